//! Elementary functions for the loops of a step: without branches and calls where a compiler can vectorize them.

/// Adding and subtracting this rounds to an integer, which then stands in the lowest bits.
const ROUND: f64 = 1.5 * (1_u64 << 52) as f64;
/// ln 2 as a sum; multiples of the first part by an exponent are exact.
const LN_2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];
/// The result is -1 to rounding long before this, and 2^k would leave the range of a number.
const SMALLEST: f64 = -700.0;
/// `1 / n!` for n = 2, 3, ...: the remainder is below rounding for arguments up to `ln 2 / 2`.
const SERIES: [f64; 12] = {
    let mut series = [0.5; 12];
    let mut n = 1;
    while n < series.len() {
        series[n] = series[n - 1] / (n + 2) as f64;
        n += 1;
    }
    series
};

/// `exp(x) - 1` for `x <= 0`, to a few units in the last place, small arguments included; exactly 0 at 0.
#[inline(always)]
pub fn exp_m1(x: f64) -> f64 {
    exp_m1_and_exp(x)[0]
}

/// `exp(x) - 1` and `exp(x)` for `x <= 0`, each to a few units in the last place: where the first is -1 to rounding, the second
/// keeps its digits; 0 below -700, where it is less than 1e-304.
#[inline(always)]
pub fn exp_m1_and_exp(x: f64) -> [f64; 2] {
    // a comparison and not `max`: NaN stays NaN
    let is_nothing = x < SMALLEST;
    let x = if is_nothing { SMALLEST } else { x };
    let shifted = x * std::f64::consts::LOG2_E + ROUND;
    let k = shifted - ROUND;
    let f = (x - k * LN_2[0]) - k * LN_2[1];
    let mut sum = SERIES[SERIES.len() - 1];
    for term in SERIES.iter().rev().skip(1) {
        sum = sum * f + term;
    }
    let part = f + f * f * sum;
    // 2^k from the bits of its exponent
    let power = f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52);
    let exp = if is_nothing {
        0.0
    } else {
        power * part + power
    };
    [power * part + (power - 1.0), exp]
}

/// Sums of squares between which neither overflow nor underflow of a square shows.
const PLAIN_SQUARES: std::ops::Range<f64> = 1e-280..1e300;

/// Length of the vector (x, y), to a unit in the last place, for all numbers: `hypot` of the library takes ten times as long.
#[inline(always)]
pub fn length(x: f64, y: f64) -> f64 {
    let square = x * x + y * y;
    if PLAIN_SQUARES.contains(&square) {
        square.sqrt()
    } else if x == 0.0 && y == 0.0 {
        0.0
    } else {
        x.hypot(y)
    }
}

#[cfg(test)]
mod tests {
    use super::{exp_m1, exp_m1_and_exp, length};

    #[test]
    fn length_agrees_with_the_library() {
        for x in [0.0, 1.0, -3e-5, 1e-200, f64::MAX, f64::MIN_POSITIVE, 1e150] {
            assert_eq!(length(x, 0.0), x.abs());
            assert_eq!(length(0.0, -x), x.abs());
            for y in [0.0, 1.7, 3e-5, 1e-190, -1e300, 5e-324] {
                let (found, exact) = (length(x, y), x.hypot(y));
                assert!(found == exact || (found / exact - 1.0).abs() <= f64::EPSILON);
            }
        }
        assert_eq!(length(f64::INFINITY, 1.0), f64::INFINITY);
        assert!(length(f64::NAN, 1.0).is_nan());
    }

    #[test]
    fn agrees_with_the_library() {
        assert_eq!(exp_m1(0.0), 0.0);
        assert_eq!(exp_m1(-0.0), 0.0);
        assert_eq!(exp_m1(f64::NEG_INFINITY), -1.0);
        assert!(exp_m1(f64::NAN).is_nan());
        let mut worst: f64 = 0.0;
        for i in 0..200_000 {
            for x in [
                -1e-5 * f64::from(i),
                -40.0 * f64::from(i) / 2e5,
                -1e-18 * f64::from(i),
            ] {
                let exact = x.exp_m1();
                if exact != 0.0 {
                    worst = worst.max((exp_m1(x) / exact - 1.0).abs());
                }
            }
        }
        assert!(worst < 4.0 * f64::EPSILON, "{worst:e}");
        for i in 0..70_000 {
            let x = -0.01 * f64::from(i);
            let [m1, exp] = exp_m1_and_exp(x);
            assert_eq!(m1, exp_m1(x));
            assert!((exp / x.exp() - 1.0).abs() < 4.0 * f64::EPSILON, "{x}");
        }
        assert_eq!(exp_m1_and_exp(f64::NEG_INFINITY), [-1.0, 0.0]);
    }
}

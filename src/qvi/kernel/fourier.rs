//! The fast Fourier transform of a length that is a power of two, in place.

/// Real and imaginary part.
pub type Complex = [f64; 2];

/// `y_m = sum_n x_n exp(-+2 pi i m n / N)`, divided by N in the inverse transform (plus sign).
pub fn transform(x: &mut [Complex], is_inverse: bool) {
    let n = x.len();
    debug_assert!(n.is_power_of_two() && n > 1);
    let shift = usize::BITS - n.ilog2();
    for i in 0..n {
        let j = i.reverse_bits() >> shift;
        if i < j {
            x.swap(i, j);
        }
    }
    let turn = if is_inverse { 2.0 } else { -2.0 } * std::f64::consts::PI;
    let mut half = 1;
    while half < n {
        // each factor by itself: products of factors would lose digits
        let factors: Vec<Complex> = (0..half)
            .map(|m| {
                let (sin, cos) = (turn * m as f64 / (2 * half) as f64).sin_cos();
                [cos, sin]
            })
            .collect();
        for block in x.chunks_mut(2 * half) {
            let (low, high) = block.split_at_mut(half);
            for ((low, high), [cos, sin]) in low.iter_mut().zip(high).zip(&factors) {
                let turned = [high[0] * cos - high[1] * sin, high[0] * sin + high[1] * cos];
                *high = [low[0] - turned[0], low[1] - turned[1]];
                *low = [low[0] + turned[0], low[1] + turned[1]];
            }
        }
        half *= 2;
    }
    if is_inverse {
        x.iter_mut().flatten().for_each(|x| *x /= n as f64);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_transform_agrees_with_its_definition_and_its_inverse() {
        let n = 16;
        let x: Vec<Complex> = (0..n)
            .map(|i| [(i as f64).sin() + 1.0, (2.0 * i as f64).cos()])
            .collect();
        let mut y = x.clone();
        transform(&mut y, false);
        for (m, found) in y.iter().enumerate() {
            let mut sum = [0.0; 2];
            for (i, x) in x.iter().enumerate() {
                let angle = -2.0 * std::f64::consts::PI * (m * i) as f64 / n as f64;
                sum[0] += x[0] * angle.cos() - x[1] * angle.sin();
                sum[1] += x[0] * angle.sin() + x[1] * angle.cos();
            }
            assert!((found[0] - sum[0]).abs() + (found[1] - sum[1]).abs() < 1e-12);
        }
        transform(&mut y, true);
        for (x, y) in x.iter().zip(&y) {
            assert!((x[0] - y[0]).abs() + (x[1] - y[1]).abs() < 1e-14);
        }
    }
}

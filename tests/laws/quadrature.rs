//! Integrals to rounding by adaptive Gauss-Kronrod quadrature (QUADPACK's qk15), for comparison with closed forms.

/// Nodes on (0, 1] of the 15-point rule, the odd ones of them those of the 7-point Gauss rule, then the middle.
const NODES: [f64; 8] = [
    0.991_455_371_120_812_6,
    0.949_107_912_342_758_5,
    0.864_864_423_359_769_1,
    0.741_531_185_599_394_4,
    0.586_087_235_467_691_1,
    0.405_845_151_377_397_2,
    0.207_784_955_007_898_47,
    0.0,
];
const KRONROD: [f64; 8] = [
    0.022_935_322_010_529_224,
    0.063_092_092_629_978_56,
    0.104_790_010_322_250_18,
    0.140_653_259_715_525_92,
    0.169_004_726_639_267_9,
    0.190_350_578_064_785_4,
    0.204_432_940_075_298_9,
    0.209_482_141_084_727_82,
];
const GAUSS: [f64; 4] = [
    0.129_484_966_168_869_7,
    0.279_705_391_489_276_64,
    0.381_830_050_505_118_9,
    0.417_959_183_673_469_4,
];

/// Integral of `f` from `a` to `b`: halved until both rules agree to rounding, or to what `f` is known to, `noise`.
pub fn integral(f: &impl Fn(f64) -> f64, a: f64, b: f64, noise: f64) -> f64 {
    piece(f, a, b, noise, 0)
}

fn piece(f: &impl Fn(f64) -> f64, a: f64, b: f64, noise: f64, depth: u32) -> f64 {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    let centre = f(middle);
    let (mut kronrod, mut gauss) = (KRONROD[7] * centre, GAUSS[3] * centre);
    for i in 0..7 {
        let both = f(middle - half * NODES[i]) + f(middle + half * NODES[i]);
        kronrod += KRONROD[i] * both;
        if i % 2 == 1 {
            gauss += GAUSS[i / 2] * both;
        }
    }
    if depth == 45 || (kronrod - gauss).abs() <= 2e-15 * kronrod.abs() + noise {
        return half * kronrod;
    }
    piece(f, a, middle, noise, depth + 1) + piece(f, middle, b, noise, depth + 1)
}

//! Points of integration on bent cells and faces, where nothing is a polynomial any more: barycentric coordinates and the share of the
//! measure of each. All weights are positive, so that a positive matrix stays one.

use super::Barycentric;

/// Gauss's rule with 3 points on a line: degree 5.
pub(super) const LINE: &[(Barycentric, f64)] = &[
    ([L, 1.0 - L, 0.0, 0.0], 5.0 / 18.0),
    ([0.5, 0.5, 0.0, 0.0], 8.0 / 18.0),
    ([1.0 - L, L, 0.0, 0.0], 5.0 / 18.0),
];

/// `(1 + sqrt(3/5)) / 2`.
const L: f64 = 0.887_298_334_620_741_7;

/// Dunavant's rule with 6 points on a triangle: degree 4.
pub(super) const TRIANGLE: &[(Barycentric, f64)] = &[
    ([1.0 - 2.0 * T1, T1, T1, 0.0], W1),
    ([T1, 1.0 - 2.0 * T1, T1, 0.0], W1),
    ([T1, T1, 1.0 - 2.0 * T1, 0.0], W1),
    ([1.0 - 2.0 * T2, T2, T2, 0.0], W2),
    ([T2, 1.0 - 2.0 * T2, T2, 0.0], W2),
    ([T2, T2, 1.0 - 2.0 * T2, 0.0], W2),
];

const T1: f64 = 0.445_948_490_915_964_9;
const W1: f64 = 0.223_381_589_678_011_47;
const T2: f64 = 0.091_576_213_509_770_74;
const W2: f64 = 0.109_951_743_655_321_87;

/// Walkington's rule with 14 points on a tetrahedron: degree 5.
pub(super) const TETRAHEDRON: &[(Barycentric, f64)] = &[
    ([1.0 - 3.0 * A1, A1, A1, A1], V1),
    ([A1, 1.0 - 3.0 * A1, A1, A1], V1),
    ([A1, A1, 1.0 - 3.0 * A1, A1], V1),
    ([A1, A1, A1, 1.0 - 3.0 * A1], V1),
    ([1.0 - 3.0 * A2, A2, A2, A2], V2),
    ([A2, 1.0 - 3.0 * A2, A2, A2], V2),
    ([A2, A2, 1.0 - 3.0 * A2, A2], V2),
    ([A2, A2, A2, 1.0 - 3.0 * A2], V2),
    ([A3, A3, B3, B3], V3),
    ([A3, B3, A3, B3], V3),
    ([A3, B3, B3, A3], V3),
    ([B3, A3, A3, B3], V3),
    ([B3, A3, B3, A3], V3),
    ([B3, B3, A3, A3], V3),
];

const A1: f64 = 0.310_885_919_263_300_6;
const V1: f64 = 0.112_687_925_718_015_85;
const A2: f64 = 0.092_735_250_310_891_23;
const V2: f64 = 0.073_493_043_116_361_95;
const A3: f64 = 0.045_503_704_125_649_65;
const B3: f64 = 0.5 - A3;
const V3: f64 = 0.042_546_020_777_081_47;

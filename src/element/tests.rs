//! What every table must satisfy, whatever element it is.

use super::*;

/// Barycentric coordinates of the nodes of a cell.
fn nodes(element: &Element) -> Vec<Barycentric> {
    let corner = |i: usize| {
        let mut at = [0.0; 4];
        at[i] = 1.0;
        at
    };
    let mut all: Vec<Barycentric> = (0..element.corners()).map(corner).collect();
    all.extend(element.midsides.iter().map(|[i, j]| {
        let mut at = [0.0; 4];
        (at[*i], at[*j]) = (0.5, 0.5);
        at
    }));
    all
}

/// Points of no symmetry inside a cell.
fn inner(element: &Element) -> Vec<Barycentric> {
    let mut all = Vec::new();
    for n in 1..6 {
        let raw: Vec<f64> = (0..element.corners())
            .map(|i| 1.1 + (f64::from(n) * 2.3 + 1.7 * i as f64).sin())
            .collect();
        let sum: f64 = raw.iter().sum();
        let mut at = [0.0; 4];
        for (to, value) in at.iter_mut().zip(&raw) {
            *to = value / sum;
        }
        all.push(at);
    }
    all
}

/// `p! q! r! s! d! / (p + q + r + s + d)!`: the mean of `l_0^p l_1^q l_2^r l_3^s` over a simplex of dimension d.
fn mean_of_monomial(powers: &[u64], dimension: u64) -> f64 {
    let factorial = |n: u64| (1..=n).product::<u64>() as f64;
    let above: f64 = powers.iter().map(|p| factorial(*p)).product();
    above * factorial(dimension) / factorial(powers.iter().sum::<u64>() + dimension)
}

fn monomial(at: &[f64], powers: &[u64]) -> f64 {
    at.iter()
        .zip(powers)
        .map(|(l, p)| l.powi(*p as i32))
        .product()
}

/// All exponents of `count` factors whose sum is `degree`.
fn powers(count: usize, degree: u64) -> Vec<Vec<u64>> {
    if count == 1 {
        return vec![vec![degree]];
    }
    let with = |first: u64| {
        let rest = powers(count - 1, degree - first);
        rest.into_iter().map(move |r| [vec![first], r].concat())
    };
    (0..=degree).flat_map(with).collect()
}

#[test]
fn names_and_places_in_scenes_are_unique_and_counts_agree() {
    for (i, e) in ELEMENTS.iter().enumerate() {
        assert!(
            ELEMENTS[..i]
                .iter()
                .all(|o| o.name != e.name && o.vtk != e.vtk)
        );
        assert_eq!(of(e.kind, e.dimension), Some(e));
        assert_eq!(e.nodes, e.corners() + e.midsides.len());
        assert_eq!(
            (e.integrals.len(), e.face_integrals.len()),
            (e.nodes, e.face_nodes())
        );
        assert_eq!(e.faces.len(), e.corners());
        assert!(e.nodes <= MOST_NODES);
        assert_eq!(linear(e.dimension).dimension, e.dimension);
    }
    assert_eq!(MOST_NODES, 10);
    assert_eq!(
        with_contact(2).map(|e| e.name).collect::<Vec<_>>(),
        ["tri3", "tri6"]
    );
    assert_eq!(
        with_contact(3).map(|e| e.name).collect::<Vec<_>>(),
        ["tet4"]
    );
}

#[test]
fn shape_functions_are_a_partition_of_unity_and_nodal() {
    for e in ELEMENTS {
        for at in inner(e).iter().chain(e.points) {
            let sum: f64 = (0..e.nodes).map(|n| (e.shape)(n, at)).sum();
            assert!((sum - 1.0).abs() < 1e-14, "{}", e.name);
            // the gradients sum to that of l_0 + l_1 + ..., which is constant: all derivatives are equal
            for i in 1..e.corners() {
                let slope = |i: usize| (0..e.nodes).map(|n| (e.slopes)(n, at)[i]).sum::<f64>();
                assert!((slope(i) - slope(0)).abs() < 1e-14, "{}", e.name);
            }
        }
        for (m, at) in nodes(e).iter().enumerate() {
            for n in 0..e.nodes {
                assert_eq!((e.shape)(n, at), f64::from(u8::from(n == m)), "{}", e.name);
            }
        }
    }
}

/// Central differences are exact for polynomials of degree 2.
#[test]
fn slopes_are_the_derivatives() {
    for e in ELEMENTS {
        for at in inner(e) {
            for n in 0..e.nodes {
                for i in 0..e.corners() {
                    let shifted = |by: f64| {
                        let mut to = at;
                        to[i] += by;
                        (e.shape)(n, &to)
                    };
                    let difference = (shifted(0.5) - shifted(-0.5)) / 1.0;
                    let slope = (e.slopes)(n, &at)[i];
                    assert!((difference - slope).abs() < 1e-14, "{} {n} {i}", e.name);
                }
                assert!((e.slopes)(n, &at)[e.corners()..].iter().all(|s| *s == 0.0));
            }
        }
    }
}

/// Products of two gradients have degree `2 (order - 1)`; the rule must be exact up to there.
#[test]
fn points_integrate_products_of_gradients() {
    for e in ELEMENTS {
        let weight = 1.0 / e.points.len() as f64;
        for degree in 0..=2 * (e.order as u64 - 1) {
            for powers in powers(e.corners(), degree) {
                let found: f64 = e.points.iter().map(|p| weight * monomial(p, &powers)).sum();
                let exact = mean_of_monomial(&powers, e.dimension as u64);
                assert!((found - exact).abs() < 1e-15, "{} {powers:?}", e.name);
            }
        }
    }
}

/// Integral of a polynomial of degree 2 by its coefficients: values at the corners and the middles of the edges fix it.
fn integral_of_quadratic(corners: usize, value: impl Fn(&[f64]) -> f64) -> f64 {
    let mut at = vec![0.0; corners];
    let dimension = corners as u64 - 1;
    let mut sum = 0.0;
    let squares = mean_of_monomial(&[2], dimension);
    let products = mean_of_monomial(&[1, 1], dimension);
    // sum_i v_i l_i (2 l_i - 1) + sum_ij 4 v_ij l_i l_j
    let ones = mean_of_monomial(&[1], dimension);
    for i in 0..corners {
        at.fill(0.0);
        at[i] = 1.0;
        sum += value(&at) * (2.0 * squares - ones);
        for j in 0..i {
            at.fill(0.0);
            (at[i], at[j]) = (0.5, 0.5);
            sum += value(&at) * 4.0 * products;
        }
    }
    sum
}

#[test]
fn integrals_of_shape_functions_are_exact() {
    for e in ELEMENTS {
        for (n, share) in e.integrals.iter().enumerate() {
            let exact = integral_of_quadratic(e.corners(), |l| {
                let mut at = [0.0; 4];
                at[..l.len()].copy_from_slice(l);
                (e.shape)(n, &at)
            });
            assert!((share.of(1.0) - exact).abs() < 1e-15, "{} {n}", e.name);
        }
        // the trace of the cell on its last face, whose corners and midside nodes are those of the face table
        let face = e.faces[e.faces.len() - 1];
        let of_cell = |n: usize| match n.checked_sub(face.len()) {
            None => face[n],
            Some(m) => {
                let ends = e.face_midsides[m].map(|i| face[i]);
                let is_same = |s: &[usize; 2]| *s == ends || *s == [ends[1], ends[0]];
                e.corners()
                    + e.midsides
                        .iter()
                        .position(is_same)
                        .expect("an edge of the cell")
            }
        };
        for (n, share) in e.face_integrals.iter().enumerate() {
            let trace = |l: &[f64]| {
                let mut at = [0.0; 4];
                for (value, corner) in l.iter().zip(face) {
                    at[*corner] = *value;
                }
                (e.shape)(of_cell(n), &at)
            };
            let exact = integral_of_quadratic(face.len(), trace);
            assert!((share.of(1.0) - exact).abs() < 1e-15, "{} {n}", e.name);
            let OnContact::Nodes { shape, between } = e.contact else {
                continue;
            };
            for l in [[0.3, 0.7, 0.0], [0.9, 0.1, 0.0], [0.2, 0.5, 0.3]] {
                // barycentric coordinates of a face sum to one
                let sum: f64 = l[..face.len()].iter().sum();
                let l: Vec<f64> = l[..face.len()].iter().map(|x| x / sum).collect();
                assert!((shape(n, &l) - trace(&l)).abs() < 1e-15, "{} {n}", e.name);
                let all: f64 = (0..e.face_nodes()).map(|m| between(m, &l)).sum();
                assert!((all - 1.0).abs() < 1e-15 && between(n, &l) >= 0.0);
            }
        }
    }
}

/// Faces are those of a positive cell: the corner that a face lacks is on its inner side.
#[test]
fn faces_point_outward() {
    let places = [
        [0.1, 0.2, 0.0],
        [1.3, -0.1, 0.0],
        [0.4, 0.9, 0.0],
        [0.3, 0.5, 1.1],
    ];
    let minus = |a: [f64; 3], b: [f64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ]
    };
    for e in ELEMENTS {
        for face in e.faces {
            let p = face.iter().map(|i| places[*i]).collect::<Vec<_>>();
            let normal = match p[..] {
                [p, q] => cross(minus(q, p), [0.0, 0.0, 1.0]),
                [p, q, r] => cross(minus(q, p), minus(r, p)),
                _ => panic!("a face of {} corners", p.len()),
            };
            let other = (0..e.corners())
                .find(|i| !face.contains(i))
                .expect("a corner");
            let inwards = minus(places[other], p[0]);
            let along: f64 = normal.iter().zip(inwards).map(|(n, d)| n * d).sum();
            assert!(along < 0.0, "{}", e.name);
        }
    }
}

/// The triangles that a plane cell is drawn as cover it once, and turn as it does.
#[test]
fn pieces_cover_the_cell() {
    for e in ELEMENTS.iter().filter(|e| e.dimension == 2) {
        let nodes = nodes(e);
        let area = |piece: &[usize; 3]| {
            let [p, q, r] = piece.map(|n| [nodes[n][1], nodes[n][2]]);
            (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
        };
        assert!(e.pieces.iter().all(|p| area(p) > 0.0));
        assert!((e.pieces.iter().map(area).sum::<f64>() - 1.0).abs() < 1e-15);
    }
}

/// The rules for bent cells and faces: positive weights, and exact for all monomials up to their degree but not beyond it.
#[test]
fn rules_for_bent_cells_are_exact_to_their_degree() {
    for (rule, dimension, degree) in [
        (rules::LINE, 1, 5),
        (rules::TRIANGLE, 2, 4),
        (rules::TETRAHEDRON, 3, 5),
    ] {
        let error = |degree: u64| {
            let of = |p: Vec<u64>| {
                let sum: f64 = rule
                    .iter()
                    .map(|(at, share)| share * monomial(&at[..=dimension], &p))
                    .sum();
                (sum - mean_of_monomial(&p, dimension as u64)).abs()
            };
            powers(dimension + 1, degree)
                .into_iter()
                .map(of)
                .fold(0.0, f64::max)
        };
        assert!(rule.iter().all(|(_, share)| *share > 0.0));
        for n in 0..=degree {
            assert!(
                error(n) < 2e-16 + 1e-15 / (n + 1) as f64,
                "{dimension} {n}: {}",
                error(n)
            );
        }
        assert!(error(degree + 1) > 1e-6, "{dimension}");
    }
}

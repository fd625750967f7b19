//! The points of the tangents that a simulation keeps, one per implicit weight: that of the start or of a jump, and that of the step.
//!
//! They are part of the state, because the iterates of a stage, and so the last bits of its result, depend on the factor that is
//! kept from step to step. The factor is only a cache, keyed by the bits of the point: a simulator that continues from a restored
//! state factors anew, to the same bits.

use std::ops::Range;

/// Points kept.
const POINTS: usize = 2;
/// Entries before the values of a point: theta_k, last use.
const HEAD: usize = 2;

/// Length of the points of a body, of which one has `point` numbers.
pub fn points_len(point: usize) -> usize {
    match point {
        0 => 0,
        _ => POINTS * (HEAD + point),
    }
}

/// Where the values of the point for `theta_k` stand among those of a state, and whether they are already known; the one used longest
/// ago makes room for a new one.
pub fn take_point(points: &mut [f64], theta_k: f64) -> (Range<usize>, bool) {
    let len = points.len() / POINTS;
    let (mut chosen, mut is_known, mut clock) = (0, false, 0.0);
    let mut oldest = f64::INFINITY;
    for (at, point) in points.chunks_exact(len).enumerate() {
        let last_use = point[1];
        clock = last_use.max(clock);
        let is_this = last_use > 0.0 && point[0].to_bits() == theta_k.to_bits();
        if is_this || (!is_known && last_use < oldest) {
            (chosen, is_known, oldest) = (at, is_this, last_use);
        }
    }
    let first = chosen * len;
    points[first] = theta_k;
    points[first + 1] = clock + 1.0;
    (first + HEAD..first + len, is_known)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_point_used_longest_ago_makes_room() {
        let mut points = vec![0.0; points_len(3)];
        let (first, is_known) = take_point(&mut points, 0.0);
        assert!(!is_known);
        points[first.clone()].fill(1.0);
        let (second, is_known) = take_point(&mut points, 0.5);
        assert!(!is_known && second != first);
        assert_eq!(take_point(&mut points, 0.0), (first, true));
        assert_eq!(take_point(&mut points, 0.25), (second.clone(), false));
        assert_eq!(take_point(&mut points, 0.25), (second, true));
        assert_eq!(points_len(0), 0);
    }
}

//! Foundations that remember penetration (`contact::relaxing`) in a stage: the line that they add to its law, and their numbers after
//! it.

use super::memory::Span;
use super::pressed::Level;
use super::velocity::Velocity;
use super::workspace::Workspace;
use crate::model::Model;
use crate::model::motions::Approach;

/// Growth by the depth, N/m, and force at depth 0, N, of every node in a stage of this length after `before`. Offsets are linear in
/// the numbers before, so tangents take the same function.
pub(super) fn set_lines(model: &Model, before: &Velocity, length: f64, out: &mut [[f64; 2]]) {
    let weights = &model.contact().weights;
    for part in model.relaxing() {
        for (node, numbers) in part.nodes() {
            let line = part.foundation.line(&before.penetration[numbers], length);
            out[node] = line.map(|value| weights[node] * value);
        }
    }
}

/// The offsets of lines.
pub(super) fn offsets(lines: &[[f64; 2]], out: &mut [f64]) {
    for (out, [_, offset]) in out.iter_mut().zip(lines) {
        *out = *offset;
    }
}

/// Where a stage leaves the contact: `reach` seconds of its normal velocity beyond the explicit part, the foundations displaced
/// by `approach`.
struct End {
    reach: f64,
    approach: Approach,
}

impl End {
    /// Of a stage; `approach` is that at the end of the step.
    fn of(
        model: &Model,
        (theta_k, level, span): (f64, Level, Span),
        index: usize,
        approach: Approach,
    ) -> End {
        let (reach, approach) = match (index, model.tableau().ends_with_stage()) {
            (0, _) => (0.0, level.approach()),
            (_, true) => (theta_k, level.approach()),
            (_, false) => (span.step, approach),
        };
        End { reach, approach }
    }

    /// How far the body is below the undeformed foundation, m; negative where it is away. Without the gap of its shape.
    fn below(&self, contact: usize, node: usize, displacement: &[f64], velocity: &Velocity) -> f64 {
        let moved = displacement[node] + self.reach * velocity.instant.normal_velocity[node];
        self.approach.of(contact) - moved
    }
}

/// Numbers after the stage that was solved into `ws.velocities[index]`; after a jump those of the same instant.
pub(super) fn advance(model: &Model, ws: &mut Workspace, at: (f64, Level, Span), index: usize) {
    if model.relaxing().is_empty() {
        return;
    }
    let end = End::of(model, at, index, ws.approach[1]);
    let (known, rest) = ws.velocities.split_at_mut(index);
    let velocity = &mut rest[0];
    if let Some(before) = known.last() {
        velocity.penetration.copy_from_slice(&before.penetration);
    }
    let displacement = &ws.explicit.normal_displacement;
    let length = at.2.step;
    for part in model.relaxing() {
        let foundation = &part.foundation;
        for (node, numbers) in part.nodes() {
            let below = end.below(part.contact, node, displacement, velocity);
            let penetration = (below - model.contact().gaps[node]).max(0.0);
            let numbers = &mut velocity.penetration[numbers];
            let depth = foundation.depth(foundation.line(numbers, length), penetration);
            foundation.advance(numbers, length, depth);
        }
    }
}

/// A stage and what leads there: velocities of the step so far, the explicit part of the normal displacement, what the gap was a
/// condition on, and the displacements of the foundations at the end of the step.
pub(super) struct Course<'a, V> {
    pub velocities: V,
    pub displacement: &'a [f64],
    pub level: Level,
    pub approach: Approach,
}

/// Derivatives of those numbers along a seed, of which `along` has the derivatives of the course.
pub(super) fn advance_slopes(
    model: &Model,
    of: Course<&[Velocity]>,
    along: Course<&mut [Velocity]>,
    (theta_k, span): (f64, Span),
    index: usize,
) {
    if model.relaxing().is_empty() {
        return;
    }
    let end = End::of(model, (theta_k, of.level, span), index, of.approach);
    let moves = End::of(model, (theta_k, along.level, span), index, along.approach);
    let (known, rest) = along.velocities.split_at_mut(index);
    let velocity = &mut rest[0];
    if let Some(before) = known.last() {
        velocity.penetration.copy_from_slice(&before.penetration);
    }
    let solution = &of.velocities[index];
    let start = &of.velocities[index.saturating_sub(1)].penetration;
    for part in model.relaxing() {
        let foundation = &part.foundation;
        for (node, numbers) in part.nodes() {
            let below = end.below(part.contact, node, of.displacement, solution);
            let penetration = (below - model.contact().gaps[node]).max(0.0);
            let line = foundation.line(&start[numbers.clone()], span.step);
            let moved = moves.below(part.contact, node, along.displacement, velocity);
            let numbers = &mut velocity.penetration[numbers];
            let [_, offset] = foundation.line(numbers, span.step);
            let depth = foundation.depth_slope(line, penetration, [offset, moved]);
            foundation.advance(numbers, span.step, depth);
        }
    }
}

/// What the branches dissipate over a step of size `k` and its derivative are squares and products of this form, J: of two courses,
/// each by its velocities.
pub(super) fn dissipated(model: &Model, k: f64, x: &[Velocity], y: &[Velocity]) -> f64 {
    let tableau = model.tableau();
    let (mut before, mut sum) = (0.0, 0.0);
    for (i, stage) in tableau.stages().iter().enumerate() {
        let length = match tableau.ends_with_stage() {
            true => (stage.instant - before) * k,
            false => k,
        };
        before = stage.instant;
        for part in model.relaxing() {
            for (node, numbers) in part.nodes() {
                let [x0, x1] = [&x[i], &x[i + 1]].map(|at| &at.penetration[numbers.clone()]);
                let [y0, y1] = [&y[i], &y[i + 1]].map(|at| &at.penetration[numbers.clone()]);
                let weight = model.contact().weights[node];
                sum += weight * part.foundation.dissipated(length, [x0, x1], [y0, y1]);
            }
        }
    }
    sum
}

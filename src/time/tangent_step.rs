//! The tangents go along with a step that is repeated: what a step does between its stages, differentiated.

use super::companion::{Companion, StagePlace};
use super::pressed::Level;
use super::record::{explicit_part, integrate, power_of_motions, power_of_pins};
use super::tangent::Tangents;
use super::workspace::Workspace;
use super::{foundation, penetration};
use crate::body::BodyModel;
use crate::body::nonlinear::{ELASTIC, VISCOUS};
use crate::error::Result;
use crate::linalg::dot;
use crate::model::Model;
use crate::model::motions::Approach;
use crate::scene::Start;
use crate::state::{State, energy};

impl Companion for Tangents {
    fn start(&mut self, model: &Model, state: &State, ws: &mut Workspace) -> Result<()> {
        let mut has_jump = ws.has_settled;
        for t in &mut self.list {
            for (i, seed) in t.seed.iter().enumerate() {
                t.course.start[i] = ws.course.start_by_input[i] * seed;
                t.course.end[i] = ws.course.end_by_input[i] * seed;
            }
            t.load.copy_from_slice(&t.course.start);
            has_jump |= t.load.iter().any(|v| *v != 0.0);
        }
        if has_jump && model.tableau().uses_start_velocity() && model.start() != Start::Zero {
            let motions = model.motions();
            for t in &mut self.list {
                let [start, end] = [&t.course.start, &t.course.end].map(|at| motions.approach(at));
                t.level = Level::Velocity {
                    approach: start,
                    velocity: Approach::rate(start, end, ws.course.size),
                };
            }
            let approach = motions.approach(&ws.course.start);
            self.settle(model, state, ws, approach)?;
        }
        Ok(())
    }

    fn keep(&mut self) {
        for t in &mut self.list {
            t.kept.0.copy_steps_from(&t.state);
            t.kept.1.copy_from(&t.velocities[0]);
        }
    }

    fn go_back(&mut self) {
        for t in &mut self.list {
            t.state.copy_steps_from(&t.kept.0);
            t.velocities[0].copy_from(&t.kept.1);
        }
    }

    fn begin(&mut self, fraction: f64) {
        for t in &mut self.list {
            t.course.at(fraction, &mut t.load);
            t.velocities[0].load.copy_from_slice(&t.load);
        }
    }

    fn stage(
        &mut self,
        model: &Model,
        state: &State,
        ws: &mut Workspace,
        k: f64,
        place: StagePlace,
    ) -> Result<()> {
        let motions = model.motions();
        let rate = match place.level {
            Level::Position { rate, .. } => rate,
            Level::Velocity { .. } => 0.0,
        };
        for t in &mut self.list {
            let known = &t.velocities[..place.index];
            explicit_part(motions, &t.state, known, place.stage, k, &mut t.explicit);
            t.course.at(place.end, &mut t.load);
            t.approach = [
                motions.approach(&t.velocities[0].load),
                motions.approach(&t.load),
            ];
            t.course.at(place.fraction, &mut t.load);
            // at the end of the step where the stage is not the new instant
            let is_stage = rate == place.stage.theta * k;
            let approach = match is_stage {
                true => motions.approach(&t.load),
                false => t.approach[1],
            };
            t.level = Level::Position { rate, approach };
        }
        self.solve(
            model,
            state,
            ws,
            (place.stage.theta * k, place.level, place.span),
            place.index,
        )
    }

    fn settle_end(
        &mut self,
        model: &Model,
        state: &State,
        ws: &mut Workspace,
        k: f64,
        fraction: f64,
    ) -> Result<()> {
        for t in &mut self.list {
            t.course.at(fraction, &mut t.load);
            t.explicit.follow(&t.state);
            t.level = Level::Velocity {
                approach: t.approach[1],
                velocity: Approach::rate(t.approach[0], t.approach[1], k),
            };
        }
        self.settle(model, state, ws, ws.approach[1])?;
        for t in &mut self.list {
            t.velocities[0].store_into(&mut t.state);
        }
        Ok(())
    }

    fn end(&mut self, model: &Model, state: &State, ws: &Workspace, k: f64) {
        let tableau = model.tableau();
        let last = tableau.stages().len();
        let body = model.body();
        for t in &mut self.list {
            t.velocities[last].store_into(&mut t.state);
            integrate(model, &mut t.state, &t.velocities[..=last], k);
            t.mean.set_mean(tableau, &t.velocities);
            let (mean, d) = (&ws.mean, &t.mean);
            let (viscous, _) = mixed_products(
                body,
                &mean.instant.velocity,
                &d.instant.velocity,
                &mut self.sum,
            );
            let displacement = &t.state.main.displacement;
            let (_, elastic) =
                mixed_products(body, &state.main.displacement, displacement, &mut self.sum);
            let viscous = viscous - power_of_pins(model, &mean.instant, &d.instant);
            let motions = model.motions();
            let loads = |inputs: &'_ [f64]| inputs[..motions.loads()].to_vec();
            let mut external = dot(&loads(&mean.load), &d.instant.output_velocity)
                + dot(&loads(&d.load), &mean.instant.output_velocity);
            let (mut viscous, mut elastic) = (viscous, elastic);
            if let Some(cells) = body.nonlinear() {
                let rate = &mean.instant.velocity;
                for (j, velocity) in ws.velocities[..=last].iter().enumerate() {
                    let (weight, at) = (tableau.weight(j), &velocity.instant.velocity);
                    if weight == 0.0 {
                        continue;
                    }
                    let mut force = vec![0.0; at.len()];
                    cells.add_forces(VISCOUS, at, &mut force);
                    // half of it: the share of the linear part is doubled below
                    viscous += 0.5 * weight * dot(&force, &d.instant.velocity);
                    force.fill(0.0);
                    let along = &t.velocities[j].instant.velocity;
                    cells.add_slopes(VISCOUS, at, along, &mut force);
                    viscous += 0.5 * weight * dot(&force, rate);
                }
                let mut force = vec![0.0; displacement.len()];
                cells.add_forces(ELASTIC, &state.main.displacement, &mut force);
                elastic += dot(&force, displacement);
            }
            if !motions.is_empty() {
                let rate = |ends: [Approach; 2]| Approach::rate(ends[0], ends[1], k);
                let (approach, approaches) = (rate(ws.approach), rate(t.approach));
                external += power_of_motions(motions, &mean.load, &d.instant, approach)
                    + power_of_motions(motions, &d.load, &mean.instant, approaches);
                let own: [&[f64]; 2] = [&mean.load, &mean.instant.output_velocity];
                let along: [&[f64]; 2] = [&d.load, &d.instant.output_velocity];
                viscous += motions.viscous_product(own, along);
                let displacement = [&state.drive_displacement, &t.state.drive_displacement];
                elastic += motions.elastic_product(displacement[0], displacement[1]);
            }
            if let Some(column) = motions.initial_column() {
                elastic -= t.state.output_displacement[column];
            }
            let moves = &t.state.main.normal_displacement;
            let ends = (ws.approach[1], t.approach[1]);
            elastic += foundation::energy_slope(model, state, ends.0, (moves, ends.1))
                + foundation::relaxing_slope(
                    model,
                    &state.main.penetration,
                    &t.state.main.penetration,
                );
            if !tableau.ends_with_stage() {
                let to = &mut t.state;
                to.mean_slip_rate.copy_from_slice(&d.instant.slip_rate);
                to.mean_force.copy_from_slice(&d.instant.force);
                to.mean_normal_force
                    .copy_from_slice(&d.instant.normal_force);
            }
            let energy = &mut t.state.energy;
            energy[energy::EXTERNAL_WORK] += k * external;
            let relaxed = penetration::dissipated(model, k, &ws.velocities, &t.velocities);
            energy[energy::VISCOUS] += 2.0 * (k * viscous + relaxed);
            energy[energy::FRICTION] += k
                * (dot(&mean.instant.reaction, &d.instant.slip_rate)
                    + dot(&d.instant.reaction, &mean.instant.slip_rate));
            energy[energy::ELASTIC] = elastic;
            t.velocities.swap(0, last);
        }
    }
}

/// `(x.A y, x.B y)`, by polarisation of the squares with `y` brought to the size of `x`.
fn mixed_products(body: &dyn BodyModel, x: &[f64], y: &[f64], sum: &mut [f64]) -> (f64, f64) {
    let size = |(a, b): (f64, f64)| (a + b).sqrt();
    let (x_size, y_size) = (size(body.products(x)), size(body.products(y)));
    if !(x_size > 0.0 && y_size > 0.0) {
        return (0.0, 0.0);
    }
    let scale = x_size / y_size;
    let mut squares = |sign: f64| {
        for (sum, (x, y)) in sum.iter_mut().zip(x.iter().zip(y)) {
            *sum = x + sign * scale * y;
        }
        body.products(sum)
    };
    let (plus, minus) = (squares(1.0), squares(-1.0));
    let part = |plus: f64, minus: f64| (plus - minus) / (4.0 * scale);
    (part(plus.0, minus.0), part(plus.1, minus.1))
}

//! The discrete problem of a small scene solved with 96 digits, step by step, and how far a run may be from it.

mod body;
mod compare;
mod friction;
mod number;

use crate::case::Case;
use crate::run::{Point, Run};
use body::{Body, assemble};
use friction::{Problem, Solution};
use number::{Matrix, Real, dot, solve, zeros};

/// Most free components of a body that is solved so.
const MOST_FREE: usize = 64;

/// What the exact solution says at a communication point, contact nodes as in the run.
pub struct Exact {
    pub rates: Vec<f64>,
    /// Tangential stress on the body, Pa.
    pub stress: Vec<f64>,
    /// How far the slip rates (m/s) and stresses (Pa) may be off when every node misses its balance of forces by a relative 1.
    pub rate_per_residual: f64,
    pub stress_per_residual: Vec<f64>,
}

/// Why there is nothing to compare with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum NotSolved {
    /// The scene is too large or has no linear elements.
    NotMeant,
    /// The iteration from the given pattern did not settle.
    NotSettled,
}

/// One operator `A + theta_k B` condensed onto the contact.
struct Condensed {
    theta_k: f64,
    s: Matrix,
    /// Contact columns of the inverse.
    columns: Matrix,
    matrix: Matrix,
}

struct Solver {
    body: Body,
    case: Case,
    operators: Vec<Condensed>,
    u: Vec<Real>,
    w: Vec<Real>,
    time_step: Real,
}

/// Solves a case; at every communication point who sticks and who slips is guessed from `run`.
pub fn solve_exactly(case: &Case, run: &Run) -> Result<Vec<Exact>, NotSolved> {
    if case.element != "p1" || run.points.is_empty() {
        return Err(NotSolved::NotMeant);
    }
    let body = assemble(case);
    if body.free() > MOST_FREE || body.weights.is_empty() {
        return Err(NotSolved::NotMeant);
    }
    let order = order(&body, run);
    let n = body.free();
    let mut solver = Solver {
        body,
        case: case.clone(),
        operators: Vec::new(),
        u: vec![Real::zero(); n],
        w: vec![Real::zero(); n],
        time_step: Real::new(case.step),
    };
    let mut out = Vec::new();
    let settled = |solution: Option<Solution>| solution.ok_or(NotSolved::NotSettled);
    for (point, seen) in run.points.iter().enumerate() {
        let guess: Vec<f64> = order.iter().map(|&i| seen.rates[i]).collect();
        let solution = if point == 0 {
            if case.start == "zero" {
                out.push(Exact {
                    rates: vec![0.0; guess.len()],
                    stress: vec![0.0; guess.len()],
                    rate_per_residual: 0.0,
                    stress_per_residual: vec![0.0; guess.len()],
                });
                continue;
            }
            let loads: Vec<Real> = case.loads.iter().map(|l| Real::new(l.course[0])).collect();
            let start = solver.u.clone();
            settled(solver.stage(&start, 0.0, &loads, &guess))?
        } else {
            let mut last = None;
            let middle = middle_rates(case, [&run.points[point - 1], seen]);
            let middle: Vec<f64> = order.iter().map(|&i| middle[i]).collect();
            for cut in 0..case.cuts {
                last = Some(settled(solver.step(point, cut, [&middle, &guess]))?);
            }
            last.ok_or(NotSolved::NotSettled)?
        };
        out.push(solver.seen(&solution, &order));
    }
    Ok(out)
}

/// Share of the largest slip rate below which that of the middle stage is rounding.
const AT_REST: f64 = 1e-9;

/// Slip rates of the middle stage of TR-BDF2, from what the slip has gained; those at the end for the other schemes, or where
/// a point is more than one internal step from the last.
fn middle_rates(case: &Case, [before, after]: [&Point; 2]) -> Vec<f64> {
    if case.scheme != "tr_bdf2" || case.cuts != 1 {
        return after.rates.clone();
    }
    let outer = 0.5 * std::f64::consts::FRAC_1_SQRT_2;
    let theta = 1.0 - std::f64::consts::FRAC_1_SQRT_2;
    let mut rates: Vec<f64> = (0..after.rates.len())
        .map(|i| {
            let mean = (after.slip[i] - before.slip[i]) / case.step;
            (mean - theta * after.rates[i]) / outer - before.rates[i]
        })
        .collect();
    let terms = before.rates.iter().chain(&after.rates).chain(&rates);
    let largest = terms.fold(0f64, |m, x| m.max(x.abs()));
    for rate in &mut rates {
        if rate.abs() <= AT_REST * largest {
            *rate = 0.0;
        }
    }
    rates
}

/// Component of the run for every component of the exact body.
fn order(body: &Body, run: &Run) -> Vec<usize> {
    let c = body.components;
    let place = |point: &[f64; 3]| {
        run.positions
            .iter()
            .position(|p| p == point)
            .expect("the same contact nodes")
    };
    body.points
        .iter()
        .flat_map(|p| {
            let at = place(p);
            at * c..(at + 1) * c
        })
        .collect()
}

impl Solver {
    /// One internal step from guesses for the middle stage, where there is one, and the end; the velocity at its end stays
    /// in `w`.
    fn step(&mut self, point: usize, cut: u32, [middle, guess]: [&[f64]; 2]) -> Option<Solution> {
        let k = self.time_step.clone();
        let (one, two) = (Real::new(1.0), Real::new(2.0));
        let loads_at = |case: &Case, instant: &Real| -> Vec<Real> {
            let fraction = (&Real::new(f64::from(cut)) + instant) / Real::new(f64::from(case.cuts));
            let between = |l: &crate::case::Load| {
                let (from, to) = (Real::new(l.course[point - 1]), Real::new(l.course[point]));
                &from + &((&to - &from) * &fraction)
            };
            case.loads.iter().map(between).collect()
        };
        let plus = |u: &[Real], factor: &Real, w: &[Real]| -> Vec<Real> {
            u.iter().zip(w).map(|(u, w)| u + &(factor * w)).collect()
        };
        let at_end = loads_at(&self.case, &one);
        match self.case.scheme {
            "trapezoid" => {
                let half = &k / &two;
                let p = plus(&self.u, &half, &self.w);
                let solution = self.stage(&p, 0.5, &at_end, guess)?;
                self.u = plus(&p, &half, &self.w);
                Some(solution)
            }
            "backward_euler" => {
                let p = self.u.clone();
                let solution = self.stage(&p, 1.0, &at_end, guess)?;
                self.u = plus(&p, &k, &self.w);
                Some(solution)
            }
            "rectangle" => {
                let p = plus(&self.u, &k, &self.w);
                let solution = self.stage(&p, 0.0, &at_end, guess)?;
                self.u = p;
                Some(solution)
            }
            "tr_bdf2" => {
                // the weights as the doubles that stand in the tableau: their rounding is no error of a step
                let theta = Real::new(1.0 - std::f64::consts::FRAC_1_SQRT_2);
                let outer = Real::new(0.5 * std::f64::consts::FRAC_1_SQRT_2);
                let first = self.w.clone();
                let p = plus(&self.u, &(&theta * &k), &first);
                let between = loads_at(&self.case, &(&theta * &two));
                self.stage(&p, 1.0 - std::f64::consts::FRAC_1_SQRT_2, &between, middle)?;
                let p = plus(&self.u, &(&outer * &k), &first);
                let p = plus(&p, &(&outer * &k), &self.w);
                let solution =
                    self.stage(&p, 1.0 - std::f64::consts::FRAC_1_SQRT_2, &at_end, guess)?;
                self.u = plus(&p, &(&theta * &k), &self.w);
                Some(solution)
            }
            other => unreachable!("{other}"),
        }
    }

    /// `M w + E Lambda = F f - B p`, `M = A + theta k B`; the velocity goes into `w`.
    fn stage(&mut self, p: &[Real], theta: f64, loads: &[Real], guess: &[f64]) -> Option<Solution> {
        let at = self.operator(theta)?;
        let start = self.body.contact_start();
        let mut force: Vec<Real> = self.body.b.iter().map(|row| -&dot(row, p)).collect();
        for (column, load) in self.body.loads.iter().zip(loads) {
            for (f, x) in force.iter_mut().zip(column) {
                *f = &*f + &(x * load);
            }
        }
        let operator = &self.operators[at];
        let right: Matrix = force.iter().map(|f| vec![f.clone()]).collect();
        let free = solve(operator.matrix.clone(), right)?;
        let free: Vec<Real> = free.into_iter().map(|mut row| row.remove(0)).collect();
        let r = operator
            .s
            .iter()
            .map(|row| dot(row, &free[start..]))
            .collect();
        let problem = Problem {
            s: operator.s.clone(),
            r,
            weights: self.body.weights.clone(),
            components: self.body.components,
            law: self.case.law,
        };
        let solution = problem.solve(guess)?;
        // the friction force y on the body moves it from the free velocity
        for (i, (free, column)) in free.iter().zip(&operator.columns).enumerate() {
            self.w[i] = free + &dot(column, &solution.y);
        }
        for (i, w) in solution.w.iter().enumerate() {
            self.w[start + i] = w.clone();
        }
        Some(solution)
    }

    /// The operator of an implicit weight, condensed once.
    fn operator(&mut self, theta: f64) -> Option<usize> {
        if let Some(at) = self.operators.iter().position(|o| o.theta_k == theta) {
            return Some(at);
        }
        let weight = &Real::new(theta) * &self.time_step;
        let n = self.body.free();
        let start = self.body.contact_start();
        let matrix: Matrix = (0..n)
            .map(|i| {
                (0..n)
                    .map(|j| &self.body.a[i][j] + &(&weight * &self.body.b[i][j]))
                    .collect()
            })
            .collect();
        let mut unit = zeros(n, n - start);
        for j in start..n {
            unit[j][j - start] = Real::new(1.0);
        }
        let columns = solve(matrix.clone(), unit)?;
        let compliance = columns[start..].to_vec();
        let mut identity = zeros(n - start, n - start);
        for (i, row) in identity.iter_mut().enumerate() {
            row[i] = Real::new(1.0);
        }
        let s = solve(compliance, identity)?;
        self.operators.push(Condensed {
            theta_k: theta,
            s,
            columns,
            matrix,
        });
        Some(self.operators.len() - 1)
    }

    fn seen(&self, solution: &Solution, order: &[usize]) -> Exact {
        let c = self.body.components;
        let m = order.len();
        let mut exact = Exact {
            rates: vec![0.0; m],
            stress: vec![0.0; m],
            rate_per_residual: solution.rate_per_residual,
            stress_per_residual: vec![0.0; m],
        };
        for (i, &at) in order.iter().enumerate() {
            let weight = &self.body.weights[i / c];
            exact.rates[at] = solution.w[i].double();
            exact.stress[at] = (&solution.y[i] / weight).double();
            exact.stress_per_residual[at] = solution.force_per_residual[i] / weight.double();
        }
        exact
    }
}

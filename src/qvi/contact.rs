//! The contact of a body as an inequality of the class.
//!
//! ```text
//! strong form   sigma = A eps(w) + B eps(u),  u = u0 + int w,  |sigma_tau| <= g(|w_tau|, s),  s = int q |w_tau|
//! inequality    (A w, v - w) + (B S_1 w, v - w) + sum_i omega_i g(|w_i|, (S_2 w)_i) (|v_i| - |w_i|) >= (f, v - w)
//! ```
//!
//! X are the velocities of the free components with the inner product of the strains, `S_1 w = u0 + int w` the displacement, `S_2 w`
//! the accumulated slip, or what the kernel of the law remembers of it (iota is `|w_tau|` at every contact node), phi is B, j the friction with nodal
//! quadrature (one S_2 per contact), K the whole space: the normal components of contact nodes have no number.
//!
//! A material with memory has one more history per branch, `S_j w = int exp(-(t-s)/tau_j) w`, and `C_j S_j w` in phi.
//!
//! The trapezoid on these histories is the component's own scheme, so both give the same trajectory to the tolerances of their solvers; the
//! tests compare them. Branches of a material take the relaxation rule and kernels of slip the mean rule, as the component does.

use super::functional::{Coefficients, LinearPhi, Part};
use super::{
    ExponentialTerm, HistoryOperator, Inequality, Integrand, Kernel, Matrix, Quadrature,
    SolveError, Space, SparseSymmetric,
};
use crate::contact::bounds::Bounds;
use crate::contact::evaluation::SlipPath;
use crate::contact::law::SlipKernel;
use crate::fem::StrainNorm;
use crate::model::Compilation;
use crate::scene::Scheme;
use nalgebra::DVector;
use std::ops::Range;
use std::sync::Arc;

/// Components of the contact nodes among the unknowns.
fn nodes(compilation: &Compilation) -> Vec<Range<usize>> {
    let contact = &compilation.body.contact;
    let first = compilation.body.dofs.contact_start();
    let of_node = |node: usize| first + node * contact.components;
    let all = 0..contact.node_count();
    all.map(|node| of_node(node)..of_node(node + 1)).collect()
}

/// The inequality of a compiled scene, whose loads have the intensities `load(t)` (one per load of the scene, Pa or N/m^3).
/// Unknowns are the velocities of the free components, in the order of `Compilation::body`; contact components are the last ones.
///
/// # Errors
/// [`SolveError::Scene`] for what is not of this form: contact with normal components (pressure, gaps), driven parts, foundations
/// that move, materials that are not linear, friction laws with a state of their own; memory of materials or slip under another scheme than the trapezoid.
pub fn of_scene(
    compilation: &Compilation,
    load: impl Fn(f64) -> Vec<f64> + 'static,
) -> Result<Inequality, SolveError> {
    let (model, body) = (Arc::clone(&compilation.model), &compilation.body);
    let branches = &body.operators.memory;
    let has_memory = !branches.is_empty() || model.friction().slip_memory_len() > 0;
    let refused = [
        (body.contact.has_normal, "contact with normal components"),
        (!body.drives.shapes.is_empty(), "driven parts"),
        (body.is_nonlinear, "a material that is not linear"),
        (!body.foundation.is_empty(), "a foundation that moves"),
        (model.friction().has_memory(), "a friction law with a state"),
        (
            has_memory && model.scene().scheme() != Scheme::Trapezoid,
            "memory under a scheme that is not the trapezoid",
        ),
    ];
    if let Some((_, what)) = refused.into_iter().find(|(is_there, _)| *is_there) {
        return Err(SolveError::Scene { what });
    }
    let n = body.len();
    let pattern = Arc::new(body.operators.clone());
    let on_pattern =
        |values: Vec<f64>| SparseSymmetric::on(Arc::clone(&pattern), values).map(Matrix::Sparse);
    let a = on_pattern(pattern.a.clone())?;
    let b = on_pattern(pattern.b.clone())?;
    let strains = match &body.strain {
        StrainNorm::Combination(x, y) => {
            let mut values = vec![0.0; pattern.a.len()];
            pattern.combine(*x, *y, &mut values);
            values
        }
        StrainNorm::Assembled(values) => values.clone(),
    };
    let columns: Vec<_> = body.loads.iter().map(|load| load.entries.clone()).collect();
    let force = move |t: f64| {
        let mut force = DVector::zeros(n);
        for (column, intensity) in columns.iter().zip(load(t)) {
            for (component, value) in column {
                force[*component] += intensity * value;
            }
        }
        force
    };
    let mut problem = Inequality::new(Space::with_product(on_pattern(strains)?)?, a, force);
    let start = match &body.initial {
        Some(initial) => DVector::from_column_slice(&initial.field),
        None => DVector::zeros(n),
    };
    let nodes = nodes(compilation);
    let contacts = model.friction().parts();
    problem.histories = vec![HistoryOperator::new(Kernel::constant(1.0), start)];
    for part in contacts {
        let own = nodes[part.nodes.clone()].to_vec();
        problem.histories.push(slip(part.law.kernel(), own));
    }
    let mut matrices = vec![Some(b)];
    matrices.extend(contacts.iter().map(|_| None));
    for branch in branches {
        let history = HistoryOperator::new(Kernel::exponential(branch.tau), DVector::zeros(n));
        problem.histories.push(HistoryOperator {
            rule: Some(Quadrature::Relaxation),
            ..history
        });
        matrices.push(Some(on_pattern(branch.c.clone())?));
    }
    problem.phi = Box::new(LinearPhi(matrices));
    problem.parts = nodes.iter().cloned().map(Part::friction).collect();
    let certificate = model.certificate();
    let beta = certificate.c0_squared * certificate.l_g;
    let bounds = move |at: &[DVector<f64>], coefficients: &mut [f64]| {
        // w and its histories: displacement, slip of every contact
        let (w, slips) = (&at[0], &at[2..]);
        let friction = model.friction();
        let law = friction.with(friction.start());
        for (part, slip) in friction.parts().iter().zip(slips) {
            for (node, slip) in part.nodes.clone().zip(slip.iter()) {
                let path = SlipPath {
                    base: *slip,
                    per_rate: 0.0,
                };
                let rate = length(w, &nodes[node]);
                let bound = law.evaluate(node, rate, path).bound;
                coefficients[node] += model.contact().weights[node] * bound;
            }
        }
    };
    problem.j = Box::new(Coefficients::new(beta, bounds));
    Ok(problem)
}

/// The slip of the contact nodes, as the kernel of the law remembers it where there is one.
fn slip(of_law: &SlipKernel, nodes: Vec<Range<usize>>) -> HistoryOperator {
    let terms = of_law.terms().iter().map(|term| ExponentialTerm {
        weight: term.weight,
        tau: term.tau,
    });
    let (kernel, rule) = match of_law.is_empty() {
        true => (Kernel::constant(1.0), None),
        false => (
            Kernel::Exponentials(terms.collect()),
            Some(Quadrature::Mean),
        ),
    };
    let count = nodes.len();
    HistoryOperator {
        integrand: Integrand::Map {
            dimension: count,
            // of the Euclidean norm; that of the strains has the trace constant in it
            lipschitz: 1.0,
            of: Box::new(move |w| DVector::from_fn(count, |node, _| length(w, &nodes[node]))),
        },
        rule,
        ..HistoryOperator::new(kernel, DVector::zeros(count))
    }
}

fn length(w: &DVector<f64>, components: &Range<usize>) -> f64 {
    match components.len() {
        1 => w[components.start].abs(),
        _ => w.rows(components.start, components.len()).norm(),
    }
}

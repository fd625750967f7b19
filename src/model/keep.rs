//! Which model of a body is kept, and how its field comes back.

use super::free::blend_of;
use super::memory::{Sizes, ensure_available};
use crate::body::BodyModel;
use crate::body::condensed::Condensed;
use crate::body::digits::Ends;
use crate::body::field::Field;
use crate::body::free::Free;
use crate::body::full::Full;
use crate::body::reduced::Reduced;
use crate::body::reduction::port_matrix::PortMatrix;
use crate::body::reduction::transfer::Sampler;
use crate::body::reduction::{Reduction, Synthesis, bounded, reduce};
use crate::error::{Error, Result};
use crate::fem::{Body, StrainNorm};
use crate::linalg::SparseCholesky;
use crate::material::{RATIOS, Share};
use crate::progress::Watch;
use crate::refusal::scene_error;
use crate::scene::{ModelKind, Scene};
use crate::time::scheme::Tableau;
use std::sync::Arc;

/// Smallest internal step, in largest ones, that the reduction of a body without dashpot is judged for.
const SMALLEST_STEP: f64 = 0.01;

/// The model that is kept; a reduced one also serves the certificate.
pub(super) enum KeptModel {
    Reduced(Arc<Reduced>),
    Free(Arc<Free>),
    Whole(Arc<dyn BodyModel>),
}

impl KeptModel {
    pub fn shared(&self) -> Arc<dyn BodyModel> {
        match self {
            KeptModel::Reduced(reduced) => Arc::clone(reduced) as Arc<dyn BodyModel>,
            KeptModel::Free(free) => Arc::clone(free) as Arc<dyn BodyModel>,
            KeptModel::Whole(whole) => Arc::clone(whole),
        }
    }
}

/// What is kept of the body, and how its field comes back.
pub(super) struct Kept {
    pub kind: ModelKind,
    pub model: KeptModel,
    pub reduction: Option<crate::body::reduction::ReductionRecord>,
    pub synthesis: Option<Synthesis>,
    /// The body whose operators the field comes back from, where they are not those of the scene.
    pub ends: Option<Box<Body>>,
    /// Why `auto` kept the whole mesh.
    pub fallback: Option<String>,
    /// Relative error by rounding.
    pub lost_digits: f64,
}

/// Decides what is kept. Whatever it is, the body is judged first, by the same numbers: a scene of which too little survives
/// is refused with every model.
pub(super) fn keep(
    scene: &Scene,
    body: &Body,
    cholesky: &SparseCholesky,
    sizes: &Sizes,
    watch: &mut Watch,
) -> Result<Kept> {
    if !body.contact.pins.is_empty() {
        return keep_pinned(scene, body);
    }
    if scene.fidelity.free_material {
        return keep_free(scene, body, cholesky, sizes, watch);
    }
    let sigma = match body.forms.have_dashpots() {
        true => 0.0,
        false => SMALLEST_STEP * Tableau::of(scene.scheme()).theta() * scene.time.step,
    };
    let [slowest, fastest] = body.element_rates.map(|rate| bounded(rate, sigma));
    let reference_rate = (slowest * fastest).sqrt();
    let ports = PortMatrix::new(body);
    let mut sampler = Sampler::new(&ports, &body.operators, cholesky, (reference_rate, sigma));
    let ends = Ends::new(&mut sampler, body)?;
    ends.check(scene.fidelity.tolerance)?;
    let whole = |kind, model, fallback| Kept {
        kind,
        model: KeptModel::Whole(model),
        reduction: None,
        synthesis: None,
        ends: None,
        fallback,
        lost_digits: ends.lost_digits,
    };
    let condensed = |fallback| -> Result<Kept> {
        let model = Arc::new(Condensed(Field::new(scene, body)?));
        Ok(whole(ModelKind::Condensed, model, fallback))
    };
    let reduced = |mut reduction: Reduction| -> Result<Kept> {
        if let (StrainNorm::Assembled(values), true) =
            (&body.strain, scene.fidelity.solver.measures_strains())
        {
            let numbers = 2 * body.len() * reduction.reduced.rates.len();
            ensure_available("the strain norm of a reduced model", 8 * numbers)?;
            let gram = reduction.synthesis.gram(body, cholesky, values)?;
            reduction.reduced.strain = Some(gram);
        }
        Ok(Kept {
            kind: ModelKind::Reduced,
            model: KeptModel::Reduced(Arc::new(reduction.reduced)),
            reduction: Some(reduction.record),
            synthesis: Some(reduction.synthesis),
            ends: None,
            fallback: None,
            lost_digits: ends.lost_digits,
        })
    };
    let mut reduction = || {
        sizes.check_reduction(scene)?;
        reduce(body, &mut sampler, &ends, &scene.fidelity, watch)
    };
    match scene.fidelity.model {
        ModelKind::Full => {
            let model = Arc::new(Full(Field::new(scene, body)?));
            Ok(whole(ModelKind::Full, model, None))
        }
        ModelKind::Condensed => condensed(None),
        ModelKind::Reduced => reduced(reduction()?),
        ModelKind::Auto if body.is_nonlinear => condensed(Some(
            "a reduced model is made of the modes of a linear body, and a law of the scene is not linear".to_owned(),
        )),
        ModelKind::Auto => match reduction() {
            Ok(found) => match dearer_step(&found, body, cholesky) {
                None => reduced(found),
                Some(why) => condensed(Some(why)),
            },
            Err(Error::Cancelled { phase }) => Err(Error::Cancelled { phase }),
            // the whole mesh needs no reduction, whatever is wrong with it
            Err(error) => condensed(Some(error.to_string())),
        },
    }
}

/// The modes that all materials of the body share: of the pair of operators at both ends of the ratios.
fn keep_free(
    scene: &Scene,
    body: &Body,
    cholesky: &SparseCholesky,
    sizes: &Sizes,
    watch: &mut Watch,
) -> Result<Kept> {
    sizes.check_reduction(scene)?;
    let both = Box::new(body.of_forms(RATIOS.map(Share::end)));
    let [slowest, fastest] = both.element_rates;
    let ports = PortMatrix::new(&both);
    let reference = ((slowest * fastest).sqrt(), 0.0);
    let mut sampler = Sampler::new(&ports, &both.operators, cholesky, reference);
    let ends = Ends::new(&mut sampler, &both)?;
    ends.check(scene.fidelity.tolerance)?;
    let reduction = reduce(&both, &mut sampler, &ends, &scene.fidelity, watch)?;
    let Some(blend) = blend_of(scene, None) else {
        return Err(Error::Body {
            what: "the material does not stay free".to_owned(),
        });
    };
    Ok(Kept {
        kind: ModelKind::Reduced,
        model: KeptModel::Free(Arc::new(Free::new(reduction.reduced, &blend))),
        reduction: Some(reduction.record),
        synthesis: Some(reduction.synthesis),
        fallback: None,
        lost_digits: ends.lost_digits,
        ends: Some(both),
    })
}

/// What is kept of a body that contact alone holds: it has no static response, so nothing is reduced, and no digits are estimated.
fn keep_pinned(scene: &Scene, body: &Body) -> Result<Kept> {
    let why =
        "contact alone holds the body along its normal, and what is reduced is a body that is held";
    if scene.fidelity.free_material {
        let found = format!("true although {why}");
        let allowed = "false; or clamped or driven parts that hold the body";
        return Err(scene_error(
            "fidelity.free_material",
            found,
            allowed.to_owned(),
        ));
    }
    let field = || Field::new(scene, body);
    let (kind, model, fallback): (_, Arc<dyn BodyModel>, _) = match scene.fidelity.model {
        ModelKind::Full => (ModelKind::Full, Arc::new(Full(field()?)), None),
        ModelKind::Condensed => (ModelKind::Condensed, Arc::new(Condensed(field()?)), None),
        ModelKind::Auto => {
            let why = Some(why.to_owned());
            (ModelKind::Condensed, Arc::new(Condensed(field()?)), why)
        }
        ModelKind::Reduced => {
            let found = format!("\"reduced\" although {why}");
            let allowed = "auto, condensed or full; or clamped or driven parts that hold the body";
            return Err(scene_error("fidelity.model", found, allowed.to_owned()));
        }
    };
    Ok(Kept {
        kind,
        model: KeptModel::Whole(model),
        reduction: None,
        synthesis: None,
        ends: None,
        fallback,
        lost_digits: 0.0,
    })
}

/// Compares the multiplications of a step: two passes over the port matrix, or over the factor and once over B. `None` where
/// the reduced model takes fewer.
fn dearer_step(reduction: &Reduction, body: &Body, cholesky: &SparseCholesky) -> Option<String> {
    let reduced = &reduction.reduced;
    let ports = reduced.contact.ncols() + reduced.outputs.ncols();
    let of_reduced = 2 * ports * reduced.rates.len();
    let applied = body.operators.row_idx.len() * (1 + body.operators.memory.len());
    let of_condensed = 2 * (cholesky.len() + applied);
    (of_reduced >= of_condensed).then(|| {
        format!(
            "a step of the reduced model takes {of_reduced} multiplications, one of the condensed model {of_condensed}"
        )
    })
}

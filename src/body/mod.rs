//! What a step sees of the body: predict its free motion, the contact operator of a step size, correct.
//!
//! One implicit stage with weight `theta_k` (s) is `M w + E Lambda = F f - B p`, `M = A + theta_k B`, `u = p + theta_k w`:
//!
//! * [`BodyModel::factor`] makes what depends on `theta_k` alone, among it the condensed operator `S = (E^T M^-1 E)^-1`;
//! * [`BodyModel::predict`] gives the condensed load `r = S E^T M^-1 (F f - B p)`;
//! * the friction solver finds `S w_c + Lambda = r`;
//! * [`BodyModel::correct`] gives the whole velocity `w`.
//!
//! The meaning of a state vector (nodal or modal) is the model's own. Where materials have memory, it holds the strains of the
//! branches too: the whole is the pencil `A_ext z' + B_ext z = F`, `z = (u, q_1, ...)`, with
//! `A_ext = diag(A, tau_j C_j)`, `B_ext = [[B + sum C_j, -C_j], [-C_j, C_j]]`, of which M, S and r above are what is left once the
//! branches are eliminated. Everything else of a step (integration in time, energies, step control, tangents) treats it as one
//! body.

pub(crate) mod condensed;
pub(crate) mod digits;
pub(crate) mod field;
pub(crate) mod free;
pub(crate) mod full;
pub(crate) mod nonlinear;
pub(crate) mod reduced;
pub(crate) mod reduction;

use crate::bytes::Writer;
use crate::error::{Error, Result};
use crate::fem::Pin;
use crate::linalg::{DenseCholesky, StoredMatrix};
use dyn_stack::{MemBuffer, StackReq};
use faer::{Mat, MatRef};
use nonlinear::Nonlinear;

/// Everything that depends on the implicit weight of a stage alone, and, where laws are not linear, on the point of their tangents.
pub struct Stage {
    /// Implicit weight, s; `None` before the first factorization.
    pub theta_k: Option<f64>,
    /// Condensed contact operator S, N s/m, with the pins of the contact.
    pub s: Mat<f64>,
    /// S without them; empty where there are none.
    unpinned: Mat<f64>,
    /// Factor of `M`, in a layout that the body model alone knows.
    pub factor: Vec<f64>,
    /// Diagonal of `S^-1`, m/(N s), where it is asked for.
    pub yielding: Vec<f64>,
    /// Entries of the tangents that M has beyond `A + theta_k B`, and their point; empty for linear laws.
    pub tangent: Vec<f64>,
    pub point: Vec<f64>,
    /// Tells apart all factorizations of a cache.
    pub version: u64,
}

/// Scratch of one simulator; never changes a result.
pub struct Scratch {
    /// Free motion between predict and correct.
    pub free: Vec<f64>,
    /// Vector of the length of a state; for the whole mesh that of its displacement.
    pub work: Vec<f64>,
    /// Explicit lags `p - p_j` of the branches of the memory between predict and correct, one after the other.
    pub lags: Vec<f64>,
    /// Vector of contact length.
    pub contact: Vec<f64>,
    /// Values of a sparse matrix, or a contact compliance.
    pub matrix: Vec<f64>,
    /// Dense factor of contact order.
    pub dense: DenseCholesky,
    /// Scratch of the sparse factorization and solves.
    pub memory: MemBuffer,
    /// Force on the body beyond those of the linear operators and the loads in the next prediction, N; empty for linear laws.
    pub excess: Vec<f64>,
    /// A velocity and a displacement at which laws are linearised; empty for linear laws.
    pub fields: [Vec<f64>; 2],
    /// Matrices of contact order and of right-hand sides, kept where factorizations may not allocate; empty elsewhere.
    pub square: Mat<f64>,
    pub columns: Mat<f64>,
}

impl Scratch {
    /// Of a model of so many modes.
    fn of_modes(contact_len: usize, modes: usize) -> Scratch {
        Scratch {
            free: vec![0.0; modes],
            work: Vec::new(),
            lags: Vec::new(),
            contact: vec![0.0; contact_len],
            matrix: vec![0.0; contact_len * contact_len],
            dense: DenseCholesky::new(contact_len),
            memory: MemBuffer::new(StackReq::EMPTY),
            excess: Vec::new(),
            fields: [Vec::new(), Vec::new()],
            square: Mat::new(),
            columns: Mat::new(),
        }
    }

    /// S from the contact compliance of such a model, `P diag(factor) P^T` with its contact velocities P.
    ///
    /// # Errors
    /// [`Error::NotPositiveDefinite`] for a compliance that is not.
    fn condense(&mut self, contact: &StoredMatrix, stage: &mut Stage) -> Result<()> {
        let m = self.contact.len();
        contact.weighted_gram(&stage.factor, &mut self.matrix);
        let compliance = &self.matrix;
        if !self.dense.factor(m, |j, column| {
            column.copy_from_slice(&compliance[j * m + j..(j + 1) * m]);
        }) {
            return Err(Error::NotPositiveDefinite {
                what: "the contact compliance",
                pivot: 0,
            });
        }
        self.dense.inverse(stage.s.as_mut());
        Ok(())
    }
}

/// A reduced body in modal coordinates, in which the viscosity A is the identity and the elasticity B the diagonal of `rates`.
#[derive(Debug, Clone, PartialEq)]
pub struct ModalMatrices {
    /// Relaxation rates, 1/s, ascending.
    pub rates: Vec<f64>,
    /// Contact velocities of every mode: states x contact components, row by row; node by node, tangential components, then the
    /// normal one where it is kept.
    pub contact: Vec<f64>,
    /// Work-conjugate integrals of every mode: states x outputs, row by row; loads, driven directions, then probes.
    pub outputs: Vec<f64>,
}

/// A body reduced to what a scene requires.
pub trait BodyModel: Send + Sync {
    /// Length of a displacement or velocity, with those of the branches of the memory.
    fn states(&self) -> usize;
    /// Tangential contact velocities: nodes times components.
    fn contact_len(&self) -> usize;
    /// Length of [`Stage::factor`].
    fn factor_len(&self) -> usize;
    /// Length of [`Stage::tangent`].
    fn tangent_len(&self) -> usize {
        0
    }
    /// Fresh scratch.
    fn scratch(&self) -> Scratch;
    /// Makes `stage` for the implicit weight `theta_k`.
    ///
    /// # Errors
    /// [`crate::Error::NotPositiveDefinite`] when the body is not held.
    fn factor(&self, theta_k: f64, stage: &mut Stage, scratch: &mut Scratch) -> Result<()>;
    /// Condensed load `r` of the free motion from the explicit displacement `p` under the loads `f`; the free motion
    /// itself stays in `scratch.free`.
    fn predict(&self, stage: &Stage, p: &[f64], f: &[f64], r: &mut [f64], scratch: &mut Scratch);
    /// Velocity `w` of the body from the free motion, the contact velocities and the contact forces.
    fn correct(
        &self,
        stage: &Stage,
        contact_velocity: &[f64],
        contact_force: &[f64],
        w: &mut [f64],
        scratch: &mut Scratch,
    );
    /// The cells whose laws are not linear; `None` where there are none.
    fn nonlinear(&self) -> Option<&Nonlinear> {
        None
    }
    /// `A x` or `B x`, of the lower tangents, into `y`; nothing for a model that has no nonlinear laws.
    fn apply(&self, _which: usize, _x: &[f64], _y: &mut [f64]) {}
    /// `y = T x` for the tangent of a stage; nothing for a model that has no nonlinear laws.
    fn apply_tangent(&self, _stage: &Stage, _x: &[f64], _y: &mut [f64]) {}
    /// `y = M x` for the matrix of a stage; nothing for a model that has no nonlinear laws.
    fn apply_stage(&self, _stage: &Stage, _x: &[f64], _y: &mut [f64], _scratch: &mut Scratch) {}
    /// `(x.A x, x.B x)`.
    fn products(&self, x: &[f64]) -> (f64, f64);
    /// The square of `|eps(x)|` in L2, for a body of several materials, whose strain norm no combination of A and B is.
    fn strain_square(&self, x: &[f64]) -> f64;
    /// Norm `(w.B w)^1/2` of the motion without contact forces, after [`BodyModel::predict`], where [`BodyModel::correct`] subtracts
    /// that of the forces from it; 0 where the one is not a difference of the others.
    fn cancelled_norm(&self, scratch: &Scratch) -> f64;
    /// Linear outputs of a displacement or velocity: work-conjugate integrals of the loads, then the probes.
    fn outputs(&self, x: &[f64], out: &mut [f64]);
    /// Multiplications of one [`BodyModel::predict`] and one [`BodyModel::correct`].
    fn stage_multiplications(&self) -> usize;
    /// The matrices of a reduced body; `None` for one that is kept whole.
    fn matrices(&self) -> Option<ModalMatrices> {
        None
    }
    /// Bytes held by the model.
    fn bytes(&self) -> usize;
    /// Writes what the model's own `read` needs.
    fn write(&self, out: &mut Writer);
}

impl Stage {
    /// An empty stage for `model`, with the diagonal of the compliance or without.
    pub fn new(model: &dyn BodyModel, has_yielding: bool) -> Stage {
        Stage {
            theta_k: None,
            s: Mat::zeros(model.contact_len(), model.contact_len()),
            unpinned: Mat::new(),
            factor: vec![0.0; model.factor_len()],
            yielding: vec![0.0; if has_yielding { model.contact_len() } else { 0 }],
            tangent: vec![0.0; model.tangent_len()],
            point: vec![0.0; model.nonlinear().map_or(0, Nonlinear::point_len)],
            version: 0,
        }
    }
}

impl Stage {
    /// The contact operator of the body itself, N s/m.
    pub fn of_contact(&self) -> MatRef<'_, f64> {
        match self.unpinned.nrows() {
            0 => self.s.as_ref(),
            _ => self.unpinned.as_ref(),
        }
    }

    /// Makes S without the pins.
    fn remove_pins(&mut self, pins: &[Pin]) {
        if pins.is_empty() {
            return;
        }
        self.unpinned.copy_from(&self.s);
        for pin in pins {
            self.unpinned[(pin.component, pin.component)] -= pin.resistance;
        }
    }

    /// The implicit weight that it is being made for or has, s.
    fn implicit(&self) -> f64 {
        self.theta_k.unwrap_or_default()
    }

    /// Fills the diagonal of `S^-1`, where there is room for it.
    fn find_yielding(&mut self, scratch: &mut Scratch) -> Result<()> {
        let m = self.yielding.len();
        if m == 0 {
            return Ok(());
        }
        let s = self.s.as_ref();
        if !scratch.dense.factor(m, |j, column| {
            for (i, entry) in (j..).zip(column) {
                *entry = s[(i, j)];
            }
        }) {
            return Err(crate::Error::NotPositiveDefinite {
                what: "the condensed contact operator",
                pivot: 0,
            });
        }
        scratch.dense.prepare_solves();
        for (i, yielding) in self.yielding.iter_mut().enumerate() {
            *yielding = scratch.dense.inverse_diagonal(i);
        }
        Ok(())
    }
}

/// The stages of the last few step sizes; the one used longest ago makes room.
pub struct StageCache {
    stages: Vec<Stage>,
    last_use: Vec<u64>,
    pins: Vec<Pin>,
    clock: u64,
    current: usize,
    /// Factorizations made so far.
    pub factorizations: u64,
}

impl StageCache {
    /// Room for the stages of `sizes` step sizes, with the diagonal of the contact compliance or without, of a body with these pins.
    pub fn new(
        model: &dyn BodyModel,
        sizes: usize,
        has_yielding: bool,
        pins: &[Pin],
    ) -> StageCache {
        let stage = || {
            let mut stage = Stage::new(model, has_yielding);
            if !pins.is_empty() {
                stage.unpinned = stage.s.clone();
            }
            stage
        };
        StageCache {
            stages: (0..sizes).map(|_| stage()).collect(),
            pins: pins.to_vec(),
            last_use: vec![0; sizes],
            clock: 0,
            current: 0,
            factorizations: 0,
        }
    }

    /// The stage that was asked for last.
    pub fn current(&self) -> &Stage {
        &self.stages[self.current]
    }

    /// Times that a stage was asked for.
    pub fn solves(&self) -> u64 {
        self.clock
    }

    /// The stage for `theta_k`, factored now or earlier.
    ///
    /// # Errors
    /// Those of [`BodyModel::factor`].
    pub fn get(
        &mut self,
        model: &dyn BodyModel,
        theta_k: f64,
        scratch: &mut Scratch,
    ) -> Result<&Stage> {
        self.get_at(model, theta_k, &[], scratch)
    }

    /// The stage for `theta_k` with the tangents of the laws at a point, factored now or earlier.
    ///
    /// # Errors
    /// Those of [`BodyModel::factor`].
    pub fn get_at(
        &mut self,
        model: &dyn BodyModel,
        theta_k: f64,
        point: &[f64],
        scratch: &mut Scratch,
    ) -> Result<&Stage> {
        self.clock += 1;
        let same = |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits();
        let known = self.stages.iter().position(|s| {
            s.theta_k.is_some_and(|t| t.to_bits() == theta_k.to_bits())
                && s.point.iter().zip(point).all(same)
        });
        let slot = match known {
            Some(slot) => slot,
            None => {
                let oldest = (0..self.stages.len())
                    .min_by_key(|&i| self.last_use[i])
                    .unwrap_or(0);
                let stage = &mut self.stages[oldest];
                stage.theta_k = None;
                self.factorizations += 1;
                stage.version = self.factorizations;
                if let Some(nonlinear) = model.nonlinear() {
                    stage.point.copy_from_slice(point);
                    let [w, u] = &mut scratch.fields;
                    nonlinear.scatter(point, [w, u]);
                    nonlinear.tangent(theta_k, [w, u], &mut stage.tangent);
                }
                model.factor(theta_k, stage, scratch)?;
                stage.find_yielding(scratch)?;
                stage.remove_pins(&self.pins);
                stage.theta_k = Some(theta_k);
                oldest
            }
        };
        self.last_use[slot] = self.clock;
        self.current = slot;
        Ok(&self.stages[slot])
    }
}

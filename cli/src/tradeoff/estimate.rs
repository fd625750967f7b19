//! What a setting will cost before it is compiled, roughly: for the order of the measurements and to keep them within the
//! budget and the memory.

use stickslip::Scene;
use stickslip::scene::ModelKind;
use stickslip::simulator::course::Points;
use stickslip::time::scheme::Tableau;

/// Responses per contact component that a reduction puts together.
const RESPONSES: f64 = 8.0;
/// Memory that a setting may take, bytes: two are held while one of them is the reference.
pub const MEMORY: f64 = 1.2e9;
/// Stages of which a simulator keeps the contact operator, and copies of it elsewhere.
const OPERATORS: f64 = 12.0;

/// Cost of compiling and running a setting.
#[derive(Debug, Clone, Copy)]
pub struct Estimate {
    /// Multiplications of the compilation.
    pub setup: f64,
    /// Multiplications of the runs.
    pub runs: f64,
    /// Largest memory.
    pub bytes: f64,
}

impl Estimate {
    /// The estimate for a scene that is compiled once and run as often as `runs` says.
    pub fn of(scene: &Scene, runs: f64) -> Estimate {
        let (nodes, contact) = sizes(scene);
        let friction = 0.03 * contact.powi(3);
        let factorization = match scene.mesh.dimension() {
            Some(2) => 100.0 * nodes * nodes.sqrt(),
            _ => 70.0 * nodes * nodes,
        };
        let (setup, per_step, responses) = match scene.fidelity.model {
            ModelKind::Full | ModelKind::Condensed => (
                factorization + contact.powi(3),
                100.0 * nodes * nodes.ln() + friction,
                0.0,
            ),
            ModelKind::Reduced | ModelKind::Auto => (
                factorization + 500.0 * nodes * contact + 100.0 * contact.powi(3),
                20.0 * contact * contact + friction,
                RESPONSES * contact,
            ),
        };
        let operators = OPERATORS * contact * contact + 3.0 * responses * responses;
        Estimate {
            setup,
            runs: runs * steps(scene) * per_step,
            bytes: 8.0 * (factorization.powf(2.0 / 3.0) * 20.0 + operators),
        }
    }

    /// Multiplications in all.
    pub fn multiplications(&self) -> f64 {
        self.setup + self.runs
    }

    /// Both together.
    pub fn and(&self, other: &Estimate) -> Estimate {
        Estimate {
            setup: self.setup + other.setup,
            runs: self.runs + other.runs,
            bytes: self.bytes.max(other.bytes),
        }
    }

    /// Whether it fits the memory that a setting may take.
    pub fn has_room(&self) -> bool {
        self.bytes <= MEMORY
    }
}

/// Converts estimates into seconds by what was measured so far.
#[derive(Debug)]
pub struct Speed {
    spent: f64,
    multiplications: f64,
}

/// Seconds per multiplication before anything was measured.
const PRIOR: f64 = 1e-9;
/// Largest factor by which measurements lower it: small settings tell little about large ones.
const TRUST: f64 = 4.0;

impl Speed {
    pub fn unknown() -> Speed {
        Speed {
            spent: 0.0,
            multiplications: 0.0,
        }
    }

    pub fn learn(&mut self, estimate: &Estimate, seconds: f64) {
        self.spent += seconds;
        self.multiplications += estimate.multiplications();
    }

    /// Seconds that something will take.
    pub fn seconds(&self, estimate: &Estimate) -> f64 {
        let measured = match self.multiplications > 0.0 {
            true => self.spent / self.multiplications,
            false => PRIOR,
        };
        estimate.multiplications() * measured.max(PRIOR / TRUST)
    }
}

/// Stages of a run.
fn steps(scene: &Scene) -> f64 {
    let stages = Tableau::of(scene.time.scheme).stages().len() as f64;
    let points = Points::of(scene);
    stages * points.count as f64 * (points.step / scene.time.step).max(1.0)
}

/// Nodes of the mesh and tangential contact components.
fn sizes(scene: &Scene) -> (f64, f64) {
    let element = scene.element_table();
    let extent = element.and_then(|e| Some((e, scene.extent(e)?)));
    // a study takes generated meshes alone
    extent.map_or((0.0, 0.0), |(element, extent)| {
        let components = element.dimension - 1;
        (extent.nodes as f64, extent.contact * components as f64)
    })
}

//! The forms of A and B in every cell: those of its region, times factors where the law of the region varies over it; and
//! the branches of its memory.

use crate::error::Result;
use crate::material::{Form, Operators, rates_with_memory};
use crate::mesh::Mesh;
use crate::message::cut;
use crate::refusal::scene_error;
use crate::scene::Scene;
use std::borrow::Cow;

/// Viscosity A (Pa s) and elasticity B (Pa) in every cell of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Forms {
    /// Of every region, without its factors: for laws that are not linear those of their lower tangents.
    regions: Vec<[Form; 2]>,
    /// The same of the largest tangents.
    upper: Vec<[Form; 2]>,
    /// Region of every cell.
    cells: Vec<u32>,
    /// Factors of A and B in every cell; empty where all are 1.
    factors: Vec<[f64; 2]>,
    /// Relaxation times (s, ascending, no time twice) and forms (Pa) of the memory of every region.
    branches: Vec<Vec<(f64, Form)>>,
}

/// Smallest and largest factor of A, of B, and ratio of that of B to that of A, in a region.
#[derive(Debug, Clone, Copy)]
struct Spans {
    a: [f64; 2],
    b: [f64; 2],
    ratio: [f64; 2],
}

impl Forms {
    /// The forms of a scene on its mesh.
    ///
    /// # Errors
    /// [`crate::Error::Scene`] for a region without a material, a material without cells, or a factor of a law that is not positive
    /// in a cell.
    pub(super) fn new(scene: &Scene, mesh: &Mesh) -> Result<Forms> {
        let materials = scene.materials();
        let without_cells = |region: &str| mesh.regions.iter().all(|r| r != region);
        for material in &materials {
            if let Some(region) = material.region.filter(|region| without_cells(region)) {
                let found = format!("{:?}, a region without cells", cut(region));
                let allowed = format!("the regions {}", cut(&mesh.regions.join(", ")));
                return Err(scene_error(
                    &format!("{}.region", material.path),
                    found,
                    allowed,
                ));
            }
        }
        let of_region = |region: &String| {
            let is_its = |of: Option<&str>| of.is_none_or(|of| of == region);
            materials.iter().find(|m| is_its(m.region)).ok_or_else(|| {
                let found = format!("none for the region {:?}", cut(region));
                scene_error("materials", found, "a material for every region".to_owned())
            })
        };
        let by_region = mesh
            .regions
            .iter()
            .map(of_region)
            .collect::<Result<Vec<_>>>()?;
        let mut factors = Vec::new();
        if by_region.iter().any(|material| material.operators.varies()) {
            factors = vec![[1.0; 2]; mesh.cell_count()];
            for (region, material) in (0..).zip(&by_region) {
                let is_its = |cell: &usize| mesh.cell_regions[*cell] == region;
                let own: Vec<usize> = (0..mesh.cell_count()).filter(is_its).collect();
                let centroid = |cell: &usize| mesh.centroid(mesh.cell(*cell));
                let places: Vec<[f64; 3]> = own.iter().map(centroid).collect();
                let found = material.operators.factors(&places, &material.path);
                let [a, b] = found.map_err(|refusal| refusal.of("scene"))?;
                for (cell, factor) in own.into_iter().zip(a.into_iter().zip(b)) {
                    factors[cell] = factor.into();
                }
            }
        }
        Ok(Forms {
            regions: by_region.iter().map(|m| m.operators.forms()).collect(),
            branches: by_region.iter().map(|m| m.operators.branches()).collect(),
            upper: by_region
                .iter()
                .map(|m| m.operators.upper_forms())
                .collect(),
            cells: mesh.cell_regions.clone(),
            factors,
        })
    }

    /// The same two forms in every cell.
    pub fn uniform(mesh: &Mesh, forms: [Form; 2]) -> Forms {
        Forms {
            regions: vec![forms; mesh.regions.len()],
            upper: vec![forms; mesh.regions.len()],
            cells: mesh.cell_regions.clone(),
            factors: Vec::new(),
            branches: vec![Vec::new(); mesh.regions.len()],
        }
    }

    /// Those of one material that does not vary, without a mesh: for its constants and rates.
    pub(crate) fn of_material(operators: &Operators) -> Forms {
        Forms {
            regions: vec![operators.forms()],
            upper: vec![operators.upper_forms()],
            cells: Vec::new(),
            factors: Vec::new(),
            branches: vec![operators.branches()],
        }
    }

    /// Whether a region has memory.
    pub fn have_memory(&self) -> bool {
        self.branches.iter().any(|branches| !branches.is_empty())
    }

    /// Whether every region has a dashpot.
    pub fn have_dashpots(&self) -> bool {
        self.regions.iter().all(|[a, _]| *a != Form::ZERO)
    }

    /// Relaxation times of all branches, s, ascending; regions with the same time share it.
    pub(super) fn times(&self) -> Vec<f64> {
        let all = self.branches.iter().flatten();
        let mut times: Vec<f64> = all.map(|(tau, _)| *tau).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    }

    /// The forms of the branches of one or two relaxation times in the places of A and B; nothing in regions without them.
    pub(super) fn of_branches(&self, times: &[f64]) -> Forms {
        let form = |branches: &[(f64, Form)], tau: Option<&f64>| {
            let found = branches.iter().find(|(of, _)| Some(of) == tau);
            found.map_or(Form::ZERO, |(_, form)| *form)
        };
        let pair = |branches: &Vec<(f64, Form)>| {
            [form(branches, times.first()), form(branches, times.get(1))]
        };
        let regions: Vec<[Form; 2]> = self.branches.iter().map(pair).collect();
        Forms {
            upper: regions.clone(),
            regions,
            cells: self.cells.clone(),
            factors: Vec::new(),
            branches: vec![Vec::new(); self.regions.len()],
        }
    }

    /// Those of a cell.
    pub fn of(&self, cell: usize) -> Cow<'_, [Form; 2]> {
        let forms = &self.regions[self.cells[cell] as usize];
        match self.factors.get(cell) {
            None => Cow::Borrowed(forms),
            Some([a, b]) => Cow::Owned([forms[0].times(*a), forms[1].times(*b)]),
        }
    }

    /// The forms of all cells, where they are the same.
    pub(super) fn common(&self) -> Option<[Form; 2]> {
        match &self.regions[..] {
            _ if !self.factors.is_empty() => None,
            [first, others @ ..] if others.iter().all(|f| f == first) => Some(*first),
            _ => None,
        }
    }

    /// The forms of every region with what their factors span over its cells.
    fn spans(&self) -> impl Iterator<Item = (&[Form; 2], Spans)> {
        let start = match self.factors.is_empty() {
            true => [1.0, 1.0],
            false => [f64::INFINITY, 0.0],
        };
        let mut all = vec![
            Spans {
                a: start,
                b: start,
                ratio: start,
            };
            self.regions.len()
        ];
        for ([a, b], region) in self.factors.iter().zip(&self.cells) {
            let Spans {
                a: of_a,
                b: of_b,
                ratio,
            } = &mut all[*region as usize];
            for (value, [low, high]) in [(*a, of_a), (*b, of_b), (b / a, ratio)] {
                *low = low.min(value);
                *high = high.max(value);
            }
        }
        self.regions.iter().zip(all)
    }

    /// Factors of A and B in a cell.
    pub fn factors(&self, cell: usize) -> [f64; 2] {
        self.factors.get(cell).copied().unwrap_or([1.0; 2])
    }

    /// Smallest and largest relaxation rate over the cells, 1/s; the largest is infinite without a dashpot. Bounds, where a law
    /// beside memory varies or is not linear.
    pub fn rates(&self, dimension: usize) -> [f64; 2] {
        self.spans()
            .zip(&self.upper)
            .zip(&self.branches)
            .map(|((([a, b], spans), [upper_a, upper_b]), branches)| {
                let low = rates(&[*upper_a, *b], &spans, branches, dimension)[0];
                let high = rates(&[*a, *upper_b], &spans, branches, dimension)[1];
                [low, high]
            })
            .reduce(|x, y| [x[0].min(y[0]), x[1].max(y[1])])
            .unwrap_or([f64::NAN; 2])
    }

    /// Ellipticity and Lipschitz constant m_A and L_A of the viscosity (Pa s), and Lipschitz constant L_B of the elasticity with the
    /// springs of the memory (Pa), over the cells.
    pub fn constants(&self, dimension: usize) -> [f64; 3] {
        type Region<'a> = (
            ((&'a [Form; 2], Spans), &'a [Form; 2]),
            &'a Vec<(f64, Form)>,
        );
        let of_region = |((([a, _], spans), [upper_a, upper_b]), branches): Region| {
            // the springs of the memory resist at once
            let springs = branches.iter().map(|(_, c)| c.extremes(dimension)[1]);
            [
                a.extremes(dimension)[0] * spans.a[0],
                upper_a.extremes(dimension)[1] * spans.a[1],
                upper_b.extremes(dimension)[1] * spans.b[1] + springs.sum::<f64>(),
            ]
        };
        let all = self.spans().zip(&self.upper).zip(&self.branches);
        let all = all.map(of_region);
        all.fold([f64::INFINITY, 0.0, 0.0], |[m_a, l_a, l_b], [m, a, b]| {
            [m_a.min(m), l_a.max(a), l_b.max(b)]
        })
    }
}

/// Smallest and largest relaxation rate of a region, 1/s.
fn rates(
    [a, b]: &[Form; 2],
    spans: &Spans,
    branches: &[(f64, Form)],
    dimension: usize,
) -> [f64; 2] {
    if branches.is_empty() {
        if *a == Form::ZERO {
            return [f64::INFINITY; 2];
        }
        let [low, high] = Form::rates(a, b, dimension);
        return [low * spans.ratio[0], high * spans.ratio[1]];
    }
    // rates grow with the elasticity and fall with the viscosity
    let of = |of_a: f64, of_b: f64| {
        rates_with_memory(&a.times(of_a), &b.times(of_b), branches, dimension)
    };
    [of(spans.a[1], spans.b[0])[0], of(spans.a[0], spans.b[1])[1]]
}

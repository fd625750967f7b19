//! The forms of A and B in every cell: those of its region, times factors where the law of the region varies over it.

use crate::error::Result;
use crate::material::Form;
use crate::mesh::Mesh;
use crate::message::cut;
use crate::refusal::scene_error;
use crate::scene::Scene;
use std::borrow::Cow;

/// Viscosity A (Pa s) and elasticity B (Pa) in every cell of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Forms {
    /// Of every region, without its factors.
    regions: Vec<[Form; 2]>,
    /// Region of every cell.
    cells: Vec<u32>,
    /// Factors of A and B in every cell; empty where all are 1.
    factors: Vec<[f64; 2]>,
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
            cells: mesh.cell_regions.clone(),
            factors,
        })
    }

    /// The same two forms in every cell.
    pub fn uniform(mesh: &Mesh, forms: [Form; 2]) -> Forms {
        Forms {
            regions: vec![forms; mesh.regions.len()],
            cells: mesh.cell_regions.clone(),
            factors: Vec::new(),
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

    /// Smallest and largest relaxation rate over the cells, 1/s.
    pub fn rates(&self, dimension: usize) -> [f64; 2] {
        self.spans()
            .map(|([a, b], Spans { ratio, .. })| {
                let [low, high] = Form::rates(a, b, dimension);
                [low * ratio[0], high * ratio[1]]
            })
            .reduce(|x, y| [x[0].min(y[0]), x[1].max(y[1])])
            .unwrap_or([f64::NAN; 2])
    }

    /// Ellipticity constant m_A of the viscosity (Pa s) and Lipschitz constant L_B of the elasticity (Pa) over the cells.
    pub fn constants(&self, dimension: usize) -> [f64; 2] {
        let of_region = |([a, b], spans): (&[Form; 2], Spans)| {
            let (m_a, l_b) = (a.extremes(dimension)[0], b.extremes(dimension)[1]);
            [m_a * spans.a[0], l_b * spans.b[1]]
        };
        let all = self.spans().map(of_region);
        all.fold([f64::INFINITY, 0.0], |[m_a, l_b], [a, b]| {
            [m_a.min(a), l_b.max(b)]
        })
    }
}

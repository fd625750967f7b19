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
}

impl Forms {
    /// The forms of a scene on its mesh.
    ///
    /// # Errors
    /// [`crate::Error::Scene`] for a region without a material or a material without cells.
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
            let material = materials.iter().find(|m| is_its(m.region));
            material.map(|m| m.operators.forms()).ok_or_else(|| {
                let found = format!("none for the region {:?}", cut(region));
                scene_error("materials", found, "a material for every region".to_owned())
            })
        };
        let regions = mesh.regions.iter().map(of_region);
        Ok(Forms {
            regions: regions.collect::<Result<_>>()?,
            cells: mesh.cell_regions.clone(),
        })
    }

    /// The same two forms in every cell.
    pub fn uniform(mesh: &Mesh, forms: [Form; 2]) -> Forms {
        Forms {
            regions: vec![forms; mesh.regions.len()],
            cells: mesh.cell_regions.clone(),
        }
    }

    /// Those of a cell.
    pub fn of(&self, cell: usize) -> Cow<'_, [Form; 2]> {
        Cow::Borrowed(&self.regions[self.cells[cell] as usize])
    }

    /// The forms of all cells, where they are the same.
    pub(super) fn common(&self) -> Option<[Form; 2]> {
        match &self.regions[..] {
            [first, others @ ..] if others.iter().all(|f| f == first) => Some(*first),
            _ => None,
        }
    }

    /// Smallest and largest relaxation rate over the cells, 1/s.
    pub fn rates(&self, dimension: usize) -> [f64; 2] {
        self.regions
            .iter()
            .map(|[a, b]| Form::rates(a, b, dimension))
            .reduce(|x, y| [x[0].min(y[0]), x[1].max(y[1])])
            .unwrap_or([f64::NAN; 2])
    }

    /// Ellipticity constant m_A of the viscosity (Pa s) and Lipschitz constant L_B of the elasticity (Pa) over the cells.
    pub fn constants(&self, dimension: usize) -> [f64; 2] {
        let of_region = |[a, b]: &[Form; 2]| [a.extremes(dimension)[0], b.extremes(dimension)[1]];
        let all = self.regions.iter().map(of_region);
        all.fold([f64::INFINITY, 0.0], |[m_a, l_b], [a, b]| {
            [m_a.min(a), l_b.max(b)]
        })
    }
}

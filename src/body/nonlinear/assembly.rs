//! From a mesh to the cells whose laws are not linear.

use super::{Laws, Nonlinear, NonlinearCell, Unknown};
use crate::error::{Error, Result};
use crate::fem::{Body, Cell};
use crate::scene::Scene;

impl Nonlinear {
    /// The cells of a body; `None` where all laws are linear.
    ///
    /// # Errors
    /// [`Error::Body`] for a body of more pairs of unknowns than can be numbered.
    pub fn new(scene: &Scene, body: &Body) -> Result<Option<Nonlinear>> {
        let laws = laws(scene);
        if !bends(&laws) {
            return Ok(None);
        }
        let mesh = &body.mesh;
        let element = mesh.element;
        let points = match element.bent_points {
            [] => element.points.len(),
            bent => bent.len(),
        };
        let materials = scene.materials();
        let of_region = |region: &String| {
            let is_its = |of: Option<&str>| of.is_none_or(|of| of == region);
            materials.iter().position(|m| is_its(m.region)).unwrap_or(0)
        };
        let of_regions: Vec<usize> = mesh.regions.iter().map(of_region).collect();
        let mut made = Nonlinear {
            laws,
            cells: Vec::new(),
            unknowns: Vec::new(),
            axes: Vec::new(),
            points,
            nodes: element.nodes,
            weights: Vec::new(),
            gradients: Vec::new(),
            places: Vec::new(),
            touched: [Vec::new(), Vec::new()],
            len: body.len(),
            start: Vec::new(),
            start_potential: 0.0,
        };
        for (i, (cell, region)) in mesh.cells().zip(&mesh.cell_regions).enumerate() {
            let material = of_regions[*region as usize];
            if made.laws[material].iter().all(Option::is_none) {
                continue;
            }
            let first = made.unknowns.len();
            for (node, number) in cell.iter().enumerate() {
                let frame = body.dofs.frame(*number);
                for (dof, axis) in body.dofs.range(*number).zip(frame) {
                    let axis = made.axis(axis);
                    made.unknowns.push(Unknown {
                        dof: dof as u32,
                        node: node as u16,
                        axis,
                    });
                }
            }
            made.cells.push(NonlinearCell {
                material: material as u32,
                first: first as u32,
                pairs: 0,
                factors: body.forms.factors(i),
            });
            for (weight, gradients) in Cell::new(mesh, cell).bent_points() {
                made.weights.push(weight);
                let gradients = gradients.iter().take(element.nodes);
                made.gradients.extend(gradients.map(|g| [g.x, g.y, g.z]));
            }
        }
        let operators = &body.operators;
        if !made.find_places(&operators.col_ptr, &operators.row_idx) {
            return Err(Error::Body {
                what: "the cells of nonlinear laws do not fit the operators".into(),
            });
        }
        let start = body.initial.as_ref();
        made.set_start(start.map_or(Vec::new(), |start| start.field.clone()));
        Ok(Some(made))
    }

    /// The number of a direction, which is new or not.
    fn axis(&mut self, axis: &[f64; 3]) -> u32 {
        let recent = self.axes.iter().rev().take(8).position(|own| own == axis);
        let global = self.axes.iter().take(3).position(|own| own == axis);
        let known = global.or(recent.map(|back| self.axes.len() - 1 - back));
        let at = known.unwrap_or_else(|| {
            self.axes.push(*axis);
            self.axes.len() - 1
        });
        at as u32
    }

    /// Finds the entries of all pairs of unknowns, and the unknowns that the laws look at; false where the pattern does not have
    /// them.
    pub(super) fn find_places(&mut self, col_ptr: &[usize], row_idx: &[usize]) -> bool {
        if row_idx.len() > u32::MAX as usize {
            return false;
        }
        let count = self.cells.len();
        let mut places = Vec::new();
        for i in 0..count {
            let end = self.end(i);
            let cell = &mut self.cells[i];
            cell.pairs = places.len();
            let unknowns = &self.unknowns[cell.first as usize..end];
            for (i, row) in unknowns.iter().enumerate() {
                for column in &unknowns[..=i] {
                    let (high, low) = (row.dof.max(column.dof), row.dof.min(column.dof));
                    let from = col_ptr[low as usize];
                    let rows = &row_idx[from..col_ptr[low as usize + 1]];
                    match rows.binary_search(&(high as usize)) {
                        Ok(at) => places.push((from + at) as u32),
                        Err(_) => return false,
                    }
                }
            }
        }
        self.places = places;
        for which in 0..2 {
            let mut dofs = Vec::new();
            for (i, cell) in self.cells.iter().enumerate() {
                if self.laws[cell.material as usize][which].is_some() {
                    let unknowns = &self.unknowns[cell.first as usize..self.end(i)];
                    dofs.extend(unknowns.iter().map(|unknown| unknown.dof));
                }
            }
            dofs.sort_unstable();
            dofs.dedup();
            self.touched[which] = dofs;
        }
        true
    }

    /// Behind the last unknown of a cell.
    fn end(&self, cell: usize) -> usize {
        let next = self.cells.get(cell + 1);
        next.map_or(self.unknowns.len(), |next| next.first as usize)
    }
}

/// What the materials of a scene add to their forms.
pub(super) fn laws(scene: &Scene) -> Vec<Laws> {
    let materials = scene.materials().into_iter();
    materials.map(|m| m.operators.excesses()).collect()
}

/// Whether one of the laws is not linear.
pub(super) fn bends(laws: &[Laws]) -> bool {
    laws.iter().flatten().any(Option::is_some)
}

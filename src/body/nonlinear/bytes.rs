//! Bytes of the cells whose laws are not linear. The laws are those of the scene; the entries of pairs follow from the pattern.

use super::assembly::{bends, laws};
use super::{Nonlinear, NonlinearCell, Unknown};
use crate::bytes::{Reader, Writer, is_usable};
use crate::element::MOST_NODES;
use crate::error::Result;
use crate::scene::Scene;

/// Most points of integration of a cell.
const MOST_POINTS: usize = 64;

impl Nonlinear {
    pub fn write(&self, out: &mut Writer) {
        out.word(self.points as u64);
        out.word(self.nodes as u64);
        let firsts: Vec<usize> = self.cells.iter().map(|c| c.first as usize).collect();
        out.indices(&firsts);
        let of_cells =
            |of: fn(&NonlinearCell) -> usize| -> Vec<usize> { self.cells.iter().map(of).collect() };
        out.indices(&of_cells(|cell| cell.material as usize));
        let factors: Vec<f64> = self.cells.iter().flat_map(|cell| cell.factors).collect();
        out.floats(&factors);
        let of_unknowns =
            |of: fn(&Unknown) -> usize| -> Vec<usize> { self.unknowns.iter().map(of).collect() };
        out.indices(&of_unknowns(|unknown| unknown.dof as usize));
        out.indices(&of_unknowns(|unknown| usize::from(unknown.node)));
        out.indices(&of_unknowns(|unknown| unknown.axis as usize));
        out.floats(self.axes.as_flattened());
        out.floats(&self.weights);
        out.floats(self.gradients.as_flattened());
        out.floats(&self.start);
    }

    /// Reads what [`Nonlinear::write`] wrote, for the laws of a scene and the pattern of the operators; `None` where all laws are
    /// linear, and nothing was written.
    ///
    /// # Errors
    /// [`crate::Error::Bytes`].
    pub fn read(
        from: &mut Reader,
        scene: &Scene,
        col_ptr: &[usize],
        row_idx: &[usize],
    ) -> Result<Option<Nonlinear>> {
        let laws = laws(scene);
        if !bends(&laws) {
            return Ok(None);
        }
        let refusal = || Reader::refusal("the cells of nonlinear laws are none");
        let (points, nodes) = (from.size()?, from.size()?);
        let firsts = from.indices(u32::MAX as usize)?;
        let materials = from.indices(laws.len())?;
        let factors = from.finite()?;
        let dofs = from.indices(col_ptr.len() - 1)?;
        let of_nodes = from.indices(MOST_NODES)?;
        let of_axes = from.indices(u32::MAX as usize)?;
        let (axes, weights, gradients) = (from.finite()?, from.finite()?, from.finite()?);
        let start = from.finite()?;
        let len = col_ptr.len() - 1;
        let (cells, unknowns) = (firsts.len(), dofs.len());
        let is_consistent = points <= MOST_POINTS
            && nodes <= MOST_NODES
            && materials.len() == cells
            && factors.len() == 2 * cells
            && factors.iter().all(|f| *f > 0.0)
            && firsts.first().is_none_or(|first| *first == 0)
            && firsts.windows(2).all(|pair| pair[0] <= pair[1])
            && firsts.last().is_none_or(|last| *last <= unknowns)
            && of_nodes.len() == unknowns
            && of_nodes.iter().all(|node| *node < nodes)
            && of_axes.len() == unknowns
            && axes.len().is_multiple_of(3)
            && of_axes.iter().all(|axis| *axis < axes.len() / 3)
            && weights.len() == cells * points
            && weights.iter().all(|w| *w > 0.0 && is_usable(*w))
            && gradients.len() == 3 * weights.len() * nodes
            && (start.is_empty() || start.len() == len);
        if !is_consistent {
            return Err(refusal());
        }
        let vectors = |values: Vec<f64>| -> Vec<[f64; 3]> { values.as_chunks::<3>().0.to_vec() };
        let cell = |i: usize| NonlinearCell {
            material: materials[i] as u32,
            first: firsts[i] as u32,
            pairs: 0,
            factors: [factors[2 * i], factors[2 * i + 1]],
        };
        let unknown = |i: usize| Unknown {
            dof: dofs[i] as u32,
            node: of_nodes[i] as u16,
            axis: of_axes[i] as u32,
        };
        let mut read = Nonlinear {
            laws,
            cells: (0..cells).map(cell).collect(),
            unknowns: (0..unknowns).map(unknown).collect(),
            axes: vectors(axes),
            points,
            nodes,
            weights,
            gradients: vectors(gradients),
            places: Vec::new(),
            touched: [Vec::new(), Vec::new()],
            len,
            start: Vec::new(),
            start_potential: 0.0,
        };
        if !read.find_places(col_ptr, row_idx) {
            return Err(refusal());
        }
        read.set_start(start);
        Ok(Some(read))
    }
}

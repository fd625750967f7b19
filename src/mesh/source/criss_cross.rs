//! The criss-cross in the plane: the grid cells of a rectangle, each cut into four triangles by both diagonals.

use super::grid::Axis;
use super::lines::Lines;

/// Bits of the sides in the order left, right, bottom, top.
pub(super) const LEFT: u8 = 1;
pub(super) const RIGHT: u8 = 2;
pub(super) const BOTTOM: u8 = 4;
pub(super) const TOP: u8 = 8;

/// Names of the four sides, `None` along a periodic axis.
pub(super) fn side_names(periodic: &[Axis]) -> [Option<&'static str>; 4] {
    let free = |axis, name| (!periodic.contains(&axis)).then_some(name);
    [
        free(Axis::X, "left"),
        free(Axis::X, "right"),
        free(Axis::Y, "bottom"),
        free(Axis::Y, "top"),
    ]
}

/// The criss-cross in the plane, before the sides are named: also the base of the extruded box.
pub(super) struct CrissCross {
    pub nodes: Vec<[f64; 3]>,
    /// Triangles, counter-clockwise; the first two nodes are a side of the grid.
    pub triangles: Vec<[u32; 3]>,
    /// Sides on which each node lies (bits).
    pub sides: Vec<u8>,
    /// Node that each node follows.
    pub leader: Vec<u32>,
}

impl CrissCross {
    /// The counts fit 32 bits: checked by [`Grid`].
    pub fn new(x: &Lines, y: &Lines, periodic: &[Axis]) -> CrissCross {
        let (nx, ny) = (x.cells(), y.cells());
        let corner = |i: u32, j: u32| j * (nx + 1) + i;
        let corners = (nx + 1) * (ny + 1);
        let centre = |i: u32, j: u32| corners + j * nx + i;
        let count = (corners + nx * ny) as usize;
        let mut mesh = CrissCross {
            nodes: Vec::with_capacity(count),
            triangles: Vec::with_capacity(4 * (nx * ny) as usize),
            sides: Vec::with_capacity(count),
            leader: Vec::with_capacity(count),
        };
        for j in 0..=ny {
            for i in 0..=nx {
                mesh.nodes.push([x.at[i as usize], y.at[j as usize], 0.0]);
                let bit = |is_there: bool, side: u8| if is_there { side } else { 0 };
                mesh.sides.push(
                    bit(i == 0, LEFT)
                        | bit(i == nx, RIGHT)
                        | bit(j == 0, BOTTOM)
                        | bit(j == ny, TOP),
                );
                let i0 = if i == nx && periodic.contains(&Axis::X) {
                    0
                } else {
                    i
                };
                let j0 = if j == ny && periodic.contains(&Axis::Y) {
                    0
                } else {
                    j
                };
                mesh.leader.push(corner(i0, j0));
            }
        }
        for j in 0..ny {
            for i in 0..nx {
                let (x, y) = (x.middles[i as usize], y.middles[j as usize]);
                mesh.nodes.push([x, y, 0.0]);
                mesh.sides.push(0);
                let c = centre(i, j);
                mesh.leader.push(c);
                let square = [
                    corner(i, j),
                    corner(i + 1, j),
                    corner(i + 1, j + 1),
                    corner(i, j + 1),
                ];
                for s in 0..4 {
                    mesh.triangles.push([square[s], square[(s + 1) % 4], c]);
                }
            }
        }
        mesh
    }
}

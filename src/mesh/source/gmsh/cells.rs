//! Cells of a file in an order of their own: the mesh does not depend on who wrote the file, nor in which version.
//!
//! Coordinates are taken to 16 digits, which is what a text file has: a binary file then gives the same bits. Nodes of cells are
//! ordered by their coordinates, other nodes (centres of arcs) are dropped. Corners of a cell ascend, but for the last two,
//! which are exchanged where the cell would be mirrored; so a clockwise file gives the mesh of a counter-clockwise one. Cells
//! are ordered by their corners, regions by their names.

use super::contents::Contents;
use super::fault::{Fault, Outcome};
use super::found::{Found, collect, element_of, sorted_tags};
use super::names::Names;
use crate::element::Element;
use crate::message::{cut, number};

/// Share of the size of a body up to which a plane mesh may leave the plane z = 0.
const PLANE: f64 = 1e-9;
/// Share of the power of its longest edge below which a cell has no volume.
const FLAT: f64 = 1e-12;
/// Mark of a node that no cell has.
pub(super) const UNUSED: u32 = u32::MAX;

/// The cells of a body.
pub(super) struct Cells {
    pub element: &'static Element,
    /// Coordinates, m.
    pub nodes: Vec<[f64; 3]>,
    pub cell_nodes: Vec<u32>,
    pub regions: Vec<String>,
    pub cell_regions: Vec<u32>,
    /// Number of every node of the file, by its own number; ascending.
    numbers: Vec<(u64, u32)>,
}

impl Cells {
    /// The cells of a file, its coordinates times `scale`.
    pub fn new(contents: &Contents, names: &Names, scale: f64) -> Outcome<Cells> {
        let element = element_of(contents)?;
        let by_tag = sorted_tags(contents)?;
        let (found, regions) = collect(contents, names, element, &by_tag)?;
        let mut places: Vec<[f64; 3]> = Vec::with_capacity(contents.nodes.len());
        for (tag, place) in &contents.nodes {
            let place = place.map(|x| rounded(x) * scale);
            if !place.iter().all(|x| x.is_finite()) {
                let found = format!("$Nodes: node {tag} is at {place:?} m after mesh.scale");
                return Err(Fault::new(found, "finite coordinates"));
            }
            places.push(place);
        }
        let (number, order) = canonical_order(&found, &places);
        let mut nodes: Vec<[f64; 3]> = order.iter().map(|&at| places[at as usize]).collect();
        if element.dimension == 2 {
            flatten(&mut nodes, &order, contents)?;
        }
        let numbers = by_tag
            .iter()
            .map(|&(tag, at)| (tag, number[at as usize]))
            .collect();
        let mut cells = Cells {
            element,
            nodes,
            cell_nodes: Vec::with_capacity(found.nodes.len()),
            regions,
            cell_regions: Vec::with_capacity(found.regions.len()),
            numbers,
        };
        cells.arrange(&found, &number)?;
        Ok(cells)
    }

    /// Number of the node with this number in the file; `None` where no cell has it.
    pub fn number(&self, tag: u64) -> Option<u32> {
        let at = self
            .numbers
            .binary_search_by_key(&tag, |(tag, _)| *tag)
            .ok()?;
        Some(self.numbers[at].1).filter(|number| *number != UNUSED)
    }

    /// Turns every cell, then orders them.
    fn arrange(&mut self, found: &Found, number: &[u32]) -> Outcome<()> {
        let (n, corners) = (self.element.nodes, self.element.corners());
        let mut turned: Vec<u32> = Vec::with_capacity(found.nodes.len());
        for (cell, tag) in found.nodes.chunks_exact(n).zip(&found.tags) {
            let cell: Vec<u32> = cell.iter().map(|&at| number[at as usize]).collect();
            let start = turned.len();
            turned.extend(self.turn(&cell).ok_or_else(|| {
                let found = format!(
                    "$Elements: element {tag} at {} has no volume",
                    self.place(cell[0])
                );
                Fault::new(found, "cells of positive area or volume")
            })?);
            debug_assert_eq!(turned.len(), start + n);
        }
        // the last two corners of a mirrored cell are exchanged: as a set they are the key
        let key = |cell: usize| {
            let mut key = [0; 4];
            key[..corners].copy_from_slice(&turned[cell * n..cell * n + corners]);
            key[..corners].sort_unstable();
            key
        };
        let mut order: Vec<([u32; 4], u32)> = (0..found.tags.len())
            .map(|cell| (key(cell), cell as u32))
            .collect();
        order.sort_unstable();
        for pair in order.windows(2) {
            if pair[0].0 == pair[1].0 {
                let [a, b] = [pair[0].1 as usize, pair[1].1 as usize];
                let region = |cell: usize| cut(&self.regions[found.regions[cell] as usize]);
                let found = format!(
                    "$Elements: elements {} (in {:?}) and {} (in {:?}) have the same corners",
                    found.tags[a],
                    region(a),
                    found.tags[b],
                    region(b)
                );
                return Err(Fault::new(
                    found,
                    "each cell once, in one physical group of its dimension",
                ));
            }
        }
        for (_, cell) in order {
            let cell = cell as usize;
            self.cell_nodes.extend(&turned[cell * n..(cell + 1) * n]);
            self.cell_regions.push(found.regions[cell]);
        }
        Ok(())
    }

    /// The nodes of a cell with its corners in order; `None` for a flat one.
    fn turn(&self, cell: &[u32]) -> Option<Vec<u32>> {
        let corners = self.element.corners();
        let mut turned = cell[..corners].to_vec();
        turned.sort_unstable();
        let volume = self.volume(&turned);
        let edges = (0..corners).flat_map(|i| (0..i).map(move |j| (i, j)));
        let longest = edges
            .map(|(i, j)| length(difference(self.at(turned[i]), self.at(turned[j]))))
            .fold(0.0, f64::max);
        // a side whose power is no number is not flat either
        let least = FLAT * longest.powi(self.element.dimension as i32);
        if volume.abs() <= least {
            return None;
        }
        if volume < 0.0 {
            turned.swap(corners - 2, corners - 1);
        }
        for [i, j] in self.element.midsides {
            let ends = [turned[*i], turned[*j]];
            let middle =
                self.element.midsides.iter().position(|[p, q]| {
                    [cell[*p], cell[*q]] == ends || [cell[*q], cell[*p]] == ends
                })?;
            turned.push(cell[corners + middle]);
        }
        Some(turned)
    }

    fn at(&self, node: u32) -> [f64; 3] {
        self.nodes[node as usize]
    }

    /// A place for messages.
    pub fn place(&self, node: u32) -> String {
        let numbers = self.at(node).map(|x| number(x).to_string());
        format!("({})", numbers[..self.element.dimension].join(", "))
    }

    /// Twice the area or six times the volume between corners.
    fn volume(&self, corners: &[u32]) -> f64 {
        let origin = self.at(corners[0]);
        let edge = |i: usize| difference(self.at(corners[i]), origin);
        let (a, b) = (edge(1), edge(2));
        let normal = [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ];
        match corners.len() {
            3 => normal[2],
            _ => edge(3).iter().zip(normal).map(|(x, y)| x * y).sum(),
        }
    }
}

fn difference(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

fn length(v: [f64; 3]) -> f64 {
    v[0].hypot(v[1]).hypot(v[2])
}

/// The number that a text file with 16 digits would have.
fn rounded(x: f64) -> f64 {
    // a finite number has a text that reads back
    let nearest = format!("{x:.15e}").parse().unwrap_or(x);
    // and 0 for -0
    nearest + 0.0
}

/// Number of every node of the file in the mesh, and the other way round.
fn canonical_order(found: &Found, places: &[[f64; 3]]) -> (Vec<u32>, Vec<u32>) {
    let mut number = vec![UNUSED; places.len()];
    for &at in &found.nodes {
        number[at as usize] = 0;
    }
    let mut order: Vec<u32> = (0..places.len() as u32)
        .filter(|&at| number[at as usize] == 0)
        .collect();
    let by_place = |a: &u32, b: &u32| {
        let pairs = places[*a as usize].iter().zip(&places[*b as usize]);
        pairs
            .map(|(x, y)| x.total_cmp(y))
            .find(|order| order.is_ne())
            .unwrap_or_else(|| a.cmp(b))
    };
    order.sort_unstable_by(by_place);
    for (new, &at) in (0..).zip(&order) {
        number[at as usize] = new;
    }
    (number, order)
}

/// Refuses a plane mesh outside the plane z = 0, and takes out what rounding left there.
fn flatten(nodes: &mut [[f64; 3]], order: &[u32], contents: &Contents) -> Outcome<()> {
    let extent = |axis: usize| {
        let values = nodes.iter().map(|p| p[axis]);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| {
            (l.min(x), h.max(x))
        });
        high - low
    };
    let size = extent(0).max(extent(1)).max(extent(2));
    for (place, &at) in nodes.iter_mut().zip(order) {
        if place[2].abs() > PLANE * size {
            let found = format!(
                "$Nodes: node {} of a triangle is at z = {} m",
                contents.nodes[at as usize].0,
                number(place[2])
            );
            let allowed = "a plane mesh in the plane z = 0, or tetrahedra: a solid needs a physical group of its volume";
            return Err(Fault::new(found, allowed));
        }
        place[2] = 0.0;
    }
    Ok(())
}

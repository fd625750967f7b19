//! Writes MSH files of all versions and encodings, for the tests of the reader.

use stickslip::mesh::Mesh;

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Format {
    Text4,
    Text2,
    /// Most significant byte first or not, bytes of a `size_t`.
    Binary4(bool, usize),
    Binary2(bool),
}

pub const FORMATS: [Format; 8] = [
    Format::Text4,
    Format::Text2,
    Format::Binary4(false, 8),
    Format::Binary4(true, 8),
    Format::Binary4(false, 4),
    Format::Binary4(true, 4),
    Format::Binary2(false),
    Format::Binary2(true),
];

/// Elements of one type on one entity.
#[derive(Debug, Clone)]
pub struct Block {
    pub of: i32,
    pub entity: i32,
    pub groups: Vec<i32>,
    /// Places in the list of nodes.
    pub cells: Vec<Vec<usize>>,
}

#[derive(Debug, Clone, Default)]
pub struct File {
    /// Dimension, number, name.
    pub names: Vec<(i32, i32, String)>,
    pub nodes: Vec<[f64; 3]>,
    /// Numbers of the nodes.
    pub tags: Vec<u64>,
    pub blocks: Vec<Block>,
}

/// Dimension of a type of elements.
pub fn dimension(of: i32) -> i32 {
    match of {
        15 => 0,
        1 | 8 | 26 => 1,
        2 | 3 | 9 | 21 => 2,
        4 | 11 => 3,
        other => panic!("type {other}"),
    }
}

/// Numbers and line ends, in one of the encodings.
struct Sink {
    bytes: Vec<u8>,
    format: Format,
}

impl Sink {
    fn text(&mut self, text: &str) {
        self.bytes.extend(text.as_bytes());
    }

    fn number<const N: usize>(&mut self, text: String, raw: [u8; N]) {
        let is_big = match self.format {
            Format::Text2 | Format::Text4 => return self.text(&format!("{text} ")),
            Format::Binary4(is_big, _) | Format::Binary2(is_big) => is_big,
        };
        let mut raw = raw;
        if is_big {
            raw.reverse();
        }
        self.bytes.extend(raw);
    }

    fn int(&mut self, value: i32) {
        self.number(value.to_string(), value.to_le_bytes());
    }

    fn size(&mut self, value: u64) {
        match self.format {
            Format::Binary4(_, 4) => self.number(String::new(), (value as u32).to_le_bytes()),
            _ => self.number(value.to_string(), value.to_le_bytes()),
        }
    }

    /// 16 digits in a text, as Gmsh writes them.
    fn double(&mut self, value: f64) {
        self.number(format!("{value:.15e}"), value.to_le_bytes());
    }

    fn end_line(&mut self) {
        if matches!(self.format, Format::Text2 | Format::Text4) {
            self.text("\n");
        }
    }
}

impl File {
    /// The file of a mesh: one entity for every region (groups 101, ...) and part (groups 1, ...).
    pub fn of(mesh: &Mesh) -> File {
        let solid = mesh.dimension as i32;
        let (cell, face) = match mesh.element.name {
            "tri3" => (2, 1),
            "tri6" => (9, 8),
            "tet4" => (4, 2),
            _ => (11, 9),
        };
        let mut file = File {
            names: Vec::new(),
            nodes: mesh.nodes.clone(),
            tags: (1..=mesh.nodes.len() as u64).collect(),
            blocks: Vec::new(),
        };
        for (i, (name, faces)) in (1..).zip(&mesh.parts) {
            file.names.push((solid - 1, i, name.clone()));
            let faces = faces.chunks_exact(mesh.element.face_nodes());
            file.blocks.push(Block {
                of: face,
                entity: i,
                groups: vec![i],
                cells: faces
                    .map(|f| f.iter().map(|n| *n as usize).collect())
                    .collect(),
            });
        }
        for (i, name) in (0..).zip(&mesh.regions) {
            let (entity, group) = (i + 1, i + 101);
            file.names.push((solid, group, name.clone()));
            let of_region = mesh
                .cells()
                .zip(&mesh.cell_regions)
                .filter(|(_, r)| **r == i as u32);
            let cells = of_region.map(|(nodes, _)| {
                let mut nodes: Vec<usize> = nodes.iter().map(|n| *n as usize).collect();
                // the last two edges of a tetrahedron have the other order in Gmsh
                if nodes.len() == 10 {
                    nodes.swap(8, 9);
                }
                nodes
            });
            file.blocks.push(Block {
                of: cell,
                entity,
                groups: vec![group],
                cells: cells.collect(),
            });
        }
        file
    }

    /// The same mesh, written by somebody else: other numbers with gaps, another order of nodes, blocks, cells and corners, every
    /// cell mirrored.
    pub fn otherwise(&self) -> File {
        let count = self.nodes.len();
        let mut other = self.clone();
        other.nodes.reverse();
        other.tags = (0..count as u64).map(|i| 7 + 13 * i).collect();
        other.blocks.reverse();
        for block in &mut other.blocks {
            block.cells.reverse();
            for cell in &mut block.cells {
                cell.iter_mut().for_each(|node| *node = count - 1 - *node);
                // with the edges of the corners that change places
                let swaps: &[(usize, usize)] = match block.of {
                    2 | 4 => &[(0, 1)],
                    9 => &[(0, 1), (4, 5)],
                    11 => &[(0, 1), (5, 6), (7, 9)],
                    _ => &[],
                };
                swaps.iter().for_each(|(a, b)| cell.swap(*a, *b));
            }
        }
        other
    }

    pub fn write(&self, format: Format) -> Vec<u8> {
        let mut out = Sink {
            bytes: Vec::new(),
            format,
        };
        let head = match format {
            Format::Text4 => "4.1 0 8",
            Format::Text2 => "2.2 0 8",
            Format::Binary4(_, 8) => "4.1 1 8",
            Format::Binary4(..) => "4.1 1 4",
            Format::Binary2(_) => "2.2 1 8",
        };
        out.text(&format!("$MeshFormat\n{head}\n"));
        if !matches!(format, Format::Text2 | Format::Text4) {
            out.int(1);
            out.text("\n");
        }
        out.text("$EndMeshFormat\n");
        if !self.names.is_empty() {
            out.text(&format!("$PhysicalNames\n{}\n", self.names.len()));
            for (dimension, number, name) in &self.names {
                out.text(&format!("{dimension} {number} \"{name}\"\n"));
            }
            out.text("$EndPhysicalNames\n");
        }
        match format {
            Format::Text2 | Format::Binary2(_) => self.write2(&mut out),
            Format::Text4 | Format::Binary4(..) => self.write4(&mut out),
        }
        out.bytes
    }

    fn write4(&self, out: &mut Sink) {
        let mut entities: Vec<(i32, i32, &[i32])> = Vec::new();
        for block in &self.blocks {
            let key = (dimension(block.of), block.entity, &block.groups[..]);
            if !entities.contains(&key) {
                entities.push(key);
            }
        }
        entities.sort_unstable();
        out.text("$Entities\n");
        for d in 0..4 {
            out.size(entities.iter().filter(|e| e.0 == d).count() as u64);
        }
        out.end_line();
        for (d, entity, groups) in entities {
            out.int(entity);
            for _ in 0..if d == 0 { 3 } else { 6 } {
                out.double(0.0);
            }
            out.size(groups.len() as u64);
            groups.iter().for_each(|g| out.int(*g));
            if d > 0 {
                out.size(1);
                out.int(-1);
            }
            out.end_line();
        }
        out.text("\n$EndEntities\n$Nodes\n");
        let count = self.nodes.len() as u64;
        // two blocks; the second has parameters
        let first = count / 2;
        for value in [2, count, 1, self.tags.iter().copied().max().unwrap_or(0)] {
            out.size(value);
        }
        out.end_line();
        for (range, has_parameters) in [(0..first, 0), (first..count, 1)] {
            for value in [1, 1, has_parameters] {
                out.int(value);
            }
            out.size(range.end - range.start);
            out.end_line();
            let range = range.start as usize..range.end as usize;
            for tag in &self.tags[range.clone()] {
                out.size(*tag);
                out.end_line();
            }
            for place in &self.nodes[range] {
                place.iter().for_each(|x| out.double(*x));
                (0..has_parameters).for_each(|_| out.double(0.25));
                out.end_line();
            }
        }
        out.text("\n$EndNodes\n$Elements\n");
        let total: usize = self.blocks.iter().map(|b| b.cells.len()).sum();
        for value in [self.blocks.len(), total, 1, total] {
            out.size(value as u64);
        }
        out.end_line();
        let mut number = 0;
        for block in &self.blocks {
            for value in [dimension(block.of), block.entity, block.of] {
                out.int(value);
            }
            out.size(block.cells.len() as u64);
            out.end_line();
            for cell in &block.cells {
                number += 1;
                out.size(number);
                cell.iter().for_each(|node| out.size(self.tags[*node]));
                out.end_line();
            }
        }
        out.text("\n$EndElements\n");
    }

    fn write2(&self, out: &mut Sink) {
        out.text(&format!("$Nodes\n{}\n", self.nodes.len()));
        for (tag, place) in self.tags.iter().zip(&self.nodes) {
            out.int(*tag as i32);
            place.iter().for_each(|x| out.double(*x));
            out.end_line();
        }
        // an element in several groups is repeated, one in none has group 0
        let groups = |block: &Block| match block.groups.is_empty() {
            true => vec![0],
            false => block.groups.clone(),
        };
        let total: usize = self
            .blocks
            .iter()
            .map(|b| b.cells.len() * groups(b).len())
            .sum();
        out.text(&format!("\n$EndNodes\n$Elements\n{total}\n"));
        let mut number = 0;
        let is_text = out.format == Format::Text2;
        for block in &self.blocks {
            for group in groups(block) {
                // in a binary file all of a block together
                if !is_text && !block.cells.is_empty() {
                    [block.of, block.cells.len() as i32, 4]
                        .iter()
                        .for_each(|v| out.int(*v));
                }
                for cell in &block.cells {
                    number += 1;
                    out.int(number);
                    if is_text {
                        [block.of, 4].iter().for_each(|v| out.int(*v));
                    }
                    // group, entity, and a partition
                    [group, block.entity, 1, 1].iter().for_each(|v| out.int(*v));
                    cell.iter()
                        .for_each(|node| out.int(self.tags[*node] as i32));
                    out.end_line();
                }
            }
        }
        out.text("\n$EndElements\n");
    }
}

//! The deformed body at every communication point, as legacy VTK files and a `.vtk.series` index.
//!
//! Point data in global axes: `displacement` (m), `velocity` (m/s), `tangential_stress` on the body (Pa; zero off the
//! contact), and where the scene has them `pressure` (Pa), `gap` (m) and `status` of the contact nodes; with several contacts
//! `contact`, the number of the one that a node is on (from 1; 0 off all).
//! Cell data: `region` (its place in the list of the mesh), `strain_rate` (1/s), and of materials whose stress is that of the instant
//! `stress` (Pa), with the point data `normal_stress` at the contact. Nodes stand where they were before the deformation, cells are triangles, quadratic triangles or tetrahedra.

use crate::cell_fields::CellFields;
use crate::course::Frame;
use crate::failure::Failure;
use num_traits::FromPrimitive;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use stickslip::fem::Body;
use stickslip::{Compilation, Simulator};
use vtkio::model::{
    Attribute, Attributes, ByteOrder, CellType, Cells, DataSet, UnstructuredGridPiece, Version,
    VertexNumbers, Vtk,
};

pub struct Series {
    folder: PathBuf,
    stem: String,
    files: Vec<(String, f64)>,
}

impl Series {
    /// Creates the folder, and removes the files that an earlier run of a scene of this name has left in it: a shorter run
    /// would leave some of them among its own.
    pub fn create(folder: &Path, name: &str) -> Result<Series, Failure> {
        let failed = Failure::writing(folder);
        std::fs::create_dir_all(folder).map_err(|e| failed(&e))?;
        // a scene may be called anything, a file may not
        let stem: String = name
            .chars()
            .map(|c| {
                if c.is_alphanumeric() || "-_".contains(c) {
                    c
                } else {
                    '_'
                }
            })
            .collect();
        for entry in std::fs::read_dir(folder).map_err(|e| failed(&e))? {
            let entry = entry.map_err(|e| failed(&e))?;
            if is_of_series(&entry.file_name().to_string_lossy(), &stem) {
                std::fs::remove_file(entry.path()).map_err(|e| failed(&e))?;
            }
        }
        Ok(Series {
            folder: folder.to_owned(),
            stem,
            files: Vec::new(),
        })
    }

    /// Writes a communication point.
    pub fn add(
        &mut self,
        compilation: &Compilation,
        simulator: &Simulator,
        frame: &Frame,
    ) -> Result<(), Failure> {
        let state = simulator.state();
        let body = &compilation.body;
        let failed = Failure::of(&compilation.model.summary().name);
        let displacement = compilation.nodal_displacement(state).map_err(&failed)?;
        let velocity = compilation.nodal_velocity(state).map_err(&failed)?;
        let mut point = vec![
            Attribute::vectors("displacement").with_data(displacement.concat()),
            Attribute::vectors("velocity").with_data(velocity.concat()),
            Attribute::vectors("tangential_stress").with_data(stress(body, frame)),
        ];
        for (name, values) in &frame.normal {
            let name = name.trim_start_matches("contact.");
            point.push(Attribute::scalars(name, 1).with_data(scalars(body, values)));
        }
        if body.contact.parts.len() > 1 {
            let number = |node| body.contact.part_of(node) as f64 + 1.0;
            let numbers: Vec<f64> = (0..body.contact.node_count()).map(number).collect();
            point.push(Attribute::scalars("contact", 1).with_data(scalars(body, &numbers)));
        }
        let fields = CellFields::new(body, &displacement, &velocity);
        let mut cell = vec![
            Attribute::scalars("region", 1).with_data(body.mesh.cell_regions.clone()),
            Attribute::tensors("strain_rate").with_data(fields.strain_rate.concat()),
        ];
        // the share of the memory needs the strains of its branches, which a file does not have; forms are those of linear laws
        if !body.forms.have_memory() && !body.is_nonlinear {
            let normal = scalars(body, &fields.normal_stress(body));
            point.push(Attribute::scalars("normal_stress", 1).with_data(normal));
            cell.push(Attribute::tensors("stress").with_data(fields.stress.concat()));
        }
        let grid = UnstructuredGridPiece {
            points: body.mesh.nodes.concat().into(),
            cells: cells(body),
            data: Attributes { point, cell },
        };
        let name = format!("{}_{:05}.vtk", self.stem, self.files.len());
        let path = self.folder.join(&name);
        let failed = Failure::writing(&path);
        let file = File::create(&path).map_err(|e| failed(&e))?;
        let vtk = Vtk {
            version: Version::new_legacy(3, 0),
            title: format!("{} at {:?} s", self.stem, frame.time),
            byte_order: ByteOrder::BigEndian,
            data: DataSet::inline(grid),
            file_path: None,
        };
        vtk.write_legacy(BufWriter::new(file))
            .map_err(|e| failed(&format!("{e:?}")))?;
        self.files.push((name, frame.time));
        Ok(())
    }

    /// Writes the index.
    pub fn finish(self) -> Result<(), Failure> {
        let path = self.folder.join(format!("{}.vtk.series", self.stem));
        let entries: Vec<_> = self
            .files
            .iter()
            .map(|(name, time)| format!("    {{\"name\": \"{name}\", \"time\": {time:?}}}"))
            .collect();
        let text = format!(
            "{{\n  \"file-series-version\": \"1.0\",\n  \"files\": [\n{}\n  ]\n}}\n",
            entries.join(",\n")
        );
        let failed = Failure::writing(&path);
        std::fs::write(&path, text).map_err(|e| failed(&e))
    }
}

/// Whether a file is the index or a communication point of a series.
fn is_of_series(file: &str, stem: &str) -> bool {
    let Some(rest) = file.strip_prefix(stem) else {
        return false;
    };
    let number = rest.strip_prefix('_').and_then(|r| r.strip_suffix(".vtk"));
    let is_number = |n: &str| n.len() >= 5 && n.bytes().all(|b| b.is_ascii_digit());
    rest == ".vtk.series" || number.is_some_and(is_number)
}

fn cells(body: &Body) -> Cells {
    let mesh = &body.mesh;
    let count = mesh.element.nodes as u32;
    let vertices = mesh
        .cells()
        .flat_map(|cell| [count].into_iter().chain(cell.iter().copied()))
        .collect();
    // midside nodes have the order of VTK
    let kind = CellType::from_u8(mesh.element.vtk).unwrap_or(CellType::ConvexPointSet);
    Cells {
        cell_verts: VertexNumbers::Legacy {
            num_cells: mesh.cell_count() as u32,
            vertices,
        },
        types: vec![kind; mesh.cell_count()],
    }
}

/// Values of the contact nodes at all nodes; zero off the contact.
fn scalars(body: &Body, values: &[f64]) -> Vec<f64> {
    let mut nodal = vec![0.0; body.mesh.nodes.len()];
    for (&node, value) in body.contact.nodes.iter().zip(values) {
        nodal[node as usize] = *value;
    }
    let leaders = body.mesh.leader.iter();
    leaders.map(|&leader| nodal[leader as usize]).collect()
}

/// Tangential stress at all nodes, in global axes.
fn stress(body: &Body, frame: &Frame) -> Vec<f64> {
    let contact = &body.contact;
    let mut nodal = vec![[0.0; 3]; body.mesh.nodes.len()];
    let c = contact.components;
    for (i, &node) in contact.nodes.iter().enumerate() {
        let values = &frame.tangential_stress[i * c..(i + 1) * c];
        for (value, tangent) in values.iter().zip(&contact.tangents[i]) {
            for (total, t) in nodal[node as usize].iter_mut().zip(tangent) {
                *total += value * t;
            }
        }
    }
    // of periodic nodes the leader carries the contact
    let leaders = body.mesh.leader.iter();
    leaders.flat_map(|&leader| nodal[leader as usize]).collect()
}

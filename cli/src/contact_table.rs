//! The CSV of `run`: one row per communication point and contact node.
//!
//! `time,node,x,y,slip_rate,slip,accumulated_slip,tangential_stress,stick`; in 3D with `z` and with `_1`, `_2` on what has
//! two tangential components. Where the scene has them `pressure`, `gap` and `status` (0 open, 1 sticks, 2 slips) follow, and with several contacts `part`, the name of the one that the node
//! is on. Numbers are the shortest that read back equal.

use crate::course::{Frame, NORMAL};
use crate::failure::Failure;
use crate::standard;
use std::io::Write;
use std::path::{Path, PathBuf};
use stickslip::fem::ContactPatch;
use stickslip::ports::Ports;

/// The one that is a count.
const STATUS: &str = NORMAL[2];

pub struct ContactTable {
    path: PathBuf,
    writer: csv::Writer<Box<dyn Write>>,
}

impl ContactTable {
    /// Creates the file, its folder if need be, and writes the header; `-` is standard output.
    pub fn create(
        path: &Path,
        contact: &ContactPatch,
        ports: &Ports,
    ) -> Result<ContactTable, Failure> {
        let failed = Failure::writing(path);
        let mut writer = csv::Writer::from_writer(standard::create(path)?);
        writer
            .write_record(header(contact, ports))
            .map_err(|e| failed(&e))?;
        Ok(ContactTable {
            path: path.to_owned(),
            writer,
        })
    }

    /// Appends a communication point.
    pub fn add(&mut self, contact: &ContactPatch, frame: &Frame) -> Result<(), Failure> {
        let c = contact.components;
        for (node, point) in contact.points.iter().enumerate() {
            let part = |values: &[f64]| values[node * c..(node + 1) * c].to_vec();
            let row = [frame.time]
                .into_iter()
                .map(shortest)
                .chain([node.to_string()])
                .chain(point[..=c].iter().copied().map(shortest))
                .chain(part(&frame.slip_rate).into_iter().map(shortest))
                .chain(part(&frame.slip).into_iter().map(shortest))
                .chain([shortest(frame.accumulated_slip[node])])
                .chain(part(&frame.tangential_stress).into_iter().map(shortest))
                .chain([format!("{}", frame.stick[node])])
                .chain(frame.normal.iter().map(|(name, values)| match *name {
                    STATUS => format!("{}", values[node]),
                    _ => shortest(values[node]),
                }))
                .chain(part_name(contact, node));
            self.writer
                .write_record(row)
                .map_err(|e| Failure::writing(&self.path)(&e))?;
        }
        Ok(())
    }

    /// Writes what is still buffered.
    pub fn finish(mut self) -> Result<(), Failure> {
        let failed = Failure::writing(&self.path);
        self.writer.flush().map_err(|e| failed(&e))
    }
}

/// The contact of a node, where there are several.
fn part_name(contact: &ContactPatch, node: usize) -> Option<String> {
    let name = || contact.parts[contact.part_of(node)].name.clone();
    (contact.parts.len() > 1).then(name)
}

fn header(contact: &ContactPatch, ports: &Ports) -> Vec<String> {
    let components = contact.components;
    let part = (contact.parts.len() > 1).then(|| "part".to_owned());
    let normal = NORMAL.iter().filter(|name| ports.find(name).is_ok());
    let normal = normal.map(|name| name.trim_start_matches("contact.").to_owned());
    let field = |name: &str| -> Vec<String> {
        match components {
            1 => vec![name.to_owned()],
            _ => (1..=components).map(|i| format!("{name}_{i}")).collect(),
        }
    };
    let axes = ["x", "y", "z"][..=components].iter().map(|a| a.to_string());
    ["time".to_owned(), "node".to_owned()]
        .into_iter()
        .chain(axes)
        .chain(field("slip_rate"))
        .chain(field("slip"))
        .chain(["accumulated_slip".to_owned()])
        .chain(field("tangential_stress"))
        .chain(["stick".to_owned()])
        .chain(normal)
        .chain(part)
        .collect()
}

/// The shortest text that reads back equal; with an exponent where the plain form would be long.
pub fn shortest(value: f64) -> String {
    format!("{value:?}")
}

/// Writes a table of numbers with a header.
pub fn write_columns(
    path: &Path,
    header: &[&str],
    rows: impl IntoIterator<Item = Vec<f64>>,
) -> Result<(), Failure> {
    let failed = Failure::writing(path);
    let mut writer = csv::Writer::from_path(path).map_err(|e| failed(&e))?;
    writer.write_record(header).map_err(|e| failed(&e))?;
    for row in rows {
        writer
            .write_record(row.into_iter().map(shortest))
            .map_err(|e| failed(&e))?;
    }
    writer.flush().map_err(|e| failed(&e))
}

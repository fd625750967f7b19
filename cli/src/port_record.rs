//! The ports over a run: a table of those that are no arrays, and all of them for NumPy.

use crate::contact_table::shortest;
use crate::failure::Failure;
use crate::npz::{self, Array};
use crate::standard;
use std::io::Write;
use std::path::{Path, PathBuf};
use stickslip::ports::{Causality, Port};
use stickslip::{Model, Simulator};

fn is_recorded(port: &&Port) -> bool {
    port.causality != Causality::Parameter
}

/// A CSV file: time, all inputs, all outputs that are no arrays over the contact; of vectors a column per component, from 1.
pub struct PortTable {
    path: PathBuf,
    writer: csv::Writer<Box<dyn Write>>,
    ports: Vec<(u32, usize)>,
}

impl PortTable {
    /// Creates the file, its folder if need be, and writes the header; `-` is standard output.
    ///
    /// # Errors
    /// [`Failure::File`].
    pub fn create(path: &Path, model: &Model) -> Result<PortTable, Failure> {
        let nodes = model.contact().node_count();
        let all = model.ports().all().iter().filter(is_recorded);
        let is_nodal =
            |port: &Port| port.name.starts_with("contact.") && port.shape.first() == Some(&nodes);
        let ports: Vec<&Port> = all.filter(|port| !is_nodal(port)).collect();
        let columns = ports.iter().flat_map(|port| -> Vec<String> {
            match port.shape[..] {
                [] => vec![port.name.clone()],
                _ => (1..=port.len())
                    .map(|i| format!("{}[{i}]", port.name))
                    .collect(),
            }
        });
        let header: Vec<String> = ["time".to_owned()].into_iter().chain(columns).collect();
        let mut writer = csv::Writer::from_writer(standard::create(path)?);
        let written = writer.write_record(header);
        written.map_err(|e| Failure::writing(path)(&e))?;
        Ok(PortTable {
            path: path.to_owned(),
            writer,
            ports: ports
                .iter()
                .map(|port| (port.reference, port.len()))
                .collect(),
        })
    }

    /// Appends a communication point.
    ///
    /// # Errors
    /// [`Failure::File`].
    pub fn add(&mut self, simulator: &Simulator) -> Result<(), Failure> {
        let failed = Failure::writing(&self.path);
        let mut row = vec![shortest(simulator.time())];
        for (reference, len) in &self.ports {
            let mut values = vec![0.0; *len];
            simulator
                .get(*reference, &mut values)
                .map_err(|e| failed(&e))?;
            row.extend(values.into_iter().map(shortest));
        }
        self.writer.write_record(row).map_err(|e| failed(&e))
    }

    /// Writes what is still buffered.
    ///
    /// # Errors
    /// [`Failure::File`].
    pub fn finish(mut self) -> Result<(), Failure> {
        self.writer
            .flush()
            .map_err(|e| Failure::writing(&self.path)(&e))
    }
}

/// All inputs and outputs over time, in memory until the end of the run.
pub struct PortArrays {
    path: PathBuf,
    times: Vec<f64>,
    values: Vec<Vec<f64>>,
}

impl PortArrays {
    pub fn new(path: &Path, model: &Model) -> PortArrays {
        let ports = model.ports().all().iter().filter(is_recorded);
        PortArrays {
            path: path.to_owned(),
            times: Vec::new(),
            values: ports.map(|_| Vec::new()).collect(),
        }
    }

    /// Appends a communication point.
    ///
    /// # Errors
    /// [`Failure::File`].
    pub fn add(&mut self, simulator: &Simulator) -> Result<(), Failure> {
        self.times.push(simulator.time());
        let ports = simulator.model().ports().all().iter().filter(is_recorded);
        for (port, values) in ports.zip(&mut self.values) {
            let from = values.len();
            values.resize(from + port.len(), 0.0);
            let read = simulator.get(port.reference, &mut values[from..]);
            read.map_err(|e| Failure::writing(&self.path)(&e))?;
        }
        Ok(())
    }

    /// Writes the file: `time`, every port by its name (points, then its shape), `contact.position` (nodes, dimension) and
    /// `contact.weight` (nodes).
    ///
    /// # Errors
    /// [`Failure::File`].
    pub fn finish(self, model: &Model) -> Result<(), Failure> {
        let points = self.times.len();
        let mut arrays = vec![("time".to_owned(), Array::Numbers(&self.times, vec![points]))];
        let ports = model.ports().all().iter().filter(is_recorded);
        for (port, values) in ports.zip(&self.values) {
            let shape = [&[points], &port.shape[..]].concat();
            arrays.push((port.name.clone(), Array::Numbers(values, shape)));
        }
        let (contact, dimension) = (model.contact(), model.summary().dimension);
        let places = contact.points.iter().flat_map(|p| p[..dimension].to_vec());
        let (places, nodes) = (places.collect::<Vec<_>>(), contact.node_count());
        let weights = Array::Numbers(&contact.weights, vec![nodes]);
        arrays.push((
            "contact.position".to_owned(),
            Array::Numbers(&places, vec![nodes, dimension]),
        ));
        arrays.push(("contact.weight".to_owned(), weights));
        npz::write(&self.path, &arrays)
    }
}

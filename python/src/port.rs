//! A port, as a master sees it.

use pyo3::prelude::*;
use pyo3::types::PyTuple;
use stickslip::ports::Causality;

/// A variable of a model: an input, an output or a parameter.
///
/// >>> import stickslip
/// >>> model = stickslip.compile("kazmi2014")
/// >>> model.port("contact.slip_rate")
/// <Port contact.slip_rate [m/s] output (32)>
#[pyclass(frozen, module = "stickslip")]
pub struct Port(pub stickslip::ports::Port);

#[pymethods]
impl Port {
    /// Its name, as a master writes it.
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    /// Its place in the list of ports; methods that take a name take it too.
    #[getter]
    fn reference(&self) -> u32 {
        self.0.reference
    }

    /// The SI unit; "1" for a number.
    #[getter]
    fn unit(&self) -> &str {
        self.0.unit
    }

    /// "input", "output" or "parameter".
    #[getter]
    fn causality(&self) -> &'static str {
        match self.0.causality {
            Causality::Input => "input",
            Causality::Output => "output",
            Causality::Parameter => "parameter",
        }
    }

    /// Empty for a scalar; (nodes,) or (nodes, components) over the contact; (dimension,).
    #[getter]
    fn shape<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, &self.0.shape)
    }

    /// One sentence with sign and frame.
    #[getter]
    fn description(&self) -> &str {
        &self.0.description
    }

    fn __repr__(&self) -> String {
        let Port(port) = self;
        let shape: Vec<_> = port.shape.iter().map(usize::to_string).collect();
        format!(
            "<Port {} [{}] {} ({})>",
            port.name,
            port.unit,
            self.causality(),
            shape.join(", ")
        )
    }
}

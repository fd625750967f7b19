//! Handles of compiled models.

use super::guard::{Handle, free, give, guarded, handle, place, room, text, values, values_mut};
use super::{STICKSLIP_INPUT, STICKSLIP_OK, STICKSLIP_OUTPUT, STICKSLIP_PARAMETER};
use crate::error::{Error, Result};
use crate::model::Model;
use crate::ports::{Causality, Port};
use std::ffi::{CString, c_char};
use std::sync::Arc;

/// A compiled scene: immutable, used by any number of simulators in any number of threads.
pub struct stickslip_model {
    tag: u64,
    pub(super) model: Arc<Model>,
    ports: Vec<PortTexts>,
}

/// Texts of a port as C reads them.
struct PortTexts {
    name: CString,
    unit: CString,
    description: CString,
    /// Place of its first value among those of its causality.
    offset: usize,
}

impl Handle for stickslip_model {
    const WHAT: &'static str = "model";
    const TAG: u64 = u64::from_le_bytes(*b"slipmodl");
    fn tag(&self) -> u64 {
        self.tag
    }
}

/// Sizes of a model.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct stickslip_model_info {
    /// Space dimension, 2 or 3.
    pub dimension: usize,
    /// Contact nodes.
    pub contact_nodes: usize,
    /// Tangential components per contact node: dimension - 1.
    pub contact_components: usize,
    /// Number of inputs: one value per load.
    pub inputs: usize,
    /// Number of values of all outputs together.
    pub outputs: usize,
    /// Number of ports; their references are 0, 1, ...
    pub ports: usize,
    /// Displacements kept of the body: degrees of freedom or modes.
    pub states: usize,
    /// Internal steps kept in the slip history.
    pub history: usize,
    /// Bytes of a serialized state.
    pub state_bytes: usize,
    /// Bytes held by the model of the body.
    pub model_bytes: usize,
    /// Identifies the model: states fit models with the same fingerprint.
    pub fingerprint: u64,
    /// Largest internal step, s; a communication step is cut into internal steps not larger than this.
    pub largest_step: f64,
    /// By what share the slope of the friction law could grow before a step may have several solutions; negative: it may
    /// have, infinite: the bound does not depend on the slip rate.
    pub uniqueness_margin: f64,
}

/// One variable.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct stickslip_port {
    /// Name; belongs to the model handle, as the two texts that follow.
    pub name: *const c_char,
    /// SI unit, "1" for a number.
    pub unit: *const c_char,
    /// One sentence with sign and frame.
    pub description: *const c_char,
    /// What `stickslip_get` and `stickslip_set` are called with.
    pub reference: u32,
    /// `STICKSLIP_INPUT`, `STICKSLIP_OUTPUT` or `STICKSLIP_PARAMETER`.
    pub causality: i32,
    /// 0 for a number, 1 for a vector, 2 for a table.
    pub rank: usize,
    /// Rows and columns, the last index running fastest; 1 beyond the rank. Contact fields: nodes, then components.
    pub shape: [usize; 2],
    /// Number of values: the product of the shape.
    pub length: usize,
    /// Place of the first value in the array of `stickslip_get_outputs` (an output) or `stickslip_set_inputs` (an input).
    pub offset: usize,
}

pub(super) fn new_handle(model: Arc<Model>) -> Result<stickslip_model> {
    let texts = |port: &Port, offset| -> Result<PortTexts> {
        let c = |text: &str| {
            CString::new(text).map_err(|_| Error::Unknown {
                what: "port name: it holds a NUL",
                found: text.into(),
            })
        };
        Ok(PortTexts {
            name: c(&port.name)?,
            unit: c(port.unit)?,
            description: c(&port.description)?,
            offset,
        })
    };
    let mut next = [0; 3];
    let all = model.ports().all().iter();
    let ports = all
        .map(|port| {
            let next = &mut next[causality(port) as usize];
            let offset = *next;
            *next += port.len();
            texts(port, offset)
        })
        .collect::<Result<Vec<_>>>()?;
    Ok(stickslip_model {
        tag: stickslip_model::TAG,
        model,
        ports,
    })
}

fn causality(port: &Port) -> i32 {
    match port.causality {
        Causality::Input => STICKSLIP_INPUT,
        Causality::Output => STICKSLIP_OUTPUT,
        Causality::Parameter => STICKSLIP_PARAMETER,
    }
}

impl stickslip_model {
    fn describe(&self, port: &Port) -> stickslip_port {
        let texts = &self.ports[port.reference as usize];
        let size = |i: usize| port.shape.get(i).copied().unwrap_or(1);
        stickslip_port {
            name: texts.name.as_ptr(),
            unit: texts.unit.as_ptr(),
            description: texts.description.as_ptr(),
            reference: port.reference,
            causality: causality(port),
            rank: port.shape.len(),
            shape: [size(0), size(1)],
            length: port.len(),
            offset: texts.offset,
        }
    }
}

/// Loads a compiled model from the `length` bytes of `stickslip_model_save`, without mesh or assembly, into `*model`; the
/// caller frees it. The bytes are not kept. Errors: `BYTES` (of another kind or version, truncated, damaged), `FINGERPRINT`,
/// `NULL`. Any thread.
///
/// # Safety
/// `bytes` is NULL or points to `length` bytes, `model` is NULL or writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_model_load(
    bytes: *const u8,
    length: usize,
    model: *mut *mut stickslip_model,
) -> i32 {
    let call = || {
        place(model, "model")?;
        // SAFETY: as promised by the caller
        let bytes = unsafe { values(bytes, length, length, "bytes of the model") }?;
        let loaded = new_handle(Arc::new(Model::from_bytes(bytes)?))?;
        unsafe { give(model, loaded) };
        Ok(STICKSLIP_OK)
    };
    guarded(call, || {})
}

/// Writes the model as bytes (little-endian, versioned, checksummed; the same on every machine) and their number into
/// `*length`. With `bytes` NULL and `capacity` 0 only the number. Errors: `LENGTH` when `capacity` is too small, `NULL`. Any
/// thread.
///
/// # Safety
/// `model` is NULL or live, `bytes` NULL or `capacity` writable bytes, `length` NULL or writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_model_save(
    model: *const stickslip_model,
    bytes: *mut u8,
    capacity: usize,
    length: *mut usize,
) -> i32 {
    let call = || {
        // SAFETY: as promised by the caller
        let model = unsafe { handle(model) }?;
        place(length, "length")?;
        let saved = model.model.to_bytes();
        let out = unsafe { room(bytes, capacity, saved.len(), "bytes of the model") }?;
        if let Some(out) = out {
            out.copy_from_slice(&saved);
        }
        unsafe { length.write(saved.len()) };
        Ok(STICKSLIP_OK)
    };
    guarded(call, || {})
}

/// Frees a model handle; NULL is allowed. Simulators of the model live on; the texts of its ports do not. Any thread, but
/// not while another call uses the handle.
///
/// # Safety
/// `model` is NULL or live.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_model_free(model: *mut stickslip_model) {
    let call = || {
        // SAFETY: as promised by the caller
        unsafe { free(model, |m| m.tag = 0) };
        Ok(STICKSLIP_OK)
    };
    guarded(call, || {});
}

/// Writes the sizes of a model into `*info`. Errors: `NULL`. Any thread.
///
/// # Safety
/// `model` is NULL or live, `info` NULL or writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_model_get_info(
    model: *const stickslip_model,
    info: *mut stickslip_model_info,
) -> i32 {
    let call = || {
        // SAFETY: as promised by the caller
        let model = &unsafe { handle(model) }?.model;
        place(info, "info")?;
        let contact = model.contact();
        let value = stickslip_model_info {
            dimension: model.summary().dimension,
            contact_nodes: contact.node_count(),
            contact_components: contact.components,
            inputs: model.input_count(),
            outputs: model.ports().output_len(),
            ports: model.ports().all().len(),
            states: model.states(),
            history: model.history_capacity(),
            state_bytes: model.state_bytes(),
            model_bytes: model.summary().bytes,
            fingerprint: model.fingerprint(),
            largest_step: model.largest_step(),
            uniqueness_margin: model.certificate().margin(),
        };
        unsafe { info.write(value) };
        Ok(STICKSLIP_OK)
    };
    guarded(call, || {})
}

/// Describes the port with that reference (0, 1, ... up to `ports` - 1) in `*port`. Errors: `UNKNOWN`, `NULL`. Any thread.
///
/// # Safety
/// `model` is NULL or live, `port` NULL or writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_model_get_port(
    model: *const stickslip_model,
    reference: u32,
    port: *mut stickslip_port,
) -> i32 {
    let call = || {
        // SAFETY: as promised by the caller
        let model = unsafe { handle(model) }?;
        place(port, "port")?;
        let found = model.describe(model.model.ports().get(reference)?);
        unsafe { port.write(found) };
        Ok(STICKSLIP_OK)
    };
    guarded(call, || {})
}

/// Describes the port of that name ("contact.slip_rate") in `*port`. Look up once, then use the reference. Errors:
/// `UNKNOWN`, `NULL`. Any thread.
///
/// # Safety
/// `model` is NULL or live, `name` NULL or NUL-terminated, `port` NULL or writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_model_find_port(
    model: *const stickslip_model,
    name: *const c_char,
    port: *mut stickslip_port,
) -> i32 {
    let call = || {
        // SAFETY: as promised by the caller
        let model = unsafe { handle(model) }?;
        let name = String::from_utf8_lossy(unsafe { text(name, "name") }?);
        place(port, "port")?;
        let found = model.describe(model.model.ports().find(&name)?);
        unsafe { port.write(found) };
        Ok(STICKSLIP_OK)
    };
    guarded(call, || {})
}

/// Writes where the contact nodes are, in the order of all contact arrays: `points`, 3 coordinates per node (m; z = 0 in
/// 2D), and `weights`, the share of the contact area of each node (m^2; m in 2D), which times a tangential stress is a
/// force. `nodes` is the number of contact nodes. Errors: `LENGTH`, `NULL`. Any thread.
///
/// # Safety
/// `model` is NULL or live, `points` NULL or 3 `nodes` writable values, `weights` NULL or `nodes` writable values.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stickslip_model_get_contact(
    model: *const stickslip_model,
    points: *mut f64,
    weights: *mut f64,
    nodes: usize,
) -> i32 {
    let call = || {
        // SAFETY: as promised by the caller
        let contact = unsafe { handle(model) }?.model.contact();
        let count = contact.node_count();
        let weights = unsafe { values_mut(weights, nodes, count, "contact nodes") }?;
        let points = unsafe { values_mut(points, 3 * count, 3 * count, "contact points") }?;
        weights.copy_from_slice(&contact.weights);
        points.copy_from_slice(contact.points.as_flattened());
        Ok(STICKSLIP_OK)
    };
    guarded(call, || {})
}

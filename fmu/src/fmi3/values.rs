//! FMI 3.0: values and derivatives of variables.
#![allow(unsafe_code, clippy::missing_safety_doc, clippy::too_many_arguments)]

use super::{Instance, run};
use crate::guard::{slice, slice_mut};
use std::ffi::c_int;

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFloat64(
    instance: Instance,
    references: *const u32,
    count: usize,
    values: *mut f64,
    value_count: usize,
) -> c_int {
    run(instance, |instance| {
        instance.get(slice(references, count)?, slice_mut(values, value_count)?)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFloat64(
    instance: Instance,
    references: *const u32,
    count: usize,
    values: *const f64,
    value_count: usize,
) -> c_int {
    run(instance, |instance| {
        instance.set(slice(references, count)?, slice(values, value_count)?)
    })
}

/// Enumerations.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetInt64(
    instance: Instance,
    references: *const u32,
    count: usize,
    values: *mut i64,
    value_count: usize,
) -> c_int {
    run(instance, |instance| {
        instance.get(slice(references, count)?, slice_mut(values, value_count)?)
    })
}

/// Enumerations.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetInt64(
    instance: Instance,
    references: *const u32,
    count: usize,
    values: *const i64,
    value_count: usize,
) -> c_int {
    run(instance, |instance| {
        instance.set(slice(references, count)?, slice(values, value_count)?)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetDirectionalDerivative(
    instance: Instance,
    unknowns: *const u32,
    unknown_count: usize,
    knowns: *const u32,
    known_count: usize,
    seed: *const f64,
    seed_count: usize,
    sensitivity: *mut f64,
    sensitivity_count: usize,
) -> c_int {
    run(instance, |instance| {
        let (unknowns, knowns) = (slice(unknowns, unknown_count)?, slice(knowns, known_count)?);
        let (seed, out) = (
            slice(seed, seed_count)?,
            slice_mut(sensitivity, sensitivity_count)?,
        );
        instance.directional(unknowns, knowns, seed, out)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetAdjointDerivative(
    instance: Instance,
    unknowns: *const u32,
    unknown_count: usize,
    knowns: *const u32,
    known_count: usize,
    seed: *const f64,
    seed_count: usize,
    sensitivity: *mut f64,
    sensitivity_count: usize,
) -> c_int {
    run(instance, |instance| {
        let (unknowns, knowns) = (slice(unknowns, unknown_count)?, slice(knowns, known_count)?);
        let (seed, out) = (
            slice(seed, seed_count)?,
            slice_mut(sensitivity, sensitivity_count)?,
        );
        instance.adjoint(unknowns, knowns, seed, out)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetOutputDerivatives(
    instance: Instance,
    references: *const u32,
    count: usize,
    orders: *const i32,
    values: *mut f64,
    value_count: usize,
) -> c_int {
    run(instance, |instance| {
        let (references, orders) = (slice(references, count)?, slice(orders, count)?);
        instance.get_slopes(references, orders, slice_mut(values, value_count)?)
    })
}

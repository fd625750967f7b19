//! FMI 2.0: values and derivatives of variables.
#![allow(unsafe_code, clippy::missing_safety_doc)]

use super::{Component, run};
use crate::fault::Fault;
use crate::guard::{slice, slice_mut};
use crate::lifecycle::Call;
use std::ffi::{c_char, c_int};

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetReal(
    component: Component,
    references: *const u32,
    count: usize,
    values: *mut f64,
) -> c_int {
    run(component, |instance| {
        instance.get(slice(references, count)?, slice_mut(values, count)?)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetInteger(
    component: Component,
    references: *const u32,
    count: usize,
    values: *mut c_int,
) -> c_int {
    run(component, |instance| {
        instance.get(slice(references, count)?, slice_mut(values, count)?)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetReal(
    component: Component,
    references: *const u32,
    count: usize,
    values: *const f64,
) -> c_int {
    run(component, |instance| {
        instance.set(slice(references, count)?, slice(values, count)?)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetInteger(
    component: Component,
    references: *const u32,
    count: usize,
    values: *const c_int,
) -> c_int {
    run(component, |instance| {
        instance.set(slice(references, count)?, slice(values, count)?)
    })
}

/// Getters and setters of types that no variable has: right for no reference, wrong for every one.
macro_rules! without_variables {
    ($($name:ident($value:ty);)*) => {$(
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(
            component: Component,
            _references: *const u32,
            count: usize,
            _values: $value,
        ) -> c_int {
            run(component, |instance| {
                instance.permit(Call::Get)?;
                match count {
                    0 => Ok(()),
                    _ => Err(Fault::error(concat!(stringify!($name), ": no variable has this type"))),
                }
            })
        }
    )*};
}

without_variables! {
    fmi2GetBoolean(*mut c_int);
    fmi2GetString(*mut *const c_char);
    fmi2SetBoolean(*const c_int);
    fmi2SetString(*const *const c_char);
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetDirectionalDerivative(
    component: Component,
    unknowns: *const u32,
    unknown_count: usize,
    knowns: *const u32,
    known_count: usize,
    seed: *const f64,
    sensitivity: *mut f64,
) -> c_int {
    run(component, |instance| {
        let (unknowns, knowns) = (slice(unknowns, unknown_count)?, slice(knowns, known_count)?);
        let out = slice_mut(sensitivity, unknown_count)?;
        instance.directional(unknowns, knowns, slice(seed, known_count)?, out)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetRealInputDerivatives(
    component: Component,
    references: *const u32,
    count: usize,
    orders: *const c_int,
    values: *const f64,
) -> c_int {
    run(component, |instance| {
        instance.set_slopes(
            slice(references, count)?,
            slice(orders, count)?,
            slice(values, count)?,
        )
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealOutputDerivatives(
    component: Component,
    references: *const u32,
    count: usize,
    orders: *const c_int,
    values: *mut f64,
) -> c_int {
    run(component, |instance| {
        instance.get_slopes(
            slice(references, count)?,
            slice(orders, count)?,
            slice_mut(values, count)?,
        )
    })
}

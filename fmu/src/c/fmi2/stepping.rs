//! The functions of FMI 2.0 for co-simulation. Steps are made at once: none is ever pending.

use super::Boolean;
use crate::c::{DISCARD, OK, Status, put, values, with};
use crate::instance::{Failure, Kind};
use std::ffi::{c_char, c_int, c_void};

/// `fmi2LastSuccessfulTime` and `fmi2Terminated` of `fmi2StatusKind`.
const LAST_TIME: c_int = 2;
const TERMINATED: c_int = 3;

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetRealInputDerivatives(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    orders: *const c_int,
    values: *const f64,
) -> Status {
    let name = "fmi2SetRealInputDerivatives";
    unsafe { values::set_derivatives(instance, name, references, count, orders, values) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealOutputDerivatives(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    orders: *const c_int,
    values: *mut f64,
) -> Status {
    let name = "fmi2GetRealOutputDerivatives";
    unsafe { values::get_derivatives(instance, name, references, count, orders, values) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DoStep(
    instance: *mut c_void,
    from: f64,
    size: f64,
    _no_earlier_state: Boolean,
) -> Status {
    unsafe { with(instance, "fmi2DoStep", |x| x.step(from, size).map(|_| ())) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2CancelStep(instance: *mut c_void) -> Status {
    unsafe {
        with(instance, "fmi2CancelStep", |_| {
            Err(Failure("no step is pending".into()))
        })
    }
}

/// A question about the last step that has no answer, as no step is pending.
unsafe fn unknown(instance: *mut c_void, function: &str) -> Status {
    match unsafe { with(instance, function, |_| Ok(())) } {
        OK => DISCARD,
        status => status,
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetStatus(
    instance: *mut c_void,
    _kind: c_int,
    _value: *mut Status,
) -> Status {
    unsafe { unknown(instance, "fmi2GetStatus") }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealStatus(
    instance: *mut c_void,
    kind: c_int,
    value: *mut f64,
) -> Status {
    let name = "fmi2GetRealStatus";
    unsafe {
        match kind {
            LAST_TIME => with(instance, name, |x| {
                put(value, x.time());
                Ok(())
            }),
            _ => unknown(instance, name),
        }
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetIntegerStatus(
    instance: *mut c_void,
    _kind: c_int,
    _value: *mut c_int,
) -> Status {
    unsafe { unknown(instance, "fmi2GetIntegerStatus") }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBooleanStatus(
    instance: *mut c_void,
    kind: c_int,
    value: *mut Boolean,
) -> Status {
    let name = "fmi2GetBooleanStatus";
    unsafe {
        match kind {
            // The FMU never asks the host to end the simulation.
            TERMINATED => with(instance, name, |x| {
                x.running(Kind::CoSimulation)?;
                put(value, 0);
                Ok(())
            }),
            _ => unknown(instance, name),
        }
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetStringStatus(
    instance: *mut c_void,
    _kind: c_int,
    _value: *mut *const c_char,
) -> Status {
    unsafe { unknown(instance, "fmi2GetStringStatus") }
}

//! Accessors that FMI 2 and FMI 3 share: numbers, truth values, derivatives of outputs, continuous states.
//!
//! Lists of references and values have the length `count`.

use super::{Status, fill, read, with};
use crate::instance::{CallResult, Instance};
use std::ffi::{c_int, c_void};

/// Reads the values of variables.
///
/// # Safety
/// As [`with`], [`read`] and [`fill`].
pub unsafe fn get(
    instance: *mut c_void,
    function: &str,
    references: *const u32,
    count: usize,
    values: *mut f64,
) -> Status {
    unsafe {
        with(instance, function, |x| {
            let references = read(references, count)?;
            for (reference, value) in references.iter().zip(fill(values, count)?) {
                *value = x.get(*reference)?;
            }
            Ok(())
        })
    }
}

/// Sets the values of variables.
///
/// # Safety
/// As [`with`] and [`read`].
pub unsafe fn set(
    instance: *mut c_void,
    function: &str,
    references: *const u32,
    count: usize,
    values: *const f64,
) -> Status {
    unsafe {
        with(instance, function, |x| {
            let (references, values) = (read(references, count)?, read(values, count)?);
            let mut pairs = references.iter().zip(values);
            pairs.try_for_each(|(reference, value)| x.set(*reference, *value))
        })
    }
}

/// Reads truth values, which have the type `T` in the host.
///
/// # Safety
/// As [`with`], [`read`] and [`fill`].
pub unsafe fn get_flags<T: From<bool>>(
    instance: *mut c_void,
    function: &str,
    references: *const u32,
    count: usize,
    values: *mut T,
) -> Status {
    unsafe {
        with(instance, function, |x| {
            let references = read(references, count)?;
            for (reference, value) in references.iter().zip(fill(values, count)?) {
                *value = x.get_flag(*reference)?.into();
            }
            Ok(())
        })
    }
}

/// Sets truth values. A host of C may pass any bits, so that they have an integer type here.
///
/// # Safety
/// As [`with`] and [`read`].
pub unsafe fn set_flags<T: Copy + Into<c_int>>(
    instance: *mut c_void,
    function: &str,
    references: *const u32,
    count: usize,
    values: *const T,
) -> Status {
    unsafe {
        with(instance, function, |x| {
            let (references, values) = (read(references, count)?, read(values, count)?);
            let mut pairs = references.iter().zip(values);
            pairs.try_for_each(|(reference, value)| x.set_flag(*reference, (*value).into() != 0))
        })
    }
}

/// Reads time derivatives of outputs.
///
/// # Safety
/// As [`with`], [`read`] and [`fill`].
pub unsafe fn get_derivatives(
    instance: *mut c_void,
    function: &str,
    references: *const u32,
    count: usize,
    orders: *const c_int,
    values: *mut f64,
) -> Status {
    unsafe {
        with(instance, function, |x| {
            let (references, orders) = (read(references, count)?, read(orders, count)?);
            let pairs = references.iter().zip(orders);
            for ((reference, order), value) in pairs.zip(fill(values, count)?) {
                *value = x.slope(*reference, *order)?;
            }
            Ok(())
        })
    }
}

/// Sets time derivatives of inputs for the next communication step.
///
/// # Safety
/// As [`with`] and [`read`].
pub unsafe fn set_derivatives(
    instance: *mut c_void,
    function: &str,
    references: *const u32,
    count: usize,
    orders: *const c_int,
    values: *const f64,
) -> Status {
    unsafe {
        with(instance, function, |x| {
            let (references, orders) = (read(references, count)?, read(orders, count)?);
            let mut pairs = references.iter().zip(orders).zip(read(values, count)?);
            pairs.try_for_each(|((reference, order), value)| {
                x.set_input_derivative(*reference, *order, *value)
            })
        })
    }
}

/// Reads a list of `count` numbers of an instance.
///
/// # Safety
/// As [`with`] and [`fill`].
pub unsafe fn list(
    instance: *mut c_void,
    function: &str,
    values: *mut f64,
    count: usize,
    of: impl FnOnce(&mut Instance, &mut [f64]) -> CallResult,
) -> Status {
    unsafe { with(instance, function, |x| of(x, fill(values, count)?)) }
}

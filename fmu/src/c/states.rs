//! Copies of the state for the host: as objects that it returns to, and as bytes that it may store.

use super::{Status, fill, put, read, with};
use crate::instance::{Failure, Snapshot};
use std::ffi::c_void;
use std::ptr::null_mut;

fn missing() -> Failure {
    Failure("the state is missing".into())
}

/// Makes a copy and stores it at a place of the host; one that is there already is replaced.
///
/// # Safety
/// `state` is null or a place with null or a copy.
unsafe fn keep(
    state: *mut *mut c_void,
    make: impl FnOnce() -> Result<Snapshot, Failure>,
) -> Result<(), Failure> {
    unsafe {
        // SAFETY: null, or a place of the host.
        let Some(state) = state.as_mut() else {
            return Err(Failure("the place for the state is missing".into()));
        };
        let copy = make()?;
        match state.cast::<Snapshot>().as_mut() {
            Some(old) => *old = copy,
            None => *state = Box::into_raw(Box::new(copy)).cast(),
        }
        Ok(())
    }
}

/// Copies the state of an instance to a place of the host. A copy that is there already is replaced.
///
/// # Safety
/// As [`with`]; `state` is null or a place with null or a copy.
pub unsafe fn get(instance: *mut c_void, function: &str, state: *mut *mut c_void) -> Status {
    unsafe { with(instance, function, |x| keep(state, || Ok(x.snapshot()))) }
}

/// Returns an instance to a copy.
///
/// # Safety
/// As [`with`]; `state` is null or a copy.
pub unsafe fn set(instance: *mut c_void, function: &str, state: *mut c_void) -> Status {
    unsafe {
        with(instance, function, |x| {
            // SAFETY: null, or made by `get`.
            let state = state.cast::<Snapshot>().as_ref().ok_or_else(missing)?;
            x.restore(state);
            Ok(())
        })
    }
}

/// Frees a copy.
///
/// # Safety
/// As [`get`].
pub unsafe fn free(instance: *mut c_void, function: &str, state: *mut *mut c_void) -> Status {
    unsafe {
        with(instance, function, |_| {
            // SAFETY: null, or a place of the host with null or what `get` made.
            if let Some(state) = state.as_mut()
                && !state.is_null()
            {
                drop(Box::from_raw(state.cast::<Snapshot>()));
                *state = null_mut();
            }
            Ok(())
        })
    }
}

/// Writes the number of bytes of a copy.
///
/// # Safety
/// As [`set`]; `size` is null or a place of the host.
pub unsafe fn size(
    instance: *mut c_void,
    function: &str,
    state: *mut c_void,
    size: *mut usize,
) -> Status {
    unsafe {
        with(instance, function, |x| {
            // SAFETY: null, or made by `get`.
            let state = state.cast::<Snapshot>().as_ref().ok_or_else(missing)?;
            put(size, x.serialise(state)?.len());
            Ok(())
        })
    }
}

/// Writes a copy to `count` bytes of the host.
///
/// # Safety
/// As [`set`] and [`fill`].
pub unsafe fn serialise(
    instance: *mut c_void,
    function: &str,
    state: *mut c_void,
    bytes: *mut u8,
    count: usize,
) -> Status {
    unsafe {
        with(instance, function, |x| {
            // SAFETY: null, or made by `get`.
            let state = state.cast::<Snapshot>().as_ref().ok_or_else(missing)?;
            let stored = x.serialise(state)?;
            if count < stored.len() {
                let needed = stored.len();
                return Err(Failure(format!(
                    "the state needs {needed} bytes, but the host gave {count}"
                )));
            }
            fill(bytes, stored.len())?.copy_from_slice(&stored);
            Ok(())
        })
    }
}

/// Makes a copy from bytes.
///
/// # Safety
/// As [`get`] and [`read`].
pub unsafe fn deserialise(
    instance: *mut c_void,
    function: &str,
    bytes: *const u8,
    count: usize,
    state: *mut *mut c_void,
) -> Status {
    unsafe {
        with(instance, function, |x| {
            keep(state, || x.deserialise(read(bytes, count)?))
        })
    }
}

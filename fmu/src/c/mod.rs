//! The C functions of FMI 3.0, as declared in `fmi3Functions.h`. All 75 exist, as hosts look up each of them.
//!
//! | module | owns |
//! |---|---|
//! | `common` | instances, co-simulation, variables, copies of the state |
//! | `exchange` | model exchange |
//! | `unsupported` | functions for missing features: other types, clocks, serialisation, partial derivatives |
//!
//! Every function trusts the pointers of its host, as C does, checks them for null, and catches panics.

// Names and arguments are those of the standard.
#![allow(
    non_snake_case,
    missing_docs,
    clippy::missing_safety_doc,
    clippy::too_many_arguments
)]

pub mod common;
pub mod exchange;
pub mod unsupported;

use crate::instance::{CallResult, Failure, Instance};
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Return code of FMI functions, `fmi3Status`.
pub type Status = c_int;
pub const OK: Status = 0;
pub const ERROR: Status = 3;
pub const FATAL: Status = 4;

/// Callback for messages to the host, `fmi3LogMessageCallback`.
pub type Log = Option<unsafe extern "C" fn(*mut c_void, Status, *const c_char, *const c_char)>;

/// The object behind the pointer `fmi3Instance`.
pub(crate) struct Handle {
    instance: Instance,
    name: String,
    logger: Logger,
}

/// Callback of the host for messages, with its environment.
#[derive(Clone, Copy)]
pub(crate) struct Logger {
    environment: *mut c_void,
    log: Log,
}

impl Logger {
    fn log(self, status: Status, message: &str) {
        let Some(log) = self.log else { return };
        let text: String = message.replace('\0', " ");
        if let Ok(text) = CString::new(text) {
            // SAFETY: the host gave the function and the environment for it, and both texts end with a zero.
            unsafe {
                log(
                    self.environment,
                    status,
                    c"logStatusError".as_ptr(),
                    text.as_ptr(),
                );
            }
        }
    }
}

/// Runs a function and converts a panic to an error.
fn caught<T>(act: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(act)).map_err(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text = text.or(panic.downcast_ref::<&str>().copied());
        format!("internal error: {}", text.unwrap_or("no message"))
    })
}

/// Calls a function on an instance and logs its failure.
///
/// # Safety
/// `instance` is null, or was returned by an instantiating function, is not freed and not in use elsewhere.
unsafe fn with(
    instance: *mut c_void,
    function: &str,
    act: impl FnOnce(&mut Instance) -> CallResult,
) -> Status {
    // SAFETY: see above.
    let Some(handle) = (unsafe { instance.cast::<Handle>().as_mut() }) else {
        return ERROR;
    };
    let (status, why) = match caught(|| act(&mut handle.instance)) {
        Ok(Ok(())) => return OK,
        Ok(Err(Failure(why))) => (ERROR, why),
        Err(why) => (FATAL, why),
    };
    let name = &handle.name;
    handle
        .logger
        .log(status, &format!("{name}: {function}: {why}"));
    status
}

/// Borrows an array of the host for reading.
///
/// # Safety
/// `p` is null or points to `n` of them.
unsafe fn read<'a, T>(p: *const T, n: usize) -> CallResult<&'a [T]> {
    match (n, p.is_null()) {
        (0, _) => Ok(&[]),
        (_, true) => Err(Failure("a list is missing".into())),
        // SAFETY: see above.
        _ => Ok(unsafe { std::slice::from_raw_parts(p, n) }),
    }
}

/// Borrows an array of the host for writing.
///
/// # Safety
/// `p` is null or points to `n` elements, which are not in use elsewhere.
unsafe fn fill<'a, T>(p: *mut T, n: usize) -> CallResult<&'a mut [T]> {
    match (n, p.is_null()) {
        (0, _) => Ok(&mut []),
        (_, true) => Err(Failure("a list is missing".into())),
        // SAFETY: see above.
        _ => Ok(unsafe { std::slice::from_raw_parts_mut(p, n) }),
    }
}

/// Writes a value to a pointer unless it is null.
///
/// # Safety
/// `p` is null or may be written to.
unsafe fn put<T>(p: *mut T, x: T) {
    if !p.is_null() {
        // SAFETY: see above.
        unsafe { p.write(x) }
    }
}

/// Reads a C string of the host; empty for a null pointer.
///
/// # Safety
/// `p` is null or a text that ends with a zero.
unsafe fn text(p: *const c_char) -> String {
    match p.is_null() {
        true => String::new(),
        // SAFETY: see above.
        false => unsafe { CStr::from_ptr(p) }.to_string_lossy().into_owned(),
    }
}

/// Checks that the numbers of references and values are equal.
fn paired(references: usize, values: usize) -> CallResult {
    match references == values {
        true => Ok(()),
        false => Err(Failure(format!(
            "{references} references, but {values} values"
        ))),
    }
}

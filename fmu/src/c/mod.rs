//! The C functions of FMI 3.0 and FMI 2.0, as declared in `fmi3Functions.h` (75) and `fmi2Functions.h` (44). All exist, as
//! hosts look up each of them. Both are facades over one [`Instance`].
//!
//! | module | owns |
//! |---|---|
//! | `fmi2`, `fmi3` | names, arguments and types of the two standards |
//! | `values` | accessors that both standards share: variables, continuous states, derivatives of outputs |
//! | `states` | copies of the state as objects and as bytes |
//!
//! Every function trusts the pointers of its host, as C does, checks them for null, and catches panics.

// Names and arguments are those of the standards.
#![allow(
    non_snake_case,
    missing_docs,
    clippy::missing_safety_doc,
    clippy::too_many_arguments
)]

pub mod fmi2;
pub mod fmi3;
mod states;
mod values;

use crate::instance::{CallResult, Failure, Instance, Kind};
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::ptr::null_mut;

/// Return code of FMI functions, `fmi3Status` and `fmi2Status`.
pub type Status = c_int;
pub const OK: Status = 0;
/// FMI 2 alone: the requested information does not exist.
pub const DISCARD: Status = 2;
pub const ERROR: Status = 3;
pub const FATAL: Status = 4;

/// Callback for messages to the host, `fmi3LogMessageCallback`.
pub type Log = Option<unsafe extern "C" fn(*mut c_void, Status, *const c_char, *const c_char)>;

/// Callback for messages to the host of FMI 2, `fmi2CallbackLogger`. The message is a format of `printf`.
pub type Log2 = Option<
    unsafe extern "C" fn(*mut c_void, *const c_char, Status, *const c_char, *const c_char, ...),
>;

/// The object behind the pointers `fmi3Instance` and `fmi2Component`.
pub(crate) struct Handle {
    instance: Instance,
    name: String,
    logger: Logger,
}

/// Callback of the host for messages, with its environment.
#[derive(Clone, Copy)]
pub(crate) struct Logger {
    environment: *mut c_void,
    log: Callback,
}

/// The logging function of either standard.
#[derive(Clone, Copy)]
pub(crate) enum Callback {
    Fmi2(Log2),
    Fmi3(Log),
}

/// Category of all messages, as the model description lists it.
const CATEGORY: &CStr = c"logStatusError";

/// Converts a text to C; its zeros become spaces.
fn c_text(text: &str) -> CString {
    CString::new(text.replace('\0', " ")).unwrap_or_default()
}

impl Logger {
    fn log(self, name: &str, status: Status, message: &str) {
        // SAFETY: the host gave the function and the environment for it, and all texts end with a zero.
        match self.log {
            Callback::Fmi3(Some(log)) => {
                let text = c_text(&format!("{name}: {message}"));
                unsafe { log(self.environment, status, CATEGORY.as_ptr(), text.as_ptr()) }
            }
            Callback::Fmi2(Some(log)) => {
                // A percent sign of the message is not one of the format.
                let (name, text) = (c_text(name), c_text(&message.replace('%', "%%")));
                let environment = self.environment;
                unsafe {
                    log(
                        environment,
                        name.as_ptr(),
                        status,
                        CATEGORY.as_ptr(),
                        text.as_ptr(),
                    );
                }
            }
            Callback::Fmi2(None) | Callback::Fmi3(None) => {}
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

/// Opens an instance from the folder of its resources; null if that fails, with a message to the host.
fn open(kind: Kind, name: String, token: &str, resources: &Path, logger: Logger) -> *mut c_void {
    let opened = caught(|| Instance::open(kind, resources, token).map_err(|e| e.to_string()));
    match opened {
        Ok(Ok(instance)) => Box::into_raw(Box::new(Handle {
            instance,
            name,
            logger,
        }))
        .cast(),
        Ok(Err(why)) | Err(why) => {
            logger.log(&name, ERROR, &why);
            null_mut()
        }
    }
}

/// Frees an instance.
///
/// # Safety
/// `instance` is null, or was returned by [`open`] and is not freed.
unsafe fn free(instance: *mut c_void) {
    if !instance.is_null() {
        // SAFETY: see above.
        let handle = unsafe { Box::from_raw(instance.cast::<Handle>()) };
        let _ = caught(|| drop(handle));
    }
}

/// Calls a function on an instance and logs its failure.
///
/// # Safety
/// `instance` is null, or was returned by [`open`], is not freed and not in use elsewhere.
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
    (handle.logger).log(&handle.name, status, &format!("{function}: {why}"));
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

/// Succeeds for zero variables; otherwise fails, as no variable of the type exists.
fn none(count: usize, what: &str) -> CallResult {
    match count {
        0 => Ok(()),
        _ => Err(Failure(format!("there are no variables of type {what}"))),
    }
}

//! The functions of FMI 2.0 that co-simulation and model exchange share.

use super::Boolean;
use crate::c::{
    Callback, ERROR, Log2, Logger, Status, free, none, open, states, text, values, with,
};
use crate::instance::{Failure, Instance, Kind};
use std::ffi::{c_char, c_int, c_void};
use std::path::PathBuf;
use std::ptr::null_mut;

/// `fmi2CallbackFunctions`. Memory is that of the library, so that the functions for memory are not called.
#[repr(C)]
pub struct Callbacks {
    pub logger: Log2,
    pub allocate: *const c_void,
    pub free: *const c_void,
    pub step_finished: *const c_void,
    pub environment: *mut c_void,
}

/// `fmi2Type`.
const MODEL_EXCHANGE: c_int = 0;
const CO_SIMULATION: c_int = 1;

#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetDebugLogging(
    instance: *mut c_void,
    _on: Boolean,
    _count: usize,
    _categories: *const *const c_char,
) -> Status {
    // Only errors are logged, whatever the debug setting.
    unsafe { with(instance, "fmi2SetDebugLogging", |_| Ok(())) }
}

/// Converts the location of the resources, a URI of RFC 3986, to a path.
pub(crate) fn path_of(location: &str) -> PathBuf {
    let Some(rest) = location.strip_prefix("file:") else {
        return PathBuf::from(location);
    };
    // `file:///path`, `file://localhost/path`, `file:/path`.
    let path = match rest.strip_prefix("//") {
        Some(rest) => &rest[rest.find('/').unwrap_or(rest.len())..],
        None => rest,
    };
    let mut bytes = Vec::with_capacity(path.len());
    let mut rest = path.as_bytes();
    let digit = |b: u8| (b as char).to_digit(16);
    while let Some((&first, after)) = rest.split_first() {
        let code = match (first, after) {
            (b'%', [a, b, ..]) => digit(*a).zip(digit(*b)),
            _ => None,
        };
        match code {
            Some((a, b)) => {
                bytes.push((16 * a + b) as u8);
                rest = &after[2..];
            }
            None => {
                bytes.push(first);
                rest = after;
            }
        }
    }
    let path = String::from_utf8_lossy(&bytes).into_owned();
    // `/C:/path` of Windows.
    match path.as_bytes() {
        [b'/', drive, b':', ..] if drive.is_ascii_alphabetic() => PathBuf::from(&path[1..]),
        _ => PathBuf::from(path),
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Instantiate(
    name: *const c_char,
    kind: c_int,
    guid: *const c_char,
    resources: *const c_char,
    callbacks: *const Callbacks,
    _visible: Boolean,
    _logging: Boolean,
) -> *mut c_void {
    // SAFETY: null, or the functions of the host.
    let given = unsafe { callbacks.as_ref() };
    let logger = Logger {
        environment: given.map_or(null_mut(), |c| c.environment),
        log: Callback::Fmi2(given.and_then(|c| c.logger)),
    };
    // SAFETY: texts of the host.
    let [name, guid, resources] = [name, guid, resources].map(|p| unsafe { text(p) });
    if name.is_empty() {
        logger.log("", ERROR, "the name of the instance is missing");
        return null_mut();
    }
    let kind = match kind {
        MODEL_EXCHANGE => Kind::ModelExchange,
        CO_SIMULATION => Kind::CoSimulation,
        _ => {
            let why = format!("there is no type {kind} of FMUs, only 0 (exchange) and 1 (steps)");
            logger.log(&name, ERROR, &why);
            return null_mut();
        }
    };
    open(kind, name, &guid, &path_of(&resources), logger)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeInstance(instance: *mut c_void) {
    unsafe { free(instance) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetupExperiment(
    instance: *mut c_void,
    _tolerance_defined: Boolean,
    _tolerance: f64,
    start: f64,
    stop_defined: Boolean,
    stop: f64,
) -> Status {
    unsafe {
        with(instance, "fmi2SetupExperiment", |x| {
            x.set_experiment(start, (stop_defined != 0).then_some(stop))
        })
    }
}

/// Functions without arguments beside the instance.
macro_rules! plain {
    ($($name:ident: $act:expr;)*) => { $(
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(instance: *mut c_void) -> Status {
            unsafe { with(instance, stringify!($name), $act) }
        }
    )* };
}

plain! {
    fmi2EnterInitializationMode: Instance::enter_initialisation;
    fmi2ExitInitializationMode: Instance::exit_initialisation;
    fmi2Terminate: Instance::terminate;
    fmi2Reset: |x| {
        x.reset();
        Ok(())
    };
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetReal(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    values: *mut f64,
) -> Status {
    unsafe { values::get(instance, "fmi2GetReal", references, count, values) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetReal(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    values: *const f64,
) -> Status {
    unsafe { values::set(instance, "fmi2SetReal", references, count, values) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBoolean(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    values: *mut Boolean,
) -> Status {
    unsafe { values::get_flags(instance, "fmi2GetBoolean", references, count, values) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetBoolean(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    values: *const Boolean,
) -> Status {
    unsafe { values::set_flags(instance, "fmi2SetBoolean", references, count, values) }
}

/// Accessors of variables of a type that does not occur.
macro_rules! no_variables {
    ($($get:ident, $set:ident, $value:ty, $what:literal;)*) => { $(
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $get(
            instance: *mut c_void,
            _references: *const u32,
            count: usize,
            _values: *mut $value,
        ) -> Status {
            unsafe { with(instance, stringify!($get), |_| none(count, $what)) }
        }

        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $set(
            instance: *mut c_void,
            _references: *const u32,
            count: usize,
            _values: *const $value,
        ) -> Status {
            unsafe { with(instance, stringify!($set), |_| none(count, $what)) }
        }
    )* };
}

no_variables! {
    fmi2GetInteger, fmi2SetInteger, c_int, "Integer";
    fmi2GetString, fmi2SetString, *const c_char, "String";
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetFMUstate(instance: *mut c_void, state: *mut *mut c_void) -> Status {
    unsafe { states::get(instance, "fmi2GetFMUstate", state) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetFMUstate(instance: *mut c_void, state: *mut c_void) -> Status {
    unsafe { states::set(instance, "fmi2SetFMUstate", state) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeFMUstate(
    instance: *mut c_void,
    state: *mut *mut c_void,
) -> Status {
    unsafe { states::free(instance, "fmi2FreeFMUstate", state) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializedFMUstateSize(
    instance: *mut c_void,
    state: *mut c_void,
    size: *mut usize,
) -> Status {
    unsafe { states::size(instance, "fmi2SerializedFMUstateSize", state, size) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializeFMUstate(
    instance: *mut c_void,
    state: *mut c_void,
    bytes: *mut u8,
    size: usize,
) -> Status {
    unsafe { states::serialise(instance, "fmi2SerializeFMUstate", state, bytes, size) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DeSerializeFMUstate(
    instance: *mut c_void,
    bytes: *const u8,
    size: usize,
    state: *mut *mut c_void,
) -> Status {
    unsafe { states::deserialise(instance, "fmi2DeSerializeFMUstate", bytes, size, state) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetDirectionalDerivative(
    instance: *mut c_void,
    _unknowns: *const u32,
    _unknown_count: usize,
    _knowns: *const u32,
    _known_count: usize,
    _seed: *const f64,
    _sensitivity: *mut f64,
) -> Status {
    unsafe {
        with(instance, "fmi2GetDirectionalDerivative", |_| {
            Err(Failure("there are no partial derivatives".into()))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::path_of;
    use std::path::Path;

    #[test]
    fn locations_of_resources_become_paths() {
        for (location, path) in [
            ("file:///tmp/a%20b/resources", "/tmp/a b/resources"),
            ("file:/tmp/a", "/tmp/a"),
            ("file://localhost/tmp/100%", "/tmp/100%"),
            ("file:///tmp/%C3%A4", "/tmp/\u{e4}"),
            ("file:///C:/fmu", "C:/fmu"),
            ("/tmp/plain", "/tmp/plain"),
        ] {
            assert_eq!(path_of(location), Path::new(path), "{location}");
        }
    }
}

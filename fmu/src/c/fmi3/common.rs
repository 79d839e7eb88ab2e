//! The functions of FMI 3.0 for instances, co-simulation, variables and copies of the state.

use crate::c::{
    Callback, ERROR, Log, Logger, OK, Status, free, open, paired, put, states, text, values, with,
};
use crate::instance::{Instance, Kind};
use std::ffi::{c_char, c_int, c_void};
use std::path::PathBuf;
use std::ptr::null_mut;

#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetDebugLogging(
    instance: *mut c_void,
    _on: bool,
    _count: usize,
    _categories: *const *const c_char,
) -> Status {
    // Only errors are logged, whatever the debug setting.
    unsafe { with(instance, "fmi3SetDebugLogging", |_| Ok(())) }
}

unsafe fn instantiate(
    kind: Kind,
    name: *const c_char,
    token: *const c_char,
    resources: *const c_char,
    logger: Logger,
) -> *mut c_void {
    if name.is_null() {
        logger.log("", ERROR, "the name of the instance is missing");
        return null_mut();
    }
    // SAFETY: texts of the host.
    let [name, token, resources] = [name, token, resources].map(|p| unsafe { text(p) });
    let path = PathBuf::from(resources.strip_prefix("file://").unwrap_or(&resources));
    open(kind, name, &token, &path, logger)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
    name: *const c_char,
    token: *const c_char,
    resources: *const c_char,
    _visible: bool,
    _logging: bool,
    _event_mode: bool,
    _early_return: bool,
    _required: *const u32,
    _required_count: usize,
    environment: *mut c_void,
    log: Log,
    _intermediate: *const c_void,
) -> *mut c_void {
    let logger = Logger {
        environment,
        log: Callback::Fmi3(log),
    };
    unsafe { instantiate(Kind::CoSimulation, name, token, resources, logger) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateModelExchange(
    name: *const c_char,
    token: *const c_char,
    resources: *const c_char,
    _visible: bool,
    _logging: bool,
    environment: *mut c_void,
    log: Log,
) -> *mut c_void {
    let logger = Logger {
        environment,
        log: Callback::Fmi3(log),
    };
    unsafe { instantiate(Kind::ModelExchange, name, token, resources, logger) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeInstance(instance: *mut c_void) {
    unsafe { free(instance) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterInitializationMode(
    instance: *mut c_void,
    _tolerance_defined: bool,
    _tolerance: f64,
    start: f64,
    stop_defined: bool,
    stop: f64,
) -> Status {
    unsafe {
        with(instance, "fmi3EnterInitializationMode", |x| {
            x.set_experiment(start, stop_defined.then_some(stop))?;
            x.enter_initialisation()
        })
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3ExitInitializationMode(instance: *mut c_void) -> Status {
    unsafe {
        with(
            instance,
            "fmi3ExitInitializationMode",
            Instance::exit_initialisation,
        )
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3Terminate(instance: *mut c_void) -> Status {
    unsafe { with(instance, "fmi3Terminate", Instance::terminate) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3Reset(instance: *mut c_void) -> Status {
    unsafe {
        with(instance, "fmi3Reset", |x| {
            x.reset();
            Ok(())
        })
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFloat64(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    values: *mut f64,
    value_count: usize,
) -> Status {
    unsafe {
        match with(instance, "fmi3GetFloat64", |_| paired(count, value_count)) {
            OK => values::get(instance, "fmi3GetFloat64", references, count, values),
            status => status,
        }
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFloat64(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    values: *const f64,
    value_count: usize,
) -> Status {
    unsafe {
        match with(instance, "fmi3SetFloat64", |_| paired(count, value_count)) {
            OK => values::set(instance, "fmi3SetFloat64", references, count, values),
            status => status,
        }
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetBoolean(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    values: *mut bool,
    value_count: usize,
) -> Status {
    unsafe {
        match with(instance, "fmi3GetBoolean", |_| paired(count, value_count)) {
            OK => values::get_flags(instance, "fmi3GetBoolean", references, count, values),
            status => status,
        }
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetBoolean(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    values: *const u8,
    value_count: usize,
) -> Status {
    unsafe {
        match with(instance, "fmi3SetBoolean", |_| paired(count, value_count)) {
            OK => values::set_flags(instance, "fmi3SetBoolean", references, count, values),
            status => status,
        }
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFMUState(instance: *mut c_void, state: *mut *mut c_void) -> Status {
    unsafe { states::get(instance, "fmi3GetFMUState", state) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFMUState(instance: *mut c_void, state: *mut c_void) -> Status {
    unsafe { states::set(instance, "fmi3SetFMUState", state) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeFMUState(
    instance: *mut c_void,
    state: *mut *mut c_void,
) -> Status {
    unsafe { states::free(instance, "fmi3FreeFMUState", state) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializedFMUStateSize(
    instance: *mut c_void,
    state: *mut c_void,
    size: *mut usize,
) -> Status {
    unsafe { states::size(instance, "fmi3SerializedFMUStateSize", state, size) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializeFMUState(
    instance: *mut c_void,
    state: *mut c_void,
    bytes: *mut u8,
    size: usize,
) -> Status {
    unsafe { states::serialise(instance, "fmi3SerializeFMUState", state, bytes, size) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DeserializeFMUState(
    instance: *mut c_void,
    bytes: *const u8,
    size: usize,
    state: *mut *mut c_void,
) -> Status {
    unsafe { states::deserialise(instance, "fmi3DeserializeFMUState", bytes, size, state) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterStepMode(instance: *mut c_void) -> Status {
    unsafe {
        with(instance, "fmi3EnterStepMode", |x| {
            x.running(Kind::CoSimulation)
        })
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DoStep(
    instance: *mut c_void,
    from: f64,
    size: f64,
    _no_earlier_state: bool,
    event_handling: *mut bool,
    terminate: *mut bool,
    early_return: *mut bool,
    last: *mut f64,
) -> Status {
    unsafe {
        put(event_handling, false);
        put(terminate, false);
        put(early_return, false);
        let mut reached = from;
        let status = with(instance, "fmi3DoStep", |x| {
            let done = x.step(from, size);
            reached = x.time();
            done.map(|_| ())
        });
        put(last, reached);
        status
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetOutputDerivatives(
    instance: *mut c_void,
    references: *const u32,
    count: usize,
    orders: *const c_int,
    values: *mut f64,
    value_count: usize,
) -> Status {
    let name = "fmi3GetOutputDerivatives";
    unsafe {
        match with(instance, name, |_| paired(count, value_count)) {
            OK => values::get_derivatives(instance, name, references, count, orders, values),
            status => status,
        }
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EvaluateDiscreteStates(instance: *mut c_void) -> Status {
    match instance.is_null() {
        true => ERROR,
        false => OK,
    }
}

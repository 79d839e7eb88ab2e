//! The functions of FMI 3.0 for instances, co-simulation, variables and copies of the state.

use super::{ERROR, Handle, Log, Logger, OK, Status, caught, fill, paired, put, read, text, with};
use crate::instance::{Failure, Instance, Kind, Snapshot};
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
        logger.log(ERROR, "the name of the instance is missing");
        return null_mut();
    }
    // SAFETY: texts of the host.
    let [name, token, resources] = [name, token, resources].map(|p| unsafe { text(p) });
    let path = PathBuf::from(resources.strip_prefix("file://").unwrap_or(&resources));
    let made = caught(|| Instance::open(kind, &path, &token).map_err(|e| e.to_string()));
    match made {
        Ok(Ok(instance)) => Box::into_raw(Box::new(Handle {
            instance,
            name,
            logger,
        }))
        .cast(),
        Ok(Err(why)) | Err(why) => {
            logger.log(ERROR, &format!("{name}: {why}"));
            null_mut()
        }
    }
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
    let logger = Logger { environment, log };
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
    let logger = Logger { environment, log };
    unsafe { instantiate(Kind::ModelExchange, name, token, resources, logger) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeInstance(instance: *mut c_void) {
    if !instance.is_null() {
        // SAFETY: made by `instantiate`, freed once.
        let handle = unsafe { Box::from_raw(instance.cast::<Handle>()) };
        let _ = caught(|| drop(handle));
    }
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
            x.enter_initialisation(start, stop_defined.then_some(stop))
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
        with(instance, "fmi3GetFloat64", |x| {
            paired(count, value_count)?;
            let references = read(references, count)?;
            for (reference, value) in references.iter().zip(fill(values, count)?) {
                *value = x.get(*reference)?;
            }
            Ok(())
        })
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
        with(instance, "fmi3SetFloat64", |x| {
            paired(count, value_count)?;
            let (references, values) = (read(references, count)?, read(values, count)?);
            let mut pairs = references.iter().zip(values);
            pairs.try_for_each(|(reference, value)| x.set(*reference, *value))
        })
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
        with(instance, "fmi3GetBoolean", |x| {
            paired(count, value_count)?;
            let references = read(references, count)?;
            for (reference, value) in references.iter().zip(fill(values, count)?) {
                *value = x.get_flag(*reference)?;
            }
            Ok(())
        })
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
        with(instance, "fmi3SetBoolean", |x| {
            paired(count, value_count)?;
            // A host of C may hand over any byte.
            let (references, values) = (read(references, count)?, read(values, count)?);
            let mut pairs = references.iter().zip(values);
            pairs.try_for_each(|(reference, value)| x.set_flag(*reference, *value != 0))
        })
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFMUState(instance: *mut c_void, state: *mut *mut c_void) -> Status {
    unsafe {
        with(instance, "fmi3GetFMUState", |x| {
            // SAFETY: null, or a place of the host.
            let Some(state) = state.as_mut() else {
                return Err(Failure("the place for the state is missing".into()));
            };
            let copy = x.snapshot();
            // A state that is there already is used again.
            match state.cast::<Snapshot>().as_mut() {
                Some(old) => *old = copy,
                None => *state = Box::into_raw(Box::new(copy)).cast(),
            }
            Ok(())
        })
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFMUState(instance: *mut c_void, state: *mut c_void) -> Status {
    unsafe {
        with(instance, "fmi3SetFMUState", |x| {
            // SAFETY: null, or made by `fmi3GetFMUState`.
            let Some(state) = state.cast::<Snapshot>().as_ref() else {
                return Err(Failure("the state is missing".into()));
            };
            x.restore(state);
            Ok(())
        })
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeFMUState(
    instance: *mut c_void,
    state: *mut *mut c_void,
) -> Status {
    unsafe {
        with(instance, "fmi3FreeFMUState", |_| {
            // SAFETY: null, or a place of the host with null or what `fmi3GetFMUState` made.
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
    unsafe {
        with(instance, "fmi3GetOutputDerivatives", |x| {
            paired(count, value_count)?;
            let (references, orders) = (read(references, count)?, read(orders, count)?);
            let pairs = references.iter().zip(orders);
            for ((reference, order), value) in pairs.zip(fill(values, count)?) {
                *value = x.slope(*reference, *order)?;
            }
            Ok(())
        })
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EvaluateDiscreteStates(instance: *mut c_void) -> Status {
    match instance.is_null() {
        true => ERROR,
        false => OK,
    }
}

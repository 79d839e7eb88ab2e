//! The functions of FMI 3.0 for model exchange.

use crate::c::{Status, put, read, values, with};
use crate::instance::{Instance, Kind};
use std::ffi::c_void;

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterEventMode(instance: *mut c_void) -> Status {
    unsafe {
        with(instance, "fmi3EnterEventMode", |x| {
            x.running(Kind::ModelExchange)
        })
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterContinuousTimeMode(instance: *mut c_void) -> Status {
    unsafe {
        with(instance, "fmi3EnterContinuousTimeMode", |x| {
            x.running(Kind::ModelExchange)
        })
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3UpdateDiscreteStates(
    instance: *mut c_void,
    again: *mut bool,
    terminate: *mut bool,
    nominals_changed: *mut bool,
    states_changed: *mut bool,
    next_defined: *mut bool,
    next: *mut f64,
) -> Status {
    unsafe {
        put(again, false);
        put(terminate, false);
        put(nominals_changed, false);
        put(states_changed, false);
        put(next_defined, false);
        with(instance, "fmi3UpdateDiscreteStates", |x| {
            // In co-simulation events are the instance's own.
            if x.kind() == Kind::CoSimulation {
                return Ok(());
            }
            let update = Instance::update(x)?;
            put(states_changed, update.moved);
            put(next_defined, update.next.is_some());
            put(next, update.next.unwrap_or(f64::INFINITY));
            Ok(())
        })
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3CompletedIntegratorStep(
    instance: *mut c_void,
    _no_earlier_state: bool,
    enter_event: *mut bool,
    terminate: *mut bool,
) -> Status {
    unsafe {
        put(enter_event, false);
        put(terminate, false);
        with(instance, "fmi3CompletedIntegratorStep", |x| {
            put(enter_event, x.completed()?);
            Ok(())
        })
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetTime(instance: *mut c_void, time: f64) -> Status {
    unsafe { with(instance, "fmi3SetTime", |x| x.set_time(time)) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetContinuousStates(
    instance: *mut c_void,
    states: *const f64,
    count: usize,
) -> Status {
    unsafe {
        with(instance, "fmi3SetContinuousStates", |x| {
            x.set_states(read(states, count)?)
        })
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetContinuousStates(
    instance: *mut c_void,
    states: *mut f64,
    count: usize,
) -> Status {
    unsafe {
        values::list(
            instance,
            "fmi3GetContinuousStates",
            states,
            count,
            |x, to| x.states(to),
        )
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetContinuousStateDerivatives(
    instance: *mut c_void,
    derivatives: *mut f64,
    count: usize,
) -> Status {
    unsafe {
        values::list(
            instance,
            "fmi3GetContinuousStateDerivatives",
            derivatives,
            count,
            Instance::derivatives,
        )
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetNominalsOfContinuousStates(
    instance: *mut c_void,
    nominals: *mut f64,
    count: usize,
) -> Status {
    unsafe {
        values::list(
            instance,
            "fmi3GetNominalsOfContinuousStates",
            nominals,
            count,
            |x, to| x.nominals(to),
        )
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetEventIndicators(
    instance: *mut c_void,
    indicators: *mut f64,
    count: usize,
) -> Status {
    unsafe {
        values::list(
            instance,
            "fmi3GetEventIndicators",
            indicators,
            count,
            Instance::event_functions,
        )
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetNumberOfEventIndicators(
    instance: *mut c_void,
    count: *mut usize,
) -> Status {
    unsafe {
        with(instance, "fmi3GetNumberOfEventIndicators", |x| {
            put(count, x.interface().event_functions);
            Ok(())
        })
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetNumberOfContinuousStates(
    instance: *mut c_void,
    count: *mut usize,
) -> Status {
    unsafe {
        with(instance, "fmi3GetNumberOfContinuousStates", |x| {
            put(count, x.interface().states);
            Ok(())
        })
    }
}

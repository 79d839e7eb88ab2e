//! The functions of FMI 2.0 for model exchange.

use super::Boolean;
use crate::c::{Status, put, read, values, with};
use crate::instance::{Instance, Kind};
use std::ffi::c_void;

/// `fmi2EventInfo`.
#[repr(C)]
pub struct EventInfo {
    pub again: Boolean,
    pub terminate: Boolean,
    pub nominals_changed: Boolean,
    pub states_changed: Boolean,
    pub next_defined: Boolean,
    pub next: f64,
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterEventMode(instance: *mut c_void) -> Status {
    unsafe {
        with(instance, "fmi2EnterEventMode", |x| {
            x.running(Kind::ModelExchange)
        })
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2NewDiscreteStates(
    instance: *mut c_void,
    info: *mut EventInfo,
) -> Status {
    unsafe {
        with(instance, "fmi2NewDiscreteStates", |x| {
            let update = Instance::update(x)?;
            let found = EventInfo {
                again: 0,
                terminate: 0,
                nominals_changed: 0,
                states_changed: update.moved.into(),
                next_defined: update.next.is_some().into(),
                next: update.next.unwrap_or(f64::INFINITY),
            };
            put(info, found);
            Ok(())
        })
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterContinuousTimeMode(instance: *mut c_void) -> Status {
    unsafe {
        with(instance, "fmi2EnterContinuousTimeMode", |x| {
            x.running(Kind::ModelExchange)
        })
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2CompletedIntegratorStep(
    instance: *mut c_void,
    _no_earlier_state: Boolean,
    enter_event: *mut Boolean,
    terminate: *mut Boolean,
) -> Status {
    unsafe {
        put(enter_event, 0);
        put(terminate, 0);
        with(instance, "fmi2CompletedIntegratorStep", |x| {
            put(enter_event, x.completed()?.into());
            Ok(())
        })
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetTime(instance: *mut c_void, time: f64) -> Status {
    unsafe { with(instance, "fmi2SetTime", |x| x.set_time(time)) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetContinuousStates(
    instance: *mut c_void,
    states: *const f64,
    count: usize,
) -> Status {
    unsafe {
        with(instance, "fmi2SetContinuousStates", |x| {
            x.set_states(read(states, count)?)
        })
    }
}

/// Functions that read one list of numbers.
macro_rules! lists {
    ($($name:ident: $act:expr;)*) => { $(
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(
            instance: *mut c_void,
            values: *mut f64,
            count: usize,
        ) -> Status {
            unsafe { values::list(instance, stringify!($name), values, count, $act) }
        }
    )* };
}

lists! {
    fmi2GetDerivatives: Instance::derivatives;
    fmi2GetEventIndicators: Instance::event_functions;
    fmi2GetContinuousStates: |x, to| x.states(to);
    fmi2GetNominalsOfContinuousStates: |x, to| x.nominals(to);
}

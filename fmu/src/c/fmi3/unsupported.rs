//! Functions of FMI 3.0 for features that these FMUs do not have: variables of other types, clocks, partial
//! derivatives, scheduled execution. A call for zero variables succeeds; any other call logs the missing
//! feature and fails.

use crate::c::{Callback, ERROR, Log, Logger, Status, none, text, with};
use crate::instance::Failure;
use std::ffi::{c_char, c_void};
use std::ptr::null_mut;

/// Accessors of variables of a type that does not occur: `(instance, references, count, values, value count)`.
macro_rules! no_variables {
    ($($get:ident, $set:ident, $value:ty, $what:literal;)*) => { $(
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $get(
            instance: *mut c_void,
            _references: *const u32,
            count: usize,
            _values: *mut $value,
            _value_count: usize,
        ) -> Status {
            unsafe { with(instance, stringify!($get), |_| none(count, $what)) }
        }

        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $set(
            instance: *mut c_void,
            _references: *const u32,
            count: usize,
            _values: *const $value,
            _value_count: usize,
        ) -> Status {
            unsafe { with(instance, stringify!($set), |_| none(count, $what)) }
        }
    )* };
}

no_variables! {
    fmi3GetFloat32, fmi3SetFloat32, f32, "Float32";
    fmi3GetInt8, fmi3SetInt8, i8, "Int8";
    fmi3GetUInt8, fmi3SetUInt8, u8, "UInt8";
    fmi3GetInt16, fmi3SetInt16, i16, "Int16";
    fmi3GetUInt16, fmi3SetUInt16, u16, "UInt16";
    fmi3GetInt32, fmi3SetInt32, i32, "Int32";
    fmi3GetUInt32, fmi3SetUInt32, u32, "UInt32";
    fmi3GetInt64, fmi3SetInt64, i64, "Int64";
    fmi3GetUInt64, fmi3SetUInt64, u64, "UInt64";
    fmi3GetString, fmi3SetString, *const c_char, "String";
}

/// Functions for features that do not exist; they always fail.
macro_rules! absent {
    ($($name:ident($($argument:ident: $type:ty),*), $why:literal;)*) => { $(
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(instance: *mut c_void $(, $argument: $type)*) -> Status {
            $(let _ = $argument;)*
            unsafe { with(instance, stringify!($name), |_| Err(Failure($why.into()))) }
        }
    )* };
}

/// Functions over a list of variables of a type that does not occur; only an empty list succeeds.
macro_rules! absent_of {
    ($($name:ident($($argument:ident: $type:ty),*), $what:literal;)*) => { $(
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(
            instance: *mut c_void,
            _references: *const u32,
            count: usize
            $(, $argument: $type)*
        ) -> Status {
            $(let _ = $argument;)*
            unsafe { with(instance, stringify!($name), |_| none(count, $what)) }
        }
    )* };
}

absent_of! {
    fmi3GetBinary(sizes: *mut usize, values: *mut *const u8, value_count: usize), "Binary";
    fmi3SetBinary(sizes: *const usize, values: *const *const u8, value_count: usize), "Binary";
    fmi3GetClock(values: *mut bool), "Clock";
    fmi3SetClock(values: *const bool), "Clock";
    fmi3GetIntervalDecimal(intervals: *mut f64, qualifiers: *mut i32), "Clock";
    fmi3GetIntervalFraction(counters: *mut u64, resolutions: *mut u64, qualifiers: *mut i32), "Clock";
    fmi3GetShiftDecimal(shifts: *mut f64), "Clock";
    fmi3GetShiftFraction(counters: *mut u64, resolutions: *mut u64), "Clock";
    fmi3SetIntervalDecimal(intervals: *const f64), "Clock";
    fmi3SetIntervalFraction(counters: *const u64, resolutions: *const u64), "Clock";
    fmi3SetShiftDecimal(shifts: *const f64), "Clock";
    fmi3SetShiftFraction(counters: *const u64, resolutions: *const u64), "Clock";
}

absent! {
    fmi3GetNumberOfVariableDependencies(reference: u32, count: *mut usize), "dependencies are not known: every output may depend on every input";
    fmi3GetVariableDependencies(dependent: u32, elements: *mut usize, independents: *mut u32, independent_elements: *mut usize, kinds: *mut i32, count: usize), "dependencies are not known: every output may depend on every input";
    fmi3GetDirectionalDerivative(unknowns: *const u32, unknown_count: usize, knowns: *const u32, known_count: usize, seed: *const f64, seed_count: usize, sensitivity: *mut f64, sensitivity_count: usize), "there are no partial derivatives";
    fmi3GetAdjointDerivative(unknowns: *const u32, unknown_count: usize, knowns: *const u32, known_count: usize, seed: *const f64, seed_count: usize, sensitivity: *mut f64, sensitivity_count: usize), "there are no partial derivatives";
    fmi3EnterConfigurationMode(), "there are no structural parameters";
    fmi3ExitConfigurationMode(), "there are no structural parameters";
    fmi3ActivateModelPartition(clock: u32, time: f64), "there are no model partitions";
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateScheduledExecution(
    name: *const c_char,
    _token: *const c_char,
    _resources: *const c_char,
    _visible: bool,
    _logging: bool,
    environment: *mut c_void,
    log: Log,
    _clock_update: *const c_void,
    _lock: *const c_void,
    _unlock: *const c_void,
) -> *mut c_void {
    // SAFETY: a text of the host.
    let name = unsafe { text(name) };
    let logger = Logger {
        environment,
        log: Callback::Fmi3(log),
    };
    let why = "there is no scheduled execution, take co-simulation or model exchange";
    logger.log(&name, ERROR, why);
    null_mut()
}

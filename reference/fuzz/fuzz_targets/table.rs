//! Whatever the bytes: a table is read or refused with a place in its text, and what is read ascends in time and is finite.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../checks.rs"]
#[allow(dead_code)]
mod checks;

fuzz_target!(|data: &[u8]| checks::table(data));

//! Fuzz target of tables: any bytes are read or refused with a position in the text, and a table that is read is
//! finite and ascending in time.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../checks.rs"]
#[allow(dead_code)]
mod checks;

fuzz_target!(|data: &[u8]| checks::table(data));

//! Whatever the bytes: a deck is read or declined, its gears are found or declined, and nothing panics,
//! hangs or takes memory out of proportion. Includes come from the same bytes.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../checks.rs"]
#[allow(dead_code)]
mod checks;

fuzz_target!(|data: &[u8]| checks::deck(data));

//! Fuzz target of decks: any bytes are read or declined, gears are found or declined, and nothing panics, hangs or
//! uses memory out of proportion. Includes come from the same bytes.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../checks.rs"]
#[allow(dead_code)]
mod checks;

fuzz_target!(|data: &[u8]| checks::deck(data));

//! Whatever the bytes: a mesh of Gmsh is read or declined, and what is read hangs together.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../checks.rs"]
#[allow(dead_code)]
mod checks;

fuzz_target!(|data: &[u8]| checks::msh(data));

//! Fuzz target of Gmsh meshes: any bytes are read or declined, and a mesh that is read is consistent.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../checks.rs"]
#[allow(dead_code)]
mod checks;

fuzz_target!(|data: &[u8]| checks::msh(data));

//! Whatever the bytes: a mesh of Gmsh is read or declined, and what is read hangs together.
#![no_main]

use gearbench_reference::{deck, mesh};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let text = String::from_utf8_lossy(data);
    // What does not begin as such a mesh is a deck: that is the other target's.
    let text = match text.starts_with("$MeshFormat") {
        true => text.into_owned(),
        false => format!("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n{text}"),
    };
    let mut none = |name: &str| Err(std::io::Error::other(format!("no file {name}")));
    match deck::read_str("fuzz.msh", &text, &mut none) {
        Ok(deck) => {
            let mesh = deck.mesh();
            assert_eq!(mesh.element_count(), deck.element_count());
            assert!(mesh.connectivity().all(|n| (n as usize) < mesh.nodes.len()));
            for face in mesh.boundary() {
                assert!(mesh.face_corners(face).len() >= 3);
            }
            assert!(mesh::element_qualities(&mesh).count() == mesh.element_count());
            assert!(deck.told().iter().all(|line| !line.is_empty()));
            let _ = deck::gears(&deck).map_err(|e| assert!(!e.to_string().is_empty()));
        }
        Err(e) => assert!(e.line > 0 || !e.found.is_empty()),
    }
});

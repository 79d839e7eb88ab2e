//! Replay of the corpora of the fuzz targets: the invariants for arbitrary bytes hold for every seed and for its
//! neighbours.

#[path = "../fuzz/checks.rs"]
mod checks;

/// The seeds of a target in the order of their names.
fn seeds(target: &str) -> Vec<(String, Vec<u8>)> {
    let folder = format!("{}/fuzz/corpus/{target}", env!("CARGO_MANIFEST_DIR"));
    let mut paths: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|f| f.unwrap().path())
        .collect();
    paths.sort();
    let named = paths.into_iter().map(|path| {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        (name, std::fs::read(path).unwrap())
    });
    named.collect()
}

/// Checks files truncated at some forty positions, and with one byte changed there.
fn nearby(bytes: &[u8], check: fn(&[u8])) {
    for cut in (0..bytes.len()).step_by(1 + bytes.len() / 40) {
        check(&bytes[..cut]);
        let mut changed = bytes.to_vec();
        changed[cut] ^= 1 << (cut % 8);
        check(&changed);
    }
}

#[test]
fn decks() {
    let seeds = seeds("deck");
    assert!(seeds.len() >= 10, "{}", seeds.len());
    for (_, bytes) in seeds {
        checks::deck(&bytes);
        nearby(&bytes, checks::deck);
    }
}

#[test]
fn meshes_of_gmsh() {
    let seeds = seeds("msh");
    assert!(seeds.len() >= 9, "{}", seeds.len());
    for (name, bytes) in seeds {
        checks::msh(&bytes);
        nearby(&bytes, checks::msh);
        // What the fuzzer found is there to be replayed; the meshes of Gmsh are sound.
        let read = gearbench_reference::deck::read_bytes(&name, &bytes);
        assert!(read.is_ok() || name.starts_with("found"), "{name}");
    }
}

#[test]
fn tables() {
    let seeds = seeds("table");
    assert!(seeds.len() >= 20, "{}", seeds.len());
    for (_, bytes) in seeds {
        checks::table(&bytes);
        for cut in 0..bytes.len() {
            checks::table(&bytes[..cut]);
            let mut changed = bytes.clone();
            for with in [b',', b';', b'"', b'\n', b'#', 0xb5, b'-', b'e'] {
                changed[cut] = with;
                checks::table(&changed);
            }
        }
    }
}

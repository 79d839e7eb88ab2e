//! Invariants of the readers for arbitrary bytes, for the fuzz targets, `examples/fuzz_readers.rs` and
//! `tests/corpora.rs`.

use gearbench_reference::data::{
    GearSubject, MeshSubject, Processing, Request, Subjects, Turning, decode, read,
};
use gearbench_reference::{deck, gear_deck, mesh};

/// Checks that a deck is read or declined, its gears are found or declined, and nothing panics, hangs or uses memory
/// out of proportion. Includes come from the same bytes.
pub fn deck(data: &[u8]) {
    let text = String::from_utf8_lossy(data);
    // `part` includes the second half, everything else is missing.
    let mut resolver = |name: &str| match name {
        "part" => {
            let middle = (0..=text.len() / 2)
                .rev()
                .find(|&i| text.is_char_boundary(i));
            Ok(text[middle.unwrap_or(0)..].to_owned())
        }
        "all" => Ok(text.clone().into_owned()),
        other => Err(std::io::Error::other(format!("no file {other}"))),
    };
    match deck::read_str("fuzz.inp", &text, &mut resolver) {
        Ok(deck) => {
            assert!(deck.told().iter().all(|line| !line.is_empty()));
            hangs_together(&deck);
            for finding in gear_deck::check_gtm(&deck) {
                assert!(!finding.to_string().is_empty());
            }
            match gear_deck::gears(&deck) {
                Ok(gears) => {
                    for g in &gears {
                        assert!(g.phase.is_finite() && g.centre.iter().all(|x| x.is_finite()));
                        for f in &g.mesh.flanks {
                            assert_eq!(f.nodes.len(), f.rows * f.columns);
                            assert!(f.tooth < g.mesh.teeth);
                        }
                    }
                }
                Err(e) => assert!(!e.to_string().is_empty()),
            }
        }
        Err(e) => assert!(e.line > 0 || !e.found.is_empty()),
    }
}

/// Checks that a mesh of Gmsh, text or binary, is read or declined, and that a mesh that is read is consistent.
pub fn msh(data: &[u8]) {
    // What does not begin as such a mesh is a deck: that is the other target's.
    let whole;
    let data = match data.starts_with(b"$MeshFormat") {
        true => data,
        false => {
            whole = [&b"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"[..], data].concat();
            &whole
        }
    };
    match deck::read_bytes("fuzz.msh", data) {
        Ok(deck) => {
            hangs_together(&deck);
            assert!(deck.told().iter().all(|line| !line.is_empty()));
            let _ = gear_deck::gears(&deck).map_err(|e| assert!(!e.to_string().is_empty()));
        }
        Err(e) => assert!(e.line > 0 || !e.found.is_empty()),
    }
}

/// Checks that a table is read or refused with a position in its text, and that a table that is read is finite and
/// ascending in time.
pub fn table(data: &[u8]) {
    let Ok((text, _)) = decode(data) else { return };
    let gear = |name: &str, slides| GearSubject {
        name: name.into(),
        slides,
        toothed: true,
    };
    let subjects = Subjects {
        gears: vec![gear("pinion", None), gear("wheel", Some(0.02))],
        spans: vec![["motor", "pinion"].map(Into::into)],
        meshes: vec![MeshSubject {
            gears: ["pinion", "wheel"].map(Into::into),
            base_helix: 0.3,
            base_radius: Some(0.05),
        }],
        turning: Some(Turning {
            speed: -100.0,
            teeth: 20,
        }),
    };
    let processed = Request {
        processing: Processing {
            time_factor: Some(1.001),
            offset: -1e-4,
            zero: Some([0.0, 1e-3]),
            moving_average: Some(1e-5),
            from: 0.0,
            to: Some(1.0),
            resample: Some(1e-3),
        },
        ..Request::default()
    };
    for request in [Request::default(), processed] {
        match read(&text, &request, &subjects) {
            Ok(found) => {
                assert!(!found.channels.is_empty());
                for c in &found.channels {
                    assert!(c.time.len() >= 3 && c.time.len() == c.value.len());
                    assert!(c.time.windows(2).all(|w| w[0] < w[1]), "{text}");
                    assert!(c.value.iter().all(|x| x.is_finite()), "{text}");
                }
            }
            Err(e) => {
                assert!(text.get(e.at.clone()).is_some(), "{e}\n{text}");
                assert!(!e.to_string().is_empty());
            }
        }
    }
}

fn hangs_together(deck: &deck::Deck) {
    let mesh = deck.mesh();
    assert_eq!(mesh.element_count(), deck.element_count());
    let nodes = mesh.nodes.len();
    assert!(mesh.connectivity().all(|n| (n as usize) < nodes));
    assert!(
        mesh.node_sets
            .values()
            .flatten()
            .all(|&n| (n as usize) < nodes)
    );
    let sets = deck.element_sets.values().flatten();
    assert!(sets.copied().all(|e| (e as usize) < mesh.element_count()));
    for &face in mesh
        .boundary()
        .iter()
        .chain(mesh.face_sets.values().flatten())
    {
        assert!(mesh.face_corners(face).len() >= 3);
    }
    assert!(mesh::element_qualities(&mesh).count() == mesh.element_count());
}

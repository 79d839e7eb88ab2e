//! Decks that would take a reader down: includes without end, lines without end, foreign files, damaged archives.

use super::{BRICKS, none};
use crate::{DeckErrorKind, MAX_INCLUDES, MAX_LINE_BYTES, read, read_bytes, read_str};
use std::io::Write;

fn refused(text: &str) -> crate::DeckError {
    read_str("a.inp", text, &mut none).unwrap_err()
}

/// Few files that include each other several times: depth is bounded, and so is their number.
#[test]
fn includes_are_bounded_in_number() {
    let mut asked = 0;
    let mut resolver = |name: &str| {
        asked += 1;
        let depth: usize = name
            .trim_matches(|c: char| !c.is_ascii_digit())
            .parse()
            .unwrap();
        Ok(match depth {
            8.. => String::new(),
            _ => format!("*INCLUDE, INPUT=i{}.inp\n", depth + 1).repeat(8),
        })
    };
    let e = read_str("a.inp", "*INCLUDE, INPUT=i0.inp\n", &mut resolver).unwrap_err();
    assert_eq!(e.kind, DeckErrorKind::Limit);
    assert!(e.to_string().contains("includes in total"), "{e}");
    assert!(asked <= MAX_INCLUDES);
}

#[test]
fn lines_are_bounded() {
    let long = format!("*NODE\n1, {}\n", "0".repeat(MAX_LINE_BYTES));
    assert_eq!(refused(&long).kind, DeckErrorKind::Limit);
    let continued = format!("*NSET, NSET=a,\n{}", "b=c,\n".repeat(MAX_LINE_BYTES / 4));
    assert_eq!(refused(&continued).kind, DeckErrorKind::Limit);
}

/// A deck that includes a file of the machine does not bring its text into a log.
#[test]
fn foreign_files_are_not_quoted() {
    for name in ["/proc/self/environ", "../secret"] {
        let text = format!("*INCLUDE, INPUT={name}\n");
        let e = read_str(
            "folder/a.inp",
            &text,
            &mut |_| Ok("PASSWORD=12345\n".into()),
        );
        let said = e.unwrap_err().to_string();
        assert!(
            said.contains("not shown") && !said.contains("12345"),
            "{said}"
        );
    }
    let own = read_str("folder/a.inp", "*INCLUDE, INPUT=b.inp\n", &mut |_| {
        Ok("word\n".into())
    });
    assert!(own.unwrap_err().to_string().contains("word"));
}

#[test]
fn archives_with_something_behind_say_so() {
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    packed.write_all(BRICKS.as_bytes()).unwrap();
    let mut bytes = packed.finish().unwrap();
    assert!(read_bytes("a.inp.gz", &bytes).is_ok());
    bytes.extend(b"junk behind it");
    let said = read_bytes("a.inp.gz", &bytes).unwrap_err().to_string();
    assert!(said.contains("followed by other bytes"), "{said}");
}

#[test]
fn twins_and_impossible_numbers_are_refused() {
    let twins = refused(&format!(
        "{BRICKS}*ELEMENT, TYPE=C3D8\n41,1,2,3,4,5,6,7,8\n"
    ));
    assert!(
        twins
            .to_string()
            .contains("elements 1 and 41 on the same nodes"),
        "{twins}"
    );
    let e = refused(&format!("{BRICKS}*TRANSFORM, NSET=all\nnan,0,0,1,0,0\n"));
    assert!(e.to_string().contains("finite number"), "{e}");
    let e = refused(&format!("{BRICKS}*BOUNDARY\nall, 1, 99999999\n"));
    assert!(e.to_string().contains("direction 99999999"), "{e}");
}

/// A pipe in the place of a deck would keep the reader waiting for ever.
#[cfg(unix)]
#[test]
fn pipes_and_folders_are_no_decks() {
    let folder = tempfile::tempdir().unwrap();
    let fifo = folder.path().join("a.inp");
    std::process::Command::new("mkfifo")
        .arg(&fifo)
        .status()
        .unwrap();
    let said = read(&fifo).unwrap_err().to_string();
    assert!(said.contains("regular file"), "{said}");
    assert!(
        read(folder.path())
            .unwrap_err()
            .to_string()
            .contains("folder")
    );
    let deck = folder.path().join("b.inp");
    std::fs::write(&deck, "*INCLUDE, INPUT=a.inp\n").unwrap();
    assert!(
        read(&deck)
            .unwrap_err()
            .to_string()
            .contains("regular file")
    );
}

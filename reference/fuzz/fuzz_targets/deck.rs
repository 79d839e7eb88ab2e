//! Whatever the bytes: a deck is read or declined, its gears are found or declined, and nothing panics,
//! hangs or takes memory out of proportion. Includes come from the same bytes.
#![no_main]

use gearbench_reference::deck;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
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
            for finding in deck::check_gtm(&deck) {
                assert!(!finding.to_string().is_empty());
            }
            match deck::gears(&deck) {
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
});

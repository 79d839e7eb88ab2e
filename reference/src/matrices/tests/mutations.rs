//! Mutated files of every format: each is read or refused, and a refusal states what was expected and found.

use super::*;

/// Number of mutated files of each format without `GEARBENCH_MATRIX_FILES`.
const FILES: usize = 100;

/// A sequence of numbers that is the same in every run (SplitMix64).
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(1);
        (crate::hash::spread(self.0) % n.max(1) as u64) as usize
    }
}

/// One to four changes: a byte, a removed or doubled piece, a word of another kind, an end.
fn mutated(bytes: &[u8], random: &mut Random) -> Vec<u8> {
    const WORDS: [&str; 12] = [
        "-1",
        "0",
        "4294967296",
        "1e999",
        "NaN",
        "****",
        "18446744073709551616",
        ".",
        ",",
        "\n",
        " -1",
        "(1I0)",
    ];
    let mut out = bytes.to_vec();
    for _ in 0..=random.below(4) {
        let at = random.below(out.len());
        match random.below(6) {
            0 => {
                if let Some(b) = out.get_mut(at) {
                    *b = random.below(256) as u8;
                }
            }
            1 => out.truncate(at),
            2 => {
                let end = (at + 1 + random.below(40)).min(out.len());
                out.drain(at.min(end)..end);
            }
            3 => {
                let end = (at + random.below(80)).min(out.len());
                let piece = out[at.min(end)..end].to_vec();
                out.splice(at..at, piece);
            }
            4 => {
                let word = WORDS[random.below(WORDS.len())];
                out.splice(at..at, word.bytes());
            }
            // The head decides about everything behind it.
            _ => {
                let at = random.below(out.len().min(400));
                if let Some(b) = out.get_mut(at) {
                    *b = b"0123456789-. (I"[random.below(15)];
                }
            }
        }
    }
    out
}

#[test]
fn mutated_files_are_read_or_refused() {
    let count = std::env::var("GEARBENCH_MATRIX_FILES").ok();
    let count = count.map_or(FILES, |n| n.parse().unwrap());
    let body = Body::small();
    let (shapes, frequencies) = held_shapes(&body, 3);
    let mut random = Random(41);
    let (mut accepted, mut refused) = (0, 0);
    let mut judge = |result: Result<(), MatrixError>| match result {
        Ok(()) => accepted += 1,
        Err(e) => {
            refused += 1;
            assert!(
                !e.expected.is_empty() && !e.found.is_empty() && !e.file.is_empty(),
                "{e}"
            );
        }
    };
    for (_, first, files, _) in formats(&body.assembly) {
        let mut names: Vec<&String> = files.0.keys().collect();
        names.sort();
        for _ in 0..count {
            let name = names[random.below(names.len())];
            let bytes = mutated(&files.0[name], &mut random);
            judge(
                body.foreign(&[first], &files.clone().with(name, bytes))
                    .map(drop),
            );
        }
    }
    for (name, bytes) in [
        ("g.frd", printed::frd(&shapes, &frequencies).into_bytes()),
        ("g.dat", printed::dat(&shapes, &frequencies).into_bytes()),
        (
            "j.dat",
            printed::abaqus_dat(&shapes, &frequencies).into_bytes(),
        ),
        ("s.npz", printed::arrays(&body.assembly, Some(&shapes))),
    ] {
        for _ in 0..count {
            let files = Files::default().with(name, mutated(&bytes, &mut random));
            let read = read_shapes(name, &mut |name| files.read(name));
            judge(read.and_then(|s| {
                ForeignBody::new(None, Some(&s), &body.frame(), &body.gear.mesh, &STEEL).map(drop)
            }));
        }
    }
    // Most changes damage a file, and some do not.
    assert_eq!(accepted + refused, 10 * count);
    assert!(refused > 4 * count && accepted > 0, "{accepted} {refused}");
}

//! Damaged scenes are refused or accepted without a panic, and every error can be rendered.

use super::{BASE, parse, render};
use crate::scene_file::SHIPPED;

fn survives(text: &str) {
    if let Err(error) = parse(text) {
        render(&error);
    }
}

#[test]
fn truncated_scenes() {
    for end in (0..BASE.len()).filter(|&i| BASE.is_char_boundary(i)) {
        survives(&BASE[..end]);
        survives(&BASE[end..]);
    }
    for scene in SHIPPED {
        for end in (0..scene.text.len())
            .step_by(397)
            .filter(|&i| scene.text.is_char_boundary(i))
        {
            survives(&scene.text[..end]);
        }
    }
}

/// Text pieces that replace others, separated by blanks.
const PIECES: &str = "\" [ ] { } = , nan -1 0 1e308 -1e-308 1e999 true [[ ]] é '' # . 0x7fffffffffffffff \
                      99999999999999999999 1979-05-27 [] {}";

/// One value of every type.
const VALUES: &str = "\"text\" | 3 | -3 | 0 | 0.5 | nan | 1e300 | 1e-300 | true | [] | [1] | {} | { a = 1 } | [{}] | [[]]";

/// Replaces, deletes and duplicates pieces at places chosen by a linear congruential generator with fixed seed.
#[test]
fn mutated_scenes() {
    let mut pieces = vec!["", "\n", "\u{0}"];
    pieces.extend(PIECES.split(' '));
    let mut seed: u64 = 20_061_107;
    let mut next = |n: usize| {
        seed = seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize % n.max(1)
    };
    for round in 0..4000 {
        let mut text = BASE.to_owned();
        for _ in 0..=round % 3 {
            let (at, cut) = (next(text.len()), next(12));
            let start = (0..=at)
                .rev()
                .find(|&i| text.is_char_boundary(i))
                .unwrap_or(0);
            let end = (start + cut..=text.len())
                .find(|&i| text.is_char_boundary(i))
                .unwrap_or(text.len());
            text.replace_range(start..end, pieces[next(pieces.len())]);
        }
        survives(&text);
    }
}

/// Replaces every value of the scene by a value of every type.
#[test]
fn every_value_of_every_type() {
    let lines: Vec<&str> = BASE.lines().collect();
    for (i, line) in lines.iter().enumerate() {
        let Some((key, _)) = line.split_once(" = ") else {
            continue;
        };
        for value in VALUES.split(" | ") {
            let mut text = lines.clone();
            let new = format!("{key} = {value}");
            text[i] = &new;
            survives(&text.join("\n"));
        }
    }
}

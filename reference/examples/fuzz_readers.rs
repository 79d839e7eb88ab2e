//! Throws mutated decks, meshes and tables at the readers, where there is no nightly compiler for libFuzzer.
//!
//!     cargo run --release -p gearbench-reference --example fuzz_readers \
//!         --config profile.release.package.gearbench-reference.overflow-checks=true \
//!         --config profile.release.package.gearbench-reference.debug-assertions=true \
//!         -- deck|msh|table SECONDS [SEED]
//!
//! Inputs come from `fuzz/corpus` and words from `fuzz/*.dict`. An input that is answered in a way not seen before,
//! digits aside, joins the pool: a coarse stand-in for coverage. What panics is written to `crash-TARGET.txt`.
#![allow(clippy::print_stdout)]

#[path = "../fuzz/checks.rs"]
mod checks;

use gearbench_reference::{data, deck, gear_deck};
use std::collections::HashSet;
use std::error::Error;
use std::path::Path;
use std::time::{Duration, Instant};

/// Longest input [bytes].
const LONGEST: usize = 8192;
/// Most inputs in the pool.
const LARGEST: usize = 20_000;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [target, seconds, rest @ ..] = arguments.as_slice() else {
        return Err("usage: fuzz_readers deck|msh|table SECONDS [SEED]".into());
    };
    let check: fn(&[u8]) = match target.as_str() {
        "deck" => checks::deck,
        "msh" => checks::msh,
        "table" => checks::table,
        other => return Err(format!("there is no target {other}").into()),
    };
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz");
    let mut pool = Vec::new();
    for entry in std::fs::read_dir(folder.join("corpus").join(target))? {
        pool.push(std::fs::read(entry?.path())?);
    }
    let words = std::fs::read_to_string(folder.join(format!("{target}.dict")))?;
    let words: Vec<&str> = words
        .lines()
        .filter_map(|l| l.strip_prefix('"')?.strip_suffix('"'))
        .collect();
    let mut random = Random(rest.first().map_or(Ok(1), |s| s.parse())?);
    let (mut answers, mut runs, mut slowest) = (HashSet::new(), 0_u64, Duration::ZERO);
    let start = Instant::now();
    let end = Duration::from_secs(seconds.parse()?);
    while start.elapsed() < end {
        let mut input = pool[random.below(pool.len())].clone();
        for _ in 0..=random.below(6) {
            mutate(&mut input, &mut random, &words, &pool);
        }
        input.truncate(LONGEST);
        let begun = Instant::now();
        if std::panic::catch_unwind(|| check(&input)).is_err() {
            std::fs::write(format!("crash-{target}.txt"), &input)?;
            return Err(format!("run {runs} panicked; the input is crash-{target}.txt").into());
        }
        slowest = slowest.max(begun.elapsed());
        if pool.len() < LARGEST && answers.insert(answer(target, &input)) {
            pool.push(input);
        }
        runs += 1;
    }
    println!(
        "{target}: {runs} inputs in {} s, {} kinds of answers, the slowest took {slowest:?}; no panic",
        start.elapsed().as_secs(),
        answers.len()
    );
    Ok(())
}

/// Returns the response to an input without text that the input itself contains: digits, and names in quotes.
fn answer(target: &str, input: &[u8]) -> String {
    let plain = |words: &str| -> String {
        let outside = words.split('`').step_by(2);
        let letters = outside.flat_map(str::chars);
        letters.filter(|c| !c.is_ascii_digit()).collect()
    };
    if target == "table" {
        let read = data::decode(input).and_then(|(text, _)| {
            let subjects = data::Subjects::default();
            data::read(&text, &data::Request::default(), &subjects)
        });
        return match read {
            Ok(found) => plain(&found.processing.join(" ")),
            Err(e) => plain(&e.to_string()),
        };
    }
    match deck::read_bytes("fuzz", input) {
        Ok(deck) => {
            let gears = match gear_deck::gears(&deck) {
                Ok(gears) => format!("{} gears", gears.len().min(3)),
                Err(e) => plain(&e.expected),
            };
            let (kinds, instances) = (deck.mesh().kind_names(), deck.instances.len().min(3));
            let passed: Vec<&String> = deck.passed_over.keys().collect();
            format!("{kinds} {instances} {} {gears} {passed:?}", deck.units.name)
        }
        Err(e) => format!("{:?} {} {}", e.kind, plain(&e.expected), plain(&e.help)),
    }
}

/// Changes a part of an input.
fn mutate(input: &mut Vec<u8>, random: &mut Random, words: &[&str], pool: &[Vec<u8>]) {
    let at = random.below(input.len() + 1);
    let end = (at + 1 + random.below(40)).min(input.len());
    let lines: Vec<usize> = (0..input.len()).filter(|&i| input[i] == b'\n').collect();
    let line = |random: &mut Random| match lines.len() {
        0 => 0,
        n => lines[random.below(n)] + 1,
    };
    match random.below(9) {
        0 if at < input.len() => input[at] ^= 1 << random.below(8),
        1 => drop(input.splice(at..at, words[random.below(words.len())].bytes())),
        2 => {
            let from = line(random);
            let word = format!("{}\n", words[random.below(words.len())]);
            input.splice(from..from, word.bytes());
        }
        3 => drop(input.drain(at..end.max(at))),
        4 => {
            let part = input[at..end.max(at)].to_vec();
            let to = random.below(input.len() + 1);
            input.splice(to..to, part);
        }
        5 => {
            // Whole lines of another input.
            let other = &pool[random.below(pool.len())];
            let text: Vec<&[u8]> = other.split_inclusive(|b| *b == b'\n').collect();
            let first = random.below(text.len().max(1));
            let part = text.get(first..(first + 1 + random.below(8)).min(text.len()));
            let to = line(random);
            input.splice(to..to, part.unwrap_or_default().concat());
        }
        6 => {
            let (a, b) = (line(random), line(random));
            drop(input.drain(a.min(b)..a.max(b).min(a.min(b) + 400)));
        }
        _ => {
            // Another number in the place of one.
            let digits: Vec<usize> = (0..input.len())
                .filter(|&i| input[i].is_ascii_digit())
                .collect();
            if digits.is_empty() {
                return;
            }
            let from = digits[random.below(digits.len())];
            let length = input[from..]
                .iter()
                .take_while(|b| b.is_ascii_digit())
                .count();
            let numbers = [
                "0",
                "1",
                "2",
                "3",
                "8",
                "9",
                "-1",
                "1e308",
                "1e-308",
                "nan",
                "4294967295",
                "99999999999",
                "0.5",
                "",
            ];
            input.splice(
                from..from + length,
                numbers[random.below(numbers.len())].bytes(),
            );
        }
    }
}

/// Numbers that look random and repeat (G. Marsaglia, *Xorshift RNGs*, J. Stat. Softw. 8, 2003).
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % n.max(1) as u64) as usize
    }
}

//! Generator of mutated scenes and records; equal seeds give equal mutations on every machine.

use serde_json::{Value, json};

/// Numbers in an order that a seed gives: G. Steele, D. Lea, C. Flood, *Fast splittable pseudorandom number generators*,
/// OOPSLA 2014 (SplitMix64).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x5851_f42d_4c95_7f2d)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let x = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ (x >> 31)
    }

    /// Returns a whole number from 0 to below a bound.
    pub fn below(&mut self, bound: usize) -> usize {
        (self.next() % bound.max(1) as u64) as usize
    }

    pub fn pick<'a, T>(&mut self, all: &'a [T]) -> &'a T {
        &all[self.below(all.len())]
    }
}

const NUMBERS: [&str; 24] = [
    "0",
    "0.0",
    "-1.0",
    "1e-320",
    "1e-300",
    "1e-30",
    "1e-12",
    "1e-6",
    "1e-3",
    "0.1",
    "0.5",
    "1.0",
    "3",
    "17",
    "1000",
    "1000000",
    "1e6",
    "1e12",
    "1e30",
    "1e300",
    "-1e300",
    "nan",
    "inf",
    "9223372036854775807",
];

const TEXTS: [&str; 14] = [
    "\"\"",
    "\"rigid\"",
    "\"elastic\"",
    "\"fe\"",
    "\"../../x\"",
    "\"/dev/zero\"",
    "\"<img src=x onerror=alert(1)>\"",
    "\"=1+1\"",
    "\"\\u0000\\u001b[31m\"",
    "\"a,b\"",
    "\"\\n::error title=x::y\"",
    "\"wheel\"",
    "\"\u{202e}abc\"",
    "\"half-space\"",
];

const VALUES: [&str; 10] = [
    "true",
    "[]",
    "{}",
    "[[1.0, 2.0]]",
    "{ ramp = { from_rad_s = 0.0, to_rad_s = 1e3, start_s = 0.0, end_s = 1e-4 } }",
    "\"text\"",
    "-0.0",
    "[0.0, 0.0, 0.0]",
    "1979-05-27",
    "0x7fffffff",
];

/// Places of the numbers in a text, as ranges of bytes.
fn numbers(text: &str) -> Vec<std::ops::Range<usize>> {
    let mut found = Vec::new();
    let bytes = text.as_bytes();
    let mut at = 0;
    while at < bytes.len() {
        let begins = bytes[at].is_ascii_digit()
            && (at == 0 || matches!(bytes[at - 1], b' ' | b'[' | b'-' | b'='));
        if !begins {
            at += 1;
            continue;
        }
        let is_part = |b: &u8| b.is_ascii_digit() || matches!(b, b'.' | b'e' | b'E' | b'_');
        let mut end = at;
        while end < bytes.len()
            && (is_part(&bytes[end]) || (bytes[end] == b'-' && bytes[end - 1] == b'e'))
        {
            end += 1;
        }
        found.push(at..end);
        at = end.max(at + 1);
    }
    found
}

/// Places of the texts between quotes, with these.
fn texts(text: &str) -> Vec<std::ops::Range<usize>> {
    let quotes: Vec<usize> = text.match_indices('"').map(|(i, _)| i).collect();
    quotes.chunks_exact(2).map(|q| q[0]..q[1] + 1).collect()
}

/// Factors that leave a number plausible more often than not.
const FACTORS: [f64; 6] = [0.1, 0.5, 0.9, 1.1, 2.0, 10.0];

/// A number of a text times a factor: a whole one stays whole.
fn scaled(number: &str, factor: f64) -> String {
    match (number.parse::<u64>(), number.parse::<f64>()) {
        (Ok(n), _) => ((n as f64 * factor).round() as u64).to_string(),
        (_, Ok(x)) => format!("{:e}", x * factor),
        _ => number.to_owned(),
    }
}

/// Returns a scene with one to three changes: numbers scaled and to extremes, keys dropped, doubled and exchanged,
/// types changed, hostile texts.
pub fn scene(base: &str, random: &mut Random) -> String {
    let mut text = base.to_owned();
    for _ in 0..=random.below(3) {
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        let replaced = |text: &str, at: std::ops::Range<usize>, with: &str| {
            format!("{}{with}{}", &text[..at.start], &text[at.end..])
        };
        text = match random.below(12) {
            kind @ (0..=2 | 8..=11) => {
                let all = numbers(&text);
                match all.is_empty() {
                    true => text,
                    false => {
                        let at = random.pick(&all).clone();
                        let with = match kind {
                            0..=2 => (*random.pick(&NUMBERS)).to_owned(),
                            _ => scaled(&text[at.clone()], *random.pick(&FACTORS)),
                        };
                        replaced(&text, at, &with)
                    }
                }
            }
            3 => {
                let all = texts(&text);
                match all.is_empty() {
                    true => text,
                    false => {
                        let at = random.pick(&all).clone();
                        replaced(&text, at, random.pick::<&str>(&TEXTS))
                    }
                }
            }
            4 => {
                let at = random.below(lines.len());
                lines.remove(at);
                lines.join("\n")
            }
            5 => {
                let at = random.below(lines.len());
                let line = lines[at].clone();
                lines.insert(random.below(lines.len()), line);
                lines.join("\n")
            }
            6 => {
                let (a, b) = (random.below(lines.len()), random.below(lines.len()));
                lines.swap(a, b);
                lines.join("\n")
            }
            _ => {
                let at = random.below(lines.len());
                if let Some((key, _)) = lines[at].split_once('=') {
                    lines[at] = format!("{key}= {}", random.pick(&VALUES));
                }
                lines.join("\n")
            }
        };
    }
    text
}

/// Paths of all values in a tree, as JSON pointers.
fn pointers(value: &Value, at: &str, all: &mut Vec<String>) {
    all.push(at.to_owned());
    match value {
        Value::Object(map) => {
            for (key, value) in map {
                let key = key.replace('~', "~0").replace('/', "~1");
                pointers(value, &format!("{at}/{key}"), all);
            }
        }
        // The numbers of a history have the same role, so that the first ones represent all.
        Value::Array(list) => {
            for (i, value) in list.iter().take(8).enumerate() {
                pointers(value, &format!("{at}/{i}"), all);
            }
        }
        _ => {}
    }
}

/// Returns a record with one to three changes: fields dropped, emptied, of another type, at extremes.
pub fn record(base: &Value, random: &mut Random) -> String {
    let mut record = base.clone();
    for _ in 0..=random.below(3) {
        let mut all = Vec::new();
        pointers(&record, "", &mut all);
        let at = random.pick(&all[1..]).clone();
        let (parent, key) = at.rsplit_once('/').unwrap_or_default();
        let value = match random.below(12) {
            0 | 1 => {
                match record.pointer_mut(parent) {
                    Some(Value::Object(map)) => {
                        map.remove(&key.replace("~1", "/").replace("~0", "~"));
                    }
                    Some(Value::Array(list)) if !list.is_empty() => {
                        list.pop();
                    }
                    _ => {}
                }
                continue;
            }
            2 => Value::Null,
            3 => json!([]),
            4 => json!({}),
            5 => json!("<script>alert(1)</script>"),
            6 => json!(1e308),
            7 => json!(-1e308),
            8 => json!(5e-324),
            9 => json!(0),
            10 => json!(u64::MAX / 2 + 1),
            _ => json!(-1),
        };
        if let Some(place) = record.pointer_mut(&at) {
            *place = value;
        }
    }
    record.to_string()
}

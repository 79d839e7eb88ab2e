//! Result files as flat lists of keys and values.

use super::BITS;
use serde_json::value::RawValue;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

/// Largest length of lists of numbers that are written number by number.
const SHORT: usize = 6;

/// Parts of names whose values are times, or depend on times or on the machine.
const TIMED: [&str; 12] = [
    "wall",
    "setup",
    "repeats",
    "machine",
    "commit",
    "created",
    "command",
    "cost",
    "solve_s",
    "cpu",
    "on_front",
    "summaries",
];

/// Keys of a choice that depend on measured times: the cheapest candidate, and data of it alone.
const CHOSEN: [&str; 6] = [
    "chosen",
    "predicted_error",
    "model_error",
    "integration_error",
    "reason",
    "cheapest",
];

/// Keys and values in order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct List(pub BTreeMap<String, String>);

impl List {
    /// Adds a value.
    ///
    /// # Panics
    /// If the key is there already.
    pub fn add(&mut self, key: String, value: String) {
        let before = self.0.insert(key.clone(), value);
        assert!(before.is_none(), "{key} is there twice");
    }

    /// Reads the output of [`List::to_text`] or [`List::to_grouped_text`]; lines that begin with `#` are comments.
    #[must_use]
    pub fn of_text(text: &str) -> List {
        let (mut list, mut within) = (List::default(), "");
        for line in text.lines().filter(|l| !l.starts_with('#')) {
            match (line.split_once(" = "), line.strip_prefix(' ')) {
                (Some((_, value)), Some(line)) => {
                    let name = &line[..line.len() - value.len() - 3];
                    list.add(format!("{within}{name}"), value.into());
                }
                (Some((key, value)), None) => list.add(key.into(), value.into()),
                (None, _) => within = line,
            }
        }
        list
    }

    /// Formats the list with one line per key.
    #[must_use]
    pub fn to_text(&self) -> String {
        self.0.iter().fold(String::new(), |mut text, (k, v)| {
            let _ = writeln!(text, "{k} = {v}");
            text
        })
    }

    /// Formats the list with the common part of keys up to their last point on a line of its own.
    #[must_use]
    pub fn to_grouped_text(&self) -> String {
        let (mut text, mut within) = (String::new(), "");
        for (key, value) in &self.0 {
            let (parent, name) = key.split_at(key.rfind('.').map_or(0, |i| i + 1));
            if parent != within {
                let _ = writeln!(text, "{parent}");
                within = parent;
            }
            let _ = writeln!(text, " {name} = {value}");
        }
        text
    }

    fn numbers(&mut self, key: &str, values: &[&str]) {
        let x: Vec<f64> = values.iter().filter_map(|v| v.parse().ok()).collect();
        let sum: f64 = x.iter().sum();
        let magnitude: f64 = x.iter().map(|x| x.abs()).sum();
        self.add(format!("{key}.len"), values.len().to_string());
        self.add(format!("{key}.sum"), format!("{sum:?}"));
        self.add(format!("{key}.magnitude"), format!("{magnitude:?}"));
        for (name, x) in [("first", x.first()), ("last", x.last())] {
            self.add(format!("{key}.{name}"), format!("{:?}", x.unwrap_or(&0.0)));
        }
        let bits = x.iter().flat_map(|x| x.to_bits().to_le_bytes());
        self.add(format!("{key}{BITS}"), hash(bits));
    }
}

/// Returns the FNV-1a hash.
fn hash(bytes: impl IntoIterator<Item = u8>) -> String {
    let step = |h: u64, b: u8| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3);
    let h = bytes.into_iter().fold(0xcbf2_9ce4_8422_2325, step);
    format!("{h:016x}")
}

fn is_timed(name: &str) -> bool {
    TIMED.iter().any(|t| name.contains(t))
}

/// Adds a file under its key; `folder` is removed from texts.
pub(super) fn file(list: &mut List, key: &str, path: &Path, folder: &str) {
    let ending = path.extension().unwrap_or_default().to_string_lossy();
    let read = || {
        std::fs::read_to_string(path)
            .expect("a text")
            .replace(folder, ".")
    };
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    match &*ending {
        "json" => {
            let text = read();
            let raw: &RawValue = serde_json::from_str(&text).expect("JSON");
            json(list, key, raw.get());
        }
        // Written from the record, with fewer digits: tables by columns, histories as they are.
        "csv" if is_timed(&name) || name == "timings.csv" || name == "choose.csv" => {}
        // Its numbers stand in the record and in the tables of the study.
        "csv" if name == "runs.csv" => {}
        "csv" => table(list, key, &read()),
        "toml" if name != "chosen.toml" => toml(list, key, &read()),
        "inp" => {
            let text = read();
            // Without the title, which names the command.
            let data = text.find("*NODE").map_or("", |i| &text[i..]);
            list.add(format!("{key}{BITS}"), hash(data.bytes()));
            let lines = data.lines().filter(|l| !l.starts_with('*'));
            let numbers: Vec<&str> = lines
                .flat_map(|l| l.split(',').map(str::trim))
                .filter(|n| n.parse::<f64>().is_ok())
                .collect();
            list.numbers(&format!("{key}.numbers"), &numbers);
        }
        "vtu" => list.add(format!("{key}{BITS}"), hash(read().bytes())),
        // Pages and pictures show what the record holds; reductions are used by a scene.
        _ => {}
    }
}

fn json(list: &mut List, key: &str, raw: &str) {
    let name = key.rsplit('.').next().unwrap_or(key);
    if is_timed(name) || (key.starts_with("choose/") && CHOSEN.contains(&name)) {
        return;
    }
    match raw.as_bytes()[0] {
        b'{' => {
            let fields: BTreeMap<String, &RawValue> = serde_json::from_str(raw).expect("an object");
            // What dearer candidates are tried depends on what the cheaper ones took.
            let family = fields.get("family").map_or("", |f| f.get());
            if key.contains("choice.tried[")
                && !["\"rigid\"", "\"movable-teeth\""].contains(&family)
            {
                return;
            }
            for (name, value) in fields {
                json(
                    list,
                    &format!("{key}.{}", name.replace(" = ", "=")),
                    value.get(),
                );
            }
        }
        b'[' => {
            let items: Vec<&RawValue> = serde_json::from_str(raw).expect("a list");
            let items: Vec<&str> = items.iter().map(|i| i.get()).collect();
            if let Some(numbers) = table_of_numbers(&items) {
                return list.numbers(key, &numbers);
            }
            if items.len() > SHORT && items.iter().all(|i| i.parse::<f64>().is_ok()) {
                return list.numbers(key, &items);
            }
            for (i, item) in items.iter().enumerate() {
                json(list, &format!("{key}[{i:02}]"), item);
            }
        }
        _ => list.add(key.to_owned(), leaf(raw)),
    }
}

/// Returns the rows of a list of lists of numbers.
fn table_of_numbers<'a>(items: &[&'a str]) -> Option<Vec<&'a str>> {
    let row = |item: &'a str| serde_json::from_str::<Vec<&'a RawValue>>(item).ok();
    let rows: Option<Vec<_>> = items.iter().map(|i| row(i)).collect();
    let all: Vec<&str> = rows?.concat().into_iter().map(RawValue::get).collect();
    (all.len() > SHORT && all.iter().all(|x| x.parse::<f64>().is_ok())).then_some(all)
}

/// Returns a number in a canonical form; other text is unchanged.
fn leaf(text: &str) -> String {
    match (text.parse::<i64>(), text.parse::<f64>()) {
        (Err(_), Ok(x)) => format!("{x:?}"),
        _ => text.to_owned(),
    }
}

fn table(list: &mut List, key: &str, text: &str) {
    if text.starts_with("time_s") {
        return list.add(format!("{key}{BITS}"), hash(text.bytes()));
    }
    // The comments of a table of reference data name the time and the commit.
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .from_reader(text.as_bytes());
    let is_reference = text.starts_with('#');
    let header = reader.headers().expect("a header").clone();
    let rows: Vec<csv::StringRecord> = reader.records().collect::<Result<_, _>>().expect("rows");
    for (i, name) in header.iter().enumerate() {
        // What is on the front follows from times.
        if is_timed(name) || name == "on_front" {
            continue;
        }
        let cells: Vec<&str> = rows.iter().map(|r| &r[i]).collect();
        if is_reference {
            list.numbers(&format!("{key}.{name}"), &cells);
            continue;
        }
        let bytes = cells.iter().flat_map(|c| c.bytes().chain([0]));
        list.add(format!("{key}.{name}{BITS}"), hash(bytes));
    }
}

fn toml(list: &mut List, key: &str, text: &str) {
    let mut within = String::new();
    for line in text.lines().filter(|l| !l.starts_with('#')) {
        if let Some(name) = line.strip_prefix('[') {
            within = name.trim_end_matches(']').to_owned();
        } else if let Some((name, value)) = line.split_once(" = ") {
            list.add(format!("{key}.{within}.{name}"), leaf(value));
        }
    }
}

//! The report of an import: parts of the file that it took, values that it assumed, and parts that it left.

use std::collections::BTreeMap;

/// Statements about an import, in the order in which they arise.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ImportReport {
    /// Parts of the file that became parts of the scene.
    pub taken: Vec<String>,
    /// Values of the scene that the file does not give.
    pub assumed: Vec<String>,
    /// Parts of the file without a counterpart in the scene.
    pub left: Vec<String>,
}

impl ImportReport {
    /// Adds an assumption, once.
    pub fn assume(&mut self, text: impl Into<String>) {
        let text = text.into();
        if !self.assumed.contains(&text) {
            self.assumed.push(text);
        }
    }

    /// Adds a part that was left, once.
    pub fn leave(&mut self, text: impl Into<String>) {
        let text = text.into();
        if !self.left.contains(&text) {
            self.left.push(text);
        }
    }

    /// Adds the numbers of components by type that were left.
    pub fn leave_kinds<'a>(&mut self, kinds: impl Iterator<Item = &'a str>) {
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        for kind in kinds {
            *counts.entry(kind).or_default() += 1;
        }
        for (kind, count) in counts {
            self.leave(format!("{count} x {kind}"));
        }
    }

    /// The report as lines of text.
    pub fn to_text(&self) -> String {
        let part = |head: &str, lines: &[String]| {
            let lines: String = lines.iter().map(|l| format!("  {l}\n")).collect();
            match lines.is_empty() {
                true => String::new(),
                false => format!("{head}:\n{lines}"),
            }
        };
        [
            part("taken", &self.taken),
            part("assumed", &self.assumed),
            part("left", &self.left),
        ]
        .concat()
    }
}

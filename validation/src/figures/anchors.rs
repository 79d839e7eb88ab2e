//! Figures in Markdown: a number, its unit, and the HTML comment that names the stored value.
//!
//! ```text
//! | elastic gears, own mesh | 1.06 %<!--=impact.own-mesh--> |
//! 0.12<!--=impact.peak %--> and 0.08 %<!--=impact.impulse-->
//! ```
//!
//! The comment is not visible on the page. The unit is between number and comment, or in the comment if several numbers
//! share one unit. A figure is right if the stored value, rounded to the printed digits, equals it; zeros at the end of
//! an integer count as rounded. A number without sign is a magnitude.

use std::ops::Range;

/// Start and end of the comment with the name of a figure.
const COMMENT: [&str; 2] = ["<!--=", "-->"];

/// Units of printed numbers with their factors to the unit of stored values.
const UNITS: [(&str, f64); 19] = [
    ("%", 1e-2),
    ("s", 1.0),
    ("ms", 1e-3),
    ("us", 1e-6),
    ("ns", 1e-9),
    ("m", 1.0),
    ("mm", 1e-3),
    ("um", 1e-6),
    ("nm", 1e-9),
    ("N", 1.0),
    ("kN", 1e3),
    ("J", 1.0),
    ("W", 1.0),
    ("Hz", 1.0),
    ("kHz", 1e3),
    ("rad/s", 1.0),
    ("GB", 1e9),
    ("N/(mm um)", 1e9),
    ("times", 1.0),
];

/// A figure of a document.
#[derive(Clone, Debug, PartialEq)]
pub struct Anchor {
    /// Name of the stored value: source and key.
    pub id: String,
    /// The number as the document prints it.
    pub printed: String,
    /// Byte range of the number in the text.
    pub at: Range<usize>,
    /// Factor from the printed number to the stored value.
    pub unit: f64,
    /// Line of the document, from 1.
    pub line: usize,
}

/// Finds the figures of a document in their order.
///
/// # Errors
/// A comment has no number before it, an unknown unit or no end: message with its line.
pub fn anchors(text: &str) -> Result<Vec<Anchor>, String> {
    let mut found = Vec::new();
    let mut from = 0;
    while let Some(start) = text[from..].find(COMMENT[0]).map(|i| from + i) {
        let line = 1 + text[..start].matches('\n').count();
        let inside = start + COMMENT[0].len();
        let end = text[inside..].find(COMMENT[1]).map(|i| inside + i);
        let end = end.ok_or_else(|| format!("line {line}: a comment without an end"))?;
        let (id, named) = match text[inside..end].split_once(' ') {
            Some((id, unit)) => (id, Some(unit)),
            None => (&text[inside..end], None),
        };
        let before = text[..start].trim_end();
        let (before, unit) = match named {
            Some(unit) => {
                let known = UNITS.iter().find(|(name, _)| *name == unit);
                let (_, factor) = known.ok_or_else(|| format!("line {line}: unit `{unit}`"))?;
                (before, *factor)
            }
            None => without_unit(before),
        };
        let number =
            number_at_end(before).ok_or_else(|| format!("line {line}: no number before `{id}`"))?;
        found.push(Anchor {
            id: id.to_owned(),
            printed: before[number.clone()].to_owned(),
            at: number,
            unit,
            line,
        });
        from = end;
    }
    Ok(found)
}

/// Splits a text into number and unit; the unit of a plain number is 1.
pub fn without_unit(text: &str) -> (&str, f64) {
    let of = |(name, factor): &(&str, f64)| {
        let rest = text.strip_suffix(name)?.strip_suffix(' ')?;
        number_at_end(rest).map(|_| (rest, *factor))
    };
    UNITS.iter().find_map(of).unwrap_or((text, 1.0))
}

fn number_at_end(text: &str) -> Option<Range<usize>> {
    let part = |c: char| c.is_ascii_digit() || matches!(c, '.' | ',' | 'e' | '-' | '+');
    let start = text.rfind(|c| !part(c)).map_or(0, |i| {
        i + text[i..].chars().next().map_or(1, char::len_utf8)
    });
    let token = &text[start..];
    let first = token.find(|c: char| c.is_ascii_digit() || matches!(c, '-' | '+'))?;
    let range = start + first..text.len();
    value(&text[range.clone()]).map(|_| range)
}

/// Reads the number at the start of a text, with the text after it.
pub fn number_at_start(text: &str) -> Option<(f64, &str)> {
    let part = |c: char| c.is_ascii_digit() || matches!(c, '.' | 'e' | '-' | '+');
    let end = text.find(|c| !part(c)).unwrap_or(text.len());
    (1..=end).rev().find_map(|end| {
        let (number, rest) = text.split_at(end);
        let ends = number.ends_with(|c: char| c.is_ascii_digit());
        Some((number.parse().ok().filter(|_| ends)?, rest))
    })
}

/// Factor of the unit that follows a number; 1 if none does.
pub fn unit_at_start(text: &str) -> f64 {
    let of = |(name, factor): &(&str, f64)| {
        let rest = text.strip_prefix(' ')?.strip_prefix(name)?;
        let ends = rest.is_empty() || rest.starts_with([' ', ',', ';', ':', ')', '*']);
        ends.then_some(*factor)
    };
    UNITS.iter().find_map(of).unwrap_or(1.0)
}

fn value(printed: &str) -> Option<f64> {
    printed.replace(',', "").parse().ok()
}

impl Anchor {
    /// Formats the stored value in the form of the printed number.
    pub fn rounded(&self, stored: f64) -> String {
        let signed = self.printed.starts_with(['-', '+']);
        let x = stored / self.unit;
        in_form(&self.printed, if signed { x } else { x.abs() })
    }
}

/// Formats a value in the form of a printed number: as many decimals, or as many significant digits of an integer.
pub fn in_form(printed: &str, x: f64) -> String {
    let (mantissa, exponent) = match printed.split_once('e') {
        Some((m, _)) => (m, true),
        None => (printed, false),
    };
    let decimals = mantissa.split_once('.').map_or(0, |(_, d)| d.len());
    if exponent {
        return format!("{x:.decimals$e}");
    }
    let mut text = match decimals {
        0 => format!("{:.0}", whole(mantissa, x)),
        d => format!("{x:.d$}"),
    };
    if printed.contains(',') {
        let digits = text.find('.').unwrap_or(text.len());
        let first = usize::from(text.starts_with('-'));
        for i in (first + 1..digits).rev().filter(|i| (digits - i) % 3 == 0) {
            text.insert(i, ',');
        }
    }
    text
}

/// Rounds a value to as many significant digits as a printed integer has.
fn whole(printed: &str, x: f64) -> f64 {
    let digits: String = printed.chars().filter(char::is_ascii_digit).collect();
    let significant = digits.trim_end_matches('0').len().max(1);
    let size = x.abs().log10().floor() as i32 + 1;
    let unit = 10f64.powi((size - significant as i32).max(0));
    if x == 0.0 {
        0.0
    } else {
        (x / unit).round() * unit
    }
}

/// Replaces the figures of a document by the stored values; figures without a stored value stay as they are.
pub fn with_figures(
    text: &str,
    anchors: &[Anchor],
    stored: impl Fn(&str) -> Option<f64>,
) -> String {
    let mut out = String::with_capacity(text.len());
    let mut from = 0;
    for anchor in anchors {
        out.push_str(&text[from..anchor.at.start]);
        match stored(&anchor.id) {
            Some(x) => out.push_str(&anchor.rounded(x)),
            None => out.push_str(&anchor.printed),
        }
        from = anchor.at.end;
    }
    out.push_str(&text[from..]);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_with_their_units() {
        let text = "| elastic | 1.06 %<!--=a.b--> |\n0.12<!--=a.c %--> and -3.0e-7<!--=d.e-->, 1,180 times<!--=f.g-->";
        let found = anchors(text).unwrap();
        let of: Vec<(&str, &str, f64, usize)> = (found.iter())
            .map(|a| (a.id.as_str(), a.printed.as_str(), a.unit, a.line))
            .collect();
        assert_eq!(
            of,
            [
                ("a.b", "1.06", 0.01, 1),
                ("a.c", "0.12", 0.01, 2),
                ("d.e", "-3.0e-7", 1.0, 2),
                ("f.g", "1,180", 1.0, 2)
            ]
        );
        let stored = |id: &str| match id {
            "a.b" => Some(-0.01234),
            "a.c" => Some(0.00128),
            "d.e" => Some(-2.96e-7),
            _ => Some(1_243.4),
        };
        assert_eq!(
            with_figures(text, &found, stored),
            "| elastic | 1.23 %<!--=a.b--> |\n0.13<!--=a.c %--> and -3.0e-7<!--=d.e-->, 1,240 times<!--=f.g-->"
        );
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (text, wrong) in [
            ("\nmany<!--=a.b-->", "line 2: no number before `a.b`"),
            ("3<!--=a.b furlong-->", "line 1: unit `furlong`"),
            ("3<!--=a.b", "line 1: a comment without an end"),
        ] {
            assert_eq!(anchors(text).unwrap_err(), wrong);
        }
    }
}

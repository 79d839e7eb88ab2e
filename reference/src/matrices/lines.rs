//! Lines of a text of numbers, with their places for messages.

use super::error::{MatrixError, MatrixErrorKind};
use crate::Refusal;
use crate::deck::quote;
use crate::files::take_line;
use std::borrow::Cow;
use std::str::FromStr;

/// A text file and the line that is being read.
pub(super) struct Lines<'a> {
    name: &'a str,
    rest: &'a [u8],
    number: usize,
}

/// A line with its place.
pub(super) struct Line<'a> {
    name: &'a str,
    number: usize,
    pub(super) text: Cow<'a, str>,
}

impl<'a> Lines<'a> {
    pub(super) fn new(name: &'a str, bytes: &'a [u8]) -> Self {
        Lines {
            name,
            rest: bytes,
            number: 0,
        }
    }

    /// The next line, blank ones included; `None` at the end of the file.
    pub(super) fn next(&mut self) -> Option<Line<'a>> {
        let line = take_line(&mut self.rest)?;
        self.number += 1;
        Some(Line {
            name: self.name,
            number: self.number,
            text: String::from_utf8_lossy(line),
        })
    }

    /// The next line that is not blank.
    pub(super) fn next_filled(&mut self) -> Option<Line<'a>> {
        loop {
            let line = self.next()?;
            if !line.text.trim().is_empty() {
                return Some(line);
            }
        }
    }

    /// The next line of a part of a file that has to be there.
    pub(super) fn need(&mut self, expected: &str) -> Result<Line<'a>, MatrixError> {
        let (name, number) = (self.name, self.number);
        self.next().ok_or_else(|| {
            let end = format!("the end of the file after line {number}");
            let help = "the file is incomplete; let the program write it again";
            Refusal::new(MatrixErrorKind::Syntax, "", expected, end, help).at(name, number)
        })
    }

    /// Bytes that were not read yet.
    pub(super) fn bytes_left(&self) -> usize {
        self.rest.len()
    }
}

impl Line<'_> {
    /// A refusal of this line.
    pub(super) fn error(&self, expected: &str, found: &str, help: &str) -> MatrixError {
        Refusal::new(MatrixErrorKind::Syntax, "", expected, quote(found), help)
            .at(self.name, self.number)
    }

    /// A whole number.
    pub(super) fn whole<T: FromStr>(&self, word: &str, expected: &str) -> Result<T, MatrixError> {
        let number = word.trim().parse();
        number.map_err(|_| self.error(expected, word, ""))
    }

    /// A finite number, also with the exponents of Fortran.
    pub(super) fn number(&self, word: &str, expected: &str) -> Result<f64, MatrixError> {
        float(word).ok_or_else(|| {
            let help =
                "a program writes stars or NaN where a number does not fit or does not exist";
            self.error(expected, word, help)
        })
    }
}

/// A finite number as C or Fortran prints it: `1.5e-3`, `1.5D-03`, `1.5-103`.
fn float(word: &str) -> Option<f64> {
    let word = word.trim();
    let finite = |x: f64| x.is_finite().then_some(x);
    if let Ok(x) = word.parse::<f64>() {
        return finite(x);
    }
    let mut text = word.replace(['D', 'd'], "e");
    if !text.contains(['e', 'E']) {
        // An exponent of three digits takes the place of its letter.
        let sign = text.char_indices().skip(1);
        let (at, _) = sign.filter(|(_, c)| matches!(c, '+' | '-')).last()?;
        text.insert(at, 'e');
    }
    finite(text.parse().ok()?)
}

#[cfg(test)]
mod tests {
    use super::float;

    #[test]
    fn numbers_of_c_and_fortran() {
        for (text, x) in [
            ("1.5e-3", Some(1.5e-3)),
            (" -2.50D+02 ", Some(-250.0)),
            ("1.0-103", Some(1e-103)),
            ("-1.0+101", Some(-1e101)),
            ("7", Some(7.0)),
            ("NaN", None),
            ("inf", None),
            ("****", None),
            ("", None),
            ("-", None),
        ] {
            assert_eq!(float(text), x, "{text}");
        }
    }
}

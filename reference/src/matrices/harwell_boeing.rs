//! Harwell-Boeing matrices, as `HBMAT` of Ansys writes them.
//!
//! Four or five lines of heads (title; numbers of lines; kind and sizes; Fortran formats; a line about right-hand sides),
//! then the first entry of each column, the row of each entry, and its value. Of a symmetric matrix (`RSA`) the lower
//! triangle is stored. Source: I. S. Duff, R. G. Grimes, J. G. Lewis, *Users' Guide for the Harwell-Boeing Sparse Matrix
//! Collection*, 1992.

use super::entries::Listed;
use super::error::MatrixError;
use super::lines::{Line, Lines};

/// Words of a fixed width, as a Fortran format such as `(4E20.12)` prints them.
struct Words {
    per_line: usize,
    width: usize,
}

impl Words {
    /// Reads a format: how many words a line has, and their width.
    fn of(line: &Line<'_>, text: &str) -> Result<Self, MatrixError> {
        let bad = || line.error("a format such as (8I10) or (1P,4E20.12)", text, "");
        let upper = text.trim().to_ascii_uppercase();
        let inner = upper.strip_prefix('(').and_then(|t| t.split(')').next());
        // A scale factor (`1P`) changes no digits that are read.
        let inner = inner.map(|t| match t.split_once('P') {
            Some((_, rest)) => rest.trim_start_matches(',').to_owned(),
            None => t.to_owned(),
        });
        let inner = inner.ok_or_else(bad)?;
        let inner = inner.trim();
        let letter = inner
            .find(|c: char| c.is_ascii_alphabetic())
            .ok_or_else(bad)?;
        if !matches!(inner.as_bytes()[letter], b'I' | b'E' | b'D' | b'F' | b'G') {
            return Err(bad());
        }
        let count = match inner[..letter].trim() {
            "" => 1,
            digits => digits.parse().map_err(|_| bad())?,
        };
        let digits: String = (inner[letter + 1..].chars())
            .take_while(char::is_ascii_digit)
            .collect();
        let width: usize = digits.parse().map_err(|_| bad())?;
        if !(1..=1000).contains(&count) || !(1..=100).contains(&width) {
            return Err(bad());
        }
        Ok(Words {
            per_line: count,
            width,
        })
    }

    /// Reads `count` words from as many lines as they take.
    fn read<T>(
        &self,
        lines: &mut Lines<'_>,
        count: usize,
        what: &str,
        value: impl Fn(&Line<'_>, &str) -> Result<T, MatrixError>,
    ) -> Result<Vec<T>, MatrixError> {
        // A word has a character at least: no more memory than the file has bytes.
        let mut all = Vec::with_capacity(count.min(lines.bytes_left()));
        while all.len() < count {
            let line = lines.need(what)?;
            let here = self.per_line.min(count - all.len());
            let words: Vec<&str> = line.text.split_whitespace().collect();
            if words.len() == here {
                for word in words {
                    all.push(value(&line, word)?);
                }
                continue;
            }
            // Words without blanks between them.
            for i in 0..here {
                let word = line.text.get(i * self.width..).map(|rest| {
                    let end = (self.width).min(rest.len());
                    rest.get(..end).unwrap_or(rest)
                });
                match word.filter(|w| !w.trim().is_empty()) {
                    Some(word) => all.push(value(&line, word)?),
                    None => {
                        let expected = format!("{here} words of {} characters", self.width);
                        return Err(line.error(&expected, &line.text, ""));
                    }
                }
            }
        }
        Ok(all)
    }
}

/// Reads a matrix.
pub(super) fn matrix(name: &str, bytes: &[u8]) -> Result<Listed, MatrixError> {
    let mut lines = Lines::new(name, bytes);
    lines.need("a title")?;
    let counts = lines.need("the numbers of lines")?;
    let words: Vec<&str> = counts.text.split_whitespace().collect();
    if !(4..=5).contains(&words.len()) {
        let expected = "four or five numbers of lines (a Harwell-Boeing matrix)";
        let help = "Ansys: HBMAT,...,ASCII; CalculiX: .sti; Abaqus: .mtx; others: .npz";
        return Err(counts.error(expected, &counts.text, help));
    }
    let sides: u64 = match words.get(4) {
        Some(word) => counts.whole(word, "a number of lines")?,
        None => 0,
    };
    for word in &words {
        counts.whole::<u64>(word, "a number of lines")?;
    }
    let kind = lines.need("the kind and the sizes")?;
    let words: Vec<&str> = kind.text.split_whitespace().collect();
    let (Some(letters), [rows, columns, count]) = (words.first(), [1, 2, 3].map(|i| words.get(i)))
    else {
        return Err(kind.error("a kind and the sizes", &kind.text, ""));
    };
    let letters = letters.to_ascii_uppercase();
    if !matches!(letters.as_str(), "RSA" | "RUA") {
        let expected = "RSA (real, symmetric, assembled) or RUA";
        return Err(kind.error(
            expected,
            &letters,
            "write the stiffness or the mass of the whole body",
        ));
    }
    let size = |word: Option<&&str>| -> Result<usize, MatrixError> {
        let word = word.copied().unwrap_or_default();
        let size = kind.whole::<usize>(word, "rows, columns and entries")?;
        match size <= 1 << 40 {
            true => Ok(size),
            false => Err(kind.error("rows, columns and entries", word, "")),
        }
    };
    let [rows, columns, count] = [size(rows)?, size(columns)?, size(count)?];
    if rows != columns || rows > 1 << 30 {
        return Err(kind.error("a square matrix", &kind.text, ""));
    }
    let formats = lines.need("the formats of numbers")?;
    let texts: Vec<&str> = formats.text.split_inclusive(')').collect();
    let [pointers, indices, values] = [0, 1, 2].map(|i| match texts.get(i) {
        Some(text) => Words::of(&formats, text),
        None => Err(formats.error("three formats in brackets", &formats.text, "")),
    });
    if sides > 0 {
        lines.need("the line about right-hand sides")?;
    }
    let whole = |line: &Line<'_>, word: &str| line.whole::<usize>(word, "a whole number");
    let number = |line: &Line<'_>, word: &str| line.number(word, "a finite number");
    let starts = pointers?.read(&mut lines, rows + 1, "the starts of columns", whole)?;
    let row_of = indices?.read(&mut lines, count, "the rows of entries", whole)?;
    let values = values?.read(&mut lines, count, "the values of entries", number)?;
    let ascending = starts.windows(2).all(|w| w[0] <= w[1]);
    if !ascending || starts.first() != Some(&1) || starts.last() != Some(&(count + 1)) {
        let found = "starts of columns that do not ascend from 1 to the number of entries";
        let expected = format!("{count} entries in {columns} columns");
        return Err(kind.error(&expected, found, "the file is damaged"));
    }
    let mut listed = Listed::default();
    for (column, range) in starts.windows(2).enumerate() {
        for entry in range[0] - 1..range[1] - 1 {
            let row = row_of[entry];
            if !(1..=rows).contains(&row) {
                let expected = format!("rows from 1 to {rows}");
                return Err(kind.error(&expected, &format!("row {row}"), "the file is damaged"));
            }
            listed.push(name, row as u32 - 1, column as u32, values[entry])?;
        }
    }
    Ok(listed)
}

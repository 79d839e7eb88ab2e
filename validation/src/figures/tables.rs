//! Tables in Markdown whose rows are made from a stored CSV file.
//!
//! ```text
//! <!--table validation/results/agreement.csv
//! | {scene} | {metric}, {tolerance} | {error:0.00 %:not known} |
//! -->
//! | scene | metric, tolerance | error |
//! |---|---|---|
//! | 1 | peak, 0.1 | 0.13 % |
//! ```
//!
//! The comment names the file and has the form of a row: text, and names of columns in braces. After a colon a number
//! with its unit shows how the value is rounded, and after a second colon is the text for an empty value. Each line of
//! the file is one row. Header and separator follow the comment.

use super::anchors::{in_form, without_unit};
use std::ops::Range;
use std::path::Path;

/// Start and end of the comment before a generated table.
const COMMENT: [&str; 2] = ["<!--table ", "-->"];

/// A table of a document that is made from a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Table {
    /// Path of the CSV file in the repository.
    pub file: String,
    /// Form of a row.
    form: String,
    /// Byte range of the rows, with the end of the last line.
    pub at: Range<usize>,
    /// Line of the first row, from 1.
    pub line: usize,
}

/// Finds the tables of a document that are made from files.
///
/// # Errors
/// A comment without an end, without a file and a form, or without a table after it: message with its line.
pub fn tables(text: &str) -> Result<Vec<Table>, String> {
    let mut found = Vec::new();
    let mut from = 0;
    while let Some(start) = text[from..].find(COMMENT[0]).map(|i| from + i) {
        let line = 1 + text[..start].matches('\n').count();
        let inside = start + COMMENT[0].len();
        let end = text[inside..].find(COMMENT[1]).map(|i| inside + i);
        let end = end.ok_or_else(|| format!("line {line}: a comment without an end"))?;
        let parts = text[inside..end].trim().split_once('\n');
        let (file, form) = parts.ok_or_else(|| format!("line {line}: a table without a form"))?;
        let after = end + COMMENT[1].len();
        let mut lines = text[after..].split_inclusive('\n');
        let head: Vec<&str> = lines.by_ref().take(3).collect();
        if head.len() < 3 || !head[1].starts_with('|') || !head[2].starts_with("|---") {
            return Err(format!("line {line}: no table after the comment"));
        }
        let first = after + head.iter().map(|l| l.len()).sum::<usize>();
        let rows: usize = lines.take_while(|l| l.starts_with('|')).map(str::len).sum();
        found.push(Table {
            file: file.trim().to_owned(),
            form: form.trim().to_owned(),
            at: first..first + rows,
            line: 1 + text[..first].matches('\n').count(),
        });
        from = first + rows;
    }
    Ok(found)
}

impl Table {
    /// Makes the rows from the file, in the repository at `root`.
    ///
    /// # Errors
    /// The file cannot be read, a column is missing, or a value is not a number where the form has one.
    pub fn rows(&self, root: &Path) -> Result<Vec<String>, String> {
        let fail = |e: String| format!("{}: {e}", self.file);
        let text = std::fs::read_to_string(root.join(&self.file));
        self.of(&text.map_err(|e| fail(e.to_string()))?)
            .map_err(fail)
    }

    /// Makes the rows from the text of the file.
    fn of(&self, text: &str) -> Result<Vec<String>, String> {
        let mut reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .from_reader(text.as_bytes());
        let columns = reader.headers().map_err(|e| e.to_string())?.clone();
        let row = |record: Result<csv::StringRecord, csv::Error>| {
            let record = record.map_err(|e| e.to_string())?;
            self.filled(|name| {
                let column = columns.iter().position(|c| c == name)?;
                record.get(column)
            })
        };
        reader.records().map(row).collect()
    }

    /// Puts the values of one line of the file into the form.
    fn filled<'v>(&self, value: impl Fn(&str) -> Option<&'v str>) -> Result<String, String> {
        let mut out = String::new();
        let mut rest = self.form.as_str();
        while let Some((before, after)) = rest.split_once('{') {
            let (field, after) = (after.split_once('}')).ok_or("a brace without an end")?;
            let mut parts = field.splitn(3, ':');
            let name = parts.next().unwrap_or_default();
            let number = parts.next().unwrap_or_default();
            let value = value(name).ok_or_else(|| format!("no column `{name}`"))?;
            out.push_str(before);
            if value.is_empty() {
                out.push_str(parts.next().unwrap_or_default());
            } else if number.is_empty() {
                out.push_str(value);
            } else {
                let x: f64 = (value.parse()).map_err(|_| format!("`{name}` is `{value}`"))?;
                let (printed, unit) = without_unit(number);
                out.push_str(&in_form(printed, x / unit));
                out.push_str(&number[printed.len()..]);
            }
            rest = after;
        }
        out.push_str(rest);
        Ok(out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "before\n<!--table a.csv\n| {scene} | {kind}, {error:0.00 %:not known} | {ratio:1,110} |\n-->\n\
                        | scene | error | ratio |\n|---|---|---|\n| 1 | old |\n\nafter\n";

    #[test]
    fn rows_have_the_form_of_the_comment() {
        let [table] = &tables(TEXT).unwrap()[..] else {
            panic!("one table");
        };
        assert_eq!((table.file.as_str(), table.line), ("a.csv", 7));
        assert_eq!(&TEXT[table.at.clone()], "| 1 | old |\n");
        let file = "# how it was made\nscene,error,kind,ratio\n1,0.01234,pair,9638\n2,,\"rack, held\",87.6\n";
        assert_eq!(
            table.of(file).unwrap(),
            [
                "| 1 | pair, 1.23 % | 9,640 |",
                "| 2 | rack, held, not known | 88 |"
            ]
        );
    }

    #[test]
    fn a_wrong_table_is_named() {
        for (text, wrong) in [
            (
                "\n<!--table a.csv\n| {a} |",
                "line 2: a comment without an end",
            ),
            ("<!--table a.csv-->", "line 1: a table without a form"),
            (
                "<!--table a.csv\n| {a} |\n-->\ntext\n",
                "line 1: no table after the comment",
            ),
        ] {
            assert_eq!(tables(text).unwrap_err(), wrong);
        }
        let table = &tables(TEXT).unwrap()[0];
        for (file, wrong) in [
            ("scene,kind\n1,pair\n", "no column `error`"),
            ("scene,kind,error\n1,pair,small\n", "`error` is `small`"),
        ] {
            assert_eq!(table.of(file).unwrap_err(), wrong);
        }
    }
}

//! Nodes and elements of version 2.2: without blocks, a line each; binary elements in runs of one type.

use super::Reader;
use crate::error::{DeckError, DeckErrorKind};

impl Reader<'_> {
    /// A count in a line of its own, binary or not, in front of values.
    fn counted(&mut self, section: &'static str) -> Result<usize, DeckError> {
        self.lines.begin_text(section);
        self.lines.row("a count")?;
        let count = self.lines.parsed("a count")?;
        self.lines.begin(section);
        Ok(count)
    }

    pub(super) fn plain_nodes(&mut self) -> Result<(), DeckError> {
        for _ in 0..self.counted("$Nodes")? {
            let lines = &mut self.lines;
            lines.row("tag, x, y, z")?;
            let (tag, x) = (lines.tag("the tag of a node")?, lines.position()?);
            self.node(tag, x)?;
        }
        Ok(())
    }

    /// Elements of version 2.2: a line each; binary in runs of one type and count of tags.
    pub(super) fn plain_elements(&mut self) -> Result<(), DeckError> {
        let mut left = self.counted("$Elements")?;
        while left > 0 {
            let (lines, what) = (&mut self.lines, "tag, type, count of tags, tags, nodes");
            lines.row(what)?;
            let (mut tag, kind, run, tags);
            if lines.is_raw() {
                let what = "type, count of elements, count of tags";
                (tag, kind) = (None, lines.small(what)?);
                (run, tags) = (lines.count(what)?, lines.small(what)?);
            } else {
                (tag, kind) = (Some(lines.tag(what)?), lines.small(what)?);
                (run, tags) = (1, lines.small(what)?);
            }
            if run == 0 || run > left {
                let expected = format!("from 1 to {left} elements of a type");
                let kind = DeckErrorKind::Syntax;
                return Err(lines.error(kind, expected, run.to_string(), ""));
            }
            left -= run;
            let mut before = None;
            for _ in 0..run {
                let tag = match tag.take() {
                    Some(tag) => tag,
                    None => self.lines.tag("the tag of an element")?,
                };
                let mut own = [0; 2];
                for i in 0..tags as usize {
                    let value = self.lines.signed(what)?;
                    if let Some(tag) = own.get_mut(i) {
                        *tag = value;
                    }
                }
                // Elements of an entity follow one another.
                let sets = match before.take() {
                    Some((same, sets)) if same == own => sets,
                    _ => {
                        let group = Some(own[0]).filter(|g| *g > 0);
                        self.sets(dimension_of(kind), own[1], group.as_slice())
                    }
                };
                self.element(tag, kind, &sets)?;
                before = Some((own, sets));
            }
        }
        Ok(())
    }
}

/// Dimension of the entities that have elements of a type.
fn dimension_of(kind: u32) -> usize {
    match kind {
        15 => 0,
        1 | 8 => 1,
        2 | 3 | 9 | 10 | 16 => 2,
        _ => 3,
    }
}

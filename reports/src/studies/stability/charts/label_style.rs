//! Colours and letters of the labels of a map, readable in colour, in greyscale and without colour vision.
//!
//! Colours after Okabe and Ito, in a different shade from those of the models. They are the same on a dark page. The
//! letter carries the meaning where colours cannot.

use crate::drawing::axis::NAME_SIZE;
use crate::drawing::canvas::{Anchor, Canvas, Ink, Stroke, Type, text_width};
use crate::drawing::geometry::Rect;
use crate::drawing::legend::in_rows;
use crate::drawing::panel::{RIGHT, WIDTH};
use crate::record::Status;
use crate::studies::stability::LineKind;

/// Colour and letter of a label.
#[derive(Clone, Copy)]
pub struct LabelStyle {
    pub ink: Ink,
    /// Letter in it; none for runs that converged.
    pub letter: &'static str,
    pub text: Ink,
}

/// Letters on dark cells, by day and by night.
const ON_DARK: Ink = Ink(0xfe, 0xfe, 0xfe, 1.0);

/// Returns colour and letter of a label.
pub fn label_style(status: Status) -> LabelStyle {
    let (ink, letter, dark) = match status {
        Status::Converged => (Ink(0xc9, 0xe7, 0xdc, 1.0), "", true),
        Status::Unchecked => (Ink(0xe6, 0xf4, 0xef, 1.0), "?", true),
        Status::Inaccurate => (Ink(0xf5, 0xea, 0x7a, 1.0), "i", true),
        Status::EnergyGrowth => (Ink(0xe6, 0x9f, 0x01, 1.0), "E", true),
        Status::Chatter => (Ink(0x01, 0x72, 0xb2, 1.0), "C", false),
        Status::NewtonFailure => (Ink(0x6b, 0x4a, 0x9d, 1.0), "N", false),
        Status::StepUnderflow => (Ink(0x6e, 0x74, 0x7a, 1.0), "U", false),
        Status::BlowUp => (Ink(0xb8, 0x3a, 0x00, 1.0), "B", false),
        Status::Tunnelling => (Ink(0xcc, 0x79, 0xa8, 1.0), "T", true),
        Status::AdhesiveForce => (Ink(0x56, 0xb4, 0xea, 1.0), "A", true),
        Status::Timeout => (Ink(0xd9, 0xdd, 0xe1, 1.0), "t", true),
        Status::Refused => (Ink(0x8d, 0x93, 0x99, 1.0), "R", false),
        Status::Aborted => (Ink(0x1d, 0x23, 0x29, 1.0), "!", false),
        Status::Interrupted => (Ink(0xf4, 0xf5, 0xf6, 1.0), "-", true),
    };
    LabelStyle {
        ink,
        letter,
        text: if dark { Ink::ON_CELL } else { ON_DARK },
    }
}

/// Names and dashes of the lines of theory.
pub const KINDS: [(LineKind, &str, &[f64]); 3] = [
    (LineKind::Stability, "theory: stability limit", &[]),
    (
        LineKind::Penalty,
        "theory: limit of the penalty alone",
        &[6.0, 3.0],
    ),
    (
        LineKind::Resonance,
        "theory: resonance, \u{3c9} h = k \u{3c0}",
        &[1.8, 2.4],
    ),
];

/// Paints a line of theory that is readable on every colour.
pub fn theory_line(c: &mut Canvas, points: &[(f64, f64)], frame: &Rect, kind: LineKind) {
    let dash = (KINDS.iter())
        .find(|k| k.0 == kind)
        .map_or(&[][..], |k| k.2);
    c.line_within(points, frame, Stroke::new(Ink::WHITE.opacity(0.9), 3.6));
    c.line_within(points, frame, Stroke::dashed(Ink::DARK, 1.7, dash));
}

/// Paints the mark of the largest stable step.
pub fn limit_mark(c: &mut Canvas, (x, y): (f64, f64)) {
    let shape = |r: f64| [(x, y - r), (x + r, y), (x, y + r), (x - r, y)];
    c.polygon(&shape(6.2), Ink::WHITE);
    c.polygon(&shape(4.4), Ink::DARK);
}

/// An entry of the legend of a map.
pub enum Entry {
    Label(Status),
    Theory(LineKind),
    /// The largest stable step that was found.
    Found,
}

impl Entry {
    fn text(&self) -> &'static str {
        match self {
            Entry::Label(status) => status.as_str(),
            Entry::Theory(kind) => (KINDS.iter()).find(|k| k.0 == *kind).map_or("", |k| k.1),
            Entry::Found => "largest stable step found",
        }
    }
}

/// Height of a row of a legend.
const ROW: f64 = 21.0;

fn places(entries: &[Entry]) -> Vec<(f64, usize)> {
    let widths = entries
        .iter()
        .map(|e| 46.0 + text_width(e.text(), NAME_SIZE));
    in_rows(widths, 16.0, WIDTH - RIGHT)
}

pub fn legend_height(entries: &[Entry]) -> f64 {
    ROW * places(entries).last().map_or(0, |p| p.1 + 1) as f64
}

/// Paints a legend from `y` downwards.
pub fn legend(c: &mut Canvas, entries: &[Entry], y: f64) {
    for (entry, (x, row)) in entries.iter().zip(places(entries)) {
        let y = y + ROW * (row as f64 + 0.5);
        let sample = Rect::new(x, y - 7.5, x + 22.0, y + 7.5);
        match entry {
            Entry::Label(status) => {
                let look = label_style(*status);
                c.fill(&sample, look.ink);
                let kind = Type::new(11.0, Anchor::Middle).ink(look.text).bold();
                c.text(look.letter, (x + 11.0, y), kind);
            }
            Entry::Theory(kind) => theory_line(c, &[(x, y), (x + 22.0, y)], &sample, *kind),
            Entry::Found => limit_mark(c, (x + 11.0, y)),
        }
        let kind = Type::new(NAME_SIZE, Anchor::Start);
        c.text(entry.text(), (x + 28.0, y), kind);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lightness of neighbours on the scale from converged to failed differs, and no two labels share a letter.
    #[test]
    fn labels_differ_without_colour() {
        let all = Status::ALL.map(label_style);
        for (i, a) in all.iter().enumerate() {
            for b in &all[i + 1..] {
                assert_ne!(a.letter, b.letter);
                assert_ne!(a.ink, b.ink);
            }
        }
    }
}

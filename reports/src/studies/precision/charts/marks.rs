//! Colours tell models, markers tell integrators: both in the order of appearance, the same in all charts.

use crate::drawing::canvas::{Anchor, Canvas, Ink, Type, text_width};
use crate::drawing::legend::in_rows;
use crate::drawing::panel::{LEFT, RIGHT, WIDTH};
use crate::drawing::style::{Look, Marker, look, marker};
use crate::record::{Results, Run};
use crate::studies::precision::id_of;

/// Markers of integrators; the star is kept for the one that is exact for modes.
const EXPLICIT: [Marker; 5] = [
    Marker::Circle,
    Marker::Square,
    Marker::Triangle,
    Marker::Diamond,
    Marker::Wedge,
];
const IMPLICIT: [Marker; 6] = [
    Marker::Circle,
    Marker::Square,
    Marker::Triangle,
    Marker::Diamond,
    Marker::Wedge,
    Marker::Star,
];
const ROW: f64 = 19.0;
const SIZE: f64 = 12.5;

/// Integrators of a record with their markers.
pub struct Marks {
    /// Id, marker, filled.
    all: Vec<(String, Marker, bool)>,
}

impl Marks {
    /// Markers in the order of appearance, explicit and implicit methods apart.
    pub fn of(results: &Results) -> Self {
        let mut all: Vec<(String, Marker, bool)> = Vec::new();
        let mut taken = [0, 0];
        for run in &results.runs {
            let id = id_of(&run.integrator);
            if all.iter().any(|m| m.0 == id) {
                continue;
            }
            let place = &mut taken[usize::from(run.implicit)];
            let shape = match (run.exact_linear, run.implicit) {
                (true, _) => Marker::Star,
                (_, false) => EXPLICIT[*place % EXPLICIT.len()],
                (_, true) => IMPLICIT[*place % IMPLICIT.len()],
            };
            *place += usize::from(!run.exact_linear);
            all.push((id.to_owned(), shape, !run.implicit));
        }
        Self { all }
    }

    /// The look of a run of the model at a place, and whether its marker is filled.
    pub fn look(&self, style: usize, run: &Run) -> (Look, bool) {
        let id = id_of(&run.integrator);
        let found = self.all.iter().find(|m| m.0 == id);
        let shape = found.map_or(Marker::Circle, |m| m.1);
        let look = Look {
            marker: shape,
            ..look(style)
        };
        (look, !run.implicit)
    }
}

/// Places of entries in rows: left edge and row.
fn places(texts: &[&str]) -> Vec<(f64, usize)> {
    let widths = texts.iter().map(|text| 34.0 + text_width(text, SIZE));
    in_rows(widths, LEFT, WIDTH - RIGHT)
}

fn rows(texts: &[&str]) -> usize {
    places(texts).last().map_or(0, |p| p.1 + 1)
}

fn texts<'t>(models: &'t [(usize, String)], marks: &'t Marks) -> [Vec<&'t str>; 2] {
    [
        models.iter().map(|m| m.1.as_str()).collect(),
        marks.all.iter().map(|m| m.0.as_str()).collect(),
    ]
}

/// Height that [`legend`] takes.
pub fn legend_height(models: &[(usize, String)], marks: &Marks) -> f64 {
    let [a, b] = texts(models, marks);
    ROW * (rows(&a) + rows(&b)) as f64 + 8.0
}

/// Models by colour, integrators by marker.
pub fn legend(c: &mut Canvas<'_>, models: &[(usize, String)], marks: &Marks) {
    let [a, b] = texts(models, marks);
    let kind = Type::new(SIZE, Anchor::Start);
    for ((x, row), (style, text)) in places(&a).into_iter().zip(models) {
        let y = 12.0 + ROW * row as f64;
        let r = 5.0;
        let ink = look(*style).ink;
        c.polygon(
            &[(x, y - r), (x + 12.0, y - r), (x + 12.0, y + r), (x, y + r)],
            ink,
        );
        c.text(text, (x + 18.0, y), kind);
    }
    let below = ROW * rows(&a) as f64;
    for ((x, row), (id, shape, filled)) in places(&b).into_iter().zip(&marks.all) {
        let y = 12.0 + below + ROW * row as f64;
        let grey = Look {
            ink: Ink::GREY,
            dash: &[],
            marker: *shape,
        };
        marker(c, (x + 6.0, y), 4.6, grey, *filled);
        c.text(id, (x + 18.0, y), kind.ink(Ink::GREY));
    }
}

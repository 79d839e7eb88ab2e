//! One map as coloured cells: steps over the values of a parameter.

use super::label_style::{label_style, limit_mark, theory_line};
use crate::drawing::axis::{Axis, NAME_SIZE, TICK_SIZE, tick_label};
use crate::drawing::canvas::{Anchor, Canvas, Ink, Stroke, Type, text_width};
use crate::drawing::geometry::Rect;
use crate::numbers::{Prefix, per_cent, quantity, short};
use crate::studies::stability::{Cell, Columns, LineKind, Map, MapAxis};

/// Width of a cell from which on it has a letter, and the distance of letters in smaller cells.
const LETTER: f64 = 9.0;

/// Returns factor and unit of the columns: microseconds for steps, none for tolerances.
pub fn column_scale(columns: Columns) -> (f64, &'static str) {
    match columns {
        Columns::Step => (1e6, "step [\u{b5}s]"),
        Columns::Tolerance => (1.0, "relative tolerance"),
    }
}

/// Abscissa of evenly spaced columns (over the decades): every cell has the same width.
pub struct Abscissa {
    first: f64,
    /// Ratio of neighbours, as a logarithm.
    step: f64,
    count: usize,
}

impl Abscissa {
    /// Makes the abscissa from the columns of a map; `None` without columns.
    pub fn of(at: &[f64]) -> Option<Self> {
        let (first, last) = (*at.first()?, *at.last()?);
        let count = at.len();
        let step = if count > 1 {
            (last / first).ln() / (count - 1) as f64
        } else {
            1.0
        };
        (first > 0.0 && step > 0.0).then_some(Abscissa { first, step, count })
    }

    /// Returns the abscissa of a column on the page.
    pub fn place(&self, x: f64, area: &Rect) -> f64 {
        let column = (x / self.first).ln() / self.step + 0.5;
        area.x0 + column / self.count as f64 * area.width()
    }

    /// Returns the ends of the axis.
    pub fn ends(&self) -> [f64; 2] {
        let half = (0.5 * self.step).exp();
        let last = self.first * (self.step * (self.count - 1) as f64).exp();
        [self.first / half, last * half]
    }

    /// Returns the ticks with labels in the unit of the axis.
    pub fn ticks(&self, scale: f64, most: usize) -> Vec<(f64, String)> {
        let [min, max] = self.ends().map(|x| x * scale);
        let axis = Axis::decades(min, max);
        let at = axis.ticks(most);
        at.iter()
            .map(|x| (x / scale, tick_label(*x, &at, true)))
            .collect()
    }
}

/// Returns the text of a cell: the values of its row and column, its label and the reason for it.
fn cell_text(map: &Map, row: &str, cell: &Cell) -> String {
    let at = match map.columns {
        Columns::Step => format!("step {}", quantity(cell.at, "s", 3)),
        Columns::Tolerance => format!("relative tolerance {}", short(cell.at, 3)),
    };
    let place = [row, &at].into_iter().filter(|t| !t.is_empty());
    let place = place.collect::<Vec<_>>().join(", ");
    let mut reasons = vec![cell.status.to_string()];
    reasons.extend(
        cell.error
            .map(|e| format!("integration error {}", per_cent(e, 3))),
    );
    let cut = cell.reached_s.filter(|t| *t < 0.999 * map.duration_s);
    reasons.extend(cut.map(|t| format!("at {}", quantity(t, "s", 3))));
    reasons.extend(cell.message.clone());
    format!(
        "{}, {}: {place}: {}",
        map.model_label(),
        map.integrator,
        reasons.join(", ")
    )
}

/// Returns the value of each parameter of a row as a text.
pub fn row_text(map: &Map, row: usize) -> String {
    let mut rest = row;
    let parts = map
        .axes
        .iter()
        .filter(|axis| !axis.values.is_empty())
        .map(|axis| {
            let value = axis.values[rest % axis.values.len()];
            rest /= axis.values.len();
            let value = match axis.unit.as_str() {
                "" => short(value, 3),
                unit => quantity(value, unit, 3),
            };
            format!("{} = {value}", axis.name)
        });
    parts.collect::<Vec<_>>().join(", ")
}

/// Paints a row of a map, each cell as wide as its column, with their letters. A pointer over a cell shows its text.
pub fn paint_row(c: &mut Canvas, map: &Map, row: usize, x: &Abscissa, strip: &Rect, area: &Rect) {
    let text = row_text(map, row);
    c.group(&[("class", "row".to_owned())], |c| {
        paint_cells(c, map, (row, &text), x, strip, area);
    });
}

fn paint_cells(
    c: &mut Canvas,
    map: &Map,
    (row, name): (usize, &str),
    x: &Abscissa,
    strip: &Rect,
    area: &Rect,
) {
    let width = area.width() / x.count as f64;
    let every = (LETTER / width.max(0.1)).ceil().max(1.0) as usize;
    for (k, cell) in map.row(row).iter().enumerate() {
        let left = area.x0 + width * k as f64;
        let box_ = Rect::new(left, strip.y0, left + width, strip.y1);
        let look = label_style(cell.status);
        c.group(&[("class", "cell".to_owned())], |c| {
            c.title(&cell_text(map, name, cell));
            c.fill(&box_, look.ink);
            if k % every == every / 2 && strip.height() >= 7.0 {
                let size = (0.72 * strip.height())
                    .min(11.5)
                    .min(0.75 * width * every as f64);
                let at = (left + 0.5 * width, 0.5 * (strip.y0 + strip.y1));
                let kind = Type::new(size, Anchor::Middle).ink(look.text).bold();
                c.text(look.letter, at, kind);
            }
        });
    }
}

/// Returns the rectangle of a row of a panel on the page.
pub fn strip(area: &Rect, rows: usize, row: usize) -> Rect {
    let height = area.height() / rows.max(1) as f64;
    let bottom = area.y1 - height * row as f64;
    Rect::new(area.x0, bottom - height, area.x1, bottom)
}

/// Returns the values of an axis as tick labels, and the axis's name.
pub fn labels(axis: &MapAxis) -> (Vec<String>, String) {
    let prefix = if axis.unit.is_empty() {
        Prefix::of(1.0, 1.0)
    } else {
        let middle = axis.values.get(axis.values.len() / 2);
        Prefix::of(middle.copied().unwrap_or(1.0), 1.0)
    };
    let texts = (axis.values.iter())
        .map(|x| short(x * prefix.factor, 3))
        .collect();
    let name = if axis.unit.is_empty() {
        axis.name.clone()
    } else {
        format!("{} [{}{}]", axis.name, prefix.symbol, axis.unit)
    };
    (texts, name)
}

/// A panel of a figure: the part of a map at one value of its second axis.
pub struct Panel<'a> {
    pub map: &'a Map,
    /// Which value of the second axis.
    pub second: usize,
    pub title: String,
    /// Values of the first axis at the left.
    pub y_labels: bool,
    /// Name of the abscissa below.
    pub x_name: bool,
}

impl Panel<'_> {
    /// Paints the panel into its area; labels lie outside.
    pub fn paint(&self, c: &mut Canvas, area: &Rect) {
        let map = self.map;
        let (Some(x), Some(axis)) = (Abscissa::of(&map.at), map.axes.first()) else {
            return;
        };
        let rows = axis.values.len();
        let first = self.second * rows;
        // Bold letters are about a fifth wider.
        let fit = area.width() / (1.2 * text_width(&self.title, 1.0)).max(1.0);
        let heading = Type::new(fit.min(NAME_SIZE), Anchor::Start).bold();
        c.text(&self.title, (area.x0, area.y0 - 10.0), heading);
        for i in 0..rows {
            paint_row(c, map, first + i, &x, &strip(area, rows, i), area);
        }
        self.grid(c, area, rows);
        for line in &map.lines {
            self.line(
                c,
                area,
                &x,
                line.kind,
                &line.step_s[first.min(line.step_s.len())..],
            );
        }
        let is_own = first + axis.own == map.own_row();
        if is_own {
            let own = strip(area, rows, axis.own);
            c.frame(&own, Stroke::new(Ink::ON_CELL, 1.4));
            if let Some(h) = map.limit().and_then(|l| l.unstable_s.and(l.stable_s)) {
                limit_mark(c, (x.place(h, area), 0.5 * (own.y0 + own.y1)));
            }
        }
        c.frame(area, Stroke::new(Ink::PALE, 1.0));
        self.ticks(c, area, &x, axis);
    }

    /// Paints fine white lines between the cells.
    fn grid(&self, c: &mut Canvas, area: &Rect, rows: usize) {
        let thin = Stroke::new(Ink::WHITE.opacity(0.55), 0.6);
        let width = area.width() / self.map.at.len() as f64;
        if width > 6.0 {
            for k in 1..self.map.at.len() {
                let x = area.x0 + width * k as f64;
                c.line(&[(x, area.y0), (x, area.y1)], thin);
            }
        }
        if area.height() / rows as f64 > 6.0 {
            for i in 1..rows {
                let y = strip(area, rows, i).y1;
                c.line(&[(area.x0, y), (area.x1, y)], thin);
            }
        }
    }

    /// Paints a line of theory: over the height of each row at its step, joined between rows.
    fn line(
        &self,
        c: &mut Canvas,
        area: &Rect,
        x: &Abscissa,
        kind: LineKind,
        steps: &[Option<f64>],
    ) {
        let rows = self.map.axes.first().map_or(0, |a| a.values.len());
        let mut piece: Vec<(f64, f64)> = Vec::new();
        for i in 0..rows {
            match steps.get(i).copied().flatten() {
                Some(h) => {
                    let (at, s) = (x.place(h, area), strip(area, rows, i));
                    piece.extend([(at, s.y1), (at, s.y0)]);
                }
                None => {
                    theory_line(c, &piece, area, kind);
                    piece.clear();
                }
            }
        }
        theory_line(c, &piece, area, kind);
    }

    fn ticks(&self, c: &mut Canvas, area: &Rect, x: &Abscissa, axis: &MapAxis) {
        let small = |anchor| Type::new(TICK_SIZE, anchor).ink(Ink::GREY);
        let (scale, name) = column_scale(self.map.columns);
        for (at, text) in x.ticks(scale, (area.width() / 46.0) as usize) {
            let at = x.place(at, area);
            c.line(
                &[(at, area.y1), (at, area.y1 + 4.0)],
                Stroke::new(Ink::PALE, 1.0),
            );
            c.text(&text, (at, area.y1 + 13.0), small(Anchor::Middle));
        }
        if self.x_name {
            let at = (0.5 * (area.x0 + area.x1), area.y1 + 31.0);
            c.text(name, at, Type::new(NAME_SIZE, Anchor::Middle));
        }
        if !self.y_labels {
            return;
        }
        let rows = axis.values.len();
        let every = (13.0 * rows as f64 / area.height()).ceil().max(1.0) as usize;
        for (i, text) in labels(axis).0.iter().enumerate() {
            let own = i == axis.own;
            // Labels keep their distance from that of the scene's own value.
            if !own && (axis.own.abs_diff(i) < every || i % every != 0) && every > 1 {
                continue;
            }
            let s = strip(area, rows, i);
            let kind = small(Anchor::End);
            let kind = if own {
                kind.ink(Ink::DARK).bold()
            } else {
                kind
            };
            c.text(text, (area.x0 - 6.0, 0.5 * (s.y0 + s.y1)), kind);
        }
    }
}

//! Heat maps with their colour bar; the colours increase evenly in lightness (viridis, S. van der Walt and N. Smith,
//! 2015), so that they can be read without colour vision.

use super::axis::{Axis, Frame, NAME_SIZE, TICK_SIZE, tick_label};
use super::canvas::{Anchor, Canvas, Ink, Stroke, Type};
use super::geometry::Rect;
use crate::numbers::significant;

/// Nine places of the colours, from least to greatest.
const COLOURS: [[u8; 3]; 9] = [
    [0x44, 0x01, 0x54],
    [0x47, 0x2d, 0x7b],
    [0x3b, 0x52, 0x8b],
    [0x2c, 0x72, 0x8e],
    [0x21, 0x91, 0x8c],
    [0x28, 0xae, 0x80],
    [0x5e, 0xc9, 0x62],
    [0xad, 0xdc, 0x30],
    [0xfd, 0xe7, 0x25],
];

/// Colours of a map: enough that steps are not seen, few enough that neighbours are one cell.
const LEVELS: usize = 40;

/// Returns the colour for a value, as a fraction of the greatest.
pub fn colour(part: f64) -> Ink {
    let last = COLOURS.len() - 1;
    let x = if part.is_finite() {
        part.clamp(0.0, 1.0)
    } else {
        0.0
    } * last as f64;
    let i = (x as usize).min(last - 1);
    let t = x - i as f64;
    let mixed = |k: usize| {
        let (a, b) = (f64::from(COLOURS[i][k]), f64::from(COLOURS[i + 1][k]));
        (a + t * (b - a)).round() as u8
    };
    Ink(mixed(0), mixed(1), mixed(2), 1.0)
}

/// Returns the colour of a level.
fn of_level(level: usize) -> Ink {
    colour(level as f64 / (LEVELS - 1) as f64)
}

/// Returns the edges of the cells around values: midpoints between neighbours.
fn edges(x: &[f64]) -> Vec<f64> {
    let n = x.len();
    if n < 2 {
        return x.iter().flat_map(|x| [*x, *x]).collect();
    }
    let first = x[0] - 0.5 * (x[1] - x[0]);
    let last = x[n - 1] + 0.5 * (x[n - 1] - x[n - 2]);
    let between = x.windows(2).map(|w| 0.5 * (w[0] + w[1]));
    std::iter::once(first)
        .chain(between)
        .chain([last])
        .collect()
}

/// Values in cells, by column: places of columns and rows in data, a scale of values.
pub struct HeatMap<'a> {
    pub x: &'a [f64],
    pub y: &'a [f64],
    pub columns: &'a [Vec<f64>],
    pub scale: &'a Axis,
    /// Unit of the values.
    pub unit: &'a str,
}

impl HeatMap<'_> {
    /// Paints the cells within a frame, under all else that the canvas has.
    pub fn paint(&self, c: &mut Canvas, frame: &Frame) {
        let (x, y) = (edges(self.x), edges(self.y));
        if ![x.as_slice(), &y].concat().iter().all(|at| at.is_finite()) {
            return;
        }
        let area = frame.area;
        let mut cells: Vec<Vec<Rect>> = vec![Vec::new(); LEVELS];
        let level = |value: f64| {
            let place = self.scale.place(value);
            let place = if place.is_finite() { place } else { 0.0 };
            (place.clamp(0.0, 1.0) * (LEVELS - 1) as f64).round() as usize
        };
        for (i, column) in self.columns.iter().enumerate() {
            let (a, b) = (x[i].min(x[i + 1]), x[i].max(x[i + 1]));
            // Neighbours of one colour are one cell.
            let mut from = 0;
            for k in 1..=column.len() {
                if k < column.len() && level(column[k]) == level(column[from]) {
                    continue;
                }
                let (x0, y1) = frame.at(a, y[from]);
                let (x1, y0) = frame.at(b, y[k]);
                let cell = Rect::new(
                    x0.clamp(area.x0, area.x1),
                    y0.clamp(area.y0, area.y1),
                    x1.clamp(area.x0, area.x1),
                    y1.clamp(area.y0, area.y1),
                );
                if cell.width() > 0.0 && cell.height() > 0.0 {
                    cells[level(column[from])].push(cell);
                }
                from = k;
            }
        }
        for (level, cells) in cells.iter().enumerate() {
            c.cells(cells, of_level(level), &self.range_text(level));
        }
    }
}

impl HeatMap<'_> {
    /// Returns the range of the values of a level, with unit.
    fn range_text(&self, level: usize) -> String {
        let last = (LEVELS - 1) as f64;
        let [low, high] = [-0.5, 0.5].map(|half| self.scale.at((level as f64 + half) / last));
        let unit = self.unit;
        let text = |x: f64| significant(x, 3);
        match level {
            0 => format!("below {} {unit}", text(high)),
            _ if level + 1 == LEVELS => format!("above {} {unit}", text(low)),
            _ => format!("{} to {} {unit}", text(low), text(high)),
        }
    }
}

/// Paints the bar of a scale: colours, ticks at its right, name and unit above.
pub fn colour_bar(c: &mut Canvas, area: Rect, scale: &Axis, name: &str) {
    let frame = Frame {
        area,
        x: Axis::linear(0.0, 1.0),
        y: scale.clone(),
    };
    let step = area.height() / LEVELS as f64;
    for level in 0..LEVELS {
        let bottom = area.y1 - step * level as f64;
        let cell = Rect::new(area.x0, bottom - step, area.x1, bottom);
        c.cells(&[cell], of_level(level), "");
    }
    c.frame(&area, Stroke::new(Ink::PALE, 1.0));
    let ticks = scale.ticks((area.height() / 34.0) as usize);
    for &t in &ticks {
        let (_, y) = frame.at(0.0, t);
        c.line(
            &[(area.x1, y), (area.x1 + 4.0, y)],
            Stroke::new(Ink::GREY, 1.0),
        );
        let kind = Type::new(TICK_SIZE, Anchor::Start).ink(Ink::GREY);
        c.text(&tick_label(t, &ticks, scale.log), (area.x1 + 7.0, y), kind);
    }
    let kind = Type::new(NAME_SIZE, Anchor::Middle);
    c.text(
        name,
        (0.5 * (area.x0 + area.x1) + 10.0, area.y0 - 11.0),
        kind,
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::canvas::draw;

    /// A single large value has the lightest colour in its own place; equal neighbours are merged to one cell.
    #[test]
    fn a_cell_has_the_colour_of_its_value() {
        let scale = Axis::decades(1e-3, 1.0);
        let columns = [vec![1e-3, 1e-3, 1e-3], vec![1e-3, 1.0, 0.0]];
        let map = HeatMap {
            x: &[1.0, 3.0],
            y: &[0.0, 1.0, 2.0],
            columns: &columns,
            scale: &scale,
            unit: "mm",
        };
        let frame = Frame {
            area: Rect::new(10.0, 0.0, 50.0, 30.0),
            x: Axis::linear(0.0, 4.0),
            y: Axis::linear(-0.5, 2.5),
        };
        let svg = draw(60.0, 40.0, "map", |c| map.paint(c, &frame)).unwrap();
        // The second column from x = 2 to 4, its middle row.
        assert!(
            svg.contains(
                "fill=\"#FDE725\" d=\"M300 100h200v100h-200z\"><title>above 0.915 mm</title>"
            ),
            "{svg}"
        );
        // The first column as one cell, and both ends of the second.
        assert!(
            svg.contains("d=\"M100 0h200v300h-200zM300 200h200v100h-200zM300 0h200v100h-200z\""),
            "{svg}"
        );
    }

    #[test]
    fn colours_grow_lighter() {
        let light = |Ink(r, g, b, _): Ink| {
            0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
        };
        let all: Vec<f64> = (0..LEVELS).map(|i| light(of_level(i))).collect();
        assert!(all.windows(2).all(|w| w[1] > w[0]), "{all:?}");
    }
}

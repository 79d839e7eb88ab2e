//! Axes: ranges, ticks at 1-2-5 steps or decades, and the frame of a plot.

use super::canvas::{Anchor, Canvas, Ink, Stroke, Type};
use super::geometry::Rect;
use crate::numbers::short;

/// Font size of tick labels.
pub const TICK_SIZE: f64 = 12.5;
/// Font size of axis names and legends.
pub const NAME_SIZE: f64 = 13.5;

/// Largest magnitude on a chart: larger values are drawn at the edge, so that decades, spans and scales stay finite.
const GREATEST: f64 = 1e100;
const LEAST: f64 = 1e-100;

/// One axis: a range, linear or logarithmic.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    pub min: f64,
    pub max: f64,
    pub log: bool,
    /// Seconds per unit of the axis, if it is one of time.
    pub seconds: Option<f64>,
}

impl Axis {
    /// Makes a linear axis over exactly this range; an empty or broken range is widened.
    pub fn linear(min: f64, max: f64) -> Self {
        let (min, max) = if min.is_finite() && max.is_finite() {
            let [a, b] = [min, max].map(|x| x.clamp(-GREATEST, GREATEST));
            (a.min(b), a.max(b))
        } else {
            (0.0, 1.0)
        };
        let least = 1e-9 * min.abs().max(max.abs()).max(1e-300);
        let (min, max) = if max - min > least {
            (min, max)
        } else if min == 0.0 {
            (0.0, 1.0)
        } else {
            (min - 0.05 * min.abs(), max + 0.05 * max.abs())
        };
        Self {
            min,
            max,
            log: false,
            seconds: None,
        }
    }

    /// Makes a linear axis with the part `margin` of the range added at both ends.
    pub fn padded(min: f64, max: f64, margin: f64) -> Self {
        let axis = Self::linear(min, max);
        let pad = margin * (axis.max - axis.min);
        Self::linear(axis.min - pad, axis.max + pad)
    }

    /// Makes a linear axis from zero to a little more than `max`.
    pub fn from_zero(max: f64) -> Self {
        Self::linear(0.0, if max > 0.0 { 1.08 * max } else { 1.0 })
    }

    /// Makes a logarithmic axis around positive values, a fifth of a decade wider at both ends.
    pub fn logarithmic(min: f64, max: f64) -> Self {
        if !(min > 0.0 && max.is_finite()) {
            return Self::linear(0.0, 1.0);
        }
        let [low, high] = [min, max.max(min)].map(|x| x.clamp(LEAST, GREATEST).log10());
        Self::decades(10f64.powf(low - 0.2), 10f64.powf(high + 0.2))
    }

    /// Makes a logarithmic axis over exactly this range of positive values; an empty or broken range is widened.
    pub fn decades(min: f64, max: f64) -> Self {
        let [min, max] = [min, max].map(|x| {
            if x.is_nan() {
                1.0
            } else {
                x.clamp(LEAST, GREATEST)
            }
        });
        let (min, max) = (min.min(max), min.max(max));
        let (min, max) = if max > min * (1.0 + 1e-9) {
            (min, max)
        } else {
            (0.9 * min, 1.1 * max)
        };
        Self {
            min,
            max,
            log: true,
            seconds: None,
        }
    }

    /// Returns the axis as one of time in units of so many seconds.
    pub fn of_time(self, seconds: f64) -> Self {
        Self {
            seconds: Some(seconds),
            ..self
        }
    }

    /// Returns the position in the range, from 0 at the lower to 1 at the upper end.
    pub fn place(&self, x: f64) -> f64 {
        if self.log {
            (x.max(1e-300) / self.min).log10() / (self.max / self.min).log10()
        } else {
            (x - self.min) / (self.max - self.min)
        }
    }

    /// Returns the value at a position in the range; the inverse of [`Axis::place`].
    pub fn at(&self, place: f64) -> f64 {
        match self.log {
            true => self.min * (self.max / self.min).powf(place),
            false => self.min + place * (self.max - self.min),
        }
    }

    /// Returns the main ticks, at most about `most`.
    pub fn ticks(&self, most: usize) -> Vec<f64> {
        if self.log {
            let (low, high) = (self.min.log10(), self.max.log10());
            let mantissas: &[f64] = if high - low < 2.2 {
                &[1.0, 2.0, 5.0]
            } else {
                &[1.0]
            };
            let every = (((high - low) / most.max(1) as f64).ceil() as i32).max(1);
            return ((low.floor() as i32)..=(high.ceil() as i32))
                .filter(|e| e % every == 0)
                .flat_map(|e| mantissas.iter().map(move |m| m * 10f64.powi(e)))
                .filter(|x| *x >= self.min * (1.0 - 1e-9) && *x <= self.max * (1.0 + 1e-9))
                .collect();
        }
        let range = self.max - self.min;
        let mut step = nice_step(range / most.max(1) as f64);
        if range / step < 2.5 {
            step = nice_step(0.4 * step);
        }
        let (first, last) = (
            (self.min / step - 1e-6).ceil(),
            (self.max / step + 1e-6).floor(),
        );
        if !(first.is_finite() && last - first < 1000.0) {
            return Vec::new();
        }
        (0..=(last - first).max(0.0) as usize)
            .map(|i| (first + i as f64) * step)
            .collect()
    }
}

/// Returns the least of 1, 2, 5 times a power of ten that is not below `x`.
pub fn nice_step(x: f64) -> f64 {
    if !(x.is_finite() && x > 0.0) {
        return 1.0;
    }
    let power = 10f64.powf(x.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|m| m * power)
        .find(|s| *s >= x * (1.0 - 1e-9))
        .unwrap_or(10.0 * power)
}

/// Formats a tick; its neighbours determine digits and notation, so that they are the same for the whole axis.
pub fn tick_label(x: f64, ticks: &[f64], log: bool) -> String {
    if log {
        let plain = |t: &f64| (0.999e-3..1.001e5).contains(t);
        return if ticks.iter().all(plain) {
            short(x, 2)
        } else {
            power_of_ten(x)
        };
    }
    let step = ticks.windows(2).map(|w| w[1] - w[0]).next().unwrap_or(x);
    if x.abs() < 1e-6 * step.abs() {
        return "0".into();
    }
    let largest = ticks.iter().fold(x.abs(), |a, t| a.max(t.abs()));
    if largest >= 1e6 || step.abs() < 1e-4 {
        return power_of_ten(x);
    }
    let decimals = (-step.abs().log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{x:.decimals$}").replace('-', "\u{2212}")
}

/// Formats a number with a power of ten, such as 2\u{b7}10\u{207b}\u{2075}.
fn power_of_ten(x: f64) -> String {
    let text = format!("{x:.3e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let raised: String = (exponent.chars())
        .map(|c| match c {
            '-' => '\u{207b}',
            '1' => '\u{b9}',
            '2' => '\u{b2}',
            '3' => '\u{b3}',
            c => char::from_u32(0x2070 + c.to_digit(10).unwrap_or(0)).unwrap_or(c),
        })
        .collect();
    let mantissa = mantissa
        .trim_end_matches('0')
        .trim_end_matches('.')
        .replace('-', "\u{2212}");
    match mantissa.as_str() {
        "1" => format!("10{raised}"),
        _ => format!("{mantissa}\u{b7}10{raised}"),
    }
}

/// A plot on the page with its two axes.
pub struct Frame {
    /// Area of the plot on the page.
    pub area: Rect,
    pub x: Axis,
    pub y: Axis,
}

impl Frame {
    /// Returns the point on the page of a point in data.
    pub fn at(&self, x: f64, y: f64) -> (f64, f64) {
        (
            self.area.x0 + self.x.place(x) * self.area.width(),
            self.area.y1 - self.y.place(y) * self.area.height(),
        )
    }

    /// Returns the attributes of the group of a plot, from which the script of a page computes values of points: area on
    /// the page, ranges, and names of the axes. The class is `panel` for curves and points, `map` for cells.
    pub fn attributes(
        &self,
        class: &str,
        x: &str,
        y: &str,
        title: &str,
    ) -> Vec<(&'static str, String)> {
        let r = &self.area;
        let range = |axis: &Axis| {
            let log = if axis.log { " log" } else { "" };
            format!("{} {}{log}", axis.min, axis.max)
        };
        vec![
            ("class", class.into()),
            (
                "data-area",
                format!("{:.3} {:.3} {:.3} {:.3}", r.x0, r.y0, r.x1, r.y1),
            ),
            ("data-x", range(&self.x)),
            ("data-y", range(&self.y)),
            ("data-x-name", x.into()),
            ("data-y-name", y.into()),
            ("data-title", title.into()),
        ]
    }

    /// Paints the abscissa alone, with at most about `most` ticks: grid, labels, base line, name.
    pub fn paint_x(&self, c: &mut Canvas, name: &str, most: usize) {
        let r = &self.area;
        let ticks = self.x.ticks(most);
        for &t in &ticks {
            let (x, _) = self.at(t, self.y.min);
            c.line(&[(x, r.y0), (x, r.y1)], Stroke::new(Ink::GRID, 0.8));
            let kind = Type::new(TICK_SIZE, Anchor::Middle).ink(Ink::GREY);
            c.text(&tick_label(t, &ticks, self.x.log), (x, r.y1 + 12.0), kind);
        }
        c.line(&[(r.x0, r.y1), (r.x1, r.y1)], Stroke::new(Ink::PALE, 1.0));
        let at = (0.5 * (r.x0 + r.x1), r.y1 + 30.0);
        c.text(name, at, Type::new(NAME_SIZE, Anchor::Middle));
    }

    /// Paints grid, tick labels, names and edge. `x_labels` is off for panels that share the axis below.
    pub fn paint(&self, c: &mut Canvas, x_name: &str, y_name: &str, x_labels: bool) {
        let ticks = self.x.ticks((self.area.width() / 85.0) as usize);
        let ticks: Vec<(f64, String)> = (ticks.iter())
            .map(|&t| (t, tick_label(t, &ticks, self.x.log)))
            .collect();
        self.paint_at(c, &ticks, x_name, y_name, x_labels);
    }

    /// Paints the frame like `paint`, but with ticks of the abscissa that the caller gives.
    pub fn paint_at(
        &self,
        c: &mut Canvas,
        x_ticks: &[(f64, String)],
        x_name: &str,
        y_name: &str,
        x_labels: bool,
    ) {
        c.group(&[("class", "axes".into())], |c| {
            self.paint_grid(c, x_ticks, x_labels);
        });
        let r = &self.area;
        c.frame(r, Stroke::new(Ink::PALE, 1.0));
        if x_labels {
            let middle = 0.5 * (r.x0 + r.x1);
            c.text(
                x_name,
                (middle, r.y1 + 30.0),
                Type::new(NAME_SIZE, Anchor::Middle),
            );
        }
        let middle = 0.5 * (r.y0 + r.y1);
        c.text(
            y_name,
            (14.0, middle),
            Type::new(NAME_SIZE, Anchor::Middle).upwards(),
        );
    }

    /// Paints lines and labels of the ticks, which the script of a page replaces where it shows a part of the range.
    fn paint_grid(&self, c: &mut Canvas, x_ticks: &[(f64, String)], x_labels: bool) {
        let r = &self.area;
        let grid = Stroke::new(Ink::GRID, 0.8);
        let small = |anchor| Type::new(TICK_SIZE, anchor).ink(Ink::GREY);
        for (t, label) in x_ticks {
            let (x, _) = self.at(*t, self.y.min);
            c.line(&[(x, r.y0), (x, r.y1)], grid);
            if x_labels {
                c.text(label, (x, r.y1 + 12.0), small(Anchor::Middle));
            }
        }
        let ticks = self.y.ticks((r.height() / 38.0).max(3.0) as usize);
        for &t in &ticks {
            let (_, y) = self.at(self.x.min, t);
            c.line(&[(r.x0, y), (r.x1, y)], grid);
            c.text(
                &tick_label(t, &ticks, self.y.log),
                (r.x0 - 7.0, y),
                small(Anchor::End),
            );
        }
        if !self.y.log && self.y.min < 0.0 && self.y.max > 0.0 {
            let (_, y) = self.at(self.x.min, 0.0);
            c.line(&[(r.x0, y), (r.x1, y)], Stroke::new(Ink::PALE, 1.0));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let a = Axis::linear(-0.31, 1.02);
        assert_eq!(a.ticks(7).len(), 7);
        let labels: Vec<String> = (a.ticks(7).iter())
            .map(|t| tick_label(*t, &a.ticks(7), false))
            .collect();
        assert_eq!(labels[1], "0");
        assert_eq!(labels[6], "1.0");
        let l = Axis::logarithmic(2e-4, 3e-1);
        assert_eq!(l.ticks(8), [1e-3, 1e-2, 1e-1]);
        assert!((l.place(l.min)).abs() < 1e-12 && (l.place(l.max) - 1.0).abs() < 1e-12);
        assert_eq!(nice_step(0.031), 0.05);
        for axis in [a, l] {
            let x = axis.at(0.3);
            assert!((axis.place(x) - 0.3).abs() < 1e-12, "{axis:?}");
        }
    }

    /// All tick labels of an axis have the same notation: never 1e-5 next to 0.001.
    #[test]
    fn ticks_of_an_axis_are_in_one_notation() {
        let labels = |ticks: &[f64], log| -> Vec<String> {
            ticks.iter().map(|t| tick_label(*t, ticks, log)).collect()
        };
        let small = labels(&[1e-5, 1e-4, 1e-3], true);
        assert_eq!(
            small,
            [
                "10\u{207b}\u{2075}",
                "10\u{207b}\u{2074}",
                "10\u{207b}\u{b3}"
            ]
        );
        assert_eq!(labels(&[0.01, 1.0, 1e4], true), ["0.01", "1", "10000"]);
        assert_eq!(
            labels(&[5e5, 1e6], false),
            ["5\u{b7}10\u{2075}", "10\u{2076}"]
        );
        assert_eq!(labels(&[2e12], true), ["2\u{b7}10\u{b9}\u{b2}"]);
    }

    #[test]
    fn broken_ranges_give_an_axis() {
        for (a, b) in [
            (0.0, 0.0),
            (f64::NAN, 1.0),
            (3.0, 3.0),
            (f64::NEG_INFINITY, 0.0),
            (1e300, -1e300),
            (f64::MIN, f64::MAX),
            (5e-324, f64::MAX),
            (0.0, 1.0),
        ] {
            for axis in [
                Axis::linear(a, b),
                Axis::padded(a, b, 0.1),
                Axis::from_zero(b),
                Axis::logarithmic(a, b),
                Axis::decades(a, b),
            ] {
                assert!(
                    axis.max > axis.min && (axis.max - axis.min).is_finite(),
                    "{axis:?}"
                );
                assert!(axis.ticks(5).len() < 1000, "{axis:?}");
                let place = axis.place(0.5 * (axis.min + axis.max));
                assert!((0.0..=1.0).contains(&place), "{axis:?}: {place}");
            }
        }
        assert!(!Axis::logarithmic(0.0, 1.0).log);
    }
}

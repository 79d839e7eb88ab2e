//! Panels of curves under one legend: lines, points, limits, marks and failures.

use super::Chart;
use super::axis::{Axis, Frame, TICK_SIZE, tick_label};
use super::canvas::{Anchor, Canvas, DrawError, Ink, Stroke, Type, draw_with, text_width};
use super::geometry::Rect;
use super::labels::OccupiedArea;
use super::legend::{Entry, entry_of, legend_height, paint_legend};
use super::scatter;
use super::style::{CurveStyle, cross, curve_style, marker};
use crate::series::decimate;

/// Width of a chart on the page.
pub const WIDTH: f64 = 860.0;
/// Space for the names and tick labels at the left.
pub const LEFT: f64 = 78.0;
/// Space at the right.
pub const RIGHT: f64 = 16.0;
/// Height of the strip of failed runs above a panel.
const STRIP: f64 = 22.0;
/// Between panels, and below one with names under its abscissa.
const GAP: f64 = 14.0;
const NAMES: f64 = 52.0;
/// Extremes of a long history are kept in so many parts of a panel: more than the histories of records have.
const BUCKETS: usize = 2000;
/// Approximate distance between the markers of its model on a line without points of its own; models alternate.
const SPACING: f64 = 150.0;
/// Opacity of points that are not strong.
const FAINT: f64 = 0.3;
/// Height of the line of text above a panel.
const ABOVE: f64 = 17.0;

/// Points of one variant, and the line through them.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Stroke of the line; `None` draws the points alone.
    pub stroke: Option<Stroke>,
    /// Look, radius and filling of the markers; `None` draws the line alone.
    pub marker: Option<(CurveStyle, f64, bool)>,
    /// Points, ascending in the abscissa.
    pub points: Vec<(f64, f64)>,
    /// Abscissae of runs that failed.
    pub failed: Vec<f64>,
    /// Colour of their crosses.
    pub ink: Ink,
    /// Index of the model whose markers are drawn along the line.
    pub along: Option<usize>,
    /// Name among the curves of one entry of the legend; empty for a curve that has the entry for itself.
    pub name: String,
}

impl Curve {
    /// Makes a curve that is a line without markers.
    pub fn line(stroke: Stroke, points: Vec<(f64, f64)>) -> Self {
        Self {
            stroke: Some(stroke),
            marker: None,
            points,
            failed: Vec::new(),
            ink: stroke.ink,
            along: None,
            name: String::new(),
        }
    }

    /// Makes a curve of markers without a line.
    pub fn points(look: CurveStyle, radius: f64, filled: bool, points: Vec<(f64, f64)>) -> Self {
        Self {
            stroke: None,
            marker: Some((look, radius, filled)),
            points,
            failed: Vec::new(),
            ink: look.ink,
            along: None,
            name: String::new(),
        }
    }

    /// Makes a curve of markers joined by a line in the look of their variant.
    pub fn joined(look: CurveStyle, width: f64, radius: f64, points: Vec<(f64, f64)>) -> Self {
        Self {
            stroke: Some(Stroke::dashed(look.ink, width, look.dash)),
            ..Self::points(look, radius, true, points)
        }
    }

    /// Adds the markers of a model along the line.
    pub fn along(self, style: Option<usize>) -> Self {
        Self {
            along: style,
            ..self
        }
    }

    /// Adds the abscissae of runs that failed.
    pub fn failed(self, failed: Vec<f64>) -> Self {
        Self { failed, ..self }
    }

    /// Makes a history in a window of its abscissa, thinned without losing its extrema.
    pub fn history(stroke: Stroke, window: &Axis, x: &[f64], y: &[f64]) -> Self {
        let n = x.len().min(y.len());
        let start = x[..n]
            .partition_point(|x| *x < window.min)
            .saturating_sub(1);
        let end = (x[..n].partition_point(|x| *x <= window.max) + 1).min(n);
        let kept = if start < end {
            decimate(&x[start..end], &y[start..end], BUCKETS)
        } else {
            Vec::new()
        };
        let points = kept.into_iter().map(|i| (x[start + i], y[start + i]));
        Self::line(stroke, points.collect())
    }
}

/// A line that is no curve to be read, such as a front: it stays with its points while the chart is zoomed.
#[derive(Clone, Debug)]
pub struct Guide {
    /// Points of the line.
    pub points: Vec<(f64, f64)>,
    pub stroke: Stroke,
    /// Index of its entry of the legend, if it has one.
    pub entry: Option<usize>,
}

/// A point with a text of its own, which a page shows at the cursor.
#[derive(Clone, Debug)]
pub struct LabelledPoint {
    /// Abscissa and ordinate.
    pub at: (f64, f64),
    /// Index of its entry of the legend.
    pub entry: usize,
    /// Look of its marker.
    pub look: CurveStyle,
    /// False for a smaller, translucent marker.
    pub is_strong: bool,
    /// Text at the cursor.
    pub text: String,
}

#[derive(Clone, Debug)]
pub struct Panel {
    /// Height of the plot.
    pub height: f64,
    pub x: Axis,
    /// Ticks of the abscissa; empty for those of the axis.
    pub x_ticks: Vec<(f64, String)>,
    /// Name of the abscissa, if this panel shows it.
    pub x_name: Option<String>,
    /// Axis of the ordinate; `None` for a range around the points.
    pub y: Option<Axis>,
    /// Name and unit of the ordinate.
    pub y_name: String,
    /// Heading above its left end.
    pub remark: String,
    /// Curves, the first at the bottom of the pile.
    pub curves: Vec<Curve>,
    /// Lines that are no curves to be read, above the curves.
    pub guides: Vec<Guide>,
    /// Points with texts of their own, the first at the bottom of the pile.
    pub labelled: Vec<LabelledPoint>,
    /// Horizontal limits with their names.
    pub limits: Vec<(f64, String)>,
    /// Vertical lines with their names.
    pub verticals: Vec<(f64, String)>,
    /// Ranges of the abscissa that are tinted.
    pub bands: Vec<([f64; 2], Ink)>,
    /// Points that are marked with a name.
    pub marks: Vec<((f64, f64), String)>,
}

impl Panel {
    /// Makes a panel without curves.
    pub fn new(height: f64, x: &Axis, y_name: &str) -> Self {
        Self {
            height,
            x: x.clone(),
            x_ticks: Vec::new(),
            x_name: None,
            y: None,
            y_name: y_name.into(),
            remark: String::new(),
            curves: Vec::new(),
            guides: Vec::new(),
            labelled: Vec::new(),
            limits: Vec::new(),
            verticals: Vec::new(),
            bands: Vec::new(),
            marks: Vec::new(),
        }
    }

    pub fn remark(self, remark: impl Into<String>) -> Self {
        let remark = remark.into();
        Self { remark, ..self }
    }

    pub fn curves(self, curves: impl IntoIterator<Item = Curve>) -> Self {
        let curves = curves.into_iter().collect();
        Self { curves, ..self }
    }

    fn strip(&self) -> f64 {
        let failed = self.curves.iter().any(|c| !c.failed.is_empty());
        if failed { STRIP } else { 0.0 }
    }

    /// Returns the height of the heading and of the names of vertical lines.
    fn above(&self) -> f64 {
        let named = self.verticals.iter().any(|v| !v.1.is_empty());
        ABOVE * (usize::from(named) + usize::from(!self.remark.is_empty())) as f64
    }

    fn total_height(&self) -> f64 {
        let below = if self.x_name.is_some() { NAMES } else { GAP };
        self.above() + self.strip() + self.height + below
    }

    /// Returns least and greatest finite ordinate of all points.
    pub fn ordinates(&self) -> (f64, f64) {
        let values = self
            .curves
            .iter()
            .flat_map(|c| c.points.iter().map(|p| p.1));
        extremes(values)
    }

    /// Sets the ordinate to the range of all points.
    pub fn close(mut self) -> Self {
        let (low, high) = self.ordinates();
        self.y = Some(Axis::padded(low, high, 0.07));
        self
    }

    /// Sets the ordinate to the range of all points where these are alike within a factor of two, so that their
    /// differences are seen. The range is at least 2 % of the values, so that rounding is not.
    pub fn near(mut self) -> Self {
        let (low, high) = self.ordinates();
        if low > 0.5 * high && high.is_finite() {
            let missing = 0.5 * (0.02 * high - (high - low)).max(0.0);
            self.y = Some(Axis::padded(low - missing, high + missing, 0.08));
        }
        self
    }

    /// Returns an axis over all points and limits, logarithmic when they span more than a decade.
    fn range(&self) -> Axis {
        let (a, b) = self.ordinates();
        let (low, high) = extremes(self.limits.iter().map(|l| l.0).chain([a, b]));
        if low > 0.0 && high > 10.0 * low {
            Axis::logarithmic(low, high)
        } else if low >= 0.0 {
            Axis::from_zero(high)
        } else {
            Axis::padded(low, high, 0.08)
        }
    }

    /// Returns the plot of the panel on a chart of this width.
    fn frame(&self, top: f64, width: f64) -> Frame {
        let y0 = top + self.above() + self.strip();
        Frame {
            area: Rect::new(LEFT, y0, width - RIGHT, y0 + self.height),
            x: self.x.clone(),
            y: self.y.clone().unwrap_or_else(|| self.range()),
        }
    }

    fn paint(&self, c: &mut Canvas, top: f64, frame: &Frame, legend: &[Entry]) {
        let area = frame.area;
        let ticks = if self.x_ticks.is_empty() {
            let at = frame.x.ticks((area.width() / 85.0) as usize);
            let label = |&t: &f64| (t, tick_label(t, &at, frame.x.log));
            at.iter().map(label).collect()
        } else {
            self.x_ticks.clone()
        };
        let name = self.x_name.as_deref();
        let notes = [("class", "notes".to_owned())];
        self.paint_bands(c, frame);
        frame.paint_at(c, &ticks, name.unwrap_or(""), &self.y_name, name.is_some());
        let heading = !self.remark.is_empty();
        if heading {
            let kind = Type::new(TICK_SIZE, Anchor::Start).ink(Ink::GREY);
            c.text(&self.remark, (area.x0, top + 7.0), kind);
        }
        let names = top + if heading { ABOVE } else { 0.0 } + 7.0;
        let mut room = OccupiedArea::of(area);
        self.paint_verticals(c, frame, names, &mut room);
        for curve in &self.curves {
            let entry = entry_of(legend, curve);
            let entry = entry.map(|i| ("data-entry", i.to_string()));
            let name = Some(&curve.name).filter(|name| !name.is_empty());
            let name = name.map(|name| ("data-name", name.clone()));
            let class = [("class", "curve".to_owned())];
            let attributes: Vec<_> = class.into_iter().chain(entry).chain(name).collect();
            c.group(&attributes, |c| {
                self.paint_curve(c, frame, curve, &mut room)
            });
        }
        self.paint_labelled(c, frame, &mut room);
        let small = Type::new(TICK_SIZE, Anchor::Start);
        scatter::limits(c, frame, &self.limits, &mut room);
        c.group(&notes, |c| {
            for ((x, y), text) in &self.marks {
                room.write(c, text, frame.at(*x, *y), small);
            }
        });
        if self.strip() > 0.0 {
            self.paint_failures(c, frame);
        }
    }

    /// Paints the tinted ranges of the abscissa.
    fn paint_bands(&self, c: &mut Canvas, frame: &Frame) {
        let area = frame.area;
        for ([a, b], ink) in &self.bands {
            let [x0, x1] = [a, b].map(|x| frame.at(*x, frame.y.min).0.clamp(area.x0, area.x1));
            let band = Rect::new(x0, area.y0, x1.max(x0 + 2.0), area.y1);
            c.group(&[("class", "band".to_owned())], |c| c.fill(&band, *ink));
        }
    }

    fn paint_curve(&self, c: &mut Canvas, frame: &Frame, curve: &Curve, room: &mut OccupiedArea) {
        let area = frame.area;
        let inside = area.grown(1.0);
        let points: Vec<(f64, f64)> = curve.points.iter().map(|p| frame.at(p.0, p.1)).collect();
        if let Some(stroke) = curve.stroke {
            c.curve(&points, &area, stroke);
            room.occupy_line(&points);
        }
        // The places of markers, for the script of a page, which moves them with their line or with their points.
        let class = |name: &str, (x, y): (f64, f64)| {
            [
                ("class", name.to_owned()),
                ("data-at", format!("{x:.3} {y:.3}")),
            ]
        };
        if let Some(style) = curve.along {
            let first = area.x0 + SPACING * (0.2 + 0.62 * style as f64).fract();
            let places = (0..).map(|k| first + SPACING * f64::from(k));
            for x in places.take_while(|x| *x < area.x1) {
                if let Some(at) = at_abscissa(&points, x).filter(|p| inside.holds(*p)) {
                    c.group(&class("along", at), |c| {
                        marker(c, at, 4.4, curve_style(style), true);
                    });
                    room.occupy_point(at, 5.4);
                }
            }
        }
        let Some((look, radius, filled)) = curve.marker else {
            return;
        };
        for p in points.into_iter().filter(|p| inside.holds(*p)) {
            c.group(&class("point", p), |c| marker(c, p, radius, look, filled));
            room.occupy_point(p, radius + 1.0);
        }
    }

    /// Paints guides, and points with texts of their own.
    fn paint_labelled(&self, c: &mut Canvas, frame: &Frame, room: &mut OccupiedArea) {
        let inside = frame.area.grown(1.0);
        for guide in &self.guides {
            let path: Vec<(f64, f64)> = guide.points.iter().map(|p| frame.at(p.0, p.1)).collect();
            scatter::guide(c, &path, &frame.area, guide.stroke, guide.entry);
            room.occupy_line(&path);
        }
        for p in &self.labelled {
            let at = frame.at(p.at.0, p.at.1);
            if !inside.holds(at) {
                continue;
            }
            let (radius, ink) = match p.is_strong {
                true => (5.0, p.look.ink),
                false => (3.4, p.look.ink.opacity(FAINT)),
            };
            let look = CurveStyle { ink, ..p.look };
            scatter::point(c, at, (p.entry, None), &p.text, |c| {
                marker(c, at, radius, look, true);
            });
            match p.is_strong {
                true => room.occupy_point(at, radius + 0.6),
                false => room.keep_pale(at, radius),
            }
        }
    }

    /// Paints vertical lines; a name that would overlap the one before it is left out.
    fn paint_verticals(&self, c: &mut Canvas, frame: &Frame, y: f64, room: &mut OccupiedArea) {
        let area = frame.area;
        let mut free = f64::NEG_INFINITY;
        for (at, text) in &self.verticals {
            let (x, _) = frame.at(*at, frame.y.min);
            if !(area.x0..=area.x1).contains(&x) {
                continue;
            }
            let line = [(x, area.y0), (x, area.y1)];
            room.occupy_line(&line);
            c.group(&upright((x, area.y0)), |c| {
                c.line(&line, Stroke::dashed(Ink::PALE, 1.2, &[4.0, 3.0]));
                let half = 0.5 * text_width(text, TICK_SIZE - 0.5);
                let centre = x.clamp(area.x0 + half, (area.x1 - half).max(area.x0 + half));
                if centre - half > free {
                    let kind = Type::new(TICK_SIZE - 0.5, Anchor::Middle).ink(Ink::GREY);
                    c.text(text, (centre, y), kind);
                    free = centre + half + 6.0;
                }
            });
        }
    }

    /// Paints the strip above a panel with a cross for every failed run.
    fn paint_failures(&self, c: &mut Canvas, frame: &Frame) {
        let area = frame.area;
        let strip = Rect::new(area.x0, area.y0 - STRIP, area.x1, area.y0 - 4.0);
        c.edge_of_failures(&strip);
        let kind = Type::new(TICK_SIZE, Anchor::End).ink(Ink::FAIL);
        c.text("failed", (area.x0 - 7.0, strip.middle()), kind);
        for curve in &self.curves {
            for &x in &curve.failed {
                let (x, _) = frame.at(x, frame.y.min);
                let at = (x, strip.middle());
                c.group(&upright(at), |c| cross(c, at, 4.2, curve.ink));
            }
        }
    }
}

/// Returns the attributes of a mark at an abscissa, which a page keeps there while the chart is zoomed.
fn upright((x, y): (f64, f64)) -> [(&'static str, String); 2] {
    [
        ("class", "upright".to_owned()),
        ("data-at", format!("{x:.3} {y:.3}")),
    ]
}

/// Returns least and greatest finite value.
pub fn extremes(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let ends = (f64::INFINITY, f64::NEG_INFINITY);
    let finite = values.filter(|x| x.is_finite());
    finite.fold(ends, |(low, high), x| (low.min(x), high.max(x)))
}

/// Returns the point of a line at an abscissa of the page.
fn at_abscissa(points: &[(f64, f64)], x: f64) -> Option<(f64, f64)> {
    let pair = points.windows(2).find(|p| p[0].0 <= x && x <= p[1].0)?;
    let [(x0, y0), (x1, y1)] = [pair[0], pair[1]];
    let part = if x1 > x0 { (x - x0) / (x1 - x0) } else { 0.0 };
    Some((x, y0 + part * (y1 - y0)))
}

/// Draws a chart of panels under one legend.
pub fn chart(
    file: &str,
    title: impl Into<String>,
    caption: impl Into<String>,
    legend: &[Entry],
    panels: &[Panel],
) -> Result<Chart, DrawError> {
    chart_of_width(WIDTH, file, title, caption, legend, panels)
}

/// Draws a chart of panels under one legend, of a width of its own.
pub fn chart_of_width(
    width: f64,
    file: &str,
    title: impl Into<String>,
    caption: impl Into<String>,
    legend: &[Entry],
    panels: &[Panel],
) -> Result<Chart, DrawError> {
    let head = 10.0 + legend_height(legend, width);
    let height = head + panels.iter().map(Panel::total_height).sum::<f64>();
    let title = title.into();
    let seconds = panels.iter().find_map(|p| p.x.seconds);
    let svg = draw_with(width, height, &title, &chart_attributes(seconds), |c| {
        paint_legend(c, legend, width);
        let mut y = head;
        for (i, panel) in panels.iter().enumerate() {
            let frame = panel.frame(y, width);
            // Panels over one abscissa have its name below the last of them.
            let named = panels[i..].iter().find_map(|p| p.x_name.as_deref());
            let mut attributes =
                frame.attributes("panel", named.unwrap_or(""), &panel.y_name, &panel.remark);
            // Ticks at places of their own cannot be made for a part of the range.
            attributes.extend((!panel.x_ticks.is_empty()).then(|| ("data-fixed", String::new())));
            c.group(&attributes, |c| panel.paint(c, y, &frame, legend));
            y += panel.total_height();
        }
    })?;
    Ok(Chart {
        file: file.into(),
        title,
        caption: caption.into(),
        svg,
    })
}

/// Returns the attributes of a chart that the script of a page reads: that it has panels, and, of a chart over time, the
/// seconds per unit of its abscissa.
fn chart_attributes(seconds: Option<f64>) -> Vec<(&'static str, String)> {
    let time = seconds.map(|s| ("data-time", s.to_string()));
    let class = [("class", "panels".to_owned())];
    class.into_iter().chain(time).collect()
}

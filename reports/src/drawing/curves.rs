//! Panels of points joined by lines over any abscissa, with limits, marks and failures.

use super::axis::{Axis, Frame, NAME_SIZE, TICK_SIZE, tick_label};
use super::canvas::{Anchor, Canvas, DrawError, Ink, Rect, Stroke, Type, draw, text_width};
use super::lines::{LEFT, RIGHT, WIDTH};
use super::style::{Look, cross, marker};

/// Height of the strip above a panel in which failures stand.
const STRIP: f64 = 22.0;
/// Between panels, and below one with names under its abscissa.
const GAP: f64 = 14.0;
const NAMES: f64 = 52.0;
const LEGEND_ROW: f64 = 21.0;

/// A point that a panel points out.
#[derive(Clone, Debug)]
pub struct Mark {
    /// Where.
    pub at: (f64, f64),
    /// What it is called.
    pub text: String,
}

/// Points of one variant.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Look.
    pub look: Look,
    /// Line width; 0 leaves the points alone.
    pub width: f64,
    /// Radius of the markers; 0 leaves the line alone.
    pub radius: f64,
    /// Markers are filled.
    pub filled: bool,
    /// Points, ascending in the abscissa.
    pub points: Vec<(f64, f64)>,
    /// Abscissae of runs that failed.
    pub failed: Vec<f64>,
}

/// One panel.
#[derive(Clone, Debug)]
pub struct CurvePanel {
    /// Height of the plot.
    pub height: f64,
    /// Abscissa.
    pub x: Axis,
    /// Its ticks; empty takes those of the axis.
    pub x_ticks: Vec<(f64, String)>,
    /// Its name, when this panel shows it.
    pub x_name: Option<String>,
    /// Ordinate; taken from the points when absent.
    pub y: Option<Axis>,
    /// Name and unit of the ordinate.
    pub y_name: String,
    /// Remark at the top left.
    pub remark: String,
    /// Curves, the first at the bottom of the pile.
    pub curves: Vec<Curve>,
    /// Horizontal limits with their names.
    pub limits: Vec<(f64, String)>,
    /// Vertical lines with their names.
    pub verticals: Vec<(f64, String)>,
    /// Points with names.
    pub marks: Vec<Mark>,
}

impl CurvePanel {
    fn strip(&self) -> f64 {
        if self.curves.iter().any(|c| !c.failed.is_empty()) {
            STRIP
        } else {
            0.0
        }
    }

    fn tall(&self) -> f64 {
        let below = if self.x_name.is_some() { NAMES } else { GAP };
        let above = if self.verticals.is_empty() { 0.0 } else { 14.0 };
        above + self.strip() + self.height + below
    }

    /// A range of all points and limits; logarithmic when it spans more than a decade.
    fn range(&self) -> Axis {
        let finite = |y: &f64| y.is_finite();
        let values: Vec<f64> = (self.curves.iter())
            .flat_map(|c| c.points.iter().map(|p| p.1))
            .chain(self.limits.iter().map(|l| l.0))
            .filter(finite)
            .collect();
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        // Head room for the remark.
        let room = if self.remark.is_empty() { 0.0 } else { 0.12 };
        if low > 0.0 && high > 10.0 * low {
            let mut axis = Axis::logarithmic(low, high);
            axis.max *= (axis.max / axis.min).powf(room);
            return axis;
        }
        let mut axis = if low >= 0.0 {
            Axis::from_zero(high)
        } else {
            Axis::padded(low, high, 0.08)
        };
        axis.max += 1.2 * room * (axis.max - axis.min);
        axis
    }
}

/// Draws panels under one legend.
///
/// # Errors
/// [`DrawError`] when the backend refuses.
pub fn draw_curves(
    title: &str,
    legend: &[(String, Look, bool)],
    panels: &[CurvePanel],
) -> Result<String, DrawError> {
    let rows = legend_rows(legend);
    let head = 10.0 + LEGEND_ROW * rows.len() as f64;
    let height = head + panels.iter().map(CurvePanel::tall).sum::<f64>();
    draw(WIDTH, height, title, |c| {
        paint_legend(c, legend, &rows);
        let mut y = head;
        for panel in panels {
            paint(c, panel, y);
            y += panel.tall();
        }
    })
}

fn legend_rows(legend: &[(String, Look, bool)]) -> Vec<Vec<usize>> {
    let mut rows: Vec<Vec<usize>> = Vec::new();
    let mut x = f64::INFINITY;
    for (i, (text, _, _)) in legend.iter().enumerate() {
        let width = 62.0 + text_width(text, NAME_SIZE);
        if x + width > WIDTH - RIGHT {
            rows.push(Vec::new());
            x = LEFT;
        }
        x += width;
        if let Some(row) = rows.last_mut() {
            row.push(i);
        }
    }
    rows
}

fn paint_legend(c: &mut Canvas<'_>, legend: &[(String, Look, bool)], rows: &[Vec<usize>]) {
    let mut y = 12.0;
    for row in rows {
        let mut x = LEFT;
        for &i in row {
            let (text, look, filled) = &legend[i];
            c.line(
                &[(x, y), (x + 34.0, y)],
                Stroke::dashed(look.ink, 1.6, look.dash),
            );
            marker(c, (x + 17.0, y), 4.6, *look, *filled);
            let kind = Type::new(NAME_SIZE, Anchor::Start);
            c.text(text, (x + 41.0, y), kind);
            x += 62.0 + text_width(text, NAME_SIZE);
        }
        y += LEGEND_ROW;
    }
}

fn paint(c: &mut Canvas<'_>, panel: &CurvePanel, top: f64) {
    let above = if panel.verticals.is_empty() {
        0.0
    } else {
        14.0
    };
    let y0 = top + above + panel.strip();
    let area = Rect::new(LEFT, y0, WIDTH - RIGHT, y0 + panel.height);
    let frame = Frame {
        area,
        x: panel.x.clone(),
        y: panel.y.clone().unwrap_or_else(|| panel.range()),
    };
    let ticks = if panel.x_ticks.is_empty() {
        let at = frame.x.ticks((area.width() / 85.0) as usize);
        at.iter()
            .map(|&t| (t, tick_label(t, &at, frame.x.log)))
            .collect()
    } else {
        panel.x_ticks.clone()
    };
    let name = panel.x_name.as_deref();
    frame.paint_at(c, &ticks, name.unwrap_or(""), &panel.y_name, name.is_some());
    let small = |anchor| Type::new(TICK_SIZE - 0.5, anchor).ink(Ink::GREY);
    verticals(c, panel, &frame, top + above - 6.0);
    let mut taken: Vec<Rect> = Vec::new();
    for (limit, text) in &panel.limits {
        let (x, y) = frame.at(frame.x.max, *limit);
        if y < area.y0 || y > area.y1 {
            continue;
        }
        let stroke = Stroke::dashed(Ink::DARK, 1.0, &[6.0, 4.0]);
        c.line(&[(area.x0, y), (x, y)], stroke);
        // At the left: curves come down to their limits on the right.
        let width = text_width(text, TICK_SIZE);
        c.text(text, (area.x0 + 6.0, y - 8.0), small(Anchor::Start));
        taken.push(Rect::new(
            area.x0,
            y - 15.0,
            area.x0 + 10.0 + width,
            y + 2.0,
        ));
    }
    for curve in &panel.curves {
        let points: Vec<(f64, f64)> = curve.points.iter().map(|p| frame.at(p.0, p.1)).collect();
        if curve.width > 0.0 {
            let stroke = Stroke::dashed(curve.look.ink, curve.width, curve.look.dash);
            c.line_within(&points, &area, stroke);
        }
        if curve.radius > 0.0 {
            let inside = Rect::new(area.x0 - 1.0, area.y0 - 1.0, area.x1 + 1.0, area.y1 + 1.0);
            for &p in points
                .iter()
                .filter(|p| inside.contains(&Rect::new(p.0, p.1, p.0, p.1)))
            {
                marker(c, p, curve.radius, curve.look, curve.filled);
                let r = curve.radius + 1.0;
                taken.push(Rect::new(p.0 - r, p.1 - r, p.0 + r, p.1 + r));
            }
        }
    }
    for mark in &panel.marks {
        name_point(
            c,
            &mark.text,
            frame.at(mark.at.0, mark.at.1),
            &area,
            &mut taken,
        );
    }
    if panel.strip() > 0.0 {
        failures(c, panel, &frame);
    }
    if !panel.remark.is_empty() {
        let at = (area.x0 + 10.0, area.y0 + 13.0);
        let width = text_width(&panel.remark, TICK_SIZE);
        let back = Rect::new(at.0 - 4.0, at.1 - 9.0, at.0 + width + 4.0, at.1 + 9.0);
        c.fill(&back, Ink::WHITE.opacity(0.85));
        let kind = Type::new(TICK_SIZE, Anchor::Start).ink(Ink::GREY);
        c.text(&panel.remark, at, kind);
    }
}

/// Vertical lines; names that would overlap the one before are left out.
fn verticals(c: &mut Canvas<'_>, panel: &CurvePanel, frame: &Frame, y: f64) {
    let area = frame.area;
    let mut free = f64::NEG_INFINITY;
    for (at, text) in &panel.verticals {
        let (x, _) = frame.at(*at, frame.y.min);
        if !(area.x0..=area.x1).contains(&x) {
            continue;
        }
        let stroke = Stroke::dashed(Ink::PALE, 1.2, &[4.0, 3.0]);
        c.line(&[(x, area.y0), (x, area.y1)], stroke);
        let half = 0.5 * text_width(text, TICK_SIZE - 0.5);
        let centre = x.clamp(area.x0 + half, (area.x1 - half).max(area.x0 + half));
        if centre - half > free {
            let kind = Type::new(TICK_SIZE - 0.5, Anchor::Middle).ink(Ink::GREY);
            c.text(text, (centre, y), kind);
            free = centre + half + 6.0;
        }
    }
}

/// The strip above a panel with a cross for every failed run.
fn failures(c: &mut Canvas<'_>, panel: &CurvePanel, frame: &Frame) {
    let area = frame.area;
    let strip = Rect::new(area.x0, area.y0 - STRIP, area.x1, area.y0 - 4.0);
    c.fill(&strip, Ink(0xf7, 0xf3, 0xf2, 1.0));
    c.frame(&strip, Stroke::new(Ink::PALE, 1.0));
    let middle = 0.5 * (strip.y0 + strip.y1);
    let kind = Type::new(TICK_SIZE, Anchor::End).ink(Ink::FAIL);
    c.text("failed", (area.x0 - 7.0, middle), kind);
    for curve in &panel.curves {
        for &x in &curve.failed {
            let (x, _) = frame.at(x, frame.y.min);
            cross(c, (x, middle), 4.2, curve.look.ink);
        }
    }
}

/// Names a point where there is room, with a leader when it stands off.
fn name_point(
    c: &mut Canvas<'_>,
    text: &str,
    (x, y): (f64, f64),
    area: &Rect,
    taken: &mut Vec<Rect>,
) {
    let size = TICK_SIZE;
    let width = text_width(text, size) + 2.0;
    let boxed = |left: f64, middle: f64| Rect::new(left, middle - 7.5, left + width, middle + 7.5);
    let mut places = vec![boxed(x + 10.0, y), boxed(x - 10.0 - width, y)];
    for level in 1..=6 {
        let d = 4.0 + 14.0 * f64::from(level);
        for left in [x + 6.0, x - 6.0 - width, x - 0.5 * width] {
            places.extend([boxed(left, y - d), boxed(left, y + d)]);
        }
    }
    let free = (places.into_iter())
        .find(|r| area.contains(r) && !taken.iter().any(|t| t.overlaps(r)))
        .unwrap_or_else(|| boxed(x + 10.0, y));
    let middle = 0.5 * (free.y0 + free.y1);
    if (middle - y).abs() > 9.0 {
        let foot = x.clamp(free.x0 + 3.0, free.x1 - 3.0);
        let toward = if middle < y { free.y1 } else { free.y0 };
        c.line(&[(x, y), (foot, toward)], Stroke::new(Ink::GREY, 0.8));
    }
    c.text(text, (free.x0, middle), Type::new(size, Anchor::Start));
    taken.push(free);
}

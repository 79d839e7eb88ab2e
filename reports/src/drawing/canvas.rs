//! A drawing surface over the SVG backend of plotters.
//!
//! The backend rounds to whole units, so everything is drawn at `SCALE` times the size and reduced by the view box. The
//! backend supports neither dash patterns nor a title, so both are added to its text. Coordinates that are not finite
//! never reach the file.

use super::geometry::{Rect, clip_segment, simplified};
pub use super::ink::Ink;
use maud::html;
use plotters::prelude::{DrawingBackend, FontTransform, RGBColor, SVGBackend, ShapeStyle};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, IntoFont};

/// Units of the SVG backend per unit of the page.
const SCALE: f64 = 10.0;

/// Distance below which points of long lines are left out \[page units\].
const FINE: f64 = 0.12;

/// Alignment of a text relative to its point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Anchor {
    /// The text begins at the point.
    Start,
    /// The text is centred on the point.
    Middle,
    /// The text ends at the point.
    End,
}

/// Size, colour and place of text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Type {
    pub size: f64,
    pub ink: Ink,
    /// Horizontal place; vertically text is centred.
    pub anchor: Anchor,
    pub bold: bool,
    /// True for text that is turned to read upwards.
    pub upwards: bool,
}

impl Type {
    pub fn new(size: f64, anchor: Anchor) -> Self {
        Self {
            size,
            ink: Ink::DARK,
            anchor,
            bold: false,
            upwards: false,
        }
    }
    pub fn ink(self, ink: Ink) -> Self {
        Self { ink, ..self }
    }
    pub fn bold(self) -> Self {
        Self { bold: true, ..self }
    }
    pub fn upwards(self) -> Self {
        Self {
            upwards: true,
            ..self
        }
    }
}

/// A stroke: colour, width, dash pattern (lengths of dash and gap; empty for a full line).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    pub ink: Ink,
    pub width: f64,
    pub dash: &'static [f64],
}

impl Stroke {
    /// Makes a solid line of the given width.
    pub fn new(ink: Ink, width: f64) -> Self {
        Self {
            ink,
            width,
            dash: &[],
        }
    }
    pub fn dashed(ink: Ink, width: f64, dash: &'static [f64]) -> Self {
        Self { ink, width, dash }
    }
}

/// An error of the drawing backend; a text buffer has none.
#[derive(Debug, thiserror::Error)]
#[error("a chart could not be drawn: {0}")]
pub struct DrawError(String);

/// Drawing surface of one chart.
pub struct Canvas<'a> {
    backend: SVGBackend<'a>,
    polylines: usize,
    dashes: Vec<(usize, &'static [f64])>,
    /// Elements under all others.
    ground: String,
    error: Option<String>,
}

/// Draws a chart of the given size and returns the SVG document.
pub fn draw(
    width: f64,
    height: f64,
    title: &str,
    paint: impl FnOnce(&mut Canvas<'_>),
) -> Result<String, DrawError> {
    let mut raw = String::new();
    let size = (unit(width).max(1) as u32, unit(height).max(1) as u32);
    let (dashes, ground, error) = {
        let mut canvas = Canvas {
            backend: SVGBackend::with_string(&mut raw, size),
            polylines: 0,
            dashes: Vec::new(),
            ground: String::new(),
            error: None,
        };
        paint(&mut canvas);
        let present = canvas.backend.present().map_err(|e| e.to_string());
        (canvas.dashes, canvas.ground, canvas.error.or(present.err()))
    };
    if let Some(error) = error {
        return Err(DrawError(error));
    }
    let header = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" width=\"{width:.0}\" \
         height=\"{height:.0}\" role=\"img\" stroke-linejoin=\"round\" font-family=\"Helvetica \
         Neue, Helvetica, Arial, Liberation Sans, sans-serif\">\n{}\n",
        size.0,
        size.1,
        html! { title { (printable(title)) } }.0
    );
    let mut body = raw.split_once('\n').map_or("", |(_, body)| body).to_owned();
    // Attributes of the backend that equal the default or have no effect.
    for idle in [
        " font-family=\"sans-serif\"",
        " opacity=\"1\"",
        " stroke=\"none\" stroke-width=\"10\"",
    ] {
        body = body.replace(idle, "");
    }
    Ok(header + &ground + &with_dashes(&body, &dashes))
}

fn with_dashes(body: &str, dashes: &[(usize, &'static [f64])]) -> String {
    const TAG: &str = "<polyline";
    let mut out = String::with_capacity(body.len() + 64 * dashes.len());
    for (i, part) in body.split(TAG).enumerate() {
        if i > 0 {
            out.push_str(TAG);
            if let Some((_, dash)) = dashes.iter().find(|d| d.0 == i) {
                let lengths: Vec<String> = dash.iter().map(|d| unit(*d).to_string()).collect();
                out.push_str(&format!(" stroke-dasharray=\"{}\"", lengths.join(" ")));
            }
        }
        out.push_str(part);
    }
    out
}

/// Returns the text without control characters and without the quotes of names.
fn printable(text: &str) -> String {
    let kept = text.chars().filter(|c| !c.is_control() && *c != '`');
    kept.collect()
}

fn unit(x: f64) -> i32 {
    (x * SCALE).round().clamp(-1e7, 1e7) as i32
}

impl Canvas<'_> {
    /// Draws a polyline through points on the page.
    pub fn line(&mut self, points: &[(f64, f64)], stroke: Stroke) {
        let points = match points.len() {
            0..16 => whole(points),
            _ => whole(&simplified(&finite(points), FINE)),
        };
        if points.len() < 2 {
            return;
        }
        self.polylines += 1;
        if !stroke.dash.is_empty() {
            self.dashes.push((self.polylines, stroke.dash));
        }
        let style = shape(stroke.ink, stroke.width, false);
        let result = self.backend.draw_path(points, &style);
        self.note(result);
    }

    /// Draws the parts of a polyline inside a rectangle of the page.
    pub fn line_within(&mut self, points: &[(f64, f64)], frame: &Rect, stroke: Stroke) {
        let mut piece: Vec<(f64, f64)> = Vec::new();
        for pair in points.windows(2) {
            match clip_segment(pair[0], pair[1], frame) {
                Some((a, b)) => {
                    if piece.last() != Some(&a) {
                        self.line(&piece, stroke);
                        piece = vec![a];
                    }
                    piece.push(b);
                }
                None => {
                    self.line(&piece, stroke);
                    piece.clear();
                }
            }
        }
        self.line(&piece, stroke);
    }

    pub fn polygon(&mut self, points: &[(f64, f64)], ink: Ink) {
        let points = whole(points);
        if points.len() > 2 {
            let result = self.backend.fill_polygon(points, &shape(ink, 1.0, true));
            self.note(result);
        }
    }

    /// Fills a rectangle with a colour.
    pub fn fill(&mut self, r: &Rect, ink: Ink) {
        self.polygon(
            &[(r.x0, r.y0), (r.x1, r.y0), (r.x1, r.y1), (r.x0, r.y1)],
            ink,
        );
    }

    /// Fills many rectangles of one colour as one element beneath all other drawings, without gaps.
    pub fn cells(&mut self, cells: &[Rect], Ink(r, g, b, _): Ink) {
        let mut path = String::new();
        for cell in cells {
            let [x, y, right, bottom] = [cell.x0, cell.y0, cell.x1, cell.y1].map(unit);
            let (wide, tall) = (right - x, bottom - y);
            path.push_str(&format!("M{x} {y}h{wide}v{tall}h{}z", -wide));
        }
        if !path.is_empty() {
            self.ground.push_str(&format!(
                "<path shape-rendering=\"crispEdges\" fill=\"#{r:02X}{g:02X}{b:02X}\" d=\"{path}\"/>\n"
            ));
        }
    }

    /// Draws the edge of a rectangle.
    pub fn frame(&mut self, r: &Rect, stroke: Stroke) {
        let corners = [
            (r.x0, r.y0),
            (r.x1, r.y0),
            (r.x1, r.y1),
            (r.x0, r.y1),
            (r.x0, r.y0),
        ];
        self.line(&corners, stroke);
    }

    /// Paints the background of the strip of failed runs.
    pub fn edge_of_failures(&mut self, r: &Rect) {
        self.fill(r, Ink::FAILED_GROUND);
        self.frame(r, Stroke::new(Ink::PALE, 1.0));
    }

    /// Draws diagonal hatching in a rectangle.
    pub fn hatch(&mut self, r: &Rect, spacing: f64, stroke: Stroke) {
        let reach = r.height().abs();
        let mut x = r.x0 - reach + spacing * 0.5;
        while x < r.x1 {
            if let Some((a, b)) = clip_segment((x, r.y1), (x + reach, r.y0), r) {
                self.line(&[a, b], stroke);
            }
            x += spacing.max(0.5);
        }
    }

    /// Draws a circle, filled or as a ring.
    pub fn circle(&mut self, at: (f64, f64), radius: f64, ink: Ink, width: Option<f64>) {
        if !(at.0.is_finite() && at.1.is_finite()) {
            return;
        }
        let style = shape(ink, width.unwrap_or(1.0), width.is_none());
        let centre = (unit(at.0), unit(at.1));
        let radius = unit(radius).max(1) as u32;
        let result = self
            .backend
            .draw_circle(centre, radius, &style, width.is_none());
        self.note(result);
    }

    /// Writes a text without control characters and without the quotes of names.
    pub fn text(&mut self, text: &str, at: (f64, f64), kind: Type) {
        let text = printable(text);
        if text.is_empty() || !(at.0.is_finite() && at.1.is_finite()) {
            return;
        }
        let horizontal = match kind.anchor {
            Anchor::Start => HPos::Left,
            Anchor::Middle => HPos::Center,
            Anchor::End => HPos::Right,
        };
        // The backend writes size / 1.24.
        let size = kind.size * SCALE * 1.24;
        let face = if kind.bold { "bold" } else { "normal" };
        let mut font = ("sans-serif", size)
            .into_font()
            .style(plotters::style::FontStyle::from(face));
        if kind.upwards {
            font = font.transform(FontTransform::Rotate270);
        }
        let style = font
            .color(&colour(kind.ink))
            .pos(Pos::new(horizontal, VPos::Center));
        let result = self
            .backend
            .draw_text(&text, &style, (unit(at.0), unit(at.1)));
        self.note(result);
    }

    fn note<E: std::fmt::Display>(&mut self, result: Result<(), E>) {
        if let Err(e) = result {
            self.error.get_or_insert(e.to_string());
        }
    }
}

/// Estimates the width of a text, since the viewer chooses the font.
pub fn text_width(text: &str, size: f64) -> f64 {
    let em: f64 = text
        .chars()
        .map(|c| match c {
            'i' | 'j' | 'l' | 't' | 'f' | 'r' | '.' | ',' | ':' | ' ' | '\'' | '|' | '-' => 0.31,
            'm' | 'w' | 'M' | 'W' | '%' => 0.86,
            'A'..='Z' => 0.68,
            _ => 0.555,
        })
        .sum();
    em * size
}

fn colour(ink: Ink) -> plotters::style::RGBAColor {
    RGBColor(ink.0, ink.1, ink.2).mix(ink.3)
}

fn shape(ink: Ink, width: f64, filled: bool) -> ShapeStyle {
    ShapeStyle {
        color: colour(ink),
        filled,
        stroke_width: unit(width).max(1) as u32,
    }
}

fn finite(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let known = points.iter().filter(|p| p.0.is_finite() && p.1.is_finite());
    known.copied().collect()
}

fn whole(points: &[(f64, f64)]) -> Vec<(i32, i32)> {
    let mut out: Vec<(i32, i32)> = finite(points)
        .iter()
        .map(|p| (unit(p.0), unit(p.1)))
        .collect();
    out.dedup();
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn document_carries_dashes_and_no_bad_numbers() {
        let svg = draw(100.0, 50.0, "a < b", |c| {
            c.line(&[(0.0, 0.0), (1.0, 1.0)], Stroke::new(Ink::DARK, 1.0));
            let dotted = Stroke::dashed(Ink::DARK, 1.0, &[2.0, 1.5]);
            c.line(
                &[
                    (0.0, 0.0),
                    (f64::NAN, 1.0),
                    (2.0, f64::INFINITY),
                    (3.0, 3.0),
                ],
                dotted,
            );
            c.circle((f64::NAN, 1.0), 2.0, Ink::DARK, None);
            c.text("x & <y>\u{0}", (1.0, 1.0), Type::new(10.0, Anchor::Middle));
            c.text("z", (f64::NAN, 1.0), Type::new(10.0, Anchor::Middle));
        })
        .unwrap();
        assert_eq!(svg.matches("stroke-dasharray=\"20 15\"").count(), 1);
        assert!(svg.contains("<title>a &lt; b</title>"));
        assert!(svg.contains("x &amp; &lt;y&gt;"));
        assert!(!svg.contains("NaN") && !svg.contains("inf") && !svg.contains('\u{0}'));
        assert!(svg.trim_end().ends_with("</svg>"));
    }
}

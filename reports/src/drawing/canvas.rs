//! A drawing surface that writes SVG.
//!
//! Coordinates are whole tenths of a unit of the page, so that files are short and equal on every machine; curves, whose
//! values the script of a page reads, have a hundredth of that ([`Canvas::curve`]). Coordinates that are not finite never
//! reach the file. Attributes and texts are escaped here ([`crate::escape::xml`]).

use super::geometry::{Rect, clip_segment, simplified, simplified_upright};
pub use super::ink::Ink;
use crate::escape::xml;
use std::fmt::Write;

/// Units of the file per unit of the page.
const SCALE: f64 = 10.0;
/// Units of curves per unit of the file: a value that is read from a curve has an error of 1e-5 of its range.
const CURVE_SCALE: f64 = 100.0;

/// Distance from which on a point of a curve is kept, along the ordinate \[page units\].
const CURVE_FINE: f64 = 0.004;

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

/// A chart has no drawable size.
#[derive(Debug, thiserror::Error)]
#[error("a chart could not be drawn: {0}")]
pub struct DrawError(String);

/// Largest width and height of a chart \[page units\].
const LARGEST: f64 = 1e5;

/// Drawing surface of one chart.
#[derive(Default)]
pub struct Canvas {
    body: String,
    /// Elements under all others.
    ground: String,
}

/// Draws a chart of the given size and returns the SVG document.
pub fn draw(
    width: f64,
    height: f64,
    title: &str,
    paint: impl FnOnce(&mut Canvas),
) -> Result<String, DrawError> {
    draw_with(width, height, title, &[], paint)
}

/// Draws a chart whose root element has further attributes, for the script of a page.
pub fn draw_with(
    width: f64,
    height: f64,
    title: &str,
    attributes: &[(&str, String)],
    paint: impl FnOnce(&mut Canvas),
) -> Result<String, DrawError> {
    if ![width, height].iter().all(|x| (0.0..=LARGEST).contains(x)) {
        return Err(DrawError(format!("its size is {width} by {height}")));
    }
    let mut canvas = Canvas::default();
    paint(&mut canvas);
    let size = [width, height].map(|x| unit(x).max(1));
    Ok(format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" width=\"{width:.0}\" height=\"{height:.0}\" \
         role=\"img\" stroke-linejoin=\"round\" font-family=\"Helvetica Neue, Helvetica, Arial, Liberation Sans, \
         sans-serif\"{}>\n<title>{}</title>\n{}{}</svg>\n",
        size[0],
        size[1],
        written(attributes),
        xml(&printable(title)),
        canvas.ground,
        canvas.body,
    ))
}

/// Returns attributes as the text of an element.
fn written(attributes: &[(&str, String)]) -> String {
    let all = attributes.iter();
    all.map(|(name, value)| format!(" {name}=\"{}\"", xml(value)))
        .collect()
}

/// Returns the text without control characters and without the quotes of names.
fn printable(text: &str) -> String {
    let kept = text.chars().filter(|c| !c.is_control() && *c != '`');
    kept.collect()
}

fn unit(x: f64) -> i32 {
    (x * SCALE).round().clamp(-1e7, 1e7) as i32
}

impl Canvas {
    fn write(&mut self, element: std::fmt::Arguments<'_>) {
        // Writing to a text has no error.
        let _ = self.body.write_fmt(element);
    }

    /// Draws elements in a group with attributes; a group without elements is left out.
    pub fn group(&mut self, attributes: &[(&str, String)], paint: impl FnOnce(&mut Self)) {
        let outside = std::mem::take(&mut self.body);
        paint(self);
        let inside = std::mem::replace(&mut self.body, outside);
        if !inside.is_empty() {
            self.write(format_args!("<g{}>\n{inside}</g>\n", written(attributes)));
        }
    }

    /// Writes the text that a pointer over the surrounding group shows.
    pub fn title(&mut self, text: &str) {
        self.write(format_args!("<title>{}</title>", xml(&printable(text))));
    }

    /// Draws the parts of a curve inside a rectangle of the page as one path, fine enough that the script of a page
    /// reads its values.
    pub fn curve(&mut self, points: &[(f64, f64)], frame: &Rect, stroke: Stroke) {
        let mut path = String::new();
        let mut piece: Vec<(f64, f64)> = Vec::new();
        for pair in points.windows(2) {
            match clip_segment(pair[0], pair[1], frame) {
                Some((a, b)) => {
                    if piece.last() != Some(&a) {
                        path.push_str(&steps(&piece));
                        piece = vec![a];
                    }
                    piece.push(b);
                }
                None => {
                    path.push_str(&steps(&piece));
                    piece.clear();
                }
            }
        }
        path.push_str(&steps(&piece));
        if path.is_empty() {
            return;
        }
        let wide = |x: f64| (x * SCALE * CURVE_SCALE).round().max(1.0);
        let dash = dashes(stroke.dash, SCALE * CURVE_SCALE);
        self.write(format_args!(
            "<path transform=\"scale({})\" fill=\"none\"{} stroke-width=\"{}\"{dash} d=\"{path}\"/>\n",
            1.0 / CURVE_SCALE,
            painted("stroke", stroke.ink),
            wide(stroke.width),
        ));
    }
    /// Draws a polyline through points on the page.
    pub fn line(&mut self, points: &[(f64, f64)], stroke: Stroke) {
        let points = match points.len() {
            0..16 => whole(points),
            _ => whole(&simplified(&finite(points), FINE)),
        };
        if points.len() < 2 {
            return;
        }
        let dash = dashes(stroke.dash, SCALE);
        self.write(format_args!(
            "<polyline fill=\"none\"{} stroke-width=\"{}\"{dash} points=\"{}\"/>\n",
            painted("stroke", stroke.ink),
            unit(stroke.width).max(1),
            listed(&points),
        ));
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
            let fill = painted("fill", ink);
            self.write(format_args!(
                "<polygon{fill} points=\"{}\"/>\n",
                listed(&points)
            ));
        }
    }

    /// Fills a rectangle with a colour.
    pub fn fill(&mut self, r: &Rect, ink: Ink) {
        self.polygon(
            &[(r.x0, r.y0), (r.x1, r.y0), (r.x1, r.y1), (r.x0, r.y1)],
            ink,
        );
    }

    /// Fills many rectangles of one colour as one element beneath all other drawings, without gaps. A pointer over it
    /// shows the title, if there is one.
    pub fn cells(&mut self, cells: &[Rect], Ink(r, g, b, _): Ink, title: &str) {
        let mut path = String::new();
        for cell in cells {
            let [x, y, right, bottom] = [cell.x0, cell.y0, cell.x1, cell.y1].map(unit);
            let (wide, tall) = (right - x, bottom - y);
            path.push_str(&format!("M{x} {y}h{wide}v{tall}h{}z", -wide));
        }
        if path.is_empty() {
            return;
        }
        let end = match title {
            "" => "/>".to_owned(),
            title => format!("><title>{}</title></path>", xml(&printable(title))),
        };
        self.ground.push_str(&format!(
            "<path shape-rendering=\"crispEdges\" fill=\"#{r:02X}{g:02X}{b:02X}\" d=\"{path}\"{end}\n"
        ));
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
        let paint = match width {
            None => painted("fill", ink),
            Some(width) => format!(
                " fill=\"none\"{} stroke-width=\"{}\"",
                painted("stroke", ink),
                unit(width).max(1)
            ),
        };
        let [x, y, r] = [unit(at.0), unit(at.1), unit(radius).max(1)];
        self.write(format_args!(
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\"{paint}/>\n"
        ));
    }

    /// Writes a text without control characters and without the quotes of names.
    pub fn text(&mut self, text: &str, at: (f64, f64), kind: Type) {
        let text = printable(text);
        if text.is_empty() || !(at.0.is_finite() && at.1.is_finite()) {
            return;
        }
        let anchor = match kind.anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
            Anchor::End => " text-anchor=\"end\"",
        };
        let [x, y] = [unit(at.0), unit(at.1)];
        let bold = if kind.bold {
            " font-weight=\"bold\""
        } else {
            ""
        };
        let turned = match kind.upwards {
            true => format!(" transform=\"rotate(270, {x}, {y})\""),
            false => String::new(),
        };
        self.write(format_args!(
            "<text x=\"{x}\" y=\"{y}\" dy=\"0.5ex\"{anchor} font-size=\"{}\"{bold}{}{turned}>{}</text>\n",
            unit(kind.size),
            painted("fill", kind.ink),
            xml(&text),
        ));
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

/// Returns the attributes of a colour, for the filling or the stroke of an element.
fn painted(part: &str, Ink(r, g, b, alpha): Ink) -> String {
    let opacity = match alpha < 1.0 {
        true => format!(" {part}-opacity=\"{alpha}\""),
        false => String::new(),
    };
    format!(" {part}=\"#{r:02X}{g:02X}{b:02X}\"{opacity}")
}

/// Returns the attribute of a dash pattern; none for a solid line.
fn dashes(dash: &[f64], scale: f64) -> String {
    if dash.is_empty() {
        return String::new();
    }
    let lengths: Vec<String> = (dash.iter())
        .map(|d| (d * scale).round().to_string())
        .collect();
    format!(" stroke-dasharray=\"{}\"", lengths.join(" "))
}

fn listed(points: &[(i32, i32)]) -> String {
    let all: Vec<String> = points.iter().map(|(x, y)| format!("{x},{y}")).collect();
    all.join(" ")
}

/// Returns a piece of a curve as the data of a path: its first point, then differences, in whole units of curves.
fn steps(piece: &[(f64, f64)]) -> String {
    let fine = |x: f64| (x * SCALE * CURVE_SCALE).round().clamp(-1e9, 1e9) as i64;
    let points = simplified_upright(&finite(piece), CURVE_FINE);
    let mut points: Vec<(i64, i64)> = points.iter().map(|p| (fine(p.0), fine(p.1))).collect();
    points.dedup();
    let Some(&(x, y)) = points.first().filter(|_| points.len() > 1) else {
        return String::new();
    };
    let mut path = format!("M{x} {y}l");
    for (i, pair) in points.windows(2).enumerate() {
        let (dx, dy) = (pair[1].0 - pair[0].0, pair[1].1 - pair[0].1);
        // A sign separates numbers as well as a space does.
        let before = if i == 0 || dx < 0 { "" } else { " " };
        let between = if dy < 0 { "" } else { " " };
        let _ = write!(path, "{before}{dx}{between}{dy}");
    }
    path
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

    /// Markup in texts, titles and attributes stays text.
    #[test]
    fn markup_is_text() {
        let evil = "<script>x</script>\"'&]]>";
        let svg = draw_with(10.0, 10.0, evil, &[("data-x", evil.into())], |c| {
            c.group(&[("data-name", evil.into())], |c| {
                c.title(evil);
                c.text(evil, (1.0, 1.0), Type::new(10.0, Anchor::Start));
            });
        })
        .unwrap();
        assert!(!svg.contains("<script") && !svg.contains("]]>"), "{svg}");
        let text = "&lt;script&gt;x&lt;/script&gt;&quot;&#39;&amp;]]&gt;";
        assert_eq!(svg.matches(text).count(), 5, "{svg}");
    }

    /// The points of a curve are read from its path within 1e-5 of a chart, whatever is left out.
    #[test]
    fn a_curve_keeps_its_values() {
        let wave: Vec<(f64, f64)> = (0..3000)
            .map(|i| 0.05 * f64::from(i))
            .map(|x| (x, 50.0 + 45.0 * (0.9 * x).sin()))
            .collect();
        let frame = Rect::new(0.0, 0.0, 150.0, 100.0);
        let svg = draw(150.0, 100.0, "wave", |c| {
            c.curve(&wave, &frame, Stroke::new(Ink::DARK, 1.0));
        })
        .unwrap();
        let path = svg
            .split(" d=\"M")
            .nth(1)
            .unwrap()
            .split('"')
            .next()
            .unwrap();
        let numbers: Vec<f64> = path
            .replace('l', " ")
            .replace('-', " -")
            .split_whitespace()
            .map(|n| n.parse().unwrap())
            .collect();
        let (mut at, mut read) = ((0.0, 0.0), Vec::new());
        for d in numbers.chunks(2) {
            at = (at.0 + d[0], at.1 + d[1]);
            read.push((at.0 / 1000.0, at.1 / 1000.0));
        }
        assert!(read.len() < wave.len());
        for (x, y) in wave {
            let k = read.partition_point(|p| p.0 < x).clamp(1, read.len() - 1);
            let [(x0, y0), (x1, y1)] = [read[k - 1], read[k]];
            let found = y0 + (x - x0) / (x1 - x0) * (y1 - y0);
            assert!((found - y).abs() < 0.005 + 0.001 * 45.0, "{x}: {found} {y}");
        }
    }

    #[test]
    fn a_size_that_is_no_number_is_refused() {
        let error = draw(f64::NAN, 10.0, "", |_| {}).unwrap_err();
        assert!(error.to_string().contains("NaN by 10"), "{error}");
    }
}

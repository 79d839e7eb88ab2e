//! Colours, dashes and markers: one set per model, distinguishable without colour.
//!
//! All charts of all studies have one convention: a model has its colour and marker, and on lines its dash pattern.
//! Filled markers are explicit integrators, open ones implicit; integrators are named, or numbered with a key below
//! ([`super::scatter::Numbers`]). The colours follow M. Okabe and K. Ito, Color Universal Design (2008), in an order of
//! falling distance in lightness, so that neighbours also differ in black and white.

use super::canvas::{Canvas, Ink, Stroke};
use maud::{Markup, html};

/// Colour, dash pattern and marker of one model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveStyle {
    pub ink: Ink,
    /// Dash pattern of its lines.
    pub dash: &'static [f64],
    pub marker: Marker,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marker {
    Circle,
    Square,
    Triangle,
    Diamond,
    /// Triangle with its point down.
    Wedge,
    /// Star of five points.
    Star,
    /// Upright cross with full arms.
    Plus,
    /// Two triangles, point to point.
    Hourglass,
}

/// Colours of models on a light page, each with its counterpart on a dark one.
const INKS: [(Ink, Ink); 8] = [
    (Ink(0xd5, 0x5e, 0x00, 1.0), Ink(0xf0, 0x88, 0x3e, 1.0)),
    (Ink(0x00, 0x72, 0xb2, 1.0), Ink(0x58, 0xa6, 0xe8, 1.0)),
    (Ink(0x00, 0x9e, 0x73, 1.0), Ink(0x2d, 0xc7, 0x96, 1.0)),
    (Ink(0xcc, 0x79, 0xa7, 1.0), Ink(0xe3, 0x9b, 0xc4, 1.0)),
    (Ink(0x56, 0xb4, 0xe9, 1.0), Ink(0x8f, 0xd2, 0xf7, 1.0)),
    (Ink(0xe6, 0x9f, 0x00, 1.0), Ink(0xf2, 0xc0, 0x50, 1.0)),
    (Ink(0x6b, 0x4a, 0x9c, 1.0), Ink(0xa8, 0x8b, 0xdd, 1.0)),
    (Ink(0x5a, 0x3a, 0x22, 1.0), Ink(0xc7, 0x9a, 0x76, 1.0)),
];
const SHAPES: [(Marker, &[f64]); 8] = [
    (Marker::Circle, &[8.0, 3.5]),
    (Marker::Square, &[]),
    (Marker::Triangle, &[9.0, 3.0, 2.0, 3.0]),
    (Marker::Diamond, &[2.5, 2.5]),
    (Marker::Wedge, &[17.0, 4.0]),
    (Marker::Star, &[5.0, 2.5, 2.0, 2.5, 2.0, 2.5]),
    (Marker::Plus, &[5.0, 5.0]),
    (Marker::Hourglass, &[14.0, 3.0, 5.0, 3.0]),
];

/// Returns the look of the model with this place in the order of appearance; the first 64 differ.
pub fn curve_style(style: usize) -> CurveStyle {
    let n = SHAPES.len();
    let (marker, dash) = SHAPES[style % n];
    CurveStyle {
        ink: INKS[(style + style / n) % n].0,
        dash,
        marker,
    }
}

/// Returns the CSS rules that replace the colours of charts on a dark page: charts write colours as attributes, which
/// rules override.
pub fn night() -> String {
    let hex = |Ink(r, g, b, _): Ink| format!("#{r:02X}{g:02X}{b:02X}");
    let pairs = INKS.iter().chain(&Ink::NIGHT);
    pairs
        .map(|(day, night)| {
            let (day, night) = (hex(*day), hex(*night));
            format!("svg [fill=\"{day}\"]{{fill:{night}}}svg [stroke=\"{day}\"]{{stroke:{night}}}")
        })
        .collect()
}

/// Renders the marker of a model for HTML.
pub fn mark(style: usize) -> Markup {
    let look = curve_style(style);
    let Ink(r, g, b, _) = look.ink;
    let corners = match look.marker {
        Marker::Circle => (0..24)
            .map(|k| (std::f64::consts::PI / 12.0 * f64::from(k)).sin_cos())
            .map(|(sin, cos)| (5.0 * sin, 5.0 * cos))
            .collect(),
        _ => outline(look.marker, (0.0, 0.0), 5.0),
    };
    let points: Vec<String> = (corners.iter())
        .map(|(x, y)| format!("{x:.1},{y:.1}"))
        .collect();
    html! {
        svg.mark viewBox="-7 -7 14 14" aria-hidden="true" {
            polygon fill=(format!("#{r:02X}{g:02X}{b:02X}")) points=(points.join(" ")) {}
        }
    }
}

/// Returns the stroke of the reference of a scene, by its place among those of the page: thick, dark, of the first one
/// solid.
pub fn reference_stroke(scene: usize) -> Stroke {
    const DASHES: [&[f64]; 4] = [&[], &[10.0, 4.0], &[4.0, 4.0], &[14.0, 4.0, 4.0, 4.0]];
    let k = scene % DASHES.len();
    Stroke::dashed(Ink::DARK.opacity(0.82 - 0.14 * k as f64), 3.2, DASHES[k])
}

/// Returns the look of measured points.
pub fn reference_look() -> CurveStyle {
    CurveStyle {
        ink: Ink::DARK,
        dash: &[],
        marker: Marker::Circle,
    }
}

/// Returns the stroke of a model.
pub fn model_stroke(style: usize) -> Stroke {
    let look = curve_style(style);
    Stroke::dashed(look.ink, 1.9, look.dash)
}

/// Returns the corners of a marker; empty for a circle.
fn outline(marker: Marker, (x, y): (f64, f64), r: f64) -> Vec<(f64, f64)> {
    let at = |corners: &[(f64, f64)]| {
        let placed = corners.iter().map(|(a, b)| (x + a * r, y + b * r));
        placed.collect::<Vec<_>>()
    };
    match marker {
        Marker::Circle => Vec::new(),
        Marker::Square => at(&[(-0.88, -0.88), (0.88, -0.88), (0.88, 0.88), (-0.88, 0.88)]),
        Marker::Triangle => at(&[(0.0, -1.15), (1.0, 0.8), (-1.0, 0.8)]),
        Marker::Wedge => at(&[(0.0, 1.15), (1.0, -0.8), (-1.0, -0.8)]),
        Marker::Diamond => at(&[(0.0, -1.2), (1.2, 0.0), (0.0, 1.2), (-1.2, 0.0)]),
        Marker::Hourglass => at(&[
            (-0.95, -1.05),
            (0.95, -1.05),
            (0.2, 0.0),
            (0.95, 1.05),
            (-0.95, 1.05),
            (-0.2, 0.0),
        ]),
        Marker::Plus => {
            let (a, b) = (0.42, 1.15);
            at(&[
                (-a, -b),
                (a, -b),
                (a, -a),
                (b, -a),
                (b, a),
                (a, a),
                (a, b),
                (-a, b),
                (-a, a),
                (-b, a),
                (-b, -a),
                (-a, -a),
            ])
        }
        Marker::Star => (0..10)
            .map(|k| {
                let radius = if k % 2 == 0 { 1.35 * r } else { 0.58 * r };
                let (sin, cos) = (std::f64::consts::PI * 0.2 * f64::from(k)).sin_cos();
                (x + radius * sin, y - radius * cos)
            })
            .collect(),
    }
}

/// Draws a marker, filled or open.
pub fn marker(c: &mut Canvas, at: (f64, f64), r: f64, look: CurveStyle, filled: bool) {
    // Half the width of an edge line, which a filled marker does not have.
    let within = if filled && r > 3.0 { 0.5 } else { 0.0 };
    let mut edge = outline(look.marker, at, r + within);
    let ground = if filled { look.ink } else { Ink::WHITE };
    if edge.is_empty() {
        c.circle(at, r, ground, None);
        if !filled {
            c.circle(at, r, look.ink, Some(1.8));
        }
        return;
    }
    c.polygon(&edge, ground);
    if !filled {
        edge.push(edge[0]);
        c.line(&edge, Stroke::new(look.ink, 1.8));
    }
}

/// Draws the cross of a failed run.
pub fn cross(c: &mut Canvas, at: (f64, f64), r: f64, ink: Ink) {
    let (x, y) = at;
    let stroke = Stroke::new(ink, 2.0);
    c.line(&[(x - r, y - r), (x + r, y + r)], stroke);
    c.line(&[(x - r, y + r), (x + r, y - r)], stroke);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Any two models of a chart differ in marker and in dash, whatever their colours; with more models than markers no
    /// two share both.
    #[test]
    fn models_differ_in_shape() {
        for a in 0..8 {
            for b in 0..a {
                let (a, b) = (curve_style(a), curve_style(b));
                assert!(a.marker != b.marker && a.dash != b.dash && a.ink != b.ink);
            }
        }
        let all: Vec<CurveStyle> = (0..64).map(curve_style).collect();
        for (i, a) in all.iter().enumerate() {
            assert!(all[i + 1..].iter().all(|b| a != b), "{i}");
        }
        for style in 0..8 {
            assert!(mark(style).0.contains("polygon"));
        }
    }

    /// Every colour of a model is light enough on a dark page: relative luminance after WCAG 2, contrast over 4.5.
    #[test]
    fn models_are_seen_at_night() {
        let luminance = |Ink(r, g, b, _): Ink| {
            let linear = |c: u8| {
                let c = f64::from(c) / 255.0;
                if c <= 0.039_28 {
                    c / 12.92
                } else {
                    ((c + 0.055) / 1.055).powf(2.4)
                }
            };
            0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b)
        };
        let page = Ink::NIGHT.iter().find(|p| p.0 == Ink::WHITE).unwrap().1;
        for (_, ink) in INKS {
            let contrast = (luminance(ink) + 0.05) / (luminance(page) + 0.05);
            assert!(contrast > 4.5, "{ink:?} {contrast}");
        }
        assert!(night().contains("[fill=\"#D55E00\"]"));
    }
}

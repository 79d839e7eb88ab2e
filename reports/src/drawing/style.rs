//! Colours, dashes and markers: one set per model, distinguishable without colour.
//!
//! Colours after M. Okabe and K. Ito, Color Universal Design (2008), in an order of falling
//! distance in lightness, so that neighbours also part in black and white.

use super::canvas::{Canvas, Ink, Stroke};

/// Look of one model.
#[derive(Clone, Copy, Debug)]
pub struct Look {
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
    /// Triangle, point down.
    Wedge,
    /// Star of five points.
    Star,
}

const LOOKS: [Look; 8] = [
    Look {
        ink: Ink(0xd5, 0x5e, 0x00, 1.0),
        dash: &[8.0, 3.5],
        marker: Marker::Circle,
    },
    Look {
        ink: Ink(0x00, 0x72, 0xb2, 1.0),
        dash: &[],
        marker: Marker::Square,
    },
    Look {
        ink: Ink(0x00, 0x9e, 0x73, 1.0),
        dash: &[9.0, 3.0, 2.0, 3.0],
        marker: Marker::Triangle,
    },
    Look {
        ink: Ink(0xcc, 0x79, 0xa7, 1.0),
        dash: &[2.5, 2.5],
        marker: Marker::Diamond,
    },
    Look {
        ink: Ink(0x56, 0xb4, 0xe9, 1.0),
        dash: &[14.0, 4.0],
        marker: Marker::Wedge,
    },
    Look {
        ink: Ink(0xe6, 0x9f, 0x00, 1.0),
        dash: &[5.0, 2.5, 2.0, 2.5, 2.0, 2.5],
        marker: Marker::Circle,
    },
    Look {
        ink: Ink(0x6b, 0x4a, 0x9c, 1.0),
        dash: &[4.0, 4.0],
        marker: Marker::Square,
    },
    Look {
        ink: Ink(0x5a, 0x3a, 0x22, 1.0),
        dash: &[10.0, 2.5],
        marker: Marker::Triangle,
    },
];

/// The look of the model with this place in the order of appearance.
pub fn look(style: usize) -> Look {
    LOOKS[style % LOOKS.len()]
}

/// The colour of a model, for HTML.
pub fn swatch(style: usize) -> String {
    let Ink(r, g, b, _) = look(style).ink;
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// The stroke of a reference: thick, dark, full.
pub fn reference_stroke() -> Stroke {
    Stroke::new(Ink::DARK.opacity(0.82), 3.2)
}

/// The stroke of a model.
pub fn model_stroke(style: usize) -> Stroke {
    let look = look(style);
    Stroke::dashed(look.ink, 1.9, look.dash)
}

/// Draws a marker, filled or open.
pub fn marker(c: &mut Canvas<'_>, at: (f64, f64), r: f64, look: Look, filled: bool) {
    let (x, y) = at;
    let corners: Vec<(f64, f64)> = match look.marker {
        Marker::Circle => {
            c.circle(at, r, Ink::WHITE, None);
            c.circle(at, r, look.ink, (!filled).then_some(1.8));
            return;
        }
        Marker::Square => {
            let s = 0.88 * r;
            vec![
                (x - s, y - s),
                (x + s, y - s),
                (x + s, y + s),
                (x - s, y + s),
            ]
        }
        Marker::Triangle => vec![
            (x, y - 1.15 * r),
            (x + r, y + 0.8 * r),
            (x - r, y + 0.8 * r),
        ],
        Marker::Wedge => vec![
            (x, y + 1.15 * r),
            (x + r, y - 0.8 * r),
            (x - r, y - 0.8 * r),
        ],
        Marker::Star => (0..10)
            .map(|k| {
                let radius = if k % 2 == 0 { 1.35 * r } else { 0.58 * r };
                let (sin, cos) = (std::f64::consts::PI * 0.2 * f64::from(k)).sin_cos();
                (x + radius * sin, y - radius * cos)
            })
            .collect(),
        Marker::Diamond => {
            let s = 1.2 * r;
            vec![(x, y - s), (x + s, y), (x, y + s), (x - s, y)]
        }
    };
    c.polygon(&corners, if filled { look.ink } else { Ink::WHITE });
    let mut edge = corners;
    edge.push(edge[0]);
    c.line(&edge, Stroke::new(look.ink, 1.8));
}

/// Draws the cross of a failed run.
pub fn cross(c: &mut Canvas<'_>, at: (f64, f64), r: f64, ink: Ink) {
    let (x, y) = at;
    let stroke = Stroke::new(ink, 2.0);
    c.line(&[(x - r, y - r), (x + r, y + r)], stroke);
    c.line(&[(x - r, y + r), (x + r, y - r)], stroke);
}

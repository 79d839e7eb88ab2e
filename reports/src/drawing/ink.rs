//! Colours of charts on a light page, and their counterparts on a dark one.

/// A colour with opacity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ink(pub u8, pub u8, pub u8, pub f64);

impl Ink {
    /// Nearly black: text, axes, references.
    pub const DARK: Self = Self(0x1b, 0x1f, 0x24, 1.0);
    /// Grey of secondary text.
    pub const GREY: Self = Self(0x57, 0x60, 0x6a, 1.0);
    /// Frames and failed bars.
    pub const PALE: Self = Self(0xa8, 0xb0, 0xb8, 1.0);
    pub const GRID: Self = Self(0xe4, 0xe7, 0xea, 1.0);
    pub const WHITE: Self = Self(0xff, 0xff, 0xff, 1.0);
    pub const FAIL: Self = Self(0x8c, 0x1d, 0x18, 1.0);
    /// Background of failed runs.
    pub const FAILED_GROUND: Self = Self(0xf7, 0xf3, 0xf2, 1.0);
    /// Text on coloured cells, by day and by night.
    pub const ON_CELL: Self = Self(0x14, 0x18, 0x1c, 1.0);
    /// Fill colours of two neighbouring gears, and the colour of their edge.
    pub const BODIES: [Self; 2] = [Self(0xdf, 0xe7, 0xef, 1.0), Self(0xf1, 0xea, 0xdf, 1.0)];
    pub const BODY_EDGE: Self = Self(0x4a, 0x55, 0x60, 1.0);

    /// Pairs of colours on a light page and on a dark page.
    pub const NIGHT: [(Self, Self); 10] = [
        (Self::DARK, Self(0xe6, 0xe9, 0xec, 1.0)),
        (Self::GREY, Self(0xa7, 0xb0, 0xb9, 1.0)),
        (Self::PALE, Self(0x66, 0x70, 0x7a, 1.0)),
        (Self::GRID, Self(0x2b, 0x31, 0x38, 1.0)),
        (Self::WHITE, Self(0x16, 0x1b, 0x21, 1.0)),
        (Self::FAIL, Self(0xf2, 0x8b, 0x82, 1.0)),
        (Self::FAILED_GROUND, Self(0x2a, 0x20, 0x20, 1.0)),
        (Self::BODIES[0], Self(0x26, 0x34, 0x42, 1.0)),
        (Self::BODIES[1], Self(0x3d, 0x35, 0x28, 1.0)),
        (Self::BODY_EDGE, Self(0x9a, 0xa6, 0xb2, 1.0)),
    ];

    /// Returns the same colour at another opacity, from 0 to 1.
    pub fn opacity(self, alpha: f64) -> Self {
        Self(self.0, self.1, self.2, alpha)
    }
}

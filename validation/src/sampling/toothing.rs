//! Gears of the random scenes. They are few, so that one reduction of finite elements serves many scenes.

use gearbench_models::geometry::{Gear, GearParams, GeometryError};

/// Density of steel [kg/m^3].
pub const DENSITY: f64 = 7850.0;
/// Stiffness of a steel tooth pair per face width, 14 N/(mm um) of ISO 6336-1 [N/m per m].
const PER_WIDTH: f64 = 1.4e10;

/// Toothing of a gear and of its mate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Toothing {
    /// Numbers of teeth of the first gear and of its mate.
    pub teeth: [u32; 2],
    /// True if the mate is a rack.
    pub rack: bool,
    /// Normal module [m].
    pub module: f64,
    /// Face width [m].
    pub width: f64,
    /// Profile shift coefficients (a rack has none).
    pub shift: [f64; 2],
    /// Bore radii [m] (a rack has none).
    pub bore: [f64; 2],
}

const fn pair(
    teeth: [u32; 2],
    module: f64,
    width: f64,
    shift: [f64; 2],
    bore: [f64; 2],
) -> Toothing {
    Toothing {
        teeth,
        rack: false,
        module,
        width,
        shift,
        bore,
    }
}

const fn rack(teeth: [u32; 2], module: f64, width: f64, shift: f64, bore: f64) -> Toothing {
    Toothing {
        teeth,
        rack: true,
        module,
        width,
        shift: [shift, 0.0],
        bore: [bore, 0.0],
    }
}

/// Pairs of external gears that scenes are sampled from.
pub const PAIRS: [Toothing; 12] = [
    pair([20, 30], 4.0e-3, 10e-3, [0.0, 0.0], [15e-3, 25e-3]),
    pair([16, 24], 4.5e-3, 14e-3, [0.1817, 0.1715], [15e-3, 15e-3]),
    pair([24, 24], 3.0e-3, 20e-3, [0.0, 0.0], [14e-3, 14e-3]),
    pair([18, 36], 3.0e-3, 15e-3, [0.3, -0.1], [10e-3, 22e-3]),
    pair([30, 30], 2.5e-3, 12e-3, [0.0, 0.0], [18e-3, 18e-3]),
    pair([17, 43], 2.5e-3, 16e-3, [0.4, 0.2], [9e-3, 24e-3]),
    pair([25, 41], 2.0e-3, 10e-3, [0.0, 0.0], [10e-3, 20e-3]),
    pair([30, 30], 10.0e-3, 60e-3, [0.0, 0.0], [60e-3, 60e-3]),
    pair([22, 33], 6.0e-3, 30e-3, [0.2, 0.2], [25e-3, 40e-3]),
    pair([40, 40], 2.0e-3, 8e-3, [0.0, 0.0], [25e-3, 25e-3]),
    pair([14, 28], 5.0e-3, 25e-3, [0.4, 0.1], [10e-3, 30e-3]),
    pair([28, 56], 1.5e-3, 10e-3, [0.0, 0.0], [8e-3, 18e-3]),
];

/// Pinions with racks that scenes are sampled from.
pub const RACKS: [Toothing; 2] = [
    rack([20, 5], 2.0e-3, 10e-3, 0.0, 8e-3),
    rack([16, 7], 2.5e-3, 18e-3, 0.3, 9e-3),
];

impl Toothing {
    fn gear(&self, i: usize) -> Result<Gear, GeometryError> {
        Gear::new(GearParams {
            teeth: self.teeth[i],
            module: self.module,
            profile_shift: self.shift[i],
            face_width: self.width,
            bore_radius: self.bore[i],
            ..GearParams::default()
        })
    }

    /// Deflection along the line of action per hub coordinate: base radii [m]; for a rack `cos(alpha)`.
    pub fn effective_radii(&self) -> Result<[f64; 2], GeometryError> {
        let first = self.gear(0)?;
        let second = if self.rack {
            first.transverse_pressure_angle().cos()
        } else {
            self.gear(1)?.r_base()
        };
        Ok([first.r_base(), second])
    }

    /// Effective radius of curvature of both flanks at the pitch point [m].
    pub fn curvature(&self, effective_radii: [f64; 2]) -> f64 {
        let tangent = GearParams::default().pressure_angle.tan();
        let [a, b] = effective_radii;
        tangent * if self.rack { a } else { a * b / (a + b) }
    }

    /// Inertia of the ring from bore to reference circle [kg m^2], or mass of a rack of mean height [kg]; rounded.
    pub fn inertia(&self, i: usize) -> f64 {
        let z = f64::from(self.teeth[i]);
        if self.rack && i == 1 {
            let height = 1.5 * self.module + 1.25 * self.module;
            return DENSITY * self.width * z * std::f64::consts::PI * self.module * height;
        }
        let r = 0.5 * z * self.module;
        0.5 * std::f64::consts::PI * DENSITY * self.width * (r.powi(4) - self.bore[i].powi(4))
    }

    /// Stiffness of a tooth pair [N/m].
    pub fn stiffness(&self) -> f64 {
        PER_WIDTH * self.width
    }
}

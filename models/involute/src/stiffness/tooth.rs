//! Bending, shear and axial compliance of a tooth from its real outline, fillet included.
//!
//! The tooth is a beam along its centreline, clamped at the root section. A unit force per width along
//! the line of action, inclined by `beta` to the normal of the centreline, acts on the flank at height
//! `d` and half thickness `y`; at height `x` the section has half thickness `t`, so that
//! `I/b = 2 t^3/3` and `A/b = 2 t`. With the load angle `beta = alpha_r - theta_r` (pressure angle and
//! half thickness angle at the radius `r` of the contact point; the pressure angle for a rack)
//!
//! ```text
//! b delta/F = 1/E' int [(d - x) cos(beta) - y sin(beta)]^2 / (I/b) dx
//!           + 1.2 cos(beta)^2 / G int dx / (A/b) + sin(beta)^2 / E' int dx / (A/b)
//! ```
//!
//! | model | E' | integrated up to |
//! |---|---|---|
//! | Weber-Banaschek | `E / (1 - nu^2)` (plane strain) | crossing of line of action and centreline |
//! | Cornell | `E`, or `E / (1 - nu^2)` when wider than five root thicknesses | load height |
//! | energy | `E` (beam) | load height |
//!
//! Teeth of internal gears are the same beams, pointing inwards from their root chord; they grow towards it, so that the load
//! angle is `alpha_r + theta_r`.
//!
//! For nu = 0.3 the first is Weber and Banaschek's `10.92 int (y_P - x)^2/s^3 + 3.1 (1 + 0.294
//! tan(beta)^2) int 1/s` with `s = 2 t`, since the bracket above is `(y_P - x) cos(beta)`. C. Weber,
//! K. Banaschek, Formaenderung und Profilruecknahme (1953); R. W. Cornell, J. Mech. Des. 103 (1981)
//! 447-459; D. C. H. Yang, J. Y. Lin, J. Mech. Trans. Autom. Des. 109 (1987) 189-196.

use crate::geometry::{Gear, Rack};

use super::material::Material;

/// Number of samples of the fillet and of the flank: the integrals are then exact to about 1e-6.
const SAMPLES: usize = 1000;

/// Angle of the fillet tangent to the centreline at Cornell's root section (rad).
const CORNELL_FILLET_ANGLE: f64 = 75.0 * std::f64::consts::PI / 180.0;

/// Model of the deflection of a tooth above its root section.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ToothModel {
    /// Weber and Banaschek: plane strain.
    WeberBanaschek,
    /// Cornell: plane stress or plane strain by face width.
    Cornell,
    /// Potential-energy method: beam with E.
    Energy,
}

impl ToothModel {
    /// Returns the name in scenes and reports.
    pub fn id(self) -> &'static str {
        match self {
            ToothModel::WeberBanaschek => "weber-banaschek",
            ToothModel::Cornell => "cornell",
            ToothModel::Energy => "energy",
        }
    }
}

/// Position and direction of the load on a tooth; heights are counted along the centreline from the root section of
/// the whole profile (chord of the root circle).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ToothLoad {
    /// Angle between force and the normal of the centreline (rad).
    pub beta: f64,
    /// Height of the contact point (m).
    pub height: f64,
    /// Half thickness at the contact point (m).
    pub half_thickness: f64,
}

impl ToothLoad {
    /// Returns the height at which the line of action crosses the centreline (m).
    pub fn crossing(&self) -> f64 {
        self.height - self.half_thickness * self.beta.tan()
    }

    /// Returns the distance from contact point to centreline along the line of action (m).
    pub fn depth(&self) -> f64 {
        self.half_thickness / self.beta.cos()
    }
}

/// Sampled half of a tooth outline with running integrals over its height.
#[derive(Debug, Clone, PartialEq)]
pub struct ToothProfile {
    /// Distance of the root chord from the gear centre (0 for a rack) (m), negative on an internal gear.
    origin: f64,
    /// Height of the root circle on the centreline above the root chord (m): 0 for a rack, below 0 for an internal gear.
    crown: f64,
    x: Vec<f64>,
    t: Vec<f64>,
    /// Running integrals of 1, x, x^2 over I/b, and of 1 over A/b.
    sums: Vec<[f64; 4]>,
    cornell: f64,
}

impl ToothProfile {
    /// Samples the profile of a gear in the transverse section.
    pub fn of_gear(gear: &Gear) -> ToothProfile {
        Self::sampled_gear(gear, SAMPLES)
    }

    fn sampled_gear(gear: &Gear, samples: usize) -> ToothProfile {
        let (root, form, tip) = (gear.r_root(), gear.r_form(), gear.r_tip());
        let n = samples as f64;
        // Quadratic spacing: the thickness falls off with infinite slope at the root circle.
        let fillet = (0..samples).map(|i| root + (form - root) * (i as f64 / n).powi(2));
        let flank = (0..=samples).map(|i| form + (tip - form) * i as f64 / n);
        let points = fillet.chain(flank).map(|r| {
            let theta = gear.half_angle_at(r);
            (r * theta.cos(), r * theta.sin())
        });
        let sign = gear.sign();
        // Heights count towards the tip; the root circle of an internal gear is lowest where the fillet leaves it.
        let points: Vec<_> = points.map(|(x, y)| (sign * x, y)).collect();
        let lowest = (0..points.len()).min_by(|i, j| points[*i].0.total_cmp(&points[*j].0));
        let mut profile = Self::from_points(points.into_iter().skip(lowest.unwrap_or(0)));
        profile.crown = sign * root - profile.origin;
        profile
    }

    /// Samples the profile of a rack in the transverse section.
    pub fn of_rack(rack: &Rack) -> ToothProfile {
        let (root, form, tip) = (-rack.root_depth(), -rack.form_depth(), rack.tip_height());
        let n = SAMPLES as f64;
        let fillet = (0..SAMPLES).map(|i| root + (form - root) * (i as f64 / n).powi(2));
        let flank = (0..=SAMPLES).map(|i| form + (tip - form) * i as f64 / n);
        Self::from_points(fillet.chain(flank).map(|h| (h, rack.half_thickness_at(h))))
    }

    fn from_points(points: impl Iterator<Item = (f64, f64)>) -> ToothProfile {
        let mut profile = ToothProfile {
            origin: 0.0,
            crown: 0.0,
            x: Vec::new(),
            t: Vec::new(),
            sums: Vec::new(),
            cornell: 0.0,
        };
        let steep = CORNELL_FILLET_ANGLE.tan();
        for (height, t) in points {
            let Some(&last) = profile.x.last() else {
                profile.origin = height;
                profile.x.push(0.0);
                profile.t.push(t);
                profile.sums.push([0.0; 4]);
                continue;
            };
            let x = height - profile.origin;
            if x <= last {
                continue;
            }
            let i = profile.x.len() - 1;
            let t_last = profile.t[i];
            let step = cell((last, t_last), (x, t));
            let sum = std::array::from_fn(|j| profile.sums[i][j] + step[j]);
            // The last section (from the root up) where the fillet is still flatter.
            if t_last - t > steep * (x - last) {
                profile.cornell = x;
            }
            profile.x.push(x);
            profile.t.push(t);
            profile.sums.push(sum);
        }
        profile
    }

    /// Returns the load at the distance `height_from_centre` (m) along the centreline from the gear centre.
    fn load(&self, height_from_centre: f64, half_thickness: f64, beta: f64) -> ToothLoad {
        ToothLoad {
            beta,
            height: height_from_centre - self.origin,
            half_thickness,
        }
    }

    /// Returns the load on the involute of `gear` at radius `r` (m).
    pub fn load_on_gear(&self, gear: &Gear, r: f64) -> ToothLoad {
        let theta = gear.half_angle_at(r);
        let alpha = (gear.r_base() / r).min(1.0).acos();
        let sign = gear.sign();
        self.load(
            sign * r * theta.cos(),
            r * theta.sin(),
            alpha - sign * theta,
        )
    }

    /// Returns the load on the straight flank of `rack` at `height` (m) above its reference line.
    pub fn load_on_rack(&self, rack: &Rack, height: f64) -> ToothLoad {
        let t = rack.half_thickness_at(height);
        self.load(height, t, rack.transverse_pressure_angle())
    }

    /// Returns the height of the root chord above the gear centre (or the rack's reference line) (m).
    pub fn origin(&self) -> f64 {
        self.origin
    }

    /// Returns the height of Cornell's root section above the root chord (m): where the fillet tangent makes 75
    /// degrees with the centreline; the root chord itself where the fillet never becomes so flat.
    pub fn cornell_section(&self) -> f64 {
        self.cornell
    }

    /// Returns the height above the root circle (above the root line of a rack) at which the line of action crosses
    /// the centreline (m).
    pub(super) fn lever(&self, load: &ToothLoad) -> f64 {
        load.crossing() - self.crown
    }

    fn locate(&self, x: f64) -> usize {
        self.x
            .partition_point(|&xi| xi <= x)
            .clamp(1, self.x.len() - 1)
            - 1
    }

    /// Returns half the thickness (m) at height `x` (m) above the root chord.
    pub fn half_thickness(&self, x: f64) -> f64 {
        let i = self.locate(x);
        let u = ((x - self.x[i]) / (self.x[i + 1] - self.x[i])).clamp(0.0, 1.0);
        self.t[i] + u * (self.t[i + 1] - self.t[i])
    }

    fn sums_to(&self, x: f64) -> [f64; 4] {
        let x = x.clamp(0.0, self.x[self.x.len() - 1]);
        let i = self.locate(x);
        let step = cell((self.x[i], self.t[i]), (x, self.half_thickness(x)));
        std::array::from_fn(|j| self.sums[i][j] + step[j])
    }

    /// Returns the compliance (m/N) of a tooth of `width` (m) above the section at height `from` (m).
    pub fn compliance(
        &self,
        model: ToothModel,
        material: &Material,
        width: f64,
        load: &ToothLoad,
        from: f64,
    ) -> f64 {
        let modulus = match model {
            ToothModel::WeberBanaschek => material.plane_strain(),
            ToothModel::Cornell if is_wide(width, 2.0 * self.half_thickness(from)) => {
                material.plane_strain()
            }
            ToothModel::Cornell | ToothModel::Energy => material.young,
        };
        let to = match model {
            ToothModel::WeberBanaschek => load.crossing(),
            ToothModel::Cornell | ToothModel::Energy => load.height,
        };
        if to <= from {
            return 0.0;
        }
        let (low, high) = (self.sums_to(from), self.sums_to(to));
        let [i0, i1, i2, area]: [f64; 4] = std::array::from_fn(|j| high[j] - low[j]);
        let (sin, cos) = load.beta.sin_cos();
        // Moment of the unit force at height x: arm - cos x.
        let arm = load.height * cos - load.half_thickness * sin;
        let bending = arm * arm * i0 - 2.0 * arm * cos * i1 + cos * cos * i2;
        let shear = 1.2 * cos * cos / material.shear_modulus() * area;
        (bending / modulus + shear + sin * sin / modulus * area) / width
    }
}

/// Returns true for a tooth wider than five root thicknesses, which is in plane strain (Cornell).
pub(super) fn is_wide(width: f64, root_thickness: f64) -> bool {
    width > 5.0 * root_thickness
}

/// Integrates over one cell by Simpson's rule, with linear thickness.
fn cell(a: (f64, f64), b: (f64, f64)) -> [f64; 4] {
    let h = b.0 - a.0;
    let middle = (0.5 * (a.0 + b.0), 0.5 * (a.1 + b.1));
    let at = |(x, t): (f64, f64)| {
        let i = 1.5 / (t * t * t);
        [i, x * i, x * x * i, 0.5 / t]
    };
    let (fa, fm, fb) = (at(a), at(middle), at(b));
    std::array::from_fn(|j| h / 6.0 * (fa[j] + 4.0 * fm[j] + fb[j]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{GearParams, RackParams};

    fn gear(teeth: u32) -> Gear {
        Gear::new(GearParams {
            teeth,
            module: 4e-3,
            tip_radius: 0.3,
            bore_radius: 10e-3,
            ..GearParams::default()
        })
        .unwrap()
    }

    /// A prismatic cantilever loaded perpendicular to its axis has the textbook deflection.
    #[test]
    fn prismatic_cantilever() {
        let (l, t, b) = (30e-3, 4e-3, 12e-3);
        let bar = ToothProfile::from_points((0..=400).map(|i| (0.1 + l * f64::from(i) / 400.0, t)));
        let load = ToothLoad {
            beta: 0.0,
            height: l,
            half_thickness: t,
        };
        let m = Material::STEEL;
        let inertia = b * (2.0 * t).powi(3) / 12.0;
        let area = 2.0 * t * b;
        let bending = l.powi(3) / (3.0 * m.young * inertia);
        let shear = 1.2 * l / (m.shear_modulus() * area);
        let energy = bar.compliance(ToothModel::Energy, &m, b, &load, 0.0);
        assert!((energy / (bending + shear) - 1.0).abs() < 1e-12);
        let strain = bar.compliance(ToothModel::WeberBanaschek, &m, b, &load, 0.0);
        assert!((strain / (0.91 * bending + shear) - 1.0).abs() < 1e-12);
        // b = 1.5 root thicknesses is narrow, ten of them are wide.
        let cornell = |b| b * bar.compliance(ToothModel::Cornell, &m, b, &load, 0.0);
        assert!((cornell(b) / (b * energy) - 1.0).abs() < 1e-12);
        assert!((cornell(80e-3) / (b * strain) - 1.0).abs() < 1e-12);
    }

    /// The plane-strain coefficients agree with the published ones for nu = 0.3: 10.92, 3.1 and 0.294.
    #[test]
    fn weber_banaschek_coefficients() {
        let g = gear(23);
        let p = ToothProfile::of_gear(&g);
        let load = p.load_on_gear(&g, 0.5 * (g.r_reference() + g.r_tip()));
        let y_p = load.crossing();
        let n = 20_000;
        let (mut bending, mut shear) = (0.0, 0.0);
        for i in 0..n {
            let x = y_p * (f64::from(i) + 0.5) / f64::from(n);
            let s = 2.0 * p.half_thickness(x);
            bending += (y_p - x).powi(2) / s.powi(3) * y_p / f64::from(n);
            shear += y_p / f64::from(n) / s;
        }
        let tan2 = load.beta.tan().powi(2);
        let cos2 = load.beta.cos().powi(2);
        let m = Material::STEEL;
        let published =
            cos2 / m.young * (10.92 * bending + 3.12 * (1.0 + 0.2917 * tan2) * shear) / 10e-3;
        let got = p.compliance(ToothModel::WeberBanaschek, &m, 10e-3, &load, 0.0);
        assert!((got / published - 1.0).abs() < 1e-4, "{got} {published}");
    }

    #[test]
    fn sampling_is_converged_and_the_load_follows_the_line_of_action() {
        let g = gear(20);
        let (coarse, fine) = (
            ToothProfile::of_gear(&g),
            ToothProfile::sampled_gear(&g, 8000),
        );
        for i in 0..=10 {
            let r = g.r_form() + (g.r_tip() - g.r_form()) * f64::from(i) / 10.0;
            let (a, b) = (coarse.load_on_gear(&g, r), fine.load_on_gear(&g, r));
            for model in [ToothModel::WeberBanaschek, ToothModel::Energy] {
                let ca = coarse.compliance(model, &Material::STEEL, 1e-2, &a, 0.0);
                let cb = fine.compliance(model, &Material::STEEL, 1e-2, &b, 0.0);
                assert!((ca / cb - 1.0).abs() < 2e-6, "{model:?} {r}: {ca} {cb}");
            }
            // A line tangent to the base circle crosses the centreline at r_b / cos(beta).
            let crossing = g.r_base() / a.beta.cos() - coarse.origin();
            assert!((crossing - a.crossing()).abs() < 1e-12);
        }
        let h = coarse.cornell_section();
        assert!(h > 0.0 && h < 0.3e-3, "{h}");
        let moved = fine.cornell_section();
        assert!((h - moved).abs() < 5e-6, "{h} {moved}");
    }

    #[test]
    fn a_rack_tooth_is_the_limit_of_large_gears() {
        let rack = Rack::new(RackParams {
            teeth: 5,
            module: 4e-3,
            tip_radius: 0.3,
            ..RackParams::default()
        })
        .unwrap();
        let (large, p) = (gear(10_000), ToothProfile::of_rack(&rack));
        let q = ToothProfile::of_gear(&large);
        for h in [-2e-3, 0.0, 3e-3] {
            let a = p.compliance(
                ToothModel::Energy,
                &Material::STEEL,
                1e-2,
                &p.load_on_rack(&rack, h),
                0.0,
            );
            let load = q.load_on_gear(&large, large.r_reference() + h);
            let b = q.compliance(ToothModel::Energy, &Material::STEEL, 1e-2, &load, 0.0);
            assert!((a / b - 1.0).abs() < 5e-3, "{h}: {a} {b}");
        }
    }
}

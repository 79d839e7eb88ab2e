//! Tooth stiffness after ISO 6336-1 (method B), and its variation along the path of contact.
//!
//! ```text
//! q'   = 0.04723 + 0.15551/zn1 + 0.25791/zn2 - 0.00635 x1 - 0.11654 x1/zn1
//!        - 0.00193 x2 - 0.24188 x2/zn2 + 0.00529 x1^2 + 0.00182 x2^2      (mm um/N)
//! c'th = 1/q'      c' = 0.8 c'th CR CB (E / E_steel) cos(beta)
//! CB   = mean over both gears of [1 + 0.5 (1.2 - hfP/mn)] [1 - 0.02 (20 - alpha_n in deg)]
//! CR   = 1 + ln(bs/b) / (5 exp(sR / (5 mn)))
//! c_ga = c' (0.75 eps_alpha + 0.25)      c_gb = 0.85 c_ga     E = 2 E1 E2 / (E1 + E2)
//! ```
//!
//! Index 1 is the pinion, the gear with fewer teeth; a rack has `1/zn2 = 0`. `c'` is the *greatest*
//! stiffness of one tooth pair, `c_ga` the *mean* stiffness of the mesh; the norm gives no curve.
//! [`IsoVariation::IsoMean`] is the parabola over the path of contact, `xi` from -1 to 1,
//!
//! ```text
//! c'(xi) = c' [1 - 0.75 (1 - 1/eps_alpha) xi^2]
//! ```
//!
//! the only one that has its maximum `c'` in the middle and whose sum over all pairs in contact has
//! the mean `c_ga` that the norm states: nothing is fitted.

use super::error::{StiffnessError, StiffnessWarning, positive};

/// One N/(mm um), the unit of the standard, in N/m per metre of face width.
pub const N_PER_MM_UM: f64 = 1e9;

/// Young's modulus for which the formula was derived (Pa).
const YOUNG_STEEL: f64 = 2.06e11;

/// Variation of `c'` along the path of contact.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum IsoVariation {
    /// Parabola with both `c'` (maximum) and `c_gamma_alpha` (mean of the mesh) of the standard.
    #[default]
    IsoMean,
    /// Parabola of Cai and Hayashi (J. Mech. Des. 116, 1994, 558-564): 55 % of the maximum at both
    /// ends, whatever the contact ratio.
    CaiHayashi,
    /// Constant stiffness `c'` along the path.
    Constant,
}

impl IsoVariation {
    /// Returns the fraction of the maximum lost at both ends of the path for a transverse contact ratio.
    pub fn drop_at_ends(self, contact_ratio: f64) -> f64 {
        match self {
            // Below a contact ratio of one (helical gears only) the norm's mean exceeds its
            // maximum; the curve is then constant.
            IsoVariation::IsoMean => (0.75 * (1.0 - 1.0 / contact_ratio)).max(0.0),
            IsoVariation::CaiHayashi => 0.45,
            IsoVariation::Constant => 0.0,
        }
    }
}

/// Data of one gear for the standard.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IsoGear {
    /// Virtual number of teeth `zn = z / (cos^2 beta_b cos beta)`; infinite for a rack.
    pub virtual_teeth: f64,
    /// Profile shift coefficient x.
    pub profile_shift: f64,
    /// Dedendum factor hfP/mn of the basic rack.
    pub dedendum: f64,
}

impl IsoGear {
    /// Returns the virtual number of teeth of an external gear.
    pub fn virtual_teeth_of(teeth: u32, helix_angle: f64, base_helix_angle: f64) -> f64 {
        f64::from(teeth) / (base_helix_angle.cos().powi(2) * helix_angle.cos())
    }
}

/// Input of the formula.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IsoInput {
    /// Both gears, in any order.
    pub gears: [IsoGear; 2],
    /// Normal pressure angle (rad).
    pub pressure_angle: f64,
    /// Helix angle (rad), sign ignored.
    pub helix_angle: f64,
    /// Transverse contact ratio of the pair.
    pub contact_ratio: f64,
    /// Young's moduli (Pa).
    pub young: [f64; 2],
    /// Gear-body factor CR: 1 for solid gears, otherwise [`disc_factor`].
    pub body_factor: f64,
}

/// Stiffness per metre of face width (N/m per m); divide by [`N_PER_MM_UM`] for N/(mm um).
#[derive(Debug, Clone, PartialEq)]
pub struct Iso6336 {
    /// Theoretical stiffness of one tooth pair `c'th`.
    pub c_th: f64,
    /// Greatest stiffness of one tooth pair `c'`.
    pub c_prime: f64,
    /// Mean stiffness of the mesh `c_gamma_alpha`.
    pub c_gamma_alpha: f64,
    /// Basic-rack factor `CB`.
    pub c_b: f64,
    /// Limits of the standard that are exceeded.
    pub warnings: Vec<StiffnessWarning>,
}

impl Iso6336 {
    /// Returns the mean stiffness of the mesh for the load over the width `c_gamma_beta`.
    pub fn c_gamma_beta(&self) -> f64 {
        0.85 * self.c_gamma_alpha
    }
}

/// Evaluates ISO 6336-1 (method B).
///
/// # Errors
/// [`StiffnessError`] for values that are not positive or teeth far outside the formula.
pub fn iso6336(input: &IsoInput) -> Result<Iso6336, StiffnessError> {
    let [mut one, mut two] = input.gears;
    // The norm numbers the pinion 1; between equal tooth numbers the larger shift comes first.
    let swap = two.virtual_teeth < one.virtual_teeth
        || (two.virtual_teeth == one.virtual_teeth && two.profile_shift > one.profile_shift);
    if swap {
        std::mem::swap(&mut one, &mut two);
    }
    positive("virtual number of teeth of the pinion", one.virtual_teeth)?;
    positive("transverse contact ratio", input.contact_ratio)?;
    positive("Young's modulus of gear 1 [Pa]", input.young[0])?;
    positive("Young's modulus of gear 2 [Pa]", input.young[1])?;
    positive("gear-body factor CR", input.body_factor)?;
    let (i1, i2) = (1.0 / one.virtual_teeth, 1.0 / two.virtual_teeth);
    let (x1, x2) = (one.profile_shift, two.profile_shift);
    let q = 0.04723 + 0.15551 * i1 + 0.25791 * i2
        - 0.00635 * x1
        - 0.11654 * x1 * i1
        - 0.00193 * x2
        - 0.24188 * x2 * i2
        + 0.00529 * x1 * x1
        + 0.00182 * x2 * x2;
    if !(q.is_finite() && q > 0.0) {
        return Err(StiffnessError::IsoRange { q });
    }
    let alpha_deg = input.pressure_angle.to_degrees();
    let rack_factor =
        |g: IsoGear| (1.0 + 0.5 * (1.2 - g.dedendum)) * (1.0 - 0.02 * (20.0 - alpha_deg));
    let c_b = 0.5 * (rack_factor(one) + rack_factor(two));
    positive("basic-rack factor CB of ISO 6336-1", c_b)?;
    let [e1, e2] = input.young;
    let young = 2.0 * e1 * e2 / (e1 + e2);
    let c_th = N_PER_MM_UM / q;
    let c_prime =
        0.8 * c_th * input.body_factor * c_b * input.helix_angle.cos() * young / YOUNG_STEEL;
    let mut warnings = Vec::new();
    if x1 < x2 {
        warnings.push(StiffnessWarning::IsoShiftOrder { x: [x1, x2] });
    }
    if !(-0.5..=2.0).contains(&(x1 + x2)) {
        warnings.push(StiffnessWarning::IsoShiftSum { sum: x1 + x2 });
    }
    if input.contact_ratio < 1.2 {
        warnings.push(StiffnessWarning::IsoContactRatio {
            value: input.contact_ratio,
        });
    }
    Ok(Iso6336 {
        c_th,
        c_prime,
        c_gamma_alpha: c_prime * (0.75 * input.contact_ratio + 0.25),
        c_b,
        warnings,
    })
}

/// Returns the gear-body factor CR of a gear with rim and web: `web_ratio = bs/b` (limited to [0.2, 1.2] as the
/// standard requires) and `rim = sR/mn` (at least 1).
pub fn disc_factor(web_ratio: f64, rim: f64) -> f64 {
    1.0 + web_ratio.clamp(0.2, 1.2).ln() / (5.0 * (rim.max(1.0) / 5.0).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spur(z: [f64; 2], x: [f64; 2], contact_ratio: f64) -> IsoInput {
        let gear = |i: usize| IsoGear {
            virtual_teeth: z[i],
            profile_shift: x[i],
            dedendum: 1.25,
        };
        IsoInput {
            gears: [gear(0), gear(1)],
            pressure_angle: 20f64.to_radians(),
            helix_angle: 0.0,
            contact_ratio,
            young: [YOUNG_STEEL; 2],
            body_factor: 1.0,
        }
    }

    /// FZG type C, S30 and the two equal pairs agree with the published formula, evaluated by hand.
    #[test]
    fn known_pairs() {
        let cases = [
            ([16.0, 24.0], [0.1817, 0.1715], 1.46, [15.8, 12.3, 16.6]),
            ([30.0, 30.0], [0.0, 0.0], 1.65, [16.4, 12.8, 19.1]),
            ([50.0, 50.0], [0.0, 0.0], 1.76, [18.0, 14.05, 22.0]),
            ([62.0, 62.0], [0.0, 0.0], 1.79, [18.6, 14.5, 23.0]),
        ];
        for (z, x, eps, expected) in cases {
            let c = iso6336(&spur(z, x, eps)).unwrap();
            assert!(c.warnings.is_empty(), "{z:?}");
            for (got, want) in [c.c_th, c.c_prime, c.c_gamma_alpha]
                .into_iter()
                .zip(expected)
            {
                // Printed to three digits, the contact ratio too.
                let got = got / N_PER_MM_UM;
                assert!((got - want).abs() < 0.1, "{z:?}: {got} against {want}");
            }
            let turned = iso6336(&spur([z[1], z[0]], [x[1], x[0]], eps)).unwrap();
            assert_eq!(turned, c, "the order of the gears must not matter");
        }
    }

    /// The mean over one base pitch of the sum of all pairs is the mean mesh stiffness of the standard.
    #[test]
    fn iso_mean_variation_keeps_the_mean_of_the_norm() {
        for eps in [1.2_f64, 1.5, 1.9, 2.3] {
            let drop = IsoVariation::IsoMean.drop_at_ends(eps);
            // Mean of the pair over its path is 1 - drop/3; eps pairs share a base pitch.
            assert!((eps * (1.0 - drop / 3.0) - (0.75 * eps + 0.25)).abs() < 1e-14);
        }
        assert_eq!(IsoVariation::IsoMean.drop_at_ends(0.8), 0.0);
    }

    #[test]
    fn warnings_and_refusals() {
        let c = iso6336(&spur([20.0, 40.0], [-0.4, -0.3], 1.1)).unwrap();
        assert_eq!(c.warnings.len(), 3, "{:?}", c.warnings);
        assert!(
            c.warnings
                .iter()
                .all(|w| w.to_string().contains("ISO 6336-1"))
        );
        assert!(iso6336(&spur([0.0, 40.0], [0.0; 2], 1.5)).is_err());
        assert!(iso6336(&spur([f64::NAN, 40.0], [0.0; 2], 1.5)).is_err());
        assert!(iso6336(&spur([8.0, 9.0], [3.0, 3.0], f64::NAN)).is_err());
        // A rack is a gear of infinite tooth number.
        let rack = iso6336(&spur([20.0, f64::INFINITY], [0.0; 2], 1.6)).unwrap();
        let large = iso6336(&spur([20.0, 1e7], [0.0; 2], 1.6)).unwrap();
        assert!((rack.c_prime / large.c_prime - 1.0).abs() < 1e-6);
    }

    #[test]
    fn body_and_helix_factors() {
        assert_eq!(disc_factor(1.0, 3.0), 1.0);
        assert!(disc_factor(0.3, 2.0) < 1.0 && disc_factor(0.05, 2.0) == disc_factor(0.2, 2.0));
        let straight = spur([25.0, 31.0], [0.1, 0.0], 1.5);
        let helical = IsoInput {
            helix_angle: 0.3,
            ..straight
        };
        let ratio = iso6336(&helical).unwrap().c_prime / iso6336(&straight).unwrap().c_prime;
        assert!((ratio - 0.3_f64.cos()).abs() < 1e-14);
    }
}

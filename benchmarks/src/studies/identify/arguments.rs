//! Arguments of `identify`.

use crate::cli::arguments::{AnyReference, Output};
use crate::cli::values::positive_load;
use crate::scene_file::calibration::CalibrationKind;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};

const EXAMPLES: &str = "\
Examples:
  gearbench identify spur_impact                    fit and report, with 95 % confidence intervals
  gearbench identify spur_impact --model rigid
  gearbench identify spur_impact --model movable-teeth --fit stiffness_n_per_m2,tooth_stiffness_n_per_m,gap_m \\
      --hold tooth_mass_kg=5e-3                     fit some parameters, fix the known ones
  gearbench identify spur_impact --write            also write the calibration file
  gearbench identify my_scene.toml --write=scene    write the constants to the scene file
  gearbench identify spur_impact --model movable-teeth --fit pinion.tooth_mass_kg,wheel.tooth_mass_kg
                                                    constants of single gears
  gearbench identify spur_impact --to running --load 27 --write
                                                    fit to the impact and to static finite elements together
  gearbench identify my_scene.toml --measured rig.csv
                                                    compare a measured curve, such as transmission_error_um over
                                                    mesh_cycle, with the initial and the identified model

A calibration is valid for the data that it was fitted to: `impact` for single impacts, `static` for gears at rest and
slow running under load, `running` for both. `impact` and `running` need a reference of the scene, `static` and
`running` a model of finite elements (--against). --write stores the constants in the calibration file that models
with `calibration = \"impact\"` read: NAME.calibration.toml in the folder of a scene file, and for a shipped scene
benchmarks/calibrations/NAME.toml (run the command in the repository and build again, since the program embeds this
file). --write=scene stores them in the scene file itself, in the contact, the parameters and `gap_m` of the model,
with a comment on their origin. Comments and layout of the file are preserved. The model then no longer uses a
calibration.

Parameters that can be fitted: stiffness_n_per_m2 and damping_ns_per_m of the contact, path_slope and path_curvature
(the stiffness along the path of contact is then k (1 + a xi + b xi^2), with xi from -1 at the start of contact to 1
at its end), gap_m, clock_s and clock_scale (offset and rate of the clock of a recorder, which are never written), and
the springs, masses and dampers of the gear model, of all gears or of one (pinion.tooth_mass_kg). So can every number of the scene, by its path: damping
of shafts (shafts.*.damping_s, one value for all of them), friction, inertia, play (meshes.1.backlash_m); --write=scene
writes it there. A reference with a contact force is fitted by that force, another by all of its speeds, angles and
torques; its clock, where it is not that of the scene, by clock_s and clock_scale. Parameters that the data do not determine are
reported and are not written, unless --write is used with --force.";

/// Where constants are written to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum WriteTarget {
    /// The calibration file of the scene.
    Calibration,
    /// The scene file; the model then no longer uses a calibration.
    Scene,
}

/// What to fit to, by its name.
fn fitted_to() -> impl TypedValueParser<Value = CalibrationKind> {
    let words = PossibleValuesParser::new(CalibrationKind::ALL.map(CalibrationKind::as_str));
    words.map(|word| CalibrationKind::named(&word).unwrap_or_default())
}

/// A key with a value.
fn assigned(text: &str) -> Result<(String, f64), String> {
    let parts = text.split_once('=');
    match parts.map(|(key, x)| (key.trim(), x.trim().parse::<f64>())) {
        Some((key, Ok(x))) if !key.is_empty() && x.is_finite() => Ok((key.into(), x)),
        _ => Err("expected KEY=VALUE in SI units, for example tooth_mass_kg=5e-3".into()),
    }
}

/// The name of a reference with its weight.
fn weighted(text: &str) -> Result<(String, f64), String> {
    let (name, weight) = text.rsplit_once('=').unwrap_or_default();
    match weight.trim().parse::<f64>() {
        Ok(w) if !name.trim().is_empty() && w > 0.0 && w.is_finite() => Ok((name.trim().into(), w)),
        _ => Err("expected NAME=WEIGHT with a weight above 0, for example slow=2".into()),
    }
}

/// A key with two values.
fn bounded(text: &str) -> Result<(String, [f64; 2]), String> {
    let parts = text.split_once('=').and_then(|(key, ends)| {
        let (low, high) = ends.split_once(':')?;
        let ends = [low.trim().parse().ok()?, high.trim().parse().ok()?];
        Some((key.trim().to_owned(), ends))
    });
    match parts {
        Some((key, [low, high])) if !key.is_empty() && low < high => Ok((key, [low, high])),
        _ => Err("expected KEY=LOW:HIGH in SI units, for example tooth_mass_kg=1e-3:1e-2".into()),
    }
}

/// Arguments of `identify`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Identify {
    /// Name of a shipped scene, or path of a scene file (.toml)
    pub scene: String,
    /// Fit this model only [default: every model with a calibration]
    #[arg(long, value_name = "LABEL")]
    pub model: Option<String>,
    /// Data of the fit: impact, static or running (both together)
    #[arg(long, value_name = "WHAT", default_value = "impact", value_parser = fitted_to())]
    pub to: CalibrationKind,
    /// Keys of the parameters to fit [default: the parameters of the model that the data may determine]
    #[arg(long, value_name = "KEYS", value_delimiter = ',')]
    pub fit: Option<Vec<String>>,
    /// Fix parameters at values, for example tooth_mass_kg=5e-3
    #[arg(long, value_name = "KEY=VALUE", value_delimiter = ',', value_parser = assigned)]
    pub hold: Vec<(String, f64)>,
    /// Start parameters from values [default: typical values for steel]
    #[arg(long, value_name = "KEY=VALUE", value_delimiter = ',', value_parser = assigned)]
    pub start: Vec<(String, f64)>,
    /// Bounds of parameters, for example gap_m=0:1e-5
    #[arg(long, value_name = "KEY=LOW:HIGH", value_delimiter = ',', value_parser = bounded)]
    pub bounds: Vec<(String, [f64; 2])>,
    /// Number of further starting points, at random within a factor of two of the first
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=1000))]
    pub starts: u16,
    /// Method of the runs, for example "generalised-alpha(rho_inf=0.8)@1e-4" for a stiff train [default: dopri5 at 1e-8]
    #[arg(long, value_name = "METHOD@STEP")]
    pub integrator: Option<String>,
    /// Compute profiles of all parameters [default: of parameters over whose interval the problem is not linear]
    #[arg(long)]
    pub profiles: bool,
    /// Model whose static compliance is the data of the fit [default: the first model of finite elements]
    #[arg(long, value_name = "LABEL")]
    pub against: Option<String>,
    /// Load of the static equilibria per common face width [N/mm]
    #[arg(long, value_name = "N/MM", default_value_t = 100.0, value_parser = positive_load)]
    pub load: f64,
    /// Weight of the static data relative to histories; both are normalised by their magnitude
    #[arg(long, value_name = "W", default_value_t = 1.0, value_parser = positive_load)]
    pub static_weight: f64,
    /// Weights of references by name; each reference is normalised by its magnitude [default: 1]
    #[arg(long, value_name = "NAME=W", value_delimiter = ',', value_parser = weighted)]
    pub weight: Vec<(String, f64)>,
    /// Weight of residuals at the largest force relative to the weight at zero force
    #[arg(long, value_name = "W", default_value_t = 1.0, value_parser = positive_load)]
    pub peak_weight: f64,
    /// Write the constants to the calibration file of the scene, or to the scene itself (--write=scene)
    #[arg(long, value_name = "WHERE", num_args = 0..=1, require_equals = true, default_missing_value = "calibration")]
    pub write: Option<WriteTarget>,
    /// Where the record and the report go.
    #[command(flatten)]
    pub output: Output,
    /// Whether a reference of other gears will do.
    #[command(flatten)]
    pub insist: AnyReference,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_with_values() {
        assert_eq!(assigned("gap_m = 2e-6"), Ok(("gap_m".into(), 2e-6)));
        assert_eq!(bounded("gap_m=0:1e-5"), Ok(("gap_m".into(), [0.0, 1e-5])));
        assert!(
            ["gap_m", "=1", "gap_m=x", "gap_m=nan"]
                .iter()
                .all(|t| assigned(t).is_err())
        );
        assert!(
            ["gap_m=1", "gap_m=2:1", "=1:2"]
                .iter()
                .all(|t| bounded(t).is_err())
        );
    }
}

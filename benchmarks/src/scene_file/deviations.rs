//! The key `deviations` of a gear: a tolerance class of ISO 1328-1 with a seed, or measured values.
//!
//! ```toml
//! deviations = { class = 6, seed = 1 }
//! deviations = { runout_m = 20e-6, runout_deg = 30.0, left = { cumulative_pitch_m = [0.0, 3e-6, 1e-6] } }
//! ```

use super::error::SceneError;
use super::reading::Place;
use super::reading::keys::keys;
use super::reading::values::{Degrees, NotNegative};
use gearbench_models::geometry::{Deviations, FlankDeviations, GivenDeviations};
use gearbench_reference::hash::spread;

keys! {
    /// Deviations of single teeth.
    struct DeviationTable {
        /// tolerance class of ISO 1328-1 to draw from, 1 to 11; combined with `seed` alone
        class: Option<u32>,
        /// a whole number, default 0; seed and name of a gear give the same teeth again, other gears have others
        seed: Option<u32>,
        /// run-out F_r in metres, twice the eccentricity, default 0
        runout_m: Option<NotNegative>,
        /// direction from the axis to the middle of the toothing in degrees from tooth 0, default 0
        runout_deg: Option<Degrees>,
        /// { cumulative_pitch_m, profile_slope_m, profile_form_m } of the left (counter-clockwise) flanks
        left: Option<FlankTable>,
        /// the same of the right flanks
        right: Option<FlankTable>,
    }

    /// Measured deviations of the flanks of one side.
    struct FlankTable {
        /// list over the teeth: counter-clockwise displacement of each flank on the reference circle in metres
        cumulative_pitch_m: Option<Vec<f64>>,
        /// list over the teeth: profile slope deviation f_Halpha in metres, positive for more material at the tip
        profile_slope_m: Option<Vec<f64>>,
        /// list over the teeth: profile form deviation f_falpha in metres, as one wave
        profile_form_m: Option<Vec<f64>>,
    }
}

/// Deviations of the teeth of a gear.
pub(super) fn deviations(
    name: &str,
    keys: Option<&DeviationTable>,
    at: &Place<'_>,
) -> Result<Deviations, SceneError> {
    let Some(keys) = keys else {
        return Ok(Deviations::None);
    };
    let measured = [
        ("runout_m", keys.runout_m.is_some()),
        ("runout_deg", keys.runout_deg.is_some()),
        ("left", keys.left.is_some()),
        ("right", keys.right.is_some()),
    ];
    match (keys.class, keys.seed) {
        (Some(class), seed) => match measured.iter().find(|(_, given)| *given) {
            Some(&(key, _)) => at.key(key).refuse(
                format!("`{key}` and `class` are both given"),
                "remove this, or `class`",
                "deviations are either random values of a class or measured values",
            ),
            None => Ok(Deviations::Class {
                class,
                seed: seed_of(name, seed.unwrap_or(0)),
            }),
        },
        (None, Some(_)) => at.key("seed").refuse(
            "`seed` is given without `class`",
            "remove this",
            "add a class: `class = 6`; the seed determines the random deviations of the class",
        ),
        (None, None) => Ok(Deviations::Given(Box::new(GivenDeviations {
            sides: [&keys.left, &keys.right]
                .map(|k| k.as_ref().map_or_else(Default::default, flank)),
            runout: keys.runout_m.map_or(0.0, |x| x.0),
            runout_direction: keys.runout_deg.map_or(0.0, Degrees::radians),
        }))),
    }
}

/// Seed of the random numbers of a gear: gears of one scene with one seed differ, as gears of a batch do.
fn seed_of(name: &str, seed: u32) -> u64 {
    let bytes = name.bytes().map(u64::from);
    bytes.fold(spread(u64::from(seed)), |hash, byte| spread(hash ^ byte))
}

fn flank(keys: &FlankTable) -> FlankDeviations {
    let list = |values: &Option<Vec<f64>>| values.clone().unwrap_or_default();
    FlankDeviations {
        cumulative_pitch: list(&keys.cumulative_pitch_m),
        profile_slope: list(&keys.profile_slope_m),
        profile_form: list(&keys.profile_form_m),
    }
}

#[cfg(test)]
mod tests {
    use super::seed_of;
    use std::collections::BTreeSet;

    #[test]
    fn gears_with_one_seed_are_drawn_apart() {
        let names = ["sun", "p1", "p2", "p3", "ring"];
        let all = names.map(|name| (0..200).map(move |seed| seed_of(name, seed)));
        let all: BTreeSet<u64> = all.into_iter().flatten().collect();
        assert_eq!(all.len(), 5 * 200);
        assert_eq!(seed_of("p1", 7), seed_of("p1", 7));
    }
}

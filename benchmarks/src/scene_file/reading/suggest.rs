//! Suggestions for unknown keys: nearest known word, renamed keys, and keys with another unit.

/// Keys of earlier versions with their present names.
const RENAMED: &[(&str, &str)] = &[("coast", "free_flight")];

/// Suffixes of other units, the suffix of the format, and the factor between them.
const UNITS: &[(&str, &str, f64)] = &[
    ("mm", "m", 1e-3),
    ("um", "m", 1e-6),
    ("cm", "m", 1e-2),
    ("in", "m", 0.0254),
    ("rad", "deg", 180.0 / std::f64::consts::PI),
    ("rpm", "rad_s", std::f64::consts::PI / 30.0),
    ("deg_s", "rad_s", std::f64::consts::PI / 180.0),
    ("mm_s", "m_s", 1e-3),
    ("ms", "s", 1e-3),
    ("us", "s", 1e-6),
    ("ns", "s", 1e-9),
    ("nmm", "nm", 1e-3),
    ("knm", "nm", 1e3),
    ("kn", "n", 1e3),
    ("g", "kg", 1e-3),
    ("gmm2", "kgm2", 1e-9),
    ("kgmm2", "kgm2", 1e-6),
    ("gcm2", "kgm2", 1e-7),
    ("kg_m2", "kgm2", 1.0),
    ("gpa", "pa", 1e9),
    ("mpa", "pa", 1e6),
    ("g_cm3", "kg_m3", 1e3),
    ("kgm3", "kg_m3", 1.0),
    ("n_per_mm", "n_per_m", 1e3),
    ("n_per_um", "n_per_m", 1e6),
    ("n_m", "n_per_m", 1.0),
    ("n_per_mm2", "n_per_m2", 1e6),
    ("n_per_mm_um", "n_per_m2", 1e9),
    ("ns_per_mm", "ns_per_m", 1e3),
    ("nm_per_rad_s", "nms_per_rad", 1.0),
];

/// A quantity under a name that is not a key of the format.
struct Alias {
    /// Alternative names of the quantity.
    names: &'static [&'static str],
    /// Keys that identify the table in which the name has this meaning.
    of: &'static [&'static str],
    /// The suggested text, with `#` in the place of the number.
    write: &'static str,
    /// Factor from the given value to the value of the key.
    factor: f64,
}

const fn alias(
    names: &'static [&'static str],
    of: &'static [&'static str],
    write: &'static str,
    factor: f64,
) -> Alias {
    Alias {
        names,
        of,
        write,
        factor,
    }
}

/// Alternative names of quantities, each with the keys that identify its table.
#[rustfmt::skip]
const ALIASES: &[Alias] = &[
    alias(&["torque_nm", "moment_nm", "load_nm"], &["loads", "speed_rad_s"], "loads = [{ torque_nm = # }]", 1.0),
    alias(&["viscous_nms_per_rad", "drag_nms_per_rad", "brake_nms_per_rad", "damping_nms_per_rad"], &["loads", "speed_rad_s"], "loads = [{ viscous_nms_per_rad = # }]", 1.0),
    alias(&["force_n", "load_n"], &["loads", "speed_m_s"], "loads = [{ force_n = # }]", 1.0),
    alias(&["bore_diameter_m", "hole_diameter_m", "inner_diameter_m"], &["bore_radius_m"], "bore_radius_m = #", 0.5),
    alias(&["hole_radius_m", "inner_radius_m", "bore_m"], &["bore_radius_m"], "bore_radius_m = #", 1.0),
    alias(&["rim_diameter_m", "outer_diameter_m"], &["rim_radius_m"], "rim_radius_m = #", 0.5),
    alias(&["tip_diameter_m", "tip_circle_diameter_m"], &["tip_circle_radius_m"], "tip_circle_radius_m = #", 0.5),
    alias(&["root_diameter_m", "root_circle_diameter_m"], &["root_circle_radius_m"], "root_circle_radius_m = #", 0.5),
    alias(&["start_diameter_m"], &["start_radius_m"], "start_radius_m = #", 0.5),
    alias(&["radius_m", "outer_radius_m"], &["diameter_m"], "diameter_m = #", 2.0),
    alias(&["z", "number_of_teeth", "num_teeth", "tooth_count"], &["teeth"], "teeth = #", 1.0),
    alias(&["m", "m_n", "normal_module_m", "modulus_m"], &["module_m"], "module_m = #", 1.0),
    alias(&["width_m", "b", "tooth_width_m", "facewidth_m"], &["face_width_m"], "face_width_m = #", 1.0),
    alias(&["alpha_deg", "alpha_n_deg", "normal_pressure_angle_deg"], &["pressure_angle_deg"], "pressure_angle_deg = #", 1.0),
    alias(&["beta_deg", "helix_deg", "spiral_angle_deg"], &["helix_angle_deg"], "helix_angle_deg = #", 1.0),
    alias(&["x", "addendum_modification", "profile_shift_coefficient"], &["profile_shift"], "profile_shift = #", 1.0),
    alias(&["crowning_m"], &["lead_crowning_m"], "lead_crowning_m = #", 1.0),
    alias(&["rpm", "n_rpm", "n"], &["speed_rad_s"], "speed_rad_s = #", std::f64::consts::PI / 30.0),
    alias(&["omega_rad_s", "angular_velocity_rad_s", "angular_speed_rad_s", "velocity_rad_s"], &["speed_rad_s"], "speed_rad_s = #", 1.0),
    alias(&["velocity_m_s"], &["speed_m_s"], "speed_m_s = #", 1.0),
    alias(&["center_distance_m", "a", "axis_distance_m"], &["centre_distance_m"], "centre_distance_m = #", 1.0),
    alias(&["end_time_s", "t_end_s", "time_s", "simulated_time_s"], &["duration_s", "models"], "duration_s = #", 1.0),
    alias(&["e_pa", "youngs_modulus_pa", "elastic_modulus_pa"], &["young_pa"], "young_pa = #", 1.0),
    alias(&["nu", "poissons_ratio", "poisson_ratio"], &["poisson"], "poisson = #", 1.0),
    alias(&["rho_kg_m3"], &["density_kg_m3"], "density_kg_m3 = #", 1.0),
];

/// The suggested text for a name that is not a key of the format, with the value converted from another unit.
fn other_name(unknown: &str, value: Option<f64>, known: &[&str]) -> Option<String> {
    let factor = |name: &'static str| match name == unknown {
        true => Some(1.0),
        false => other_unit(unknown, &[name]).map(|(_, factor)| factor),
    };
    let meant = ALIASES
        .iter()
        .filter(|a| a.of.iter().all(|k| known.contains(k)));
    let mut meant = meant.filter_map(|a| Some((a, a.names.iter().find_map(|n| factor(n))?)));
    let (alias, factor) = meant.next()?;
    let number = value.map_or("..".to_owned(), |x| number(x * factor * alias.factor));
    Some(alias.write.replace('#', &number))
}

/// Rounds a number to remove rounding errors of a change of unit.
fn number(x: f64) -> String {
    let short = format!("{x:.12e}").parse::<f64>();
    format!("{}", short.unwrap_or(x))
}

/// Unsupported features: beginnings of the keys that ask for them, and the advice. `docs/limits.md` has the details.
const NOT_DONE: &[(&[&str], &str)] = &[
    (
        &["planet", "carrier", "sun", "annulus"],
        "a body on a shaft with `planets` is a carrier",
    ),
    (&["shaft"], "what turns together stands in `[[shafts]]`"),
    (&["housing", "support"], "housings are not modelled"),
    (&["helix_dev", "lead_dev"], "no deviations of the helix"),
    (
        &[
            "oil",
            "lubric",
            "viscosity",
            "temperature",
            "thermal",
            "wear",
            "roughness",
        ],
        "flanks are dry and cold",
    ),
    (
        &["bevel", "cone", "hypoid", "worm", "crossed"],
        "gears are cylindrical or conical (beveloid)",
    ),
    (
        &["yield", "plastic", "fatigue", "s_n"],
        "materials are linear elastic",
    ),
    (
        &["field", "output", "vtu", "animation"],
        "`gearbench compare --vtu 60` writes the bodies of a run",
    ),
    (
        &["stress", "mode_shape"],
        "no stress, no shapes of elastic bodies",
    ),
];

/// The advice on an unsupported feature, where a key asks for one.
fn not_done(unknown: &str) -> Option<&'static str> {
    let asked = unknown.to_lowercase();
    let asks = |words: &&(&[&str], &str)| words.0.iter().any(|w| asked.starts_with(w));
    NOT_DONE.iter().find(asks).map(|(_, why)| *why)
}

/// Known key that differs from an unknown one in its unit only, with the factor to the known unit.
fn other_unit<'k>(unknown: &str, known: &[&'k str]) -> Option<(&'k str, f64)> {
    for &key in known {
        for (from, to, factor) in UNITS {
            let stem = unknown.strip_suffix(from).and_then(|s| s.strip_suffix('_'));
            let known_stem = key.strip_suffix(to).and_then(|s| s.strip_suffix('_'));
            if stem.is_some() && stem == known_stem {
                return Some((key, *factor));
            }
        }
    }
    None
}

/// Known key for an unknown one without unit: `module_m` for `module`.
fn without_unit<'k>(unknown: &str, known: &[&'k str]) -> Option<&'k str> {
    let mut found = known.iter().filter(|k| {
        k.strip_prefix(unknown).is_some_and(|rest| {
            rest.strip_prefix('_')
                .is_some_and(|unit| UNITS.iter().any(|(_, to, _)| unit == *to) || unit == "deg")
        })
    });
    match (found.next(), found.next()) {
        (Some(key), None) => Some(key),
        _ => None,
    }
}

/// Length of words above which no similar word is searched.
const LONGEST: usize = 64;

/// The known word nearest to an unknown one, if one is similar.
fn nearest<'k>(unknown: &str, known: &[&'k str]) -> Option<&'k str> {
    known
        .iter()
        .filter(|_| unknown.len() <= LONGEST)
        .map(|&k| {
            let typed = strsim::osa_distance(&unknown.to_lowercase(), &k.to_lowercase());
            (typed, k)
        })
        .filter(|(d, k)| *d <= (k.len().max(unknown.len()) / 3).max(1))
        .min_by_key(|(d, _)| *d)
        .map(|(_, k)| k)
}

/// Text "did you mean" with the nearest known word, if one is similar.
pub(crate) fn did_you_mean(unknown: &str, known: &[&str]) -> String {
    nearest(unknown, known).map_or(String::new(), |n| format!("did you mean `{n}`? "))
}

/// Text with the nearest known word, if one is similar, and all known words.
pub(in super::super) fn there_are<K: AsRef<str>>(unknown: &str, known: &[K]) -> String {
    let known: Vec<&str> = known.iter().map(AsRef::as_ref).collect();
    format!(
        "{}there are {}",
        did_you_mean(unknown, &known),
        listed(&known, "and")
    )
}

/// Joins words in a sentence: `a`, `b` or `c`.
pub(in super::super) fn words<K: AsRef<str>>(known: &[K]) -> String {
    listed(known, "or")
}

fn listed<K: AsRef<str>>(known: &[K], joined: &str) -> String {
    let known: Vec<String> = known.iter().map(|k| format!("`{}`", k.as_ref())).collect();
    match known.as_slice() {
        [] => "nothing".into(),
        [one] => one.clone(),
        [most @ .., last] => format!("{} {joined} {last}", most.join(", ")),
    }
}

/// The help for an unknown key: a similar key, or the key with the converted number.
pub(in super::super) fn help_for(
    unknown: &str,
    value: Option<f64>,
    known: &[&str],
    meaning: &dyn Fn(&str) -> &'static str,
) -> String {
    let renamed = RENAMED.iter().find(|(old, _)| *old == unknown);
    // Keys of enumerations have no meaning of their own.
    let explained = |name: &str| match meaning(name) {
        "" => format!("`{name}`"),
        meaning => format!("`{name}`: {meaning}"),
    };
    if let Some((_, name)) = renamed.filter(|(_, new)| known.contains(new)) {
        format!("`{unknown}` is now called {}", explained(name))
    } else if let Some((name, factor)) = other_unit(unknown, known) {
        let written = value.map_or(String::new(), |x| format!(" = {}", number(x * factor)));
        let meaning = match meaning(name) {
            "" => String::new(),
            meaning => format!(": {meaning}"),
        };
        format!("the format takes SI units and degrees; write `{name}{written}`{meaning}")
    } else if let Some(write) = other_name(unknown, value, known) {
        format!("write `{write}`")
    } else if let Some(why) = not_done(unknown) {
        format!("{why}: `gearbench help limits` describes what gearbench does not do")
    } else if let Some(name) = without_unit(unknown, known) {
        format!("keys carry their unit; write {}", explained(name))
    } else if let Some(name) = nearest(unknown, known) {
        format!("did you mean {}?", explained(name))
    } else if known.is_empty() {
        "this table has no keys".to_owned()
    } else {
        format!("known are {}", known.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The page of limits contains everything that refusals refer to.
    #[test]
    fn the_page_of_limits_has_what_is_refused() {
        let page = include_str!("../../../../docs/limits.md").to_lowercase();
        let page = page.split_whitespace().collect::<Vec<_>>().join(" ");
        for (words, why) in NOT_DONE {
            assert!(page.contains(why), "{why}");
            let help = help_for(words[0], None, &["teeth"], &|_| "");
            assert_eq!(
                help,
                format!("{why}: `gearbench help limits` describes what gearbench does not do")
            );
        }
    }

    #[test]
    fn suggestions() {
        let known = [
            "module_m",
            "speed_rad_s",
            "teeth",
            "inertia_kgm2",
            "pressure_angle_deg",
        ];
        assert_eq!(other_unit("module_mm", &known), Some(("module_m", 1e-3)));
        assert_eq!(other_unit("speed_rpm", &known).unwrap().0, "speed_rad_s");
        assert_eq!(
            other_unit("pressure_angle_rad", &known).unwrap().0,
            "pressure_angle_deg"
        );
        assert_eq!(other_unit("teeth", &known), None);
        assert_eq!(without_unit("module", &known), Some("module_m"));
        assert_eq!(without_unit("speed", &known), Some("speed_rad_s"));
        assert_eq!(nearest("tetth", &known), Some("teeth"));
        assert_eq!(nearest("colour", &known), None);
        assert_eq!(nearest("eteth", &known), Some("teeth"));
        assert_eq!(nearest(&"teeth".repeat(20), &known), None);
        assert_eq!(words(&["a", "b", "c"]), "`a`, `b` or `c`");
        let help = help_for("coast", Some(0.1), &["free_flight"], &|_| "a switch");
        assert_eq!(help, "`coast` is now called `free_flight`: a switch");
        assert_eq!(
            help_for("coast", None, &["teeth"], &|_| ""),
            "known are teeth"
        );
    }

    #[test]
    fn other_names_lead_to_the_key_and_the_value() {
        let gear = ["teeth", "module_m", "bore_radius_m", "speed_rad_s", "loads"];
        let help = |unknown: &str, value: f64, known: &[&str]| {
            help_for(unknown, Some(value), known, &|_| "")
        };
        for (unknown, value, write) in [
            ("torque_nm", 20.0, "loads = [{ torque_nm = 20 }]"),
            ("torque_nmm", 2e4, "loads = [{ torque_nm = 20 }]"),
            ("bore_diameter_m", 0.03, "bore_radius_m = 0.015"),
            ("bore_diameter_mm", 30.0, "bore_radius_m = 0.015"),
            ("z", 20.0, "teeth = 20"),
        ] {
            assert_eq!(help(unknown, value, &gear), format!("write `{write}`"));
        }
        // A key of an enumeration has no meaning that could follow a colon.
        assert_eq!(
            help("torque_nmm", 5.0, &["torque_nm", "ramp"]),
            "the format takes SI units and degrees; write `torque_nm = 0.005`"
        );
        let rack = ["teeth", "module_m", "speed_m_s", "loads"];
        assert_eq!(
            help("force_n", 5.0, &rack),
            "write `loads = [{ force_n = 5 }]`"
        );
        assert!(help("torque_nm", 5.0, &rack).starts_with("known are"));
    }

    /// No alternative name of a quantity is a key of the same table.
    #[test]
    fn other_names_are_no_keys() {
        use super::super::keys::tables;
        for table in tables() {
            let keys: Vec<&str> = table.keys.iter().map(|k| k.0).collect();
            for alias in ALIASES
                .iter()
                .filter(|a| a.of.iter().all(|k| keys.contains(k)))
            {
                let same = alias.names.iter().find(|n| keys.contains(n));
                assert!(same.is_none(), "{same:?} of {}", table.name);
            }
        }
        let of =
            |a: &Alias| tables().any(|t| a.of.iter().all(|k| t.keys.iter().any(|x| x.0 == *k)));
        assert!(ALIASES.iter().all(of), "an alias of no table");
    }
}

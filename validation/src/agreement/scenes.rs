//! Random scenes in the style of users: eight kinds in turn, each with its own sizes, loads, speeds and damping.
//!
//! Scene `n` follows from the seed and `n` alone. Gears are small and meshes coarse, so that the refined gears are
//! solved in seconds; the required accuracy varies, so that some models are adequate and others are not.

use crate::sampling::random::{Random, fitting, short};
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// Seed of the scenes; it was committed before any of them was run.
pub const SEED: u64 = 74_120_263_511_907;
/// Number of the sampled scenes.
pub const SCENES: usize = 40;

/// Kind of a sampled scene: mechanism and loading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    PairLoaded,
    PairImpact,
    PairHammering,
    RackLoaded,
    RackImpact,
    Train,
    HelicalOnBearings,
    Planetary,
}

impl Kind {
    const ALL: [Kind; 8] = [
        Kind::PairLoaded,
        Kind::PairImpact,
        Kind::PairHammering,
        Kind::RackLoaded,
        Kind::RackImpact,
        Kind::Train,
        Kind::HelicalOnBearings,
        Kind::Planetary,
    ];

    /// The name of the kind in tables.
    pub fn as_str(self) -> &'static str {
        match self {
            Kind::PairLoaded => "pair under load",
            Kind::PairImpact => "impact of a pair",
            Kind::PairHammering => "pair that hammers",
            Kind::RackLoaded => "rack under load",
            Kind::RackImpact => "impact on a rack",
            Kind::Train => "three gears under load",
            Kind::HelicalOnBearings => "helical pair on bearings",
            Kind::Planetary => "planetary set under load",
        }
    }
}

/// A sampled scene with the metric and the tolerance of its question.
#[derive(Clone, Debug)]
pub struct UserScene {
    pub number: usize,
    pub kind: Kind,
    /// Metric of the question, by its name on the command line.
    pub metric: &'static str,
    pub tolerance: f64,
    pub text: String,
}

/// Module and face width that the gears of a scene share [m].
struct Toothing {
    module: f64,
    width: f64,
}

/// Samples the scene with a number from 1 to [`SCENES`].
pub fn scene(number: usize) -> UserScene {
    let kind = Kind::ALL[(number - 1) % Kind::ALL.len()];
    let r = &mut Random::of(SEED, number, 0);
    let of = Toothing {
        module: r.one(&[0.002, 0.0025, 0.003, 0.004]),
        width: short(r.between(0.008, 0.016)),
    };
    let loaded = !matches!(
        kind,
        Kind::PairImpact | Kind::PairHammering | Kind::RackImpact
    );
    let (metric, tolerance) = match loaded {
        true => r.one(&[
            ("peak", 0.05),
            ("peak", 0.1),
            ("rms", 0.02),
            ("transmission-error-pp", 0.1),
        ]),
        false => r.one(&[
            ("peak", 0.05),
            ("force-aligned", 0.05),
            ("force-aligned", 0.1),
            ("impulse", 0.02),
        ]),
    };
    let body = match kind {
        Kind::PairLoaded | Kind::PairImpact | Kind::PairHammering => pair(r, kind, &of),
        Kind::RackLoaded | Kind::RackImpact => rack(r, kind, &of),
        Kind::Train => train(r, &of),
        Kind::HelicalOnBearings => helical(r, &of),
        Kind::Planetary => planetary(r, &of),
    };
    let key = match metric {
        "peak" => "peak_force_rel",
        "rms" => "rms_force_rel",
        "impulse" => "impulse_rel",
        "force-aligned" => "force_l2_aligned",
        _ => "transmission_error_pp_rel",
    };
    let name = kind.as_str().replace(' ', "_");
    let models = models(r, kind);
    let text = format!(
        "schema = 1\nname = \"{name}_{number}\"\ntolerance = {{ metric = \"{key}\", limit = {tolerance} }}\n{body}{models}"
    );
    UserScene {
        number,
        kind,
        metric,
        tolerance,
        text,
    }
}

fn models(r: &mut Random, kind: Kind) -> String {
    let loaded = !matches!(
        kind,
        Kind::PairImpact | Kind::PairHammering | Kind::RackImpact
    );
    let stiffness = r.one(&["iso6336", "compliance"]);
    let ratio = r.one(&[0.005, 0.02, 0.06]);
    let (rigid, elastic) = match loaded {
        true => (
            format!(", damping = {{ law = \"ratio-at-load\", ratio = {ratio} }}"),
            ", damping = { law = \"ratio-at-load\", ratio = 0.05 }",
        ),
        false => (String::new(), ""),
    };
    let contact = match kind {
        // Half-spaces need hubs that turn about fixed axes.
        Kind::HelicalOnBearings => "penalty_pa_per_m = 1e15",
        _ => "local = \"half-space\"",
    };
    let width = if kind == Kind::HelicalOnBearings {
        3
    } else {
        1
    };
    let method = match kind {
        Kind::HelicalOnBearings | Kind::Planetary => String::new(),
        _ => "integrators = [{ method = \"trigonometric\", step_s = 1e-6 }]\n".into(),
    };
    let damped = if loaded { ", damping_ratio = 0.05" } else { "" };
    format!(
        "
[[models]]
model = \"rigid\"
contact = {{ stiffness = \"{stiffness}\"{rigid} }}

[[models]]
model = \"elastic\"
parameters = {{ modes = 20{damped}, flank_elements = 6, width_elements = {width} }}
contact = {{ {contact}{elastic} }}
{method}
[study]
integrators = [{{ method = \"dopri5\", rtol = 1e-6 }}, {{ method = \"rk4\", step_s = 1e-6 }}]
"
    )
}

/// The table `[gears.NAME]` of a gear.
fn gear(name: &str, teeth: u32, of: &Toothing, bore: f64, further: &str) -> String {
    format!(
        "
[gears.{name}]
teeth = {teeth}
module_m = {}
face_width_m = {}
bore_radius_m = {}
{further}",
        of.module,
        of.width,
        short(bore * 0.5 * f64::from(teeth) * of.module),
    )
}

/// Random torque for a load per face width of 20 to 100 N/mm on a gear [N m].
fn torque(r: &mut Random, teeth: u32, of: &Toothing) -> f64 {
    let force = r.decades(2e4, 1e5) * of.width;
    short(force * 0.5 * f64::from(teeth) * of.module * 20_f64.to_radians().cos())
}

/// Duration of a random number of mesh cycles of a gear [s].
fn cycles(r: &mut Random, teeth: u32, speed: f64) -> f64 {
    short(r.one(&[2.0, 3.0]) * TAU / (f64::from(teeth) * speed))
}

fn pair(r: &mut Random, kind: Kind, of: &Toothing) -> String {
    let (a, b) = (
        18 + r.one(&[0_u32, 2, 5, 8]),
        21 + r.one(&[0_u32, 4, 10, 14]),
    );
    let backlash = short(r.between(40e-6, 90e-6));
    let (head, first, second, start) = match kind {
        Kind::PairLoaded => {
            let speed = short(r.decades(60.0, 250.0));
            let load = torque(r, a, of);
            let ratio = f64::from(b) / f64::from(a);
            (
                cycles(r, a, speed),
                format!("speed_rad_s = {speed}\nloads = [{{ torque_nm = {load} }}]\n"),
                format!(
                    "speed_rad_s = {}\nloads = [{{ torque_nm = {} }}]\n",
                    fitting(-speed / ratio),
                    fitting(load * ratio)
                ),
                "start = { flank = \"left\", loaded = true }".to_owned(),
            )
        }
        _ => {
            let radius = 0.5 * f64::from(a) * of.module * 20_f64.to_radians().cos();
            let approach = r.decades(0.1, 0.8);
            let speed = short(approach / radius);
            let (duration, start) = match kind {
                Kind::PairImpact => (
                    0.35e-3,
                    format!(
                        "start = {{ flank = \"left\", gap_m = {} }}",
                        short(r.between(1e-6, 4e-6))
                    ),
                ),
                _ => (4.0 * backlash / approach + 0.6e-3, String::new()),
            };
            (
                short(duration),
                format!("speed_rad_s = {speed}\n"),
                String::new(),
                start,
            )
        }
    };
    format!(
        "duration_s = {head}\n{}{}\n[[meshes]]\ngears = [\"pinion\", \"wheel\"]\nbacklash_m = {backlash}\n{start}\n",
        gear("pinion", a, of, r.between(0.4, 0.6), &first),
        gear("wheel", b, of, r.between(0.4, 0.6), &second),
    )
}

fn rack(r: &mut Random, kind: Kind, of: &Toothing) -> String {
    let teeth = 18 + r.one(&[0_u32, 1, 3, 6]);
    let radius = 0.5 * f64::from(teeth) * of.module;
    let backlash = short(r.between(30e-6, 70e-6));
    let (head, first, second, start) = match kind {
        Kind::RackLoaded => {
            let speed = short(r.decades(60.0, 200.0));
            let load = torque(r, teeth, of);
            (
                cycles(r, teeth, speed),
                format!("speed_rad_s = {speed}\nloads = [{{ torque_nm = {load} }}]\n"),
                format!(
                    "speed_m_s = {}\nloads = [{{ force_n = {} }}]\n",
                    fitting(speed * radius),
                    fitting(-load / radius)
                ),
                "start = { flank = \"left\", loaded = true }".to_owned(),
            )
        }
        _ => (
            0.3e-3,
            format!("speed_rad_s = {}\n", short(r.decades(5.0, 30.0))),
            String::new(),
            format!(
                "start = {{ flank = \"left\", gap_m = {} }}",
                short(r.between(1e-6, 4e-6))
            ),
        ),
    };
    format!(
        "duration_s = {head}\n{}
[gears.rack]
kind = \"rack\"
teeth = 9
module_m = {}
face_width_m = {}
{second}
[[meshes]]
gears = [\"pinion\", \"rack\"]
backlash_m = {backlash}
{start}
",
        gear("pinion", teeth, of, r.between(0.35, 0.5), &first),
        of.module,
        of.width,
    )
}

fn train(r: &mut Random, of: &Toothing) -> String {
    let teeth = [
        18 + r.one(&[0_u32, 1, 2]),
        22 + r.one(&[0_u32, 3, 5]),
        20 + r.one(&[0_u32, 1, 4]),
    ];
    let speed = short(r.decades(60.0, 200.0));
    let load = torque(r, teeth[0], of);
    let ratio = |i: usize| f64::from(teeth[0]) / f64::from(teeth[i]);
    let mut text = format!("duration_s = {}\n", cycles(r, teeth[0], speed));
    let first = format!("speed_rad_s = {speed}\nloads = [{{ torque_nm = {load} }}]\n");
    let idler = format!("speed_rad_s = {}\n", fitting(-speed * ratio(1)));
    let last = format!(
        "speed_rad_s = {}\nloads = [{{ torque_nm = {} }}]\n",
        fitting(speed * ratio(2)),
        fitting(-load / ratio(2))
    );
    for (name, teeth, further) in [
        ("first", teeth[0], first),
        ("idler", teeth[1], idler),
        ("last", teeth[2], last),
    ] {
        text += &gear(name, teeth, of, r.between(0.4, 0.55), &further);
    }
    let direction = r.one(&[30, 60, 90]);
    let _ = write!(
        text,
        "
[[meshes]]
gears = [\"first\", \"idler\"]
backlash_m = 60e-6
start = {{ flank = \"left\", loaded = true }}

[[meshes]]
gears = [\"idler\", \"last\"]
backlash_m = 60e-6
direction_deg = {direction}
start = {{ flank = \"right\", loaded = true }}
"
    );
    text
}

fn helical(r: &mut Random, of: &Toothing) -> String {
    let (a, b) = (18 + r.one(&[0_u32, 2, 4]), 23 + r.one(&[0_u32, 2, 6]));
    let helix = r.one(&[10.0, 15.0, 20.0]);
    let speed = short(r.decades(80.0, 250.0));
    let load = torque(r, a, of);
    let ratio = f64::from(b) / f64::from(a);
    let stiffness = short(r.decades(1e8, 5e8));
    let bearing = format!(
        "bearing = {{ stiffness = [{stiffness}, {stiffness}, {}, 1e5, 1e5, 0.0], damping = [2e3, 2e3, 1e3, 10.0, 10.0, 0.0] }}\n",
        short(0.5 * stiffness)
    );
    let first = format!(
        "helix_angle_deg = {helix}\n{bearing}speed_rad_s = {speed}\nloads = [{{ torque_nm = {load} }}]\n"
    );
    let second = format!(
        "helix_angle_deg = -{helix}\n{bearing}speed_rad_s = {}\nloads = [{{ torque_nm = {} }}]\n",
        fitting(-speed / ratio),
        fitting(load * ratio)
    );
    format!(
        "duration_s = {}\n{}{}\n[[meshes]]\ngears = [\"pinion\", \"wheel\"]\nbacklash_m = 80e-6\nstart = {{ flank = \"left\", loaded = true }}\n",
        cycles(r, a, speed),
        gear("pinion", a, of, r.between(0.4, 0.5), &first),
        gear("wheel", b, of, r.between(0.4, 0.5), &second),
    )
}

fn planetary(r: &mut Random, of: &Toothing) -> String {
    // Three planets can be assembled where the sum of sun and ring is a multiple of three.
    let (sun, planet, ring) = r.one(&[(20_u32, 28_u32, 76_u32), (18, 24, 66), (24, 27, 78)]);
    let speed = short(r.decades(60.0, 150.0));
    let load = torque(r, sun, of);
    let carrier = f64::from(sun) / f64::from(sun + ring);
    let distance = 0.5 * f64::from(sun + planet) * of.module;
    let mut text = format!("duration_s = {}\n", cycles(r, sun, speed));
    text += &gear(
        "sun",
        sun,
        of,
        0.4,
        &format!(
            "thinning_m = 30e-6\nposition_m = [0.0, 0.0]\nspeed_rad_s = {speed}\nloads = [{{ torque_nm = {load} }}]\n"
        ),
    );
    for i in 1..=3 {
        text += &gear(&format!("p{i}"), planet, of, 0.4, "thinning_m = 30e-6\n");
    }
    let _ = write!(
        text,
        "
[gears.ring]
teeth = {ring}
module_m = {}
face_width_m = {}
internal = true
addendum_factor = 0.85
position_m = [0.0, 0.0]
mount = \"fixed\"

[[shafts]]
name = \"arm\"
carries = [{{ body = \"carrier\", at_m = 0.0, inertia_kgm2 = 2e-3, planets = [\"p1\", \"p2\", \"p3\"], speed_rad_s = {}, loads = [{{ torque_nm = {} }}] }}]
",
        of.module,
        of.width,
        fitting(speed * carrier),
        fitting(-load / carrier)
    );
    for i in 1..=3 {
        let _ = write!(
            text,
            "\n[[meshes]]\ngears = [\"sun\", \"p{i}\"]\ncentre_distance_m = {}\ndirection_deg = {}\n",
            fitting(distance),
            120 * (i - 1)
        );
    }
    // Planets press on the ring with their right flanks; the other meshes close loops.
    text += "\n[[meshes]]\ngears = [\"p1\", \"ring\"]\nstart = { flank = \"right\", gap_m = 0.0, loaded = true }\n";
    for i in 2..=3 {
        let _ = write!(text, "\n[[meshes]]\ngears = [\"p{i}\", \"ring\"]\n");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use gearbench::context::Context;
    use gearbench::scene_file::{Origin, SceneFile};

    /// Every scene can be read, and scenes are independent of each other.
    #[test]
    fn scenes_are_read_and_are_what_they_were() {
        for number in 1..=SCENES {
            let of = scene(number);
            assert_eq!(of.text, scene(number).text);
            let read = SceneFile::unbuilt(
                &Context::default(),
                "scene.toml",
                &of.text,
                Origin::Shipped,
                false,
            );
            assert!(read.is_ok(), "{number}: {:?}\n{}", read.err(), of.text);
        }
    }
}

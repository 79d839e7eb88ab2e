//! Random scenes in the style of users: eight kinds in turn, each with its own sizes, loads, speeds and damping.
//!
//! Scene `n` follows from the seed and `n` alone. Gears are small and meshes coarse, so that the refined gears are
//! solved in seconds; the required accuracy varies, so that some models are adequate and others are not.

use crate::sampling::random::{Random, fitting, short};
use gearbench::scene_file::format::*;
use gearbench_integrators::table::{DOPRI5, RK4, TRIGONOMETRIC};
use gearbench_models::geometry::Side;
use gearbench_reports::Metric;
use std::f64::consts::TAU;

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

    /// True if loads act in scenes of the kind.
    fn is_loaded(self) -> bool {
        !matches!(
            self,
            Kind::PairImpact | Kind::PairHammering | Kind::RackImpact
        )
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

impl Toothing {
    fn radius(&self, teeth: u32) -> f64 {
        0.5 * f64::from(teeth) * self.module
    }

    /// The gear has a bore, given by its share of the radius, and further keys.
    fn gear(&self, teeth: u32, bore: f64, further: GearTable) -> ToothedTable {
        let gear = GearTable {
            teeth,
            module_m: self.module,
            face_width_m: self.width,
            bore_radius_m: short(bore * 0.5 * f64::from(teeth) * self.module),
            ..further
        };
        gear.into()
    }

    /// Each gear has a random bore between two shares of its radius.
    fn gears<const N: usize>(
        &self,
        r: &mut Random,
        [low, high]: [f64; 2],
        all: [(&str, u32, GearTable); N],
    ) -> OrderedTable<ToothedTable> {
        all.map(|(name, teeth, own)| (name, self.gear(teeth, r.between(low, high), own)))
            .into_iter()
            .collect()
    }
}

/// Samples the scene with a number from 1 to [`SCENES`].
///
/// # Errors
/// [`WriteError`] for a number that TOML cannot have.
pub fn scene(number: usize) -> Result<UserScene, WriteError> {
    let kind = Kind::ALL[(number - 1) % Kind::ALL.len()];
    let r = &mut Random::of(SEED, number, 0);
    let of = Toothing {
        module: r.one(&[0.002, 0.0025, 0.003, 0.004]),
        width: short(r.between(0.008, 0.016)),
    };
    let (metric, tolerance) = match kind.is_loaded() {
        true => r.one(&[
            (Metric::PeakForceRel, 0.05),
            (Metric::PeakForceRel, 0.1),
            (Metric::RmsForceRel, 0.02),
            (Metric::TransmissionErrorSpanRel, 0.1),
        ]),
        false => r.one(&[
            (Metric::PeakForceRel, 0.05),
            (Metric::ForceL2Aligned, 0.05),
            (Metric::ForceL2Aligned, 0.1),
            (Metric::ImpulseRel, 0.02),
        ]),
    };
    let gears = match kind {
        Kind::PairLoaded | Kind::PairImpact | Kind::PairHammering => pair(r, kind, &of),
        Kind::RackLoaded | Kind::RackImpact => rack(r, kind, &of),
        Kind::Train => train(r, &of),
        Kind::HelicalOnBearings => helical(r, &of),
        Kind::Planetary => planetary(r, &of),
    };
    let scene = SceneTable {
        name: SceneName(format!("{}_{number}", kind.as_str().replace(' ', "_"))),
        tolerance: Some(ToleranceChoice::Full(ToleranceTable {
            metric: Some(MetricKey(metric)),
            limit: Positive(tolerance),
            ..ToleranceTable::default()
        })),
        models: models(r, kind),
        study: StudyTable {
            integrators: Some(vec![
                IntegratorTable::from(&DOPRI5.at_tolerance(1e-6)),
                IntegratorTable::from(&RK4.at_step(1e-6)),
            ]),
            ..StudyTable::default()
        },
        ..gears
    };
    Ok(UserScene {
        number,
        kind,
        metric: metric.option().unwrap_or(metric.key()),
        tolerance,
        text: scene.to_toml()?,
    })
}

fn models(r: &mut Random, kind: Kind) -> Vec<ModelTable> {
    let stiffness = match r.one(&[true, false]) {
        true => StiffnessTable::Iso6336(IsoTable::default()),
        false => StiffnessTable::Compliance(ComplianceTable::default()),
    };
    let contact = |ratio| ContactTable {
        damping: match kind.is_loaded() {
            true => Damping::RatioAtLoad { ratio },
            false => Damping::None,
        },
        ..ContactTable::default()
    };
    let rigid = ContactTable {
        stiffness: Some(stiffness),
        ..contact(r.one(&[0.005, 0.02, 0.06]))
    };
    let on_bearings = kind == Kind::HelicalOnBearings;
    // The elements of the flanks touch where hubs tilt.
    let elastic = ContactTable {
        penalty_pa_per_m: on_bearings.then_some(1e15),
        local: (!on_bearings).then_some(LocalContact::HalfSpace),
        ..contact(0.05)
    };
    let parameters = [
        ("modes", 20.0),
        ("flank_elements", 6.0),
        ("width_elements", if on_bearings { 3.0 } else { 1.0 }),
    ];
    let damped = kind.is_loaded().then_some(("damping_ratio", 0.05));
    let modal = !on_bearings && kind != Kind::Planetary;
    vec![
        ModelTable {
            model: "rigid".into(),
            contact: rigid.into(),
            ..ModelTable::default()
        },
        ModelTable {
            model: "elastic".into(),
            parameters: parameters.into_iter().chain(damped).collect(),
            contact: elastic.into(),
            integrators: modal.then(|| vec![IntegratorTable::from(&TRIGONOMETRIC.at_step(1e-6))]),
            ..ModelTable::default()
        },
    ]
}

/// The gear starts at a speed [rad/s] and may carry a torque [N m].
fn turning(speed: f64, torque: Option<f64>) -> GearTable {
    GearTable {
        speed_rad_s: Some(speed),
        loads: torque.map(|x| vec![GearLoad::torque_nm(x)]),
        ..GearTable::default()
    }
}

fn mesh(gears: [&str; 2], backlash_m: Option<f64>, start: Option<StartTable>) -> MeshTable {
    MeshTable {
        gears: gears.map(GearName::from),
        backlash_m,
        start,
        ..MeshTable::default()
    }
}

/// The scene has gears and meshes; name, question and models are added to it.
fn arranged(
    duration_s: f64,
    gears: OrderedTable<ToothedTable>,
    meshes: Vec<MeshTable>,
) -> SceneTable {
    SceneTable {
        duration_s: Positive(duration_s),
        gears,
        meshes,
        ..SceneTable::default()
    }
}

/// The mesh starts in the equilibrium of the loads.
fn loaded(flank: Side) -> StartTable {
    StartTable {
        flank: Some(flank),
        loaded: true,
        ..StartTable::default()
    }
}

/// The mesh starts with a random gap at its left flanks.
fn apart(r: &mut Random) -> StartTable {
    StartTable {
        flank: Some(Side::Left),
        gap_m: short(r.between(1e-6, 4e-6)),
        ..StartTable::default()
    }
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

fn pair(r: &mut Random, kind: Kind, of: &Toothing) -> SceneTable {
    let (a, b) = (18 + r.one(&[0, 2, 5, 8]), 21 + r.one(&[0, 4, 10, 14]));
    let backlash = short(r.between(40e-6, 90e-6));
    let (duration, first, second, start) = match kind {
        Kind::PairLoaded => {
            let speed = short(r.decades(60.0, 250.0));
            let load = torque(r, a, of);
            let ratio = f64::from(b) / f64::from(a);
            (
                cycles(r, a, speed),
                turning(speed, Some(load)),
                turning(fitting(-speed / ratio), Some(fitting(load * ratio))),
                Some(loaded(Side::Left)),
            )
        }
        _ => {
            let approach = r.decades(0.1, 0.8);
            let speed = short(approach / (of.radius(a) * 20_f64.to_radians().cos()));
            let (duration, start) = match kind {
                Kind::PairImpact => (0.35e-3, Some(apart(r))),
                _ => (4.0 * backlash / approach + 0.6e-3, None),
            };
            let (first, second) = (turning(speed, None), GearTable::default());
            (short(duration), first, second, start)
        }
    };
    let gears = [("pinion", a, first), ("wheel", b, second)];
    arranged(
        duration,
        of.gears(r, [0.4, 0.6], gears),
        vec![mesh(["pinion", "wheel"], Some(backlash), start)],
    )
}

fn rack(r: &mut Random, kind: Kind, of: &Toothing) -> SceneTable {
    let teeth = 18 + r.one(&[0, 1, 3, 6]);
    let radius = of.radius(teeth);
    let backlash = short(r.between(30e-6, 70e-6));
    let mut rack = RackTable {
        teeth: 9,
        module_m: of.module,
        face_width_m: of.width,
        ..RackTable::default()
    };
    let (duration, pinion, start) = match kind {
        Kind::RackLoaded => {
            let speed = short(r.decades(60.0, 200.0));
            let load = torque(r, teeth, of);
            rack.speed_m_s = Some(fitting(speed * radius));
            rack.loads = Some(vec![RackLoad::force_n(fitting(-load / radius))]);
            let pinion = turning(speed, Some(load));
            (cycles(r, teeth, speed), pinion, loaded(Side::Left))
        }
        _ => {
            let pinion = turning(short(r.decades(5.0, 30.0)), None);
            (0.3e-3, pinion, apart(r))
        }
    };
    let mut gears = of.gears(r, [0.35, 0.5], [("pinion", teeth, pinion)]);
    gears.0.push(("rack".into(), rack.into()));
    let mesh = mesh(["pinion", "rack"], Some(backlash), Some(start));
    arranged(duration, gears, vec![mesh])
}

fn train(r: &mut Random, of: &Toothing) -> SceneTable {
    let a = 18 + r.one(&[0, 1, 2]);
    let (b, c) = (22 + r.one(&[0, 3, 5]), 20 + r.one(&[0, 1, 4]));
    let speed = short(r.decades(60.0, 200.0));
    let load = torque(r, a, of);
    let ratio = |teeth: u32| f64::from(a) / f64::from(teeth);
    let duration = cycles(r, a, speed);
    let last = [speed * ratio(c), -load / ratio(c)].map(fitting);
    let gears = [
        ("first", a, turning(speed, Some(load))),
        ("idler", b, turning(fitting(-speed * ratio(b)), None)),
        ("last", c, turning(last[0], Some(last[1]))),
    ];
    let gears = of.gears(r, [0.4, 0.55], gears);
    let [first, second] = [
        (["first", "idler"], Side::Left),
        (["idler", "last"], Side::Right),
    ]
    .map(|(gears, flank)| mesh(gears, Some(60e-6), Some(loaded(flank))));
    let second = MeshTable {
        direction_deg: Some(Degrees(r.one(&[30.0, 60.0, 90.0]))),
        ..second
    };
    arranged(duration, gears, vec![first, second])
}

fn helical(r: &mut Random, of: &Toothing) -> SceneTable {
    let (a, b) = (18 + r.one(&[0, 2, 4]), 23 + r.one(&[0, 2, 6]));
    let helix = r.one(&[10.0, 15.0, 20.0]);
    let speed = short(r.decades(80.0, 250.0));
    let load = torque(r, a, of);
    let ratio = f64::from(b) / f64::from(a);
    let radial = short(r.decades(1e8, 5e8));
    let on_bearing = |helix: f64, speed: f64, torque: f64| GearTable {
        helix_angle_deg: Some(Degrees(helix)),
        bearing: Some(BearingTable {
            stiffness: Some([radial, radial, short(0.5 * radial), 1e5, 1e5, 0.0]),
            damping: Some([2e3, 2e3, 1e3, 10.0, 10.0, 0.0]),
            ..BearingTable::default()
        }),
        ..turning(speed, Some(torque))
    };
    let second = on_bearing(-helix, fitting(-speed / ratio), fitting(load * ratio));
    let gears = [
        ("pinion", a, on_bearing(helix, speed, load)),
        ("wheel", b, second),
    ];
    let start = Some(loaded(Side::Left));
    arranged(
        cycles(r, a, speed),
        of.gears(r, [0.4, 0.5], gears),
        vec![mesh(["pinion", "wheel"], Some(80e-6), start)],
    )
}

fn planetary(r: &mut Random, of: &Toothing) -> SceneTable {
    const PLANETS: [&str; 3] = ["p1", "p2", "p3"];
    // Three planets can be assembled where the sum of sun and ring is a multiple of three.
    let (sun, planet, ring) = r.one(&[(20, 28, 76), (18, 24, 66), (24, 27, 78)]);
    let speed = short(r.decades(60.0, 150.0));
    let load = torque(r, sun, of);
    let carrier = f64::from(sun) / f64::from(sun + ring);
    let distance = of.radius(sun + planet);
    let thinned = |own: GearTable| GearTable {
        thinning_m: 30e-6,
        ..own
    };
    let centre = Some(Position([0.0; 3]));
    let turned = GearTable {
        position_m: centre,
        ..thinned(turning(speed, Some(load)))
    };
    let held = GearTable {
        internal: true,
        addendum_factor: Some(0.85),
        position_m: centre,
        mount: GearMount::Fixed,
        ..GearTable::default()
    };
    let between = PLANETS.map(|name| (name, of.gear(planet, 0.4, thinned(GearTable::default()))));
    let gears = [("sun", of.gear(sun, 0.4, turned))]
        .into_iter()
        .chain(between);
    let gears = gears.chain([("ring", of.gear(ring, 0.0, held))]).collect();
    let arm = StationTable {
        body: Some("carrier".into()),
        inertia_kgm2: Some(NotNegative(2e-3)),
        planets: Some(PLANETS.map(GearName::from).to_vec()),
        speed_rad_s: Some(fitting(speed * carrier)),
        loads: Some(vec![GearLoad::torque_nm(fitting(-load / carrier))]),
        ..StationTable::default()
    };
    let inner = PLANETS.into_iter().zip([0.0, 120.0, 240.0]);
    let inner = inner.map(|(name, direction)| MeshTable {
        centre_distance_m: Some(Positive(fitting(distance))),
        direction_deg: Some(Degrees(direction)),
        ..mesh(["sun", name], None, None)
    });
    // Planets press on the ring with their right flanks; the other meshes close loops.
    let starts = [Some(loaded(Side::Right)), None, None];
    let outer = PLANETS.into_iter().zip(starts);
    let outer = outer.map(|(name, start)| mesh([name, "ring"], None, start));
    let arm = ShaftTable {
        name: "arm".into(),
        carries: vec![arm],
        ..ShaftTable::default()
    };
    SceneTable {
        shafts: Some(vec![arm]),
        ..arranged(cycles(r, sun, speed), gears, inner.chain(outer).collect())
    }
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
            let of = scene(number).unwrap();
            assert_eq!(of.text, scene(number).unwrap().text);
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

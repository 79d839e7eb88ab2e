//! Scene file of a sampled scene, which can be viewed and run like any other.
//!
//! The finite elements define a scene: mesh, penalty and damping of the models `elastic`, `densest` and `fe` are the
//! same. Rigid gears and movable teeth are added as a user would specify them without further knowledge, with the
//! stiffness of the norm.

use super::distributions::{Kind, Load, Parameters, Second};
use super::random::short;
use super::toothing::DENSITY;
use gearbench::scene_file::format::*;
use gearbench_integrators::table::{DOPRI5, NEWMARK, TRIGONOMETRIC};
use gearbench_models::geometry::Side;

/// Teeth of fitted impacts: contact stiffness and tooth stiffness per face width [N/m per m], tooth mass over
/// `density width module^2` (calibration `impact` of the scene `spur_impact`).
const CONTACT_PER_WIDTH: f64 = 2.68e10;
const TOOTH_PER_WIDTH: f64 = 7.8e10;
const TOOTH_MASS: f64 = 4.2;
/// Numbers of elements of all gears: along a flank, over the width, from root to bore.
const ELEMENTS: [(&str, f64); 3] = [
    ("flank_elements", 8.0),
    ("width_elements", 1.0),
    ("rim_elements", 3.0),
];
/// Setting that leaves gyroscopic terms out: gears rotate at a few per cent of their lowest frequency at most, and
/// modal integration needs uncoupled modes.
const SPIN: (&str, &str) = ("spin_terms", "none");
/// Number of modes and step [s] of the densest elastic model.
const DENSEST: (usize, f64) = (300, 2.5e-7);
/// Step of the elastic model [s].
const STEP: f64 = 1e-6;
/// Number of steps of full finite elements over the duration of an impact.
const FULL_STEPS: f64 = 500.0;
/// Names of the gears.
const NAMES: [&str; 2] = ["first", "second"];

/// Writes the scene with a duration [s]; `path` is the path coordinate of the first tooth pair [m].
///
/// # Errors
/// [`WriteError`] for a number that TOML cannot have.
pub fn scene(p: &Parameters, path: Option<f64>, duration: f64) -> Result<String, WriteError> {
    let head = format!(
        "# A random scene: {} of the set \"{}\" (`gearbench-validation sample {}:{}`).\n",
        p.number, p.set, p.set, p.number
    );
    Ok(head + &tables(p, path, duration).to_toml()?)
}

fn tables(p: &Parameters, path: Option<f64>, duration: f64) -> SceneTable {
    let t = &p.toothing;
    let mate = if t.rack {
        format!("on a rack of {} teeth", t.teeth[1])
    } else {
        format!("and {}", t.teeth[1])
    };
    let kind = match p.kind {
        Kind::Impact => "One impact",
        Kind::Hammer => "Hammering in the backlash",
        Kind::Load => "Running under load",
    };
    let labels = ["rigid", "movable-teeth", "elastic", "densest"];
    SceneTable {
        name: SceneName(format!("{}-{}", p.set, p.number)),
        title: format!(
            "{kind}: {} teeth {mate}, m = {} mm",
            t.teeth[0],
            short(1e3 * t.module)
        ),
        duration_s: Positive(short(duration)),
        tolerance: Some(ToleranceChoice::Full(ToleranceTable {
            metric: Some(MetricKey(p.metric)),
            limit: Positive(p.tolerance),
            against: Some("model".into()),
            ..ToleranceTable::default()
        })),
        gears: [0, 1].map(|i| (NAMES[i], gear(p, i))).into_iter().collect(),
        meshes: vec![MeshTable {
            gears: NAMES.map(GearName::from),
            backlash_m: Some(p.backlash),
            start: Some(StartTable {
                flank: Some(Side::Left),
                gap_m: p.gap,
                path_coordinate_m: path.map(short),
                loaded: false,
            }),
            ..MeshTable::default()
        }],
        models: models(p),
        study: StudyTable {
            models: Some(Distinct(labels.map(Label::from).to_vec())),
            reference_model: Some("densest".into()),
            integrators: Some(vec![IntegratorTable::from(&DOPRI5.at_tolerance(1e-7))]),
            quantities: Some(Distinct(vec![p.metric.into()])),
            ..StudyTable::default()
        },
        ..SceneTable::default()
    }
}

/// A speed that is not zero.
fn moving(speed: f64) -> Option<f64> {
    Some(speed).filter(|v| *v != 0.0)
}

fn gear(p: &Parameters, i: usize) -> ToothedTable {
    if p.toothing.rack && i == 1 {
        return rack(p).into();
    }
    let t = &p.toothing;
    let (mount, speed) = match (i, p.second) {
        (1, Second::Fixed) => (GearMount::Fixed, None),
        (1, Second::Driven) => (GearMount::Driven(Turning::speed_rad_s(p.speed[1])), None),
        _ => (GearMount::Revolute, moving(p.speed[i])),
    };
    let load = match p.load[i] {
        _ if mount != GearMount::Revolute => None,
        Load::None => None,
        Load::Constant(x) => Some(GearLoad::torque_nm(x)),
        Load::Ramp(x, end) => Some(GearLoad::ramp(CheckedProfile(TorqueRamp {
            from_nm: 0.0,
            to_nm: x,
            start_s: 0.0,
            end_s: end,
        }))),
        Load::Viscous(c) => Some(GearLoad::viscous_nms_per_rad(NotNegative(c))),
    };
    let gear = GearTable {
        teeth: t.teeth[i],
        module_m: t.module,
        face_width_m: t.width,
        profile_shift: t.shift[i],
        bore_radius_m: t.bore[i],
        added_inertia_kgm2: Some(p.added[i]).filter(|x| *x > 0.0).map(NotNegative),
        mount,
        speed_rad_s: speed,
        loads: load.map(|load| vec![load]),
        ..GearTable::default()
    };
    gear.into()
}

/// The rack, which has impacts only: its loads are constant.
fn rack(p: &Parameters) -> RackTable {
    let t = &p.toothing;
    let (mount, speed) = match p.second {
        Second::Fixed => (RackMount::Fixed, None),
        Second::Driven => (RackMount::Driven(Sliding::speed_m_s(p.speed[1])), None),
        Second::Free => (RackMount::Prismatic, moving(p.speed[1])),
    };
    let load = match p.load[1] {
        Load::Constant(x) if mount == RackMount::Prismatic => Some(RackLoad::force_n(x)),
        _ => None,
    };
    RackTable {
        teeth: t.teeth[1],
        module_m: t.module,
        face_width_m: t.width,
        added_mass_kg: Some(p.added[1]).filter(|x| *x > 0.0).map(NotNegative),
        mount,
        speed_m_s: speed,
        loads: load.map(|load| vec![load]),
        ..RackTable::default()
    }
}

/// Parameters of the elastic models.
fn elements<'k>(
    more: impl IntoIterator<Item = (&'k str, f64)>,
    modal_ratio: Option<f64>,
) -> OrderedTable<ParameterValue> {
    let numbers = ELEMENTS.into_iter().chain(more);
    let numbers = numbers.map(|(key, x)| (key, ParameterValue::from(x)));
    let word = modal_ratio.map(|_| (SPIN.0, SPIN.1.into()));
    let ratio = modal_ratio.filter(|ratio| *ratio > 0.0);
    let ratio = ratio.map(|ratio| ("damping_ratio", ratio.into()));
    numbers.chain(word).chain(ratio).collect()
}

fn models(p: &Parameters) -> Vec<ModelTable> {
    let t = &p.toothing;
    let damping = match p.rigid_ratio > 0.0 {
        true => Damping::KelvinVoigtRatio {
            ratio: p.rigid_ratio,
        },
        false => Damping::None,
    };
    let pairs = |stiffness: StiffnessTable| {
        OneOrMany::One(ContactTable {
            stiffness: Some(stiffness),
            damping,
            ..ContactTable::default()
        })
    };
    let tooth = TOOTH_PER_WIDTH * t.width;
    let mass = TOOTH_MASS * DENSITY * t.width * t.module * t.module;
    let damper = 2.0 * p.modal_ratio * (tooth * mass).sqrt();
    let teeth = [
        ("tooth_stiffness_n_per_m", tooth),
        ("tooth_mass_kg", mass),
        ("tooth_damping_ns_per_m", damper),
    ];
    let points = OneOrMany::One(ContactTable {
        penalty_pa_per_m: Some(p.penalty),
        damping_ns_per_m3: Some(p.dashpot).filter(|c| *c > 0.0),
        ..ContactTable::default()
    });
    let (modes, step) = DENSEST;
    let mut models = vec![
        ModelTable {
            model: "rigid".into(),
            contact: pairs(StiffnessTable::Iso6336(IsoTable::default())),
            ..ModelTable::default()
        },
        ModelTable {
            model: "movable-teeth".into(),
            contact: pairs(StiffnessTable::Constant(ConstantTable {
                stiffness_n_per_m2: Positive(CONTACT_PER_WIDTH),
                of: Default::default(),
            })),
            parameters: teeth.map(|(key, x)| (key, short(x))).into_iter().collect(),
            ..ModelTable::default()
        },
        ModelTable {
            model: "elastic".into(),
            parameters: elements([("modes", 100.0)], Some(p.modal_ratio)),
            contact: points.clone(),
            integrators: Some(vec![IntegratorTable::from(&TRIGONOMETRIC.at_step(STEP))]),
            ..ModelTable::default()
        },
        ModelTable {
            label: Some(ModelLabel("densest".into())),
            model: "elastic".into(),
            parameters: elements(
                [("modes", modes as f64), ("step_s", step)],
                Some(p.modal_ratio),
            ),
            contact: points.clone(),
            integrators: Some(vec![IntegratorTable::from(&TRIGONOMETRIC.at_step(step))]),
            ..ModelTable::default()
        },
    ];
    // Full finite elements have no modal damping, and cost seconds for an impact.
    if p.kind == Kind::Impact {
        models.push(ModelTable {
            model: "fe".into(),
            parameters: elements([], None),
            contact: points,
            integrators: Some(vec![IntegratorTable::from(
                &NEWMARK.at_step(short(p.contact_time / FULL_STEPS)),
            )]),
            ..ModelTable::default()
        });
    }
    models
}

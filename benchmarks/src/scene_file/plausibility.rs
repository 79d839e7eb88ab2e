//! Checks of plausibility. Physically impossible values are refused, unusual values cause a warning. Both name the line
//! and the unit that was probably meant.
//!
//! Limits of the possible:
//! - A rim with the surface speed `v` has the hoop stress `rho v^2`, which exceeds Young's modulus `E` where `v`
//!   exceeds the speed of sound `sqrt(E / rho)` (Timoshenko, Strength of Materials II, thin rotating ring).
//! - A load `F` at the base circle gives a nominal stress `F / (b m)` of a tooth of module `m` and width `b`; no solid
//!   carries more than `E`.
//! - A tooth of stiffness `k` and mass `m` vibrates at `sqrt(k / m)`, in gears about once in the time in which a wave
//!   crosses its module; at a thousand times that no step would be short enough.
//! - A fixed step is at most as long as the simulated time.
//!
//! Typical ranges are wide: values beyond them are mostly errors of units.

use super::error::SceneError;
use super::motion;
use super::reading::Place;
use super::typical_ranges::{
    DAMPING_RATIO, DENSITY, DURATION, FRICTION, HELIX_ANGLE, INERTIA, PENALTY, PRESSURE_ANGLE,
    STIFFNESS, TOLERANCE, TypicalRange, YOUNG,
};
use super::{ModelChoice, SceneFile};
use gearbench_integrators::{Resolution, Scheme};
use gearbench_models::Vec3;
use gearbench_models::error::BuildError;
use gearbench_models::gear::movable_teeth::{MovableTeethParameters, PerTooth};
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_models::law::Damping;
use gearbench_models::spec::{Body, ContactSpec, GearSpec, Load, Mount, effective_radius};
use gearbench_models::stiffness::{Material, PairStiffness};
use gearbench_reports::numbers::short;

/// Smallest pressure angle of cutting tools [degrees].
const LEAST_PRESSURE_ANGLE: f64 = 5.0;
/// Surface speed above which hardly any gear runs [m/s].
const FAST: f64 = 400.0;
/// Angular frequency of a tooth, relative to that of waves across its module, from which on it is refused.
const STIFF_TOOTH: f64 = 1e3;
/// Lower bound of the wave speed in gear materials [m/s].
const SLOW: f64 = 500.0;
/// Nominal tooth stress, relative to Young's modulus, above which a warning is given.
const HEAVY: f64 = 0.01;

/// Refuses a pressure angle that no tool has [rad], most often one given in radians.
///
/// # Errors
/// [`SceneError`] with the angle in degrees.
pub(super) fn pressure_angle(angle: f64, gear: &Place<'_>) -> Result<(), SceneError> {
    let degrees = angle.to_degrees();
    if !(0.0..LEAST_PRESSURE_ANGLE).contains(&degrees) {
        return Ok(());
    }
    let place = gear.key("pressure_angle_deg");
    let help = match PRESSURE_ANGLE.warning(&place, "pressure_angle_deg", degrees) {
        Some(odd) => odd.help_text().unwrap_or_default().to_owned(),
        None => String::new(),
    };
    place.refuse(
        format!(
            "a pressure angle of {} degrees, which no tool can cut",
            short(degrees, 4)
        ),
        format!("expected at least {LEAST_PRESSURE_ANGLE} degrees"),
        help,
    )
}

/// Checks a scene; returns warnings, or the first error.
///
/// # Errors
/// [`SceneError`] for an impossible value.
pub(super) fn check(scene: &SceneFile) -> Result<Vec<SceneError>, SceneError> {
    let root = scene.document.at("");
    let mut odd = Vec::new();
    odd.extend(DURATION.warning(&root.key("duration_s"), "duration_s", scene.duration));
    odd.extend(tolerance(scene, &root.key("tolerance")));
    for gear in &scene.spec.gears {
        let at = root.key("gears").key(&gear.name);
        toothing(gear, &at, &mut odd);
        material(&gear.material, &at.key("material"), &mut odd);
        speed(gear, &at, &mut odd)?;
        loads(gear, &at, &mut odd)?;
    }
    overlap(scene)?;
    driven(scene)?;
    odd.extend(motion::check(scene));
    steps(
        &scene.study.integrators,
        scene,
        &root.key("study").key("integrators"),
    )?;
    for (i, model) in scene.models.iter().enumerate() {
        let at = root.key("models").member(i);
        contacts(model, &at.key("contact"), &mut odd);
        odd.extend(calibrated(scene, model, &at));
        tooth_springs(scene, model)?;
        let own = model.integrators.as_deref().unwrap_or_default();
        steps(own, scene, &at.key("integrators"))?;
    }
    Ok(odd)
}

/// Refuses a mesh whose gears both have prescribed motions: forces could not move them, and teeth would pass through
/// each other.
///
/// # Errors
/// [`SceneError`] at the mount of the second gear.
fn driven(scene: &SceneFile) -> Result<(), SceneError> {
    let gears = &scene.spec.gears;
    let prescribed =
        |i: &usize| matches!(gears[*i].mount, Mount::Driven(_)) && gears[*i].lateral.is_none();
    let Some(mesh) = (scene.spec.meshes.iter()).find(|m| m.gears.iter().all(prescribed)) else {
        return Ok(());
    };
    let [a, b] = mesh.gears.map(|i| gears[i].name.as_str());
    let gear = scene.document.at("gears").key(b);
    gear.first(&["mount"]).refuse(
        format!("`{a}` and `{b}` mesh and are both driven"),
        "no free gear",
        format!("drive one of them and give the other `loads`, for example {b}.loads = [{{ torque_nm = 10.0 }}]"),
    )
}

/// Warns of a tolerance that accepts any result.
fn tolerance(scene: &SceneFile, at: &Place<'_>) -> Option<SceneError> {
    let of = scene
        .tolerance
        .as_ref()
        .filter(|t| t.metric.unit().is_empty())?;
    let (place, key) = match at.has("limit") {
        true => (at.key("limit"), "limit"),
        false => (at.clone(), "tolerance"),
    };
    let odd = TOLERANCE.warning(&place, key, of.limit)?;
    let message = format!(
        "`{key}` = {} permits an error of {} %",
        short(of.limit, 4),
        short(100.0 * of.limit, 4)
    );
    Some(place.error(message, "odd", odd.help_text().unwrap_or_default()))
}

/// Refuses tooth springs that vibrate faster than teeth of any material.
///
/// # Errors
/// [`SceneError`] at the stiffness.
fn tooth_springs(scene: &SceneFile, model: &ModelChoice) -> Result<(), SceneError> {
    for (gear, spec) in scene.spec.gears.iter().zip(&model.modelling.gears) {
        let Some(p) = MovableTeethParameters::of(spec) else {
            continue;
        };
        let table = p.stiffness_at_radius_n_per_m.iter().flatten().copied();
        let stiffest = (p
            .tooth_stiffness_n_per_m
            .iter()
            .filter_map(PerTooth::greatest))
        .chain(table)
        .fold(0.0, f64::max);
        let Some(lightest) = p.tooth_mass_kg.as_ref().and_then(PerTooth::least) else {
            continue;
        };
        let frequency = (stiffest / lightest).sqrt();
        let module = match &gear.body {
            Body::Gear(g) => g.params().module,
            Body::Rack(r) => r.params().module,
        };
        // A modulus in another unit has a message of its own.
        let wave = (gear.material.young / gear.material.density)
            .sqrt()
            .max(SLOW)
            / module;
        if stiffest > 0.0 && lightest > 0.0 && frequency > STIFF_TOOTH * wave {
            let why = (
                format!(
                    "{} N/m on a tooth of {} kg vibrate at {} rad/s, where waves in the material of `{}` cross a module {} times \
                     a second",
                    short(stiffest, 3),
                    short(lightest, 3),
                    short(frequency, 3),
                    gear.name,
                    short(wave, 3)
                ),
                "a tooth of steel has about 5e8 N/m per 10 mm of width and a few grams; for teeth without springs use the model `rigid`",
            );
            let key = match p.tooth_stiffness_n_per_m {
                Some(_) => "tooth_stiffness_n_per_m",
                None => "stiffness_at_radius_n_per_m",
            };
            let error = BuildError::parameter(spec.id(), key, why).of_gear(&gear.name);
            return Err(scene.locate_in(&model.label, &error));
        }
    }
    Ok(())
}

/// Warns of constants fitted to an impact in a scene that runs under load: the mesh is then far too stiff.
fn calibrated(scene: &SceneFile, model: &ModelChoice, at: &Place<'_>) -> Option<SceneError> {
    let calibration = model.calibration.as_ref()?;
    let loaded = |g: &GearSpec| {
        g.loads.iter().any(|l| match l {
            Load::Applied(p) => p.settled() != 0.0,
            Load::Viscous(c) => *c != 0.0,
        })
    };
    let holds = |g: &GearSpec| loaded(g) || matches!(g.mount, Mount::Driven(_) | Mount::Fixed);
    let gears = &scene.spec.gears;
    let runs = gears.iter().any(loaded) && gears.iter().filter(|g| holds(g)).count() > 1;
    (runs && !calibration.fitted_to().to_statics()).then(|| {
        at.key("calibration").error(
            format!(
                "`{}` runs under load with a calibration for {}",
                model.label,
                calibration.fitted_to().holds_for()
            ),
            "odd",
            format!(
                "use \"running\" or \"static\": `gearbench identify {} --to running --write` fits it",
                calibration.scene
            ),
        )
    })
}

fn toothing(gear: &GearSpec, at: &Place<'_>, odd: &mut Vec<SceneError>) {
    let (pressure, helix) = match &gear.body {
        Body::Gear(g) => (g.params().pressure_angle, g.params().helix_angle),
        Body::Rack(r) => (r.params().pressure_angle, r.params().helix_angle),
    };
    let mut look = |usual: &TypicalRange, key: &str, value: f64| {
        odd.extend(
            at.has(key)
                .then(|| usual.warning(&at.key(key), key, value))
                .flatten(),
        );
    };
    look(&PRESSURE_ANGLE, "pressure_angle_deg", pressure.to_degrees());
    if helix != 0.0 {
        look(&HELIX_ANGLE, "helix_angle_deg", helix.to_degrees().abs());
    }
    if let Some(inertia) = gear.inertia {
        let (key, own) = match &gear.body {
            Body::Gear(g) => ("inertia_kgm2", g.mass_properties(gear.material.density).izz),
            Body::Rack(r) => ("mass_kg", r.mass(gear.material.density)),
        };
        look(&INERTIA, key, inertia / own);
    }
}

fn material(material: &Material, at: &Place<'_>, odd: &mut Vec<SceneError>) {
    odd.extend(YOUNG.warning(&at.key("young_pa"), "young_pa", material.young));
    odd.extend(DENSITY.warning(&at.key("density_kg_m3"), "density_kg_m3", material.density));
}

/// Compares the surface speed with the speed of sound.
fn speed(gear: &GearSpec, at: &Place<'_>, odd: &mut Vec<SceneError>) -> Result<(), SceneError> {
    let driven = match &gear.mount {
        Mount::Driven(motion) => Some(motion.greatest()),
        _ => None,
    };
    let place = match driven {
        Some(_) => at.key("mount"),
        None => at.first(&["speed_rad_s", "speed_m_s"]),
    };
    let fastest = driven.unwrap_or(gear.speed.abs());
    let surface = match &gear.body {
        Body::Gear(g) => g.r_tip() * fastest,
        Body::Rack(_) => fastest,
    };
    let sound = (gear.material.young / gear.material.density).sqrt();
    let what = format!(
        "the teeth of `{}` move at {} m/s",
        gear.name,
        short(surface, 4)
    );
    if surface >= sound {
        let young = short(gear.material.young, 4);
        return place.refuse(
            format!("{what}, faster than the speed of sound in their material, {} m/s", short(sound, 4)),
            "no solid withstands this speed",
            format!("give speeds in rad/s (of a rack in m/s) and Young's modulus, here {young} Pa, in pascal"),
        );
    }
    if surface > FAST {
        let help = format!(
            "pitch line velocities of gears are at most about {FAST} m/s; give speeds in rad/s, of a rack in m/s"
        );
        odd.push(place.error(what, "odd", help));
    }
    Ok(())
}

/// Compares the nominal tooth stress under each load with Young's modulus.
fn loads(gear: &GearSpec, at: &Place<'_>, odd: &mut Vec<SceneError>) -> Result<(), SceneError> {
    let (module, width) = match &gear.body {
        Body::Gear(g) => (g.params().module, g.params().face_width),
        Body::Rack(r) => (r.params().module, r.params().face_width),
    };
    for (i, load) in gear.loads.iter().enumerate() {
        let Load::Applied(profile) = load else {
            continue;
        };
        let force = profile.greatest() / effective_radius(&gear.body);
        let stress = force / (module * width);
        let place = at.key("loads").member(i);
        let what = format!(
            "the load causes {} N on the teeth of `{}`, {} of its Young's modulus times module and face width",
            short(force, 3),
            gear.name,
            short(stress / gear.material.young, 3)
        );
        if stress >= gear.material.young {
            return place.refuse(
                what,
                "too large for any solid",
                "give torques in N m, forces in N, lengths in metres, Young's modulus in pascal",
            );
        }
        if stress > HEAVY * gear.material.young {
            odd.push(place.error(
                what,
                "odd",
                "few steels withstand a hundredth of Young's modulus",
            ));
        }
    }
    Ok(())
}

/// Refuses gears that overlap without meshing, across their axes and along them.
fn overlap(scene: &SceneFile) -> Result<(), SceneError> {
    let gears = &scene.spec.gears;
    let mesh = |a: usize, b: usize| {
        (scene.spec.meshes.iter()).any(|m| m.gears == [a, b] || m.gears == [b, a])
    };
    for (b, second) in gears.iter().enumerate() {
        for (a, first) in gears[..b].iter().enumerate() {
            let (Body::Gear(ga), Body::Gear(gb)) = (&first.body, &second.body) else {
                continue;
            };
            let [dx, dy] = [0, 1].map(|k| second.position[k] - first.position[k]);
            let (distance, room) = (dx.hypot(dy), ga.r_outer() + gb.r_outer());
            let inside = [(ga, gb), (gb, ga)].iter().any(|(ring, other)| {
                ring.is_internal() && distance + other.r_outer() <= ring.r_tip()
            });
            let along =
                (Vec3::from(second.position) - Vec3::from(first.position)).dot(&first.axes[2]);
            let apart = along.abs() >= 0.5 * (ga.face_width() + gb.face_width());
            if distance >= room || inside || apart || mesh(a, b) {
                continue;
            }
            let root = scene.document.at("");
            let placed = (scene.spec.meshes.iter()).position(|m| m.gears.contains(&b));
            let gear = root.key("gears").key(&second.name);
            let place = match placed.map(|i| root.key("meshes").member(i)) {
                _ if gear.has("position_m") => gear.key("position_m"),
                Some(mesh) => mesh.first(&["direction_deg", "gears"]),
                None => gear,
            };
            return place.refuse(
                format!(
                    "`{}` and `{}` do not mesh and overlap: their axes are {} m apart, their tip circles need {} m",
                    first.name,
                    second.name,
                    short((distance / room * 1e9).round() * 1e-9 * room, 4),
                    short(room, 4)
                ),
                format!("puts `{}` there", second.name),
                "give this mesh another `direction_deg`, or the gear another `position_m`",
            );
        }
    }
    Ok(())
}

/// Compares fixed steps with the simulated time.
fn steps(schemes: &[Scheme], scene: &SceneFile, at: &Place<'_>) -> Result<(), SceneError> {
    for (i, scheme) in schemes.iter().enumerate() {
        if let Some(why) = step_too_long(scheme, scene.duration) {
            let place = at.member(i);
            let help = "give a smaller step; contact usually needs microseconds or less";
            return place.first(&["step_s"]).refuse(why, "too long", help);
        }
    }
    Ok(())
}

/// The message on a step that is longer than the simulated time [s], if it is.
pub(super) fn step_too_long(scheme: &Scheme, duration: f64) -> Option<String> {
    match scheme.resolution {
        Resolution::Step(h) if h > duration => Some(format!(
            "a step of {h:e} s of `{}` is longer than the {duration:e} s that are simulated",
            scheme.method
        )),
        _ => None,
    }
}

fn contacts(model: &ModelChoice, at: &Place<'_>, odd: &mut Vec<SceneError>) {
    let own = |i: usize| Some(at.member(i)).filter(Place::exists);
    for (i, contact) in model.modelling.contacts.iter().enumerate() {
        let at = match own(i) {
            Some(own) => own,
            // One contact of all meshes is looked at once.
            None if i > 0 => return,
            None => at.clone(),
        };
        odd.extend(contact_of(contact, &at));
    }
}

fn contact_of(contact: &ContactSpec, at: &Place<'_>) -> Vec<SceneError> {
    let look = |usual: &TypicalRange, keys: [&str; 2], value: f64| {
        let place = at.key(keys[0]).key(keys[1]);
        place
            .exists()
            .then(|| usual.warning(&place, keys[1], value))
            .flatten()
    };
    let friction = contact
        .friction
        .map(|f| look(&FRICTION, ["friction", "mu"], f.mu()));
    let damping = match contact.damping {
        Damping::KelvinVoigtRatio { ratio } | Damping::RatioAtLoad { ratio } => {
            look(&DAMPING_RATIO, ["damping", "ratio"], ratio)
        }
        _ => None,
    };
    let stiffness = match &contact.stiffness {
        PairStiffness::Constant { per_width, .. } | PairStiffness::Parabola { per_width, .. } => {
            look(&STIFFNESS, ["stiffness", "stiffness_n_per_m2"], *per_width)
        }
        _ => None,
    };
    let key = "penalty_pa_per_m";
    let penalty = (contact.flanks.penalty().filter(|_| at.has(key)))
        .and_then(|[penalty, _]| PENALTY.warning(&at.key(key), key, penalty));
    [friction.flatten(), damping, stiffness, penalty]
        .into_iter()
        .flatten()
        .collect()
}

//! Natural frequencies of models of a scene.

use super::plan::Plan;
use super::shares::{name, name_of, shape, shares};
use crate::experiment::error::StudyError;
use crate::experiment::key::Key;
use crate::experiment::motion::motion_of_modes;
use crate::experiment::runner::Runner;
use crate::small_signals::mesh_mode::{FEW, mesh_mode_of, resonances, with_resonance};
use crate::small_signals::motions::{Energies, Motion, SLACK, energies, scaled};
use crate::small_signals::{
    LoadedState, LoadedStateError, MOST, Patience, has_loads, loaded, settled,
};
use gearbench_integrators::system::SecondOrderSystem;
use gearbench_models::error::{BuildError, Fault};
use gearbench_models::gear::table::Model;
use gearbench_models::scene::{Scene, StrainIn};
use gearbench_models::spec::{Modelling, SceneSpec};
use gearbench_reference::statics::StaticsError;
use gearbench_reports::modes::{
    LinearisedState, MemberPlace, MeshState, ModeRecord, ModelModes, ModesRecord,
};
use gearbench_reports::record::{MeshMode, Part, Results};
use std::f64::consts::TAU;

/// Range and grouping of the natural frequencies that are listed for a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModesSettings {
    /// Largest number of frequencies that are listed.
    pub most: usize,
    /// Upper limit of the frequencies [Hz].
    pub up_to: f64,
    /// Relative distance below which frequencies are grouped as one.
    pub group: f64,
}

impl Default for ModesSettings {
    fn default() -> Self {
        ModesSettings {
            most: 30,
            up_to: f64::INFINITY,
            group: 1e-6,
        }
    }
}

/// Computes the natural frequencies of a model of a scene; if there are none the record has the reason.
///
/// # Errors
/// [`BuildError`] where the scene cannot be assembled.
pub fn vibrations(
    label: &str,
    (spec, modelling): (&SceneSpec, &Modelling),
    models: &[Model],
    wanted: &ModesSettings,
) -> Result<ModelModes, BuildError> {
    analysed(label, (spec, modelling), models, wanted).map(|(modes, _)| modes)
}

/// Natural frequencies of a model of a scene, and its mesh mode where the scene has loads.
fn analysed(
    label: &str,
    (spec, modelling): (&SceneSpec, &Modelling),
    models: &[Model],
    wanted: &ModesSettings,
) -> Result<(ModelModes, Option<MeshMode>), BuildError> {
    let spec = settled(spec);
    let mut scene = Scene::build(&spec, modelling, models)?;
    let n = scene.layout().n;
    let mut record = ModelModes {
        label: label.to_owned(),
        coordinates: n,
        constraints: scene.constraints().len(),
        members: places(&scene, spec.gears.len()),
        ..ModelModes::default()
    };
    let loads = has_loads(&spec, 0.0);
    let found = match n {
        0 => Err(LoadedStateError::Matrices("nothing in it can move")),
        n if n > MOST => Err(LoadedStateError::TooLarge(n)),
        _ => loaded(&mut scene, loads, &Patience::ENDLESS),
    };
    let mesh_mode = loads.then(|| mesh_mode_of(label, (&spec, &mut scene), found.as_ref(), None));
    match found {
        Ok(found) => fill(&mut record, &mut scene, &spec, (&found, loads), wanted),
        Err(why) => {
            record.about = LinearisedState::NotFound;
            record.message = why.to_string();
        }
    }
    let mesh_mode = mesh_mode.map(|mode| with_resonance(mode, &resonances(&mut scene, &spec, FEW)));
    Ok((record, mesh_mode))
}

fn places(scene: &Scene, gears: usize) -> Vec<MemberPlace> {
    let first = scene.gears().first().map(|g| g.model.hub().axes[2]);
    let place = |(i, g): (usize, &gearbench_models::scene::SceneGear)| {
        let hub = g.model.hub();
        let [x, y] = scene.in_plane(&hub.centre);
        let slides = hub.slide.is_some();
        MemberPlace {
            name: g.name.clone(),
            x_m: x,
            y_m: y,
            radius_m: if slides {
                1.0
            } else {
                hub.effective_base_radius
            },
            slides,
            toothed: i < gears,
            in_plane: slides || first.is_some_and(|z| z.cross(&hub.axes[2]).norm() < 1e-6),
        }
    };
    scene.gears().iter().enumerate().map(place).collect()
}

/// Motions of one frequency, by the first of them, and the energies of all.
struct MotionGroup {
    first: Motion,
    multiplicity: usize,
    energies: Energies,
}

fn fill(
    record: &mut ModelModes,
    scene: &mut Scene,
    spec: &SceneSpec,
    (found, loads): (&LoadedState, bool),
    wanted: &ModesSettings,
) {
    let squares = &found.modes.squares;
    let highest = found.highest_square();
    let all = found.motions();
    record.about = match found.pressed.iter().any(|f| *f > 0.0) {
        false if !found.pressed.is_empty() => LinearisedState::Apart,
        _ if loads => LinearisedState::Loaded,
        _ => LinearisedState::Preloaded,
    };
    let unstable = squares.iter().filter(|x| **x < -SLACK * highest).count();
    if unstable > 0 {
        record.message = format!(
            "{unstable} of its modes have a negative stiffness, caused by contact forces that follow the motion; they are \
             listed without a frequency"
        );
    } else if record.about == LinearisedState::Apart {
        record.message =
            "no load closes the contacts: the frequencies are those of separate gears".into();
    }
    record.steps = found.steps;
    record.residual_rel = found.modes.residual;
    record.frequencies = all.len();
    record.highest_hz = highest.sqrt() / TAU;
    record.meshes = (scene.meshes().iter().zip(&found.pressed))
        .map(|(m, force)| {
            let [a, b] = m.gears.map(|i| scene.gears()[i].name.as_str());
            MeshState {
                name: format!("{a} - {b}"),
                force_n: *force,
            }
        })
        .collect();
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for i in 0..all.len() {
        let with = groups.last().filter(|g| {
            let (w, last) = (all[i].omega, all[g[g.len() - 1]].omega);
            let alike = (all[i].square < -SLACK * highest) == (all[g[0]].square < -SLACK * highest);
            alike && (w - last).abs() <= wanted.group * w
        });
        match with {
            Some(_) => groups.last_mut().into_iter().for_each(|g| g.push(i)),
            None => groups.push(vec![i]),
        }
    }
    groups.retain(|g| all[g[0]].omega <= TAU * wanted.up_to);
    groups.truncate(wanted.most);
    let mut motions: Vec<MotionGroup> = Vec::new();
    for group in &groups {
        let mut sum = Energies::default();
        for &i in group {
            sum.add(energies(scene, &found.state, &found.linear, &all[i].x));
        }
        motions.push(MotionGroup {
            first: all[group[0]].clone(),
            multiplicity: group.len(),
            energies: sum,
        });
    }
    let mut springs: Vec<StrainIn> = (motions.iter())
        .flat_map(|m| m.energies.strain.keys().copied())
        .collect();
    springs.sort_unstable();
    springs.dedup();
    record.springs = springs.iter().map(|s| name_of(*s, scene, spec)).collect();
    let shapes: Vec<Vec<f64>> = (motions.iter())
        .map(|m| scaled(scene, &m.first.x))
        .collect();
    record.motion =
        (!shapes.is_empty()).then(|| motion_of_modes(spec, scene, &found.state, &shapes));
    record.modes = (motions.into_iter())
        .map(|m| listed(scene, found, (&springs, &record.springs), &m))
        .collect();
}

fn listed(
    scene: &Scene,
    found: &LoadedState,
    (springs, names): (&[StrainIn], &[String]),
    group: &MotionGroup,
) -> ModeRecord {
    let (motion, energies) = (&group.first, &group.energies);
    let energy = |s: &StrainIn| energies.strain.get(s).copied().unwrap_or(0.0);
    let swings = motion.omega > 0.0;
    let strain = match swings {
        true => shares(&springs.iter().map(energy).collect::<Vec<_>>()),
        false => Vec::new(),
    };
    let kinetic = shares(&energies.kinetic);
    let own: f64 = energies.kinetic.iter().sum();
    let x = scaled(scene, &motion.x);
    let mut shape = shape(scene, &found.state, &x);
    for (s, energy) in shape.iter_mut().zip(&energies.own) {
        s.own = if own > 0.0 { energy / own } else { 0.0 };
    }
    ModeRecord {
        frequency_hz: motion.omega / TAU,
        multiplicity: group.multiplicity,
        damping_ratio: motion.damped.map(|d| d.ratio),
        damped_frequency_hz: motion.damped.and_then(|d| d.omega).map(|w| w / TAU),
        name: match swings {
            true => name(names, &strain),
            false if motion.square < 0.0 => "negative stiffness".into(),
            false => "rigid motion".into(),
        },
        kinetic,
        strain,
        shape,
    }
}

/// Computes the natural frequencies and modes of all models.
///
/// # Errors
/// [`StudyError`]; models without an equilibrium are rows.
pub fn study(plan: &Plan, runner: &Runner<'_>) -> Result<Results, StudyError> {
    let (mut vibrations_of, mut mesh_modes) = (Vec::new(), Vec::new());
    for (done, entry) in plan.entries.iter().enumerate() {
        if runner.is_interrupted() {
            // After an interruption the finished part is reported.
            break;
        }
        runner.report_progress(done, plan.entries.len(), &entry.label);
        let scene = (&entry.scene, &entry.modelling);
        let label = entry.model_label();
        let key = (Key::new("modes").and_scene(scene.0, scene.1)).and(&(&label, &plan.wanted));
        let found = runner.piece(key, || {
            match analysed(&label, scene, &plan.conditions.context.models, &plan.wanted) {
                Err(e) if e.fault == Fault::Model => Ok((
                    ModelModes {
                        label: label.clone(),
                        about: LinearisedState::NotFound,
                        message: e.to_string(),
                        ..ModelModes::default()
                    },
                    None,
                )),
                found => found
                    .map_err(|e| StudyError::Statics(entry.label.clone(), StaticsError::Build(e))),
            }
        });
        let (found, mesh_mode) = found?;
        vibrations_of.push(found);
        mesh_modes.extend(mesh_mode);
    }
    runner.report_progress(plan.entries.len(), plan.entries.len(), "report");
    let part = ModesRecord {
        vibrations: vibrations_of,
    };
    Ok(Results {
        mesh_modes,
        ..plan.conditions.record(Part::Modes(part))
    })
}

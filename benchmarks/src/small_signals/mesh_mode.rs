//! The mesh mode of a model: the natural mode, about the equilibrium under loads, in which the hubs close the meshes
//! most; see [`super::cycle`].
//!
//! The damping of a scene has different meanings in different models: a ratio for the contact spring, for each mode of
//! a body, or for tooth springs. The damping ratio of the mesh mode is comparable across models.

use super::cycle::{MeshCycle, PHASES, Resonance, mesh_mode_at, running};
use super::motions::energies;
use super::{LoadedState, LoadedStateError, Patience, has_loads, loaded, settled};
use gearbench_integrators::system::{SecondOrderSystem, State};
use gearbench_models::gear::table::{Model, properties_of};
use gearbench_models::scene::{Scene, StrainIn};
use gearbench_models::spec::{ModelSpec, Modelling, SceneSpec};
use gearbench_reports::record::{GearMotion, MeshMode, finite};
use std::f64::consts::TAU;

/// Largest number of coordinates for which other studies compute the mesh mode: the work grows with the cube.
pub const FEW: usize = 300;
/// Largest number of coordinates for which other studies compute the resonance over the mesh cycle: each phase takes a
/// decomposition.
pub const FEW_OVER_CYCLE: usize = 150;

/// Modes per gear of elastic gears whose mesh mode is computed: residual compliance has the rest.
const MODES: usize = 50;
/// Coordinates of a hub at most.
const HUB: usize = 6;

/// Returns the modes of each of so many elastic gears with which their mesh mode is computed in at most [`FEW`]
/// coordinates.
pub fn few_modes(gears: usize) -> usize {
    MODES.min((FEW / gears.max(1)).saturating_sub(HUB))
}

/// A function that makes a motion of a mode from the state at rest and the displacement of the coordinates, for pages with
/// moving gears.
pub type ModeMotion<'a> = &'a dyn Fn(&SceneSpec, &mut Scene, &State, &[f64]) -> GearMotion;

/// The mesh mode of a loaded scene in its equilibrium, with its motion if a function makes one.
pub fn mesh_mode_of(
    label: &str,
    (spec, scene): (&SceneSpec, &mut Scene),
    found: Result<&LoadedState, &LoadedStateError>,
    motion_of: Option<ModeMotion<'_>>,
) -> MeshMode {
    let none = |message: String| MeshMode {
        label: label.to_owned(),
        message,
        ..MeshMode::default()
    };
    let found = match found {
        Ok(found) if found.pressed.iter().all(|f| *f == 0.0) => {
            return none("the loads act on no flanks".into());
        }
        Ok(found) => found,
        Err(why) => return none(why.to_string()),
    };
    let place = match mesh_mode_at(scene, found) {
        Ok(place) => found.rigid.len() + place,
        Err(why) => return none(why.to_string()),
    };
    let motion = found.motions().into_iter().nth(place);
    let Some(motion) = motion.filter(|m| m.omega > 0.0) else {
        return none("nothing in it vibrates".into());
    };
    let strain = energies(scene, &found.state, &found.linear, &motion.x).strain;
    let in_meshes = |(place, energy): (&StrainIn, &f64)| match place {
        StrainIn::Mesh(_) => *energy,
        _ => 0.0,
    };
    let all: f64 = strain.values().sum();
    let share = strain.iter().map(in_meshes).sum::<f64>() / all.max(f64::MIN_POSITIVE);
    MeshMode {
        label: label.to_owned(),
        frequency_hz: finite(motion.omega / TAU),
        damping_ratio: motion.damped.and_then(|d| finite(d.ratio)),
        mesh_share: finite(share),
        motion: motion_of.map(|of| of(spec, scene, &found.state, &motion.x)),
        ..MeshMode::default()
    }
}

/// Computes the mesh mode of a model of a scene, with its resonance over the cycle for at most so many coordinates and
/// with its motion if a function makes one; `None` if the scene has no loads.
pub fn mesh_mode(
    label: &str,
    (scene, modelling): (&SceneSpec, &Modelling),
    models: &[Model],
    over_cycle: usize,
    motion_of: Option<ModeMotion<'_>>,
) -> Option<MeshMode> {
    let spec = settled(scene);
    if !has_loads(&spec, 0.0) {
        return None;
    }
    let none = |message: String| MeshMode {
        label: label.to_owned(),
        message,
        ..MeshMode::default()
    };
    let full = |g: &ModelSpec| properties_of(models, g.id()).full_order;
    if modelling.gears.iter().any(full) {
        return Some(none(
            "not computed: full finite elements have too many coordinates".into(),
        ));
    }
    let mut scene = match Scene::build(&spec, modelling, models) {
        Ok(scene) => scene,
        Err(e) => return Some(none(e.to_string())),
    };
    let found = match scene.layout().n {
        0 => Err(LoadedStateError::Matrices("nothing in it can move")),
        n if n > FEW => {
            return Some(none(format!(
                "not computed: {n} coordinates, more than {FEW}; `gearbench modes` permits more"
            )));
        }
        _ => loaded(&mut scene, true, &Patience::ENDLESS),
    };
    let mode = mesh_mode_of(label, (&spec, &mut scene), found.as_ref(), motion_of);
    let of_cycles = resonances(&mut scene, &spec, over_cycle);
    Some(with_resonance(mode, &of_cycles))
}

/// Adds the resonance over the cycle to a mesh mode: that of the meshes whose frequency is nearest to it.
pub fn with_resonance(mode: MeshMode, of_cycles: &[Resonance]) -> MeshMode {
    let found = mode.frequency_hz.and_then(|frequency| {
        let distance = |r: &Resonance| (r.frequency / frequency).ln().abs();
        (of_cycles.iter()).min_by(|a, b| distance(a).total_cmp(&distance(b)))
    });
    MeshMode {
        resonance_hz: found.map(|r| r.frequency),
        resonance_range_hz: found.map(|r| r.range),
        ..mode
    }
}

/// The resonances of the meshes of a scene over their cycles, one for each mesh frequency; empty if its gears are at rest, if
/// it has too many coordinates, or if a phase has no equilibrium.
pub fn resonances(scene: &mut Scene, spec: &SceneSpec, most: usize) -> Vec<Resonance> {
    if scene.layout().n > most {
        return Vec::new();
    }
    let running = running(scene, spec, PHASES, &Patience::ENDLESS);
    running.map_or_else(
        |_| Vec::new(),
        |r| r.cycles.iter().filter_map(MeshCycle::resonance).collect(),
    )
}

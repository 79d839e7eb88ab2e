//! Linearised scenes: equilibrium under the loads, natural modes and frequency response.
//!
//! | module | owns |
//! |---|---|
//! | [`cycle`] | meshes over their cycles in quasi-static motion |
//! | `damping` | damping ratios and damped frequencies of modes |
//! | `equilibrium` | the loaded state |
//! | [`grounds`] | forces on the ground as functions of the motion |
//! | [`mesh_mode`] | the mode that strains the meshes most, and its damping |
//! | [`motions`] | natural modes, their damping and energies |
//! | [`response`] | frequency response to tooth meshing |
//! | [`stated_damping`] | dampers of a model for a stated damping of its mesh mode |
//! | `admissible_motions` | admissible motions and their modes |

mod admissible_motions;
pub mod cycle;
mod damping;
mod equilibrium;
pub mod grounds;
pub mod mesh_mode;
pub mod motions;
pub mod response;
pub mod stated_damping;

pub use admissible_motions::{AdmissibleMotions, Modes};
pub use equilibrium::{LoadedState, loaded};

use gearbench_integrators::system::SecondOrderSystem;
use gearbench_models::error::{BuildError, MeshPart};
use gearbench_models::gear::table::Model;
use gearbench_models::scene::Scene;
use gearbench_models::spec::{Load, Modelling, Mount, Profile, SceneSpec, StationMember};

/// Largest number of coordinates of a scene, as its matrices are dense.
pub const MOST: usize = 1500;

/// Reason why a scene has no loaded state.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LoadedStateError {
    /// The matrices of the scene do not allow a solution, for the given reason.
    #[error("{0}")]
    Matrices(&'static str),
    /// No equilibrium was found.
    #[error(
        "no equilibrium under its loads was found: after {steps} Newton steps the residual force on `{at}` is {:.3e} of the \
         largest load; balance the loads except for the resultant that accelerates the whole train, or start without loads and \
         with a negative `gap_m`",
        imbalance
    )]
    Unbalanced {
        /// Number of Newton steps taken.
        steps: u32,
        /// Largest residual force, relative to the largest load.
        imbalance: f64,
        /// The member on which the largest residual force acts.
        at: String,
    },
    /// The user interrupted the search.
    #[error("interrupted")]
    Interrupted,
    /// The scene has too many coordinates.
    #[error(
        "it has {0} coordinates, but dense matrices have at most {MOST}; use elastic gears with fewer modes"
    )]
    TooLarge(usize),
}

/// The scene with constant loads and motions, equal to their final values.
pub fn settled(spec: &SceneSpec) -> SceneSpec {
    let mut spec = spec.clone();
    let constant = |p: &mut Profile| *p = Profile::Constant(p.settled());
    let settle = |mount: &mut Mount, loads: &mut Vec<Load>| {
        if let Mount::Driven(p) = mount {
            constant(p);
        }
        for load in loads {
            if let Load::Applied(p) = load {
                constant(p);
            }
        }
    };
    for g in &mut spec.gears {
        settle(&mut g.mount, &mut g.loads);
    }
    for station in spec.shafts.iter_mut().flat_map(|s| &mut s.stations) {
        if let StationMember::Body(body) = &mut station.carries {
            settle(&mut body.mount, &mut body.loads);
        }
    }
    spec
}

/// True if an applied or viscous load acts in a scene at a time [s].
pub fn has_loads(spec: &SceneSpec, t: f64) -> bool {
    let acts = |load: &Load| match load {
        Load::Applied(p) => p.value(t) != 0.0,
        Load::Viscous(c) => *c != 0.0,
    };
    let gears = spec.gears.iter().flat_map(|g| &g.loads);
    let bodies = spec.shafts.iter().flat_map(|s| s.bodies());
    gears.chain(bodies.flat_map(|b| &b.loads)).any(acts)
}

/// Assembles a scene in its initial state, which is the equilibrium of its loads at time zero where a mesh requires it.
///
/// # Errors
/// [`BuildError`], also of a scene that has no such equilibrium.
pub fn assemble(
    spec: &SceneSpec,
    modelling: &Modelling,
    models: &[Model],
) -> Result<Scene, BuildError> {
    let mut scene = Scene::build(spec, modelling, models)?;
    let Some(mesh) = spec.starts_loaded() else {
        return Ok(scene);
    };
    let names = spec.names_of(mesh.gears);
    let refuse = |why: String, help: &str| {
        let mut ids: Vec<&str> = modelling.gears.iter().map(|g| g.id()).collect();
        ids.dedup();
        let why = format!(
            "the loaded start of the model `{}` cannot be computed: {why}",
            ids.join("`, `")
        );
        Err(BuildError::mesh(names, MeshPart::Start, (why, help)).of_model())
    };
    if !has_loads(spec, 0.0) {
        return refuse(
            "no load acts at time zero".into(),
            "give loads that act from the start, or remove `loaded`",
        );
    }
    let found = match scene.layout().n {
        0 => Err(LoadedStateError::Matrices("nothing in it can move")),
        n if n > MOST => Err(LoadedStateError::TooLarge(n)),
        _ => loaded(&mut scene, true),
    };
    match found {
        Ok(found) if found.pressed.iter().all(|f| *f == 0.0) => refuse(
            "the loads act on no flanks".into(),
            "give opposing loads, or remove `loaded`",
        ),
        Ok(found) => {
            scene.start_from(found.state);
            Ok(scene)
        }
        Err(why) => refuse(
            why.to_string(),
            "start with flanks that touch: remove `loaded`",
        ),
    }
}

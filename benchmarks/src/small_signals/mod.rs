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

use crate::experiment::interruption::Interruption;
use gearbench_integrators::clock::processor_time;
use gearbench_integrators::system::SecondOrderSystem;
use gearbench_models::error::{BuildError, MeshPart};
use gearbench_models::gear::table::Model;
use gearbench_models::scene::Scene;
use gearbench_models::spec::{Load, Modelling, Mount, Profile, SceneSpec, StationMember};
use std::time::Duration;

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
    /// The search exceeded its bound of processor time [s].
    #[error(
        "its search takes more than {0} s, the bound of processor time of a run; allow more with `--timeout`"
    )]
    TooLong(f64),
    /// The scene has too many coordinates.
    #[error(
        "it has {0} coordinates, but dense matrices have at most {MOST}; use elastic gears with fewer modes"
    )]
    TooLarge(usize),
}

/// Bounds of a search for a loaded state.
#[derive(Clone, Copy, Debug)]
pub struct Patience<'a> {
    /// The request of the user that the search ends.
    pub interruption: Option<&'a Interruption>,
    /// Bound of processor time.
    pub limit: Duration,
    started: Option<Duration>,
}

impl<'a> Patience<'a> {
    /// A search without bounds.
    pub const ENDLESS: Patience<'static> = Patience {
        interruption: None,
        limit: Duration::MAX,
        started: None,
    };

    /// A search that begins now, within a bound of processor time.
    pub fn of(interruption: &'a Interruption, limit: Duration) -> Self {
        Patience {
            interruption: Some(interruption),
            limit,
            started: processor_time(),
        }
    }

    /// A search that ends where the user requests it.
    pub fn until(interruption: &'a Interruption) -> Self {
        Self::of(interruption, Duration::MAX)
    }

    /// Returns an error once the search is to end.
    fn check(&self) -> Result<(), LoadedStateError> {
        if self.interruption.is_some_and(Interruption::is_requested) {
            return Err(LoadedStateError::Interrupted);
        }
        let spent = self.started.zip(processor_time());
        match spent.is_some_and(|(from, now)| now.saturating_sub(from) > self.limit) {
            true => Err(LoadedStateError::TooLong(self.limit.as_secs_f64())),
            false => Ok(()),
        }
    }
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
    patience: &Patience<'_>,
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
        _ => loaded(&mut scene, true, patience),
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

//! Damping of rigid gears and movable teeth that is equivalent to the damping of elastic gears.
//!
//! The damping of elastic gears in a scene belongs to their modes and to their contact, which have little of the
//! compliance of a mesh: with 5 % in both, the mesh mode of the gears of `gearbench init` has 0.5 %. Two models are
//! equivalent under load only if the mesh mode has the same damping. So in a scene with loads the elastic gears of the
//! yardstick ([`Details::judge`]) are linearised about the loaded state, and every derived level gets their damping
//! ratio: its damper is scaled until its own mesh mode has this ratio. Other damping of that mode, for example of
//! bearings, is included.
//!
//! Without loads there is no vibration about a state, and the damper follows from the losses of a slow cycle
//! ([`Problem::relaxation`]).

use super::detail::Details;
use super::plan::elastic;
use super::problem::Problem;
use crate::small_signals::mesh_mode::{few_modes, mesh_mode};
use crate::small_signals::stated_damping::{WITHIN, damper_for};
use gearbench_models::law::Damping;
use gearbench_models::spec::Modelling;
use std::f64::consts::TAU;

/// Damping of the mesh mode of elastic gears.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshModeDamping {
    /// Damping ratio of the mesh mode [-].
    pub ratio: f64,
    /// Relaxation time of a damper in parallel to a spring that alone gives this ratio, `2 ratio / omega` [s].
    pub relaxation: f64,
}

impl MeshModeDamping {
    /// Computes the damping of the mesh mode of the elastic gears that serve as yardstick; `None` in a scene without
    /// loads, and where they have no such mode.
    pub fn of(problem: &Problem, details: &Details) -> Option<MeshModeDamping> {
        let modes = few_modes(problem.scene.gears.len());
        let judge = elastic(details.judge(), modes, None);
        let mode = mesh_mode(
            "",
            (&problem.scene, &judge),
            &problem.context.models,
            0,
            None,
        )?;
        let (frequency, ratio) = (mode.frequency_hz?, mode.damping_ratio?);
        Some(MeshModeDamping {
            ratio,
            relaxation: 2.0 * ratio / (TAU * frequency),
        })
    }

    /// Scales the damping of contacts until the mesh mode of the models has this ratio. Models whose mesh mode is
    /// unknown, or does not depend on it, stay unchanged.
    pub fn give(&self, problem: &Problem, modelling: &mut Modelling) {
        let with = |factor: f64| {
            let mut scaled = modelling.clone();
            (scaled.contacts.iter_mut()).for_each(|c| c.damping = times(c.damping, factor));
            scaled
        };
        let ratio = |factor: f64| {
            mesh_mode(
                "",
                (&problem.scene, &with(factor)),
                &problem.context.models,
                0,
                None,
            )?
            .damping_ratio
        };
        let Some(without) = ratio(0.0) else {
            return;
        };
        let wanted = (self.ratio - without).max(0.0);
        let factor = match wanted {
            0.0 => Some(0.0),
            _ => damper_for(1.0, (wanted, WITHIN * self.ratio), |factor| {
                ratio(factor).map(|r| r - without)
            }),
        };
        if let Some(factor) = factor {
            *modelling = with(factor);
        }
    }
}

/// A damper, or a ratio, times a factor.
fn times(damping: Damping, factor: f64) -> Damping {
    match damping {
        Damping::KelvinVoigt { c } => Damping::KelvinVoigt { c: factor * c },
        Damping::RatioAtLoad { ratio } => Damping::RatioAtLoad {
            ratio: factor * ratio,
        },
        other => other,
    }
}

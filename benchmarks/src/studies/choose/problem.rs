//! The scene of a choice, with its elastic gears and further models.
//!
//! The elastic gears of the scene are what all models are meant to stand for: their mesh, material, contact and
//! damping. Where a scene has no elastic model, gears get a generated mesh and steel-like penalty; a Kelvin-Voigt ratio
//! of its rigid model becomes a dashpot of the flanks.
//!
//! **Damping.** With penalty `p` [Pa/m] and dashpot `c` [N s/m^3] per area, a patch of flanks of the stiffness `k_c` has
//! the damper `tau k_c`, `tau = c/p`, in series with teeth that carry modal damping `zeta`. In a slow cycle a pair of the
//! stiffness `k` then loses as much as one with the damper
//!
//! ```text
//! c = k (tau k / k_c + (1 - k / k_c) 2 zeta / omega_t)
//! ```
//!
//! with `omega_t` the first frequency of a tooth. That is the damper of rigid gears and movable teeth. Flat contact of the
//! width `b` under the force `F`, on flanks of the relative radius `rho`, has the half width `a = (3 F rho / (2 p b))^(1/3)`
//! and the stiffness `k_c = 2 a b p`.

use super::detail::Detail;
use crate::cli::values::DEFAULT_TIMEOUT;
use crate::context::Context;
use crate::experiment::runner::Runner;
use crate::scene_file::{ModelChoice, SceneFile};
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_models::law::Damping;
use gearbench_models::spec::{Body, ContactSpec, Modelling, PointContact, SceneSpec, mesh_layout};
use gearbench_models::stiffness::{IsoVariation, PairStiffness};
use gearbench_reference::MeshParameters;
use gearbench_reference::reduction::ElasticParameters;
use std::f64::consts::TAU;
use std::sync::Arc;
use std::time::Duration;

/// Penalty of generated meshes [Pa/m].
pub const PENALTY: f64 = 1e15;
/// Elements of generated meshes along a flank and over the width.
pub const ELEMENTS: [(&str, usize); 2] = [("flank_elements", 12), ("width_elements", 2)];

/// First frequency of a steel tooth times its module [Hz m].
const TOOTH_SPEED: f64 = 244.0;

/// Elastic gears of a problem: parameters of the gears and contact of their flanks.
#[derive(Clone, Debug)]
pub struct ElasticSettings {
    /// Parameters of the elastic model for each gear: mesh and damping, no modes and no step.
    pub gears: Vec<ElasticParameters>,
    /// Contacts with flank points, one per mesh.
    pub contacts: Vec<ContactSpec>,
    /// Label of the model of the scene with these gears; `None` where the scene has none.
    pub label: Option<String>,
    /// Mesh density and kind of flank contact.
    pub detail: Detail,
}

/// Rigid or movable-teeth model of the scene with constants of its own.
#[derive(Clone, Debug)]
pub struct ModelWithConstants {
    /// Label of the model in the scene.
    pub label: String,
    /// True if the gears are rigid.
    pub rigid: bool,
    /// Gears and meshes of the scene, with the gap of this model.
    pub scene: SceneSpec,
    /// Gear models and contacts of this model.
    pub modelling: Modelling,
}

/// Scene for which a model is chosen, with its elastic gears and further models.
#[derive(Clone, Debug)]
pub struct Problem {
    /// Runner that stores finished runs.
    pub runner: Arc<Runner<'static>>,
    /// Name of the scene.
    pub name: String,
    /// Gears and meshes of the scene, with the gap of the elastic model.
    pub scene: SceneSpec,
    /// Simulated time of the scene [s].
    pub duration: f64,
    /// Samples of the histories over the duration.
    pub samples: usize,
    /// Elastic gears with the mesh and the contact of the scene.
    pub flexible: ElasticSettings,
    /// Rigid and movable-teeth models of the scene, as further levels.
    pub own: Vec<ModelWithConstants>,
    /// The context of the scene.
    pub context: Context,
    /// Number of runs of the scene over which the set-up is distributed.
    pub runs: u64,
    /// Bound on the processor time of one integration on the window, far beyond that of an adequate one.
    pub timeout: Duration,
}

impl Problem {
    /// Returns the problem of a scene file: its first elastic model with residual compliance, and its rigid and
    /// movable-teeth models as further levels.
    pub fn of(file: &SceneFile) -> Problem {
        let elastic = file.models.iter().find(|m| is_elastic(m));
        let own: Vec<ModelWithConstants> = (file.models.iter())
            .filter(|m| file.properties_of(&m.model).fit.is_some())
            .filter(|m| m.modelling.gears.iter().all(|g| g.id() == m.model))
            .map(|m| ModelWithConstants {
                label: m.label.clone(),
                rigid: file.properties_of(&m.model).rigid,
                scene: file.spec_for(m),
                modelling: m.modelling.clone(),
            })
            .collect();
        let mut flexible = elastic.map_or_else(
            || generated(&file.spec, own.first().map(|o| &o.modelling)),
            |m| ElasticSettings {
                gears: (m.modelling.gears.iter())
                    .filter_map(ElasticParameters::of)
                    .map(|p| ElasticParameters {
                        modes: None,
                        max_frequency_hz: None,
                        target_error: None,
                        choose: None,
                        residual: None,
                        step_s: None,
                        ..p.clone()
                    })
                    .collect(),
                contacts: m.modelling.contacts.clone(),
                label: Some(m.label.clone()),
                detail: Detail::Given,
            },
        );
        if let (Some(stated), None) = (file.damping, elastic) {
            let mut modelling = super::plan::elastic(&flexible, ElasticParameters::MODES, None);
            // Without a mesh mode the levels are compared undamped, as the finding on damping says.
            if (stated.give(&file.spec, &mut modelling, &file.context.models)).is_ok() {
                let damped = modelling.gears.iter().filter_map(ElasticParameters::of);
                for (gear, damped) in flexible.gears.iter_mut().zip(damped) {
                    gear.rayleigh = damped.rayleigh;
                }
            }
        }
        Problem {
            runner: Arc::new(Runner::of(file.context.clone())),
            runs: 1,
            timeout: Duration::from_secs_f64(DEFAULT_TIMEOUT),
            name: file.name.clone(),
            scene: elastic.map_or_else(|| file.spec.clone(), |m| file.spec_for(m)),
            duration: file.duration,
            samples: file.study.samples,
            flexible,
            own,
            context: file.context.clone(),
        }
    }

    /// Time by which the force of a mesh runs ahead of the approach of its gears, the damper of a pair over its
    /// stiffness `k` [N/m], under a force [N]; see the head of the module [s].
    pub fn relaxation(&self, of: &ElasticSettings, mesh: usize, k: f64, force: f64) -> f64 {
        let ratio = (of.gears.iter())
            .filter_map(|p| p.damping_ratio)
            .fold(0.0, f64::max);
        let teeth = 2.0 * ratio / (TAU * self.tooth_frequency());
        let law = of.contacts.get(mesh).and_then(|c| c.flanks.penalty());
        let Some([penalty, dashpot]) = law else {
            return teeth;
        };
        let part = self
            .patch(mesh, penalty, force)
            .map_or(1.0, |patch| (k / patch).min(1.0));
        part * dashpot / penalty + (1.0 - part) * teeth
    }

    /// Stiffness of a patch of contact at the pitch point [N/m].
    fn patch(&self, mesh: usize, penalty: f64, force: f64) -> Option<f64> {
        let mesh = self.scene.meshes.get(mesh)?;
        let [a, b] = mesh.gears.map(|i| &self.scene.gears[i]);
        let l = mesh_layout(a, b).ok()?;
        let one = l.pitch_point;
        let radius = match &b.body {
            Body::Gear(_) => one * (l.length - one) / l.length,
            Body::Rack(_) => one,
        };
        let half = (1.5 * force * radius / (penalty * l.face_width)).cbrt();
        let k = 2.0 * half * l.face_width * penalty;
        (k.is_finite() && k > 0.0).then_some(k)
    }

    /// Computes the first natural frequency of a tooth from its size [Hz].
    pub fn tooth_frequency(&self) -> f64 {
        let modules = self.scene.gears.iter().map(|g| g.body.module());
        let largest = modules.fold(0.0, f64::max);
        TOOTH_SPEED / largest
    }
}

/// A model whose gears are all elastic and keep the compliance of cut modes, or quadrature points of its own kind.
fn is_elastic(m: &ModelChoice) -> bool {
    m.modelling
        .gears
        .iter()
        .all(|g| ElasticParameters::of(g).is_some_and(|p| p.keeps_residual()))
}

/// Returns elastic gears with generated meshes; damping and friction are those of `rigid`.
fn generated(scene: &SceneSpec, rigid: Option<&Modelling>) -> ElasticSettings {
    let [flank_elements, width_elements] = ELEMENTS.map(|(_, n)| Some(n));
    let parameters = ElasticParameters {
        mesh: MeshParameters {
            flank_elements,
            width_elements,
            ..MeshParameters::default()
        },
        ..ElasticParameters::default()
    };
    let contacts = (0..scene.meshes.len())
        .map(|mesh| {
            let given = rigid.and_then(|m| m.contacts.get(mesh));
            let damping = given
                .and_then(|c| super::statics::relaxation_of(scene, c))
                .map_or(0.0, |tau| tau * PENALTY);
            ContactSpec {
                stiffness: PairStiffness::Iso6336 {
                    variation: IsoVariation::default(),
                },
                exponent: 1.0,
                damping: Damping::None,
                normal_force: None,
                friction: given.and_then(|c| c.friction),
                slices: None,
                flanks: PointContact::new(PENALTY).damped(damping).into(),
            }
        })
        .collect();
    ElasticSettings {
        gears: vec![parameters; scene.gears.len()],
        contacts,
        label: None,
        detail: Detail::Given,
    }
}

//! A scene as the choice sees it.
//!
//! The elastic gears of the scene are what all models are meant to stand for: their mesh, material, contact and
//! damping. Where a scene has no elastic model, gears get a generated mesh and steel-like penalty; a Kelvin-Voigt ratio
//! of its rigid model becomes a dashpot of the flanks. With penalty `p` [Pa/m] and dashpot `c` [N s/m^3] per area, gears
//! without modes touch with `N = k (d + tau d')`, `tau = c/p`, for a penetration `d` of the undeformed flanks: a rigid
//! pair of stiffness `k` has the damper `tau k`, its ratio is `tau omega / 2` at the frequency of the contact.

use crate::models::models;
use crate::scene_file::{ModelChoice, SceneFile};
use gearbench_models::contact::flank_points::PointContact;
use gearbench_models::contact::law::Damping;
use gearbench_models::gear::table::Model;
use gearbench_models::scene::spec::{ContactSpec, Modelling, Parameters, SceneSpec, Value};
use gearbench_models::stiffness::{IsoVariation, PairStiffness};

/// Penalty of generated meshes [Pa/m].
pub const PENALTY: f64 = 1e15;
/// Elements of generated meshes along a flank and over the width.
pub const ELEMENTS: [(&str, f64); 2] = [("flank_elements", 12.0), ("width_elements", 2.0)];

/// What the elastic gears are made of.
#[derive(Clone, Debug)]
pub struct Flexible {
    /// Parameters of `elastic` for each gear: mesh and damping, no modes and no step.
    pub gears: Vec<Parameters>,
    /// Contacts with flank points, one per mesh.
    pub contacts: Vec<ContactSpec>,
    /// Label of the model of the scene that it is; `None` where the scene has none.
    pub label: Option<String>,
}

/// A model of the scene with constants of its own: rigid, or with movable teeth.
#[derive(Clone, Debug)]
pub struct Own {
    /// Its label.
    pub label: String,
    /// Id of its gears.
    pub model: String,
    /// The scene, with the gap of this model.
    pub scene: SceneSpec,
    /// Its models.
    pub modelling: Modelling,
}

/// A scene to choose for.
#[derive(Clone, Debug)]
pub struct Situation {
    /// Name.
    pub name: String,
    /// Gears and meshes, with the gap of the elastic model.
    pub scene: SceneSpec,
    /// Simulated time [s].
    pub duration: f64,
    /// Samples of the histories over the duration.
    pub samples: usize,
    /// The elastic gears.
    pub flexible: Flexible,
    /// Further models of the scene.
    pub own: Vec<Own>,
    /// Table of models.
    pub models: &'static [Model],
}

/// Parameters of `elastic` that a rung sets itself.
const SET_BY_RUNG: [&str; 6] = [
    "modes",
    "max_frequency_hz",
    "target_error",
    "choose",
    "residual",
    "step_s",
];

impl Situation {
    /// The situation of a scene file: its first elastic model with residual compliance, and its rigid and movable-teeth
    /// models as further rungs.
    #[must_use]
    pub fn of(file: &SceneFile) -> Situation {
        let elastic = file.models.iter().find(|m| is_elastic(m));
        let own: Vec<Own> = (file.models.iter())
            .filter(|m| ["rigid", "movable-teeth"].contains(&m.model.as_str()))
            .filter(|m| m.modelling.gears.iter().all(|g| g.id == m.model))
            .map(|m| Own {
                label: m.label.clone(),
                model: m.model.clone(),
                scene: file.spec_for(m),
                modelling: m.modelling.clone(),
            })
            .collect();
        let flexible = elastic.map_or_else(
            || generated(&file.spec, own.first().map(|o| &o.modelling)),
            |m| Flexible {
                gears: (m.modelling.gears.iter())
                    .map(|g| {
                        let mut p = g.parameters.clone();
                        p.retain(|key, _| !SET_BY_RUNG.contains(&key.as_str()));
                        p
                    })
                    .collect(),
                contacts: m.modelling.contacts.clone(),
                label: Some(m.label.clone()),
            },
        );
        Situation {
            name: file.name.clone(),
            scene: elastic.map_or_else(|| file.spec.clone(), |m| file.spec_for(m)),
            duration: file.duration,
            samples: file.study.samples,
            flexible,
            own,
            models: models(),
        }
    }

    /// Time by which the dashpot of the flanks lets the force of a mesh run ahead of the penetration, `c/p` [s].
    #[must_use]
    pub fn relaxation(&self, mesh: usize) -> f64 {
        let points = self.flexible.contacts.get(mesh).and_then(|c| c.points);
        points
            .filter(|p| !p.hard)
            .map_or(0.0, |p| p.damping / p.penalty)
    }
}

/// A model whose gears are all elastic and keep the compliance of cut modes, or quadrature points of its own kind.
fn is_elastic(m: &ModelChoice) -> bool {
    m.modelling
        .gears
        .iter()
        .all(|g| g.id == "elastic" && g.parameters.get("residual") != Some(&Value::Flag(false)))
}

/// Generated meshes; `rigid` tells the damping and the friction.
fn generated(scene: &SceneSpec, rigid: Option<&Modelling>) -> Flexible {
    let parameters: Parameters = ELEMENTS
        .iter()
        .map(|(key, n)| ((*key).to_string(), Value::Number(*n)))
        .collect();
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
                friction: given.and_then(|c| c.friction),
                slices: None,
                points: Some(PointContact {
                    damping,
                    ..PointContact::new(PENALTY)
                }),
            }
        })
        .collect();
    Flexible {
        gears: vec![parameters; scene.gears.len()],
        contacts,
        label: None,
    }
}

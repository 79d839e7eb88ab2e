//! What is loaded: models of a scene, and rigid gears with the stiffness of formulas.

use crate::scene_file::formula_limits;
use gearbench_models::gear::rigid;
use gearbench_models::gear::table::{Model, properties_of};
use gearbench_models::spec::{Modelling, SceneSpec};
use gearbench_models::stiffness::{Foundation, Hertz, IsoVariation, PairStiffness, ToothModel};

/// A model to load.
pub struct Entry {
    pub label: String,
    /// What its stiffness includes.
    pub includes: String,
    pub spec: SceneSpec,
    pub modelling: Modelling,
}

impl Entry {
    /// Formulas of its contacts that have left their range, in words; flank points have none.
    pub fn limits(&self) -> Vec<String> {
        let contacts = self.spec.meshes.iter().zip(&self.modelling.contacts);
        (contacts.filter(|(_, contact)| contact.points.is_none()))
            .flat_map(|(mesh, contact)| formula_limits(&self.spec, mesh.gears, contact))
            .collect()
    }
}

/// Rigid gears with the stiffness of the norm, and with the analytic compliance of teeth, bodies and contact, in
/// place of a model of the same gears.
pub fn formulas(spec: &SceneSpec, modelling: &Modelling) -> [Entry; 2] {
    let with = |label: &str, includes: &str, stiffness: PairStiffness| {
        let mut modelling = modelling.clone();
        modelling.gears.fill(rigid::spec());
        for contact in &mut modelling.contacts {
            contact.stiffness = stiffness.clone();
            contact.exponent = 1.0;
            contact.points = None;
        }
        Entry {
            label: label.into(),
            includes: includes.into(),
            spec: spec.clone(),
            modelling,
        }
    };
    [
        with(
            "ISO 6336-1",
            "c' of the norm with its 0.8, CR = 1, parabola with the norm's mean; for 100 N/mm and more",
            PairStiffness::Iso6336 {
                variation: IsoVariation::IsoMean,
            },
        ),
        with(
            "analytic",
            "Weber-Banaschek tooth and Hertz contact at 100 N/mm, body as an elastic ring that all pairs share",
            PairStiffness::Compliance {
                tooth: ToothModel::WeberBanaschek,
                foundation: Foundation::Ring,
                hertz: Hertz::WeberBanaschek {
                    reference_load: None,
                },
            },
        ),
    ]
}

/// What the stiffness of a modelling includes, in words.
pub fn includes(modelling: &Modelling, models: &[Model]) -> String {
    let mut gears = (modelling.gears.iter()).map(|g| properties_of(models, &g.id));
    let all_rigid = gears.clone().all(|p| p.rigid);
    let contact = modelling.contacts.first();
    if gears.any(|p| p.full_order) {
        let penalty = contact.and_then(|c| c.points).map_or(String::new(), |p| {
            format!(", penalty {:.1e} Pa/m", p.penalty)
        });
        return format!("teeth, body to the rigid bore, contact over the mesh{penalty}");
    }
    let law = contact.map_or(String::new(), |c| c.stiffness.describe());
    if all_rigid {
        law
    } else {
        format!("the model's own springs in series with {law}")
    }
}

//! The key `damping` of a scene: damping that all of its models share.
//!
//! ```toml
//! damping = { mesh_ratio = 0.02 }
//! ```
//!
//! Models receive their dampers when they are built ([`StatedDamping::give`]).

use super::error::SceneError;
use super::model::ModelTable;
use super::reading::Place;
use super::reading::keys::keys;
use super::reading::values::{OneOrMany, is_default};
use super::{ModelChoice, SceneFile};
use crate::small_signals::stated_damping::{StatedDamping, of_elements};
use gearbench_models::error::BuildError;

keys! {
    /// Damping that all models of a scene share; one of the keys.
    #[derive(Default)]
    struct SharedDampingTable {
        /// ratio of the mesh mode under the loads of the scene to critical damping, for example 0.02
        mesh_ratio: Option<f64>,
        /// in place of mesh_ratio: loss factor of the material, twice that ratio
        loss_factor: Option<f64>,
        /// in place of mesh_ratio: [alpha, beta] of the damping alpha M + beta K, in 1/s and s, which gives the mesh mode a ratio
        /// by its frequency
        rayleigh: Option<[f64; 2]>,
    }
}

/// Reads the damping of a scene.
pub(super) fn damping(
    keys: &SharedDampingTable,
    at: &Place<'_>,
) -> Result<StatedDamping, SceneError> {
    let given = [
        keys.mesh_ratio.map(StatedDamping::MeshRatio),
        keys.loss_factor.map(StatedDamping::LossFactor),
        keys.rayleigh.map(StatedDamping::Rayleigh),
    ];
    let mut given = given.into_iter().flatten();
    let Some(stated) = given.next() else {
        return Err(at.missing("mesh_ratio", &SharedDampingTable::TABLE));
    };
    if given.next().is_some() {
        return at.refuse(
            "the damping of the scene is stated more than once",
            "this table",
            "give one of `mesh_ratio`, `loss_factor` and `rayleigh`",
        );
    }
    let (key, numbers, below) = match stated {
        StatedDamping::MeshRatio(x) => ("mesh_ratio", vec![x], 1.0),
        StatedDamping::LossFactor(x) => ("loss_factor", vec![x], 2.0),
        StatedDamping::Rayleigh(both) => ("rayleigh", both.to_vec(), f64::INFINITY),
    };
    let fits = |x: &f64| (0.0..below).contains(x);
    match numbers.iter().all(fits) && numbers.iter().any(|x| *x > 0.0) {
        true => Ok(stated),
        false => at.key(key).refuse(
            format!("`{key}` has to be positive, and the mesh mode has to vibrate"),
            "this value",
            "0.001 to 0.1 are usual ratios; leave `damping` out for undamped models",
        ),
    }
}

/// Refuses a model that states the damping of a scene once more.
pub(super) fn check_once(
    keys: &ModelTable,
    choice: &ModelChoice,
    at: &Place<'_>,
) -> Result<(), SceneError> {
    let twice = |place: Place<'_>| {
        place.refuse(
            format!(
                "the damping of the model `{}` is stated by the scene already",
                choice.label
            ),
            "stated again here",
            "remove this, or `damping` of the scene",
        )
    };
    let gears = &choice.modelling.gears;
    if keys.parameters.0.iter().any(|(key, _)| key == "rayleigh") {
        return twice(at.key("parameters").key("rayleigh"));
    }
    let contacts = match &keys.contact {
        OneOrMany::One(one) => std::slice::from_ref(one),
        OneOrMany::Many(several) => several,
    };
    // Elastic gears may have dampers at their flanks as well.
    let own = contacts.iter().position(|c| !is_default(&c.damping));
    let Some(i) = own.filter(|_| !gears.iter().all(of_elements)) else {
        return Ok(());
    };
    let all = at.key("contact");
    let of_mesh = all.member(i);
    twice(match of_mesh.exists() {
        true => of_mesh.key("damping"),
        false => all.key("damping"),
    })
}

impl SceneFile {
    /// Gives models, selected by their labels, the damping of the scene without building them; warns of those that other
    /// dampers alone give more.
    ///
    /// # Errors
    /// [`SceneError`] of the first model without a mesh mode.
    pub(crate) fn damp_unbuilt(&mut self, labels: &[&str]) -> Result<(), SceneError> {
        for index in 0..self.models.len() {
            let label = self.models[index].label.clone();
            if labels.contains(&label.as_str()) {
                let more = self.damp(index).map_err(|e| self.locate_in(&label, &e))?;
                if let Some(more) = more {
                    self.context.messages.warn(&more.to_text());
                }
            }
        }
        Ok(())
    }

    /// Gives a model, by its index, the damping of the scene, once. Returns a warning where other dampers alone give its
    /// mesh mode more.
    ///
    /// # Errors
    /// [`BuildError`] of a model without a mesh mode.
    pub(super) fn damp(&mut self, index: usize) -> Result<Option<SceneError>, BuildError> {
        let (Some(stated), false) = (self.damping, self.models[index].is_damped) else {
            return Ok(None);
        };
        let (spec, models) = (
            self.spec_for(&self.models[index]),
            self.context.models.clone(),
        );
        let choice = &mut self.models[index];
        let more = stated.give(&spec, &mut choice.modelling, &models)?;
        choice.is_damped = true;
        let label = &choice.label;
        Ok(more.map(|ratio| {
            self.document.at("damping").error(
                format!(
                    "bearings and dampers of the model `{label}` alone give its mesh mode {:.2} % of critical damping, more than the scene states",
                    100.0 * ratio
                ),
                "less is stated here",
                "damp less there",
            )
        }))
    }
}

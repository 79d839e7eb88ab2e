//! Damping that a scene states once for all of its models: the ratio of the mesh mode.
//!
//! Each model gets dampers proportional to its stiffness, with a retardation time `beta`:
//!
//! | part | damper |
//! |---|---|
//! | elastic gears and full finite elements, with the contact of their flanks | `beta K`, by Rayleigh's second constant |
//! | contact between rigid gears and movable teeth | `beta k` at the load, by its damping ratio there |
//!
//! Springs of movable teeth keep the dampers that the model gives them: teeth are light, and dampers proportional to their
//! springs would be far beyond critical. If nothing else damps or gives way, the mesh mode has the ratio `beta omega / 2`;
//! dampers of bearings, hubs and modes change it, and springs of teeth and shafts add compliance. So `beta` is found by
//! iteration on the mesh mode about the loaded state ([`super::mesh_mode`]). Full finite elements have too many coordinates for it: elastic gears of the same meshes, with
//! few modes and the static compliance of the others, take their place, whose mesh mode is the same.

use super::mesh_mode::{few_modes, mesh_mode};
use gearbench_models::error::BuildError;
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_models::gear::table::Model;
use gearbench_models::law::Damping;
use gearbench_models::spec::{ModelSpec, Modelling, SceneSpec};
use gearbench_reference::full_order::FullOrderParameters;
use gearbench_reference::reduction::ElasticParameters;
use gearbench_reports::numbers::short;
use std::f64::consts::TAU;

/// Relative error of the ratio of a mesh mode, after so many trials at most.
pub const WITHIN: f64 = 1e-4;
const TRIALS: usize = 12;
/// Factor of the first value beyond which a damper does not damp the mesh mode.
const MOST: f64 = 1e3;
/// Excess of other damping over the stated ratio that is remarked.
const REMARKED: f64 = 1.03;

/// Damping of the mesh mode as a scene states it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StatedDamping {
    /// Ratio to critical damping [-].
    MeshRatio(f64),
    /// Loss factor of the material [-]: twice the ratio.
    LossFactor(f64),
    /// Rayleigh's constants `alpha` [1/s] and `beta` [s].
    Rayleigh([f64; 2]),
}

impl StatedDamping {
    /// Returns the damping ratio of a mode with an angular frequency [rad/s].
    pub fn ratio_at(self, omega: f64) -> f64 {
        match self {
            StatedDamping::MeshRatio(ratio) => ratio,
            StatedDamping::LossFactor(factor) => 0.5 * factor,
            StatedDamping::Rayleigh([alpha, beta]) => 0.5 * (alpha / omega + beta * omega),
        }
    }

    /// Returns the damping in words.
    pub fn to_text(self) -> String {
        match self {
            StatedDamping::MeshRatio(ratio) => {
                format!("mesh mode {} % of critical", short(100.0 * ratio, 3))
            }
            StatedDamping::LossFactor(factor) => {
                format!("loss factor {} at the mesh mode", short(factor, 3))
            }
            StatedDamping::Rayleigh([alpha, beta]) => format!(
                "{} 1/s times the mass and {} us times the stiffness",
                short(alpha, 3),
                short(1e6 * beta, 3)
            ),
        }
    }

    /// Sets the dampers of a model so that its mesh mode has the stated damping. Returns the ratio of other dampers where
    /// these alone give more.
    ///
    /// # Errors
    /// [`BuildError`] of a model whose mesh mode is not known or does not depend on the dampers.
    pub fn give(
        self,
        scene: &SceneSpec,
        modelling: &mut Modelling,
        models: &[Model],
    ) -> Result<Option<f64>, BuildError> {
        if let (StatedDamping::Rayleigh(both), true) = (self, is_elastic(&modelling.gears)) {
            *modelling = with_rayleigh(modelling, both);
            return Ok(None);
        }
        let analysed = analysed(modelling);
        let mode = |beta: f64, omega: f64| {
            let damped = with_dampers(&analysed, scene, beta, omega);
            let refused = |why: &str| {
                BuildError::scene((
                    format!("the damping of the scene needs the mesh mode of the model: {why}"),
                    "give each model its own damping in place of `damping` of the scene",
                ))
                .of_model()
            };
            let found = mesh_mode("", (scene, &damped), models, 0, None)
                .ok_or_else(|| refused("no load acts in the scene"))?;
            match (found.frequency_hz, found.damping_ratio) {
                (Some(f), Some(ratio)) => Ok((TAU * f, ratio)),
                _ => Err(refused(&found.message)),
            }
        };
        let (omega, without) = mode(0.0, 1.0)?;
        let ratio = self.ratio_at(omega);
        let wanted = ratio - without;
        if wanted <= WITHIN * ratio {
            *modelling = with_dampers(modelling, scene, 0.0, omega);
            return Ok(Some(without).filter(|w| *w > REMARKED * ratio));
        }
        let of_dampers = |beta: f64| Some(mode(beta, omega).ok()?.1 - without);
        let first = 2.0 * wanted / omega;
        let found = damper_for(first, (wanted, WITHIN * ratio), of_dampers).ok_or_else(|| {
            BuildError::scene((
                "no damping of teeth and contacts gives its mesh mode the damping of the scene",
                "state less, or give the model its own damping",
            ))
            .of_model()
        })?;
        *modelling = with_dampers(modelling, scene, found, omega);
        Ok(None)
    }
}

/// Returns the value of a damper, first tried at `first`, with which the mesh mode has the damping that is wanted, within
/// so much; `None` if there is none. Damping is nearly proportional to the damper, but for one behind other springs.
pub fn damper_for(
    first: f64,
    (wanted, within): (f64, f64),
    damping: impl Fn(f64) -> Option<f64>,
) -> Option<f64> {
    let mut value = first;
    for _ in 0..TRIALS {
        let found = damping(value)?;
        if (found - wanted).abs() <= within {
            return Some(value);
        }
        value *= wanted / found;
        if !(value.is_finite() && value > 0.0 && value <= MOST * first) {
            break;
        }
    }
    None
}

/// True if all gears are made of finite elements.
fn is_elastic(gears: &[ModelSpec]) -> bool {
    gears.iter().all(of_elements)
}

/// True for a gear made of finite elements, reduced or not.
pub fn of_elements(gear: &ModelSpec) -> bool {
    [ElasticParameters::MODEL, FullOrderParameters::MODEL].contains(&gear.id())
}

/// Returns a model with few coordinates that has the same mesh mode.
fn analysed(modelling: &Modelling) -> Modelling {
    let most = few_modes(modelling.gears.len());
    let few = |gear: &ModelSpec| {
        if let Some(full) = FullOrderParameters::of(gear) {
            let reduced = ElasticParameters {
                modes: Some(most),
                mesh: full.mesh.clone(),
                ..ElasticParameters::default()
            };
            return reduced.spec();
        }
        let Some(mut reduced) = ElasticParameters::of(gear).cloned() else {
            return gear.clone();
        };
        let modes = reduced.most_modes().map_or(most, |n| n.min(most));
        reduced.with_modes(modes);
        reduced.spec()
    };
    Modelling {
        gears: modelling.gears.iter().map(few).collect(),
        contacts: modelling.contacts.clone(),
    }
}

/// Returns a model with Rayleigh's constants for all of its gears of finite elements.
fn with_rayleigh(modelling: &Modelling, both: [f64; 2]) -> Modelling {
    let given = Some(both).filter(|both| *both != [0.0; 2]);
    let mut damped = modelling.clone();
    ElasticParameters::change(&mut damped, |p| p.rayleigh = given);
    FullOrderParameters::change(&mut damped, |p| p.rayleigh = given);
    damped
}

/// Returns a model with dampers of a retardation time `beta` [s]; `omega` is the frequency of its mesh mode [rad/s].
fn with_dampers(modelling: &Modelling, scene: &SceneSpec, beta: f64, omega: f64) -> Modelling {
    let mut damped = with_rayleigh(modelling, [0.0, beta]);
    for (contact, mesh) in damped.contacts.iter_mut().zip(&scene.meshes) {
        if !mesh.gears.iter().any(|g| of_elements(&modelling.gears[*g])) {
            contact.damping = match beta {
                0.0 => Damping::None,
                _ => Damping::RatioAtLoad {
                    ratio: 0.5 * beta * omega,
                },
            };
        }
    }
    damped
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::context::Context;
    use crate::scene_file::{Origin, SceneFile, shipped};

    /// A shipped scene with other words in its text.
    fn scene(name: &str, changes: &[(&str, String)]) -> SceneFile {
        let mut text = shipped::shipped(name).unwrap().text.to_owned();
        for (from, to) in changes {
            assert!(text.contains(from), "{name}: {from}");
            text = text.replace(from, to);
        }
        SceneFile::unbuilt(&Context::default(), name, &text, Origin::Shipped, true).unwrap()
    }

    /// Returns the damping ratio of the mesh mode of a model with the damping of its scene.
    fn ratio(mut file: SceneFile, label: &str) -> f64 {
        file.damp_unbuilt(&[label]).unwrap();
        let choice = file.model(label).unwrap();
        let spec = file.spec_for(choice);
        let of = (&spec, &choice.modelling);
        let mode = mesh_mode(label, of, &file.context.models, 0, None).unwrap();
        mode.damping_ratio
            .unwrap_or_else(|| panic!("{label}: {}", mode.message))
    }

    /// The mesh mode has the stated ratio in every model, however many modes elastic gears have and however they touch:
    /// spur and internal gears, and helical ones on bearings.
    #[test]
    fn every_model_has_the_stated_ratio() {
        let points = "local = \"half-space\"";
        let penalty = "penalty_pa_per_m = 1e15".to_owned();
        for stated in [0.02, 0.05, 0.1] {
            let ratio_of = |was: &'static str| (was, format!("mesh_ratio = {stated}"));
            let mut all = Vec::new();
            for label in ["rigid", "movable-teeth", "elastic"] {
                all.push((
                    label,
                    scene("loaded_mesh", &[ratio_of("mesh_ratio = 0.05")]),
                ));
                all.push((label, scene("ring_pair", &[ratio_of("mesh_ratio = 0.05")])));
            }
            for modes in [20, 140] {
                let modes = ("modes = 60", format!("modes = {modes}"));
                for contact in [None, Some((points, penalty.clone()))] {
                    let mut changes = vec![ratio_of("mesh_ratio = 0.05"), modes.clone()];
                    changes.extend(contact);
                    all.push(("elastic", scene("loaded_mesh", &changes)));
                }
            }
            if stated == 0.1 {
                all.push(("rigid", scene("helical_loaded", &[])));
                all.push(("movable-teeth", scene("helical_loaded", &[])));
            }
            for (label, file) in all {
                let name = file.name.clone();
                let found = ratio(file, label);
                assert!(
                    (found / stated - 1.0).abs() < 0.03,
                    "{name}, {label}: {found}"
                );
            }
        }
    }

    /// A loss factor is twice the ratio; Rayleigh's constants give elastic gears their damping, and others the ratio at the
    /// frequency of their own mesh mode.
    #[test]
    fn all_forms_are_ratios() {
        let with = |stated: &str| scene("loaded_mesh", &[("mesh_ratio = 0.05", stated.to_owned())]);
        let by_factor = ratio(with("loss_factor = 0.08"), "rigid");
        assert!((by_factor / 0.04 - 1.0).abs() < 1e-3, "{by_factor}");
        let beta = 1.2e-6;
        for label in ["rigid", "elastic"] {
            let file = with(&format!("rayleigh = [0.0, {beta}]"));
            let choice = file.model(label).unwrap();
            let of = (&file.spec_for(choice), &choice.modelling);
            let mode = mesh_mode(label, of, &file.context.models, 0, None).unwrap();
            let expected = 0.5 * beta * TAU * mode.frequency_hz.unwrap();
            let found = ratio(file, label);
            assert!((found / expected - 1.0).abs() < 0.01, "{label}: {found}");
        }
    }

    /// Damping without loads, twice, or of no sense is refused where it stands.
    #[test]
    fn what_cannot_be_is_refused() {
        let refused = |from: &str, to: &str| {
            let mut text = shipped::shipped("loaded_mesh").unwrap().text.to_owned();
            assert!(text.contains(from), "{from}");
            text = text.replace(from, to);
            let read = SceneFile::unbuilt(&Context::default(), "s", &text, Origin::Shipped, true);
            match read {
                Err(e) => e.to_text(),
                Ok(mut file) => file.damp_unbuilt(&["rigid"]).unwrap_err().to_text(),
            }
        };
        for (from, to, words) in [
            ("mesh_ratio = 0.05", "", "mesh_ratio"),
            ("mesh_ratio = 0.05", "mesh_ratio = 0.0", "positive"),
            ("mesh_ratio = 0.05", "mesh_ratio = 1.5", "vibrate"),
            (
                "mesh_ratio = 0.05",
                "mesh_ratio = 0.05, loss_factor = 0.1",
                "more than once",
            ),
            (
                "stiffness = \"compliance\"",
                "stiffness = \"compliance\", damping = { law = \"ratio-at-load\", ratio = 0.1 }",
                "stated by the scene already",
            ),
            (
                "modes = 60",
                "modes = 60, rayleigh = [0.0, 1e-6]",
                "stated by the scene already",
            ),
            ("loads = ", "# loads = ", "no load acts"),
        ] {
            let text = refused(from, to);
            assert!(text.contains(words), "{to}: {text}");
        }
    }
}

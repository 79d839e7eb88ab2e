//! What is identified, and how it is put into a scene.

use crate::scene_file::calibration::Constants;
use gearbench_models::error::BuildError;
use gearbench_models::gear::table::Model;
use gearbench_models::spec::{Modelling, SceneSpec};
use gearbench_reference::statics::{Load, LoadedPair, MeshCycle, StaticsError};
use serde_json::{Value, json};

/// An identified parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Identified {
    /// Key as written in scenes.
    pub key: &'static str,
    /// Value in SI units.
    pub value: f64,
    /// Half width of the 95 % confidence interval, relative.
    pub relative_95: f64,
}

/// What constants are fitted to: one of them, or both at once, each weighted by its size.
#[derive(Clone, Debug, Default)]
pub struct Target<'a> {
    /// Times [s] and contact force [N] of a reference impact.
    pub history: Option<(&'a [f64], &'a [f64])>,
    /// A mesh cycle at rest.
    pub statics: Option<StaticTarget>,
}

/// Compliances of the mesh under a load at even positions over one base pitch: tangents, as facets of finite-element
/// flanks shift the transmission error itself.
#[derive(Clone, Debug, PartialEq)]
pub struct StaticTarget {
    /// Force along the line of action [N].
    pub force: f64,
    /// Tangent compliance along the line of action at each position [m/N].
    pub compliance: Vec<f64>,
}

impl StaticTarget {
    /// That of a model of a scene.
    ///
    /// # Errors
    /// [`StaticsError`] where it cannot be loaded.
    pub fn of(
        (spec, modelling): (&SceneSpec, &Modelling),
        models: &[Model],
        force: f64,
        positions: usize,
    ) -> Result<Self, StaticsError> {
        let mut pair = LoadedPair::new(spec, modelling, models)?;
        let cycle = MeshCycle::solve(&mut pair, Load::Force(force), positions, |_| {})?;
        Ok(StaticTarget {
            force,
            compliance: cycle.tangent.iter().map(|k| k.recip()).collect(),
        })
    }
}

/// The result of an identification.
#[derive(Clone, Debug, PartialEq)]
pub struct Identification {
    /// Parameters.
    pub parameters: Vec<Identified>,
    /// Relative L2 error of the force history with them, where it was fitted.
    pub force_l2: Option<f64>,
    /// Relative L2 error of the static compliance over a mesh cycle, where it was fitted.
    pub static_l2: Option<f64>,
    /// Integrations done.
    pub evaluations: u32,
}

impl Identification {
    /// The same for programs.
    pub fn told(&self, label: &str) -> Value {
        let parameters: Vec<Value> = (self.parameters.iter())
            .map(|p| json!({ "key": p.key, "value": p.value, "relative_95": p.relative_95 }))
            .collect();
        json!({
            "model": label,
            "force_l2": self.force_l2,
            "static_l2": self.static_l2,
            "evaluations": self.evaluations,
            "parameters": parameters,
        })
    }
}

/// Why nothing could be identified.
#[derive(Debug, thiserror::Error)]
pub enum IdentifyError {
    /// The scene cannot be assembled.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// There is no recipe for the model.
    #[error("there is nothing to identify for the model `{0}`; {known} have stiffness to fit", known = .1.join(" and "))]
    Model(String, Vec<&'static str>),
    /// The model that statics are fitted to cannot be loaded.
    #[error(transparent)]
    Statics(#[from] StaticsError),
    /// The reference has no force.
    #[error("the reference has no contact force to fit to")]
    NoForce,
    /// No start led to a fit.
    #[error("the fit failed from every start: {0}")]
    Failed(String),
}

/// Puts identified values into a scene and its models, as a calibration with them would be.
pub fn apply(values: &[(&str, f64)], model: &str, spec: &mut SceneSpec, modelling: &mut Modelling) {
    let constants = Constants::of(values.iter().copied());
    constants.apply(model, modelling);
    if let Some(gap) = constants.gap {
        for m in &mut spec.meshes {
            m.start.gap = gap;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene_file::calibration::{GAP, STIFFNESS};
    use crate::scene_file::{Selection, load_for};
    use gearbench_models::stiffness::{PairOrMesh, PairStiffness};

    /// What is fitted is what a calibration with the same constants is: one spring of the mesh stays one.
    #[test]
    fn constants_mean_the_same_in_a_fit_and_in_a_calibration() {
        let scene = load_for("spur_impact", Selection::None).unwrap();
        let mut modelling = scene.model("rigid").unwrap().modelling.clone();
        modelling.contacts[0].stiffness = PairStiffness::Constant {
            per_width: 1e10,
            of: PairOrMesh::Mesh,
        };
        let (mut fitted, mut spec) = (modelling.clone(), scene.spec.clone());
        let values = [(STIFFNESS, 2e10), (GAP, 3e-6)];
        apply(&values, "rigid", &mut spec, &mut fitted);
        Constants::of(values).apply("rigid", &mut modelling);
        let expected = PairStiffness::Constant {
            per_width: 2e10,
            of: PairOrMesh::Mesh,
        };
        assert_eq!(fitted.contacts[0].stiffness, expected);
        assert_eq!(modelling.contacts[0].stiffness, expected);
        assert_eq!(spec.meshes[0].start.gap, 3e-6);
    }
}

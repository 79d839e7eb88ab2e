//! Plan of an identification: the data sets, the model and its parameters, and the result.

use super::fit_parameters::FitParameters;
use super::parameters::FitOptions;
use crate::experiment::error::ModelRefusal;
use crate::experiment::journal::JournalError;
use crate::experiment::key::Key;
use crate::scene_file::calibration::Constants;
use crate::scene_file::changes::{KeyPath, set_at};
use crate::scene_file::{ReferenceConditions, SceneError, SceneFile};
use gearbench_integrators::table::DOPRI5;
use gearbench_integrators::{Scheme, StepError};
use gearbench_models::error::BuildError;
use gearbench_models::gear::table::Model;
use gearbench_models::spec::{Modelling, SceneSpec};
use gearbench_reference::data::Quantity;
use gearbench_reference::statics::{Load, LoadedPair, MeshCycle, StaticsError};
use gearbench_reports::identify::FitRecord;

/// Data set that a model is fitted to, or compared with.
#[derive(Clone, Debug)]
pub struct DataSet {
    /// Name of the data set.
    pub name: String,
    /// Name of the recorder, whose sensors share a clock.
    pub recorder: String,
    /// Gears, speeds and loads under which the data were recorded.
    pub spec: SceneSpec,
    /// Measured or computed values.
    pub data: Data,
    /// Weight of the residuals, relative to the size of the data.
    pub weight: f64,
    /// Weight of a residual at the greatest value over that at zero; it increases with the square of the value.
    pub peak_weight: f64,
    /// Gap at the start of these data minus the fitted gap of the scene [m].
    pub further_gap: f64,
    /// Conditions of the data that differ from those of the scene.
    pub conditions: ReferenceConditions,
}

/// Values of a data set.
#[derive(Clone, Debug)]
pub enum Data {
    /// A quantity over time.
    History {
        /// The quantity: a contact force, a speed, an angle or a torque.
        quantity: Quantity,
        /// Sample times [s], ascending.
        time: Vec<f64>,
        /// Values at these times in SI units.
        values: Vec<f64>,
    },
    /// A mesh cycle at rest.
    Statics(StaticTarget),
}

impl DataSet {
    /// Creates a data set from a history of the contact force of the first mesh of a scene.
    pub fn history(name: &str, spec: &SceneSpec, time: &[f64], force: &[f64]) -> Self {
        let data = Data::History {
            quantity: Quantity::Force(0),
            time: time.to_vec(),
            values: force.to_vec(),
        };
        Self::of(name, spec, data)
    }

    /// Creates a data set with a weight of one, under the conditions of the scene.
    pub fn of(name: &str, spec: &SceneSpec, data: Data) -> Self {
        DataSet {
            name: name.into(),
            recorder: name.into(),
            spec: spec.clone(),
            data,
            weight: 1.0,
            peak_weight: 1.0,
            further_gap: 0.0,
            conditions: ReferenceConditions::default(),
        }
    }

    /// Creates a data set from a static mesh cycle of a scene.
    pub fn statics(name: &str, spec: &SceneSpec, target: StaticTarget) -> Self {
        Self::of(name, spec, Data::Statics(target))
    }

    /// Returns the values that are compared with the model.
    pub fn values(&self) -> &[f64] {
        match &self.data {
            Data::History { values, .. } => values,
            Data::Statics(target) => &target.compliance,
        }
    }

    /// Returns the length of a history [s]; 0 for other data.
    pub fn duration(&self) -> f64 {
        match &self.data {
            Data::History { time, .. } => {
                let ends = time.first().zip(time.last());
                ends.map_or(0.0, |(a, b)| b - a)
            }
            Data::Statics(_) => 0.0,
        }
    }

    /// Returns the weights of the residuals: `w p_i/|p y|` with `p_i = 1 + (p - 1)(y_i/max y)^2`.
    pub fn factors(&self) -> Vec<f64> {
        let y = self.values();
        let most = y.iter().fold(0.0_f64, |a, y| a.max(y.abs()));
        let of = |y: &f64| 1.0 + (self.peak_weight - 1.0) * (y / most).powi(2);
        let all: Vec<f64> = y.iter().map(of).collect();
        let weighed: Vec<f64> = y.iter().zip(&all).map(|(y, p)| y * p).collect();
        let over = self.weight / size(&weighed);
        all.iter().map(|p| over * p).collect()
    }

    /// Returns a key to the values: equal numbers have equal keys.
    pub fn key(&self) -> Key {
        Key::new("data").and(&self.data)
    }

    /// Returns the root of the sum of the squared values.
    pub fn size(&self) -> f64 {
        size(self.values())
    }
}

/// Computes the root of the sum of squares.
pub fn size(y: &[f64]) -> f64 {
    y.iter().map(|y| y * y).sum::<f64>().sqrt()
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
    /// Computes the mesh cycle of a model of a scene under a static force [N].
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

/// Plan of a fit: the model, its data and the user options.
#[derive(Clone, Debug)]
pub struct FitPlan {
    /// Label of the model in its scene.
    pub label: String,
    /// Gear models and contacts; the model of the first gear is the one whose constants are fitted.
    pub modelling: Modelling,
    /// Method by which trials are integrated.
    pub method: Scheme,
    /// The scene file, whose keys can be fitted.
    pub scene: SceneFile,
    /// Data sets to fit, at least one.
    pub data: Vec<DataSet>,
    /// Data that the fitted model is compared with.
    pub held_out: Vec<DataSet>,
    /// User options: parameters to fit, fixed values, starts and bounds.
    pub wishes: FitOptions,
}

/// Tolerance of the integration inside a fit: differences of two runs are to have three digits.
const RTOL: f64 = 1e-8;

/// Returns the method by which trials are integrated unless the user chooses another.
pub fn default_method() -> Scheme {
    DOPRI5.at_tolerance(RTOL)
}

impl FitPlan {
    /// Creates a plan without data and options.
    pub fn new(scene: SceneFile, label: &str, modelling: &Modelling) -> Self {
        FitPlan {
            label: label.to_owned(),
            modelling: modelling.clone(),
            method: default_method(),
            scene,
            data: Vec::new(),
            held_out: Vec::new(),
            wishes: FitOptions::default(),
        }
    }

    /// Returns the gear model whose parameters are fitted: that of the label, else that of the gears.
    pub fn model(&self) -> &str {
        let of_label = self
            .scene
            .model(&self.label)
            .map(|choice| choice.model.as_str());
        let mut gears = self.modelling.gears.iter();
        let is_used = |id: &&str| self.modelling.gears.iter().any(|g| g.id() == *id);
        (of_label.filter(is_used)).unwrap_or_else(|| gears.next().map_or("", |g| g.id()))
    }

    /// Returns the plan without data, and a data set, with values of keys of the scene.
    ///
    /// # Errors
    /// [`IdentifyError::Scene`] where the scene with these values is not valid.
    pub fn changed(
        &self,
        set: &DataSet,
        keys: &[(KeyPath, f64)],
    ) -> Result<(FitPlan, DataSet), IdentifyError> {
        let wrong = |why: String| IdentifyError::Scene(why);
        let scene = scene_with(&self.scene, &self.label, keys).map_err(wrong)?;
        let choice = scene.model(&self.label);
        let choice = choice.ok_or_else(|| wrong(format!("there is no model `{}`", self.label)))?;
        let own = scene.with(&set.conditions);
        let own = own.map_err(|(key, why, _)| wrong(format!("`{key}`: {why}")))?;
        let set = DataSet {
            spec: own.spec_for(choice),
            ..set.clone()
        };
        let modelling = choice.modelling.clone();
        let plan = FitPlan {
            method: self.method,
            ..FitPlan::new(scene, &self.label, &modelling)
        };
        Ok((plan, set))
    }
}

/// Returns a scene with values of its keys, and with its damping for one of its models.
///
/// # Errors
/// A text about what is not valid.
pub fn scene_with(
    scene: &SceneFile,
    label: &str,
    keys: &[(KeyPath, f64)],
) -> Result<SceneFile, String> {
    let text = text_with(scene, keys)?;
    let of_file = |e: SceneError| e.to_text();
    let mut changed = scene.with_text(&text).map_err(of_file)?;
    changed.damp_unbuilt(&[label]).map_err(of_file)?;
    Ok(changed)
}

/// Returns the text of a scene with values of its keys.
///
/// # Errors
/// A sentence about a key that does not exist.
pub fn text_with(scene: &SceneFile, keys: &[(KeyPath, f64)]) -> Result<String, String> {
    let document = scene.text().parse::<toml_edit::DocumentMut>();
    let mut document = document.map_err(|e| e.to_string())?;
    for (key, x) in keys {
        set_at(&mut document, key, &(*x).into())?;
    }
    Ok(document.to_string())
}

/// Result of an identification: record, constants and data.
#[derive(Clone, Debug)]
pub struct Identification {
    /// Record of the fit for reports.
    pub record: FitRecord,
    /// Values of all parameters at the minimum, those that are not identifiable included.
    pub all: Constants,
    /// Values of the keys of the scene at the minimum, with whether the data determine each.
    pub keys: Vec<(KeyPath, f64, bool)>,
    /// Parameters of the fit with their starting points.
    pub chosen: FitParameters,
    /// Names of the data that were fitted, each with a key to its values.
    pub data: Vec<(String, Key)>,
}

impl Identification {
    /// Returns the constants that the data determine.
    pub fn constants(&self) -> Constants {
        let known =
            (self.record.parameters.iter().zip(&self.chosen.parameters)).filter_map(|(p, of)| {
                match of {
                    super::parameters::Parameter::Constant(key) => Some((key.as_str(), p.value?)),
                    super::parameters::Parameter::Key(_)
                    | super::parameters::Parameter::Clock(_)
                    | super::parameters::Parameter::ClockScale(_) => None,
                }
            });
        Constants::of(known)
    }
}

/// Error of an identification.
#[derive(Debug, thiserror::Error)]
pub enum IdentifyError {
    /// The scene cannot be assembled.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The model has no constants to identify.
    #[error("the model `{0}` has nothing to identify; {known} have a stiffness to fit", known = .1.join(" and "))]
    Model(String, Vec<&'static str>),
    /// A key is none that can be fitted.
    #[error("`{0}` cannot be fitted for the model `{1}`; there are {known}", known = .2.join(", "))]
    Key(String, String, Vec<&'static str>),
    /// The contact has no stiffness along a path.
    #[error(
        "`{0}` cannot be fitted: this model has contact at flank points, with a penalty but without a stiffness along the path of contact"
    )]
    NoPath(String),
    /// The course of a stiffness that is not known.
    #[error(
        "`{0}` cannot be fitted alone: it describes the variation of a stiffness, which is neither \"constant\" nor \"parabola\" here; fit or fix `stiffness_n_per_m2` too"
    )]
    Course(String),
    /// A constant of one gear, of a model whose gears have none.
    #[error("`{0}` cannot be fitted: gears of the model `{1}` have no constants of their own")]
    NothingOfGears(String, String),
    /// The key refers to an unknown gear, or to a gear with another model.
    #[error("`{0}` cannot be fitted: it does not belong to a gear of the model `{1}`; there are {known}", known = .2.join(", "))]
    Gear(String, String, Vec<String>),
    /// A key that no gear has.
    #[error("`{0}` cannot be fitted: `{1}` is not a constant of a gear; there are {known}", known = .2.join(", "))]
    KeyOfGear(String, String, Vec<&'static str>),
    /// A value cannot be one of the parameter.
    #[error("`{0}` cannot be {1:e}")]
    Value(String, f64),
    /// The model that statics are fitted to cannot be loaded.
    #[error(transparent)]
    Statics(#[from] StaticsError),
    /// The model cannot be integrated over the data.
    #[error("{0}{hint}", hint = way_out_of(.0))]
    Step(#[from] StepError),
    /// Finished pieces cannot be read or kept.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The scene is not valid with values of its keys.
    #[error("{0}")]
    Scene(String),
    /// A path leads to no key of the scene.
    #[error("{0}")]
    Path(String),
    /// A key of the scene without a number to start from.
    #[error(
        "`{0}` has no value above zero in the scene to start from: give one with --start {0}=VALUE, or --bounds {0}=LOW:HIGH for a value of any sign"
    )]
    NoStart(String),
    /// The data have no force.
    #[error("{0} has no values to fit to")]
    NoForce(String),
    /// The run of a trial does not reach the end of the data.
    #[error("the run ends before {0}")]
    Short(String),
    /// The fit failed from every starting point.
    #[error("the fit failed from every start: {0}")]
    Failed(String),
}

/// Returns a way out of a trial that takes too many steps.
fn way_out_of(e: &StepError) -> &'static str {
    match e {
        StepError::Timeout { .. } => {
            "; an implicit method with a step gets through a stiff train, for example --integrator generalised-alpha@1e-4"
        }
        _ => "",
    }
}

impl ModelRefusal for IdentifyError {
    fn refusal(&self) -> Option<String> {
        match self {
            IdentifyError::Build(e) => e.refusal(),
            IdentifyError::Statics(_)
            | IdentifyError::Scene(_)
            | IdentifyError::Step(_)
            | IdentifyError::Short(_)
            | IdentifyError::Failed(_) => Some(self.to_string()),
            // Wishes, data and files are not of one model.
            _ => None,
        }
    }
}

impl IdentifyError {
    /// True if the user asked for a parameter or value that the model does not have.
    pub fn is_of_wishes(&self) -> bool {
        use IdentifyError::{
            Course, Gear, Key, KeyOfGear, Model, NoPath, NoStart, NothingOfGears, Path, Value,
        };
        matches!(
            self,
            Model(..)
                | Key(..)
                | Value(..)
                | NoPath(..)
                | NoStart(..)
                | Path(..)
                | Course(..)
                | NothingOfGears(..)
                | Gear(..)
                | KeyOfGear(..)
        )
    }
}

/// Applies constants to a scene and its models, as a calibration with the same constants does.
///
/// # Errors
/// A parameter that the model does not have.
pub fn apply(
    constants: &Constants,
    model: &str,
    spec: &mut SceneSpec,
    modelling: &mut Modelling,
) -> Result<(), BuildError> {
    let names: Vec<&str> = spec.gears.iter().map(|g| g.name.as_str()).collect();
    constants.apply(model, &names, modelling)?;
    if let Some(gap) = constants.gap {
        for m in &mut spec.meshes {
            m.start.gap = gap;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::context::Context;
    use crate::scene_file::calibration::{GAP, STIFFNESS};
    use crate::scene_file::{Selection, load_for};
    use gearbench_models::stiffness::{PairOrMesh, PairStiffness};

    /// A fit applies constants as a calibration does: a constant mesh stiffness stays a constant mesh stiffness.
    #[test]
    fn constants_mean_the_same_in_a_fit_and_in_a_calibration() {
        let scene = load_for(&Context::default(), "spur_impact", Selection::None).unwrap();
        let mut modelling = scene.model("rigid").unwrap().modelling.clone();
        modelling.contacts[0].stiffness = PairStiffness::Constant {
            per_width: 1e10,
            of: PairOrMesh::Mesh,
        };
        let (mut fitted, mut spec) = (modelling.clone(), scene.spec.clone());
        let values = Constants::of([(STIFFNESS, 2e10), (GAP, 3e-6)]);
        apply(&values, "rigid", &mut spec, &mut fitted).unwrap();
        let names = ["pinion", "wheel"];
        values.apply("rigid", &names, &mut modelling).unwrap();
        let expected = PairStiffness::Constant {
            per_width: 2e10,
            of: PairOrMesh::Mesh,
        };
        assert_eq!(fitted.contacts[0].stiffness, expected);
        assert_eq!(modelling.contacts[0].stiffness, expected);
        assert_eq!(spec.meshes[0].start.gap, 3e-6);
    }
}

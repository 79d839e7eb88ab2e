//! Parameters that can be fitted, with key, unit, effect on the scene, starting value and bounds.
//!
//! | key | of | coordinate |
//! |---|---|---|
//! | `stiffness_n_per_m2` | contact: stiffness of a tooth pair per face width | logarithm |
//! | `damping_ns_per_m` | contact: linear dashpot of Kelvin and Voigt | linear, at least 0 |
//! | `gap_m` | gap at the start, which is the touch time of an impact | linear, at least 0 |
//! | `path_slope`, `path_curvature` | contact: course of that stiffness along the path of contact | linear |
//! | `clock_s` | offset of the clock of a recorder, one per recorder, never written | linear |
//! | `clock_scale` | seconds of the scene over seconds of the recorder, one per recorder, never written | logarithm |
//! | path of a key of the scene, as `shafts.*.damping_s` | number at every place that it names | logarithm; linear where bounds are given and the value is not positive |
//! | any positive parameter of the gear model | gears that take the model | logarithm; dampers linear |
//! | `GEAR.` and such a parameter | that gear alone | likewise |

use super::estimate::coordinates::{Coordinate, Scale};
use super::fit_parameters::FitParameters;
use super::plan::{Data, DataSet, FitPlan, IdentifyError};
use crate::scene_file::SceneFile;
use crate::scene_file::calibration::{CURVATURE, DAMPING, GAP, SLOPE, STIFFNESS, of_gear};
use crate::scene_file::changes::{KeyPath, numbers_at};
use gearbench_models::gear::properties::{Fit, Start};
use gearbench_models::gear::table::{Model, properties_of};
use gearbench_models::spec::{ContactSpec, FlankContact, Modelling, SceneSpec};
use gearbench_models::stiffness::PairStiffness;

/// Key of the clock offset of a recorder.
pub const CLOCK: &str = "clock_s";
/// Key of the scale of the clock of a recorder.
pub const CLOCK_SCALE: &str = "clock_scale";
/// Bounds of that scale: clocks of instruments agree to far less than a tenth.
const SCALES: [f64; 2] = [0.9, 1.1];
/// Stiffness of a tooth pair that fits start from [N/m per m]: steel has about that whatever the module.
const PAIR: f64 = 1.5e10;
/// Gap from which on it is its own typical size [m].
const LEAST_GAP: f64 = 1e-7;
/// Damping of a contact and of a tooth to start from [N s/m].
const DAMPER: f64 = 50.0;
/// Typical slope and curvature of a stiffness along the path: norms give a parabola that falls by about so much.
const COURSE: f64 = 0.3;
/// Typical offset of a clock over the duration of the data.
const OFFSET: f64 = 0.02;

/// Parameter of a fit: a constant of the model, a key of the scene, or the clock of a recorder.
#[derive(Clone, Debug, PartialEq)]
pub enum Parameter {
    /// A constant of a calibration, by its key.
    Constant(String),
    /// The offset of the clock of a recorder, by its first data set.
    Clock(usize),
    /// The scale of the clock of a recorder, by its first data set.
    ClockScale(usize),
    /// A number of the scene file, at every place that a path names.
    Key(KeyPath),
}

/// User options of a fit that replace the defaults.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FitOptions {
    /// Keys to fit; `None` takes those of the model that the data may determine.
    pub fit: Option<Vec<String>>,
    /// Keys with their fixed values.
    pub held: Vec<(String, f64)>,
    /// Keys with their starting values.
    pub starts: Vec<(String, f64)>,
    /// Keys with their least and greatest value.
    pub bounds: Vec<(String, [f64; 2])>,
    /// Number of further starting points, scattered about those of the model.
    pub scattered: usize,
    /// True if profiles of all parameters are computed.
    pub profiles: bool,
}

impl Parameter {
    /// Returns the key of the parameter; the key of a clock contains the name of the data.
    pub fn key(&self, data: &[DataSet]) -> String {
        match self {
            Parameter::Key(path) => path.to_string(),
            Parameter::Constant(key) => key.clone(),
            Parameter::Clock(i) => of_recorder(CLOCK, *i, data),
            Parameter::ClockScale(i) => of_recorder(CLOCK_SCALE, *i, data),
        }
    }

    /// Returns the name of the parameter in words.
    pub fn name(&self, data: &[DataSet]) -> String {
        match self {
            Parameter::Clock(i) => of_recorder("clock offset", *i, data),
            Parameter::ClockScale(i) => of_recorder("clock scale", *i, data),
            Parameter::Key(path) => match path.names() {
                [of @ .., key] => format!("{} of {}", words(key).0, of.join(" ")),
                [] => String::new(),
            },
            Parameter::Constant(key) => match key.as_str() {
                STIFFNESS => "contact stiffness".into(),
                DAMPING => "contact damping".into(),
                GAP => "gap at the start".into(),
                SLOPE => "stiffness slope along the path".into(),
                CURVATURE => "stiffness curvature along the path".into(),
                other => match of_gear(other) {
                    (Some(gear), key) => format!("{} of {gear}", words(key).0),
                    (None, key) => words(key).0,
                },
            },
        }
    }

    /// Returns the unit of the parameter.
    pub fn unit(&self) -> String {
        match self {
            Parameter::Clock(_) => "s".into(),
            Parameter::ClockScale(_) => "1".into(),
            Parameter::Key(path) => path.names().last().map_or("", |key| words(key).1).into(),
            Parameter::Constant(key) => words(key).1.into(),
        }
    }

    /// True if the parameter is the constant with this key.
    pub fn is(&self, key: &str) -> bool {
        matches!(self, Parameter::Constant(own) if own == key)
    }
}

/// A word about the clock of a recorder, with its name where there are several.
fn of_recorder(word: &str, set: usize, data: &[DataSet]) -> String {
    match is_one_recorder(data) {
        true => word.into(),
        false => {
            let name = data.get(set).map_or("", |d| d.recorder.as_str());
            format!("{word} of {name}")
        }
    }
}

/// True if all data are of one recorder.
fn is_one_recorder(data: &[DataSet]) -> bool {
    data.windows(2).all(|d| d[0].recorder == d[1].recorder)
}

/// A key in words, and the unit at its end.
fn words(key: &str) -> (String, &'static str) {
    const UNITS: [(&str, &str); 12] = [
        ("_nm_per_rad", "N\u{b7}m/rad"),
        ("_nms_per_rad", "N\u{b7}m\u{b7}s/rad"),
        ("_nm", "N\u{b7}m"),
        ("_rad", "rad"),
        ("_n_per_m2", "N/m\u{b2}"),
        ("_n_per_m", "N/m"),
        ("_ns_per_m", "N\u{b7}s/m"),
        ("_kgm2", "kg\u{b7}m\u{b2}"),
        ("_kg", "kg"),
        ("_rad_s", "rad/s"),
        ("_m", "m"),
        ("_s", "s"),
    ];
    let found = (UNITS.iter()).find_map(|(end, unit)| Some((key.strip_suffix(end)?, *unit)));
    let (stem, unit) = found.unwrap_or((key, ""));
    (stem.replace('_', " "), unit)
}

/// Number of [`keys`] that belong to the scene; the others belong to the model of a gear.
const OF_SCENE: usize = 7;

/// The keys that can be fitted in a model.
fn keys(model: &Model) -> Vec<&'static str> {
    let own = model.parameters.iter().map(|p| p.key);
    let known = model.properties.fit.map_or(&[][..], |f| f.parameters);
    let dampers = own.filter(|k| k.ends_with("_ns_per_m"));
    let mut all = vec![
        STIFFNESS,
        DAMPING,
        GAP,
        SLOPE,
        CURVATURE,
        CLOCK,
        CLOCK_SCALE,
    ];
    all.extend(known);
    all.extend(dampers);
    all
}

/// Returns the largest gap of the meshes at the start \[m\].
pub(super) fn largest_gap(spec: &SceneSpec) -> Option<f64> {
    spec.meshes.iter().map(|m| m.start.gap).reduce(f64::max)
}

fn coordinate(key: &str, spec: &SceneSpec, duration: f64) -> Coordinate {
    let (scale, bounds) = match key {
        GAP => {
            let gap = largest_gap(spec).unwrap_or(0.0);
            (Scale::Linear(gap.max(LEAST_GAP)), [0.0, f64::INFINITY])
        }
        CLOCK => (Scale::Linear(OFFSET * duration), [-duration, duration]),
        CLOCK_SCALE => (Scale::Logarithm, SCALES),
        SLOPE | CURVATURE => (Scale::Linear(COURSE), [f64::NEG_INFINITY, f64::INFINITY]),
        k if k.ends_with("_ns_per_m") => (Scale::Linear(DAMPER), [0.0, f64::INFINITY]),
        _ => (Scale::Logarithm, [0.0, f64::INFINITY]),
    };
    Coordinate { scale, bounds }
}

/// Tables of a scene whose keys can be fitted.
const TABLES: [&str; 6] = ["gears", "meshes", "shafts", "stages", "models", "damping"];

/// Returns the path of a key of the scene; `None` for a constant of the model.
pub fn path_of(key: &str) -> Option<KeyPath> {
    let path = KeyPath::parse(key).ok()?;
    let [first, _, ..] = path.names() else {
        return None;
    };
    TABLES.contains(&first.as_str()).then_some(path)
}

/// Returns the coordinate and the starting value of a key of the scene.
fn of_scene(
    path: &KeyPath,
    scene: &SceneFile,
    start: Option<f64>,
    bounds: Option<[f64; 2]>,
) -> Result<(Coordinate, f64), IdentifyError> {
    let document = scene.text().parse::<toml_edit::DocumentMut>();
    let document = document.map_err(|e| IdentifyError::Scene(e.to_string()))?;
    let present = numbers_at(&document, path).map_err(IdentifyError::Path)?;
    let start = start.or(present.first().copied());
    match (start, bounds) {
        (Some(x), bounds) if x > 0.0 && bounds.is_none_or(|[low, _]| low >= 0.0) => {
            let bounds = bounds.unwrap_or([0.0, f64::INFINITY]);
            let scale = Scale::Logarithm;
            Ok((Coordinate { scale, bounds }, x))
        }
        (start, Some(bounds)) if bounds.iter().all(|x| x.is_finite()) => {
            let scale = Scale::Linear(0.1 * (bounds[1] - bounds[0]));
            let middle = 0.5 * (bounds[0] + bounds[1]);
            Ok((Coordinate { scale, bounds }, start.unwrap_or(middle)))
        }
        _ => Err(IdentifyError::NoStart(path.to_string())),
    }
}

/// A model of which keys of the scene alone are fitted.
const NOTHING: Fit = Fit {
    parameters: &[],
    starts: |contact, _| {
        vec![Start {
            contact,
            parameters: Vec::new(),
        }]
    },
};

/// Selects the parameters of a fit, with their starting points and bounds.
///
/// # Errors
/// [`IdentifyError`] for a model without a recipe, a key that it has not, or a value that cannot be.
pub fn choose(
    (spec, modelling, models): (&SceneSpec, &Modelling, &[Model]),
    plan: &FitPlan,
) -> Result<FitParameters, IdentifyError> {
    let (scene, data, wishes) = (&plan.scene, &plan.data, &plan.wishes);
    let id = plan.model();
    let of_scene_alone = (wishes.fit.as_ref()).is_some_and(|keys| {
        let is_clock = |k: &String| k == CLOCK || k == CLOCK_SCALE;
        keys.iter().all(|k| is_clock(k) || path_of(k).is_some())
    });
    let recipe = (properties_of(models, id).fit).or(of_scene_alone.then_some(NOTHING));
    let (Some(recipe), Some(model)) = (recipe, models.iter().find(|m| m.id == id)) else {
        let known = models.iter().filter(|m| m.properties.fit.is_some());
        return Err(IdentifyError::Model(
            id.into(),
            known.map(|m| m.id).collect(),
        ));
    };
    let histories: Vec<usize> = (data.iter().enumerate())
        .filter(|(_, d)| matches!(d.data, Data::History { .. }))
        .map(|(i, _)| i)
        .collect();
    // Statics alone cannot tell springs in series apart, nor masses and gaps.
    let default: Vec<String> = match histories.is_empty() {
        true => vec![STIFFNESS.into()],
        false => ([&[STIFFNESS], recipe.parameters, &[GAP]]
            .concat()
            .into_iter())
        .map(str::to_owned)
        .collect(),
    };
    let mut wanted = wishes.fit.clone().unwrap_or(default);
    for (key, _) in &wishes.held {
        if !wanted.contains(key) {
            wanted.push(key.clone());
        }
    }
    let named = [&wishes.held, &wishes.starts];
    let named = (named.into_iter().flatten().map(|(k, _)| k))
        .chain(wishes.bounds.iter().map(|(k, _)| k))
        .chain(&wanted);
    for key in named.filter(|key| path_of(key).is_none()) {
        check(key, model, (spec, modelling, models))?;
    }
    let course = |key: &String| key == SLOPE || key == CURVATURE;
    if let Some(key) = wanted.iter().find(|key| course(key))
        && !wanted.iter().any(|key| key == STIFFNESS)
        && present(STIFFNESS, spec, modelling, id).is_none()
    {
        return Err(IdentifyError::Course(key.clone()));
    }
    // Where gears start: the first that takes the model for all, each for itself.
    let starts_of = |name: Option<&str>| {
        let takes = (spec.gears.iter().zip(&modelling.gears)).filter(|(_, m)| m.id() == id);
        let mut takes = takes.map(|(gear, _)| gear);
        let gear = takes.find(|gear| name.is_none_or(|name| name == gear.name));
        gear.map_or_else(Vec::new, |gear| (recipe.starts)(PAIR, gear))
    };
    let count = starts_of(None).len();

    let first_of = |d: &DataSet| {
        let same = data.iter().position(|other| other.recorder == d.recorder);
        same.unwrap_or_default()
    };
    let mut chosen = FitParameters {
        recorders: data.iter().map(first_of).collect(),
        ..FitParameters::default()
    };
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for key in &wanted {
        let given = |list: &[(String, f64)]| list.iter().find(|(k, _)| k == key).map(|(_, x)| *x);
        let held = given(&wishes.held);
        if let Some(path) = path_of(key) {
            let bounds = wishes.bounds.iter().find(|(k, _)| k == key).map(|b| b.1);
            let start = held.or(given(&wishes.starts));
            let (coordinate, start) = of_scene(&path, scene, start, bounds)?;
            chosen.parameters.push(Parameter::Key(path));
            chosen.coordinates.push(coordinate);
            chosen.free.push(held.is_none());
            chosen.held.push(held);
            columns.push(vec![start; count]);
            continue;
        }
        let duration = data.iter().map(DataSet::duration).fold(0.0, f64::max);
        let mut coordinate = coordinate(key, spec, duration.max(f64::MIN_POSITIVE));
        if let Some((_, bounds)) = wishes.bounds.iter().find(|(k, _)| k == key) {
            coordinate.bounds = *bounds;
        }
        let (of, own_key) = of_gear(key);
        let of_model = starts_of(of);
        let place = recipe.parameters.iter().position(|k| *k == own_key);
        let present = present(key, spec, modelling, id);
        // Springs and masses start as the model says, all else as the scene has it.
        let start = |i: usize| {
            held.or(given(&wishes.starts)).or_else(|| {
                let of = of_model.get(i)?;
                match (key.as_str(), place) {
                    (STIFFNESS, _) => Some(of.contact),
                    (_, Some(place)) if histories.is_empty() => {
                        present.or(of.parameters.get(place).copied())
                    }
                    (_, Some(place)) => of.parameters.get(place).copied(),
                    (CLOCK, _) => Some(0.0),
                    (CLOCK_SCALE, _) => Some(1.0),
                    (SLOPE | CURVATURE, _) => present.or(Some(0.0)),
                    _ => present.or(Some(DAMPER)),
                }
            })
        };
        let column: Vec<f64> = (0..count).filter_map(start).collect();
        let fits = |x: &f64| match coordinate.scale {
            Scale::Logarithm => *x > 0.0 && x.is_finite(),
            Scale::Linear(_) => x.is_finite(),
        };
        if let Some(x) = column.iter().find(|x| !fits(x)) {
            return Err(IdentifyError::Value(key.clone(), *x));
        }
        let parameters: Vec<Parameter> = match key.as_str() {
            CLOCK | CLOCK_SCALE => {
                let firsts = histories.iter().filter(|&&i| chosen.recorders[i] == i);
                let parameter = |&i: &usize| match key == CLOCK {
                    true => Parameter::Clock(i),
                    false => Parameter::ClockScale(i),
                };
                firsts.map(parameter).collect()
            }
            _ => vec![Parameter::Constant(key.clone())],
        };
        for parameter in parameters {
            chosen.parameters.push(parameter);
            chosen.coordinates.push(coordinate);
            chosen.free.push(held.is_none());
            chosen.held.push(held);
            columns.push(column.clone());
        }
    }
    chosen.starts = (0..count)
        .map(|i| {
            (columns.iter().zip(&chosen.coordinates))
                .map(|(column, c)| c.clamp(c.of(column[i])))
                .collect()
        })
        .collect();
    chosen.starts.dedup();
    chosen.scatter(wishes.scattered);
    Ok(chosen)
}

/// Returns true if the gears with the model `id`, or contacts, have a parameter with this key.
pub fn has_key(key: &str, id: &str, of: (&SceneSpec, &Modelling, &[Model])) -> bool {
    let model = of.2.iter().find(|m| m.id == id);
    model.is_some_and(|model| check(key, model, of).is_ok())
}

/// Refuses a key that cannot be fitted.
fn check(
    key: &str,
    model: &Model,
    (spec, modelling, models): (&SceneSpec, &Modelling, &[Model]),
) -> Result<(), IdentifyError> {
    let possible = keys(model);
    let of_model = &possible[OF_SCENE..];
    let (Some(gear), own) = of_gear(key) else {
        if !possible.contains(&key) {
            return Err(IdentifyError::Key(key.into(), model.id.into(), possible));
        }
        let course = key == SLOPE || key == CURVATURE;
        return match course && !has_path(spec, modelling, models) {
            true => Err(IdentifyError::NoPath(key.into())),
            false => Ok(()),
        };
    };
    let takes = (spec.gears.iter().zip(&modelling.gears)).filter(|(_, m)| m.id() == model.id);
    let takes: Vec<String> = takes.map(|(gear, _)| gear.name.clone()).collect();
    if of_model.is_empty() {
        return Err(IdentifyError::NothingOfGears(key.into(), model.id.into()));
    }
    if !takes.iter().any(|name| name == gear) {
        return Err(IdentifyError::Gear(key.into(), model.id.into(), takes));
    }
    match of_model.contains(&own) {
        true => Ok(()),
        false => Err(IdentifyError::KeyOfGear(
            key.into(),
            own.into(),
            of_model.to_vec(),
        )),
    }
}

/// True if a contact is one of tooth pairs on the path of contact, and not of points of elastic flanks.
fn has_path(spec: &SceneSpec, modelling: &Modelling, models: &[Model]) -> bool {
    let mut meshes = spec.meshes.iter().zip(&modelling.contacts);
    meshes.any(|(mesh, contact)| {
        let elastic = |&gear: &usize| {
            let of = properties_of(models, modelling.gears[gear].id());
            of.modes || of.full_order
        };
        contact.flanks == FlankContact::Toothing || !mesh.gears.iter().any(elastic)
    })
}

/// Returns the present value of a constant in the scene.
fn present(key: &str, spec: &SceneSpec, modelling: &Modelling, id: &str) -> Option<f64> {
    match key {
        GAP => Some(largest_gap(spec)?.max(LEAST_GAP)),
        STIFFNESS | SLOPE | CURVATURE => {
            let of = |c: &ContactSpec| match c.stiffness {
                PairStiffness::Constant { per_width, .. } => Some((per_width, [0.0; 2])),
                PairStiffness::Parabola {
                    per_width, along, ..
                } => Some((per_width, along)),
                _ => None,
            };
            let (k, along) = modelling.contacts.iter().find_map(of)?;
            Some(match key {
                SLOPE => along[0],
                CURVATURE => along[1],
                _ => k,
            })
        }
        _ => {
            let (of, key) = of_gear(key);
            let mut gears = modelling.gears.iter().zip(&spec.gears);
            let gear = gears.find(|(g, s)| g.id() == id && of.is_none_or(|of| of == s.name))?;
            gear.0.values().get(key)?.as_f64()
        }
    }
}

//! A model of REXS as a scene.
//!
//! | module | owns |
//! |---|---|
//! | `gears` | toothing, profile shift, tooth thickness, material, modifications |
//! | `balance` | speeds of all shafts, balance of torques |
//! | `topography` | points of a topographical modification as a grid |
//! | `shafts` | shafts with sections and bearings, carriers |
//! | `report` | what was taken, assumed and left |
//!
//! The axis `u` of REXS is the axis `z` of a scene, `v` and `w` are `x` and `y`.

mod balance;
mod gears;
mod report;
mod shafts;
mod topography;

pub use report::ImportReport;

use super::attributes as key;
use super::model::{Component, Model};
use crate::context::Context;
use crate::scene_file::SceneError;
use crate::scene_file::format::{
    ComplianceTable, ContactTable, Degrees, GearLoad, GearMount, GearName, IntegratorTable,
    IsoTable, MeshTable, Method, ModelTable, NotNegative, OneOrMany, OrderedTable, Positive,
    SceneName, SceneTable, Share, SharedDampingTable, StartTable, StiffnessTable, StudyTable,
    ToothedTable,
};
use balance::Train;
use gearbench_integrators::MethodSpec;
use gearbench_models::geometry::Side;
use gears::{ImportedGear, ImportedStage, exact};
use shafts::Rotors;
use std::collections::BTreeSet;

/// Choices of an import.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImportOptions {
    /// True if shafts are rigid, whatever their sections.
    pub rigid_shafts: bool,
    /// True if bearings with their stiffness carry the shafts; else shafts turn about fixed axes.
    pub bearings: bool,
    /// Id of the load case; without one the first.
    pub load_case: Option<u64>,
}

/// A scene with the report of its import.
#[derive(Clone, Debug)]
pub struct Import {
    /// Tables of the scene.
    pub scene: SceneTable,
    /// Parts of the file that the import took, values that it assumed, and parts that it left.
    pub report: ImportReport,
    /// Difference between the centre distance of each stage and the one that its profile shifts give without backlash [m].
    pub distances: Vec<f64>,
}

fn bad(why: impl Into<String>, help: impl Into<String>) -> SceneError {
    SceneError::plain(why, help)
}

/// Converts a model to a scene of a name.
///
/// # Errors
/// Parts of the model that gearbench cannot have (racks, worms, bevel gears), missing or impossible values, or a scene that is
/// refused.
pub fn scene(
    context: &Context,
    model: &Model,
    name: &str,
    options: &ImportOptions,
) -> Result<Import, SceneError> {
    let mut report = ImportReport::default();
    let model = &with_load_case(model, options, &mut report)?;
    decline(model)?;
    let (mut gears, mut stages) = stages(model, &mut report)?;
    if stages.is_empty() {
        return Err(bad(
            "the model has no stage of cylindrical gears",
            "a stage is a relation `stage` of a `cylindrical_stage` with two gears",
        ));
    }
    gears::fill_shifts(&mut gears, &stages, &mut report);
    for gear in &mut gears {
        if let Some(component) = model.component(gear.id) {
            gear.settle(component, &mut report)?;
        }
    }
    align_rings(&mut gears, &stages, &mut report);
    gears::thin(&mut gears, &stages, &mut report);
    let distances = distances(&gears, &stages, &mut report);
    let rotors = Rotors::of(model, &gears);
    arrange_planets(&gears, &mut stages, &rotors, &mut report);
    let mut tables = Assembly {
        model,
        options,
        gears,
        stages,
        rotors,
        rolls: true,
        report,
    };
    let mut scene = tables.scene(name)?;
    let mut report = tables.report;
    leave_rest(model, &mut report);
    fit(context, &mut scene, &mut report)?;
    scene.description = format!(
        "Imported from REXS {} ({}).\n{}",
        model.version,
        model.application,
        report.to_text()
    );
    Ok(Import {
        scene,
        report,
        distances,
    })
}

/// Refuses what the models of gearbench do not cover.
fn decline(model: &Model) -> Result<(), SceneError> {
    if let Some(rack) = model.components.iter().find(|c| {
        let kind = c.kind.to_lowercase();
        kind.contains("rack") && !kind.contains("rack_shaped_tool")
    }) {
        return Err(bad(
            format!(
                "{}: the standard has no component for racks, and this one is private to its program",
                rack.title()
            ),
            "write the pair of a rack by hand: `gearbench init rack` has an example",
        ));
    }
    for relation in model.relations_of("stage") {
        let stage = relation.role("stage").and_then(|id| model.component(id));
        if let Some(stage) = stage.filter(|s| s.kind != "cylindrical_stage") {
            return Err(bad(
                format!("{}: gearbench has no gears of this kind", stage.title()),
                "it has cylindrical gears: external, internal, spur and helical ones",
            ));
        }
    }
    Ok(())
}

/// The model with the attributes of a load case in place of its own.
fn with_load_case(
    model: &Model,
    options: &ImportOptions,
    report: &mut ImportReport,
) -> Result<Model, SceneError> {
    let mut all = model.clone();
    let case = match options.load_case {
        None => model.load_cases.first(),
        Some(id) => {
            let found = model.load_cases.iter().find(|c| c.id == id);
            Some(found.ok_or_else(|| {
                let ids: Vec<String> = model.load_cases.iter().map(|c| c.id.to_string()).collect();
                bad(
                    format!("the model has no load case {id}"),
                    format!("its load cases are {}", ids.join(", ")),
                )
            })?)
        }
    };
    let Some(case) = case else {
        return Ok(all);
    };
    report.taken.push(format!("load case {}", case.id));
    if model.load_cases.len() > 1 {
        report.leave(format!("{} other load cases", model.load_cases.len() - 1));
    }
    for own in &case.components {
        if let Some(component) = all.components.iter_mut().find(|c| c.id == own.id) {
            component.attributes.extend(own.attributes.clone());
        }
    }
    Ok(all)
}

/// A name for a scene: that of a component in lower-case letters, digits and `_`, unique among `used`.
fn name_of(component: &Component, used: &mut BTreeSet<String>) -> String {
    let mut name = String::new();
    for c in component.name.to_lowercase().chars() {
        match c {
            'a'..='z' | '0'..='9' => name.push(c),
            _ if !name.is_empty() && !name.ends_with('_') => name.push('_'),
            _ => {}
        }
        if name.len() >= 24 {
            break;
        }
    }
    let name = name.trim_matches('_');
    let base = match name.chars().next() {
        Some('a'..='z') => name.to_owned(),
        Some(_) => format!("{}_{name}", component.kind),
        None => component.kind.clone(),
    };
    let name = match used.contains(&base) {
        false => base,
        true => format!("{base}_{}", component.id),
    };
    used.insert(name.clone());
    name
}

/// Gears and stages of cylindrical gears.
fn stages(
    model: &Model,
    report: &mut ImportReport,
) -> Result<(Vec<ImportedGear>, Vec<ImportedStage>), SceneError> {
    let mut gears: Vec<ImportedGear> = Vec::new();
    let mut used = BTreeSet::new();
    let mut stages = Vec::new();
    for relation in model.relations_of("stage") {
        let part = |role: &str| {
            let id = relation.role(role);
            id.and_then(|id| model.component(id)).ok_or_else(|| {
                bad(
                    format!("a relation `stage` has no component with the role `{role}`"),
                    "it needs `stage`, `gear_1` and `gear_2`",
                )
            })
        };
        let stage = part("stage")?;
        let mut pair = [0; 2];
        for (k, role) in ["gear_1", "gear_2"].into_iter().enumerate() {
            let component = part(role)?;
            if !matches!(component.kind.as_str(), "cylindrical_gear" | "ring_gear") {
                return Err(bad(
                    format!("{} is part of a cylindrical stage", component.title()),
                    "expected a `cylindrical_gear` or a `ring_gear`",
                ));
            }
            pair[k] = match gears.iter().position(|g| g.id == component.id) {
                Some(i) => i,
                None => {
                    let name = name_of(component, &mut used);
                    gears.push(gears::gear(model, component, name, report)?);
                    gears.len() - 1
                }
            };
        }
        let distance = stage.number(&key::CENTRE_DISTANCE)?.map(exact);
        if let Some(a) = distance.filter(|a| *a <= 0.0) {
            return Err(bad(
                format!("{}: `center_distance` is {} mm", stage.title(), 1e3 * a),
                "expected a positive number",
            ));
        }
        let limits = [&key::LEAST_BACKLASH, &key::MOST_BACKLASH];
        let [least, most] = limits.map(|limit| stage.number(limit));
        let backlash = match (least?, most?) {
            (Some(a), Some(b)) => Some(0.5 * (a + b)),
            (a, b) => a.or(b),
        };
        let mut direction = direction(model, stage, pair.map(|i| gears[i].id), distance)?;
        if gears[pair[0]].table.internal {
            pair.reverse();
            direction += std::f64::consts::PI;
        }
        if pair[0] == pair[1] || gears[pair[0]].table.internal {
            return Err(bad(
                format!("{}: its gears cannot mesh", stage.title()),
                "expected two gears, of which one at most is internal",
            ));
        }
        stages.push(ImportedStage {
            gears: pair,
            distance,
            direction,
            backlash,
        });
    }
    Ok((gears, stages))
}

/// Direction from the first to the second gear of a stage [rad]: from the positions of the gears or their shafts, else from
/// the angle of the stage.
fn direction(
    model: &Model,
    stage: &Component,
    gears: [u64; 2],
    distance: Option<f64>,
) -> Result<f64, SceneError> {
    let places = gears.map(|id| position(model, id));
    if let ([Some(a), Some(b)], Some(distance)) = (places, distance) {
        let [x, y] = [b[0] - a[0], b[1] - a[1]];
        if (x.hypot(y) - distance).abs() < 1e-3 * distance {
            return Ok(y.atan2(x));
        }
    }
    Ok(-stage.number(&key::STAGE_ANGLE)?.unwrap_or(0.0))
}

/// A list of three numbers of a component, in metres.
fn vector(of: &Component, name: &str) -> Option<[f64; 3]> {
    <[f64; 3]>::try_from(of.numbers(name, "mm")?).ok()
}

/// Position of a gear in the plane of `v` and `w` [m]. The axes are those of the gear unit: the own axes of a gear turn with its
/// teeth.
fn position(model: &Model, gear: u64) -> Option<[f64; 2]> {
    let place = vector(model.component(gear)?, "support_vector")?;
    let unit = model.of_kind("gear_unit").next();
    let axis = |name: &str, usual: [f64; 3]| {
        let own = unit.and_then(|unit| vector(unit, name)).unwrap_or(usual);
        let length = own.iter().map(|x| x * x).sum::<f64>().sqrt();
        (length > 0.0).then(|| own.map(|x| x / length))
    };
    let u = axis("u_axis_vector", [1.0, 0.0, 0.0])?;
    let w = axis("w_axis_vector", [0.0, 0.0, 1.0])?;
    let v = [
        w[1] * u[2] - w[2] * u[1],
        w[2] * u[0] - w[0] * u[2],
        w[0] * u[1] - w[1] * u[0],
    ];
    let dot = |a: [f64; 3]| a.iter().zip(&place).map(|(a, b)| a * b).sum::<f64>();
    Some([dot(v), dot(w)])
}

/// Spreads planets evenly where the file gives all of them one direction, and puts internal gears about their suns.
fn arrange_planets(
    gears: &[ImportedGear],
    stages: &mut [ImportedStage],
    rotors: &Rotors,
    report: &mut ImportReport,
) {
    for carrier in rotors.carriers.values() {
        let of_carrier = |s: &ImportedStage| rotors.carrier_of(s.gears) == Some(*carrier);
        let is_external = |s: &ImportedStage| !gears[s.gears[1]].table.internal;
        let external: Vec<usize> = (0..stages.len())
            .filter(|i| of_carrier(&stages[*i]) && is_external(&stages[*i]))
            .collect();
        let directions: Vec<f64> = external.iter().map(|i| stages[*i].direction).collect();
        let count = external.len();
        if count > 1 && directions.iter().all(|d| (d - directions[0]).abs() < 1e-6) {
            for (k, i) in external.iter().enumerate() {
                stages[*i].direction += std::f64::consts::TAU * k as f64 / count as f64;
            }
            report.assume("planets are spread evenly");
        }
        for k in 0..stages.len() {
            if !of_carrier(&stages[k]) || is_external(&stages[k]) {
                continue;
            }
            let planet = stages[k].gears[0];
            let sun = external.iter().find_map(|i| {
                let [a, b] = stages[*i].gears;
                match (a == planet, b == planet) {
                    (false, true) => Some(stages[*i].direction + std::f64::consts::PI),
                    (true, false) => Some(stages[*i].direction),
                    _ => None,
                }
            });
            stages[k].direction = sun.unwrap_or(stages[k].direction);
        }
    }
}

/// Gives internal gears the hand of their mates: the sign of their helix angle is not used alike by all programs.
fn align_rings(gears: &mut [ImportedGear], stages: &[ImportedStage], report: &mut ImportReport) {
    for stage in stages {
        let [a, b] = stage.gears;
        let mate = gears[a].table.helix_angle_deg;
        let own = gears[b].table.helix_angle_deg;
        if let (true, Some(mate), Some(own)) = (gears[b].table.internal, mate, own)
            && mate.0 * own.0 < 0.0
        {
            gears[b].table.helix_angle_deg = Some(Degrees(-own.0));
            report.assume(format!("{}: the hand of its mate", gears[b].name));
        }
    }
}

/// Compares centre distances with those that the profile shifts give without backlash.
fn distances(
    gears: &[ImportedGear],
    stages: &[ImportedStage],
    report: &mut ImportReport,
) -> Vec<f64> {
    let mut differences = Vec::new();
    for stage in stages {
        let pair = stage.gears.map(|i| &gears[i]);
        let shifts = pair.iter().filter_map(|g| g.shift).sum();
        let names = format!("{} and {}", pair[0].name, pair[1].name);
        if let (Some(a), Some([free, _])) = (stage.distance, gears::distance_of(pair, shifts)) {
            differences.push(a - free);
            report.taken.push(format!(
                "{names}: {}/{} teeth, centre distance {} mm; their profile shifts give {:.5} mm without backlash",
                pair[0].table.teeth,
                pair[1].table.teeth,
                exact(1e3 * a),
                1e3 * free
            ));
        }
    }
    differences
}

/// Lists components that the scene has no part of.
fn leave_rest(model: &Model, report: &mut ImportReport) {
    const READ: [&str; 16] = [
        "gear_unit",
        "gear_casing",
        "shaft",
        "shaft_section",
        "cylindrical_gear",
        "ring_gear",
        "cylindrical_stage",
        "planetary_stage",
        "planet_carrier",
        "flank_geometry",
        "cylindrical_gear_flank",
        "stage_gear_data",
        "cylindrical_stage_gear_data",
        "external_load",
        "material",
        "cylindrical_gear_manufacturing_settings",
    ];
    const ELSEWHERE: [&str; 12] = [
        "rack_shaped_tool",
        "cutter_wheel_tool",
        "tip_relief",
        "profile_crowning",
        "helix_crowning",
        "helix_slope",
        "end_relief_datum_face",
        "end_relief_non_datum_face",
        "profile_twist",
        "topographical_modification",
        "concept_bearing",
        "rolling_bearing_with_catalog_geometry",
    ];
    let kinds = model.components.iter().map(|c| c.kind.as_str());
    report.leave_kinds(kinds.filter(|k| !READ.contains(k) && !ELSEWHERE.contains(k)));
}

/// Changes what the file does not determine until the scene can be read: the addendum of internal gears without a tip
/// diameter, their cutters, elastic shafts, damping.
///
/// # Errors
/// The refusal of the scene with the smallest addendum, if no change helps.
fn fit(
    context: &Context,
    scene: &mut SceneTable,
    report: &mut ImportReport,
) -> Result<(), SceneError> {
    let Err(mut refusal) = try_addenda(context, scene, report) else {
        return Ok(());
    };
    /// A change of a scene; false if there is nothing to change.
    type Change = fn(&mut SceneTable) -> bool;
    let changes: [(&str, Change); 4] = [
        (
            "internal gears: the cutter of the defaults, as that of the file cannot be used",
            default_cutters,
        ),
        (
            "no topographies, as those of the file cannot be used",
            no_topographies,
        ),
        (
            "rigid shafts, as those of the file cannot be used",
            rigid_shafts,
        ),
        ("no damping, as the loads determine no mesh mode", |scene| {
            scene.damping.take().is_some()
        }),
    ];
    for (k, (what, change)) in changes.into_iter().enumerate() {
        if !change(scene) {
            continue;
        }
        match try_addenda(context, scene, report) {
            Ok(()) => {
                report.assume(format!("{what}: {}", refusal.message()));
                return Ok(());
            }
            Err(e) if k == 0 => refusal = e,
            Err(_) => {}
        }
    }
    Err(refusal)
}

/// Removes what the file says about cutters of internal gears.
fn default_cutters(scene: &mut SceneTable) -> bool {
    let mut changed = false;
    for (_, gear) in &mut scene.gears.0 {
        if let ToothedTable::Gear(gear) = gear
            && gear.internal
            && (gear.cutter_teeth.is_some() || gear.tip_radius_factor.is_some())
        {
            (gear.cutter_teeth, gear.tip_radius_factor) = (None, None);
            changed = true;
        }
    }
    changed
}

/// Removes the topographies of all gears.
fn no_topographies(scene: &mut SceneTable) -> bool {
    let mut changed = false;
    for (_, gear) in &mut scene.gears.0 {
        if let ToothedTable::Gear(gear) = gear {
            changed |= gear.topography.take().is_some();
        }
    }
    changed
}

/// Removes the sections of all shafts.
fn rigid_shafts(scene: &mut SceneTable) -> bool {
    let mut changed = false;
    for shaft in scene.shafts.iter_mut().flatten() {
        changed |= shaft.sections.take().is_some();
        shaft.damping_ratio = None;
        for station in &mut shaft.carries {
            if station.body.is_some() {
                station.inertia_kgm2.get_or_insert(NotNegative(1e-9));
            }
        }
    }
    changed
}

/// Loads the scene, with a smaller and smaller addendum of internal gears that the file gives no tip diameter.
fn try_addenda(
    context: &Context,
    scene: &mut SceneTable,
    report: &mut ImportReport,
) -> Result<(), SceneError> {
    let open: Vec<usize> = (scene.gears.0.iter().enumerate())
        .filter(|(_, (_, gear))| match gear {
            ToothedTable::Gear(gear) => {
                gear.internal
                    && gear.addendum_factor.is_none()
                    && gear.tip_circle_radius_m.is_none()
            }
            ToothedTable::Rack(_) => false,
        })
        .map(|(i, _)| i)
        .collect();
    let set = |scene: &mut SceneTable, addendum: Option<f64>| {
        for &i in &open {
            if let ToothedTable::Gear(gear) = &mut scene.gears.0[i].1 {
                gear.addendum_factor = addendum;
            }
        }
        scene.load(context).map(|_| ())
    };
    let mut refusal = match set(scene, None) {
        Ok(()) => return Ok(()),
        Err(e) => e,
    };
    for addendum in [0.9, 0.8, 0.7, 0.6, 0.5] {
        if open.is_empty() {
            break;
        }
        match set(scene, Some(addendum)) {
            Ok(()) => {
                report.assume(format!(
                    "internal gears: addendum {addendum} modules, the largest without interference"
                ));
                return Ok(());
            }
            Err(e) => refusal = e,
        }
    }
    let _ = set(scene, None);
    Err(refusal)
}

/// All parts of a scene under construction.
struct Assembly<'m> {
    model: &'m Model,
    options: &'m ImportOptions,
    gears: Vec<ImportedGear>,
    stages: Vec<ImportedStage>,
    rotors: Rotors,
    /// True if the speeds fit the numbers of teeth.
    rolls: bool,
    report: ImportReport,
}

impl Assembly<'_> {
    fn scene(&mut self, name: &str) -> Result<SceneTable, SceneError> {
        let train = self.train();
        let speeds = self.speeds(&train)?;
        let torques = self.torques(&train)?;
        let signs = train.mesh_signs(&torques);
        let duration = self.duration(&speeds);
        let loaded = self.rolls && torques.iter().any(|t| *t != 0.0);
        let meshes = self.meshes(loaded.then_some(&signs));
        let shafts = shafts::tables(self, &speeds, &torques)?;
        for i in 0..self.gears.len() {
            let rotor = self.rotors.of_gear[i];
            let held = train.held.contains(&rotor);
            let is_planet = self.rotors.is_planet(i);
            let free = !is_planet && !shafts.carries(&self.gears[i].name);
            let table = &mut self.gears[i].table;
            if held {
                table.mount = GearMount::Fixed;
            } else if !is_planet {
                table.speed_rad_s = Some(speeds[rotor]).filter(|w| *w != 0.0);
            }
            if free && !held && torques[rotor] != 0.0 {
                table.loads = Some(vec![GearLoad::torque_nm(torques[rotor])]);
            }
        }
        let gears = self.gears.iter();
        let gears: OrderedTable<_> = gears.map(|g| (g.name.as_str(), g.table.clone())).collect();
        self.report.taken.push(format!(
            "{} gears, {} stages, {} shafts",
            self.gears.len(),
            self.stages.len(),
            shafts.shafts.len()
        ));
        self.report.assume(match self.stiffness() {
            StiffnessTable::Iso6336(_) => "contact: stiffness of ISO 6336",
            _ => "contact: compliance of the teeth",
        });
        let damped = torques.iter().any(|t| *t != 0.0);
        self.report.assume(match damped {
            true => "damping: 5 % of critical of the mesh mode",
            false => "no damping, as there are no loads",
        });
        let method: MethodSpec = "dopri5"
            .parse()
            .map_err(|e| bad(format!("{e}"), "report this"))?;
        Ok(SceneTable {
            name: SceneName(name.to_owned()),
            title: format!("Imported from REXS {}", self.model.version),
            duration_s: Positive(duration),
            gears,
            meshes,
            shafts: Some(shafts.shafts).filter(|s| !s.is_empty()),
            damping: damped.then(|| SharedDampingTable {
                mesh_ratio: Some(0.05),
                ..SharedDampingTable::default()
            }),
            models: vec![ModelTable {
                model: "rigid".into(),
                contact: OneOrMany::One(ContactTable {
                    stiffness: Some(self.stiffness()),
                    ..ContactTable::default()
                }),
                ..ModelTable::default()
            }],
            study: StudyTable {
                integrators: Some(vec![IntegratorTable {
                    method: Method(method),
                    step_s: None,
                    rtol: Some(Share(1e-6)),
                }]),
                ..StudyTable::default()
            },
            ..SceneTable::default()
        })
    }

    /// The stiffness law: that of ISO 6336 for helical gears, compliances of the teeth for spur gears.
    fn stiffness(&self) -> StiffnessTable {
        match self.gears.iter().any(|g| g.table.helix_angle_deg.is_some()) {
            true => StiffnessTable::Iso6336(IsoTable::default()),
            false => StiffnessTable::Compliance(ComplianceTable::default()),
        }
    }

    /// Ten mesh periods of the slowest stage, at most 200 of the fastest, at least a tenth of a millisecond.
    fn duration(&mut self, speeds: &[f64]) -> f64 {
        let frequency = |stage: &ImportedStage| {
            let [a, _] = stage.gears;
            let speed = speeds[self.rotors.of_gear[a]]
                - self
                    .rotors
                    .carrier_of(stage.gears)
                    .map_or(0.0, |c| speeds[c]);
            (speed * f64::from(self.gears[a].table.teeth)).abs() / std::f64::consts::TAU
        };
        let all: Vec<f64> = self.stages.iter().map(frequency).collect();
        let slowest = all.iter().copied().fold(f64::INFINITY, f64::min);
        let fastest = all.iter().copied().fold(0.0, f64::max);
        let duration = match slowest > 0.0 {
            true => (10.0 / slowest).min(200.0 / fastest).clamp(1e-4, 1.0),
            false => 1e-3,
        };
        let duration = format!("{duration:.1e}").parse().unwrap_or(duration);
        self.report
            .assume(format!("duration {duration} s, ten mesh periods of the slowest stage, at most 200 of the fastest"));
        duration
    }

    fn train(&self) -> Train {
        let mesh = |stage: &ImportedStage| {
            let [a, b] = stage.gears;
            let [one, two] = stage.gears.map(|i| f64::from(self.gears[i].table.teeth));
            let two = if self.gears[b].table.internal {
                -two
            } else {
                two
            };
            let mut row = vec![(self.rotors.of_gear[a], one), (self.rotors.of_gear[b], two)];
            if let Some(carrier) = self.rotors.carrier_of(stage.gears) {
                row.push((carrier, -(one + two)));
            }
            row
        };
        Train {
            rotors: self.rotors.count,
            meshes: self.stages.iter().map(mesh).collect(),
            held: self.rotors.held.clone(),
        }
    }

    fn speeds(&mut self, train: &Train) -> Result<Vec<f64>, SceneError> {
        let mut given = Vec::new();
        for shaft in self.model.of_kind("shaft") {
            let rotor = self.rotors.of_shaft.get(&shaft.id);
            if let (Some(rotor), Some(speed)) = (rotor, shaft.number(&key::SPEED)?) {
                given.push((*rotor, exact(speed)));
            }
        }
        if given.is_empty() {
            self.report.assume("speeds 0, as no shaft has one");
        }
        let speeds = train.speeds(&given).unwrap_or_else(|| {
            self.report.assume(
                "speeds as in the file, which do not fit the numbers of teeth; 0 where it has none",
            );
            self.rolls = false;
            let mut speeds = vec![0.0; train.rotors];
            for (rotor, speed) in &given {
                speeds[*rotor] = *speed;
            }
            speeds
        });
        let rounded = speeds
            .iter()
            .map(|w| if w.abs() < 1e-9 { 0.0 } else { exact(*w) });
        Ok(rounded.collect())
    }

    /// Torques of loads by rotor; those that the file leaves open follow from the balance.
    fn torques(&mut self, train: &Train) -> Result<Vec<f64>, SceneError> {
        let mut torques = vec![0.0; train.rotors];
        let mut open = Vec::new();
        for load in self.model.of_kind("external_load") {
            let Some(&rotor) = self.rotors.of_load.get(&load.id) else {
                self.report
                    .leave(format!("{}: on no shaft with gears", load.title()));
                continue;
            };
            match load.number(&key::TORQUE)? {
                Some(torque) => torques[rotor] += torque,
                None if load.is_true(&key::TRANSMITS) => open.push(rotor),
                None => self.report.leave(load.title()),
            }
        }
        let balanced = train.balanced(&torques, &open);
        let torques = balanced.unwrap_or_else(|| {
            self.report
                .assume("torques as in the file, which are not in balance: the train accelerates");
            torques
        });
        Ok(torques
            .iter()
            .map(|t| if t.abs() < 1e-9 { 0.0 } else { exact(*t) })
            .collect())
    }

    /// Meshes in an order in which each has a placed gear, with their starts where `signs` of the torques are given.
    fn meshes(&self, signs: Option<&Vec<f64>>) -> Vec<MeshTable> {
        let mut meshes = Vec::new();
        let mut placed: BTreeSet<usize> = BTreeSet::new();
        let mut turned: BTreeSet<usize> = BTreeSet::new();
        let mut left: Vec<usize> = (0..self.stages.len()).collect();
        // External pairs first: planets are placed by their sun.
        left.sort_by_key(|&i| self.gears[self.stages[i].gears[1]].table.internal);
        while !left.is_empty() {
            let rotors = |i: usize| self.stages[i].gears.map(|g| self.rotors.of_gear[g]);
            let next = left
                .iter()
                .position(|&i| rotors(i).iter().any(|r| placed.contains(r)));
            let i = left.remove(next.unwrap_or(0));
            let stage = &self.stages[i];
            let [a, b] = rotors(i);
            let closes = placed.contains(&a) && placed.contains(&b);
            let starts = !(turned.contains(&stage.gears[0]) && turned.contains(&stage.gears[1]));
            placed.extend([a, b]);
            turned.extend(stage.gears);
            let start = signs.filter(|_| starts).map(|signs| StartTable {
                // The mesh resists the gear that drives with its left flanks.
                flank: Some(if signs[i] > 0.0 {
                    Side::Right
                } else {
                    Side::Left
                }),
                loaded: meshes.is_empty(),
                ..StartTable::default()
            });
            meshes.push(MeshTable {
                gears: stage.gears.map(|g| GearName(self.gears[g].name.clone())),
                centre_distance_m: stage.distance.filter(|_| !closes).map(Positive),
                direction_deg: Some(exact(stage.direction.to_degrees()))
                    .filter(|d| *d != 0.0 && !closes)
                    .map(Degrees),
                start,
                ..MeshTable::default()
            });
        }
        meshes
    }
}

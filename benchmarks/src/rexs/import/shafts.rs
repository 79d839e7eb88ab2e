//! Shafts and carriers: which parts turn together, sections, bearings, loads between gears.

use super::gears::{ImportedGear, exact, material, needed};
use super::{Assembly, name_of};
use crate::rexs::attributes as key;
use crate::rexs::attributes::{OPERATING_STIFFNESS, RIGID, STIFFNESS_DIRECTIONS};
use crate::rexs::model::{Component, Model};
use crate::scene_file::SceneError;
use crate::scene_file::format::{
    BearingTable, DirectionTable, GearLoad, GearName, NotNegative, Positive, SectionTable,
    ShaftTable, StationTable, Tilt, Translation,
};
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;

/// Largest gap or overlap of neighbouring sections [m].
const GAP: f64 = 1e-6;
/// Density of steel, for the inertia of carriers [kg/m^3].
const STEEL: f64 = 7850.0;

/// Parts that turn together, by index: shafts with gears, carriers with their shafts.
#[derive(Clone, Debug, Default)]
pub struct Rotors {
    /// Number of rotors.
    pub count: usize,
    /// Rotor of each shaft, by id.
    pub of_shaft: BTreeMap<u64, usize>,
    /// Rotor of each gear, by index.
    pub of_gear: Vec<usize>,
    /// Rotor of each external load, by id.
    pub of_load: BTreeMap<u64, usize>,
    /// Rotors that the housing holds.
    pub held: Vec<usize>,
    /// Rotor of each carrier by the id of its planetary stage.
    pub carriers: BTreeMap<u64, usize>,
    /// Gears on planet shafts, by index.
    pub planets: BTreeSet<usize>,
    /// Planetary stage of each planet.
    stage_of: BTreeMap<usize, u64>,
}

impl Rotors {
    /// Finds the rotors of a model.
    pub fn of(model: &Model, gears: &[ImportedGear]) -> Self {
        let mut all = Rotors::default();
        for stage in model.of_kind("planetary_stage") {
            all.carriers.insert(stage.id, all.count);
            let shafts =
                model.related("planet_carrier_shaft", "planetary_stage", stage.id, "shaft");
            for shaft in shafts {
                all.of_shaft.insert(shaft.id, all.count);
            }
            all.count += 1;
        }
        for (i, gear) in gears.iter().enumerate() {
            let shaft = shaft_of(model, gear.id);
            let rotor = match shaft.and_then(|s| all.of_shaft.get(&s)) {
                Some(rotor) => *rotor,
                None => {
                    all.count += 1;
                    all.count - 1
                }
            };
            all.of_gear.push(rotor);
            let Some(shaft) = shaft else { continue };
            all.of_shaft.insert(shaft, rotor);
            let mut stages = model.relations_of("planet_shaft");
            let stage = stages
                .find(|r| r.role("shaft") == Some(shaft))
                .and_then(|r| r.role("planetary_stage"));
            if let Some(stage) = stage.filter(|s| all.carriers.contains_key(s)) {
                all.planets.insert(i);
                all.stage_of.insert(i, stage);
            }
        }
        for load in model.of_kind("external_load") {
            let shaft = shaft_of(model, load.id);
            if let Some(rotor) = shaft.and_then(|s| all.of_shaft.get(&s)) {
                all.of_load.insert(load.id, *rotor);
            }
        }
        let casing = |id: u64| model.component(id).is_some_and(|c| c.kind == "gear_casing");
        for side in model.relations_of("side") {
            let [inner, outer] = ["inner_part", "outer_part"].map(|role| side.role(role));
            let kind = side.role("assembly").and_then(|id| model.component(id));
            let couples = kind.is_some_and(|c| c.kind.contains("coupling"));
            if let (true, Some(a), Some(b)) = (couples, inner, outer) {
                let shaft = if casing(a) { b } else { a };
                if let Some(rotor) = all.of_shaft.get(&shaft)
                    && (casing(a) || casing(b))
                    && !all.held.contains(rotor)
                {
                    all.held.push(*rotor);
                }
            }
        }
        all
    }

    /// True if a gear goes round with a carrier.
    pub fn is_planet(&self, gear: usize) -> bool {
        self.planets.contains(&gear)
    }

    /// The carrier of a mesh, if one of its gears is a planet.
    pub fn carrier_of(&self, gears: [usize; 2]) -> Option<usize> {
        let stage = gears.iter().find_map(|g| self.stage_of.get(g))?;
        self.carriers.get(stage).copied()
    }
}

/// The shaft that a component is part of.
fn shaft_of(model: &Model, id: u64) -> Option<u64> {
    let owners = model.related("assembly", "part", id, "assembly");
    let shaft = owners.into_iter().find(|c| c.kind == "shaft")?;
    Some(shaft.id)
}

/// Shafts of a scene.
pub struct ShaftTables {
    /// Tables of the scene.
    pub shafts: Vec<ShaftTable>,
    on_shafts: BTreeSet<String>,
}

impl ShaftTables {
    /// True if a shaft carries a gear.
    pub fn carries(&self, gear: &str) -> bool {
        self.on_shafts.contains(gear)
    }
}

/// Builds the shafts: those with several gears, with sections between gears and loads, and carriers.
pub fn tables(
    of: &mut Assembly<'_>,
    speeds: &[f64],
    torques: &[f64],
) -> Result<ShaftTables, SceneError> {
    let mut names: BTreeSet<String> = of.gears.iter().map(|g| g.name.clone()).collect();
    let mut all = ShaftTables {
        shafts: Vec::new(),
        on_shafts: BTreeSet::new(),
    };
    let model = of.model;
    for shaft in model.of_kind("shaft") {
        let Some(&rotor) = of.rotors.of_shaft.get(&shaft.id) else {
            continue;
        };
        let on_it: Vec<usize> = (0..of.gears.len())
            .filter(|i| {
                of.rotors.of_gear[*i] == rotor && shaft_of(model, of.gears[*i].id) == Some(shaft.id)
            })
            .collect();
        let moves = !of.rotors.held.contains(&rotor);
        let is_plain = on_it.iter().all(|i| !of.rotors.is_planet(*i));
        if on_it.is_empty() || !moves || !is_plain {
            continue;
        }
        if let Some(table) = plain(of, shaft, &on_it, &mut names, [speeds, torques])? {
            all.on_shafts
                .extend(on_it.iter().map(|i| of.gears[*i].name.clone()));
            all.shafts.push(table);
        }
    }
    let carriers: Vec<(u64, usize)> = of.rotors.carriers.iter().map(|(s, r)| (*s, *r)).collect();
    for (stage, rotor) in carriers {
        let Some(stage) = model.component(stage) else {
            continue;
        };
        all.shafts
            .push(carrier(of, stage, rotor, &mut names, [speeds, torques]));
    }
    Ok(all)
}

/// A shaft with gears; `None` if a single gear on a fixed axis says the same.
fn plain(
    of: &mut Assembly<'_>,
    shaft: &Component,
    on_it: &[usize],
    names: &mut BTreeSet<String>,
    [speeds, torques]: [&[f64]; 2],
) -> Result<Option<ShaftTable>, SceneError> {
    let rotor = of.rotors.of_gear[on_it[0]];
    let model = of.model;
    let mut stations = Vec::new();
    for &i in on_it {
        let component = model.component(of.gears[i].id);
        let place = component.map(|c| c.number(&key::PLACE)).transpose()?;
        // Version 1.0 has another attribute of this name (numeric id 782): the place of the lower end of the gear.
        let to_middle = match model.version.as_str() {
            "1.0" => 0.5 * of.gears[i].table.face_width_m,
            _ => 0.0,
        };
        stations.push(StationTable {
            gear: Some(GearName(of.gears[i].name.clone())),
            at_m: exact(place.flatten().unwrap_or(0.0) + to_middle),
            ..StationTable::default()
        });
    }
    let loads: Vec<&Component> = model
        .of_kind("external_load")
        .filter(|l| of.rotors.of_load.get(&l.id) == Some(&rotor))
        .collect();
    let mut sections = match of.options.rigid_shafts {
        true => None,
        false => sections(of, shaft)?,
    };
    let length: f64 = sections.iter().flatten().map(|s| s.length_m.0).sum();
    let mut places = Vec::new();
    for load in &loads {
        places.push(exact(load.number(&key::PLACE)?.unwrap_or(0.0)));
    }
    let all = stations
        .iter()
        .map(|s| s.at_m)
        .chain(places.iter().copied());
    if sections.is_some() && all.clone().any(|x| x < -GAP || x > length + GAP) {
        of.report.leave(format!(
            "sections of {}: a part lies outside of them",
            shaft.title()
        ));
        sections = None;
    }
    let bearings = match of.options.bearings {
        true => bearings(of, shaft)?,
        false => Vec::new(),
    };
    if stations.len() == 1 && sections.is_none() {
        let own = on_it[0];
        match bearings.as_slice() {
            [one] if (one.place - stations[0].at_m).abs() < GAP => {
                let table = &mut of.gears[own].table;
                table.bearing = Some(one.springs.clone());
                table.directions.clone_from(&one.directions);
                of.report
                    .taken
                    .push(format!("{}: 1 bearing", shaft.title()));
            }
            [] => {}
            _ => of.report.leave(format!(
                "bearings of {}: a gear without sections of a shaft has one, at its middle",
                shaft.title()
            )),
        }
        return Ok(None);
    }
    if sections.is_none() && !bearings.is_empty() {
        of.report.leave(format!(
            "bearings of {}: the shaft has no sections that bend",
            shaft.title()
        ));
    }
    let bearings: Vec<StationTable> = match &sections {
        Some(_) => {
            let count = bearings.len();
            of.report
                .taken
                .push(format!("{}: {count} bearings", shaft.title()));
            bearings.into_iter().map(|b| b.station(names)).collect()
        }
        None => Vec::new(),
    };
    // The torque of the rotor acts at the place of its first load.
    if let Some(load) = loads.first().filter(|_| torques[rotor] != 0.0) {
        stations.push(StationTable {
            body: Some(name_of(load, names)),
            at_m: places[0],
            speed_rad_s: Some(speeds[rotor]),
            loads: Some(vec![GearLoad::torque_nm(torques[rotor])]),
            inertia_kgm2: sections.is_none().then_some(NotNegative(1e-9)),
            ..StationTable::default()
        });
    }
    stations.extend(bearings);
    stations.sort_by(|a, b| a.at_m.total_cmp(&b.at_m));
    let damping_ratio = sections.as_ref().map(|_| {
        of.report.assume("shafts with sections: damping ratio 0.01");
        NotNegative(0.01)
    });
    Ok(Some(ShaftTable {
        name: name_of(shaft, names),
        carries: stations,
        sections,
        damping_ratio,
        speed_rad_s: Some(speeds[rotor]).filter(|w| *w != 0.0),
        ..ShaftTable::default()
    }))
}

/// Sections of a shaft from its start on; `None` if there are none or they have gaps.
fn sections(
    of: &mut Assembly<'_>,
    shaft: &Component,
) -> Result<Option<Vec<SectionTable>>, SceneError> {
    let parts = of.model.related("assembly", "assembly", shaft.id, "part");
    let mut found = Vec::new();
    for own in parts.into_iter().filter(|c| c.kind == "shaft_section") {
        let mean = |a: &key::Attribute, b: &key::Attribute| {
            let [a, b] = [own.number(a)?, own.number(b)?];
            let [x, y] = [a.or(b), b.or(a)].map(Option::unwrap_or_default);
            Ok((0.5 * (x + y), (x - y).abs()))
        };
        let (outer, taper) = mean(&key::OUTER_BEGIN, &key::OUTER_END)?;
        let (inner, _) = mean(&key::INNER_BEGIN, &key::INNER_END)?;
        if taper > GAP {
            of.report.assume(format!(
                "{}: tapered sections have their mean diameter",
                shaft.title()
            ));
        }
        let place = own.number(&key::PLACE)?.unwrap_or(0.0);
        found.push((place, needed(own, &key::LENGTH)?, outer, inner));
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut end = 0.0;
    for (place, length, outer, inner) in &found {
        if (place - end).abs() > GAP || *length <= 0.0 || outer <= inner {
            of.report.leave(format!(
                "sections of {}: they have gaps, overlaps or no wall",
                shaft.title()
            ));
            return Ok(None);
        }
        end += length;
    }
    if found.is_empty() {
        return Ok(None);
    }
    let material = material(of.model, shaft.id, &shaft.title(), &mut of.report)?;
    let table = |(_, length, outer, inner): (f64, f64, f64, f64)| SectionTable {
        length_m: Positive(exact(length)),
        diameter_m: Some(Positive(exact(outer))),
        inner_diameter_m: (inner > 0.0).then_some(NotNegative(exact(inner))),
        material: material.clone(),
        ..SectionTable::default()
    };
    Ok(Some(found.into_iter().map(table).collect()))
}

/// A bearing between a shaft and the housing.
struct ShaftBearing<'m> {
    component: &'m Component,
    /// Place on the shaft [m].
    place: f64,
    springs: BearingTable,
    /// Directions that it holds; `None` if it holds none.
    directions: Option<DirectionTable>,
}

impl ShaftBearing<'_> {
    /// A body without inertia at the place of the bearing.
    fn station(self, names: &mut BTreeSet<String>) -> StationTable {
        StationTable {
            body: Some(name_of(self.component, names)),
            at_m: self.place,
            bearing: Some(self.springs),
            directions: self.directions,
            ..StationTable::default()
        }
    }
}

/// Bearings of a shaft on the housing.
fn bearings<'m>(
    of: &mut Assembly<'m>,
    shaft: &Component,
) -> Result<Vec<ShaftBearing<'m>>, SceneError> {
    let mut found = Vec::new();
    let model = of.model;
    for side in model.relations_of("side") {
        let part = |role: &str| side.role(role).and_then(|id| model.component(id));
        let (Some(bearing), Some(outer)) = (part("assembly"), part("outer_part")) else {
            continue;
        };
        if side.role("inner_part") != Some(shaft.id) || !bearing.kind.contains("bearing") {
            continue;
        }
        if outer.kind != "gear_casing" {
            of.report
                .leave(format!("{}: between two shafts", bearing.title()));
            continue;
        }
        let (matrix, holds) = stiffness(of, bearing)?;
        let is_diagonal = (0..6).all(|i| (0..6).all(|k| i == k || matrix[i][k] == 0.0));
        let along = |k: usize| holds[k].then_some(Translation::Held);
        let about = |k: usize| holds[k].then_some(Tilt::Held);
        found.push(ShaftBearing {
            component: bearing,
            place: exact(needed(bearing, &key::BEARING_PLACE)?),
            springs: BearingTable {
                stiffness: is_diagonal.then(|| std::array::from_fn(|k| matrix[k][k])),
                stiffness_matrix: (!is_diagonal).then_some(matrix),
                ..BearingTable::default()
            },
            directions: holds.contains(&true).then(|| DirectionTable {
                x: along(0),
                y: along(1),
                z: along(2),
                tilt_x: about(3),
                tilt_y: about(4),
                tilt_z: None,
            }),
        });
    }
    Ok(found)
}

/// Stiffness matrix of a bearing and the directions that it holds rigidly, in the directions of a scene. The matrix in the
/// operating point replaces radial, axial and tilting stiffness.
fn stiffness(
    of: &mut Assembly<'_>,
    bearing: &Component,
) -> Result<([[f64; 6]; 6], [bool; 6]), SceneError> {
    let mut matrix = [[0.0; 6]; 6];
    let mut is_given = false;
    for (row, i) in OPERATING_STIFFNESS.iter().zip(STIFFNESS_DIRECTIONS) {
        for (attribute, k) in row.iter().zip(STIFFNESS_DIRECTIONS) {
            if let Some(x) = bearing.number(attribute)? {
                (matrix[i][k], is_given) = (exact(x), true);
            }
        }
    }
    let carries_axial = bearing.text(&key::AXIAL_ABSORPTION) != Some("no_direction");
    if !is_given {
        let [radial, axial] = [&key::RADIAL_STIFFNESS, &key::AXIAL_STIFFNESS]
            .map(|attribute| bearing.number(attribute));
        let rigid = |k: Option<f64>| k.filter(|k| *k > 0.0).unwrap_or(f64::INFINITY);
        let radial = rigid(radial?);
        let axial = if carries_axial { rigid(axial?) } else { 0.0 };
        let tilting = bearing.number(&key::BENDING_STIFFNESS)?.unwrap_or(0.0);
        if radial > RIGID {
            of.report
                .assume("bearings without radial stiffness, or with more than 1e13 N/m, are rigid");
        }
        for (i, k) in [radial, radial, axial, tilting, tilting]
            .into_iter()
            .enumerate()
        {
            matrix[i][i] = k;
        }
    }
    let holds = std::array::from_fn(|i| matrix[i][i] > RIGID);
    let largest = matrix.iter().flatten().filter(|k| k.is_finite());
    let largest = largest.fold(0.0_f64, |most, k| most.max(k.abs()));
    for i in 0..6 {
        for k in 0..=i {
            if (matrix[i][k] - matrix[k][i]).abs() > 1e-9 * largest {
                let title = bearing.title();
                of.report.assume(format!(
                    "{title}: the symmetric part of its stiffness matrix"
                ));
            }
            // A direction that is held has no spring.
            let mean = match holds[i] || holds[k] {
                true => 0.0,
                false => exact(0.5 * (matrix[i][k] + matrix[k][i])),
            };
            (matrix[i][k], matrix[k][i]) = (mean, mean);
        }
    }
    Ok((matrix, holds))
}

/// The carrier of a planetary stage.
fn carrier(
    of: &mut Assembly<'_>,
    stage: &Component,
    rotor: usize,
    names: &mut BTreeSet<String>,
    [speeds, torques]: [&[f64]; 2],
) -> ShaftTable {
    let planets: Vec<usize> = (0..of.gears.len())
        .filter(|i| of.rotors.stage_of.get(i) == Some(&stage.id))
        .collect();
    let distance = of.stages.iter().find_map(|s| {
        let has = s.gears.iter().any(|g| planets.contains(g));
        s.distance.filter(|_| has)
    });
    let width = planets.iter().map(|i| of.gears[*i].table.face_width_m);
    let width = width.fold(0.0, f64::max);
    // A disc of steel over the axes of the planets, half as thick as they are wide.
    let radius = 1.3 * distance.unwrap_or(0.0);
    let inertia = 0.5 * (STEEL * PI * radius.powi(2) * 0.5 * width) * radius.powi(2);
    let inertia = format!("{:.3e}", inertia.max(1e-9));
    of.report.assume(format!(
        "{}: inertia of the carrier {inertia} kg m^2, a disc of steel of 1.3 centre distances and half the face width",
        stage.title()
    ));
    let held = of.rotors.held.contains(&rotor);
    let name = name_of(stage, names);
    ShaftTable {
        name: format!("{name}_arm"),
        carries: vec![StationTable {
            body: Some(name),
            inertia_kgm2: Some(NotNegative(inertia.parse().unwrap_or(1e-9))),
            mount: held.then_some(crate::scene_file::format::GearMount::Fixed),
            speed_rad_s: (!held).then_some(speeds[rotor]),
            loads: (!held && torques[rotor] != 0.0)
                .then(|| vec![GearLoad::torque_nm(torques[rotor])]),
            planets: Some(
                planets
                    .iter()
                    .map(|i| GearName(of.gears[*i].name.clone()))
                    .collect(),
            ),
            ..StationTable::default()
        }],
        ..ShaftTable::default()
    }
}

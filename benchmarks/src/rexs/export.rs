//! A scene as a model of REXS 2.0, with the stiffness of its meshes.
//!
//! | attribute | value |
//! |---|---|
//! | `single_stiffness_iso_6336_2019`, `mean_mesh_stiffness_for_transverse_load_iso_6336_2019` | c' and c_gamma_alpha of ISO 6336-1 |
//! | `meshing_stiffness_characteristic` | tangent of the force over the displacement along the line of action, in the transverse plane, at positions over one pitch of the first gear ([`MESHING_POSITION`](super::attributes::MESHING_POSITION), 0 at the pitch point) |
//! | `load_distribution_along_face_width` | largest load of one contact line over the face width, at the positions of the slices of the contact, under the same load |
//!
//! Bearings that are equal in all radial directions have radial, axial and tilting stiffness, others the matrix of the
//! operating point. A direction that is held has ten times the stiffness from which on the import takes it as rigid.
//!
//! The date of the file is a constant, so that equal scenes give equal bytes.

use super::attributes as key;
use super::model::{Component, Model, Relation};
use crate::scene_file::{ModelChoice, SceneError, SceneFile};
use gearbench_models::gear::table::Model as GearModel;
use gearbench_models::geometry::{EndRelief, Gear, Mate, ReliefShape, Side, Topography};
use gearbench_models::spec::{
    Body, Freedom, GearSpec, Load, MeshSpec, Modelling, Mount, OutOfPlaneSpec, Profile, SceneSpec,
    SectionKind, StationMember, initial_speed, mesh_layout,
};
use gearbench_models::stiffness::{Material, iso_of};
use gearbench_reference::statics::{Load as StaticLoad, LoadedPair, MeshCycle};
use std::collections::BTreeMap;

/// Version of the standard of exported files.
const VERSION: &str = "2.0";
/// Number of positions over one pitch.
const POSITIONS: usize = 24;
/// Line load of the stiffness where the scene has no torque [N/m].
const LINE_LOAD: f64 = 1e5;

/// A model with remarks about parts of the scene that it does not contain.
#[derive(Clone, Debug)]
pub struct Export {
    /// The model.
    pub model: Model,
    /// Parts of the scene without a counterpart, and stiffnesses that cannot be computed.
    pub left: Vec<String>,
}

/// Builds components and relations.
#[derive(Default)]
struct Builder {
    model: Model,
    left: Vec<String>,
}

impl Builder {
    fn add(&mut self, kind: &str, name: &str) -> u64 {
        let id = self.model.components.len() as u64 + 1;
        self.model.components.push(Component {
            id,
            kind: kind.into(),
            name: name.into(),
            ..Component::default()
        });
        id
    }

    fn of(&mut self, id: u64) -> &mut Component {
        &mut self.model.components[id as usize - 1]
    }

    fn relate(&mut self, kind: &str, refs: &[(&str, u64)]) {
        self.model.relations.push(Relation {
            kind: kind.into(),
            order: None,
            refs: refs
                .iter()
                .map(|(role, id)| ((*role).into(), *id))
                .collect(),
        });
    }

    fn part(&mut self, of: u64, part: u64) {
        self.relate("assembly", &[("assembly", of), ("part", part)]);
    }

    /// A relation to a material.
    fn material(&mut self, of: u64, material: &Material) {
        let id = self.add("material", "");
        let own = self.of(id);
        own.set(&key::YOUNG, material.young);
        own.set(&key::POISSON, material.poisson);
        own.set(&key::DENSITY, material.density);
        self.relate("reference", &[("origin", of), ("referenced", id)]);
    }
}

/// Converts a scene with the mesh stiffness of one of its models.
///
/// # Errors
/// A rack or a conical gear, of which REXS has none.
pub fn model(file: &SceneFile, choice: &ModelChoice) -> Result<Export, SceneError> {
    let spec = file.spec_for(choice);
    for gear in &spec.gears {
        let refuse = |what: &str| {
            let why = format!("`{}` is {what}, which REXS does not have", gear.name);
            Err(SceneError::plain(
                why,
                "export a scene of cylindrical gears",
            ))
        };
        match &gear.body {
            Body::Rack(_) => return refuse("a rack"),
            Body::Gear(g) if g.params().profile_shift_angle != 0.0 => {
                return refuse("a conical gear");
            }
            Body::Gear(_) => {}
        }
    }
    let mut to = Builder {
        model: Model {
            version: VERSION.into(),
            ..Model::default()
        },
        left: Vec::new(),
    };
    let unit = to.add("gear_unit", &file.title);
    let casing = to.add("gear_casing", "casing");
    to.part(unit, casing);
    let planets: Vec<usize> = spec.bodies().flat_map(|b| b.planets.clone()).collect();
    let shafts = shafts(&mut to, &spec, &planets, [unit, casing]);
    let mut gears = Vec::new();
    for (i, gear) in spec.gears.iter().enumerate() {
        gears.push(toothed(&mut to, gear, &shafts, i)?);
    }
    let planetary = carriers(&mut to, &spec, &shafts, unit);
    for (m, mesh) in spec.meshes.iter().enumerate() {
        let stage = stage(&mut to, &spec, mesh, &gears)?;
        let is_planet = mesh.gears.iter().any(|g| planets.contains(g));
        match planetary.first().filter(|_| is_planet) {
            Some(planetary) => to.part(*planetary, stage),
            None => to.part(unit, stage),
        }
        let found = stiffness(&spec, &choice.modelling, m, &file.context.models);
        match found {
            Ok(found) => {
                found.set(to.of(stage));
                if let Some(data) = data_of(&to, stage) {
                    to.of(data).set_list(&key::MESHING_POSITION, &found.angles);
                }
            }
            Err(why) => to.left.push(format!("mesh {}: {why}", m + 1)),
        }
    }
    if !spec.stages.is_empty() {
        to.left.push("stages without teeth".into());
    }
    Ok(Export {
        model: to.model,
        left: to.left,
    })
}

/// Shafts by gear, with the place of the gear on it [m].
type ShaftsOfGears = BTreeMap<usize, (u64, f64)>;

/// The constant torque of loads; `None` if one varies.
fn constant(loads: &[Load]) -> Option<f64> {
    let all = loads.iter().map(|load| match load {
        Load::Applied(Profile::Constant(x)) => Some(*x),
        _ => None,
    });
    all.sum()
}

/// An external load on a shaft.
fn load(to: &mut Builder, shaft: u64, name: &str, place: f64, loads: &[Load]) {
    if loads.is_empty() {
        return;
    }
    let Some(torque) = constant(loads) else {
        to.left
            .push(format!("{name}: loads that vary or depend on speed"));
        return;
    };
    let id = to.add("external_load", name);
    let own = to.of(id);
    own.set(&key::PLACE, place);
    own.set(&key::TORQUE, torque);
    own.set_text(&key::TRANSMITS, "true");
    to.part(shaft, id);
}

/// Adds all shafts: those of the scene, and one for each further gear.
fn shafts(
    to: &mut Builder,
    spec: &SceneSpec,
    planets: &[usize],
    [unit, casing]: [u64; 2],
) -> ShaftsOfGears {
    let mut of_gears = ShaftsOfGears::new();
    for shaft in &spec.shafts {
        if shaft.bodies().any(|b| !b.planets.is_empty()) {
            continue;
        }
        let id = to.add("shaft", &shaft.name);
        to.part(unit, id);
        // Places on shafts of REXS are not negative.
        let first = shaft.stations.iter().map(|s| s.place).fold(0.0, f64::min);
        let mut speed = 0.0;
        for station in &shaft.stations {
            let place = station.place - first;
            match &station.carries {
                StationMember::Gear(i) => {
                    of_gears.insert(*i, (id, place));
                    let gear = &spec.gears[*i];
                    speed = initial_speed(&gear.mount, gear.speed);
                    load(to, id, &gear.name, place, &gear.loads);
                    bearing(
                        to,
                        [id, unit, casing],
                        (&gear.name, place),
                        gear.lateral.as_deref(),
                    );
                }
                StationMember::Body(body) => {
                    load(to, id, &body.name, place, &body.loads);
                    bearing(
                        to,
                        [id, unit, casing],
                        (&body.name, place),
                        body.lateral.as_deref(),
                    );
                    if body.inertia != 0.0 {
                        to.left.push(format!("{}: inertia", body.name));
                    }
                }
            }
        }
        to.of(id).set(&key::SPEED, speed);
        let bars = shaft.sections.iter().find_map(|s| match &s.kind {
            SectionKind::Round { material, .. } => Some(*material),
            SectionKind::Coupling { .. } => None,
        });
        if let Some(material) = bars {
            to.material(id, &material);
        }
        let mut place = -first;
        for section in &shaft.sections {
            let length = section.length;
            match &section.kind {
                SectionKind::Round {
                    diameters: [outer, inner],
                    ..
                } => {
                    let own = to.add("shaft_section", "");
                    let part = to.of(own);
                    part.set(&key::PLACE, place);
                    part.set(&key::LENGTH, length);
                    for (keys, d) in [
                        ([&key::OUTER_BEGIN, &key::OUTER_END], *outer),
                        ([&key::INNER_BEGIN, &key::INNER_END], *inner),
                    ] {
                        keys.iter().for_each(|key| part.set(key, d));
                    }
                    to.part(id, own);
                }
                SectionKind::Coupling { .. } => {
                    to.left
                        .push(format!("{}: a coupling without mass", shaft.name));
                }
            }
            place += length;
        }
    }
    for (i, gear) in spec.gears.iter().enumerate() {
        if of_gears.contains_key(&i) {
            continue;
        }
        let id = to.add("shaft", &format!("shaft of {}", gear.name));
        to.part(unit, id);
        of_gears.insert(i, (id, 0.0));
        load(to, id, &gear.name, 0.0, &gear.loads);
        if !planets.contains(&i) {
            bearing(
                to,
                [id, unit, casing],
                (&gear.name, 0.0),
                gear.lateral.as_deref(),
            );
        } else if gear.lateral.is_some() {
            to.left.push(format!("{}: elastic pin", gear.name));
        }
        match gear.mount {
            Mount::Fixed => {
                let coupling = to.add("coupling", "");
                let refs = [
                    ("assembly", coupling),
                    ("inner_part", id),
                    ("outer_part", casing),
                ];
                to.relate("side", &refs);
            }
            // Planets roll on their suns.
            _ if planets.contains(&i) => {}
            _ => {
                let speed = initial_speed(&gear.mount, gear.speed);
                to.of(id).set(&key::SPEED, speed);
            }
        }
    }
    of_gears
}

/// Adds the bearing of a hub between its shaft and the casing.
fn bearing(
    to: &mut Builder,
    [shaft, unit, casing]: [u64; 3],
    (name, place): (&str, f64),
    of: Option<&OutOfPlaneSpec>,
) {
    let Some(of) = of else { return };
    let mut matrix = of.bearing.stiffness;
    let holds = |k: usize| of.directions[k] == Freedom::Fixed;
    let supports = |k: usize| holds(k) || matrix[k][k] > 0.0;
    if (0..6).all(|k| matrix[k].iter().all(|x| *x == 0.0)) && !holds(0) && !holds(1) {
        return;
    }
    if !supports(0) || !supports(1) {
        to.left
            .push(format!("{name}: a bearing without radial stiffness"));
        return;
    }
    let carries_axial = supports(2);
    for k in 0..5 {
        if matches!(of.directions[k], Freedom::Driven(_)) {
            to.left.push(format!("{name}: driven directions"));
        } else if holds(k) {
            (0..6).for_each(|i| (matrix[i][k], matrix[k][i]) = (0.0, 0.0));
            matrix[k][k] = 10.0 * key::RIGID;
        }
    }
    if (0..6).any(|k| matrix[5][k] != 0.0) {
        to.left
            .push(format!("{name}: stiffness of its bearing about the axis"));
    }
    let [damped, loose] = [
        of.bearing.damping != [[0.0; 6]; 6],
        of.bearing.clearance != 0.0,
    ];
    for (is_there, what) in [(damped, "damping"), (loose, "clearance")] {
        if is_there {
            to.left.push(format!("{name}: {what} of its bearing"));
        }
    }
    let is_diagonal = (0..5).all(|i| (0..5).all(|k| i == k || matrix[i][k] == 0.0));
    let is_round = matrix[0][0] == matrix[1][1] && matrix[3][3] == matrix[4][4];
    let id = to.add("concept_bearing", name);
    let own = to.of(id);
    own.set(&key::BEARING_PLACE, place);
    let axial = if carries_axial {
        "both_directions"
    } else {
        "no_direction"
    };
    own.set_text(&key::AXIAL_ABSORPTION, axial);
    if is_diagonal && is_round {
        own.set(&key::RADIAL_STIFFNESS, matrix[0][0]);
        own.set(&key::BENDING_STIFFNESS, matrix[3][3]);
        if carries_axial {
            own.set(&key::AXIAL_STIFFNESS, matrix[2][2]);
        }
    } else {
        for (row, i) in key::OPERATING_STIFFNESS
            .iter()
            .zip(key::STIFFNESS_DIRECTIONS)
        {
            for (attribute, k) in row.iter().zip(key::STIFFNESS_DIRECTIONS) {
                own.set(attribute, matrix[i][k]);
            }
        }
    }
    let refs = [
        ("assembly", id),
        ("inner_part", shaft),
        ("outer_part", casing),
    ];
    to.relate("side", &refs);
    to.part(unit, id);
}

/// Adds a gear with flanks, tool and material.
fn toothed(
    to: &mut Builder,
    gear: &GearSpec,
    shafts: &ShaftsOfGears,
    index: usize,
) -> Result<u64, SceneError> {
    let Body::Gear(body) = &gear.body else {
        return Err(SceneError::plain("a rack", "export cylindrical gears"));
    };
    let params = body.params();
    let internal = params.internal.is_some();
    let id = to.add(
        if internal {
            "ring_gear"
        } else {
            "cylindrical_gear"
        },
        &gear.name,
    );
    let (shaft, place) = shafts.get(&index).copied().unwrap_or_default();
    to.part(shaft, id);
    let own = to.of(id);
    own.set(&key::TEETH, f64::from(params.teeth));
    own.set(&key::MODULE, params.module);
    own.set(&key::HELIX, params.helix_angle);
    own.set(&key::WIDTH, params.face_width);
    own.set(&key::TIP, 2.0 * body.r_tip());
    own.set(&key::ROOT, 2.0 * body.r_root());
    own.set(&key::PLACE, place);
    if params.bore_radius > 0.0 {
        own.set(&key::INNER, 2.0 * params.bore_radius);
    }
    let flanks = ["left", "right"].map(|side| {
        let flank = to.add("cylindrical_gear_flank", &format!("{} {side}", gear.name));
        let own = to.of(flank);
        own.set(&key::PRESSURE_ANGLE, params.pressure_angle);
        own.set(&key::SHIFT, params.profile_shift);
        flank
    });
    let [left, right] = flanks;
    to.relate("flank", &[("gear", id), ("left", left), ("right", right)]);
    modifications(to, gear, body, flanks);
    let tool = match &params.internal {
        None => to.add("rack_shaped_tool", ""),
        Some(internal) => {
            let tool = to.add("cutter_wheel_tool", "");
            if let Some(teeth) = internal.cutter_teeth {
                to.of(tool).set(&key::TEETH, f64::from(teeth));
            }
            tool
        }
    };
    let own = to.of(tool);
    own.set(&key::TOOL_ADDENDUM, params.dedendum);
    own.set(&key::TOOL_RADIUS, params.tip_radius);
    for flank in flanks {
        to.relate(
            "manufacturing_step",
            &[("workpiece", flank), ("tool", tool)],
        );
    }
    to.material(id, &gear.material);
    Ok(id)
}

/// Adds the modifications of the flanks, left before right.
fn modifications(to: &mut Builder, gear: &GearSpec, body: &Gear, flanks: [u64; 2]) {
    let own = &body.params().modifications;
    let mut add = |kind: &str, flanks: &[u64], fill: &dyn Fn(&mut Component)| {
        for flank in flanks {
            let id = to.add(kind, &gear.name);
            fill(to.of(id));
            to.relate("reference", &[("origin", *flank), ("referenced", id)]);
        }
    };
    let shape = |own: &mut Component, shape: ReliefShape| {
        let text = match shape {
            ReliefShape::Linear => "linear",
            ReliefShape::Parabolic => "parabolic",
        };
        own.set_text(&key::RELIEF_SHAPE, text);
    };
    if let Some(relief) = &own.tip_relief {
        add("tip_relief", &flanks, &|c| {
            c.set(&key::TIP_RELIEF, relief.amount);
            c.set(&key::TIP_RELIEF_START, 2.0 * relief.start_radius);
            shape(c, relief.shape);
        });
    }
    for (amount, kind, keys) in [
        (
            own.profile_crowning,
            "profile_crowning",
            [&key::PROFILE_CROWNING_TIP, &key::PROFILE_CROWNING_ROOT],
        ),
        (
            own.lead_crowning,
            "helix_crowning",
            [&key::HELIX_CROWNING_DATUM, &key::HELIX_CROWNING_OTHER],
        ),
    ] {
        if amount != 0.0 {
            add(kind, &flanks, &|c| {
                keys.iter().for_each(|key| c.set(key, amount))
            });
        }
    }
    let [low, high] = &own.end_relief;
    let ends: [(&Option<EndRelief>, &str, [&key::Attribute; 2]); 2] = [
        (
            low,
            "end_relief_datum_face",
            [&key::DATUM_RELIEF, &key::DATUM_RELIEF_LENGTH],
        ),
        (
            high,
            "end_relief_non_datum_face",
            [&key::OTHER_RELIEF, &key::OTHER_RELIEF_LENGTH],
        ),
    ];
    for (end, kind, keys) in ends {
        if let Some(end) = end {
            add(kind, &flanks, &|c| {
                c.set(keys[0], end.amount);
                c.set(keys[1], end.length);
                shape(c, end.shape);
            });
        }
    }
    for (i, flank) in flanks.iter().enumerate() {
        for (amount, kind, key) in [
            (own.helix_slope[i], "helix_slope", &key::HELIX_SLOPE),
            (own.twist[i], "profile_twist", &key::PROFILE_TWIST),
        ] {
            if amount != 0.0 {
                add(kind, &[*flank], &|c| c.set(key, amount));
            }
        }
        if let Some(grid) = &own.topography[i] {
            add("topographical_modification", &[*flank], &|c| {
                points(c, body, grid)
            });
        }
    }
}

/// Sets the points of a topography: amounts by rows from the root to the tip, with their diameters and coordinates.
fn points(own: &mut Component, body: &Gear, grid: &Topography) {
    let half = 0.5 * body.params().face_width;
    let roll = |r: f64| (r * r - body.r_base().powi(2)).max(0.0).sqrt();
    let ends = grid.radii().unwrap_or([body.r_form(), body.r_tip()]);
    let heights = grid.heights().unwrap_or([-half, half]);
    let [rows, columns] = grid.size();
    let between = |[a, b]: [f64; 2], i: usize, n: usize| a + (b - a) * i as f64 / (n - 1) as f64;
    let [mut diameters, mut coordinates] = [Vec::new(), Vec::new()];
    for i in 0..rows {
        for k in 0..columns {
            let s = between(ends.map(roll), i, rows);
            diameters.push(2.0 * s.hypot(body.r_base()));
            coordinates.push(half + between(heights, k, columns));
        }
    }
    let amounts: Vec<f64> = grid.rows().flatten().copied().collect();
    own.set_list(&key::TOPOGRAPHY, &amounts);
    own.set_list(&key::TOPOGRAPHY_DIAMETERS, &diameters);
    own.set_list(&key::TOPOGRAPHY_COORDINATES, &coordinates);
    own.set_text(&key::TOPOGRAPHY_INTERPOLATION, "spline");
}

/// Adds planetary stages with their carriers; returns their ids.
fn carriers(to: &mut Builder, spec: &SceneSpec, shafts: &ShaftsOfGears, unit: u64) -> Vec<u64> {
    let mut stages = Vec::new();
    for body in spec.bodies().filter(|b| !b.planets.is_empty()) {
        let stage = to.add("planetary_stage", &body.name);
        let carrier = to.add("planet_carrier", &body.name);
        let arm = to.add("shaft", &format!("arm of {}", body.name));
        to.part(unit, stage);
        to.part(stage, carrier);
        to.part(carrier, arm);
        to.part(unit, arm);
        let arm_of = [("planetary_stage", stage), ("shaft", arm)];
        to.relate("planet_carrier_shaft", &arm_of);
        to.of(arm)
            .set(&key::SPEED, initial_speed(&body.mount, body.speed));
        load(to, arm, &body.name, 0.0, &body.loads);
        let mut central = Vec::new();
        for mesh in &spec.meshes {
            let [a, b] = mesh.gears;
            match [a, b].map(|g| body.planets.contains(&g)) {
                [true, false] => central.push(b),
                [false, true] => central.push(a),
                _ => {}
            }
        }
        central.sort_unstable();
        central.dedup();
        for (kind, gears) in [("planet_shaft", &body.planets), ("central_shaft", &central)] {
            for (shaft, _) in gears.iter().filter_map(|g| shafts.get(g)) {
                to.relate(kind, &[("planetary_stage", stage), ("shaft", *shaft)]);
            }
        }
        stages.push(stage);
    }
    stages
}

/// Adds a stage with the data of its gears.
fn stage(
    to: &mut Builder,
    spec: &SceneSpec,
    mesh: &MeshSpec,
    gears: &[u64],
) -> Result<u64, SceneError> {
    let [a, b] = mesh.gears.map(|i| &spec.gears[i]);
    let layout =
        mesh_layout(a, b).map_err(|e| SceneError::plain(e.to_string(), "see the scene"))?;
    let [one, two] = mesh.gears.map(|i| gears[i]);
    let id = to.add("cylindrical_stage", &format!("{} and {}", a.name, b.name));
    let refs = [("stage", id), ("gear_1", one), ("gear_2", two)];
    to.relate("stage", &refs);
    let toward: Vec<f64> = (0..2).map(|k| b.position[k] - a.position[k]).collect();
    let own = to.of(id);
    own.set(&key::CENTRE_DISTANCE, layout.distance);
    own.set(&key::STAGE_ANGLE, -toward[1].atan2(toward[0]));
    let backlash = layout.pair.backlash_normal();
    own.set(&key::LEAST_BACKLASH, backlash);
    own.set(&key::MOST_BACKLASH, backlash);
    own.set(&key::CONTACT_RATIO, layout.pair.contact_ratio());
    own.set(&key::OVERLAP_RATIO, layout.pair.overlap_ratio());
    let radii = layout.pair.pitch_radii();
    for (gear, radius) in [one, two].into_iter().zip(radii) {
        let data = to.add("cylindrical_stage_gear_data", "");
        let own = to.of(data);
        own.set(&key::PITCH, 2.0 * radius.abs());
        own.set(&key::WORKING_ANGLE, layout.working_pressure_angle);
        let refs = [("stage", id), ("gear", gear), ("stage_gear_data", data)];
        to.relate("stage_gear_data", &refs);
    }
    Ok(id)
}

/// The data of the first gear of a stage.
fn data_of(to: &Builder, stage: u64) -> Option<u64> {
    let mut all = to.model.relations_of("stage_gear_data");
    all.find(|r| r.role("stage") == Some(stage))?
        .role("stage_gear_data")
}

/// Stiffness of a mesh.
struct MeshStiffness {
    /// c' and c_gamma_alpha of ISO 6336-1 [N/m^2].
    norm: Option<[f64; 2]>,
    /// Tangent over one pitch [N/m]; empty if the model has no equilibria.
    curve: Vec<f64>,
    /// Angles of the first gear at these positions [rad], 0 at the pitch point.
    angles: Vec<f64>,
    /// Load over the face width [N/m].
    width_load: Vec<f64>,
}

impl MeshStiffness {
    fn set(&self, stage: &mut Component) {
        if let Some([single, mesh]) = self.norm {
            stage.set(&key::SINGLE_STIFFNESS, single);
            stage.set(&key::MESH_STIFFNESS, mesh);
        }
        if !self.curve.is_empty() {
            stage.set_list(&key::MESH_STIFFNESS_CURVE, &self.curve);
        }
        if self.width_load.len() > 1 {
            stage.set_list(&key::WIDTH_LOAD, &self.width_load);
        }
    }
}

/// Computes the stiffness of a mesh: by the norm, and from static equilibria of the model.
fn stiffness(
    spec: &SceneSpec,
    modelling: &Modelling,
    mesh: usize,
    models: &[GearModel],
) -> Result<MeshStiffness, String> {
    let own = &spec.meshes[mesh];
    let pair = SceneSpec {
        gears: own.gears.map(|i| spec.gears[i].clone()).to_vec(),
        meshes: vec![MeshSpec {
            gears: [0, 1],
            ..own.clone()
        }],
        shafts: Vec::new(),
        stages: Vec::new(),
        ..spec.clone()
    };
    let modelling = Modelling {
        gears: own.gears.map(|i| modelling.gears[i].clone()).to_vec(),
        contacts: vec![modelling.contacts[mesh].clone()],
    };
    let [a, b] = [&pair.gears[0], &pair.gears[1]];
    let layout = mesh_layout(a, b).map_err(|e| e.to_string())?;
    let norm = match (&a.body, &b.body) {
        (Body::Gear(gear), Body::Gear(mate)) => iso_of(
            gear,
            (Mate::Gear(mate), &layout.pair),
            [a.material, b.material],
        )
        .ok()
        .map(|iso| [iso.c_prime, iso.c_gamma_alpha]),
        _ => None,
    };
    let width = a.body.face_width().min(b.body.face_width());
    let torque = constant(&a.loads).unwrap_or_default().abs();
    let force = match (&a.body, torque > 0.0) {
        (Body::Gear(gear), true) => torque / gear.r_base(),
        _ => LINE_LOAD * width,
    };
    let mut loaded = LoadedPair::new(&pair, &modelling, models).map_err(|e| e.to_string())?;
    let cycle = MeshCycle::solve(&mut loaded, StaticLoad::Force(force), POSITIONS, |_| {})
        .map_err(|e| e.to_string())?;
    let pitch = match &a.body {
        Body::Gear(gear) => std::f64::consts::TAU / f64::from(gear.teeth()),
        Body::Rack(_) => 0.0,
    };
    let angle = |s: f64| pitch * (s - cycle.pitch_point) / cycle.base_pitch;
    Ok(MeshStiffness {
        norm,
        angles: cycle.positions.iter().map(|p| angle(p.s)).collect(),
        curve: cycle.tangent.clone(),
        width_load: width_load(&mut loaded, width),
    })
}

/// The load over the face width of the tooth pair with the largest force, at the last equilibrium [N/m]: contacts by their
/// height, each over an equal share of the width.
fn width_load(pair: &mut LoadedPair, width: f64) -> Vec<f64> {
    let contacts = pair.contacts();
    let mut by_tooth: BTreeMap<i64, f64> = BTreeMap::new();
    for c in &contacts {
        *by_tooth.entry(c.teeth[0].index).or_default() += c.normal_force;
    }
    let most = by_tooth.iter().max_by(|a, b| a.1.total_cmp(b.1));
    let Some((tooth, _)) = most else {
        return Vec::new();
    };
    let mut own: Vec<(f64, f64)> = contacts
        .iter()
        .filter(|c| c.teeth[0].index == *tooth && matches!(c.side, Side::Left | Side::Right))
        .map(|c| (c.x[2], c.normal_force))
        .collect();
    own.sort_by(|a, b| a.0.total_cmp(&b.0));
    let slices = own.len() as f64;
    own.iter()
        .map(|(_, force)| force * slices / width)
        .collect()
}

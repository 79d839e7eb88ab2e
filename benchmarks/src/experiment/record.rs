//! The record of a run: histories, energy ledger, modes, and the contact points at the largest force.

use super::history::History;
use super::run::Job;
use gearbench_integrators::State;
use gearbench_integrators::observers::ledger::Ledger;
use gearbench_integrators::system::{Outputs, Report};
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_models::scene::{Channel, OfGear, OfMesh, Scene};
use gearbench_models::spec::{
    self, Body, MeshSpec, Modelling, SceneSpec, mesh_layout, signed_base_radius,
};
use gearbench_reference::reduction::ElasticParameters;
use gearbench_reports::histories::{Histories, SprungTooth};
use gearbench_reports::record::{self, ContactPoint, ContactSnapshot, Run, finite};
use gearbench_reports::series::{
    BACKLASH_POSITION, Column, MESH_CYCLE, Quantity, SPEED, SPEED_RATIO_ERROR, TOOTH_DEFLECTION,
    TOOTH_RADIAL_FORCE, TOOTH_SPRING_FORCE, TOOTH_TANGENTIAL_FORCE, TRANSMISSION_ERROR, TimeSeries,
};

/// The columns of a row on the modes of elastic gears.
pub fn reduction(scene: &Scene, modelling: &Modelling) -> Run {
    let mut found = Run::default();
    for (gear, spec) in scene.gears().iter().zip(&modelling.gears) {
        let Some(field) = gear.model.displacement() else {
            found.modes_of_gears.push(0);
            continue;
        };
        let kept = field.mode_frequencies();
        found.modes_of_gears.push(kept.len());
        found.modes = found.modes.max(Some(kept.len()));
        found.residual = Some(found.residual.unwrap_or(false) || field.is_compliant());
        let highest = kept.iter().map(|w| w / std::f64::consts::TAU);
        found.highest_hz = highest.chain(found.highest_hz).reduce(f64::max);
        if let Some(way) = ElasticParameters::of(spec).and_then(|p| p.choose) {
            found.choose = Some(way.id().into());
        }
    }
    if found.modes.is_none() {
        found.modes_of_gears.clear();
    }
    found
}

/// The histories of a run: contact forces of all meshes and speeds of all gears, then all others.
pub fn time_series(job: &Job<'_>, scene: &Scene, history: &History) -> TimeSeries {
    let spec = job.scene;
    let values =
        |channel: Channel| (scene.channel(channel)).map_or_else(Vec::new, |c| history.column(c));
    let of_gear = |g: usize, what: OfGear| values(Channel::Gear(g, what));
    let column = |channel: Channel| Column::new(channel.column(spec), values(channel));
    let (gears, meshes) = (0..spec.gears.len(), 0..spec.meshes.len());
    let mut series = TimeSeries {
        time_s: history.time.clone(),
        ..TimeSeries::default()
    };
    let columns = &mut series.columns;
    columns.extend((meshes.clone()).map(|m| column(Channel::Mesh(m, OfMesh::Force))));
    for (g, gear) in spec.gears.iter().enumerate() {
        // That of a rack is in [m/s].
        let own = column(Channel::Gear(g, OfGear::Speed));
        if matches!(gear.body, Body::Rack(_)) {
            let turning = turning(spec, g, own.values.clone());
            columns.push(own);
            columns.push(Column::new(SPEED.of(&gear.name), turning));
        } else {
            columns.push(own);
        }
    }
    columns.extend(
        gears
            .clone()
            .map(|g| column(Channel::Gear(g, OfGear::Displacement))),
    );
    columns.extend(motion_columns(spec, &of_gear));
    if let Some(contacts) = &history.contacts {
        columns.extend(tooth_columns(spec, history, &contacts.sprung));
    }
    if job.forces {
        for (force, bearing) in [(OfMesh::X, OfGear::BearingX), (OfMesh::Y, OfGear::BearingY)] {
            columns.extend(meshes.clone().map(|m| column(Channel::Mesh(m, force))));
            columns.extend(gears.clone().map(|g| column(Channel::Gear(g, bearing))));
        }
    }
    if job.measurable {
        columns.extend(measurable(spec, values));
    }
    for m in meshes {
        columns.push(column(Channel::Mesh(m, OfMesh::Transverse)));
        if scene.meshes()[m].search.lines().is_some() {
            columns.push(column(Channel::Mesh(m, OfMesh::Pressure)));
            columns.push(column(Channel::Mesh(m, OfMesh::HalfWidth)));
        }
    }
    columns.extend(
        of_shafts(spec)
            .filter(|c| matches!(c, Channel::ShaftTorque(_)))
            .map(column),
    );
    let mut series = series.finite_prefix();
    let pieces = history.pieces.iter().flat_map(|p| &p.meshes);
    series.forces = pieces.map(|mesh| mesh.history.clone()).collect();
    series
}

/// Channels of shafts and stages: torques between members, then motions of the bodies.
fn of_shafts(spec: &SceneSpec) -> impl Iterator<Item = Channel> + '_ {
    let torques = spec.spans().len();
    let first = spec.gears.len();
    let bodies = spec.bodies().enumerate().flat_map(move |(i, body)| {
        let aside: &[OfGear] = match body.lateral {
            Some(_) => OfGear::aside(),
            None => &[],
        };
        let own = [OfGear::HubSpeed, OfGear::Displacement, OfGear::MountTorque];
        let bearing = [OfGear::BearingX, OfGear::BearingY, OfGear::BearingZ];
        let bearing = bearing.into_iter().filter(|_| !aside.is_empty());
        let all = own.into_iter().chain(bearing).chain(aside.iter().copied());
        all.map(move |what| Channel::Gear(first + i, what))
    });
    (0..torques).map(Channel::ShaftTorque).chain(bodies)
}

/// Channels of the torques of a gear.
const TORQUES: [OfGear; 2] = [OfGear::ContactTorque, OfGear::MountTorque];

/// Torques of contacts and mounts by gear, then motions and torques of bodies, from the values of their channels.
fn measurable(spec: &SceneSpec, values: impl Fn(Channel) -> Vec<f64>) -> Vec<Column> {
    let gears = spec.gears.len();
    let of_body = [OfGear::Speed, OfGear::Displacement, OfGear::MountTorque];
    let bodies = gears..gears + spec.bodies().count();
    let bodies = bodies.flat_map(|b| of_body.map(|what| Channel::Gear(b, what)));
    let gears = (0..gears).flat_map(|g| TORQUES.map(|what| Channel::Gear(g, what)));
    let channels = gears.chain(bodies);
    let column = |channel: Channel| Column::new(channel.column(spec), values(channel));
    channels.map(column).collect()
}

/// The channels of the history files of a run that are not in its series: all components of forces, torques, hub speeds,
/// tooth pairs and events.
pub fn histories(job: &Job<'_>, scene: &Scene, history: &History) -> Histories {
    let spec = job.scene;
    let rows = &history.on_grid;
    let values = |channel: Channel| -> Vec<f64> {
        (scene.channel(channel)).map_or_else(Vec::new, |c| {
            rows.iter().map(|&row| history.rows[row][c]).collect()
        })
    };
    let mut further = Vec::new();
    let mut add = |channel: Channel| {
        further.push(Column::new(channel.column(spec), values(channel)));
    };
    for m in 0..spec.meshes.len() {
        for what in [OfMesh::X, OfMesh::Y, OfMesh::Z] {
            add(Channel::Mesh(m, what));
        }
    }
    for g in 0..spec.gears.len() {
        for what in [
            OfGear::HubSpeed,
            OfGear::ContactTorque,
            OfGear::BearingX,
            OfGear::BearingY,
            OfGear::MountTorque,
        ] {
            // The series may have torques already.
            if !(job.measurable && TORQUES.contains(&what)) {
                add(Channel::Gear(g, what));
            }
        }
        if spec.gears[g].lateral.is_some() {
            add(Channel::Gear(g, OfGear::BearingZ));
            (OfGear::aside().iter()).for_each(|what| add(Channel::Gear(g, *what)));
        }
    }
    of_shafts(spec)
        .filter(|c| matches!(c, Channel::Gear(..)))
        .for_each(&mut add);
    let (pairs, events) = (history.contacts.as_ref())
        .map_or_else(Default::default, |c| (c.pairs.clone(), c.events.clone()));
    Histories {
        series: None,
        on_grid: rows.clone(),
        further,
        pairs,
        events,
    }
}

/// Angular speeds of a gear [rad/s]; for a rack its speed over the reference radius of the first gear that it meshes
/// with.
fn turning(scene: &SceneSpec, gear: usize, mut speed: Vec<f64>) -> Vec<f64> {
    let Some(Body::Rack(_)) = scene.gears.get(gear).map(|g| &g.body) else {
        return speed;
    };
    let mate = scene.meshes.iter().find_map(|m| match m.gears {
        [a, b] if a == gear => Some(b),
        [a, b] if b == gear => Some(a),
        _ => None,
    });
    if let Some(Body::Gear(mate)) = mate.map(|i| &scene.gears[i].body) {
        speed.iter_mut().for_each(|v| *v /= mate.r_reference());
    }
    speed
}

/// The carrier of a planet gear, as index of a member behind the gears.
pub fn carrier_of(scene: &SceneSpec, gear: usize) -> Option<usize> {
    let carries = scene.bodies().position(|b| b.planets.contains(&gear));
    carries.map(|body| scene.gears.len() + body)
}

/// Transmission error of a mesh [m], [`spec::transmission_error`]; in a planetary set from the motions relative to its
/// carrier.
fn transmission_error(
    scene: &SceneSpec,
    mesh: usize,
    displacement: impl Fn(usize) -> Vec<f64>,
) -> Option<Vec<f64>> {
    let mesh = scene.meshes.get(mesh)?;
    let of = spec::transmission_error(mesh, &scene.gears);
    let [x, y] = seen_from_carrier(scene, mesh, displacement);
    Some(x.iter().zip(&y).map(|(x, y)| of(*x, *y)).collect())
}

/// Motions of both gears of a mesh from the motion of each hub; in a planetary set relative to the carrier.
fn seen_from_carrier(
    scene: &SceneSpec,
    mesh: &MeshSpec,
    of_hub: impl Fn(usize) -> Vec<f64>,
) -> [Vec<f64>; 2] {
    let mut motions = mesh.gears.map(&of_hub);
    let carrier = mesh.gears.into_iter().find_map(|g| carrier_of(scene, g));
    if let Some(carried) = carrier.map(of_hub) {
        for motion in &mut motions {
            motion.iter_mut().zip(&carried).for_each(|(x, c)| *x -= c);
        }
    }
    motions
}

/// Cycles of a mesh since the start, from the rotation of its first toothed wheel; in a planetary set relative to its
/// carrier.
fn mesh_cycles(
    scene: &SceneSpec,
    mesh: usize,
    displacement: impl Fn(usize) -> Vec<f64>,
) -> Option<Vec<f64>> {
    let mesh = scene.meshes.get(mesh)?;
    let turns = seen_from_carrier(scene, mesh, displacement);
    let (teeth, mut turn) =
        (mesh.gears.into_iter().zip(turns)).find_map(|(g, turn)| match &scene.gears[g].body {
            Body::Gear(body) => Some((f64::from(body.teeth()), turn)),
            Body::Rack(_) => None,
        })?;
    for x in &mut turn {
        *x = teeth * *x / std::f64::consts::TAU;
    }
    Some(turn)
}

/// Range of the position in the backlash that the motion must exceed to be recorded: both flanks are then close to
/// contact.
const HAMMERING: [f64; 2] = [0.25, 0.75];
/// Least ratio of the lowest to the highest speed of the second gear for which the error of the speed ratio is
/// recorded.
const TURNING: f64 = 0.5;

/// Columns of each mesh: transmission error, mesh cycles, position of the tooth in the backlash, if it crosses the
/// backlash, and error of the speed ratio, if both gears keep rotating.
fn motion_columns(spec: &SceneSpec, of_gear: &impl Fn(usize, OfGear) -> Vec<f64>) -> Vec<Column> {
    let displacement = |g: usize| of_gear(g, OfGear::Displacement);
    let of_mesh = |(m, mesh): (usize, &MeshSpec)| {
        let names = spec.names_of(mesh.gears);
        let column = move |quantity: Quantity, values: Option<Vec<f64>>| {
            Some(Column::new(quantity.of_mesh(&names), values?))
        };
        let speed_ratio = speed_ratio_error(spec, m, |g| of_gear(g, OfGear::HubSpeed));
        [
            column(
                TRANSMISSION_ERROR,
                transmission_error(spec, m, displacement),
            ),
            column(MESH_CYCLE, mesh_cycles(spec, m, displacement)),
            column(BACKLASH_POSITION, backlash_position(spec, m, displacement)),
            column(SPEED_RATIO_ERROR, speed_ratio),
        ]
    };
    let all = spec.meshes.iter().enumerate().flat_map(of_mesh);
    all.flatten().collect()
}

fn span(values: &[f64]) -> [f64; 2] {
    (values.iter()).fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], &x| {
        [a.min(x), b.max(x)]
    })
}

/// Position of the tooth in the backlash: 0 at load-free contact of the flank of the start, 1 at load-free contact of
/// the other flank.
fn backlash_position(
    spec: &SceneSpec,
    m: usize,
    displacement: impl Fn(usize) -> Vec<f64>,
) -> Option<Vec<f64>> {
    let [a, b] = spec.meshes[m].gears.map(|i| &spec.gears[i]);
    let backlash = mesh_layout(a, b).ok()?.backlash;
    if backlash <= 0.0 {
        return None;
    }
    let error = transmission_error(spec, m, displacement)?;
    let place: Vec<f64> = error.iter().map(|e| -e / backlash).collect();
    let [least, most] = span(&place);
    (least < HAMMERING[0] && most > HAMMERING[1]).then_some(place)
}

/// Error of the speed ratio of the hubs, `-(r_b1 omega_1)/(r_b2 omega_2) - 1`.
fn speed_ratio_error(
    spec: &SceneSpec,
    m: usize,
    speed: impl Fn(usize) -> Vec<f64>,
) -> Option<Vec<f64>> {
    let mesh = &spec.meshes[m];
    let [ra, rb] = mesh.gears.map(|i| signed_base_radius(&spec.gears[i].body));
    let [x, y] = seen_from_carrier(spec, mesh, speed);
    let [least, most] = span(&y);
    let turns =
        least * most > 0.0 && least.abs().min(most.abs()) > TURNING * least.abs().max(most.abs());
    let error = |(x, y): (&f64, &f64)| -(ra * x) / (rb * y) - 1.0;
    turns.then(|| x.iter().zip(&y).map(error).collect())
}

/// Of each gear whose teeth move on springs the deflection of the tooth whose spring is loaded most, among those that touch,
/// and the forces on it; 0 while none does. `sprung` has the touching teeth by time and gear, ascending in time.
fn tooth_columns(
    spec: &SceneSpec,
    history: &History,
    sprung: &[(f64, usize, SprungTooth)],
) -> Vec<Column> {
    let mut found = Vec::new();
    for (g, gear) in spec.gears.iter().enumerate() {
        if sprung.iter().all(|(_, of, _)| *of != g) {
            continue;
        }
        let at = |t: &f64| {
            let first = sprung.partition_point(|(time, ..)| time < t);
            let here = sprung[first..].iter().take_while(|(time, ..)| time == t);
            let own = here.filter(|(_, of, _)| *of == g).map(|(.., tooth)| tooth);
            let most = own.max_by(|a, b| a.spring_n.abs().total_cmp(&b.spring_n.abs()));
            most.copied().unwrap_or_default()
        };
        let teeth: Vec<SprungTooth> = history.time.iter().map(at).collect();
        let deflection = match gear.body {
            Body::Rack(_) => TOOTH_DEFLECTION.in_unit("m"),
            Body::Gear(_) => TOOTH_DEFLECTION,
        };
        type ToothField = fn(&SprungTooth) -> f64;
        let quantities: [(Quantity, ToothField); 4] = [
            (deflection, |t| t.deflection),
            (TOOTH_RADIAL_FORCE, |t| t.radial_n),
            (TOOTH_TANGENTIAL_FORCE, |t| t.tangential_n),
            (TOOTH_SPRING_FORCE, |t| t.spring_n),
        ];
        found.extend(quantities.map(|(quantity, value)| {
            Column::new(quantity.of(&gear.name), teeth.iter().map(value).collect())
        }));
    }
    found
}

/// Momentum of each gear along its line of action, `L / r_b` [N s].
pub fn momenta(scene: &mut Scene, state: &State) -> Vec<f64> {
    let mut out = Outputs::default();
    scene.output(state.at(), &mut out);
    scene
        .gears()
        .iter()
        .map(|g| g.model.hub_state(g.at(state.at())).momentum)
        .collect()
}

/// Impulse of the transverse force from the samples of a series [N s], of the mesh where it is largest.
pub fn sampled_impulse(spec: &SceneSpec, series: &TimeSeries) -> f64 {
    let of_mesh = |mesh: usize| -> f64 {
        let name = Channel::Mesh(mesh, OfMesh::Transverse).column(spec);
        let transverse = series.column(&name).unwrap_or_default();
        (series.time_s.windows(2).zip(transverse.windows(2)))
            .map(|(t, f)| 0.5 * (t[1] - t[0]) * (f[0] + f[1]))
            .sum()
    };
    (0..spec.meshes.len()).map(of_mesh).fold(0.0, f64::max)
}

/// The energy and impulse balance of a run; the impulse is that of the force in the transverse plane, which contains
/// the lines of action.
pub fn ledger_record(
    job: &Job<'_>,
    ledger: &Ledger,
    impulse: f64,
    momenta: Option<[Vec<f64>; 2]>,
) -> record::Ledger {
    // Without loads a mesh of two free gears keeps L1/r1 - L2/r2 (both counter-clockwise positive) as long as
    // its forces stay on the lines of action.
    let two_free = job.scene.gears.len() == 2
        && !job.scene.joins_members()
        && job.scene.gears.iter().all(|g| {
            g.loads.is_empty()
                && g.lateral.is_none()
                && g.guide.is_none()
                && matches!(
                    g.mount,
                    gearbench_models::spec::Mount::Revolute
                        | gearbench_models::spec::Mount::Prismatic
                )
        });
    let drift = momenta.filter(|_| two_free).map(|[start, end]| {
        let r = [
            signed_base_radius(&job.scene.gears[0].body),
            signed_base_radius(&job.scene.gears[1].body),
        ];
        let change: Vec<f64> = start.iter().zip(&end).map(|(a, b)| b - a).collect();
        let moved = (change[0] / r[0]).abs().max(f64::MIN_POSITIVE);
        (change[0] / r[0] - change[1] / r[1]) / moved
    });
    let e = ledger.end;
    record::Ledger {
        energy_start_j: ledger.start.and_then(|e| finite(e.total())),
        energy_end_j: finite(e.total()),
        kinetic_j: finite(e.kinetic),
        strain_j: finite(e.strain),
        contact_j: finite(e.contact),
        external_work_j: finite(ledger.external),
        // What a damper leaves in the contact when it lets go is lost there and then.
        dissipated_j: finite(ledger.dissipated + (ledger.gained - ledger.jumps)),
        jumps_j: finite(ledger.gained),
        residual_j: finite(ledger.residual()),
        residual_rel: finite(ledger.residual_relative()),
        vibrating_j: finite(ledger.vibrating()),
        impulse_ns: finite(impulse),
        invariant_drift_rel: drift.and_then(finite),
    }
}

/// The mesh at one state: contacts with their forces.
pub fn snapshot(spec: &SceneSpec, scene: &mut Scene, state: &State) -> ContactSnapshot {
    let forces = scene.contact_forces(state.at());
    let line = forces.first().and_then(|f| scene.line_of_action(f));
    let contacts = forces
        .iter()
        .map(|f| ContactPoint {
            point: scene.in_plane(&f.x),
            force: scene.in_plane(&f.force),
            pair: pair_name(spec, f),
            pressure_pa: f.pressure.and_then(|p| finite(p.peak)),
            half_width_m: f.pressure.and_then(|p| finite(p.half_width)),
        })
        .collect();
    ContactSnapshot {
        time_s: state.t,
        outlines: Vec::new(),
        line_of_action: line,
        contacts,
        flanks: Vec::new(),
        deformed: Vec::new(),
    }
}

/// Name of the tooth pair of a contact; teeth are counted from 1 within each gear.
fn pair_name(spec: &SceneSpec, f: &gearbench_models::scene::ContactForce) -> String {
    let [a, b] = tooth_numbers(spec, f.mesh, f.teeth.map(|t| t.index));
    format!("{a}-{b}")
}

/// Returns the numbers of the teeth of a contact, counted from 1 within each gear.
pub fn tooth_numbers(spec: &SceneSpec, mesh: usize, indices: [i64; 2]) -> [i64; 2] {
    let gears = spec.meshes[mesh].gears;
    [0, 1].map(|k| {
        let teeth = match &spec.gears[gears[k]].body {
            Body::Gear(g) => i64::from(g.teeth()),
            Body::Rack(r) => i64::from(r.teeth()),
        };
        indices[k].rem_euclid(teeth) + 1
    })
}

//! Paths of torque and power through a train, from the histories of a run.
//!
//! ```text
//! P_m = -mean(T_1 omega_1),   s_k = F_k / sum F,   K_gamma = N max F_k / sum F,   W_i = sum (T_i + T_(i+1))/2 (phi_(i+1) - phi_i)
//! ```
//!
//! Means are over the second half of a run, by the trapezoidal rule, as the first half contains the start. Works of
//! loads are sums over the rotation of their hub, exact for constant torques; those of drives over torque and rotation
//! on the grid.

use super::history::History;
use super::record::carrier_of;
use gearbench_integrators::observers::ledger::Ledger;
use gearbench_models::scene::{Channel, OfGear, OfMesh, Scene};
use gearbench_models::spec::{Mount, SceneSpec};
use gearbench_reports::record::{
    MemberPath, MeshPath, PlanetShare, ShaftPath, Sharing, TorquePaths,
};

/// Share of the duration before means are taken.
const ONSET: f64 = 0.5;
/// Forces below this share of the greatest count as zero: load shares of zero are undefined.
const NOTHING: f64 = 1e-3;

/// Histories at the sampling times.
struct Grid<'a> {
    scene: &'a Scene,
    history: &'a History,
    /// Rows of the history at the sampling times, and the first one that means include.
    rows: Vec<usize>,
    from: usize,
}

impl Grid<'_> {
    fn time(&self, i: usize) -> f64 {
        self.history.time[self.rows[i]]
    }

    /// Values of a channel at the sampling times; zeros if the scene does not have it.
    fn column(&self, channel: Channel) -> Vec<f64> {
        let place = self.scene.channel(channel);
        let value = |row: &usize| place.map_or(0.0, |c| self.history.rows[*row][c]);
        self.rows.iter().map(value).collect()
    }

    /// Mean over the time from the onset on.
    fn mean(&self, value: impl Fn(usize) -> f64) -> f64 {
        self.mean_within([self.from, self.rows.len() - 1], value)
    }

    /// Mean over the time from one sample to another.
    fn mean_within(&self, [from, to]: [usize; 2], value: impl Fn(usize) -> f64) -> f64 {
        let span = self.time(to) - self.time(from);
        let sum: f64 = (from..to)
            .map(|i| 0.5 * (self.time(i + 1) - self.time(i)) * (value(i) + value(i + 1)))
            .sum();
        sum / span
    }

    /// Means over both halves of the time from the onset on.
    fn halves(&self, values: &[f64]) -> [f64; 2] {
        let last = self.rows.len() - 1;
        let middle = (self.from + last) / 2;
        [[self.from, middle], [middle, last]].map(|part| self.mean_within(part, |i| values[i]))
    }
}

/// Work of a torque over the rotation from a sample on [J].
fn work(torque: &[f64], angle: &[f64], from: usize) -> f64 {
    let turns = angle[from..].windows(2).map(|w| w[1] - w[0]);
    let means = torque[from..].windows(2).map(|w| 0.5 * (w[0] + w[1]));
    turns.zip(means).map(|(turn, torque)| turn * torque).sum()
}

/// True if a scene has several paths of torque: more than one mesh, shafts or stages.
pub fn has_train(spec: &SceneSpec) -> bool {
    spec.meshes.len() > 1 || spec.joins_members()
}

/// Computes the torque paths of a scene; `None` for a run that ended too early.
pub fn torque_paths(
    spec: &SceneSpec,
    scene: &Scene,
    history: &History,
    ledger: &Ledger,
) -> Option<TorquePaths> {
    let finite = |row: &usize| history.rows[*row].iter().all(|x| x.is_finite());
    let rows: Vec<usize> = (history.on_grid.iter().copied())
        .take_while(finite)
        .collect();
    let last = history.time[*rows.last()?];
    let from = rows.partition_point(|row| history.time[*row] < ONSET * last);
    if rows.len() < from + 3 {
        return None;
    }
    let grid = Grid {
        scene,
        history,
        rows,
        from,
    };
    let members = members(spec, &grid);
    let input: f64 = members.iter().map(|m| m.power_w.max(0.0)).sum();
    let works = members.iter().map(|m| m.work_j);
    let (work_in, work_out) = works.fold((0.0, 0.0), |(given, taken), w| {
        (given + w.max(0.0), taken - w.min(0.0))
    });
    // As in the record: what a damper leaves in a contact that opens is lost there and then.
    let dissipated = ledger.dissipated + (ledger.gained - ledger.jumps);
    let stored = ledger.end.total() - ledger.start.map_or(0.0, |e| e.total());
    let paths = TorquePaths {
        from_s: grid.time(from),
        to_s: last,
        change_rel: change(spec, &grid, input),
        input_w: input,
        meshes: (0..spec.meshes.len())
            .map(|m| of_mesh(spec, &grid, m, input))
            .collect(),
        shafts: shafts(spec, &grid),
        sharing: sharing(spec, &grid),
        members,
        work_in_j: work_in,
        work_out_j: work_out,
        dissipated_j: dissipated,
        stored_j: stored,
        unexplained_j: work_in - work_out - dissipated - stored,
    };
    Some(paths).filter(TorquePaths::is_finite)
}

/// Relative change of the means of a run between both halves of their time, [`TorquePaths::change_rel`].
fn change(spec: &SceneSpec, grid: &Grid<'_>, input: f64) -> f64 {
    let torques: Vec<[f64; 2]> = (0..spec.meshes.len())
        .flat_map(|m| OfMesh::TORQUES.map(|what| grid.halves(&grid.column(Channel::Mesh(m, what)))))
        .collect();
    // Of a torque that is small next to the others the change is small next to them.
    let relative = |[a, b]: &[f64; 2]| (b - a).abs() / a.abs().max(b.abs()).max(f64::MIN_POSITIVE);
    let largest = torques
        .iter()
        .flatten()
        .fold(0.0_f64, |most, x| most.max(x.abs()));
    let loaded = torques
        .iter()
        .filter(|[a, b]| a.abs().max(b.abs()) > NOTHING * largest);
    let of_meshes = loaded.map(relative).fold(0.0, f64::max);
    let between = 0.5 * (grid.time(grid.rows.len() - 1) - grid.time(grid.from));
    let accelerates = |i: usize| {
        let [a, b] = grid.halves(&grid.column(Channel::Gear(i, OfGear::HubSpeed)));
        let hub = &grid.scene.gears()[i].model.hub().hub;
        match hub.is_free() {
            true => 0.5 * (a + b) * hub.inertia * (b - a) / between,
            false => 0.0,
        }
    };
    let members = spec.gears.len() + spec.bodies().count();
    let power: f64 = (0..members).map(accelerates).sum();
    let of_speeds = if input > 0.0 {
        power.abs() / input
    } else {
        0.0
    };
    of_meshes.max(of_speeds)
}

fn members(spec: &SceneSpec, grid: &Grid<'_>) -> Vec<MemberPath> {
    let mounts = spec.gears.iter().map(|g| &g.mount);
    let mounts = mounts.chain(spec.bodies().map(|b| &b.mount));
    let of = |(i, mount): (usize, &Mount)| {
        let column = |what| grid.column(Channel::Gear(i, what));
        let (angle, speed) = (column(OfGear::Displacement), column(OfGear::HubSpeed));
        let gear = &grid.scene.gears()[i];
        let load: Vec<f64> = (speed.iter().enumerate())
            // The empty sum is less than zero.
            .map(|(k, speed)| gear.load(grid.time(k), *speed) + 0.0)
            .collect();
        let held = column(OfGear::MountTorque);
        let driven = matches!(mount, Mount::Driven(_));
        // A hub that is held does no work, and a load on one that is driven is taken by its drive.
        let exerted: Vec<f64> = match mount {
            Mount::Fixed => vec![0.0; load.len()],
            _ if driven => held.clone(),
            _ => load.clone(),
        };
        let forces = [OfGear::BearingX, OfGear::BearingY, OfGear::BearingZ].map(column);
        let bearing = |k: usize| forces.iter().map(|f| f[k] * f[k]).sum::<f64>().sqrt();
        let span = grid.time(grid.rows.len() - 1) - grid.time(grid.from);
        let contact = column(OfGear::ContactTorque);
        MemberPath {
            name: spec.member_name(i).to_owned(),
            speed_rad_s: (angle[angle.len() - 1] - angle[grid.from]) / span,
            load_nm: grid.mean(|k| load[k]),
            mount_nm: grid.mean(|k| held[k]),
            contact_nm: grid.mean(|k| contact[k]),
            power_w: work(&exerted, &angle, grid.from) / span,
            bearing_n: grid.mean(bearing),
            work_j: work(&exerted, &angle, 0),
        }
    };
    mounts.enumerate().map(of).collect()
}

fn of_mesh(spec: &SceneSpec, grid: &Grid<'_>, m: usize, input: f64) -> MeshPath {
    let gears = spec.meshes[m].gears;
    let force = grid.column(Channel::Mesh(m, OfMesh::Force));
    let torques = OfMesh::TORQUES.map(|what| grid.column(Channel::Mesh(m, what)));
    let speeds = gears.map(|g| grid.column(Channel::Gear(g, OfGear::HubSpeed)));
    let carriers = gears.map(|g| carrier_of(spec, g));
    let carrier = carriers[0].or(carriers[1]);
    let carried = carrier.map(|c| grid.column(Channel::Gear(c, OfGear::HubSpeed)));
    let seen = |k: usize, i: usize| speeds[k][i] - carried.as_ref().map_or(0.0, |c| c[i]);
    // The pin also transmits power to a planet. The power of the mesh is therefore taken from the mate, whose axis is
    // fixed.
    let power = match carriers[0] {
        None => grid.mean(|i| -torques[0][i] * speeds[0][i]),
        Some(_) => grid.mean(|i| torques[1][i] * speeds[1][i]),
    };
    MeshPath {
        gears: spec.names_of(gears).map(str::to_owned),
        force_n: grid.mean(|i| force[i]),
        torque_nm: [0, 1].map(|k| grid.mean(|i| torques[k][i])),
        power_w: power,
        share: (input > 0.0).then(|| power.abs() / input),
        rolling_w: carrier.map(|_| grid.mean(|i| -torques[0][i] * seen(0, i))),
        loss_w: grid.mean(|i| -torques[0][i] * seen(0, i) - torques[1][i] * seen(1, i)),
    }
}

fn shafts(spec: &SceneSpec, grid: &Grid<'_>) -> Vec<ShaftPath> {
    let of = |(span, members): (usize, [usize; 2])| {
        let torque = grid.column(Channel::ShaftTorque(span));
        let speed = grid.column(Channel::Gear(members[1], OfGear::HubSpeed));
        ShaftPath {
            torque_nm: grid.mean(|i| torque[i]),
            power_w: grid.mean(|i| torque[i] * speed[i]),
            between: members.map(|i| spec.member_name(i).to_owned()),
        }
    };
    spec.spans().into_iter().enumerate().map(of).collect()
}

fn sharing(spec: &SceneSpec, grid: &Grid<'_>) -> Vec<Sharing> {
    let mut all = Vec::new();
    for carrier in spec.bodies().filter(|b| b.planets.len() > 1) {
        for gear in 0..spec.gears.len() {
            // Meshes of planets with this gear; planets that mesh with each other are none.
            let meshes: Vec<(usize, usize)> = (spec.meshes.iter().enumerate())
                .filter_map(|(m, mesh)| {
                    let [a, b] = mesh.gears;
                    let planet = if a == gear { b } else { a };
                    let own = mesh.gears.contains(&gear) && carrier.planets.contains(&planet);
                    (own && !carrier.planets.contains(&gear)).then_some((m, planet))
                })
                .collect();
            if meshes.len() > 1 {
                all.extend(shared(spec, grid, (&carrier.name, gear), &meshes));
            }
        }
    }
    all
}

fn shared(
    spec: &SceneSpec,
    grid: &Grid<'_>,
    (carrier, gear): (&str, usize),
    meshes: &[(usize, usize)],
) -> Option<Sharing> {
    let of = |(m, _): &(usize, usize)| grid.column(Channel::Mesh(*m, OfMesh::Force));
    let forces: Vec<Vec<f64>> = meshes.iter().map(of).collect();
    let sum = |i: usize| forces.iter().map(|f| f[i]).sum::<f64>();
    let times = grid.from..grid.rows.len();
    let most = times.clone().map(sum).fold(0.0, f64::max);
    let loaded: Vec<usize> = times.filter(|i| sum(*i) > NOTHING * most).collect();
    if loaded.is_empty() {
        return None;
    }
    let means: Vec<f64> = forces.iter().map(|f| grid.mean(|i| f[i])).collect();
    let all: f64 = means.iter().sum();
    let n = meshes.len() as f64;
    let greatest = |k: usize| {
        loaded
            .iter()
            .map(|i| forces[k][*i] / sum(*i))
            .fold(0.0, f64::max)
    };
    let least = |k: usize| {
        let shares = loaded.iter().map(|i| forces[k][*i] / sum(*i));
        shares.fold(f64::INFINITY, f64::min)
    };
    let planets: Vec<PlanetShare> = (meshes.iter().enumerate())
        .map(|(k, (_, planet))| PlanetShare {
            planet: spec.gears[*planet].name.clone(),
            mean: means[k] / all,
            least: least(k),
            greatest: greatest(k),
        })
        .collect();
    let largest = |of: fn(&PlanetShare) -> f64| planets.iter().map(of).fold(0.0, f64::max);
    Some(Sharing {
        carrier: carrier.to_owned(),
        gear: spec.gears[gear].name.clone(),
        factor: n * largest(|p| p.mean),
        factor_greatest: n * largest(|p| p.greatest),
        planets,
    })
}

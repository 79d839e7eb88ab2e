//! Detection of missed contacts (tunnelling).
//!
//! The displacements of both hubs determine how far the flanks of rigid teeth would overlap along the line of action:
//! the approach less the gap at the start or, on the other flank, less the rest of the backlash. The overlap of elastic
//! teeth is at most their deflection, and what the teeth in contact recede from those at the start by their deviations.
//! A contact was missed if
//!
//! - the overlap is larger than any deflection, a tenth of the module: teeth passed through each other;
//! - it is clearly larger than the deflection, and no force acts: an overlap without contact force;
//! - within one step the flanks touched and separated again, and the scene's own search finds a contact at the point of
//!   return, but the speeds changed as without a contact: the step passed over it.

use super::Finding;
use gearbench_integrators::{AcceptedStep, Outputs, SecondOrderSystem, State};
use gearbench_models::kinematics::Hub;
use gearbench_models::scene::{Channel, OfGear, OfMesh, Scene};
use gearbench_models::spec::{Body, SceneSpec, mesh_layout, signed_effective_radius};
use gearbench_reports::record::Status;
use std::ops::Range;

/// Overlap beyond which teeth have passed through each other, in modules.
const PASSED: f64 = 0.1;
/// Overlap without a force that no relief of the flanks explains, in modules.
const UNSEEN: f64 = 0.03;
/// Overlap without a force that no relief explains, in typical deflections of the scene; it decides for soft contacts.
const DEFLECTIONS: f64 = 4.0;
/// Overlap at a point of return, in typical deflections, from which on a contact counts as missed.
const GRAZE: f64 = 0.01;
/// Change of speed beyond that by loads, relative to the total change, that indicates a contact force.
const FELT: f64 = 0.25;

/// Rigid geometry of a mesh.
struct Pair {
    hubs: [(Hub, Range<usize>); 2],
    /// Approach along the flank normal by unit displacement of each hub [m].
    effective_radii: [f64; 2],
    /// Approach along the flank normal by unit displacement in the out-of-plane directions of each hub.
    lateral: [[f64; 6]; 2],
    /// Gap at the start, and backlash, along the flank normal [m].
    gap: f64,
    backlash: f64,
    module: f64,
    /// Largest change of the gap by deviations of the teeth in contact from those at the start [m].
    deviation: f64,
    displacement: [usize; 2],
    /// Coordinate and channel of the carrier of a planetary set, relative to which the gears move.
    carrier: Option<[usize; 2]>,
    /// Channels of the first five out-of-plane directions.
    sideways: [Vec<usize>; 2],
    force: usize,
    /// Rate of change of the approach velocity by loads alone [m/s^2], from the last step without contact.
    free: Option<f64>,
}

impl Pair {
    /// Approach [m] and its rate [m/s].
    fn at(&self, s: &State) -> [f64; 2] {
        let mut sum = [0.0; 2];
        if let Some([carrier, _]) = self.carrier {
            let both = self.effective_radii[0] + self.effective_radii[1];
            sum = [-both * s.q[carrier], -both * s.v[carrier]];
        }
        for (((hub, own), radius), lateral) in
            (self.hubs.iter().zip(self.effective_radii)).zip(&self.lateral)
        {
            let (q, v) = (&s.q[own.clone()], &s.v[own.clone()]);
            sum[0] += radius * hub.displacement(s.t, q);
            sum[1] += radius * hub.speed(s.t, v);
            if hub.lateral.is_some() {
                let motion = hub.motion(s.t, q, v);
                for (d, along) in lateral.iter().enumerate() {
                    sum[0] += along * motion.x[d];
                    sum[1] += along * motion.v[d];
                }
            }
        }
        sum
    }

    /// Largest overlap [m] that a share of the module, or else the softness of a contact, explains. Teeth may recede
    /// from those at the start by their deviations.
    fn explained(&self, share: f64, soft: f64) -> f64 {
        (share * self.module).max(soft) + self.deviation
    }

    /// Overlap on the closer flank [m]; negative if both flanks are apart.
    fn depth(&self, approach: f64) -> f64 {
        (approach - self.gap).max(-approach - (self.backlash - self.gap))
    }
}

/// Returns the range of the deviations of the teeth of a body from their common position [m].
fn deviation_of(body: &Body) -> f64 {
    match body {
        Body::Gear(gear) => 2.0 * gear.greatest_tooth_deviation(),
        Body::Rack(_) => 0.0,
    }
}

/// Detects missed contacts of the meshes of a run.
pub struct TunnellingDetector {
    pairs: Vec<(usize, Pair)>,
    /// Names of the gears of each mesh.
    names: Vec<[String; 2]>,
    deflection: f64,
    /// Mesh, time [s] and overlap [m] of the first contact in which teeth passed through each other.
    passed: Option<(usize, f64, f64)>,
    grazed: Option<(usize, f64, f64)>,
    /// Mesh, time [s] and overlap [m] of the largest overlap above a tenth of the module.
    deepest: Option<(usize, f64, f64)>,
    inside: State,
    out: Outputs,
}

impl TunnellingDetector {
    /// Creates a detector for the meshes of a scene, except for those whose gap does not follow from rigid
    /// displacements.
    pub fn new(spec: &SceneSpec, scene: &Scene) -> Self {
        let pair = |m: usize| {
            let mesh = &spec.meshes[m];
            let [a, b] = mesh.gears.map(|i| &spec.gears[i]);
            let layout = mesh_layout(a, b).ok()?;
            let Body::Gear(gear) = &a.body else {
                return None;
            };
            let hubs = mesh.gears.map(|i| {
                let g = &scene.gears()[i];
                (g.model.hub().hub.clone(), g.range())
            });
            let carrier = scene.carrier_of_mesh(m);
            if carrier.is_some() && hubs.iter().any(|(hub, _)| hub.lateral.is_some()) {
                return None;
            }
            let carrier = match carrier {
                Some((coordinate, body)) => {
                    let channel = Channel::Gear(body, OfGear::Displacement);
                    Some([coordinate, scene.channel(channel)?])
                }
                None => None,
            };
            let mut lateral = [[0.0; 6]; 2];
            let pairs = scene.meshes()[m].search.pairs();
            if let Some((x, n)) = pairs.and_then(|p| p.middle_of(mesh.start.side)) {
                for (k, (hub, _)) in hubs.iter().enumerate() {
                    for d in (0..6).filter(|d| *d != hub.moving()) {
                        let along = hub.component(d, &x, &n);
                        lateral[k][d] = if k == 0 { along } else { -along };
                    }
                }
            }
            let displacement = |i: usize| scene.channel(Channel::Gear(i, OfGear::Displacement));
            Some((
                m,
                Pair {
                    hubs,
                    carrier,
                    lateral,
                    effective_radii: [a, b]
                        .map(|g| mesh.start.side.sign() * signed_effective_radius(&g.body)),
                    gap: mesh.start.gap,
                    backlash: layout.pair.backlash_normal(),
                    module: gear.params().module,
                    deviation: [a, b].map(|g| deviation_of(&g.body)).iter().sum(),
                    displacement: [displacement(mesh.gears[0])?, displacement(mesh.gears[1])?],
                    sideways: mesh.gears.map(|i| {
                        let channels = OfGear::aside().iter().map(|what| Channel::Gear(i, *what));
                        channels.filter_map(|c| scene.channel(c)).collect()
                    }),
                    force: scene.channel(Channel::Mesh(m, OfMesh::Force))?,
                    free: None,
                },
            ))
        };
        TunnellingDetector {
            pairs: (0..spec.meshes.len()).filter_map(pair).collect(),
            names: (spec.meshes.iter())
                .map(|m| spec.names_of(m.gears).map(str::to_owned))
                .collect(),
            deflection: scene.magnitudes().deflection,
            passed: None,
            grazed: None,
            deepest: None,
            inside: State::default(),
            out: Outputs::default(),
        }
    }

    /// Checks an accepted step.
    pub fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) {
        let h = step.to.t - step.from.t;
        for (m, pair) in &mut self.pairs {
            let ([x0, r0], [x1, r1]) = (pair.at(step.from), pair.at(step.to));
            let depth = pair.depth(x1);
            let soft = DEFLECTIONS * self.deflection;
            if depth > pair.explained(PASSED, soft) && self.passed.is_none() {
                self.passed = Some((*m, step.to.t, depth));
            }
            let deflected = depth - pair.deviation;
            if deflected > PASSED * pair.module
                && self.deepest.is_none_or(|(_, _, most)| deflected > most)
            {
                self.deepest = Some((*m, step.to.t, deflected));
            }
            if step.flight || h <= 0.0 {
                continue;
            }
            let open = pair.depth(x0) <= 0.0 && depth <= 0.0;
            let change = r1 - r0;
            let known = pair.free;
            if open {
                pair.free = Some(change / h);
            }
            // The flanks came closer and went away again within the step.
            let nearest = |flank: f64| flank * r0 > 0.0 && flank * r1 < 0.0;
            if !open || self.grazed.is_some() || !(nearest(1.0) || nearest(-1.0)) {
                continue;
            }
            let by_loads = known.is_some_and(|a| (change - a * h).abs() <= FELT * change.abs());
            let theta = r0 / (r0 - r1);
            let overlap = pair.depth(x0 + 0.5 * theta * h * r0);
            if !by_loads || overlap <= GRAZE * self.deflection {
                continue;
            }
            self.inside.copy_from(step.from);
            let State { t, q, v, discrete } = &mut self.inside;
            *t = step.from.t + theta * h;
            step.dense.eval(theta, q, v);
            // The force of a scene without located events, whatever the branch.
            discrete[0] = 0.0;
            sys.output(self.inside.at(), &mut self.out);
            if self.out.channels[pair.force] > 0.0 {
                self.grazed = Some((*m, self.inside.t, overlap));
            }
        }
    }

    /// A warning if teeth overlap by more than a tenth of the module: contact laws and linear elasticity are not valid
    /// there.
    pub(super) fn warning(&self) -> Option<String> {
        let (m, time, depth) = self.deepest?;
        let (_, pair) = self.pairs.iter().find(|(mesh, _)| *mesh == m)?;
        let [first, second] = &self.names[m];
        Some(format!(
            "the teeth of `{first}` and `{second}` deflect by up to {depth:.3e} m (at t = {time:.4e} s), {:.2} of the module; contact laws and linear teeth are not valid above {PASSED}: reduce speeds or loads, or check the stiffness",
            depth / pair.module
        ))
    }

    /// Returns the first missed contact. `rows` are times and channels of the run, `forces` the channels of the mesh
    /// forces.
    pub(super) fn finding<'a>(
        &self,
        rows: impl Iterator<Item = (&'a f64, &'a Vec<f64>)>,
        forces: &[usize],
        located: bool,
    ) -> Option<Finding> {
        let mut passed = self.passed;
        let mut unseen = None;
        for (t, row) in rows {
            for (m, pair) in &self.pairs {
                let along = |k: usize| {
                    let own = pair.effective_radii[k] * row[pair.displacement[k]];
                    let sideways = pair.lateral[k].iter().zip(&pair.sideways[k]);
                    own + sideways.map(|(along, c)| along * row[*c]).sum::<f64>()
                };
                let radii = pair.effective_radii[0] + pair.effective_radii[1];
                let turned = pair.carrier.map_or(0.0, |[_, c]| radii * row[c]);
                let depth = pair.depth(along(0) + along(1) - turned);
                let soft = self.deflection * DEFLECTIONS;
                let earlier = |known: Option<(usize, f64, f64)>| known.is_none_or(|k| *t < k.1);
                if depth > pair.explained(PASSED, soft) && earlier(passed) {
                    passed = Some((*m, *t, depth));
                }
                let silent = forces.get(*m).is_some_and(|&f| row[f] == 0.0);
                if silent && depth > pair.explained(UNSEEN, soft) && earlier(unseen) {
                    unseen = Some((*m, *t, depth));
                }
            }
        }
        let finding = |(m, time, depth): (usize, f64, f64), what: &str| Finding {
            time,
            status: Status::Tunnelling,
            message: format!(
                "the teeth of `{}` and `{}` {what} by {depth:.3e} m at t = {time:.4e} s: a contact was missed; use a smaller step{}",
                self.names[m][0],
                self.names[m][1],
                if located {
                    " or tolerance"
                } else {
                    ", or locate events"
                }
            ),
        };
        [
            self.grazed
                .map(|x| finding(x, "touched and separated within one step, with an overlap")),
            unseen.map(|x| finding(x, "overlap without a contact force,")),
            passed.map(|x| finding(x, "overlap")),
        ]
        .into_iter()
        .flatten()
        .min_by(|a, b| a.time.total_cmp(&b.time))
    }
}

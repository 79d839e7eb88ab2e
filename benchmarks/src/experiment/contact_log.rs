//! Log of contacts: tooth pairs in contact at the sampling times, and openings and closings with the force on both
//! sides.

use gearbench_integrators::{MemberContact, Outputs, SecondOrderSystem, State};
use gearbench_models::scene::{OfMesh, Scene};
use gearbench_models::spec::{Body, SceneSpec};
use gearbench_reports::histories::{ContactEvent, PairSample, SprungTooth};

/// Records the contacts of a run.
#[derive(Clone, Debug, Default)]
pub struct ContactLog {
    /// Numbers of teeth of both gears of each mesh.
    teeth: Vec<[i64; 2]>,
    /// Channels of the mesh forces.
    forces: Vec<usize>,
    /// Tooth pairs in contact at the sampling times.
    pub pairs: Vec<PairSample>,
    /// Openings and closings of contacts.
    pub events: Vec<ContactEvent>,
    /// Spring-mounted teeth in contact at the times of a history: time [s], gear, tooth.
    pub sprung: Vec<(f64, usize, SprungTooth)>,
    /// Gears of each mesh if the scene has spring-mounted teeth, else empty.
    sprung_meshes: Vec<[usize; 2]>,
    /// Forces of the meshes at the last sampling time [N].
    last_forces: Vec<f64>,
    last: Vec<MemberContact>,
    now: Vec<MemberContact>,
    touches: Vec<MemberContact>,
    out: Outputs,
}

/// The spring-mounted teeth of a contact.
fn sprung_teeth(touch: &MemberContact) -> [Option<SprungTooth>; 2] {
    touch.sprung.map(|tooth| {
        tooth.map(|t| SprungTooth {
            radial_n: t.radial,
            tangential_n: t.tangential,
            spring_n: t.spring,
            deflection: t.deflection,
        })
    })
}

impl ContactLog {
    /// An empty log for the meshes of a scene.
    pub fn new(spec: &SceneSpec, scene: &Scene) -> Self {
        let count = |i: usize| match &spec.gears[i].body {
            Body::Gear(g) => i64::from(g.teeth()),
            Body::Rack(r) => i64::from(r.teeth()),
        };
        let moves = scene.gears().iter().any(|g| g.model.teeth().is_some());
        let meshes = spec.meshes.iter().filter(|_| moves);
        ContactLog {
            sprung_meshes: meshes.map(|m| m.gears).collect(),
            teeth: spec.meshes.iter().map(|m| m.gears.map(count)).collect(),
            forces: scene.channels_of_meshes(OfMesh::Force),
            last_forces: vec![0.0; spec.meshes.len()],
            ..Self::default()
        }
    }

    /// Tooth numbers of a contact, counted from 1 within each gear.
    fn numbers(&self, touch: &MemberContact) -> [i64; 2] {
        let teeth = self.teeth[touch.group];
        [0, 1].map(|k| touch.members[k].rem_euclid(teeth[k]) + 1)
    }

    fn mesh_forces(&self, channels: &[f64]) -> Vec<f64> {
        self.forces.iter().map(|&c| channels[c]).collect()
    }

    /// Records the contacts at a sampling time. Without located events, changes since the last sampling time are
    /// recorded as events.
    pub fn on_grid(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        s: &State,
        channels: &[f64],
        located: bool,
    ) {
        let mut now = std::mem::take(&mut self.now);
        if let Some(report) = sys.report() {
            report.touches(s.at(), &mut now);
        }
        for touch in now.iter().filter(|t| t.force > 0.0) {
            self.pairs.push(PairSample {
                time_s: s.t,
                mesh: touch.group + 1,
                teeth: self.numbers(touch),
                force_n: touch.force,
                sprung: sprung_teeth(touch),
            });
        }
        let forces = self.mesh_forces(channels);
        if !located {
            let last = std::mem::take(&mut self.last);
            let before = std::mem::take(&mut self.last_forces);
            self.compare(s.t, [&last, &now], [&before, &forces], false);
            self.last = last;
        }
        self.last_forces = forces;
        std::mem::swap(&mut self.last, &mut now);
        self.now = now;
    }

    /// Records spring-mounted teeth in contact at a row of a history.
    pub fn at_row(&mut self, sys: &mut dyn SecondOrderSystem, s: &State) {
        if self.sprung_meshes.is_empty() {
            return;
        }
        let mut touches = std::mem::take(&mut self.touches);
        if let Some(report) = sys.report() {
            report.touches(s.at(), &mut touches);
        }
        for touch in touches.iter().filter(|t| t.force > 0.0) {
            let gears = self.sprung_meshes[touch.group];
            let teeth = gears.into_iter().zip(sprung_teeth(touch));
            let row = teeth.filter_map(|(gear, tooth)| Some((s.t, gear, tooth?)));
            self.sprung.extend(row);
        }
        self.touches = touches;
    }

    /// Records the events of an instant at which the contact state was switched.
    pub fn switched(&mut self, sys: &mut dyn SecondOrderSystem, before: &State, after: &State) {
        let mut out = std::mem::take(&mut self.out);
        let [(old, old_forces), (new, new_forces)] = [before, after].map(|s| {
            let mut touches = Vec::new();
            if let Some(report) = sys.report() {
                report.sample(s.at(), &mut out);
                report.touches(s.at(), &mut touches);
            }
            (touches, self.mesh_forces(&out.channels))
        });
        self.out = out;
        self.compare(after.t, [&old, &new], [&old_forces, &new_forces], true);
    }

    /// Records an event for each contact that is in one list and not in the other.
    fn compare(
        &mut self,
        time_s: f64,
        lists: [&[MemberContact]; 2],
        forces: [&[f64]; 2],
        located: bool,
    ) {
        for (closes, [here, there]) in [(false, lists), (true, [lists[1], lists[0]])] {
            for touch in here {
                let same = |t: &MemberContact| (t.group, t.members) == (touch.group, touch.members);
                if !there.iter().any(same) {
                    self.events.push(ContactEvent {
                        time_s,
                        closes,
                        mesh: touch.group + 1,
                        teeth: self.numbers(touch),
                        force_n: forces.map(|f| f.get(touch.group).copied().unwrap_or(0.0)),
                        located,
                    });
                }
            }
        }
    }
}

//! Recorded quantities of a run-up: transmission error and force of every mesh, force of every bearing.
//!
//! The motion of gears on a carrier is relative to it; otherwise the order of the carrier would be added to that of
//! the mesh.

use super::recorder::Recorder;
use crate::experiment::record::carrier_of;
use gearbench_models::scene::{Channel, OfGear, OfMesh, Scene};
use gearbench_models::spec::{SceneSpec, transmission_error};
use gearbench_reports::series::TRANSMISSION_ERROR;

/// Radial forces of a bearing.
const RADIAL: [OfGear; 2] = [OfGear::BearingX, OfGear::BearingY];

/// Recorded quantity whose amplitudes are evaluated.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// Name of the column of the quantity, with the unit.
    pub column: String,
    /// Name of the quantity in reports.
    pub name: String,
    /// Unit of the quantity.
    pub unit: &'static str,
    /// Number of the group of equivalent quantities, such as those of the planets of a carrier; maps show one of each
    /// group.
    pub kind: usize,
    /// Histories of the quantity: one, or one for each component of a force.
    pub histories: Vec<Vec<f64>>,
}

/// Layout of the recorded channels of a scene.
pub struct ChannelLayout<'a> {
    spec: &'a SceneSpec,
    /// Carrier of each gear, among the members.
    carriers: Vec<Option<usize>>,
    members: usize,
}

impl<'a> ChannelLayout<'a> {
    /// Returns the layout of the recorded channels for a scene.
    pub fn of(spec: &'a SceneSpec) -> Self {
        ChannelLayout {
            spec,
            carriers: (0..spec.gears.len()).map(|g| carrier_of(spec, g)).collect(),
            members: spec.gears.len() + spec.bodies().count(),
        }
    }

    /// Returns the channels to record: angles of all members, forces of meshes, bearings of gears.
    pub fn channels(&self, scene: &Scene) -> Vec<usize> {
        let angles = (0..self.members).map(|i| Channel::Gear(i, OfGear::Displacement));
        let forces = (0..self.spec.meshes.len()).map(|m| Channel::Mesh(m, OfMesh::Force));
        let gears = 0..self.spec.gears.len();
        let bearings = gears.flat_map(|g| RADIAL.map(|what| Channel::Gear(g, what)));
        let all = angles.chain(forces).chain(bearings);
        all.filter_map(|c| scene.channel(c)).collect()
    }

    /// Returns the recorded angle of a member [rad].
    pub fn angle<'r>(&self, recorder: &'r Recorder, member: usize) -> &'r [f64] {
        &recorder.columns[member]
    }

    /// Computes the rotation of a member between two samples, relative to its carrier if it has one [rad].
    pub fn rotation(&self, recorder: &Recorder, member: usize, [a, b]: [usize; 2]) -> f64 {
        let of = |i: usize| recorder.columns[i][b] - recorder.columns[i][a];
        let carrier = self.carriers.get(member).copied().flatten();
        of(member) - carrier.map_or(0.0, of)
    }

    /// Returns the carrier to which the motion of the gears of a mesh is relative.
    pub fn carrier_of_mesh(&self, mesh: usize) -> Option<usize> {
        let gears = self.spec.meshes[mesh].gears;
        gears.into_iter().find_map(|g| self.carriers[g])
    }

    /// Gears of a carrier with one number of teeth are alike.
    fn class(&self, gear: usize) -> usize {
        let teeth = |g: usize| self.spec.gears[g].body.teeth();
        let alike = |&other: &usize| {
            self.carriers[gear].is_some()
                && self.carriers[other] == self.carriers[gear]
                && teeth(other) == teeth(gear)
        };
        (0..gear).find(alike).unwrap_or(gear)
    }

    /// Returns the histories of all quantities from a sample on.
    pub fn quantities(&self, recorder: &Recorder, from: usize) -> Vec<Quantity> {
        let spec = self.spec;
        let name = |g: usize| spec.gears[g].name.as_str();
        let mut all = Vec::new();
        let mut kinds: Vec<(&str, [usize; 2])> = Vec::new();
        let mut kind = |of: &'static str, gears: [usize; 2]| {
            let place = kinds.iter().position(|k| *k == (of, gears));
            place.unwrap_or_else(|| {
                kinds.push((of, gears));
                kinds.len() - 1
            })
        };
        for (m, mesh) in spec.meshes.iter().enumerate() {
            let [a, b] = mesh.gears;
            let of_turns = transmission_error(mesh, &spec.gears);
            let of = |g: usize| recorder.columns[g][from..].iter();
            let carried: Vec<f64> = match self.carrier_of_mesh(m) {
                Some(c) => recorder.columns[c][from..].to_vec(),
                None => vec![0.0; recorder.len() - from],
            };
            let error = of(a).zip(of(b)).zip(&carried);
            let error = error.map(|((x, y), c)| of_turns(x - c, y - c));
            let of_mesh = format!("{} - {}", name(a), name(b));
            let classes = [a, b].map(|g| self.class(g));
            all.push(Quantity {
                column: TRANSMISSION_ERROR.of_mesh(&[name(a), name(b)]),
                name: format!("transmission error {of_mesh}"),
                unit: "m",
                kind: kind("error", classes),
                histories: vec![error.collect()],
            });
            all.push(Quantity {
                column: Channel::Mesh(m, OfMesh::Force).column(spec),
                name: format!("mesh force {of_mesh}"),
                unit: "N",
                kind: kind("force", classes),
                histories: vec![recorder.columns[self.members + m][from..].to_vec()],
            });
        }
        let first = self.members + spec.meshes.len();
        for g in 0..spec.gears.len() {
            let [x, y] = [0, 1].map(|k| &recorder.columns[first + 2 * g + k][from..]);
            let histories = match self.carriers[g] {
                None => vec![x.to_vec(), y.to_vec()],
                Some(c) => {
                    let angles = recorder.columns[c][from..].iter();
                    let seen = angles.zip(x).zip(y).map(|((c, x), y)| {
                        let (sin, cos) = c.sin_cos();
                        (x * cos + y * sin, y * cos - x * sin)
                    });
                    let (x, y) = seen.unzip();
                    vec![x, y]
                }
            };
            all.push(Quantity {
                column: format!("bearing_{}_n", name(g)),
                name: format!("bearing force {}", name(g)),
                unit: "N",
                kind: kind("bearing", [self.class(g), usize::MAX]),
                histories,
            });
        }
        all
    }
}

//! The carrier-frame state of a scene.

use super::plan::PlanetarySets;
use crate::Vec3;
use crate::kinematics::HubFrame;
use crate::scene::members::SceneGear;
use gearbench_integrators::system::{State, StateView};
use std::ops::Range;

/// A carrier, and the gears that are described in its frame.
#[derive(Clone, Debug)]
pub(in crate::scene) struct Carrier {
    /// Coordinate `theta_c` of the carrier, and the coordinates of its displacements along x, y and z where it has
    /// them.
    pub(super) turn: usize,
    pub(super) shift: [Option<usize>; 3],
    pub(super) members: Vec<Member>,
    /// Axes of the carrier, and a point on its axis at the start.
    axes: [Vec3; 3],
    centre: Vec3,
}

/// A gear that is described in the frame of a carrier.
#[derive(Clone, Debug)]
pub(super) struct Member {
    pub gear: usize,
    /// Ranges of the coordinates that are angles.
    pub turns: Vec<Range<usize>>,
    /// Coordinates of its displacements across the axis, and along it.
    pub across: Option<[usize; 2]>,
    pub along: Option<usize>,
    /// Position from the axis of the carrier at the start [m].
    pub place: [f64; 2],
}

/// Buffers of a carrier-frame state.
#[derive(Default)]
pub(in crate::scene) struct CarrierFrameState {
    pub q: Vec<f64>,
    pub v: Vec<f64>,
    pub f: Vec<f64>,
}

/// Carriers of a scene.
#[derive(Clone, Debug, Default)]
pub(in crate::scene) struct Carriers {
    pub(super) all: Vec<Carrier>,
    /// True for each gear on a carrier.
    carried: Vec<bool>,
    /// Carrier in whose frame each mesh is described.
    of_mesh: Vec<Option<usize>>,
}

impl Carriers {
    /// Creates the carriers of a plan between gears with known coordinates.
    pub fn new(sets: &PlanetarySets, gears: &[SceneGear]) -> Self {
        let mut carried = vec![false; gears.len()];
        let all = sets.all.iter().map(|set| {
            let body = &gears[set.body];
            let hub = &body.model.hub().hub;
            let of = |gear: &SceneGear, direction: usize| {
                let hub = &gear.model.hub().hub;
                let found = hub.free_directions().position(|d| d == direction);
                found.map(|k| gear.offset + k)
            };
            let members = set.gears.iter().map(|(gear, on_carrier)| {
                carried[*gear] = *on_carrier;
                let g = &gears[*gear];
                let own = g.model.hub();
                // Teeth have angles as the hub does; displacements of modes and nodes are those of a body that turns.
                let teeth = g
                    .model
                    .teeth()
                    .map(|_| g.offset + own.first()..g.offset + g.n);
                let off = own.centre - hub.centre;
                Member {
                    gear: *gear,
                    turns: std::iter::once(g.offset..g.offset + 1)
                        .chain(teeth)
                        .collect(),
                    across: of(g, 0).zip(of(g, 1)).map(|(x, y)| [x, y]),
                    along: of(g, 2),
                    place: [hub.axes[0].dot(&off), hub.axes[1].dot(&off)],
                }
            });
            Carrier {
                turn: body.offset,
                shift: [0, 1, 2].map(|d| of(body, d)),
                members: members.collect(),
                axes: hub.axes,
                centre: hub.centre,
            }
        });
        Carriers {
            all: all.collect(),
            carried,
            of_mesh: sets.of_mesh.clone(),
        }
    }

    #[inline]
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Returns true if a gear is on a carrier.
    #[inline]
    pub fn carries(&self, gear: usize) -> bool {
        self.carried.get(gear).copied().unwrap_or(false)
    }

    /// Sets the velocities of gears on carriers to those of their pins, `u' = u_c' + theta_c' e_z x (P + u - u_c)`:
    /// their speed in the carrier frame is then zero across and along the axis.
    pub fn carry_along(&self, s: &mut State) {
        for carrier in &self.all {
            let spin = s.v[carrier.turn];
            let shift = |x: &[f64]| carrier.shift.map(|i| i.map_or(0.0, |i| x[i]));
            let (place, speed) = (shift(&s.q), shift(&s.v));
            for m in carrier.members.iter().filter(|m| self.carries(m.gear)) {
                if let Some([ix, iy]) = m.across {
                    let [px, py] = m.place;
                    let (x, y) = (px + s.q[ix] - place[0], py + s.q[iy] - place[1]);
                    (s.v[ix], s.v[iy]) = (speed[0] - spin * y, speed[1] + spin * x);
                }
                if let Some(i) = m.along {
                    s.v[i] = speed[2];
                }
            }
        }
    }

    /// Computes the accelerations of gears on carriers that rotate at constant speed, `theta_c'' = 0`: `u'' = -theta_c'^2
    /// (P + u - u_c)`.
    pub fn centripetal(&self, at: StateView<'_>, a: &mut [f64]) {
        a.fill(0.0);
        for carrier in &self.all {
            let square = at.v[carrier.turn].powi(2);
            let place = carrier.shift.map(|i| i.map_or(0.0, |i| at.q[i]));
            for m in carrier.members.iter().filter(|m| self.carries(m.gear)) {
                if let Some([ix, iy]) = m.across {
                    a[ix] = -square * (m.place[0] + at.q[ix] - place[0]);
                    a[iy] = -square * (m.place[1] + at.q[iy] - place[1]);
                }
            }
        }
    }

    /// Transforms a state to the carrier frame.
    pub fn to_carrier_frame(&self, at: StateView<'_>, to: &mut CarrierFrameState) {
        to.q.clear();
        to.q.extend_from_slice(at.q);
        to.v.clear();
        to.v.extend_from_slice(at.v);
        for carrier in &self.all {
            let (turn, spin) = (at.q[carrier.turn], at.v[carrier.turn]);
            let shift = |x: &[f64]| carrier.shift.map(|i| i.map_or(0.0, |i| x[i]));
            let (place, speed) = (shift(at.q), shift(at.v));
            let (sin, cos) = turn.sin_cos();
            for m in &carrier.members {
                for i in m.turns.iter().cloned().flatten() {
                    to.q[i] -= turn;
                    to.v[i] -= spin;
                }
                if let Some([ix, iy]) = m.across {
                    let [px, py] = m.place;
                    let (x, y) = (px + at.q[ix] - place[0], py + at.q[iy] - place[1]);
                    let (x, y) = (cos * x + sin * y, cos * y - sin * x);
                    let (vx, vy) = (at.v[ix] - speed[0], at.v[iy] - speed[1]);
                    (to.q[ix], to.q[iy]) = (x - px, y - py);
                    to.v[ix] = cos * vx + sin * vy + spin * y;
                    to.v[iy] = cos * vy - sin * vx - spin * x;
                }
                if let Some(i) = m.along {
                    to.q[i] -= place[2];
                    to.v[i] -= speed[2];
                }
            }
        }
    }

    /// Adds carrier-frame forces to those of the coordinates: `f += J^T f~`.
    pub fn pull_back(&self, at: StateView<'_>, relative: &CarrierFrameState, f: &mut [f64]) {
        let from = &relative.f;
        f.iter_mut().zip(from).for_each(|(f, r)| *f += r);
        for carrier in &self.all {
            let (sin, cos) = at.q[carrier.turn].sin_cos();
            for m in &carrier.members {
                for i in m.turns.iter().cloned().flatten() {
                    f[carrier.turn] -= from[i];
                }
                if let Some([ix, iy]) = m.across {
                    let (fx, fy) = (from[ix], from[iy]);
                    let (x, y) = (m.place[0] + relative.q[ix], m.place[1] + relative.q[iy]);
                    let (ax, ay) = (cos * fx - sin * fy, sin * fx + cos * fy);
                    f[ix] += ax - fx;
                    f[iy] += ay - fy;
                    f[carrier.turn] -= x * fy - y * fx;
                    for (i, force) in carrier.shift.iter().zip([ax, ay]) {
                        if let Some(i) = i {
                            f[*i] -= force;
                        }
                    }
                }
                if let (Some(own), Some(of_carrier)) = (m.along, carrier.shift[2]) {
                    f[of_carrier] -= from[own];
                }
            }
        }
    }

    /// Returns the coordinates of carriers.
    pub fn coordinates(&self) -> Vec<usize> {
        let of = |c: &Carrier| [Some(c.turn), c.shift[0], c.shift[1], c.shift[2]];
        self.all.iter().flat_map(of).flatten().collect()
    }

    /// Returns the motion in space, rotated back with the carrier, of the gears of a set per unit of one of the
    /// carrier's coordinates while they are at rest in the carrier frame.
    pub fn motion_of(&self, coordinate: usize, carrier_state: StateView<'_>, n: usize) -> Vec<f64> {
        let mut b = vec![0.0; n];
        for carrier in &self.all {
            let turns = carrier.turn == coordinate;
            let along = carrier.shift.iter().position(|i| *i == Some(coordinate));
            for m in &carrier.members {
                if turns {
                    m.turns.iter().cloned().flatten().for_each(|i| b[i] = 1.0);
                }
                if let Some([ix, iy]) = m.across {
                    let place = [
                        m.place[0] + carrier_state.q[ix],
                        m.place[1] + carrier_state.q[iy],
                    ];
                    let (sin, cos) = carrier.angle(carrier_state);
                    (b[ix], b[iy]) = match along {
                        _ if turns => (-place[1], place[0]),
                        Some(0) => (cos, -sin),
                        Some(1) => (sin, cos),
                        _ => (0.0, 0.0),
                    };
                }
                if let (Some(i), Some(2)) = (m.along, along) {
                    b[i] = 1.0;
                }
            }
        }
        b
    }

    /// Rotates the parts of a vector across the axes from space to the carrier frame.
    pub fn turn_back(&self, at: StateView<'_>, x: &mut [f64]) {
        self.turn_across(at, x, -1.0);
    }

    /// Rotates the parts of a vector across the axes from the carrier frame to space.
    pub fn turn_forth(&self, at: StateView<'_>, x: &mut [f64]) {
        self.turn_across(at, x, 1.0);
    }

    fn turn_across(&self, at: StateView<'_>, x: &mut [f64], sign: f64) {
        for carrier in &self.all {
            let (sin, cos) = (sign * at.q[carrier.turn]).sin_cos();
            for [ix, iy] in carrier.members.iter().filter_map(|m| m.across) {
                (x[ix], x[iy]) = (cos * x[ix] - sin * x[iy], sin * x[ix] + cos * x[iy]);
            }
        }
    }

    /// Returns the carrier in whose frame a mesh is described.
    pub(super) fn carrier_of(&self, mesh: usize) -> Option<&Carrier> {
        let carrier = self.of_mesh.get(mesh).copied().flatten()?;
        Some(&self.all[carrier])
    }

    /// Transforms a direction from the frame of a mesh to space.
    pub fn direction(&self, mesh: usize, at: StateView<'_>, x: Vec3) -> Vec3 {
        match self.carrier_of(mesh) {
            Some(carrier) => carrier.turned(at.q[carrier.turn], &x),
            None => x,
        }
    }

    /// Transforms a direction from the frame of a gear to space; with `sign` -1 in the inverse direction.
    pub fn direction_at(&self, gear: usize, at: StateView<'_>, x: Vec3, sign: f64) -> Vec3 {
        match self.of_gear(gear) {
            Some(carrier) => carrier.turned(sign * at.q[carrier.turn], &x),
            None => x,
        }
    }

    fn of_gear(&self, gear: usize) -> Option<&Carrier> {
        let mut carriers = self.all.iter();
        carriers.find(|c| c.members.iter().any(|m| m.gear == gear))
    }

    /// Transforms a position from the frame of a mesh to space [m].
    pub fn place(&self, mesh: usize, at: StateView<'_>, x: Vec3) -> Vec3 {
        match self.carrier_of(mesh) {
            Some(carrier) => {
                let turned = carrier.turned(at.q[carrier.turn], &(x - carrier.centre));
                carrier.moved(at) + turned
            }
            None => x,
        }
    }

    /// Transforms positions [m] and displacements of a gear on a carrier to space.
    pub fn lift(&self, gear: usize, at: StateView<'_>, [places, displacements]: [&mut [Vec3]; 2]) {
        let Some(carrier) = self.of_gear(gear) else {
            return;
        };
        let (turn, moved) = (at.q[carrier.turn], carrier.moved(at));
        for x in places {
            *x = moved + carrier.turned(turn, &(*x - carrier.centre));
        }
        for d in displacements {
            *d = carrier.turned(turn, d);
        }
    }

    /// Transforms the frame of a hub from the carrier frame to space.
    pub fn frame(&self, gear: usize, at: StateView<'_>, frame: HubFrame) -> HubFrame {
        let Some(carrier) = self.of_gear(gear) else {
            return frame;
        };
        let turn = at.q[carrier.turn];
        HubFrame {
            axes: frame.axes.map(|axis| carrier.turned(turn, &axis)),
            origin: carrier.moved(at) + carrier.turned(turn, &(frame.origin - carrier.centre)),
        }
    }
}

impl Carrier {
    fn turned(&self, turn: f64, x: &Vec3) -> Vec3 {
        let (sin, cos) = turn.sin_cos();
        let [a, b, c] = self.axes.map(|axis| axis.dot(x));
        (cos * a - sin * b) * self.axes[0] + (sin * a + cos * b) * self.axes[1] + c * self.axes[2]
    }

    /// Returns sine and cosine of the rotation of the carrier; its own coordinates are equal in the carrier-frame
    /// state.
    fn angle(&self, at: StateView<'_>) -> (f64, f64) {
        at.q[self.turn].sin_cos()
    }

    /// Returns the present position of the carrier axis [m].
    fn moved(&self, at: StateView<'_>) -> Vec3 {
        let by = self.shift.iter().zip(&self.axes);
        let by = by.filter_map(|(i, axis)| i.map(|i| at.q[i] * axis));
        by.fold(self.centre, |sum, by| sum + by)
    }
}

//! Tangentially movable teeth: one tangential coordinate per tooth (S. Ebrahimi, P. Eberhard,
//! *Contact modeling of meshing gear wheels using tangentially movable teeth*, SIMPACK user meeting 2006).
//!
//! Tooth `i` at angle `S_i`, body at `phi`, spring and damper between them on the radius `r_d`:
//!
//! ```text
//! m_t r_d^2 S_i'' + c r_d^2 (S_i' - phi') + k r_d^2 (S_i - phi) = T_i,       T_i = F_t,i r
//! J_b phi'' = sum_i [k r_d^2 (S_i - phi) + c r_d^2 (S_i' - phi')] + T_hub,   J_b = J - sum_i m_t r_d^2
//! ```
//!
//! The contact force of a tooth is projected on its normal (radial) and tangential direction: the radial part
//! goes through the body, the tangential part through the spring. On the line of action `F_t r = N r_b`, the
//! effective base radius arm of the contact row. The total inertia is held: the body is what the teeth leave.
//!
//! **Teeth out of contact are not integrated one by one.** With equal teeth the mean `R` of those outside the
//! contact windows obeys the same equation as each of them, driven by the body, and their deviations
//! `d_i = S_i - R` obey the free equation `m d'' + c d' + k d = 0`, known in closed form. As `sum d_i = 0` they do
//! not act on the body. So the state is `[phi, R, window teeth...]`: exact, at a cost that does not grow with
//! the number of teeth. When the gear turns by a tooth the window moves by one: the tooth that leaves joins
//! the mean, the tooth that enters takes its place, momentum and energy are kept (`deviations`). With
//! unequal teeth all are integrated. **Bound**: rounding. Integrated or not, a tooth obeys the same equation, so that
//! the motion is the same but for the error of the method, which has fewer teeth to make it on; in flight (`flight`) no
//! tooth is integrated.
//!
//! A rack is the same with displacement for angles and `r_d = 1`.
//!
//! `k` may depend on the contact radius (`k(r)` of a tooth in contact, `k(r_0)` otherwise, `r_0` the first
//! breakpoint); the energy that appears at entry is booked by the ledger as a jump, the work of `k'(r) r'` as
//! parametric.

mod deviations;
mod fit;
mod free_flight;
mod parameters;
mod reaction;
mod springs;

pub use fit::FIT;
pub use parameters::{Integrate, MovableTeethParameters, PARAMETERS, PerTooth, build};

use super::capabilities::{LinearMotion, ToothCoordinates};
use super::free_flight::FreeFlight;
use super::hub_body::HubBody;
use super::model::{GearModel, HubState};
use crate::Vec3;
use crate::geometry::Side;
use crate::kinematics::{MeshView, Point, Row, Tooth, Wrench};
use deviations::{Deviations, Exchange};
use gearbench_integrators::FlightPath;
use gearbench_integrators::system::{At, Change, Coeffs, Energy, Power, Singular};
use springs::{RadiusStiffness, ToothSprings};

/// Teeth beyond a whole pitch by this fraction still belong to the window they were in.
const HYSTERESIS: f64 = 0.05;
/// Room for deflections in the width of a window, in pitches.
const MARGIN: f64 = 0.02;

/// Consecutive teeth around a mesh that are integrated one by one.
#[derive(Clone, Debug, PartialEq)]
struct Window {
    /// Teeth on each side of the middle one.
    half: i64,
    /// First coordinate of its slots in the gear's own.
    base: usize,
    /// First tooth slot, counted over the windows.
    slot: usize,
}

impl Window {
    fn len(&self) -> i64 {
        2 * self.half + 1
    }
}

/// Which teeth have a coordinate of their own.
#[derive(Clone, Debug, PartialEq)]
enum Integrated {
    /// All of them.
    All,
    /// Windows around the meshes, and the mean of the rest.
    Windows(Vec<Window>),
}

/// A gear or rack with movable teeth.
#[derive(Clone, Debug)]
pub struct MovableTeeth {
    hub: HubBody,
    teeth: usize,
    /// Inertia of the body without its teeth.
    body: f64,
    springs: ToothSprings,
    all_wanted: bool,
    integrated: Integrated,
    views: Vec<MeshView>,
    /// Number of teeth in windows.
    slots: usize,
    /// The springs behind the gear's own coordinates where they are constant, else empty.
    constant: Vec<Spring>,
}

impl MovableTeeth {
    /// Coordinates before the teeth: those of the mount.
    #[inline]
    fn first(&self) -> usize {
        self.hub.coordinates()
    }

    #[inline]
    fn deviations(&self) -> Deviations {
        Deviations { teeth: self.teeth }
    }

    /// Cells of the discrete state before the deviations: the middle tooth of each mesh, the flank in contact of
    /// each slot.
    #[inline]
    fn head(&self) -> usize {
        let slots = if self.integrated == Integrated::All {
            self.teeth
        } else {
            self.slots
        };
        self.views.len().max(1) + slots
    }

    /// Discrete state cell that says on which flank the tooth of a slot is in contact: 0, or the side's sign times
    /// (mesh + 1).
    #[inline]
    fn engaged_cell(&self, slot: usize) -> usize {
        self.views.len().max(1) + slot
    }

    /// Inertia and number of the teeth behind coordinate `first() + i`.
    #[inline]
    fn count(&self, i: usize) -> f64 {
        match &self.integrated {
            Integrated::Windows(_) if i == 0 => (self.teeth - self.slots) as f64,
            _ => 1.0,
        }
    }

    /// Slot of coordinate `first() + i`, `None` for the mean.
    #[inline]
    fn slot(&self, i: usize) -> Option<usize> {
        match &self.integrated {
            Integrated::All => Some(i),
            Integrated::Windows(_) => i.checked_sub(1),
        }
    }

    /// Coordinate of a tooth, `None` when it is outside the windows.
    #[inline]
    fn coordinate(&self, discrete: &[f64], tooth: Tooth) -> Option<usize> {
        match &self.integrated {
            Integrated::All => {
                Some(self.first() + (tooth.index as i32).rem_euclid(self.teeth as i32) as usize)
            }
            Integrated::Windows(windows) => {
                let w = &windows[tooth.mesh as usize];
                let centre = discrete[tooth.mesh as usize] as i64;
                ((tooth.index - centre).abs() <= w.half)
                    .then(|| w.base + (tooth.index as i32).rem_euclid(w.len() as i32) as usize)
            }
        }
    }

    /// Parameters of the spring behind coordinate `first() + i` at angle `s`: count, stiffness and its
    /// derivative by the angle, damping, tooth inertia; all about the hub (times `r_d^2`).
    #[inline]
    fn spring(&self, at: At<'_>, i: usize, s: f64) -> Spring {
        match self.constant.get(i) {
            Some(spring) => *spring,
            None => self.varying_spring(at, i, s),
        }
    }

    fn varying_spring(&self, at: At<'_>, i: usize, s: f64) -> Spring {
        let n = self.count(i);
        let slot = self.slot(i);
        let p = &self.springs;
        let tooth = if p.uniform { 0 } else { slot.unwrap_or(0) };
        let (mut k, mut dk) = (p.stiffness[tooth], 0.0);
        if let (Some(table), Some(slot)) = (&p.radius, slot) {
            let engaged = at.discrete[self.engaged_cell(slot)];
            if engaged != 0.0 {
                let (kr, slope) = self.stiffness_in_contact(at, table, slot, engaged, s);
                (k, dk) = (kr, slope);
            }
        }
        let r2 = p.radius_squared;
        Spring {
            k: n * k * r2,
            dk: n * dk * r2,
            c: n * p.damping[tooth] * r2,
            inertia: n * p.mass[tooth] * r2,
        }
    }

    /// Notes the springs that do not change.
    fn note_constants(&mut self) {
        self.constant.clear();
        if self.springs.radius.is_none() {
            let at = At {
                t: 0.0,
                q: &[],
                v: &[],
                discrete: &[],
            };
            self.constant = (0..self.hub.own)
                .map(|i| self.varying_spring(at, i, 0.0))
                .collect();
        }
    }

    /// `k(r)` and `dk/dS` of a tooth in contact.
    fn stiffness_in_contact(
        &self,
        at: At<'_>,
        table: &RadiusStiffness,
        slot: usize,
        engaged: f64,
        s: f64,
    ) -> (f64, f64) {
        let mesh = engaged.abs() as usize - 1;
        let side = if engaged > 0.0 {
            Side::Left
        } else {
            Side::Right
        };
        let view = &self.views[mesh];
        let Some(rb) = view.base_radius else {
            return (table.at(0.0).0, 0.0);
        };
        let index = self.tooth_of_slot(at.discrete, mesh, slot);
        let angle = view.assembled + s + index as f64 * view.pitch;
        let path = view.path_coordinate(side, angle);
        let r = rb.hypot(path);
        let (k, dk_dr) = table.at(r);
        (k, dk_dr * path / r * rb * side.sign())
    }

    /// Unwrapped index of the tooth in a slot, nearest to the mesh.
    fn tooth_of_slot(&self, discrete: &[f64], mesh: usize, slot: usize) -> i64 {
        let centre = discrete[mesh] as i64;
        let (local, len) = match &self.integrated {
            Integrated::All => (slot as i64, self.teeth as i64),
            Integrated::Windows(w) => ((slot - w[mesh].slot) as i64, w[mesh].len()),
        };
        let first = centre - len / 2;
        first + (local - first).rem_euclid(len)
    }

    /// Index of the tooth nearest to a mesh, as a real number.
    fn nearest(&self, mesh: usize, displacement: f64) -> f64 {
        let v = &self.views[mesh];
        let target = if v.base_radius.is_some() {
            v.direction
        } else {
            0.0
        };
        (target - v.assembled - displacement) / v.pitch
    }

    /// Teeth that a mesh may touch on either flank, on each side of the nearest one.
    fn half_window(view: &MeshView) -> i64 {
        let reach = |s: f64| match view.base_radius {
            Some(rb) => (s / rb - view.working_pressure_angle - view.half_angle_base).abs(),
            None => (view.half_angle_base - s / view.working_pressure_angle.cos()).abs(),
        };
        let widest = reach(view.path[0]).max(reach(view.path[1])) / view.pitch;
        (widest - 0.5 + HYSTERESIS + MARGIN).ceil().max(0.0) as i64
    }

    /// Chooses the windows, or all teeth where windows do not fit.
    fn arrange(&mut self) {
        self.integrated = Integrated::All;
        self.slots = 0;
        if self.all_wanted || !self.springs.uniform || self.views.is_empty() {
            return;
        }
        let mut windows = Vec::new();
        let (mut base, mut slot) = (self.first() + 1, 0);
        for view in &self.views {
            let w = Window {
                half: Self::half_window(view),
                base,
                slot,
            };
            base += w.len() as usize;
            slot += w.len() as usize;
            windows.push(w);
        }
        // Two windows must never own the same tooth.
        let apart = windows.iter().enumerate().all(|(i, a)| {
            windows.iter().enumerate().skip(i + 1).all(|(j, b)| {
                let d = (self.nearest(i, 0.0) - self.nearest(j, 0.0)).rem_euclid(self.teeth as f64);
                d.min(self.teeth as f64 - d) > (a.half + b.half) as f64 + 2.0
            })
        });
        if apart && slot + 2 <= self.teeth {
            self.slots = slot;
            self.integrated = Integrated::Windows(windows);
        }
    }
}

/// One spring of the gear, about the hub.
#[derive(Clone, Copy, Debug)]
struct Spring {
    k: f64,
    dk: f64,
    c: f64,
    inertia: f64,
}

impl GearModel for MovableTeeth {
    fn hub(&self) -> &HubBody {
        &self.hub
    }

    fn hub_mut(&mut self) -> &mut HubBody {
        &mut self.hub
    }

    fn initialise(&self, speed: f64, q: &mut [f64], v: &mut [f64], discrete: &mut [f64]) {
        q.fill(0.0);
        v.fill(speed);
        discrete.fill(0.0);
        for m in 0..self.views.len() {
            discrete[m] = self.nearest(m, 0.0).round();
        }
    }

    #[inline]
    fn row(&self, at: At<'_>, p: &Point, n: &Vec3, row: &mut Row) -> f64 {
        // A tooth outside its window carries no force, so the mean stands for it.
        let i = self
            .coordinate(at.discrete, p.tooth)
            .unwrap_or(self.first());
        row.push(i, self.hub.effective_radius(&p.x, n));
        // A tooth has a coordinate whatever its hub does: nothing of its motion is prescribed.
        0.0
    }

    fn forces(&mut self, at: At<'_>, f: &mut [f64]) {
        let first = self.first();
        let (phi, speed) = (
            self.hub.displacement(at.t, at.q),
            self.hub.speed(at.t, at.v),
        );
        let mut on_body = 0.0;
        if !self.constant.is_empty() {
            let own = f[first..]
                .iter_mut()
                .zip(&at.q[first..])
                .zip(&at.v[first..]);
            for (((f, s), v), p) in own.zip(&self.constant) {
                let torque = p.k * (s - phi) + p.c * (v - speed);
                *f -= torque;
                on_body += torque;
            }
            if first > 0 {
                f[0] += on_body;
            }
            return;
        }
        for i in 0..at.q.len() - first {
            let (s, v) = (at.q[first + i], at.v[first + i]);
            let p = self.spring(at, i, s);
            let torque = p.k * (s - phi) + p.c * (v - speed);
            f[first + i] -= torque;
            on_body += torque;
        }
        if first > 0 {
            f[0] += on_body;
        }
    }

    fn tangent(&mut self, at: At<'_>, dq: &[f64], dv: &[f64], df: &mut [f64]) {
        let first = self.first();
        let phi = self.hub.displacement(at.t, at.q);
        let (dphi, dspeed) = if first > 0 {
            (dq[0], dv[0])
        } else {
            (0.0, 0.0)
        };
        let mut on_body = 0.0;
        for i in 0..at.q.len() - first {
            let s = at.q[first + i];
            let p = self.spring(at, i, s);
            let (ds, du) = (dq[first + i], dv[first + i]);
            let torque = p.k * (ds - dphi) + p.dk * (s - phi) * ds + p.c * (du - dspeed);
            df[first + i] -= torque;
            on_body += torque;
        }
        if first > 0 {
            df[0] += on_body;
        }
    }

    /// Arrow matrix: the teeth are coupled through the hub only.
    fn correct(
        &mut self,
        at: At<'_>,
        c: Coeffs,
        hub_damping: f64,
        x: &mut [f64],
    ) -> Result<(), Singular> {
        let first = self.first();
        let phi = self.hub.displacement(at.t, at.q);
        let (mut hub, mut rhs) = (c.m * self.body + c.d * hub_damping, 0.0);
        for i in 0..at.q.len() - first {
            let s = at.q[first + i];
            let p = self.spring(at, i, s);
            let spring = c.d * p.c + c.k * p.k;
            let turning = spring + c.k * p.dk * (s - phi);
            let diagonal = c.m * p.inertia + turning;
            if diagonal == 0.0 {
                return Err(Singular);
            }
            hub += spring - turning * spring / diagonal;
            rhs += turning * x[first + i] / diagonal;
        }
        if first > 0 {
            if hub == 0.0 {
                return Err(Singular);
            }
            x[0] = (x[0] + rhs) / hub;
        }
        let dphi = if first > 0 { x[0] } else { 0.0 };
        for i in 0..at.q.len() - first {
            let s = at.q[first + i];
            let p = self.spring(at, i, s);
            let spring = c.d * p.c + c.k * p.k;
            let diagonal = c.m * p.inertia + spring + c.k * p.dk * (s - phi);
            x[first + i] = (x[first + i] + spring * dphi) / diagonal;
        }
        Ok(())
    }

    fn energy(&self, at: At<'_>) -> Energy {
        let first = self.first();
        let (phi, speed) = (
            self.hub.displacement(at.t, at.q),
            self.hub.speed(at.t, at.v),
        );
        let mut e = Energy::default();
        if first > 0 {
            e.kinetic += 0.5 * self.body * speed * speed;
        }
        for i in 0..at.q.len() - first {
            let (s, v) = (at.q[first + i], at.v[first + i]);
            let p = self.spring(at, i, s);
            e.kinetic += 0.5 * p.inertia * v * v;
            e.strain += 0.5 * p.k * (s - phi).powi(2);
        }
        if self.slots > 0 {
            // The cross terms with the mean vanish because the deviations sum to zero.
            let (dd, vv) =
                self.deviations()
                    .squares(&self.springs, at.t, &at.discrete[self.head()..]);
            let (k, m, r2) = (
                self.springs.stiffness[0],
                self.springs.mass[0],
                self.springs.radius_squared,
            );
            e.strain += 0.5 * k * r2 * dd;
            e.kinetic += 0.5 * m * r2 * vv;
        }
        e
    }

    fn powers(&self, at: At<'_>) -> Power {
        Power {
            dissipated: self.dissipated(at),
            parametric: self.parametric(at),
            external: self.driven_power(at),
        }
    }

    fn hub_state(&self, at: At<'_>) -> HubState {
        let first = self.first();
        let speed = self.hub.speed(at.t, at.v);
        let teeth: f64 = (0..at.q.len() - first)
            .map(|i| self.tooth_inertia(i) * at.v[first + i])
            .sum();
        HubState {
            displacement: self.hub.displacement(at.t, at.q),
            speed,
            momentum: self.body * speed + teeth,
        }
    }

    fn mount_reaction(&self, at: At<'_>, forces: &[f64], contact: &Wrench) -> Wrench {
        self.reaction(at, forces, contact)
    }

    fn linear(&self) -> Option<&dyn LinearMotion> {
        Some(self)
    }

    fn teeth(&self) -> Option<&dyn ToothCoordinates> {
        Some(self)
    }
}

impl LinearMotion for MovableTeeth {
    fn free_flight(&self, at: At<'_>, load: f64) -> Option<FreeFlight> {
        self.flight_of(at, load)
    }

    fn add_to_path(&self, at: At<'_>, load: f64, first: usize, path: &mut FlightPath) {
        self.add_oscillators(at, load, first, path);
    }

    fn cut_off_vibrations(
        &self,
        t: f64,
        load: f64,
        q: &mut [f64],
        v: &mut [f64],
        discrete: &mut [f64],
    ) -> bool {
        self.rest_teeth(t, load, q, v, discrete)
    }

    fn steady_work(&self, from: At<'_>, to: At<'_>, load: f64) -> f64 {
        self.work_of(from, to, load)
    }
}

impl ToothCoordinates for MovableTeeth {
    #[inline]
    fn displacement(&self, at: At<'_>, tooth: Tooth) -> f64 {
        match self.coordinate(at.discrete, tooth) {
            Some(i) => at.q[i],
            // Outside its window a tooth cannot touch: its small free deviation is not worth a sine here.
            None => at.q[self.first()],
        }
    }

    fn displacements(&self, at: At<'_>, first: Tooth, out: &mut [f64]) {
        let mean = at.q[self.first()];
        match &self.integrated {
            Integrated::All => {
                let own = &at.q[self.first()..];
                let mut i = (first.index as i32).rem_euclid(self.teeth as i32) as usize;
                for displacement in out {
                    *displacement = own[i];
                    i = if i + 1 == own.len() { 0 } else { i + 1 };
                }
            }
            Integrated::Windows(windows) => {
                let w = &windows[first.mesh as usize];
                let from = at.discrete[first.mesh as usize] as i64 - w.half;
                let own = &at.q[w.base..][..w.len() as usize];
                let mut i = (first.index as i32).rem_euclid(own.len() as i32) as usize;
                // Distance behind the window's first tooth; negative is huge.
                let mut behind = (first.index - from) as u64;
                for displacement in out {
                    *displacement = if behind < own.len() as u64 {
                        own[i]
                    } else {
                        mean
                    };
                    behind = behind.wrapping_add(1);
                    i = if i + 1 == own.len() { 0 } else { i + 1 };
                }
            }
        }
    }

    fn follows_contact(&self) -> bool {
        self.springs.radius.is_some()
    }

    fn engage(&self, discrete: &mut [f64], tooth: Tooth, side: Side, closed: bool) -> Change {
        if self.springs.radius.is_none() {
            return Change::None;
        }
        let Some(i) = self.coordinate(discrete, tooth) else {
            return Change::None;
        };
        let Some(slot) = self.slot(i - self.first()) else {
            return Change::None;
        };
        let cell = self.engaged_cell(slot);
        discrete[cell] = if closed {
            side.sign() * f64::from(tooth.mesh + 1)
        } else {
            0.0
        };
        Change::Restart
    }

    fn commit(&self, t: f64, q: &mut [f64], v: &mut [f64], discrete: &mut [f64]) -> Change {
        let displacement = self.hub.displacement(t, q);
        let mut change = Change::None;
        for m in 0..self.views.len() {
            let x = self.nearest(m, displacement);
            let mut centre = discrete[m];
            while (x - centre).abs() > 0.5 + HYSTERESIS {
                let step = (x - centre).signum();
                let before = centre as i64;
                centre += step;
                discrete[m] = centre;
                if let Integrated::Windows(windows) = &self.integrated {
                    let w = &windows[m];
                    let leaves = before - step as i64 * w.half;
                    let enters = before + step as i64 * (w.half + 1);
                    let local = enters.rem_euclid(w.len()) as usize;
                    let engaged = self.engaged_cell(w.slot + local);
                    discrete[engaged] = 0.0;
                    let (mean, i) = (self.first(), w.base + local);
                    let mut state = [q[mean], v[mean], q[i], v[i]];
                    let (head, free) = discrete.split_at_mut(self.head());
                    let outside = |tooth: i64| {
                        windows.iter().zip(head.iter()).all(|(w, &centre)| {
                            let from_first = tooth - (centre as i64 - w.half);
                            from_first.rem_euclid(self.teeth as i64) >= w.len()
                        })
                    };
                    let teeth = Exchange {
                        t,
                        count: self.count(0),
                        leaves,
                        enters,
                    };
                    self.deviations()
                        .exchange(&self.springs, teeth, free, &mut state, outside);
                    [q[mean], v[mean], q[i], v[i]] = state;
                    change = Change::Restart;
                }
            }
        }
        change
    }
}

impl MovableTeeth {
    fn dissipated(&self, at: At<'_>) -> f64 {
        let first = self.first();
        let speed = self.hub.speed(at.t, at.v);
        let mut power = 0.0;
        for i in 0..at.q.len() - first {
            let p = self.spring(at, i, at.q[first + i]);
            power += p.c * (at.v[first + i] - speed).powi(2);
        }
        if self.slots > 0 && self.springs.damping[0] > 0.0 {
            let (_, vv) =
                self.deviations()
                    .squares(&self.springs, at.t, &at.discrete[self.head()..]);
            power += self.springs.damping[0] * self.springs.radius_squared * vv;
        }
        power
    }

    fn parametric(&self, at: At<'_>) -> f64 {
        if self.springs.radius.is_none() {
            return 0.0;
        }
        let first = self.first();
        let phi = self.hub.displacement(at.t, at.q);
        (0..at.q.len() - first)
            .map(|i| {
                let s = at.q[first + i];
                0.5 * self.spring(at, i, s).dk * at.v[first + i] * (s - phi).powi(2)
            })
            .sum()
    }

    fn driven_power(&self, at: At<'_>) -> f64 {
        if self.first() > 0 {
            return 0.0;
        }
        let (phi, speed) = (
            self.hub.displacement(at.t, at.q),
            self.hub.speed(at.t, at.v),
        );
        -(0..at.q.len())
            .map(|i| {
                let p = self.spring(at, i, at.q[i]);
                (p.k * (at.q[i] - phi) + p.c * (at.v[i] - speed)) * speed
            })
            .sum::<f64>()
    }

    /// Chooses the teeth with coordinates of their own, and notes what follows from them.
    fn lay_out(&mut self) {
        self.arrange();
        self.hub.own = match &self.integrated {
            Integrated::All => self.teeth,
            Integrated::Windows(_) => 1 + self.slots,
        };
        self.hub.discrete = self.head() + self.deviations().cells();
        self.note_constants();
        let teeth = (0..self.hub.own).map(|i| self.tooth_inertia(i));
        self.hub.masses = std::iter::repeat_n(self.body, self.first())
            .chain(teeth)
            .collect();
    }
}

impl MovableTeeth {
    /// Angle (or displacement) of any tooth from its assembled position, those outside the windows with their free
    /// deviation from the mean. `at` holds the gear's own state.
    pub fn exact_tooth_displacement(&self, at: At<'_>, tooth: Tooth) -> f64 {
        self.coordinate(at.discrete, tooth).map_or_else(
            || {
                let free = &at.discrete[self.head()..];
                at.q[self.first()] + self.deviations().of(&self.springs, at.t, free, tooth.index)
            },
            |i| at.q[i],
        )
    }

    #[inline]
    fn tooth_inertia(&self, i: usize) -> f64 {
        let p = &self.springs;
        let tooth = if p.uniform {
            0
        } else {
            self.slot(i).unwrap_or(0)
        };
        self.count(i) * p.mass[tooth] * p.radius_squared
    }
}

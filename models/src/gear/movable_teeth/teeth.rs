//! Data of a gear with movable teeth: springs, and the selection of teeth with individual coordinates.

use super::deviations::Deviations;
use super::springs::{RadiusStiffness, ToothSprings};
use crate::gear::hub_body::HubBody;
use crate::geometry::Side;
use crate::kinematics::{MeshView, Tooth};
use gearbench_integrators::system::StateView;

/// Fraction of a pitch beyond a whole pitch up to which teeth still belong to their present window.
pub(super) const HYSTERESIS: f64 = 0.05;

/// Margin for deflections in the width of a window, in pitches.
const MARGIN: f64 = 0.02;

/// Consecutive teeth around a mesh that are integrated individually.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Window {
    /// Number of teeth on each side of the middle one.
    pub(super) half: i64,
    /// Index of the coordinate of its first slot among those of the gear.
    pub(super) base: usize,
    /// Index of its first tooth slot, counted over the windows.
    pub(super) slot: usize,
}

impl Window {
    pub(super) fn len(&self) -> i64 {
        2 * self.half + 1
    }
}

/// Selection of the teeth with individual coordinates.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum ToothSelection {
    /// All teeth have coordinates.
    All,
    /// Windows around the meshes have coordinates; the mean represents all other teeth.
    Windows(Vec<Window>),
}

/// A gear or rack with movable teeth.
#[derive(Clone, Debug)]
pub struct MovableTeeth {
    pub(super) hub: HubBody,
    pub(super) teeth: usize,
    /// Inertia of the body without its teeth.
    pub(super) body: f64,
    pub(super) springs: ToothSprings,
    pub(super) all_wanted: bool,
    pub(super) integrated: ToothSelection,
    pub(super) views: Vec<MeshView>,
    /// Number of teeth in windows.
    pub(super) slots: usize,
    /// Springs of the coordinates of the gear where they are constant, otherwise empty.
    pub(super) constant: Vec<Spring>,
}

/// Spring of one coordinate about the hub.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spring {
    pub(super) k: f64,
    pub(super) dk: f64,
    /// Half of the second derivative of `k`.
    pub(super) bend: f64,
    pub(super) c: f64,
    pub(super) inertia: f64,
}

impl MovableTeeth {
    /// Returns the number of coordinates before the teeth: those of the mount.
    #[inline]
    pub(super) fn first(&self) -> usize {
        self.hub.coordinates()
    }

    #[inline]
    pub(super) fn deviations(&self) -> Deviations {
        Deviations { teeth: self.teeth }
    }

    /// Returns the number of cells of the discrete state before the deviations: the middle tooth of each mesh, and the
    /// flank in contact of each slot.
    #[inline]
    pub(super) fn head(&self) -> usize {
        let slots = if self.integrated == ToothSelection::All {
            self.teeth
        } else {
            self.slots
        };
        self.views.len().max(1) + slots
    }

    /// Returns the cell of the discrete state with the flank in contact of the tooth of a slot: 0, or the side's sign
    /// times (mesh + 1).
    #[inline]
    pub(super) fn engaged_cell(&self, slot: usize) -> usize {
        self.views.len().max(1) + slot
    }

    /// Returns inertia and number of the teeth represented by coordinate `first() + i`.
    #[inline]
    pub(super) fn count(&self, i: usize) -> f64 {
        match &self.integrated {
            ToothSelection::Windows(_) if i == 0 => (self.teeth - self.slots) as f64,
            _ => 1.0,
        }
    }

    /// Returns the slot of coordinate `first() + i`, or `None` for the mean.
    #[inline]
    pub(super) fn slot(&self, i: usize) -> Option<usize> {
        match &self.integrated {
            ToothSelection::All => Some(i),
            ToothSelection::Windows(_) => i.checked_sub(1),
        }
    }

    /// Returns the coordinate that represents a tooth. A tooth outside its window cannot touch; its small free
    /// deviation from the mean is neglected.
    #[inline]
    pub(super) fn own_or_mean(&self, discrete: &[f64], tooth: Tooth) -> usize {
        self.own_coordinate(discrete, tooth).unwrap_or(self.first())
    }

    /// Returns the coordinate of a tooth, or `None` outside the windows.
    #[inline]
    pub(super) fn own_coordinate(&self, discrete: &[f64], tooth: Tooth) -> Option<usize> {
        match &self.integrated {
            ToothSelection::All => {
                Some(self.first() + (tooth.index as i32).rem_euclid(self.teeth as i32) as usize)
            }
            ToothSelection::Windows(windows) => {
                let w = &windows[tooth.mesh as usize];
                let centre = discrete[tooth.mesh as usize] as i64;
                ((tooth.index - centre).abs() <= w.half)
                    .then(|| w.base + (tooth.index as i32).rem_euclid(w.len() as i32) as usize)
            }
        }
    }

    /// Returns the spring of coordinate `first() + i` at angle `s`: count, stiffness and its derivative by the angle,
    /// damping, tooth inertia, all about the hub (times `r_d^2`).
    #[inline]
    pub(super) fn spring(&self, at: StateView<'_>, i: usize, s: f64) -> Spring {
        match self.constant.get(i) {
            Some(spring) => *spring,
            None => self.varying_spring(at, i, s),
        }
    }

    /// Iterates over the coordinates after the mount's: index, angle, speed and spring.
    #[inline]
    pub(super) fn each_spring<'a>(
        &'a self,
        at: StateView<'a>,
    ) -> impl Iterator<Item = (usize, f64, f64, Spring)> + 'a {
        let own = self.first()..at.q.len();
        let state = at.q[own.clone()].iter().zip(&at.v[own]);
        let springs = state.enumerate();
        springs.map(move |(i, (&s, &v))| (i, s, v, self.spring(at, i, s)))
    }

    fn varying_spring(&self, at: StateView<'_>, i: usize, s: f64) -> Spring {
        let n = self.count(i);
        let slot = self.slot(i);
        let p = &self.springs;
        let tooth = if p.uniform { 0 } else { slot.unwrap_or(0) };
        let [mut k, mut dk, mut bend] = [p.stiffness[tooth], 0.0, 0.0];
        if let (Some(table), Some(slot)) = (&p.radius, slot) {
            let engaged = at.discrete[self.engaged_cell(slot)];
            if engaged != 0.0 {
                [k, dk, bend] = self.stiffness_in_contact(at, table, slot, engaged, s);
            }
        }
        let r2 = p.radius_squared;
        Spring {
            k: n * k * r2,
            dk: n * dk * r2,
            bend: 0.5 * n * bend * r2,
            c: n * p.damping[tooth] * r2,
            inertia: n * p.mass[tooth] * r2,
        }
    }

    /// Stores the constant springs.
    fn note_constants(&mut self) {
        self.constant.clear();
        if self.springs.radius.is_none() {
            let at = StateView {
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

    /// Returns `k(r)` of a tooth in contact and its derivatives by the angle `S`.
    fn stiffness_in_contact(
        &self,
        at: StateView<'_>,
        table: &RadiusStiffness,
        slot: usize,
        engaged: f64,
        s: f64,
    ) -> [f64; 3] {
        let mesh = engaged.abs() as usize - 1;
        let side = if engaged > 0.0 {
            Side::Left
        } else {
            Side::Right
        };
        let view = &self.views[mesh];
        let Some(rb) = view.base_radius else {
            return [table.at(0.0)[0], 0.0, 0.0];
        };
        let index = self.tooth_of_slot(at.discrete, mesh, slot);
        let angle = view.assembled + s + index as f64 * view.pitch;
        let path = view.path_coordinate(side, angle);
        let r = rb.hypot(path);
        let [k, by_r, bend] = table.at(r);
        let turn = path / r * rb * side.sign();
        let bend = bend * turn * turn + by_r * rb.powi(4) / r.powi(3);
        [k, by_r * turn, bend]
    }

    /// Returns the index of the tooth in a slot, counted on over turns and nearest to the mesh.
    pub(super) fn tooth_of_slot(&self, discrete: &[f64], mesh: usize, slot: usize) -> i64 {
        let centre = discrete[mesh] as i64;
        let (local, len) = match &self.integrated {
            ToothSelection::All => (slot as i64, self.teeth as i64),
            ToothSelection::Windows(w) => ((slot - w[mesh].slot) as i64, w[mesh].len()),
        };
        let first = centre - len / 2;
        first + (local - first).rem_euclid(len)
    }

    /// Returns the index of the tooth nearest to a mesh, as a real number.
    pub(super) fn nearest(&self, mesh: usize, displacement: f64) -> f64 {
        let v = &self.views[mesh];
        let target = if v.base_radius.is_some() {
            v.direction
        } else {
            0.0
        };
        (target - v.assembled - displacement) / v.pitch
    }

    /// Returns the number of teeth on each side of the nearest one that a mesh may touch on either flank.
    fn half_window(view: &MeshView) -> i64 {
        let reach = |s: f64| {
            let of = |half_angle: f64| match view.base_radius {
                Some(rb) => (s / rb - view.working_pressure_angle - half_angle).abs(),
                None => (half_angle - s / view.working_pressure_angle.cos()).abs(),
            };
            view.half_angle_base.map(of).into_iter().fold(0.0, f64::max)
        };
        let widest = reach(view.touching[0]).max(reach(view.touching[1])) / view.pitch;
        (widest - 0.5 + HYSTERESIS + MARGIN).ceil().max(0.0) as i64
    }

    /// Selects the windows, or all teeth where windows do not fit.
    fn arrange(&mut self) {
        self.integrated = ToothSelection::All;
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
            self.integrated = ToothSelection::Windows(windows);
        }
    }

    /// Selects the teeth with individual coordinates, and updates the dependent data.
    pub(super) fn lay_out(&mut self) {
        self.arrange();
        self.hub.own = match &self.integrated {
            ToothSelection::All => self.teeth,
            ToothSelection::Windows(_) => 1 + self.slots,
        };
        self.hub.discrete = self.head() + self.deviations().cells();
        self.note_constants();
        let teeth = (0..self.hub.own).map(|i| self.tooth_inertia(i));
        let sideways = usize::from(self.hub.is_free());
        let lateral = self.hub.masses.iter().copied().skip(sideways);
        self.hub.masses = std::iter::repeat_n(self.body, sideways)
            .chain(lateral.take(self.first() - sideways))
            .chain(teeth)
            .collect();
    }

    #[inline]
    pub(super) fn tooth_inertia(&self, i: usize) -> f64 {
        let p = &self.springs;
        let tooth = if p.uniform {
            0
        } else {
            self.slot(i).unwrap_or(0)
        };
        self.count(i) * p.mass[tooth] * p.radius_squared
    }
}

//! Forces and event functions of tooth pairs as scalars, for gears whose teeth move by one coordinate each.
//!
//! On the line of action the effective radius arm of a flank is constant: the contact row of a pair is one number per
//! gear, and its gap and gap rate follow from the displacements and speeds of two teeth. The pairs, and the
//! coordinates by which their teeth move, follow from the discrete state, which changes once in a thousand steps: they
//! are stored in a [`PairList`] until then. There is no search, and neither points nor rows are computed. Candidates
//! give the same forces of the same pairs, with the additional data for figures, tangents and friction.

use super::coupling::{Group, MOST_ON_LINE};
use super::lines::{Line, LinesOfAction, ZONE_EVENTS, all_open};
use crate::kinematics::{Hub, Tooth};
use crate::law::{Law, touch_speed};

/// Coordinate index of a gear whose motion is prescribed.
pub(crate) const PRESCRIBED: usize = usize::MAX;

/// Returns values for both gears. (A `map` over an array of two compiles to a call for each of them.)
#[inline(always)]
fn both<T>(of: impl Fn(usize) -> T) -> [T; 2] {
    [of(0), of(1)]
}

/// A tooth pair in the list of a mesh.
#[derive(Clone, Copy, Debug)]
struct ListedPair {
    pair: i64,
    slot: usize,
    /// Tooth number of the first gear.
    tooth: i64,
    /// Coordinates of the scene by which its teeth move, or [`PRESCRIBED`].
    coordinates: [usize; 2],
}

/// List of the pairs of a mesh for a discrete state, with one pair before and behind those of each line.
#[derive(Debug, Default)]
pub(crate) struct PairList {
    /// Discrete state of the list.
    key: Vec<f64>,
    listed: Vec<ListedPair>,
    /// End of each line in [`Self::listed`].
    ends: Vec<usize>,
}

impl PairList {
    /// Returns true if the list belongs to a discrete state, given in parts.
    #[inline(always)]
    fn is_of(&self, parts: [&[f64]; 3]) -> bool {
        let mut key = self.key.iter();
        for part in parts {
            for cell in part {
                if key.next() != Some(cell) {
                    return false;
                }
            }
        }
        !self.ends.is_empty() && key.next().is_none()
    }
}

/// A mesh at a state, for scalar forces.
pub(crate) struct Mesh<'a> {
    pub(crate) law: &'a Law,
    /// Effective radius arms of both gears on each line ([`LinesOfAction::arms`]).
    pub(crate) arms: &'a [[f64; 2]],
    /// Coordinates and velocities of the scene.
    pub(crate) q: &'a [f64],
    pub(crate) v: &'a [f64],
    /// Displacement and speed of gears whose motion is prescribed.
    pub(crate) prescribed: [[f64; 2]; 2],
    /// Discrete state of the search, and the parts of both gears that determine by which coordinates teeth move.
    pub(crate) discrete: [&'a [f64]; 3],
    /// Per slot `(mode, impact speed)`.
    pub(crate) modes: &'a [f64],
}

impl Mesh<'_> {
    #[inline(always)]
    fn displacement(&self, k: usize, coordinate: usize) -> f64 {
        match self.q.get(coordinate) {
            Some(q) => *q,
            None => self.prescribed[k][0],
        }
    }

    #[inline(always)]
    fn speed(&self, k: usize, coordinate: usize) -> f64 {
        match self.v.get(coordinate) {
            Some(v) => *v,
            None => self.prescribed[k][1],
        }
    }

    /// Returns the [impact speed](touch_speed) of a contact [m/s].
    #[inline(always)]
    fn impact_speed(&self, p: &LoadedPair) -> f64 {
        touch_speed(self.modes[2 * p.slot + 1], p.rate)
    }
}

/// A tooth pair whose force is evaluated.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LoadedPair {
    slot: usize,
    tooth: i64,
    coordinates: [usize; 2],
    /// Path coordinate [m], gap [m] and its rate [m/s].
    s: f64,
    gap: f64,
    rate: f64,
    scale: [f64; 2],
    /// Entries of the contact row of both gears.
    row: [f64; 2],
    stiffness: f64,
    stiffness_s: f64,
    /// Factor of both entries in the force [N].
    on: [f64; 2],
    /// Elastic force, which acts on neighbouring pairs [N].
    elastic: f64,
}

impl LoadedPair {
    #[inline(always)]
    fn add_to(&self, f: &mut [f64]) {
        for k in 0..2 {
            if let Some(f) = f.get_mut(self.coordinates[k]) {
                *f += self.on[k] * self.row[k];
            }
        }
    }
}

/// Computes the force of a closed pair, with the parametric term of its stiffness along the path.
#[inline(always)]
fn press(law: &Law, mesh: &Mesh<'_>, p: &mut LoadedPair) {
    let (mode, v0) = (mesh.modes[2 * p.slot], mesh.impact_speed(p));
    let n = law.force_in_mode(mode, p.gap, p.rate, v0, p.stiffness);
    p.on = [n; 2];
    if p.stiffness_s != 0.0 {
        let along = 0.5 * law.d_potential_dk(p.gap, p.stiffness) * p.stiffness_s;
        p.on = [n + along / p.scale[0], n - along / p.scale[1]];
    }
}

/// Returns the event function of a pair [m].
#[inline(always)]
fn watched(law: &Law, mesh: &Mesh<'_>, p: &LoadedPair) -> f64 {
    let v0 = mesh.impact_speed(p);
    let mode = mesh.modes[2 * p.slot];
    if mode == 0.0 {
        return law.until_it_pushes(p.gap, p.rate, v0, p.stiffness);
    }
    law.valid_for(mode, p.gap, p.rate, v0, p.stiffness)
}

impl LinesOfAction {
    /// Returns the effective radius arms of both gears on each line, `d(x . n)/dq` of a point on it, from the hubs.
    pub(crate) fn arms(&self, of: [&Hub; 2]) -> Vec<[f64; 2]> {
        let lines = self.lines.iter();
        lines
            .map(|line| of.map(|hub| hub.effective_radius(&line.origin, &line.normal)))
            .collect()
    }

    /// Lists the pairs of a discrete state. `coordinate` returns the coordinate of the scene by which a tooth of the
    /// first or second gear moves.
    #[inline(always)]
    pub(crate) fn list(
        &self,
        mesh: &Mesh<'_>,
        pair_list: &mut PairList,
        coordinate: impl Fn(usize, Tooth) -> usize,
    ) {
        if self.whole_mesh || !pair_list.is_of(mesh.discrete) {
            self.list_afresh(mesh, pair_list, &coordinate);
        }
    }

    #[inline(never)]
    fn list_afresh(
        &self,
        mesh: &Mesh<'_>,
        pair_list: &mut PairList,
        coordinate: &dyn Fn(usize, Tooth) -> usize,
    ) {
        pair_list.key.clear();
        for part in mesh.discrete {
            pair_list.key.extend_from_slice(part);
        }
        pair_list.listed.clear();
        pair_list.ends.clear();
        for (l, line) in self.lines.iter().enumerate() {
            let listed = |pair: i64| {
                let teeth = self.teeth(line.side, pair);
                ListedPair {
                    pair,
                    slot: self.slot(l, pair),
                    tooth: teeth[0].index,
                    coordinates: both(|k| coordinate(k, teeth[k])),
                }
            };
            let (lo, hi) = if self.whole_mesh {
                // One spring: the pair nearest to the middle of the path stands for the mesh.
                let pair = self.nearest_to_middle(self.middle(self.path(line, &listed(0), mesh)));
                (pair, pair)
            } else {
                let own = &mesh.discrete[0][2 * l..];
                (own[0] as i64, own[1] as i64)
            };
            // Neither end is missing where a run that blows up has crossed both.
            pair_list
                .listed
                .extend((lo - 1..=lo.max(hi + 1)).map(listed));
            pair_list.ends.push(pair_list.listed.len());
        }
    }

    /// Returns the pairs of a line, with one before and one behind them.
    #[inline(always)]
    fn of_line<'r>(&self, pair_list: &'r PairList, l: usize) -> &'r [ListedPair] {
        let first = if l == 0 { 0 } else { pair_list.ends[l - 1] };
        &pair_list.listed[first..pair_list.ends[l]]
    }

    #[inline(always)]
    fn path(&self, line: &Line, of: &ListedPair, mesh: &Mesh<'_>) -> [f64; 2] {
        both(|k| {
            let x = mesh.displacement(k, of.coordinates[k]);
            line.map[k].s(x, of.pair)
        })
    }

    /// Returns the gap of a pair [m] and the scales of its row.
    #[inline(always)]
    fn gap_and_scale(&self, line: &Line, pair: i64, s: [f64; 2]) -> (f64, [f64; 2]) {
        if line.plain && s[0] <= line.tips[0] && s[1] <= line.tips[1] {
            let gap = self.helix_cos * (self.mesh.length - s[0] - s[1]);
            return (gap, [1.0; 2]);
        }
        let p = self.pair_on_line(line, pair, s);
        (p.gap, p.scale)
    }

    /// Adds the forces of the closed pairs.
    pub(crate) fn add_forces(
        &self,
        mesh: &Mesh<'_>,
        pair_list: &PairList,
        found: &mut Vec<LoadedPair>,
        f: &mut [f64],
    ) {
        for l in 0..self.lines.len() {
            if all_open(&mesh.modes[2 * l * self.pairs..][..2 * self.pairs]) {
                continue;
            }
            let line = &self.lines[l];
            let law = mesh.law.shared(self.slices[line.slice].weight);
            let of_line = self.of_line(pair_list, l);
            let closed = of_line[1..of_line.len() - 1].iter();
            let closed = closed.filter(|of| mesh.modes[2 * of.slot] != 0.0);
            if !self.couples() {
                for of in closed {
                    let path = self.path(line, of, mesh);
                    let mut p = self.pressed(l, of, path, mesh);
                    press(&law, mesh, &mut p);
                    p.add_to(f);
                }
                continue;
            }
            found.clear();
            for of in closed {
                let path = self.path(line, of, mesh);
                found.push(self.pressed(l, of, path, mesh));
            }
            self.couple_pressed(l, found, |_| true);
            for p in &mut *found {
                press(&law, mesh, p);
            }
            self.press_along(l, found);
            for p in &*found {
                p.add_to(f);
            }
        }
    }

    /// Computes the event functions of the discrete state: of the zone, and of each pair in it by slot, in metres.
    /// Others are not changed.
    pub(crate) fn watch_listed(
        &self,
        mesh: &Mesh<'_>,
        pair_list: &PairList,
        found: &mut Vec<LoadedPair>,
        zones: &mut [f64],
        slots: &mut [f64],
    ) {
        let dissipates = mesh.law.is_dissipative();
        for (l, line) in self.lines.iter().enumerate() {
            let of_line = self.of_line(pair_list, l);
            let n = of_line.len();
            let place = |i: usize| self.middle(self.path(line, &of_line[i], mesh));
            if !self.whole_mesh {
                let ends = [place(0), place(1), place(n - 2), place(n - 1)];
                self.set_zone_events(ends, &mut zones[ZONE_EVENTS * l..][..ZONE_EVENTS]);
            }
            let closed = !all_open(&mesh.modes[2 * l * self.pairs..][..2 * self.pairs]);
            let couples = closed && self.couples();
            let law = mesh.law.shared(self.slices[line.slice].weight);
            found.clear();
            for of in &of_line[1..n - 1] {
                let path = self.path(line, of, mesh);
                let open = mesh.modes[2 * of.slot] == 0.0;
                let (gap, scale) = self.gap_and_scale(line, of.pair, path);
                if couples {
                    found.push(self.pressed_at(l, of, path, (gap, scale), mesh));
                } else if dissipates && !(open && gap > 0.0) {
                    let p = self.pressed_at(l, of, path, (gap, scale), mesh);
                    slots[of.slot] = watched(&law, mesh, &p);
                } else {
                    // Gaps are all that open contacts and contacts without damping need.
                    slots[of.slot] = if open { gap } else { -gap };
                }
            }
            if couples {
                self.couple_pressed(l, found, |slot| mesh.modes[2 * slot] != 0.0);
                for p in &*found {
                    slots[p.slot] = watched(&law, mesh, p);
                }
            }
        }
    }

    /// Returns a pair without its force.
    #[inline(always)]
    fn pressed(&self, l: usize, of: &ListedPair, path: [f64; 2], mesh: &Mesh<'_>) -> LoadedPair {
        let gap_and_scale = self.gap_and_scale(&self.lines[l], of.pair, path);
        self.pressed_at(l, of, path, gap_and_scale, mesh)
    }

    /// Returns a pair, without its force, from its gap and scales.
    #[inline(always)]
    fn pressed_at(
        &self,
        l: usize,
        of: &ListedPair,
        path: [f64; 2],
        (gap, scale): (f64, [f64; 2]),
        mesh: &Mesh<'_>,
    ) -> LoadedPair {
        let line = &self.lines[l];
        let [a, b] = mesh.arms[l];
        let row = [-scale[0] * a, scale[1] * b];
        let speed = both(|k| mesh.speed(k, of.coordinates[k]));
        let s = self.middle(path);
        let (k, k_s) = self.stiffness.eval(s);
        let weight = self.slices[line.slice].weight;
        LoadedPair {
            slot: of.slot,
            tooth: of.tooth,
            coordinates: of.coordinates,
            s,
            gap,
            rate: row[0] * speed[0] + row[1] * speed[1],
            scale,
            row,
            stiffness: k * weight,
            stiffness_s: k_s * weight / self.helix_cos,
            on: [0.0; 2],
            elastic: 0.0,
        }
    }

    /// Adds the elastic effect of neighbouring forces to the gaps of pairs of a line.
    #[inline(always)]
    fn couple_pressed(&self, l: usize, found: &mut [LoadedPair], closed: impl Fn(usize) -> bool) {
        if found.len() < 2 || !self.couples() {
            return;
        }
        let mut group = Group::default();
        for p in found.iter().take(MOST_ON_LINE) {
            group.add(p.tooth, p.s, p.stiffness, p.gap, Some(closed(p.slot)));
        }
        self.settle(l, &mut group);
        for (p, gap) in found.iter_mut().zip(group.gap).take(group.n) {
            p.gap = gap;
        }
    }

    /// Adds the change of the compliance between the pairs of a line along the path to their forces.
    #[inline(always)]
    fn press_along(&self, l: usize, found: &mut [LoadedPair]) {
        if found.len() < 2 {
            return;
        }
        for p in &mut *found {
            p.elastic = self.elastic.force(p.gap, 0.0, 0.0, p.stiffness);
        }
        for j in 1..found.len() {
            let (before, rest) = found.split_at_mut(j);
            let b = &mut rest[0];
            for a in before {
                let between = self.between(l, [a.tooth, b.tooth], [a.s, b.s]);
                let Some((_, slope)) = between.filter(|_| a.slot != b.slot) else {
                    continue;
                };
                // By half for either contact, and by half for either gear.
                let along = -0.25 * slope * a.elastic * b.elastic;
                for p in [&mut *a, &mut *b] {
                    p.on[0] += along / p.scale[0];
                    p.on[1] -= along / p.scale[1];
                }
            }
        }
    }
}

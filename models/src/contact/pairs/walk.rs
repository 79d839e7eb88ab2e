//! Consecutive pairs along the lines of action: teeth, path coordinates, gaps and candidates.

use super::lines::{
    Displacements, GearKinematics, Line, LinesOfAction, MeshedGears, PairState, side_index,
};
use crate::contact::candidate::Candidate;
use crate::contact::gear_state::CandidateSelection;
use crate::geometry::Side;
use crate::kinematics::{Locus, Point, Tooth};

/// Number of pairs whose path coordinates are computed at once: those of a line, for contact ratios up to three.
const BLOCK: usize = 4;

/// Rounds `x` to the nearest whole number within 32 bits: no gear turns through 2^31 teeth, except in a diverging run.
/// (`round` is a library call on processors without SSE 4.1.)
#[inline]
fn nearest(x: f64) -> i64 {
    i64::from((x + 0.5_f64.copysign(x)) as i32)
}

impl LinesOfAction {
    #[inline]
    pub(super) fn teeth(&self, side: Side, pair: i64) -> [Tooth; 2] {
        let i = if side == Side::Left { pair } else { -pair };
        // Gears turn against each other; a rack goes along, and so do an internal gear and its mate.
        let [a, b] = self.counting;
        let j = b * i;
        [
            Tooth {
                index: a * i,
                mesh: self.mesh.mesh_of_gear[0],
            },
            Tooth {
                index: j + self.partner[side_index(side)],
                mesh: self.mesh.mesh_of_gear[1],
            },
        ]
    }

    /// Returns the path coordinate of the flank of gear `k` in a pair [m].
    #[inline(always)]
    fn path_coordinate(&self, line: &Line, k: usize, gear: &GearKinematics<'_>, pair: i64) -> f64 {
        let displacement = match gear.displacements {
            Displacements::OfHub(displacement) => displacement,
            Displacements::OfTeeth(teeth) => {
                teeth.displacement(gear.at, self.teeth(line.side, pair)[k])
            }
        };
        line.map[k].s(displacement, pair)
    }

    /// Computes the path coordinates of the flanks of gear `k` in consecutive pairs from `first` on [m].
    #[inline(always)]
    fn path_coordinates(
        &self,
        line: &Line,
        k: usize,
        gear: &GearKinematics<'_>,
        first: i64,
        out: &mut [f64],
    ) {
        let teeth = match gear.displacements {
            Displacements::OfHub(displacement) => {
                for (pair, s) in (first..).zip(out) {
                    *s = line.map[k].s(displacement, pair);
                }
                return;
            }
            Displacements::OfTeeth(teeth) => teeth,
        };
        let up = line.ascending[k];
        let lowest = if up {
            first
        } else {
            first + out.len() as i64 - 1
        };
        teeth.displacements(gear.at, self.teeth(line.side, lowest)[k], out);
        if !up {
            out.reverse();
        }
        for (pair, x) in (first..).zip(out) {
            *x = line.map[k].s(*x, pair);
        }
    }

    /// Calls `f(slot, pair, path coordinates)` for consecutive pairs of a line.
    #[inline(always)]
    pub(super) fn each_pair(
        &self,
        l: usize,
        (first, last): (i64, i64),
        gears: &MeshedGears<'_>,
        mut f: impl FnMut(usize, i64, [f64; 2]),
    ) {
        let [a, b] = &gears.of;
        let line = &self.lines[l];
        let (mut pair, mut slot) = (first, self.slot(l, first));
        if let [Displacements::OfHub(a), Displacements::OfHub(b)] =
            [a.displacements, b.displacements]
        {
            while pair <= last {
                f(slot, pair, [line.map[0].s(a, pair), line.map[1].s(b, pair)]);
                pair += 1;
                slot = self.next_slot(l, slot);
            }
            return;
        }
        while pair <= last {
            let n = ((last - pair + 1) as usize).min(BLOCK);
            let mut s = [[0.0; BLOCK]; 2];
            self.path_coordinates(line, 0, a, pair, &mut s[0][..n]);
            self.path_coordinates(line, 1, b, pair, &mut s[1][..n]);
            for i in 0..n {
                f(slot, pair, [s[0][i], s[1][i]]);
                pair += 1;
                slot = self.next_slot(l, slot);
            }
        }
    }

    /// Returns a pair with its teeth, path coordinates and gap.
    #[inline(always)]
    pub(super) fn pair(
        &self,
        line: &Line,
        gears: &MeshedGears<'_>,
        pair: i64,
        s: [f64; 2],
    ) -> PairState {
        match &self.spatial {
            None if self.planar => self.pair_in_plane(line, gears, pair, s),
            None => self.pair_on_line(line, pair, s),
            Some(spatial) => self.pair_in_space(spatial, line, gears, pair, s),
        }
    }

    /// Returns the path coordinates of both flanks of a pair [m].
    pub(super) fn both(&self, line: &Line, gears: &MeshedGears<'_>, pair: i64) -> [f64; 2] {
        [0, 1].map(|k| self.path_coordinate(line, k, &gears.of[k], pair))
    }

    /// Returns a pair on the line of action from its path coordinates.
    #[inline(always)]
    pub(super) fn pair_on_line(&self, line: &Line, pair: i64, s: [f64; 2]) -> PairState {
        let teeth = self.teeth(line.side, pair);
        let mut p = PairState {
            teeth,
            s,
            gap: self.helix_cos * (self.mesh.length - s[0] - s[1]),
            scale: [1.0; 2],
            curvature: [0.0; 2],
            touch: None,
        };
        if !(line.plain && s[0] <= line.tips[0] && s[1] <= line.tips[1]) {
            self.separate(line, &mut p);
        }
        p
    }

    /// Adds the separations of the flanks of a pair from their involutes.
    pub(super) fn separate(&self, line: &Line, p: &mut PairState) {
        let separations = &self.slices[line.slice].separation[line.side.index()];
        for (k, separation) in separations.iter().enumerate() {
            let [e, slope, curvature] = separation.eval(p.s[k]);
            p.gap += e;
            p.scale[k] -= slope / self.helix_cos;
            p.curvature[k] = curvature / (self.helix_cos * self.helix_cos);
        }
        for (k, gear) in self.mesh.deviating.iter().enumerate() {
            let Some(gear) = gear else { continue };
            let side = gear.side_from_root(line.side);
            let [e, slope, curvature] =
                gear.tooth_deviation_at_roll(p.teeth[k].index, side, p.s[k]);
            p.gap += e;
            p.scale[k] -= slope / self.helix_cos;
            p.curvature[k] += curvature / (self.helix_cos * self.helix_cos);
        }
    }

    /// Returns true if all pairs of a line are certainly open by more than `reach` [m], without an evaluation of each,
    /// where all teeth move with the hub. False gives no information.
    #[inline(always)]
    pub(super) fn clearly_open(&self, line: &Line, gears: &MeshedGears<'_>, reach: f64) -> bool {
        let [a, b] = &gears.of;
        let (Displacements::OfHub(a), Displacements::OfHub(b)) = (a.displacements, b.displacements)
        else {
            return false;
        };
        if let Some(spatial) = &self.spatial {
            return self.is_apart(spatial, line, gears, reach);
        }
        if !line.plain {
            return false;
        }
        let slack =
            line.slack - line.map[0].per_displacement * a - line.map[1].per_displacement * b;
        // Rounding may leave the exact gap a hair below.
        self.helix_cos * slack > reach + 1e-9 * self.mesh.base_pitch
    }

    #[inline(always)]
    fn points(&self, line: &Line, teeth: [Tooth; 2], s: [f64; 2]) -> [Point; 2] {
        let x = line.origin + self.middle(s) * line.transverse;
        let zeta = self.slices[line.slice].zeta;
        let flank = |k: usize| {
            let radius = match self.mesh.views[k].base_radius {
                Some(rb) => (rb * rb + s[k] * s[k]).sqrt(),
                None => self.height_on_rack(k, self.middle(s)),
            };
            Point {
                tooth: teeth[k],
                locus: Locus::Flank { radius, zeta },
                x,
            }
        };
        [flank(0), flank(1)]
    }

    /// Returns the path coordinate of a contact on that of gear a [m], independent of the order of the gears.
    #[inline(always)]
    pub(super) fn middle(&self, s: [f64; 2]) -> f64 {
        0.5 * (s[0] + self.mesh.length - s[1])
    }

    /// Returns the height above the reference line of a rack, which lies at `length / sin(alpha)` from gear a.
    pub(super) fn height_on_rack(&self, k: usize, s_a: f64) -> f64 {
        let (sin, cos) = self.mesh.views[k].working_pressure_angle.sin_cos();
        let rb = self.mesh.views[0].base_radius.unwrap_or(0.0);
        self.mesh.length / sin - (rb * cos + s_a * sin)
    }

    /// Returns the slot of the pair after the one in `slot`.
    #[inline(always)]
    fn next_slot(&self, l: usize, slot: usize) -> usize {
        if slot + 1 == (l + 1) * self.pairs {
            l * self.pairs
        } else {
            slot + 1
        }
    }

    #[inline]
    pub(super) fn slot(&self, l: usize, pair: i64) -> usize {
        // 32-bit division is several times cheaper, and no gear turns through 2^31 teeth.
        l * self.pairs + (pair as i32).rem_euclid(self.pairs as i32) as usize
    }

    #[inline]
    fn candidate(&self, line: &Line, slot: usize, p: &PairState) -> Candidate {
        let weight = self.slices[line.slice].weight;
        let mut points = self.points(line, p.teeth, p.s);
        let (mut normal, mut along) = (line.normal, None);
        if let Some(touch) = &p.touch {
            points.iter_mut().for_each(|point| point.x = touch.x);
            normal = touch.normal;
            along = Some(touch.path.map(|part| self.helix_cos * part));
        }
        let s = self.middle(p.s);
        let (k, k_s) = self.stiffness.eval(s);
        Candidate {
            aside: [crate::Vec3::zeros(); 2],
            taper: 1.0,
            slot,
            points,
            normal,
            along,
            scale: p.scale,
            curvature: p.curvature,
            gap: p.gap,
            stiffness: k * weight,
            stiffness_s: k_s * weight / self.helix_cos,
            s,
            share: weight,
        }
    }

    /// Appends the candidates of a line.
    pub(super) fn collect(
        &self,
        l: usize,
        gears: &MeshedGears<'_>,
        discrete: &[f64],
        selection: CandidateSelection<'_>,
        out: &mut Vec<Candidate>,
    ) {
        let line = &self.lines[l];
        let listed = !matches!(selection, CandidateSelection::Touching(_));
        let range = self.pairs_of(l, gears, discrete, listed);
        self.each_pair(l, range, gears, |slot, pair, s| {
            if let CandidateSelection::Closed(modes) = selection
                && modes[2 * slot] == 0.0
            {
                return;
            }
            let p = self.pair(line, gears, pair, s);
            if let CandidateSelection::Touching(reach) = selection
                && p.gap > reach
            {
                return;
            }
            out.push(self.candidate(line, slot, &p));
        });
    }

    /// Computes the gaps of consecutive pairs of a line, by slot.
    pub(super) fn gaps_of_pairs(
        &self,
        l: usize,
        range: (i64, i64),
        gears: &MeshedGears<'_>,
        out: &mut [f64],
    ) {
        let line = &self.lines[l];
        self.each_pair(l, range, gears, |slot, pair, s| {
            out[slot] = self.pair(line, gears, pair, s).gap
        });
    }

    /// Computes event functions and gaps of a line; the displacements of teeth with their own motion are read once for
    /// both.
    pub(super) fn watch_line(
        &self,
        l: usize,
        (lo, hi): (i64, i64),
        gears: &MeshedGears<'_>,
        event_functions: &mut [f64],
        gaps: &mut [f64],
    ) {
        let line = &self.lines[l];
        let n = (hi - lo + 1) as usize;
        let mut both = [[0.0; BLOCK + 2]; 2];
        if n > BLOCK {
            let place = |pair: i64| self.place(line, gears, pair);
            self.set_zone_events([lo - 1, lo, hi, hi + 1].map(place), event_functions);
            return self.gaps_of_pairs(l, (lo, hi), gears, gaps);
        }
        let [a, b] = &mut both;
        let (a, b) = (&mut a[..n + 2], &mut b[..n + 2]);
        self.path_coordinates(line, 0, &gears.of[0], lo - 1, a);
        self.path_coordinates(line, 1, &gears.of[1], lo - 1, b);
        let ends = [0, 1, n, n + 1].map(|i| self.middle([a[i], b[i]]));
        self.set_zone_events(ends, event_functions);
        let mut slot = self.slot(l, lo);
        for i in 0..n {
            let s = [a[i + 1], b[i + 1]];
            gaps[slot] = self.pair(line, gears, lo + i as i64, s).gap;
            slot = self.next_slot(l, slot);
        }
    }

    /// Returns the path coordinate of a pair on that of gear a [m], independent of the order of the gears.
    #[inline(always)]
    pub(super) fn place(&self, line: &Line, gears: &MeshedGears<'_>, pair: i64) -> f64 {
        self.middle(self.both(line, gears, pair))
    }

    /// Sets the event functions of a zone from `s`, the path coordinates of the pair before the first, the first, the
    /// last, and the one after it.
    #[inline(always)]
    pub(super) fn set_zone_events(&self, s: [f64; 4], event_functions: &mut [f64]) {
        let scale = self.per_base_pitch;
        event_functions[0] = (self.zone[1] - s[2]) * scale;
        event_functions[1] = (s[1] - self.zone[0]) * scale;
        event_functions[2] = (self.zone[0] - s[0]) * scale;
        event_functions[3] = (s[3] - self.zone[1]) * scale;
    }

    /// Returns the range of pairs that a line evaluates: those in the discrete state, or those in the zone at this
    /// state.
    #[inline(always)]
    pub(super) fn pairs_of(
        &self,
        l: usize,
        gears: &MeshedGears<'_>,
        discrete: &[f64],
        listed: bool,
    ) -> (i64, i64) {
        let line = &self.lines[l];
        if self.whole_mesh {
            // One spring: the pair nearest to the middle of the path stands for the mesh; all pairs of
            // rigid gears have its gap.
            let pair = self.nearest_to_middle(self.place(line, gears, 0));
            (pair, pair)
        } else if listed {
            (discrete[2 * l] as i64, discrete[2 * l + 1] as i64)
        } else {
            self.zone_now(line, gears)
        }
    }

    /// Returns the pair nearest to the middle of the path, where pair 0 is at a path coordinate [m].
    #[inline]
    pub(super) fn nearest_to_middle(&self, s0: f64) -> i64 {
        let middle = 0.5 * (self.zone[0] + self.zone[1]);
        nearest((middle - s0) * self.per_base_pitch)
    }

    /// Returns the first and last pair in the zone at a state.
    pub(super) fn zone_now(&self, line: &Line, gears: &MeshedGears<'_>) -> (i64, i64) {
        // The teeth move little against the hub, so the pair nearest to the middle is a safe start.
        let guess = self.nearest_to_middle(self.place(line, gears, 0));
        // Two pairs on each side are all that a contact ratio below three has.
        let mut around = [[0.0; 5]; 2];
        for (k, around) in around.iter_mut().enumerate() {
            self.path_coordinates(line, k, &gears.of[k], guess - 2, around);
        }
        let inside = |p: i64| {
            let known = usize::try_from(p - (guess - 2)).ok().filter(|i| *i < 5);
            let s = match known {
                Some(i) => self.middle([around[0][i], around[1][i]]),
                None => self.place(line, gears, p),
            };
            s >= self.zone[0] && s <= self.zone[1]
        };
        let reach = self.pairs as i64 + 1;
        let (mut lo, mut hi) = (guess, guess);
        while lo > guess - reach && inside(lo - 1) {
            lo -= 1;
        }
        while hi < guess + reach && inside(hi + 1) {
            hi += 1;
        }
        (lo, hi)
    }
}

//! Contact on the lines of action: all tooth pairs in the contact zone, both flanks, sliced over the width.
//!
//! In the transverse plane the flanks of a pair touch on the line of action, the common tangent of the base
//! circles. With the path coordinate `s_a` of gear a's flank from its tangent point towards gear b and `s_b`
//! of gear b's flank from the other end, the gap along the line is
//!
//! ```text
//! g = L - s_a - s_b + e_a(s_a) + e_b(s_b),   s = r_b (sign * theta + alpha_w + chi)
//! ```
//!
//! with `theta` the angle of the tooth from the line of centres, `chi` its half angle on the base circle, `L`
//! the length between the tangent points, `e` the flank modification. A pair lies in the zone while
//! `s_A <= s_a <= s_E`. This is the six-step search of seed 001 (Ebrahimi, Eberhard 2006: tooth of gear 1 in
//! the contact region, its neighbours, their partners, intersection with the line of action, relative angle;
//! the same for the other flank) with each tooth's own angle, so it serves rigid gears, movable teeth, and
//! elastic gears whose points stay on the line.
//!
//! The line's normal, for flank sign +1 (left) or -1 and direction of centres `delta`: angle
//! `delta + sign (pi/2 - alpha_w)`, tangent point at angle `delta - sign alpha_w`.

use super::candidate::{Candidate, Locus, Point, Tooth};
use super::search::{ContactSearch, Party, Wanted, ZoneChange};
use crate::Vec3;
use crate::gear::MeshView;
use crate::geometry::Side;
use crate::stiffness::StiffnessCurve;

/// Deviation of one gear's flank over its own path coordinate, sampled once.
#[derive(Clone, Debug)]
pub struct Deviation {
    start: f64,
    step: f64,
    value: Vec<f64>,
}

impl Deviation {
    /// Samples `e(s)` [m] on `[start, end]`.
    pub fn sample(range: [f64; 2], samples: usize, e: impl Fn(f64) -> f64) -> Self {
        let step = (range[1] - range[0]) / (samples - 1) as f64;
        let value = (0..samples).map(|i| e(range[0] + i as f64 * step)).collect();
        Deviation { start: range[0], step, value }
    }

    /// Value and slope at `s`; cubic between samples (Catmull-Rom) and straight on outside, so the slope is
    /// continuous: a flank that is short of the other's tip by the gap reaches a little beyond its path.
    #[inline]
    pub fn eval(&self, s: f64) -> (f64, f64) {
        let n = self.value.len();
        let last = (n - 1) as f64;
        let x = (s - self.start) / self.step;
        let line = |i: usize, from: f64| {
            let rise = self.value[i + 1] - self.value[i];
            (self.value[i] + (x - from) * rise, rise / self.step)
        };
        if x <= 0.0 {
            return line(0, 0.0);
        }
        if x >= last {
            return line(n - 2, last - 1.0);
        }
        let i = x as usize;
        let u = x - i as f64;
        let (p1, p2) = (self.value[i], self.value[i + 1]);
        let p0 = if i > 0 { self.value[i - 1] } else { 2.0 * p1 - p2 };
        let p3 = if i + 2 < n { self.value[i + 2] } else { 2.0 * p2 - p1 };
        let (m1, m2) = (0.5 * (p2 - p0), 0.5 * (p3 - p1));
        let (d, r) = (p2 - p1, 1.0 - u);
        let value = p1 + u * d + u * r * (r * (m1 - d) - u * (m2 - d));
        let slope = d + r * (1.0 - 3.0 * u) * (m1 - d) + u * (2.0 - 3.0 * u) * (d - m2);
        (value, slope / self.step)
    }
}

/// A slice of the face width.
#[derive(Clone, Debug)]
pub struct Slice {
    /// Position over the width in [-1, 1].
    pub zeta: f64,
    /// Height along the axis [m].
    pub z: f64,
    /// Share of the stiffness.
    pub weight: f64,
    /// Offset of the path coordinate of a left flank by the helix [m].
    pub offset: f64,
    /// Modification of the flanks of both gears, if any.
    pub deviation: [Option<Deviation>; 2],
}

/// What a mesh of two gears looks like in its transverse plane.
#[derive(Clone, Debug)]
pub struct LinesOfAction {
    /// How the mesh sees gear a (never a rack) and gear b.
    pub views: [MeshView; 2],
    /// The mesh's index in each gear's own count.
    pub mesh_of_gear: [u8; 2],
    /// Centre of gear a [m].
    pub centre_a: Vec3,
    /// Distance between the tangent points [m].
    pub length: f64,
    /// Base pitch [m].
    pub base_pitch: f64,
    /// Start and end of the path of contact on `s_a` [m].
    pub zone: [f64; 2],
    /// Base helix angle of gear a [rad].
    pub base_helix: f64,
    /// Tooth index of b that pair 0 joins to tooth 0 of a, for the left and the right flank.
    pub partner: [i64; 2],
    /// Stiffness of a pair along `s_a`, whole width.
    pub stiffness: StiffnessCurve,
    /// One spring for the mesh, whatever the number of pairs in contact.
    pub whole_mesh: bool,
    /// Slices over the width; one for a spur gear.
    pub slices: Vec<Slice>,
    /// Contact slots per line.
    pub pairs: usize,
    helix_cos: f64,
    lines: Vec<Line>,
}

/// One flank side of one slice.
#[derive(Clone, Debug)]
struct Line {
    side: Side,
    slice: usize,
    /// Unit normal from a to b, and its part in the transverse plane.
    normal: Vec3,
    transverse: Vec3,
    /// Tangent point on gear a in the slice's plane.
    origin: Vec3,
    /// `s = at_zero + per_travel * travel + per_pair * pair` for both gears, helix included.
    map: [PathMap; 2],
}

/// Path coordinate of a flank as a linear function of its tooth's travel and the pair's number.
#[derive(Clone, Copy, Debug, Default)]
struct PathMap {
    at_zero: f64,
    per_travel: f64,
    per_pair: f64,
}

impl PathMap {
    #[inline]
    fn s(&self, travel: f64, pair: i64) -> f64 {
        self.at_zero + self.per_travel * travel + self.per_pair * pair as f64
    }
}

/// A pair at a state.
#[derive(Clone, Copy, Debug)]
struct PairState {
    teeth: [Tooth; 2],
    s: [f64; 2],
    gap: f64,
    scale: [f64; 2],
}

/// Everything of [`LinesOfAction`] that is given; lines and slots follow.
#[derive(Clone, Debug)]
pub struct MeshGeometry {
    /// See [`LinesOfAction::views`].
    pub views: [MeshView; 2],
    /// See [`LinesOfAction::mesh_of_gear`].
    pub mesh_of_gear: [u8; 2],
    /// See [`LinesOfAction::centre_a`].
    pub centre_a: Vec3,
    /// See [`LinesOfAction::length`].
    pub length: f64,
    /// See [`LinesOfAction::base_pitch`].
    pub base_pitch: f64,
    /// See [`LinesOfAction::zone`].
    pub zone: [f64; 2],
    /// See [`LinesOfAction::base_helix`].
    pub base_helix: f64,
}

const ZONE_GUARDS: usize = 4;

impl LinesOfAction {
    /// Builds the lines of both flanks.
    pub fn new(g: MeshGeometry, stiffness: StiffnessCurve, whole_mesh: bool, slices: Vec<Slice>) -> Self {
        let view = &g.views[0];
        let (delta, alpha) = (view.direction, view.working_pressure_angle);
        let rb = view.base_radius.unwrap_or(0.0);
        let mut lines = Vec::new();
        for side in [Side::Left, Side::Right] {
            let sign = side.sign();
            let along = delta + sign * (std::f64::consts::FRAC_PI_2 - alpha);
            let transverse = Vec3::new(along.cos(), along.sin(), 0.0);
            let to_tangent = delta - sign * alpha;
            let (c, s) = (g.base_helix.cos(), g.base_helix.sin());
            let normal = Vec3::new(c * transverse.x, c * transverse.y, -sign * s);
            for (i, slice) in slices.iter().enumerate() {
                let mut origin = g.centre_a + rb * Vec3::new(to_tangent.cos(), to_tangent.sin(), 0.0);
                origin.z = slice.z;
                lines.push(Line {
                    side,
                    slice: i,
                    normal,
                    transverse,
                    origin,
                    map: [PathMap::default(); 2],
                });
            }
        }
        let ratio = (g.zone[1] - g.zone[0]) / g.base_pitch;
        let pairs = if whole_mesh { 1 } else { ratio.floor() as usize + 2 };
        let mut loa = LinesOfAction {
            views: g.views,
            mesh_of_gear: g.mesh_of_gear,
            centre_a: g.centre_a,
            length: g.length,
            base_pitch: g.base_pitch,
            zone: g.zone,
            base_helix: g.base_helix,
            partner: [0, 0],
            stiffness,
            whole_mesh,
            slices,
            pairs,
            helix_cos: g.base_helix.cos(),
            lines,
        };
        for side in [Side::Left, Side::Right] {
            let gap = |j: i64| {
                let a = loa.views[0].path_coordinate(side, loa.views[0].assembled);
                let vb = &loa.views[1];
                let b = vb.path_coordinate(side, vb.assembled + j as f64 * vb.pitch);
                loa.length - a - b
            };
            let slope = gap(1) - gap(0);
            loa.partner[side_index(side)] = (-gap(0) / slope).round() as i64;
        }
        for l in 0..loa.lines.len() {
            let (side, slice) = (loa.lines[l].side, loa.lines[l].slice);
            let offset = side.sign() * loa.slices[slice].offset;
            let teeth = [0, 1].map(|pair| loa.teeth(side, pair));
            loa.lines[l].map = [0, 1].map(|k| {
                let v = &loa.views[k];
                let s = |tooth: i64, travel: f64| {
                    v.path_coordinate(side, v.assembled + travel + tooth as f64 * v.pitch)
                };
                let (t0, t1) = (teeth[0][k].index, teeth[1][k].index);
                let shift = if k == 0 { offset } else { -offset };
                PathMap {
                    at_zero: s(t0, 0.0) + shift,
                    per_travel: side.sign() * v.path_per_travel(),
                    // One base pitch per pair, up for gear a and down for gear b.
                    per_pair: (s(t1, 0.0) - s(t0, 0.0)).signum() * loa.base_pitch,
                }
            });
        }
        loa
    }

    /// Gap of pair 0 of a flank at the assembled position [m], without modifications.
    pub fn assembled_gap(&self, side: Side) -> f64 {
        let j = self.partner[side_index(side)];
        let a = self.views[0].path_coordinate(side, self.views[0].assembled);
        let vb = &self.views[1];
        self.length - a - vb.path_coordinate(side, vb.assembled + j as f64 * vb.pitch)
    }

    #[inline]
    fn teeth(&self, side: Side, pair: i64) -> [Tooth; 2] {
        let i = if side == Side::Left { pair } else { -pair };
        // Gears turn against each other, a rack goes along.
        let j = if self.views[1].base_radius.is_some() { -i } else { i };
        [
            Tooth { index: i, mesh: self.mesh_of_gear[0] },
            Tooth { index: j + self.partner[side_index(side)], mesh: self.mesh_of_gear[1] },
        ]
    }

    /// Path coordinate of gear a's flank in a pair [m].
    #[inline]
    fn s_a(&self, line: &Line, a: &Party<'_>, pair: i64) -> f64 {
        line.map[0].s(a.gear.tooth_travel(a.at, self.teeth(line.side, pair)[0]), pair)
    }

    /// Where a pair stands: its teeth, path coordinates and gap.
    ///
    /// An elastic displacement along the normal carries the flank along the line of action like a turn of the
    /// tooth: it belongs to the path coordinate, which modifications and stiffness are read at.
    #[inline]
    fn pair(&self, line: &Line, pair: i64, a: &Party<'_>, b: &Party<'_>) -> PairState {
        let teeth = self.teeth(line.side, pair);
        let mut s = [
            line.map[0].s(a.gear.tooth_travel(a.at, teeth[0]), pair),
            line.map[1].s(b.gear.tooth_travel(b.at, teeth[1]), pair),
        ];
        if a.gear.has_displacement() || b.gear.has_displacement() {
            let points = self.points(line, teeth, s);
            s[0] += a.gear.displacement(a.at, &points[0]).dot(&line.normal) / self.helix_cos;
            s[1] -= b.gear.displacement(b.at, &points[1]).dot(&line.normal) / self.helix_cos;
        }
        let mut gap = self.helix_cos * (self.length - s[0] - s[1]);
        let mut scale = [1.0, 1.0];
        let slice = &self.slices[line.slice];
        for k in 0..2 {
            if let Some(deviation) = &slice.deviation[k] {
                let (e, slope) = deviation.eval(s[k]);
                gap += e;
                scale[k] -= slope / self.helix_cos;
            }
        }
        PairState { teeth, s, gap, scale }
    }

    fn points(&self, line: &Line, teeth: [Tooth; 2], s: [f64; 2]) -> [Point; 2] {
        let x = line.origin + s[0] * line.transverse;
        let zeta = self.slices[line.slice].zeta;
        [0, 1].map(|k| {
            let radius = match self.views[k].base_radius {
                Some(rb) => (rb * rb + s[k] * s[k]).sqrt(),
                None => {
                    // The reference line of a rack lies at `length / sin(alpha)` from gear a.
                    let (sin, cos) = self.views[k].working_pressure_angle.sin_cos();
                    let rb = self.views[0].base_radius.unwrap_or(0.0);
                    self.length / sin - (rb * cos + s[0] * sin)
                }
            };
            Point { tooth: teeth[k], locus: Locus::Flank { radius, zeta }, x }
        })
    }

    #[inline]
    fn slot(&self, l: usize, pair: i64) -> usize {
        // 32-bit division is several times cheaper, and no gear turns through 2^31 teeth.
        l * self.pairs + (pair as i32).rem_euclid(self.pairs as i32) as usize
    }

    fn candidate(&self, l: usize, pair: i64, p: &PairState, a: &Party<'_>, b: &Party<'_>) -> Candidate {
        let line = &self.lines[l];
        let weight = self.slices[line.slice].weight;
        let points = self.points(line, p.teeth, p.s);
        let (k, k_s) = self.stiffness.eval(p.s[0]);
        let gap_t = p.scale[1] * b.gear.drift(b.at, &points[1], &line.normal)
            - p.scale[0] * a.gear.drift(a.at, &points[0], &line.normal);
        Candidate {
            slot: self.slot(l, pair),
            points,
            normal: line.normal,
            scale: p.scale,
            gap: p.gap,
            gap_t,
            stiffness: k * weight,
            stiffness_s: k_s * weight / self.helix_cos,
            s: p.s[0],
        }
    }

    /// Pairs that a line looks at: those in memory, or those in the zone now.
    #[inline]
    fn pairs_of(&self, l: usize, a: &Party<'_>, memory: &[f64], listed: bool) -> (i64, i64) {
        let line = &self.lines[l];
        if self.whole_mesh {
            // One spring: the pair nearest to the middle of the path stands for the mesh; all pairs of
            // rigid gears have its gap.
            let middle = 0.5 * (self.zone[0] + self.zone[1]);
            let s0 = self.s_a(line, a, 0);
            let pair = ((middle - s0) / self.base_pitch).round() as i64;
            (pair, pair)
        } else if listed {
            (memory[2 * l] as i64, memory[2 * l + 1] as i64)
        } else {
            self.zone_now(line, a)
        }
    }

    /// First and last pair in the zone at a state.
    fn zone_now(&self, line: &Line, a: &Party<'_>) -> (i64, i64) {
        // The teeth move little against the hub, so the pair nearest to the middle is a safe start.
        let middle = 0.5 * (self.zone[0] + self.zone[1]);
        let s0 = self.s_a(line, a, 0);
        let guess = ((middle - s0) / self.base_pitch).round() as i64;
        let inside = |p: i64| {
            let s = self.s_a(line, a, p);
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

#[inline]
fn side_index(side: Side) -> usize {
    match side {
        Side::Left => 0,
        Side::Right => 1,
    }
}

impl ContactSearch for LinesOfAction {
    fn slots(&self) -> usize {
        self.lines.len() * self.pairs
    }

    fn memory(&self) -> usize {
        2 * self.lines.len()
    }

    fn guard_count(&self) -> usize {
        if self.whole_mesh { 0 } else { ZONE_GUARDS * self.lines.len() }
    }

    fn begin(&self, a: Party<'_>, _b: Party<'_>, memory: &mut [f64]) {
        for (line, m) in self.lines.iter().zip(memory.chunks_exact_mut(2)) {
            let (lo, hi) = self.zone_now(line, &a);
            m[0] = lo as f64;
            m[1] = hi as f64;
        }
    }

    fn candidates(
        &self,
        a: Party<'_>,
        b: Party<'_>,
        memory: &[f64],
        wanted: Wanted<'_>,
        out: &mut Vec<Candidate>,
    ) {
        if let Wanted::Closed(modes) = wanted
            && modes.chunks_exact(2).all(|m| m[0] == 0.0)
        {
            return;
        }
        for l in 0..self.lines.len() {
            if let Wanted::Closed(modes) = wanted
                && modes[2 * l * self.pairs..][..2 * self.pairs].chunks_exact(2).all(|m| m[0] == 0.0)
            {
                continue;
            }
            let line = &self.lines[l];
            let listed = !matches!(wanted, Wanted::Touching(_));
            let (lo, hi) = self.pairs_of(l, &a, memory, listed);
            for pair in lo..=hi {
                if let Wanted::Closed(modes) = wanted
                    && modes[2 * self.slot(l, pair)] == 0.0
                {
                    continue;
                }
                let p = self.pair(line, pair, &a, &b);
                if let Wanted::Touching(reach) = wanted
                    && p.gap > reach
                {
                    continue;
                }
                out.push(self.candidate(l, pair, &p, &a, &b));
            }
        }
    }

    fn gaps(&self, a: Party<'_>, b: Party<'_>, memory: &[f64], out: &mut [f64]) {
        for l in 0..self.lines.len() {
            let line = &self.lines[l];
            let (lo, hi) = self.pairs_of(l, &a, memory, true);
            for pair in lo..=hi {
                let p = self.pair(line, pair, &a, &b);
                out[self.slot(l, pair)] = p.gap;
            }
        }
    }

    fn guards(&self, a: Party<'_>, _b: Party<'_>, memory: &[f64], out: &mut [f64]) {
        if self.whole_mesh {
            return;
        }
        for (l, line) in self.lines.iter().enumerate() {
            let s = |p: f64| self.s_a(line, &a, p as i64);
            let (lo, hi) = (memory[2 * l], memory[2 * l + 1]);
            let scale = 1.0 / self.base_pitch;
            let g = &mut out[ZONE_GUARDS * l..][..ZONE_GUARDS];
            g[0] = (self.zone[1] - s(hi)) * scale;
            g[1] = (s(lo) - self.zone[0]) * scale;
            g[2] = (self.zone[0] - s(lo - 1.0)) * scale;
            g[3] = (s(hi + 1.0) - self.zone[1]) * scale;
        }
    }

    fn switch(&self, guard: usize, memory: &mut [f64]) -> ZoneChange {
        let l = guard / ZONE_GUARDS;
        let slot = |p: f64| l * self.pairs + (p as i64).rem_euclid(self.pairs as i64) as usize;
        let m = &mut memory[2 * l..2 * l + 2];
        let mut change = ZoneChange::default();
        match guard % ZONE_GUARDS {
            0 => {
                change.left = Some(slot(m[1]));
                m[1] -= 1.0;
            }
            1 => {
                change.left = Some(slot(m[0]));
                m[0] += 1.0;
            }
            2 => {
                m[0] -= 1.0;
                change.entered = Some(slot(m[0]));
            }
            _ => {
                m[1] += 1.0;
                change.entered = Some(slot(m[1]));
            }
        }
        change
    }

    fn line(&self, side: Side) -> Option<[Vec3; 2]> {
        let line = self.lines.iter().find(|l| l.side == side)?;
        // A rack has no tangent point: the line is shown as far as the path of contact reaches.
        let end = if self.views[1].base_radius.is_some() { self.length } else { 1.2 * self.zone[1] };
        Some([line.origin, line.origin + end * line.transverse])
    }

    fn flank_of(&self, c: &Candidate) -> ([Tooth; 2], Side) {
        let side = self.lines[c.slot / self.pairs].side;
        ([c.points[0].tooth, c.points[1].tooth], side)
    }
}

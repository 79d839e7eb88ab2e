//! A gear of a mesh in the point search: the shapes of its flanks, and the selection of those that may touch.
//!
//! Teeth are found as in the two-step search of the gear train module: the teeth about the line of centres
//! first, then for each flank the one it faces. A flank stands at the path coordinate `s` of the involute
//! through its outermost node, which is linear in the gear's displacement, so both steps look up sorted lists.

use super::generated;
use super::involute::{deviation_bound, off_involute, outermost, path_at_zero};
use super::projection::MOST_PAST;
use super::rule::Rule;
use super::search_gear::SearchGear;
use super::surface::Shape;
use crate::contact::gear_state::GearState;
use crate::error::Reason;
use crate::geometry::{Flanks, Side, Tips};
use crate::kinematics::{Placement, Pose};
use crate::spec::{Body, SurfaceKind};
use std::f64::consts::TAU;

/// Largest deviation of the nodes of a flank from one involute, relative to the base pitch, for the search by path
/// coordinates.
const OFF_INVOLUTE: f64 = 0.1;

/// Entry of a flank in the sorted list of its side.
#[derive(Clone, Copy, Debug)]
struct Entry {
    /// Path coordinate at zero displacement [m], within one turn for a gear.
    s: f64,
    shape: usize,
    tooth: i64,
}

/// A gear with its flanks, for the point search.
#[derive(Clone, Debug)]
pub(super) struct FlankedGear {
    /// True if the gear model has flanks of its own, whose node positions it computes.
    pub own: bool,
    pub rack: bool,
    pub tips: Tips,
    pub conical: bool,
    pub placement: Placement,
    pub shapes: Vec<Shape>,
    /// Undeformed nodes, for gear models without own flanks.
    pub grids: Flanks,
    pub mesh: u8,
    pub face_width: f64,
    teeth: i64,
    /// Derivative of the path coordinate of left flanks by the displacement.
    per_displacement: f64,
    /// Path coordinate of a whole turn [m]; infinite for a rack.
    turn: f64,
    /// Flanks of both sides, sorted by their path coordinate.
    sorted: [Vec<Entry>; 2],
    /// Largest path coordinate at zero displacement of any surface of either side, within one base pitch; for flanks
    /// that move with the hub alone.
    foremost: Option<[f64; 2]>,
    /// True if the flanks move with the hub alone.
    pub rigid: bool,
    /// True if the flanks follow their involutes closely enough for the search by path coordinates.
    pub involute: bool,
    /// Largest outward deviation of such a flank from its involute, on the path coordinate [m].
    pub deviation_bound: f64,
    /// Base radius [m], negative for an internal gear; `None` for a rack.
    pub base_radius: Option<f64>,
}

/// A flank that may touch.
#[derive(Clone, Copy, Debug)]
pub(super) struct NearbyFlank {
    pub shape: usize,
    /// Tooth number, counted on over turns.
    pub tooth: i64,
    /// Path coordinate of the flank [m].
    pub s: f64,
}

fn side_index(side: Side) -> usize {
    usize::from(side == Side::Right)
}

impl FlankedGear {
    pub fn new(o: SearchGear<'_>, kind: SurfaceKind, rule: &Rule) -> Result<Self, Reason> {
        let (rack, tips) = (matches!(o.body, Body::Rack(_)), o.body.tips());
        let own = o.gear.flanks().is_some();
        let grids = match o.gear.flanks() {
            Some(flanks) => flanks.clone(),
            None => generated::flanks(o.body),
        };
        check(&grids)?;
        let slope = match o.body {
            Body::Gear(g) if g.is_conical() => g.params().tip_cone_angle.tan(),
            _ => 0.0,
        };
        let shapes: Vec<Shape> = (0..grids.grids().len())
            .map(|g| Shape::new(&grids, g, kind, rule, tips).on_cone(slope))
            .collect();
        if let Some(s) = shapes
            .iter()
            .find(|s| !s.heights.is_sorted_by(|a, b| a < b))
        {
            return Err((
                format!(
                    "the nodes of the {:?} flank of tooth {} do not rise from the root to the tip",
                    s.side, s.tooth
                ),
                "order its rows that way",
            )
                .into());
        }
        let teeth = match o.body {
            Body::Gear(g) => i64::from(g.teeth()),
            Body::Rack(r) => i64::from(r.teeth()),
        };
        let turn = match o.view.base_radius {
            Some(rb) => TAU * rb.abs(),
            None => f64::INFINITY,
        };
        let moves_as_one = o.gear.displacement().is_some() || (!own && o.gear.teeth().is_none());
        let pitch = turn / teeth as f64;
        let pitch = if rack {
            o.view.pitch * o.view.working_pressure_angle.cos()
        } else {
            pitch
        };
        // The first flank of a side represents all others, with their largest deviation from its position.
        let mut largest = 0.0_f64;
        let mut foremost: [Option<(f64, f64)>; 2] = [None; 2];
        let mut involute = true;
        let mut sorted = [vec![], vec![]];
        for (shape, g) in grids.grids().iter().enumerate() {
            let outermost = outermost(o.body, &o.view, g);
            let (s, tooth) = path_at_zero(&o, g.side, outermost);
            involute &= off_involute(&o, g) <= OFF_INVOLUTE * pitch;
            if moves_as_one {
                let stands = deviation_bound(&o, &shapes[shape], outermost, MOST_PAST);
                largest = largest.max(stands);
                let s = s + stands;
                let of_side = &mut foremost[side_index(g.side)];
                let (first, ahead) = of_side.get_or_insert((s, 0.0));
                let off = s - *first;
                *ahead = ahead.max(off - pitch * (off / pitch).round());
            }
            sorted[side_index(g.side)].push(Entry {
                s: if rack { s } else { s.rem_euclid(turn) },
                shape,
                tooth,
            });
        }
        for list in &mut sorted {
            list.sort_by(|a, b| a.s.total_cmp(&b.s));
        }
        Ok(FlankedGear {
            own,
            rack,
            tips,
            conical: matches!(o.body, Body::Gear(g) if g.is_conical()),
            placement: Placement::new(o.gear.hub(), o.phase),
            shapes,
            grids,
            mesh: o.mesh,
            face_width: match o.body {
                Body::Gear(g) => g.face_width(),
                Body::Rack(r) => r.face_width(),
            },
            teeth,
            per_displacement: o.view.path_per_displacement(),
            turn,
            sorted,
            rigid: moves_as_one,
            involute,
            deviation_bound: largest,
            base_radius: o.view.base_radius,
            foremost: match foremost {
                [Some(left), Some(right)] if involute => Some([left.0 + left.1, right.0 + right.1]),
                _ => None,
            },
        })
    }

    /// Returns the frame of the gear after a displacement [rad or m] from the assembled position.
    #[inline]
    pub fn pose(&self, gear_state: &GearState<'_>, displacement: f64) -> Pose {
        let at = gear_state.at;
        (self.placement).pose_at(gear_state.gear.hub(), at.t, at.q, displacement)
    }

    /// Returns the largest path coordinate of the flanks of a side at a displacement, modulo the base pitch; `None`
    /// for flanks that do not move with the hub alone.
    #[inline]
    pub fn foremost(&self, side: Side, displacement: f64) -> Option<f64> {
        let at_zero = self.foremost?[side_index(side)];
        Some(at_zero + side.sign() * self.per_displacement * displacement)
    }

    /// Returns the derivative of the path coordinate of left flanks by the displacement; that of right flanks is the
    /// opposite.
    #[inline]
    pub fn per_displacement(&self) -> f64 {
        self.per_displacement
    }

    /// Returns the height of the point of a flank on the path of contact, at the path coordinate `s` [m]; for a gear,
    /// not a rack.
    #[inline]
    pub fn height_on_path(&self, s: f64) -> f64 {
        let rb = self.base_radius.unwrap_or(0.0);
        rb.signum() * (rb * rb + s * s)
    }

    /// Calls `f` for the flanks of a side with a path coordinate from `low` to `high` at a displacement.
    #[inline]
    pub fn each_near(
        &self,
        side: Side,
        displacement: f64,
        [low, high]: [f64; 2],
        mut f: impl FnMut(NearbyFlank),
    ) {
        let list = &self.sorted[side_index(side)];
        let shift = side.sign() * self.per_displacement * displacement;
        if self.rack {
            let first = list.partition_point(|e| e.s + shift < low);
            for e in list[first..].iter().take_while(|e| e.s + shift <= high) {
                f(NearbyFlank {
                    shape: e.shape,
                    tooth: e.tooth,
                    s: e.s + shift,
                });
            }
            return;
        }
        let base = (low - shift).rem_euclid(self.turn);
        let first = list.partition_point(|e| e.s < base);
        for i in 0..list.len() {
            let at = if first + i < list.len() {
                first + i
            } else {
                first + i - list.len()
            };
            let e = &list[at];
            let past = if e.s < base {
                e.s - base + self.turn
            } else {
                e.s - base
            };
            if past > high - low {
                break;
            }
            let s = low + past;
            let turns = ((s - shift - e.s) / self.turn).round() as i64;
            f(NearbyFlank {
                shape: e.shape,
                tooth: e.tooth
                    + (side.sign() * self.per_displacement.signum()) as i64 * self.teeth * turns,
                s,
            });
        }
    }

    /// Calls `f` for all flanks of a side in the order of their path coordinates, those of a gear within half a turn
    /// of `s`.
    pub fn each_about(&self, side: Side, displacement: f64, s: f64, f: impl FnMut(NearbyFlank)) {
        self.each_near(
            side,
            displacement,
            [s - 0.5 * self.turn, s + 0.5 * self.turn],
            f,
        );
    }
}

/// Refuses invalid grids.
fn check(flanks: &Flanks) -> Result<(), Reason> {
    if flanks.grids().is_empty() {
        return Err(("it brings no flank", "give the flanks that may touch").into());
    }
    for g in flanks.grids() {
        let name = format!("the {:?} flank of tooth {}", g.side, g.tooth);
        if g.rows < 2 || g.columns < 2 {
            return Err((
                format!("{name} has {} x {} nodes", g.rows, g.columns),
                "a flank needs at least 2 along the profile and 2 over the width",
            )
                .into());
        }
        let n = g.rows * g.columns;
        if g.nodes.len() != n || g.positions.len() != n {
            return Err((
                format!(
                    "{name} has {} nodes and {} positions",
                    g.nodes.len(),
                    g.positions.len()
                ),
                format!("{} x {} need {n} of each", g.rows, g.columns),
            )
                .into());
        }
        if g.positions.iter().any(|x| !x.iter().all(|x| x.is_finite())) {
            return Err(format!("{name} has a node whose position is no number").into());
        }
    }
    Ok(())
}

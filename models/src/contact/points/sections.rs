//! Flanks of both gears as profiles in the transverse plane, and the positions over the width of their points.

use super::flanked::FlankedGear;
use super::profile::{Profile, Vec2};
use super::projection::RIM;
use super::rule::Rule;
use super::surface::Shape;
use crate::kinematics::Pose;

/// Flanks of both gears as transverse profiles.
#[derive(Clone, Debug)]
pub(super) struct Spur {
    pub(super) profiles: [Vec<Profile>; 2],
    /// Positions over the width of the points of each gear, as slave.
    pub(super) cells: [Vec<Cell>; 2],
    /// Points along the profile of a face with their weights; empty for points at nodes.
    pub(super) along: Vec<(f64, f64)>,
    pub(super) across: usize,
}

/// Position over the width of a line of points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    /// Height along the axis [m].
    pub(super) z: f64,
    /// Column of the face of the slave, position there, and index of the point among those of a face over the width
    /// (for the rule at nodes, column of the node).
    pub(super) column: usize,
    pub(super) b: f64,
    pub(super) index: usize,
    /// Column of the face of the master, and position there.
    pub(super) on: usize,
    pub(super) b_on: f64,
}

/// Rigid transformation in the transverse plane from the frame of one gear to that of another.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlaneTransform {
    pub(super) cos: f64,
    pub(super) sin: f64,
    pub(super) shift: Vec2,
}

impl PlaneTransform {
    /// Returns the transformation between frames with parallel axes and origins at one height.
    pub(super) fn between(from: &Pose, to: &Pose) -> Self {
        let d = from.origin - to.origin;
        let [x, y, _] = &to.axes;
        PlaneTransform {
            cos: from.axes[0].dot(x),
            sin: from.axes[0].dot(y),
            shift: Vec2::new(x.dot(&d), y.dot(&d)),
        }
    }

    /// Composes this transformation after another.
    #[inline]
    pub(super) fn after(&self, first: &PlaneTransform) -> PlaneTransform {
        PlaneTransform {
            cos: self.cos * first.cos - self.sin * first.sin,
            sin: self.sin * first.cos + self.cos * first.sin,
            shift: self.point(&first.shift),
        }
    }

    #[inline]
    pub(super) fn inverse(&self) -> PlaneTransform {
        let s = &self.shift;
        PlaneTransform {
            cos: self.cos,
            sin: -self.sin,
            shift: -Vec2::new(
                self.cos * s.x + self.sin * s.y,
                self.cos * s.y - self.sin * s.x,
            ),
        }
    }

    #[inline]
    pub(super) fn point(&self, x: &Vec2) -> Vec2 {
        Vec2::new(
            self.cos * x.x - self.sin * x.y + self.shift.x,
            self.sin * x.x + self.cos * x.y + self.shift.y,
        )
    }
}

impl Spur {
    /// Returns the profiles of both gears, where their flanks allow it.
    pub fn new(gears: &[FlankedGear; 2], rule: &Rule) -> Option<Self> {
        let profiles = |g: &FlankedGear| -> Option<Vec<Profile>> {
            let first = &g.shapes[0];
            let alike = |s: &Shape| s.z == first.z && s.z.is_sorted_by(|a, b| a < b);
            (g.rigid && g.shapes.iter().all(alike))
                .then(|| g.shapes.iter().map(|s| Profile::new(s, rule, g.tips)))?
                .collect()
        };
        let profiles = [profiles(&gears[0])?, profiles(&gears[1])?];
        let cells = [0, 1].map(|k| cells(&gears[k].shapes[0], &gears[1 - k].shapes[0], rule, RIM));
        Some(Spur {
            profiles,
            cells,
            along: rule.along.clone(),
            across: rule.across.len(),
        })
    }
}

/// Lists the positions over the width at which points of a slave face a master, or are less than `beside` of a face
/// away from it.
pub(super) fn cells(slave: &Shape, master: &Shape, rule: &Rule, beside: f64) -> Vec<Cell> {
    let mut all = Vec::new();
    let mut add = |column: usize, b: f64, index: usize| {
        let z = slave.z[column] + b * (slave.z[column + 1] - slave.z[column]);
        let (on, b_on) = master.column_at(z);
        if (-beside..=1.0 + beside).contains(&b_on) {
            all.push(Cell {
                z,
                column,
                b,
                index,
                on,
                b_on,
            });
        }
    };
    if rule.is_nodes() {
        for c in 0..slave.columns {
            let column = c.min(slave.columns - 2);
            add(column, (c - column) as f64, c);
        }
    } else {
        for column in 0..slave.columns - 1 {
            for (index, &(b, _)) in rule.across.iter().enumerate() {
                add(column, b, index);
            }
        }
    }
    all
}

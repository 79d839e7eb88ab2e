//! Flanks that move with their hubs and whose transverse profile rotates in proportion to the height: helical teeth,
//! and teeth with lead crowning as an approximation.
//!
//! At a height `z` the own frame is that of the section there, turned by the twist (of a rack: moved along by it),
//!
//! ```text
//! x(a, z) = S(z)^-1 p(a),      dx/dz = d:   tau (-y, x) of a gear, (0, sigma) of a rack
//! ```
//!
//! so that one flank relative to the other is, in their sections, the pair of profiles of spur teeth in a pose that
//! depends on `z`. A projection in the section, with the gap `g_t` along the normal `n_t` there, determines the
//! closest point in space up to second order in the gap: with `w = -n_t . d`
//!
//! ```text
//! cos^2 beta = 1/(1 + w^2),   g = g_t cos beta,   z' = z - g_t w cos^2 beta
//! ```
//!
//! Axes that are not quite parallel take a section of the slave to places at different heights `z_m` of the master; each is
//! turned back to the section of the master at its own height,
//!
//! ```text
//! x_m = S_m(z_m) (R x + o)_xy,      z_m = (R x + o)_z
//! ```
//!
//! which is exact: what is of second order in the tilt is the distance alone.
//!
//! (F. L. Litvin, A. Fuentes, *Gear Geometry and Applied Theory*, 2nd ed. 2004, ch. 14, for helicoids). Sections
//! therefore select the points and the start of the search in space; the result is that of the surfaces.

use super::flanked::FlankedGear;
use super::mesh_flanks::MeshFlanks;
use super::patch::Patch;
use super::profile::{NEARLY, Profile, Vec2};
use super::rule::Rule;
use super::sections::{Cell, PlaneTransform, cells};
use super::surface::Shape;
use crate::Vec3;
use crate::geometry::Tips;
use crate::kinematics::Pose;

/// Largest deviation of a flank from its twisted profile, relative to the base pitch, for the search in sections.
const OFF_TWIST: f64 = 0.01;

/// Distance from a flank, as a fraction of a face, up to which the search in space evaluates a point.
pub(super) const BESIDE: f64 = 0.2;

/// Distance from a flank over the width, as a fraction of a face, that axial shifts and tilts may bridge.
const MAY_COME: f64 = 2.0;

/// Largest fraction of a gap, and of displacements, that the section neglects.
const SECOND_ORDER: f64 = 0.02;

/// Flanks of both gears as twisted profiles.
#[derive(Clone, Debug)]
pub(super) struct TwistedFlanks {
    pub profiles: [Vec<Profile>; 2],
    /// Faces of each flank as polynomials.
    pub patches: [Vec<Vec<Patch>>; 2],
    pub twists: [Twist; 2],
    /// Points of the rule on each flank in the gear frame, in the order of their areas.
    pub points: [Vec<Vec<Vec3>>; 2],
    /// Positions over the width of the points of each gear, as slave.
    pub cells: [Vec<TwistedCell>; 2],
    /// Points along the profile of a face with their weights; empty for points at nodes.
    pub along: Vec<(f64, f64)>,
    pub across: usize,
    /// Largest deviation of both flanks from their twisted profiles [m].
    pub off: f64,
    /// True if axes are parallel and the middles of both gears are at one height.
    pub parallel: bool,
}

/// Position over the width of a line of points, with its section transformations.
#[derive(Clone, Copy, Debug)]
pub(super) struct TwistedCell {
    pub cell: Cell,
    /// Transformation from the section of the slave to its frame, and from the frame of the master to its section.
    from_slave: PlaneTransform,
    to_master: PlaneTransform,
}

/// Map from a section of the slave to those of the master.
#[derive(Clone, Copy, Debug)]
pub(super) struct SectionMap {
    /// Transformation for parallel axes; an approximation for others.
    pub turn: PlaneTransform,
    tilted: Option<TiltTerms>,
}

/// Additional terms for tilted axes.
#[derive(Clone, Copy, Debug)]
struct TiltTerms {
    /// Map to the section of the master at the height of the slave's axis, as rows.
    rows: [Vec2; 2],
    shift: Vec2,
    /// Slope of the height over the section.
    slope: Vec2,
    twist: Twist,
}

impl SectionMap {
    #[inline]
    pub fn point(&self, x: &Vec2) -> Vec2 {
        let Some(t) = &self.tilted else {
            return self.turn.point(x);
        };
        let at = t.shift + Vec2::new(t.rows[0].dot(x), t.rows[1].dot(x));
        let e = t.twist.rate * t.slope.dot(x);
        if t.twist.rack {
            return at - Vec2::new(0.0, e);
        }
        // The tangent of the helix times the tilt: small.
        let (sin, cos) = (e - e * e * e / 6.0, 1.0 - 0.5 * e * e);
        Vec2::new(cos * at.x + sin * at.y, cos * at.y - sin * at.x)
    }
}

/// Rotation of the sections of a flank along the axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Twist {
    rack: bool,
    /// Twist rate `tau` [rad/m] of a gear, or slope `sigma` of a rack.
    pub rate: f64,
}

impl Twist {
    /// Computes the twist of the flanks of a gear, from the ends of one flank in the middle of the profile.
    fn of(gear: &FlankedGear) -> Self {
        let shape = &gear.shapes[0];
        let row = shape.rows / 2 * shape.columns;
        let [a, b] = [0, shape.columns - 1].map(|c| shape.positions[row + c]);
        let height = b.z - a.z;
        let rate = if gear.rack {
            (b.y - a.y) / height
        } else {
            (a.x * b.y - a.y * b.x).atan2(a.x * b.x + a.y * b.y) / height
        };
        Twist {
            rack: gear.rack,
            rate,
        }
    }

    /// Returns the transformation from the section at a height to the gear frame.
    fn section(&self, z: f64) -> PlaneTransform {
        let by = self.rate * z;
        let (angle, shift) = if self.rack { (0.0, by) } else { (by, 0.0) };
        PlaneTransform {
            cos: angle.cos(),
            sin: angle.sin(),
            shift: Vec2::new(0.0, shift),
        }
    }

    /// Returns the derivative `d` by the height at a point of a section.
    #[inline]
    pub fn drift(&self, x: &Vec2) -> Vec2 {
        if self.rack {
            Vec2::new(0.0, self.rate)
        } else {
            self.rate * Vec2::new(-x.y, x.x)
        }
    }
}

impl TwistedFlanks {
    /// Returns the twisted profiles of both gears, where their flanks allow it.
    pub fn new(
        gears: &[FlankedGear; 2],
        rule: &Rule,
        base_pitch: f64,
        parallel: bool,
    ) -> Option<Self> {
        let rising = |s: &Shape| s.z.is_sorted_by(|a, b| a < b);
        let may_be = |g: &FlankedGear| g.rigid && !g.conical && g.shapes.iter().all(rising);
        if !gears.iter().all(may_be) {
            return None;
        }
        let twists = [0, 1].map(|k| Twist::of(&gears[k]));
        let mut off = 0.0;
        let profiles = [0, 1].map(|k| {
            let of_shape = |shape: &Shape| {
                let (profile, own) = twisted(shape, &twists[k], rule, gears[k].tips);
                (profile, own)
            };
            let (profiles, offs): (Vec<_>, Vec<f64>) = gears[k].shapes.iter().map(of_shape).unzip();
            off += offs.into_iter().fold(0.0, f64::max);
            profiles
        });
        // Written so that NaN also counts as apart.
        if off.is_nan() || off > OFF_TWIST * base_pitch {
            return None;
        }
        let of = |k: usize| -> Vec<TwistedCell> {
            let beside = if parallel { BESIDE } else { MAY_COME };
            let all = cells(&gears[k].shapes[0], &gears[1 - k].shapes[0], rule, beside);
            let with_turns = all.into_iter().map(|cell| TwistedCell {
                cell,
                from_slave: twists[k].section(cell.z),
                to_master: twists[1 - k].section(cell.z).inverse(),
            });
            with_turns.collect()
        };
        // Columns of all flanks of a gear have the same heights.
        let alike = |g: &FlankedGear| g.shapes.iter().all(|s| s.z == g.shapes[0].z);
        let patches =
            [0, 1].map(|k| -> Vec<Vec<Patch>> { gears[k].shapes.iter().map(Patch::all).collect() });
        let points = [0, 1].map(|k| {
            let flanks = gears[k].shapes.iter().zip(&patches[k]);
            flanks
                .map(|(shape, patches)| points(shape, patches, rule))
                .collect()
        });
        gears.iter().all(alike).then(|| TwistedFlanks {
            profiles,
            patches,
            points,
            twists,
            cells: [of(0), of(1)],
            along: rule.along.clone(),
            across: rule.across.len(),
            off,
            parallel,
        })
    }

    /// Returns the frame of the slave `k` in that of the master.
    pub fn relative_frame(&self, slave: &Pose, master: &Pose) -> Pose {
        if !self.parallel {
            return slave.seen_from(master);
        }
        let turn = PlaneTransform::between(slave, master);
        Pose {
            axes: [
                Vec3::new(turn.cos, turn.sin, 0.0),
                Vec3::new(-turn.sin, turn.cos, 0.0),
                Vec3::z(),
            ],
            origin: Vec3::new(turn.shift.x, turn.shift.y, 0.0),
        }
    }

    /// Computes the maps from the section of the slave `k` at each of its cells to those of the master; `relative_frame` is the
    /// frame of the slave in that of the master.
    pub fn maps(&self, k: usize, relative_frame: &Pose, out: &mut Vec<SectionMap>) {
        out.clear();
        let [x, y, z] = &relative_frame.axes;
        let turn = PlaneTransform {
            cos: x.x,
            sin: x.y,
            shift: relative_frame.origin.xy(),
        };
        let twist = self.twists[1 - k];
        out.extend(self.cells[k].iter().map(|c| {
            if self.parallel {
                return SectionMap {
                    turn: c.to_master.after(&turn.after(&c.from_slave)),
                    tilted: None,
                };
            }
            // x' = x R S p + R (S_0 + z e_z) + o, in the frame of the master.
            let from = &c.from_slave;
            let first = from.cos * x + from.sin * y;
            let second = from.cos * y - from.sin * x;
            let origin = relative_frame.origin + from.shift.x * x + from.shift.y * y + c.cell.z * z;
            let slope = Vec2::new(first.z, second.z);
            let to = twist.section(origin.z).inverse();
            let turned =
                |v: &Vec3| Vec2::new(to.cos * v.x - to.sin * v.y, to.sin * v.x + to.cos * v.y);
            let (a, b) = (turned(&first), turned(&second));
            let shift = to.point(&origin.xy());
            let length = a.norm();
            SectionMap {
                turn: PlaneTransform {
                    cos: a.x / length,
                    sin: a.y / length,
                    shift,
                },
                tilted: Some(TiltTerms {
                    rows: [Vec2::new(a.x, b.x), Vec2::new(a.y, b.y)],
                    shift,
                    slope,
                    twist,
                }),
            }
        }));
    }

    /// Returns the change of the path coordinate of a left flank of the first gear from the middle to a height [m].
    #[inline]
    pub fn path_by_height(&self, of: &MeshFlanks, z: f64) -> f64 {
        of.gears[0].base_radius.unwrap_or(0.0) * self.twists[0].rate * z
    }

    /// Returns the position of smallest gap on the profile of the slave `k`, in a section where the flank of the first
    /// gear has the path coordinate `s` [m]: where the line of action crosses it, or, outside a flank, the end of that
    /// flank. `turn` maps to the section of the master.
    pub fn facing(
        [first, second]: [&Profile; 2],
        k: usize,
        (of, s): (&MeshFlanks, f64),
        turn: &PlaneTransform,
    ) -> Vec2 {
        let back = turn.inverse();
        let [to_second, to_first] = if k == 0 { [turn, &back] } else { [&back, turn] };
        let s = match of.gears[0].tips {
            Tips::Inwards => s.min(0.0),
            _ => s.max(0.0),
        };
        let x = first.at_height(of.gears[0].height_on_path(s));
        let height = second.height(&to_second.point(&x));
        if k == 1 {
            return second.at_height(height);
        }
        if second.reaches(height) {
            return x;
        }
        let y = second.at_height(height);
        first.at_height(first.height(&to_first.point(&y)))
    }

    /// Returns the height over the middle of the master of a point in a section of the slave.
    pub fn height(relative_frame: &Pose, cell: &TwistedCell, x: &Vec2) -> f64 {
        let own = cell.from_slave.point(x);
        relative_frame
            .point(&Vec3::new(own.x, own.y, cell.cell.z))
            .z
    }

    /// Returns a bound of the error of sections for a gap [m] and displacements [m].
    #[inline]
    pub fn doubt(&self, gap: f64, displacements: f64) -> f64 {
        self.off + SECOND_ORDER * (gap.abs() + displacements)
    }
}

/// Returns the points of the rule on a flank in the gear frame, in the order of their areas.
fn points(shape: &Shape, patches: &[Patch], rule: &Rule) -> Vec<Vec3> {
    let mut all = Vec::with_capacity(shape.areas.len());
    shape.points(
        rule,
        |_, _| true,
        |p| {
            all.push(patches[p.row * (shape.columns - 1) + p.column].position(p.a, p.b));
        },
    );
    all
}

/// Returns the profile of a shape in the section at height zero, and the deviation of the shape from the twisted
/// profile [m].
fn twisted(shape: &Shape, twist: &Twist, rule: &Rule, tips: Tips) -> (Profile, f64) {
    let untwisted = |row: usize, column: usize, place: [f64; 2]| {
        let x: Vec3 = shape.undeformed(row, column, place);
        twist.section(x.z).inverse().point(&x.xy())
    };
    let column = (shape.columns - 1) / 2;
    let profile = Profile::of(shape, rule, tips, |row, a| untwisted(row, column, [a, 0.0]));
    let mut off = 0.0_f64;
    for row in 0..shape.rows - 1 {
        for column in 0..shape.columns - 1 {
            for a in [0.0, 0.5, 1.0] {
                for b in [0.0, 0.5, 1.0] {
                    let x = untwisted(row, column, [a, b]);
                    off = off.max((x - profile.place(row, a)).norm());
                }
            }
        }
    }
    // Bound of the deviation that projections within a section neglect.
    let longest = shape.lengths.iter().fold(0.0_f64, |l, x| l.max(*x));
    (profile, off + NEARLY.powi(3) * longest)
}

//! Contact of elastic gears along lines of their flanks: one pressure line per tooth pair and strip of the width.
//!
//! The [lines of action](LinesOfAction) determine where the flanks touch, with the exact separation of involutes
//! beyond the path and of modified flanks. The [lines](crate::gear::elastic::lines) of the meshes around that position
//! determine the deflection of the teeth. The gap before residual compliance is
//!
//! ```text
//! g = g_rigid(theta_1, theta_2) - w_1 . a_1 - w_2 . a_2
//! ```
//!
//! with the outward displacements `a` of four lines of each flank and their weights `w`, which depend on the path
//! coordinate `s_k` of the own flank alone. The force follows the law of [half-spaces](crate::law::HalfSpace), whose
//! `F_0` depends on both places. All derives from one potential, so that a gear is turned by
//!
//! ```text
//! N (dg_rigid/dtheta_k - ds_k/dtheta_k w_k' . a_k) - dV/dF_0 dF_0/ds_k ds_k/dtheta_k
//! ```
//!
//! with the slope of `a_k` by `theta_k` as well for gears with explicit node positions
//! ([`DeformedLines`](crate::gear::DeformedLines)).
//!
//! Hubs that move in further directions change the gap and both path coordinates by their relative motion, the velocity
//! `v` of gear b relative to gear a at the contact point and the angular velocity `w`: `dg = n . v`, `ds_k = f_k . v + m_k .
//! w`, exact for parallel axes and as nearest points in space. So the line exerts one wrench on gear b and its
//! opposite on gear a,
//!
//! ```text
//! N n - sum_k (N w_k' . a_k + dV/dF_0 dF_0/ds_k) (f_k, m_k)
//! ```
//!
//! whatever the directions of the hubs. Strips of both flanks stay partners: a displacement along the axis shifts them by
//! less than a strip. The facets of a mesh have no effect: geometry under load is that
//! of the exact flank. The motion of the contact along the profile by the tilt of a flank, `R` times the tilt, is
//! neglected: 1 % of the approach where teeth are loaded to 800 N/mm. A tip edge counts as the end of the flank, with
//! its curvature there.

use super::lines::{Line, LinesOfAction, MeshedGears, PairState, side_index};
use super::spatial::NearestPoints;
use crate::Vec3;
use crate::contact::nodal::{
    GapBound, GearNodes, LineMotion, LineTerms, NodalGearState, NodalPoint, NodalPoints,
    RelativeMotion, UNUSED, weighted,
};
use crate::error::Reason;
use crate::gear::elastic::lines::spread;
use crate::geometry::Flanks;
use crate::kinematics::{PointWrench, Tooth};
use crate::spec::Body;
use std::f64::consts::{LN_2, PI};
use std::sync::Arc;

/// Smallest radius of curvature relative to the base pitch: near the base circle that of an involute vanishes. The
/// radii of concave flanks, on internal gears, are negative.
const SHARPEST: f64 = 0.05;

/// Lines of both flanks of a mesh with at least one elastic gear.
#[derive(Clone, Debug)]
pub struct FlankLines {
    pairs: LinesOfAction,
    /// Lines of the elastic gears; `None` for a rigid gear.
    gears: [Option<LineGear>; 2],
    /// `A_1 + A_2` [m^2/N].
    compliance: f64,
    /// Width of the contact along the teeth, all strips [m].
    width: f64,
}

/// Flanks of a gear as lines.
#[derive(Clone, Debug)]
pub struct LineGear {
    /// `2 (1 - nu^2)/(pi E)` [m^2/N].
    compliance: f64,
    teeth: i64,
    /// Index of the first tooth of a rack.
    first: Option<i64>,
    /// Index of the flank of each tooth, left and right.
    of_tooth: Vec<[Option<u32>; 2]>,
    flanks: Vec<LineFlank>,
    near_field: Arc<Vec<Vec<f64>>>,
    strips: usize,
}

#[derive(Clone, Debug)]
struct LineFlank {
    /// Heights of the lines as [`Tips`](crate::geometry::Tips) measures them, ascending.
    heights: Vec<f64>,
    /// Numbers of the nodes, line by line, strip by strip.
    nodes: Vec<u32>,
}

/// Position of a contact on a flank, with its derivatives by its place: the displacement of the gear, or the path
/// coordinate.
struct FlankPosition {
    lines: [u32; 4],
    weights: [f64; 4],
    slopes: [f64; 4],
    /// Logarithm of the width over which the mesh distributes the load, and its slope.
    ln_spread: (f64, f64),
}

impl LineGear {
    /// Builds the lines of a gear [reduced to lines](crate::gear::elastic::reduced::Reduced::over_lines), of a
    /// material with `2 (1 - nu^2)/(pi E)` [m^2/N].
    pub fn new(
        flanks: &Flanks,
        near_field: Arc<Vec<Vec<f64>>>,
        body: &Body,
        compliance: f64,
    ) -> Result<Self, Reason> {
        let (tips, teeth) = (body.tips(), body.teeth() as usize);
        let first = match body {
            Body::Gear(_) => None,
            Body::Rack(rack) => Some(rack.first_tooth()),
        };
        let mut of_tooth = vec![[None; 2]; teeth];
        let mut lines = Vec::new();
        let mut strips = 0;
        for (i, grid) in flanks.grids().iter().enumerate() {
            let heights: Vec<f64> = (grid.positions.iter().step_by(grid.columns))
                .map(|x| tips.height([x.x, x.y]))
                .collect();
            if !heights.is_sorted_by(|a, b| a < b) {
                return Err((
                    format!(
                        "the nodes of the {:?} flank of tooth {} do not rise from the root to the tip",
                        grid.side, grid.tooth
                    ),
                    "order its rows that way",
                )
                    .into());
            }
            strips = grid.columns;
            if let Some(of_tooth) = of_tooth.get_mut(grid.tooth as usize) {
                of_tooth[side_index(grid.side)] = Some(i as u32);
            }
            lines.push(LineFlank {
                heights,
                nodes: grid.nodes.clone(),
            });
        }
        Ok(LineGear {
            compliance,
            teeth: teeth as i64,
            first,
            of_tooth,
            flanks: lines,
            near_field,
            strips,
        })
    }

    /// Returns the number of strips over the width.
    pub fn strips(&self) -> usize {
        self.strips
    }

    /// Returns the flank of a tooth, if it is meshed; meshes number the teeth of a rack as if it were closed.
    fn flank(&self, tooth: Tooth, side: usize) -> Option<usize> {
        let beyond = |first: i64| !(first..first + self.teeth).contains(&tooth.index);
        if self.first.is_some_and(beyond) {
            return None;
        }
        let tooth = tooth.index.rem_euclid(self.teeth) as usize;
        self.of_tooth.get(tooth)?[side].map(|f| f as usize)
    }

    /// Returns the position of a height on a flank, with the slope of the height by the place.
    #[inline]
    fn place(&self, flank: usize, strip: usize, (height, slope): (f64, f64)) -> FlankPosition {
        let f = &self.flanks[flank];
        let lines = f.heights.len();
        let element = (f.heights.partition_point(|h| *h <= height)).clamp(1, lines - 1) - 1;
        let per = (f.heights[element + 1] - f.heights[element]).recip();
        let x = (height - f.heights[element]) * per;
        // Beyond the ends of the flank the load stays at its end.
        let (x, moves) = if (0.0..=1.0).contains(&x) {
            (x, per * slope)
        } else {
            (x.clamp(0.0, 1.0), 0.0)
        };
        let spread = spread(element, x, lines);
        let field = &self.near_field[flank];
        let (mut p, mut by_place) = (0.0, 0.0);
        for i in 0..4 {
            let row = &field[(spread.first + i) * lines + spread.first..][..4];
            let of_row = weighted(&spread.weights, &[row[0], row[1], row[2], row[3]]);
            p += spread.weights[i] * of_row;
            by_place += spread.slopes[i] * of_row;
        }
        FlankPosition {
            lines: std::array::from_fn(|i| f.nodes[(spread.first + i) * self.strips + strip]),
            weights: spread.weights,
            slopes: spread.slopes.map(|x| x * moves),
            ln_spread: (LN_2 + 0.5 - p, -2.0 * by_place * moves),
        }
    }
}

/// Hertzian pressure on a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinePressure {
    /// Half-width of the contact strip [m].
    pub half_width: f64,
    /// Maximum pressure [Pa].
    pub peak: f64,
}

impl FlankLines {
    /// Returns the pressure under a normal force [N] on a share of the width, with the relative radius of curvature
    /// [m]: `b^2 = 2 R A q`, `p_0 = 2 q/(pi b)`.
    pub fn pressure(&self, radius: f64, share: f64, force: f64) -> LinePressure {
        let per_width = force / (share * self.width);
        let half_width = (2.0 * radius * self.compliance * per_width).sqrt();
        LinePressure {
            half_width,
            peak: 2.0 * per_width / (PI * half_width),
        }
    }

    /// Builds the search from lines of action with one slice for each strip.
    pub fn new(pairs: LinesOfAction, gears: [Option<LineGear>; 2], face_width: f64) -> Self {
        let compliance = gears.iter().flatten().map(|g| g.compliance).sum();
        FlankLines {
            width: face_width / pairs.helix_cos,
            pairs,
            gears,
            compliance,
        }
    }

    /// Returns the lines of action.
    pub fn pairs(&self) -> &LinesOfAction {
        &self.pairs
    }

    /// Returns the sum of both material compliances, `A_1 + A_2` [m^2/N].
    pub fn compliance(&self) -> f64 {
        self.compliance
    }

    /// Returns the width of the contact along the teeth [m].
    pub fn width(&self) -> f64 {
        self.width
    }

    /// Appends the lines with a gap within the bound before residual compliance, and registers their nodes.
    pub fn nodal_points(
        &self,
        mut sides: [NodalGearState<'_>; 2],
        gap_bound: &mut GapBound,
        out: &mut NodalPoints,
    ) {
        let deformed = sides
            .iter()
            .any(|s| s.gear_state.gear.deformed_lines().is_some());
        let limit = if deformed {
            f64::INFINITY
        } else {
            sides[0].bound() + sides[1].bound()
        };
        let gears = &MeshedGears::for_lines(&sides[0].gear_state, &sides[1].gear_state);
        for (l, line) in self.pairs.lines.iter().enumerate() {
            if self.pairs.clearly_open(line, gears, limit) {
                continue;
            }
            let range = self.pairs.pairs_of(l, gears, &[], false);
            self.pairs.each_pair(l, range, gears, |_, pair, s| {
                let p = self.pairs.pair(line, gears, pair, s);
                if p.gap <= limit {
                    self.line_point(line, &p, (gears, &mut sides), gap_bound, out);
                }
            });
        }
    }

    /// Appends the line of a pair, and registers its nodes.
    fn line_point(
        &self,
        line: &Line,
        p: &PairState,
        (gears, sides): (&MeshedGears<'_>, &mut [NodalGearState<'_>; 2]),
        gap_bound: &mut GapBound,
        out: &mut NodalPoints,
    ) {
        let mesh = &self.pairs.mesh;
        let helix = self.pairs.helix_cos;
        let side = side_index(line.side);
        // Places on the flanks are displacements of the gears, or path coordinates.
        let per_place = match p.touch {
            None => [0, 1].map(|k| line.map[k].per_displacement),
            Some(_) => [1.0; 2],
        };
        let mut radii = [0, 1].map(|k| -helix * p.scale[k] * per_place[k]);
        let mut relative = p.touch.as_ref().map(relative_motion);
        let mut terms = LineTerms::default();
        let (mut slots, mut weights) = ([[UNUSED; 4]; 2], [[0.0; 4]; 2]);
        let mut gap0 = p.gap;
        let mut ln_spread = 0.0;
        // Curvatures of both flanks, and their slopes by the displacements.
        let mut curvature = [0.0; 2];
        let mut bends = [0.0; 2];
        for k in 0..2 {
            let (moves, s) = (per_place[k], p.s[k]);
            let height = match mesh.views[k].base_radius {
                Some(rb) => {
                    let least = SHARPEST * mesh.base_pitch;
                    let rho = match rb > 0.0 {
                        true => s.clamp(least, line.tips[k].max(least)),
                        false => s.min(line.tips[k].min(-least)),
                    };
                    curvature[k] = helix / rho;
                    if rho == s {
                        bends[k] = -helix / (rho * rho) * moves;
                    }
                    let sign = rb.signum();
                    (sign * (rb * rb + s * s), sign * 2.0 * s * moves)
                }
                None => {
                    let of_a = mesh.length - s;
                    let up = mesh.views[k].working_pressure_angle.sin();
                    (self.pairs.height_on_rack(k, of_a), up * moves)
                }
            };
            let Some(gear) = &self.gears[k] else { continue };
            let NodalGearState {
                gear_state,
                field,
                nodes,
            } = &mut sides[k];
            let Some(flank) = gear.flank(p.teeth[k], side) else {
                return;
            };
            let place = gear.place(flank, line.slice, height);
            weights[k] = place.weights;
            if let Some(field) = *field {
                slots[k] = nodes.meet(field, gear_state.at, &place.lines);
                gap0 -= weighted(&weights[k], &GearNodes::at(&nodes.displacement, &slots[k]));
                terms.slopes[k] = place.slopes;
            } else if let Some(lines) = gear_state.gear.deformed_lines() {
                let at = gear_state.at;
                let outward = place.lines.map(|line| lines.outward(at, line));
                let a = outward.map(|x| x.0);
                gap0 -= weighted(&weights[k], &a);
                let moved = weighted(&place.slopes, &a);
                let hub = &gear_state.gear.hub().hub;
                let mut of_nodes = PointWrench {
                    point: gears.of[k].frame().0.origin,
                    ..PointWrench::default()
                };
                for (w, (_, by_hub)) in weights[k].iter().zip(&outward) {
                    of_nodes.add(*w, by_hub);
                }
                let own = hub.own_component(hub.hub_pose(at.t, at.q).as_ref(), &of_nodes);
                radii[k] -= moved + own;
                terms.with_nodes[k] = own;
                if let Some(relative) = &mut relative {
                    relative.gap.add(-moved, &relative.paths[k]);
                    relative.of_nodes[k].add(-1.0, &of_nodes);
                }
                terms.deformed[k] = Some(place.lines);
            }
            let share = 2.0 * gear.compliance / self.compliance;
            ln_spread += share * place.ln_spread.0;
            terms.ln_force[k] += share * place.ln_spread.1;
        }
        // Few as they are, all are listed: the residual displacements under a deeper line that is yet to come may close a
        // gap.
        gap_bound.takes(gap0);
        let total: f64 = curvature.iter().sum();
        terms.radius = total.recip();
        for k in 0..2 {
            // -d ln R
            terms.ln_force[k] += bends[k] / total;
        }
        let weight = self.pairs.slices[line.slice].weight;
        let ln_force = ln_spread - (2.0 * self.compliance * terms.radius).ln();
        let (x, normal) = match &p.touch {
            None => (
                line.origin + self.pairs.middle(p.s) * line.transverse,
                line.normal,
            ),
            Some(touch) => (touch.x, touch.normal),
        };
        terms.motion = match relative {
            None => LineMotion::OwnDirections(radii),
            Some(relative) => {
                out.motions.push(relative);
                LineMotion::Relative(out.motions.len() as u32 - 1)
            }
        };
        out.lines.push(terms);
        out.points.push(NodalPoint {
            mesh: 0,
            slot: side as u8,
            slave: 1,
            partner: None,
            line: Some(out.lines.len() as u32 - 1),
            teeth: p.teeth,
            x,
            normal,
            sensitivity: [Vec3::zeros(); 2],
            place: [0.0; 2],
            slots,
            weights,
            gap0,
            stiffness: weight * self.width * ln_force.exp(),
            share: weight,
            taper_gradient: Vec3::zeros(),
        });
    }
}

/// Returns the derivatives of gap and path coordinates by the motion of gear b relative to gear a, about the contact point.
fn relative_motion(touch: &NearestPoints) -> RelativeMotion {
    let here = PointWrench {
        point: touch.x,
        ..PointWrench::default()
    };
    RelativeMotion {
        gap: PointWrench {
            force: touch.normal,
            ..here
        },
        paths: touch.rolls.map(|roll| {
            let mut path = here;
            path.add(1.0, &roll);
            path
        }),
        of_nodes: [here; 2],
    }
}

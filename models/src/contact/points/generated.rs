//! Generated flanks for gear models without own flanks: fine grids on the involute (or the straight rack flank) that
//! move rigidly with their tooth.
//!
//! ```text
//! x = r (cos, sin)(theta_k +- half angle(r) + z tan(beta_b) / r_b),    r^2 = r_b^2 + s^2
//! ```
//!
//! at equal steps of the length of roll `s` from the form circle to the tip, moved into the material by the
//! flank's modification and by the deviations of each tooth; on conical gears from the form circle to the tip of each
//! section, on the helicoids of [`InvoluteHelicoid`](crate::geometry::InvoluteHelicoid).

use crate::Vec3;
use crate::geometry::{FlankGrid, Flanks, Gear, Rack, Side};
use crate::spec::Body;

/// Number of nodes along the profile: the error of the spline is far below a nanometre.
const ROWS: usize = 49;
/// Number of nodes over the width where the flank varies over it.
const COLUMNS: usize = 17;
/// Largest number of nodes over the width.
const MOST_COLUMNS: usize = 129;

/// Returns the grids of all flanks of a body.
pub(super) fn flanks(body: &Body) -> Flanks {
    match body {
        Body::Gear(g) => {
            let mut flanks = Flanks::new(gear(g));
            flanks.deviate(g);
            flanks
        }
        Body::Rack(r) => Flanks::new(rack(r)),
    }
}

fn grid(
    tooth: u32,
    side: Side,
    first_node: u32,
    [rows, columns]: [usize; 2],
    point: impl Fn(f64, f64) -> Vec3,
) -> FlankGrid {
    let unit = |i: usize, n: usize| i as f64 / (n - 1) as f64;
    FlankGrid {
        tooth,
        side,
        rows,
        columns,
        nodes: (first_node..).take(rows * columns).collect(),
        positions: (0..rows * columns)
            .map(|i| {
                point(
                    unit(i / columns, rows),
                    2.0 * unit(i % columns, columns) - 1.0,
                )
            })
            .collect(),
    }
}

/// Returns the number of nodes over the width: at least that of a measured flank, and four over each end relief.
fn columns(g: &Gear) -> usize {
    let m = &g.params().modifications;
    let measured = m.topography.iter().flatten().map(|t| t.size()[1]);
    let reliefs = m.end_relief.iter().flatten();
    let reliefs = reliefs.map(|r| (4.0 * g.face_width() / r.length).ceil() as usize + 1);
    measured
        .chain(reliefs)
        .fold(COLUMNS, usize::max)
        .min(MOST_COLUMNS)
}

fn gear(g: &Gear) -> Vec<FlankGrid> {
    let size = [ROWS, if g.varies_over_width() { columns(g) } else { 2 }];
    let rb = g.r_base();
    let (low, high) = (g.roll_length_form(), g.roll_length_tip());
    let twist = g.base_helix_angle().tan() / rb;
    let mut all = Vec::new();
    if g.is_conical() {
        return conical(g, size);
    }
    for tooth in 0..g.teeth() {
        for relative_frame in Side::BOTH {
            let side = g.side_from_root(relative_frame);
            let first = (all.len() * size[0] * size[1]) as u32;
            all.push(grid(tooth, relative_frame, first, size, |t, zeta| {
                let z = 0.5 * g.face_width() * zeta;
                let s = low + t * (high - low);
                let r = rb.hypot(s);
                let centre = f64::from(tooth) * g.pitch_angle() + z * twist;
                let angle = centre + side.sign() * g.half_angle_at(r);
                // The normal touches the base circle, an angle atan(s / r_b) behind the point.
                let normal = angle - side.sign() * (s / rb).atan();
                let removed = g.flank_deviation(side, r, zeta) / g.base_helix_angle().cos();
                let (sin, cos) = normal.sin_cos();
                let out = side.sign() * Vec3::new(-sin, cos, 0.0);
                Vec3::new(r * angle.cos(), r * angle.sin(), z) - removed * out
            }));
        }
    }
    all
}

/// Returns the grids of a conical gear: from the form circle of each section to the tip cone, on the helicoid of each
/// side.
fn conical(g: &Gear, size: [usize; 2]) -> Vec<FlankGrid> {
    let end = 0.5 * g.face_width();
    let height = |zeta: f64| end * zeta;
    let heights = (0..size[1]).map(|c| height(2.0 * c as f64 / (size[1] - 1) as f64 - 1.0));
    // Sections within the ends of the face can be cut where those at the ends can.
    let lows: Vec<f64> = heights
        .map(|z| (g.transverse_section(z)).map_or(g.r_form(), |section| section.r_form()))
        .collect();
    let mut all = Vec::new();
    for tooth in 0..g.teeth() {
        let psi = f64::from(tooth) * g.pitch_angle();
        for side in Side::BOTH {
            let flank = g.flank(side);
            let base = flank.base_radius;
            let first = (all.len() * size[0] * size[1]) as u32;
            all.push(grid(tooth, side, first, size, |t, zeta| {
                let z = height(zeta);
                let column = (0.5 * (zeta + 1.0) * (size[1] - 1) as f64).round() as usize;
                let low = ((lows[column] - base) * (lows[column] + base))
                    .max(0.0)
                    .sqrt();
                let high = g.roll_length_tip_at(side, z);
                let roll = low + t * (high - low);
                let radius = flank.base(psi, roll, z);
                let x = flank.point(&radius, roll, z);
                let removed = g.flank_deviation_at(side, base.hypot(roll), z) / flank.cos_helix;
                let out = side.sign() * Vec3::new(-radius.sin, radius.cos, 0.0);
                x - removed * out
            }));
        }
    }
    all
}

fn rack(rack: &Rack) -> Vec<FlankGrid> {
    let helix = rack.params().helix_angle;
    // A rack's flank is plane.
    let size = [ROWS, 2];
    let (low, high) = (-rack.form_depth(), rack.tip_height());
    let mut all = Vec::new();
    for tooth in 0..rack.teeth() {
        let centre = (rack.first_tooth() + i64::from(tooth)) as f64 * rack.pitch();
        for side in Side::BOTH {
            let first = (all.len() * size[0] * size[1]) as u32;
            all.push(grid(tooth, side, first, size, |t, zeta| {
                let z = 0.5 * rack.face_width() * zeta;
                let h = low + t * (high - low);
                let y = centre - z * helix.tan() - side.sign() * rack.half_thickness_at(h);
                Vec3::new(-h, y, z)
            }));
        }
    }
    all
}

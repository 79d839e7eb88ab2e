//! Relative position of the bodies of a mesh, independent of their models: centre distance, path of contact,
//! stiffness.

use super::mount::turned_to;
use super::scene::{Body, ContactSpec, GearSpec, MeshSpec};
use crate::Vec3;
use crate::error::{BuildError, MeshPart, Reason};
use crate::geometry::{ConicalPair, Frame, GeometryError, Mate, Pair};
use crate::stiffness::{self, StiffnessCurve};

/// Quantities of a pair that do not depend on the model.
#[derive(Clone, Debug)]
pub struct MeshLayout {
    /// Direction from the first gear to the pitch point [rad]: to the second gear, or away from an internal one.
    pub direction: f64,
    /// Direction from each gear to the pitch point in its own axes [rad]; unused for a rack.
    pub towards: [f64; 2],
    /// Centre distance, or distance to the rack's reference line [m].
    pub distance: f64,
    /// Transverse working pressure angle [rad].
    pub working_pressure_angle: f64,
    /// Length of the line of action between the tangent points [m]; negative in an internal gear.
    pub length: f64,
    /// Path of contact on the first gear's path coordinate [m].
    pub path: [f64; 2],
    /// Path coordinate of the pitch point [m].
    pub pitch_point: f64,
    /// Transverse base pitch [m].
    pub base_pitch: f64,
    /// Transverse contact ratio.
    pub contact_ratio: f64,
    /// Backlash along the line of action [m].
    pub backlash: f64,
    /// Common face width [m].
    pub face_width: f64,
    /// Position of the middle of the common face width along the axis, from the middle of the face width of each gear
    /// [m].
    pub heights: [f64; 2],
    /// The pair in its transverse plane; for conical gears the equivalent cylindrical one.
    pub pair: Pair,
    /// The pair of conical gears at their positions.
    pub conical: Option<Box<ConicalPair>>,
    /// Offset of a rack's reference point along its motion, from the first gear [m].
    pub(crate) rack_offset: f64,
}

impl<'a> From<&'a Body> for Mate<'a> {
    fn from(body: &'a Body) -> Self {
        match body {
            Body::Gear(gear) => Mate::Gear(gear),
            Body::Rack(rack) => Mate::Rack(rack),
        }
    }
}

/// Returns the transverse base radius [m] of a gear, or `cos(alpha_t)` of a rack: path coordinate per hub coordinate.
/// Mesh frequencies, transmission errors and torques over base radii refer to the transverse plane.
pub fn base_radius(body: &Body) -> f64 {
    match body {
        Body::Gear(g) => g.r_base(),
        Body::Rack(r) => r.transverse_pressure_angle().cos(),
    }
}

/// Returns the transverse base radius with the sign by which the path coordinate of a left flank grows with the hub
/// coordinate: negative for racks and internal gears.
pub fn signed_base_radius(body: &Body) -> f64 {
    let sign = match body {
        Body::Gear(g) => g.sign(),
        Body::Rack(_) => -1.0,
    };
    sign * base_radius(body)
}

/// Returns the approach along the normal of the flanks per hub coordinate [m], [`base_radius`] times the cosine of the
/// base helix angle. Gaps, contact forces and effective masses refer to the normal.
pub fn effective_radius(body: &Body) -> f64 {
    base_radius(body) * body.base_helix_angle().cos()
}

/// Returns [`effective_radius`] with the sign of [`signed_base_radius`].
pub fn signed_effective_radius(body: &Body) -> f64 {
    signed_base_radius(body) * body.base_helix_angle().cos()
}

/// Returns the transmission error of a mesh as a function of the displacements of its gears [m], in the transverse
/// plane and zero where the loaded flanks of rigid gears first touch:
///
/// ```text
/// e = +-(r_b1 theta_1 + r_b2 theta_2) - gap / cos(beta_b)
/// ```
///
/// with the sign of the flank of the mesh's start. The gap at the start is along the normal of the flanks.
pub fn transmission_error(mesh: &MeshSpec, gears: &[GearSpec]) -> impl Fn(f64, f64) -> f64 {
    let [a, b] = mesh.gears.map(|i| &gears[i].body);
    let [ra, rb] = [a, b].map(|body| mesh.start.side.sign() * signed_base_radius(body));
    let gap = mesh.start.gap / a.base_helix_angle().cos();
    move |x, y| ra * x + rb * y - gap
}

/// Returns true if a body is an internal gear.
pub fn is_internal(body: &Body) -> bool {
    matches!(body, Body::Gear(gear) if gear.is_internal())
}

/// Returns the axes in which a mesh is laid out, halfway between those of its gears.
pub fn layout_axes(a: &GearSpec, b: &GearSpec) -> [Vec3; 3] {
    let middle = (a.axes[2] + b.axes[2]).normalize();
    if matches!(b.body, Body::Rack(_)) || a.axes[2] == b.axes[2] {
        return a.axes;
    }
    turned_to(&a.axes, &middle)
}

/// Returns the direction from each gear to the pitch point in its own axes, where that of the layout is `direction`.
fn towards(a: &GearSpec, b: &GearSpec, direction: f64) -> [f64; 2] {
    if matches!(b.body, Body::Rack(_)) || a.axes == b.axes {
        let inside = is_internal(&a.body) || is_internal(&b.body);
        let beyond = if inside { 0.0 } else { std::f64::consts::PI };
        return [direction, direction + beyond];
    }
    let apart = Vec3::from(b.position) - Vec3::from(a.position);
    let seen = |axes: &[Vec3; 3], to: Vec3| axes[1].dot(&to).atan2(axes[0].dot(&to));
    [seen(&a.axes, apart), seen(&b.axes, -apart)]
}

/// Largest angle between the axes of cylindrical gears in mesh [rad]: the contact of misaligned gears is that of gears
/// on parallel axes whose flanks are rotated by small angles. Axes of conical gears may have any angle that their
/// geometry allows.
pub const LARGEST_MISALIGNMENT: f64 = 2.0 * std::f64::consts::PI / 180.0;
/// Rounding of an angle between axes [rad].
const ANGLE_ROUNDING: f64 = 1e-7;

/// Refuses axes of cylindrical gears that are not parallel within a small misalignment.
///
/// # Errors
/// [`GeometryError::CrossedAxes`].
pub fn check_axes([a, b]: [&Body; 2], axes: [&Vec3; 2]) -> Result<(), GeometryError> {
    let conical = |body: &Body| matches!(body, Body::Gear(gear) if gear.is_conical());
    let angle = axes[0].angle(axes[1]);
    if conical(a) || conical(b) || angle <= LARGEST_MISALIGNMENT + ANGLE_ROUNDING {
        return Ok(());
    }
    Err(GeometryError::CrossedAxes {
        angle_deg: angle.to_degrees(),
        most_deg: LARGEST_MISALIGNMENT.to_degrees(),
    })
}

/// Returns the pair of two gears at their positions, in the transverse plane.
///
/// # Errors
/// [`GeometryError`] where they do not mesh there.
pub fn pair_of(a: &GearSpec, b: &GearSpec) -> Result<Pair, GeometryError> {
    match conical_pair(a, b)? {
        Some(conical) => Ok(conical.pair),
        None => {
            let Body::Gear(gear) = &a.body else {
                unreachable!("a rack comes second")
            };
            check_axes([&a.body, &b.body], [&a.axes[2], &b.axes[2]])?;
            Pair::new(gear, &b.body, in_plane(a, b).1)
        }
    }
}

/// Returns the direction from the first gear to the pitch point, the distance of the axes (or to the reference line of
/// a rack), the offset along a rack, and the offset along the axes.
fn in_plane(a: &GearSpec, b: &GearSpec) -> (f64, f64, f64, f64) {
    let apart = Vec3::from(b.position) - Vec3::from(a.position);
    let [dx, dy, dz] = layout_axes(a, b).map(|axis| axis.dot(&apart));
    match &b.body {
        // Contact of an internal gear lies on the far side of its mate.
        Body::Gear(second) if second.is_internal() => ((-dy).atan2(-dx), dx.hypot(dy), 0.0, dz),
        Body::Gear(_) => (dy.atan2(dx), dx.hypot(dy), 0.0, dz),
        Body::Rack(_) => {
            let direction = b.facing + std::f64::consts::PI;
            let (sin, cos) = (direction.sin(), direction.cos());
            (direction, dx * cos + dy * sin, -dx * sin + dy * cos, dz)
        }
    }
}

/// Computes the layout of the mesh of two gears at their positions.
pub fn mesh_layout(a: &GearSpec, b: &GearSpec) -> Result<MeshLayout, BuildError> {
    let error = |why: Reason| BuildError::mesh([&a.name, &b.name], MeshPart::Layout, why);
    let Body::Gear(ga) = &a.body else {
        return Err(error(
            (
                "the first gear of a mesh must not be a rack",
                "name the gear first",
            )
                .into(),
        ));
    };
    check_axes([&a.body, &b.body], [&a.axes[2], &b.axes[2]]).map_err(|e| error(e.reason()))?;
    let (direction, distance, offset, dz) = in_plane(a, b);
    let conical = conical_pair(a, b).map_err(|e| error(e.reason()))?;
    let pair = match &conical {
        Some(conical) => conical.pair.clone(),
        None => Pair::new(ga, &b.body, distance).map_err(|e| error(e.reason()))?,
    };
    let distance = conical
        .as_ref()
        .map_or(distance, |_| pair.centre_distance());
    let alpha = pair.working_pressure_angle();
    let half = [&a.body, &b.body].map(|body| 0.5 * body.face_width());
    let (low, high) = ((-half[0]).max(dz - half[1]), half[0].min(dz + half[1]));
    if high <= low && conical.is_none() {
        return Err(error(
            (
                format!(
                    "the face widths do not overlap: their middles are {dz:.4e} m apart along the axis"
                ),
                "give positions whose third coordinates lie closer together",
            )
                .into(),
        ));
    }
    let (face_width, middle) = match dz == 0.0 {
        true => (pair.face_width(), 0.0),
        false => (high - low, 0.5 * (low + high)),
    };
    let (face_width, heights) = match &conical {
        Some(conical) => (conical.face_width, conical.heights),
        None => (face_width, [middle, middle - dz]),
    };
    Ok(MeshLayout {
        direction,
        towards: towards(a, b, direction),
        distance,
        working_pressure_angle: alpha,
        length: match &b.body {
            Body::Gear(_) => pair.line_length(),
            Body::Rack(_) => distance * alpha.sin(),
        },
        path: [pair.s_start(), pair.s_end()],
        pitch_point: pair.s_pitch(),
        base_pitch: pair.base_pitch(),
        contact_ratio: pair.contact_ratio(),
        backlash: pair.backlash_base(),
        face_width,
        heights,
        rack_offset: offset,
        pair,
        conical: conical.map(Box::new),
    })
}

/// Returns the pair of two gears of which at least one is conical, at their positions.
fn conical_pair(a: &GearSpec, b: &GearSpec) -> Result<Option<ConicalPair>, GeometryError> {
    match [&a.body, &b.body] {
        [Body::Gear(one), Body::Gear(two)] if one.is_conical() || two.is_conical() => {
            let frames = [a, b].map(|g| Frame {
                axes: g.axes,
                origin: g.position.into(),
            });
            ConicalPair::new([one, two], frames).map(Some)
        }
        _ => Ok(None),
    }
}

/// Returns the stiffness of a tooth pair along the path of contact of a mesh.
pub fn stiffness_curve(
    a: &GearSpec,
    b: &GearSpec,
    l: &MeshLayout,
    contact: &ContactSpec,
) -> Result<StiffnessCurve, stiffness::StiffnessError> {
    let Body::Gear(ga) = &a.body else {
        unreachable!("mesh_layout refuses a rack as the first gear")
    };
    let materials = [a.material, b.material];
    stiffness::build(
        &contact.stiffness,
        ga,
        &b.body,
        &l.pair,
        materials,
        l.face_width,
    )
}

//! How the bodies of a mesh stand to each other, whatever their models: centre distance, path of contact, stiffness.

use super::mount::turned_to;
use super::scene::{Body, ContactSpec, GearSpec};
use crate::Vec3;
use crate::error::{BuildError, MeshPart, Reason};
use crate::geometry::{Mate, Pair};
use crate::stiffness::{self, StiffnessCurve};

/// Quantities of a pair that do not depend on the model.
#[derive(Clone, Debug)]
pub struct MeshLayout {
    /// Direction from the first gear to the second [rad].
    pub direction: f64,
    /// Direction from each gear to its mate in its own axes [rad]; nothing of a rack.
    pub towards: [f64; 2],
    /// Centre distance, or distance to the rack's reference line [m].
    pub distance: f64,
    /// Transverse working pressure angle [rad].
    pub working_pressure_angle: f64,
    /// Length of the line of action between the tangent points [m].
    pub length: f64,
    /// Path of contact on the first gear's path coordinate [m].
    pub path: [f64; 2],
    /// Pitch point [m].
    pub pitch_point: f64,
    /// Base pitch [m].
    pub base_pitch: f64,
    /// Contact ratio in the transverse plane.
    pub contact_ratio: f64,
    /// Backlash along the line of action [m].
    pub backlash: f64,
    /// Common face width [m].
    pub face_width: f64,
    /// Its middle along the axis, from the middle of the face width of each gear [m].
    pub heights: [f64; 2],
    /// Offset of a rack's reference point along its slide, seen from the first gear [m].
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

/// Base radius [m] of a gear, or `cos(alpha)` of a rack: deflection on the line of action per hub coordinate.
pub fn effective_radius(body: &Body) -> f64 {
    let transverse = match body {
        Body::Gear(g) => g.r_base(),
        Body::Rack(r) => r.transverse_pressure_angle().cos(),
    };
    transverse * body.base_helix_angle().cos()
}

/// The axes that a mesh is laid out in, halfway between those of its gears.
pub fn layout_axes(a: &GearSpec, b: &GearSpec) -> [Vec3; 3] {
    let middle = (a.axes[2] + b.axes[2]).normalize();
    if matches!(b.body, Body::Rack(_)) || a.axes[2] == b.axes[2] {
        return a.axes;
    }
    turned_to(&a.axes, &middle)
}

/// Direction from each gear to its mate in its own axes, where that of the layout is `direction`.
fn towards(a: &GearSpec, b: &GearSpec, direction: f64) -> [f64; 2] {
    if matches!(b.body, Body::Rack(_)) || a.axes == b.axes {
        return [direction, direction + std::f64::consts::PI];
    }
    let apart = Vec3::from(b.position) - Vec3::from(a.position);
    let seen = |axes: &[Vec3; 3], to: Vec3| axes[1].dot(&to).atan2(axes[0].dot(&to));
    [seen(&a.axes, apart), seen(&b.axes, -apart)]
}

/// The mesh of two gears at their positions.
pub fn mesh_layout(a: &GearSpec, b: &GearSpec) -> Result<MeshLayout, BuildError> {
    let error = |why: Reason| BuildError::mesh([&a.name, &b.name], MeshPart::Layout, why);
    let Body::Gear(ga) = &a.body else {
        return Err(error(
            (
                "the first gear of a mesh may not be a rack",
                "name the gear first",
            )
                .into(),
        ));
    };
    let apart = Vec3::from(b.position) - Vec3::from(a.position);
    let axes = layout_axes(a, b);
    let [dx, dy, dz] = axes.map(|axis| axis.dot(&apart));
    let (direction, distance, offset) = match &b.body {
        Body::Gear(_) => (dy.atan2(dx), dx.hypot(dy), 0.0),
        Body::Rack(_) => {
            let direction = b.facing + std::f64::consts::PI;
            let (sin, cos) = (direction.sin(), direction.cos());
            (direction, dx * cos + dy * sin, -dx * sin + dy * cos)
        }
    };
    let pair = Pair::new(ga, &b.body, distance).map_err(|e| error(e.reason()))?;
    let alpha = pair.working_pressure_angle();
    let half = [&a.body, &b.body].map(|body| 0.5 * body.face_width());
    let (low, high) = ((-half[0]).max(dz - half[1]), half[0].min(dz + half[1]));
    if high <= low {
        return Err(error(
            (
                format!(
                    "the face widths do not meet: their middles are {dz:.4e} m apart along the axis"
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
        heights: [middle, middle - dz],
        rack_offset: offset,
    })
}

/// Stiffness of a tooth pair along the path of contact of a mesh.
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
    let pair =
        Pair::new(ga, &b.body, l.distance).expect("the pair was built when the mesh was laid out");
    stiffness::build(
        &contact.stiffness,
        ga,
        &b.body,
        &pair,
        materials,
        l.face_width,
    )
}

//! How the bodies of a mesh stand to each other, whatever their models: centre distance, path of contact, stiffness.

use super::scene::{Body, ContactSpec, GearSpec};
use crate::error::{BuildError, MeshPart, Reason};
use crate::geometry::{Mate, Pair};
use crate::stiffness::{self, StiffnessCurve};

/// Quantities of a pair that do not depend on the model.
#[derive(Clone, Debug)]
pub struct MeshLayout {
    /// Direction from the first gear to the second [rad].
    pub direction: f64,
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
    let (dx, dy) = (b.position[0] - a.position[0], b.position[1] - a.position[1]);
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
    Ok(MeshLayout {
        direction,
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
        face_width: pair.face_width(),
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

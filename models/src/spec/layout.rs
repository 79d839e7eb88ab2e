//! How the bodies of a mesh stand to each other, whatever their models: centre distance, path of contact, stiffness.

use super::scene::{Body, ContactSpec, GearSpec};
use crate::error::{BuildError, MeshPart, Reason};
use crate::geometry::{Gear, Pair, RackPair};
use crate::stiffness::{BuiltStiffness, Mate, StiffnessCurve, StiffnessError, build_with_warnings};

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

/// Base radius [m] of a gear, or `cos(alpha)` of a rack: deflection on the line of action per hub coordinate.
pub fn effective_radius(body: &Body) -> f64 {
    match body {
        Body::Gear(g) => g.r_base() * g.base_helix_angle().cos(),
        Body::Rack(r) => r.transverse_pressure_angle().cos() * r.base_helix_angle().cos(),
    }
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
    match &b.body {
        Body::Gear(gb) => {
            let distance = dx.hypot(dy);
            let pair = Pair::new(ga, gb, distance).map_err(|e| error(e.reason()))?;
            Ok(MeshLayout {
                direction: dy.atan2(dx),
                distance,
                working_pressure_angle: pair.working_pressure_angle(),
                length: pair.line_length(),
                path: [pair.s_start(), pair.s_end()],
                pitch_point: pair.s_pitch(),
                base_pitch: pair.base_pitch(),
                contact_ratio: pair.contact_ratio(),
                backlash: pair.backlash_base(),
                face_width: ga.face_width().min(gb.face_width()),
                rack_offset: 0.0,
            })
        }
        Body::Rack(rack) => {
            let direction = b.facing + std::f64::consts::PI;
            let distance = dx * direction.cos() + dy * direction.sin();
            let pair = RackPair::new(ga, rack, distance).map_err(|e| error(e.reason()))?;
            Ok(MeshLayout {
                direction,
                distance,
                working_pressure_angle: pair.working_pressure_angle(),
                length: distance * pair.working_pressure_angle().sin(),
                path: [pair.s_start(), pair.s_end()],
                pitch_point: pair.s_pitch(),
                base_pitch: pair.base_pitch(),
                contact_ratio: pair.contact_ratio(),
                backlash: pair.backlash_base(),
                face_width: ga.face_width().min(rack.face_width()),
                rack_offset: -dx * direction.sin() + dy * direction.cos(),
            })
        }
    }
}

/// Hands on what the first gear of a mesh meets, with the pair that both make.
///
/// # Panics
/// Where the layout is not that of the two.
pub fn with_mate<T>(
    [a, b]: [&GearSpec; 2],
    l: &MeshLayout,
    what: impl FnOnce(&Gear, Mate<'_>) -> T,
) -> T {
    const LAID_OUT: &str = "the pair was built when the mesh was laid out";
    let Body::Gear(ga) = &a.body else {
        unreachable!("mesh_layout refuses a rack as the first gear")
    };
    match &b.body {
        Body::Gear(gb) => {
            let pair = Pair::new(ga, gb, l.distance).expect(LAID_OUT);
            what(ga, Mate::Gear(gb, &pair))
        }
        Body::Rack(rack) => {
            let pair = RackPair::new(ga, rack, l.distance).expect(LAID_OUT);
            what(ga, Mate::Rack(rack, &pair))
        }
    }
}

/// Stiffness of a tooth pair along the path of contact of a mesh, with what a reader should know of it.
pub fn stiffness_with_warnings(
    [a, b]: [&GearSpec; 2],
    l: &MeshLayout,
    contact: &ContactSpec,
) -> Result<BuiltStiffness, StiffnessError> {
    let materials = [a.material, b.material];
    with_mate([a, b], l, |gear, mate| {
        build_with_warnings(&contact.stiffness, gear, mate, materials, l.face_width)
    })
}

/// The same without the warnings.
pub fn stiffness_curve(
    a: &GearSpec,
    b: &GearSpec,
    l: &MeshLayout,
    contact: &ContactSpec,
) -> Result<StiffnessCurve, StiffnessError> {
    stiffness_with_warnings([a, b], l, contact).map(|built| built.curve)
}

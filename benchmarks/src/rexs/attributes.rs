//! The attributes of REXS that gearbench reads and writes, by numeric id.
//!
//! Names and units change between versions of the standard, numeric ids rarely do. Each attribute stands here once, with all
//! names that versions 1.0 to 2.0 give it, the newest first, and the unit in which version 2.0 has it.

/// An attribute of the standard.
#[derive(Debug)]
pub struct Attribute {
    /// Numeric ids of the attribute, the newest first.
    pub ids: &'static [u32],
    /// Names of the attribute, the newest first.
    pub names: &'static [&'static str],
    /// Unit of version 2.0.
    pub unit: &'static str,
}

macro_rules! attributes {
    ($($(#[$doc:meta])* $name:ident: [$($id:literal),*], [$($text:literal),*], $unit:literal;)*) => {
        $(
            $(#[$doc])*
            pub static $name: Attribute = Attribute {
                ids: &[$($id),*],
                names: &[$($text),*],
                unit: $unit,
            };
        )*

        /// All attributes, for tests against the files of the standard.
        pub static ALL: &[&Attribute] = &[$(&$name),*];
    };
}

attributes! {
    /// Number of teeth, of ring gears as well.
    TEETH: [347], ["number_of_teeth"], "none";
    /// Normal module.
    MODULE: [781], ["normal_module"], "mm";
    /// Helix angle at the reference circle with sign.
    HELIX: [796], ["helix_angle_reference_diameter"], "deg";
    /// Face width.
    WIDTH: [808], ["face_width"], "mm";
    /// Tip diameter.
    TIP: [756], ["tip_diameter"], "mm";
    /// Root diameter.
    ROOT: [746], ["root_diameter"], "mm";
    /// Inner diameter of a gear or a body.
    INNER: [6691], ["inner_diameter"], "mm";
    /// Place on the shaft.
    PLACE: [348, 782, 617, 596], ["u_coordinate_on_shaft"], "mm";
    /// Normal pressure angle of a flank or a tool.
    PRESSURE_ANGLE: [1015, 3050], ["normal_pressure_angle"], "deg";
    /// Profile shift coefficient.
    SHIFT: [784], ["addendum_modification_coefficient"], "none";
    /// Profile shift as a length.
    SHIFT_LENGTH: [4198], ["addendum_modification"], "mm";
    /// Addendum of the tool over the module.
    TOOL_ADDENDUM: [3055], ["addendum_coefficient_reference_profile"], "none";
    /// Radius of the tip corner of the tool over the module.
    TOOL_RADIUS: [3061], ["tip_corner_radius_factor_reference_profile", "tip_radius_factor"], "none";
    /// Radius of the tip corner of the tool.
    TOOL_RADIUS_LENGTH: [3062], ["tip_corner_radius_reference_profile", "tip_radius"], "mm";
    /// Protuberance of the tool.
    PROTUBERANCE: [3063], ["protuberance_amount"], "mm";
    /// Centre distance of a stage.
    CENTRE_DISTANCE: [995], ["center_distance"], "mm";
    /// Angle from the first to the second gear of a stage, about the negative axis of the shaft.
    STAGE_ANGLE: [997], ["rotating_angle_around_neg_u_axis"], "deg";
    /// Smallest normal backlash of a stage.
    LEAST_BACKLASH: [15111], ["minimum_normal_backlash"], "mm";
    /// Largest normal backlash of a stage.
    MOST_BACKLASH: [15110], ["maximum_normal_backlash"], "mm";
    /// Speed of a shaft with sign.
    SPEED: [9203], ["rotational_speed"], "1 / min";
    /// Torque of an external load about the axis of its shaft.
    TORQUE: [9201], ["torque_around_u_axis"], "N m";
    /// Torque of a gear in a stage.
    GEAR_TORQUE: [12827], ["torque"], "N m";
    /// Whether an external load is a connection through which torque enters or leaves.
    TRANSMITS: [9260], ["transmits_torque"], "none";
    /// Length of a section of a shaft.
    LENGTH: [606], ["length"], "mm";
    /// Outer diameter at the start of a section.
    OUTER_BEGIN: [599], ["outer_diameter_begin"], "mm";
    /// Outer diameter at the end of a section.
    OUTER_END: [597], ["outer_diameter_end"], "mm";
    /// Inner diameter at the start of a section.
    INNER_BEGIN: [603], ["inner_diameter_begin"], "mm";
    /// Inner diameter at the end of a section.
    INNER_END: [598], ["inner_diameter_end"], "mm";
    /// Place of a bearing or a coupling on its inner shaft.
    BEARING_PLACE: [545], ["u_coordinate_on_shaft_inner_side"], "mm";
    /// Radial stiffness of a bearing.
    RADIAL_STIFFNESS: [508], ["radial_stiffness"], "N / m";
    /// Axial stiffness of a bearing.
    AXIAL_STIFFNESS: [2088], ["axial_stiffness"], "N / m";
    /// Tilting stiffness of a bearing.
    BENDING_STIFFNESS: [488], ["bending_stiffness"], "N mm / rad";
    /// Directions of axial force that a bearing carries.
    AXIAL_ABSORPTION: [470], ["axial_force_absorption"], "none";
    /// Young's modulus.
    YOUNG: [2898], ["elastic_modulus"], "MPa";
    /// Poisson's ratio.
    POISSON: [2904], ["poisson_ratio"], "none";
    /// Density.
    DENSITY: [2915], ["density"], "kg / dm^3";
    /// Depth of tip relief.
    TIP_RELIEF: [9295], ["tip_relief_depth"], "mm";
    /// Diameter at which tip relief starts.
    TIP_RELIEF_START: [9296], ["tip_relief_datum_diameter"], "mm";
    /// Shape of a relief.
    RELIEF_SHAPE: [14513], ["shape_of_relief"], "none";
    /// Profile crowning at the tip.
    PROFILE_CROWNING_TIP: [14529], ["profile_crowning_at_tip"], "mm";
    /// Profile crowning at the root.
    PROFILE_CROWNING_ROOT: [14530], ["profile_crowning_at_root"], "mm";
    /// Helix crowning at the datum face.
    HELIX_CROWNING_DATUM: [14549], ["helix_crowning_amount_datum_face"], "mm";
    /// Helix crowning at the other face.
    HELIX_CROWNING_OTHER: [14550], ["helix_crowning_amount_non_datum_face"], "mm";
    /// Helix slope deviation from the datum face to the other one.
    HELIX_SLOPE: [14541], ["helix_slope"], "mm";
    /// Depth of end relief at the datum face.
    DATUM_RELIEF: [14555], ["end_relief_depth_datum_face"], "mm";
    /// Length of end relief at the datum face.
    DATUM_RELIEF_LENGTH: [14554], ["end_relief_length_datum_face"], "mm";
    /// Depth of end relief at the other face.
    OTHER_RELIEF: [14560], ["end_relief_depth_non_datum_face"], "mm";
    /// Length of end relief at the other face.
    OTHER_RELIEF_LENGTH: [14559], ["end_relief_length_non_datum_face"], "mm";
    /// Twist of the profile: its slope at the other face less that at the datum face.
    PROFILE_TWIST: [14585], ["profile_twist"], "mm";
    /// Material removed at the points of a topography.
    TOPOGRAPHY: [14536], ["topographical_modification_amounts"], "mm";
    /// Distances of the points of a topography from the datum face.
    TOPOGRAPHY_COORDINATES: [14537], ["coordinates_of_topographical_modification"], "mm";
    /// Diameters of the points of a topography.
    TOPOGRAPHY_DIAMETERS: [14538], ["diameters_of_topographical_modification"], "mm";
    /// Lengths of roll of the points of a topography.
    TOPOGRAPHY_LENGTHS: [14539], ["length_of_topographical_modification"], "mm";
    /// Interpolation between the points of a topography.
    TOPOGRAPHY_INTERPOLATION: [14540], ["type_of_interpolation_topographical_modification"], "none";
    /// Transverse contact ratio.
    CONTACT_RATIO: [990], ["radial_contact_ratio"], "none";
    /// Overlap ratio.
    OVERLAP_RATIO: [991], ["overlap_contact_ratio"], "none";
    /// Working transverse pressure angle.
    WORKING_ANGLE: [4195], ["operating_pressure_angle_in_the_transverse_section"], "deg";
    /// Pitch diameter.
    PITCH: [9206], ["pitch_diameter"], "mm";
    /// Single stiffness c' of ISO 6336.
    SINGLE_STIFFNESS: [200705], ["single_stiffness_iso_6336_2019"], "N / (mm mum)";
    /// Mean mesh stiffness of ISO 6336 for transverse load, c_gamma_alpha.
    MESH_STIFFNESS: [200742], ["mean_mesh_stiffness_for_transverse_load_iso_6336_2019"], "N / (mm mum)";
    /// Mesh stiffness over a rotation by one pitch.
    MESH_STIFFNESS_CURVE: [19307], ["meshing_stiffness_characteristic"], "N / mm";
    /// Angles of a gear for the mesh stiffness.
    MESHING_POSITION: [14128], ["rotational_meshing_position"], "deg";
    /// Load over the face width.
    WIDTH_LOAD: [5914], ["load_distribution_along_face_width"], "N / mm";
}

/// A row of [`OPERATING_STIFFNESS`].
macro_rules! stiffness_row {
    ($row:literal, $($id:literal $column:literal $unit:literal),*) => {
        [$(Attribute {
            ids: &[$id],
            names: &[concat!("operating_point_stiffness_", $row, "_", $column)],
            unit: $unit,
        }),*]
    };
}

/// Stiffness matrix of a bearing in its operating point: forces along `u`, `v`, `w` and moments about `v`, `w`, by
/// displacements along and rotations about the same axes.
pub static OPERATING_STIFFNESS: [[Attribute; 5]; 5] = [
    stiffness_row!("f_u", 8718 "d_u" "N / m", 9218 "d_v" "N / m", 9219 "d_w" "N / m", 9220 "rot_v" "N / rad", 9221 "rot_w" "N / rad"),
    stiffness_row!("f_v", 9222 "d_u" "N / m", 8719 "d_v" "N / m", 9223 "d_w" "N / m", 9224 "rot_v" "N / rad", 9225 "rot_w" "N / rad"),
    stiffness_row!("f_w", 9226 "d_u" "N / m", 9227 "d_v" "N / m", 8720 "d_w" "N / m", 9228 "rot_v" "N / rad", 9229 "rot_w" "N / rad"),
    stiffness_row!("m_v", 9230 "d_u" "N", 9231 "d_v" "N", 9232 "d_w" "N", 8721 "rot_v" "N mm / rad", 9233 "rot_w" "N mm / rad"),
    stiffness_row!("m_w", 9234 "d_u" "N", 9235 "d_v" "N", 9236 "d_w" "N", 9237 "rot_v" "N mm / rad", 8722 "rot_w" "N mm / rad"),
];

/// Directions of a scene (along x, y, z, about x, y) of the rows and columns of [`OPERATING_STIFFNESS`].
pub const STIFFNESS_DIRECTIONS: [usize; 5] = [2, 0, 1, 3, 4];

/// Stiffness above which a bearing holds a direction rigidly [N/m, N m/rad].
pub const RIGID: f64 = 1e13;

#[cfg(test)]
mod tests {
    use super::{ALL, Attribute, OPERATING_STIFFNESS};
    use std::collections::BTreeSet;

    #[test]
    fn no_two_attributes_share_an_id_or_a_name() {
        let matrix = OPERATING_STIFFNESS.iter().flatten();
        let all: Vec<&Attribute> = ALL.iter().copied().chain(matrix).collect();
        let ids: Vec<u32> = all.iter().flat_map(|a| a.ids.iter().copied()).collect();
        let names: Vec<&str> = all.iter().flat_map(|a| a.names.iter().copied()).collect();
        assert_eq!(ids.iter().collect::<BTreeSet<_>>().len(), ids.len());
        assert_eq!(names.iter().collect::<BTreeSet<_>>().len(), names.len());
    }
}

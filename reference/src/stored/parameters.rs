//! Parameters of a stored reference, and the figures computed from its results.

use serde::Deserialize;

/// One gear of a reference.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct GearData {
    /// Number of teeth.
    #[serde(rename = "z")]
    pub teeth: u32,
    /// Profile shift coefficient of the gear.
    #[serde(rename = "x")]
    pub profile_shift: f64,
    /// Helix angle, right hand positive [deg].
    #[serde(default, rename = "beta_deg")]
    pub helix_angle_deg: f64,
    /// Rotation of the gear with its axis, about its centre, from the position with the axis along z: direction times
    /// angle [rad].
    #[serde(default, rename = "tilt_rad")]
    pub tilt: [f64; 3],
    /// Radius of the bore, which is a rigid hub [m].
    #[serde(rename = "rbore")]
    pub bore_radius: f64,
    /// Mass of the mesh [kg].
    #[serde(rename = "mass_mesh_kg")]
    pub mass: f64,
    /// Inertia of the mesh about its axis [kg m^2].
    #[serde(rename = "inertia_zz_mesh_kg_m2")]
    pub inertia: f64,
    /// Base radius [m].
    #[serde(rename = "r_base")]
    pub base_radius: f64,
    /// Angular velocity at t = 0 [rad/s].
    #[serde(skip)]
    pub speed: f64,
}

/// Rack of a reference with fixed back; teeth point to -x.
#[derive(Clone, Debug, PartialEq)]
pub struct RackData {
    /// Number of teeth.
    pub teeth: u32,
    /// Mass of the mesh [kg].
    pub mass: f64,
    /// Distance of the reference line from the axis of gear 1 [m].
    pub distance: f64,
}

/// Parameters of an impact of two gears, or of a gear on a rack.
#[derive(Clone, Debug, PartialEq)]
pub struct ImpactParameters {
    /// Name of the case.
    pub case: String,
    /// Type of the finite elements.
    pub element: String,
    /// Both gears; only the first for an impact on a rack.
    pub gears: Vec<GearData>,
    /// The rack, for an impact without a second gear.
    pub rack: Option<RackData>,
    /// Normal module [m].
    pub module: f64,
    /// Normal pressure angle [rad].
    pub pressure_angle: f64,
    /// Face width [m].
    pub face_width: f64,
    /// Addendum factor of both gears.
    pub addendum: f64,
    /// Dedendum factor of both gears.
    pub dedendum: f64,
    /// Tip radius factor of the rack tool.
    pub tip_radius: f64,
    /// Young's modulus [Pa].
    pub young: f64,
    /// Poisson's ratio of the material.
    pub poisson: f64,
    /// Density of the material [kg/m^3].
    pub density: f64,
    /// Pressure over overclosure of the contact [Pa/m].
    pub penalty: f64,
    /// Coefficient of friction.
    pub friction: f64,
    /// Centre distance, or distance from the axis to the rack's reference line [m].
    pub centre_distance: f64,
    /// Working pressure angle, transverse [rad].
    pub working_pressure_angle: f64,
    /// Path coordinate of the touching pair from the tangent point of gear 1 [m].
    pub path_coordinate: f64,
    /// Gap of the exact involutes at t = 0, in the transverse plane and without tilts [m].
    pub gap_exact: f64,
    /// Gap of the faceted flanks of the first contact at t = 0 [m]: the initial gap for smooth flanks that touch at
    /// the same time.
    pub gap_effective: f64,
    /// Time step [s].
    pub step: f64,
    /// Parameter of the HHT method.
    pub hht_alpha: f64,
}

/// Figures computed from the results when they were made: gears 1 and 2, momentum means and bores (`hub`) at the end
/// of the run, energies, the impact of rigid bodies for comparison. Quantities that a fixed rack does not have are 0
/// or `None`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "the keys of `summary.json`, with their units")]
pub struct Summary {
    pub impulse_ns: f64,
    pub impulse_rigid_elastic_ns: f64,
    pub peak_force_n: f64,
    pub peak_time_s: f64,
    pub first_contact_s: f64,
    pub last_contact_s: f64,
    pub end_s: f64,
    pub omega1_mean_end_rad_s: f64,
    #[serde(default)]
    pub omega2_mean_end_rad_s: f64,
    pub omega1_hub_end_rad_s: f64,
    #[serde(default)]
    pub omega2_hub_end_rad_s: f64,
    pub angular_impulse1_nms: f64,
    pub angular_impulse2_nms: Option<f64>,
    pub angular_momentum_change1_nms: f64,
    pub angular_momentum_change2_nms: Option<f64>,
    pub arm1_m: f64,
    pub arm2_m: Option<f64>,
    pub energy_start_j: f64,
    pub energy_end_j: f64,
    pub strain_energy_end_j: f64,
    pub kinetic_energy_rigid_end_j: f64,
    pub approach_speed_m_s: f64,
    pub separation_speed_m_s: f64,
    pub restitution: f64,
    pub reduced_mass_kg: f64,
    pub increments: u32,
    pub cpu_s: f64,
    pub wall_s: f64,
}

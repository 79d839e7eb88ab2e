//! What a stored reference was computed from, and the figures computed from its results.

use serde::Deserialize;

/// One gear of a reference.
#[derive(Clone, Debug, PartialEq)]
pub struct GearData {
    /// Number of teeth.
    pub teeth: u32,
    /// Profile shift coefficient.
    pub profile_shift: f64,
    /// Radius of the bore, which is a rigid hub [m].
    pub bore_radius: f64,
    /// Mass of the mesh [kg].
    pub mass: f64,
    /// Inertia of the mesh about its axis [kg m^2].
    pub inertia: f64,
    /// Base radius [m].
    pub base_radius: f64,
    /// Polar angle of tooth 1 at t = 0 [rad].
    pub tooth1_angle: f64,
    /// Angular velocity at t = 0 [rad/s].
    pub speed: f64,
}

/// A rack of a reference, its back held; teeth point to -x.
#[derive(Clone, Debug, PartialEq)]
pub struct RackData {
    /// Number of teeth.
    pub teeth: u32,
    /// Mass of the mesh [kg].
    pub mass: f64,
    /// Distance of the reference line from the axis of gear 1 [m].
    pub distance: f64,
    /// Position of tooth 0's centreline along y at t = 0 [m].
    pub tooth0: f64,
}

/// What an impact of two gears, or of a gear on a rack, was computed from.
#[derive(Clone, Debug, PartialEq)]
pub struct ImpactParameters {
    /// Name of the case.
    pub case: String,
    /// Finite element.
    pub element: String,
    /// Both gears; only the first if it meets a rack.
    pub gears: Vec<GearData>,
    /// The rack, if there is one instead of a second gear.
    pub rack: Option<RackData>,
    /// Module [m].
    pub module: f64,
    /// Pressure angle [rad].
    pub pressure_angle: f64,
    /// Face width [m].
    pub face_width: f64,
    /// Addendum factor.
    pub addendum: f64,
    /// Dedendum factor.
    pub dedendum: f64,
    /// Tip radius factor of the rack tool.
    pub tip_radius: f64,
    /// Young's modulus [Pa].
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Density [kg/m^3].
    pub density: f64,
    /// Pressure over overclosure of the contact [Pa/m].
    pub penalty: f64,
    /// Friction coefficient.
    pub friction: f64,
    /// Centre distance, or distance from the axis to the rack's reference line [m].
    pub centre_distance: f64,
    /// Working pressure angle [rad].
    pub working_pressure_angle: f64,
    /// Path coordinate of the touching pair from the tangent point of gear 1 [m].
    pub path_coordinate: f64,
    /// Gap of the exact involutes at t = 0 [m].
    pub gap_exact: f64,
    /// Gap of the faceted flanks of the touching pair at t = 0 [m]: what smooth flanks have to start with
    /// to touch at the same time.
    pub gap_effective: f64,
    /// Time step [s].
    pub step: f64,
    /// Parameter of the HHT method.
    pub hht_alpha: f64,
}

/// Figures computed from the results when they were made.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Summary {
    /// Impulse of the contact force [N s].
    pub impulse_ns: f64,
    /// Impulse of a rigid, perfectly elastic impact [N s].
    pub impulse_rigid_elastic_ns: f64,
    /// Greatest contact force [N].
    pub peak_force_n: f64,
    /// When it acts [s].
    pub peak_time_s: f64,
    /// First time with contact force [s].
    pub first_contact_s: f64,
    /// Last time with contact force [s].
    pub last_contact_s: f64,
    /// End of the run [s].
    pub end_s: f64,
    /// Momentum mean of the angular velocity of gear 1 at the end [rad/s].
    pub omega1_mean_end_rad_s: f64,
    /// The same of gear 2, 0 for a held rack [rad/s].
    #[serde(default)]
    pub omega2_mean_end_rad_s: f64,
    /// Angular velocity of bore 1 at the end [rad/s].
    pub omega1_hub_end_rad_s: f64,
    /// Angular velocity of bore 2 at the end, 0 for a held rack [rad/s].
    #[serde(default)]
    pub omega2_hub_end_rad_s: f64,
    /// Integral of the contact moment on gear 1 about its axis [N m s].
    pub angular_impulse1_nms: f64,
    /// The same on gear 2 [N m s]; none for a rack.
    pub angular_impulse2_nms: Option<f64>,
    /// Change of the angular momentum of gear 1 [N m s].
    pub angular_momentum_change1_nms: f64,
    /// The same of gear 2 [N m s]; none for a rack.
    pub angular_momentum_change2_nms: Option<f64>,
    /// Mean effective base radius arm of the contact force about the axis of gear 1 [m].
    pub arm1_m: f64,
    /// The same about the axis of gear 2 [m]; none for a rack.
    pub arm2_m: Option<f64>,
    /// Energy at the start [J].
    pub energy_start_j: f64,
    /// Kinetic and strain energy at the end [J].
    pub energy_end_j: f64,
    /// Strain energy at the end [J].
    pub strain_energy_end_j: f64,
    /// Kinetic energy of the momentum means at the end [J].
    pub kinetic_energy_rigid_end_j: f64,
    /// Speed of approach on the line of action at the start [m/s].
    pub approach_speed_m_s: f64,
    /// The same at the end, negative when parting [m/s].
    pub separation_speed_m_s: f64,
    /// Coefficient of restitution from the momentum means.
    pub restitution: f64,
    /// Reduced mass of both gears on the line of action [kg].
    pub reduced_mass_kg: f64,
    /// Increments.
    pub increments: u32,
    /// Processor time of the run [s].
    pub cpu_s: f64,
    /// Wall time of the run [s].
    pub wall_s: f64,
}

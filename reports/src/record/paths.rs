//! The record of torque paths in a train: meshes, shafts, bearings, loads and drives, and load sharing of planets.

use serde::{Deserialize, Serialize};

/// Paths of torque through a scene: mean values over an interval, and work over the whole run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct TorquePaths {
    /// Start of the interval of the means [s].
    pub from_s: f64,
    /// End of the interval of the means [s].
    pub to_s: f64,
    /// Measure of the distance from a settled state [-]: the largest relative change of a mesh's mean torque between
    /// both halves of the interval, or the power that accelerates members over the input power.
    pub change_rel: f64,
    /// Mean power of the loads and drives that supply power [W].
    pub input_w: f64,
    /// Meshes in the order of the scene.
    pub meshes: Vec<MeshPath>,
    /// Gears, and behind them bodies on shafts.
    pub members: Vec<MemberPath>,
    /// Shafts between neighbouring stations.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub shafts: Vec<ShaftPath>,
    /// Load sharing of planets at each gear that they all mesh with.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sharing: Vec<Sharing>,
    /// Work of all loads and drives that supply energy, over the whole run [J].
    pub work_in_j: f64,
    /// Work of all loads and drives that absorb energy, over the whole run [J].
    pub work_out_j: f64,
    /// Energy dissipated by damping and friction over the whole run [J].
    pub dissipated_j: f64,
    /// Increase of the scene's kinetic, strain and contact energy over the whole run [J].
    pub stored_j: f64,
    /// Unexplained energy [J]: `work_in_j` less work out, dissipated and stored energy, by errors of the integration
    /// and of the sums over the grid.
    pub unexplained_j: f64,
}

/// Mean force, torques and power of a mesh.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct MeshPath {
    /// Names of its gears.
    pub gears: [String; 2],
    /// Mean contact force [N].
    pub force_n: f64,
    /// Mean torques on both gears about their axes [N m]; of a rack the force along its slide [N].
    pub torque_nm: [f64; 2],
    /// Mean power from the first gear to the second in space [W]: by torque and speed of the first gear, or of the
    /// second where the first is a planet.
    pub power_w: f64,
    /// Magnitude of that power over the input power [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub share: Option<f64>,
    /// Mean power from gear to gear as the carrier of a planetary set sees it [W].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rolling_w: Option<f64>,
    /// Mean power absorbed in the contacts: damping, friction, and change of stored energy [W].
    pub loss_w: f64,
}

/// Mean speed, torques and power of a gear or a body.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct MemberPath {
    /// Name of the gear or body.
    pub name: String,
    /// Mean speed [rad/s].
    pub speed_rad_s: f64,
    /// Mean torque of its loads [N m].
    pub load_nm: f64,
    /// Mean torque of its mount or drive [N m].
    pub mount_nm: f64,
    /// Mean torque of all contacts [N m].
    pub contact_nm: f64,
    /// Mean power of loads and drive [W].
    pub power_w: f64,
    /// Mean magnitude of the force of its bearing or pin [N].
    pub bearing_n: f64,
    /// Work of loads and drive over the whole run [J].
    pub work_j: f64,
}

/// A piece of a shaft between neighbours.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct ShaftPath {
    /// Names of the stations.
    pub between: [String; 2],
    /// Mean torque that the first exerts on the second [N m].
    pub torque_nm: f64,
    /// Mean power through the shaft [W].
    pub power_w: f64,
}

/// Load sharing of the planets of a carrier at one gear.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Sharing {
    /// Name of the carrier.
    pub carrier: String,
    /// The gear that they mesh with.
    pub gear: String,
    /// Shares of the planets, one each.
    pub planets: Vec<PlanetShare>,
    /// Load sharing factor of the mean forces: number of planets times the largest over their sum [-].
    pub factor: f64,
    /// Largest load sharing factor at any time [-].
    pub factor_greatest: f64,
}

/// Share of a planet in the load of a gear.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct PlanetShare {
    /// Name of the planet.
    pub planet: String,
    /// Mean force of its mesh over the sum of all [-].
    pub mean: f64,
    /// Least share at any time [-].
    pub least: f64,
    /// Greatest share at any time [-].
    pub greatest: f64,
}

/// Change between both halves of the time of means beyond which a run has not settled.
const SETTLED: f64 = 0.1;

impl TorquePaths {
    /// True if the run has settled, so that its means are meaningful: `change_rel` at most 0.1.
    pub fn has_settled(&self) -> bool {
        self.change_rel <= SETTLED
    }

    /// Power taken out by loads and drives over the power put in [-]; `None` without power.
    pub fn efficiency(&self) -> Option<f64> {
        let taken: f64 = self.members.iter().map(|m| (-m.power_w).max(0.0)).sum();
        (self.input_w > 0.0).then(|| taken / self.input_w)
    }

    /// True if every number is finite.
    pub fn is_finite(&self) -> bool {
        let whole = [
            self.change_rel,
            self.input_w,
            self.work_in_j,
            self.work_out_j,
            self.dissipated_j,
            self.stored_j,
            self.unexplained_j,
        ];
        let meshes = self.meshes.iter().flat_map(|m| {
            [
                m.force_n,
                m.torque_nm[0],
                m.torque_nm[1],
                m.power_w,
                m.loss_w,
            ]
        });
        let members = self.members.iter().flat_map(|m| {
            [
                m.speed_rad_s,
                m.load_nm,
                m.mount_nm,
                m.contact_nm,
                m.power_w,
                m.bearing_n,
                m.work_j,
            ]
        });
        let shafts = self.shafts.iter().flat_map(|s| [s.torque_nm, s.power_w]);
        let sharing = self.sharing.iter().flat_map(|s| {
            let shares = s.planets.iter().flat_map(|p| [p.mean, p.least, p.greatest]);
            shares.chain([s.factor, s.factor_greatest])
        });
        let all = whole.into_iter().chain(meshes).chain(members);
        all.chain(shafts).chain(sharing).all(f64::is_finite)
    }
}

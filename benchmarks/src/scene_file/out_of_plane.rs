//! Out-of-plane motion of a hub: `bearing`, `directions`, mass and inertia of the body, and the direction of its axis.
//!
//! ```toml
//! bearing = { stiffness = [1e8, 1e8, 5e7, 1e5, 1e5, 0.0], damping = [1e3, 1e3, 1e3, 1.0, 1.0, 0.0] }
//! directions = { z = "held", tilt_x = { driven = { speed_rad_s = 0.01 } } }
//! misalignment_deg = { plane_of_action = 0.03 }
//! ```

use super::error::SceneError;
use super::measured::DataFiles;
use super::profile::{Sliding, Turning};
use super::reading::Place;
use super::reading::keys::keys;
use super::reading::values::{Degrees, NotNegative, Positive};
use gearbench_models::Vec3;
use gearbench_models::spec::{
    Bearing, Freedom, LARGEST_MISALIGNMENT, Load, OutOfPlaneSpec, Profile, SpinTerms,
};
use serde::de::{Deserialize, Deserializer, Error};
use serde::{Serialize, Serializer};

keys! {
    /// Springs and dampers between a hub and the ground.
    #[derive(Default)]
    struct BearingTable {
        /// stiffness along x, y, z in N/m and of tilts about x, y, z in N m/rad, in the axes of the hub, for example [1e8, 1e8, 5e7, 1e5, 1e5, 0.0]
        stiffness: Option<[f64; 6]>,
        /// the same with all couplings, six rows of six
        stiffness_matrix: Option<[[f64; 6]; 6]>,
        /// damping in N s/m and N m s/rad, six values, default 0
        damping: Option<[f64; 6]>,
        /// the same with all couplings, six rows of six
        damping_matrix: Option<[[f64; 6]; 6]>,
        /// radial play to either side in metres, default 0
        clearance_m: Option<NotNegative>,
    }

    /// Freedom of the directions of a hub besides its own motion.
    struct DirectionTable {
        /// along the first axis of the hub, x: "free", "held" or { driven = { speed_m_s = 0.001 } }; default "free" with a bearing, else "held"
        x: Option<Translation>,
        /// along its second axis, y
        y: Option<Translation>,
        /// along the gear's axis
        z: Option<Translation>,
        /// about x: "free", "held" or { driven = { speed_rad_s = 0.001 } }
        tilt_x: Option<Tilt>,
        /// about y
        tilt_y: Option<Tilt>,
        /// about z, of a rack
        tilt_z: Option<Tilt>,
    }

    /// A small tilt of the axis of a gear.
    struct MisalignmentTable {
        /// tilt of the axis within the plane of action of left flanks of the gear's first mesh, in degrees; positive brings left flanks together at the upper end of the axis
        plane_of_action: Option<Degrees>,
        /// tilt across the plane of action in degrees
        across: Option<Degrees>,
        /// any other axis to turn about, with `angle`, for example [0.0, 1.0, 0.0]
        about: Option<[f64; 3]>,
        /// turn about that axis in degrees
        angle: Option<Degrees>,
    }
}

macro_rules! freedoms {
    ($($name:ident: $motion:ident;)*) => { $(
        /// Freedom of one out-of-plane direction of the hub: held, free or driven.
        #[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
        #[serde(rename_all = "kebab-case")]
        pub enum $name {
            /// The direction is held.
            Held,
            /// The direction moves freely.
            Free,
            /// The motion is prescribed.
            Driven($motion),
        }

        impl $name {
            fn freedom(self, files: &DataFiles<'_>, at: &Place<'_>) -> Result<Freedom, SceneError> {
                Ok(match self {
                    $name::Held => Freedom::Fixed,
                    $name::Free => Freedom::Free,
                    $name::Driven(motion) => match motion.load(files, &at.key("driven"))? {
                        Load::Applied(profile) => Freedom::Driven(profile),
                        // A motion has no viscous coefficient.
                        Load::Viscous(_) => Freedom::Driven(Profile::Constant(0.0)),
                    },
                })
            }
        }
    )* };
}

freedoms! {
    Translation: Sliding;
    Tilt: Turning;
}

/// Position of a gear: `[x, y]`, or `[x, y, z]` [m].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Position(pub [f64; 3]);

impl<'de> Deserialize<'de> for Position {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match Vec::<f64>::deserialize(deserializer)?.as_slice() {
            [x, y] => Ok(Position([*x, *y, 0.0])),
            [x, y, z] => Ok(Position([*x, *y, *z])),
            other => Err(D::Error::invalid_length(
                other.len(),
                &"[x, y] or [x, y, z]",
            )),
        }
    }
}

impl Serialize for Position {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0 {
            [x, y, 0.0] => [x, y].serialize(serializer),
            all => all.serialize(serializer),
        }
    }
}

/// Returns the axis of a gear with its misalignment; `line` is the direction of the line of action of left flanks
/// towards the mate.
pub(super) fn misaligned(
    axis: Vec3,
    line: Vec3,
    keys: &MisalignmentTable,
    at: &Place<'_>,
) -> Result<Vec3, SceneError> {
    let turn = |about: Vec3, angle: f64| nalgebra::Rotation3::new(about.normalize() * angle);
    let within = keys.plane_of_action.map_or(0.0, Degrees::radians);
    let across = keys.across.map_or(0.0, Degrees::radians);
    // A turn about z x n brings z towards n.
    let mut tilted = turn(axis.cross(&line), within) * turn(-line, across) * axis;
    match (keys.about, keys.angle) {
        (Some(about), Some(angle)) if Vec3::from(about).norm() > 0.0 => {
            tilted = turn(Vec3::from(about), angle.radians()) * tilted;
        }
        (None, None) => {}
        (about, _) => {
            return at
                .key(if about.is_some() { "about" } else { "angle" })
                .refuse(
                    "`about` and `angle` belong together",
                    "only one is given",
                    "give both, as about = [0.0, 1.0, 0.0], angle = 0.03",
                );
        }
    }
    let away = tilted.angle(&axis);
    if away > LARGEST_MISALIGNMENT {
        return at.refuse(
            format!("the axis is turned by {:.3} degrees", away.to_degrees()),
            "this much",
            format!(
                "a misalignment is at most {} degrees",
                LARGEST_MISALIGNMENT.to_degrees()
            ),
        );
    }
    Ok(tilted)
}

/// Out-of-plane keys of a gear: bearing, freedoms, mass and inertia.
pub(super) struct OutOfPlaneTable {
    pub(super) bearing: Option<BearingTable>,
    pub(super) directions: Option<DirectionTable>,
    pub(super) mass: Option<Positive>,
    pub(super) added_mass: Option<NotNegative>,
    pub(super) inertia: Option<[[f64; 3]; 3]>,
    pub(super) centre_of_mass: Option<[f64; 3]>,
    pub(super) spin: Option<SpinTerms>,
}

/// Reads a matrix from six diagonal values or from all values.
fn matrix(
    key: &str,
    (values, matrix): (Option<[f64; 6]>, Option<[[f64; 6]; 6]>),
    at: &Place<'_>,
) -> Result<[[f64; 6]; 6], SceneError> {
    match (values, matrix) {
        (Some(_), Some(_)) => at.key(key).refuse(
            format!("`{key}` and `{key}_matrix` are both given"),
            "only one is given",
            "the diagonal of the matrix contains the six values",
        ),
        (None, Some(matrix)) => Ok(matrix),
        (values, None) => {
            let mut diagonal = [[0.0; 6]; 6];
            for (i, x) in values.into_iter().flatten().enumerate() {
                diagonal[i][i] = x;
            }
            Ok(diagonal)
        }
    }
}

/// Reads the out-of-plane motion of a hub; `None` if its mount fixes all directions but its own motion (index `own`).
pub(super) fn out_of_plane(
    keys: OutOfPlaneTable,
    own: usize,
    files: &DataFiles<'_>,
    at: &Place<'_>,
) -> Result<Option<Box<OutOfPlaneSpec>>, SceneError> {
    if keys.bearing.is_none() && keys.directions.is_none() {
        let of_body = [
            ("mass_kg", keys.mass.is_some() && own == 5),
            ("added_mass_kg", keys.added_mass.is_some() && own == 5),
            ("inertia_tensor_kgm2", keys.inertia.is_some()),
            ("centre_of_mass_m", keys.centre_of_mass.is_some()),
            ("spin_terms", keys.spin.is_some()),
        ];
        return match of_body.into_iter().find(|(_, given)| *given) {
            None => Ok(None),
            Some((key, _)) => at.key(key).refuse(
                format!("`{key}` has no effect on a hub that only rotates"),
                "this key",
                "add `bearing` or `directions`, or remove it",
            ),
        };
    }
    let mut spec = OutOfPlaneSpec {
        mass: keys.mass.map(f64::from),
        added_mass: keys.added_mass.map_or(0.0, f64::from),
        inertia: keys
            .inertia
            .map(|rows| nalgebra::Matrix3::from_fn(|i, j| rows[i][j])),
        centre_of_mass: keys.centre_of_mass.map_or(Vec3::zeros(), Vec3::from),
        spin: keys.spin.unwrap_or_default(),
        ..OutOfPlaneSpec::default()
    };
    if let Some(b) = &keys.bearing {
        let place = at.key("bearing");
        spec.bearing = Bearing {
            stiffness: matrix("stiffness", (b.stiffness, b.stiffness_matrix), &place)?,
            damping: matrix("damping", (b.damping, b.damping_matrix), &place)?,
            clearance: b.clearance_m.map_or(0.0, f64::from),
        };
        spec.directions = [const { Freedom::Free }; 6];
    }
    if let Some(d) = keys.directions {
        let place = at.key("directions");
        let given: [Option<Result<Freedom, SceneError>>; 6] = [
            d.x.map(|x| x.freedom(files, &place.key("x"))),
            d.y.map(|y| y.freedom(files, &place.key("y"))),
            d.z.map(|z| z.freedom(files, &place.key("z"))),
            d.tilt_x
                .map(|tilt| tilt.freedom(files, &place.key("tilt_x"))),
            d.tilt_y
                .map(|tilt| tilt.freedom(files, &place.key("tilt_y"))),
            d.tilt_z
                .map(|tilt| tilt.freedom(files, &place.key("tilt_z"))),
        ];
        for (i, freedom) in given.into_iter().enumerate() {
            let Some(freedom) = freedom.transpose()? else {
                continue;
            };
            if i == own {
                let key = ["x", "", "", "", "", "tilt_z"][own];
                return place.key(key).refuse(
                    format!("`{key}` is the direction of motion of the mount"),
                    "defined by `mount`",
                    "give it in `mount`",
                );
            }
            spec.directions[i] = freedom;
        }
    }
    spec.directions[own] = Freedom::Fixed;
    Ok(Some(Box::new(spec)))
}

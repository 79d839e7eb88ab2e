//! Loads, prescribed motions and mounts of gears.
//!
//! ```toml
//! loads = [{ torque_nm = 10.0 }, { viscous_nms_per_rad = 0.01 }]
//! loads = [{ ramp = { from_nm = 0.0, to_nm = 10.0, start_s = 0.0, end_s = 0.05 } }]
//! loads = [{ table = { time_s = [0.0, 0.1], torque_nm = [0.0, 10.0] } }]
//! loads = [{ harmonic = { mean_nm = 10.0, amplitude_nm = 1.0, frequency_hz = 50.0, phase_deg = 90.0 } }]
//! loads = [{ csv = { file = "drive.csv", column = "torque [N m]" } }]
//! mount = { driven = { speed_rad_s = 100.0 } }      # as above, with speeds
//! mount = { guided = { stiffness_nm_per_rad = 10.0, damping_nms_per_rad = 0.1, friction_nm = 0.5, stick_rad = 1e-5 } }
//! ```
//!
//! A rack takes forces [N] and speeds [m/s] instead.

use super::error::SceneError;
use super::measured::{Action, DataFiles, MeasuredTable};
use super::reading::Place;
use super::reading::keys::{Table, keys};
use super::reading::values::{Degrees, NotNegative, Positive, is_default};
use gearbench_models::law::{DryFriction, FrictionForm};
use gearbench_models::spec::{Guide, Load, Mount, Profile};
use serde::Serializer;
use serde::de::{Deserialize, Deserializer, Error};

/// The keys of a profile that is found possible while it is read: its times ascend.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[serde(transparent)]
pub struct CheckedProfile<K>(pub K);

impl<'de, K: Deserialize<'de> + Clone + Into<Profile>> Deserialize<'de> for CheckedProfile<K> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let keys = K::deserialize(deserializer)?;
        let profile: Profile = keys.clone().into();
        match profile.problem() {
            None => Ok(CheckedProfile(keys)),
            Some(problem) => Err(D::Error::custom(problem)),
        }
    }
}

/// Declares functions of time in one unit: constant, ramp, table, harmonic or a column of a file, and for loads a
/// viscous coefficient.
macro_rules! profiles {
    ($($choice:ident of $action:ident: $value:ident, $from:ident, $to:ident, $mean:ident, $amplitude:ident $(, $viscous:ident)?; $ramp:ident, $table:ident, $harmonic:ident;)*) => {
        $(
            keys! {
                /// A linear change between two times.
                struct $ramp {
                    /// value before the ramp
                    $from: f64,
                    /// value after the ramp
                    $to: f64,
                    /// time at which the ramp starts in seconds
                    start_s: f64,
                    /// time at which the ramp ends in seconds
                    end_s: f64,
                }

                /// Values over time.
                struct $table {
                    /// list of ascending times in seconds
                    time_s: Vec<f64>,
                    /// list of values, one per time
                    $value: Vec<f64>,
                }

                /// A cosine about a mean.
                struct $harmonic {
                    /// mean value, default 0
                    #[serde(default, skip_serializing_if = "is_default")]
                    $mean: f64,
                    /// amplitude, half of peak to peak
                    $amplitude: f64,
                    /// frequency in hertz
                    frequency_hz: Positive,
                    /// phase of the cosine at the time 0 in degrees, default 0
                    phase_deg: Option<Degrees>,
                }
            }

            impl From<$harmonic> for Profile {
                fn from(keys: $harmonic) -> Self {
                    Profile::Harmonic {
                        mean: keys.$mean,
                        amplitude: keys.$amplitude,
                        frequency: keys.frequency_hz.0,
                        phase: keys.phase_deg.map_or(0.0, Degrees::radians),
                    }
                }
            }

            impl From<$ramp> for Profile {
                fn from(keys: $ramp) -> Self {
                    Profile::Ramp {
                        from: keys.$from,
                        to: keys.$to,
                        start: keys.start_s,
                        end: keys.end_s,
                    }
                }
            }

            impl From<$table> for Profile {
                fn from(keys: $table) -> Self {
                    Profile::table(keys.time_s, keys.$value)
                }
            }

            /// Function of time; its variants are keys of the file.
            #[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
            #[allow(non_camel_case_types)]
            pub enum $choice {
                /// A constant.
                $value(f64),
                /// A linear change between two times.
                ramp(CheckedProfile<$ramp>),
                /// Values over time.
                table(CheckedProfile<$table>),
                /// A cosine about a mean.
                harmonic(CheckedProfile<$harmonic>),
                /// A column of a CSV file.
                csv(Box<MeasuredTable>),
                $(
                /// A viscous coefficient.
                $viscous(NotNegative),
                )?
            }

            impl $choice {
                /// Returns the load or motion; `at` is its place in the scene.
                ///
                /// # Errors
                /// [`SceneError`] about a CSV file.
                pub(super) fn load(self, files: &DataFiles<'_>, at: &Place<'_>) -> Result<Load, SceneError> {
                    Ok(match self {
                        $choice::$value(x) => Load::Applied(Profile::Constant(x)),
                        $choice::ramp(ramp) => Load::Applied(ramp.0.into()),
                        $choice::table(table) => Load::Applied(table.0.into()),
                        $choice::harmonic(harmonic) => Load::Applied(harmonic.0.into()),
                        $choice::csv(keys) => {
                            Load::Applied(keys.profile(Action::$action, files, &at.key("csv"))?)
                        }
                        $($choice::$viscous(c) => Load::Viscous(c.0),)?
                    })
                }
            }
        )*

        /// All tables of loads and motions.
        pub(super) const TABLES: [&Table; 12] = [$(&$ramp::TABLE, &$table::TABLE, &$harmonic::TABLE),*];
    };
}

profiles! {
    GearLoad of Torque: torque_nm, from_nm, to_nm, mean_nm, amplitude_nm, viscous_nms_per_rad; TorqueRamp, TorqueTable, TorqueHarmonic;
    RackLoad of Force: force_n, from_n, to_n, mean_n, amplitude_n, viscous_ns_per_m; ForceRamp, ForceTable, ForceHarmonic;
    Turning of Rotation: speed_rad_s, from_rad_s, to_rad_s, mean_rad_s, amplitude_rad_s; TurningRamp, TurningTable, TurningHarmonic;
    Sliding of Translation: speed_m_s, from_m_s, to_m_s, mean_m_s, amplitude_m_s; SlidingRamp, SlidingTable, SlidingHarmonic;
}

/// The keys of a guide, and the guide that they give.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckedGuide<K>(K, Guide);

impl<K: Clone + TryInto<Guide, Error = String>> CheckedGuide<K> {
    /// Checks the keys of a guide.
    ///
    /// # Errors
    /// A guide without effect, or friction without a regularisation.
    pub fn new(keys: K) -> Result<Self, String> {
        let guide = keys.clone().try_into()?;
        Ok(CheckedGuide(keys, guide))
    }
}

impl<'de, K> Deserialize<'de> for CheckedGuide<K>
where
    K: Deserialize<'de> + Clone + TryInto<Guide, Error = String>,
{
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        CheckedGuide::new(K::deserialize(deserializer)?).map_err(D::Error::custom)
    }
}

impl<K: serde::Serialize> serde::Serialize for CheckedGuide<K> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.0.serialize(serializer)
    }
}

/// Friction by its sliding force and one of two forms, with the names of their keys.
fn dry(
    [force, stick, v_ref]: [Option<f64>; 3],
    [of_force, of_stick, of_v_ref]: [&str; 3],
) -> Result<Option<DryFriction>, String> {
    let form = match (force, stick, v_ref) {
        (None, None, None) => return Ok(None),
        (None, _, _) => {
            return Err(format!(
                "`{of_stick}` and `{of_v_ref}` belong to friction: also give `{of_force}`"
            ));
        }
        (_, Some(l), None) => FrictionForm::StickSlip(l),
        (_, None, Some(v)) => FrictionForm::Regularised(v),
        _ => {
            return Err(format!(
                "friction needs one regularisation: give `{of_stick}`, the elastic displacement while it sticks, or `{of_v_ref}`, the sliding velocity over which it is smoothed"
            ));
        }
    };
    let law = DryFriction::new(force.unwrap_or(0.0), form);
    law.map(Some).map_err(|e| e.to_string())
}

macro_rules! guides {
    ($($name:ident: $stiffness:ident, $damping:ident, $friction:ident, $stick:ident, $v_ref:ident;)*) => { $(
        keys! {
            /// A spring, a damper and friction between a hub and the ground.
            struct $name {
                /// spring to the ground, without force at the start, default 0
                $stiffness: Option<NotNegative>,
                /// damper to the ground, default 0
                $damping: Option<NotNegative>,
                /// sliding force (torque) of dry friction, default 0
                $friction: Option<NotNegative>,
                /// elastic displacement of sticking friction, at most a thousandth of the motions of interest
                $stick: Option<Positive>,
                /// in its place: speed over which friction is smoothed
                $v_ref: Option<Positive>,
            }
        }

        impl TryFrom<$name> for Guide {
            type Error = String;

            fn try_from(keys: $name) -> Result<Self, String> {
                let guide = Guide {
                    stiffness: keys.$stiffness.map_or(0.0, f64::from),
                    damping: keys.$damping.map_or(0.0, f64::from),
                    friction: dry(
                        [keys.$friction.map(f64::from), keys.$stick.map(f64::from), keys.$v_ref.map(f64::from)],
                        [stringify!($friction), stringify!($stick), stringify!($v_ref)],
                    )?,
                };
                if guide == Guide::default() {
                    return Err(format!(
                        "a guide without spring, damper and friction has no effect: give `{}`, `{}` or `{}`",
                        stringify!($stiffness), stringify!($damping), stringify!($friction),
                    ));
                }
                Ok(guide)
            }
        }
    )* };
}

guides! {
    TurningGuide: stiffness_nm_per_rad, damping_nms_per_rad, friction_nm, stick_rad, v_ref_rad_s;
    SlidingGuide: stiffness_n_per_m, damping_ns_per_m, friction_n, stick_m, v_ref_m_s;
}

macro_rules! mounts {
    ($($name:ident: $free:ident, $motion:ident, $guide:ident;)*) => { $(
        /// Mount of a hub.
        #[derive(Clone, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
        #[serde(rename_all = "kebab-case")]
        pub enum $name {
            /// The hub moves freely in its own direction.
            #[default]
            $free,
            /// The hub is held.
            Fixed,
            /// The motion of the hub is prescribed.
            Driven($motion),
            /// The hub is free and has a spring, damper or friction to the ground.
            Guided(CheckedGuide<$guide>),
        }

        impl $name {
            /// The mount, and the guide if the hub is free.
            ///
            /// # Errors
            /// [`SceneError`] about a CSV file of its motion.
            pub(super) fn parts(self, files: &DataFiles<'_>, at: &Place<'_>) -> Result<(Mount, Option<Guide>), SceneError> {
                Ok(match self {
                    $name::$free => (Mount::$free, None),
                    $name::Fixed => (Mount::Fixed, None),
                    $name::Guided(guide) => (Mount::$free, Some(guide.1)),
                    // A motion has no viscous coefficient.
                    $name::Driven(motion) => match motion.load(files, &at.key("driven"))? {
                        Load::Applied(profile) => (Mount::Driven(profile), None),
                        Load::Viscous(_) => (Mount::Fixed, None),
                    },
                })
            }
        }
    )* };
}

mounts! {
    GearMount: Revolute, Turning, TurningGuide;
    RackMount: Prismatic, Sliding, SlidingGuide;
}

//! Loads, prescribed motions and mounts of a gear.
//!
//! ```toml
//! loads = [{ torque_nm = 10.0 }, { viscous_nms_per_rad = 0.01 }]
//! loads = [{ ramp = { from_nm = 0.0, to_nm = 10.0, start_s = 0.0, end_s = 0.05 } }]
//! loads = [{ table = { time_s = [0.0, 0.1], torque_nm = [0.0, 10.0] } }]
//! loads = [{ harmonic = { mean_nm = 10.0, amplitude_nm = 1.0, frequency_hz = 50.0, phase_deg = 90.0 } }]
//! mount = { driven = { speed_rad_s = 100.0 } }      # as above, with speeds
//! ```
//!
//! A rack takes forces [N] and speeds [m/s] instead.

use super::reading::keys::{Table, keys};
use super::reading::values::{Degrees, NotNegative, Positive};
use gearbench_models::spec::{Load, Mount, Profile};
use serde::de::{Deserialize, Deserializer, Error};
use std::marker::PhantomData;

/// A profile that ascends in time, read from a table of keys.
#[derive(Clone, Debug)]
pub(super) struct Checked<K>(Profile, PhantomData<K>);

impl<'de, K: Deserialize<'de> + Into<Profile>> Deserialize<'de> for Checked<K> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let profile = K::deserialize(deserializer)?.into();
        match profile.problem() {
            None => Ok(Checked(profile, PhantomData)),
            Some(problem) => Err(D::Error::custom(problem)),
        }
    }
}

/// A function of time in one unit: constant, ramp, table or harmonic, and for loads a viscous coefficient.
macro_rules! profiles {
    ($($choice:ident: $value:ident, $from:ident, $to:ident, $mean:ident, $amplitude:ident $(, $viscous:ident)?; $ramp:ident, $table:ident, $harmonic:ident;)*) => {
        $(
            keys! {
                pub(super) struct $ramp {
                    /// value before the ramp
                    $from: f64,
                    /// value after the ramp
                    $to: f64,
                    /// time at which the ramp starts in seconds
                    start_s: f64,
                    /// time at which the ramp ends in seconds
                    end_s: f64,
                }

                pub(super) struct $table {
                    /// list of ascending times in seconds
                    time_s: Vec<f64>,
                    /// list of values, one per time
                    $value: Vec<f64>,
                }

                pub(super) struct $harmonic {
                    /// mean value, default 0
                    #[serde(default)]
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
                        phase: keys.phase_deg.map_or(0.0, |p| p.0),
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
                    Profile::Table {
                        time: keys.time_s,
                        value: keys.$value,
                    }
                }
            }

            /// Its variants are the keys of the file.
            #[derive(Clone, Debug, serde::Deserialize)]
            #[allow(non_camel_case_types)]
            pub(super) enum $choice {
                $value(f64),
                ramp(Checked<$ramp>),
                table(Checked<$table>),
                harmonic(Checked<$harmonic>),
                $($viscous(NotNegative),)?
            }

            impl From<$choice> for Load {
                fn from(choice: $choice) -> Self {
                    match choice {
                        $choice::$value(x) => Load::Applied(Profile::Constant(x)),
                        $choice::ramp(ramp) => Load::Applied(ramp.0),
                        $choice::table(table) => Load::Applied(table.0),
                        $choice::harmonic(harmonic) => Load::Applied(harmonic.0),
                        $($choice::$viscous(c) => Load::Viscous(c.0),)?
                    }
                }
            }
        )*

        /// All tables of loads and motions.
        pub(super) const TABLES: [&Table; 12] = [$(&$ramp::TABLE, &$table::TABLE, &$harmonic::TABLE),*];
    };
}

profiles! {
    GearLoad: torque_nm, from_nm, to_nm, mean_nm, amplitude_nm, viscous_nms_per_rad; TorqueRamp, TorqueTable, TorqueHarmonic;
    RackLoad: force_n, from_n, to_n, mean_n, amplitude_n, viscous_ns_per_m; ForceRamp, ForceTable, ForceHarmonic;
    Turning: speed_rad_s, from_rad_s, to_rad_s, mean_rad_s, amplitude_rad_s; TurningRamp, TurningTable, TurningHarmonic;
    Sliding: speed_m_s, from_m_s, to_m_s, mean_m_s, amplitude_m_s; SlidingRamp, SlidingTable, SlidingHarmonic;
}

macro_rules! mounts {
    ($($name:ident: $free:ident, $motion:ident;)*) => { $(
        /// How a hub may move.
        #[derive(Clone, Debug, Default, serde::Deserialize)]
        #[serde(rename_all = "kebab-case")]
        pub(super) enum $name {
            #[default]
            $free,
            Fixed,
            Driven($motion),
        }

        impl From<$name> for Mount {
            fn from(mount: $name) -> Self {
                match mount {
                    $name::$free => Mount::$free,
                    $name::Fixed => Mount::Fixed,
                    // A motion has no viscous coefficient.
                    $name::Driven(motion) => match motion.into() {
                        Load::Applied(profile) => Mount::Driven(profile),
                        Load::Viscous(_) => Mount::Fixed,
                    },
                }
            }
        }
    )* };
}

mounts! {
    GearMount: Revolute, Turning;
    RackMount: Prismatic, Sliding;
}

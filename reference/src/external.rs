//! A reference computed by another program: parameters, histories and where they come from.
//!
//! Owns the reading of the stored files: a CSV whose header carries SI units, and two JSON files, what the
//! deck was made from (`params.json`) and figures computed from the results (`summary.json`).

use crate::stored_format::RawParameters;
use serde::Deserialize;
use std::collections::BTreeMap;

/// Why stored data cannot be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReferenceError {
    /// There is no such reference.
    #[error("there is no reference `{id}`; there are {known}")]
    Unknown {
        /// The id asked for.
        id: String,
        /// The ids there are.
        known: String,
    },
    /// A stored file is damaged.
    #[error("reference `{id}`, {file}: {message}")]
    Damaged {
        /// Id of the reference.
        id: String,
        /// File.
        file: &'static str,
        /// What is wrong.
        message: String,
    },
}

/// A finite-element run of another program, with all that is needed to judge and to repeat it.
#[derive(Clone, Debug)]
pub struct ExternalReference {
    /// Id, `program/case`.
    pub id: &'static str,
    /// One line for legends and lists.
    pub title: &'static str,
    /// Program and version.
    pub solver: String,
    /// Who computed what and how: the text of its `SOURCE.md`.
    pub source: &'static str,
    /// Command that computes it again, from the root of the repository.
    pub regenerate: &'static str,
    /// Input deck, gzip.
    pub deck: &'static [u8],
    /// What the deck was made from.
    pub parameters: ImpactParameters,
    /// Figures computed from the results when they were made.
    pub summary: Summary,
    /// Histories.
    pub history: History,
}

impl ExternalReference {
    /// Reads the stored texts of a reference.
    ///
    /// # Errors
    /// [`ReferenceError::Damaged`] names the file and what is wrong.
    pub(crate) fn read(stored: &crate::StoredReference) -> Result<Self, ReferenceError> {
        let damaged = |file: &'static str, message: String| ReferenceError::Damaged {
            id: stored.id.into(),
            file,
            message,
        };
        let raw: RawParameters = serde_json::from_str(stored.params)
            .map_err(|e| damaged("params.json", e.to_string()))?;
        let summary: Summary = serde_json::from_str(stored.summary)
            .map_err(|e| damaged("summary.json", e.to_string()))?;
        let solver = raw.solver.clone();
        let parameters = raw
            .typed()
            .map_err(|message| damaged("params.json", message))?;
        let history = History::read(stored.results, parameters.rack.is_some())
            .map_err(|message| damaged("results.csv", message))?;
        Ok(Self {
            id: stored.id,
            title: stored.title,
            solver,
            source: stored.source,
            regenerate: stored.regenerate,
            deck: stored.deck,
            parameters,
            summary,
            history,
        })
    }
}

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
    /// Mean lever arm of the contact force about the axis of gear 1 [m].
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

/// Histories of a reference over one time axis; the first row is the initial state, at t = 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History {
    /// Time [s], strictly increasing.
    pub time: Vec<f64>,
    /// Magnitude of the vector sum of the contact forces over all tooth pairs [N].
    pub contact_force: Vec<f64>,
    /// Components of that sum on gear 1 [N].
    pub force: [Vec<f64>; 2],
    /// Moment of that sum about the axis of gear 1 [N m].
    pub moment: Vec<f64>,
    /// Momentum mean of the angular velocity of gear 1 (angular momentum over inertia) [rad/s].
    pub omega1_mean: Vec<f64>,
    /// The same of gear 2 [rad/s].
    pub omega2_mean: Vec<f64>,
    /// Angular velocity of the bore of gear 1 [rad/s].
    pub omega1_hub: Vec<f64>,
    /// The same of gear 2 [rad/s].
    pub omega2_hub: Vec<f64>,
    /// Angle of the bore of gear 1 since t = 0 [rad].
    pub phi1_hub: Vec<f64>,
    /// The same of gear 2 [rad].
    pub phi2_hub: Vec<f64>,
    /// Strain energy of both gears [J].
    pub strain_energy: [Vec<f64>; 2],
    /// Kinetic energy of both gears [J].
    pub kinetic_energy: [Vec<f64>; 2],
}

impl History {
    /// Reads the CSV; the header names the columns, in any order, further ones are passed over. A rack held at
    /// its back does not turn: its table has no columns of that.
    fn read(text: &str, rack: bool) -> Result<Self, String> {
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let header = reader.headers().map_err(|e| e.to_string())?.clone();
        let mut columns: Vec<Vec<f64>> = vec![Vec::new(); header.len()];
        for record in reader.records() {
            let record = record.map_err(|e| e.to_string())?;
            for (column, cell) in columns.iter_mut().zip(&record) {
                let value: f64 = cell
                    .parse()
                    .map_err(|_| format!("`{cell}` is not a number"))?;
                if !value.is_finite() {
                    return Err(format!("`{cell}` is not finite"));
                }
                column.push(value);
            }
        }
        let rows = columns.first().map_or(0, Vec::len);
        let mut by_name: BTreeMap<&str, Vec<f64>> = header.iter().zip(columns).collect();
        if rack {
            for name in ["omega2_mean_rad_s", "omega2_hub_rad_s", "phi2_hub_rad"] {
                by_name.entry(name).or_insert_with(|| vec![0.0; rows]);
            }
        }
        let mut take = |name: &str| {
            by_name
                .remove(name)
                .ok_or_else(|| format!("column {name} is missing"))
        };
        let history = Self {
            time: take("time_s")?,
            contact_force: take("contact_force_n")?,
            force: [take("force_x_n")?, take("force_y_n")?],
            moment: take("moment_z_origin_nm")?,
            omega1_mean: take("omega1_mean_rad_s")?,
            omega2_mean: take("omega2_mean_rad_s")?,
            omega1_hub: take("omega1_hub_rad_s")?,
            omega2_hub: take("omega2_hub_rad_s")?,
            phi1_hub: take("phi1_hub_rad")?,
            phi2_hub: take("phi2_hub_rad")?,
            strain_energy: [take("strain_energy1_j")?, take("strain_energy2_j")?],
            kinetic_energy: [take("kinetic_energy1_j")?, take("kinetic_energy2_j")?],
        };
        if history.time.first() != Some(&0.0) {
            return Err("the first row is not t = 0".into());
        }
        if let Some(w) = history.time.windows(2).find(|w| w[1] <= w[0]) {
            return Err(format!("time {} follows {}", w[1], w[0]));
        }
        Ok(history)
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// True without rows; a reference that was read has at least the initial state.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// Greatest contact force [N] and its time [s].
    pub fn peak(&self) -> (f64, f64) {
        self.contact_force
            .iter()
            .zip(&self.time)
            .fold(
                (0.0, 0.0),
                |best, (&f, &t)| if f > best.0 { (f, t) } else { best },
            )
    }

    /// Integral of the contact force by the trapezoid rule [N s].
    pub fn impulse(&self) -> f64 {
        trapezoid(&self.time, &self.contact_force)
    }

    /// First and last sampled time with contact force [s], if there is contact at all.
    pub fn contact_interval(&self) -> Option<(f64, f64)> {
        let first = self.contact_force.iter().position(|&f| f > 0.0)?;
        let last = self.contact_force.iter().rposition(|&f| f > 0.0)?;
        Some((self.time[first], self.time[last]))
    }

    /// Kinetic and strain energy of both gears in a row [J].
    pub fn energy(&self, row: usize) -> f64 {
        self.strain_energy
            .iter()
            .chain(&self.kinetic_energy)
            .map(|column| column[row])
            .sum()
    }
}

/// Integral of samples by the trapezoid rule.
pub fn trapezoid(time: &[f64], value: &[f64]) -> f64 {
    time.windows(2)
        .zip(value.windows(2))
        .map(|(t, y)| 0.5 * (t[1] - t[0]) * (y[0] + y[1]))
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "time_s,contact_force_n,force_x_n,force_y_n,moment_z_origin_nm,omega1_hub_rad_s,\
        omega2_hub_rad_s,omega1_mean_rad_s,omega2_mean_rad_s,phi1_hub_rad,phi2_hub_rad,strain_energy1_j,\
        strain_energy2_j,kinetic_energy1_j,kinetic_energy2_j";

    fn row(time: &str) -> String {
        format!("\n{time}{}", ",1".repeat(14))
    }

    #[test]
    fn damaged_tables_are_named() {
        let read = |text: String| History::read(&text, false).unwrap_err();
        assert_eq!(
            read("time_s\n0".into()),
            "column contact_force_n is missing"
        );
        assert_eq!(read(format!("{HEADER}{}", row("x"))), "`x` is not a number");
        assert_eq!(
            read(format!("{HEADER}{}", row("NaN"))),
            "`NaN` is not finite"
        );
        assert_eq!(
            read(format!("{HEADER}{}", row("1"))),
            "the first row is not t = 0"
        );
        assert_eq!(
            read(format!("{HEADER}{}{}", row("0"), row("0"))),
            "time 0 follows 0"
        );
        assert!(History::read(&format!("{HEADER}{}{}", row("0"), row("1")), false).is_ok());
        let held = "time_s,contact_force_n,force_x_n,force_y_n,moment_z_origin_nm,omega1_hub_rad_s,\
            omega1_mean_rad_s,phi1_hub_rad,strain_energy1_j,strain_energy2_j,kinetic_energy1_j,\
            kinetic_energy2_j\n0,1,1,1,1,1,1,1,1,1,1,1";
        assert_eq!(read(held.into()), "column omega2_mean_rad_s is missing");
        assert_eq!(History::read(held, true).unwrap().omega2_mean, [0.0]);
    }
}

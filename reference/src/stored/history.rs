//! Histories of a stored reference, from its CSV.

use std::collections::BTreeMap;

/// Histories of a reference over one time axis; the first row is the initial state, at t = 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History {
    /// Time [s], strictly increasing.
    pub time: Vec<f64>,
    /// Magnitude of the vector sum of the contact forces over all tooth pairs [N].
    pub contact_force: Vec<f64>,
    /// Components of that sum on gear 1 [N]; where the table has none of the axial force, it is 0.
    pub force: [Vec<f64>; 3],
    /// Moment of the contact forces on gear 1 about the middle of its axis [N m]; tables of spur gears have the
    /// component about z alone, the others are 0.
    pub moment: [Vec<f64>; 3],
    /// Momentum mean of the angular velocity of gear 1 (angular momentum over inertia) [rad/s].
    pub omega1_mean: Vec<f64>,
    /// Mean angular velocity of gear 2 [rad/s].
    pub omega2_mean: Vec<f64>,
    /// Angular velocity of the bore of gear 1 [rad/s].
    pub omega1_hub: Vec<f64>,
    /// Strain energy of both gears [J].
    pub strain_energy: [Vec<f64>; 2],
    /// Kinetic energy of both gears [J].
    pub kinetic_energy: [Vec<f64>; 2],
}

impl History {
    /// Reads the CSV; the header names the columns, in any order, and further ones are ignored. A rack with fixed back
    /// does not rotate: its table has no such columns.
    pub fn read(text: &str, rack: bool) -> Result<Self, String> {
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
            let still = by_name.entry("omega2_mean_rad_s");
            still.or_insert_with(|| vec![0.0; rows]);
        }
        for spatial in ["force_z_n", "moment_x_origin_nm", "moment_y_origin_nm"] {
            let none = by_name.entry(spatial);
            none.or_insert_with(|| vec![0.0; rows]);
        }
        let mut take = |name: &str| {
            by_name
                .remove(name)
                .ok_or_else(|| format!("column {name} is missing"))
        };
        let history = Self {
            time: take("time_s")?,
            contact_force: take("contact_force_n")?,
            force: [take("force_x_n")?, take("force_y_n")?, take("force_z_n")?],
            moment: [
                take("moment_x_origin_nm")?,
                take("moment_y_origin_nm")?,
                take("moment_z_origin_nm")?,
            ],
            omega1_mean: take("omega1_mean_rad_s")?,
            omega2_mean: take("omega2_mean_rad_s")?,
            omega1_hub: take("omega1_hub_rad_s")?,
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

//! Histories of a run at full resolution and on an even grid, as CSV files.
//!
//! `results.json` keeps the thinned histories of charts. The study that made the run writes these tables to CSV files
//! once; `docs/data.md` describes them: `runNN-NAME.csv` (a row per time of the grid, strictly ascending), `-pairs.csv`
//! (a row per tooth pair in contact at such a time), `-events.csv` (a row per contact that closes or opens, with the
//! force on both sides of the instant).

use crate::columns::{Columns, FileDescription, up_to};
use crate::csv_table::{CsvTable, number};
use crate::series::{Column, TimeSeries};
use serde::{Deserialize, Serialize};

/// Endings of a run's CSV files after the stem of its name: histories on the grid, tooth pairs, contact events.
pub(crate) const ENDINGS: [&str; 3] = [".csv", "-pairs.csv", "-events.csv"];

/// Force of a tooth pair at a time of the grid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct PairSample {
    /// Time of the sample on the grid \[s\].
    pub time_s: f64,
    /// Mesh, counted from 1 in the order of the scene.
    pub mesh: usize,
    /// Teeth of its two gears, counted from 1.
    pub teeth: [i64; 2],
    /// Magnitude of the vector sum of the pair's contact forces \[N\].
    pub force_n: f64,
    /// Teeth of the pair that move on springs of their own.
    #[serde(default, skip_serializing_if = "no_tooth_moves")]
    pub sprung: [Option<SprungTooth>; 2],
}

/// A tooth that moves against its body on a spring and a damper.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SprungTooth {
    /// Radial part of the contact force on the tooth, positive away from the axis \[N\].
    pub radial_n: f64,
    /// Tangential part, positive counter-clockwise, of a rack along its slide \[N\].
    pub tangential_n: f64,
    /// Force of spring and damper on the tooth, positive as the tangential part \[N\].
    pub spring_n: f64,
    /// Displacement of the tooth relative to its body \[rad\], of a rack \[m\].
    pub deflection: f64,
}

fn no_tooth_moves(sprung: &[Option<SprungTooth>; 2]) -> bool {
    sprung.iter().all(Option::is_none)
}

/// A contact that closes or opens.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ContactEvent {
    /// Time of the event \[s\].
    pub time_s: f64,
    /// True if the contact closes, false if it opens.
    pub closes: bool,
    /// Mesh, counted from 1 in the order of the scene.
    pub mesh: usize,
    /// Teeth of its two gears, counted from 1.
    pub teeth: [i64; 2],
    /// Contact force of the whole mesh just before and just after the event \[N\].
    pub force_n: [f64; 2],
    /// True if the time is that of a located event and the forces are its two sides; else the forces are those at
    /// neighbouring times of the grid.
    pub located: bool,
}

/// Histories of a run at full resolution: the content of its CSV files.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct Histories {
    /// The series at full resolution, if the record's own has been thinned.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub series: Option<TimeSeries>,
    /// Rows of that series at times of the grid, ascending.
    pub on_grid: Vec<usize>,
    /// Columns that are known on the grid alone.
    pub further: Vec<Column>,
    /// Forces of tooth pairs in contact, at times of the grid.
    pub pairs: Vec<PairSample>,
    /// Contacts that close and open.
    pub events: Vec<ContactEvent>,
}

impl Histories {
    /// Returns the table of one of the [`ENDINGS`]; `kept` is the series in the record.
    pub(crate) fn table(&self, ending: usize, kept: Option<&TimeSeries>) -> CsvTable {
        match ending {
            0 => self.even(kept),
            1 => pairs(&self.moving_gears()).table(&self.pairs),
            _ => events().table(&self.events),
        }
    }

    /// Returns the numbers of both gears of a pair, none where no tooth moves.
    fn moving_gears(&self) -> Vec<String> {
        let moves = self.pairs.iter().any(|s| !no_tooth_moves(&s.sprung));
        if moves { up_to(2) } else { Vec::new() }
    }

    fn even(&self, kept: Option<&TimeSeries>) -> CsvTable {
        let empty = TimeSeries::default();
        let series = self.series.as_ref().or(kept).unwrap_or(&empty);
        let rows: Vec<usize> = (self.on_grid.iter().copied())
            .take_while(|&row| row < series.len())
            .collect();
        let row = |(k, &i): (usize, &usize)| {
            let of_series = series.columns.iter().map(|c| c.values.get(i).copied());
            let on_grid = self.further.iter().map(|c| c.values.get(k).copied());
            let time = std::iter::once(series.time_s.get(i).copied());
            time.chain(of_series).chain(on_grid).map(number).collect()
        };
        let names = series.columns.iter().chain(&self.further);
        CsvTable {
            file: String::new(),
            header: std::iter::once("time_s".to_owned())
                .chain(names.map(|c| c.name.clone()))
                .collect(),
            rows: rows.iter().enumerate().map(row).collect(),
        }
    }
}

/// Returns the columns of tooth pairs; `gears` are the numbers of both gears where teeth move, which only some models have.
#[rustfmt::skip]
fn pairs<'a>(gears: &[String]) -> Columns<'a, &'a PairSample> {
    let of = |value: fn(&SprungTooth) -> f64| move |s: &&PairSample, k: usize| s.sprung[k].as_ref().map(value);
    Columns::<&PairSample>::of("runNN-MODEL-INTEGRATOR-pairs.csv", "")
        .add("time_s", "time", |s| s.time_s)
        .add("mesh", "number of the mesh, from 1", |s| s.mesh)
        .add("tooth_1", "tooth of its first gear, from 1", |s| s.teeth[0].to_string())
        .add("tooth_2", "tooth of its second gear, from 1", |s| s.teeth[1].to_string())
        .add("pair_force_n", "magnitude of the vector sum of the pair's contact forces", |s| s.force_n)
        .numbered(gears, "tooth_radial_force_N_n", "of movable teeth: radial part of the contact force on the tooth of this gear of the pair, positive away from the axis, at the contact point (F_n of Ebrahimi and Eberhard)", of(|t| t.radial_n))
        .numbered(gears, "tooth_tangential_force_N_n", "tangential part, positive counter-clockwise, of a rack along its motion (F_t); times the radius of the contact point it is the torque on the tooth", of(|t| t.tangential_n))
        .numbered(gears, "tooth_spring_force_N_n", "force of spring and damper on the tooth, `k r_d (phi - S) + c r_d (omega - S')` (F_te), positive as the tangential part", of(|t| t.spring_n))
        .numbered(gears, "tooth_deflection_N_rad", "angle of the tooth minus that of its body, `S_i - phi`; of a rack a displacement in m", of(|t| t.deflection))
}

#[rustfmt::skip]
fn events<'a>() -> Columns<'a, &'a ContactEvent> {
    Columns::<&ContactEvent>::of("runNN-MODEL-INTEGRATOR-events.csv", "")
        .add("time_s", "time", |e| format!("{:.16e}", e.time_s))
        .add("event", "`closes` or `opens`", |e| if e.closes { "closes" } else { "opens" })
        .add("mesh", "number of the mesh, from 1", |e| e.mesh)
        .add("tooth_1", "tooth of its first gear, from 1", |e| e.teeth[0].to_string())
        .add("tooth_2", "tooth of its second gear, from 1", |e| e.teeth[1].to_string())
        .add("force_before_n", "contact force of the whole mesh just before", |e| e.force_n[0])
        .add("force_after_n", "contact force of the whole mesh just after", |e| e.force_n[1])
        .add("located", "`true`: time of a located event; `false`: the contact changed between two times of the grid; this is the second one, and the forces are those at both", |e| e.located)
}

/// Returns the descriptions of the files of histories. Models and studies make the names of the columns of a run.
pub(crate) fn files() -> Vec<FileDescription> {
    let column = |(key, meaning): &(&str, &str)| ((*key).to_owned(), (*meaning).to_owned());
    let of_runs = FileDescription {
        file: "runNN-MODEL-INTEGRATOR.csv".into(),
        rows: String::new(),
        columns: COLUMNS.iter().map(column).collect(),
    };
    let of_references = FileDescription {
        file: "referenceNN-ID.csv".into(),
        ..of_runs.clone()
    };
    vec![
        of_runs,
        of_references,
        pairs(&["N".to_owned()]).described(),
        events().described(),
    ]
}

/// Columns of the histories of a run. MESH are the names of both gears of a mesh with `_` between them.
#[rustfmt::skip]
const COLUMNS: [(&str, &str); 36] = [
    ("time_s", "time"),
    ("contact_force_MESH_n", "contact force: magnitude, in space, of the vector sum over the tooth pairs of the mesh; on helical gears therefore the force normal to the flanks, 1 / cos(beta_b) times `transverse_force_MESH_n` (1.045 at a base helix angle of 16.9 degrees)"),
    ("speed_GEAR_rad_s", "angular velocity, angular momentum over inertia; of a rack its speed over the pitch radius of its mate"),
    ("speed_GEAR_m_s", "speed of a rack, momentum over mass"),
    ("hub_angle_GEAR_rad", "rotation of the hub since the start"),
    ("hub_displacement_GEAR_m", "displacement of a rack since the start"),
    ("transmission_error_MESH_m", "transmission error in the transverse plane"),
    ("mesh_cycle_MESH", "cycles of the mesh since the start, from the rotation of its first gear, in planetary sets relative to the carrier"),
    ("backlash_position_MESH", "position of the tooth in its backlash: the negative transmission error over the transverse backlash, 0 where the flank of the start touches without load, 1 where the other one does, outside of this range while teeth are deflected; only for runs with values below 0.25 and above 0.75"),
    ("speed_ratio_error_MESH", "error of the speed ratio: speed of the first hub over that of the second, over their ratio by numbers of teeth, minus 1; in planetary sets relative to the carrier; only for runs whose second gear keeps half of its greatest speed"),
    ("tooth_deflection_GEAR_rad", "of movable teeth: angle of a tooth minus that of its body, `S_i - phi`, of the tooth in contact with the greatest spring force, 0 without contact"),
    ("tooth_deflection_GEAR_m", "deflection of a tooth of a rack with movable teeth"),
    ("tooth_radial_force_GEAR_n", "radial part of the contact force on the tooth with the greatest spring force, positive away from the axis (F_n of Ebrahimi and Eberhard)"),
    ("tooth_tangential_force_GEAR_n", "tangential part of the contact force on the tooth with the greatest spring force, positive counter-clockwise, of a rack along its slide (F_t)"),
    ("tooth_spring_force_GEAR_n", "force of spring and damper on the tooth with the greatest spring force, positive as the tangential part (F_te)"),
    ("transverse_force_MESH_n", "component of the contact force in the transverse plane; for spur gears equal to the contact force"),
    ("contact_pressure_MESH_pa", "greatest pressure of a mesh with contact on half-spaces: Hertz's pressure in the middle of a line"),
    ("contact_half_width_MESH_m", "half-width of the contact line of a mesh on half-spaces"),
    ("force_x_MESH_n", "force of the mesh on its second gear along x"),
    ("force_y_MESH_n", "force of the mesh on its second gear along y"),
    ("force_z_MESH_n", "force of the mesh on its second gear along the axes"),
    ("hub_speed_GEAR_rad_s", "angular velocity of the hub"),
    ("hub_speed_GEAR_m_s", "speed of the hub of a rack"),
    ("contact_torque_GEAR_nm", "torque of the contact forces about the axis"),
    ("contact_torque_GEAR_n", "contact force on a rack along its motion"),
    ("bearing_GEAR_x_n", "force of the bearing on the gear along x"),
    ("bearing_GEAR_y_n", "force of the bearing on the gear along y"),
    ("bearing_GEAR_z_n", "force of the bearing on the gear along z; the column exists where the hub also moves out of the transverse plane"),
    ("hub_GEAR_x_m", "displacement of the hub from its assembled position along its first axis"),
    ("hub_GEAR_y_m", "displacement of the hub along its second axis"),
    ("hub_GEAR_z_m", "displacement of the hub along the axis of the gear"),
    ("hub_GEAR_tilt_x_rad", "tilt of the hub about its first axis"),
    ("hub_GEAR_tilt_y_rad", "tilt of the hub about its second axis"),
    ("mount_torque_GEAR_nm", "torque of a mount that holds, drives or guides the gear"),
    ("mount_torque_GEAR_n", "force of a mount that holds, drives or guides a rack along its motion"),
    ("shaft_torque_A_B_nm", "torque that A exerts through their shaft on the next member B; of a long shaft next to A"),
];

#[cfg(test)]
mod tests {
    use super::*;

    /// The files of tooth pairs and events have the columns of movable teeth only where a tooth moves, and times of events
    /// with all their digits.
    #[test]
    fn pairs_and_events_have_their_columns() {
        let tooth = SprungTooth {
            radial_n: 1.0,
            tangential_n: -2.0,
            spring_n: 3.0,
            deflection: 1e-5,
        };
        let mut all = Histories {
            pairs: vec![PairSample {
                time_s: 1e-3,
                mesh: 2,
                teeth: [3, -1],
                force_n: 12.5,
                sprung: [None, Some(tooth)],
            }],
            events: vec![ContactEvent {
                time_s: 0.1 + 0.2,
                closes: true,
                mesh: 1,
                teeth: [4, 5],
                force_n: [0.0, 7.0],
                located: true,
            }],
            ..Histories::default()
        };
        let moving = "time_s,mesh,tooth_1,tooth_2,pair_force_n,tooth_radial_force_1_n,tooth_radial_force_2_n,\
            tooth_tangential_force_1_n,tooth_tangential_force_2_n,tooth_spring_force_1_n,tooth_spring_force_2_n,\
            tooth_deflection_1_rad,tooth_deflection_2_rad\n1.000000000e-3,2,3,-1,1.250000000e1,,1.000000000e0,,\
            -2.000000000e0,,3.000000000e0,,1.000000000e-5\n";
        assert_eq!(all.table(1, None).text(), moving);
        all.pairs[0].sprung = [None, None];
        let still =
            "time_s,mesh,tooth_1,tooth_2,pair_force_n\n1.000000000e-3,2,3,-1,1.250000000e1\n";
        assert_eq!(all.table(1, None).text(), still);
        let events = "time_s,event,mesh,tooth_1,tooth_2,force_before_n,force_after_n,located\n\
            3.0000000000000004e-1,closes,1,4,5,0.000000000e0,7.000000000e0,true\n";
        assert_eq!(all.table(2, None).text(), events);
    }
}

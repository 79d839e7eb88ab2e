//! The text of a reference file: comments on its origin, then columns of contact force, speeds, angles, transmission
//! errors and torques.

use crate::experiment::machine;
use crate::scene_file::references::conditions::stated;
use gearbench_models::spec::SceneSpec;
use gearbench_reports::series::{SPEED, TimeSeries};

/// Contents of the comment lines at the head of the file.
pub(super) struct Header<'a> {
    pub title: &'a str,
    pub command: &'a str,
    pub note: &'a str,
    pub scene: &'a str,
}

/// Least number of digits of times.
const TIME_DIGITS: usize = 13;

/// Prefixes of the columns of a reference.
const KEPT: [&str; 8] = [
    "hub_angle_",
    "hub_displacement_",
    "transmission_error",
    "contact_force_",
    "transverse_force_",
    "speed_",
    "contact_torque_",
    "mount_torque_",
];

/// The text of a reference file, its numbers with so many digits.
pub(super) fn text(
    header: &Header<'_>,
    spec: &SceneSpec,
    series: &TimeSeries,
    digits: usize,
) -> String {
    let line = |text: &str| text.replace(['\n', '\r'], " ");
    let mut text = format!(
        "# title: {}\n# source: made by a model of gearbench {} (commit {}, {}), scene {}\n# command: {}\n# note: {}\n# contact forces are normal forces; conditions, by the keys of a scene:\n",
        line(header.title),
        env!("CARGO_PKG_VERSION"),
        machine::commit(),
        machine::now(),
        line(header.scene),
        line(header.command),
        line(header.note),
    );
    for (key, x) in stated(spec) {
        // No sum of loads is a negative zero.
        text.push_str(&format!("# {key} = {:?}\n", x + 0.0));
    }
    let is_of_rack = |name: &str| {
        let gear = SPEED.subject(name);
        gear.is_some_and(|gear| series.of(SPEED.in_unit("m_s"), gear).is_some())
    };
    let mut columns: Vec<(&str, &[f64])> = vec![("time_s", &series.time_s)];
    for c in &series.columns {
        // A mount that neither holds nor drives has no torque, and the speed of a rack is in m/s.
        let free = c.name.starts_with("mount_torque_") && c.values.iter().all(|x| *x == 0.0);
        if KEPT.iter().any(|k| c.name.starts_with(k)) && !free && !is_of_rack(&c.name) {
            columns.push((&c.name, &c.values));
        }
    }
    let names: Vec<&str> = columns.iter().map(|(name, _)| *name).collect();
    text.push_str(&names.join(","));
    text.push('\n');
    let mut before = String::new();
    for i in 0..series.len() {
        // Of both sides of a jump the first stays: times ascend, also as they are printed.
        let time = format!("{:.*e}", TIME_DIGITS.max(digits) - 1, series.time_s[i]);
        if time == before {
            continue;
        }
        text.push_str(&time);
        for (_, values) in &columns[1..] {
            text.push(',');
            if let Some(x) = values.get(i) {
                text.push_str(&format!("{x:.*e}", digits - 1));
            }
        }
        text.push('\n');
        before = time;
    }
    text
}

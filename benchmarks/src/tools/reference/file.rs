//! The text of a reference file: comments on its origin, then columns of contact force, speeds, angles, transmission
//! errors and torques.

use crate::experiment::machine;
use crate::scene_file::references::conditions::stated;
use gearbench_models::scene::{Channel, OfGear};
use gearbench_models::spec::{Body, SceneSpec};
use gearbench_reports::series::TimeSeries;

/// Contents of the comment lines at the head of the file.
pub(super) struct Header<'a> {
    pub title: &'a str,
    pub command: &'a str,
    pub note: &'a str,
    pub scene: &'a str,
}

/// Prefixes of further columns of a reference.
const KEPT: [&str; 7] = [
    "hub_angle_",
    "hub_displacement_",
    "transmission_error",
    "contact_force_",
    "speed_",
    "contact_torque_",
    "mount_torque_",
];

/// The text of a reference file.
pub(super) fn text(header: &Header<'_>, spec: &SceneSpec, series: &TimeSeries) -> String {
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
    let mut columns: Vec<(String, &[f64])> = vec![
        ("time_s".into(), &series.time_s),
        ("contact_force_n".into(), &series.contact_force_n),
    ];
    for (g, speed) in [&series.omega1_rad_s, &series.omega2_rad_s]
        .into_iter()
        .enumerate()
    {
        // A rack has a column of its own in m/s.
        if spec
            .gears
            .get(g)
            .is_some_and(|gear| matches!(gear.body, Body::Gear(_)))
        {
            columns.push((Channel::Gear(g, OfGear::Speed).column(spec), speed));
        }
    }
    for c in &series.columns {
        // A mount that neither holds nor drives has no torque.
        let free = c.name.starts_with("mount_torque_") && c.values.iter().all(|x| *x == 0.0);
        if KEPT.iter().any(|k| c.name.starts_with(k)) && !free {
            columns.push((c.name.clone(), &c.values));
        }
    }
    let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
    text.push_str(&names.join(","));
    text.push('\n');
    let mut before = String::new();
    for i in 0..series.len() {
        // Of both sides of a jump the first stays: times ascend, also as they are printed.
        let time = format!("{:.12e}", series.time_s[i]);
        if time == before {
            continue;
        }
        text.push_str(&time);
        for (_, values) in &columns[1..] {
            text.push(',');
            if let Some(x) = values.get(i) {
                text.push_str(&format!("{x:.9e}"));
            }
        }
        text.push('\n');
        before = time;
    }
    text
}

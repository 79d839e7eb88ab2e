//! CSV tables of a frequency response: meshes and mounts over the mesh frequency, and meshes at low speed.

use super::{GroupResponse, MeshLimit, MeshPoint, ModelResponse, MountPoint, ResponsePoint};
use crate::csv_table::{CsvTable, number};

type Row<'a, T> = (
    &'a ModelResponse,
    &'a GroupResponse,
    &'a ResponsePoint,
    usize,
    &'a T,
);

fn points(
    responses: &[ModelResponse],
) -> impl Iterator<Item = (&ModelResponse, &GroupResponse, &ResponsePoint)> {
    let groups = responses
        .iter()
        .flat_map(|r| r.groups.iter().map(move |g| (r, g)));
    groups.flat_map(|(r, g)| g.points.iter().map(move |p| (r, g, p)))
}

/// Appends the harmonics of each row as columns.
fn append<T>(table: &mut CsvTable, name: &str, unit: &str, rows: &[T], of: impl Fn(&T) -> &[f64]) {
    let most = rows.iter().map(|r| of(r).len()).max().unwrap_or(0);
    (table.header).extend((1..=most).map(|k| format!("{name}_{k}_{unit}")));
    for (to, row) in table.rows.iter_mut().zip(rows) {
        to.extend((0..most).map(|k| number(of(row).get(k).copied())));
    }
}

/// Returns the tables of a record.
pub fn tables(responses: &[ModelResponse]) -> Vec<CsvTable> {
    let meshes: Vec<Row<'_, MeshPoint>> = points(responses)
        .flat_map(|(r, g, p)| {
            p.meshes
                .iter()
                .enumerate()
                .map(move |(k, m)| (r, g, p, k, m))
        })
        .collect();
    let mut of_meshes = CsvTable::new(
        "response.csv",
        &meshes,
        &[
            ("model", &|(r, ..)| r.label.clone()),
            ("mesh", &|(_, g, _, k, _)| g.meshes[*k].name.clone()),
            ("mesh_frequency_hz", &|(_, _, p, ..)| {
                number(p.mesh_frequency_hz)
            }),
            ("transmission_error_rms_m", &|(.., m)| number(m.error_rms_m)),
            ("transmission_error_peak_to_peak_m", &|(.., m)| {
                number(m.error_peak_to_peak_m)
            }),
            ("force_rms_n", &|(.., m)| number(m.force_rms_n)),
            ("force_least_n", &|(.., m)| number(m.force_least_n)),
            ("force_greatest_n", &|(.., m)| number(m.force_greatest_n)),
            ("holds", &|(_, _, p, ..)| p.is_linear().to_string()),
        ],
    );
    append(&mut of_meshes, "transmission_error", "m", &meshes, |r| {
        &r.4.error_harmonics_m
    });
    let mounts: Vec<Row<'_, MountPoint>> = points(responses)
        .flat_map(|(r, g, p)| {
            p.mounts
                .iter()
                .enumerate()
                .map(move |(k, m)| (r, g, p, k, m))
        })
        .collect();
    let mut of_mounts = CsvTable::new(
        "response_mounts.csv",
        &mounts,
        &[
            ("model", &|(r, ..)| r.label.clone()),
            ("gear", &|(_, g, _, k, _)| g.mounts[*k].clone()),
            ("mesh_frequency_hz", &|(_, _, p, ..)| {
                number(p.mesh_frequency_hz)
            }),
            ("mount_rms_n", &|(.., m)| number(m.rms_n)),
            ("holds", &|(_, _, p, ..)| p.is_linear().to_string()),
        ],
    );
    append(&mut of_mounts, "mount", "n", &mounts, |r| &r.4.harmonics_n);
    let limits: Vec<(&ModelResponse, &GroupResponse, &MeshLimit)> = (responses.iter())
        .flat_map(|r| r.groups.iter().map(move |g| (r, g)))
        .flat_map(|(r, g)| g.meshes.iter().map(move |m| (r, g, m)))
        .collect();
    let mut of_limits = CsvTable::new(
        "response_limits.csv",
        &limits,
        &[
            ("model", &|(r, ..)| r.label.clone()),
            ("mesh", &|(.., m)| m.name.clone()),
            ("mesh_frequency_hz", &|(_, g, _)| number(g.own_frequency_hz)),
            ("resonance_hz", &|(_, g, _)| number(g.resonance_hz)),
            ("resonance_least_hz", &|(_, g, _)| {
                number(g.resonance_range_hz.map(|r| r[0]))
            }),
            ("resonance_greatest_hz", &|(_, g, _)| {
                number(g.resonance_range_hz.map(|r| r[1]))
            }),
            ("force_mean_n", &|(.., m)| number(m.force_n)),
            ("stiffness_n_per_m", &|(.., m)| number(m.stiffness_n_per_m)),
            ("stiffness_least_n_per_m", &|(.., m)| {
                number(m.stiffness_range_n_per_m[0])
            }),
            ("stiffness_greatest_n_per_m", &|(.., m)| {
                number(m.stiffness_range_n_per_m[1])
            }),
            ("transmission_error_rms_m", &|(.., m)| number(m.error_rms_m)),
            ("transmission_error_peak_to_peak_m", &|(.., m)| {
                number(m.error_peak_to_peak_m)
            }),
        ],
    );
    append(&mut of_limits, "transmission_error", "m", &limits, |r| {
        &r.2.error_harmonics_m
    });
    vec![of_meshes, of_mounts, of_limits]
}

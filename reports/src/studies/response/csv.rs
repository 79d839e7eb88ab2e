//! CSV tables of a frequency response: meshes and mounts over the mesh frequency, and meshes at low speed.

use super::{GroupResponse, MeshLimit, MeshPoint, ModelResponse, MountPoint, ResponsePoint};
use crate::columns::{Columns, up_to};
use crate::csv_table::CsvTable;
use crate::markup::column::Format;

/// A mesh or a mount at a mesh frequency, with its place in its group.
type Row<'a, T> = (
    &'a ModelResponse,
    &'a GroupResponse,
    &'a ResponsePoint,
    usize,
    &'a T,
);
/// A mesh at low speed.
pub type Limit<'a> = (&'a ModelResponse, &'a GroupResponse, &'a MeshLimit);

/// Returns the rows of all points.
fn points<T>(responses: &[ModelResponse], of: fn(&ResponsePoint) -> &[T]) -> Vec<Row<'_, T>> {
    let groups = (responses.iter()).flat_map(|r| r.groups.iter().map(move |g| (r, g)));
    let points = groups.flat_map(|(r, g)| g.points.iter().map(move |p| (r, g, p)));
    points
        .flat_map(|(r, g, p)| (of(p).iter().enumerate()).map(move |(k, x)| (r, g, p, k, x)))
        .collect()
}

/// Returns the numbers of the harmonics of some rows.
fn harmonics<R>(rows: &[R], of: impl Fn(&R) -> &[f64]) -> Vec<String> {
    up_to(rows.iter().map(|r| of(r).len()).max().unwrap_or(0))
}

/// Returns the tables of a record.
pub fn tables(responses: &[ModelResponse]) -> Vec<CsvTable> {
    let of_meshes = points(responses, |p| &p.meshes);
    let of_mounts = points(responses, |p| &p.mounts);
    let of_limits: Vec<Limit<'_>> = (responses.iter())
        .flat_map(|r| r.groups.iter().map(move |g| (r, g)))
        .flat_map(|(r, g)| g.meshes.iter().map(move |m| (r, g, m)))
        .collect();
    vec![
        meshes(&harmonics(&of_meshes, |r| &r.4.error_harmonics_m)).table(of_meshes),
        mounts(&harmonics(&of_mounts, |r| &r.4.harmonics_n)).table(of_mounts),
        limits(&harmonics(&of_limits, |r| &r.2.error_harmonics_m)).table(of_limits),
    ]
}

const ERROR_RMS: (&str, &str) = (
    "transmission_error_rms_m",
    "root mean square of the deviation of the transmission error from its mean",
);
const ERROR_SPAN: (&str, &str) = (
    "transmission_error_peak_to_peak_m",
    "greatest minus least transmission error",
);
const ERROR_HARMONIC: (&str, &str) = (
    "transmission_error_N_m",
    "amplitude of the N-th harmonic of the mesh frequency in the transmission error",
);
const HOLDS: (&str, &str) = ("holds", "no flanks separate at this mesh frequency");

#[rustfmt::skip]
pub fn meshes<'a>(harmonics: &[String]) -> Columns<'a, Row<'a, MeshPoint>> {
    Columns::<Row<'_, MeshPoint>>::of("response.csv", "`response`: one row per mesh and mesh frequency.")
        .model(|(r, ..)| r.label.clone())
        .add("mesh", "names of its gears", |(_, g, _, k, _)| g.meshes[*k].name.clone())
        .mesh_frequency(|(_, _, p, ..)| p.mesh_frequency_hz)
        .add(ERROR_RMS.0, ERROR_RMS.1, |(.., m)| m.error_rms_m)
        .add(ERROR_SPAN.0, ERROR_SPAN.1, |(.., m)| m.error_peak_to_peak_m)
        .add("force_rms_n", "root mean square of the force of the mesh about its mean", |(.., m)| m.force_rms_n)
        .add("force_least_n", "least force of the mesh; below zero the flanks separate, and the linear response does not hold", |(.., m)| m.force_least_n)
        .add("force_greatest_n", "greatest force of the mesh", |(.., m)| m.force_greatest_n)
        .add(HOLDS.0, HOLDS.1, |(_, _, p, ..)| p.is_linear())
        .numbered(harmonics, ERROR_HARMONIC.0, ERROR_HARMONIC.1, |(.., m), k| m.error_harmonics_m.get(k).copied())
}

#[rustfmt::skip]
pub fn mounts<'a>(harmonics: &[String]) -> Columns<'a, Row<'a, MountPoint>> {
    Columns::<Row<'_, MountPoint>>::of("response_mounts.csv", "`response`: one row per mount and mesh frequency.")
        .model(|(r, ..)| r.label.clone())
        .add("gear", "gear on the mount", |(_, g, _, k, _)| g.mounts[*k].clone())
        .mesh_frequency(|(_, _, p, ..)| p.mesh_frequency_hz)
        .add("mount_rms_n", "root mean square of the force of the mount across the axis, about its mean", |(.., m)| m.rms_n)
        .add(HOLDS.0, HOLDS.1, |(_, _, p, ..)| p.is_linear())
        .numbered(harmonics, "mount_N_n", "amplitude of the N-th harmonic of the mesh frequency in this force, both directions together", |(.., m), k| m.harmonics_n.get(k).copied())
}

/// Returns the columns of meshes at low speed.
#[rustfmt::skip]
pub fn limits<'a>(harmonics: &[String]) -> Columns<'a, Limit<'a>> {
    Columns::<Limit<'_>>::of("response_limits.csv", "`response`: one row per mesh at low speed.")
        .model(|(r, ..)| r.label.clone())
        .add("mesh", "names of its gears", |(.., m)| m.name.clone()).shown("Mesh", Format::Text)
        .add("mesh_frequency_hz", "mesh frequency at the speeds of the scene", |(_, g, _)| g.own_frequency_hz).shown("Own mesh frequency", Format::Numbers(4))
        .add("resonance_hz", "resonance: root mean square over the mesh cycle of the natural frequency that strains the meshes most", |(_, g, _)| g.resonance_hz).shown("Resonance", Format::Numbers(4)).result()
        .add("resonance_least_hz", "least of this frequency over the mesh cycle", |(_, g, _)| g.resonance_range_hz.map(|r| r[0]))
        .add("resonance_greatest_hz", "greatest of it", |(_, g, _)| g.resonance_range_hz.map(|r| r[1]))
        .add("force_mean_n", "mean contact force", |(.., m)| m.force_n).shown("Force", Format::Numbers(4))
        .add("stiffness_n_per_m", "mean stiffness of the mesh between its hubs", |(.., m)| m.stiffness_n_per_m).shown("Stiffness", Format::Numbers(4)).result()
        .add("stiffness_least_n_per_m", "least stiffness over a mesh cycle", |(.., m)| m.stiffness_range_n_per_m[0]).shown("Least stiffness", Format::Numbers(4))
        .add("stiffness_greatest_n_per_m", "greatest stiffness over a mesh cycle", |(.., m)| m.stiffness_range_n_per_m[1]).shown("Greatest stiffness", Format::Numbers(4))
        .add(ERROR_RMS.0, ERROR_RMS.1, |(.., m)| m.error_rms_m).shown("TE rms, slowly", Format::Numbers(3)).result()
        .add(ERROR_SPAN.0, ERROR_SPAN.1, |(.., m)| m.error_peak_to_peak_m)
        .numbered(harmonics, ERROR_HARMONIC.0, ERROR_HARMONIC.1, |(.., m), k| m.error_harmonics_m.get(k).copied())
}

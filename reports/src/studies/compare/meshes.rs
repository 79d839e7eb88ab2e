//! Contact forces of the meshes of a scene with several: a table and its CSV file.

use crate::csv_table::{CsvTable, number};
use crate::markup::table::Table;
use crate::markup::{note, section};
use crate::numbers::quantity;
use crate::record::{MeshForce, Run};
use crate::view::View;
use maud::{Markup, html};

/// Returns the table of the runs whose histories are drawn, one of each model.
pub fn table(view: &View<'_>) -> Markup {
    let drawn = view.groups.iter().filter_map(|g| Some((g, view.drawn(g)?)));
    let rows: Vec<(&str, usize, &MeshForce)> = drawn
        .flat_map(|(g, (_, run))| {
            let of = |m| (g.label.as_str(), g.style, m);
            run.mesh_forces.iter().map(of)
        })
        .collect();
    let Some((.., first)) = rows.first() else {
        return Markup::default();
    };
    let above = first.ripple_above_hz;
    let ripple = above.map_or("Ripple".into(), |f| {
        format!("Ripple above {}", quantity(f, "Hz", 3))
    });
    let force = |x: Option<f64>| x.map(|x| quantity(x, "N", 4));
    let mut table = Table::of(&rows)
        .grouped(|(label, style, _)| ((*label).to_owned(), *style))
        .text("Mesh", |(.., m)| m.gears.join(" - "))
        .written("Peak force", "", |(.., m)| force(m.peak_force_n))
        .result()
        .written("Root mean square", "", |(.., m)| force(m.rms_force_n))
        .result()
        .written("First contact", "", |(.., m)| {
            m.first_contact_s.map(|t| quantity(t, "s", 4))
        })
        .result();
    if rows.iter().any(|(.., m)| m.ripple_rms_n.is_some()) {
        table = table
            .written(&ripple, "", |(.., m)| force(m.ripple_rms_n))
            .result();
    }
    section(
        "Forces of the meshes",
        html! {
            (table)
            (note("Of the runs that the charts show, over the whole run. The first contact lasts from the first touch until no tooth pair \
                   of the mesh touches; the ripple is the root mean square of the part of the force above a frequency."))
        },
    )
}

/// Returns the CSV file with the forces of all meshes of all runs.
pub fn csv(view: &View<'_>) -> Vec<CsvTable> {
    type Row<'a> = (&'a Run, &'a MeshForce);
    let rows: Vec<Row<'_>> = view.results.runs.iter().flat_map(pairs).collect();
    if rows.is_empty() {
        return Vec::new();
    }
    vec![CsvTable::new::<Row<'_>>(
        "mesh_forces.csv",
        rows,
        &[
            ("model", &|(r, _)| r.model_label()),
            ("integrator", &|(r, _)| r.integrator.clone()),
            ("mesh_name", &|(_, m)| m.gears.join(" - ")),
            ("peak_force_n", &|(_, m)| number(m.peak_force_n)),
            ("rms_force_n", &|(_, m)| number(m.rms_force_n)),
            ("first_contact_s", &|(_, m)| number(m.first_contact_s)),
            ("ripple_rms_n", &|(_, m)| number(m.ripple_rms_n)),
            ("ripple_above_hz", &|(_, m)| number(m.ripple_above_hz)),
        ],
    )]
}

/// Returns each pair of a run and one of its meshes.
fn pairs(run: &Run) -> Vec<(&Run, &MeshForce)> {
    run.mesh_forces.iter().map(|m| (run, m)).collect()
}

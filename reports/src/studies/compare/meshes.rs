//! Contact forces of the meshes of a scene with several: a table and its CSV file.

use crate::columns::Columns;
use crate::csv_table::CsvTable;
use crate::markup::column::Format;
use crate::markup::table::Table;
use crate::markup::{note, section};
use crate::numbers::quantity;
use crate::record::{MeshForce, Run};
use crate::view::View;
use maud::{Markup, html};

/// Returns the table of the runs whose histories are drawn, one of each model.
pub fn table(view: &View<'_>) -> Markup {
    let drawn = view.groups.iter().filter_map(|g| Some((g, view.drawn(g)?)));
    let rows: Vec<(&str, usize, &Run, &MeshForce)> = drawn
        .flat_map(|(g, (_, run))| {
            let of = |m| (g.label.as_str(), g.style, *run, m);
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
    let table = Table::of(&rows)
        .grouped(|(label, style, ..)| ((*label).to_owned(), *style))
        .columns(&columns(&ripple), |(.., run, m)| Some((*run, *m)));
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
    let runs = view.results.runs.iter();
    let rows: Vec<Row<'_>> = runs
        .flat_map(|r| r.mesh_forces.iter().map(move |m| (r, m)))
        .collect();
    match rows.is_empty() {
        true => Vec::new(),
        false => vec![columns("").table(rows)],
    }
}

/// A mesh of a run.
type Row<'a> = (&'a Run, &'a MeshForce);

/// Returns the columns of a mesh; `ripple` is the heading of its ripple on the page.
#[rustfmt::skip]
pub fn columns<'a>(ripple: &str) -> Columns<'a, Row<'a>> {
    Columns::<Row<'_>>::of("mesh_forces.csv", "`compare` of scenes with several meshes: one row per run and mesh.")
        .model(|(r, _)| r.model_label())
        .integrator(|(r, _)| r.integrator.clone())
        .add("mesh_name", "names of both gears of the mesh", |(_, m)| m.gears.join(" - ")).shown("Mesh", Format::Text)
        .add("peak_force_n", "greatest contact force", |(_, m)| m.peak_force_n).shown("Peak force", Format::Quantities(4)).result()
        .add("rms_force_n", "root mean square of the contact force over the time of the run", |(_, m)| m.rms_force_n).shown("Root mean square", Format::Quantities(4)).result()
        .add("first_contact_s", "duration of the first contact, from the first touch until no tooth pair touches", |(_, m)| m.first_contact_s).shown("First contact", Format::Quantities(4)).result()
        .add("ripple_rms_n", "root mean square over the run of the part of the force above `ripple_above_hz`, by discrete Fourier transform", |(_, m)| m.ripple_rms_n).shown(ripple, Format::Quantities(4)).result()
        .add("ripple_above_hz", "the key `ripple_above_hz` of the scene", |(_, m)| m.ripple_above_hz)
}

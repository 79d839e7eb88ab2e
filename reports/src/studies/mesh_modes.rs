//! What pages and CSV files say of the mesh modes of a record, whatever its study.

use crate::csv_table::{CsvTable, number};
use crate::markup::table::Table;
use crate::markup::{note, section};
use crate::numbers::quantity;
use crate::record::{MeshMode, damping_differs, damping_to_text};
use maud::{Markup, html};

/// The section of a page; nothing where there are none.
pub fn tables(all: &[MeshMode]) -> Markup {
    if all.is_empty() {
        return Markup::default();
    }
    let table = Table::of(all)
        .text("Model", |m| m.label.clone())
        .written("Frequency", "", |m| {
            m.frequency_hz.map(|f| quantity(f, "Hz", 4))
        })
        .result()
        .written("Damping ratio", "", |m| {
            m.damping_ratio.map(damping_to_text)
        })
        .result()
        .percents("Strain energy in meshes", 3, |m| m.mesh_share)
        .text("Remark", |m| {
            (!m.message.is_empty()).then(|| m.message.clone())
        });
    let meaning = "The mesh mode is the natural mode with the largest share of strain energy in the meshes, in the equilibrium of the \
                   loads at the start. Damping that a scene states means different things to different models; this ratio is comparable.";
    let differs = damping_differs(all).map(|text| format!("Note: {text}."));
    section(
        "Damping of the mesh mode",
        html! { (table) (note(meaning)) @if let Some(text) = differs { (note(text)) } },
    )
}

/// The table in CSV; `None` where there are none.
pub fn csv(all: &[MeshMode]) -> Option<CsvTable> {
    (!all.is_empty()).then(|| {
        CsvTable::new::<&MeshMode>(
            "mesh_modes.csv",
            all,
            &[
                ("model", &|m| m.label.clone()),
                ("frequency_hz", &|m| number(m.frequency_hz)),
                ("damping_ratio", &|m| number(m.damping_ratio)),
                ("mesh_share", &|m| number(m.mesh_share)),
                ("note", &|m| m.message.clone()),
            ],
        )
    })
}

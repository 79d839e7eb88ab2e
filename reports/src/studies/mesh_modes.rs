//! Table, note and CSV file of the mesh modes of a record, for every study.

use crate::columns::Columns;
use crate::csv_table::CsvTable;
use crate::markup::column::Format;
use crate::markup::table::Table;
use crate::markup::{note, section};
use crate::record::{MeshMode, damping_differs, damping_to_text};
use maud::{Markup, html};

/// Returns the section of the page; empty if the record has no mesh modes.
pub fn tables(all: &[MeshMode]) -> Markup {
    if all.is_empty() {
        return Markup::default();
    }
    let table = Table::of(all)
        .columns_by_key(&columns(), &["model", "frequency_hz", "resonance_hz"], Some)
        .ranges("Over the mesh cycle", "Hz", 4, |m| m.resonance_range_hz)
        .written("Damping ratio", "", |m| {
            m.damping_ratio.map(damping_to_text)
        })
        .result()
        .columns_by_key(&columns(), &["mesh_share", "note"], Some);
    let meaning = "The mesh mode is the natural mode with the largest share of strain energy in the meshes, in the equilibrium of the \
                   loads at the start. The resonance is the root mean square of its frequency over the mesh cycle. Damping that a scene states means different things to different models; this ratio is comparable.";
    let differs = damping_differs(all).map(|text| format!("Note: {text}."));
    section(
        "Damping of the mesh mode",
        html! { (table) (note(meaning)) @if let Some(text) = differs { (note(text)) } },
    )
}

/// Returns the CSV table of mesh modes; `None` where there are none.
pub fn csv(all: &[MeshMode]) -> Option<CsvTable> {
    (!all.is_empty()).then(|| columns().table(all))
}

#[rustfmt::skip]
pub fn columns<'a>() -> Columns<'a, &'a MeshMode> {
    Columns::<&MeshMode>::of("mesh_modes.csv", "Scenes with loads: one row per model. The mesh mode is the natural mode with the largest share of strain energy in the meshes.")
        .model(|m| m.label.clone()).shown("Model", Format::Text)
        .add("frequency_hz", "frequency of the mesh mode at the start", |m| m.frequency_hz).shown("Frequency at the start", Format::Quantities(4)).result()
        .add("resonance_hz", "resonance: root mean square of this frequency over the mesh cycle", |m| m.resonance_hz).shown("Resonance", Format::Quantities(4)).result()
        .add("resonance_least_hz", "least of this frequency over the mesh cycle", |m| m.resonance_range_hz.map(|r| r[0]))
        .add("resonance_greatest_hz", "greatest of it", |m| m.resonance_range_hz.map(|r| r[1]))
        .add("damping_ratio", "damping ratio of the mode", |m| m.damping_ratio)
        .add("mesh_share", "share of its strain energy in the meshes", |m| m.mesh_share).shown("Strain energy in meshes", Format::Percents(3))
        .add("note", "note", |m| m.message.clone()).shown("Remark", Format::Text)
}

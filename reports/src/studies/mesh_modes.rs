//! Table, note and CSV file of the mesh modes of a record, for every study.

use crate::csv_table::{CsvTable, number};
use crate::markup::table::Table;
use crate::markup::{note, section};
use crate::numbers::quantity;
use crate::record::{MeshMode, damping_differs, damping_to_text};
use maud::{Markup, html};

/// Returns the section of the page; empty if the record has no mesh modes.
pub fn tables(all: &[MeshMode]) -> Markup {
    if all.is_empty() {
        return Markup::default();
    }
    let table = Table::of(all)
        .text("Model", |m| m.label.clone())
        .written("Frequency at the start", "", |m| {
            m.frequency_hz.map(|f| quantity(f, "Hz", 4))
        })
        .result()
        .written("Resonance", "", |m| {
            m.resonance_hz.map(|f| quantity(f, "Hz", 4))
        })
        .result()
        .ranges("Over the mesh cycle", "Hz", 4, |m| m.resonance_range_hz)
        .written("Damping ratio", "", |m| {
            m.damping_ratio.map(damping_to_text)
        })
        .result()
        .percents("Strain energy in meshes", 3, |m| m.mesh_share)
        .text("Remark", |m| {
            (!m.message.is_empty()).then(|| m.message.clone())
        });
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
    (!all.is_empty()).then(|| {
        CsvTable::new::<&MeshMode>(
            "mesh_modes.csv",
            all,
            &[
                ("model", &|m| m.label.clone()),
                ("frequency_hz", &|m| number(m.frequency_hz)),
                ("resonance_hz", &|m| number(m.resonance_hz)),
                ("resonance_least_hz", &|m| {
                    number(m.resonance_range_hz.map(|r| r[0]))
                }),
                ("resonance_greatest_hz", &|m| {
                    number(m.resonance_range_hz.map(|r| r[1]))
                }),
                ("damping_ratio", &|m| number(m.damping_ratio)),
                ("mesh_share", &|m| number(m.mesh_share)),
                ("note", &|m| m.message.clone()),
            ],
        )
    })
}

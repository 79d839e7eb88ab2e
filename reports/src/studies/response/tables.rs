//! Finding and tables of frequency response.

use super::csv::{Limit, limits};
use super::{GroupResponse, MeshLimit, ModelResponse, ResponsePoint};
use crate::markup::table::Table;
use crate::markup::{glance, note, prose};
use crate::numbers::quantity;
use maud::{Markup, html};

/// Returns the point with the largest transmission error of a mesh among those at which all flanks stay in contact,
/// since the linear response is valid there alone.
fn peak(group: &GroupResponse, mesh: usize) -> Option<&ResponsePoint> {
    let rms = |p: &&ResponsePoint| p.meshes[mesh].error_rms_m;
    let valid = group.points.iter().filter(|p| p.is_linear());
    valid.max_by(|a, b| rms(a).total_cmp(&rms(b)))
}

/// Returns lowest and highest mesh frequency at which flanks separate [Hz].
fn parting(group: &GroupResponse) -> Option<[f64; 2]> {
    let parts = group.points.iter().filter(|p| !p.is_linear());
    let mut parts = parts.map(|p| p.mesh_frequency_hz);
    let first = parts.next()?;
    Some([first, parts.next_back().unwrap_or(first)])
}

/// Returns a sentence or two on each model: its largest transmission error in contact, its resonance, and the mesh
/// frequencies at which flanks separate.
pub fn finding(responses: &[ModelResponse]) -> Vec<Markup> {
    let of = |r: &ModelResponse| {
        let peaks: Vec<String> = (r.groups.iter())
            .filter_map(|g| {
                let peaks = (0..g.meshes.len()).filter_map(|m| Some((m, peak(g, m)?)));
                let rms = |(m, p): &(usize, &ResponsePoint)| p.meshes[*m].error_rms_m;
                let (m, p) = peaks.reduce(|a, b| if rms(&b) > rms(&a) { b } else { a })?;
                Some(format!(
                    "{} {} rms at {}",
                    g.meshes[m].name,
                    quantity(p.meshes[m].error_rms_m, "m", 3),
                    quantity(p.mesh_frequency_hz, "Hz", 4)
                ))
            })
            .collect();
        let apart: Vec<String> = (r.groups.iter())
            .filter_map(|g| {
                let [from, to] = parting(g)?.map(|f| quantity(f, "Hz", 3));
                Some(match from == to {
                    true => format!("at {from}"),
                    false => format!("between {from} and {to}"),
                })
            })
            .collect();
        let resonance = r.groups.iter().find_map(|g| {
            let [low, high] = g.resonance_range_hz?.map(|f| quantity(f, "Hz", 3));
            let f = quantity(g.resonance_hz?, "Hz", 4);
            Some(format!(
                "; its resonance is {f} ({low} to {high} over the mesh cycle)"
            ))
        });
        html! {
            b { (r.label) }
            @if r.groups.is_empty() { " has no response: " (prose(&r.message)) "." }
            @else {
                @if peaks.is_empty() { " keeps its flanks in contact at no frequency of the range" }
                @else { " has its largest transmission error with flanks in contact at " (peaks.join("; ")) }
                (resonance.unwrap_or_default()) "."
                @if !apart.is_empty() {
                    " Flanks part " (apart.join("; ")) ": the response to first order is not valid there, run "
                    code { "gearbench sweep" } "."
                }
            }
        }
    };
    responses.iter().map(of).collect()
}

pub fn tables(responses: &[ModelResponse]) -> Markup {
    type Row<'a> = (
        usize,
        &'a ModelResponse,
        &'a GroupResponse,
        usize,
        &'a MeshLimit,
    );
    let rows: Vec<Row<'_>> = (responses.iter().enumerate())
        .flat_map(|(i, r)| r.groups.iter().map(move |g| (i, r, g)))
        .flat_map(|(i, r, g)| {
            g.meshes
                .iter()
                .enumerate()
                .map(move |(k, m)| (i, r, g, k, m))
        })
        .collect();
    fn of<'a>((_, r, g, _, m): &Row<'a>) -> Option<Limit<'a>> {
        Some((r, g, m))
    }
    let table = Table::of(&rows)
        .grouped(|(i, r, ..)| (r.label.clone(), *i))
        .columns_by_key(
            &limits(&[]),
            &[
                "mesh",
                "force_mean_n",
                "stiffness_n_per_m",
                "transmission_error_rms_m",
                "resonance_hz",
            ],
            of,
        )
        .ranges("Over the mesh cycle", "Hz", 4, |(_, _, g, ..)| {
            g.resonance_range_hz
        })
        .numbers("Largest TE rms in contact", "m", 3, |(_, _, g, k, _)| {
            peak(g, *k).map(|p| p.meshes[*k].error_rms_m)
        })
        .result()
        .numbers("at", "Hz", 4, |(_, _, g, k, _)| {
            peak(g, *k).map(|p| p.mesh_frequency_hz)
        })
        .result()
        .numbers("Flanks part from", "Hz", 3, |(_, _, g, ..)| {
            parting(g).map(|p| p[0])
        })
        .numbers("to", "Hz", 3, |(_, _, g, ..)| parting(g).map(|p| p[1]))
        .columns_by_key(
            &limits(&[]),
            &[
                "stiffness_least_n_per_m",
                "stiffness_greatest_n_per_m",
                "mesh_frequency_hz",
            ],
            of,
        );
    html! {
        (glance("Response to the passing of teeth", html! {
            (table)
            (note("Transmission error (TE) by the hubs along the line of action, about its mean. Slowly: in the equilibrium of the \
                   loads at each phase. The resonance is the root mean square over the mesh cycle of the natural frequency that strains the mesh most. \
                   Where the least force falls below zero flanks part, and a response to first order is not valid: the largest \
                   transmission error is that of frequencies at which all flanks stay in contact."))
        }))
    }
}

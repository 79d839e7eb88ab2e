//! Summary of a reduced gear, as text and as JSON.

use super::recognised_body::{digits, to_json as body_to_json, to_text};
use super::{Job, ReducedGear, hub};
use crate::messages::Messages;
use gearbench_models::gear::elastic::reduced::FlankCompliance;
use gearbench_reference::mesh;
use gearbench_reference::recognise::{Involute, ToolCandidate};
use gearbench_reference::reduction::store::Motion;
use gearbench_reference::reduction::{Basis, DIRECTIONS, Toothing, mount_text};
use serde_json::{Value, json};
use std::f64::consts::TAU;
use std::path::Path;

/// Number of natural frequencies in the summary.
const FIRST: usize = 6;

/// A line of the summary: name and value in columns.
pub(super) fn line(what: &str, text: &str) -> String {
    format!("  {what:<12}  {text}")
}

/// Describes a written file with its size.
pub(super) fn file(path: &Path, bytes: u64) -> String {
    let (size, unit) = match bytes {
        0..1_000_000 => (bytes as f64 / 1e3, "kB"),
        _ => (bytes as f64 / 1e6, "MB"),
    };
    format!("{}, {size:.1} {unit}", path.display())
}

/// Prints the summary of a reduced gear.
pub(super) fn print_report(messages: &Messages, job: &Job, done: &ReducedGear) {
    let (basis, meta) = (&*done.basis, &done.meta);
    let shown = Toothing::of(basis, meta.motion, meta.teeth);
    messages.print_line(&format!("{}, from {}", job.name, job.source));
    for note in &job.notes {
        messages.print_line(&line("note", note));
    }
    messages.print_line(&line("mesh", &of_mesh(job)));
    messages.print_line(&line(
        "geometry",
        &of_toothing(&shown, meta.motion, meta.teeth),
    ));
    if let Some(fit) = &shown.involute {
        messages.print_line(&line("involute", &of_involute(fit)));
        if let Some(tool) = shown.readings.first() {
            messages.print_line(&line("tool", &of_tools(tool, &shown.readings[1..])));
        }
    }
    if let Some(found) = &job.found {
        messages.print_line(&line("found", &to_text(found)));
    }
    messages.print_line(&line("contact", &of_flanks(job, basis, &shown)));
    messages.print_line(&line("bore", &of_bore(job, meta.motion, basis)));
    messages.print_line(&line("inertia", &of_inertia(job, meta.motion, basis)));
    let m = &job.material;
    messages.print_line(&line(
        "material",
        &format!(
            "E = {:e} Pa, nu = {}, {} kg/m^3",
            m.young, m.poisson, m.density
        ),
    ));
    messages.print_line(&line("modes", &of_modes(basis, &meta.asked)));
    if let Some(text) = of_compliance(basis) {
        messages.print_line(&line("compliance", &text));
    }
    let from = if done.hit { ", from the cache" } else { "" };
    messages.print_line(&line("time", &format!("{:.2} s{from}", done.seconds)));
}

/// The summary of a reduced gear as JSON.
pub(super) fn to_json(job: &Job, done: &ReducedGear) -> Value {
    let (basis, meta) = (&*done.basis, &done.meta);
    let shown = Toothing::of(basis, meta.motion, meta.teeth);
    let hertz: Vec<f64> = basis.omega.iter().map(|w| w / TAU).collect();
    let mut told = json!({
        "name": job.name,
        "source": job.source,
        "notes": job.notes,
        "nodes": job.mesh.mesh.nodes.len(),
        "elements": job.mesh.mesh.element_count(),
        "element": job.mesh.mesh.kind_names(),
        "teeth": meta.teeth,
        "module_m": shown.module,
        "involute": shown.involute.map(|fit| json!({
            "base_radius_m": fit.base_radius,
            "base_pitch_m": fit.base_pitch(),
            "base_helix_deg": fit.base_helix_angle().to_degrees(),
            "base_thickness_m": fit.base_thickness(),
            "residual_rms_m": fit.residual[0],
            "residual_most_m": fit.residual[1],
            "nodes": fit.nodes,
        })),
        "tools": shown.readings.iter().map(|t| json!({
            "module_m": t.module,
            "pressure_angle_deg": t.pressure_angle.to_degrees(),
            "helix_deg": t.helix_angle.to_degrees(),
            "profile_shift": t.profile_shift,
            "standard": t.standard,
        })).collect::<Vec<_>>(),
        "found": job.found.as_ref().map(body_to_json),
        "face_width_m": shown.width,
        "inertia": basis.inertia,
        "unknowns": basis.unknowns,
        "frequencies_hz": hertz,
        "compliance_in_modes": compliance(basis).map(|(_, _, share)| share),
        "from_cache": done.hit,
        "seconds": done.seconds,
    });
    if let Some(l) = &basis.lateral {
        told["mount"] = json!(mount_text(basis.free, &l.free));
        told["body"] = json!({
            "mass_kg": l.mass,
            "centre_m": l.centre,
            "inertia_kgm2": l.inertia.as_chunks::<3>().0,
        });
    }
    told
}

/// A count with its noun, such as `1 flank` or `2 flanks`.
pub(super) fn some(count: usize, what: &str) -> String {
    match count {
        1 => format!("1 {what}"),
        n => format!("{n} {what}s"),
    }
}

fn of_mesh(job: &Job) -> String {
    let mesh = &job.mesh.mesh;
    let q = mesh::quality(mesh);
    let of = match job.sector {
        true => format!("one sector of {}: ", job.mesh.teeth),
        false => String::new(),
    };
    format!(
        "{of}{}, {}, {}, scaled Jacobian {:.3} or more",
        some(mesh.nodes.len(), "node"),
        some(mesh.element_count(), "element"),
        mesh.kind_names(),
        q.min_scaled_jacobian
    )
}

fn of_toothing(t: &Toothing, motion: Motion, teeth: u32) -> String {
    let module = match t.module.is_finite() {
        true => format!(
            "; module {:.3} mm at {:.1} degrees{}",
            1e3 * t.module,
            t.pressure_angle.to_degrees(),
            if t.standard { "" } else { ", none of ISO 54" }
        ),
        // The tool of an internal gear cannot be derived from its flanks.
        false => String::new(),
    };
    match motion {
        Motion::Turn => format!(
            "gear with {}, tip radius {:.3} mm, base radius {:.3} mm{module}",
            some(teeth as usize, "tooth").replace("tooths", "teeth"),
            1e3 * t.tip,
            1e3 * t.base
        ),
        Motion::Slide => format!(
            "rack with {}, tips {:.3} mm above its reference line{module}",
            some(teeth as usize, "tooth").replace("tooths", "teeth"),
            1e3 * t.tip
        ),
    }
}

/// Describes base pitch, base helix and base thickness with the deviations of the nodes.
fn of_involute(fit: &Involute) -> String {
    let helix = fit.base_helix_angle().to_degrees();
    let helix = match helix {
        h if h.abs() < 1e-6 => "spur".to_owned(),
        h => format!(
            "base helix {:.5} degrees {}",
            h.abs(),
            if h > 0.0 { "right" } else { "left" }
        ),
    };
    format!(
        "base pitch {:.6} mm, {helix}, base thickness {:.6} mm; {} deviate from the flank surface by {:.1e} mm rms, {:.1e} mm at most",
        1e3 * fit.base_pitch(),
        1e3 * fit.base_thickness(),
        some(fit.nodes, "node"),
        1e3 * fit.residual[0],
        1e3 * fit.residual[1]
    )
}

/// Describes the likeliest tool, and other tools that produce the same flanks.
fn of_tools(tool: &ToolCandidate, others: &[ToolCandidate]) -> String {
    let pair = |t: &ToolCandidate| {
        format!(
            "normal module {:.4} mm at {:.1} degrees with x = {}",
            1e3 * t.module,
            t.pressure_angle.to_degrees(),
            digits(t.profile_shift, 4)
        )
    };
    let helix = match tool.helix_angle.to_degrees() {
        h if h.abs() < 1e-6 => String::new(),
        h => format!(", helix {h:.4} degrees"),
    };
    let of = match tool.standard {
        true => "ISO 54",
        false => "none of ISO 54 at a usual angle",
    };
    let also: Vec<String> = others.iter().map(pair).collect();
    let also = match also.is_empty() {
        true => String::new(),
        false => format!("; the same flanks have {}", also.join(", or ")),
    };
    format!("{}{helix} ({of}){also}", pair(tool))
}

fn of_flanks(job: &Job, basis: &Basis, t: &Toothing) -> String {
    let points = match job.mesh.tied.is_empty() {
        true => "nodes",
        false => "points tied to faces",
    };
    let grids = basis.flanks.grids();
    let faces: usize = grids.iter().map(|g| (g.rows - 1) * (g.columns - 1)).sum();
    let ends = |of: &dyn Fn(usize) -> usize| {
        let all = || (0..grids.len()).map(of);
        match (all().min(), all().max()) {
            (Some(least), Some(most)) if least < most => format!("{least} to {most}"),
            (least, _) => least.unwrap_or(0).to_string(),
        }
    };
    format!(
        "{} with {} and {}: {} {points} along the profile, {} over {:.3} mm of width{}",
        some(grids.len(), "flank"),
        some(basis.normals.len(), "node"),
        some(faces, "face"),
        ends(&|i| grids[i].rows),
        ends(&|i| grids[i].columns),
        1e3 * t.width,
        if t.straight { ", straight" } else { "" }
    )
}

fn of_bore(job: &Job, motion: Motion, basis: &Basis) -> String {
    let nodes = &job.mesh.mesh.nodes;
    let bore = &job.mesh.bore;
    let held = some(bore.len(), "node");
    let beside = match &basis.lateral {
        Some(l) => {
            let free = DIRECTIONS.iter().zip(l.free).filter(|(_, free)| *free);
            let names: Vec<&str> = free.map(|(name, _)| *name).collect();
            format!(" and free in {}", names.join(", "))
        }
        None => String::new(),
    };
    let hub = format!("{}{beside}", hub(motion, basis.free));
    match (motion, bore.first()) {
        (Motion::Turn, Some(&first)) => {
            let radius = nodes[first as usize].xy().norm();
            format!(
                "{held} at {:.3} mm tied to the hub, which is {hub}",
                1e3 * radius
            )
        }
        _ => format!("{held} tied to the hub, which is {hub}"),
    }
}

fn of_inertia(job: &Job, motion: Motion, basis: &Basis) -> String {
    let parts = if job.sector {
        f64::from(job.mesh.teeth)
    } else {
        1.0
    };
    let mass = parts * job.material.density * mesh::quality(&job.mesh.mesh).volume;
    let added = basis.added_inertia;
    match motion {
        Motion::Turn => {
            let added = match added {
                0.0 => String::new(),
                j => format!(", including {j:e} kg m^2 added at the hub"),
            };
            format!(
                "mass {mass:.6} kg, inertia {:.6e} kg m^2{added}",
                basis.inertia
            )
        }
        Motion::Slide => {
            let added = match added {
                0.0 => String::new(),
                m => format!("; with {m} kg added at the hub, {:.6} kg", basis.inertia),
            };
            format!("mass {mass:.6} kg{added}")
        }
    }
}

fn of_modes(basis: &Basis, asked: &str) -> String {
    let hertz = |w: &f64| w / TAU;
    let Some(highest) = basis.omega.last() else {
        return format!("none of {} unknowns ({asked})", basis.unknowns);
    };
    let mut first: Vec<String> = basis
        .omega
        .iter()
        .take(FIRST)
        .map(|w| format!("{:.1}", hertz(w)))
        .collect();
    if basis.omega.len() > FIRST {
        first.push("...".to_owned());
    }
    format!(
        "{} of {} unknowns to {:.1} Hz ({asked}): {} Hz",
        basis.omega.len(),
        basis.unknowns,
        hertz(highest),
        first.join(", ")
    )
}

/// Tooth of the first flank, compliance in the middle of that flank [m/N], and the share of the modes in it.
fn compliance(basis: &Basis) -> Option<(u32, f64, f64)> {
    let g = basis.flanks.grids().first()?;
    let node = g.nodes[(g.rows / 2) * g.columns + g.columns / 2];
    let own = basis.compliance_between(node, node);
    let shapes = basis.shapes_at(node);
    let modal: f64 = shapes
        .iter()
        .zip(&basis.omega)
        .map(|(b, w)| (b / w).powi(2))
        // The empty sum is the negative zero.
        .fold(0.0, |sum, x| sum + x);
    Some((g.tooth, own, modal / own))
}

fn of_compliance(basis: &Basis) -> Option<String> {
    let (tooth, own, modal) = compliance(basis)?;
    let c = &basis.compliance;
    let layout = match c.flanks {
        FlankCompliance::Full(_) => "between all flank nodes",
        FlankCompliance::Cyclic { .. } => "of one tooth on all",
        FlankCompliance::Deflated(_) => "of one tooth on all, without some modes",
    };
    Some(format!(
        "{layout}; {own:.4e} m/N in the middle of a flank of tooth {}, {:.1} % of it in the modes",
        tooth + 1,
        100.0 * modal
    ))
}

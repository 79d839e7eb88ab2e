//! Two hundred modes of a gear with 24 teeth: from one sector, with the ratio to CalculiX's time stored in
//! `calculix/modal/frequency_z24.json`, and of a moderate whole mesh, with the growth with the mesh.
//!
//! `cargo bench --bench cyclic_modes`
//!
//! Not by criterion: a run takes seconds, and the other side of the ratio was measured once, elsewhere.

#![allow(clippy::print_stdout)]

use gearbench_models::geometry::{Gear, GearParams};
use gearbench_models::stiffness::Material;
use gearbench_reference::assembly::assemble;
use gearbench_reference::assembly::tie::{MassKind, Tie};
use gearbench_reference::gear_mesh::{GearMeshParams, Tooth, gear, sector};
use gearbench_reference::mesh::ElementKind;
use gearbench_reference::modes::cyclic::{self, Hub};
use gearbench_reference::modes::{Options, Report, lowest};
use std::time::Instant;

const TEETH: u32 = 24;
const MODES: usize = 200;

fn body() -> Gear {
    let params = GearParams {
        teeth: TEETH,
        module: 4e-3,
        face_width: 0.02,
        bore_radius: 0.02,
        ..GearParams::default()
    };
    Gear::new(params).expect("a standard gear")
}

/// Returns meshes of growing fineness; about 105,000 unknowns of the whole gear at 3.
fn mesh(fineness: usize) -> GearMeshParams {
    GearMeshParams {
        kind: ElementKind::C3D8,
        tooth: Tooth {
            flank: 3 * fineness,
            fillet: 2 * fineness,
            root: fineness,
            across: 2 * fineness + 2,
        },
        layers: fineness.min(2),
        rim: 2 * fineness,
        width: 2 * fineness,
        ..GearMeshParams::default()
    }
}

fn sum(reports: &[Report]) -> Report {
    reports.iter().fold(Report::default(), |mut s, r| {
        s.factorisations += r.factorisations;
        s.solves += r.solves;
        s.steps += r.steps;
        s.subspace = s.subspace.max(r.subspace);
        s.factor_bytes += r.factor_bytes;
        s
    })
}

/// Returns the largest memory of the process so far [MB], where the system reports it.
fn peak_memory() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    let kilobytes = line.and_then(|l| l.split_whitespace().next()?.parse::<f64>().ok());
    kilobytes.map_or(f64::NAN, |k| k / 1e3)
}

/// Returns the processor time of the process so far [s], where the system reports it; other loads do not count in it.
fn processor_s() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after_name = stat.rsplit(')').next().unwrap_or_default();
    let ticks = |i: usize| after_name.split_whitespace().nth(i)?.parse::<f64>().ok();
    // Fields 14 and 15 of the line, in hundredths of a second.
    ticks(11)
        .zip(ticks(12))
        .map_or(f64::NAN, |(user, system)| (user + system) / 100.0)
}

fn main() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../reference/calculix/modal/frequency_z24.json"
    );
    let stored: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(path).expect("stored time")).expect("JSON");
    let wall = stored["wall_s"].as_f64().expect("seconds");
    println!(
        "CalculiX: {} unknowns, {} modes, {wall} s, {} MB; {}, {}",
        stored["unknowns"],
        stored["modes"],
        stored["memory_bytes"].as_f64().unwrap_or(f64::NAN) / 1e6,
        stored["machine"],
        stored["date"]
    );
    let gear_body = body();
    for fineness in [2, 3, 4] {
        let start = Instant::now();
        let section = sector(&gear_body, &mesh(fineness)).expect("mesh");
        let meshing = start.elapsed().as_secs_f64();
        let mut best: Option<(f64, f64, cyclic::CyclicModes)> = None;
        for _ in 0..if fineness > 3 { 1 } else { 3 } {
            let (start, processor) = (Instant::now(), processor_s());
            let modes = cyclic::lowest(
                &section.as_sector(),
                &Material::STEEL,
                &Hub::fixed(),
                MODES,
                &Options::default(),
            )
            .expect("modes");
            let seconds = start.elapsed().as_secs_f64();
            if best.as_ref().is_none_or(|b| seconds < b.0) {
                best = Some((seconds, processor_s() - processor, modes));
            }
        }
        let (seconds, processor, modes) = best.expect("a run");
        let f = modes.frequencies();
        let total = sum(&modes.reports);
        let residual = modes.modes.iter().map(|m| m.residual).fold(0.0, f64::max);
        println!(
            "cyclic, fineness {fineness}: {} unknowns, {} modes {:.1} to {:.1} Hz, {seconds:.2} s (processor {processor:.2} s) \
             (mesh {meshing:.2}), CalculiX takes {:.0} times that; residual {residual:.1e}",
            modes.unknowns,
            f.len(),
            f[0],
            f[f.len() - 1],
            wall / seconds
        );
        println!(
            "    {} factorisations, {} solves, {} steps, longest basis {}; factors {:.0} MB, peak {:.0} MB",
            total.factorisations,
            total.solves,
            total.steps,
            total.subspace,
            total.factor_bytes as f64 / 1e6,
            peak_memory()
        );
    }
    for (fineness, count) in [(1, 200), (2, 50), (2, 200)] {
        let whole = gear(&gear_body, &mesh(fineness)).expect("mesh");
        let assembly = assemble(&whole.mesh, &Material::STEEL).expect("elements");
        let r = Tie::new(&whole.mesh.nodes, &whole.bore, &[]).reduce(
            &assembly,
            &[],
            MassKind::Consistent,
        );
        for block in [4, 8] {
            let options = Options {
                block: Some(block),
                ..Options::default()
            };
            let (start, processor) = (Instant::now(), processor_s());
            let modes = lowest(&r, count, &options).expect("modes");
            let seconds = start.elapsed().as_secs_f64();
            let residual = modes.residuals.iter().copied().fold(0.0, f64::max);
            println!(
                "whole mesh, fineness {fineness}: {} unknowns, {count} modes, block {block}: {seconds:.2} s (processor {:.2} s); residual {residual:.1e}",
                r.stiffness.ncols(),
                processor_s() - processor
            );
            println!(
                "    {} solves, {} steps, {} restarts, longest basis {}; factor {:.0} MB, peak {:.0} MB",
                modes.report.solves,
                modes.report.steps,
                modes.report.restarts,
                modes.report.subspace,
                modes.report.factor_bytes as f64 / 1e6,
                peak_memory()
            );
        }
    }
}

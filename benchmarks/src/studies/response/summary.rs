//! Terminal summary of a record of `response`.

use crate::messages::Messages;
use gearbench_reports::numbers::{quantity, short};
use gearbench_reports::record::Results;

/// Prints the limit of slow running and the peak of each mesh.
pub fn summarise(messages: &Messages, results: &Results) {
    for r in results.responses() {
        if r.groups.is_empty() {
            messages.print_line(&format!("{}: {}", r.label, r.message));
            continue;
        }
        messages.print_line(&format!("{}:", r.label));
        for group in &r.groups {
            for (k, limit) in group.meshes.iter().enumerate() {
                messages.print_line(&format!(
                    "  {}: force {}, stiffness {}/m, quasi-static transmission error {} um rms",
                    limit.name,
                    quantity(limit.force_n, "N", 5),
                    quantity(limit.stiffness_n_per_m, "N", 4),
                    short(1e6 * limit.error_rms_m, 4),
                ));
                let rms = |p: &&gearbench_reports::response::ResponsePoint| p.meshes[k].error_rms_m;
                // Beyond contact a response to first order is no result.
                let valid = group.points.iter().filter(|p| p.is_linear());
                let peak = valid.max_by(|a, b| rms(a).total_cmp(&rms(b)));
                if let Some(peak) = peak {
                    messages.print_line(&format!(
                        "    largest transmission error with continuous contact, at a mesh frequency of {}: {} um rms, force {} to {}",
                        quantity(peak.mesh_frequency_hz, "Hz", 5),
                        short(1e6 * peak.meshes[k].error_rms_m, 4),
                        quantity(peak.meshes[k].force_least_n, "N", 4),
                        quantity(peak.meshes[k].force_greatest_n, "N", 4),
                    ));
                }
            }
            if let (Some(f), Some([low, high])) = (group.resonance_hz, group.resonance_range_hz) {
                messages.print_line(&format!(
                    "  resonance {}, varying over the mesh cycle from {} to {}",
                    quantity(f, "Hz", 4),
                    quantity(low, "Hz", 4),
                    quantity(high, "Hz", 4),
                ));
            }
            let parts: Vec<f64> = (group.points.iter())
                .filter(|p| !p.is_linear())
                .map(|p| p.mesh_frequency_hz)
                .collect();
            if let (Some(first), Some(last)) = (parts.first(), parts.last()) {
                messages.print_line(&format!(
                    "  flanks separate at {} of {} frequencies, from {} to {}, where the response is not valid",
                    parts.len(),
                    group.points.len(),
                    quantity(*first, "Hz", 4),
                    quantity(*last, "Hz", 4),
                ));
            }
        }
    }
}

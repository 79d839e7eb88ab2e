//! Stored references as records keep them.

use gearbench_reference::ExternalReference;
use gearbench_reports::record::ReferenceSeries;
use gearbench_reports::series::TimeSeries;

/// The history of an external reference as records keep it.
pub fn external(r: &ExternalReference) -> ReferenceSeries {
    let h = &r.history;
    ReferenceSeries {
        // Records name the program; the title and source say which case.
        id: r.id.split('/').next().unwrap_or(r.id).to_string(),
        title: r.title.split(", impact").next().unwrap_or(r.title).to_string(),
        source: format!("{} ({})", r.title, r.id),
        note: "first-order bricks, faceted flanks: judge models against this discretisation, it is not converged physics"
            .into(),
        command: Some(r.regenerate.to_string()),
        cpu_s: Some(r.summary.cpu_s),
        series: TimeSeries {
            time_s: h.time.clone(),
            contact_force_n: h.contact_force.clone(),
            omega1_rad_s: h.omega1_mean.clone(),
            omega2_rad_s: h.omega2_mean.clone(),
            ..TimeSeries::default()
        },
    }
}

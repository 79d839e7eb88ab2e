//! How a run ended: one label for every way a run can go wrong.
//!
//! What an integrator says of itself ([`status_of`]) comes first; what only the whole run shows ([`judge`]) comes next:
//! energy that the integration made up, teeth that passed through each other, contacts that pull.

use super::history::History;
use super::run::{Job, approach};
use gearbench_integrators::StepError;
use gearbench_integrators::observers::ledger::Ledger;
use gearbench_models::scene::build::mesh_layout;
use gearbench_models::scene::spec::{Body, SceneSpec};
use gearbench_reports::record::Status;
use gearbench_reports::series::TimeSeries;

/// Energy that the integration may make up, over the largest energy, before a run counts as growth.
const ENERGY_GROWTH: f64 = 0.02;
/// Penetration beyond which teeth have passed through each other, in modules.
const TUNNELLING: f64 = 0.1;

/// Pull on a contact, over the peak force, before a run counts as adhesive. The interpolant of a coarse step may
/// dip a little below zero just before the contact opens; the law itself never pulls.
const ADHESION: f64 = 1e-3;
/// Made-up share of the energy at which a run is beyond saving and stops.
pub(super) const HOPELESS: f64 = 0.5;

/// The label of what an integrator says of itself.
pub fn status_of(e: &StepError) -> Status {
    match e {
        StepError::NewtonDiverged { .. } | StepError::SingularTangent { .. } => {
            Status::NewtonFailure
        }
        StepError::NonFinite { .. } => Status::BlowUp,
        StepError::StepTooSmall { .. } => Status::StepUnderflow,
        StepError::Chatter { .. } => Status::Chatter,
        StepError::Timeout { .. } | StepError::Interrupted { .. } => Status::Timeout,
        StepError::Unsupported { .. } | StepError::Library { .. } => Status::NewtonFailure,
    }
}

/// Failures that only the whole run shows.
pub fn judge(
    job: &Job<'_>,
    history: &History,
    ledger: &Ledger,
    series: &TimeSeries,
) -> Option<(Status, String)> {
    let residual = ledger.residual_relative();
    if residual > ENERGY_GROWTH || !residual.is_finite() {
        return Some((
            Status::EnergyGrowth,
            format!(
                "{:.1} % of the energy at t = {:.4e} s is made up by the integration; use a smaller step",
                residual * 100.0,
                series.time_s.last().copied().unwrap_or(0.0)
            ),
        ));
    }
    if let Some((mesh, depth)) = deepest(job.scene, series) {
        return Some((
            Status::Tunnelling,
            format!(
                "the teeth of mesh {mesh} overlap by {:.3} mm: a contact was missed",
                depth * 1e3
            ),
        ));
    }
    if history.least_normal < -ADHESION * history.peak {
        return Some((
            Status::AdhesiveForce,
            format!("a contact pulls with {:.3e} N", -history.least_normal),
        ));
    }
    None
}

/// Mesh whose teeth overlap beyond all reason, with the depth [m].
fn deepest(scene: &SceneSpec, series: &TimeSeries) -> Option<(usize, f64)> {
    let column = |name: &str| series.columns.iter().find(|c| c.name.starts_with(name));
    for (m, mesh) in scene.meshes.iter().enumerate() {
        let [a, b] = mesh.gears.map(|i| &scene.gears[i]);
        let Ok(layout) = mesh_layout(a, b) else {
            continue;
        };
        let (Some(qa), Some(qb)) = (
            column(&format!("travel_{}_", a.name)),
            column(&format!("travel_{}_", b.name)),
        ) else {
            continue;
        };
        let Body::Gear(gear) = &a.body else { continue };
        let approach = approach(mesh.start.side, [&a.body, &b.body]);
        for (x, y) in qa.values.iter().zip(&qb.values) {
            // Approach of the flanks that started `gap` apart; the others are one backlash away.
            let approach = approach(*x, *y);
            let depth =
                (approach - mesh.start.gap).max(-approach - (layout.backlash - mesh.start.gap));
            if depth > TUNNELLING * gear.params().module {
                return Some((m, depth));
            }
        }
    }
    None
}

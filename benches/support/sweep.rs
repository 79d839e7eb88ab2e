//! Work against precision: methods swept over their resolutions.

use super::ratio::{median, seconds};
use gearbench_integrators::observers::recorder::Recorder;
use gearbench_integrators::{Integrator, NullSink, Resolution, StepError, TimePlan, Work};
use gearbench_models::scene::{Channel, Scene};
use std::time::Instant;

/// Records a channel of a run on a grid.
pub fn record(
    scene: &mut Scene,
    method: &mut dyn Integrator,
    resolution: Resolution,
    grid: &[f64],
    channel: Channel,
) -> Result<Vec<f64>, StepError> {
    let index = scene.channel(channel).unwrap();
    let mut recorder = Recorder::on(grid.to_vec());
    let mut s = scene.initial();
    let plan = TimePlan::new(*grid.last().unwrap(), resolution);
    method.run(scene, &mut s, &plan, &mut recorder, &mut Work::default())?;
    Ok(recorder.column(index))
}

/// Returns the wall time of one integration [s] without output: median of at least seven, for at least 20 ms in all.
pub fn time(
    scene: &mut Scene,
    method: &mut dyn Integrator,
    resolution: Resolution,
    end: f64,
) -> (f64, Work) {
    let plan = TimePlan::new(end, resolution);
    let mut walls = Vec::new();
    let mut work = Work::default();
    let begin = Instant::now();
    while walls.len() < 7 || begin.elapsed().as_secs_f64() < 0.02 {
        let mut s = scene.initial();
        work = Work::default();
        walls.push(seconds(|| {
            let _ = method.run(scene, &mut s, &plan, &mut NullSink, &mut work);
        }));
    }
    (median(walls), work)
}

/// Returns the resolutions over which a method is swept: tolerances, or steps that start at `coarsest` [s].
pub fn sweep(adaptive: bool, coarsest: f64) -> Vec<Resolution> {
    if adaptive {
        (2..=20)
            .map(|i| Resolution::Tolerance(10f64.powf(-0.5 * f64::from(i))))
            .collect()
    } else {
        (0..12)
            .map(|i| Resolution::Step(coarsest * 0.6f64.powi(i)))
            .collect()
    }
}

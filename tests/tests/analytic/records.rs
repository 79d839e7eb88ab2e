//! Content of a record for gears and meshes: all of them, each in its unit.

use gearbench::context::Context;
use gearbench::experiment::run::{Job, run};
use gearbench_integrators::Scheme;
use gearbench_integrators::table::VELOCITY_VERLET;
use gearbench_models::geometry::Side;
use gearbench_models::spec::{Modelling, Mount, SceneSpec};
use gearbench_reports::series::TimeSeries;
use gearbench_tests::*;
use std::time::Duration;

fn history(spec: &SceneSpec) -> TimeSeries {
    let method: Scheme = VELOCITY_VERLET.at_step(2e-7);
    let modelling = Modelling {
        gears: vec![rigid(); spec.gears.len()],
        contacts: vec![contact(2e10); spec.meshes.len()],
    };
    let grid: Vec<f64> = (0..=100).map(|i| 3e-6 * f64::from(i)).collect();
    let job = Job {
        scene: spec,
        modelling: &modelling,
        context: &Context::default(),
        method: &method,
        t_end: 3e-4,
        grid: &grid,
        also_steps: false,
        forces: false,
        measurable: false,
        paths: false,
        histories: false,
        motion: false,
        pictures: None,
        events: true,
        repeats: 0,
        timeout: Duration::from_secs(600),
        max_steps: 10_000,
    };
    run(&job).unwrap().series.unwrap()
}

fn column<'s>(series: &'s TimeSeries, name: &str) -> &'s [f64] {
    let found = series.columns.iter().find(|c| c.name == name);
    &found.unwrap_or_else(|| panic!("no column {name}")).values
}

/// The speed of a rack is recorded in [m/s], and over the reference radius of its mate in [rad/s].
#[test]
fn speeds_of_racks_are_angular_where_the_record_says_so() {
    let mut spec = pair_of(
        gear("pinion", spur(20), 0.0, 20.0),
        rack("rack", 40, 0.0401, 0.3),
        start(Side::Left, 3e-6),
    );
    spec.gears[1].inertia = Some(0.4);
    spec.gears[1].mount = Mount::Prismatic;
    let series = history(&spec);
    let gearbench_models::spec::Body::Gear(pinion) = &spec.gears[0].body else {
        panic!("the pinion is a gear");
    };
    let [v, omega] = ["speed_rack_m_s", "speed_rack_rad_s"].map(|name| column(&series, name));
    let last = *v.last().unwrap();
    assert!(last.abs() > 1e-2, "{last:e}");
    for (v, omega) in v.iter().zip(omega) {
        assert_eq!(v / pinion.r_reference(), *omega);
    }
}

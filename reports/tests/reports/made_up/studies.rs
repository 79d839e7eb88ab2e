//! Made-up records of the studies of speeds and penalties.

use super::{impact, metrics_of, reference, run, study};
use gearbench_reports::columns::Columns;
use gearbench_reports::identify::{
    DataKind, DataRecord, FitRecord, IdentifyRecord, Outcome, ParameterRecord, ProfileRecord,
};
use gearbench_reports::sweep::{Bearing, ShaftOrders, StaticCycle, Steady, SweepRecord};
use gearbench_reports::tabular::{TableChart, TabularRecord};
use gearbench_reports::{Format, Ledger, Part, Results, Run, Status};
use std::f64::consts::PI;

/// Makes a sweep of two models over their mesh resonance, with one failed run.
pub fn sweep_results() -> Results {
    let (mut runs, mut statics) = (Vec::new(), Vec::new());
    let position: Vec<f64> = (0..64).map(|i| (f64::from(i) + 0.5) / 64.0 - 0.5).collect();
    for (model, resonance) in [("rigid", 6000.0), ("elastic", 5500.0)] {
        let amplitude = |k: usize, f: f64| {
            let r = f * k as f64 / resonance;
            2e-6 / (k * k) as f64 / ((1.0 - r * r).powi(2) + (0.1 * r).powi(2)).sqrt()
        };
        let cycle = |f: f64| -> Vec<f64> {
            (position.iter())
                .map(|p| {
                    let of = |k: usize| amplitude(k, f) * (2.0 * PI * k as f64 * p).cos();
                    10e-6 + (1..=12).map(of).sum::<f64>()
                })
                .collect()
        };
        let spread = |x: &[f64]| {
            x.iter().copied().fold(f64::MIN, f64::max) - x.iter().copied().fold(f64::MAX, f64::min)
        };
        let still = cycle(0.0);
        statics.push(StaticCycle {
            label: model.into(),
            force_n: 2700.0,
            position: position.clone(),
            error_peak_to_peak_m: spread(&still),
            error_m: still,
            error_mean_m: 10e-6,
            tangent_n_per_m: 2.7e8,
            resonance_hz: Some(resonance),
            resonance_range_hz: Some([0.9 * resonance, 1.1 * resonance]),
        });
        for i in 0..30 {
            let f = 500.0 + 300.0 * f64::from(i);
            let error = cycle(f);
            let harmonics: Vec<f64> = (1..=12).map(|k| amplitude(k, f)).collect();
            let peak = 2700.0 * (1.0 + 0.05e6 * spread(&error));
            let bearing = |gear: &str| Bearing {
                gear: gear.into(),
                own_inertia: model == "elastic",
                mean_n: 2700.0,
                rms_n: 1e8 * harmonics[0],
                harmonics_n: harmonics.iter().map(|a| 2e8 * a).collect(),
            };
            let mut run = Run {
                wall_s: 0.1,
                steady: Some(Steady {
                    branch: gearbench_reports::sweep::Branch::Up,
                    mesh_frequency_hz: f,
                    speed_rad_s: f / 16.0 * 2.0 * PI,
                    cycles: 8,
                    error_mean_m: 10e-6,
                    error_rms_m: (harmonics.iter().map(|a| 0.5 * a * a).sum::<f64>()).sqrt(),
                    error_peak_to_peak_m: spread(&error),
                    error_harmonics_m: harmonics.clone(),
                    error_long_peak_to_peak_m: 1e-7,
                    shaft_orders: vec![ShaftOrders {
                        gear: "pinion".into(),
                        teeth: 16,
                        error_m: (1..=36).map(|n| 1e-6 / f64::from(n)).collect(),
                    }],
                    force_mean_n: 2700.0,
                    force_peak_n: peak,
                    separated: if spread(&error) > 30e-6 { 0.2 } else { 0.0 },
                    irregular: 1e-4,
                    bearings: vec![bearing("pinion"), bearing("wheel")],
                    position: position.clone(),
                    force_cycle_n: vec![2700.0; position.len()],
                    error_cycle_m: error,
                }),
                ..run(model, "velocity-verlet", 2e-7, 0.01)
            };
            if model == "elastic" && i == 21 {
                run.status = Status::EnergyGrowth;
                run.message = Some("made up".into());
            }
            runs.push(run);
        }
    }
    let part = Part::Sweep(SweepRecord { statics });
    let mut results = study("gearbench sweep loaded_mesh", part, Vec::new(), runs);
    results.header.scene = "loaded_mesh".into();
    results
}

/// Makes a study whose results are one table: penalties that converge to hard contact; the run with the stiffest one
/// failed.
pub fn penalty_results() -> Results {
    let hard = impact(1.9e-5, 3610.0, 0.05, 1e-6);
    let columns = Columns::<(Option<f64>, Run, f64)>::of("penalty.csv", "one row per penalty")
        .model(|(_, run, _)| run.model.clone())
        .add("penalty_pa_per_m", "penalty", |(penalty, ..)| *penalty)
        .shown("Penalty", Format::Powers)
        .result()
        .status(|(_, run, _)| run.status)
        .shown("Status", Format::Text)
        .add("peak_force_n", "peak force", |(_, run, _)| {
            run.metrics[0].peak_force_n
        })
        .shown("Peak force", Format::Numbers(5))
        .result()
        .add("peak_force_off_rel", "deviation", |(_, _, off)| *off)
        .shown("Peak force, off", Format::Deviations)
        .result();
    let mut rows = Vec::new();
    for i in 0..=9 {
        let penalty = (i < 9).then(|| 1e13 * 10f64.powf(0.5 * f64::from(i)));
        let off = penalty.map_or(0.0, |p| 0.3 / (1.0 + p / 1e13));
        let series = impact(1.9e-5, 3610.0 * (1.0 - off), 0.05, 1e-6);
        let mut run = Run {
            wall_s: 1e-3,
            metrics: vec![metrics_of(&series, &Ledger::default(), &hard, "hard")],
            series: (i % 3 == 0).then_some(series),
            ..run("elastic", "trigonometric", 1e-6, 1.34e-4)
        };
        if i == 8 {
            run.status = Status::BlowUp;
            run.message = Some("made up".into());
        }
        rows.push((penalty, run, -off));
    }
    let chart = |file: &str, ordinate: &str, magnitudes: bool, limit: &str| TableChart {
        file: file.into(),
        title: format!("Made up: {file}"),
        caption: "Made up.".into(),
        abscissa: "penalty_pa_per_m".into(),
        ordinates: vec![ordinate.into()],
        magnitudes,
        limit: limit.into(),
        ..TableChart::default()
    };
    let table = TabularRecord {
        name: "penalty".into(),
        rows_are: "one row per penalty".into(),
        finding: vec!["With 1e16 Pa/m the peak force differs by 0.03\u{a0}%.".into()],
        columns: columns.recorded(),
        rows: rows.iter().map(|row| columns.recorded_row(row)).collect(),
        remark: "Off: deviation from hard contact.".into(),
        charts: vec![
            chart("penalty", "peak_force_n", false, "hard contact"),
            chart("penalty_distance", "peak_force_off_rel", true, ""),
        ],
        ..TabularRecord::default()
    };
    let runs = rows.into_iter().map(|(_, run, _)| run).collect();
    study(
        "gearbench penalty spur_impact",
        Part::Tabular(table),
        vec![reference("hard", "hard contact", &hard)],
        runs,
    )
}

/// Makes an identification: one parameter identified, one at its bound, one that the data do not determine; fitted and
/// held-out data; a profile; and numbers that are not finite.
pub fn identify_results() -> Results {
    let parameter = |key: &str, outcome: Outcome, value: Option<f64>| ParameterRecord {
        key: key.into(),
        name: key.replace('_', " "),
        unit: "N/m".into(),
        outcome,
        value,
        low: value.map(|x| 0.9 * x),
        high: Some(f64::INFINITY),
        freedom: Some(7.5),
        by_profile: outcome == Outcome::Identified,
    };
    let n = 60;
    let data = |name: &str, validation: bool, kind: DataKind| DataRecord {
        name: name.into(),
        validation,
        kind,
        weight: 1.0,
        l2: if validation { 0.05 } else { 0.03 },
        peak_rel: Some(0.01),
        impulse_rel: Some(f64::NAN),
        correlation_lag1: Some(0.9),
        noise_order: Some(3),
        abscissa: (0..n).map(|i| f64::from(i) * 1e-6).collect(),
        data: (0..n).map(|i| (f64::from(i) * PI / 60.0).sin()).collect(),
        model: (0..n)
            .map(|i| 1.03 * (f64::from(i) * PI / 60.0).sin())
            .collect(),
    };
    let fit = FitRecord {
        label: "movable-teeth".into(),
        parameters: vec![
            parameter("stiffness_n_per_m2", Outcome::Identified, Some(2.7e10)),
            parameter("tooth_damping_ns_per_m", Outcome::AtBound, Some(0.0)),
            parameter("tooth_mass_kg", Outcome::NotIdentifiable, None),
        ],
        correlation: vec![
            vec![1.0, 0.2, 0.97],
            vec![0.2, 1.0, 0.0],
            vec![0.97, 0.0, 1.0],
        ],
        condition: Some(f64::INFINITY),
        undetermined: vec!["tooth mass is not determined: made up".into()],
        data: vec![
            data("press", false, DataKind::Force),
            data("at rest", false, DataKind::Compliance),
            data("faster", true, DataKind::Force),
        ],
        profiles: vec![ProfileRecord {
            key: "stiffness_n_per_m2".into(),
            value: vec![2.4e10, 2.7e10, 3.2e10],
            deviation: vec![-2.5, 0.0, 2.2],
            quantile: 2.3,
        }],
        evaluations: 321,
        starts: 4,
        starts_agreed: 3,
    };
    let part = Part::Identify(IdentifyRecord {
        fits: vec![fit],
        ..IdentifyRecord::default()
    });
    study(
        "gearbench identify spur_impact",
        part,
        Vec::new(),
        Vec::new(),
    )
}

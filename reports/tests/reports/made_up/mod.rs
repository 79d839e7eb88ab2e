//! Made-up records: an impact with a rippling reference, and a long rotation without one.
//!
//! No number comes from a simulation: the force of a run is a half-sine with given errors, and the outlines are
//! involutes with straight roots.

mod studies;

use gearbench_reports::{
    BodyPath, ContactPoint, ContactSnapshot, FinishedRun, FlankGrid, FlankLoad, FlankPatch,
    FlankValue, FrameContacts, GearMotion, Ledger, Machine, Metric, Metrics, OUTLINE, Outline,
    Part, Quantised, ReferenceSeries, Results, Run, Status, StudyHeader, TimeSeries, Tolerance,
    ToothDisplacements, ToothedBody, compare,
};
use std::f64::consts::PI;
pub use studies::{identify_results, penalty_results, sweep_results};

/// Computes the metrics of a run whose end time is that of its history.
fn metrics_of(
    series: &TimeSeries,
    ledger: &Ledger,
    reference: &TimeSeries,
    against: &str,
) -> Metrics {
    let end = series.time_s.last().copied().unwrap_or(0.0);
    let run = FinishedRun::reached(series, ledger, [end, end]).unwrap();
    compare(run, reference, against)
}

/// Makes a run with a fixed step up to an end time.
fn run(model: &str, integrator: &str, step: f64, simulated_s: f64) -> Run {
    Run {
        model: model.into(),
        integrator: integrator.into(),
        step: Some(step),
        simulated_s,
        steps: (simulated_s / step).round() as u64,
        ..Run::default()
    }
}

/// Makes a reference that is a run of its record.
fn reference(id: &str, title: &str, series: &TimeSeries) -> ReferenceSeries {
    ReferenceSeries {
        id: id.into(),
        title: title.into(),
        source: "a run of this record".into(),
        series: series.clone(),
        ..ReferenceSeries::default()
    }
}

/// Makes a record of another study with the header of the impact.
fn study(command: &str, part: Part, references: Vec<ReferenceSeries>, runs: Vec<Run>) -> Results {
    let base = impact_results();
    Results {
        header: StudyHeader {
            command: command.into(),
            ..base.header
        },
        part,
        tolerance: None,
        references,
        runs,
        ..base
    }
}

/// Makes a series of the contact force and the speeds of a pinion and a wheel.
fn pair() -> TimeSeries {
    TimeSeries::named([
        "contact_force_pinion_wheel_n",
        "speed_pinion_rad_s",
        "speed_wheel_rad_s",
    ])
}

/// Makes a half-sine impact that starts at `start`, with ripples of relative height `ripple`.
pub fn impact(start: f64, peak: f64, ripple: f64, h: f64) -> TimeSeries {
    let (length, end) = (9.2e-5, 1.34e-4);
    let mut series = pair();
    let mut impulse = 0.0;
    for i in 0..=((end / h) as usize) {
        let t = i as f64 * h;
        let u = (t - start) / length;
        let f = if (0.0..=1.0).contains(&u) {
            let wave = ripple * (1.0 - u) * (2.0 * PI * 62e3 * (t - start)).sin();
            (peak * ((PI * u).sin() + wave * (PI * u).sin().sqrt())).max(0.0)
        } else {
            0.0
        };
        impulse += f * h;
        series.push(t, &[f, 20.0 - 134.0 * impulse, -26.3 * impulse]);
    }
    series
}

/// Makes the outline of an involute gear (module 4 mm, pressure angle 20 degrees) with a tooth at the angle `turn`.
fn outline(name: &str, z: usize, centre: f64, turn: f64) -> Outline {
    let m = 4e-3;
    let (r, ra, rf) = (
        0.5 * m * z as f64,
        m * (0.5 * z as f64 + 1.0),
        m * (0.5 * z as f64 - 1.25),
    );
    let alpha = 20f64.to_radians();
    let rb = r * alpha.cos();
    let inv = |radius: f64| {
        let x = ((radius / rb).max(1.0).powi(2) - 1.0).sqrt();
        x - x.atan()
    };
    let half = |radius: f64| 0.5 * PI / z as f64 + inv(r) - inv(radius) - 4e-4 / r;
    let mut points = Vec::new();
    for k in 0..z {
        let axis = turn + 2.0 * PI * k as f64 / z as f64;
        let mut flank: Vec<(f64, f64)> = vec![(rf, half(rb) + 0.006)];
        flank.extend((0..=24).map(|i| {
            let radius = rb.max(rf) + (ra - rb.max(rf)) * f64::from(i) / 24.0;
            (radius, half(radius))
        }));
        let right = flank.iter().map(|(radius, a)| (*radius, axis - a));
        let left = flank.iter().rev().map(|(radius, a)| (*radius, axis + a));
        points.extend(
            right
                .chain(left)
                .map(|(radius, a)| [centre + radius * a.cos(), radius * a.sin()]),
        );
    }
    Outline {
        gear: name.into(),
        points,
    }
}

/// Makes the picture of the pair 20/30 with one or two contacts on the line of action.
pub fn snapshot(forces: &[(f64, f64, &str)]) -> ContactSnapshot {
    let (aw, centre) = (20f64.to_radians(), 0.1);
    let direction = [aw.sin(), aw.cos()];
    let pitch = 0.04;
    let contacts = forces.iter().map(|(s, force, pair)| ContactPoint {
        point: [pitch + s * direction[0], s * direction[1]],
        force: [force * direction[0], force * direction[1]],
        pair: (*pair).into(),
        ..ContactPoint::default()
    });
    let end = |s: f64| [pitch + s * direction[0], s * direction[1]];
    ContactSnapshot {
        time_s: 6.31e-5,
        outlines: vec![
            outline("gear 1, z = 20", 20, 0.0, -0.5 * PI / 20.0),
            outline("gear 2, z = 30", 30, centre, PI - 0.5 * PI / 30.0),
        ],
        line_of_action: Some([end(-0.0137), end(0.0205)]),
        contacts: contacts.collect(),
        flanks: vec![flank(forces)],
        deformed: Vec::new(),
    }
}

/// Makes the motion of the pair 20/30 at three instants, helical if `helix` is not 0 [rad]: teeth of trapezoids, one contact, and
/// one tooth of the first gear displaced.
pub fn motion(helix: f64) -> GearMotion {
    let body = |name: &str, teeth: u32, reach: f64| {
        let pitch = 2.0 * PI / f64::from(teeth);
        let section = |turn: f64| {
            let root = reach - 9e-3;
            [
                (-0.5, root),
                (-0.36, root),
                (-0.15, reach),
                (0.0, reach),
                (0.15, reach),
                (0.36, root),
                (0.5, root),
            ]
            .map(|(part, r)| {
                [
                    r * (part * pitch + turn).cos(),
                    r * (part * pitch + turn).sin(),
                ]
            })
        };
        let sections = if helix == 0.0 {
            vec![section(0.0)]
        } else {
            vec![section(-helix), section(helix)]
        };
        ToothedBody {
            gear: name.into(),
            teeth,
            pitch,
            back_m: 0.01,
            heights_m: vec![-5e-3, 5e-3],
            is_prism: helix == 0.0,
            points_m: Quantised::of(&sections.concat().concat(), OUTLINE),
            ..ToothedBody::default()
        }
    };
    let path = |origin: f64, turns: [f64; 3]| BodyPath {
        axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        origin_m: [origin, 0.0, 0.0],
        turn_rad: Quantised::of(&turns, 1e-8),
        ..BodyPath::default()
    };
    let of = |values: &[f64]| Quantised::relative(values);
    GearMotion {
        view: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        bodies: vec![body("gear 1", 20, 0.044), body("gear 2", 30, 0.064)],
        time_s: vec![0.0, 6.31e-5, 1.2e-4],
        paths: vec![
            path(0.0, [0.0, 1e-3, 2e-3]),
            path(0.1, [0.0, -5e-4, -1.2e-3]),
        ],
        teeth: vec![ToothDisplacements {
            body: 0,
            rows_m: vec![0.035, 0.044],
            heights_m: vec![0.0],
            counts: vec![0, 1, 1],
            teeth: vec![0, 0],
            displacements_m: of(&[0.0, 0.0, 0.0, 2e-6, 0.0, 0.0, 0.0, 2e-6].repeat(2)),
            ..ToothDisplacements::default()
        }],
        meshes: vec![[0, 1]],
        contacts: FrameContacts {
            counts: vec![0, 1, 0],
            meshes: vec![1],
            teeth: vec![[1, 1]],
            sides: vec![0],
            points_m: of(&[0.04, 1e-3, 0.0]),
            forces_n: of(&[1200.0, 3300.0, 0.0]),
            widths_m: of(&[0.01]),
            half_widths_m: of(&[2e-4]),
            value: FlankValue::Pressure,
            values: of(&[5e8]),
        },
        ..GearMotion::default()
    }
}

/// Makes a flank with an ellipse of pressure for each force.
fn flank(forces: &[(f64, f64, &str)]) -> FlankLoad {
    let mut patches = Vec::new();
    for (tooth, (s, force, _)) in (1..).zip(forces) {
        for (i, j) in (0..9).flat_map(|i| (0..16).map(move |j| (i, j))) {
            let (u, v) = (f64::from(i) / 4.0 - 1.0, f64::from(j) / 7.5 - 1.0);
            let pressure = 5e8 * (1.0 - u * u - 0.8 * v * v).max(0.0).sqrt();
            patches.push(FlankPatch {
                tooth,
                roll_m: 0.0137 + s + 2e-4 * u,
                height_m: 4.7e-3 * v,
                size_m: [5e-5, 6.25e-4],
                force_n: force / 90.0 * pressure / 5e8,
                value: pressure,
            });
        }
    }
    let cells = (0..32).flat_map(|i| (0..16).map(move |j| (i, j)));
    FlankLoad {
        mesh: 1,
        gear: "gear 1".into(),
        side: "left".into(),
        value: FlankValue::Pressure,
        roll_m: [2e-3, 23e-3],
        width_m: [-5e-3, 5e-3],
        patches,
        over_run: Some(FlankGrid {
            instants: 40,
            rows: 32,
            columns: 16,
            values: cells
                .map(|(i, j)| {
                    if (4..28).contains(&i) {
                        1e7 * f64::from(i + j)
                    } else {
                        0.0
                    }
                })
                .collect(),
        }),
    }
}

/// Makes eighteen runs of two models, two of them failed, one inaccurate.
pub fn impact_results() -> Results {
    let reference = impact(1.9e-5, 3610.0, 0.055, 5e-7);
    let explicit = [
        ("semi-implicit-euler", 1.0, 2.1),
        ("velocity-verlet", 0.0, 2.2),
        ("rk4", 0.0, 5.1),
        ("dormand-prince", 0.0, 1.4),
    ];
    let implicit = [
        ("newmark", 0.05, 9.1),
        ("hht-alpha", 0.1, 9.6),
        ("generalised-alpha", 0.1, 9.4),
        ("bdf", 0.05, 13.0),
        ("esdirk34", 0.02, 22.0),
    ];
    let mut runs = Vec::new();
    for (model, k, ripple, cost) in [
        ("rigid", 0.0, 0.0, 1.0),
        ("movable-teeth", 1.0, 0.028, 1.46),
    ] {
        for (i, (integrator, error, work)) in explicit.iter().chain(&implicit).enumerate() {
            let adaptive = matches!(*integrator, "dormand-prince" | "bdf" | "esdirk34");
            let peak = 3660.0 - 40.0 * k + 60.0 * error;
            let series = impact(1.6e-5 + 2e-6 * k, peak, ripple, 2.5e-7);
            let wall_s = 2.3e-4 * work * cost;
            let steps = (536.0 / work) as u64;
            let energy = 0.062_041;
            let residual = -1e-4 * energy * error - 1e-9;
            let mut run = Run {
                model: model.into(),
                integrator: (*integrator).into(),
                implicit: i >= explicit.len(),
                step: (!adaptive).then_some(2.5e-7),
                rtol: adaptive.then_some(1e-6),
                wall_s,
                wall_spread_s: Some([0.94 * wall_s, 1.12 * wall_s]),
                repeats: 9,
                setup_s: 1.2e-4,
                simulated_s: 1.34e-4,
                steps,
                rejected: if adaptive { 31 } else { 0 },
                force_evaluations: 4 * steps,
                newton_iterations: if i >= explicit.len() { 3 * steps } else { 0 },
                factorisations: if i >= explicit.len() { steps / 2 } else { 0 },
                events: 2,
                dofs: 2 + 50 * (k as usize),
                calibration: Some("impact".into()),
                ledger: Ledger {
                    energy_start_j: Some(energy),
                    energy_end_j: Some(energy + residual),
                    kinetic_j: Some(energy + residual - 1e-7 * k),
                    strain_j: (k > 0.0).then_some(1e-7),
                    contact_j: Some(0.0),
                    external_work_j: Some(0.0),
                    dissipated_j: Some(0.0),
                    jumps_j: None,
                    vibrating_j: Some(0.5),
                    residual_j: Some(residual),
                    residual_rel: Some(residual / energy),
                    impulse_ns: Some(0.2105),
                    invariant_drift_rel: Some(3.1e-15),
                },
                contacts: (i < 3).then(|| snapshot(&[(0.0016, peak, "1-1")])),
                motion: (i == 0).then(|| motion(0.0)),
                ..Run::default()
            };
            run.metrics = vec![metrics_of(&series, &run.ledger, &reference, "calculix")];
            run.series = Some(series);
            runs.push(run);
        }
    }
    fail(
        &mut runs[2],
        &reference,
        Status::BlowUp,
        "speed of gear 2 not finite at t = 61.25 us (step 245, h = 0.25 us)",
    );
    fail(
        &mut runs[15],
        &reference,
        Status::NewtonFailure,
        "no convergence at t = 44.5 us, h = 0.25 us: residual 3.1e-2 N after 12 iterations",
    );
    runs[9].status = Status::Inaccurate;
    Results {
        header: StudyHeader {
            scene: "spur_impact".into(),
            title: "Impact of two steel spur gears, z = 20/30, at 20 rad/s".into(),
            command: "gearbench compare spur_impact --out out/spur_impact/compare".into(),
            machine: Machine {
                cpu: "made-up processor, 2 cores".into(),
                cores: 2,
                os: "Linux 6.1".into(),
                arch: Some("x86_64".into()),
                profile: Some("release".into()),
                note: None,
            },
            commit: "0123456789ab".into(),
            created: "2026-01-01T00:00:00Z".into(),
            ..StudyHeader::default()
        },
        settings: [
            ("gear 1", "z = 20, m = 4 mm, x = 0, b = 5 mm, steel"),
            ("gear 2", "z = 30, m = 4 mm, x = 0, b = 5 mm, steel"),
            ("centre distance", "100 mm"),
            ("initial speed of gear 1", "20 rad/s"),
            ("contact law", "linear, 15.4 N/(mm \u{b5}m), no damping"),
        ]
        .map(|(what, value)| (what.into(), value.into()))
        .to_vec(),
        tolerance: Some(Tolerance {
            metric: Metric::ForceL2Aligned,
            limit: 0.05,
            against: "calculix".into(),
            except: Vec::new(),
        }),
        references: vec![ReferenceSeries {
            id: "calculix".into(),
            title: "CalculiX 2.20, C3D8".into(),
            source: "made up: a half-sine with ripples".into(),
            note: "stands for an implicit HHT solution on a hexahedral mesh".into(),
            command: Some("ccx AF8_d05".into()),
            cpu_s: Some(243.0),
            series: reference,
            ..ReferenceSeries::default()
        }],
        runs,
        ..Results::default()
    }
}

fn fail(run: &mut Run, reference: &TimeSeries, status: Status, message: &str) {
    run.status = status;
    run.message = Some(message.into());
    run.simulated_s = 6.1e-5;
    run.wall_s *= 0.2;
    run.wall_spread_s = Some([f64::NAN, f64::INFINITY]);
    run.ledger.residual_rel = Some(f64::INFINITY);
    if let Some(series) = &mut run.series {
        for column in [0, 2] {
            for x in series.columns[column].values.iter_mut().skip(245) {
                *x = f64::NAN;
            }
        }
        run.metrics = vec![metrics_of(series, &run.ledger, reference, "calculix")];
    }
    run.metrics[0].force_l2 = Some(f64::NAN);
    run.metrics[0].peak_force_rel = Some(f64::INFINITY);
}

/// Makes a quarter of a second of rattling: hundreds of contacts, no reference, five variants.
pub fn rotation_results() -> Results {
    let mut runs = Vec::new();
    for (model, variant, scale) in [
        ("rigid", None, 1.0),
        ("movable-teeth", Some("k = 5.6e7 N/m"), 1.2),
        ("movable-teeth", Some("k = 3.6e9 N/m"), 1.25),
        ("movable-teeth", Some("k identified"), 0.95),
    ] {
        for (integrator, implicit, cost) in
            [("velocity-verlet", false, 0.01), ("newmark", true, 0.6)]
        {
            let mut s = pair();
            for i in 0..50_000 {
                let t = f64::from(i) * 5e-6;
                let wave =
                    (2.0 * PI * 318.3 * t).sin() + 0.4 * (2.0 * PI * 1190.0 * t * scale).sin();
                let f = (scale * 270.0 * (0.2 + wave)).max(0.0);
                s.push(t, &[f, 100.0 + 0.3 * wave, -66.67 + 0.2 * wave * scale]);
            }
            let ledger = Ledger {
                energy_start_j: Some(1.55),
                energy_end_j: Some(1.61),
                external_work_j: Some(0.06),
                residual_j: Some(2e-6),
                residual_rel: Some(1.3e-6),
                ..Ledger::default()
            };
            let metrics = vec![metrics_of(&s, &ledger, &s, "self")];
            runs.push(Run {
                variant: variant.map(Into::into),
                implicit,
                wall_s: cost * scale,
                repeats: 3,
                setup_s: 1e-4,
                force_evaluations: 250_001,
                dofs: 2,
                calibration: Some("static".into()),
                metrics,
                ledger,
                series: Some(s.decimated(2000)),
                contacts: Some(snapshot(&[(-0.004, 180.0, "1-1"), (0.0078, 262.0, "2-2")])),
                ..run(model, integrator, 1e-6, 0.25)
            });
        }
    }
    let command = "gearbench compare spur_rotation";
    let mut results = study(command, Part::default(), Vec::new(), runs);
    results.header.scene = "spur_rotation".into();
    results.header.title = "Rotation with backlash at 100 rad/s and 10 N m".into();
    results
}

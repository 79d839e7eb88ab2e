//! Reports of run-ups, and of paths of torque.

use crate::{finding, has_only_numbers, holds, written};
use gearbench_reports::record::{
    MemberPath, MeshForce, MeshPath, PlanetShare, Run, ShaftPath, Sharing, TorquePaths,
};
use gearbench_reports::run_up::{
    ModelRunUp, NaturalFrequency, RunUpChannel, RunUpMap, RunUpRecord, TrackedOrder,
};
use gearbench_reports::{Column, Part, Results, TimeSeries};

/// Makes a run-up whose mesh order of 16 is largest at 600 rad/s.
pub fn run_up() -> Results {
    let speeds: Vec<f64> = (0..20).map(|i| 200.0 + 50.0 * f64::from(i)).collect();
    let map = |span: f64, lines: Vec<f64>| RunUpMap {
        span,
        time_s: (0..20).map(|i| 0.05 * f64::from(i)).collect(),
        speed_rad_s: speeds.clone(),
        lines,
    };
    let orders: Vec<f64> = (0..=36).map(f64::from).collect();
    let frequencies: Vec<f64> = (0..=40).map(|i| 100.0 * f64::from(i)).collect();
    let resonance = |s: f64| 1e-6 / (0.05 + (s / 600.0 - 1.0).powi(2)).sqrt();
    let at = |line: f64, here: f64, s: f64| resonance(s) * (-(line - here).powi(2)).exp();
    let spectra = |s: &f64| {
        let here = 16.0 * s / std::f64::consts::TAU / 100.0;
        frequencies
            .iter()
            .map(|f| at(f / 100.0, here, *s))
            .collect()
    };
    let of_orders = |s: &f64| orders.iter().map(|o| at(*o, 16.0, *s)).collect();
    let found = ModelRunUp {
        label: "rigid".into(),
        gear: "pinion <a>".into(),
        turns: 138.0,
        lowest_rad_s: 200.0,
        highest_rad_s: 1150.0,
        orders: vec![
            TrackedOrder {
                name: "1x mesh".into(),
                order: 16.0,
                of_mesh: true,
            },
            TrackedOrder {
                name: "2x mesh".into(),
                order: 32.0,
                of_mesh: true,
            },
        ],
        by_time: map(0.01, frequencies.clone()),
        by_turns: map(1.0, orders.clone()),
        natural: vec![NaturalFrequency {
            frequency_hz: 1530.0,
            name: "mesh pinion - wheel".into(),
        }],
        channels: vec![RunUpChannel {
            column: "transmission_error_pinion_wheel_m".into(),
            name: "transmission error pinion - wheel".into(),
            unit: "m".into(),
            orders: vec![
                speeds.iter().map(|s| resonance(*s)).collect(),
                vec![1e-8; 20],
            ],
            spectra: speeds.iter().map(spectra).collect(),
            order_spectra: speeds.iter().map(of_orders).collect(),
        }],
        ..ModelRunUp::default()
    };
    let still = ModelRunUp {
        label: "elastic".into(),
        message: "the speed stays".into(),
        ..ModelRunUp::default()
    };
    Results {
        part: Part::RunUp(RunUpRecord {
            run_ups: vec![found, still],
        }),
        ..Results::default()
    }
}

#[test]
fn a_run_up_tells_where_its_orders_peak() {
    let files = written(&run_up());
    let names = "run_up_orders.csv run_up_spectra.csv run_up_order_spectra.csv run_up_orders_rigid.svg \
                 run_up_rigid_transmission-error-pinion-wheel-m.svg";
    holds(&files, &names.split_whitespace().collect::<Vec<_>>());
    has_only_numbers(&files);
    let page = &files["index.html"];
    let found = finding(page);
    for words in ["600", "1x mesh", "mesh pinion - wheel", "the speed stays"] {
        assert!(found.contains(words), "{words} in {found}");
    }
    assert_eq!(files["run_up_spectra.csv"].lines().count(), 1 + 20 * 41);
    assert_eq!(files["run_up_orders.csv"].lines().count(), 1 + 20 * 2);
    // Windows without their lines are refused.
    let mut broken = run_up();
    if let Part::RunUp(part) = &mut broken.part {
        part.run_ups[0].by_turns.lines.pop();
    }
    assert!(broken.validate().is_err());
}

/// Makes a record with two planets, of which one carries twice the load of the other.
pub fn trains() -> Results {
    let mesh = |a: &str, b: &str, force_n: f64| MeshPath {
        gears: [a.into(), b.into()],
        force_n,
        torque_nm: [-0.03 * force_n, 0.06 * force_n],
        power_w: 3.0 * force_n,
        share: Some(force_n / 900.0),
        rolling_w: Some(2.0 * force_n),
        loss_w: 0.1,
    };
    let share = |planet: &str, mean: f64| PlanetShare {
        planet: planet.into(),
        mean,
        least: 0.9 * mean,
        greatest: 1.1 * mean,
    };
    let time: Vec<f64> = (0..100).map(|i| 1e-4 * f64::from(i)).collect();
    let column = |name: &str, value: f64| Column {
        name: name.into(),
        values: vec![value; 100],
    };
    let run = Run {
        model: "rigid".into(),
        integrator: "dopri5".into(),
        series: Some(TimeSeries {
            columns: vec![
                column("contact_force_sun_p1_n", 600.0),
                column("contact_force_sun_p2_n", 300.0),
                column("speed_sun_rad_s", 100.0),
                column("speed_p1_rad_s", -40.0),
                column("speed_ring_rad_s", 1e-16),
            ],
            time_s: time,
            ..TimeSeries::default()
        }),
        paths: Some(TorquePaths {
            from_s: 0.005,
            to_s: 0.0099,
            change_rel: 0.02,
            input_w: 2700.0,
            meshes: vec![mesh("sun", "p1", 600.0), mesh("sun", "p2", 300.0)],
            members: vec![MemberPath {
                name: "sun".into(),
                speed_rad_s: 100.0,
                load_nm: 27.0,
                power_w: 2700.0,
                ..MemberPath::default()
            }],
            shafts: vec![ShaftPath {
                between: ["motor".into(), "sun".into()],
                torque_nm: 27.0,
                power_w: 2700.0,
            }],
            sharing: vec![Sharing {
                carrier: "arm".into(),
                gear: "sun".into(),
                planets: vec![share("p1", 2.0 / 3.0), share("p2", 1.0 / 3.0)],
                factor: 4.0 / 3.0,
                factor_greatest: 1.467,
            }],
            work_in_j: 27.0,
            work_out_j: 26.5,
            dissipated_j: 0.3,
            stored_j: 0.2,
            unexplained_j: 1e-9,
        }),
        ..Run::default()
    };
    Results {
        runs: vec![run],
        ..Results::default()
    }
}

#[test]
fn paths_of_torque_and_shares_of_planets_are_told() {
    let results = trains();
    let mut unsettled = results.runs[0].clone();
    if let Some(paths) = &mut unsettled.paths {
        (paths.change_rel, paths.meshes[0].share) = (0.4, Some(1.08));
    }
    let files = written(&results);
    // A ring that is held has no panel of its speed.
    assert!(files["speeds.svg"].contains("sun") || files["speeds.svg"].contains('\u{3c9}'));
    assert!(!files["speeds.svg"].contains("ring"));
    let names =
        "torque_paths.csv torque_members.csv torque_shafts.csv load_sharing.csv load_sharing.svg";
    holds(&files, &names.split_whitespace().collect::<Vec<_>>());
    has_only_numbers(&files);
    let page = &files["index.html"];
    for words in [
        "Paths of torque",
        "Load sharing of planets",
        "66.67",
        "1.333",
        "motor - sun",
    ] {
        assert!(page.contains(words), "{words}");
    }
    assert_eq!(files["load_sharing.csv"].lines().count(), 3);
    // No means are shown for a run that has not settled.
    let files = written(&Results {
        runs: vec![unsettled],
        ..Results::default()
    });
    let page = &files["index.html"];
    assert!(page.contains("the run has not settled, its means change by 40\u{a0}%"));
    assert!(page.contains("Balance of power") && !page.contains("Load sharing of planets"));
    assert!(
        !page.contains("of the input"),
        "no share of a run that has not settled"
    );
    assert!(!files.contains_key("torque_paths.csv") && !files.contains_key("load_sharing.svg"));
}

/// Makes a record of two models of a scene with a number of pairs whose forces and speed ratios oscillate; teeth of the
/// second model move.
fn pairs(meshes: usize) -> Results {
    let time_s: Vec<f64> = (0..200).map(|i| 1e-5 * f64::from(i)).collect();
    let swing = |size: f64, per_s: f64| -> Vec<f64> {
        time_s.iter().map(|t| size * (per_s * t).sin()).collect()
    };
    let gears: Vec<[String; 2]> = (0..meshes)
        .map(|m| [format!("p{m}"), format!("w{m}")])
        .collect();
    let run = |model: &str, size: f64| {
        let of = |m: usize, what: &str, unit: &str| {
            let [a, b] = &gears[m];
            Column {
                name: format!("{what}_{a}_{b}{unit}"),
                values: swing(size * (m + 1) as f64, 1e3 * (m + 2) as f64),
            }
        };
        let mut columns: Vec<Column> = (0..meshes)
            .flat_map(|m| [of(m, "speed_ratio_error", ""), of(m, "contact_force", "_n")])
            .collect();
        if model == "movable-teeth" {
            for what in [
                "deflection",
                "radial_force",
                "tangential_force",
                "spring_force",
            ] {
                let unit = if what == "deflection" { "rad" } else { "n" };
                columns.extend(gears[0].iter().map(|gear| Column {
                    name: format!("tooth_{what}_{gear}_{unit}"),
                    values: swing(size, 5e3),
                }));
            }
        }
        Run {
            model: model.into(),
            integrator: "rk4".into(),
            simulated_s: 2e-3,
            series: Some(TimeSeries {
                columns,
                time_s: time_s.clone(),
                forces: Vec::new(),
            }),
            mesh_forces: (gears.iter().enumerate())
                .map(|(m, gears)| MeshForce {
                    gears: gears.clone(),
                    peak_force_n: Some(size * (m + 1) as f64),
                    ripple_rms_n: Some(0.5),
                    ripple_above_hz: Some(25e3),
                    ..MeshForce::default()
                })
                .collect(),
            ..Run::default()
        }
    };
    Results {
        runs: vec![run("rigid", 100.0), run("movable-teeth", 90.0)],
        ..Results::default()
    }
}

/// Counts the occurrences of a text in a chart.
fn texts(svg: &str, text: &str) -> usize {
    svg.matches(&format!(">{text}</text>")).count()
}

/// The meshes of a model share a panel, and the legend names them, up to the number that can be distinguished; of more
/// meshes each has a panel of its own.
#[test]
fn the_meshes_of_a_model_share_a_panel() {
    let files = written(&pairs(2));
    has_only_numbers(&files);
    let (motion, force) = (&files["teeth.svg"], &files["force.svg"]);
    for svg in [motion, force] {
        assert_eq!([texts(svg, "p0 - w0"), texts(svg, "p1 - w1")], [1, 1]);
    }
    for model in ["rigid (rk4)", "movable-teeth (rk4)"] {
        assert_eq!(texts(force, model), 1, "{model}");
        let of = |what: &str| texts(motion, &format!("{what}, {model}"));
        assert_eq!(of("error of the speed ratio"), 1);
        // One model has moving teeth: both gears are in its panels.
        let moves = usize::from(model.starts_with("movable"));
        for what in [
            "deflection of a tooth, S_i \u{2212} \u{3c6}",
            "radial force F_n",
            "tangential force F_t",
            "spring force F_te",
        ] {
            assert_eq!(of(what), moves, "{what}");
        }
    }
    assert_eq!([texts(motion, "p0"), texts(motion, "w0")], [1, 1]);
    let page = &files["index.html"];
    assert!(page.contains("Forces of the meshes") && page.contains("Ripple above 25"));
    assert_eq!(files["mesh_forces.csv"].lines().count(), 1 + 4);

    let many = written(&pairs(5));
    let motion = &many["teeth.svg"];
    assert_eq!(texts(motion, "error of the speed ratio, p4 - w4"), 1);
    assert_eq!(texts(motion, "p4 - w4"), 0);
    // Models are named by the legend.
    assert_eq!(texts(motion, "rigid (rk4)"), 1);
    let force = &many["force.svg"];
    for mesh in ["p0 - w0", "p4 - w4"] {
        assert_eq!(texts(force, mesh), 1, "{mesh}");
    }
    assert_eq!(texts(force, "rigid (rk4)"), 1);
}

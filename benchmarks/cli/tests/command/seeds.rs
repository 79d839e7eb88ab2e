//! Tests of the examples in the publications that the models come from, within the axes and numbers that these print.

use super::Folder;
use gearbench_reports::metrics::Metric;
use gearbench_reports::record::{Results, Run};
use gearbench_reports::series::SPEED;

/// The record of a command, which ends with code 0.
fn record(arguments: &str) -> Results {
    let folder = Folder::new();
    folder.ends(&format!("{arguments} --out here"), 0);
    super::as_documented(&folder.at("here"));
    gearbench_reports::load_results(&folder.at("here")).unwrap()
}

/// The run of a model, by what sets it apart from others of its kind.
fn run_of<'a>(record: &'a Results, model: &str, variant: Option<&str>) -> &'a Run {
    let of = |r: &&Run| r.model == model && r.variant.as_deref() == variant;
    let found = record.runs.iter().find(of);
    found.unwrap_or_else(|| panic!("no run of {model} {variant:?}"))
}

/// A quantity of a run.
fn metric(run: &Run, metric: Metric) -> f64 {
    let found = run.metrics.iter().find_map(|m| m.get(metric));
    found.unwrap_or_else(|| panic!("{}: no {metric:?}", run.model_label()))
}

/// Ebrahimi and Eberhard 2006, Example 1: plots of the contact force over 0.25 s end at 600 N for rigid gears, at 200 N for
/// k = 5.6e7 N/m and at 600 N for k = 3.6e9 N/m. Every peak lies in the upper half of its axis.
#[test]
fn example_1_fills_the_published_axes() {
    let record = record("compare spur_rotation --integrators dopri5@1e-6 --repeats 1");
    let peaks = [
        ("rigid", None, 600.0),
        ("movable-teeth", Some("5.6e7"), 200.0),
        ("movable-teeth", Some("3.6e9"), 600.0),
    ];
    let peaks = peaks.map(|(model, variant, axis)| {
        let run = run_of(&record, model, variant);
        let peak = metric(run, Metric::PeakForce);
        assert!(
            peak > 0.5 * axis && peak < axis,
            "{model} {variant:?}: {peak} N on an axis to {axis} N"
        );
        assert_eq!(run.simulated_s, 0.25);
        peak
    });
    // The force depends on the stiffness: soft teeth make it a third, stiff ones leave it within 10 %.
    assert!(peaks[1] < 0.4 * peaks[0], "{peaks:?}");
    assert!((peaks[2] / peaks[0] - 1.0).abs() < 0.1, "{peaks:?}");
}

/// Ebrahimi and Eberhard 2006, Example 2: within 1 ms the plots end at 60 kN, show omega1 from -1 to 2 rad/s and omega2 from
/// -1.5 to 0.5 rad/s. The published times stand with the models, and the fitted teeth are nearer than unfitted ones.
#[test]
fn example_2_stays_within_the_published_axes() {
    let record = record("compare flank_contact --repeats 1");
    for run in &record.runs {
        let series = run.series.as_ref().unwrap();
        let within = |values: &[f64], [low, high]: [f64; 2]| {
            assert!(
                values.iter().all(|x| *x >= low && *x <= high),
                "{}: beyond {low} to {high}",
                run.model_label()
            );
        };
        let speeds: Vec<&[f64]> = series.all_of(SPEED).map(|(_, speed)| speed).collect();
        within(series.contact_force(), [0.0, 6e4]);
        within(speeds[0], [-1.0, 2.0]);
        within(speeds[1], [-1.5, 0.5]);
        assert!(series.contact_force().iter().any(|f| *f > 3e4));
    }
    let published = ["rigid", "movable-teeth", "fe"].map(|m| run_of(&record, m, None).published_s);
    assert_eq!(published, [Some(0.2), Some(2.0), Some(36_000.0)]);
    let error = |variant: Option<&str>| {
        let run = run_of(&record, "movable-teeth", variant);
        run.against("fe").and_then(|m| m.force_l2).unwrap()
    };
    let (fitted, unfitted) = (error(None), error(Some("3.6e9")));
    assert!(fitted < 0.05 && unfitted > 0.2, "{fitted} {unfitted}");
}

/// The rack of the steering gear: 200 truncated modes, and the cut at 80 kHz, with the modes that act in the settings.
#[test]
fn the_rack_shows_both_truncations_with_their_modes() {
    let record = record("compare rack_pinion --repeats 1");
    let setting = |what: &str| {
        let found = record.settings.iter().find(|(name, _)| name == what);
        found.unwrap_or_else(|| panic!("no {what}")).1.clone()
    };
    super::has(
        &setting("modes of elastic-truncated"),
        &["pinion 200, rack 200"],
    );
    super::has(&setting("modes of elastic-80khz"), &["pinion 13, rack 3"]);
    let error = |variant: &str| {
        let run = run_of(&record, "elastic", Some(variant));
        run.against("fe-nodes").and_then(|m| m.force_l2).unwrap()
    };
    let errors = ["nodes", "truncated", "80khz"].map(error);
    assert!(
        errors[0] < 0.005 && errors[1] < 0.1 && errors[2] > 0.4,
        "{errors:?}"
    );
    let derived: Vec<(f64, bool)> = (record.runs.iter())
        .filter_map(|r| Some((r.published_s?, r.published_derived)))
        .collect();
    assert_eq!(derived, [(84.0, true), (210.0, false), (3180.0, false)]);
}

/// Forces and deflections of movable teeth: what Ebrahimi and Eberhard call F_n, F_t, F_te and S_i - phi. The contact force is
/// the sum of its radial and tangential parts, and an undamped spring gives k r_d times the deflection.
#[test]
fn movable_teeth_report_their_forces_and_deflections() {
    let folder = Folder::new();
    let of = "--models movable-teeth --integrators dopri5@1e-8 --repeats 1";
    folder.ends(&format!("compare spur_impact {of} --out here"), 1);
    super::as_documented(&folder.at("here"));
    let text = folder.read("here/run01-movable-teeth-dopri5-pairs.csv");
    let mut lines = text.lines().map(|l| l.split(',').collect::<Vec<_>>());
    let names = lines.next().unwrap();
    let column = |name: &str| {
        let at = names.iter().position(|n| *n == name).unwrap();
        let rows = text.lines().skip(1);
        rows.map(move |l| l.split(',').nth(at).unwrap().parse().unwrap())
            .collect::<Vec<f64>>()
    };
    let force = column("pair_force_n");
    assert!(force.len() > 100);
    let largest = force.iter().fold(0.0_f64, |a, b| a.max(*b));
    // The dedendum circles carry the springs.
    for (gear, radius) in [(1, 0.035), (2, 0.055)] {
        let of = |what: &str, unit: &str| column(&format!("tooth_{what}_{gear}_{unit}"));
        let (radial, tangential) = (of("radial_force", "n"), of("tangential_force", "n"));
        let (spring, deflection) = (of("spring_force", "n"), of("deflection", "rad"));
        let stiffness: Vec<f64> = (spring.iter().zip(&deflection))
            .filter(|(f, _)| f.abs() > 0.1 * largest)
            .map(|(f, s)| -f / (radius * s))
            .collect();
        assert!(
            stiffness
                .iter()
                .all(|k| (k / stiffness[0] - 1.0).abs() < 1e-6),
            "{stiffness:?}"
        );
        assert!((7e8..9e8).contains(&stiffness[0]), "{}", stiffness[0]);
        for i in 0..force.len() {
            let sum = radial[i].hypot(tangential[i]);
            assert!(
                (sum - force[i]).abs() < 1e-8 * largest,
                "{sum} of {}",
                force[i]
            );
            // At the pitch point the force is inclined by the pressure angle.
            assert!(tangential[i].abs() > 2.0 * radial[i].abs());
        }
    }
}

/// Teeth that hammer cross their backlash from one flank to the other; the charts show it.
#[test]
fn the_place_in_the_backlash_is_drawn() {
    let folder = Folder::new();
    folder.ends(
        "compare hammer --models rigid --integrators dopri5@1e-6 --repeats 1 --out here",
        0,
    );
    let record = gearbench_reports::load_results(&folder.at("here")).unwrap();
    let series = record.runs[0].series.as_ref().unwrap();
    let column = |name: &str| series.columns.iter().find(|c| c.name == name).unwrap();
    let place = &column("backlash_position_pinion_wheel").values;
    let [least, most] = place
        .iter()
        .fold([f64::MAX, f64::MIN], |[a, b], x| [a.min(*x), b.max(*x)]);
    assert!(
        (place[0] - 0.5).abs() < 1e-9,
        "the run starts in the middle: {}",
        place[0]
    );
    // Flanks give way by some micrometres of 100.
    assert!(
        (-0.2..0.0).contains(&least) && (1.0..1.2).contains(&most),
        "{least} to {most}"
    );
    let ratio = &column("speed_ratio_error_pinion_wheel").values;
    assert!(
        (ratio[0] - (20.0 * 20.0 / (12.0 * 30.0) - 1.0)).abs() < 1e-9,
        "{}",
        ratio[0]
    );
    super::has(
        &folder.read("here/index.html"),
        &["Motion of the teeth", "place in the backlash"],
    );
}

/// The forces on movable teeth, F_n, F_t and F_te, are panels of the motion of the teeth.
#[test]
fn forces_on_movable_teeth_are_drawn() {
    let folder = Folder::new();
    let of = "--models movable-teeth --integrators dopri5@1e-6 --repeats 1";
    folder.ends(&format!("compare hammer {of} --out here"), 0);
    super::as_documented(&folder.at("here"));
    let svg = folder.read("here/teeth.svg");
    for what in [
        "deflection of a tooth, S_i \u{2212} \u{3c6}",
        "radial force F_n",
        "tangential force F_t",
        "spring force F_te",
    ] {
        let heading = format!("{what}, movable-teeth (dopri5)");
        assert_eq!(
            svg.matches(&format!(">{heading}</text>")).count(),
            1,
            "{heading}"
        );
    }
    // The radial and the tangential part make up the force of one of the two pairs in contact at the peak.
    let record = gearbench_reports::load_results(&folder.at("here")).unwrap();
    let series = record.runs[0].series.as_ref().unwrap();
    let column = |name: &str| series.column(name).unwrap();
    let force = series.contact_force();
    let most = (0..force.len())
        .max_by(|a, b| force[*a].total_cmp(&force[*b]))
        .unwrap();
    for gear in ["pinion", "wheel"] {
        let part = |what: &str| column(&format!("tooth_{what}_force_{gear}_n"))[most];
        let sum = part("radial").hypot(part("tangential"));
        assert!(
            sum > 0.4 * force[most] && sum < 1.01 * force[most],
            "{sum} {}",
            force[most]
        );
        assert!(part("spring") * part("tangential") < 0.0);
    }
}

/// The beveloid pairs of the user meeting of 2014, epsilon = speed ratio - 1: the corrected pair turns more evenly.
#[test]
fn the_corrected_beveloid_pair_turns_more_evenly() {
    let folder = Folder::new();
    let study = "compare beveloid_pairs --models rigid --integrators dopri5@1e-4 --repeats 1";
    folder.ends(&format!("{study} --out here"), 0);
    let record = gearbench_reports::load_results(&folder.at("here")).unwrap();
    let series = record.runs[0].series.as_ref().unwrap();
    let swing = |name: &str| {
        let column = series.columns.iter().find(|c| c.name == name).unwrap();
        let settled = column
            .values
            .iter()
            .zip(&series.time_s)
            .filter(|(_, t)| **t > 5e-3);
        let [least, most] = settled.fold([f64::MAX, f64::MIN], |[a, b], (x, _)| {
            [a.min(*x), b.max(*x)]
        });
        most - least
    };
    let original = swing("speed_ratio_error_pinion_wheel");
    let corrected = swing("speed_ratio_error_pinion_corrected_wheel_corrected");
    assert!(
        original > 0.015 && corrected < 0.3 * original,
        "{original} {corrected}"
    );
    // Both errors are curves of one panel, which the legend names.
    let svg = folder.read("here/teeth.svg");
    for text in [
        "pinion - wheel",
        "pinion_corrected - wheel_corrected",
        "error of the speed ratio, rigid (dopri5)",
    ] {
        assert_eq!(svg.matches(&format!(">{text}</text>")).count(), 1, "{text}");
    }
}

/// The skew gears of 2014: with misalignment the contact gets softer, so that the first impact is weaker and longer, and the
/// gears vibrate less. One command has all three pairs in one chart and one table.
#[test]
fn misalignment_softens_the_contact() {
    let folder = Folder::new();
    folder.ends("compare skew_pairs --repeats 1 --out here", 0);
    super::as_documented(&folder.at("here"));
    let record = gearbench_reports::load_results(&folder.at("here")).unwrap();
    let numbers = |model: &str| -> Vec<[f64; 3]> {
        let forces = &run_of(&record, model, None).mesh_forces;
        let of = |m: &gearbench_reports::record::MeshForce| {
            [m.peak_force_n, m.first_contact_s, m.ripple_rms_n].map(Option::unwrap)
        };
        forces.iter().map(of).collect()
    };
    let elastic = numbers("elastic");
    assert_eq!(elastic.len(), 3);
    for pair in elastic.windows(2) {
        assert!(pair[1][0] < 0.99 * pair[0][0], "peaks fall: {elastic:?}");
        assert!(
            pair[1][1] > 1.05 * pair[0][1],
            "first contacts last longer: {elastic:?}"
        );
        assert!(pair[1][2] < 0.7 * pair[0][2], "ripples fall: {elastic:?}");
    }
    let svg = folder.read("here/force.svg");
    for mesh in [
        "pinion - wheel",
        "pinion_50mdeg - wheel_50mdeg",
        "pinion_200mdeg - wheel_200mdeg",
    ] {
        assert_eq!(svg.matches(&format!(">{mesh}</text>")).count(), 1, "{mesh}");
    }
    super::has(
        &folder.read("here/index.html"),
        &["Forces of the meshes", "Ripple above 25"],
    );
}

/// The stored calibration of the first impact is what `identify` finds today, with its intervals: numbers agree to a thousandth, words
/// exactly.
#[test]
fn the_stored_calibration_is_that_of_today() {
    let folder = Folder::new();
    folder.says("init spur_impact");
    folder.ends("identify spur_impact.toml --write --force --out o", 0);
    let stored = include_str!("../../../calibrations/spur_impact.toml");
    let written = folder.read("spur_impact.calibration.toml");
    for model in ["rigid", "movable-teeth"] {
        let line = |text: &str| -> Vec<String> {
            let begin = format!("# impact: {model}: ");
            let found = text.lines().find_map(|l| l.strip_prefix(&begin));
            let found = found.unwrap_or_else(|| panic!("{begin} is missing in\n{text}"));
            found.split([' ', ',', ';']).map(str::to_owned).collect()
        };
        let (stored, found) = (line(stored), line(&written));
        assert_eq!(stored.len(), found.len(), "{stored:?} {found:?}");
        for (a, b) in stored.iter().zip(&found) {
            match (a.parse::<f64>(), b.parse::<f64>()) {
                (Ok(a), Ok(b)) => assert!((a - b).abs() <= 1e-3 * b.abs(), "{a} {b}"),
                _ => assert_eq!(a, b),
            }
        }
    }
}

//! Comparison of boxes with tooth indices: pairs found, their order, and cost.

use super::gaps::helical;
use super::*;
use gearbench_models::spec::CoarseSearch;
use std::time::Instant;

fn points(coarse: CoarseSearch) -> PointContact {
    PointContact {
        coarse,
        rule: quadrature(4, 2),
        reach: Some(6e-4),
        ..PointContact::new(1e15)
    }
}

/// Returns spur gears, helical gears, and a rack.
fn pairs() -> [SceneSpec; 3] {
    let pair = |a, b, distance| {
        let (a, b) = (gear("a", a, 0.0, 0.0), gear("b", b, distance, 0.0));
        pair_of(a, b, start(Side::Left, 5e-6))
    };
    let beta = 0.3_f64;
    let (a, b) = (helical(spur(20), beta), helical(spur(30), -beta));
    [
        pair(spur(20), spur(30), 0.1001),
        pair(a, b, 0.1001 / beta.cos()),
        pair_of(
            gear("a", spur(20), 0.0, 0.0),
            rack("r", 15, 0.04005, 0.0),
            start(Side::Left, 5e-6),
        ),
    ]
}

/// Returns numbers in [-1, 1) without a pattern.
fn random(i: u32) -> f64 {
    2.0 * (f64::from(i) * 0.754_877_666_246_692_8).fract() - 1.0
}

/// Returns candidates with a gap in a range as text, with every bit of them.
fn found(scene: &Scene, s: &State, gaps: std::ops::Range<f64>) -> Vec<String> {
    let all = candidates(scene, s).into_iter();
    all.filter(|(_, c)| gaps.contains(&c.gap))
        .map(|c| format!("{c:?}"))
        .collect()
}

/// At random poses, overlapping ones among them: all that tooth indices find is found by boxes, in the same order.
/// Where gears touch as they may, no point else is closed: the forces are the same to the last bit.
#[test]
fn boxes_find_what_tooth_indices_find() {
    for spec in pairs() {
        let own = flanked("rigid-flanks-test", 12, 4);
        for second in [flanked("rigid-flanks-test", 9, 3), rigid()] {
            let model = &second.id();
            let models = [own.clone(), second.clone()];
            let of = |coarse| build(&spec, &models, &with_points(points(coarse)));
            let indices = of(CoarseSearch::ToothIndices);
            let boxes = of(CoarseSearch::Boxes);
            let pitch = std::f64::consts::PI * 4e-3;
            let (mut count, mut closed) = (0, 0);
            for i in 1..60 {
                let mut s = roll(&spec, &indices, random(i) * 0.15);
                let apart = 0.4 * random(7 * i) * pitch;
                let second = indices.gears()[1].range().start;
                let rolled = s.q[second];
                s.q[second] += apart / effective_radius(&spec.gears[1].body);
                let all = -0.2 * pitch..f64::INFINITY;
                let (a, b) = (found(&indices, &s, all.clone()), found(&boxes, &s, all));
                let mut further = b.iter();
                assert!(
                    a.iter().all(|a| further.any(|b| a == b)),
                    "{model}, pose {i}"
                );
                count += a.len();
                s.q[second] = rolled + 0.02 * apart / effective_radius(&spec.gears[1].body);
                let all = f64::NEG_INFINITY..0.0;
                let (a, b) = (found(&indices, &s, all.clone()), found(&boxes, &s, all));
                assert_eq!(a, b, "{model}, pose {i}");
                closed += a.len();
            }
            assert!(count > 1000 && closed > 100, "{count} {closed}");
        }
    }
}

/// Tips that stand off their involutes by most of a pitch: path coordinates no longer tell where flanks are, and
/// without a choice boxes do.
#[test]
fn flanks_that_are_no_involutes_are_found_by_boxes() {
    let spec = &pairs()[0];
    let leaning = with(flanked("rigid-flanks-test", 12, 3), "lean_pitches", 0.7);
    let models = [flanked("rigid-flanks-test", 12, 3), leaning];
    let of = |coarse| build(spec, &models, &with_points(points(coarse)));
    let [indices, boxes, auto] = [
        CoarseSearch::ToothIndices,
        CoarseSearch::Boxes,
        CoarseSearch::Auto,
    ]
    .map(of);
    let mut missed = 0;
    for i in 0..40 {
        let mut s = boxes.initial();
        let second = boxes.gears()[1].range().start;
        s.q[second] += f64::from(i) / 40.0 * TAU / 30.0;
        let near = |scene| found(scene, &s, -6e-4..6e-4);
        let (by_indices, by_boxes) = (near(&indices), near(&boxes));
        assert_eq!(near(&auto), by_boxes);
        missed += usize::from(by_indices.len() < by_boxes.len());
    }
    assert!(missed > 3, "{missed} poses");
}

#[test]
#[ignore = "measures"]
fn cost_of_boxes() {
    // Few points, so that the coarse step weighs.
    let spec = &pairs()[0];
    let models = [0; 2].map(|_| flanked("rigid-flanks-test", 3, 2));
    let few = |coarse| PointContact {
        rule: quadrature(1, 1),
        reach: Some(1e-5),
        ..points(coarse)
    };
    let of = |coarse| build(spec, &models, &with_points(few(coarse)));
    let scenes = [CoarseSearch::ToothIndices, CoarseSearch::Boxes].map(of);
    let poses: Vec<State> = (0..200)
        .map(|i| roll(spec, &scenes[0], 0.15 * random(i)))
        .collect();
    let mut best = [f64::INFINITY; 2];
    let mut counts = [0; 2];
    for _ in 0..50 {
        for ((scene, best), count) in scenes.iter().zip(&mut best).zip(&mut counts) {
            let begin = Instant::now();
            *count = poses.iter().map(|s| candidates(scene, s).len()).sum();
            *best = best.min(begin.elapsed().as_secs_f64() / poses.len() as f64);
        }
    }
    println!(
        "a search by indices {:.2} us, by boxes {:.2} us: ratio {:.2}",
        1e6 * best[0],
        1e6 * best[1],
        best[1] / best[0]
    );
    assert_eq!(counts[0], counts[1]);
}

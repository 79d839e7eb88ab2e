use super::distributions::{Second, TOLERANCES};
use super::random::{Random, short};
use super::toothing::{PAIRS, RACKS};
use super::*;
use gearbench::context::Context;
use gearbench::models::models;
use gearbench::scene_file::{Origin, SceneFile};
use std::collections::BTreeSet;

/// The first numbers are those of SplitMix64 with the state 1234567, as published with its reference program.
#[test]
fn random_numbers_are_those_of_the_generator() {
    let mut r = Random::new(1_234_567);
    let expected = [
        6_457_827_717_110_365_317,
        3_203_168_211_198_807_973,
        9_817_491_932_198_370_423_u64,
    ];
    assert_eq!(expected.map(|_| r.bits()), expected);
    let units: Vec<f64> = (0..10_000).map(|_| r.unit()).collect();
    let mean = units.iter().sum::<f64>() / units.len() as f64;
    assert!(units.iter().all(|u| (0.0..1.0).contains(u)));
    // Six standard deviations of such a mean.
    assert!((mean - 0.5).abs() < 6.0 * 0.2887 / 100.0, "{mean}");
    assert_eq!(short(1.234_56e-5), 1.235e-5);
}

#[test]
fn sets_are_known_by_name_and_number() {
    let tuning = set("tuning").unwrap();
    assert_eq!((tuning.scenes, tuning.full_order), (60, 0));
    let held_out = set("held-out").unwrap();
    assert_eq!((held_out.scenes, held_out.full_order), (100, 20));
    assert_ne!(tuning.seed, held_out.seed);
    assert!(set("other").unwrap_err().to_string().contains("tuning"));
    let no = sample(&tuning, 61).unwrap_err().to_string();
    assert!(no.contains("1 to 60"), "{no}");
    assert!(sample(&tuning, 0).is_err());
}

/// A scene depends on seed and number alone, not on the scenes sampled before.
#[test]
fn scenes_are_reproducible_and_independent() {
    let tuning = set("tuning").unwrap();
    let first = sample(&tuning, 5).unwrap();
    let other = sample(&tuning, 6).unwrap();
    let again = sample(&tuning, 5).unwrap();
    assert_eq!(first.text, again.text);
    assert_ne!(first.text.replace("tuning-5", "tuning-6"), other.text);
    // Another seed is another scene.
    let moved = Set {
        seed: tuning.seed + 1,
        ..tuning
    };
    assert_ne!(sample(&moved, 5).unwrap().text, first.text);
}

/// The tuning set contains every kind, metric, tolerance and mount; few scenes had to be sampled again; rigid gears
/// move in every scene according to its kind; the file contains exactly the sampled values.
#[test]
fn tuning_scenes_are_sound_and_varied() {
    let tuning = set("tuning").unwrap();
    let all: Vec<Sample> = (1..=tuning.scenes)
        .map(|n| sample(&tuning, n).unwrap())
        .collect();
    for kind in Kind::ALL {
        let of: Vec<&Sample> = all.iter().filter(|d| d.kind == kind).collect();
        assert!(of.len() >= 10, "{} of {}", of.len(), kind.as_str());
        let metrics: BTreeSet<_> = of.iter().map(|d| d.metric).collect();
        assert_eq!(metrics.len(), kind.metrics().len(), "{metrics:?}");
    }
    for part in [
        "mount = \"fixed\"",
        "driven",
        "kind = \"rack\"",
        "damping_ns_per_m3",
        "damping_ratio",
        "torque_nm",
        "ramp",
        "viscous",
        "added_inertia",
    ] {
        assert!(all.iter().any(|d| d.text.contains(part)), "no {part}");
    }
    for tolerance in TOLERANCES {
        assert!(all.iter().any(|d| d.tolerance == tolerance));
    }
    let again: u32 = all.iter().map(|d| d.rejected).sum();
    assert!((1..=200).contains(&again), "{again} rejected");
    for d in &all {
        let (peak, contacts) = rigid::contacts(&d.scene, d.contact_time).unwrap();
        let place = format!("scene {}: {contacts:?}", d.number);
        assert!(peak > 0.0 && d.scene.duration <= LONGEST, "{place}");
        match d.kind {
            Kind::Impact => assert_eq!(contacts.len(), 1, "{place}"),
            Kind::Hammer => assert!((2..=6).contains(&contacts.len()), "{place}"),
            Kind::Load => assert!(!contacts.is_empty(), "{place}"),
        }
        let t = d.scene.tolerance.as_ref().unwrap();
        assert_eq!(
            (t.metric, t.limit, t.against.as_str()),
            (d.metric, d.tolerance, "densest")
        );
    }
}

/// The sets for validation by a refined model agree with their parameters, and rigid gears move in each scene according
/// to its kind.
#[test]
fn refined_scenes_are_as_their_set_says() {
    let tuning = set("refined-tuning").unwrap();
    let judged = set("refined").unwrap();
    assert_ne!(tuning.seed, judged.seed);
    assert_eq!(tuning.own, judged.own);
    let all: Vec<Sample> = (1..=tuning.scenes)
        .map(|n| sample(&tuning, n).unwrap())
        .collect();
    for s in &all {
        assert_eq!(s.kind == Kind::Load, s.number.is_multiple_of(3));
        assert!(!s.text.contains("damping_ns_per_m3"), "{}", s.text);
        assert_eq!(s.text.contains("damping_ratio"), s.damps_modes);
    }
    let racks = (all.iter()).filter(|s| s.text.contains("kind = \"rack\""));
    assert!(racks.count() >= 4);
    let full = full_order(&tuning).unwrap();
    assert_eq!(full.len(), tuning.full_order);
    let fit = |n: &usize| all[n - 1].kind == Kind::Impact && !all[n - 1].damps_modes;
    assert!(full.iter().all(fit));
}

/// Every pair of the list can be generated, meshed and assembled from its scene file, free and held. Reductions of
/// these meshes take minutes and are left to the validation.
#[test]
fn every_toothing_is_built() {
    use gearbench_models::scene::Scene;
    let tuning = set("tuning").unwrap();
    for toothing in PAIRS.iter().chain(&RACKS) {
        let mut r = Random::new(1);
        let mut p = loop {
            let p = parameters(&mut r, &tuning, 1).unwrap();
            if p.kind == Kind::Impact {
                break p;
            }
        };
        p.toothing = *toothing;
        p.added = [0.0; 2];
        p.backlash = 0.02 * toothing.module;
        p.gap = 2e-6;
        p.speed = [1.0, 0.0];
        for second in [Second::Free, Second::Fixed] {
            p.second = second;
            let text = text::scene(&p, None, 1e-4).unwrap();
            let file = SceneFile::unbuilt(
                &Context::default(),
                "sample.toml",
                &text,
                Origin::Shipped,
                false,
            )
            .unwrap();
            let labels: Vec<&str> = file.models.iter().map(|m| m.label.as_str()).collect();
            let expected = ["rigid", "movable-teeth", "elastic", "densest", "fe"];
            assert_eq!(labels, expected);
            for label in ["rigid", "movable-teeth", "fe"] {
                let model = file.model(label).unwrap();
                let built = Scene::build(&file.spec, &model.modelling, models());
                assert!(built.is_ok(), "{toothing:?}, {label}: {:?}", built.err());
            }
        }
    }
}

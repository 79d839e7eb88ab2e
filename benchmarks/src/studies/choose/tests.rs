//! Static calibration, candidates and domain on a coarse pair that reduces in a fraction of a second.

use super::damping::MeshModeDamping;
use super::detail::{Detail, Details};
use super::level::{Level, Stiffness};
use super::plan::{Candidate, CandidateData, InelasticLevel, elastic};
use super::problem::{ElasticSettings, Problem};
use super::requirement::Requirement;
use super::run::choose;
use super::statics::{MeshOscillator, calibrate};
use super::{domain, pilot};
use crate::context::Context;
use crate::scene_file::{Origin, SceneFile};
use crate::small_signals::mesh_mode::mesh_mode;
use crate::studies::test_scene::coarse;
use gearbench_integrators::Resolution;
use gearbench_models::spec::SurfaceKind;
use gearbench_reference::statics::{LoadedPair, StaticsError};
use gearbench_reports::{Adequacy, Metric, Verdict};
use std::collections::BTreeSet;
use std::sync::Arc;

fn problem() -> Problem {
    Problem::of(&coarse(&[
        ("modes", 30.0.into()),
        ("damping_ratio", 0.01.into()),
    ]))
}

/// Returns the scene of [`problem`] without dashpots at flank points.
fn without_dashpots() -> Problem {
    let mut s = problem();
    for c in &mut s.flexible.contacts {
        let points = c.flanks.points_mut().expect("points");
        *points = points.damped(0.0);
    }
    s
}

/// Half-spaces on the mesh of the scene are the lead, and a mesh with twice the elements along the flanks is the
/// yardstick; a scene with contact on half-spaces is itself the lead.
#[test]
fn half_spaces_lead_and_a_finer_mesh_judges() {
    let mut s = without_dashpots();
    let d = Details::of(&s, 0);
    assert_eq!(
        (d.lead.detail, &d.no_half_spaces),
        (Detail::HalfSpaces, &None)
    );
    let mesh = |f: &ElasticSettings| f.gears[0].mesh.counted();
    assert_eq!(mesh(&d.lead), [4, 2, 6, 2, 1]);
    assert_eq!(d.judge().detail, Detail::Finer);
    assert_eq!(mesh(d.judge()), [8, 4, 12, 4, 2]);
    assert!(d.on_half_spaces());
    assert!(d.setup_s(Detail::Finer) > 0.0);
    let of = |detail| d.flexible(&s, detail).detail;
    for detail in [Detail::Given, Detail::HalfSpaces, Detail::Finer] {
        assert_eq!(of(detail), detail);
    }
    s.flexible.contacts.clone_from(&d.lead.contacts);
    let d = Details::of(&s, 0);
    assert_eq!(d.lead.detail, Detail::Given);
    assert!(d.on_half_spaces() && d.finer.is_ok());
}

/// A contact that half-spaces cannot represent stays that of the scene, and an external mesh is not refined; both are
/// reported.
#[test]
fn what_cannot_be_refined_is_told() {
    let mut s = problem();
    let d = Details::of(&s, 0);
    assert_eq!(d.lead.detail, Detail::Given);
    let why = d.no_half_spaces.as_deref().expect("a reason");
    assert!(why.contains("dashpots"), "{why}");
    let finer = d.finer.as_ref().expect("a finer mesh");
    let points = |f: &ElasticSettings| f.contacts[0].flanks;
    assert_eq!(points(finer), points(&s.flexible));
    s.flexible.gears[1].reduction = Some("wheel.npz".into());
    let why = Details::of(&s, 0).finer.expect_err("a stored reduction");
    assert!(why.contains("`b`") && why.contains("wheel.npz"), "{why}");
    s.flexible.gears[1].reduction = None;
    s.flexible.gears[1].mesh.mesh = Some("wheel.inp".into());
    let why = Details::of(&s, 0).finer.expect_err("a deck");
    assert!(why.contains("`b`") && why.contains("wheel.inp"), "{why}");
}

/// The choice compares all levels with the finer mesh: its distance is the error of the scene's own mesh, the estimates
/// include it, and the chosen candidate is written with the contact and the mesh that it is for.
#[test]
fn a_choice_is_held_against_the_finer_mesh() {
    let mut s = without_dashpots();
    let requirement = Requirement {
        metric: Metric::ForceL2Aligned,
        tolerance: 0.05,
    };
    let mut told = Vec::new();
    let choice = choose(&s, &requirement, |what| told.push(what.to_string())).expect("an answer");
    let level = |detail| {
        let found = (choice.levels.iter()).filter(|l| l.level.detail() == Some(detail));
        found.max_by_key(|l| l.level.modes()).expect("a level")
    };
    let [given, lead, top] = [Detail::Given, Detail::HalfSpaces, Detail::Finer].map(level);
    assert_eq!(top.distance, 0.0);
    assert_eq!(lead.step_up, Some(lead.distance));
    assert_eq!(given.level.modes(), lead.level.modes());
    assert!(given.distance > lead.distance && lead.distance > 0.0);
    assert!(given.cheapest.is_none());
    // A quarter of the distance of twice the elements is left, the sum of all that follow a third.
    let off = choice.parts.mesh.expect("an estimate");
    assert!((off - lead.distance / 3.0).abs() < 1e-12);
    // The yardstick's own error is that of its modes, its mesh and its integration, and everything is judged by it.
    let own = choice.own_error.expect("an own error");
    let parts = choice.parts;
    let sum = parts.growth * (parts.top + off + parts.top_integration);
    assert!((own - sum).abs() < 1e-12 * sum && parts.top_integration > 0.0);
    assert_eq!(choice.yardstick.level, top.level);
    let levels = choice.levels.iter().map(|l| (l.error, l.adequate));
    let tried = choice.tried.iter().map(|t| (t.error, t.adequate));
    for (error, adequate) in levels.chain(tried) {
        assert_eq!(adequate, Adequacy::of(error, own, requirement.tolerance));
    }
    assert_eq!(choice.verdict, Verdict::Adequate);
    let setup = choice.setup_s + choice.predicted_cost_s;
    assert!((choice.total_cost_s - setup).abs() < 1e-12 * setup);
    assert!(told.iter().any(|t| t.contains("finer mesh")), "{told:?}");
    let reason = choice.reason.join(" ");
    assert!(reason.contains("local = \"half-space\""), "{reason}");
    assert!(reason.contains("twice the elements"), "{reason}");
    assert!(choice.candidate.is_some(), "{reason}");

    let p = CandidateData::of(&s).expect("a scene that runs");
    let all = p.candidates(&s);
    let file = coarse(&[("modes", 30.0.into()), ("damping_ratio", 0.01.into())]);
    for (detail, elements) in [(Detail::HalfSpaces, 4), (Detail::Finer, 8)] {
        let of = |c: &&Candidate| c.level.detail() == Some(detail);
        let candidate = all.iter().find(of).expect("a candidate");
        let text = super::chosen_scene::text(&file, candidate, &[]).expect("a scene");
        assert!(text.contains("local = \"half-space\""), "{text}");
        assert!(
            text.contains(&format!("flank_elements = {elements},")),
            "{text}"
        );
    }
    // If a mesh cannot be refined, the error bound states this.
    for g in &mut s.flexible.gears {
        g.mesh.mesh = Some("nowhere.inp".into());
    }
    assert!(Details::of(&s, 0).finer.is_err());
}

/// Windows of gears that run hold mesh cycles under the whole load, however late that is there; impacts have none.
#[test]
fn windows_reach_the_running_load() {
    let file = |load: &str, duration: f64| {
        let text = format!(
            "schema = 1\nname = \"run\"\nduration_s = {duration:e}\n[gears.a]\nteeth = 18\nmodule_m = 0.002\n\
             face_width_m = 0.006\nbore_radius_m = 0.007\nspeed_rad_s = 200.0\n{load}\n[gears.b]\nteeth = 24\n\
             module_m = 0.002\nface_width_m = 0.006\nbore_radius_m = 0.01\nmount = {{ driven = {{ speed_rad_s = -150.0 }} }}\n\
             [[meshes]]\ngears = [\"a\", \"b\"]\nbacklash_m = 80e-6\nstart = {{ flank = \"left\", gap_m = 0.0 }}\n\
             [[models]]\nmodel = \"rigid\"\ncontact = {{ stiffness = \"iso6336\", damping = {{ law = \"kelvin-voigt-ratio\", ratio = 0.05 }} }}\n"
        );
        SceneFile::unbuilt(
            &Context::default(),
            "run.toml",
            &text,
            Origin::Shipped,
            false,
        )
        .expect("a scene")
    };
    // A cycle takes 1.7 ms.
    let window = |load: &str| {
        let s = Problem::of(&file(load, 40e-3));
        let oscillator = MeshOscillator::of(&s.scene).expect("an oscillator");
        let level = InelasticLevel {
            level: Level::Rigid(Stiffness::Norm),
            scene: Arc::new(s.scene.clone()),
            modelling: Arc::new(s.own[0].modelling.clone()),
        };
        pilot::window(&s, &level, &oscillator, Metric::ForceL2).expect("a window")
    };
    let at_once = window("loads = [{ torque_nm = 5.0 }]");
    let late =
        window("loads = [{ ramp = { from_nm = 0.5, to_nm = 5.0, start_s = 0.0, end_s = 20e-3 } }]");
    assert!(!at_once.whole && at_once.end < 10e-3, "{}", at_once.end);
    assert!(late.end > 20e-3 && late.end < 28e-3, "{}", late.end);
}

/// Rigid gears with the stiffness of static solves carry what the elastic ones without modes carry, at positions and
/// approaches that were not solved for.
#[test]
fn static_solves_make_rigid_gears_as_stiff_as_elastic_ones() {
    let s = problem();
    let p = CandidateData::of(&s).expect("a scene that runs");
    let found = p.statics.clone().expect("a stiffness");
    assert!((1.0..1.5).contains(&found.exponent), "{}", found.exponent);
    let rigid = p.best_rigid();
    assert_eq!(rigid.level, Level::Rigid(Stiffness::Static));
    let pair = |m| LoadedPair::new(&s.scene, m, &s.context.models).expect("a pair");
    let (mut one, mut two) = (
        pair(&rigid.modelling),
        pair(&elastic(p.details.judge(), 0, None)),
    );
    let l = two.layout();
    let (pitch, base) = (l.pitch_point, l.base_pitch);
    let mut ratio = |part: f64| {
        let (at, approach) = (pitch + part * base, 0.7 * found.approach);
        let [a, b] = [&mut one, &mut two].map(|p| p.at_approach(at, approach).expect("rest").force);
        a / b
    };
    // Where two pairs carry they bend the same bodies, which pairs on their own do not know.
    let found = [-0.11, 0.013, -0.31, 0.22].map(&mut ratio);
    let [single @ .., two_pairs] = found;
    assert!(single.iter().all(|r| (r - 1.0).abs() < 0.02), "{found:?}");
    assert!((1.05..1.3).contains(&two_pairs), "{found:?}");
}

/// Facets of coarse flanks lie below the involute: at a small approach none of them touches, and there is no stiffness.
#[test]
fn gears_that_do_not_touch_have_no_static_stiffness() {
    let mut s = problem();
    for c in &mut s.flexible.contacts {
        c.flanks.points_mut().expect("points").surface = SurfaceKind::Faceted;
    }
    let found = calibrate(&s, &s.flexible, 1e-9);
    assert!(
        matches!(found, Err(StaticsError::NoContact { .. })),
        "{found:?}"
    );
}

/// The damper of rigid gears: of a lag that sits in the patch of contact alone a stiff pair sees a part, and modal
/// damping fills the rest.
#[test]
fn dampers_of_rigid_gears_follow_the_flanks() {
    let mut s = problem();
    let lag = 2e9 / 2e15;
    let (k, force) = (8e7, 300.0);
    let both = s.relaxation(&s.flexible, 0, k, force);
    for p in &mut s.flexible.gears {
        p.damping_ratio = None;
    }
    let flanks = s.relaxation(&s.flexible, 0, k, force);
    assert!(flanks > 0.0 && flanks < lag && both > flanks);
    // More force, larger patch, stiffer: less of the lag is seen; the cube root of the force.
    let more = s.relaxation(&s.flexible, 0, k, 8.0 * force);
    assert!((flanks / more - 2.0).abs() < 1e-9);
    assert!(s.relaxation(&s.flexible, 0, 1e12, force) == lag);
}

/// Under a load rigid gears and movable teeth vibrate in the mesh mode with the damping ratio of the elastic yardstick,
/// for any law of their contacts: of 5 % in modes and contact little remains in this mode.
#[test]
fn derived_levels_have_the_damping_of_the_mesh_mode() {
    let file = |contact: &str| {
        let gear = "module_m = 0.002\nface_width_m = 0.006\n";
        let text = format!(
            "schema = 1\nname = \"run\"\nduration_s = 1e-3\n[gears.a]\nteeth = 18\n{gear}bore_radius_m = 0.007\n\
             speed_rad_s = 200.0\nloads = [{{ torque_nm = 5.0 }}]\n[gears.b]\nteeth = 24\n{gear}bore_radius_m = 0.01\n\
             speed_rad_s = -150.0\nloads = [{{ torque_nm = 6.666666666666667 }}]\n\
             [[meshes]]\ngears = [\"a\", \"b\"]\nbacklash_m = 80e-6\nstart = {{ flank = \"left\", loaded = true }}\n\
             [[models]]\nmodel = \"elastic\"\nparameters = {{ flank_elements = 4, fillet_elements = 2, across_elements = 6, \
             rim_elements = 2, width_elements = 1, modes = 20, damping_ratio = 0.05 }}\ncontact = {{ {contact} }}\n"
        );
        SceneFile::unbuilt(
            &Context::default(),
            "run.toml",
            &text,
            Origin::Shipped,
            false,
        )
        .expect("a scene")
    };
    for contact in [
        "local = \"half-space\", damping = { law = \"ratio-at-load\", ratio = 0.05 }",
        "penalty_pa_per_m = 2e15, damping_ns_per_m3 = 2e9",
    ] {
        let s = Problem::of(&file(contact));
        let p = CandidateData::of(&s).expect("a scene that runs");
        let judge = MeshModeDamping::of(&s, &p.details).expect("a mesh mode");
        assert!((1e-4..0.02).contains(&judge.ratio), "{judge:?}");
        // Stiffness of the norm, of analytic compliance and of static solves, and movable teeth.
        assert_eq!(p.fixed.len(), 4);
        for f in &p.fixed {
            let mode =
                mesh_mode("", (&f.scene, &f.modelling), &s.context.models, 0, None).expect("loads");
            let ratio = mode.damping_ratio.expect("a ratio");
            let what = f.level.name();
            assert!((ratio / judge.ratio - 1.0).abs() < 1e-3, "{what}: {ratio}");
        }
    }
    // Without loads nothing swings about a state.
    let s = problem();
    assert_eq!(MeshModeDamping::of(&s, &Details::of(&s, 0)), None);
}

#[test]
fn candidates_are_distinct_and_go_from_cheap_to_dear() {
    let s = problem();
    let all = CandidateData::of(&s)
        .expect("a scene that runs")
        .candidates(&s);
    let names: BTreeSet<String> = all.iter().map(Candidate::name).collect();
    assert_eq!(names.len(), all.len());
    assert!(matches!(all[0].level, Level::Rigid(_)));
    assert_eq!(all[all.len() - 1].level, Level::elastic(300, Detail::Finer));
    for pair in all.windows(2) {
        let steps = [&pair[0], &pair[1]].map(|c| match c.method.resolution {
            Resolution::Step(h) => Some(h),
            Resolution::Tolerance(_) => None,
        });
        if pair[0].level == pair[1].level
            && pair[0].method.method == pair[1].method.method
            && let [Some(a), Some(b)] = steps
        {
            assert!(b < a, "{} before {}", pair[0].name(), pair[1].name());
        }
    }
}

#[test]
fn scenes_outside_of_the_domain_are_told() {
    let mut s = without_dashpots();
    let p = CandidateData::of(&s).expect("a scene that runs");
    assert_eq!(domain::outside(&s, &p), Vec::<String>::new());
    s.duration = 1.0;
    s.scene.gears[0].speed = 5000.0;
    let found = domain::outside(&s, &p).join("; ");
    assert!(found.contains("it lasts 1.000 s"), "{found}");
    assert!(found.contains("teeth of `a` pass in a second"), "{found}");
    let s = problem();
    let p = CandidateData::of(&s).expect("a scene that runs");
    let found = domain::outside(&s, &p).join("; ");
    assert!(found.contains("dashpots"), "{found}");
}

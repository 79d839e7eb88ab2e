//! Conical gears (beveloids) on axes that meet: the pair of the SIMPACK User Meeting of 2014 against an independent tooth-contact analysis.

mod elastic;
mod loaded;
mod tooth_contact;

use super::*;
use gearbench_models::geometry::{Frame, Gear};
use gearbench_models::spec::mesh_layout;
use tooth_contact::{Contact, EnvelopedFlank, touch};

/// Angle between the axes [rad].
const SHAFT_ANGLE: f64 = 10.0 * std::f64::consts::PI / 180.0;

/// Returns the pair z = 35/39, m_n = 6.5 mm, on axes that meet at 10 degrees, 1401.489 and 1400.33 mm from the middles
/// of the faces; `lead` and `profile` are crownings [m], equal on both gears.
pub fn seed_pair(lead: f64, profile: f64) -> SceneSpec {
    let params = |[teeth, shift, angle, cone, helix, width]: [f64; 6]| GearParams {
        teeth: teeth as u32,
        module: 6.5e-3,
        profile_shift: shift,
        profile_shift_angle: angle.to_radians(),
        tip_cone_angle: cone.to_radians(),
        helix_angle: helix.to_radians(),
        face_width: width,
        thinning: 1e-4,
        bore_radius: 0.04,
        modifications: Modifications {
            lead_crowning: lead,
            profile_crowning: profile,
            ..Modifications::default()
        },
        ..GearParams::default()
    };
    let mut a = gear(
        "pinion",
        params([35.0, 0.25, 5.0, 4.729, -6.0, 0.091]),
        0.0,
        2.0,
    );
    let mut b = gear(
        "wheel",
        params([39.0, 0.2, 5.8427, 5.271, 6.0, 0.085]),
        0.0,
        0.0,
    );
    a.position = [0.0, 0.0, 1.401489];
    let axis = Vec3::new(SHAFT_ANGLE.sin(), 0.0, SHAFT_ANGLE.cos());
    b.axes = turned_to(&b.axes, &axis);
    b.position = (1.40033 * axis).into();
    pair_of(a, b, start(Side::Left, 0.0))
}

fn toothing(spec: &SceneSpec, k: usize) -> &Gear {
    match &spec.gears[k].body {
        Body::Gear(gear) => gear,
        Body::Rack(_) => unreachable!("no racks here"),
    }
}

fn ratio(spec: &SceneSpec) -> f64 {
    f64::from(toothing(spec, 0).teeth()) / f64::from(toothing(spec, 1).teeth())
}

/// Returns the rotation of the second gear [rad] at which the smallest gap of a side vanishes, where the first has
/// rotated by `turn`.
fn follows(scene: &Scene, spec: &SceneSpec, side: Side, turn: f64) -> f64 {
    let rb = toothing(spec, 1).r_base();
    let cos = toothing(spec, 1).base_helix_angle().cos();
    let mut s = scene.initial();
    let [first, second] = [0, 1].map(|k| scene.gears()[k].range().start);
    s.q[first] += turn;
    let mut by = -turn * ratio(spec);
    let at_start = s.q[second];
    for _ in 0..30 {
        s.q[second] = at_start + by;
        let found = candidates(scene, &s);
        // What fades over a tip tells no distance.
        let whole = found.iter().filter(|(_, c)| c.taper >= 1.0);
        let of_side = whole.filter(|(_, c)| is_of(scene, c, side));
        let gap = of_side.map(|(_, c)| c.gap).fold(f64::INFINITY, f64::min);
        by += side.sign() * gap / (rb * cos);
        if gap.abs() < 1e-13 {
            break;
        }
    }
    by
}

fn is_of(scene: &Scene, c: &gearbench_models::contact::Candidate, side: Side) -> bool {
    scene.meshes()[0].search.flank_of(c).1 == side
}

fn built(spec: &SceneSpec, slices: usize) -> Scene {
    let mut law = contact(1.5e10);
    law.slices = Some(slices);
    build(spec, &[rigid(), rigid()], &law)
}

/// Returns the rotation of the second gear [rad] by the tooth-contact analysis; contacts have to lie on the flanks of
/// both.
fn analysed(scene: &Scene, spec: &SceneSpec, side: Side, turn: f64) -> f64 {
    let gears = [0, 1].map(|k| toothing(spec, k));
    let frames = [0, 1].map(|k| Frame {
        axes: spec.gears[k].axes,
        origin: spec.gears[k].position.into(),
    });
    let apart = frames[1].origin - frames[0].origin;
    let towards = [(0, apart), (1, -apart)].map(|(k, to): (usize, Vec3)| {
        let [x, y, _] = frames[k].axes;
        y.dot(&to).atan2(x.dot(&to))
    });
    let flanks = gears.map(|g| EnvelopedFlank::new(g, side));
    let flanks = [&flanks[0], &flanks[1]];
    // The teeth that are nearest to the mate; the angles of the first teeth are all that is taken from the scene.
    let pitch = gears.map(Gear::pitch_angle);
    let at = [turn, -turn * ratio(spec)];
    let near = [0, 1].map(|k| {
        let angle = scene.phases()[k] + at[k] - towards[k];
        angle - pitch[k] * (angle / pitch[k]).round()
    });
    let mut least = f64::INFINITY;
    for pair in -2..=2 {
        let psi = near[0] + f64::from(pair) * pitch[0];
        for other in [-1.0, 0.0, 1.0] {
            let in_front = near[1] - pitch[1] * ((near[1] + psi * ratio(spec)) / pitch[1]).round();
            let psi_mate = in_front + other * pitch[1];
            let start = Contact {
                place: [[psi, 0.0], [psi_mate, 0.0]],
                psi: psi_mate + towards[1],
            };
            let frames = [&frames[0], &frames[1]];
            let Some(found) = touch(flanks, frames, psi + towards[0], start) else {
                continue;
            };
            let by = found.psi - towards[1] - psi_mate;
            let inside = (0..2).all(|k| {
                let [turn, height] = found.place[k];
                let beyond = flanks[k].beyond(gears[k], turn, height);
                beyond.iter().all(|x| *x < 1.0)
            });
            if inside && by.abs() < 0.5 * pitch[1] {
                least = least.min(side.sign() * by);
            }
        }
    }
    at[1] + side.sign() * least
}

/// Returns the transmission error [m] at the base radius of the second gear over a mesh cycle on either side: that of
/// the scene, and its difference from the analysis.
fn over_a_cycle(scene: &Scene, spec: &SceneSpec, places: i32) -> [(f64, f64); 2] {
    let (rb, pitch) = (toothing(spec, 1).r_base(), toothing(spec, 0).pitch_angle());
    Side::BOTH.map(|side| {
        let (mut low, mut high, mut off) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
        for place in 0..=places {
            let turn = pitch * (f64::from(place) / f64::from(places) - 0.5);
            let by = follows(scene, spec, side, turn);
            let error = rb * (by + turn * ratio(spec));
            (low, high) = (low.min(error), high.max(error));
            off = off.max(rb * (by - analysed(scene, spec, side, turn)).abs());
        }
        (high - low, off)
    })
}

#[test]
fn conical_gears_without_corrections_turn_evenly() {
    let spec = seed_pair(0.0, 0.0);
    let l = mesh_layout(&spec.gears[0], &spec.gears[1]).unwrap();
    println!(
        "working pressure angle {:.3} degrees, contact ratio {:.3}, backlash {:.3e} m",
        l.working_pressure_angle.to_degrees(),
        l.contact_ratio,
        l.backlash
    );
    for (found, off) in over_a_cycle(&built(&spec, 400), &spec, 40) {
        println!("peak to peak {found:.2e} m, analysis within {off:.2e} m");
        assert!(found < 1e-8, "{found:.2e}");
        assert!(off < 1e-8, "{off:.2e}");
    }
}

#[test]
fn transmission_error_of_conical_gears_is_that_of_the_tooth_contact_analysis() {
    let mut misaligned = seed_pair(2e-5, 1e-5);
    tilt(&mut misaligned, 0, 4e-4, -3e-4);
    let mut cylindrical = seed_pair(2e-5, 1e-5);
    let mut params = toothing(&cylindrical, 1).params().clone();
    (params.profile_shift_angle, params.tip_cone_angle) = (0.0, 0.0);
    cylindrical.gears[1].body = Body::Gear(Gear::new(params).unwrap());
    // On axes at the angle of the one cone.
    let axis = Vec3::new(4.8_f64.to_radians().sin(), 0.0, 4.8_f64.to_radians().cos());
    cylindrical.gears[1].axes = turned_to(&cylindrical.gears[1].axes, &axis);
    cylindrical.gears[1].position = [0.2475, 0.0, 1.41];
    for (name, spec) in [
        ("crowned", seed_pair(2e-5, 1e-5)),
        ("crowned and misaligned", misaligned),
        ("with a cylindrical wheel", cylindrical),
    ] {
        for (found, off) in over_a_cycle(&built(&spec, 300), &spec, 24) {
            println!("{name}: peak to peak {found:.3e} m, analysis within {off:.2e} m");
            assert!(found > 1e-6, "{name}: {found:.2e}");
            assert!(off < 1e-7, "{name}: {off:.2e}");
        }
    }
}

//! Meshed flanks of conical gears: their gaps beside the helicoids and the tooth-contact analysis, reduced gears beside full
//! finite elements, and cones that become cylinders.

use super::super::elastic::on_points;
use super::*;
use gearbench_integrators::{AcceptedStep, Control, Resolution, SecondOrderSystem, Sink, TimePlan};
use gearbench_models::contact::Candidate;
use gearbench_models::spec::{
    ContactSpec, FlankContact, ModelSpec, Modelling, PointContact, PointRule,
};
use gearbench_reference::statics::LoadedPair;

/// Returns a model on a mesh with a number of elements along the flank and over the width.
fn meshed(id: &str, flank: f64, width: f64, modes: Option<f64>) -> ModelSpec {
    let counts = [
        ("flank_elements", flank),
        ("fillet_elements", 2.0),
        ("across_elements", 4.0),
        ("rim_elements", 2.0),
        ("width_elements", width),
    ];
    let modes = modes.map(|n| ("modes", n));
    let all = counts.into_iter().chain(modes);
    model_of(id, all)
}

/// Returns a contact with a number of points of a face along the profile and over the width.
fn points(along: usize, across: usize) -> ContactSpec {
    let mut law = on_points(0.0);
    law.flanks = FlankContact::Points(PointContact {
        rule: PointRule::Quadrature { along, across },
        reach: Some(1.5e-3),
        ..PointContact::new(1e15)
    });
    law
}

/// Returns the distance of a point of one gear from the helicoid of the other, gear `k` [m].
fn exact_gap(spec: &SceneSpec, scene: &Scene, s: &State, k: usize, c: &Candidate) -> f64 {
    let g = &scene.gears()[k];
    let frame = Frame {
        axes: spec.gears[k].axes,
        origin: spec.gears[k].position.into(),
    };
    let side = scene.meshes()[0].search.flank_of(c).1;
    let tooth = c.points[k].tooth.index as f64 * toothing(spec, k).pitch_angle();
    let psi = scene.phases()[k] + s.q[g.range().start] + tooth;
    let x = frame.point_back(&c.points[1 - k].x);
    toothing(spec, k)
        .flank(side)
        .near(psi, &x, &gearbench_models::geometry::PlaneAngle::new(0.0))
        .distance
}

#[test]
fn gaps_of_meshed_cones_are_distances_from_their_helicoids() {
    let spec = seed_pair(0.0, 0.0);
    let mesh = || meshed("elastic", 20.0, 8.0, Some(2.0));
    for (name, models) in [
        ("both meshed", [mesh(), mesh()]),
        ("on a rigid gear", [mesh(), rigid()]),
    ] {
        let scene = build(&spec, &models, &points(4, 2));
        let (mut worst, mut count) = ([0.0_f64; 2], 0);
        for place in 0..9 {
            let mut s = scene.initial();
            let turn = 0.18 * (f64::from(place) / 8.0 - 0.5);
            s.q[scene.gears()[0].range().start] += turn;
            s.q[scene.gears()[1].range().start] -= turn * ratio(&spec);
            for (_, c) in candidates(&scene, &s) {
                // Gaps that fade over a tip are no distances.
                if c.taper < 1.0 || c.gap.abs() > 5e-5 {
                    continue;
                }
                // A point of either gear lies on its own flank and off that of the other.
                let gaps = [0, 1].map(|k| exact_gap(&spec, &scene, &s, k, &c));
                let off = gaps.map(|gap| (gap - c.gap).abs());
                worst[0] = worst[0].max(off[0].min(off[1]));
                count += 1;
            }
        }
        println!("{name}: {count} gaps off by {:.1e} m", worst[0]);
        assert!(count > 300, "{name}: {count} candidates");
        assert!(worst[0] < 2e-8, "{name}: {:.2e}", worst[0]);
    }
}

#[test]
fn transmission_error_of_meshed_cones_is_that_of_the_tooth_contact_analysis() {
    let spec = seed_pair(2e-5, 1e-5);
    let mesh = || meshed("elastic", 20.0, 8.0, Some(2.0));
    let scene = build(&spec, &[mesh(), mesh()], &points(8, 10));
    for (found, off) in over_a_cycle(&scene, &spec, 4) {
        println!("meshed: peak to peak {found:.3e} m, analysis within {off:.2e} m");
        // Points stand beside the point of contact, half a tenth of a millimetre along the profile and one over the width.
        assert!(found > 1e-6, "{found:.2e}");
        assert!(off < 1e-7, "{off:.2e}");
    }
}

/// Returns a small pair, 20 on 24 teeth of module 4 mm, 12 mm wide, on axes that meet at 10 degrees.
fn small_pair(gap: f64) -> SceneSpec {
    let cone = [4.544_f64, 5.456];
    let params = |k: usize, teeth: u32| GearParams {
        teeth,
        module: 4e-3,
        profile_shift: 0.2,
        profile_shift_angle: cone[k].to_radians(),
        tip_cone_angle: cone[k].to_radians(),
        face_width: 0.012,
        thinning: 1e-4,
        bore_radius: 0.015,
        ..GearParams::default()
    };
    let mut a = gear("pinion", params(0, 20), 0.0, 10.0);
    let mut b = gear("wheel", params(1, 24), 0.0, 0.0);
    // Cones of the sums of profile shifts; both from where the axes meet.
    a.position = [0.0, 0.0, 0.5135];
    let axis = Vec3::new(SHAFT_ANGLE.sin(), 0.0, SHAFT_ANGLE.cos());
    b.axes = turned_to(&b.axes, &axis);
    b.position = (0.5128 * axis).into();
    pair_of(a, b, start(Side::Left, gap))
}

const COARSE: [f64; 2] = [6.0, 3.0];

/// Where the flanks touch `fe` moves in all directions, reduced gears along their normals: some thousandths, as of cylinders.
#[test]
fn static_forces_of_elastic_cones_are_those_of_finite_elements() {
    let solved = |spec: &SceneSpec, model: ModelSpec, approach: f64| {
        let modelling = Modelling {
            gears: vec![model.clone(), model],
            contacts: vec![on_points(0.0)],
        };
        let models = gearbench::models::models();
        let mut pair = LoadedPair::new(spec, &modelling, models).unwrap();
        let layout = pair.layout();
        let (middle, pitch) = (layout.pitch_point, layout.base_pitch);
        [-0.3, 0.0, 0.25].map(|at| {
            let found = pair.at_approach(middle + at * pitch, approach).unwrap();
            found.force
        })
    };
    let [flank, width] = COARSE;
    for (name, spec) in [
        ("cones", small_pair(0.0)),
        ("cylinders", helical_pair(0.1, 0.0, false)),
    ] {
        for approach in [1e-5, 3e-5] {
            let full = solved(&spec, meshed("fe", flank, width, None), approach);
            let reduced = |modes| {
                solved(
                    &spec,
                    meshed("elastic", flank, width, Some(modes)),
                    approach,
                )
            };
            let (few, many) = (reduced(10.0), reduced(40.0));
            for ((a, b), c) in full.into_iter().zip(many).zip(few) {
                println!(
                    "{name}, approach {approach:.0e} m: fe {a:.4} N, elastic {b:.4} N, {:+.1e}, fewer modes {:+.1e}",
                    b / a - 1.0,
                    c / b - 1.0
                );
                assert!(a > 100.0 && (b / a - 1.0).abs() < 8e-3, "{name}: {a} {b}");
                assert!((c / b - 1.0).abs() < 1e-6, "{name}: {b} {c}");
            }
        }
    }
}

/// Sink that records the force of the mesh at accepted steps.
#[derive(Default)]
struct History(Vec<f64>, Outputs);

impl Sink for History {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        sys.output(step.to.at(), &mut self.1);
        self.0.push(self.1.channels[0]);
        Control::Continue
    }
}

fn history(spec: &SceneSpec, model: &ModelSpec, method: &str, end: f64) -> Vec<f64> {
    let mut scene = build(spec, &[model.clone(), model.clone()], &on_points(0.0));
    let s = scene.initial();
    let mut found = History::default();
    let plan = TimePlan::new(end, Resolution::Step(1e-6));
    watched(&mut scene, s, method, &plan, &mut found);
    found.0
}

#[test]
fn an_impact_of_elastic_cones_is_that_of_finite_elements() {
    let spec = small_pair(1e-6);
    let [flank, width] = COARSE;
    let full = history(&spec, &meshed("fe", flank, width, None), "newmark", 1.6e-4);
    for (modes, limit) in [(100.0, 0.02), (200.0, 0.01)] {
        let model = meshed("elastic", flank, width, Some(modes));
        let reduced = history(&spec, &model, "trigonometric", 1.6e-4);
        assert_eq!(full.len(), reduced.len());
        let square = |x: &mut dyn Iterator<Item = f64>| x.map(|x| x * x).sum::<f64>().sqrt();
        let size = square(&mut full.iter().copied());
        let off = square(&mut full.iter().zip(&reduced).map(|(a, b)| a - b)) / size;
        let impulse = reduced.iter().sum::<f64>() / full.iter().sum::<f64>() - 1.0;
        let peak = full.iter().fold(0.0, |m: f64, x| m.max(*x));
        println!(
            "{modes} modes: force history {:.2} %, impulse {:+.3} %, peak {peak:.0} N",
            100.0 * off,
            100.0 * impulse
        );
        assert!(peak > 500.0 && off < limit && impulse.abs() < 2e-3);
    }
}

/// Forces of a helical pair whose profile shifts grow by an angle, one up and one down the axis, at places where its teeth
/// stand as those of the cylindrical pair do: where cones are next to none, path coordinates are told by any section.
#[test]
fn cones_without_angle_are_cylinders() {
    let pair = |angle: f64| {
        let mut spec = helical_pair(0.2, 0.0, false);
        for (gear, sign) in spec.gears.iter_mut().zip([1.0, -1.0]) {
            let Body::Gear(g) = &gear.body else {
                unreachable!("no racks here")
            };
            let params = GearParams {
                profile_shift_angle: sign * angle,
                tip_cone_angle: sign * angle,
                ..g.params().clone()
            };
            gear.body = Body::Gear(Gear::new(params).unwrap());
        }
        let model = meshed("elastic", 5.0, 3.0, Some(10.0));
        let scene = build(&spec, &[model.clone(), model], &on_points(0.0));
        (spec, scene)
    };
    let force = |(spec, scene): &mut (SceneSpec, Scene), phases: &[f64]| {
        let forces = (0..5).map(|place| {
            let mut s = scene.initial();
            let roll = 0.05 * f64::from(place);
            for (k, by) in [roll, -roll * ratio(spec) + 4e-4].into_iter().enumerate() {
                let at = scene.gears()[k].range().start;
                s.q[at] += by + phases[k] - scene.phases()[k];
            }
            let all = scene.contact_forces(s.at());
            all.iter().map(|c| c.normal_force).sum::<f64>()
        });
        forces.collect::<Vec<f64>>()
    };
    let mut cylinder = pair(0.0);
    let phases = cylinder.1.phases().to_vec();
    let expected = force(&mut cylinder, &phases);
    for (angle, limit) in [(1e-6, 1e-5), (1e-9, 1e-8)] {
        let found = force(&mut pair(angle), &phases);
        for (a, b) in expected.iter().zip(&found) {
            println!(
                "{angle:.0e} rad: {b:.6} N beside {a:.6} N, {:+.1e}",
                b / a - 1.0
            );
            assert!(*a > 100.0 && (b / a - 1.0).abs() < limit, "{a} {b}");
        }
    }
}

#[test]
fn half_spaces_stay_with_cylindrical_gears() {
    let model = meshed("elastic", 5.0, 3.0, Some(2.0));
    let mut law = on_points(0.0);
    law.flanks = FlankContact::HalfSpace;
    let refused = try_build(&small_pair(0.0), &[model.clone(), model], &law);
    let why = refused.err().expect("it is refused").to_string();
    assert!(why.contains("conical") || why.contains("about z"), "{why}");
}

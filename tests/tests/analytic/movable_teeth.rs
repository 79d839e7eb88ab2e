//! Movable teeth with closed-form deviations of the teeth out of contact, compared with all teeth integrated.

use gearbench::context::Context;
use gearbench::scene_file::{Origin, SceneFile};
use gearbench_integrators::observers::ledger::Ledger;
use gearbench_integrators::{
    AcceptedStep, Control, Outputs, Resolution, SecondOrderSystem, Sink, State, TimePlan,
};
use gearbench_models::geometry::Side;
use gearbench_models::law::Damping;
use gearbench_models::scene::OfMesh;
use gearbench_models::scene::Scene;
use gearbench_models::spec::{ContactSpec, Load, ModelSpec, Mount, Profile, SceneSpec};
use gearbench_tests::*;

const K: f64 = 5.3e8;
const M: f64 = 4.8e-3;

/// Sink that records momentum, energy, hub motion and force of a scene at the ends of accepted steps on a grid.
struct Watch {
    out: Outputs,
    every: f64,
    next: f64,
    rows: Vec<Vec<f64>>,
    /// Largest relative jump of momenta and energy where coordinates were handed over.
    jump: f64,
    handovers: usize,
}

impl Watch {
    fn every(every: f64) -> Self {
        Watch {
            out: Outputs::default(),
            every,
            next: 0.0,
            rows: Vec::new(),
            jump: 0.0,
            handovers: 0,
        }
    }
}

impl Sink for Watch {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        while self.next <= step.to.t {
            let h = step.to.t - step.from.t;
            let mut s = step.from.clone();
            step.dense
                .eval((self.next - step.from.t) / h, &mut s.q, &mut s.v);
            s.t = self.next;
            sys.output(s.at(), &mut self.out);
            let mut row = vec![self.out.energy.total()];
            row.extend(&self.out.channels);
            self.rows.push(row);
            self.next += self.every;
        }
        Control::Continue
    }

    fn restarted(&mut self, sys: &mut dyn SecondOrderSystem, before: &State, after: &State) {
        if before.q == after.q {
            return;
        }
        self.handovers += 1;
        sys.output(before.at(), &mut self.out);
        let (e, momenta) = (self.out.energy.total(), self.out.channels.clone());
        sys.output(after.at(), &mut self.out);
        self.jump = self.jump.max((self.out.energy.total() / e - 1.0).abs());
        let names = sys.channels().iter();
        for ((a, b), name) in momenta
            .iter()
            .zip(&self.out.channels)
            .zip(names)
            .skip(OfMesh::ALL.len())
        {
            // Speeds, displacements and torques of the gears. Mounts answer to tooth deflections, differences of angles
            // that grow with every turn: their rounding is larger.
            let answer = name.starts_with("bearing") || name.starts_with("mount");
            let rounding = if answer { 100.0 } else { 1.0 };
            self.jump = self.jump.max((a - b).abs() / (1.0 + a.abs()) / rounding);
        }
    }
}

fn watch(
    spec: &SceneSpec,
    models: &[ModelSpec],
    contact: &ContactSpec,
    t_end: f64,
    rtol: f64,
) -> (Watch, State, Scene) {
    let mut scene = build(spec, models, contact);
    let start = scene.initial();
    let mut w = Watch::every(t_end / 400.0);
    let plan = TimePlan::new(t_end, Resolution::Tolerance(rtol));
    let (s, _) = watched(&mut scene, start, "dopri5", &plan, &mut w);
    (w, s, scene)
}

/// Returns the largest difference of two records, channel by channel, relative to the largest value of the channel.
fn difference(a: &Watch, b: &Watch) -> f64 {
    assert_eq!(a.rows.len(), b.rows.len());
    let columns = a.rows[0].len();
    (0..columns)
        .map(|c| {
            let size = a.rows.iter().fold(1e-9_f64, |m, r| m.max(r[c].abs()));
            a.rows
                .iter()
                .zip(&b.rows)
                .fold(0.0_f64, |m, (x, y)| m.max((x[c] - y[c]).abs()))
                / size
        })
        .fold(0.0, f64::max)
}

/// Returns a pinion that drives against a load on the wheel, in either direction of rotation.
pub fn loaded(direction: f64, speed: f64, torque: f64) -> SceneSpec {
    let side = if direction > 0.0 {
        Side::Left
    } else {
        Side::Right
    };
    let mut spec = case_a(0.0);
    spec.meshes[0].start = start(side, 2e-6);
    spec.gears[0].speed = direction * speed;
    spec.gears[1].speed = -direction * speed / 1.5;
    spec.gears[0].loads = vec![Load::Applied(Profile::Constant(direction * torque))];
    spec.gears[1].loads = vec![Load::Applied(Profile::Constant(direction * torque * 1.5))];
    spec
}

#[test]
fn active_teeth_equal_all_teeth_over_an_impact() {
    for damping in [0.0, 60.0] {
        let teeth = movable(K, M, damping);
        let (few, s, _) = watch(
            &case_a(3.3e-6),
            &[teeth.clone(), teeth.clone()],
            &contact(5e10),
            3e-4,
            1e-10,
        );
        let all = all_teeth(teeth);
        let (every, t, _) = watch(
            &case_a(3.3e-6),
            &[all.clone(), all],
            &contact(5e10),
            3e-4,
            1e-10,
        );
        assert!(
            s.q.len() < 20 && t.q.len() == 52,
            "{} and {} coordinates",
            s.q.len(),
            t.q.len()
        );
        let d = difference(&few, &every);
        assert!(d < 1e-6, "damping {damping}: histories differ by {d:.2e}");
    }
}

/// Returns a contact with so much damping that motion under load becomes independent of its start, so that long runs
/// can be compared.
fn damped(per_width: f64) -> ContactSpec {
    ContactSpec {
        damping: Damping::KelvinVoigtRatio { ratio: 0.1 },
        ..contact(per_width)
    }
}

#[test]
fn active_teeth_equal_all_teeth_over_revolutions_under_load() {
    for direction in [1.0, -1.0] {
        let mut spec = loaded(direction, 300.0, 80.0);
        // The pinion is driven, so the load cannot run away.
        spec.gears[0].mount = Mount::Driven(Profile::Constant(direction * 300.0));
        let t_end = 2.3 * std::f64::consts::TAU / 300.0;
        let teeth = movable(1e8, M, 150.0);
        let run =
            |m: ModelSpec, rtol: f64| watch(&spec, &[m.clone(), m], &damped(5e9), t_end, rtol);
        let (few, s, scene) = run(teeth.clone(), 1e-9);
        let (every, _, _) = run(all_teeth(teeth.clone()), 1e-9);
        let (again, _, _) = run(teeth, 1e-10);
        let (d, own) = (difference(&few, &every), difference(&few, &again));
        println!(
            "direction {direction}: {} handovers, jump {:.1e}, active to all {d:.2e}, own error {own:.2e}",
            few.handovers, few.jump
        );
        // 46 of the pinion and as many of the wheel.
        assert!(few.handovers > 80, "{} handovers", few.handovers);
        assert!(
            few.jump < 1e-12,
            "momentum or energy jumps by {:.2e} at a handover",
            few.jump
        );
        assert!(
            d < 10.0 * own.max(1e-8) && d < 1e-4,
            "histories differ by {d:.2e}, own error {own:.2e}"
        );
        let wheel = s.q[scene.gears()[1].range().start];
        assert!(-wheel * direction > 1.5 * std::f64::consts::TAU, "{wheel}");
    }
}

/// Returns an idler between two gears, driven by the first against a load on the last.
fn train(torque: f64) -> SceneSpec {
    let mut first = gear("first", spur(20), 0.0, 200.0);
    first.loads = vec![Load::Applied(Profile::Constant(torque))];
    let idler = gear("idler", spur(30), 0.1001, -200.0 / 1.5);
    let mut last = gear("last", spur(20), 0.1001, 200.0);
    last.position = [0.1001, 0.1001, 0.0];
    last.loads = vec![Load::Applied(Profile::Constant(-torque))];
    SceneSpec {
        duration: f64::INFINITY,
        gears: vec![first, idler, last],
        meshes: vec![
            mesh([0, 1], start(Side::Left, 2e-6)),
            mesh([1, 2], start(Side::Right, 2e-6)),
        ],
        shafts: vec![],
        stages: Vec::new(),
    }
}

#[test]
fn an_idler_has_two_windows() {
    let t_end = 0.01;
    let run = |m: ModelSpec, rtol: f64| {
        watch(
            &train(20.0),
            &[m.clone(), m.clone(), m],
            &damped(5e9),
            t_end,
            rtol,
        )
    };
    // Little damping: teeth still ring when they leave their window.
    let teeth = movable(1e8, M, 30.0);
    let (few, s, scene) = run(teeth.clone(), 1e-9);
    let (every, _, _) = run(all_teeth(teeth.clone()), 1e-9);
    let (again, _, _) = run(teeth, 1e-10);
    let idler = scene.gears()[1].range().len();
    assert!(idler < 20, "{idler} coordinates of the idler");
    assert!(
        few.handovers > 8 && few.jump < 1e-12,
        "{} handovers, jump {:.2e}",
        few.handovers,
        few.jump
    );
    let (d, own) = (difference(&few, &every), difference(&few, &again));
    println!("idler: active to all {d:.2e}, own error {own:.2e}");
    assert!(
        d < 10.0 * own.max(1e-8),
        "histories differ by {d:.2e} over {:.3} rad, own error {own:.2e}",
        s.q[0]
    );
}

#[test]
fn all_teeth_are_integrated_where_windows_do_not_fit() {
    let coordinates = |spec: &SceneSpec, models: &[ModelSpec], i: usize| {
        build(spec, models, &contact(1e10)).gears()[i].range().len()
    };
    let teeth = movable(K, M, 0.0);
    let pair = [teeth.clone(), teeth.clone()];
    assert!(coordinates(&case_a(3e-6), &pair, 0) < 10);
    // Unequal teeth.
    let mut k = vec![K; 20];
    k[3] *= 0.5;
    let cracked = with(teeth.clone(), "tooth_stiffness_n_per_m", k);
    assert_eq!(coordinates(&case_a(3e-6), &[cracked, rigid()], 0), 21);
    // Two meshes side by side on a small idler: the windows would overlap.
    let mut close = train(0.0);
    close.gears[0] = gear("first", spur(30), 0.0, 0.0);
    close.gears[1] = gear("idler", spur(14 + 6), 0.1001, 0.0);
    let angle = 100f64.to_radians();
    close.gears[2] = gear("last", spur(30), 0.0, 0.0);
    close.gears[2].position = [0.1001 - 0.1001 * angle.cos(), 0.1001 * angle.sin(), 0.0];
    let three = [
        teeth.clone(),
        with(teeth.clone(), "tooth_mass_kg", 1e-3),
        teeth,
    ];
    let n = coordinates(&close, &three, 1);
    let small = 0.1001 - 0.1001 * 40f64.to_radians().cos();
    close.gears[2].position = [small, 0.1001 * 40f64.to_radians().sin(), 0.0];
    let tight = coordinates(&close, &three, 1);
    assert!(
        n < 21 && tight == 21,
        "{n} coordinates apart, {tight} close together"
    );
}

#[test]
fn the_cost_does_not_grow_with_the_number_of_teeth() {
    let n = |z: u32| {
        let params = spur(z);
        let x = 0.5 * 4e-3 * f64::from(z + 30) + 1e-4;
        let spec = pair_of(
            gear("a", params, 0.0, 1.0),
            gear("b", spur(30), x, 0.0),
            start(Side::Left, 3e-6),
        );
        let small = movable(K, 1e-4, 0.0);
        build(&spec, &[small.clone(), small], &contact(1e10)).gears()[0]
            .range()
            .len()
    };
    assert!(n(200) <= n(25) + 2, "{} against {}", n(200), n(25));
}

/// Large gears at 1.2 MN of tooth force, 4 % of the module of deflection: no tooth in contact is handed over, so that
/// the energy has no jump, and the losses of both methods are equal.
#[test]
fn active_teeth_equal_all_teeth_at_a_meganewton() {
    let text = "schema = 1\nname = \"big\"\nduration_s = 0.012\n\
        [gears.pinion]\nteeth = 15\nmodule_m = 0.02\nface_width_m = 0.2\nbore_radius_m = 0.05\nprofile_shift = 0.4\n\
        speed_rad_s = 64.66666666666667\nloads = [{ torque_nm = 169144.0 }]\n\
        [gears.wheel]\nteeth = 97\nmodule_m = 0.02\nface_width_m = 0.2\nbore_radius_m = 0.3\n\
        speed_rad_s = -10.0\nloads = [{ torque_nm = 1093798.0 }]\n\
        [[meshes]]\ngears = [\"pinion\", \"wheel\"]\nbacklash_m = 3e-4\nstart = { flank = \"left\" }\n\
        [[models]]\nmodel = \"movable-teeth\"\ncontact = { stiffness = \"iso6336\" }\n\
        parameters = { tooth_stiffness_n_per_m = 4e9, tooth_mass_kg = 1.5, tooth_damping_ns_per_m = 5000.0, integrate = \"active\" }\n";
    let [active, all] = ["active", "all"].map(|teeth| {
        let text = text.replace("\"active\"", &format!("{teeth:?}"));
        let file =
            SceneFile::unbuilt(&Context::default(), "big", &text, Origin::Shipped, true).unwrap();
        let choice = file.model("movable-teeth").unwrap();
        let models = gearbench::models::models();
        let mut scene = Scene::build(&file.spec_for(choice), &choice.modelling, models).unwrap();
        let mut ledger = Ledger::default();
        let plan = TimePlan::new(0.012, Resolution::Tolerance(1e-7));
        let start = scene.initial();
        watched(&mut scene, start, "dopri5", &plan, &mut ledger);
        println!(
            "{teeth}: {} coordinates, lost {:.6} J, jumps {:.1e} J",
            scene.layout().n,
            ledger.dissipated,
            ledger.jumps
        );
        (scene.layout().n, ledger)
    });
    assert!(active.0 < all.0);
    assert!(active.1.jumps.abs() < 1e-6, "{:e} J", active.1.jumps);
    let ratio = active.1.dissipated / all.1.dissipated;
    assert!((ratio - 1.0).abs() < 1e-5, "{ratio}");
}

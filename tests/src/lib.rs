//! Scenes, models and runs shared by the tests across crates.
//!
//! The kinds of evidence stand in separate test binaries: `analytic` (exact solutions, difference checks,
//! refusals), `conformance` (one law over all models and methods, fitted orders) and `golden` (what every study
//! computes on small scenes, by its [`fingerprint`], against what is stored).

use gearbench_integrators::observers::Tee;
use gearbench_integrators::observers::ledger::Ledger;
use gearbench_integrators::{
    AcceptedStep, Control, METHODS, Method, MethodInfo, Outputs, Report, Resolution,
    SecondOrderSystem, Sink, State, StepError, Stepping, TimePlan, Work,
};
use gearbench_models::contact::{Candidate, Party, Wanted};
use gearbench_models::error::BuildError;
use gearbench_models::gear::table::{MODELS, Model};
use gearbench_models::geometry::{Gear, GearParams, Rack, RackParams, Side};
use gearbench_models::kinematics::Row;
use gearbench_models::law::Damping;
use gearbench_models::scene::{OfMesh, Scene};
use gearbench_models::spec::{
    Body, ContactSpec, GearSpec, MeshSpec, ModelSpec, Modelling, Mount, Parameters, SceneSpec,
    Start, Value,
};
use gearbench_models::stiffness::{Material, PairOrMesh, PairStiffness};

pub mod elastic_toy;
#[allow(dead_code)]
#[path = "../../models/examples/elastic_web.rs"]
pub mod elastic_web;
pub mod fingerprint;
pub mod flank_test_gears;

/// All models: the table of the crate and the example.
pub fn models() -> Vec<Model> {
    [MODELS, &[elastic_web::MODEL]].concat()
}

/// All models, with the test gears that bring flanks.
pub fn models_with_flanks() -> Vec<Model> {
    let mut table = models();
    table.extend([
        flank_test_gears::RIGID,
        flank_test_gears::NODAL,
        elastic_toy::ELASTIC_TOY,
    ]);
    table
}

/// Geometry of a spur gear of module 4 mm.
pub fn spur(teeth: u32) -> GearParams {
    GearParams {
        teeth,
        module: 4e-3,
        tip_radius: 0.3,
        bore_radius: 0.015,
        ..Default::default()
    }
}

/// A gear at a position on the x axis that is free to turn.
pub fn gear(name: &str, params: GearParams, x: f64, speed: f64) -> GearSpec {
    GearSpec {
        name: name.into(),
        body: Body::Gear(Gear::new(params).expect("the gear can be cut")),
        material: Material::STEEL,
        inertia: None,
        added_inertia: 0.0,
        mount: Mount::Revolute,
        position: [x, 0.0],
        facing: 0.0,
        speed,
        loads: vec![],
    }
}

/// A rack of module 4 mm in front of a gear at the origin, teeth towards it.
pub fn rack(name: &str, teeth: u32, distance: f64, speed: f64) -> GearSpec {
    let params = RackParams {
        teeth,
        module: 4e-3,
        tip_radius: 0.3,
        ..Default::default()
    };
    GearSpec {
        body: Body::Rack(Rack::new(params).expect("the rack can be cut")),
        mount: Mount::Prismatic,
        facing: std::f64::consts::PI,
        ..gear(name, spur(20), distance, speed)
    }
}

/// The tooth pair of a mesh that is placed at the start.
pub fn start(side: Side, gap: f64) -> Start {
    Start {
        side,
        gap,
        path_coordinate: None,
    }
}

/// Two gears in mesh.
pub fn pair_of(a: GearSpec, b: GearSpec, start: Start) -> SceneSpec {
    SceneSpec {
        gears: vec![a, b],
        meshes: vec![MeshSpec {
            gears: [0, 1],
            start,
        }],
    }
}

/// The impact of reference case A: z = 20/30, m = 4 mm, 10 mm wide, 20 rad/s, inertias of the stored meshes.
pub fn case_a(gap: f64) -> SceneSpec {
    let mut a = gear("pinion", spur(20), 0.0, 20.0);
    a.inertia = Some(0.000_310_205_607_253_510_6);
    let mut b = gear(
        "wheel",
        GearParams {
            bore_radius: 0.025,
            ..spur(30)
        },
        0.1001,
        0.0,
    );
    b.inertia = Some(0.001_543_270_566_960_835_3);
    pair_of(a, b, start(Side::Left, gap))
}

/// A linear elastic contact of constant stiffness per width [N/m per m] of a tooth pair.
pub fn contact(per_width: f64) -> ContactSpec {
    ContactSpec {
        stiffness: PairStiffness::Constant {
            per_width,
            of: PairOrMesh::Pair,
        },
        exponent: 1.0,
        damping: Damping::None,
        friction: None,
        slices: None,
        points: None,
    }
}

/// The rigid model.
pub fn rigid() -> ModelSpec {
    ModelSpec {
        id: "rigid".into(),
        parameters: Parameters::new(),
    }
}

/// Movable teeth with spring [N/m], mass [kg] and damper [N s/m] of each tooth.
pub fn movable(k: f64, m: f64, c: f64) -> ModelSpec {
    let parameters = Parameters::from([
        ("tooth_stiffness_n_per_m".to_string(), Value::Number(k)),
        ("tooth_mass_kg".to_string(), Value::Number(m)),
        ("tooth_damping_ns_per_m".to_string(), Value::Number(c)),
    ]);
    ModelSpec {
        id: "movable-teeth".into(),
        parameters,
    }
}

/// The same model with another parameter.
pub fn with(mut model: ModelSpec, key: &str, value: Value) -> ModelSpec {
    model.parameters.insert(key.into(), value);
    model
}

/// Movable teeth that are all integrated.
pub fn all_teeth(model: ModelSpec) -> ModelSpec {
    with(model, "integrate", Value::Text("all".into()))
}

/// The example: half of the inertia in a rim of 20 kHz.
pub fn web(damping_ratio: f64) -> ModelSpec {
    let model = ModelSpec {
        id: elastic_web::MODEL.id.into(),
        parameters: Parameters::new(),
    };
    let model = with(model, "frequency_hz", Value::Number(2e4));
    let model = with(model, "rim_share", Value::Number(0.5));
    with(model, "damping_ratio", Value::Number(damping_ratio))
}

/// A model for each row of the table with usual parameters for a gear of so many teeth; undamped.
pub fn usual(model: &Model, _teeth: usize) -> ModelSpec {
    match model.id {
        "movable-teeth" => movable(5.3e8, 4.8e-3, 0.0),
        "elastic-web" => web(0.0),
        id => ModelSpec {
            id: id.into(),
            parameters: Parameters::new(),
        },
    }
}

/// Contact stiffness per width [N/m per m] that goes with [`usual`]: what the model does not carry itself.
pub fn usual_stiffness(model: &Model) -> f64 {
    if model.id == "rigid" { 1.54e10 } else { 5e10 }
}

/// Builds a scene with the joined table.
pub fn try_build(
    spec: &SceneSpec,
    gears: &[ModelSpec],
    contact: &ContactSpec,
) -> Result<Scene, BuildError> {
    let modelling = Modelling {
        gears: gears.to_vec(),
        contacts: vec![contact.clone(); spec.meshes.len()],
    };
    Scene::build(spec, &modelling, &models_with_flanks())
}

/// Builds a scene that must be buildable, all contacts alike.
pub fn build(spec: &SceneSpec, gears: &[ModelSpec], contact: &ContactSpec) -> Scene {
    try_build(spec, gears, contact).expect("the scene can be assembled")
}

/// All candidates of a scene at a state, whatever their gap, with the index of their mesh.
pub fn candidates(scene: &Scene, s: &State) -> Vec<(usize, Candidate)> {
    let mut all = Vec::new();
    for (m, mesh) in scene.meshes().iter().enumerate() {
        let party = |i: usize| {
            let g = &scene.gears()[i];
            Party {
                gear: g.model.as_ref(),
                at: g.at(s.at()),
            }
        };
        let mut found = Vec::new();
        let wanted = Wanted::Touching(f64::INFINITY);
        mesh.search.candidates(
            party(mesh.gears[0]),
            party(mesh.gears[1]),
            &[],
            wanted,
            &mut found,
        );
        all.extend(found.into_iter().map(|c| (m, c)));
    }
    all
}

/// The candidate of the same teeth, flank and slice at another state.
pub fn same_candidate(scene: &Scene, s: &State, mesh: usize, c: &Candidate) -> Option<Candidate> {
    let same = |x: &Candidate| x.slot == c.slot && x.points[0].tooth == c.points[0].tooth;
    candidates(scene, s)
        .into_iter()
        .find(|(m, x)| *m == mesh && same(x))
        .map(|(_, x)| x)
}

/// The contact row `dg/dq` of a candidate as a full vector.
pub fn contact_row(scene: &Scene, s: &State, mesh: usize, c: &Candidate) -> Vec<f64> {
    row_and_rate(scene, s, mesh, c).0
}

/// The contact row of a candidate, and the part of its gap rate that is prescribed [m/s].
pub fn row_and_rate(scene: &Scene, s: &State, mesh: usize, c: &Candidate) -> (Vec<f64>, f64) {
    let (mut row, mut rate) = (Row::default(), 0.0);
    row.clear();
    for (k, sign) in [(0, -1.0), (1, 1.0)] {
        let g = &scene.gears()[scene.meshes()[mesh].gears[k]];
        row.target(g.range().start, sign * c.scale[k]);
        let at = g.at(s.at());
        rate += sign * c.scale[k] * g.model.row(at, &c.points[k], &c.normal, &mut row);
    }
    let mut w = vec![0.0; s.q.len()];
    row.add_to(1.0, &mut w);
    (w, rate)
}

/// What a run left behind.
pub struct Outcome {
    /// Last state.
    pub state: State,
    /// Energy ledger.
    pub ledger: Ledger,
    /// Work counters.
    pub work: Work,
    /// Least normal force of any contact at any accepted step [N].
    pub normal_min: f64,
    /// Impulse of the contact force of the first mesh [N s], trapezoid rule over accepted steps.
    pub impulse: f64,
    /// Largest contact force of the first mesh at an accepted step [N].
    pub peak: f64,
    /// How the run ended.
    pub result: Result<(), StepError>,
}

impl Outcome {
    /// The run, which must have ended well.
    pub fn unwrap(self, what: &str) -> Outcome {
        if let Err(e) = &self.result {
            panic!("{what}: {e}");
        }
        self
    }
}

/// Watches forces at accepted steps.
#[derive(Default)]
struct Forces {
    normal_min: f64,
    impulse: f64,
    peak: f64,
    last: Option<f64>,
    meshes: usize,
    out: Outputs,
}

impl Sink for Forces {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        if self.last.is_none() {
            sys.output(step.from.at(), &mut self.out);
            self.last = Some(self.out.channels[0]);
        }
        sys.output(step.to.at(), &mut self.out);
        for m in 0..self.meshes {
            self.normal_min = self
                .normal_min
                .min(self.out.channels[OfMesh::ALL.len() * m + OfMesh::LeastNormal as usize]);
        }
        let force = self.out.channels[0];
        self.peak = self.peak.max(force);
        self.impulse += 0.5 * (step.to.t - step.from.t) * (self.last.unwrap_or(0.0) + force);
        self.last = Some(force);
        Control::Continue
    }

    fn restarted(&mut self, sys: &mut dyn SecondOrderSystem, _before: &State, after: &State) {
        sys.output(after.at(), &mut self.out);
        self.last = Some(self.out.channels[0]);
    }
}

/// Runs a scene from its initial state with a method `id(name=value)`.
pub fn run(scene: &mut Scene, id: &str, resolution: Resolution, t_end: f64) -> Outcome {
    let s = scene.initial();
    run_from(
        scene,
        s,
        id,
        &TimePlan {
            max_steps: 4_000_000,
            ..TimePlan::new(t_end, resolution)
        },
    )
}

/// Runs a scene from a state.
pub fn run_from(scene: &mut Scene, mut state: State, id: &str, plan: &TimePlan<'_>) -> Outcome {
    let mut integrator = gearbench_integrators::method(id).expect("the method is known");
    let mut ledger = Ledger::default();
    let mut forces = Forces {
        meshes: scene.meshes().len(),
        ..Forces::default()
    };
    let mut work = Work::default();
    let result = integrator.run(
        scene,
        &mut state,
        plan,
        &mut Tee(vec![&mut ledger, &mut forces]),
        &mut work,
    );
    let Forces {
        normal_min,
        impulse,
        peak,
        ..
    } = forces;
    Outcome {
        state,
        ledger,
        work,
        normal_min,
        impulse,
        peak,
        result,
    }
}

/// Value of a named channel at a state.
pub fn channel(scene: &mut Scene, s: &State, name: &str) -> f64 {
    let mut out = Outputs::default();
    scene.output(s.at(), &mut out);
    out.channels[named(scene, name)]
}

/// Place of a channel by its name.
pub fn named(scene: &Scene, name: &str) -> usize {
    let found = scene.channels().iter().position(|c| c == name);
    found.unwrap_or_else(|| panic!("there is no channel {name}"))
}

/// A resolution a method can run at: the step [s], or a tolerance where it takes no steps.
pub fn resolution(info: &MethodInfo, step: f64, tolerance: f64) -> Resolution {
    match info.stepping {
        Stepping::Adaptive => Resolution::Tolerance(tolerance),
        _ => Resolution::Step(step),
    }
}

/// The methods of the table that can run a scene.
pub fn methods_of(scene: &mut Scene) -> Vec<&'static Method> {
    let split = scene.modal().is_some();
    METHODS
        .iter()
        .filter(|m| split || !m.info.linear_part)
        .collect()
}

/// Slope of `log y` over `log x`, least squares.
pub fn slope(x: &[f64], y: &[f64]) -> f64 {
    let n = x.len() as f64;
    let log = |v: &[f64]| -> Vec<f64> { v.iter().map(|a| a.ln()).collect() };
    let (x, y) = (log(x), log(y));
    let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let above: f64 = x.iter().zip(&y).map(|(a, b)| (a - mx) * (b - my)).sum();
    let below: f64 = x.iter().map(|a| (a - mx).powi(2)).sum();
    above / below
}

/// Deterministic numbers in [-1, 1) for directions and states.
pub struct Numbers(u64);

impl Numbers {
    /// A sequence from a seed.
    pub fn new(seed: u64) -> Self {
        Numbers(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    /// The next number (xorshift64*).
    pub fn draw(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let bits = self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11;
        bits as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// A vector of them, scaled by entries of `scale`.
    pub fn vector(&mut self, scale: &[f64]) -> Vec<f64> {
        scale.iter().map(|s| s * self.draw()).collect()
    }
}

/// Magnitudes of coordinates and velocities of a scene.
pub fn scales(scene: &Scene) -> (Vec<f64>, Vec<f64>) {
    let n = scene.layout().n;
    let (mut q, mut v) = (vec![0.0; n], vec![0.0; n]);
    SecondOrderSystem::scales(scene, &mut q, &mut v);
    (q, v)
}

//! A new gear model in one file and one line: a small elastic gear.
//!
//! `cargo run --release -p gearbench-models --example elastic_test_gear` runs one impact of an elastic pinion
//! on a rigid wheel and prints what it found.
//!
//! The model is the smallest that uses the whole of [`GearModel`]: a hub, some modes and a local compliance.
//!
//! ```text
//! J phi'' = T + sum_c N_c w_c
//! q_j'' + 2 zeta_j omega_j q_j' + omega_j^2 q_j = sum_c N_c phi_j(tooth_c) w_c / r
//! g = g0 + C N,   C = c0 rho^d      (d: distance of two teeth around the gear)
//! ```
//!
//! Modes have unit modal mass and carry no angular momentum (mean-axis modes of a free hub, or modes of a held
//! hub). Mode `j` moves the flanks of a tooth along the tangent, by `phi_j(tooth)` at the base circle and in
//! proportion to the radius elsewhere, so that on the line of action its displacement along the normal does
//! not depend on where the flanks touch. `r` is the lever of the line of action.
//!
//! A gear model of your own does the same three things: a type, `impl GearModel`, a [`Model`] row. The table
//! that a scene is built from is a slice, so it needs no change to this crate:
//!
//! ```ignore
//! let mut table = MODELS.to_vec();
//! table.push(elastic_test_gear::MODEL);
//! let scene = Scene::build(&spec, &modelling, &table)?;
//! ```
#![allow(clippy::print_stdout)]

use gearbench_integrators::observers::Tee;
use gearbench_integrators::observers::ledger::Ledger;
use gearbench_integrators::observers::recorder::Recorder;
use gearbench_integrators::system::{At, Coeffs, Energy, SecondOrderSystem, Singular};
use gearbench_integrators::{Resolution, TimePlan, Work, method};
use gearbench_models::Vec3;
use gearbench_models::error::{BuildError, GearPart, Reason};
use gearbench_models::gear::table::{GearContext, MODELS, Model, ParameterInfo};
use gearbench_models::gear::{Coordinates, GearModel, HubState, Magnitudes};
use gearbench_models::geometry::{Gear, GearParams, Side};
use gearbench_models::kinematics::{Hub, Point, Row, Tooth};
use gearbench_models::law::Damping;
use gearbench_models::scene::Scene;
use gearbench_models::spec::{
    Body, ContactSpec, GearSpec, MeshSpec, ModelSpec, Modelling, Mount, Parameters, SceneSpec,
    Start, Value,
};
use gearbench_models::stiffness::{Material, PairOrMesh, PairStiffness};

/// The row that a table of models needs: this is the one line.
pub const MODEL: Model = Model {
    id: "elastic-test",
    title: "hub, a few modes and a local compliance (example)",
    parameters: PARAMETERS,
    build,
};

const fn takes(key: &'static str, meaning: &'static str, required: bool) -> ParameterInfo {
    ParameterInfo {
        key,
        meaning,
        required,
    }
}

/// Parameters of the model.
const PARAMETERS: &[ParameterInfo] = &[
    takes(
        "omega_rad_per_s",
        "natural angular frequency of each mode",
        true,
    ),
    takes("damping_ratio", "of each mode; default 0", false),
    takes(
        "flank_shape_per_sqrt_kg",
        "mass-normalised, per mode and tooth",
        true,
    ),
    takes(
        "compliance_m_per_n",
        "local compliance c0 of a flank; default 0",
        false,
    ),
    takes(
        "compliance_coupling",
        "of neighbouring teeth over c0, in [0, 1); default 0",
        false,
    ),
];

/// One mode.
#[derive(Clone, Debug)]
struct Mode {
    omega: f64,
    zeta: f64,
    /// Shape at the flanks of each tooth [1/sqrt(kg)].
    shape: Vec<f64>,
}

/// A gear with a hub, modes and a local compliance.
#[derive(Clone, Debug)]
pub struct ElasticTestGear {
    hub: Hub,
    teeth: usize,
    /// Lever of the line of action [m].
    lever: f64,
    modes: Vec<Mode>,
    local: f64,
    coupling: f64,
}

fn refuse(key: &str, message: impl Into<Reason>) -> BuildError {
    BuildError::parameter(MODEL.id, key, message)
}

/// Values of a parameter, all finite and at least `low`; none when it is not given.
fn numbers(context: &GearContext<'_>, key: &str, low: f64) -> Result<Vec<f64>, BuildError> {
    let values = match context.parameters.get(key) {
        None => vec![],
        Some(Value::Number(x)) => vec![*x],
        Some(Value::List(x)) => x.clone(),
        Some(Value::Text(x)) => {
            return Err(refuse(key, format!("expected numbers, found \"{x}\"")));
        }
        Some(Value::Flag(x)) => {
            return Err(refuse(key, format!("expected numbers, found {x}")));
        }
    };
    match values.iter().find(|x| !(x.is_finite() && **x >= low)) {
        Some(x) => Err(refuse(
            key,
            format!("{x} is not a number from {low:e} upwards"),
        )),
        None => Ok(values),
    }
}

fn build(context: &GearContext<'_>) -> Result<Box<dyn GearModel>, BuildError> {
    let Body::Gear(gear) = context.body else {
        let why = ("the elastic test gear is no rack", "use another model");
        return Err(BuildError::gear(context.name, GearPart::Model, why));
    };
    let teeth = gear.teeth() as usize;
    let omega = numbers(context, "omega_rad_per_s", f64::MIN_POSITIVE)?;
    if omega.is_empty() {
        return Err(refuse(
            "omega_rad_per_s",
            "is missing; give one value per mode",
        ));
    }
    let mut zeta = numbers(context, "damping_ratio", 0.0)?;
    if zeta.is_empty() {
        zeta.resize(omega.len(), 0.0);
    }
    let shape = numbers(context, "flank_shape_per_sqrt_kg", f64::MIN)?;
    if zeta.len() != omega.len() || shape.len() != omega.len() * teeth {
        return Err(refuse(
            "flank_shape_per_sqrt_kg",
            format!(
                "{} values and {} damping ratios; give {} modes times {teeth} teeth",
                shape.len(),
                zeta.len(),
                omega.len()
            ),
        ));
    }
    let one = |key: &str| numbers(context, key, 0.0).map(|x| x.first().copied().unwrap_or(0.0));
    let coupling = one("compliance_coupling")?;
    if coupling >= 1.0 {
        return Err(refuse(
            "compliance_coupling",
            format!("{coupling} is not below 1"),
        ));
    }
    let modes = omega.iter().zip(&zeta).zip(shape.chunks_exact(teeth));
    Ok(Box::new(ElasticTestGear {
        hub: context.hub.clone(),
        teeth,
        lever: context.lever,
        modes: modes
            .map(|((&omega, &zeta), shape)| Mode {
                omega,
                zeta,
                shape: shape.to_vec(),
            })
            .collect(),
        local: one("compliance_m_per_n")?,
        coupling,
    }))
}

impl ElasticTestGear {
    /// Coordinates before the modes: those of the mount.
    fn first(&self) -> usize {
        self.hub.coordinates()
    }

    fn tooth(&self, tooth: Tooth) -> usize {
        tooth.index.rem_euclid(self.teeth as i64) as usize
    }

    /// Normal displacement along `n` per unit of tangential displacement at the base circle.
    fn along(&self, p: &Point, n: &Vec3) -> f64 {
        self.hub.lever(&p.x, n) / self.lever
    }
}

impl GearModel for ElasticTestGear {
    fn id(&self) -> &'static str {
        MODEL.id
    }

    fn hub(&self) -> &Hub {
        &self.hub
    }

    fn hub_mut(&mut self) -> &mut Hub {
        &mut self.hub
    }

    fn coordinates(&self) -> Coordinates {
        Coordinates {
            n: self.first() + self.modes.len(),
            memory: 0,
        }
    }

    fn scales(&self, m: Magnitudes, q: &mut [f64], v: &mut [f64]) {
        for (i, (q, v)) in q.iter_mut().zip(v).enumerate() {
            // A deflection at the flank as an angle of the hub, or as a modal coordinate.
            let per_coordinate = match i.checked_sub(self.first()) {
                None => self.lever,
                Some(j) => self.modes[j]
                    .shape
                    .iter()
                    .fold(0.0_f64, |m, x| m.max(x.abs()))
                    .max(1e-3),
            };
            *q = m.deflection / per_coordinate;
            *v = m.speed / per_coordinate;
        }
    }

    fn initialise(&self, speed: f64, q: &mut [f64], v: &mut [f64], _memory: &mut [f64]) {
        q.fill(0.0);
        v.fill(0.0);
        if self.first() > 0 {
            v[0] = speed;
        }
    }

    fn contact_mass(&self) -> f64 {
        let hub = if self.first() > 0 {
            self.lever.powi(2) / self.hub.inertia
        } else {
            0.0
        };
        let softest = (0..self.teeth)
            .map(|i| self.modes.iter().map(|m| m.shape[i].powi(2)).sum::<f64>())
            .fold(0.0, f64::max);
        1.0 / (hub + softest)
    }

    fn pace(&self) -> f64 {
        self.modes
            .iter()
            .fold(f64::INFINITY, |t, m| t.min(1.0 / m.omega))
    }

    fn tooth_travel(&self, at: At<'_>, _tooth: Tooth) -> f64 {
        self.hub.travel(at.t, at.q)
    }

    fn has_displacement(&self) -> bool {
        true
    }

    fn displacement(&self, at: At<'_>, p: &Point) -> Vec3 {
        let tooth = self.tooth(p.tooth);
        let modal = self.modes.iter().zip(&at.q[self.first()..]);
        let amount: f64 = modal.map(|(m, q)| m.shape[tooth] * q).sum();
        let r = p.x - self.hub.centre;
        amount / self.lever * Vec3::new(-r.y, r.x, 0.0)
    }

    fn row(&self, _at: At<'_>, p: &Point, n: &Vec3, row: &mut Row) {
        if self.first() > 0 {
            row.push(0, self.hub.lever(&p.x, n));
        }
        let (tooth, along) = (self.tooth(p.tooth), self.along(p, n));
        row.push_span(
            self.first(),
            self.modes.iter().map(|m| m.shape[tooth] * along),
        );
    }

    fn compliance(&self, p: &Point, n: &Vec3, r: &Point, m: &Vec3) -> f64 {
        let apart = self.tooth(p.tooth).abs_diff(self.tooth(r.tooth));
        let apart = apart.min(self.teeth - apart);
        // A geometric decay around the gear is positive definite.
        let value = if apart == 0 {
            self.local
        } else {
            self.local * self.coupling.powi(apart as i32)
        };
        value * self.along(p, n) * self.along(r, m)
    }

    fn is_compliant(&self) -> bool {
        self.local > 0.0
    }

    fn internal_force(&mut self, at: At<'_>, f: &mut [f64]) {
        let first = self.first();
        for (j, m) in self.modes.iter().enumerate() {
            let i = first + j;
            f[i] -= m.omega * (m.omega * at.q[i] + 2.0 * m.zeta * at.v[i]);
        }
    }

    fn internal_tangent(&mut self, _at: At<'_>, dq: &[f64], dv: &[f64], df: &mut [f64]) {
        let first = self.first();
        for (j, m) in self.modes.iter().enumerate() {
            let i = first + j;
            df[i] -= m.omega * (m.omega * dq[i] + 2.0 * m.zeta * dv[i]);
        }
    }

    fn solve_mass(&mut self, _at: At<'_>, f_to_a: &mut [f64]) {
        if self.first() > 0 {
            f_to_a[0] /= self.hub.inertia;
        }
    }

    fn apply_mass(&mut self, _at: At<'_>, x: &[f64], y: &mut [f64]) {
        y.copy_from_slice(x);
        if self.first() > 0 {
            y[0] *= self.hub.inertia;
        }
    }

    fn correct(
        &mut self,
        _at: At<'_>,
        c: Coeffs,
        hub_damping: f64,
        rhs_to_x: &mut [f64],
    ) -> Result<(), Singular> {
        let first = self.first();
        for (i, x) in rhs_to_x.iter_mut().enumerate() {
            let diagonal = match i.checked_sub(first) {
                None => c.m * self.hub.inertia + c.d * hub_damping,
                Some(j) => {
                    let m = &self.modes[j];
                    c.m + m.omega * (2.0 * c.d * m.zeta + c.k * m.omega)
                }
            };
            if diagonal == 0.0 {
                return Err(Singular);
            }
            *x /= diagonal;
        }
        Ok(())
    }

    fn energy(&self, at: At<'_>) -> Energy {
        let first = self.first();
        let mut e = Energy::default();
        if first > 0 {
            e.kinetic += 0.5 * self.hub.inertia * at.v[0] * at.v[0];
        }
        for (j, m) in self.modes.iter().enumerate() {
            e.kinetic += 0.5 * at.v[first + j].powi(2);
            e.strain += 0.5 * (m.omega * at.q[first + j]).powi(2);
        }
        e
    }

    fn dissipated(&self, at: At<'_>) -> f64 {
        let rates = &at.v[self.first()..];
        self.modes
            .iter()
            .zip(rates)
            .map(|(m, v)| 2.0 * m.zeta * m.omega * v * v)
            .sum()
    }

    fn hub_state(&self, at: At<'_>) -> HubState {
        let speed = self.hub.speed(at.t, at.v);
        HubState {
            travel: self.hub.travel(at.t, at.q),
            speed,
            momentum: self.hub.inertia * speed,
        }
    }
}

/// Parameters of an elastic gear with `z` teeth whose modes of harmonic index 1, 2, ... come in cosine and sine
/// pairs; a static load on a tooth meets the compliance `2 amplitude^2 / omega^2` of a pair [m/N].
pub fn harmonic_modes(z: usize, omega: &[f64], zeta: f64, amplitude: f64) -> Parameters {
    let mut shape = Vec::new();
    let mut both = Vec::new();
    for (j, &omega) in omega.iter().enumerate() {
        let angle = |i: usize| std::f64::consts::TAU * (j + 1) as f64 * i as f64 / z as f64;
        shape.extend((0..z).map(|i| amplitude * angle(i).cos()));
        shape.extend((0..z).map(|i| amplitude * angle(i).sin()));
        both.extend([omega, omega]);
    }
    Parameters::from([
        (
            "damping_ratio".to_string(),
            Value::List(vec![zeta; both.len()]),
        ),
        ("omega_rad_per_s".to_string(), Value::List(both)),
        ("flank_shape_per_sqrt_kg".to_string(), Value::List(shape)),
    ])
}

/// One impact of an elastic pinion on a rigid wheel: z = 20/30, m = 4 mm, 20 rad/s.
pub fn impact_scene() -> Result<Scene, Box<dyn std::error::Error>> {
    let gear = |name: &str,
                teeth,
                bore_radius,
                x,
                speed|
     -> Result<GearSpec, Box<dyn std::error::Error>> {
        let params = GearParams {
            teeth,
            module: 4e-3,
            tip_radius: 0.3,
            bore_radius,
            ..Default::default()
        };
        Ok(GearSpec {
            name: name.into(),
            body: Body::Gear(Gear::new(params)?),
            material: Material::STEEL,
            inertia: None,
            added_inertia: 0.0,
            mount: Mount::Revolute,
            position: [x, 0.0],
            facing: 0.0,
            speed,
            loads: vec![],
        })
    };
    let spec = SceneSpec {
        gears: vec![
            gear("pinion", 20, 0.015, 0.0, 20.0)?,
            gear("wheel", 30, 0.025, 0.1001, 0.0)?,
        ],
        meshes: vec![MeshSpec {
            gears: [0, 1],
            start: Start {
                side: Side::Left,
                gap: 3e-6,
                path_coordinate: None,
            },
        }],
    };
    let mut elastic = harmonic_modes(20, &[2.5e5, 4e5, 6e5], 0.01, 3.0);
    elastic.insert("compliance_m_per_n".into(), Value::Number(2e-9));
    elastic.insert("compliance_coupling".into(), Value::Number(0.25));
    let modelling = Modelling {
        gears: vec![
            ModelSpec {
                id: MODEL.id.into(),
                parameters: elastic,
            },
            ModelSpec {
                id: "rigid".into(),
                parameters: Parameters::new(),
            },
        ],
        contacts: vec![ContactSpec {
            stiffness: PairStiffness::Constant {
                per_width: 3e10,
                of: PairOrMesh::Pair,
            },
            exponent: 1.0,
            damping: Damping::None,
            friction: None,
            slices: None,
            points: None,
        }],
    };
    let mut table = MODELS.to_vec();
    table.push(MODEL);
    Ok(Scene::build(&spec, &modelling, &table)?)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut scene = impact_scene()?;
    let mut state = scene.initial();
    let t_end = 3e-4;
    let mut record = Recorder::on((0..=3000).map(|i| 1e-7 * f64::from(i)).collect());
    let mut ledger = Ledger::default();
    let mut work = Work::default();
    let mut integrator = method("dopri5")?;
    let plan = TimePlan::new(t_end, Resolution::Tolerance(1e-8));
    integrator.run(
        &mut scene,
        &mut state,
        &plan,
        &mut Tee(vec![&mut record, &mut ledger]),
        &mut work,
    )?;

    let force = record.column(0);
    let peak = (0..force.len())
        .max_by(|&a, &b| force[a].total_cmp(&force[b]))
        .unwrap_or(0);
    println!(
        "{} coordinates, {} steps, {} events",
        scene.layout().n,
        work.steps,
        work.events
    );
    println!(
        "peak contact force {:.1} N at {:.1} us",
        force[peak],
        1e6 * record.grid[peak]
    );
    let (start, end) = (ledger.start.unwrap_or_default(), ledger.end);
    println!(
        "energy at the start {:.6e} J, at the end {:.6e} J",
        start.total(),
        end.total()
    );
    println!(
        "of it kinetic {:.6e} J, strain {:.6e} J",
        end.kinetic, end.strain
    );
    println!("lost to modal damping {:.6e} J", ledger.dissipated);
    println!(
        "not explained {:.1e} of the energy",
        ledger.residual_relative()
    );
    Ok(())
}

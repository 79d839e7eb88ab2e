//! The two-gear problems that `benchmarks/scripts/scipy_floor.py` solves too, and their exact solution.

use gearbench_models::gear::table::MODELS;
use gearbench_models::geometry::{Gear, GearParams, Pair, Side};
use gearbench_models::law::Damping;
use gearbench_models::scene::Scene;
use gearbench_models::spec::{
    Body, ContactSpec, FlankContact, GearSpec, MeshSpec, Modelling, Mount, SceneSpec, Start,
    UPRIGHT,
};
use gearbench_models::stiffness::{Material, PairOrMesh, PairStiffness};
use std::f64::consts::PI;

const MODULE: f64 = 5e-3;
const WIDTH: f64 = 20e-3;
const STIFFNESS: f64 = 5.72e9 * WIDTH;
const RATIO: f64 = 0.05;
const BACKLASH: f64 = 1e-4;

/// Problems with two degrees of freedom that `scripts/scipy_floor.py` solves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Problem {
    /// One impact, 1 ms.
    Impact,
    /// 24 impacts in 0.25 s.
    Hammer,
}

struct Data {
    end: f64,
    start: f64,
    speed: [f64; 2],
}

impl Problem {
    /// Returns the name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Problem::Impact => "impact",
            Problem::Hammer => "hammer",
        }
    }

    fn data(self) -> Data {
        match self {
            Problem::Impact => Data {
                end: 1e-3,
                start: 0.5 * BACKLASH,
                speed: [1.0, 0.0],
            },
            Problem::Hammer => Data {
                end: 0.25,
                start: 0.0,
                speed: [101.0, 99.0 * 2.0 / 3.0],
            },
        }
    }

    /// Returns the end time [s].
    pub fn end(self) -> f64 {
        self.data().end
    }

    /// Builds the problem as a gearbench scene: one spring for the mesh, Kelvin-Voigt damping, backlash.
    pub fn scene(self) -> Scene {
        let data = self.data();
        let gear = |teeth| {
            Gear::new(GearParams {
                teeth,
                module: MODULE,
                face_width: WIDTH,
                ..Default::default()
            })
            .unwrap()
        };
        let (one, two) = (gear(20), gear(30));
        // The distance at which the backlash along the line of action is as asked.
        let mut distance = 0.1251;
        for _ in 0..20 {
            let alpha = Pair::new(&one, &two, distance)
                .unwrap()
                .working_pressure_angle();
            distance =
                Pair::centre_distance_for_backlash(&one, &two, BACKLASH / alpha.cos()).unwrap();
        }
        let spec = |name: &str, gear: Gear, x: f64, speed: f64| GearSpec {
            name: name.into(),
            inertia: Some(inertia(&gear)),
            body: Body::Gear(gear),
            material: Material::STEEL,
            added_inertia: 0.0,
            mount: Mount::Revolute,
            guide: None,
            lateral: None,
            axes: UPRIGHT,
            position: [x, 0.0, 0.0],
            facing: 0.0,
            speed,
            loads: Vec::new(),
        };
        let spec = SceneSpec {
            duration: f64::INFINITY,
            gears: vec![
                spec("pinion", one, 0.0, data.speed[0]),
                spec("wheel", two, distance, -data.speed[1]),
            ],
            meshes: vec![MeshSpec {
                gears: [0, 1],
                start: Start {
                    side: Side::Left,
                    gap: 0.5 * BACKLASH - data.start,
                    path_coordinate: None,
                    loaded: false,
                },
            }],
            shafts: vec![],
            stages: Vec::new(),
        };
        let rigid = gearbench_models::gear::rigid::spec();
        let modelling = Modelling {
            gears: vec![rigid.clone(), rigid],
            contacts: vec![ContactSpec {
                stiffness: PairStiffness::Constant {
                    per_width: STIFFNESS / WIDTH,
                    of: PairOrMesh::Mesh,
                },
                exponent: 1.0,
                damping: Damping::KelvinVoigtRatio { ratio: RATIO },
                normal_force: None,
                friction: None,
                slices: None,
                flanks: FlankContact::Toothing,
            }],
        };
        Scene::build(&spec, &modelling, MODELS).unwrap()
    }

    /// Computes the pinion speed on a grid: free flights and damped half oscillations, one after the other.
    pub fn exact(self, grid: &[f64]) -> Vec<f64> {
        let data = self.data();
        let base = [20.0, 30.0].map(|z: f64| 0.5 * MODULE * z * 20f64.to_radians().cos());
        let discs = [20.0, 30.0].map(|z: f64| disc(0.5 * MODULE * z));
        let mass = [discs[0] / base[0].powi(2), discs[1] / base[1].powi(2)];
        let reduced = mass[0] * mass[1] / (mass[0] + mass[1]);
        let damper = 2.0 * RATIO * (STIFFNESS * reduced).sqrt();
        let surface = [base[0] * data.speed[0], base[1] * data.speed[1]];
        let mean = (mass[0] * surface[0] + mass[1] * surface[1]) / (mass[0] + mass[1]);
        let (mut s, mut v, mut t) = (data.start, surface[0] - surface[1], 0.0);
        let omega0 = (STIFFNESS / reduced).sqrt();
        let decay = RATIO * omega0;
        let omega = omega0 * (1.0 - RATIO * RATIO).sqrt();
        let release = (PI - (damper * omega).atan2(STIFFNESS - damper * decay)) / omega;
        let half = 0.5 * BACKLASH;
        let mut touching = s >= half && v > 0.0;
        let mut rate = vec![0.0; grid.len()];
        let mut fill = |from: f64, to: f64, f: &dyn Fn(f64) -> f64| {
            for (r, &x) in rate.iter_mut().zip(grid) {
                if x >= from && x <= to {
                    *r = f(x - from);
                }
            }
        };
        while t <= data.end {
            if touching {
                let side = s.signum();
                let u = v;
                let wave = |tau: f64| {
                    u * (-decay * tau).exp()
                        * ((omega * tau).cos() - decay / omega * (omega * tau).sin())
                };
                fill(t, t + release, &wave);
                s = side * half + u / omega * (-decay * release).exp() * (omega * release).sin();
                v = wave(release);
                t += release;
            } else {
                let target = if v > 0.0 { half } else { -half };
                let flight = (target - s) / v;
                let u = v;
                fill(t, t + flight, &|_| u);
                (s, t) = (target, t + flight);
            }
            touching = !touching;
        }
        rate.iter()
            .map(|r| (mean + r * mass[1] / (mass[0] + mass[1])) / base[0])
            .collect()
    }
}

fn disc(r: f64) -> f64 {
    0.5 * 7850.0 * PI * WIDTH * r.powi(4)
}

fn inertia(gear: &Gear) -> f64 {
    disc(gear.r_reference())
}

//! Forces, tangents, mass and corrections of a ring without teeth.

mod floating;
mod mount;

use super::FullOrder;
use super::body::Body;
use crate::assembly::tie::MassKind;
use crate::gear_mesh::GearMesh;
use crate::mesh::{ElementKind, Mesh};
use crate::test_support::{hub, noise};
use gearbench_integrators::system::{Coeffs, StateView};
use gearbench_models::Vec3;
use gearbench_models::gear::{CoupledMass, FlankNodes, GearModel, LargeGear};
use gearbench_models::kinematics::Placement;
use gearbench_models::spec::{Mount, Profile};
use gearbench_models::stiffness::Material;

/// A ring without teeth: `around` elements, two across, one over the width.
/// `f <- M^-1 f`.
fn solve_mass(gear: &FullOrder, at: StateView<'_>, f: &mut [f64]) {
    if let Some(mass) = gear.coupled_mass() {
        return mass.solve(at, f);
    }
    let mut diagonal = vec![0.0; f.len()];
    gear.hub().diagonal_mass(&mut diagonal);
    f.iter_mut().zip(diagonal).for_each(|(f, m)| *f /= m);
}

fn ring(around: usize) -> GearMesh {
    let radii = [0.02, 0.03, 0.045];
    let mut nodes = Vec::new();
    for z in [-0.005, 0.005] {
        for k in 0..around {
            let (sin, cos) = (std::f64::consts::TAU * k as f64 / around as f64).sin_cos();
            nodes.extend(radii.map(|r| Vec3::new(r * cos, r * sin, z)));
        }
    }
    let mut connectivity = Vec::new();
    for k in 0..around {
        for i in 0..2 {
            let next = (k + 1) % around;
            let layer = [3 * k + i, 3 * k + i + 1, 3 * next + i + 1, 3 * next + i];
            let upper = layer.map(|n| n + 3 * around);
            connectivity.extend(layer.into_iter().chain(upper).map(|n| n as u32));
        }
    }
    let bore = (0..2 * around as u32).map(|k| 3 * k).collect();
    GearMesh {
        mesh: Mesh::new(ElementKind::C3D8, nodes, connectivity),
        teeth: around as u32,
        bore,
        flanks: Vec::new(),
        tied: Vec::new(),
    }
}

fn gear(mount: Mount, slide: Option<Vec3>, mass: MassKind) -> FullOrder {
    let hub = hub(mount, slide);
    let placement = Placement::new(&hub, 0.3);
    let body = Body::new(
        ring(10),
        &Material::STEEL,
        &placement,
        &hub.mount,
        mass,
        1e-4,
    )
    .unwrap();
    FullOrder::new(hub, 0.04, body)
}

fn at<'a>(t: f64, q: &'a [f64], v: &'a [f64]) -> StateView<'a> {
    StateView {
        t,
        q,
        v,
        discrete: &[],
    }
}

/// A state turned (or moved) by `displacement` with small displacements and velocities on top.
fn state(gear: &FullOrder, displacement: f64, speed: f64) -> (Vec<f64>, Vec<f64>) {
    let n = gear.hub().len();
    let own = gear.hub().coordinates();
    let (mut q, mut v) = (vec![0.0; n], vec![0.0; n]);
    gear.initialise(speed, &mut q, &mut v, &mut []);
    if own > 0 {
        q[0] = displacement;
    }
    let body = gear.body();
    let frame = super::frame::Frame::at(displacement, gear.hub().slide.as_ref());
    let jitter = noise(3 * body.free.len(), 1e-6);
    for (k, &node) in body.free.iter().enumerate() {
        let carried = frame.carried(&body.position[node as usize]);
        for axis in 0..3 {
            q[own + 3 * k + axis] = carried[axis] + jitter[3 * k + axis];
            v[own + 3 * k + axis] += 3e3 * jitter[(7 * k + axis) % jitter.len()];
        }
    }
    (q, v)
}

fn cases() -> Vec<FullOrder> {
    let slide = Some(Vec3::new(0.6, 0.8, 0.0));
    let ramp = Profile::Ramp {
        from: 3.0,
        to: 8.0,
        start: 0.0,
        end: 1.0,
    };
    let mut all = Vec::new();
    for mass in [MassKind::Consistent, MassKind::Lumped] {
        all.push(gear(Mount::Revolute, None, mass));
        all.push(gear(Mount::Prismatic, slide, mass));
        all.push(gear(Mount::Fixed, None, mass));
        all.push(gear(Mount::Driven(ramp.clone()), None, mass));
    }
    all
}

#[test]
fn tangent_is_the_derivative_of_the_force() {
    for mut gear in cases() {
        let (q, v) = state(&gear, 0.7, 40.0);
        let n = q.len();
        let (dq, dv) = (noise(n, 1e-7), noise(n, 1e-3));
        let mut exact = vec![0.0; n];
        gear.tangent(at(0.5, &q, &v), &dq, &dv, &mut exact);
        let mut side = |sign: f64| {
            let shift = |x: &[f64], d: &[f64]| -> Vec<f64> {
                x.iter().zip(d).map(|(x, d)| x + sign * d).collect()
            };
            let mut f = vec![0.0; n];
            gear.forces(at(0.5, &shift(&q, &dq), &shift(&v, &dv)), &mut f);
            f
        };
        let (plus, minus) = (side(1.0), side(-1.0));
        let largest = exact.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        for i in 0..n {
            let difference = 0.5 * (plus[i] - minus[i]);
            assert!(
                (difference - exact[i]).abs() < 2e-7 * largest,
                "{i}: {difference} {}",
                exact[i]
            );
        }
    }
}

#[test]
fn force_is_minus_the_slope_of_the_strain_energy() {
    for mut gear in cases() {
        let (q, v) = state(&gear, 0.7, 0.0);
        let v = vec![0.0; v.len()];
        let mut f = vec![0.0; q.len()];
        // The prescribed motion is at rest before its ramp in none of the cases but has no part in the slope.
        gear.forces(at(2.0, &q, &v), &mut f);
        let dq = noise(q.len(), 1e-8);
        let energy = |sign: f64| {
            let q: Vec<f64> = q.iter().zip(&dq).map(|(x, d)| x + sign * d).collect();
            gear.energy(at(2.0, &q, &v)).strain
        };
        let slope = 0.5 * (energy(1.0) - energy(-1.0));
        // The force of a rotating hub on its neighbours is inertial, not elastic.
        let frame_speed = gear.hub().speed(2.0, &v);
        if frame_speed == 0.0 {
            let work: f64 = f.iter().zip(&dq).map(|(f, d)| f * d).sum();
            assert!((work + slope).abs() < 1e-6 * slope.abs(), "{work} {slope}");
        }
    }
}

#[test]
fn mass_solves_what_mass_makes_and_gives_the_kinetic_energy() {
    for gear in cases() {
        let (q, v) = state(&gear, 0.7, 40.0);
        let n = q.len();
        let a = noise(n, 1.0);
        let mut f = vec![0.0; n];
        CoupledMass::apply(&gear, at(0.0, &q, &v), &a, &mut f);
        let mut back = f.clone();
        solve_mass(&gear, at(0.0, &q, &v), &mut back);
        for (a, b) in a.iter().zip(&back) {
            assert!((a - b).abs() < 1e-9, "{a} {b}");
        }
        if gear.hub().coordinates() > 0 {
            let mut p = vec![0.0; n];
            CoupledMass::apply(&gear, at(0.0, &q, &v), &v, &mut p);
            let kinetic = 0.5 * p.iter().zip(&v).map(|(p, v)| p * v).sum::<f64>();
            let found = gear.energy(at(0.0, &q, &v)).kinetic;
            assert!((kinetic - found).abs() < 1e-12 * found, "{kinetic} {found}");
        }
    }
}

#[test]
fn internal_forces_leave_the_momentum_alone() {
    // dL/dt = sum of the moments; nothing outside acts, so it is zero however the gear is turned and bent.
    for mass in [MassKind::Consistent, MassKind::Lumped] {
        for (mount, slide) in [
            (Mount::Revolute, None),
            (Mount::Prismatic, Some(Vec3::new(0.6, 0.8, 0.0))),
        ] {
            let mut gear = gear(mount, slide, mass);
            let (q, v) = state(&gear, 0.7, 40.0);
            let mut a = vec![0.0; q.len()];
            gear.forces(at(0.0, &q, &v), &mut a);
            let size = a.iter().fold(0.0_f64, |m, x| m.max(x.abs())) * 0.045;
            solve_mass(&gear, at(0.0, &q, &v), &mut a);
            let h = 1e-9;
            let momentum = |sign: f64| {
                let (mut q, mut v) = (q.clone(), v.clone());
                for i in 0..q.len() {
                    q[i] += sign * h * v[i];
                    v[i] += sign * h * a[i];
                }
                gear.hub_state(at(0.0, &q, &v)).momentum
            };
            let rate = (momentum(1.0) - momentum(-1.0)) / (2.0 * h);
            assert!(rate.abs() < 1e-5 * size, "{rate} {size}");
        }
    }
}

#[test]
fn a_rigid_motion_has_no_strain_and_the_inertia_of_the_body() {
    for mass in [MassKind::Consistent, MassKind::Lumped] {
        let gear = gear(Mount::Revolute, None, mass);
        let (n, speed) = (gear.hub().len(), 25.0);
        let (mut q, mut v) = (vec![0.0; n], vec![0.0; n]);
        gear.initialise(speed, &mut q, &mut v, &mut []);
        let e = gear.energy(at(0.0, &q, &v));
        assert_eq!(e.strain, 0.0);
        let expected = 0.5 * gear.hub().inertia * speed * speed;
        assert!((e.kinetic - expected).abs() < 1e-12 * expected);
        let state = gear.hub_state(at(0.0, &q, &v));
        assert!((state.momentum - gear.hub().inertia * speed).abs() < 1e-12);
    }
}

#[test]
fn corrections_invert_the_tangent_up_to_the_strain() {
    for mut gear in cases() {
        let (q, v) = state(&gear, 0.7, 0.0);
        let n = q.len();
        let c = Coeffs {
            m: 1.0,
            d: 1e-6,
            k: 1e-12,
        };
        let x = noise(n, 1e-6);
        let mut rhs = vec![0.0; n];
        CoupledMass::apply(&gear, at(2.0, &q, &v), &x, &mut rhs);
        let mut tangent = vec![0.0; n];
        gear.tangent(at(2.0, &q, &v), &x, &vec![0.0; n], &mut tangent);
        for (r, t) in rhs.iter_mut().zip(&tangent) {
            *r -= c.k * t;
        }
        let damping = 3.0;
        if gear.hub().coordinates() > 0 {
            rhs[0] += c.d * damping * x[0];
        }
        gear.correct(at(2.0, &q, &v), c, damping, &mut rhs).unwrap();
        let error = rhs
            .iter()
            .zip(&x)
            .fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
        assert!(error < 1e-3 * 1e-6, "{error}");
    }
}

#[test]
fn kept_columns_give_the_response_of_the_whole_gear() {
    for mut gear in cases() {
        let (q, v) = state(&gear, 0.7, 0.0);
        let n = q.len();
        let own = gear.hub().coordinates() as u32;
        let c = Coeffs {
            m: 1.0,
            d: 0.0,
            k: 1e-12,
        };
        // The hub's own among them where it is free.
        let coordinates = [own + 31, own + 30, own + 4, 0, own + 32];
        let forces = [2.0, -1.0, 0.5, 3.0, -0.25];
        let mut expected = vec![0.0; n];
        for (&i, f) in coordinates.iter().zip(forces) {
            expected[i as usize] = f;
        }
        gear.correct(at(2.0, &q, &v), c, 0.0, &mut expected)
            .unwrap();
        let mut found = vec![0.0; n];
        gear.add_response(at(2.0, &q, &v), c, 0.0, (&coordinates, &forces), &mut found)
            .unwrap();
        let size = expected.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        for (a, b) in expected.iter().zip(&found) {
            assert!((a - b).abs() < 1e-12 * size, "{a} {b}");
        }
        let mut g = vec![0.0; 25];
        gear.condensed(at(2.0, &q, &v), c, 0.0, &coordinates, &mut g)
            .unwrap();
        for (row, &i) in coordinates.iter().enumerate() {
            let at_node: f64 = (0..5).map(|j| g[5 * row + j] * forces[j]).sum();
            assert!((at_node - expected[i as usize]).abs() < 1e-12 * size);
        }
    }
}

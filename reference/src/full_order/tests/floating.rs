//! Tests of the floating frame with a ring whose hub moves in several directions, for axes of any orientation.

mod alike;

use super::*;
use crate::full_order::body::AddedInertia;
use gearbench_models::kinematics::{BodyMass, OutOfPlane};
use gearbench_models::spec::{Bearing, Freedom};
use nalgebra::{Matrix3, Rotation3};
use std::sync::Arc;

/// When states are looked at [s].
const T: f64 = 0.05;

fn some_axes() -> [Vec3; 3] {
    let turn = Rotation3::from_euler_angles(0.4, -0.3, 0.9);
    [Vec3::x(), Vec3::y(), Vec3::z()].map(|a| turn * a)
}

fn ramp(from: f64, to: f64) -> Profile {
    Profile::Ramp {
        from,
        to,
        start: 0.0,
        end: 1.0,
    }
}

const FREE: Freedom = Freedom::Free;
const HELD: Freedom = Freedom::Fixed;

fn bearing() -> Bearing {
    let mut b = Bearing::default();
    for d in 0..6 {
        b.stiffness[d][d] = if d < 3 { 3e7 } else { 2e4 };
        b.damping[d][d] = if d < 3 { 200.0 } else { 0.2 };
    }
    (b.stiffness[0][1], b.stiffness[1][0]) = (1e7, 1e7);
    b
}

fn floating(
    (mount, slide): (Mount, Option<Vec3>),
    axes: Option<[Vec3; 3]>,
    lateral: Option<([Freedom; 6], Bearing)>,
    mass: MassKind,
) -> FullOrder {
    let mut hub = hub(mount, slide);
    if let Some(axes) = axes {
        hub.axes = axes;
    }
    hub.lateral = lateral.map(|(mut directions, bearing)| {
        directions[hub.moving()] = HELD;
        Arc::new(OutOfPlane {
            directions,
            bearing,
            // The body has the mass and inertia of the corresponding rigid gear.
            body: BodyMass {
                mass: 1.0,
                inertia: Matrix3::identity(),
                centre: Vec3::zeros(),
            },
            spins: false,
        })
    });
    let placement = Placement::new(&hub, 0.3);
    let slides = slide.is_some();
    let added = AddedInertia {
        own: if slides { 0.02 } else { 1e-5 },
        mass: 0.02,
        tilting: 6e-6,
    };
    let body = Body::floating(ring(10), &Material::STEEL, &placement, &hub, mass, added).unwrap();
    FullOrder::new(hub, 0.04, body)
}

fn floating_cases() -> Vec<FullOrder> {
    let all = [const { FREE }; 6];
    let none = Bearing::default();
    let slide = Some(Vec3::new(0.6, 0.8, 0.0));
    let some = [FREE, FREE, HELD, FREE, FREE, HELD];
    let driven = [
        FREE,
        FREE,
        Freedom::Driven(ramp(0.1, 0.4)),
        Freedom::Driven(ramp(0.3, -0.2)),
        FREE,
        HELD,
    ];
    let mut cases = Vec::new();
    for mass in [MassKind::Consistent, MassKind::Lumped] {
        let axes = || Some(some_axes());
        let turns = || (Mount::Revolute, None);
        cases.push(floating(turns(), axes(), Some((all.clone(), none)), mass));
        cases.push(floating(
            turns(),
            None,
            Some((some.clone(), bearing())),
            mass,
        ));
        cases.push(floating(turns(), axes(), None, mass));
        let held = (Mount::Fixed, None);
        cases.push(floating(
            held,
            axes(),
            Some((some.clone(), bearing())),
            mass,
        ));
        let spun = (Mount::Driven(ramp(30.0, 80.0)), None);
        cases.push(floating(spun, axes(), Some((driven.clone(), none)), mass));
        let slides = (Mount::Prismatic, slide);
        cases.push(floating(slides, None, Some((all.clone(), bearing())), mass));
    }
    cases
}

/// A hub that is displaced, tilted and turned, with small displacements and velocities of the nodes on top.
fn moved(gear: &FullOrder, moves: f64) -> (Vec<f64>, Vec<f64>) {
    bent(gear, moves, 1e-6)
}

/// Returns a state with displacements of another magnitude.
fn bent(gear: &FullOrder, moves: f64, size: f64) -> (Vec<f64>, Vec<f64>) {
    let (n, own) = (gear.hub().len(), gear.own);
    let (mut q, mut v) = (vec![0.0; n], vec![0.0; n]);
    for (k, d) in gear.hub().free_directions().enumerate() {
        let x = [1e-3, -2e-3, 5e-4, 0.11, -0.07, 0.7][d];
        let rate = [0.3, 0.2, -0.4, 5.0, -3.0, 40.0][d];
        (q[k], v[k]) = (x, moves * rate);
    }
    let frame_pose = gear.frame_pose(at(T, &q, &v));
    let jitter = noise(3 * gear.body().free.len(), size);
    for (k, &node) in gear.body().free.iter().enumerate() {
        let place = gear.body().position[node as usize];
        let carried = frame_pose.frame().carried(&place);
        let velocity = frame_pose.velocity(&(frame_pose.turn * place));
        for axis in 0..3 {
            q[own + 3 * k + axis] = carried[axis] + jitter[3 * k + axis];
            let other = jitter[(7 * k + axis) % jitter.len()];
            v[own + 3 * k + axis] = velocity[axis] + moves * 3e3 * other;
        }
    }
    (q, v)
}

fn accelerations(gear: &mut FullOrder, q: &[f64], v: &[f64]) -> Vec<f64> {
    let mut a = vec![0.0; q.len()];
    gear.forces(at(T, q, v), &mut a);
    solve_mass(gear, at(T, q, v), &mut a);
    a
}

/// The central difference of something along the motion.
fn rate<X>(q: &[f64], v: &[f64], a: &[f64], of: impl Fn(StateView<'_>) -> X) -> X
where
    X: std::ops::Sub<Output = X> + std::ops::Div<f64, Output = X>,
{
    let h = 1e-9;
    let side = |sign: f64| {
        let h = sign * h;
        let moved = |x: &[f64], r: &[f64], second: f64| -> Vec<f64> {
            (x.iter().zip(r).zip(a))
                .map(|((x, r), a)| x + h * (r + second * h * a))
                .collect()
        };
        of(at(T + h, &moved(q, v, 0.5), &moved(v, a, 0.0)))
    };
    (side(1.0) - side(-1.0)) / (2.0 * h)
}

#[test]
fn tangents_are_derivatives() {
    for (case, mut gear) in floating_cases().into_iter().enumerate() {
        let (q, v) = moved(&gear, 1.0);
        let n = q.len();
        let (dq, dv) = (noise(n, 1e-7), noise(n, 1e-3));
        let mut exact = vec![0.0; n];
        gear.tangent(at(T, &q, &v), &dq, &dv, &mut exact);
        let mut side = |sign: f64| {
            let shift = |x: &[f64], d: &[f64]| -> Vec<f64> {
                x.iter().zip(d).map(|(x, d)| x + sign * d).collect()
            };
            let mut f = vec![0.0; n];
            gear.forces(at(T, &shift(&q, &dq), &shift(&v, &dv)), &mut f);
            f
        };
        let (plus, minus) = (side(1.0), side(-1.0));
        let own = gear.own;
        for part in [0..own, own..n] {
            let of = |x: &[f64]| x[part.clone()].iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            let largest = of(&exact);
            for i in part.clone() {
                let difference = 0.5 * (plus[i] - minus[i]);
                let error = (difference - exact[i]).abs();
                assert!(
                    error < 2e-6 * largest,
                    "{case}, {i}: {difference} {}",
                    exact[i]
                );
            }
        }
    }
}

/// With bearings, drives and spin terms the energy changes by the supplied less the dissipated power.
#[test]
fn energy_changes_by_the_powers() {
    for (case, mut gear) in floating_cases().into_iter().enumerate() {
        let (q, v) = moved(&gear, 1.0);
        let a = accelerations(&mut gear, &q, &v);
        let gain = rate(&q, &v, &a, |at| gear.energy(at).total());
        let powers = gear.powers(at(T, &q, &v));
        let energy = gear.energy(at(T, &q, &v));
        let power = powers.external - powers.dissipated;
        // Power of the elastic forces alone, which may cancel.
        let mut f = vec![0.0; q.len()];
        gear.forces(at(T, &q, &v), &mut f);
        let scale: f64 = f.iter().zip(&v).map(|(f, v)| (f * v).abs()).sum();
        assert!(energy.kinetic > 0.0 && scale > 0.0);
        assert!(
            (gain - power).abs() < 1e-5 * scale,
            "{case}: {gain} {power} of {scale}"
        );
    }
}

/// A free floating, spinning, vibrating body conserves both momenta; bearings change the linear one by their force.
#[test]
fn momentum_changes_by_what_acts() {
    for (case, mut gear) in floating_cases().into_iter().enumerate() {
        let free = gear.hub().free_directions().count();
        if free < 6 {
            continue;
        }
        let (q, v) = moved(&gear, 1.0);
        let a = accelerations(&mut gear, &q, &v);
        let centre = gear.hub().centre;
        let of = |at: StateView<'_>| {
            let [linear, angular] = gear.momenta(at);
            let origin = centre + gear.frame_pose(at).shift;
            nalgebra::Matrix3x2::from_columns(&[linear, angular + origin.cross(&linear)])
        };
        let found = rate(&q, &v, &a, of);
        let frame_pose = gear.frame_pose(at(T, &q, &v));
        let lateral = gear.hub().lateral.clone().unwrap();
        let exerted = lateral.bearing_forces(&frame_pose.motion);
        let force: Vec3 = (0..3).map(|d| exerted[d] * frame_pose.axes[d]).sum();
        let internal = {
            let mut f = vec![0.0; q.len()];
            gear.forces(at(T, &q, &v), &mut f);
            f.iter().fold(0.0_f64, |m, x| m.max(x.abs()))
        };
        let scale = internal + force.norm();
        let error = (found.column(0) - force).norm();
        assert!(error < 1e-6 * scale, "{case}: {error} of {scale}");
        if lateral.bearing == Bearing::default() {
            let error = found.column(1).norm();
            assert!(error < 1e-6 * scale * 0.3, "{case}: {error} of {scale}");
        }
    }
}

#[test]
fn forces_are_slopes_and_masses_are_solved() {
    for (case, mut gear) in floating_cases().into_iter().enumerate() {
        let (q, _) = moved(&gear, 0.0);
        let (n, v) = (q.len(), vec![0.0; q.len()]);
        if !gear.hub().is_driven() {
            let mut f = vec![0.0; n];
            gear.forces(at(T, &q, &v), &mut f);
            let dq = noise(n, 1e-8);
            let energy = |sign: f64| {
                let q: Vec<f64> = q.iter().zip(&dq).map(|(x, d)| x + sign * d).collect();
                gear.energy(at(T, &q, &v)).strain
            };
            let slope = 0.5 * (energy(1.0) - energy(-1.0));
            let work: f64 = f.iter().zip(&dq).map(|(f, d)| f * d).sum();
            assert!(
                (work + slope).abs() < 1e-5 * slope.abs(),
                "{case}: {work} {slope}"
            );
        }
        let a = noise(n, 1.0);
        let mut f = vec![0.0; n];
        CoupledMass::apply(&gear, at(T, &q, &v), &a, &mut f);
        CoupledMass::solve(&gear, at(T, &q, &v), &mut f);
        for (i, (a, b)) in a.iter().zip(&f).enumerate() {
            assert!((a - b).abs() < 1e-8, "{case}, {i}: {a} {b}");
        }
    }
}

#[test]
fn corrections_invert_the_tangent_and_condense() {
    for (case, mut gear) in floating_cases().into_iter().enumerate() {
        // What is left out is of the order of the strain.
        let (q, v) = bent(&gear, 0.0, 1e-8);
        let (n, own) = (q.len(), gear.own);
        let now = at(T, &q, &v);
        let c = Coeffs {
            m: 1.0,
            d: 1e-6,
            k: 1e-12,
        };
        let x = noise(n, 1e-6);
        let mut rhs = vec![0.0; n];
        CoupledMass::apply(&gear, now, &x, &mut rhs);
        let mut tangent = vec![0.0; n];
        let along = |by: f64| -> Vec<f64> { x.iter().map(|x| by * x).collect() };
        gear.tangent(now, &along(c.k), &along(c.d), &mut tangent);
        rhs.iter_mut().zip(&tangent).for_each(|(r, t)| *r -= t);
        let damping = 3.0;
        if gear.hub().is_free() {
            rhs[0] += c.d * damping * x[0];
        }
        gear.correct(now, c, damping, &mut rhs).unwrap();
        let misses = rhs.iter().zip(&x).map(|(a, b)| (a - b).abs());
        let error = misses.fold(0.0, f64::max);
        assert!(error < 1e-4 * 1e-6, "{case}: {error}");

        let first = own as u32;
        let mut coordinates: Vec<u32> = (0..first).collect();
        coordinates.extend([first + 31, first + 30, first + 4, first + 32]);
        let m = coordinates.len();
        let forces = noise(m, 3.0);
        let mut expected = vec![0.0; n];
        for (&i, f) in coordinates.iter().zip(&forces) {
            expected[i as usize] = *f;
        }
        gear.correct(now, c, damping, &mut expected).unwrap();
        let mut found = vec![0.0; n];
        let touched = (&coordinates[..], &forces[..]);
        gear.add_response(now, c, damping, touched, &mut found)
            .unwrap();
        let size = expected.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        for (a, b) in expected.iter().zip(&found) {
            assert!((a - b).abs() < 1e-10 * size, "{case}: {a} {b}");
        }
        let mut g = vec![0.0; m * m];
        gear.condensed(now, c, damping, &coordinates, &mut g)
            .unwrap();
        for (row, &i) in coordinates.iter().enumerate() {
            let there: f64 = (0..m).map(|j| g[m * row + j] * forces[j]).sum();
            assert!(
                (there - expected[i as usize]).abs() < 1e-10 * size,
                "{case}"
            );
            for column in 0..row {
                let (a, b) = (g[m * row + column], g[m * column + row]);
                assert!((a - b).abs() < 1e-10 * size);
            }
        }
    }
}

//! Power of a drive, and the reaction of the mount.

use super::*;

#[test]
fn a_drive_puts_in_what_the_energy_gains() {
    for mass in [MassKind::Consistent, MassKind::Lumped] {
        let ramp = Profile::Ramp {
            from: 30.0,
            to: 80.0,
            start: 0.0,
            end: 1.0,
        };
        let mut gear = gear(Mount::Driven(ramp), None, mass);
        let t = 0.5;
        let (q, v) = state(
            &gear,
            gear.hub().displacement(t, &[]),
            gear.hub().speed(t, &[]),
        );
        let mut a = vec![0.0; q.len()];
        gear.forces(at(t, &q, &v), &mut a);
        solve_mass(&gear, at(t, &q, &v), &mut a);
        let h = 1e-9;
        let energy = |sign: f64| {
            let (mut q, mut v) = (q.clone(), v.clone());
            for i in 0..q.len() {
                q[i] += sign * h * (v[i] + 0.5 * sign * h * a[i]);
                v[i] += sign * h * a[i];
            }
            gear.energy(at(t + sign * h, &q, &v)).total()
        };
        let gain = (energy(1.0) - energy(-1.0)) / (2.0 * h);
        let power = gear.driven_power(at(t, &q, &v));
        assert!((gain / power - 1.0).abs() < 1e-3, "{mass:?} {gain} {power}");
    }
}

/// The mount's force and torque are the rates of momentum less the contact forces, for any state and any forces.
#[test]
fn the_mount_gives_what_momentum_takes() {
    for mut g in cases() {
        let lumped = g.body().mass == MassKind::Lumped;
        let driven = matches!(g.hub().mount, Mount::Driven(_));
        if !(lumped || driven) {
            continue;
        }
        let own = g.hub().coordinates();
        let (displacement, speed) = (
            g.hub().displacement(0.5, &[0.4]),
            g.hub().speed(0.5, &[90.0]),
        );
        let (q, v) = state(&g, displacement, speed);
        let at = at(0.5, &q, &v);
        // Contact forces on free nodes, in space.
        let forces: Vec<f64> = (0..q.len())
            .map(|i| {
                if i >= own {
                    40.0 * noise(q.len(), 1.0)[i]
                } else {
                    0.0
                }
            })
            .collect();
        let mut a = forces.clone();
        g.forces(at, &mut a);
        solve_mass(&g, at, &mut a);
        let (centre, slide) = (g.hub().centre, g.hub().slide);
        let nodes = g.body().position.len();
        let numbers: Vec<u32> = (0..nodes as u32).collect();
        let mut x = vec![Vec3::zeros(); nodes];
        g.positions(at, &numbers, &mut x);
        let acceleration = if own > 0 {
            a[0]
        } else {
            g.hub.prescribed_acceleration(0.5)
        };
        let (mut all, mut image) = (vec![0.0; 3 * nodes], vec![0.0; 3 * nodes]);
        let mut contact = gearbench_models::kinematics::Wrench::default();
        for node in 0..nodes {
            let place = g.body().place[node];
            let r = x[node] - centre;
            let of_node = match (place, slide) {
                (crate::assembly::tie::Tie::HELD, Some(e)) => acceleration * e,
                (crate::assembly::tie::Tie::HELD, None) => {
                    acceleration * Vec3::new(-r.y, r.x, 0.0)
                        - speed * speed * Vec3::new(r.x, r.y, 0.0)
                }
                (place, _) => {
                    let f = Vec3::from_column_slice(&forces[own + 3 * place as usize..][..3]);
                    contact.force += f;
                    contact.torque += g.hub().effective_radius(&x[node], &f);
                    Vec3::from_column_slice(&a[own + 3 * place as usize..][..3])
                }
            };
            all[3 * node..][..3].copy_from_slice(of_node.as_slice());
        }
        g.body().apply_nodal_mass(&all, &mut image);
        let (mut rate, mut turning) = (Vec3::zeros(), g.body().added_inertia * acceleration);
        for node in 0..nodes {
            let f = Vec3::from_column_slice(&image[3 * node..][..3]);
            rate += f;
            turning += g.hub().effective_radius(&x[node], &f);
        }
        let r = g.mount_reaction(at, &forces, &contact);
        let mut exact = rate - contact.force;
        if let (Some(e), true) = (slide, own > 0) {
            // Its hub's own inertia is added along the slide.
            exact -= exact.dot(&e) * e;
        }
        let scale = rate.norm() + contact.force.norm();
        let error = (r.force - exact).xy().norm() / scale;
        assert!(error < 1e-10, "{:?} {lumped}: {error:e}", g.hub().mount);
        let exact = if own > 0 {
            0.0
        } else {
            turning - contact.torque
        };
        let error = (r.torque - exact).abs() / (turning.abs() + contact.torque.abs());
        assert!(
            error < 1e-9,
            "{:?} {lumped}: torque {error:e}",
            g.hub().mount
        );
    }
}

//! Mount reactions of the elastic gear compared with the rows of the finite elements at the nodes tied to the hub.

use super::choose::{self, ModalDamping};
use super::surface::Surface;
use super::{ModeSelection, Mounting, basis};
use crate::assembly::assemble;
use crate::assembly::tie::{MassKind, Tie};
use crate::gear_mesh::{self, GearMesh};
use crate::modes::{self, Options};
use crate::test_support::{coarse, hub, noise, rack, stub};
use gearbench_integrators::system::StateView;
use gearbench_models::Vec3;
use gearbench_models::gear::elastic::Elastic;
use gearbench_models::gear::{FlankDisplacement, GearModel};
use gearbench_models::kinematics::{Placement, Wrench};
use gearbench_models::spec::Mount;
use gearbench_models::stiffness::Material;
use std::sync::Arc;

fn bodies() -> [(GearMesh, Mounting, Mount, Option<Vec3>); 4] {
    let gear = stub(6, 0.0);
    let rack = rack(2, 4e-3, |p| p.body_height = 8e-3);
    let wheel = || gear_mesh::gear(&gear, &coarse(1, 1)).unwrap();
    let bar = || gear_mesh::rack(&rack, &coarse(1, 1)).unwrap();
    let slide = Some(Vec3::new(-0.6, 0.8, 0.0));
    [
        (wheel(), Mounting::gear(true, 1e-5), Mount::Revolute, None),
        (wheel(), Mounting::gear(false, 0.0), Mount::Fixed, None),
        (bar(), Mounting::rack(true, 0.1), Mount::Prismatic, slide),
        (bar(), Mounting::rack(false, 0.0), Mount::Fixed, slide),
    ]
}

/// With all modes the mount reaction equals the stiffness and mass forces at the tied nodes, in motion as at rest.
#[test]
fn with_all_modes_reactions_are_those_of_the_held_nodes() {
    for (mesh, mounting, mount, slide) in bodies() {
        let case = format!("{mount:?}, slide {slide:?}");
        let free = mounting.free;
        let assembly = assemble(&mesh.mesh, &Material::STEEL).unwrap();
        let tie = Tie::new(&mesh.mesh.nodes, &mesh.bore, &mounting.motions());
        let added = [mounting.added_inertia];
        let r = tie.reduce(&assembly, &added[..usize::from(free)], MassKind::Consistent);
        let all = tie.coordinates();
        let found = modes::lowest(&r, all, &Options::default()).unwrap();
        let rigid = usize::from(free);
        let wanted = ModeSelection::Count(all - rigid);
        let basis =
            basis::of_mesh(&mesh, &Material::STEEL, &mounting, wanted, false, None).unwrap();
        let kept: Vec<usize> = (0..all - rigid).collect();
        let data = choose::reduced(&basis, &kept, &ModalDamping::default(), false).unwrap();

        let hub = hub(mount, slide);
        let placement = Placement::new(&hub, 0.7);
        let gear = Elastic::new(hub, 0.02, placement, Arc::new(data)).unwrap();
        // A state at an angle, deflected and vibrating; forces on some nodes and a load on the hub.
        let n = gear.hub().len();
        let mut q: Vec<f64> = noise(n, 1.0);
        for (i, q) in q.iter_mut().enumerate().skip(rigid) {
            // The amplitudes are small, so that the rotation by the deflection is negligible.
            *q *= 10.0 / basis.omega[i - rigid].powi(2);
        }
        if free {
            q[0] = 0.4;
        }
        let v = vec![0.0; n];
        let at = StateView {
            t: 0.0,
            q: &q,
            v: &v,
            discrete: &[],
        };
        let surface = Surface::new(&mesh).unwrap();
        let nodes: Vec<u32> = (0..surface.nodes() as u32).step_by(5).collect();
        let pressed: Vec<f64> = noise(nodes.len(), 300.0).iter().map(|f| f.abs()).collect();
        let mut forces = vec![0.0; n];
        gear.apply_nodal_forces(&nodes, &pressed, &mut forces);
        let pose = placement.pose(if free { 0.4 } else { 0.0 });
        let mut contact = Wrench::default();
        let positions = surface.positions();
        for (&k, f) in nodes.iter().zip(&pressed) {
            let x = pose.point(&positions[k as usize]);
            let f = -*f * pose.turn(&surface.directions[k as usize]);
            contact.force += f;
            contact.torque += gear.hub().effective_radius(&x, &f);
        }
        if free {
            forces[0] += contact.torque;
        }
        gear.hub().add_load(12.0, &mut forces);
        let reaction = gear.mount_reaction(at, &forces, &contact);

        // The same by the finite elements, own frame: K u + M a at the held nodes.
        let mut state = vec![0.0; all];
        let mut rate = vec![0.0; all];
        for i in rigid..all {
            let a = forces[i] - basis.omega[i - rigid].powi(2) * q[i];
            for j in 0..all {
                state[j] += q[i] * found.vectors[(j, i)];
                rate[j] += a * found.vectors[(j, i)];
            }
        }
        let size = 3 * mesh.mesh.nodes.len();
        let [mut u, mut a, mut ku, mut ma] = [(); 4].map(|()| vec![0.0; size]);
        tie.expand(&state, &mut u);
        tie.expand(&rate, &mut a);
        if free {
            let turn = forces[0] / basis.inertia;
            for (a, e) in a.iter_mut().zip(mounting.rigid(&mesh.mesh.nodes)) {
                *a += turn * e;
            }
        }
        assembly.stiffness.apply(&u, &mut ku);
        assembly.mass.apply(&a, &mut ma);
        let (mut force, mut torque) = (Vec3::zeros(), 0.0);
        for &node in &mesh.bore {
            let f = |x: &[f64]| Vec3::from_column_slice(&x[3 * node as usize..][..3]);
            let f = f(&ku) + f(&ma);
            force += f;
            torque += f.dot(&mounting.motion.of(&mesh.mesh.nodes[node as usize]));
        }
        let mut force = pose.turn(&force);
        if let (Some(e), true) = (slide, free) {
            // Load and inertia added at the hub act along the slide.
            force -= force.dot(&e) * e;
        }
        let scale = contact.force.norm();
        let error = (reaction.force - force).xy().norm() / scale;
        assert!(error < 1e-7, "{case}: {error:e}");
        let inertial = (contact.force + reaction.force).xy().norm() / scale;
        assert!(inertial > 0.02, "{case}: nothing moves, {inertial:e}");
        let torque = if free { 0.0 } else { torque };
        let error = (reaction.torque - torque).abs() / contact.torque.abs();
        assert!(error < 1e-7, "{case}: torque {error:e}");
    }
}

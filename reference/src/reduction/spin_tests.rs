//! A turning gear stretches as a rotating ring on a rigid hub does.

use super::choose::{self, ModalDamping};
use super::{ModeSelection, Mounting, basis};
use crate::gear_mesh::sector;
use crate::test_support::{counted, gear, hub};
use gearbench_integrators::system::StateView;
use gearbench_models::gear::elastic::{Elastic, SpinTerms};
use gearbench_models::gear::{FlankDisplacement, GearModel};
use gearbench_models::kinematics::Placement;
use gearbench_models::spec::{Mount, Profile};
use gearbench_models::stiffness::Material;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Returns the radial displacement over the square of the speed [m s^2] at the outer radius `b` of a thin ring
/// supported at `a`, with a load per area there: `u = A r + B/r - (1 - nu^2) rho r^3 / (8 E)` (S. Timoshenko, J. N.
/// Goodier, *Theory of Elasticity*, 3rd ed., 1970, art. 32).
fn stretch(steel: &Material, a: f64, b: f64, load: f64) -> f64 {
    let (e, nu, rho) = (steel.young, steel.poisson, steel.density);
    let body = (1.0 - nu * nu) * rho / (8.0 * e);
    // u(a) = 0 and sigma_r(b) = load.
    let (p, q) = (1.0 + nu, (1.0 - nu) / (b * b));
    let right = (load + (3.0 + nu) * rho * b * b / 8.0) * (1.0 - nu * nu) / e;
    // A a + B/a = body a^3, A p - B q = right.
    let det = -a * q - p / a;
    let big_a = (-body * a.powi(3) * q - right / a) / det;
    let big_b = (a * right - body * a.powi(3) * p) / det;
    big_a * b + big_b / b - body * b.powi(3)
}

/// Returns the relative difference of the expansion of a gear of 60 mm from that of a ring whose teeth are loads
/// alone.
fn off_the_ring(teeth: u32) -> f64 {
    let steel = Material::STEEL;
    let g = gear(teeth, 0.06 / f64::from(teeth), |p| {
        p.face_width = 2e-3;
        p.bore_radius = 12e-3;
    });
    let mesh = sector(&g, &counted(3, 24, 1)).unwrap();
    let mounting = Mounting::gear(false, 0.0);
    let basis =
        basis::of_sector(&mesh, &steel, &mounting, ModeSelection::Count(1500), false).unwrap();
    let all: Vec<usize> = (0..basis.omega.len()).collect();
    let data = choose::reduced(&basis, &all, &ModalDamping::default(), false).unwrap();
    let speed = 1e3;
    let hub = hub(Mount::Driven(Profile::Constant(speed)), None);
    let placement = Placement::new(&hub, 0.0);
    let mut turning = Elastic::new(hub, 0.02, placement, Arc::new(data))
        .and_then(|gear| gear.with_spin_terms(SpinTerms::Full))
        .unwrap();
    // At rest in the turning frame; the softening is small, so that a few corrections find it.
    let n = all.len();
    let (mut q, v) = (vec![0.0; n], vec![0.0; n]);
    for _ in 0..4 {
        let mut f = vec![0.0; n];
        let at = StateView {
            t: 0.0,
            q: &q,
            v: &v,
            discrete: &[],
        };
        turning.forces(at, &mut f);
        for ((q, f), w) in q.iter_mut().zip(&f).zip(&basis.omega) {
            *q += f / (w * w);
        }
    }
    // Outward displacements of the lowest nodes of the flanks, which the ring carries along.
    let mut radial = Vec::new();
    for grid in basis.flanks.grids() {
        let nodes = &grid.nodes[..grid.columns];
        let mut out = vec![0.0; nodes.len()];
        turning.displacements(&q, nodes, &mut out);
        for ((node, x), u) in nodes.iter().zip(&grid.positions).zip(&out) {
            let n = &basis.normals[*node as usize];
            let along = (n.x * x.x + n.y * x.y) / x.x.hypot(x.y);
            radial.push(u / along);
        }
    }
    let found = radial.iter().sum::<f64>() / radial.len() as f64;
    let spread = radial
        .iter()
        .fold(0.0_f64, |m, x| m.max((x / found - 1.0).abs()));
    let (a, b) = (g.params().bore_radius, g.r_root());
    let mass = g.mass_properties(steel.density).mass;
    let of_ring = steel.density * 0.5 * TAU * (b * b - a * a) * g.face_width();
    let load = (mass - of_ring) * 0.5 * (b + g.r_tip()) / (TAU * b * g.face_width());
    let exact = stretch(&steel, a, b, load) * speed * speed;
    assert!(spread < 1e-9, "teeth stretch unevenly: {spread:.1e}");
    1.0 - found / exact
}

/// A rotating gear expands like a ring, more closely the finer its teeth: the feet of the teeth stiffen the rim, over
/// a part of their height, which vanishes with it. The rest is from radial modes above the computed ones.
#[test]
fn a_turning_gear_stretches_as_a_ring_the_finer_its_teeth() {
    let [coarse, fine] = [120, 360].map(off_the_ring);
    let order = (coarse / fine).ln() / 3.0_f64.ln();
    let left = fine - 0.5 * (coarse - fine);
    assert!(
        (order - 1.0).abs() < 0.3,
        "{coarse} and {fine}: of order {order}"
    );
    assert!(
        left.abs() < 1e-2,
        "{coarse} and {fine}: {left} left of teeth without end"
    );
}

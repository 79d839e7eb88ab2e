//! Integrals compared with the kinetic energy of nodes, one sector with the whole mesh, and a spinning disc.

use super::*;
use crate::assembly::assemble;
use crate::gear_mesh::{self, GearMesh, GearMeshParams};
use crate::mesh::{ElementKind, Mesh};
use crate::reduction::choose::{ModalDamping, reduced};
use crate::reduction::{Basis, ModeSelection, Mounting, basis};
use crate::test_support::{self, coarse};
use crate::vector::dot;
use gearbench_integrators::system::StateView;
use gearbench_models::gear::GearModel;
use gearbench_models::gear::elastic::inertia::AUTO_LIMIT;
use gearbench_models::gear::elastic::{Elastic, SpinTerms};
use gearbench_models::geometry::{FlankGrid, Gear, Side};
use gearbench_models::kinematics::{Hub, Placement};
use gearbench_models::spec::{Mount, Profile};
use gearbench_models::stiffness::Material;
use std::sync::Arc;

fn gear() -> (Gear, GearMeshParams) {
    let gear = test_support::gear(10, 4e-3, |p| {
        p.profile_shift = 0.48;
        p.face_width = 8e-3;
        p.bore_radius = 5e-3;
    });
    (gear, coarse(2, 1))
}

fn noise(n: usize, seed: f64) -> Vec<f64> {
    (0..n)
        .map(|i| ((i as f64 * 12.9898 + seed).sin() * 43_758.545_3).fract())
        .collect()
}

/// Any fields will do for shapes: the kinetic energy of the nodes is that of the integrals.
#[test]
fn kinetic_energy_is_that_of_the_nodes() {
    let (gear, params) = gear();
    let mesh = gear_mesh::gear(&gear, &params).unwrap().mesh;
    let mass = assemble(&mesh, &Material::STEEL).unwrap().mass;
    let n = 3 * mesh.nodes.len();
    let fields = [1.0, 2.0, 3.0].map(|seed| noise(n, seed));
    let i = of_mesh(&mass, &mesh.nodes, 3, |k, u| u.copy_from_slice(&fields[k])).unwrap();
    let (q, rate, speed) = (noise(3, 4.0), noise(3, 5.0), 0.7);
    // Displaced as far as the gear is large, or the linear terms would hide the others.
    let q: Vec<f64> = q.iter().map(|x| 0.05 * x).collect();
    let rate: Vec<f64> = rate.iter().map(|x| 0.03 * x).collect();
    let mut velocity = vec![0.0; n];
    let mut own = vec![0.0; n];
    for (node, x) in mesh.nodes.iter().enumerate() {
        let mut place = *x;
        let mut own_rate = Vec3::zeros();
        for k in 0..3 {
            let u = Vec3::from_column_slice(&fields[k][3 * node..][..3]);
            place += q[k] * u;
            own_rate += rate[k] * u;
        }
        let turning = speed * Vec3::new(-place.y, place.x, 0.0);
        velocity[3 * node..][..3].copy_from_slice((turning + own_rate).as_slice());
        own[3 * node..][..3].copy_from_slice(own_rate.as_slice());
    }
    let mut image = vec![0.0; n];
    let mut twice = |v: &[f64]| {
        mass.apply(v, &mut image);
        dot(v, &image)
    };
    let exact = twice(&velocity);
    let square = |a: &[f64], x: &[f64], y: &[f64]| -> f64 {
        (0..3).map(|r| x[r] * dot(&a[3 * r..][..3], y)).sum()
    };
    let inertia = i.tensor[8] + 2.0 * dot(&i.radial, &q) + square(&i.planar, &q, &q);
    let coupling: f64 = (0..3).map(|k| i.rotation[3 * k + 2] * rate[k]).sum::<f64>()
        + square(&i.gyroscopic, &q, &rate);
    let found = speed * speed * inertia + 2.0 * speed * coupling + twice(&own);
    assert!((found / exact - 1.0).abs() < 1e-12, "{found} {exact}");
    // A slide along x: M_te is its momentum.
    let mut along: Vec<f64> = vec![0.0; n];
    along.iter_mut().step_by(3).for_each(|x| *x = 1.0);
    mass.apply(&along, &mut image);
    for k in 0..3 {
        assert!((i.translation[3 * k] - dot(&fields[k], &image)).abs() < 1e-12);
    }
    assert!((i.mass - dot(&along, &image)).abs() < 1e-12 * i.mass);
}

#[test]
fn sector_and_whole_mesh_agree() {
    let (gear, params) = gear();
    let whole = gear_mesh::gear(&gear, &params).unwrap();
    let sector = gear_mesh::sector(&gear, &params).unwrap();
    let mounting = Mounting::gear(true, 1e-5);
    let a = basis::of_sector(
        &sector,
        &Material::STEEL,
        &mounting,
        ModeSelection::Count(41),
        false,
    )
    .unwrap();
    let b = basis::of_mesh(
        &whole,
        &Material::STEEL,
        &mounting,
        ModeSelection::Count(41),
        false,
        None,
    )
    .unwrap();
    let (x, y) = (a.integrals.unwrap(), b.integrals.unwrap());
    assert!((x.mass / y.mass - 1.0).abs() < 1e-12);
    for k in 0..3 {
        assert!((x.centre[k] - y.centre[k]).abs() < 1e-12);
    }
    for k in 0..9 {
        assert!((x.tensor[k] - y.tensor[k]).abs() < 1e-12 * x.tensor[8]);
    }
    assert!((x.tensor[8] + 1e-5 - a.inertia).abs() < 1e-12 * a.inertia);
    // Pairs may be turned: what counts is the size of the blocks.
    let families = |f: &[u32]| -> Vec<std::ops::Range<usize>> {
        let mut first = 0;
        f.chunk_by(|a, b| a == b)
            .map(|c| {
                first += c.len();
                first - c.len()..first
            })
            .collect()
    };
    let (f, g) = (families(&a.family), families(&b.family));
    let (m, n) = (x.modes(), y.modes());
    let count = f.len().min(g.len()) - 1;
    let norm = |v: &[f64], r: &std::ops::Range<usize>, per: usize| {
        v[per * r.start..per * r.end]
            .iter()
            .map(|x| x * x)
            .sum::<f64>()
            .sqrt()
    };
    let block = |v: &[f64], n: usize, r: &std::ops::Range<usize>, s: &std::ops::Range<usize>| {
        let square = r
            .clone()
            .flat_map(|i| s.clone().map(move |j| v[i * n + j].powi(2)));
        square.sum::<f64>().sqrt()
    };
    let (mut couples, mut spins) = (0, 0);
    for i in 0..count {
        assert_eq!(f[i], g[i]);
        for (v, w, per, scale) in [
            (&x.translation, &y.translation, 3, 1.0),
            (&x.rotation, &y.rotation, 3, 0.02),
            (&x.radial, &y.radial, 1, 0.02),
        ] {
            let (p, q) = (norm(v, &f[i], per), norm(w, &f[i], per));
            assert!((p - q).abs() < 1e-6 * scale, "family {i}: {p} {q}");
        }
        for j in 0..count {
            let (p, q) = (
                block(&x.planar, m, &f[i], &f[j]),
                block(&y.planar, n, &f[i], &f[j]),
            );
            assert!((p - q).abs() < 1e-6, "G {i} {j}: {p} {q}");
            couples += u32::from(p > 1e-3);
            let p = block(&x.gyroscopic, m, &f[i], &f[j]);
            let q = block(&y.gyroscopic, n, &f[i], &f[j]);
            assert!((p - q).abs() < 1e-6, "C {i} {j}: {p} {q}");
            spins += u32::from(p > 1e-3);
        }
    }
    assert!(couples > 20 && spins > 20);
    // No mode of a free gear rotates the body: its rotation integral cancels that of the added inertia at the hub.
    let own = |i: usize| x.rotation[3 * i + 2] + 1e-5 * a.hub[i];
    assert!((0..m).all(|i| own(i).abs() < 1e-8 * a.inertia.sqrt()));
}

const INNER: f64 = 0.02;
const OUTER: f64 = 0.06;
const THICKNESS: f64 = 1e-3;

/// A sector of a thin disc on a stiff shaft; its rim is the flank.
fn disc(teeth: u32, around: usize, across: usize) -> GearMesh {
    let pitch = TAU / f64::from(teeth);
    let at = |c: usize, r: usize, l: usize| ((c * (across + 1) + r) * 2 + l) as u32;
    let mut nodes = Vec::new();
    for c in 0..=around {
        let (sin, cos) = (pitch * (c as f64 / around as f64 - 0.5)).sin_cos();
        for r in 0..=across {
            let radius = INNER + (OUTER - INNER) * r as f64 / across as f64;
            for z in [-0.5 * THICKNESS, 0.5 * THICKNESS] {
                nodes.push(Vec3::new(radius * cos, radius * sin, z));
            }
        }
    }
    let mut connectivity = Vec::new();
    for c in 0..around {
        for r in 0..across {
            for l in 0..2 {
                connectivity.extend([
                    at(c, r, l),
                    at(c, r + 1, l),
                    at(c + 1, r + 1, l),
                    at(c + 1, r, l),
                ]);
            }
        }
    }
    let cut = |c: usize| {
        (0..=across)
            .flat_map(move |r| [at(c, r, 0), at(c, r, 1)])
            .collect()
    };
    let rim: Vec<u32> = [1, 2]
        .iter()
        .flat_map(|&c| [at(c, across, 0), at(c, across, 1)])
        .collect();
    let flank = FlankGrid {
        tooth: 0,
        side: Side::Right,
        rows: 2,
        columns: 2,
        positions: rim.iter().map(|&n| nodes[n as usize]).collect(),
        nodes: rim,
    };
    GearMesh {
        mesh: Mesh {
            node_sets: [
                ("cut_low".to_string(), cut(0)),
                ("cut_high".to_string(), cut(around)),
            ]
            .into(),
            ..Mesh::new(ElementKind::C3D8I, nodes, connectivity)
        },
        teeth,
        bore: (0..=around)
            .flat_map(|c| [at(c, 0, 0), at(c, 0, 1)])
            .collect(),
        flanks: vec![flank],
        tied: Vec::new(),
    }
}

/// How far the rim of a spinning disc on a stiff shaft expands in plane stress (S. P. Timoshenko, J. N. Goodier,
/// *Theory of Elasticity*, section 32): `u = A r + B / r - (1 - nu^2) rho w^2 r^3 / (8 E)`.
fn expansion(speed: f64) -> f64 {
    let Material {
        young: e,
        poisson: nu,
        density,
    } = Material::STEEL;
    let (a, b) = (INNER, OUTER);
    let load = density * speed * speed;
    let particular = (1.0 - nu * nu) * load / (8.0 * e);
    // u(a) = 0, and no radial stress at b.
    let right = (3.0 + nu) * load * b * b / 8.0 * (1.0 - nu * nu) / e;
    let (p, q) = (1.0 + nu, -(1.0 - nu) / (b * b));
    // A a + B / a = particular a^3;  p A + q B = right.
    let big_a = (particular * a.powi(3) * q - right / a) / (a * q - p / a);
    let big_b = (right - p * big_a) / q;
    big_a * b + big_b / b - particular * b.powi(3)
}

fn elastic(b: &Basis, speed: f64, terms: SpinTerms) -> Elastic {
    let all: Vec<usize> = (0..b.omega.len()).collect();
    let data = reduced(b, &all, &ModalDamping::default(), false).unwrap();
    let hub = Hub::new(
        Mount::Driven(Profile::table(vec![0.0], vec![speed])),
        Vec3::zeros(),
        None,
        1.0,
    );
    let placement = Placement::new(&hub, 0.0);
    let gear = Elastic::new(hub, OUTER, placement, Arc::new(data)).unwrap();
    gear.with_spin_terms(terms).unwrap()
}

/// All modes of a disc with three elements per sector.
fn disc_basis(sectors: u32) -> Basis {
    let mounting = Mounting::gear(false, 0.0);
    let all = ModeSelection::Count(usize::MAX / 2);
    basis::of_sector(
        &disc(sectors, 3, 6),
        &Material::STEEL,
        &mounting,
        all,
        false,
    )
    .unwrap()
}

/// Expansion of the rim at rest in the turning frame: the force on the modes over their stiffness.
fn rim(b: &Basis, speed: f64, terms: SpinTerms) -> f64 {
    let n = b.omega.len();
    let mut gear = elastic(b, speed, terms);
    gear.decide_spin_terms(speed);
    let (zero, mut f) = (vec![0.0; n], vec![0.0; n]);
    let at = StateView {
        t: 1.0,
        q: &zero,
        v: &zero,
        discrete: &[],
    };
    gear.forces(at, &mut f);
    let part = |i: usize| b.shapes[i] * f[i] / b.omega[i].powi(2);
    (0..n).map(part).sum::<f64>()
}

#[test]
fn a_spinning_disc_expands_as_the_closed_form_says() {
    let exact = expansion(1000.0);
    // Polygons of 24 and 36 sides: what they miss of the circle falls with the square. The shaft also holds the
    // thickness of the first row of elements, which plane stress does not know.
    let [coarse, fine] = [8, 12].map(|sectors| rim(&disc_basis(sectors), 1000.0, SpinTerms::Full));
    let (e, f) = (1.0 - coarse / exact, 1.0 - fine / exact);
    assert!(f < 0.025 && e > 1.3 * f && e < 3.0 * f, "{e} {f}");
    let limit = (36.0 * 36.0 * fine - 24.0 * 24.0 * coarse) / (36.0 * 36.0 - 24.0 * 24.0);
    assert!((limit / exact - 1.0).abs() < 0.02, "{limit:e} {exact:e}");
}

#[test]
fn what_auto_leaves_out_is_small() {
    let b = disc_basis(8);
    let n = b.omega.len();
    // Expansion: less than the limit squared, times the radius.
    let limit = AUTO_LIMIT * b.omega[0];
    assert_eq!(rim(&b, 0.99 * limit, SpinTerms::Auto), 0.0);
    let dropped = rim(&b, 0.99 * limit, SpinTerms::Full) / OUTER;
    assert!(
        dropped > 0.0 && dropped < AUTO_LIMIT * AUTO_LIMIT,
        "{dropped:e}"
    );
    assert!(rim(&b, 1.01 * limit, SpinTerms::Auto) > 0.0);
    // Coriolis forces part the frequencies of a pair by theta' C, at most by the speed itself.
    let c = &b.integrals.as_ref().unwrap().gyroscopic;
    let pairs = (1..n).filter(|i| b.family[*i] == b.family[i - 1]);
    let strongest = pairs.map(|i| c[i * n + i - 1].abs()).fold(0.0, f64::max);
    assert!(strongest > 0.1 && strongest <= 1.0 + 1e-9, "{strongest}");
}

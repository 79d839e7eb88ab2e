//! Shafts: exact frequencies and deflections, conservation laws under all methods, rigid shafts compared with single
//! bodies.

mod beams;
mod frequencies;
mod rigid;
mod stages;
mod torsion;

use gearbench_integrators::{Coeffs, Outputs, Report, SecondOrderSystem, State};
use gearbench_models::scene::Scene;
use gearbench_models::spec::{
    BodySpec, Modelling, SceneSpec, Section, SectionKind, ShaftSpec, Station, StationMember,
};
use gearbench_models::stiffness::Material;
use gearbench_tests::*;
use nalgebra::{DMatrix, SymmetricEigen};
use std::f64::consts::TAU;

/// Returns a station with a body that rotates freely.
pub fn body(place: f64, name: &str, inertia: f64) -> Station {
    Station {
        place,
        carries: StationMember::Body(Box::new(BodySpec::new(name, inertia))),
    }
}

/// Returns a station with a gear.
pub fn on(place: f64, gear: usize) -> Station {
    Station {
        place,
        carries: StationMember::Gear(gear),
    }
}

/// Returns a torsional spring [N m/rad] of a length [m].
pub fn coupling(length: f64, stiffness: f64) -> Section {
    Section {
        length,
        kind: SectionKind::Coupling { stiffness },
        divisions: 1,
        damping: None,
    }
}

/// Returns a round bar.
pub fn bar(length: f64, diameter: f64, material: Material, divisions: usize) -> Section {
    Section {
        length,
        kind: SectionKind::Round {
            diameters: [diameter, 0.0],
            material,
        },
        divisions,
        damping: None,
    }
}

pub fn shaft(name: &str, stations: Vec<Station>, sections: Vec<Section>) -> ShaftSpec {
    ShaftSpec {
        name: name.into(),
        stations,
        sections,
        ..ShaftSpec::default()
    }
}

/// Returns a scene of shafts without gears.
pub fn alone(shafts: Vec<ShaftSpec>) -> SceneSpec {
    SceneSpec {
        duration: f64::INFINITY,
        gears: vec![],
        meshes: vec![],
        shafts,
        stages: Vec::new(),
    }
}

/// Builds a scene with one model for all its gears.
pub fn of_subject(spec: &SceneSpec, subject: &Subject) -> Scene {
    let modelling = Modelling {
        gears: vec![subject.spec.clone(); spec.gears.len()],
        contacts: vec![subject.contact.clone(); spec.meshes.len()],
    };
    Scene::build(spec, &modelling, &joined().models)
        .unwrap_or_else(|e| panic!("{}: {e}", subject.name))
}

/// Returns a matrix of a scene, column by column.
fn matrix(n: usize, mut column: impl FnMut(&[f64], &mut [f64])) -> DMatrix<f64> {
    let mut out = DMatrix::zeros(n, n);
    let (mut unit, mut y) = (vec![0.0; n], vec![0.0; n]);
    for j in 0..n {
        unit[j] = 1.0;
        column(&unit, &mut y);
        unit[j] = 0.0;
        (0..n).for_each(|i| out[(i, j)] = y[i]);
    }
    out
}

/// Returns the total energy of a scene at a state [J].
pub fn energy(scene: &mut Scene, s: &State) -> f64 {
    let mut out = Outputs::default();
    scene.output(s.at(), &mut out);
    out.energy.total()
}

/// Returns mass and stiffness matrices at a state.
pub fn matrices(scene: &mut Scene, s: &State) -> [DMatrix<f64>; 2] {
    let n = s.q.len();
    let zero = vec![0.0; n];
    let mass = matrix(n, |x, y| scene.apply_mass(s.at(), x, y));
    let stiffness = matrix(n, |x, y| {
        scene.tangent_times(s.at(), x, &zero, y);
        y.iter_mut().for_each(|y| *y = -*y);
    });
    [mass, stiffness]
}

/// Returns the natural frequencies of an assembled scene about its initial state [Hz], ascending.
pub fn frequencies(scene: &mut Scene) -> Vec<f64> {
    let s = scene.initial();
    squares(scene, &s)
        .iter()
        .map(|x| x.max(0.0).sqrt() / TAU)
        .collect()
}

/// Returns the squares of angular frequencies, ascending.
pub fn squares(scene: &mut Scene, s: &State) -> Vec<f64> {
    let [mass, stiffness] = matrices(scene, s);
    let n = s.q.len();
    let scale: Vec<f64> = (0..n).map(|i| mass[(i, i)].sqrt().recip()).collect();
    let scaled = DMatrix::from_fn(n, n, |i, j| {
        0.5 * (stiffness[(i, j)] + stiffness[(j, i)]) * scale[i] * scale[j]
    });
    let mut found: Vec<f64> = SymmetricEigen::new(scaled)
        .eigenvalues
        .iter()
        .copied()
        .collect();
    found.sort_by(f64::total_cmp);
    found
}

/// Checks that the correction of a scene solves the equations with the matrix of its tangents.
pub fn corrects(scene: &mut Scene, s: &State, c: Coeffs, rigid: bool, what: &str) {
    corrects_within(scene, s, c, (rigid, 1e-7), what);
}

/// Checks the correction of a scene to a relative tolerance.
pub fn corrects_within(
    scene: &mut Scene,
    s: &State,
    c: Coeffs,
    (rigid, within): (bool, f64),
    what: &str,
) {
    let n = s.q.len();
    let mut rng = Numbers::new(7);
    // Of the size that moves each coordinate alike.
    let (of_q, _) = scales(scene);
    let wanted = rng.vector(&of_q);
    let held = if rigid {
        load_references(scene, s, &wanted)
    } else {
        wanted
    };
    let mut rhs = vec![0.0; n];
    scene.apply_mass(s.at(), &held, &mut rhs);
    rhs.iter_mut().for_each(|x| *x *= c.m);
    let (dq, dv): (Vec<f64>, Vec<f64>) = held.iter().map(|x| (c.k * x, c.d * x)).unzip();
    let mut df = vec![0.0; n];
    scene.tangent_times(s.at(), &dq, &dv, &mut df);
    rhs.iter_mut().zip(&df).for_each(|(r, d)| *r -= d);
    scene.correct(s.at(), c, &mut rhs).unwrap();
    for (i, (x, w)) in rhs.iter().zip(&held).enumerate() {
        assert!((x - w).abs() < within * of_q[i], "{what}: {i}, {x} for {w}");
    }
}

/// Returns a direction that rigid shafts permit: accelerations from changes of force.
fn load_references(scene: &mut Scene, s: &State, wanted: &[f64]) -> Vec<f64> {
    let n = s.q.len();
    let (mut x, zero) = (vec![0.0; n], vec![0.0; n]);
    scene.tangent_times(s.at(), wanted, &zero, &mut x);
    scene.solve_mass(s.at(), &mut x);
    let (of_q, _) = scales(scene);
    let sizes = x.iter().zip(&of_q).map(|(x, s)| (x / s).abs());
    let largest = sizes.fold(0.0, f64::max);
    x.iter().map(|x| x / largest).collect()
}

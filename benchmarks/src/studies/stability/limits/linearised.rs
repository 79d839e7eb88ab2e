//! Linearisation of a scene at a state with closed contacts: the state and its matrices.

use super::LimitError;
use super::end_dampers::{acts_at_ends, known_at_ends, predicted, speeds};
use super::linear::{Dense, FastestMode, Linear};
use crate::small_signals::{Patience, assemble};
use gearbench_integrators::linear_stability::Impulses;
use gearbench_integrators::table::{DOPRI5, HHT_ALPHA, TRIGONOMETRIC};
use gearbench_integrators::{
    AcceptedStep, Control, Events, Outputs, Resolution, SecondOrderSystem, Sink, State, TimePlan,
    Work,
};
use gearbench_models::gear::table::Model;
use gearbench_models::scene::{Channel, OfGear, OfMesh, Scene};
use gearbench_models::spec::{Body, Modelling, SceneSpec};
use nalgebra::DMatrix;

/// Coordinates up to which matrices are formed; beyond, only the fastest mode is sought.
const DENSE: usize = 450;
/// Largest number of steps of the run that searches the state; a scene without contact until then counts as open.
const MOST_STEPS: u64 = 20_000;
/// Largest number of steps of the search run, for contacts whose force requires a search over flank nodes.
const MOST_STEPS_OF_FIELDS: u64 = 4_000;
/// Tolerance of the search run: the state need not be accurate.
const TOLERANCE: f64 = 1e-4;
/// Largest number of stored states in contact; beyond it every other one is dropped.
const KEPT: usize = 128;
/// Steps of the largest Krylov space in which the fastest mode of a large scene is sought.
const KRYLOV: usize = 120;

/// Scene with a state in which its contacts are closed.
pub struct Linearised {
    scene: Scene,
    closed: Option<State>,
    start: State,
}

impl Linearised {
    /// Assembles a scene and runs it through its first contact.
    pub fn new(
        spec: &SceneSpec,
        modelling: &Modelling,
        models: &[Model],
    ) -> Result<Linearised, LimitError> {
        let mut scene = assemble(spec, modelling, models, &Patience::ENDLESS)?;
        let start = scene.initial();
        let closed = closed_state(&mut scene, spec);
        Ok(Linearised {
            scene,
            closed,
            start,
        })
    }

    /// Returns the scene that is linearised.
    pub fn scene(&mut self) -> &mut Scene {
        &mut self.scene
    }

    /// Returns the state with closed contacts, if the scene came into contact.
    pub fn closed(&self) -> Option<&State> {
        self.closed.as_ref()
    }

    /// Linearises the scene about its closed state, or about its start where it did not come into contact.
    pub fn linear(&mut self) -> Result<Linear, LimitError> {
        let s = self.closed.as_ref().unwrap_or(&self.start);
        if self.scene.layout().n > DENSE {
            return fastest(&mut self.scene, s).map(Linear::FastestMode);
        }
        let m = mass(&mut self.scene, s);
        let d = damping(&mut self.scene, s);
        let k = stiffness(&mut self.scene, s);
        let at_ends = known_at_ends(&mut self.scene, s, &d);
        Dense::of(m, (d, at_ends), k).map(Linear::Dense)
    }

    /// Frequencies [rad/s] of the oscillators that the scene's coordinates are, zero for bodies; `None` for a scene
    /// that is not oscillators and a rest, or too large.
    pub fn oscillators(&mut self) -> Option<Vec<f64>> {
        let n = self.scene.layout().n;
        let (mut omega, mut zeta) = (vec![0.0; n], vec![0.0; n]);
        if n > DENSE {
            return None;
        }
        self.scene.modal()?.oscillators(&mut omega, &mut zeta);
        Some(omega)
    }

    /// Returns the remaining stiffness in addition to the oscillators for a method with these impulses at a step `h` [s]: `K -
    /// Omega^2` for unit masses. `omega` are [`Self::oscillators`].
    pub fn rest(
        &mut self,
        omega: &[f64],
        impulses: Impulses,
        h: f64,
    ) -> Result<DMatrix<f64>, LimitError> {
        if let Some(split) = self.scene.modal() {
            let quasi_static: Vec<f64> =
                omega.iter().map(|w| impulses.quasi_static(*w, h)).collect();
            split.prepare(&quasi_static);
        }
        let s = self.closed.as_ref().unwrap_or(&self.start);
        let mass = mass(&mut self.scene, s);
        let stiffness = stiffness(&mut self.scene, s);
        // Prepared data are reset at the start of a run.
        self.scene.begin(&mut s.clone(), false);
        let none = DMatrix::zeros(omega.len(), omega.len());
        let mut rest = Dense::of(mass, (none, None), stiffness)?.stiffness;
        for (i, w) in omega.iter().enumerate() {
            rest[(i, i)] -= w * w;
        }
        Ok(rest)
    }

    /// Computes the angular frequency of the bodies' masses on the penalty of the contact alone [rad/s]; `None` without
    /// a penalty that carries a force.
    pub fn penalty_frequency(&mut self) -> Option<f64> {
        let s = self.closed.as_ref()?;
        let mut stiffness = vec![0.0; self.scene.meshes().len()];
        for f in self.scene.contact_forces(s.at()) {
            let law = &self.scene.meshes()[f.mesh].law;
            if f.gap < 0.0 {
                stiffness[f.mesh] += law.exponent() * f.normal_force / -f.gap;
            }
        }
        let of_mesh = |(mesh, k): (&gearbench_models::scene::SceneMesh, &f64)| {
            let inverse = |i: usize| self.scene.gears()[i].model.hub().contact_mass.recip();
            k * mesh.gears.map(inverse).iter().sum::<f64>()
        };
        let square = (self.scene.meshes().iter().zip(&stiffness))
            .map(of_mesh)
            .fold(0.0, f64::max);
        (square > 0.0 && square.is_finite()).then(|| square.sqrt())
    }
}

/// Observer that stores states in contact.
struct ClosedStateRecorder {
    force: Vec<usize>,
    /// Channel of the displacement of the first gear of each mesh, its pitch, and its displacement at the start.
    passed: Vec<(usize, f64, Option<f64>)>,
    touched: bool,
    peak: (f64, Option<State>),
    kept: Vec<State>,
    stride: usize,
    skip: usize,
    out: Outputs,
}

impl Sink for ClosedStateRecorder {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        sys.output(step.to.at(), &mut self.out);
        let force: f64 = (self.force.iter())
            .map(|&c| self.out.channels[c].abs())
            .sum();
        let mut passes_a_pitch = false;
        for (channel, pitch, start) in &mut self.passed {
            let displacement = self.out.channels[*channel];
            passes_a_pitch |= (displacement - *start.get_or_insert(displacement)).abs() > *pitch;
        }
        if force == 0.0 {
            return if self.touched {
                Control::Stop
            } else {
                Control::Continue
            };
        }
        self.touched = true;
        if force > self.peak.0 {
            self.peak = (force, Some(step.to.clone()));
        }
        if self.skip == 0 {
            self.kept.push(step.to.clone());
            self.skip = self.stride;
        }
        self.skip -= 1;
        if self.kept.len() == KEPT {
            let mut odd = false;
            self.kept.retain(|_| {
                odd = !odd;
                odd
            });
            self.stride *= 2;
        }
        if passes_a_pitch {
            Control::Stop
        } else {
            Control::Continue
        }
    }

    fn wants_restarts(&self) -> bool {
        false
    }
}

/// Number of tooth pairs that push, and the sum of their forces [N].
fn contact(scene: &mut Scene, s: &State) -> (usize, f64) {
    let forces = scene.contact_forces(s.at());
    let mut pairs: Vec<_> = (forces.iter())
        .map(|f| (f.mesh, f.teeth[0].index, f.teeth[1].index))
        .collect();
    pairs.sort_unstable();
    pairs.dedup();
    (pairs.len(), forces.iter().map(|f| f.normal_force).sum())
}

/// The state of the first contact with the most pairs, and the largest force among those.
fn closed_state(scene: &mut Scene, spec: &SceneSpec) -> Option<State> {
    let passed = spec.meshes.iter().map(|mesh| {
        let first = mesh.gears[0];
        let pitch = match &spec.gears[first].body {
            Body::Gear(g) => std::f64::consts::TAU / f64::from(g.teeth()),
            Body::Rack(r) => r.pitch(),
        };
        let channel = scene.channel(Channel::Gear(first, OfGear::Displacement))?;
        Some((channel, pitch, None))
    });
    let passed = passed.collect::<Option<Vec<_>>>()?;
    let fields = scene
        .gears()
        .iter()
        .any(|g| g.model.displacement().is_some());
    let m = scene.magnitudes();
    // Bodies of finite elements have modes that an explicit method would follow for nothing.
    let (method, resolution) = if scene.modal().is_some() {
        (TRIGONOMETRIC, Resolution::Tolerance(TOLERANCE))
    } else if scene.layout().n > DENSE {
        let step = 0.02 * m.deflection / m.speed;
        (HHT_ALPHA, Resolution::Step(step))
    } else {
        (DOPRI5, Resolution::Tolerance(TOLERANCE))
    };
    let mut watch = ClosedStateRecorder {
        force: scene.channels_of_meshes(OfMesh::Force),
        passed,
        touched: false,
        peak: (0.0, None),
        kept: Vec::new(),
        stride: 1,
        skip: 0,
        out: Outputs::default(),
    };
    let plan = TimePlan {
        max_steps: if fields || scene.layout().n > DENSE {
            MOST_STEPS_OF_FIELDS
        } else {
            MOST_STEPS
        },
        // As long as it takes to close a pitch at the typical speed.
        ..TimePlan::new(1e4 * m.deflection.max(1e-5) / m.speed, resolution)
    };
    let mut integrator = method.build();
    let mut s = scene.initial();
    // A run that ends early has stored the states so far.
    let _ = integrator.run(scene, &mut s, &plan, &mut watch, &mut Work::default());
    let mut best: Option<((usize, f64), State)> = None;
    for s in watch.kept.into_iter().chain(watch.peak.1) {
        let found = contact(scene, &s);
        if best.as_ref().is_none_or(|(b, _)| found > *b) && found.0 > 0 {
            best = Some((found, s));
        }
    }
    best.map(|(_, s)| s)
}

/// A matrix column by column.
fn by_columns(n: usize, mut times: impl FnMut(&[f64], &mut [f64])) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(n, n);
    let (mut unit, mut column) = (vec![0.0; n], vec![0.0; n]);
    for j in 0..n {
        unit[j] = 1.0;
        times(&unit, &mut column);
        matrix.column_mut(j).copy_from_slice(&column);
        unit[j] = 0.0;
    }
    matrix
}

fn mass(scene: &mut Scene, s: &State) -> DMatrix<f64> {
    by_columns(s.q.len(), |x, y| scene.apply_mass(s.at(), x, y))
}

fn stiffness(scene: &mut Scene, s: &State) -> DMatrix<f64> {
    let none = vec![0.0; s.q.len()];
    -by_columns(s.q.len(), |x, y| scene.tangent_times(s.at(), x, &none, y))
}

fn damping(scene: &mut Scene, s: &State) -> DMatrix<f64> {
    let none = vec![0.0; s.q.len()];
    -by_columns(s.q.len(), |x, y| scene.tangent_times(s.at(), &none, x, y))
}

/// The fastest mode, by Lanczos steps with `M^-1 K` in the inner product of `M`, and its damping.
fn fastest(scene: &mut Scene, s: &State) -> Result<FastestMode, LimitError> {
    let n = scene.layout().n;
    let at = s.at();
    let mass_times = |scene: &mut Scene, x: &[f64]| {
        let mut y = vec![0.0; n];
        scene.apply_mass(at, x, &mut y);
        y
    };
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    // A start that is orthogonal to no mode.
    let mut seed = 0x9e37_79b9_7f4a_7c15_u64;
    let mut v: Vec<f64> = (0..n)
        .map(|_| {
            seed ^= seed << 13;
            seed ^= seed >> 7;
            seed ^= seed << 17;
            seed as f64 / u64::MAX as f64 - 0.5
        })
        .collect();
    let (mut basis, mut weighted): (Vec<Vec<f64>>, Vec<Vec<f64>>) = (Vec::new(), Vec::new());
    let (mut alpha, mut beta) = (Vec::new(), Vec::new());
    let none = vec![0.0; n];
    for _ in 0..KRYLOV.min(n) {
        let mut w = mass_times(scene, &v);
        let size = dot(&v, &w).sqrt();
        if !(size.is_finite() && size > 0.0) {
            break;
        }
        if !basis.is_empty() {
            beta.push(size);
        }
        for x in v.iter_mut().chain(&mut w) {
            *x /= size;
        }
        let mut next = vec![0.0; n];
        scene.tangent_times(at, &v, &none, &mut next);
        for x in &mut next {
            *x = -*x;
        }
        alpha.push(dot(&v, &next));
        scene.solve_mass(at, &mut next);
        basis.push(v);
        weighted.push(w);
        // Twice, for orthogonality to rounding.
        for _ in 0..2 {
            for (b, w) in basis.iter().zip(&weighted) {
                let along = dot(w, &next);
                for (x, b) in next.iter_mut().zip(b) {
                    *x -= along * b;
                }
            }
        }
        v = next;
    }
    let size = alpha.len();
    let t = DMatrix::from_fn(size, size, |i, j| match i.abs_diff(j) {
        0 => alpha[i],
        1 => beta[i.min(j)],
        _ => 0.0,
    });
    if size == 0 || !t.iter().all(|x| x.is_finite()) {
        return Err(LimitError::Matrices("its tangent is not finite"));
    }
    let eigen = t.symmetric_eigen();
    let top = eigen.eigenvalues.imax();
    let square = eigen.eigenvalues[top];
    if square <= 0.0 {
        return Err(LimitError::Matrices("nothing vibrates"));
    }
    let mut mode = vec![0.0; n];
    for (b, y) in basis.iter().zip(eigen.eigenvectors.column(top).iter()) {
        for (x, b) in mode.iter_mut().zip(b) {
            *x += y * b;
        }
    }
    let mut damped = vec![0.0; n];
    scene.tangent_times(at, &none, &mode, &mut damped);
    let omega = square.sqrt();
    let zeta = (-dot(&mode, &damped) / (2.0 * omega)).max(0.0);
    let v = speeds(scene);
    let zeta_predicted = if acts_at_ends(scene, s, &v) {
        let largest = (mode.iter().zip(&v)).fold(0.0_f64, |m, (x, v)| m.max((x / v).abs()));
        let typical: Vec<f64> = mode.iter().map(|x| x / largest).collect();
        predicted(scene, s, &typical, &mut damped);
        (-dot(&mode, &damped) * largest / (2.0 * omega)).max(0.0)
    } else {
        zeta
    };
    Ok(FastestMode {
        omega,
        zeta,
        zeta_predicted,
    })
}

//! Static equilibrium compared with exact solutions, and the errors where there is none.

use crate::problems::state;
use crate::unit_masses;
use gearbench_integrators::{
    EquilibriumError, EquilibriumOptions, Layout, SecondOrderSystem, State, StateView, equilibrium,
};

/// System `f = load - K q + sum of stops`, with springs as a full matrix and one-sided stops `k <q_i - limit>`.
pub struct Springs {
    k: Vec<f64>,
    load: Vec<f64>,
    /// Coordinate, limit [m] and stiffness [N/m] of each stop.
    stops: Vec<(usize, f64, f64)>,
    /// Coefficient `h` of the hardening force `-h q^3` of every coordinate.
    hardening: f64,
}

impl Springs {
    pub fn new(k: &[f64], load: &[f64]) -> Self {
        Springs {
            k: k.to_vec(),
            load: load.to_vec(),
            stops: vec![],
            hardening: 0.0,
        }
    }
}

impl SecondOrderSystem for Springs {
    fn layout(&self) -> Layout {
        Layout {
            n: self.load.len(),
            ..Layout::default()
        }
    }
    fn scales(&self, q: &mut [f64], v: &mut [f64]) {
        q.fill(1e-3);
        v.fill(1.0);
    }
    fn force(&mut self, at: StateView<'_>, f: &mut [f64]) {
        let n = f.len();
        for i in 0..n {
            let spring: f64 = (0..n).map(|j| self.k[i * n + j] * at.q[j]).sum();
            f[i] = self.load[i] - spring - self.hardening * at.q[i].powi(3);
        }
        for &(i, limit, k) in &self.stops {
            f[i] -= k * (at.q[i] - limit).max(0.0);
        }
    }
    fn solve_mass(&mut self, _at: StateView<'_>, f_to_a: &mut [f64]) {
        f_to_a.iter_mut().for_each(|f| *f /= 0.5);
    }
    fn apply_mass(&mut self, _at: StateView<'_>, x: &[f64], y: &mut [f64]) {
        for (y, x) in y.iter_mut().zip(x) {
            *y = 0.5 * x;
        }
    }
    fn tangent_times(&mut self, at: StateView<'_>, dq: &[f64], _dv: &[f64], df: &mut [f64]) {
        let n = df.len();
        for i in 0..n {
            let spring: f64 = (0..n).map(|j| self.k[i * n + j] * dq[j]).sum();
            df[i] = -spring - 3.0 * self.hardening * at.q[i].powi(2) * dq[i];
        }
        for &(i, limit, k) in &self.stops {
            if at.q[i] > limit {
                df[i] -= k * dq[i];
            }
        }
    }
}

fn options() -> EquilibriumOptions {
    EquilibriumOptions::default()
}

#[test]
fn a_chain_of_springs_takes_its_exact_deflection_in_one_correction() {
    // Twelve springs of k in a row, the last one pulled: q_i = i F / k.
    let (n, k, pull) = (12, 3e4, 7.0);
    let mut matrix = vec![0.0; n * n];
    for i in 0..n {
        matrix[i * n + i] = if i + 1 == n { k } else { 2.0 * k };
        if i > 0 {
            matrix[i * n + i - 1] = -k;
            matrix[(i - 1) * n + i] = -k;
        }
    }
    let mut load = vec![0.0; n];
    load[n - 1] = pull;
    let mut sys = Springs::new(&matrix, &load);
    let mut s = state(&vec![0.0; n], &vec![3.0; n]);
    let work = equilibrium(&mut sys, &mut s, &options()).unwrap();
    for (i, q) in s.q.iter().enumerate() {
        let want = (i + 1) as f64 * pull / k;
        assert!(
            (q - want).abs() < 1e-13 * want.abs() + 1e-16,
            "{i}: {q} {want}"
        );
    }
    assert!(s.v.iter().all(|v| *v == 0.0), "at rest");
    // The second iteration only confirms.
    assert!(
        work.newton_iterations <= 2 && work.force_evaluations <= 3,
        "{work:?}"
    );
    assert_eq!(work.steps, 0);
}

#[test]
fn stops_close_and_open_on_the_way_to_the_exact_solution() {
    // A soft spring of 10 N/m under 100 N runs into two stops of 1e6 and 1e8 N/m at 1 and 2 mm: both bear.
    let mut sys = Springs::new(&[10.0], &[3000.0]);
    sys.stops = vec![(0, 1e-3, 1e6), (0, 2e-3, 1e8)];
    let want = (3000.0 + 1e6 * 1e-3 + 1e8 * 2e-3) / (10.0 + 1e6 + 1e8);
    for start in [0.0, 5.0, -40.0, 1.5e-3] {
        let mut s = state(&[start], &[0.0]);
        let work = equilibrium(&mut sys, &mut s, &options()).unwrap();
        assert!((s.q[0] - want).abs() < 1e-15, "{start}: {} {want}", s.q[0]);
        assert!(work.newton_iterations <= 8, "{start}: {work:?}");
    }
    // The same from a start deep inside, where both bear, to a load that neither does.
    sys.load = vec![5e-3];
    let mut s = state(&[5.0], &[0.0]);
    equilibrium(&mut sys, &mut s, &options()).unwrap();
    assert!((s.q[0] - 5e-4).abs() < 1e-15, "{}", s.q[0]);
}

#[test]
fn many_stops_of_random_heights_end_at_zero_residual() {
    let n = 20;
    let mut matrix = vec![0.0; n * n];
    for i in 0..n {
        matrix[i * n + i] = 300.0;
        matrix[i * n + (i + 1) % n] = -100.0;
        matrix[((i + 1) % n) * n + i] = -100.0;
    }
    let load: Vec<f64> = (0..n).map(|i| 50.0 * ((7 * i % 11) as f64 - 3.0)).collect();
    let mut sys = Springs::new(&matrix, &load);
    sys.stops = (0..n)
        .map(|i| (i, 1e-3 * ((5 * i % 13) as f64), 1e7))
        .collect();
    let mut s = state(&vec![0.0; n], &vec![0.0; n]);
    equilibrium(&mut sys, &mut s, &options()).unwrap();
    let mut f = vec![0.0; n];
    sys.force(s.at(), &mut f);
    assert!(f.iter().all(|f| f.abs() < 1e-6), "{f:?}");
    let bearing = sys.stops.iter().filter(|(i, h, _)| s.q[*i] > *h).count();
    assert!((4..n).contains(&bearing), "{bearing} of {n} stops bear");
}

#[test]
fn a_hardening_spring_converges_quadratically() {
    let mut sys = Springs::new(&[1.0], &[8.0e-9 + 2e-3]);
    sys.hardening = 1.0;
    let mut s = state(&[0.0], &[0.0]);
    let work = equilibrium(&mut sys, &mut s, &options()).unwrap();
    assert!((s.q[0] - 2e-3).abs() < 1e-15, "{}", s.q[0]);
    assert!(work.newton_iterations <= 4, "{work:?}");
}

#[test]
fn a_body_that_only_a_stop_holds_rests_on_it() {
    // No spring at all: the tangent of the start is that of the stop alone.
    let mut sys = Springs::new(&[0.0; 4], &[30.0, -5.0]);
    sys.k[3] = 100.0;
    sys.stops = vec![(0, 1e-3, 1e6)];
    let mut s = state(&[1.5e-3, 0.0], &[0.0; 2]);
    equilibrium(&mut sys, &mut s, &options()).unwrap();
    assert!((s.q[0] - 1.03e-3).abs() < 1e-14 && (s.q[1] + 0.05).abs() < 1e-14);
    // Started open, without any stiffness, there is nothing to hold it.
    let mut sys = Springs::new(&[0.0], &[30.0]);
    sys.stops = vec![(0, 1e-3, 1e6)];
    let result = equilibrium(&mut sys, &mut state(&[0.0], &[0.0]), &options());
    assert_eq!(result, Err(EquilibriumError::SingularTangent { t: 0.0 }));
}

/// System [`Springs`] whose correction refuses a stiffness without mass, as a scene does that corrects gear by gear.
struct BlockwiseSprings(Springs);

impl SecondOrderSystem for BlockwiseSprings {
    fn layout(&self) -> Layout {
        self.0.layout()
    }
    fn scales(&self, q: &mut [f64], v: &mut [f64]) {
        self.0.scales(q, v);
    }
    fn force(&mut self, at: StateView<'_>, f: &mut [f64]) {
        self.0.force(at, f);
    }
    fn solve_mass(&mut self, at: StateView<'_>, f: &mut [f64]) {
        self.0.solve_mass(at, f);
    }
    fn apply_mass(&mut self, at: StateView<'_>, x: &[f64], y: &mut [f64]) {
        self.0.apply_mass(at, x, y);
    }
    fn correct(
        &mut self,
        at: StateView<'_>,
        c: gearbench_integrators::Coeffs,
        x: &mut [f64],
    ) -> Result<(), gearbench_integrators::system::Singular> {
        if c.m == 0.0 {
            return Err(gearbench_integrators::system::Singular);
        }
        self.0.correct(at, c, x)
    }
    fn tangent_times(&mut self, at: StateView<'_>, dq: &[f64], dv: &[f64], df: &mut [f64]) {
        self.0.tangent_times(at, dq, dv, df);
    }
}

#[test]
fn a_shift_by_mass_does_not_move_the_equilibrium() {
    // A free body of two masses joined by a spring, pushed against a stop: held by the stop alone.
    let springs = |load: &[f64]| {
        let mut sys = Springs::new(&[5e3, -5e3, -5e3, 5e3], load);
        sys.stops = vec![(1, 0.0, 2e6)];
        BlockwiseSprings(sys)
    };
    let mut s = state(&[1e-3, 1e-3], &[0.0; 2]);
    equilibrium(&mut springs(&[40.0, 0.0]), &mut s, &options()).unwrap();
    assert!((s.q[1] - 40.0 / 2e6).abs() < 1e-12, "{:?}", s.q);
    assert!((s.q[0] - s.q[1] - 40.0 / 5e3).abs() < 1e-12, "{:?}", s.q);

    // Pulled away, the stop lets go and nothing is left.
    let mut s = state(&[1e-3, 1e-3], &[0.0; 2]);
    let result = equilibrium(&mut springs(&[-40.0, 0.0]), &mut s, &options());
    assert_eq!(result, Err(EquilibriumError::SingularTangent { t: 0.0 }));
}

/// System `f = 1 + q^2` without any equilibrium.
struct NoEquilibrium;

impl SecondOrderSystem for NoEquilibrium {
    unit_masses!(|_own| [1, 0, 0]);

    fn force(&mut self, at: StateView<'_>, f: &mut [f64]) {
        f[0] = 1.0 + at.q[0] * at.q[0];
    }
    fn tangent_times(&mut self, at: StateView<'_>, dq: &[f64], _dv: &[f64], df: &mut [f64]) {
        df[0] = 2.0 * at.q[0] * dq[0];
    }
}

#[test]
fn without_an_equilibrium_the_last_correction_is_reported() {
    let mut s = State {
        t: 0.25,
        ..state(&[-3.0], &[0.0])
    };
    let short = EquilibriumOptions {
        max_iterations: 7,
        ..options()
    };
    let Err(EquilibriumError::NewtonDiverged {
        t: 0.25,
        residual,
        iterations: 7,
    }) = equilibrium(&mut NoEquilibrium, &mut s, &short)
    else {
        panic!("{s:?}")
    };
    assert!(residual > 1e-3, "{residual}");
    s.q[0] = f64::NAN;
    let result = equilibrium(&mut NoEquilibrium, &mut s, &short);
    assert_eq!(result, Err(EquilibriumError::NonFinite { t: 0.25, dof: 0 }));
}

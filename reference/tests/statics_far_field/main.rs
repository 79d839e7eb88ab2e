//! Mesh stiffness and static transmission error by finite elements with an analytical Hertzian contact, as reference
//! for the stiffness of rigid gears.
//!
//! ```text
//! cargo test --release -p gearbench-reference --test statics_far_field -- --nocapture --ignored   # 5 minutes
//! ```
//!
//! A mesh carries a line load on one row of nodes and gives way under it by the logarithm of its elements; contact by
//! penalty converges only once several elements lie within the half-width of 0.1 mm. What does converge is the answer to
//! a load spread over some elements. So each flank is loaded by a raised cosine `w(x)` of half length `W`, and the
//! half-plane's answer to the same load is exchanged for that to Hertz's pressure (`A = 2 (1 - nu^2)/(pi E)`, per body):
//!
//! ```text
//! T_i = b w^T C w + A_i int int w(x) ln|x - y| w(y) dx dy                    body i, without contact
//! d_p = q_p [T_1 + T_2 + (A_1 + A_2) (1/2 - ln(a/2))] + sum over r of c_pr q_r,     a^2 = 4 R q_p/(pi E*)
//! ```
//!
//! `C` is the compliance between flank nodes of a gear held at its bore, `c_pr` that between teeth (no contact in it).
//! Contact stays on the path of contact: pairs that touch before and after it under load play no part here.

#![allow(clippy::print_stdout)] // measured numbers belong to the log of a test run

mod elements;

use elements::Elements;
use gearbench_models::geometry::{Gear, GearParams, Pair};
use gearbench_models::stiffness::Material;

/// A pair: all that its stiffness depends on.
struct Case {
    name: &'static str,
    teeth: [u32; 2],
    module: f64,
    shift: [f64; 2],
    width: f64,
    /// `None`: where the backlash is 0.1 mm.
    distance: Option<f64>,
    /// Bore radius; 0 for a solid gear.
    bore: f64,
    material: Material,
}

const BORES: Case = Case {
    name: "20/30, m 4, bore radius 25",
    teeth: [20, 30],
    module: 4e-3,
    shift: [0.0; 2],
    width: 10e-3,
    distance: None,
    bore: 25e-3,
    material: Material::STEEL,
};

const CASES: [Case; 7] = [
    BORES,
    Case {
        name: "20/30, m 4, bore radius 15",
        bore: 15e-3,
        ..BORES
    },
    Case {
        name: "20/30, m 4, bore radius 5",
        bore: 5e-3,
        ..BORES
    },
    Case {
        name: "20/30, m 4, solid on a seat",
        bore: 0.0,
        ..BORES
    },
    Case {
        name: "S30 30/30, m 2",
        teeth: [30, 30],
        module: 2e-3,
        width: 15e-3,
        distance: Some(60e-3),
        bore: 10e-3,
        material: Material::STEEL_ISO,
        ..BORES
    },
    Case {
        name: "50/50, m 2",
        teeth: [50, 50],
        module: 2e-3,
        width: 20e-3,
        distance: Some(100e-3),
        bore: 20e-3,
        material: Material::STEEL_ISO,
        ..BORES
    },
    Case {
        name: "FZG C 16/24, m 4.5",
        teeth: [16, 24],
        module: 4.5e-3,
        shift: [0.1817, 0.1715],
        width: 14e-3,
        distance: Some(91.5e-3),
        bore: 15e-3,
        material: Material::STEEL_ISO,
    },
];

impl Case {
    fn gears(&self) -> ([Gear; 2], Pair) {
        let gears = [0, 1].map(|i| {
            Gear::new(GearParams {
                teeth: self.teeth[i],
                module: self.module,
                profile_shift: self.shift[i],
                face_width: self.width,
                bore_radius: self.bore,
                thinning: if self.distance.is_some() { 30e-6 } else { 0.0 },
                ..GearParams::default()
            })
            .unwrap()
        });
        let [one, two] = &gears;
        let distance = self
            .distance
            .unwrap_or_else(|| Pair::centre_distance_for_backlash(one, two, 106e-6).unwrap());
        let pair = Pair::new(one, two, distance).unwrap();
        (gears, pair)
    }
}

/// Compliances of the pairs in contact at one position.
struct Position {
    /// Fraction of the mesh cycle of the position.
    weight: f64,
    /// `T_1 + T_2` of each pair and its relative radius of curvature.
    own: Vec<(f64, f64)>,
    between: Vec<f64>,
}

impl Position {
    fn new(bodies: &[Elements<'_>; 2], pair: &Pair, s: f64, weight: f64) -> Position {
        let [one, two] = bodies;
        let length = pair.line_length();
        let at: Vec<f64> = (0..4)
            .map(|j| s + f64::from(j) * pair.base_pitch())
            .take_while(|s| *s <= pair.s_end())
            .collect();
        let n = at.len();
        let mut between = vec![0.0; n * n];
        for i in 0..n {
            for j in 0..i {
                let m = (i - j) as u32;
                let c =
                    one.coupling(m, at[j], at[i]) + two.coupling(m, length - at[i], length - at[j]);
                (between[i * n + j], between[j * n + i]) = (c, c);
            }
        }
        let own = at
            .iter()
            .map(|&s| (one.own(s) + two.own(length - s), s * (length - s) / length))
            .collect();
        Position {
            weight,
            own,
            between,
        }
    }

    /// Common approach under the load `q` [N/m]; `a` is A_1 + A_2.
    fn approach(&self, q: f64, a: f64) -> f64 {
        let n = self.own.len();
        let mut loads = vec![q / n as f64; n];
        let mut approach = 0.0;
        for _ in 0..60 {
            let mut c = self.between.clone();
            for (i, (own, radius)) in self.own.iter().enumerate() {
                // 1/E* = pi A/2.
                let half = (2.0 * radius * loads[i] * a).sqrt();
                c[i * n + i] = own + a * (0.5 - (0.5 * half).ln());
            }
            let unit = solve(c, n);
            let sum: f64 = unit.iter().sum();
            approach = q / sum;
            loads = unit.iter().map(|u| (u * approach).max(1e-3 * q)).collect();
        }
        approach
    }
}

/// Solves for a right-hand side of ones.
fn solve(mut c: Vec<f64>, n: usize) -> Vec<f64> {
    let mut b = vec![1.0; n];
    for k in 0..n {
        for i in k + 1..n {
            let f = c[i * n + k] / c[k * n + k];
            for j in k..n {
                c[i * n + j] -= f * c[k * n + j];
            }
            b[i] -= f * b[k];
        }
    }
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| c[k * n + j] * b[j]).sum();
        b[k] = (b[k] - known) / c[k * n + k];
    }
    b
}

/// Elements along the flank; the values that are stored are extrapolated from the last two with the second order.
const LEVELS: [u32; 3] = [18, 24, 36];
/// Half length of the spread load in modules: 2 elements of the coarsest level. Of 0.4 modules the mean stiffness is
/// 0.2 % less.
const SPREAD: f64 = 0.25;
const LOADS: [f64; 2] = [100e3, 300e3];
/// In each zone of a number of pairs.
const POSITIONS: u32 = 16;

/// Returns the ranges of the first pair on the path with one pair more and one less in contact, over a base pitch.
fn zones(pair: &Pair) -> [[f64; 2]; 2] {
    let (start, pitch) = (pair.s_start(), pair.base_pitch());
    let more = (pair.s_end() - start) % pitch;
    [[start, start + more], [start + more, start + pitch]]
}

/// Results of a mesh cycle, in N/(mm um) and um.
#[derive(Clone, Copy)]
struct Cycle {
    at_pitch_point: f64,
    mean_stiffness: f64,
    mean_error: f64,
    peak_to_peak: f64,
}

impl Cycle {
    fn of(bodies: &[Elements<'_>; 2], pair: &Pair, positions: &[Position], load: f64) -> Cycle {
        let a = bodies[0].a() + bodies[1].a();
        let d: Vec<f64> = positions.iter().map(|p| p.approach(load, a)).collect();
        let mean = |f: &dyn Fn(f64) -> f64| {
            (positions.iter().zip(&d))
                .map(|(p, d)| p.weight * f(*d))
                .sum::<f64>()
        };
        let (low, high) = d
            .iter()
            .fold((f64::MAX, 0.0_f64), |(l, h), d| (l.min(*d), h.max(*d)));
        // One pair alone, whatever its neighbours do.
        let s = pair.s_pitch();
        let length = pair.line_length();
        let alone = Position {
            weight: 1.0,
            own: vec![(
                bodies[0].own(s) + bodies[1].own(length - s),
                s * (length - s) / length,
            )],
            between: vec![0.0],
        };
        Cycle {
            at_pitch_point: 1e-9 * load / alone.approach(load, a),
            mean_stiffness: 1e-9 * mean(&|d| load / d),
            mean_error: 1e6 * mean(&|d| d),
            peak_to_peak: 1e6 * (high - low),
        }
    }

    /// Limit of second order in the length of the elements.
    fn limit(coarse: Cycle, fine: Cycle) -> Cycle {
        let part = 1.0 / ((f64::from(LEVELS[2]) / f64::from(LEVELS[1])).powi(2) - 1.0);
        let of = |a: f64, b: f64| b + part * (b - a);
        Cycle {
            at_pitch_point: of(coarse.at_pitch_point, fine.at_pitch_point),
            mean_stiffness: of(coarse.mean_stiffness, fine.mean_stiffness),
            mean_error: of(coarse.mean_error, fine.mean_error),
            peak_to_peak: of(coarse.peak_to_peak, fine.peak_to_peak),
        }
    }

    fn print(&self, name: &str, load: f64) {
        println!(
            "  {name:<5} {:>4} N/mm   at C {:.3}   c_g {:.3}   TE {:.4}   p-p {:.4}",
            1e-3 * load,
            self.at_pitch_point,
            self.mean_stiffness,
            self.mean_error,
            self.peak_to_peak
        );
    }
}

/// The last line of each pair and load is stored in `models/involute/src/stiffness/coupling_tests.rs`.
#[test]
#[ignore = "minutes"]
fn a_mesh_cycle_of_every_pair() {
    for case in &CASES {
        println!("{}", case.name);
        let ([one, two], pair) = case.gears();
        let spread = SPREAD * case.module;
        let mut found = Vec::new();
        for flank in LEVELS {
            let bodies =
                [&one, &two].map(|g| Elements::new(g, case.material, flank as usize, spread));
            let positions: Vec<Position> = zones(&pair)
                .into_iter()
                .flat_map(|[from, to]| {
                    (0..POSITIONS).map(move |i| {
                        let u = (f64::from(i) + 0.5) / f64::from(POSITIONS);
                        (from + u * (to - from), (to - from) / f64::from(POSITIONS))
                    })
                })
                .map(|(s, weight)| Position::new(&bodies, &pair, s, weight / pair.base_pitch()))
                .collect();
            found.push(LOADS.map(|load| {
                let cycle = Cycle::of(&bodies, &pair, &positions, load);
                cycle.print(&flank.to_string(), load);
                cycle
            }));
        }
        for (i, load) in LOADS.into_iter().enumerate() {
            let [_, coarse, fine] = [0, 1, 2].map(|level| found[level][i]);
            let limit = Cycle::limit(coarse, fine);
            limit.print("limit", load);
            assert!((limit.mean_stiffness / fine.mean_stiffness - 1.0).abs() < 0.01);
        }
    }
}

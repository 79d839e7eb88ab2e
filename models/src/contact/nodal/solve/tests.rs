use super::*;
use crate::law::{Damping, Law};

/// Returns a generator of repeatable numbers in [-1, 1).
fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut x = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    move || {
        x ^= x >> 12;
        x ^= x << 25;
        x ^= x >> 27;
        (x.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// Builds two gears with `n` nodes each, `m` points between them, and a compliance of rank `rank` per gear.
fn problem(n: usize, m: usize, rank: usize, law: Law) -> (Vec<Block>, Vec<f64>, Vec<Spring>) {
    let mut draw = numbers((n * m + rank) as u64);
    let mut compliance = Vec::new();
    for _ in 0..2 {
        let root: Vec<f64> = (0..n * rank).map(|_| 4e-5 * draw()).collect();
        for i in 0..n {
            for j in 0..n {
                let product = (0..rank).map(|k| root[i * rank + k] * root[j * rank + k]);
                compliance.push(product.sum::<f64>());
            }
        }
    }
    let blocks = [0, n].map(|start| Block { start, len: n });
    let springs = (0..m).map(|p| {
        let mut nodes = [0; 8];
        let mut weights = [0.0; 8];
        for c in 0..4 {
            (nodes[c], weights[c]) = (((p + c) % n) as u32, 0.5 + 0.4 * draw());
            (nodes[4 + c], weights[4 + c]) = ((n + (p * p + c) % n) as u32, 0.5 + 0.4 * draw());
        }
        let of = (1e-5 * (draw() - 0.5), 0.3 * draw());
        Spring::new((nodes, weights), of, 1e8 * (1.5 + draw()), law.clone())
    });
    (blocks.to_vec(), compliance, springs.collect())
}

fn set(solve: &mut NodalSolve, blocks: &[Block], r: &[f64]) {
    let n: usize = blocks.iter().map(|b| b.len).sum();
    let numbers: Vec<u32> = (0..n as u32).collect();
    let begin = |k: usize| -> usize { blocks[..k].iter().map(|b| b.len * b.len).sum() };
    solve.set_nodes(blocks, &numbers, |k, out| {
        out.copy_from_slice(&r[begin(k)..][..out.len()])
    });
}

/// Returns the residual of `u = -R W^T N` and of the law at the solution.
fn residual(blocks: &[Block], r: &[f64], springs: &[Spring], u: &[f64]) -> f64 {
    let n = u.len();
    let mut f = vec![0.0; n];
    for s in springs {
        s.add(s.force.n, &mut f);
    }
    let (mut worst, mut largest, mut begin) = (0.0_f64, 0.0_f64, 0);
    for b in blocks {
        for i in 0..b.len {
            let row = &r[begin + i * b.len..][..b.len];
            let way: f64 = row.iter().zip(&f[b.start..]).map(|(r, f)| r * f).sum();
            worst = worst.max((u[b.start + i] + way).abs());
            largest = largest.max(way.abs());
        }
        begin += b.len * b.len;
    }
    worst / largest.max(f64::MIN_POSITIVE)
}

#[test]
fn the_linear_law_and_the_compliance_hold_at_the_solution() {
    for (n, m, rank) in [(6, 5, 6), (8, 20, 8), (8, 30, 3), (1, 2, 1)] {
        let (blocks, r, mut springs) = problem(n, m, rank, Law::elastic());
        let mut solve = NodalSolve::default();
        set(&mut solve, &blocks, &r);
        let u = solve
            .solve(&mut springs, &vec![0.0; 2 * n])
            .unwrap()
            .to_vec();
        assert!(residual(&blocks, &r, &springs, &u) < 1e-9);
        for s in &springs {
            let want = s.stiffness * (-s.gap).max(0.0);
            assert!((s.force.n - want).abs() <= 1e-12 * want);
            assert!((s.gap - (s.gap0 - s.along(&u))).abs() < 1e-17);
        }
        assert!(springs.iter().any(|s| s.force.n > 0.0));
    }
}

#[test]
fn where_it_begins_does_not_show() {
    for (n, m) in [(6, 12), (12, 50)] {
        let (blocks, r, springs) = problem(n, m, n, Law::elastic());
        let run = |guess: &[f64]| {
            let mut solve = NodalSolve::default();
            set(&mut solve, &blocks, &r);
            let mut springs = springs.clone();
            let u = solve.solve(&mut springs, guess).unwrap().to_vec();
            let forces: Vec<f64> = springs.iter().map(|s| s.force.n).collect();
            (u, forces)
        };
        let cold = run(&vec![0.0; 2 * n]);
        let mut draw = numbers(3);
        for _ in 0..20 {
            let guess: Vec<f64> = (0..2 * n).map(|_| 1e-5 * draw()).collect();
            assert_eq!(cold, run(&guess));
        }
    }
}

#[test]
fn other_exponents_hold_their_law() {
    for exponent in [1.2, 1.5] {
        let law = Law::new(exponent, Damping::None).unwrap();
        let (blocks, r, mut springs) = problem(8, 25, 8, law.clone());
        for s in &mut springs {
            // Forces of the same size for all exponents.
            s.stiffness *= (1e-5_f64).powf(1.0 - exponent);
        }
        let mut solve = NodalSolve::default();
        set(&mut solve, &blocks, &r);
        let u = solve.solve(&mut springs, &[0.0; 16]).unwrap().to_vec();
        assert!(residual(&blocks, &r, &springs, &u) < 1e-9, "{exponent}");
        let mut closed = 0;
        for s in &springs {
            assert!((s.gap - (s.gap0 - s.along(&u))).abs() < 1e-15);
            let want = law.clipped(s.gap, 0.0, 0.0, s.stiffness).n;
            assert!((s.force.n - want).abs() <= 1e-9 * want, "{exponent}");
            closed += usize::from(s.force.n > 0.0);
        }
        assert!(closed > 5, "{closed}");
    }
}

/// The derivative of the forces by the gaps before residual compliance agrees with finite differences.
#[test]
fn the_compliance_of_points_is_that_of_differences() {
    let (blocks, r, springs) = problem(8, 20, 8, Law::new(1.5, Damping::None).unwrap());
    let mut springs: Vec<Spring> = springs;
    springs.iter_mut().for_each(|s| s.stiffness *= 300.0);
    let run = |gaps: &dyn Fn(usize) -> f64| {
        let mut solve = NodalSolve::default();
        set(&mut solve, &blocks, &r);
        let mut moved = springs.clone();
        (moved.iter_mut().enumerate()).for_each(|(i, s)| s.gap0 += gaps(i));
        solve.solve(&mut moved, &[0.0; 16]).unwrap();
        (solve, moved)
    };
    let direction = |i: usize| ((i * i) as f64).sin();
    let h = 1e-10;
    let (_, above) = run(&|i| h * direction(i));
    let (_, below) = run(&|i| -h * direction(i));
    let (mut solve, here) = run(&|_| 0.0);
    solve.linearise(&here).unwrap();
    let mut z = vec![0.0; solve.nodes()];
    for (i, s) in here.iter().enumerate() {
        s.add(s.force.dn_dg * direction(i), &mut z);
    }
    solve.apply_compliance(&mut z);
    let largest = here.iter().fold(0.0_f64, |m, s| m.max(s.force.dn_dg.abs()));
    for (i, s) in here.iter().enumerate() {
        let dn = s.force.dn_dg * (direction(i) + s.along(&z));
        let slope = (above[i].force.n - below[i].force.n) / (2.0 * h);
        assert!((dn - slope).abs() < 1e-4 * largest, "{dn:e} {slope:e}");
    }
}

/// One solve for the gaps that the laws see gives the forces of the two solves that it replaces, elastic and with
/// retardation, and the elastic gaps to second order in the retardation. A change of a gap beyond its overlap is left to
/// the two solves.
#[test]
fn one_solve_has_the_forces_of_bodies_with_a_retardation_time() {
    let law = Law::new(1.1, Damping::None).unwrap();
    let (blocks, r, mut springs) = problem(8, 5, 8, law);
    let mobility: Vec<f64> = r.iter().map(|r| 2e4 * r).collect();
    let mut solve = NodalSolve::default();
    set(&mut solve, &blocks, &r);
    let both = |solve: &mut NodalSolve, springs: &[Spring], beta: f64| {
        let of = || -> Vec<Spring> {
            let spring = |s: &Spring| Spring {
                retardation: beta,
                ..s.clone()
            };
            springs.iter().map(spring).collect()
        };
        let (mut one, mut two) = (of(), of());
        solve.solve(&mut two, &[]).unwrap();
        assert!(solve.is_by_points());
        let points = solve.point_based();
        points.set_mobility(&two, (&blocks, &mobility), 16);
        points.damp(&mut two, false).unwrap();
        let points = solve.point_based();
        points.set_mobility(&one, (&blocks, &mobility), 16);
        let solved = solve.solve_retarded(&mut one).unwrap();
        (solved, one, two)
    };
    // Overlaps are beyond what the retardation changes.
    for s in &mut springs {
        s.gap0 = s.gap0.min(0.0) - 2e-6;
        s.rate_before *= 0.1;
    }
    let mut errors = Vec::new();
    for beta in [1e-6, 5e-7] {
        let (solved, one, two) = both(&mut solve, &springs, beta);
        assert!(solved);
        let largest = two.iter().fold(0.0_f64, |m, s| m.max(s.force.n));
        let mut error = 0.0_f64;
        for (a, b) in one.iter().zip(&two) {
            assert!((a.force.n - b.force.n).abs() < 1e-12 * largest);
            assert!((a.gap - b.gap).abs() < 1e-12 * a.gap0.abs());
            error = error.max((a.elastic.0 - b.elastic.0).abs());
        }
        assert!(
            one.iter()
                .any(|s| s.force.n > 0.0 && s.force.n != s.elastic.1)
        );
        errors.push(error);
    }
    assert!(
        errors[0] < 1e-9 && errors[0] / errors[1] > 3.5,
        "{errors:?}"
    );
    let deepest = springs.iter().map(|s| s.gap0).fold(0.0, f64::min);
    for s in &mut springs {
        s.rate_before = -1.0;
    }
    assert!(!both(&mut solve, &springs, -2.0 * deepest).0);
}

use super::*;

/// Force history of a mass that hits one row of flank nodes of a free gear.
#[allow(clippy::too_many_arguments)]
fn impact(b: &Basis, kept: &[usize], rows: &[u32], lever: f64, mass: f64, penalty: f64, h: f64, end: f64, every: usize) -> Vec<f64> {
    let n = b.omega.len();
    let mean: Vec<f64> = (0..n).map(|i| rows.iter().map(|&k| b.shapes[k as usize * n + i]).sum::<f64>() / rows.len() as f64).collect();
    let mut is = vec![false; n];
    kept.iter().for_each(|&i| is[i] = true);
    let soft: f64 = (0..n).filter(|i| !is[*i]).map(|i| (mean[i] / b.omega[i]).powi(2)).sum();
    let compliance = soft + 1.0 / penalty;
    let modes: Vec<(f64, f64, f64)> = kept.iter().map(|&i| { let (s, c) = (b.omega[i] * h).sin_cos(); let _ = s; (b.omega[i], mean[i], c) }).collect();
    let mut q: Vec<[f64; 2]> = vec![[0.0; 2]; modes.len()];
    let (mut x, mut v, mut y, mut w) = (0.0, -1.0, 0.0, 0.0); // mass; rigid gear along the line, y outward
    let gear = b.inertia / lever.powi(2);
    let force = |x: f64, y: f64, q: &[[f64; 2]]| {
        let a: f64 = q.iter().zip(&modes).map(|(q, m)| q[0] * m.1).sum();
        ((y + a - x) / compliance).max(0.0)
    };
    let mut f = force(x, y, &q);
    let mut out = vec![];
    let steps = (end / h).round() as usize;
    for step in 0..steps {
        if step % every == 0 { out.push(f); }
        v += 0.5 * h * f / mass; w -= 0.5 * h * f / gear;
        for (q, m) in q.iter_mut().zip(&modes) { q[1] -= 0.5 * h * f * m.1; }
        x += h * v; y += h * w;
        for (q, m) in q.iter_mut().zip(&modes) {
            let (s, c) = ((m.0 * h).sin(), m.2);
            *q = [c * q[0] + s / m.0 * q[1], c * q[1] - m.0 * s * q[0]];
        }
        f = force(x, y, &q);
        v += 0.5 * h * f / mass; w -= 0.5 * h * f / gear;
        for (q, m) in q.iter_mut().zip(&modes) { q[1] -= 0.5 * h * f * m.1; }
    }
    out
}

#[test]
fn scratch() {
    use crate::reduction::{Mounting, Wanted, basis};
    let r = crate::REFERENCES.iter().find(|r| r.id == "calculix/case-a-fine").unwrap();
    let d = crate::deck::read_bytes(r.id, r.deck).unwrap();
    let m = crate::deck::gears(&d).unwrap().swap_remove(0).mesh;
    let b = basis::of_mesh(&m, &gearbench_models::stiffness::Material::STEEL, &Mounting::gear(true, 0.0), Wanted::Count(700)).unwrap();
    eprintln!("highest {} kHz", b.omega.last().unwrap() / 6283.0);
    let n = b.omega.len();
    let c2 = flank_compliances(&b, true);
    let rbs = 0.0376;
    eprintln!("total {:.3e} sum", c2.iter().sum::<f64>());
    for row in [3, 8usize, 14] {
        let g = &b.flanks.grids()[0];
        let rows = &g.nodes[row * g.columns..][..g.columns];
        let all: Vec<usize> = (0..n).collect();
        let total: f64 = c2.iter().sum();
        let mass = 1.0;
        let reference = impact(&b, &all, rows, rbs, mass, 1e9, 2e-8, 1.5e-4, 50);
        let norm = reference.iter().map(|x| x * x).sum::<f64>();
        let peak = reference.iter().fold(0.0_f64, |a, b| a.max(*b));
        eprintln!("row {row} duration {} us, peak {peak}", reference.iter().filter(|f| **f > 0.0).count());
        let red = mass * (b.inertia / rbs / rbs) / (mass + b.inertia / rbs / rbs);
        let wc2 = 1.0 / (red * (total + 1e-9));
        for p in [0, 1] {
            let mut order: Vec<usize> = (0..n).filter(|i| b.omega[*i] < 2.01e6).collect();
            let key = |i: usize| match p { 0 => 1.0 / b.omega[i], _ => c2[i] / b.omega[i].powi(p as i32 - 1) };
            order.sort_by(|a, b| key(*b).total_cmp(&key(*a)));
            for count in [5, 10, 15, 25, 35, 50, 75, 100, 150, 200] {
                let kept = &order[..count];
                let f = impact(&b, kept, rows, rbs, mass, 1e9, 2e-8, 1.5e-4, 50);
                let e = (f.iter().zip(&reference).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / norm).sqrt();
                let cut: Vec<usize> = (0..n).filter(|i| !kept.contains(i)).collect();
                let share: f64 = cut.iter().map(|&i| c2[i]).sum::<f64>() / total;
                let lin: f64 = cut.iter().map(|&i| c2[i] * wc2.sqrt() / b.omega[i]).sum::<f64>() / total;
                let rms: f64 = cut.iter().map(|&i| (c2[i] * wc2.sqrt() / b.omega[i] / total).powi(2)).sum::<f64>().sqrt();
                eprint!(" {count}: {:.2}% ({:.1} {:.2} {:.2})", 100.0 * e, 100.0 * share, 100.0 * lin, 100.0 * rms);
            }
            eprintln!(" p={p}");
        }
    }
}

//! Effect of the laws on contacts that vibrate about a load, and on slow impacts.

use super::*;

/// Returns the largest speeds of the half cycles of a mass that is released slightly below its static position, by
/// fine RK4 steps.
fn settling(law: &Law, load: f64, k: f64, cycles: usize) -> Vec<f64> {
    let deflection = (load / k).powf(1.0 / law.exponent());
    let omega = (law.exponent() * load / deflection / MASS).sqrt();
    let h = 1e-3 / omega;
    let rate = |[g, v]: [f64; 2]| {
        let n = law.clipped(g, v, 0.0, k).n;
        [v, (n - load) / MASS]
    };
    let along = |x: [f64; 2], d: [f64; 2], h: f64| [x[0] + h * d[0], x[1] + h * d[1]];
    let (mut x, mut speeds) = ([-1.05 * deflection, 0.0], Vec::new());
    let mut before = load / MASS;
    while speeds.len() < cycles {
        let a = rate(x);
        let b = rate(along(x, a, 0.5 * h));
        let c = rate(along(x, b, 0.5 * h));
        let d = rate(along(x, c, h));
        let mean = [0, 1].map(|i| (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]) / 6.0);
        x = along(x, mean, h);
        // The speed is greatest where the force passes the load.
        if mean[1] * before < 0.0 {
            speeds.push(x[1].abs());
        }
        before = mean[1];
    }
    speeds
}

#[test]
fn under_load_a_restitution_is_lost_per_half_cycle() {
    let load = 1200.0;
    for exponent in [1.0, 1.5] {
        for e in [0.999, 0.99, 0.9, 0.7] {
            for damping in dampings(e) {
                let law = Law::new(exponent, damping).unwrap();
                if !law.needs_impact_speed() {
                    continue;
                }
                let k = stiffness(&law);
                let (force, mass) = (load, MASS);
                let stiffness = k;
                let law = law
                    .under_load(MeshLoad {
                        force,
                        stiffness,
                        mass,
                    })
                    .unwrap();
                let speeds = settling(&law, load, k, 12);
                // Small vibrations: the last half cycles, but for what is left of the amplitude.
                let decay = (speeds[11] / speeds[5]).powf(1.0 / 6.0);
                let allowed = 0.02 * (1.0 - e) + 0.1 * (1.0 - e) * (1.0 - e);
                assert!(
                    (decay - e).abs() < allowed.max(2e-5),
                    "{law:?}: {decay} per half cycle"
                );
            }
        }
    }
}

#[test]
fn a_ratio_at_load_is_that_of_small_vibrations_and_needs_a_load() {
    for exponent in [1.0, 10.0 / 9.0, 1.5] {
        let ratio = 0.05;
        let law = Law::new(exponent, Damping::RatioAtLoad { ratio }).unwrap();
        let k = stiffness(&law);
        let load = MeshLoad {
            force: 900.0,
            stiffness: k,
            mass: MASS,
        };
        let loaded = law.clone().under_load(load).unwrap();
        let deflection = (load.force / k).powf(1.0 / exponent);
        let f = loaded.smooth(-deflection, 0.0, 0.0, k);
        let got = -f.dn_dgdot / (2.0 * (-f.dn_dg * MASS).sqrt());
        assert!((got - ratio).abs() < 1e-12, "{got}");
        // A point of a flank has the same, as many of them as there are.
        let share = 0.25;
        let point = loaded.at_point(-deflection, 1e-6, share * k);
        let all = loaded.at_point(-deflection, 1e-6, k);
        assert!((point.dn_dgdot - share * all.dn_dgdot).abs() < 1e-12 * all.dn_dgdot.abs());
        assert!((all.dn_dgdot / f.dn_dgdot - 1.0).abs() < 1e-12);
        for rate in [-0.9, -1e-3, 1e-3, 0.9] {
            let h = 1e-6;
            let n = |g: f64, r: f64| loaded.at_point(g, r, k).n;
            let d = loaded.at_point(-deflection, rate, k);
            let by_rate = (n(-deflection, rate + h) - n(-deflection, rate - h)) / (2.0 * h);
            let h = 1e-6 * deflection;
            let by_gap = (n(-deflection + h, rate) - n(-deflection - h, rate)) / (2.0 * h);
            assert!((by_rate - d.dn_dgdot).abs() < 1e-6 * all.dn_dgdot.abs());
            assert!((by_gap - d.dn_dg).abs() < 1e-6 * all.dn_dg.abs());
        }
        // It grows from nothing where a contact closes.
        assert_eq!(loaded.smooth(0.0, -1.0, 0.0, k).n, 0.0);
        let none = MeshLoad { force: 0.0, ..load };
        assert_eq!(law.under_load(none), Err(LawError::NoLoad));
    }
}

#[test]
fn a_slow_free_impact_loses_what_a_fast_one_does() {
    // Without a load there is no speed but that of the impact.
    for damping in dampings(0.1) {
        let law = Law::new(1.0, damping).unwrap();
        if !law.needs_impact_speed() {
            continue;
        }
        for v0 in [1e-6, 7.5e-5, 7.5e-4, 0.75] {
            let [fast, slow] = [(V0, 1e-5), (v0, 1e-5 * v0 / V0)].map(|(v0, d)| {
                let f = law.smooth(-d, -0.4 * v0, v0, K);
                f.n / (K * d)
            });
            assert!(
                (fast - slow).abs() < 1e-12,
                "{law:?} at {v0}: {fast} {slow}"
            );
        }
        // Squeezed faster than it was touched, it pushes no more than 1 + chi times as hard.
        let f = law.smooth(-1e-5, -3.0, 1e-9, K);
        assert!((f.n / (K * 1e-5) - 1.0 - law.chi()).abs() < 1e-12);
    }
}

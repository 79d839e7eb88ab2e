use super::*;
use crate::geometry::{GearParams, RackParams};
use crate::stiffness::foundation::{ring_compliance, sainsot_velex_factors};
use std::f64::consts::PI;

const STEEL: Material = Material::STEEL;

fn harmonics(alpha: f64) -> Harmonics {
    Harmonics {
        kappa: (3.0 - STEEL.poisson) / (1.0 + STEEL.poisson),
        alpha,
    }
}

fn gear(teeth: u32, bore_radius: f64) -> Gear {
    Gear::new(GearParams {
        teeth,
        module: 4e-3,
        bore_radius,
        ..GearParams::default()
    })
    .unwrap()
}

/// Maxwell and Betti's reciprocity holds: displacement by shear and displacement by pressure agree, and every harmonic
/// has positive energy, although the formulas do not enforce it.
#[test]
fn every_harmonic_is_reciprocal_and_takes_energy() {
    for alpha in [1e-3, 0.2, 0.7, 0.97, 1.02, 1.3, 4.0, 1e3] {
        for n in [1, 2, 3, 10, 100, 3000] {
            let (h, mirrored) = harmonics(alpha).both(n);
            let mixed = (h.normal * h.shear).sqrt();
            assert!((h.mixed - mirrored).abs() < 1e-9 * mixed, "{alpha} {n}");
            assert!(h.normal > 0.0 && h.normal * h.shear > h.mixed * h.mixed);
        }
    }
}

/// Waves that are short compared with the ring have the compliance of a half-plane: `2 G u = (kappa + 1)/2 sigma/k`
/// and `(kappa - 1)/2` across.
#[test]
fn short_waves_feel_a_half_plane() {
    for (n, alpha) in [(200, 0.5), (2000, 0.5), (200, 1.5), (2000, 1.5)] {
        let ring = harmonics(alpha);
        let h = ring.compliance(n);
        let n = f64::from(n);
        for (found, plane) in [
            (h.normal, ring.kappa + 1.0),
            (h.shear, ring.kappa + 1.0),
            (h.mixed, ring.kappa - 1.0),
        ] {
            assert!(
                (found * n / (0.5 * plane) - 1.0).abs() < 4.0 / n,
                "{n}: {found}"
            );
        }
    }
}

/// A thin sleeve, `t << R`, under one wave `n << R/t` is sheared like a flat layer, `tau t/G`, and compressed like a
/// confined one.
#[test]
fn a_sleeve_on_its_seat_is_a_flat_layer() {
    let t = 1e-4;
    let h = harmonics(1.0 - t).compliance(7);
    assert!((h.shear / (2.0 * t) - 1.0).abs() < 1e-3, "{}", h.shear);
    let confined =
        (1.0 - STEEL.poisson * STEEL.poisson) / STEEL.young * 2.0 * STEEL.shear_modulus();
    assert!(
        (h.normal / (confined * t) - 1.0).abs() < 1e-3,
        "{}",
        h.normal
    );
}

/// A rim of large radius supported outside is a layer supported at its back, as a ring supported inside is: their
/// difference falls with the radius.
#[test]
fn a_large_rim_is_a_large_ring() {
    let (height, theta, pitch) = (0.012, 3e-3, 12e-3);
    let differ = |radius: f64| {
        let of =
            |held: f64| RingBody::new([held, radius], theta / radius, pitch / radius, &STEEL, 2);
        let bodies = [of(radius - height), of(radius + height)];
        let mut worst = 0.0_f64;
        for beta in [0.2, 0.5] {
            for pitches in 0..=2 {
                let [a, b, own] = [(0, pitches), (1, pitches), (0, 0)].map(|(k, m)| {
                    let load = |lever| bodies[k].root_load(lever, beta);
                    bodies[k].between(m, &load(4e-3), &load(3e-3), 1e-2)
                });
                worst = worst.max((a - b).abs() / own);
            }
        }
        worst
    };
    let [near, far] = [40.0, 160.0].map(|heights| differ(heights * height));
    assert!(near < 0.05 && far < 0.27 * near, "{near:e} {far:e}");
}

/// Between distant teeth a disc with a small bore is a torsion spring: `delta = r_b^2/(4 pi G b) (1/a^2 - 1/R^2)`.
#[test]
fn a_small_bore_leaves_the_torsion_of_the_disc() {
    let (g, width) = (gear(30, 1e-3), 1e-2);
    let body = RingBody::of_gear(&g, &STEEL, 5);
    let beta = 0.3;
    let load = body.root_load(g.r_base() / f64::cos(beta) - g.r_root(), beta);
    let torsion = g.r_base().powi(2) / (4.0 * PI * STEEL.shear_modulus() * width)
        * (1e6 - g.r_root().powi(-2));
    for m in 1..=5 {
        let c = body.between(m, &load, &load, width);
        assert!((c / torsion - 1.0).abs() < 0.01, "{m}: {c} {torsion}");
    }
}

/// The load at the root has the force and the torque of the load on the tooth: its work on rigid motions is that of
/// the load, by quadrature over the arc.
#[test]
fn the_root_carries_the_load() {
    let g = gear(20, 15e-3);
    let body = RingBody::of_gear(&g, &STEEL, 0);
    let (beta, r, t) = (0.4, g.r_root(), body.theta_f);
    let [normal, linear, shear] = body.root_load(g.r_base() / f64::cos(beta) - r, beta);
    let (mut force, mut torque) = ([0.0; 2], 0.0);
    let n = 2000;
    for i in 0..n {
        let theta = t * ((2.0 * f64::from(i) + 1.0) / f64::from(n) - 1.0);
        let share = 1.0 / f64::from(n);
        let sigma = (normal + linear * theta / t) * share;
        let tau = shear * share;
        let (sin, cos) = theta.sin_cos();
        force[0] += sigma * cos - tau * sin;
        force[1] += sigma * sin + tau * cos;
        torque += tau * r;
    }
    assert!((force[0] + beta.sin()).abs() < 1e-6, "{force:?}");
    assert!((force[1] + beta.cos()).abs() < 1e-6, "{force:?}");
    assert!((torque + g.r_base()).abs() < 1e-9, "{torque}");
}

/// The compliances between any teeth are those of one elastic body: positive definite.
#[test]
fn all_teeth_of_a_body_are_one_elastic_body() {
    for bore in [1e-3, 15e-3, 33e-3] {
        let g = gear(20, bore);
        let body = RingBody::of_gear(&g, &STEEL, 3);
        let loads: Vec<_> = (0..4)
            .map(|i| {
                let beta = 0.1 + 0.15 * f64::from(i);
                body.root_load(g.r_base() / beta.cos() - g.r_root(), beta)
            })
            .collect();
        let mut c: Vec<f64> = (0..16)
            .map(|ij| {
                let (low, high) = ((ij % 4).min(ij / 4), (ij % 4).max(ij / 4));
                body.between(high - low, &loads[low], &loads[high], 1e-2)
            })
            .collect();
        let scale = c[0];
        c.iter_mut().for_each(|x| *x /= scale);
        let definite = nalgebra::Matrix4::from_row_slice(&c).cholesky();
        assert!(definite.is_some(), "{bore}");
        // Two pitches on a tooth gives way less than one pitch on.
        assert!(c[4] > c[8] && c[8] > 0.0, "{c:?}");
    }
}

/// Within its range the fit of Sainsot and Velex agrees with this solution to a sixth of the compliance, and is
/// stiffest for thin rims (finite elements agree with this solution, see the tests of coupling).
#[test]
fn agrees_with_the_published_fit_in_its_range() {
    for teeth in [30, 50, 80] {
        for h in [1.5, 2.0, 3.0, 5.0] {
            let bare = gear(teeth, 1e-3);
            let g = gear(teeth, bare.r_root() / h);
            let theta_f = g.half_angle_at(g.r_root());
            let body = RingBody::of_gear(&g, &STEEL, 0);
            for beta in [0.2, 0.45] {
                let lever = g.r_base() / f64::cos(beta) - g.r_root();
                let load = body.root_load(lever, beta);
                let ours = body.between(0, &load, &load, 1e-2);
                let u = lever / (2.0 * g.r_root() * theta_f);
                let fit = ring_compliance(sainsot_velex_factors(theta_f, h), u, beta, &STEEL, 1e-2);
                assert!(
                    (ours / fit - 1.0).abs() < 0.16,
                    "{teeth} {h} {beta}: {ours} {fit}"
                );
            }
        }
    }
}

/// The radius of the ring that represents a rack does not matter.
#[test]
fn a_rack_is_a_flat_body() {
    let rack = Rack::new(RackParams {
        teeth: 9,
        module: 2e-3,
        body_height: 5e-3,
        ..RackParams::default()
    })
    .unwrap();
    let (height, half) = (5e-3, rack.half_thickness_at(-rack.root_depth()));
    let of_radius = |r: f64| RingBody::new([r - height, r], half / r, rack.pitch() / r, &STEEL, 1);
    let (a, b) = (
        RingBody::of_rack(&rack, &STEEL, 1),
        of_radius(4.0 * RACK_RADIUS * height),
    );
    let c = |body: &RingBody, m| {
        let load = body.root_load(2e-3, 0.35);
        body.between(m, &load, &load, 1e-2)
    };
    for m in [0, 1] {
        let off = c(&a, m) - c(&b, m);
        assert!(
            off.abs() < 0.02 * c(&b, 0),
            "{m}: {} {}",
            c(&a, m),
            c(&b, m)
        );
    }
}

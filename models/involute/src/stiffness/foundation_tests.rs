use super::*;
use crate::geometry::GearParams;

/// Builds the ROSS test geometry (62 teeth, m 2 mm): theta_f there is 0.0299 rad, h = 59.5/17.5.
fn gear(teeth: u32, bore: f64) -> Gear {
    Gear::new(GearParams {
        teeth,
        module: 2e-3,
        bore_radius: bore,
        ..GearParams::default()
    })
    .unwrap()
}

/// Two points of the domain agree with the published table evaluated by hand. Over `1.4 <= h <= 7`, `0.012 <= theta_f
/// <= 0.12` the extremes agree with those of the published fit ranges that the polynomials attain (the ranges are
/// those of the underlying finite-element values).
#[test]
fn factors_of_the_fit() {
    let hand = [
        (0.03, 3.4, [6.9445, 1.1771, 5.2634, 0.4406]),
        (0.10, 2.0, [6.8882, 1.1398, 2.7268, 0.4963]),
    ];
    for (theta, h, expected) in hand {
        for (got, want) in sainsot_velex_factors(theta, h).into_iter().zip(expected) {
            assert!(
                (got - want).abs() < 1.5e-4,
                "({theta}, {h}): {got} against {want}"
            );
        }
    }
    let extreme = |i: usize, better: fn(f64, f64) -> f64| {
        let mut best = sainsot_velex_factors(0.05, 3.0)[i];
        for j in 0..=280 {
            for k in 0..=220 {
                let h = 1.4 + 5.6 * f64::from(j) / 280.0;
                let theta = 0.012 + 0.108 * f64::from(k) / 220.0;
                best = better(best, sainsot_velex_factors(theta, h)[i]);
            }
        }
        best
    };
    assert!((extreme(0, f64::max) / FITS[0].range[1] - 1.0).abs() < 2e-3);
    assert!((extreme(2, f64::max) / FITS[2].range[1] - 1.0).abs() < 4e-3);
}

#[test]
fn warnings_name_gear_and_factor() {
    let steel = Material::STEEL;
    let mut warnings = Vec::new();
    RingFit::new(
        &gear(62, 17.5e-3),
        RootLength::TwoRfThetaF,
        &steel,
        1,
        &mut warnings,
    );
    assert!(warnings.is_empty(), "{warnings:?}");
    let aluminium = Material {
        poisson: 0.34,
        ..steel
    };
    RingFit::new(
        &gear(20, 1e-3),
        RootLength::TwoRfThetaF,
        &aluminium,
        2,
        &mut warnings,
    );
    let text: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    assert!(text.iter().all(|t| t.contains("gear 2")), "{text:?}");
    assert!(
        text[0].contains("17.500") && text[1].contains("0.34"),
        "{text:?}"
    );
}

/// The half-plane coefficients agree with the published ones for nu = 0.3 (5.2, 1.0, 1.4, 0.294) to their printed
/// digits, and Cornell's two forms with one another.
#[test]
fn half_plane_coefficients() {
    let g = gear(30, 5e-3);
    let p = ToothProfile::of_gear(&g);
    let load = p.load_on_gear(&g, g.r_reference());
    let m = Material::STEEL;
    let s = 2.0 * p.half_thickness(0.0);
    let lever = load.crossing() / s;
    let cos2 = load.beta.cos().powi(2);
    let tan2 = load.beta.tan().powi(2);
    let published =
        cos2 / (m.young * 1e-2) * (5.2 * lever * lever + 1.0 * lever + 1.4 * (1.0 + 0.294 * tan2));
    let got = Foundation::WeberBanaschek
        .half_plane(&p, &m, 1e-2, &load)
        .unwrap();
    assert!((got / published - 1.0).abs() < 0.012, "{got} {published}");

    let per_width = |b: f64| b * Foundation::Cornell.half_plane(&p, &m, b, &load).unwrap();
    let (narrow, wide) = (per_width(5e-3), per_width(100e-3));
    assert!(
        wide < narrow && wide > 0.85 * narrow * 0.91,
        "{wide} {narrow}"
    );
    assert_eq!(Foundation::Rigid.half_plane(&p, &m, 1e-2, &load), Some(0.0));
    let ring = Foundation::SainsotVelex(RootLength::TwoRfThetaF);
    assert_eq!(ring.half_plane(&p, &m, 1e-2, &load), None);
    assert!(ring.describe().contains("2 r_f theta_f"));
}

#[test]
fn conventions_order_as_their_lengths() {
    let g = gear(40, 10e-3);
    let m = Material::STEEL;
    let c = |s| {
        let ring = RingFit::new(&g, s, &m, 1, &mut Vec::new());
        ring.compliance(&m, 1e-2, 0.35).unwrap()
    };
    // The shorter the root, the softer; r_b > r_f here, and sin(theta) < theta.
    assert!(c(RootLength::TwoRfSinThetaF) > c(RootLength::TwoRfThetaF));
    assert!(c(RootLength::TwoRfThetaF) > c(RootLength::TwoRbThetaF));
}

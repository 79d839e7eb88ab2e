use super::*;
use crate::geometry::{EndRelief, Gear, GearParams, Modifications, ReliefShape, Side};
use std::sync::Arc;

fn gear(modifications: Modifications) -> Gear {
    let params = GearParams {
        teeth: 30,
        module: 3e-3,
        face_width: 0.02,
        modifications,
        ..GearParams::default()
    };
    Gear::new(params).unwrap()
}

/// Samples a surface over fractions of profile and width.
fn sampled(rows: usize, columns: usize, of: impl Fn(f64, f64) -> f64) -> Vec<Vec<f64>> {
    let parts = |n: usize| (0..n).map(move |i| i as f64 / (n - 1) as f64);
    let row = |u: f64| parts(columns).map(|v| of(u, v)).collect();
    parts(rows).map(row).collect()
}

fn with(rows: &[Vec<f64>]) -> Gear {
    let measured = Arc::new(Topography::new(rows, None, None).unwrap());
    gear(Modifications {
        topography: [Some(measured.clone()), Some(measured)],
        ..Modifications::default()
    })
}

/// Returns the largest difference of the material removed from two gears.
fn difference(a: &Gear, b: &Gear) -> f64 {
    let mut greatest = 0.0_f64;
    for i in 0..=601 {
        let part = f64::from(i) / 601.0;
        let s = a.roll_length_form() + part * (a.roll_length_tip() - a.roll_length_form());
        for j in 0..=303 {
            let zeta = f64::from(j) / 151.5 - 1.0;
            let of = |g: &Gear| g.flank_deviation(Side::Left, g.r_base().hypot(s), zeta);
            greatest = greatest.max((of(a) - of(b)).abs());
        }
    }
    greatest
}

#[test]
fn a_sampled_crowning_is_the_crowning() {
    let crowned = gear(Modifications {
        profile_crowning: 4e-6,
        lead_crowning: 6e-6,
        ..Modifications::default()
    });
    for [rows, columns] in [[3, 3], [5, 9], [20, 4]] {
        let of = |u: f64, v: f64| 4e-6 * (2.0 * u - 1.0).powi(2) + 6e-6 * (2.0 * v - 1.0).powi(2);
        let found = difference(&with(&sampled(rows, columns, of)), &crowned);
        assert!(found < 1e-19, "{rows} x {columns}: {found:e}");
    }
}

#[test]
fn a_sampled_surface_is_met_to_the_third_order() {
    let of = |u: f64, v: f64| 1e-5 * (3.0 * u + 1.0).sin() * (2.0 * v).exp();
    let exact = with(&sampled(900, 900, of));
    let errors = [9, 17, 33, 65].map(|n| difference(&with(&sampled(n, n, of)), &exact));
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!(
            (2.7..3.6).contains(&order),
            "order {order:.2} of {errors:?}"
        );
    }
}

#[test]
fn a_grid_stands_where_it_was_measured_and_holds_beyond() {
    let g = gear(Modifications::default());
    let rolls = [0.3, 0.8]
        .map(|part| g.roll_length_form() + part * (g.roll_length_tip() - g.roll_length_form()));
    let radii = rolls.map(|s| g.r_base().hypot(s));
    let rows = sampled(6, 8, |u, v| 1e-6 * (1.0 + u) + 3e-6 * v);
    let measured = Topography::new(&rows, Some(radii), Some([-4e-3, 8e-3])).unwrap();
    let g = gear(Modifications {
        topography: [None, Some(Arc::new(measured))],
        ..Modifications::default()
    });
    let at = |side, s: f64, z: f64| g.flank_deviation(side, g.r_base().hypot(s), z / 0.01);
    let middle = 0.5 * (rolls[0] + rolls[1]);
    for (s, z, expected) in [
        (rolls[0], -4e-3, 1e-6),
        (rolls[1], 8e-3, 5e-6),
        (middle, 2e-3, 3e-6),
        (g.roll_length_form(), -9e-3, 1e-6),
        (g.roll_length_tip(), 0.01, 5e-6),
    ] {
        let found = at(Side::Right, s, z);
        assert!((found - expected).abs() < 1e-16, "{s} {z}: {found:e}");
        assert_eq!(at(Side::Left, s, z), 0.0);
    }
}

#[test]
fn what_varies_over_the_width_is_as_told() {
    let g = gear(Modifications {
        end_relief: [
            Some(EndRelief {
                amount: 8e-6,
                length: 5e-3,
                shape: ReliefShape::Parabolic,
            }),
            Some(EndRelief {
                amount: 4e-6,
                length: 2e-3,
                shape: ReliefShape::Linear,
            }),
        ],
        helix_slope: [6e-6, -2e-6],
        twist: [0.0, 12e-6],
        ..Modifications::default()
    });
    let [low, high] = [g.r_form(), g.r_tip()];
    let (left, right) = (Side::Left, Side::Right);
    let known = [
        // Slope of 6 um towards the upper end; reliefs of 8 and 4 um.
        (left, low, -1.0, 8e-6),
        (left, high, -0.75, 2e-6 + 0.75e-6),
        (left, low, 0.0, 3e-6),
        (left, high, 0.9, 5.7e-6 + 2e-6),
        (left, high, 1.0, 6e-6 + 4e-6),
        // Slope of 2 um towards the lower end, and a profile slope from -6 um to 6 um.
        (right, high, 0.0, 1e-6 + 3e-6),
        (right, high, 1.0, 4e-6 + 6e-6),
        (right, low, 1.0, 4e-6),
        (right, low, -1.0, 8e-6 + 2e-6 + 6e-6),
        (right, high, -1.0, 8e-6 + 2e-6),
    ];
    for (side, r, zeta, expected) in known {
        let found = g.flank_deviation(side, r, zeta);
        assert!(
            (found - expected).abs() < 1e-17,
            "{side:?} {zeta}: {found:e}, {expected:e}"
        );
    }
}

#[test]
fn what_is_no_flank_is_refused_with_a_way_out() {
    let of = |modifications| {
        let params = GearParams {
            teeth: 30,
            module: 3e-3,
            face_width: 0.02,
            modifications,
            ..GearParams::default()
        };
        Gear::new(params).unwrap_err().to_string()
    };
    let grid = |rows: &[Vec<f64>], radii, heights| Topography::new(rows, radii, heights);
    let said = |rows: &[Vec<f64>]| grid(rows, None, None).unwrap_err().to_string();
    assert!(said(&[vec![0.0; 3]]).contains("1 rows of 3 amounts"));
    assert!(said(&[vec![0.0; 3], vec![0.0; 2]]).contains("2 amounts in row 2"));
    assert!(said(&[vec![0.0, f64::NAN], vec![0.0; 2]]).contains("not finite"));
    let laid = |radii, heights, amount| Modifications {
        topography: [
            Some(Arc::new(
                grid(&[vec![amount; 2], vec![0.0; 2]], radii, heights).unwrap(),
            )),
            None,
        ],
        ..Modifications::default()
    };
    assert!(of(laid(Some([0.03, 0.048]), None, 0.0)).contains("rows from radius"));
    assert!(of(laid(None, Some([-0.01, 0.011]), 0.0)).contains("columns from"));
    assert!(of(laid(None, None, 1.0)).contains("flank modifications remove"));
    let relief = |amount, length| Modifications {
        end_relief: [
            None,
            Some(EndRelief {
                amount,
                length,
                shape: ReliefShape::Linear,
            }),
        ],
        ..Modifications::default()
    };
    assert!(of(relief(1e-6, 0.03)).contains("the face is 0.02"));
    assert!(of(relief(-1e-6, 0.01)).contains("end relief amount"));
    let slope = Modifications {
        helix_slope: [f64::NAN, 0.0],
        ..Modifications::default()
    };
    assert!(of(slope).contains("helix slope"));
}

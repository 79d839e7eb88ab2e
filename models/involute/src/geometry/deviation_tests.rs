use super::*;
use crate::Vec3;
use crate::geometry::{FlankGrid, Flanks, Gear, GearParams};

fn gear(deviations: Deviations) -> Gear {
    Gear::new(GearParams {
        teeth: 25,
        module: 4e-3,
        deviations,
        ..GearParams::default()
    })
    .unwrap()
}

fn drawn(class: u32, seed: u64) -> Gear {
    gear(Deviations::Class { class, seed })
}

/// Tolerances of class 5 for d = 100 mm, m_n = 4 mm, computed by hand; each class is coarser by sqrt(2).
#[test]
fn tolerances_of_the_standard() {
    let t = IsoTolerances::new(5, 100e-3, 4e-3);
    let um = |x: f64| 1e6 * x;
    for (found, by_hand) in [
        (um(t.single_pitch), 6.7),
        (um(t.cumulative_pitch), 20.5),
        (um(t.profile_slope), 5.7),
        (um(t.profile_form), 7.2),
        (um(t.runout), 18.45),
    ] {
        assert!((found - by_hand).abs() < 1e-9, "{found} {by_hand}");
    }
    let coarser = IsoTolerances::new(7, 100e-3, 4e-3);
    assert!((coarser.single_pitch / t.single_pitch - 2.0).abs() < 1e-12);
}

/// Measured at the reference circle, single pitches, their sum and the run-out are within the class, and one of them
/// reaches its tolerance.
#[test]
fn a_drawn_gear_is_of_its_class() {
    for class in [1, 6, 11] {
        for seed in 0..20 {
            let g = drawn(class, seed);
            let t = IsoTolerances::new(class, 2.0 * g.r_reference(), 4e-3);
            let d = g.deviations().unwrap();
            let mut used = 2.0 * d.eccentric[0] / t.runout;
            for side in Side::BOTH {
                // Without slope and form, which vanish there or are no pitch.
                let place = |k: i64| {
                    let s = g.roll_length(g.r_reference());
                    let bare = ToothDeviations {
                        sides: d
                            .sides
                            .clone()
                            .map(|all| all.into_iter().map(|[p, _, _]| [p, 0.0, 0.0]).collect()),
                        ..(**d).clone()
                    };
                    -side.sign() * bare.at(k, side, s)[0] * g.r_reference() / g.r_base()
                };
                let all: Vec<f64> = (0..25).map(place).collect();
                let (low, high) = all
                    .iter()
                    .fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(*x), h.max(*x)));
                used = used.max((high - low) / t.cumulative_pitch);
                for k in 0..25 {
                    let single = place(k) - place(k - 1);
                    used = used.max(single.abs() / t.single_pitch);
                }
            }
            assert!((used - 1.0).abs() < 1e-9, "{class} {seed}: {used}");
            let profiles = d.sides.iter().flatten();
            for [_, slope, form] in profiles {
                assert!(slope.abs() <= t.profile_slope && (0.0..=t.profile_form).contains(form));
            }
        }
    }
    assert_eq!(drawn(6, 1), drawn(6, 1));
    assert_ne!(
        drawn(6, 1).tooth_deviation(0, Side::Left, 0.05),
        drawn(6, 2).tooth_deviation(0, Side::Left, 0.05)
    );
}

#[test]
fn derivatives_are_those_of_the_deviation() {
    let g = drawn(8, 3);
    let h = 1e-6;
    for side in Side::BOTH {
        for (tooth, s) in [(0, 0.01), (7, 0.017), (-3, 0.024), (103, 0.03)] {
            let at = |s| g.tooth_deviation_at_roll(tooth, side, s);
            let [value, slope, curvature] = at(s);
            let (a, b) = (at(s - h), at(s + h));
            assert!(((b[0] - a[0]) / (2.0 * h) - slope).abs() < 1e-8);
            assert!(((b[1] - a[1]) / (2.0 * h) - curvature).abs() < 1e-5);
            assert_eq!(at(s), g.tooth_deviation_at_roll(tooth + 25, side, s));
            let r = g.r_base().hypot(s);
            if (g.r_form()..=g.r_tip()).contains(&r) {
                assert!((g.tooth_deviation(tooth, side, r) - value).abs() < 1e-15);
            }
        }
    }
}

/// Run-out equals the same toothing about another axis: nodes of the plain flanks, shifted, lie on the deviating ones
/// to second order; pitch deviations rotate a flank about the axis.
#[test]
fn flanks_move_as_the_toothing_does() {
    let grid = |tooth: u32, side: Side, g: &Gear| {
        let positions = (0..9).map(|i| {
            let r = g.r_form() + (g.r_tip() - g.r_form()) * f64::from(i) / 8.0;
            let angle = f64::from(tooth) * g.pitch_angle() + side.sign() * g.half_angle_at(r);
            Vec3::new(r * angle.cos(), r * angle.sin(), 0.0)
        });
        FlankGrid {
            tooth,
            side,
            rows: 9,
            columns: 1,
            nodes: (0..9).collect(),
            positions: positions.collect(),
        }
    };
    let runout = gear(Deviations::Given(Box::new(GivenDeviations {
        runout: 40e-6,
        runout_direction: 0.7,
        ..GivenDeviations::default()
    })));
    let mut step = vec![0.0; 25];
    step[6] = 15e-6;
    let flank = FlankDeviations {
        cumulative_pitch: step,
        ..FlankDeviations::default()
    };
    let pitch = gear(Deviations::Given(Box::new(GivenDeviations {
        sides: [flank.clone(), flank],
        ..GivenDeviations::default()
    })));
    for tooth in [0, 6, 17] {
        for side in Side::BOTH {
            let plain = grid(tooth, side, &runout);
            let mut flanks = Flanks::new(vec![plain.clone()]);
            flanks.deviate(&runout);
            let mut turned = Flanks::new(vec![plain.clone()]);
            turned.deviate(&pitch);
            let angle = if tooth == 6 {
                15e-6 / pitch.r_reference()
            } else {
                0.0
            };
            for (i, x) in plain.positions.iter().enumerate() {
                let r = x.x.hypot(x.y);
                let s = runout.roll_length(r);
                let normal = x.y.atan2(x.x) - side.sign() * (s / runout.r_base()).atan();
                let out = side.sign() * Vec3::new(-normal.sin(), normal.cos(), 0.0);
                let shift = 20e-6 * Vec3::new(0.7_f64.cos(), 0.7_f64.sin(), 0.0);
                let found = (flanks.grids()[0].positions[i] - x).dot(&out);
                assert!(
                    (found - shift.dot(&out)).abs() < 1e-12,
                    "{tooth} {side:?}: {found}"
                );
                let turn = angle * Vec3::new(-x.y, x.x, 0.0);
                let found = (turned.grids()[0].positions[i] - x).dot(&out);
                assert!(
                    (found - turn.dot(&out)).abs() < 1e-12,
                    "{tooth} {side:?}: {found}"
                );
            }
        }
    }
}

#[test]
fn refusals_name_what_is_wrong() {
    let refused = |deviations| {
        let params = GearParams {
            teeth: 25,
            module: 4e-3,
            deviations,
            ..GearParams::default()
        };
        Gear::new(params).unwrap_err().to_string()
    };
    assert!(refused(Deviations::Class { class: 12, seed: 0 }).contains("12"));
    let list = |values: Vec<f64>| {
        let left = FlankDeviations {
            profile_slope: values,
            ..FlankDeviations::default()
        };
        Deviations::Given(Box::new(GivenDeviations {
            sides: [left, FlankDeviations::default()],
            ..GivenDeviations::default()
        }))
    };
    assert!(refused(list(vec![1e-6; 24])).contains("24 values"));
    assert!(refused(list(vec![f64::NAN; 25])).contains("not finite"));
    assert!(refused(list(vec![5e-3; 25])).contains("flank modifications"));
    assert!(!gear(list(vec![])).deviations().unwrap().greatest().is_nan());
}

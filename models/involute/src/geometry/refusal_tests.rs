//! Every refusal has its cause and a remedy.

use super::error::GeometryError::*;
use super::*;

fn standard(teeth: u32) -> GearParams {
    GearParams {
        teeth,
        module: 4e-3,
        ..GearParams::default()
    }
}

fn gear(teeth: u32) -> Gear {
    Gear::new(standard(teeth)).unwrap()
}

/// Checks the variant of an error and that its text has every given word; returns the expression after the arrow.
macro_rules! refused {
    ($result:expr, $variant:pat $(=> $out:expr)?, $($word:expr),+) => {{
        let error = $result.unwrap_err();
        let text = error.to_string();
        $(assert!(text.contains($word), "`{}` not in: {text}", $word);)+
        #[allow(unused_variables)]
        match error {
            $variant => { $($out)? }
            other => panic!("{other:?}"),
        }
    }};
}

#[test]
fn undercut_states_the_smallest_shift_and_tooth_number() {
    let (x, z) = refused!(Gear::new(standard(12)), Undercut { min_profile_shift: x, min_teeth: z, .. } => (x, z),
        "undercut",
        "profile shift",
        "teeth"
    );
    assert_eq!(z, 18);
    let at = |teeth, profile_shift| {
        Gear::new(GearParams {
            profile_shift,
            ..standard(teeth)
        })
    };
    assert!(at(12, x).is_ok() && at(12, x - 1e-6).is_err());
    assert!(at(18, 0.0).is_ok() && at(17, 0.0).is_err());
}

#[test]
fn pointed_teeth_state_the_largest_addendum() {
    let params = GearParams {
        profile_shift: 0.9,
        ..standard(12)
    };
    let max_addendum = refused!(Gear::new(params.clone()), PointedTooth { max_addendum, .. } => max_addendum,
        "pointed",
        "addendum"
    );
    let with = |addendum| {
        Gear::new(GearParams {
            addendum,
            ..params.clone()
        })
    };
    assert!(with(max_addendum - 1e-6).is_ok() && with(max_addendum + 1e-6).is_err());
}

#[test]
fn tool_tip_must_fit() {
    let with = |tip_radius| {
        Gear::new(GearParams {
            tip_radius,
            ..standard(40)
        })
    };
    let max_factor = refused!(with(0.6), TipRadius { max_factor, .. } => max_factor,
        "tip radius factor",
        "full radius"
    );
    assert!(with(max_factor).is_ok() && with(max_factor + 1e-6).is_err());
    let deep = Gear::new(GearParams {
        dedendum: 2.3,
        tip_radius: 0.0,
        ..standard(80)
    });
    refused!(deep, PointedTool { .. }, "dedendum", "too deep");
}

#[test]
fn bodies_and_flanks_that_vanish() {
    let bore = GearParams {
        bore_radius: 36e-3,
        ..standard(20)
    };
    refused!(
        Gear::new(bore),
        BoreTooLarge { .. },
        "bore too large",
        "smaller"
    );
    let thin = GearParams {
        thinning: 8e-3,
        ..standard(20)
    };
    refused!(Gear::new(thin), NoToothLeft { .. }, "thinning", "thin less");
    let shallow = GearParams {
        addendum: 0.05,
        profile_shift: -2.0,
        ..standard(60)
    };
    refused!(
        Gear::new(shallow),
        NoInvolute { .. },
        "no involute",
        "addendum"
    );
    // A sharp tool tip on the rolling line cuts a single point instead of a fillet.
    let folded = GearParams {
        profile_shift: 1.25,
        tip_radius: 0.0,
        addendum: 0.5,
        ..standard(100)
    };
    refused!(Gear::new(folded), FilletFolds, "fillet", "profile shift");
    let rootless = GearParams {
        profile_shift: -2.0,
        ..standard(4)
    };
    refused!(
        Gear::new(rootless),
        NoRoot { .. },
        "root radius",
        "more teeth"
    );
}

#[test]
fn modifications_must_stay_on_the_flank() {
    let with = |amount, start_radius, profile_crowning| {
        Gear::new(GearParams {
            modifications: Modifications {
                tip_relief: Some(TipRelief {
                    amount,
                    start_radius,
                    shape: ReliefShape::Linear,
                }),
                profile_crowning,
                lead_crowning: 0.0,
                ..Modifications::default()
            },
            ..standard(20)
        })
    };
    assert!(with(20e-6, 42e-3, 5e-6).is_ok());
    refused!(
        with(20e-6, 36e-3, 0.0),
        ReliefStart { .. },
        "tip relief starts",
        "form"
    );
    refused!(
        with(20e-6, 44e-3, 0.0),
        ReliefStart { .. },
        "tip relief starts"
    );
    refused!(
        with(2e-3, 42e-3, 0.0),
        ModificationTooDeep { .. },
        "smaller amounts"
    );
    refused!(with(-1e-6, 42e-3, 0.0), Invalid { .. }, "tip relief amount");
    refused!(with(1e-6, f64::NAN, 0.0), Invalid { .. }, "start radius");
    refused!(with(1e-6, 42e-3, -1e-6), Invalid { .. }, "profile crowning");
}

#[test]
fn values_that_are_no_lengths() {
    type Set = fn(&mut GearParams, f64);
    let fields: [(&str, Set); 10] = [
        ("module", |p, v| p.module = v),
        ("pressure angle", |p, v| p.pressure_angle = v),
        ("profile shift", |p, v| p.profile_shift = v),
        ("helix angle", |p, v| p.helix_angle = v),
        ("face width", |p, v| p.face_width = v),
        ("addendum", |p, v| p.addendum = v),
        ("dedendum", |p, v| p.dedendum = v),
        ("tip radius", |p, v| p.tip_radius = v),
        ("thinning", |p, v| p.thinning = v),
        ("bore", |p, v| p.bore_radius = v),
    ];
    for (name, set) in fields {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1e3, -1.0] {
            // A negative shift or helix angle is legitimate; -1.0 rad (57 degrees) still is.
            if value == -1.0 && ["profile shift", "helix angle"].contains(&name) {
                continue;
            }
            let mut params = standard(20);
            set(&mut params, value);
            let error = Gear::new(params).unwrap_err();
            if value != -1e3 || name != "profile shift" {
                let named = matches!(error, Invalid { .. }) && error.to_string().contains(name);
                assert!(named, "{name} = {value}: {error}");
            }
        }
    }
    refused!(
        Gear::new(GearParams::default()),
        Invalid { .. },
        "number of teeth"
    );
    let huge = GearParams {
        profile_shift: 1e300,
        ..standard(20)
    };
    assert!(Gear::new(huge).is_err());
    let (one, two) = (gear(20), gear(30));
    for a in [f64::NAN, f64::INFINITY, -0.1, 0.0] {
        refused!(Pair::new(&one, &two, a), Invalid { .. }, "centre distance");
    }
}

#[test]
fn gears_that_do_not_belong_together() {
    let one = gear(20);
    let other = |change: fn(&mut GearParams)| {
        let mut params = standard(30);
        change(&mut params);
        Gear::new(params).unwrap()
    };
    let module = other(|p| p.module = 5e-3);
    refused!(
        Pair::new(&one, &module, 0.1),
        UnequalModules { .. },
        "modules"
    );
    let angle = other(|p| p.pressure_angle = 0.4);
    refused!(
        Pair::new(&one, &angle, 0.1),
        UnequalPressureAngles { .. },
        "pressure angles"
    );
    let helical = other(|p| p.helix_angle = 0.2);
    refused!(
        Pair::new(&one, &helical, 0.1),
        HelixMismatch { .. },
        "opposite"
    );
    refused!(
        Pair::new(&helical, &helical, 0.1),
        HelixMismatch { .. },
        "hand"
    );
}

#[test]
fn impossible_centre_distances() {
    let (one, two) = (gear(20), gear(30));
    let at = |a| Pair::new(&one, &two, a);
    refused!(
        at(0.09),
        CentreDistanceTooSmall { .. },
        "too small",
        "base radii"
    );
    let min_distance = refused!(at(0.0995), FlanksOverlap { min_distance, .. } => min_distance,
        "overlap",
        "at least"
    );
    assert!((min_distance - 0.1).abs() < 1e-12 && at(min_distance).is_ok());
    let max_distance = refused!(at(0.11), NoEngagement { max_distance, .. } => max_distance,
        "engagement",
        "below"
    );
    refused!(at(max_distance + 1e-9), NoEngagement { .. }, "engagement");
    refused!(
        at(max_distance - 1e-9),
        ContactRatio { .. },
        "contact ratio"
    );
    refused!(at(0.1045), ContactRatio { .. }, "contact ratio", "below 1");
    // Thinned gears can be pushed together until the tips reach the roots.
    let thin = |teeth| {
        Gear::new(GearParams {
            thinning: 1.5e-3,
            ..standard(teeth)
        })
        .unwrap()
    };
    let close = Pair::new(&thin(40), &thin(40), 0.1585);
    refused!(close, TipRootCollision { .. }, "collide", "gear 1");
}

#[test]
fn interference_states_by_how_much_to_shorten() {
    // Eighteen teeth have hardly any involute near the base circle; a long mating addendum digs in.
    let long = |addendum| {
        Gear::new(GearParams {
            addendum,
            ..standard(100)
        })
        .unwrap()
    };
    let (small, a) = (gear(18), 0.236_05);
    let reduce_by = refused!(Pair::new(&small, &long(1.1), a), Interference { reduce_by, .. } => reduce_by,
        "interference",
        "gear 2",
        "reduce"
    );
    assert!(Pair::new(&small, &long(1.1 - reduce_by / 4e-3 - 1e-9), a).is_ok());
}

#[test]
fn racks_and_rack_pairs() {
    let rack_of = |change: fn(&mut RackParams)| {
        let mut params = RackParams {
            teeth: 5,
            module: 4e-3,
            ..RackParams::default()
        };
        change(&mut params);
        Rack::new(params)
    };
    refused!(rack_of(|p| p.teeth = 0), Invalid { .. }, "rack teeth");
    refused!(rack_of(|p| p.body_height = 0.0), Invalid { .. }, "body");
    refused!(
        rack_of(|p| p.addendum = 2.2),
        PointedTooth { .. },
        "pointed"
    );
    refused!(
        rack_of(|p| p.tip_radius = 0.5),
        TipRadius { .. },
        "full radius"
    );
    refused!(rack_of(|p| p.thinning = 7e-3), NoToothLeft { .. }, "thin");
    let (pinion, rack) = (gear(20), rack_of(|_| ()).unwrap());
    let at = |d| Pair::new(&pinion, &rack, d);
    let min_distance =
        refused!(at(0.0395), FlanksOverlap { min_distance, .. } => min_distance, "overlap");
    assert!((min_distance - 0.04).abs() < 1e-12 && at(0.04).is_ok());
    refused!(at(0.048), NoEngagement { .. }, "engagement");
    refused!(at(0.0445), ContactRatio { .. }, "contact ratio");
    refused!(at(f64::NAN), Invalid { .. }, "distance");
    let coarse = rack_of(|p| p.module = 5e-3).unwrap();
    refused!(
        Pair::new(&pinion, &coarse, 0.04),
        UnequalModules { .. },
        "modules"
    );
    let long = rack_of(|p| p.addendum = 1.2).unwrap();
    refused!(
        Pair::new(&pinion, &long, 0.04),
        Interference { .. },
        "the rack",
        "reduce"
    );
}

//! Every refusal names its cause and a way out.

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

/// The error must be of the variant and its text must hold every word.
macro_rules! refused {
    ($result:expr, $variant:pat, $($word:expr),+) => {{
        let error = $result.unwrap_err();
        assert!(matches!(error, $variant), "{error:?}");
        let text = error.to_string();
        $(assert!(text.contains($word), "`{}` not in: {text}", $word);)+
        error
    }};
}

#[test]
fn undercut_states_the_smallest_shift_and_tooth_number() {
    let error = refused!(
        Gear::new(standard(12)),
        GeometryError::Undercut { .. },
        "undercut",
        "profile shift",
        "teeth"
    );
    let GeometryError::Undercut {
        min_profile_shift: x,
        min_teeth: z,
        ..
    } = error
    else {
        unreachable!("matched above")
    };
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
    let error = refused!(
        Gear::new(params.clone()),
        GeometryError::PointedTooth { .. },
        "pointed",
        "addendum"
    );
    let GeometryError::PointedTooth { max_addendum, .. } = error else {
        unreachable!("matched above")
    };
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
    let error = refused!(
        with(0.6),
        GeometryError::TipRadius { .. },
        "tip radius factor",
        "full radius"
    );
    let GeometryError::TipRadius { max_factor, .. } = error else {
        unreachable!("matched above")
    };
    assert!(with(max_factor).is_ok() && with(max_factor + 1e-6).is_err());
    let deep = Gear::new(GearParams {
        dedendum: 2.3,
        tip_radius: 0.0,
        ..standard(80)
    });
    refused!(
        deep,
        GeometryError::PointedTool { .. },
        "dedendum",
        "too deep"
    );
}

#[test]
fn bodies_and_flanks_that_vanish() {
    let bore = GearParams {
        bore_radius: 36e-3,
        ..standard(20)
    };
    refused!(
        Gear::new(bore),
        GeometryError::BoreTooLarge { .. },
        "bore too large",
        "smaller"
    );
    let thin = GearParams {
        thinning: 8e-3,
        ..standard(20)
    };
    refused!(
        Gear::new(thin),
        GeometryError::NoToothLeft { .. },
        "thinning",
        "thin less"
    );
    let shallow = GearParams {
        addendum: 0.05,
        profile_shift: -2.0,
        ..standard(60)
    };
    refused!(
        Gear::new(shallow),
        GeometryError::NoInvolute { .. },
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
    refused!(
        Gear::new(folded),
        GeometryError::FilletFolds,
        "fillet",
        "profile shift"
    );
    let rootless = GearParams {
        profile_shift: -2.0,
        ..standard(4)
    };
    refused!(
        Gear::new(rootless),
        GeometryError::NoRoot { .. },
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
            },
            ..standard(20)
        })
    };
    assert!(with(20e-6, 42e-3, 5e-6).is_ok());
    refused!(
        with(20e-6, 36e-3, 0.0),
        GeometryError::ReliefStart { .. },
        "tip relief starts",
        "form"
    );
    refused!(
        with(20e-6, 44e-3, 0.0),
        GeometryError::ReliefStart { .. },
        "tip relief starts"
    );
    refused!(
        with(2e-3, 42e-3, 0.0),
        GeometryError::ModificationTooDeep { .. },
        "smaller amounts"
    );
    refused!(
        with(-1e-6, 42e-3, 0.0),
        GeometryError::Invalid { .. },
        "tip relief amount"
    );
    refused!(
        with(1e-6, f64::NAN, 0.0),
        GeometryError::Invalid { .. },
        "start radius"
    );
    refused!(
        with(1e-6, 42e-3, -1e-6),
        GeometryError::Invalid { .. },
        "profile crowning"
    );
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
                let named = matches!(error, GeometryError::Invalid { .. })
                    && error.to_string().contains(name);
                assert!(named, "{name} = {value}: {error}");
            }
        }
    }
    refused!(
        Gear::new(GearParams::default()),
        GeometryError::Invalid { .. },
        "number of teeth"
    );
    let huge = GearParams {
        profile_shift: 1e300,
        ..standard(20)
    };
    assert!(Gear::new(huge).is_err());
    let (one, two) = (gear(20), gear(30));
    for a in [f64::NAN, f64::INFINITY, -0.1, 0.0] {
        refused!(
            Pair::new(&one, &two, a),
            GeometryError::Invalid { .. },
            "centre distance"
        );
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
        GeometryError::UnequalModules { .. },
        "modules"
    );
    let angle = other(|p| p.pressure_angle = 0.4);
    refused!(
        Pair::new(&one, &angle, 0.1),
        GeometryError::UnequalPressureAngles { .. },
        "pressure angles"
    );
    let helical = other(|p| p.helix_angle = 0.2);
    refused!(
        Pair::new(&one, &helical, 0.1),
        GeometryError::HelixMismatch { .. },
        "opposite"
    );
    refused!(
        Pair::new(&helical, &helical, 0.1),
        GeometryError::HelixMismatch { .. },
        "hand"
    );
}

#[test]
fn impossible_centre_distances() {
    let (one, two) = (gear(20), gear(30));
    let at = |a| Pair::new(&one, &two, a);
    refused!(
        at(0.09),
        GeometryError::CentreDistanceTooSmall { .. },
        "too small",
        "base radii"
    );
    let error = refused!(
        at(0.0995),
        GeometryError::FlanksOverlap { .. },
        "overlap",
        "at least"
    );
    let GeometryError::FlanksOverlap { min_distance, .. } = error else {
        unreachable!("matched above")
    };
    assert!((min_distance - 0.1).abs() < 1e-12 && at(min_distance).is_ok());
    let error = refused!(
        at(0.11),
        GeometryError::NoEngagement { .. },
        "engagement",
        "below"
    );
    let GeometryError::NoEngagement { max_distance, .. } = error else {
        unreachable!("matched above")
    };
    refused!(
        at(max_distance + 1e-9),
        GeometryError::NoEngagement { .. },
        "engagement"
    );
    refused!(
        at(max_distance - 1e-9),
        GeometryError::ContactRatio { .. },
        "contact ratio"
    );
    refused!(
        at(0.1045),
        GeometryError::ContactRatio { .. },
        "contact ratio",
        "below 1"
    );
    // Thinned gears can be pushed together until the tips reach the roots.
    let thin = |teeth| {
        Gear::new(GearParams {
            thinning: 1.5e-3,
            ..standard(teeth)
        })
        .unwrap()
    };
    let close = Pair::new(&thin(40), &thin(40), 0.1585);
    refused!(
        close,
        GeometryError::TipRootCollision { .. },
        "collide",
        "gear 1"
    );
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
    let error = refused!(
        Pair::new(&small, &long(1.1), a),
        GeometryError::Interference { .. },
        "interference",
        "gear 2",
        "reduce"
    );
    let GeometryError::Interference { reduce_by, .. } = error else {
        unreachable!("matched above")
    };
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
    refused!(
        rack_of(|p| p.teeth = 0),
        GeometryError::Invalid { .. },
        "rack teeth"
    );
    refused!(
        rack_of(|p| p.body_height = 0.0),
        GeometryError::Invalid { .. },
        "body"
    );
    refused!(
        rack_of(|p| p.addendum = 2.2),
        GeometryError::PointedTooth { .. },
        "pointed"
    );
    refused!(
        rack_of(|p| p.tip_radius = 0.5),
        GeometryError::TipRadius { .. },
        "full radius"
    );
    refused!(
        rack_of(|p| p.thinning = 7e-3),
        GeometryError::NoToothLeft { .. },
        "thin"
    );
    let (pinion, rack) = (gear(20), rack_of(|_| ()).unwrap());
    let at = |d| RackPair::new(&pinion, &rack, d);
    let error = refused!(at(0.0395), GeometryError::FlanksOverlap { .. }, "overlap");
    let GeometryError::FlanksOverlap { min_distance, .. } = error else {
        unreachable!("matched above")
    };
    assert!((min_distance - 0.04).abs() < 1e-12 && at(0.04).is_ok());
    refused!(at(0.048), GeometryError::NoEngagement { .. }, "engagement");
    refused!(
        at(0.0445),
        GeometryError::ContactRatio { .. },
        "contact ratio"
    );
    refused!(at(f64::NAN), GeometryError::Invalid { .. }, "distance");
    let coarse = rack_of(|p| p.module = 5e-3).unwrap();
    refused!(
        RackPair::new(&pinion, &coarse, 0.04),
        GeometryError::UnequalModules { .. },
        "modules"
    );
    let long = rack_of(|p| p.addendum = 1.2).unwrap();
    refused!(
        RackPair::new(&pinion, &long, 0.04),
        GeometryError::Interference { .. },
        "the rack",
        "reduce"
    );
}

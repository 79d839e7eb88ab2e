//! Specification of a gear: it guides the search where that is ambiguous, and is compared with the result.

use super::*;
use crate::gear_mesh::{self, GearMeshParams, Web};
use crate::mesh::ElementKind;
use crate::recognise::tests::plain;
use crate::recognise::{Skin, recognise};
use crate::test_support;

fn held(of: Result<crate::recognise::RecognisedGear, Misfit>) -> &'static str {
    match of {
        Err(Misfit::Against { key, .. }) => key,
        other => panic!("{other:?}"),
    }
}

/// A specified radius selects the bore of a gear with a web, which has two inner cylinders.
#[test]
fn a_radius_that_is_said_tells_the_bore() {
    let gear = test_support::gear(30, 4e-3, |p| p.bore_radius = 20e-3);
    let params = GearMeshParams {
        rim: 2,
        width: 3,
        web: Some(Web {
            inner_radius: 30e-3,
            outer_radius: 48e-3,
            thickness: 4e-3,
            layers: 2,
            hub_layers: 2,
        }),
        ..plain(ElementKind::C3D8)
    };
    let own = gear_mesh::gear(&gear, &params).unwrap();
    let skin = Skin::of(&own.mesh.nodes, &own.mesh.blocks);
    let of = |bore_radius| {
        let known = SpecifiedBody {
            bore_radius,
            ..SpecifiedBody::default()
        };
        recognise(&skin, &known).unwrap().bore.radius
    };
    for (said, found) in [(None, 20e-3), (Some(21e-3), 20e-3), (Some(47e-3), 48e-3)] {
        assert!((of(said) - found).abs() < 1e-9, "{said:?} {}", of(said));
    }
}

#[test]
fn the_sense_of_an_axis_is_the_one_that_is_said() {
    let gear = test_support::gear(17, 3e-3, |p| {
        p.bore_radius = 10e-3;
        p.helix_angle = 0.2;
    });
    let own = gear_mesh::gear(&gear, &plain(ElementKind::C3D8)).unwrap();
    let skin = Skin::of(&own.mesh.nodes, &own.mesh.blocks);
    let of = |axis: [f64; 3], point: [f64; 3]| {
        let known = SpecifiedBody {
            axis: Some(axis.into()),
            point: Some(point.into()),
            ..SpecifiedBody::default()
        };
        recognise(&skin, &known)
    };
    let up = of([0.0, 0.0, 1.0], [0.0; 3]).unwrap();
    let down = of([0.01, 0.0, -3.0], [1e-4, 0.0, 1.0]).unwrap();
    assert_eq!(down.axis.direction, -Vec3::z());
    // From the other end the hand of the helix is the same, and left flanks are right ones still of the same gear.
    assert!((down.fit.base_helix_angle() - up.fit.base_helix_angle()).abs() < 1e-9);
    assert!((down.fit.base_thickness() - up.fit.base_thickness()).abs() < 1e-12);
    assert_eq!(down.flanks.len(), 34);
    assert_eq!(held(of([0.0, 1.0, 0.0], [0.0; 3])), "axis");
    assert_eq!(held(of([0.0, 0.0, 1.0], [2e-3, 0.0, 0.0])), "axis_point_m");
}

/// Specified radii limit the flanks, and include parts that a relief has removed.
#[test]
fn radii_that_are_said_bound_the_flanks() {
    use gearbench_models::geometry::{Modifications, ReliefShape, TipRelief};
    let gear = test_support::gear(25, 4e-3, |p| {
        p.bore_radius = 20e-3;
        // More than the search takes for a relief: a fiftieth of the tooth's height.
        p.modifications = Modifications {
            tip_relief: Some(TipRelief {
                amount: 300e-6,
                start_radius: 51.5e-3,
                shape: ReliefShape::Linear,
            }),
            ..Modifications::default()
        };
    });
    let own = gear_mesh::gear(&gear, &plain(ElementKind::C3D8)).unwrap();
    let skin = Skin::of(&own.mesh.nodes, &own.mesh.blocks);
    let faces = |flanks| {
        let known = SpecifiedBody {
            flanks,
            ..SpecifiedBody::default()
        };
        let found = recognise(&skin, &known)?;
        let faces: usize = found.flanks.iter().map(|p| p.faces.len()).sum();
        Ok::<_, Misfit>((faces, found.active))
    };
    let (free, active) = faces(None).unwrap();
    assert!(free < 50 * 12, "the relief counts as a flank: {free}");
    let tip = own
        .mesh
        .nodes
        .iter()
        .map(|x| x.xy().norm())
        .fold(0.0, f64::max);
    let (whole, _) = faces(Some([active[0], tip])).unwrap();
    assert_eq!(whole, 50 * 12);
    let (less, ends) = faces(Some([49e-3, tip])).unwrap();
    assert!(less < whole && ends[0] >= 49e-3 - 1e-6, "{less} {ends:?}");
    let refused = faces(Some([30e-3, tip])).unwrap_err();
    assert!(matches!(
        refused,
        Misfit::Against {
            key: "flank_radii_m",
            ..
        }
    ));
}

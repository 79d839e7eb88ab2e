//! Stored reductions held against gears, and opened once.

use super::*;
use crate::mesh;
use crate::reduction::geometry::tests::bare;
use crate::reduction::store::Meta;
use crate::reduction::{Basis, Mounting, Request, Wanted};
use crate::test_support::{self, counted};
use gearbench_models::geometry::{Gear, GearParams};
use gearbench_models::spec::{Mount, Parameters};
use gearbench_models::stiffness::Material;

fn gear(teeth: u32, change: impl Fn(&mut GearParams)) -> Gear {
    test_support::gear(teeth, 3e-3, |p| {
        (p.face_width, p.tip_radius, p.bore_radius) = (1e-2, 0.3, 8e-3);
        change(p);
    })
}

/// What is wrong with a stored gear of 18 teeth for another gear on some mount.
fn judged(
    body: Body,
    mount: Mount,
    added_inertia: f64,
    material: Material,
    change: impl Fn(&mut Basis),
) -> Option<String> {
    let mesh = mesh::gear(&gear(18, |_| {}), &counted(4, 1, 1)).unwrap();
    let mut basis = bare(&mesh);
    change(&mut basis);
    let request = Request {
        along_profile: false,
        mesh: &mesh,
        sector: false,
        material: Material::STEEL,
        mounting: Mounting::gear(true, 0.0),
        wanted: Wanted::Count(0),
    };
    let stored = Stored {
        meta: Meta::new(&request, "a test"),
        basis: Arc::new(basis),
    };
    let (hub, none) = (test_support::hub(mount, None), Parameters::new());
    let context = GearContext {
        slides: false,
        lines: None,
        material,
        added_inertia,
        ..test_support::context(&body, &hub, &none)
    };
    misfit(&stored, &context)
}

#[test]
fn what_does_not_suit_a_gear_is_told_with_a_way_out() {
    let steel = Material::STEEL;
    let own = || Body::Gear(gear(18, |_| {}));
    let free = Mount::Revolute;
    assert_eq!(judged(own(), free.clone(), 0.0, steel, |_| {}), None);
    // A bore, a fillet or some backlash more do not matter to contact.
    let other = Body::Gear(gear(18, |p| {
        p.bore_radius = 6e-3;
        p.thinning = 5e-5;
    }));
    assert_eq!(judged(other, free.clone(), 0.0, steel, |_| {}), None);

    let rack = test_support::rack(18, 3e-3, |p| p.face_width = 1e-2);
    let another = |change: &dyn Fn(&mut GearParams)| {
        judged(
            Body::Gear(gear(18, change)),
            free.clone(),
            0.0,
            steel,
            |_| {},
        )
    };
    let added = |basis: &mut Basis| basis.added_inertia = 2e-4;
    let soft = Material {
        young: 7e10,
        ..steel
    };
    for (found, words) in [
        (
            judged(
                Body::Gear(gear(19, |_| {})),
                free.clone(),
                0.0,
                steel,
                |_| {},
            ),
            "it is of a gear with 18 teeth, but `pinion` is a gear with 19; reduce the mesh of this gear",
        ),
        (
            judged(Body::Rack(rack), Mount::Fixed, 0.0, steel, |_| {}),
            "`pinion` is a rack with 18",
        ),
        (another(&|p| p.profile_shift = 0.2), "tip radius"),
        (another(&|p| p.module = 3.1e-3), "tip radius"),
        (
            another(&|p| p.pressure_angle = 0.4363),
            "its base radius is 25.3",
        ),
        (
            another(&|p| p.face_width = 1.1e-2),
            "its face width is 10.0000 mm, that of `pinion` 11.0000 mm",
        ),
        (
            judged(own(), Mount::Fixed, 0.0, steel, |_| {}),
            "its hub is free, but the mount of `pinion` leaves it held; reduce the gear with `--mount held`",
        ),
        (
            judged(own(), free.clone(), 0.0, steel, |b| b.free = false),
            "reduce the gear with `--mount free`",
        ),
        (
            judged(own(), free.clone(), 1e-4, steel, |_| {}),
            "0e0 is added to its hub, but 1e-4 to that of `pinion`; reduce the gear with `--added-inertia 1e-4`",
        ),
        (
            judged(own(), free.clone(), 1e-4, steel, added),
            "2e-4 is added",
        ),
        (
            judged(own(), free.clone(), 0.0, soft, |_| {}),
            "`material = { young_pa = 2.1e11, poisson = 0.3, density_kg_m3 = 7850 }`",
        ),
    ] {
        let found = found.expect(words);
        assert!(found.contains(words), "{found}\n{words}");
        assert!(found.contains("; "), "a way out: {found}");
    }
}

#[test]
fn a_file_is_opened_once_until_it_changes() {
    let (basis, meta) = crate::reduction::store::tests::example(3, 5, true);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npz");
    store::write(&path, &basis, &meta).unwrap();
    let first = open(&path).unwrap();
    assert!(Arc::ptr_eq(&first, &open(&path).unwrap()));
    let (basis, meta) = crate::reduction::store::tests::example(3, 6, true);
    store::write(&path, &basis, &meta).unwrap();
    let second = open(&path).unwrap();
    assert_eq!((first.basis.omega.len(), second.basis.omega.len()), (5, 6));
    std::fs::remove_file(&path).unwrap();
    assert!(open(&path).is_err());
}

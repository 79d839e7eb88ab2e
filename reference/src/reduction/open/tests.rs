//! Stored reductions compared with gears, and opened once.

use super::*;
use crate::gear_mesh;
use crate::reduction::geometry::tests::bare;
use crate::reduction::store::Meta;
use crate::reduction::{Basis, ModeSelection, Mounting, Request};
use crate::test_support::{self, counted};
use gearbench_models::gear::elastic::inertia::Integrals;
use gearbench_models::gear::elastic::reduced::FlankCompliance;
use gearbench_models::gear::rigid;
use gearbench_models::geometry::{Gear, GearParams};
use gearbench_models::spec::Mount;
use gearbench_models::stiffness::Material;

fn gear(teeth: u32, change: impl Fn(&mut GearParams)) -> Gear {
    test_support::gear(teeth, 3e-3, |p| {
        (p.face_width, p.tip_radius, p.bore_radius) = (1e-2, 0.3, 8e-3);
        change(p);
    })
}

/// Returns the misfit of a stored gear of 18 teeth with another gear on some mount.
fn judged(
    body: Body,
    mount: Mount,
    added_inertia: f64,
    material: Material,
    change: impl Fn(&mut Basis),
) -> Option<String> {
    let mesh = gear_mesh::gear(&gear(18, |_| {}), &counted(4, 1, 1)).unwrap();
    let mut basis = bare(&mesh);
    change(&mut basis);
    let request = Request {
        along_profile: false,
        foreign: None,
        mesh: &mesh,
        sector: false,
        material: Material::STEEL,
        mounting: Mounting::gear(true, 0.0),
        wanted: ModeSelection::Count(0),
    };
    let stored = Stored {
        meta: Meta::new(&request, "a test"),
        basis: Arc::new(basis),
    };
    let (hub, none) = (test_support::hub(mount, None), rigid::spec());
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

/// Modes of a small gear, as they are reduced.
fn reduced(modes: usize) -> (Basis, Meta) {
    let mesh = gear_mesh::gear(&gear(18, |_| {}), &counted(4, 1, 1)).unwrap();
    let request = Request {
        along_profile: false,
        foreign: None,
        mesh: &mesh,
        sector: false,
        material: Material::STEEL,
        mounting: Mounting::gear(true, 0.0),
        wanted: ModeSelection::Count(modes),
    };
    (request.compute().unwrap(), Meta::new(&request, "a test"))
}

#[test]
fn a_file_is_opened_once_until_it_changes() {
    let (basis, meta) = reduced(5);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npz");
    store::write(&path, &basis, &meta).unwrap();
    let first = open(&path).unwrap();
    assert!(Arc::ptr_eq(&first, &open(&path).unwrap()));
    let (more, meta) = reduced(9);
    store::write(&path, &more, &meta).unwrap();
    let second = open(&path).unwrap();
    let counts = [&first, &second].map(|s| s.basis.omega.len());
    assert_eq!(counts, [basis.omega.len(), more.omega.len()]);
    std::fs::remove_file(&path).unwrap();
    assert!(open(&path).is_err());
}

/// Reductions that violate mechanics are refused: reciprocity, modes within the compliance, size, mass.
#[test]
fn reductions_of_no_elastic_body_are_refused() {
    let (basis, meta) = reduced(8);
    let folder = tempfile::tempdir().unwrap();
    let blocks = |b: &mut Basis, change: &dyn Fn(&mut [f64])| match &mut b.compliance.flanks {
        FlankCompliance::Full(c) | FlankCompliance::Cyclic { blocks: c, .. } => change(c),
        FlankCompliance::Deflated(_) => {}
    };
    let integrals = |b: &mut Basis, change: &dyn Fn(&mut Integrals)| {
        change(Arc::make_mut(b.integrals.as_mut().unwrap()));
    };
    type Change<'a> = &'a dyn Fn(&mut Basis);
    let cases: [(&str, Change<'_>, &str); 8] = [
        ("sound", &|_| {}, ""),
        (
            "compliance",
            &|b| blocks(b, &|c| c.iter_mut().for_each(|x| *x *= 1e10)),
            "of this width and modulus",
        ),
        (
            "asymmetric",
            &|b| blocks(b, &|c| c[1] *= 1.5),
            "reciprocity",
        ),
        (
            "shapes",
            &|b| b.shapes.iter_mut().for_each(|x| *x *= 100.0),
            "not more compliant than the whole body",
        ),
        (
            "inertia",
            &|b| b.inertia *= 100.0,
            "that of the mass of the mesh",
        ),
        (
            "frequencies",
            &|b| b.omega.iter_mut().for_each(|w| *w = 1e300),
            "at most",
        ),
        (
            "mass",
            &|b| integrals(b, &|i| i.mass = -5.0),
            "a positive mass",
        ),
        (
            "heavy",
            &|b| b.inertia = 1e300,
            "that of the mass of the mesh",
        ),
    ];
    for (name, change, words) in cases {
        let mut changed = basis.clone();
        change(&mut changed);
        let path = folder.path().join(format!("{name}.npz"));
        store::write(&path, &changed, &meta).unwrap();
        match open(&path) {
            Ok(_) => assert!(words.is_empty(), "{name} is taken"),
            Err(e) => {
                let said = e.to_string();
                assert!(!words.is_empty() && said.contains(words), "{name}: {said}");
            }
        }
    }
    // Another body in the place of the gear, where the file has no masses to compare with.
    let heavy = judged(
        Body::Gear(gear(18, |_| {})),
        Mount::Revolute,
        0.0,
        Material::STEEL,
        |b| {
            b.inertia *= 100.0;
        },
    );
    assert!(heavy.is_some_and(|why| why.contains("its inertia is")));
}

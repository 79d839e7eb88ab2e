use super::*;
use crate::deck::{Deck, InitialVelocity, Procedure, Target};
use crate::gear_deck::{DeckGear, gears};
use crate::test_support::{self, calculix, layered, parsed};

fn read_text(text: &[u8]) -> Deck {
    parsed("written.inp", std::str::from_utf8(text).unwrap())
}

fn same_mesh(a: &DeckGear, b: &DeckGear) {
    assert!(a.mesh == b.mesh, "the mesh came back otherwise");
    assert_eq!(a.material, b.material);
}

#[test]
fn one_gear_comes_back_bit_for_bit() {
    for name in [
        "case-a-fine/AF8_d05.inp.gz",
        "rack-pinion/R8b_d05.inp.gz",
        "modal/impA_g1_C3D8I.inp.gz",
        "modal/g1_C3D20R.inp.gz",
    ] {
        for gear in gears(&calculix(name)).unwrap() {
            let mut text = Vec::new();
            let options = GearDeck {
                title: format!("{name}\n*a line of stars"),
                modal: Some(ModalRun {
                    program: ModalProgram::Calculix,
                    modes: 7,
                    stem: String::new(),
                }),
            };
            write(&mut text, &gear.mesh, &gear.material, &options).unwrap();
            let deck = read_text(&text);
            assert_eq!(deck.heading, [name, "a line of stars"]);
            assert_eq!(deck.steps[0].procedure, Procedure::Frequency { modes: 7 });
            let mut found = gears(&deck).unwrap();
            let again = found.pop().unwrap();
            assert!(found.is_empty());
            same_mesh(&gear, &again);
            assert_eq!(again.shape, gear.shape);
            assert_eq!((again.centre, again.phase), (Vec3::zeros(), 0.0), "{name}");
            let mut second = Vec::new();
            write(&mut second, &again.mesh, &again.material, &options).unwrap();
            assert!(text == second, "the same text again");
        }
    }
}

#[test]
fn an_impact_says_what_the_stored_one_says() {
    let stored = calculix("case-a-fine/AF8_d05.inp.gz");
    let found = gears(&stored).unwrap();
    let impact = Impact::of(&stored, &found).unwrap();
    assert_eq!(impact.pairs, [[19, 1], [0, 0], [1, 29]]);
    assert_eq!(
        impact.gears.each_ref().map(|g| g.hub),
        [Hub::Free { speed: 20.0 }, Hub::Free { speed: 0.0 }]
    );
    assert_eq!(
        (impact.penalty, impact.step, impact.end, impact.alpha),
        (1e15, 5e-7, 2.5e-4, -0.05)
    );
    let mut text = Vec::new();
    write_impact(&mut text, &impact).unwrap();
    let deck = read_text(&text);
    let again = gears(&deck).unwrap();
    for (a, b) in found.iter().zip(&again) {
        // Positions were turned there and back: the last bits differ.
        for (x, y) in a.mesh.mesh.nodes.iter().zip(&b.mesh.mesh.nodes) {
            assert!((x - y).norm() < 1e-16);
        }
        assert_eq!(a.mesh.mesh.blocks, b.mesh.mesh.blocks);
        assert_eq!(a.mesh.mesh.node_sets, b.mesh.mesh.node_sets);
        assert_eq!(a.mesh.mesh.face_sets, b.mesh.mesh.face_sets);
        assert!((a.phase - b.phase).abs() < 1e-15 && a.centre == b.centre);
        assert_eq!(a.rigid_body, b.rigid_body);
    }
    for (name, faces) in &stored.surfaces {
        let mut one = faces.clone();
        let mut two = deck.surfaces[name].clone();
        one.sort_unstable();
        two.sort_unstable();
        assert_eq!(one, two, "{name}");
    }
    let pairs = |d: &Deck| -> Vec<(String, String)> {
        let pairs = d.contact_pairs.iter();
        pairs.map(|p| (p.slave.clone(), p.master.clone())).collect()
    };
    assert_eq!(pairs(&stored), pairs(&deck));
    let stiffness = |d: &Deck| d.interactions["si"].stiffness;
    assert_eq!(stiffness(&stored), stiffness(&deck));
    let (a, b) = (&stored.initial_velocities, &deck.initial_velocities);
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().zip(b) {
        assert_eq!((&a.target, a.direction), (&b.target, b.direction));
        assert!((a.value - b.value).abs() <= 1e-9 * a.value.abs().max(0.1));
    }
    assert_eq!(stored.steps[0].procedure, deck.steps[0].procedure);
    assert_eq!(stored.steps[0].requests, deck.steps[0].requests);
    let sets = |d: &Deck| d.node_sets.keys().cloned().collect::<Vec<_>>();
    assert_eq!(sets(&stored), sets(&deck));
}

#[test]
fn a_clamped_rack_has_no_hub() {
    let stored = calculix("rack-pinion/R8b_d05.inp.gz");
    let found = gears(&stored).unwrap();
    let mut text = Vec::new();
    let impact = Impact::of(&stored, &found).unwrap();
    // The deck calls the rack's teeth 1, 0 and -1 from the other end.
    assert_eq!(impact.pairs, [[19, 4], [0, 0], [1, 1]]);
    assert_eq!(impact.gears[1].hub, Hub::Clamped);
    write_impact(&mut text, &impact).unwrap();
    let deck = read_text(&text);
    assert_eq!(deck.rigid_bodies.len(), 1);
    let again = gears(&deck).unwrap();
    assert_eq!(again[1].shape, found[1].shape);
    assert!((again[1].phase - found[1].phase).abs() < 1e-16);
    assert!((again[1].centre - found[1].centre).norm() < 1e-16);
}

#[test]
fn a_tilted_gear_comes_back_about_its_axis() {
    let stored = calculix("case-a-coarse/A8_d05.inp.gz");
    let found = gears(&stored).unwrap();
    let mut impact = Impact::of(&stored, &found).unwrap();
    let axis = Vec3::new(3e-3, -2e-3, 1.0).normalize();
    for gear in &mut impact.gears {
        gear.axis = axis;
        gear.hub = Hub::Free { speed: 20.0 };
    }
    let mut text = Vec::new();
    write_impact(&mut text, &impact).unwrap();
    let deck = read_text(&text);
    let again = gears(&deck).unwrap();
    let back = Impact::of(&deck, &again).unwrap();
    for (i, (a, b)) in impact.gears.iter().zip(&back.gears).enumerate() {
        assert!((a.axis - b.axis).norm() < 1e-9, "{:?}", b.axis);
        assert!((a.centre - b.centre).norm() < 1e-9, "{:?}", b.centre);
        assert!((a.phase - b.phase).abs() < 1e-8, "{} {}", a.phase, b.phase);
        let Hub::Free { speed } = b.hub else {
            panic!("gear {i} is held");
        };
        assert!((speed - 20.0).abs() < 1e-9, "{speed}");
        for (x, y) in a.mesh.mesh.nodes.iter().zip(&b.mesh.mesh.nodes) {
            assert!((x - y).norm() < 1e-9, "{x:?} {y:?}");
        }
        let labels = [&again[i]].map(|g| g.nodes.iter().map(|&n| deck.node_labels[n as usize]));
        let first = labels.into_iter().flatten().next().unwrap();
        let of = |d: u8| {
            let mut all = deck.initial_velocities.iter();
            let node = |v: &&InitialVelocity| matches!(v.target, Target::Node(n) if deck.node_labels[n as usize] == first);
            all.find(|v| node(v) && v.direction == d).unwrap().value
        };
        // Velocities lie square to the axis.
        let v = Vec3::new(of(1), of(2), of(3));
        assert!(v.norm() > 0.1 && v.dot(&axis).abs() < 1e-10, "{v:?}");
    }
    let own = |b: &&crate::deck::Boundary| b.own_axes;
    assert_eq!(deck.boundaries.iter().filter(own).count(), 2);
}

#[test]
fn what_cannot_be_written_is_named() {
    let deck = calculix("case-a-coarse/A8_d05.inp.gz");
    let found = gears(&deck).unwrap();
    let good = Impact::of(&deck, &found).unwrap();
    let refuse = |change: &dyn Fn(&mut Impact<'_>)| {
        let mut bad = good.clone();
        change(&mut bad);
        write_impact(&mut Vec::new(), &bad).unwrap_err().to_string()
    };
    assert_eq!(
        refuse(&|i| i.pairs = vec![[4, 0]]),
        "gear 1 has no flank 5l; it has 1l, 1r, 2l, 2r, 20l, 20r"
    );
    assert_eq!(
        refuse(&|i| i.penalty = 0.0),
        "the penalty [Pa/m] is 0, but it has to be above 0"
    );
    assert!(refuse(&|i| i.end = 1e-9).contains("at least one step"));
    assert!(refuse(&|i| i.step = f64::NAN).contains("above 0"));
    assert!(refuse(&|i| i.alpha = -0.5).contains("between -1/3 and 0"));
    assert!(refuse(&|i| i.gears[0].centre.x = f64::NAN).contains("position of node 1"));
    let mut mesh = found[0].mesh.clone();
    mesh.flanks[0].nodes.swap(0, 7);
    let e = write(
        &mut Vec::new(),
        &mesh,
        &Material::STEEL,
        &GearDeck::default(),
    )
    .unwrap_err();
    assert!(
        e.to_string().starts_with("flank flank_1l: row 0, column 0"),
        "{e}"
    );
}

/// Meshes made here, spur, helical and rack, of 8 and 20 nodes: written, read, and fit for the elastic
/// preprocessing.
#[test]
fn generated_meshes_come_back_bit_for_bit() {
    use crate::gear_mesh::{GearMeshParams, gear, rack};
    use crate::mesh::ElementKind;
    let mut meshes = Vec::new();
    for (teeth, helix, kind) in [
        (17, 0.0, ElementKind::C3D8I),
        (18, 0.3, ElementKind::C3D8),
        (9, 0.0, ElementKind::C3D20R),
    ] {
        let spec = test_support::gear(teeth, 2e-3, |p| {
            p.profile_shift = 0.5;
            p.helix_angle = helix;
            p.bore_radius = 5e-3;
        });
        let gear = gear(&spec, &layered(kind, 2)).unwrap();
        meshes.push((format!("{teeth} teeth, helix {helix}"), gear));
    }
    for teeth in [4, 5] {
        let spec = test_support::rack(teeth, 2e-3, |_| {});
        let rack = rack(&spec, &GearMeshParams::default()).unwrap();
        meshes.push((format!("rack of {teeth}"), rack));
    }
    for (name, mesh) in &meshes {
        let mut text = Vec::new();
        write(&mut text, mesh, &Material::STEEL, &GearDeck::default()).unwrap();
        let deck = read_text(&text);
        let findings: Vec<String> = crate::gear_deck::check_gtm(&deck)
            .iter()
            .map(ToString::to_string)
            .collect();
        assert!(findings.is_empty(), "{name}: {findings:#?}");
        let again = gears(&deck).unwrap().swap_remove(0);
        assert_eq!((again.centre, again.phase), (Vec3::zeros(), 0.0), "{name}");
        let (a, b) = (mesh, &again.mesh);
        assert!(a.mesh.nodes == b.mesh.nodes, "{name}: nodes");
        assert!(a.mesh.blocks == b.mesh.blocks, "{name}: elements");
        assert_eq!((a.teeth, &a.bore), (b.teeth, &b.bore), "{name}");
        assert!(a.mesh.node_sets == b.mesh.node_sets, "{name}: node sets");
        assert!(a.mesh.face_sets == b.mesh.face_sets, "{name}: face sets");
        assert_eq!(a.flanks.len(), 2 * a.teeth as usize, "{name}");
        assert_eq!(a.flanks.len(), b.flanks.len(), "{name}");
        for f in &a.flanks {
            assert!(
                b.flanks.contains(f),
                "{name}: tooth {} {:?}",
                f.tooth,
                f.side
            );
        }
    }
}

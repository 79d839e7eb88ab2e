use super::*;
use crate::mesh::ElementKind;
use crate::test_support::{calculix, parsed};
use gearbench_models::geometry::{FlankGrid, Side};
use std::io::Read;

fn parameters(case: &str) -> serde_json::Value {
    let path = format!("{}/calculix/{case}/params.json", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn in_deck(gear: &DeckGear, x: Vec3) -> Vec3 {
    placed(gear.shape, [gear.centre, gear.axis], gear.phase, x)
}

/// Rows climb, columns go to +z, positions are those of the nodes, sides are on their side.
fn check_grid(gear: &DeckGear, f: &FlankGrid) {
    let at = |r: usize, c: usize| f.positions[r * f.columns + c];
    assert_eq!(f.nodes.len(), f.rows * f.columns);
    for (n, x) in f.nodes.iter().zip(&f.positions) {
        assert_eq!(gear.mesh.mesh.nodes[*n as usize], *x);
    }
    let height = |x: Vec3| match gear.shape {
        BodyShape::Gear => x.x.hypot(x.y),
        BodyShape::Rack { .. } => -x.x,
    };
    for r in 0..f.rows {
        for c in 0..f.columns {
            if r > 0 {
                assert!(height(at(r, c)) > height(at(r - 1, c)));
            }
            if c > 0 {
                assert!(at(r, c).z > at(r, c - 1).z);
            }
            if let BodyShape::Gear = gear.shape {
                let pitch = std::f64::consts::TAU / f64::from(gear.mesh.teeth);
                let from_centre = turned(at(r, c), -pitch * f64::from(f.tooth));
                assert_eq!(from_centre.y > 0.0, f.side == Side::Left);
                assert!(from_centre.y.abs() < 0.5 * pitch * from_centre.x);
            }
        }
    }
}

#[test]
fn impacts_become_two_gears_where_their_parameters_say() {
    for (case, deck, rows) in [
        ("case-a-fine", "AF8_d05", [21, 21]),
        ("case-c", "C8_d25", [21, 21]),
        ("case-a-coarse", "A8_d05", [9, 9]),
    ] {
        let deck = calculix(&format!("{case}/{deck}.inp.gz"));
        let p = parameters(case);
        let found = gears(&deck).unwrap();
        assert_eq!(found.len(), 2);
        for (i, g) in found.iter().enumerate() {
            let expected = &p[format!("gear{}", i + 1)];
            assert_eq!(g.name, format!("gear{}", i + 1));
            assert_eq!(u64::from(g.mesh.teeth), expected["z"].as_u64().unwrap());
            assert_eq!(
                g.mesh.mesh.nodes.len() as u64,
                expected["nodes"].as_u64().unwrap()
            );
            assert_eq!(
                g.mesh.mesh.element_count() as u64,
                expected["elements"].as_u64().unwrap()
            );
            let angle = expected["tooth1_centre_angle_rad"].as_f64().unwrap();
            assert!(
                wrapped(g.phase - angle).abs() < 2e-11,
                "{case} {i}: {} {angle}",
                g.phase
            );
            let a = if i == 0 {
                0.0
            } else {
                p["pair"]["centre_distance_m"].as_f64().unwrap()
            };
            assert_eq!(g.centre, Vec3::new(a, 0.0, 0.0));
            assert_eq!(g.rigid_body, Some(i));
            assert_eq!(g.material, Material::STEEL);
            for &n in &g.mesh.bore {
                let x = g.mesh.mesh.nodes[n as usize];
                let r = expected["rbore"].as_f64().unwrap();
                assert!((x.x.hypot(x.y) - r).abs() < 1e-11);
            }
            // Teeth 1, 2 and the last are meshed finely and have both flanks.
            let teeth: Vec<u32> = g.mesh.flanks.iter().map(|f| f.tooth).collect();
            assert_eq!(teeth, [0, 0, 1, 1, g.mesh.teeth - 1, g.mesh.teeth - 1]);
            for f in &g.mesh.flanks {
                assert_eq!((f.rows, f.columns), (rows[i], 2));
                check_grid(g, f);
                let tip = expected["r_tip"].as_f64().unwrap();
                let top = f.positions[f.nodes.len() - 1];
                assert!((top.x.hypot(top.y) - tip).abs() < 1e-11);
            }
            for (k, &n) in g.nodes.iter().enumerate() {
                let back = in_deck(g, g.mesh.mesh.nodes[k]);
                assert!((back - deck.nodes[n as usize]).norm() < 1e-16 + 1e-15 * back.norm());
            }
        }
    }
}

#[test]
fn the_rack_stands_on_its_reference_line() {
    let deck = calculix("rack-pinion/R8b_d05.inp.gz");
    let p = parameters("rack-pinion");
    let found = gears(&deck).unwrap();
    let (pinion, rack) = (&found[0], &found[1]);
    assert_eq!(pinion.shape, BodyShape::Gear);
    let angle = p["gear1"]["tooth1_centre_angle_rad"].as_f64().unwrap();
    assert!((pinion.phase - angle).abs() < 2e-11);
    assert_eq!(rack.shape, BodyShape::Rack { direction: 0.0 });
    assert_eq!((rack.mesh.teeth, rack.rigid_body), (5, None));
    let x = p["rack"]["reference_line_x_m"].as_f64().unwrap();
    let y = p["rack"]["tooth0_centre_y_m"].as_f64().unwrap();
    assert!(
        (rack.centre - Vec3::new(x, 0.0, 0.0)).norm() < 2e-12,
        "{}",
        rack.centre
    );
    assert!((rack.phase - y).abs() < 2e-12, "{} {y}", rack.phase);
    // Three left flanks: the deck's teeth 1, 0 and -1 count against y.
    let teeth: Vec<(u32, Side)> = rack.mesh.flanks.iter().map(|f| (f.tooth, f.side)).collect();
    assert_eq!(teeth, [(0, Side::Left), (1, Side::Left), (4, Side::Left)]);
    for f in &rack.mesh.flanks {
        check_grid(rack, f);
        assert_eq!((f.rows, f.columns), (21, 2));
        // Left flanks of a rack face -y.
        let k = if f.tooth == 4 {
            -1.0
        } else {
            f64::from(f.tooth)
        };
        let pitch = std::f64::consts::PI * 2e-3;
        assert!(
            f.positions
                .iter()
                .all(|x| x.y < k * pitch && x.y > (k - 0.5) * pitch)
        );
        let on_line = |x: &&Vec3| x.x.abs() < 0.2e-3;
        for x in f.positions.iter().filter(on_line) {
            let exact = k * pitch - (0.25 * pitch + x.x * 20f64.to_radians().tan());
            assert!((x.y - exact).abs() < 2e-12);
        }
    }
    for &n in &rack.mesh.bore {
        assert!((rack.mesh.mesh.nodes[n as usize].x - 8.5e-3).abs() < 1e-11);
    }
    for (k, &n) in rack.nodes.iter().enumerate() {
        assert!((in_deck(rack, rack.mesh.mesh.nodes[k]) - deck.nodes[n as usize]).norm() < 1e-17);
    }
}

#[test]
fn a_turned_rack_is_the_same_rack() {
    let deck = calculix("rack-pinion/R8b_d05.inp.gz");
    let rack = gears(&deck).unwrap().swap_remove(1);
    let mut other = deck;
    let shift = Vec3::new(3e-3, -1e-3, 2e-3);
    for x in &mut other.nodes {
        *x = turned(*x, 2.1) + shift;
    }
    other.rigid_bodies.clear();
    let again = gears(&other).unwrap().swap_remove(1);
    let BodyShape::Rack { direction } = again.shape else {
        panic!("{:?}", again.shape)
    };
    assert!((direction - 2.1).abs() < 1e-9);
    for (a, b) in rack.mesh.mesh.nodes.iter().zip(&again.mesh.mesh.nodes) {
        assert!((a - b).norm() < 1e-10);
    }
    assert_eq!(rack.mesh.mesh.node_sets, again.mesh.mesh.node_sets);
}

#[test]
fn modal_and_static_decks_become_gears() {
    let modal = [
        ("g1_C3D8", 20, ElementKind::C3D8),
        ("g1_C3D8I", 20, ElementKind::C3D8I),
        ("g1_C3D20R", 20, ElementKind::C3D20R),
        ("g2_C3D8", 30, ElementKind::C3D8),
        ("impA_g1_C3D8", 20, ElementKind::C3D8),
        ("impA_g1_C3D20R", 20, ElementKind::C3D20R),
        ("impA_g2_C3D8I", 30, ElementKind::C3D8I),
    ];
    for (name, teeth, kind) in modal {
        let deck = calculix(&format!("modal/{name}.inp.gz"));
        let g = gears(&deck).unwrap().swap_remove(0);
        assert_eq!(
            (g.mesh.teeth, g.mesh.mesh.kind(), g.phase),
            (teeth, Some(kind), 0.0),
            "{name}"
        );
        assert_eq!(g.centre, Vec3::zeros(), "{name}");
        assert_eq!(g.mesh.mesh.nodes, deck.nodes, "{name}");
        // The C3D20R decks name no flanks: they are found.
        assert_eq!(g.mesh.flanks.len(), 2 * teeth as usize, "{name}");
        assert!(g.mesh.tied.is_empty(), "{name}");
        g.mesh.flanks.iter().for_each(|f| check_grid(&g, f));
    }
    let beam = calculix("modal/beam_C3D20R.inp.gz");
    assert_eq!(beam.element_count(), 80);
    let text = gears(&beam).unwrap_err().to_string();
    assert!(text.contains("or a node set `bore`"), "{text}");
    for name in ["p0_34um_C3D8", "p6_17um_C3D8", "p6_25um_C3D20R"] {
        let deck = calculix(&format!("static/{name}.inp.gz"));
        let g = gears(&deck).unwrap();
        assert_eq!([g[0].mesh.teeth, g[1].mesh.teeth], [20, 30]);
        g.iter()
            .for_each(|g| g.mesh.flanks.iter().for_each(|f| check_grid(g, f)));
    }
}

#[test]
fn names_of_flanks() {
    assert_eq!(flank_name("flank_3l"), Some((3, Side::Left)));
    assert_eq!(flank_name("flank12_30r"), Some((30, Side::Right)));
    assert_eq!(flank_name("flank2_m1l"), Some((-1, Side::Left)));
    for other in [
        "flank",
        "flank_l",
        "flank_3",
        "flanks_3l",
        "flank_3x",
        "flank_99999999999l",
        "flank_+1l",
    ] {
        assert_eq!(flank_name(other), None, "{other}");
    }
    assert!(is_bore_name("bore") && is_bore_name("bore2") && !is_bore_name("borehole"));
}

#[test]
fn one_embedded_reference_reads_too() {
    let a = crate::reference("calculix/case-a-fine").unwrap();
    let deck = crate::deck::read_bytes("AF8_d05.inp.gz", a.deck).unwrap();
    assert_eq!(gears(&deck).unwrap().len(), 2);
    let none = parsed("empty.inp", "");
    assert!(gears(&none).is_err());
}

/// Missing values of a material are completed, and given ones are not changed.
#[test]
fn materials_are_completed() {
    let bytes = include_bytes!("../../../calculix/modal/impA_g1_C3D8.inp.gz");
    let mut whole = String::new();
    flate2::read::GzDecoder::new(&bytes[..])
        .read_to_string(&mut whole)
        .unwrap();
    let other = Material {
        young: 7e10,
        poisson: 0.33,
        density: 2700.0,
    };
    let of = |text: &str, other| {
        let deck = parsed("g.inp", text);
        gears_with(&deck, other).map(|g| g[0].material)
    };
    assert_eq!(of(&whole, Some(other)).unwrap(), Material::STEEL);
    let keyword = |name: &str| {
        let start = whole.find(name).unwrap();
        let end = start + whole[start + 1..].find('*').unwrap() + 1;
        whole[..start].to_owned() + &whole[end..]
    };
    let light = keyword("*DENSITY");
    assert!(of(&light, None).is_err());
    let completed = Material {
        density: 2700.0,
        ..Material::STEEL
    };
    assert_eq!(of(&light, Some(other)).unwrap(), completed);
    let none = keyword("*SOLID SECTION");
    assert!(of(&none, None).is_err());
    assert_eq!(of(&none, Some(other)).unwrap(), other);
}

#[test]
fn instances_make_gears() {
    let folder = format!("{}/fuzz/corpus/deck", env!("CARGO_MANIFEST_DIR"));
    let seed = std::fs::read_to_string(format!("{folder}/gear.inp")).unwrap();
    let read = |text: &str| parsed("a.inp", text);
    let plain = read(&seed);
    let middle = seed.find("*MATERIAL").unwrap();
    let section = seed.find("*SOLID SECTION").unwrap();
    let end = section + seed[section..].find("\n").unwrap() + 1;
    let (mesh, rest) = (
        &seed[seed.find("*NODE").unwrap()..middle],
        &seed[middle..section],
    );
    let text = format!(
        "*PART, NAME=wheel\n{mesh}{}*END PART\n*ASSEMBLY, NAME=a\n*INSTANCE, NAME=w-1, PART=wheel\n*END INSTANCE\n\
         *INSTANCE, NAME=w-2, PART=wheel\n0.3, 0, 0\n*END INSTANCE\n*END ASSEMBLY\n{rest}",
        &seed[section..end]
    );
    let pair = gears(&read(&text)).unwrap();
    let [one] = gears(&plain)
        .unwrap()
        .try_into()
        .unwrap_or_else(|_| panic!());
    assert_eq!(pair.len(), 2);
    assert_eq!(pair[0].mesh, one.mesh);
    assert!((pair[1].centre - Vec3::new(0.3, 0.0, 0.0) - one.centre).norm() < 1e-12);
}

/// The seeds of the fuzz target that contain gears.
#[test]
fn fuzz_seeds_have_their_gears() {
    for (name, count, is_fit) in [
        ("gear.inp", 1, true),
        ("pair.inp", 2, false),
        ("rack.inp", 1, true),
    ] {
        let folder = format!("{}/fuzz/corpus/deck", env!("CARGO_MANIFEST_DIR"));
        let deck = crate::deck::read(format!("{folder}/{name}")).unwrap();
        assert_eq!(gears(&deck).unwrap().len(), count, "{name}");
        assert!(
            !is_fit || crate::gear_deck::check_gtm(&deck).is_empty(),
            "{name}"
        );
    }
}

//! Archives as Ansys writes them are read, own ones come back, and others are refused with their line.

use super::writer;
use crate::{Deck, DeckError, read_bytes};
use gearbench_solid_fe::Material;
use gearbench_solid_fe::mesh::{ElementKind, brick};

fn read(text: &str) -> Result<Deck, DeckError> {
    read_bytes("gear.cdb", text.as_bytes())
}

#[test]
fn meshes_come_back_bit_for_bit() {
    for kind in ElementKind::ALL {
        let mut mesh = brick(kind, [2, 3, 1], [0.3, 0.2, 0.07]);
        mesh.node_sets.insert("some".to_owned(), vec![0, 3, 4]);
        let mut text = Vec::new();
        writer::write(&mut text, &mesh, &Material::STEEL, "a box\nof steel").unwrap();
        let deck = read(std::str::from_utf8(&text).unwrap()).unwrap();
        assert_eq!(deck.mesh().nodes, mesh.nodes, "{kind:?}");
        assert_eq!(deck.mesh().blocks, mesh.blocks, "{kind:?}");
        assert_eq!(deck.node_sets["some"], [0, 3, 4]);
        assert_eq!(deck.material("material 1"), Some(Material::STEEL));
    }
}

/// Wedges and tetrahedra are elements with repeated nodes there.
#[test]
fn degenerate_elements_keep_their_shape() {
    for kind in ElementKind::ALL {
        let nodes: Vec<u32> = (0..kind.nodes() as u32).collect();
        let (number, option, order) = writer::kind(kind);
        let there: Vec<u32> = order.iter().map(|i| nodes[*i] + 1).collect();
        let (found, back) = super::solid(number, option, &there).unwrap();
        assert_eq!(found, kind);
        let here: Vec<u32> = back.iter().map(|i| there[*i] - 1).collect();
        assert_eq!(here, nodes, "{kind:?}");
    }
}

/// A cube as `CDWRITE` writes it: other commands, contact elements, ranges in components, a table of properties.
const CUBE: &str = "\
/COM,ANSYS RELEASE 2021 R2
/PREP7
/NOPR
*IF,_CDRDOFF,EQ,1,THEN
_CDRDOFF= 
*ENDIF
DOF,DELETE
ET,        1,185
KEYOP,     1,      2,        3
ET,        2,SURF154
NBLOCK,6,SOLID,         8,         8
(3i9,6e21.13e3)
        1        0        0
        2        0        0 1.0000000000000E+001
        3        0        0 1.0000000000000E+001 1.0000000000000E+001
        4        0        0 0.0000000000000E+000 1.0000000000000E+001
        5        0        0 0.0000000000000E+000 0.0000000000000E+000 1.0000000000000E+001
        6        0        0 1.0000000000000E+001 0.0000000000000E+000 1.0000000000000E+001
        7        0        0 1.0000000000000E+001 1.0000000000000E+001 1.0000000000000E+001
        8        0        0 0.0000000000000E+000 1.0000000000000E+001 1.0000000000000E+001
N,UNBL,LOC,       -1,
EBLOCK,19,SOLID,         2,         2
(19i9)
        1        1        1        1        0        0        0        0        8        0        1        1        2        3        4        5        6        7        8
        1        2        1        1        0        0        0        0        4        0        2        1        2        3        4
       -1
CMBLOCK,BORE    ,NODE,       3  ! users node component definition
(8i10)
         1         3        -5
MPTEMP,R5.0, 1, 1,  0.00000000    ,
MPDATA,R5.0, 1,EX  ,       1, 1,  210000.000    ,
MPTEMP,R5.0, 1, 1,  0.00000000    ,
MPDATA,R5.0, 1,PRXY,       1, 1, 0.300000000    ,
MPDATA,R5.0, 1,DENS,       1, 1, 7.850000000E-09,
/GO
FINISH
";

#[test]
fn an_archive_of_ansys_is_read() {
    let deck = read(CUBE).unwrap();
    assert_eq!((deck.nodes.len(), deck.element_count()), (8, 1));
    assert_eq!(deck.blocks[0].kind, ElementKind::C3D8I);
    assert_eq!(deck.units.name, "mm-t-s");
    assert!((deck.nodes[6].x - 0.01).abs() < 1e-18);
    assert_eq!(deck.node_sets["bore"], [0, 2, 3, 4]);
    let steel = deck.material("material 1").unwrap();
    assert!((steel.young / 2.1e11 - 1.0).abs() < 1e-12 && (steel.density - 7850.0).abs() < 1e-9);
    let told = deck.told().join("\n");
    assert!(
        told.contains("1 elements of type 154 are no solids"),
        "{told}"
    );
    assert!(told.contains("/GO"), "{told}");
}

#[test]
fn what_is_wrong_is_named_with_its_line() {
    let cases: [(&str, &str, &[&str]); 13] = [
        (
            "(3i9,6e21.13e3)",
            "(3x9)",
            &["gear.cdb:12", "NBLOCK", "(19i9)"],
        ),
        (
            "        4        0        0 0.0",
            "        3        0        0 0.0",
            &["gear.cdb:16", "each node once", "node 3"],
        ),
        (
            "        4        0        0 0.0",
            "        4        0        0 x.0",
            &["gear.cdb:16", "a finite number"],
        ),
        (
            "ET,        1,185",
            "ET,        3,185",
            &["EBLOCK", "an element type of ET", "type 1"],
        ),
        (
            "ET,        1,185",
            "ET,        1,",
            &["gear.cdb:8", "ET", "a whole number"],
        ),
        (
            "        7        8\n",
            "        7        9\n",
            &["gear.cdb:24", "a node of NBLOCK", "node 9"],
        ),
        (
            "        4        5        6",
            "        4        5        5",
            &[
                "gear.cdb:24",
                "hexahedron, wedge or tetrahedron",
                "pyramids",
            ],
        ),
        (
            "       -1\nCMBLOCK",
            "CMBLOCK",
            &["EBLOCK", "a whole number"],
        ),
        (
            "         3        -5",
            "         3        -2",
            &["gear.cdb:29", "CMBLOCK", "the end of a range"],
        ),
        (
            "210000.000    ,",
            "210000.000    , 2.,",
            &["gear.cdb:31", "not a function of temperature"],
        ),
        ("EX  ", "EY  ", &["gear.cdb:31", "isotropic"]),
        (
            "/GO",
            "CE,1,0,1,UX,1",
            &["gear.cdb:35", "connected by their elements", "CE,1"],
        ),
        (
            "/GO",
            "TB,BISO,1\nTBDATA,1,200",
            &["gear.cdb:35", "linear elasticity", "TB,BISO,1"],
        ),
    ];
    for (old, new, words) in cases {
        let text = CUBE.replacen(old, new, 1);
        assert_ne!(text, CUBE, "{old}");
        let e = read(&text).unwrap_err().to_string();
        assert!(words.iter().all(|w| e.contains(w)), "{new}: {e}");
    }
    for end in [
        "        5        0",
        "        1        2        1        1",
        "         1         3",
    ] {
        let cut = CUBE.find(end).unwrap();
        let e = read(&CUBE[..cut]).unwrap_err().to_string();
        assert!(e.contains("the end of the file"), "{e}");
    }
}

#[test]
fn mutated_archives_are_read_or_refused() {
    let mut read_count = 0;
    let bytes = CUBE.as_bytes();
    let mut state = 7_u64;
    let mut below = |n: usize| {
        state += 1;
        (gearbench_solid_fe::hash::spread(state) % n as u64) as usize
    };
    for _ in 0..2000 {
        let mut changed = bytes.to_vec();
        for _ in 0..=below(3) {
            let at = below(changed.len());
            match below(3) {
                0 => changed[at] = b"0123456789-,.(iE\n "[below(18)],
                1 => changed.truncate(at.max(1)),
                _ => {
                    changed.splice(at..at, b"99999999999".iter().copied());
                }
            }
        }
        match read_bytes("gear.cdb", &changed) {
            Ok(_) => read_count += 1,
            Err(e) => assert!(!e.expected.is_empty() && !e.found.is_empty(), "{e}"),
        }
    }
    assert!((1..2000).contains(&read_count), "{read_count}");
}

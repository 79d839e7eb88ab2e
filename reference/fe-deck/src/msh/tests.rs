use crate::Units;
use crate::{Deck, DeckError, read_bytes, read_str, read_str_in};
use gearbench_solid_fe::Vec3;
use gearbench_solid_fe::mesh::{ElementKind, quality};

fn corpus(name: &str) -> String {
    let folder = format!("{}/../fuzz/corpus", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(format!("{folder}/{name}")).unwrap()
}

fn read(name: &str) -> Deck {
    let found = read_str_in(
        name,
        &corpus(name),
        Some(Units::SI),
        &mut |_| unreachable!(),
    );
    found.unwrap_or_else(|e| panic!("{e}"))
}

/// Elements by the positions of their nodes, in an order that does not depend on labels.
fn elements(deck: &Deck) -> Vec<Vec<[i64; 3]>> {
    let round = |x: Vec3| [x.x, x.y, x.z].map(|c| (c * 1e9).round() as i64);
    let mut all: Vec<Vec<[i64; 3]>> = (0..deck.element_count() as u32)
        .map(|e| {
            deck.element(e)
                .iter()
                .map(|&n| round(deck.nodes[n as usize]))
                .collect()
        })
        .collect();
    all.sort();
    all
}

/// Gmsh wrote each mesh twice, as `.msh` and as a deck: the order of the nodes of an element is the same then.
#[test]
fn nodes_have_the_order_that_gmsh_gives_decks() {
    for (name, kind) in [
        ("tet10", ElementKind::C3D10),
        ("wedge15", ElementKind::C3D15),
        ("hex20", ElementKind::C3D20),
    ] {
        let mesh = read(&format!("msh/{name}.msh"));
        let deck = read(&format!("deck/gmsh_{name}.inp"));
        assert_eq!(mesh.mesh().kind(), Some(kind));
        assert_eq!(elements(&mesh), elements(&deck), "{name}");
        assert_eq!(
            mesh.node_sets["low end"].len(),
            deck.node_sets["low_end"].len()
        );
        assert_eq!(
            mesh.element_sets["body"].len(),
            deck.element_sets["body"].len()
        );
        let q = quality(&mesh.mesh());
        assert!((q.volume - 3.0).abs() < 1e-12, "{name} {}", q.volume);
        for e in 0..mesh.element_count() as u32 {
            let nodes = mesh.element(e);
            for (i, edge) in kind.edges().iter().enumerate() {
                let [a, b] = edge.map(|c| mesh.nodes[nodes[c] as usize]);
                let middle = mesh.nodes[nodes[kind.corners() + i] as usize];
                assert!((middle - 0.5 * (a + b)).norm() < 1e-12, "{name} {edge:?}");
            }
        }
    }
}

#[test]
fn version_two_is_the_same_mesh() {
    let (new, old) = (read("msh/tet10.msh"), read("msh/tet10_22.msh"));
    assert_eq!(elements(&new), elements(&old));
    assert_eq!(
        new.node_sets["low end"].len(),
        old.node_sets["low end"].len()
    );
    assert_eq!(old.element_sets.keys().collect::<Vec<_>>(), ["body"]);
}

#[test]
fn entities_are_sets_where_there_are_no_groups() {
    let deck = read("msh/wedge6.msh");
    assert_eq!(deck.mesh().kind(), Some(ElementKind::C3D6));
    assert_eq!(deck.element_sets.keys().collect::<Vec<_>>(), ["volume1"]);
    assert_eq!(deck.node_sets["point1"].len(), 1);
    assert!(
        deck.node_sets["surface1"]
            .iter()
            .all(|&n| deck.nodes[n as usize].z == 0.0)
    );
    assert!(
        deck.told().iter().any(|l| l.contains("triangles")),
        "{:?}",
        deck.told()
    );
    let guessed = read_str("a.msh", &corpus("msh/wedge6.msh"), &mut |_| unreachable!()).unwrap();
    assert!(
        guessed.units_from.starts_with("an assumption"),
        "{}",
        guessed.units_from
    );
}

fn refused(text: &str) -> DeckError {
    read_str("a.msh", text, &mut |_| unreachable!()).unwrap_err()
}

#[test]
fn refusals_say_where_what_and_how() {
    let good = corpus("msh/tet4.msh");
    let solid = |line: &str| {
        format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n$Elements\n1\n{line}\n$EndElements\n"
        )
    };
    assert!(read_str("a.msh", &solid("1 4 0 1 2 3 4"), &mut |_| unreachable!()).is_ok());
    for (text, words) in [
        (
            good.replace("4.1 0 8", "4.1 1 8"),
            "a.msh:2: $MeshFormat: expected the number 1 as four bytes, found [24, 45, 6e, 64]; was the binary file transferred",
        ),
        (
            good.replace("4.1 0 8", "4.1 2 8"),
            "expected 0 for text, 1 for binary, found 2",
        ),
        (
            good.replace("4.1 0 8", "4.1 1 4"),
            "expected numbers of 8 bytes, found 4",
        ),
        (
            good.replace("4.1 0 8", "3 0 8"),
            "expected version 4.1 or 2.2, found 3",
        ),
        (
            good.replace("$EndNodes", "$EndNode"),
            "expected $EndNodes, found `$EndNode`",
        ),
        (
            good[..good[..good.len() / 2].rfind('\n').unwrap()].to_owned(),
            "found the end of the file",
        ),
        (
            solid("1 7 0 1 2 3 4 5"),
            "a.msh:13: $Elements: expected tetrahedra, wedges and hexahedra of the first or second order, found type 7",
        ),
        (
            solid("1 4 0 1 2 3 9"),
            "expected a node of $Nodes, found tag 9",
        ),
        (solid("1 4 0 1 2 3"), "expected the tag of a node, found ``"),
        (
            solid("1 4 0 2 1 3 4"),
            "element 1 with the Jacobian -1.000e0",
        ),
        (solid("x"), "found `x`"),
        (
            solid("1 4 0 1 2 3 4").replace("2 1 0 0", "1 1 0 0"),
            "expected each node once, found tag 1 again",
        ),
        (
            solid("1 4 0 1 2 3 4").replace("2 1 0 0", "2 nan 0 0"),
            "expected a finite number",
        ),
        (
            solid("1 4 0 1 2 3 4").replace("$Nodes\n4", "$Nodes\n999999999999"),
            "is the file whole?",
        ),
        (
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n1 2 3\n".to_owned(),
            "expected a section such as $Nodes",
        ),
    ] {
        let e = refused(&text);
        let shown = e.to_string();
        assert!(shown.contains(words), "{words}\n{shown}");
        assert!(e.line > 0);
    }
}

/// Converts a text mesh to a binary one by the description of the format, without code of the reader.
fn as_binary(text: &str, high_first: bool) -> Vec<u8> {
    let mut out = Vec::new();
    let mut old = false;
    let mut lines = text.lines();
    let raw = |out: &mut Vec<u8>, mut bytes: Vec<u8>| {
        if high_first {
            bytes.reverse();
        }
        out.extend(bytes);
    };
    let int = |out: &mut Vec<u8>, w: &str| raw(out, w.parse::<i32>().unwrap().to_le_bytes().into());
    let size =
        |out: &mut Vec<u8>, w: &str| raw(out, w.parse::<u64>().unwrap().to_le_bytes().into());
    let double =
        |out: &mut Vec<u8>, w: &str| raw(out, w.parse::<f64>().unwrap().to_le_bytes().into());
    while let Some(line) = lines.next() {
        out.extend(format!("{line}\n").bytes());
        let mut row = || -> Vec<&str> { lines.next().unwrap().split_whitespace().collect() };
        match line {
            "$MeshFormat" => {
                let format = row();
                old = format[0] == "2.2";
                out.extend(format!("{} 1 8\n", format[0]).bytes());
                int(&mut out, "1");
            }
            "$Entities" => {
                let counts = row();
                counts.iter().for_each(|c| size(&mut out, c));
                for (dimension, count) in counts.iter().enumerate() {
                    for _ in 0..count.parse().unwrap() {
                        let words = row();
                        int(&mut out, words[0]);
                        let corners = if dimension == 0 { 3 } else { 6 };
                        words[1..=corners].iter().for_each(|w| double(&mut out, w));
                        let mut rest = &words[corners + 1..];
                        while let [count, more @ ..] = rest {
                            size(&mut out, count);
                            let count: usize = count.parse().unwrap();
                            more[..count].iter().for_each(|w| int(&mut out, w));
                            rest = &more[count..];
                        }
                    }
                }
            }
            "$Nodes" if old => {
                let count = row();
                out.extend(format!("{}\n", count[0]).bytes());
                for _ in 0..count[0].parse().unwrap() {
                    let words = row();
                    int(&mut out, words[0]);
                    words[1..].iter().for_each(|w| double(&mut out, w));
                }
            }
            "$Elements" if old => {
                let count = row();
                out.extend(format!("{}\n", count[0]).bytes());
                for _ in 0..count[0].parse().unwrap() {
                    let words = row();
                    // A run of its own for each: type, one element, count of tags.
                    [words[1], "1", words[2], words[0]]
                        .iter()
                        .for_each(|w| int(&mut out, w));
                    words[3..].iter().for_each(|w| int(&mut out, w));
                }
            }
            "$Nodes" | "$Elements" => {
                let counts = row();
                counts.iter().for_each(|c| size(&mut out, c));
                for _ in 0..counts[0].parse().unwrap() {
                    let block = row();
                    block[..3].iter().for_each(|w| int(&mut out, w));
                    size(&mut out, block[3]);
                    let count: usize = block[3].parse().unwrap();
                    let rows: Vec<Vec<&str>> = (0..count).map(|_| row()).collect();
                    rows.iter().flatten().for_each(|w| size(&mut out, w));
                    if line == "$Nodes" {
                        let places: Vec<Vec<&str>> = (0..count).map(|_| row()).collect();
                        places.iter().flatten().for_each(|w| double(&mut out, w));
                    }
                }
            }
            _ => continue,
        }
        out.push(b'\n');
    }
    out
}

#[test]
fn binary_meshes_are_the_same_as_text() {
    for name in ["tet10", "tet10_22", "tet4", "wedge15", "wedge6", "hex20"] {
        let text = corpus(&format!("msh/{name}.msh"));
        let wanted = read_bytes("a.msh", text.as_bytes()).unwrap();
        for high_first in [false, true] {
            let binary = as_binary(&text, high_first);
            assert_ne!(binary, text.as_bytes());
            let found = read_bytes("a.msh", &binary).unwrap_or_else(|e| panic!("{name}: {e}"));
            assert_eq!(found.nodes, wanted.nodes, "{name}");
            assert_eq!(found.node_labels, wanted.node_labels, "{name}");
            assert_eq!(found.mesh().blocks, wanted.mesh().blocks, "{name}");
            assert_eq!(found.element_labels, wanted.element_labels, "{name}");
            assert_eq!(found.node_sets, wanted.node_sets, "{name}");
            assert_eq!(found.element_sets, wanted.element_sets, "{name}");
        }
    }
}

/// Gmsh 4.15 wrote the same body binary and, in the same order, as text.
#[test]
fn binary_meshes_of_gmsh_are_read() {
    for version in ["41", "22"] {
        let bytes = |kind: &str| {
            let folder = env!("CARGO_MANIFEST_DIR");
            std::fs::read(format!(
                "{folder}/../fuzz/corpus/msh/gmsh_{kind}{version}.msh"
            ))
            .unwrap()
        };
        let read = |kind: &str| read_bytes("a.msh", &bytes(kind)).unwrap_or_else(|e| panic!("{e}"));
        let (text, binary) = (read("text"), read("binary"));
        assert_eq!(binary.mesh().kind_names(), "C3D10");
        let q = quality(&binary.mesh());
        assert!((q.volume - 6.0).abs() < 1e-12, "{}", q.volume);
        assert_eq!(elements(&text), elements(&binary));
        assert_eq!(text.node_sets, binary.node_sets);
        assert_eq!(text.element_sets.keys().collect::<Vec<_>>(), ["body"]);
        // Wherever it ends it is refused, with the place in the file.
        let whole = bytes("binary");
        for end in (0..whole.len() - 14).step_by(7) {
            let e = read_bytes("a.msh", &whole[..end]);
            if let Err(e) = e {
                assert!(e.to_string().starts_with("a.msh"), "{e}");
            } else {
                // Only between sections, with no elements yet.
                assert_eq!(e.unwrap().element_count(), 0, "{end}");
            }
        }
        let elements = whole.windows(9).position(|w| w == b"$Elements").unwrap();
        let e = read_bytes("a.msh", &whole[..elements + 60])
            .unwrap_err()
            .to_string();
        assert!(
            e.contains("$Elements, byte ") && e.contains("is the file whole?"),
            "{e}"
        );
    }
}

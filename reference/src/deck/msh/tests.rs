use crate::deck::Units;
use crate::deck::{Deck, DeckError, read_str, read_str_in};
use crate::mesh::{ElementKind, quality};
use gearbench_models::Vec3;

fn corpus(name: &str) -> String {
    let folder = format!("{}/fuzz/corpus", env!("CARGO_MANIFEST_DIR"));
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
        guessed.units_from.starts_with("a guess"),
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
            "a.msh:2: $MeshFormat: expected a mesh as text, found a binary one; save it as text",
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

/// The seeds of the fuzz target are read.
#[test]
fn fuzz_seeds_are_read() {
    let folder = format!("{}/fuzz/corpus/msh", env!("CARGO_MANIFEST_DIR"));
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let text = String::from_utf8_lossy(&std::fs::read(&path).unwrap()).into_owned();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let found = read_str(&name, &text, &mut |_| unreachable!());
        // What the fuzzer found is there to be replayed; the meshes of Gmsh are sound.
        assert!(found.is_ok() || name.starts_with("found"), "{name}");
        count += 1;
    }
    assert!(count >= 5);
}

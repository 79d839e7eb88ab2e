//! Membership of nodes in the sets of a gear, as fields for pictures.

use crate::mesh::Mesh;

/// Returns node fields of a gear for [`write`](crate::mesh::vtu::write()): `bore` is 1 on the bore; `flank` is the number of the tooth from 1 on
/// its left flank and minus that on its right one; `cut` is -1 and 1 on the cuts of a sector; 0 elsewhere.
pub fn membership(mesh: &Mesh) -> [(&'static str, Vec<i32>); 3] {
    let mut found = ["bore", "flank", "cut"].map(|name| (name, vec![0; mesh.nodes.len()]));
    for (name, nodes) in &mesh.node_sets {
        let flank = || {
            let (number, side) = name
                .strip_prefix("flank_")?
                .split_at_checked(name.len() - 7)?;
            let number: i32 = number.parse().ok()?;
            Some(if side == "r" { -number } else { number })
        };
        let (which, value) = match name.as_str() {
            "bore" => (0, 1),
            "cut_low" => (2, -1),
            "cut_high" => (2, 1),
            _ => match flank() {
                Some(value) => (1, value),
                None => continue,
            },
        };
        for &n in nodes {
            found[which].1[n as usize] = value;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear_mesh::sector;
    use crate::mesh::ElementKind;
    use crate::test_support::{gear, layered};

    #[test]
    fn fields_name_the_sets_of_each_node() {
        let g = gear(20, 4e-3, |p| p.bore_radius = 15e-3);
        for kind in [ElementKind::C3D8, ElementKind::C3D20] {
            let mesh = sector(&g, &layered(kind, 4)).unwrap().mesh;
            let [(_, bore), (_, flank), (_, cut)] = membership(&mesh);
            for i in 0..mesh.nodes.len() {
                let on = |name: &str| mesh.node_sets[name].contains(&(i as u32));
                assert_eq!(bore[i] == 1, on("bore"));
                assert_eq!(
                    (flank[i] == 1, flank[i] == -1),
                    (on("flank_1l"), on("flank_1r"))
                );
                assert_eq!((cut[i] == -1, cut[i] == 1), (on("cut_low"), on("cut_high")));
            }
        }
    }
}

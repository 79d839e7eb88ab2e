//! Gears come back from archives of Ansys.

use super::{GearDeck, ModalProgram, ModalRun, gears, write};
use crate::deck::read_bytes;
use crate::gear_mesh::{GearMesh, gear};
use crate::mesh::ElementKind;
use crate::test_support::{self, layered};
use gearbench_models::stiffness::Material;

fn archive(mesh: &GearMesh) -> String {
    let mut text = Vec::new();
    let options = GearDeck {
        title: "a gear\ngearbench mesh gear --modal ansys".to_owned(),
        modal: Some(ModalRun {
            program: ModalProgram::Ansys,
            modes: 12,
            stem: "gear".to_owned(),
        }),
    };
    write(&mut text, mesh, &Material::STEEL, &options).unwrap();
    String::from_utf8(text).unwrap()
}

#[test]
fn gears_come_back_bit_for_bit() {
    let spec = test_support::gear(17, 2e-3, |p| {
        p.profile_shift = 0.5;
        p.helix_angle = 0.2;
        p.bore_radius = 5e-3;
    });
    for kind in ElementKind::HEXAHEDRA {
        let own = gear(&spec, &layered(kind, 2)).unwrap();
        let text = archive(&own);
        assert!(text.contains("HBMAT,gear_stiff,hb,,ASCII,STIFF,NO,YES"));
        let deck = read_bytes("gear.cdb", text.as_bytes()).unwrap();
        let again = gears(&deck).unwrap().swap_remove(0);
        assert_eq!(again.material, Material::STEEL);
        assert_eq!(again.rotation(), nalgebra::Matrix3::identity());
        let (a, b) = (&own, &again.mesh);
        assert!(
            a.mesh.nodes == b.mesh.nodes && a.mesh.blocks == b.mesh.blocks,
            "{kind:?}"
        );
        assert_eq!((a.teeth, &a.bore), (b.teeth, &b.bore));
        assert_eq!(a.flanks.len(), b.flanks.len());
        assert!(a.flanks.iter().all(|f| b.flanks.contains(f)), "{kind:?}");
    }
}

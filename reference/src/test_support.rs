//! Bodies, meshes and numbers that several tests share.

use crate::assembly::assemble;
use crate::assembly::tie::{HubMotion, MassKind, Reduced, Tie};
use crate::deck::{self, Deck, ElementBlock, Place};
use crate::gear_mesh::{GearMesh, GearMeshParams, Tooth};
use crate::mesh::{ElementKind, Mesh};
use gearbench_models::Vec3;
use gearbench_models::gear::table::GearContext;
use gearbench_models::geometry::{Gear, GearParams, Rack, RackParams};
use gearbench_models::kinematics::{Hub, Placement};
use gearbench_models::spec::{Body, ModelSpec, Mount};
use gearbench_models::stiffness::Material;

/// A deck of the stored references.
pub(crate) fn calculix(name: &str) -> Deck {
    deck::read(format!("{}/calculix/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

/// A deck from its text, without includes.
pub(crate) fn parsed(name: &str, text: &str) -> Deck {
    let read = deck::read_str(name, text, &mut |_| {
        Err(std::io::Error::other("no includes"))
    });
    read.unwrap_or_else(|e| panic!("{e}"))
}

/// A deck without sets.
pub(crate) fn bare(mesh: &Mesh) -> Deck {
    let kind = mesh.kind().unwrap();
    let mut deck = Deck::default();
    deck.name = "bare.inp".to_owned();
    deck.nodes.clone_from(&mesh.nodes);
    deck.node_labels = (1..=mesh.nodes.len() as u32).map(Into::into).collect();
    deck.blocks.push(ElementBlock {
        kind,
        set: None,
        first: 0,
        connectivity: mesh.connectivity().collect(),
        place: Place {
            file: "bare.inp".into(),
            line: 1,
        },
    });
    deck.element_labels = (1..=mesh.element_count() as u32).map(Into::into).collect();
    deck
}

/// A gear of the default toothing, changed where a test needs it.
pub(crate) fn gear(teeth: u32, module: f64, change: impl FnOnce(&mut GearParams)) -> Gear {
    let mut params = GearParams {
        teeth,
        module,
        ..GearParams::default()
    };
    change(&mut params);
    Gear::new(params).unwrap()
}

/// Builds a rack from its number of teeth and module.
pub(crate) fn rack(teeth: u32, module: f64, change: impl FnOnce(&mut RackParams)) -> Rack {
    let mut params = RackParams {
        teeth,
        module,
        ..RackParams::default()
    };
    change(&mut params);
    Rack::new(params).unwrap()
}

/// Builds a thick-walled gear with stub teeth: a few hundred unknowns.
pub(crate) fn stub(teeth: u32, helix_angle: f64) -> Gear {
    gear(teeth, 4e-3, |p| {
        p.helix_angle = helix_angle;
        p.pressure_angle = 0.5;
        p.profile_shift = 0.35;
        p.addendum = 0.7;
        p.dedendum = 1.0;
        p.tip_radius = 0.15;
        p.bore_radius = 0.25 * 4e-3 * f64::from(teeth);
    })
}

/// Returns the parameters of a coarse mesh, for tests that do not depend on the number of elements.
pub(crate) fn coarse(rim: usize, width: usize) -> GearMeshParams {
    GearMeshParams {
        kind: ElementKind::C3D8,
        tooth: Tooth::coarse(),
        layers: 1,
        rim,
        width,
        ..GearMeshParams::default()
    }
}

/// The default mesh of a kind of element, with so many layers over the width.
pub(crate) fn layered(kind: ElementKind, width: usize) -> GearMeshParams {
    GearMeshParams {
        kind,
        width,
        ..GearMeshParams::default()
    }
}

/// The default mesh with other counts along a flank, of the rim and over the width.
pub(crate) fn counted(flank: usize, rim: usize, width: usize) -> GearMeshParams {
    let mut params = layered(ElementKind::C3D8I, width);
    (params.tooth.flank, params.rim) = (flank, rim);
    params
}

/// A hub away from the origin, with unit inertia.
pub(crate) fn hub(mount: Mount, slide: Option<Vec3>) -> Hub {
    Hub::new(mount, Vec3::new(0.1, -0.2, 0.0), slide, 1.0)
}

/// Returns the context of a steel gear without meshes.
pub(crate) fn context<'a>(body: &'a Body, hub: &'a Hub, model: &'a ModelSpec) -> GearContext<'a> {
    GearContext {
        name: "pinion",
        body,
        material: Material::STEEL,
        hub,
        added_inertia: 0.0,
        placement: Placement::new(hub, 0.1),
        effective_radius: 1.0,
        meshes: &[],
        slides: false,
        lines: None,
        speed: 0.0,
        time_of_first_teeth: f64::INFINITY,
        model,
    }
}

/// Returns the largest absolute value.
pub(crate) fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |m, x| m.max(x.abs()))
}

/// A mesh on its hub: the tie, stiffness and consistent mass.
pub(crate) fn tied(gear: &GearMesh, motions: &[HubMotion], added: &[f64]) -> (Tie, Reduced) {
    let assembly = assemble(&gear.mesh, &Material::STEEL).unwrap();
    let tie = Tie::new(&gear.mesh.nodes, &gear.bore, motions);
    let reduced = tie.reduce(&assembly, added, MassKind::Consistent);
    (tie, reduced)
}

/// Numbers that look random and repeat.
pub(crate) fn noise(n: usize, size: f64) -> Vec<f64> {
    (0..n)
        .map(|i| size * ((i as f64 * 12.9898).sin() * 43_758.545_3).fract())
        .collect()
}

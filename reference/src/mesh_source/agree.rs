//! Comparison of a recognised mesh with the gear of the scene.

use crate::deck::Deck;
use crate::gear_deck::DeckGear;
use crate::gear_mesh::GearMesh;
use crate::recognise::{RecognisedBody, RecognisedGear, RecognisedRack};
use gearbench_models::geometry::{Gear, Rack};
use gearbench_models::spec::Body as Toothing;

/// How far lengths of a scene's gear may be from those of its mesh, over the transverse module.
const NEAR: f64 = 0.1;
/// How far its base helix angle, and a rack's pressure angle, may be [rad].
const NEAR_ANGLE: f64 = 0.01;

/// A difference between a recognised gear and the scene.
pub(super) struct Disagreement {
    what: &'static str,
    /// Keys of the scene's gear that define the quantity.
    keys: &'static str,
    shown: String,
    said: String,
    /// Ratio of the length in the mesh to that in the scene, if it is a length.
    ratio: f64,
}

impl Disagreement {
    /// Both figures and the way out.
    pub(super) fn told(&self, gear: &str, source: &str, deck: &Deck) -> (String, String) {
        let Disagreement {
            what,
            keys,
            shown,
            said,
            ..
        } = self;
        let message = format!(
            "the {what} of gear `{gear}` is {said}, but the flanks of \"{source}\" show {shown}"
        );
        let help = match self.ratio {
            // A factor between units of length.
            r if !(0.02..50.0).contains(&r) => format!(
                "the file was read in {} ({}): give its units as `units = \"mm-t-s\"`, \"m-kg-s\" or another",
                deck.units.name, deck.units_from
            ),
            _ => format!(
                "give the gear the data of the mesh by {keys} (`gearbench reduce` prints them), or use the mesh of this gear"
            ),
        };
        (message, help)
    }
}

/// Returns the first difference between a recognised body and the scene. Small differences are accepted: contact is
/// between the flanks of the mesh, loads and mesh layout are those of the gear of the scene.
pub(super) fn disagreement(gear: &DeckGear, body: &Toothing) -> Option<Disagreement> {
    match (&gear.found, body) {
        (Some(RecognisedBody::Gear(found)), Toothing::Gear(said)) => of_gear(found, said),
        (Some(RecognisedBody::Rack(found)), Toothing::Rack(said)) => of_rack(found, said),
        (Some(_), _) => None,
        (None, said) => of_named_sets(&gear.mesh, said),
    }
}

/// The first difference between a gear of the scene and a mesh whose flanks are named by sets, so that their profile is
/// not recognised: face width and bore radius.
fn of_named_sets(mesh: &GearMesh, body: &Toothing) -> Option<Disagreement> {
    let across = mesh.flanks.iter().flat_map(|f| &f.positions).map(|x| x.z);
    let (low, high) = across.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| {
        (low.min(z), high.max(z))
    });
    if low >= high {
        return None;
    }
    let (said, module) = match body {
        Toothing::Gear(g) => (g.face_width(), g.transverse_module()),
        Toothing::Rack(r) => (r.face_width(), r.pitch() / std::f64::consts::PI),
    };
    let mut lengths: Vec<Pair> = vec![face_width(high - low, said)];
    if let Toothing::Gear(g) = body
        && g.params().bore_radius > 0.0
        && !mesh.bore.is_empty()
    {
        let radius = |n: &u32| mesh.mesh.nodes[*n as usize].xy().norm();
        let shown = mesh.bore.iter().map(radius).fold(0.0, f64::max);
        lengths.push(bore_radius(shown, g.params().bore_radius));
    }
    first_off(&lengths, module)
}

/// A quantity, the keys that define it, the value of the mesh and that of the scene.
type Pair = (&'static str, &'static str, f64, f64);

fn face_width(shown: f64, said: f64) -> Pair {
    ("face width", "`face_width_m`", shown, said)
}

fn bore_radius(shown: f64, said: f64) -> Pair {
    ("bore radius", "`bore_radius_m`", shown, said)
}

/// The first length that is off by more than a part of the module.
fn first_off(lengths: &[Pair], module: f64) -> Option<Disagreement> {
    let mm = |x: f64| format!("{:.4} mm", 1e3 * x);
    let off = lengths
        .iter()
        .find(|(_, _, shown, said)| (shown - said).abs() > NEAR * module);
    off.map(|&(what, keys, shown, said)| Disagreement {
        what,
        keys,
        shown: mm(shown),
        said: mm(said),
        ratio: shown / said,
    })
}

/// The first angle that is off [rad].
fn angle_off(angles: &[Pair]) -> Option<Disagreement> {
    let degrees = |x: f64| format!("{:.3} degrees", x.to_degrees());
    let off = angles
        .iter()
        .find(|(_, _, shown, said)| (shown - said).abs() > NEAR_ANGLE);
    off.map(|&(what, keys, shown, said)| Disagreement {
        what,
        keys,
        shown: degrees(shown),
        said: degrees(said),
        ratio: 1.0,
    })
}

fn of_gear(found: &RecognisedGear, said: &Gear) -> Option<Disagreement> {
    let fit = &found.fit;
    let thickness = 2.0 * said.r_base() * said.half_angle_base();
    let mut lengths = vec![
        (
            "base radius",
            "`module_m`, `pressure_angle_deg` and `helix_angle_deg`",
            fit.base_radius,
            said.r_base(),
        ),
        (
            "tip radius",
            "`addendum_factor` and `profile_shift`",
            found.tip.radius,
            said.r_tip(),
        ),
        (
            "tooth thickness at the base circle",
            "`profile_shift` and `thinning_m`",
            fit.base_thickness(),
            thickness,
        ),
        face_width(found.width, said.face_width()),
    ];
    let bore = said.params().bore_radius;
    // A gear without a bore has no bore radius to compare.
    if bore > 0.0 {
        lengths.push(bore_radius(found.bore.radius, bore));
    }
    let helix = (
        "base helix angle",
        "`helix_angle_deg` and `pressure_angle_deg`",
        fit.base_helix_angle(),
        said.base_helix_angle(),
    );
    first_off(&lengths, said.transverse_module()).or_else(|| angle_off(&[helix]))
}

fn of_rack(found: &RecognisedRack, said: &Rack) -> Option<Disagreement> {
    let p = said.params();
    // A thinned tooth counts as one cut deeper: its tips stand higher above its reference line.
    let deeper = 0.5 * p.thinning / said.transverse_pressure_angle().tan();
    let module = said.pitch() / std::f64::consts::PI;
    let lengths = [
        (
            "pitch",
            "`module_m` and `helix_angle_deg`",
            found.pitch,
            said.pitch(),
        ),
        (
            "tip height",
            "`addendum_factor` and `thinning_m`",
            found.tip,
            said.tip_height() + deeper,
        ),
        face_width(found.width, said.face_width()),
    ];
    let angles = [
        (
            "transverse pressure angle",
            "`pressure_angle_deg` and `helix_angle_deg`",
            found.pressure_angle,
            said.transverse_pressure_angle(),
        ),
        (
            "helix angle",
            "`helix_angle_deg`",
            found.helix_angle,
            p.helix_angle,
        ),
    ];
    if found.teeth != said.teeth() {
        return Some(Disagreement {
            what: "number of teeth",
            keys: "`teeth`",
            shown: found.teeth.to_string(),
            said: said.teeth().to_string(),
            ratio: 1.0,
        });
    }
    first_off(&lengths, module).or_else(|| angle_off(&angles))
}

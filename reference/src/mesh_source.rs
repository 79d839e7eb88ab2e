//! Where the mesh of a gear comes from: the parameters of the models that are made of finite elements.

use crate::mesh::{ElementKind, GearMesh, GearMeshParams};
use crate::{deck, mesh};
use gearbench_models::error::{BuildError, Reason};
use gearbench_models::gear::parameters::whole;
use gearbench_models::gear::table::{GearContext, ParameterInfo};
use gearbench_models::spec::Body as Toothing;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A parameter that may be left out.
pub const fn optional(key: &'static str, meaning: &'static str) -> ParameterInfo {
    ParameterInfo {
        key,
        meaning,
        required: false,
    }
}

/// Parameters that say where a mesh comes from.
pub const PARAMETERS: [ParameterInfo; 7] = [
    optional(
        "mesh",
        "\"generated\" (default), a stored reference such as \"calculix/case-a-fine\", or a path of a deck (.inp) or a mesh of Gmsh (.msh), also .gz",
    ),
    optional(
        "element",
        "\"C3D8\" or \"C3D8I\" (default for generated meshes); a deck brings its own",
    ),
    optional(
        "flank_elements",
        "elements along a flank of a generated mesh",
    ),
    optional(
        "fillet_elements",
        "elements along a fillet of a generated mesh",
    ),
    optional(
        "across_elements",
        "elements across a tooth of a generated mesh",
    ),
    optional(
        "rim_elements",
        "elements from root to bore of a generated mesh",
    ),
    optional(
        "width_elements",
        "elements over the face width of a generated mesh",
    ),
];

/// The parameters of a mesh and `own` ones of a model: `N` are those of both.
pub const fn with_own<const N: usize>(own: &[ParameterInfo]) -> [ParameterInfo; N] {
    let mut all = [PARAMETERS[0]; N];
    assert!(
        PARAMETERS.len() + own.len() == N,
        "N is the number of all parameters"
    );
    let mut i = 0;
    while i < N {
        all[i] = if i < PARAMETERS.len() {
            PARAMETERS[i]
        } else {
            own[i - PARAMETERS.len()]
        };
        i += 1;
    }
    all
}

/// Parameters of a gear as its model reads them: errors name model and key.
#[derive(Clone, Copy, Debug)]
pub struct Reader<'a> {
    /// Id of the model.
    pub model: &'static str,
    /// What it is built from.
    pub context: &'a GearContext<'a>,
}

impl Reader<'_> {
    /// An error about a parameter.
    pub fn error(&self, key: &str, why: impl Into<Reason>) -> BuildError {
        BuildError::parameter(self.model, key, why)
    }

    /// A number above 0, if one is given.
    pub fn positive(&self, key: &str, value: Option<f64>) -> Result<Option<f64>, BuildError> {
        match value {
            Some(x) if !(x.is_finite() && x > 0.0) => {
                Err(self.error(key, "expected a number above 0"))
            }
            value => Ok(value),
        }
    }

    /// A number of 0 or more; 0 when none is given.
    pub fn not_negative(&self, key: &str, value: Option<f64>) -> Result<f64, BuildError> {
        match value {
            Some(x) if !(x.is_finite() && x >= 0.0) => {
                Err(self.error(key, "expected a number of 0 or more"))
            }
            value => Ok(value.unwrap_or(0.0)),
        }
    }

    /// A whole number from `least` to `most`, if one is given.
    pub fn count(
        &self,
        key: &str,
        value: Option<usize>,
        least: usize,
        most: usize,
    ) -> Result<Option<usize>, BuildError> {
        match value {
            Some(n) if !(least..=most).contains(&n) => Err(self.error(
                key,
                format!("expected a whole number from {least} to {most}"),
            )),
            value => Ok(value),
        }
    }
}

/// Parameters that say where a mesh comes from; the table of parameters below says what they mean.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
#[expect(missing_docs, reason = "the keys of scenes, described in PARAMETERS")]
pub struct MeshParameters {
    pub mesh: Option<String>,
    pub element: Option<String>,
    #[serde(deserialize_with = "whole")]
    pub flank_elements: Option<usize>,
    #[serde(deserialize_with = "whole")]
    pub fillet_elements: Option<usize>,
    #[serde(deserialize_with = "whole")]
    pub across_elements: Option<usize>,
    #[serde(deserialize_with = "whole")]
    pub rim_elements: Option<usize>,
    #[serde(deserialize_with = "whole")]
    pub width_elements: Option<usize>,
}

impl MeshParameters {
    /// Numbers of elements of a generated mesh, by their keys.
    fn counts(&self) -> [(&'static str, Option<usize>); 5] {
        [
            ("flank_elements", self.flank_elements),
            ("fillet_elements", self.fillet_elements),
            ("across_elements", self.across_elements),
            ("rim_elements", self.rim_elements),
            ("width_elements", self.width_elements),
        ]
    }

    /// Numbers of elements of a generated mesh, given or by default: along a flank, along a fillet, across a tooth, from
    /// root to bore, over the width.
    pub fn counted(&self) -> [usize; 5] {
        let usual = GearMeshParams::default();
        let tooth = usual.tooth;
        let usual = [
            tooth.flank,
            tooth.fillet,
            tooth.across,
            usual.rim,
            usual.width,
        ];
        let mut given = self.counts().into_iter().zip(usual);
        std::array::from_fn(|_| given.next().map_or(1, |((_, n), usual)| n.unwrap_or(usual)))
    }

    /// A generated mesh with so many times the elements along flank and fillet, across the teeth, from root to bore, over
    /// the width.
    #[must_use]
    pub fn times(&self, factor: usize) -> MeshParameters {
        let [flank, fillet, across, rim, width] = self.counted().map(|n| Some(factor * n));
        MeshParameters {
            mesh: None,
            element: self.element.clone(),
            flank_elements: flank,
            fillet_elements: fillet,
            across_elements: across,
            rim_elements: rim,
            width_elements: width,
        }
    }
}

/// A mesh, or how to make one.
#[derive(Clone, Debug)]
pub enum Source {
    /// To be generated.
    Generated(Box<GearMeshParams>),
    /// Read from a deck, in the gear's own frame.
    Deck(Box<GearMesh>),
}

impl Source {
    /// Where the mesh of a gear comes from.
    pub fn read(reader: &Reader<'_>, given: &MeshParameters) -> Result<Source, BuildError> {
        let element = match &given.element {
            None => None,
            Some(name) => Some(ElementKind::from_name(name).ok_or_else(|| {
                let known = ElementKind::ALL.map(ElementKind::name);
                reader.error(
                    "element",
                    (
                        format!("there is no element \"{name}\""),
                        format!("there are {}", known.join(", ")),
                    ),
                )
            })?),
        };
        match given.mesh.as_deref().unwrap_or("generated") {
            "generated" => generated(reader, given, element),
            source => stored(reader, given, source, element).map(|m| Source::Deck(Box::new(m))),
        }
    }

    /// The whole mesh in the gear's own frame.
    pub fn whole(self, reader: &Reader<'_>) -> Result<GearMesh, BuildError> {
        let params = match self {
            Source::Deck(mesh) => return Ok(*mesh),
            Source::Generated(params) => params,
        };
        let mesh = match reader.context.body {
            Toothing::Gear(g) => mesh::gear(g, &params),
            Toothing::Rack(r) => mesh::rack(r, &params),
        };
        mesh.map_err(|e| reader.error("mesh", e.to_string()))
    }

    /// The sector of tooth 0 where the gear is made of equal ones: a generated gear of three teeth or more.
    pub fn sector(&self, reader: &Reader<'_>) -> Result<Option<GearMesh>, BuildError> {
        match (self, reader.context.body) {
            (Source::Generated(params), Toothing::Gear(g)) if g.teeth() >= 3 => {
                let mesh = mesh::sector(g, params);
                mesh.map(Some)
                    .map_err(|e| reader.error("mesh", e.to_string()))
            }
            _ => Ok(None),
        }
    }
}

/// A generated mesh.
fn generated(
    reader: &Reader<'_>,
    given: &MeshParameters,
    element: Option<ElementKind>,
) -> Result<Source, BuildError> {
    let mut params = GearMeshParams::default();
    if let Some(kind) = element {
        params.kind = kind;
    }
    let tooth = &mut params.tooth;
    let values = [
        &mut tooth.flank,
        &mut tooth.fillet,
        &mut tooth.across,
        &mut params.rim,
        &mut params.width,
    ];
    for ((key, count), value) in given.counts().into_iter().zip(values) {
        if let Some(n) = reader.count(key, count, 1, 500)? {
            *value = n;
        }
    }
    Ok(Source::Generated(Box::new(params)))
}

/// The mesh of a gear in a deck: the toothed body with as many teeth whose centre is nearest.
fn stored(
    reader: &Reader<'_>,
    given: &MeshParameters,
    source: &str,
    element: Option<ElementKind>,
) -> Result<GearMesh, BuildError> {
    let context = reader.context;
    if let Some((key, _)) = given.counts().iter().find(|(_, n)| n.is_some()) {
        return Err(reader.error(
            key,
            (
                format!("is for generated meshes, but the mesh is \"{source}\""),
                "leave it out",
            ),
        ));
    }
    let stored = crate::REFERENCES.iter().find(|r| r.id == source);
    let deck = match stored {
        Some(reference) => deck::read_bytes(source, reference.deck),
        None if Path::new(source).is_file() => deck::read(source),
        None => {
            let known: Vec<&str> = crate::REFERENCES.iter().map(|r| r.id).collect();
            return Err(reader.error(
                "mesh",
                (
                    format!("\"{source}\" is neither a file nor a stored reference"),
                    format!("there are \"generated\", {}", known.join(", ")),
                ),
            ));
        }
    };
    let gears = deck
        // A mesh without a material is as good: the scene has its own.
        .and_then(|d| deck::gears_with(&d, Some(context.material)))
        .map_err(|e| reader.error("mesh", e.to_string()))?;
    let (teeth, rack) = match context.body {
        Toothing::Gear(g) => (g.teeth(), false),
        Toothing::Rack(r) => (r.teeth(), true),
    };
    let found: Vec<String> = gears
        .iter()
        .map(|g| format!("{} with {} teeth", g.name, g.mesh.teeth))
        .collect();
    let distance = |g: &deck::DeckGear| (g.centre - context.hub.centre).xy().norm();
    let gear = gears
        .into_iter()
        .filter(|g| rack == matches!(g.shape, deck::BodyShape::Rack { .. }))
        .filter(|g| rack || g.mesh.teeth == teeth)
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
        .ok_or_else(|| {
            reader.error(
                "mesh",
                format!(
                    "gear `{}` has {teeth} teeth, but \"{source}\" has {}",
                    context.name,
                    found.join(", ")
                ),
            )
        })?;
    if let Some((what, shown, said)) = disagreement(&gear, context.body) {
        return Err(reader.error(
            "mesh",
            (
                format!(
                    "the {what} of gear `{}` is {said}, but the flanks of \"{source}\" show {shown}",
                    context.name
                ),
                "give the scene the data of the mesh (`gearbench reduce` tells them), or the mesh of this gear",
            ),
        ));
    }
    let mut gear = gear.mesh;
    if let Some(kind) = element {
        let same = |k: ElementKind| (k.shape(), k.nodes()) == (kind.shape(), kind.nodes());
        if !gear.mesh.blocks.iter().any(|b| same(b.kind)) {
            return Err(reader.error(
                "element",
                (
                    format!(
                        "the elements of \"{source}\" are {}",
                        gear.mesh.kind_names()
                    ),
                    format!(
                        "none of them has the nodes of {}: {}",
                        kind.name(),
                        kind.nodes()
                    ),
                ),
            ));
        }
        for block in gear.mesh.blocks.iter_mut().filter(|b| same(b.kind)) {
            block.kind = kind;
        }
    }
    Ok(gear)
}

/// How far base and tip radius of a scene's gear may be from those of its mesh, over the transverse module.
const NEAR: f64 = 0.1;
/// How far its base helix may be [rad].
const NEAR_HELIX: f64 = 0.01;

/// What a recognised gear has otherwise than the scene says, with the mesh's value and the scene's. Small differences are
/// left to the scene: contact is between the flanks of the mesh, loads and mesh layout are those of its gear.
fn disagreement(gear: &deck::DeckGear, body: &Toothing) -> Option<(&'static str, String, String)> {
    let (found, Toothing::Gear(said)) = (gear.found.as_ref()?, body) else {
        return None;
    };
    let fit = &found.fit;
    let mm = |x: f64| format!("{:.4} mm", 1e3 * x);
    let lengths = [
        ("base radius", fit.base_radius, said.r_base()),
        ("tip radius", found.tip.radius, said.r_tip()),
        ("face width", found.width, said.face_width()),
    ];
    for (what, shown, said_so) in lengths {
        if (shown - said_so).abs() > NEAR * said.transverse_module() {
            return Some((what, mm(shown), mm(said_so)));
        }
    }
    let degrees = |x: f64| format!("{:.3} degrees", x.to_degrees());
    let (shown, expected) = (fit.base_helix_angle(), said.base_helix_angle());
    let off = (shown - expected).abs() > NEAR_HELIX;
    off.then(|| ("base helix angle", degrees(shown), degrees(expected)))
}

#[cfg(test)]
mod tests {
    use super::MeshParameters;

    /// Given counts and those by default are multiplied alike, and what was asked for beside stays.
    #[test]
    fn counts_are_multiplied() {
        let given = MeshParameters {
            element: Some("C3D8".into()),
            flank_elements: Some(5),
            width_elements: Some(1),
            ..MeshParameters::default()
        };
        let [_, fillet, across, rim, _] = MeshParameters::default().counted();
        assert_eq!(given.counted(), [5, fillet, across, rim, 1]);
        let twice = given.times(2);
        assert_eq!(twice.counted(), [10, 2 * fillet, 2 * across, 2 * rim, 2]);
        assert_eq!((twice.element, twice.mesh), (given.element, None));
    }
}

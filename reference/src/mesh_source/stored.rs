//! Selection of the gear of a scene in a file, and comparison of the file with the scene.
//!
//! The keys of the gear guide the search where they describe a mesh: number of teeth and bore radius. The mesh has to
//! be one of that gear: base radius (module, pressure angle, teeth), base helix, thickness at the base circle (profile
//! shift, thinning), tip radius, bore radius and face width are compared. Data that no key of a gear has, units and
//! the position in the file, are given by `units`, `axis`, `axis_point_m` and `flank_radii_m`.

use super::agree::disagreement;
use super::{MeshParameters, Reader};
use crate::deck::{self, Deck, DeckError, Units};
use crate::file_kind::{self, Input};
use crate::gear_deck::{self, BodyShape, DeckGear};
use crate::gear_mesh::GearMesh;
use crate::mesh::ElementKind;
use crate::recognise::{RecognisedBody, SpecifiedBody};
use gearbench_models::Vec3;
use gearbench_models::error::BuildError;
use gearbench_models::spec::Body as Toothing;
use std::path::Path;

/// A mesh that was read.
#[derive(Clone, Debug)]
pub struct Stored {
    /// The mesh in the gear's own frame.
    pub mesh: GearMesh,
    /// Result of the recognition, where no sets name the flanks.
    pub found: Option<RecognisedBody>,
    /// How the file was read, a line each.
    pub notes: Vec<String>,
}

/// The mesh of a gear in a file: the toothed body with as many teeth whose centre is nearest.
pub(super) fn stored(
    reader: &Reader<'_>,
    given: &MeshParameters,
    source: &str,
    element: Option<ElementKind>,
) -> Result<Stored, BuildError> {
    let context = reader.context;
    if let Some((key, _)) = given.counts().iter().find(|(_, n)| n.is_some()) {
        return Err(reader.error(
            key,
            (
                format!("applies to generated meshes, but the mesh is \"{source}\""),
                "remove it",
            ),
        ));
    }
    if matches!(context.body, Toothing::Gear(g) if g.is_internal()) {
        return Err(reader.error(
            "mesh",
            (
                "meshes of internal gears are not recognised in files",
                "remove it to generate the mesh",
            ),
        ));
    }
    let known = known(reader, given)?;
    let deck = read(reader, given, source)?;
    // A mesh without a material is as good: the scene has its own.
    let bodies = gear_deck::gears_known(&deck, Some(context.material), &known);
    let bodies = bodies.map_err(|e| reader.error("mesh", e.to_string()))?;
    let gear = chosen(reader, source, bodies)?;
    if let Some(off) = disagreement(&gear, context.body) {
        return Err(reader.error("mesh", off.told(context.name, source, &deck)));
    }
    // A flank that is not there would be passed through.
    if let Some(first) = gear.missing.first() {
        let more = match gear.missing.len() {
            1 => String::new(),
            n => format!(", and {} more", n - 1),
        };
        return Err(reader.error(
            "mesh",
            (
                format!("of `{}` in \"{source}\" {first}{more}", gear.name),
                "use the same mesh for all flanks, give their radii as `flank_radii_m`, or name the flanks in contact by node sets \
                 (`flank_1l`, `flank_1r`, ...)",
            ),
        ));
    }
    let mut mesh = gear.mesh;
    if let Some(kind) = element {
        taken_as(reader, source, &mut mesh, kind)?;
    }
    Ok(Stored {
        mesh,
        found: gear.found,
        notes: deck.told(),
    })
}

/// Returns the specification of the body from the scene.
fn known(reader: &Reader<'_>, given: &MeshParameters) -> Result<SpecifiedBody, BuildError> {
    let finite = |x: &[f64]| x.iter().all(|x| x.is_finite());
    let axis = given.axis.map(Vec3::from);
    if axis.is_some_and(|a| !(finite(a.as_slice()) && a.norm() > 0.0)) {
        return Err(reader.error("axis", "expected a direction [x, y, z] other than zero"));
    }
    if given.axis_point_m.is_some_and(|p| !finite(&p)) {
        return Err(reader.error("axis_point_m", "expected a position [x, y, z] in metres"));
    }
    if let Some([a, b]) = given.flank_radii_m
        && !(a > 0.0 && b > a && b.is_finite())
    {
        return Err(reader.error(
            "flank_radii_m",
            "expected two radii in metres, the smaller one above 0 first",
        ));
    }
    Ok(SpecifiedBody {
        teeth: match reader.context.body {
            Toothing::Gear(g) => Some(g.teeth()),
            Toothing::Rack(r) => Some(r.teeth()),
        },
        axis,
        point: given.axis_point_m.map(Vec3::from),
        bore_radius: match reader.context.body {
            Toothing::Gear(g) => Some(g.params().bore_radius).filter(|r| *r > 0.0),
            Toothing::Rack(_) => None,
        },
        flanks: given.flank_radii_m,
    })
}

/// The file, or the stored reference of this name.
fn read(reader: &Reader<'_>, given: &MeshParameters, source: &str) -> Result<Deck, BuildError> {
    let units = match &given.units {
        None => None,
        Some(name) => Some(Units::from_name(name).ok_or_else(|| {
            let known = Units::ALL.map(|u| u.name);
            reader.error(
                "units",
                (
                    format!("there are no units \"{name}\""),
                    format!("there are {}", known.join(", ")),
                ),
            )
        })?),
    };
    let bad = |e: DeckError| reader.error("mesh", e.to_string());
    if let Some(reference) = crate::REFERENCES.iter().find(|r| r.id == source) {
        if units.is_some_and(|u| u != Units::SI) {
            return Err(reader.error(
                "units",
                (
                    format!("the stored reference \"{source}\" is in m-kg-s"),
                    "remove it",
                ),
            ));
        }
        return deck::read_bytes(source, reference.deck).map_err(bad);
    }
    if let Some(kind) = file_kind::foreign(source, Input::Mesh) {
        return Err(reader.error(
            "mesh",
            (
                format!("\"{source}\" is {}, not a mesh", kind.name),
                kind.way_out_of(source),
            ),
        ));
    }
    if Path::new(source).is_file() {
        return deck::read_in(source, units).map_err(bad);
    }
    let known: Vec<&str> = crate::REFERENCES.iter().map(|r| r.id).collect();
    Err(reader.error(
        "mesh",
        (
            format!("\"{source}\" is neither a file nor a stored reference"),
            format!("there are \"generated\", {}", known.join(", ")),
        ),
    ))
}

/// The body that is the gear of the scene; bodies that are no gears matter where it is not among the others.
fn chosen(
    reader: &Reader<'_>,
    source: &str,
    bodies: Vec<Result<DeckGear, DeckError>>,
) -> Result<DeckGear, BuildError> {
    let context = reader.context;
    let (teeth, rack) = match context.body {
        Toothing::Gear(g) => (g.teeth(), false),
        Toothing::Rack(r) => (r.teeth(), true),
    };
    let mut refused = None;
    let mut gears = Vec::new();
    for body in bodies {
        match body {
            Ok(gear) => gears.push(gear),
            Err(e) => refused = refused.or(Some(e)),
        }
    }
    let found: Vec<String> = gears
        .iter()
        .map(|g| format!("{} with {} teeth", g.name, g.mesh.teeth))
        .collect();
    let distance = |g: &DeckGear| (g.centre - context.hub.centre).xy().norm();
    let gear = gears
        .into_iter()
        .filter(|g| rack == matches!(g.shape, BodyShape::Rack { .. }))
        .filter(|g| rack || g.mesh.teeth == teeth)
        .min_by(|a, b| distance(a).total_cmp(&distance(b)));
    let what = if rack { "is a rack with" } else { "has" };
    gear.ok_or_else(|| match refused {
        Some(e) if found.is_empty() => reader.error("mesh", e.to_string()),
        refused => {
            let other = refused.map_or(String::new(), |e| {
                format!("; another body is not a gear: {e}")
            });
            reader.error(
                "mesh",
                format!(
                    "gear `{}` {what} {teeth} teeth, but \"{source}\" has {}{other}",
                    context.name,
                    found.join(", ")
                ),
            )
        }
    })
}

/// The elements of a mesh as another kind with the same nodes.
fn taken_as(
    reader: &Reader<'_>,
    source: &str,
    gear: &mut GearMesh,
    kind: ElementKind,
) -> Result<(), BuildError> {
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
    Ok(())
}

//! Assembly of contact along lines of flanks: the gears that support it, and its law.

use super::members::SceneGear;
use super::mesh_assembly::{touches_in_space, varies_over_width};
use crate::contact::pairs::{FlankLines, LineGear, LinesOfAction};
use crate::error::{BuildError, GearPart, MeshPart, Reason};
use crate::gear::GearModel;
use crate::gear::elastic::lines::Strips;
use crate::geometry::Flanks;
use crate::law::{Damping, HalfSpace, Law};
use crate::spec::{Body, ContactSpec, FlankContact, MeshLayout, MeshSpec, Modelling, SceneSpec};
use crate::stiffness::Material;
use std::f64::consts::PI;
use std::sync::Arc;

/// Returns true if the local compliance of a contact is that of half-spaces.
pub(super) fn is_half_space(contact: &ContactSpec) -> bool {
    contact.flanks == FlankContact::HalfSpace
}

/// Returns the strips of a gear with contact along lines: one where contact is uniform over the width, otherwise the
/// given slices, or one per layer of elements; `None` for other gears.
pub(super) fn lines_of(spec: &SceneSpec, modelling: &Modelling, gear: usize) -> Option<Strips> {
    let meshes = spec.meshes.iter().zip(&modelling.contacts);
    let mut own = meshes.filter(|(m, c)| is_half_space(c) && m.gears.contains(&gear));
    let varies = |m: &MeshSpec| {
        let mut gears = m.gears.iter();
        touches_in_space(spec, m) || gears.any(|g| varies_over_width(&spec.gears[*g].body))
    };
    let of = |(mesh, contact): (&MeshSpec, &ContactSpec)| match contact.slices {
        Some(n) => Strips::Count(n),
        None if varies(mesh) => Strips::Layers,
        None => Strips::Count(1),
    };
    let first = of(own.next()?);
    Some(own.fold(first, |strips, next| match (strips, of(next)) {
        (Strips::Count(a), Strips::Count(b)) => Strips::Count(a.max(b)),
        _ => Strips::Layers,
    }))
}

/// Returns the strips over the width of a mesh with contact along lines: those of its elastic gears.
///
/// # Errors
/// A gear that does not give way along lines or touches otherwise in another mesh, strips that differ.
pub(super) fn strips(
    spec: &SceneSpec,
    modelling: &Modelling,
    mesh: &MeshSpec,
    gears: &[SceneGear],
) -> Result<usize, BuildError> {
    let names = spec.names_of(mesh.gears);
    let error = |part, why: Reason| BuildError::mesh(names, part, why);
    let mut found: Option<usize> = None;
    for i in mesh.gears {
        let model = &gears[i].model;
        let lines = lines_of_gear(model.as_ref());
        if lines.is_none() && (model.teeth().is_some() || model.flanks().is_some()) {
            let error = BuildError::gear(
                &spec.gears[i].name,
                GearPart::Model,
                (
                    format!(
                        "half-space contact needs elastic gears, finite elements, or a rigid gear in mesh with them, but `{}` is `{}`",
                        spec.gears[i].name, gears[i].id
                    ),
                    "give the contact local = \"mesh\" and a penalty",
                ),
            );
            return Err(error.of_model());
        }
        let Some((flanks, _)) = lines else {
            continue;
        };
        let mut others = spec.meshes.iter().zip(&modelling.contacts);
        if others.any(|(m, c)| m.gears.contains(&i) && !is_half_space(c)) {
            return Err(error(
                MeshPart::Contact,
                (
                    format!(
                        "`{}` has half-space contact here and contact of mesh elements in another mesh",
                        spec.gears[i].name
                    ),
                    "give all contacts of a gear the same `local`",
                )
                    .into(),
            ));
        }
        let own = flanks.grids().first().map_or(0, |g| g.columns);
        if flanks.grids().iter().any(|g| g.columns != own) {
            return Err(BuildError::gear(
                &spec.gears[i].name,
                GearPart::Model,
                (
                    "its flanks have different numbers of elements over the width",
                    "use the same mesh for all flanks, or give the contact local = \"mesh\"",
                ),
            ));
        }
        match found {
            Some(other) if other != own => {
                return Err(error(
                    MeshPart::Slices,
                    (
                        format!(
                            "half-space contact pairs the strips of both flanks, but they have {other} and {own} strips over the width"
                        ),
                        "give both gears the same `width_elements`, or the contact `slices`",
                    )
                        .into(),
                ));
            }
            _ => found = Some(own),
        }
    }
    let Some(strips) = found.filter(|n| *n > 0) else {
        return Err(error(
            MeshPart::Contact,
            (
                "half-space contact adds the compliance that a mesh does not resolve, but neither gear is elastic",
                "remove `local`: the stiffness of a tooth pair has Hertz's approach",
            )
                .into(),
        ));
    };
    let widths = mesh.gears.map(|i| match &spec.gears[i].body {
        Body::Gear(gear) => gear.face_width(),
        Body::Rack(rack) => rack.face_width(),
    });
    if (widths[0] - widths[1]).abs() > 1e-9 * widths[0] && strips > 1 {
        return Err(error(
            MeshPart::Slices,
            (
                "half-space contact pairs the strips of both flanks, but the face widths differ",
                "give both gears the same face width, or one element over it",
            )
                .into(),
        ));
    }
    Ok(strips)
}

/// Returns the flanks of a gear with lines as nodes, and its near field; `None` for other gears.
fn lines_of_gear(model: &dyn GearModel) -> Option<(&Flanks, &Arc<Vec<Vec<f64>>>)> {
    if let Some(lines) = model.deformed_lines() {
        return Some((lines.flanks(), lines.near_field()));
    }
    Some((model.flanks()?, model.displacement()?.near_field()?))
}

/// Returns `A = 2 (1 - nu^2)/(pi E)` of a material [m^2/N].
fn compliance(of: &Material) -> f64 {
    2.0 * (1.0 - of.poisson * of.poisson) / (PI * of.young)
}

/// Builds the lines of a mesh and their law; `of_pairs` is the law for tooth pairs, whose damping is used for lines as
/// well.
pub(super) fn flank_lines(
    spec: &SceneSpec,
    mesh: &MeshSpec,
    l: &MeshLayout,
    contact: &ContactSpec,
    gears: &[SceneGear],
    (search, of_pairs): (LinesOfAction, Law),
) -> Result<(FlankLines, Law), BuildError> {
    let names = spec.names_of(mesh.gears);
    let error = |part, why: Reason| BuildError::mesh(names, part, why);
    if contact.exponent != 1.0 {
        return Err(error(
            MeshPart::Exponent,
            (
                format!(
                    "half-space contact has its own force law, but the exponent {} is given",
                    contact.exponent
                ),
                "remove it",
            )
                .into(),
        ));
    }
    let at_load = contact.damping.is_by_load();
    if contact.damping != Damping::None && !at_load {
        return Err(error(
            MeshPart::Damping,
            (
                format!(
                    "the damping `{}` belongs to a tooth pair, but its gears deform along contact lines",
                    contact.damping.id()
                ),
                "use a ratio at load, { law = \"ratio-at-load\", ratio = 0.05 }, or damp the modes",
            )
                .into(),
        ));
    }
    let mut of_gears = [None, None];
    for (out, &i) in of_gears.iter_mut().zip(&mesh.gears) {
        let Some((flanks, near_field)) = lines_of_gear(gears[i].model.as_ref()) else {
            continue;
        };
        let g = &spec.gears[i];
        let compliance = compliance(&g.material);
        let lines = LineGear::new(flanks, near_field.clone(), &g.body, compliance)
            .map_err(|why| BuildError::gear(&g.name, GearPart::Model, why).of_model())?;
        *out = Some(lines);
    }
    let lines = FlankLines::new(search, of_gears, l.face_width);
    let law = of_pairs.with_half_space(HalfSpace::new(lines.width(), lines.compliance()));
    Ok((lines, law))
}

//! Assembly of the contact of flank points of a mesh.

use super::members::SceneGear;
use crate::Vec3;
use crate::contact::pairs::MeshGeometry;
use crate::contact::points::{FlankPoints, SearchGear};
use crate::error::{BuildError, GearPart, MeshPart, Reason};
use crate::law::{Damping, Law};
use crate::spec::{ContactSpec, MeshSpec, Passes, PointContact, PointLaw, SceneSpec};

/// Refuses hard contact at nodes without compliance.
fn refuse_singular(
    spec: &SceneSpec,
    mesh: &MeshSpec,
    contact: &ContactSpec,
    points: &PointContact,
    gears: &[SceneGear],
) -> Result<(), (MeshPart, Reason)> {
    if contact.exponent != 1.0 {
        return Err((
            MeshPart::Exponent,
            (
                format!(
                    "hard contact has no exponent, but {} is given",
                    contact.exponent
                ),
                "remove it",
            )
                .into(),
        ));
    }
    let own = |k: usize| gears[mesh.gears[k]].model.flanks().is_some();
    let slave = match points.passes {
        Passes::Auto => usize::from(!own(0) && own(1)),
        Passes::Second => 1,
        Passes::First | Passes::Both => 0,
    };
    let gives = |k: usize| {
        let model = &gears[mesh.gears[k]].model;
        model.displacement().is_some_and(|f| f.is_compliant())
    };
    if gives(slave) {
        return Ok(());
    }
    let name = |k: usize| spec.gears[mesh.gears[k]].name.as_str();
    let way_out = if gives(1 - slave) {
        let passes = if slave == 0 { "second" } else { "first" };
        format!(
            "use the points of `{}`, passes = \"{passes}\"",
            name(1 - slave)
        )
    } else {
        "give an elastic gear its residual compliance, or a penalty".into()
    };
    Err((
        MeshPart::Contact,
        (
            format!(
                "hard contact needs nodes that deform under their own force, but gear `{}`, \
                     which has the contact points, has no residual compliance",
                name(slave)
            ),
            way_out,
        )
            .into(),
    ))
}

/// Builds the point search of a mesh with a gear that has its own flanks, and its law; `of_pairs` is the law for tooth
/// pairs, whose ratio at load is used for points as well.
pub(super) fn flank_points(
    spec: &SceneSpec,
    mesh: &MeshSpec,
    contact: &ContactSpec,
    gears: &[SceneGear],
    phases: &[f64],
    geometry: &MeshGeometry,
    (lines, of_pairs): ([Option<[Vec3; 2]>; 2], Law),
) -> Result<(FlankPoints, Law), BuildError> {
    let [a, b] = mesh.gears.map(|i| &spec.gears[i]);
    let error = |part, why: Reason| BuildError::mesh([&a.name, &b.name], part, why);
    let flanked = mesh
        .gears
        .iter()
        .find(|i| gears[**i].model.flanks().is_some());
    let name = flanked.map_or("", |i| spec.gears[*i].name.as_str());
    let Some(points) = contact.flanks.points() else {
        return Err(error(
            MeshPart::Contact,
            (
                format!("gear `{name}` has contact at flank points and needs a penalty in Pa/m"),
                "give the contact `penalty_pa_per_m`, for steel for example 1e15",
            )
                .into(),
        ));
    };
    let hard = points.law == PointLaw::Hard;
    if contact.friction.is_some() && hard {
        return Err(error(
            MeshPart::Friction,
            (
                format!("the hard contact of gear `{name}` has no friction"),
                "give it a penalty, or remove friction",
            )
                .into(),
        ));
    }
    let at_load = contact.damping.is_by_load();
    if at_load && points.penalty().is_none_or(|[_, dashpot]| dashpot != 0.0) {
        return Err(error(
            MeshPart::Damping,
            (
                format!(
                    "the damping `{}` is given together with {}",
                    contact.damping.id(),
                    if hard {
                        "hard contact"
                    } else {
                        "a dashpot per area"
                    }
                ),
                "give one of them",
            )
                .into(),
        ));
    }
    if contact.damping != Damping::None && !at_load {
        return Err(error(
            MeshPart::Damping,
            (
                format!(
                    "the damping `{}` belongs to a tooth pair, but gear `{name}` has contact \
                     at flank points",
                    contact.damping.id()
                ),
                "use a ratio at load, { law = \"ratio-at-load\", ratio = 0.05 }, or give a dashpot per area, `damping_ns_per_m3`",
            )
                .into(),
        ));
    }
    if let Some(i) = mesh
        .gears
        .iter()
        .find(|i| gears[**i].model.follows_contact())
    {
        return Err(error(
            MeshPart::Contact,
            (
                format!(
                    "the springs of gear `{}` vary with the contact radius, which the flank \
                     points of gear `{name}` do not define",
                    spec.gears[*i].name
                ),
                "use a constant tooth stiffness",
            )
                .into(),
        ));
    }
    if hard {
        refuse_singular(spec, mesh, contact, points, gears)
            .map_err(|(part, why)| error(part, why).of_model())?;
    }
    let owner = |k: usize| {
        let i = mesh.gears[k];
        SearchGear {
            body: &spec.gears[i].body,
            gear: gears[i].model.as_ref(),
            phase: phases[i],
            view: geometry.views[k],
            mesh: geometry.mesh_of_gear[k],
        }
    };
    let search = FlankPoints::new([owner(0), owner(1)], geometry, points, lines).map_err(
        |(gear, message)| {
            let error = match gear {
                Some(k) => {
                    BuildError::gear(&spec.gears[mesh.gears[k]].name, GearPart::Model, message)
                }
                None => error(MeshPart::Contact, message),
            };
            error.of_model()
        },
    )?;
    if at_load {
        return Ok((search, of_pairs));
    }
    let dashpot = points.penalty().map_or(0.0, |[_, dashpot]| dashpot);
    let law = Law::new(contact.exponent, Damping::KelvinVoigt { c: dashpot })
        .map_err(|e| error(MeshPart::Exponent, e.reason()))?;
    Ok((search, law))
}

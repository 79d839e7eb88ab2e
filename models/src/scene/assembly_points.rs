//! The contact of flank points of a mesh, from its settings.

use super::SceneGear;
use crate::Vec3;
use crate::contact::pairs::MeshGeometry;
use crate::contact::points::{FlankPoints, Owner};
use crate::law::{Damping, Law};
use crate::spec::{BuildError, ContactSpec, MeshSpec, Passes, PointContact, SceneSpec};

/// Hard contact needs nodes that give way where its points are.
fn refuse_singular(
    spec: &SceneSpec,
    mesh: &MeshSpec,
    contact: &ContactSpec,
    points: &PointContact,
    gears: &[SceneGear],
) -> Result<(), String> {
    if contact.exponent != 1.0 {
        return Err(format!(
            "hard contact has no exponent, but {} is given; leave it out",
            contact.exponent
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
        model.field().is_some_and(|f| f.is_compliant())
    };
    if gives(slave) {
        return Ok(());
    }
    let name = |k: usize| spec.gears[mesh.gears[k]].name.as_str();
    let way_out = if gives(1 - slave) {
        let passes = if slave == 0 { "second" } else { "first" };
        format!(
            "take the points of `{}`, passes = \"{passes}\"",
            name(1 - slave)
        )
    } else {
        "give an elastic gear its residual compliance, or a penalty".into()
    };
    Err(format!(
        "hard contact needs nodes that give way under their own force, but gear `{}`, whose points touch, has no residual compliance; {way_out}",
        name(slave)
    ))
}

/// The point search of a mesh with a gear that brings its flanks, and its law.
pub(super) fn flank_points(
    spec: &SceneSpec,
    mesh: &MeshSpec,
    contact: &ContactSpec,
    gears: &[SceneGear],
    phases: &[f64],
    geometry: &MeshGeometry,
    lines: [Option<[Vec3; 2]>; 2],
) -> Result<(FlankPoints, Law), BuildError> {
    let [a, b] = mesh.gears.map(|i| &spec.gears[i]);
    let error = |e: String| BuildError::mesh(&a.name, &b.name, e);
    let flanked = mesh
        .gears
        .iter()
        .find(|i| gears[**i].model.flanks().is_some());
    let name = flanked.map_or("", |i| spec.gears[*i].name.as_str());
    let Some(points) = &contact.points else {
        return Err(error(format!(
            "gear `{name}` touches with the points of its flanks and needs their penalty in Pa/m; give the contact `penalty_pa_per_m`, for steel for example 1e15"
        )));
    };
    if contact.friction.is_some() {
        return Err(error(format!(
            "friction is not known to the flank points of gear `{name}`; leave it out, or use a model without flanks"
        )));
    }
    if contact.damping != Damping::None {
        return Err(error(format!(
            "the damping `{}` is that of a tooth pair, but gear `{name}` touches with the points of its flanks; leave it out or give a dashpot per area, `damping_ns_per_m3`",
            contact.damping.id()
        )));
    }
    if let Some(i) = mesh
        .gears
        .iter()
        .find(|i| gears[**i].model.uses_engagement())
    {
        return Err(error(format!(
            "the springs of gear `{}` vary with the contact radius, which the flank points of gear `{name}` do not tell; use a constant tooth stiffness",
            spec.gears[*i].name
        )));
    }
    if points.hard {
        refuse_singular(spec, mesh, contact, points, gears).map_err(error)?;
    }
    let owner = |k: usize| {
        let i = mesh.gears[k];
        Owner {
            body: &spec.gears[i].body,
            gear: gears[i].model.as_ref(),
            phase: phases[i],
            view: geometry.views[k],
            mesh: geometry.mesh_of_gear[k],
        }
    };
    let search = FlankPoints::new([owner(0), owner(1)], geometry, points, lines).map_err(
        |(gear, message)| match gear {
            Some(k) => BuildError::gear(&spec.gears[mesh.gears[k]].name, message),
            None => error(message),
        },
    )?;
    let law = Law::new(contact.exponent, Damping::KelvinVoigt { c: points.damping })
        .map_err(|e| error(e.to_string()))?;
    Ok((search, law))
}

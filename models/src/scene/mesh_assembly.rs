//! A mesh from its settings: lines of action over slices, and the law of its contact.

use super::friction::MeshFriction;
use super::placement::{engagement, views};
use super::scales::{hub_mass, initial_speed, reduced_mass};
use crate::Vec3;
use crate::contact::pairs::{LinesOfAction, MeshGeometry, Separation, Slice};
use crate::error::{BuildError, GearPart, MeshPart, Reason};
use crate::kinematics::{Hub, MeshView};
use crate::law::{Damping, Law, LawError, MeshFilm, MeshLoad};
use crate::spec::{
    Body, ContactSpec, GearSpec, MeshLayout, MeshSpec, Mount, SceneSpec, effective_radius,
    stiffness_curve,
};

/// Slices of a mesh whose contact varies over the width.
const DEFAULT_SLICES: usize = 16;

/// Samples of a modified flank along the path.
const FLANK_SAMPLES: usize = 257;

/// Separation of the flanks of gear `k` of a mesh in the middle of the width.
fn separation(
    l: &MeshLayout,
    gears: [&GearSpec; 2],
    views: &[MeshView; 2],
    k: usize,
) -> Separation {
    let of = engagement(l, gears[0], views, k);
    let start = views[k].touching[0];
    match &gears[k].body {
        Body::Gear(g) if !g.params().modifications.is_none() => {
            let rb = g.r_base();
            let removed = |s: f64| g.flank_deviation(rb.hypot(s), 0.0);
            Separation::new(&of, start, FLANK_SAMPLES, Some(&removed))
        }
        _ => Separation::new(&of, start, FLANK_SAMPLES, None),
    }
}

/// What is removed at a place of the width more than in its middle [m].
fn lead(body: &Body, zeta: f64) -> f64 {
    match body {
        Body::Gear(g) => g.params().modifications.lead_crowning * zeta * zeta,
        Body::Rack(_) => 0.0,
    }
}

pub(super) fn varies_over_width(body: &Body) -> bool {
    match body {
        Body::Gear(g) => {
            g.params().helix_angle != 0.0 || g.params().modifications.lead_crowning != 0.0
        }
        Body::Rack(r) => r.params().helix_angle != 0.0,
    }
}

pub(super) fn lines_of_action(
    spec: &SceneSpec,
    mesh: &MeshSpec,
    l: &MeshLayout,
    (contact, strips): (&ContactSpec, Option<usize>),
    phases: &[f64],
    mesh_of_gear: [u8; 2],
) -> Result<(LinesOfAction, Law, MeshGeometry), BuildError> {
    let [a, b] = mesh.gears.map(|i| &spec.gears[i]);
    let error = |part, why: Reason| BuildError::mesh([&a.name, &b.name], part, why);
    let curve =
        stiffness_curve(a, b, l, contact).map_err(|e| error(MeshPart::Stiffness, e.reason()))?;
    let views = views(l, a, b, mesh.gears.map(|i| phases[i]));
    let many = varies_over_width(&a.body) || varies_over_width(&b.body);
    let count = strips
        .or(contact.slices)
        .unwrap_or(if many { DEFAULT_SLICES } else { 1 });
    if count == 0 || count > 1000 {
        return Err(error(
            MeshPart::Slices,
            (format!("{count} slices over the width"), "use 1 to 1000").into(),
        ));
    }
    let base_helix = a.body.base_helix_angle();
    let separations = [0, 1].map(|k| separation(l, [a, b], &views, k));
    let slices = (0..count)
        .map(|i| {
            let zeta = (2 * i + 1) as f64 / count as f64 - 1.0;
            let z = 0.5 * l.face_width * zeta;
            Slice {
                zeta,
                z,
                weight: 1.0 / count as f64,
                offset: z * base_helix.tan(),
                separation: [
                    separations[0].raised(lead(&a.body, zeta)),
                    separations[1].raised(lead(&b.body, zeta)),
                ],
            }
        })
        .collect();
    let geometry = MeshGeometry {
        views,
        mesh_of_gear,
        centre_a: Vec3::new(a.position[0], a.position[1], 0.0),
        length: l.length,
        base_pitch: l.base_pitch,
        zone: l.path,
        base_helix,
        deviating: [a, b].map(|g| match &g.body {
            Body::Gear(gear) if gear.deviates() => Some(gear.clone()),
            _ => None,
        }),
    };
    let law = law_of(spec, mesh, contact, curve.maximum().1)?;
    let search = LinesOfAction::new(geometry.clone(), curve, &law, slices);
    Ok((search, law, geometry))
}

pub(super) fn hub_of(g: &GearSpec) -> Result<Hub, BuildError> {
    let own = g.inertia.unwrap_or_else(|| match &g.body {
        Body::Gear(gear) => gear.mass_properties(g.material.density).izz,
        Body::Rack(rack) => rack.mass(g.material.density),
    });
    let inertia = own + g.added_inertia;
    if !(inertia > 0.0 && inertia.is_finite()) {
        return Err(BuildError::gear(
            &g.name,
            GearPart::Inertia,
            format!("inertia {inertia} is not positive"),
        ));
    }
    let rack = matches!(g.body, Body::Rack(_));
    match (&g.mount, rack) {
        (Mount::Prismatic, false) => {
            return Err(BuildError::gear(
                &g.name,
                GearPart::Mount,
                ("a prismatic mount is for racks", "use revolute"),
            ));
        }
        (Mount::Revolute, true) => {
            return Err(BuildError::gear(
                &g.name,
                GearPart::Mount,
                ("a rack cannot turn", "use prismatic or fixed"),
            ));
        }
        _ => {}
    }
    // The slide points counter-clockwise as seen from a gear in front of the teeth.
    let slide = rack.then(|| Vec3::new(g.facing.sin(), -g.facing.cos(), 0.0));
    Ok(Hub {
        mount: g.mount.clone(),
        centre: Vec3::new(g.position[0], g.position[1], 0.0),
        slide,
        inertia,
    })
}

/// An error of the law of a mesh.
fn law_error(gears: [&str; 2], e: &LawError) -> BuildError {
    let part = match e {
        LawError::Exponent { .. } => MeshPart::Exponent,
        _ => MeshPart::Damping,
    };
    BuildError::mesh(gears, part, e)
}

fn law_of(
    spec: &SceneSpec,
    mesh: &MeshSpec,
    contact: &ContactSpec,
    k: f64,
) -> Result<Law, BuildError> {
    let [a, b] = mesh.gears.map(|i| &spec.gears[i]);
    let error = |part, why: Reason| BuildError::mesh([&a.name, &b.name], part, why);
    let mass = reduced_mass([hub_mass(a, &hub_of(a)?), hub_mass(b, &hub_of(b)?)]);
    let damping = match contact.damping {
        Damping::KelvinVoigtRatio { .. } => {
            if !mass.is_finite() {
                return Err(error(
                    MeshPart::Damping,
                    (
                        "a damping ratio needs a gear that can move, but both are held",
                        "give the damper in N s/m",
                    )
                        .into(),
                ));
            }
            contact
                .damping
                .resolved(contact.exponent, k, mass)
                .map_err(|e| law_error([&a.name, &b.name], &e))?
        }
        other => other,
    };
    let load = MeshLoad {
        force: load_of(spec, mesh),
        stiffness: k,
        mass,
    };
    Law::new(contact.exponent, damping)
        .and_then(|law| law.under_load(load))
        .map_err(|e| law_error([&a.name, &b.name], &e))
}

/// Friction of a mesh; a film learns load, curvature and speeds at the pitch point.
pub(super) fn friction_of(
    spec: &SceneSpec,
    mesh: &MeshSpec,
    l: &MeshLayout,
    contact: &ContactSpec,
) -> Option<MeshFriction> {
    let [a, b] = mesh.gears.map(|i| &spec.gears[i]);
    let Body::Gear(first) = &a.body else {
        return None;
    };
    let helix = a.body.base_helix_angle();
    let curvature = |rho: f64| helix.cos() / rho;
    let of_second = match b.body {
        Body::Gear(_) => curvature(l.length - l.pitch_point),
        Body::Rack(_) => 0.0,
    };
    let film = MeshFilm {
        force_per_width: load_of(spec, mesh) / l.face_width,
        radius: 1.0 / (curvature(l.pitch_point) + of_second),
        // Flanks roll at the pitch point, each with v_t sin(alpha).
        per_speed: 2.0 * first.r_base() * l.working_pressure_angle.tan(),
    };
    let law = contact.friction?.in_mesh(&film);
    let teeth = first.teeth();
    Some(MeshFriction::new(law, teeth, helix != 0.0, l.face_width))
}

/// Largest force along the line of action that loads put on a mesh [N]: those on its own gears, else those on any gear
/// of the scene, whose torque a train hands on.
fn load_of(spec: &SceneSpec, mesh: &MeshSpec) -> f64 {
    let of = |g: &GearSpec| {
        let sum: f64 = g.loads.iter().map(|l| l.greatest(initial_speed(g))).sum();
        sum / effective_radius(&g.body)
    };
    let own = mesh.gears.map(|i| of(&spec.gears[i]));
    let own = own[0].max(own[1]);
    if own > 0.0 {
        return own;
    }
    spec.gears.iter().map(of).fold(0.0, f64::max)
}

//! Assembly of a mesh: lines of action over slices, and the contact law.

use super::friction::MeshFriction;
use super::hubs::hub_of;
use super::placement::{engagement, views};
use super::scales::{hub_mass, initial_speed, reduced_mass};
use crate::contact::pairs::{
    FlankForm, Helicoid, LinesOfAction, MeshGeometry, Plane, Separation, Slice, Spatial,
    SpatialGeometry,
};
use crate::error::{BuildError, MeshPart, Reason};
use crate::geometry::Side;
use crate::kinematics::{Direction, Hub, MeshView};
use crate::law::{Damping, Law, LawError, MeshFilm, MeshLoad};
use crate::spec::{
    Body, ContactSpec, GearSpec, MeshLayout, MeshSpec, SceneSpec, effective_radius, is_internal,
    layout_axes, stiffness_curve,
};

/// Number of slices of a mesh whose contact varies over the width.
const DEFAULT_SLICES: usize = 16;

/// Number of samples of a modified flank along the path.
const FLANK_SAMPLES: usize = 257;

/// Returns the separations of the left and the right flanks of gear `k` of a mesh at positions over the common width
/// in [-1, 1].
fn separations(
    l: &MeshLayout,
    gears: [&GearSpec; 2],
    views: &[MeshView; 2],
    k: usize,
    places: &[f64],
) -> [Vec<Separation>; 2] {
    let of = engagement(l, gears[0], views, k);
    let new = |removed: Option<&dyn Fn(f64) -> f64>| {
        Separation::new(&of, views[k].touching[0], FLANK_SAMPLES, removed)
    };
    let modified = match &gears[k].body {
        Body::Gear(g) if !g.params().modifications.is_none() => Some(g),
        _ => None,
    };
    let Some(g) = modified else {
        let plain = vec![new(None); places.len()];
        return [plain.clone(), plain];
    };
    let rb = g.r_base();
    let own_side = |side: Side| {
        if g.is_internal() {
            side.opposite()
        } else {
            side
        }
    };
    let at = |side: Side, zeta: f64| new(Some(&|s| g.flank_deviation(side, rb.hypot(s), zeta)));
    let own = |zeta: &f64| own_place(l, g.face_width(), k, *zeta);
    let of_side = |side: Side| -> Vec<Separation> {
        let side = own_side(side);
        if g.params().modifications.vary_jointly(side) {
            return places.iter().map(|zeta| at(side, own(zeta))).collect();
        }
        let middle = at(side, 0.0);
        let more = |zeta: f64| g.lead_deviation(side, zeta) - g.lead_deviation(side, 0.0);
        places
            .iter()
            .map(|zeta| middle.raised(more(own(zeta))))
            .collect()
    };
    let left = of_side(Side::Left);
    if g.params().modifications.are_symmetric() {
        return [left.clone(), left];
    }
    [left, of_side(Side::Right)]
}

/// Converts a position over the common width of a mesh to one over the width of one of its gears, both in [-1, 1].
fn own_place(l: &MeshLayout, width: f64, k: usize, zeta: f64) -> f64 {
    if l.heights[k] == 0.0 && l.face_width == width {
        return zeta;
    }
    (l.heights[k] + 0.5 * l.face_width * zeta) / (0.5 * width)
}

pub(super) fn varies_over_width(body: &Body) -> bool {
    match body {
        Body::Gear(g) => g.varies_over_width(),
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
    let hubs = [hub_of(a)?, hub_of(b)?];
    let of_hubs = hubs.each_ref();
    let planar = l.conical.is_none() && moves_in_plane(of_hubs);
    let in_space = is_in_space(of_hubs) || l.conical.is_some();
    if in_space && (is_internal(&a.body) || is_internal(&b.body)) {
        return Err(error(
            MeshPart::Layout,
            (
                "an internal gear meshes on axes that are not parallel, or on hubs that tilt",
                "fix the tilts of both gears: directions = { tilt_x = \"held\", tilt_y = \"held\" }",
            )
                .into(),
        ));
    }
    let sliced = if in_space { sliced_gear([a, b]) } else { 0 };
    let many = in_space || varies_over_width(&a.body) || varies_over_width(&b.body);
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
    let places: Vec<f64> = (0..count)
        .map(|i| (2 * i + 1) as f64 / count as f64 - 1.0)
        .collect();
    let separations = [0, 1].map(|k| separations(l, [a, b], &views, k, &places));
    let slices = (places.iter().enumerate())
        .map(|(i, &zeta)| {
            let along = 0.5 * l.face_width * zeta;
            // Helices of mates are opposite.
            let offset = |k: usize| (l.heights[k] + along) * base_helix.tan();
            let ahead = [offset(0), -offset(1)];
            let z = l.heights[sliced] + along;
            let conical = l
                .conical
                .as_deref()
                .map(|pair| Side::BOTH.map(|side| pair.section(sliced, side, z)));
            Slice {
                zeta,
                z,
                weight: 1.0 / count as f64,
                offset: conical.map_or([ahead, ahead.map(|x| -x)], |both| both.map(|of| of.1)),
                rolls: conical.map(|both| Box::new(both.map(|of| of.0))),
                separation: Side::BOTH
                    .map(|side| [0, 1].map(|k| separations[k][side.index()][i].clone())),
            }
        })
        .collect();
    let geometry = MeshGeometry {
        views,
        mesh_of_gear,
        centre_a: a.position.into(),
        axes: layout_axes(a, b),
        direction: l.direction,
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
    let mut search = LinesOfAction::new(geometry.clone(), curve, &law, slices);
    if planar {
        search = search.in_plane([a, b].map(|g| g.position.into()));
    }
    if in_space {
        search = search.in_space(Spatial::new(SpatialGeometry {
            flanks: [a, b].map(|g| match &g.body {
                Body::Gear(gear) => FlankForm::Involute(Box::new(Helicoid::new(gear))),
                Body::Rack(rack) => FlankForm::Plane(Plane::new(rack, rack.tip_height())),
            }),
            sliced,
            length: l.length,
            roll_scale: l
                .conical
                .as_ref()
                .map_or([[1.0; 2]; 2], |pair| pair.roll_scale()),
            base_pitch: l.base_pitch,
            phases: mesh.gears.map(|i| phases[i]),
        }));
    }
    Ok((search, law, geometry))
}

/// Largest angle between axes that count as parallel [rad].
const PARALLEL: f64 = 1e-12;

/// Returns true if hubs of gears on parallel axes move without tilt.
fn moves_in_plane(hubs: [&Hub; 2]) -> bool {
    let [a, b] = hubs;
    let holds = |hub: &Hub, d: usize| hub.directions()[d] == Direction::Fixed;
    let upright = |hub: &Hub| hub.slide.is_none() && holds(hub, 3) && holds(hub, 4);
    let moves = hubs.iter().any(|hub| hub.lateral.is_some());
    moves && hubs.into_iter().all(upright) && a.axes[2].cross(&b.axes[2]).norm() <= PARALLEL
}

/// Returns true if the flanks of cylindrical gears have to be evaluated in space, because the hubs tilt or the axes are not
/// parallel.
fn is_in_space(hubs: [&Hub; 2]) -> bool {
    let [a, b] = hubs.map(|hub| hub.axes[2]);
    let moves = hubs.iter().any(|hub| hub.lateral.is_some()) || a.cross(&b).norm() > PARALLEL;
    moves && !moves_in_plane(hubs)
}

/// Returns true if the gears of a mesh touch in space, because their hubs tilt or their axes are not parallel: contact then
/// varies over the width. Hubs that cannot be built touch nothing.
pub fn touches_in_space(spec: &SceneSpec, mesh: &MeshSpec) -> bool {
    let [a, b] = mesh.gears.map(|i| hub_of(&spec.gears[i]));
    a.is_ok_and(|a| b.is_ok_and(|b| is_in_space([&a, &b])))
}

/// Returns the gear of a mesh whose sections are the slices, independent of the order: the narrower one, otherwise
/// that of fewer teeth, otherwise by name; never a rack.
fn sliced_gear([a, b]: [&GearSpec; 2]) -> usize {
    let Body::Gear(_) = b.body else { return 0 };
    let order = |g: &GearSpec| {
        let teeth = match &g.body {
            Body::Gear(gear) => gear.teeth(),
            Body::Rack(_) => u32::MAX,
        };
        (g.body.face_width(), teeth)
    };
    let ((wa, za), (wb, zb)) = (order(a), order(b));
    let first = wa
        .total_cmp(&wb)
        .then(za.cmp(&zb))
        .then(a.name.cmp(&b.name));
    usize::from(first.is_gt())
}

/// Converts an error of the law of a mesh.
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
    if let Some(own) = &contact.normal_force {
        let (exponent, damping) = (contact.exponent, contact.damping.id());
        if exponent != 1.0 || contact.damping != Damping::None {
            return Err(error(
                MeshPart::NormalForce,
                (
                    format!(
                        "the law `{}` gives the whole normal force, but the contact also has the exponent {exponent} and the damping `{damping}`",
                        own.name()
                    ),
                    "remove exponent and damping: both belong into the function of the law",
                )
                    .into(),
            ));
        }
        return Ok(Law::of_program(own.clone()));
    }
    let mass = reduced_mass([hub_mass(a, &hub_of(a)?), hub_mass(b, &hub_of(b)?)]);
    let damping = match contact.damping {
        Damping::KelvinVoigtRatio { .. } => {
            if !mass.is_finite() {
                return Err(error(
                    MeshPart::Damping,
                    (
                        "a damping ratio needs a gear that can move, but both are fixed",
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

/// Returns the friction of a mesh; the coefficient of a film follows from load, curvature and speeds at the pitch
/// point.
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

/// Returns the largest force along the line of action from the loads on a mesh [N]: those on its own gears and their
/// shafts, otherwise those on any gear of the scene, whose torque the train transmits.
fn load_of(spec: &SceneSpec, mesh: &MeshSpec) -> f64 {
    let of = |i: usize| {
        let speed = initial_speed(&spec.gears[i]);
        let sum: f64 = spec.loads_at(i).map(|l| l.greatest(speed)).sum();
        sum / effective_radius(&spec.gears[i].body)
    };
    let own = mesh.gears.map(of);
    let own = own[0].max(own[1]);
    if own > 0.0 {
        return own;
    }
    (0..spec.gears.len()).map(of).fold(0.0, f64::max)
}

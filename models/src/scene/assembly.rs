//! Assembly of a scene: positions, initial angles, lines of action, models, loads.

use super::assembly_points::flank_points;
use super::channels;
use super::contacts::Workspace;
use super::nodal::Nodal;
use super::{Scene, SceneGear, SceneMesh};
use crate::Vec3;
use crate::contact::Search;
use crate::contact::pairs::{Deviation, LinesOfAction, MeshGeometry, Slice};
use crate::error::{BuildError, GearPart, MeshPart, Reason};
use crate::gear::table::{GearContext, Model};
use crate::gear::{LinearMotion, Magnitudes};
use crate::geometry::{Gear, Side};
use crate::kinematics::{Hub, MeshView, Placement};
use crate::law::{Damping, Law, LawError};
use crate::spec::{
    Body, ContactSpec, GearSpec, Load, MeshLayout, MeshSpec, Modelling, Mount, SceneSpec,
    effective_radius, mesh_layout, stiffness_curve,
};
use crate::stiffness::PairOrMesh;
use gearbench_integrators::system::State;

/// Slices of a mesh whose contact varies over the width.
const DEFAULT_SLICES: usize = 16;
/// Samples of a flank modification along the path.
const DEVIATION_SAMPLES: usize = 257;

/// How far points on surfaces through flank nodes may stand off what the nodes tell, over the base pitch; and what
/// rounding leaves.
const FLANK_BOUND: f64 = 1e-6;
const ROUNDING: f64 = 1e-9;

/// How gear a and gear b are seen by a mesh, given their phases (angle or displacement of tooth 0).
fn views(l: &MeshLayout, a: &GearSpec, b: &GearSpec, phase: [f64; 2]) -> [MeshView; 2] {
    let gear_view = |g: &Gear, direction: f64, path: [f64; 2], assembled: f64| MeshView {
        base_radius: Some(g.r_base()),
        direction,
        working_pressure_angle: l.working_pressure_angle,
        half_angle_base: g.half_angle_base(),
        path,
        pitch: g.pitch_angle(),
        assembled,
    };
    let other = [l.length - l.path[1], l.length - l.path[0]];
    let first = match &a.body {
        Body::Gear(g) => gear_view(g, l.direction, l.path, phase[0]),
        Body::Rack(_) => unreachable!("mesh_layout refuses a rack as the first gear"),
    };
    let second = match &b.body {
        Body::Gear(g) => gear_view(g, l.direction + std::f64::consts::PI, other, phase[1]),
        Body::Rack(r) => MeshView {
            base_radius: None,
            direction: 0.0,
            working_pressure_angle: l.working_pressure_angle,
            half_angle_base: r.half_thickness_reference(),
            path: other,
            pitch: r.pitch(),
            assembled: l.rack_offset + phase[1],
        },
    };
    [first, second]
}

/// Angle (or displacement) that puts a flank of tooth 0 at a path coordinate of its own.
fn phase_at(view: &MeshView, sign: f64, s: f64) -> f64 {
    match view.base_radius {
        Some(rb) => {
            view.direction + sign * (s / rb - view.working_pressure_angle - view.half_angle_base)
        }
        None => sign * (view.half_angle_base - s / view.working_pressure_angle.cos()),
    }
}

/// Places gears one mesh after another; returns the phase of each.
fn assemble(spec: &SceneSpec, layouts: &[MeshLayout]) -> Result<Vec<f64>, BuildError> {
    let mut phase: Vec<Option<f64>> = vec![None; spec.gears.len()];
    for (mesh, l) in spec.meshes.iter().zip(layouts) {
        let [ia, ib] = mesh.gears;
        let (a, b) = (&spec.gears[ia], &spec.gears[ib]);
        let sign = mesh.start.side.sign();
        let wanted = mesh.start.path_coordinate.unwrap_or(l.pitch_point);
        if !(l.path[0]..=l.path[1]).contains(&wanted) {
            return Err(BuildError::mesh(
                [&a.name, &b.name],
                MeshPart::Start,
                format!(
                    "the start lies at {wanted:.6e} m, outside the path of contact {:.6e} to {:.6e} m",
                    l.path[0], l.path[1]
                ),
            ));
        }
        let [va, vb] = views(l, a, b, [0.0, 0.0]);
        // The pitch in path coordinates brings a placed gear's tooth nearest to where the start is wanted.
        let nearest = |view: &MeshView, phase: f64, s: f64| {
            let placed = MeshView {
                assembled: phase,
                ..*view
            };
            let s0 = placed.path_coordinate(mesh.start.side, phase);
            s0 + ((s - s0) / l.base_pitch).round() * l.base_pitch
        };
        match (phase[ia], phase[ib]) {
            (None, None) => {
                phase[ia] = Some(phase_at(&va, sign, wanted));
                phase[ib] =
                    Some(phase_at(&vb, sign, l.length - wanted - mesh.start.gap) - l.rack_offset);
            }
            (Some(p), None) => {
                let s = nearest(&va, p, wanted);
                phase[ib] =
                    Some(phase_at(&vb, sign, l.length - s - mesh.start.gap) - l.rack_offset);
            }
            (None, Some(p)) => {
                let s = nearest(&vb, p + l.rack_offset, l.length - wanted);
                phase[ia] = Some(phase_at(&va, sign, l.length - s - mesh.start.gap));
            }
            (Some(_), Some(_)) => {}
        }
    }
    Ok(phase.into_iter().map(|p| p.unwrap_or(0.0)).collect())
}

/// Part of the base pitch that flanks may overlap by at the start: a mesh may start preloaded, but not with
/// teeth inside one another.
const LARGEST_OVERLAP: f64 = 0.01;

/// Refuses starts at which flanks overlap by more than a preload.
fn check_start(
    spec: &SceneSpec,
    mesh: &MeshSpec,
    l: &MeshLayout,
    loa: &LinesOfAction,
) -> Result<(), BuildError> {
    let [a, b] = mesh.gears.map(|i| &spec.gears[i]);
    for side in Side::BOTH {
        let gap = loa.assembled_gap(side);
        if gap >= -LARGEST_OVERLAP * l.base_pitch {
            continue;
        }
        let name = if side == Side::Left { "left" } else { "right" };
        return Err(BuildError::mesh(
            [&a.name, &b.name],
            MeshPart::Start,
            (
                format!(
                    "at the start the {name} flanks overlap by {:.4e} m (gap asked for: {:.4e} m, backlash along the line of action: {:.4e} m)",
                    -gap, mesh.start.gap, l.backlash
                ),
                "use a gap between 0 and the backlash, or, where other meshes place both gears, another position",
            ),
        ));
    }
    if !mesh.start.gap.is_finite() {
        return Err(BuildError::mesh(
            [&a.name, &b.name],
            MeshPart::Start,
            format!("the gap {} at the start is no number", mesh.start.gap),
        ));
    }
    Ok(())
}

fn deviation(body: &Body, own_path: [f64; 2], zeta: f64) -> Option<Deviation> {
    let Body::Gear(g) = body else { return None };
    if g.params().modifications.is_none() {
        return None;
    }
    let rb = g.r_base();
    Some(Deviation::sample(own_path, DEVIATION_SAMPLES, |s| {
        g.flank_deviation(rb.hypot(s), zeta)
    }))
}

fn varies_over_width(body: &Body) -> bool {
    match body {
        Body::Gear(g) => {
            g.params().helix_angle != 0.0 || g.params().modifications.lead_crowning != 0.0
        }
        Body::Rack(r) => r.params().helix_angle != 0.0,
    }
}

fn lines_of_action(
    spec: &SceneSpec,
    mesh: &MeshSpec,
    l: &MeshLayout,
    contact: &ContactSpec,
    phases: &[f64],
    mesh_of_gear: [u8; 2],
) -> Result<(LinesOfAction, MeshGeometry), BuildError> {
    let [a, b] = mesh.gears.map(|i| &spec.gears[i]);
    let error = |part, why: Reason| BuildError::mesh([&a.name, &b.name], part, why);
    let curve =
        stiffness_curve(a, b, l, contact).map_err(|e| error(MeshPart::Stiffness, e.reason()))?;
    let views = views(l, a, b, mesh.gears.map(|i| phases[i]));
    let many = varies_over_width(&a.body) || varies_over_width(&b.body);
    let count = contact
        .slices
        .unwrap_or(if many { DEFAULT_SLICES } else { 1 });
    if count == 0 || count > 1000 {
        return Err(error(
            MeshPart::Slices,
            (format!("{count} slices over the width"), "use 1 to 1000").into(),
        ));
    }
    let base_helix = match &a.body {
        Body::Gear(g) => g.base_helix_angle(),
        Body::Rack(r) => r.base_helix_angle(),
    };
    let slices = (0..count)
        .map(|i| {
            let zeta = (2 * i + 1) as f64 / count as f64 - 1.0;
            let z = 0.5 * l.face_width * zeta;
            Slice {
                zeta,
                z,
                weight: 1.0 / count as f64,
                offset: z * base_helix.tan(),
                deviation: [
                    deviation(&a.body, views[0].path, zeta),
                    deviation(&b.body, views[1].path, zeta),
                ],
            }
        })
        .collect();
    let whole_mesh = curve.of() == PairOrMesh::Mesh;
    let geometry = MeshGeometry {
        views,
        mesh_of_gear,
        centre_a: Vec3::new(a.position[0], a.position[1], 0.0),
        length: l.length,
        base_pitch: l.base_pitch,
        zone: l.path,
        base_helix,
    };
    let search = LinesOfAction::new(geometry.clone(), curve, whole_mesh, slices);
    Ok((search, geometry))
}

fn hub_of(g: &GearSpec) -> Result<Hub, BuildError> {
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

impl Scene {
    /// Assembles a scene with the given models.
    ///
    /// # Errors
    /// [`BuildError`] names the gear, mesh or parameter and a way out.
    pub fn build(
        spec: &SceneSpec,
        modelling: &Modelling,
        models: &[Model],
    ) -> Result<Scene, BuildError> {
        if modelling.gears.len() != spec.gears.len()
            || modelling.contacts.len() != spec.meshes.len()
        {
            return Err(BuildError::scene(format!(
                "{} gears and {} meshes, but {} models and {} contacts",
                spec.gears.len(),
                spec.meshes.len(),
                modelling.gears.len(),
                modelling.contacts.len()
            )));
        }
        let layouts = spec
            .meshes
            .iter()
            .map(|m| mesh_layout(&spec.gears[m.gears[0]], &spec.gears[m.gears[1]]))
            .collect::<Result<Vec<_>, _>>()?;
        let phases = assemble(spec, &layouts)?;
        let mut seen_by = vec![Vec::new(); spec.gears.len()];
        for (mesh, l) in spec.meshes.iter().zip(&layouts) {
            let [a, b] = mesh.gears.map(|i| &spec.gears[i]);
            let of_mesh = views(l, a, b, mesh.gears.map(|i| phases[i]));
            for (&i, view) in mesh.gears.iter().zip(of_mesh) {
                seen_by[i].push(view);
            }
        }

        let mut gears = Vec::new();
        for (g, model) in spec.gears.iter().zip(&modelling.gears) {
            for load in &g.loads {
                check_load(&g.name, load)?;
            }
            if let Mount::Driven(p) = &g.mount
                && let Some(problem) = p.problem()
            {
                return Err(BuildError::gear(
                    &g.name,
                    GearPart::Mount,
                    format!("driven motion: {problem}"),
                ));
            }
            let hub = hub_of(g)?;
            let row = models.iter().find(|m| m.id == model.id).ok_or_else(|| {
                let known: Vec<&str> = models.iter().map(|m| m.id).collect();
                BuildError::gear(
                    &g.name,
                    GearPart::Model,
                    (
                        format!("there is no model `{}`", model.id),
                        format!("there are {}", known.join(", ")),
                    ),
                )
            })?;
            let context = GearContext {
                name: &g.name,
                body: &g.body,
                material: g.material,
                hub: &hub,
                added_inertia: g.added_inertia,
                placement: Placement::new(&hub, phases[gears.len()]),
                effective_radius: effective_radius(&g.body),
                meshes: &seen_by[gears.len()],
                speed: initial_speed(g),
                parameters: &model.parameters,
            };
            gears.push(SceneGear {
                name: g.name.clone(),
                id: model.id.clone(),
                model: row.build(&context)?,
                loads: g.loads.clone(),
                offset: 0,
                n: 0,
                discrete: (0, 0),
                internal: true,
            });
        }

        let mut meshes = Vec::new();
        let mut seen = vec![0u8; spec.gears.len()];
        let mut scales = Scales::default();
        for ((mesh, l), contact) in spec.meshes.iter().zip(&layouts).zip(&modelling.contacts) {
            let [ia, ib] = mesh.gears;
            let of_gear = [seen[ia], seen[ib]];
            let (search, geometry) = lines_of_action(spec, mesh, l, contact, &phases, of_gear)?;
            for i in mesh.gears {
                seen[i] += 1;
            }
            check_start(spec, mesh, l, &search)?;
            for i in mesh.gears {
                // Pairs take turns in standing for the mesh: that is no jump only where all have one gap.
                if search.whole_mesh && gears[i].model.hub().own > 0 {
                    return Err(BuildError::mesh(
                        mesh.gears.map(|i| spec.gears[i].name.as_str()),
                        MeshPart::Stiffness,
                        (
                            format!(
                                "one stiffness for the whole mesh needs rigid gears, but gear `{}` is `{}`",
                                spec.gears[i].name, gears[i].id
                            ),
                            "give the stiffness of a tooth pair",
                        ),
                    ));
                }
            }
            let k_max = search.stiffness.maximum().1;
            scales.add(spec, mesh, &gears, k_max);
            let on_lines = search.clearances();
            let with_flanks = mesh
                .gears
                .iter()
                .any(|i| gears[*i].model.flanks().is_some());
            let (search, law, clearances): (Search, Law, _) = if with_flanks {
                let lines = Side::BOTH.map(|side| search.line(side));
                let (search, law) =
                    flank_points(spec, mesh, contact, &gears, &phases, &geometry, lines)?;
                // Nodes may stand off the involute: the foremost ones count.
                let clearances = search
                    .clearance([0.0; 2])
                    .map_or_else(Vec::new, |c| c.lines().to_vec());
                (Search::Points(Box::new(search)), law, clearances)
            } else {
                let law = law_of(spec, mesh, contact, k_max)?;
                (Search::Pairs(Box::new(search)), law, on_lines)
            };
            let has_field = |i: &usize| gears[*i].model.displacement().is_some();
            meshes.push(SceneMesh {
                gears: mesh.gears,
                search,
                law,
                friction: contact.friction,
                hard: contact.points.is_some_and(|p| p.hard) && mesh.gears.iter().any(has_field),
                nodal: mesh.gears.iter().any(has_field),
                clearances,
                gap_bound: (if with_flanks { FLANK_BOUND } else { ROUNDING }) * l.base_pitch,
                discrete: 0,
                event_functions: 0,
                cells: 0,
                slots: 0,
                zones: 0,
            });
        }
        refuse_two_laws(spec, &gears, &meshes)?;
        Ok(Self::lay_out(spec, gears, meshes, &scales, phases))
    }

    /// Offsets, initial state, buffers.
    fn lay_out(
        spec: &SceneSpec,
        mut gears: Vec<SceneGear>,
        mut meshes: Vec<SceneMesh>,
        scales: &Scales,
        phases: Vec<f64>,
    ) -> Scene {
        let (mut n, mut discrete, mut event_functions) = (0, 1, 0);
        for g in &mut gears {
            let hub = g.model.hub();
            (g.offset, g.n) = (n, hub.len());
            g.discrete = (discrete, hub.discrete);
            g.internal = hub.own > 0;
            n += hub.len();
            discrete += hub.discrete;
        }
        for m in &mut meshes {
            (m.discrete, m.event_functions) = (discrete, event_functions);
            if let Some(pairs) = m.search.pairs() {
                (m.cells, m.slots, m.zones) =
                    (pairs.discrete(), pairs.slots(), pairs.event_count());
            }
            discrete += m.cells + 2 * m.slots;
            event_functions += m.zones + m.slots;
        }
        let locates = meshes.iter().all(|m| m.search.pairs().is_some());
        if !locates {
            event_functions = 0;
        }
        let mut initial = State {
            t: 0.0,
            q: vec![0.0; n],
            v: vec![0.0; n],
            discrete: vec![0.0; discrete],
        };
        for (g, s) in gears.iter_mut().zip(&spec.gears) {
            let range = g.range();
            g.model.initialise(
                initial_speed(s),
                &mut initial.q[range.clone()],
                &mut initial.v[range],
                &mut initial.discrete[g.discrete.0..][..g.discrete.1],
            );
        }
        let characteristic_time = gears
            .iter()
            .map(|g| g.model.hub().characteristic_time)
            .fold(scales.characteristic_time, f64::min);
        let channels = channels::names(meshes.len(), gears.iter().map(|g| g.name.as_str()));
        let fields = gears.iter().any(|g| g.model.displacement().is_some());
        let nodal = Nodal::new(&gears, &meshes);
        let condenses = gears.iter().any(|g| g.model.large().is_some());
        let tracks = meshes.iter().any(|m| m.law.needs_impact_speed())
            || gears.iter().any(|g| g.model.follows_contact());
        let mut mass = vec![0.0; n];
        for g in &gears {
            g.model.hub().diagonal_mass(&mut mass[g.range()]);
        }
        let diagonal = gears.iter().all(|g| g.model.coupled_mass().is_none());
        let linear = |g: &SceneGear| {
            g.model
                .linear()
                .and_then(LinearMotion::oscillators)
                .is_some()
        };
        let oscillators = gears.iter().all(linear);
        let cuts_vibration = gears.iter().any(|g| g.model.hub().vibration_cut_off > 0.0);
        Scene {
            gears,
            meshes,
            oscillators,
            cuts_vibration,
            flights: Vec::new(),
            channels,
            magnitudes: scales.magnitudes(),
            characteristic_time,
            n,
            discrete,
            event_functions,
            fields,
            condenses,
            locates,
            tracks,
            inverse_mass: if diagonal {
                mass.iter().map(|m| m.recip()).collect()
            } else {
                Vec::new()
            },
            mass,
            work: Workspace {
                nodal,
                ..Workspace::default()
            },
            initial,
            phases,
        }
    }
}

/// Meshes that residual compliance couples are solved together, by one kind of law.
fn refuse_two_laws(
    spec: &SceneSpec,
    gears: &[SceneGear],
    meshes: &[SceneMesh],
) -> Result<(), BuildError> {
    for island in super::nodal::islands(gears, meshes) {
        let soft = island.meshes.iter().find(|m| !meshes[**m].hard);
        let hard = island.meshes.iter().find(|m| meshes[**m].hard);
        if let (Some(&soft), Some(&hard)) = (soft, hard) {
            let name = |m: usize, k: usize| spec.gears[meshes[m].gears[k]].name.as_str();
            return Err(BuildError::mesh(
                [name(hard, 0), name(hard, 1)],
                MeshPart::Contact,
                (
                    format!(
                        "its contact is hard, but that of `{}` and `{}`, coupled by the compliance of a gear, has a penalty",
                        name(soft, 0),
                        name(soft, 1)
                    ),
                    "give both the same law",
                ),
            ));
        }
    }
    Ok(())
}

/// Typical deflection, speed and time of the meshes of a scene.
#[derive(Clone, Copy, Debug)]
struct Scales {
    deflection: f64,
    speed: f64,
    characteristic_time: f64,
}

impl Default for Scales {
    fn default() -> Self {
        Scales {
            deflection: 0.0,
            speed: 0.0,
            characteristic_time: f64::INFINITY,
        }
    }
}

impl Scales {
    fn add(&mut self, spec: &SceneSpec, mesh: &MeshSpec, gears: &[SceneGear], k: f64) {
        let sides = mesh.gears.map(|i| (&spec.gears[i], &gears[i]));
        let mass = reduced_mass(sides.map(|(s, g)| hub_mass(s, g.model.hub())));
        let own = reduced_mass(sides.map(|(_, g)| g.model.hub().contact_mass));
        let along = sides.map(|(s, g)| {
            let speed = initial_speed(s);
            let force =
                s.loads.iter().map(|l| g.load_bound(l)).sum::<f64>() / effective_radius(&s.body);
            (speed * effective_radius(&s.body), force)
        });
        let fastest = along[0].0.abs().max(along[1].0.abs());
        // Gears mesh with opposite turning; a rack goes along with its gear.
        let closing = match sides[1].0.body {
            Body::Gear(_) => (along[0].0 + along[1].0).abs(),
            Body::Rack(_) => (along[0].0 - along[1].0).abs(),
        };
        let force = along[0].1.max(along[1].1);
        let m = if mass.is_finite() { mass } else { 1.0 };
        let speed = closing
            .max(force / (k * m).sqrt())
            .max(1e-3 * fastest)
            .max(1e-6);
        self.speed = self.speed.max(speed);
        self.deflection = self.deflection.max(speed * (m / k).sqrt());
        let light = if own.is_finite() { own.min(m) } else { m };
        self.characteristic_time = self.characteristic_time.min((light / k).sqrt());
    }

    fn magnitudes(&self) -> Magnitudes {
        Magnitudes {
            deflection: if self.deflection > 0.0 {
                self.deflection
            } else {
                1e-6
            },
            speed: if self.speed > 0.0 { self.speed } else { 1e-3 },
        }
    }
}

impl SceneGear {
    /// Largest magnitude of a load.
    fn load_bound(&self, load: &Load) -> f64 {
        match load {
            Load::Applied(p) => match p {
                crate::spec::Profile::Constant(x) => x.abs(),
                crate::spec::Profile::Ramp { from, to, .. } => from.abs().max(to.abs()),
                crate::spec::Profile::Table { value, .. } => {
                    value.iter().fold(0.0, |m, x| x.abs().max(m))
                }
            },
            Load::Viscous(_) => 0.0,
        }
    }
}

/// Speed of a hub at the start: a prescribed motion says itself how fast its gear moves.
fn initial_speed(g: &GearSpec) -> f64 {
    match &g.mount {
        Mount::Driven(p) => p.value(0.0),
        Mount::Fixed => 0.0,
        Mount::Revolute | Mount::Prismatic => g.speed,
    }
}

/// Mass along the line of action that a hub stands for [kg]; infinite when it is held.
fn hub_mass(spec: &GearSpec, hub: &Hub) -> f64 {
    if hub.coordinates() == 0 {
        f64::INFINITY
    } else {
        hub.inertia / effective_radius(&spec.body).powi(2)
    }
}

fn reduced_mass(m: [f64; 2]) -> f64 {
    1.0 / (1.0 / m[0] + 1.0 / m[1])
}

fn check_load(gear: &str, load: &Load) -> Result<(), BuildError> {
    let problem = match load {
        Load::Applied(p) => p.problem(),
        Load::Viscous(c) if !(c.is_finite() && *c >= 0.0) => {
            Some(format!("viscous coefficient {c} is not zero or positive"))
        }
        Load::Viscous(_) => None,
    };
    match problem {
        Some(p) => Err(BuildError::gear(gear, GearPart::Load, format!("load: {p}"))),
        None => Ok(()),
    }
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
    let damping = match contact.damping {
        Damping::KelvinVoigtRatio { .. } => {
            let mass = reduced_mass([hub_mass(a, &hub_of(a)?), hub_mass(b, &hub_of(b)?)]);
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
    Law::new(contact.exponent, damping).map_err(|e| law_error([&a.name, &b.name], &e))
}

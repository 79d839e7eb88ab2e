//! Assembly of a scene: positions, initial angles, lines of action, models, loads.

use super::assembled::Scene;
use super::assembly_lines::{flank_lines, is_half_space, lines_of, strips};
use super::assembly_points::flank_points;
use super::carriers::{Carriers, PlanetarySets, grounded};
use super::channels;
use super::checks::{check_contacts, check_load, refuse_two_laws, refuse_user_law};
use super::direct::FlankMotion;
use super::hubs::hub_of;
use super::members::{ActingFlanks, SceneGear, SceneMesh};
use super::mesh_assembly::{friction_of, lines_of_action};
use super::nodal::Nodal;
use super::placement::{assemble, check_start, views};
use super::scales::{Scales, initial_speed};
use super::shafts::{CELLS, Guided, Plan, ShaftBody, Shafts, guides};
use super::workspace::Workspace;
use crate::contact::Search;
use crate::contact::pairs::{LinesOfAction, PairList};
use crate::error::{BuildError, GearPart, MeshPart};
use crate::gear::LinearMotion;
use crate::gear::table::{GearContext, Model};
use crate::geometry::Side;
use crate::kinematics::Placement;
use crate::law::{Law, UNTOUCHED};
use crate::spec::{
    Body, Modelling, Mount, SceneSpec, effective_radius, mesh_layout, signed_effective_radius,
};
use gearbench_integrators::system::State;

/// Largest deviation of surfaces through flank nodes from the positions of the nodes, relative to the base pitch, and
/// that of rounding.
const FLANK_BOUND: f64 = 1e-6;
const ROUNDING: f64 = 1e-9;

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
        let (freed, sets) = grounded(spec)?;
        let given = spec;
        let (with_shafts, mut plan) = Plan::of(&freed)?;
        let spec = with_shafts.as_ref();
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

        let slides = |gear: usize| {
            let mut meshes = spec.meshes.iter().zip(&modelling.contacts);
            meshes.any(|(mesh, contact)| contact.friction.is_some() && mesh.gears.contains(&gear))
        };
        // What needs no mesh of a gear is refused before gears are meshed, which takes seconds to minutes.
        let (mut hubs, mut rows) = (Vec::new(), Vec::new());
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
            hubs.push(hub_of(g)?);
            rows.push(models.iter().find(|m| m.id == model.id()).ok_or_else(|| {
                let known: Vec<&str> = models.iter().map(|m| m.id).collect();
                BuildError::gear(
                    &g.name,
                    GearPart::Model,
                    (
                        format!("there is no model `{}`", model.id()),
                        format!("there are {}", known.join(", ")),
                    ),
                )
            })?);
        }
        plan.check_models(spec, &hubs, &rows)?;
        sets.check_models(spec, &rows)?;
        check_contacts(spec, modelling)?;

        let mut gears: Vec<SceneGear> = Vec::new();
        for (i, (g, model)) in spec.gears.iter().zip(&modelling.gears).enumerate() {
            let hub = &hubs[i];
            let context = GearContext {
                name: &g.name,
                body: &g.body,
                material: g.material,
                hub,
                added_inertia: g.added_inertia + g.body.core_inertia(g.material.density),
                placement: Placement::new(hub, phases[i]),
                effective_radius: effective_radius(&g.body),
                meshes: &seen_by[i],
                slides: slides(i),
                lines: lines_of(spec, modelling, i),
                speed: initial_speed(g),
                time_of_first_teeth: spec.time_of_first_teeth(),
                model,
            };
            let built = (rows[i].build)(&context).map_err(|e| e.of_gear(&g.name))?;
            gears.push(SceneGear::new(&g.name, model.id(), built, &g.loads));
        }
        gears.extend(plan.bodies.iter().map(ShaftBody::member));
        plan.check(&gears)?;
        plan.guides = guides(given, &gears)?;
        sets.check(&gears)?;

        let mut meshes = Vec::new();
        let mut seen = vec![0u8; spec.gears.len()];
        let mut scales = Scales::default();
        for ((mesh, l), contact) in spec.meshes.iter().zip(&layouts).zip(&modelling.contacts) {
            let [ia, ib] = mesh.gears;
            let of_gear = [seen[ia], seen[ib]];
            let strips = if is_half_space(contact) {
                Some(strips(spec, modelling, mesh, &gears)?)
            } else {
                None
            };
            let (search, law, geometry) =
                lines_of_action(spec, mesh, l, (contact, strips), &phases, of_gear)?;
            for i in mesh.gears {
                seen[i] += 1;
            }
            check_start(spec, mesh, l, &search, of_gear.iter().all(|n| *n > 0))?;
            for i in mesh.gears {
                // Pairs take turns in standing for the mesh: that is no jump only where all have one gap.
                if search.whole_mesh && gears[i].model.hub().own > 0 {
                    let error = BuildError::mesh(
                        spec.names_of(mesh.gears),
                        MeshPart::Stiffness,
                        (
                            format!(
                                "one stiffness for the whole mesh needs rigid gears, but gear `{}` is `{}`",
                                spec.gears[i].name, gears[i].id
                            ),
                            "give the stiffness of a tooth pair",
                        ),
                    );
                    return Err(error.of_model());
                }
            }
            let deviates =
                |i: &usize| matches!(&spec.gears[*i].body, Body::Gear(g) if g.deviates());
            if search.whole_mesh && mesh.gears.iter().any(deviates) {
                return Err(BuildError::mesh(
                    spec.names_of(mesh.gears),
                    MeshPart::Stiffness,
                    (
                        "one stiffness for the whole mesh needs equal teeth, but teeth deviate from each other",
                        "give the stiffness of a tooth pair",
                    ),
                ));
            }
            let k_max = search.stiffness.maximum().1;
            scales.add(spec, mesh, &gears, k_max);
            let on_lines = search.clearances();
            let acting = Side::BOTH.map(|side| ActingFlanks {
                middle: search.middle_of(side),
                gap: search.assembled_gap(side),
            });
            let with_flanks = mesh
                .gears
                .iter()
                .any(|i| gears[*i].model.flanks().is_some());
            let has_pairs = strips.is_none() && !with_flanks;
            refuse_user_law(spec.names_of(mesh.gears), contact, has_pairs)?;
            let (search, law, clearances): (Search, Law, _) = if strips.is_some() {
                let (lines, law) = flank_lines(spec, mesh, l, contact, &gears, (search, law))?;
                (Search::Lines(Box::new(lines)), law, on_lines)
            } else if with_flanks {
                let lines = Side::BOTH.map(|side| search.line(side));
                let (search, law) = flank_points(
                    spec,
                    mesh,
                    contact,
                    &gears,
                    &phases,
                    &geometry,
                    (lines, law),
                )?;
                // Nodes may deviate from the involute; those that protrude most determine the contact.
                let clearances = search
                    .clearance([0.0; 2])
                    .map_or_else(Vec::new, |c| c.lines().to_vec());
                (Search::Points(Box::new(search)), law, clearances)
            } else {
                (Search::Pairs(Box::new(search)), law, on_lines)
            };
            let has_field = |i: &usize| gears[*i].model.displacement().is_some();
            let hard = contact.flanks.is_hard() && mesh.gears.iter().any(has_field);
            let nodal = mesh.gears.iter().any(has_field) || search.lines().is_some();
            let towards = mesh.gears.map(|i| {
                let sign = signed_effective_radius(&spec.gears[i].body).signum();
                sign * gears[i].model.hub().effective_base_radius
            });
            meshes.push(SceneMesh {
                gears: mesh.gears,
                towards,
                acting,
                axis: geometry.axes[2],
                search,
                law,
                retardation: if hard {
                    0.0
                } else {
                    retardation_of(mesh.gears.map(|g| &gears[g]))
                },
                friction: friction_of(spec, mesh, l, contact),
                hard,
                nodal,
                arms: None,
                bodies: false,
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
        let joined = (&plan, &sets);
        Ok(Self::lay_out(
            spec,
            gears,
            meshes,
            (&scales, joined),
            phases,
        ))
    }

    /// Computes offsets, initial state and buffers.
    fn lay_out(
        spec: &SceneSpec,
        mut gears: Vec<SceneGear>,
        mut meshes: Vec<SceneMesh>,
        (scales, (plan, sets)): (&Scales, (&Plan, &PlanetarySets)),
        phases: Vec<f64>,
    ) -> Scene {
        let (mut n, mut discrete, mut event_functions) = (0, 1, 0);
        for g in &mut gears {
            let hub = g.model.hub();
            (g.offset, g.n) = (n, hub.len());
            g.discrete = (discrete, hub.discrete);
            g.internal = hub.is_internal();
            n += hub.len();
            discrete += hub.discrete;
            g.note_load();
        }
        for m in &mut meshes {
            (m.discrete, m.event_functions) = (discrete, event_functions);
            if let Some(pairs) = m.search.pairs() {
                (m.cells, m.slots, m.zones) =
                    (pairs.discrete(), pairs.slots(), pairs.event_count());
            }
            discrete += m.cells + 2 * m.slots;
            if let Some(f) = &mut m.friction {
                f.discrete = discrete;
                discrete += f.cells();
            }
            event_functions += m.zones + m.slots;
        }
        let of_guides = discrete;
        discrete += CELLS * plan.guides.len();
        let guide_events = event_functions;
        event_functions += plan.guides.iter().map(Guided::events).sum::<usize>();
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
        for m in &meshes {
            for slot in 0..m.slots {
                initial.discrete[m.slot(slot) + 1] = UNTOUCHED;
            }
        }
        let speeds = spec.gears.iter().map(initial_speed);
        let speeds = speeds.chain(plan.bodies.iter().map(|b| b.speed));
        for (g, speed) in gears.iter_mut().zip(speeds) {
            let range = g.range();
            g.model.initialise(
                speed,
                &mut initial.q[range.clone()],
                &mut initial.v[range],
                &mut initial.discrete[g.discrete.0..][..g.discrete.1],
            );
        }
        for g in &mut gears {
            g.follows = FlankMotion::of(g, &initial.discrete[g.discrete.0..][..g.discrete.1]);
            g.places = g.model.teeth().map_or(0, |teeth| teeth.places());
        }
        for m in &mut meshes {
            m.note_directness(&gears);
        }
        let characteristic_time = gears
            .iter()
            .map(|g| g.model.hub().characteristic_time)
            .fold(scales.characteristic_time, f64::min);
        let channels = channels::names(&meshes, &gears, plan.spans);
        let pair_lists = meshes.iter().map(|_| PairList::default()).collect();
        let fields = meshes.iter().any(|m| m.nodal);
        let nodal = Nodal::new(&gears, &meshes);
        let spatial = |m: &SceneMesh| m.search.pairs().is_some_and(LinesOfAction::is_spatial);
        let in_space = meshes.iter().any(spatial);
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
        let one_mass = |i: &usize| {
            let model = &gears[*i].model;
            model.displacement().is_some() || (model.teeth().is_none() && model.flanks().is_none())
        };
        let mut damped = meshes.iter().filter(|m| m.nodal && m.dissipates());
        // The ports of a half-step impulse have one degree of freedom per hub.
        let sideways = gears.iter().any(|g| g.model.hub().lateral.is_some());
        let implicit_dissipation = diagonal
            && sets.is_empty()
            && !sideways
            && damped.clone().next().is_some()
            && damped.all(|m| m.gears.iter().all(one_mass));
        let sticks = |m: &SceneMesh| m.friction.as_ref().is_some_and(|f| f.law.sticks());
        let remembers = meshes.iter().any(sticks);
        let mut shafts = Shafts::new(
            plan,
            &sets.ground,
            &gears,
            (&mass, of_guides, scales.magnitudes().speed),
        );
        let carriers = Carriers::new(sets, &gears);
        carriers.carry_along(&mut initial);
        let mut scene = Scene {
            oscillators: carriers.is_empty() && gears.iter().all(linear),
            gears,
            meshes,
            shafts: Shafts::default(),
            carriers,
            flights: Vec::new(),
            channels,
            magnitudes: scales.magnitudes(),
            characteristic_time: characteristic_time.min(shafts.characteristic_time),
            n,
            discrete,
            event_functions,
            guide_events,
            fields,
            in_space,
            condenses,
            // Gears joined by a rigid shaft share one mass.
            implicit_dissipation: implicit_dissipation && shafts.rigid().is_empty(),
            remembers,
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
                pair_lists,
                ..Workspace::default()
            },
            initial,
            balanced: false,
            phases,
        };
        shafts.note_masses(&scene.inverse_mass);
        scene.shafts = shafts;
        scene.oscillators &= !scene.rigid_shafts_swing();
        scene
    }
}

/// Returns the retardation time of the flanks of a mesh [s]: the mean of those of its gears that are elastic bodies.
fn retardation_of(gears: [&SceneGear; 2]) -> f64 {
    let elastic = |g: &&SceneGear| g.model.flanks().is_some();
    let of = |g: &SceneGear| g.model.hub().retardation;
    let own: Vec<f64> = (gears.into_iter().filter(elastic)).map(of).collect();
    own.iter().sum::<f64>() / own.len().max(1) as f64
}

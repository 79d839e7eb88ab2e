//! The motion of a scene for the report: poses, displaced teeth and contacts at some states.
//!
//! The states of a run are those that its history keeps, more of them in contact than in free flight. Everything is evaluated
//! after the run, so that the time of the run does not contain it. Contacts of one tooth pair are summed over the profile in
//! slices across the width: a slice has the sum of the forces, their centre, and the largest pressure. Natural modes have the
//! state at rest `q_0` and the amplitudes `q_0 + a phi`, without contacts, and teeth displaced from their places at rest. Reduced
//! gears know displacements along the normal of the flanks; along the profile a tooth then moves as its rigid motion does.

use super::history::History;
use super::mechanism::{bearings, plain_bodies, shafts};
use super::record::tooth_numbers;
use crate::small_signals::motions::scaled;
use gearbench_integrators::State;
use gearbench_models::geometry::swept::PitchSections;
use gearbench_models::geometry::{SMOOTH_FLANK, Side};
use gearbench_models::kinematics::Tooth;
use gearbench_models::scene::{ContactExtent, ContactForce, DeformedFlank, Scene};
use gearbench_models::spec::{Body, SceneSpec, UPRIGHT, mesh_layout};
use gearbench_reports::record::{
    BodyPath, FlankValue, FrameContacts, FramePose, GearMotion, OUTLINE, Quantised,
    ToothDisplacements, ToothedBody,
};
use nalgebra::{Matrix3, Vector3};

/// Points per flank of a body whose sections differ: it is drawn in space only.
const IN_SPACE: usize = 32;
/// Largest number of teeth of a gear that have displacements in all frames; of more only those near a contact have.
const ALL_FRAMES: usize = 14;
/// Largest number of values of displaced teeth in modes, in a plane and in space: about 0.4 MB and 1.3 MB in a page.
const MOST_NUMBERS: [usize; 2] = [150_000, 500_000];
/// Largest number of slices of a tooth pair in space.
const MOST_SLICES: usize = 24;
/// Heights that differ by less than this share of the width belong to one slice.
const SAME_HEIGHT: f64 = 1e-5;

/// Returns the toothed bodies of a scene.
pub fn bodies(spec: &SceneSpec) -> Vec<ToothedBody> {
    let of = |g: &gearbench_models::spec::GearSpec| {
        let (sections, is_prism) = match &g.body {
            Body::Gear(gear) => {
                let prism = gear.params().helix_angle == 0.0 && !gear.is_conical();
                let points = if prism { SMOOTH_FLANK } else { IN_SPACE };
                (PitchSections::gear(gear, points), prism)
            }
            Body::Rack(rack) => {
                let prism = rack.params().helix_angle == 0.0;
                (PitchSections::rack(rack, SMOOTH_FLANK / 2), prism)
            }
        };
        let stored = if is_prism { 1 } else { sections.outlines.len() };
        let points = sections.outlines.iter().take(stored).flatten().flatten();
        let points: Vec<f64> = points.copied().collect();
        let body = ToothedBody {
            gear: g.name.clone(),
            heights_m: sections.heights,
            is_prism,
            points_m: Quantised::of(&points, OUTLINE),
            ..ToothedBody::default()
        };
        match &g.body {
            Body::Gear(gear) => ToothedBody {
                teeth: gear.teeth(),
                pitch: gear.pitch_angle(),
                is_internal: gear.is_internal(),
                back_m: match gear.is_internal() {
                    true => gear.r_outer(),
                    false => gear.params().bore_radius,
                },
                ..body
            },
            Body::Rack(rack) => ToothedBody {
                teeth: rack.teeth(),
                first_tooth: rack.first_tooth(),
                is_rack: true,
                pitch: rack.pitch(),
                back_m: rack.root_depth() + rack.params().body_height,
                ..body
            },
        }
    };
    spec.gears.iter().map(of).collect()
}

/// Returns the motion of a run at the states of its history.
pub fn motion_of_run(spec: &SceneSpec, scene: &mut Scene, history: &History) -> GearMotion {
    let mut states: Vec<&State> = (history.instants.states.iter())
        .chain(&history.flight.states)
        .chain(&history.peak_state)
        .collect();
    states.sort_by(|a, b| a.t.total_cmp(&b.t));
    states.dedup_by(|b, a| b.t <= a.t);
    motion(spec, scene, states)
}

/// Returns modes as a motion: frame 0 is the state at rest, frame k the amplitude of the k-th of some displacements of the
/// coordinates. Modes whose data would be too large are left out.
pub fn motion_of_modes(
    spec: &SceneSpec,
    scene: &mut Scene,
    rest: &State,
    shapes: &[Vec<f64>],
) -> GearMotion {
    let moved = |x: &Vec<f64>| {
        let mut state = rest.clone();
        state.q.iter_mut().zip(x).for_each(|(q, x)| *q += x);
        scene.follow_carriers(&mut state);
        state
    };
    let moved: Vec<State> = shapes.iter().map(moved).collect();
    let states: Vec<&State> = std::iter::once(rest).chain(&moved).collect();
    let touching = scene.contact_forces(rest.at());
    let mut motion = placed(spec, scene, &states);
    // Modes have no times; contacts of the state at rest are not part of them.
    motion.contacts = FrameContacts {
        counts: vec![0; states.len()],
        ..contacts(spec, scene, (&[], &[]), 1)
    };
    motion.teeth = (0..motion.bodies.len())
        .filter_map(|gear| {
            let is_elastic = scene.gears()[gear].model.surface().is_some();
            let own = match is_elastic {
                true => (0..motion.bodies[gear].teeth).collect(),
                false => teeth_in_contact(spec, &touching, (gear, 0)),
            };
            let mut by_frame = vec![own; states.len()];
            by_frame[0].clear();
            let of = Displaced {
                states: &states,
                by_frame,
                forces: std::slice::from_ref(&touching),
                from_rest: true,
            };
            displacements(spec, scene, of, &motion, gear)
        })
        .collect();
    let each = |t: &ToothDisplacements| t.teeth.len() * t.heights_m.len() * t.rows_m.len() * 4;
    let numbers = motion.teeth.iter().map(each).sum::<usize>() / shapes.len().max(1);
    let fits = MOST_NUMBERS[usize::from(!motion.is_plane())] / numbers.max(1);
    match shapes.len() > fits.max(1) {
        true => motion_of_modes(spec, scene, rest, &shapes[..fits.max(1)]),
        false => motion,
    }
}

/// Returns a single mode as a motion: the state at rest, and the amplitude for a largest displacement at a flank of 1 um.
pub fn motion_of_mode(spec: &SceneSpec, scene: &mut Scene, rest: &State, x: &[f64]) -> GearMotion {
    let x = scaled(scene, x);
    motion_of_modes(spec, scene, rest, &[x])
}

/// Returns the motion of a scene at states in ascending order of time.
fn motion(spec: &SceneSpec, scene: &mut Scene, mut states: Vec<&State>) -> GearMotion {
    let mut forces: Vec<Vec<ContactForce>> = Vec::with_capacity(states.len());
    states.retain(|s| {
        let here = scene.contact_forces(s.at());
        let sound = |f: &ContactForce| f.force.iter().chain(f.x.iter()).all(|x| x.is_finite());
        let keep = s.q.iter().all(|x| x.is_finite()) && here.iter().all(sound);
        if keep {
            forces.push(here);
        }
        keep
    });
    let mut motion = GearMotion {
        time_s: states.iter().map(|s| s.t).collect(),
        ..placed(spec, scene, &states)
    };
    let slices = if motion.is_plane() { 1 } else { MOST_SLICES };
    motion.contacts = contacts(spec, scene, (&states, &forces), slices);
    motion.teeth = (0..motion.bodies.len())
        .filter_map(|i| {
            let of = Displaced {
                states: &states,
                by_frame: displaced_teeth(spec, scene, &forces, i),
                forces: &forces,
                from_rest: false,
            };
            displacements(spec, scene, of, &motion, i)
        })
        .collect();
    motion
}

/// Returns the bodies of a scene with their poses at some states.
fn placed(spec: &SceneSpec, scene: &mut Scene, states: &[&State]) -> GearMotion {
    let (bodies, plain_bodies) = (bodies(spec), plain_bodies(spec));
    let members = bodies.len() + plain_bodies.len();
    let paths: Vec<BodyPath> = (0..members).map(|i| path(scene, i, states)).collect();
    let view = scene.gears().first().map(|g| g.model.hub().hub.axes);
    GearMotion {
        view: view.unwrap_or(UPRIGHT).map(|a| [a.x, a.y, a.z]),
        bodies,
        paths,
        plain_bodies,
        shafts: shafts(spec),
        bearings: bearings(spec),
        meshes: spec.meshes.iter().map(|m| m.gears).collect(),
        ..GearMotion::default()
    }
}

fn path(scene: &mut Scene, gear: usize, states: &[&State]) -> BodyPath {
    let poses: Vec<FramePose> = (states.iter())
        .map(|s| {
            let pose = scene.pose(s.at(), gear);
            FramePose {
                axes: pose.axes.map(|a| [a.x, a.y, a.z]),
                origin_m: [pose.origin.x, pose.origin.y, pose.origin.z],
            }
        })
        .collect();
    let g = &scene.gears()[gear];
    let turned = states
        .iter()
        .map(|s| g.model.hub_state(g.at(s.at())).displacement);
    // The rotation is counted about the axis of the gear, which may point against that of the scene.
    let turned: Vec<f64> = turned.collect();
    BodyPath::of(&poses, &turned)
}

/// A slice of a line of contact.
struct Slice {
    force: gearbench_models::Vec3,
    place: gearbench_models::Vec3,
    normal: f64,
    width: f64,
    half_width: f64,
    /// Largest pressure, where all contacts have one [Pa].
    pressure: Option<f64>,
}

/// Sums contacts of one tooth pair at one height.
fn slice(contacts: &[&ContactForce], width: f64) -> Slice {
    let mut sum = Slice {
        force: gearbench_models::Vec3::zeros(),
        place: gearbench_models::Vec3::zeros(),
        normal: 0.0,
        width,
        half_width: 0.0,
        pressure: Some(0.0),
    };
    let mut area = 0.0;
    for f in contacts {
        sum.force += f.force;
        sum.place += f.normal_force * f.x;
        sum.normal += f.normal_force;
        let own = match (f.pressure, f.extent) {
            (Some(line), _) => {
                sum.half_width = sum.half_width.max(line.half_width);
                Some(line.peak)
            }
            // With equal weights of the nodes an area of 1 means that no area is known.
            (None, ContactExtent::Area(a)) if a < 1.0 => {
                area += a;
                Some(f.normal_force / a)
            }
            _ => None,
        };
        sum.pressure = sum.pressure.zip(own).map(|(a, b)| f64::max(a, b));
    }
    sum.place /= sum.normal.max(f64::MIN_POSITIVE);
    if area > 0.0 && width > 0.0 {
        sum.half_width = 0.5 * area / width;
    }
    sum
}

/// Returns the contacts of all frames.
fn contacts(
    spec: &SceneSpec,
    scene: &mut Scene,
    (states, forces): (&[&State], &[Vec<ContactForce>]),
    most: usize,
) -> FrameContacts {
    let widths: Vec<f64> = (spec.meshes.iter())
        .map(|m| {
            let [a, b] = m.gears.map(|i| &spec.gears[i]);
            mesh_layout(a, b).map_or(0.0, |l| l.face_width)
        })
        .collect();
    let mut all = FrameContacts::default();
    let mut slices: Vec<Slice> = Vec::new();
    for (state, forces) in states.iter().zip(forces) {
        let before = slices.len();
        let mut pairs: Vec<(usize, [i64; 2], Side)> = Vec::new();
        for f in forces {
            let pair = (f.mesh, f.teeth.map(|t| t.index), f.side);
            if !pairs.contains(&pair) {
                pairs.push(pair);
            }
        }
        for (mesh, teeth, side) in pairs {
            let frame = scene.pose(state.at(), spec.meshes[mesh].gears[0]);
            let mut own: Vec<(f64, &ContactForce)> = (forces.iter())
                .filter(|f| (f.mesh, f.teeth.map(|t| t.index), f.side) == (mesh, teeth, side))
                .map(|f| (frame.height(&f.x), f))
                .collect();
            own.sort_by(|a, b| a.0.total_cmp(&b.0));
            let width = widths[mesh];
            let mut columns: Vec<Vec<&ContactForce>> = Vec::new();
            let mut last = f64::NEG_INFINITY;
            for (height, f) in own {
                match columns.last_mut() {
                    Some(column) if height - last < SAME_HEIGHT * width => column.push(f),
                    _ => columns.push(vec![f]),
                }
                last = height;
            }
            // Neighbouring columns are joined to bound the number of slices.
            let joined = columns.len().div_ceil(most);
            let share = |column: &[&ContactForce]| match column[0].extent {
                ContactExtent::Width(share) => share * width,
                ContactExtent::Area(_) => width / columns.len() as f64,
            };
            for group in columns.chunks(joined) {
                let across = group.iter().map(|c| share(c)).sum();
                let members: Vec<&ContactForce> = group.iter().flatten().copied().collect();
                slices.push(slice(&members, across));
                all.meshes.push(mesh + 1);
                all.teeth.push(tooth_numbers(spec, mesh, teeth));
                all.sides.push(u8::from(side == Side::Right));
            }
        }
        all.counts.push(slices.len() - before);
    }
    let pressed = slices.iter().all(|s| s.pressure.is_some());
    all.value = match pressed {
        true => FlankValue::Pressure,
        false => FlankValue::LineLoad,
    };
    let three = |of: fn(&Slice) -> gearbench_models::Vec3| -> Vec<f64> {
        let all = slices.iter().map(of);
        all.flat_map(|x| [x.x, x.y, x.z]).collect()
    };
    let one = |of: &dyn Fn(&Slice) -> f64| {
        let values: Vec<f64> = slices.iter().map(of).collect();
        Quantised::relative(&values)
    };
    all.points_m = Quantised::of(&three(|s| s.place), 1e-7);
    all.forces_n = Quantised::relative(&three(|s| s.force));
    all.widths_m = one(&|s| s.width);
    all.half_widths_m = one(&|s| s.half_width);
    all.values = one(&|s| match (pressed, s.pressure) {
        (true, Some(p)) => p,
        _ if s.width > 0.0 => s.normal / s.width,
        _ => 0.0,
    });
    all
}

/// Returns the teeth of a gear in contact with so many neighbours on either side, ascending.
fn teeth_in_contact(
    spec: &SceneSpec,
    forces: &[ContactForce],
    (gear, around): (usize, i64),
) -> Vec<u32> {
    let number = |index: i64| match &spec.gears[gear].body {
        Body::Gear(g) => Some(index.rem_euclid(i64::from(g.teeth())) as u32),
        // The teeth of a rack have ends.
        Body::Rack(r) => (r.first_tooth()..r.first_tooth() + i64::from(r.teeth()))
            .contains(&index)
            .then(|| index.rem_euclid(i64::from(r.teeth())) as u32),
    };
    let mut near: Vec<u32> = Vec::new();
    for f in forces {
        for k in (0..2).filter(|k| spec.meshes[f.mesh].gears[*k] == gear) {
            near.extend((-around..=around).filter_map(|by| number(f.teeth[k].index + by)));
        }
    }
    near.sort_unstable();
    near.dedup();
    near
}

/// Returns the teeth of a gear that a displacement is recorded of in a run, by frame.
fn displaced_teeth(
    spec: &SceneSpec,
    scene: &Scene,
    forces: &[Vec<ContactForce>],
    gear: usize,
) -> Vec<Vec<u32>> {
    let around = i64::from(scene.gears()[gear].model.surface().is_some());
    let mut each: Vec<Vec<u32>> = (forces.iter())
        .map(|forces| teeth_in_contact(spec, forces, (gear, around)))
        .collect();
    let mut union: Vec<u32> = each.iter().flatten().copied().collect();
    union.sort_unstable();
    union.dedup();
    if union.len() <= ALL_FRAMES {
        each.iter_mut().for_each(|own| own.clone_from(&union));
    }
    each
}

/// Teeth whose displacements are recorded.
struct Displaced<'a> {
    /// States of the frames.
    states: &'a [&'a State],
    /// Teeth by frame.
    by_frame: Vec<Vec<u32>>,
    /// Contacts of some states, which contain all teeth on springs that are in contact.
    forces: &'a [Vec<ContactForce>],
    /// True if displacements count from those of the first state.
    from_rest: bool,
}

/// Returns the displacements of the teeth of a gear; `None` of a gear with rigid teeth.
fn displacements(
    spec: &SceneSpec,
    scene: &mut Scene,
    of: Displaced<'_>,
    motion: &GearMotion,
    gear: usize,
) -> Option<ToothDisplacements> {
    let model = &scene.gears()[gear].model;
    let (is_elastic, springs) = (model.surface().is_some(), model.teeth().is_some());
    let Displaced {
        states,
        by_frame,
        forces,
        from_rest,
    } = of;
    let first = by_frame.iter().flatten().next().copied();
    let (Some(first), true) = (first, is_elastic || springs) else {
        return None;
    };
    let body = &motion.bodies[gear];
    let ends = [
        body.heights_m.first().copied()?,
        body.heights_m.last().copied()?,
    ];
    let heights = match motion.is_plane() || !is_elastic {
        true => vec![0.5 * (ends[0] + ends[1])],
        false => vec![ends[0], 0.5 * (ends[0] + ends[1]), ends[1]],
    };
    let mut found = ToothDisplacements {
        body: gear,
        is_elastic,
        heights_m: heights.clone(),
        counts: by_frame.iter().map(Vec::len).collect(),
        teeth: by_frame.concat(),
        ..ToothDisplacements::default()
    };
    if !is_elastic {
        found.rows_m = spring_rows(&spec.gears[gear].body);
        let mut known: Vec<Tooth> = Vec::new();
        for f in forces.iter().flatten() {
            for k in (0..2).filter(|k| spec.meshes[f.mesh].gears[*k] == gear) {
                if !known.contains(&f.teeth[k]) {
                    known.push(f.teeth[k]);
                }
            }
        }
        let of_gear = (gear, &*known, body.teeth);
        let mut values = Vec::new();
        for (state, teeth) in states.iter().zip(&by_frame) {
            for tooth in teeth {
                let by = spring_displacement(scene, state, of_gear, *tooth);
                let rest = match from_rest {
                    true => spring_displacement(scene, states[0], of_gear, *tooth),
                    false => 0.0,
                };
                let rows = &found.rows_m;
                values.extend(spring_section(&spec.gears[gear].body, rows, by - rest));
            }
        }
        found.displacements_m = Quantised::relative(&values);
        return Some(found);
    }
    let rest = scene.deformed_flanks(states[0].at(), gear, &[first], heights[0]);
    let height = |x: &gearbench_models::Vec3| match body.is_rack {
        true => x.x,
        false => x.x.hypot(x.y),
    };
    found.rows_m = rest.first()?.at_rest.iter().map(height).collect();
    let rows = found.rows_m.len();
    let surface = scene.gears()[gear].model.surface()?;
    let normal_alone = (surface.displacement).is_some_and(|field| field.along_profile().is_none());
    let places = flank_places(scene, states[0], (gear, body), (first, &heights));
    let mut of_state = |state: &State, teeth: &[u32]| {
        flank_displacements(scene, state, (gear, body), (teeth, &heights, rows))
    };
    let mut values = Vec::new();
    for (state, teeth) in states.iter().zip(&by_frame) {
        let mut own = of_state(state, teeth);
        if from_rest {
            let rest = of_state(states[0], teeth);
            own.iter_mut().zip(rest).for_each(|(x, rest)| *x -= rest);
            if normal_alone {
                own.chunks_exact_mut(4 * rows)
                    .zip(places.iter().cycle())
                    .for_each(|(section, places)| add_tooth_motion(section, places));
            }
        }
        values.extend(own);
    }
    found.displacements_m = Quantised::relative(&values);
    Some(found)
}

/// Returns the displacements of the flanks of some teeth of an elastic gear: for each tooth by height, flank and row.
fn flank_displacements(
    scene: &mut Scene,
    state: &State,
    (gear, body): (usize, &ToothedBody),
    (teeth, heights, rows): (&[u32], &[f64], usize),
) -> Vec<f64> {
    let mut values = Vec::with_capacity(teeth.len() * heights.len() * rows * 4);
    let pose = scene.pose(state.at(), gear);
    let columns: Vec<_> = (heights.iter())
        .map(|z| scene.deformed_flanks(state.at(), gear, teeth, *z))
        .collect();
    for tooth in teeth {
        let (sin, cos) = body.direction_of(i64::from(*tooth));
        let along = |f: &DeformedFlank| {
            let x = f.at_rest[f.at_rest.len() / 2];
            match body.is_rack {
                true => {
                    let number = i64::from(*tooth) - body.first_tooth;
                    let number = body.first_tooth + number.rem_euclid(i64::from(body.teeth));
                    x.y - number as f64 * body.pitch
                }
                false => cos * x.y - sin * x.x,
            }
        };
        for column in &columns {
            for sign in [1.0, -1.0] {
                let flank = (column.iter())
                    .find(|f| f.tooth == *tooth && !f.at_rest.is_empty() && sign * along(f) > 0.0);
                for row in 0..rows {
                    let d = flank.filter(|f| row < f.at_rest.len()).map(|f| {
                        let place = f.with_hub[row] + f.displacement[row];
                        pose.point_back(&place) - f.at_rest[row]
                    });
                    let d = d.unwrap_or_default();
                    values.extend([cos * d.x + sin * d.y, cos * d.y - sin * d.x]);
                }
            }
        }
    }
    values
}

/// Returns the places at rest of the nodes of both flanks of a tooth in the frame of tooth 0, by height.
fn flank_places(
    scene: &mut Scene,
    state: &State,
    (gear, body): (usize, &ToothedBody),
    (tooth, heights): (u32, &[f64]),
) -> Vec<Vec<[f64; 2]>> {
    let (sin, cos) = body.direction_of(i64::from(tooth));
    let of = |height: &f64| {
        let mut flanks: Vec<Vec<[f64; 2]>> = scene
            .deformed_flanks(state.at(), gear, &[tooth], *height)
            .iter()
            .map(|f| {
                let places = f.at_rest.iter();
                places
                    .map(|x| [cos * x.x + sin * x.y, cos * x.y - sin * x.x])
                    .collect()
            })
            .collect();
        // The flank at larger y is first.
        let middle = |f: &Vec<[f64; 2]>| f.get(f.len() / 2).map_or(0.0, |p| p[1]);
        flanks.sort_by(|a, b| middle(b).total_cmp(&middle(a)));
        flanks.concat()
    };
    heights.iter().map(of).collect()
}

/// Adds what normal displacements of the flanks of a tooth do not contain: the motion along the profile. It is that of the
/// rigid motion of the tooth in the plane that has the given normal displacements in the least-squares sense.
///
/// `section` has the displacements of the rows of both flanks, `places` the positions of the rows.
fn add_tooth_motion(section: &mut [f64], places: &[[f64; 2]]) {
    let rows = section.len() / 4;
    if places.len() != 2 * rows || rows < 2 {
        return;
    }
    let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
    let mut known = Vec::with_capacity(2 * rows);
    for (i, place) in places.iter().enumerate() {
        let (flank, row) = (i / rows * rows, i % rows);
        let ends = [row.saturating_sub(1), (row + 1).min(rows - 1)].map(|r| places[flank + r]);
        let along = [ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]];
        let length = along[0].hypot(along[1]).max(f64::MIN_POSITIVE);
        let normal = [along[1] / length, -along[0] / length];
        let out = section[2 * i] * normal[0] + section[2 * i + 1] * normal[1];
        // Normal displacement under a translation x, y, and a rotation about the origin.
        let of = Vector3::new(
            normal[0],
            normal[1],
            place[0] * normal[1] - place[1] * normal[0],
        );
        matrix += of * of.transpose();
        right += out * of;
        known.push((normal, out, of));
    }
    let Some(motion) = matrix.try_inverse().map(|inverse| inverse * right) else {
        return;
    };
    for (i, (place, (normal, out, of))) in places.iter().zip(known).enumerate() {
        let rest = out - of.dot(&motion);
        section[2 * i] = motion.x - motion.z * place[1] + rest * normal[0];
        section[2 * i + 1] = motion.y + motion.z * place[0] + rest * normal[1];
    }
}

/// Radii at the root, at the end of the fillet and at the tip, of a rack places along x [m].
fn spring_rows(body: &Body) -> Vec<f64> {
    match body {
        Body::Gear(g) => vec![g.r_root(), g.r_form(), g.r_tip()],
        Body::Rack(r) => vec![r.root_depth(), r.form_depth(), -r.tip_height()],
    }
}

/// Returns the displacement of a tooth on a spring [rad], of a rack [m]: the largest of the windows that contain it.
/// `known` has the teeth of the gear that are in contact at any frame.
fn spring_displacement(
    scene: &Scene,
    state: &State,
    (gear, known, teeth): (usize, &[Tooth], u32),
    tooth: u32,
) -> f64 {
    let same = |t: &&Tooth| t.index.rem_euclid(i64::from(teeth)) == i64::from(tooth);
    let of = |t: &Tooth| scene.tooth_displacement(state.at(), gear, *t);
    let all = known.iter().filter(same).filter_map(of);
    all.max_by(|a, b| a.abs().total_cmp(&b.abs()))
        .unwrap_or_default()
}

/// Returns the displacements of both flanks of a tooth that moves as a whole, held at the root.
fn spring_section(body: &Body, rows: &[f64], by: f64) -> Vec<f64> {
    let mut values = Vec::with_capacity(4 * rows.len());
    for side in Side::BOTH {
        for (i, row) in rows.iter().enumerate() {
            let by = if i == 0 { 0.0 } else { by };
            values.extend(match body {
                Body::Rack(_) => [0.0, by],
                Body::Gear(g) => {
                    let angle = side.sign() * g.half_angle_at(*row);
                    [-by * row * angle.sin(), by * row * angle.cos()]
                }
            });
        }
    }
    values
}

#[cfg(test)]
#[path = "motion_tests.rs"]
mod tests;

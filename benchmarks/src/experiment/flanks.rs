//! Contact load on the flanks of the first gear of each mesh, at the largest force and as maximum over a run.
//!
//! Coordinates on a flank are the length of roll and the height along the axis from the middle of the face. The value
//! of a contact on a slice of the width is its load per width, or Hertz's pressure if its width is known; that of a
//! contact area is its pressure. Single nodes without an area have neither.

use super::run::Job;
use gearbench_integrators::State;
use gearbench_models::geometry::{Gear, Side};
use gearbench_models::scene::{ContactExtent, ContactForce, Scene};
use gearbench_models::spec::{Body, PointRule, SceneSpec, mesh_layout};
use gearbench_reports::record::{DeformedSection, FlankGrid, FlankLoad, FlankPatch, FlankValue};

/// Cells over the profile, and largest number of cells over the width, of the maximum over a run.
const CELLS: [usize; 2] = [32, 64];
/// Largest number of stored patches of a flank at the largest force.
const MOST_PATCHES: usize = 4000;
/// Heights that differ by less than this share of the width belong to one column of points.
const SAME_HEIGHT: f64 = 1e-5;

/// Geometry of the flanks of a mesh, independent of the contacts.
struct Flank<'a> {
    gear: &'a Gear,
    index: usize,
    face_width: f64,
}

/// Contacts of one side of a mesh at one instant.
struct SideContacts {
    side: Side,
    value: FlankValue,
    patches: Vec<FlankPatch>,
}

/// Contact loads on the flanks of all meshes at the largest force, and their maxima over several instants.
pub fn flank_loads(
    job: &Job<'_>,
    scene: &mut Scene,
    peak: &State,
    instants: &[State],
) -> Vec<FlankLoad> {
    let Job {
        scene: spec,
        modelling,
        ..
    } = job;
    let mut all = Vec::new();
    for (m, mesh) in spec.meshes.iter().enumerate() {
        let [a, b] = mesh.gears.map(|i| &spec.gears[i]);
        let points = modelling.contacts.get(m).and_then(|c| c.flanks.points());
        let alike = points.is_some_and(|p| p.rule == PointRule::EachNode);
        let (Body::Gear(gear), Ok(layout), false) = (&a.body, mesh_layout(a, b), alike) else {
            continue;
        };
        let flank = Flank {
            gear,
            index: mesh.gears[0],
            face_width: layout.face_width,
        };
        for mut borne in at(scene, peak, m, &flank) {
            let mut over_run = Grid::of(&flank, &borne.patches);
            over_run.add(&borne.patches);
            let mut seen = 1;
            for state in instants {
                let of_side = at(scene, state, m, &flank);
                let same = |o: &&SideContacts| o.side == borne.side && o.value == borne.value;
                if let Some(other) = of_side.iter().find(same) {
                    over_run.add(&other.patches);
                    seen += 1;
                }
            }
            if borne.patches.len() > MOST_PATCHES {
                continue;
            }
            for patch in &mut borne.patches {
                let teeth = i64::from(gear.teeth());
                patch.tooth = patch.tooth.rem_euclid(teeth) + 1;
            }
            all.push(FlankLoad {
                mesh: m + 1,
                gear: a.name.clone(),
                side: side_name(borne.side).into(),
                value: borne.value,
                roll_m: [gear.roll_length_form(), gear.roll_length_tip()],
                width_m: [-0.5 * gear.face_width(), 0.5 * gear.face_width()],
                patches: borne.patches,
                over_run: Some(over_run.finish(seen)),
            });
        }
    }
    all
}

/// Contacts of a mesh at a state, by side of the tooth.
fn at(scene: &mut Scene, state: &State, mesh: usize, flank: &Flank<'_>) -> Vec<SideContacts> {
    let forces = scene.contact_forces(state.at());
    let frame = scene.hub_frame(flank.index, state.at());
    let mut out = Vec::new();
    for side in Side::BOTH {
        let of_side = |f: &&ContactForce| f.mesh == mesh && f.side == side;
        let found: Vec<&ContactForce> = forces.iter().filter(of_side).collect();
        let mut patches: Vec<FlankPatch> = Vec::with_capacity(found.len());
        let pressed =
            |f: &&ContactForce| f.pressure.is_some() || matches!(f.extent, ContactExtent::Area(_));
        let value = match found.iter().all(pressed) {
            true => FlankValue::Pressure,
            false => FlankValue::LineLoad,
        };
        for f in &found {
            let place = frame.point_back(&f.x);
            let roll = flank.gear.roll_length(place.x.hypot(place.y));
            let (size_m, per_area) = match f.extent {
                ContactExtent::Width(share) => {
                    let along = f.pressure.map_or(0.0, |p| 2.0 * p.half_width);
                    ([along, share * flank.face_width], None)
                }
                ContactExtent::Area(area) => ([0.0, 0.0], Some(area)),
            };
            patches.push(FlankPatch {
                tooth: f.teeth[0].index,
                roll_m: roll,
                height_m: place.z,
                size_m,
                force_n: f.normal_force,
                value: match (f.pressure, per_area) {
                    (Some(p), _) => p.peak,
                    (None, Some(area)) => f.normal_force / area,
                    (None, None) => f.normal_force / size_m[1],
                },
            });
        }
        let areas = found.iter().map(|f| match f.extent {
            ContactExtent::Area(area) => area,
            ContactExtent::Width(_) => 0.0,
        });
        spread(&mut patches, areas, flank);
        if !patches.is_empty() {
            out.push(SideContacts {
                side,
                value,
                patches,
            });
        }
    }
    out
}

/// Sets positions and sizes of points with areas: over the width from middle to middle between their columns, along the
/// profile so that the area is kept.
fn spread(patches: &mut [FlankPatch], areas: impl Iterator<Item = f64>, flank: &Flank<'_>) {
    let heights = columns(patches, flank.face_width);
    let end = 0.5 * flank.gear.face_width();
    for (patch, area) in patches.iter_mut().zip(areas) {
        if area == 0.0 {
            continue;
        }
        let height = patch.height_m;
        let i = heights.partition_point(|h| *h < height - SAME_HEIGHT * flank.face_width);
        let beside = [i.checked_sub(1), Some(i + 1)].map(|j| heights.get(j?).copied());
        // The outermost columns reach as far outwards as inwards, within the face.
        let edge = |other: Option<f64>| other.map(|h| 0.5 * (h + height));
        let [low, high] = match beside.map(edge) {
            [Some(low), Some(high)] => [low, high],
            [Some(low), None] => [low, 2.0 * height - low],
            [None, Some(high)] => [2.0 * height - high, high],
            [None, None] => [-end, end],
        };
        let (low, high) = (low.max(-end), high.min(end));
        let across = (high - low).max(SAME_HEIGHT * flank.face_width);
        // Along the profile the arc is roll / r_b times the length of roll.
        let arc = area / across;
        let roll = patch.roll_m.max(0.05 * flank.gear.r_base());
        patch.size_m = [arc * flank.gear.r_base() / roll, across];
        patch.height_m = 0.5 * (low + high);
    }
}

/// Distinct heights of points, ascending.
fn columns(patches: &[FlankPatch], width: f64) -> Vec<f64> {
    let mut heights: Vec<f64> = patches.iter().map(|p| p.height_m).collect();
    heights.sort_by(f64::total_cmp);
    heights.dedup_by(|b, a| *b - *a < SAME_HEIGHT * width);
    heights
}

/// Deformed sections of the teeth in contact and of their neighbours at the height of the largest load, for gears with
/// a finite element mesh.
pub fn deformed_sections(
    spec: &SceneSpec,
    scene: &mut Scene,
    peak: &State,
) -> Vec<DeformedSection> {
    let forces = scene.contact_forces(peak.at());
    let mut out = Vec::new();
    for (i, g) in spec.gears.iter().enumerate() {
        let neighbour = |index: i64| match &g.body {
            Body::Gear(gear) => Some(index.rem_euclid(i64::from(gear.teeth())) as u32),
            Body::Rack(rack) => {
                let (n, first) = (i64::from(rack.teeth()), rack.first_tooth());
                // The teeth of a rack have ends.
                (first..first + n)
                    .contains(&index)
                    .then_some(index.rem_euclid(n) as u32)
            }
        };
        let mut near: Vec<u32> = Vec::new();
        let mut greatest = (0.0, 0.0);
        for f in &forces {
            for k in [0, 1]
                .into_iter()
                .filter(|k| spec.meshes[f.mesh].gears[*k] == i)
            {
                let numbers = [-1, 0, 1].map(|by| neighbour(f.teeth[k].index + by));
                near.extend(numbers.into_iter().flatten());
                let frame = scene.hub_frame(i, peak.at());
                if f.normal_force > greatest.0 {
                    greatest = (f.normal_force, frame.point_back(&f.x).z);
                }
            }
        }
        near.sort_unstable();
        near.dedup();
        for section in scene.deformed_flanks(peak.at(), i, &near, greatest.1) {
            let points = section.with_hub.iter().map(|x| scene.in_plane(x));
            let displacements = section.displacement.iter().map(|d| scene.in_plane(d));
            out.push(DeformedSection {
                gear: g.name.clone(),
                tooth: i64::from(section.tooth) + 1,
                side: side_name(section.side).into(),
                points: points.collect(),
                displacements: displacements.collect(),
            });
        }
    }
    out
}

fn side_name(side: Side) -> &'static str {
    match side {
        Side::Left => "left",
        Side::Right => "right",
    }
}

/// The greatest values on a flank, by cell.
struct Grid {
    roll: [f64; 2],
    width: f64,
    columns: usize,
    values: Vec<f64>,
}

impl Grid {
    /// Creates a grid with one column for each column of contact points.
    fn of(flank: &Flank<'_>, patches: &[FlankPatch]) -> Self {
        let across = patches.iter().map(|p| p.size_m[1]);
        let finest = across.fold(flank.face_width, f64::min);
        let width = flank.gear.face_width();
        let columns = ((width / finest).round() as usize).clamp(1, CELLS[1]);
        Grid {
            roll: [flank.gear.roll_length_form(), flank.gear.roll_length_tip()],
            width,
            columns,
            values: vec![0.0; CELLS[0] * columns],
        }
    }

    fn add(&mut self, patches: &[FlankPatch]) {
        let cell = |part: f64, n: usize| ((part * n as f64).max(0.0) as usize).min(n - 1);
        for p in patches {
            let row = |s: f64| cell((s - self.roll[0]) / (self.roll[1] - self.roll[0]), CELLS[0]);
            let column = |z: f64| cell(z / self.width + 0.5, self.columns);
            let half = p.size_m.map(|s| 0.499 * s);
            for i in row(p.roll_m - half[0])..=row(p.roll_m + half[0]) {
                for j in column(p.height_m - half[1])..=column(p.height_m + half[1]) {
                    let value = &mut self.values[i * self.columns + j];
                    *value = value.max(p.value);
                }
            }
        }
    }

    fn finish(self, instants: usize) -> FlankGrid {
        let digits = |x: f64| format!("{x:.3e}").parse().unwrap_or(x);
        FlankGrid {
            instants,
            rows: CELLS[0],
            columns: self.columns,
            values: self.values.into_iter().map(digits).collect(),
        }
    }
}

#[cfg(test)]
#[path = "flanks_tests.rs"]
mod tests;

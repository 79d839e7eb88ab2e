//! Grids of flank nodes from the geometry of a gear or a rack, and a rigid gear with these flanks, for tests of the
//! contact of flank points.

use gearbench_integrators::system::{Coeffs, Singular, StateView};
use gearbench_models::Vec3;
use gearbench_models::declare_parameters;
use gearbench_models::error::BuildError;
use gearbench_models::gear::parameters::whole;
use gearbench_models::gear::properties::Properties;
use gearbench_models::gear::rigid::Rigid;
use gearbench_models::gear::table::{GearContext, Model};
use gearbench_models::gear::{FlankNodes, FlankSurface, GearModel, HubBody};
use gearbench_models::geometry::{FlankGrid, Flanks, Gear, Rack, Side};
use gearbench_models::kinematics::Placement;
use gearbench_models::spec::Body;

declare_parameters! {
    /// Nodes of the flanks of a test gear.
    pub struct NodeParameters {
        /// nodes along the profile
        #[serde(deserialize_with = "whole")]
        rows: usize,
        /// nodes over the width
        #[serde(deserialize_with = "whole")]
        columns: usize,
    }
}

declare_parameters! {
    /// Parameters of the rigid gear with flanks.
    struct RigidFlanksParameters model "rigid-flanks-test" {
        /// how far tips stand off their involutes
        lean_pitches: f64,
        flatten nodes: NodeParameters,
    }
}

/// Row of a rigid gear with flanks in the table of models.
pub const RIGID: Model = Model::of::<RigidFlanksParameters>(
    "rigid gear with flanks of nodes (test)",
    Properties::NONE,
    build_rigid,
);

/// Returns the grids of all flanks of a body: `place(tooth, side, t, w)` is the position of a node at `t` from 0 at
/// the form circle to 1 at the tip and at `w` from -1/2 to 1/2 over the width.
fn all_flanks(
    teeth: u32,
    [rows, columns]: [usize; 2],
    place: impl Fn(u32, Side, f64, f64) -> Vec3,
) -> Flanks {
    let mut all = Vec::new();
    for tooth in 0..teeth {
        for side in Side::BOTH {
            let first = (all.len() * rows * columns) as u32;
            let position = |i: usize| {
                let t = (i / columns) as f64 / (rows - 1) as f64;
                let w = (i % columns) as f64 / (columns - 1) as f64 - 0.5;
                place(tooth, side, t, w)
            };
            all.push(FlankGrid {
                tooth,
                side,
                rows,
                columns,
                nodes: (first..).take(rows * columns).collect(),
                positions: (0..rows * columns).map(position).collect(),
            });
        }
    }
    Flanks::new(all)
}

/// Returns the grids of all flanks of a gear: the involute from the form circle to the tip, at equal steps of the
/// length of roll.
pub fn grids(gear: &Gear, rows: usize, columns: usize) -> Flanks {
    let (low, high) = (gear.roll_length_form(), gear.roll_length_tip());
    all_flanks(gear.teeth(), [rows, columns], |tooth, seen, t, w| {
        let side = gear.side_from_root(seen);
        let radius = gear.r_base().hypot(low + t * (high - low));
        let z = gear.face_width() * w;
        let angle = f64::from(tooth) * gear.pitch_angle()
            + z * gear.base_helix_angle().tan() / gear.r_base()
            + side.sign() * gear.half_angle_at(radius);
        Vec3::new(radius * angle.cos(), radius * angle.sin(), z)
    })
}

/// Returns the grids of all flanks of a rack, in the frame of its geometry; teeth are counted from the lowest.
fn rack_grids(rack: &Rack, rows: usize, columns: usize) -> Flanks {
    all_flanks(rack.teeth(), [rows, columns], |tooth, side, t, w| {
        let height = t * rack.tip_height() - (1.0 - t) * rack.form_depth();
        let z = rack.face_width() * w;
        let y = (rack.first_tooth() + i64::from(tooth)) as f64 * rack.pitch()
            - z * rack.params().helix_angle.tan()
            - side.sign() * rack.half_thickness_at(height);
        Vec3::new(-height, y, z)
    })
}

pub(crate) fn flanks_of(body: &Body, nodes: &NodeParameters) -> Flanks {
    let (rows, columns) = (nodes.rows.unwrap_or(9), nodes.columns.unwrap_or(2));
    match body {
        Body::Gear(gear) => grids(gear, rows, columns),
        Body::Rack(rack) => rack_grids(rack, rows, columns),
    }
}

fn build_rigid(context: &GearContext<'_>) -> Result<Box<dyn GearModel>, BuildError> {
    let given = context.parameters::<RigidFlanksParameters>()?;
    let mut flanks = flanks_of(context.body, &given.nodes);
    if let Body::Gear(gear) = context.body {
        flanks = leaning(gear, flanks, given.lean_pitches.unwrap_or(0.0));
    }
    Ok(Box::new(RigidFlanks {
        rigid: Rigid::new(context.hub.clone(), context.effective_radius),
        placement: context.placement,
        positions: undeformed(&flanks),
        flanks,
    }))
}

/// Rotates each node of the flanks in proportion to its height over the base circle, the tips by a number of pitches.
fn leaning(gear: &Gear, flanks: Flanks, pitches: f64) -> Flanks {
    let mut grids = flanks.grids().to_vec();
    for x in grids.iter_mut().flat_map(|g| &mut g.positions) {
        let height = (x.x.hypot(x.y) - gear.r_base()) / (gear.r_tip() - gear.r_base());
        let (sin, cos) = (height * pitches * gear.pitch_angle()).sin_cos();
        *x = Vec3::new(cos * x.x - sin * x.y, sin * x.x + cos * x.y, x.z);
    }
    Flanks::new(grids)
}

pub(crate) fn undeformed(flanks: &Flanks) -> Vec<Vec3> {
    flanks
        .grids()
        .iter()
        .flat_map(|g| g.positions.iter().copied())
        .collect()
}

/// A rigid gear with flanks; see [`RIGID`].
struct RigidFlanks {
    rigid: Rigid,
    flanks: Flanks,
    placement: Placement,
    positions: Vec<Vec3>,
}

impl GearModel for RigidFlanks {
    fn hub(&self) -> &HubBody {
        self.rigid.hub()
    }
    fn hub_mut(&mut self) -> &mut HubBody {
        self.rigid.hub_mut()
    }
    fn correct(
        &mut self,
        at: StateView<'_>,
        c: Coeffs,
        hub_damping: f64,
        x: &mut [f64],
    ) -> Result<(), Singular> {
        self.rigid.correct(at, c, hub_damping, x)
    }
    fn surface(&self) -> Option<FlankSurface<'_>> {
        Some(FlankSurface {
            flanks: &self.flanks,
            nodes: self,
            displacement: None,
        })
    }
}

impl FlankNodes for RigidFlanks {
    fn positions(&self, at: StateView<'_>, nodes: &[u32], out: &mut [Vec3]) {
        let pose = self.placement.pose(self.hub().displacement_at(at));
        for (x, &i) in out.iter_mut().zip(nodes) {
            *x = pose.point(&self.positions[i as usize]);
        }
    }
}

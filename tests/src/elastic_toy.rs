//! An elastic gear with artificial data: smooth modes of the flanks and a positive definite residual compliance.
//!
//! Mode `i` moves the flanks of tooth `t` by `b cos(k t + phase)` times a polynomial of the height, with opposite signs
//! on both flanks for even `i`: teeth bend, or swell. The residual compliance is a local kernel `exp(-d / l)` between
//! the nodes of a flank, less of it between flanks of a tooth, of neighbouring and of other teeth. Where there is friction
//! nodes also move along the profile, by shapes of their own; the kernel then couples both directions, `ACROSS`.

use crate::flank_test_gears::{NodeParameters, flanks_of};
use gearbench_models::Vec3;
use gearbench_models::declare_parameters;
use gearbench_models::error::{BuildError, GearPart};
use gearbench_models::gear::GearModel;
use gearbench_models::gear::elastic::Elastic;
use gearbench_models::gear::elastic::reduced::{
    FlankCompliance, OutOfPlaneShapes, Reduced, Residual,
};
use gearbench_models::gear::parameters::{number, whole};
use gearbench_models::gear::properties::Properties;
use gearbench_models::gear::table::{GearContext, Model};
use gearbench_models::geometry::Side;
use gearbench_models::kinematics::OutOfPlane;
use gearbench_models::spec::{Body, Freedom};
use std::sync::Arc;

declare_parameters! {
    /// Parameters of the model.
    pub struct ToyParameters model "elastic-toy" {
        /// number of modes
        #[serde(deserialize_with = "whole")]
        modes: usize,
        /// modal compliance of a flank node
        softness_m_per_n: f64,
        /// residual compliance of a node; 0: none
        #[serde(deserialize_with = "number")]
        residual_m_per_n: f64,
        /// of all modes
        #[serde(deserialize_with = "number")]
        damping_ratio: f64,
        /// length of the local kernel
        spread_m: f64,
        flatten nodes: NodeParameters,
    }
}

/// Row of the model in the table.
pub const ELASTIC_TOY: Model = Model::of::<ToyParameters>(
    "elastic gear with made-up modes and residual compliance (test)",
    Properties::NONE,
    build_toy,
);

fn build_toy(context: &GearContext<'_>) -> Result<Box<dyn GearModel>, BuildError> {
    let given = context.parameters::<ToyParameters>()?;
    let data = toy(context, given);
    let model = Elastic::new(
        context.hub.clone(),
        context.effective_radius,
        context.placement,
        Arc::new(data),
    )
    .map_err(|e| BuildError::gear(context.name, GearPart::Model, e))?;
    Ok(Box::new(model))
}

/// Ratio of the residual compliance between outward (0) and profile (1) directions to that of outward ones: positive
/// definite.
const ACROSS: [[f64; 2]; 2] = [[1.0, -0.4], [-0.4, 0.7]];

/// Builds the artificial reduction.
pub fn toy(context: &GearContext<'_>, given: &ToyParameters) -> Reduced {
    let flanks = flanks_of(context.body, &given.nodes);
    let modes = given.modes.unwrap_or(6);
    let softness = given.softness_m_per_n.unwrap_or(3e-9);
    let local = given.residual_m_per_n.unwrap_or(2e-9);
    let spread = given.spread_m.unwrap_or(5e-4);
    let free = context.hub.is_free();
    let teeth = flanks.grids().len() / 2;
    let omega: Vec<f64> = (0..modes)
        .map(|i| 1e5 * (1.0 + 19.0 * i as f64 / modes as f64))
        .collect();
    let mut normals = Vec::new();
    let mut shapes = Vec::new();
    let mut places = Vec::new();
    for grid in flanks.grids() {
        for (at, x) in grid.positions.iter().enumerate() {
            normals.push(normal(context.body, grid.side, x));
            let height = (at / grid.columns) as f64 / (grid.rows - 1) as f64;
            places.push((grid.tooth, grid.side, *x));
            for (i, w) in omega.iter().enumerate() {
                let around = f64::from(grid.tooth) * (1 + i / 2) as f64 + 0.7 * i as f64;
                let profile = match i % 3 {
                    0 => 0.3 + 0.7 * height * height,
                    1 => 0.5 - height * (1.0 - height),
                    _ => (2.0 * height + 0.2 * i as f64).cos(),
                };
                let sign = if i % 2 == 0 { grid.side.sign() } else { 1.0 };
                let b = w * (softness / modes as f64).sqrt();
                shapes.push(sign * b * around.cos() * profile * (1.0 + 10.0 * x.z));
            }
            for (i, w) in omega.iter().enumerate().filter(|_| context.slides) {
                let around = f64::from(grid.tooth) * (1 + i / 2) as f64 + 0.7 * i as f64;
                let b = w * (0.5 * softness / modes as f64).sqrt();
                shapes.push(b * around.sin() * (1.0 - 0.4 * height) * (1.0 - 5.0 * x.z));
            }
        }
    }
    let per_node = 1 + usize::from(context.slides);
    let per_tooth = places.len() / teeth * per_node;
    let residual = (local > 0.0).then(|| {
        let mut blocks = vec![0.0; teeth * per_tooth * per_tooth];
        for apart in 0..teeth {
            let between = match apart.min(teeth - apart) {
                0 => 1.0,
                1 => 0.1,
                // All share a little, as over the rim.
                _ => 0.02,
            };
            for i in 0..per_tooth {
                for j in 0..per_tooth {
                    let across = ACROSS[i % per_node][j % per_node];
                    let (at, i, j) = (
                        (apart * per_tooth + i) * per_tooth + j,
                        i / per_node,
                        j / per_node,
                    );
                    // Between the same places of both flanks.
                    let same = places[i].1 == places[j].1;
                    let x = |k: usize| {
                        let x = &places[k].2;
                        let side = if matches!(context.body, Body::Rack(_)) {
                            x.y.abs()
                        } else {
                            0.0
                        };
                        Vec3::new(x.x.hypot(x.y) - side, 0.0, x.z)
                    };
                    let kernel = local * (-(x(i) - x(j)).norm() / spread).exp();
                    blocks[at] = kernel * across * between * if same { 1.0 } else { 0.3 };
                }
            }
        }
        Residual {
            flanks: FlankCompliance::Cyclic {
                teeth,
                per_tooth,
                blocks,
            },
            hub: places
                .iter()
                .flat_map(|p| std::iter::repeat_n(p, per_node))
                .map(|p| {
                    if free {
                        1e-9 * p.1.sign() * (1.0 + 20.0 * p.2.z)
                    } else {
                        0.0
                    }
                })
                .collect(),
            hub_hub: if free { 1e-7 } else { 0.0 },
        }
    });
    let per_mode = |x: f64| -> Vec<f64> { (0..modes).map(|i| x / (1.0 + i as f64)).collect() };
    Reduced {
        flanks,
        normals,
        along_profile: context.slides,
        free,
        inertia: context.hub.inertia,
        damping: vec![given.damping_ratio.unwrap_or(0.0); modes],
        shapes,
        hub: per_mode(if free { 0.5 } else { 0.0 }),
        participation: per_mode(if free { 0.0 } else { 1e-3 }),
        momentum: vec![[0.0; 2]; modes],
        unbalance: [0.0; 2],
        omega,
        residual,
        near_field: None,
        integrals: None,
        lateral: (context.hub.lateral.as_ref()).map(|l| Arc::new(lateral_shapes(l, modes))),
    }
}

/// Returns the shapes of a hub with out-of-plane freedom, with the body of the scene.
fn lateral_shapes(lateral: &OutOfPlane, modes: usize) -> OutOfPlaneShapes {
    let free = [0, 1, 2, 3, 4, 5].map(|d| lateral.directions[d] == Freedom::Free);
    let of_mode = |i: usize| {
        let at = |d: usize| {
            if free[d] {
                (1.3 * (i + 2 * d) as f64).sin()
            } else {
                0.0
            }
        };
        [0, 1, 2, 3, 4, 5].map(|d| if d < 3 { 0.05 } else { 2.0 } * at(d))
    };
    let inertia = &lateral.body.inertia;
    OutOfPlaneShapes {
        free,
        hub: (0..modes).map(of_mode).collect(),
        mass: lateral.body.mass,
        centre: [0.0; 3],
        inertia: std::array::from_fn(|i| inertia[(i / 3, i % 3)]),
    }
}

/// Returns the outward normal of an unmodified flank.
fn normal(body: &Body, side: Side, x: &Vec3) -> Vec3 {
    match body {
        Body::Gear(gear) => {
            let r = x.x.hypot(x.y);
            let roll = (r * r - gear.r_base().powi(2)).max(0.0).sqrt();
            let angle = x.y.atan2(x.x) - side.sign() * (roll / gear.r_base()).atan();
            let (sin, cos) = angle.sin_cos();
            side.sign() * Vec3::new(-sin, cos, 0.0)
        }
        Body::Rack(rack) => {
            let (sin, cos) = rack.transverse_pressure_angle().sin_cos();
            Vec3::new(-sin, -side.sign() * cos, 0.0)
        }
    }
}

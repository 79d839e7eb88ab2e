//! Data of an elastic gear.

use super::inertia::SpinTerms;
use super::out_of_plane::{self, HubShapes};
use super::reduced::{FlankCompliance, Reduced};
use crate::Vec3;
use crate::error::Reason;
use crate::gear::body::Recovery;
use crate::gear::hub_body::HubBody;
use crate::kinematics::{Hub, Placement};
use std::cell::RefCell;
use std::sync::Arc;

/// A reduced elastic body on its hub.
#[derive(Clone, Debug)]
pub struct Elastic {
    pub(super) hub: HubBody,
    pub(super) placement: Placement,
    pub(super) data: Arc<Reduced>,
    /// Undeformed flank nodes in the gear frame [m].
    pub(super) positions: Vec<Vec3>,
    /// Number of coordinates of the hub; the modes follow.
    pub(super) own: usize,
    /// Shapes of the modes at a hub with out-of-plane freedom.
    pub(super) shapes: Option<HubShapes>,
    /// Angular frequencies and damping ratios of all coordinates, where these are independent oscillators.
    pub(super) swings: Option<[Vec<f64>; 2]>,
    /// Angular frequency and damping ratio of each coordinate; zero for the hub.
    pub(super) omega: Vec<f64>,
    pub(super) zeta: Vec<f64>,
    /// Largest modal compliance of a flank node, `sum_i b_i^2 / omega_i^2` [m/N].
    pub(super) softest: f64,
    /// Largest residual displacement of a flank node per unit load on the hub.
    pub(super) hub_reach: f64,
    pub(super) spin: Spin,
    pub(super) correction: RefCell<QuasiStatic>,
    /// Buffers of the mobility of nodes: weighted shapes, and a row.
    pub(super) mobility: RefCell<(Vec<f64>, Vec<f64>)>,
    /// Full mesh behind the reduction, where it is available.
    pub(super) recovery: Option<Arc<dyn Recovery>>,
}

/// Spin terms of a gear, with work space for their evaluation.
#[derive(Clone, Debug, Default)]
pub(super) struct Spin {
    pub(super) terms: SpinTerms,
    pub(super) active: bool,
    /// Vectors over the modes.
    pub(super) room: RefCell<[Vec<f64>; 3]>,
}

/// Compliance between flank nodes that a method leaves out of the oscillators.
#[derive(Clone, Debug, Default)]
pub(super) struct QuasiStatic {
    /// Compliance per unit of acceleration [s^2] that is left out. It is computed once for all runs with one step.
    pub(super) missing: Vec<f64>,
    pub(super) flanks: Option<FlankCompliance>,
    /// True if the method of this run leaves out compliance.
    pub(super) on: bool,
}

impl QuasiStatic {
    pub(super) fn flanks<'a>(&'a self, data: &'a Reduced) -> Option<&'a FlankCompliance> {
        let made = self.flanks.as_ref().filter(|_| self.on);
        made.or(data.residual.as_ref().map(|r| &r.flanks))
    }
}

impl Elastic {
    /// Creates a reduced body on its hub, with its base radius [m], or `cos(alpha)` for a rack. The inertia of the hub
    /// becomes that of the reduction.
    ///
    /// # Errors
    /// What of the data does not fit together, or does not fit the mount.
    pub fn new(
        mut hub: Hub,
        effective_base_radius: f64,
        placement: Placement,
        data: Arc<Reduced>,
    ) -> Result<Self, Reason> {
        if let Some(problem) = data.problem() {
            return Err(problem.into());
        }
        let own = hub.coordinates();
        if hub.is_free() != data.free {
            let (is, of) = if data.free {
                ("free", "held")
            } else {
                ("held", "free")
            };
            return Err((
                format!(
                    "the modes are those of a hub that is {is} to move, but the mount's hub is {of}"
                ),
                "reduce the gear for this mount",
            )
                .into());
        }
        hub.inertia = data.inertia;
        let mut shapes = None;
        if let Some(lateral) = &hub.lateral {
            let lateral = out_of_plane::on_hub(lateral, data.lateral.as_ref(), &placement)?;
            let own = hub.moving();
            let of_modes = data.lateral.iter().flat_map(|l| &l.hub).zip(&data.hub);
            let with_own = of_modes.map(|(phi, turn)| {
                let mut phi = *phi;
                // A rack slides along its own y.
                phi[if own == 0 { 1 } else { own }] += turn;
                phi
            });
            shapes = Some(HubShapes(with_own.collect()));
            hub.lateral = Some(Arc::new(lateral));
        } else if data.lateral.is_some() {
            return Err((
                "the modes are those of a hub with more free directions",
                "reduce the gear for this mount",
            )
                .into());
        }
        let with_hub = |x: &[f64]| -> Vec<f64> {
            std::iter::repeat_n(0.0, own)
                .chain(x.iter().copied())
                .collect()
        };
        let mut largest = vec![0.0_f64; data.modes()];
        let mut softest = 0.0_f64;
        for node in 0..data.nodes() as u32 {
            let mut compliance = 0.0;
            for ((b, w), l) in data
                .shapes_at(node)
                .iter()
                .zip(&data.omega)
                .zip(&mut largest)
            {
                *l = l.max(b.abs());
                compliance += (b / w).powi(2);
            }
            softest = softest.max(compliance);
        }
        let hub_reach = data.residual.as_ref().map_or(0.0, |r| {
            r.hub.iter().fold(0.0_f64, |most, x| most.max(x.abs()))
        });
        let mut positions = vec![Vec3::zeros(); data.nodes()];
        for grid in data.flanks.grids() {
            for (&node, x) in grid.nodes.iter().zip(&grid.positions) {
                positions[node as usize] = *x;
            }
        }
        // A mode that moves no flank has no magnitude of its own.
        let floor = 1e-3 * largest.iter().copied().fold(0.0, f64::max);
        let of_modes = largest
            .iter()
            .map(|shape| shape.max(floor).max(f64::MIN_POSITIVE));
        let body = HubBody::new(hub, effective_base_radius);
        let hub = HubBody {
            own: data.modes(),
            characteristic_time: (1.0 / data.omega.iter().copied().fold(0.0, f64::max))
                .min(body.characteristic_time),
            scales: own_first(&body.scales, effective_base_radius, own)
                .chain(of_modes)
                .collect(),
            masses: own_first(&body.masses, body.inertia, own)
                .chain(data.omega.iter().map(|_| 1.0))
                .collect(),
            hub_shapes: data.hub.clone(),
            conservative: data.damping.iter().all(|z| *z <= 0.0),
            ..body
        };
        let swings = match &hub.hub.lateral {
            None => Some(vec![[0.0; 2]; own]),
            Some(lateral) => lateral.oscillators(hub.moving()).map(|of| {
                let own = hub.is_free().then_some([0.0; 2]);
                own.into_iter().chain(of).collect()
            }),
        };
        let swings = swings.map(|of_hub| {
            let of_modes = data.omega.iter().zip(&data.damping).map(|(w, z)| [*w, *z]);
            let all: Vec<[f64; 2]> = of_hub.into_iter().chain(of_modes).collect();
            [0, 1].map(|k| all.iter().map(|o| o[k]).collect())
        });
        Ok(Elastic {
            swings,
            positions,
            own,
            shapes,
            omega: with_hub(&data.omega),
            zeta: with_hub(&data.damping),
            hub,
            placement,
            data,
            softest,
            hub_reach,
            spin: Spin::default(),
            correction: RefCell::default(),
            mobility: RefCell::default(),
            recovery: None,
        })
    }

    /// Returns the gear with the full mesh behind its reduction.
    #[must_use]
    pub fn with_recovery(self, recovery: Arc<dyn Recovery>) -> Self {
        Elastic {
            recovery: Some(recovery),
            ..self
        }
    }

    /// Returns the gear whose flanks are damped in proportion to their stiffness, in what the modes leave out and in the
    /// contact, with a retardation time [s].
    #[must_use]
    pub fn with_retardation(mut self, retardation: f64) -> Self {
        self.hub.retardation = retardation;
        self.hub.conservative &= retardation == 0.0;
        self
    }

    /// Returns true if the hub's own motion is free.
    #[inline]
    pub(super) fn turns(&self) -> bool {
        self.hub.is_free()
    }

    /// Returns the reduction.
    pub fn data(&self) -> &Reduced {
        &self.data
    }

    /// Returns the sum over the modes of `w_i x_i`.
    pub(super) fn over_modes(&self, w: &[f64], x: &[f64]) -> f64 {
        w.iter().zip(&x[self.own..]).map(|(w, x)| w * x).sum()
    }
}

/// Returns the values of a rigid body for the hub coordinates, completed with `own`.
fn own_first(of_body: &[f64], own: f64, n: usize) -> impl Iterator<Item = f64> + '_ {
    let all = of_body.iter().copied().chain(std::iter::repeat(own));
    all.take(n)
}

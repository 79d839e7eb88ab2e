//! Assembly of hubs: inertia, axes, and out-of-plane freedom.

use crate::Vec3;
use crate::error::{BuildError, GearPart, Reason};
use crate::kinematics::{BodyMass, Hub, OutOfPlane};
use crate::spec::{Body, Freedom, GearSpec, Mount, OutOfPlaneSpec, SpinTerms, UPRIGHT};
use nalgebra::Matrix3;
use std::sync::Arc;

/// Builds the hub of a gear.
///
/// # Errors
/// The mount is not for this gear, or a number of bearing or body cannot be.
pub fn hub_of(g: &GearSpec) -> Result<Hub, BuildError> {
    let inertia = g.own_inertia() + g.added_inertia;
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
    let mut hub = Hub::new(g.mount.clone(), g.position.into(), slide, inertia);
    if !rack {
        hub.axes = g.axes;
    } else if g.axes != UPRIGHT {
        return Err(BuildError::gear(
            &g.name,
            GearPart::Mount,
            ("the axis of a rack is z", "tilt its gear instead"),
        ));
    }
    hub.lateral = match &g.lateral {
        Some(lateral) => {
            let of = LateralBody {
                name: &g.name,
                mount: &g.mount,
                speed: g.speed,
                mass: g.body.mass(g.material.density),
                tensor: round_tensor(g),
            };
            lateral_of(&of, lateral, &mut hub)?.map(Arc::new)
        }
        None => None,
    };
    Ok(hub)
}

/// Returns the inertia tensor of a body with three or more equal sectors, about its hub.
pub(super) fn round_tensor(g: &GearSpec) -> Matrix3<f64> {
    let about = g.own_inertia() + g.added_inertia;
    let added = g.lateral.as_ref().map_or(0.0, |l| l.added_mass);
    let own = g.lateral.as_ref().and_then(|l| l.mass);
    let mass = own.unwrap_or_else(|| g.body.mass(g.material.density)) + added;
    let width = g.body.face_width();
    let along = match g.body {
        Body::Gear(_) => about - g.added_inertia,
        Body::Rack(_) => 0.0,
    };
    let across = 0.5 * along + mass * width * width / 12.0;
    Matrix3::from_diagonal(&Vec3::new(across, across, about))
}

/// Specification of a body on a hub that may have out-of-plane freedom.
pub(super) struct LateralBody<'a> {
    pub name: &'a str,
    pub mount: &'a Mount,
    pub speed: f64,
    /// Mass [kg] and inertia tensor [kg m^2] of the body where none are given.
    pub mass: f64,
    pub tensor: Matrix3<f64>,
}

/// Ratio of the hub speed to the lowest natural frequency of the tilt above which spin terms are included.
const SLOW: f64 = 1e-3;

/// Returns the out-of-plane freedom of a hub and its body, or `None` where all directions are fixed.
pub(super) fn lateral_of(
    g: &LateralBody<'_>,
    lateral: &OutOfPlaneSpec,
    hub: &mut Hub,
) -> Result<Option<OutOfPlane>, BuildError> {
    let error = |why: Reason| BuildError::gear(g.name, GearPart::Mount, why);
    let own = hub.moving();
    let mut directions = lateral.directions.clone();
    directions[own] = Freedom::Fixed;
    for (d, freedom) in directions.iter().enumerate() {
        if let Freedom::Driven(p) = freedom
            && let Some(problem) = p.problem()
        {
            return Err(error(
                format!("driven direction {}: {problem}", d + 1).into(),
            ));
        }
    }
    if directions.iter().all(|d| *d == Freedom::Fixed) {
        return Ok(None);
    }
    let b = &lateral.bearing;
    for (what, matrix) in [("stiffness", &b.stiffness), ("damping", &b.damping)] {
        for (i, row) in matrix.iter().enumerate() {
            if row.iter().any(|x| !x.is_finite()) || row[i] < 0.0 {
                return Err(error(
                    (
                        format!("the {what} of direction {} is not zero or positive", i + 1),
                        "give values in N/m and N m/rad, damping in N s/m and N m s/rad",
                    )
                        .into(),
                ));
            }
            for (j, x) in row.iter().enumerate() {
                let scale = (matrix[i][i] * matrix[j][j]).sqrt();
                if (x - matrix[j][i]).abs() > 1e-9 * scale || (i != j && x.abs() > scale) {
                    return Err(error(
                        (
                            format!(
                                "the {what} matrix is not symmetric and positive at {}, {}",
                                i + 1,
                                j + 1
                            ),
                            "give a symmetric positive matrix",
                        )
                            .into(),
                    ));
                }
                if (i == own) != (j == own) && *x != 0.0 {
                    return Err(error(
                        (
                            format!(
                                "the {what} couples direction {} with the direction of motion of the mount",
                                i + j - own + 1
                            ),
                            "set the off-diagonal values of this row and column to 0",
                        )
                            .into(),
                    ));
                }
            }
        }
    }
    let isotropic = b.stiffness[0][0] == b.stiffness[1][1] && b.stiffness[0][1] == 0.0;
    if b.clearance < 0.0 || b.clearance.is_nan() || (b.clearance > 0.0 && !isotropic) {
        return Err(error(
            (
                format!(
                    "a radial clearance of {:.4e} m needs one radial stiffness",
                    b.clearance
                ),
                "give both radial directions one stiffness, or no clearance",
            )
                .into(),
        ));
    }
    let mass = lateral.mass.unwrap_or(g.mass) + lateral.added_mass;
    let inertia = lateral.inertia.unwrap_or(g.tensor);
    if own == 5 {
        if lateral.inertia.is_some() {
            hub.inertia = inertia[(2, 2)];
        }
    } else {
        hub.inertia = mass;
    }
    let positive = inertia.symmetric_eigenvalues().iter().all(|x| *x > 0.0);
    if mass <= 0.0 || mass.is_nan() || !positive || inertia != inertia.transpose() {
        return Err(BuildError::gear(
            g.name,
            GearPart::Inertia,
            (
                format!("mass {mass:.4e} kg and the inertia tensor are not positive"),
                "give a positive mass and a symmetric positive tensor",
            ),
        ));
    }
    let body = BodyMass {
        mass,
        inertia,
        centre: lateral.centre_of_mass,
    };
    let fastest = match g.mount {
        Mount::Driven(p) => p.greatest(),
        _ => g.speed.abs(),
    };
    let tilts = [3, 4]
        .into_iter()
        .filter(|d| directions[*d] != Freedom::Fixed);
    let slowest = tilts
        .map(|d| (b.stiffness[d][d] / inertia[(d - 3, d - 3)]).sqrt())
        .fold(f64::INFINITY, f64::min);
    let gyroscopic = fastest * inertia[(2, 2)] / inertia[(0, 0)].min(inertia[(1, 1)]);
    let spins = match lateral.spin {
        SpinTerms::On => true,
        SpinTerms::Off => false,
        SpinTerms::Auto => {
            own == 5 && (gyroscopic > SLOW * slowest || (!body.is_round() && fastest > 0.0))
        }
    };
    Ok(Some(OutOfPlane {
        directions,
        bearing: *b,
        body,
        spins,
    }))
}

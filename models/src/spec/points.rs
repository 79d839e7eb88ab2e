//! Settings of the contact between flank points and flank surfaces.

use crate::error::Reason;
use serde::{Deserialize, Serialize};

/// Integration rule: positions of the points on the faces of a flank, and their areas.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointRule {
    /// Points at the nodes, each with the reference area of its shape function: the lowest order.
    Nodes,
    /// Points at the nodes with unit areas: penalty and dashpot are those of a node [N/m, N s/m]. The force then
    /// depends on the mesh; for comparison with methods of that kind.
    EachNode,
    /// Gauss points of each face.
    Quadrature {
        /// Number of points along the profile, 1 to 10.
        along: usize,
        /// Number of points over the width, 1 to 10.
        across: usize,
    },
}

impl Default for PointRule {
    /// Returns eight points along the profile and two over the width: a tip edge loads a strip much narrower than an
    /// element, which fewer points include or miss as a whole. The cost of a step depends on the nodes, not on the
    /// points.
    fn default() -> Self {
        PointRule::Quadrature {
            along: 8,
            across: 2,
        }
    }
}

/// The surface between the nodes of a flank.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SurfaceKind {
    /// The element faces as they are: a convex flank lies up to `l^2 / (8 rho)` outside its chords.
    Faceted,
    /// Cubic splines through the undeformed nodes, moved by the interpolated displacement.
    #[default]
    Smooth,
}

/// Method that finds the pairs of flanks for the point contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CoarseSearch {
    /// Tooth indices where the flanks of both gears follow the involutes of their toothings, otherwise boxes.
    #[default]
    Auto,
    /// Path coordinates of the involutes that the flanks approximate.
    ToothIndices,
    /// Bounding boxes of the flanks, whatever their numbers and poses.
    Boxes,
}

/// Selection of the gear whose points are projected on the other's surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Passes {
    /// Points of both gears, so that the order of the gears does not matter. Hard contact, which needs a single pass,
    /// uses the points of the first gear with its own flanks.
    #[default]
    #[serde(skip)]
    Auto,
    /// Points of the first gear of the mesh.
    First,
    /// Points of the second gear of the mesh.
    Second,
    /// Points of both gears, each with half the penalty: no edge passes between the points of the other side.
    Both,
}

/// Normal law of the points of a flank.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PointLaw {
    /// Pressure of a penalty, and a dashpot.
    Penalty {
        /// Contact pressure over penetration to the power of the law's exponent [Pa/m for a linear law]; the force of a
        /// node [N/m] with [`PointRule::EachNode`].
        stiffness: f64,
        /// Dashpot per area of flank [N s/m^3].
        damping: f64,
    },
    /// Gaps that do not become negative, at the nodes of the slave with the rule [`PointRule::Nodes`], otherwise
    /// averaged with the shape functions of its nodes (mortar).
    Hard,
}

/// Contact of the flanks of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum FlankContact {
    /// The flanks of the toothing: contact of tooth pairs.
    #[default]
    Toothing,
    /// Points of the flanks of finite elements, with a penalty or hard.
    Points(PointContact),
    /// Half-spaces instead of the elements next to the contact, as in Hertz's theory: lines over strips of the width
    /// ([`FlankLines`](crate::contact::pairs::FlankLines)).
    HalfSpace,
}

impl FlankContact {
    /// Returns the settings of contact at points.
    pub fn points(&self) -> Option<&PointContact> {
        match self {
            FlankContact::Points(points) => Some(points),
            FlankContact::Toothing | FlankContact::HalfSpace => None,
        }
    }

    /// Returns the settings of contact at points, to change them.
    pub fn points_mut(&mut self) -> Option<&mut PointContact> {
        match self {
            FlankContact::Points(points) => Some(points),
            FlankContact::Toothing | FlankContact::HalfSpace => None,
        }
    }

    /// Returns the penalty of contact at points, to change it; `None` for any other contact.
    pub fn penalty_mut(&mut self) -> Option<&mut f64> {
        match &mut self.points_mut()?.law {
            PointLaw::Penalty { stiffness, .. } => Some(stiffness),
            PointLaw::Hard => None,
        }
    }

    /// Returns true if contact at points is hard.
    pub fn is_hard(&self) -> bool {
        self.points().is_some_and(|p| p.law == PointLaw::Hard)
    }

    /// Returns penalty and dashpot of contact at points; `None` for any other contact.
    pub fn penalty(&self) -> Option<[f64; 2]> {
        self.points()?.penalty()
    }
}

impl From<PointContact> for FlankContact {
    fn from(points: PointContact) -> Self {
        FlankContact::Points(points)
    }
}

/// Settings of the contact between flank points and flank surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointContact {
    /// Normal law.
    pub law: PointLaw,
    /// Integration rule of the points.
    pub rule: PointRule,
    /// Surface between the nodes.
    pub surface: SurfaceKind,
    /// Selection of the gear with the points.
    pub passes: Passes,
    /// Method that finds the pairs of flanks.
    pub coarse: CoarseSearch,
    /// Largest gap of the undeformed flanks [m] at which a pair of flanks is evaluated; it must exceed the elastic
    /// displacement of the teeth. `None` uses a fiftieth of the base pitch.
    pub reach: Option<f64>,
}

impl PointContact {
    /// Returns settings of hard contact at nodes, or averaged over the points of a rule, otherwise the defaults.
    #[must_use]
    pub fn hard(rule: PointRule) -> Self {
        PointContact {
            law: PointLaw::Hard,
            rule,
            ..PointContact::new(1.0)
        }
    }

    /// Returns settings of a linear penalty [Pa/m] without damping, otherwise the defaults.
    #[must_use]
    pub fn new(penalty: f64) -> Self {
        PointContact {
            law: PointLaw::Penalty {
                stiffness: penalty,
                damping: 0.0,
            },
            rule: PointRule::default(),
            surface: SurfaceKind::default(),
            passes: Passes::default(),
            coarse: CoarseSearch::default(),
            reach: None,
        }
    }

    /// Returns the settings with another dashpot of the penalty [N s/m^3]; hard contact has none.
    #[must_use]
    pub fn damped(mut self, dashpot: f64) -> Self {
        if let PointLaw::Penalty { damping, .. } = &mut self.law {
            *damping = dashpot;
        }
        self
    }

    /// Returns penalty [Pa/m] and dashpot [N s/m^3]; `None` for hard contact.
    pub fn penalty(&self) -> Option<[f64; 2]> {
        match self.law {
            PointLaw::Penalty { stiffness, damping } => Some([stiffness, damping]),
            PointLaw::Hard => None,
        }
    }

    /// Returns the first invalid setting with a remedy, if any.
    pub fn problem(&self) -> Option<Reason> {
        match self.law {
            PointLaw::Penalty { stiffness, .. } if !(stiffness > 0.0 && stiffness.is_finite()) => {
                return Some(
                    (
                        format!("the penalty is {stiffness} Pa/m"),
                        "it must be finite and positive, for steel for example 1e15",
                    )
                        .into(),
                );
            }
            PointLaw::Penalty { damping, .. } if !(damping >= 0.0 && damping.is_finite()) => {
                return Some(
                    (
                        format!("the damping is {damping} N s/m^3"),
                        "it must be finite and not negative",
                    )
                        .into(),
                );
            }
            PointLaw::Hard if self.passes == Passes::Both => {
                return Some(
                    (
                        "hard contact in both passes constrains every position twice",
                        "use the first or the second pass",
                    )
                        .into(),
                );
            }
            PointLaw::Penalty { .. } | PointLaw::Hard => {}
        }
        if let PointRule::Quadrature { along, across } = self.rule
            && !((1..=MAX_POINTS).contains(&along) && (1..=MAX_POINTS).contains(&across))
        {
            return Some(
                (
                    format!("{along} x {across} quadrature points per face"),
                    format!("use 1 to {MAX_POINTS} in each direction"),
                )
                    .into(),
            );
        }
        match self.reach {
            Some(r) if !(r > 0.0 && r.is_finite()) => Some(
                (
                    format!("the reach is {r} m"),
                    "it must be finite and positive, or leave it out",
                )
                    .into(),
            ),
            _ => None,
        }
    }
}

/// Largest number of quadrature points in one direction of a face.
pub const MAX_POINTS: usize = 10;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_settings_are_named() {
        let good = PointContact::new(1e15);
        assert_eq!(good.problem(), None);
        let bad = [
            PointContact::new(0.0),
            PointContact::new(f64::NAN),
            good.damped(-1.0),
            PointContact {
                reach: Some(0.0),
                ..good
            },
            PointContact {
                rule: PointRule::Quadrature {
                    along: 0,
                    across: 2,
                },
                ..good
            },
        ];
        for settings in bad {
            assert!(settings.problem().is_some(), "{settings:?}");
        }
    }
}

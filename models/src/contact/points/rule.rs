//! Integration rules for the points of a face: positions and weights.

use super::quadrature::gauss_legendre;
use crate::spec::PointRule;

/// Integration point of a flank.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FlankPoint {
    pub row: usize,
    pub column: usize,
    /// Position on the face, 0 to 1.
    pub a: f64,
    pub b: f64,
    /// Reference area of the point [m^2].
    pub area: f64,
    /// Length of the point along the profile [m].
    pub length: f64,
}

/// Points and weights on [0, 1] in both directions of a face; empty for points at nodes.
#[derive(Clone, Debug, Default)]
pub(super) struct Rule {
    /// Points and weights along the profile.
    pub along: Vec<(f64, f64)>,
    /// Points and weights over the width.
    pub across: Vec<(f64, f64)>,
    /// True if all nodes have a unit area.
    pub alike: bool,
}

impl Rule {
    pub fn new(rule: PointRule) -> Self {
        let unit = |n: usize| -> Vec<(f64, f64)> {
            gauss_legendre(n)
                .into_iter()
                .map(|(x, w)| (0.5 * (1.0 + x), 0.5 * w))
                .collect()
        };
        match rule {
            PointRule::Nodes => Rule::default(),
            PointRule::EachNode => Rule {
                alike: true,
                ..Rule::default()
            },
            PointRule::Quadrature { along, across } => Rule {
                along: unit(along),
                across: unit(across),
                alike: false,
            },
        }
    }

    pub fn is_nodes(&self) -> bool {
        self.along.is_empty()
    }
}

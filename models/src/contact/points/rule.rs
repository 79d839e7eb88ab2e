//! Where the points of a face are, and what they weigh.

use super::quadrature::gauss_legendre;
use crate::spec::PointRule;

/// A point of a flank.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FlankPoint {
    pub row: usize,
    pub column: usize,
    /// Place on the face, 0 to 1.
    pub a: f64,
    pub b: f64,
    /// Reference area it stands for [m^2].
    pub area: f64,
    /// Length along the profile it stands for [m].
    pub length: f64,
}

/// Points and weights on [0, 1] in both directions of a face; none for nodes.
#[derive(Clone, Debug, Default)]
pub(super) struct Rule {
    /// Along the profile.
    pub along: Vec<(f64, f64)>,
    /// Over the width.
    pub across: Vec<(f64, f64)>,
    /// Nodes count alike: each stands for a unit of area.
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

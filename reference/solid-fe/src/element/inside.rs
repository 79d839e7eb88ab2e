//! Check for elements that are inverted at one of their integration points.

use super::{Point, jacobian, stiffness_rule};
use crate::Vec3;
use crate::mesh::ElementKind;

/// The integration points of a kind.
pub struct Inside(Vec<Point>);

impl Inside {
    /// Prepares the integration points.
    pub fn new(kind: ElementKind) -> Self {
        let rule = stiffness_rule(kind).into_iter();
        Inside(rule.map(|(xi, w)| Point::new(kind, xi, w)).collect())
    }

    /// The first Jacobian that is not positive, of an element with these nodes.
    pub fn wrong(&self, x: &[Vec3]) -> Option<f64> {
        let determinants = self.0.iter();
        let mut determinants = determinants.map(|p| jacobian(x, &p.gradients).determinant());
        // Written so that a NaN is wrong too.
        determinants.find(|d| d.is_nan() || *d <= 0.0)
    }
}

//! The parabola along the path: its values, its slope, its refusals.

use super::*;

const PATH: Path = Path {
    start: 4e-3,
    end: 2e-2,
    base_pitch: 1e-2,
};

/// The parabola has the values `k (1 + a xi + b xi^2)` and their slope by the path coordinate at every position, and
/// is constant beyond the ends.
#[test]
fn a_parabola_has_its_values_and_its_slope() {
    let (k, a, b) = (2e8, 0.5, -0.3);
    let curve = parabola(k, [a, b], PairOrMesh::Mesh, &PATH).unwrap();
    assert_eq!(curve.of(), PairOrMesh::Mesh);
    let half = 0.5 * (PATH.end - PATH.start);
    for i in -10..=10 {
        let xi = 0.099 * f64::from(i);
        let (value, slope) = curve.eval(PATH.start + half * (1.0 + xi));
        assert!((value / (k * (1.0 + a * xi + b * xi * xi)) - 1.0).abs() < 1e-12);
        let exact = k * (a + 2.0 * b * xi) / half;
        assert!(
            (slope - exact).abs() < 1e-9 * k / half,
            "{xi}: {slope} {exact}"
        );
    }
    for (s, xi) in [(0.0, -1.0), (0.1, 1.0)] {
        let (value, slope) = curve.eval(s);
        assert!((value / (k * (1.0 + a * xi + b)) - 1.0).abs() < 1e-12);
        assert_eq!(slope, 0.0);
    }
    let level = parabola(k, [0.0; 2], PairOrMesh::Pair, &PATH).unwrap();
    assert!(level.range().is_none());
}

/// A parabola that is not positive at an end, or between the ends, is refused.
#[test]
fn a_parabola_that_is_not_positive_is_refused() {
    for along in [
        [1.0, 0.0],
        [-1.3, 0.2],
        [0.0, -1.0],
        [2.0, 1.01 * 0.99],
        [f64::NAN, 0.0],
    ] {
        let refused = parabola(1e8, along, PairOrMesh::Pair, &PATH).unwrap_err();
        assert!(refused.to_string().contains("not positive"), "{along:?}");
    }
    // The minimum is at xi = -0.5: 1 - 4/4 plus the added term.
    assert!(parabola(1e8, [4.1, 4.1], PairOrMesh::Pair, &PATH).is_err());
    assert!(parabola(1e8, [3.9, 3.9], PairOrMesh::Pair, &PATH).is_ok());
}

//! Integrals over faces of functions that grow as `1/r` towards a line: a piece near to it is divided into four.

/// Points of a triangle, exact to degree 5: coordinates and weights, half a unit square in all (J. Radon, 1948).
const TRIANGLE: [([f64; 2], f64); 7] = {
    const A: f64 = 0.059_715_871_789_77;
    const B: f64 = 0.470_142_064_105_115;
    const C: f64 = 0.797_426_985_353_087;
    const D: f64 = 0.101_286_507_323_456;
    const U: f64 = 0.066_197_076_394_253;
    const V: f64 = 0.062_969_590_272_414;
    [
        ([1.0 / 3.0, 1.0 / 3.0], 0.1125),
        ([A, B], U),
        ([B, A], U),
        ([B, B], U),
        ([C, D], V),
        ([D, C], V),
        ([D, D], V),
    ]
};

/// Gauss's points and weights from -1 to 1, exact to degree 5.
const GAUSS: [(f64, f64); 3] = [
    (-0.774_596_669_241_483, 5.0 / 9.0),
    (0.0, 8.0 / 9.0),
    (0.774_596_669_241_483, 5.0 / 9.0),
];

/// How often a piece is divided at most.
const DEEPEST: usize = 7;

/// A piece of a face in its natural coordinates: `origin + a u + b v`, over the unit triangle or the square from -1 to 1.
#[derive(Clone, Copy)]
struct Piece {
    origin: [f64; 2],
    axes: [[f64; 2]; 2],
    depth: usize,
}

impl Piece {
    fn at(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let [a, b] = self.axes;
        [0, 1].map(|i| self.origin[i] + a[i] * u + b[i] * v)
    }

    /// The piece over so much of this one, about a place in it.
    fn part(&self, origin: [f64; 2], scale: f64) -> Piece {
        Piece {
            origin: self.at(origin),
            axes: self.axes.map(|a| a.map(|x| scale * x)),
            depth: self.depth + 1,
        }
    }
}

/// Natural coordinates and weights of the points of a face of three or four corners, weights for the area of the natural
/// coordinates. `near` says of the middle of a piece, and its axes, whether it is to be divided.
pub fn each(
    corners: usize,
    near: impl Fn([f64; 2], [[f64; 2]; 2]) -> bool,
) -> impl Iterator<Item = ([f64; 2], f64)> {
    let triangle = corners == 3;
    let mut pieces = vec![Piece {
        origin: [0.0; 2],
        axes: [[1.0, 0.0], [0.0, 1.0]],
        depth: 0,
    }];
    let mut whole = Vec::new();
    while let Some(piece) = pieces.pop() {
        let middle = if triangle { [1.0 / 3.0; 2] } else { [0.0; 2] };
        if piece.depth == DEEPEST || !near(piece.at(middle), piece.axes) {
            whole.push(piece);
        } else if triangle {
            pieces.extend([[0.0, 0.0], [0.5, 0.0], [0.0, 0.5]].map(|o| piece.part(o, 0.5)));
            pieces.push(piece.part([0.5, 0.5], -0.5));
        } else {
            let quarters = [[-0.5, -0.5], [0.5, -0.5], [-0.5, 0.5], [0.5, 0.5]];
            pieces.extend(quarters.map(|o| piece.part(o, 0.5)));
        }
    }
    let square = GAUSS.map(|(a, u)| GAUSS.map(|(b, v)| ([a, b], u * v)));
    let points = match triangle {
        true => TRIANGLE.to_vec(),
        false => square.as_flattened().to_vec(),
    };
    whole.into_iter().flat_map(move |piece| {
        let [a, b] = piece.axes;
        let scale = (a[0] * b[1] - a[1] * b[0]).abs();
        let of_piece = |(xi, weight): &([f64; 2], f64)| (piece.at(*xi), scale * weight);
        points.iter().map(of_piece).collect::<Vec<_>>()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Areas and a moment stay, and `1/r` from a corner comes out.
    #[test]
    fn pieces_make_up_the_face() {
        for (corners, area) in [(3, 0.5), (4, 4.0)] {
            let corner = if corners == 3 { 0.0 } else { -1.0 };
            let away = |x: [f64; 2]| (x[0] - corner).hypot(x[1] - corner);
            let near =
                |x: [f64; 2], axes: [[f64; 2]; 2]| away(x) < 2.0 * axes[0][0].hypot(axes[0][1]);
            let all: Vec<_> = each(corners, near).collect();
            let sum = |f: &dyn Fn([f64; 2]) -> f64| all.iter().map(|(x, w)| w * f(*x)).sum::<f64>();
            assert!((sum(&|_| 1.0) - area).abs() < 1e-12);
            let quintic = sum(&|x| (x[0] - corner).powi(5));
            let exact = if corners == 3 { 1.0 / 42.0 } else { 64.0 / 3.0 };
            assert!((quintic / exact - 1.0).abs() < 1e-12, "{quintic}");
            // Over the triangle, and over twice that for each half of the square of side 2.
            let root = 2.0_f64.sqrt();
            let exact = match corners {
                3 => root * (1.0 + root).ln(),
                _ => 4.0 * (1.0 + root).ln(),
            };
            let found = sum(&|x| 1.0 / away(x));
            assert!((found / exact - 1.0).abs() < 3e-3, "{found} {exact}");
        }
    }
}

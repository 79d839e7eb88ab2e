//! Two families of parallel planes that are the flanks of a rack: their frame, and the rack through them.

use super::{RecognisedRack, flanks, sense};
use crate::recognise::axis::Axis;
use crate::recognise::skin::Skin;
use crate::recognise::specified_body::{Misfit, SpecifiedBody};
use crate::recognise::{FINE, extent, median};
use crate::vector::snapped;
use gearbench_models::Vec3;
use gearbench_models::geometry::Side;
use nalgebra::{SMatrix, SVector};

/// Largest number of groups of faces with one normal that are evaluated.
const MOST: usize = 40;

/// Sine of the angle within which normals coincide.
const ALIKE: f64 = 1e-2;

/// Cosine of the angle between left and right flanks: pressure angles of 5 to 45 degrees.
const BETWEEN: [f64; 2] = [-0.985, 0.0];

/// How far a flank may be from its even place [pitches]; far more than any pitch error.
const UNEVEN: f64 = 0.1;

/// Distance of planes, relative to the tooth height, below which they coincide.
const APART: f64 = 0.3;

/// Faces with one outward normal.
struct Gathering {
    normal: Vec3,
    area: f64,
    faces: Vec<u32>,
}

/// Faces by their normals, largest areas first.
fn gatherings(skin: &Skin<'_>) -> Vec<Gathering> {
    let mut order: Vec<usize> = (0..skin.facets.len()).collect();
    order.sort_by(|&a, &b| skin.areas[b].total_cmp(&skin.areas[a]));
    let mut all: Vec<Gathering> = Vec::new();
    for f in order {
        let (n, area) = (skin.normals[f], skin.areas[f]);
        let same = |g: &&mut Gathering| {
            n.dot(&g.normal) > 0.0 && n.cross(&g.normal).norm() < ALIKE * g.normal.norm()
        };
        let full = all.len() >= 400;
        match all.iter_mut().find(same) {
            // The sum of vector areas until all are there.
            Some(g) => {
                g.normal += area * n;
                g.area += area;
                g.faces.push(f as u32);
            }
            None if !full => all.push(Gathering {
                normal: area * n,
                area,
                faces: vec![f as u32],
            }),
            None => {}
        }
    }
    for g in &mut all {
        g.normal = g.normal.normalize();
    }
    all.sort_by(|a, b| b.area.total_cmp(&a.area));
    all.truncate(MOST);
    all
}

/// Middle of the corners of a face.
fn middle(skin: &Skin<'_>, face: u32) -> Vec3 {
    let corners = skin.facets[face as usize].corners();
    let sum = corners
        .iter()
        .map(|&n| skin.nodes[n as usize])
        .sum::<Vec3>();
    sum / corners.len() as f64
}

/// Recognises the rack whose surface this is.
///
/// # Errors
/// What was looked for and not found, or what is not as it is said.
pub fn recognise(skin: &Skin<'_>, known: &SpecifiedBody) -> Result<RecognisedRack, Misfit> {
    let all = gatherings(skin);
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for i in 0..all.len() {
        for j in 0..i {
            let cos = all[i].normal.dot(&all[j].normal);
            if (BETWEEN[0]..BETWEEN[1]).contains(&cos) {
                pairs.push((all[i].area + all[j].area, j, i));
            }
        }
    }
    pairs.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut refused: Option<(u8, String)> = None;
    for (_, i, j) in pairs {
        match of_pair(skin, &all, [&all[i], &all[j]], known) {
            Ok(rack) => {
                known.same_axis(&rack.axes[2])?;
                if known.flanks.is_some() {
                    return Err(Misfit::Against {
                        key: "flank_radii_m",
                        said: "radii about an axis".to_owned(),
                        found: "the body is a rack".to_owned(),
                    });
                }
                let axis = Axis {
                    direction: rack.axes[1],
                    point: rack.origin,
                };
                known.same_point(&axis, rack.tip + rack.root)?;
                return Ok(rack);
            }
            Err(why) => refused = refused.max(Some(why)),
        }
    }
    let why = refused.map_or("no two families of parallel planes".to_owned(), |r| r.1);
    Err(Misfit::Missing(format!("as a rack: {why}")))
}

/// Why two gatherings are not the flanks of a rack, behind how far they were followed.
type Refusal = (u8, String);

/// Own x, y and z of a rack with flanks of these normals, and the faces of its back.
fn frame(
    skin: &Skin<'_>,
    all: &[Gathering],
    flanks: [&Gathering; 2],
    known: &SpecifiedBody,
) -> Option<([Vec3; 3], Vec<u32>)> {
    let bisector = -(flanks[0].normal + flanks[1].normal).normalize();
    let back = all
        .iter()
        .filter(|g| g.normal.dot(&bisector) > (1.0 - 0.5 * ALIKE * ALIKE))
        .max_by(|a, b| a.area.total_cmp(&b.area))?;
    let out = |f: u32| middle(skin, f).dot(&back.normal);
    let furthest = back.faces.iter().map(|&f| out(f)).fold(f64::MIN, f64::max);
    let [low, high] = extent(skin.corner_nodes().iter().map(|&n| {
        let x = &skin.nodes[n as usize];
        x.dot(&back.normal)
    }));
    let near = 1e-3 * (high - low);
    if high - furthest > near {
        return None;
    }
    let outermost = |f: &u32| furthest - out(*f) < near;
    let faces: Vec<u32> = back.faces.iter().copied().filter(outermost).collect();
    let weighted = |f: &u32| skin.areas[*f as usize] * skin.normals[*f as usize];
    let x = faces.iter().map(weighted).sum::<Vec3>().normalize();
    // Teeth run along the planes of both flanks; the end faces stand across them, at the helix angle.
    let trace = flanks[0].normal.cross(&flanks[1].normal).normalize();
    let ends = all
        .iter()
        .filter(|g| g.normal.dot(&x).abs() < ALIKE && g.normal.dot(&trace).abs() > 0.75)
        .max_by(|a, b| {
            a.normal
                .dot(&trace)
                .abs()
                .total_cmp(&b.normal.dot(&trace).abs())
        });
    let z = ends.map_or(trace, |g| g.normal);
    let z = (z - z.dot(&x) * x).normalize();
    // Its sense is the one that is said, else that of its largest component.
    let said = known.unit_axis().map(|a| a.dot(&z));
    let z = if said.unwrap_or(z[z.iamax()]) < 0.0 {
        -z
    } else {
        z
    };
    let exact = |v: Vec3| {
        let most = v.iamax();
        let unit = Vec3::from_fn(|i, _| if i == most { v[most].signum() } else { 0.0 });
        if (v - unit).norm() < 1e-9 { unit } else { v }
    };
    let (x, z) = (exact(x), exact(z));
    Some(([x, z.cross(&x), z], faces))
}

/// Places along y of the parallel planes of a gathering, ascending.
fn planes(places: &mut [f64], apart: f64) -> Vec<f64> {
    places.sort_by(f64::total_cmp);
    let groups = places.chunk_by(|a, b| b - a < apart);
    groups.map(|g| g[g.len() / 2]).collect()
}

/// A node of a flank: steps of its tooth, side, own position about a first origin.
#[derive(Clone, Copy)]
struct Node {
    steps: f64,
    side: f64,
    x: Vec3,
}

/// `y_0, p, -tan(beta), h, tan(alpha_t)` by least squares, with the rms and the largest distance along y; `size` [m] makes
/// the columns of the matrix comparable.
fn fitted(nodes: &[Node], size: f64) -> Option<(SVector<f64, 5>, [f64; 2])> {
    let row = |n: &Node| {
        let (x, z) = (n.x.x / size, n.x.z / size);
        SVector::<f64, 5>::from([1.0, n.steps, z, n.side, n.side * x])
    };
    let (mut normal, mut right) = (SMatrix::<f64, 5, 5>::zeros(), SVector::<f64, 5>::zeros());
    for n in nodes {
        let r = row(n);
        normal += r * r.transpose();
        right += r * (n.x.y / size);
    }
    let inverse = normal.cholesky()?;
    let mut found = inverse.solve(&right);
    // Once more for the digits that the normal equations lose.
    let mut rest = SVector::<f64, 5>::zeros();
    for n in nodes {
        let r = row(n);
        rest += r * (n.x.y / size - r.dot(&found));
    }
    found += inverse.solve(&rest);
    let off = || {
        nodes
            .iter()
            .map(|n| size * (n.x.y / size - row(n).dot(&found)))
    };
    let square = off().map(|e| e * e).sum::<f64>() / nodes.len() as f64;
    let most = off().fold(0.0, |m: f64, e| m.max(e.abs()));
    let lengths = SVector::<f64, 5>::from([size, size, 1.0, size, 1.0]);
    let found = found.component_mul(&lengths);
    let finite = found.iter().all(|v| v.is_finite());
    finite.then_some((found, [square.sqrt(), most]))
}

fn of_pair(
    skin: &Skin<'_>,
    all: &[Gathering],
    flanks: [&Gathering; 2],
    known: &SpecifiedBody,
) -> Result<RecognisedRack, Refusal> {
    let no = |far: u8, why: String| (far, why);
    let (axes, back) = frame(skin, all, flanks, known)
        .ok_or_else(|| no(0, "no plane back against its teeth".into()))?;
    let [ex, ey, ez] = axes;
    let seen = |x: &Vec3| Vec3::new(x.dot(&ex), x.dot(&ey), x.dot(&ez));
    // Left flanks face -y.
    let [left, right] = match flanks[0].normal.dot(&ey) < 0.0 {
        true => flanks,
        false => [flanks[1], flanks[0]],
    };
    if left.normal.dot(&ey) >= 0.0 || right.normal.dot(&ey) <= 0.0 {
        return Err(no(0, "no flanks on both sides of its teeth".into()));
    }
    let nodes_of = |g: &Gathering| skin.nodes_of(&g.faces, false);
    let both: Vec<Vec3> = (nodes_of(left).into_iter().chain(nodes_of(right)))
        .map(|n| seen(&skin.nodes[n as usize]))
        .collect();
    let [top, bottom] = extent(both.iter().map(|x| x.x));
    let height = bottom - top;
    // About the middle of all of them, so that no digits are lost far from the origin.
    let centre = both.iter().sum::<Vec3>() / both.len() as f64;
    // Where the plane of a face passes the middle height and width.
    let at = |f: u32| {
        let (n, x) = (
            seen(&skin.normals[f as usize]),
            seen(&middle(skin, f)) - centre,
        );
        n.dot(&x) / n.y
    };
    let place = |g: &Gathering| -> Vec<f64> { g.faces.iter().map(|&f| at(f)).collect() };
    let [a, b] = [left, right].map(|g| planes(&mut place(g), APART * height));
    let steps = a.windows(2).chain(b.windows(2)).map(|w| w[1] - w[0]);
    let pitch = median(steps).filter(|_| a.len() > 1 || b.len() > 1);
    let pitch = pitch.ok_or_else(|| no(1, "only one tooth, so that there is no pitch".into()))?;
    let turns = |y: f64| (y - a[0]) / pitch;
    // Right flanks are offset by the tooth thickness.
    let thick = median(b.iter().map(|&y| turns(y).rem_euclid(1.0)))
        .ok_or_else(|| no(1, "no right flanks".into()))?;
    let uneven = |t: f64| (t - t.round()).abs() > UNEVEN;
    let worst = (a.iter().map(|&y| turns(y)))
        .chain(b.iter().map(|&y| turns(y) - thick))
        .find(|&t| uneven(t));
    if let Some(t) = worst {
        let off = (t - t.round()).abs();
        let count = a.len() + b.len();
        return Err(no(
            2,
            format!("{count} parallel planes, one of them {off:.2} pitches from equal spacing"),
        ));
    }
    let step = |f: u32, side: Side| match side {
        Side::Left => turns(at(f)).round(),
        Side::Right => (turns(at(f)) - thick).round(),
    };
    let teeth_of = |ys: &[f64], less: f64| -> Vec<f64> {
        ys.iter().map(|&y| (turns(y) - less).round()).collect()
    };
    let found: Vec<f64> = [teeth_of(&a, 0.0), teeth_of(&b, thick)].concat();
    let [first, last] = extent(found.iter().copied());
    // A large distance between planes must not produce a large count.
    let teeth = match last - first {
        more if more < found.len() as f64 => more as u32 + 1,
        more => return Err(no(2, format!("{} planes over {more} pitches", found.len()))),
    };
    // Tooth 0 has as many teeth below it as the geometry's.
    let zero = first + f64::from((teeth - 1) / 2);

    let mut nodes: Vec<Node> = Vec::new();
    for (g, side) in [(left, Side::Left), (right, Side::Right)] {
        let mut taken: Vec<(u32, i64)> = Vec::new();
        for &f in &g.faces {
            let tooth = step(f, side) - zero;
            taken.extend(
                skin.facets[f as usize]
                    .corners()
                    .iter()
                    .map(|&n| (n, tooth as i64)),
            );
        }
        taken.sort_unstable();
        taken.dedup();
        nodes.extend(taken.into_iter().map(|(n, steps)| Node {
            steps: steps as f64,
            side: sense(side),
            x: seen(&skin.nodes[n as usize]) - centre,
        }));
    }
    let fine = FINE * height;
    let singular = || no(2, "flanks that determine no rack".into());
    let (mut fit, mut residual) = fitted(&nodes, height).ok_or_else(singular)?;
    // The fit is repeated without the nodes of largest deviation: reliefs, and fillets whose faces have nearly the same
    // normal.
    for _ in 0..12 {
        let off = |n: &Node| {
            let half = fit[3] + n.x.x * fit[4];
            n.x.y - fit[0] - n.steps * fit[1] - fit[2] * n.x.z - n.side * half
        };
        let typical = median(nodes.iter().map(|n| off(n).abs())).unwrap_or(0.0);
        let limit = (6.0 * 1.4826 * typical).max(fine);
        let kept: Vec<Node> = nodes
            .iter()
            .copied()
            .filter(|n| off(n).abs() <= limit)
            .collect();
        let same = kept.len() == nodes.len();
        nodes = kept;
        (fit, residual) = fitted(&nodes, height).ok_or_else(singular)?;
        if same {
            break;
        }
    }
    let [y0, pitch, slope, half, tan] = [fit[0], fit[1], fit[2], fit[3], fit[4]];
    if !(residual[0] <= 0.01 * height && pitch > 0.0 && tan > 0.0) {
        return Err(no(
            3,
            format!(
                "flanks {:.1e} mm rms off planes at equal angles to the back",
                1e3 * residual[0]
            ),
        ));
    }
    // Half a tooth is a quarter of the pitch thick on the reference line.
    let line = (0.25 * pitch - half) / tan;
    let own = centre + Vec3::new(line, y0, 0.0);
    let mut rack = RecognisedRack {
        axes,
        origin: own.x * ex + own.y * ey + own.z * ez,
        teeth,
        pitch,
        pressure_angle: tan.atan(),
        helix_angle: snapped(-slope.atan(), 1.0),
        residual,
        nodes: nodes.len(),
        tip: 0.0,
        root: 0.0,
        back: 0.0,
        back_nodes: skin.nodes_of(&back, true),
        active: [0.0; 2],
        width: 0.0,
        flanks: Vec::new(),
    };
    rack.residual = residual.map(|r| r / rack.steepness());
    flanks::finished(skin, rack)
        .ok_or_else(|| no(3, "flanks without a face on their planes".into()))
}

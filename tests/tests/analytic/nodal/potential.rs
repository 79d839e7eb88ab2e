//! Forces are the gradient of one potential.

use super::*;

/// Returns the largest difference of `-dPi/dq` and the force over all coordinates, each moved as if flanks moved a
/// nanometre, with its work relative to the largest of its gear.
pub fn gradient_error(scene: &mut Scene, s: &State) -> f64 {
    let f = force(scene, s);
    let (scale, _) = scales(scene);
    let metre = scale.iter().map(|x| x / scene.magnitudes().deflection);
    let step: Vec<f64> = metre.map(|x| 1e-9 * x).collect();
    let mut error = 0.0_f64;
    let gears: Vec<_> = scene.gears().iter().map(|g| g.range()).collect();
    for range in gears {
        let size = range
            .clone()
            .fold(0.0_f64, |m, i| m.max((f[i] * step[i]).abs()));
        for i in range {
            // Fourth order: the gap is curved.
            let mut at = |x: f64| {
                let mut m = s.clone();
                m.q[i] += x * step[i];
                potential(scene, &m)
            };
            let change = (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / 12.0;
            error = error.max((change + f[i] * step[i]).abs() / size);
        }
    }
    error
}

/// All coordinates, on smooth and faceted flanks, with and without residual compliance, linear and not, through a
/// mesh cycle with its tip edges, loads on the hubs.
#[test]
fn forces_are_the_gradient_of_one_potential() {
    for (surface, passes, exponent, residual) in [
        (SurfaceKind::Smooth, Passes::First, 1.0, 2e-9),
        (SurfaceKind::Smooth, Passes::Both, 1.0, 2e-9),
        (SurfaceKind::Faceted, Passes::First, 1.0, 2e-9),
        (SurfaceKind::Smooth, Passes::Second, 1.0, 0.0),
        (SurfaceKind::Smooth, Passes::First, 1.5, 2e-9),
    ] {
        let points = PointContact {
            surface,
            passes,
            rule: quadrature(6, 2),
            ..PointContact::new(if exponent == 1.0 { 1e15 } else { 4e17 })
        };
        let contact = ContactSpec {
            exponent,
            ..with_points(points)
        };
        let mut spec = case_a(-12e-6);
        spec.gears[0].loads = vec![Load::Applied(Profile::Constant(20.0))];
        spec.gears[1].loads = vec![Load::Applied(Profile::Constant(30.0))];
        let model = toy(13, 3, 6, residual);
        let mut scene = build(&spec, &[model.clone(), model], &contact);
        let (mut worst, mut touching) = (0.0_f64, 0);
        for step in 0..12 {
            let mut s = scene.initial();
            roll(&spec, &scene, &mut s, 0.03 * f64::from(step));
            deform(&scene, &mut s, 3e-6, 7 + step as u64);
            touching += usize::from(scene.contact_forces(s.at()).len() > 5);
            worst = worst.max(gradient_error(&mut scene, &s));
        }
        println!(
            "{surface:?} {passes:?}, exponent {exponent}, residual {residual:e}: off by {worst:.1e}"
        );
        assert!(touching > 10, "{touching} states touch");
        assert!(worst < 1e-6, "{worst:.2e}");
    }
}

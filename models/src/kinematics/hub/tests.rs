use super::*;

/// Moves a hub by a small amount in one of its directions.
fn moved(hub: &Hub, direction: usize, by: f64, x: &Vec3) -> Vec3 {
    let along = hub.slide.unwrap_or(Vec3::x());
    let axes = [along, Vec3::z().cross(&along), Vec3::z()];
    match direction {
        0..3 => x + by * axes[direction],
        _ => x + by * axes[direction - 3].cross(&(x - hub.centre)),
    }
}

#[test]
fn a_wrench_has_the_components_of_the_six_motions() {
    let (x, n) = (Vec3::new(0.3, -0.2, 0.1), Vec3::new(0.48, 0.6, 0.64));
    for slide in [None, Some(Vec3::new(0.6, 0.8, 0.0))] {
        let hub = Hub::new(Mount::Fixed, Vec3::new(0.05, 0.1, -0.02), slide, 1.0);
        for direction in 0..6 {
            let work = (moved(&hub, direction, 1.0, &x) - x).dot(&n);
            let found = hub.component(direction, &x, &n);
            assert!((found - work).abs() < 1e-15, "{direction}: {found} {work}");
        }
    }
}

#[test]
fn mounts_leave_at_most_one_direction() {
    let speed = Profile::Constant(3.0);
    for (mount, slide, place, is) in [
        (Mount::Revolute, None, 5, Direction::Free),
        (Mount::Prismatic, Some(Vec3::y()), 0, Direction::Free),
        (
            Mount::Driven(speed.clone()),
            None,
            5,
            Direction::Driven(&speed),
        ),
        (Mount::Fixed, None, 5, Direction::Fixed),
    ] {
        let hub = Hub::new(mount, Vec3::zeros(), slide, 1.0);
        for (i, direction) in hub.directions().into_iter().enumerate() {
            let expected = if i == place { is } else { Direction::Fixed };
            assert_eq!(direction, expected);
        }
    }
}

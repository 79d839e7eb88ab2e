//! Tests that the prescribed rotation of driven gears continues from one speed to the next.

use super::*;

#[test]
fn a_driven_gear_goes_on_from_where_it_came() {
    for (t, turned, speed) in [(0.3, 70.0, -5.0), (2.0, -4.0, 80.0), (0.0, 0.0, 3.0)] {
        let p = constant_speed_from(t, turned, speed);
        assert!((p.integral(t) - turned).abs() <= 1e-12 * turned.abs());
        assert_eq!((p.value(t), p.slope(t)), (speed, 0.0));
        assert_eq!(p.next_breakpoint(t), f64::INFINITY);
    }
}

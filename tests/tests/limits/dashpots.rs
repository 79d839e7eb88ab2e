//! Dashpots at flanks with damped modes: velocity Verlet evaluates the first implicitly, the second at predicted
//! velocities.

use super::{entry, hold, with_modes};
use gearbench::experiment::configuration::Configuration;

/// Returns elastic gears of few modes with dashpots [N s/m^3], and modes damped by a ratio.
fn damped(dashpots: f64, ratio: f64) -> Configuration {
    let mut entry = with_modes(entry("spur_impact", "elastic"), 10);
    for gear in &mut entry.modelling.gears {
        gear.set("damping_ratio", ratio).unwrap();
    }
    for contact in &mut entry.modelling.contacts {
        if let Some(points) = contact.flanks.points_mut() {
            *points = points.damped(dashpots);
        }
    }
    entry.label = format!("elastic, {dashpots:.0e} N s/m3");
    entry
}

/// The stability limit with implicit dashpots is that of the modes, which are damped at predicted velocities.
#[test]
fn limits_with_dashpots_are_found_by_stepping() {
    let entries = [1e9, 1.6e10].map(|dashpots| damped(dashpots, 0.02));
    let rows = hold(
        &entries,
        &["velocity-verlet", "semi-implicit-euler", "rk4"],
        0.02,
    );
    assert_eq!(rows.len(), 2 * 3 * 2);
}

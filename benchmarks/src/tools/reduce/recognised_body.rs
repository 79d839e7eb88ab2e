//! Recognised geometry of a body without named flanks, as text and as JSON.

use super::report::some;
use gearbench_reference::recognise::{RecognisedBody, RecognisedGear, RecognisedRack};
use serde_json::{Value, json};

/// Formats a number with a number of decimals, without the sign of a zero.
pub(super) fn digits(x: f64, digits: usize) -> String {
    let text = format!("{x:.digits$}");
    match text.strip_prefix('-') {
        Some(zero) if zero.bytes().all(|b| b == b'0' || b == b'.') => zero.to_owned(),
        _ => text,
    }
}

fn triple(x: [f64; 3]) -> String {
    let [x, y, z] = x.map(|x| digits(x, 6));
    format!("({x}, {y}, {z})")
}

/// The recognised geometry of a body as JSON.
pub(super) fn to_json(found: &RecognisedBody) -> Value {
    let vector = |x: &gearbench_models::Vec3| [x.x, x.y, x.z];
    match found {
        RecognisedBody::Gear(f) => json!({
            "axis": vector(&f.axis.direction),
            "centre_m": vector(&f.axis.point),
            "tip_radius_m": f.tip.radius,
            "root_radius_m": f.root.radius,
            "bore_radius_m": f.bore.radius,
            "flank_radii_m": f.active,
        }),
        RecognisedBody::Rack(f) => json!({
            "axis": vector(&f.axes[2]),
            "pitch_direction": vector(&f.axes[1]),
            "centre_m": vector(&f.origin),
            "pitch_m": f.pitch,
            "pressure_angle_deg": f.normal_pressure_angle().to_degrees(),
            "helix_deg": f.helix_angle.to_degrees(),
            "tip_height_m": f.tip,
            "root_depth_m": f.root,
            "back_depth_m": f.back,
            "residual_rms_m": f.residual[0],
            "residual_most_m": f.residual[1],
            "nodes": f.nodes,
        }),
    }
}

/// The recognised geometry of a body as text.
pub(super) fn to_text(found: &RecognisedBody) -> String {
    match found {
        RecognisedBody::Gear(gear) => of_found_gear(gear),
        RecognisedBody::Rack(rack) => of_found_rack(rack),
    }
}

fn of_found_gear(f: &RecognisedGear) -> String {
    let mm = |x: f64| 1e3 * x;
    let at = f.axis.point.map(mm);
    format!(
        "no sets name its flanks: axis along {} through {} mm, {} from {:.4} to {:.4} mm, tips at {:.4} mm, roots at {:.4} mm, \
         bore {:.4} mm",
        triple(f.axis.direction.into()),
        triple(at.into()),
        some(f.flanks.len(), "flank"),
        mm(f.active[0]),
        mm(f.active[1]),
        mm(f.tip.radius),
        mm(f.root.radius),
        mm(f.bore.radius)
    )
}

fn of_found_rack(f: &RecognisedRack) -> String {
    let mm = |x: f64| 1e3 * x;
    let at = f.origin.map(mm);
    format!(
        "no sets name its flanks: pitch {:.6} mm along {}, width along {}, reference line through {} mm (teeth half a pitch \
         thick), pressure angle {} and helix {} degrees, {} from {} to {} mm about that line, tips {:.4} mm above it, roots \
         {:.4} mm and back {:.4} mm below; {} deviate from the planes by {:.1e} mm rms, {:.1e} mm at most",
        mm(f.pitch),
        triple(f.axes[1].into()),
        triple(f.axes[2].into()),
        triple(at.into()),
        digits(f.normal_pressure_angle().to_degrees(), 4),
        digits(f.helix_angle.to_degrees(), 4),
        some(f.flanks.len(), "flank"),
        digits(mm(f.active[0]), 4),
        digits(mm(f.active[1]), 4),
        mm(f.tip),
        mm(f.root),
        mm(f.back),
        some(f.nodes, "node"),
        mm(f.residual[0]),
        mm(f.residual[1])
    )
}

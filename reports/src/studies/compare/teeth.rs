//! Charts of the motion of teeth: position in the backlash of hammering gears, error of the speed ratio, deflection of
//! movable teeth and the forces on them.

use super::histories::{Histories, MemberColumn, legend_of, overlay};
use crate::drawing::Chart;
use crate::drawing::axis::Axis;
use crate::drawing::canvas::DrawError;
use crate::drawing::panel::{Panel, chart};
use crate::numbers::Prefix;
use crate::series::{
    self, BACKLASH_POSITION, SPEED_RATIO_ERROR, TOOTH_DEFLECTION, TOOTH_RADIAL_FORCE,
    TOOTH_SPRING_FORCE, TOOTH_TANGENTIAL_FORCE,
};
use crate::view::View;

/// A quantity of meshes or of gears.
struct Quantity {
    /// Quantity of the columns.
    of: series::Quantity,
    /// Name of the quantity in panels.
    words: &'static str,
    /// Endings of its columns with their units; a quantity of meshes has none.
    units: &'static [(&'static str, &'static str)],
    /// Sentence of the caption that defines the quantity.
    meaning: &'static str,
}

const FORCE: &[(&str, &str)] = &[("n", "N")];

const QUANTITIES: [Quantity; 6] = [
    Quantity {
        of: BACKLASH_POSITION,
        words: "place in the backlash",
        units: &[],
        meaning: "The place in the backlash is 0 where the flank that touches first does so without load and 1 where the other \
                  one does; beyond them teeth are deflected.",
    },
    Quantity {
        of: SPEED_RATIO_ERROR,
        words: "error of the speed ratio",
        units: &[],
        meaning: "The error of the speed ratio is the ratio of the hubs' speeds over that of the numbers of teeth, less 1.",
    },
    Quantity {
        of: TOOTH_DEFLECTION,
        words: "deflection of a tooth, S_i \u{2212} \u{3c6}",
        units: &[("rad", "rad"), ("m", "m")],
        meaning: "The deflection of a movable tooth is its angle less that of its body, of the touching tooth whose spring is \
                  loaded most, 0 while none touches; the forces are those on this tooth.",
    },
    Quantity {
        of: TOOTH_RADIAL_FORCE,
        words: "radial force F_n",
        units: FORCE,
        meaning: "The radial part of its contact force is positive away from the axis.",
    },
    Quantity {
        of: TOOTH_TANGENTIAL_FORCE,
        words: "tangential force F_t",
        units: FORCE,
        meaning: "The tangential part is positive counter-clockwise.",
    },
    Quantity {
        of: TOOTH_SPRING_FORCE,
        words: "spring force F_te",
        units: FORCE,
        meaning: "The spring force is that of spring and damper on the tooth, positive as the tangential part.",
    },
];

/// Draws the panels of the motion of teeth; `None` where no run has such a history.
pub fn teeth(views: &[View<'_>]) -> Result<Option<Chart>, DrawError> {
    let Some(h) = Histories::of(views) else {
        return Ok(None);
    };
    let mut drawn = ToothPanels::default();
    let mut said = Vec::new();
    for quantity in &QUANTITIES {
        let before = drawn.panels.len();
        match quantity.units {
            [] => {
                let meshes = h.meshes_with(quantity.of);
                let overlaid = overlay(meshes.len());
                drawn.add(&h, quantity, meshes, ("", overlaid));
            }
            units => {
                for (ending, unit) in units {
                    let gears = h.gears_with(quantity.of.in_unit(ending));
                    // The layout with fewer panels.
                    let overlaid = overlay(gears.len()) && h.models_with(&gears) < gears.len();
                    drawn.add(&h, quantity, gears, (unit, overlaid));
                }
            }
        }
        if drawn.panels.len() > before {
            said.push(quantity.meaning);
        }
    }
    if drawn.panels.is_empty() {
        return Ok(None);
    }
    let mut legend: Vec<_> = legend_of(&drawn.overlaid).collect();
    if drawn.has_models {
        legend.extend(h.legend());
    }
    let title = "Motion of the teeth";
    chart("teeth.svg", title, said.join(" "), &legend, &drawn.panels).map(Some)
}

/// Panels of a chart with the entries of its legend.
#[derive(Default)]
struct ToothPanels {
    panels: Vec<Panel>,
    /// Meshes and gears that have curves of their own.
    overlaid: Vec<MemberColumn>,
    /// Models have curves of their own.
    has_models: bool,
}

impl ToothPanels {
    /// Adds the panels of a quantity of some members, in a unit, laid over one another or not.
    fn add(
        &mut self,
        h: &Histories<'_>,
        quantity: &Quantity,
        members: Vec<MemberColumn>,
        (unit, overlaid): (&str, bool),
    ) {
        // One scale for all members, so that they compare.
        let (low, high) = h.extremes(&members);
        let (factor, label) = match unit {
            "" => (1.0, "[-]".to_owned()),
            _ => {
                let prefix = Prefix::of(high.max(-low), 1.0);
                (prefix.factor, format!("[{}{unit}]", prefix.symbol))
            }
        };
        let y = Axis::padded(low * factor, high * factor, 0.04);
        // A tooth that hammers does so all the time; the rest is read around the highest force.
        let time = match (quantity.units, &h.zoom) {
            ([_, ..], Some(zoom)) => zoom,
            _ => &h.time,
        };
        let height = if unit.is_empty() { 150.0 } else { 110.0 };
        let panel = |of: &str| {
            let remark = match of {
                "" => quantity.words.to_owned(),
                _ => format!("{}, {of}", quantity.words),
            };
            Panel {
                y: Some(y.clone()),
                ..Panel::new(height, &time.axis, &label).remark(remark)
            }
        };
        let mut panels = match overlaid {
            true => h.by_model(&members, factor, time, &panel),
            false => h.by_member(&members, factor, time, &panel),
        };
        let Some(last) = panels.last_mut() else {
            return;
        };
        last.x_name = Some(time.name.clone());
        self.panels.extend(panels);
        match overlaid {
            true => {
                let new =
                    |m: &MemberColumn| self.overlaid.iter().all(|known| known.style != m.style);
                let new: Vec<MemberColumn> = members.into_iter().filter(new).collect();
                self.overlaid.extend(new);
            }
            false => self.has_models = true,
        }
    }
}

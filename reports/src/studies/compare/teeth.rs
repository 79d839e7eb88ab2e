//! How teeth move: their place in the backlash where they hammer, the deflection of movable teeth, the error of the speed
//! ratio.

use super::histories::Histories;
use crate::drawing::Chart;
use crate::drawing::axis::Axis;
use crate::drawing::canvas::DrawError;
use crate::drawing::panel::{Panel, chart, extremes};
use crate::numbers::Prefix;
use crate::series::{BACKLASH_POSITION, SPEED_RATIO_ERROR, TOOTH_DEFLECTION, TimeSeries};
use crate::view::View;

/// Columns by what their names begin with: what a panel calls them, their unit, and what the caption says.
const QUANTITIES: [(&str, &str, &str, &str); 3] = [
    (
        BACKLASH_POSITION,
        "place in the backlash",
        "",
        "The place in the backlash is 0 where the flank that touches first does so without load and 1 where the other one does; \
         beyond them teeth are deflected.",
    ),
    (
        SPEED_RATIO_ERROR,
        "error of the speed ratio",
        "",
        "The error of the speed ratio is the ratio of the hubs' speeds over that of the numbers of teeth, less 1.",
    ),
    (
        TOOTH_DEFLECTION,
        "deflection of a tooth",
        "rad",
        "The deflection of a movable tooth is its angle less that of its body, of the touching tooth whose spring is \
         loaded most, 0 while none touches.",
    ),
];

/// Panels of the motion of teeth; none where no run has such a history.
pub fn teeth(view: &View<'_>) -> Result<Option<Chart>, DrawError> {
    let Some(h) = Histories::of(view) else {
        return Ok(None);
    };
    let all: Vec<&TimeSeries> = h.curves.iter().flat_map(|c| c.all_series()).collect();
    let (mut panels, mut said) = (Vec::new(), Vec::new());
    for (begin, words, unit, meaning) in QUANTITIES {
        let mut names: Vec<&str> = Vec::new();
        for c in all.iter().flat_map(|s| &s.columns) {
            if c.name.starts_with(begin) && !names.contains(&c.name.as_str()) {
                names.push(&c.name);
            }
        }
        // One scale for all gears and meshes, so that they compare.
        let values = || {
            names
                .iter()
                .flat_map(|name| all.iter().filter_map(|s| s.column(name)).flatten())
        };
        let (low, high) = extremes(values().copied().chain([0.0]));
        let (factor, label) = match unit {
            "" => (1.0, "[-]".to_owned()),
            _ => {
                let prefix = Prefix::of(high.max(-low), 1.0);
                (prefix.factor, format!("[{}{unit}]", prefix.symbol))
            }
        };
        let y = Axis::linear(low * factor, high * factor);
        for name in &names {
            let of = name[begin.len()..]
                .trim_start_matches('_')
                .trim_end_matches("_rad");
            let of = match of {
                "" => String::new(),
                _ => format!(", {}", of.replace('_', " ")),
            };
            // A tooth that hammers does so all the time; the rest is read around the highest force.
            let time = match (begin, &h.zoom) {
                (TOOTH_DEFLECTION, Some(zoom)) => zoom,
                _ => &h.time,
            };
            panels.push(Panel {
                x_name: Some(time.name.clone()),
                y: Some(y.clone()),
                ..Panel::new(150.0, &time.axis, &label)
                    .remark(format!("{words}{of}"))
                    .curves(h.lines(|s| s.column(name), factor, time))
                    .close()
            });
        }
        if !names.is_empty() {
            said.push(meaning);
        }
    }
    if panels.is_empty() {
        return Ok(None);
    }
    let title = "Motion of the teeth";
    chart("teeth.svg", title, said.join(" "), &h.legend(), &panels).map(Some)
}

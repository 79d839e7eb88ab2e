//! Natural modes in motion, for the pages of `modes`, `response`, `sweep` and `stability`: the viewer of moving gears, and its still
//! picture.

use super::modes::ModelModes;
use super::solid;
use crate::drawing::Chart;
use crate::drawing::canvas::{Anchor, DrawError, Ink, Stroke, Type, draw, text_width};
use crate::drawing::geometry::Rect;
use crate::drawing::panel::WIDTH;
use crate::drawing::style::curve_style;
use crate::markup::gears::{MovingMode, MovingModel, Viewer};
use crate::numbers::{counted, quantity, short};
use crate::record::{GearMotion, MeshMode};

/// File of the still picture.
const FILE: &str = "modes_moving.svg";
/// Part of the period at which the viewer begins: the amplitude.
const AMPLITUDE: f64 = 0.25;
/// Modes in the still picture, and its height.
const MOST_STILL: usize = 3;
const HEIGHT: f64 = 300.0;
/// Drawn displacement over the size of the scene.
const DRAWN: f64 = 0.04;

/// Returns the still picture and the viewer of the modes of models; `None` of records without their motion.
pub fn of_modes(vibrations: &[ModelModes]) -> Result<Option<(Chart, Viewer)>, DrawError> {
    let named = |(style, v)| -> Option<ModelMotion<'_>> {
        let v: &ModelModes = v;
        let motion = v.motion.as_ref()?;
        let names = v.modes.iter().take(motion.frames().saturating_sub(1));
        let names = names.enumerate().map(|(i, m)| {
            let times = match m.multiplicity {
                1 => String::new(),
                n => format!(" ({n}\u{d7})"),
            };
            let frequency = match m.frequency_hz > 0.0 {
                true => format!("{}{times}, ", quantity(m.frequency_hz, "Hz", 4)),
                false => String::new(),
            };
            let name = format!("{}: {frequency}{}", i + 1, m.name);
            (name, m.frequency_hz <= 0.0)
        });
        Some((&v.label, style, motion, names.collect()))
    };
    let all: Vec<ModelMotion<'_>> = (vibrations.iter().enumerate()).filter_map(named).collect();
    let Some((mut chart, viewer)) = moving(&all)? else {
        return Ok(None);
    };
    for (label, _, _, shown) in &all {
        let listed = vibrations.iter().find(|v| v.label == **label);
        if listed.is_some_and(|v| shown.len() < v.modes.len()) {
            chart.caption += &format!(" Of {label} the first {} modes move.", shown.len());
        }
    }
    Ok(Some((chart, viewer)))
}

/// Returns the still picture and the viewer of mesh modes; `None` of records without their motion.
pub fn of_mesh_modes(all: &[MeshMode]) -> Result<Option<(Chart, Viewer)>, DrawError> {
    let named = |(style, m)| -> Option<ModelMotion<'_>> {
        let m: &MeshMode = m;
        let frequency = quantity(m.frequency_hz?, "Hz", 4);
        let name = format!("mesh mode, {frequency}");
        Some((&m.label, style, m.motion.as_ref()?, vec![(name, false)]))
    };
    let all: Vec<ModelMotion<'_>> = all.iter().enumerate().filter_map(named).collect();
    moving(&all)
}

/// Label, style, motion of a model, and its modes: name, and whether the motion is rigid.
type ModelMotion<'a> = (&'a str, usize, &'a GearMotion, Vec<(String, bool)>);

fn moving(all: &[ModelMotion<'_>]) -> Result<Option<(Chart, Viewer)>, DrawError> {
    let models: Vec<MovingModel<'_>> = (all.iter())
        .map(|(label, style, motion, names)| MovingModel {
            label,
            integrator: "",
            style: *style,
            motion,
            modes: (names.iter().enumerate())
                .map(|(i, (name, is_rigid))| MovingMode {
                    name: name.clone(),
                    is_rigid: *is_rigid,
                    largest_m: motion.largest_displacement(i + 1).unwrap_or(0.0),
                })
                .collect(),
        })
        .collect();
    let Some(first) = models.first() else {
        return Ok(None);
    };
    let mut chart = still(first)?;
    let Some((viewer, left_out)) = Viewer::fitting(FILE, models, AMPLITUDE) else {
        return Ok(None);
    };
    if !left_out.is_empty() {
        let labels = left_out.join("; ");
        chart.caption += &format!(" Models that do not fit into the page: {labels}.");
    }
    Ok(Some((chart, viewer)))
}

/// Returns a round number that is no larger.
fn rounded(x: f64) -> f64 {
    let power = 10f64.powf(x.log10().floor());
    let part = [5.0, 2.0, 1.0].into_iter().find(|m| m * power <= x);
    part.unwrap_or(1.0) * power
}

/// Draws the first vibrating modes of a model at their amplitude, as rigid bodies.
fn still(model: &MovingModel<'_>) -> Result<Chart, DrawError> {
    let motion = model.motion;
    let all = model.modes.iter().enumerate();
    let mut drawn: Vec<(usize, &MovingMode)> = all.clone().filter(|(_, m)| !m.is_rigid).collect();
    if drawn.is_empty() {
        drawn = all.collect();
    }
    drawn.truncate(MOST_STILL);
    let outlines: Vec<Vec<[f64; 2]>> = (motion.bodies.iter())
        .map(|b| b.outline(b.heights_m.len() / 2).unwrap_or_default())
        .collect();
    let reach =
        |points: &Vec<[f64; 2]>| points.iter().map(|p| p[0].hypot(p[1])).fold(0.0, f64::max);
    let centre = |k: usize| motion.paths.iter().map(move |p| p.origin_m[k]);
    let spread = (0..3).map(|k| {
        let high = centre(k).fold(f64::NEG_INFINITY, f64::max);
        high - centre(k).fold(f64::INFINITY, f64::min)
    });
    let size = 2.0 * outlines.iter().map(reach).fold(0.0, f64::max) + spread.fold(0.0, f64::max);
    let count = drawn.len().max(1) as f64;
    let wide = WIDTH / count;
    let title = "Modes in motion";
    let mut factors = Vec::new();
    let svg = draw(WIDTH, HEIGHT, title, |c| {
        for (i, (place, mode)) in drawn.iter().enumerate() {
            let left = wide * i as f64;
            let area = Rect::new(left + 4.0, 26.0, left + wide - 4.0, HEIGHT - 4.0);
            let factor = match mode.largest_m > 0.0 {
                true => rounded(DRAWN * size / mode.largest_m),
                false => 1.0,
            };
            factors.push(factor);
            let font = (12.5 * (wide - 14.0) / text_width(&mode.name, 12.5)).clamp(7.5, 12.5);
            let at = (left + 0.5 * wide, 13.0);
            c.text(&mode.name, at, Type::new(font, Anchor::Middle));
            solid::paint(
                c,
                motion,
                (place + 1, factor, curve_style(model.style).ink),
                &area,
            );
            c.frame(&area, Stroke::new(Ink::PALE, 1.0));
        }
    })?;
    let factors: Vec<String> = factors.iter().map(|f| short(*f, 2)).collect();
    Ok(Chart {
        file: FILE.into(),
        title: title.into(),
        caption: format!(
            "A mode of each model, all at the same phase; on paper and without scripts {} of {} at the amplitude, drawn \u{d7} {} and \
             without the deformation of bodies. The amplitude of a mode is arbitrary, here about 1 \u{b5}m at a flank; the \
             factor of the drawing is below each picture, and magnified flanks overlap. In a section, gears at rest are dashed.",
            counted(drawn.len(), "mode", "modes"),
            model.label,
            factors.join(", ")
        ),
        svg,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_round_and_not_larger() {
        for (x, expected) in [(1.0, 1.0), (9.9, 5.0), (2400.0, 2000.0), (0.07, 0.05)] {
            assert!((rounded(x) - expected).abs() < 1e-12 * expected, "{x}");
        }
    }
}

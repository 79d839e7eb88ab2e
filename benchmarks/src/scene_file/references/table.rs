//! Reading of reference tables: columns, units and subjects.

use super::super::SceneError;
use super::super::reading::Place;
use super::{
    DecimalWord, DelimiterWord, ForceKindWord, ReferenceConditions, ReferenceTable, SceneParts,
    columns,
};
use gearbench_models::spec::{Body, Mount, Profile, SceneSpec};
use gearbench_reference::data::{
    ForceKind, GearSubject, MeshSubject, Processing, Request, Subjects, Turning,
};

/// Builds the request by which a reference table is read.
pub(super) fn request(
    keys: &ReferenceTable,
    conditions: &ReferenceConditions,
    beside: &SceneParts<'_>,
    at: &Place<'_>,
) -> Result<Request, SceneError> {
    let end = conditions.duration.unwrap_or(beside.duration);
    let from = keys.from_s.unwrap_or(0.0).max(0.0);
    let to = keys.to_s.map_or(end, |t| t.0.min(end));
    if from >= to {
        return at.first(&["from_s", "to_s"]).refuse(
            format!("the time window from {from:e} s to {to:e} s is empty"),
            "empty window",
            format!("the scene lasts {end:e} s: give `from_s` below `to_s` within it"),
        );
    }
    let (time, columns) = columns::columns(keys.columns.as_ref(), beside.spec, &at.key("columns"))?;
    let (time_unit, units) = columns::units(keys.units.as_ref(), beside.spec, &at.key("units"))?;
    Ok(Request {
        time,
        columns,
        time_unit,
        units,
        force_kind: keys.force_kind.map(|kind| match kind {
            ForceKindWord::Normal => ForceKind::Normal,
            ForceKindWord::Transverse => ForceKind::Transverse,
        }),
        delimiter: keys.delimiter.map(DelimiterWord::delimiter),
        decimal_comma: keys.decimal.map(|d| matches!(d, DecimalWord::Comma)),
        processing: Processing {
            time_factor: keys.time_factor.map(f64::from),
            offset: keys.offset_s,
            zero: keys.zero_over_s,
            moving_average: keys.moving_average_s.map(f64::from),
            from,
            to: Some(to),
            resample: keys.resample_s.map(f64::from),
        },
    })
}

/// Gears and meshes of a scene that columns can refer to.
pub fn subjects(spec: &SceneSpec) -> Subjects {
    let mate = |gear: usize| {
        let other = spec.meshes.iter().find_map(|m| match m.gears {
            [a, b] if a == gear => Some(b),
            [a, b] if b == gear => Some(a),
            _ => None,
        })?;
        match &spec.gears.get(other)?.body {
            Body::Gear(mate) => Some(mate.r_reference()),
            Body::Rack(_) => None,
        }
    };
    let gears = spec.gears.iter().enumerate();
    let bodies = spec.bodies().map(|b| GearSubject {
        name: b.name.clone(),
        slides: None,
        toothed: false,
    });
    let turning = spec.meshes.first().and_then(|m| {
        let gear = spec.gears.get(m.gears[0])?;
        let speed = match &gear.mount {
            Mount::Driven(Profile::Constant(speed)) => *speed,
            Mount::Driven(_) | Mount::Fixed => return None,
            _ => gear.speed,
        };
        match &gear.body {
            Body::Gear(g) => Some(Turning {
                speed,
                teeth: g.teeth(),
            }),
            Body::Rack(_) => None,
        }
    });
    Subjects {
        turning,
        gears: gears
            .map(|(i, g)| GearSubject {
                name: g.name.clone(),
                slides: match g.body {
                    Body::Gear(_) => None,
                    Body::Rack(_) => Some(mate(i).unwrap_or(1.0)),
                },
                toothed: true,
            })
            .chain(bodies)
            .collect(),
        spans: columns::spans(spec),
        meshes: (spec.meshes.iter())
            .map(|m| MeshSubject {
                gears: spec.names_of(m.gears).map(str::to_owned),
                base_helix: spec.gears[m.gears[0]].body.base_helix_angle(),
                base_radius: match &spec.gears[m.gears[1]].body {
                    Body::Gear(gear) => Some(gear.r_base()),
                    Body::Rack(_) => None,
                },
            })
            .collect(),
    }
}

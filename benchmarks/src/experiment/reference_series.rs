//! Conversion of references to the form of records.
//!
//! A record has one series over the times of the contact force, else of the longest history, and one for the histories on
//! each other axis of times.

use crate::scene_file::references::subjects;
use gearbench_models::scene::{Channel, OfGear, OfMesh};
use gearbench_models::spec::SceneSpec;
use gearbench_reference::data::{self, Quantity, Reference};
use gearbench_reports::record::ReferenceSeries;
use gearbench_reports::series::{Column, SPEED, TRANSMISSION_ERROR, TimeSeries};
use std::cmp::Reverse;

/// Converts a reference to the form of the record of a scene.
pub fn recorded(r: &Reference, scene: &SceneSpec) -> ReferenceSeries {
    let mut all: Vec<TimeSeries> = Vec::new();
    // Contact forces first, then what has most samples: their times are those of the series that stands in all records.
    let mut channels: Vec<&data::Channel> = r.channels.iter().collect();
    channels.sort_by_key(|c| {
        (
            !matches!(c.quantity, Quantity::Force(_)),
            Reverse(c.time.len()),
        )
    });
    for channel in channels {
        let place = all.iter().position(|s| s.time_s == channel.time);
        let index = place.unwrap_or_else(|| {
            all.push(TimeSeries {
                time_s: channel.time.clone(),
                ..TimeSeries::default()
            });
            all.len() - 1
        });
        add_channel(&mut all[index], channel, scene);
    }
    let mut all = all.into_iter();
    ReferenceSeries {
        id: r.id.clone(),
        title: r.title.clone(),
        source: r.source.clone(),
        note: r.note.clone(),
        own_error: r.own_error,
        command: r.command.clone(),
        cpu_s: r.cpu_s,
        processing: r.processing.clone(),
        series: all.next().unwrap_or_default(),
        further: all.collect(),
    }
}

/// Returns the channel of runs with a quantity; a transmission error is made of two angles and has none.
pub fn channel_of(quantity: Quantity) -> Option<Channel> {
    Some(match quantity {
        Quantity::Force(m) => Channel::Mesh(m, OfMesh::Force),
        Quantity::TransmissionError(_) => return None,
        Quantity::Speed(g) => Channel::Gear(g, OfGear::Speed),
        Quantity::Angle(g) => Channel::Gear(g, OfGear::Displacement),
        Quantity::Torque(g) => Channel::Gear(g, OfGear::ContactTorque),
        Quantity::MountTorque(g) => Channel::Gear(g, OfGear::MountTorque),
        Quantity::ShaftTorque(s) => Channel::ShaftTorque(s),
    })
}

/// Adds a history to the series with the same times.
fn add_channel(series: &mut TimeSeries, channel: &data::Channel, scene: &SceneSpec) {
    let mut values = channel.value.clone();
    let name = match channel.quantity {
        // A rack as its mate would turn.
        Quantity::Speed(g) => {
            let subjects = subjects(scene);
            let gear = &subjects.gears[g];
            let radius = gear.slides.unwrap_or(1.0);
            values.iter_mut().for_each(|v| *v /= radius);
            SPEED.of(&gear.name)
        }
        Quantity::TransmissionError(m) => match scene.meshes.get(m) {
            Some(mesh) => TRANSMISSION_ERROR.of_mesh(&scene.names_of(mesh.gears)),
            None => return,
        },
        other => match channel_of(other) {
            Some(channel) => channel.column(scene),
            None => return,
        },
    };
    series.columns.push(Column::new(name, values));
}

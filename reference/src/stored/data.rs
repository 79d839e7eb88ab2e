//! A stored reference as data.

use super::ExternalReference;
use crate::data::{Channel, Quantity, Reference};

impl ExternalReference {
    /// Returns the histories of contact force and speeds; `gears` are the positions of its two gears in a scene. A
    /// fixed rack is at rest.
    pub fn data(&self, gears: [usize; 2]) -> Reference {
        let h = &self.history;
        let channel = |quantity, value: &[f64]| Channel {
            quantity,
            time: h.time.clone(),
            value: value.to_vec(),
        };
        Reference {
            // Records name the program; the title and source say which case.
            id: self.id.split('/').next().unwrap_or(self.id).to_string(),
            title: self
                .title
                .split(", impact")
                .next()
                .unwrap_or(self.title)
                .to_string(),
            source: format!("{} ({})", self.title, self.id),
            note: self.note.into(),
            own_error: self.own_error,
            command: Some(self.regenerate.to_string()),
            cpu_s: Some(self.summary.cpu_s),
            channels: vec![
                channel(Quantity::Force(0), &h.contact_force),
                channel(Quantity::Speed(gears[0]), &h.omega1_mean),
                channel(Quantity::Speed(gears[1]), &h.omega2_mean),
            ],
            ..Reference::default()
        }
    }
}

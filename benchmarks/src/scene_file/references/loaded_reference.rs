//! Data of references, and comparison of their stated conditions with the scene.

use super::super::{SceneError, SceneFile, tables};
use super::conditions::stated;
use super::{DataOrigin, NamedReference, Role, subjects};
use gearbench_reference::data::{self, Quantity, Reference, Request};
use gearbench_reference::reference;
use gearbench_reports::Metric;
use gearbench_reports::numbers::short;
use std::path::Path;

/// Largest size of a table [bytes].
const LARGEST: u64 = 1 << 30;
/// Relative deviation below which a condition counts as equal.
const SAME: f64 = 1e-4;

/// A reference with its data.
#[derive(Clone, Debug)]
pub struct LoadedReference {
    /// The entry of the scene.
    pub named: NamedReference,
    /// The histories of the reference.
    pub data: Reference,
    /// The scene under the conditions of the reference: speeds, loads, distance, start and duration.
    pub scene: SceneFile,
}

impl SceneFile {
    /// Reads all references of the scene, in the order of the file: those under its own conditions and those under
    /// others ([`NamedReference::is_of_the_scene`]). A reference of other gears, speeds or loads than the scene has
    /// under the conditions of that reference is refused, unless the user insists (`any`); then the difference becomes
    /// a warning of the scene.
    ///
    /// # Errors
    /// [`SceneError`] at the line of the scene, or of the file with the data.
    pub fn load_references(&mut self, any: bool) -> Result<Vec<LoadedReference>, SceneError> {
        let named = self.references.clone();
        named
            .into_iter()
            .map(|r| self.load_reference(r, any))
            .collect()
    }

    /// Reads the references under the conditions of the scene itself, with which its models are compared.
    ///
    /// # Errors
    /// As [`SceneFile::load_references`]; references under other conditions are not read.
    pub fn load_own_references(&mut self, any: bool) -> Result<Vec<Reference>, SceneError> {
        let own = |r: &&NamedReference| r.is_of_the_scene();
        let named: Vec<_> = self.references.iter().filter(own).cloned().collect();
        let held = named.into_iter().map(|r| self.load_reference(r, any));
        held.map(|h| h.map(|h| h.data)).collect()
    }

    fn load_reference(
        &mut self,
        named: NamedReference,
        any: bool,
    ) -> Result<LoadedReference, SceneError> {
        let scene = self.with(&named.conditions).map_err(|(key, why, help)| {
            let place = self.document.at(&*named.at);
            place.error(format!("`{key}`: {why}"), "not possible", help)
        })?;
        let (mut data, differs) = match &named.origin {
            DataOrigin::Stored(id) => {
                let place = self.document.at(&*named.at);
                // Ids that are not known are refused when the scene is read.
                let found = reference(id).map_err(|e| {
                    place.error(
                        e.to_string(),
                        "cannot be read",
                        "`gearbench list` names the references",
                    )
                })?;
                let gears = scene.spec.meshes.first().map_or([0, 1], |m| m.gears);
                let differs = scene.differs_from(&found.parameters);
                (found.data(gears), differs)
            }
            DataOrigin::Csv { path, request } => {
                let data = self.table(&named, path, request)?;
                let differs = scene.differs_from_stated(&data.stated);
                (data, differs)
            }
        };
        data.id.clone_from(&named.name);
        if let Some(title) = &named.title {
            data.title.clone_from(title);
        }
        if let Some(source) = &named.source {
            data.source.clone_from(source);
        }
        data.own_error = named.own_error.or(data.own_error);
        self.can_be_told(&data)?;
        self.odd.extend(self.negative_force(&named, &data));
        if !differs.is_empty() {
            let place = self.document.at(&*named.at);
            let error = place.error(
                format!(
                    "the reference belongs to other conditions than the scene: {}",
                    differs.join(", ")
                ),
                "reference of other conditions",
                match (self.fitting(), named.stored()) {
                    (Some(fitting), _) => format!("write `{fitting}`, or use this reference with --any-reference"),
                    (None, Some(_)) => "no stored reference belongs to these gears, speeds and loads: remove it, or use it with --any-reference".into(),
                    (None, None) => "give the conditions that differ in the table of the reference, such as gears.pinion.speed_rad_s, duration_s, gap_m; compute it again with `gearbench reference`; or use it with --any-reference".into(),
                },
            );
            if !any {
                return Err(error);
            }
            self.odd.push(error);
        }
        Ok(LoadedReference { named, data, scene })
    }

    /// A warning about contact forces that point the other way: contact forces of runs are magnitudes, so that no model
    /// comes near such a reference, and each fits its negative far better.
    fn negative_force(&self, named: &NamedReference, data: &Reference) -> Option<SceneError> {
        let forces = data.channels.iter();
        let mut forces = forces.filter(|c| matches!(c.quantity, Quantity::Force(_)));
        let (least, greatest) = forces.find_map(|c| {
            let least = c.value.iter().copied().fold(0.0, f64::min);
            let greatest = c.value.iter().copied().fold(0.0, f64::max);
            (-least > greatest).then_some((least, greatest))
        })?;
        Some(self.document.at(&*named.at).error(
            format!(
                "the contact force of the reference \"{}\" is negative, from {} to {} N",
                data.id,
                short(least, 4),
                short(greatest, 4)
            ),
            "sign of the force",
            "contact forces of runs are magnitudes: change the sign of the column, otherwise errors exceed 100 %",
        ))
    }

    /// Refuses a tolerance in a metric that its reference cannot provide.
    fn can_be_told(&self, data: &Reference) -> Result<(), SceneError> {
        let Some(tolerance) = self.tolerance.as_ref().filter(|t| t.against == data.id) else {
            return Ok(());
        };
        let of_any = |kind: fn(&Quantity) -> bool| data.channels.iter().any(|c| kind(&c.quantity));
        let force = of_any(|q| matches!(q, Quantity::Force(_)));
        let speeds = of_any(|q| matches!(q, Quantity::Speed(_)));
        let error = of_any(|q| matches!(q, Quantity::TransmissionError(_)));
        let angles = of_any(|q| matches!(q, Quantity::Angle(_)));
        let torques = of_any(|q| {
            matches!(
                q,
                Quantity::Torque(_) | Quantity::MountTorque(_) | Quantity::ShaftTorque(_)
            )
        });
        let (told, lacking) = match tolerance.metric {
            Metric::ForceL1
            | Metric::ForceL2
            | Metric::ForceL2Aligned
            | Metric::TimeShift
            | Metric::PeakForceRel
            | Metric::RmsForceRel
            | Metric::ImpulseRel => (force, "contact force"),
            Metric::Rebound | Metric::Speed => (speeds, "speed of a gear"),
            Metric::TransmissionError
            | Metric::TransmissionErrorSpanRel
            | Metric::TransmissionErrorOrders
            | Metric::TransmissionErrorAligned => (error, "transmission error"),
            Metric::Angle => (angles, "angle"),
            Metric::Torque | Metric::TorquePeakRel => (torques, "torque"),
            _ => return Ok(()),
        };
        if told {
            return Ok(());
        }
        let others = [
            (force, Metric::ForceL2Aligned),
            (speeds, Metric::Rebound),
            (error, Metric::TransmissionError),
            (angles, Metric::Angle),
            (torques, Metric::Torque),
        ];
        let others: Vec<&str> = others.iter().filter(|o| o.0).map(|o| o.1.key()).collect();
        self.document.at("tolerance").refuse(
            format!(
                "the tolerance limits {} against \"{}\", which has no {lacking}",
                tolerance.metric, data.id
            ),
            "undefined for this reference",
            match others.is_empty() {
                true => "write `against = \"self\"`, or remove the tolerance".into(),
                false => format!(
                    "write `metric` {}, or `against = \"self\"`",
                    others.join(" or ")
                ),
            },
        )
    }

    /// Reads the data of a table.
    fn table(
        &self,
        named: &NamedReference,
        path: &Path,
        request: &Request,
    ) -> Result<Reference, SceneError> {
        let place = self.document.at(&*named.at);
        let place = place.first(&["csv"]);
        let from = "paths are relative to the folder of the scene file";
        let text = tables::text(path, LARGEST, from)
            .map_err(|e| place.error(e.why, "this file", e.help))?;
        // A table over the angle of rotation counts by the speed of its own conditions.
        let mut spec = self.spec.clone();
        if named.conditions.apply(&mut spec).is_err() {
            spec = self.spec.clone();
        }
        let mut data = data::read(&text.decoded, request, &subjects(&spec))
            .map_err(|e| text.error(&e, &format!("reference \"{}\"", named.name)))?;
        if text.latin {
            data.processing
                .insert(0, "read as Latin-1, since it is not UTF-8".into());
        }
        let told = |key: &str| {
            let lines = text
                .decoded
                .lines()
                .map_while(|l| l.trim().strip_prefix('#'));
            let mut found = lines.filter_map(|l| l.trim().strip_prefix(key)?.strip_prefix(": "));
            found.next().map(str::to_owned)
        };
        data.title = told("title").unwrap_or_else(|| named.name.clone());
        data.source = told("source").unwrap_or_else(|| text.name.clone());
        data.note = told("note").unwrap_or_default();
        data.command = told("command");
        Ok(data)
    }

    /// Returns the conditions stated in the data that differ from the scene.
    fn differs_from_stated(&self, of: &[(String, f64)]) -> Vec<String> {
        let own = stated(&self.spec);
        let differs = |(key, theirs): &(String, f64)| {
            let (_, ours) = own.iter().find(|(k, _)| k == key)?;
            let scale = ours.abs().max(theirs.abs());
            let same = (ours - theirs).abs() <= SAME * scale;
            (!same).then(|| format!("`{key}` {ours} (reference: {theirs})"))
        };
        of.iter().filter_map(differs).collect()
    }
}

impl LoadedReference {
    /// True if the reference is held out from fits and serves for validation only.
    pub fn is_held_out(&self) -> bool {
        self.named.role == Role::Validate
    }
}

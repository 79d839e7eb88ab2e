//! Selection of models of a scene by their labels.

use super::reading::suggest;
use super::{ModelChoice, SceneError, SceneFile};

impl SceneFile {
    /// Selects models by their labels, separated by commas; `None` selects those of the study. Models that cannot run
    /// the scene ([`SceneFile::refused`]) are left out.
    ///
    /// # Errors
    /// [`SceneError`] with the known labels, or with the reasons why none of the models can run.
    pub fn select(&self, labels: Option<&str>) -> Result<Vec<&ModelChoice>, SceneError> {
        let wanted: Vec<&str> = match labels {
            Some(text) => text
                .split(',')
                .map(str::trim)
                .filter(|l| !l.is_empty())
                .collect(),
            None => self.study.models.iter().map(String::as_str).collect(),
        };
        let known: Vec<&str> = self.models.iter().map(|m| m.label.as_str()).collect();
        if wanted.is_empty() {
            return Err(SceneError::plain(
                "no model is named",
                format!("`{}` has {}", self.name, known.join(", ")),
            ));
        }
        // A repeated label is run once.
        let mut once: Vec<&str> = Vec::new();
        for label in wanted {
            if !once.contains(&label) {
                once.push(label);
            }
        }
        let found: Result<Vec<&ModelChoice>, SceneError> = once
            .iter()
            .map(|label| {
                self.model(label).ok_or_else(|| {
                    let near = suggest::did_you_mean(label, &known);
                    SceneError::plain(
                        format!("the scene `{}` has no model `{label}`", self.name),
                        format!("{near}it has {}", known.join(", ")),
                    )
                })
            })
            .collect();
        let mut found = found?;
        found.retain(|m| !self.is_refused(&m.label));
        if found.is_empty() {
            let asked = self
                .refused
                .iter()
                .filter(|r| once.contains(&r.label.as_str()));
            return Err(SceneError::all_of(asked.map(|r| r.error.clone())));
        }
        Ok(found)
    }

    /// Selects models by their labels; `None` selects those of the study but for full finite elements.
    ///
    /// # Errors
    /// [`SceneError`] as of [`SceneFile::select`].
    pub fn select_reduced(&self, labels: Option<&str>) -> Result<Vec<&ModelChoice>, SceneError> {
        let mut found = self.select(labels)?;
        found.retain(|m| labels.is_some() || !self.properties_of(&m.model).full_order);
        Ok(found)
    }

    /// Selects the models of the study of accuracy against cost, which may have defaults of its own.
    ///
    /// # Errors
    /// [`SceneError`] lists the labels there are.
    pub fn select_precision(&self, labels: Option<&str>) -> Result<Vec<&ModelChoice>, SceneError> {
        let own = self.study.precision.models.join(",");
        self.select(labels.or((!own.is_empty()).then_some(own.as_str())))
    }
}

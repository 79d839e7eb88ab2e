//! The array `meta`: JSON text with the origin of a basis.

use super::error::{StoreError, StoreErrorKind, refused, unusable, value};
use super::names::{META, MOST};
use super::{Meta, Motion, SCHEMA};
use crate::hash::Hash;
use crate::mesh::ElementKind;
use crate::reduction::Basis;
use serde_json::{Value, json};

/// Entry of reductions that have it; others leave it out.
pub(super) const ALONG_PROFILE: &str = "along_profile";
pub(super) const NEAR_FIELD: &str = "near_field";
pub(super) const LATERAL: &str = "lateral";

pub(super) fn text(b: &Basis, meta: &Meta) -> String {
    let mut entries = json!({
        "format": "gearbench reduction",
        "schema": SCHEMA,
        "program": meta.program,
        "source": meta.source,
        "mesh": meta.mesh.to_string(),
        "key": meta.key.to_string(),
        "mount": if b.free { "free" } else { "held" },
        "motion": match meta.motion {
            Motion::Turn => "turn",
            Motion::Slide => "slide",
        },
        "element": meta.element,
        "teeth": meta.teeth,
        "nodes": meta.nodes,
        "elements": meta.elements,
        "unknowns": b.unknowns,
        "asked": meta.asked,
        "integrals": b.integrals.is_some(),
    });
    if b.along_profile {
        entries[ALONG_PROFILE] = json!(true);
    }
    if b.near_field.is_some() {
        entries[NEAR_FIELD] = json!(true);
    }
    if b.lateral.is_some() {
        entries[LATERAL] = json!(true);
    }
    entries.to_string()
}

/// Entries of the array `meta`.
pub(super) struct Entries(Value);

impl Entries {
    pub(super) fn read(bytes: &[u8]) -> Result<Self, StoreError> {
        let text = serde_json::from_slice(bytes);
        let entries = Entries(text.map_err(|e| value(META, "JSON text", e.to_string()))?);
        match entries.0.get("schema").and_then(Value::as_u64) {
            Some(SCHEMA) => Ok(entries),
            Some(newer) if newer > SCHEMA => Err(refused(
                StoreErrorKind::Newer,
                META,
                format!("schema {SCHEMA}"),
                format!("schema {newer}"),
                "a newer gearbench reads it; or make it again with this one: `gearbench reduce`",
            )),
            other => Err(value(
                META,
                format!("schema {SCHEMA}"),
                other.map_or("none".to_owned(), |s| format!("schema {s}")),
            )),
        }
    }

    pub(super) fn get<T>(
        &self,
        name: &str,
        what: &str,
        as_t: impl Fn(&Value) -> Option<T>,
    ) -> Result<T, StoreError> {
        let found = self.0.get(name);
        found.and_then(as_t).ok_or_else(|| {
            unusable(
                match found {
                    Some(_) => StoreErrorKind::Value,
                    None => StoreErrorKind::Missing,
                },
                META,
                format!("`{name}`, {what}"),
                found.map_or("no such entry".to_owned(), |v| {
                    v.to_string().chars().take(60).collect()
                }),
            )
        })
    }

    pub(super) fn flag(&self, name: &str) -> Option<bool> {
        self.0.get(name).and_then(Value::as_bool)
    }

    pub(super) fn text(&self, name: &str) -> Result<String, StoreError> {
        self.get(name, "a text", |v| v.as_str().map(str::to_owned))
    }

    pub(super) fn count(&self, name: &str) -> Result<usize, StoreError> {
        self.get(name, "a count", |v| {
            v.as_u64().filter(|n| *n <= MOST as u64).map(|n| n as usize)
        })
    }

    pub(super) fn word<T: Copy>(&self, name: &str, words: &[(&str, T)]) -> Result<T, StoreError> {
        let known: Vec<&str> = words.iter().map(|w| w.0).collect();
        self.get(name, &format!("one of {}", known.join(", ")), |v| {
            let text = v.as_str()?;
            words.iter().find(|w| w.0 == text).map(|w| w.1)
        })
    }

    /// Names of kinds of elements.
    pub(super) fn kinds(&self, name: &str) -> Result<String, StoreError> {
        let known = ElementKind::ALL.map(ElementKind::name).join(", ");
        self.get(name, &format!("some of {known}"), |v| {
            let text = v.as_str()?;
            let all = text
                .split(", ")
                .all(|k| ElementKind::from_name(k).is_some());
            all.then(|| text.to_owned())
        })
    }

    pub(super) fn hash(&self, name: &str) -> Result<Hash, StoreError> {
        self.get(name, "32 hexadecimal digits", |v| {
            v.as_str().and_then(Hash::from_hex)
        })
    }
}

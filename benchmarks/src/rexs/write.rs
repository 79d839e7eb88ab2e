//! A model as XML or JSON.

use super::model::{AttributeValue, Component, Model, Relation, Value};
use gearbench_reports::escape::xml;
use serde_json::{Value as Json, json};
use std::fmt::Write as _;

/// Name of the program in files.
const APPLICATION: &str = "gearbench";

/// The text of a model as XML (`.rexs`).
pub fn to_xml(model: &Model) -> String {
    let mut out = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    // Writing to a string does not fail.
    let _ = writeln!(
        out,
        "<model version=\"{}\" applicationId=\"{APPLICATION}\" applicationVersion=\"{}\" date=\"1970-01-01T00:00:00+00:00\">\n  <relations>",
        xml(&model.version),
        env!("CARGO_PKG_VERSION")
    );
    for (i, relation) in model.relations.iter().enumerate() {
        out.push_str(&relation_of(i + 1, relation, model));
    }
    out.push_str("  </relations>\n  <components>\n");
    for component in &model.components {
        out.push_str(&component_of(component));
    }
    out.push_str("  </components>\n</model>\n");
    out
}

/// Type of a component, as the hint of a reference.
fn hint(model: &Model, id: u64) -> &str {
    model.component(id).map_or("", |c| c.kind.as_str())
}

fn relation_of(id: usize, relation: &Relation, model: &Model) -> String {
    let order = relation.order.map(|o| format!(" order=\"{o}\""));
    let mut out = format!(
        "    <relation id=\"{id}\" type=\"{}\"{}>\n",
        relation.kind,
        order.unwrap_or_default()
    );
    for (role, of) in &relation.refs {
        let hint = hint(model, *of);
        let _ = writeln!(
            out,
            "      <ref id=\"{of}\" role=\"{role}\" hint=\"{hint}\"/>"
        );
    }
    out.push_str("    </relation>\n");
    out
}

fn component_of(component: &Component) -> String {
    let mut out = format!(
        "    <component id=\"{}\" type=\"{}\" name=\"{}\">\n",
        component.id,
        component.kind,
        xml(&component.name)
    );
    for (name, AttributeValue { unit, value }) in &component.attributes {
        let head = format!("      <attribute id=\"{name}\" unit=\"{}\">", xml(unit));
        let _ = match value {
            Value::Text(text) => writeln!(out, "{head}{}</attribute>", xml(text)),
            Value::Numbers(list) => {
                let list: String = list.iter().map(|x| format!("<c>{x}</c>")).collect();
                writeln!(out, "{head}<array>{list}</array></attribute>")
            }
            Value::Other => Ok(()),
        };
    }
    out.push_str("    </component>\n");
    out
}

/// The text of a model as JSON (`.rexsj`).
pub fn to_json(model: &Model) -> String {
    let relations = model.relations.iter().enumerate().map(|(i, relation)| {
        let refs: Vec<Json> = (relation.refs.iter())
            .map(|(role, id)| json!({"id": id, "role": role, "hint": hint(model, *id)}))
            .collect();
        let mut out = json!({"id": i + 1, "type": relation.kind, "refs": refs});
        if let Some(order) = relation.order {
            out["order"] = order.into();
        }
        out
    });
    let attribute = |(name, own): (&String, &AttributeValue)| {
        let mut out = json!({"id": name, "unit": own.unit});
        match &own.value {
            Value::Numbers(list) => out["floating_point_array"] = json!(list),
            Value::Text(text) => match (text.parse::<u64>(), text.parse::<f64>()) {
                // Numbers of teeth are whole; all other quantities have fractions.
                (Ok(n), _) if name == "number_of_teeth" => out["integer"] = n.into(),
                (_, Ok(x)) => out["floating_point"] = json!(x),
                _ if text == "true" || text == "false" => out["boolean"] = (text == "true").into(),
                _ => out["enum"] = text.clone().into(),
            },
            Value::Other => return None,
        }
        Some(out)
    };
    let components = model.components.iter().map(|c| {
        let attributes: Vec<Json> = c.attributes.iter().filter_map(attribute).collect();
        json!({"id": c.id, "type": c.kind, "name": c.name, "attributes": attributes})
    });
    let all = json!({"model": {
        "version": model.version,
        "applicationId": APPLICATION,
        "applicationVersion": env!("CARGO_PKG_VERSION"),
        "date": "1970-01-01T00:00:00+00:00",
        "relations": relations.collect::<Vec<_>>(),
        "components": components.collect::<Vec<_>>(),
    }});
    let mut text = serde_json::to_string_pretty(&all).unwrap_or_default();
    text.push('\n');
    text
}

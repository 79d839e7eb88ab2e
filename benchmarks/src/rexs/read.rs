//! Reading of files of REXS: XML (`.rexs`), JSON (`.rexsj`) and a zip of either (`.rexsz`, `.zip`). The form is that of the
//! content, whatever the name.
//!
//! Files are bounded in size, also unpacked; documents with a DTD are refused, so that no entity expands.

use super::model::{AttributeValue, Component, LoadCase, Model, Relation, Value};
use crate::scene_file::SceneError;
use flate2::bufread::DeflateDecoder;
use gearbench_reference::files;
use rawzip::{CompressionMethod, ZipArchive};
use roxmltree::{Document, Node, ParsingOptions};
use serde_json::Value as Json;
use std::io::Read;
use std::path::Path;

/// Largest size of a file, packed or not [bytes].
const MOST_BYTES: u64 = 64 << 20;
/// Largest number of nodes of a document.
const MOST_NODES: u32 = 4_000_000;

fn bad(why: impl Into<String>, help: &str) -> SceneError {
    SceneError::plain(why, help)
}

const EXPECTED: &str = "expected a model of REXS 1.0 to 2.0: XML (.rexs), JSON (.rexsj), or one of them in a zip (.rexsz)";

/// Reads a model from a file.
///
/// # Errors
/// [`SceneError`] with the place in the document, where it has one.
pub fn read(path: &Path) -> Result<Model, SceneError> {
    let name = path.display();
    let bytes = files::read(path, MOST_BYTES).map_err(|e| bad(format!("{name}: {e}"), EXPECTED))?;
    of_bytes(&bytes).map_err(|e| {
        let help = e.help_text().unwrap_or(EXPECTED).to_owned();
        bad(format!("{name}: {}", e.message()), &help)
    })
}

/// Reads a model from the content of a file.
///
/// # Errors
/// As [`read`].
pub fn of_bytes(bytes: &[u8]) -> Result<Model, SceneError> {
    if bytes.starts_with(b"PK") {
        return of_document(&unpacked(bytes)?);
    }
    of_document(bytes)
}

fn of_document(bytes: &[u8]) -> Result<Model, SceneError> {
    let text = std::str::from_utf8(bytes)
        .map_err(|e| bad(format!("byte {} is not UTF-8", e.valid_up_to()), EXPECTED))?;
    let text = text.trim_start_matches('\u{feff}');
    let model = match text.trim_start().chars().next() {
        Some('<') => of_xml(text)?,
        Some('{') => of_json(text)?,
        _ => return Err(bad("this is neither XML nor JSON", EXPECTED)),
    };
    let major = model.version.split('.').next().unwrap_or_default();
    if !matches!(major, "1" | "2") {
        return Err(bad(
            format!("the version of the model is {:?}", model.version),
            "gearbench reads REXS 1.0 to 2.0",
        ));
    }
    Ok(model)
}

/// The first model in a zip.
fn unpacked(bytes: &[u8]) -> Result<Vec<u8>, SceneError> {
    let refuse = |e: &dyn std::fmt::Display| bad(format!("the zip cannot be read: {e}"), EXPECTED);
    let archive = ZipArchive::from_slice(bytes).map_err(|e| refuse(&e))?;
    for entry in archive.entries() {
        let entry = entry.map_err(|e| refuse(&e))?;
        let name = String::from_utf8_lossy(entry.file_path().as_ref()).to_lowercase();
        let end = Path::new(&name).extension().unwrap_or_default().to_owned();
        if !["rexs", "rexsj", "xml", "json"].iter().any(|e| end == *e) {
            continue;
        }
        let packed = archive
            .get_entry(entry.wayfinder())
            .map_err(|e| refuse(&e))?;
        let mut content = Vec::new();
        let mut fill = |reader: &mut dyn Read| {
            let read = reader.take(MOST_BYTES + 1).read_to_end(&mut content);
            read.map_err(|e| refuse(&e))
        };
        match entry.compression_method() {
            CompressionMethod::STORE => fill(&mut packed.data())?,
            CompressionMethod::DEFLATE => fill(&mut DeflateDecoder::new(packed.data()))?,
            other => return Err(refuse(&format!("compression {other:?} of `{name}`"))),
        };
        if content.len() as u64 > MOST_BYTES {
            return Err(refuse(&format!(
                "`{name}` has more than {MOST_BYTES} bytes"
            )));
        }
        return Ok(content);
    }
    Err(bad("the zip contains no model", EXPECTED))
}

fn of_xml(text: &str) -> Result<Model, SceneError> {
    let options = ParsingOptions {
        allow_dtd: false,
        nodes_limit: MOST_NODES,
        ..ParsingOptions::default()
    };
    let document =
        Document::parse_with_options(text, options).map_err(|e| bad(e.to_string(), EXPECTED))?;
    let root = document.root_element();
    if root.tag_name().name() != "model" {
        let found = root.tag_name().name();
        return Err(bad(
            format!("the root of the document is <{found}>"),
            EXPECTED,
        ));
    }
    let attribute = |name: &str| root.attribute(name).unwrap_or_default().to_owned();
    let mut model = Model {
        version: attribute("version"),
        application: attribute("applicationId"),
        ..Model::default()
    };
    for part in root.children().filter(Node::is_element) {
        match part.tag_name().name() {
            "components" => model.components = components(part)?,
            "relations" => {
                let all = elements(part, "relation").map(relation);
                model.relations = all.collect::<Result<_, _>>()?;
            }
            "load_spectrum" => {
                for case in elements(part, "load_case") {
                    model.load_cases.push(LoadCase {
                        id: id(case)?,
                        components: components(case)?,
                    });
                }
            }
            _ => {}
        }
    }
    Ok(model)
}

fn elements<'a>(of: Node<'a, 'a>, name: &'static str) -> impl Iterator<Item = Node<'a, 'a>> {
    of.children()
        .filter(move |n| n.is_element() && n.tag_name().name() == name)
}

/// The attribute `id` of an element, a whole number.
fn id(node: Node<'_, '_>) -> Result<u64, SceneError> {
    let text = node.attribute("id").unwrap_or_default();
    text.parse().map_err(|_| {
        let line = node.document().text_pos_at(node.range().start).row;
        let name = node.tag_name().name();
        bad(
            format!("line {line}: the id of <{name}> is {text:?}"),
            "expected a whole number",
        )
    })
}

fn components(of: Node<'_, '_>) -> Result<Vec<Component>, SceneError> {
    let read = |node: Node<'_, '_>| {
        let text = |name: &str| node.attribute(name).unwrap_or_default().to_owned();
        let attributes = elements(node, "attribute").map(|a| {
            let value = AttributeValue {
                unit: a.attribute("unit").unwrap_or_default().to_owned(),
                value: value(a),
            };
            (a.attribute("id").unwrap_or_default().to_owned(), value)
        });
        Ok(Component {
            id: id(node)?,
            kind: text("type"),
            name: text("name"),
            attributes: attributes.collect(),
        })
    };
    elements(of, "component").map(read).collect()
}

fn value(node: Node<'_, '_>) -> Value {
    match node.first_element_child() {
        None => Value::Text(node.text().unwrap_or_default().trim().to_owned()),
        Some(list) if list.tag_name().name() == "array" => {
            let code = list.attribute("code");
            let numbers = match code {
                Some(code) => decoded(code, list.text().unwrap_or_default()),
                None => elements(list, "c")
                    .map(|c| c.text()?.trim().parse::<f64>().ok())
                    .collect(),
            };
            numbers.map_or(Value::Other, Value::Numbers)
        }
        Some(_) => Value::Other,
    }
}

/// Numbers that are stored in base64, little-endian.
fn decoded(code: &str, text: &str) -> Option<Vec<f64>> {
    let bytes = base64(text)?;
    match code {
        "float64" => {
            let all = bytes.chunks_exact(8);
            all.remainder().is_empty().then(|| {
                all.map(|b| f64::from_le_bytes(b.try_into().unwrap_or_default()))
                    .collect()
            })
        }
        "float32" => {
            let all = bytes.chunks_exact(4);
            all.remainder().is_empty().then(|| {
                all.map(|b| f64::from(f32::from_le_bytes(b.try_into().unwrap_or_default())))
                    .collect()
            })
        }
        "int32" => {
            let all = bytes.chunks_exact(4);
            all.remainder().is_empty().then(|| {
                all.map(|b| f64::from(i32::from_le_bytes(b.try_into().unwrap_or_default())))
                    .collect()
            })
        }
        _ => None,
    }
}

/// Bytes of a text in base64 (RFC 4648); spaces and line breaks are passed over.
fn base64(text: &str) -> Option<Vec<u8>> {
    let digit = |c: u8| match c {
        b'A'..=b'Z' => Some(c - b'A'),
        b'a'..=b'z' => Some(c - b'a' + 26),
        b'0'..=b'9' => Some(c - b'0' + 52),
        b'+' => Some(62),
        b'/' => Some(63),
        _ => None,
    };
    let (mut bits, mut held, mut bytes) = (0_u32, 0, Vec::new());
    for c in text.bytes().filter(|c| !c.is_ascii_whitespace()) {
        if c == b'=' {
            break;
        }
        bits = (bits << 6) | u32::from(digit(c)?);
        held += 6;
        if held >= 8 {
            held -= 8;
            bytes.push((bits >> held) as u8);
        }
    }
    Some(bytes)
}

fn relation(node: Node<'_, '_>) -> Result<Relation, SceneError> {
    let refs = elements(node, "ref").map(|r| {
        let role = r.attribute("role").unwrap_or_default().to_owned();
        Ok((role, id(r)?))
    });
    Ok(Relation {
        kind: node.attribute("type").unwrap_or_default().to_owned(),
        order: node.attribute("order").and_then(|o| o.parse().ok()),
        refs: refs.collect::<Result<_, SceneError>>()?,
    })
}

fn of_json(text: &str) -> Result<Model, SceneError> {
    let all: Json = serde_json::from_str(text).map_err(|e| bad(e.to_string(), EXPECTED))?;
    let root = &all["model"];
    if !root.is_object() {
        return Err(bad("the document has no object \"model\"", EXPECTED));
    }
    let text = |of: &Json, name: &str| of[name].as_str().unwrap_or_default().to_owned();
    let list = |of: &Json| of.as_array().cloned().unwrap_or_default();
    let number = |of: &Json, what: &str| {
        of["id"].as_u64().ok_or_else(|| {
            bad(
                format!("the id of a {what} is {}", of["id"]),
                "expected a whole number",
            )
        })
    };
    let attribute = |a: &Json| {
        let value = AttributeValue {
            unit: text(a, "unit"),
            value: value_of_json(a),
        };
        (text(a, "id"), value)
    };
    let component = |c: &Json| {
        Ok(Component {
            id: number(c, "component")?,
            kind: text(c, "type"),
            name: text(c, "name"),
            attributes: list(&c["attributes"]).iter().map(attribute).collect(),
        })
    };
    let components = |of: &Json| -> Result<Vec<Component>, SceneError> {
        list(&of["components"]).iter().map(component).collect()
    };
    let relation = |r: &Json| {
        let refs = list(&r["refs"]);
        let refs = refs
            .iter()
            .map(|x| Ok((text(x, "role"), number(x, "reference")?)));
        Ok(Relation {
            kind: text(r, "type"),
            order: r["order"].as_i64(),
            refs: refs.collect::<Result<_, SceneError>>()?,
        })
    };
    let mut load_cases = Vec::new();
    for case in list(&root["load_spectrum"]["load_cases"]) {
        load_cases.push(LoadCase {
            id: number(&case, "load case")?,
            components: components(&case)?,
        });
    }
    let relations = list(&root["relations"]);
    Ok(Model {
        version: text(root, "version"),
        application: text(root, "applicationId"),
        components: components(root)?,
        relations: relations
            .iter()
            .map(relation)
            .collect::<Result<_, SceneError>>()?,
        load_cases,
    })
}

/// The value of an attribute: the one key beside `id` and `unit` has the type in its name.
fn value_of_json(of: &Json) -> Value {
    let entries = of.as_object().into_iter().flatten();
    let mut own = entries.filter(|(key, _)| !matches!(key.as_str(), "id" | "unit"));
    match own.next() {
        Some((_, Json::Number(x))) => Value::Text(x.to_string()),
        Some((_, Json::String(text))) => Value::Text(text.clone()),
        Some((_, Json::Bool(flag))) => Value::Text(flag.to_string()),
        Some((_, Json::Array(list))) => {
            let numbers: Option<Vec<f64>> = list.iter().map(Json::as_f64).collect();
            numbers.map_or(Value::Other, Value::Numbers)
        }
        Some((_, coded @ Json::Object(_))) => {
            let text = |key: &str| coded[key].as_str().unwrap_or_default();
            let numbers = decoded(text("code"), text("value"));
            numbers.map_or(Value::Other, Value::Numbers)
        }
        _ => Value::Other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_that_of_its_standard() {
        // Examples of RFC 4648, section 10.
        for (text, bytes) in [
            ("", ""),
            ("Zg==", "f"),
            ("Zm9v", "foo"),
            ("Zm9vYg==", "foob"),
        ] {
            assert_eq!(base64(text).unwrap(), bytes.as_bytes());
        }
        assert!(base64("Zm9*").is_none());
        // 1.0 and -2.5 as float64, little-endian.
        let numbers = decoded("float64", "AAAAAAAA8D8AAAAAAAAEwA==").unwrap();
        assert_eq!(numbers, [1.0, -2.5]);
    }

    #[test]
    fn what_is_no_model_is_refused() {
        for (bytes, why) in [
            (&b""[..], "neither XML nor JSON"),
            (b"\xff\xfe", "not UTF-8"),
            (b"<a/>", "root of the document is <a>"),
            (b"<model version=\"1.0\">", "never closed"),
            (b"{\"model\": 3}", "no object"),
            (b"<model version=\"9.0\"/>", "version of the model"),
            (b"PK\x03\x04", "zip cannot be read"),
            (
                b"<!DOCTYPE m [<!ENTITY a \"b\">]><model version=\"1.0\">&a;</model>",
                "DTD",
            ),
        ] {
            let e = of_bytes(bytes).unwrap_err();
            assert!(e.message().contains(why), "{}", e.message());
        }
    }
}

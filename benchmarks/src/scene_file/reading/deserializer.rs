//! Deserialiser of a TOML value with its place in the file.
//!
//! Beyond serde's data model it reads three kinds of enumerations, which the format writes as plain TOML:
//!
//! | in the file | in Rust |
//! |---|---|
//! | a word, or a table with one key | a unit variant, or the variant of the key (serde's own form) |
//! | a word, or a table with a tag: `{ law = "flores", e = 0.9 }` | an enum renamed `<law>`; the variant reads the other keys. `<kind=gear>` gives the tag a default |
//! | a value of one of several types | variants renamed `<number>`, `<text>`, `<flag>`, `<list>`, `<table>` |
//!
//! A newtype renamed `<gear>` reads a name that the file itself defines, [`Context::known`](super::node::Context); one
//! renamed `<distinct>` reads a list without duplicates. Lists are never empty, numbers always finite.

use super::flaw::Flaw;
use super::keys::{self, Table};
use super::node::Node;
use super::suggest;
use serde::de::value::StrDeserializer;
use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, Error, Expected, IntoDeserializer, MapAccess,
    SeqAccess, VariantAccess, Visitor,
};
use serde::forward_to_deserialize_any;
use std::sync::LazyLock;
use toml::de::{DeTable, DeValue};

static EMPTY: LazyLock<DeValue<'static>> = LazyLock::new(|| DeValue::Table(DeTable::new()));

impl<'d> Node<'d> {
    /// Splits an enumeration into variant and content.
    fn choice(
        &self,
        name: &'static str,
        variants: &'static [&'static str],
    ) -> Result<(&'static str, Node<'d>), Flaw> {
        let kind = match self.value {
            DeValue::String(_) => "<text>",
            DeValue::Integer(_) | DeValue::Float(_) => "<number>",
            DeValue::Boolean(_) => "<flag>",
            DeValue::Array(_) => "<list>",
            DeValue::Table(_) => "<table>",
            DeValue::Datetime(_) => "",
        };
        let known = |word: &str| variants.iter().find(|v| **v == word).copied();
        if let Some(variant) = known(kind) {
            return Ok((variant, *self));
        }
        let words: Vec<&'static str> = (variants.iter().copied())
            .filter(|v| !v.starts_with('<'))
            .collect();
        let tag = name.strip_prefix('<').and_then(|n| n.strip_suffix('>'));
        match (kind, tag) {
            ("<text>", _) if !words.is_empty() => {
                let word = self.text()?;
                let Some(variant) = known(word) else {
                    return Err(Flaw::Placed(self.unknown_word(word, &words)));
                };
                let value: &'d DeValue<'d> = &EMPTY;
                Ok((variant, Node { value, ..*self }))
            }
            ("<table>", Some(tag)) => {
                let (tag, default) = tag.split_once('=').unwrap_or((tag, ""));
                let at = self.entries()?.into_iter().find(|e| e.key == tag);
                let word = match at.map(|e| self.value_of(e)) {
                    Some(at) => match known(at.text()?) {
                        Some(word) => word,
                        None => return Err(Flaw::Placed(at.unknown_word(at.text()?, &words))),
                    },
                    None => match known(default) {
                        Some(word) => word,
                        None => {
                            let meaning = format!("one of {}", words.join(", "));
                            return Err(Flaw::Placed(self.missing(tag, &meaning)));
                        }
                    },
                };
                let tag = Some(tag);
                Ok((word, Node { tag, ..*self }))
            }
            ("<table>", None) if !words.is_empty() => self.only(&words),
            _ if words.is_empty() => {
                let kinds: Vec<&str> = variants
                    .iter()
                    .map(|v| v.trim_matches(['<', '>']))
                    .collect();
                self.expected(&format!("a {}", kinds.join(" or a ")))
            }
            _ => self.expected(&format!("one of {}", suggest::words(&words))),
        }
    }

    /// Returns the only entry of a table that requires exactly one of its keys.
    fn only(&self, words: &[&'static str]) -> Result<(&'static str, Node<'d>), Flaw> {
        let entries = self.entries()?;
        let [entry, more @ ..] = entries.as_slice() else {
            return self.refuse(
                format!("{} is empty", self.called()),
                "here",
                format!("give one of {}; {}", suggest::words(words), self.help()),
            );
        };
        if let Some(second) = more.first() {
            let help = format!("give one of {}; {}", suggest::words(words), self.help());
            let message = format!("{} has exactly one key", self.called());
            let error = second.error(message, "and this", help);
            return Err(Flaw::Placed(error.and(entry.at.0..entry.at.1, "this")));
        }
        match words.iter().find(|w| **w == entry.key) {
            Some(word) => {
                let meaning = self.meaning;
                let value = self.value_of(*entry);
                Ok((*word, Node { meaning, ..value }))
            }
            None => Err(Flaw::Placed(self.unknown_key(entry, words, None))),
        }
    }
}

impl<'d> Deserializer<'d> for Node<'d> {
    type Error = Flaw;

    fn deserialize_any<V: Visitor<'d>>(self, visitor: V) -> Result<V::Value, Flaw> {
        match self.value {
            DeValue::String(_) => self.deserialize_str(visitor),
            DeValue::Integer(_) | DeValue::Float(_) => self.deserialize_f64(visitor),
            DeValue::Boolean(_) => self.deserialize_bool(visitor),
            DeValue::Array(_) => self.deserialize_seq(visitor),
            DeValue::Table(_) => self.deserialize_map(visitor),
            DeValue::Datetime(_) => self.expected(&(&visitor as &dyn Expected).to_string()),
        }
    }

    fn deserialize_f64<V: Visitor<'d>>(self, visitor: V) -> Result<V::Value, Flaw> {
        visitor.visit_f64(self.number()?)
    }

    fn deserialize_u32<V: Visitor<'d>>(self, visitor: V) -> Result<V::Value, Flaw> {
        visitor.visit_u32(self.whole()?)
    }

    fn deserialize_bool<V: Visitor<'d>>(self, visitor: V) -> Result<V::Value, Flaw> {
        match self.value {
            DeValue::Boolean(b) => visitor.visit_bool(*b),
            _ => self.expected("true or false"),
        }
    }

    fn deserialize_str<V: Visitor<'d>>(self, visitor: V) -> Result<V::Value, Flaw> {
        visitor.visit_str(self.text()?)
    }

    fn deserialize_string<V: Visitor<'d>>(self, visitor: V) -> Result<V::Value, Flaw> {
        self.deserialize_str(visitor)
    }

    fn deserialize_option<V: Visitor<'d>>(self, visitor: V) -> Result<V::Value, Flaw> {
        visitor.visit_some(self)
    }

    fn deserialize_newtype_struct<V: Visitor<'d>>(
        mut self,
        name: &'static str,
        visitor: V,
    ) -> Result<V::Value, Flaw> {
        if let Some(known) = self.context.known(name) {
            let word = self.text()?;
            if !known.iter().any(|k| k == word) {
                return self.refuse(
                    format!("there is no {} `{word}`", name.trim_matches(['<', '>'])),
                    "not known",
                    suggest::there_are(word, known),
                );
            }
        }
        self.distinct = name == "<distinct>";
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_seq<V: Visitor<'d>>(self, visitor: V) -> Result<V::Value, Flaw> {
        let DeValue::Array(members) = self.value else {
            return self.expected("a list");
        };
        if members.is_empty() {
            let message = format!("`{}` is empty", self.key);
            return self.refuse(message, "expected at least one", self.help());
        }
        let list = Node {
            member: true,
            ..self
        };
        let nodes: Vec<Node<'d>> = members.iter().map(|m| list.of(m)).collect();
        if self.distinct {
            for (i, node) in nodes.iter().enumerate() {
                let DeValue::String(word) = node.value else {
                    continue;
                };
                let same = |n: &Node<'_>| matches!(n.value, DeValue::String(w) if w == word);
                if nodes[..i].iter().any(same) {
                    let message = format!("`{word}` occurs twice in `{}`", self.key);
                    return node.refuse(message, "again", "remove one");
                }
            }
        }
        visitor.visit_seq(Members(nodes.into_iter()))
    }

    fn deserialize_tuple<V: Visitor<'d>>(self, len: usize, visitor: V) -> Result<V::Value, Flaw> {
        match self.value {
            DeValue::Array(members) if members.len() != len => self.refuse(
                format!(
                    "`{}` has {} member{}, expected {len}",
                    self.key,
                    members.len(),
                    if members.len() == 1 { "" } else { "s" }
                ),
                format!("expected {len}"),
                self.help(),
            ),
            _ => self.deserialize_seq(visitor),
        }
    }

    fn deserialize_map<V: Visitor<'d>>(self, visitor: V) -> Result<V::Value, Flaw> {
        visitor.visit_map(Entries::new(self, &[], None)?)
    }

    fn deserialize_struct<V: Visitor<'d>>(
        self,
        name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Flaw> {
        let table = keys::table(name);
        visitor
            .visit_map(Entries::new(self, fields, table)?)
            .map_err(|flaw| match flaw {
                Flaw::Missing(key) => {
                    let meaning = table.map_or("", |t| t.meaning(key));
                    Flaw::Placed(self.missing(key, meaning))
                }
                other => other,
            })
    }

    fn deserialize_enum<V: Visitor<'d>>(
        self,
        name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Flaw> {
        let (variant, content) = self.choice(name, variants)?;
        visitor.visit_enum(Choice { variant, content })
    }

    forward_to_deserialize_any! {
        <W: Visitor<'d>>
        i8 i16 i32 i64 i128 u8 u16 u64 u128 f32 char bytes byte_buf unit unit_struct tuple_struct identifier
        ignored_any
    }
}

/// Sequence access over the members of a list.
struct Members<'d>(std::vec::IntoIter<Node<'d>>);

impl<'d> SeqAccess<'d> for Members<'d> {
    type Error = Flaw;

    fn next_element_seed<T: DeserializeSeed<'d>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Flaw> {
        let next = self.0.next();
        next.map(|node| node.placed(seed.deserialize(node)))
            .transpose()
    }
}

/// Map access over the entries of a table.
struct Entries<'d> {
    of: Node<'d>,
    left: std::vec::IntoIter<Node<'d>>,
    current: Option<Node<'d>>,
    fields: &'static [&'static str],
    table: Option<&'static Table>,
}

impl<'d> Entries<'d> {
    fn new(
        of: Node<'d>,
        fields: &'static [&'static str],
        table: Option<&'static Table>,
    ) -> Result<Self, Flaw> {
        let left = of.entries()?.into_iter();
        Ok(Entries {
            of,
            left,
            current: None,
            fields,
            table,
        })
    }
}

impl<'d> MapAccess<'d> for Entries<'d> {
    type Error = Flaw;

    fn next_key_seed<K: DeserializeSeed<'d>>(&mut self, seed: K) -> Result<Option<K::Value>, Flaw> {
        self.current = self.left.next();
        let Some(entry) = &mut self.current else {
            return Ok(None);
        };
        entry.meaning = self.table.map_or("", |t| t.meaning(entry.key));
        let key: StrDeserializer<'_, Flaw> = entry.key.into_deserializer();
        seed.deserialize(key).map(Some).map_err(|flaw| match flaw {
            Flaw::UnknownKey => Flaw::Placed(self.of.unknown_key(entry, self.fields, self.table)),
            flaw => Flaw::Placed(entry.place(flaw)),
        })
    }

    fn next_value_seed<T: DeserializeSeed<'d>>(&mut self, seed: T) -> Result<T::Value, Flaw> {
        let Some(entry) = self.current.take() else {
            return Err(Flaw::custom("a value is asked for before its key"));
        };
        let node = self.of.value_of(entry);
        node.placed(seed.deserialize(node))
    }
}

/// Enum access: a variant and its content.
struct Choice<'d> {
    variant: &'static str,
    content: Node<'d>,
}

impl<'d> EnumAccess<'d> for Choice<'d> {
    type Error = Flaw;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'d>>(self, seed: V) -> Result<(V::Value, Self), Flaw> {
        let variant: StrDeserializer<'_, Flaw> = self.variant.into_deserializer();
        Ok((seed.deserialize(variant)?, self))
    }
}

impl<'d> VariantAccess<'d> for Choice<'d> {
    type Error = Flaw;

    /// Checks that a table with a tag has no other keys.
    fn unit_variant(self) -> Result<(), Flaw> {
        match self.content.entries()?.first() {
            Some(more) => Err(Flaw::Placed(self.content.unknown_key(more, &[], None))),
            None => Ok(()),
        }
    }

    fn newtype_variant_seed<T: DeserializeSeed<'d>>(self, seed: T) -> Result<T::Value, Flaw> {
        self.content.placed(seed.deserialize(self.content))
    }

    fn tuple_variant<V: Visitor<'d>>(self, len: usize, visitor: V) -> Result<V::Value, Flaw> {
        self.content.deserialize_tuple(len, visitor)
    }

    fn struct_variant<V: Visitor<'d>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Flaw> {
        (self.content).placed(
            self.content
                .deserialize_struct(self.variant, fields, visitor),
        )
    }
}

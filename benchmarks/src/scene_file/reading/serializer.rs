//! Serialiser of the tables of the format to TOML: the inverse of the deserialiser, with the same enumerations.
//!
//! | in Rust | in the file |
//! |---|---|
//! | a unit variant, or a variant with a content | a word, or a table with one key |
//! | a variant of an enum renamed `<law>` | a word, or the table of the content with the tag `law = ".."`; without it for the default of `<kind=gear>` |
//! | a variant renamed `<number>`, `<text>`, `<flag>`, `<list>`, `<table>` | its content |
//!
//! `None` is left out of tables, and tables keep the order of their fields.

use serde::ser::{
    Error as _, Impossible, Serialize, SerializeMap, SerializeSeq, SerializeStruct,
    SerializeStructVariant, SerializeTuple, SerializeTupleStruct, Serializer,
};
use std::fmt::{self, Display};
use toml_edit::{Array, InlineTable, Value};

/// Writes a value of the format as TOML, tables in one line; `None` if it is an option without a value.
///
/// # Errors
/// A value that TOML cannot have.
pub(crate) fn to_value(value: &impl Serialize) -> Result<Option<Value>, WriteError> {
    value.serialize(Writer)
}

/// A number in the shortest form that reads back to it; one that is not finite is written as such, and refused by the
/// reader with its line.
#[must_use]
pub fn number(x: f64) -> Value {
    let short = match x.abs() {
        0.0 => return Value::from(0.0),
        size if (1e-3..1e6).contains(&size) => format!("{x:?}"),
        _ => format!("{x:e}"),
    };
    short.parse().unwrap_or_else(|_| Value::from(x))
}

/// A value that cannot be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WriteError(String);

impl Display for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for WriteError {}

impl serde::ser::Error for WriteError {
    fn custom<T: Display>(why: T) -> Self {
        WriteError(why.to_string())
    }
}

type Written = Result<Option<Value>, WriteError>;

struct Writer;

/// The tag of an enum renamed `<tag>` or `<tag=default>`, with its default.
fn tag_of(name: &'static str) -> Option<(&'static str, &'static str)> {
    let inside = name.strip_prefix('<')?.strip_suffix('>')?;
    Some(inside.split_once('=').unwrap_or((inside, "")))
}

fn table_of(entries: impl IntoIterator<Item = (String, Value)>) -> Value {
    entries.into_iter().collect::<InlineTable>().into()
}

/// A variant with its content: the content, the content with a tag, or a table with one key.
fn variant_of(name: &'static str, variant: &'static str, content: Value) -> Written {
    if variant.starts_with('<') {
        return Ok(Some(content));
    }
    let Some((tag, default)) = tag_of(name) else {
        return Ok(Some(table_of([(variant.to_owned(), content)])));
    };
    let Value::InlineTable(table) = content else {
        let why = format!("the variant `{variant}` is no table");
        return Err(WriteError::custom(why));
    };
    let head = (variant != default).then(|| (tag.to_owned(), Value::from(variant)));
    let rest = table
        .into_iter()
        .map(|(key, value)| (key.to_string(), value));
    Ok(Some(table_of(head.into_iter().chain(rest))))
}

macro_rules! as_i64 {
    ($($name:ident: $of:ty,)*) => { $(
        fn $name(self, x: $of) -> Written {
            self.serialize_i64(x.into())
        }
    )* };
}

impl Serializer for Writer {
    type Ok = Option<Value>;
    type Error = WriteError;
    type SerializeSeq = List;
    type SerializeTuple = List;
    type SerializeTupleStruct = List;
    type SerializeTupleVariant = Impossible<Option<Value>, WriteError>;
    type SerializeMap = Entries;
    type SerializeStruct = Entries;
    type SerializeStructVariant = VariantEntries;

    fn serialize_bool(self, x: bool) -> Written {
        Ok(Some(x.into()))
    }

    as_i64! {
        serialize_i8: i8, serialize_i16: i16, serialize_i32: i32,
        serialize_u8: u8, serialize_u16: u16, serialize_u32: u32,
    }

    fn serialize_i64(self, x: i64) -> Written {
        Ok(Some(x.into()))
    }

    fn serialize_u64(self, x: u64) -> Written {
        let x = i64::try_from(x).map_err(|e| WriteError::custom(format!("{x}: {e}")))?;
        self.serialize_i64(x)
    }

    fn serialize_f32(self, x: f32) -> Written {
        self.serialize_f64(x.into())
    }

    fn serialize_f64(self, x: f64) -> Written {
        Ok(Some(number(x)))
    }

    fn serialize_char(self, x: char) -> Written {
        self.serialize_str(&x.to_string())
    }

    fn serialize_str(self, x: &str) -> Written {
        Ok(Some(x.into()))
    }

    fn serialize_bytes(self, _: &[u8]) -> Written {
        Err(WriteError::custom("bytes are no part of the format"))
    }

    fn serialize_none(self) -> Written {
        Ok(None)
    }

    fn serialize_some<T: Serialize + ?Sized>(self, x: &T) -> Written {
        x.serialize(self)
    }

    fn serialize_unit(self) -> Written {
        Ok(None)
    }

    fn serialize_unit_struct(self, _: &'static str) -> Written {
        Ok(None)
    }

    fn serialize_unit_variant(self, _: &'static str, _: u32, variant: &'static str) -> Written {
        self.serialize_str(variant)
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(self, _: &'static str, x: &T) -> Written {
        x.serialize(self)
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        name: &'static str,
        _: u32,
        variant: &'static str,
        x: &T,
    ) -> Written {
        match x.serialize(self)? {
            Some(content) => variant_of(name, variant, content),
            None => Ok(None),
        }
    }

    fn serialize_seq(self, len: Option<usize>) -> Result<List, WriteError> {
        Ok(List(Vec::with_capacity(len.unwrap_or_default())))
    }

    fn serialize_tuple(self, len: usize) -> Result<List, WriteError> {
        self.serialize_seq(Some(len))
    }

    fn serialize_tuple_struct(self, _: &'static str, len: usize) -> Result<List, WriteError> {
        self.serialize_seq(Some(len))
    }

    fn serialize_tuple_variant(
        self,
        name: &'static str,
        _: u32,
        _: &'static str,
        _: usize,
    ) -> Result<Self::SerializeTupleVariant, WriteError> {
        Err(unsupported(name))
    }

    fn serialize_map(self, _: Option<usize>) -> Result<Entries, WriteError> {
        Ok(Entries::default())
    }

    fn serialize_struct(self, _: &'static str, _: usize) -> Result<Entries, WriteError> {
        Ok(Entries::default())
    }

    fn serialize_struct_variant(
        self,
        name: &'static str,
        _: u32,
        variant: &'static str,
        _: usize,
    ) -> Result<VariantEntries, WriteError> {
        Ok(VariantEntries {
            name,
            variant,
            entries: Entries::default(),
        })
    }
}

/// The format has no tuples as variants.
fn unsupported(name: &str) -> WriteError {
    WriteError::custom(format!("a variant of {name} has several contents"))
}

/// The members of a list.
struct List(Vec<Value>);

impl List {
    fn push<T: Serialize + ?Sized>(&mut self, x: &T) -> Result<(), WriteError> {
        let value = x.serialize(Writer)?;
        let value = value.ok_or_else(|| WriteError::custom("a member of a list has no value"))?;
        self.0.push(value);
        Ok(())
    }

    fn list(self) -> Written {
        Ok(Some(self.0.into_iter().collect::<Array>().into()))
    }
}

macro_rules! lists {
    ($($of:ident: $push:ident;)*) => { $(
        impl $of for List {
            type Ok = Option<Value>;
            type Error = WriteError;

            fn $push<T: Serialize + ?Sized>(&mut self, x: &T) -> Result<(), WriteError> {
                self.push(x)
            }

            fn end(self) -> Written {
                self.list()
            }
        }
    )* };
}

lists! {
    SerializeSeq: serialize_element;
    SerializeTuple: serialize_element;
    SerializeTupleStruct: serialize_field;
}

/// The entries of a table.
#[derive(Default)]
struct Entries {
    table: InlineTable,
    key: String,
}

impl Entries {
    fn insert<T: Serialize + ?Sized>(&mut self, key: &str, x: &T) -> Result<(), WriteError> {
        if let Some(value) = x.serialize(Writer)? {
            self.table.insert(key, value);
        }
        Ok(())
    }
}

/// The entries of a variant that is a table.
struct VariantEntries {
    name: &'static str,
    variant: &'static str,
    entries: Entries,
}

impl SerializeStructVariant for VariantEntries {
    type Ok = Option<Value>;
    type Error = WriteError;

    fn serialize_field<T: Serialize + ?Sized>(
        &mut self,
        key: &'static str,
        x: &T,
    ) -> Result<(), WriteError> {
        self.entries.insert(key, x)
    }

    fn end(self) -> Written {
        variant_of(self.name, self.variant, self.entries.table.into())
    }
}

impl SerializeMap for Entries {
    type Ok = Option<Value>;
    type Error = WriteError;

    fn serialize_key<T: Serialize + ?Sized>(&mut self, key: &T) -> Result<(), WriteError> {
        match key.serialize(Writer)? {
            Some(Value::String(key)) => self.key = key.into_value(),
            _ => return Err(WriteError::custom("a key is no text")),
        }
        Ok(())
    }

    fn serialize_value<T: Serialize + ?Sized>(&mut self, x: &T) -> Result<(), WriteError> {
        let key = std::mem::take(&mut self.key);
        self.insert(&key, x)
    }

    fn end(self) -> Written {
        Ok(Some(self.table.into()))
    }
}

impl SerializeStruct for Entries {
    type Ok = Option<Value>;
    type Error = WriteError;

    fn serialize_field<T: Serialize + ?Sized>(
        &mut self,
        key: &'static str,
        x: &T,
    ) -> Result<(), WriteError> {
        self.insert(key, x)
    }

    fn end(self) -> Written {
        Ok(Some(self.table.into()))
    }
}

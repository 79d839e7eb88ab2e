//! Records of studies as Python objects.
//!
//! A type of the record becomes an object of the class of its name (`gearbench.records`, which is generated from the
//! JSON Schema of the records), a list of numbers an array, an enumeration a text. Histories are handed over: the array
//! owns the memory that the run has written.

use gearbench_reports::record::Run;
use gearbench_reports::series::TimeSeries;
use gearbench_reports::{Histories, series::Column};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyFloat, PyList, PyString, PyTuple};
use serde::ser::{self, Serialize};
use std::fmt::{self, Display};

/// Error of a conversion.
#[derive(Debug)]
pub struct ConversionError(PyErr);

impl Display for ConversionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl std::error::Error for ConversionError {}

impl ser::Error for ConversionError {
    fn custom<T: Display>(why: T) -> Self {
        ConversionError(pyo3::exceptions::PyValueError::new_err(why.to_string()))
    }
}

impl From<PyErr> for ConversionError {
    fn from(e: PyErr) -> Self {
        ConversionError(e)
    }
}

impl From<ConversionError> for PyErr {
    fn from(e: ConversionError) -> PyErr {
        e.0
    }
}

/// The classes of the record by name.
#[derive(Clone)]
pub struct Classes<'py>(Bound<'py, PyDict>);

impl<'py> Classes<'py> {
    /// The classes of `gearbench.records`.
    ///
    /// # Errors
    /// When the package is incomplete.
    pub fn of(py: Python<'py>) -> PyResult<Self> {
        let module = py.import(pyo3::intern!(py, "gearbench.records"))?;
        Ok(Classes(module.dict()))
    }

    fn object(&self, name: &str, fields: Bound<'py, PyDict>) -> PyResult<Bound<'py, PyAny>> {
        match self.0.get_item(name)? {
            Some(class) => class.call((), Some(&fields)),
            None => Ok(fields.into_any()),
        }
    }

    /// Converts a value of the record.
    ///
    /// # Errors
    /// Errors of Python.
    pub fn convert(&self, value: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
        let py = self.0.py();
        Ok(value.serialize(Writer { py, classes: self })?)
    }

    /// Hands the histories of a series over.
    ///
    /// # Errors
    /// Errors of Python.
    pub fn series(&self, series: TimeSeries) -> PyResult<Bound<'py, PyAny>> {
        let py = self.0.py();
        let (columns, addresses) = (PyDict::new(py), PyDict::new(py));
        let hand_over = |values: Vec<f64>| (values.as_ptr() as usize, values.into_pyarray(py));
        let (address, time) = hand_over(series.time_s);
        addresses.set_item("time_s", address)?;
        for Column { name, values } in series.columns {
            let (address, values) = hand_over(values);
            addresses.set_item(&name, address)?;
            columns.set_item(&name, values)?;
        }
        let fields = PyDict::new(py);
        fields.set_item("time_s", time)?;
        fields.set_item("columns", columns)?;
        let made = self.object("TimeSeries", fields)?;
        // Where the run has written the histories, for a test that none was copied.
        made.setattr("_written_at", addresses)?;
        Ok(made)
    }

    /// Converts a run and hands its histories over. The series is that at full resolution.
    ///
    /// # Errors
    /// Errors of Python.
    pub fn run(&self, run: &mut Run) -> PyResult<Bound<'py, PyAny>> {
        let py = self.0.py();
        let mut histories = run.histories.take();
        let full = histories.as_mut().and_then(|h| h.series.take());
        // The thinned series stays for the report.
        let series = match full {
            Some(full) => Some(full),
            None => run.series.clone(),
        };
        let thin = run.series.take();
        let made = self.convert(run)?;
        run.series = thin;
        if let Some(series) = series {
            made.setattr("series", self.series(series)?)?;
        }
        if let Some(histories) = &histories {
            made.setattr("pairs", self.pairs(histories)?)?;
            made.setattr("contact_events", self.events(histories)?)?;
            let further = PyDict::new(py);
            for column in &histories.further {
                further.set_item(&column.name, PyArray1::from_slice(py, &column.values))?;
            }
            made.setattr("on_grid", further)?;
        }
        run.histories = histories;
        Ok(made)
    }

    /// Converts a run that is not kept, and hands its histories over without a copy.
    ///
    /// # Errors
    /// Errors of Python.
    pub fn whole_run(&self, mut run: Run) -> PyResult<Bound<'py, PyAny>> {
        let series = run.series.take();
        let made = self.run(&mut run)?;
        if let Some(series) = series {
            made.setattr("series", self.series(series)?)?;
        }
        Ok(made)
    }

    fn pairs(&self, histories: &Histories) -> PyResult<Bound<'py, PyAny>> {
        let py = self.0.py();
        let all = &histories.pairs;
        let fields = PyDict::new(py);
        fields.set_item("time_s", column(py, all.iter().map(|p| p.time_s)))?;
        fields.set_item("mesh", column(py, all.iter().map(|p| p.mesh as i64)))?;
        fields.set_item("teeth", two(py, all.iter().map(|p| p.teeth))?)?;
        fields.set_item("force_n", column(py, all.iter().map(|p| p.force_n)))?;
        self.object("PairForces", fields)
    }

    fn events(&self, histories: &Histories) -> PyResult<Bound<'py, PyAny>> {
        let py = self.0.py();
        let all = &histories.events;
        let fields = PyDict::new(py);
        fields.set_item("time_s", column(py, all.iter().map(|e| e.time_s)))?;
        fields.set_item("closes", column(py, all.iter().map(|e| e.closes)))?;
        fields.set_item("mesh", column(py, all.iter().map(|e| e.mesh as i64)))?;
        fields.set_item("teeth", two(py, all.iter().map(|e| e.teeth))?)?;
        fields.set_item("force_n", two(py, all.iter().map(|e| e.force_n))?)?;
        fields.set_item("located", column(py, all.iter().map(|e| e.located)))?;
        self.object("ContactEvents", fields)
    }
}

fn column<'py, T: numpy::Element>(
    py: Python<'py>,
    values: impl Iterator<Item = T>,
) -> Bound<'py, PyArray1<T>> {
    values.collect::<Vec<T>>().into_pyarray(py)
}

/// An array of two columns.
fn two<'py, T: numpy::Element>(
    py: Python<'py>,
    rows: impl Iterator<Item = [T; 2]>,
) -> PyResult<Bound<'py, PyArray2<T>>> {
    let flat: Vec<T> = rows.flatten().collect();
    let rows = flat.len() / 2;
    flat.into_pyarray(py).reshape([rows, 2])
}

struct Writer<'c, 'py> {
    py: Python<'py>,
    classes: &'c Classes<'py>,
}

impl Clone for Writer<'_, '_> {
    fn clone(&self) -> Self {
        *self
    }
}

impl Copy for Writer<'_, '_> {}

type Made<'py> = Result<Bound<'py, PyAny>, ConversionError>;

macro_rules! numbers {
    ($($name:ident: $of:ty,)*) => { $(
        fn $name(self, x: $of) -> Made<'py> {
            let Ok(made) = x.into_pyobject(self.py);
            Ok(made.into_any())
        }
    )* };
}

/// The entries of a list; numbers until another value comes.
struct List<'c, 'py> {
    writer: Writer<'c, 'py>,
    numbers: Vec<f64>,
    others: Option<Vec<Bound<'py, PyAny>>>,
    is_tuple: bool,
}

impl<'py> List<'_, 'py> {
    fn push<T: Serialize + ?Sized>(&mut self, x: &T) -> Result<(), ConversionError> {
        let value = x.serialize(self.writer)?;
        match &mut self.others {
            Some(others) => others.push(value),
            None if !self.is_tuple && value.is_exact_instance_of::<PyFloat>() => {
                self.numbers.push(value.extract().map_err(ConversionError)?);
            }
            None => {
                let py = self.writer.py;
                let before = self
                    .numbers
                    .drain(..)
                    .map(|x| PyFloat::new(py, x).into_any());
                self.others = Some(before.chain([value]).collect());
            }
        }
        Ok(())
    }

    fn end(self) -> Made<'py> {
        let py = self.writer.py;
        Ok(match self.others {
            Some(others) if self.is_tuple => PyTuple::new(py, others)?.into_any(),
            Some(others) => PyList::new(py, others)?.into_any(),
            None if self.numbers.is_empty() => PyList::empty(py).into_any(),
            None => self.numbers.into_pyarray(py).into_any(),
        })
    }
}

macro_rules! lists {
    ($($of:ident: $push:ident;)*) => { $(
        impl<'py> ser::$of for List<'_, 'py> {
            type Ok = Bound<'py, PyAny>;
            type Error = ConversionError;

            fn $push<T: Serialize + ?Sized>(&mut self, x: &T) -> Result<(), ConversionError> {
                self.push(x)
            }

            fn end(self) -> Made<'py> {
                self.end()
            }
        }
    )* };
}

lists! {
    SerializeSeq: serialize_element;
    SerializeTuple: serialize_element;
    SerializeTupleStruct: serialize_field;
    SerializeTupleVariant: serialize_field;
}

/// Returns true for a keyword of Python, which is no name of a field: a field has `_` at its end.
fn is_keyword(py: Python<'_>, name: &str) -> PyResult<bool> {
    static KEYWORDS: PyOnceLock<Vec<String>> = PyOnceLock::new();
    let read = || py.import("keyword")?.getattr("kwlist")?.extract();
    let known = KEYWORDS.get_or_try_init(py, read)?;
    Ok(known.iter().any(|k| k == name))
}

/// The entries of a table, and the class of the object that they become.
struct Entries<'c, 'py> {
    writer: Writer<'c, 'py>,
    class: Option<&'static str>,
    all: Bound<'py, PyDict>,
    key: Option<Bound<'py, PyAny>>,
}

impl<'py> ser::SerializeMap for Entries<'_, 'py> {
    type Ok = Bound<'py, PyAny>;
    type Error = ConversionError;

    fn serialize_key<T: Serialize + ?Sized>(&mut self, key: &T) -> Result<(), ConversionError> {
        self.key = Some(key.serialize(self.writer)?);
        Ok(())
    }

    fn serialize_value<T: Serialize + ?Sized>(&mut self, x: &T) -> Result<(), ConversionError> {
        let value = x.serialize(self.writer)?;
        if let Some(key) = self.key.take() {
            self.all.set_item(key, value)?;
        }
        Ok(())
    }

    fn end(self) -> Made<'py> {
        Ok(self.all.into_any())
    }
}

impl<'py> ser::SerializeStruct for Entries<'_, 'py> {
    type Ok = Bound<'py, PyAny>;
    type Error = ConversionError;

    fn serialize_field<T: Serialize + ?Sized>(
        &mut self,
        key: &'static str,
        x: &T,
    ) -> Result<(), ConversionError> {
        let value = x.serialize(self.writer)?;
        match is_keyword(self.writer.py, key)? {
            true => Ok(self.all.set_item(format!("{key}_"), value)?),
            false => Ok(self.all.set_item(key, value)?),
        }
    }

    fn end(self) -> Made<'py> {
        match self.class {
            Some(class) => Ok(self.writer.classes.object(class, self.all)?),
            None => Ok(self.all.into_any()),
        }
    }
}

impl<'py> ser::SerializeStructVariant for Entries<'_, 'py> {
    type Ok = Bound<'py, PyAny>;
    type Error = ConversionError;

    fn serialize_field<T: Serialize + ?Sized>(
        &mut self,
        key: &'static str,
        x: &T,
    ) -> Result<(), ConversionError> {
        ser::SerializeStruct::serialize_field(self, key, x)
    }

    fn end(self) -> Made<'py> {
        Ok(self.all.into_any())
    }
}

impl<'c, 'py> ser::Serializer for Writer<'c, 'py> {
    type Ok = Bound<'py, PyAny>;
    type Error = ConversionError;
    type SerializeSeq = List<'c, 'py>;
    type SerializeTuple = List<'c, 'py>;
    type SerializeTupleStruct = List<'c, 'py>;
    type SerializeTupleVariant = List<'c, 'py>;
    type SerializeMap = Entries<'c, 'py>;
    type SerializeStruct = Entries<'c, 'py>;
    type SerializeStructVariant = Entries<'c, 'py>;

    numbers! {
        serialize_i8: i8, serialize_i16: i16, serialize_i32: i32, serialize_i64: i64,
        serialize_u8: u8, serialize_u16: u16, serialize_u32: u32, serialize_u64: u64,
        serialize_f64: f64,
    }

    fn serialize_bool(self, x: bool) -> Made<'py> {
        Ok(pyo3::types::PyBool::new(self.py, x).to_owned().into_any())
    }

    fn serialize_f32(self, x: f32) -> Made<'py> {
        self.serialize_f64(x.into())
    }

    fn serialize_char(self, x: char) -> Made<'py> {
        self.serialize_str(x.encode_utf8(&mut [0; 4]))
    }

    fn serialize_str(self, x: &str) -> Made<'py> {
        Ok(PyString::new(self.py, x).into_any())
    }

    fn serialize_bytes(self, x: &[u8]) -> Made<'py> {
        Ok(pyo3::types::PyBytes::new(self.py, x).into_any())
    }

    fn serialize_none(self) -> Made<'py> {
        Ok(self.py.None().into_bound(self.py))
    }

    fn serialize_some<T: Serialize + ?Sized>(self, x: &T) -> Made<'py> {
        x.serialize(self)
    }

    fn serialize_unit(self) -> Made<'py> {
        self.serialize_none()
    }

    fn serialize_unit_struct(self, _: &'static str) -> Made<'py> {
        self.serialize_none()
    }

    fn serialize_unit_variant(self, _: &'static str, _: u32, variant: &'static str) -> Made<'py> {
        self.serialize_str(variant)
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(self, _: &'static str, x: &T) -> Made<'py> {
        x.serialize(self)
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        _: u32,
        variant: &'static str,
        x: &T,
    ) -> Made<'py> {
        let all = PyDict::new(self.py);
        all.set_item(variant, x.serialize(self)?)?;
        Ok(all.into_any())
    }

    fn serialize_seq(self, _: Option<usize>) -> Result<List<'c, 'py>, ConversionError> {
        Ok(List {
            writer: self,
            numbers: Vec::new(),
            others: None,
            is_tuple: false,
        })
    }

    fn serialize_tuple(self, len: usize) -> Result<List<'c, 'py>, ConversionError> {
        Ok(List {
            writer: self,
            numbers: Vec::new(),
            others: Some(Vec::with_capacity(len)),
            is_tuple: true,
        })
    }

    fn serialize_tuple_struct(
        self,
        _: &'static str,
        len: usize,
    ) -> Result<List<'c, 'py>, ConversionError> {
        self.serialize_tuple(len)
    }

    fn serialize_tuple_variant(
        self,
        _: &'static str,
        _: u32,
        _: &'static str,
        len: usize,
    ) -> Result<List<'c, 'py>, ConversionError> {
        self.serialize_tuple(len)
    }

    fn serialize_map(self, _: Option<usize>) -> Result<Entries<'c, 'py>, ConversionError> {
        Ok(Entries {
            writer: self,
            class: None,
            all: PyDict::new(self.py),
            key: None,
        })
    }

    fn serialize_struct(
        self,
        name: &'static str,
        _: usize,
    ) -> Result<Entries<'c, 'py>, ConversionError> {
        Ok(Entries {
            class: Some(name),
            ..self.serialize_map(None)?
        })
    }

    fn serialize_struct_variant(
        self,
        _: &'static str,
        _: u32,
        variant: &'static str,
        _: usize,
    ) -> Result<Entries<'c, 'py>, ConversionError> {
        let all = self.serialize_map(None)?;
        all.all.set_item("kind", variant)?;
        Ok(all)
    }
}

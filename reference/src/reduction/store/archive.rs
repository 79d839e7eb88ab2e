//! The container: a zip archive with one `.npy` file per array.

use super::error::{StoreError, StoreErrorKind, refused, unusable};
use super::npy::{self, ArrayHeader, shape_text};
use crate::limits;
use rawzip::{CompressionMethod, ZipArchive, ZipArchiveEntryWayfinder, ZipSliceArchive};
use std::cell::Cell;
use std::collections::BTreeMap;
use std::io::{self, Read, Write};

/// Bytes that pass through memory at once.
const CHUNK: usize = 1 << 16;
/// More arrays than any stored reduction has.
const MOST: usize = 1000;

/// Writes arrays into an archive.
pub(crate) struct Writer<W: Write>(rawzip::ZipArchiveWriter<W>);

fn as_io(e: rawzip::Error) -> io::Error {
    io::Error::other(e)
}

impl<W: Write> Writer<W> {
    pub(crate) fn new(out: W) -> Self {
        Writer(rawzip::ZipArchiveWriter::new(out))
    }

    /// An array as bytes of fixed length; the shape has as many numbers.
    fn array<const N: usize>(
        &mut self,
        name: &str,
        descr: &str,
        shape: &[usize],
        numbers: impl Iterator<Item = [u8; N]>,
    ) -> io::Result<()> {
        // Numbers of a mode shape have no pattern that a compressor would find.
        let (mut entry, config) = self
            .0
            .new_file(format!("{name}.npy").as_str())
            .start()
            .map_err(as_io)?;
        let mut out = config.wrap(&mut entry);
        out.write_all(&npy::head(descr, shape))?;
        let mut chunk = Vec::with_capacity(CHUNK);
        for number in numbers {
            if chunk.len() + N > CHUNK {
                out.write_all(&chunk)?;
                chunk.clear();
            }
            chunk.extend(number);
        }
        out.write_all(&chunk)?;
        let (_, descriptor) = out.finish().map_err(as_io)?;
        entry.finish(descriptor).map_err(as_io)?;
        Ok(())
    }

    pub(crate) fn f64s(
        &mut self,
        name: &str,
        shape: &[usize],
        x: impl Iterator<Item = f64>,
    ) -> io::Result<()> {
        self.array(name, npy::F64, shape, x.map(f64::to_le_bytes))
    }

    pub(crate) fn i64s(
        &mut self,
        name: &str,
        shape: &[usize],
        x: impl Iterator<Item = i64>,
    ) -> io::Result<()> {
        self.array(name, npy::I64, shape, x.map(i64::to_le_bytes))
    }

    pub(super) fn bytes(&mut self, name: &str, x: &[u8]) -> io::Result<()> {
        self.array(name, npy::U8, &[x.len()], x.iter().map(|b| [*b]))
    }

    pub(crate) fn finish(self) -> io::Result<W> {
        self.0.finish().map_err(as_io)
    }
}

/// Lengths that the axes of an array may have.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Axis {
    /// An axis of this length.
    Is(usize),
    /// Any number, called by this name in messages.
    Any(&'static str),
}

/// Arrays of an archive in memory.
pub(crate) struct Reader<'a> {
    archive: ZipSliceArchive<&'a [u8]>,
    entries: BTreeMap<String, (ZipArchiveEntryWayfinder, CompressionMethod)>,
    /// Bytes of the arrays read so far, including those of the archive itself.
    bytes: Cell<f64>,
}

impl<'a> Reader<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Result<Self, StoreError> {
        let archive = ZipArchive::from_slice(bytes).map_err(|e| {
            unusable(
                StoreErrorKind::NotZip,
                "",
                "a reduction as `gearbench reduce` writes it, a zip archive (.npz)",
                match bytes.len() {
                    0 => "an empty file".to_owned(),
                    n => format!("{n} bytes that are none ({e})"),
                },
            )
        })?;
        let mut entries = BTreeMap::new();
        for entry in archive.entries() {
            let damaged = |found: String| {
                unusable(
                    StoreErrorKind::Damaged,
                    "",
                    "a whole table of contents",
                    found,
                )
            };
            let entry = entry.map_err(|e| damaged(e.to_string()))?;
            let path = String::from_utf8_lossy(entry.file_path().as_ref()).into_owned();
            let Some(name) = path.strip_suffix(".npy") else {
                continue;
            };
            let place = (entry.wayfinder(), entry.compression_method());
            if entries.len() == MOST || entries.insert(name.to_owned(), place).is_some() {
                return Err(damaged(format!("`{}` twice", name.escape_debug())));
            }
        }
        Ok(Reader {
            archive,
            entries,
            bytes: Cell::new(bytes.len() as f64),
        })
    }

    fn missing(&self, name: &str) -> StoreError {
        let there: Vec<&str> = self.entries.keys().map(String::as_str).take(40).collect();
        unusable(
            StoreErrorKind::Missing,
            name,
            "this array",
            match there.is_empty() {
                true => "no array at all".to_owned(),
                false => format!("only {}", there.join(", ").escape_debug()),
            },
        )
    }

    /// Opens an array: its head, and its numbers one after the other.
    fn open<'r>(&'r self, name: &str) -> Result<(ArrayHeader, Box<dyn Read + 'r>), StoreError> {
        let &(place, method) = self.entries.get(name).ok_or_else(|| self.missing(name))?;
        let damaged = |found: String| damaged(name, found);
        let entry = self
            .archive
            .get_entry(place)
            .map_err(|e| damaged(e.to_string()))?;
        let mut input: Box<dyn Read + 'r> = match method {
            CompressionMethod::STORE => Box::new(entry.verifying_reader(entry.data())),
            CompressionMethod::DEFLATE => {
                let inflated = flate2::bufread::DeflateDecoder::new(entry.data());
                Box::new(entry.verifying_reader(inflated))
            }
            other => {
                return Err(damaged(format!("packing by {other}")));
            }
        };
        let head = npy::read_head(&mut input).map_err(damaged)?;
        Ok((head, input))
    }

    /// Reads an array of known type and shape; memory is allocated as numbers arrive.
    fn array<const N: usize, T>(
        &self,
        name: &str,
        (descr, what): (&str, &str),
        axes: &[Axis],
        number: impl Fn([u8; N]) -> T,
    ) -> Result<(Vec<usize>, Vec<T>), StoreError> {
        let (head, mut input) = self.open(name)?;
        if head.descr != descr || (head.fortran && head.shape.len() > 1) {
            return Err(refused(
                StoreErrorKind::Type,
                name,
                format!("{what} (`{descr}`), the last axis fastest"),
                match head.descr == descr {
                    true => "the first axis fastest".to_owned(),
                    false => format!("`{}`", head.descr.escape_debug()),
                },
                format!("store `numpy.ascontiguousarray(x, dtype='{descr}')`"),
            ));
        }
        let fits = head.shape.len() == axes.len()
            && axes
                .iter()
                .zip(&head.shape)
                .all(|(axis, found)| match axis {
                    Axis::Is(n) => n == found,
                    Axis::Any(_) => true,
                });
        let count = head
            .shape
            .iter()
            .try_fold(1_usize, |n, axis| n.checked_mul(*axis))
            .filter(|n| n.checked_mul(N).is_some());
        let (true, Some(count)) = (fits, count) else {
            let expected: Vec<String> = axes
                .iter()
                .map(|axis| match axis {
                    Axis::Is(n) => n.to_string(),
                    Axis::Any(name) => (*name).to_owned(),
                })
                .collect();
            return Err(unusable(
                StoreErrorKind::Shape,
                name,
                format!("the shape ({})", expected.join(", ")),
                shape_text(&head.shape),
            ));
        };
        // The size of the unpacked arrays is given by their headers, not by the size of the archive.
        self.bytes.set(self.bytes.get() + (N * count) as f64);
        let what = "the arrays of a stored reduction";
        limits::check(
            what,
            self.bytes.get(),
            "store fewer modes, or reduce a coarser mesh",
        )
        .map_err(|e| {
            let expected = format!("at most {} of memory", e.allowed);
            unusable(StoreErrorKind::Value, name, expected, e.to_string())
        })?;
        let mut numbers = Vec::with_capacity(count.min(CHUNK));
        let mut chunk = vec![0; CHUNK.min(count.saturating_mul(N))];
        while numbers.len() < count {
            let left = (count - numbers.len()).saturating_mul(N);
            let part = chunk.len().min(left);
            let part = &mut chunk[..part - part % N];
            input.read_exact(part).map_err(|e| {
                damaged(
                    name,
                    match e.kind() {
                        io::ErrorKind::UnexpectedEof => {
                            format!("fewer numbers than {count}")
                        }
                        _ => e.to_string(),
                    },
                )
            })?;
            let words = part.chunks_exact(N).map(|w| {
                let mut word = [0; N];
                word.copy_from_slice(w);
                number(word)
            });
            numbers.extend(words);
        }
        // The end of the data is where sizes and checksum are compared.
        match input.read(&mut [0]) {
            Ok(0) => Ok((head.shape, numbers)),
            Ok(_) => Err(damaged(name, format!("more numbers than {count}"))),
            Err(e) => Err(damaged(name, e.to_string())),
        }
    }

    /// Floating-point numbers, all finite.
    pub(crate) fn f64s(
        &self,
        name: &str,
        axes: &[Axis],
    ) -> Result<(Vec<usize>, Vec<f64>), StoreError> {
        let (shape, x) = self.array(
            name,
            (npy::F64, "8-byte numbers, little endian"),
            axes,
            f64::from_le_bytes,
        )?;
        if let Some(i) = x.iter().position(|x| !x.is_finite()) {
            return Err(unusable(
                StoreErrorKind::Value,
                name,
                "finite numbers",
                format!("{} at [{}]", x[i], index(i, &shape)),
            ));
        }
        Ok((shape, x))
    }

    /// Whole numbers from 0 to 2^32 - 1, or from -1 where signs are meant.
    pub(crate) fn i64s(&self, name: &str, count: Axis) -> Result<Vec<i64>, StoreError> {
        let (_, x) = self.array(
            name,
            (npy::I64, "8-byte integers, little endian"),
            &[count],
            i64::from_le_bytes,
        )?;
        if let Some(i) = x
            .iter()
            .position(|x| !(-1..=i64::from(u32::MAX)).contains(x))
        {
            return Err(unusable(
                StoreErrorKind::Value,
                name,
                "numbers that count or name something",
                format!("{} at [{i}]", x[i]),
            ));
        }
        Ok(x)
    }

    /// Reads a single number.
    pub(super) fn number(&self, name: &str) -> Result<f64, StoreError> {
        Ok(self.f64s(name, &[])?.1[0])
    }

    pub(super) fn bytes(&self, name: &str) -> Result<Vec<u8>, StoreError> {
        let (_, x) = self.array(
            name,
            (npy::U8, "bytes"),
            &[Axis::Any("bytes")],
            |[b]: [u8; 1]| b,
        )?;
        Ok(x)
    }

    /// Number of axes of an array.
    pub(super) fn axes(&self, name: &str) -> Result<usize, StoreError> {
        Ok(self.open(name)?.0.shape.len())
    }
}

fn damaged(name: &str, found: String) -> StoreError {
    unusable(StoreErrorKind::Damaged, name, "a whole array", found)
}

/// Place of number `i` in an array.
fn index(mut i: usize, shape: &[usize]) -> String {
    let mut places: Vec<String> = Vec::with_capacity(shape.len());
    for axis in shape.iter().rev() {
        places.push((i % axis).to_string());
        i /= axis;
    }
    places.reverse();
    places.join(", ")
}

//! The head of an `.npy` file: type, order and shape of the numbers that follow.
//!
//! Magic `\x93NUMPY`, version, length of the head, then a Python dictionary as text, padded with blanks so that
//! the numbers begin at a multiple of 64 bytes (NumPy Enhancement Proposal 1).
//!
//! The package npyz reads this too, but trusts a file: it takes as much memory as a head says it is long, up to 4 GiB,
//! and multiplies the axes unchecked. For these hundred lines it would bring a parser generator and an assembler.

use std::io::{self, Read};

/// 8-byte floating-point numbers, little endian.
pub(super) const F64: &str = "<f8";
/// 8-byte integers, little endian.
pub(super) const I64: &str = "<i8";
/// Type code of bytes.
pub(super) const U8: &str = "|u1";

const MAGIC: &[u8] = b"\x93NUMPY";
/// Longest head that is read: those of real arrays have some hundred bytes.
const LONGEST: usize = 1 << 16;

/// Type and shape of the numbers of an array.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ArrayHeader {
    /// Type as numpy writes it.
    pub(super) descr: String,
    /// The first axis runs fastest.
    pub(super) fortran: bool,
    /// Lengths of the axes.
    pub(super) shape: Vec<usize>,
}

/// A shape as Python writes it.
pub(super) fn shape_text(shape: &[usize]) -> String {
    let axes: Vec<String> = shape.iter().map(usize::to_string).collect();
    match axes.as_slice() {
        [one] => format!("({one},)"),
        _ => format!("({})", axes.join(", ")),
    }
}

/// The head of an array in version 1.0.
pub(super) fn head(descr: &str, shape: &[usize]) -> Vec<u8> {
    let mut text = format!(
        "{{'descr': '{descr}', 'fortran_order': False, 'shape': {}, }}",
        shape_text(shape)
    );
    let unpadded = MAGIC.len() + 4 + text.len() + 1;
    text.push_str(&" ".repeat(unpadded.next_multiple_of(64) - unpadded));
    text.push('\n');
    let mut bytes = MAGIC.to_vec();
    bytes.extend([1, 0]);
    bytes.extend((text.len() as u16).to_le_bytes());
    bytes.extend(text.as_bytes());
    bytes
}

/// Reads a head, versions 1 to 3.
pub(super) fn read_head(input: &mut dyn Read) -> Result<ArrayHeader, String> {
    let short = |e: io::Error| match e.kind() {
        io::ErrorKind::UnexpectedEof => "an end within its head".to_owned(),
        _ => e.to_string(),
    };
    let mut start = [0; 8];
    input.read_exact(&mut start).map_err(short)?;
    if &start[..6] != MAGIC {
        return Err("no head of a numpy array".into());
    }
    let length = match start[6] {
        1 => {
            let mut two = [0; 2];
            input.read_exact(&mut two).map_err(short)?;
            usize::from(u16::from_le_bytes(two))
        }
        2 | 3 => {
            let mut four = [0; 4];
            input.read_exact(&mut four).map_err(short)?;
            u32::from_le_bytes(four) as usize
        }
        other => return Err(format!("version {other} of the numpy format")),
    };
    if length > LONGEST {
        return Err(format!("a head of {length} bytes"));
    }
    let mut text = vec![0; length];
    input.read_exact(&mut text).map_err(short)?;
    let text = String::from_utf8(text).map_err(|_| "a head that is no text".to_owned())?;
    parse(&text).ok_or_else(|| {
        let start: String = text.chars().take(60).collect();
        format!("the head `{}`", start.escape_debug())
    })
}

/// Reads the dictionary of a head.
fn parse(text: &str) -> Option<ArrayHeader> {
    let mut rest = text.trim().strip_prefix('{')?.strip_suffix('}')?;
    let (mut descr, mut fortran, mut shape) = (None, None, None);
    loop {
        rest = rest.trim_start().trim_start_matches(',').trim_start();
        if rest.is_empty() {
            break;
        }
        let (key, after) = quoted(rest)?;
        let value = after.trim_start().strip_prefix(':')?.trim_start();
        rest = match key {
            "descr" => {
                let (text, after) = quoted(value)?;
                descr = Some(text.to_owned());
                after
            }
            "fortran_order" => {
                let (flag, after) = match value.strip_prefix("True") {
                    Some(after) => (true, after),
                    None => (false, value.strip_prefix("False")?),
                };
                fortran = Some(flag);
                after
            }
            "shape" => {
                let (inside, after) = value.strip_prefix('(')?.split_once(')')?;
                let axes = inside.split(',').map(str::trim).filter(|a| !a.is_empty());
                let axes: Option<Vec<usize>> = axes.map(|a| a.parse().ok()).collect();
                shape = Some(axes?);
                after
            }
            _ => return None,
        };
    }
    Some(ArrayHeader {
        descr: descr?,
        fortran: fortran?,
        shape: shape?,
    })
}

/// Splits a text in quotation marks at the start from the rest.
fn quoted(text: &str) -> Option<(&str, &str)> {
    let mark = text.chars().next().filter(|c| matches!(c, '\'' | '"'))?;
    text[1..].split_once(mark)
}

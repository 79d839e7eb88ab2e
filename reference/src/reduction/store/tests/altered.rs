//! Archives that were packed, changed or damaged.

use super::*;

/// The archive with some arrays replaced or left out; `packed` deflates all.
pub(super) fn repacked(
    bytes: &[u8],
    packed: bool,
    change: impl Fn(&str, Vec<u8>) -> Option<Vec<u8>>,
) -> Vec<u8> {
    archive_of(
        packed,
        entries(bytes).into_iter().filter_map(|(name, data)| {
            let data = change(&name, data)?;
            Some((name, data))
        }),
    )
}

/// Returns the archive with one more file.
fn with_further(bytes: &[u8], name: &str, data: &[u8]) -> Vec<u8> {
    let mut all = entries(bytes);
    all.push((name.to_owned(), data.to_vec()));
    archive_of(false, all.into_iter())
}

/// Names and contents of an archive that is not packed.
fn entries(bytes: &[u8]) -> Vec<(String, Vec<u8>)> {
    let archive = rawzip::ZipArchive::from_slice(bytes).unwrap();
    let entries = archive.entries().map(|entry| {
        let entry = entry.unwrap();
        let name = String::from_utf8(entry.file_path().as_ref().to_vec()).unwrap();
        let data = archive
            .get_entry(entry.wayfinder())
            .unwrap()
            .data()
            .to_vec();
        (name, data)
    });
    entries.collect()
}

fn archive_of(packed: bool, files: impl Iterator<Item = (String, Vec<u8>)>) -> Vec<u8> {
    use rawzip::{CompressionMethod, ZipArchiveWriter};
    let mut out = ZipArchiveWriter::new(Vec::new());
    for (name, data) in files {
        let method = match packed {
            true => CompressionMethod::DEFLATE,
            false => CompressionMethod::STORE,
        };
        let file = out.new_file(name.as_str()).compression_method(method);
        let (mut entry, config) = file.start().unwrap();
        let descriptor = if packed {
            let encoder =
                flate2::write::DeflateEncoder::new(&mut entry, flate2::Compression::fast());
            let mut w = config.wrap(encoder);
            w.write_all(&data).unwrap();
            let (encoder, descriptor) = w.finish().unwrap();
            encoder.finish().unwrap();
            descriptor
        } else {
            let mut w = config.wrap(&mut entry);
            w.write_all(&data).unwrap();
            w.finish().unwrap().1
        };
        entry.finish(descriptor).unwrap();
    }
    out.finish().unwrap()
}

#[test]
fn packed_archives_and_further_arrays_are_read() {
    let (basis, meta) = example(3, 5, true);
    let bytes = to_bytes(&basis, &meta).unwrap();
    let packed = repacked(&bytes, true, |_, data| Some(data));
    assert_ne!(packed, bytes);
    assert_eq!(
        all_bits(&read_bytes("x", &packed).unwrap().basis),
        all_bits(&basis)
    );
    // An unknown array, and a file that is no array.
    let further = "further.npy";
    let out = with_further(&bytes, further, &array("<c16", &[], &[1.0, 2.0]));
    let out = with_further(&out, "read me", b"?");
    assert_eq!(
        all_bits(&read_bytes("x", &out).unwrap().basis),
        all_bits(&basis)
    );
}

/// Returns the archive with one array replaced.
pub(super) fn with(bytes: &[u8], array: &str, new: &[u8]) -> Vec<u8> {
    repacked(bytes, false, |name, data| {
        Some(match name.strip_suffix(".npy") == Some(array) {
            true => new.to_vec(),
            false => data,
        })
    })
}

pub(super) fn array(descr: &str, shape: &[usize], numbers: &[f64]) -> Vec<u8> {
    let mut bytes = npy::head(descr, shape);
    numbers.iter().for_each(|x| bytes.extend(x.to_le_bytes()));
    bytes
}

/// Whatever byte is cut or altered: a refusal, or the same numbers.
#[test]
fn damage_anywhere_is_found_or_harmless() {
    for packed in [false, true] {
        let (basis, meta) = example(1, 2, true);
        let bytes = to_bytes(&basis, &meta).unwrap();
        let bytes = if packed {
            repacked(&bytes, true, |_, data| Some(data))
        } else {
            bytes
        };
        let expected = all_bits(&basis);
        let sound = |altered: &[u8], what: &dyn Fn() -> String| match read_bytes("x", altered) {
            Ok(read) => {
                assert_eq!(all_bits(&read.basis), expected, "{}", what());
                assert_eq!(read.meta, meta, "{}", what());
                true
            }
            Err(e) => {
                assert!(!e.found.is_empty() && !e.help.is_empty(), "{e}");
                false
            }
        };
        for n in 0..bytes.len() {
            assert!(!sound(&bytes[..n], &|| format!("cut at {n}")));
        }
        let mut altered = bytes.clone();
        let data: Vec<(u64, u64)> = {
            let archive = rawzip::ZipArchive::from_slice(&bytes).unwrap();
            let ranges = archive.entries().map(|entry| {
                let entry = archive.get_entry(entry.unwrap().wayfinder());
                entry.unwrap().compressed_data_range()
            });
            ranges.collect()
        };
        for at in 0..bytes.len() {
            let in_data = data
                .iter()
                .any(|&(from, to)| (from..to).contains(&(at as u64)));
            for bit in [1_u8 << (at % 8), 0xff] {
                altered[at] = bytes[at] ^ bit;
                let what = || format!("byte {at} with {bit:#x}");
                assert!(!sound(&altered, &what) || packed || !in_data, "{}", what());
            }
            altered[at] = bytes[at];
        }
        // Several bytes at once.
        let mut seed = 3;
        for _ in 0..2000 {
            let mut altered = bytes.clone();
            for _ in 0..3 {
                let at = ((noise(&mut seed) + 1.0) / 2.0 * bytes.len() as f64) as usize;
                altered[at.min(bytes.len() - 1)] = (128.0 * (noise(&mut seed) + 1.0)) as u8;
            }
            sound(&altered, &|| "three bytes".into());
        }
    }
}

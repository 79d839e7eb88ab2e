//! Round trips, refusals, and files that were cut or altered anywhere.

use super::*;
use crate::reduction::hash::Hash;
use gearbench_models::Vec3;
use gearbench_models::gear::elastic::inertia::Integrals;
use gearbench_models::gear::elastic::reduced::{FlankCompliance, Residual};
use gearbench_models::geometry::{FlankGrid, Flanks, Side};

/// Numbers without a pattern in (-1, 1).
fn noise(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
    ((*seed >> 11) as f64 / (1_u64 << 52) as f64) - 1.0
}

/// A basis that fits together, of a few numbers without meaning.
pub(in crate::reduction) fn example(teeth: u32, modes: usize, cyclic: bool) -> (Basis, Meta) {
    let mut seed = 7;
    let mut next = || noise(&mut seed);
    let mut grids = Vec::new();
    let mut nodes = 0_u32;
    for tooth in 0..teeth {
        for (side, rows) in [(Side::Left, 3), (Side::Right, 2)] {
            let n = rows * 2;
            grids.push(FlankGrid {
                tooth,
                side,
                rows,
                columns: 2,
                nodes: (nodes..nodes + n as u32).collect(),
                positions: (0..n).map(|_| Vec3::new(next(), next(), next())).collect(),
            });
            nodes += n as u32;
        }
    }
    let n = nodes as usize;
    let mut some = |count: usize| -> Vec<f64> { (0..count).map(|_| 1e-9 * next()).collect() };
    let flanks = match cyclic {
        true => FlankCompliance::Cyclic {
            teeth: teeth as usize,
            per_tooth: 10,
            blocks: some(n * 10),
        },
        false => FlankCompliance::Full(some(n * n)),
    };
    let basis = Basis {
        flanks: Flanks::new(grids),
        normals: some(n)
            .iter()
            .map(|x| Vec3::new(1e9 * x, 0.3, 0.1).normalize())
            .collect(),
        free: cyclic,
        inertia: 0.1 + 0.2,
        added_inertia: 1e-4,
        unknowns: 4711,
        omega: (0..modes).map(|i| 1e4 + i as f64 / 3.0).collect(),
        family: (0..modes as u32).map(|i| i / 2).collect(),
        shapes: some(n * modes),
        hub: some(modes),
        participation: vec![-0.0; modes],
        momentum: some(2 * modes)
            .chunks_exact(2)
            .map(|x| [x[0], x[1]])
            .collect(),
        unbalance: [-1e-9, 0.7],
        compliance: Residual {
            flanks,
            hub: some(n),
            hub_hub: f64::MIN_POSITIVE,
        },
        // One kind of gear with them, one without.
        integrals: cyclic.then(|| {
            Arc::new(Integrals {
                mass: 0.3,
                centre: [1e-3, -2e-9, 0.0],
                tensor: [1e-4, 0.0, 1e-9, 0.0, 1e-4, 0.0, 1e-9, 0.0, 2e-4],
                translation: some(3 * modes),
                rotation: some(3 * modes),
                radial: some(modes),
                planar: some(modes * modes),
                gyroscopic: some(modes * modes),
            })
        }),
    };
    let mut mesh = Hash::START;
    mesh.text("mesh");
    let meta = Meta {
        program: "gearbench test".into(),
        source: "an \"example\" without meaning, z\u{a0}=\u{a0}3".into(),
        mesh,
        key: Hash::START,
        motion: Motion::Turn,
        material: Material::STEEL,
        element: ElementKind::C3D8I,
        teeth,
        nodes: 100,
        elements: 50,
        asked: format!("{modes} modes"),
    };
    (basis, meta)
}

fn bits(x: &[f64]) -> Vec<u64> {
    x.iter().map(|x| x.to_bits()).collect()
}

/// Every bit of a basis.
pub(in crate::reduction) fn all_bits(b: &Basis) -> Vec<u64> {
    let mut all = vec![
        u64::from(b.free),
        b.unknowns as u64,
        b.inertia.to_bits(),
        b.added_inertia.to_bits(),
    ];
    for g in b.flanks.grids() {
        all.extend([
            u64::from(g.tooth),
            g.side as u64,
            g.rows as u64,
            g.columns as u64,
        ]);
        all.extend(g.nodes.iter().map(|n| u64::from(*n)));
        g.positions
            .iter()
            .for_each(|x| all.extend(bits(x.as_slice())));
    }
    b.normals
        .iter()
        .for_each(|x| all.extend(bits(x.as_slice())));
    all.extend(b.family.iter().map(|f| u64::from(*f)));
    for x in [&b.omega, &b.shapes, &b.hub, &b.participation] {
        all.extend(bits(x));
    }
    let c = &b.compliance;
    all.extend(bits(&c.hub));
    all.push(c.hub_hub.to_bits());
    match &c.flanks {
        FlankCompliance::Full(c) => all.extend(bits(c)),
        FlankCompliance::Cyclic {
            teeth,
            per_tooth,
            blocks,
        } => {
            all.extend([*teeth as u64, *per_tooth as u64]);
            all.extend(bits(blocks));
        }
    }
    all
}

#[test]
fn every_bit_comes_back() {
    for (teeth, modes, cyclic) in [(3, 5, true), (2, 4, false), (1, 0, true), (40, 300, false)] {
        let (basis, meta) = example(teeth, modes, cyclic);
        let bytes = to_bytes(&basis, &meta).unwrap();
        let back = read_bytes("x.npz", &bytes).unwrap();
        assert_eq!(all_bits(&back.basis), all_bits(&basis));
        assert_eq!(back.meta, meta);
        assert_eq!(
            to_bytes(&back.basis, &back.meta).unwrap(),
            bytes,
            "the same file again"
        );
    }
}

#[test]
fn files_are_whole_or_not_there() {
    let folder = std::env::temp_dir().join(format!("gearbench-store-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let (basis, meta) = example(3, 5, true);
    let path = folder.join("a.npz");
    let size = write(&path, &basis, &meta).unwrap();
    assert_eq!(fs::metadata(&path).unwrap().len(), size);
    assert_eq!(all_bits(&read(&path).unwrap().basis), all_bits(&basis));
    let mut bad = basis.clone();
    bad.omega[1] = f64::NAN;
    assert_eq!(
        write(&path, &bad, &meta).unwrap_err().kind,
        StoreErrorKind::Value
    );
    assert!(read(&path).is_ok(), "the old file stays");
    let nowhere = folder.join("no/such/folder/a.npz");
    assert_eq!(
        write(&nowhere, &basis, &meta).unwrap_err().kind,
        StoreErrorKind::Io
    );
    assert_eq!(read(&nowhere).unwrap_err().kind, StoreErrorKind::Io);
    assert_eq!(read(&folder).unwrap_err().kind, StoreErrorKind::Io);
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
    fs::remove_dir_all(&folder).unwrap();
}

/// The archive with some arrays replaced or left out; `packed` deflates all.
fn repacked(
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

/// The archive with one more file.
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
    // An array that this version does not know, and a file that is none.
    let further = "further.npy";
    let out = with_further(&bytes, further, &array("<c16", &[], &[1.0, 2.0]));
    let out = with_further(&out, "read me", b"?");
    assert_eq!(
        all_bits(&read_bytes("x", &out).unwrap().basis),
        all_bits(&basis)
    );
}

/// One array replaced.
fn with(bytes: &[u8], array: &str, new: &[u8]) -> Vec<u8> {
    repacked(bytes, false, |name, data| {
        Some(match name.strip_suffix(".npy") == Some(array) {
            true => new.to_vec(),
            false => data,
        })
    })
}

fn array(descr: &str, shape: &[usize], numbers: &[f64]) -> Vec<u8> {
    let mut bytes = npy::head(descr, shape);
    numbers.iter().for_each(|x| bytes.extend(x.to_le_bytes()));
    bytes
}

#[test]
fn refusals_name_array_expectation_and_way_out() {
    let (basis, meta) = example(2, 4, false);
    let bytes = to_bytes(&basis, &meta).unwrap();
    let refused = |bytes: &[u8]| read_bytes("gear.npz", bytes).unwrap_err();
    let cases = [
        (
            refused(b"*NODE\n1, 0., 0., 0.\n"),
            StoreErrorKind::NotZip,
            "gear.npz: expected a reduction as `gearbench reduce` writes it, a zip archive (.npz), found 20 bytes",
        ),
        (refused(b""), StoreErrorKind::NotZip, "found an empty file"),
        (
            refused(&repacked(&bytes, false, |name, data| {
                (name != "hub_shapes.npy").then_some(data)
            })),
            StoreErrorKind::Missing,
            "gear.npz: `hub_shapes`: expected this array, found only added_inertia, density_kg_m3",
        ),
        (
            refused(&repacked(&bytes, false, |_, _| None)),
            StoreErrorKind::Missing,
            "found no array at all",
        ),
        (
            refused(&with(&bytes, "omega_rad_s", &array("<f4", &[4], &[0.0; 2]))),
            StoreErrorKind::Type,
            "gear.npz: `omega_rad_s`: expected 8-byte numbers, little endian (`<f8`), the last axis fastest, found `<f4`; \
             store `numpy.ascontiguousarray(x, dtype='<f8')`",
        ),
        (
            refused(&with(&bytes, "hub_shapes", &array("<f8", &[5], &[0.0; 5]))),
            StoreErrorKind::Shape,
            "gear.npz: `hub_shapes`: expected the shape (4), found (5,); make it again with `gearbench reduce`",
        ),
        (
            refused(&with(
                &bytes,
                "flank_nodes_m",
                &array("<f8", &[60], &[0.0; 60]),
            )),
            StoreErrorKind::Shape,
            "expected the shape (flank nodes, 3), found (60,)",
        ),
        (
            refused(&with(
                &bytes,
                "hub_shapes",
                &array("<f8", &[4], &[0.0, 1.0, f64::NAN, 0.0]),
            )),
            StoreErrorKind::Value,
            "gear.npz: `hub_shapes`: expected finite numbers, found NaN at [2]",
        ),
        (
            refused(&with(
                &bytes,
                "omega_rad_s",
                &array("<f8", &[4], &[2.0, 1.0, 3.0, 4.0]),
            )),
            StoreErrorKind::Value,
            "expected ascending frequencies, found 1 after 2",
        ),
        (
            refused(&with(&bytes, "hub_shapes", &array("<f8", &[4], &[0.0; 3]))),
            StoreErrorKind::Damaged,
            "gear.npz: `hub_shapes`: expected a whole array, found fewer numbers than 4",
        ),
        (
            refused(&with(&bytes, "hub_shapes", &array("<f8", &[4], &[0.0; 5]))),
            StoreErrorKind::Damaged,
            "found more numbers than 4",
        ),
        (
            refused(&with(&bytes, "flank_side", &{
                let mut a = npy::head("<i8", &[4]);
                [1_i64, -1, 1, 2]
                    .iter()
                    .for_each(|x| a.extend(x.to_le_bytes()));
                a
            })),
            StoreErrorKind::Value,
            "gear.npz: `flank_side`: expected 1 (left) or -1 (right), found 2",
        ),
        (
            refused(&with(&bytes, "inertia", &array("<f8", &[], &[0.0]))),
            StoreErrorKind::Value,
            "`inertia`: expected a positive inertia that holds what is added at the hub, found 0 with 0.0001 added",
        ),
    ];
    for (e, kind, text) in cases {
        assert_eq!(e.kind, kind, "{e}");
        assert!(e.to_string().contains(text), "{e}\n{text}");
    }
    let fortran = {
        let n = 20;
        let text = format!("{{'descr': '<f8', 'fortran_order': True, 'shape': ({n}, 4), }}\n");
        let mut a = b"\x93NUMPY\x02\x00".to_vec();
        a.extend((text.len() as u32).to_le_bytes());
        a.extend(text.as_bytes());
        a.extend(vec![0; 8 * n * 4]);
        a
    };
    let e = refused(&with(&bytes, "shapes_per_sqrt_kg", &fortran));
    assert_eq!(
        (e.kind, &*e.found),
        (StoreErrorKind::Type, "the first axis fastest")
    );
}

#[test]
fn a_newer_schema_and_a_broken_meta_are_refused() {
    let (basis, meta) = example(2, 4, false);
    let bytes = to_bytes(&basis, &meta).unwrap();
    let with_meta = |change: &dyn Fn(&str) -> String| {
        let new = repacked(&bytes, false, |name, data| {
            Some(match name == "meta.npy" {
                true => {
                    let start = data.iter().position(|b| *b == b'\n').unwrap() + 1;
                    let text = change(std::str::from_utf8(&data[start..]).unwrap());
                    let mut new = npy::head(npy::U8, &[text.len()]);
                    new.extend(text.as_bytes());
                    new
                }
                false => data,
            })
        });
        read_bytes("gear.npz", &new)
    };
    assert!(with_meta(&str::to_owned).is_ok());
    let refused = |from: &str, to: &str| {
        with_meta(&|text| {
            assert!(text.contains(from), "{from} in {text}");
            text.replace(from, to)
        })
        .unwrap_err()
    };
    let newer = refused("\"schema\":1", "\"schema\":2");
    assert_eq!(newer.kind, StoreErrorKind::Newer);
    assert_eq!(
        newer.to_string(),
        "gear.npz: `meta`: expected schema 1, found schema 2; a newer gearbench reads it; or make it again with this \
         one: `gearbench reduce`"
    );
    let missing = refused("\"mount\"", "\"count\"");
    assert_eq!(missing.kind, StoreErrorKind::Missing);
    assert!(
        missing
            .to_string()
            .contains("expected `mount`, one of free, held, found no such entry")
    );
    for (from, to) in [
        ("\"held\"", "\"loose\""),
        ("C3D8I", "C3D9"),
        ("\"teeth\":2", "\"teeth\":-2"),
        ("\"teeth\":2", "\"teeth\":1"),
        ("\"teeth\":2", "\"teeth\":18446744073709551615"),
        ("\"schema\":1", "\"schema\":\"1\""),
    ] {
        let e = refused(from, to);
        assert_eq!(e.kind, StoreErrorKind::Value, "{e}");
    }
    assert_eq!(
        with_meta(&|_| "{".into()).unwrap_err().kind,
        StoreErrorKind::Value
    );
}

/// Heads that promise more than there is take no memory for it.
#[test]
fn lying_heads_are_refused_at_once() {
    let (basis, meta) = example(2, 4, false);
    let bytes = to_bytes(&basis, &meta).unwrap();
    let max = usize::MAX;
    for shape in [
        vec![max],
        vec![1 << 60],
        vec![1 << 40],
        vec![max, max],
        vec![0, max],
    ] {
        for name in ["omega_rad_s", "flank_tooth", "meta"] {
            let descr = match name {
                "omega_rad_s" => npy::F64,
                "flank_tooth" => npy::I64,
                _ => npy::U8,
            };
            let e =
                read_bytes("x", &with(&bytes, name, &array(descr, &shape, &[1.0]))).unwrap_err();
            assert!(
                matches!(e.kind, StoreErrorKind::Damaged | StoreErrorKind::Shape),
                "{e}"
            );
        }
        let shape: Vec<usize> = shape.iter().copied().chain([3]).collect();
        let lie = array(npy::F64, &shape, &[1.0]);
        assert!(read_bytes("x", &with(&bytes, "flank_nodes_m", &lie)).is_err());
    }
    // A length of the head beyond its file, and heads of nonsense.
    for head in [
        &b"\x93NUMPY\x01\x00\xff\xff{"[..],
        b"\x93NUMPY\x02\x00\xff\xff\xff\xff{",
        b"\x93NUMPY\x09\x00\x01\x00{",
        b"\x93NUMPY\x01\x00\x02\x00{}",
        b"\x93NUMPY\x01\x00\x0e\x00{'shape': (1,}",
        b"\x93NUMPY\x01\x00\x0c\x00{'descr': 3}",
        b"\x93NUM",
        b"",
    ] {
        let e = read_bytes("x", &with(&bytes, "omega_rad_s", head)).unwrap_err();
        assert_eq!(e.kind, StoreErrorKind::Damaged, "{e}");
    }
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

/// Whatever belongs to a mode goes with it: the file of some modes fits together.
#[test]
fn some_modes_of_a_basis_make_a_basis() {
    let (basis, meta) = example(3, 6, true);
    let kept = [0, 3, 5];
    let some = basis.with_modes(&kept);
    let back = read_bytes("x", &to_bytes(&some, &meta).unwrap()).unwrap();
    assert_eq!(all_bits(&back.basis), all_bits(&some));
    for (new, &old) in kept.iter().enumerate() {
        assert_eq!(some.omega[new], basis.omega[old]);
        assert_eq!(some.momentum[new], basis.momentum[old]);
        for node in 0..basis.normals.len() {
            assert_eq!(some.shapes[node * 3 + new], basis.shapes[node * 6 + old]);
        }
    }
    let none = basis.with_modes(&[]);
    assert!(to_bytes(&none, &meta).is_ok());
}

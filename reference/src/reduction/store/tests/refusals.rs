//! Refusals of stored files, and their messages.

use super::altered::{array, repacked, with};
use super::*;

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
                "flank_compliance_m_per_n",
                &array("<f8", &[20, 20], &[-1e-9; 400]),
            )),
            StoreErrorKind::Value,
            "`flank_compliance_m_per_n`: expected a positive compliance of every node at itself",
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
                matches!(
                    e.kind,
                    StoreErrorKind::Damaged | StoreErrorKind::Shape | StoreErrorKind::Value
                ),
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

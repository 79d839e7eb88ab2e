//! Round trips, refusals, and files that were cut or altered anywhere.

mod altered;
mod refusals;

use super::*;
use crate::hash::Hash;
use gearbench_models::Vec3;
use gearbench_models::gear::elastic::inertia::Integrals;
use gearbench_models::gear::elastic::reduced::{FlankCompliance, OutOfPlaneShapes, Residual};
use gearbench_models::geometry::{FlankGrid, Flanks, Side};

/// Numbers without a pattern in (-1, 1).
fn noise(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
    ((*seed >> 11) as f64 / (1_u64 << 52) as f64) - 1.0
}

/// Returns a consistent basis of a few arbitrary numbers.
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
            blocks: some(n * 10).into_iter().map(f64::abs).collect(),
        },
        false => FlankCompliance::Full(some(n * n).into_iter().map(f64::abs).collect()),
    };
    let near_field = grids.iter().map(|g| some(g.rows * g.rows)).collect();
    let basis = Basis {
        near_field: cyclic.then(|| Arc::new(near_field)),
        flanks: Flanks::new(grids),
        normals: some(n)
            .iter()
            .map(|x| Vec3::new(1e9 * x, 0.3, 0.1).normalize())
            .collect(),
        along_profile: false,
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
        added: if cyclic { [0.1, 2e-5] } else { [0.0; 2] },
        lateral: cyclic.then(|| {
            Arc::new(OutOfPlaneShapes {
                free: [true, true, false, true, true, false],
                hub: some(6 * modes).as_chunks().0.to_vec(),
                mass: 0.4,
                centre: [0.0, -1e-9, 1e-3],
                inertia: [1e-4, 0.0, 1e-9, 0.0, 1e-4, 0.0, 1e-9, 0.0, 2e-4],
            })
        }),
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
        element: "C3D8I".into(),
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
        FlankCompliance::Deflated(_) => panic!("a basis holds the whole compliance"),
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
        assert_eq!(
            (&back.basis.lateral, back.basis.added),
            (&basis.lateral, basis.added)
        );
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
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
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
    assert_eq!(read(folder).unwrap_err().kind, StoreErrorKind::Io);
    assert_eq!(fs::read_dir(folder).unwrap().count(), 1);
}

/// A selection of the modes of a basis is a consistent basis.
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
        let hub = |b: &Basis, mode: usize| b.lateral.as_ref().map(|l| l.hub[mode]);
        assert_eq!(hub(&some, new), hub(&basis, old));
        for node in 0..basis.normals.len() {
            assert_eq!(some.shapes[node * 3 + new], basis.shapes[node * 6 + old]);
        }
    }
    let none = basis.with_modes(&[]);
    assert!(to_bytes(&none, &meta).is_ok());
}

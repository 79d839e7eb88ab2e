//! Hits, misses, keys, and the bound of the folder.

use super::*;
use crate::assembly::tie::HubMotion;
use crate::gear_mesh::{self, GearMesh};
use crate::mesh::{self, ElementKind};
use crate::reduction::request::ALGORITHM;
use crate::reduction::store::tests::{all_bits, example};
use crate::reduction::{ModeSelection, Mounting};
use crate::test_support::{counted, gear};
use gearbench_models::Vec3;
use gearbench_models::geometry::{FlankGrid, Side};
use gearbench_models::stiffness::Material;
use std::collections::HashSet;
use std::convert::Infallible;
use tempfile::{TempDir, tempdir};

fn small() -> GearMesh {
    let gear = gear(12, 2e-3, |p| {
        p.profile_shift = 0.3;
        p.face_width = 5e-3;
        p.bore_radius = 4e-3;
    });
    gear_mesh::gear(&gear, &counted(2, 1, 1)).unwrap()
}

fn request(mesh: &GearMesh) -> Request<'_> {
    Request {
        along_profile: false,
        foreign: None,
        mesh,
        material: Material::STEEL,
        mounting: Mounting::gear(true, 0.0),
        wanted: ModeSelection::Count(20),
        sector: false,
    }
}

fn files(folder: &TempDir) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap();
    let mut files: Vec<PathBuf> = entries.map(|e| e.unwrap().path()).collect();
    files.sort();
    files
}

#[test]
fn computed_once_and_again_when_the_file_is_spoilt() {
    let folder = tempdir().unwrap();
    let cache = Cache::at(folder.path(), LIMIT);
    let mesh = small();
    let (basis, _) = example(3, 5, true);
    let ask = |mesh: &GearMesh, computes: bool| {
        let mut computed = false;
        let Ok(found) = cache.basis(&request(mesh), "a test", || {
            computed = true;
            Ok::<_, Infallible>(basis.clone())
        });
        assert_eq!((found.hit, computed), (!computes, computes));
        assert_eq!(all_bits(&found.basis), all_bits(&basis));
    };
    // The example has the teeth of another gear than this mesh: it is not stored.
    ask(&mesh, true);
    assert!(files(&folder).is_empty());
    let mesh = GearMesh { teeth: 3, ..mesh };
    let ask = |computes| ask(&mesh, computes);
    ask(true);
    ask(false);
    let [path] = &files(&folder)[..] else {
        panic!("one file")
    };
    // Cut short; another's file under this name; no file at all.
    let whole = fs::read(path).unwrap();
    fs::write(path, &whole[..whole.len() / 2]).unwrap();
    ask(true);
    ask(false);
    assert_eq!(fs::read(path).unwrap(), whole);
    let (other, meta) = example(3, 4, true);
    store::write(path, &other, &meta).unwrap();
    ask(true);
    ask(false);
    fs::remove_file(path).unwrap();
    ask(true);
    assert_eq!(files(&folder).len(), 1);
    // Errors of the computation come through, and leave nothing behind.
    let held = Request {
        wanted: ModeSelection::Count(21),
        ..request(&mesh)
    };
    let failed = cache.basis(&held, "a test", || Err::<Basis, _>("no modes"));
    assert_eq!(failed.unwrap_err(), "no modes");
    assert_eq!(files(&folder).len(), 1);
}

#[test]
fn a_cache_that_cannot_be_written_is_no_error() {
    let folder = tempdir().unwrap();
    let file = folder.path().join("a file");
    fs::write(&file, "no folder").unwrap();
    let mesh = GearMesh {
        teeth: 3,
        ..small()
    };
    let (basis, _) = example(3, 5, true);
    for cache in [Cache::at(&file, LIMIT), Cache::default()] {
        for _ in 0..2 {
            let Ok(found) = cache.basis(&request(&mesh), "a test", || {
                Ok::<_, Infallible>(basis.clone())
            });
            assert!(!found.hit);
        }
    }
    assert_eq!(files(&folder), [file]);
}

#[test]
fn the_key_tells_all_apart_that_the_basis_depends_on() {
    let mesh = small();
    let base = request(&mesh);
    assert_eq!(base.key(), request(&small()).key());
    let mut moved = mesh.clone();
    moved.mesh.nodes[17].x += f64::EPSILON;
    let mut other_element = mesh.clone();
    other_element.mesh.blocks[0].kind = ElementKind::C3D8;
    let mut joined = mesh.clone();
    joined.mesh.blocks[0].connectivity.swap(0, 1);
    let mut bore = mesh.clone();
    bore.bore.pop();
    let mut flanks = mesh.clone();
    flanks.flanks.pop();
    let mut keys = HashSet::from([base.key()]);
    for mesh in [&moved, &other_element, &joined, &bore, &flanks] {
        let r = request(mesh);
        assert_ne!(r.mesh_hash(), base.mesh_hash());
        assert!(keys.insert(r.key()));
    }
    let mounted = |mounting| Request { mounting, ..base };
    let mut stiffer = base;
    stiffer.material.young *= 1.0 + 1e-15;
    let mut denser = base;
    denser.material.density += 1.0;
    let mut harder = base;
    harder.material.poisson = 0.29;
    let slide = HubMotion::Slide(Vec3::x());
    let lateral = |free| Mounting::gear(true, 0.0).lateral(free);
    let others = [
        stiffer,
        denser,
        harder,
        Request {
            wanted: ModeSelection::Count(21),
            ..base
        },
        Request {
            wanted: ModeSelection::UpTo(20.0),
            ..base
        },
        Request {
            sector: true,
            ..base
        },
        mounted(Mounting::gear(false, 0.0)),
        mounted(Mounting::gear(true, 1e-9)),
        mounted(Mounting::rack(true, 0.0)),
        mounted(Mounting {
            motion: slide,
            ..Mounting::rack(true, 0.0)
        }),
        mounted(lateral([true; 6]).unwrap()),
        mounted(lateral([true, true, false, false, false, false]).unwrap()),
        mounted(lateral([true; 6]).unwrap().with_added(0.1, 0.0)),
        mounted(lateral([true; 6]).unwrap().with_added(0.0, 0.1)),
    ];
    for r in others {
        assert_eq!(r.mesh_hash(), base.mesh_hash());
        assert!(keys.insert(r.key()));
    }
}

/// The hash does not depend on comments in the sources or on the compiler: its value is fixed for stated data.
#[test]
fn the_key_depends_on_nothing_else() {
    let node = |x: u32| Vec3::new(f64::from(x), 0.5, -0.25);
    let mesh = GearMesh {
        mesh: mesh::Mesh {
            node_sets: [("cut_low".to_owned(), vec![1, 2])].into(),
            ..mesh::Mesh::new(
                ElementKind::C3D8,
                (0..8).map(node).collect(),
                (0..8).collect(),
            )
        },
        teeth: 3,
        bore: vec![0, 1],
        flanks: vec![FlankGrid {
            tooth: 0,
            side: Side::Left,
            rows: 2,
            columns: 2,
            nodes: vec![4, 5, 6, 7],
            positions: (4..8).map(node).collect(),
        }],
        tied: Vec::new(),
    };
    let key = request(&mesh).key();
    assert_eq!(key.to_string(), "f01846fd19c20a92b409e91dfebcc4ad");
}

/// [`ALGORITHM`] identifies these numbers of one mesh: whoever changes the algorithm raises it and renews them.
#[test]
fn the_version_of_the_algorithm_belongs_to_its_numbers() {
    let mesh = small();
    let basis = request(&mesh).compute().unwrap();
    let nodes = basis.normals.len();
    let sum = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
    let found = [
        basis.omega[0],
        basis.omega[19],
        sum(&basis.shapes),
        sum(&basis.compliance.hub),
        basis.compliance.flanks.between(3, 5, nodes),
    ];
    let numbers = [
        262500.1962847042,
        739905.7399652028,
        182793.69647043283,
        2.23558703440368e-14,
        9.233195400448711e-9,
    ];
    let equal = found
        .iter()
        .zip(numbers)
        .all(|(found, number)| (found / number - 1.0).abs() < 1e-7);
    assert!(equal, "{found:?}, expected {numbers:?}");
    assert_eq!(ALGORITHM, 3);
}

#[test]
fn what_was_not_used_for_longest_goes() {
    let folder = tempdir().unwrap();
    let mesh = GearMesh {
        teeth: 3,
        ..small()
    };
    let (basis, meta) = example(3, 5, true);
    let size = store::to_bytes(&basis, &meta).unwrap().len() as u64;
    let cache = Cache::at(folder.path(), 3 * size + size / 2);
    let ask = |modes: usize| {
        let r = Request {
            wanted: ModeSelection::Count(modes),
            ..request(&mesh)
        };
        let Ok(found) = cache.basis(&r, &meta.source, || Ok::<_, Infallible>(basis.clone()));
        let path = file(folder.path(), r.key());
        let aged = move |seconds: u64| {
            let time = SystemTime::now() - Duration::from_secs(seconds);
            let opened = fs::File::options().append(true).open(&path).unwrap();
            opened.set_modified(time).unwrap();
        };
        (found.hit, aged)
    };
    let foreign = folder.path().join("notes.npz");
    fs::write(&foreign, vec![0; 10 * size as usize]).unwrap();
    for (modes, age) in [(20, 300), (21, 200), (22, 100)] {
        let (hit, aged) = ask(modes);
        assert!(!hit);
        aged(age);
    }
    assert!(ask(20).0, "used again: now the newest");
    assert!(!ask(23).0);
    assert!(ask(20).0 && ask(22).0 && ask(23).0);
    assert!(!ask(21).0, "the oldest had to go");
    assert!(foreign.is_file(), "what is not ours stays");
    // Half written long ago, and just now.
    let part = |name: &str, seconds: u64| {
        let path = folder
            .path()
            .join(format!("{}.npz.{name}.part", Hash::START));
        let file = fs::File::create(&path).unwrap();
        file.set_modified(SystemTime::now() - Duration::from_secs(seconds))
            .unwrap();
        path
    };
    let (old, new) = (part("1-0", 2 * 24 * 3600), part("2-0", 10));
    assert!(!ask(24).0);
    assert!(!old.exists() && new.exists());
}

#[test]
fn folders_of_the_platforms() {
    let of = |system: &str, variables: &[(&str, &str)]| {
        folder(system, |name| {
            let found = variables.iter().find(|v| v.0 == name);
            found.map(|v| OsString::from(v.1))
        })
    };
    let path = |p: &str| Some(PathBuf::from(p));
    let home = ("HOME", "/home/a");
    assert_eq!(of("linux", &[home]), path("/home/a/.cache/gearbench"));
    let xdg = ("XDG_CACHE_HOME", "/c");
    assert_eq!(of("linux", &[home, xdg]), path("/c/gearbench"));
    // Not absolute: not valid.
    let relative = ("XDG_CACHE_HOME", "c");
    assert_eq!(
        of("linux", &[home, relative]),
        path("/home/a/.cache/gearbench")
    );
    assert_eq!(
        of("macos", &[home, xdg]),
        path("/home/a/Library/Caches/gearbench")
    );
    let local = ("LOCALAPPDATA", "/local");
    assert_eq!(of("windows", &[home, local]), path("/local/gearbench"));
    assert_eq!(of("linux", &[]), None);
    let own = |value| (VARIABLE, value);
    assert_eq!(of("linux", &[home, own("/x/y")]), path("/x/y"));
    assert_eq!(
        of("linux", &[home, own("")]),
        path("/home/a/.cache/gearbench")
    );
    for off in ["off", "OFF"] {
        assert_eq!(of("linux", &[home, own(off)]), None);
    }
}

//! Tests of the command `gearbench fmu`.

use super::{Folder, has, stderr};
use std::collections::BTreeMap;
use std::io::Read;

/// Entries of an archive, unpacked.
fn entries(bytes: &[u8]) -> BTreeMap<String, Vec<u8>> {
    let archive = rawzip::ZipArchive::from_slice(bytes).unwrap();
    let mut all = BTreeMap::new();
    for entry in archive.entries() {
        let entry = entry.unwrap();
        let name = String::from_utf8_lossy(entry.file_path().as_ref()).into_owned();
        let packed = archive.get_entry(entry.wayfinder()).unwrap();
        let inflated = flate2::bufread::DeflateDecoder::new(packed.data());
        let mut contents = Vec::new();
        let mut reader = packed.verifying_reader(inflated);
        reader.read_to_end(&mut contents).unwrap();
        all.insert(name, contents);
    }
    all
}

#[test]
fn a_model_is_packed_with_all_that_it_reads() {
    let folder = Folder::new();
    folder.write("library.so", "the library");
    let said = folder.says("fmu spur_impact --model movable-teeth --library library.so");
    has(
        &said,
        &[
            "spur_impact.fmu",
            "2 inputs",
            "co-simulation and model exchange",
        ],
    );
    let bytes = std::fs::read(folder.at("spur_impact.fmu")).unwrap();
    let all = entries(&bytes);
    let names: Vec<&str> = all.keys().map(String::as_str).collect();
    let library = names.iter().find(|n| n.starts_with("binaries/")).unwrap();
    assert!(library.contains("/spur_impact."), "{library}");
    assert_eq!(all[*library], b"the library");
    let text = |name: &str| String::from_utf8_lossy(&all[name]).into_owned();
    // The chosen model alone, with its fitted constants, and nothing that only studies read.
    let scene = text("resources/scene.toml");
    assert!(scene.contains("movable-teeth") && !scene.contains("rigid"));
    assert!(!scene.contains("calculix") && !scene.contains("[study"));
    has(
        &text("resources/scene.calibration.toml"),
        &["[impact.movable-teeth]", "tooth_mass_kg"],
    );
    has(
        &text("modelDescription.xml"),
        &[
            "fmiVersion=\"3.0\"",
            "pinion.torque",
            "maxOutputDerivativeOrder=\"2\"",
        ],
    );
    assert_eq!(all.len(), 5);
    // The same command writes an identical file.
    folder.says("fmu spur_impact --model movable-teeth --library library.so --out again.fmu");
    assert_eq!(bytes, std::fs::read(folder.at("again.fmu")).unwrap());
}

#[test]
fn what_cannot_be_packed_is_refused_with_a_way_out() {
    let folder = Folder::new();
    let refused = |arguments: &str, told: &[&str]| {
        has(&stderr(&folder.ends(&format!("fmu {arguments}"), 2)), told);
    };
    refused(
        "hammer --library nowhere.so",
        &["nowhere.so", "cargo build --release -p gearbench-fmu"],
    );
    folder.write("library.so", "");
    let library = "--library library.so";
    refused(
        &format!("hammer --model rigit {library}"),
        &["did you mean `rigid`"],
    );
    refused(
        &format!("hammer --model movable-teeth --method trigonometric@1us {library}"),
        &["oscillators"],
    );
    refused(
        &format!("hammer --method rk4@1us,dopri5@1e-6 {library}"),
        &["name one"],
    );
    refused(
        &format!("driveline --move wheel {library}"),
        &["is on a shaft"],
    );
    assert_eq!(folder.files(), 1);
}

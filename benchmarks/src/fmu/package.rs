//! Contents and archive of an FMU.

use super::coupled::Coupled;
use super::description::{self, DescriptionHeader, FmiVersion};
use super::settings::{CALIBRATION, SCENE, SETTINGS, Settings};
use crate::experiment::key::files;
use crate::scene_file::{Calibration, ModelChoice, Origin, SceneError, SceneFile};
use flate2::Compression;
use flate2::write::DeflateEncoder;
use gearbench_integrators::Scheme;
use rawzip::{CompressionMethod, ZipArchiveWriter};
use std::io::{self, Write};
use std::path::{Component, Path, PathBuf};
use toml_edit::{DocumentMut, Item, Value};

/// A file within the archive of an FMU.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Path within the archive.
    pub path: String,
    /// Content of the file.
    pub bytes: Vec<u8>,
}

impl Entry {
    fn new(path: impl Into<String>, bytes: impl Into<Vec<u8>>) -> Self {
        Entry {
            path: path.into(),
            bytes: bytes.into(),
        }
    }
}

/// An FMU with its files, before it is compressed.
#[derive(Clone, Debug)]
pub struct Package {
    /// Name of the shared library in the FMU.
    pub identifier: String,
    /// Version of the standard.
    pub version: FmiVersion,
    /// Instantiation token, which hosts return to the library.
    pub token: String,
    /// The model description and the resources.
    pub entries: Vec<Entry>,
}

impl Package {
    /// Packs a model of a scene.
    ///
    /// # Errors
    /// A scene that cannot be assembled with these inputs, or that reads files outside its folder.
    pub fn of(
        file: &SceneFile,
        choice: &ModelChoice,
        scheme: Scheme,
        moved: &[String],
        version: FmiVersion,
    ) -> Result<Self, SceneError> {
        let coupled = Coupled::assemble(file, choice, moved)?;
        let settings = Settings {
            gearbench: env!("CARGO_PKG_VERSION").into(),
            model: choice.label.clone(),
            method: scheme.method,
            step_s: scheme.resolution.step(),
            rtol: scheme.resolution.tolerance(),
            events: file.study.events,
            moved: moved.to_vec(),
            interface: coupled.interface.key(),
        }
        .text();
        let scene = alone(file, &choice.label)?;
        let token = Settings::token(&settings, &scene);
        let identifier = identifier(&file.name);
        let head = DescriptionHeader {
            version,
            identifier: &identifier,
            name: &file.name,
            title: &file.title,
            token: &token,
            scheme,
            duration: file.duration,
            samples: file.study.samples,
        };
        let description = description::text(&head, &coupled.interface);
        let mut entries = vec![
            Entry::new("modelDescription.xml", description),
            Entry::new(format!("resources/{SETTINGS}"), settings),
            Entry::new(format!("resources/{SCENE}"), scene),
        ];
        entries.extend(constants(file, choice));
        entries.extend(read_files(file, choice)?);
        Ok(Package {
            identifier,
            version,
            token,
            entries,
        })
    }

    /// Adds the shared library for the platform of this program.
    pub fn add_library(&mut self, bytes: Vec<u8>) {
        let end = std::env::consts::DLL_EXTENSION;
        let path = format!(
            "binaries/{}/{}.{end}",
            platform(self.version),
            self.identifier
        );
        self.entries.push(Entry::new(path, bytes));
    }

    /// Writes the entries into a folder, as a host unpacks them.
    ///
    /// # Errors
    /// When files cannot be written.
    pub fn unpack(&self, folder: &Path) -> io::Result<()> {
        for entry in &self.entries {
            let path = folder.join(&entry.path);
            if let Some(parent) = path.parent() {
                std::fs::create_dir_all(parent)?;
            }
            std::fs::write(path, &entry.bytes)?;
        }
        Ok(())
    }

    /// Compresses the archive. Equal entries give equal bytes, as the archive contains no times.
    ///
    /// # Errors
    /// When an entry cannot be packed.
    pub fn archive(&self) -> io::Result<Vec<u8>> {
        let other = |e: rawzip::Error| io::Error::other(e);
        let mut out = Vec::new();
        let mut archive = ZipArchiveWriter::new(&mut out);
        for entry in &self.entries {
            let file = archive.new_file(entry.path.as_str());
            let packed = file.compression_method(CompressionMethod::DEFLATE);
            let (mut slot, config) = packed.start().map_err(other)?;
            let mut to = config.wrap(DeflateEncoder::new(&mut slot, Compression::default()));
            to.write_all(&entry.bytes)?;
            let (encoder, descriptor) = to.finish().map_err(other)?;
            encoder.finish()?;
            slot.finish(descriptor).map_err(other)?;
        }
        archive.finish().map_err(other)?;
        Ok(out)
    }
}

/// The name of this platform in a version of the standard.
pub fn platform(version: FmiVersion) -> String {
    let (machine, system) = (std::env::consts::ARCH, std::env::consts::OS);
    match version {
        FmiVersion::Three if system == "macos" => format!("{machine}-darwin"),
        FmiVersion::Three => format!("{machine}-{system}"),
        FmiVersion::Two => {
            let system = match system {
                "windows" => "win",
                "macos" => "darwin",
                other => other,
            };
            format!("{system}{}", usize::BITS)
        }
    }
}

/// Converts the name of a scene to an identifier in C.
fn identifier(name: &str) -> String {
    let fits = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let name: String = name.chars().map(fits).collect();
    match name.starts_with(|c: char| c.is_ascii_digit()) {
        true => format!("_{name}"),
        false => name,
    }
}

/// The text of a scene with one model, without keys that only studies read.
fn alone(file: &SceneFile, label: &str) -> Result<String, SceneError> {
    let mut document: DocumentMut = (file.text().parse())
        .map_err(|e: toml_edit::TomlError| SceneError::plain(e.to_string(), "correct the scene"))?;
    for key in ["reference", "references", "tolerance", "study"] {
        document.remove(key);
    }
    let mut labels = file.models.iter().map(|m| m.label == label);
    let mut keep = || labels.next().unwrap_or(false);
    match document.get_mut("models") {
        Some(Item::ArrayOfTables(all)) => all.retain(|_| keep()),
        Some(Item::Value(Value::Array(all))) => all.retain(|_| keep()),
        _ => {}
    }
    Ok(document.to_string())
}

/// Fitted constants that the model takes from a calibration of this scene; those of shipped scenes are part of the
/// library.
fn constants(file: &SceneFile, choice: &ModelChoice) -> Option<Entry> {
    let used = choice.calibration.as_ref()?;
    let constants = used
        .constants
        .as_ref()
        .filter(|_| used.scene == file.name)?;
    let mut calibration = Calibration::default();
    let set = calibration.sets.entry(used.name.clone()).or_default();
    set.insert(used.label.clone(), constants.clone());
    let path = format!("resources/{CALIBRATION}");
    Some(Entry::new(path, calibration.to_toml()))
}

/// Files that the scene reads, with their paths relative to it.
fn read_files(file: &SceneFile, choice: &ModelChoice) -> Result<Vec<Entry>, SceneError> {
    let Origin::File(scene) = &file.origin else {
        return Ok(Vec::new());
    };
    let folder = scene.parent().unwrap_or(Path::new(""));
    let read = files(&choice.modelling);
    let mut paths: Vec<PathBuf> = read.chain(file.data_files.iter().cloned()).collect();
    paths.sort();
    paths.dedup();
    let mut entries = Vec::new();
    for path in paths {
        let inside = path.strip_prefix(folder).ok().filter(|p| {
            p.components()
                .all(|c| matches!(c, Component::Normal(_) | Component::CurDir))
        });
        let Some(inside) = inside else {
            return Err(SceneError::plain(
                format!(
                    "{} is not in the folder of the scene or below it, so that an FMU cannot contain it",
                    path.display()
                ),
                "move it into the folder of the scene, and name it from there",
            ));
        };
        let bytes = std::fs::read(&path).map_err(|e| {
            SceneError::plain(format!("{}: {e}", path.display()), "make it readable")
        })?;
        let names: Vec<String> = (inside.components())
            .filter(|c| *c != Component::CurDir)
            .map(|c| c.as_os_str().to_string_lossy().into_owned())
            .collect();
        entries.push(Entry::new(format!("resources/{}", names.join("/")), bytes));
    }
    Ok(entries)
}

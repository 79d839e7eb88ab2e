//! Kinds of files that are common in this field, by their extensions, and their use in gearbench.
//!
//! Every input consults this table before it reads a file, so that a message names the kind of a file of another
//! program.

use std::path::Path;

/// Input that a file can be read as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Input {
    /// A scene file.
    Scene,
    /// The mesh of a gear.
    Mesh,
    /// A table of measured or computed histories.
    Table,
    /// The record of a study.
    Record,
}

/// A kind of file.
#[derive(Clone, Copy, Debug)]
pub struct FileKind {
    /// Endings of names, lower case, without the point.
    pub endings: &'static [&'static str],
    /// Name of the kind, with its article.
    pub name: &'static str,
    /// Inputs that gearbench reads it as.
    pub read_as: &'static [Input],
    /// Advice for the use of such a file.
    pub way_out: &'static str,
}

/// A way from meshes of other programs.
macro_rules! converted {
    () => {
        "convert the mesh to an Abaqus deck (.inp) or a Gmsh mesh (.msh), for instance with meshio or Gmsh; `gearbench reduce F.inp` and `parameters = { mesh = \"F.inp\" }` of elastic gears read it"
    };
}

/// All kinds of files.
pub const KINDS: &[FileKind] = &[
    FileKind {
        endings: &["toml"],
        name: "a scene",
        read_as: &[Input::Scene],
        way_out: "`gearbench compare F.toml` runs it",
    },
    FileKind {
        endings: &["inp", "inp.gz", "msh", "msh.gz", "cdb", "cdb.gz"],
        name: "a mesh (deck of Abaqus or CalculiX, mesh of Gmsh, or archive of Ansys)",
        read_as: &[Input::Mesh],
        way_out: "`gearbench reduce F.inp` reduces its gears; elastic gears of a scene use it by `parameters = { mesh = \"F.inp\" }`",
    },
    FileKind {
        endings: &["npz"],
        name: "a stored reduction",
        read_as: &[],
        way_out: "elastic gears of a scene use it by `parameters = { reduction = \"F.npz\" }`",
    },
    FileKind {
        endings: &["csv", "tsv"],
        name: "a table",
        read_as: &[Input::Table],
        way_out: "a scene uses it as its reference: reference = { csv = \"F.csv\" }",
    },
    FileKind {
        endings: &["json"],
        name: "a record (results.json)",
        read_as: &[Input::Record],
        way_out: "`gearbench report DIR` rewrites its report, `gearbench rerun results.json` repeats the study",
    },
    FileKind {
        endings: &["jsonl"],
        name: "a journal, or the baselines of a check",
        read_as: &[],
        way_out: "name the scene, or for `gearbench check` the check file",
    },
    FileKind {
        endings: &[
            "step", "stp", "iges", "igs", "brep", "x_t", "x_b", "sldprt", "ipt", "prt", "catpart",
        ],
        name: "CAD geometry",
        read_as: &[],
        way_out: "describe the gears by their data (`gearbench init`), or mesh the body (Gmsh: gmsh -3 F.step -o F.msh) and run `gearbench reduce F.msh`",
    },
    FileKind {
        endings: &["stl", "obj", "ply", "off", "3mf", "amf"],
        name: "a surface of triangles",
        read_as: &[],
        way_out: "describe the gears by their data (`gearbench init`), or mesh the volume within the surface, for instance in Gmsh, and run `gearbench reduce F.msh`",
    },
    FileKind {
        endings: &["rexs", "rexsj", "rexsz"],
        name: "gear data in the exchange format REXS",
        read_as: &[],
        way_out: "REXS is not read yet (`gearbench help limits`); write its values, in SI units, into a scene: `gearbench init`",
    },
    FileKind {
        endings: &["cae", "odb", "fil", "sim"],
        name: "a database or result of Abaqus",
        read_as: &[],
        way_out: "write the input file of the job (Abaqus/CAE: Job, Write Input) and run `gearbench reduce F.inp`; histories go into a CSV file",
    },
    FileKind {
        endings: &["txt", "dat"],
        name: "a text file",
        read_as: &[Input::Mesh, Input::Table],
        way_out: "a scene ends in .toml (`gearbench init`); a table of histories is a reference of a scene: reference = { csv = \"F.csv\" }",
    },
    FileKind {
        endings: &["frd"],
        name: "a result of CalculiX",
        read_as: &[],
        way_out: "`gearbench reduce` reads its deck (.inp), and by --shapes the modes in this file; write histories to a CSV file, the reference of a scene: reference = { csv = \"F.csv\" }",
    },
    FileKind {
        endings: &["sti", "mas", "dof", "mtx", "hb", "mapping"],
        name: "a matrix of another program",
        read_as: &[],
        way_out: "`gearbench reduce DECK --matrices FILE` reduces the gear of its deck with it",
    },
    FileKind {
        endings: &["rst", "rth", "db", "wbpj", "mechdb", "full", "emat", "sub"],
        name: "a database or result of Ansys",
        read_as: &[],
        way_out: "write the mesh as an archive (CDWRITE,DB,F,cdb) and run `gearbench reduce F.cdb`; HBMAT writes matrices as text",
    },
    FileKind {
        endings: &["bdf", "nas", "op2", "f06", "pch"],
        name: "a deck or result of Nastran",
        read_as: &[],
        way_out: converted!(),
    },
    FileKind {
        endings: &[
            "unv", "med", "mesh", "vol", "exo", "cgns", "k", "key", "xdmf", "su2",
        ],
        name: "a mesh of another program",
        read_as: &[],
        way_out: converted!(),
    },
    FileKind {
        endings: &["vtu", "vtk", "vtp", "pvd"],
        name: "a file for ParaView",
        read_as: &[],
        way_out: converted!(),
    },
    FileKind {
        endings: &[
            "xlsx", "xls", "ods", "mf4", "mdf", "tdms", "h5", "hdf5", "mat", "parquet",
        ],
        name: "a spreadsheet or a file of measurements",
        read_as: &[],
        way_out: "export the histories as CSV with a line of names; a scene uses them as its reference: reference = { csv = \"F.csv\" }",
    },
    FileKind {
        endings: &["fmu"],
        name: "an FMU",
        read_as: &[],
        way_out: "`gearbench fmu SCENE` writes FMUs for other programs but does not read them",
    },
    FileKind {
        endings: &["yaml", "yml", "xml", "ini"],
        name: "a file in another format than TOML",
        read_as: &[],
        way_out: "scenes are TOML: `gearbench init` writes a template, `gearbench help scene` describes the format",
    },
    FileKind {
        endings: &["html", "svg", "png", "pdf"],
        name: "a page or a picture",
        read_as: &[],
        way_out: "`gearbench report DIR` rewrites the report of a study from its folder",
    },
];

/// The kind of a file by its name; the longest ending counts.
pub fn of(path: impl AsRef<Path>) -> Option<&'static FileKind> {
    let name = path.as_ref().file_name()?.to_string_lossy().to_lowercase();
    let ends = |ending: &&str| {
        let before = name.strip_suffix(*ending);
        before.is_some_and(|b| b.ends_with('.') && b.len() > 1)
    };
    KINDS.iter().find(|kind| kind.endings.iter().any(ends))
}

/// Returns the kind of a known file that cannot be read as `input`.
pub fn foreign(path: impl AsRef<Path>, input: Input) -> Option<&'static FileKind> {
    of(path).filter(|kind| !kind.read_as.contains(&input))
}

impl FileKind {
    /// Returns the advice for a file of this kind, with the name of the file in place of the one in the table.
    pub fn way_out_of(&self, path: impl AsRef<Path>) -> String {
        let path = path.as_ref();
        let name = path.display().to_string();
        let stem = path.with_extension("").display().to_string();
        let mut text = self.way_out.to_owned();
        let own = |ending: &str| self.endings.contains(&ending);
        let examples = ["toml", "inp", "msh", "cdb", "csv", "npz", "step"];
        for ending in examples {
            let with = match own(ending) {
                true => name.clone(),
                false => format!("{stem}.{ending}"),
            };
            text = text.replace(&format!("F.{ending}"), &with);
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_known_by_their_endings() {
        let name = |path: &str| of(path).map(|kind| kind.name);
        assert_eq!(name("a/gear.STEP"), Some("CAD geometry"));
        assert_eq!(name("gear.inp.gz"), of("gear.msh").map(|k| k.name));
        assert_eq!(name("step"), None);
        assert_eq!(name(".step"), None);
        assert_eq!(name("gear.unknown"), None);
        assert!(foreign("gear.msh", Input::Mesh).is_none());
        assert!(foreign("gear.msh", Input::Scene).is_some());
        for kind in KINDS {
            for ending in kind.endings {
                assert_eq!(
                    of(format!("a.{ending}")).unwrap().name,
                    kind.name,
                    "{ending}"
                );
            }
        }
    }

    #[test]
    fn the_way_out_names_the_file() {
        let way_out = |path: &str| of(path).unwrap().way_out_of(path);
        assert!(way_out("cad/gear.stp").contains("gmsh -3 cad/gear.stp -o cad/gear.msh"));
        assert!(way_out("x.vtu").contains("gearbench reduce x.inp"));
        assert!(way_out("press.tsv").contains("csv = \"press.tsv\""));
        assert!(way_out("press.xlsx").contains("csv = \"press.csv\""));
    }
}

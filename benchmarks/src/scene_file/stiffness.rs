//! `stiffness` of a contact: of a tooth pair along the path of contact.

use super::contact::{tag, word_or};
use super::error::SceneError;
use super::reader::{Entry, Key, Section, key};
use gearbench_models::stiffness::{
    Ends, Foundation, Hertz, Interpolation, IsoVariation, PairOrMesh, PairStiffness, RootLength,
    ToothModel,
};

const KIND: Key = key(
    "kind",
    "\"constant\", \"iso6336\", \"compliance\" or \"table\"",
);
const OF: Key = key(
    "of",
    "\"pair\" (default): one spring per tooth pair; \"mesh\": one for the mesh",
);

pub(super) static CONSTANT: &[Key] = &[
    KIND,
    key(
        "stiffness_n_per_m2",
        "stiffness per face width in N/m per m; 14 N/(mm um) is 1.4e10",
    ),
    OF,
];
pub(super) static ISO: &[Key] = &[
    KIND,
    key(
        "variation",
        "along the path: \"iso-mean\" (default), \"cai-hayashi\" or \"constant\"",
    ),
];
pub(super) static COMPLIANCE: &[Key] = &[
    KIND,
    key(
        "tooth",
        "\"weber-banaschek\" (default), \"cornell\" or \"energy\"",
    ),
    key(
        "foundation",
        "\"sainsot-velex\" (default), \"weber-banaschek\", \"cornell\" or \"rigid\"",
    ),
    key(
        "root_length",
        "S of Sainsot and Velex: \"2 rf theta\" (default), \"2 rf sin theta\" or \"2 rb theta\"",
    ),
    key(
        "hertz",
        "\"linear\" (default), \"log\", \"weber-banaschek\" or \"rigid\"",
    ),
    key(
        "reference_load_n",
        "load of the pair in newton at which a logarithmic Hertz law is taken",
    ),
];
pub(super) static TABLE: &[Key] = &[
    KIND,
    key(
        "path_coordinate_m",
        "list of path coordinates in metres, ascending",
    ),
    key(
        "stiffness_n_per_m",
        "list of stiffnesses in N/m for the whole face width",
    ),
    OF,
    key(
        "ends",
        "outside the table: \"clamped\" (default) or \"periodic\"",
    ),
    key("interpolation", "\"cubic\" (default) or \"linear\""),
];

/// Reads a stiffness.
pub(super) fn stiffness(entry: &Entry<'_>) -> Result<PairStiffness, SceneError> {
    if let Some(word) = entry.as_text() {
        return match word {
            "iso6336" => Ok(PairStiffness::Iso6336 { variation: IsoVariation::default() }),
            "compliance" => Ok(PairStiffness::Compliance {
                tooth: ToothModel::WeberBanaschek,
                foundation: Foundation::SainsotVelex(RootLength::default()),
                hertz: Hertz::Linear,
            }),
            "constant" | "table" => Err(entry.error(
                format!("the stiffness \"{word}\" needs its values"),
                "expected a table",
                if word == "constant" {
                    "for example { kind = \"constant\", stiffness_n_per_m2 = 1.4e10 }"
                } else {
                    "for example { kind = \"table\", path_coordinate_m = [..], stiffness_n_per_m = [..] }"
                },
            )),
            other => Err(entry.unknown_word(other, &["constant", "iso6336", "compliance", "table"])),
        };
    }
    let kinds = [
        ("constant", 0),
        ("iso6336", 1),
        ("compliance", 2),
        ("table", 3),
    ];
    match tag(entry, "kind", &kinds)? {
        0 => constant(&entry.section("`stiffness`", CONSTANT)?),
        1 => {
            let s = entry.section("`stiffness`", ISO)?;
            let known = [
                ("iso-mean", IsoVariation::IsoMean),
                ("cai-hayashi", IsoVariation::CaiHayashi),
                ("constant", IsoVariation::Constant),
            ];
            Ok(PairStiffness::Iso6336 {
                variation: word_or(&s, "variation", &known)?,
            })
        }
        2 => compliance(&entry.section("`stiffness`", COMPLIANCE)?),
        _ => table(&entry.section("`stiffness`", TABLE)?),
    }
}

fn of(s: &Section<'_>) -> Result<PairOrMesh, SceneError> {
    word_or(
        s,
        "of",
        &[("pair", PairOrMesh::Pair), ("mesh", PairOrMesh::Mesh)],
    )
}

fn constant(s: &Section<'_>) -> Result<PairStiffness, SceneError> {
    let entry = s.need("stiffness_n_per_m2")?;
    let per_width = entry.number()?;
    if per_width <= 0.0 {
        return Err(entry.error(
            format!("the stiffness per width is {per_width}"),
            "expected more than zero",
            "a steel tooth pair has about 1.4e10 N/m per m, 14 N/(mm um)",
        ));
    }
    Ok(PairStiffness::Constant {
        per_width,
        of: of(s)?,
    })
}

fn compliance(s: &Section<'_>) -> Result<PairStiffness, SceneError> {
    let tooth = word_or(
        s,
        "tooth",
        &[
            ("weber-banaschek", ToothModel::WeberBanaschek),
            ("cornell", ToothModel::Cornell),
            ("energy", ToothModel::Energy),
        ],
    )?;
    let root_length = word_or(
        s,
        "root_length",
        &[
            ("2 rf theta", RootLength::TwoRfThetaF),
            ("2 rf sin theta", RootLength::TwoRfSinThetaF),
            ("2 rb theta", RootLength::TwoRbThetaF),
        ],
    )?;
    let foundation = word_or(
        s,
        "foundation",
        &[
            ("sainsot-velex", Foundation::SainsotVelex(root_length)),
            ("weber-banaschek", Foundation::WeberBanaschek),
            ("cornell", Foundation::Cornell),
            ("rigid", Foundation::Rigid),
        ],
    )?;
    if let (Some(e), false) = (
        s.get("root_length"),
        matches!(foundation, Foundation::SainsotVelex(_)),
    ) {
        return Err(e.error(
            format!(
                "`root_length` does not belong to the foundation \"{}\"",
                foundation.id()
            ),
            "remove this",
            "only \"sainsot-velex\" has a root length S",
        ));
    }
    let kind = word_or(
        s,
        "hertz",
        &[
            ("linear", 0),
            ("log", 1),
            ("weber-banaschek", 2),
            ("rigid", 3),
        ],
    )?;
    let load = s.get("reference_load_n");
    let hertz = match (kind, load) {
        (0 | 3, Some(e)) => {
            return Err(e.error(
                "`reference_load_n` does not belong to this Hertz law",
                "remove this",
                "only \"log\" and \"weber-banaschek\" depend on the load",
            ));
        }
        (0, None) => Hertz::Linear,
        (3, None) => Hertz::Rigid,
        (kind, _) => {
            let entry = s.need("reference_load_n")?;
            let reference_load = entry.number()?;
            if reference_load <= 0.0 {
                return Err(entry.error(
                    format!("the reference load is {reference_load} N"),
                    "expected more than zero",
                    "take the mean load of a tooth pair",
                ));
            }
            if kind == 1 {
                Hertz::Log { reference_load }
            } else {
                Hertz::WeberBanaschek { reference_load }
            }
        }
    };
    Ok(PairStiffness::Compliance {
        tooth,
        foundation,
        hertz,
    })
}

fn table(s: &Section<'_>) -> Result<PairStiffness, SceneError> {
    Ok(PairStiffness::Table {
        s: s.need("path_coordinate_m")?.numbers()?,
        k: s.need("stiffness_n_per_m")?.numbers()?,
        of: of(s)?,
        ends: word_or(
            s,
            "ends",
            &[("clamped", Ends::Clamped), ("periodic", Ends::Periodic)],
        )?,
        interpolation: word_or(
            s,
            "interpolation",
            &[
                ("cubic", Interpolation::Cubic),
                ("linear", Interpolation::Linear),
            ],
        )?,
    })
}

//! The key `stiffness` of a contact: stiffness of a tooth pair along the path of contact.

use super::error::SceneError;
use super::reading::Place;
use super::reading::keys::keys;
use super::reading::values::{Positive, is_default};
use gearbench_models::stiffness::{
    Ends, Foundation, Hertz, Interpolation, IsoVariation, PairOrMesh, PairStiffness, RootLength,
    ToothModel,
};
use serde::{Deserialize, Serialize};

/// Stiffness of tooth pairs along the path of contact; the tag is `kind`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(rename = "<kind>", rename_all = "kebab-case")]
pub enum StiffnessTable {
    /// A constant.
    Constant(ConstantTable),
    /// A parabola over the path.
    Parabola(ParabolaTable),
    /// The single stiffness of ISO 6336-1.
    Iso6336(IsoTable),
    /// Compliances of tooth, foundation and Hertzian contact.
    Compliance(ComplianceTable),
    /// Values over the path coordinate.
    Table(TabulatedTable),
}

keys! {
    /// A constant stiffness.
    struct ConstantTable {
        /// stiffness per face width in N/m per m; 14 N/(mm um) is 1.4e10
        stiffness_n_per_m2: Positive,
        /// "pair" (default): one spring per tooth pair; "mesh": one for the mesh
        #[serde(default, skip_serializing_if = "is_default")]
        of: PairOrMesh,
    }

    /// A stiffness that is a parabola over the path of contact.
    struct ParabolaTable {
        /// stiffness per face width in the middle of the path in N/m per m
        stiffness_n_per_m2: Positive,
        /// a of 1 + a xi + b xi^2, with xi from -1 where contact starts to 1 where it ends; default 0
        #[serde(default, skip_serializing_if = "is_default")]
        path_slope: f64,
        /// b of it, default 0
        #[serde(default, skip_serializing_if = "is_default")]
        path_curvature: f64,
        /// "pair" (default): one spring per tooth pair; "mesh": one for the mesh
        #[serde(default, skip_serializing_if = "is_default")]
        of: PairOrMesh,
    }

    /// The stiffness of ISO 6336-1.
    #[derive(Default)]
    struct IsoTable {
        /// along the path: "iso-mean" (default), "cai-hayashi" or "constant"
        #[serde(default, skip_serializing_if = "is_default")]
        variation: IsoVariation,
    }

    /// A stiffness from the compliances of tooth, foundation and contact.
    #[derive(Default)]
    struct ComplianceTable {
        /// "weber-banaschek" (default), "cornell" or "energy"
        tooth: Option<ToothModel>,
        /// "ring" (default), "sainsot-velex", "weber-banaschek", "cornell" or "rigid"
        #[serde(default, skip_serializing_if = "is_default")]
        foundation: FoundationWord,
        /// S of Sainsot and Velex: "2 rf theta" (default), "2 rf sin theta" or "2 rb theta"
        root_length: Option<RootLength>,
        /// "weber-banaschek" (default), "log", "linear" or "rigid"
        #[serde(default, skip_serializing_if = "is_default")]
        hertz: HertzWord,
        /// load of a tooth pair in newton at which "weber-banaschek" and "log" are taken; 100 N per mm of face width when left out
        reference_load_n: Option<Positive>,
    }

    /// A stiffness by its values over the path coordinate.
    #[derive(Default)]
    struct TabulatedTable {
        /// list of path coordinates in metres, ascending
        path_coordinate_m: Vec<f64>,
        /// list of stiffnesses in N/m for the whole face width
        stiffness_n_per_m: Vec<f64>,
        /// "pair" (default): one spring per tooth pair; "mesh": one for the mesh
        #[serde(default, skip_serializing_if = "is_default")]
        of: PairOrMesh,
        /// outside the table: "clamped" (default) or "periodic"
        #[serde(default, skip_serializing_if = "is_default")]
        ends: Ends,
        /// "cubic" (default) or "linear"
        #[serde(default, skip_serializing_if = "is_default")]
        interpolation: Interpolation,
    }
}

/// Compliance of the tooth foundation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FoundationWord {
    /// The foundation is an elastic ring whose bore is held.
    #[default]
    Ring,
    /// The foundation follows the formula of Sainsot and Velex.
    SainsotVelex,
    /// The formula of Weber and Banaschek.
    WeberBanaschek,
    /// The formula of Cornell.
    Cornell,
    /// No compliance.
    Rigid,
}

/// Compliance of the Hertzian contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum HertzWord {
    /// A constant.
    Linear,
    /// The logarithmic formula for a line contact.
    Log,
    /// The formula of Weber and Banaschek.
    #[default]
    WeberBanaschek,
    /// No compliance.
    Rigid,
}

impl From<&PairStiffness> for StiffnessTable {
    fn from(stiffness: &PairStiffness) -> Self {
        match stiffness {
            PairStiffness::Constant { per_width, of } => StiffnessTable::Constant(ConstantTable {
                stiffness_n_per_m2: Positive(*per_width),
                of: *of,
            }),
            PairStiffness::Parabola {
                per_width,
                along: [path_slope, path_curvature],
                of,
            } => StiffnessTable::Parabola(ParabolaTable {
                stiffness_n_per_m2: Positive(*per_width),
                path_slope: *path_slope,
                path_curvature: *path_curvature,
                of: *of,
            }),
            PairStiffness::Iso6336 { variation } => StiffnessTable::Iso6336(IsoTable {
                variation: *variation,
            }),
            PairStiffness::Compliance {
                tooth,
                foundation,
                hertz,
            } => {
                let (foundation, root_length) = match *foundation {
                    Foundation::Ring => (FoundationWord::Ring, None),
                    Foundation::SainsotVelex(length) => {
                        let given = Some(length).filter(|l| *l != RootLength::default());
                        (FoundationWord::SainsotVelex, given)
                    }
                    Foundation::WeberBanaschek => (FoundationWord::WeberBanaschek, None),
                    Foundation::Cornell => (FoundationWord::Cornell, None),
                    Foundation::Rigid => (FoundationWord::Rigid, None),
                };
                let (hertz, reference_load) = match *hertz {
                    Hertz::Linear => (HertzWord::Linear, None),
                    Hertz::Log { reference_load } => (HertzWord::Log, reference_load),
                    Hertz::WeberBanaschek { reference_load } => {
                        (HertzWord::WeberBanaschek, reference_load)
                    }
                    Hertz::Rigid => (HertzWord::Rigid, None),
                };
                StiffnessTable::Compliance(ComplianceTable {
                    tooth: Some(*tooth),
                    foundation,
                    root_length,
                    hertz,
                    reference_load_n: reference_load.map(Positive),
                })
            }
            PairStiffness::Table {
                s,
                k,
                of,
                ends,
                interpolation,
            } => StiffnessTable::Table(TabulatedTable {
                path_coordinate_m: s.clone(),
                stiffness_n_per_m: k.clone(),
                of: *of,
                ends: *ends,
                interpolation: *interpolation,
            }),
        }
    }
}

/// Reads the stiffness of a contact.
pub(super) fn stiffness(
    keys: &StiffnessTable,
    at: &Place<'_>,
) -> Result<PairStiffness, SceneError> {
    Ok(match keys {
        StiffnessTable::Constant(keys) => PairStiffness::Constant {
            per_width: keys.stiffness_n_per_m2.0,
            of: keys.of,
        },
        StiffnessTable::Parabola(keys) => PairStiffness::Parabola {
            per_width: keys.stiffness_n_per_m2.0,
            along: [keys.path_slope, keys.path_curvature],
            of: keys.of,
        },
        StiffnessTable::Iso6336(keys) => PairStiffness::Iso6336 {
            variation: keys.variation,
        },
        StiffnessTable::Compliance(keys) => PairStiffness::Compliance {
            tooth: keys.tooth.unwrap_or(ToothModel::WeberBanaschek),
            foundation: foundation(keys, at)?,
            hertz: hertz(keys, at)?,
        },
        StiffnessTable::Table(keys) => PairStiffness::Table {
            s: keys.path_coordinate_m.clone(),
            k: keys.stiffness_n_per_m.clone(),
            of: keys.of,
            ends: keys.ends,
            interpolation: keys.interpolation,
        },
    })
}

fn foundation(keys: &ComplianceTable, at: &Place<'_>) -> Result<Foundation, SceneError> {
    let foundation = match keys.foundation {
        FoundationWord::Ring => Foundation::Ring,
        FoundationWord::SainsotVelex => {
            return Ok(Foundation::SainsotVelex(
                keys.root_length.unwrap_or_default(),
            ));
        }
        FoundationWord::WeberBanaschek => Foundation::WeberBanaschek,
        FoundationWord::Cornell => Foundation::Cornell,
        FoundationWord::Rigid => Foundation::Rigid,
    };
    match keys.root_length {
        None => Ok(foundation),
        Some(_) => at.key("root_length").refuse(
            format!(
                "`root_length` does not belong to the foundation \"{}\"",
                foundation.id()
            ),
            "remove this",
            "only \"sainsot-velex\" has a root length S",
        ),
    }
}

fn hertz(keys: &ComplianceTable, at: &Place<'_>) -> Result<Hertz, SceneError> {
    let reference_load = keys.reference_load_n.map(f64::from);
    Ok(match (keys.hertz, reference_load) {
        (HertzWord::Log, _) => Hertz::Log { reference_load },
        (HertzWord::WeberBanaschek, _) => Hertz::WeberBanaschek { reference_load },
        (HertzWord::Linear, None) => Hertz::Linear,
        (HertzWord::Rigid, None) => Hertz::Rigid,
        (_, Some(_)) => {
            return at.key("reference_load_n").refuse(
                "`reference_load_n` does not belong to this Hertz law",
                "remove this",
                "only \"log\" and \"weber-banaschek\" depend on the load",
            );
        }
    })
}

//! The key `stiffness` of a contact: stiffness of a tooth pair along the path of contact.

use super::error::SceneError;
use super::reading::Place;
use super::reading::keys::keys;
use super::reading::values::Positive;
use gearbench_models::stiffness::{
    Ends, Foundation, Hertz, Interpolation, IsoVariation, PairOrMesh, PairStiffness, RootLength,
    ToothModel,
};
use serde::Deserialize;

#[derive(Clone, Debug, Deserialize)]
#[serde(rename = "<kind>", rename_all = "kebab-case")]
pub(super) enum StiffnessKeys {
    Constant(ConstantKeys),
    Parabola(ParabolaKeys),
    Iso6336(IsoKeys),
    Compliance(ComplianceKeys),
    Table(TableKeys),
}

keys! {
    pub(super) struct ConstantKeys {
        /// stiffness per face width in N/m per m; 14 N/(mm um) is 1.4e10
        stiffness_n_per_m2: Positive,
        /// "pair" (default): one spring per tooth pair; "mesh": one for the mesh
        #[serde(default)]
        of: PairOrMesh,
    }

    pub(super) struct ParabolaKeys {
        /// stiffness per face width in the middle of the path in N/m per m
        stiffness_n_per_m2: Positive,
        /// a of 1 + a xi + b xi^2, with xi from -1 where contact starts to 1 where it ends; default 0
        #[serde(default)]
        path_slope: f64,
        /// b of it, default 0
        #[serde(default)]
        path_curvature: f64,
        /// "pair" (default): one spring per tooth pair; "mesh": one for the mesh
        #[serde(default)]
        of: PairOrMesh,
    }

    pub(super) struct IsoKeys {
        /// along the path: "iso-mean" (default), "cai-hayashi" or "constant"
        #[serde(default)]
        variation: IsoVariation,
    }

    pub(super) struct ComplianceKeys {
        /// "weber-banaschek" (default), "cornell" or "energy"
        tooth: Option<ToothModel>,
        /// "ring" (default), "sainsot-velex", "weber-banaschek", "cornell" or "rigid"
        #[serde(default)]
        foundation: FoundationWord,
        /// S of Sainsot and Velex: "2 rf theta" (default), "2 rf sin theta" or "2 rb theta"
        root_length: Option<RootLength>,
        /// "weber-banaschek" (default), "log", "linear" or "rigid"
        #[serde(default)]
        hertz: HertzWord,
        /// load of a tooth pair in newton at which "weber-banaschek" and "log" are taken; 100 N per mm of face width when left out
        reference_load_n: Option<Positive>,
    }

    pub(super) struct TableKeys {
        /// list of path coordinates in metres, ascending
        path_coordinate_m: Vec<f64>,
        /// list of stiffnesses in N/m for the whole face width
        stiffness_n_per_m: Vec<f64>,
        /// "pair" (default): one spring per tooth pair; "mesh": one for the mesh
        #[serde(default)]
        of: PairOrMesh,
        /// outside the table: "clamped" (default) or "periodic"
        #[serde(default)]
        ends: Ends,
        /// "cubic" (default) or "linear"
        #[serde(default)]
        interpolation: Interpolation,
    }
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum FoundationWord {
    #[default]
    Ring,
    SainsotVelex,
    WeberBanaschek,
    Cornell,
    Rigid,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum HertzWord {
    Linear,
    Log,
    #[default]
    WeberBanaschek,
    Rigid,
}

/// Reads the stiffness of a contact.
pub(super) fn stiffness(keys: &StiffnessKeys, at: &Place<'_>) -> Result<PairStiffness, SceneError> {
    Ok(match keys {
        StiffnessKeys::Constant(keys) => PairStiffness::Constant {
            per_width: keys.stiffness_n_per_m2.0,
            of: keys.of,
        },
        StiffnessKeys::Parabola(keys) => PairStiffness::Parabola {
            per_width: keys.stiffness_n_per_m2.0,
            along: [keys.path_slope, keys.path_curvature],
            of: keys.of,
        },
        StiffnessKeys::Iso6336(keys) => PairStiffness::Iso6336 {
            variation: keys.variation,
        },
        StiffnessKeys::Compliance(keys) => PairStiffness::Compliance {
            tooth: keys.tooth.unwrap_or(ToothModel::WeberBanaschek),
            foundation: foundation(keys, at)?,
            hertz: hertz(keys, at)?,
        },
        StiffnessKeys::Table(keys) => PairStiffness::Table {
            s: keys.path_coordinate_m.clone(),
            k: keys.stiffness_n_per_m.clone(),
            of: keys.of,
            ends: keys.ends,
            interpolation: keys.interpolation,
        },
    })
}

fn foundation(keys: &ComplianceKeys, at: &Place<'_>) -> Result<Foundation, SceneError> {
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

fn hertz(keys: &ComplianceKeys, at: &Place<'_>) -> Result<Hertz, SceneError> {
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

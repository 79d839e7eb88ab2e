//! Why a mesh was refused.

use crate::limits::TooMuchMemory;
use gearbench_models::geometry::{GeometryError, Side};

/// A part of a toothed body, for messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[expect(missing_docs, reason = "`words` says what they are")]
pub enum Part {
    Flank,
    Fillet,
    Core,
    Rim,
    Web,
    Hub,
}

impl Part {
    /// Returns the name of the part, and the parameter to change when its elements are invalid.
    fn words(self) -> (&'static str, &'static str) {
        match self {
            Part::Flank => (
                "the skin of the flank",
                "use more elements along the flank or fewer layers in the skin",
            ),
            Part::Fillet => (
                "the skin of the fillet and root",
                "use more elements along the fillet, or fewer layers in the skin",
            ),
            Part::Core => (
                "the core of the tooth",
                "use more elements along the fillet and across the tooth",
            ),
            Part::Rim => (
                "the rim",
                "use more elements along the fillet, or a smaller bore (a deeper body)",
            ),
            Part::Web => ("the web", "move its radii away from the root and the bore"),
            Part::Hub => ("the hub", "move the web's inner radius away from the bore"),
        }
    }
}

impl std::fmt::Display for Part {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.words().0)
    }
}

/// Refusal of a mesh: the problem and the parameter to change.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are about")]
pub enum MeshError {
    #[error("{what} is {value}; expected {expected}")]
    Invalid {
        what: &'static str,
        value: f64,
        expected: &'static str,
    },
    #[error(
        "the web from radius {inner:.6} m to {outer:.6} m, {thickness:.6} m thick, does not fit: it needs \
         {low:.6} m < inner < outer < {high:.6} m and a thickness below the face width {width:.6} m"
    )]
    Web {
        inner: f64,
        outer: f64,
        thickness: f64,
        low: f64,
        high: f64,
        width: f64,
    },
    #[error("meshes of gears and racks are built of hexahedra, not of {kind}: take {known}")]
    NoHexahedron { kind: &'static str, known: String },
    #[error("fine tooth {tooth} does not exist: the teeth are 0 to {last}")]
    NoSuchTooth { tooth: u32, last: u32 },
    #[error(
        "a sector is one tooth: it cannot have fine and coarse teeth; mesh the whole gear or drop one of both"
    )]
    SectorWithFineTeeth,
    #[error("the section at the height {height:.6} m cannot be meshed: {why}")]
    Section { height: f64, why: GeometryError },
    #[error(
        "at the height {height:.6} m the tilted rack undercuts {side:?} flanks: their base radius {base:.6} m lies above the form \
         radius {form:.6} m; take a smaller profile-shift angle, helix angle or face width, or a larger profile shift"
    )]
    Undercut {
        side: Side,
        height: f64,
        base: f64,
        form: f64,
    },
    #[error("an internal gear is a rim with teeth, without a web: leave the web out")]
    InternalWithWeb,
    #[error("a rack has neither a web nor sectors: leave them out")]
    RackWithWebOrSector,
    #[error(transparent)]
    TooLarge(#[from] TooMuchMemory),
    #[error(
        "an element in {part}, near ({:.6}, {:.6}, {:.6}) m, would have the Jacobian {jacobian:.2e} (of its size); {}",
        .at[0], .at[1], .at[2], .part.words().1
    )]
    Inverted {
        part: Part,
        at: [f64; 3],
        jacobian: f64,
    },
}

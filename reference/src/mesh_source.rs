//! Where the mesh of a gear comes from: the parameters of the models that are made of finite elements.
//!
//! | part | owns |
//! |---|---|
//! | `reader` | parameters as a model reads them |
//! | `stored` | the gear of a scene in a file, and what is said of it |
//! | `agree` | what its mesh has otherwise than the gear of the scene |

mod agree;
mod reader;
mod stored;
#[cfg(test)]
mod tests;

pub use reader::Reader;
pub use stored::Stored;

use crate::gear_mesh::{self, GearMesh, GearMeshParams};
use crate::mesh::ElementKind;
use gearbench_models::declare_parameters;
use gearbench_models::error::BuildError;
use gearbench_models::gear::parameters::whole;
use gearbench_models::spec::Body as Toothing;

declare_parameters! {
    /// Parameters of the source of a mesh.
    pub struct MeshParameters {
        /// "generated" (default), a stored reference such as "calculix/case-a-fine", or a path of a deck (.inp), a mesh of Gmsh (.msh) or an archive of Ansys (.cdb), also .gz
        mesh: String,
        /// "C3D8" or "C3D8I" (default for generated meshes); a deck brings its own
        element: String,
        /// elements along a flank of a generated mesh
        #[serde(deserialize_with = "whole")]
        flank_elements: usize,
        /// elements along a fillet of a generated mesh
        #[serde(deserialize_with = "whole")]
        fillet_elements: usize,
        /// elements across a tooth of a generated mesh
        #[serde(deserialize_with = "whole")]
        across_elements: usize,
        /// elements from root to bore of a generated mesh
        #[serde(deserialize_with = "whole")]
        rim_elements: usize,
        /// elements over the face width of a generated mesh
        #[serde(deserialize_with = "whole")]
        width_elements: usize,
        /// units of the file that `mesh` names, one of "m-kg-s", "mm-t-s", "mm-kg-s", "mm-kg-ms", "mm-g-ms"; left out, they are found from density and modulus, or from the size
        units: String,
        /// [x, y, z] of the gear's axis (of a rack: of its width) in the file, teeth counted counter-clockwise about it; left out, it is found
        axis: [f64; 3],
        /// [x, y, z] of a point on the axis (of a rack: on its reference line) in the file, in metres; left out, it is found
        axis_point_m: [f64; 3],
        /// [from, to]: radii between which the flanks lie, in metres; left out, they are found
        flank_radii_m: [f64; 2],
    }
}

impl MeshParameters {
    /// Returns the first given key that describes a file.
    fn of_file(&self) -> Option<&'static str> {
        let given = [
            ("units", self.units.is_some()),
            ("axis", self.axis.is_some()),
            ("axis_point_m", self.axis_point_m.is_some()),
            ("flank_radii_m", self.flank_radii_m.is_some()),
        ];
        given.into_iter().find_map(|(key, is)| is.then_some(key))
    }

    /// Numbers of elements of a generated mesh, by their keys.
    fn counts(&self) -> [(&'static str, Option<usize>); 5] {
        [
            ("flank_elements", self.flank_elements),
            ("fillet_elements", self.fillet_elements),
            ("across_elements", self.across_elements),
            ("rim_elements", self.rim_elements),
            ("width_elements", self.width_elements),
        ]
    }

    /// Numbers of elements of a generated mesh, given or by default: along a flank, along a fillet, across a tooth, from
    /// root to bore, over the width.
    pub fn counted(&self) -> [usize; 5] {
        let usual = GearMeshParams::default();
        let tooth = usual.tooth;
        let usual = [
            tooth.flank,
            tooth.fillet,
            tooth.across,
            usual.rim,
            usual.width,
        ];
        let mut given = self.counts().into_iter().zip(usual);
        std::array::from_fn(|_| given.next().map_or(1, |((_, n), usual)| n.unwrap_or(usual)))
    }

    /// A generated mesh with so many times the elements along flank and fillet, across the teeth, from root to bore, over
    /// the width.
    #[must_use]
    pub fn times(&self, factor: usize) -> MeshParameters {
        let [flank, fillet, across, rim, width] = self.counted().map(|n| Some(factor * n));
        MeshParameters {
            element: self.element.clone(),
            flank_elements: flank,
            fillet_elements: fillet,
            across_elements: across,
            rim_elements: rim,
            width_elements: width,
            ..MeshParameters::default()
        }
    }
}

/// A mesh from a file, or the parameters of a generated one.
#[derive(Clone, Debug)]
pub enum Source {
    /// Parameters of a generated mesh.
    Generated(Box<GearMeshParams>),
    /// Read from a deck, in the gear's own frame.
    Deck(Box<Stored>),
}

impl Source {
    /// Where the mesh of a gear comes from.
    pub fn read(reader: &Reader<'_>, given: &MeshParameters) -> Result<Source, BuildError> {
        let element = match &given.element {
            None => None,
            Some(name) => Some(ElementKind::from_name(name).ok_or_else(|| {
                let known = ElementKind::ALL.map(ElementKind::name);
                reader.error(
                    "element",
                    (
                        format!("there is no element \"{name}\""),
                        format!("there are {}", known.join(", ")),
                    ),
                )
            })?),
        };
        match given.mesh.as_deref().unwrap_or("generated") {
            "generated" => generated(reader, given, element),
            source => {
                stored::stored(reader, given, source, element).map(|m| Source::Deck(Box::new(m)))
            }
        }
    }

    /// The whole mesh in the gear's own frame.
    pub fn whole(self, reader: &Reader<'_>) -> Result<GearMesh, BuildError> {
        let params = match self {
            Source::Deck(stored) => return Ok(stored.mesh),
            Source::Generated(params) => params,
        };
        let mesh = match reader.context.body {
            Toothing::Gear(g) => gear_mesh::gear(g, &params),
            Toothing::Rack(r) => gear_mesh::rack(r, &params),
        };
        mesh.map_err(|e| reader.error("mesh", e.to_string()).of_model())
    }

    /// Returns the sector of tooth 0 where the gear consists of equal sectors: a generated gear of three teeth or
    /// more.
    pub fn sector(&self, reader: &Reader<'_>) -> Result<Option<GearMesh>, BuildError> {
        match (self, reader.context.body) {
            (Source::Generated(params), Toothing::Gear(g)) if g.teeth() >= 3 => {
                let mesh = gear_mesh::sector(g, params);
                mesh.map(Some)
                    .map_err(|e| reader.error("mesh", e.to_string()).of_model())
            }
            _ => Ok(None),
        }
    }
}

/// Creates the source of a generated mesh.
fn generated(
    reader: &Reader<'_>,
    given: &MeshParameters,
    element: Option<ElementKind>,
) -> Result<Source, BuildError> {
    if let Some(key) = given.of_file() {
        return Err(reader.error(
            key,
            (
                "applies to meshes from files, but this one is generated",
                "remove it, or set `mesh` to the path of a file",
            ),
        ));
    }
    let mut params = GearMeshParams::default();
    if let Some(kind) = element {
        params.kind = kind;
    }
    let tooth = &mut params.tooth;
    let values = [
        &mut tooth.flank,
        &mut tooth.fillet,
        &mut tooth.across,
        &mut params.rim,
        &mut params.width,
    ];
    for ((key, count), value) in given.counts().into_iter().zip(values) {
        if let Some(n) = reader.count(key, count, 1, 500)? {
            *value = n;
        }
    }
    Ok(Source::Generated(Box::new(params)))
}

//! Parameters of a mesh: numbers of elements, grading, kind of element.

use crate::mesh::ElementKind;

/// Numbers of elements of one tooth in the transverse section.
///
/// Every tooth has a skin of [`Tooth::layers`] elements under its flanks, its fillets and the root between
/// teeth, and a core between the two skins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tooth {
    /// Elements along the involute (or straight) flank, at least 1. This count decides how well contact is
    /// resolved: the sagitta of a chord falls with its square.
    pub flank: usize,
    /// Elements along the fillet, at least 2.
    pub fillet: usize,
    /// Elements on the root arc between the fillet and the middle of the tooth space, at least 1. Where a large
    /// tool radius leaves no such arc they are spread over the fillet.
    pub root: usize,
    /// Elements across the tooth from flank to flank, at least 3.
    pub across: usize,
}

impl Tooth {
    /// Just enough for a tooth that carries no load: it brings mass and the stiffness of its root.
    pub fn coarse() -> Self {
        Tooth {
            flank: 3,
            fillet: 2,
            root: 1,
            across: 3,
        }
    }
}

impl Default for Tooth {
    /// Returns numbers of elements for deflections of teeth on their rims within 1 per cent (with [`GearMeshParams::rim`]
    /// by default; 36 combinations of the three were compared on two pairs of few teeth with elements that resolve the
    /// contact).
    fn default() -> Self {
        Tooth {
            flank: 8,
            fillet: 6,
            root: 2,
            across: 8,
        }
    }
}

/// Some teeth fine, the others coarse.
///
/// Both kinds share the skin's layers, the layers of the rim and those over the width: faces in the middle of
/// the tooth spaces match whatever the teeth beside them look like.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FineTeeth {
    /// Teeth, from 0, with the counts of the mesh.
    pub teeth: Vec<u32>,
    /// Counts of all other teeth.
    pub others: Tooth,
}

/// A position of the flank around which elements are short, for contact: of equal length over about `reach`, and
/// beyond it proportional to the distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Focus {
    /// Part of the flank's arc length from the form circle, 0 to 1.
    pub place: f64,
    /// Part of the flank's arc length, above 0.
    pub reach: f64,
}

/// A web: between the rim and the hub the body is a thinner disc, in the middle of the face width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Web {
    /// Where the hub ends and the web begins [m], above the bore radius (of a solid gear, its seat).
    pub inner_radius: f64,
    /// Where the web ends and the rim begins [m], below the root radius.
    pub outer_radius: f64,
    /// Thickness [m], below the face width.
    pub thickness: f64,
    /// Layers of elements from the outer to the inner radius.
    pub layers: usize,
    /// Layers of elements from the inner radius to the bore.
    pub hub_layers: usize,
}

/// How a gear or a rack is meshed.
#[derive(Clone, Debug, PartialEq)]
pub struct GearMeshParams {
    /// Kind of the elements.
    pub kind: ElementKind,
    /// Elements of a tooth.
    pub tooth: Tooth,
    /// Layers of the skin under flanks, fillets and root; fewer where a tooth has not elements enough across for
    /// them and a core.
    pub layers: usize,
    /// Layers from the skin of the root to the bore, or to the back of a rack (with a web: to its outer radius).
    pub rim: usize,
    /// Layers over the face width (with a web at least 3).
    pub width: usize,
    /// Length of the flank's last element at the tip over that of the first at the form circle; 1 is uniform.
    pub flank_grading: f64,
    /// Elements along the flank short about a place, in the place of `flank_grading`.
    pub flank_focus: Option<Focus>,
    /// Thickness of each layer of the skin over that of its neighbour nearer to the surface; 1 is uniform.
    pub skin_growth: f64,
    /// Thickness of each layer of the rim over that of its neighbour nearer to the teeth; left out, it is chosen
    /// so that the rim continues the skin.
    pub rim_growth: Option<f64>,
    /// A thinner disc between hub and rim; of a gear only.
    pub web: Option<Web>,
    /// True for a mesh of one pitch of a gear only: tooth 0 between the middles of its tooth spaces. The faces there
    /// are the node sets `cut_low` and `cut_high`; node `i` of `cut_high` is node `i` of `cut_low` rotated by one
    /// pitch.
    pub sector: bool,
    /// Mesh these teeth with [`GearMeshParams::tooth`], the others coarser.
    pub fine_teeth: Option<FineTeeth>,
}

impl Default for GearMeshParams {
    fn default() -> Self {
        GearMeshParams {
            kind: ElementKind::C3D8I,
            tooth: Tooth::default(),
            layers: 2,
            rim: 8,
            width: 4,
            flank_grading: 1.0,
            flank_focus: None,
            skin_growth: 1.5,
            rim_growth: None,
            web: None,
            sector: false,
            fine_teeth: None,
        }
    }
}

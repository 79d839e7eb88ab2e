//! The pairs, by laws of stiffness and by finite elements.

use crate::common::{self, modelling};
use gearbench_models::declare_parameters;
use gearbench_models::error::{BuildError, GearPart};
use gearbench_models::gear::GearModel;
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_models::gear::properties::Properties;
use gearbench_models::gear::rigid;
use gearbench_models::gear::table::{GearContext, MODELS, Model};
use gearbench_models::geometry::{Gear, GearParams};
use gearbench_models::spec::{Body, FlankContact, Mount, PointContact, PointRule, SceneSpec};
use gearbench_models::stiffness::{
    Foundation, Hertz, IsoVariation, Material, PairStiffness, RootLength, ToothModel,
};
use gearbench_reference::assembly::tie::MassKind;
use gearbench_reference::full_order::FullOrder;
use gearbench_reference::full_order::body::Body as Elements;
use gearbench_reference::gear_mesh::{self, FineTeeth, GearMeshParams, Tooth};
use gearbench_reference::mesh::ElementKind;
use gearbench_reference::statics::LoadedPair;

/// A pair: all that its stiffness depends on.
pub struct Case {
    pub name: &'static str,
    pub teeth: [u32; 2],
    pub module: f64,
    pub shift: [f64; 2],
    pub width: f64,
    pub distance: f64,
    pub bore_radius: f64,
    /// c' of ISO 6336-1 as published, to its digits.
    pub iso: f64,
}

pub const CASES: [Case; 3] = [
    Case {
        name: "FZG C 16/24, m 4.5",
        teeth: [16, 24],
        module: 4.5e-3,
        shift: [0.1817, 0.1715],
        width: 14e-3,
        distance: 91.5e-3,
        bore_radius: 15e-3,
        iso: 12.3,
    },
    Case {
        name: "S30 30/30, m 2",
        teeth: [30, 30],
        module: 2e-3,
        shift: [0.0, 0.0],
        width: 15e-3,
        distance: 60e-3,
        bore_radius: 10e-3,
        iso: 12.8,
    },
    Case {
        name: "50/50, m 2",
        teeth: [50, 50],
        module: 2e-3,
        shift: [0.0, 0.0],
        width: 20e-3,
        distance: 100e-3,
        bore_radius: 20e-3,
        iso: 14.05,
    },
];

/// Backlash of the pairs comes from teeth thinned by so much [m].
const THINNING: f64 = 30e-6;

fn scene(case: &Case) -> SceneSpec {
    let gear = |i: usize| {
        let params = GearParams {
            teeth: case.teeth[i],
            module: case.module,
            profile_shift: case.shift[i],
            face_width: case.width,
            bore_radius: case.bore_radius,
            thinning: THINNING,
            ..Default::default()
        };
        Gear::new(params).unwrap()
    };
    common::scene([gear(0), gear(1)], Material::STEEL_ISO, case.distance)
}

/// A mesh of finite elements: the teeth about the pitch point as counted here, the others coarse.
#[derive(Clone, Copy)]
pub struct Fineness {
    pub kind: ElementKind,
    pub flank: usize,
    pub fillet: usize,
    pub across: usize,
    pub layers: usize,
    pub rim: usize,
    pub width: usize,
}

pub const USUAL: Fineness = Fineness {
    kind: ElementKind::C3D8I,
    flank: 24,
    fillet: 4,
    across: 6,
    layers: 2,
    rim: 4,
    width: 2,
};

declare_parameters! {
    /// Elements of the pair.
    struct FinePairParameters model "fe" {
        /// elements along a flank
        flank: usize,
        /// elements along a fillet
        fillet: usize,
        /// elements across a tooth
        across: usize,
        /// layers below the flank
        layers: usize,
        /// elements from root to bore
        rim: usize,
        /// elements over the face width
        width: usize,
        /// kind of the elements
        kind: String,
    }
}

/// Finite elements with fine teeth where the contact is.
const FINE_WHERE_IT_TOUCHES: Model = Model::of::<FinePairParameters>(
    "finite elements, fine teeth about the pitch point",
    Properties::NONE,
    fine,
);

fn fine(context: &GearContext<'_>) -> Result<Box<dyn GearModel>, BuildError> {
    let Body::Gear(gear) = context.body else {
        return Err(BuildError::gear(
            context.name,
            GearPart::Model,
            "is no gear",
        ));
    };
    let given = context.parameters::<FinePairParameters>()?;
    let n = |count: Option<usize>| count.expect("all counts are given");
    let kind = given.kind.as_deref().expect("the kind is given");
    let layers = n(given.layers);
    let params = GearMeshParams {
        kind: ElementKind::from_name(kind).unwrap(),
        tooth: Tooth {
            flank: n(given.flank),
            fillet: n(given.fillet),
            root: 2,
            across: n(given.across),
        },
        layers,
        rim: n(given.rim),
        width: n(given.width),
        fine_teeth: Some(FineTeeth {
            teeth: vec![0, 1, gear.teeth() - 1],
            others: Tooth {
                flank: 4,
                fillet: 2,
                root: 1,
                across: 2 * layers + 2,
            },
        }),
        ..Default::default()
    };
    let refused = |e: String| BuildError::gear(context.name, GearPart::Model, e);
    let mesh = gear_mesh::gear(gear, &params).map_err(|e| refused(e.to_string()))?;
    let body = Elements::new(
        mesh,
        &context.material,
        &context.placement,
        &Mount::Fixed,
        MassKind::Lumped,
        context.added_inertia,
    )
    .map_err(|e| refused(e.to_string()))?;
    Ok(Box::new(FullOrder::new(
        context.hub.clone(),
        context.effective_radius,
        body,
    )))
}

pub fn iso() -> PairStiffness {
    PairStiffness::Iso6336 {
        variation: IsoVariation::IsoMean,
    }
}

pub fn analytic(hertz: Hertz) -> PairStiffness {
    PairStiffness::Compliance {
        tooth: ToothModel::WeberBanaschek,
        foundation: Foundation::SainsotVelex(RootLength::default()),
        hertz,
    }
}

pub fn rigid_pair(case: &Case, stiffness: PairStiffness) -> LoadedPair {
    let modelling = modelling(rigid::spec(), stiffness, FlankContact::Toothing);
    LoadedPair::new(&scene(case), &modelling, MODELS).unwrap()
}

pub fn elastic_pair(case: &Case, f: Fineness, penalty: f64) -> LoadedPair {
    let fe = FinePairParameters {
        flank: Some(f.flank),
        fillet: Some(f.fillet),
        across: Some(f.across),
        layers: Some(f.layers),
        rim: Some(f.rim),
        width: Some(f.width),
        kind: Some(f.kind.name().into()),
    }
    .spec();
    let points = PointContact {
        rule: PointRule::Quadrature {
            along: 4,
            across: 2,
        },
        ..PointContact::new(penalty)
    };
    let modelling = modelling(fe, iso(), points.into());
    LoadedPair::new(&scene(case), &modelling, &[FINE_WHERE_IT_TOUCHES]).unwrap()
}

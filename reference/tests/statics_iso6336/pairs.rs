//! The pairs, by laws of stiffness and by finite elements.

use crate::common::{self, modelling};
use gearbench_models::error::{BuildError, GearPart};
use gearbench_models::gear::GearModel;
use gearbench_models::gear::properties::Properties;
use gearbench_models::gear::table::{GearContext, MODELS, Model, ParameterInfo};
use gearbench_models::geometry::{Gear, GearParams};
use gearbench_models::spec::{
    Body, FlankContact, ModelSpec, Mount, Parameters, PointContact, PointRule, SceneSpec, Value,
};
use gearbench_models::stiffness::{
    Foundation, Hertz, IsoVariation, Material, PairStiffness, RootLength, ToothModel,
};
use gearbench_reference::assembly::tie::MassKind;
use gearbench_reference::full_order::FullOrder;
use gearbench_reference::full_order::body::Body as Elements;
use gearbench_reference::mesh::{self, ElementKind, FineTeeth, GearMeshParams, Tooth};
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

const KEYS: [&str; 6] = ["flank", "fillet", "across", "layers", "rim", "width"];

const fn count(key: &'static str) -> ParameterInfo {
    ParameterInfo {
        key,
        meaning: "elements",
        required: true,
    }
}

/// Finite elements with fine teeth where the contact is.
const FINE_WHERE_IT_TOUCHES: Model = Model {
    id: "fe",
    title: "finite elements, fine teeth about the pitch point",
    parameters: &[
        count("flank"),
        count("fillet"),
        count("across"),
        count("layers"),
        count("rim"),
        count("width"),
        count("kind"),
    ],
    properties: Properties::NONE,
    build: fine,
};

fn fine(context: &GearContext<'_>) -> Result<Box<dyn GearModel>, BuildError> {
    let Body::Gear(gear) = context.body else {
        return Err(BuildError::gear(
            context.name,
            GearPart::Model,
            "is no gear",
        ));
    };
    let n = |key: &str| match &context.parameters[key] {
        Value::Number(x) => *x as usize,
        other => panic!("{key}: {other:?}"),
    };
    let Value::Text(kind) = &context.parameters["kind"] else {
        panic!("kind")
    };
    let layers = n("layers");
    let params = GearMeshParams {
        kind: ElementKind::from_name(kind).unwrap(),
        tooth: Tooth {
            flank: n("flank"),
            fillet: n("fillet"),
            root: 2,
            across: n("across"),
        },
        layers,
        rim: n("rim"),
        width: n("width"),
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
    let mesh = mesh::gear(gear, &params).map_err(|e| refused(e.to_string()))?;
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
    let rigid = ModelSpec {
        id: "rigid".into(),
        parameters: Parameters::new(),
    };
    let modelling = modelling(rigid, stiffness, FlankContact::Toothing);
    LoadedPair::new(&scene(case), &modelling, MODELS).unwrap()
}

pub fn elastic_pair(case: &Case, f: Fineness, penalty: f64) -> LoadedPair {
    let counts = [f.flank, f.fillet, f.across, f.layers, f.rim, f.width];
    let mut parameters: Parameters = KEYS
        .iter()
        .zip(counts)
        .map(|(key, n)| (key.to_string(), Value::Number(n as f64)))
        .collect();
    parameters.insert("kind".into(), Value::Text(f.kind.name().into()));
    let fe = ModelSpec {
        id: "fe".into(),
        parameters,
    };
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

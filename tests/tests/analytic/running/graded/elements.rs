//! Finite elements of full order that are short along the flank around a position and thin under it.

use crate::running::*;
use gearbench_models::declare_parameters;
use gearbench_models::error::BuildError;
use gearbench_models::gear::GearModel;
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_models::gear::properties::Properties;
use gearbench_models::gear::table::GearContext;
use gearbench_models::geometry::Gear;
use gearbench_models::spec::{Body, Mount, Passes, PointContact, PointRule};
use gearbench_reference::assembly::tie::MassKind;
use gearbench_reference::full_order::FullOrder;
use gearbench_reference::full_order::body::Body as Elements;
use gearbench_reference::gear_mesh::{self, FineTeeth, Focus, GearMeshParams, Tooth};

declare_parameters! {
    /// Numbers of the mesh.
    struct GradedParameters model "graded" {
        /// elements along a flank
        flank: usize,
        /// layers under the flank
        layers: usize,
        /// elements over the width
        width: usize,
        /// place of the short elements
        place: f64,
        /// extent of the short elements; infinite for elements of equal length
        reach: f64,
    }
}

const GRADED: Model = Model::of::<GradedParameters>(
    "finite elements that are short about a place of the flank",
    Properties::NONE,
    graded,
);

fn graded(context: &GearContext<'_>) -> Result<Box<dyn GearModel>, BuildError> {
    let &GradedParameters {
        flank: Some(flank),
        layers: Some(layers),
        width: Some(width),
        place: Some(place),
        reach: Some(reach),
    } = context.parameters()?
    else {
        panic!("all are given")
    };
    let params = GearMeshParams {
        tooth: Tooth {
            flank,
            fillet: layers + 2,
            root: 4,
            across: 2 * layers + 4,
        },
        layers,
        rim: layers + 2,
        // The first layer is a two hundredth of the tooth's half thickness.
        skin_growth: if layers > 6 { 1.5 } else { 2.0 },
        width,
        fine_teeth: Some(FineTeeth {
            teeth: Vec::new(),
            others: Tooth {
                across: 2 * layers + 1,
                ..Tooth::coarse()
            },
        }),
        ..Default::default()
    };
    let gear = toothing(context.body);
    // Elements of equal length along the flanks of three teeth serve all positions of a cycle.
    let (focus, teeth) = match reach.is_finite() {
        true => (Some(Focus { place, reach }), vec![0]),
        false => (None, vec![0, 1, gear.teeth() - 1]),
    };
    let params = GearMeshParams {
        flank_focus: focus,
        fine_teeth: params.fine_teeth.map(|f| FineTeeth { teeth, ..f }),
        ..params
    };
    let mut mesh = gear_mesh::gear(gear, &params).unwrap();
    // Where flanks touch; the elements under them are thinner than a pitch deviation.
    for grid in &mut mesh.flanks {
        grid.deviate(gear);
    }
    let body = Elements::new(
        mesh,
        &context.material,
        &context.placement,
        &Mount::Fixed,
        MassKind::Lumped,
        0.0,
    );
    Ok(Box::new(FullOrder::new(
        context.hub.clone(),
        context.effective_radius,
        body.unwrap(),
    )))
}

/// Returns the gear of a body.
pub fn toothing(body: &Body) -> &Gear {
    match body {
        Body::Gear(gear) => gear,
        Body::Rack(_) => panic!("a gear"),
    }
}

/// Fineness of the finite elements: `flank` of them along the teeth that touch at the path coordinate `s`, of equal
/// length within `reach` of it [m], `layers` under the flank, `width` over the width of each gear. With an infinite reach
/// they are of equal length along the whole flank.
pub struct ElementFineness {
    pub s: f64,
    pub reach: f64,
    pub flank: usize,
    pub layers: usize,
    pub width: [usize; 2],
    /// Penalty of the contact [Pa/m].
    pub penalty: f64,
}

impl ElementFineness {
    pub fn pair(&self, spec: &SceneSpec) -> LoadedPair {
        let length = mesh_layout(&spec.gears[0], &spec.gears[1]).unwrap().length;
        let gears = [self.s, length - self.s].into_iter().enumerate();
        let gears = gears.map(|(i, s)| {
            let gear = toothing(&spec.gears[i].body);
            let (a, b) = (gear.roll_length_form(), gear.roll_length_tip());
            let parameters = GradedParameters {
                flank: Some(self.flank),
                layers: Some(self.layers),
                width: Some(self.width[i]),
                place: Some(((s * s - a * a) / (b * b - a * a)).clamp(0.0, 1.0)),
                // The arc of an involute is s^2/(2 r_b).
                reach: Some(self.reach * 2.0 * gear.r_base() / (b * b - a * a)),
            };
            parameters.spec()
        });
        let points = PointContact {
            rule: PointRule::Quadrature {
                along: 1,
                across: 2,
            },
            passes: Passes::First,
            ..PointContact::new(self.penalty)
        };
        let modelling = Modelling {
            gears: gears.collect(),
            contacts: vec![ContactSpec {
                flanks: points.into(),
                ..contact(1.4e10)
            }],
        };
        let mut table = gearbench::models::models().to_vec();
        table.push(GRADED);
        LoadedPair::new(spec, &modelling, &table).unwrap()
    }
}

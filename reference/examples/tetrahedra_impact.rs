//! The impact of `spur_impact` (z = 20/30, m = 4 mm, 20 rad/s) between elastic gears of other meshes of one body: own
//! hexahedra, quadratic tetrahedra cut from own ones, and meshes of other programs. Prints peak and impulse of the force
//! and how far its history is from that of the first row, as a table.
//!
//!     cargo run --release -p gearbench-reference --example tetrahedra_impact -- [half-spaces] MESH...
//!
//! Flanks touch on their elements, or on half-spaces where that stands first.
//!
//! A MESH is `hex:FLANK:WIDTH`, `tet:FLANK:WIDTH` (elements along a flank and over the width; tetrahedra are written as a
//! deck without sets and read back) or `PINION,WHEEL`, two files.

#![allow(clippy::print_stdout, reason = "the table is what the example is for")]

use gearbench_integrators::{
    AcceptedStep, Control, Outputs, Resolution, SecondOrderSystem, Sink, TimePlan, Work,
};
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_models::geometry::{Gear, GearParams, Side};
use gearbench_models::law::Damping;
use gearbench_models::scene::Scene;
use gearbench_models::spec::{
    Body, ContactSpec, FlankContact, GearSpec, MeshSpec, ModelSpec, Modelling, Mount, Passes,
    PointContact, SceneSpec, Start, UPRIGHT,
};
use gearbench_models::stiffness::{Material, PairOrMesh, PairStiffness};
use gearbench_reference::MODELS;
use gearbench_reference::gear_mesh::{self, GearMeshParams, Tooth};
use gearbench_reference::mesh::{self, ElementKind};
use gearbench_reference::reduction::ElasticParameters;
use std::io::{BufWriter, Write};
use std::path::Path;

/// Error of whatever the example does not expect.
type Failed = Box<dyn std::error::Error>;
/// Step [s] and end of the run [s].
const TIMES: [f64; 2] = [1e-6, 1.4e-4];

/// Force at every step.
#[derive(Default)]
struct History {
    force: Vec<f64>,
    out: Outputs,
}

impl Sink for History {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        sys.output(step.to.at(), &mut self.out);
        self.force.push(self.out.channels[0]);
        Control::Continue
    }
}

fn gears() -> Result<Vec<Gear>, Failed> {
    let gear = |(teeth, bore_radius)| {
        Gear::new(GearParams {
            teeth,
            module: 4e-3,
            face_width: 10e-3,
            tip_radius: 0.3,
            bore_radius,
            ..Default::default()
        })
    };
    let gears = [(20, 15e-3), (30, 25e-3)].map(gear);
    Ok(gears.into_iter().collect::<Result<_, _>>()?)
}

/// Parameters of the model `elastic` for each gear.
fn models(mesh: &str, folder: &Path) -> Result<Vec<ModelSpec>, Failed> {
    let counts: Vec<&str> = mesh.split(':').collect();
    let number = |i: usize| -> Result<usize, Failed> {
        Ok(counts
            .get(i)
            .ok_or("FLANK and WIDTH are missing")?
            .parse()?)
    };
    match counts[0] {
        "hex" => {
            let (flank, width) = (number(1)?, number(2)?);
            let of = ElasticParameters::by_key([
                ("flank_elements", flank),
                ("fillet_elements", flank.div_ceil(2).max(2)),
                ("across_elements", flank.max(6)),
                ("rim_elements", flank.div_ceil(2).max(3)),
                ("width_elements", width),
            ])?;
            Ok(vec![of.clone(), of])
        }
        "tet" => {
            let (flank, width) = (number(1)?, number(2)?);
            let mut all = Vec::new();
            for gear in gears()? {
                let path = folder.join(format!("tet_{flank}_{width}_{}.inp", gear.teeth()));
                write(&path, &gear, flank, width)?;
                all.push(ElasticParameters::by_key([(
                    "mesh",
                    path.display().to_string(),
                )])?);
            }
            Ok(all)
        }
        _ => Ok((mesh.split(','))
            .map(|path| ElasticParameters::by_key([("mesh", path)]))
            .collect::<Result<_, _>>()?),
    }
}

/// A deck of tetrahedra without sets.
fn write(path: &Path, gear: &Gear, flank: usize, width: usize) -> Result<(), Failed> {
    let params = GearMeshParams {
        kind: ElementKind::C3D20,
        tooth: Tooth {
            flank,
            fillet: flank.div_ceil(2).max(2),
            root: 1,
            across: flank.max(3),
        },
        layers: 1,
        rim: flank.div_ceil(2).max(2),
        width,
        ..Default::default()
    };
    let whole = gear_mesh::gear(gear, &params)?.mesh;
    let mesh = mesh::tetrahedra(&whole).ok_or("hexahedra of 20 nodes are cut")?;
    let mut file = BufWriter::new(std::fs::File::create(path)?);
    writeln!(file, "*NODE")?;
    for (i, x) in mesh.nodes.iter().enumerate() {
        writeln!(file, "{}, {:.14e}, {:.14e}, {:.14e}", i + 1, x.x, x.y, x.z)?;
    }
    writeln!(file, "*ELEMENT, TYPE=C3D10, ELSET=GEAR")?;
    for (i, element) in mesh.elements().enumerate() {
        let nodes: Vec<String> = element.iter().map(|n| (n + 1).to_string()).collect();
        writeln!(file, "{}, {}", i + 1, nodes.join(", "))?;
    }
    writeln!(
        file,
        "*MATERIAL, NAME=STEEL\n*ELASTIC\n2.1e11, 0.3\n*DENSITY\n7850.\n*SOLID SECTION, ELSET=GEAR, MATERIAL=STEEL"
    )?;
    Ok(file.flush()?)
}

fn run(mesh: &str, flanks: FlankContact, folder: &Path) -> Result<Vec<f64>, Failed> {
    let gear = |(i, gear)| GearSpec {
        name: format!("gear {}", i + 1),
        body: Body::Gear(gear),
        material: Material::STEEL,
        inertia: None,
        added_inertia: 0.0,
        mount: Mount::Revolute,
        guide: None,
        lateral: None,
        axes: UPRIGHT,
        position: [i as f64 * 0.1001, 0.0, 0.0],
        facing: 0.0,
        speed: if i == 0 { 20.0 } else { 0.0 },
        loads: vec![],
    };
    let spec = SceneSpec {
        duration: f64::INFINITY,
        gears: gears()?.into_iter().enumerate().map(gear).collect(),
        meshes: vec![MeshSpec {
            gears: [0, 1],
            start: Start {
                side: Side::Left,
                gap: 2e-6,
                path_coordinate: None,
                loaded: false,
            },
        }],
        shafts: vec![],
        stages: Vec::new(),
    };
    let modelling = Modelling {
        gears: models(mesh, folder)?,
        contacts: vec![ContactSpec {
            stiffness: PairStiffness::Constant {
                per_width: 1.4e10,
                of: PairOrMesh::Pair,
            },
            exponent: 1.0,
            damping: Damping::None,
            normal_force: None,
            friction: None,
            slices: None,
            flanks,
        }],
    };
    let mut scene = Scene::build(&spec, &modelling, MODELS)?;
    let mut state = scene.initial();
    let plan = TimePlan::new(TIMES[1], Resolution::Step(TIMES[0]));
    let mut history = History::default();
    let mut method = gearbench_integrators::method("trigonometric")?;
    let mut work = Work::default();
    method.run(&mut scene, &mut state, &plan, &mut history, &mut work)?;
    Ok(history.force)
}

fn main() -> Result<(), Failed> {
    let folder = std::env::temp_dir();
    let mut first: Option<Vec<f64>> = None;
    println!(
        "mesh, peak [N], impulse [mN s], from the first: peak %, impulse %, force L2 %, seconds"
    );
    let mut meshes: Vec<String> = std::env::args().skip(1).collect();
    let flanks = if meshes.first().is_some_and(|m| m == "half-spaces") {
        meshes.remove(0);
        FlankContact::HalfSpace
    } else {
        FlankContact::Points(PointContact {
            passes: Passes::First,
            ..PointContact::new(1e15)
        })
    };
    for mesh in meshes {
        let start = std::time::Instant::now();
        let force = run(&mesh, flanks, &folder)?;
        let peak = |f: &[f64]| f.iter().copied().fold(0.0, f64::max);
        let impulse = |f: &[f64]| TIMES[0] * f.iter().sum::<f64>();
        let against = first.get_or_insert_with(|| force.clone());
        let off: f64 = force
            .iter()
            .zip(&*against)
            .map(|(a, b)| (a - b).powi(2))
            .sum();
        let size: f64 = against.iter().map(|b| b * b).sum();
        println!(
            "{mesh}, {:.2}, {:.4}, {:+.3}, {:+.3}, {:.3}, {:.1}",
            peak(&force),
            1e3 * impulse(&force),
            100.0 * (peak(&force) / peak(against) - 1.0),
            100.0 * (impulse(&force) / impulse(against) - 1.0),
            100.0 * (off / size).sqrt(),
            start.elapsed().as_secs_f64()
        );
    }
    Ok(())
}

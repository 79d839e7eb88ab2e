//! Deck of an impact: two gears with rigid bores, contact of tooth pairs, initial speeds, one implicit step.

use super::{FirstLabels, NumberedGear, WriteError, heading, materials};
use crate::deck::writer::{number, position};
use crate::gear_deck::gears::{BodyShape, DeckGear, placed};
use crate::gear_mesh::{GearMesh, letter};
use crate::recognise::across;
use gearbench_models::Vec3;
use gearbench_models::geometry::Side;
use gearbench_models::stiffness::Material;
use std::io::{self, Write};

/// Support of a bore.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hub {
    /// A rigid body, free to turn about the axis, with this speed at the start [rad/s].
    Free {
        /// Angular velocity [rad/s].
        speed: f64,
    },
    /// All nodes of the bore are fixed.
    Clamped,
}

/// A gear of an impact, with its pose.
#[derive(Clone, Debug, PartialEq)]
pub struct ImpactGear<'a> {
    /// Mesh in its own frame.
    pub mesh: &'a GearMesh,
    /// Material of the gear.
    pub material: Material,
    /// Kind of the body: gear or rack.
    pub shape: BodyShape,
    /// As [`DeckGear::axis`]; the hub turns about it.
    pub axis: Vec3,
    /// As [`DeckGear::centre`] [m].
    pub centre: Vec3,
    /// As [`DeckGear::phase`] [rad, m].
    pub phase: f64,
    /// Support of the bore.
    pub hub: Hub,
}

impl<'a> ImpactGear<'a> {
    /// A gear where its deck has it.
    pub fn new(gear: &'a DeckGear, hub: Hub) -> Self {
        ImpactGear {
            mesh: &gear.mesh,
            material: gear.material,
            shape: gear.shape,
            axis: gear.axis,
            centre: gear.centre,
            phase: gear.phase,
            hub,
        }
    }

    /// Transforms a point from the gear frame to the deck.
    fn placed(&self, x: Vec3) -> Vec3 {
        placed(self.shape, [self.centre, self.axis], self.phase, x)
    }
}

/// An impact of two gears.
#[derive(Clone, Debug, PartialEq)]
pub struct Impact<'a> {
    /// Text under `*HEADING`.
    pub title: String,
    /// Both gears; the first has the slave surfaces.
    pub gears: [ImpactGear<'a>; 2],
    /// Side of the flanks that may touch.
    pub side: Side,
    /// Pairs of teeth that may touch, from 0.
    pub pairs: Vec<[u32; 2]>,
    /// Pressure over overclosure [Pa/m].
    pub penalty: f64,
    /// Time step [s].
    pub step: f64,
    /// End time [s].
    pub end: f64,
    /// Parameter of the HHT method, -1/3 to 0.
    pub alpha: f64,
}

/// Writes the deck of an impact, with the sets, surfaces and prints of the stored references.
pub fn write_impact(out: &mut dyn Write, impact: &Impact<'_>) -> Result<(), WriteError> {
    impact.check()?;
    heading(out, &impact.title)?;
    let [one, two] = &impact.gears;
    let counts = [one, two].map(|g| g.mesh.mesh.nodes.len() as u32);
    let numbered = [
        NumberedGear {
            gear: one.mesh,
            suffix: "1",
            labels: FirstLabels::default(),
        },
        NumberedGear {
            gear: two.mesh,
            suffix: "2",
            labels: FirstLabels {
                node: 1 + counts[0],
                element: 1 + one.mesh.mesh.element_count() as u32,
            },
        },
    ];
    for (gear, n) in impact.gears.iter().zip(&numbered) {
        let nodes: Vec<Vec3> = (gear.mesh.mesh.nodes.iter())
            .map(|x| gear.placed(*x))
            .collect();
        n.mesh(out, &nodes)?;
    }
    let mut free: Vec<(usize, u32, f64)> = Vec::new();
    for (i, gear) in impact.gears.iter().enumerate() {
        if let Hub::Free { speed } = gear.hub {
            let reference = 1 + counts[0] + counts[1] + 2 * free.len() as u32;
            free.push((i, reference, speed));
        }
    }
    for (set, second) in [("refs", 0), ("rots", 1)] {
        writeln!(out, "*NODE, NSET={set}")?;
        for &(i, reference, _) in &free {
            let c = impact.gears[i].centre;
            let label = reference + second;
            let [x, y, z] = [c.x, c.y, c.z].map(|v| position(v, label));
            writeln!(out, "{label}, {}, {}, {}", x?, y?, z?)?;
        }
    }
    for &(i, reference, _) in &free {
        let rotation = reference + 1;
        writeln!(
            out,
            "*RIGID BODY, NSET=bore{}, REF NODE={reference}, ROT NODE={rotation}",
            i + 1
        )?;
    }
    // A tilted hub turns about the third of axes of its own: its conditions and prints are in them, initial speeds are not.
    for &(i, reference, _) in &free {
        let axis = impact.gears[i].axis;
        if axis != Vec3::z() {
            let rotation = reference + 1;
            writeln!(out, "*NSET, NSET=tilted{}\n{rotation}", i + 1)?;
            writeln!(out, "*TRANSFORM, NSET=tilted{}, TYPE=R", i + 1)?;
            let [e, f] = across(axis);
            let axes = [e.x, e.y, e.z, f.x, f.y, f.z].map(|v| position(v, rotation));
            let axes = axes.into_iter().collect::<Result<Vec<_>, _>>()?;
            writeln!(out, "{}", axes.join(", "))?;
        }
    }
    materials(out, &[one.material, two.material], &["gear1", "gear2"])?;
    writeln!(
        out,
        "*SURFACE INTERACTION, NAME=SI\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{}",
        number(impact.penalty, "the penalty")?
    )?;
    let pairs: Vec<[String; 2]> = impact
        .pairs
        .iter()
        .map(|p| [0, 1].map(|i| format!("sflank{}_{}{}", i + 1, p[i] + 1, letter(impact.side))))
        .collect();
    for [slave, master] in &pairs {
        writeln!(
            out,
            "*CONTACT PAIR, INTERACTION=SI, TYPE=SURFACE TO SURFACE\n{slave}, {master}"
        )?;
    }
    writeln!(out, "*BOUNDARY")?;
    for i in 0..2 {
        match free.iter().find(|f| f.0 == i) {
            Some((_, reference, _)) => {
                writeln!(out, "{reference}, 1, 3\n{}, 1, 2", reference + 1)?;
            }
            None => writeln!(out, "bore{}, 1, 3", i + 1)?,
        }
    }
    if free.iter().any(|f| f.2 != 0.0) {
        writeln!(out, "*INITIAL CONDITIONS, TYPE=VELOCITY")?;
    }
    for &(i, reference, speed) in free.iter().filter(|f| f.2 != 0.0) {
        let gear = &impact.gears[i];
        for (label, &x) in (numbered[i].labels.node..).zip(&gear.mesh.mesh.nodes) {
            let velocity = speed * gear.axis.cross(&(gear.placed(x) - gear.centre));
            let directions = if gear.axis == Vec3::z() { 2 } else { 3 };
            for (k, v) in (1..=directions).zip(&velocity) {
                writeln!(out, "{label}, {k}, {v:.12e}")?;
            }
        }
        let turning = speed * gear.axis;
        for (k, w) in (1..).zip(&turning).filter(|(_, w)| **w != 0.0) {
            writeln!(out, "{}, {k}, {}", reference + 1, number(*w, "the speed")?)?;
        }
    }
    impact.steps(out, &pairs, !free.is_empty())?;
    Ok(())
}

impl Impact<'_> {
    fn check(&self) -> Result<(), WriteError> {
        let range = |what, value: f64, fits: bool, range| match fits {
            true => Ok(()),
            false => Err(WriteError::Range { what, value, range }),
        };
        let positive = |x: f64| x > 0.0 && x.is_finite();
        range(
            "the penalty [Pa/m]",
            self.penalty,
            positive(self.penalty),
            "above 0",
        )?;
        range("the step [s]", self.step, positive(self.step), "above 0")?;
        let end = self.end >= self.step && self.end.is_finite();
        range("the end [s]", self.end, end, "at least one step")?;
        let alpha = (-1.0 / 3.0..=0.0).contains(&self.alpha);
        range("alpha", self.alpha, alpha, "between -1/3 and 0")?;
        for pair in &self.pairs {
            for (i, gear) in self.gears.iter().enumerate() {
                let flanks = &gear.mesh.flanks;
                let name = |tooth: u32, side| format!("{}{}", tooth + 1, letter(side));
                if !flanks
                    .iter()
                    .any(|f| (f.tooth, f.side) == (pair[i], self.side))
                {
                    let known: Vec<String> = flanks.iter().map(|f| name(f.tooth, f.side)).collect();
                    return Err(WriteError::NoFlank {
                        gear: i + 1,
                        flank: name(pair[i], self.side),
                        known: match known.is_empty() {
                            true => "none".into(),
                            false => known.join(", "),
                        },
                    });
                }
            }
        }
        Ok(())
    }

    fn steps(&self, out: &mut dyn Write, pairs: &[[String; 2]], hubs: bool) -> io::Result<()> {
        writeln!(out, "*STEP, NLGEOM, INC=1000000")?;
        writeln!(
            out,
            "*DYNAMIC, DIRECT, ALPHA={}, SOLVER=SPOOLES\n{:e}, {:e}",
            self.alpha, self.step, self.end
        )?;
        if hubs {
            writeln!(
                out,
                "*NODE PRINT, NSET=rots\nU, V\n*NODE PRINT, NSET=refs\nRF"
            )?;
        }
        for [slave, master] in pairs {
            writeln!(out, "*CONTACT PRINT, SLAVE={slave}, MASTER={master}\nCF")?;
        }
        for i in 1..=2 {
            writeln!(out, "*EL PRINT, ELSET=gear{i}, TOTALS=ONLY\nELSE, ELKE")?;
        }
        writeln!(out, "*NODE FILE\nV\n*END STEP")
    }
}

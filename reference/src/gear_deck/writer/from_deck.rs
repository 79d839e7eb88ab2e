//! The impact that a deck describes, so that it can be computed here or written again.

use super::{Hub, Impact, ImpactGear};
use crate::deck::{ContactKind, Deck, DeckError, DeckErrorKind, Procedure, Target};
use crate::gear_deck::gears::DeckGear;
use crate::gear_mesh::flank_set;
use crate::mesh::Face;
use gearbench_models::Vec3;
use gearbench_models::geometry::Side;

impl<'a> Impact<'a> {
    /// Builds the impact of a deck with two gears, their contact pairs and one implicit dynamic step.
    pub fn of(deck: &Deck, gears: &'a [DeckGear]) -> Result<Self, DeckError> {
        let decline = |expected: &str, found: String, help: &str| {
            DeckError::new(DeckErrorKind::Gear, "an impact", expected, found, help)
                .at(&deck.name, 0)
        };
        let [one, two] = gears else {
            let found = gears.len().to_string();
            return Err(decline("two gears", found, "one deck contains both gears"));
        };
        let (step, end, alpha) = match deck.steps.as_slice() {
            [step] => match step.procedure {
                Procedure::Dynamic {
                    direct: true,
                    explicit: false,
                    alpha,
                    times: Some([step, end]),
                } => (step, end, alpha.unwrap_or(-0.05)),
                _ => {
                    return Err(step.place.error(
                        DeckErrorKind::Gear,
                        "an impact",
                        "*DYNAMIC, DIRECT with a step and an end",
                        "another procedure",
                        "fixed implicit steps",
                    ));
                }
            },
            steps => {
                let found = format!("{} steps", steps.len());
                return Err(decline("one step", found, "remove the others"));
            }
        };
        let mut pairs = Vec::new();
        let (mut side, mut penalty) = (None, None);
        for pair in &deck.contact_pairs {
            let wrong = |expected: &str, found: String| {
                pair.place
                    .error(DeckErrorKind::Gear, "*CONTACT PAIR", expected, found, "")
            };
            let of = |gear: &DeckGear, surface: &str| {
                flank_of(gear, &deck.surfaces[surface])
                    .ok_or_else(|| wrong("a whole flank", format!("surface `{surface}`")))
            };
            let (a, b) = (of(one, &pair.slave)?, of(two, &pair.master)?);
            if a.1 != b.1 || *side.get_or_insert(a.1) != a.1 {
                return Err(wrong("flanks of one side", "both sides".into()));
            }
            if pair.kind == ContactKind::Other {
                let expected = "TYPE=SURFACE TO SURFACE or NODE TO SURFACE";
                return Err(wrong(expected, "another type or no type".into()));
            }
            let interaction = &deck.interactions[&pair.interaction];
            if let Some(more) = interaction.more.first() {
                return Err(wrong("a linear penalty only", more.clone()));
            }
            let stiffness = interaction.stiffness;
            let Some(k) = stiffness else {
                return Err(wrong("a *SURFACE BEHAVIOR", "none".into()));
            };
            if *penalty.get_or_insert(k) != k {
                return Err(wrong("one penalty for all pairs", k.to_string()));
            }
            pairs.push([a.0, b.0]);
        }
        let (Some(side), Some(penalty)) = (side, penalty) else {
            return Err(decline(
                "contact pairs",
                "none".into(),
                "name the flanks of the contact pairs",
            ));
        };
        let hub = |gear: &DeckGear| {
            let Some(body) = gear.rigid_body.map(|b| &deck.rigid_bodies[b]) else {
                return Hub::Clamped;
            };
            // Components along the deck's own axes, whatever axes conditions are in; the last of each counts.
            let mut speed = Vec3::zeros();
            for v in &deck.initial_velocities {
                let turns = matches!(v.target, Target::Node(n) if Some(n) == body.rotation);
                if let (true, k @ 1..=3) = (turns, v.direction) {
                    speed[usize::from(k) - 1] = v.value;
                }
            }
            Hub::Free {
                speed: speed.dot(&gear.axis),
            }
        };
        Ok(Impact {
            title: deck.heading.join("\n"),
            gears: [one, two].map(|g| ImpactGear::new(g, hub(g))),
            side,
            pairs,
            penalty,
            step,
            end,
            alpha,
        })
    }
}

/// Tooth and side of the flank that a surface is.
fn flank_of(gear: &DeckGear, surface: &[Face]) -> Option<(u32, Side)> {
    let mut wanted = surface.to_vec();
    wanted.sort_unstable();
    gear.mesh.flanks.iter().find_map(|f| {
        let name = format!("s{}", flank_set(f.tooth, f.side));
        let mut faces: Vec<Face> = gear
            .mesh
            .mesh
            .face_sets
            .get(&name)?
            .iter()
            .map(|face| Face {
                element: gear.elements[face.element as usize],
                face: face.face,
            })
            .collect();
        faces.sort_unstable();
        (faces == wanted).then_some((f.tooth, f.side))
    })
}

//! Is a deck fit for the preprocessing of elastic gears that the GTM tool set laid down (Institute of
//! Engineering and Computational Mechanics, University of Stuttgart, 2014)?
//!
//! Its requirements: one gear per input file; z is the axis; linear elastic, homogeneous material; units m, kg,
//! s; hexahedra only; one node set per flank, `flank_1l` and so on, and the set `bore`; the origin is where the
//! gear is coupled; a structured mesh on the flanks. [`read`](crate::deck::read()) itself needs less: decks with
//! several gears are read and split by [`gears`].

use super::gears::{BodyShape, DeckGear, bodies_of, bore_axis, flank_name, gears, is_bore_name};
use crate::deck::{Deck, DeckErrorKind, ElementBlock, Place};
use crate::gear_mesh::flank_set;
use crate::mesh::Shape;
use gearbench_models::geometry::Side;
use std::fmt;

/// A requirement of [`check_gtm`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[expect(missing_docs, reason = "`text` says them in words")]
pub enum GtmRequirement {
    OneGear,
    AxisZ,
    Origin,
    Units,
    Hexahedra,
    Material,
    Bore,
    Flanks,
    Structured,
}

impl GtmRequirement {
    /// The requirement in words.
    pub fn text(self) -> &'static str {
        match self {
            Self::OneGear => "one gear per deck",
            Self::AxisZ => "z is the axis of rotation",
            Self::Origin => "the origin is on the axis, in the middle of the width",
            Self::Units => "SI units: m, kg, s, so Pa and kg/m^3",
            Self::Hexahedra => "hexahedra only",
            Self::Material => "one linear elastic, homogeneous material with density",
            Self::Bore => "a node set `bore`",
            Self::Flanks => "one node set per flank, `flank_1l`, `flank_1r` and so on",
            Self::Structured => "a structured mesh on the flanks",
        }
    }
}

/// A requirement of the GTM preprocessing that a deck does not meet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// Requirement that is not met.
    pub requirement: GtmRequirement,
    /// Position of the problem, if it has one.
    pub place: Option<Place>,
    /// Actual content.
    pub found: String,
    /// Remedy of the problem.
    pub way_out: String,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(p) = &self.place {
            write!(f, "{}:{}: ", p.file, p.line)?;
        }
        let required = self.requirement.text();
        write!(f, "{required}: found {}; {}", self.found, self.way_out)
    }
}

/// Checks a deck against the requirements of the GTM preprocessing; the list is empty for a deck that meets them all.
pub fn check_gtm(deck: &Deck) -> Vec<Finding> {
    let mut check = Check {
        deck,
        findings: Vec::new(),
    };
    if deck.element_count() == 0 {
        check.find(
            GtmRequirement::Hexahedra,
            None,
            "no elements".into(),
            "mesh the gear with C3D8, C3D8I, C3D20 or C3D20R",
        );
        return check.findings;
    }
    let bodies = bodies_of(deck);
    if bodies != 1 {
        check.find(
            GtmRequirement::OneGear,
            None,
            format!("{bodies} bodies that share no nodes"),
            "write each gear to its own deck, or connect parts that should share nodes",
        );
    }
    check.units();
    check.kinds();
    let axis = check.bore();
    check.flank_names(bodies == 1);
    // Without a bore about z there are no teeth to count and no flanks to lay out.
    if axis {
        match gears(deck) {
            Ok(gears) => gears.iter().for_each(|g| check.gear(g)),
            Err(e) => {
                let requirement = match e.kind {
                    DeckErrorKind::Grid => GtmRequirement::Structured,
                    DeckErrorKind::Material => GtmRequirement::Material,
                    _ => GtmRequirement::Flanks,
                };
                let place = deck
                    .defined
                    .values()
                    .find(|p| p.line == e.line && *p.file == *e.file)
                    .cloned();
                let found = format!("{} instead of {}", e.found, e.expected);
                let found = match e.context.is_empty() {
                    true => found,
                    false => format!("{}: {found}", e.context),
                };
                check.find(requirement, place, found, &e.help);
            }
        }
    }
    check.findings
}

struct Check<'a> {
    deck: &'a Deck,
    findings: Vec<Finding>,
}

impl Check<'_> {
    fn find(
        &mut self,
        requirement: GtmRequirement,
        place: Option<Place>,
        found: String,
        way_out: &str,
    ) {
        self.findings.push(Finding {
            requirement,
            place,
            found,
            way_out: way_out.to_owned(),
        });
    }

    /// Elements that are no hexahedra.
    fn kinds(&mut self) {
        let other = |b: &&ElementBlock| b.kind.shape() != Shape::Hexahedron;
        if let Some(block) = self.deck.blocks.iter().find(other) {
            self.find(
                GtmRequirement::Hexahedra,
                Some(block.place.clone()),
                block.kind.name().to_owned(),
                "gearbench reads these elements; programs that build on structured gear meshes need C3D8, C3D8I, C3D20 or C3D20R",
            );
        }
    }

    /// Sizes and materials that no gear in SI units has.
    fn units(&mut self) {
        if self.deck.units != crate::deck::Units::SI {
            self.find(
                GtmRequirement::Units,
                None,
                format!("{} ({})", self.deck.units.name, self.deck.units_from),
                "no change is needed for gearbench, which converts units; other programs require m-kg-s",
            );
        }
        let used = self.deck.blocks.iter().flat_map(|b| &b.connectivity);
        let (mut low, mut high) = ([f64::MAX; 3], [f64::MIN; 3]);
        for &n in used {
            let x = self.deck.nodes[n as usize];
            for k in 0..3 {
                low[k] = low[k].min(x[k]);
                high[k] = high[k].max(x[k]);
            }
        }
        let size = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
        if size > 10.0 {
            self.find(
                GtmRequirement::Units,
                None,
                format!("a model {size:.4} units large, which looks like millimetres"),
                "divide all coordinates by 1000",
            );
        } else if size < 1e-4 {
            self.find(
                GtmRequirement::Units,
                None,
                format!("a model {size:.3e} units large, too small for metres"),
                "give coordinates in metres",
            );
        }
        for (name, m) in &self.deck.materials {
            let place = || Some(m.place.clone());
            match m.elastic {
                Some((e, _)) if (1e3..1e7).contains(&e) => self.find(
                    GtmRequirement::Units,
                    place(),
                    format!("E = {e:e} of material `{name}`, which looks like MPa"),
                    "multiply E by 1e6 to have Pa, together with coordinates in metres",
                ),
                Some((e, _)) if !(1e8..=2e12).contains(&e) => self.find(
                    GtmRequirement::Units,
                    place(),
                    format!(
                        "E = {e:e} of material `{name}`, outside the range of gear materials in Pa"
                    ),
                    "give E in Pa, steel has 2.1e11",
                ),
                _ => {}
            }
            let unit = match m.density {
                Some(d) if (500.0..=25_000.0).contains(&d) => continue,
                Some(d) if (5e-10..=2.5e-8).contains(&d) => "t/mm^3: multiply by 1e12",
                Some(d) if (5e-7..=2.5e-5).contains(&d) => "kg/mm^3: multiply by 1e9",
                Some(d) if (0.5..=25.0).contains(&d) => "g/cm^3: multiply by 1000",
                Some(_) => "no known unit",
                None => continue,
            };
            self.find(
                GtmRequirement::Units,
                place(),
                format!(
                    "density {:e} of material `{name}`, which looks like {unit}",
                    m.density.unwrap_or(0.0)
                ),
                "give the density in kg/m^3, steel has 7850",
            );
        }
    }

    /// The bore's name and axis; true when it is a circle about z or a plane along it.
    fn bore(&mut self) -> bool {
        let deck = self.deck;
        let bores: Vec<&String> = deck.node_sets.keys().filter(|n| is_bore_name(n)).collect();
        if bores.is_empty() {
            self.find(
                GtmRequirement::Bore,
                None,
                "none".into(),
                "put the nodes of the bore into the node set `bore`",
            );
            return false;
        }
        let mut along_z = true;
        for name in bores {
            let place = deck.defined.get(name).cloned();
            if name != "bore" {
                self.find(
                    GtmRequirement::Bore,
                    place.clone(),
                    format!("`{name}`"),
                    "name it `bore`",
                );
            }
            match bore_axis(deck, name) {
                Some('z') => {}
                Some(axis) => {
                    along_z = false;
                    self.find(
                        GtmRequirement::AxisZ,
                        place,
                        format!("set `{name}` on a circle about {axis}"),
                        "turn the model so that its axis is z",
                    );
                }
                None => {
                    along_z = false;
                    self.find(
                        GtmRequirement::AxisZ,
                        place,
                        format!("set `{name}` on no circle about a coordinate axis"),
                        "turn the model, and put all nodes of the bore, and no others, into the set",
                    );
                }
            }
        }
        along_z
    }

    fn flank_names(&mut self, one: bool) {
        let deck = self.deck;
        let named = deck.node_sets.keys();
        let flanks: Vec<&String> = named.filter(|n| flank_name(n).is_some()).collect();
        if flanks.is_empty() {
            self.find(
                GtmRequirement::Flanks,
                None,
                "none".into(),
                "put the nodes of each flank into its own node set",
            );
        }
        if let Some(name) = flanks.iter().find(|n| one && !n.starts_with("flank_")) {
            self.find(
                GtmRequirement::Flanks,
                deck.defined.get(*name).cloned(),
                format!("`{name}`"),
                "leave out the number of the gear, as in `flank_1l`",
            );
        }
    }

    fn gear(&mut self, g: &DeckGear) {
        let deck = self.deck;
        if g.shape == BodyShape::Gear && g.centre.norm() > 0.0 {
            self.find(
                GtmRequirement::Origin,
                None,
                format!(
                    "the middle of gear `{}` at ({:.6e}, {:.6e}, {:.6e})",
                    g.name, g.centre.x, g.centre.y, g.centre.z
                ),
                "move the model so that the middle of the gear is at the origin",
            );
        }
        let has = |tooth: u32, side: Side| {
            let flanks = &g.mesh.flanks;
            flanks.iter().any(|f| f.tooth == tooth && f.side == side)
        };
        let missing: Vec<String> = (0..g.mesh.teeth)
            .flat_map(|t| Side::BOTH.map(|side| (t, side)))
            .filter(|&(t, side)| !has(t, side))
            .map(|(t, side)| flank_set(t, side))
            .collect();
        if !missing.is_empty() && !g.mesh.flanks.is_empty() {
            let shown = missing[..missing.len().min(4)].join(", ");
            let more = if missing.len() > 4 { ", ..." } else { "" };
            self.find(
                GtmRequirement::Flanks,
                None,
                format!(
                    "{} of {} flanks of gear `{}` without a set ({shown}{more})",
                    missing.len(),
                    2 * g.mesh.teeth,
                    g.name
                ),
                "define a set for each flank; flanks without a set have no contact",
            );
        }
        // Teeth of a rack have no first one that all agree on.
        let numbered = g.mesh.flanks.iter().filter(|_| g.shape == BodyShape::Gear);
        for f in numbered {
            let label = i64::from(f.tooth) + 1;
            let Some(&node) = f.nodes.first() else {
                continue;
            };
            let deck_node = g.nodes[node as usize];
            let named = deck.node_sets.iter().find(|(name, nodes)| {
                flank_name(name).is_some_and(|n| n.1 == f.side) && nodes.contains(&deck_node)
            });
            if let Some((name, _)) = named.filter(|n| flank_name(n.0) != Some((label, f.side))) {
                self.find(
                    GtmRequirement::Flanks,
                    deck.defined.get(name).cloned(),
                    format!("`{name}` on the tooth with number {label}"),
                    &format!(
                        "number the teeth counter-clockwise, seen against +z: this is `{}`",
                        flank_set(f.tooth, f.side)
                    ),
                );
                return; // one finding says it for all teeth
            }
        }
    }
}

#[cfg(test)]
mod tests;

//! Units of a deck, determined from its material or its size, and the conversion to SI units.
//!
//! Decks do not state units. `sqrt(E / rho)` is a speed, so that it determines the ratio of length to time: for solids
//! 500 to 15,000 m/s. The density then determines the mass: for solids 500 to 25,000 kg/m^3. Both ranges span less
//! than the factors between the systems below, so that at most one of them fits. With the modulus alone, or only a
//! size, the system is a guess, and reported as such.

use super::data::{Deck, Target};
use std::collections::HashSet;

/// A system of units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units {
    /// Name of the system of units, such as `mm-t-s`.
    pub name: &'static str,
    /// Unit of length [m].
    pub length: f64,
    /// Unit of mass [kg].
    pub mass: f64,
    /// Unit of time [s].
    pub time: f64,
}

impl Default for Units {
    fn default() -> Self {
        Units::SI
    }
}

impl Units {
    /// Metre, kilogram, second: Pa, kg/m^3.
    pub const SI: Units = Units {
        name: "m-kg-s",
        length: 1.0,
        mass: 1.0,
        time: 1.0,
    };

    /// All systems of units that are distinguished.
    pub const ALL: [Units; 5] = [
        Units::SI,
        // MPa, t/mm^3.
        Units {
            name: "mm-t-s",
            length: 1e-3,
            mass: 1e3,
            time: 1.0,
        },
        // kPa, kg/mm^3.
        Units {
            name: "mm-kg-s",
            length: 1e-3,
            mass: 1.0,
            time: 1.0,
        },
        // GPa, kg/mm^3.
        Units {
            name: "mm-kg-ms",
            length: 1e-3,
            mass: 1.0,
            time: 1e-3,
        },
        // MPa, g/mm^3.
        Units {
            name: "mm-g-ms",
            length: 1e-3,
            mass: 1e-3,
            time: 1e-3,
        },
    ];

    /// Finds a system by its name, whatever the case.
    pub fn from_name(name: &str) -> Option<Units> {
        let mut all = Self::ALL.into_iter();
        all.find(|u| u.name.eq_ignore_ascii_case(name))
    }

    /// Unit of pressure [Pa].
    fn pressure(&self) -> f64 {
        self.mass / (self.length * self.time * self.time)
    }

    /// Unit of density [kg/m^3].
    fn density(&self) -> f64 {
        self.mass / self.length.powi(3)
    }
}

/// Moduli of solids [Pa].
const MODULI: std::ops::Range<f64> = 1e8..2e12;
/// Speeds `sqrt(E / rho)` of solids [m/s].
const SPEEDS: std::ops::Range<f64> = 500.0..15e3;
/// Densities of solids [kg/m^3].
const DENSITIES: std::ops::Range<f64> = 500.0..25e3;
/// Greatest extent [m] of a body of unknown units: above it the numbers count as millimetres.
const GREATEST: f64 = 3.0;

/// Start of the reason where only one system of units fits.
const CERTAIN: &str = "from ";

/// Converts the deck to SI units, from given or determined units.
pub(super) fn in_si(mut deck: Deck, units: Option<Units>) -> Deck {
    let found = found(&deck);
    let (units, from) = match units {
        // A guess is no contradiction.
        Some(given) if given != found.0 && found.1.starts_with(CERTAIN) => {
            let Units { name, .. } = found.0;
            (
                given,
                format!(
                    "as given, although {name} corresponds to {}",
                    &found.1[CERTAIN.len()..]
                ),
            )
        }
        Some(given) => (given, "as given".to_owned()),
        None => found,
    };
    deck.units_from = from;
    convert(&mut deck, units);
    deck
}

/// Units of a deck as it was written, with the reason in words.
fn found(deck: &Deck) -> (Units, String) {
    let mut unfit = None;
    for (name, m) in &deck.materials {
        let young = m.elastic.map(|(e, _)| e);
        let fits = |u: &Units| {
            let density = m
                .density
                .is_none_or(|d| DENSITIES.contains(&(d * u.density())));
            let modulus = young.is_none_or(|e| MODULI.contains(&(e * u.pressure())));
            let speed = match (young, m.density) {
                (Some(e), Some(d)) => SPEEDS.contains(&((e / d).sqrt() * u.length / u.time)),
                _ => true,
            };
            density && modulus && speed
        };
        let mut fitting = Units::ALL.into_iter().filter(fits);
        let what = match (young, m.density) {
            (Some(e), Some(d)) => format!("E = {e:e} and density {d:e} of material `{name}`"),
            (Some(e), None) => format!("E = {e:e} of material `{name}`"),
            (None, Some(d)) => format!("density {d:e} of material `{name}`"),
            (None, None) => continue,
        };
        match (fitting.next(), fitting.next()) {
            (Some(one), None) => return (one, format!("{CERTAIN}{what}")),
            (Some(one), Some(other)) => {
                let guess = format!(
                    "an assumption from {what}, which also corresponds to {}; give the units if it is wrong",
                    other.name
                );
                return (one, guess);
            }
            (None, _) => unfit = unfit.or(Some(what)),
        }
    }
    if let Some(what) = unfit {
        let reason = format!(
            "an assumption, since no known units correspond to {what}; give the units if it is wrong"
        );
        return (Units::SI, reason);
    }
    let (mut low, mut high) = ([f64::MAX; 3], [f64::MIN; 3]);
    for &n in deck.blocks.iter().flat_map(|b| &b.connectivity) {
        let x = deck.nodes[n as usize];
        for k in 0..3 {
            low[k] = low[k].min(x[k]);
            high[k] = high[k].max(x[k]);
        }
    }
    let size = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
    let units = if size > GREATEST {
        Units::ALL[1]
    } else {
        Units::SI
    };
    let unit = if size > GREATEST { "mm" } else { "m" };
    let reason = format!(
        "an assumption, since there is no material: the size of {size:.4} is read as {unit}; give the units if it is wrong"
    );
    (units, reason)
}

/// Converts all quantities of a deck to SI units.
fn convert(deck: &mut Deck, units: Units) {
    deck.units = units;
    if units == Units::SI {
        return;
    }
    for x in &mut deck.nodes {
        *x *= units.length;
    }
    for m in deck.materials.values_mut() {
        if let Some((young, _)) = &mut m.elastic {
            *young *= units.pressure();
        }
        if let Some(density) = &mut m.density {
            *density *= units.density();
        }
    }
    for i in deck.interactions.values_mut() {
        if let Some(k) = &mut i.stiffness {
            *k *= units.pressure() / units.length;
        }
    }
    // Rotations have no length.
    let turns: HashSet<u32> = deck
        .rigid_bodies
        .iter()
        .filter_map(|r| r.rotation)
        .collect();
    let length = |target: &Target| match target {
        Target::Node(n) if turns.contains(n) => 1.0,
        _ => units.length,
    };
    let steps = deck.steps.iter_mut().flat_map(|s| &mut s.boundaries);
    for b in deck.boundaries.iter_mut().chain(steps) {
        b.value *= length(&b.target);
    }
    for v in &mut deck.initial_velocities {
        v.value *= length(&v.target) / units.time;
    }
    for step in &mut deck.steps {
        step.procedure.scale_times(units.time);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::parsed;
    use crate::{self as deck, Procedure};

    const BRICK: &str = "*NODE, NSET=all\n1,0,0,0\n2,20,0,0\n3,20,20,0\n4,0,20,0\n5,0,0,20\n6,20,0,20\n7,20,20,20\n8,0,20,20\n\
        *NODE, NSET=ref\n9\n10\n*ELEMENT, TYPE=C3D8, ELSET=e\n1,1,2,3,4,5,6,7,8\n";

    fn with_material(young: &str, density: &str) -> Deck {
        parsed(
            "a.inp",
            &format!(
                "{BRICK}*MATERIAL, NAME=m\n*ELASTIC\n{young}, .3\n*DENSITY\n{density}\n*SOLID SECTION, ELSET=e, MATERIAL=m\n"
            ),
        )
    }

    #[test]
    fn steel_and_nylon_are_the_same_in_all_units() {
        for u in Units::ALL {
            for (young, density) in [
                (2.1e11, 7850.0),
                (2.5e9, 1140.0),
                (7e10, 2700.0),
                (1.1e11, 19300.0),
            ] {
                let (e, d) = (young / u.pressure(), density / u.density());
                let deck = with_material(&format!("{e:e}"), &format!("{d:e}"));
                assert_eq!(deck.units.name, u.name, "{}", deck.units_from);
                let m = deck.material("m").unwrap();
                assert!((m.young / young - 1.0).abs() < 1e-12);
                assert!((m.density / density - 1.0).abs() < 1e-12);
                assert!((deck.nodes[1].x - 20.0 * u.length).abs() < 1e-15);
                assert!(deck.units_from.starts_with("from E = "));
            }
        }
    }

    #[test]
    fn guesses_are_told_as_such_and_can_be_overridden() {
        let guess = parsed("a.inp", BRICK);
        assert_eq!(guess.units.name, "mm-t-s");
        assert!(
            guess.told()[0]
                .contains("an assumption, since there is no material: the size of 20.0000 is read")
        );
        let given =
            deck::read_str_in("a.inp", BRICK, Some(Units::SI), &mut |_| unreachable!()).unwrap();
        assert_eq!((given.units, given.nodes[1].x), (Units::SI, 20.0));
        assert_eq!(given.units_from, "as given");
        // A conflict between the given units and those of the material is reported.
        let steel = "*MATERIAL, NAME=m\n*ELASTIC\n2.1e5, .3\n*DENSITY\n7.85e-9\n";
        let text = format!("{BRICK}{steel}");
        let against =
            deck::read_str_in("a.inp", &text, Some(Units::SI), &mut |_| unreachable!()).unwrap();
        let said = &against.units_from;
        assert_eq!(against.units, Units::SI);
        assert!(
            said.starts_with("as given, although mm-t-s corresponds to E = 2.1e5"),
            "{said}"
        );
        // Mixed units fit nothing.
        let mixed = with_material("2.1e5", "7850");
        assert_eq!(mixed.units, Units::SI);
        assert!(
            mixed.units_from.contains("no known units correspond"),
            "{}",
            mixed.units_from
        );
        let alone = parsed(
            "a.inp",
            &format!("{BRICK}*MATERIAL, NAME=m\n*ELASTIC\n2.1e8, .3\n"),
        );
        assert!(
            alone.units_from.contains("also corresponds to mm-kg-s"),
            "{}",
            alone.units_from
        );
    }

    #[test]
    fn times_speeds_and_penalties_are_converted() {
        let text = format!(
            "{BRICK}*RIGID BODY, NSET=all, REF NODE=9, ROT NODE=10\n\
             *SURFACE INTERACTION, NAME=i\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1e6\n\
             *INITIAL CONDITIONS, TYPE=VELOCITY\nall, 1, 2000\n10, 3, 5\n\
             *STEP\n*DYNAMIC, DIRECT\n1e-6, 1e-3\n*BOUNDARY\n9, 1, 1, 4\n10, 1, 1, 4\n*END STEP\n"
        );
        let units = Units::from_name("MM-KG-MS");
        let deck = deck::read_str_in("a.inp", &text, units, &mut |_| unreachable!()).unwrap();
        assert_eq!(
            deck.interactions["i"]
                .stiffness
                .map(|k| (k * 1e-18).round()),
            Some(1.0)
        );
        assert_eq!(deck.initial_velocities[0].value, 2000.0);
        assert_eq!(deck.initial_velocities[1].value, 5000.0);
        let [a, b] = deck.steps[0].boundaries.as_slice() else {
            panic!()
        };
        assert_eq!((a.value, b.value), (4e-3, 4.0));
        let Procedure::Dynamic {
            times: Some([step, end]),
            ..
        } = deck.steps[0].procedure
        else {
            panic!()
        };
        assert!((step - 1e-9).abs() < 1e-20 && (end - 1e-6).abs() < 1e-17);
    }
}

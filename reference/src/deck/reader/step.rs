//! Steps: the procedures that the references use; output requests are recognised and passed over.

use super::model::field;
use super::{OpenStep, Reader, at_most, number, options, whole};
use crate::deck::data::{Procedure, Step};
use crate::deck::error::{DeckError, quote};
use crate::deck::lexer::{Data, Keyword};

/// Keywords that only ask for output: they change no model.
pub(super) const REQUESTS: [&str; 15] = [
    "NODEPRINT",
    "NODEFILE",
    "NODEOUTPUT",
    "ELPRINT",
    "ELFILE",
    "ELEMENTOUTPUT",
    "FACEPRINT",
    "SECTIONPRINT",
    "CONTACTPRINT",
    "CONTACTFILE",
    "CONTACTOUTPUT",
    "OUTPUT",
    "ENERGYOUTPUT",
    "PRINT",
    "MONITOR",
];

impl Reader<'_> {
    pub(super) fn begin_step(&mut self, k: &Keyword) -> Result<(), DeckError> {
        self.outside_step(k)?;
        let [nlgeom, increments, perturbation] =
            options(k, ["NLGEOM", "INC", "PERTURBATION"], &["NAME"])?;
        let nlgeom = match nlgeom {
            None => false,
            Some(v) if v.is_empty() || v.eq_ignore_ascii_case("YES") => true,
            Some(v) if v.eq_ignore_ascii_case("NO") => false,
            Some(v) => {
                return Err(k.syntax("NLGEOM, NLGEOM=YES or NLGEOM=NO", quote(v), ""));
            }
        };
        if perturbation.is_some() && !self.deck.steps.is_empty() {
            return Err(k.unsupported(
                "a perturbation of the undeformed state, in the first step",
                "one after another step",
                "",
            ));
        }
        let increments = increments
            .map(|text| whole(k, &as_data(k, text), text, "a number of increments"))
            .transpose()?;
        self.step = Some(OpenStep {
            step: Step {
                nlgeom,
                increments,
                procedure: Procedure::Frequency { modes: 0 },
                boundaries: Vec::new(),
                requests: Vec::new(),
                place: k.place.clone(),
            },
            procedure: false,
        });
        // Abaqus allows a subtitle under *STEP.
        while self.lexer.data()?.is_some() {}
        Ok(())
    }

    pub(super) fn end_step(&mut self, k: &Keyword) -> Result<(), DeckError> {
        options(k, [], &[])?;
        match self.step.take() {
            Some(open) if open.procedure => {
                self.deck.steps.push(open.step);
                Ok(())
            }
            Some(_) => Err(k.syntax(
                "*STATIC, *DYNAMIC or *FREQUENCY in the step",
                "none of them",
                "",
            )),
            None => Err(outside(k)),
        }
    }

    fn procedure(&mut self, k: &Keyword, procedure: Procedure) -> Result<(), DeckError> {
        match &mut self.step {
            Some(open) if !open.procedure => {
                open.step.procedure = procedure;
                open.procedure = true;
                Ok(())
            }
            Some(_) => Err(k.syntax(
                "one procedure in a step",
                "a second one",
                "open a further step",
            )),
            None => Err(outside(k)),
        }
    }

    /// Increment and period, in a line that may be left out; further values bound adaptive increments.
    fn times(&mut self, k: &Keyword) -> Result<Option<[f64; 2]>, DeckError> {
        let Some(data) = self.lexer.data()? else {
            return Ok(None);
        };
        at_most(k, &data, 5)?;
        let mut times = [1.0; 2];
        for (i, text) in data.fields.iter().enumerate() {
            let value = if text.is_empty() {
                1.0
            } else {
                number(k, &data, text)?
            };
            if value <= 0.0 && i < 2 {
                return Err(data.syntax(k, "an increment and a period above 0", quote(text), ""));
            }
            if i < 2 {
                times[i] = value;
            }
        }
        Ok(Some(times))
    }

    pub(super) fn static_(&mut self, k: &Keyword) -> Result<(), DeckError> {
        let [direct] = options(k, ["DIRECT"], &["SOLVER"])?;
        let times = self.times(k)?;
        let direct = direct.is_some();
        self.procedure(k, Procedure::Static { direct, times })
    }

    pub(super) fn dynamic(&mut self, k: &Keyword) -> Result<(), DeckError> {
        let [direct, explicit, alpha] = options(k, ["DIRECT", "EXPLICIT", "ALPHA"], &["SOLVER"])?;
        let alpha = alpha
            .map(|text| number(k, &as_data(k, text), text))
            .transpose()?;
        if let Some(alpha) = alpha.filter(|a| !(-1.0 / 3.0..=0.0).contains(a)) {
            return Err(k.syntax("an alpha between -1/3 and 0", alpha.to_string(), ""));
        }
        let times = self.times(k)?;
        let procedure = Procedure::Dynamic {
            direct: direct.is_some(),
            explicit: explicit.is_some(),
            alpha,
            times,
        };
        self.procedure(k, procedure)
    }

    pub(super) fn frequency(&mut self, k: &Keyword) -> Result<(), DeckError> {
        options(k, [], &["SOLVER", "STORAGE"])?;
        let data = self.need_data(k, "the number of modes")?;
        let modes = whole(k, &data, field(&data, 0), "a number of modes")?;
        self.procedure(k, Procedure::Frequency { modes })
    }

    pub(super) fn request(&mut self, k: &Keyword) -> Result<(), DeckError> {
        while self.lexer.data()?.is_some() {}
        match &mut self.step {
            Some(open) => open.step.requests.push(k.text.clone()),
            None => return Err(outside(k)),
        }
        Ok(())
    }
}

fn outside(k: &Keyword) -> DeckError {
    k.syntax("it between *STEP and *END STEP", "it outside a step", "")
}

/// An option's value as a data line, for the functions that read those.
fn as_data(k: &Keyword, text: &str) -> Data {
    Data {
        place: k.place.clone(),
        fields: vec![text.to_owned()],
    }
}

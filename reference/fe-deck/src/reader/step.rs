//! Steps: the procedures that the references use; output requests are recognised and passed over.

use super::model::field;
use super::{OpenStep, Reader, number, options, whole};
use crate::data::{Procedure, Step};
use crate::error::{DeckError, quote};
use crate::lexer::{Data, Keyword};

/// Options of *STEP without effect on the data that are read.
const STEP_OPTIONS: &[&str] = &[
    "NAME",
    "AMPLITUDE",
    "UNSYMM",
    "CONVERTSDI",
    "EXTRAPOLATION",
    "SOLVER",
    "THERMALEXPANSION",
    "ADIABATIC",
    "DIRECT",
    "STEADYSTATE",
    "TURBULENCEMODEL",
    "SHOCKSMOOTHING",
    "COMPRESSIBLE",
    "INCF",
    "INCFRAC",
];

/// Keywords that only request output.
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
            options(k, ["NLGEOM", "INC", "PERTURBATION"], STEP_OPTIONS)?;
        let nlgeom = match nlgeom {
            None => false,
            Some(v) if v.is_empty() || v.eq_ignore_ascii_case("YES") => true,
            Some(v) if v.eq_ignore_ascii_case("NO") => false,
            Some(v) => {
                return Err(k.syntax("NLGEOM, NLGEOM=YES or NLGEOM=NO", quote(v), ""));
            }
        };
        let increments = increments
            .map(|text| whole(k, &as_data(k, text), text, "a number of increments"))
            .transpose()?;
        self.step = Some(OpenStep {
            step: Step {
                nlgeom,
                perturbation: perturbation.is_some(),
                increments,
                procedure: Procedure::Other,
                boundaries: Vec::new(),
                boundaries_anew: false,
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
            Some(open) => {
                self.deck.steps.push(open.step);
                Ok(())
            }
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
                "begin another step",
            )),
            None => Err(outside(k)),
        }
    }

    /// Increment and period, in a line that may be left out; further values bound adaptive increments.
    fn times(&mut self, k: &Keyword) -> Result<Option<[f64; 2]>, DeckError> {
        let Some(data) = self.lexer.data()? else {
            return Ok(None);
        };
        let mut times = [1.0; 2];
        for (time, text) in times.iter_mut().zip(&data.fields) {
            if !text.is_empty() {
                *time = number(k, &data, text)?;
            }
            if *time <= 0.0 {
                return Err(data.syntax(k, "an increment and a period above 0", quote(text), ""));
            }
        }
        while self.lexer.data()?.is_some() {}
        Ok(Some(times))
    }

    pub(super) fn static_(&mut self, k: &Keyword) -> Result<(), DeckError> {
        let direct = k.options.iter().find(|o| o.key == "DIRECT");
        let times = self.times(k)?;
        let direct = direct.is_some();
        self.procedure(k, Procedure::Static { direct, times })
    }

    pub(super) fn dynamic(&mut self, k: &Keyword) -> Result<(), DeckError> {
        let [direct, explicit, alpha] = options(
            k,
            ["DIRECT", "EXPLICIT", "ALPHA"],
            &[
                "SOLVER",
                "RELATIVETOABSOLUTE",
                "APPLICATION",
                "INITIAL",
                "HAFTOL",
                "HALFINCSCALEFACTOR",
                "NOHAF",
                "TIMEINTEGRATOR",
                "SCALEFACTOR",
                "IMPROVEDDTMETHOD",
                "ELEMENTBYELEMENT",
                "FIXEDTIMEINCREMENTATION",
                "DIRECTUSERCONTROL",
                "ADIABATIC",
            ],
        )?;
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
        let data = self.need_data(k, "the number of modes")?;
        // Abaqus may ask for all modes in a range of frequencies instead.
        let modes = match field(&data, 0) {
            "" => 0,
            text => whole(k, &data, text, "a number of modes")?,
        };
        while self.lexer.data()?.is_some() {}
        self.procedure(k, Procedure::Frequency { modes })
    }

    pub(super) fn request(&mut self, k: &Keyword) -> Result<(), DeckError> {
        if let Some(open) = &mut self.step {
            open.step.requests.push(k.text.clone());
        }
        self.pass_over(k)
    }
}

fn outside(k: &Keyword) -> DeckError {
    k.syntax(
        "the keyword between *STEP and *END STEP",
        "the keyword outside a step",
        "",
    )
}

/// An option's value as a data line, for the functions that read those.
fn as_data(k: &Keyword, text: &str) -> Data {
    Data {
        place: k.place.clone(),
        fields: vec![text.to_owned()],
    }
}

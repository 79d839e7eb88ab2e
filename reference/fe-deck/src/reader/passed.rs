//! Keywords beyond those that are read: they change no body and are passed over, or they do and are declined.

use super::Reader;
use super::options;
use crate::data::{NonlinearProperty, Procedure};
use crate::error::{DeckError, quote};
use crate::lexer::Keyword;

/// Ignored keywords: loads, conditions, output, control of the solution, and properties without weight or stiffness.
/// An orientation has no effect on an isotropic material; a coupling ties nodes to a point, as the bore is tied to the
/// hub here.
const NEUTRAL: &str = "\
    AMPLITUDE BASEMOTION BOUNDARYF CFILM CFLUX CLOAD CRADIATE DFLUX DLOAD DSFLUX DSLOAD FIELD FILM \
    INERTIARELIEF LOADCASE ENDLOADCASE MASSFLOW MASSFLOWRATE PRESSURESTRESS PSD-DEFINITION RADIATE \
    SFILM SRADIATE SUBMODEL TEMPERATURE TRANSFORMF EQUATIONF VALUESATINFINITY PHYSICALCONSTANTS \
    VIEWFACTOR RETAINEDNODALDOFS BULKVISCOSITY CONTROLS DIAGNOSTICS ELEMENTMATRIXOUTPUT MATRIXOUTPUT ENERGYFILE \
    ENERGYPRINT FILEFORMAT FILTER FIXEDMASSSCALING GLOBALDAMPING INCREMENTATIONOUTPUT \
    INTEGRATEDOUTPUT INTEGRATEDOUTPUTSECTION MODALDAMPING MODALFILE MODALOUTPUT MODALPRINT PREPRINT \
    RADIATIONFILE RADIATIONPRINT SECTIONCONTROLS SECTIONFILE SELECTEIGENMODES SOLUTIONTECHNIQUE \
    SUBSTRUCTUREMATRIXOUTPUT TIMEPOINTS VARIABLEMASSSCALING CONSTRAINT CORRELATIONLENGTH \
    DESIGNRESPONSE DESIGNVARIABLES GEOMETRICCONSTRAINT OBJECTIVE CHANGECONTACTTYPE CHANGEFRICTION \
    CHANGESURFACEBEHAVIOR CLEARANCE COHESIVEBEHAVIOR CONTACT CONTACTCLEARANCE \
    CONTACTCLEARANCEASSIGNMENT CONTACTCONTROLS CONTACTCONTROLSASSIGNMENT CONTACTEXCLUSIONS \
    CONTACTFORMULATION CONTACTINCLUSIONS CONTACTINITIALIZATIONASSIGNMENT CONTACTINITIALIZATIONDATA \
    CONTACTINTERFERENCE CONTACTPROPERTYASSIGNMENT CONTACTSTABILIZATION GAPCONDUCTANCE \
    GAPHEATGENERATION SURFACEPROPERTYASSIGNMENT COUPLING DISTRIBUTING DISTRIBUTINGCOUPLING KINEMATIC \
    KINEMATICCOUPLING CONDUCTIVITY DAMPING DISTRIBUTION DISTRIBUTIONTABLE ELECTRICALCONDUCTIVITY \
    EXPANSION FLUIDCONSTANTS HOURGLASSSTIFFNESS INELASTICHEATFRACTION JOULEHEATFRACTION LATENTHEAT \
    MAGNETICPERMEABILITY NODALTHICKNESS NORMAL ORIENTATION SPECIFICGASCONSTANT SPECIFICHEAT \
    USEROUTPUTVARIABLES";

/// Procedures other than those that are read.
const PROCEDURES: &str = "\
    ANNEAL BUCKLE CFD COMPLEXFREQUENCY COUPLEDTEMPERATURE-DISPLACEMENT CRACKPROPAGATION DIRECTCYCLIC \
    DYNAMICTEMPERATURE-DISPLACEMENT ELECTROMAGNETICS FEASIBLEDIRECTION GEOSTATIC GREEN HEATTRANSFER \
    MATRIXGENERATE MODALDYNAMIC NOANALYSIS RANDOMRESPONSE REFINEMESH RESPONSESPECTRUM ROBUSTDESIGN SENSITIVITY \
    STEADYSTATEDYNAMICS SUBSTRUCTUREGENERATE UNCOUPLEDTEMPERATURE-DISPLACEMENT VISCO";

/// Keywords of materials beyond linear isotropic elasticity.
const BEYOND_ELASTIC: &str = "\
    BRITTLECRACKING CAPPLASTICITY CASTIRONPLASTICITY CLAYPLASTICITY CONCRETE \
    CONCRETEDAMAGEDPLASTICITY CREEP CRUSHABLEFOAM CYCLICHARDENING DAMAGEEVOLUTION DAMAGEINITIATION \
    DEFORMATIONPLASTICITY DEPVAR DRUCKERPRAGER EOS FAILSTRAIN FAILSTRESS HYPERELASTIC HYPERFOAM \
    HYPOELASTIC HYSTERESIS JOHNSONCOOK LOWDENSITYFOAM MOHRCOULOMB MULLINSEFFECT NOCOMPRESSION \
    NOTENSION PLASTIC POROUSELASTIC RATEDEPENDENT SWELLING USERMATERIAL VISCOELASTIC VISCOUS";

/// Keywords that change a body or its connectivity in other ways, with the reason and the remedy.
const DECLINED: &[(&str, &str, &str)] = &[
    (
        "EQUATION MPC TIE EMBEDDEDELEMENT SHELLTOSOLIDCOUPLING FASTENER COUPLEDNODES",
        "nodes that are connected by their elements only",
        "let connected parts share their nodes, and remove the keyword",
    ),
    (
        "CYCLICSYMMETRYMODEL SELECTCYCLICSYMMETRYMODES",
        "a whole body, not a sector",
        "mesh the whole body",
    ),
    (
        "BEAMGENERALSECTION BEAMSECTION COHESIVESECTION CONNECTORSECTION FLUIDSECTION \
         FLUIDSECTIONS FRAMESECTION GASKETSECTION MEMBRANE MEMBRANESECTION PRE-TENSIONSECTION \
         SHELLGENERALSECTION SHELLSECTION SURFACESECTION TRUSSSECTION USERSECTION",
        "solid elements only",
        "remove its elements, or mesh them as solids",
    ),
    (
        "DASHPOT GAP MASS NONSTRUCTURALMASS POINTMASS ROTARYINERTIA SPRING INERTIA",
        "solid elements only",
        "remove it, and give masses and springs in the scene",
    ),
    (
        "CHANGEMATERIAL CHANGEPLASTIC CHANGESOLIDSECTION",
        "one body in all steps",
        "remove the change",
    ),
    (
        "ELCOPY ELGEN IMPORT NCOPY NFILL NGEN NMAP PARAMETER SUPERPROPERTY SYSTEM",
        "explicit lists of nodes and elements",
        "let the preprocessor write the whole mesh",
    ),
];

impl Reader<'_> {
    /// A keyword that has no function of its own.
    pub(super) fn other_keyword(&mut self, k: &Keyword) -> Result<(), DeckError> {
        let key = k.key.as_str();
        if among(NEUTRAL, key) {
            return self.pass_over(k);
        }
        if among(PROCEDURES, key) {
            if let Some(open) = &mut self.step {
                open.step.procedure = Procedure::Other;
                open.procedure = true;
            }
            return self.pass_over(k);
        }
        if among(BEYOND_ELASTIC, key) {
            return self.beyond(k, "the material is linear elastic and isotropic");
        }
        match key {
            "MODELCHANGE" => {
                let [kind] = options(k, ["TYPE"], &["ADD", "REMOVE"])?;
                match kind.is_some_and(|t| t.eq_ignore_ascii_case("ELEMENT")) {
                    true => Err(k.unsupported(
                        "one body in all steps",
                        "elements that are added or removed",
                        "remove it",
                    )),
                    false => self.pass_over(k),
                }
            }
            "RESTART" => match k.options.iter().any(|o| o.key == "READ") {
                true => Err(k.unsupported(
                    "a deck that does not continue another one",
                    "a deck that continues another one",
                    "remove it",
                )),
                false => self.pass_over(k),
            },
            _ => match DECLINED.iter().find(|d| among(d.0, key)) {
                Some((_, expected, way_out)) => {
                    Err(k.unsupported(*expected, quote(&name(k)), *way_out))
                }
                None => Err(k.unsupported(
                    "a keyword whose influence on the body is known",
                    "an unknown keyword",
                    "remove it from the deck if the body does not depend on it",
                )),
            },
        }
    }

    /// Counts a keyword that changes no body, and passes its data lines over.
    pub(super) fn pass_over(&mut self, k: &Keyword) -> Result<(), DeckError> {
        self.count_passed(name(k));
        while self.lexer.data()?.is_some() {}
        Ok(())
    }

    pub(super) fn count_passed(&mut self, what: String) {
        *self.deck.passed_over.entry(what).or_default() += 1;
    }

    /// Marks a material beyond linear isotropic elasticity: its bodies are declined.
    pub(super) fn beyond(&mut self, k: &Keyword, reason: &str) -> Result<(), DeckError> {
        let beyond = NonlinearProperty {
            keyword: k.text.clone(),
            reason: reason.to_owned(),
            place: k.place.clone(),
        };
        self.open_material(k)?.beyond.get_or_insert(beyond);
        while self.lexer.data()?.is_some() {}
        Ok(())
    }
}

/// Returns true if a keyword is in a list.
fn among(list: &str, key: &str) -> bool {
    list.split_whitespace().any(|k| k == key)
}

/// A keyword without its options.
pub(super) fn name(k: &Keyword) -> String {
    let name = k.text.split(',').next().unwrap_or_default();
    let words: Vec<&str> = name.split_whitespace().collect();
    words.join(" ").to_ascii_uppercase()
}

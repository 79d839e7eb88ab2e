//! Details of elastic gears beyond the number of modes: kind of flank contact and density of the finite-element mesh.
//!
//! The mesh and the contact of a scene have errors of their own: a coarse mesh with contact at its elements is too soft
//! or too stiff by several per cent, and its stiffness ripples over the mesh cycle. So there are three **details**:
//!
//! | detail | contact of the flanks | elements |
//! |---|---|---|
//! | [`Detail::Given`] | of the scene | of the scene |
//! | [`Detail::HalfSpaces`] | on Hertzian half-spaces | of the scene |
//! | [`Detail::Finer`] | on half-spaces, if possible | twice as many in the section; over the width see below |
//!
//! The finer mesh has twice as many elements over the width if contact varies or is sliced there, else two.
//!
//! The **lead** is the better one of the first two; modes are refined on it. All models are compared with the finer
//! one, whose distance from the lead gives its own error. Half-spaces are excluded where flank points have dashpots,
//! which belong to a mesh, where the assembly refuses them, and where no run on them is sound. An external mesh cannot
//! be refined.

use super::plan::elastic;
use super::problem::{ElasticSettings, Problem};
use crate::experiment::budget::ProcessorClock;
use gearbench_models::law::Damping;
use gearbench_models::scene::{Scene, touches_in_space};
use gearbench_models::spec::{Body, FlankContact};
use gearbench_reference::reduction::ElasticParameters;
use gearbench_reference::{MeshParameters, REFERENCES};

/// Elements of the finer mesh over those of the scene.
const FACTOR: usize = 2;
/// Elements over the width of which more change nothing where contact lies evenly over it: of the FZG C gears the stiffness
/// of a pair is 12.31, 12.46 and 12.46 N/(mm um) with one, two and four.
const WIDTH: usize = 2;

/// Mesh density and kind of flank contact of elastic gears.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Detail {
    /// Mesh and contact of the scene.
    #[default]
    Given,
    /// Contact on half-spaces, with the mesh of the scene.
    HalfSpaces,
    /// A finer mesh, with contact on half-spaces where it is possible.
    Finer,
}

impl Detail {
    /// Returns the rank of the detail in tables, from 0.
    pub fn rank(self) -> u8 {
        match self {
            Detail::Given => 0,
            Detail::HalfSpaces => 1,
            Detail::Finer => 2,
        }
    }

    /// Returns the suffix of the name of a level with this detail.
    pub fn suffix(self) -> &'static str {
        match self {
            Detail::Given => "",
            Detail::HalfSpaces => ", half-spaces",
            Detail::Finer => ", finer mesh",
        }
    }
}

/// Elastic gears of a problem in all details: the lead and the finer mesh.
#[derive(Clone, Debug)]
pub struct Details {
    /// Elastic gears on which modes are refined: half-spaces on the mesh of the scene, else mesh and contact of the
    /// scene.
    pub lead: ElasticSettings,
    /// Reason why flanks do not touch on half-spaces; `None` if they do.
    pub no_half_spaces: Option<String>,
    /// Elastic gears with a finer mesh, or the reason why there is none.
    pub finer: Result<ElasticSettings, String>,
    /// Processor time of the first set-up of the gears of the lead and of the finer mesh, caches as they were [s].
    setup_s: [f64; 2],
}

impl Details {
    /// Finds them: sets the gears up with some modes, since what is refused is refused there; with none where it is not
    /// known how many are to come.
    pub fn of(problem: &Problem, modes: usize) -> Details {
        let given = &problem.flexible;
        let begin = ProcessorClock::start();
        let (lead, no_half_spaces) = match half_spaces(problem, modes) {
            Ok(Some(lead)) => (lead, None),
            Ok(None) => (given.clone(), None),
            Err(why) => (given.clone(), Some(why)),
        };
        Details::from_lead((problem, modes), lead, no_half_spaces, begin)
    }

    /// Returns the details with the contact of the scene in place of half-spaces, for the reason `why`.
    pub fn as_given(problem: &Problem, why: String) -> Details {
        Details::from_lead(
            (problem, 0),
            problem.flexible.clone(),
            Some(why),
            ProcessorClock::start(),
        )
    }

    fn from_lead(
        (problem, modes): (&Problem, usize),
        lead: ElasticSettings,
        no_half_spaces: Option<String>,
        begin: ProcessorClock,
    ) -> Details {
        let of_lead = begin.elapsed().as_secs_f64();
        let finer = finer(problem, &lead, modes);
        Details {
            lead,
            no_half_spaces,
            finer,
            setup_s: [of_lead, begin.elapsed().as_secs_f64() - of_lead],
        }
    }

    /// Returns the processor time of the first set-up of the gears of a detail, caches as they were [s].
    pub fn setup_s(&self, detail: Detail) -> f64 {
        self.setup_s[usize::from(detail == Detail::Finer)]
    }

    /// Describes elements and contact of the gears that all models are compared with.
    pub fn describe_judge(&self) -> String {
        let mut of_gears: Vec<String> = self.judge().gears.iter().map(elements).collect();
        of_gears.dedup();
        let contact = match self.on_half_spaces() {
            true => "half-spaces",
            false => "the contact of the scene",
        };
        format!("{}; {contact}", of_gears.join("; "))
    }

    /// Returns the elastic gears that all models are compared with: the finer mesh, else the lead.
    pub fn judge(&self) -> &ElasticSettings {
        self.finer.as_ref().unwrap_or(&self.lead)
    }

    /// Returns the elastic gears (elements and contact) of a detail.
    pub fn flexible<'a>(&'a self, problem: &'a Problem, detail: Detail) -> &'a ElasticSettings {
        match &self.finer {
            Ok(finer) if detail == Detail::Finer => finer,
            _ if detail == self.lead.detail => &self.lead,
            _ => &problem.flexible,
        }
    }

    /// True if the flanks touch on half-spaces.
    pub fn on_half_spaces(&self) -> bool {
        touches_on_half_spaces(&self.lead)
    }
}

/// True if all contacts are those of half-spaces.
fn touches_on_half_spaces(flexible: &ElasticSettings) -> bool {
    (flexible.contacts.iter()).all(|c| c.flanks == FlankContact::HalfSpace)
}

/// The gears of the scene on half-spaces; nothing where they touch so anyway.
///
/// # Errors
/// Why they cannot.
fn half_spaces(problem: &Problem, modes: usize) -> Result<Option<ElasticSettings>, String> {
    let given = &problem.flexible;
    if touches_on_half_spaces(given) {
        return Ok(None);
    }
    let mut lead = ElasticSettings {
        detail: Detail::HalfSpaces,
        ..given.clone()
    };
    for c in &mut lead.contacts {
        if c.flanks.penalty().is_some_and(|[_, dashpot]| dashpot > 0.0) {
            return Err("flank points have dashpots, which half-spaces do not know".into());
        }
        if !matches!(c.damping, Damping::None | Damping::RatioAtLoad { .. }) {
            return Err(format!("half-spaces do not know `{}`", c.damping.id()));
        }
        c.flanks = FlankContact::HalfSpace;
        c.exponent = 1.0;
    }
    match Scene::build(
        &problem.scene,
        &elastic(&lead, modes, None),
        &problem.context.models,
    ) {
        Ok(_) => Ok(Some(lead)),
        Err(e) => Err(e.to_string()),
    }
}

/// Gears of a finer mesh.
///
/// # Errors
/// Why there are none.
fn finer(
    problem: &Problem,
    lead: &ElasticSettings,
    modes: usize,
) -> Result<ElasticSettings, String> {
    let mut finer = ElasticSettings {
        detail: Detail::Finer,
        ..lead.clone()
    };
    for (i, gear) in finer.gears.iter_mut().enumerate() {
        if let Some(path) = &gear.reduction {
            let name = &problem.scene.gears[i].name;
            return Err(format!("`{name}` is a stored reduction, {path}"));
        }
        gear.mesh = refined(problem, &gear.mesh, i)?;
    }
    match Scene::build(
        &problem.scene,
        &elastic(&finer, modes, None),
        &problem.context.models,
    ) {
        Ok(_) => Ok(finer),
        Err(e) => Err(e.to_string()),
    }
}

/// The parameters of a mesh with more elements: generated ones have their counts multiplied, those of stored references
/// become generated ones of the same gear.
fn refined(
    problem: &Problem,
    given: &MeshParameters,
    gear: usize,
) -> Result<MeshParameters, String> {
    let sliced = (problem.flexible.contacts.iter()).any(|c| c.slices.is_some());
    let scene = &problem.scene;
    let mut own = scene.meshes.iter().filter(|m| m.gears.contains(&gear));
    let in_space = own.any(|m| touches_in_space(scene, m));
    let even = !sliced && !in_space && even_over_width(&scene.gears[gear].body);
    let more = |of: &MeshParameters| {
        let finer = of.times(FACTOR);
        MeshParameters {
            width_elements: match even {
                true => Some(WIDTH),
                false => finer.width_elements,
            },
            ..finer
        }
    };
    match given.mesh.as_deref().unwrap_or("generated") {
        "generated" => Ok(more(given)),
        stored if REFERENCES.iter().any(|r| r.id == stored) => {
            let modelling = elastic(&problem.flexible, 0, None);
            let scene = Scene::build(&problem.scene, &modelling, &problem.context.models)
                .map_err(|e| e.to_string())?;
            let grid = (scene.gears()[gear].model.flanks())
                .and_then(|f| f.grids().first().map(|g| [g.rows - 1, g.columns - 1]));
            let [flank, width] = grid.ok_or("a mesh without flanks")?;
            let counts = MeshParameters {
                flank_elements: Some(flank),
                width_elements: Some(width),
                ..MeshParameters::default()
            };
            Ok(more(&counts))
        }
        path => Err(format!(
            "the mesh of `{}` is from {path}",
            problem.scene.gears[gear].name
        )),
    }
}

/// Contact lies evenly over the face width.
fn even_over_width(body: &Body) -> bool {
    match body {
        Body::Gear(g) => !g.varies_over_width(),
        Body::Rack(r) => r.params().helix_angle == 0.0,
    }
}

/// Describes the elements of a mesh.
pub fn elements(of: &ElasticParameters) -> String {
    let m = &of.mesh;
    match (&m.mesh, &of.reduction) {
        (_, Some(path)) => path.clone(),
        (Some(mesh), _) if mesh != "generated" => mesh.clone(),
        _ => {
            let [flank, _, _, _, width] = m.counted();
            format!("{flank} elements along a flank, {width} over the width")
        }
    }
}

//! The model description of an FMU, `modelDescription.xml` of FMI 3.0 or FMI 2.0.
//!
//! Both list the same variables in the same order, with their index as value reference. FMI 2 has no event indicators among
//! the variables, only their number; they are the last of the list.

use super::interface::{Interface, Role, Variable};
use gearbench_integrators::{Resolution, Scheme};
use gearbench_reports::escape::xml;
use std::fmt::Write as _;

/// Units by name, with the powers of kg, m, s and rad.
const UNITS: [(&str, [i32; 4]); 7] = [
    ("s", [0, 0, 1, 0]),
    ("rad", [0, 0, 0, 1]),
    ("rad/s", [0, 0, -1, 1]),
    ("m", [0, 1, 0, 0]),
    ("m/s", [0, 1, -1, 0]),
    ("N", [1, 1, -2, 0]),
    ("N.m", [1, 2, -2, 0]),
];

/// Version of the standard that an FMU follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FmiVersion {
    /// FMI 2.0.
    Two,
    /// FMI 3.0.
    Three,
}

impl FmiVersion {
    /// The version as in a model description.
    pub fn text(self) -> &'static str {
        match self {
            FmiVersion::Two => "2.0",
            FmiVersion::Three => "3.0",
        }
    }
}

/// Data of the model description that are not variables: names, token, method, default experiment.
#[derive(Clone, Copy, Debug)]
pub struct DescriptionHeader<'a> {
    /// Version of the standard.
    pub version: FmiVersion,
    /// Name of the shared library in the FMU.
    pub identifier: &'a str,
    /// Name of the scene.
    pub name: &'a str,
    /// Title of the scene.
    pub title: &'a str,
    /// Instantiation token, which the library verifies.
    pub token: &'a str,
    /// Integration method of co-simulation.
    pub scheme: Scheme,
    /// Simulated time of the scene [s].
    pub duration: f64,
    /// Number of samples over `duration`.
    pub samples: usize,
}

/// Default communication step of a host [s]: a sampling interval of the scene, in whole steps of the method.
fn default_step(head: &DescriptionHeader<'_>) -> f64 {
    let sample = head.duration / head.samples.max(1) as f64;
    match head.scheme.resolution {
        Resolution::Step(h) => h * (sample / h).round().max(1.0),
        Resolution::Tolerance(_) => sample,
    }
}

/// The text of the model description.
pub fn text(head: &DescriptionHeader<'_>, all: &Interface) -> String {
    let mut out = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    root(&mut out, head, all);
    out.push_str("  <UnitDefinitions>\n");
    for (unit, powers) in UNITS {
        let powers = ["kg", "m", "s", "rad"].iter().zip(powers);
        let powers = powers.filter(|(_, p)| *p != 0);
        let powers: Vec<String> = powers.map(|(n, p)| format!("{n}=\"{p}\"")).collect();
        let powers = powers.join(" ");
        // Writing to a string does not fail.
        let _ = writeln!(out, "    <Unit name=\"{unit}\"><BaseUnit {powers}/></Unit>");
    }
    let _ = write!(
        out,
        "  </UnitDefinitions>\n  <LogCategories>\n    <Category name=\"logStatusError\" description=\"why a call failed\"/>\n  \
         </LogCategories>\n  <DefaultExperiment startTime=\"0\" stopTime=\"{:e}\" stepSize=\"{:e}\"/>\n  <ModelVariables>\n",
        head.duration,
        default_step(head)
    );
    for (reference, variable) in all.variables.iter().enumerate() {
        if head.version == FmiVersion::Two && matches!(variable.role, Role::EventFunction(_)) {
            continue;
        }
        out.push_str(&element(head.version, reference, variable, all));
    }
    out.push_str("  </ModelVariables>\n  <ModelStructure>\n");
    structure(&mut out, head.version, all);
    out.push_str("  </ModelStructure>\n</fmiModelDescription>\n");
    out
}

/// Writes the root element and the kinds of FMI that the FMU supports.
fn root(out: &mut String, head: &DescriptionHeader<'_>, all: &Interface) {
    let DescriptionHeader {
        identifier, token, ..
    } = head;
    let [name, title] = [head.name, head.title].map(xml);
    let program = format!("gearbench {}", env!("CARGO_PKG_VERSION"));
    let version = head.version.text();
    let state = match head.version {
        FmiVersion::Two => "FMUstate",
        FmiVersion::Three => "FMUState",
    };
    let (token, indicators) = match head.version {
        FmiVersion::Two if all.exchanges => (
            format!("guid=\"{token}\""),
            format!(" numberOfEventIndicators=\"{}\"", all.event_functions),
        ),
        FmiVersion::Two => (format!("guid=\"{token}\""), String::new()),
        FmiVersion::Three => (format!("instantiationToken=\"{token}\""), String::new()),
    };
    let copies = format!("canGetAndSet{state}=\"true\" canSerialize{state}=\"true\"");
    let step = match (head.version, head.scheme.resolution) {
        (FmiVersion::Two, _) => " canInterpolateInputs=\"true\"".to_owned(),
        (_, Resolution::Step(h)) => format!(" fixedInternalStepSize=\"{h:e}\""),
        (_, Resolution::Tolerance(_)) => String::new(),
    };
    let completed = match head.version {
        FmiVersion::Two => "",
        FmiVersion::Three => " needsCompletedIntegratorStep=\"true\"",
    };
    let _ = writeln!(
        out,
        "<fmiModelDescription fmiVersion=\"{version}\" modelName=\"{name}\" description=\"{title}\" {token} \
         generationTool=\"{program}\" variableNamingConvention=\"flat\"{indicators}>"
    );
    if all.exchanges {
        let _ = writeln!(
            out,
            "  <ModelExchange modelIdentifier=\"{identifier}\" {copies}{completed}/>"
        );
    }
    let _ = writeln!(
        out,
        "  <CoSimulation modelIdentifier=\"{identifier}\" {copies} \
         canHandleVariableCommunicationStepSize=\"true\"{step} maxOutputDerivativeOrder=\"2\"/>"
    );
}

/// Writes the lists of outputs, derivatives, unknowns of the initialisation and event indicators.
fn structure(out: &mut String, version: FmiVersion, all: &Interface) {
    /// Condition on the role of a variable.
    type OfRole = fn(Role) -> bool;
    let outputs: OfRole = |role| matches!(role, Role::Output(_));
    let derivatives: OfRole = |role| matches!(role, Role::Derivative(_));
    let unknowns: OfRole = |role| matches!(role, Role::Output(_) | Role::Derivative(_));
    let indicators: OfRole = |role| matches!(role, Role::EventFunction(_));
    let kinds = [
        ("Output", "Outputs", outputs),
        ("ContinuousStateDerivative", "Derivatives", derivatives),
        ("InitialUnknown", "InitialUnknowns", unknowns),
        ("EventIndicator", "", indicators),
    ];
    for (three, two, of) in kinds {
        let roles = all.variables.iter().map(|v| v.role).enumerate();
        let found: Vec<usize> = roles
            .filter(|(_, role)| of(*role))
            .map(|(i, _)| i)
            .collect();
        match version {
            FmiVersion::Three => {
                for reference in found {
                    let _ = writeln!(out, "    <{three} valueReference=\"{reference}\"/>");
                }
            }
            FmiVersion::Two if !two.is_empty() && !found.is_empty() => {
                let _ = writeln!(out, "    <{two}>");
                for reference in found {
                    // Indices begin with one.
                    let _ = writeln!(out, "      <Unknown index=\"{}\"/>", reference + 1);
                }
                let _ = writeln!(out, "    </{two}>");
            }
            FmiVersion::Two => {}
        }
    }
}

/// The XML element of a variable.
fn element(version: FmiVersion, reference: usize, v: &Variable, all: &Interface) -> String {
    let state_of = |i: usize| {
        let mut roles = all.variables.iter().map(|v| v.role);
        roles.position(|role| role == Role::State(i)).unwrap_or(0)
    };
    let (causality, variability, initial) = match v.role {
        Role::Time => ("independent", "continuous", ""),
        Role::Interpolate => ("parameter", "fixed", ""),
        Role::Input { .. } => ("input", "continuous", ""),
        Role::Output(_) => ("output", "continuous", "calculated"),
        Role::State(_) => ("local", "continuous", "exact"),
        Role::Derivative(_) | Role::EventFunction(_) => ("local", "continuous", "calculated"),
    };
    let attribute = |name: &str, value: &str| match value {
        "" => String::new(),
        value => format!(" {name}=\"{}\"", xml(value)),
    };
    let start = match (v.role, v.start) {
        (Role::Interpolate, Some(_)) => "false".to_owned(),
        (_, Some(start)) => format!("{start:e}"),
        _ => String::new(),
    };
    let of = match (v.role, version) {
        (Role::Derivative(i), FmiVersion::Two) => (state_of(i) + 1).to_string(),
        (Role::Derivative(i), FmiVersion::Three) => state_of(i).to_string(),
        _ => String::new(),
    };
    let general = [
        attribute("name", &v.name),
        attribute("valueReference", &reference.to_string()),
        attribute("causality", causality),
        attribute("variability", variability),
        attribute("initial", initial),
        attribute("description", &v.description),
    ]
    .concat();
    let own = [
        attribute("unit", v.unit),
        attribute("derivative", &of),
        attribute("start", &start),
    ]
    .concat();
    let boolean = v.role == Role::Interpolate;
    match version {
        FmiVersion::Two => {
            let kind = if boolean { "Boolean" } else { "Real" };
            format!("    <ScalarVariable{general}><{kind}{own}/></ScalarVariable>\n")
        }
        FmiVersion::Three => {
            let kind = if boolean { "Boolean" } else { "Float64" };
            format!("    <{kind}{general}{own}/>\n")
        }
    }
}

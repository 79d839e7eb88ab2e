//! The model description of an FMU, `modelDescription.xml` of FMI 3.0.1.

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

/// Data of the model description that are not variables: names, token, method, default experiment.
#[derive(Clone, Copy, Debug)]
pub struct DescriptionHeader<'a> {
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
    let DescriptionHeader {
        identifier, token, ..
    } = head;
    let [name, title] = [head.name, head.title].map(xml);
    let version = env!("CARGO_PKG_VERSION");
    let step = match head.scheme.resolution {
        Resolution::Step(h) => format!(" fixedInternalStepSize=\"{h:e}\""),
        Resolution::Tolerance(_) => String::new(),
    };
    // Writing to a string does not fail.
    let _ = writeln!(
        out,
        "<fmiModelDescription fmiVersion=\"3.0\" modelName=\"{name}\" description=\"{title}\" \
         instantiationToken=\"{token}\" generationTool=\"gearbench {version}\" variableNamingConvention=\"flat\">"
    );
    if all.exchanges {
        let _ = writeln!(
            out,
            "  <ModelExchange modelIdentifier=\"{identifier}\" canGetAndSetFMUState=\"true\" needsCompletedIntegratorStep=\"true\"/>"
        );
    }
    let _ = writeln!(
        out,
        "  <CoSimulation modelIdentifier=\"{identifier}\" canGetAndSetFMUState=\"true\" \
         canHandleVariableCommunicationStepSize=\"true\"{step} maxOutputDerivativeOrder=\"2\"/>"
    );
    out.push_str("  <UnitDefinitions>\n");
    for (unit, powers) in UNITS {
        let powers = ["kg", "m", "s", "rad"].iter().zip(powers);
        let powers = powers.filter(|(_, p)| *p != 0);
        let powers: Vec<String> = powers.map(|(n, p)| format!("{n}=\"{p}\"")).collect();
        let powers = powers.join(" ");
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
        out.push_str(&element(reference, variable, all));
    }
    out.push_str("  </ModelVariables>\n  <ModelStructure>\n");
    let outputs = |role: Role| matches!(role, Role::Output(_));
    let derivatives = |role: Role| matches!(role, Role::Derivative(_));
    list(&mut out, "Output", all, outputs);
    list(&mut out, "ContinuousStateDerivative", all, derivatives);
    list(&mut out, "InitialUnknown", all, |role| {
        outputs(role) || derivatives(role)
    });
    list(&mut out, "EventIndicator", all, |role| {
        matches!(role, Role::EventFunction(_))
    });
    out.push_str("  </ModelStructure>\n</fmiModelDescription>\n");
    out
}

/// Writes one element for every variable of a kind.
fn list(out: &mut String, element: &str, all: &Interface, of: impl Fn(Role) -> bool) {
    let roles = all.variables.iter().map(|v| v.role).enumerate();
    for (reference, _) in roles.filter(|(_, role)| of(*role)) {
        let _ = writeln!(out, "    <{element} valueReference=\"{reference}\"/>");
    }
}

/// The XML element of a variable.
fn element(reference: usize, v: &Variable, all: &Interface) -> String {
    let state_of = |i: usize| {
        let mut roles = all.variables.iter().map(|v| v.role);
        roles.position(|role| role == Role::State(i)).unwrap_or(0)
    };
    let kind = match v.role {
        Role::Interpolate => "Boolean",
        _ => "Float64",
    };
    let role = match v.role {
        Role::Time => "causality=\"independent\" variability=\"continuous\"".to_owned(),
        Role::Interpolate => "causality=\"parameter\" variability=\"fixed\"".to_owned(),
        Role::Input { .. } => "causality=\"input\" variability=\"continuous\"".to_owned(),
        Role::Output(_) => {
            "causality=\"output\" variability=\"continuous\" initial=\"calculated\"".to_owned()
        }
        Role::State(_) => {
            "causality=\"local\" variability=\"continuous\" initial=\"exact\"".to_owned()
        }
        Role::Derivative(i) => format!(
            "causality=\"local\" variability=\"continuous\" initial=\"calculated\" derivative=\"{}\"",
            state_of(i)
        ),
        Role::EventFunction(_) => {
            "causality=\"local\" variability=\"continuous\" initial=\"calculated\"".to_owned()
        }
    };
    let mut out = format!(
        "    <{kind} name=\"{}\" valueReference=\"{reference}\" {role}",
        xml(&v.name)
    );
    if !v.description.is_empty() {
        let _ = write!(out, " description=\"{}\"", xml(&v.description));
    }
    if !v.unit.is_empty() {
        let _ = write!(out, " unit=\"{}\"", v.unit);
    }
    match (v.role, v.start) {
        (Role::Interpolate, Some(_)) => out.push_str(" start=\"false\""),
        (_, Some(start)) => {
            let _ = write!(out, " start=\"{start:e}\"");
        }
        _ => {}
    }
    out.push_str("/>\n");
    out
}

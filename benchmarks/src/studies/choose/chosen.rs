//! The scene file with a choice written in: the gears and meshes as they stood, one model, one integrator.

use super::plan::Candidate;
use crate::scene_file::{Origin, SceneError, SceneFile};
use gearbench_integrators::Resolution;
use gearbench_models::law::Damping;
use gearbench_models::spec::{ContactSpec, Parameters, Passes, PointRule, SurfaceKind, Value};
use gearbench_models::stiffness::{
    Ends, Foundation, Hertz, Interpolation, IsoVariation, PairOrMesh, PairStiffness, RootLength,
};
use toml_edit::{DocumentMut, TomlError};

/// Tables and keys that a choice replaces. The tolerance may refer to a model that is gone.
const REPLACED: [&str; 3] = ["models", "study", "tolerance"];

/// Text of the scene with a choice; `remarks` head it as comments.
///
/// # Errors
/// [`SceneError`] when what was written is no scene: its models stand in a way that was not seen through.
pub fn text(
    file: &SceneFile,
    candidate: &Candidate,
    remarks: &[String],
) -> Result<String, SceneError> {
    let mut out = String::new();
    for remark in remarks {
        out.push_str(&format!("# {}\n", remark.replace('\n', " ")));
    }
    out.push_str(kept(file.text())?.trim_end());
    out.push_str("\n\n");
    out.push_str(&model(file, candidate));
    out.push_str(&study(file, candidate));
    SceneFile::parse("chosen.toml", &out, Origin::Shipped, true)?;
    Ok(out)
}

/// A scene without what a choice replaces, and without the comments right above that.
fn kept(text: &str) -> Result<String, SceneError> {
    let mut document: DocumentMut = text.parse().map_err(|e: TomlError| {
        let help = "a choice is written into a scene that is TOML";
        SceneError::plain(e.to_string(), help)
    })?;
    for key in REPLACED {
        document.remove(key);
    }
    Ok(document.to_string())
}

fn number(x: f64) -> String {
    // Ten digits are enough for anything that was found; whole numbers stay as they are.
    if x.fract() == 0.0 && x.abs() < 1e6 {
        return format!("{x:.0}");
    }
    let short: f64 = format!("{x:.9e}").parse().unwrap_or(x);
    format!("{short:e}")
}

fn list(x: &[f64]) -> String {
    let all: Vec<String> = x.iter().map(|x| number(*x)).collect();
    format!("[{}]", all.join(", "))
}

fn quote(text: &str) -> String {
    toml_edit::Value::from(text).to_string()
}

fn model(file: &SceneFile, candidate: &Candidate) -> String {
    let modelling = &candidate.modelling;
    let first = &modelling.gears[0];
    let mut out = format!("[[models]]\nlabel = \"chosen\"\nmodel = \"{}\"\n", first.id);
    if !first.parameters.is_empty() {
        out.push_str(&format!("parameters = {}\n", parameters(&first.parameters)));
    }
    let others: Vec<String> = (file.spec.gears.iter().zip(&modelling.gears))
        .filter(|(_, m)| *m != first)
        .map(|(g, m)| {
            format!(
                "{} = {{ model = \"{}\", parameters = {} }}",
                g.name,
                m.id,
                parameters(&m.parameters)
            )
        })
        .collect();
    if !others.is_empty() {
        out.push_str(&format!("gears = {{ {} }}\n", others.join(", ")));
    }
    let contacts: Vec<String> = modelling.contacts.iter().map(contact).collect();
    let alike = contacts.windows(2).all(|w| w[0] == w[1]);
    let contact = match contacts.first() {
        Some(one) if alike => one.clone(),
        _ => format!("[{}]", contacts.join(", ")),
    };
    out.push_str(&format!("contact = {contact}\n"));
    let gap = candidate.scene.meshes.first().map(|m| m.start.gap);
    let plain = file.spec.meshes.first().map(|m| m.start.gap);
    if let Some(gap) = gap.filter(|_| gap != plain) {
        out.push_str(&format!("gap_m = {}\n", number(gap)));
    }
    out
}

fn parameters(all: &Parameters) -> String {
    let pairs: Vec<String> = (all.iter())
        .map(|(key, value)| {
            let value = match value {
                Value::Number(x) => number(*x),
                Value::Text(x) => quote(x),
                Value::List(x) => list(x),
                Value::Flag(x) => x.to_string(),
            };
            format!("{key} = {value}")
        })
        .collect();
    format!("{{ {} }}", pairs.join(", "))
}

fn contact(c: &ContactSpec) -> String {
    let mut parts = Vec::new();
    if let Some(p) = &c.points {
        if p.hard {
            parts.push("law = \"hard\"".into());
            if p.rule == PointRule::Nodes {
                parts.push("points = \"nodes\"".into());
            }
        } else {
            let key = match p.rule {
                PointRule::EachNode => "penalty_n_per_m",
                _ => "penalty_pa_per_m",
            };
            parts.push(format!("{key} = {}", number(p.penalty)));
            parts.push(match p.rule {
                PointRule::Nodes | PointRule::EachNode => "points = \"nodes\"".into(),
                PointRule::Quadrature { along, across } => {
                    format!("points = {{ along = {along}, across = {across} }}")
                }
            });
        }
        if p.surface == SurfaceKind::Faceted {
            parts.push("surface = \"faceted\"".into());
        }
        match p.passes {
            Passes::Auto => {}
            Passes::First => parts.push("passes = \"first\"".into()),
            Passes::Second => parts.push("passes = \"second\"".into()),
            Passes::Both => parts.push("passes = \"both\"".into()),
        }
        if p.damping != 0.0 {
            parts.push(format!("damping_ns_per_m3 = {}", number(p.damping)));
        }
        if let Some(reach) = p.reach {
            parts.push(format!("reach_m = {}", number(reach)));
        }
    }
    parts.push(format!("stiffness = {}", stiffness(&c.stiffness)));
    if c.exponent != 1.0 {
        parts.push(format!("exponent = {}", number(c.exponent)));
    }
    let restitution = |e: f64| {
        format!(
            "damping = {{ law = \"{}\", e = {} }}",
            c.damping.id(),
            number(e)
        )
    };
    match c.damping {
        Damping::None => {}
        Damping::KelvinVoigt { c } => parts.push(format!(
            "damping = {{ law = \"kelvin-voigt\", damping_ns_per_m = {} }}",
            number(c)
        )),
        Damping::KelvinVoigtRatio { ratio } => parts.push(format!(
            "damping = {{ law = \"kelvin-voigt-ratio\", ratio = {} }}",
            number(ratio)
        )),
        Damping::HuntCrossley { e }
        | Damping::LankaraniNikravesh { e }
        | Damping::Flores { e }
        | Damping::Gonthier { e } => parts.push(restitution(e)),
    }
    if let Some(f) = &c.friction {
        parts.push(format!(
            "friction = {{ mu = {}, v_ref_m_s = {} }}",
            number(f.mu()),
            number(f.v_ref())
        ));
    }
    if let Some(n) = c.slices {
        parts.push(format!("slices = {n}"));
    }
    format!("{{ {} }}", parts.join(", "))
}

fn stiffness(s: &PairStiffness) -> String {
    let of = |of: &PairOrMesh| match of {
        PairOrMesh::Pair => "",
        PairOrMesh::Mesh => ", of = \"mesh\"",
    };
    match s {
        PairStiffness::Constant { per_width, of: o } => format!(
            "{{ kind = \"constant\", stiffness_n_per_m2 = {}{} }}",
            number(*per_width),
            of(o)
        ),
        PairStiffness::Iso6336 { variation } => {
            let variation = match variation {
                IsoVariation::IsoMean => "iso-mean",
                IsoVariation::CaiHayashi => "cai-hayashi",
                IsoVariation::Constant => "constant",
            };
            format!("{{ kind = \"iso6336\", variation = \"{variation}\" }}")
        }
        PairStiffness::Compliance {
            tooth,
            foundation,
            hertz,
        } => {
            let root = match foundation {
                Foundation::SainsotVelex(RootLength::TwoRfSinThetaF) => {
                    ", root_length = \"2 rf sin theta\""
                }
                Foundation::SainsotVelex(RootLength::TwoRbThetaF) => {
                    ", root_length = \"2 rb theta\""
                }
                _ => "",
            };
            let load = match hertz {
                Hertz::Log { reference_load } | Hertz::WeberBanaschek { reference_load } => {
                    format!(", reference_load_n = {}", number(*reference_load))
                }
                Hertz::Linear | Hertz::Rigid => String::new(),
            };
            format!(
                "{{ kind = \"compliance\", tooth = \"{}\", foundation = \"{}\"{root}, hertz = \"{}\"{load} }}",
                tooth.id(),
                foundation.id(),
                hertz.id()
            )
        }
        PairStiffness::Table {
            s,
            k,
            of: o,
            ends,
            interpolation,
        } => {
            let ends = match ends {
                Ends::Clamped => "",
                Ends::Periodic => ", ends = \"periodic\"",
            };
            let between = match interpolation {
                Interpolation::Cubic => "",
                Interpolation::Linear => ", interpolation = \"linear\"",
            };
            format!(
                "{{ kind = \"table\", path_coordinate_m = {}, stiffness_n_per_m = {}{}{ends}{between} }}",
                list(s),
                list(k),
                of(o)
            )
        }
    }
}

fn study(file: &SceneFile, candidate: &Candidate) -> String {
    let resolution = match candidate.method.resolution {
        Resolution::Step(h) => format!("step_s = {}", number(h)),
        Resolution::Tolerance(r) => format!("rtol = {}", number(r)),
    };
    format!(
        "\n[study]\nintegrators = [{{ method = {}, {resolution} }}]\nsamples = {}\n",
        quote(&candidate.method.method.to_string()),
        file.study.samples
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replaced_parts_go_with_their_comments() {
        let text = "name = \"x\" # [[models]]\ntolerance = { limit = 1 }\n\n[gears.a]\nteeth = 20\n\n# rigid\n\
                    [[models]]\nmodel = \"rigid\"\ncontact = { table = [\n[1.0, 2.0],\n] }\n[models.parameters]\nx = 1\n\
                    # kept\n[[meshes]]\ngears = [\"a\"]\n[study]\nsamples = 3\n";
        assert_eq!(
            kept(text)
                .unwrap()
                .split('\n')
                .filter(|l| !l.is_empty())
                .collect::<Vec<_>>(),
            [
                "name = \"x\" # [[models]]",
                "[gears.a]",
                "teeth = 20",
                "# kept",
                "[[meshes]]",
                "gears = [\"a\"]"
            ]
        );
        let quoted = "description = \"\"\"\n[[models]]\nof words\"\"\"\n[gears.a]";
        assert_eq!(kept(quoted).unwrap().trim_end(), quoted);
    }

    #[test]
    fn numbers_read_back() {
        for x in [1e15, 2.5e-7, 60.0, 0.0, 1.234567891e-3, 12.0] {
            let back: f64 = number(x).parse().unwrap();
            assert!((back - x).abs() <= 1e-9 * x.abs(), "{x}");
        }
    }
}

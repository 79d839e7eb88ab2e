//! Plan of a study of mesh stiffness: models of the scene, and rigid gears with the stiffness of formulas.

use crate::experiment::conditions::Conditions;
use crate::scene_file::formula_limits;
use gearbench_models::gear::rigid;
use gearbench_models::gear::table::{Model, properties_of};
use gearbench_models::geometry::Mate;
use gearbench_models::spec::{
    Body, FlankContact, Modelling, PointLaw, PointRule, SceneSpec, mesh_layout,
};
use gearbench_models::stiffness::{
    Foundation, Hertz, IsoVariation, PairStiffness, ToothModel, iso_of,
};

/// Plan of a study of mesh stiffness.
pub struct Plan {
    /// Conditions of the scene, for the head of the record.
    pub conditions: Conditions,
    /// Models of the scene, followed by formulas, each with its force along the line of action [N].
    pub entries: Vec<(Entry, f64)>,
    /// Number of positions over one base pitch.
    pub positions: usize,
}

/// Model whose static mesh stiffness is computed.
pub struct Entry {
    pub label: String,
    /// Description of the compliances that the stiffness includes.
    pub includes: String,
    pub spec: SceneSpec,
    pub modelling: Modelling,
    /// Stiffness of a pair and mean stiffness of the mesh that a norm states [N/m^2]: of helical gears they are no
    /// secants of a loaded mesh, so that they cannot be read from its cycle.
    pub stated: Option<[f64; 2]>,
}

impl Entry {
    /// Formulas of its contacts that have left their range, in words; flank points have none.
    pub fn limits(&self) -> Vec<String> {
        let contacts = self.spec.meshes.iter().zip(&self.modelling.contacts);
        (contacts.filter(|(_, contact)| contact.flanks == FlankContact::Toothing))
            .flat_map(|(mesh, contact)| formula_limits(&self.spec, mesh.gears, contact))
            .collect()
    }
}

/// Returns rigid gears with the stiffness of ISO 6336, and with the analytic compliance of teeth, bodies and contact,
/// in place of a model of the same gears.
pub fn formulas(spec: &SceneSpec, modelling: &Modelling) -> [Entry; 2] {
    let with = |label: &str, includes: &str, stiffness: PairStiffness| {
        let mut modelling = modelling.clone();
        modelling.gears.fill(rigid::spec());
        for contact in &mut modelling.contacts {
            contact.stiffness = stiffness.clone();
            contact.exponent = 1.0;
            contact.normal_force = None;
            contact.flanks = FlankContact::Toothing;
        }
        Entry {
            label: label.into(),
            includes: includes.into(),
            spec: spec.clone(),
            modelling,
            stated: None,
        }
    };
    [
        Entry {
            stated: iso_values(spec),
            ..with(
                "ISO 6336-1",
                "c' and c_gamma as the norm states them, with its 0.8 and CR = 1; the cycle with the parabola that has them in spur gears; for 100 N/mm and more",
                PairStiffness::Iso6336 {
                    variation: IsoVariation::IsoMean,
                },
            )
        },
        with(
            "analytic",
            "Weber-Banaschek tooth and Hertz contact at 100 N/mm, body as an elastic ring that all pairs share",
            PairStiffness::Compliance {
                tooth: ToothModel::WeberBanaschek,
                foundation: Foundation::Ring,
                hertz: Hertz::WeberBanaschek {
                    reference_load: None,
                },
            },
        ),
    ]
}

/// Computes `c'` and `c_gamma_alpha` of ISO 6336-1 for the gears of a mesh [N/m^2]; `None` where the formula has no
/// value.
pub fn iso_values(spec: &SceneSpec) -> Option<[f64; 2]> {
    let [a, b] = spec.meshes.first()?.gears.map(|i| &spec.gears[i]);
    let Body::Gear(gear) = &a.body else {
        return None;
    };
    let layout = mesh_layout(a, b).ok()?;
    let mate = match &b.body {
        Body::Gear(g) => Mate::Gear(g),
        Body::Rack(r) => Mate::Rack(r),
    };
    let iso = iso_of(gear, (mate, &layout.pair), [a.material, b.material]).ok()?;
    Some([iso.c_prime, iso.c_gamma_alpha])
}

/// Describes the compliances that the stiffness of a modelling includes.
pub fn includes(modelling: &Modelling, models: &[Model]) -> String {
    let properties = (modelling.gears.iter()).map(|g| properties_of(models, g.id()));
    let all_rigid = properties.clone().all(|p| p.rigid);
    let Some(contact) = modelling.contacts.first() else {
        return String::new();
    };
    match contact.flanks {
        FlankContact::HalfSpace => {
            "teeth, body to the rigid bore, Hertz's half-spaces in the place of the elements in contact".into()
        }
        FlankContact::Points(p) => match p.law {
            PointLaw::Hard => "teeth, body to the rigid bore, hard contact over the mesh".into(),
            PointLaw::Penalty { stiffness, .. } => {
                let unit = match p.rule {
                    PointRule::EachNode => "N/m per node",
                    _ => "Pa/m",
                };
                format!(
                    "teeth, body to the rigid bore, contact over the mesh, penalty {stiffness:.1e} {unit}"
                )
            }
        },
        FlankContact::Toothing if all_rigid => contact.stiffness.describe(),
        FlankContact::Toothing => format!(
            "the model's own springs in series with {}",
            contact.stiffness.describe()
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::context::Context;
    use crate::scene_file::{Origin, SceneFile};

    fn helical(
        teeth: [u32; 2],
        [module, angle, width]: [f64; 3],
        extra: [&str; 2],
        place: &str,
    ) -> SceneSpec {
        let gear = |name: &str, z: u32, angle: f64, extra: &str| {
            format!(
                "[gears.{name}]\nteeth = {z}\nmodule_m = {module}\nface_width_m = {width}\nhelix_angle_deg = {angle}\n{extra}\n"
            )
        };
        let [a, b] = teeth;
        let text = format!(
            "schema = 1\nname = \"helical\"\nduration_s = 1e-3\n{}{}[[meshes]]\ngears = [\"a\", \"b\"]\n{place}\n[[models]]\nmodel = \"rigid\"\ncontact = {{ stiffness = \"iso6336\" }}\n",
            gear("a", a, angle, extra[0]),
            gear("b", b, -angle, extra[1]),
        );
        SceneFile::parse(
            &Context::default(),
            "helical.toml",
            &text,
            Origin::Shipped,
            false,
        )
        .unwrap()
        .spec
    }

    /// ISO/TR 6336-30, example 1, its Annex A; and pairs of 20 and 30 degrees by the formula worked by hand.
    #[test]
    fn the_row_of_the_norm_is_the_norms_for_helical_gears() {
        let rack = "dedendum_factor = 1.4\nmaterial = { young_pa = 2.06e11, poisson = 0.3, density_kg_m3 = 7800 }";
        let shifted = format!("{rack}\nprofile_shift = 0.145");
        let example = helical(
            [17, 103],
            [0.008, 15.8, 0.1],
            [&shifted, rack],
            "centre_distance_m = 0.5",
        );
        let [c, mesh] = iso_values(&example).unwrap();
        assert!((c / 1e9 - 12.370472).abs() < 2e-5, "{c}");
        // The contact ratio depends on tip diameters, which the example alters by a tip shortening.
        let ratio = (mesh / c - 0.25) / 0.75;
        assert!((1.45..1.65).contains(&ratio), "{ratio}");
        for (angle, known) in [(20.0, [12.24, 16.35]), (30.0, [11.82, 14.47])] {
            let pair = helical(
                [20, 30],
                [0.004, angle, 0.04],
                ["", ""],
                "backlash_m = 100e-6",
            );
            let found = iso_values(&pair).unwrap().map(|k| k / 1e9);
            for (f, k) in found.iter().zip(known) {
                assert!((f / k - 1.0).abs() < 6e-4, "{angle} deg: {found:?}");
            }
        }
    }
}

//! Comparison of a stored reference with the gears of a scene: errors against a run of other gears, speeds or loads
//! have no meaning.

use super::super::SceneFile;
use gearbench_models::Vec3;
use gearbench_models::spec::{Body, GearSpec, Mount, mesh_layout};
use gearbench_reference::stored::{GearData, ImpactParameters};
use gearbench_reference::{REFERENCES, reference};
use gearbench_reports::numbers::{digits_apart, short};
use nalgebra::Rotation3;

/// Relative deviation of a length, angle or speed that counts as equal.
const SAME: f64 = 1e-4;
/// Relative deviation of an inertia that counts as equal: the mesh of the reference is faceted.
const SAME_INERTIA: f64 = 0.03;
/// Largest angle between axes that count as parallel [rad].
const SAME_TILT: f64 = 1e-5;

/// Descriptions of the quantities that differ, with both values.
struct Differences(Vec<String>);

impl Differences {
    fn compare(&mut self, what: &str, (scene, reference): (f64, f64), unit: &str, same: f64) {
        let scale = scene.abs().max(reference.abs());
        if (scene - reference).abs() > same * scale {
            let digits = digits_apart(&[scene, reference], 4);
            let [a, b] = [scene, reference].map(|x| short(x, digits));
            self.note(what, &a, &b, unit);
        }
    }

    fn note(&mut self, what: &str, scene: &str, reference: &str, unit: &str) {
        let text = format!("{what} {scene} {unit}");
        self.0
            .push(format!("{} (reference: {reference})", text.trim_end()));
    }
}

impl SceneFile {
    /// The lines of a scene for each stored reference that suits its gears, speeds and loads; `None` if none does.
    pub fn fitting(&self) -> Option<String> {
        let fits =
            |id: &&str| reference(id).is_ok_and(|r| self.differs_from(&r.parameters).is_empty());
        let ids = REFERENCES.iter().map(|r| r.id).filter(fits);
        let lines: Vec<String> = ids.map(|id| format!("reference = \"{id}\"")).collect();
        (!lines.is_empty()).then(|| lines.join("` or `"))
    }

    /// Lists the quantities of the scene that differ from those of a reference.
    pub(super) fn differs_from(&self, of: &ImpactParameters) -> Vec<String> {
        let mut differs = Differences(Vec::new());
        let ([a, b], [mesh]) = (self.spec.gears.as_slice(), self.spec.meshes.as_slice()) else {
            let count = format!("{} gears", self.spec.gears.len());
            differs.note("a scene of", &count, "two gears with one mesh", "");
            return differs.0;
        };
        let [a, b] = if mesh.gears == [0, 1] { [a, b] } else { [b, a] };
        gear(a, of.gears.first(), of, &mut differs);
        match (&b.body, &of.rack) {
            (Body::Rack(_), Some(_)) => {
                common(b, of, 0.0, &mut differs);
                if !matches!(b.mount, Mount::Fixed) {
                    differs.note(&format!("mount of `{}`", b.name), "free", "fixed", "");
                }
            }
            (Body::Rack(_), None) => {
                differs.note(&format!("`{}` is", b.name), "a rack", "a gear", "")
            }
            (Body::Gear(_), Some(_)) => {
                differs.note(&format!("`{}` is", b.name), "a gear", "a rack", "")
            }
            (Body::Gear(_), None) => gear(b, of.gears.get(1), of, &mut differs),
        }
        if let Ok(layout) = mesh_layout(a, b) {
            let distances = (1e3 * layout.distance, 1e3 * of.centre_distance);
            differs.compare("distance", distances, "mm", SAME);
        }
        differs.0
    }
}

fn gear(g: &GearSpec, of: Option<&GearData>, whole: &ImpactParameters, differs: &mut Differences) {
    let (Body::Gear(own), Some(of)) = (&g.body, of) else {
        differs.note(&format!("`{}` is", g.name), "a rack", "a gear", "");
        return;
    };
    let p = own.params();
    let name = |what: &str| format!("{what} of `{}`", g.name);
    differs.compare(&name("teeth"), (p.teeth.into(), of.teeth.into()), "", 0.0);
    common(g, whole, of.helix_angle_deg, differs);
    let tilt = Vec3::from(of.tilt);
    let axis = Rotation3::new(tilt) * Vec3::z();
    if g.axes[2].cross(&axis).norm() > SAME_TILT {
        let [own, of] =
            [&g.axes[2], &axis].map(|a| format!("({:.6}, {:.6}, {:.6})", a.x, a.y, a.z));
        differs.note(&name("axis"), &own, &of, "");
    }
    if g.lateral.is_some() {
        differs.note(
            &name("mount"),
            "on a bearing",
            "fixed except for its rotation",
            "",
        );
    }
    if (p.profile_shift - of.profile_shift).abs() > SAME {
        let [a, b] = [p.profile_shift, of.profile_shift].map(|x| short(x, 4));
        differs.note(&name("profile shift"), &a, &b, "");
    }
    let inertia = own.mass_properties(g.material.density).izz;
    let inertia = g.inertia.unwrap_or(inertia) + g.added_inertia;
    differs.compare(
        &name("inertia"),
        (inertia, of.inertia),
        "kg m^2",
        SAME_INERTIA,
    );
    match &g.mount {
        Mount::Revolute => {
            differs.compare(&name("initial speed"), (g.speed, of.speed), "rad/s", SAME)
        }
        Mount::Driven(_) => differs.note(&name("mount"), "driven", "free", ""),
        _ => differs.note(&name("mount"), "fixed", "free", ""),
    }
}

/// Compares the parameters that gears and racks share.
fn common(g: &GearSpec, of: &ImpactParameters, helix_deg: f64, differs: &mut Differences) {
    let (module, width, pressure, helix) = match &g.body {
        Body::Gear(x) => {
            let p = x.params();
            (p.module, p.face_width, p.pressure_angle, p.helix_angle)
        }
        Body::Rack(x) => {
            let p = x.params();
            (p.module, p.face_width, p.pressure_angle, p.helix_angle)
        }
    };
    let name = |what: &str| format!("{what} of `{}`", g.name);
    differs.compare(&name("module"), (1e3 * module, 1e3 * of.module), "mm", SAME);
    differs.compare(
        &name("face width"),
        (1e3 * width, 1e3 * of.face_width),
        "mm",
        SAME,
    );
    let angles = (pressure.to_degrees(), of.pressure_angle.to_degrees());
    differs.compare(&name("pressure angle"), angles, "degrees", SAME);
    differs.compare(
        &name("helix angle"),
        (helix.to_degrees(), helix_deg),
        "degrees",
        SAME,
    );
    let young = (1e-9 * g.material.young, 1e-9 * of.young);
    differs.compare(&name("Young's modulus"), young, "GPa", 0.01);
    if !g.loads.is_empty() {
        differs.note(&name("loads"), &g.loads.len().to_string(), "none", "");
    }
}

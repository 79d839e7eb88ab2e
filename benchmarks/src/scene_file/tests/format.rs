//! Tests of scenes as values: what is written is read, for every shipped scene and every form of a value.

use super::super::format::*;
use super::super::{Origin, SHIPPED, SceneFile};
use crate::context::Context;

/// Writes tables and reads them again.
fn again(name: &str, tables: &SceneTable) -> SceneTable {
    let text = tables.to_toml().unwrap();
    SceneTable::parse(&Context::default(), name, &text)
        .unwrap_or_else(|e| panic!("{name}: {}\n{text}", e.to_text()))
}

#[test]
fn shipped_scenes_are_written_and_read() {
    let context = Context::default();
    for shipped in SHIPPED {
        let name = format!("{}.toml", shipped.name);
        let tables = SceneTable::parse(&context, &name, shipped.text).unwrap();
        assert_eq!(again(&name, &tables), tables, "{name}");
        let read = |text: &str| {
            let file = SceneFile::unbuilt(&context, &name, text, Origin::Shipped, false).unwrap();
            format!(
                "{:?}{:?}{:?}{:?}",
                file.spec, file.models, file.study, file.references
            )
        };
        let written = tables.to_toml().unwrap();
        assert!(read(&written) == read(shipped.text), "{name}\n{written}");
    }
}

/// Forms that no shipped scene has.
#[test]
fn all_forms_of_values_are_written_and_read() {
    for more in [
        "pressure_angle_deg = 17.3\nhelix_slope_m = 1e-6\ntwist_m = { left = 2e-6 }",
        "topography = { both = [[0.0, 1e-6], [0.0, 2e-6]], radii_m = [0.04, 0.043] }",
        "topography = { left = \"left.csv\", unit_m = 1e-6 }",
        "deviations = { runout_m = 1e-5, runout_deg = 33.3, left = { cumulative_pitch_m = [0.0, 1e-6] } }",
        "mount = { driven = { table = { time_s = [0.0, 0.1], speed_rad_s = [0.0, 3.0] } } }",
        "mount = { guided = { stiffness_nm_per_rad = 10.0, friction_nm = 0.5, stick_rad = 1e-5 } }",
        "mount = \"fixed\"\nmaterial = \"steel-iso6336\"\nposition_m = [0.0, 0.1]\naxis = [0.0, 0.6, 0.8]",
        "material = { young_pa = 7e10, poisson = 0.33, density_kg_m3 = 2700 }\nposition_m = [0, 0, 1e-3]",
        "loads = [{ harmonic = { amplitude_nm = 1.0, frequency_hz = 50.0, phase_deg = 77.7 } }, { viscous_nms_per_rad = 1e-3 }]",
        "bearing = { stiffness = [1e8, 1e8, 5e7, 1e5, 1e5, 0.0] }\ndirections = { z = \"held\", x = \"free\", tilt_x = { driven = { speed_rad_s = 0.01 } } }\nspin_terms = \"off\"",
        "internal = true\nrim_radius_m = 0.06\nmisalignment_deg = { plane_of_action = 0.03 }",
    ] {
        for model in [
            "model = \"rigid\"\ncontact = { stiffness = \"iso6336\", damping = { law = \"flores\", e = 0.9 }, friction = { film = { viscosity_pa_s = 0.04, roughness_m = 4e-7 }, stick_m = 1e-6 } }",
            "model = \"rigid\"\ncontact = [{ stiffness = { kind = \"compliance\", foundation = \"sainsot-velex\", root_length = \"2 rf sin theta\" } }]\ngears = { wheel = \"rigid\" }",
            "model = \"elastic\"\ncontact = { penalty_n_per_m = 3.5e7, points = \"nodes\", passes = \"both\" }\nparameters = { modes = 20, mesh = \"a.inp\", spin_terms = \"none\" }\ncalibration = { name = \"static\", scene = \"hammer\" }",
            "model = \"elastic\"\ncontact = { law = \"hard\", surface = \"faceted\" }\ngap_m = -1e-7\nintegrators = [{ method = \"generalised-alpha(rho_inf=0.8)\", step_s = 1e-6 }]",
            "model = \"elastic\"\ncontact = { penalty_pa_per_m = 1e15, points = { along = 3, across = 1 } }\ncalibration = \"impact\"",
        ] {
            let text = format!(
                "schema = 1\nname = \"x\"\nduration_s = 1e-3\ntolerance = 0.05\n\
                 reference = {{ csv = \"a.csv\", columns = {{ time = \"t\", speed = {{ pinion = \"n\" }} }}, units = {{ speed = \"1/min\" }}, decimal = \"comma\", role = \"validate\" }}\n\
                 [gears.pinion]\nteeth = 20\nmodule_m = 0.004\nface_width_m = 0.01\n{more}\n\
                 [gears.wheel]\nkind = \"rack\"\nteeth = 9\nmodule_m = 0.004\nface_width_m = 0.01\n\
                 [[meshes]]\ngears = [\"pinion\", \"wheel\"]\nbacklash_m = 1e-5\nstart = {{ flank = \"right\", loaded = true }}\n\
                 [[models]]\n{model}\n[study]\nsweep = {{ points = 3 }}\nquantities = [\"peak_force_n\"]\n\
                 stability = {{ step_s = {{ from = 1e-7, to = 1e-5 }}, axes = [{{ axis = \"damping\", values = [0.0, 1.0] }}] }}\n\
                 [calibration.impact.rigid]\nstiffness_n_per_m2 = 1e10\npinion.tooth_mass_kg = 1e-3\nfitted_to = [\"a\"]\n"
            );
            let tables = SceneTable::parse(&Context::default(), "x.toml", &text)
                .unwrap_or_else(|e| panic!("{}\n{text}", e.to_text()));
            assert_eq!(again("x.toml", &tables), tables);
        }
    }
}

/// A table that a program makes is refused as the file would be: with line, key and way out.
#[test]
fn values_of_programs_are_refused_by_their_text() {
    let mut tables = SceneTable::parse(
        &Context::default(),
        "hammer.toml",
        SHIPPED.iter().find(|s| s.name == "hammer").unwrap().text,
    )
    .unwrap();
    tables.duration_s = Positive(-1.0);
    let e = tables.load(&Context::default()).unwrap_err();
    assert!(e.message().contains("duration_s"), "{}", e.to_text());
    let line = tables.to_toml().unwrap();
    let line = line.lines().position(|l| l.starts_with("duration_s"));
    assert_eq!(e.line(), line.map(|l| l + 1));
    tables.duration_s = Positive(f64::NAN);
    let e = tables.load(&Context::default()).unwrap_err();
    assert!(e.message().contains("finite"), "{}", e.to_text());
}

/// Programs make tables by the descriptions of their keys, and have each checked by the type that reads it.
#[test]
fn tables_are_described_and_checked_alone() {
    let all = tables();
    let gear = all.iter().find(|t| t.name == "GearTable").unwrap();
    let teeth = gear.keys.iter().find(|k| k.name == "teeth").unwrap();
    assert!(teeth.is_required && !teeth.meaning.is_empty());
    let shift = gear.keys.iter().find(|k| k.name == "speed_rad_s").unwrap();
    assert!(!shift.is_required && shift.type_name.starts_with("Option"));
    let check = |kind: &str, text: &str| check_table(kind, "a table", text).unwrap();
    check(
        "GearTable",
        "teeth = 20\nmodule_m = 4e-3\nface_width_m = 0.01",
    )
    .unwrap();
    let e = check(
        "GearTable",
        "teeth = 20\nmodul_m = 4e-3\nface_width_m = 0.01",
    )
    .unwrap_err();
    assert_eq!(e.line(), Some(2));
    assert!(e.help_text().unwrap().contains("module_m"));
    check("MeshTable", "gears = [\"any\", \"other\"]").unwrap();
    check(
        "StiffnessTable",
        "kind = \"constant\"\nstiffness_n_per_m2 = 1e10",
    )
    .unwrap();
    check("GearLoad", "torque_nm = 1.0").unwrap();
    assert!(check_table("NoTable", "a table", "").is_none());
}

/// A scene that a program makes as a table has the text of the table, also where a list has no tables.
#[test]
fn a_table_is_laid_out_as_its_file() {
    let text = "schema = 1\n[gears.a]\nteeth = 20\n[[meshes]]\ngears = [\"a\", \"b\"]\n";
    let document: toml_edit::DocumentMut = text.parse().unwrap();
    let table = document.as_table().clone().into_inline_table();
    assert_eq!(laid_out(table).to_string().replace("\n\n", "\n"), text);
    let wrong: toml_edit::DocumentMut = "models = [\"rigid\"]".parse().unwrap();
    let table = wrong.as_table().clone().into_inline_table();
    assert_eq!(laid_out(table).to_string(), "models = [\"rigid\"]\n");
}

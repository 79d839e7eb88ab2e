//! Tests of `gearbench import` and `gearbench export`: own samples of all forms and versions, the public samples where a
//! folder has them, round trips, and mutations.

#![allow(clippy::print_stdout)]

use super::{Folder, has, stderr};
use gearbench::context::Context;
use gearbench::experiment::machine::timed;
use gearbench::rexs::attributes::{self as key, Attribute};
use gearbench::rexs::import::{ImportOptions, scene};
use gearbench::rexs::read::of_bytes;
use gearbench::rexs::write::{to_json, to_xml};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Two helical stages of version 1.4, as a program writes them: flanks of their own, a tool, a material, a load case.
const GEARBOX: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<model version="1.4" applicationId="sample" applicationVersion="1" date="2026-01-01T00:00:00+00:00">
  <relations>
    <relation id="1" type="stage"><ref id="30" role="stage"/><ref id="10" role="gear_1"/><ref id="11" role="gear_2"/></relation>
    <relation id="2" type="stage"><ref id="31" role="stage"/><ref id="12" role="gear_1"/><ref id="13" role="gear_2"/></relation>
    <relation id="3" type="assembly"><ref id="20" role="assembly"/><ref id="10" role="part"/></relation>
    <relation id="4" type="assembly"><ref id="21" role="assembly"/><ref id="11" role="part"/></relation>
    <relation id="5" type="assembly"><ref id="21" role="assembly"/><ref id="12" role="part"/></relation>
    <relation id="6" type="assembly"><ref id="22" role="assembly"/><ref id="13" role="part"/></relation>
    <relation id="7" type="assembly"><ref id="20" role="assembly"/><ref id="40" role="part"/></relation>
    <relation id="8" type="assembly"><ref id="22" role="assembly"/><ref id="41" role="part"/></relation>
    <relation id="9" type="assembly"><ref id="21" role="assembly"/><ref id="50" role="part"/></relation>
    <relation id="10" type="flank"><ref id="10" role="gear"/><ref id="60" role="left"/><ref id="61" role="right"/></relation>
    <relation id="11" type="manufacturing_step" order="1"><ref id="60" role="workpiece"/><ref id="70" role="tool"/></relation>
    <relation id="12" type="reference"><ref id="60" role="origin"/><ref id="71" role="referenced"/></relation>
    <relation id="13" type="reference"><ref id="10" role="origin"/><ref id="80" role="referenced"/></relation>
    <relation id="14" type="side"><ref id="90" role="assembly"/><ref id="21" role="inner_part"/><ref id="2" role="outer_part"/></relation>
    <relation id="15" type="side"><ref id="91" role="assembly"/><ref id="21" role="inner_part"/><ref id="2" role="outer_part"/></relation>
  </relations>
  <components>
    <component id="2" type="gear_casing" name="casing"/>
    <component id="10" type="cylindrical_gear" name="Ritzel 1">
      <attribute id="number_of_teeth" unit="none">27</attribute><attribute id="normal_module" unit="mm">4.5</attribute>
      <attribute id="helix_angle_reference_diameter" unit="deg">21</attribute><attribute id="face_width" unit="mm">50</attribute>
    </component>
    <component id="11" type="cylindrical_gear" name="Rad 1">
      <attribute id="number_of_teeth" unit="none">51</attribute><attribute id="normal_module" unit="mm">4.5</attribute>
      <attribute id="helix_angle_reference_diameter" unit="deg">-21</attribute><attribute id="face_width" unit="mm">50</attribute>
      <attribute id="u_coordinate_on_shaft" unit="mm">40</attribute>
    </component>
    <component id="12" type="cylindrical_gear" name="Ritzel 2">
      <attribute id="number_of_teeth" unit="none">23</attribute><attribute id="normal_module" unit="mm">6.5</attribute>
      <attribute id="helix_angle_reference_diameter" unit="deg">-10</attribute><attribute id="face_width" unit="mm">74</attribute>
      <attribute id="u_coordinate_on_shaft" unit="mm">140</attribute>
    </component>
    <component id="13" type="cylindrical_gear" name="Rad 2">
      <attribute id="number_of_teeth" unit="none">34</attribute><attribute id="normal_module" unit="mm">6.5</attribute>
      <attribute id="helix_angle_reference_diameter" unit="deg">10</attribute><attribute id="face_width" unit="mm">74</attribute>
    </component>
    <component id="20" type="shaft" name="in"/>
    <component id="21" type="shaft" name="between"/>
    <component id="22" type="shaft" name="out"/>
    <component id="30" type="cylindrical_stage" name="1"><attribute id="center_distance" unit="mm">190</attribute></component>
    <component id="31" type="cylindrical_stage" name="2">
      <attribute id="center_distance" unit="mm">190</attribute><attribute id="rotating_angle_around_neg_u_axis" unit="deg">-30</attribute>
      <attribute id="minimum_normal_backlash" unit="mm">0.1</attribute><attribute id="maximum_normal_backlash" unit="mm">0.3</attribute>
    </component>
    <component id="40" type="external_load" name="input"><attribute id="transmits_torque" unit="none">true</attribute></component>
    <component id="41" type="external_load" name="output"><attribute id="transmits_torque" unit="none">true</attribute></component>
    <component id="50" type="shaft_section" name="">
      <attribute id="u_coordinate_on_shaft" unit="mm">0</attribute><attribute id="length" unit="mm">200</attribute>
      <attribute id="outer_diameter_begin" unit="mm">60</attribute><attribute id="outer_diameter_end" unit="mm">60</attribute>
    </component>
    <component id="60" type="cylindrical_gear_flank" name="left">
      <attribute id="normal_pressure_angle" unit="deg">20</attribute><attribute id="addendum_modification_coefficient" unit="none">0.231415</attribute>
    </component>
    <component id="61" type="cylindrical_gear_flank" name="right">
      <attribute id="normal_pressure_angle" unit="deg">20</attribute><attribute id="addendum_modification_coefficient" unit="none">0.231415</attribute>
    </component>
    <component id="70" type="rack_shaped_tool" name="hob">
      <attribute id="addendum_coefficient_reference_profile" unit="none">1.4</attribute><attribute id="tip_radius_factor" unit="none">0.25</attribute>
    </component>
    <component id="71" type="tip_relief" name="relief">
      <attribute id="tip_relief_depth" unit="mm">0.02</attribute><attribute id="tip_relief_datum_diameter" unit="mm">138</attribute>
    </component>
    <component id="80" type="material" name="iron">
      <attribute id="elastic_modulus" unit="N / mm^2">170000</attribute><attribute id="poisson_ratio" unit="none">0.28</attribute>
      <attribute id="density" unit="kg / dm^3">7.2</attribute>
    </component>
    <component id="90" type="concept_bearing" name="fixed bearing">
      <attribute id="u_coordinate_on_shaft_inner_side" unit="mm">10</attribute><attribute id="radial_stiffness" unit="N / m">5e8</attribute>
      <attribute id="axial_stiffness" unit="N / m">2e8</attribute><attribute id="bending_stiffness" unit="N mm / rad">1e6</attribute>
    </component>
    <component id="91" type="concept_bearing" name="free bearing">
      <attribute id="u_coordinate_on_shaft_inner_side" unit="mm">190</attribute><attribute id="radial_stiffness" unit="N / m">5e8</attribute>
      <attribute id="axial_force_absorption" unit="none">no_direction</attribute>
    </component>
    <component id="99" type="lubricant" name="oil"/>
  </components>
  <load_spectrum id="1">
    <load_case id="1">
      <component id="20" type="shaft" name="in"><attribute id="rotational_speed" unit="1 / min">600</attribute></component>
      <component id="40" type="external_load" name="input"><attribute id="torque_around_u_axis" unit="N m">500</attribute></component>
    </load_case>
    <load_case id="2">
      <component id="20" type="shaft" name="in"><attribute id="rotational_speed" unit="1 / min">1200</attribute></component>
      <component id="40" type="external_load" name="input"><attribute id="torque_around_u_axis" unit="N m">250</attribute></component>
    </load_case>
  </load_spectrum>
</model>
"#;

/// A planetary set of version 1.1: old names, the degree sign, no positions of planets, the ring coupled to the casing.
fn planetary() -> String {
    let mut relations = String::new();
    let mut components = String::new();
    let mut relation = |kind: &str, refs: &[(&str, u32)]| {
        let refs: String = refs
            .iter()
            .map(|(role, id)| format!("<ref id=\"{id}\" role=\"{role}\"/>"))
            .collect();
        let id = relations.matches("<relation ").count() + 1;
        relations += &format!("<relation id=\"{id}\" type=\"{kind}\">{refs}</relation>\n");
    };
    let mut component = |id: u32, kind: &str, attributes: &[(&str, &str, &str)]| {
        let own: String = attributes
            .iter()
            .map(|(name, unit, x)| {
                format!("<attribute id=\"{name}\" unit=\"{unit}\">{x}</attribute>")
            })
            .collect();
        components += &format!(
            "<component id=\"{id}\" type=\"{kind}\" name=\"{kind} {id}\">{own}</component>\n"
        );
    };
    component(1, "gear_casing", &[]);
    component(2, "planetary_stage", &[]);
    component(3, "planet_carrier", &[]);
    component(4, "shaft", &[]);
    relation(
        "planet_carrier_shaft",
        &[("planetary_stage", 2), ("shaft", 4)],
    );
    let gear = |teeth: &'static str| {
        [
            ("number_of_teeth", "none", teeth),
            ("normal_module", "mm", "4.0"),
            ("face_width", "mm", "50.0"),
            ("helix_angle_reference_diameter", "\u{b0}", "0.0"),
        ]
    };
    let shaft_of = [(10, 20), (11, 21), (12, 22), (13, 23), (14, 24)];
    component(10, "cylindrical_gear", &gear("17"));
    for planet in 11..14 {
        component(planet, "cylindrical_gear", &gear("22"));
    }
    component(14, "ring_gear", &gear("61"));
    for (gear, shaft) in shaft_of {
        let speed = [("rotational_speed", "1 / min", "1500.0")];
        component(shaft, "shaft", if gear == 10 { &speed } else { &[] });
        relation("assembly", &[("assembly", shaft), ("part", gear)]);
        let kind = if (11..14).contains(&gear) {
            "planet_shaft"
        } else {
            "central_shaft"
        };
        relation(kind, &[("planetary_stage", 2), ("shaft", shaft)]);
    }
    for (k, planet) in (11..14).enumerate() {
        for (stage, pair) in [(30 + k as u32, [10, planet]), (40 + k as u32, [planet, 14])] {
            component(
                stage,
                "cylindrical_stage",
                &[("center_distance", "mm", "78.0")],
            );
            relation(
                "stage",
                &[("stage", stage), ("gear_1", pair[0]), ("gear_2", pair[1])],
            );
        }
    }
    component(50, "switchable_coupling", &[]);
    relation(
        "side",
        &[("assembly", 50), ("inner_part", 24), ("outer_part", 1)],
    );
    component(
        60,
        "external_load",
        &[
            ("torque_around_u_axis", "N m", "170.0"),
            ("transmits_torque", "none", "true"),
        ],
    );
    component(61, "external_load", &[("transmits_torque", "none", "true")]);
    relation("assembly", &[("assembly", 20), ("part", 60)]);
    relation("assembly", &[("assembly", 4), ("part", 61)]);
    format!(
        "<model version=\"1.1\" applicationId=\"sample\">\n<relations>\n{relations}</relations>\n<components>\n{components}</components>\n</model>\n"
    )
}

/// A zip with one deflated entry.
fn zipped(name: &str, text: &str) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut archive = rawzip::ZipArchiveWriter::new(&mut bytes);
    let file = archive.new_file(name);
    let packed = file.compression_method(rawzip::CompressionMethod::DEFLATE);
    let (mut slot, config) = packed.start().unwrap();
    let encoder = flate2::write::DeflateEncoder::new(&mut slot, flate2::Compression::default());
    let mut to = config.wrap(encoder);
    to.write_all(text.as_bytes()).unwrap();
    let (encoder, descriptor) = to.finish().unwrap();
    encoder.finish().unwrap();
    slot.finish(descriptor).unwrap();
    archive.finish().unwrap();
    bytes
}

fn toml(folder: &Folder, name: &str) -> toml::Table {
    let text = std::fs::read_to_string(folder.at(name)).unwrap();
    text.parse().unwrap()
}

/// A value below keys and indices, separated by points.
fn at<'a>(of: &'a toml::Table, path: &str) -> &'a toml::Value {
    let (first, rest) = path.split_once('.').unwrap_or((path, ""));
    let mut value = &of[first];
    for key in rest.split('.').filter(|k| !k.is_empty()) {
        value = match key.parse::<usize>() {
            Ok(i) => &value[i],
            Err(_) => &value[key],
        };
    }
    value
}

fn number(of: &toml::Table, path: &str) -> f64 {
    let value = at(of, path);
    let whole = value.as_integer().map(|x| x as f64);
    value
        .as_float()
        .or(whole)
        .unwrap_or_else(|| panic!("{path}: {value}"))
}

fn close(a: f64, b: f64) {
    assert!((a - b).abs() <= 1e-9 * b.abs().max(1e-3), "{a} {b}");
}

#[test]
fn a_gearbox_becomes_a_scene() {
    let folder = Folder::new();
    folder.write("box.rexs", GEARBOX);
    let said = folder.says("import box.rexs");
    has(
        &said,
        &[
            "box.toml",
            "load case 1",
            "27/51 teeth, centre distance 190 mm",
            "profile shift",
            "1 other load cases",
            "1 x lubricant",
        ],
    );
    let scene = toml(&folder, "box.toml");
    let of = |path: &str| number(&scene, path);
    assert_eq!(at(&scene, "gears.ritzel_1.teeth").as_integer(), Some(27));
    close(of("gears.ritzel_1.module_m"), 4.5e-3);
    close(of("gears.ritzel_1.helix_angle_deg"), 21.0);
    close(of("gears.ritzel_1.profile_shift"), 0.231415);
    close(of("gears.ritzel_1.dedendum_factor"), 1.4);
    close(of("gears.ritzel_1.tip_radius_factor"), 0.25);
    close(of("gears.ritzel_1.tip_relief.amount_m"), 2e-5);
    close(of("gears.ritzel_1.tip_relief.start_radius_m"), 0.069);
    close(of("gears.ritzel_1.material.young_pa"), 1.7e11);
    close(of("gears.ritzel_1.material.density_kg_m3"), 7200.0);
    // The wheel has no profile shift: it follows from the centre distance; that of the file of Bearinx is the same.
    assert!((of("gears.rad_1.profile_shift") - 0.231415).abs() < 2e-6);
    // Speeds and torques follow from the numbers of teeth.
    let speed = 600.0 * std::f64::consts::PI / 30.0;
    close(of("gears.ritzel_1.speed_rad_s"), speed);
    close(
        of("gears.rad_2.speed_rad_s"),
        speed * 27.0 * 23.0 / (51.0 * 34.0),
    );
    close(of("gears.ritzel_1.loads.0.torque_nm"), 500.0);
    close(
        of("gears.rad_2.loads.0.torque_nm"),
        -500.0 * 51.0 * 34.0 / (27.0 * 23.0),
    );
    close(of("meshes.1.direction_deg"), 30.0);
    // The shaft with two gears has its section.
    close(of("shafts.0.sections.0.diameter_m"), 0.06);
    close(of("shafts.0.carries.1.at_m"), 0.14);
    // The other load case; bearings make the shaft bend.
    has(
        &folder.says("import box.rexs --out two.toml --load-case 2 --bearings"),
        &["load case 2", "2 bearings"],
    );
    let scene = toml(&folder, "two.toml");
    close(number(&scene, "gears.ritzel_1.loads.0.torque_nm"), 250.0);
    let carries = at(&scene, "shafts.0.carries").as_array().unwrap();
    let bearings = carries.iter().filter_map(|s| s.get("bearing"));
    let stiffness: Vec<f64> = bearings
        .flat_map(|b| b["stiffness"].as_array().unwrap())
        .map(|x| x.as_float().unwrap())
        .collect();
    let (fixed, free) = (
        [5e8, 5e8, 2e8, 1e3, 1e3, 0.0],
        [5e8, 5e8, 0.0, 0.0, 0.0, 0.0],
    );
    assert_eq!(stiffness, [fixed, free].concat());
    // The scene runs.
    folder.says("compare box.toml --repeats 1 --any-reference");
    // Its own file is written again, others are not.
    folder.says("import box.rexs");
    folder.write("own.toml", "# mine\n");
    has(
        &stderr(&folder.ends("import box.rexs --out own.toml", 2)),
        &["own.toml", "--force"],
    );
}

#[test]
fn forms_of_a_file_give_equal_scenes() {
    let model = of_bytes(GEARBOX.as_bytes()).unwrap();
    let made = |bytes: &[u8]| {
        let model = of_bytes(bytes).unwrap();
        scene(
            &Context::default(),
            &model,
            "box",
            &ImportOptions::default(),
        )
        .unwrap_or_else(|e| panic!("{}", e.to_text()))
        .scene
    };
    // Load cases are not written: those of the model are its own.
    let mut plain = model.clone();
    plain.load_cases.clear();
    let (xml, json) = (to_xml(&plain), to_json(&plain));
    let first = made(xml.as_bytes());
    for bytes in [
        json.clone().into_bytes(),
        zipped("box.rexs", &xml),
        zipped("box.rexsj", &json),
        format!("\u{feff}{xml}").into_bytes(),
    ] {
        let other = made(&bytes);
        assert_eq!(
            (first.gears.clone(), first.meshes.clone()),
            (other.gears, other.meshes)
        );
        assert_eq!(first.shafts, other.shafts);
    }
}

#[test]
fn a_planetary_set_becomes_a_scene() {
    let folder = Folder::new();
    folder.write("set.rexs", &planetary());
    let said = folder.says("import set.rexs");
    has(
        &said,
        &[
            "planets are spread evenly",
            "inertia of the carrier",
            "17/22 teeth",
            "22/61 teeth",
        ],
    );
    let scene = toml(&folder, "set.toml");
    let speed = 1500.0 * std::f64::consts::PI / 30.0;
    let carrier = at(&scene, "shafts").as_array().unwrap().last().unwrap()["carries"][0].clone();
    close(
        carrier["speed_rad_s"].as_float().unwrap(),
        speed * 17.0 / 78.0,
    );
    close(
        carrier["loads"][0]["torque_nm"].as_float().unwrap(),
        -170.0 * 78.0 / 17.0,
    );
    assert_eq!(carrier["planets"].as_array().unwrap().len(), 3);
    assert_eq!(
        at(&scene, "gears.ring_gear_14.mount").as_str(),
        Some("fixed")
    );
    folder.says("compare set.toml --repeats 1 --any-reference");
}

#[test]
fn what_cannot_be_a_scene_is_refused_with_its_reason() {
    let folder = Folder::new();
    let refused = |text: &str, told: &[&str]| {
        folder.write("bad.rexs", text);
        has(&stderr(&folder.ends("import bad.rexs", 2)), told);
    };
    let with = |from: &str, to: &str| {
        assert!(GEARBOX.contains(from), "{from}");
        GEARBOX.replacen(from, to, 1)
    };
    // The impossible tip diameter of a public sample: 1 mm.
    let tip = "<attribute id=\"number_of_teeth\" unit=\"none\">23</attribute>";
    refused(
        &with(
            tip,
            &format!("{tip}<attribute id=\"tip_diameter\" unit=\"mm\">1</attribute>"),
        ),
        &[
            "component 12",
            "Ritzel 2",
            "`tip_diameter` is 1 mm",
            "root diameter",
            "delete it",
        ],
    );
    refused(
        &with(
            "type=\"cylindrical_gear\" name=\"Rad 1\"",
            "type=\"custom_rack\" name=\"Rad 1\"",
        ),
        &[
            "component 11",
            "no component for racks",
            "gearbench init rack",
        ],
    );
    refused(
        &with(
            "type=\"cylindrical_stage\" name=\"1\"",
            "type=\"worm_stage\" name=\"1\"",
        ),
        &["worm_stage", "no gears of this kind"],
    );
    refused(
        &with("unit=\"mm\">4.5<", "unit=\"furlong\">4.5<"),
        &["`normal_module`", "furlong", "mm"],
    );
    refused(
        &with("unit=\"mm\">4.5<", "unit=\"mm\">wide<"),
        &["`normal_module` is \"wide\"", "number in mm"],
    );
    refused(
        &with(
            "<attribute id=\"normal_module\" unit=\"mm\">4.5</attribute>",
            "",
        ),
        &["has no `normal_module`"],
    );
    refused(
        &with(
            "unit=\"none\">0.231415</attribute>\n    </component>\n    <component id=\"61\"",
            "unit=\"none\">0.3</attribute>\n    </component>\n    <component id=\"61\"",
        ),
        &["differs between the flanks"],
    );
    refused(
        "<model version=\"1.4\"/>",
        &["no stage of cylindrical gears"],
    );
    refused("<model version=\"1.4\">", &["bad.rexs", "REXS 1.0 to 2.0"]);
    folder.write("box.rexs", GEARBOX);
    has(
        &stderr(&folder.ends("import box.rexs --load-case 9", 2)),
        &["no load case 9", "1, 2"],
    );
    has(
        &stderr(&folder.ends("import nowhere.rexs", 2)),
        &["nowhere.rexs"],
    );
    has(
        &stderr(&folder.ends("export rack_pinion --rexs out.rexs", 2)),
        &["a rack", "REXS does not have"],
    );
}

#[test]
fn exported_scenes_are_imported_as_they_were() {
    let folder = Folder::new();
    for (name, end) in [
        ("loaded_mesh", "rexs"),
        ("planetary", "rexsj"),
        ("ring_pair", "rexs"),
        ("driveline", "rexs"),
    ] {
        let said = folder.says(&format!("export {name} --rexs {name}.{end}"));
        has(&said, &[&format!("{name}.{end}"), "stiffness of"]);
        let text = std::fs::read_to_string(folder.at(&format!("{name}.{end}"))).unwrap();
        has(
            &text,
            &[
                "meshing_stiffness_characteristic",
                "rotational_meshing_position",
                "single_stiffness_iso_6336_2019",
            ],
        );
        folder.says(&format!(
            "import {name}.{end} --out {name}.toml --rigid-shafts"
        ));
        let context = Context::default();
        let load = |path: &str| {
            gearbench::scene_file::load_unbuilt(&context, path)
                .unwrap_or_else(|e| panic!("{}", e.to_text()))
        };
        let own = load(name);
        let path = folder.at(&format!("{name}.toml"));
        let other = load(path.to_str().unwrap());
        let mut worst = 0.0_f64;
        for gear in &own.spec.gears {
            let found = other
                .spec
                .gears
                .iter()
                .find(|g| g.name == gear.name)
                .unwrap();
            let bodies = [gear, found].map(|g| match &g.body {
                gearbench_models::spec::Body::Gear(g) => {
                    let p = g.params();
                    [
                        f64::from(p.teeth),
                        g.r_tip(),
                        g.r_root(),
                        g.r_base(),
                        p.profile_shift + 1.0,
                        p.face_width,
                        p.module,
                    ]
                }
                gearbench_models::spec::Body::Rack(_) => panic!("a rack"),
            });
            for (a, b) in bodies[0].iter().zip(bodies[1]) {
                worst = worst.max((a - b).abs() / a.abs());
            }
            let speeds =
                [gear, found].map(|g| gearbench_models::spec::initial_speed(&g.mount, g.speed));
            let planet = own.spec.bodies().any(|b| {
                b.planets
                    .iter()
                    .any(|p| own.spec.gears[*p].name == gear.name)
            });
            if !planet {
                // Speeds of scenes have eight digits, so that teeth and speeds agree to these.
                let error = (speeds[0] - speeds[1]).abs() / speeds[0].abs().max(1.0);
                assert!(error < 1e-7, "{name}, {}: {error:e}", gear.name);
            }
        }
        for (a, b) in own.spec.meshes.iter().zip(&other.spec.meshes) {
            let layouts = [(&own.spec, a), (&other.spec, b)].map(|(spec, mesh)| {
                let gears = mesh.gears.map(|i| &spec.gears[i]);
                gearbench_models::spec::mesh_layout(gears[0], gears[1]).unwrap()
            });
            let [x, y] = layouts.map(|l| [l.distance, l.pair.backlash_normal()]);
            worst = worst
                .max((x[0] - y[0]).abs() / x[0])
                .max((x[1] - y[1]).abs() / x[1]);
        }
        println!("{name}: export and import, largest relative difference {worst:.1e}");
        assert!(worst < 1e-9, "{name}: {worst:e}");
    }
    // Equal scenes give equal files.
    folder.says("export loaded_mesh --rexs again.rexs");
    let read = |name: &str| std::fs::read(folder.at(name)).unwrap();
    assert_eq!(read("loaded_mesh.rexs"), read("again.rexs"));
}

/// A pair with all modifications, one bearing with equal radial stiffness and one with a full matrix.
const CHANGED: &str = r#"
schema = 1
name = "changed"
duration_s = 1e-3
[gears.pinion]
teeth = 19
module_m = 0.003
face_width_m = 0.02
bore_radius_m = 0.012
speed_rad_s = 100.0
loads = [{ torque_nm = 20.0 }]
tip_relief = { amount_m = 1e-5, start_radius_m = 0.0305, shape = "parabolic" }
profile_crowning_m = 2e-6
lead_crowning_m = 3e-6
end_relief = { low = { amount_m = 5e-6, length_m = 2e-3 }, high = { amount_m = 6e-6, length_m = 3e-3, shape = "parabolic" } }
helix_slope_m = { left = 4e-6 }
twist_m = { left = 1e-6, right = -2e-6 }
topography = { unit_m = 1e-6, left = [[0, 1, 0], [0, 0, 0], [2, 3, 2], [1, 1, 4]], radii_m = [0.0275, 0.031], heights_m = [-0.008, 0.009] }
bearing = { stiffness = [2e8, 2e8, 0.0, 0.0, 0.0, 0.0] }
directions = { z = "held", tilt_x = "held", tilt_y = "held" }
[gears.wheel]
teeth = 41
module_m = 0.003
face_width_m = 0.02
bore_radius_m = 0.025
speed_rad_s = -46.341463
loads = [{ torque_nm = 43.157895 }]
bearing = { stiffness_matrix = [[3e8, 1e6, 0.0, 0.0, 2e6, 0.0], [1e6, 4e8, 0.0, 5e5, 0.0, 0.0], [0.0, 0.0, 1e8, 0.0, 0.0, 0.0], [0.0, 5e5, 0.0, 7e5, 0.0, 0.0], [2e6, 0.0, 0.0, 0.0, 8e5, 0.0], [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]] }
[[meshes]]
gears = ["pinion", "wheel"]
backlash_m = 80e-6
[[models]]
model = "rigid"
contact = { stiffness = "compliance", slices = 8 }
[study]
integrators = [{ method = "dopri5", rtol = 1e-6 }]
"#;

#[test]
fn modifications_and_bearings_come_back() {
    let folder = Folder::new();
    folder.write("changed.toml", CHANGED);
    let load = |name: &str| {
        let path = folder.at(name);
        gearbench::scene_file::load_unbuilt(&Context::default(), path.to_str().unwrap())
            .unwrap_or_else(|e| panic!("{}", e.to_text()))
            .spec
    };
    let own = load("changed.toml");
    for end in ["rexs", "rexsj"] {
        let said = folder.says(&format!("export changed.toml --rexs changed.{end}"));
        assert!(!said.contains("left:"), "{said}");
        let said = folder.says(&format!(
            "import changed.{end} --bearings --out again.toml --force"
        ));
        assert!(!said.contains("left:"), "{said}");
        let again = load("again.toml");
        let mut worst = 0.0_f64;
        let mut near = |a: f64, b: f64, scale: f64| worst = worst.max((a - b).abs() / scale);
        for (a, b) in own.gears.iter().zip(&again.gears) {
            let [m, n] = [a, b].map(|g| match &g.body {
                gearbench_models::spec::Body::Gear(g) => g.params().modifications.clone(),
                gearbench_models::spec::Body::Rack(_) => panic!("a rack"),
            });
            let list = |m: &gearbench_models::geometry::Modifications| {
                let relief = m.tip_relief.iter().flat_map(|r| [r.amount, r.start_radius]);
                let ends = m
                    .end_relief
                    .iter()
                    .flatten()
                    .flat_map(|e| [e.amount, e.length]);
                let grids = m.topography.iter().flatten();
                let grids = grids.flat_map(|t| {
                    let corners = [t.radii().unwrap(), t.heights().unwrap()].concat();
                    t.rows()
                        .flatten()
                        .copied()
                        .chain(corners)
                        .collect::<Vec<_>>()
                });
                let all = [m.profile_crowning, m.lead_crowning];
                let all = all.into_iter().chain(m.helix_slope).chain(m.twist);
                all.chain(relief)
                    .chain(ends)
                    .chain(grids)
                    .collect::<Vec<f64>>()
            };
            let [x, y] = [&m, &n].map(list);
            assert_eq!(x.len(), y.len(), "{end}, {}: {x:?} {y:?}", a.name);
            x.iter()
                .zip(&y)
                .for_each(|(x, y)| near(*x, *y, 1e-6_f64.max(x.abs())));
            let shapes = |m: &gearbench_models::geometry::Modifications| {
                let ends = m.end_relief.map(|e| e.map(|e| e.shape));
                (m.tip_relief.map(|r| r.shape), ends)
            };
            assert_eq!(shapes(&m), shapes(&n));
            let [p, q] = [a, b].map(|g| g.lateral.clone().unwrap());
            assert_eq!(p.directions, q.directions, "{end}, {}", a.name);
            for (x, y) in p
                .bearing
                .stiffness
                .iter()
                .flatten()
                .zip(q.bearing.stiffness.iter().flatten())
            {
                near(*x, *y, 1e8);
            }
        }
        println!("{end}: modifications and bearings, largest relative difference {worst:.1e}");
        assert!(worst < 1e-12, "{end}: {worst:e}");
    }
    // Without the option the axes are fixed.
    folder.says("import changed.rexs --out fixed.toml");
    assert!(load("fixed.toml").gears.iter().all(|g| g.lateral.is_none()));
}

#[test]
fn exported_stiffness_is_that_of_the_study() {
    let folder = Folder::new();
    for (scene, model, torque) in [
        ("loaded_mesh", "rigid", 94.1),
        ("loaded_mesh", "movable-teeth", 94.1),
    ] {
        let said = folder.says(&format!(
            "export {scene} --model {model} --rexs {model}.rexs"
        ));
        has(&said, &[&format!("stiffness of {model}")]);
        folder.says(&format!(
            "stiffness {scene} --models {model} --torque {torque} --positions 24 --out {model}"
        ));
        let record: serde_json::Value =
            serde_json::from_str(&folder.read(&format!("{model}/results.json"))).unwrap();
        let study = record["stiffness"].as_array().unwrap();
        let study = study.iter().find(|m| m["label"] == model).unwrap();
        let number = |of: &serde_json::Value, key: &str| of[key].as_f64().unwrap();
        let file = of_bytes(folder.read(&format!("{model}.rexs")).as_bytes()).unwrap();
        let list = |kind: &str, attribute: &Attribute| {
            file.of_kind(kind).find_map(|c| c.list(attribute)).unwrap()
        };
        let curve = list("cylindrical_stage", &key::MESH_STIFFNESS_CURVE);
        let angles = list("cylindrical_stage_gear_data", &key::MESHING_POSITION);
        let positions = study["positions"].as_array().unwrap();
        assert_eq!([positions.len(), curve.len(), angles.len()], [24; 3]);
        // Each angle of the file, as a place on the path of contact of the study.
        let per_angle = number(study, "base_pitch_m") * 16.0 / std::f64::consts::TAU;
        let mut worst = 0.0_f64;
        for (angle, stiffness) in angles.iter().zip(&curve) {
            let s = number(study, "pitch_point_m") + per_angle * angle;
            let at = |p: &&serde_json::Value| (number(p, "path_coordinate_m") - s).abs();
            let own = positions
                .iter()
                .min_by(|a, b| at(a).total_cmp(&at(b)))
                .unwrap();
            assert!(at(&own) < 1e-12, "{angle}: {}", at(&own));
            worst = worst.max((stiffness / number(own, "tangent_n_per_m") - 1.0).abs());
        }
        println!(
            "{scene}, {model}: stiffness of file and study, largest relative difference {worst:.1e}"
        );
        assert!(worst < 1e-12, "{worst:e}");
        let stage = file.of_kind("cylindrical_stage").next().unwrap();
        let iso = record["stiffness"].as_array().unwrap().iter();
        let iso = iso.clone().find(|m| m["label"] == "ISO 6336-1").unwrap();
        for (attribute, name) in [
            (&key::SINGLE_STIFFNESS, "single_stiffness_n_per_m2"),
            (&key::MESH_STIFFNESS, "mesh_stiffness_n_per_m2"),
        ] {
            let own = stage.number(attribute).unwrap().unwrap();
            assert!((own / number(iso, name) - 1.0).abs() < 1e-12);
        }
    }
}

/// Files below a folder whose names end as those of REXS.
fn samples(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        let name = path.to_string_lossy().to_lowercase();
        if path.is_dir() {
            samples(&path, found);
        } else if [".rexs", ".rexsj", ".rexsz", ".rexs.zip"]
            .iter()
            .any(|e| name.ends_with(e))
        {
            found.push(path);
        }
    }
}

/// The public samples, where `GEARBENCH_REXS_SAMPLES` names a folder with them: copies of `fva-net/rexs-api-java` and
/// `BearinxSimulationSuite/REXSapi` on GitHub.
#[test]
fn public_samples_are_read() {
    let Ok(folder) = std::env::var("GEARBENCH_REXS_SAMPLES") else {
        println!("left out: GEARBENCH_REXS_SAMPLES names no folder with public samples");
        return;
    };
    let mut all = Vec::new();
    samples(Path::new(&folder), &mut all);
    assert!(all.len() >= 5, "{} samples in {folder}", all.len());
    let mut read = 0;
    for path in all {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let bytes = std::fs::read(&path).unwrap();
        let made = of_bytes(&bytes).and_then(|model| {
            let options = ImportOptions::default();
            scene(&Context::default(), &model, "sample", &options)
        });
        let refused = |why: &str| {
            let e = made.as_ref().map(|_| ()).unwrap_err();
            assert!(e.message().contains(why), "{name}: {}", e.message());
            println!("{name}: refused, {}", e.message());
        };
        if name.contains("Industriegetriebe") {
            refused("`tip_diameter` is 1 mm");
            // Without that attribute the gearbox is read.
            if name.ends_with(".rexs") {
                let text = String::from_utf8(bytes).unwrap();
                let line = text
                    .lines()
                    .find(|l| l.contains("\"tip_diameter\""))
                    .unwrap();
                let model = of_bytes(text.replace(line, "").as_bytes()).unwrap();
                let options = ImportOptions::default();
                let found = scene(&Context::default(), &model, "sample", &options).unwrap();
                near(&name, &found.distances, 2);
            }
        } else if name.contains("worm") {
            refused("no gears of this kind");
        } else if name.contains("no_rexs") {
            assert!(made.is_err());
        } else if name.contains("SEW") || name.contains("Planetary") {
            let found = made.unwrap_or_else(|e| panic!("{name}: {}", e.to_text()));
            near(
                &name,
                &found.distances,
                if name.contains("SEW") { 3 } else { 6 },
            );
            read += 1;
        } else if let Err(e) = made {
            println!("{name}: refused, {}", e.message());
        }
    }
    assert!(read >= 2, "{read} gearboxes were read");
}

/// Centre distances agree with profile shifts to the digits of the files.
fn near(name: &str, distances: &[f64], count: usize) {
    let worst = distances.iter().fold(0.0_f64, |x, d| x.max(d.abs()));
    println!(
        "{name}: {} stages, centre distances within {:.1e} mm",
        distances.len(),
        1e3 * worst
    );
    assert_eq!(distances.len(), count);
    // The profile shifts of the file of SEW have four digits: 57.0000548 mm for 57 mm.
    assert!(worst < 6e-8, "{worst:e}");
}

/// Random numbers: xorshift64* (S. Vigna, ACM TOMS 42, 2016).
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        ((self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) % n.max(1) as u64) as usize
    }
}

/// Mutations of samples by a seed: bytes, cut, doubled and swapped parts, numbers at their limits.
fn mutated(of: &[u8], random: &mut Random) -> Vec<u8> {
    const NUMBERS: [&str; 10] = [
        "0",
        "-1",
        "1e308",
        "-1e308",
        "1e-308",
        "NaN",
        "inf",
        "4294967296",
        "",
        "\u{221e}",
    ];
    let mut bytes = of.to_vec();
    for _ in 0..=random.below(4) {
        let n = bytes.len();
        let (i, j) = (random.below(n), random.below(n));
        let (a, b) = (i.min(j), i.max(j).min(i.min(j) + 4000));
        match random.below(6) {
            0 if n > 0 => bytes[i] ^= 1 << random.below(8),
            1 => drop(bytes.drain(a..b)),
            2 => {
                let part = bytes[a..b].to_vec();
                bytes.splice(i..i, part);
            }
            3 | 4 => {
                // A number between `>` and `<` becomes another one.
                let starts: Vec<usize> = (0..n).filter(|k| bytes[*k] == b'>').collect();
                if starts.is_empty() {
                    continue;
                }
                let start = starts[random.below(starts.len())] + 1;
                let end = (start..n).find(|k| bytes[*k] == b'<').unwrap_or(n);
                let number = NUMBERS[random.below(NUMBERS.len())];
                bytes.splice(start..end, number.bytes());
            }
            _ => bytes.truncate(i),
        }
    }
    bytes
}

/// No file makes the import panic or run without bound. `GEARBENCH_REXS_FILES` lengthens the test, `GEARBENCH_REXS_SEED`
/// starts it elsewhere, `GEARBENCH_REXS_SAMPLES` adds the public samples.
#[test]
fn rexs_survives_mutated_files() {
    let read = |name: &str, usual: u64| {
        std::env::var(name)
            .ok()
            .and_then(|x| x.parse().ok())
            .unwrap_or(usual)
    };
    let files = read("GEARBENCH_REXS_FILES", 200);
    let mut random = Random(read("GEARBENCH_REXS_SEED", 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
    let model = of_bytes(GEARBOX.as_bytes()).unwrap();
    let mut seeds = vec![
        GEARBOX.as_bytes().to_vec(),
        planetary().into_bytes(),
        to_json(&model).into_bytes(),
        zipped("box.rexs", GEARBOX),
    ];
    if let Ok(folder) = std::env::var("GEARBENCH_REXS_SAMPLES") {
        let mut paths = Vec::new();
        samples(Path::new(&folder), &mut paths);
        seeds.extend(paths.iter().map(|path| std::fs::read(path).unwrap()));
    }
    let context = Context::default();
    let (mut scenes, mut slowest) = (0, 0.0_f64);
    for count in 0..files {
        let seed = &seeds[random.below(seeds.len())];
        let bytes = mutated(seed, &mut random);
        let options = ImportOptions {
            bearings: count % 3 == 0,
            ..ImportOptions::default()
        };
        // Processor time, which other work on the machine does not lengthen.
        let (made, spent) = timed(|| {
            of_bytes(&bytes).and_then(|model| scene(&context, &model, "mutated", &options))
        });
        scenes += usize::from(made.is_ok());
        slowest = slowest.max(spent);
    }
    println!("{files} mutated files, {scenes} scenes, slowest {slowest:.3} s");
    assert!(
        files > 0 && slowest < 20.0,
        "{files} files, {slowest} s of processor time"
    );
}

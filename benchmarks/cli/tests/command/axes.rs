//! Tests that every command that reads a scene refuses crossed cylindrical gears.

use super::Folder;

const SCENE: &str = r#"schema = 1
name = "crossed"
duration_s = 1e-3
gears.pinion = { teeth = 20, module_m = 0.004, face_width_m = 0.01, axis = [0.0, 0.0, 1.0], speed_rad_s = 20.0, loads = [{ torque_nm = 10.0 }] }
gears.wheel = { teeth = 30, module_m = 0.004, face_width_m = 0.01, axis = [0.0, 0.17364817766693033, 0.984807753012208], speed_rad_s = -13.333333333333334, loads = [{ torque_nm = 15.0 }] }
meshes = [{ gears = ["pinion", "wheel"], centre_distance_m = 0.1001, start = { flank = "left", gap_m = 0.0 } }]
models = [{ model = "rigid", contact = { stiffness = "iso6336" } }, { model = "elastic", parameters = { modes = 2 }, contact = { penalty_pa_per_m = 1e15 } }]
"#;

#[test]
fn every_command_refuses_crossed_cylindrical_gears() {
    let folder = Folder::new();
    folder.write("c.toml", SCENE);
    let commands = "compare|stiffness|sweep|response|modes|stability|run-up|coupling|precision|penalty|truncation|choose|\
                    identify|mesh|reference|fmu --model rigid --out c.fmu";
    for command in commands.split('|') {
        let mut words = command.splitn(2, ' ');
        let (name, rest) = (words.next().unwrap(), words.next().unwrap_or(""));
        let arguments = match name {
            "reference" => "reference c.toml --model rigid --out c.csv".to_owned(),
            _ => format!("{name} c.toml {rest}"),
        };
        let line = ["c.toml:5:", "10.0000 degrees", "crossed gears"];
        folder.refuses(&arguments, &line);
    }
    assert_eq!(folder.files(), 1, "nothing is written");
}

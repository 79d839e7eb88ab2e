//! Tables of common formats, and refusals.

use super::*;
use std::f64::consts::PI;

/// Returns a helical pinion and a wheel, or a rack.
fn subjects(base_helix: f64, rack: Option<f64>) -> Subjects {
    let gear = |name: &str, slides| GearSubject {
        name: name.into(),
        slides,
        toothed: true,
    };
    let motor = GearSubject {
        toothed: false,
        ..gear("motor", None)
    };
    Subjects {
        gears: vec![gear("pinion", None), gear("wheel", rack), motor],
        spans: vec![["motor", "pinion"].map(Into::into)],
        meshes: vec![MeshSubject {
            gears: ["pinion", "wheel"].map(Into::into),
            base_helix,
            base_radius: Some(0.05),
        }],
        turning: None,
    }
}

/// A table over the angle of rotation of the first gear, or over mesh cycles, is converted to one over time by its
/// speed.
#[test]
fn angles_of_rotation_and_mesh_cycles_are_times() {
    let turning = |speed| Subjects {
        turning: Some(Turning { speed, teeth: 20 }),
        ..subjects(0.0, None)
    };
    let of = |head: &str, speed| {
        let text = format!("{head},transmission_error [um]\n0,1\n0.5,2\n1,3\n");
        read(&text, &Request::default(), &turning(speed))
    };
    let times = |r: &Reference| {
        r.channel(Quantity::TransmissionError(0))
            .unwrap()
            .time
            .clone()
    };
    for (head, last) in [
        ("roll_angle [deg]", std::f64::consts::PI / 180.0 / 50.0),
        ("roll_angle_rad", 1.0 / 50.0),
        ("mesh_cycle", std::f64::consts::TAU / 20.0 / 50.0),
        ("t [ms]", 1e-3),
    ] {
        // The direction of rotation does not matter.
        for speed in [50.0, -50.0] {
            let found = of(head, speed).unwrap();
            near(&times(&found), &[0.0, 0.5 * last, last]);
        }
    }
    let e = of("roll_angle [deg]", 0.0).unwrap_err().to_string();
    assert!(e.contains("constant speed"), "{e}");
    let e = of("roll_angle [kN]", 50.0).unwrap_err().to_string();
    assert!(e.contains("cycle"), "{e}");
}

fn spur(text: &str, request: &Request) -> Result<Reference, TableError> {
    read(text, request, &subjects(0.0, None))
}

fn plain(text: &str) -> Result<Reference, TableError> {
    spur(text, &Request::default())
}

fn values(r: &Reference, quantity: Quantity) -> (&[f64], &[f64]) {
    let found = r.channel(quantity).unwrap();
    (&found.time, &found.value)
}

fn near(found: &[f64], wanted: &[f64]) {
    assert_eq!(found.len(), wanted.len(), "{found:?}");
    let off = |(a, b): (&f64, &f64)| (a - b).abs() > 1e-12 * b.abs();
    assert!(!found.iter().zip(wanted).any(off), "{found:?} {wanted:?}");
}

/// The table of the issue: units from the header, columns by their names.
#[test]
fn a_measured_press() {
    let text = "# rig 7\n\nt [ms];Fn [kN];n1 [1/min];note\n0,0;0;190,9859317;a\n0,5;1,5;180;b\n\n1,0;0;170;c\n";
    let request = Request {
        time: Some("t [ms]".into()),
        columns: vec![
            (Quantity::Force(0), "Fn [kN]".into()),
            (Quantity::Speed(0), "n1".into()),
        ],
        ..Request::default()
    };
    let found = spur(text, &request).unwrap();
    let (time, force) = values(&found, Quantity::Force(0));
    near(time, &[0.0, 5e-4, 1e-3]);
    near(force, &[0.0, 1500.0, 0.0]);
    let (_, speed) = values(&found, Quantity::Speed(0));
    assert!((speed[0] - 20.0).abs() < 1e-8, "{speed:?}");
    let told = found.processing.join("\n");
    for word in [
        "3 rows",
        "semicolon",
        "decimal commas",
        "kN",
        "normal force",
        "`note`",
    ] {
        assert!(told.contains(word), "{word}\n{told}");
    }
}

/// Columns of gearbench and of other programs are recognised by their names without settings.
#[test]
fn columns_are_known_by_their_names() {
    let own = "time_s,contact_force_n,omega1_rad_s,omega2_rad_s,hub_angle_pinion_rad,transmission_error_m\n\
        0,1,20,0,0,1e-6\n1,2,19,0,0.5,2e-6\n2,3,18,0,0.6,3e-6\n";
    let found = plain(own).unwrap();
    let all: Vec<Quantity> = found.channels.iter().map(|c| c.quantity).collect();
    use Quantity::{Angle, Force, Speed, TransmissionError};
    assert_eq!(
        all,
        [Force(0), TransmissionError(0), Speed(0), Angle(0), Speed(1)]
    );
    // Names of gears come before names without, which are of the first mesh.
    let named = "time_s,contact_force_n,contact_force_pinion_wheel_n,transverse_force_pinion_wheel_n,speed_wheel_rad_s\n\
        0,1,4,4,0\n1,2,5,5,1\n2,3,6,6,2\n";
    let found = plain(named).unwrap();
    near(values(&found, Force(0)).1, &[4.0, 5.0, 6.0]);
    near(values(&found, Speed(1)).1, &[0.0, 1.0, 2.0]);
    let units_below = "t\tforce\tspeed pinion\nms\tkN\trpm\n0\t1\t30\n1\t2\t60\n2\t3\t90\n";
    let found = plain(units_below).unwrap();
    near(values(&found, Speed(0)).1, &[PI, 2.0 * PI, 3.0 * PI]);
    near(values(&found, Force(0)).0, &[0.0, 1e-3, 2e-3]);
    let excel = "sep=;\r\n\"t (us)\";\"force (N)\"\r\n0;1\r\n1;2\r\n2;3\r\n";
    near(
        values(&plain(excel).unwrap(), Force(0)).0,
        &[0.0, 1e-6, 2e-6],
    );
    let (text, latin) = decode(b"t [\xb5s],force [N]\n0,1\n1,2\n2,3\n").unwrap();
    assert!(latin);
    near(
        values(&plain(&text).unwrap(), Force(0)).0,
        &[0.0, 1e-6, 2e-6],
    );
    let (text, latin) = decode("\u{feff}t [µs],force [N]\n0,1\n1,2\n2,3\n".as_bytes()).unwrap();
    assert!(!latin);
    near(
        values(&plain(&text).unwrap(), Force(0)).0,
        &[0.0, 1e-6, 2e-6],
    );
}

/// A transverse force becomes the normal one by the base helix angle, whether the user or the header declares it; a
/// normal one is unchanged.
#[test]
fn transverse_forces_become_normal_ones() {
    let beta = 16.9_f64.to_radians();
    let read_as = |header: &str, kind| {
        let text = format!("t [s],{header}\n0,1\n1,2\n2,3\n");
        let request = Request {
            force_kind: kind,
            ..Request::default()
        };
        let found = read(&text, &request, &subjects(beta, None)).unwrap();
        let told = found.processing.join("\n");
        (values(&found, Quantity::Force(0)).1[2], told)
    };
    let (force, told) = read_as("force [N]", Some(ForceKind::Transverse));
    assert!((force - 3.0 / beta.cos()).abs() < 1e-12 && told.contains("cos(beta_b)"));
    assert_eq!(read_as("contact_force_transverse_n", None).0, force);
    let (force, told) = read_as("force [N]", None);
    assert!(
        force == 3.0 && told.contains("read as the normal force"),
        "{told}"
    );
}

/// The speed of a rack may be given as the angular velocity of its mate.
#[test]
fn angular_velocities_of_racks() {
    let read_as = |header: &str| {
        let text = format!("t [s],{header}\n0,1\n1,2\n2,3\n");
        let found = read(&text, &Request::default(), &subjects(0.0, Some(0.02))).unwrap();
        values(&found, Quantity::Speed(1)).1[2]
    };
    assert_eq!(read_as("speed_wheel [mm/s]"), 3e-3);
    assert_eq!(read_as("speed_wheel_m_s"), 3.0);
    assert!((read_as("omega2_rad_s") - 0.06).abs() < 1e-15);
}

/// Cells that are empty are samples that a history does not have.
#[test]
fn columns_have_times_of_their_own() {
    let found = plain("t [s],force [N],speed1 [rad/s]\n0,1,\n1,,5\n2,3,6\n3,4,7\n").unwrap();
    near(values(&found, Quantity::Force(0)).0, &[0.0, 2.0, 3.0]);
    near(values(&found, Quantity::Speed(0)).0, &[1.0, 2.0, 3.0]);
    assert_eq!(found.end(), 3.0);
}

/// Refusals have line, column, expected and actual content.
#[test]
fn refusals_say_where_and_what() {
    let head = "t [ms],force [N]\n0,1\n1,2\n";
    for (text, line, words) in [
        (String::new(), 1, "a table|nothing"),
        ("# only a comment\n".into(), 2, "a table|nothing"),
        ("0,1\n1,2\n2,3\n".into(), 1, "a line of names|numbers only"),
        (
            "a,b\n0,1\n1,2\n2,3\n".into(),
            1,
            "a column of time|`a`, `b`",
        ),
        ("t [s],b\n0,1\n1,2\n2,3\n".into(), 1, "a contact force"),
        (
            "t,force [N]\n0,1\n1,2\n2,3\n".into(),
            1,
            "column 1 `t`|a unit of time: s, ms|none in",
        ),
        ("t [h],force [N]\n0,1\n".into(), 1, "a unit of time|`h`"),
        (
            "t [s],force [kg]\n0,1\n".into(),
            1,
            "a unit of contact force: N, kN|`kg`",
        ),
        (
            format!("{head}2,x\n"),
            4,
            "column 2 `force [N]`|a number|`x`",
        ),
        (
            format!("# a\n{head}\n# b\n2,nan\n"),
            7,
            "a finite number|`nan`",
        ),
        (format!("{head}2,1e999\n"), 4, "a finite number|`1e999`"),
        (format!("{head},5\n"), 4, "column 1|a time|an empty cell"),
        (
            format!("{head}1,5\n"),
            4,
            "column 1|after|the same time again",
        ),
        (
            format!("{head}0.5,5\n"),
            4,
            "column 1|after|an earlier time",
        ),
        (
            format!("{head}2,5,6\n"),
            4,
            "2 cells, the number of names|3 cells",
        ),
        (head.into(), 1, "at least 3 samples|2"),
        (format!("{head}\"2\n3,4\n"), 4, "cells within one line"),
        ("t [ms];force [N]\n0;1\n1;1.234,5\n".into(), 3, "thousands"),
        (
            "t [ms];force [N]\n0;1,5\n1;1.5\n".into(),
            3,
            "a decimal comma, like the numbers before it",
        ),
    ] {
        let e = plain(&text).unwrap_err();
        let told = e.to_string();
        assert_eq!(e.line, line, "{text}\n{told}");
        for word in words.split('|') {
            assert!(told.contains(word), "{word}\n{told}");
        }
        assert!(e.at.end <= text.len() && e.at.start <= e.at.end, "{text}");
        assert!(!e.help.is_empty(), "{told}");
    }
    for (bytes, word) in [
        (&b"\xff\xfet\0"[..], "UTF-16"),
        (b"PK\x03\x04\0\0", "binary"),
    ] {
        assert!(decode(bytes).unwrap_err().to_string().contains(word));
    }
    let missing = Request {
        columns: vec![(Quantity::Force(0), "Fn".into())],
        ..Request::default()
    };
    let e = spur(head, &missing).unwrap_err();
    assert!(e.to_string().contains("one column called `Fn`") && e.help.contains("`force [N]`"));
    let twice = Request {
        columns: vec![(Quantity::Force(0), "t".into())],
        ..Request::default()
    };
    assert!(spur(head, &twice).is_err());
}

/// The refusal marks the invalid cell.
#[test]
fn refusals_point_to_the_cell() {
    let text = "t [ms],force [N]\r\n0,1\r\n1,2\r\n\r\n2,bad\r\n";
    let e = plain(text).unwrap_err();
    assert_eq!((e.line, &text[e.at.clone()]), (5, "bad"));
}

/// A file may state its conditions, as `gearbench reference` writes them.
#[test]
fn files_state_their_conditions() {
    let text = "# command: gearbench reference\n# gears.pinion.speed_rad_s = 60\n# remark = 3\n# gears.x = nan\nt [s],force [N]\n0,1\n1,2\n2,3\n";
    let found = plain(text).unwrap();
    assert_eq!(
        found.stated,
        [("gears.pinion.speed_rad_s".to_owned(), 60.0)]
    );
}

/// `1,000` between quotes in a comma-separated table is refused as ambiguous, because it may be a thousand.
#[test]
fn thousands_are_no_decimals() {
    let text = "time [s],force [N]\n0,\"1,000\"\n1,\"2,000\"\n2,\"3,000\"\n";
    let e = plain(text).unwrap_err();
    assert!(e.expected.contains("thousands separators"), "{e}");
    let decimal = Request {
        decimal_comma: Some(true),
        ..Request::default()
    };
    let found = spur(text, &decimal).unwrap();
    near(values(&found, Quantity::Force(0)).1, &[1.0, 2.0, 3.0]);
    let other = "time [s],force [N]\n0,\"1,5\"\n1,\"2,5\"\n2,\"3,5\"\n";
    near(
        values(&plain(other).unwrap(), Quantity::Force(0)).1,
        &[1.5, 2.5, 3.5],
    );
}

#[test]
fn a_moving_average_fits_into_its_table() {
    let request = Request {
        processing: Processing {
            moving_average: Some(1e300),
            ..Processing::default()
        },
        ..Request::default()
    };
    let e = spur("time [s];force [N]\n0;1\n1;2\n2;3\n", &request).unwrap_err();
    assert!(e.expected.contains("at most 2e0 s"), "{e}");
}

/// Bodies have speeds and angles by name but no number and no contact torque; torques of shafts have both names.
#[test]
fn bodies_and_shafts_have_columns() {
    let text = "time_s,speed_motor [1/min],shaft_torque_motor_pinion_nm,torque_motor_nm,omega3_rad_s\n\
                0,30,1,5,7\n1,60,2,5,7\n2,90,3,5,7\n";
    let found = read(text, &Request::default(), &subjects(0.0, None)).unwrap();
    let speed = found.channel(Quantity::Speed(2)).unwrap();
    assert!((speed.value[1] - std::f64::consts::TAU).abs() < 1e-12);
    assert_eq!(
        found.channel(Quantity::ShaftTorque(0)).unwrap().value,
        [1.0, 2.0, 3.0]
    );
    assert_eq!(found.channels.len(), 2);
}

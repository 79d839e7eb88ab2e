//! `[study] stability`: what is read, and refusals by line.

use super::{BASE, changed, parse, read, render};
use crate::studies::stability::axis::Axis;

const SET: &str = r#"
[[study.stability]]
models = ["rigid"]
integrators = ["rk4", "generalised-alpha(rho_inf=0.5)"]
duration_s = 5e-5
step_s = { from = 1e-7, to = 1e-5, points = 5 }
axes = [{ axis = "damping", values = [0.2, 0.0] }, { axis = "speed", from = 0.5, to = 2.0, points = 3 }]
max_steps = 1000
"#;

#[test]
fn a_set_is_read() {
    let scene = parse(&format!("{BASE}{SET}")).unwrap_or_else(|e| panic!("{}", render(&e)));
    let [set] = scene.study.stability.as_slice() else {
        panic!("{:?}", scene.study.stability)
    };
    assert_eq!(set.models.as_deref(), Some(&["rigid".to_owned()][..]));
    assert_eq!(set.integrators.as_ref().map(Vec::len), Some(2));
    assert_eq!((set.duration, set.max_steps), (Some(5e-5), Some(1000)));
    assert_eq!(set.steps.map(|s| s.values().len()), Some(5));
    assert_eq!(set.axes[0].values, [0.0, 0.2]);
    assert_eq!(
        (set.axes[1].axis, set.axes[1].values.len()),
        (Axis::Speed, 3)
    );
    assert!((set.axes[1].values[1] - 1.0).abs() < 1e-12);
}

#[test]
fn one_set_needs_no_list() {
    let scene = read(
        "[study]\n",
        "[study]\nstability = { axes = [{ axis = \"contact-stiffness\" }] }\n",
    );
    let set = &scene.study.stability[0];
    assert_eq!(set.axes[0].values, Axis::ContactStiffness.defaults());
    assert!(set.models.is_none() && set.steps.is_none());
    assert!(parse(BASE).is_ok_and(|s| s.study.stability.is_empty()));
}

#[test]
fn refusals_name_the_line() {
    let first = BASE.lines().count();
    for (from, to, line, words) in [
        (
            "models = [\"rigid\"]",
            "models = [\"rigit\"]",
            3,
            ["did you mean `rigid`", "rigit"],
        ),
        ("\"rk4\"", "\"rk5\"", 4, ["no integrator `rk5`", "rk4"]),
        ("rho_inf=0.5", "rho_inf=5", 4, ["outside", "brackets"]),
        (
            "duration_s = 5e-5",
            "duration_s = 0",
            5,
            ["`duration_s` is 0", "more than 0"],
        ),
        (
            "to = 1e-5",
            "to = 1e-8",
            6,
            ["has not begun", "smaller value as `from`"],
        ),
        ("points = 5", "points = 1", 6, ["`points` is 1", "2 to 400"]),
        (
            "from = 1e-7, ",
            "",
            6,
            ["`from` is missing", "smallest value"],
        ),
        ("step_s", "step", 6, ["unknown key `step`", "step_s"]),
        (
            "\"damping\"",
            "\"dampin\"",
            7,
            ["did you mean `damping`", "not known"],
        ),
        (
            "0.2, 0.0",
            "0.2, 1.5",
            7,
            ["damping ratio 1.5 cannot be", "0 to 0.999"],
        ),
        (
            "values = [0.2, 0.0]",
            "values = [0.2], to = 1.0",
            7,
            ["both given", "and this"],
        ),
        (
            "\"speed\", from = 0.5, to = 2.0, points = 3",
            "\"damping\", values = [0.1]",
            7,
            ["stands twice", "leave it out"],
        ),
        (
            "\"speed\", from = 0.5",
            "\"speed\", from = 0.0",
            7,
            ["`from` is 0", "more than 0"],
        ),
        (
            "max_steps = 1000",
            "max_steps = 0",
            8,
            ["`max_steps` is 0", "at least 1"],
        ),
    ] {
        assert!(SET.contains(from), "{from}");
        let text = format!("{BASE}{}", SET.replacen(from, to, 1));
        let error = match parse(&text) {
            Ok(_) => panic!("`{to}` was accepted"),
            Err(e) => e,
        };
        let shown = render(&error);
        assert_eq!(error.line(), Some(first + line), "{to}\n{shown}");
        for word in words {
            assert!(shown.contains(word), "no `{word}` in\n{shown}");
        }
        assert!(error.help_text().is_some(), "no way out in\n{shown}");
    }
    let three = "{ axis = \"modes\" }, { axis = \"speed\" }, { axis = \"damping\" }";
    let text = changed(
        "[study]\n",
        &format!("[study]\nstability = {{ axes = [{three}] }}\n"),
    );
    let shown = render(&parse(&text).unwrap_err());
    assert!(shown.contains("one or two"), "{shown}");
}

//! Reading of the table `[study] stability`.

use super::{BASE, STABILITY, parse, read, render};
use crate::studies::stability::axis::Axis;

#[test]
fn a_set_is_read() {
    let scene = parse(&format!("{BASE}{STABILITY}")).unwrap_or_else(|e| panic!("{}", render(&e)));
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

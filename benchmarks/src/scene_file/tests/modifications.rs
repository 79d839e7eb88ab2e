//! Flanks that vary over the width.

use super::{BASE, toothing_of};
use crate::context::Context;
use crate::scene_file::{Origin, SceneFile};
use gearbench_models::geometry::{ReliefShape, Side};

/// Flanks that vary over the width, with a grid in the file and one beside it.
#[test]
fn flanks_that_vary_over_the_width() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(
        folder.path().join("flank.csv"),
        "# um\n0; 1,5; 0\n\n2; 3; 4\n",
    )
    .unwrap();
    let keys = "teeth = 20\nhelix_slope_m = { left = 8e-6 }\ntwist_m = -5e-6\n\
                end_relief = { high = { amount_m = 1e-5, length_m = 2e-3, shape = \"parabolic\" } }\n\
                topography = { unit_m = 1e-6, left = \"flank.csv\", right = [[0, 1], [2, 3]], heights_m = [-4e-3, 4e-3] }";
    let text = BASE.replacen("teeth = 20", keys, 1);
    let origin = Origin::File(folder.path().join("test.toml"));
    let scene = SceneFile::unbuilt(&Context::default(), "test.toml", &text, origin, true).unwrap();
    let gear = toothing_of(&scene, 0);
    let m = &gear.params().modifications;
    assert_eq!((m.helix_slope, m.twist), ([8e-6, 0.0], [-5e-6, -5e-6]));
    let relief = m.end_relief[1].unwrap();
    assert_eq!((relief.amount, relief.length), (1e-5, 2e-3));
    assert_eq!(
        (relief.shape, m.end_relief[0]),
        (ReliefShape::Parabolic, None)
    );
    let sizes = m
        .topography
        .each_ref()
        .map(|t| t.as_ref().map(|t| t.size()));
    assert_eq!(sizes, [Some([2, 3]), Some([2, 2])]);
    assert_eq!(m.topography[0].as_ref().unwrap().greatest(), 4e-6);
    // At the tip, 4 mm above the middle of the face: slope, twist (its least part is none) and the grid's last corner.
    let at = |side| gear.flank_deviation(side, gear.r_tip(), 0.8);
    let common = |c: f64| 0.25 * (5e-6 - 5e-6 * 0.8) + 1e-5 * 0.25 + c;
    assert!((at(Side::Left) - common(4e-6 + 4e-6 * 1.8)).abs() < 1e-17);
    assert!((at(Side::Right) - common(3e-6)).abs() < 1e-17);
    let files: Vec<_> = scene.source().files.into_keys().collect();
    assert!(files.iter().any(|f| f.ends_with("flank.csv")), "{files:?}");
}

//! Tests of the reading of check files and of the error messages for malformed ones.

use super::*;

fn parse(text: &str) -> Result<CheckFile, SceneError> {
    CheckFile::parse(Path::new("ci/check.toml"), text)
}

#[test]
fn what_a_case_says_counts_more() {
    let file = parse(
        "schema = 1\ntolerances.peak_force_n = { relative = 0.01, most = 4e3 }\n\
         [[cases]]\nscene = \"mine.toml\"\ntolerances.peak_force_n.relative = 0.02\n\
         [[cases]]\nscene = \"spur_impact\"\nslow = true\nmodels = [\"rigid\", \"fe\"]\n",
    )
    .unwrap();
    assert_eq!(file.baseline, Path::new("ci/check.baseline.jsonl"));
    let [own, shipped] = file.cases.as_slice() else {
        panic!("{:?}", file.cases)
    };
    assert_eq!(
        (own.name.as_str(), own.scene.as_str()),
        ("mine", "ci/mine.toml")
    );
    let peak = own.rules.tolerance("peak_force_n");
    assert_eq!((peak.relative, peak.most), (0.02, Some(4e3)));
    assert_eq!(shipped.rules.tolerance("peak_force_n").relative, 0.01);
    assert_eq!(shipped.rules.tolerance("force_l2@calculix").absolute, 1e-8);
    assert_eq!(shipped.models.as_deref(), Some("rigid,fe"));
    assert_eq!(file.select(&[], true).unwrap().len(), 1);
    assert!(file.select(&["other".into()], false).is_err());
}

#[test]
fn what_is_wrong_is_said_with_its_line() {
    let case = "[[cases]]\nscene = \"spur_impact\"\n";
    for (text, line, part) in [
        (format!("schema = 2\n{case}"), 1, "schema 2"),
        (format!("schema = 1\nwork = \"some\"\n{case}"), 2, "some"),
        (
            format!("schema = 1\nruntime = {{ factor = 0.9 }}\n{case}"),
            2,
            "makes every run too slow",
        ),
        (
            format!("schema = 1\n{case}metrics = [\"peek\"]\n"),
            4,
            "peek",
        ),
        (
            format!("schema = 1\n{case}{case}"),
            5,
            "called `spur_impact`",
        ),
        (format!("schema = 1\n{case}modls = []\n"), 4, "modls"),
    ] {
        let e = parse(&text).unwrap_err();
        assert!(e.message().contains(part), "{}", e.to_text());
        assert_eq!(e.line(), Some(line), "{}", e.to_text());
        assert!(e.help_text().is_some(), "{}", e.to_text());
    }
}

//! Tests of `view`: the page of a study, the gallery of a folder, and what it refuses and does not replace.

use super::{Folder, has};

const SCENE: &str = include_str!("../malformed/scene.toml");
const COMPARE: &str = "compare s.toml --models rigid --integrators rk4 --repeats 1";

fn with_results() -> Folder {
    let folder = Folder::new();
    folder.write("s.toml", SCENE);
    folder.says(&format!("{COMPARE} --out all/first"));
    folder.write(
        "s.toml",
        &SCENE.replace("A sound scene", "A <b>second</b> scene"),
    );
    folder.says(&format!("{COMPARE} --out all/of/it/second"));
    folder
}

#[test]
fn a_folder_of_results_has_a_gallery() {
    let folder = with_results();
    let page = |of: &str| format!("{}", folder.at(of).canonicalize().unwrap().display());
    let said = folder.says("view all/first --print");
    has(&said, &[&format!("page: {}", page("all/first/index.html"))]);
    assert!(!folder.at("all/index.html").exists());
    let said = folder.says("view all --print");
    has(&said, &[&page("all/index.html")]);
    let gallery = folder.read("all/index.html");
    has(
        &gallery,
        &[
            "href=\"./first/index.html\"",
            "href=\"./of/it/second/index.html\"",
            "src=\"./first/force.svg\"",
            "A &lt;b&gt;second&lt;/b&gt; scene",
            "The cheapest run",
            "2 results",
        ],
    );
    // Each result has the date of its record.
    let record: serde_json::Value =
        serde_json::from_str(&folder.read("all/first/results.json")).unwrap();
    has(&gallery, &[record["created"].as_str().unwrap()]);
    // The gallery is replaced by a later one, and a broken record is left out with a warning.
    folder.write("all/first/results.json", "{}");
    let out = folder.ends("view all --print", 0);
    has(&super::stderr(&out), &["left out", "results.json"]);
    has(&folder.read("all/index.html"), &["1 result"]);
}

/// Without a display no program is started: the path is printed.
#[test]
fn without_a_display_the_path_is_printed() {
    if std::env::consts::OS != "linux" {
        return;
    }
    let folder = with_results();
    let mut command = folder.command("view all/first");
    let out = command
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .output()
        .unwrap();
    assert_eq!(out.status.code(), Some(0));
    has(
        &super::stdout(&out),
        &["all/first/index.html", "open it in a browser"],
    );
}

#[test]
fn pages_of_others_stay() {
    let folder = with_results();
    folder.write("all/index.html", "<p>mine");
    folder.refuses(
        "view all --print",
        &["is not replaced", "view one of the results"],
    );
    assert_eq!(folder.read("all/index.html"), "<p>mine");
    folder.refuses(
        "view nowhere",
        &["nowhere is not a folder", "out/SCENE/STUDY"],
    );
    std::fs::create_dir(folder.at("empty")).unwrap();
    folder.refuses("view empty", &["empty has no results", "--out"]);
    std::fs::remove_file(folder.at("all/first/index.html")).unwrap();
    folder.refuses("view all/first", &["gearbench report all/first"]);
}

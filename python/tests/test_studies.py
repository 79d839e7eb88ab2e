"""Studies as calls: arguments, results, tables and charts."""

from __future__ import annotations

import inspect
import pickle
import subprocess
import sys

import gearbench as gb
import numpy as np
import pytest


@pytest.mark.parametrize("name", gb._names.STUDIES)
def test_a_study_has_the_arguments_of_its_command(name):
    study = getattr(gb, name.replace("-", "_"))
    own = {s[0]: s[2] for s in gb._native.study_arguments()}[name]
    # The first argument is the scene, in place of which a check has a file; a list of positions is
    # that of further scenes.
    positions = {True: "further", False: "scene"}
    expected = {positions[a[5]] if a[4] else gb._names.python_name(a[0]) for a in own}
    found = set(inspect.signature(study).parameters) - {"progress", "executor", "shards", "retries"}
    assert found == expected and "memory" in found and "scene" in found
    assert all(f"{n} :" in study.__doc__ for n in expected)


def test_wrong_arguments_are_refused():
    with pytest.raises(TypeError, match="did you mean `models`"):
        gb.compare("hammer", model="rigid")
    with pytest.raises(gb.SceneError, match="did you mean `rigid`"):
        gb.compare("hammer", models="rigit")
    with pytest.raises(gb.SceneError, match="no integrator `rk5`"):
        gb.compare("hammer", integrators="rk5@1us")
    with pytest.raises(gb.SceneError, match="not in 1..=1000"):
        gb.compare("hammer", repeats=0)
    with pytest.raises(TypeError, match="takes one scene, not 2"):
        gb.modes("driveline", "run_up")
    with pytest.raises(gb.SceneError, match="two scenes of the command have the name `hammer`"):
        gb.compare("hammer", gb.Scene.load("hammer").changed({"duration_s": 0.01}), models="rigid")


@pytest.mark.filterwarnings("ignore::gearbench.SceneWarning")
def test_studies_return_records_with_arrays():
    scene = gb.Scene.load("spur_impact")
    stiffness = scene.stiffness(models="rigid", positions=8)
    assert stiffness.stiffness[0].mesh_stiffness_n_per_m2 > 0
    assert len(stiffness.stiffness[0].positions) == 8
    modes = gb.modes("driveline")
    assert len(modes.vibrations[0].modes) > 3
    response = gb.response("loaded_mesh", models="rigid")
    assert response.responses[0].label == "rigid"
    runup = gb.run_up("run_up", models="rigid")
    assert runup.run_ups[0].label == "rigid"
    fit = scene.identify(model="rigid")
    assert fit.fits[0].evaluations > 0


@pytest.mark.filterwarnings("ignore::gearbench.SceneWarning")
def test_choose_returns_a_scene_that_runs():
    scene = gb.Scene.load("spur_impact")
    choice = scene.choose(metric="peak", tolerance=0.2, runs=1)
    assert choice.choice is not None
    assert choice.chosen.run().status in ("converged", "unchecked")


def test_results_are_tables_and_pages():
    result = gb.compare("hammer", models="rigid", integrators="dopri5@1e-6,rk4@1us", repeats=1)
    rows = result.to_rows()
    assert [r["integrator"] for r in rows] == ["dopri5", "rk4"]
    assert rows[0]["force_l2 (self)"] == result.runs[0].metrics[0].force_l2
    again = pickle.loads(pickle.dumps(result))
    assert again.to_rows() == rows and again.runs[0].steps == result.runs[0].steps
    with pytest.raises(ValueError, match="copy"):
        again.report("nowhere")
    assert "<table>" in result._repr_html_() and "dopri5" in result._repr_html_()
    run = result.runs[0]
    assert "<table>" in run.series._repr_html_() and "<table>" in run._repr_html_()
    with pytest.raises(KeyError, match="there are"):
        run.series["force"]


SLOW = {
    "name": "slow",
    "title": "At half the speed",
    "gears.pinion.speed_rad_s": 10.0,
    "gears.wheel.speed_rad_s": -6.0,
}
TWICE = {"models": "rigid", "integrators": "dopri5@1e-6", "repeats": 1}


def test_scenes_of_one_file_are_compared_in_one_report(tmp_path):
    scene = gb.Scene.load("hammer")
    slow = scene.changed(SLOW)
    both = scene.compare(slow, **TWICE)
    alone = [s.compare(**TWICE) for s in (scene, slow)]
    assert [both.scene] + [r.scene for r in both.further] == ["hammer", "slow"]
    assert isinstance(both.further[0], type(both))
    for found, own in zip([both, *both.further], alone):
        assert np.array_equal(found.runs[0].series.time_s, own.runs[0].series.time_s)
        for name in own.runs[0].series:
            assert np.array_equal(found.runs[0].series[name], own.runs[0].series[name]), name
    rows = both.to_rows()
    assert [r["scene"] for r in rows] == ["hammer", "slow"]
    speeds = [r.runs[0].series["speed_pinion_rad_s"][0] for r in (both, both.further[0])]
    assert speeds == [20.0, 10.0]
    assert repr(both) == "<CompareResult of hammer, slow, 2 runs>"
    again = pickle.loads(pickle.dumps(both))
    assert again.further[0].runs[0].steps == both.further[0].runs[0].steps
    page = both.report(tmp_path)
    assert "At half the speed" in open(page, encoding="utf-8").read()
    files = [tmp_path / f"{name}-run01-rigid-dopri5.csv" for name in ("hammer", "slow")]
    assert all(f.exists() for f in files)


def test_two_scenes_are_swept_in_one_report():
    scene = gb.Scene.load("loaded_mesh")
    torques = {"gears.pinion.loads.1.torque_nm": 120.0, "gears.wheel.loads.1.torque_nm": 180.0}
    heavy = scene.changed({"name": "heavy", **torques})
    both = gb.sweep("loaded_mesh", heavy, models="rigid", points=2)
    assert [both.scene, both.further[0].scene] == ["loaded_mesh", "heavy"]
    errors = [abs(r.statics[0].error_mean_m) for r in (both, both.further[0])]
    assert 1.1 * errors[0] < errors[1]


def test_laws_of_one_name_in_two_scenes_are_refused():
    def pair(stiffness, name):
        law = gb.ContactLaw(lambda gap, rate: -stiffness * gap, name="spring", elastic=True)
        contact = gb.Contact(stiffness="iso6336", normal_force=law)
        models = [gb.Model(model="rigid", contact=contact)]
        study = gb.Study(models=["rigid"])
        return gb.Scene.load("hammer").replace(name=name, models=models, study=study)

    with pytest.raises(gb.SceneError, match="two contact laws have the name `spring`"):
        gb.compare(pair(1e8, "soft"), pair(2e8, "stiff"), **TWICE)


def test_pandas_xarray_and_matplotlib_where_they_are_installed():
    result = gb.compare("hammer", models="rigid", integrators="dopri5@1e-6", repeats=1)
    run = result.runs[0]
    pandas = pytest.importorskip("pandas")
    frame = run.to_pandas()
    assert isinstance(frame, pandas.DataFrame) and frame.index.name == "time_s"
    assert len(result.to_pandas()) == 1
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    assert len(run.plot().lines) == 1 and len(result.plot().lines) == 1
    pytest.importorskip("xarray")
    assert run.to_xarray()["speed_pinion_rad_s"].attrs["units"] == "rad/s"


def test_the_package_needs_numpy_alone():
    others = {"pandas", "xarray", "matplotlib", "tqdm"}
    code = f"import sys, gearbench; print(sorted({others} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_a_scan_has_its_cells_as_arrays():
    scan = gb.scan("spur_impact", vary={"gears.pinion.speed_rad_s": [10, 20, 40]}, models="rigid")
    columns = scan.to_columns()
    assert columns["gears.pinion.speed_rad_s"].tolist() == [10.0, 20.0, 40.0]
    assert np.all(np.diff(columns["peak_force_n"]) > 0)
    assert len(scan.to_rows()) == scan.cells == 3


def test_commands_that_write_files_are_calls(tmp_path):
    scene = gb.Scene.load("hammer")
    found = scene.mesh(gear="pinion", flank=2, width=1, out=tmp_path / "pinion.inp")
    assert (tmp_path / "pinion.inp").is_file() and len(found["written"]) == 1
    assert (found["gears"][0]["gear"], found["gears"][0]["teeth"]) == ("pinion", 20)
    assert gb.mesh(tmp_path / "pinion.inp")["gears"][0]["nodes"] == found["gears"][0]["nodes"]
    csv = tmp_path / "rigid.csv"
    stored = scene.reference(model="rigid", method="dopri5@1e-8", out=csv)
    assert csv.is_file() and stored["model"] == "rigid"
    assert 0 < stored["own_error"]["force_l2"] < 1e-2
    with pytest.raises(gb.SceneError, match="required"):
        scene.reference(out=csv)


CHECK = """
schema = 1
[[cases]]
scene = "hammer"
models = ["rigid"]
integrators = ["dopri5@1e-6"]
"""


def test_a_check_compares_with_its_baseline(tmp_path):
    file = tmp_path / "check.toml"
    file.write_text(CHECK)
    stored = gb.check(file, update=True, no_runtime=True, out=tmp_path / "first")
    assert stored.exit_code == 0
    again = gb.check(file, no_runtime=True)
    assert again.exit_code == 0 and len(again.entries) == 1
    with pytest.raises(gb.SceneError):
        gb.check(tmp_path / "none.toml")

"""FMUs and REXS as calls."""

from __future__ import annotations

import shutil
import xml.etree.ElementTree as ET
import zipfile

import gearbench as gb
import pytest


def description(path):
    with zipfile.ZipFile(path) as archive:
        return ET.fromstring(archive.read("modelDescription.xml")), archive.namelist()


@pytest.mark.parametrize("version", [2, 3])
def test_a_model_is_packed_in_both_versions_of_fmi(version, tmp_path):
    library = tmp_path / "library.so"
    library.write_bytes(b"the library")
    path = tmp_path / "hammer.fmu"
    made = gb.fmu("hammer", model="rigid", method="rk4@2us", fmi=version, library=library, out=path)
    assert made["written"] == str(path)
    root, names = description(path)
    assert root.get("fmiVersion") == f"{version}.0"
    with zipfile.ZipFile(path) as archive:
        (binary,) = [n for n in names if n.startswith("binaries/")]
        assert archive.read(binary) == b"the library"
    variables = {v.get("name") for v in root.iter() if v.get("causality") == "output"}
    assert {"pinion.speed", "pinion_wheel.force"} <= variables


@pytest.mark.parametrize("version", [2, 3])
def test_an_fmu_is_the_run_of_its_scene(version, tmp_path):
    fmpy = pytest.importorskip("fmpy")
    if gb.studies.LIBRARY is None and shutil.which("cargo") is None:
        pytest.skip("there is neither the library of FMUs nor cargo to build it")
    scene, path = gb.Scene.load("hammer"), tmp_path / "hammer.fmu"
    scene.fmu(model="rigid", method="rk4@2us", fmi=version, out=path)
    end = scene.duration_s
    host = fmpy.simulate_fmu(
        str(path),
        stop_time=end,
        output_interval=end / 1000,
        fmi_type="CoSimulation",
        output=["pinion.angle", "wheel.angle"],
    )
    series = scene.run("rigid", "rk4@2us").series
    for gear in ("pinion", "wheel"):
        own, other = series[f"hub_angle_{gear}_rad"], host[f"{gear}.angle"]
        assert series.time_s[-1] == end
        assert abs(own[-1] - other[-1]) <= 1e-12 * abs(own).max()


def test_a_scene_goes_through_rexs(tmp_path):
    path = tmp_path / "pair.rexs"
    made = gb.export("loaded_mesh", rexs=path)
    assert made["written"] == str(path)
    kinds = [c.get("type") for c in ET.parse(path).iter("component")]
    assert kinds.count("cylindrical_gear") == 2 and kinds.count("cylindrical_stage") == 1
    back = tmp_path / "back.toml"
    made = gb.import_(path, out=back)
    assert made["written"] == str(back) and made["taken"]
    assert max(abs(x) for x in made["centre_distance_errors_m"]) < 1e-3
    own, other = gb.Scene.load("loaded_mesh"), gb.Scene.load(back)
    for name in own.gears:
        assert own.gears[name].teeth == other.gears[name].teeth
        assert own.gears[name].module_m == pytest.approx(other.gears[name].module_m, rel=1e-12)


def test_a_file_that_is_no_model_is_refused(tmp_path):
    path = tmp_path / "no.rexs"
    path.write_text("<a/>")
    with pytest.raises(gb.SceneError, match="root of the document"):
        gb.import_(path)

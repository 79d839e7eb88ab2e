"""Numbers are those of the command line, bit for bit."""

from __future__ import annotations

import dataclasses
import json
import keyword
import os
import pathlib
import shutil
import subprocess

import gearbench as gb
import pytest

COMMAND = os.environ.get("GEARBENCH_COMMAND") or shutil.which("gearbench")
# Keys whose values depend on the clock and the machine, as `OF_THE_CLOCK` of the record.
OF_THE_CLOCK = set(
    "wall_s wall_spread_s wall_min_s wall_max_s repeats setup_s solve_s cost_s "
    "predicted_cost_s cpu_s summaries "
    "cpu_per_simulated_time cpu_per_step_s cpu_per_evaluation_s estimate_s finding created "
    "on_front machine cpu command reason".split()
)
# Histories are compared apart; names of files are those of a folder; commits of two builds may
# differ.
APART = {"series", "further", "files", "commit"}

STUDIES = {
    "compare": {"models": "rigid", "repeats": 1},
    "precision": {"models": "rigid", "integrators": "rk4,dopri5", "repeats": 1},
    "identify": {"model": "rigid"},
    "sweep": {"models": "rigid", "points": 2},
    "stability": {"models": "rigid", "integrators": "rk4,hht-alpha", "threads": 2},
    "truncation": {
        "any_reference": True,
        "models": "elastic,fe",
        "counts": [0, 5, 20],
        "repeats": 1,
    },
    "coupling": {"models": "rigid", "steps": "1e-6:1e-4:3", "threads": 2},
    "penalty": {"model": "elastic-nodes", "points": 3, "positions": 4},
    "cost": {"models": "rigid", "integrators": "dopri5@1e-6,rk4@1us", "repeats": 1},
}
# Small scenes of the tests of the workspace, for studies that take long on shipped ones.
SMALL = pathlib.Path(__file__).parents[2] / "tests" / "fingerprint"
SCENES = {
    "compare": ["spur_impact", "hammer", "rack_pinion"],
    "precision": ["spur_impact", "hammer", "rack_pinion"],
    "identify": ["spur_impact", "spur_impact_large", "rack_pinion"],
    "sweep": ["loaded_mesh", "ring_pair", "mesh_efficiency"],
    "stability": [str(SMALL / "impact.toml")],
    "truncation": [str(SMALL / "impact.toml")],
    "coupling": [str(SMALL / "loaded.toml")],
    "penalty": [str(SMALL / "impact.toml")],
    "cost": [str(SMALL / "hammer.toml")],
}


def field(of, key):
    """The field of a key; a keyword of Python has `_` at its end."""
    return getattr(of, f"{key}_" if keyword.iskeyword(key) else key)


def assert_same(found, written, path):
    """Compare an object of the record with its JSON; numbers have to be equal in all bits."""
    if isinstance(written, dict):
        get = found.get if isinstance(found, dict) else lambda k: field(found, k)
        for key, value in written.items():
            if key not in OF_THE_CLOCK | APART:
                assert_same(get(key), value, f"{path}.{key}")
    elif isinstance(written, list):
        assert len(found) == len(written), path
        for i, (a, b) in enumerate(zip(found, written)):
            assert_same(a, b, f"{path}[{i}]")
    elif isinstance(written, float):
        assert float(found) == written, path
    else:
        assert found == written, path


@pytest.mark.skipif(COMMAND is None, reason="the command gearbench is not installed")
@pytest.mark.parametrize(("study", "name"), [(s, n) for s, names in SCENES.items() for n in names])
@pytest.mark.filterwarnings("ignore::gearbench.SceneWarning")
def test_numbers_are_those_of_the_command_line(study, name, tmp_path):
    options = STUDIES[study]
    arguments = next(s[2] for s in gb._native.study_arguments() if s[0] == study)
    words = gb.studies.words_of(arguments, options)
    command = [COMMAND, study, name, *words, "--out", str(tmp_path), "--quiet"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    record = json.loads((tmp_path / "results.json").read_text())
    result = getattr(gb.Scene.load(name), study)(**options)
    assert result.exit_code == done.returncode, done.stderr
    assert_same(result, record, study)
    known = {f.name for f in dataclasses.fields(result)}
    assert set(record) <= known
    # The record rounds its histories; their files have all digits.
    result.report(tmp_path / "python")
    names = [name for run in record.get("runs", []) for name in run.get("files", [])]
    for name in names:
        files = [(folder / name).read_bytes() for folder in (tmp_path, tmp_path / "python")]
        assert files[0] == files[1], name
    assert names or study != "compare"


def test_a_folder_of_a_study_is_that_of_the_command(tmp_path):
    result = gb.compare("hammer", models="rigid", integrators="dopri5@1e-6", repeats=1)
    path = result.report(tmp_path / "later")
    written = gb.compare(
        "hammer", models="rigid", integrators="dopri5@1e-6", repeats=1, out=tmp_path / "at-once"
    )
    assert os.path.isfile(path) and written.folder == str(tmp_path / "at-once")
    names = [sorted(p.name for p in (tmp_path / f).iterdir()) for f in ("later", "at-once")]
    assert names[0] == names[1] and "results.json" in names[0]
    own = [n for n in names[0] if n.endswith(".csv") and n not in ("runs.csv",)]
    assert own
    for name in own:
        texts = [(tmp_path / f / name).read_text() for f in ("later", "at-once")]
        assert texts[0] == texts[1], name

"""Scenes as objects: equal to those of files, checked by the reader of files."""

from __future__ import annotations

import pickle
import warnings

import gearbench as gb
import numpy as np
import pytest

PAIR = """
schema = 1
name = "pair"
duration_s = 1e-3
[gears.pinion]
teeth = 20
module_m = 0.004
face_width_m = 0.01
speed_rad_s = 60.0
[gears.wheel]
teeth = 30
module_m = 0.004
face_width_m = 0.01
[[meshes]]
gears = ["pinion", "wheel"]
centre_distance_m = 0.1002
[[models]]
model = "rigid"
contact = { stiffness = "iso6336" }
"""


def pair(**keys: object) -> gb.Scene:
    """The pair of the text above, from objects."""
    pinion = gb.Gear(teeth=20, module_m=4e-3, face_width_m=10e-3, speed_rad_s=60.0)
    parts = gb.Pair(pinion, pinion.replace(teeth=30, speed_rad_s=None), centre_distance_m=0.1002)
    rigid = gb.Model(model="rigid", contact=gb.Contact(stiffness="iso6336"))
    return gb.Scene(parts, **{"name": "pair", "duration_s": 1e-3, "models": [rigid], **keys})


def test_a_scene_of_objects_equals_that_of_its_file(tmp_path):
    scene = pair()
    assert scene == gb.Scene.parse(PAIR)
    assert scene != pair(duration_s=2e-3)
    scene.dump(tmp_path / "pair.toml")
    loaded = gb.Scene.load(tmp_path / "pair.toml")
    assert loaded == scene and gb.Scene.parse(loaded.dump()) == scene
    assert pickle.loads(pickle.dumps(scene)) == scene


@pytest.mark.parametrize("name", gb.shipped_scenes())
def test_shipped_scenes_are_made_again_from_their_tables(name):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", gb.SceneWarning)
        scene = gb.Scene.load(name)
        again = gb.Scene(**scene._read())
    assert again == scene
    assert list(again.gears) == list(scene.gears)


def test_a_planetary_set_is_that_of_the_shipped_scene():
    scene = gb.Scene.load("planetary")
    station = scene.shafts[0].carries[0]
    carrier = {k: x for k, x in station.items() if k not in ("body", "at_m", "planets")}
    gears = scene.gears
    made = gb.Planetary(
        gears["sun"], gears["p1"], gears["ring"], centre_distance_m=0.081, carrier=carrier
    )
    again = scene.replace(gears=made.gears, meshes=made.meshes, shafts=made.shafts)
    assert again == scene


def test_racks_and_trains():
    gear = gb.Gear(teeth=20, module_m=3e-3, face_width_m=0.02, thinning_m=3e-5)
    rack = gb.Rack(teeth=30, module_m=3e-3, face_width_m=0.02, thinning_m=3e-5)
    assert rack.kind == "rack"
    train = gb.Train({"a": gear, "b": gear, "c": rack}, centre_distance_m=None, backlash_m=80e-6)
    assert [m.gears for m in train.meshes] == [["a", "b"], ["b", "c"]]
    rigid = gb.Model(model="rigid", contact=gb.Contact(stiffness="compliance"))
    scene = gb.Scene(
        gb.Train({"a": gear.replace(speed_rad_s=5.0), "c": rack}, backlash_m=80e-6),
        name="rack",
        duration_s=1e-3,
        models=[rigid],
    )
    assert scene.gears["c"] == rack


@pytest.mark.parametrize(
    ("make", "expected"),
    [
        (lambda: gb.Gear(teeth=20, modul_m=4e-3, face_width_m=0.01), "did you mean `module_m`"),
        (lambda: gb.Gear(teeth=20, face_width_m=0.01), "`module_m` is missing"),
        (lambda: gb.Gear(teeth=20, module_mm=4, face_width_m=0.01), "write `module_m = 0.004`"),
        (lambda: gb.Mesh(gears=["a", "b"], centre_distance_m=-1.0), "more than 0"),
        (lambda: gb.Gear(teeth=2.5, module_m=4e-3, face_width_m=0.01), "teeth"),
        (lambda: gb.Stiffness(kind="constant"), "stiffness_n_per_m2"),
        (lambda: gb.Load(torque=3.0), "torque_nm"),
        (lambda: gb.Gear(teeth=object()), "a scene cannot contain"),
    ],
)
def test_a_wrong_key_is_refused_with_a_way_out(make, expected):
    with pytest.raises(gb.SceneError) as refused:
        make()
    assert expected in str(refused.value)
    assert isinstance(refused.value, ValueError) and refused.value.help


def test_errors_have_the_line_of_the_file(tmp_path):
    text = PAIR.replace("teeth = 30", "teeth = -30")
    (tmp_path / "bad.toml").write_text(text)
    with pytest.raises(gb.SceneError) as refused:
        gb.Scene.load(tmp_path / "bad.toml")
    assert refused.value.line == text.splitlines().index("teeth = -30") + 1
    assert "bad.toml" in str(refused.value)
    again = pickle.loads(pickle.dumps(refused.value))
    assert (str(again), again.line) == (str(refused.value), refused.value.line)


def test_values_change_by_their_paths_and_comments_stay():
    scene = gb.Scene.parse(PAIR.replace("speed_rad_s = 60.0", "speed_rad_s = 60.0 # fast"))
    faster = scene.changed({"gears.pinion.speed_rad_s": np.float64(70), "gears.*.teeth": 25})
    assert faster.gears["pinion"].speed_rad_s == 70.0
    assert [g.teeth for g in faster.gears.values()] == [25, 25]
    assert "# fast" in faster.dump()
    assert scene.gears["pinion"].speed_rad_s == 60.0
    with pytest.raises(gb.SceneError, match="no entry"):
        scene.changed({"models.elastic.gap": 1})


def test_a_table_does_not_change():
    gear = gb.Gear(teeth=20, module_m=4e-3, face_width_m=10e-3)
    with pytest.raises(AttributeError, match="replace"):
        gear.teeth = 30
    assert gear.profile_shift is None and gear.replace(teeth=30).teeth == 30
    with pytest.raises(AttributeError, match="no key `modul`"):
        print(gear.modul)
    assert gear == {"teeth": 20, "module_m": 4e-3, "face_width_m": 10e-3}

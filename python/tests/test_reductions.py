"""Reductions as arrays: made, read, changed, and handed over to a model."""

from __future__ import annotations

import gearbench as gb
import numpy as np
import pytest


@pytest.fixture(scope="module")
def scene():
    return gb.Scene.load("spur_impact")


@pytest.fixture(scope="module")
def reductions(scene):
    return {name: gb.reduce(scene, gear=name, modes=30) for name in scene.gears}


def peak_of(scene, reductions, young_pa=2.1e11):
    """Peak force of the impact of elastic gears with these reductions [N]."""
    gears = {
        name: gb.GearModel(model="elastic", parameters={"reduction": r, "residual": True})
        for name, r in reductions.items()
    }
    model = gb.Model(
        label="reduced", model="elastic", gears=gears, contact=gb.Contact(local="half-space")
    )
    steel = gb.Material(young_pa=young_pa, poisson=0.3, density_kg_m3=7850.0)
    own_gears = {name: gear.replace(material=steel) for name, gear in scene.gears.items()}
    own = scene.replace(models=[model], gears=own_gears, study=None, tolerance=None)
    run = own.run("reduced", "trigonometric@1us")
    assert run.modes_of_gears == [r["omega_rad_s"].size for r in reductions.values()]
    return run.series["contact_force_pinion_wheel_n"].max()


def test_a_reduction_is_read_and_written_as_it_is(reductions, tmp_path):
    reduction = reductions["pinion"]
    omega = reduction["omega_rad_s"]
    # Directions that carry almost no energy are left out.
    assert 20 < omega.size <= 30 and np.all(np.diff(omega) >= 0)
    rows = reduction["shapes_per_sqrt_kg"].shape[0]
    assert reduction["flank_nodes_m"].shape == (rows, 3)
    reduction.save(tmp_path / "gear.npz")
    again = gb.Reduction.load(tmp_path / "gear.npz")
    assert again.meta == reduction.meta
    for name, values in reduction.arrays.items():
        assert np.array_equal(again[name], values) and again[name].dtype == values.dtype


def test_arrays_of_another_program_are_handed_over(scene, reductions):
    """Gears whose modes are slower and whose compliance is larger, as those of a softer material,
    press less.
    """
    stiff = peak_of(scene, reductions)
    factor = 2.0
    soft = {
        name: r.replace(
            omega_rad_s=r["omega_rad_s"] / factor**0.5,
            flank_compliance_m_per_n=factor * r["flank_compliance_m_per_n"],
            hub_flank_compliance=factor * r["hub_flank_compliance"],
            hub_compliance=factor * r["hub_compliance"],
            young_pa=r["young_pa"] / factor,
        )
        for name, r in reductions.items()
    }
    # The peak of an impact grows with the root of the stiffness.
    assert peak_of(scene, soft, 2.1e11 / factor) == pytest.approx(stiff / factor**0.5, rel=0.1)


def test_arrays_of_wrong_shape_are_refused(scene, reductions):
    wrong = {**reductions, "wheel": reductions["wheel"].replace(omega_rad_s=np.ones(3))}
    with pytest.raises(gb.SceneError, match="expected the shape"):
        peak_of(scene, wrong)

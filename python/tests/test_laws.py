"""Contact laws that are functions of Python: runs, energy, exceptions, limits of such a scene."""

from __future__ import annotations

import _thread
import copy
import pickle
import signal
import threading
from concurrent.futures import ThreadPoolExecutor

import gearbench as gb
import numpy as np
import pytest

E = 0.8
METHODS = [
    "dopri5@1e-8",
    "rk4@0.2us",
    "velocity-verlet@0.1us",
    "trigonometric@0.2us",
    "newmark@0.2us",
    "generalised-alpha@0.2us",
    "bdf@1e-7",
]


def hunt_crossley(gap, gap_rate, stiffness, touch_speed):
    """The law of Hunt and Crossley with Hertz's exponent, as the built-in one."""
    speed = max(touch_speed, abs(gap_rate))
    return stiffness * (-gap) ** 1.5 * (1.0 - 1.5 * (1.0 - E) * gap_rate / speed)


def with_derivatives(gap, gap_rate, stiffness, touch_speed):
    """The same with its derivatives."""
    speed = max(touch_speed, abs(gap_rate))
    chi = 1.5 * (1.0 - E)
    d = -gap
    elastic, slope = stiffness * d**1.5, 1.5 * stiffness * d**0.5
    factor = 1.0 - chi * gap_rate / speed
    # Above the touch speed the damping depends on the sign of the gap rate alone.
    by_rate = -chi * elastic / speed if speed == touch_speed else 0.0
    return elastic * factor, -slope * factor, by_rate


def spring(gap, gap_rate):
    """A stiffening spring."""
    return 2e8 * -gap * (0.5 + gap / (gap - 4e-6))


def pair(model="rigid", loaded=False, **contact):
    """A pair of gears, of which one meets the other at rest, or which a torque loads."""
    gear = gb.Gear(
        teeth=20, module_m=4e-3, face_width_m=10e-3, speed_rad_s=None if loaded else 20.0,
        loads=[gb.Load(torque_nm=30.0)] if loaded else None,
    )  # fmt: skip
    wheel = gear.replace(
        teeth=30, speed_rad_s=None, loads=[gb.Load(torque_nm=45.0)] if loaded else None
    )
    stiffness = {"kind": "constant", "stiffness_n_per_m2": contact.pop("stiffness", 1e10)}
    parameters = None
    if model == "movable-teeth":
        parameters = {
            "tooth_mass_kg": 5e-3, "tooth_stiffness_n_per_m": 2e8, "tooth_damping_ns_per_m": 0.0,
        }  # fmt: skip
    start = gb.Start(flank="left", gap_m=0.0 if loaded else 2e-6)
    contact = gb.Contact(stiffness=stiffness, **contact)
    return gb.Scene(
        gb.Pair(gear, wheel, backlash_m=80e-6, start=start),
        name="pair",
        duration_s=2e-4,
        models=[gb.Model(model=model, contact=contact, parameters=parameters)],
    )


def force(run):
    return run.series["contact_force_pinion_wheel_n"]


@pytest.mark.parametrize("model", ["rigid", "movable-teeth"])
@pytest.mark.parametrize("method", METHODS)
def test_a_law_of_python_gives_the_run_of_the_built_in_law(model, method):
    if model == "movable-teeth" and method.startswith("trigonometric"):
        pytest.skip("the method needs coordinates that are independent oscillators")
    stiffness = 1e10 * 1e-5**-0.5
    damping = gb.ContactDamping(law="hunt-crossley", e=E)
    known = pair(model, stiffness=stiffness, exponent=1.5, damping=damping).run(model, method)
    assert force(known).max() > 1000 and known.ledger.dissipated_j > 0
    grid = np.linspace(0.0, 2e-4, 1501)
    for law in (hunt_crossley, with_derivatives):
        own = pair(model, stiffness=stiffness, normal_force=law).run(model, method)
        # Rounding, and tangents by differences in Newton iterations.
        assert own.steps == known.steps, law.__name__
        assert force(own).max() == pytest.approx(force(known).max(), rel=1e-8), law.__name__
        assert own.ledger.dissipated_j == pytest.approx(known.ledger.dissipated_j, rel=1e-8)
        # Samples at the ends of contacts lie within the accuracy of their location.
        one, other = (np.interp(grid, r.series.time_s, force(r)) for r in (known, own))
        assert np.abs(one - other).max() < 1e-5 * one.max(), law.__name__


def test_an_elastic_law_keeps_the_energy_and_loaded_gears_vibrate():
    for law in (
        spring,
        gb.ContactLaw(spring, elastic=True),
        gb.ContactLaw(spring, elastic=True, potential=potential),
    ):
        run = pair(normal_force=law).run("rigid", "dopri5@1e-9")
        ledger = run.ledger
        assert ledger.dissipated_j == pytest.approx(0.0, abs=1e-9 * ledger.energy_start_j)
        assert ledger.energy_end_j == pytest.approx(ledger.energy_start_j, rel=1e-7)
        assert abs(ledger.residual_rel) < 1e-7
    loaded = force(pair(loaded=True, normal_force=spring).run("rigid", "dopri5@1e-8"))
    assert loaded.min() >= 0.0 and loaded.max() > 500.0


def potential(gap):
    """The integral of `spring`: d (1/2 + d/(d + a)) = 3/2 d - a + a^2/(d + a)."""
    a, d = 4e-6, -gap
    return 2e8 * (0.75 * d**2 - a * d + a**2 * np.log1p(d / a))


def test_studies_and_other_scenes_have_the_law():
    scene = pair(normal_force=spring)
    result = scene.compare(integrators="dopri5@1e-6", repeats=1)
    assert force(result.runs[0]).max() == force(scene.run("rigid", "dopri5@1e-6")).max()
    faster = scene.changed({"gears.pinion.speed_rad_s": 40.0})
    assert (
        force(faster.run("rigid", "dopri5@1e-6")).max()
        > force(scene.run("rigid", "dopri5@1e-6")).max()
    )
    again = scene.replace(duration_s=1e-4)
    assert again.models[0].contact["normal_force"].function is spring
    assert scene == pair(normal_force=spring) != pair(normal_force=lambda g, v: -2e8 * g)
    scan = scene.scan(vary={"gears.pinion.speed_rad_s": [10, 20]}, integrators="dopri5@1e-6")
    assert np.diff(scan.to_columns()["peak_force_n"]) > 0
    known = scene.replace(models=[gb.Model(model="rigid", contact=gb.Contact(stiffness="iso6336"))])
    assert gb.Scene.parse(known.dump()) == known


class Failed(Exception):
    pass


def fails(gap, gap_rate):
    if gap < -1e-6:
        raise Failed("deep")
    return -1e8 * gap


@pytest.mark.parametrize("method", ["dopri5@1e-6", "rk4@1us", "newmark@1us", "bdf@1e-6"])
def test_an_exception_ends_the_run_and_comes_out(method):
    simulation = pair(normal_force=fails).simulation("rigid", method)
    for _ in range(2):
        with pytest.raises(Failed, match="deep"):
            simulation.run()
    with pytest.raises(Failed, match="deep"):
        pair(normal_force=fails).compare(integrators=method, repeats=1)


def test_a_law_that_fails_in_one_thread_leaves_the_others_alone():
    caller = threading.current_thread()

    def law(gap, gap_rate):
        if threading.current_thread() is not caller and gap < -1e-6:
            raise Failed("not here")
        return -1e8 * gap

    simulation = pair(normal_force=law).simulation("rigid", "dopri5@1e-6")
    with ThreadPoolExecutor(1) as other:
        failed = other.submit(simulation.run)
        assert force(simulation.run()).max() > 0
        with pytest.raises(Failed, match="not here"):
            failed.result()


def test_an_interruption_in_a_law_ends_the_run():
    # A shell starts jobs in the background with the signal ignored.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    calls = []

    def law(gap, gap_rate):
        calls.append(gap)
        if len(calls) == 10:
            _thread.interrupt_main()
        return -1e8 * gap

    with pytest.raises(KeyboardInterrupt):
        pair(normal_force=law).run("rigid", "rk4@1us")


@pytest.mark.parametrize(
    ("law", "match"),
    [
        (lambda gap, gap_rate: "much", "returns the force"),
        (lambda gap, gap_rate: (1.0, 2.0), "returns the force"),
        (lambda gap, gap_rate: None, "returns the force"),
    ],
)
def test_a_law_that_returns_no_number_is_a_type_error(law, match):
    with pytest.raises(TypeError, match=match):
        pair(normal_force=law).run("rigid", "rk4@1us")


def test_a_law_that_is_not_a_number_is_a_failed_run():
    with pytest.raises(gb.RunFailed):
        pair(normal_force=lambda gap, gap_rate: float("nan")).run("rigid", "rk4@1us")


def test_a_scene_with_a_law_stays_in_its_program(tmp_path):
    scene = pair(normal_force=spring)
    for attempt in (
        scene.dump,
        lambda: scene.dump(tmp_path / "pair.toml"),
        lambda: pickle.dumps(scene),
        lambda: pickle.dumps(gb.Contact(normal_force=spring)),
    ):
        with pytest.raises(gb.SceneError, match="`spring`, a function of Python") as refused:
            attempt()
        assert "script" in refused.value.help
    assert not (tmp_path / "pair.toml").exists()
    vary = {"gears.pinion.speed_rad_s": [10, 20]}
    with ThreadPoolExecutor(1) as threads:
        with pytest.raises(gb.SceneError, match="workers of an executor"):
            scene.scan(vary=vary, executor=threads)
    # A file that names a law of another program.
    with pytest.raises(gb.SceneError) as refused:
        gb.Scene.parse(scene._text)
    assert "no contact law `spring`" in refused.value.message
    assert refused.value.line and "normal_force" in refused.value.help
    assert copy.copy(gb.Contact(stiffness="iso6336")) == gb.Contact(stiffness="iso6336")


def test_wrong_laws_are_refused():
    with pytest.raises(TypeError, match="2 to 4 arguments"):
        gb.ContactLaw(lambda gap: 0.0)
    with pytest.raises(gb.SceneError, match="two contact laws"):
        gb.Scene(
            gb.Pair(*[gb.Gear(teeth=20, module_m=4e-3, face_width_m=1e-2)] * 2),
            models=[
                gb.Model(
                    label=str(i),
                    model="rigid",
                    contact=gb.Contact(stiffness="iso6336", normal_force=lambda g, v: -1e8 * g),
                )
                for i in range(2)
            ],
        )
    damped = pair(normal_force=spring, damping=gb.ContactDamping(law="flores", e=0.9))
    with pytest.raises(gb.SceneError) as refused:
        damped.run("rigid", "rk4@1us")
    assert "the whole normal force" in refused.value.message and "remove" in refused.value.help
    elastic = pair(normal_force=spring).replace(
        models=[
            gb.Model(
                model="elastic",
                contact=gb.Contact(local="half-space", normal_force=spring),
                parameters={"modes": 2},
            )
        ]
    )
    with pytest.raises(gb.SceneError) as refused:
        elastic.run("elastic", "trigonometric@1us")
    assert "between tooth pairs" in refused.value.message and "rigid" in refused.value.help

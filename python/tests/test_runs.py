"""Runs of one model: histories without copies, interruption, threads, failures."""

from __future__ import annotations

import os
import pickle
import signal
import threading
from concurrent.futures import ThreadPoolExecutor

import gearbench as gb
import numpy as np
import pytest


@pytest.fixture(scope="module")
def scene():
    return gb.Scene.load("spur_impact")


def test_histories_own_the_memory_that_the_run_has_written(scene):
    run = scene.run("rigid", "dopri5@1e-6", samples=1_000_000)
    assert len(run.series.time_s) >= 1_000_000
    for name, address in run.series._written_at.items():
        array = run.series[name]
        assert array.__array_interface__["data"][0] == address, name
        assert array.dtype == np.float64 and array.flags.c_contiguous


def test_a_run_is_the_same_every_time_and_in_every_thread(scene):
    first = scene.run("rigid", "dopri5@1e-6", histories=True)
    simulation = scene.simulation("rigid", "dopri5@1e-6", histories=True)
    with ThreadPoolExecutor(2) as threads:
        others = list(threads.map(lambda _: simulation.run(), range(4)))
    for other in others:
        assert other.steps == first.steps
        assert list(other.series) == list(first.series)
        for name in first.series:
            assert np.array_equal(other.series[name], first.series[name])
    assert first.pairs.teeth.shape == (len(first.pairs.time_s), 2)
    assert first.contact_events.force_n.shape == (len(first.contact_events.time_s), 2)
    assert scene.run("rigid", "dopri5@1e-6").pairs is None


def test_a_run_can_be_copied_before_it_is_used(scene):
    run = scene.run("rigid", "dopri5@1e-6")
    again = pickle.loads(pickle.dumps(run))
    assert type(again) is type(run) and again.steps == run.steps > 0
    assert again.series.time_s.tolist() == run.series.time_s.tolist()
    assert "rigid" in repr(scene.run("rigid", "dopri5@1e-6"))


def test_a_failed_run_is_an_exception_with_the_partial_result(scene):
    with pytest.raises(gb.RunFailed) as failed:
        scene.run("rigid", "rk4@1us", timeout=1e-9)
    run = failed.value.result
    assert run.status not in ("converged", "unchecked")
    assert run.simulated_s < scene.duration_s


def test_an_observer_sees_every_step_and_ends_the_run(scene):
    times = []

    def observe(t, q, v):
        times.append(t)
        assert q.shape == v.shape == (2,)
        return len(times) == 50

    run = scene.run("rigid", "rk4@100ns", observer=observe)
    assert len(times) == 50 and run.simulated_s == pytest.approx(times[-1])

    def fails(t, q, v):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        scene.run("rigid", "rk4@100ns", observer=fails)
    assert scene.run("rigid", "rk4@100ns").status == "unchecked"


def test_a_load_follows_a_function_of_time():
    scene = gb.Scene.load("loaded_mesh").changed({"duration_s": 1e-3})
    ramp = {"ramp": {"from_nm": 50.0, "to_nm": 150.0, "start_s": 0.0, "end_s": 1e-3}}
    function = gb.over_time(lambda t: 50.0 + 1e5 * t, 1e-3, samples=11)
    forces = []
    for load in (ramp, function, {"torque_nm": 50.0}):
        pinion = scene.gears["pinion"].replace(loads=[load])
        own = scene.replace(gears={**scene.gears, "pinion": pinion}, tolerance=None)
        run = own.run("rigid", "rk4@500ns")
        forces.append(run.series["contact_force_pinion_wheel_n"])
    assert forces[1] == pytest.approx(forces[0], rel=1e-6, abs=1e-3 * forces[0].max())
    assert forces[2][-1] < 0.9 * forces[0][-1]


def interrupt_after(seconds):
    """Send the signal of Ctrl-C to this process."""
    # A shell starts jobs in the background with the signal ignored.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(seconds, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    return timer


def test_ctrl_c_ends_a_run_at_once(scene):
    long = scene.changed({"duration_s": 50.0})
    long.simulation("rigid", "rk4@10ns")
    timer = interrupt_after(0.3)
    with pytest.raises(KeyboardInterrupt):
        long.run("rigid", "rk4@10ns")
    timer.join()


def test_ctrl_c_ends_a_study_and_leaves_what_is_finished():
    scene = gb.Scene.load("loaded_mesh")
    timer = interrupt_after(1.5)
    with pytest.raises(KeyboardInterrupt) as stopped:
        scene.sweep(models="rigid", points=2000)
    assert isinstance(stopped.value, gb.Interrupted)
    if stopped.value.result is not None:
        assert all(run.steps > 0 for run in stopped.value.result.runs)
    timer.join()


def test_the_interpreter_lock_is_released_and_two_studies_run_in_two_threads(scene):
    counted, ended = [0], threading.Event()

    def count():
        while not ended.is_set():
            counted[0] += 1

    counter = threading.Thread(target=count)
    counter.start()
    try:
        with ThreadPoolExecutor(2) as threads:
            both = [threads.submit(scene.compare, models="rigid", repeats=1) for _ in range(2)]
            results = [f.result() for f in both]
    finally:
        ended.set()
        counter.join()
    assert counted[0] > 1000
    a, b = (r.runs[0] for r in results)
    assert np.array_equal(a.series.time_s, b.series.time_s)
    assert a.metrics[0].force_l2 == b.metrics[0].force_l2


def test_progress_is_reported_and_its_exceptions_end_the_study(scene):
    seen = []
    scene.compare(models="rigid", repeats=1, progress=lambda *of: seen.append(of))
    assert seen and all(len(of) == 3 and isinstance(of[2], str) for of in seen)

    def fails(*_):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        scene.compare(models="rigid", repeats=1, progress=fails)

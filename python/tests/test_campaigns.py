"""Scans in parts by an executor: the same table as without, also where workers die."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor

import gearbench as gb
import pytest
from gearbench import _campaign

VARY = {"gears.pinion.speed_rad_s": "10..100:12"}


def cells(result):
    with open(os.path.join(result.folder, "cells.csv"), encoding="utf-8") as file:
        return file.read()


@pytest.fixture(scope="module")
def plain():
    return cells(gb.scan("spur_impact", vary=VARY, models="rigid"))


def test_threads(plain):
    seen = []
    with ThreadPoolExecutor(2) as threads:
        result = gb.scan(
            "spur_impact", vary=VARY, models="rigid", executor=threads, shards=5,
            progress=lambda *of: seen.append(of),
        )  # fmt: skip
    assert cells(result) == plain
    assert seen[-1][:2] == (5, 5)


def die_once(marker):
    """The first worker of a pool that begins to work dies."""
    run_part = _campaign.run_part

    def mortal(*call):
        try:
            os.close(os.open(marker, os.O_CREAT | os.O_EXCL))
        except FileExistsError:
            return run_part(*call)
        os.kill(os.getpid(), signal.SIGKILL)

    _campaign.run_part = mortal
    mortal.__module__, mortal.__qualname__ = "gearbench._campaign", "run_part"


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_a_worker_that_dies_costs_its_parts(plain, tmp_path):
    marker = str(tmp_path / "died")
    pools = []

    def pool():
        import multiprocessing

        pools.append(
            ProcessPoolExecutor(
                2, multiprocessing.get_context("spawn"), initializer=die_once, initargs=(marker,)
            )
        )
        return pools[-1]

    result = gb.scan("spur_impact", vary=VARY, models="rigid", executor=pool, shards=4)
    assert os.path.exists(marker) and len(pools) > 1
    assert cells(result) == plain
    for own in pools:
        own.shutdown()


def test_a_scan_goes_on_after_its_finished_parts(plain, tmp_path, monkeypatch):
    out = tmp_path / "scan"
    calls = []
    whole = _campaign.run_part

    def counted(*call):
        calls.append(call)
        if len(calls) == 3:
            raise gb.SceneError("stopped here")
        return whole(*call)

    monkeypatch.setattr(_campaign, "run_part", counted)
    again = {"vary": VARY, "models": "rigid", "shards": 4, "out": out}
    with ThreadPoolExecutor(1) as threads:
        with pytest.raises(gb.SceneError, match="stopped"):
            gb.scan("spur_impact", executor=threads, **again)
        threads.submit(int).result()
        result = gb.scan("spur_impact", executor=threads, **again)
    assert cells(result) == plain
    assert not (tmp_path / "scan.parts").exists()
    assert len(calls) < 8


def test_a_part_that_always_fails_ends_the_scan(monkeypatch):
    calls = []

    def fails(*call):
        calls.append(call)
        raise OSError("no disk")

    monkeypatch.setattr(_campaign, "run_part", fails)
    with ThreadPoolExecutor(1) as threads:
        with pytest.raises(gb.RunFailed, match="no disk"):
            gb.scan("spur_impact", vary=VARY, models="rigid", executor=threads, shards=1, retries=2)
    assert len(calls) == 3


def test_a_scene_that_is_refused_ends_the_scan():
    with ThreadPoolExecutor(1) as threads:
        with pytest.raises(gb.SceneError, match="no model"):
            gb.scan("spur_impact", vary=VARY, models="none", executor=threads, shards=2)


def test_a_local_dask_cluster_of_which_a_worker_is_killed(plain, tmp_path):
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None
    ) as cluster:
        with distributed.Client(cluster) as client:
            pids = list(client.run(os.getpid).values())
            killed = []

            def kill(done, total, what):
                if not killed:
                    killed.append(pids[0])
                    os.kill(pids[0], signal.SIGKILL)

            result = gb.scan(
                "spur_impact", vary=VARY, models="rigid", executor=client.get_executor(),
                shards=8, progress=kill,
            )  # fmt: skip
    assert killed and cells(result) == plain


def test_loky_replaces_a_worker_that_dies(plain, tmp_path):
    loky = pytest.importorskip("loky")
    marker = str(tmp_path / "died")
    pools = []

    def pool():
        # A pool whose worker died is broken, and another one takes its place.
        pools.append(
            loky.get_reusable_executor(
                max_workers=2, reuse=False, initializer=die_once, initargs=(marker,)
            )
        )
        return pools[-1]

    result = gb.scan("spur_impact", vary=VARY, models="rigid", executor=pool, shards=4)
    assert os.path.exists(marker) and len(pools) > 1
    assert cells(result) == plain
    pools[-1].shutdown(kill_workers=True)


def test_submitit_runs_each_part_as_a_job_of_which_one_dies(plain, tmp_path):
    submitit = pytest.importorskip("submitit")
    died = []

    class Jobs(Executor):
        """The interface of `concurrent.futures` over submitit's jobs, which are polled."""

        def __init__(self, folder):
            self.executor = submitit.LocalExecutor(folder=folder)
            self.executor.update_parameters(timeout_min=5)
            self.waiting = ThreadPoolExecutor(2)

        def submit(self, function, /, *given, **named):
            def wait():
                job = self.executor.submit(function, *given, **named)
                if not died:
                    died.append(job.job_id)
                    job.cancel()
                return job.result()

            return self.waiting.submit(wait)

    result = gb.scan("spur_impact", vary=VARY, models="rigid", executor=Jobs(tmp_path), shards=3)
    assert died and cells(result) == plain


WITH_MPI = """
import os
import gearbench as gb
from gearbench import _campaign
from mpi4py.futures import MPIPoolExecutor

whole = _campaign.run_part
calls = []

def dies_once(*call):
    # The second part of a process ends it, in the first run of the script.
    calls.append(call)
    if len(calls) == 2 and not os.path.exists({marker}):
        open({marker}, "w").close()
        os.abort()
    return whole(*call)

if __name__ == "__main__":
    _campaign.run_part = dies_once
    with MPIPoolExecutor() as executor:
        gb.scan("spur_impact", vary={vary}, models="rigid", executor=executor, shards=5, out={out})
"""


def test_mpi_goes_on_after_the_parts_that_its_processes_finished(plain, tmp_path):
    pytest.importorskip("mpi4py")
    folders = [os.path.dirname(sys.executable), os.environ.get("PATH", os.defpath)]
    launcher = shutil.which("mpiexec", path=os.pathsep.join(folders))
    if launcher is None:
        pytest.skip("mpiexec is not installed")
    script, out = tmp_path / "scan.py", str(tmp_path / "scan")
    marker = tmp_path / "died"
    script.write_text(WITH_MPI.format(vary=VARY, out=repr(out), marker=repr(str(marker))))
    command = [launcher, "-n", "3", sys.executable, "-m", "mpi4py.futures", str(script)]
    # Open MPI refuses the administrator and more processes than processors unless told otherwise.
    told = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    told["OMPI_MCA_rmaps_base_oversubscribe"] = "1"
    told["PRTE_MCA_rmaps_default_mapping_policy"] = ":oversubscribe"
    for dies in (True, False):
        done = subprocess.run(
            command, env={**os.environ, **told}, capture_output=True, text=True, timeout=300
        )
        assert (done.returncode != 0) == dies, done.stderr
        assert marker.exists()
        # Without a worker MPI ends all processes; finished parts stay.
        assert not dies or os.listdir(f"{out}.parts")
    with open(os.path.join(out, "cells.csv"), encoding="utf-8") as file:
        assert file.read() == plain

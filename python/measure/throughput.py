"""Measures calls from Python: overhead of a call, throughput of short runs, histories without
copies.

python python/measure/throughput.py
"""

from __future__ import annotations

import statistics
import time

import gearbench as gb

IMPACTS = 10_000


def main() -> None:
    """Print the figures."""
    scene = gb.Scene.load("spur_impact")
    simulation = scene.simulation("rigid", "dopri5@1e-6", samples=2)
    native = simulation._native
    native.run_repeatedly(200)
    pieces, python, rust = 50, [], []
    for _ in range(pieces):
        # In turns, since other work of the machine comes and goes.
        rust.append(native.run_repeatedly(IMPACTS // pieces) / (IMPACTS // pieces))
        begin = time.perf_counter()
        for _ in range(IMPACTS // pieces):
            simulation.run()
        python.append((time.perf_counter() - begin) / (IMPACTS // pieces))
    overhead = [p - r for p, r in zip(python, rust)]
    print(f"{IMPACTS} impacts of rigid gears, {1e6 * statistics.median(rust):.1f} us each in Rust")
    print(f"  loop of Python: {100 * sum(rust) / sum(python):.1f} % of the throughput of Rust")
    print(f"  overhead of a call: {1e6 * statistics.median(overhead):.1f} us (median)")

    cells = f"10..100:{IMPACTS}"
    vary = {"gears.pinion.speed_rad_s": cells}
    begin = time.perf_counter()
    gb.scan(scene, vary=vary, models="rigid", threads=1)
    print(
        f"  scan by call, one thread: {1e6 * (time.perf_counter() - begin) / IMPACTS:.1f} us each"
    )

    run = scene.run("rigid", "dopri5@1e-6", samples=1_000_000)
    same = all(
        run.series[name].__array_interface__["data"][0] == address
        for name, address in run.series._written_at.items()
    )
    address = run.series._written_at["time_s"]
    found = run.series.time_s.__array_interface__["data"][0]
    print(f"histories of {len(run.series.time_s)} samples:")
    print(f"  written at {address:#x}, array at {found:#x}")
    print(f"  all {len(run.series._written_at)} arrays own what the run has written: {same}")


if __name__ == "__main__":
    main()

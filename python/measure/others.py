"""Compares gearbench with SciPy and Exudyn on the same impact and the same loaded pair: error and
wall time.

    pip install scipy exudyn
    python python/measure/others.py

Two rigid gears on one undamped spring for the mesh. In the impact one gear meets the other at
rest. In the loaded pair balanced torques act on gears at rest in unloaded contact. Both have
closed forms,

    impact:       F(t) = k v / omega sin(omega t) while it is positive
    loaded pair:  F(t) = F_0 (1 - cos(omega t))

with omega^2 = k (1/m_1 + 1/m_2), m_i = I_i / r_i^2. The error is the root mean square error of the
contact force over the root mean square of the closed form, on the same 1001 times. The lines are
those of the function that makes the run, without its head and its description. The time is the
least of 50 runs with recording.
"""

from __future__ import annotations

import inspect
import time
from collections.abc import Callable
from math import cos, pi, radians
from typing import Any

import gearbench as gb
import numpy as np

MODULE, WIDTH = 5e-3, 20e-3
TEETH = (20, 30)
BASE = [MODULE * z / 2 * cos(radians(20.0)) for z in TEETH]
INERTIA = [0.5 * 7850.0 * pi * WIDTH * (MODULE * z / 2) ** 4 for z in TEETH]
MASS = [i / r**2 for i, r in zip(INERTIA, BASE)]
REDUCED = MASS[0] * MASS[1] / (MASS[0] + MASS[1])
K = 5.72e9 * WIDTH
OMEGA = (K / REDUCED) ** 0.5
SPEED, TORQUE, END = 1.0, 50.0, 1e-3
FORCE = TORQUE / BASE[0]
ROUNDS = 50
TIMES = np.linspace(0.0, END, 1001)
EXACT = {
    "impact": np.maximum(
        0.0,
        np.where(TIMES * OMEGA < pi, K * SPEED * BASE[0] / OMEGA * np.sin(OMEGA * TIMES), 0.0),
    ),
    "loaded pair": FORCE * (1 - np.cos(OMEGA * TIMES)),
}


def of_gearbench(case: str, method: str) -> Callable[[], Any]:
    """A run of gearbench."""
    loaded = case == "loaded pair"

    def gear(i: int) -> gb.Gear:
        torque = (TORQUE, FORCE * BASE[1])[i]
        return gb.Gear(
            teeth=TEETH[i],
            module_m=MODULE,
            face_width_m=WIDTH,
            inertia_kgm2=INERTIA[i],
            speed_rad_s=SPEED if i == 0 and not loaded else None,
            loads=[gb.Load(torque_nm=torque)] if loaded else None,
        )

    stiffness = gb.Stiffness(kind="constant", stiffness_n_per_m2=K / WIDTH, of="mesh")
    scene = gb.Scene(
        gb.Pair(gear(0), gear(1), backlash_m=1e-4, start=gb.Start(flank="left", gap_m=0.0)),
        name="pair",
        duration_s=END,
        models=[gb.Model(model="rigid", contact=gb.Contact(stiffness=stiffness))],
    )
    simulation = scene.simulation("rigid", method, samples=len(TIMES))

    def run() -> Any:
        series = simulation.run().series
        return np.interp(TIMES, series.time_s, series["contact_force_pinion_wheel_n"])

    return run


def of_scipy(case: str, rtol: float) -> Callable[[], Any]:
    """A run of `solve_ivp` with dense output."""
    from scipy.integrate import solve_ivp

    load = FORCE if case == "loaded pair" else 0.0

    def force(x: Any) -> Any:
        return K * np.maximum(0.0, x[0] - x[1])

    def rhs(_: float, x: Any) -> list[float]:
        f = K * max(0.0, x[0] - x[1])
        return [x[2], x[3], (load - f) / MASS[0], (f - load) / MASS[1]]

    start = [0.0, 0.0, 0.0 if load else SPEED * BASE[0], 0.0]
    scale = 1e-3 * SPEED * BASE[0] / OMEGA

    def run() -> Any:
        end = (0.0, END)
        atol = [rtol * scale, rtol * scale, rtol * scale * OMEGA, rtol * scale * OMEGA]
        found = solve_ivp(rhs, end, start, "DOP853", TIMES, rtol=rtol, atol=atol, max_step=END / 20)
        return force(found.y)

    return run


def of_exudyn(case: str, step: float) -> Callable[[], Any]:
    """A run of Exudyn: two masses on the line of action and a spring that only presses."""
    import exudyn as exu
    from exudyn import itemInterface as items

    loaded = case == "loaded pair"
    system = exu.SystemContainer()
    mbs = system.AddSystem()
    markers, nodes = [], []
    for i in range(2):
        velocity = SPEED * BASE[0] if i == 0 and not loaded else 0.0
        node = mbs.AddNode(
            items.Node1D(
                referenceCoordinates=[0.0], initialCoordinates=[0.0], initialVelocities=[velocity]
            )
        )
        mbs.AddObject(items.Mass1D(mass=MASS[i], nodeNumber=node))
        marker = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=0))
        if loaded:
            load = FORCE if i == 0 else -FORCE
            mbs.AddLoad(items.LoadCoordinate(markerNumber=marker, load=load))
        markers.append(marker)
        nodes.append(node)

    def press(_: Any, t: float, n: int, x: float, v: float, k: float, *others: Any) -> float:
        return k * min(0.0, x)

    mbs.AddObject(
        items.ObjectConnectorCoordinateSpringDamperExt(
            markerNumbers=markers, stiffness=K, springForceUserFunction=press
        )
    )
    of_node = [
        mbs.AddSensor(
            items.SensorNode(
                nodeNumber=n,
                outputVariableType=exu.OutputVariableType.Coordinates,
                storeInternal=True,
            )
        )
        for n in nodes
    ]
    mbs.Assemble()
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps = round(END / step)
    settings.timeIntegration.endTime = END
    settings.timeIntegration.verboseMode = 0
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = step

    def run() -> Any:
        mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.RK44)
        a, b = (np.array(mbs.GetSensorStoredData(s)) for s in of_node)
        return np.interp(TIMES, a[:, 0], K * np.maximum(0.0, a[:, 1] - b[:, 1]))

    return run


def main() -> None:
    """Print a row for each program."""
    programs: list[tuple[str, Callable[..., Callable[[], Any]], Any]] = [
        ("gearbench, dopri5 at 1e-8", of_gearbench, "dopri5@1e-8"),
        ("gearbench, trigonometric at 1 us", of_gearbench, "trigonometric@1us"),
        ("SciPy, DOP853 at 1e-8", of_scipy, 1e-8),
        ("Exudyn, RK44 at 1 us", of_exudyn, 1e-6),
    ]
    print("| problem | program | lines | error | time |\n|---|---|---|---|---|")
    for case, exact in EXACT.items():
        runs: dict[str, Callable[[], Any]] = {}
        for name, make, resolution in programs:
            try:
                runs[name] = make(case, resolution)
            except ImportError as error:
                print(f"| {case} | {name} | | left out: {error} | |")
        least = dict.fromkeys(runs, float("inf"))
        for _ in range(ROUNDS):
            # In turns, since other work of the machine comes and goes.
            for name, run in runs.items():
                begin = time.perf_counter()
                run()
                least[name] = min(least[name], time.perf_counter() - begin)
        for name, make, _ in programs:
            if name not in runs:
                continue
            lines = len([x for x in inspect.getsource(make).splitlines() if x.strip()]) - 2
            deviation = np.sqrt(np.mean((runs[name]() - exact) ** 2) / np.mean(exact**2))
            figures = f"{lines} | {deviation:.2e} | {1e3 * least[name]:.3f} ms"
            print(f"| {case} | {name} | {figures} |")


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""FMUs of gearbench in other hosts: under FMPy (FMI 3 and FMI 2) validation, co-simulation against the plain run of the scene,
model exchange, returns to a state, states as bytes; under libcosim (FMI 2, C++) co-simulation.

    cargo build --release
    pip install fmpy libcosimpy
    python3 benchmarks/scripts/fmpy_check.py [target/release/gearbench]

Packs shipped scenes in both versions of the standard, and ends with an error where FMPy finds a problem or results differ by
more than the bounds below. libcosim is left out where it is not installed. `.ci/fmpy.sh` installs both in an environment of its
own and runs this script.
"""

import csv
import subprocess
import sys
import tempfile
from pathlib import Path

import fmpy
from fmpy import extract, instantiate_fmu, read_model_description, simulate_fmu
from fmpy.validation import validate_fmu

try:
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave
except ImportError:
    CosimExecution = None

# Scene, model, method, end [s], communication step [s].
CASES = [
    ("hammer", "rigid", "rk4@2us", 12e-3, 2e-5),
    ("hammer", "movable-teeth", "velocity-verlet@1us", 3e-3, 1e-5),
    ("loaded_mesh", "rigid", "velocity-verlet@200ns", 1e-3, 1e-6),
    ("driveline", "rigid", "velocity-verlet@400ns", 4e-3, 4e-6),
    ("spur_impact", "elastic", "velocity-verlet@50ns", 1.6e-4, 1e-6),
]
# Greatest difference of a motion at the end over its greatest value: between the FMU and the plain run, between one
# communication step and many, between hosts; and between model exchange under CVode (rtol 1e-8) and co-simulation.
EQUAL, EXCHANGED = 1e-12, 1e-4
# The fastest of a hundred modes have lost a tenth of a radian under the method that steps them in co-simulation.
EXCHANGED_MODES = 1e-3


def packed(program, folder, scene, model, method, version):
    path = folder / f"{scene}-{model}-{version}.fmu"
    command = [program, "fmu", scene, "--model", model, "--method", method, "--fmi", version, "--out", str(path)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return path


def plain(program, folder, scene, model, method, end):
    """Last row of the run of a scene without an FMU, by column, with all digits."""
    out = folder / f"{scene}-{model}.csv"
    command = [program, "reference", scene, "--model", model, "--method", method, "--duration", repr(end)]
    subprocess.run(command + ["--digits", "17", "--out", str(out)], check=True, stdout=subprocess.DEVNULL)
    rows = list(csv.DictReader(line for line in out.read_text().splitlines() if not line.startswith("#")))
    assert float(rows[-1]["time_s"]) == end, rows[-1]["time_s"]
    return {name: float(value) for name, value in rows[-1].items() if value}


def columns_of(names, run, model):
    """Columns of the plain run by output of motion: forces multiply the rounding of displacements by the stiffness. In the file
    speeds of gears with teeth or modes of their own are those of their momentum, and angles those of hubs."""
    kinds = {"angle": "hub_angle_{}_rad"}
    if model == "rigid":
        kinds["speed"] = "speed_{}_rad_s"
    found = {}
    for name in names:
        gear, _, kind = name.rpartition(".")
        column = kinds.get(kind, "").format(gear)
        if column in run:
            found[name] = column
    return found


def under_libcosim(path, description, names, step, end):
    """Outputs at the end under libcosim, with fixed communication steps (whole nanoseconds)."""
    references = {v.name: v.valueReference for v in description.modelVariables}
    # Its FMI Library reports that the independent variable has no start value, which the standard forbids.
    log_output_level(CosimLogLevel.FATAL)
    execution = CosimExecution.from_step_size(round(step * 1e9))
    execution.add_local_slave(CosimLocalSlave(str(path), "gears"))
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    execution.simulate_until(round(end * 1e9))
    values = list(observer.last_real_values(0, [references[n] for n in names]))
    return dict(zip(names, values))


def goes_back(path, step):
    """Ten ways astray from a state leave no trace."""
    description = read_model_description(str(path))
    unzipped = extract(str(path))
    fmu = instantiate_fmu(unzipped, description, "CoSimulation")
    references = [v.valueReference for v in description.modelVariables if v.causality == "output"]
    torque = next(v.valueReference for v in description.modelVariables if v.causality == "input")
    if description.fmiVersion == "2.0":
        fmu.setupExperiment(startTime=0.0)
        get, put = fmu.getReal, fmu.setReal
        keep, go_back, free = fmu.getFMUstate, fmu.setFMUstate, fmu.freeFMUstate
        store, restore = fmu.serializeFMUstate, fmu.deSerializeFMUstate
    else:
        get, put = fmu.getFloat64, fmu.setFloat64
        keep, go_back, free = fmu.getFMUState, fmu.setFMUState, fmu.freeFMUState
        store, restore = fmu.serializeFMUState, fmu.deserializeFMUState
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    fmu.doStep(0.0, step)
    kept = keep()
    stored = store(kept)
    ends = []
    for i in range(10):
        if i == 5:
            # The second half starts from the bytes.
            free(kept)
            kept = restore(stored)
        go_back(kept)
        fmu.doStep(step, 20 * step)
        ends.append(list(get(references)))
        put([torque], [10.0 * (i - 5)])
        fmu.doStep(21 * step, 3.3 * step)
    free(kept)
    fmu.terminate()
    fmu.freeInstance()
    return all(end == ends[0] for end in ends)


def main():
    program = sys.argv[1] if len(sys.argv) > 1 else "target/release/gearbench"
    failed = []
    print(f"FMPy {fmpy.__version__}, " + ("libcosim" if CosimExecution else "left out: libcosimpy is not installed"))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for scene, model, method, end, step in CASES:
            run = plain(program, folder, scene, model, method, end)
            results = []
            for version in "32":
                path = packed(program, folder, scene, model, method, version)
                problems = validate_fmu(str(path))
                description = read_model_description(str(path))
                names = [v.name for v in description.modelVariables if v.causality == "output"]
                speeds = [n for n in names if n.endswith(".speed")]
                host = dict(filename=str(path), stop_time=end, output=names)
                many = simulate_fmu(fmi_type="CoSimulation", output_interval=step, **host)
                one = simulate_fmu(fmi_type="CoSimulation", output_interval=end, **host)
                results.append(many)
                scale = {n: abs(many[n]).max() for n in speeds}
                equal = max(abs(many[n][-1] - one[n][-1]) / scale[n] for n in speeds)
                columns = columns_of(names, run, model)
                largest = {n: abs(many[n]).max() or 1.0 for n in names}
                beside = max(abs(many[n][-1] - run[c]) / largest[n] for n, c in columns.items())
                other_host, told = 0.0, ""
                if version == "2" and CosimExecution:
                    values = under_libcosim(path, description, list(columns), step, end)
                    other_host = max(abs(many[n][-1] - values[n]) / largest[n] for n in columns)
                    told = f", of libcosim {other_host:.1e}"
                exchanged = simulate_fmu(
                    fmi_type="ModelExchange", solver="CVode", relative_tolerance=1e-8, output_interval=end / 200,
                    record_events=False, **host,
                )
                other = simulate_fmu(fmi_type="CoSimulation", output_interval=end / 200, **host)
                exchange = max(abs(exchanged[n][-1] - other[n][-1]) / scale[n] for n in speeds)
                back = goes_back(path, step)
                print(
                    f"FMI {version}, {scene} {model} {method}: {len(problems)} problems, "
                    f"{description.numberOfContinuousStates} states; {len(many)} samples; difference from the plain run in "
                    f"{len(columns)} quantities {beside:.1e}, of one step from many {equal:.1e}{told}, of model exchange "
                    f"under CVode {exchange:.1e}; returns {'bit for bit' if back else 'DIFFER'}"
                )
                for problem in problems:
                    print("   ", problem)
                bound = EXCHANGED_MODES if model == "elastic" else EXCHANGED
                same = equal < EQUAL and beside < EQUAL and other_host < EQUAL
                if problems or not back or not same or not exchange < bound:
                    failed.append(f"FMI {version}, {scene} {model}")
            three, two = results
            if any((three[n] != two[n]).any() for n in three.dtype.names):
                failed.append(f"{scene} {model}: FMI 2 and FMI 3 differ")
            else:
                print(f"    all {len(three.dtype.names)} columns of FMI 2 and FMI 3 are equal bit for bit")
    if failed:
        sys.exit(f"failed: {', '.join(failed)}")


if __name__ == "__main__":
    main()

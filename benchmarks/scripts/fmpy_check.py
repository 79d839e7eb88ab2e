#!/usr/bin/env python3
"""FMUs of gearbench under FMPy: validation, co-simulation against the run of the scene, model exchange, going back.

    cargo build --release --workspace
    pip install fmpy
    python3 benchmarks/scripts/fmpy_check.py [target/release/gearbench]

Packs shipped scenes, and ends with an error where FMPy finds a problem or results differ by more than the bounds below.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import fmpy
from fmpy import extract, instantiate_fmu, read_model_description, simulate_fmu
from fmpy.validation import validate_fmu

# Scene, model, method, end [s], communication step [s].
CASES = [
    ("hammer", "rigid", "rk4@2us", 12e-3, 2e-5),
    ("hammer", "movable-teeth", "velocity-verlet@1us", 3e-3, 1e-5),
    ("loaded_mesh", "rigid", "velocity-verlet@200ns", 1e-3, 1e-6),
    ("driveline", "rigid", "velocity-verlet@400ns", 4e-3, 4e-6),
    ("spur_impact", "elastic", "velocity-verlet@50ns", 1.6e-4, 1e-6),
]
# Greatest difference of speeds at the end over their greatest value: between one communication step and many, and of model
# exchange under CVode (rtol 1e-8) beside co-simulation.
EQUAL, EXCHANGED = 1e-12, 1e-4
# The fastest of a hundred modes have lost a tenth of a radian under the method that steps them in co-simulation.
EXCHANGED_MODES = 1e-3


def packed(program, folder, scene, model, method):
    path = folder / f"{scene}-{model}.fmu"
    command = [program, "fmu", scene, "--model", model, "--method", method, "--out", str(path)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return path


def goes_back(path, step):
    """Ten ways astray from a state leave no trace."""
    description = read_model_description(str(path))
    unzipped = extract(str(path))
    fmu = instantiate_fmu(unzipped, description, "CoSimulation")
    references = [v.valueReference for v in description.modelVariables if v.causality == "output"]
    torque = next(v.valueReference for v in description.modelVariables if v.causality == "input")
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    fmu.doStep(0.0, step)
    kept = fmu.getFMUState()
    ends = []
    for i in range(10):
        fmu.setFMUState(kept)
        fmu.doStep(step, 20 * step)
        ends.append(fmu.getFloat64(references))
        fmu.setFloat64([torque], [10.0 * (i - 5)])
        fmu.doStep(21 * step, 3.3 * step)
    fmu.freeFMUState(kept)
    fmu.terminate()
    fmu.freeInstance()
    return all(end == ends[0] for end in ends)


def main():
    program = sys.argv[1] if len(sys.argv) > 1 else "target/release/gearbench"
    failed = []
    print(f"FMPy {fmpy.__version__}")
    with tempfile.TemporaryDirectory() as folder:
        for scene, model, method, end, step in CASES:
            path = packed(program, Path(folder), scene, model, method)
            problems = validate_fmu(str(path))
            description = read_model_description(str(path))
            names = [v.name for v in description.modelVariables if v.causality == "output"]
            speeds = [n for n in names if n.endswith(".speed")]
            run = dict(filename=str(path), stop_time=end, output=names)
            many = simulate_fmu(fmi_type="CoSimulation", output_interval=step, **run)
            one = simulate_fmu(fmi_type="CoSimulation", output_interval=end, **run)
            equal = max(abs(many[n][-1] - one[n][-1]) / abs(many[n]).max() for n in speeds)
            exchanged = simulate_fmu(
                fmi_type="ModelExchange", solver="CVode", relative_tolerance=1e-8, output_interval=end / 200,
                record_events=False, **run,
            )
            other = simulate_fmu(fmi_type="CoSimulation", output_interval=end / 200, **run)
            exchange = max(abs(exchanged[n][-1] - other[n][-1]) / abs(other[n]).max() for n in speeds)
            back = goes_back(path, step)
            print(
                f"{scene} {model} {method}: {len(problems)} problems, {description.numberOfContinuousStates} states, "
                f"{description.numberOfEventIndicators} event indicators; {len(many)} samples, "
                f"one step beside many {equal:.1e}, model exchange under CVode {exchange:.1e}, going back "
                f"{'bit for bit' if back else 'DIFFERS'}"
            )
            for problem in problems:
                print("   ", problem)
            bound = EXCHANGED_MODES if model == "elastic" else EXCHANGED
            bad = problems or not back or not equal < EQUAL or not exchange < bound
            if bad:
                failed.append(f"{scene} {model}")
    if failed:
        sys.exit(f"failed: {', '.join(failed)}")


if __name__ == "__main__":
    main()

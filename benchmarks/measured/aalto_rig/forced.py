"""Amplitudes of two shaft torques under harmonic loads of both motors (numpy, FMPy).

    python3 forced.py [PROGRAM]

Loads are those that the rig's recorder had at the frequency of a steady load: amplitude and phase of the drive torque against the
propeller torque. Each scene of `modes_8mm.toml` and `modes_6mm.toml` has them in place of its own, is packed as an FMU by PROGRAM
(default `gearbench`) and run until the start is forgotten; an amplitude is that of the last ten periods.
"""
import os
import re
import subprocess
import sys
import tempfile

import numpy as np
from fmpy import simulate_fmu

HERE = os.path.dirname(os.path.abspath(__file__))
# Shaft [mm], frequency [Hz], drive torque [N m], its phase [deg], propeller torque [N m].
LOADS = [(8, 32.03, 0.635, 62.9, 3.554), (8, 17.54, 0.730, -96.0, 3.826), (6, 17.83, 0.992, -110.2, 3.752)]
# Steady torques that keep the flanks in contact: those of the two motors, over the ratio of 12.
STEADY = (1.0, 12.0)
TORQUES = ["shaft_torque_n18_n19", "shaft_torque_n8_n9"]
METHOD = "generalised-alpha(rho_inf=0.8)@1e-4"


def scene(shaft, frequency, drive, phase, propeller):
    """A scene of the rig with harmonic loads, and its duration."""
    with open(os.path.join(HERE, f"modes_{shaft}mm.toml")) as f:
        text = f.read()
    harmonic = "{{ harmonic = {{ mean_nm = {}, amplitude_nm = {}, frequency_hz = {}, phase_deg = {} }} }}, "
    for body, load in (
        ("n0", harmonic.format(STEADY[0], drive, frequency, phase)),
        ("n21", harmonic.format(-STEADY[1], -propeller, frequency, 0.0)),
    ):
        own = r'(body = "%s"[^\n]*?loads = \[)(\{ torque_nm = [^}]*\}, )?' % body
        text, count = re.subn(own, lambda found: found.group(1) + load, text)
        assert count == 1, body
    end = round(1.0 + 30.0 / frequency, 3)
    return re.sub(r"duration_s = .*", f"duration_s = {end}", text, count=1), end


def main(program):
    for shaft, frequency, *loads in LOADS:
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "forced.toml")
            text, end = scene(shaft, frequency, *loads)
            with open(path, "w") as f:
                f.write(text)
            fmu = os.path.join(folder, "forced.fmu")
            subprocess.run([program, "fmu", path, "--model", "rigid", "--method", METHOD, "--out", fmu], check=True, stdout=subprocess.DEVNULL)
            found = simulate_fmu(fmu, fmi_type="CoSimulation", stop_time=end, output_interval=1e-3, output=TORQUES)
        last = found[found["time"] > end - 10.0 / frequency]
        angle = 2.0 * np.pi * frequency * last["time"]
        basis = np.array([np.cos(angle), np.sin(angle), np.ones(len(angle))]).T
        fits = [np.linalg.lstsq(basis, last[name], rcond=None)[0] for name in TORQUES]
        amplitudes = ", ".join(f"{name} {np.hypot(*fit[:2]):.4f} N m" for name, fit in zip(TORQUES, fits))
        print(f"{shaft} mm shaft, {frequency} Hz: {amplitudes}")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "gearbench")

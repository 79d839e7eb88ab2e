"""Makes the tables of the step of load from the records of the rig (numpy).

    python3 tables.py SOURCE

SOURCE is a copy of the repository `urho-h/torque_estimation_masters` (see README.md). Written are `tables/step_up.csv` and
`tables/step_down.csv`: 1 s about each edge of the load at 1 kHz, 0 at the edge.

The two recorders are not synchronised: the lag of the motor's behind the sensors' is that at which the rig's own model fits
best, to 0.5 ms. What turns with the propeller shaft is taken off the torques of the shafts: orders 1 to 72 of its angle,
fitted where the state is steady (before the edge, and behind it where the state after has settled); no model of the drive
train has these.
"""
import csv
import os
import sys

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
RATIO = 12.0
ORDERS = 72
# Time of the edge and lag of the motor's recorder, in seconds of the sensors' recorder.
EDGES = {"up": (4.66826, 0.4658), "down": (9.82256, 0.4608)}
# Steady states, likewise.
STEADY = {"before up": (0.0, 4.618), "after up": (5.668, 9.773), "before down": (5.668, 9.773), "after down": (10.823, 12.815)}


def read(source, name):
    return np.loadtxt(os.path.join(source, "data", "masters_data2", name + ".csv"), delimiter=",")


def shapes(angle):
    return np.array([np.ones(len(angle))] + [f(k * angle) for k in range(1, ORDERS + 1) for f in (np.cos, np.sin)]).T


def turning(time, x, angle, basis, span):
    """The part of a history that turns with the shaft, without its mean, as fitted over a span."""
    within = (time >= span[0]) & (time <= span[1])
    found = np.linalg.lstsq(basis[within], x[within], rcond=None)[0]
    found[0] = 0.0
    return basis @ found


def main(source):
    motor, sensor = read(source, "step_motor"), read(source, "step_sensor")
    time = sensor[:, 0]
    steps = np.diff(time) * 0.5 * (sensor[1:, 1] + sensor[:-1, 1])
    angle = np.concatenate([[0.0], np.cumsum(steps)]) / RATIO
    basis = shapes(angle)
    os.makedirs(os.path.join(HERE, "tables"), exist_ok=True)
    for name, (edge, lag) in EDGES.items():
        t = np.arange(-300, 700) / 1000.0
        at = lambda x: np.interp(t + edge, time, x)
        loads = [np.interp(t + edge - lag, motor[:, 0], motor[:, k]) for k in (2, 4)]
        torques = []
        for k in (3, 4):
            before = turning(time, sensor[:, k], angle, basis, STEADY["before " + name])
            after = turning(time, sensor[:, k], angle, basis, STEADY["after " + name])
            torques.append(at(sensor[:, k] - np.where(time < edge, before, after)))
        path = os.path.join(HERE, "tables", f"step_{name}.csv")
        with open(path, "w", newline="") as f:
            out = csv.writer(f)
            out.writerow(["time_s", "drive_torque_nm", "propeller_torque_nm", "shaft_torque_n8_n9_nm", "shaft_torque_n18_n19_nm"])
            for row in zip(t, *loads, *torques):
                out.writerow([f"{x:.6g}" for x in row])
        print(path)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])

"""The two-degree-of-freedom impact and hammering problems in SciPy, for `cargo bench --bench against_scipy`.

What a careful researcher writes by hand: two rigid gears, one spring-damper on the line of action with
backlash that never pulls, `solve_ivp` with and without restarts at contact events. Prints and writes one row per
method and tolerance: wall and processor time of the integration alone (median of repeats, no output in the
timed part) and the rms error of the pinion's speed over its span, against the exact piecewise solution on
5001 points.

Usage: python3 scipy_floor.py OUT.csv        (pip install numpy scipy; written with numpy 2.3, scipy 1.16)
"""

import csv
import sys
import time
from math import atan2, cos, exp, pi, radians, sin, sqrt

import numpy as np
import scipy
from scipy.integrate import solve_ivp

MODULE, WIDTH, DENSITY, ALPHA = 5e-3, 20e-3, 7850.0, radians(20.0)
PITCH = [MODULE * 20 / 2, MODULE * 30 / 2]
BASE = [r * cos(ALPHA) for r in PITCH]
INERTIA = [0.5 * DENSITY * pi * WIDTH * r**4 for r in PITCH]
MASS = [j / r**2 for j, r in zip(INERTIA, BASE)]
REDUCED = MASS[0] * MASS[1] / (MASS[0] + MASS[1])
STIFFNESS = 5.72e9 * WIDTH
RATIO = 0.05
DAMPER = 2 * RATIO * sqrt(STIFFNESS * REDUCED)
HALF = 0.05e-3  # half the backlash along the line of action

# End time, start of the relative coordinate, speeds (the wheel's counted positive when driven).
PROBLEMS = {
    "impact": (1e-3, HALF, 1.0, 0.0),
    "hammer": (0.25, 0.0, 101.0, 99.0 * 2 / 3),
}


def exact(name, grid):
    """Pinion speed on a grid: free flight and damped half oscillations, one after the other."""
    end, s, w1, w2 = PROBLEMS[name]
    mean = (MASS[0] * BASE[0] * w1 + MASS[1] * BASE[1] * w2) / (MASS[0] + MASS[1])
    v = BASE[0] * w1 - BASE[1] * w2
    omega0 = sqrt(STIFFNESS / REDUCED)
    decay = RATIO * omega0
    omega = omega0 * sqrt(1 - RATIO**2)
    release = (pi - atan2(DAMPER * omega, STIFFNESS - DAMPER * decay)) / omega
    rate = np.zeros_like(grid)
    t, touching = 0.0, abs(s) >= HALF and s * v > 0
    while t <= end:
        if touching:
            inside = (grid >= t) & (grid <= t + release)
            tau = grid[inside] - t
            rate[inside] = v * np.exp(-decay * tau) * (
                np.cos(omega * tau) - decay / omega * np.sin(omega * tau)
            )
            e, side = exp(-decay * release), (1.0 if s > 0 else -1.0)
            s = side * HALF + v / omega * e * sin(omega * release)
            v = v * e * (cos(omega * release) - decay / omega * sin(omega * release))
            t += release
        else:
            target = HALF if v > 0 else -HALF
            flight = (target - s) / v
            rate[(grid >= t) & (grid <= t + flight)] = v
            s, t = target, t + flight
        touching = not touching
    return (mean + rate * MASS[1] / (MASS[0] + MASS[1])) / BASE[0]


def force(s, v):
    if s > HALF:
        return max(0.0, STIFFNESS * (s - HALF) + DAMPER * v)
    if s < -HALF:
        return min(0.0, STIFFNESS * (s + HALF) + DAMPER * v)
    return 0.0


def rhs(_, y):
    f = force(BASE[0] * y[0] - BASE[1] * y[1], BASE[0] * y[2] - BASE[1] * y[3])
    return [y[2], y[3], -f * BASE[0] / INERTIA[0], f * BASE[1] / INERTIA[1]]


def start(name):
    end, s, w1, w2 = PROBLEMS[name]
    return end, [s / BASE[0], 0.0, w1, w2]


def scales(rtol):
    return rtol * np.array([1e-4, 1e-4, 1.0, 1.0])


def plain(name, method, rtol, grid):
    end, y = start(name)
    r = solve_ivp(rhs, (0, end), y, method=method, rtol=rtol, atol=scales(rtol), t_eval=grid)
    return r.y[2] if grid is not None else None


def restarted(name, method, rtol, grid):
    """Stops at every opening and closing and starts afresh, on a force without kinks."""
    end, y = start(name)
    y, t = np.array(y), 0.0
    gap = lambda y: BASE[0] * y[0] - BASE[1] * y[1]
    rate = lambda y: BASE[0] * y[2] - BASE[1] * y[3]
    side = 1.0 if gap(y) >= HALF and rate(y) > 0 else 0.0
    out = None if grid is None else np.zeros_like(grid)
    while t < end * (1 - 1e-14):
        if side:
            push = lambda y: STIFFNESS * (gap(y) - side * HALF) + DAMPER * rate(y)
            f = lambda _, y: [y[2], y[3], -push(y) * BASE[0] / INERTIA[0], push(y) * BASE[1] / INERTIA[1]]
            event = lambda _, y: side * push(y)
            event.direction = -1
            step = {"first_step": 1e-7, "max_step": 5e-5}
        else:
            toward = 1.0 if rate(y) > 0 else -1.0
            f = lambda _, y: [y[2], y[3], 0.0, 0.0]
            event = lambda _, y: toward * gap(y) - HALF
            event.direction = 1
            step = {}
        event.terminal = True
        r = solve_ivp(f, (t, end), y, method=method, rtol=rtol, atol=scales(rtol), events=event,
                      dense_output=grid is not None, **step)
        if grid is not None:
            inside = (grid >= t) & (grid <= r.t[-1])
            out[inside] = r.sol(grid[inside])[2]
        t, y = r.t[-1], r.y[:, -1].copy()
        if r.status == 0:
            break
        side = 0.0 if side else (1.0 if rate(y) > 0 else -1.0)
    return out


def main(path):
    print(f"numpy {np.__version__}, scipy {scipy.__version__}, Python {sys.version.split()[0]}")
    with open(path, "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(["problem", "method", "rtol", "error", "wall_s", "cpu_s"])
        for name in PROBLEMS:
            grid = np.linspace(0, PROBLEMS[name][0], 5001)
            truth = exact(name, grid)
            span = truth.max() - truth.min()
            for run, suffix in (plain, ""), (restarted, " + events"):
                for method in "RK45", "DOP853", "LSODA", "Radau":
                    for exponent in range(3, 11):
                        rtol = 10.0**-exponent
                        try:
                            error = sqrt(np.mean((run(name, method, rtol, grid) - truth) ** 2)) / span
                            walls, cpus = [], []
                            while len(walls) < 3 or (sum(walls) < 0.3 and len(walls) < 15):
                                wall, cpu = time.perf_counter(), time.process_time()
                                run(name, method, rtol, None)
                                walls.append(time.perf_counter() - wall)
                                cpus.append(time.process_time() - cpu)
                                if walls[-1] > 5:
                                    break
                        except (ValueError, ArithmeticError, IndexError) as reason:
                            print(f"{name:7} {method + suffix:16} {rtol:.0e}  failed: {reason}")
                            continue
                        row = [name, method + suffix, rtol, error, np.median(walls), np.median(cpus)]
                        table.writerow(row)
                        print(f"{name:7} {row[1]:16} {rtol:.0e}  error {error:.1e}  {row[4] * 1e3:9.3f} ms",
                              flush=True)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])

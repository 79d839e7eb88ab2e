"""Measures what contact laws in Python cost against the built-in law of Hunt and Crossley.

python python/measure/laws.py
"""

from __future__ import annotations

import time
from typing import Any

import gearbench as gb

E = 0.8
STIFFNESS = 1e10 * 1e-5**-0.5
ROUNDS = 15


def force(gap: float, gap_rate: float, stiffness: float, touch_speed: float) -> float:
    """The force alone."""
    speed = max(touch_speed, abs(gap_rate))
    return stiffness * float((-gap) ** 1.5) * (1.0 - 1.5 * (1.0 - E) * gap_rate / speed)


def with_derivatives(
    gap: float, gap_rate: float, stiffness: float, touch_speed: float
) -> tuple[float, float, float]:
    """The force with its derivatives."""
    speed = max(touch_speed, abs(gap_rate))
    chi, d = 1.5 * (1.0 - E), -gap
    root = float(d**0.5)
    elastic, factor = stiffness * d * root, 1.0 - chi * gap_rate / speed
    by_rate = -chi * elastic / speed if speed == touch_speed else 0.0
    return elastic * factor, -1.5 * stiffness * root * factor, by_rate


def potential(gap: float, stiffness: float) -> float:
    """The integral of the force at rest."""
    return stiffness * float((-gap) ** 2.5) / 2.5


class Counted:
    """A law that counts its calls."""

    def __init__(self, law: Any) -> None:
        self.law, self.calls = law, 0

    def __call__(self, gap: float, gap_rate: float, stiffness: float, touch_speed: float) -> Any:
        self.calls += 1
        return self.law(gap, gap_rate, stiffness, touch_speed)


def impact(**law: Any) -> gb.Scene:
    """One impact of rigid gears."""
    gear = gb.Gear(teeth=20, module_m=4e-3, face_width_m=10e-3, speed_rad_s=20.0)
    stiffness = gb.Stiffness(kind="constant", stiffness_n_per_m2=STIFFNESS)
    return gb.Scene(
        gb.Pair(
            gear,
            gear.replace(teeth=30, speed_rad_s=None),
            backlash_m=80e-6,
            start=gb.Start(flank="left", gap_m=2e-6),
        ),
        name="impact",
        duration_s=2e-4,
        models=[gb.Model(model="rigid", contact=gb.Contact(stiffness=stiffness, **law))],
    )


def main() -> None:
    """Print a row for each method."""
    known = {"exponent": 1.5, "damping": gb.ContactDamping(law="hunt-crossley", e=E)}
    print("| method | built-in | force | and potential | and derivatives | calls | each |")
    print("|---|---|---|---|---|---|---|")
    for method in ("dopri5@1e-6", "rk4@0.5us", "trigonometric@0.5us", "newmark@0.5us"):
        laws: list[dict[str, Any]] = [
            known,
            {"normal_force": force},
            {"normal_force": gb.ContactLaw(force, potential=potential)},
            {"normal_force": gb.ContactLaw(with_derivatives, potential=potential)},
        ]
        runs = [impact(**law).simulation("rigid", method, samples=2) for law in laws]
        least = [float("inf")] * len(runs)
        for _ in range(ROUNDS):
            for i, run in enumerate(runs):
                begin = time.perf_counter()
                run.run()
                least[i] = min(least[i], time.perf_counter() - begin)
        counted = Counted(force)
        one = impact(normal_force=counted).simulation("rigid", method, samples=2)
        before = counted.calls
        one.run()
        calls = counted.calls - before
        a, b, c, d = (1e3 * x for x in least)
        each = 1e3 * (b - a) / calls
        times = " | ".join(f"{x:.2f} ms" for x in (a, b, c, d))
        print(f"| {method} | {times} | {calls} | {each:.2f} us |")


if __name__ == "__main__":
    main()

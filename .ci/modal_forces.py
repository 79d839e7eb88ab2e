#!/usr/bin/env python3
"""Tables of .ci/modal.sh: contact forces and frequencies with the data of CalculiX against those with own data.

    modal_forces.py FOLDER

Writes FOLDER/modal.csv and FOLDER/modal_c3d8i.csv, prints them, and fails where a force with the matrices of CalculiX
differs by more than 1e-6 of the peak.
"""
import csv
import glob
import json
import os
import sys

LIMIT = 1e-6


def force(folder, label):
    """Times and contact forces of a run."""
    paths = glob.glob(os.path.join(folder, "compare", f"run*-elastic-{label}-trigonometric.csv"))
    assert len(paths) == 1, f"{len(paths)} runs of {label}"
    with open(paths[0], newline="") as file:
        rows = list(csv.DictReader(file))
    return [[float(r[c]) for r in rows] for c in ("time_s", "contact_force_pinion_wheel_n")]


def forces(folder):
    """The table of forces, and the largest difference with matrices of CalculiX."""
    rows, worst = ["mesh,data,instants,peak_n,largest_difference_over_peak"], 0.0
    for mesh in ["fine", "own"]:
        times, own = force(folder, f"{mesh}-gearbench")
        peak = max(abs(f) for f in own)
        for data in ["matrices", "shapes"]:
            other_times, other = force(folder, f"{mesh}-{data}")
            assert times == other_times, f"{mesh}-{data}: the instants differ"
            difference = max(abs(a - b) for a, b in zip(own, other)) / peak
            rows.append(f"{mesh},{data},{len(own)},{peak:.3f},{difference:.1e}")
            if data == "matrices":
                worst = max(worst, difference)
    return rows, worst


def frequencies(folder):
    """Frequencies of a held gear of C3D8I: as CalculiX prints them, with its matrices, of gearbench."""
    printed, inside = [], False
    with open(os.path.join(folder, "inner.dat")) as file:
        for line in file:
            joined = "".join(line.split())
            inside = inside and not joined.startswith("PARTICIPATION") or joined == "EIGENVALUEOUTPUT"
            words = line.split()
            if inside and len(words) == 5 and words[0].isdigit():
                printed.append(float(words[3]))
    found = []
    for data in ["matrices", "gearbench"]:
        with open(os.path.join(folder, f"inner-{data}.json")) as file:
            found.append(json.load(file)["gears"][0]["frequencies_hz"])
    rows = ["mode,calculix_hz,matrices_hz,gearbench_hz"]
    for i, f in enumerate(printed[:20]):
        rows.append(f"{i + 1},{f:.2f},{found[0][i]:.2f},{found[1][i]:.2f}")
    return rows


def main():
    folder = sys.argv[1]
    table, worst = forces(folder)
    for name, rows in [("modal.csv", table), ("modal_c3d8i.csv", frequencies(folder))]:
        text = "\n".join(rows) + "\n"
        with open(os.path.join(folder, name), "w") as file:
            file.write(text)
        print(text)
    if worst > LIMIT:
        sys.exit(f"a force with the matrices of CalculiX differs by {worst:.1e} of the peak, allowed {LIMIT:.0e}")


main()

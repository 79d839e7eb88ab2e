#!/usr/bin/env bash
# Both passes of the modal data of another program: CalculiX assembles the gears of spur_impact, `gearbench reduce` reduces
# them with its matrices and with its mode shapes, and a scene compares the contact forces with those of the reduction of
# gearbench on the same meshes.
#
#   .ci/modal.sh [FOLDER]        default target/modal; the tables are FOLDER/modal.csv and FOLDER/modal_c3d8i.csv
#
# Needs CalculiX 2.20 (Debian: apt-get install calculix-ccx; another name or path: CCX=...) and Python 3; without them the
# script reports "left out: " and fails nothing. It fails where a force differs by more than 1e-6 of the peak. CalculiX
# takes about two minutes of processor time; its results are kept for the next run. Stored tables: validation/results.
set -euo pipefail
cd "$(dirname "$0")/.."
root=$PWD
work=${1:-target/modal}
ccx=${CCX:-ccx}

leave_out() { echo "left out: modal data of CalculiX, $*"; exit 0; }
command -v "$ccx" > /dev/null || leave_out "$ccx was not found"
command -v python3 > /dev/null || leave_out "Python was not found"
program=${GEARBENCH:-${CARGO_TARGET_DIR:-$root/target}/release/gearbench}
[ -x "$program" ] || cargo build --release --locked --bins

mkdir -p "$work"
cd "$work"
export GEARBENCH_CACHE=off

# Mesh `fine` is that of the model `elastic` (C3D8), mesh `own` is generated (C3D8). The C3D8I of CalculiX has coordinates and a
# mass of its own and is another element than that of gearbench: its frequencies are compared alone.
"$program" mesh "$root/reference/calculix/case-a-fine/AF8_d05.inp.gz" --modal calculix --force --out fine.inp
"$program" mesh spur_impact --element C3D8 --flank 6 --fillet 2 --across 4 --layers 1 --rim 2 --width 1 --modal calculix \
  --force --out own.inp
"$program" mesh spur_impact --gear pinion --element C3D8I --flank 4 --fillet 2 --across 4 --layers 1 --rim 2 --width 2 \
  --modal calculix --modes 20 --force --out inner.inp
decks="fine-gear1 fine-gear2 own-pinion own-wheel"
for deck in $decks inner; do
  if [ -s "$deck.mas" ] && cmp -s "$deck.inp" "$deck.solved"; then continue; fi
  echo "CalculiX: $deck"
  OMP_NUM_THREADS=1 "$ccx" "$deck" > "$deck.log" || { tail -20 "$deck.log" >&2; exit 1; }
  cp "$deck.inp" "$deck.solved"
done
for deck in $decks; do
  "$program" reduce "$deck.inp" --modes 100 --force --out "$deck-gearbench.npz" > "$deck-gearbench.txt"
  "$program" reduce "$deck.inp" --modes 100 --matrices "$deck.sti" --force --out "$deck-matrices.npz" | tee "$deck-matrices.txt"
  "$program" reduce "$deck.inp" --modes 100 --matrices "$deck.sti" --shapes "$deck.frd" --force --out "$deck-shapes.npz" \
    > "$deck-shapes.txt"
done
"$program" reduce inner.inp --modes 20 --mount held --json > inner-gearbench.json
"$program" reduce inner.inp --modes 20 --mount held --matrices inner.sti --json > inner-matrices.json

# The gears and the start of spur_impact.
python3 - "$root/benchmarks/scenes/spur_impact.toml" > modal.toml << 'SCENE'
import sys

text = open(sys.argv[1]).read()
print("""schema = 1
name = "modal"
title = "spur_impact with the matrices of CalculiX"
duration_s = 0.16e-3
""")
print(text[text.index("[gears.pinion]"):text.index("[[models]]")])
for mesh, names, contact in [
    ("fine", ["gear1", "gear2"], 'penalty_pa_per_m = 1e15, surface = "faceted", passes = "first"'),
    ("own", ["pinion", "wheel"], 'local = "half-space"'),
]:
    for data in ["gearbench", "matrices", "shapes"]:
        gears = "".join(
            f'gears.{gear} = {{ model = "elastic", parameters = {{ reduction = "{mesh}-{name}-{data}.npz", modes = 100 }} }}\n'
            for gear, name in zip(["pinion", "wheel"], names)
        )
        print(f"""[[models]]
label = "{mesh}-{data}"
model = "elastic"
{gears}contact = {{ {contact} }}
integrators = [{{ method = "trigonometric", step_s = 1e-6 }}]
""")
SCENE
"$program" compare modal.toml --repeats 1 --out compare > compare.txt
python3 "$root/.ci/modal_forces.py" .

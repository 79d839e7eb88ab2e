#!/usr/bin/env bash
# Both passes of the modal data of another program: CalculiX assembles the gears of spur_impact, `gearbench reduce` reduces
# them with its matrices and with its mode shapes, and a scene compares the contact forces with those of the reduction of
# gearbench on the same meshes.
#
#   .ci/modal.sh [FOLDER]        default target/modal; the table is FOLDER/modal.csv
#
# Needs CalculiX 2.20 (Debian: apt-get install calculix-ccx; another name or path: CCX=...) and Python 3; without them the
# script reports "left out: " and fails nothing. It fails where a force differs by more than 1e-6 of the peak.
# validation/results/modal.csv is a stored table.
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

# Mesh `fine` is that of the model `elastic` (C3D8). Mesh `inner` has elements with incompatible modes (C3D8I), to which
# CalculiX gives coordinates of their own.
"$program" mesh "$root/reference/calculix/case-a-fine/AF8_d05.inp.gz" --modal calculix --modes 100 --force --out fine.inp
"$program" mesh spur_impact --flank 8 --fillet 3 --across 4 --layers 1 --rim 3 --width 2 --modal calculix --modes 100 \
  --force --out inner.inp
decks="fine-gear1 fine-gear2 inner-pinion inner-wheel"
for deck in $decks; do
  [ -s "$deck.mas" ] && [ "$deck.mas" -nt "$deck.inp" ] && continue
  echo "CalculiX: $deck"
  OMP_NUM_THREADS=1 "$ccx" "$deck" > "$deck.log" || { tail -20 "$deck.log" >&2; exit 1; }
done
for deck in $decks; do
  "$program" reduce "$deck.inp" --modes 100 --force --out "$deck-gearbench.npz" > "$deck-gearbench.txt"
  "$program" reduce "$deck.inp" --modes 100 --matrices "$deck.sti" --force --out "$deck-matrices.npz" | tee "$deck-matrices.txt"
  "$program" reduce "$deck.inp" --modes 100 --matrices "$deck.sti" --shapes "$deck.frd" --force --out "$deck-shapes.npz" \
    > "$deck-shapes.txt"
done

# The gears and the start of spur_impact; in its contacts the meshes are those of the two models.
python3 - "$root/benchmarks/scenes/spur_impact.toml" > modal.toml << 'SCENE'
import sys
text = open(sys.argv[1]).read()
gears = text[text.index("[gears.pinion]"):text.index("[[models]]")]
print("""schema = 1
name = "modal"
title = "spur_impact with the matrices of CalculiX"
duration_s = 0.16e-3
""")
print(gears)
for mesh, names, contact in [
    ("fine", ["gear1", "gear2"], 'penalty_pa_per_m = 1e15, surface = "faceted", passes = "first"'),
    ("inner", ["pinion", "wheel"], 'local = "half-space"'),
]:
    for origin in ["gearbench", "matrices", "shapes"]:
        print(f"""[[models]]
label = "{mesh}-{origin}"
model = "elastic"
gears.pinion = {{ model = "elastic", parameters = {{ reduction = "{mesh}-{names[0]}-{origin}.npz", modes = 100 }} }}
gears.wheel = {{ model = "elastic", parameters = {{ reduction = "{mesh}-{names[1]}-{origin}.npz", modes = 100 }} }}
contact = {{ {contact} }}
integrators = [{{ method = "trigonometric", step_s = 1e-6 }}]
""")
SCENE
"$program" compare modal.toml --repeats 1 --out compare > compare.txt
python3 "$root/.ci/modal_forces.py" compare "$("$ccx" -v | tr -dc '0-9.' )" | tee modal.csv

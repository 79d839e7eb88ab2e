#!/bin/sh
# Runs CalculiX on the deck of an impact that gearbench wrote, and turns its output into a CSV with the columns
# of the stored references.
#
#   reference/calculix/own_deck.sh DECK.inp [DIR]
#
# DECK.inp  as `gearbench_reference::deck::write_impact` writes it, for example
#             cargo run --release -p gearbench-reference --example rewrite_impact -- \
#                 reference/calculix/case-a-coarse/A8_d05.inp.gz own.inp 5e-7 3e-5
# DIR       folder to work in (default out/calculix/own)
#
# Needs ccx 2.20 (Debian: apt-get install calculix-ccx; another name or path: CCX=...) and Python 3. The
# momentum means need C3D8 elements.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
deck=${1:?usage: own_deck.sh DECK.inp [DIR]}
work=${2:-out/calculix/own}
name=$(basename "$deck" .inp)
mkdir -p "$work"
[ "$(cd "$(dirname "$deck")" && pwd)" = "$(cd "$work" && pwd)" ] || cp "$deck" "$work/$name.inp"
(cd "$work" && OMP_NUM_THREADS=1 "${CCX:-ccx}" "$name" > "$name.log") || {
    tail -20 "$work/$name.log" >&2
    exit 1
}
python3 "$here/dat_to_csv.py" "$work/$name" -o "$work/$name.csv"
echo "$work/$name.csv"

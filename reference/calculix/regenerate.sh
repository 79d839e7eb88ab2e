#!/bin/sh
# Runs a stored CalculiX deck again and turns its output into the stored CSV.
#
#   reference/calculix/regenerate.sh CASE [END_S [DIR]]
#
# CASE   case-a-fine or case-c
# END_S  simulated time [s] instead of the deck's own, to look at the beginning only
# DIR    folder to work in (default out/calculix/CASE)
#
# Needs ccx 2.20 (Debian: apt-get install calculix-ccx; another name or path: CCX=...) and Python 3.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
case_=${1:?usage: regenerate.sh case-a-fine|case-c [END_S [DIR]]}
work=${3:-out/calculix/$case_}
deck=$(ls "$here/$case_"/*.inp.gz) || { echo "no case '$case_' in $here" >&2; exit 2; }
name=$(basename "$deck" .inp.gz)
mkdir -p "$work"
gunzip -c "$deck" > "$work/$name.inp"
if [ -n "${2:-}" ]; then
    # The line after *DYNAMIC is "step, end".
    sed -i.whole "/^\*DYNAMIC/{n;s/,.*/, $2/;}" "$work/$name.inp"
fi
(cd "$work" && OMP_NUM_THREADS=1 "${CCX:-ccx}" "$name" > "$name.log")
python3 "$here/dat_to_csv.py" "$work/$name" -o "$work/results.csv"
echo "$work/results.csv (stored: $here/$case_/results.csv)"

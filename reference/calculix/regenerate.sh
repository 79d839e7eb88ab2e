#!/bin/sh
# Runs stored CalculiX decks again.
#
#   reference/calculix/regenerate.sh CASE [END_S [DIR]]
#
# CASE   an impact, case-a-fine, case-a-graded, case-c, case-a-coarse, rack-pinion, helical or helical-tilted: its output becomes the stored CSV;
#        modal: prints the frequencies of every deck; static: prints the force per width of every deck
# END_S  simulated time [s] instead of the deck's own, to look at the beginning only (impacts; "" leaves it)
# DIR    folder to work in (default out/calculix/CASE)
#
# Needs ccx 2.20 (Debian: apt-get install calculix-ccx; another name or path: CCX=...) and Python 3.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
case_=${1:?usage: regenerate.sh case-a-fine|case-a-graded|case-c|case-a-coarse|rack-pinion|helical|helical-tilted|modal|static [END_S [DIR]]}
work=${3:-out/calculix/$case_}
ls "$here/$case_"/*.inp.gz > /dev/null || { echo "no case '$case_' in $here" >&2; exit 2; }
mkdir -p "$work"
for deck in "$here/$case_"/*.inp.gz; do
    name=$(basename "$deck" .inp.gz)
    gunzip -c "$deck" > "$work/$name.inp"
    if [ -n "${2:-}" ]; then
        # The line after *DYNAMIC is "step, end".
        sed -i.whole "/^\*DYNAMIC/{n;s/,.*/, $2/;}" "$work/$name.inp"
    fi
    (cd "$work" && OMP_NUM_THREADS=1 "${CCX:-ccx}" "$name" > "$name.log")
    case $case_ in
    modal)
        # "mode, eigenvalue, rad/time, cycles/time, imaginary part"
        awk -v name="$name" '/E I G E N V A L U E   O U T P U T/ {on = 1; next} /P A R T I C I P A T I O N/ {on = 0}
            on && NF == 5 && $1 ~ /^[0-9]+$/ {printf "%s,%d,%.5f\n", name, $1, $4}' "$work/$name.dat" \
            | tee "$work/$name.csv"
        ;;
    static)
        # The moment on hub 1 is the z component of the reaction of the first node in the set rots.
        awk -v name="$name" '/^ *forces .* for set ROTS/ {on = 2; next}
            on && NF == 4 {if (on == 2) moment = $4; on--; if (on == 1) on = 0}
            END {printf "%s: moment %.6e N m, force %.2f N per mm of width\n", name, moment,
                moment / 0.037587704831436336 / 10}' "$work/$name.dat"
        ;;
    *)
        python3 "$here/dat_to_csv.py" "$work/$name" -o "$work/results.csv"
        echo "$work/results.csv (stored: $here/$case_/results.csv)"
        ;;
    esac
done

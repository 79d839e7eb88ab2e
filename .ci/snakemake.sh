#!/usr/bin/env bash
# Installs Snakemake for the test of the workflow `gearbench init snakemake` into a virtual environment of the checkout.
# The only line on standard output is the path of the executable, target/tools/snakemake/bin/snakemake, or "left out: "
# with the reason. The exit code is 0 in both cases: a missing Python or a missing network is reported and fails nothing.
set -euo pipefail
cd "$(dirname "$0")/.."

version=9.27.1
folder=target/tools/snakemake
snakemake=$PWD/$folder/bin/snakemake

leave_out() { echo "left out: $*"; exit 0; }

if [ "$("$snakemake" --version 2> /dev/null || true)" != "$version" ]; then
  command -v python3 > /dev/null || leave_out "Snakemake is not installed, python3 was not found"
  mkdir -p target/tools
  log=target/tools/snakemake.log
  python3 -m venv --clear "$folder" > "$log" 2>&1 || leave_out "Snakemake is not installed, python3 -m venv failed ($log)"
  "$folder/bin/pip" install --quiet --disable-pip-version-check "snakemake==$version" >> "$log" 2>&1 \
    || leave_out "Snakemake is not installed, pip failed ($log)"
fi
echo "$snakemake"

#!/usr/bin/env bash
# FMUs of both versions of FMI under FMPy, and of FMI 2 under libcosim, in an environment of the checkout (target/tools/fmpy).
# A missing Python, or a missing network, is reported as "left out: " and fails nothing; so is libcosim, which has no package for
# every version of Python.
set -euo pipefail
cd "$(dirname "$0")/.."

folder=$PWD/target/tools/fmpy
leave_out() { echo "left out: $*"; exit 0; }

if [ ! -x "$folder/bin/python" ] || ! "$folder/bin/python" -c 'import fmpy' 2> /dev/null; then
  command -v python3 > /dev/null || leave_out "FMUs are not checked with FMPy, no Python was found"
  rm -rf "$folder"
  python3 -m venv "$folder" > /dev/null 2>&1 || leave_out "FMUs are not checked with FMPy, venv failed"
  "$folder/bin/pip" install --quiet --disable-pip-version-check 'fmpy>=0.3.22' > /dev/null 2>&1 \
    || { rm -rf "$folder"; leave_out "FMUs are not checked with FMPy, pip failed"; }
fi
if ! "$folder/bin/python" -c 'import libcosimpy' 2> /dev/null; then
  "$folder/bin/pip" install --quiet --disable-pip-version-check --only-binary :all: libcosimpy > /dev/null 2>&1 || true
fi
program=${CARGO_TARGET_DIR:-$PWD/target}/release/gearbench
[ -x "$program" ] || cargo build --release --locked
"$folder/bin/python" benchmarks/scripts/fmpy_check.py "$program"

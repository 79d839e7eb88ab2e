#!/usr/bin/env bash
# Builds the wheel of the Python package and checks it in virtual environments of the checkout (target/tools/python), one
# for the oldest and one for the newest Python from 3.10 on that this machine has: tests against the command line, stubs,
# types, examples, doctests, size, metadata. A missing Python, or a missing network, is reported as "left out: " and fails
# nothing; a test that fails does.
set -euo pipefail
cd "$(dirname "$0")/.."

folder=$PWD/target/tools/python
mkdir -p "$folder"
log=$folder/install.log
: > "$log"

leave_out() { echo "left out: $*"; exit 0; }

# The version of an interpreter, if it runs and is new enough.
version_of() {
  "$1" -c 'import sys; assert sys.version_info >= (3, 10); print("%d.%02d" % sys.version_info[:2])' 2> /dev/null || true
}

# Interpreters on the path, those that pyenv has installed without a shim that is on, and those that PYTHONS names (paths
# separated by spaces).
pyenv=${PYENV_ROOT:-$(pyenv root 2> /dev/null || echo "$HOME/.pyenv")}
found=$(
  for python in python3.10 python3.11 python3.12 python3.13 python3.14 python3.15 python3 "$pyenv"/versions/*/bin/python3 \
    ${PYTHONS:-}; do
    command -v "$python" > /dev/null || continue
    version=$(version_of "$python")
    if [ -n "$version" ]; then echo "$version $python"; fi
  done | sort -u -k1,1
)
[ -n "$found" ] || leave_out "the Python package is not checked, no Python from 3.10 on was found"
pythons=$( (echo "$found" | head -n 1; echo "$found" | tail -n 1) | sort -u | cut -d ' ' -f 2)

# Maturin and its environment.
first=$(echo "$pythons" | head -n 1)
if [ ! -x "$folder/build/bin/ruff" ]; then
  "$first" -m venv --clear "$folder/build" >> "$log" 2>&1 || leave_out "the Python package is not checked, venv failed ($log)"
  "$folder/build/bin/pip" install --quiet --disable-pip-version-check 'maturin>=1.9,<2' twine ruff >> "$log" 2>&1 \
    || { rm -rf "$folder/build"; leave_out "the Python package is not checked, pip failed ($log)"; }
fi

"$folder/build/bin/ruff" format --check python
"$folder/build/bin/ruff" check python

echo "wheel"
rm -rf "$folder/wheels"
"$folder/build/bin/maturin" build --release --locked --manifest-path python/Cargo.toml --out "$folder/wheels"
wheel=$(ls "$folder"/wheels/gearbench-*.whl)
size=$(wc -c < "$wheel")
echo "$(basename "$wheel"): $size bytes"
[ "$size" -lt 15000000 ] || { echo "the wheel has $size bytes, more than 15 MB"; exit 1; }
case $wheel in *-cp310-abi3-*) ;; *) echo "the wheel is not one for all Pythons from 3.10 on"; exit 1 ;; esac
"$folder/build/bin/twine" check --strict "$wheel"

GEARBENCH_COMMAND=${CARGO_TARGET_DIR:-$PWD/target}/release/gearbench
export GEARBENCH_COMMAND
[ -x "$GEARBENCH_COMMAND" ] || cargo build --release --locked

for python in $pythons; do
  version=$(version_of "$python")
  echo "Python $version"
  own=$folder/$version
  # A clean environment with the wheel alone: it needs nothing but numpy.
  "$python" -m venv --clear "$own" >> "$log" 2>&1 || leave_out "Python $version: venv failed ($log)"
  "$own/bin/pip" install --quiet --disable-pip-version-check "$wheel" >> "$log" 2>&1 \
    || leave_out "Python $version: pip failed ($log)"
  (
    cd "$folder"
    "$own/bin/python" -c 'import gearbench'
    "$own/bin/python" - << 'END'
import subprocess, sys, time

def seconds():
    begin = time.perf_counter()
    subprocess.run([sys.executable, "-c", "import gearbench"], check=True)
    return time.perf_counter() - begin

least = min(seconds() for _ in range(7))
print(f"import, with the start of Python: {least:.3f} s")
END
  )
  "$own/bin/pip" install --quiet --disable-pip-version-check pytest mypy pandas xarray matplotlib distributed loky fmpy >> "$log" 2>&1 \
    || leave_out "Python $version: pip failed ($log)"
  (
    cd python/tests
    package=$("$own/bin/python" -c 'import gearbench, pathlib; print(pathlib.Path(gearbench.__file__).parent)')
    "$own/bin/python" -m gearbench._generate --check ../../docs/results.schema.json ../package/gearbench
    "$own/bin/python" -m pytest --quiet -p no:cacheprovider .
    "$own/bin/python" -m pytest --quiet -p no:cacheprovider --doctest-modules "$package" --ignore="$package/_generate.py"
  )
  # The examples as notebooks and as pages of the book.
  (root=$PWD; cd "$folder" && "$own/bin/python" "$root/python/notebooks.py" "$root/target/notebooks")
  (root=$PWD; cd "$folder" && "$own/bin/mypy" --strict --cache-dir "$folder/mypy" --ignore-missing-imports "$root"/python/examples/*.py "$root"/python/notebooks.py \
    "$root"/python/measure/throughput.py "$root"/python/measure/laws.py)
  (cd python/package && "$own/bin/mypy" --strict --cache-dir "$folder/mypy" --ignore-missing-imports gearbench)
done

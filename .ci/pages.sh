#!/usr/bin/env bash
# Makes small reports with the built program and opens them in a real browser (.ci/pages.mjs): comparisons of one scene, of
# two, and of a planetary set, a choice, errors against cost, a stability map, a sweep over speed, a run-up, a frequency
# response, and modes in a plane and in space. Further reports are arguments, NAME=FOLDER; only those are opened with ONLY=1.
# Node packages (puppeteer-core, axe-core) come from the npm registry into target/tools/browser; the browser is Debian's
# `chromium` or the one that BROWSER names. A missing browser, Node or network is reported as "left out: " and fails
# nothing; a check that fails does. Pictures and prints are in target/tools/browser/out.
set -euo pipefail
cd "$(dirname "$0")/.."

leave_out() { echo "left out: $*"; exit 0; }

browser=
for name in "${BROWSER:-}" chromium chromium-browser google-chrome; do
  if [ -n "$name" ] && command -v "$name" > /dev/null; then browser=$(command -v "$name"); break; fi
done
[ -n "$browser" ] || leave_out "pages are not opened, there is no chromium (apt-get install chromium, or BROWSER=PATH)"
command -v node > /dev/null && command -v npm > /dev/null || leave_out "pages are not opened, there is no Node with npm"
[ "$(node -p 'process.versions.node.split(".")[0] >= 18')" = true ] || leave_out "pages are not opened, Node is older than version 18"

tools=$PWD/target/tools/browser
out=$tools/out
mkdir -p "$out"
if [ ! -f "$tools/node_modules/axe-core/axe.min.js" ] || [ ! -d "$tools/node_modules/puppeteer-core" ]; then
  npm install --prefix "$tools" --no-audit --no-fund --silent puppeteer-core@24 axe-core@4 > "$tools/install.log" 2>&1 \
    || leave_out "pages are not opened, npm could not install puppeteer-core and axe-core ($tools/install.log)"
fi

program=${CARGO_TARGET_DIR:-$PWD/target}/release/gearbench
[ -x "$program" ] || cargo build --release --locked
results=$(mktemp -d)
trap 'rm -rf "$results"' EXIT
# A run beyond the tolerance of its scene (code 1) is a result.
make() { "$program" --quiet "$@" || [ $? -eq 1 ]; }
reports=()
if [ -z "${ONLY:-}" ]; then
  make compare spur_impact --models rigid,movable-teeth --integrators dopri5@1e-6,velocity-verlet@100ns,rk4@200ns --out "$results/compare"
  make compare examples/my_pair.toml --models rigid --out "$results/compare_pair"
  relieved=$results/my_pair_relieved.toml
  sed -e 's/^name = "my_pair"/name = "my_pair_relieved"/' \
    -e 's/^pinion = { teeth = 19, /&tip_relief = { amount_m = 1e-5, start_radius_m = 0.0305, shape = "linear" }, /' examples/my_pair.toml > "$relieved"
  make compare examples/my_pair.toml "$relieved" --models rigid --out "$results/compare_scenes"
  make choose examples/my_pair.toml --metric peak --tolerance 0.05 --out "$results/choose"
  make precision spur_impact --models rigid,movable-teeth --integrators dopri5,rk4 --out "$results/precision"
  make stability spur_impact --models rigid --integrators rk4,velocity-verlet --grid 12x6 --no-refine --out "$results/stability"
  make sweep loaded_mesh --models rigid --out "$results/sweep"
  make run-up run_up --models rigid --out "$results/run_up"
  make compare planetary --models rigid --integrators dopri5@1e-5 --out "$results/planetary"
  make response loaded_mesh --models rigid --out "$results/response"
  make modes loaded_mesh --models rigid,elastic --out "$results/modes"
  make modes driveline --models rigid --out "$results/modes_driveline"
  make view "$results" --print

  for name in compare compare_pair compare_scenes choose precision stability sweep run_up planetary response modes modes_driveline; do
    reports+=("$name=$results/$name")
  done
  reports+=("gallery=$results")
fi
node .ci/pages.mjs "$tools" "$browser" "$out" "${reports[@]}" "$@"

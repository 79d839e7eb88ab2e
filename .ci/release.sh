#!/usr/bin/env bash
# Builds what a release consists of, in target/releases:
#
#   gearbench-VERSION-x86_64-linux.tar.gz   a static program with the library of FMUs, manual pages, completions; its folders
#                                           are those of a prefix: tar -C /usr/local --strip-components=1 -xzf FILE
#   gearbench-VERSION-cp310-abi3-*.whl      the wheel, with the library of FMUs
#
# Options select parts: `.ci/release.sh program`, `.ci/release.sh wheel`; without one both are built. What cannot be built is
# reported as "left out: " and ends with exit code 1: a release has all its parts. `.ci/install.sh` installs them in a bare Debian.
set -euo pipefail
cd "$(dirname "$0")/.."

parts=${*:-program wheel}
out=$PWD/target/releases
built=${CARGO_TARGET_DIR:-target}/dist
version=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -n 1)
mkdir -p "$out"

leave_out() { echo "left out: $*"; exit 1; }

# A released program does not look for the checkout that it was compiled in. Equal sources give equal files: paths of this
# machine are left out of them.
export GEARBENCH_RELEASE=1
export CARGO_INCREMENTAL=0
export RUSTFLAGS="--remap-path-prefix=$PWD=/gearbench --remap-path-prefix=${CARGO_HOME:-$HOME/.cargo}=/cargo"

# Hosts of FMUs load the library with their own C library, so that it is linked dynamically.
echo "the library of FMUs"
cargo build --profile dist --locked -p gearbench-fmu --lib
library=$built/libgearbench_fmu.so
[ -f "$library" ] || leave_out "cargo made no $library"

case " $parts " in *" program "*)
  echo "the program"
  # The C library is linked statically, in the last step alone: all crates are those of the library of FMUs.
  cargo rustc --profile dist --locked -p gearbench-cli --bin gearbench -- -C target-feature=+crt-static
  if ldd "$built/gearbench" 2> /dev/null | grep -q '=>'; then leave_out "the program is not static"; fi
  name=gearbench-$version-$(uname -m)-linux
  share=$out/$name/share
  rm -rf "${out:?}/$name"
  mkdir -p "$out/$name/bin" "$out/$name/lib" "$share/gearbench/completions" "$share/doc/gearbench"
  cp "$built/gearbench" "$out/$name/bin/"
  cp "$library" "$out/$name/lib/"
  cp README.md CHANGELOG.md CITATION.cff SECURITY.md LICENSE-MIT LICENSE-APACHE "$share/doc/gearbench/"
  "$out/$name/bin/gearbench" man --out "$share/man/man1" --quiet
  for shell in bash elvish fish powershell zsh; do
    "$out/$name/bin/gearbench" completions "$shell" > "$share/gearbench/completions/gearbench.$shell"
  done
  # The archive has no times and owners of this machine.
  tar --sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner -C "$out" -cf - "$name" | gzip -n > "$out/$name.tar.gz"
  ls -l "$out/$name.tar.gz"
;; esac

case " $parts " in *" wheel "*)
  echo "the wheel"
  tools=$PWD/target/tools/python/build
  if [ ! -x "$tools/bin/maturin" ]; then
    (python3 -m venv "$tools" && "$tools/bin/pip" install --quiet 'maturin>=1.9,<2') || leave_out "maturin cannot be installed"
  fi
  # The package contains the library while the wheel is built.
  cp "$library" python/package/gearbench/
  trap 'rm -f python/package/gearbench/libgearbench_fmu.so' EXIT
  rm -f "$out"/gearbench-*.whl
  "$tools/bin/maturin" build --profile dist --locked --manifest-path python/Cargo.toml --out "$out"
  ls -l "$out"/*.whl
;; esac

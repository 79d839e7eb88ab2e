#!/usr/bin/env bash
# Builds what a release consists of, in target/releases:
#
#   gearbench-VERSION-x86_64-linux.tar.gz   a static program (musl) with the library of FMUs, manual pages, completions
#   gearbench-VERSION-cp310-abi3-*.whl      the wheel, with the library of FMUs
#
# Options select parts: `.ci/release.sh program`, `.ci/release.sh wheel`; without one both are built. A missing target or
# network is reported as "left out: " and ends with exit code 1: a release has all its parts.
set -euo pipefail
cd "$(dirname "$0")/.."

parts=${*:-program wheel}
target=x86_64-unknown-linux-musl
out=$PWD/target/releases
version=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -n 1)
mkdir -p "$out"

leave_out() { echo "left out: $*"; exit 1; }

# A released program does not look for the checkout that it was compiled in. Equal sources give equal files: paths of this
# machine are left out of them.
export GEARBENCH_RELEASE=1
export CARGO_INCREMENTAL=0
export RUSTFLAGS="--remap-path-prefix=$PWD=/gearbench --remap-path-prefix=${CARGO_HOME:-$HOME/.cargo}=/cargo"

# Hosts of FMUs load the library with their own C library, so that it is one of glibc.
echo "the library of FMUs"
cargo build --profile dist --locked --workspace --lib
library=$PWD/${CARGO_TARGET_DIR:-target}/dist/libgearbench_fmu.so
[ -f "$library" ] || leave_out "cargo made no $library"

case " $parts " in *" program "*)
  echo "the program"
  if command -v rustup > /dev/null && ! rustup target list --installed | grep -q "^$target$"; then
    rustup target add "$target" || leave_out "the target $target cannot be installed"
  fi
  cargo build --profile dist --locked --workspace --bin gearbench --target "$target"
  name=gearbench-$version-x86_64-linux
  rm -rf "${out:?}/$name"
  mkdir -p "$out/$name/bin" "$out/$name/lib" "$out/$name/share/completions"
  cp "${CARGO_TARGET_DIR:-target}/$target/dist/gearbench" "$out/$name/bin/"
  cp "$library" "$out/$name/lib/"
  cp README.md CHANGELOG.md CITATION.cff SECURITY.md LICENSE-MIT LICENSE-APACHE "$out/$name/"
  "$out/$name/bin/gearbench" man --out "$out/$name/share/man/man1" --quiet
  for shell in bash elvish fish powershell zsh; do
    "$out/$name/bin/gearbench" completions "$shell" > "$out/$name/share/completions/gearbench.$shell"
  done
  # The archive has no times and owners of this machine.
  tar --sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner -C "$out" -czf "$out/$name.tar.gz" "$name"
  if ldd "$out/$name/bin/gearbench" 2> /dev/null | grep -q '=>'; then leave_out "the program is not static"; fi
  ls -l "$out/$name.tar.gz"
;; esac

case " $parts " in *" wheel "*)
  echo "the wheel"
  tools=$PWD/target/tools/python/build
  if [ ! -x "$tools/bin/maturin" ]; then
    python3 -m venv "$tools" && "$tools/bin/pip" install --quiet 'maturin>=1.9,<2' || leave_out "maturin cannot be installed"
  fi
  # The package contains the library while the wheel is built.
  cp "$library" python/package/gearbench/
  trap 'rm -f python/package/gearbench/libgearbench_fmu.so' EXIT
  "$tools/bin/maturin" build --profile dist --locked --manifest-path python/Cargo.toml --out "$out"
  ls -l "$out"/*.whl
;; esac

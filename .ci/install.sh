#!/usr/bin/env bash
# Installs a release (target/releases) in bare Debians, which debootstrap makes in target/tools/debian:
#
#   build      builds the release as the Dockerfile does: a copy of the commit, gcc, libc6-dev and the Rust of this machine
#   program    the archive in a Debian without compiler and Python: the README's main job, an FMU, completions, a manual page
#   wheel      the wheel in a virtual environment of Debian's Python: a comparison, an FMU, REXS
#   docker     `docker build` and the main job in the image, where a Docker daemon runs
#
# Options select parts; without one those after `build` are run. It needs root and debootstrap; without them, or without a
# release, it reports "left out: " and fails nothing. Packages come from the sources of this machine.
set -euo pipefail
cd "$(dirname "$0")/.."

parts=${*:-program wheel docker}
folder=$PWD/target/tools/debian
releases=$PWD/target/releases
suite=bookworm

leave_out() { echo "left out: $*"; exit 0; }
[ "$(id -u)" = 0 ] || leave_out "a bare Debian needs root"
command -v debootstrap > /dev/null || leave_out "debootstrap is not installed (apt-get install debootstrap)"

# Runs a command in a Debian of this script, with no variable of this machine but those named before it.
inside() {
  local root=$1
  shift
  chroot "$root" /usr/bin/env -i HOME=/root PATH=/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin LC_ALL=C.UTF-8 "$@"
}

mounted=()
unmount() {
  local i
  for ((i = ${#mounted[@]} - 1; i >= 0; i--)); do umount "${mounted[i]}"; done
  mounted=()
}
trap unmount EXIT

# Mounts a folder of this machine in a Debian, where it cannot be changed or deleted.
share() {
  mkdir -p "$2"
  mount --bind "$1" "$2"
  mounted+=("$2")
  mount -o remount,ro,bind "$2"
}

# A fresh copy of the bare Debian, with name service and certificates of this machine.
debian() {
  if [ ! -f "$folder/base/etc/debian_version" ]; then
    rm -rf "$folder/base"
    mkdir -p "$folder"
    debootstrap --variant=minbase --include=ca-certificates "$suite" "$folder/base" > "$folder/debootstrap.log" \
      || { rm -rf "$folder/base"; leave_out "debootstrap failed ($folder/debootstrap.log)"; }
  fi
  # Deletion must not reach folders of this machine that a killed run left mounted.
  if grep -q " $folder/$1/" /proc/mounts; then
    echo "folders are still mounted in $folder/$1: umount them (grep $folder /proc/mounts)"
    exit 1
  fi
  rm -rf "${folder:?}/$1"
  cp -a "$folder/base" "$folder/$1"
  cp /etc/resolv.conf "$folder/$1/etc/"
  cp -L /etc/ssl/certs/ca-certificates.crt "$folder/$1/etc/ssl/certs/"
  share /proc "$folder/$1/proc"
}

for part in $parts; do
  echo "== $part"
  root=$folder/$part
  case $part in
  build)
    # A build that was interrupted goes on: what it compiled is kept.
    if [ -d "$root/gearbench/target" ]; then mv "$root/gearbench/target" "$folder/built"; fi
    debian build
    inside "$root" apt-get -qq update
    inside "$root" apt-get -qq install --no-install-recommends -y gcc libc6-dev > "$folder/apt.log" 2>&1
    mkdir -p "$root/gearbench"
    if [ -d "$folder/built" ]; then mv "$folder/built" "$root/gearbench/target"; fi
    git archive HEAD | tar -x -m -C "$root/gearbench"
    share "$(rustc --print sysroot)" "$root/usr/local/rust"
    mkdir -p "$root/root/.cargo"
    cp -a "${CARGO_HOME:-$HOME/.cargo}/registry" "$root/root/.cargo/"
    inside "$root" PATH=/usr/local/rust/bin:/usr/bin:/bin GEARBENCH_COMMIT="$(git rev-parse --short=12 HEAD)" \
      /gearbench/.ci/release.sh program
    # The tool that builds wheels is one of Python.
    inside "$root" apt-get -qq install --no-install-recommends -y python3-venv >> "$folder/apt.log" 2>&1
    inside "$root" PATH=/usr/local/rust/bin:/usr/bin:/bin GEARBENCH_COMMIT="$(git rev-parse --short=12 HEAD)" \
      /gearbench/.ci/release.sh wheel
    mkdir -p "$releases"
    cp "$root"/gearbench/target/releases/gearbench-*.{tar.gz,whl} "$releases/"
    ;;
  program)
    archive=$(ls "$releases"/gearbench-*-linux.tar.gz 2> /dev/null) || leave_out "no program in $releases (.ci/release.sh)"
    debian program
    for tool in cc gcc cargo python3; do
      if inside "$root" sh -c "command -v $tool"; then echo "the Debian is not bare: it has $tool"; exit 1; fi
    done
    tar -C "$root/usr/local" --strip-components=1 -xzf "$archive"
    inside "$root" gearbench --version
    inside "$root" sh -c 'mkdir -p /work && cd /work && gearbench compare spur_impact --out out' | tail -n 12
    inside "$root" sh -c 'cd /work && gearbench fmu hammer --model rigid --method rk4@2us --out hammer.fmu && gearbench fmu hammer --model rigid --fmi 2 --out hammer2.fmu'
    inside "$root" sh -c 'ls -l /work/*.fmu /usr/local/share/man/man1/gearbench-compare.1 /usr/local/share/gearbench/completions/gearbench.bash'
    if command -v python3 > /dev/null; then python3 .ci/check_record.py "$root/work/out/results.json"; fi
    ;;
  wheel)
    wheel=$(ls "$releases"/gearbench-*.whl 2> /dev/null) || leave_out "no wheel in $releases (.ci/release.sh)"
    debian wheel
    inside "$root" apt-get -qq update
    inside "$root" apt-get -qq install --no-install-recommends -y python3-venv > "$folder/apt.log" 2>&1
    cp "$wheel" "$root/root/"
    inside "$root" sh -c 'python3 -m venv /opt/gearbench && /opt/gearbench/bin/pip install --quiet --disable-pip-version-check --only-binary :all: /root/gearbench-*.whl'
    cat > "$root/root/job.py" <<'PYTHON'
import os
import gearbench as gb

os.chdir("/root")
result = gb.compare("loaded_mesh", out="out")
print(result)
gb.fmu("hammer", model="rigid", method="rk4@2us", out="hammer.fmu")
gb.export("loaded_mesh", rexs="loaded_mesh.rexs")
gb.import_("loaded_mesh.rexs", out="again.toml")
print(*(f"{name}: {os.path.getsize(name)} bytes" for name in ["hammer.fmu", "loaded_mesh.rexs", "again.toml"]), sep="\n")
PYTHON
    inside "$root" /opt/gearbench/bin/python /root/job.py
    ;;
  docker)
    docker info > /dev/null 2>&1 || leave_out "no Docker daemon runs"
    docker build -t gearbench --build-arg GEARBENCH_COMMIT="$(git rev-parse --short=12 HEAD)" .
    docker run --rm gearbench compare spur_impact --out out
    ;;
  *) echo "unknown part $part"; exit 2 ;;
  esac
  unmount
done

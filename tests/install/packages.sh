#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Usage: packages.sh BUILD_DIR
# Makes the Debian package and the wheel of a finished build and tries them where neither the source
# nor the build is to be seen: the package in a fresh Debian (debootstrap, with apt's own mirror), the
# wheel in virtual environments without and with NumPy. Without root, debootstrap or a mirror the
# package is unpacked instead and its dependencies are looked for here; the last line says so.
set -euo pipefail

build=$(realpath "$1")
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
source=$(realpath "$here/../..")
work=$(mktemp -d)
trap 'rm -rf --one-file-system "$work"' EXIT
root=$work/root
study=beam_identification
version=$(sed -n 's/^#define MT_VERSION_STRING "\(.*\)"$/\1/p' "$source/include/modetune/version.h")
inputs=("$source/tests/models/pendulum.json" "$here/pendulum_study.json")

fail() { echo "packages.sh: $*" >&2; exit 1; }
say() { printf '%4d s  %s\n' "$SECONDS" "$*"; }

# A command in the fresh Debian, which sees nothing of this environment.
inside() {
    env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C HOME=/root DEBIAN_FRONTEND=noninteractive \
        chroot "$root" "$@"
}

make_deb() {
    cpack -G DEB --config "$build/CPackConfig.cmake" -B "$work/deb" >"$work/cpack.log" 2>&1 ||
        { cat "$work/cpack.log" >&2; fail "cpack failed"; }
    deb=$(echo "$work"/deb/modetune_*.deb)
    local field
    for field in Package=modetune "Version=$version" Section=science \
        'Maintainer=modetune developers <modetune@example.org>'; do
        [ "$(dpkg-deb -f "$deb" "${field%%=*}")" = "${field#*=}" ] || fail "$deb: its ${field%%=*} is not ${field#*=}"
    done
    local depends
    depends=$(dpkg-deb -f "$deb" Depends)
    for field in libc6 libnlopt0 libgsl libopenblas0 libcholmod libcjson1; do
        [[ $depends == *"$field"* ]] || fail "$deb: does not depend on $field"
    done
    dpkg-deb -c "$deb" >"$work/contents"
    for field in bin/modetune lib/libmodetune.so lib/libmodetune.so.${version%%.*} lib/libmodetune.a include/modetune/study.h \
        lib/pkgconfig/modetune.pc lib/cmake/modetune/modetune-config.cmake share/man/man1/modetune.1.gz share/man/man1/modetune-run.1.gz \
        share/bash-completion/completions/modetune share/zsh/vendor-completions/_modetune share/doc/modetune/copyright \
        share/doc/modetune/README.md share/doc/modetune/schemas/README.md share/doc/modetune/src/cli/README.md; do
        grep -q " \./usr/$field\( -> .*\)\?\$" "$work/contents" || fail "$deb: has no /usr/$field"
    done
    ! grep -v " \./\(usr/.*\)\?\$" "$work/contents" | grep -v " -> " || fail "$deb: has files outside of /usr"
    say "$(basename "$deb"): $(stat -c %s "$deb") bytes"
}

# What breaks Debian's policy.
look_with_lintian() {
    command -v lintian >/dev/null || { say "without lintian"; return 0; }
    lintian --allow-root --fail-on error --tag-display-limit 0 "$deb" >"$work/lintian.log" 2>&1 ||
        { grep '^E:' "$work/lintian.log" >&2; fail "$(basename "$deb"): breaks Debian's policy"; }
    say "lintian: no error"
}

# The fresh Debian; 1: there is none, and $why says why.
make_root() {
    local place codename options
    why="debootstrap needs root"
    [ "$(id -u)" -eq 0 ] || return 1
    why="there is no debootstrap"
    command -v debootstrap >/dev/null || return 1
    why="apt has no mirror of Debian"
    codename=$(. /etc/os-release && echo "${VERSION_CODENAME:-}")
    place=$(apt-get indextargets --format '$(CODENAME) $(COMPONENT) $(REPO_URI)' 'Identifier: Packages' \
        'Origin: Debian' | awk -v c="$codename" '$1 == c && $2 == "main" { print $3; exit }')
    [ -n "$place" ] || return 1
    why="debootstrap of $codename failed"
    debootstrap --variant=minbase "$codename" "$root" "$place" >"$work/root.log" 2>&1 || { tail -n 5 "$work/root.log"; return 1; }
    cp /etc/resolv.conf "$root/etc/resolv.conf"
    options=$(apt-config dump | grep -i '^Acquire::[^ ]*proxy' || true)
    echo "$options" >"$root/etc/apt/apt.conf.d/99packages"
    say "a fresh Debian $codename"
}

# The public functions, from a program that is compiled against the package's files.
compile_consumer() { # root
    local flags
    read -ra flags <<<"$(PKG_CONFIG_PATH=$1/usr/lib/pkgconfig pkg-config --cflags --libs modetune)"
    [[ ${flags[0]} == "-I$1/usr/"* ]] || fail "modetune.pc leads to ${flags[0]}"
    gcc -std=c11 -Wall -Wextra -Wpedantic -Werror "$here/consumer.c" -o "$1/consumer" "${flags[@]}"
}

try_in_root() {
    cp "$deb" "$root/modetune.deb"
    inside apt-get update >"$work/apt.log" 2>&1 || { cat "$work/apt.log" >&2; fail "apt-get update failed in the fresh Debian"; }
    inside apt-get install -y --no-install-recommends /modetune.deb >>"$work/apt.log" 2>&1 ||
        { cat "$work/apt.log" >&2; fail "apt cannot install $deb"; }
    inside dpkg -V modetune || fail "files of the package differ from what was packed"
    [ "$(inside modetune --version | head -n 1)" = "$("$build/modetune" --version | head -n 1)" ] || fail "modetune --version differs"
    inside sh -ec "cd /root; modetune examples $study >/dev/null; modetune run --quiet --verify studies/$study.json >/dev/null"
    local model=problems/beam_lumped.json
    inside sh -ec "cd /root; modetune modes $model -c free_free --format json" >"$work/there.json"
    (cd "$source" && "$build/modetune" modes "$model" -c free_free --format json) >"$work/here.json"
    cmp "$work/here.json" "$work/there.json" || fail "the package's modes are others"
    compile_consumer "$root"
    mkdir "$root/tests" "$root/tests/models" "$root/tests/install"
    cp "${inputs[0]}" "$root/tests/models/"
    cp "${inputs[1]}" "$root/tests/install/"
    inside /consumer /tests/models/pendulum.json /tests/install/pendulum_study.json | grep -q "^$version 1 mode 0.610330 Hz solved L " ||
        fail "a program linked to the package's library says something else"
    inside apt-get purge -y modetune >>"$work/apt.log" 2>&1 || fail "apt cannot remove the package"
    [ -z "$(find "$root/usr" -name '*modetune*')" ] || fail "the package leaves files behind"
    tried="installed, run and removed by apt in a fresh Debian"
}

try_unpacked() {
    dpkg-deb -x "$deb" "$root"
    local wanted name relation number have
    while read -r wanted; do
        read -r name relation number <<<"$(tr -d '()' <<<"$wanted")"
        have=$(dpkg-query -W -f='${db:Status-Status} ${Version}\n' "$name" 2>/dev/null | sed -n 's/^installed //p' | head -n 1)
        [ -n "$have" ] || fail "$name, which the package depends on, is not installed here"
        [ -z "$number" ] || dpkg --compare-versions "$have" "$relation" "$number" || fail "$name is $have, not $relation $number"
    done < <(dpkg-deb -f "$deb" Depends | tr ',' '\n')
    "$root/usr/bin/modetune" run --quiet --verify -o "$work/results" "$source/studies/$study.json" >/dev/null
    compile_consumer "$root"
    LD_LIBRARY_PATH=$root/usr/lib "$root/consumer" "${inputs[@]}" | grep -q "^$version 1 mode 0.610330 Hz solved L " ||
        fail "a program linked to the package's library says something else"
    tried="ONLY UNPACKED, not installed: $why"
}

make_wheel() {
    cmake --install "$build" --strip --prefix "$work/prefix" >"$work/install.log"
    local made=("$work/wheel" "$work/again") to
    for to in "${made[@]}"; do
        /usr/bin/python3 -B "$source/src/library/python/make_wheel.py" --library "$work/prefix/lib/libmodetune.so" --out "$to" >"$work/wheel.log"
    done
    wheel=$(echo "$work"/wheel/*.whl)
    [ "$(basename "$wheel")" = "modetune-$version-py3-none-linux_$(uname -m).whl" ] || fail "the wheel is called $wheel"
    cmp "$wheel" "$work/again/$(basename "$wheel")" || fail "two wheels of the same files differ"
    say "$(basename "$wheel"): $(stat -c %s "$wheel") bytes"
}

# The tests of the Python package, where pip has put it.
try_wheel() { # environment, does it have NumPy
    local python=$1/bin/python numpy=no
    "$python" -c 'import numpy' 2>/dev/null && numpy=yes
    [ "$numpy" = "$2" ] || fail "$1: NumPy is there: $numpy"
    (
        cd "$work"
        unset PYTHONPATH MODETUNE_LIBRARY OPENBLAS_NUM_THREADS
        [[ $("$python" -c 'import modetune; print(modetune.__file__)') == "$1"/* ]] || fail "modetune is not that of $1"
        MODETUNE_INSTALLED=1 SOURCE_DIR=$source MODETUNE=$build/modetune "$python" -B "$source/tests/library/test_python.py" >"$work/wheel.log" 2>&1
    ) || { cat "$work/wheel.log" >&2; fail "the wheel's tests failed in $1"; }
    say "$(tail -n 1 "$work/wheel.log"): $(grep '^Ran' "$work/wheel.log"), NumPy: $2"
}

make_deb
look_with_lintian
why=
tried=
if make_root; then try_in_root; else try_unpacked; fi
say "the package: $tried"
make_wheel
/usr/bin/python3 -m venv "$work/plain"
/usr/bin/python3 -m venv --without-pip --system-site-packages "$work/numeric"
pip() { "$work/plain/bin/python" -m pip --disable-pip-version-check --no-input --quiet "$@"; }
for environment in plain numeric; do
    pip --python "$work/$environment/bin/python" install --no-index "$wheel"
done
try_wheel "$work/plain" no
try_wheel "$work/numeric" yes
pip --python "$work/plain/bin/python" check
pip --python "$work/plain/bin/python" uninstall --yes modetune
[ -z "$(find "$work/plain" -name '*modetune*')" ] || fail "the wheel leaves files behind"
echo "modetune $version: the package $tried; the wheel in two environments"

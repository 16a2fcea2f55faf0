#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Usage: consume.sh BUILD_DIR
# Installs a finished build into a temporary prefix and uses it from outside the source tree,
# through pkg-config and through find_package, shared and static. A version that does not exist
# yet must be refused by both.
set -euo pipefail

build=$(realpath "$1")
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
prefix=$work/prefix

fail() { echo "consume.sh: $*" >&2; exit 1; }

cmake --install "$build" --prefix "$prefix" >"$work/install.log" || fail "install failed"
cp "$here/consumer.c" "$work/"
inputs=("$here/../models/pendulum.json" "$here/pendulum_study.json")
cd "$work"

pc=$(find "$prefix" -name modetune.pc)
[ -n "$pc" ] || fail "no modetune.pc was installed"
libdir=$(dirname "$(dirname "$pc")")
export PKG_CONFIG_PATH=$libdir/pkgconfig
version=$(pkg-config --modversion modetune)
# what the consumer must say: the pendulum at 0.6103298209 Hz, and the length for 0.7 Hz, the larger root of omega^2 (L^2/3 + w^2/12) = g L/2
length=$(awk 'BEGIN { o = (2*3.14159265358979323846*0.7)^2; a = o/3; b = 9.81/2; c = o*0.05^2/12; printf "%.6f", (b + sqrt(b*b - 4*a*c))/(2*a) }')
said="$version 1 mode 0.610330 Hz solved L $length"
major=${version%%.*}
newer=$((major + 1)).0.0
minor_newer=$major.999.0

[ -f "$prefix/include/modetune/version.h" ] || fail "no header was installed"
[ -f "$libdir/libmodetune.a" ] || fail "no static library was installed"
leaked=$(nm -D --defined-only "$libdir/libmodetune.so" | awk '$3 !~ /^mt_/ && $2 ~ /[TDBR]/ { print $3 }')
[ -z "$leaked" ] || fail "the shared library shows foreign names: $leaked"
for lib in "$libdir"/libmodetune.so "$libdir"/libmodetune.a; do
    wants=$(nm -u "$lib" | awk '{ sub(/@.*/, "", $2); print $2 }' | grep -xE 'exit|abort|_exit|printf|puts|putchar|stdout|stderr' || true)
    [ -z "$wants" ] || fail "$lib can print or exit: $wants"
done
if [ -e "$prefix/bin/modetune" ]; then
    [[ $("$prefix/bin/modetune" --version) == *"$version"* ]] || fail "modetune --version does not say $version"
fi

read -ra flags <<<"$(pkg-config --cflags --libs modetune)"
gcc -std=c11 -Wall -Wextra -Wpedantic -Werror consumer.c -o by_pkg_config "${flags[@]}"
[ "$(LD_LIBRARY_PATH=$libdir ./by_pkg_config "${inputs[@]}")" = "$said" ] || fail "pkg-config: shared consumer failed"

read -ra flags <<<"$(pkg-config --static --cflags --libs modetune | sed "s|-lmodetune|$libdir/libmodetune.a|")"
gcc -std=c11 consumer.c -o by_pkg_config_static "${flags[@]}"
[ "$(./by_pkg_config_static "${inputs[@]}")" = "$said" ] || fail "pkg-config: static consumer failed"

for wanted in "$newer" "$minor_newer"; do
    ! pkg-config --exists "modetune >= $wanted" || fail "pkg-config accepted version $wanted"
done

cat >CMakeLists.txt <<'EOF'
cmake_minimum_required(VERSION 3.16)
project(consumer C)
find_package(modetune ${WANTED} REQUIRED COMPONENTS static)
add_executable(shared consumer.c)
target_link_libraries(shared PRIVATE modetune::modetune)
add_executable(static consumer.c)
target_link_libraries(static PRIVATE modetune::modetune_static)
EOF
consume() { # version wanted
    rm -rf out
    cmake -S . -B out -DCMAKE_PREFIX_PATH="$prefix" -DWANTED="$1" >cmake.log 2>&1
}
consume "$version" || { cat cmake.log >&2; fail "find_package refused version $version"; }
cmake --build out >cmake.log 2>&1 || { cat cmake.log >&2; fail "find_package: build failed"; }
for program in shared static; do
    [ "$(./out/$program "${inputs[@]}")" = "$said" ] || fail "find_package: $program consumer failed"
done
for wanted in "$newer" "$minor_newer"; do
    ! consume "$wanted" || fail "find_package accepted version $wanted"
    grep -q "not compatible\|compatible with requested version" cmake.log || fail "find_package failed for another reason"
done
echo "installed $version, consumed by pkg-config and find_package; $newer and $minor_newer refused"

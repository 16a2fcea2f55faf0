#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The beam beside the paper's way in GNU Octave, where that is installed; nothing else needs it.
set -euo pipefail
here=$(dirname "$(realpath "${BASH_SOURCE[0]}")")
if ! command -v octave >/dev/null; then
    echo "no GNU Octave here: for the comparison with the paper's way,"
    echo "    sudo apt-get install --no-install-recommends octave"
    exit 0
fi
numbers=$(mktemp)
trap 'rm -f "$numbers"' EXIT
# Octave's own exit may complain, and says nothing about the numbers: bench_beam checks those
octave --no-gui --norc --quiet "$here/bench_beam.m" >"$numbers" 2>/dev/null || true
echo
"$BUILD_DIR/tests/bench/bench_beam" "$numbers"
echo "(Octave $(octave --no-gui --version 2>/dev/null | sed -n '1s/.*version //p'): Eq. 1 with pinv, Jacobian by central differences, eig, fsolve)"

#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Data races: every shipped study with four workers, and the tests that have some, in the build of the thread sanitizer.
#   tests/races/run.sh [BUILD]     BUILD: build/tsan, made by "cmake --workflow --preset tsan"
# No suppressions: the numeric libraries, which are not instrumented, share nothing between workers, and BLAS has one thread.
set -euo pipefail

cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/../.."
build=${1:-build/tsan}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
export OPENBLAS_NUM_THREADS=1 LC_ALL=C TSAN_OPTIONS=exitcode=66:halt_on_error=0 scratch build

# A race that is planted is found, or the rest says nothing.
cat >"$scratch/race.c" <<'END'
#include <pthread.h>
static int shared;
static void *add(void *unused) { for (int i = 0; i < 100000; i++) { shared++; } return unused; }
int main(void)
{
    pthread_t other;
    if (pthread_create(&other, NULL, add, NULL) != 0) { return 1; }
    add(NULL);
    return pthread_join(other, NULL);
}
END
"${CC:-clang}" -g -O1 -fsanitize=thread "$scratch/race.c" -o "$scratch/race" -pthread
code=0
"$scratch/race" >/dev/null 2>&1 || code=$?
[ $code -eq 66 ] || { echo "a planted race is not found (exit $code)"; exit 1; }

one() { # study
    local name code=0
    name=$(basename "$1" .json)
    "$build/modetune" run "$1" --threads 4 --quiet -o "$scratch/$name" >/dev/null 2>"$scratch/$name.log" || code=$?
    if [ $code -gt 1 ] || grep -q 'WARNING: ThreadSanitizer' "$scratch/$name.log"; then
        echo "$build/modetune run $1 --threads 4: exit $code"
        head -n 60 "$scratch/$name.log"
        return 1
    fi
}
export -f one
# the longest first, so that no processor waits for it at the end
studies=(studies/truss_72bar.json studies/inceptor_identification.json studies/inceptor_rotor.json)
for study in studies/*.json tests/models/pendulum_tolerance.json; do
    [[ " ${studies[*]} " == *" $study "* ]] || studies+=("$study")
done
printf '%s\0' "${studies[@]}" | xargs -0 -n 1 -P "$(nproc)" bash -c 'one "$1"' _
for test in base/test_workers nlp/test_nlp_coverage answer/test_study_run answer/test_trade_warm; do
    "$build/tests/$test" >"$scratch/test.log" 2>&1 || { cat "$scratch/test.log"; echo "$build/tests/$test failed"; exit 1; }
done
echo "${#studies[@]} studies with four workers: no race"

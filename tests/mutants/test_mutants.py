# SPDX-License-Identifier: GPL-3.0-or-later
"""The mutants in the suite: saved cases, faults that must be found, and some of a fixed seed (MT_EVERY=1: six times as many, and
saved cases with three draws of commands)."""
import os
import random
import signal
import tempfile
import unittest
from pathlib import Path

import run
from campaign import hold, hold_saved
from commands import Answer, Program
from corpus import Corpus
from suite import FEW, INSTRUMENTED, LAUNCHED, PROGRAM

SEED = "5"
COUNT = 6 if INSTRUMENTED or LAUNCHED else len(run.ROUND)
CASES = Path(__file__).resolve().parent / "cases"

# Programs that are wrong in one way: a shell script around the sound one, "$@" what it was asked.
FAULTS = {
    "crash": 'kill -SEGV $$',
    "crash of a sanitizer": '"$SOUND" "$@"; code=$?; echo "SUMMARY: AddressSanitizer: heap-buffer-overflow" >&2; exit $code',
    "stuck": 'while :; do :; done',
    "silent": '"$SOUND" "$@" >/dev/null 2>&1; exit 2',
    "internal": 'echo "modetune: error: internal error, please report" >&2; exit 3',
    "words": '"$SOUND" "$@"; code=$?; echo "is missed by nan %" >&2; exit $code',
    "words of a file": '"$SOUND" "$@"; code=$?; [ "$1" != run ] || echo "1,-inf" >>out/changed/recommendations.csv; exit $code',
    "form": '"$SOUND" "$@" | head -c 20; exit 0',
    "place": 'echo "modetune: error: something is wrong" >&2; exit 2',
    "place outside": 'echo "$2:99999:1: error: /name: something is wrong" >&2; exit 2',
    "place of nothing": 'echo "$2:1:1: error: /nothing/here: something is wrong" >&2; exit 2',
    "left": '"$SOUND" "$@"; code=$?; [ "$1" = run ] || touch .temporary; exit $code',
    "left out": '"$SOUND" "$@"; code=$?; [ "$1" != run ] || rm -f out/changed/report.html; exit $code',
    "system": 'echo "modetune: error: Too many open files" >&2; exit 4',
    "back": 'case "$*" in *out/changed/result.json*) echo "modetune: error: x.json: \\"x\\"" >&2; exit 2; esac; exec "$SOUND" "$@"',
    "agree": 'case "$1" in check) echo "$2:1:1: error: no" >&2; exit 2; esac; exec "$SOUND" "$@"',
    "harmless": '"$SOUND" "$@"; code=$?; ! grep -q zq_ studies/changed.json || sed -i s/7/8/ out/changed/result.json; exit $code',
}


class Cases(unittest.TestCase):
    """What was once found. A case is one file {"holds": why it is here, "kind": ..., "files": {place: text}}, of which one is the kind's."""

    def test_cases(self):
        hold_saved(self, run.Mutants(Program(PROGRAM)), CASES, draws=1 if FEW else 3)


class Faults(unittest.TestCase):
    def test_faults_are_found(self):
        corpus = Corpus(PROGRAM)
        for fault, script in FAULTS.items():
            with self.subTest(fault=fault), tempfile.TemporaryDirectory() as folder:
                self.assertIn(fault.split(" ")[0], self._found(Path(folder), corpus, fault, script))

    def _found(self, folder, corpus, fault, script):
        path = folder / "modetune"
        path.write_text(f"#!/bin/bash\nSOUND={os.path.abspath(PROGRAM)}\n{script}\n", encoding="utf-8")
        path.chmod(0o755)
        program = Program(path, patience=(0.2, 0.2) if fault == "stuck" else None)
        if fault == "harmless":
            study = corpus.study("studies/inceptor_tuning_1.json")
            return {check for check, _ in run.harmless.compare(program, random.Random(1), study, "rename", folder, {"commands": 0})}
        case = corpus.study("studies/inceptor_tuning_1.json")
        if fault in ("silent", "place", "place outside", "place of nothing"):
            case.files[case.target] = case.files[case.target].replace('"goals"', '"gaols"')
        (folder / "case").mkdir()
        case.write(folder / "case")
        found = (check for draw in range(4) for check, _ in Answer(program, folder / "case", case, {"commands": 0}).findings(random.Random(draw)))
        return {next((check for check in found if check == fault.split(" ")[0]), None)}


class Interrupts(unittest.TestCase):
    def test_the_interrupt_arrives_where_it_is_ignored(self):
        """As in a hunt that a shell has put in the background; bash, too, leaves what was ignored ignored."""
        before = signal.signal(signal.SIGINT, signal.SIG_IGN)
        self.addCleanup(signal.signal, signal.SIGINT, before)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "modetune"
            path.write_text("#!/bin/bash\ntrap 'exit 130' INT\nwhile :; do :; done\n", encoding="utf-8")
            path.chmod(0o755)
            done = Program(path, patience=(0.2, 5)).run(Path(folder), ["run"])
            self.assertEqual((done.code, done.slow), (130, "interrupted"))


class Mutants(unittest.TestCase):
    def test_random_mutants(self):
        mutants = run.Mutants(Program(PROGRAM))
        tally = hold(self, mutants, SEED, [(kind, index) for kind, index in mutants.todo(mutants.kinds, COUNT) if not FEW or index % 6 == 0])
        self.assertGreater(tally["good"], tally["mutants"] // 8)  # not all are refused at the door


if __name__ == "__main__":
    unittest.main()

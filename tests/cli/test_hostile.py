# SPDX-License-Identifier: GPL-3.0-or-later
"""
No file keeps the program for long, takes the machine's memory or fills the terminal, whatever it holds: files of every hostile kind (common_hostile.py), the tree's own files grown at random places, and
extreme numbers in them, end by themselves within processor seconds and memory that files of their size never need (a search over all names for each of them does), with an exit status of the program's own.
MT_EVERY=1: files of twice the size, and twenty grown files and twenty with extreme numbers, else six.
    tests/cli/test_hostile.py --size N --count N --seed S     larger files of each kind, more grown ones
"""
import argparse
import json
import random
import resource
import subprocess
import sys
import unittest
from concurrent.futures import ThreadPoolExecutor

import common_hostile as hostile
from common_cli import PROGRAM, SOURCE, CliTest
from suite import EVERY, INSTRUMENTED, LAUNCHED

SLOW = INSTRUMENTED or LAUNCHED
BASE = 5000  # size that the seconds are for
SECONDS = 60 if SLOW else 3  # of the processor; no file of that size takes one
MEMORY = "1G"
TALK = 400_000  # bytes of messages: at most 200 lines
STATES = {0, 1, 2, 3, 4}
FILES = ["tests/schema/plane.json", "tests/schema/space.json", "tests/documents/good/study_full.json", "tests/documents/good/study_bands.json",
         "tests/documents/good/aircraft.json", "tests/documents/good/profile.json", "problems/inceptor.json", "studies/engine_orders.json", "studies/inceptor_trade.json",
         "studies/six_masses_bands.json", "tests/models/space_couplings.json"]
COMMANDS = {"model": [("modes",), ("info",), ("sensitivity", "--count", "2")], "study": [("run", "-o", "out", "--quiet")]}
knobs = argparse.Namespace(size=500 if SLOW else 2000 if EVERY else 1000, count=20 if EVERY else 6, seed=4)


def seconds():
    """In proportion to the size."""
    return -(-SECONDS * max(knobs.size, BASE) // BASE)


# A search may take long where bounds are 1e308; only that it ends is asked of it.
SEARCH_SECONDS = 300


def limit(most):
    resource.setrlimit(resource.RLIMIT_CPU, (most, most))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


class Hostile(CliTest):
    def ends(self, what, folder, *words):
        """Problems with how a command ended: a list of texts."""
        most = SEARCH_SECONDS if words[0] == "run" else seconds()
        try:
            done = subprocess.run([PROGRAM, *words, "--max-memory", MEMORY], cwd=folder, preexec_fn=lambda: limit(most),
                                  capture_output=True, timeout=20 * most)
        except subprocess.TimeoutExpired:
            return [f"{what}: {words[0]} still waits"]
        found = []
        if done.returncode not in STATES:
            found.append(f"{what}: {words[0]} ended with {done.returncode}: {done.stderr[-300:]!r}")
        if len(done.stderr) > TALK:
            found.append(f"{what}: {words[0]} said {len(done.stderr)} bytes")
        if done.returncode > 1 and b"error: " not in done.stderr:
            found.append(f"{what}: {words[0]} ended with {done.returncode} without a reason")
        return found

    def all_end(self, cases):
        """cases: functions that return problems. Two at a time."""
        with ThreadPoolExecutor(2) as pool:
            found = [problem for problems in pool.map(lambda case: case(), cases) for problem in problems]
        self.assertEqual(found, [], f"--seed {knobs.seed} --size {knobs.size} --count {knobs.count}")

    def test_files_of_every_kind(self):
        def case(number, kind, make, is_study):
            folder = self.folder / f"kind{number}"
            folder.mkdir()
            if is_study:
                (folder / "model.json").write_text(hostile.study_model(knobs.size), encoding="utf-8")
            (folder / "x.json").write_text(make(knobs.size), encoding="utf-8")
            return self.ends(kind, folder, "check", "x.json")
        self.all_end([lambda n=n, k=k, m=m, s=s: case(n, k, m, s) for n, (k, m, s) in enumerate(
            [(k, m, False) for k, m in hostile.MODELS.items()] + [(k, m, True) for k, m in hostile.STUDIES.items()])])

    def place(self, number, path, text):
        """The text where the file stood, its neighbours beside it."""
        root = self.folder / f"grown{number}"
        for folder in ("problems", "tests"):
            if not (root / folder).exists():
                (root / folder).mkdir(parents=True)
        for other in ("problems/inceptor.json", "problems/engine_accessory.json", "problems/aircraft.json",
                      "problems/six_masses.json", "tests/documents/wrong/parts/model.json", "tests/models/six_masses.json",
                      "tests/documents/good/aircraft.json"):
            if (SOURCE / other).exists():
                (root / other).parent.mkdir(parents=True, exist_ok=True)
                (root / other).write_bytes((SOURCE / other).read_bytes())
        (root / path).parent.mkdir(parents=True, exist_ok=True)
        (root / path).write_text(text, encoding="utf-8")
        return root

    def test_own_files_grown(self):
        def case(i):
            rng = random.Random(knobs.seed * 100003 + i)
            path = rng.choice(FILES)
            what, text = hostile.grown(rng, json.loads((SOURCE / path).read_text(encoding="utf-8")), 25 * knobs.size)
            return self.ends(f"{i}: {path} {what}", self.place(i, path, text), "check", path, "--root", ".")
        self.all_end([lambda i=i: case(i) for i in range(knobs.count)])

    def test_extreme_numbers(self):
        def case(i):
            rng = random.Random(knobs.seed * 100019 + i)
            path = rng.choice([p for p in FILES if "aircraft" not in p])
            document = json.loads((SOURCE / path).read_text(encoding="utf-8"))
            what, text = hostile.extreme(rng, document, rng.choice([1, 1, 2, 4]))
            command = rng.choice(COMMANDS["study" if "study" in document["format"] else "model"])
            folder = self.place(f"n{i}", path, text)
            return self.ends(f"{i}: {path} {what}", folder, command[0], path, *command[1:], "--root", ".")
        self.all_end([lambda i=i: case(i) for i in range(knobs.count)])


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    for knob in ("size", "count", "seed"):
        parser.add_argument(f"--{knob}", type=int, default=getattr(knobs, knob))
    knobs, rest = parser.parse_known_args(namespace=knobs)
    unittest.main(argv=[sys.argv[0], *rest], verbosity=1)

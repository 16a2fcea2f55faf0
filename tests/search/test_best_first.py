#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Mode placements best first, against the search of all of them from all starts.

Random rows of masses with springs and masses as variables, weights, linear measures, bands and limits, for the least change. A study with "max_evaluations" has
all placements searched, from all starts: its designs are no better than those of the study without it, and those that are not listed change no less than what
is said of the placements left out. The suite has a few; MT_EVERY=1: sixty; MT_COUNT=N: so many; MT_SEED=S.
"""
import json
import math
import random
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from suite import PROGRAM, SEED, count  # noqa: E402

import numpy as np

COUNT = count(10, every=60, instrumented=5)
ALL = 10**8  # evaluations: no search uses them up
SAME = 1e-6  # of the changes of two searches that end at the same design


def row(stiffness, mass):
    n = len(stiffness)
    return {
        "format": "modetune-model/1", "dimension": 2,
        "parameters": {**{f"k{i}": k for i, k in enumerate(stiffness)}, **{f"m{i}": m for i, m in enumerate(mass)}},
        "bodies": [{"name": f"b{i}", "mass_kg": f"m{i}", "inertia_kg_m2": 1, "centre": [i + 1, 0]} for i in range(n)],
        "joints": [{"name": f"j{i}", "type": "prismatic", "bodies": ["ground", f"b{i}"], "at": [i + 1, 0], "axis": [1, 0]} for i in range(n)],
        "springs": [{"name": f"s{i}", "type": "axial", "bodies": ["ground" if i == 0 else f"b{i - 1}", f"b{i}"],
                     **({"at": [[0, 0], [1, 0]]} if i == 0 else {}), "stiffness_n_per_m": f"k{i}"} for i in range(n)],
    }


def frequencies(stiffness, mass):
    n = len(stiffness)
    k = np.zeros((n, n))
    for i, s in enumerate(stiffness):
        k[i, i] += s
        if i > 0:
            k[i - 1, i - 1] += s
            k[i - 1, i] = k[i, i - 1] = -s
    root = 1 / np.sqrt(mass)
    return np.sqrt(np.linalg.eigvalsh(root[:, None] * k * root)) / (2 * math.pi)


def study(rng):
    """A model and a question; the bands are about modes of the original, and apart."""
    while True:
        n = rng.randint(3, 6) if rng.random() < 0.4 else rng.randint(5, 6)
        k, m = [round(10 ** rng.uniform(3, 4.3), 1) for _ in range(n)], [round(rng.uniform(0.5, 3), 3) for _ in range(n)]
        hz, wide = frequencies(k, np.array(m)), rng.choice([0.02, 0.04, 0.08])
        middles = sorted(rng.sample(list(hz), rng.randint(1, min(4, n))))
        bands = [[middle * (1 - wide), middle * (1 + wide)] for middle in middles]
        if all(low[1] < high[0] for low, high in zip(bands, bands[1:])):
            break
    masses = rng.random() < 0.4
    variables = []
    for i in range(n):
        variables.append({"parameter": f"k{i}", "lower": k[i] / rng.uniform(1.3, 3), "upper": k[i] * rng.uniform(1.3, 3)})
        if rng.random() < 0.4:
            variables[-1]["weight"] = round(10 ** rng.uniform(-1, 1), 3)
        if rng.random() < 0.2:
            variables[-1]["scale"] = k[i] * rng.uniform(0.3, 2)
        if masses and rng.random() < 0.5:
            variables.append({"parameter": f"m{i}", "lower": m[i] / 1.5, "upper": m[i] * 1.5})
    goals = [{"type": "avoid", "bands_hz": bands}]
    if rng.random() < 0.2:
        goals.append({"type": "frequency", "mode": 1, "at_least_hz": float(hz[0] * rng.uniform(0.9, 1.1))})
    return row(k, m), {"format": "modetune-study/1", "model": "m.json", "variables": variables, "goals": goals,
                       "objective": {"minimise": "change"}, "recommendations": rng.choice([1, 1, 2, 3, 5])}


class BestFirst(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory()
        self.addCleanup(self.place.cleanup)
        self.folder = Path(self.place.name)

    def answer(self, question, *args):
        (self.folder / "s.json").write_text(json.dumps(question), encoding="utf-8")
        done = subprocess.run([PROGRAM, "run", "s.json", "--quiet", "--report", "none", "-o", "out", *args], cwd=self.folder, capture_output=True, text=True)
        self.assertIn(done.returncode, (0, 1), done.stderr)
        return (self.folder / "out/s/result.json").read_text(encoding="utf-8")

    @staticmethod
    def changes(result):
        return [r["change"] for r in result["recommendations"] if r["feasible"]]

    def test_the_list_is_that_of_the_whole_search(self):
        rng, left_out, fewer = random.Random(SEED), 0, 0
        for case in range(COUNT):
            model, question = study(rng)
            (self.folder / "m.json").write_text(json.dumps(model), encoding="utf-8")
            text = self.answer(question, "--threads", "1")
            best = json.loads(text)
            whole = json.loads(self.answer({**question, "recommendations": 1000, "search": {"max_evaluations": ALL, "starts": 24 + len(question["variables"])}}))
            with self.subTest(case):
                got, all_of = self.changes(best), self.changes(whole)
                listed = all_of[:question["recommendations"]]
                self.assertGreaterEqual(len(got), len(listed))
                for a, b in zip(got, listed):
                    self.assertLessEqual(a, b * (1 + SAME) + SAME)
                self.assertEqual(best["status"], whole["status"])
                fewer += best["run"]["evaluations"] < whole["run"]["evaluations"]
                for told in (c["text"] for c in best["certificates"] if c["kind"] == "least_change"):
                    found = re.match(r"(\d+) of (\d+) mode placements were searched,.* by ([\d.e+-]+) or more", told)
                    left_out += 1
                    self.assertLess(int(found[1]), int(found[2]))
                    self.assertLessEqual(sum(c < float(found[3]) for c in all_of), int(found[1]))
                    self.assertGreaterEqual(float(found[3]) * (1 + 1e-3), got[-1])
                if case < 4:
                    self.assertEqual(self.answer(question, "--threads", "3"), text)
        self.assertGreater(left_out, 0)
        self.assertGreater(fewer, COUNT // 2)


if __name__ == "__main__":
    unittest.main()

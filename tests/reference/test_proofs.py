# SPDX-License-Identifier: GPL-3.0-or-later
"""Proofs over a full matrix of 28 freedoms (every mass tied to others farther off), against eigenvalues of samples by
numpy; and, with MT_EVERY=1, that a proof ends where no reasonable one decides: a target and a band that miss each other by 4e-5."""
import json
import math
import random
import re
import sys
import unittest
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "cli"))
from common_cli import CliTest  # noqa: E402
from suite import EVERY  # noqa: E402

N = 28
NOMINAL = {"k_a": 4e4, "k_b": 2e4, "k_c": 1e4}
WITHIN = 2.0
SAMPLES = 200
TARGET_HZ = 3.6


def springs():
    """(one end, the other, stiffness parameter, share of it); mass 0 is the ground."""
    r = random.Random(3)
    out = []
    for i in range(N):
        for reach, name, low, high in ((1, "k_a", 0.7, 1.3), (5, "k_b", 0.1, 0.3), (11, "k_c", 0.1, 0.3)):
            if i + reach <= N:
                out.append((i, i + reach, name, round(r.uniform(low, high), 6)))
    return out


SPRINGS = springs()


def model():
    def body(i):
        return f"b{i}" if i > 0 else "ground"

    masses = range(1, N + 1)
    return {
        "format": "modetune-model/1", "dimension": 2, "parameters": NOMINAL,
        "points": {f"p{i}": [0.1 * i, 0] for i in range(N + 1)},
        "bodies": [{"name": f"b{i}", "mass_kg": 1, "centre": f"p{i}"} for i in masses],
        "joints": [{"name": f"g{i}", "type": "pin-in-slot", "bodies": ["ground", f"b{i}"], "at": f"p{i}", "axis": [1, 0]} for i in masses],
        "springs": [{"name": f"s{i}_{j}", "type": "axial", "bodies": [body(i), body(j)], "at": [f"p{i}", f"p{j}"],
                     "stiffness_n_per_m": f"{share}*{name}"} for i, j, name, share in SPRINGS],
    }


def unit(name):
    """The stiffness of the springs of one parameter at 1 N/m."""
    k = numpy.zeros((N + 1, N + 1))
    for i, j, of, share in SPRINGS:
        if of == name:
            k[numpy.ix_([i, j], [i, j])] += share * numpy.array([[1, -1], [-1, 1]])
    return k[1:, 1:]


UNITS = {name: unit(name) for name in NOMINAL}


def frequencies(x):
    return numpy.sqrt(numpy.linalg.eigvalsh(sum(x[name] * k for name, k in UNITS.items()))) / (2 * math.pi)


def on_target(r):
    """A design at random of which mode 1 has its target (all stiffnesses times s: all frequencies times sqrt(s)); None
    where that is out of the bounds."""
    x = {name: value * WITHIN ** r.uniform(-1, 1) for name, value in NOMINAL.items()}
    s = (TARGET_HZ / frequencies(x)[0]) ** 2
    x = {name: s * value for name, value in x.items()}
    return x if all(1 / WITHIN <= x[name] / NOMINAL[name] <= WITHIN for name in x) else None


class Dense(CliTest):
    def answer(self, band, status=0, loaded=False, **search):
        self.write("model.json", json.dumps(model() | ({"gravity_m_per_s2": [0, -9.81]} if loaded else {})))
        path = self.write("study.json", json.dumps({
            "format": "modetune-study/1", "model": "model.json",
            "variables": [{"parameter": name, "lower": value / WITHIN, "upper": value * WITHIN} for name, value in NOMINAL.items()],
            "goals": [{"type": "frequency", "mode": 1, "target_hz": TARGET_HZ}, {"type": "avoid", "bands_hz": [band]}],
            "objective": {"minimise": "change"}, "search": {"starts": 4} | search}))
        self.said = self.expect(status, "run", path, "-o", "out").stderr
        return json.loads(Path(self.folder, "out/study/result.json").read_text())

    def below(self, band):
        """Numbers of modes below the band of sampled designs on the target that keep it; how many samples there were."""
        r = random.Random(1)
        kinds = set()
        tried = 0
        for _ in range(SAMPLES):
            x = on_target(r)
            if x is not None:
                tried += 1
                hz = frequencies(x)
                if not any(band[0] < f < band[1] for f in hz):
                    kinds.add(sum(f <= band[0] for f in hz))
        return kinds, tried

    def test_kinds_are_those_of_samples_and_no_other(self):
        for band, expected in (([11.5, 12.0], {1, 2}), ([10.5, 12.9], {1}), ([10.2, 16], set())):
            result = self.answer(band, 0 if expected else 1)
            kinds, tried = self.below(band)
            self.assertGreater(tried, SAMPLES // 4)
            self.assertTrue(result["certificates"][0]["proven"], band)
            self.assertLessEqual(kinds, expected)
            found = set()
            for each in result["recommendations"]:
                hz = frequencies({p["name"]: p["recommended"] for p in each["parameters"]})
                if each["feasible"]:
                    self.assertAlmostEqual(hz[0] / TARGET_HZ, 1, delta=2e-6)
                    self.assertFalse(any(band[0] * (1 + 2e-6) < f < band[1] * (1 - 2e-6) for f in hz), hz)
                    found.add(sum(f < (band[0] + band[1]) / 2 for f in hz))
            self.assertEqual(found, expected, band)

    def test_samples_are_within_the_budget(self):
        """A model under gravity has no proof; 1024 designs would be sampled."""
        result = self.answer([11.5, 12.0], loaded=True, max_evaluations=200)
        self.assertIn("no proof: gravity", result["certificates"][0]["text"].replace('configuration "default": ', ""))
        self.assertLess(int(re.search(r"(\d+) evaluations", self.said).group(1)), 300)

    @unittest.skipUnless(EVERY, "the whole budget of a proof, four seconds")
    def test_a_proof_ends(self):
        result = self.answer([11.034765625, 15.0], 1)
        first = result["certificates"][0]
        self.assertEqual((first["kind"], first["proven"]), ("gap_assignments", False))
        said = re.search(r"the budget of the proof ended after \d+ boxes, with (\S+) % of the designs .* undecided", first["text"])
        self.assertTrue(0 < float(said.group(1)) < 50, first["text"])  # targets and bands rule out most designs at once
        self.assertFalse(any(each["feasible"] for each in result["recommendations"]))
        self.assertEqual(self.below([11.034765625, 15.0])[0], set())


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""
A MAC over sensors of displacements and rotations. A bar on two unequal springs bounces and pitches: in (y, theta) its modes are those of
K = [[k1 + k2, b k2 - a k1], [., a^2 k1 + b^2 k2]], M = diag(m, J), solved here. An angle counts as its arc at "length_m" of the goal, or at
the model's length, which is told; the same bar in millimetres then has the same MACs. Sensors of one kind are compared as they are.
"""
import json
import math
import os
import random
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

PROGRAM = os.environ["MODETUNE"]
CASES = 100 if "MT_EVERY" in os.environ else 10


def modes(m, j, a, b, k1, k2):
    """Shapes (y, theta), lowest first."""
    k = ((k1 + k2, b * k2 - a * k1), (b * k2 - a * k1, a * a * k1 + b * b * k2))
    p, q = k[0][0] / m + k[1][1] / j, (k[0][0] * k[1][1] - k[0][1] ** 2) / (m * j)
    root = math.sqrt(p * p - 4 * q)
    return [(-k[0][1], k[0][0] - lam * m) for lam in ((p - root) / 2, (p + root) / 2)]


def mac(u, v, scale):
    u, v = [(s[0], s[1] * scale) for s in (u, v)]
    return (u[0] * v[0] + u[1] * v[1]) ** 2 / ((u[0] ** 2 + u[1] ** 2) * (v[0] ** 2 + v[1] ** 2))


def model(m, j, a, b, k1, k2, sensors, unit=1.0):
    """unit: of lengths in metres; then mass stays, forces are kg unit / s^2: every number of N/m stays, of N m/rad is over unit^2."""
    return {
        "format": "modetune-model/1", "dimension": 2, "parameters": {"k1": {"value": k1}},
        "bodies": [{"name": "bar", "mass_kg": m, "inertia_kg_m2": j / unit**2, "centre": [0, 0]}],
        "joints": [{"name": "guide", "type": "pin-in-slot", "bodies": ["ground", "bar"], "at": [0, 0], "axis": [0, 1]}],
        "springs": [{"name": f"s{i}", "type": "axial", "bodies": ["ground", "bar"], "at": [[x / unit, -1 / unit], [x / unit, 0]],
                     "stiffness_n_per_m": k} for i, (x, k) in enumerate(((-a, "k1"), (b, k2)))],
        "sensors": [{"name": "cg", "on": "bar", "at": [0, 0], "directions": sensors}],
    }


class Mixed(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def run_one(self, data, shape, length=None):
        goal = {"type": "mac", "mode": 1, "reference": "pure", "at_least": 0.001}
        if length is not None:
            goal["length_m"] = length
        study = {"format": "modetune-study/1", "model": "m.json", "variables": [{"parameter": "k1", "lower": 10, "upper": 1e6}],
                 "references": {"pure": {"modes": [{"shape": shape}]}}, "goals": [goal], "objective": {"minimise": "change"}, "search": {"starts": 1}}
        (self.folder / "m.json").write_text(json.dumps(data), encoding="utf-8")
        (self.folder / "s.json").write_text(json.dumps(study), encoding="utf-8")
        done = subprocess.run([PROGRAM, "run", self.folder / "s.json", "--quiet", "-o", self.folder], capture_output=True, text=True, timeout=60)
        self.assertIn(done.returncode, (0, 1), done.stderr)
        result = json.loads((self.folder / "s/result.json").read_text(encoding="utf-8"))
        told = [float(m[1]) for m in (re.search(r"rotation counts as its arc at ([\d.e+-]+) m, the model's length", w) for w in result["warnings"]) if m]
        return result["baseline"]["goals"][0]["value"], told

    def test_an_angle_is_an_arc(self):
        rng = random.Random(14)
        for _ in range(CASES):
            m, j, a, b = rng.uniform(1, 10), rng.uniform(0.01, 1), rng.uniform(0.1, 1), rng.uniform(0.1, 1)
            k1, k2 = 10 ** rng.uniform(2, 5), 10 ** rng.uniform(2, 5)
            u = modes(m, j, a, b, k1, k2)[0]
            shape = {"cg.y": rng.uniform(-1, 1), "cg.r": rng.uniform(-1, 1)}
            pure = (shape["cg.y"], shape["cg.r"])
            length = 10 ** rng.uniform(-1, 1)
            data = model(m, j, a, b, k1, k2, ["y", "r"])
            value, told = self.run_one(data, shape, length)
            self.assertTrue(abs(value - mac(u, pure, length)) < 1e-9, (value, mac(u, pure, length)))
            self.assertEqual(told, [])
            value, told = self.run_one(data, shape)
            self.assertEqual(len(told), 1)
            self.assertTrue(abs(value - mac(u, pure, told[0])) < 2e-3, (value, told))  # told in four digits
            small = self.run_one(model(m, j, a, b, k1, k2, ["y", "r"], 1e-3), {"cg.y": 1e3 * pure[0], "cg.r": pure[1]})
            self.assertTrue(abs(small[0] - value) < 1e-9, (small, value))
            self.assertTrue(abs(small[1][0] / told[0] / 1e3 - 1) < 1e-3, (small, told))

    def test_one_kind_is_as_it_is(self):
        for sensors, shape in ((["y"], {"cg.y": 2.0}), (["r"], {"cg.r": 0.1})):
            value, told = self.run_one(model(2, 0.1, 0.3, 0.5, 1e3, 2e3, sensors), shape)
            self.assertTrue(abs(value - 1) < 1e-12, value)
            self.assertEqual(told, [])

    def test_mac_of_two_models_says_the_length(self):
        for sensors, said in ((["y", "r"], True), (["y"], False)):
            for name, k in (("a", 1e3), ("b", 9e3)):
                (self.folder / f"{name}.json").write_text(json.dumps(model(2, 0.1, 0.3, 0.5, k, 2e3, sensors)), encoding="utf-8")
            done = subprocess.run([PROGRAM, "mac", "a.json", "b.json", "--format", "json"], cwd=self.folder, capture_output=True, text=True, timeout=60)
            got = json.loads(done.stdout)
            told = [float(m[1]) for m in (re.search(r"arc at ([\d.e+-]+) m", n) for n in got["notes"]) if m]
            self.assertEqual(len(told), 1 if said else 0, got["notes"])
            if said:
                one, two = (modes(2, 0.1, 0.3, 0.5, k, 2e3) for k in (1e3, 9e3))
                for i in range(2):
                    for j in range(2):
                        self.assertTrue(abs(got["matrix"][i][j] - mac(one[i], two[j], told[0])) < 2e-3, got["matrix"])


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""
Named modes asked to cross. Masses on guides of their own, each with a spring of its own, do not know of each other: the named mode of each
depends on its own spring alone, also where frequencies are asked to be equal, or nearly so. Then k_i = m_i (2 pi f_i)^2, the redesign is the
root of the sum of ln(k_i / k_i0)^2, asking for 1 % less of f_i saves 0.02 ln(k_i / k_i0) / redesign, and nothing is a double solution.
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
CASES = 300 if "MT_EVERY" in os.environ else 30
PRICE = re.compile(r"A target ([\d.e-]+) % (lower|higher) in goal /goals/(\d+) .* would reduce the total change by ([\d.e-]+) %")


def model(masses, springs, axes):
    n = range(len(masses))
    return {
        "format": "modetune-model/1", "dimension": 2, "parameters": {f"k{i}": {"value": springs[i], "unit": "N/m"} for i in n},
        "bodies": [{"name": f"b{i}", "mass_kg": masses[i], "inertia_kg_m2": 0.1, "centre": [i, 0]} for i in n],
        "joints": [{"name": f"j{i}", "type": "prismatic", "bodies": ["ground", f"b{i}"], "at": [i, 0], "axis": axes[i]} for i in n],
        "springs": [{"name": f"s{i}", "type": "axial", "bodies": ["ground", f"b{i}"], "at": [[i - axes[i][0], -axes[i][1]], [i, 0]],
                     "stiffness_n_per_m": f"k{i}"} for i in n],
    }


class Crossings(unittest.TestCase):
    def check(self, masses, springs, axes, targets):
        n = range(len(masses))
        order = sorted(n, key=lambda i: springs[i] / masses[i])
        data = model(masses, springs, axes)
        data["modes"] = {f"m{i}": {"configuration": "default", "index": 1 + order.index(i)} for i in n}
        study = {"format": "modetune-study/1", "model": "m.json", "variables": [{"parameter": f"k{i}", "lower": springs[i] / 20, "upper": springs[i] * 20} for i in n],
                 "goals": [{"type": "frequency", "mode": f"m{i}", "target_hz": targets[i]} for i in n], "objective": {"minimise": "change"}}
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            (folder / "m.json").write_text(json.dumps(data), encoding="utf-8")
            (folder / "s.json").write_text(json.dumps(study), encoding="utf-8")
            done = subprocess.run([PROGRAM, "run", folder / "s.json", "--quiet", "--starts", "4", "-o", folder], capture_output=True, text=True, timeout=60)
            self.assertEqual(done.returncode, 0, done.stderr + done.stdout)
            best = json.loads((folder / "s/result.json").read_text(encoding="utf-8"))["recommendations"][0]
        told = f"masses {masses}, springs {springs}, targets {targets}: {best['reasons']}"
        step = [math.log(masses[i] * (2 * math.pi * targets[i]) ** 2 / springs[i]) for i in n]
        change = math.hypot(*step)
        self.assertTrue(abs(best["change"] / change - 1) < 3e-6, told)
        for i in n:
            self.assertTrue(abs(best["parameters"][i]["recommended"] / (springs[i] * math.exp(step[i])) - 1) < 3e-6, told)
        self.assertFalse(best["singular"], told)
        self.assertTrue(best["kkt_residual"] is None or best["kkt_residual"] < 1e-4, told)
        prices = {int(m[3]): m for m in (PRICE.search(r["text"]) for r in best["reasons"]) if m}
        for i in n:
            if abs(step[i]) * 0.02 < 0.2 * change**2 and abs(step[i]) > 1e-3:
                m = prices[i]
                self.assertEqual(m[2], "lower" if step[i] > 0 else "higher", told)
                self.assertTrue(abs(0.01 * float(m[4]) * change / (2 * abs(step[i]) * 0.01 * float(m[1]) / change) - 1) < 0.01, told)

    def test_two_modes_are_asked_to_the_same_frequency(self):
        self.check([1, 1], [4000, 9000], [[0, 1], [0, 1]], [12, 12])
        self.check([1, 2], [9000, 5000], [[0, 1], [1, 0]], [7, 7])

    def test_random_crossings_exact_and_near(self):
        rng = random.Random(11)
        for _ in range(CASES):
            n = rng.choice((2, 2, 3, 4))
            masses = [round(10 ** rng.uniform(-1, 1), 4) for _ in range(n)]
            base = 10 ** rng.uniform(0.5, 2)
            near = rng.choice((0.0, 10 ** rng.uniform(-13, -2)))
            targets = [base * (1 + near * rng.uniform(-1, 1)) for _ in range(n)]
            starts = [base * math.exp(0.5 * (rng.choice((-1, 1)) * rng.uniform(0.2, 1.5))) for _ in range(n)]
            springs = [m * (2 * math.pi * f) ** 2 for m, f in zip(masses, starts)]
            angles = [rng.uniform(0, math.pi) for _ in range(n)]
            if min(abs(math.log(a / b)) for i, a in enumerate(starts) for b in starts[:i]) > 0.01:
                self.check(masses, springs, [[math.cos(a), math.sin(a)] for a in angles], targets)


if __name__ == "__main__":
    unittest.main()

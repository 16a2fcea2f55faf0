# SPDX-License-Identifier: GPL-3.0-or-later
"""
What prices say, against closed forms. One mass on a spring of stiffness K + k, of which k is the variable: ln f depends on ln k by
s = k / (2 (K + k)), which K sets from 1/2 to almost 0, and the target is as far from the original as the case says. The least redesign
is c = |ln(k/k0)|; giving way by a part p of the target saves p / s of it. That a goal hardly depends on the variables may be said only
where s is below a hundredth, and must be, since the one variable is all there is.
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
CASES = 400 if "MT_EVERY" in os.environ else 40
NUMBER = r"([-+\d.e]+)"
PRICE = re.compile(rf"A target {NUMBER} % (lower|higher) in goal .* would reduce the total change by {NUMBER} %")
HARDLY = re.compile(rf"hardly depends on the variables here: moving it by 1 % takes a total change of {NUMBER} or more")


def run(folder, beside, shift):
    """The reasons of the recommendation, the redesign and the slope s there."""
    k0 = 1000.0
    hz = math.sqrt((beside + k0 * math.exp(shift)) / 2.0) / (2.0 * math.pi)
    model = {"format": "modetune-model/1", "name": "m", "dimension": 2, "parameters": {"k": {"value": k0, "unit": "N/m"}},
             "bodies": [{"name": "b", "mass_kg": 2, "inertia_kg_m2": 0.1, "centre": [0, 0]}],
             "joints": [{"name": "j", "type": "prismatic", "bodies": ["ground", "b"], "at": [0, 0], "axis": [1, 0]}],
             "springs": [{"name": "s", "type": "axial", "bodies": ["ground", "b"], "at": [[-1, 0], [0, 0]], "stiffness_n_per_m": f"{beside!r} + k"}]}
    study = {"format": "modetune-study/1", "name": "s", "model": "m.json",
             "variables": [{"parameter": "k", "lower": k0 / 10.0, "upper": 10.0 * k0}],
             "goals": [{"type": "frequency", "configuration": "default", "mode": 1, "target_hz": hz}], "objective": {"minimise": "change"}}
    (folder / "m.json").write_text(json.dumps(model), encoding="utf-8")
    (folder / "s.json").write_text(json.dumps(study), encoding="utf-8")
    done = subprocess.run([PROGRAM, "run", folder / "s.json", "--quiet", "--starts", "3", "-o", folder], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    best = json.loads((folder / "s/result.json").read_text(encoding="utf-8"))["recommendations"]
    assert done.returncode == 0 and best, done.stderr
    k = best[0]["parameters"][0]["recommended"]
    return [r["text"] for r in best[0]["reasons"]], best[0]["change"], k / (2.0 * (beside + k))


class Prices(unittest.TestCase):
    def check(self, beside, shift):
        with tempfile.TemporaryDirectory() as folder:
            reasons, change, slope = run(Path(folder), beside, shift)
        prices = [m for m in map(PRICE.search, reasons) if m]
        hardly = [m for m in map(HARDLY.search, reasons) if m]
        told = f"beside {beside}, shift {shift}: slope {slope}, {reasons}"
        self.assertTrue(abs(change / abs(shift) - 1.0) < 1e-6 + 2e-12 / (slope * abs(shift)), told)
        self.assertEqual(len(hardly), 1 if slope < 0.01 else 0, told)
        for m in hardly:
            self.assertTrue(abs(float(m[1]) / (0.01 / slope) - 1.0) < 0.06, told)  # two digits
        # a price is told unless it takes less than 1e-5 of the target to save a quarter of the redesign
        if slope * abs(shift) > 4e-5:
            self.assertEqual(len(prices), 1, told)
        for m in prices:
            part = 0.01 * float(m[1])
            self.assertEqual(m[2], "lower" if shift > 0.0 else "higher", told)
            worth = 0.01 * float(m[3]) * change
            self.assertTrue(abs(worth / (part / slope) - 1.0) < 0.006 + 2e-12 / (slope * abs(shift)), told)
            self.assertLessEqual(worth, 0.26 * change, told)  # as far as a slope tells

    def test_a_small_redesign_is_not_one_that_hardly_moves_the_goal(self):
        for shift in (1e-5, -1e-4, 1e-3, -0.0125, 0.02, 0.1, -1.0, 2.0):
            self.check(0.0, shift)

    def test_random_slopes_and_shifts(self):
        rng = random.Random(28)
        for _ in range(CASES):
            slope = 0.5 * 10.0 ** rng.uniform(-3.5, 0.0)
            shift = rng.choice((-1, 1)) * 10.0 ** rng.uniform(-3.0, 0.3)
            beside = 1000.0 * math.exp(shift) * (0.5 / slope - 1.0)
            if abs(slope / 0.01 - 1.0) > 1e-3:
                self.check(beside, shift)


if __name__ == "__main__":
    unittest.main()

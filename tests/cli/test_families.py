#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""
Two families of positions in one study, of masses and ranges that differ, goals in both orders: what lies between the positions of each is its
own. The arm of test_motion: f(theta) = sqrt((k1 + k2 cos(theta)^2) / m) / (2 pi), greatest at 0, least at a right angle.
"""
import json
import math
import tempfile
import unittest
from pathlib import Path

from common_cli import main
from test_motion import K2, TWO_PI, arm, avoid, drive, run, study

K1 = 3000.0
MASS = {"c": 2.0, "d": 3.0}
POSITIONS = {"c": [-0.5, 0.3, 0.7], "d": [0.2, 1.0, 2.0]}  # 0 lies within the first, a right angle within the second
NAMES = {family: [f"{family}{i}" for i in range(3)] for family in "cd"}
GOALS = [{"type": "frequency", "configurations": NAMES["c"], "mode": 1, "at_most_hz": 9.9}, {"type": "frequency", "configurations": NAMES["d"], "mode": 1, "at_least_hz": 5.2}]
BANDS = [avoid(NAMES["c"], [[10.2, 11]], margin_percent=2), avoid(NAMES["d"], [[4, 4.9]], margin_percent=3)]


def hz(family, theta, k1=K1):
    return math.sqrt((k1 + K2 * math.cos(theta) ** 2) / MASS[family]) / TWO_PI


def apart(inner, outer):
    """A clearance: the greater over the smaller less 1, in percent; negative where they stand the other way round."""
    return 100 * (outer / inner - 1) if inner <= outer else -100 * (inner / outer - 1)


class Families(unittest.TestCase):
    def answer(self, goals):
        more = {name: {"drive": drive(theta), "parameters": {"m": MASS["d"]}} for name, theta in zip(NAMES["d"], POSITIONS["d"])}
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "model.json").write_text(json.dumps(arm(dict(zip(NAMES["c"], POSITIONS["c"])), K1, more)))
            (Path(folder) / "study.json").write_text(json.dumps(study(goals, [{"parameter": "k1", "catalogue": [K1, 2 * K1]}])))
            done = run("run", "study.json", "-o", "out", "--quiet", cwd=folder)
            self.assertIn(done.returncode, (0, 1), done.stderr)
            return json.loads((Path(folder) / "out/study/result.json").read_text())

    def check_range(self, row, family):
        self.assertEqual([row["drive"], row["from"], row["to"]], ["pivot", POSITIONS[family][0], POSITIONS[family][-1]])

    def test_limits_of_two_families(self):
        extreme = {"c": 0.0, "d": math.pi / 2}
        for turned in (False, True):
            result = self.answer(GOALS[::-1] if turned else GOALS)
            for design in [result["baseline"], *result["recommendations"]]:
                k1 = design["parameters"][0]["recommended"]
                rows = {row["goal"]: row for row in design["responses_between"]}
                self.assertEqual(sorted(rows), ["/goals/0", "/goals/1"])
                for i, family in enumerate("dc" if turned else "cd"):
                    row, limit, true = rows[f"/goals/{i}"], 9.9 if family == "c" else 5.2, hz(family, extreme[family], k1)
                    off = max(0.0, true / limit - 1 if family == "c" else 1 - true / limit)
                    self.check_range(row, family)
                    self.assertAlmostEqual(row["value"] / true, 1, delta=1e-4)
                    self.assertAlmostEqual(row["at"], extreme[family], delta=0.02)
                    self.assertEqual(row["holds"], off == 0)
                    self.assertAlmostEqual(row["violation_percent"], 100 * off, delta=0.02)
                    named = [hz(family, theta, k1) for theta in POSITIONS[family]]
                    value = max(named) if family == "c" else min(named)
                    goals = [g for g in design["goals"] if g["pointer"] == f"/goals/{i}"]
                    self.assertAlmostEqual((max if family == "c" else min)(g["value"] for g in goals) / value, 1, delta=1e-9)

    def test_bands_of_two_families(self):
        followed = {"c": 0, "d": 0}
        for turned in (False, True):
            result = self.answer(BANDS[::-1] if turned else BANDS)
            for design in [result["baseline"], *result["recommendations"]]:
                k1 = design["parameters"][0]["recommended"]
                rows = {row["goal"]: row for row in design["motion"]}
                for i, family in enumerate("dc" if turned else "cd"):
                    row, goal = rows[f"/goals/{i}"], BANDS["cd".index(family)]
                    (low, high), margin = goal["bands_hz"][0], goal["margin_percent"]
                    nearest = lambda thetas: min((max(apart(f, low), apart(high, f)), t) for t in thetas for f in [hz(family, t, k1)])
                    if row["grade"] == "not followed":
                        self.assertLess(nearest(POSITIONS[family])[0], margin)
                        continue
                    followed[family] += 1
                    thetas = [POSITIONS[family][0] + (POSITIONS[family][-1] - POSITIONS[family][0]) * n / 20000 for n in range(20001)]
                    percent, _ = nearest(thetas)
                    self.check_range(row, family)
                    self.assertAlmostEqual(row["least_clearance_percent"], percent, delta=0.01 + 0.002 * abs(percent))
                    below = 100 * (1 / (1 - margin / 100) - 1)  # the margin of the lower edge, as a clearance
                    self.assertLess(min(abs(row["margin_percent"] - margin), abs(row["margin_percent"] - below)), 1e-9)
                    self.assertEqual(row["crosses"], percent < row["margin_percent"])
                    self.assertAlmostEqual(row["hz"] / hz(family, row["at"], k1), 1, delta=1e-6)
        self.assertTrue(all(followed.values()), followed)


if __name__ == "__main__":
    main()

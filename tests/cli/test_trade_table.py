#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a trade study shows: both objectives of its front as numbers, in the units of the study.

Of a mass m on a spring k with a damper c, shaken by a force at one frequency, |H| = 1 / |k - m w^2 + i w c|.
"""
import csv
import json
import math
import tempfile
import unittest
from pathlib import Path

from common_cli import main
from test_motion import TWO_PI, run

M, K, C, HZ, LIMIT = 2.0, 8000.0, 10.0, 9.0, 5e-4


def response(k, c=C):
    w = TWO_PI * HZ
    return 1 / abs(k - M * w * w + 1j * w * c)


MODEL = {
    "format": "modetune-model/1", "dimension": 2, "units": {"length": "mm"},
    "parameters": {"k": {"value": K, "unit": "N/m"}, "c": C, "L": {"value": 50, "unit": "mm"}},
    "bodies": [{"name": "b", "mass_kg": M, "inertia_kg_m2": 1, "centre": ["L", 0]}],
    "joints": [{"name": "j", "type": "prismatic", "bodies": ["ground", "b"], "at": ["L", 0], "axis": [1, 0]}],
    "springs": [{"name": "s", "type": "axial", "joint": "j", "stiffness_n_per_m": "k"}],
    "dampers": [{"name": "d", "type": "axial", "joint": "j", "damping_n_s_per_m": "c"}], "sensors": [{"name": "o", "on": "b"}]}
GOAL = {"type": "response", "input": "o.x", "output": "o.x", "at_hz": HZ, "at_most": LIMIT}
VARIABLES = [{"parameter": "k", "lower": 2000, "upper": 40000}]
STUDY = {"format": "modetune-study/1", "model": "model.json", "variables": VARIABLES, "goals": [GOAL], "objective": {"minimise": "change"}}


class TradeTable(unittest.TestCase):
    def answer(self, study):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "model.json").write_text(json.dumps(MODEL))
            (Path(folder) / "study.json").write_text(json.dumps(study))
            done = run("run", "study.json", "-o", "out", "--quiet", cwd=folder)
            self.assertIn(done.returncode, (0, 1), done.stderr)
            self.text = done.stdout
            out = Path(folder) / "out/study"
            with open(out / "trade.csv", encoding="utf-8", newline="") as lines:
                self.rows = list(csv.DictReader(lines))
            return json.loads((out / "result.json").read_text())

    def test_an_objective_of_the_front_alone_is_shown(self):
        limits = [6e-4, 3e-4, 1e-4, 0.5e-4]
        vary = {"goal": 0, "member": "at_most", "values": limits}
        result = self.answer(STUDY | {"trade": {"vary": [vary], "objectives": ["change", "vibration"]}})
        self.assertIn("vibration [%]", self.text)
        for point, row, limit in zip(result["trade"]["points"], self.rows, limits):
            best = point["best"]
            k = best["parameters"][0]["recommended"]
            told = {o["text"]: o for o in best["objectives"]}
            with self.subTest(limit=limit):
                self.assertEqual(list(told), ["change", "vibration"])
                self.assertAlmostEqual(told["vibration"]["recommended"] / (100 * response(k) / LIMIT), 1, delta=1e-9)
                self.assertAlmostEqual(told["vibration"]["original"] / (100 * response(K) / LIMIT), 1, delta=1e-9)
                self.assertEqual(told["vibration"]["unit"], "%")
                self.assertEqual(float(row["objective vibration [%]"]), told["vibration"]["recommended"])
                self.assertEqual(float(row["k [N/m]"]), k)
                self.assertEqual(float(row["at_most of /goals/0 [m per N]"]), limit)
                self.assertAlmostEqual(told["change"]["recommended"], abs(math.log(k / K)), delta=1e-9)

    def test_no_design_of_a_grid_beats_a_front(self):
        """Two variables, all designs of a grid of each over its bounds: none has less change and less vibration than a point."""
        limits = [3e-4, 2e-4, 1.5e-4, 1e-4, 0.7e-4]
        both = VARIABLES + [{"parameter": "c", "lower": 2, "upper": 200}]
        trade = {"vary": [{"goal": 0, "member": "at_most", "values": limits}], "objectives": ["change", "vibration"]}
        points = self.answer(STUDY | {"variables": both, "trade": trade})["trade"]["points"]
        grid = [(math.hypot(math.log(k / K), math.log(c / C)), response(k, c)) for k in (2000 * 20 ** (i / 400) for i in range(401))
                for c in (2 * 100 ** (i / 400) for i in range(401))]
        for point, limit in zip(points, limits):
            own = {p["name"]: p["recommended"] for p in point["best"]["parameters"]}
            change, value = math.hypot(math.log(own["k"] / K), math.log(own["c"] / C)), response(own["k"], own["c"])
            with self.subTest(limit=limit):
                self.assertTrue(point["pareto"])
                self.assertAlmostEqual(value / limit, 1, delta=2e-6)
                self.assertFalse([g for g in grid if g[0] < change * (1 - 1e-6) and g[1] < value * (1 + 1e-6)])
                self.assertLess(min(g[0] for g in grid if g[1] < limit), change + 0.02)

    def test_lengths_are_in_the_unit_of_the_study(self):
        """A bound of 60 mm is 60 under "[mm]", and so is the length beside it; in the result both are in metres."""
        study = STUDY | {"variables": VARIABLES + [{"parameter": "L", "lower": 10, "upper": 90}], "units": {"length": "mm"},
                         "trade": {"vary": [{"variable": "L", "bound": "upper", "values": [60, 75.5]}]}}
        result = self.answer(study)
        self.assertEqual([float(r["upper bound of L [mm]"]) for r in self.rows], [60, 75.5])
        for point, row in zip(result["trade"]["points"], self.rows):
            length = next(p["recommended"] for p in point["best"]["parameters"] if p["name"] == "L")
            self.assertAlmostEqual(length, 0.05, delta=1e-12)
            self.assertAlmostEqual(float(row["L [mm]"]), 50, delta=1e-9)
        self.assertAlmostEqual(result["trade"]["points"][1]["values"][0], 0.0755, delta=1e-15)

    def test_points_that_tie_are_both_on_the_front(self):
        """Limits above what the original has change nothing, and all of these points are one design."""
        vary = {"goal": 0, "member": "at_most", "values": [10 * response(K), 5 * response(K), 2 * response(K), response(K) * (1 + 1e-12), 1e-4]}
        points = self.answer(STUDY | {"trade": {"vary": [vary], "objectives": ["change", "vibration"]}})["trade"]["points"]
        self.assertEqual([p["pareto"] for p in points], [True] * 5)

    def test_limits_that_only_scale_are_no_goals(self):
        """Beside the resonance on either side there is a least vibration: one keeps the limit, the other does not."""
        study = STUDY | {"objective": {"minimise": "vibration"}, "variables": [{"parameter": "k", "lower": 5500, "upper": 9000}],
                         "trade": {"vary": [{"goal": 0, "member": "at_most", "values": [LIMIT]}]}}
        result = self.answer(study)
        parts = [100 * response(p["parameters"][0]["recommended"]) / LIMIT for p in result["recommendations"]]
        kept = [i + 1 for i, part in enumerate(parts) if part <= 100]
        self.assertEqual(len(parts), 2)
        self.assertEqual(kept, [1], parts)
        self.assertEqual(result["status_text"], "Solved: 2 distinct designs; all limits of vibration are kept by recommendation 1 alone.")
        self.assertRegex(self.text, r"at most 0\.0005 m per N +\S+ m per N +\S+ m per N +\S+ % +kept")
        study["goals"] = [GOAL | {"at_most": LIMIT / 100}, {"type": "frequency", "mode": 1, "at_least_hz": 5}]
        self.assertIn("designs meet all goals; no recommendation keeps all limits of vibration.", self.answer(study)["status_text"])
        self.assertRegex(self.text, r"m per N +\S+ m per N +\S+ m per N +-\S+ % +exceeded")


if __name__ == "__main__":
    main()

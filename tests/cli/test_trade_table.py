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
from common_pack import data
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
            self.page = (out / "report.html").read_text(encoding="utf-8")
            done = run("report", "out/study/result.json", "-o", "again", "--quiet", cwd=folder)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual((Path(folder) / "again/study/report.html").read_text(encoding="utf-8"), self.page)
            return json.loads((out / "result.json").read_text())

    def test_a_neighbour_in_another_valley_within_narrow_bounds(self):
        """Bounds within 1 % of the value, and valleys of the objective within them: the point of looser bounds is at least as good as the
        one of stricter bounds, from whose design it is searched."""
        study = {"format": "modetune-study/1", "model": "model.json", "variables": [{"parameter": "k", "lower": K, "upper": 1.009 * K}],
                 "search": {"starts": 2, "max_evaluations": 400}, "goals": [{"type": "frequency", "mode": 1, "at_least_hz": 0.01}],
                 "objective": {"minimise": f"-cos(6000*k/{K}) - 100*k/{K}"},
                 "trade": {"vary": [{"variable": "k", "bound": "lower", "values": [K, 1.0082 * K]}]}}
        loose, strict = (p["best"]["objectives"][0]["recommended"] for p in self.answer(study)["trade"]["points"])
        self.assertLessEqual(loose, strict + 1e-6)

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

    def check_page_of_a_grid(self, result, pareto):
        """Whole points are a selection, all numbers stand in columns, and the tables show what is whole."""
        points = result["trade"]["points"]
        page = data(self.page, "data")
        grid, whole = page["grid"], page["trade"]["points"]
        self.assertEqual(whole, [points[k] for k in grid["at"]])
        self.assertEqual({k: v for k, v in page.items() if k not in ("grid", "trade", "run")},
                         {k: v for k, v in result.items() if k not in ("trade", "run")})
        chosen = [k for k, p in enumerate(points) if (p["pareto"] if pareto else p["best"]["parameters"])]
        self.assertGreater(len(chosen), 1)
        each = -(-len(chosen) // 400)
        self.assertEqual(grid["at"], chosen[::each])
        self.assertEqual(list(zip(*grid["values"])), [tuple(p["values"]) for p in points])
        self.assertEqual([grid["statuses"][i] for i in grid["status"]], [p["status"] for p in points])
        self.assertEqual(grid["feasible"], [int(p["best"]["feasible"]) for p in points])
        self.assertEqual(grid["pareto"], [int(p["pareto"]) for p in points])
        self.assertEqual(grid["has_design"], [int(bool(p["best"]["parameters"])) for p in points])
        columns = {name: [p["best"][name] for p in points] for name in ("score", "change", "misfit", "clearance_percent")}
        for i, column in enumerate(grid["parameters"]):
            columns[f"parameter {i}"] = [p["best"]["parameters"][i]["recommended"] if p["best"]["parameters"] else None for p in points]
        for i, column in enumerate(grid["objectives"]):
            columns[f"objective {i}"] = [p["best"]["objectives"][i]["recommended"] if p["best"]["objectives"] else None for p in points]
        for name, want in columns.items():
            kind, _, place = name.partition(" ")
            got = grid[f"{kind}s"][int(place)] if place else grid[name]
            want = [] if all(v is None for v in want) else [v if v is None else float(f"{v:.7g}") for v in want]
            self.assertEqual(got, want, name)
        left = f"{len(grid['at'])} of {len(points)} points, "
        self.assertIn(left, self.page)
        self.assertIn(left, self.text)
        self.assertEqual(len(self.rows), len(points))
        self.assertLess(len(self.page), 1_300_000)

    def test_the_page_of_a_large_grid_has_a_table_of_numbers(self):
        """21 x 20 points with a front; without a front, whole points are spread over those with a design."""
        vary = [{"goal": 0, "member": "at_most", "values": [10 ** (-4 - i / 15) for i in range(21)]},
                {"variable": "L", "bound": "upper", "values": [60 + i for i in range(20)]}]
        study = STUDY | {"variables": VARIABLES + [{"parameter": "L", "lower": 10, "upper": 90}], "units": {"length": "mm"},
                         "search": {"starts": 1}}
        result = self.answer(study | {"trade": {"vary": vary, "objectives": ["change", "vibration"]}})
        self.assertIn("compromise", {p["status"] for p in result["trade"]["points"]})
        self.check_page_of_a_grid(result, True)
        self.check_page_of_a_grid(self.answer(study | {"trade": {"vary": vary}}), False)

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

# SPDX-License-Identifier: GPL-3.0-or-later
"""The inceptor from catalogues and its trade study: `run --verify` holds, and the modes alone, one design at a time, give the same answers."""
import json
import math
import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

TREE = Path(os.environ["SOURCE_DIR"])
PROGRAM = os.environ["MODETUNE"]
MODEL = (TREE / "problems/inceptor.json").read_text(encoding="utf-8")
ORIGINAL = {"M_SAU": 2.2635, "K_T1": 9795.7}
MASSES = [0.5, 0.63, 0.8, 1, 1.25, 1.6, 2, 2.5, 3.15, 4, 5, 6.3, 8]
E12 = [3900, 4700, 5600, 6800, 8200, 10000, 12000, 15000, 18000, 22000, 27000]  # IEC 60063
ROTOR_HZ = 258 / 60


def bands(margin):
    """1P, 4P, 8P, 16P and 24P over 95 to 105 % of the rotor's speed, widened by the margin."""
    return [(n * ROTOR_HZ * 0.95 * (1 - margin), n * ROTOR_HZ * 1.05 * (1 + margin)) for n in (1, 4, 8, 16, 24)]


class Choices(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def run_study(self, name, *options):
        done = subprocess.run([PROGRAM, "run", "--verify", str(TREE / f"studies/{name}.json"), "-o", "out", *options],
                              cwd=self.folder, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return json.loads((self.folder / f"out/{name}/result.json").read_text(encoding="utf-8"))

    def hz(self, pairs):
        """Of each pair of mass and spring: one process, a configuration for each design."""
        model = json.loads(MODEL)
        names = [f"design_{i}" for i in range(len(pairs))]
        model["configurations"].update({name: {"like": "installed", "parameters": {"M_SAU": mass, "K_T1": spring}}
                                        for name, (mass, spring) in zip(names, pairs)})
        (self.folder / "designs.json").write_text(json.dumps(model), encoding="utf-8")
        done = subprocess.run([PROGRAM, "modes", "designs.json", "--format", "json"], cwd=self.folder, capture_output=True, text=True, check=True)
        answers = {answer["configuration"]: answer["modes"] for answer in json.loads(done.stdout)}
        return [[m["frequency_hz"] for m in answers[name] if m["kind"] == "flexible"] for name in names]

    def clear(self, pairs, margins):
        return [all(f <= low * (1 + 1e-6) or f >= high * (1 - 1e-6) for f in hz for low, high in bands(margin))
                for hz, margin in zip(self.hz(pairs), margins, strict=True)]

    @staticmethod
    def change(mass, spring):
        return math.hypot(math.log(mass / ORIGINAL["M_SAU"]), math.log(spring / ORIGINAL["K_T1"]))

    def test_the_catalogue_study_is_what_judging_every_pair_gives(self):
        pairs = sorted((self.change(m, k), m, k) for m in MASSES for k in E12)
        feasible = [p for p, clear in zip(pairs, self.clear([p[1:] for p in pairs], [0.1] * len(pairs))) if clear]
        result = self.run_study("inceptor_catalogue")
        self.assertEqual(result["status"], "solved")
        for want, got in zip(feasible, result["recommendations"], strict=False):
            values = {p["name"]: p["recommended"] for p in got["parameters"]}
            self.assertEqual((values["M_SAU"], values["K_T1"]), want[1:])
            self.assertAlmostEqual(got["score"], want[0], delta=1e-9)
        text = result["certificates"][0]["text"]
        self.assertTrue(result["certificates"][0]["proven"])
        self.assertIn(f"all 143 combinations of catalogue values were judged, {len(feasible)} of them", text)

    def test_the_trade_study_keeps_its_promises(self):
        result = self.run_study("inceptor_trade", "--threads", "2")
        points = result["trade"]["points"]
        self.assertEqual(len(points), 40)
        designs = []
        for point in points:
            if point["status"] != "solved":
                self.assertEqual(point["status"], "infeasible")
                continue
            values = {p["name"]: p["recommended"] for p in point["best"]["parameters"]}
            allowed, margin = point["values"]
            self.assertLessEqual(values["M_SAU"], allowed)
            designs.append((values["M_SAU"], values["K_T1"], margin / 100))
            self.assertGreaterEqual(point["best"]["clearance_percent"], margin - 1e-4)
        self.assertTrue(all(self.clear([d[:2] for d in designs], [d[2] for d in designs])))
        front = [(p["best"]["change"], p["best"]["clearance_percent"]) for p in points if p["pareto"]]
        self.assertGreaterEqual(len(front), 8)
        for change, clearance in front:
            self.assertFalse([1 for c, d in front if c < change * (1 - 1e-5) and d > clearance * (1 + 1e-5)])
        self.assertTrue((self.folder / "out/inceptor_trade/trade.csv").read_text().startswith("upper bound of M_SAU [kg],"))
        self.assertIn("Trade study", (self.folder / "out/inceptor_trade/report.html").read_text())

    def test_nothing_nearer_than_the_recommended_design_is_clear(self):
        best = self.run_study("inceptor_trade")["recommendations"][0]
        reach = best["change"] * 0.999
        angles = [ray * math.pi / 18 for ray in range(36)]
        around = [(ORIGINAL["M_SAU"] * math.exp(reach * math.cos(a)), ORIGINAL["K_T1"] * math.exp(reach * math.sin(a))) for a in angles]
        self.assertEqual([a for a, clear in zip(angles, self.clear(around, [0.1] * len(around))) if clear], [])


if __name__ == "__main__":
    unittest.main()

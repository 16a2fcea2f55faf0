#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bands over the range of motion.

An arm of length 1 turns about the origin, locked at theta; a mass m slides along it on a spring k1, and a spring k2 holds
the mass in the global x. The potential is quadratic in the mass's place r on the arm, so for every theta, stretched or not,
    f(theta) = sqrt((k1 + k2 cos(theta)^2) / m) / (2 pi).
The suite chooses among a few values where the search itself is not asked about. MT_EVERY=1: searches everywhere, relaxations, the greatest clearance, a margin of none and one worker, too, and twelve random arms.
"""
import json
import math
import random
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

from common_cli import PROGRAM, main
from suite import EVERY, FEW


def run(*args, cwd):
    return subprocess.run([PROGRAM, *args], cwd=cwd, capture_output=True, encoding="utf-8", timeout=600)

TWO_PI = 2 * math.pi
M, K2 = 2.0, 5000.0


def k1_for(hz, theta, m=M, k2=K2):
    return m * (TWO_PI * hz) ** 2 - k2 * math.cos(theta) ** 2


def hz_at(k1, theta, m=M, k2=K2):
    return math.sqrt((k1 + k2 * math.cos(theta) ** 2) / m) / TWO_PI


def drive(theta):
    return {"joint": "pivot", "position_rad": theta, "hold": "lock"}


def arm(positions, k1, more=None):
    """positions: name to angle."""
    configurations = {name: {"drive": drive(theta)} for name, theta in positions.items()}
    configurations.update(more or {})
    return {
        "format": "modetune-model/1", "name": "Arm", "dimension": 2,
        "parameters": {"k1": k1, "k2": K2, "m": M, "spare": 1},
        "bodies": [{"name": "arm", "mass_kg": 1, "inertia_kg_m2": 0.1, "centre": [0.5, 0]},
                   {"name": "slider", "mass_kg": "m", "inertia_kg_m2": 0.01, "centre": [1, 0]}],
        "joints": [{"name": "pivot", "type": "revolute", "bodies": ["ground", "arm"], "at": [0, 0]},
                   {"name": "slide", "type": "prismatic", "bodies": ["arm", "slider"], "at": [1, 0], "axis": [1, 0]}],
        "springs": [{"name": "along", "type": "bushing", "bodies": ["arm", "slider"], "at": [1, 0],
                     "stiffness_n_per_m": ["k1", 0], "stiffness_n_m_per_rad": 0},
                    {"name": "across", "type": "bushing", "bodies": ["ground", "slider"], "at": [1, 0],
                     "stiffness_n_per_m": ["k2", 0], "stiffness_n_m_per_rad": 0}],
        "configurations": configurations}


def study(goals, variables=None, **more):
    text = {"format": "modetune-study/1", "name": "Arm", "model": "model.json",
            "variables": variables or [{"parameter": "k1", "lower": 1000, "upper": 50000}],
            "goals": goals, "objective": {"minimise": "change"}, "search": {"starts": 4}}
    text.update(more)
    return text


def avoid(configurations, bands, **more):
    goal = {"type": "avoid", "configurations": configurations, "bands_hz": bands}
    goal.update(more)
    return goal


class ArmTest(unittest.TestCase):
    """Asks a study of one model, in a folder of their own; what was printed is in `text`, the exit status in `code`."""

    def ask(self, model, question, *options):
        with tempfile.TemporaryDirectory() as folder:
            here = Path(folder)
            (here / "model.json").write_text(json.dumps(model))
            (here / "study.json").write_text(json.dumps(question))
            done = run("run", "study.json", "-o", "out", "--quiet", *options, cwd=folder)
            self.assertIn(done.returncode, (0, 1), done.stderr)
            self.assertTrue((here / "out/study/result.json").exists(), done.stderr)
            self.code, self.text = done.returncode, done.stdout
            return json.loads((here / "out/study/result.json").read_text())


class Motion(ArmTest):
    def answer(self, model, question, code=None, *options):
        result = self.ask(model, question, *options)
        if code is not None:
            self.assertEqual(self.code, code, self.text)
        return result

    @staticmethod
    def among(*values):
        """Variables of a study: one of these values, or with all tests any value."""
        return [{"parameter": "k1", "catalogue": sorted(values)}] if FEW else None

    def best(self, result):
        design = result["recommendations"][0]
        return design, {p["name"]: p["recommended"] for p in design["parameters"]}

    def test_a_margin_between_positions_has_a_price(self):
        """The mode stays below a band and is highest at theta = 0, between the positions: k1 = m (2 pi f)^2 - k2 at the edge
        f of band and margin, and 1 % more of f is worth dk1 = 0.02 m (2 pi f)^2 (to first order)."""
        for low, margin in ((16.0, 10), (14.0, 0))[:2 if EVERY else 1]:
            edge = low * (1 - margin / 100)
            model = dict(arm({"back": -0.6, "forth": 0.8}, 5000), units={"angle": "deg"})
            model["parameters"]["k1"] = {"value": 5000, "unit": "N/m"}
            result = self.answer(model, study([avoid(["back", "forth"], [[low, 30]], margin_percent=margin)], objective={"minimise": "60000 - k1"}), 0)
            best, at = self.best(result)
            with self.subTest(low=low, margin=margin):
                self.assertAlmostEqual(at["k1"] / k1_for(edge, 0), 1, delta=1e-4)
                told = [r["text"] for r in best["reasons"] if r["kind"] == "cost" and "between the positions" in r["text"]]
                self.assertGreaterEqual(len(told), 1, best["reasons"])
                found = [re.search(r"Relaxing the lower edge of .*, which holds mode 1 where pivot is at (\S+) deg, between the positions, "
                                   r"by 1 % would reduce the objective by ([0-9.]+)", t) for t in told]
                self.assertTrue(all(found), told)
                self.assertTrue(all(abs(float(m[1])) < 1 for m in found), told)
                worth = 0.02 * M * (TWO_PI * edge) ** 2
                self.assertAlmostEqual(sum(float(m[2]) for m in found) / worth, 1, delta=6e-3)
                row = best["motion"][0]
                self.assertEqual((row["unit"], row["display_unit"]), ("rad", "deg"))
                self.assertAlmostEqual(row["from"], -0.6, delta=1e-12)
                self.assertTrue(row["text"].startswith("pivot from -34.3775 to 45.8366 deg ("), row["text"])
        self.assertRegex(self.text, r"pivot +deg +-34\.3775 +45\.8366 ")

    def test_one_drive_has_one_count(self):
        """Above the band at one end of the motion, below it at the other: the shipped design must stay on one side."""
        positions = {"down": 0.1, "up": 1.3}
        model = arm(positions, k1_for(13.0, 0.1))  # 13 Hz down to 10.8: 12.2 in between
        self.assertLess(hz_at(model["parameters"]["k1"], 1.3), 11)
        result = self.answer(model, study([avoid(["down", "up"], [[11, 12.5]])]), 0)
        self.assertFalse(result["baseline"]["feasible"])
        self.assertTrue(result["baseline"]["motion"][0]["crosses"])
        self.assertIn('mode 1 crosses 11 to 12.5 Hz between "down" and "up"', " ".join(
            r["text"] for r in result["baseline"]["reasons"]))
        found = sorted(r["parameters"][0]["recommended"] for r in result["recommendations"])
        wanted = [k1_for(11, 0.1), k1_for(12.5, 1.3)]
        self.assertEqual(len(found), 2)
        for a, b in zip(found, wanted):
            self.assertAlmostEqual(a / b, 1, delta=1e-5)
        for r in result["recommendations"]:
            self.assertEqual(len({g["modes_below"] for g in r["gap_assignment"]}), 1)
            self.assertNotEqual(r["grade"], "feasible and proven")
            self.assertEqual(r["motion"][0]["grade"], "sampled")
            self.assertFalse(r["motion"][0]["crosses"])

    def test_two_goals_of_one_drive_count_as_one(self):
        positions = {"down": 0.1, "up": 1.3}
        model = arm(positions, k1_for(13.0, 0.1))
        goals = [avoid(["down"], [[11, 12.5]]), avoid(["up"], [[11, 12.5]])]
        k1 = k1_for(11, 0.1) * (1 - 1e-7)
        result = self.answer(model, study(goals, self.among(k1, k1 * 1.05)), 0)
        self.assertFalse(result["baseline"]["feasible"])
        self.assertAlmostEqual(min(abs(math.log(r["parameters"][0]["recommended"] / k)) for r in
                                   result["recommendations"] for k in [k1_for(11, 0.1)]), 0, delta=1e-5)
        # bands that share no frequency say nothing of each other
        goals = [avoid(["down"], [[11, 12]]), avoid(["up"], [[12.5, 13]])]
        result = self.answer(model, study(goals, self.among(model["parameters"]["k1"])), 0)
        self.assertTrue(result["baseline"]["feasible"])
        self.assertEqual(result["baseline"]["motion"], [])

    def test_a_dip_between_clean_positions_is_searched(self):
        """Same count at both ends, the greatest frequency between them: the answer keeps that clear, in closed form, whoever works at it."""
        model = arm({"down": -1.1, "up": 0.9}, k1_for(12.0, 0.0))
        answers = [self.answer(model, study([avoid(["down", "up"], [[11, 12.5]])]), 0, "--threads", n) for n in ("3", "1")[:2 if EVERY else 1]]
        self.assertEqual(answers[0], answers[-1])
        design, x = self.best(answers[0])
        self.assertAlmostEqual(x["k1"] / k1_for(11, 0.0), 1, delta=1e-5)
        motion = design["motion"][0]
        self.assertAlmostEqual(motion["at"], 0, delta=1e-3)
        self.assertAlmostEqual(motion["hz"], 11, delta=1e-4)
        self.assertGreater(motion["positions"], 8)
        self.assertAlmostEqual(design["clearance_percent"], 0, delta=1e-3)
        clear = [c for c in design["clearances"] if c["side"] == "below"]
        self.assertTrue(all(c["percent"] > 1 for c in clear), "the named positions are well clear")

    def test_a_dip_in_a_catalogue_is_refused(self):
        model = arm({"down": -1.1, "up": 0.9}, 9000)
        ends_only = 0.5 * (k1_for(11, 0.0) + k1_for(11, 0.9))  # clear at both ends, inside between them
        inside = hz_at(ends_only, 0.0)
        self.assertTrue(11 < inside < 12.5 and hz_at(ends_only, 0.9) < 11)
        fine = 0.9 * k1_for(11, 0.0)
        values = [ends_only, fine]
        model["parameters"]["k1"] = ends_only
        question = study([avoid(["down", "up"], [[11, 12.5]])],
                         [{"parameter": "k1", "catalogue": values}])
        result = self.answer(model, question, 0)
        self.assertFalse(result["baseline"]["feasible"])
        self.assertEqual([r["parameters"][0]["recommended"] for r in result["recommendations"]], [fine])
        # and with a continuous variable beside the catalogue
        question["variables"].append({"parameter": "spare", "lower": 0.5, "upper": 2})
        result = self.answer(model, question, 0)
        self.assertEqual(self.best(result)[1]["k1"], fine)

    def test_a_catalogue_of_crossings_has_no_answer(self):
        model = arm({"down": 0.1, "up": 1.3}, k1_for(13.0, 0.1))
        values = [k1_for(12.9, 0.1), k1_for(13.0, 0.1)]
        result = self.answer(model, study([avoid(["down", "up"], [[11, 12.5]])],
                                          [{"parameter": "k1", "catalogue": values}]), 1)
        self.assertNotEqual(result["status"], "solved")
        self.assertTrue(all(not r["feasible"] for r in result["recommendations"]))

    @unittest.skipUnless(EVERY, "searches for seconds: MT_EVERY=1")
    def test_greatest_clearance_is_that_of_the_whole_motion(self):
        model = arm({"down": -1.1, "up": 0.9}, k1_for(14.0, 0.0))
        variables = [{"parameter": "k1", "lower": k1_for(11, 0.0) * 0.7, "upper": k1_for(12.5, 0.0) * 1.5}]
        result = self.answer(model, study([avoid(["down", "up"], [[11, 12.5]])], variables,
                                          objective={"maximise": "clearance"}), 0)
        for design in result["recommendations"]:
            k1 = design["parameters"][0]["recommended"]
            dense = [hz_at(k1, -1.1 + 2.0 * i / 2000) for i in range(2001)]
            least = min(max(11 / f, f / 12.5) for f in dense) - 1
            self.assertAlmostEqual(design["motion"][0]["least_clearance_percent"] / 100,
                                   min(min(11 / f - 1 if f < 11.7 else f / 12.5 - 1 for f in dense), 1e9),
                                   delta=1e-5)
            self.assertGreater(least, 0)

    def test_what_is_a_family(self):
        """Same items, overrides and hold: one drive. Another override or hold: not."""
        k1 = k1_for(13.0, 0.1)
        here = [{"parameter": "k1", "catalogue": [k1]}]  # it is the baseline that is looked at
        cases = [
            ({"up": {"like": "down", "drive": drive(1.3)}}, True),
            ({"up": {"drive": drive("1.3")}}, True),
            ({"up": {"parameters": {"spare": 7}, "drive": drive("1.3")}}, True),  # enters nothing
            ({"up": {"parameters": {"k2": 4999}, "drive": drive(1.3)}}, False),
            ({"up": {"gravity_m_per_s2": [0, -1e-9], "drive": drive(1.3)}}, False),
        ]
        for more, family in cases:
            with self.subTest(more=more):
                result = self.answer(arm({"down": 0.1}, k1, more), study([avoid(["down", "up"], [[11, 12.5]])], here))
                self.assertEqual(result["baseline"]["feasible"], not family)
                self.assertEqual(len(result["baseline"]["motion"]), 1 if family else 0)

    def test_positions_that_follow_a_parameter(self):
        model = arm({}, k1_for(13.0, 0.1), {"down": {"parameters": {"spare": 0.1}, "drive": drive("spare")},
                                            "up": {"parameters": {"spare": 1.3}, "drive": drive("spare")}})
        result = self.answer(model, study([avoid(["down", "up"], [[11, 12.5]])], self.among(k1_for(10.9, 0.1), k1_for(12, 0.1))), 0)
        self.assertFalse(result["baseline"]["feasible"])
        self.assertTrue(all(r["feasible"] for r in result["recommendations"]))

    @unittest.skipUnless(EVERY, "searches for several seconds: MT_EVERY=1")
    def test_what_would_let_a_design_exist_holds_over_the_motion(self):
        k1 = k1_for(12.0, 0.0)
        variables = [{"parameter": "k1", "lower": 0.95 * k1, "upper": 1.05 * k1}]
        result = self.answer(arm({"down": -1.1, "up": 0.9}, k1), study([avoid(["down", "up"], [[11, 12.5]])], variables), 1)
        bounds = [r for r in result["relaxations"] if r["pointer"].startswith("/variables")]
        self.assertTrue(bounds)
        for r in bounds:  # the lower one would need k1_for(11, 0.0), not what the ends alone ask for
            wanted = k1_for(12.5, 1.1) if r["to"] > k1 else k1_for(11, 0.0)
            self.assertAlmostEqual(r["to"] / wanted, 1, delta=1e-4)


class Random(unittest.TestCase):
    """Two-link arms of random proportions, driven at the shoulder, sprung at the elbow and against the ground."""

    @staticmethod
    def model(rng):
        a, b = rng.uniform(0.5, 1.5), rng.uniform(0.3, 1.2)
        bend = rng.uniform(-2.5, 2.5)
        elbow = [a, 0]
        tip = [a + b * math.cos(bend), b * math.sin(bend)]
        ends = sorted(rng.sample(range(-12, 13), rng.choice([2, 3])))
        names = ["down", "mid", "up"][:len(ends)]
        return {
            "format": "modetune-model/1", "name": "Two links", "dimension": 2,
            "gravity_m_per_s2": [0, rng.choice([0, 0, -9.81])],
            "parameters": {"ke": rng.uniform(50, 500), "kx": rng.uniform(50, 2000), "ky": rng.uniform(0, 500),
                           "mt": rng.uniform(0.2, 2)},
            "bodies": [{"name": "upper", "mass_kg": 1, "inertia_kg_m2": 0.05, "centre": [a / 2, 0]},
                       {"name": "lower", "mass_kg": 0.7, "inertia_kg_m2": 0.03,
                        "centre": [(elbow[0] + tip[0]) / 2, tip[1] / 2]},
                       {"name": "tip", "mass_kg": "mt", "inertia_kg_m2": 0.01, "centre": tip}],
            "joints": [{"name": "shoulder", "type": "revolute", "bodies": ["ground", "upper"], "at": [0, 0]},
                       {"name": "elbow", "type": "revolute", "bodies": ["upper", "lower"], "at": elbow},
                       {"name": "wrist", "type": "revolute", "bodies": ["lower", "tip"], "at": tip}],
            "springs": [{"name": "se", "type": "torsion", "joint": "elbow", "stiffness_n_m_per_rad": "ke"},
                        {"name": "sw", "type": "torsion", "joint": "wrist", "stiffness_n_m_per_rad": 30},
                        {"name": "sg", "type": "bushing", "bodies": ["ground", "lower"], "at": tip,
                         "stiffness_n_per_m": ["kx", "ky"], "stiffness_n_m_per_rad": 0}],
            "configurations": {name: {"drive": {"joint": "shoulder", "position_rad": 0.1 * e, "hold": "lock"}}
                               for name, e in zip(names, ends)}}

    def dense(self, folder, model, x, n=241):
        """Frequencies at n positions by the sweep, of a model with the values of a design."""
        named = model["configurations"]
        at = [c["drive"]["position_rad"] for c in named.values()]
        fresh = json.loads(json.dumps(model))
        fresh["parameters"].update(x)
        (Path(folder) / "fresh.json").write_text(json.dumps(fresh))
        done = run("sweep", "fresh.json", "-c", next(iter(named)), "--drive",
                   f"shoulder={min(at)!r}:{max(at)!r}:{n}", "--frequencies", "--format", "json", "--quiet", cwd=folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        text = json.loads(done.stdout)
        text = text[0] if isinstance(text, list) else text
        return [p["frequencies_hz"] for p in text["points"]]

    def test_what_is_recommended_stays_clear_all_the_way(self):
        seen = 0
        arms = 12 if EVERY else 1
        for seed in range(arms):
            rng = random.Random(seed)
            model = self.model(rng)
            with tempfile.TemporaryDirectory() as folder, self.subTest(seed=seed):
                here = Path(folder)
                (here / "model.json").write_text(json.dumps(model))
                names = list(model["configurations"])
                done = run("modes", "model.json", "-c", names[0], "--format", "json", cwd=folder)
                if done.returncode != 0:
                    continue  # no stable position to begin from
                modes = json.loads(done.stdout)["modes"]
                if any(m["kind"] != "flexible" for m in modes):
                    continue
                hz = rng.choice([m["frequency_hz"] for m in modes[:2]])
                band = [hz * rng.uniform(0.93, 0.99), hz * rng.uniform(1.01, 1.07)]
                variables = [{"parameter": p, "lower": model["parameters"][p] / 10, "upper": model["parameters"][p] * 10}
                             for p in ("ke", "kx", "mt")]
                question = {"format": "modetune-study/1", "name": "s", "model": "model.json", "variables": variables,
                            "goals": [{"type": "avoid", "configurations": names, "bands_hz": [band],
                                       "margin_percent": rng.choice([0, 5])}],
                            "objective": {"minimise": "change"}, "search": {"starts": 4, "max_evaluations": 400}}
                (here / "study.json").write_text(json.dumps(question))
                done = run("run", "study.json", "-o", "out", "--quiet", cwd=folder)
                if done.returncode not in (0, 1):
                    continue
                result = json.loads((here / "out/study/result.json").read_text())
                for design in [result["baseline"]] + result["recommendations"]:
                    seen += self.judge(folder, model, design)
        self.assertGreater(seen, 0.8 * arms)

    def judge(self, folder, model, design):
        """1: a design that is called clear was found clear."""
        if not design["feasible"]:
            return 0
        x = {p["name"]: p["original"] if p["recommended"] is None else p["recommended"] for p in design["parameters"]}
        gap = design["gap_assignment"][0]
        lower, upper, k = gap["margin_lower_hz"], gap["margin_upper_hz"], gap["modes_below"]
        least = math.inf
        for f in self.dense(folder, model, x):
            below = math.log(lower / f[k - 1]) if k > 0 else math.inf
            above = math.log(f[k] / upper) if k < len(f) else math.inf
            least = min(least, below, above)
        self.assertGreater(least, -3e-6, design["motion"])
        motion = design["motion"][0]
        self.assertEqual(motion["crosses"], False)
        if motion["grade"] == "sampled":
            mine = math.log(motion["hz"] / upper) if motion["hz"] > math.sqrt(lower * upper) else \
                math.log(lower / motion["hz"])
            self.assertLess(mine, least + 1e-6, "the dense sweep comes nearer than what is said")
        return 1


if __name__ == "__main__":
    main()

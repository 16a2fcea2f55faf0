#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Goals of forced vibration over the positions of a drive.

The arm of test_motion, with a damper c beside the spring along it. A force of 1 N along the global x at the mass, which
moves along the arm alone, makes it move along x by
    |H(theta)| = cos(theta)^2 / |k1 + k2 cos(theta)^2 - m w^2 + i w c|
for every theta, stretched or not: with x = cos(theta)^2 between two positions at which it is smaller.
MT_EVERY=1: a search with bands beside it, bands that cut, and every budget.
"""
import math
import re
import unittest

from common_cli import main
from suite import EVERY, FEW
from test_motion import K2, M, TWO_PI, ArmTest, arm, avoid, k1_for, study

HZ = 12.0
NAMED = {"down": 0.2, "up": 1.2}


def response(k1, c, theta, hz=HZ):
    w, x = TWO_PI * hz, math.cos(theta) ** 2
    return x / abs(k1 + K2 * x - M * w * w + 1j * w * c)


def largest(k1, c, theta=None):
    """Over all theta: with a = k1 - m w^2, b = w c the square x^2 / ((a + k2 x)^2 + b^2) is stationary at x = -(a^2 + b^2) / (a k2)."""
    w = TWO_PI * HZ
    a, b = k1 - M * w * w, w * c
    x = -(a * a + b * b) / (a * K2)
    return response(k1, c, math.acos(math.sqrt(x))), math.acos(math.sqrt(x))


def damped(k1, c, positions=None, more=None):
    model = arm(positions or NAMED, k1, more)
    model["parameters"]["c"] = c
    model["dampers"] = [{"name": "d", "type": "axial", "bodies": ["arm", "slider"], "at": [[0.5, 0], [1, 0]], "damping_n_s_per_m": "c"}]
    model["sensors"] = [{"name": "grip", "on": "slider", "at": [1, 0], "directions": ["x"]}]
    return model


def goal(limit, **more):
    return {"type": "response", "configurations": ["down", "up"], "input": "grip.x", "output": "grip.x", "at_hz": HZ, "at_most": limit} | more


C = [{"parameter": "c", "lower": 1, "upper": 1000}]
K1 = k1_for(HZ, 0.7)


class Positions(ArmTest):
    def test_the_worst_position_is_found(self):
        value, at = largest(K1, 20.0)
        for limit in (value / 1.2, value * 1.2):
            design = self.ask(damped(K1, 20.0), study([goal(limit)], C))["baseline"]
            row = design["responses_between"][0]
            self.assertLess(max(response(K1, 20.0, t) for t in NAMED.values()), 0.95 * value)
            self.assertAlmostEqual(row["value"] / value, 1, delta=1e-6)
            self.assertAlmostEqual(row["at"], at, delta=2e-3)
            self.assertEqual((row["goal"], row["drive"], row["unit"], row["value_unit"]), ("/goals/0", "pivot", "rad", "m per N"))
            self.assertEqual((row["from"], row["to"], row["named"], row["end"], row["grade"]), (0.2, 1.2, False, "finite", "sampled"))
            self.assertEqual(row["holds"], limit > value)
            self.assertAlmostEqual(row["violation_percent"], 100 * max(value / limit - 1, 0), delta=1e-3)
            self.assertGreater(row["positions"], 8)

    def test_positions_are_told_in_the_model_s_unit(self):
        value, at = largest(K1, 20.0)
        row = self.ask(dict(damped(K1, 20.0), units={"angle": "deg"}), study([goal(value * 1.2)], C))["baseline"]["responses_between"][0]
        self.assertEqual((row["unit"], row["from"]), ("rad", 0.2))
        self.assertRegex(row["text"], r" over pivot from 11\.4592 to 68\.7549 deg \(")
        told = re.search(r" is worst at ([0-9.]+) deg: ", row["text"])
        self.assertIsNotNone(told, row["text"])
        self.assertAlmostEqual(math.radians(float(told[1])), at, delta=2e-3)

    def test_the_search_keeps_the_limit_between_the_positions(self):
        """More damping than the named positions ask for: what the worst between them does, whoever works at it."""
        limit = largest(K1, 25.0)[0]
        answers = [self.ask(damped(K1, 20.0), study([goal(limit)], C), "--threads", n) for n in ("1", "3")]
        self.assertEqual(answers[0], answers[1])
        design = answers[0]["recommendations"][0]
        self.assertTrue(design["feasible"])
        self.assertAlmostEqual(design["parameters"][0]["recommended"] / 25.0, 1, delta=1e-5)
        row = design["responses_between"][0]
        self.assertTrue(row["holds"])
        self.assertFalse(row["named"])
        self.assertLess(max(response(K1, 25.0, t) for t in NAMED.values()), 0.98 * limit)
        self.assertIn("all of them keep the limit (sampled, not proven)", self.text)
        self.assertEqual(answers[0]["warnings"], [])

    def test_a_band_of_frequencies_is_kept_likewise(self):
        """The peak of the resonance, whose frequency and coupling both follow the arm, against a fine grid of the closed form."""
        def peak(c, theta):
            return max(response(K1, c, theta, 8 + 0.005 * i) for i in range(1600))
        grid = [0.2 + 0.01 * i for i in range(101)]
        positions = {"a": 0.9, "b": 1.2, "c": -0.6}
        model = damped(K1, 20.0, positions)
        limit = 0.5 * max(peak(20.0, t) for t in grid)
        asked = study([goal(limit, configurations=["a", "b", "c"]) | {"band_hz": [8, 16]}], C)
        del asked["goals"][0]["at_hz"]
        design = self.ask(model, asked)["recommendations"][0]
        row = design["responses_between"][0]
        c = design["parameters"][0]["recommended"]
        self.assertTrue(row["holds"])
        self.assertAlmostEqual(row["at"], 0, delta=2e-3)  # where the arm lies along x
        self.assertAlmostEqual(peak(c, 0) / limit, 1, delta=1e-4)
        self.assertEqual((row["from"], row["to"]), (-0.6, 1.2))

    def test_what_cannot_be_kept_is_told(self):
        """The damping has a bound that is enough for the positions that are given, and for no more."""
        limit = largest(K1, 25.0)[0]
        named = max(response(K1, 24.5, t) for t in NAMED.values())
        self.assertLess(named, limit)
        result = self.ask(damped(K1, 20.0), study([goal(limit)], [C[0] | {"upper": 24.5}]))
        design = result["recommendations"][0]
        self.assertTrue(design["feasible"])
        self.assertFalse(design["responses_between"][0]["holds"])
        self.assertIn("does not hold over the range", self.text)
        self.assertIn("keeps the limit of /goals/0 only at the named positions", " ".join(result["warnings"]))

    def test_a_limit_from_below(self):
        """Two positions beside the node of a peak: the least lies between, at an end of neither."""
        k1 = k1_for(HZ, 0.7)
        positions = {"down": -0.5, "up": 0.65}
        asked = study([goal(None, at_least=response(k1, 20.0, 0.0) * 1.1)], C)
        del asked["goals"][0]["at_most"]
        row = self.ask(damped(k1, 20.0, positions), asked)["baseline"]["responses_between"][0]
        self.assertAlmostEqual(row["at"], 0, delta=2e-3)
        self.assertAlmostEqual(row["value"] / response(k1, 20.0, 0.0), 1, delta=1e-6)
        self.assertFalse(row["holds"])

    def test_what_is_no_range_has_none(self):
        same = self.ask(damped(K1, 20.0, {"down": 0.2, "up": 0.2}), study([goal(1.0)], C))
        self.assertEqual(same["baseline"]["responses_between"], [])
        one = self.ask(damped(K1, 20.0), study([goal(1.0) | {"configurations": ["down"]}], C))
        self.assertEqual(one["baseline"]["responses_between"], [])
        target = goal(None, target=1e-4) | {"configurations": ["down", "up"]}
        del target["at_most"]
        weighted = study([target | {"weight": 1}], C)
        weighted["objective"] = {"minimise": "misfit"}
        self.assertEqual(self.ask(damped(K1, 20.0), weighted)["baseline"]["responses_between"], [])

    def test_a_position_where_nothing_moves(self):
        """At a right angle the response is 0, and its logarithm none."""
        value, at = largest(K1, 20.0)
        row = self.ask(damped(K1, 20.0, {"down": 0.1, "up": math.pi / 2}), study([goal(value / 2)], C))["baseline"]["responses_between"][0]
        self.assertAlmostEqual(row["value"] / value, 1, delta=1e-6)
        self.assertAlmostEqual(row["at"], at, delta=2e-3)

    def test_the_objective_vibration_is_told_too(self):
        asked = study([goal(largest(K1, 25.0)[0])], C)
        asked["objective"] = {"minimise": "vibration"}
        design = self.ask(damped(K1, 20.0), asked)["recommendations"][0]
        self.assertEqual(len(design["responses_between"]), 1)
        self.assertLessEqual(response(K1, design["parameters"][0]["recommended"], 0.2), design["responses_between"][0]["value"] * (1 + 1e-9))

    def test_a_resonance_that_nothing_damps(self):
        """It is met somewhere between the positions, as the frequency passes through: the value has no bound worth a number."""
        row = self.ask(damped(K1, 1e-6), study([goal(1e-3)], C))["baseline"]["responses_between"][0]
        self.assertAlmostEqual(row["at"], 0.7, delta=1e-3)
        self.assertFalse(row["holds"])
        self.assertGreater(row["violation_percent"], 1e4)

    def test_a_budget_is_kept(self):
        limit = largest(K1, 25.0)[0]
        for most in (20, 60, 200) if FEW else (20, 33, 60, 120, 200):
            result = self.ask(damped(K1, 20.0), study([goal(limit)], C), "--max-evaluations", str(most))
            self.assertLessEqual(result["run"]["evaluations"], most)
            rows = [d["responses_between"][0] for d in [result["baseline"], *result["recommendations"]]]
            self.assertTrue(all(r["positions"] <= max(3, most // 10) for r in rows))

    def test_bands_beside_it(self):
        limit = largest(K1, 25.0)[0]
        among = [{"parameter": "c", "catalogue": [25 * (1 + 1e-7), 26]}] if FEW else C
        result = self.ask(damped(K1, 20.0), study([goal(limit), avoid(["down", "up"], [[30, 40]])], among))
        design = result["recommendations"][0]
        self.assertTrue(design["responses_between"][0]["holds"])
        self.assertAlmostEqual(design["parameters"][0]["recommended"] / 25.0, 1, delta=1e-5)
        self.assertEqual(design["motion"][0]["grade"], "sampled")

    @unittest.skipUnless(EVERY, "searches for seconds: MT_EVERY=1")
    def test_bands_that_cut_beside_it(self):
        """Both have their worst between the positions: the spring keeps the mode below a band, the damper the limit."""
        positions = {"down": -1.1, "up": 0.9}
        asked = study([goal(1.0), avoid(["down", "up"], [[11, 12.5]])], [C[0], {"parameter": "k1", "lower": 1000, "upper": k1_for(12.0, 0.0)}])
        asked["goals"][0]["at_most"] = limit = 0.5 * response(k1_for(11, 0.0), 20.0, 0.0)
        design = self.ask(damped(k1_for(12.0, 0.0), 20.0, positions), asked)["recommendations"][0]
        c, k1 = (next(p["recommended"] for p in design["parameters"] if p["name"] == n) for n in ("c", "k1"))
        self.assertTrue(design["responses_between"][0]["holds"])
        self.assertFalse(design["motion"][0]["crosses"])
        self.assertLess(k1 / k1_for(11, 0.0), 1 + 1e-5)
        self.assertLess(max(response(k1, c, -1.1 + 2e-3 * i) for i in range(1001)), limit * (1 + 2e-6))

    def test_a_catalogue_beside_it(self):
        limit = largest(K1, 25.0)[0]
        mixed = C + [{"parameter": "spare", "catalogue": [1, 2]}]
        design = self.ask(damped(K1, 20.0), study([goal(limit)], mixed))["recommendations"][0]
        self.assertTrue(design["responses_between"][0]["holds"])
        alone = [{"parameter": "c", "catalogue": [20, 24.6, 26]}]
        result = self.ask(damped(K1, 20.0), study([goal(limit)], alone))
        holds = [(d["parameters"][0]["recommended"], d["responses_between"][0]["holds"]) for d in result["recommendations"]]
        self.assertEqual(holds, [(26, True)])  # 24.6 keeps the limit at the positions alone
        self.assertEqual(result["warnings"], [])
        named = max(response(K1, 24.6, t) for t in NAMED.values())
        self.assertLess(named, limit)
        none = self.ask(damped(K1, 20.0), study([goal(limit)], [{"parameter": "c", "catalogue": [20, 24.6]}]))
        self.assertEqual((none["status"], [d["parameters"][0]["recommended"] for d in none["recommendations"]]), ("solved", [24.6]))
        self.assertFalse(none["recommendations"][0]["responses_between"][0]["holds"])
        self.assertIn("only at the named positions", " ".join(none["warnings"]))
        self.assertIn("1 of them meets all goals at the named positions, and not between them.", self.text)
        poor = self.ask(damped(K1, 20.0), study([goal(limit)], [{"parameter": "c", "catalogue": [10, 12]}]))
        self.assertEqual(poor["status"], "infeasible")


if __name__ == "__main__":
    main()

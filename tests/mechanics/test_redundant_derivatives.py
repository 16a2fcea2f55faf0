# SPDX-License-Identifier: GPL-3.0-or-later
"""A parameter that ends a redundancy has no derivative there: null, with the joints; a study with it is refused."""
import json
import math
import unittest
from pathlib import Path

from common_mechanisms import MechanismTest, add, loop, seeded

AXES = ("j0", "j1", "j2", "j3")


def polar(length, angle):
    return [length * math.cos(angle), length * math.sin(angle)]


def tilted_four_bar(r, joint):
    """A planar four-bar in space; `joint`'s axis is tilted by the parameter, a pendulum stands beside it."""
    points = [[0, 0], [r.uniform(0.2, 0.4), r.uniform(0.3, 0.5)], [r.uniform(1, 1.3), r.uniform(0.6, 0.8)], [1, 0]]
    m = loop(points).in_space()
    m.body("beside", [3, -0.3, 0])
    m.joint("apart", "revolute", "ground", "beside", [3, 0, 0], [0, 0, 1])
    m.torsion("apart", r.choice([0.1, 1000.0]))
    model = m.model()
    model["parameters"] = {"tilt": 0.0, "k": 10.0}
    model["springs"][0]["stiffness_n_m_per_rad"] = "k"
    for j in model["joints"]:
        if j["name"] == joint:
            j["axis"] = ["tilt", f"{r.uniform(-1, 1)}*tilt", 1]
    return model


def three_cranks(lengths):
    """Parallel cranks of the parameters' lengths, one for each of the three."""
    tip = polar(0.5, 1)
    m = loop([[0, 0], tip, add(tip, [1, 0]), [1, 0]])
    m.body("b9", add([2, 0], tip, 0.5))
    m.joint("j8", "revolute", "ground", "b9", [2, 0])
    m.joint("j9", "revolute", "b1", "b9", add([2, 0], tip))
    model = m.model()
    model["parameters"] = {"l": 0.5, "far": 0.5}
    for j in model["joints"]:
        for name, x, length in zip(("j1", "j2", "j9"), (0, 1, 2), lengths):
            if j["name"] == name:  # on the coupler as drawn, on the crank at its length
                crank = [f"{x}+{length}*cos(1)", f"{length}*sin(1)"]
                pair = [crank, list(add([x, 0], tip))]
                j["at"] = pair if j["bodies"][0] == "b0" else pair[::-1]
    return model


class RedundantDerivatives(MechanismTest):
    def test_a_tilt_has_none_and_what_it_does_not_block_has(self):
        for i in range(12):
            r = seeded("tilt", i)
            joint = r.choice(AXES)
            with self.subTest(i, joint=joint):
                model = tilted_four_bar(r, joint)
                got = self.answer(model, "sensitivity")
                self.assertEqual([(d["parameter"], d["reason"], set(d["joints"])) for d in got["no_derivatives"]],
                                 [("tilt", "blocks_motion", set(AXES))])
                modes = got["modes"]
                self.assertEqual(len(modes), 2)
                by_k = [m["sensitivities"][1]["hz_per_unit"] for m in modes]
                four_bar = max(range(2), key=lambda m: abs(by_k[m]))
                for m in range(2):
                    slope = modes[m]["sensitivities"][0]["hz_per_unit"]
                    if m < four_bar:  # below it, its index stands
                        self.assertAlmostEqual(slope, 0, delta=1e-12)
                    else:
                        self.assertIsNone(slope)
                    self.assertIsNotNone(by_k[m])
                # and that is how it is: a tilt that is no rounding takes the mode away
                done = self.run_on(model, "modes", "--format", "json", "--set", "tilt=1e-4")
                self.assertEqual(len(json.loads(done.stdout)[0]["modes"]), 1, done.stderr)
                self.assertIn("No derivative by tilt: joints ", self.run_on(model, "sensitivity").stdout)

    def test_a_length_that_opens_the_joints_has_none(self):
        got = self.answer(three_cranks(("l", "l", "far")), "sensitivity")
        self.assertEqual([(d["parameter"], d["reason"]) for d in got["no_derivatives"]],
                         [("l", "opens_joints"), ("far", "opens_joints")])
        self.assertEqual({s["hz_per_unit"] for m in got["modes"] for s in m["sensitivities"]}, {None})

    def test_lengths_that_go_together_have_one(self):
        model = three_cranks(("l", "l", "l"))
        got = self.answer(model, "sensitivity")
        self.assertEqual(got["no_derivatives"], [])
        slope = got["modes"][0]["sensitivities"][0]["hz_per_unit"]
        step = 1e-4
        hz = []
        for side in (-1, 1):
            model["parameters"]["l"] = 0.5 + side * step
            hz.append(self.answer(model, "modes")["modes"][0]["frequency_hz"])
        self.assertAlmostEqual((hz[1] - hz[0]) / (2 * step) / slope, 1, delta=1e-6)

    def test_a_study_hears_it_before_it_searches(self):
        folder = Path(self._folder.name)
        (folder / "problems").mkdir()
        (folder / "studies").mkdir()
        for name, model, word in (("tilt", tilted_four_bar(seeded("study"), "j1"), "cannot vary"),
                                  ("far", three_cranks(("l", "l", "far")), "cannot vary alone")):
            for number, variable in enumerate((name, "k" if name == "tilt" else None)):
                if variable is None:
                    continue
                (folder / "problems/m.json").write_text(json.dumps(model), encoding="utf-8")
                study = {"format": "modetune-study/1", "name": "s", "model": "../problems/m.json",
                         "variables": [{"parameter": variable, "lower": -0.1 if number == 0 else 1,
                                        "upper": 0.7 if number == 0 else 20}],
                         "goals": [{"type": "frequency", "configuration": "default", "mode": 1, "at_least_hz": 0.01}]}
                path = folder / "studies/s.json"
                path.write_text(json.dumps(study, indent=1), encoding="utf-8")
                for command in (("check", str(path)), ("run", str(path), "-o", str(folder / "out"), "--quiet")):
                    done = self.run_program(*command)
                    if number == 0:
                        self.assertEqual(done.returncode, 2, done.stderr)
                        self.assertRegex(done.stderr, r"s\.json:\d+:\d+: error: /variables/0: \"" + name + '" ' + word)
                        self.assertIn('"j0", "j1", "j2", "j3"', done.stderr)
                    else:
                        self.assertEqual(done.returncode, 0, done.stderr)


if __name__ == "__main__":
    unittest.main()

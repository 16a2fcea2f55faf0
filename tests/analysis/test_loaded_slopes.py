# SPDX-License-Identifier: GPL-3.0-or-later
"""
Slopes of loaded trees in space, where nothing is symmetric: levers, axes, forces and gravity along all directions, joints of several kinds,
rigid members, a parameter of 0 among them; of what settles under its loads, and of what rests as drawn, each body pulled apart by two equal
forces. Against differences of frequencies (analysis/test_lowest_trees holds the other ways against this one).
"""
import json
import os
import random
import subprocess
import tempfile
import unittest
from pathlib import Path

PROGRAM = os.environ["MODETUNE"]
PARAMETERS = {"L": 1.0, "W": 1.0, "a": 0.0, "b": 0.5, "d": 1.0, "f": 5.0, "g": 1.0, "k": 300.0, "m": 1.0}
STEP = 2e-3        # of a parameter's size; differences of fourth order are off by 1e-9 of what they differ by
TOLERANCE = 1e-6   # of the greatest slope of a mode
MODES = 4


def tree(seed, rests, n=4):
    """Bodies on bodies: two on revolute joints, one on another kind, one fixed to another with a lever between."""
    rng = random.Random(seed)
    some = lambda size=1.0: [round(rng.uniform(-size, size), 3) for _ in range(3)]
    place = lambda aside="": (lambda p: [f"{p[0]}*L", f"{p[1]}*W{aside}", f"{p[2]}*W + {round(rng.uniform(-1, 1), 3)}*b"])(some())
    model = {"format": "modetune-model/1", "name": "tree", "dimension": 3, "parameters": PARAMETERS, "gravity_m_per_s2": ["1.5*g", "-2*g", "-9*g"],
             "bodies": [], "joints": [], "springs": [], "loads": [], "configurations": {"c": {}}}
    for i, kind in enumerate(("revolute", "revolute", rng.choice(("universal", "cylindrical", "spherical")), "fixed")[:n]):
        name, on, at = f"b{i}", "ground" if i == 0 else f"b{rng.randrange(i)}", place()
        model["bodies"].append({"name": name, "mass_kg": f"{rng.uniform(0.5, 2):.3f}*m", "inertia_kg_m2": [0.3, 0.4, 0.5, 0.03, -0.02, 0.01], "centre": place(" + a")})
        joint = {"name": f"j{i}", "type": kind, "bodies": [on, name], "at": at}
        axis = some()
        if kind not in ("fixed", "spherical"):
            joint["axis"] = axis
        if kind == "universal":  # at a right angle
            joint["axis_b"] = [round(axis[1], 3), round(-axis[0], 3), 0]
        model["joints"].append(joint)
        if kind == "revolute":
            model["springs"].append({"name": f"t{i}", "type": "torsion", "joint": f"j{i}", "stiffness_n_m_per_rad": f"{rng.uniform(1, 4):.3f}*k"})
        elif kind != "fixed":
            model["springs"].append({"name": f"u{i}", "type": "bushing", "bodies": [on, name], "at": at,
                                     "stiffness_n_per_m": [f"{rng.uniform(1, 9):.3f}*k" for _ in range(3)],
                                     "stiffness_n_m_per_rad": [f"{rng.uniform(1, 4):.3f}*k" for _ in range(3)]})
        force, at = some(3.0), place()
        model["loads"].append({"name": f"f{i}", "on": name, "at": at, "force_n": [f"{x}*f" for x in force]})
        if rests:  # against it, a lever of length d away along the force: pulled apart or pressed together
            model["loads"].append({"name": f"r{i}", "on": name, "at": [f"{p} - {x}*d" for p, x in zip(at, force)], "force_n": [f"{-x}*f" for x in force]})
    if rests:
        del model["gravity_m_per_s2"]
    return model


class LoadedSlopes(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = Path(self.folder.name) / "tree.json"

    def tearDown(self):
        self.folder.cleanup()

    def run_it(self, *arguments):
        done = subprocess.run([PROGRAM, arguments[0], str(self.path), *arguments[1:], "--quiet"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, (arguments, done.stderr))
        return done.stdout

    def frequencies(self, **moved):
        changes = [part for name, value in moved.items() for part in ("--set", f"{name}={value!r}")]
        found = json.loads(self.run_it("modes", *changes, "--format", "json"))
        return [mode["frequency_hz"] for mode in found[0]["modes"]][:MODES]

    def slopes(self):
        """By parameter and mode in Hz per unit."""
        found = json.loads(self.run_it("sensitivity", "--parameters", ",".join(PARAMETERS), "--format", "json"))[0]
        return {p: [next(s["hz_per_unit"] for s in m["sensitivities"] if s["parameter"] == p) for m in found["modes"]][:MODES] for p in PARAMETERS}

    def check(self, seed, unused):
        got, want = self.slopes(), {}
        for name, value in PARAMETERS.items():
            h = STEP * (abs(value) or 1.0)
            at = {n: self.frequencies(**{name: value + n * h}) for n in (-2, -1, 1, 2) if name not in unused}
            want[name] = [(8 * (b - a) - (d - c)) / (12 * h) for a, b, c, d in zip(at[-1], at[1], at[-2], at[2])] if at else [0.0] * MODES
        for mode in range(MODES):
            most = max(abs(want[p][mode]) * (abs(PARAMETERS[p]) or 1.0) for p in PARAMETERS)
            for p, value in PARAMETERS.items():
                self.assertLessEqual(abs(got[p][mode] - want[p][mode]), TOLERANCE * most / (abs(value) or 1.0), (seed, p, mode + 1, got[p], want[p]))
        for p in PARAMETERS:  # or the test says nothing of it
            self.assertTrue(p in unused or max(map(abs, want[p])) > 1e-5, (seed, p))

    def test_of_what_settles(self):
        self.path.write_text(json.dumps(tree(1, False)))
        self.check(1, ["d"])

    def test_of_what_rests_as_drawn(self):
        self.path.write_text(json.dumps(tree(5, True)))
        self.check(5, ["g"])


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""
All ways to modes tell the same: the lowest modes of a model (`modes --count`: of a tree, by a sparse factor) against all of them
(`modes`, dense). Random plane models: chains, stars and rings of bodies in one or several parts, held or free, with springs some of
which are negative, knots without mass, redundant joints, under gravity or not. Kinds, indices, frequencies, and the counts of rigid-body
and unstable modes must agree; directions without mass are counted by the dense way alone. MT_EVERY=1: many more.
"""
import json
import math
import os
import random
import subprocess
import sys
import tempfile
import unittest
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from suite import EVERY  # noqa: E402
import large  # noqa: E402

PROGRAM = os.environ["MODETUNE"]
CASES = 24 if EVERY else 12
COUNT = 6
LEAST = 100  # bodies, from where the lowest modes have a way of their own
COUNTS = ("rigid_body_modes", "unstable_modes", "undecided_modes", "freedoms")


def part(rng, model, origin, size, held, negative, shapes=("chain", "chain", "star", "ring")):
    """One part of a model: a chain, a star or a ring of bodies along x from origin."""
    shape = rng.choice(shapes)
    names = []
    for i in range(size):
        name = f"b{len(model['bodies'])}"
        names.append(name)
        at = [origin + i + 0.5, 0.3 * (i % 2) if shape == "ring" else 0]
        body = {"name": name, "centre": at}
        if i % 7 != 3 or rng.random() < 0.8 or shape != "chain":
            body.update(mass_kg=round(rng.uniform(0.5, 2), 3), inertia_kg_m2=round(rng.uniform(0.05, 0.2), 4))
        else:
            body.update(mass_kg=round(rng.uniform(0.5, 2), 3), inertia_kg_m2=0.1)
        model["bodies"].append(body)

    def join(a, b, at, k):
        joint = f"j{len(model['joints'])}"
        model["joints"].append({"name": joint, "type": "revolute", "bodies": [a, b], "at": at})
        model["springs"].append({"name": f"s{len(model['springs'])}", "type": "torsion", "joint": joint, "stiffness_n_m_per_rad": k})

    def stiffness(i):
        return round(-10 ** rng.uniform(-3, 0), 5) if i in negative else round(10 ** rng.uniform(1, 3), 3)

    if held:
        join("ground", names[0], [origin, 0], stiffness(-1))
    for i in range(1, size):
        if shape == "star":
            join(names[0], names[i], [origin + 0.5 + 0.3 * i, 0], stiffness(i))
        else:
            join(names[i - 1], names[i], [origin + i, 0.15], stiffness(i))
    if shape == "ring" and size > 3:
        model["springs"].append({"name": f"s{len(model['springs'])}", "type": "axial", "bodies": [names[0], names[-1]],
                                 "at": [[origin + 0.5, 1], [origin + size - 0.5, 1.5]], "stiffness_n_per_m": 20})
    return names


def settling_model(rng):
    """A cantilever, drawn straight or with a bend, in the plane or a frame in space, that its weight brings elsewhere: little or far."""
    if rng.random() < 0.3:
        model = large.frame(3, 3, 3, 2)
        model["gravity_m_per_s2"] = [round(rng.uniform(-5, 5), 3) for _ in range(2)] + [-9.81]
        return model
    n = rng.randint(LEAST + 1, LEAST + 30)
    model = rng.choice([large.link, large.beam, large.chain])(n)
    size = 10 ** rng.uniform(-2, 0.8)
    model["gravity_m_per_s2"] = [round(rng.uniform(-0.3, 1) * size, 4), round(-size, 4)]
    tip = f"b{n - 1}" if "links" not in model else "beam.end"
    model["springs"] = [*model.get("springs", []), {"name": "stay", "type": "axial", "bodies": ["ground", tip],
                                                    "at": [[1.3, 0.4], [1, 0]], "stiffness_n_per_m": round(rng.uniform(0.1, 5), 3)}]
    return model


def random_model(rng):
    model = {"format": "modetune-model/1", "dimension": 2, "bodies": [], "joints": [], "springs": [], "configurations": {"c": {}}}
    if rng.random() < 0.25:  # a tree that is held, which has a way of its own
        part(rng, model, 0, rng.randint(LEAST, LEAST + 40), True, set(), ("chain", "star"))
        if rng.random() < 0.5:
            model["gravity_m_per_s2"] = [9.81, 0]
        return model
    n_parts = rng.choice([1, 1, 2, 3])
    origin = 0
    for _ in range(n_parts):
        size = rng.randint(LEAST // n_parts + 1, LEAST // n_parts + 15)
        negative = set(rng.sample(range(1, size), rng.choice([0, 0, 1, 2]))) if size > 4 else set()
        part(rng, model, origin, size, rng.random() < 0.5, negative)
        origin += size + 2
    if rng.random() < 0.25:
        model["gravity_m_per_s2"] = [9.81, 0]
    if rng.random() < 0.3:  # a knot without mass between two springs on a rail, that may push
        model["bodies"] += [{"name": "knot", "centre": [-3, 0]}, {"name": "block", "mass_kg": 2, "centre": [-2, 0]}]
        for name, x in (("knot", -3), ("block", -2)):
            model["joints"].append({"name": f"rail_{name}", "type": "pin-in-slot", "bodies": ["ground", name], "at": [x, 0], "axis": [1, 0]})
        model["springs"] += [
            {"name": "to_ground", "type": "axial", "bodies": ["ground", "knot"], "at": [[-4, 0], [-3, 0]],
             "stiffness_n_per_m": rng.choice([1500, -1500])},
            {"name": "to_block", "type": "axial", "bodies": ["knot", "block"], "stiffness_n_per_m": 700}]
    return model


class Ways(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = Path(holder.name)

    def modes(self, model, *more):
        path = self.folder / "m.json"
        path.write_text(json.dumps(model), encoding="utf-8")
        done = subprocess.run([PROGRAM, "modes", path, "--format", "json", "--quiet", *more], capture_output=True, text=True, timeout=300)
        return (json.loads(done.stdout)[0] if done.returncode == 0 else None), done.returncode, done.stderr

    def compare(self, model):
        """How the lowest were found; what the two ways tell otherwise."""
        whole, code, said = self.modes(model, "--count", "all")
        few, other, _ = self.modes(model, "--count", str(COUNT))
        if whole is None or few is None:
            self.assertEqual((code, whole is None), (other, few is None), said)
            return "refused"
        for name in COUNTS:
            self.assertEqual(few[name], whole[name], name)
        self.assertIn(few["massless_directions"], (None, whole["massless_directions"]))
        kinds = [[m["kind"] for m in answer["modes"]] for answer in (whole, few)]
        self.assertEqual(Counter(kinds[0][:len(kinds[1])]), Counter(kinds[1]))
        self.assertEqual(kinds[1].count("unstable"), min(whole["unstable_modes"], kinds[0].count("unstable")))
        flexible = [[m for m in answer["modes"] if m["kind"] == "flexible"] for answer in (whole, few)]
        for a, b in zip(*flexible):
            self.assertEqual(a.get("mode"), b.get("mode"))
            self.assertLessEqual(abs(b["frequency_hz"] / a["frequency_hz"] - 1), 1e-7)
        return few["method"]

    def test_the_lowest_modes_are_those_of_all(self):
        ways = Counter()
        for index in range(CASES):
            with self.subTest(seed=f"ways.{index}"):
                ways[self.compare(random_model(random.Random(f"ways.{index}")))] += 1
        print(dict(ways), file=sys.stderr)
        self.assertGreaterEqual({"tree", "sparse"} & set(ways), {"tree", "sparse"}, ways)

    def test_what_settles_elsewhere_has_the_modes_of_where_it_settles(self):
        found = Counter()
        for index in range(8 if EVERY else 2):
            with self.subTest(seed=f"sags.{index}"):
                model = settling_model(random.Random(f"sags.{index}"))
                whole, code, said = self.modes(model, "--count", "all", "--shapes")
                few, _, _ = self.modes(model, "--count", str(COUNT), "--shapes")
                self.assertEqual(code, 0, said)
                found[few["method"]] += 1
                self.assertEqual(few["rigid_body_modes"] + few["unstable_modes"], 0)
                for a, b in zip(whole["modes"], few["modes"]):
                    off = abs(a["omega_squared"] - b["omega_squared"])
                    self.assertLessEqual(off, a["omega_squared_error"] + b["omega_squared_error"])
                    self.assertLessEqual(b["omega_squared_error"], 1e-7 * b["omega_squared"])
                    most = max(map(abs, a["shape"].values()))
                    sign = math.copysign(1, sum(value * b["shape"][name] for name, value in a["shape"].items()))  # of two equal entries either leads
                    for name, value in a["shape"].items():
                        self.assertLessEqual(abs(sign * b["shape"][name] - value), 1e-6 * most, name)
                for name in ("largest_motion_m", "largest_turn_rad"):
                    self.assertLessEqual(abs(whole["equilibrium"][name] - few["equilibrium"][name]), 1e-9)
        self.assertGreaterEqual(found["sparse"], found.total() - 1, found)

    def test_a_direction_without_mass_is_unstable_once(self):
        """A knot of -1500 + 700 N/m: one unstable direction; the block beside it sees k1 k2/(k1 + k2)."""
        rng = random.Random(0)
        while True:
            model = random_model(rng)
            if model["bodies"][-1]["name"] == "block" and model["springs"][-2]["stiffness_n_per_m"] < 0:
                break
        names = {"knot", "block"}
        model["bodies"] = [b for b in model["bodies"] if b["name"] in names]
        model["joints"] = [j for j in model["joints"] if j["name"].startswith("rail")]
        model["springs"] = model["springs"][-2:]
        model.pop("gravity_m_per_s2", None)
        answer, code, said = self.modes(model, "--count", "all")
        self.assertEqual(code, 0, said)
        self.assertEqual(answer["unstable_modes"], 1)


if __name__ == "__main__":
    unittest.main()

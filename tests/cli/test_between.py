#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Limits of every kind of goal between the positions of a drive, against closed forms.

An arm turns about the origin, locked at theta. A mass m slides along it on a spring k0, at r from the origin, and a short spring k
of free length l is tied to a point of the ground next to its way. With d from that point to the mass and u along the arm
    k0 (r - 1) + k (1 - l/|d|) d.u = 0,     K(theta) = k0 + k (1 - l/|d| + l (d.u)^2 / |d|^3),
    omega^2 = K/m,   zeta = c / (2 sqrt(K m)),   |H(theta)| = cos(theta)^2 / |K - m w^2 + i w c|,
and where the ground shakes along x, the acceleration of the mass along x per that of the ground
    |H_b(theta)|^2 = ((K - m w^2 (1 - x))^2 + (w c)^2) / ((K - m w^2)^2 + (w c)^2),   x = cos(theta)^2:
all of them come and go within an angle of about l. A second mass on the arm has a mode of its own, which the first one's crosses.
Every claim of every design is held against a grid that resolves the spring, and so is that no design nearer to the original keeps the limit. MT_EVERY=1: ten times as many arms; MT_COUNT and MT_SEED: others.
"""
import json
import math
import random
import re
import tempfile
import unittest
from pathlib import Path

import numpy as np
from common_cli import main
from suite import SEED, count
from test_motion import TWO_PI, run

SEED = int(SEED)
COUNT = count(5, every=60)
M, M2 = 1.0, 0.5


def arm(a):
    """a: k0, k, c, length, place [3] of the spring's end, positions; k2 and c2 of the second mass, or None."""
    bodies = [{"name": "arm", "mass_kg": 1, "inertia_kg_m2": [0.1, 0.1, 0.1], "centre": [0.5, 0, 0]}]
    joints = [{"name": "p", "type": "revolute", "bodies": ["ground", "arm"], "at": [0, 0, 0], "axis": [0, 0, 1]}]
    springs, dampers, sensors = [], [], []
    for name, mass, k, c in (("x", "m", "k0", "c"), ("y", M2, "k2", "c2"))[:2 if a["k2"] else 1]:
        bodies.append({"name": name, "mass_kg": mass, "centre": [1, 0, 0], "inertia_kg_m2": [0.001, 0.001, 0.001]})
        joints.append({"name": "s" + name, "type": "prismatic", "bodies": ["arm", name], "at": [1, 0, 0], "axis": [1, 0, 0]})
        springs.append({"name": k, "type": "axial", "joint": "s" + name, "stiffness_n_per_m": k})
        dampers.append({"name": c, "type": "axial", "joint": "s" + name, "damping_n_s_per_m": c})
        sensors.append({"name": "o" if name == "x" else "y", "on": name})
    springs.append({"name": "k", "type": "axial", "bodies": ["ground", "x"], "at": [a["place"], [1, 0, 0]], "stiffness_n_per_m": "k", "free_length_m": a["length"]})
    return {"format": "modetune-model/1", "dimension": 3,
            "parameters": {"k0": a["k0"], "k": a["k"], "m": M, "c": a["c"]} | ({"k2": a["k2"], "c2": a["c2"]} if a["k2"] else {}),
            "bodies": bodies, "joints": joints, "springs": springs, "dampers": dampers, "sensors": sensors,
            "configurations": {f"c{i}": {"drive": {"joint": "p", "position_rad": t}} for i, t in enumerate(a["positions"])}}


def stiffness(a, theta):
    """K at rest, of an array of angles, by Newton's method from the drawing in short steps."""
    u = np.array([np.cos(theta), np.sin(theta), 0 * theta])
    r, end, l = np.ones_like(theta), np.array(a["place"])[:, None], a["length"]
    for _ in range(300):
        d = r * u - end
        far, along = np.sqrt((d * d).sum(0)), (d * u).sum(0)
        k = a["k0"] + a["k"] * (1 - l / far + l * along ** 2 / far ** 3)
        step = np.clip((a["k0"] * (r - 1) + a["k"] * (1 - l / far) * along) / np.where(k > 0.05 * a["k0"], k, a["k0"] + a["k"]), -0.02, 0.02)
        r = r - step
        if np.abs(step).max() < 1e-14:
            break
    return k


def numbers(a, goal, theta):
    k, x = stiffness(a, theta), np.cos(theta) ** 2
    if goal["type"] == "vibration":
        low, high, tone_low, tone_high = a["shaken"]
        random_part = rms(k, x, a["c"], low, high, 0.5) if goal["quantity"] != "sine" else 0
        tones = 2 * tone(k, x, a["c"], tone_low, tone_high) if goal["quantity"] != "rms" else 0
        return (3 if goal["quantity"] == "peak" else 1) * random_part + tones
    one = np.array([np.sqrt(k / M) / TWO_PI, a["c"] / (2 * np.sqrt(k * M))])
    if goal["type"] != "response":
        two = [math.sqrt(a["k2"] / M2) / TWO_PI, a["c2"] / (2 * math.sqrt(a["k2"] * M2))] if a["k2"] else [math.inf, math.inf]
        first = (one[0] < two[0]) == (goal["mode"] == 1)
        which = 0 if goal["type"] == "frequency" else 1
        return np.where(first, one[which], two[which])
    low, high = goal.get("band_hz", [goal.get("at_hz")] * 2)
    w2 = np.clip((k - a["c"] ** 2 / (2 * M)) / M, (TWO_PI * low) ** 2, (TWO_PI * high) ** 2)
    return x / np.abs(k - M * w2 + 1j * np.sqrt(w2) * a["c"])


def tone(k, x, c, low, high):
    """The largest |H_b| from low to high Hz: with y = w^2 a ratio of quadratics N/D, stationary where N'D = ND', a quadratic."""
    a1, b1 = M * M * (1 - x) ** 2, c * c - 2 * k * M * (1 - x)
    a2, b2 = M * M, c * c - 2 * k * M
    p, q, r = a1 * b2 - b1 * a2, (a1 - a2) * k * k, (b1 - b2) * k * k
    root = np.sqrt(np.maximum(q * q - p * r, 0))
    best = 0
    for y in ((TWO_PI * low) ** 2 + 0 * k, (TWO_PI * high) ** 2 + 0 * k, (-q + root) / p, (-q - root) / p):
        y = np.clip(y, (TWO_PI * low) ** 2, (TWO_PI * high) ** 2)
        best = np.maximum(best, (a1 * y * y + b1 * y + k * k) / (a2 * y * y + b2 * y + k * k))
    return np.sqrt(best)


def rms(k, x, c, low, high, density):
    """Of the acceleration under a flat density: with f = f0 (1 + zeta tan u) a resonance is smooth in u, and Simpson's rule enough."""
    f0, zeta = np.sqrt(k / M) / TWO_PI, c / (2 * np.sqrt(k * M))
    ends = [np.arctan((f / f0 - 1) / zeta) for f in (low, high)]
    n = 200
    total = 0
    for i in range(n + 1):
        u = ends[0] + (ends[1] - ends[0]) * i / n
        y = (TWO_PI * f0 * (1 + zeta * np.tan(u))) ** 2
        h2 = ((k - M * y * (1 - x)) ** 2 + y * c * c) / ((k - M * y) ** 2 + y * c * c)
        weight = 1 if i in (0, n) else 4 if i % 2 else 2
        total = total + weight * h2 * f0 * zeta / np.cos(u) ** 2
    return np.sqrt(density * total * (ends[1] - ends[0]) / (3 * n))


def limits(goal):
    """Its limit, and whether that is an upper one."""
    return next((goal[name], "most" in name) for name in goal if name.startswith("at_most") or name.startswith("at_least"))


def worst(a, goal):
    """The number that is furthest on the wrong side, on a grid around the spring's end and everywhere."""
    near = math.atan2(a["place"][1], a["place"][0]) + np.linspace(-20, 20, 8001) * a["length"]
    t = np.sort(np.concatenate([np.linspace(a["positions"][0], a["positions"][-1], 4001), near]))
    t = t[(t >= a["positions"][0]) & (t <= a["positions"][-1])]
    for _ in range(4):
        q = numbers(a, goal, t) * (1 if limits(goal)[1] else -1)
        i = int(np.argmax(q))
        t = np.linspace(t[max(i - 1, 0)], t[min(i + 1, len(t) - 1)], 201)
    return abs(q[i])


def draw(seed):
    """A random arm, and a limit next to what it has at its positions."""
    r = random.Random(seed)
    h, phi, rho = 10 ** r.uniform(-3.3, -1), r.uniform(-0.45, 0.45), r.uniform(0.97, 1.03)
    a = {"k0": 4000 * 10 ** r.uniform(-0.1, 0.5), "k": 4000 * 10 ** r.uniform(-0.7, 0.1), "c": 2 * 10 ** r.uniform(0, 1.2), "length": h * r.uniform(0.6, 1.5),
         "place": [rho * math.cos(phi), rho * math.sin(phi), h], "positions": [-0.5] + sorted(r.uniform(-0.45, 0.45) for _ in range(r.randrange(3))) + [0.5],
         "k2": None, "c2": r.uniform(1, 20)}
    named = np.array(a["positions"])
    hz = numbers(a, {"type": "frequency", "mode": 1}, named).mean()
    kind, upper = r.choice([("frequency", True), ("frequency", False), ("damping", True), ("damping", False), ("at", True), ("band", True), ("vibration", True)])
    tone_hz = hz * r.uniform(0.75, 1.25)
    a["shaken"] = [hz * r.uniform(0.3, 0.9), hz * r.uniform(1.05, 3), tone_hz, tone_hz * r.choice([1, 1.03, 1.15])]
    if kind == "vibration":
        goal = {"type": "vibration", "profile": "profile.json", "output": "o.x:acceleration", "quantity": r.choice(["rms", "sine", "peak"])}
    elif kind in ("frequency", "damping"):
        a["k2"] = M2 * (TWO_PI * hz * r.uniform(0.8, 1.3)) ** 2 if r.random() < 0.5 else None
        goal = {"type": kind, "mode": r.choice([1, 2]) if a["k2"] else 1}
    else:
        goal = {"type": "response", "input": "o.x", "output": "o.x"}
        goal |= {"at_hz": hz * r.uniform(0.75, 1.25)} if kind == "at" else {"band_hz": [hz * r.uniform(0.5, 0.9), hz * r.uniform(0.95, 1.3)]}
    q = numbers(a, goal, named)
    limit = float(q.max() if upper else q.min()) * r.uniform(0.9, 1.1)
    goal[("at_most" if upper else "at_least") + ("_hz" if kind == "frequency" else "")] = limit
    goal["configurations"] = [f"c{i}" for i in range(len(named))]
    name, far = ("k0", 4) if kind == "frequency" else ("c", 20)
    return a, goal, [{"parameter": name, "lower": a[name] / far, "upper": a[name] * far}]


class Between(unittest.TestCase):
    def answer(self, a, goal, variables, **more):
        study = more | {"format": "modetune-study/1", "model": "model.json", "variables": variables, "goals": goal if isinstance(goal, list) else [goal], "search": {"starts": 3}}
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "model.json").write_text(json.dumps(a if "bodies" in a else arm(a)))
            (Path(folder) / "study.json").write_text(json.dumps(study))
            low, high, tone_low, tone_high = a.get("shaken", [1, 2, 1, 2])
            (Path(folder) / "profile.json").write_text(json.dumps({
                "format": "modetune-profile/1", "axis": "x", "random": {"psd_m2_per_s3": [[low, 0.5], [high, 0.5]], "origin": "assumed"},
                "tones": [{"frequency_hz": [tone_low, tone_high], "acceleration_m_per_s2": 2, "origin": "assumed"}]}))
            done = run("run", "study.json", "-o", "out", "--quiet", cwd=folder)
            self.assertIn(done.returncode, (0, 1), done.stderr)
            self.assertTrue((Path(folder) / "out/study/result.json").exists(), done.stderr)
            self.assertNotIn("holds over the range", done.stdout)
            return json.loads((Path(folder) / "out/study/result.json").read_text())

    def judge(self, a, goal, design):
        """The claims of one design."""
        own = a | {p["name"]: p["recommended"] for p in design["parameters"]}
        if not np.all(stiffness(own, np.linspace(-0.5, 0.5, 2001)) > 0):
            return
        row, true = design["responses_between"][0], worst(own, goal)
        limit, upper = limits(goal)
        self.assertEqual(row["grade"], "sampled")
        self.assertAlmostEqual(row["value"] / true, 1, delta=1e-4)
        missed = true / limit - 1 if upper else 1 - true / limit
        if abs(missed) > 1e-4:
            self.assertEqual(row["holds"], missed < 0, row["text"])
            self.assertAlmostEqual(row["violation_percent"], 100 * max(missed, 0), delta=0.02)
        if row["holds"]:
            self.assertIn("all of them keep the limit (sampled, not proven)", row["text"])

    def judge_optimum(self, a, goal, design):
        """Of one variable the least change that keeps the limit everywhere: all that is nearer to the original misses it somewhere."""
        parameter = design["parameters"][0]
        change = math.log(parameter["recommended"] / parameter["original"])
        limit, upper = limits(goal)
        if not design["responses_between"][0]["holds"] or abs(change) < 1e-3:
            return
        for part in (0.01, 0.1, 0.4, 0.7, 1):
            for side in (1, -1):
                own = a | {parameter["name"]: parameter["original"] * math.exp(side * (1 - part) * change)}
                if np.all(stiffness(own, np.linspace(-0.5, 0.5, 2001)) > 0):
                    missed = worst(own, goal) / limit - 1 if upper else 1 - worst(own, goal) / limit
                    self.assertGreater(missed, -1e-6, (part, side))

    def test_random_arms(self):
        kept = 0
        for seed in range(SEED, SEED + COUNT):
            a, goal, variables = draw(seed)
            with self.subTest(seed=seed, goal=goal):
                result = self.answer(a, goal, variables)
                for design in [result["baseline"], *result["recommendations"]]:
                    self.judge(a, goal, design)
                self.judge_optimum(a, goal, result["recommendations"][0])
                kept += sum(d["responses_between"][0]["holds"] for d in result["recommendations"])
        self.assertGreater(kept, COUNT // 3)

    def test_a_dip_of_a_frequency_is_kept(self):
        """A lower limit that the three positions keep and 7 Hz between them do not: k0 for the dip, in closed form."""
        a = {"k0": 4000, "k": 4000, "c": 2, "length": 0.075, "k2": None, "place": [0.9720467106440411, 0.23478754721258074, 0.05], "positions": [-0.5, 0, 0.5]}
        goal = {"type": "frequency", "configurations": ["c0", "c1", "c2"], "mode": 1, "at_least_hz": 12.5}
        result = self.answer(a, goal, [{"parameter": "k0", "lower": 2000, "upper": 12000}])
        before, after = result["baseline"]["responses_between"][0], result["recommendations"][0]
        self.assertAlmostEqual(before["value"], 7.117, delta=1e-2)
        self.assertFalse(before["holds"])
        self.assertAlmostEqual(worst(a | {"k0": after["parameters"][0]["recommended"]}, goal) / 12.5, 1, delta=2e-6)
        self.assertIn("the frequency of mode 1 over p from -0.5 to 0.5 rad", after["responses_between"][0]["text"])
        self.assertEqual(after["grade"], "feasible")
        one = {"type": "frequency", "mode": 1, "at_least_hz": 12.5}
        apart = self.answer(a, [one | {"configuration": c} for c in goal["configurations"]], [{"parameter": "k0", "lower": 2000, "upper": 12000}])
        rows = apart["recommendations"][0]["responses_between"]
        self.assertEqual([(r["goal"], r["value"]) for r in rows], [("/goals/0", after["responses_between"][0]["value"])])

    def test_a_dip_of_an_instant(self):
        """The spring's end is 0.01 mm from the way: the mode falls, and is back again within a thousandth of a degree."""
        asked = {"configurations": ["c0", "c1", "c2"]}
        for place in (0.2371, -0.131):
            a = {"k0": 4000, "k": 4000, "c": 2, "length": 15e-6, "k2": None, "place": [math.cos(place), math.sin(place), 1e-5], "positions": [-0.5, 0, 0.5]}
            limit = {"type": "frequency", "mode": 1, "at_least_hz": 12.5}
            true = worst(a, limit)
            self.assertLess(true, 9)
            only = [{"parameter": "k0", "catalogue": [4000, 4001]}]
            row = self.answer(a, limit | asked, only)["baseline"]["responses_between"][0]
            self.assertAlmostEqual(row["value"] / true, 1, delta=1e-4)
            self.assertFalse(row["holds"])
            row = self.answer(a, {"type": "avoid", "bands_hz": [[0.01, 12.5]]} | asked, only)["baseline"]["motion"][0]
            self.assertAlmostEqual(row["hz"] / true, 1, delta=1e-5)
            self.assertTrue(row["crosses"])

    def test_a_shape_that_another_mode_has_between(self):
        """The first mode moves x at the three positions; in the dip of the second mass's frequency it moves y: MAC 1 and 0."""
        a = {"k0": 3000, "k": 3000, "c": 2, "length": 0.02, "place": [math.cos(0.21), math.sin(0.21), 0.014], "positions": [-0.5, 0, 0.5], "c2": 2}
        deep = stiffness(a, np.array([0.21]))[0]
        a["k2"] = M2 * 0.5 * (deep + 6000) / M  # between the depth of the dip and what is beside it
        goal = {"type": "mac", "mode": 2, "reference": "r", "reference_mode": 1, "at_least": 0.9, "configurations": ["c0", "c1", "c2"]}
        reference = {"r": {"modes": [{"frequency_hz": 1, "shape": {"o.x": 1, "y.x": 0}}]}}
        row = self.answer(a, goal, [{"parameter": "c", "catalogue": [2, 3]}], references=reference)["baseline"]["responses_between"][0]
        self.assertAlmostEqual(row["value"], 0, delta=1e-12)
        self.assertFalse(row["holds"])
        self.assertAlmostEqual(row["violation_percent"], 90, delta=1e-9)
        self.assertLess(abs(row["at"] - 0.21), 0.02)
        self.assertIn("the MAC of mode 2 over p from -0.5 to 0.5 rad", row["text"])

    def test_a_resonance_that_comes_and_goes_is_kept(self):
        a = {"k0": 4000, "k": 4000, "c": 18.73917217596472, "length": 0.013462997587195397, "k2": None,
             "place": [0.9992078337400331, 0.03979579114115576, 0.008975331724796932], "positions": [-0.5, 0, 0.5]}
        goal = {"type": "response", "configurations": ["c0", "c1", "c2"], "input": "o.x", "output": "o.x", "at_most": 0.0004613, "at_hz": 12.209}
        variables = [{"parameter": "c", "lower": 9, "upper": 562}]
        design = self.answer(a, goal, variables)["recommendations"][0]
        c = design["parameters"][0]["recommended"]
        self.assertAlmostEqual(worst(a | {"c": c}, goal) / 0.0004613, 1, delta=2e-6)
        self.assertAlmostEqual(c, 28.25, delta=5e-3)
        told = [re.search(r"Relaxing the limit of goal /goals/0 where p is at 0\.01[56]\d* rad, between the positions, "
                          r"by 1 % would reduce the total change by ([0-9.]+) %", r["text"]) for r in design["reasons"] if r["kind"] == "cost"]
        self.assertEqual(len(told), 1)
        less = self.answer(a, goal | {"at_most": 0.0004613 * 1.01}, variables)["recommendations"][0]["change"]
        self.assertAlmostEqual(float(told[0][1]) / 100 * design["change"] / (design["change"] - less), 1, delta=0.02)

    def test_postures_between_which_nothing_is_followed_are_named(self):
        """Two hinged arms, one with a mass on a spring: positions of one hinge are followed, other ways between postures are not."""
        model = arm({"k0": 4000, "k": 1, "c": 2, "length": 1, "k2": None, "place": [2, 1, 0], "positions": [0]})
        model["bodies"].append({"name": "fore", "mass_kg": 1, "inertia_kg_m2": [0.1, 0.1, 0.1], "centre": [0, 1, 0]})
        model["joints"].append({"name": "q", "type": "revolute", "bodies": ["ground", "fore"], "at": [0, 0, 0], "axis": [0, 0, 1]})
        postures = {"a": (0, 0), "b": (0.3, 0), "c": (0, 0.3), "d": (0.3, 0.3)}
        model["configurations"] = {name: {"drive": [{"joint": "p", "position_rad": p}, {"joint": "q", "position_rad": q}]} for name, (p, q) in postures.items()}
        first, clear = {"type": "frequency", "mode": 1, "at_least_hz": 1}, {"type": "avoid", "bands_hz": [[1, 2]]}
        for goal, named, apart in ((first, "ab", None), (first, "ac", None), (first, "ad", "ad"), (first, "acb", "ab"), (clear, "ac", None), (clear, "abc", "ac")):
            with self.subTest(goal=goal["type"], named=named):
                said = self.answer(model, goal | {"configurations": list(named)}, [{"parameter": "k0", "catalogue": [4000, 4001]}])["warnings"]
                told = [re.match(r'nothing is looked at between "(.)" and "(.)": ', text) for text in said]
                self.assertEqual(["".join(m.groups()) for m in told if m], [apart] if apart else [])


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Nothing depends on the units of length, mass and time: mechanisms with loops to close, loaded and driven ones, in two systems of units.

A mechanism is made once of numbers with dimensions; a change of units multiplies each by a power of three random factors (no
powers of ten). Frequencies must then be multiplied by one over that of time, and relative sensitivities stay, to rounding.
"""
import json
import math
import random
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "cli"))
from common_cli import CliTest  # noqa: E402
from suite import SEED, count  # noqa: E402

COUNT = count(20, every=60, instrumented=60)


class Units:
    def __init__(self, length=1.0, mass=1.0, time=1.0):
        self.length, self.mass, self.time = length, mass, time

    def __call__(self, x, length=0, mass=0, time=0):
        return x * self.length**length * self.mass**mass * self.time**time

    def place(self, p):
        return [self(x, length=1) for x in p]

    def inertia(self, x):
        return self(x, length=2, mass=1)

    def stiffness(self, x):
        return self(x, mass=1, time=-2)

    def torsion(self, x):
        return self(x, length=2, mass=1, time=-2)

    def gravity(self, g):
        return [self(x, length=1, time=-2) for x in g]


def polygon(rng, n, dimension):
    """Corners of a closed chain between two fixed ones, in general position."""
    corners = []
    for i in range(n):
        angle = 2 * math.pi * (i + rng.uniform(-0.3, 0.3)) / n
        radius = rng.uniform(0.7, 1.6)
        z = [rng.uniform(-0.5, 0.5)] if dimension == 3 else []
        corners.append([radius * math.cos(angle), radius * math.sin(angle)] + z)
    return corners


def mechanism(rng):
    """Numbers of one random mechanism, without units: a function from units to the model."""
    dimension = rng.choice([2, 2, 3])
    bars = rng.randint(3, 5)
    corners = polygon(rng, bars + 1, dimension)
    gap = [rng.uniform(-0.12, 0.12) for _ in range(dimension)]
    open_at = rng.randint(1, bars - 1)
    masses = [rng.uniform(0.3, 3) for _ in range(bars)]
    spins = [rng.uniform(0.02, 0.2) for _ in range(bars)]
    k = [10 ** rng.uniform(0, 3) for _ in range(bars + 2)]
    preload = rng.uniform(-0.5, 0.5)
    gravity = rng.random() < 0.4
    driven = rng.choice([None, None, "lock", "spring"]) if dimension == 2 else None
    angle = rng.uniform(-0.25, 0.25)
    far = [rng.uniform(-3, 3) for _ in range(dimension)]

    def make(u):
        model = {"format": "modetune-model/1", "dimension": dimension, "bodies": [], "joints": [], "springs": [],
                 "parameters": {"k0": u.torsion(k[0]) if dimension == 2 else u.stiffness(k[0]), "m0": u(masses[0], mass=1),
                                "x1": u(corners[1][0], length=1)}, "configurations": {"c": {}}}
        if gravity:
            model["gravity_m_per_s2"] = u.gravity([0.3, -1.0] + [0.5] * (dimension - 2))
        place = [u.place(c) for c in corners]
        place[1] = ["x1"] + place[1][1:]
        for i in range(bars):
            # a body's centre stands at a third of its bar, its joints at the ends
            centre = [f"({a!r})*2/3+({b!r})/3" if isinstance(a, float) and isinstance(b, float) else f"({a})*2/3+({b})/3"
                      for a, b in zip(place[i], place[i + 1])]
            spin = u.inertia(spins[i])
            model["bodies"].append({"name": f"b{i}", "mass_kg": "m0" if i == 0 else u(masses[i], mass=1), "centre": centre,
                                    "inertia_kg_m2": spin if dimension == 2 else [spin, 1.3 * spin, 1.7 * spin]})
        for i in range(bars + 1):
            ends = ["ground" if i == 0 else f"b{i - 1}", "ground" if i == bars else f"b{i}"]
            at = place[i]
            if i == open_at:  # drawn apart: the loop has to be closed
                at = [place[i], [f"({x})+({u(g, length=1)!r})" for x, g in zip(place[i], gap)]]
            kind = "revolute" if dimension == 2 else "spherical"
            model["joints"].append({"name": f"j{i}", "type": kind, "bodies": ends, "at": at})
        for i in range(bars):
            if dimension == 2:
                value = "k0" if i == 0 else u.torsion(k[i])
                model["springs"].append({"name": f"s{i}", "type": "torsion", "joint": f"j{i}", "stiffness_n_m_per_rad": value})
            else:
                turn = u.torsion(k[i])
                model["springs"].append({"name": f"s{i}", "type": "bushing", "bodies": ["ground", f"b{i}"],
                                         "stiffness_n_per_m": [u.stiffness(k[i])] * 3, "stiffness_n_m_per_rad": [turn, 2 * turn, turn]})
        model["springs"].append({"name": "pull", "type": "axial", "bodies": ["ground", f"b{bars - 1}"],
                                 "at": [u.place(far), u.place(corners[bars])], "stiffness_n_per_m": u.stiffness(k[bars])})
        if gravity:
            model["springs"][-1]["preload_n"] = u(preload, length=1, mass=1, time=-2)
        if driven is not None:
            hold = "lock" if driven == "lock" else {"trim": "s0"}
            model["configurations"]["c"]["drive"] = {"joint": "j0", "position_rad": angle, "hold": hold}
        return model

    return make


class UnitsDoNotMatter(CliTest):
    def answer(self, model):
        self.write("units.json", json.dumps(model))
        modes = self.run_program("modes", "units.json", "--count", "all", "--format", "json", "--quiet")
        slopes = self.run_program("sensitivity", "units.json", "--format", "json", "--quiet")
        return modes, slopes

    def check(self, index):
        rng = random.Random(f"{SEED}:{index}")
        make = mechanism(rng)
        where = f"MT_SEED={SEED} index {index}"
        u = Units(*(10.0 ** rng.uniform(-3, 3) for _ in range(3)))
        models = [make(Units()), make(u)]
        (one, slopes_one), (other, slopes_other) = [self.answer(m) for m in models]
        said = f"{where}: {one.stderr}{other.stderr}\n{json.dumps(models)}"
        self.assertEqual(one.returncode, other.returncode, said)
        if one.returncode != 0:
            self.skipped += 1
            return
        one, other = [json.loads(x.stdout)[0]["modes"] for x in (one, other)]
        self.assertEqual([m["kind"] for m in one], [m["kind"] for m in other], said)
        most = max((abs(m["omega_squared"]) for m in one), default=0.0)
        for a, b in zip(one, other):
            self.assertLessEqual(abs(a["omega_squared"] - u(b["omega_squared"], time=2)), 1e-11 * most, said)
        self.assertEqual(slopes_one.returncode, slopes_other.returncode, f"{said}{slopes_one.stderr}{slopes_other.stderr}")
        if slopes_one.returncode == 0:
            slopes = [json.loads(x.stdout)[0]["modes"] for x in (slopes_one, slopes_other)]
            for a, b in zip(*slopes):
                for x, y in zip(a["sensitivities"], b["sensitivities"]):
                    difference = abs(x["hz_per_percent"] - u(y["hz_per_percent"], time=1))
                    self.assertLessEqual(difference, 1e-10 * a["frequency_hz"], said)

    def test_units(self):
        self.skipped = 0
        for index in range(COUNT):
            with self.subTest(index=index):
                self.check(index)
        self.assertLess(self.skipped, COUNT / 4)


if __name__ == "__main__":
    unittest.main()

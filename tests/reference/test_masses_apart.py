#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Masses far apart, in oblique rows: beads on a line, sliders on each other, discs on a shaft.

Each is a chain of masses m_i and springs k_i along one coordinate, whose eigenvalues are those of a tridiagonal matrix: found
by bisection with Sturm's sequence in eighty digits. The rows stand oblique to the axes, so that no coordinate is one of the
chain's. Masses are spread over up to twenty decades; every frequency has to be right in itself, not only beside the largest.
"""
import decimal
import json
import math
import random
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "cli"))
from common_cli import CliTest  # noqa: E402
from suite import SEED, count  # noqa: E402

COUNT = count(8)
DECADES = [0, 4, 8, 12, 16, 20]
WANTED = 1e-10  # relative, of omega^2
decimal.getcontext().prec = 80


def eigenvalues(m, k):
    """omega^2 of ground - k[0] - m[0] - k[1] - ... - m[n-1] - k[n] - ground, ascending; exactly 0 where nothing holds the chain."""
    n = len(m)
    m = [decimal.Decimal(x) for x in m]
    k = [decimal.Decimal(x) for x in k]
    free = k[0] == 0 and k[-1] == 0
    diagonal = [(k[i] + k[i + 1]) / m[i] for i in range(n)]
    beside = [k[i + 1] ** 2 / (m[i] * m[i + 1]) for i in range(n - 1)]

    def below(x):
        count = 0
        q = diagonal[0] - x
        for i in range(n):
            if i > 0:
                q = diagonal[i] - x - beside[i - 1] / (q or decimal.Decimal("1e-300"))
            count += q < 0
        return count

    found = []
    for j in range(n):
        low, high = decimal.Decimal("1e-40"), 4 * max(diagonal)
        while high / low - 1 > decimal.Decimal("1e-20"):
            middle = (low * high).sqrt()
            low, high = (low, middle) if below(middle) > j else (middle, high)
        found.append(0.0 if free and j == 0 else float(low))
    return found


def numbers(rng, decades):
    n = rng.randint(2, 6)
    m = [10.0 ** (-decades * rng.random()) for _ in range(n)]
    light, heavy = rng.sample(range(n), 2)
    m[heavy], m[light] = 1.0, 10.0**-decades
    k = [10.0 ** rng.uniform(-1, 3) for _ in range(n + 1)]
    if rng.random() < 0.3:
        k[0] = k[-1] = 0.0
    return m, k


def oblique(rng, dimension):
    while True:
        d = [rng.gauss(0, 1) for _ in range(dimension)]
        length = math.sqrt(sum(x * x for x in d))
        d = [x / length for x in d]
        if min(abs(x) for x in d) > 0.05:
            return d


def empty(dimension):
    return {"format": "modetune-model/1", "dimension": dimension, "bodies": [], "joints": [], "springs": [], "configurations": {"c": {}}}


def row_of_beads(rng, m, k):
    """Along a line through the origin: on the ground (points or bodies), or each on the one before."""
    dimension = rng.choice([2, 3])
    d = oblique(rng, dimension)
    points = rng.random() < 0.4
    carried = not points and rng.random() < 0.5
    along = [0.0] + [i + 1 + rng.uniform(-0.3, 0.3) for i in range(len(m) + 1)]
    at = [[x * s for x in d] for s in along]
    model = empty(dimension)
    for i, mass in enumerate(m):
        body = {"name": f"b{i}", "mass_kg": mass, "centre": at[i + 1]}
        if not points:
            spin = 0.1 * mass
            body["inertia_kg_m2"] = spin if dimension == 2 else [spin, 1.5 * spin, 1.2 * spin]
        model["bodies"].append(body)
        kind = "prismatic" if not points else "pin-in-slot" if dimension == 2 else "point-on-line"
        on = f"b{i - 1}" if carried and i > 0 else "ground"
        model["joints"].append({"name": f"j{i}", "type": kind, "bodies": [on, f"b{i}"], "at": at[i + 1], "axis": d})
    for i, stiffness in enumerate(k):
        ends = ["ground" if j in (0, len(m) + 1) else f"b{j - 1}" for j in (i, i + 1)]
        if stiffness:
            model["springs"].append({"name": f"s{i}", "type": "axial", "bodies": ends, "at": [at[i], at[i + 1]],
                                     "stiffness_n_per_m": stiffness})
    return model


def shaft(rng, m, k):
    """Discs on a shaft, one on the other; nothing holds the far end."""
    d = oblique(rng, 3)
    k[-1] = 0.0
    model = empty(3)
    for i, spin in enumerate(m):
        at = [x * (i + 1) for x in d]
        model["bodies"].append({"name": f"b{i}", "mass_kg": 10 * spin, "centre": at, "inertia_kg_m2": [spin] * 3})
        on = f"b{i - 1}" if i > 0 else "ground"
        model["joints"].append({"name": f"j{i}", "type": "revolute", "bodies": [on, f"b{i}"], "at": at, "axis": d})
        if k[i]:
            model["springs"].append({"name": f"s{i}", "type": "torsion", "joint": f"j{i}", "stiffness_n_m_per_rad": k[i]})
    return model


class MassesApart(CliTest):
    def check(self, make, decades, index):
        rng = random.Random(f"{SEED}:{make.__name__}:{decades}:{index}")
        m, k = numbers(rng, decades)
        model = make(rng, m, k)
        where = f"MT_SEED={SEED} {make.__name__} decades {decades} index {index}"
        self.write("row.json", json.dumps(model))
        done = self.run_program("modes", "row.json", "--count", "all", "--format", "json", "--quiet")
        self.assertEqual(done.returncode, 0, f"{where}: {done.stderr}\n{json.dumps(model)}")
        modes = json.loads(done.stdout)[0]["modes"]
        want = eigenvalues(m, k)
        self.assertEqual(len(modes), len(want), where)
        for mode, exact in zip(modes, want):
            error = abs(mode["omega_squared"] - exact)
            self.assertLessEqual(error, WANTED * exact, f"{where}: {mode} {exact}\n{json.dumps(model)}")
            self.assertLessEqual(error, mode["omega_squared_error"], f"{where}: {mode} {exact}\n{json.dumps(model)}")
            self.assertEqual(mode["kind"], "flexible" if exact > 0 else "rigid_body", where)

    def test_beads(self):
        for decades in DECADES:
            for index in range(2 * COUNT):
                with self.subTest(decades=decades, index=index):
                    self.check(row_of_beads, decades, index)

    def test_shafts(self):
        for decades in DECADES:
            for index in range(COUNT):
                with self.subTest(decades=decades, index=index):
                    self.check(shaft, decades, index)


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""Masses on springs and dampers along a line, and the matrices of their equations, for tests of what shakes them."""
import math
import random

import numpy

G = 9.80665


def one_mass(zeta, hz, mass=2.0):
    """A mass on a spring and a damper that stand on the ground, along x."""
    w = 2 * math.pi * hz
    along = {"type": "axial", "bodies": ["ground", "a"], "at": [[0, 0], [1, 0]]}
    return {"format": "modetune-model/1", "name": "One", "dimension": 2,
            "bodies": [{"name": "a", "mass_kg": mass, "inertia_kg_m2": 1, "centre": [1, 0]}],
            "joints": [{"name": "j", "type": "prismatic", "bodies": ["ground", "a"], "at": [1, 0], "axis": [1, 0]}],
            "springs": [along | {"name": "s", "stiffness_n_per_m": mass * w * w}],
            "dampers": [along | {"name": "d", "damping_n_s_per_m": 2 * zeta * w * mass}],
            "sensors": [{"name": "a", "on": "a", "directions": ["x"]}]}


def chain(seed, n):
    """Masses on a line, each sprung and damped against those before it: the model, and M, C, K made here."""
    rng = random.Random(seed)
    m, c, k = (numpy.zeros((n, n)) for _ in range(3))
    model = {"format": "modetune-model/1", "name": "chain", "dimension": 2, "bodies": [], "joints": [], "springs": [], "dampers": [], "sensors": []}

    def tie(matrix, i, j, value):
        for a in (i, j):
            for b in (i, j):
                if a >= 0 and b >= 0:
                    matrix[a, b] += value if a == b else -value

    for i in range(n):
        name, at = f"b{i}", [i + 1, 0]
        m[i, i] = 10 ** rng.uniform(-1, 1)
        model["bodies"].append({"name": name, "mass_kg": m[i, i], "inertia_kg_m2": 1, "centre": at})
        model["joints"].append({"name": "j" + name, "type": "prismatic", "bodies": ["ground", name], "at": at, "axis": [1, 0]})
        model["sensors"].append({"name": name, "on": name, "directions": ["x"]})
        for kind, matrix, member, low, high in (("springs", k, "stiffness_n_per_m", 2, 4), ("dampers", c, "damping_n_s_per_m", -1, 0.5)):
            to = rng.randrange(-1, i) if i and kind == "dampers" else i - 1
            value = 10 ** rng.uniform(low, high)
            tie(matrix, i, to, value)
            ends = ["ground" if to < 0 else f"b{to}", name]
            model[kind].append({"name": kind[0] + name, "type": "axial", "bodies": ends, "at": [[to + 1, 0], at], member: value})
    return model, m, c, k

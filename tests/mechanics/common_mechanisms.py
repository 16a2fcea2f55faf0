# SPDX-License-Identifier: GPL-3.0-or-later
"""Mechanisms for generated tests: drawn about the origin, then turned, moved, scaled and shuffled at random."""
import json
import math
import os
import random
import subprocess
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(os.environ.get("SOURCE_DIR", Path(__file__).resolve().parents[2]))
PROGRAM = os.environ.get("MODETUNE", str(SOURCE / "build/release/modetune"))


def add(a, b, k=1.0):
    return [x + k * y for x, y in zip(a, b)]


def spatial(x):
    return list(x) + [0.0] * (3 - len(x))


def rotation(rng, dimension):
    """A random rotation matrix, as rows; about z alone in two dimensions."""
    if dimension == 2:
        angle = rng.uniform(0, 2 * math.pi)
        return [[math.cos(angle), -math.sin(angle), 0.0], [math.sin(angle), math.cos(angle), 0.0], [0.0, 0.0, 1.0]]
    q = [rng.gauss(0, 1) for _ in range(4)]
    size = math.sqrt(sum(v * v for v in q))
    w, x, y, z = (v / size for v in q)
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]


class Mechanism:
    """Bodies of 1 kg and joints, in plain lists; `at` may be a pair of points."""

    def __init__(self, dimension):
        self.dimension = dimension
        self.bodies = []
        self.joints = []
        self.springs = []
        self.more = {}

    def body(self, name, centre):
        self.bodies.append((name, list(centre)))

    def joint(self, name, kind, a, b, at, axis=None):
        self.joints.append((name, kind, (a, b), at, axis))

    def torsion(self, joint, stiffness=10.0):
        self.springs.append({"name": "s_" + joint, "type": "torsion", "joint": joint, "stiffness_n_m_per_rad": stiffness})

    def in_space(self):
        """The same planar mechanism of revolute joints in three dimensions."""
        other = Mechanism(3)
        other.bodies = [(n, spatial(c)) for n, c in self.bodies]
        for name, kind, bodies, at, axis in self.joints:
            place = tuple(spatial(p) for p in at) if isinstance(at, tuple) else spatial(at)
            direction = [0.0, 0.0, 1.0] if kind == "revolute" else None if axis is None else spatial(axis)
            other.joints.append((name, kind, bodies, place, direction))
        other.springs, other.more = self.springs, self.more
        return other

    def model(self, rng=None):
        """As drawn; with rng anywhere, of any size, in any order."""
        n = self.dimension
        scale = 1.0 if rng is None else 10 ** rng.uniform(-3, 3)
        turn = [[float(i == k) for k in range(3)] for i in range(3)] if rng is None else rotation(rng, n)
        move = [0.0] * 3 if rng is None else [scale * rng.gauss(0, 3) for _ in range(3)]

        def vector(x):
            return [sum(row[k] * v for k, v in enumerate(spatial(x))) for row in turn][:n]

        def point(x):
            return [scale * v + m for v, m in zip(vector(x), move)]

        bodies = [{"name": name, "mass_kg": 1, "centre": point(c),
                   "inertia_kg_m2": 0.02 * scale**2 if n == 2 else [0.02 * scale**2] * 3} for name, c in self.bodies]
        joints = []
        for name, kind, pair, at, axis in self.joints:
            joint = {"name": name, "type": kind, "bodies": list(pair)}
            joint["at"] = [point(p) for p in at] if isinstance(at, tuple) else point(at)
            if axis is not None:
                joint["axis"] = vector(axis)
            joints.append(joint)
        springs = []
        for spring in self.springs:
            spring = dict(spring)
            if "stiffness_n_m_per_rad" in spring:
                spring["stiffness_n_m_per_rad"] *= scale**2
            if "at" in spring:
                spring["at"] = [point(p) for p in spring["at"]]
            springs.append(spring)
        if rng is not None:
            rng.shuffle(bodies)
            rng.shuffle(joints)
        model = {"format": "modetune-model/1", "dimension": n, "bodies": bodies, "joints": joints, "springs": springs}
        model.update(self.more)
        if "gravity_m_per_s2" in model:
            model["gravity_m_per_s2"] = vector(model["gravity_m_per_s2"])
        return model


def loop(points):
    """Bars b0, b1, .. between the points, hinges j0, j1, .. at them, the first and the last to the ground; a spring in j0."""
    m = Mechanism(2)
    n = len(points)
    for i in range(n - 1):
        m.body(f"b{i}", [0.5 * x for x in add(points[i], points[i + 1])])
    for i in range(n):
        m.joint(f"j{i}", "revolute", "ground" if i == 0 else f"b{i - 1}", "ground" if i == n - 1 else f"b{i}", points[i])
    m.torsion("j0")
    return m


class MechanismTest(unittest.TestCase):
    maxDiff = None

    def setUp(self):
        self._folder = tempfile.TemporaryDirectory()
        self.addCleanup(self._folder.cleanup)

    def run_on(self, model, command, *args):
        path = Path(self._folder.name) / "model.json"
        path.write_text(json.dumps(model), encoding="utf-8")
        return self.run_program(command, str(path), *args)

    @staticmethod
    def run_program(*args):
        return subprocess.run([PROGRAM, *args], capture_output=True, encoding="utf-8", timeout=600, check=False)

    def answer(self, model, command, *args, code=0):
        done = self.run_on(model, command, "--format", "json", *args)
        self.assertEqual(done.returncode, code, done.stderr + json.dumps(model))
        got = json.loads(done.stdout)
        return got[0] if isinstance(got, list) else got


def seeded(*what):
    return random.Random(repr(what))

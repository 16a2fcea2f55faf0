#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Springs that act against what joints and locks block: how many rigid-body modes, against ranks in exact arithmetic.

Open chains and trees of bodies, drawn at small integers, with joints of every type (some of them twice: permanently
redundant), springs of every type across and beside the joints, and a servo on a driven joint that is locked. The rows of
constraints (A) and springs (B) are then integers, and
    freedoms = nq - rank A,   rigid-body modes = nq - rank [A; B]
are counted without rounding. Turning, shifting and scaling the drawing changes neither, and the program sees it turned,
shifted and scaled. The frequencies are compared with those of the same rows reduced by an exact basis.
"""
import json
import math
import random
import sys
import unittest
from fractions import Fraction
from pathlib import Path

import numpy
import scipy.linalg

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "cli"))
from common_cli import CliTest  # noqa: E402
from suite import SEED, count  # noqa: E402

SEED = int(SEED)
COUNT = count(15, every=300, instrumented=50)

PLANE_JOINTS = ["fixed", "revolute", "prismatic", "pin-in-slot", "distance"]
SPACE_JOINTS = ["fixed", "revolute", "prismatic", "cylindrical", "spherical", "universal", "planar", "point-on-line", "distance"]
ANGLE = {"revolute", "cylindrical"}
LENGTH = {"prismatic", "pin-in-slot", "point-on-line", "cylindrical"}
AXIS = ANGLE | LENGTH | {"universal", "planar"}


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def eliminate(rows):
    """Reduced row echelon form over the rationals: rows, pivot columns."""
    rows = [[Fraction(x) for x in r] for r in rows]
    pivots = []
    at = 0
    for column in range(len(rows[0]) if rows else 0):
        found = next((i for i in range(at, len(rows)) if rows[i][column]), None)
        if found is None:
            continue
        rows[at], rows[found] = rows[found], rows[at]
        rows[at] = [x / rows[at][column] for x in rows[at]]
        for i, row in enumerate(rows):
            if i != at and row[column]:
                rows[i] = [x - row[column] * y for x, y in zip(row, rows[at])]
        pivots.append(column)
        at += 1
    return rows[:at], pivots


def rank(rows):
    return len(eliminate(rows)[1])


def null_space(rows, n):
    """Columns of an exact basis of {q: rows q = 0}."""
    echelon, pivots = eliminate(rows)
    columns = []
    for free in (j for j in range(n) if j not in pivots):
        column = [Fraction(0)] * n
        column[free] = Fraction(1)
        for row, pivot in zip(echelon, pivots):
            column[pivot] = -row[free]
        columns.append(column)
    return columns


class Mechanism:
    """A tree at integers. rows: over (dx, dy, dz, rx, ry, rz) of each body; in the plane what leaves it is dropped."""

    def __init__(self, rng, dimension):
        self.rng = rng
        self.dimension = dimension
        self.centres = []
        self.joints = []  # (type, a, b, at, axis, axis_b)
        self.springs = []  # (json without geometry, [(stiffness, row)])
        self.constraints = []
        self.lock = None
        for b in range(rng.randint(1, 4)):
            self.centres.append(self.point())
            self.join(b)
        for _ in range(rng.randint(1, 5)):
            self.spring()

    def point(self):
        x = [self.rng.randint(-3, 3) for _ in range(3)]
        return x if self.dimension == 3 else [x[0], x[1], 0]

    def direction(self):
        while True:
            d = self.point()
            if any(d):
                return d

    def keep(self, row):
        """Columns of the states there are."""
        kept = [0, 1, 2, 3, 4, 5] if self.dimension == 3 else [0, 1, 5]
        return [row[6 * b + k] for b in range(len(self.centres)) for k in kept]

    def row(self, a, b, on_a, on_b):
        """Six numbers on each of two bodies (-1: ground)."""
        row = [0] * (6 * 8)
        for body, part in ((a, on_a), (b, on_b)):
            for k in range(6):
                row[6 * body + k] += part[k] if body >= 0 else 0
        return row

    def along(self, a, b, at_a, at_b, u):
        """u, carried by a, times (Q - P)."""
        s = minus(at_b, self.centres[a] if a >= 0 else [0, 0, 0])
        t = minus(at_b, self.centres[b] if b >= 0 else [0, 0, 0])
        return self.row(a, b, [-x for x in u] + [-x for x in cross(s, u)], list(u) + cross(t, u))

    def about(self, a, b, n):
        return self.row(a, b, [0, 0, 0] + [-x for x in n], [0, 0, 0] + list(n))

    def distance(self, a, b, at_a, at_b):
        v = minus(at_b, at_a)
        s = minus(at_a, self.centres[a] if a >= 0 else [0, 0, 0])
        t = minus(at_b, self.centres[b] if b >= 0 else [0, 0, 0])
        return self.row(a, b, [-x for x in v] + [-x for x in cross(s, v)], list(v) + cross(t, v))

    def perpendicular(self, n):
        if self.dimension == 2:
            return [[-n[1], n[0], 0]]
        first = next(p for p in (cross(n, e) for e in ([1, 0, 0], [0, 1, 0], [0, 0, 1])) if any(p))
        return [first, cross(n, first)]

    def equations(self, kind, a, b, at, n, m):
        e = [[1, 0, 0], [0, 1, 0], [0, 0, 1]][:self.dimension]
        space = self.dimension == 3
        point = [self.along(a, b, at[0], at[1], u) for u in e]
        turns = [self.about(a, b, u) for u in ([[1, 0, 0], [0, 1, 0], [0, 0, 1]] if space else [[0, 0, 1]])]
        if kind == "distance":
            return [self.distance(a, b, *at)]
        if kind == "fixed":
            return point + turns
        if kind == "spherical" or (kind == "revolute" and not space):
            return point
        if kind == "universal":
            return point + [self.about(a, b, cross(n, m))]
        line = [self.along(a, b, at[0], at[1], u) for u in self.perpendicular(n)]
        parallel = [self.about(a, b, u) for u in self.perpendicular(n)] if space else turns
        return {"revolute": point + parallel, "cylindrical": line + parallel, "prismatic": line + turns, "pin-in-slot": line,
                "point-on-line": line, "planar": [self.along(a, b, at[0], at[1], n)] + parallel}[kind]

    def coordinate(self, kind, a, b, at, n):
        """The row of the coordinate that a drive locks, a servo acts on."""
        if kind in ANGLE:
            return self.about(a, b, n if self.dimension == 3 else [0, 0, 1])
        return self.along(a, b, at[0], at[1], n)

    def join(self, b):
        rng = self.rng
        kinds = PLANE_JOINTS if self.dimension == 2 else SPACE_JOINTS
        a = rng.randint(-1, b - 1)
        if a < 0 and rng.random() < 0.4:
            return  # free, so far
        kind = rng.choice(kinds)
        at = [self.point()] * 2
        while kind == "distance" and at[0] == at[1]:
            at = [self.point(), self.point()]
        n = self.direction()
        m = None
        if kind == "universal":
            m = self.perpendicular(n)[rng.randint(0, 1)]
        for _ in range(2 if rng.random() < 0.2 else 1):
            self.joints.append((kind, a, b, at, n, m))
            self.constraints += self.equations(kind, a, b, at, n, m)
        if self.lock is None and kind in ANGLE | LENGTH and rng.random() < 0.3:
            self.lock = len(self.joints) - 1
            self.constraints.append(self.coordinate(kind, a, b, at, n))

    def spring(self):
        rng = self.rng
        if self.joints and rng.random() < 0.75:  # across a joint
            index = rng.randrange(len(self.joints))
            kind, a, b, at, n, _ = self.joints[index]
        else:
            index, kind = None, None
            a, b = rng.sample(range(-1, len(self.centres)), 2)
            at = [self.point()] * 2
        if kind in ANGLE and rng.random() < 0.5:
            k = self.stiffness()
            about = n if self.dimension == 3 else [0, 0, 1]
            length = math.sqrt(sum(x * x for x in about))
            self.springs.append(({"type": "torsion", "joint": f"j{index}"}, [], [(k, self.about(a, b, about), length)]))
            return
        form = rng.choice(["axial", "bushing", "bar", "torsion"] if self.dimension == 2 else ["axial", "bushing", "bar", "matrix"])
        if form == "torsion":
            k = self.stiffness()
            self.springs.append(({"type": form, "bodies": [a, b]}, [], [(k, self.about(a, b, [0, 0, 1]), 1)]))
        elif form == "matrix":  # a bushing that is soft or stiff along the axes of the drawing, however that is turned
            point = at[0] if rng.random() < 0.5 else self.point()
            e = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
            rows = []
            sizes = [self.stiffness() if rng.random() < 0.5 else 0.0 for _ in range(6)]
            for k, size in enumerate(sizes):
                if size:
                    rows.append((size, self.along(a, b, point, point, e[k]) if k < 3 else self.about(a, b, e[k - 3]), 1))
            self.springs.append(({"type": "bushing", "bodies": [a, b], "sizes": sizes}, [point], rows))
        elif form == "bushing":
            sides = [rng.random() < 0.7, rng.random() < 0.7]
            force, torque = self.stiffness(), self.stiffness()
            point = at[0] if rng.random() < 0.5 else self.point()
            e = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
            turns = e if self.dimension == 3 else e[2:]
            rows = [(force, self.along(a, b, point, point, u), 1) for u in e[:self.dimension] if sides[0]]
            rows += [(torque, self.about(a, b, u), 1) for u in turns if sides[1]]
            self.springs.append(({"type": form, "bodies": [a, b], "sides": sides}, [point], rows))
        else:
            p, q = self.point(), self.point()
            while p == q:
                q = self.point()
            k = self.stiffness()
            length = math.sqrt(sum(x * x for x in minus(q, p)))
            self.springs.append(({"type": form, "bodies": [a, b]}, [p, q], [(k, self.distance(a, b, p, q), length)]))

    def stiffness(self):
        return 10.0 ** self.rng.uniform(0, 5)

    # what the program gets: turned by r, scaled by l, shifted by o
    def model(self, r, l, o):
        def place(p):
            return [float(x) for x in (o + l * (r @ numpy.array(p, float)))[:self.dimension]]

        def turn(d):
            return [float(x) for x in (r @ numpy.array(d, float))[:self.dimension]]

        def body(i):
            return "ground" if i < 0 else f"b{i}"

        model = {"format": "modetune-model/1", "dimension": self.dimension, "bodies": [], "joints": [], "springs": [],
                 "configurations": {"c": {}}}
        for i, centre in enumerate(self.centres):
            spin = 0.4 * l * l * (1 + i)
            model["bodies"].append({"name": f"b{i}", "mass_kg": 1 + i, "centre": place(centre),
                                    "inertia_kg_m2": spin if self.dimension == 2 else [spin, spin, spin]})
        for i, (kind, a, b, at, n, m) in enumerate(self.joints):
            joint = {"name": f"j{i}", "type": kind, "bodies": [body(a), body(b)], "at": place(at[0])}
            if kind == "distance":
                joint["at"] = [place(at[0]), place(at[1])]
            if kind in AXIS and not (kind == "revolute" and self.dimension == 2):
                joint["axis"] = turn(n)
            if m is not None:
                joint["axis_b"] = turn(m)
            model["joints"].append(joint)
        for i, (head, at, rows) in enumerate(self.springs):
            spring = dict(head, name=f"s{i}")
            if "bodies" in spring:
                spring["bodies"] = [body(x) for x in spring["bodies"]]
            if at:
                spring["at"] = [place(p) for p in at] if len(at) == 2 else place(at[0])
            k = rows[0][0] if rows else 0.0
            if head["type"] == "torsion":
                spring["stiffness_n_m_per_rad"] = k * l * l
            elif head["type"] == "axial":
                spring["stiffness_n_per_m"] = k
            elif head["type"] == "bar":
                spring.update(youngs_modulus_pa=k * rows[0][2] * l, area_m2=1)
            elif "sizes" in head:
                size = numpy.diag(spring.pop("sizes"))
                force, torque = r @ size[:3, :3] @ r.T, r @ size[3:, 3:] @ r.T * l * l
                matrix = numpy.block([[force, numpy.zeros((3, 3))], [numpy.zeros((3, 3)), torque]])
                spring["stiffness_matrix"] = ((matrix + matrix.T) / 2).tolist()
            else:
                sides = spring.pop("sides")
                turns = [x for x, row, _ in rows if not any(row[6 * j + c] for j in range(8) for c in range(3))]
                pushes = [x for x, row, _ in rows if any(row[6 * j + c] for j in range(8) for c in range(3))]
                n_turns = 3 if self.dimension == 3 else 1
                spring["stiffness_n_per_m"] = [pushes[0] if sides[0] else 0.0] * self.dimension
                torque = [turns[0] * l * l if sides[1] else 0.0] * n_turns
                spring["stiffness_n_m_per_rad"] = torque if n_turns == 3 else torque[0]
            model["springs"].append(spring)
        if self.lock is not None:
            kind = self.joints[self.lock][0]
            unit = "position_rad" if kind in ANGLE else "position_m"
            model["configurations"]["c"] = {"drive": {"joint": f"j{self.lock}", unit: 0, "hold": "lock"}}
        return model

    # what is right
    def counts(self):
        a = [self.keep(r) for r in self.constraints]
        b = [self.keep(r) for _, _, rows in self.springs for _, r, _ in rows]
        nq = len(self.centres) * (6 if self.dimension == 3 else 3)
        return nq, nq - (rank(a) if a else 0), nq - (rank(a + b) if a + b else 0)

    def eigenvalues(self):
        """omega^2 of the drawing at scale 1."""
        nq, n, _ = self.counts()
        a = [self.keep(r) for r in self.constraints]
        z = numpy.array(null_space(a, nq) if a else numpy.eye(nq), float).T.reshape(nq, n)
        states = 6 if self.dimension == 3 else 3
        mass = numpy.array([(1 + b) * (1.0 if k < self.dimension else 0.4) for b in range(len(self.centres))
                            for k in range(states)])
        k_r = numpy.zeros((n, n))
        for _, _, rows in self.springs:
            for k, row, length in rows:
                exact = [sum(x * Fraction(y) for x, y in zip(self.keep(row), c)) for c in self.exact(nq, a)]
                r = numpy.array(exact, float) / length
                k_r += k * numpy.outer(r, r)
        if n == 0:
            return numpy.zeros(0)
        return scipy.linalg.eigh(k_r, z.T @ (mass[:, None] * z), eigvals_only=True)

    def exact(self, nq, a):
        if a:
            return null_space(a, nq)
        return [[Fraction(int(i == j)) for i in range(nq)] for j in range(nq)]


def turning(rng, dimension):
    """A random rotation; in the plane about z."""
    q = numpy.array([rng.gauss(0, 1) for _ in range(4)])
    if dimension == 2:
        q[1] = q[2] = 0
    w, x, y, z = q / numpy.linalg.norm(q)
    return numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


class BlockedSprings(CliTest):
    def check(self, index, dimension):
        rng = random.Random(f"{SEED}:{dimension}:{index}")
        mechanism = Mechanism(rng, dimension)
        _, n, rigid = mechanism.counts()
        l = 10.0 ** rng.uniform(-3, 3)
        o = l * numpy.array([rng.uniform(-20, 20) for _ in range(3)])
        if dimension == 2:
            o[2] = 0
        model = mechanism.model(turning(rng, dimension), l, o)
        self.write("blocked.json", json.dumps(model))
        done = self.run_program("modes", "blocked.json", "--count", "all", "--format", "json", "--quiet")
        where = f"MT_SEED={SEED} dimension {dimension} index {index}"
        self.assertEqual(done.returncode, 0, f"{where}: {done.stderr}\n{json.dumps(model)}")
        modes = json.loads(done.stdout)[0]["modes"]
        kinds = [m["kind"] for m in modes]
        found = [kinds.count("rigid_body"), kinds.count("flexible"), len(kinds)]
        self.assertEqual(found, [rigid, n - rigid, n], f"{where}: {kinds}\n{json.dumps(model)}")
        want = mechanism.eigenvalues()
        got = [m["omega_squared"] for m in modes]
        most = max(want, default=0.0)
        for x, y in zip(got, want):
            self.assertLessEqual(abs(x - y), 1e-10 * most, f"{where}: {got} {list(want)}\n{json.dumps(model)}")

    def test_plane(self):
        for index in range(COUNT):
            with self.subTest(index=index):
                self.check(index, 2)

    def test_space(self):
        for index in range(COUNT):
            with self.subTest(index=index):
                self.check(index, 3)

    def test_sensors_see_nothing_where_nothing_moves(self):
        """A sensor across a slide reads exactly 0, not rounding that a MAC could be made of."""
        rng = random.Random(SEED)
        for index in range(20):
            at = [rng.uniform(-9, 9), rng.uniform(-9, 9)]
            arm = [x + rng.uniform(-1, 1) for x in at]
            model = {"format": "modetune-model/1", "dimension": 2,
                     "bodies": [{"name": "s", "mass_kg": 1, "inertia_kg_m2": 0.3, "centre": at}],
                     "joints": [{"name": "j", "type": "prismatic", "bodies": ["ground", "s"], "at": arm, "axis": [1, 0]}],
                     "springs": [{"name": "k", "type": "bushing", "bodies": ["ground", "s"], "at": arm,
                                  "stiffness_n_per_m": [rng.uniform(1, 9), 1e6], "stiffness_n_m_per_rad": 1e6}],
                     "sensors": [{"name": "c", "on": "s", "at": [rng.uniform(-9, 9), rng.uniform(-9, 9)],
                                  "directions": ["x", "y", "r"]}]}
            self.write("slide.json", json.dumps(model))
            done = self.run_program("modes", "slide.json", "--count", "all", "--format", "json", "--quiet", "--shapes")
            self.assertEqual(done.returncode, 0, done.stderr)
            shape = json.loads(done.stdout)[0]["modes"][0]["shape"]
            self.assertAlmostEqual(abs(shape["c.x"]), 1.0, 14, f"MT_SEED={SEED} index {index}")
            self.assertEqual([shape["c.y"], shape["c.r"]], [0, 0], f"MT_SEED={SEED} index {index}")

    def test_slopes_do_not_see_blocked_springs(self):
        """Nor do derivatives by the geometry, however stiff a bushing across a hinge is."""
        rng = random.Random(SEED)
        for index in range(10):
            where = f"MT_SEED={SEED} index {index}"
            tilt, soft, stiff = rng.uniform(0.2, 1.4), rng.uniform(1, 30), 10.0 ** rng.uniform(3, 13)
            tip = [f"L*cos({tilt})", f"L*sin({tilt})"]
            model = {"format": "modetune-model/1", "dimension": 2, "parameters": {"L": rng.uniform(1, 2), "d": 0.4, "k": 50.0},
                     "bodies": [{"name": "a", "mass_kg": 2, "inertia_kg_m2": 0.3, "centre": [f"{x}/2" for x in tip]},
                                {"name": "b", "mass_kg": 1, "inertia_kg_m2": 0.2, "centre": [f"{tip[0]}+d", tip[1]]}],
                     "joints": [{"name": "p", "type": "revolute", "bodies": ["ground", "a"], "at": [0, 0]},
                                {"name": "q", "type": "revolute", "bodies": ["a", "b"], "at": tip}],
                     "springs": [{"name": "t", "type": "torsion", "joint": "p", "stiffness_n_m_per_rad": "k"},
                                 {"name": "u", "type": "torsion", "joint": "q", "stiffness_n_m_per_rad": soft}]}
            slopes = []
            for _ in range(2):
                self.write("slope.json", json.dumps(model))
                done = self.run_program("sensitivity", "slope.json", "--format", "json", "--quiet")
                self.assertEqual(done.returncode, 0, f"{where}: {done.stderr}")
                slopes.append([x["hz_per_percent"] for m in json.loads(done.stdout)[0]["modes"] for x in m["sensitivities"]])
                model["springs"].append({"name": "x", "type": "bushing", "bodies": ["a", "b"], "at": tip,
                                         "stiffness_n_per_m": [stiff, 2 * stiff], "stiffness_n_m_per_rad": 0})
            for x, y in zip(*slopes):
                self.assertAlmostEqual(x, y, 13, where)


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""--start begins in the assembly of the drawing: random closed loops with springs, against circles that meet.

Sides of a loop are turned by the joints that are held, the rest is a triangle: the sign of its area tells the assembly, and
where its sides reach each other no longer there is a limit.
"""
import json
import math
import os
import random
import subprocess
import tempfile
import unittest
from pathlib import Path

PROGRAM = os.environ["MODETUNE"]
EVERY = bool(os.environ.get("MT_EVERY"))
EACH = 120 if EVERY else 12  # of a family


def turned(point, centre, angle):
    x, y = point[0] - centre[0], point[1] - centre[1]
    return centre[0] + x * math.cos(angle) - y * math.sin(angle), centre[1] + x * math.sin(angle) + y * math.cos(angle)


def area(p, q, s):
    """Sine of the angle at q."""
    cross = (q[0] - p[0]) * (s[1] - q[1]) - (q[1] - p[1]) * (s[0] - q[0])
    return cross / (math.dist(p, q) * math.dist(q, s))


def ring(r, points, loads):
    """Bars between points that follow each other, the last to the first is the ground; joints j0, j1, ..."""
    n = len(points)
    bars = ["ground"] + [f"b{i}" for i in range(1, n)]
    middle = [[(a + b) / 2 for a, b in zip(points[i - 1], points[i])] for i in range(1, n)]
    bodies = [{"name": f"b{i}", "mass_kg": r.uniform(0.5, 2), "inertia_kg_m2": r.uniform(1e-3, 2e-2), "centre": middle[i - 1]}
              for i in range(1, n)]
    joints = [{"name": f"j{i}", "type": "revolute", "bodies": [bars[i], bars[(i + 1) % n]], "at": list(points[i])} for i in range(n)]
    springs = [{"name": "coil", "type": "torsion", "joint": "j0", "stiffness_n_m_per_rad": r.uniform(1, 30),
                "preload_n_m": loads * r.uniform(-60, 60)},
               {"name": "wire", "type": "axial", "bodies": ["ground", "b2"], "at": [[r.uniform(-1, 1), r.uniform(-1, 1)], middle[1]],
                "stiffness_n_per_m": r.uniform(50, 1000), "preload_n": loads * r.uniform(-900, 900)}]
    return {"format": "modetune-model/1", "dimension": 2, "bodies": bodies, "joints": joints, "springs": springs,
            "configurations": {"c": {}}}


def side(points, i, j, angles):
    """Distance from joint i on to joint j, those between turned by their angles."""
    n, k, turn, at = len(points), i, 0.0, (0.0, 0.0)
    while k != j:
        step = [b - a for a, b in zip(points[k], points[(k + 1) % n])]
        at = tuple(a + b for a, b in zip(at, turned(step, (0, 0), turn)))
        k = (k + 1) % n
        turn += angles.get(k, 0.0)
    return math.hypot(*at)


def room(points, free, held, share):
    """How far the triangle of the free joints is from being flat, of its longest side."""
    angles = {i: v * share for i, v in held.items()}
    s = [side(points, free[k], free[(k + 1) % 3], angles) for k in range(3)]
    return min(s[0] + s[1] - s[2], s[1] + s[2] - s[0], s[2] + s[0] - s[1]) / max(s)


def four_bar(r):
    points = [(0.0, 0.0), (r.uniform(-0.2, 0.3), r.uniform(0.02, 0.3)), (r.uniform(-0.1, 0.5), r.uniform(-0.3, 0.3)),
              (r.uniform(0.1, 0.4), r.uniform(-0.1, 0.1))]
    return points, {r.randrange(4): r.uniform(-2.5, 2.5)}, 0


def past_a_line(r):
    """The crank passes where coupler and rocker nearly lie on each other, by more than a drawing's digits leave open."""
    crank, ground, rocker = r.uniform(0.1, 0.2), r.uniform(0.25, 0.4), r.uniform(0.15, 0.3)
    gap = ground - crank
    coupler = rocker + gap * (1 - 10 ** r.uniform(-3, -1.5))
    begin = r.choice([-1, 1]) * r.uniform(0.8, 1.5)
    tip = turned((crank, 0), (0, 0), begin)
    reach = math.dist(tip, (ground, 0))
    bend = math.acos((reach**2 + coupler**2 - rocker**2) / (2 * reach * coupler))
    knee = turned((tip[0] + coupler * (ground - tip[0]) / reach, tip[1] - coupler * tip[1] / reach), tip, r.choice([-1, 1]) * bend)
    return [(0.0, 0.0), tip, knee, (ground, 0.0)], {0: -math.copysign(r.uniform(0.3, 1.0), begin) - begin}, 0


def five_bar(r):
    """Loads pull it through positions in line: where it rests is often another assembly than the drawing."""
    points = [(0.0, 0.0), (r.uniform(-0.2, 0.2), r.uniform(0.05, 0.3)), (r.uniform(-0.1, 0.4), r.uniform(-0.3, 0.5)),
              (r.uniform(0.1, 0.7), r.uniform(-0.3, 0.4)), (r.uniform(0.2, 0.5), r.uniform(-0.1, 0.1))]
    return points, {i: r.uniform(-0.5, 0.5) for i in sorted(r.sample(range(5), 2))}, 1


class Starts(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = Path(self.folder.name) / "ring.json"

    def begin(self, model, held):
        """(exit status, angles of all joints, messages)"""
        self.path.write_text(json.dumps(model), encoding="utf-8")
        done = subprocess.run([PROGRAM, "simulate", self.path, "--duration", "1e-4", "--dt-out", "1e-4", "--format", "json", "--quiet"]
                              + [a for j, v in held.items() for a in ("--start", f"j{j}={v!r}")]
                              + [a for j in model["joints"] for a in ("--measure", j["name"])],
                              capture_output=True, text=True, check=False, timeout=60)
        if done.returncode != 0:
            return done.returncode, None, done.stderr
        return 0, [o["values"][0] for o in json.loads(done.stdout)["outputs"]], ""

    def placed(self, points, angles):
        """Where the joints are, by turning one bar after the other; the loop has to close."""
        out, turn, n = [points[0]], 0.0, len(points)
        for i in range(n):
            turn += angles[i]
            if i + 1 < n:
                step = turned([b - a for a, b in zip(points[i], points[i + 1])], (0, 0), turn)
                out.append(tuple(a + b for a, b in zip(out[i], step)))
        self.assertLess(math.dist(out[-1], points[-1]), 1e-9)
        return out

    def members(self, family):
        """Loops that are not flat as drawn."""
        r = random.Random(f"starts {family.__name__}")
        found = 0
        while found < EACH:
            points, held, loads = family(r)
            free = [i for i in range(len(points)) if i not in held]
            far = min(math.dist(a, b) for a, b in zip(points, points[1:] + points[:1])) > 0.05
            if far and abs(area(*(points[i] for i in free))) > 0.3:
                found += 1
                yield found, points, held, free, ring(r, points, loads)

    def check(self, family):
        ends = {"there": 0, "refused": 0, "no rest": 0}
        for number, points, held, free, model in self.members(family):
            with self.subTest(family.__name__, number=number):
                code, angles, said = self.begin(model, held)
                if "no equilibrium found" in said:  # of the loaded loop itself
                    ends["no rest"] += 1
                    continue
                least = min(room(points, free, held, k / 400) for k in range(401))
                if code == 0:
                    end = self.placed(points, angles)
                    ends["there"] += 1
                    self.assertGreater(least, -1e-6)
                    self.assertGreater(area(*(points[i] for i in free)) * area(*(end[i] for i in free)), 0)
                    for joint, value in held.items():
                        self.assertAlmostEqual(angles[joint], value, delta=1e-9)
                else:
                    ends["refused"] += 1
                    self.assertEqual(code, 3)
                    self.assertRegex(said, "limit position|its joints stay closed up to")
                    self.assertLess(least, 1e-4)
        self.assertLessEqual(ends["no rest"], EACH // 8)
        return ends

    def test_one_joint_of_a_four_bar(self):
        ends = self.check(four_bar)
        self.assertTrue(ends["there"] and ends["refused"], ends)

    def test_a_crank_that_nearly_folds_a_loop(self):
        self.assertGreater(self.check(past_a_line)["there"], EACH // 2)

    def test_two_joints_of_a_five_bar_under_loads(self):
        ends = self.check(five_bar)
        self.assertTrue(ends["there"] and ends["refused"], ends)
        other = 0
        for _, points, _, free, model in self.members(five_bar):
            code, angles, _ = self.begin(model, {})
            if code == 0:
                end = self.placed(points, angles)
                other += area(*(points[i] for i in free)) * area(*(end[i] for i in free)) < 0
        self.assertGreater(other, 0, "no rest position is in another assembly: the family tries nothing")


if __name__ == "__main__":
    unittest.main()

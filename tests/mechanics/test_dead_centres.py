# SPDX-License-Identifier: GPL-3.0-or-later
"""Positions where joints depend on each other there only are refused by name; joints redundant everywhere are welcome."""
import math
import unittest

from common_mechanisms import Mechanism, MechanismTest, add, loop, seeded

EACH = 6  # mechanisms of a family, in the plane and in space


def polar(length, angle):
    return [length * math.cos(angle), length * math.sin(angle)]


def parallelogram(angle, a=0.5, b=1.0):
    tip = polar(a, angle)
    return loop([[0, 0], tip, add(tip, [b, 0]), [b, 0]])


# Families at a dead centre. Each: a mechanism from random numbers, and the joints that depend on each other.

def flat_parallelogram(r):
    return parallelogram(r.choice([0, math.pi]), r.uniform(0.3, 2), r.uniform(0.3, 2))


def flat_change_point(r):
    a, b, c = (r.uniform(0.3, 2) for _ in range(3))
    return loop([[0, 0], [a, 0], [a + b, 0], [a + b - c, 0]])


def flat_kite(r):
    a, b = r.uniform(0.3, 1), r.uniform(1.1, 2)
    return loop([[0, 0], [-a, 0], [b - a, 0], [-a, 0]])


def taut_chain(r):
    x, points = 0.0, [[0.0, 0.0]]
    for _ in range(r.randint(2, 5)):
        x += r.uniform(0.3, 2)
        points.append([x, 0.0])
    return loop(points)


def bead_between_ropes(r):
    m = Mechanism(2)
    m.body("bead", [0, 0])
    m.joint("left", "distance", "ground", "bead", ([-r.uniform(0.3, 2), 0], [0, 0]))
    m.joint("right", "distance", "ground", "bead", ([r.uniform(0.3, 2), 0], [0, 0]))
    m.springs = [{"name": "s", "type": "axial", "bodies": ["ground", "bead"], "at": [[0, 1], [0, 0]],
                  "stiffness_n_per_m": 10}]
    return m


def three_cranks_flat(r):
    a, b, c = (r.uniform(0.3, 2) for _ in range(3))
    m = parallelogram(0, a, b)
    m.body("b9", [c + a / 2, 0])
    m.joint("j8", "revolute", "ground", "b9", [c, 0])
    m.joint("j9", "revolute", "b1", "b9", [c + a, 0])
    return m


def ball_joint_parallelogram(r):
    flat = parallelogram(0, r.uniform(0.3, 2), r.uniform(0.3, 2)).in_space()
    flat.joints = [(n, "spherical" if n in ("j1", "j2") else k, b, p, None if n in ("j1", "j2") else x)
                   for n, k, b, p, x in flat.joints]
    return flat


def watt_with_a_guide(r):
    """Its point moves along a line to the third order: nothing to second order says that the guide stops it."""
    a, h = r.uniform(1, 2), r.uniform(0.3, 1)
    m = loop([[-a, h / 2], [0, h / 2], [0, -h / 2], [a, -h / 2]])
    m.joint("guide", "pin-in-slot", "ground", "b1", [0, 0], [0, 1])
    return m


DEAD = {"flat parallelogram": flat_parallelogram, "change point": flat_change_point, "flat kite": flat_kite,
        "taut chain": taut_chain, "bead between ropes": bead_between_ropes, "three cranks": three_cranks_flat}
DEAD_AS_THEY_ARE = {"ball joints": ball_joint_parallelogram, "third order": watt_with_a_guide}


# Families with redundant joints everywhere, or positions that only look singular.

def four_bar(r):
    while True:
        p = [[r.gauss(0, 1), r.gauss(0, 1)] for _ in range(4)]
        # not stretched: the coupler and one crank within 5 degrees of a line are another family's
        if all(abs(math.remainder(math.atan2(*add(p[i + 1], p[i], -1)) - math.atan2(*add(p[i + 2], p[i + 1], -1)),
                                  math.pi)) > 0.1 for i in range(2)):
            return loop(p)


def doubled_hinge(r):
    m = four_bar(r)
    m.joints.append(("again", *m.joints[r.randrange(4)][1:]))
    return m


def three_cranks(r):
    a, b, c, angle = r.uniform(0.3, 2), r.uniform(0.3, 2), r.uniform(0.3, 2), r.uniform(0.3, 2.8)
    m = parallelogram(angle, a, b)
    m.body("b9", add([c, 0], polar(a / 2, angle)))
    m.joint("j8", "revolute", "ground", "b9", [c, 0])
    m.joint("j9", "revolute", "b1", "b9", add([c, 0], polar(a, angle)))
    return m


def slider_crank_at_its_dead_centre(r):
    a, b, sign = r.uniform(0.3, 1), r.uniform(1.2, 2), r.choice([-1, 1])
    m = loop([[0, 0], [sign * a, 0], [sign * a + b, 0]])
    m.body("slider", [sign * a + b, 0])
    m.joints[-1] = ("j2", "revolute", ("b1", "slider"), [sign * a + b, 0], None)
    m.joint("guide", "prismatic", "ground", "slider", [sign * a + b, 0], [1, 0])
    return m


def stretched_four_bar(r):
    a, b = r.uniform(0.3, 0.6), r.uniform(1, 1.4)
    return loop([[0, 0], [a, 0], [a + b, 0], [1.2 + r.uniform(0, 0.2), r.uniform(0.5, 1)]])


def bennett(r):
    """Four hinges in space that move for a sin(beta) = b sin(alpha) alone."""
    while True:
        alpha, beta, a, theta = r.uniform(0.4, 1.2), r.uniform(0.3, 1.4), r.uniform(0.5, 1), r.uniform(0.5, 2.5)
        b = a * math.sin(beta) / math.sin(alpha)
        if abs(alpha - beta) > 0.05:
            break
    phi = 2 * math.atan(math.sin((beta + alpha) / 2) / math.sin((beta - alpha) / 2) / math.tan(theta / 2))
    frame = [[float(i == k) for k in range(4)] for i in range(4)]
    frames = [frame]
    for turn, length, twist in ((theta, a, alpha), (phi, b, beta), (-theta, a, alpha), (-phi, b, beta)):
        c, s, ct, st = math.cos(turn), math.sin(turn), math.cos(twist), math.sin(twist)
        link = [[c, -s * ct, s * st, length * c], [s, c * ct, -c * st, length * s], [0, st, ct, 0], [0, 0, 0, 1]]
        frame = [[sum(x * link[j][k] for j, x in enumerate(row)) for k in range(4)] for row in frame]
        frames.append(frame)
    assert all(abs(frame[i][k] - (i == k)) < 1e-9 for i in range(4) for k in range(4)), "does not close"
    m = Mechanism(3)
    place = [[f[k][3] for k in range(3)] for f in frames]
    for i in range(3):
        m.body(f"b{i}", [0.5 * x for x in add(place[i], place[i + 1])])
    for i in range(4):
        m.joint(f"j{i}", "revolute", "ground" if i == 0 else f"b{i - 1}", "ground" if i == 3 else f"b{i}", place[i],
                [frames[i][k][2] for k in range(3)])
    m.torsion("j0")
    return m


def sarrus(r):
    h, w, size = r.uniform(0.5, 1), r.uniform(0.3, 0.8), r.uniform(0.5, 1)
    m = Mechanism(3)
    m.body("top", [0, 0, 2 * h])
    for i, angle in enumerate([0, r.uniform(0.6, 2.5), r.uniform(3.2, 5)][:r.randint(2, 3)]):
        out, along = [*polar(1, angle), 0], [-math.sin(angle), math.cos(angle), 0]
        p = [add([0, 0, k * h], out, size + (w if k == 1 else 0)) for k in range(3)]
        m.body(f"low{i}", [0.5 * x for x in add(p[0], p[1])])
        m.body(f"high{i}", [0.5 * x for x in add(p[1], p[2])])
        m.joint(f"a{i}", "revolute", "ground", f"low{i}", p[0], along)
        m.joint(f"b{i}", "revolute", f"low{i}", f"high{i}", p[1], along)
        m.joint(f"c{i}", "revolute", f"high{i}", "top", p[2], along)
    m.torsion("a0")
    return m


GOOD = {"four-bar": four_bar, "doubled hinge": doubled_hinge, "three cranks": three_cranks,
        "slider-crank": slider_crank_at_its_dead_centre, "stretched four-bar": stretched_four_bar}
GOOD_AS_THEY_ARE = {"Bennett": bennett, "Sarrus": sarrus}


def members(plane, as_they_are, name):
    for i in range(EACH):
        for family, make in plane.items():
            r = seeded(name, family, i)
            flat = make(r)
            yield f"{family} {i}, plane", flat, r
            yield f"{family} {i}, space", flat.in_space(), r
        for family, make in as_they_are.items():
            r = seeded(name, family, i)
            yield f"{family} {i}", make(r), r


class DeadCentres(MechanismTest):
    def test_every_one_is_refused_with_the_names_of_its_joints(self):
        for label, m, r in members(DEAD, DEAD_AS_THEY_ARE, "dead"):
            with self.subTest(label):
                if r.random() < 0.3:  # a load changes nothing: no force can be computed either
                    m.more["gravity_m_per_s2"] = [0, -9.81] + [0] * (m.dimension - 2)
                done = self.run_on(m.model(r), "modes")
                self.assertEqual(done.returncode, 3, done.stdout)
                self.assertIn("dead centre: joints ", done.stderr)
                for name, *_ in m.joints:  # every joint of these has a part in it
                    self.assertIn(f'"{name}"', done.stderr)

    def test_joints_redundant_everywhere_are_welcome(self):
        for label, m, r in members(GOOD, GOOD_AS_THEY_ARE, "good"):
            with self.subTest(label):
                got = self.answer(m.model(r), "modes")
                self.assertEqual((got["freedoms"], len(got["modes"])), (1, 1))

    def test_all_commands_refuse(self):
        model = parallelogram(0).model()
        model["parameters"] = {"k": 10.0}
        model["springs"][0]["stiffness_n_m_per_rad"] = "k"
        for command, *args in (("modes",), ("info",), ("sensitivity",), ("sweep", "--drive", "j0=0:0.5:3")):
            with self.subTest(command):
                done = self.run_on(model, command, *args)
                self.assertEqual(done.returncode, 3)
                self.assertIn('dead centre: joints "j0", "j1", "j2", "j3" become dependent', done.stderr)

    def test_the_frequency_stays_right_up_to_the_refusal(self):
        # both cranks turn about their ends, the coupler is carried along: the same inertia at every angle
        right = math.sqrt(10 / (2 * (0.02 + 0.0625) + 0.25)) / (2 * math.pi)
        for space in (False, True):
            for exponent in range(1, 7):
                m = parallelogram(10.0**-exponent)
                got = self.answer((m.in_space() if space else m).model(), "modes")["modes"]
                # 1e-16 of the drawing, seen from 10^-exponent of the dead centre
                self.assertAlmostEqual(got[0]["frequency_hz"] / right, 1, delta=1e-15 * 10**exponent + 1e-13)
            for angle in (1e-8, 1e-10, 1e-14):
                m = parallelogram(angle)
                self.assertEqual(self.run_on((m.in_space() if space else m).model(), "modes").returncode, 3)

    def test_info_and_sweep_say_how_near_one_is(self):
        self.assertIsNone(self.answer(parallelogram(1).model(), "info")["dead_centre"])
        for angle in (0.03, 1e-2, 1e-4, 1e-6):
            near = self.answer(parallelogram(angle).model(), "info")["dead_centre"]
            self.assertEqual(near["joints"], ["j0", "j1", "j2", "j3"])
            self.assertTrue(0.5 < near["distance"] / angle < 2, near)
        self.assertIn("near a dead centre: about", self.run_on(parallelogram(0.01).model(), "info").stdout)
        for angle in (1e-3, 1e-4, 1e-5):  # with the crank held there, the others must move 6.6 times as far
            points = self.answer(parallelogram(1).model(), "sweep", "--drive", f"j0={angle - 1}:0:2")["points"]
            self.assertAlmostEqual(points[0]["dead_centre"]["distance"] / angle, 6.617, delta=0.01)
            self.assertEqual(points[0]["dead_centre"]["joints"], ["j0", "j1", "j2", "j3"])
            self.assertIsNone(points[1]["dead_centre"])
        text = self.run_on(parallelogram(1).model(), "sweep", "--drive", "j0=-0.999:0:2").stdout
        self.assertIn("Near a dead centre at -0.999", text)

    def test_a_sweep_through_one_says_so_there_and_goes_on(self):
        for space in (False, True):
            m = parallelogram(1)
            model = (m.in_space() if space else m).model()
            for more in ((), ("--frequencies",)):
                points = self.answer(model, "sweep", "--drive", "j0=-1.5:0:16", *more, code=3)["points"]
                wrong = [p["position_rad"] for p in points if "error" in p]
                self.assertEqual(wrong, [-1.0])
                self.assertIn('joint "j0" at -1 rad: dead centre', [p["error"] for p in points if "error" in p][0])
                for p in points:  # on the branch of the drawing: the cranks stay parallel
                    for joint in p.get("joints", []):
                        self.assertAlmostEqual(abs(joint["ratio"]), 1, delta=1e-9)

    def test_tilted_axes_are_no_dead_centre(self):
        m = loop([[0, 0], polar(0.5, 1), add(polar(0.5, 1), [1, 0]), [1.2, 0]]).in_space()
        for tilt in (1e-12, 1e-10, 1e-8, 1e-6, 1e-5, 1e-4, 1e-2):
            m.joints[1] = (*m.joints[1][:4], [tilt, 0.3 * tilt, 1.0])
            got = self.answer(m.model(), "info")
            self.assertIsNone(got["dead_centre"])
            self.assertEqual(got["freedoms"], 1 if tilt < 1e-9 else 0)


if __name__ == "__main__":
    unittest.main()

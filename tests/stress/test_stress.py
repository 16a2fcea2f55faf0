# SPDX-License-Identifier: GPL-3.0-or-later
"""Some models of every family (run.py), and errors that must be found in what the program answers. MT_EVERY=1: more of them, and
larger ones."""
import json
import random
import tempfile
import unittest
from decimal import Decimal

import run  # first: it says where the others are
import extremes  # noqa: E402
import hanging  # noqa: E402
from campaign import Tally, hold  # noqa: E402
from campaign import run as judged  # noqa: E402
from suite import EVERY, FEW, INSTRUMENTED  # noqa: E402

COUNT = 4 if EVERY else 1 if FEW else 2  # of each family


def slide(beside):
    """A body on a slide that a rod across it holds, the rod so much out of the perpendicular."""
    return extremes.plain(2, [extremes.solid("b", 1.0, 0.25, [0.0, 0.0])],
                          [extremes.joint("g", "prismatic", "ground", "b", [0.0, 0.0], axis=[1, 0]), extremes.joint("rod", "distance", "ground", "b", [[beside, 1.0], [0.0, 0.0]])])


class Stress(unittest.TestCase):
    def sound(self, seed, family, indices, tally=None, far=None):
        """These models of a family have no finding."""
        tally = Tally() if tally is None else tally
        self.assertEqual(list(judged(run.Stress(far), seed, [(family, index) for index in indices], tally)), [])
        return tally

    def test_families(self):
        tally = hold(self, run.Stress(), "1", run.Stress().todo(run.FAMILIES, COUNT))
        print("\n".join(run.Stress().table(tally)))
        for row in (tally[name] for name in run.FAMILIES):
            if COUNT > 2:  # of two either may ask what the data do not determine, or what the reference does not find
                self.assertGreater(row.cases, row.left, row.name)
                self.assertGreater(row.determined, 0, row.name)
            else:
                self.assertGreater(row.cases, 0, row.name)

    def test_bounds_count_what_the_constraints_leave_open(self):
        """Two ropes that are almost parallel: the circle that they leave is known to rounding over their angle."""
        self.sound("1", "nearly redundant joints", [15, 64, 111])

    def test_forces_are_those_of_the_balance(self):
        """Stiff springs under a little load: their forces are lost in the rounding of the position, and found by what is unbalanced there."""
        self.sound("f", "heavy on stiff feet", [18] if FEW else [18, 43], far=1.0)

    def test_places_of_rest_are_known_to_the_rounding_of_lengths(self):
        """A stiff spring with a short lever under load: what rounding of its length turns its body by changes the lever."""
        self.sound("fin2", "heavy on stiff feet", [5], far=1.0)
        self.sound("1", "short levers", [5, 29, 32, 42], far=1.0)

    def test_what_is_drawn_at_rest_stays_there(self):
        """Columns short of their critical load by next to nothing, or beyond it: rounding of the balance, over the stiffness that is left, leads nowhere."""
        tally = self.sound("g", "nearly buckled", range(20), self.sound("c1", "nearly buckled", [46, 111]))
        self.assertEqual(tally["nearly buckled"].left, 0)

    def test_what_is_0_in_decimals_is_not_told_from_it(self):
        """A slide that a rod holds at its dead centre but for 4e-17 of the axis as it is read; a spring that is straight across a slot but for as much."""
        tally = self.sound("zz", "both", [22])
        self.sound("1795386040.2", "nanometres to kilometres", [5])
        self.assertEqual((tally["left out"], tally["refused as undetermined"]), (1, 1))

    def test_slides_beside_their_dead_centre_are_refused_next_to_it_only(self):
        """Beside it by 2^-k: an answer down to 2^-20, a refusal from 2^-30 on, and what is refused is not determined."""
        for k in (0, 10, 20, 30, 50):
            model = slide(2.0 ** -k if k < 50 else 0.0)
            with self.subTest(k=k), tempfile.TemporaryDirectory() as folder:
                done, _ = run.ask(folder, model)
                self.assertEqual(done.returncode, 0 if k < 30 else 3, done.stderr)
                if k < 30:
                    self.assertEqual(json.loads(done.stdout)[0]["freedoms"], 0)
                else:
                    self.assertIn("dead centre", done.stderr)

    def test_springs_beyond_the_freedoms(self):
        """They hold each other: what Householder's method leaves in the stiff ones counts beside the soft ones."""
        tally = self.sound("fin7", "redundant springs", [6], self.sound("q1", "redundant springs", [6]))
        self.assertLess(tally["redundant springs"].share, 0.2)  # the second one, by elimination, whatever the springs: 0.32

    def test_bounds_follow_from_energies(self):
        """Errors and bounds of what the data determine, of springs and masses far apart: a thousand times as good where quotients of energies are taken."""
        for family in ("stiffnesses 1:1e12", "masses 1:1e9", "both", "slender beams"):
            row = self.sound("q1", family, range(6 if EVERY else 1 if FEW else 2))[family]
            self.assertLess(row.told, 1e-11, row.name)
            self.assertLess(row.error, 1e-13, row.name)

    @unittest.skipUnless(EVERY or INSTRUMENTED, "three seconds of the reference")
    def test_long_stacks_keep_their_modes(self):
        """Rods with a short way from the end of a long arm pass on what the platform above does, enlarged and turned: bounds that grew with each step made 87 of 90 modes free."""
        self.assertLess(self.sound("3", "hanging stacks", [3])["hanging stacks"].told, 1e-5)

    def test_many_equal_modes_of_a_tree_are_all_found(self):
        """Arms on a hub: 120 equal ones; 104 that almost are; in groups of twenty, of which the errors add up."""
        self.sound("2", "large stars", [0, 12, 11, 3])


@unittest.skipIf(INSTRUMENTED, "judges the reference, not the program")
class Faults(unittest.TestCase):
    """Wrong answers are told from right ones."""

    def setUp(self):
        rng = random.Random("faults")
        model = run.FAMILIES["soft ground"](rng, 1.0)
        self.exact = run.Exact(model, rng)
        with tempfile.TemporaryDirectory() as folder:
            self.said = json.loads(run.ask(folder, model)[0].stdout)[0]

    def _found(self):
        return {check for check, _ in run.judge(run.Row("fault"), self.exact, self.said)}

    def test_right(self):
        self.assertEqual(self._found(), set())

    def test_wrong_eigenvalue(self):
        self.said["modes"][0]["omega_squared"] *= 1 + 1e-9
        self.assertEqual(self._found(), {"accuracy", "bound"})

    def test_bound_too_small(self):
        for mode in self.said["modes"]:
            mode["omega_squared_error"] = 0.0
        self.assertEqual(self._found(), {"bound"})

    def test_wrong_kind(self):
        self.said["modes"][0]["kind"] = "rigid_body"
        self.assertEqual(self._found(), {"kind"})

    def test_wrong_kind_of_what_the_data_leave_open(self):
        """Sixteen roundings may make it 0: nothing is said of its kind, but of its bound."""
        self.exact.condition[0] = 2 / (run.ROUNDINGS * run.UNIT)
        self.said["modes"][0].update(kind="rigid_body", omega_squared=0.0, omega_squared_error=2 * float(self.exact.values[0]))
        self.assertEqual(self._found(), set())

    def test_undecided(self):
        self.said["modes"][0]["kind"] = "undecided"
        self.assertEqual(self._found(), {"undecided"})

    def test_wrong_count(self):
        self.said["freedoms"] += 1
        self.assertEqual(self._found(), {"counts"})


@unittest.skipIf(INSTRUMENTED, "judges the reference, not the program")
class HangingFaults(unittest.TestCase):
    """Wrong answers of what hangs are told from right ones."""

    def setUp(self):
        model = hanging.stack(random.Random("faults"), 0.0)
        self.exact = run.Hanging(model)
        with tempfile.TemporaryDirectory() as folder:
            self.said = json.loads(run.ask(folder, model)[0].stdout)[0]

    def _found(self):
        return {check for check, _ in self.exact.judge(run.Row("fault"), self.said)}

    def test_right(self):
        self.assertEqual(self._found(), set())

    def test_wrong_eigenvalue(self):
        self.said["modes"][0]["omega_squared"] *= 1 + 1e-6
        self.assertEqual(self._found(), {"bound"})

    def test_a_mode_in_anothers_place(self):
        self.said["modes"][0] = self.said["modes"][1]
        self.assertEqual(self._found(), {"bound"})

    def test_bound_too_small(self):
        for mode in self.said["modes"]:
            mode["omega_squared_error"] = 1e-40
        self.assertEqual(self._found(), {"bound"})

    def test_wrong_kind(self):
        self.said["modes"][0]["kind"] = "undecided"
        self.assertEqual(self._found(), {"kind"})

    def test_wrong_count(self):
        self.said["rigid_body_modes"] += 1
        self.assertEqual(self._found(), {"counts"})


@unittest.skipIf(INSTRUMENTED, "judges the reference, not the program")
class Reference(unittest.TestCase):
    """Sturm's count of a row of masses against the mechanics in eighty digits, and the condition where it is known."""

    def test_chain(self):
        rng = random.Random("chain")
        name = lambda i: f"b{i}" if i else "ground"
        model = extremes.plain(2, [extremes.point(name(i + 1), 1.0 + i, [i + 1.0, 0.0]) for i in range(6)],
                               [extremes.joint(f"g{i}", "pin-in-slot", "ground", name(i + 1), [i + 1.0, 0.0], axis=[1, 0]) for i in range(6)],
                               [extremes.axial(f"s{i}", name(i), name(i + 1), [[float(i), 0.0], [i + 1.0, 0.0]], 10.0 ** (2 * i)) for i in range(6)])
        for a, b in zip(run.Chain(model).values, run.Exact(model, rng).values):
            self.assertLess(abs(a / b - 1), 1e-18)

    def test_hanging_chain(self):
        """n equal masses l apart: g / l times the zeros of the Laguerre polynomial L_n, of which as many are below x as L_0(x) ... L_n(x) change their sign."""
        n, length = 12, Decimal(2)
        plane = hanging.Plane([(Decimal(3), Decimal(0), [Decimal(0), -length * (i + 1)]) for i in range(n)],
                              [{"kind": "revolute", "on": [i - 1 if i else None, i], "at": [[Decimal(0), -length * i]] * 2} for i in range(n)])
        counts = set()
        for k in range(1, 200):
            x = Decimal(7 * k + 3) / 37
            values = [Decimal(1), 1 - x]
            for i in range(1, n):
                values.append(((2 * i + 1 - x) * values[i] - i * values[i - 1]) / (i + 1))
            changes = sum(a * b < 0 for a, b in zip(values, values[1:]))
            counts.add(changes)
            self.assertEqual(plane.below(x * run.binary(hanging.G) / length), changes, x)
        self.assertEqual(counts, set(range(1, n + 1)))

    def test_hanging_rope(self):
        """The same chain with its masses on distances in place of bodies that turn."""
        n = 8
        chain, rope = [hanging.Plane([(Decimal(1 + i), inertia, [Decimal(0), -Decimal(i + 1)]) for i in range(n)],
                                     [{"kind": kind, "on": [i - 1 if i else None, i], "at": [[Decimal(0), -Decimal(i)], [Decimal(0), -Decimal(i + low)]]} for i in range(n)])
                       for kind, low, inertia in (("revolute", 0, Decimal(0)), ("distance", 1, Decimal(1)))]
        self.assertEqual(chain.freedoms + n, rope.freedoms)  # spins on their points are free
        for k in range(1, 60):
            x = Decimal(k * k) / 40
            self.assertEqual(chain.below(x) + n, rope.below(x), x)

    def test_condition_of_joints(self):
        """The slide's rod holds it by the sine of its angle, whose square the volume is: 2 over the sine, of what each coordinate is changed by."""
        for k in (5, 20, 40):
            opened = max(run.Exact(slide(2.0 ** -k), random.Random(str(i))).open() for i in range(5))
            self.assertTrue(2 ** k / 4 < opened < 8 * 2 ** k, opened)

    def test_condition(self):
        """omega^2 = (k - m g l)/(J + m l^2): of k - m g l = 2^-20 k each half is known to a unit."""
        pendulum = extremes.plain(2, [extremes.solid("b", 1.0, 0.25, [0.0, 1.0])], [extremes.joint("j", "revolute", "ground", "b", [0.0, 0.0])],
                                  [extremes.torsion("s", "j", 8.0 * (1 + 2.0 ** -20))], gravity_m_per_s2=[0, -8.0])
        condition = max(run.Exact(pendulum, random.Random(str(i))).condition[0] for i in range(5))
        self.assertTrue(2 ** 20 < condition < 6 * 2 ** 20, condition)


if __name__ == "__main__":
    unittest.main()

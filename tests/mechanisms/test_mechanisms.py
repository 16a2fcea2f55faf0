# SPDX-License-Identifier: GPL-3.0-or-later
"""Random mechanisms in the suite: saved cases, faults that must be found, and one of each kind of a fixed seed, in a plane or
in space (MT_EVERY=1: both)."""
import functools
import random
import tempfile
import unittest
from decimal import Decimal
from pathlib import Path

import exact
import ring
import run
import statics
from campaign import hold, hold_saved
from faults import DAMPING_FAULTS, FAULTS, RINGING_FAULTS
from suite import FEW, INSTRUMENTED

SEED = "1"
COUNT = 1  # of each kind; run.py draws more, of fresh seeds
TRIED = 4 if FEW else 10  # mechanisms that each fault is planted in; `least` is of ten
# In turn the one in a plane and the one in space of two kinds that differ in that alone.
TWINS = [name for name in run.KINDS if name.endswith("2") and name[:-1] + "3" in run.KINDS]
LEFT_OUT = {name if place % 2 else name[:-1] + "3" for place, name in enumerate(TWINS)} if FEW else set()
if FEW:
    ring.SPREAD = 20  # three motions of stiffer ones are half of the time; .every lets them ring, too
CASES = Path(__file__).resolve().parent / "cases"
G = 9.81


@unittest.skipIf(INSTRUMENTED, "judges the hunt, not the program")
class Oracle(unittest.TestCase):
    """What the oracle finds where the answer is known."""

    def _hz(self, model):
        return [float(x) for x in statics.modes({"format": "modetune-model/1", **model}).hz()]

    def test_arithmetic(self):
        s, c = exact.sine_cosine(exact.PI / 6)
        self.assertLess(abs(s - Decimal("0.5")), Decimal("1e-76"))
        self.assertLess(abs(exact.angle(s, c) - exact.PI / 6), Decimal("1e-70"))
        f, first, second = exact.angle_over_sine(c)
        self.assertLess(abs(f - exact.PI / 3), Decimal("1e-70"))
        near = [exact.angle_over_sine(c + h * Decimal("1e-25"))[0] for h in (-1, 0, 1)]
        self.assertLess(abs((near[2] - near[0]) / Decimal("2e-25") - first), Decimal("1e-45"))
        self.assertLess(abs((near[2] - 2 * near[1] + near[0]) / Decimal("1e-50") - second), Decimal("1e-20"))

    def test_hanging_rod(self):
        rod = {"dimension": 2, "gravity_m_per_s2": [0, -G], "bodies": [{"name": "b", "mass_kg": 2, "inertia_kg_m2": 0.5, "centre": [0.6, -0.8]}],
               "joints": [{"name": "j", "type": "revolute", "bodies": ["ground", "b"], "at": [0, 0]}]}
        self.assertAlmostEqual(self._hz(rod)[0], (2 * G * 1 / (0.5 + 2)) ** 0.5 / (2 * float(exact.PI)), places=14)

    def test_tensioned_bead(self):
        """Across a string: 2 T/l; along it 2 k."""
        bead = {"dimension": 3, "bodies": [{"name": "b", "mass_kg": 0.1, "centre": [0, 0, 0]}],
                "springs": [{"name": f"s{x}", "type": "axial", "bodies": ["ground", "b"], "at": [[x, 0, 0], [0, 0, 0]], "stiffness_n_per_m": 500,
                             "preload_n": 8} for x in (-2, 2)]}
        expected = [(k / 0.1) ** 0.5 / (2 * float(exact.PI)) for k in (8, 8, 1000)]
        for a, b in zip(self._hz(bead), expected):
            self.assertAlmostEqual(a, b, places=13)

    def test_spinning_freedoms(self):
        """A body in space on a ball joint and a bushing that only turns: three vibrations, nothing else; without it three free motions."""
        body = {"dimension": 3, "bodies": [{"name": "b", "mass_kg": 1, "inertia_kg_m2": [0.2, 0.3, 0.4], "centre": [0, 0, 0]}],
                "joints": [{"name": "j", "type": "spherical", "bodies": ["ground", "b"], "at": [0, 0, 0]}]}
        self.assertEqual(statics.modes(body).counts(), {"freedoms": 3, "rigid": 3, "unstable": 0})
        body["springs"] = [{"name": "s", "type": "bushing", "bodies": ["ground", "b"], "at": [0, 0, 0], "stiffness_n_per_m": [1, 1, 1],
                            "stiffness_n_m_per_rad": [20, 90, 40]}]
        for a, k in zip(self._hz(body), (100, 100, 300)):
            self.assertAlmostEqual(a, k ** 0.5 / (2 * float(exact.PI)), places=13)


def made(kind, index):
    return run.KINDS[kind](random.Random(f"faults:{index}"))


@functools.cache
def sound(kind, index):
    """The mechanism that faults are planted in; None where what the program says of it is not what it is."""
    with tempfile.TemporaryDirectory() as folder:
        case = run.Judgement(Path(folder), "fault", None, made(kind, index))
        return None if list(case.agree(run.Answer(Path(folder), "sound", case.model))) else case


class Cases(unittest.TestCase):
    """What was once found. A case is one file {"holds": why it is here, "model": ...}."""

    def test_cases(self):
        hold_saved(self, run.Mechanisms(), CASES, 2 if FEW else 1)


@unittest.skipIf(INSTRUMENTED, "judges the hunt, not the program")
class Faults(unittest.TestCase):
    def test_faults_are_found(self):
        for plant, kinds, least in FAULTS:
            with self.subTest(fault=plant.__name__), tempfile.TemporaryDirectory() as folder:
                self.assertGreaterEqual(self._found(Path(folder), plant, kinds), least * TRIED // 10)

    def test_faults_of_damping_are_found(self):
        for plant, least in DAMPING_FAULTS:
            with self.subTest(fault=plant.__name__), tempfile.TemporaryDirectory() as folder:
                self.assertGreaterEqual(self._damped(Path(folder), plant), least * TRIED // 10)

    def test_faults_of_motions_are_found(self):
        for plant in RINGING_FAULTS:
            with self.subTest(fault=plant.__name__), tempfile.TemporaryDirectory() as folder:
                tried = found = 0
                for index in range(3 if FEW else 6):
                    case = run.Judgement(Path(folder), "free2", random.Random(f"ring:{index}"), made("loaded2", index))
                    answer = run.Answer(Path(folder), "as_made", case.model)
                    wrong = list(case.ringing(answer, plant)) if not answer.code else []
                    tried, found = tried + (case.tones > 0), found + bool(wrong)
                self.assertGreater(tried, 1)
                self.assertEqual(found, tried)

    def _damped(self, folder, plant, of=TRIED):
        tried, found, index = [], 0, 0
        while len(tried) < of:
            self.assertLess(index, 100, "the fault has no place in these mechanisms")
            kind = ("loaded2", "loaded3")[index % 2]
            case = run.Judgement(folder, kind, random.Random(f"damped:{index}"), made(kind, index))
            index += 1
            found += bool(list(case.damping(lambda model: plant(model) and tried.append(model) is None)))
        return found

    def _found(self, folder, plant, kinds, of=TRIED):
        tried = found = index = 0
        while tried < of:
            self.assertLess(index, 100, "the fault has no place in these mechanisms")
            place = kinds[index % len(kinds)], index
            faulty = made(*place)
            index += 1
            if not plant(faulty) or sound(*place) is None:
                continue
            tried += 1
            found += bool(list(sound(*place).agree(run.Answer(folder, "faulty", faulty))))
        return found


class Mechanisms(unittest.TestCase):
    def test_random_mechanisms(self):
        tally = hold(self, run.Mechanisms(), SEED, [(kind, index) for index in range(COUNT) for kind in run.KINDS if kind not in LEFT_OUT])
        self.assertLess(tally["left out"], max(2, tally["mechanisms"] // 20))


if __name__ == "__main__":
    unittest.main()

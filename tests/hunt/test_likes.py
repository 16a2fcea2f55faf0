# SPDX-License-Identifier: GPL-3.0-or-later
"""`like`, `repeat` and `include` in the suite: models of a fixed seed, and faults that must be found."""
import tempfile
import unittest
from pathlib import Path

import likes
from campaign import Tally, hold
from suite import EVERY, INSTRUMENTED

COUNT = 20 if EVERY else 4


def _forget(member):
    """Where nothing was given for what a configuration is like, nothing is lost: the fault has no place there."""
    def plant(full):
        has = [c for c in full["configurations"].values() if member in c]
        for c in has:
            del c[member]
        return bool(has)
    plant.__name__ = f"forgets_{member}"
    return plant


def item_lost(full):
    where = [s["in"] for s in full["springs"] if len(s.get("in", [])) > 1]
    for names in where:
        names.pop()
    return bool(where)


class Likes(unittest.TestCase):
    def test_chains(self):
        hold(self, likes.Likes(), "suite", likes.Likes().todo(["like"], COUNT))

    def test_repeats(self):
        hold(self, likes.Likes(), "suite", likes.Likes().todo(["repeat"], 10 * COUNT))

    @unittest.skipIf(INSTRUMENTED, "judges the hunt, not the program")
    def test_faults_are_found(self):
        for plant in (*(_forget(m) for m in ("parameters", *likes.WHOLE)), item_lost):
            with self.subTest(fault=plant.__name__):
                self.assertTrue(any(self._found(plant, index) for index in range(3)))

    def _found(self, plant, index):
        case = likes.Likes().make("faults", "like", index)
        with tempfile.TemporaryDirectory() as folder:
            return plant(case.document["full"]) and list(likes.Likes().judge(case, Path(folder), Tally()))


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""`like` in the suite: chains of configurations of a fixed seed, and faults that must be found."""
import os
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import likes  # noqa: E402

COUNT = 20 if "MT_EVERY" in os.environ else 4


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
        with tempfile.TemporaryDirectory() as folder:
            for index in range(COUNT):
                with self.subTest(index=index):
                    self.assertEqual(list(likes.findings(Path(folder), index, "suite")), [])

    @unittest.skipIf("MT_INSTRUMENTED" in os.environ, "judges the hunt, not the program")
    def test_faults_are_found(self):
        for plant in (*(_forget(m) for m in ("parameters", *likes.WHOLE)), item_lost):
            with self.subTest(fault=plant.__name__), tempfile.TemporaryDirectory() as folder:
                self.assertTrue(any(list(likes.findings(Path(folder), index, "faults", plant)) for index in range(3)))


if __name__ == "__main__":
    unittest.main()

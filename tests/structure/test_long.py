# SPDX-License-Identifier: GPL-3.0-or-later
"""
What `./bootstrap test` leaves out is known: the tests with the label "long" (tests/CMakeLists.txt: long_tests, and every_tests with
".every" behind their names, which alone stand for those in both) are the rows of the table in tests/README.md, each with the defect that only it would find.
"""
import os
import re
import unittest
from pathlib import Path

TREE = Path(os.environ["SOURCE_DIR"])
ROW = re.compile(r"^\| `(\w+/test_\w+(?:\.every)?)` \| ([^|]+) \|$", re.M)


def listed(text, name):
    """The words of a list of CMake."""
    found = re.search(rf"^set\({name}\b([^)]*)\)", text, re.M)
    return [word for line in found[1].split("\n") for word in line.split("#")[0].split()]


class Long(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cmake = (TREE / "tests/CMakeLists.txt").read_text(encoding="utf-8")
        cls.whole = listed(cmake, "long_tests")
        cls.every = listed(cmake, "every_tests")
        cls.rows = ROW.findall((TREE / "tests/README.md").read_text(encoding="utf-8"))

    def test_the_table_has_all_that_is_left_out(self):
        self.assertGreater(len(self.whole) + len(self.every), 0)
        whole = [name for name in self.whole if name not in self.every]
        self.assertEqual(sorted(name for name, _ in self.rows), sorted(whole + [name + ".every" for name in self.every]))
        for name, defect in self.rows:
            self.assertGreater(len(defect.split()), 5, name)

    def test_each_is_a_test_that_is_there(self):
        for name in self.whole + self.every:
            self.assertTrue(any((TREE / "tests" / (name + ending)).is_file() for ending in (".c", ".py", ".sh")), name)

    def test_what_looks_at_a_sample_reads_the_switch(self):
        """Itself, or a file of its folder that scripts share."""
        for name in self.every:
            path = TREE / "tests" / name
            texts = [p.read_text(encoding="utf-8") for p in path.parent.glob("*.py")] if path.with_suffix(".py").is_file() else [
                path.with_suffix(".c").read_text(encoding="utf-8")]
            self.assertTrue(any(re.search(r"\b(MT_)?EVERY\b|\bFEW\b|\bcount\(.*every=", text) for text in texts), name)


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""What .ci/run shows of a step that failed: each failed test with its assertion and how to run it alone, in less than thirty lines."""
import os
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(os.environ["SOURCE_DIR"]) / ".ci"))
sys.dont_write_bytecode = True
from failures import MOST, told  # noqa: E402

PASSED = " 1/9 Test   #4: expr/test_parse ................   Passed    0.02 sec\n        Start   5: modal/test_modes\n"
FAILED = """ {n}/9 Test   #{n}: modal/test_{name} ................***Failed    0.02 sec
[==========] Running 2 test(s).
[ RUN      ] modal__first
[       OK ] modal__first
[ RUN      ] modal__second
{many}tests/modal/test_{name}.c:77: row 3: error 2.000e-03 is not below 1.000e-09
[  FAILED  ] modal__second

        Start   6: modal/test_next
"""
END = """
78% tests passed, 2 tests failed out of 9

The following tests FAILED:
        5 - modal/test_a (Failed)
"""


class Failures(unittest.TestCase):
    def test_a_failed_test_is_named_with_its_assertion_and_its_command(self):
        lines = told(PASSED + FAILED.format(n=5, name="a", many="noise\n" * 500) + END, "memcheck")
        text = "\n".join(lines)
        self.assertIn("modal/test_a: Failed 0.02 sec", lines)
        self.assertIn("test_a.c:77: row 3: error 2.000e-03 is not below 1.000e-09", text)
        self.assertIn("again: ONLY='^modal/test_a$' .ci/run memcheck", text)
        self.assertNotIn("expr/test_parse", text)
        self.assertNotIn("noise", text)

    def test_many_are_all_named(self):
        names = [chr(97 + k) for k in range(9)]
        lines = told("".join(FAILED.format(n=k, name=name, many="") for k, name in enumerate(names)) + END, "quick")
        self.assertLessEqual(len(lines), MOST + 1)
        for name in names:
            self.assertIn(f"modal/test_{name}", "\n".join(lines))

    def test_any_other_log_ends_the_message(self):
        lines = told("".join(f"line {i}\n" for i in range(1000)), "tidy")
        self.assertEqual(lines[-1], "line 999")
        self.assertLess(len(lines), 30)


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""Large models are read and checked in time in proportion to their size. No time is measured: a million elements take hours where
time goes with the square of the size."""
import json
import os
import sys

from common_cli import SOURCE, CliTest, main

sys.path.insert(0, str(SOURCE / "tests/support"))
import large  # noqa: E402

PARTS = 3000 if "MT_INSTRUMENTED" in os.environ else 30000  # written out
ELEMENTS = 1000000  # the most that a link may have


class Large(CliTest):
    def model_of(self, kind, n):
        return self.write(f"{kind}{n}.json", json.dumps(large.KINDS[kind](n)))

    def test_many_parts_are_checked(self):
        for kind in ("chain", "points"):
            done = self.expect(0, "check", self.model_of(kind, PARTS))
            self.assertIn("ok (model)", done.stdout)

    def test_a_million_elements_are_checked(self):
        for kind in ("link", "beam"):
            done = self.expect(0, "check", self.model_of(kind, ELEMENTS))
            self.assertIn("ok (model)", done.stdout)
            done = self.expect(2, "check", self.model_of(kind, ELEMENTS + 1))
            self.assertIn(f"/links/0/elements: must be a whole number from 1 to {ELEMENTS}", done.stderr)


if __name__ == "__main__":
    main()

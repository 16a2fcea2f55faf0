# SPDX-License-Identifier: GPL-3.0-or-later
"""Data in pages are packed (report/page.h) and say the same: read back they are the result, and what `show` draws. What is drawn of an inceptor
takes seconds: MT_EVERY=1 looks at these, too."""
import json
import subprocess
import sys
import unittest
from pathlib import Path

from common_pack import data

sys.path.append(str(Path(__file__).resolve().parents[1] / "support"))
from suite import EVERY  # noqa: E402
from answers import PROGRAM, SOURCE, answer  # noqa: E402

STUDIES = ("inceptor_catalogue", "inceptor_tuning_1", "beam_identification", "six_masses_bands", "truss_10bar_E68_9")
SHOWN = STUDIES if EVERY else STUDIES[2:]
DRIVEN = "tests/models/four_bar.json"
MOST_SHOW, MOST_REPORT = 300_000, 560_000  # bytes of pages, of these studies


class Pack(unittest.TestCase):
    def run_program(self, *arguments):
        return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=True).stdout

    def drawn(self, file):
        show = self.run_program("show", file)
        self.assertEqual(data(show, "scene"), json.loads(self.run_program("show", "--format", "json", file)))
        self.assertLess(len(show), MOST_SHOW)

    def test_pages_say_what_their_results_say(self):
        for study in STUDIES:
            with self.subTest(study):
                folder = answer(SOURCE / f"studies/{study}.json").folder
                result = json.loads((folder / "result.json").read_text(encoding="utf-8"))
                page = (folder / "report.html").read_text(encoding="utf-8")
                got = data(page, "data")
                result["run"]["outputs"] = got["run"]["outputs"] = []  # the page is one of them
                self.assertEqual(got, result)
                self.assertLess(len(page), MOST_REPORT)
                if study in SHOWN:
                    self.drawn(folder / "result.json")

    def test_pages_of_driven_models_say_what_is_drawn(self):
        self.drawn(SOURCE / DRIVEN)


if __name__ == "__main__":
    unittest.main()

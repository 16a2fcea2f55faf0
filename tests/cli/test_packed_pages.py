# SPDX-License-Identifier: GPL-3.0-or-later
"""Data in pages are packed (report/pack.h) and say the same: read back they are the result, and what `show` draws."""
import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

from common_pack import data

SOURCE, MODETUNE = Path(os.environ["SOURCE_DIR"]), os.environ["MODETUNE"]
STUDIES = ("inceptor_catalogue", "inceptor_tuning_1", "beam_identification", "six_masses_bands", "truss_10bar_E68_9")
MOST_SHOW, MOST_REPORT = 300_000, 560_000  # bytes of pages, of these studies


class Pack(unittest.TestCase):
    def run_program(self, *arguments):
        return subprocess.run([MODETUNE, *map(str, arguments)], capture_output=True, text=True, check=True).stdout

    def test_pages_say_what_their_results_say(self):
        with tempfile.TemporaryDirectory() as name:
            for study in STUDIES:
                with self.subTest(study):
                    self.run_program("run", "--quiet", "-o", name, SOURCE / f"studies/{study}.json")
                    folder = Path(name) / study
                    result = json.loads((folder / "result.json").read_text(encoding="utf-8"))
                    page = (folder / "report.html").read_text(encoding="utf-8")
                    got = data(page, "data")
                    result["run"]["outputs"] = got["run"]["outputs"] = []  # the page is one of them
                    self.assertEqual(got, result)
                    show = self.run_program("show", folder / "result.json")
                    self.assertEqual(data(show, "scene"), json.loads(self.run_program("show", "--format", "json", folder / "result.json")))
                    self.assertLess(len(show), MOST_SHOW)
                    self.assertLess(len(page), MOST_REPORT)


if __name__ == "__main__":
    unittest.main()

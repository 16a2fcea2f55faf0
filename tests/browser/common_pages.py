# SPDX-License-Identifier: GPL-3.0-or-later
"""What tests of pages share: the program, the shipped studies and their answers, made once."""
import json
import os
import subprocess
import tempfile
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from browser import Browser

SOURCE = Path(os.environ.get("SOURCE_DIR", Path(__file__).resolve().parents[2]))
PROGRAM = os.environ.get("MODETUNE", str(SOURCE / "build/release/modetune"))
STUDIES = sorted((SOURCE / "studies").glob("*.json"))
SIZES = [(390, 844), (1280, 900), (1920, 1080)]
EVERY = "MT_EVERY" in os.environ


def run(study, folder, *more):
    """The folder of its result; a study that is not solved has one, too."""
    subprocess.run([PROGRAM, "run", study, "--quiet", "-o", folder, *more], capture_output=True, timeout=300, check=False)
    return folder / study.stem


class Answers(unittest.TestCase):
    """A browser and the reports of studies, by their names: page and result."""
    studies = STUDIES

    @classmethod
    def setUpClass(cls):
        holder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(holder.cleanup)
        cls.folder = Path(holder.name)
        cls.browser = Browser()
        cls.addClassCleanup(cls.browser.close)
        with ThreadPoolExecutor(2) as pool:
            folders = list(pool.map(lambda study: run(study, cls.folder), cls.studies))
        cls.reports = {f.name: (f / "report.html", json.loads((f / "result.json").read_text(encoding="utf-8"))) for f in folders}

    def open(self, name, **wishes):
        path, result = self.reports[name]
        self.browser.screen(**wishes)
        self.browser.open(path)
        return result

# SPDX-License-Identifier: GPL-3.0-or-later
"""What tests of pages share: the program, the shipped studies and their answers, and one browser for all of a process."""
import atexit
import functools
import json
import sys
import tempfile
import unittest
from pathlib import Path

from browser import Browser

sys.path.append(str(Path(__file__).resolve().parents[1] / "support"))
from suite import EVERY  # noqa: E402
from answers import PROGRAM, SOURCE, answers  # noqa: E402

STUDIES = sorted((SOURCE / "studies").glob("*.json"))
SIZES = [(390, 844), (1280, 900), (1920, 1080)]
WINDOWS = [{"width": width, "height": height, "dark": dark} for width, height in SIZES for dark in (False, True)]


@functools.cache
def browser():
    started = Browser()
    atexit.register(started.close)
    return started


class Pages(unittest.TestCase):
    """A browser, and a folder for pages."""

    @classmethod
    def setUpClass(cls):
        holder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(holder.cleanup)
        cls.folder = Path(holder.name)
        cls.browser = browser()


class Answers(Pages):
    """The reports of studies, by their names: page and result."""
    studies = STUDIES

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        folders = [made.folder for made in answers(cls.studies)]
        cls.reports = {f.name: (f / "report.html", json.loads((f / "result.json").read_text(encoding="utf-8"))) for f in folders}

    def open(self, name, **wishes):
        path, result = self.reports[name]
        self.browser.open(path, **wishes)
        return result

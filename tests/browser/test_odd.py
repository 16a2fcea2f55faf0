# SPDX-License-Identifier: GPL-3.0-or-later
"""Reports of odd results (odd.py), read by the program as anybody's are: whatever a result says, its page says nothing that is no
number, lets no text become markup, and hides nothing. Every sixth of the quick kinds, of one study in one window;
MT_EVERY=1: every kind; MT_ODD_STUDIES=1: of all studies, in both windows, a quarter of an hour."""
import json
import os
import subprocess
import unittest

import odd
from common_pages import EVERY, PROGRAM, SOURCE, STUDIES, Answers

ALL = "MT_ODD_STUDIES" in os.environ
# With shapes and weights; with bands and a proof; with curves. Of more: with motion; with a trade study.
SAMPLE = ["beam_identification", "six_masses_bands", "den_hartog"]
MORE = ["inceptor_rotor", "inceptor_trade", "inceptor_tuning_1"]
WINDOWS = [{"width": 1280}, {"width": 390, "dark": True}]
SLOW = {"thousands_of_designs", "hundreds_of_parameters"}


class Odd(Answers):
    studies = STUDIES if ALL else [SOURCE / "studies" / f"{name}.json" for name in (SAMPLE + MORE if EVERY else SAMPLE)]

    def report(self, name, kind):
        folder = self.folder / f"{name}_{kind}"
        folder.mkdir(exist_ok=True)
        (folder / "result.json").write_text(json.dumps(odd.made(kind, self.reports[name][1])), encoding="utf-8")
        done = subprocess.run([PROGRAM, "report", folder / "result.json", "--format", "html"], capture_output=True, text=True, timeout=100)
        self.assertEqual(done.returncode, 0, done.stderr[:500])
        page = folder / "report.html"
        page.write_text(done.stdout, encoding="utf-8")
        return page

    def judge(self):
        found = self.browser.problems() + self.browser.numbers()
        if self.browser.run("return window.broken !== undefined || document.querySelector('main img') !== null"):
            found.append("a text became markup")
        return found

    def test_whatever_a_result_says(self):
        names = list(self.reports)
        with_curves = [name for name in names if self.reports[name][1]["curves"]]
        for place, kind in enumerate(odd.KINDS if EVERY or ALL else [kind for kind in odd.KINDS if kind not in SLOW][::6]):
            able = with_curves if kind in odd.CURVES else names
            for turn, name in enumerate(able if ALL else [able[place % len(able)]]):
                with self.subTest(result=kind, of=name):
                    page = self.report(name, kind)
                    for window in WINDOWS if ALL else [WINDOWS[(place + turn) % 2]]:
                        self.browser.open(page, **window)
                        if self.browser.run("return mt.designs().length") > 1 and (EVERY or ALL) and kind not in SLOW:
                            self.assertEqual(self.judge(), [])
                        self.browser.run("mt.choose(mt.designs().length - 1)")
                        self.browser.settle()
                        self.assertEqual(self.judge(), [])

    def test_what_turns_texts_round_is_seen(self):
        self.browser.open(self.report("beam_identification", "text_bidi"))
        self.assertNotRegex(self.browser.run("return document.documentElement.innerHTML.split('<script')[0]"), "[\u202e\u2066\u200f]")
        self.assertIn("left\\u202eright", self.browser.one("#figure-frequencies").text)
        # and planted faults are found
        for harm, told in (("document.querySelector('.gist').append('NaN')", "shows"), ("window.broken = 1", "markup"),
                           ("document.querySelector('.gist li').style.marginBottom = '-1.4em'", "in the page")):
            self.browser.run(harm)
            self.assertIn(told, " ".join(self.judge()))


if __name__ == "__main__":
    unittest.main()

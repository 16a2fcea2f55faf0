# SPDX-License-Identifier: GPL-3.0-or-later
"""Reports of odd results (odd.py), read by the program as anybody's are: whatever a result says, its page says nothing that is no
number, lets no text become markup, and hides nothing. MT_EVERY=1: of all studies, in both windows."""
import json
import subprocess
import unittest

import odd
from common_pages import EVERY, PROGRAM, SOURCE, STUDIES, Answers

# With bands, motion and a proof; with shapes and weights; with a trade study.
SAMPLE = ["inceptor_rotor", "beam_identification", "inceptor_trade", "inceptor_tuning_1"]
WINDOWS = [{"width": 1280}, {"width": 390, "dark": True}]
SLOW = {"thousands_of_designs", "hundreds_of_parameters"}


class Odd(Answers):
    studies = STUDIES if EVERY else [SOURCE / "studies" / f"{name}.json" for name in SAMPLE]

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
        for place, kind in enumerate(odd.KINDS):
            able = with_curves if kind in odd.CURVES else names
            for turn, name in enumerate(able if EVERY else [able[place % len(able)]]):
                with self.subTest(result=kind, of=name):
                    page = self.report(name, kind)
                    for window in WINDOWS if EVERY else [WINDOWS[(place + turn) % 2]]:
                        self.browser.screen(**window)
                        self.browser.open(page)
                        if self.browser.run("return mt.designs().length") > 1 and kind not in SLOW:
                            self.assertEqual(self.judge(), [])
                        self.browser.run("mt.choose(mt.designs().length - 1)")
                        self.browser.settle()
                        self.assertEqual(self.judge(), [])

    def test_what_turns_texts_round_is_seen(self):
        self.browser.screen()
        self.browser.open(self.report("inceptor_rotor", "text_bidi"))
        self.assertNotRegex(self.browser.run("return document.documentElement.innerHTML.split('<script')[0]"), "[\u202e\u2066\u200f]")
        self.assertIn("left\\u202eright", self.browser.one("#figure-frequencies").text)

    def test_planted_faults_are_found(self):
        self.open("inceptor_rotor")
        for harm, told in (("document.querySelector('.gist').append('NaN')", "shows"), ("window.broken = 1", "markup"),
                           ("document.querySelector('.gist li').style.marginBottom = '-1.4em'", "in the page")):
            self.browser.run(harm)
            self.assertIn(told, " ".join(self.judge()))


if __name__ == "__main__":
    unittest.main()

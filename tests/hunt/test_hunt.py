# SPDX-License-Identifier: GPL-3.0-or-later
"""The hunt in the suite: saved cases (with MT_EVERY=1, and in instrumented builds, all, else every sixth), faults that must be
found, and a study of each kind of a fixed seed; run.py draws more, of fresh ones."""
import functools
import itertools
import json
import unittest
from pathlib import Path

import run
import campaign
import numpy as np
from campaign import Tally
from faults import FAULTS
from suite import FEW, INSTRUMENTED

SEED = "7"
COUNT = 1  # of each kind
FIRST = {"_second_objective": [("limits", 14)], "_range": [("infeasible", 9)]}  # before others, of which none has a place for the fault
CASES = Path(__file__).resolve().parent / "cases"


@functools.cache
def hunted():
    """Findings and tally of the suite's random studies, and the generator, which keeps (model, study, answer) of each."""
    hunt, tally = run.Hunt(kept={}), Tally()
    return list(campaign.run(hunt, SEED, hunt.todo(hunt.kinds, COUNT), tally)), tally, hunt


def solved(kind, index):
    """(model, study, answer): where a fault is planted, among those of the suite first."""
    hunt = hunted()[2]
    if (kind, index) not in hunt.kept:
        case = hunt.make(SEED, kind, index).document
        hunt.kept[kind, index] = case["model"], case["study"], run.again(case["model"], [case["study"]])[0]
    return hunt.kept[kind, index]


class Cases(unittest.TestCase):
    """What the hunt once found. A case is one file {"holds": why it is here, "model": ..., "study": ...}."""

    def test_cases(self):
        campaign.hold_saved(self, run.Hunt(), CASES, 6 if FEW else 1)


@unittest.skipIf(INSTRUMENTED, "judges the hunt, not the program")
class Faults(unittest.TestCase):
    def test_faults_are_found(self):
        for plant, kinds, check in FAULTS:
            with self.subTest(fault=plant.__name__, check=check):
                self.assertTrue(self._find(plant, kinds, check))

    def _find(self, plant, kinds, check, tries=40):
        """Does the check tell a sound result from the same with the fault?"""
        for kind, index in (*(FIRST.get(plant.__name__, ()) if FEW else ()), *((k, i) for i in range(tries) for k in kinds)):
            model, study, (_, words, result) = solved(kind, index)
            if result is None:
                continue
            faulty = run.Run("fault", model, study, json.loads(words.texts["result.json"]), words)
            if not plant(faulty) or self._check(run.Run("sound", model, study, result, words), check):
                continue
            self.assertTrue(self._check(faulty, check), f"{kind} {index}")
            return True
        return False

    def _check(self, run_, check):
        with np.errstate(all="ignore"):
            if check == "trade":
                return list(itertools.islice(run.check_again.trade(run_, run.again), 1))
            return list(itertools.islice(run.CHECKS[check](run_), 1))


class Hunt(unittest.TestCase):
    def test_random_studies(self):
        found, tally, hunt = hunted()
        campaign.fail(self, hunt, SEED, found)
        self.assertLess(tally["refused"], tally["studies"] // 8)


if __name__ == "__main__":
    unittest.main()

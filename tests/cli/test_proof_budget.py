# SPDX-License-Identifier: GPL-3.0-or-later
"""--proof and "proof_s": a proof that ends early claims nothing, says so, and 0 spends nothing; on studies of every kind that has proofs, at budgets from nothing to
what settles them. What is proven with little is proven with all; no time is measured. MT_EVERY=1: those of the pedal without a catalogue, which take as
long as all others, too."""
import json
import math
import random
import re

from common_cli import MODEL, CliTest, main, study
from suite import EVERY, FEW, INSTRUMENTED
from test_budget_binds import CHOICES, HIGH, KINDS, PEDAL, masses

TOO_HIGH = [{**HIGH[0], "at_least_hz": 5}, {"type": "frequency", "configuration": "held", "mode": 2, "at_most_hz": 0.2}]
# the first mode up, the second down: each alone can be met, both cannot (their quotient is at least that of k1 = 2 k2)
APART = [{**HIGH[0], "at_least_hz": 0.15}, {"type": "frequency", "configuration": "held", "mode": 2, "at_most_hz": 0.22}]
MANY = [round(0.5 + 0.01 * i, 2) for i in range(500)]
PROVEN = {
    **{kind: KINDS[kind] for kind in ("pedal", "pedal_catalogue", "pedal_tolerances", "tolerances", "stages", "infeasible", "bands", "catalogue", "catalogue_infeasible")},
    "mixed": masses(variables=[{"parameter": "k1", "catalogue": CHOICES}, {"parameter": "k2", "lower": 0.1, "upper": 100}],
                    goals=[{**HIGH[0], "at_most_hz": 0.2}]),
    "many": masses(variables=[{"parameter": p, "catalogue": MANY} for p in ("k1", "k2")], goals=[{**HIGH[0], "at_most_hz": 0.2}]),
    "many_mixed": masses(variables=[{"parameter": "k1", "catalogue": MANY}, {"parameter": "k2", "lower": 0.1, "upper": 100}],
                         goals=[{**HIGH[0], "at_most_hz": 0.2}]),
    "too_high": masses(goals=TOO_HIGH),
    "apart": masses(goals=APART),
    "trade": KINDS["trade"],
}
BUDGETS = ("0", "1e-6") if INSTRUMENTED else ("0", "1e-12", "1e-5") if FEW else ("0", "1e-12", "1e-6", "1e-5", "1e-4")
NOT_PROVEN = '"proof_s" is 0|budget of (the proof|branch and bound) ended|heuristic|sampled, not proven'
BY_BOXES = re.compile(r" \([^()]*\d+ boxes[^()]*\)")


class ProofBudget(CliTest):
    def setUp(self):
        super().setUp()
        self.write("problems/model.json", MODEL)
        self.write("problems/pedal.json", json.dumps(PEDAL))

    def answer(self, kind, *options, folder="out", **search):
        asked = PROVEN[kind] if not search else {**PROVEN[kind], "search": search}
        self.write(f"studies/{kind}.json", json.dumps(asked))
        done = self.run_program("run", f"studies/{kind}.json", "-o", folder, "--starts", "4", *options)
        self.assertIn(done.returncode, (0, 1), done.stderr)
        return json.loads((self.folder / folder / kind / "result.json").read_text(encoding="utf-8"))

    def claims(self, result):
        """What is proven, without how; what mode placements change at least (search/test_best_first) depends on how many were searched."""
        return {(c["kind"], BY_BOXES.sub("", c["text"])) for c in result["certificates"] or () if c["proven"] and c["kind"] != "least_change"}

    def boxes_within(self, few, all_of):
        """Tolerances that are proven with less work are no larger, where the designs are the same ones."""
        known = {tuple(p["recommended"] for p in r["parameters"]): r["tolerance_box"] for r in all_of["recommendations"]}
        for r in few["recommendations"]:
            box, best = r["tolerance_box"], known.get(tuple(p["recommended"] for p in r["parameters"]))
            if box is not None and best is not None:
                self.assertLessEqual(box["all_percent"], best["all_percent"])
                for own, whole in zip(box["per_variable"], best["per_variable"], strict=True):
                    self.assertLessEqual(own["percent"], whole["percent"])

    def nothing_proven(self, found):
        self.assertEqual(found["run"]["spent"]["multiplications"], 0)
        self.assertEqual([c["kind"] for c in found["certificates"] or () if c["proven"] and c["kind"] not in ("enumeration", "least_change")], [])
        self.assertEqual([r["tolerance_box"] for r in found["recommendations"] if r["tolerance_box"] is not None], [])
        self.assertNotRegex(json.dumps(found), r"branch and bound, \d")

    def test_what_little_work_proves_all_of_it_proves(self):
        ended = 0
        for kind in PROVEN if EVERY else [k for k in PROVEN if k not in ("pedal", "pedal_tolerances")]:
            whole = self.answer(kind)
            self.assertGreaterEqual(whole["run"]["spent"]["multiplications"], 0)
            known = self.claims(whole)
            for budget in BUDGETS if EVERY or kind != "pedal_catalogue" else ("1e-6",) if FEW else ("0", "1e-6"):
                with self.subTest(kind, budget=budget):
                    few = self.answer(kind, "--proof", budget)
                    self.assertLessEqual(self.claims(few), known)
                    self.boxes_within(few, whole)
                    if budget == "0":
                        self.nothing_proven(few)
                    self.assertEqual([(o["name"], o["value"]) for o in few["run"]["overrides"]], [("starts", 4), ("proof_s", float(budget))])
                    if whole["status"] == "solved":  # what is proven impossible has no design: no budget makes it so
                        self.assertNotEqual(few["status"], "infeasible")
                    if few["status"] == "infeasible":
                        self.assertEqual(whole["status"], "infeasible")
                    missing = known - self.claims(few)
                    ended += bool(missing)
                    told = " ".join(c["text"] for c in few["certificates"] or ())
                    if {k for k, _ in missing} - {"range"}:
                        self.assertRegex(told, NOT_PROVEN)
        self.assertGreater(ended, 5 if len(BUDGETS) == 2 else 15)

    def test_changes_that_are_not_searched_have_no_design(self):
        """What little work proves of a change of the question spares its search; without proofs all are searched: random limits and bands."""
        draw, spared, found = random.Random(5), 0, 0
        for row in range(6 if FEW else 12):
            first, second = (f(0.05, 0.4) for f in (draw.uniform, draw.uniform))
            goals = [{"type": "frequency", "configuration": "held", "mode": 1, "at_least_hz": first, "at_most_hz": 1.1 * first},
                     {"type": "frequency", "configuration": "held", "mode": 2, "at_least_hz": second, "at_most_hz": 1.2 * second}]
            if row % 3 == 2:
                goals[0] = {"type": "avoid", "configurations": ["held"], "bands_hz": [[first / 2, first * 3]]}
            bounds = {"lower": 1, "upper": draw.uniform(2, 5)}
            PROVEN["drawn"] = masses(goals=goals, variables=[{"parameter": p, **bounds} for p in ("k1", "k2")])
            with self.subTest(goals=goals, bounds=bounds):
                little, none = self.answer("drawn"), self.answer("drawn", "--proof", "0")
                self.assertEqual(little["relaxations"], none["relaxations"])
                self.assertLessEqual(little["run"]["spent"]["relaxations"], none["run"]["spent"]["relaxations"])
                spared += little["run"]["spent"]["relaxations"] < none["run"]["spent"]["relaxations"]
                found += len(little["relaxations"]) > 0
        PROVEN.pop("drawn")
        self.assertGreater(min(spared, found), 2)

    def test_the_work_of_one_proof_is_within_its_budget(self):
        """One question without a tolerance box: the proof that no design meets both limits, to a box or two."""
        whole = self.answer("apart")
        self.assertEqual(whole["status"], "infeasible")
        worked = whole["run"]["spent"]["multiplications"]
        for part in (0.01, 0.1, 0.5, 0.9):
            budget = part * worked / 1e9
            with self.subTest(part):
                spent = self.answer("apart", "--proof", repr(budget))["run"]["spent"]["multiplications"]
                self.assertLess(spent, 1e9 * budget + 5000)
        self.assertEqual(self.answer("apart", "--proof", "1000")["run"]["spent"]["multiplications"], worked)

    def test_the_same_for_any_number_of_workers(self):
        for kind in ("bands", "mixed", "many_mixed", *(["pedal"] if EVERY else [])):
            for budget in ("1e-5",) if FEW else ("1e-6", "1e-5"):
                alone = self.answer(kind, "--proof", budget, "--threads", "1", folder="one")
                self.assertEqual(alone, self.answer(kind, "--proof", budget, "--threads", "3", folder="three"))

    def test_the_option_is_as_if_the_study_said_so(self):
        asked = self.answer("bands", "--proof", "1e-6")
        said = self.answer("bands", folder="said", proof_s="0.000001")
        over = self.answer("bands", "--proof", "1e-6", folder="over", proof_s=2)
        self.assertEqual([(o["name"], o["value"], o["original"]) for o in over["run"]["overrides"]], [("starts", 4, None), ("proof_s", 1e-6, 2)])
        for r in (asked, said, over):
            for own in ("inputs", "outputs", "overrides"):
                r["run"].pop(own)
        self.assertEqual(asked, said)
        self.assertEqual(asked, over)
        told = self.expect(0, "report", "over/bands/result.json").stdout
        self.assertIn("Asked with search starts = 4, search proof_s = 1e-06 (study: 2).", told.splitlines())

    def test_two_masses_cannot_be_nearer(self):
        """What the study "apart" asks is impossible: omega_1 omega_2 = sqrt(k1 k2) and omega_1^2 + omega_2^2 = k1 + 2 k2, for m = 1, so that
        (s^2 + 1/s^2) = (k1 + 2 k2) / sqrt(k1 k2) >= 2 sqrt(2) for the quotient s of the frequencies."""
        least = math.sqrt(math.sqrt(2) + 1)
        self.assertLess(APART[1]["at_most_hz"] / APART[0]["at_least_hz"], least)

    def test_a_journal_goes_on_with_the_same_only(self):
        self.write("studies/two.json", study(extra=', "search": {"starts": 4}'))
        journal = "parts/two.1-of-2.journal"
        self.expect(0, "run", "studies/two.json", "--shard", "1/2", "--proof", "1", "-o", "parts")
        for other in ((), ("--proof", "0"), ("--proof", "2")):
            self.assertIn("of another question", self.expect(2, "merge", "studies/two.json", journal, *other).stderr)
        self.expect(0, "merge", "studies/two.json", journal, "--proof", "1")


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""max_evaluations, and max_modal_solutions, is of everything: searches, positions of drives, analyses anew, other weights, relaxations, each point of a
trade study. What does not fit is left out and said; one that suffices changes no design. MT_EVERY=1: those of the pedal, which take longest, with every budget, too, and every kind by any number of workers."""
import json
import math
import sys

from common_cli import MODEL, SOURCE, CliTest, main, study
from suite import EVERY, FEW, INSTRUMENTED

sys.path.insert(0, str(SOURCE / "tests/support"))
from pedal import FREE, PEDAL, study as pedal  # noqa: E402


def masses(**more):
    return {**json.loads(study()), **more}


BUDGETS = (60, 300) if INSTRUMENTED else (20, 100, 1000) if FEW else (20, 60, 100, 300, 1000)
CHOICES = [1, 1.5, 2, 3, 4, 6, 8, 12]
CATALOGUES = [{"parameter": p, "catalogue": CHOICES} for p in ("k1", "k2")]
HIGH = [{"type": "frequency", "configuration": "held", "mode": 1, "at_least_hz": 0.15}]
WEIGHTED = [{"type": "frequency", "configuration": "held", "mode": i, "target_hz": hz, "weight": 1} for i, hz in ((1, 0.14), (2, 0.34))]
WEIGHTED += [{"type": "frequency", "configuration": "twice", "mode": 1, "target_hz": 0.12, "weight": 2}]
KINDS = {
    "pedal": pedal(FREE),
    "pedal_clearance": pedal(FREE, objective={"maximise": "clearance"}),
    "pedal_catalogue": pedal([{"parameter": "arm", "catalogue": [0.05 + 0.01 * i for i in range(16)]}, {"parameter": "m", "catalogue": [0.4, 0.8, 1.2, 1.6]}]),
    "pedal_mixed": pedal([{"parameter": "arm", "catalogue": [0.05 + 0.01 * i for i in range(16)]}, FREE[1]]),
    "pedal_tolerances": pedal([{**FREE[0], "tolerance_percent": 2}, FREE[1]]),
    "targets": masses(),
    "tolerances": masses(goals=HIGH, variables=[{"parameter": p, "lower": 0.1, "upper": 100, "tolerance_percent": 2} for p in ("k1", "k2")]),
    "stages": masses(goals=HIGH, objective=[{"minimise": "change"}, {"minimise": "k1"}]),
    "spread": masses(goals=WEIGHTED, objective={"minimise": "misfit"}, spread={"factor": 4}),
    "infeasible": masses(goals=[{**HIGH[0], "at_least_hz": 5}]),
    "bands": masses(goals=[{"type": "avoid", "configurations": ["held"], "bands_hz": [[0.1, 0.2], [0.3, 0.4]], "margin_percent": 2}]),
    "catalogue": masses(variables=CATALOGUES),
    "catalogue_infeasible": masses(variables=CATALOGUES, goals=[{**HIGH[0], "at_least_hz": 5}]),
    "mixed": masses(variables=[CATALOGUES[0], {"parameter": "k2", "lower": 0.1, "upper": 100}]),
    "trade": masses(goals=HIGH, objective={"minimise": "change"}, trade={"vary": [{"goal": 0, "member": "at_least_hz", "values": [0.12, 0.15, 0.2]}]}),
}


class Binds(CliTest):
    def setUp(self):
        super().setUp()
        self.write("problems/model.json", MODEL)
        self.write("problems/pedal.json", json.dumps(PEDAL))

    def answer(self, kind, *options, folder="out"):
        self.write(f"studies/{kind}.json", json.dumps(KINDS[kind]))
        done = self.run_program("run", f"studies/{kind}.json", "-o", folder, "--starts", "4", *options)
        self.assertIn(done.returncode, (0, 1), done.stderr)
        return json.loads((self.folder / folder / kind / "result.json").read_text(encoding="utf-8"))

    def test_no_answer_takes_more_than_its_budget(self):
        for place, kind in enumerate(KINDS):
            if FEW and kind == "pedal_tolerances":
                continue
            for most in BUDGETS[place % 2::4] if FEW and kind.startswith("pedal") else BUDGETS if EVERY or FEW or not kind.startswith("pedal") else BUDGETS[:1] if kind == "pedal_tolerances" else BUDGETS[:4:2]:
                with self.subTest(kind, most=most):
                    found = self.answer(kind, "--max-evaluations", str(most))
                    spent = found["run"]["spent"]
                    self.assertLessEqual(found["run"]["evaluations"] - spent["trade"], most, spent)
                    points = found["trade"]["points"] if found["trade"] else []
                    self.assertLessEqual(spent["trade"], most * len(points), spent)
                    for design in found["recommendations"]:  # all that is told was analysed anew
                        self.assertTrue(all(math.isfinite(f["recommended_hz"]) for f in design["frequencies"]))
                    self.assertGreaterEqual(spent["descriptions"], 2 + 2 * len(found["recommendations"]))

    def test_nor_more_modal_solutions(self):
        """The original design and one more are analysed in any case, over their tolerances, too."""
        for kind in KINDS:
            if FEW and kind.startswith("pedal") and kind != "pedal_catalogue":
                continue
            for most in (60, 300, 1000, 5000) if EVERY or not kind.startswith("pedal") else (60, 300):
                with self.subTest(kind, most=most):
                    found = self.answer(kind, "--max-modal-solutions", str(most), "--report", "none")
                    points = found["trade"]["points"] if found["trade"] else []
                    least = 500 if kind == "pedal_tolerances" else 0  # for those two
                    self.assertLessEqual(found["run"]["modal_solutions"], max(most, least) * (1 + len(points)), found["run"]["spent"])
                    self.assertGreaterEqual(found["run"]["modal_solutions"], found["run"]["evaluations"] - found["run"]["spent"]["positions"])
                    self.assertTrue(all(h["evaluations"] <= most for h in found["run"]["history"]))

    def test_one_that_suffices_changes_no_design(self):
        for kind in KINDS if EVERY else [k for k in KINDS if not k.startswith("pedal")][1::2] if FEW else [k for k in KINDS if k == "pedal_catalogue" or not k.startswith("pedal")]:
            with self.subTest(kind):
                free = self.answer(kind)
                bound = self.answer(kind, "--max-evaluations", "1000000")
                solved = self.answer(kind, "--max-modal-solutions", "100000000")
                spent = [dict(r["run"]["spent"]) for r in (free, bound, solved)]
                if kind == "mixed":  # combinations that cannot be among the designs asked for are left out where no budget has to be shared out
                    self.assertTrue(all(spent[0]["search"] <= s["search"] for s in spent[1:]), spent)
                    for r in (bound, solved):
                        self.assertEqual(len(free["recommendations"]), len(r["recommendations"]))
                        for one, other in zip(free["recommendations"], r["recommendations"]):
                            self.assertTrue(one["feasible"] and other["feasible"])
                            self.assertAlmostEqual(one["score"], other["score"], delta=1e-6 * abs(one["score"]))
                            for a, b in zip(one["parameters"], other["parameters"]):
                                self.assertAlmostEqual(a["recommended"], b["recommended"], delta=1e-4 * abs(a["recommended"]))
                    continue
                if kind == "bands":  # least changes of placements are computed where no budget has to be shared out
                    of_free, *others = [s.pop("multiplications") for s in spent]
                    self.assertTrue(all(m <= of_free for m in others), (of_free, others))
                for r in (bound, solved):
                    self.assertEqual(spent[0], r["run"]["spent"] if kind != "bands" else {k: v for k, v in r["run"]["spent"].items() if k != "multiplications"})
                for r in (free, bound, solved):
                    r.pop("run")
                self.assertEqual(free, bound)
                self.assertEqual(free, solved)

    def test_it_is_the_same_for_all_workers_and_parts(self):
        by_evaluations, by_solutions = ("--max-evaluations", "300"), ("--max-modal-solutions", "900")
        kinds = [(k, by_evaluations) for k in (*(() if FEW else ("pedal", "spread")), "pedal_catalogue", "mixed", "trade")]
        for kind, budget in [*kinds, ("tolerances", by_solutions), *(() if FEW else [("pedal_tolerances", by_solutions)])]:
            with self.subTest(kind, budget=budget):
                self.answer(kind, *budget, "--threads", "1", folder="whole")
                self.answer(kind, *budget, "--threads", "3", folder="many")
                whole = (self.folder / "whole" / kind / "result.json").read_bytes()
                self.assertEqual(whole, (self.folder / "many" / kind / "result.json").read_bytes())
                journals = [f"parts/{kind}.{part}-of-2.journal" for part in (1, 2)]
                for part in (1, 2):
                    self.expect(0, "run", f"studies/{kind}.json", "-o", "parts", "--shard", f"{part}/2", "--starts", "4", *budget)
                joined = self.run_program("merge", f"studies/{kind}.json", *journals, "-o", "joined", "--starts", "4", *budget)
                self.assertIn(joined.returncode, (0, 1), joined.stderr)
                self.assertEqual(whole, (self.folder / "joined" / kind / "result.json").read_bytes())

    def test_what_does_not_fit_is_said(self):
        warned = " ".join(self.answer("spread", "--max-evaluations", "60")["warnings"])
        self.assertIn('sensitivity to the weights: not computed, since "max_evaluations" leaves no evaluations for it', warned)
        self.assertIn('since "max_modal_solutions" leaves no', " ".join(self.answer("spread", "--max-modal-solutions", "120")["warnings"]))
        few = self.answer("mixed", "--max-modal-solutions", "200")
        self.assertRegex(" ".join(few["warnings"]), r'the budget of modal solutions ran out \(\d+ of 200 were made in the search\): a larger "max_modal_solutions"')
        few = self.answer("pedal", "--max-evaluations", "300")
        self.assertIn("the budget of evaluations ran out (", " ".join(few["warnings"]))
        self.assertIn("of 300 were made in the search)", " ".join(few["warnings"]))
        coarse = [m["grade"] for r in few["recommendations"] for m in r["motion"]]
        self.assertTrue(coarse and set(coarse) <= {"sampled", "sampled coarsely", "not followed"}, coarse)


if __name__ == "__main__":
    main()

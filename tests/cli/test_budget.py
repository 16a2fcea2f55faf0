# SPDX-License-Identifier: GPL-3.0-or-later
"""--time, --seed, --starts, --max-evaluations, --set: a limit ends like an interrupt and is resumed, all else is as if the files said so. No time is measured."""
import json
import math

from common_cli import MODEL, CliTest, main, study
from test_interrupts import BEAM, LONG

# The same search, which ends, and tells its starts apart.
SHORT = LONG.replace("5000", "40").replace('"starts"', '"seed": %d, "starts"').replace("1000000000", "4000")


class Budget(CliTest):
    def setUp(self):
        super().setUp()
        self.write("problems/beam.json", BEAM % 2)
        self.write("problems/slender.json", BEAM % 16)
        self.write("studies/long.json", LONG.replace("beam.json", "slender.json"))
        self.write("studies/short.json", SHORT % 1)

    @staticmethod
    def code_of(found):
        """0 where a design that was analysed again meets all goals."""
        return 0 if found["recommendations"] and found["recommendations"][0]["feasible"] else 1

    def result(self, folder="results", name="short"):
        return (self.folder / folder / name / "result.json").read_bytes()

    def test_the_limit_ends_with_the_best_so_far_and_the_next_study_has_its_own(self):
        for threads in ("1", "3"):
            done = self.run_program("run", "studies/long.json", "studies/short.json", "--time", "0.5", "--threads", threads)
            self.assertIn("studies/long.json: stopped at the time limit of 0.5 s; --resume goes on from here", done.stderr)
            found = json.loads(self.result(name="long"))
            self.assertEqual(found["status"], "time_limit")
            self.assertEqual(done.returncode, self.code_of(found), done.stderr)
            self.assertIn("search", found["run"]["incomplete"])
            self.assertEqual(found["run"]["cut_by"], "time limit")
            self.assertRegex(found["status_text"], r"^Stopped at the time limit \(not complete: search.*\)\. ")
            self.assertTrue(found["status_text"].endswith(" `run --resume` goes on from here."))
            self.assertIn(found["status_text"], done.stdout)
            self.expect(0, "check", "results/long/result.json")
            self.assertTrue((self.folder / "results/short/result.json").exists())  # a signal leaves the rest undone

    def test_the_best_design_is_analysed_again_however_short_the_time(self):
        asked = json.loads((self.folder / "studies/long.json").read_text())
        self.write("studies/hard.json", json.dumps({**asked, "recommendations": 9, "search": {**asked["search"], "starts": 400}}))
        seen = 0
        for seconds in ("0.02", "0.4", "1.2", "3.6", "10.8"):
            done = self.run_program("run", "studies/hard.json", "--time", seconds)
            self.assertIn(done.returncode, (0, 1), done.stderr)
            path = self.folder / "results/hard/result.json"
            if not path.exists():
                self.assertIn("before the original design", done.stderr)
                continue
            found = json.loads(path.read_bytes())
            path.unlink()
            seen += len(found["recommendations"])
            if found["status"] == "solved":  # the time was long enough
                break
            self.assertEqual((found["status"], found["run"]["cut_by"]), ("time_limit", "time limit"))
            self.assertEqual(done.returncode, self.code_of(found))
            if found["unchecked"]:
                self.assertGreaterEqual(len(found["recommendations"]), 1)  # never all of them
            for design in found["unchecked"]:
                self.assertEqual(sorted(design["values"]), sorted(found["variables"]))
                self.assertTrue(all(math.isfinite(x) for x in design["values"].values()))
                self.assertIn(design["text"], done.stdout)
        self.assertGreater(seen, 0, "no time was long enough")

    def test_a_part_that_is_out_of_time_is_not_done(self):
        done = self.expect(1, "run", "studies/long.json", "-o", "parts", "--shard", "1/2", "--time", "0.2")
        self.assertIn("stopped at the time limit of 0.2 s; --resume goes on from here", done.stderr)

    def test_a_time_that_suffices_changes_no_byte(self):
        self.expect(0, "run", "studies/short.json", "-o", "free")
        done = self.expect(0, "run", "studies/short.json", "-o", "limited", "--time", "1e9")
        self.assertNotIn("time limit", done.stderr)
        self.assertEqual(self.result("free"), self.result("limited"))

    def test_what_the_limit_cut_is_resumed(self):
        self.expect(0, "run", "studies/short.json", "-o", "free")
        for seconds in ("1e-9", "0.002", "0.01", "0.03"):  # wherever it is cut, or not at all
            cut = self.run_program("run", "studies/short.json", "-o", "cut", "--time", seconds)
            self.assertIn(cut.returncode, (0, 1), cut.stderr)
            self.assertTrue(seconds != "1e-9" or "time limit" in cut.stderr, cut.stderr)
            written = self.folder / "cut/short/result.json"
            if written.exists():
                found = json.loads(written.read_bytes())
                self.assertEqual("time limit" in cut.stderr, found["status"] == "time_limit", cut.stderr)
                self.assertEqual(cut.returncode, self.code_of(found), cut.stderr)
            self.expect(0, "run", "studies/short.json", "-o", "cut", "--resume")
            self.assertEqual(self.result("free"), self.result("cut"), seconds)

    def test_a_seed_is_as_if_the_study_said_so(self):
        (self.folder / "edited").mkdir()
        self.write("edited/short.json", SHORT % 7)
        self.expect(0, "run", "edited/short.json", "-o", "edited_out")
        self.expect(0, "run", "studies/short.json", "-o", "set_out", "--seed", "7")
        self.expect(0, "run", "studies/short.json", "-o", "plain_out")
        edited, given, plain = (json.loads(self.result(f)) for f in ("edited_out", "set_out", "plain_out"))
        self.assertEqual((given["run"]["seed"], plain["run"]["seed"]), (7, 1))
        self.assertNotEqual(given["run"]["evaluations"], plain["run"]["evaluations"])  # other starts
        for r in (edited, given):
            for digests in ("inputs", "outputs"):  # of the study, and of what names it
                r["run"].pop(digests)
        self.assertEqual([(o["name"], o["value"], o["original"]) for o in given["run"].pop("overrides")], [("seed", 7, 1)])
        self.assertEqual(edited["run"].pop("overrides"), [])
        self.assertEqual(edited, given)

    def test_a_journal_is_of_its_seed(self):
        self.expect(0, "run", "studies/short.json", "-o", "parts", "--shard", "1/2", "--seed", "7")
        journal = "parts/short.1-of-2.journal"
        self.expect(0, "merge", "studies/short.json", journal, "-o", "joined", "--seed", "7")
        refused = self.run_program("merge", "studies/short.json", journal, "-o", "other")
        self.assertNotIn(refused.returncode, (0, 1), refused.stderr)

    def two_masses(self):
        self.write("problems/model.json", MODEL)
        self.write("studies/two.json", study(extra=', "search": {"seed": 3}'))

    def two(self, folder):
        return json.loads(self.result(folder, "two"))

    def test_a_value_that_is_set_is_as_if_the_model_said_so(self):
        """Four times the mass asks for four times the springs: (12, 4) and (8, 6) for (3, 1) and (2, 1.5)."""
        self.two_masses()
        self.expect(0, "run", "studies/two.json", "-o", "set_out", "--set", "m=4*m", "--starts", "9", "--max-evaluations", "3000", "--max-modal-solutions", "9000")
        given = self.two("set_out")
        springs = sorted(tuple(p["recommended"] for p in r["parameters"]) for r in given["recommendations"])
        for found, expected in zip(springs, [(8, 6), (12, 4)], strict=True):
            for a, b in zip(found, expected, strict=True):
                self.assertAlmostEqual(a, b, delta=1e-7 * b)
        self.assertEqual([(o["kind"], o["name"], o["value"], o["original"]) for o in given["run"]["overrides"]],
                         [("parameter", "m", 4, 1), ("search", "starts", 9, None), ("search", "max_evaluations", 3000, None), ("search", "max_modal_solutions", 9000, None)])
        self.assertEqual(given["run"]["starts"], 9)
        (self.folder / "edited").mkdir()
        self.write("problems/model.json", MODEL.replace('"m": 1.0', '"m": 4.0'))
        self.write("edited/two.json", study(extra=', "search": {"seed": 3, "starts": 9, "max_evaluations": 3000, "max_modal_solutions": 9000}'))
        self.expect(0, "run", "edited/two.json", "-o", "edited_out")
        edited = self.two("edited_out")
        for r in (edited, given):
            for own in ("inputs", "outputs", "overrides"):
                r["run"].pop(own)
        self.assertEqual(edited, given)

    def test_what_was_asked_for_is_told_wherever_the_result_is(self):
        self.two_masses()
        line = "Asked with m = 4 (model: 1), search seed = 5 (study: 3)."
        told = self.expect(0, "run", "studies/two.json", "--set", "m=4", "--seed", "5").stdout
        self.assertIn(line, told.splitlines())
        result = "results/two/result.json"
        self.assertIn(line, self.expect(0, "report", result).stdout)
        self.assertIn(line, (self.folder / "results/two/report.html").read_text(encoding="utf-8"))
        self.expect(0, "check", result)
        self.expect(0, "run", "studies/two.json", "-o", "plain")
        self.assertRegex(self.expect(1, "diff", "results/two", "plain/two").stdout, "override m +")

    def test_a_trade_study_spends_what_its_points_spend_alone(self):
        """Of catalogues: points are not searched again from their neighbours. They tell their best designs alone."""
        self.two_masses()
        ends = '"lower": 0.1, "upper": 100'
        self.assertIn(ends, study())

        def catalogue(extra=""):
            return study(extra=', "recommendations": 1' + extra).replace(ends, '"catalogue": [1, 1.5, 2, 3, 4, 6, 8, 12]')

        self.write("studies/trade.json", catalogue(', "trade": {"vary": [{"parameter": "m", "values": [1, 2, 4]}]}'))
        self.write("studies/two.json", catalogue())
        spent = json.loads(self.expect(0, "run", "studies/trade.json", "--format", "json").stdout)["run"]["spent"]
        alone = [json.loads(self.expect(0, "run", "studies/two.json", "--set", f"m={m}", "--format", "json").stdout)["run"]
                 for m in (1, 2, 4)]
        self.assertEqual(spent["trade"], sum(r["evaluations"] for r in alone))
        self.assertEqual(spent["search"], alone[0]["spent"]["search"])

    def test_apply_writes_what_was_solved(self):
        """The model that apply writes has the frequencies that were asked for."""
        self.two_masses()
        self.expect(0, "run", "studies/two.json", "--set", "m=4")
        self.write("problems/applied.json", self.expect(0, "apply", "results/two/result.json").stdout)
        modes = json.loads(self.expect(0, "modes", "problems/applied.json", "-c", "held", "--format", "json").stdout)
        asked = [f["target_hz"] for f in self.two("results")["recommendations"][0]["frequencies"]]
        found = [m["frequency_hz"] for m in modes["modes"]]
        for a, b in zip(found, asked, strict=True):
            self.assertAlmostEqual(a, b, delta=1e-9 * b)

    def test_published_values_and_proofs_are_of_what_was_set(self):
        self.write("problems/model.json", MODEL)
        self.write("studies/two.json", study(second_hz="20", extra=', "published": [{"parameter": "m", "value": 4, "tolerance_percent": 0.1, "role": "verifies"}]'))
        plain = json.loads(self.expect(1, "run", "studies/two.json", "--format", "json").stdout)
        done = json.loads(self.expect(1, "run", "studies/two.json", "--set", "m=4", "--format", "json").stdout)
        self.assertEqual([r["published"][0]["holds"] for r in (plain, done)], [False, True])
        for r, mass in ((plain, 1), (done, 4)):
            certificate, = (c for c in r["certificates"] if c["reachable_upper_hz"] is not None)
            highest = math.sqrt((3 + math.sqrt(5)) / 2 * 100 / mass) / (2 * math.pi)  # of mode 2, both springs at 100 N/m
            self.assertAlmostEqual(certificate["reachable_upper_hz"], highest, delta=1e-6 * highest)

    def test_a_journal_is_of_what_was_asked_for(self):
        self.two_masses()
        asked = ("--set", "m=4", "--starts", "9")
        self.expect(0, "run", "studies/two.json", "-o", "whole", *asked)
        self.expect(0, "run", "studies/two.json", "-o", "parts", "--shard", "1/2", *asked)
        journal = "parts/two.1-of-2.journal"
        self.expect(0, "merge", "studies/two.json", journal, "-o", "joined", *asked)
        self.assertEqual(self.result("whole", "two"), self.result("joined", "two"))
        self.expect(0, "merge", "studies/two.json", journal, "-o", "joined", *reversed(("9", "--starts", "m=4", "--set")))
        for other in ((), ("--set", "m=4"), ("--starts", "9"), ("--set", "m=4", "--starts", "8"), ("--set", "m=5", "--starts", "9")):
            refused = self.expect(2, "merge", "studies/two.json", journal, "-o", "other", *other)
            self.assertIn("of another question", refused.stderr)
        (self.folder / journal).rename(self.folder / "parts/two.journal")
        self.assertIn("of another question", self.expect(2, "run", "studies/two.json", "-o", "parts", "--resume", "--set", "m=3").stderr)

    def test_what_cannot_be_set(self):
        self.two_masses()
        for sets, said in ((["k1=2"], 'studies/two.json:1:118: error: /variables/0/parameter: the study varies "k1" itself'),
                           (["mm=2"], '--set: unknown parameter "mm"; did you mean "m"?'), (["m=2", "m=3"], 'parameter "m" is set twice'),
                           (["m"], '"m" is not NAME=VALUE'), (["=2"], "is not NAME=VALUE"), (["m=1/0"], "--set: m=1/0: 1 / 0 has no finite value"),
                           (["m=2*q"], 'unknown name "q"'), (["m=-1"], 'body "a": mass_kg (-1) must not be negative')):
            for command in ("run", "compare"):
                done = self.expect(2, command, "studies/two.json", *[a for s in sets for a in ("--set", s)])
                self.assertIn(said, done.stderr)
        self.assertIn("/parameters/m: is set to -1", done.stderr)
        self.assertFalse((self.folder / "results").exists())
        own = self.expect(0, "run", "studies/two.json", "--set", "m=4")
        self.assertIn('configuration "heavy" has its own value of "m": to set it changes nothing there', own.stderr)
        self.write("studies/two.json", study(extra=', "trade": {"vary": [{"parameter": "m", "values": [1, 2]}]}'))
        done = self.expect(2, "run", "studies/two.json", "--set", "m=4")
        self.assertIn('/trade/vary/0/parameter: the study varies "m" itself', done.stderr)

    def test_values_that_are_none(self):
        for option, values in {"--time": ("0", "-1", "nan", "inf", "1s", "2e9", "0x5"), "--seed": ("-1", "1.5", "x", "2147483648"),
                               "--starts": ("0", "1.5", "100001"), "--max-evaluations": ("0", "x", "2147483648"), "--max-modal-solutions": ("0", "x", "2147483648"),
                               "--proof": ("-1", "nan", "inf", "5s", "1.1e6", "0x5")}.items():
            for value in values:
                done = self.expect(2, "run", "studies/short.json", f"{option}={value}")
                self.assertIn(f'{option}: "{value}" is not', done.stderr)


if __name__ == "__main__":
    main()

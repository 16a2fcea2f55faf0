# SPDX-License-Identifier: GPL-3.0-or-later
"""--time and --seed: a limit ends like an interrupt and is resumed, a seed is as if the study said so. No time is measured."""
import json

from common_cli import CliTest, main
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

    def result(self, folder="results", name="short"):
        return (self.folder / folder / name / "result.json").read_bytes()

    def test_the_limit_ends_with_the_best_so_far_and_the_next_study_has_its_own(self):
        for threads in ("1", "3"):
            done = self.expect(130, "run", "studies/long.json", "studies/short.json", "--time", "1", "--threads", threads)
            self.assertIn("studies/long.json: stopped at the time limit of 1 s", done.stderr)
            found = json.loads(self.result(name="long"))
            self.assertEqual(found["status"], "interrupted")
            self.assertIn("search", found["run"]["incomplete"])
            self.expect(0, "check", "results/long/result.json")
            self.assertTrue((self.folder / "results/short/result.json").exists())  # a signal leaves the rest undone

    def test_a_time_that_suffices_changes_no_byte(self):
        self.expect(0, "run", "studies/short.json", "-o", "free")
        done = self.expect(0, "run", "studies/short.json", "-o", "limited", "--time", "1e9")
        self.assertNotIn("time limit", done.stderr)
        self.assertEqual(self.result("free"), self.result("limited"))

    def test_what_the_limit_cut_is_resumed(self):
        self.expect(0, "run", "studies/short.json", "-o", "free")
        for seconds in ("1e-9", "0.002", "0.01", "0.03"):  # wherever it is cut, or not at all
            cut = self.run_program("run", "studies/short.json", "-o", "cut", "--time", seconds)
            self.assertIn(cut.returncode, (0, 130), cut.stderr)
            self.assertTrue(seconds != "1e-9" or cut.returncode == 130, cut.stderr)
            self.assertEqual("time limit" in cut.stderr, cut.returncode == 130, cut.stderr)
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
        self.assertEqual(edited, given)

    def test_a_journal_is_of_its_seed(self):
        self.expect(0, "run", "studies/short.json", "-o", "parts", "--shard", "1/2", "--seed", "7")
        journal = "parts/short.1-of-2.journal"
        self.expect(0, "merge", "studies/short.json", journal, "-o", "joined", "--seed", "7")
        refused = self.run_program("merge", "studies/short.json", journal, "-o", "other")
        self.assertNotIn(refused.returncode, (0, 1), refused.stderr)

    def test_values_that_are_none(self):
        for option, values in {"--time": ("0", "-1", "nan", "inf", "1s", "2e9", "0x5"), "--seed": ("-1", "1.5", "x", "2147483648")}.items():
            for value in values:
                done = self.expect(2, "run", "studies/short.json", f"{option}={value}")
                self.assertIn(f'{option}: "{value}" is not', done.stderr)


if __name__ == "__main__":
    main()

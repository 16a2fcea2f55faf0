# SPDX-License-Identifier: GPL-3.0-or-later
"""--progress: what standard error says while a command is at work, on a terminal, in a pipe and for programs; results do not depend on it.
MT_EVERY=1: every kind of study that is judged anew, and the ten seconds between two lines of a pipe."""
import json
import re
import signal
import time
import unittest

import jsonschema

from common_cli import SOURCE, CliTest, main
from suite import EVERY, INSTRUMENTED
from test_budget_binds import KINDS, PEDAL
from test_interrupts import BEAM, LONG, Running

SCHEMA = json.loads((SOURCE / "schemas/progress.schema.json").read_text(encoding="utf-8"))
FEWER = INSTRUMENTED  # what waits for a clock shows a sanitizer nothing
WIPE = "\r\x1b[K"
SHORT = LONG.replace("5000", "40").replace("1000000000", "40000")
# Two equal targets for one mode: impossible, which a proof and changes of the question are about.
TORN = SHORT.replace('"target_hz": 5 }', '"target_hz": 5 }, { "type": "frequency", "mode": 1, "target_hz": 6 }')


class Progress(CliTest):
    def setUp(self):
        super().setUp()
        self.write("problems/beam.json", BEAM % 4)
        self.short = self.write("studies/short.json", SHORT)
        self.write("problems/slender.json", BEAM % 16)
        self.long = self.write("studies/long.json", LONG.replace("beam.json", "slender.json").replace("5000", "50000"))
        self.torn = self.write("studies/torn.json", TORN)

    def objects(self, text):
        """The lines for programs, each held against the schema."""
        found = [json.loads(line) for line in text.splitlines() if line.startswith("{")]
        validator = jsonschema.Draft7Validator(SCHEMA)
        for one in found:
            self.assertEqual([e.message for e in validator.iter_errors(one)], [], one)
        return found

    def check_steps(self, found):
        """In a step nothing goes back; the last word is of all of it."""
        self.assertEqual(found[-1]["state"], "done")
        self.assertEqual(found[-1]["share"], 1)
        for a, b in zip(found, found[1:]):
            if a["state"] != "running" or b["state"] != "running":
                continue
            self.assertGreaterEqual(b["evaluations"], a["evaluations"])
            self.assertGreaterEqual(b["boxes"], a["boxes"])
            self.assertGreaterEqual(b["step"], a["step"])  # a phase may come again, and has steps of its own then
            if a["step"] == b["step"]:
                self.assertEqual((a["phase"], a["unit"], a["total"]), (b["phase"], b["unit"], b["total"]))
                self.assertGreaterEqual(b["done"], a["done"])
                self.assertGreaterEqual(b["share"] or 0, a["share"] or 0)
                self.assertTrue(a["best"] is None or b["best"] <= a["best"])
            self.assertTrue(a["first_cpu_s"] is None or b["first_cpu_s"] == a["first_cpu_s"])
            for of in ("best_cpu_s", "best_evaluations", "proof_cpu_s", "cpu_s"):
                self.assertTrue(a[of] is None or b[of] >= a[of], (a, b))
        for f in found:
            self.assertEqual(f["first_cpu_s"] is None, f["best"] is None)
            if f["best"] is not None:
                self.assertLessEqual(f["first_cpu_s"], f["best_cpu_s"])
                self.assertLessEqual(f["best_cpu_s"], f["cpu_s"])
                self.assertLessEqual(f["first_evaluations"], f["best_evaluations"])
                self.assertLessEqual(f["best_evaluations"], f["evaluations"])

    def test_objects_for_programs(self):
        done = self.expect(1, "run", self.short, self.torn, "--progress", "json", "--threads", "2")
        found = self.objects(done.stderr)
        self.assertEqual([(f["number"], f["phase"]) for f in found if f["state"] == "done" and f["phase"] == "reading"],
                         [(1, "reading"), (2, "reading")])
        for number, name in ((1, "short"), (2, "torn")):
            own = [f for f in found if f["number"] == number]
            self.assertEqual({f["file"] for f in own}, {f"studies/{name}.json"})
            self.check_steps(own)
            result = json.loads((self.folder / f"results/{name}/result.json").read_text(encoding="utf-8"))
            self.assertGreaterEqual(own[-1]["evaluations"], result["run"]["spent"]["search"])
        best = [f for f in found if f["number"] == 1][-1]
        result = json.loads((self.folder / "results/short/result.json").read_text(encoding="utf-8"))
        self.assertEqual(best["objective"], "change")
        self.assertAlmostEqual(best["best"], result["recommendations"][0]["change"], delta=1e-4)
        self.assertIsNone(best["proof_cpu_s"])
        self.assertIs(best["impossible"], False)
        self.assertIs(found[-1]["impossible"], True)
        self.assertIsNone(found[-1]["best"])  # no design meets both targets
        self.assertLessEqual(found[-1]["proof_cpu_s"], found[-1]["cpu_s"])

    def test_the_best_of_designs_that_are_judged_anew(self):
        """Over positions of a drive and tolerances: what is told last is the answer's."""
        self.write("problems/pedal.json", json.dumps(PEDAL))
        for kind in ("pedal", "pedal_catalogue", "pedal_tolerances") if EVERY else ("pedal_catalogue", "tolerances"):
            with self.subTest(kind):
                self.write(f"studies/{kind}.json", json.dumps(KINDS[kind]))
                done = self.expect(0, "run", f"studies/{kind}.json", "--starts", "4", "--progress", "json")
                found = self.objects(done.stderr)
                self.check_steps(found)
                result = json.loads((self.folder / f"results/{kind}/result.json").read_text(encoding="utf-8"))
                self.assertAlmostEqual(found[-1]["best"], result["recommendations"][0]["change"], delta=1e-6)
                self.assertGreater(found[-1]["best_evaluations"], 0)

    def test_a_long_search_and_its_end(self):
        fewer = self.write("studies/fewer.json", LONG.replace("beam.json", "slender.json"))
        running = Running(self.folder, "run", fewer, "--progress", "json", "--threads", "1")
        self.assertTrue(running.wait_for('"unit": "starts"'), running.said)
        for _ in range(2):
            self.assertTrue(running.wait_for('"unit": "starts"'), running.said)
        running.send(signal.SIGINT)
        self.assertEqual(running.end()[0], 130)
        found = self.objects(running.said)
        self.assertEqual(found[-1]["state"], "ended")
        starts = [f for f in found if f["unit"] == "starts"]
        self.assertGreaterEqual(len(starts), 2)
        for f in starts:
            self.assertEqual(f["total"], 5000)
            self.assertAlmostEqual(f["share"], f["done"] / 5000, delta=1e-12)

    def test_a_line_of_a_terminal_goes(self):
        for columns in (200, 40):
            begun = time.monotonic()
            running = Running(self.folder, "run", self.long, "--time", "600", "--threads", "1", columns=columns)
            self.assertTrue(running.wait_for("of 50000 "), running.said)
            time.sleep(0.5)  # some lines more
            running.send(signal.SIGINT)
            code, out = running.end()
            lasted = time.monotonic() - begun
            self.assertEqual(code, 130)
            lines = running.said.split(WIPE)
            told = [re.sub(r"[\r\n].*", "", line, flags=re.S) for line in lines[1:]]
            self.assertTrue(any(re.match(r"search: \d+ of 50000 (first values|starts)", line) for line in told), running.said)
            self.assertTrue(all(len(line) < columns for line in told if line.startswith("search")), told)
            self.assertLessEqual(len(told), 10 * lasted + 11)  # ten a second, and one for each phase that begins
            self.assertRegex(lines[-1], r"^studies/long\.json: ")  # the last line is wiped before anything else is said
            self.assertNotIn("\x1b", out)
            if columns == 200:
                self.assertRegex(running.said, r"\d s left of --time")

    def test_a_second_signal_wipes_the_line(self):
        running = Running(self.folder, "run", self.long)
        self.assertTrue(running.wait_for("first values"), running.said)
        running.send(signal.SIGSTOP, signal.SIGINT, signal.SIGTERM, signal.SIGCONT)
        self.assertIn(running.end()[0], (-signal.SIGINT, -signal.SIGTERM))
        self.assertTrue(running.said.endswith(WIPE), running.said)

    def test_several_studies_are_told_apart(self):
        running = Running(self.folder, "run", self.short, self.long, "--threads", "1")
        self.assertTrue(running.wait_for("long.json (2 of 2): search: "), running.said)
        running.send(signal.SIGINT)
        self.assertEqual(running.end()[0], 130)

    def test_short_runs_say_nothing_in_pipes(self):
        done = self.expect(0, "run", self.short)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)  # where the result is
        self.assertEqual(self.expect(0, "modes", "problems/beam.json").stderr, "")

    @unittest.skipUnless(EVERY, "waits for ten seconds: MT_EVERY=1")
    def test_a_pipe_gets_a_line_every_ten_seconds(self):
        done = self.run_program("run", self.long, "--time", "11", "--threads", "1")
        told = [line for line in done.stderr.splitlines() if line.startswith("search")]
        self.assertEqual(len(told), 1, done.stderr)
        self.assertRegex(told[0], r"^search: \d+ of 50000 (first values|starts), \d+ %, (best change 0\.\d+, )?(about .* left of this step, )?"
                                  r"\d s left of --time, 1\d s, \d+ designs evaluated, \d+ modal solutions$")

    def test_nothing_where_nothing_is_asked_for(self):
        for option in (("--progress", "none"), ("--quiet",)):
            running = Running(self.folder, "run", self.long, "--time", "0.5", "--threads", "1", *option)
            self.assertIn(running.end()[0], (0, 1))
            self.assertNotIn(WIPE, running.said)

    def test_results_do_not_depend_on_it(self):
        bytes_of = []
        small, torn = (self.write(f"studies/{name}.json", text.replace('"starts": 40', '"starts": 8')) for name, text in (("small", SHORT), ("torn", TORN)))
        # (without most of the proof, whose progress test_objects_for_programs looks at)
        for form in ("none", "json") if FEWER else ("none", "line", "json", "auto"):
            told = [self.expect(code, "run", study, "--progress", form, "--proof", "0.01", "-o", form).stdout for code, study in ((0, small), (1, torn))]
            bytes_of.append((*told, *((self.folder / form / name / "result.json").read_bytes() for name in ("small", "torn"))))
        self.assertEqual(len(set(bytes_of)), 1)

    def test_modes_tell_reading_and_iterations(self):
        found = self.objects(self.expect(0, "modes", self.write("problems/long.json", BEAM % 20000), "--count", "3", "--progress", "json").stderr)
        self.check_steps(found)
        self.assertEqual([f["phase"] for f in found if f["state"] == "done"], ["reading", "modes"])
        self.assertEqual(found[-1]["unit"], "iterations")
        self.assertGreater(found[-1]["done"], 0)

    def test_values_that_are_none(self):
        done = self.expect(2, "run", self.short, "--progress", "lines")
        self.assertIn('--progress: "lines" is not one of auto, line, json, none; did you mean "line"?', done.stderr)
        self.assertIn('"check" has no option "--progress"', self.expect(2, "check", self.short, "--progress", "json").stderr)


if __name__ == "__main__":
    main()

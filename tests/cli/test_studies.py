# SPDX-License-Identifier: GPL-3.0-or-later
"""run, compare and apply: files, exit status, and what happens when nothing can be written."""
import csv
import json
import math
import os
import pty
import re
import subprocess

from common_cli import MODEL, PROGRAM, CliTest, main, study

# What the study publishes.
HOLDS = ', "published": [ { "parameter": "k1", "value": 3, "tolerance_percent": 0.1, "source": "a, \\"b\\"" }, { "status": "solved" } ]'
FAILS = ', "published": [ { "parameter": "k1", "value": 5, "tolerance_percent": 0.1, "role": "verifies" } ]'
FILES = ["recommendations.csv", "report.html", "result.json", "timing.json"]


STAGES = ["program", "geometry", "tangent", "reduction", "stiffness", "mass", "modes"]


def stages(text):
    """Of --timing: stage to how often it was done, shared and skipped."""
    rows = re.findall(r"^  (\w+) +(\d+) +(\d+) +(\d+) +\S+ +\w", text, re.M)
    return {name: tuple(map(int, counts)) for name, *counts in rows}


class Profile(CliTest):
    def test_stages_of_modes_are_done_once(self):
        done = self.expect(0, "modes", self.write("model.json", MODEL), "--timing", "--format", "json")
        n = len(json.loads(done.stdout))  # configurations
        counts = stages(done.stderr)
        self.assertEqual(list(counts), STAGES)
        self.assertEqual(counts, {stage: (0 if stage == "tangent" else n, 0, 0) for stage in STAGES})

    def test_stages_of_a_study_are_counted_and_change_nothing(self):
        path = self.write("studies/two.json", study())
        without = self.expect(0, "run", path, "-o", "a")
        self.assertNotIn("geometry", without.stderr)
        counts = [stages(self.expect(0, "run", path, "-o", str(n), "--timing", "--threads", str(n)).stderr) for n in (1, 2)]
        for had in counts:
            self.assertEqual(list(had), STAGES)
            self.assertEqual(had["tangent"], (0, 0, 0))  # springs alone vary: the geometry stands
            self.assertGreater(had["program"][0], 10)
            self.assertEqual(had["geometry"][0], had["reduction"][0])
            self.assertLess(10 * had["geometry"][0], had["stiffness"][0] + 10)
            self.assertEqual(had["mass"][0], had["geometry"][0])
        files = [(self.folder / n / "two/result.json").read_bytes() for n in ("a", "1", "2")]
        self.assertEqual(files[0], files[1])
        self.assertEqual(files[0], files[2])


class Run(CliTest):
    def test_both_solutions_are_found_written_and_summarised(self):
        path = self.write("studies/two.json", study(extra=HOLDS))
        done = self.expect(0, "run", path)
        folder = self.folder / "results/two"
        self.assertEqual(sorted(p.name for p in folder.iterdir()), FILES)
        result = json.loads((folder / "result.json").read_text(encoding="utf-8"))
        self.assertEqual((result["format"], result["status"]), ("modetune-result/1", "solved"))
        found = sorted(tuple(p["recommended"] for p in r["parameters"]) for r in result["recommendations"])
        self.assertEqual(len(found), 2)
        for got, want in zip(found, [(2, 1.5), (3, 1)]):
            self.assertAlmostEqual(got[0], want[0], delta=1e-5)  # goals are met within 1e-4 %, and the slopes are about 1
            self.assertAlmostEqual(got[1], want[1], delta=1e-5)  # goals are met within 1e-4 %, and the slopes are about 1
        rows = list(csv.DictReader((folder / "recommendations.csv").read_text(encoding="utf-8").splitlines()))
        self.assertEqual([r["rank"] for r in rows], ["0", "1", "2"])
        self.assertEqual((rows[0]["k1 [N/m]"], rows[0]["k2 [N/m]"]), ("3", "1"))
        page = (folder / "report.html").read_text(encoding="utf-8")
        self.assertTrue(page.startswith("<!DOCTYPE html>") and page.endswith("</html>\n"))
        for part in ("Two springs\n", "\nParameters\n", "\nFrequencies\n", "\nWhy: what changes\n", "\nDesigns side by side\n"):
            self.assertIn(part, done.stdout)
        self.assertNotIn("Published", done.stdout)
        self.assertRegex(done.stderr, r"^studies/two.json: \S+ s, \d+ evaluations \(search \d+, descriptions 6\), \d+ modal solutions; written to results/two/\n$")

    def test_results_hold_no_time_or_path_and_repeat_byte_for_byte(self):
        path = self.write("studies/two.json", study(extra=HOLDS))
        self.expect(0, "run", path, "-o", "one", "--quiet")
        done = self.expect(0, "run", str(self.folder / path), "-o", "deep/er/two", "--quiet", "--threads", "2")
        self.assertEqual(done.stderr, "")
        for name in ("result.json", "recommendations.csv", "report.html"):
            a = (self.folder / "one/two" / name).read_bytes()
            self.assertEqual(a, (self.folder / "deep/er/two/two" / name).read_bytes())
            self.assertNotIn(str(self.folder).encode(), a)

    def test_exit_status_follows_the_goals_or_the_published_values(self):
        impossible = {"first_hz": 0.01, "second_hz": 0.0101}
        for want, options, given in ((0, [], {}), (1, [], impossible), (0, ["--verify"], {"extra": HOLDS}),
                                     (1, ["--verify"], {"extra": FAILS}), (0, [], {"extra": FAILS}),
                                     (2, ["--verify"], {}),
                                     (0, ["--verify"], dict(impossible, extra=', "published": [{ "status": "compromise" }]'))):
            with self.subTest(options=options, given=given):
                path = self.write("studies/s.json", study(**given))
                self.expect(want, "run", path, *options)

    def test_the_worst_of_several_studies_counts(self):
        good = self.write("studies/good.json", study())
        bad = self.write("studies/bad.json", study(first_hz=0.01, second_hz=0.0101))
        wrong = self.write("studies/wrong.json", "{}")
        self.expect(1, "run", good, bad)
        done = self.expect(2, "run", wrong, good)
        self.assertIn("Solved", done.stdout)
        self.expect(4, "run", "studies/none.json", wrong, good)
        self.assertEqual(len(self.json_of("run", good, bad, code=1)), 2)
        self.assertEqual(self.json_of("run", good)["status"], "solved")

    def test_two_studies_of_one_name_are_refused_before_anything_runs(self):
        (self.folder / "other").mkdir()
        first = self.write("studies/two.json", study())
        second = self.write("other/two.json", study())
        done = self.expect(2, "run", first, second)
        self.assertIn("would both be written to", done.stderr)
        self.assertFalse((self.folder / "results").exists())

    def test_verify_prints_the_published_table(self):
        path = self.write("studies/two.json", study(extra=HOLDS))
        text = self.expect(0, "run", path, "--verify").stdout
        self.assertIn("\nPublished against computed\n", text)
        self.assertIn("within 0.1 %", text)
        self.assertIn('a, "b"', text)

    def test_a_folder_that_cannot_be_written_is_4_and_leaves_nothing(self):
        path = self.write("studies/two.json", study())
        self.write("file", "in the way")
        done = self.expect(4, "run", path, "-o", "file")
        self.assertEqual(done.stderr, "modetune: error: file/two: Not a directory\n")
        self.expect(4, "run", path, "-o", "/proc/nowhere")
        (self.folder / "taken/two/result.json").mkdir(parents=True)
        self.expect(4, "run", path, "-o", "taken")
        self.assertEqual([p.name for p in (self.folder / "taken/two").iterdir()], ["result.json"])

    def test_root_keeps_files_inside(self):
        path = self.write("studies/two.json", study())
        self.assertIn("studies/two.json:1:", self.expect(2, "run", path, "--root", "studies").stderr)
        self.expect(0, "run", path, "--root", ".")


class Compare(CliTest):
    def test_table_and_exit_status(self):
        path = self.write("studies/two.json", study(extra=HOLDS))
        done = self.expect(0, "compare", path)
        self.assertRegex(done.stdout, r"k1 +3 +3\.00000 ")
        self.assertFalse((self.folder / "results").exists())
        got = self.json_of("compare", path)
        self.assertEqual([p["holds"] for p in got["published"]], [True, True])
        self.assertEqual(got["published"][1]["computed"], "solved")
        rows = self.expect(0, "compare", path, "--format", "csv").stdout
        self.assertIn('"a, ""b"""', rows)
        self.write("studies/two.json", study(extra=FAILS))
        self.assertIn("FAILS", self.expect(1, "compare", path).stdout)
        self.write("studies/two.json", study())
        self.assertIn("no published values to judge", self.expect(2, "compare", path).stderr)

    def test_every_objective_has_its_value_everywhere(self):
        order = ', "objective": [ { "minimise": "k1 + k2" }, { "minimise": "change" } ]'
        path = self.write("studies/two.json", study(extra=order + HOLDS.replace("3,", "2,")))
        self.expect(0, "run", path, "-o", ".")
        result = json.loads((self.folder / "two/result.json").read_text(encoding="utf-8"))
        change = math.hypot(math.log(2 / 3), math.log(1.5))  # (3, 1), the original, and (2, 1.5) meet the goals
        for design, wanted in [(result["baseline"], (4, 0)), *zip(result["recommendations"], ((3.5, change), (4, 0)), strict=True)]:
            self.assertEqual([o["text"] for o in design["objectives"]], ["k1 + k2", "change"])
            for told, value, original in zip(design["objectives"], wanted, (4, 0)):
                self.assertAlmostEqual(told["recommended"], value, delta=1e-5)
                self.assertAlmostEqual(told["original"], original, delta=1e-12)
        self.assertEqual(self.json_of("compare", path)["objectives"], result["recommendations"][0]["objectives"])
        row = r"k1 \+ k2 +4\.00000 +3\.50000\n +change +0 +0\.5734"
        for args in (["run", path, "-o", "."], ["compare", path]):
            self.assertRegex(self.expect(0, *args).stdout, row)
        with open(self.folder / "two/recommendations.csv", encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([round(float(r["objective k1 + k2"]), 4) for r in rows], [4, 3.5, 4])
        self.assertEqual([round(float(r["change"]), 4) for r in rows], [0, round(change, 4), 0])
        page = (self.folder / "two/report.html").read_text(encoding="utf-8")
        self.assertIn('<td>k1 + k2</td><td>-</td><td class="n">4.00000</td><td class="n">3.50000</td>', page)


class Apply(CliTest):
    def setUp(self):
        super().setUp()
        self.study = self.write("studies/two.json", study(extra=HOLDS))
        self.expect(0, "run", self.study)

    def applied(self, *args, code=0):
        return self.expect(code, "apply", "results/two/result.json", *args)

    def test_only_the_values_change(self):
        result = json.loads((self.folder / "results/two/result.json").read_text(encoding="utf-8"))
        for rank in (1, 2):
            text = self.applied("--rank", str(rank)).stdout
            k1, k2 = (p["recommended"] for p in result["recommendations"][rank - 1]["parameters"])
            self.assertEqual(json.loads(text)["parameters"]["k1"]["value"], k1)
            self.assertEqual(json.loads(text)["parameters"]["k2"]["value"], k2)
            back = re.sub(r'("k1": \{ "value": )[^,]*', r"\g<1>3", text)
            self.assertEqual(re.sub(r'("k2": \{"value":)[^,]*', r"\g<1>1e0", back), MODEL)

    def test_the_applied_model_has_the_frequencies(self):
        self.write("problems/new.json", self.applied("--rank", "2").stdout)
        hz = [m["frequency_hz"] for m in self.json_of("modes", "problems/new.json", "-c", "held")["modes"]]
        for got, squared in zip(hz, ((5 - math.sqrt(13)) / 2, (5 + math.sqrt(13)) / 2)):
            self.assertAlmostEqual(got * 2 * math.pi / math.sqrt(squared), 1, delta=1e-6)  # the goals' tolerance

    def test_a_rank_that_is_not_there(self):
        self.assertEqual(self.applied("--rank", "3", code=2).stderr,
                         "modetune: error: results/two/result.json has 2 recommendations: there is no rank 3\n")

    def test_a_changed_model_is_not_taken_unless_named(self):
        self.write("problems/model.json", MODEL + "\n")
        self.assertIn("name it with --model", self.applied(code=2).stderr)
        done = self.applied("--model", "problems/model.json")
        self.assertIn("modetune: warning: problems/model.json is not what was solved", done.stderr)
        self.assertTrue(done.stdout.endswith("}\n\n"))

    def test_a_result_of_another_version_says_so(self):
        path = self.folder / "results/two/result.json"
        text = path.read_text(encoding="utf-8")
        self.write("other.json", re.sub('"modetune": "[^"]*"', '"modetune": "0.0.1"', text))
        self.assertIn("was written by modetune 0.0.1", self.expect(0, "apply", "other.json").stderr)

    def test_the_model_is_found_without_timing_and_from_elsewhere(self):
        (self.folder / "results/two/timing.json").unlink()
        self.applied()
        self.expect(0, "run", self.study, "-o", str(self.folder / "far/away/out"))
        os.chdir("/")
        done = subprocess.run([PROGRAM, "apply", self.folder / "far/away/out/two/result.json"], cwd="/",
                              capture_output=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_a_result_that_was_tampered_with_is_refused(self):
        path = self.folder / "results/two/result.json"
        text = path.read_text(encoding="utf-8")
        for old, new, want in (('"name": "k2"', '"name": "k1"', '/parameters/1/name: must be "k2"'),
                               ('"variables": [\n    "k1"', '"variables": [\n    "k2"', '"k2" is listed twice'),
                               ('"recommended": 3', '"recommended": null, "x": 3', 'unknown member "x"'),
                               ('"recommended": 3', '"recommended": null', 'recommends no value of "k1"'),
                               ('"reasons": ', '"reason": ', 'member "reasons" is missing')):
            with self.subTest(new):
                self.assertIn(old, text)
                self.write("other.json", text.replace(old, new))
                self.assertIn(want, self.expect(2, "apply", "other.json").stderr)

    def test_a_report_is_what_the_run_told(self):
        folder = self.folder / "results/two"
        ran = {p.name: p.read_bytes() for p in folder.iterdir()}
        summary = self.expect(0, "run", self.study).stdout
        self.write("alone.json", ran["result.json"].decode())
        (folder / "report.html").unlink()
        for line in (("results/two/result.json", "-o", "results"), ("alone.json", "-o", "again"), ("alone.json",)):
            self.assertEqual(self.expect(0, "report", *line).stdout, summary)
        self.assertEqual({p.name: p.read_bytes() for p in folder.iterdir()} | {"timing.json": b""}, ran | {"timing.json": b""})
        self.assertIn(b"result_sha256", (folder / "timing.json").read_bytes())
        del ran["timing.json"]  # beside alone.json there is none
        self.assertEqual({p.name: p.read_bytes() for p in (self.folder / "again/two").iterdir()}, ran)
        for form, name in (("html", "report.html"), ("csv", "recommendations.csv"), ("json", "result.json")):
            self.assertEqual(self.expect(0, "report", "alone.json", "--format", form).stdout.encode(), ran[name].replace(b"\r\n", b"\n"))

    def test_a_report_of_another_program_names_its_own_files(self):
        text = (self.folder / "results/two/result.json").read_text(encoding="utf-8")
        self.write("other.json", re.sub('"modetune": "[^"]*"', '"modetune": "0.0.1"', text))
        self.expect(0, "report", "other.json", "-o", "again")
        self.assertIn("0.0.1", (self.folder / "again/two/report.html").read_text(encoding="utf-8"))
        self.expect(0, "check", "again/two/result.json")
        self.write("other.json", text.replace('"file": "two.json"', '"file": "x/.."', 1))
        self.assertIn("is not the name of a file", self.expect(2, "report", "other.json", "-o", "again").stderr)

    def test_check_knows_results_and_studies(self):
        self.assertEqual(self.expect(0, "check", "results/two/result.json", self.study).stdout,
                         "results/two/result.json: ok (result)\nstudies/two.json: ok (study)\n")


class Output(CliTest):
    def test_a_closed_pipe_is_quiet_and_4(self):
        read, write = os.pipe()
        os.close(read)
        done = subprocess.run([PROGRAM, "modes", self.model], cwd=self.folder, stdout=write, stderr=subprocess.PIPE,
                              check=False)
        os.close(write)
        self.assertEqual((done.returncode, done.stderr), (4, b""))

    def test_a_full_device_is_told_and_4(self):
        with open("/dev/full", "wb") as full:
            done = subprocess.run([PROGRAM, "modes", self.model], cwd=self.folder, stdout=full,
                                  stderr=subprocess.PIPE, check=False)
        self.assertEqual((done.returncode, done.stderr),
                         (4, b"modetune: error: standard output: No space left on device\n"))

    def on_terminal(self, **environment):
        """Standard error of a failing command when that is a terminal."""
        master, slave = pty.openpty()
        env = {k: v for k, v in os.environ.items() if k not in ("NO_COLOR", "TERM")}
        subprocess.run([PROGRAM, "check", self.write("bad.json", "{}"), "none.json"], cwd=self.folder,
                       stdout=slave, stderr=slave, env=dict(env, **environment), check=False)
        os.close(slave)
        text = b""
        try:
            while True:  # a terminal hands on what was written in parts of its own
                text += os.read(master, 65536)
        except OSError:  # the other end is closed, and all has been read
            os.close(master)
        return text

    def test_colour_on_a_terminal_only_and_never_under_no_color(self):
        self.assertEqual(self.on_terminal(TERM="xterm").count(b"\033[1;31merror"), 2)
        self.assertNotIn(b"\033", self.on_terminal(TERM="xterm", NO_COLOR="1"))
        self.assertNotIn(b"\033", self.on_terminal(TERM="dumb"))
        self.assertNotIn("\033", self.expect(2, "check", "bad.json", env={"TERM": "xterm"}).stderr)


if __name__ == "__main__":
    main()

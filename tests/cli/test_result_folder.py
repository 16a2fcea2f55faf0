# SPDX-License-Identifier: GPL-3.0-or-later
"""A result folder is one unit, and every command survives every call to the system that fails.

MT_FAULTS_EVERY=1 tries every error at every call (else at one of 48, of the run alone at one of 16, with MT_EVERY=1 of four, and the first of each function of a quarter of the commands), MT_FAULTS_KILLS=N kills so many runs of the program
(default 4, with MT_EVERY=1 eight), MT_FAULTS_SEED=S chooses where. tests/io/test_folder_faults.c does the same to the writing of the folder alone, at every call.
"""
import errno
import json
import os
import random
import re
import resource
import shutil
import subprocess
import unittest

from common_cli import COMMANDS, PROGRAM, SOURCE, CliTest, main, study
from suite import EVERY as ALL, INSTRUMENTED, LAUNCHED

FAULTY = os.environ.get("MODETUNE_FAULTS", os.path.join(os.path.dirname(PROGRAM), "tests/modetune_faults"))
EVERY = os.environ.get("MT_FAULTS_EVERY", "0") != "0"
SEED = int(os.environ.get("MT_FAULTS_SEED", "1"))
FEW = not (EVERY or INSTRUMENTED or ALL)
STRIDE = 1 if EVERY else 30 if INSTRUMENTED else 4 if ALL else 48  # of a command's calls
ERRORS = [errno.EIO, errno.ENOSPC, errno.EMFILE, errno.EDQUOT, errno.EINTR]
FILES = ["recommendations.csv", "report.html", "result.json", "timing.json"]
ONE_START = ', "search": { "starts": 1 }'
TRADE = ONE_START + ', "trade": { "vary": [ { "variable": "k1", "bound": "upper", "values": [50, 100] } ] }'
# What each command is driven with; run is driven apart, too.
LINES = {
    "modes": ["modes", "problems/model.json", "--shapes"],
    "mac": ["mac", "problems/model.json:held", "problems/model.json:twice"],
    "sweep": ["sweep", "problems/model.json", "-c", "held", "--drive", "ra=-0.1:0.1:3", "--frequencies"],
    "simulate": ["simulate", "problems/model.json", "-c", "held", "--start", "ra=0.1", "--duration", "0.1"],
    "sensitivity": ["sensitivity", "problems/model.json", "-c", "held", "--format", "csv"],
    "response": ["response", "problems/model.json", "-c", "held", "--input", "a.x", "--format", "csv"],
    "info": ["info", "problems/model.json", "--format", "json"],
    "check": ["check", "studies/two.json", "results/two/result.json"],
    "catalogue": ["check", str(SOURCE / "studies/inceptor_catalogue.json")],
    "report": ["report", "results/two/result.json", "--format", "html"],
    "apply": ["apply", "results/two/result.json"],
    "apply --model": ["apply", "results/two/result.json", "--model", "problems/model.json", "--root", "problems"],
    "explain": ["explain", "results/two/result.json"],
    "show": ["show", "results/two/result.json"],
    "diff": ["diff", "results/two", "results/two/result.json", "--format", "csv"],
    "compare": ["compare", "studies/judged.json"],
    "init": ["init", "mine", "--quiet"],
    "examples": ["examples", "truss_72bar", "-o", "shipped"],
    "schema": ["schema", "model"],
    "profile": ["profile", "gevs_qualification", "--spectrum", "10:100:3"],
    "help": ["help", "avoid"],
    "run": ["run", "studies/two.json", "--format", "csv"],
    "run two": ["run", "studies/two.json", "studies/judged.json", "--format", "csv"],
    "merge": ["merge", "studies/two.json", "results/two.1-of-1.journal", "--format", "csv"],
    "--help": ["run", "--help"],
    "--version": ["--version"],
}
HOLDS = ONE_START + ', "published": [ { "status": "solved" } ]'


class FolderTest(CliTest):
    def setUp(self):
        super().setUp()
        self.write("studies/two.json", study(extra=ONE_START))
        self.write("studies/judged.json", study(extra=HOLDS))
        self.results = self.folder / "results/two"

    def faulty(self, args, fault=None, **more):
        env = {"MT_FAULT": fault} if fault else {}
        return subprocess.run([FAULTY, *args], cwd=self.folder, env=dict(os.environ, **env), capture_output=True,
                              encoding="utf-8", timeout=600, check=False, **more)

    def calls(self, args):
        """Names of the calls to the system that the command makes."""
        log = self.folder / "calls.log"
        done = subprocess.run([FAULTY, *args], cwd=self.folder, env=dict(os.environ, MT_FAULT_LOG=str(log)),
                              capture_output=True, encoding="utf-8", timeout=600, check=False)
        names = log.read_text(encoding="utf-8").split()
        log.unlink()
        return done, names

    def files(self):
        """Names and contents of the folder's files, but for the clock's number."""
        if not self.results.is_dir():
            return {}
        return {p.name: re.sub(rb'"solve_s": .*', b"", p.read_bytes()) for p in self.results.iterdir()}

    def unit_of(self, extra, name="two"):
        """The files that this study's run writes."""
        self.write(f"studies/{name}.json", study(extra=extra))
        self.expect(0, "run", f"studies/{name}.json", "--quiet")
        return self.files()


class Belonging(FolderTest):
    def setUp(self):
        super().setUp()
        self.expect(0, "run", "studies/two.json")

    def refused(self, path="results/two/result.json"):
        done = self.expect(2, "apply", path)
        self.assertEqual(done.stdout, "")
        checked = self.expect(2, "check", path)
        self.assertIn(done.stderr.removeprefix("modetune: error: "), checked.stderr)
        return done.stderr

    def test_the_result_names_what_stands_beside_it(self):
        outputs = json.loads((self.results / "result.json").read_text(encoding="utf-8"))["run"]["outputs"]
        self.assertEqual([o["file"] for o in outputs], ["recommendations.csv", "report.html"])
        self.assertEqual(self.json_of("run", "studies/two.json")["run"]["outputs"], [])
        self.assertEqual(sorted(self.files()), FILES)

    def test_without_a_report_the_old_one_goes_and_is_made_later(self):
        path = self.results / "result.json"
        full, page = path.read_bytes(), (self.results / "report.html").read_bytes()
        self.expect(0, "run", "studies/two.json", "--report", "none")
        self.assertEqual(sorted(self.files()), [name for name in FILES if name != "report.html"])
        bare = json.loads(path.read_text(encoding="utf-8"))
        self.assertEqual([o["file"] for o in bare["run"]["outputs"]], ["recommendations.csv"])
        self.assertEqual({**bare, "run": None}, {**json.loads(full), "run": None})
        self.expect(0, "report", "results/two", "--output", "results")
        self.assertEqual((self.results / "report.html").read_bytes(), page)
        self.assertEqual(path.read_bytes(), full)
        self.expect(0, "run", "studies/two.json", "--report", "html")
        self.assertEqual(path.read_bytes(), full)
        self.assertIn('--report: "htm" is not one of html, none; did you mean "html"?',
                      self.expect(2, "run", "studies/two.json", "--report", "htm").stderr)
        self.expect(0, "run", "studies/two.json", "studies/judged.json", "--report", "none", "--quiet")
        self.assertNotIn("<a ", (self.folder / "results/index.html").read_text(encoding="utf-8"))

    def test_a_changed_file_is_named_and_what_to_do(self):
        for name in FILES:
            with self.subTest(name):
                path = self.results / name
                text = path.read_bytes()
                path.write_bytes(text.replace(b'_sha256": "', b'_sha256": "0') if name == "timing.json" else text + b"\n")
                said = self.refused()
                self.assertIn('"timing.json" beside it is not' if name == "result.json" else f'"{name}" beside it is not', said)
                self.assertIn("Run the study again, or copy the result.json that you trust", said)
                path.write_bytes(text)
                if name != "result.json":
                    path.unlink()
                    path.mkdir()
                    self.assertIn(f'"{name}" beside it', self.refused())
                    path.rmdir()
                    self.expect(0, "apply", "results/two/result.json")  # what is not there contradicts nothing
                    path.write_bytes(text)
        self.expect(0, "apply", "results/two/result.json")

    def test_a_file_that_the_result_does_not_have_is_refused(self):
        (self.results / "trade.csv").write_text("of an older study", encoding="utf-8")
        self.assertIn('"trade.csv" beside it', self.refused())
        self.expect(0, "run", "studies/two.json")
        self.assertEqual(sorted(self.files()), FILES)

    def test_a_copy_that_stands_alone_or_under_another_name_is_read(self):
        whole = self.expect(0, "apply", "results/two/result.json").stdout
        (self.folder / "alone").mkdir()
        shutil.copy(self.results / "result.json", self.folder / "alone")
        shutil.copy(self.results / "result.json", self.results / "kept.json")
        (self.results / "report.html").write_text("changed", encoding="utf-8")
        self.assertEqual(self.expect(0, "apply", "alone/result.json").stdout, whole)
        self.assertEqual(self.expect(0, "apply", "results/two/kept.json").stdout, whole)
        self.refused()

    def test_a_result_of_an_older_build_is_refused(self):
        path = self.results / "result.json"
        result = json.loads(path.read_text(encoding="utf-8"))
        del result["run"]["outputs"]
        path.write_text(json.dumps(result), encoding="utf-8")
        self.assertIn('/run: member "outputs" is missing', self.expect(2, "apply", "results/two/result.json").stderr)

    def test_outputs_that_lead_elsewhere_are_refused(self):
        path = self.results / "result.json"
        text = path.read_text(encoding="utf-8")
        path.write_text(text.replace('"report.html"', '"../../studies/two.json"'), encoding="utf-8")
        self.assertIn('error: /run/outputs/1/file: "../../studies/two.json" is not a file beside it', self.refused())
        result = json.loads(text)
        result["run"]["outputs"] *= 9
        path.write_text(json.dumps(result), encoding="utf-8")
        self.assertIn("error: /run/outputs: names more than 16 files", self.refused())

    def test_a_replacement_that_was_cut_is_told(self):
        (self.results / ".modetune-new.result.json").write_text("hal", encoding="utf-8")
        self.expect(0, "apply", "results/two/result.json")  # nothing is replaced yet
        (self.results / "report.html").rename(self.results / ".modetune-old.report.html")
        self.assertIn('a run ended while it replaced the files of this folder, and "report.html" is not of this result: '
                      "run the study again\n", self.refused())
        self.expect(0, "run", "studies/two.json")
        self.assertEqual(sorted(self.files()), FILES)


class Names(FolderTest):
    def test_no_name_leads_out_of_the_folder_for_results(self):
        for name, folder in (("...json", "...json"), ("..json", "..json"), (".json", ".json"), ("a b\n\u00e9.json", "a b\n\u00e9"),
                             ("....json", "..."), ("x", "x"), ("-o.json", "-o"), ("a.json.json", "a.json")):
            with self.subTest(name):
                self.write("studies/" + name, study(extra=ONE_START))
                self.expect(0, "run", "studies/" + name, "-o", "out", "--quiet")
                self.assertEqual([p.name for p in (self.folder / "out").iterdir()], [folder])
                self.assertEqual(sorted(p.name for p in (self.folder / "out" / folder).iterdir()), FILES)
                self.expect(0, "apply", f"out/{folder}/result.json")
                shutil.rmtree(self.folder / "out")
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["problems", "studies"])

    def test_folders_are_no_studies(self):
        for name in ("studies/..", ".", "studies/", ""):
            self.assertIn("is not the name of a file", self.expect(2, "run", name).stderr)
        self.assertFalse((self.folder / "results").exists())

    def test_two_studies_of_one_folder_are_refused_before_anything_runs(self):
        other = self.write("studies/other.json", study(extra=ONE_START))
        (self.folder / "more").mkdir()
        again = self.write("more/two.json", study(extra=ONE_START))
        self.assertIn("studies/two.json and more/two.json would both be written to \"results/two\"",
                      self.expect(2, "run", "studies/two.json", other, again).stderr)
        self.assertFalse((self.folder / "results").exists())
        self.results.mkdir(parents=True)
        (self.folder / "results/other").symlink_to("two")
        self.assertIn("studies/two.json and studies/other.json would both be written",
                      self.expect(2, "run", "studies/two.json", other).stderr)
        self.assertEqual(self.files(), {})


class EveryCall(FolderTest):
    def check_command(self, name, k, function, error, mode, whole):
        """The k-th call fails: the same output all the same, or 4 with a message."""
        done = self.faulty(LINES[name], f"{k}:{mode}:{error}")
        what = f"{name}: {mode} {k} {function} {errno.errorcode[error]}: {done.returncode} {done.stderr}"
        if done.returncode == whole.returncode:
            self.assertEqual(done.stdout, whole.stdout, what)
        else:
            self.assertEqual(done.returncode, 4, what)
            # nothing can be written any more: neither the files nor, then, standard output
            several = ("check", "catalogue", "run two", *(("merge",) if mode == "ever" else ()))
            self.assertTrue(done.stderr.count("modetune: error: ") == 1 or name in several, what)
            self.assertGreater(len(done.stderr), 20, what)
        return done, what

    def test_every_command_says_so_with_4_or_does_without(self):
        self.assertEqual(set(COMMANDS) - set(LINES), set())
        for name in ("init", "examples"):  # what they write is there then, in every call
            self.expect(0, *LINES[name])
        self.expect(0, "run", "studies/two.json", "--shard", "1/1")
        self.expect(0, "run", "studies/two.json")
        for number, (name, line) in enumerate(LINES.items()):
            if name == "run":
                continue
            whole, calls = self.calls(line)
            self.assertEqual(whole.returncode, 0, whole.stderr)
            self.assertGreater(len(calls), 0)
            for k, function in enumerate(calls):
                first = calls.index(function) == k and (STRIDE == 4 or (k + number) % (4 if FEW else 2) == 0)
                if not (EVERY or first or k % STRIDE == SEED % STRIDE):
                    continue
                for i, error in enumerate(ERRORS):
                    if EVERY or k % len(ERRORS) == i:
                        done, what = self.check_command(name, k, function, error, "fail", whole)
                        # (of the places where apply, report and show look for the model they may do without some, and run where it asks
                        # for the permissions of what it replaces)
                        if function in ("write", "open") and error != errno.EINTR and name not in ("apply", "report", "show", "merge", "run two"):
                            self.assertEqual(done.returncode, 4, what)
                if EVERY or k == 0 or k % (2 * STRIDE) == SEED % STRIDE:
                    self.check_command(name, k, function, errno.EIO, "ever", whole)

    def test_run_leaves_the_old_result_or_the_new_one(self):
        new = self.unit_of(ONE_START)
        old = self.unit_of(TRADE)
        self.write("studies/two.json", study(extra=ONE_START))
        whole, calls = self.calls(LINES["run"])
        self.assertEqual(self.files(), new)
        backup = self.folder / "backup"
        stride = 16 if FEW else STRIDE
        for k, function in list(enumerate(calls))[SEED % stride::stride]:
            for i, error in enumerate(ERRORS):
                if not EVERY and k % len(ERRORS) != i:
                    continue
                if not backup.exists():
                    self.assertEqual(self.unit_of(TRADE), old)
                    self.write("studies/two.json", study(extra=ONE_START))
                    shutil.copytree(self.results, backup)
                shutil.rmtree(self.results)
                shutil.copytree(backup, self.results)
                done, what = self.check_command("run", k, function, error, "fail", whole)
                files = {n: t for n, t in self.files().items() if function != "unlinkat" or not n.startswith(".modetune-")}
                files.pop("timing.json")
                names = set(files)
                self.assertIn(files, [{n: u[n] for n in u if n != "timing.json"} for u in (old, new)], f"{what} {names}")
                self.expect(0, "apply", "results/two/result.json")

    def test_killed_runs_are_old_new_or_refused_and_mended(self):
        chance = random.Random(SEED)
        new = self.unit_of(ONE_START)
        old = self.unit_of(TRADE)
        backup = self.folder / "backup"
        shutil.copytree(self.results, backup)
        self.write("studies/two.json", study(extra=ONE_START))
        count = len(self.calls(LINES["run"])[1])
        for _ in range(int(os.environ.get("MT_FAULTS_KILLS", "4" if FEW else "8"))):
            k, how = chance.randrange(count), chance.choice(["kill", "tear"])
            shutil.rmtree(self.results)
            shutil.copytree(backup, self.results)
            self.assertEqual(self.faulty(LINES["run"], f"{k}:{how}").returncode, -9)
            done = self.run_program("apply", "results/two/result.json")
            what = f"seed {SEED}: {how} {k} of {count}: {done.stderr}"
            if done.returncode == 0:
                files = {n: t for n, t in self.files().items() if not n.startswith(".modetune-")}
                files["timing.json"] = (new if files["result.json"] == new["result.json"] else old)["timing.json"]
                self.assertIn(files, (old, new), what)
            else:
                self.assertEqual(done.returncode, 2, what)
                self.assertIn("run the study again", done.stderr, what)
            self.expect(0, "run", "studies/two.json")
            self.assertEqual(self.files(), new, what)

    def test_runs_at_the_same_time_leave_one_result(self):
        units = []
        for i, extra in enumerate((ONE_START, TRADE)):
            self.unit_of(extra)
            (self.folder / f"studies{i}").mkdir()
            shutil.copy(self.folder / "studies/two.json", self.folder / f"studies{i}")
            units.append({n: t for n, t in self.files().items() if n != "timing.json"})
        for count in (2, 8):
            running = [subprocess.Popen([PROGRAM, "run", "--quiet", f"studies{i % 2}/two.json"], cwd=self.folder,
                                        stdout=subprocess.DEVNULL) for i in range(count)]
            self.assertEqual([r.wait(300) for r in running], [0] * count)
            files = self.files()
            files.pop("timing.json")
            self.assertIn(files, units)
            self.expect(0, "apply", "results/two/result.json")


class Streams(FolderTest):
    def setUp(self):
        super().setUp()
        self.expect(0, "run", "studies/two.json", "--shard", "1/1")
        self.expect(0, "run", "studies/two.json")

    def streams(self, args, stdout, limit=None):
        def restrict():
            if limit is not None:
                resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
        return subprocess.run([PROGRAM, *args], cwd=self.folder, stdout=stdout, stderr=subprocess.PIPE, encoding="utf-8",
                              preexec_fn=restrict, timeout=600, check=False)

    def test_a_full_device_is_told_and_4_in_every_command(self):
        for name, line in list(LINES.items())[::2 if FEW else 1]:
            with self.subTest(name), open("/dev/full", "wb") as full:
                done = self.streams(line, full)
                self.assertEqual(done.returncode, 4)
                self.assertIn("modetune: error: standard output: No space left on device\n", done.stderr)

    def test_a_closed_pipe_is_quiet_and_4_in_every_command(self):
        for name, line in list(LINES.items())[1 if FEW else 0::2 if FEW else 1]:
            with self.subTest(name):
                read, write = os.pipe()
                os.close(read)
                done = self.streams(line + (["--quiet"] if name.startswith(("run", "merge")) else []), write)
                os.close(write)
                self.assertEqual((done.returncode, done.stderr if name != "catalogue" else ""), (4, ""))
                self.assertNotIn("error", done.stderr)

    def test_a_limit_of_size_is_an_error_not_a_signal(self):
        with open(self.folder / "out", "wb") as out:
            done = self.streams(LINES["modes"], out, limit=100)
        self.assertEqual((done.returncode, done.stderr), (4, "modetune: error: standard output: File too large\n"))
        before = self.files()
        self.write("studies/two.json", study(extra=TRADE))
        done = self.streams(["run", "--quiet", "studies/two.json"], subprocess.DEVNULL, limit=1000)
        self.assertEqual((done.returncode, done.stderr),
                         (4, "modetune: error: results/two/result.json: File too large\n"))
        self.assertEqual(self.files(), before)

    @unittest.skipIf(LAUNCHED, "the launcher needs its streams")
    def test_closed_streams_are_4_and_no_file_is_written_into(self):
        new = self.files()
        for closed in (">&-", "2>&-", "<&- >&- 2>&-"):
            with self.subTest(closed):
                shutil.rmtree(self.results)
                done = subprocess.run(["sh", "-c", f'"$0" run studies/two.json {closed}', PROGRAM], cwd=self.folder,
                                      stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
                self.assertEqual(done.returncode, 4 if ">&-" in closed.replace("2>&-", "") else 0)
                self.assertEqual(self.files(), new)


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""SIGINT and SIGTERM: run ends with the best so far, every other command ends by the signal. Signals are sent when the program is seen to be at work, never after a time."""
import fcntl
import json
import os
import pty
import re
import signal
import struct
import subprocess
import tempfile
import termios
import unittest
from pathlib import Path

from common_cli import PROGRAM, CliTest, main
from suite import LAUNCHED

# A beam whose modes take the longer the more elements it has, and a search among them that no test waits for.
BEAM = """{ "format": "modetune-model/1", "dimension": 2, "parameters": { "E": 1e9, "m": 1 },
  "points": { "a": [0, 0], "b": [1, 0] },
  "links": [ { "name": "beam", "kind": "beam", "from": "a", "to": "b", "elements": %d, "youngs_modulus_pa": "E",
               "density_kg_per_m3": "m/1e-4", "section": { "shape": "rectangle", "width_m": 0.01, "height_m": 0.01 } } ] }
"""
LONG = """{ "format": "modetune-study/1", "model": "../problems/beam.json",
  "variables": [ { "parameter": "E", "lower": 1e8, "upper": 1e10 }, { "parameter": "m", "lower": 0.1, "upper": 10 } ],
  "goals": [ { "type": "frequency", "mode": 1, "target_hz": 5 } ],
  "search": { "starts": 5000, "max_evaluations": 1000000000 } }
"""
# A driven arm, for a sweep of as many positions as a test likes.
ARM = """{ "format": "modetune-model/1", "dimension": 2,
  "bodies": [ { "name": "arm", "mass_kg": 1, "inertia_kg_m2": 1, "centre": [1, 0] } ],
  "joints": [ { "name": "hinge", "type": "revolute", "bodies": ["ground", "arm"], "at": [0, 0] } ] }
"""
ENDS = (-signal.SIGINT, -signal.SIGTERM)
# A file with so many blanks behind it is more than all that a program reads to be loaded.
BLANKS = " " * (1 << 17)


def at_default():
    """A test in the background of a shell has SIGINT ignored, and would hand that on."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def ignoring():
    signal.signal(signal.SIGINT, signal.SIG_IGN)


class Running:
    """A run of the program whose standard error is a terminal, where it tells how far it is."""

    def __init__(self, folder, *args, before=at_default, columns=200):
        self.master, slave = pty.openpty()
        fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("4H", 24, columns, 0, 0))
        self.process = subprocess.Popen([PROGRAM, *args], cwd=folder, stdout=subprocess.PIPE, stderr=slave,
                                        encoding="utf-8", preexec_fn=before)
        os.close(slave)
        self.said = ""

    def read(self):
        try:
            more = os.read(self.master, 4096).decode("utf-8", "replace")
        except OSError:  # the other end is closed
            more = ""
        self.said += more
        return more

    def wait_for(self, text):
        """Until it is said once more than so far; False where the program ends before."""
        count = self.said.count(text)
        while self.said.count(text) == count:
            if not self.read():
                return False
        return True

    def wait_for_designs(self, count):
        """Until a search says that it has evaluated so many."""
        while not any(int(n) >= count for n in re.findall(r"search: [^\r]*?(\d+) designs evaluated", self.said[-400:])):
            if not self.read():
                return False
        return True

    def send(self, *numbers):
        for number in numbers:
            self.process.send_signal(number)

    def end(self):
        """Status and standard output, all that is said read meanwhile."""
        while self.read():
            pass
        out, _ = self.process.communicate(timeout=300)
        os.close(self.master)
        return self.process.returncode, out


class Run(CliTest):
    def setUp(self):
        super().setUp()
        # of twelve links the search goes on for seconds of CPU time after the starts are evaluated, however fast the machine
        self.write("problems/beam.json", BEAM % 12)
        self.long, self.other = (self.write(f"studies/{name}.json", LONG) for name in ("long", "other"))

    def result(self, name="long"):
        return json.loads((self.folder / f"results/{name}/result.json").read_text(encoding="utf-8"))

    def at_work(self, *args, **options):
        running = Running(self.folder, "run", *args, **options)
        self.assertTrue(running.wait_for_designs(5500), running.said)  # the starts, and searches from some
        return running

    def test_the_best_so_far_is_written_and_130(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(number):
                running = self.at_work(self.long)
                running.send(number)
                code, out = running.end()
                self.assertEqual(code, 130, running.said)
                result = self.result()
                self.assertEqual((result["status"], result["run"]["cut_by"]), ("interrupted", "interrupt"))
                self.assertEqual((result["certificates"], result["undetermined"]), (None, None))
                # a slow machine has not analysed all designs anew when the quarter of a second for it is over
                late = "recommendations" in result["run"]["incomplete"]
                parts = ["search", *(["recommendations"] if late else []), "certificates", "relaxations"]
                self.assertEqual(result["run"]["incomplete"], parts)
                self.assertIn(f"Interrupted (not complete: {', '.join(parts[:-1])} and {parts[-1]})", out)
                told = result["unchecked"]
                self.assertEqual(bool(told), late)
                self.assertGreaterEqual(len(result["recommendations"]) + len(told), 1)
                for best in result["recommendations"][:1]:
                    self.assertTrue(best["feasible"])
                    self.assertAlmostEqual(best["frequencies"][0]["recommended_hz"], 5, delta=1e-4)
                    self.assertIn("The search was interrupted: better designs may exist.", [r["text"] for r in best["reasons"]])

    def test_what_was_not_begun_is_said(self):
        running = self.at_work(self.long, self.other, "--format", "json")
        running.send(signal.SIGINT)
        code, out = running.end()
        self.assertEqual(code, 130)
        self.assertIn("interrupted; not answered: studies/other.json\r\n", running.said)
        self.assertEqual([r["status"] for r in json.loads(out)], ["interrupted"])
        self.assertEqual(sorted(p.name for p in (self.folder / "results").iterdir()), ["index.html", "index.json", "long", "long.journal"])

    def test_the_index_says_what_was_not_run(self):
        quick = self.write("studies/quick.json", LONG.replace("5000", "4"))
        running = self.at_work(quick, self.long, self.other)
        running.send(signal.SIGINT)
        code, out = running.end()
        self.assertEqual(code, 130, running.said)
        index = json.loads((self.folder / "results/index.json").read_text(encoding="utf-8"))
        self.assertEqual([(s["file"], s["state"], s["status"], s["exit_status"]) for s in index["studies"]],
                         [("quick.json", "answered", "solved", 0), ("long.json", "answered", "interrupted", 130),
                          ("other.json", "not run", None, None)])
        self.assertRegex(out, r"\n  studies/other\.json +not run +- +- +-\n$")
        self.assertIn("modetune: error: interrupted; not answered: studies/other.json", running.said)
        self.assertFalse((self.folder / "results/other").exists())

    def test_what_cannot_be_written_is_4(self):
        running = self.at_work(self.long, "-o", self.write("taken", ""))
        running.send(signal.SIGINT)
        code, _ = running.end()
        self.assertEqual(code, 4, running.said)

    def test_the_second_signal_ends_the_program(self):
        running = self.at_work(self.long)
        running.send(signal.SIGSTOP, signal.SIGINT, signal.SIGTERM, signal.SIGCONT)  # both are due when it goes on
        code, out = running.end()
        self.assertIn(code, ENDS, running.said)
        self.assertEqual(out, "")
        self.assertEqual([p.name for p in self.folder.glob("results/*")], ["long.journal"])

    def test_what_the_caller_ignores_is_ignored(self):
        running = self.at_work(self.long, before=ignoring)
        running.send(signal.SIGINT)
        for _ in range(3):
            self.assertTrue(running.wait_for("designs evaluated"), running.said)
        running.send(signal.SIGTERM)
        self.assertEqual(running.end()[0], 130)


@unittest.skipUnless(Path("/proc/self/io").exists() and not LAUNCHED,
                     "what a program has read is told by Linux alone, and of itself only")
class Commands(CliTest):
    """The program has read its files and is at work on them."""

    @classmethod
    def setUpClass(cls):
        """
        What is read before the program begins, a sanitizer's two hundred thousand bytes of /proc among it; less what that
        varies by. Looked at while it waits for its reader: of what it reads at its end (a build that counts lines adds them
        to files) nothing has been read.
        """
        super().setUpClass()
        with subprocess.Popen([PROGRAM, "--manual"], stdout=subprocess.PIPE, pipesize=4096, bufsize=0) as process:
            process.stdout.read(1)
            cls.before = max(0, cls.read_by(process) - 4096)
            if not len(process.stdout.read()) > 4096:
                raise AssertionError("the text fits into the pipe: it did not wait")

    @staticmethod
    def read_by(process):
        return int(Path(f"/proc/{process.pid}/io").read_text(encoding="ascii").split("rchar: ")[1].split()[0])

    @classmethod
    def until(cls, process, due):
        """Wait until so many bytes are read, or the program has ended."""
        read = 0
        while process.poll() is None and read < due:
            try:
                read = cls.read_by(process)
            except (OSError, IndexError):  # it has just ended
                break

    def ended(self, due, number, *args):
        """Send the signal when so many bytes of files have been read; the exit status."""
        before = sorted(p for p in self.folder.rglob("*"))
        with tempfile.TemporaryFile("w+", encoding="utf-8") as said:  # no pipe, which might be full
            with subprocess.Popen([PROGRAM, *args], cwd=self.folder, stdout=subprocess.DEVNULL, stderr=said, preexec_fn=at_default) as process:
                self.until(process, self.before + due)
                process.send_signal(number)
                process.wait(timeout=300)
            said.seek(0)
            self.said = said.read()
        if process.returncode == -number:
            self.assertEqual(sorted(p for p in self.folder.rglob("*")), before)  # nothing is left behind
        return process.returncode

    def expect_end(self, files, *args):
        """Each signal ends the command, once it is given enough to do: the size of its work doubles while it is done before the signal comes."""
        for number in (signal.SIGINT, signal.SIGTERM):
            code = 0
            for size in (50, 100, 200, 400):
                self.write("problems/beam.json", BEAM % size + BLANKS)
                self.write("studies/long.json", LONG + BLANKS)
                self.write("arm.json", ARM + BLANKS)
                due = sum((self.folder / name).stat().st_size for name in files)
                code = self.ended(due, number, *[a.replace("STEPS", str(50 * size)) for a in args])
                if code != 0:
                    break
            self.assertEqual(code, -number, (args, self.said))

    def test_each_ends_by_the_signal(self):
        beam = "problems/beam.json"
        for files, args in (([beam], ["modes", beam]), ([beam], ["sensitivity", beam]), ([beam], ["check", beam]),
                            ([beam], ["info", beam]), ([beam], ["mac", f"{beam}:default", f"{beam}:default"]),
                            (["arm.json"], ["sweep", "arm.json", "--drive", "hinge=0:1:STEPS"]),
                            ([beam, "studies/long.json"], ["compare", "studies/long.json"])):
            with self.subTest(args[0]):
                self.expect_end(files, *args)

    def test_a_run_that_reads_ends_by_the_signal_and_says_what_it_leaves(self):
        self.write("problems/beam.json", BEAM % 2)
        for size in (1 << 20, 1 << 22, 1 << 24):  # blanks take time to read; no study comes of them
            self.write("studies/wide.json", " " * size)
            self.write("studies/long.json", LONG)
            code = self.ended(size // 2, signal.SIGINT, "run", "studies/wide.json", "studies/long.json")
            if code == -signal.SIGINT:
                break
        self.assertEqual((code, self.said), (-signal.SIGINT,
                                             "modetune: error: interrupted; not answered: studies/wide.json studies/long.json\n"))


if __name__ == "__main__":
    main()

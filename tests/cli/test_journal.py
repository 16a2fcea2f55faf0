# SPDX-License-Identifier: GPL-3.0-or-later
"""A run that is killed and resumed, or shared out and merged, writes the bytes of one that was left alone.
MT_COUNT=100: so many kills at random moments (MT_EVERY=1: 30; else 4), MT_SEED=S.
MT_EVERY=1: any number of workers up to 8, seven parts, every place where a journal is cut, a proof that goes on after a kill; else some of them."""
import hashlib
import json
import os
import random
import re
import signal
import subprocess
import time
from pathlib import Path

from common_cli import PROGRAM, CliTest, main
from suite import EVERY, FEW, INSTRUMENTED, SEED, count

FEWER = INSTRUMENTED  # a sanitizer looks at the same lines with a few parts and workers
KILLS = count(4, every=30, instrumented=3)
# Eight masses in a row between the ground and nothing, their springs the variables.
N = 8
CHAIN = {
    "format": "modetune-model/1", "dimension": 2,
    "parameters": {f"k{i}": 10.0 + i for i in range(N)},
    "bodies": [{"name": f"b{i}", "mass_kg": 1, "inertia_kg_m2": 1, "centre": [i + 1, 0]} for i in range(N)],
    "joints": [{"name": f"j{i}", "type": "prismatic", "bodies": ["ground", f"b{i}"], "at": [i + 1, 0], "axis": [1, 0]} for i in range(N)],
    "springs": [{"name": f"s{i}", "type": "axial", "bodies": ["ground" if i == 0 else f"b{i - 1}", f"b{i}"],
                 **({"at": [[0, 0], [1, 0]]} if i == 0 else {}), "stiffness_n_per_m": f"k{i}"} for i in range(N)],
    "configurations": {"held": {}},
}


def variables(n, catalogue=0):
    return [{"parameter": f"k{i}", "catalogue": [5.0, 8.0, 10.0, 12.0, 20.0, 30.0]} if i < catalogue else
            {"parameter": f"k{i}", "lower": 1, "upper": 100} for i in range(n)]


def frequency(mode, hz):
    return {"type": "frequency", "configuration": "held", "mode": mode, "target_hz": hz}


AVOID = {"type": "avoid", "configurations": ["held"], "bands_hz": [[0.25, 0.3], [0.5, 0.6]], "up_to_hz": 1}
MANY = [5.0, 8.0, 9.0, 10.0, 11.0, 12.0, 14.0, 20.0, 30.0]
# One of every way that work is shared: starts, gap assignments, combinations with and without a search, boxes of them, relaxations,
# trade points one by one, in stretches and in tiles of a grid.
STUDIES = {
    "starts": {"variables": variables(8), "goals": [frequency(1, 0.1), frequency(2, 0.33)], "search": {"starts": 60}},
    "gaps": {"variables": variables(4), "goals": [AVOID], "search": {"starts": 6}},
    "mixed": {"variables": variables(4, 2), "goals": [frequency(1, 0.1)], "search": {"starts": 3}},
    "branched": {"variables": [dict(v, catalogue=MANY) for v in variables(3, 3)] + variables(4)[3:], "goals": [AVOID], "search": {"starts": 2}},
    "catalogue": {"variables": variables(4, 4), "goals": [AVOID]},
    "none": {"variables": [dict(v, lower=9, upper=14) for v in variables(3)], "goals": [dict(AVOID, bands_hz=[[0.2, 0.9]])], "search": {"starts": 4}},
    "trade": {"variables": variables(4), "goals": [frequency(1, 0.1)], "search": {"starts": 4},
              "trade": {"vary": [{"parameter": "k7", "values": [2.0 + i for i in range(24)]}]}},
    "stretches": {"variables": variables(2), "goals": [{"type": "frequency", "configuration": "held", "mode": 1, "at_least_hz": 0.1}],
                  "trade": {"vary": [{"goal": 0, "member": "at_least_hz", "values": [0.1 + 0.0001 * i for i in range(136)]}]}},
    "tiles": {"variables": variables(2), "goals": [{"type": "frequency", "configuration": "held", "mode": 1, "at_least_hz": 0.1},
                                                   {"type": "frequency", "configuration": "held", "mode": 8, "at_most_hz": 1}],
              "trade": {"vary": [{"goal": 0, "member": "at_least_hz", "values": [0.1 + 0.002 * i for i in range(16)]},
                                 {"goal": 1, "member": "at_most_hz", "values": [1.1 - 0.02 * i for i in range(13)]}]}},
}


class Journal(CliTest):
    def setUp(self):
        super().setUp()
        self.write("problems/chain.json", json.dumps(CHAIN))
        for name, asked in STUDIES.items():
            self.write(f"studies/{name}.json", json.dumps({"format": "modetune-study/1", "model": "../problems/chain.json", **asked}))

    def run_study(self, name, folder, *more, command="run", expect=None):
        done = self.run_program(command, f"studies/{name}.json", *more, "-o", folder)
        self.assertIn(done.returncode, (0, 1) if expect is None else expect, f"{name} {more}: {done.stderr}")
        return done.stderr

    def result(self, name, folder):
        return (self.folder / folder / name / "result.json").read_bytes()

    def journal(self, name, folder, part=""):
        return self.folder / folder / f"{name}{part}.journal"

    def test_any_number_of_workers_and_shards(self):
        for place, name in enumerate(STUDIES):
            self.run_study(name, "whole", "--threads", "1")
            self.assertEqual(os.listdir(self.folder / "whole").count(f"{name}.journal"), 0)
            for threads in range(2, 9) if EVERY else () if FEW else (3,):  # parts have two
                self.run_study(name, "many", "--threads", str(threads))
                self.assertEqual(self.result(name, "whole"), self.result(name, "many"), f"{name}: {threads} workers")
            for parts in (1, 3, 7) if EVERY else (2,):
                folder = f"parts{parts}"
                for part in range(1, parts + 1):
                    self.run_study(name, folder, "--shard", f"{part}/{parts}", "--threads", "2", expect=(0,))
                    self.assertFalse((self.folder / folder / name).exists())
                journals = [str(self.journal(name, folder, f".{k}-of-{parts}")) for k in range(1, parts + 1)]
                said = self.run_study(name, folder, *reversed(journals), command="merge")
                self.assertEqual(self.result(name, "whole"), self.result(name, folder), f"{name}: {parts} parts")
                if parts > 1 and not (FEW and place % 2):  # what is missing is done, and said
                    short = self.run_study(name, "short", *journals[1:], command="merge")
                    self.assertEqual(self.result(name, "whole"), self.result(name, "short"), name)
                    known, more = (int(s.split(" tasks known of ")[0].split()[-1]) for s in (short, said))
                    self.assertLessEqual(known, more)

    def kill_at(self, name, seconds):
        """Whether there was a journal that was not whole."""
        run = subprocess.Popen([PROGRAM, "run", f"studies/{name}.json", "-o", "killed", "--threads", "2"], cwd=self.folder,
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(seconds)
        run.kill()
        run.wait()
        return self.journal(name, "killed").exists()

    def test_kill_and_resume(self):
        names = ["starts", "mixed", "trade", "none", "gaps", "catalogue", "branched"]
        seconds = {}
        for name in names[:KILLS]:
            begun = time.monotonic()
            self.run_study(name, "whole", "--threads", "2")
            seconds[name] = time.monotonic() - begun
        moments = random.Random(int(SEED))
        for kill in range(KILLS):
            name = names[kill % len(names)]
            for _ in range(moments.randint(1, 2)):  # perhaps of the resumed run, too
                self.kill_at(name, moments.random() * seconds[name])
            self.run_study(name, "killed", "--resume", "--threads", str(moments.randint(1, 3)))
            self.assertEqual(self.result(name, "whole"), self.result(name, "killed"), f"{name}, kill {kill}")
            self.assertFalse(self.journal(name, "killed").exists())
            (self.folder / "killed" / name / "result.json").unlink()

    def test_design_is_safe_before_a_long_proof(self):
        asked = {"variables": variables(8), "goals": [AVOID], "search": {"starts": 2}, "recommendations": 1000}  # more than there are
        self.write("studies/long.json", json.dumps({"format": "modetune-study/1", "model": "../problems/chain.json", **asked}))
        proof = ("--proof", "1")  # long enough to be killed in
        early = self.folder / "killed" / "long" / "result.json"
        run = subprocess.Popen([PROGRAM, "run", "studies/long.json", "-o", "killed", *proof], cwd=self.folder,
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while run.poll() is None and not early.exists():
            time.sleep(0.001)
        run.kill()
        self.assertEqual(run.wait(), -9, "there was no result before the end")
        said = json.loads(early.read_bytes())
        self.assertEqual(said["status"], "interrupted")
        self.assertEqual(said["run"]["incomplete"][0], "search")
        self.assertEqual(len(said["recommendations"]), 1)
        self.assertTrue(all(goal["met"] for goal in said["recommendations"][0]["goals"]))
        if FEW:
            return  # the same proof twice more
        self.run_study("long", "whole", *proof)
        self.run_study("long", "killed", "--resume", *proof)
        self.assertEqual(self.result("long", "whole"), self.result("long", "killed"))

    def test_cut_behind_every_line(self):
        """What a kill leaves, without a clock: a journal of so many lines, and half of the next one."""
        for i, name in enumerate(STUDIES if EVERY else ("gaps", "trade") if FEWER else ("mixed", "trade")):
            some = slice(None) if EVERY else slice(i % 2, None, 2)
            self.run_study(name, "whole")
            self.run_study(name, "part", "--shard", "1/1")
            lines = self.journal(name, "part", ".1-of-1").read_bytes().splitlines(keepends=True)
            first = next(i for i, line in enumerate(lines) if i > 0 and not line.startswith(b"|"))
            for head in (b"", lines[0][:30], lines[0], b"".join(lines[:first])[:-1])[some]:  # killed while it was begun
                self.journal(name, "whole").write_bytes(head)
                before = self.result(name, "whole")
                self.assertIn(" 0 tasks known of 0 in journals", self.run_study(name, "whole", "--resume"))
                self.assertEqual(before, self.result(name, "whole"), f"{name}, {len(head)} bytes")
            for cut in sorted({first, first + 1, (first + len(lines)) // 2, len(lines) - 1})[some]:
                torn = lines[cut][: len(lines[cut]) // 2] if cut < len(lines) else b""
                self.journal(name, "whole").write_bytes(b"".join(lines[:cut]) + torn)
                before = self.result(name, "whole")
                said = self.run_study(name, "whole", "--resume")
                self.assertIn(f" {cut - first} tasks known of {cut - first} in journals", said)
                self.assertEqual("damaged" in said, torn != b"", said)
                self.assertEqual(before, self.result(name, "whole"), f"{name}, {cut} lines")

    def test_wrong_numbers_are_not_believed(self):
        """Records of a local search whose line checks but whose design has other values are done again."""
        self.run_study("starts", "whole")
        self.run_study("starts", "part", "--shard", "1/1")
        lines = self.journal("starts", "part", ".1-of-1").read_text().splitlines()
        identity = lines[0].split()[1]
        first = next(i for i, line in enumerate(lines) if i > 0 and not line.startswith("|"))
        for word in range(2, 30, 1 if EVERY else 8 if FEW else 4):
            forged = lines[:first]
            for line in lines[first:]:
                parts = line.split()[1:]
                if len(parts) > word:
                    parts[word] = format(int(parts[word], 16) ^ (1 << 51), "x")
                rest = " ".join(parts)
                forged.append(hashlib.sha256((identity + rest).encode()).hexdigest()[:16] + " " + rest)
            self.write("forged.journal", "\n".join(forged) + "\n")
            self.run_study("starts", "forged", "forged.journal", command="merge")
            whole, got = (json.loads(self.result("starts", f))["recommendations"] for f in ("whole", "forged"))
            self.assertEqual([r["feasible"] for r in whole], [r["feasible"] for r in got])
            for a, b in zip(whole, got):
                for p, q in zip(a["parameters"], b["parameters"]):
                    self.assertAlmostEqual(p["recommended"], q["recommended"], delta=1e-6 * p["recommended"], msg=f"word {word}")

    def test_processors_that_compute_otherwise_are_not_mixed(self):
        """A part done without fused multiply-add, by glibc or by OpenBLAS, and one with it."""
        flags = Path("/proc/cpuinfo").read_text(encoding="utf-8").split()
        if "fma" not in flags or "avx2" not in flags:
            self.skipTest("this processor has one way to compute")
        self.run_study("starts", "whole")
        self.run_study("starts", "out", "--shard", "1/2")
        without = "" if "FMA" in os.environ.get("GLIBC_TUNABLES", "") else "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4"
        for variable, value, member in (("GLIBC_TUNABLES", without, "arithmetic"),
                                        ("OPENBLAS_CORETYPE", "Nehalem" if os.environ.get("OPENBLAS_CORETYPE") == "Prescott" else "Prescott", "blas")):
            self.expect(0, "run", "studies/starts.json", "-o", "other", "--shard", "2/2", env={variable: value})
            journals = [str(self.journal("starts", "out", ".1-of-2")), str(self.journal("starts", "other", ".2-of-2"))]
            first = [line for line in Path(self.folder / journals[0]).read_text().splitlines() if f'"{member}"' in line][0].strip("| ")
            second = [line for line in Path(self.folder / journals[1]).read_text().splitlines() if f'"{member}"' in line][0].strip("| ")
            self.assertNotEqual(first, second)
            said = self.run_study("starts", "merged", *journals, command="merge", expect=(2,))
            for told in ("other/starts.2-of-2.journal: the journal of a processor that computes otherwise", first, second, "--redo"):
                self.assertIn(told, said)
            self.assertFalse((self.folder / "merged").exists())
            said = self.run_study("starts", "merged", "--redo", *journals, command="merge")
            self.assertIn("its tasks are done again", said)
            self.assertEqual(self.result("starts", "whole"), self.result("starts", "merged"))
            for path in (self.folder / "other").glob("*journal*"):
                path.unlink()
            for path in sorted((self.folder / "merged").rglob("*"), reverse=True):
                path.rmdir() if path.is_dir() else path.unlink()
            (self.folder / "merged").rmdir()
        self.run_study("gaps", "other", "--shard", "2/2")  # another question stays one
        said = self.run_study("starts", "merged", "--redo", str(self.journal("gaps", "other", ".2-of-2")), command="merge", expect=(2,))
        self.assertIn("of another question", said)

    def test_other_questions_are_refused(self):
        self.run_study("starts", "part", "--shard", "1/2")
        journal = str(self.journal("starts", "part", ".1-of-2"))
        said = self.run_study("gaps", "other", journal, command="merge", expect=(2,))
        self.assertIn("the journal of another question or program", said)
        self.write("studies/starts.json", (self.folder / "studies/starts.json").read_text() + " ")
        said = self.run_study("starts", "other", journal, command="merge", expect=(2,))
        self.assertIn("sha256", said)
        self.write("nothing.journal", "{}\n")
        self.assertIn("not a journal", self.run_study("starts", "other", "nothing.journal", command="merge", expect=(2,)))
        self.run_study("starts", "other", "missing.journal", command="merge", expect=(4,))
        self.assertFalse((self.folder / "other").exists())

    def test_words(self):
        said = self.run_study("gaps", "out", "--resume")
        self.assertIn("there is no out/gaps.journal to resume", said)
        self.journal("gaps", "out").write_text("left")
        said = self.run_study("gaps", "out")
        self.assertIn("it is kept as out/gaps.journal.old; --resume would have gone on from it", said)
        self.assertFalse(self.journal("gaps", "out").exists())
        self.assertEqual((self.folder / "out/gaps.journal.old").read_text(), "left")
        for wrong in ("0/3", "4/3", "3", "1/", "/2", "1/2/3", "-1/2", "1/x", "1 /2"):
            done = self.run_program("run", "studies/gaps.json", "--shard", wrong)
            self.assertEqual(done.returncode, 2, wrong)
            self.assertIn("is not PART/PARTS", done.stderr)

    def test_a_forgotten_resume_costs_nothing(self):
        self.run_study("starts", "whole")
        self.run_study("starts", "out", "--shard", "1/1")
        self.journal("starts", "out", ".1-of-1").rename(self.journal("starts", "out"))
        said = self.run_study("starts", "out")
        command = said.split("`modetune ")[1].split("`")[0].split()
        self.assertEqual(command[0], "merge")
        said = self.expect(0, *command, "-o", "again").stderr
        self.assertRegex(said, r": ([1-9]\d*) tasks known of \d+ in journals, 0 done now")
        self.assertEqual(self.result("starts", "whole"), self.result("starts", "again"))

    def test_runs_at_the_same_time_leave_each_others_journal_alone(self):
        """The second comes and goes while the first one works; a kill then leaves all that the first one knew."""
        first = subprocess.Popen([PROGRAM, "run", "studies/trade.json", "-o", "out", "--threads", "1"], cwd=self.folder,
                                 stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        journal = self.journal("trade", "out")
        known = re.compile(rb"^[^|m].*\n", re.MULTILINE)  # a task, behind what the journal is of
        while first.poll() is None and not (journal.exists() and known.search(journal.read_bytes())):
            time.sleep(0.001)
        os.kill(first.pid, signal.SIGSTOP)
        try:
            self.assertIsNone(first.poll(), "it was too fast to be met")
            inode, size = journal.stat().st_ino, journal.stat().st_size
            for more in ((), ("--resume",)):
                said = self.run_study("trade", "out", *more)
                self.assertIn("another run is writing out/trade.journal: this one keeps no journal", said)
                self.assertEqual((journal.stat().st_ino, journal.stat().st_size), (inode, size))
        finally:
            first.kill()
            first.wait()
        self.run_study("trade", "whole")
        self.assertNotIn(" 0 tasks known", self.run_study("trade", "out", "--resume"))
        self.assertEqual(self.result("trade", "whole"), self.result("trade", "out"))
        self.assertFalse(journal.exists())

    def test_what_is_no_journal_of_ours_is_left_alone(self):
        self.run_study("starts", "whole")
        (self.folder / "out").mkdir()
        victim = self.folder / "victim"
        journal = self.journal("starts", "out")
        for make in (lambda: journal.symlink_to(victim), lambda: os.mkfifo(journal), lambda: os.link(victim, journal),
                     lambda: journal.symlink_to("/dev/full"), lambda: journal.symlink_to("nowhere")):
            victim.write_text("precious")
            make()
            for more in ((), ("--shard", "1/2")):
                if more:
                    journal.rename(self.journal("starts", "out", ".1-of-2"))
                link = os.path.lexists(victim) and journal.exists() and not journal.is_symlink() and journal.is_file()
                said = self.run_study("starts", "out", *more, expect=(0, 4) if more else (0,))
                self.assertIn(".journal", said)
                self.assertEqual(victim.read_text(), "precious")
                if link:
                    break
            for path in (self.folder / "out").glob("*journal*"):
                path.unlink()
        self.assertEqual(self.result("starts", "whole"), self.result("starts", "out"))
        self.assertFalse((self.folder / "out/nowhere").exists())

    def test_a_journal_that_cannot_be_written_is_no_failure(self):
        (self.folder / "out" / "gaps.journal").mkdir(parents=True)
        said = self.run_study("gaps", "out")
        self.assertIn("warning: studies/gaps.json: the journal: ", said)
        self.assertTrue((self.folder / "out" / "gaps" / "result.json").exists())
        (self.folder / "out" / "gaps.1-of-2.journal").mkdir()
        self.run_study("gaps", "out", "--shard", "1/2", expect=(4,))


if __name__ == "__main__":
    main()

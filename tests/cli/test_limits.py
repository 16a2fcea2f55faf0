# SPDX-License-Identifier: GPL-3.0-or-later
"""Too little memory ends every command at once with exit status 4 and a sentence: never a hang, never a crash, never a wrong answer.
MT_EVERY=1: within a few megabytes of the least that is enough, else within thirty."""
import itertools
import resource
import subprocess
import sys
import unittest
from pathlib import Path

from common_cli import PROGRAM, SOURCE, CliTest, main
from suite import EVERY, INSTRUMENTED, LAUNCHED

sys.path.append(str(Path(__file__).resolve().parents[1] / "support"))
from answers import answer  # noqa: E402

MB = 1 << 20
SECONDS = 5  # of the processor; every command takes a fraction of one
COMMANDS = [
    ("check", "problems/inceptor.json"),
    ("modes", "problems/truss_72bar.json", "--shapes"),
    ("info", "problems/stick_reference.json"),
    ("sensitivity", "problems/truss_10bar.json"),
    ("sweep", "problems/inceptor.json", "-c", "installed", "--drive", "pivot=-0.1:0.1:3", "--frequencies"),
    ("mac", "problems/beam_reference.json", "problems/beam_lumped.json"),
    ("compare", "studies/engine_orders.json", "--threads", "3"),
    ("run", "studies/engine_orders.json", "-o", "@"),
]


@unittest.skipIf(INSTRUMENTED or LAUNCHED, "a sanitizer needs address space")
class Limits(CliTest):
    def under(self, words, **limits):
        """Run a command of the source tree under limits of the system; its exit status, output and errors."""
        def limit():
            for name, size in limits.items():
                resource.setrlimit(getattr(resource, name), (size, size))
            resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
        words = [str(self.folder / "out") if w == "@" else w for w in words]
        done = subprocess.run([PROGRAM, *words], cwd=SOURCE, preexec_fn=limit, capture_output=True, encoding="utf-8",
                              timeout=120)
        return done.returncode, done.stdout, done.stderr

    def is_enough(self, words, whole, **limits):
        """Does the command do all its work under the limits? Else it says so."""
        code, said, problems = self.under(words, **limits)
        self.assertIn(code, (4, whole[0]), problems)
        if code != 4:
            self.assertEqual(said, whole[1])
        else:
            self.assertIn("out of memory", problems)
        return code != 4

    def test_little_memory(self):
        """Too little, enough, and halves between them, ever nearer to the edge, of address space or of data."""
        short = []
        for words, (what, little) in zip(COMMANDS, itertools.cycle([("RLIMIT_AS", 60), ("RLIMIT_DATA", 20)])):
            with self.subTest(f"{words[0]}, {what}"):
                whole, much = self.under(words), 1000
                self.assertTrue(self.is_enough(words, whole, **{what: much * MB}))
                size = little
                while much - size > (4 if EVERY else 30):
                    if self.is_enough(words, whole, **{what: size * MB}):
                        much = size
                    else:
                        little = size
                        short.append(words)
                    size = (little + much) // 2
        self.assertTrue(short)

    def test_a_limit_of_our_own_is_named(self):
        points = ", ".join(f'"p{i}": [{i}, 0]' for i in range(20000))
        model = self.write("many.json", '{"format": "modetune-model/1", "dimension": 2, "points": {%s}, '
                           '"bodies": [{"name": "a", "mass_kg": 1, "inertia_kg_m2": 1, "centre": "p1"}]}' % points)
        done = self.expect(4, "modes", model, "--max-memory", "4M")
        self.assertEqual(done.stdout, "")
        self.assertRegex(done.stderr, r"out of memory\nThe program may use 4 MB \(--max-memory\)\.\n$")
        enough = self.expect(0, "modes", model, "--max-memory", "1G")
        self.assertEqual(enough.stdout, self.expect(0, "modes", model).stdout)

    def test_a_result_of_many_points_takes_a_few_times_its_text(self):
        text = (answer(SOURCE / "studies/inceptor_trade.json").folder / "result.json").read_text(encoding="utf-8")
        begin = text.index('\n    "points": [') + len('\n    "points": [')
        end = text.index("\n    ]", begin)
        many = text[:begin] + ",".join([text[begin:end]] * 50) + text[end:]
        self.assertGreater(len(many), 10 * MB)
        result = self.write("many.json", many)
        self.assertEqual(self.expect(0, "report", result, "--format", "json", "--max-memory", "60M").stdout, many)
        other = self.write("other.json", many[:begin] + " " + many[begin:])  # laid out otherwise: read as a whole
        self.assertEqual(self.expect(0, "report", other, "--format", "json").stdout, many)
        self.expect(4, "report", other, "--format", "json", "--max-memory", "60M")

    def test_sizes(self):
        for size in ("1M", "1048576", "1024k", "2000G", "1024T"):
            self.assertNotIn("max-memory", self.run_program("check", self.model, "--max-memory", size).stderr)
        for size in ("0", "1k", "1048575", "1025T", "99999999999999999999", "-1M", "1.5G", "1MB", "M", " 1M", "1 M", "nan", "1e9"):
            done = self.expect(2, "check", self.model, "--max-memory", size)
            self.assertIn(f'--max-memory: "{size}" is not a size from 1M to 1024T ("500M", "8G")', done.stderr)

    def test_more_workers_than_are_used(self):
        one = self.under(("compare", "studies/engine_orders.json"))
        self.assertEqual(self.under(("compare", "studies/engine_orders.json", "--threads", "1024", "--max-memory", "1G")), one)


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""The campaign of tests/support/campaign.py, on a generator whose faults are known: it finds them, counts them, shows them again and makes them small."""
import contextlib
import io
import json
import re
import shlex
import tempfile
import unittest
from pathlib import Path

import campaign

LARGE = 97  # of numbers below 100: what counts as a fault


class Lists(campaign.Generator):
    """Lists of numbers. A large one is a fault; one that ends in 13 is a mistake of the judge, and one that begins with 7 is left out."""
    script, cases, kinds, tallied = "tests/support/lists.py", "lists", ("short", "long"), ("left out",)

    def __init__(self):
        self.from_ = 0

    def options(self, parser):
        parser.add_argument("--from", type=int, default=0, dest="from_")

    def asked(self, args):
        self.from_ = args.from_
        return ["--from", str(self.from_)] if self.from_ else []

    def make(self, seed, kind, index):
        rng = campaign.draw(seed, kind, index)
        return campaign.Case(kind, {"name": "a list of numbers", "values": [rng.randrange(self.from_, 100) for _ in range(3 if kind == "short" else 9)]}, rng)

    def judge(self, case, folder, tally):
        values = case.document["values"]
        tally["numbers"] += len(values)
        (folder / "drawn").write_text(str(case.rng.random()))
        if values and values[0] == 7:
            raise campaign.LeftOut("begins with 7")
        if values and values[-1] == 13:
            raise ValueError("13")
        for value in values:
            if value >= LARGE:
                yield "large", f"{value} in {case.kind}"


class Whole(Lists):
    """Of fewer than four numbers another check fails."""

    def judge(self, case, folder, tally):
        yield from super().judge(case, folder, tally)
        if len(case.document["values"]) < 4:
            yield "short", "too few"


class Pairs(Lists):
    """Judged three at a time; the number of the batch is told."""
    batch = 3

    def judge_batch(self, seed, number, batch, folder, tally):
        tally[f"batch of {len(batch)}"] += 1
        yield from super().judge_batch(seed, number, batch, folder, tally)


def findings(generator, jobs=1, seed="s", count=60, **more):
    tally = campaign.Tally()
    return list(campaign.run(generator, seed, generator.todo(generator.kinds, count), tally, jobs=jobs, **more)), tally


def said(generator, *words):
    """Exit status and lines of a command line."""
    with contextlib.redirect_stdout(io.StringIO()) as out:
        code = campaign.main(generator, list(words))
    return code, out.getvalue().splitlines()


class Campaigns(unittest.TestCase):
    def test_every_fault_is_found(self):
        lists = Lists()
        found, tally = findings(lists)
        large = wrong = left = 0
        for kind, index in lists.todo(lists.kinds, 60):
            values = lists.make("s", kind, index).document["values"]
            if values[0] == 7:
                left += 1
            elif values[-1] == 13:
                wrong += 1
            else:
                large += sum(v >= LARGE for v in values)
        self.assertEqual([sum(f.check == c for f in found) for c in ("large", "reference")], [large, wrong])
        self.assertEqual((tally["lists"], tally["left out"], tally["begins with 7"]), (120 - left, left, left))
        self.assertEqual(tally["numbers"], 60 * 12)
        self.assertTrue(large > 10 and wrong and left, "the seed tries nothing")
        where = next(f.text for f in found if f.check == "reference")
        self.assertRegex(where, r"^test_campaign\.py:\d+: ValueError\('13'\)$")

    def test_a_case_does_not_depend_on_others(self):
        lists = Lists()
        one = findings(lists)[0]
        alone = [f for kind, index in lists.todo(lists.kinds, 60) for f in campaign.run(lists, "s", [(kind, index)], campaign.Tally())]
        self.assertEqual(one, alone)
        self.assertNotEqual(one, findings(lists, seed="t")[0])

    def test_processes_share_the_work(self):
        for generator in (Lists(), Pairs()):
            with self.subTest(generator=type(generator).__name__):
                self.assertEqual(findings(generator, 3), findings(generator, 1))
        self.assertEqual(findings(Pairs(), 2, count=10)[1]["batch of 3"], 6)
        self.assertEqual(findings(Pairs(), 2, count=10)[1]["batch of 2"], 1)

    def test_the_time_ends_it(self):
        for jobs in (1, 2):
            found, tally = findings(Lists(), jobs, seconds=-1)
            self.assertEqual((found, tally["lists"]), ([], 0))

    def test_files_are_kept(self):
        with tempfile.TemporaryDirectory() as folder:
            findings(Lists(), count=2, keep=folder)
            self.assertEqual(sorted(str(p.relative_to(folder)) for p in Path(folder).glob("*/*")), [f"{k}_{i}/drawn" for k in ("long", "short") for i in (0, 1)])


class CommandLine(unittest.TestCase):
    def test_a_finding_is_shown_again_by_its_line(self):
        code, lines = said(Lists(), "--seed", "s", "--count", "20", "--from", "50")
        self.assertEqual(code, 1)
        large = next(i for i, line in enumerate(lines) if line.startswith("large: "))
        words = shlex.split(lines[large + 1].removeprefix("again: "))
        words = words[words.index("tests/support/lists.py") + 1:]
        self.assertIn("--from", words)
        self.assertIn(lines[large], said(Lists(), *words)[1])
        self.assertEqual(said(Lists(), *words)[1][-1].split(" (")[0], "1 lists of seed s")

    def test_the_summary_counts(self):
        found, tally = findings(Lists(), count=20)
        code, lines = said(Lists(), "--seed", "s", "--count", "20", "--jobs", "2")
        self.assertEqual(lines[-1], f"{tally['lists']} lists of seed s (left out: {tally['left out']}, numbers: 240, begins with 7: {tally['begins with 7']}): "
                                    f"{len(found)} findings, 0 known")
        self.assertEqual(len(lines), 2 * len(found) + 1)

    def test_rare_findings_do_not_fail(self):
        found, tally = findings(Lists(), count=20)
        rate = len(found) / tally["lists"]
        for rare, code in ((0, 1), (0.9 * rate, 1), (1.1 * rate, 0)):
            self.assertEqual(said(Lists(), "--seed", "s", "--count", "20", "--rare", str(rare))[0], code)
        places = [f[:2] for f in found]
        first = next(f for f in found if places.count(f[:2]) == 1)
        alone = ("--seed", "s", "--only", first.kind, "--index", str(first.index))
        self.assertEqual([said(Lists(), *alone, "--rare", rare)[0] for rare in ("0", "0.001")], [1, 0])

    def test_known_findings_wait(self):
        found = findings(Lists(), count=20)[0]
        campaign.KNOWN.append((Lists.script, "large", "long", "98 in", "wait"))
        self.addCleanup(campaign.KNOWN.pop)
        known = sum(f.check == "large" and f.kind == "long" and "98 in" in f.text for f in found)
        self.assertTrue(0 < known < len(found))
        lines = said(Lists(), "--seed", "s", "--count", "20")[1]
        self.assertRegex(lines[-1], f": {len(found) - known} findings, {known} known$")
        self.assertEqual(len(lines), 2 * (len(found) - known) + 1)
        self.assertEqual(sum("(known: wait)" in line for line in said(Lists(), "--seed", "s", "--count", "20", "--known")[1]), known)
        self.assertRegex(said(Pairs(), "--seed", "s", "--count", "20")[1][-1], f", {known} known$")

    def test_a_finding_is_made_small(self):
        with tempfile.TemporaryDirectory() as folder:
            code, lines = said(Lists(), "--seed", "s", "--count", "20", "--only", "long", "--shrink", f"{folder}/small")
            self.assertEqual(code, 1)
            path = Path(folder) / "small/case.json"
            small = json.loads(path.read_text(encoding="utf-8"))
            self.assertEqual((list(small), small["kind"], len(small["values"])), (["holds", "kind", "values"], "long", 1))
            self.assertRegex(lines[-1], r"^\d+ bytes in ")
            found = re.match(r"large: (\d+)", lines[0])
            self.assertGreaterEqual(small["values"][0], LARGE)
            self.assertIn(found[1], {str(v) for v in range(LARGE, 100)})
            again, lines = said(Lists(), "--case", str(path), "--shrink", f"{folder}/smaller")
            self.assertEqual((again, lines[0].split(" ")[1]), (1, str(small["values"][0])))
            self.assertEqual(json.loads((Path(folder) / "smaller/case.json").read_text(encoding="utf-8")), small)


    def test_a_small_one_fails_nothing_else(self):
        with tempfile.TemporaryDirectory() as folder:
            said(Whole(), "--seed", "s", "--count", "20", "--only", "long", "--shrink", folder)
            self.assertEqual(len(json.loads((Path(folder) / "case.json").read_text(encoding="utf-8"))["values"]), 4)


class Suites(unittest.TestCase):
    def outcome(self, act):
        """How many failures a test has that does this."""
        class Inner(unittest.TestCase):
            def test(self):
                act(self)
        result = unittest.TestResult()
        Inner("test").run(result)
        self.assertEqual(result.errors, [])
        return len(result.failures)

    def test_hold(self):
        lists = Lists()
        found = findings(lists, count=10)[0]
        self.assertEqual(self.outcome(lambda test: campaign.hold(test, lists, "s", lists.todo(lists.kinds, 10))), len(found))
        sound = [(kind, index) for kind, index in lists.todo(lists.kinds, 10) if not any(f[:2] == (kind, index) for f in found)]
        self.assertEqual(self.outcome(lambda test: campaign.hold(test, lists, "s", sound)), 0)

    def test_hold_saved(self):
        lists = Lists()
        with tempfile.TemporaryDirectory() as folder:
            hold = lambda *more: self.outcome(lambda test: campaign.hold_saved(test, lists, Path(folder), *more))
            self.assertEqual(hold(), 1, "no case at all")
            for name, values in (("a", [1]), ("b", [LARGE]), ("c", [2, 13]), ("d", [3])):
                (Path(folder) / f"{name}.json").write_text(json.dumps({"holds": "why", "kind": "short", "values": values}), encoding="utf-8")
            self.assertEqual([hold(), hold(2), hold(1, 3)], [2, 1, 6])


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""Results and journals that programs of earlier days wrote (written_by/DATE, each by the commit below) are read, with defaults for what they lack, or are
refused in words: up to November 22 goals were only words, up to November 26 clearances from bands were in percent of the edge. A file that is read is told
as it was: its frequencies and values, and nothing that it does not hold. A journal goes on with its own program only, whose commit stands in its head."""
import csv
import io
import json
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import jsonschema

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tests/support"))
from suite import PROGRAM  # noqa: E402

CORPUS = Path(__file__).resolve().parent / "written_by"
# The last commit of the day; that of the 22nd is of the night to the 23rd.
COMMITS = {"2026-11-20": "d74034291764", "2026-11-22": "74e8b55f487d", "2026-11-23": "2f3204d1e33d", "2026-11-25": "d63f29d7e34f", "2026-11-27": "229877960ad0"}
GOALS = "written by a modetune 0.1.0 of November 22, 2026, or before, which tells neither types nor limits of goals: run the study again"
BANDS = "written by a modetune 0.1.0 of November 26, 2026, or before, which tells clearances from bands in percent of the edge, not as ratios of frequencies: run the study again"
REFUSED = {("2026-11-20", "inceptor_tuning_1"): GOALS, ("2026-11-25", "inceptor_catalogue"): BANDS}
RESULTS = sorted((p.parent.name, p.stem) for p in CORPUS.glob("*/*.json"))
READ = [key for key in RESULTS if key not in REFUSED]
NEW = "2026-11-27"
# No number or text that is not there.
NOTHING = re.compile(r"\(null\)|\bnan\b|\bundefined\b|-1 modal", re.IGNORECASE)


def place(key):
    return CORPUS / key[0] / f"{key[1]}.json"


def told(key):
    return json.loads(place(key).read_text(encoding="utf-8"))


def modetune(*line):
    done = subprocess.run([PROGRAM, *map(str, line)], capture_output=True, timeout=120, encoding="utf-8")
    return done.returncode, done.stdout, done.stderr


def near(test, number, value, digits=6):
    test.assertTrue(abs(number - value) <= abs(value) * 10.0 ** (1 - digits), (number, value))


class WrittenBy(unittest.TestCase):
    def test_corpus(self):
        self.assertEqual({date for date, _ in RESULTS}, set(COMMITS))
        self.assertGreaterEqual(len(READ), 9)
        for key in RESULTS:
            build = told(key)["run"].get("build")
            with self.subTest(key):
                self.assertEqual(COMMITS[key[0]] if build else "2026-11-20", build["commit"] if build else key[0])

    def test_refused_in_words(self):
        for key, words in REFUSED.items():
            for command in (["report"], ["report", "--format", "html"], ["report", "--format", "csv"], ["explain"], ["apply"]):
                with self.subTest(key=key, command=command):
                    code, out, err = modetune(*command, place(key))
                    self.assertEqual((code, out), (2, ""))
                    self.assertIn(words, err)
                    self.assertEqual(err.count("error:"), 1, err)

    def test_reports(self):
        for key in READ:
            result = told(key)
            with self.subTest(key):
                code, text, err = modetune("report", place(key))
                self.assertEqual((code, err), (0, ""))
                self.assertIsNone(NOTHING.search(text), NOTHING.search(text))
                self.assertIn({"solved": "Solved", "compromise": "Compromise"}[result["status"]] if result["variables"] else "No goals", text)
                for design in result["recommendations"]:
                    for goal in design["goals"]:
                        self.assertIn(goal.get("quantity", goal["goal"]), text)
                for reason in result["recommendations"][0]["reasons"] if result["recommendations"] else []:
                    self.assertIn(reason if isinstance(reason, str) else reason["text"], text)
                code, text, err = modetune("explain", place(key))
                self.assertEqual((code, err), (0, ""))
                self.assertIsNone(NOTHING.search(text))
                if key[0] < "2026-11-25" and result["recommendations"]:
                    self.assertNotIn("no sensitivity", text)
                    self.assertNotIn("nothing:", text)
                code, page, err = modetune("report", "--format", "html", place(key))
                self.assertEqual((code, err), (0, ""))
                self.assertNotIn("-1 modal", page)

    def test_parameters(self):
        for key in READ:
            result = told(key)
            with self.subTest(key):
                code, text, err = modetune("report", "--format", "csv", place(key))
                self.assertEqual((code, err), (0, ""))
                rows = list(csv.DictReader(io.StringIO(text)))
                values = [[p["recommended"] for p in d["parameters"]] for d in result["recommendations"]]
                shown = [[float(row[name]) for name in row if name.split(" ")[0] in result["variables"]] for row in rows]
                self.assertEqual(shown[-len(values):] if values else [], values)

    def test_read_and_written_again(self):
        """What was read is written as it was, with defaults for what it lacks, and is read again; today's schema holds it."""
        schema = jsonschema.Draft7Validator(json.loads((ROOT / "schemas/result.schema.json").read_text(encoding="utf-8")))
        with tempfile.TemporaryDirectory() as name:
            for key in READ:
                with self.subTest(key):
                    code, _, err = modetune("report", place(key), "-o", Path(name) / key[0], "--quiet")
                    self.assertEqual(code, 0, err)
                    again, = (Path(name) / key[0]).glob(f"{told(key)['study']['file'].removesuffix('.json')}/result.json")
                    new, old = json.loads(again.read_text(encoding="utf-8")), told(key)
                    self.assertEqual([e.message for e in schema.iter_errors(new)], [])
                    for number in ("baseline", "recommendations", "published", "status", "variables"):
                        self.held(old[number], new[number], number)
                    self.assertEqual(modetune("report", again)[1], modetune("report", place(key))[1])
                    if key[0] >= "2026-11-25":
                        self.assertEqual([e.message for e in schema.iter_errors(old)], [])

    def held(self, old, new, where):
        if isinstance(old, str) and isinstance(new, dict):
            self.assertEqual(old, new["text"], where)
        elif isinstance(old, dict):
            for member, value in old.items():
                self.held(value, new[member], f"{where}/{member}")
        elif isinstance(old, list):
            self.assertEqual(len(old), len(new), where)
            for i, value in enumerate(old):
                self.held(value, new[i], f"{where}/{i}")
        else:
            self.assertEqual(old, new, where)

    def test_applies(self):
        """The recommended values are put into the model, which is named: that of today may be another one than was solved."""
        for key in [k for k in READ if told(k)["recommendations"]]:
            result = told(key)
            with self.subTest(key):
                code, out, err = modetune("apply", place(key), "--model", ROOT / "studies" / result["model"]["file"])
                self.assertEqual(code, 0, err)
                model = json.loads(out)["parameters"]
                for parameter in result["recommendations"][0]["parameters"]:
                    value = model[parameter["name"]]
                    near(self, value["value"] if isinstance(value, dict) else value, parameter["recommended"], 12)

    def test_differences(self):
        """A result has no difference from itself; an older one differs from a new one in no frequency of the design that both recommend."""
        for key in RESULTS:
            code, text, err = modetune("diff", place(key), place(key))
            self.assertEqual((code, err), (0, ""), (key, text))
        for key in [k for k in RESULTS if (NEW, k[1]) in RESULTS and k[0] != NEW]:
            with self.subTest(key):
                code, text, err = modetune("diff", place(key), place((NEW, key[1])), "--rel-tol", "1e-9")
                self.assertIn(code, (0, 1), err)
                self.assertIsNone(NOTHING.search(text))
                self.assertNotIn("recommended_hz", text)
                self.assertNotIn("status:", text)

    def test_journals(self):
        """A journal of another program is refused, with the version that it names: the work of another search is not mixed with this one's."""
        journals = sorted(CORPUS.glob("*/*.journal"))
        self.assertEqual([p.parent.name for p in journals], ["2026-11-23", "2026-11-25", "2026-11-27"])
        study = ROOT / "studies/inceptor_tuning_1.json"
        for journal in journals:
            with self.subTest(journal.parent.name), tempfile.TemporaryDirectory() as name:
                code, out, err = modetune("merge", study, journal, "-o", name, "--quiet")
                self.assertEqual((code, out), (2, ""))
                self.assertIn("the journal of another question or program", err)
                self.assertIn('"modetune": "0.1.0"', err)
                self.assertEqual(list(Path(name).iterdir()), [])
                kept = Path(name) / "inceptor_tuning_1.journal"
                kept.write_bytes(journal.read_bytes())
                code, out, err = modetune("run", study, "--resume", "-o", name, "--quiet")
                self.assertEqual((code, out), (2, ""))
                self.assertIn('"modetune": "0.1.0"', err)
                self.assertEqual([(p, p.read_bytes()) for p in Path(name).iterdir()], [(kept, journal.read_bytes())])


if __name__ == "__main__":
    unittest.main()

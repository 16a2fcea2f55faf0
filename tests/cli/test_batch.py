# SPDX-License-Identifier: GPL-3.0-or-later
"""run with several studies: each is answered, whatever becomes of the others; a table and an index say what became of all; no two results in one place."""
import hashlib
import html
import json
import os
import re
import urllib.parse

import jsonschema

from common_cli import SOURCE, CliTest, main, study

SCHEMA = json.loads((SOURCE / "schemas/index.schema.json").read_text(encoding="utf-8"))
QUICK = ', "search": { "starts": 4 }'
FAR = {"first_hz": 0.01, "second_hz": 0.0101}


class Batch(CliTest):
    def index(self, folder="results"):
        got = json.loads((self.folder / folder / "index.json").read_text(encoding="utf-8"))
        jsonschema.validate(got, SCHEMA, cls=jsonschema.Draft7Validator)
        for one in got["studies"]:
            result = self.folder / folder / one["folder"] / "result.json"
            if one["state"] == "answered":
                self.assertEqual(hashlib.sha256(result.read_bytes()).hexdigest(), one["result_sha256"])
                told = json.loads(result.read_text(encoding="utf-8"))
                best = (told["recommendations"] or [{"grade": None, "change": None}])[0]
                self.assertEqual((one["status"], one["name"], one["grade"], one["change"]),
                                 (told["status"], told["study"]["name"], best["grade"], best["change"]))
                self.assertIsNone(one["message"])
            else:
                self.assertIsNone(one["result_sha256"])
                self.assertEqual(one["message"] is None, one["state"] == "not run")
        page = (self.folder / folder / "index.html").read_text(encoding="utf-8")
        links = [urllib.parse.unquote(link) for link in re.findall(r'<a href="([^"]+)">', page)]
        self.assertEqual(links, [f'{s["folder"]}/report.html' for s in got["studies"] if s["state"] == "answered"])
        for link in links:
            self.assertTrue((self.folder / folder / link).exists(), link)
        rows = re.findall(r"^<tr><td>(?:<a [^>]*>)?(.*?)(?:</a>)?</td>", page, re.M)
        self.assertEqual([html.unescape(row) for row in rows], [s["file"] for s in got["studies"]])
        return got["studies"]

    def test_every_study_is_answered_whatever_becomes_of_the_others(self):
        jsonschema.Draft7Validator.check_schema(SCHEMA)
        good, far = self.write("studies/good.json", study(extra=QUICK)), self.write("studies/far.json", study(**FAR, extra=QUICK))
        bad, odd = self.write("studies/bad.json", "{"), self.write("studies/a b<&%.json", study(extra=QUICK))
        names = [bad, good, "none.json", far, odd, "studies"]
        done = self.expect(4, "run", *names)
        told = self.index()
        self.assertEqual([s["state"] for s in told], ["not answered", "answered", "not answered", "answered", "answered", "not answered"])
        self.assertEqual([s["exit_status"] for s in told], [2, 0, 4, 1, 0, 2])
        self.assertEqual([s["status"] for s in told], [None, "solved", None, "compromise", "solved", None])
        self.assertTrue(told[0]["message"].startswith("studies/bad.json:1:2: error: "), told[0]["message"])
        self.assertTrue(told[2]["message"].startswith("none.json: No such file"))
        self.assertIn("is not a regular file", told[5]["message"])
        table = done.stdout[done.stdout.index("\nStudies\n"):].splitlines()[4:]
        self.assertEqual([re.split(r"  +", line.strip())[:3] for line in table],
                         [[path, s["status"] or s["state"], s["grade"] or "-"] for path, s in zip(names, told)])
        for line, s in zip(table, told):
            self.assertRegex(line, r" 0$| [\d.]+$" if s["status"] else r" -$")
        self.assertTrue(done.stderr.endswith("6 studies; index written to results/\n"), done.stderr)
        for status, of in ((0, [good, odd]), (1, [good, far]), (2, [far, bad, good])):
            with self.subTest(status):
                self.expect(status, "run", *of, "--quiet", "-o", "some")
                self.assertEqual(max(s["exit_status"] for s in self.index("some")), status)

    def test_the_same_studies_make_the_same_index(self):
        names = [self.write(f"studies/{n}.json", study(extra=QUICK)) for n in "abc"]
        self.expect(0, "run", *names, "-o", "one")
        self.expect(0, "run", *names, "-o", "two", "--threads", "3")
        for name in ("index.json", "index.html"):
            self.assertEqual((self.folder / "one" / name).read_bytes(), (self.folder / "two" / name).read_bytes())
        self.assertNotIn("Studies", self.expect(0, "run", *names, "--format", "csv", "--quiet").stdout)
        self.assertEqual(len(self.json_of("run", *names)), 3)
        self.assertFalse({p.name for p in (self.folder / "one").iterdir()} - {"a", "b", "c", "index.json", "index.html"})

    def test_one_study_has_no_index(self):
        done = self.expect(0, "run", self.write("studies/good.json", study(extra=QUICK)))
        self.assertNotIn("\nStudies\n", done.stdout)
        self.assertEqual([p.name for p in (self.folder / "results").iterdir()], ["good"])

    def refused(self, says, *names, **more):
        before = sorted(self.folder.rglob("*"))
        done = self.expect(2, "run", *names, **more)
        self.assertEqual(done.stdout, "")
        self.assertIn(says, done.stderr)
        self.assertEqual(sorted(self.folder.rglob("*")), before)

    def test_no_two_results_in_one_place(self):
        for folder in ("other", "deep", "results/c"):
            (self.folder / folder).mkdir(parents=True)
        a, b, c = (self.write(f"studies/{n}.json", study(extra=QUICK)) for n in "abc")
        self.refused(f'{a} and other/a.json would both be written to "results/a"', a, b, self.write("other/a.json", study()))
        self.refused(f'{a} and ./{a} would both be written to "results/a"', a, f"./{a}")
        self.refused('would both be written to "results/A"', c, a, self.write("other/A.json", study()))
        self.refused('would both be written to "results/c"', c, b, self.write("other/c", study()))
        os.symlink("c", self.folder / "results/a")  # a link to what is there
        self.refused(f'{c} and {a} would both be written to "results/a"', c, b, a)
        os.unlink(self.folder / "results/a")
        os.symlink("b", self.folder / "deep/a")  # to what a run of b would make
        self.refused(f'{a} would be written to "deep/a", a link that leads nowhere', a, b, "-o", "deep")
        os.symlink("../studies/a.json", self.folder / "other/d.json")  # a study may be run under two names
        self.expect(0, "run", a, "other/d.json", "--quiet")
        for name in ("index.json", "INDEX.html"):
            self.refused("which is the place of the index of all studies", b, self.write(f"other/{name}.json", study()))
        self.refused('"studies/" is not the name of a file', a, "studies/")

    def test_an_index_that_cannot_be_written_is_4(self):
        names = [self.write(f"studies/{n}.json", study(extra=QUICK)) for n in "ab"]
        (self.folder / "results/index.json").mkdir(parents=True)
        done = self.expect(4, "run", *names)
        self.assertEqual(done.stdout.count("Solved"), 2)
        self.assertTrue((self.folder / "results/b/result.json").exists())


if __name__ == "__main__":
    main()

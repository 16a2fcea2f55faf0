# SPDX-License-Identifier: GPL-3.0-or-later
"""check --format json and sarif: every problem with its place, whatever the files are; SARIF as its standard and code hosts ask for it."""
import json
import re
import urllib.parse

import jsonschema

from common_cli import SOURCE, CliTest, main, study

# Of the OASIS schema of SARIF 2.1.0 the members that are used, in our words; no other is allowed, and what code hosts need is required.
TEXT = {"type": "object", "properties": {"text": {"type": "string", "minLength": 1}}, "required": ["text"], "additionalProperties": False}
LEVEL = {"enum": ["error", "warning", "note"]}


def closed(required, **optional):
    return {"type": "object", "properties": {**required, **optional}, "required": sorted(required), "additionalProperties": False}


def listed(item, **more):
    return {"type": "array", "items": item, **more}


SARIF = closed({
    "$schema": {"const": "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"},
    "version": {"const": "2.1.0"},
    "runs": listed(closed({
        "tool": closed({"driver": closed({
            "name": {"const": "modetune"}, "version": {"type": "string"},
            "rules": listed(closed({"id": {"type": "string"}, "shortDescription": TEXT, "fullDescription": TEXT,
                                    "defaultConfiguration": closed({"level": LEVEL})}), uniqueItems=True)})}),
        "columnKind": {"const": "unicodeCodePoints"},
        "results": listed(closed({
            "ruleId": {"type": "string"}, "ruleIndex": {"type": "integer", "minimum": 0}, "level": LEVEL, "message": TEXT,
            "locations": listed(closed({
                "physicalLocation": closed({
                    "artifactLocation": closed({"uri": {"type": "string", "pattern": "^(file://)?([A-Za-z0-9._~/-]|%[0-9A-F]{2})+$"}}),
                    "region": closed({"startLine": {"type": "integer", "minimum": 1}}, startColumn={"type": "integer", "minimum": 1})})},
                logicalLocations=listed(closed({"fullyQualifiedName": {"type": "string", "pattern": "^/"}}), minItems=1, maxItems=1)),
                minItems=1, maxItems=1)})),
        "invocations": listed(closed({"executionSuccessful": {"type": "boolean"}, "exitCode": {"type": "integer"}},
                                     toolExecutionNotifications=listed(closed({"level": LEVEL, "message": TEXT}))), minItems=1, maxItems=1),
    }), minItems=1, maxItems=1)})
PROBLEM = closed({"file": {"type": "string"}, "line": {"type": ["integer", "null"], "minimum": 1}, "column": {"type": ["integer", "null"], "minimum": 1},
                  "pointer": {"type": ["string", "null"], "pattern": "^(/.*)?$"}, "severity": LEVEL, "message": {"type": "string", "minLength": 1}})
IS_SARIF, IS_PROBLEM = (jsonschema.Draft7Validator(schema) for schema in (SARIF, PROBLEM))
WRONG = sorted((SOURCE / "tests/documents/wrong").glob("*.json"))


class CheckFormats(CliTest):
    def both(self, *files, code=None):
        """Problems from JSON and results from SARIF, which say the same; the SARIF run."""
        done = {name: self.run_program("check", *files, "--format", name) for name in ("json", "sarif")}
        self.assertEqual(done["json"].returncode, done["sarif"].returncode)
        self.assertEqual(done["json"].stderr, done["sarif"].stderr)
        if code is not None:
            self.assertEqual(done["sarif"].returncode, code, done["sarif"].stderr)
        told, log = (json.loads(done[name].stdout) for name in ("json", "sarif"))
        IS_SARIF.validate(log)
        for f in told:
            self.assertEqual(f["ok"], all(p["severity"] != "error" for p in f["problems"]), f["file"])
        problems = [p for f in told for p in f["problems"]]
        for p in problems:
            IS_PROBLEM.validate(p)
            self.assertEqual({p["line"] is None, p["column"] is None, p["pointer"] is None}, {p["line"] is None})
        (run,) = log["runs"]
        rules = run["tool"]["driver"]["rules"]
        self.assertEqual(len(problems), len(run["results"]))
        for p, r in zip(problems, run["results"]):
            self.assertEqual((p["severity"], p["message"]), (r["level"], r["message"]["text"]))
            self.assertEqual((rules[r["ruleIndex"]]["id"], rules[r["ruleIndex"]]["defaultConfiguration"]["level"]), (r["ruleId"], r["level"]))
            place = r["locations"][0]
            region = place["physicalLocation"]["region"]
            self.assertEqual((region["startLine"], region.get("startColumn")), (p["line"] or 1, p["column"]))
            self.assertEqual([at["fullyQualifiedName"] for at in place.get("logicalLocations", [])], [p["pointer"]] if p["pointer"] else [])
        (invocation,) = run["invocations"]
        self.assertEqual(invocation["exitCode"], done["sarif"].returncode)
        self.assertEqual(invocation["executionSuccessful"], done["sarif"].returncode in (0, 2))
        self.assertEqual(sum(f["left_out"] for f in told),
                         sum(int(n["message"]["text"].split()[0]) for n in invocation.get("toolExecutionNotifications", [])))
        return problems, run, done["sarif"].stderr

    def test_every_wrong_file_is_told_alike_and_as_on_paper(self):
        self.assertGreater(len(WRONG), 30)
        problems, _, text = self.both(*map(str, WRONG))
        lines = [line for line in text.splitlines() if not line.endswith("more not shown")]
        self.assertEqual(len(lines), len(problems))
        for line, p in zip(lines, problems):
            if p["line"] is not None:
                self.assertEqual(line, f'{p["file"]}:{p["line"]}:{p["column"]}: {p["severity"]}: '
                                       f'{p["pointer"] + ": " if p["pointer"] else ""}{p["message"]}')

    def test_rules_are_by_kind_of_problem(self):
        doubtful = self.write("doubtful.json", json.dumps({
            "format": "modetune-model/1", "dimension": 2, "bodies": [{"name": "a", "mass_kg": 1, "inertia_kg_m2": 1, "centre": [0, 0]}]}))
        bad, none = self.write("bad.json", "{}"), "none.json"
        ghost = self.write("ghost.json", json.dumps({  # of which a fact is known before it cannot be analysed
            "format": "modetune-model/1", "dimension": 2, "parameters": {"m": 1}, "bodies": [{"name": "g", "mass_kg": "m", "centre": [0, 0]}],
            "configurations": {"fine": {}, "ghostly": {"parameters": {"m": 0}}}}))
        _, run, _ = self.both(doubtful, bad, none, ghost, code=4)
        rules = {}
        for r in run["results"]:
            rules.setdefault(r["locations"][0]["physicalLocation"]["artifactLocation"]["uri"], set()).add((r["ruleId"], r["level"]))
        self.assertEqual(rules[bad], {("bad-input", "error")})
        self.assertEqual(rules[none], {("not-analysed", "error")})
        self.assertEqual(rules[ghost], {("good-to-know", "note"), ("not-analysed", "error")})
        self.assertEqual(rules[doubtful], {("good-to-know", "note")})
        self.both(doubtful, code=0)

    def test_paths_are_uris_relative_to_where_it_runs(self):
        (self.folder / "a b#ü").mkdir()
        for name, uri in (("a b#ü/x%41.json", "a%20b%23%C3%BC/x%2541.json"), ("./studies/../y:1.json", "y%3A1.json"),
                          ("studies//z.json", "studies/z.json"), ("-w.json", "-w.json"), (str(self.folder / "v.json"), f"file://{self.folder}/v.json")):
            with self.subTest(name):
                (self.folder / name).write_text("{}", encoding="utf-8")
                done = self.expect(2, "check", "--format", "sarif", "--", name)
                (result,) = json.loads(done.stdout)["runs"][0]["results"]
                got = result["locations"][0]["physicalLocation"]["artifactLocation"]["uri"]
                self.assertEqual(got, uri)
                self.assertTrue((self.folder / urllib.parse.unquote(re.sub("^file://", "", got))).exists())

    def test_a_problem_of_a_study_lies_in_the_model_where_it_does(self):
        self.write("problems/model.json", '{ "format": "modetune-model/1" }')
        path = self.write("studies/s.json", study())
        problems, run, _ = self.both(path, code=2)
        uris = {r["locations"][0]["physicalLocation"]["artifactLocation"]["uri"] for r in run["results"]}
        self.assertEqual(uris, {"problems/model.json"})
        self.assertEqual({p["file"] for p in problems}, {"studies/../problems/model.json"})

    def test_what_is_too_much_is_counted(self):
        self.write("bad.json", "{}")
        self.write("many.json", '{ "format": "modetune-model/1", "dimension": 2, "bodies": [' + ", ".join(["{}"] * 300) + "] }")
        problems, _, text = self.both("many.json", "many.json", "bad.json", code=2)
        self.assertEqual(len(problems), 401)
        self.assertRegex(text, r"many.json: \d+ more not shown\n")

    def test_sarif_is_of_check_alone(self):
        self.assertIn('--format: "sarif" is not one of text, json, csv\n', self.expect(2, "modes", self.model, "--format", "sarif").stderr)
        self.assertIn('is not one of text, json, csv, html; did you mean "html"?', self.expect(2, "report", "x", "--format", "htm").stderr)
        self.assertIn('is not one of text, json, csv, sarif; did you mean "sarif"?', self.expect(2, "check", "x", "--format", "sarf").stderr)


if __name__ == "__main__":
    main()

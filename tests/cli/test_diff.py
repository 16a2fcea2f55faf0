# SPDX-License-Identifier: GPL-3.0-or-later
"""diff finds every member that differs, and nothing else: each one is changed, taken away and moved (MT_EVERY=1; else an eighth of them)."""
import copy
import csv
import ctypes
import io
import json
import re

from common_cli import SOURCE, CliTest, main, study
from suite import EVERY

# What is not compared, wherever it stands.
SENTENCES = {"history", "column", "goal", "kkt_residual", "line", "orthogonality", "outputs", "reasons", "residual", "status_text", "text", "warnings"}
# Lists whose items are found by what they are about. A change of that makes another item of it.
KEYS = {"assumptions": ["parameter"], "certificates": ["kind", "pointer"], "curves": ["configuration", "pointer"], "extremes": ["kind"], "limits": ["pointer"], "tones": ["tone"],
         "clearances": ["configuration", "mode", "band"], "doubts": ["kind", "configuration", "pointer"],
        "excitations": ["pointer", "name"], "facts": ["kind", "configuration", "pointer"],
        "frequencies": ["configuration", "mode", "name", "reference"], "gap_assignment": ["configuration", "band"], "goals": ["pointer"],
        "inputs": ["file"], "mac_matrices": ["configuration", "reference"], "rows": ["mode"], "motion": ["goal", "drive"], "objectives": ["text"], "orders": ["label"], "overrides": ["kind", "name"], "parameters": ["name"],
        "per_variable": ["name"], "published": ["pointer"], "relaxations": ["kind", "pointer", "what"], "responses": ["goal", "configuration"], "responses_between": ["goal", "drive"], "spread": ["parameter"], "vary": ["pointer"]}
LIBC = ctypes.CDLL(None)
BY_PLACE = {"densities", "history", "points", "reasons", "recommendations", "unchecked", "undetermined", "outputs"}
MADE_BY = ("study", "model", "run")
HOLDS = """, "published": [
    { "label": "spring", "parameter": "k1", "value": 3, "tolerance_percent": 0.1, "source": "a" }, { "status": "solved" } ],
    "search": { "starts": 4 }"""
# One mass between two bands, its spring with a tolerance: designs with clearances, bands and a tolerance box.
BANDED = {
    "format": "modetune-study/1", "name": "Banded", "model": "../problems/model.json",
    "variables": [{"parameter": "k1", "lower": 1, "upper": 10, "tolerance_percent": 1}, {"parameter": "k2", "lower": 1, "upper": 10}],
    "goals": [{"type": "avoid", "configurations": ["held"], "bands_hz": [[0.2, 0.3]], "margin_percent": 2, "up_to_hz": 1}],
    "objective": [{"minimise": "k1 + k2"}, {"minimise": "change"}], "search": {"starts": 4},
}


def obeys_permissions():
    """So does root after the next exec: it may not have the capabilities to read what nobody may read."""
    for capability in (1, 2):  # CAP_DAC_OVERRIDE, CAP_DAC_READ_SEARCH
        LIBC.prctl(24, capability, 0, 0, 0)  # PR_CAPBSET_DROP


def leaves(value, way=()):
    """Way and value of everything that is no list or object."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from leaves(inner, (*way, key))
    elif isinstance(value, list):
        for i, inner in enumerate(value):
            yield from leaves(inner, (*way, i))
    else:
        yield way, value


def pointer(way):
    return "".join("/" + str(step).replace("~", "~0").replace("/", "~1") for step in way)


def at(value, way):
    for step in way:
        value = value[step]
    return value


def passed_over(way):
    return any(step in SENTENCES and not (step == "text" and "objectives" in way) for step in way if not isinstance(step, int)) or way == ("format",)


def is_key(way):
    """Is it what an item of a list is found by?"""
    return len(way) > 2 and isinstance(way[-2], int) and way[-1] in KEYS.get(way[-3], ())


def other(value):
    if isinstance(value, bool):
        return not value
    if value is None:
        return 0.25
    return value + "x" if isinstance(value, str) else value * 1.5 + 0.5


class Diff(CliTest):
    def setUp(self):
        super().setUp()
        self.write("studies/two.json", study(extra=HOLDS))
        self.expect(0, "run", "studies/two.json", "--quiet")
        self.result = json.loads((self.folder / "results/two/result.json").read_text(encoding="utf-8"))

    def put(self, result, name="b.json"):
        return self.write(name, result if isinstance(result, str) else json.dumps(result))

    def diff(self, a, b, *options, code=None):
        done = self.run_program("diff", a, b, "--format", "json", *options)
        got = json.loads(done.stdout)
        self.assertEqual(done.returncode, 0 if got["same"] else 1, done.stderr)
        self.assertEqual(got["same"], not got["differences"])
        if code is not None:
            self.assertEqual(done.returncode, code)
        return got

    def found(self, got):
        return [(d["pointer_a"], d["pointer_b"]) for d in got["made_by"] + got["differences"]]

    def leaf_of_each_kind(self, result, within=()):
        """Way and value; of lists the last item's. An eighth of them, unless all are asked for (MT_EVERY=1)."""
        kinds = {}
        for way, value in leaves(at(result, within)):
            kinds[tuple("#" if isinstance(step, int) else step for step in way)] = (*within, *way), value
        every = [leaf for leaf in kinds.values() if leaf[0] != ("format",)]
        self.assertGreater(len(every), 50)
        return every if EVERY else every[::8]

    def changed(self, result, way, value):
        other_one = copy.deepcopy(result)
        at(other_one, way[:-1])[way[-1]] = value
        return self.put(other_one)

    def every_member(self, result, within=()):
        a = self.put(result, "a.json")
        for way, value in self.leaf_of_each_kind(result, within):
            here, item = pointer(way), pointer(way[:-1])
            with self.subTest(here):
                got = self.diff(a, self.changed(result, way, other(value)))
                if is_key(way):  # of modes the name counts, where they have one, else the index
                    self.assertIn(self.found(got), [[(item, None), (None, item)], [(here, here)]])
                elif passed_over(way):
                    self.assertEqual(self.found(got), [])
                else:
                    (row,) = got["made_by"] + got["differences"]
                    self.assertEqual((row["pointer_a"], row["pointer_b"], row["a"], row["b"]), (here, here, value, other(value)))
                    self.assertEqual(bool(got["made_by"]), way[0] in MADE_BY)
                if isinstance(way[-1], str) and not is_key(way):
                    without = copy.deepcopy(result)
                    del at(without, way[:-1])[way[-1]]
                    wanted = [] if passed_over(way) else [(here, None)]
                    self.assertEqual(self.found(self.diff(a, self.put(without))), wanted)
                    self.assertEqual(self.found(self.diff("b.json", a)), [pair[::-1] for pair in wanted])

    def test_every_list_of_a_result_says_what_its_items_are_found_by(self):
        schema = json.loads((SOURCE / "schemas/result.schema.json").read_text(encoding="utf-8"))
        lists = set()

        def collect(value, name=None):
            if isinstance(value, dict):
                if name is not None and "items" in value and {"$ref", "properties"} & set(value["items"]):
                    lists.add(name)
                for key, inner in value.items():
                    for member, part in inner.items() if key == "properties" else [(name, inner)]:
                        collect(part, member)
            elif isinstance(value, list):
                for inner in value:
                    collect(inner, name)

        collect(schema)
        self.assertEqual(lists, set(KEYS) | BY_PLACE)

    def test_every_member_that_differs_is_found_and_no_other(self):
        self.every_member(self.result)

    def test_so_it_is_of_bands_and_tolerances(self):
        path = self.write("studies/banded.json", json.dumps(BANDED))
        self.run_program("run", path, "--quiet")
        result = json.loads((self.folder / "results/banded/result.json").read_text(encoding="utf-8"))
        design = result["recommendations"][0]
        self.assertTrue(design["clearances"] and design["gap_assignment"])
        self.every_member(result, ("recommendations", 0))

    def test_items_are_found_wherever_they_stand(self):
        turned = copy.deepcopy(self.result)

        def turn(value):
            for key, inner in list(value.items()) if isinstance(value, dict) else enumerate(value):
                if isinstance(inner, (dict, list)):
                    turn(inner)
                if isinstance(inner, list) and key in KEYS:
                    inner.reverse()
                elif isinstance(inner, dict):
                    value[key] = dict(reversed(inner.items()))

        turn(turned)
        self.assertNotEqual(json.dumps(turned), json.dumps(self.result))
        self.assertEqual(self.found(self.diff("results/two", self.put(turned), code=0)), [])
        turned["recommendations"][0]["parameters"][0]["recommended"] *= 1.1  # k2, which was the second
        (row,) = self.diff("results/two", self.put(turned))["differences"]
        self.assertEqual((row["pointer_a"], row["pointer_b"]),
                         ("/recommendations/0/parameters/1/recommended", "/recommendations/0/parameters/0/recommended"))
        self.assertEqual((row["part"], row["what"], row["member"], row["unit"]), ("recommendation 1", "parameter k2", "recommended", "N/m"))
        self.assertAlmostEqual(row["change_percent"], 10, delta=1e-12)

    def test_tolerances_are_of_the_numbers_they_stand_beside(self):
        a = self.put(self.result, "a.json")
        for way, by, below, above in (
                (("recommendations", 0, "parameters", 0, "recommended"), 1e-4 * self.result["recommendations"][0]["parameters"][0]["recommended"], 2e-4, 5e-5),
                (("recommendations", 0, "frequencies", 0, "error_percent"), 1e-3, 2e-5, 5e-6),
                (("recommendations", 0, "change"), 1e-3, 2e-3, 5e-4),
                (("recommendations", 0, "goals", 0, "value"), 1e-4 * self.result["recommendations"][0]["goals"][0]["target"], 2e-4, 5e-5)):
            with self.subTest(pointer(way)):
                changed = copy.deepcopy(self.result)
                at(changed, way[:-1])[way[-1]] += by
                b = self.put(changed)
                self.assertTrue(self.diff(a, b, "--rel-tol", str(below))["same"])
                self.assertFalse(self.diff(a, b, "--rel-tol", str(above))["same"])
                self.assertFalse(self.diff(a, b)["same"])
        nothing, target = copy.deepcopy(self.result), self.result["recommendations"][0]["goals"][0]["target"]
        nothing["recommendations"][0]["goals"][0]["value"] = 0  # beside its target
        b = self.changed(nothing, ("recommendations", 0, "goals", 0, "value"), 1e-4 * target)
        self.assertTrue(self.diff(self.put(nothing, "a.json"), b, "--rel-tol", "2e-4")["same"])
        self.assertFalse(self.diff("a.json", b, "--rel-tol", "5e-5")["same"])
        for wrong in ("1", "-0.1", "nan", "x", "1e-6x", "0x1p-3", "inf"):
            self.assertIn(f'--rel-tol: "{wrong}" is not a number from 0 up to 1', self.expect(2, "diff", a, a, f"--rel-tol={wrong}").stderr)

    def test_a_floor_whatever_the_size(self):
        a = self.put(self.result, "a.json")
        way = ("recommendations", 0, "change")
        b = self.changed(self.result, way, self.result["recommendations"][0]["change"] + 3e-7)
        self.assertFalse(self.diff(a, b)["same"])
        self.assertTrue(self.diff(a, b, "--abs-tol", "4e-7")["same"])
        self.assertFalse(self.diff(a, b, "--abs-tol", "2e-7")["same"])
        b = self.changed(self.result, way, 2.0)  # beside a floor of 1e30 everything is the same but what is no number
        self.assertTrue(self.diff(a, b, "--abs-tol", "1e30", "--rel-tol", "1e-9")["same"])
        self.assertFalse(self.diff(a, self.changed(self.result, ("recommendations", 0, "feasible"), None), "--abs-tol", "1e30")["same"])
        for wrong in ("-0.1", "nan", "x", "1e-6x", "0x1p-3", "inf"):
            self.assertIn(f'--abs-tol: "{wrong}" is not a number from 0', self.expect(2, "diff", a, a, f"--abs-tol={wrong}").stderr)

    def test_how_an_answer_was_made_is_told_and_is_no_difference(self):
        changed = copy.deepcopy(self.result)
        changed["run"]["modetune"], changed["run"]["seed"] = "9.9.9", 77
        changed["run"]["inputs"][0]["sha256"] = "0" * 64
        done = self.expect(0, "diff", "results/two/", self.put(changed))
        self.assertEqual(done.stderr, "")
        self.assertIn("\nmade by\n", done.stdout)
        self.assertRegex(done.stdout, r"\n  - +modetune +\S+ +9\.9\.9\n")
        self.assertRegex(done.stdout, r"\n  - +seed +1 +77\n")
        self.assertTrue(done.stdout.endswith("\nThe answers are the same.\n"))

    def test_text_and_csv(self):
        self.write("studies/other.json", study(first_hz=0.14, extra=HOLDS))
        self.run_program("run", "studies/other.json", "--quiet")
        done = self.expect(1, "diff", "results/two", "results/other")
        self.assertTrue(done.stdout.startswith("A  results/two\nB  results/other\n\nmade by\n"))
        self.assertRegex(done.stdout, r"\n  frequency held first +recommended_hz +Hz +0\.132894 +0\.138364 +\+4\.12\n")
        count = re.search(r"\nThe answers differ in (\d+) members; (\d+) of them follow from the others and are left out here\.\n$", done.stdout)
        got = self.diff("results/two", "results/other")
        self.assertEqual(int(count[1]), len(got["differences"]))
        rows = list(csv.DictReader(io.StringIO(self.expect(1, "diff", "results/two", "results/other", "--format", "csv").stdout)))
        self.assertEqual(len(rows), len(got["differences"]) + len(got["made_by"]))
        self.assertEqual([r["member"] or None for r in rows if r["part"] != "made by"], [d["member"] for d in got["differences"]])

    def test_what_is_no_result(self):
        good = "results/two/result.json"
        text = (self.folder / good).read_text(encoding="utf-8")
        (self.folder / "empty").mkdir()
        for code, name, content, says in (
                (4, "none.json", None, "none.json: No such file"),
                (4, "empty", None, "empty/result.json: No such file"),
                (2, "newer.json", text.replace("modetune-result/1", "modetune-result/2", 1), "newer.json:2:13: error: /format: "),
                (2, "study.json", study(), "study.json:1:12: error: /format: "),
                (2, "list.json", "[]", "list.json:1:1: error: must be an object, not a list"),
                (2, "nan.json", text.replace('"rank": 1', '"rank": NaN', 1), "nan.json:"),
                (2, "twice.json", '{"format": "modetune-result/1", "a": 1, "a": 2}', 'twice.json:1:41: error: '),
                (2, "bare.json", "{}", 'bare.json:1:1: error: member "format" is missing'),
                (2, "cut.json", text[:len(text) // 2], "cut.json:")):
            with self.subTest(name):
                if content is not None:
                    self.write(name, content)
                for pair in ((good, name), (name, good), (name, name)):
                    done = self.expect(code, "diff", *pair)
                    self.assertIn(says, done.stderr)
                    self.assertEqual(done.stdout, "")
        (self.folder / "a.json").write_text(text, encoding="utf-8")
        (self.folder / "a.json").chmod(0)
        self.assertIn("Permission denied", self.expect(4, "diff", good, "a.json", preexec_fn=obeys_permissions).stderr)

    def test_what_has_other_types_or_is_almost_nothing_is_compared_all_the_same(self):
        bare = self.put('{"format": "modetune-result/1"}', "bare.json")
        self.assertTrue(self.diff(bare, bare, code=0)["same"])
        got = self.diff("results/two", bare, code=1)
        self.assertEqual({d["pointer_b"] for d in got["differences"]}, {None})
        for odd in (None, 3, "x", [], {}, [[[1]]], {"a~/b": [{"c": None}]}):
            for name in ("status", "recommendations", "run", "baseline", "study"):
                with self.subTest(odd=odd, name=name):
                    changed = dict(self.result, **{name: odd})
                    got = self.diff(self.put(changed, "a.json"), self.put(self.result))
                    self.assertTrue(self.found(got))
                    self.assertEqual(self.found(self.diff("a.json", "a.json", code=0)), [])
        a = {"format": "modetune-result/1", "x": {"a~/b": [{"c": None}]}}
        b = {"format": "modetune-result/1", "x": {"a~/b": [{"c": 1}]}}
        self.assertEqual(self.found(self.diff(self.put(a, "a.json"), self.put(b))), [("/x/a~0~1b/0/c", "/x/a~0~1b/0/c")])


if __name__ == "__main__":
    main()

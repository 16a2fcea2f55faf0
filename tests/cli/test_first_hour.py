# SPDX-License-Identifier: GPL-3.0-or-later
"""From an empty folder to an answer: init, examples, schema, and the catalogue of aircraft that is found without a path."""
import json
import re

import jsonschema
from common_cli import SOURCE, CliTest, main
from suite import EVERY

SLOW = ("arm", "stick")  # seconds: answered with MT_EVERY=1
STUDY = """{ "format": "modetune-study/1", "name": "x", "model": "../mine/model.json",
  "variables": [ { "parameter": "servo", "lower": 200, "upper": 5000 } ],
  "goals": [ { "type": "avoid", "configuration": "held", "up_to_hz": 100,
               "rotor": { "aircraft": "UH-60", "harmonics": ["4P"], "margin_percent": 5 } } ] }
"""


class FirstHour(CliTest):
    def text(self, path):
        return (self.folder / path).read_text(encoding="utf-8")

    def test_init_makes_a_model_and_a_study_that_is_answered(self):
        done = self.expect(0, "init", "mine")
        self.assertEqual(done.stdout, "mine/model.json\nmine/study.json\nmine/schemas/model.schema.json\nmine/schemas/study.schema.json\n")
        self.assertIn('"modetune run study.json"', done.stderr)
        self.assertEqual(self.expect(0, "init", "other", "--quiet").stderr, "")
        self.assertEqual({str(p.relative_to(self.folder / "mine")) for p in (self.folder / "mine").rglob("*") if p.is_file()},
                         {"model.json", "study.json", "schemas/model.schema.json", "schemas/study.schema.json"})
        for name in ("model", "study"):
            document = json.loads(self.text(f"mine/{name}.json"))
            schema = json.loads(self.text(f"mine/{document['$schema']}"))
            self.assertEqual([e.message for e in jsonschema.Draft7Validator(schema).iter_errors(document)], [])
            self.assertEqual(self.expect(0, "check", f"mine/{name}.json").stderr, "")
        modes = json.loads(self.expect(0, "modes", "mine/model.json", "-c", "held", "--format", "json").stdout)
        self.assertEqual(modes["redundant_constraints"], [])
        band = (258 / 60 * 4 * 0.95 * 0.9, 258 / 60 * 4 * 1.05 * 1.1)  # 4P of the study's rotor: the model has to change
        self.assertTrue(any(band[0] < m["frequency_hz"] < band[1] for m in modes["modes"]))
        self.expect(0, "run", "mine/study.json")
        result = json.loads(self.text("results/study/result.json"))
        self.assertEqual(result["status"], "solved")
        self.assertTrue(all(r["feasible"] for r in result["recommendations"]))

    def test_every_kind_is_a_model_in_space_that_its_study_answers(self):
        kinds = re.search(r"^ +--kind ([a-z|]+)", self.expect(0, "init", "--help").stdout, re.M).group(1).split("|")
        self.assertEqual(set(kinds), {p.name for p in (SOURCE / "src/cli/init").iterdir() if p.is_dir()})
        for kind in kinds:
            with self.subTest(kind):
                self.expect(0, "init", kind, "--kind", kind)
                model, study = (json.loads(self.text(f"{kind}/{name}.json")) for name in ("model", "study"))
                self.assertEqual(model["dimension"], 3)
                for document, schema in ((model, "model"), (study, "study")):
                    known = json.loads(self.text(f"{kind}/schemas/{schema}.schema.json"))
                    self.assertEqual([e.message for e in jsonschema.Draft7Validator(known).iter_errors(document)], [])
                self.assertNotIn("warning", self.expect(0, "check", f"{kind}/model.json", f"{kind}/study.json").stderr)
                if kind in SLOW and not EVERY:
                    continue
                done = self.expect(0, "run", f"{kind}/study.json", "-o", f"{kind}/results", "--quiet")
                self.assertRegex(done.stdout.splitlines()[1], "^(Solved|Fitted): ")
                result = json.loads(self.text(f"{kind}/results/study/result.json"))
                self.assertGreater(result["recommendations"][0]["change"], 0.01)  # something has to change
        self.assertEqual(self.expect(2, "init", "x", "--kind", "stik").stderr.splitlines()[0],
                         'modetune: error: no kind of model is called "stik"; --kind takes stick, mounts, arm, updating or rotor')

    def test_init_leaves_alone_what_is_there(self):
        self.expect(0, "init", "mine")
        again = self.text("mine/model.json")
        self.expect(0, "init", "mine")  # the same bytes: nothing to be lost
        self.assertEqual(self.text("mine/model.json"), again)
        self.write("mine/study.json", "{}")
        (self.folder / "mine/model.json").unlink()
        done = self.expect(2, "init", "mine")
        self.assertEqual(done.stderr, "modetune: error: mine/study.json: is there already, and is left alone\n")
        self.assertEqual(self.text("mine/study.json"), "{}")
        self.assertFalse((self.folder / "mine/model.json").exists())

    def test_every_example_comes_with_all_that_it_names(self):
        listed = json.loads(self.expect(0, "examples", "--format", "json").stdout)
        studies = {p.stem: json.loads(p.read_text(encoding="utf-8"))["name"] for p in (SOURCE / "studies").glob("*.json")}
        self.assertEqual({e["name"]: e["text"] for e in listed}, studies)
        for name in studies:
            with self.subTest(name):
                written = self.expect(0, "examples", name, "-o", name).stdout.splitlines()
                for path in written:
                    self.assertEqual(self.text(path), (SOURCE / path.removeprefix(name + "/")).read_text(encoding="utf-8"))
                self.expect(0, "check", f"{name}/studies/{name}.json")
        done = self.expect(2, "examples", "inceptor_roter")
        self.assertIn('no example is called "inceptor_roter"; did you mean "inceptor_rotor"?', done.stderr)

    def test_a_result_is_read_by_its_folder_too(self):
        self.expect(0, "init", "mine")
        self.expect(0, "run", "mine/study.json")
        for command in ("report", "explain", "apply", "show"):
            with self.subTest(command):
                self.assertEqual(self.expect(0, command, "results/study").stdout,
                                 self.expect(0, command, "results/study/result.json").stdout)
        self.assertIn("error: results/result.json: No such file", self.expect(4, "explain", "results/").stderr)

    def test_a_file_of_another_kind_is_one_error(self):
        model, study, aircraft, profile = ("problems/inceptor.json", "studies/inceptor_tuning_1.json", "problems/aircraft.json",
                                           "problems/profiles/truck_vertical.json")
        wrong = [("modes", study), ("modes", aircraft), ("modes", profile), ("run", model), ("run", aircraft), ("run", profile), ("profile", model), ("profile", study)]
        wrong += [(command, file) for command in ("explain", "report", "show", "diff") for file in (model, study, aircraft, profile) if (command, file) != ("show", model)]
        for command, file in wrong:
            done = self.expect(2, command, *[SOURCE / file] * (2 if command == "diff" else 1))
            lines = done.stderr.splitlines()
            self.assertEqual(len(lines), 2 if command == "diff" else 1, done.stderr)
            for line in lines:
                self.assertRegex(line, r':\d+:\d+: error: /format: the format is not "modetune-\w+/1": this is not a .*; it is a ')

    def test_apply_writes_no_digit_more_than_the_number_has(self):
        self.expect(0, "init", "mine")
        self.expect(0, "run", "mine/study.json")
        applied = self.expect(0, "apply", "results/study").stdout
        result = json.loads(self.text("results/study/result.json"))
        for p in result["recommendations"][0]["parameters"]:
            said = re.search(rf'"{p["name"]}": {{ "value": ([^ ,]+)', applied)[1]
            self.assertEqual(float(said), p["recommended"])
            self.assertLessEqual(len(re.sub("[-.]", "", said).lstrip("0")), len(re.sub("[-.]", "", repr(p["recommended"])).lstrip("0")))

    def test_schemas_are_those_of_the_sources(self):
        listed = {e["name"] for e in json.loads(self.expect(0, "schema", "--format", "json").stdout)}
        self.assertEqual(listed, {p.name.removesuffix(".schema.json") for p in (SOURCE / "schemas").glob("*.schema.json")})
        for name in listed:
            self.assertEqual(self.expect(0, "schema", name).stdout, (SOURCE / f"schemas/{name}.schema.json").read_text(encoding="utf-8"))
        self.assertIn('no schema is called "modle"; did you mean "model"?', self.expect(2, "schema", "modle").stderr)

    def test_the_catalogue_of_aircraft_is_found_without_a_path(self):
        self.expect(0, "init", "mine")
        self.write("mine/study.json", STUDY.replace("../mine/", ""))
        self.expect(0, "run", "mine/study.json")
        result = json.loads(self.text("results/study/result.json"))
        self.assertIn("aircraft.json of modetune", [i["file"] for i in result["run"]["inputs"]])
        # one that is there wins
        self.write("mine/aircraft.json", (SOURCE / "problems/aircraft.json").read_text(encoding="utf-8").replace("UH-60", "XY-1"))
        self.assertIn("UH-60", self.expect(2, "check", "mine/study.json").stderr)


class Slips(CliTest):
    MODEL = {"format": "modetune-model/1", "dimension": 2, "parameters": {"k": 100, "m": 2},
             "bodies": [{"name": "a", "mass_kg": "m", "inertia_kg_m2": 0.1, "centre": [0, 0]}],
             "joints": [{"name": "g", "type": "prismatic", "bodies": ["ground", "a"], "at": [0, 0], "axis": [1, 0]}],
             "springs": [{"name": "s", "type": "axial", "bodies": ["ground", "a"], "at": [[-1, 0], [0, 0]], "stiffness_n_per_m": "k"}]}
    STUDY = {"format": "modetune-study/1", "model": "m.json", "variables": [{"parameter": "k", "lower": 50, "upper": 200}],
             "goals": [{"type": "frequency", "mode": 1, "at_least_hz": 1.2}]}

    def said(self, study=None, model=None, also=()):
        self.write("m.json", json.dumps(dict(self.MODEL, **(model or {}))))
        self.write("s.json", json.dumps(dict(self.STUDY, **(study or {}))))
        done = self.run_program("check", *also, "s.json")
        return done.returncode, done.stderr

    def test_other_words_are_understood(self):
        rotor = {"speed_hz": 6.6, "blades": 4, "margin_percent": 10}
        machine = {"name": "m", "speed_hz": 20, "margin_percent": 10}
        for study, why in (
                *(({"goals": [{"type": "avoid", "rotor": dict(rotor, harmonics=[h]), "up_to_hz": 90}]}, f'did you mean "{meant}"?')
                  for h, meant in (("4p", "4P"), ("4/rev", "4P"), ("4 / Rev", "4P"), ("4 per rev", "4P"), ("n/rev", "nP"), ("NP ", "nP"), ("4", "4P"),
                                   ("2t", "2T"), ("2N/rev", "2nP"))),
                *(({"goals": [{"type": "avoid", "machine": dict(machine, orders=[h]), "up_to_hz": 90}]}, f'did you mean "{meant}"?')
                  for h, meant in (("2", "2E"), ("0.5/rev", "0.5E"), ("1.5x", "1.5E"), ("2e", "2E"))),
                ({"goals": [{"type": "avoid", "machine": {"name": "m", "speed_rpm": 700, "orders": ["1E"]}}]},
                 'unknown member "speed_rpm"; did you mean "speed_hz", with numbers as "...*rpm"?'),
                ({"goals": [{"type": "avoid", "machine": {"name": "m", "speed_range_rpm": [700, 850], "orders": ["1E"]}}]},
                 'did you mean "speed_range_hz", with numbers as "...*rpm"?'),
                ({"goals": [{"type": "frequency", "mode": 1, "at_least_rpm": 60}]}, 'did you mean "at_least_hz", with numbers as "...*rpm"?'),
                ({"objective": {"minimise": "weight"}}, 'unknown name "weight"; did you mean "mass"?')):
            with self.subTest(study=study):
                code, said = self.said(study)
                self.assertEqual(code, 2)
                self.assertIn(why, said)
        for harmonic in ("p", "4Q", "four", "0P", "4//rev", "4P4P4P4P4P4P4P4P4P"):
            with self.subTest(harmonic=harmonic):
                said = self.said({"goals": [{"type": "avoid", "rotor": dict(rotor, harmonics=[harmonic]), "up_to_hz": 90}]})[1]
                self.assertIn("is not a harmonic", said)
                self.assertNotIn("did you mean", said)
        for model, why in (({"bodies": [dict(self.MODEL["bodies"][0], weight=3)]}, 'did you mean "mass_kg"'),
                           ({"links": [{"name": "l", "from": [0, 0], "to": [1, 0], "section": {"type": "circle", "diameter_mm": 9}}]},
                            'did you mean "diameter_m", with numbers as "...*mm"?')):
            with self.subTest(model=model):
                self.assertIn(why, self.said(model=model)[1])

    def test_a_parameter_called_weight_may_be_minimised(self):
        self.assertEqual(self.said({"objective": {"minimise": "weight"}, "variables": [{"parameter": "weight", "lower": 1, "upper": 3}]},
                                   {"parameters": {"k": 100, "m": "weight", "weight": 2}})[0], 0)

    def test_what_is_wrong_is_told_once(self):
        twice = {"joints": self.MODEL["joints"] + [dict(self.MODEL["joints"][0], name="h")]}
        code, said = self.said(model=twice, also=["m.json"])
        self.assertEqual((code, said.count("redundant")), (0, 1), said)
        self.assertEqual(self.said(model=twice)[1].count("redundant"), 1)
        code, said = self.said(model={"gravity_m_per_s2": 9.81}, also=["m.json"])
        self.assertEqual((code, said.count("gravity_m_per_s2")), (2, 1))
        self.assertIn("s.json: error: the errors of its model are listed above", said)
        code, said = self.said({"objective": {"minimise": "weight"}}, {"gravity_m_per_s2": 9.81}, ["./m.json"])
        self.assertEqual((code, said.count("gravity_m_per_s2")), (2, 1))

    def test_redundant_equations_of_the_same_joints_are_one_line(self):
        def held(name, at):
            return {"name": name, "type": "fixed", "bodies": ["ground", "a"], "at": at}

        space = {"dimension": 3, "springs": [], "joints": [held("e", [0, 0, 0]), held("f", [1, 2, 3]), held("g", [2, 0, 1])],
                 "bodies": [{"name": "a", "mass_kg": 1, "inertia_kg_m2": [1, 1, 1], "centre": [0, 0, 0]},
                            {"name": "b", "mass_kg": 1, "inertia_kg_m2": [1, 1, 1], "centre": [0, 0, 0]}]}
        space["joints"].append({"name": "hinge", "type": "revolute", "bodies": ["ground", "b"], "at": [0, 0, 0], "axis": [0, 0, 1]})
        self.write("m.json", json.dumps(dict(self.MODEL, **space)))
        said = self.expect(0, "check", "m.json").stderr
        self.assertEqual(re.findall(r"redundant: (\d+) equations of (.*) change nothing", said), [("12", '"e", "f", "g"')], said)


class Universal(CliTest):
    FILE = "    -1\n    15\n         1         0         0        11  4.0E-01  0.0E+00  0.0E+00\n    -1\n" + "    -1\n    55\n" + "NONE\n" * 5 + \
        "         1         2         2         8         2         3\n         2         4         1         1\n  5.0E+00  1.0E+00  1.9E-02  0.0E+00\n" \
        "         1\n  0.0E+00 -2.4E-02 -2.1E-01\n    -1\n"

    def test_a_universal_file_is_told_by_what_it_holds(self):
        self.write("test.unv", self.FILE)
        for args in (("check", "test.unv"), ("modes", "test.unv"), ("mac", "test.unv:a", "test.unv:b"), ("run", "test.unv")):
            with self.subTest(args=args):
                said = self.expect(2, *args).stderr
                self.assertIn("test.unv:1:1: error: this is a universal file, no JSON: 1 mode shape (dataset 55), 1 node (dataset 15); "
                              "no frequency response", said)
                self.assertNotIn("unexpected", said)
        self.assertIn("test.unv:1:1: error: the file has no dataset 58; it holds: 1 mode shape (dataset 55), 1 node (dataset 15); no frequency response",
                      self.expect(2, "info", "test.unv").stderr)


if __name__ == "__main__":
    main()

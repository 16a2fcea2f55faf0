# SPDX-License-Identifier: GPL-3.0-or-later
"""info of files that are no models: each kind told by its bytes, with what it holds, the files that it names, and what is wrong with it."""
import csv
import hashlib
import io
import json
import re

from common_cli import SOURCE, CliTest, main, study

PROFILE = {"format": "modetune-profile/1", "name": "Shaker", "axis": "y",
           "random": [{"psd_g2_per_hz": [[10, 0.01], [1000, 0.01]], "origin": "published", "source": "a standard"}],
           "tones": [{"frequency_hz": [20, 25], "acceleration_g": 2, "origin": "published", "source": "a standard"}]}
TABLE = "frequency_hz,real,imag,coherence,input,output,configuration,unit\n" + "".join(
    f"{hz},1,0.5,0.9,a.x,{out}:acceleration,held,m/s^2 per N\n" for out in ("a.x", "b.x") for hz in range(1, 4 if out == "a.x" else 9))


class Info(CliTest):
    def held(self, path, *more):
        """What info tells of the file as JSON, with what it says of every file."""
        got = self.json_of("info", path, *more)
        bytes_ = (self.folder / got["file"]).read_bytes()
        self.assertEqual((got["bytes"], got["sha256"]), (len(bytes_), hashlib.sha256(bytes_).hexdigest()))
        text = self.expect(0, "info", path, *more).stdout
        self.assertTrue(text.startswith(f'{got["file"]}: {got["kind"]} ({got["format"]}), {len(bytes_)} bytes\n'), text)
        for part in dict.fromkeys(i["part"] for i in got["items"]):
            self.assertIn(f'\n{part} ({sum(i["part"] == part for i in got["items"])})\n', text)
        rows = list(csv.DictReader(io.StringIO(self.expect(0, "info", path, "--format", "csv", *more).stdout)))
        self.assertEqual([(row["part"], row["name"], row["count"]) for row in rows],
                         [(i["part"], i["name"] or "", "" if i["count"] is None else str(i["count"])) for i in got["items"]])
        return got

    def parts(self, got, part):
        return [i for i in got["items"] if i["part"] == part]

    def states(self, got):
        return {f["file"]: (f["what"], f["state"]) for f in got["refers_to"]}

    def test_a_study_and_what_it_names(self):
        text = study(extra=', "author": "A. Nyquist", "references": {"other": {"model": "../problems/other.json", "configuration": "held"}}')
        self.write("problems/other.json", (self.folder / self.model).read_text(encoding="utf-8"))
        path = self.write("studies/two.json", text)
        got = self.held(path)
        self.assertEqual((got["kind"], got["format"], got["name"], got["author"]), ("study", "modetune-study/1", "Two springs", "A. Nyquist"))
        k1, k2 = self.parts(got, "variable")
        self.assertEqual((k1["name"], k1["value"], k1["lower"], k1["upper"], k1["unit"]), ("k1", 3, 0.1, 100, "N/m"))
        self.assertEqual((k2["name"], k2["value"]), ("k2", 1))
        goals = self.parts(got, "goal")
        self.assertEqual([(g["name"], g["text"], g["unit"]) for g in goals],
                         [("/goals/0", 'frequency of mode "first" in "held"', "Hz"), ("/goals/1", 'frequency of mode 2 in "held"', "Hz")])
        self.assertAlmostEqual(goals[0]["value"], 0.13289, places=5)
        self.assertEqual([o["name"] for o in self.parts(got, "objective")], ["change"])
        self.assertEqual(self.states(got), {"../problems/model.json": ("model", "found"), "../problems/other.json": ("reference", "found")})
        # of a study whose model is not there it tells what it can, and the error
        (self.folder / "problems/other.json").rename(self.folder / "problems/gone.json")
        done = self.expect(2, "info", path, "--format", "json")
        self.assertRegex(done.stderr, r"^studies/two.json:\d+:\d+: error: /references/other/model: ")
        got = json.loads(done.stdout)
        self.assertEqual((got["name"], got["items"]), ("Two springs", []))
        self.assertEqual(self.states(got), {"../problems/model.json": ("model", "found"), "../problems/other.json": ("reference", "not found")})

    def test_results_and_what_lies_beside_them(self):
        self.write("studies/two.json", study(first_hz=0.1329, second_hz=0.331))
        self.write("studies/one.json", study())
        self.expect(0, "run", "studies/two.json", "studies/one.json", "-o", "out")
        got = self.held("out/two")
        self.assertEqual(got["file"], "out/two/result.json")
        version = re.match(r"modetune (\S+) \(commit (\S+),", self.expect(0, "--version").stdout).groups()
        self.assertEqual((got["kind"], got["modetune"], got["commit"], got["name"]), ("result", *version, "Two springs"))
        result = json.loads((self.folder / "out/two/result.json").read_text(encoding="utf-8"))
        self.assertEqual(len(self.parts(got, "design")), 1 + len(result["recommendations"]))
        hz = {f["name"]: f["value"] for f in self.parts(got, "frequency")}
        best = result["recommendations"][0]
        for f in best["frequencies"]:
            name = "" if f["name"] is None else f', {f["name"]}'
            self.assertEqual(hz[f'design 1, {f["configuration"]}, mode {f["mode"]}{name}'], f["recommended_hz"])
        self.assertIn(f'{sum(g["met"] for g in best["goals"])} of {len(best["goals"])} goals met', self.parts(got, "design")[1]["text"])
        self.assertTrue(got["status"].startswith("solved: "))
        names = self.states(got)
        self.assertEqual((names["two.json"], names["../problems/model.json"]), (("study", "found"), ("input", "found")))
        self.assertEqual(names["recommendations.csv"], ("output", "found"))
        index = self.held("out/index.json")
        self.assertEqual([(i["name"], i["text"]) for i in index["items"]], [("two.json", "answered, solved"), ("one.json", "answered, solved")])
        self.assertEqual(set(self.states(index).values()), {("result", "found")})
        timing = self.held("out/two/timing.json")
        self.assertEqual(timing["refers_to"], [{"what": "study", "file": str((self.folder / "studies/two.json").resolve()), "state": "found"},
                                               {"what": "result", "file": "result.json", "state": "found"}])
        # files that have other bytes than those that were solved
        self.write("problems/model.json", (self.folder / "problems/model.json").read_text(encoding="utf-8") + "\n")
        (self.folder / "studies/two.json").unlink()
        names = self.states(self.held("out/two"))
        self.assertEqual((names["two.json"][1], names["../problems/model.json"][1]), ("not found", "changed"))

    def test_journals_progress_and_scenes(self):
        self.write("studies/two.json", study(first_hz=0.1329, second_hz=0.331))
        done = self.run_program("run", "studies/two.json", "-o", "out", "--shard", "1/2", "--progress", "json", "--quiet")
        journal = next((self.folder / "out").glob("*.journal"))
        got = self.held(f"out/{journal.name}")
        lines = [line for line in journal.read_text(encoding="utf-8").splitlines()[1:] if not line.startswith("|")]
        self.assertEqual([i["count"] for i in self.parts(got, "records")], [len(lines), 0])
        self.assertEqual([i["name"] for i in self.parts(got, "input")], ["two.json", "../problems/model.json"])
        self.assertEqual(got["modetune"], re.match(r"modetune (\S+)", self.expect(0, "--version").stdout).group(1))
        journal.write_text(journal.read_text(encoding="utf-8") + "0123456789abcdef broken/0 1\n", encoding="utf-8")
        self.assertEqual([i["count"] for i in self.parts(self.held(f"out/{journal.name}"), "records")], [len(lines), 1])
        told = [line for line in done.stderr.splitlines() if line.startswith("{")]
        got = self.held(self.write("progress.txt", "".join(line + "\n" for line in told)))
        self.assertEqual([(i["name"], i["count"], i["value"]) for i in got["items"]], [("studies/two.json", len(told), json.loads(told[-1])["share"])])
        self.expect(0, "show", self.model, "--format", "json", "-o", "scene.json")
        got = self.held("scene.json")
        self.assertEqual((got["kind"], got["name"]), ("scene", "Two masses"))
        self.assertEqual([(i["name"], i["count"]) for i in self.parts(got, "configuration")], [("held", 2), ("twice", 2), ("free", 2), ("heavy", 2)])

    def test_profiles_rotors_and_measurements(self):
        got = self.held(self.write("profile.json", json.dumps(PROFILE)))
        (random,), (tone,) = self.parts(got, "random"), self.parts(got, "tone")
        self.assertEqual((random["lower_hz"], random["upper_hz"], random["count"], random["unit"]), (10, 1000, 2, "m/s^2"))
        self.assertAlmostEqual(random["value"], 9.80665 * (0.01 * 990) ** 0.5, places=9)
        self.assertAlmostEqual(tone["value"], 2 * 9.80665, places=12)
        self.assertEqual([i["name"] for i in self.parts(got, "axis")], ["y"])
        rotors = self.json_of("info", str(SOURCE / "problems/aircraft.json"))
        self.assertIn(("UH-60, main rotor", 4), [(i["name"], i["count"]) for i in rotors["items"]])
        table = self.held(self.write("hammer.csv", TABLE))
        self.assertEqual((table["kind"], table["format"]), ("measurement", "CSV table"))
        self.assertEqual([(i["name"], i["unit"], i["lower_hz"], i["upper_hz"], i["count"], i["text"]) for i in table["items"]],
                         [("a.x:acceleration by a.x", "m/s^2 per N", 1, 3, 3, "frequency response, configuration held, with coherence"),
                          ("b.x:acceleration by a.x", "m/s^2 per N", 1, 8, 8, "frequency response, configuration held, with coherence")])
        self.assertEqual(self.held(self.write("marked.csv", "\ufeff# a hammer\n" + TABLE))["items"], table["items"])
        self.assertEqual(self.held(self.write("capital.csv", TABLE.replace("frequency_hz", "Frequency_Hz")))["items"], table["items"])
        for name, n in (("text", 2), ("binary", 1)):
            path = f"{name}.uff"
            (self.folder / path).write_bytes((SOURCE / "tests/fuzz/corpus/fuzz_measurement" / path).read_bytes())
            got = self.held(path)
            self.assertEqual((got["format"], len(got["items"])), ("universal file, datasets 58", n))
            self.assertEqual((got["items"][0]["name"], got["items"][0]["lower_hz"], got["items"][0]["upper_hz"], got["items"][0]["count"]),
                             ("dataset 1: node 3, direction 1, by node 1, direction 1", 10, 30, 3))

    def test_a_model_is_told_as_ever(self):
        self.assertEqual([c["configuration"] for c in self.json_of("info", self.model)], ["held", "twice", "free", "heavy"])
        # a byte order mark is the model reader's to refuse
        self.assertIn("byte order mark", self.expect(2, "info", self.write("marked.json", "\ufeff" + (self.folder / self.model).read_text(encoding="utf-8"))).stderr)

    def test_wrong_files(self):
        for name, text in (("notes.txt", "Stiffness of the mounts, by hand\n"), ("list.csv", "a,b\n1,2\n"), ("empty", ""), ("other.json", '{"a": 1}'),
                           ("newer.json", '{"format": "modetune-study/2"}'), ("list.json", "[1]"), ("nul", "\0frequency_hz\n")):
            with self.subTest(name):
                done = self.expect(2, "info", self.write(name, text))
                self.assertEqual(done.stdout, "")
                self.assertTrue(done.stderr.startswith(f"modetune: error: {name}: not a file that modetune reads: "), done.stderr)
                for tried in ('"modetune-model/1"', '"modetune-study/1"', '"modetune-result/1"', "journal", "universal file", "(CSV)"):
                    self.assertIn(tried, done.stderr)
        self.assertRegex(self.expect(2, "info", self.write("cut.json", '{"format": "modetune-study/1", "name": ')).stderr, r"^cut.json:1:\d+: error: ")
        self.assertRegex(self.expect(2, "info", self.write("index.json", '{"format": "modetune-index/1", "studies": ')).stderr, r"^index.json:1:\d+: error: ")
        self.assertRegex(self.expect(2, "info", self.write("short.csv", "frequency_hz,real,imag\n1,2\n")).stderr, r"^short.csv:2:1: error: 2 fields")
        self.assertIn("the head of the journal is damaged", self.expect(2, "info", self.write("a.journal", "modetune-journal/1 " + "0" * 64 + "\n| {}\nx\n")).stderr)
        self.assertIn("No such file", self.expect(4, "info", "gone.json").stderr)
        # results of other things than the program's keep it on its feet
        for text in ('{"format": "modetune-index/1", "studies": [3, {"file": 4, "folder": "x", "result_sha256": 1}]}', '{"format": "modetune-index/1", "studies": 7}',
                     '{"format": "modetune-scene/1", "designs": [{"configurations": [null, {"modes": 1}]}, 2]}', '{"format": "modetune-timing/1", "study_path": 1}'):
            self.expect(0, "info", self.write("odd.json", text))
        for options in (("--set", "k1=1"), ("-c", "held")):
            self.assertIn("needs a model, and studies/two.json holds none", self.expect(2, "info", self.write("studies/two.json", study()), *options).stderr)


if __name__ == "__main__":
    main()

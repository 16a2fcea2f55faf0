# SPDX-License-Identifier: GPL-3.0-or-later
"""modes, mac, sensitivity, info and check on small models with known answers."""
import csv
import io
import json
import math

from common_cli import MASSLESS, REPEATED, CliTest, main

LOW, HIGH = 0.6972243622680054, 4.302775637731995  # omega^2 = (5 -+ sqrt 13)/2 for k1 = 3, k2 = 1
HZ = [math.sqrt(x) / (2 * math.pi) for x in (LOW, HIGH)]
TOL = 1e-12  # two unknowns, condition 6: a few units in the last place


STANDING = '''{"format": "modetune-model/1", "dimension": 2, "gravity_m_per_s2": [0, -8], "parameters": {"k": %.17g},
"bodies": [{"name": "rod", "mass_kg": 1, "inertia_kg_m2": 1, "centre": [0, 1]}],
"joints": [{"name": "pin", "type": "revolute", "bodies": ["ground", "rod"], "at": [0, 0]}],
"springs": [{"name": "k", "type": "torsion", "joint": "pin", "stiffness_n_m_per_rad": "k"}]}'''
STANDING_STUDY = '''{"format": "modetune-study/1", "model": "../problems/standing.json", "variables": [{"parameter": "k", "lower": 4, "upper": 8}],
"goals": [{"type": "frequency", "mode": 1, "target_hz": 0.2}]}'''


CASES = '''{"format": "modetune-model/1", "dimension": 2, "parameters": {"n": 3, "q": 1, "k": 4},
"bodies": [{"name": "rod", "mass_kg": 1, "inertia_kg_m2": 1, "centre": [0, 0]}], "modes": {"swing": {"configuration": "two", "index": 1}},
"joints": [{"name": "pin", "type": "revolute", "bodies": ["ground", "rod"], "at": [0, 0]}],
"springs": [{"name": "k", "type": "torsion", "joint": "pin", "stiffness_n_m_per_rad": "if(n*q >= 4, 9, k)"}], "configurations": {"two": {}, "own": {"parameters": {"n": 1}}}}'''


class Modes(CliTest):
    def test_a_value_of_set_decides_cases(self):
        path = self.write("cases.json", CASES)
        for sets, omega in ((["k=16"], 4), (["n=4"], 3), (["q=2"], 3), (["q=0.5", "n=8", "k=25"], 3), (["k=25", "n=2"], 5)):
            got = self.json_of("modes", path, "-c", "two", *(a for s in sets for a in ("--set", s)))
            self.assertAlmostEqual(2 * math.pi * got["modes"][0]["frequency_hz"], omega, delta=TOL)
            self.assertIsNone(got["modes"][0]["name"])
        self.assertIn('configuration "own" has its own value of "n"', self.expect(0, "modes", path, "--set", "n=4").stderr)
        self.assertIn("the condition of an if() depends on what varies here", self.expect(2, "sensitivity", path, "--parameters", "n").stderr)

    def test_a_parameter_may_be_called_if(self):
        """As in files of 1.0.0, which had no cases: it is one where no "(" follows."""
        path = self.write("if.json", CASES.replace('"n"', '"if"').replace("n*q", "if*q"))
        for sets, omega in ((["if=4"], 3), (["k=25", "if=2"], 5)):
            got = self.json_of("modes", path, "-c", "two", *(a for s in sets for a in ("--set", s)))
            self.assertAlmostEqual(2 * math.pi * got["modes"][0]["frequency_hz"], omega, delta=TOL)

    def test_json_of_one_configuration_is_an_object(self):
        got = self.json_of("modes", self.model, "-c", "held")
        self.assertEqual(got["configuration"], "held")
        self.assertEqual([m["index"] for m in got["modes"]], [1, 2])
        self.assertEqual([m["name"] for m in got["modes"]], ["first", None])
        self.assertEqual({m["kind"] for m in got["modes"]}, {"flexible"})
        for mode, hz, squared in zip(got["modes"], HZ, (LOW, HIGH)):
            self.assertAlmostEqual(mode["frequency_hz"] / hz, 1, delta=TOL)
            self.assertAlmostEqual(mode["omega_squared"] / squared, 1, delta=TOL)
            self.assertTrue(0 <= mode["residual"] < 10)
            self.assertTrue(0 <= mode["orthogonality"] < 10)
        self.assertEqual(got["redundant_constraints"], [])
        self.assertEqual(got["freedoms"], 2)
        self.assertIs(got["equilibrium"]["solved"], False)

    def test_json_of_all_configurations_is_a_list_in_the_file_s_order(self):
        got = self.json_of("modes", self.model)
        self.assertEqual([c["configuration"] for c in got], ["held", "twice", "free", "heavy"])
        self.assertEqual([len(c["modes"]) for c in got], [2, 2, 2, 2])
        self.assertEqual(got[1]["redundant_constraints"], [["rb", "rc"], ["rb", "rc"]])
        rigid = got[2]["modes"][0]
        self.assertEqual((rigid["kind"], rigid["index"], rigid["frequency_hz"]), ("rigid_body", None, 0))
        self.assertAlmostEqual(got[2]["modes"][1]["omega_squared"], 2, delta=TOL)
        for a, b in zip(got[0]["modes"], got[3]["modes"]):
            self.assertAlmostEqual(a["omega_squared"] / b["omega_squared"], 4, delta=4 * TOL)

    def test_set_takes_expressions_of_the_file_s_values(self):
        got = self.json_of("modes", self.model, "-c", "held", "--set", "k1=k1-1", "--set", "k2=k1/2")["modes"]
        for mode, squared in zip(got, (LOW, HIGH)):  # (2, 1.5) has the same eigenvalues as (3, 1)
            self.assertAlmostEqual(mode["omega_squared"] / squared, 1, delta=TOL)
        wrong = self.expect(2, "modes", self.model, "--set", "k1=1/0").stderr
        self.assertIn("modetune: error: --set: k1=1/0: ", wrong)

    def test_set_that_a_configuration_overrides_is_warned_about(self):
        done = self.expect(0, "modes", self.model, "-c", "heavy", "--set", "m=2")
        self.assertEqual(done.stderr, 'modetune: warning: configuration "heavy" has its own value of "m": --set '
                                      'changes nothing there\n')

    def test_every_mode_carries_its_error(self):
        for configuration in self.json_of("modes", self.model):
            self.assertEqual(configuration["undecided_modes"], 0)
            for mode in configuration["modes"]:
                self.assertLess(mode["omega_squared_error"], 1e-12)
                self.assertLess(mode["frequency_error_hz"], 1e-6 if mode["kind"] == "rigid_body" else 1e-12)
        self.assertNotIn("error [Hz]", self.expect(0, "modes", self.model).stdout)

    def test_an_error_that_shows_is_printed(self):
        # a pendulum that stands on a spring just stiffer than its weight: what is left after cancellation is known less well
        path = self.write("problems/standing.json", STANDING % (8 * (1 + 1e-9)))
        mode = self.json_of("modes", path)[0]["modes"][0]
        self.assertLess(abs(mode["omega_squared"] / 4e-9 - 1), 1e-5)
        self.assertLess(abs(mode["omega_squared"] - 4e-9), mode["omega_squared_error"])
        text = self.expect(0, "modes", path).stdout
        self.assertIn("frequency [Hz]  error [Hz]", text)

    def test_a_buckling_load_is_undecided(self):
        path = self.write("problems/standing.json", STANDING % 8)
        got = self.json_of("modes", path)[0]
        self.assertEqual((got["undecided_modes"], got["rigid_body_modes"], got["unstable_modes"]), (1, 0, 0))
        mode = got["modes"][0]
        self.assertEqual((mode["kind"], mode["index"], mode["frequency_hz"]), ("undecided", None, None))
        self.assertIn("undecided in 1 direction: springs and loads cancel", self.expect(0, "modes", path).stdout)
        sweep = self.json_of("sweep", path, "--drive", "pin=0:0.1:2", "--hold", "k", "--frequencies")
        points = (sweep[0] if isinstance(sweep, list) else sweep)["points"]
        self.assertEqual([p["undecided_modes"] for p in points], [1, 0])
        study = self.write("studies/standing.json", STANDING_STUDY)
        done = self.run_program("run", study)
        self.assertEqual(done.returncode, 1)
        self.assertIn("has a mode of which rounding hides whether it is stable, so that its modes have no index", done.stdout)
        self.assertIn("not met", done.stdout)
        self.assertIn("Goal /goals/0 (default mode 1 at 0.2 Hz) has no value here and does not count as met.", done.stdout)

    def test_the_lowest_twenty_unless_more_are_asked_for(self):
        chain = {"format": "modetune-model/1", "dimension": 2, "points": {"a": [0, 0], "b": [1, 0]},
                 "links": [{"name": "l", "kind": "beam", "from": "a", "to": "b", "elements": 12, "density_kg_per_m3": 7800, "youngs_modulus_pa": 2e11,
                            "section": {"shape": "circle", "diameter_m": 0.02}}],
                 "joints": [{"name": "wall", "type": "fixed", "bodies": ["ground", "l.start"], "at": "a"}],
                 "configurations": {"default": {}}}
        path = self.write("problems/chain.json", json.dumps(chain))
        whole = self.json_of("modes", path, "-c", "default", "--count", "all")
        self.assertGreater(len(whole["modes"]), 20)
        self.assertEqual(whole["vibration_modes"], len(whole["modes"]))
        lowest = self.json_of("modes", path, "-c", "default")
        self.assertEqual([m["index"] for m in lowest["modes"]], list(range(1, 21)))
        self.assertEqual(lowest["vibration_modes"], whole["vibration_modes"])
        for one, other in zip(lowest["modes"], whole["modes"]):
            self.assertAlmostEqual(one["frequency_hz"] / other["frequency_hz"], 1, delta=1e-10)
        told = f"The lowest 20 of {whole['vibration_modes']} vibration modes; --count N or all: more."
        self.assertIn(told, self.expect(0, "modes", path).stdout)
        for count in ("20", "all"):  # who asks for a number knows that there may be more
            self.assertNotIn("--count", self.expect(0, "modes", path, "--count", count).stdout)
        self.assertNotIn("--count", self.expect(0, "modes", self.model).stdout)

    def test_count_counts_vibration_modes(self):
        got = self.json_of("modes", self.model, "-c", "free", "--count", "1")["modes"]
        self.assertEqual([m["kind"] for m in got], ["rigid_body", "flexible"])
        self.assertEqual(len(self.json_of("modes", self.model, "-c", "held", "--count", "1")["modes"]), 1)

    def test_shapes_are_mass_normalised_sensor_values(self):
        got = self.json_of("modes", self.model, "-c", "held", "--shapes")["modes"]
        for mode in got:
            self.assertEqual(list(mode["shape"]), ["a.x", "b.x"])
            self.assertAlmostEqual(sum(v * v for v in mode["shape"].values()), 1, delta=TOL)
        ratio = got[0]["shape"]["b.x"] / got[0]["shape"]["a.x"]
        self.assertAlmostEqual(ratio, 4 - LOW, delta=10 * TOL)  # row of a: (k1 + k2 - omega^2) a = k2 b

    def test_shapes_without_sensors_are_body_motions(self):
        path = self.write("problems/repeated.json", REPEATED)
        got = self.json_of("modes", path, "--shapes")[0]["modes"]
        self.assertEqual(list(got[0]["shape"]), ["p.x", "p.y"])
        self.assertIn("Modes 1 to 2 are repeated", self.expect(0, "modes", path).stdout)
        self.assertIn("body", self.expect(0, "modes", path, "--shapes").stdout)

    def test_csv_reads_back(self):
        text = self.expect(0, "modes", self.model, "--shapes", "--format", "csv").stdout
        rows = list(csv.DictReader(io.StringIO(text)))
        self.assertEqual(len(rows), 8)
        self.assertEqual(float(rows[0]["frequency_hz"]), self.json_of("modes", self.model)[0]["modes"][0]["frequency_hz"])
        self.assertEqual((rows[4]["configuration"], rows[4]["index"], rows[4]["kind"]), ("free", "", "rigid_body"))

    def test_text_is_aligned_and_says_what_is_special(self):
        text = self.expect(0, "modes", self.model).stdout
        self.assertIn("  mode  kind      frequency [Hz]  name   residual  orthogonality\n"
                      "  ----  --------  --------------  -----  --------  -------------\n"
                      "     1  flexible        0.132894  first ", text)
        self.assertIn('free\n  note: 1 free motion: is a joint missing? Free to move: "a" (along x), "b" (along x)\n  mode ', text)
        self.assertIn('twice\n  note: redundant: 2 equations of "rb", "rc" change nothing\n  mode ', text)
        self.assertFalse([line for line in text.splitlines() if line.endswith(" ")])

    def test_a_numerical_failure_is_3_and_names_its_place(self):
        path = self.write("problems/massless.json", MASSLESS)
        done = self.expect(3, "modes", path)
        self.assertIn(f"modetune: error: {path}: configuration ", done.stderr)
        self.assertIn("ghost", done.stderr)

    def test_the_locale_changes_nothing(self):
        plain = self.expect(0, "modes", self.model, "--format", "json", env={"LC_ALL": "C"}).stdout
        for name in ("de_DE.UTF-8", "tr_TR.UTF-8", "C.UTF-8", "nonsense"):
            self.assertEqual(self.expect(0, "modes", self.model, "--format", "json", env={"LC_ALL": name}).stdout, plain)


class Mac(CliTest):
    def test_a_configuration_against_itself_is_the_identity(self):
        got = self.json_of("mac", f"{self.model}:held", f"{self.model}:heavy")
        self.assertEqual([(p["a"], p["b"]) for p in got["pairs"]], [(1, 1), (2, 2)])
        for pair, hz in zip(got["pairs"], HZ):
            self.assertAlmostEqual(pair["mac"], 1, delta=TOL)
            self.assertAlmostEqual(pair["frequency_a_hz"] / hz, 1, delta=TOL)
            self.assertAlmostEqual(pair["frequency_b_hz"] / hz, 0.5, delta=TOL)
        for i in range(2):
            for j in range(2):
                self.assertAlmostEqual(got["matrix"][i][j], float(i == j), delta=TOL)
        self.assertEqual(got["channels"], ["a.x", "b.x"])
        self.assertEqual(got["notes"], [])

    def test_too_few_sensors_are_said(self):
        text = (self.folder / self.model).read_text(encoding="utf-8").replace(
            ', { "name": "b", "on": "b", "directions": ["x"] }', "")
        one = self.write("problems/one.json", text)
        got = self.json_of("mac", f"{one}:held", f"{self.model}:held", "--count", "2")
        self.assertIn("1 sensor channels cannot tell 2 modes apart: shapes beyond 1 depend on each other there",
                      got["notes"])
        self.assertIn("modes 1 and 2 of A look the same at the sensors (MAC 1.0000)", got["notes"])
        self.assertEqual(len(self.json_of("mac", f"{one}:held", f"{one}:held")["pairs"]), 1)
        self.assertEqual(got["vibration_modes"], [2, 2])
        text = self.expect(0, "mac", f"{one}:held", f"{self.model}:held").stdout
        self.assertEqual(text.splitlines()[:2], [f"A: {one}, held, the lowest 1 of 2 vibration modes",
                                                 f"B: {self.model}, held, the lowest 1 of 2 vibration modes"])
        text = self.expect(0, "mac", f"{one}:held", f"{self.model}:held", "--count", "all").stdout
        self.assertEqual(text.splitlines()[0], f"A: {one}, held, all 2 vibration modes")

    def test_no_common_sensor_is_an_error(self):
        path = self.write("problems/repeated.json", REPEATED)
        self.assertIn("no sensor and direction in common", self.expect(2, "mac", path, f"{self.model}:held").stderr)

    def test_repeated_modes_are_compared_as_a_space(self):
        text = REPEATED.rstrip()[:-1] + ', "sensors": [ { "name": "p", "on": "p", "directions": ["x", "y"] } ] }'
        path = self.write("problems/repeated.json", text)
        got = self.json_of("mac", path, path)
        self.assertEqual((got["subspaces"][0]["first_a"], got["subspaces"][0]["modes"]), (1, 2))
        for value in got["subspaces"][0]["mac"]:
            self.assertAlmostEqual(value, 1, delta=TOL)
        self.assertIn("Repeated modes 1 to 2 of A as a space: MAC 1.00000 1.00000", self.expect(0, "mac", path, path).stdout)


class Sensitivity(CliTest):
    def entries(self, *args):
        got = self.json_of("sensitivity", self.model, "-c", "held", *args)
        return [{e["parameter"]: e for e in m["sensitivities"]} for m in got["modes"]]

    def test_values_are_the_derivatives(self):
        modes = self.entries()
        self.assertEqual(list(modes[0]), ["k1", "k2", "m"])  # "both" is made of others
        for mode, squared, hz in zip(modes, (LOW, HIGH), HZ):
            # implicit differentiation of omega^4 - (k1 + 2 k2) omega^2 + k1 k2 = 0
            slope = 2 * squared - 5
            for name, d in (("k1", (squared - 1) / slope), ("k2", (2 * squared - 3) / slope)):
                want = d / (8 * math.pi ** 2 * hz)
                self.assertAlmostEqual(mode[name]["hz_per_unit"] / want, 1, delta=100 * TOL)
            self.assertAlmostEqual(mode["m"]["hz_per_percent"] / (-0.005 * hz), 1, delta=100 * TOL)
            self.assertAlmostEqual(mode["k1"]["hz_per_percent"] / (0.03 * mode["k1"]["hz_per_unit"]), 1, delta=TOL)
            # Euler: frequencies are of degree 1/2 in the stiffnesses
            total = mode["k1"]["hz_per_percent"] + mode["k2"]["hz_per_percent"]
            self.assertAlmostEqual(total / (0.005 * hz), 1, delta=100 * TOL)

    def test_a_parameter_made_of_others_does_not_stop_them(self):
        with_both = self.entries("--parameters", "k1,both")
        alone = self.entries("--parameters", "k1")
        self.assertEqual(with_both[0]["k1"], alone[0]["k1"])
        self.assertEqual(with_both[0]["both"]["hz_per_unit"], 0)

    def test_without_parameters_there_is_nothing_to_vary(self):
        model = self.write("problems/fixed.json", REPEATED.replace('"parameters": { "kx": 100, "ky": 100 },', "").replace('"kx"', "100").replace('"ky"', "100"))
        self.assertIn("there are no parameters to vary", self.expect(2, "sensitivity", model).stderr)

    def test_overridden_parameters_have_no_influence(self):
        got = self.json_of("sensitivity", self.model, "-c", "heavy", "--parameters", "m")
        self.assertEqual(got["modes"][0]["sensitivities"][0]["value"], 4)
        self.assertEqual(got["modes"][0]["sensitivities"][0]["hz_per_percent"], 0)
        self.assertIn("value of this configuration's own", self.expect(0, "sensitivity", self.model, "-c", "heavy").stdout)

    def test_repeated_modes_have_directional_values(self):
        path = self.write("problems/repeated.json", REPEATED)
        got = self.json_of("sensitivity", path)[0]["modes"]
        self.assertEqual([m["repeated"] for m in got], [True, True])
        values = [m["sensitivities"][0]["hz_per_percent"] for m in got]
        hz = 10 / (2 * math.pi)  # kx moves one direction by 0.5 % of f, the other not at all
        self.assertAlmostEqual(values[0], 0, delta=hz * TOL)
        self.assertAlmostEqual(values[1] / (0.005 * hz), 1, delta=100 * TOL)
        self.assertIn("* Repeated modes: none of them has a derivative of its own", self.expect(0, "sensitivity", path).stdout)

    def test_set_moves_the_point_of_expansion(self):
        got = self.entries("--set", "k1=2", "--set", "k2=1.5")
        self.assertEqual(got[0]["k1"]["value"], 2)
        self.assertNotAlmostEqual(got[0]["k1"]["hz_per_unit"], self.entries()[0]["k1"]["hz_per_unit"], delta=1e-4)

    def test_csv_has_one_row_per_mode_and_parameter(self):
        text = self.expect(0, "sensitivity", self.model, "--format", "csv").stdout
        self.assertEqual(len(list(csv.DictReader(io.StringIO(text)))), (2 + 2 + 1 + 2) * 3)


class Info(CliTest):
    def test_mass_centre_inertia_and_mobility(self):
        got = self.json_of("info", self.model)
        held, twice = got[0], got[1]
        self.assertEqual((held["mass_kg"], held["centre_m"]), (2, [1.5, 0]))
        self.assertAlmostEqual(held["inertia_kg_m2"]["zz"], 2.5, delta=TOL)  # 1 + 1 + 2 * 0.5^2
        self.assertEqual((held["states"], held["equations"], held["freedoms"]), (6, 4, 2))
        self.assertEqual((twice["equations"], twice["freedoms"], twice["redundant_equations"]), (6, 2, 2))
        self.assertEqual(twice["redundant_constraints"], [["rb", "rc"], ["rb", "rc"]])
        self.assertEqual(got[3]["mass_kg"], 8)

    def test_text_and_csv(self):
        text = self.expect(0, "info", self.model, "-c", "twice").stdout
        self.assertIn("  mobility    2 freedoms = 6 states - 4 independent of 6 equations\n", text)
        rows = list(csv.DictReader(io.StringIO(self.expect(0, "info", self.model, "--format", "csv").stdout)))
        self.assertEqual([r["mass_kg"] for r in rows], ["2", "2", "2", "8"])


# What there is to know of the model before any number.
FACTS = ('problems/model.json: note: twice: redundant: 2 equations of "rb", "rc" change nothing\n'
         'problems/model.json: note: free: 1 free motion: is a joint missing? Free to move: "a" (along x), "b" (along x)\n')


class Check(CliTest):
    def test_good_files_are_ok(self):
        done = self.expect(0, "check", self.model)
        self.assertEqual((done.stdout, done.stderr), (f"{self.model}: ok (model)\n", FACTS))

    def test_every_problem_of_every_file_is_told(self):
        bad = self.write("bad.json", '{ "format": "modetune-modl/1" }\n')
        none = self.write("none.json", "[1, 2]\n")
        broken = self.write("broken.json", '{ "format": }\n')
        done = self.expect(2, "check", bad, self.model, none, broken)
        self.assertEqual(done.stdout, f"{self.model}: ok (model)\n")
        lines = done.stderr.splitlines()
        self.assertEqual(lines[0], 'bad.json:1:13: error: /format: must be one of "modetune-model/1", "modetune-study/1", '
                                   '"modetune-result/1", "modetune-aircraft/1", "modetune-profile/1"; did you mean "modetune-model/1"?')
        self.assertEqual("\n".join(lines[1:3]) + "\n", FACTS)
        self.assertEqual(lines[3], 'none.json:1:1: error: must be an object with a member "format"')
        self.assertTrue(lines[4].startswith("broken.json:1:13: error: "), lines[4])

    def test_a_missing_file_is_4_and_the_worst_counts(self):
        bad = self.write("bad.json", "{}")
        done = self.expect(4, "check", bad, "nowhere.json", self.model)
        self.assertIn("modetune: error: nowhere.json: ", done.stderr)
        self.assertIn("bad.json:1:1: error: member \"format\" is missing", done.stderr)

    def test_json_says_the_same(self):
        bad = self.write("bad.json", "{}")
        got = self.json_of("check", self.model, bad, code=2)
        self.assertEqual([(g["file"], g["kind"], g["ok"]) for g in got],
                         [(self.model, "model", True), (bad, None, False)])
        self.assertEqual({p["severity"] for p in got[0]["problems"]}, {"note"})
        (problem,) = got[1]["problems"]
        self.assertTrue(problem.pop("message").startswith('member "format" is missing: one of '))
        self.assertEqual(problem, {"severity": "error", "file": bad, "line": 1, "column": 1, "pointer": ""})
        gone = self.json_of("check", "gone.json", code=4)[0]["problems"]
        self.assertEqual([(p["line"], p["column"], p["pointer"]) for p in gone], [(None, None, None)])

    def test_csv_says_the_same(self):
        bad = self.write("bad.json", "{}")
        done = self.expect(2, "check", self.model, bad, "--format", "csv")
        self.assertEqual(list(csv.reader(io.StringIO(done.stdout))),
                         [["file", "kind", "ok"], [self.model, "model", "true"], [bad, "", "false"]])

    def test_a_format_that_is_none_is_told(self):
        for name, said in (("other.json", '{ "format": "xyzzy" }'), ("number.json", '{ "format": 1 }')):
            with self.subTest(name):
                done = self.expect(2, "check", self.write(name, said))
                self.assertEqual(done.stderr, f'{name}:1:13: error: /format: must be one of "modetune-model/1", "modetune-study/1", '
                                 '"modetune-result/1", "modetune-aircraft/1", "modetune-profile/1"\n')


if __name__ == "__main__":
    main()

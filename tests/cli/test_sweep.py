# SPDX-License-Identifier: GPL-3.0-or-later
"""sweep and modes --damped on mechanisms with closed forms."""
import csv
import io
import json
import math

from common_cli import SOURCE, CliTest, main

# Crank 0.1 m drawn at 60 degrees, rod 0.3 m, slider along x.
SLIDER_CRANK = """{ "format": "modetune-model/1", "name": "Slider-crank", "dimension": 2,
  "parameters": { "r": 0.1, "l": 0.3, "turn": "2*pi" },
  "points": { "B": ["r*cos(pi/3)", "r*sin(pi/3)"], "C": ["r*cos(pi/3)+sqrt(l^2-(r*sin(pi/3))^2)", 0] },
  "bodies": [ { "name": "crank", "mass_kg": 1, "inertia_kg_m2": 1e-3, "centre": [0, 0] },
              { "name": "rod", "mass_kg": 1, "inertia_kg_m2": 1e-2, "centre": "B" },
              { "name": "piston", "mass_kg": 1, "inertia_kg_m2": 1e-3, "centre": "C" } ],
  "joints": [ { "name": "shaft", "type": "revolute", "bodies": ["ground", "crank"], "at": [0, 0] },
              { "name": "big_end", "type": "revolute", "bodies": ["crank", "rod"], "at": "B" },
              { "name": "small_end", "type": "revolute", "bodies": ["rod", "piston"], "at": "C" },
              { "name": "bore", "type": "prismatic", "bodies": ["ground", "piston"], "at": "C", "axis": [1, 0] } ] }
"""
# 2 kg on 50 N/m with a damper c, and a second one without a spring.
DAMPED = """{ "format": "modetune-model/1", "name": "Damped", "dimension": 2, "parameters": { "c": 3 },
  "bodies": [ { "name": "a", "mass_kg": 2, "inertia_kg_m2": 1, "centre": [1, 0] }, { "name": "b", "mass_kg": 1, "inertia_kg_m2": 1, "centre": [2, 0] } ],
  "joints": [ { "name": "ja", "type": "prismatic", "bodies": ["ground", "a"], "at": [1, 0], "axis": [1, 0] },
              { "name": "jb", "type": "prismatic", "bodies": ["ground", "b"], "at": [2, 0], "axis": [1, 0] } ],
  "springs": [ { "name": "s", "type": "axial", "bodies": ["ground", "a"], "at": [[0, 0], [1, 0]], "stiffness_n_per_m": 50 } ],
  "dampers": [ { "name": "d", "type": "axial", "bodies": ["ground", "a"], "at": [[0, 0], [1, 0]], "damping_n_s_per_m": "c" } ] }
"""
TOL = 1e-11


class Sweep(CliTest):
    def setUp(self):
        super().setUp()
        self.slider = self.write("problems/slider.json", SLIDER_CRANK)
        self.rod = self.write("problems/rod.json", (SOURCE / "tests/models/driven_rod.json").read_text(encoding="utf-8"))

    def test_json_follows_the_closed_form_over_a_whole_turn(self):
        got = self.json_of("sweep", self.slider, "--drive", "shaft=-pi:turn:31")[0]
        self.assertEqual((got["joint"], got["hold"], got["spring"]), ("shaft", "lock", None))
        self.assertEqual(len(got["points"]), 31)
        drawn = 0.05 + math.sqrt(0.09 - 0.0075)
        for point in got["points"]:
            joints = {j["name"]: j for j in point["joints"]}
            angle = math.pi / 3 + point["position_rad"]
            root = math.sqrt(0.09 - 0.01 * math.sin(angle) ** 2)
            self.assertAlmostEqual(joints["shaft"]["coordinate_rad"], point["position_rad"], delta=TOL)
            self.assertAlmostEqual(joints["bore"]["coordinate_m"], 0.1 * math.cos(angle) + root - drawn, delta=TOL)
            self.assertAlmostEqual(joints["bore"]["ratio"], -0.1 * math.sin(angle) * (1 + 0.1 * math.cos(angle) / root),
                                   delta=TOL)
            self.assertLess(point["gap_m"], 1e-12)
        self.assertEqual(got["points"][0]["position_rad"], -math.pi)
        self.assertEqual(got["points"][-1]["position_rad"], 2 * math.pi)

    def test_positions_end_at_a_thousand_radians_or_lengths(self):
        for words, said in ((("shaft=0:1e12:3",), r"shaft goes to 5e\+11 rad, and at most to 1000 rad"),
                            (("shaft=-1e308:1e308:3", "--frequencies"), r"shaft goes to -1e\+308 rad, and at most to 1000 rad"),
                            (("bore=1e6:1e7:2",), r"bore goes to 1e\+06 m, and at most to \d+(\.\d+)? m")):
            done = self.expect(2, "sweep", self.slider, "--drive", *words)
            self.assertRegex(done.stderr, f"error: --drive: {said} from the reference position\n$")
        far = self.json_of("sweep", self.slider, "--drive", "shaft=0:100*2*pi:2")[0]["points"][1]
        bore = {j["name"]: j for j in far["joints"]}["bore"]["coordinate_m"]
        self.assertAlmostEqual(bore, 0.0, delta=1e-10)  # after a hundred turns it is where it was

    def test_a_walk_of_too_many_steps_ends(self):
        fast = SLIDER_CRANK[:SLIDER_CRANK.index('"bodies"')] + """
          "bodies": [ { "name": "slow", "mass_kg": 1, "inertia_kg_m2": 1, "centre": [0, 0] }, { "name": "fast", "mass_kg": 1, "inertia_kg_m2": 1, "centre": [1, 0] } ],
          "joints": [ { "name": "a", "type": "revolute", "bodies": ["ground", "slow"], "at": [0, 0] },
                      { "name": "b", "type": "revolute", "bodies": ["ground", "fast"], "at": [1, 0] },
                      { "name": "g", "type": "gear", "joints": ["a", "b"], "ratio": 1e7 } ] }"""
        done = self.expect(3, "sweep", self.write("problems/fast.json", fast), "--drive", "a=0:1:2")
        self.assertRegex(done.stderr, r'joint "a" reached 0\.\d+ rad in 20000 steps, not 1 rad: other parts would have to move too far')

    def test_a_limit_position_is_named_and_the_rest_printed(self):
        args = ("sweep", self.slider, "-c", "default", "--drive", "bore=-0.1:0.1:21")
        done = self.expect(3, *args)
        self.assertRegex(done.stderr, r'^modetune: error: .*: configuration "default": joint "bore" cannot be driven beyond '
                                      r'0\.06277\d+ m: limit position, where joint "\w+" moves without it \(.* just before\)\n$')
        self.assertIn("  17 of 21 positions reached.\n", done.stdout)
        points = json.loads(self.expect(3, *args, "--format", "json").stdout)["points"]
        self.assertEqual([("error" in p) for p in points], [False] * 17 + [True] * 4)
        rows = list(csv.DictReader(io.StringIO(self.expect(3, *args, "--format", "csv").stdout)))
        self.assertEqual(len(rows), 21)
        self.assertEqual((rows[20]["position_m"], rows[20]["shaft_rad"]), ("0.10000000000000001", ""))
        self.assertEqual(float(rows[3]["shaft_ratio_rad_per_m"]),
                         next(j["ratio"] for j in points[3]["joints"] if j["name"] == "shaft"))

    def test_frequencies_locked_and_trimmed(self):
        lock = self.json_of("sweep", self.rod, "-c", "sprung", "--drive", "pivot=0:30*deg:3", "--frequencies")
        for point in lock["points"]:
            self.assertEqual(len(point["frequencies_hz"]), 1)
            self.assertAlmostEqual(point["frequencies_hz"][0] / (math.sqrt(3 / 0.004) / (2 * math.pi)), 1, delta=TOL)
            weight = 1.5 * 9.81 * 0.8 * math.sin(point["position_rad"])
            self.assertAlmostEqual(point["hold_n_m"], weight + 40 * point["position_rad"], delta=1e-9)
        trim = self.json_of("sweep", self.rod, "-c", "sprung", "--drive", "pivot=0:30*deg:3", "--frequencies", "--hold", "servo")
        self.assertEqual((trim["hold"], trim["spring"]), ("trim", "servo"))
        want = self.json_of("modes", self.rod, "-c", "trimmed")["modes"]
        for got, mode in zip(trim["points"][2]["frequencies_hz"], want):
            self.assertAlmostEqual(got / mode["frequency_hz"], 1, delta=TOL)
        some = self.json_of("sweep", self.rod, "-c", "sprung", "--drive", "pivot=0:1:2", "--frequencies", "--hold", "servo",
                            "--count", "1")
        self.assertEqual([len(p["frequencies_hz"]) for p in some["points"]], [1, 1])

    def test_text_has_units_and_set_is_obeyed(self):
        text = self.expect(0, "sweep", self.rod, "-c", "sprung", "--drive", "pivot=0:angle:3", "--set", "angle=1",
                           "--frequencies").stdout
        self.assertRegex(text, r"  pivot \[rad\] +axle \[rad\] +per pivot +lock \[N m\] +mode 1 \[Hz\]\n")
        self.assertIn("\n     1.00000 ", text)
        nothing = self.expect(0, "sweep", self.slider, "--drive", "shaft=0:1:2", "--frequencies").stdout
        self.assertIn("No vibration modes", nothing)

    def test_wrong_use(self):
        def wrong(want, *args):
            with self.subTest(args):
                done = self.expect(2, "sweep", self.rod, "-c", "sprung", *args)
                self.assertEqual(done.stderr.splitlines()[0], f"modetune: error: {want}")
        wrong('"sweep" needs --drive JOINT=FROM:TO:N')
        for text in ("pivot", "pivot=0:1", "=0:1:2", "pivot=0:1:2:3"):
            wrong(f'--drive: "{text}" is not JOINT=FROM:TO:N', "--drive", text)
        wrong('--drive: the number of positions, "1", is not a whole number from 2 to 100001', "--drive", "pivot=0:1:1")
        wrong('--drive: the number of positions, "x", is not a whole number from 2 to 100001', "--drive", "pivot=0:1:x")
        wrong('problems/rod.json: drive: there is no joint "pivo" in configuration "sprung"; did you mean "pivot"?', "--drive", "pivo=0:1:2")
        wrong('problems/rod.json: drive: there is no spring "motor" to hold it in configuration "sprung"', "--drive", "pivot=0:1:2",
              "--hold", "motor")

        for n in ("", "0", "-3", "3x", "100002", "9" * 30):
            wrong(f'--drive: the number of positions, "{n}", is not a whole number from 2 to 100001', "--drive", f"pivot=0:1:{n}")
        wrong('--drive: bogus: at character 1: unknown name "bogus"', "--drive", "pivot=0:bogus:2")
        wrong('--drive: 1/: at character 3: the expression ends where a number, a name or "(" is expected', "--drive", "pivot=1/:1:2")

    def test_csv_holds_every_configuration_with_the_same_joints(self):
        args = ("sweep", self.rod, "--drive", "pivot=0:0.5:2", "--frequencies")
        rows = list(csv.DictReader(io.StringIO(self.expect(0, *args, "--format", "csv").stdout)))
        want = self.json_of(*args)
        self.assertEqual([r["configuration"] for r in rows], ["sprung"] * 2 + ["locked"] * 2 + ["trimmed"] * 2)
        points = [p for c in want for p in c["points"]]
        for row, point in zip(rows, points, strict=True):
            self.assertEqual(float(row["position_rad"]), point["position_rad"])
            self.assertEqual(float(row["hold_n_m"]), point["hold_n_m"])
            self.assertEqual(float(row["mode_1_hz"]), point["frequencies_hz"][0])

    def test_csv_with_other_joints_is_refused(self):
        two = DAMPED.replace('"centre": [2, 0] }', '"centre": [2, 0], "in": ["two"] }').replace(
            '"at": [2, 0], "axis": [1, 0] } ],', '"at": [2, 0], "axis": [1, 0], "in": ["two"] } ],\n'
            '  "configurations": { "one": {}, "two": {} },')
        model = self.write("problems/two.json", two)
        done = self.expect(2, "sweep", model, "--drive", "ja=0:0.1:2", "--format", "csv")
        self.assertIn("configurations with different joints do not fit into one CSV table: choose one with -c", done.stderr)
        one = self.expect(0, "sweep", model, "--drive", "ja=0:0.1:2", "--format", "csv", "-c", "two").stdout
        self.assertEqual(one.splitlines()[0], "configuration,position_m,jb_m,jb_ratio,hold_n,equilibrium_residual,gap_m")
        text = self.expect(0, "sweep", model, "--drive", "ja=0:0.1:2").stdout
        self.assertRegex(text, r"one\n +ja \[m\] +lock \[N\]\n")
        self.assertRegex(text, r"two\n +ja \[m\] +jb \[m\] +per ja +lock \[N\]\n")

    def test_free_and_unstable_positions_are_said(self):
        free = self.write("problems/free.json", DAMPED)
        text = self.expect(0, "sweep", free, "--drive", "ja=0:0.1:2", "--frequencies").stdout
        self.assertIn("  1 rigid-body mode: it can move freely.\n", text)
        rod = ("sweep", self.rod, "-c", "sprung", "--frequencies", "--set", "k_d=-1", "--drive")
        self.assertIn("  UNSTABLE at 3 positions: they do not hold.\n", self.expect(0, *rod, "pivot=0:0.5:3").stdout)
        self.assertIn("  UNSTABLE at 1 position: it does not hold.\n", self.expect(0, *rod, "pivot=0:0:1").stdout)
        rows = list(csv.DictReader(io.StringIO(self.expect(0, *rod, "pivot=0:0.5:3", "--format", "csv").stdout)))
        self.assertEqual([r["mode_1_hz"] for r in rows], ["", "", ""])

    def test_one_point_is_a_range(self):
        got = self.json_of("sweep", self.slider, "-c", "default", "--drive", "shaft=0.5:0.5:1")
        self.assertEqual([p["position_rad"] for p in got["points"]], [0.5])


class Damped(CliTest):
    def setUp(self):
        super().setUp()
        self.model = self.write("problems/damped.json", DAMPED)

    def test_oscillating_mode_and_rigid_body(self):
        got = self.json_of("modes", self.model, "-c", "default", "--damped")
        rigid, mode = got["damped_modes"]
        self.assertEqual((rigid["kind"], rigid["index"], rigid["natural_frequency_hz"]), ("rigid_body", None, 0))
        self.assertIsNone(rigid["damping_ratio_percent"])
        zeta = 3 / (2 * 2 * 5)
        self.assertEqual((mode["kind"], mode["index"]), ("oscillating", 1))
        self.assertAlmostEqual(mode["natural_frequency_hz"], 5 / (2 * math.pi), delta=TOL)
        self.assertAlmostEqual(mode["damped_frequency_hz"], 5 * math.sqrt(1 - zeta ** 2) / (2 * math.pi), delta=TOL)
        self.assertAlmostEqual(mode["damping_ratio_percent"], 100 * zeta, delta=TOL)
        self.assertAlmostEqual(mode["decay_per_s"], 0.75, delta=TOL)
        self.assertLess(mode["residual"], 10)
        self.assertNotIn("damped_modes", self.json_of("modes", self.model, "-c", "default"))

    def test_overdamped_roots_are_said(self):
        text = self.expect(0, "modes", self.model, "-c", "default", "--damped", "--set", "c=25").stdout
        self.assertRegex(text, r"damped mode +kind +natural \[Hz\] +damping ratio \[%\] +decay \[1/s\]")
        self.assertIn("2 real roots: they decay without oscillation.", text)
        rows = list(csv.DictReader(io.StringIO(self.expect(0, "modes", self.model, "--damped", "--set", "c=25",
                                                           "--format", "csv").stdout)))
        self.assertEqual([r["kind"] for r in rows], ["rigid_body", "overdamped", "overdamped"])
        self.assertAlmostEqual(float(rows[1]["decay_per_s"]), 2.5, delta=TOL)
        self.assertAlmostEqual(float(rows[2]["decay_per_s"]), 10, delta=TOL)
        self.assertEqual(rows[1]["damped_frequency_hz"], "")

    def test_count_counts_oscillating_modes(self):
        # a second spring makes two oscillating modes, k/m = 25 and 100: --count 1 keeps the first, and what has no index
        model = self.write("problems/two_springs.json", DAMPED.replace('"springs": [ ', '"springs": [ { "name": "t", "type": "axial", '
                           '"bodies": ["ground", "b"], "at": [[0, 0], [2, 0]], "stiffness_n_per_m": 100 }, '))
        for form in ("json", "csv", "text"):
            with self.subTest(form):
                one, two = (self.expect(0, "modes", model, "--damped", "--format", form, *more).stdout
                            for more in (("--count", "1"), ("--count", "2")))
                if form == "json":
                    one, two = (json.loads(text)[0]["damped_modes"] for text in (one, two))
                    self.assertEqual([m["index"] for m in one], [1])
                    self.assertEqual([m["index"] for m in two], [1, 2])
                    self.assertAlmostEqual(two[1]["natural_frequency_hz"], 10 / (2 * math.pi), delta=TOL)
                elif form == "csv":
                    one, two = ([r["index"] for r in csv.DictReader(io.StringIO(text))] for text in (one, two))
                    self.assertEqual((one, two), (["1"], ["1", "2"]))
                else:
                    self.assertEqual([text.count("oscillating") for text in (one, two)], [1, 2])


if __name__ == "__main__":
    main()

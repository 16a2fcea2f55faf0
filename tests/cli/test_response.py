# SPDX-License-Identifier: GPL-3.0-or-later
"""response: against SciPy, closed forms, and what it says where there is no value."""
import csv
import io
import json
import math

import numpy
from scipy import signal
from scipy.io import mmread

from common_cli import CliTest, main
from common_shaken import chain

# 2 kg on 200 N/m and a damper c, along x.
ONE = """{ "format": "modetune-model/1", "name": "One", "dimension": 2, "parameters": { "m": 2, "k": 200, "c": 0.4 },
  "bodies": [ { "name": "a", "mass_kg": "m", "inertia_kg_m2": 1, "centre": [1, 0] } ],
  "joints": [ { "name": "j", "type": "prismatic", "bodies": ["ground", "a"], "at": [1, 0], "axis": [1, 0] } ],
  "springs": [ { "name": "s", "type": "axial", "bodies": ["ground", "a"], "at": [[0, 0], [1, 0]], "stiffness_n_per_m": "k" } ],
  "dampers": [ { "name": "d", "type": "axial", "bodies": ["ground", "a"], "at": [[0, 0], [1, 0]], "damping_n_s_per_m": "c" } ],
  "sensors": [ { "name": "a", "on": "a", "directions": ["x"] } ] }
"""


class Response(CliTest):
    def setUp(self):
        super().setUp()
        self.one = self.write("problems/one.json", ONE)

    def test_scipy_and_the_states_give_the_same(self):
        for seed, n in ((1, 2), (2, 5), (3, 9)):
            model, m, c, k = chain(seed, n)
            path = self.write("problems/chain.json", json.dumps(model))
            inverse = numpy.linalg.inv(m)
            a = numpy.block([[numpy.zeros((n, n)), numpy.eye(n)], [-inverse @ k, -inverse @ c]])
            b = numpy.vstack([numpy.zeros((n, 1)), inverse[:, [0]]])
            wanted = numpy.hstack([numpy.eye(n), numpy.zeros((n, n))])
            for way in ([], ["--direct"]):
                got = self.json_of("response", path, "-c", "default", "--input", "b0.x", "--from", "0.5", "--to", "40", "--points", "30", *way)
                hz = numpy.array(got["frequencies_hz"])
                self.assertTrue(got["coupled"])
                for o in range(n):
                    s = 2j * math.pi * hz
                    want = numpy.array([(wanted[o] @ numpy.linalg.solve(x * numpy.eye(2 * n) - a, b))[0] for x in s])
                    if n < 3:  # it goes by polynomials, which lose digits
                        _, other = signal.freqresp(signal.StateSpace(a, b, wanted[[o]], numpy.zeros((1, 1))), 2 * math.pi * hz)
                        self.assertLess(numpy.max(numpy.abs(other - want)), 1e-10 * numpy.max(numpy.abs(want)))
                    entry = got["responses"][o]
                    h = numpy.array(entry["re"]) + 1j * numpy.array(entry["im"])
                    self.assertLess(numpy.max(numpy.abs(h - want)) / numpy.max(numpy.abs(want)), 1e-10)
                    self.assertEqual((entry["input"], entry["output"], entry["unit"]), ("b0.x", f"b{o}.x:displacement", "m per N"))
                    self.assertTrue(numpy.all(numpy.array(entry["error"]) < 1e-9 * numpy.max(numpy.abs(want))))

    def test_what_grows_by_itself_has_no_response(self):
        """By one function, whichever damper has the wrong sign; a passive system never grows, however small its damping beside its stiffest mode."""
        for c in (-0.4, -1e-6, -60):
            rate = -c / 4 if abs(c) < 40 else (-c + math.sqrt(c * c - 1600)) / 4
            for more in ((), ("--direct",), ("--sensitivity", "k"), ("--vibration", "white")):
                port = ("--input", "base.x") if more[:1] == ("--vibration",) else ("--input", "a.x")
                said = self.expect(3, "response", self.one, *port, "--set", f"c={c}", *more).stderr
                self.assertIn("so there is no steady response", said)
                self.assertAlmostEqual(float(said.split("exp(")[1].split(" t/s")[0]) / rate, 1, delta=2e-6)
            self.assertIn("unstable", self.expect(0, "modes", self.one, "--damped", "--set", f"c={c}").stdout)
        self.expect(0, "response", self.one, "--input", "a.x", "--set", "c=0")
        for seed in range(1, 9):  # one weak damper, springs over twelve decades
            model, *_ = chain(seed, 6)
            for i, spring in enumerate(model["springs"]):
                spring["stiffness_n_per_m"] = 10.0 ** (12 - 2.4 * i)
            for i, damper in enumerate(model["dampers"]):
                damper["damping_n_s_per_m"] = 1e-3 if i == seed % 6 else 0
            path = self.write("problems/chain.json", json.dumps(model))
            self.expect(0, "response", path, "-c", "default", "--input", "b0.x")
            self.assertNotIn("unstable", self.expect(0, "modes", path, "-c", "default", "--damped").stdout)

    def test_peak_and_its_sensitivities_have_closed_forms(self):
        got = self.json_of("response", self.one, "-c", "default", "--input", "a.x", "--sensitivity", "m,k,c")
        peak, = got["responses"][0]["extremes"]
        zeta = 0.4 / (2 * math.sqrt(400))
        top = 1 / (2 * 200 * zeta * math.sqrt(1 - zeta ** 2))
        self.assertEqual(peak["kind"], "peak")
        self.assertAlmostEqual(peak["frequency_hz"], 10 * math.sqrt(1 - 2 * zeta ** 2) / (2 * math.pi), delta=1e-9)
        self.assertAlmostEqual(peak["magnitude"], top, delta=1e-12 * top)
        for entry, name in zip(peak["sensitivities"], "mkc"):
            def height(m=2, k=200, c=0.4):
                z = c / (2 * math.sqrt(k * m))
                return 1 / (2 * k * z * math.sqrt(1 - z ** 2))
            value = entry["value"]
            step = 1e-4 * value
            slope = (height(**{name: value + step}) - height(**{name: value - step})) / (2 * step)
            self.assertEqual(entry["parameter"], name)
            self.assertAlmostEqual(entry["magnitude_per_percent"], 0.01 * value * slope, delta=1e-6 * top)
        moved = self.json_of("response", self.one, "-c", "default", "--input", "a.x", "--set", "c=2*c")["responses"][0]["extremes"][0]
        self.assertLess(moved["magnitude"], 0.51 * top)

    def test_what_nothing_damps_has_no_value(self):
        got = self.expect(0, "response", self.model, "-c", "held", "--input", "a.x", "--format", "json").stdout
        self.assertNotIn("inf", got.lower().replace("infinite", ""))
        kinds = [[e["kind"] for e in r["extremes"]] for r in json.loads(got)["responses"]]
        self.assertEqual(kinds, [["resonance", "antiresonance", "resonance"], ["resonance", "minimum", "resonance"]])
        text = self.expect(0, "response", self.model, "-c", "held", "--input", "a.x").stdout
        self.assertIn("Resonances that nothing damps have no magnitude: it is infinite.", text)

    def test_csv_has_a_row_per_value_and_the_ground_can_move(self):
        rows = list(csv.DictReader(io.StringIO(self.expect(0, "response", self.one, "--input", "base.x", "--measure", "a.x:acceleration", "--measure",
                                                           "joint.j.x", "--from", "0.1", "--to", "pi", "--log", "--format", "csv").stdout)))
        self.assertEqual({r["output"] for r in rows}, {"a.x:acceleration", "joint.j.x"})
        first = [r for r in rows if r["output"] == "a.x:acceleration"]
        self.assertAlmostEqual(float(first[0]["frequency_hz"]), 0.1)
        self.assertAlmostEqual(float(first[-1]["frequency_hz"]), math.pi)
        for row in first:
            s = 2j * math.pi * float(row["frequency_hz"])
            want = (200 + 0.4 * s) / (2 * s * s + 0.4 * s + 200)
            self.assertLess(abs(complex(float(row["re"]), float(row["im"])) - want), 1e-10 * abs(want))
            self.assertEqual(row["unit"], "m/s^2 per m/s^2")

    def test_poles_and_residues_make_the_response(self):
        model, _, _, _ = chain(7, 4)
        path = self.write("problems/chain.json", json.dumps(model))
        got = self.json_of("response", path, "-c", "default", "--input", "base.x", "--measure", "b2.x:acceleration", "--poles")
        entry, = got["responses"]
        s = 2j * math.pi * numpy.array(got["frequencies_hz"])
        value = sum(complex(d["re"], d["im"]) * s ** k for k, d in enumerate(entry["polynomial"]))
        for pole in entry["poles"]:
            value = value + complex(pole["residue_re"], pole["residue_im"]) / (s - complex(pole["re"], pole["im"]))
        h = numpy.array(entry["re"]) + 1j * numpy.array(entry["im"])
        self.assertEqual(len(entry["poles"]), 8)
        self.assertLess(numpy.max(numpy.abs(value - h)), 1e-9 * numpy.max(numpy.abs(h)))
        free = self.json_of("response", self.model, "-c", "free", "--input", "a.x", "--poles", "--from", "0.1")["responses"][0]
        self.assertIsNone(free["poles"])
        self.assertIn("like 1/s^2", free["no_poles"])
        self.assertIn("There is no sum of poles", self.expect(0, "response", self.model, "-c", "free", "--input", "a.x", "--poles").stdout)

    def test_fewer_modes_are_said(self):
        text = self.expect(0, "response", self.model, "-c", "held", "--input", "a.x", "--modes", "1").stdout
        self.assertIn("By 1 of 2 modes.", text)
        self.assertIn("1 modes from 0.33014 Hz on follow statically", text)

    def test_wrong_use_is_named(self):
        for args, said in (([], "needs --input"), (["--input", "a.y"], 'no input is called "a.y"; did you mean "a.x"?'),
                           (["--input", "a.x", "--from", "5", "--to", "1"], "--to: 1 Hz is not above --from, 5 Hz"),
                           (["--input", "a.x", "--from", "-1"], "--from: -1 is not a frequency above 0"),
                           (["--input", "a.x", "--points", "1"], "--points: a grid has at least 2 points"),
                           (["--input", "a.x", "--sensitivity", "k9"], '--sensitivity: unknown parameter "k9"')):
            self.assertIn(said, self.expect(2, "response", self.model, "-c", "held", *args).stderr)
        self.assertIn('joint "rb" is redundant', self.expect(2, "response", self.model, "-c", "twice", "--input", "a.x", "--measure", "joint.rb.y").stderr)

class StateSpace(CliTest):
    """--state-space: its matrices against the responses that the command tells, in all three forms."""

    def setUp(self):
        super().setUp()
        model, *_ = chain(4, 7)
        self.chain = self.write("problems/chain.json", json.dumps(model))
        self.ports = ["--input", "b0.x", "--input", "base.x", "--measure", "b6.x", "--measure", "b3.x:acceleration", "--measure", "b2.x:relative_velocity",
                      "--measure", "spring.s4"]
        self.ports = self.ports if any(spring["name"] == "s4" for spring in model["springs"]) else self.ports[:-2]

    def written(self, name, *more):
        file = self.folder / name
        got = self.json_of("response", self.chain, "-c", "default", *self.ports, "--state-space", file, *more)
        return got, file

    @staticmethod
    def at(space, hz):
        a, b, c, d = (numpy.array(space[name], float).reshape(len(space[name]), -1) for name in "ABCD")
        return [c @ numpy.linalg.solve(2j * math.pi * f * numpy.eye(len(a)) - a, b) + d for f in hz]

    def worst(self, got, space, below=math.inf):
        hz = [f for f in got["frequencies_hz"] if f <= below]
        values = self.at(space, hz)
        worst = 0.0
        for k, one in enumerate(got["responses"]):
            o, i = k % len(got["outputs"]), k // len(got["outputs"])
            want = (numpy.array(one["re"]) + 1j * numpy.array(one["im"]))[:len(hz)]
            have = numpy.array([value[o, i] for value in values])
            worst = max(worst, float(numpy.max(numpy.abs(have - want) / numpy.maximum(numpy.abs(want), numpy.median(numpy.abs(want))))))
        return worst

    def test_its_matrices_have_the_response(self):
        got, file = self.written("all.json", "--to", "1000")
        space = json.loads(file.read_text(encoding="utf-8"))
        self.assertEqual(space, got["state_space"])
        self.assertEqual((space["modes"], space["residual_shapes"], len(space["states"])), (7, 0, 16))  # the ground's motion, too
        self.assertEqual(space["states"][-2:], ["integral of base.x:acceleration", "second integral of base.x:acceleration"])
        self.assertLess(self.worst(got, space), 1e-8)
        self.assertLess(space["largest_difference_percent"], 1e-6)
        self.assertFalse(space["viscous_for_loss_factors"])

    def test_fewer_modes_follow_the_rest_statically(self):
        hz = [mode["frequency_hz"] for mode in self.json_of("modes", self.chain, "-c", "default")["modes"]]
        got, file = self.written("few.json", "--from", str(hz[0] / 50), "--to", str((hz[2] + hz[3]) / 2))
        space = json.loads(file.read_text(encoding="utf-8"))
        self.assertEqual((space["modes"], space["residual_shapes"]), (3, 2))
        self.assertLess(self.worst(got, space, hz[0] / 10), 1e-4)
        told = space["largest_difference_percent"]
        self.assertTrue(0.3 * told < 100 * self.worst(got, space) < 3 * told, told)  # at other frequencies

    def test_all_forms_say_the_same(self):
        got, _ = self.written("x.json")
        space = got["state_space"]
        _, file = self.written("x.csv")
        rows = list(csv.reader(io.StringIO(file.read_text(encoding="utf-8"))))
        inputs, outputs = ([port["name"] for port in space[kind]] for kind in ("inputs", "outputs"))
        self.assertEqual(rows[0], ["row", *space["states"], *inputs])
        self.assertEqual([row[0] for row in rows[1:]], space["states"] + outputs)
        self.assertEqual([[float(cell) for cell in row[1:]] for row in rows[1:]],
                         [a + b for a, b in zip(space["A"] + space["C"], space["B"] + space["D"])])
        self.written("deep/x.mtx")
        for name in "ABCD":
            numpy.testing.assert_array_equal(mmread(self.folder / "deep" / f"x_{name}.mtx"), numpy.array(space[name]))

    def test_what_has_none_is_refused(self):
        for args, said in ((["--input", "b0.x", "--state-space", self.folder / "x.mat"], "ends with .json, .csv or .mtx"),
                           (["--input", "base.x:displacement", "--state-space", self.folder / "x.json"],
                            "base.x:displacement: there is no state space: a derivative of this input acts")):
            self.assertIn(said, " ".join(self.expect(2, "response", self.chain, *args).stderr.split()))
        self.assertFalse((self.folder / "x.json").exists())


if __name__ == "__main__":
    main()

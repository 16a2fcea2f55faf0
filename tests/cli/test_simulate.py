# SPDX-License-Identifier: GPL-3.0-or-later
"""simulate at the command line: what is asked for, in every form; refusals in words; what an interrupt leaves."""
import csv
import io
import json
import math
import os
import signal
import subprocess
import time

from common_cli import PROGRAM, SOURCE, CliTest, main
from test_interrupts import at_default

PENDULUM = str(SOURCE / "tests/models/pendulum.json")
FOUR_BAR = str(SOURCE / "tests/models/four_bar.json")
MASSLESS = str(SOURCE / "tests/models/massless.json")


def cpu_seconds(pid):
    with open(f"/proc/{pid}/stat", encoding="ascii") as stat:
        return sum(map(int, stat.read().rpartition(")")[2].split()[11:13])) / os.sysconf("SC_CLK_TCK")


class Simulate(CliTest):
    def refused(self, text, *args, code=2):
        done = self.expect(code, "simulate", *args)
        self.assertEqual(done.stdout, "")
        self.assertIn(text, done.stderr)

    def test_table_csv_and_json_say_the_same(self):
        asked = (PENDULUM, "-c", "hanging", "--start", "pivot=30*deg", "--duration", "1", "--dt-out", "0.25", "--measure", "pivot",
                 "--measure", "tip.x:velocity", "--measure", "tip.x:acceleration")
        answer = self.json_of("simulate", *asked)
        rows = list(csv.DictReader(io.StringIO(self.expect(0, "simulate", *asked, "--format", "csv").stdout)))
        self.assertEqual(answer["time_s"], [0, 0.25, 0.5, 0.75, 1])
        self.assertEqual([o["unit"] for o in answer["outputs"]], ["rad", "m/s", "m/s^2"])
        for name, output in zip(("pivot_rad", "tip.x_m_per_s", "tip.x_m_per_s2"), answer["outputs"]):
            self.assertEqual([float(r[name]) for r in rows], output["values"])
        self.assertEqual([float(r["kinetic_j"]) for r in rows], answer["kinetic_j"])
        self.assertAlmostEqual(answer["outputs"][0]["values"][0], math.radians(30), places=14)
        text = self.expect(0, "simulate", *asked).stdout
        self.assertIn("tip.x:acceleration [m/s^2]", text)
        self.assertEqual(len([line for line in text.splitlines() if line.startswith("  0.") or line.startswith("  0 ")]), 4)
        self.assertTrue(answer["complete"])

    def test_damping_that_is_no_force_is_refused(self):
        with open(PENDULUM, encoding="utf-8") as text:
            model = json.load(text)
        for damping, what in (({"ratio": 0.02}, "damping ratios of modes"), ({"mass_per_s": 0.1}, "proportional damping")):
            with self.subTest(damping=damping):
                path = self.write("damped.json", json.dumps(model | {"damping": damping}))
                self.refused(what, path, "-c", "hanging", "--start", "pivot=0.1", "--duration", "1")

    def test_energy_comes_from_where_it_says(self):
        answer = self.json_of("simulate", PENDULUM, "-c", "hanging", "--input", "tip.x=2*sin(5*t)", "--duration", "2")
        for kinetic, potential, work in zip(answer["kinetic_j"], answer["potential_j"], answer["work_j"]):
            self.assertAlmostEqual(kinetic + potential, work, places=10)
        self.assertGreater(max(answer["work_j"]), 1e-3)

    def test_a_moved_joint_goes_where_it_is_told(self):
        answer = self.json_of("simulate", FOUR_BAR, "-c", "loaded", "--start", "jA=0.3", "--input", "jA=0.5*sin(4*t)", "--duration", "1",
                              "--measure", "jA")
        for t, value in zip(answer["time_s"], answer["outputs"][0]["values"]):
            self.assertAlmostEqual(value, 0.3 + 0.5 * math.sin(4 * t), places=12)

    def test_the_ground_by_place_velocity_and_acceleration(self):
        seen = [self.json_of("simulate", PENDULUM, "-c", "hanging", "--input", f"base.x{of}", "--duration", "1", "--measure", "pivot")["outputs"][0]["values"]
                for of in ("=-0.01*64*sin(8*t)", ":velocity=0.01*8*cos(8*t)", ":displacement=0.01*sin(8*t)")]
        for a, b, c in zip(*seen):
            self.assertAlmostEqual(a, b, places=13)
            self.assertAlmostEqual(a, c, places=13)
        sine = self.json_of("simulate", PENDULUM, "-c", "hanging", "--sine", "base.x=-0.64@4/pi", "--duration", "1", "--measure", "pivot")
        for a, b in zip(seen[0], sine["outputs"][0]["values"]):
            self.assertAlmostEqual(a, b, places=13)

    def test_what_stands_on_the_ground_is_accelerated_with_it(self):
        """A beam that is held at both ends has the ground's acceleration where it is read; both ways of a motion agree."""
        bar = {"kind": "beam", "elements": 1, "youngs_modulus_pa": 7e10, "density_kg_per_m3": 2700, "section": {"shape": "rectangle", "width_m": 0.01, "height_m": 0.01}}
        model = self.write("held.json", json.dumps({
            "format": "modetune-model/1", "name": "A held beam and a mass", "dimension": 2, "bodies": [{"name": "m", "mass_kg": 2, "centre": [1, 0]}],
            "links": [{"name": "b", "from": [0, 1], "to": [1, 1], **bar}],
            "joints": [{"name": "g", "type": "pin-in-slot", "bodies": ["ground", "m"], "at": [1, 0], "axis": [1, 0]},
                       {"name": "r", "type": "fixed", "bodies": ["ground", "b.start"], "at": [0, 1]},
                       {"name": "e", "type": "fixed", "bodies": ["ground", "b.end"], "at": [1, 1]}],
            "springs": [{"name": "k", "type": "axial", "bodies": ["ground", "m"], "at": [[0, 0], [1, 0]], "stiffness_n_per_m": 800}],
            "sensors": [{"name": "q", "on": "b", "fraction": 0.5, "directions": ["x"]}, {"name": "s", "on": "m", "directions": ["x"]}]}))
        both = [self.json_of("simulate", model, "--duration", "0.1", "--input", "base.x=3", "--measure", "q.x:acceleration", "--measure", "s.x:acceleration", *how)
                for how in ((), ("--integrate",))]
        self.assertEqual([answer["method"] for answer in both], ["exact", "integrated"])
        for answer in both:
            held, moves = (o["values"] for o in answer["outputs"])
            for t, a, b in zip(answer["time_s"], held, moves, strict=True):
                self.assertAlmostEqual(a, 3, delta=1e-12)
                self.assertAlmostEqual(b, 3 * (1 - math.cos(20 * t)), delta=1e-9)

    def test_steady_amplitudes_are_read_under_one_sine_alone(self):
        model = str(SOURCE / "tests/models/space_body.json")
        one = self.json_of("simulate", model, "-c", "damped", "--sine", "base.x=1@3", "--duration", "20", "--measure", "s.x")
        self.assertEqual(one["readings"][0]["steady"]["periods"], 10)
        two = self.json_of("simulate", model, "-c", "damped", "--sine", "base.x=1@3", "--sine", "base.y=1@4", "--duration", "1", "--measure", "s.x")
        self.assertNotIn("steady", two["readings"][0])

    def test_random_vibration_is_that_of_its_seed(self):
        asked = ("simulate", PENDULUM, "-c", "hanging", "--random", "base.x=1:0.1,5:0.1", "--duration", "2", "--format", "csv")
        self.assertEqual(self.expect(0, *asked).stdout, self.expect(0, *asked, "--seed", "1").stdout)
        self.assertNotEqual(self.expect(0, *asked).stdout, self.expect(0, *asked, "--seed", "2").stdout)

    def test_refusals(self):
        hanging = (PENDULUM, "-c", "hanging")
        self.refused("needs --duration SECONDS", *hanging)
        self.refused("4 configurations: choose the one that moves with -c", PENDULUM, "--duration", "1")
        self.refused('there is no joint "pivo"', *hanging, "--duration", "1", "--start", "pivo=1")
        self.refused('did you mean "pivot"?', *hanging, "--duration", "1", "--measure", "pivott")
        self.refused('did you mean "base.x"?', *hanging, "--duration", "1", "--input", "base.z=1")
        self.refused("is not PORT=AMPLITUDE@HZ", *hanging, "--duration", "1", "--sine", "base.x=1")
        self.refused("the frequency is not above 0", *hanging, "--duration", "1", "--sine", "base.x=1@0")
        self.refused("is not PORT=LEVEL@FROM:TO", *hanging, "--duration", "1", "--sine-sweep", "base.x=1@5")
        self.refused("two breakpoints or more", *hanging, "--duration", "1", "--random", "base.x=1:1")
        self.refused('unknown name "x"', *hanging, "--duration", "1", "--input", "base.x=x")
        self.refused("is not displacement, velocity or acceleration", *hanging, "--duration", "1", "--measure", "tip.x:speed")
        self.refused("there are 1 vibration modes", *hanging, "--duration", "1", "--start-mode", "2:0.1")
        self.refused("is not N:AMPLITUDE", *hanging, "--duration", "1", "--start-mode", "0.1")
        self.refused("samples of", *hanging, "--duration", "1", "--dt-out", "1e-9")
        self.refused("has no finite value", *hanging, "--duration", "1", "--input", "base.x=sqrt(0.5 - t)", code=3)
        self.refused("after", MASSLESS, "-c", "sprung", "--duration", "1", "--input", "base.x=t", code=3)
        self.refused("cannot turn or slide", FOUR_BAR, "-c", "locked", "--duration", "1", "--rate", "jA=1")

    def test_rotations_count_from_the_position_at_rest(self):
        """As the joint does that turns the body alone, whatever the start; in space about each axis."""
        with open(PENDULUM, encoding="utf-8") as text:
            model = json.load(text)
        model["sensors"].append({"name": "turn", "on": model["bodies"][0]["name"], "directions": ["rz"]})
        path = self.write("turned.json", json.dumps(model))
        for start in (0.5, -2.5, 3.0):
            told = self.json_of("simulate", path, "-c", "hanging", "--start", f"pivot={start}", "--duration", "1", "--dt-out", "0.05",
                                "--measure", "turn.r", "--measure", "pivot")
            turn, pivot = (o["values"] for o in told["outputs"])
            self.assertAlmostEqual(turn[0], start, delta=1e-9)
            for a, b in zip(turn, pivot):
                self.assertAlmostEqual(a, b, delta=1e-6)
        for axis, name in enumerate(("rx", "ry", "rz")):
            along = [float(k == axis) for k in range(3)]
            path = self.write("wheel.json", json.dumps({
                "format": "modetune-model/1", "dimension": 3,
                "bodies": [{"name": "a", "mass_kg": 1, "inertia_kg_m2": [1, 1, 1], "centre": [0, 0, 0]}],
                "joints": [{"name": "j", "type": "revolute", "bodies": ["ground", "a"], "at": [0, 0, 0], "axis": along}],
                "springs": [{"name": "k", "type": "torsion", "joint": "j", "stiffness_n_m_per_rad": 3}],
                "sensors": [{"name": "s", "on": "a", "directions": ["rx", "ry", "rz"]}], "configurations": {"c": {}}}))
            told = self.json_of("simulate", path, "--start", "j=0.7", "--duration", "0.1", "--measure", f"s.{name}")
            self.assertAlmostEqual(told["outputs"][0]["values"][0], 0.7, delta=1e-9)

    def test_dead_centres_are_refused_with_the_names_of_their_joints(self):
        bar = {"mass_kg": 1, "inertia_kg_m2": 0.01}
        model = {"format": "modetune-model/1", "name": "parallelogram", "dimension": 2,
                 "bodies": [dict(bar, name="left", centre=[0, 0.05]), dict(bar, name="top", centre=[0.15, 0.1]), dict(bar, name="right", centre=[0.3, 0.05])],
                 "joints": [{"name": n, "type": "revolute", "bodies": b, "at": p} for n, b, p in (
                     ("jA", ["ground", "left"], [0, 0]), ("jB", ["left", "top"], [0, 0.1]), ("jC", ["top", "right"], [0.3, 0.1]),
                     ("jD", ["ground", "right"], [0.3, 0]))],
                 "configurations": {"c": {}}}
        done = self.expect(3, "simulate", self.write("p.json", json.dumps(model)), "--rate", "jA=2", "--duration", "5")
        self.assertRegex(done.stderr, r'after 0\.78539\d* s: dead centre: joints "jA", "jB", "jC", "jD" become dependent')

    def test_time_limit_and_interrupt_leave_what_there_is(self):
        asked = ("simulate", PENDULUM, "-c", "hanging", "--start", "pivot=2", "--duration", "1e6", "--dt-out", "1")
        done = self.expect(1, *asked, "--time", "0.3", "--format", "json")
        answer = json.loads(done.stdout)
        self.assertFalse(answer["complete"])
        self.assertGreater(len(answer["time_s"]), 0)
        self.assertIn("stopped at the time limit: the motion ends at", done.stderr)
        child = subprocess.Popen([PROGRAM, *asked], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=at_default)
        while cpu_seconds(child.pid) < 0.5:  # then it is at work, however slow the machine is
            time.sleep(0.01)
        child.send_signal(signal.SIGINT)
        out, err = child.communicate(timeout=600)
        self.assertEqual(child.returncode, 130)
        self.assertIn("interrupted: the motion ends at", err)
        self.assertIn("time [s]", out)


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""`modes --effective-mass`: participation factors and effective modal masses against closed forms and against invariants.

A clamped uniform beam has 61.31, 18.83 and 6.47 % of its mass in its first three modes (with a_k of cos a cosh a = -1 and
s = (cosh a + cos a)/(sinh a + sin a) its modes of unit mass have the mean 2 s / a; Clough and Penzien, Dynamics of Structures, table of
example E18-4, has the same to three digits).
"""
import csv
import io
import json
import math

from common_cli import CliTest, main

ROOTS = [1.8751040687119611, 4.694091132974175, 7.854757438237613, 10.995540734875467]  # a
PART = [(2 * (math.cosh(a) + math.cos(a)) / (math.sinh(a) + math.sin(a)) / a) ** 2 for a in ROOTS]
NEAR = 1e-9
FINE = 2e-9  # what 60 elements leave


def slide(name, body, **more):
    return {"name": name, "type": "prismatic", "bodies": ["ground", body], "axis": [1, 0], **more}


def spring(name, bodies, at, k):
    return {"name": name, "type": "axial", "bodies": bodies, "at": at, "stiffness_n_per_m": k}


# Two masses in a row along x, and a third that a fixed joint holds.
ROW = {"format": "modetune-model/1", "dimension": 2,
       "bodies": [{"name": "a", "mass_kg": 1, "inertia_kg_m2": 0.1, "centre": [1, 0]}, {"name": "b", "mass_kg": 2, "inertia_kg_m2": 0.1, "centre": [2, 0]},
                  {"name": "foot", "mass_kg": 7, "inertia_kg_m2": 0.3, "centre": [0, 1]}],
       "joints": [slide("ra", "a", at=[1, 0]), slide("rb", "b", at=[2, 0]), {"name": "bolts", "type": "fixed", "bodies": ["foot", "ground"], "at": [0, 1]}],
       "springs": [spring("s1", ["foot", "a"], [[0, 0], [1, 0]], 3), spring("s2", ["a", "b"], [[1, 0], [2, 0]], 1)]}
FREE = {"format": "modetune-model/1", "dimension": 3,
        "bodies": [{"name": "box", "mass_kg": 3, "inertia_kg_m2": [0.4, 0.5, 0.6, 0.02, -0.03, 0.01], "centre": [0.2, -0.1, 0.5]}]}


def beam(elements):
    return {"format": "modetune-model/1", "dimension": 2,
            "links": [{"name": "beam", "kind": "beam", "from": [0, 0], "to": [2, 0], "elements": elements, "density_kg_per_m3": 7800,
                       "youngs_modulus_pa": 2.1e11, "section": {"shape": "rectangle", "width_m": 0.05, "height_m": 0.01}}],
            "joints": [{"name": "clamp", "type": "fixed", "bodies": ["ground", "beam.start"], "at": [0, 0]}]}


class EffectiveMass(CliTest):
    def modes(self, model, *more):
        path = self.write("problems/e.json", json.dumps(model))
        answer = self.json_of("modes", path, "--effective-mass", *more)
        answer = answer[0] if isinstance(answer, list) else answer
        rows = {row["direction"]: row for row in answer["effective_mass"]}
        for row in rows.values():
            self.assertEqual(len(row["participation"]), len(answer["modes"]))
            for gamma, mass in zip(row["participation"], row["effective_mass"]):
                self.near(mass, gamma * gamma)
            self.near(row["sum"], sum(row["effective_mass"]))
            self.assertLessEqual(row["sum"], row["total"] * (1 + NEAR))
        return answer, rows

    def near(self, a, b, part=NEAR, size=1.0):
        self.assertFalse(math.isnan(a))
        self.assertLessEqual(abs(a - b), part * max(abs(b), size))

    def test_masses_in_a_row(self):
        _, rows = self.modes(ROW)
        self.assertEqual(list(rows), ["x", "y", "rz"])
        # K = [4 -1; -1 1], M = diag(1, 2): lambda = (9 -+ sqrt(57)) / 4, shapes (1, 4 - lambda)
        for i, sign in enumerate((-1, 1)):
            x = 4 - (9 + sign * math.sqrt(57)) / 4
            self.near(rows["x"]["effective_mass"][i], (1 + 2 * x) ** 2 / (1 + 2 * x * x))
        self.near(rows["x"]["sum"], 3)
        self.near(rows["x"]["total"], 3)  # what the bolts hold does not move
        self.near(rows["x"]["sum_percent"], 100)
        self.assertEqual((rows["x"]["unit"], rows["rz"]["unit"]), ("kg", "kg m^2"))
        self.assertEqual((rows["y"]["sum"], rows["rz"]["sum"]), (0, 0))  # the guides hold it
        self.near(rows["y"]["total"], 3)
        self.near(rows["rz"]["total"], 1 * 1 + 2 * 4 + 0.2)

    def test_clamped_beam_with_all_modes_and_with_the_lowest(self):
        for elements, method in ((60, "dense"), (200, "tree")):
            answer, rows = self.modes(beam(elements), "--count", "4")
            self.assertEqual(answer["method"], method)
            mass = 7800 * 2 * 0.05 * 0.01
            self.near(rows["y"]["total"], mass)
            for told, part in zip(rows["y"]["effective_mass"], PART):
                self.near(told / mass, part, FINE)
            self.near(rows["y"]["sum_percent"], 100 * sum(PART), FINE)
            self.near(rows["rz"]["total"], mass * 4 / 3)
            # about the clamp a mode of unit mass has the mean 2 / a^2 of x phi
            self.near(rows["rz"]["effective_mass"][0] / rows["rz"]["total"], 3 * (2 / ROOTS[0] ** 2) ** 2, FINE)
            self.assertEqual(rows["x"]["effective_mass"], [0, 0, 0, 0])

    def test_a_free_body_has_all_of_its_mass_in_rigid_body_modes(self):
        for about in ([0, 0, 0], [0.2, -0.1, 0.5], [1, 2, -3]):
            answer, rows = self.modes(FREE, "--about", ",".join(map(str, about)))
            self.assertEqual(answer["about_m"], about)
            self.assertEqual({m["kind"] for m in answer["modes"]}, {"rigid_body"})
            arm = [c - a for c, a in zip(FREE["bodies"][0]["centre"], about)]
            for k, name in enumerate(("rx", "ry", "rz")):
                steiner = 3 * sum(d * d for i, d in enumerate(arm) if i != k)
                self.near(rows[name]["total"], FREE["bodies"][0]["inertia_kg_m2"][k] + steiner)
            for row in rows.values():
                self.near(row["sum"], row["total"])
        far, near = self.modes(FREE, "--count", "all")[1], self.modes(FREE, "--count", "all", "--about", "0,0,0")[1]
        self.assertEqual(far, near)

    def test_a_bar_with_its_end_on_the_ground_has_no_mode_for_that_end(self):
        mass, bar = 2.0, 7800 * 1e-4
        row = {"format": "modetune-model/1", "dimension": 2, "bodies": [{"name": "a", "mass_kg": mass, "centre": [1, 0]}],
               "joints": [{"name": "r", "type": "pin-in-slot", "bodies": ["ground", "a"], "at": [1, 0], "axis": [1, 0]}],
               "springs": [{"name": "bar", "type": "bar", "bodies": ["ground", "a"], "at": [[0, 0], [1, 0]], "area_m2": 1e-4,
                            "youngs_modulus_pa": 2e11, "density_kg_per_m3": 7800}]}
        _, rows = self.modes(row)
        self.near(rows["x"]["total"], mass + bar)
        self.near(rows["x"]["effective_mass"][0], (mass + bar / 2) ** 2 / (mass + bar / 3))

    def test_a_locked_drive_holds(self):
        arm = {"format": "modetune-model/1", "dimension": 2,
               "bodies": [{"name": "arm", "mass_kg": 5, "inertia_kg_m2": 0.2, "centre": [0.5, 0]}, {"name": "a", "mass_kg": 1, "inertia_kg_m2": 0.1, "centre": [1, 0]}],
               "joints": [{"name": "pivot", "type": "revolute", "bodies": ["ground", "arm"], "at": [0, 0]},
                          {"name": "s", "type": "prismatic", "bodies": ["arm", "a"], "at": [1, 0], "axis": [1, 0]}],
               "springs": [{"name": "k", "type": "axial", "joint": "s", "stiffness_n_per_m": 100}],
               "configurations": {"turned": {"drive": {"joint": "pivot", "position_rad": "30*deg", "hold": "lock"}}}}
        _, rows = self.modes(arm)
        self.near(rows["x"]["total"], 1)
        self.near(rows["x"]["effective_mass"][0], 0.75)
        self.near(rows["y"]["effective_mass"][0], 0.25)

    def test_text_and_csv(self):
        path = self.write("problems/e.json", json.dumps(ROW))
        text = self.expect(0, "modes", path, "--effective-mass", "--about", "1,0,0").stdout
        self.assertRegex(text, r"\n  mode +x \[kg\] +y \[kg\] +rz \[kg m\^2\]\n")
        self.assertIn("about them through (1, 0, 0) m", text)
        self.assertRegex(text, r"\n  sum +3\.00000 +0 +0\n  total +3\.00000 +3\.00000 +2\.20000\n  sum \[%\] +100\.0 +0 +0\n")
        rows = list(csv.DictReader(io.StringIO(self.expect(0, "modes", path, "--effective-mass", "--format", "csv").stdout)))
        self.near(sum(float(row["effective_mass_x_kg"]) for row in rows), 3)
        for row in rows:
            self.near(float(row["participation_x_sqrt_kg"]) ** 2, float(row["effective_mass_x_kg"]))
        self.assertIn("effective_mass_rz_kg_m2", rows[0])

    def test_wrong_points(self):
        path = self.write("problems/e.json", json.dumps(ROW))
        self.assertIn("--about goes with --effective-mass", self.expect(2, "modes", path, "--about", "1,0,0").stderr)
        for wrong in ("1,2", "1,2,3,4", "a,b,c", "1,,2", "1,2,inf", "1;2;3", "1,2,3e999"):
            self.assertIn("is not a point X,Y,Z", self.expect(2, "modes", path, "--effective-mass", "--about", wrong).stderr)


if __name__ == "__main__":
    main()

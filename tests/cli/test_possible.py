# SPDX-License-Identifier: GPL-3.0-or-later
"""What no mechanism is like is refused where it stands, whatever number, expression, bound or configuration leads there."""
import copy
import json
import re

from common_cli import SOURCE, CliTest, main

# Two bodies, one above the other, each on a hinge with a spring of its own.
STICK = {
    "format": "modetune-model/1", "dimension": 3, "gravity_m_per_s2": [0, 0, -9.81],
    "bodies": [{"name": "ring", "mass_kg": 0.5, "inertia_kg_m2": [1e-3, 2e-3, 2e-3], "centre": [0, 0, 0]},
               {"name": "stick", "mass_kg": 0.5, "inertia_kg_m2": [1e-3, 1e-3, 1e-4], "centre": [0, 0, 0.1]}],
    "joints": [{"name": "roll", "type": "revolute", "bodies": ["ground", "ring"], "at": [0, 0, 0], "axis": [1, 0, 0]},
               {"name": "pitch", "type": "revolute", "bodies": ["ring", "stick"], "at": [0, 0, 0], "axis": [0, 1, 0]}],
    "springs": [{"name": "kr", "type": "torsion", "joint": "roll", "stiffness_n_m_per_rad": 100},
                {"name": "kp", "type": "torsion", "joint": "pitch", "stiffness_n_m_per_rad": 150}],
}


# Functions that rows of src/base/possible.c name, and what drives each from both sides: a test here, of doubts, or a wrong file.
WITH = {
    "nonzero": "tests/documents/wrong/structure_space.json", "lint_matrix": "tests/documents/wrong/structure_space.json",
    "lint_axes": "tests/documents/wrong/structure_space.json", "lint_line": "test_a_bound_at_which_points_coincide",
    "lint_tensor": "test_inertia_by_expressions_configurations_and_bounds", "lint_section": "test_bounds_at_which_nothing_can_be_built",
    "lint_stout": "test_values_of_a_model", "lint_drive": "test_values_of_a_model", "lint_stroke": "test_a_stroke_longer_than_the_drawing",
    "lint_gravity": "test_values_of_a_model", "mt_reader_count": "tests/documents/wrong/study_counts.json",
    "warn_target": "test_values_of_a_study", "warn_reference": "test_measured_frequencies_in_other_units",
}
# ... and functions that the test of studies, profiles and catalogues drives member by member, each from both sides.
BY_MEMBER = "tests/documents/test_possible_files.c"


class Possible(CliTest):
    def test_every_function_that_a_row_names_is_there_and_driven(self):
        rows = (SOURCE / "src/base/possible.c").read_text(encoding="utf-8")
        named = set(re.findall(r'\.with = "(\w+)"', rows))
        kinds = re.search(r"ANALYSED\[\] = \{(.*?)\}", (SOURCE / BY_MEMBER).read_text(encoding="utf-8"))[1]
        self.assertEqual(set(re.findall(r'"(\w+)"', kinds)), {"warn_target", "warn_reference"})
        models = re.findall(r'\.with = "(\w+)"', rows[:rows.index("[MT_POSSIBLE_WHOLE]")])
        self.assertEqual(set(models) | {"mt_reader_count", "warn_target", "warn_reference"}, set(WITH))
        sources = "".join(p.read_text(encoding="utf-8") for p in sorted((SOURCE / "src").glob("*/*.c")))
        tests = "".join((SOURCE / f"tests/cli/{name}.py").read_text(encoding="utf-8") for name in ("test_possible", "test_doubts"))
        for function in named:
            self.assertTrue(re.search(rf"\b{function}\([^;]*\)\n{{", sources), function)
        for where in WITH.values():
            self.assertTrue((SOURCE / where).is_file() if "/" in where else f"def {where}(" in tests, where)

    def put(self, model, name="problems/p.json"):
        return self.write(name, json.dumps(model, indent=1))

    def test_a_spring_that_cannot_hold_the_position(self):
        for spring, code in (("kr", 2), ("kp", 0)):
            drive = {"joint": "pitch", "position_rad": 0.3, "hold": {"trim": spring}}
            path = self.put(dict(STICK, configurations={"neutral": {}, "fwd": {"drive": drive}, "again": {"like": "fwd"}}))
            line = 1 + [i for i, text in enumerate((self.folder / path).read_text(encoding="utf-8").splitlines()) if '"trim"' in text][0]
            for command in ("check", "modes"):
                done = self.expect(code, command, path)
                if code:
                    self.assertIn(f'spring "kr" cannot hold "pitch": its force does no work when "pitch" moves (p.json:{line}:14)', done.stderr)

    def test_a_drive_that_an_option_drops(self):
        """As with `like`: of two joints one is driven, and that is said."""
        drive = {"joint": "pitch", "position_rad": 0.3, "hold": {"trim": "kp"}}
        path = self.put(dict(STICK, configurations={"neutral": {}, "fwd": {"drive": drive}}))
        said = 'configuration "fwd" drives "pitch", which is dropped while "roll" is driven'
        for joint, want in (("roll", 1), ("pitch", 0)):
            done = self.expect(0, "sweep", path, "--drive", f"{joint}=-0.1:0.1:3")
            self.assertEqual(done.stderr.count(f"--drive: {said}"), want, done.stderr)
            done = self.expect(0, "simulate", path, "-c", "fwd", "--input", f"{joint}=0.01*sin(t)", "--duration", "0.01")
            self.assertEqual(done.stderr.count(f"--input: {said}"), want, done.stderr)

    def test_a_spring_that_holds_by_a_detour(self):
        """The ring's spring holds the stick where a gear ties the two angles."""
        model = copy.deepcopy(STICK)
        model["joints"].append({"name": "mesh", "type": "gear", "joints": ["roll", "pitch"], "ratio": 0.01})
        model["configurations"] = {"fwd": {"drive": {"joint": "pitch", "position_rad": 0.1, "hold": {"trim": "kr"}}}}
        self.expect(0, "modes", self.put(model))

    def test_inertia_by_expressions_configurations_and_bounds(self):
        model = copy.deepcopy(STICK)
        model["parameters"] = {"r": 0.1}
        model["bodies"][1]["inertia_kg_m2"] = ["0.5*r^2/4", "0.5*r^2/4", "0.5*0.1^2/2"]
        impossible = r'body "stick": inertia_kg_m2/2 \(0\.0025\) is more than the other two moments together'
        self.assertEqual(self.expect(0, "check", self.put(model)).stderr, "")
        thin = dict(model, configurations={"a": {}, "b": {"parameters": {"r": 0.09}}})
        self.assertRegex(self.expect(2, "check", self.put(thin)).stderr, impossible + '.* in configuration "b"')
        self.assertRegex(self.expect(2, "modes", self.put(model), "--set", "r=0.09").stderr, impossible)
        study = {"format": "modetune-study/1", "model": "../problems/p.json", "goals": [{"type": "frequency", "mode": 1, "at_least_hz": 1}]}
        for lower, code in ((0.09, 2), (0.1, 0)):
            asked = dict(study, variables=[{"parameter": "r", "lower": lower, "upper": 0.2}])
            done = self.expect(code, "check", self.write("studies/s.json", json.dumps(asked)))
            if code:
                self.assertRegex(done.stderr, r"error: /variables/0/lower: with r at 0\.09, " + impossible)

    def test_a_link_without_length(self):
        beam = {"name": "arm", "kind": "beam", "from": [0, 0], "to": ["L", 0], "elements": 2, "density_kg_per_m3": 7850, "youngs_modulus_pa": 2e11,
                "section": {"shape": "circle", "diameter_m": 0.02}}
        model = {"format": "modetune-model/1", "dimension": 2, "parameters": {"L": 1}, "links": [beam],
                 "configurations": {"a": {}, "b": {"parameters": {"L": "L0"}}}}
        for length, code in ((0, 2), (0.5, 0)):
            done = self.expect(code, "check", self.put(dict(model, parameters={"L": 1, "L0": length})))
            if code:
                self.assertRegex(done.stderr, r'/links/0/name: link "arm" begins and ends at the same point \(0, 0, 0\) in configuration "b"')

    def test_a_bound_at_which_points_coincide(self):
        model = copy.deepcopy(STICK)
        model["parameters"] = {"L": 0.1}
        model["springs"].append({"name": "pull", "type": "axial", "bodies": ["ground", "stick"], "at": [[0, "L", 0.1], [0, 0, 0.1]],
                                 "stiffness_n_per_m": 100})
        self.put(model)
        study = {"format": "modetune-study/1", "model": "../problems/p.json", "goals": [{"type": "frequency", "mode": 1, "at_least_hz": 1}]}
        for lower, code in ((0, 2), (1e-6, 0)):
            asked = dict(study, variables=[{"parameter": "L", "lower": lower, "upper": 0.2, "scale": 0.1}])
            done = self.expect(code, "check", self.write("studies/s.json", json.dumps(asked)))
            if code:
                self.assertIn('/variables/0/lower: with L at 0, spring "pull": its two points coincide', done.stderr)


if __name__ == "__main__":
    main()

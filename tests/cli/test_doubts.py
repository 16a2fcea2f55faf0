# SPDX-License-Identifier: GPL-3.0-or-later
"""Doubts about values that are hardly meant, and facts that surprise: each fires, each has a near miss that stays silent, and no
shipped file is doubted."""
import copy
import json
import re

from common_cli import SOURCE, CliTest, main

# A beam of steel that stands on a hinge with a spring, and a mass on its tip. Lowest mode some 5 Hz.
MODEL = {
    "format": "modetune-model/1", "dimension": 2,
    "parameters": {"k": {"value": 2000, "unit": "N m/rad"}, "m": {"value": 1, "unit": "kg"}},
    "links": [{"name": "rod", "kind": "beam", "from": [0, 0], "to": [0, 1], "elements": 4, "density_kg_per_m3": 7850,
               "youngs_modulus_pa": 2.1e11, "section": {"shape": "circle", "diameter_m": 0.02}}],
    "bodies": [{"name": "tip", "mass_kg": "m", "inertia_kg_m2": 0.01, "centre": [0, 1]}],
    "joints": [{"name": "foot", "type": "revolute", "bodies": ["ground", "rod.start"], "at": [0, 0]},
               {"name": "weld", "type": "fixed", "bodies": ["rod.end", "tip"], "at": [0, 1]}],
    "springs": [{"name": "hold", "type": "torsion", "joint": "foot", "stiffness_n_m_per_rad": "k"}],
}
ROTOR = {"speed_hz": 10, "harmonics": ["1P"], "speed_range": [0.95, 1.05], "margin_percent": 10}
STUDY = {
    "format": "modetune-study/1", "model": "../problems/m.json",
    "variables": [{"parameter": "k", "lower": 200, "upper": 20000}, {"parameter": "m", "lower": 0.5, "upper": 2}],
    "goals": [{"type": "avoid", "rotor": ROTOR}],
}


def changed(base, path, value):
    """A copy with the member at the path replaced; None takes it away."""
    out = copy.deepcopy(base)
    at = out
    for key in path[:-1]:
        at = at[key]
    if value is None:
        del at[path[-1]]
    else:
        at[path[-1]] = value
    return out


def machine(**members):
    return {"type": "avoid", "margin_percent": 10, "machine": dict({"orders": ["1E"]}, **members)}


class Doubts(CliTest):
    def write_json(self, name, data):
        return self.write(name, json.dumps(data))

    def found(self, path, code=0):
        """Kinds of doubts and facts that `check` tells."""
        done = self.expect(code, "check", path, "--format", "json")
        got = json.loads(done.stdout)[0]
        for doubt in got["doubts"]:
            self.assertIn(doubt["text"], done.stderr)
            self.assertRegex(done.stderr, "(?m)^[^ ]*: warning: ")
        return got["doubts"], got["facts"]

    def put_model(self, path=None, value=None, base=MODEL):
        return self.write_json("problems/m.json", changed(base, path, value) if path else base)

    def put_study(self, path=None, value=None, base=STUDY):
        return self.write_json("studies/s.json", changed(base, path, value) if path else base)

    def test_shipped_files_are_not_doubted(self):
        files = [p for p in (SOURCE / "problems").glob("*.json") if p.name != "aircraft.json"] + list((SOURCE / "studies").glob("*.json"))
        self.assertGreater(len(files), 25)
        got = self.json_of("check", *sorted(map(str, files)))
        self.assertEqual({g["file"]: g["doubts"] for g in got}, {str(p): [] for p in files})

    def test_the_models_here_are_not_doubted(self):
        self.assertEqual(self.found(self.put_model()), ([], []))
        self.assertEqual(self.found(self.put_study()), ([], []))

    def test_values_of_a_study(self):
        self.put_model()
        goal = ("goals", 0)
        rotor = (*goal, "rotor")
        frequency = {"type": "frequency", "mode": 1}
        rows = [  # path, doubted, kind, pointer, near miss
            ((*rotor, "speed_range"), [95, 105], "speed_range", "/goals/0/rotor/speed_range", [0.5, 2]),
            ((*rotor, "speed_range"), [0.9, 2.1], "speed_range", "/goals/0/rotor/speed_range", [0.9, 2]),
            ((*rotor, "speed_range"), [0.49, 1], "speed_range", "/goals/0/rotor/speed_range", [0.5, 1]),
            ((*rotor, "margin_percent"), 0.1, "margin", "/goals/0/rotor/margin_percent", 1),
            (goal, machine(speed_hz=10, speed_range=[20, 110]), "speed_range", "/goals/0/machine/speed_range",
             machine(speed_hz=10, speed_range=[0.2, 1.1])),
            (goal, machine(speed_range_hz=[7, 3000]), "speed", "/goals/0/machine/speed_range_hz",
             machine(speed_range_hz=[7, "3000*rpm"])),
            (goal, machine(speed_hz=1500, orders=["0.01E"]), "speed", "/goals/0/machine/speed_hz",
             machine(speed_hz=480, orders=["0.02E"])),
            (goal, machine(speed_hz=10, margin_percent=0.1), "margin", "/goals/0/machine/margin_percent",
             machine(speed_hz=10, margin_percent=2)),
            (goal, {"type": "avoid", "bands_hz": [[9, 11]], "margin_percent": 0.5}, "margin", "/goals/0/margin_percent",
             {"type": "avoid", "bands_hz": [[9, 11]], "margin_percent": 0}),
            (goal, {"type": "avoid", "bands_hz": [[9, 9.001]]}, "band", "/goals/0/bands_hz",
             {"type": "avoid", "bands_hz": [[9, 9.01]]}),
            (goal, {"type": "avoid", "bands_hz": [[9, 11]], "up_to_hz": 9.001}, "band", "/goals/0/up_to_hz",
             {"type": "avoid", "bands_hz": [[9, 11]], "up_to_hz": 9.1}),
            (goal, {"type": "avoid", "bands_hz": [[1e6, 1.1e6]]}, "no_effect", "/goals/0",
             {"type": "avoid", "bands_hz": [[1e6, 1.1e6], [9, 11]]}),
            (goal, dict(frequency, target_hz=2000), "target", "/goals/0/target_hz", dict(frequency, target_hz=200)),
            (goal, dict(frequency, target_hz=0.01), "target", "/goals/0/target_hz", dict(frequency, target_hz=0.1)),
            (goal, dict(frequency, at_least_hz=2000), "target", "/goals/0/at_least_hz", dict(frequency, at_least_hz=0.001)),
            (goal, dict(frequency, at_most_hz=0.001), "target", "/goals/0/at_most_hz", dict(frequency, at_most_hz=9000)),
            (goal, dict(frequency, target_hz=9, tolerance_percent=50), "tolerance", "/goals/0/tolerance_percent",
             dict(frequency, target_hz=9, tolerance_percent=40)),
            (("variables", 0), {"parameter": "k", "lower": 1e-3, "upper": 2e5}, "bounds", "/variables/0",
             {"parameter": "k", "lower": 1e-3, "upper": 9e4}),
            (("variables", 0), {"parameter": "k", "lower": 0.1, "upper": 1.9}, "bounds", "/variables/0",
             {"parameter": "k", "lower": 0.1, "upper": 2.1}),
            (("variables", 0), {"parameter": "k", "lower": 3e6, "upper": 4e6}, "bounds", "/variables/0",
             {"parameter": "k", "lower": 1.9e6, "upper": 4e6}),
        ]
        for path, wrong, kind, pointer, right in rows:
            with self.subTest(kind=kind, wrong=wrong):
                doubts, _ = self.found(self.put_study(path, wrong))
                self.assertIn((kind, pointer), [(d["kind"], d["pointer"]) for d in doubts])
                for d in doubts:
                    self.assertEqual((d["file"], d["line"]), ("s.json", 1))
                    self.assertGreater(d["column"], 1)
                self.assertEqual(self.found(self.put_study(path, right))[0], [])

    def test_values_of_a_trade(self):
        self.put_model()
        for values, want in (([0.1, 0.2], ["margin"]), ([5, 10], []), ([0, 0.5, 10], [])):
            vary = [{"goal": 0, "member": "margin_percent", "values": values}]
            doubts, _ = self.found(self.put_study(("trade",), {"vary": vary}))
            self.assertEqual([d["kind"] for d in doubts], want)

    def test_values_of_a_model(self):
        section = ("links", 0, "section", "diameter_m")
        drive = {"x": {"drive": {"joint": "foot", "position_rad": 20}}}
        turned = {"x": {"drive": {"joint": "foot", "position_rad": "20*deg"}}}
        rows = [  # path, doubted, kind, near miss
            (("links", 0, "youngs_modulus_pa"), 2.1e5, "modulus", 2e6),
            (("links", 0, "youngs_modulus_pa"), 2.1e14, "modulus", 9e12),
            (("links", 0, "density_kg_per_m3"), 7.85e-9, "density", 10),
            (("links", 0, "density_kg_per_m3"), 9.99, "density", 7850),
            (("links", 0, "density_kg_per_m3"), 23001, "density", 23000),
            (section, 20, "section", 0.2),
            (section, 2e-7, "section", 2e-3),
            (("bodies", 0, "inertia_kg_m2"), 1e4, "inertia", 100),
            (("bodies", 0, "mass_kg"), 2e10, "mass", 2e8),
            (("springs", 0, "stiffness_n_m_per_rad"), 1e-12, "frequency", 1e-3),
            (("links", 0, "to"), [0, 500], "size", [0, 1]),
            (("gravity_m_per_s2",), [0, 9.81], "gravity", [0, -9.81]),
            (("gravity_m_per_s2",), [1, 2], "gravity", [2, 1]),
            (("gravity_m_per_s2",), [0, -981], "gravity", [0, -199]),
            (("gravity_m_per_s2",), [0, -1], "gravity", [0, -1.6]),
            (("gravity_m_per_s2",), [0, -1.4], "gravity", [0, -0.4]),
            (("parameters", "q"), {"value": "sin(90)"}, "angle", {"value": "sin(90*deg)"}),
            (("parameters", "q"), {"value": "cos(6.3 + pi/2)"}, "angle", {"value": "cos(6.2 + 4*pi)"}),
            (("joints", 0, "at"), [[0, 0], [0.5, 0]], "gap", [[0, 0], [0.05, 0]]),
            (("joints", 0, "at"), [1.5, 0], "off", [0.4, 0]),
            (("configurations",), drive, "drive", turned),
        ]
        for path, wrong, kind, right in rows:
            with self.subTest(kind=kind, wrong=wrong):
                self.assertIn(kind, [d["kind"] for d in self.found(self.put_model(path, wrong))[0]])
                self.assertEqual(self.found(self.put_model(path, right))[0], [])

    def test_what_a_configuration_drops_of_another(self):
        trimmed = {"joint": "foot", "position_rad": 0.1, "hold": {"trim": "hold"}}
        mass, both = {"mass_per_s": 0.1, "ratio": 0.01}, {"mass_per_s": 0, "ratio": 0.02}
        rows = [  # of the configuration that another is like, of that one, near miss, what is dropped
            ({"drive": trimmed}, {"drive": {"joint": "foot", "position_rad": 0.2}}, {"drive": trimmed}, ["hold"]),
            ({"damping": mass}, {"damping": {"ratio": 0.02}}, {"damping": both}, ["mass_per_s"]),
            ({"damping": mass}, {"damping": {"stiffness_s": 1e-5}}, {}, ['ratio", "mass_per_s']),
        ]
        for inherited, own, right, members in rows:
            for mine, want in ((own, members), (right, [])):
                with self.subTest(own=mine):
                    between = {"a": inherited, "b": {"like": "a"}, "c": dict(mine, like="b"), "d": {"like": "c"}}
                    doubts, _ = self.found(self.put_model(base=dict(MODEL, configurations=between)))
                    self.assertEqual([d["kind"] for d in doubts], ["dropped"] * len(want))
                    for doubt, member in zip(doubts, want):
                        self.assertIn(f'drops the inherited "{member}"', doubt["text"])
                        self.assertEqual(doubt["pointer"], f"/configurations/c/{list(mine)[0]}")
        damped = dict(MODEL, damping=mass, configurations={"a": {"damping": {"ratio": 0.02}}})
        self.assertEqual([d["kind"] for d in self.found(self.put_model(base=damped))[0]], ["dropped"])

    def test_angles_of_parameters(self):
        rows = [  # parameters, how many doubts
            ({"q": 90, "x": "cos(q)", "z": "sin(q)"}, ["q"]),
            ({"q": {"value": 90, "unit": "deg"}, "x": "cos(q)"}, []),
            ({"q": {"value": 30, "unit": "deg"}, "p": 45, "x": "cos(q+p)"}, ["p"]),
            ({"q": {"value": 30, "unit": "deg"}, "n": 24, "x": "cos(n*q)"}, []),
            ({"q": 90, "x": "cos(q*deg)", "y": "tan(q*pi/180)"}, []),
            ({"q": 6.2, "x": "cos(q)"}, []),
            ({"q": "45*2", "x": "cos(q)"}, ["q"]),
        ]
        for parameters, want in rows:
            with self.subTest(parameters):
                base = dict(MODEL, parameters=dict(MODEL["parameters"], **parameters))
                doubts = [d for d in self.found(self.put_model(base=base))[0]]
                self.assertEqual([(d["kind"], d["text"].split('"')[1]) for d in doubts], [("angle", q) for q in want])
                for d in doubts:
                    self.assertGreater(d["column"], 1)

    def test_a_body_of_several_points_has_their_size(self):
        for inertia, want in ((9.01, ["inertia"]), (8.99, [])):  # 1 kg, points 1 m apart
            base = changed(MODEL, ("bodies", 0, "inertia_kg_m2"), inertia)
            base["sensors"] = [{"name": "low", "on": "tip", "at": [0, 0]}]
            self.assertEqual([d["kind"] for d in self.found(self.put_model(base=base))[0]], want)

    def test_bushings(self):
        """Two points apart, or none given: where the forces act is said."""
        bushing = {"name": "mount", "type": "bushing", "bodies": ["ground", "tip"], "stiffness_n_per_m": [1e3, 1e3], "stiffness_n_m_per_rad": 1}
        for at, kinds in (([[0, 1], [0, 1.011]], ["bushing"]), ([[0, 1], [0, 1.009]], []), ([0, 1], [])):
            base = dict(changed(MODEL, ("bodies", 0, "inertia_kg_m2"), 1e-4), springs=MODEL["springs"] + [dict(bushing, at=at)])
            doubts, _ = self.found(self.put_model(base=base))
            self.assertEqual([d["kind"] for d in doubts], kinds)
            for d in doubts:
                self.assertIn("its two points are 0.011 m apart; its forces act at the second, (0, 1.011) m", d["text"])
        path = self.put_model(base=dict(MODEL, springs=MODEL["springs"] + [bushing]))
        doubts, facts = self.found(path)
        self.assertEqual((doubts, [f["text"] for f in facts]),
                         ([], ['spring "mount" has no "at": its forces act at the centre of "tip", (0, 1) m']))
        self.assertIn(facts[0]["text"], self.expect(0, "info", path).stdout)

    def test_springs_that_joints_block(self):
        slide = {"name": "foot", "type": "prismatic", "bodies": ["ground", "rod.start"], "at": [0, 0], "axis": [1, 0]}
        along = {"name": "hold", "type": "axial", "bodies": ["ground", "rod.start"], "at": [[-1, 0], [0, 0]], "stiffness_n_per_m": "k*0.5"}
        across = dict(along, name="blocked", at=[[0, -1], [0, 0]])
        oblique = dict(along, name="blocked", at=[[-1e-6, -1], [0, 0]])
        pot = {"name": "pot", "type": "axial", "bodies": ["ground", "rod.start"], "at": [[0, -1], [0, 0]], "damping_n_s_per_m": 1}
        rows = [
            ([along, across], [], ["blocked"]),
            ([along, oblique], [], []),
            ([along, dict(across, stiffness_n_per_m=0)], [], []),
            ([along, dict(across, preload_n=5)], [], []),
            ([along], [pot], ["pot"]),
            ([along, {"name": "bush", "type": "bushing", "bodies": ["ground", "rod.start"], "at": [0, 0], "stiffness_n_per_m": [0, 10],
                      "stiffness_n_m_per_rad": 3}], [], ["bush"]),
            ([along, {"name": "bush", "type": "bushing", "bodies": ["ground", "rod.start"], "at": [0, 0], "stiffness_n_per_m": [1, 10],
                      "stiffness_n_m_per_rad": 3}], [], []),
        ]
        for springs, dampers, want in rows:
            with self.subTest([s["name"] for s in springs + dampers]):
                base = dict(MODEL, joints=[slide, MODEL["joints"][1]], springs=springs, dampers=dampers)
                doubts, _ = self.found(self.put_model(base=base))
                self.assertEqual([(d["kind"], d["text"].split('"')[1]) for d in doubts], [("spring", name) for name in want])
                for d in doubts:
                    where = "/dampers/0" if dampers else "/springs/1"
                    self.assertEqual((d["pointer"], d["line"]), (where, 1))
                    self.assertIn("has no effect here", d["text"])
        # a joint that is driven and locked forbids its own motion: that is what it is for
        locked = dict(MODEL, configurations={"x": {"drive": {"joint": "foot", "position_rad": 0.1}}})
        self.assertEqual(self.found(self.put_model(base=locked))[0], [])

    def test_links_of_rigid_elements_in_space(self):
        link = {"name": "rod", "from": [0, 0, 0], "to": [0, 0, 1], "elements": 4, "hinge_axis": [0, 1, 0], "density_kg_per_m3": 7850,
                "youngs_modulus_pa": 2.1e11, "section": {"shape": "circle", "diameter_m": 0.02}}
        foot = {"name": "foot", "type": "fixed", "bodies": ["ground", "rod.start"], "at": [0, 0, 0]}
        beam = {k: v for k, v in dict(link, kind="beam", shear_modulus_pa=8e10).items() if k != "hinge_axis"}
        for one, want in ((link, ["one_axis"]), (beam, [])):
            arm = {"name": "arm", "mass_kg": 1, "inertia_kg_m2": [1, 1, 1], "centre": [1, 0, 0]}
            hinge = {"name": "hinge", "type": "revolute", "bodies": ["ground", "arm"], "at": [0, 0, 0], "axis": [0, 0, 1]}
            spring = {"name": "hold", "type": "torsion", "joint": "hinge", "stiffness_n_m_per_rad": "k"}
            path = self.put_model(base={"format": "modetune-model/1", "dimension": 3, "links": [one], "joints": [foot, hinge], "bodies": [arm],
                                        "parameters": {"k": 100}, "springs": [spring], "dampers": [{"name": "pot", "type": "torsion", "joint": "hinge", "damping_n_m_s_per_rad": 1}],
                                        "sensors": [{"name": "hand", "on": "arm"}]})
            doubts, facts = self.found(path)
            self.assertEqual((doubts, [f["kind"] for f in facts]), ([], want))
            for command in (["modes"], ["info"], ["sensitivity"], ["sweep", "--drive", "hinge=0:0.1:2"],
                            ["simulate", "--start", "hinge=0.01", "--duration", "0.001"], ["response", "--measure", "hand.y", "--input", "hand.y"]):
                done = self.expect(0, command[0], path, *command[1:])
                for fact in facts:
                    self.assertIn(fact["text"], done.stdout)
                self.assertEqual("hinge axis only" in done.stdout, bool(facts))

    def test_measured_frequencies_in_other_units(self):
        self.put_model()
        hz = [m["frequency_hz"] for m in self.json_of("modes", "problems/m.json")[0]["modes"] if m["frequency_hz"]][:3]
        rows = [(6.283185, "rad/s", ["reference"]), (60, "turns per minute", ["reference"]), (1 / 6.283185, "rad/s", ["reference"]),
                (1.1, "", []), (5, "", [])]
        for factor, word, want in rows:
            modes = [{"frequency_hz": f * factor * (1 + 0.05 * i)} for i, f in enumerate(hz)]
            goals = [{"type": "frequency", "mode": i + 1, "reference": "test", "weight": 1} for i in range(3)]
            study = dict(STUDY, goals=goals, references={"test": {"modes": modes}}, objective={"minimise": "misfit"})
            doubts, _ = self.found(self.put_study(base=study))
            self.assertEqual([d["kind"] for d in doubts], want)
            for d in doubts:
                self.assertIn(word, d["text"])
                self.assertEqual(d["pointer"], "/references/test")
        modes[0]["frequency_hz"] = hz[0] * 6.28  # one of three
        self.assertEqual(self.found(self.put_study(base=dict(study, references={"test": {"modes": modes}})))[0], [])

    def test_tolerances_of_variables(self):
        """By itself; and of what no part is made to: a spring to 0.1 %, a length to a micrometre."""
        length = changed(MODEL, ("parameters", "d"), {"value": 0.02, "unit": "m"})
        self.put_model(("links", 0, "section", "diameter_m"), "d", length)
        rows = [({"parameter": "m", "lower": 0.5, "upper": 2}, 0.0099, 0.01), ({"parameter": "k", "lower": 200, "upper": 20000}, 0.099, 0.1),
                ({"parameter": "d", "lower": 0.001, "upper": 0.009}, 0.011, 0.012)]
        for variable, fine, good in rows:
            for tolerance, want in ((fine, ["tolerance"]), (good, [])):
                study = dict(STUDY, variables=[dict(variable, tolerance_percent=tolerance)])
                doubts, _ = self.found(self.put_study(base=study))
                self.assertEqual([(d["kind"], d["pointer"]) for d in doubts], [(k, "/variables/0/tolerance_percent") for k in want])

    def test_a_point_in_metres_in_a_file_of_millimetres(self):
        base = dict(MODEL, units={"length": "mm"}, points={"far": [0, 1000]}, links=[dict(MODEL["links"][0], to="far")], joints=[
            MODEL["joints"][0], dict(MODEL["joints"][1], at="far")], bodies=[dict(MODEL["bodies"][0], centre="far")])
        for point, want in (([0.3, 0.5], ["size"]), ([0.3, 0], []), ([0.3, 1.5], []), ([0.01, 0.02], []), (["0.3*mm", "0.5*mm + 0*k"], [])):
            doubts, _ = self.found(self.put_model(("points",), dict(base["points"], foot=point), base))
            self.assertEqual([(d["kind"], d["pointer"]) for d in doubts], [(k, "/points/foot") for k in want], point)
        self.assertEqual(self.found(self.put_model(("points",), {"foot": [0.3, 0.5]}))[0], [])  # in a file of metres

    def test_goals_that_contradict_the_order_of_modes(self):
        self.put_model()
        modes = [{"frequency_hz": 60}, {"frequency_hz": 5.2}]
        measured = [{"type": "frequency", "mode": m, "reference": "test", "weight": 1} for m in (1, 2)]
        rows = [(measured, modes, True), (measured, modes[::-1], False), ([dict(measured[0], reference_mode=2), dict(measured[1], reference_mode=1)], modes, False),
                ([{"type": "frequency", "mode": 2, "at_most_hz": 60}, {"type": "frequency", "mode": 1, "at_least_hz": 61}], modes, True),
                ([{"type": "frequency", "mode": 2, "at_most_hz": 60}, {"type": "frequency", "mode": 1, "at_least_hz": 60}], modes, False)]
        for goals, frequencies, doubted in rows:
            study = dict(STUDY, goals=goals, references={"test": {"modes": frequencies}})
            if "weight" in goals[0]:
                study["objective"] = {"minimise": "misfit"}
            doubts = [d for d in self.found(self.put_study(base=study))[0] if "ascending" in d["text"]]
            self.assertEqual([d["kind"] for d in doubts], ["target"] if doubted else [], goals)

    def test_a_shape_of_one_number(self):
        self.put_model(("sensors",), [{"name": "top", "on": "tip", "directions": ["x", "y"]}])
        for shape, doubted in (({"top.x": 1}, True), ({"top.x": 1, "other.x": 2}, True), ({"top.x": 1, "top.y": 0.1}, False)):
            study = dict(STUDY, goals=[{"type": "mac", "mode": 1, "reference": "test", "at_least": 0.9}], references={"test": {"modes": [{"shape": shape}]}})
            doubts = self.found(self.put_study(base=study))[0]
            self.assertEqual([(d["kind"], d["pointer"]) for d in doubts], [("no_effect", "/goals/0")] if doubted else [], shape)

    def test_bounds_of_a_stiffness_below_0(self):
        self.put_model()
        for lower, doubted in ((-1, True), (0, False)):
            study = dict(STUDY, variables=[{"parameter": "k", "lower": lower, "upper": 20000, "scale": 1000}])
            doubts = self.found(self.put_study(base=study))[0]
            self.assertEqual([(d["kind"], d["pointer"]) for d in doubts], [("bounds", "/variables/0/lower")] if doubted else [])

    def test_a_damper_that_feeds_the_motion(self):
        for coefficient, told in ((-0.1, ["damper"]), (0.1, [])):
            damper = {"name": "d", "type": "torsion", "joint": "foot", "damping_n_m_s_per_rad": coefficient}
            doubts, facts = self.found(self.put_model(("dampers",), [damper]))
            self.assertEqual((doubts, [f["kind"] for f in facts]), ([], told))

    def test_a_joint_far_from_its_body(self):
        """A long arm with a short one at its end is no reason for a doubt; the same joint in other units is."""
        arms = {"format": "modetune-model/1", "dimension": 2,
                "bodies": [{"name": n, "mass_kg": 1, "inertia_kg_m2": 0.01, "centre": [x, 0]} for n, x in (("a", 0.5), ("b", 0.6))],
                "joints": [{"name": "hip", "type": "revolute", "bodies": ["ground", "a"], "at": [0, 0]},
                           {"name": "knee", "type": "revolute", "bodies": ["a", "b"], "at": [0.5, 0]}],
                "springs": [{"name": n, "type": "torsion", "joint": j, "stiffness_n_m_per_rad": 50} for n, j in (("s", "hip"), ("t", "knee"))]}
        for at, want in ((0, []), (-1.4, []), (-1.6, ["off"]), (-50, ["off"])):
            doubts, _ = self.found(self.put_model(("joints", 0, "at"), [at, 0], arms))
            self.assertEqual([d["kind"] for d in doubts], want, at)

    def test_a_limit_that_no_variable_changes(self):
        self.put_model(("parameters", "twice"), "2*m")
        for expression, doubted in (("twice", False), ("m + 0*k", False), ("k*0 + 3", True), ("sqrt(4)", True)):
            goals = [*STUDY["goals"], {"type": "limit", "expression": expression, "at_most": 1000}]
            doubts = self.found(self.put_study(("goals",), goals))[0]
            self.assertEqual([(d["kind"], d["pointer"]) for d in doubts], [("no_effect", "/goals/1")] if doubted else [], expression)

    def test_a_weight_that_is_forgotten(self):
        self.put_model(("sensors",), [{"name": "top", "on": "tip", "directions": ["x", "y"]}])
        modes = [{"frequency_hz": 5.2, "shape": {"top.x": 1, "top.y": 0.1}}, {"frequency_hz": 60}]
        frequency = {"type": "frequency", "mode": 1, "reference": "test"}
        shape = {"type": "shape", "mode": 1, "reference": "test", "weight": 1}
        rows = [([frequency, shape], True), ([dict(frequency, weight=1), shape], False), ([dict(frequency, tolerance_percent=1), shape], False),
                ([{"type": "frequency", "mode": 1, "target_hz": 5}, shape], False)]
        for goals, doubted in rows:
            study = dict(STUDY, goals=goals, references={"test": {"modes": modes}}, objective={"minimise": "misfit"})
            doubts, _ = self.found(self.put_study(base=study))
            self.assertEqual([(d["kind"], d["pointer"]) for d in doubts], [("weight", "/goals/0")] if doubted else [], goals)

    def test_no_doubt_of_the_very_large_and_the_very_small(self):
        """A ship and a resonator: the same two numbers of frequency and damping as any."""
        ship = {"format": "modetune-model/1", "dimension": 2, "gravity_m_per_s2": [0, -9.81],
                "bodies": [{"name": "hull", "mass_kg": 2e8, "inertia_kg_m2": 2e12, "centre": [200, 0]}],
                "springs": [{"name": n, "type": "bushing", "bodies": ["ground", "hull"], "at": [x, 0], "stiffness_n_per_m": [1e6, 1e8],
                             "stiffness_n_m_per_rad": 1e9} for n, x in (("bow", 400), ("stern", 0))]}
        chip = {"format": "modetune-model/1", "dimension": 2,
                "bodies": [{"name": "plate", "mass_kg": 1e-12, "inertia_kg_m2": 1e-22, "centre": [1e-5, 0]}],
                "springs": [{"name": n, "type": "bushing", "bodies": ["ground", "plate"], "at": [x, 0], "stiffness_n_per_m": [10, 10],
                             "stiffness_n_m_per_rad": 1e-9} for n, x in (("a", 0), ("b", 2e-5))]}
        for model in (ship, chip):
            self.assertEqual(self.found(self.put_model(base=model))[0], [])

    def test_what_is_accepted(self):
        base = changed(MODEL, ("links", 0, "density_kg_per_m3"), 5)
        self.assertEqual([d["kind"] for d in self.found(self.put_model(base=base))[0]], ["density"])
        path = self.put_model(base=dict(base, accepted=["density"]))
        doubts, facts = self.found(path)
        self.assertEqual((doubts, [f["kind"] for f in facts]), ([], ["density"]))
        self.assertTrue(facts[0]["text"].startswith('accepted: link "rod": density_kg_per_m3 (5) is below 10'), facts)
        self.assertNotIn("warning", self.expect(0, "check", path).stderr)
        self.assertIn("note: accepted: link", self.expect(0, "modes", path).stdout)
        # a study accepts for its model, too, and its own
        self.put_model(base=base)
        study = dict(changed(STUDY, ("goals", 0, "rotor", "margin_percent"), 0.1), accepted=["density", "margin"])
        doubts, facts = self.found(self.put_study(base=study))
        self.assertEqual((doubts, [f["kind"] for f in facts]), ([], ["margin", "density"]))
        text = self.run_program("run", "studies/s.json").stdout
        self.assertNotIn("Doubts", text)
        self.assertIn("accepted: margin_percent 0.1", text)
        done = self.expect(2, "check", self.put_model(base=dict(base, accepted=["densty"])))
        self.assertIn('/accepted/0: unknown warning "densty"; did you mean "density"?', done.stderr)

    def test_every_doubt_has_a_name_that_can_be_accepted(self):
        header = (SOURCE / "src/base/diagnostics.h").read_text(encoding="utf-8")
        names = re.findall(r'X\("(\w+)", "', header)
        self.assertEqual(names, sorted(names))
        used = set()
        for file in sorted((SOURCE / "src").glob("*/*.c")):
            used |= set(re.findall(r'MT_LEVEL_WARNING,\s*"(\w+)"', file.read_text(encoding="utf-8")))
        self.assertEqual(used - set(names), set())
        for schema in ("model", "study"):
            text = json.loads((SOURCE / f"schemas/{schema}.schema.json").read_text(encoding="utf-8"))
            self.assertEqual(text["properties"]["accepted"]["items"]["enum"], names)

    def test_joints_off_what_they_hold(self):
        _, facts = self.found(self.put_model(("joints", 0, "at"), [0.4, 0]))
        self.assertEqual([(f["kind"], f["text"], f["pointer"]) for f in facts],
                         [("off", 'joint "foot" lies 0.4 m off "rod.start"', "/joints/0/at")])
        doubts, _ = self.found(self.put_model(("joints", 0, "at"), [1.5, 0]))
        self.assertEqual([d["text"] for d in doubts], ['joint "foot" lies 1.5 m off "rod.start"; the whole link is 1 m long'])
        lumped = changed(MODEL, ("links", 0), {"name": "rod", "from": [0, 0], "to": [0, 1], "elements": 2, "mass_kg": 1,
                                               "stiffness_n_m_per_rad": 1e4, "element_length_m": [0.25, 0.75]})
        for at, want in (([0, 0.2], []), ([0, 0.5], ['joint "foot" lies 0.25 m off "rod.start"'])):
            _, facts = self.found(self.put_model(("joints", 0, "at"), at, lumped))
            self.assertEqual([f["text"] for f in facts], want)

    def test_the_farthest_is_said_first_and_gaps_with_both_distances(self):
        two = changed(MODEL, ("joints", 0, "at"), [0.3, 0])
        two = changed(two, ("joints", 1, "at"), [0.5, 1])
        _, facts = self.found(self.put_model(base=two))
        self.assertEqual([f["text"][:24] for f in facts], ['joint "weld" lies 0.5 m ', 'joint "foot" lies 0.3 m '])
        doubts, _ = self.found(self.put_model(("joints", 0, "at"), [[0, 0], [0.5, 0]]))
        gap = [d["text"] for d in doubts if d["kind"] == "gap"]
        self.assertRegex(gap[0], r'^joint "foot": its two points are drawn 0.5 m apart; .* \(to \d\.\de[-+]\d\d m\)$')

    def test_a_rod_that_spins_between_its_ball_joints_is_no_missing_joint(self):
        def body(name, x):
            return {"name": name, "mass_kg": 1, "inertia_kg_m2": [0.1, 0.2, 0.25], "centre": [x, 0.5, 0]}

        def ball(name, bodies, at):
            return {"name": name, "type": "spherical", "bodies": bodies, "at": at}

        crank = {"format": "modetune-model/1", "dimension": 3, "bodies": [body("crank", 0), body("rod", 1)],
                 "joints": [{"name": "pivot", "type": "revolute", "bodies": ["ground", "crank"], "at": [0, 0, 0], "axis": [0, 0, 1]},
                            ball("near", ["crank", "rod"], [0.2, 0.7, 0]), ball("far", ["rod", "ground"], [1.5, 0.9, 0.3])],
                 "springs": [{"name": "s", "type": "torsion", "joint": "pivot", "stiffness_n_m_per_rad": 10}], "configurations": {"c": {}}}
        two = changed(crank, ("bodies",), crank["bodies"] + [body("other", 2)])
        two = changed(two, ("joints",), crank["joints"] + [ball("a", ["crank", "other"], [0.3, 0.6, 0]), ball("b", ["other", "ground"], [2, 0.4, -0.5])])
        split = changed(crank, ("bodies",), crank["bodies"] + [body("half", 1.2)])
        split = changed(split, ("joints",), crank["joints"][:2] + [ball("far", ["half", "ground"], [1.5, 0.9, 0.3]), {
            "name": "weld", "type": "fixed", "bodies": ["rod", "half"], "at": [1, 0.8, 0.1]}])
        hanging = changed(crank, ("joints",), crank["joints"][:2])
        missing = "3 free motions: is a joint missing? Free to move: "
        for model, words in ((crank, '"rod" spins freely between its ball joints'), (two, 'free motions: "rod", "other" spin freely between their ball joints'),
                             (split, '"rod" spins freely between its ball joints'), (hanging, missing)):
            with self.subTest(words):
                path = self.put_model(base=model)
                for command in ("info", "modes"):
                    said = [f["text"] for f in self.json_of(command, path)[0]["facts"] if f["kind"] == "free_motion"]
                    self.assertEqual(len(said), 1)
                    self.assertIn(words, said[0])
                    self.assertEqual("missing" in said[0], words is missing)

    def test_rods_that_share_ball_joints_or_stand_beside_a_missing_one_are_told_as_such(self):
        """Rods that meet at one ball joint of a held crank, all on its point; a tripod of rods alone, which holds that point by its three
        lengths; two rods alone, which swing about the line through their feet; a door without a spring; nothing at the ground."""
        near, feet = [0.2, 0.7, 0], {"a": [1.5, 0.9, 0.3], "b": [1.5, -0.4, -0.5], "c": [0.5, -0.4, -1.5]}
        soft = {"type": "bushing", "at": [0, 0, 0], "stiffness_n_per_m": [1e4, 2e4, 3e4], "stiffness_n_m_per_rad": [100, 200, 300]}
        hold = dict(soft, name="h", bodies=["ground", "crank"])
        hinge = {"name": "hinge", "type": "revolute", "bodies": ["ground", "door"], "at": [1, 0.5, 0.2], "axis": [0, 0, 1]}

        def body(name):
            return {"name": name, "mass_kg": 1, "inertia_kg_m2": [0.1, 0.2, 0.25], "centre": [1, 0.5, 0.2]}

        def ball(one, other, at):
            return {"name": one + other, "type": "spherical", "bodies": [one, other], "at": at}

        def rods(names, *ends):
            return [ball(name, "ground", feet[name]) for name in names] + [ball(one, other, near) for one, other in ends]

        def model(bodies, joints, springs):
            return {"format": "modetune-model/1", "dimension": 3, "bodies": [body(b) for b in bodies], "joints": joints, "springs": springs,
                    "configurations": {"c": {}}}

        both = '"a", "b" spin freely between their ball joints'
        rows = [("two", model(["crank", "a", "b"], rods("ab", ("crank", "a"), ("a", "b")), [hold]), "2 free motions: " + both),
                ("three", model(["crank", "a", "b", "c"], rods("abc", ("crank", "a"), ("a", "b"), ("b", "c")), [hold]),
                 '3 free motions: "a", "b", "c" spin freely between their ball joints'),
                ("tripod", model(["a", "b", "c", "pump"], rods("abc", ("a", "b"), ("b", "c")), [dict(soft, name="h", bodies=["ground", "pump"])]),
                 '3 free motions: "a", "b", "c" spin freely between their ball joints'),
                ("bipod", model(["a", "b"], rods("ab", ("a", "b")), []), r'3 free motions: is a joint missing\? Free to move: "a" .*; ' + both),
                ("door", model(["crank", "a", "door"], [*rods("a", ("crank", "a")), hinge], [hold]),
                 r'2 free motions: is a joint missing\? Free to move: "door" \(rotation about z\); "a" spins freely between its ball joints'),
                ("afloat", model(["crank", "a", "b"], [ball("crank", "a", near), ball("a", "b", feet["a"])], [dict(hold, bodies=["crank", "b"])]),
                 '7 free motions: nothing holds it to the ground; "a" spins freely between its ball joints')]
        for name, base, words in rows:
            with self.subTest(name):
                _, facts = self.found(self.put_model(base=base))
                said = [f["text"] for f in facts if f["kind"] == "free_motion"]
                self.assertEqual(len(said), 1)
                self.assertRegex(said[0], f"^{words}$")

    def test_what_is_in_another_unit_than_its_member_is_doubted(self):
        """Powers of single parameters, products and roots; what a number without a unit may stand for is not judged."""
        base = changed(MODEL, ("parameters",), {**MODEL["parameters"], "c": {"value": 100, "unit": "N/m"}, "L": {"value": 0.5, "unit": "m"}, "u": 3,
                                                "w": {"value": 30, "unit": "rad/s"}, "E": {"value": 2e11, "unit": "Pa"}, "n": {"value": 0.5, "unit": "1"}})
        stiffness, mass, end = ("springs", 0, "stiffness_n_m_per_rad"), ("bodies", 0, "mass_kg"), ("bodies", 0, "centre", 1)
        line = {"name": "line", "type": "axial", "bodies": ["ground", "tip"], "at": [[1, 0], [0, 1]], "stiffness_n_per_m": 10}
        lined = changed(base, ("springs",), [*MODEL["springs"], line])
        axial = ("springs", 1, "stiffness_n_per_m")
        per, is_in = '"stiffness_n_m_per_rad" in N m/rad', "this expression is in "
        rows = [(stiffness, "c", f'"c" is in N/m, and {per}'), (stiffness, "-c", f'"c" is in N/m, and {per}'), (stiffness, "k", None),
                (stiffness, "c*L", f"{is_in}N, and {per}"), (stiffness, "c*L^2", None), (stiffness, "2*c*L*L/3", None), (stiffness, "c*0.25", None),
                (stiffness, "40*c", None), (stiffness, "c*u", None), (stiffness, "max(c, 1)", f"{is_in}N/m, and {per}"),
                (stiffness, "c*sin(1)", f"{is_in}N/m, and {per}"), (stiffness, "E*L^4/12/L", None), (stiffness, "E*pi*L^2", f"{is_in}N, and {per}"),
                (stiffness, "sqrt(c*m)*w*L^2", None), (stiffness, "sqrt(c*m)*w*L", f"{is_in}N, and {per}"), (stiffness, "m*w^2*L^4", f"{is_in}m^4 kg^1 s^-2, and {per}"),
                (mass, "L", '"L" is in m, and "mass_kg" in kg'), (mass, "1000*mm", f'{is_in}m, and "mass_kg" in kg'), (mass, "m*n", None), (mass, "2*n", None),
                (mass, "cbrt(m*m*m)", None), (mass, "abs(-m)*2^0.5", None), (end, "2*L", None), (end, "1 + 0*L", None), (end, "m", '"m" is in kg, and "centre" in m'),
                (("parameters", "f"), {"value": "w", "unit": "Hz"}, '"w" is in rad/s, and "f" in Hz'), (("parameters", "f"), {"value": "w/(2*pi)", "unit": "Hz"}, None),
                (("parameters", "f"), {"value": "60*rpm", "unit": "rad/s"}, None), (("configurations",), {"a": {"parameters": {"k": "c"}}}, '"c" is in N/m, and "k" in N m/rad'),
                (axial, "k", '"k" is in N m/rad, and "stiffness_n_per_m" in N/m'), (axial, "k/L^2", None), (axial, "E*(20*mm)^2/(1500*mm)", None)]
        for path, value, words in rows:
            with self.subTest(value):
                doubts, _ = self.found(self.put_model(path, value, lined))
                self.assertEqual([d["text"] for d in doubts if d["kind"] == "unit"], [words] if words else [])
        # A mass that is a number may be a factor of the inertia, or the 1 that nobody writes; a mass that is a parameter is missing.
        wanted = 'and "inertia_kg_m2" in kg m^2'
        rows = [("m", "L^2/12", f"{is_in}m^2, {wanted}"), ("m", "m*L^2/12", None), ("m", "m*L", f"{is_in}kg m, {wanted}"), (1, "L^2/12", None), ("1", "L^2/12", None),
                (3, "3*L^2/12", None), (2.5, "L^2/12", None), (1, "L^2*(1/12 + 1/4)", None), (1, "L", '"L" is in m, ' + wanted), (1, "L*L*L/12", f"{is_in}m^3, {wanted}"),
                (1, "c*L^2", f"{is_in}N m, {wanted}"), (1, "m*m*L^2", f"{is_in}m^2 kg^2, {wanted}"), ("1 + 0*m", "L^2/12", f"{is_in}m^2, {wanted}")]
        for mass_is, inertia, words in rows:
            with self.subTest(f"mass {mass_is}, inertia {inertia}"):
                doubts, _ = self.found(self.put_model(("bodies", 0), {"name": "tip", "mass_kg": mass_is, "inertia_kg_m2": inertia, "centre": [0, 1]}, base))
                self.assertEqual([d["text"] for d in doubts if d["kind"] == "unit"], [words] if words else [])
        self.assertIn(': warning: /springs/0/stiffness_n_m_per_rad: "c" is in N/m', self.expect(0, "check", self.put_model(stiffness, "c", base)).stderr)
        self.assertEqual(self.found(self.put_model(stiffness, "c", changed(base, ("accepted",), ["unit"])))[0], [])

    def test_damping_ratios_of_more_modes_than_there_are_are_a_fault(self):
        """A row of three masses, held by a spring or afloat: as many vibration modes as masses, or one less."""
        masses = [{"name": f"m{i}", "mass_kg": 1, "centre": [i, 0]} for i in range(1, 4)]
        joints = [{"name": f"g{i}", "type": "pin-in-slot", "bodies": ["ground", f"m{i}"], "at": [i, 0], "axis": [1, 0]} for i in range(1, 4)]
        springs = [{"name": f"s{i}", "type": "axial", "bodies": ["ground" if i == 1 else f"m{i - 1}", f"m{i}"], "at": [[i - 1, 0], [i, 0]], "stiffness_n_per_m": 1000}
                   for i in range(1, 4)]
        for held, modes in ((True, 3), (False, 2)):
            for n in (1, 2, 3, 4, 5):
                with self.subTest(f"held {held}, {n} ratios"):
                    base = {"format": "modetune-model/1", "dimension": 2, "bodies": masses, "joints": joints, "springs": springs if held else springs[1:],
                            "configurations": {"row": {"damping": {"ratios": [0.01 * (k + 1) for k in range(n)]}}}}
                    done = self.run_program("check", self.put_model(base=base), "--format", "json")
                    said = f'damping lists ratios for {n} vibration modes, but configuration "row" has {modes}'
                    self.assertEqual(said in done.stdout + done.stderr, n > modes, done.stdout + done.stderr)

    def test_freedoms_come_first_and_in_words(self):
        loose = changed(MODEL, ("springs",), None)
        floating = changed(loose, ("joints", 0), {"name": "foot", "type": "fixed", "bodies": ["rod.end", "tip"], "at": [0, 1]})
        falling = changed(dict(MODEL, gravity_m_per_s2=[0, -9.81]), ("springs", 0, "stiffness_n_m_per_rad"), 1)
        held_twice = changed(MODEL, ("joints",), MODEL["joints"] + [dict(MODEL["joints"][0], name="again")])
        rows = [("loose", loose, "free_motion", "1 free motion: is a joint missing? Free to move: "),
                ("floating", floating, "free_motion", "3 free motions: nothing holds it to the ground"),
                ("falling", falling, "unstable", "the equilibrium is unstable in 1 direction, moving "),
                ("twice", held_twice, "redundant", 'redundant: 2 equations of "foot", "again" change nothing')]
        for name, base, kind, words in rows:
            with self.subTest(name):
                path = self.put_model(base=base)
                doubts, facts = self.found(path)
                self.assertEqual(doubts, [])
                mine = [f for f in facts if f["kind"] == kind]
                self.assertEqual(len(mine), 1, facts)
                self.assertTrue(mine[0]["text"].startswith(words), mine[0]["text"])
                self.assertEqual(mine[0]["configuration"], "default")
                for command in ("info", "modes"):
                    lines = self.expect(0, command, path).stdout.splitlines()
                    self.assertIn(f"  note: {mine[0]['text']}", lines[1:3])
                    self.assertIn(mine[0]["text"], [f["text"] for f in self.json_of(command, path)[0]["facts"]])

    def bounds(self, lower, upper, limit=None, model=None):
        """What `check` says of a tube whose diameters are variables."""
        tube = {"shape": "tube", "outer_diameter_m": "outer", "inner_diameter_m": "inner"}
        base = changed(model or MODEL, ("links", 0, "section"), tube)
        base["parameters"].update(outer=0.03, inner=0.02)
        self.put_model(base=base)
        goals = [{"type": "frequency", "mode": 1, "at_least_hz": 1}]
        goals += [{"type": "limit", "expression": "outer-inner", "at_least": limit}] if limit else []
        return self.put_study(base=dict(STUDY, goals=goals, variables=[{"parameter": "outer", "lower": lower[0], "upper": upper[0]},
                                                                      {"parameter": "inner", "lower": lower[1], "upper": upper[1]}]))

    def test_bounds_at_which_nothing_can_be_built(self):
        done = self.expect(2, "check", self.bounds((0, 0.01), (0.04, 0.021)))
        self.assertRegex(done.stderr, r'studies/s\.json:1:\d+: error: /variables/0/lower: with outer at 0, link "rod": '
                                      r'section/outer_diameter_m \(0\) must be above 0\n')
        done = self.expect(2, "check", self.bounds((0.025, 0.01), (0.04, 0.031)))
        self.assertRegex(done.stderr, r'error: /variables/1/upper: with inner at 0\.031, link "rod": section/inner_diameter_m \(0\.031\) '
                                      r'must be below outer_diameter_m \(0\.03\)')
        # only both together are impossible: a warning, which a limit takes away
        done = self.expect(0, "check", self.bounds((0.022, 0.01), (0.04, 0.028)))
        self.assertRegex(done.stderr, r'warning: /variables/0: with outer at 0\.022 and inner at 0\.028, link "rod": .* a goal of type "limit"')
        self.assertEqual(self.expect(0, "check", self.bounds((0.022, 0.01), (0.04, 0.028), limit=0.002)).stderr, "")
        self.assertEqual(self.expect(0, "check", self.bounds((0.025, 0.01), (0.04, 0.0249))).stderr, "")
        # an override that takes the place of the variable, in all that the study asks of
        held = dict(MODEL, configurations={"a": {"parameters": {"outer": 0.05}}, "b": {}})
        both = self.bounds((0, 0.01), (0.04, 0.021), model=held)
        for name, code in (("a", 0), ("b", 2)):
            study = json.loads((self.folder / both).read_text(encoding="utf-8"))
            study["goals"][0]["configuration"] = name
            study["variables"] = [study["variables"][0], {"parameter": "k", "lower": 1000, "upper": 3000}]
            study["goals"].append({"type": "limit", "expression": "outer", "at_most": 1})
            self.expect(code, "check", self.put_study(base=study))

    def test_set_makes_no_impossible_model(self):
        path = self.put_model()
        for command in ("info", "modes", "sensitivity"):
            done = self.expect(2, command, path, "--set", "m=-1")
            self.assertEqual(done.stderr, 'modetune: error: --set: body "tip": mass_kg (-1) must not be negative\n')
            self.expect(0, command, path, "--set", "m=0.1")

    def test_a_drive_that_is_inherited_is_doubted_once(self):
        there = {"joint": "foot", "position_rad": 20}
        base = dict(MODEL, configurations={"plain": {}, "up": {"drive": there}, "light": {"like": "up", "parameters": {"m": 0.5}}})
        doubts, _ = self.found(self.put_model(base=base))
        self.assertEqual([(d["text"], d["pointer"]) for d in doubts if d["kind"] == "drive"],
                         [('"foot" is driven by 20 rad, more than a turn: degrees are written "20*deg"',
                           "/configurations/up/drive/position_rad")])
        goals = [{"type": "frequency", "configuration": "light", "mode": 1, "at_least_hz": 1}]
        self.assertIn("drive", [d["kind"] for d in self.found(self.put_study(base=dict(STUDY, goals=goals, variables=STUDY["variables"][:1])))[0]])

    def test_compare_says_doubts_too(self):
        self.put_model()
        asked = dict(changed(STUDY, ("goals", 0, "rotor", "margin_percent"), 0.1), published=[{"status": "solved"}])
        lines = self.expect(0, "compare", self.put_study(base=asked)).stdout.splitlines()
        self.assertEqual(lines[2], "Warnings of the model and the study")
        self.assertEqual([d["kind"] for d in self.json_of("compare", "studies/s.json")["doubts"]], ["margin"])

    def test_a_doubt_takes_no_proof_from_the_points_of_a_trade(self):
        self.put_model()
        trade = {"vary": [{"goal": 0, "member": "margin_percent", "values": [5, 10]}]}
        for margin, proven in ((10, True), (0.1, True)):
            study = dict(changed(STUDY, ("goals", 0, "rotor", "margin_percent"), margin), trade=trade)
            result = self.json_of("run", self.put_study(base=study))
            grades = {p["best"]["grade"] for p in result["trade"]["points"]}
            self.assertEqual("feasible and proven" in grades, proven)

    def test_a_stroke_longer_than_the_drawing(self):
        slide = {"name": "foot", "type": "prismatic", "bodies": ["ground", "rod.start"], "at": [0, 0], "axis": [1, 0]}
        spring = {"name": "hold", "type": "axial", "bodies": ["ground", "rod.start"], "at": [[-1, 0], [0, 0]], "stiffness_n_per_m": "k*0.5"}
        base = dict(MODEL, joints=[slide, MODEL["joints"][1]], springs=[spring])
        for position, want in ((20, ["drive"]), (0.02, [])):
            base["configurations"] = {"out": {"drive": {"joint": "foot", "position_m": position}}}
            self.assertEqual([d["kind"] for d in self.found(self.put_model(base=base))[0]], want)

    def test_a_sweep_beyond_a_turn_warns(self):
        path = self.put_model()
        warning = 'modetune: warning: --drive: foot goes to 10 rad, more than a turn: degrees are written "10*deg"\n'
        self.assertEqual(self.expect(0, "sweep", path, "--drive", "foot=-1:10:3").stderr, warning)
        self.assertEqual(self.expect(0, "sweep", path, "--drive", "foot=-10*deg:6:3").stderr, "")

    def test_an_unstable_configuration_is_told_with_its_goals(self):
        self.put_model(("springs", 0, "stiffness_n_m_per_rad"), -5)
        _, facts = self.found(self.put_study())
        self.assertEqual([f["kind"] for f in facts], ["unstable"])
        self.assertTrue(facts[0]["text"].endswith("; goals name it, and none of them is met by a design that does so"))

    def test_bands_of_what_cannot_vibrate(self):
        rigid = changed(MODEL, ("springs",), None)
        rigid["links"] = [dict(MODEL["links"][0], kind="rigid_elements", elements=1)]
        rigid["joints"] = [MODEL["joints"][0], dict(MODEL["joints"][1])]
        self.put_model(base=rigid)
        study = dict(STUDY, variables=STUDY["variables"][1:])
        doubts, facts = self.found(self.put_study(base=study))
        self.assertEqual([d["kind"] for d in doubts], ["no_effect"])
        self.assertIn("there is no vibration mode at all", doubts[0]["text"])
        self.assertEqual([f["kind"] for f in facts], ["free_motion"])
        # a spring that is 0 in the original gives it one, the bands have an effect
        held = dict(MODEL, links=rigid["links"], parameters=dict(MODEL["parameters"], k=0))
        self.put_model(base=held)
        study = dict(STUDY, variables=[{"parameter": "k", "lower": 0, "upper": 20000, "scale": 1000}])
        self.assertEqual(self.found(self.put_study(base=study))[0], [])

    def test_the_model_of_a_reference_is_judged(self):
        self.put_model()
        goals = [{"type": "frequency", "mode": 1, "reference": "fe"}]
        study = dict(STUDY, goals=goals, references={"fe": {"model": "../problems/fe.json", "configuration": "default"}})
        for modulus, want in ((2.1e5, [("modulus", "../problems/fe.json")]), (2.1e11, [])):
            self.write_json("problems/fe.json", changed(MODEL, ("links", 0, "youngs_modulus_pa"), modulus))
            self.assertEqual([(d["kind"], d["file"]) for d in self.found(self.put_study(base=study))[0]], want)

    def test_a_negative_spring_is_allowed(self):
        doubts, facts = self.found(self.put_model(("springs", 0, "stiffness_n_m_per_rad"), -5))
        self.assertEqual((doubts, [f["kind"] for f in facts]), ([], ["unstable"]))

    def test_run_says_the_doubt_first_and_what_is_proven(self):
        self.put_model()
        asked = changed(STUDY, ("goals", 0, "rotor", "speed_range"), [95, 105])
        done = self.run_program("run", self.put_study(base=asked))
        lines = done.stdout.splitlines()
        self.assertTrue(lines[1].startswith("Solved: 1 of "), lines[1])
        self.assertEqual(lines[3], "Warnings of the model and the study")
        self.assertRegex(lines[4], r"^  - s\.json:1:\d+: /goals/0/rotor/speed_range: speed_range \[95, 105\] .*\[0\.95, 1\.05\] is meant\?$")
        self.assertRegex(done.stderr, r"studies/s\.json:1:\d+: warning: /goals/0/rotor/speed_range: ")
        result = json.loads((self.folder / "results/s/result.json").read_text(encoding="utf-8"))
        self.assertEqual(result["status_text"], lines[1])
        self.assertEqual([d["kind"] for d in result["doubts"]][0], "speed_range")
        page = (self.folder / "results/s/report.html").read_text(encoding="utf-8")
        self.assertLess(page.index("<h2>Warnings of the model and the study</h2>"), page.index("<h2>Parameters</h2>"))
        good = self.expect(0, "run", self.put_study())
        self.assertIn("feasible and proven", good.stdout)
        self.assertNotIn("oubt", good.stdout)

    def test_facts_of_the_model_stand_at_the_top_of_run(self):
        self.put_model(("joints", 0, "at"), [0.4, 0])
        lines = self.expect(0, "run", self.put_study()).stdout.splitlines()
        self.assertEqual(lines[3:5], ["Notes on the model", '  - default: joint "foot" lies 0.4 m off "rod.start"'])

    def test_what_turns_and_is_a_body_is_at_rest_in_the_modes(self):
        self.put_model()
        gear = {"name": "tip", "ratio": 2, "teeth": 20, "orders": ["1G"]}
        for goal, told in ((machine(name="tip", speed_hz=30), True), (machine(name="engine", speed_hz=30, gears=[gear]), True),
                           ({"type": "avoid", "rotor": dict(ROTOR, name="tip")}, True), (machine(name="engine", speed_hz=30), False)):
            self.expect(0, "run", self.put_study(("goals", 0), goal), "--starts", "2")
            warnings = json.loads((self.folder / "results/s/result.json").read_text(encoding="utf-8"))["warnings"]
            said = [w for w in warnings if w.startswith('/goals/0: body "tip" turns, and the modes are those of the mechanism at rest')]
            self.assertEqual(len(said), 1 if told else 0, (goal, warnings))

    def test_a_band_that_is_cut_off_whole_is_an_error(self):
        self.put_model()
        done = self.expect(2, "run", self.put_study(("goals", 0), {"type": "avoid", "bands_hz": [[9, 11]], "up_to_hz": 5}))
        self.assertIn("/goals/0/up_to_hz: no band lies below up_to_hz (5)", done.stderr)


if __name__ == "__main__":
    main()

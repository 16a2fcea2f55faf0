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
        for margin, want in ((0.1, ["margin"]), (5, [])):
            vary = [{"goal": 0, "member": "margin_percent", "values": [margin, 10]}]
            doubts, _ = self.found(self.put_study(("trade",), {"vary": vary}))
            self.assertEqual([d["kind"] for d in doubts], want)

    def test_values_of_a_model(self):
        section = ("links", 0, "section", "diameter_m")
        drive = {"x": {"drive": {"joint": "foot", "position_rad": 20}}}
        turned = {"x": {"drive": {"joint": "foot", "position_rad": "20*deg"}}}
        rows = [  # path, doubted, kind, near miss
            (("links", 0, "youngs_modulus_pa"), 2.1e5, "modulus", 2e6),
            (("links", 0, "youngs_modulus_pa"), 2.1e14, "modulus", 9e12),
            (("links", 0, "density_kg_per_m3"), 7.85e-9, "density", 1.2),
            (("links", 0, "density_kg_per_m3"), 7.85e6, "density", 2.2e4),
            (section, 20, "section", 0.2),
            (section, 2e-7, "section", 2e-3),
            (("bodies", 0, "inertia_kg_m2"), 1e4, "inertia", 100),
            (("bodies", 0, "mass_kg"), 2e6, "mass", 9e5),
            (("springs", 0, "stiffness_n_m_per_rad"), 1e-11, "frequency", 1e-3),
            (("links", 0, "to"), [0, 500], "size", [0, 1]),
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

    def test_freedoms_come_first_and_in_words(self):
        loose = changed(MODEL, ("springs",), None)
        floating = changed(loose, ("joints", 0), {"name": "foot", "type": "fixed", "bodies": ["rod.end", "tip"], "at": [0, 1]})
        falling = changed(dict(MODEL, gravity_m_per_s2=[0, -9.81]), ("springs", 0, "stiffness_n_m_per_rad"), 1)
        held_twice = changed(MODEL, ("joints",), MODEL["joints"] + [dict(MODEL["joints"][0], name="again")])
        rows = [("loose", loose, "free_motion", "1 free motion: is a joint missing? Free to move: "),
                ("floating", floating, "free_motion", "3 free motions: nothing holds it to the ground"),
                ("falling", falling, "unstable", "unstable in 1 direction: it falls over from here, moving "),
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
        self.assertEqual(lines[2], "Doubts")
        self.assertEqual([d["kind"] for d in self.json_of("compare", "studies/s.json")["doubts"]], ["margin"])

    def test_points_of_a_trade_are_not_proven_either(self):
        self.put_model()
        trade = {"vary": [{"goal": 0, "member": "margin_percent", "values": [5, 10]}]}
        for margin, proven in ((10, True), (0.1, False)):
            study = dict(changed(STUDY, ("goals", 0, "rotor", "margin_percent"), margin), trade=trade)
            result = self.json_of("run", self.put_study(base=study))
            grades = {p["best"]["grade"] for p in result["trade"]["points"]}
            self.assertEqual("feasible and proven" in grades, proven)

    def test_a_stroke_longer_than_the_drawing(self):
        slide = {"name": "foot", "type": "prismatic", "bodies": ["ground", "rod.start"], "at": [0, 0], "axis": [1, 0]}
        spring = {"name": "hold", "type": "axial", "bodies": ["ground", "rod.start"], "at": [[-1, 0], [0, 0]], "stiffness_n_per_m": "k"}
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

    def test_run_says_the_doubt_first_and_proves_nothing(self):
        self.put_model()
        asked = changed(STUDY, ("goals", 0, "rotor", "speed_range"), [95, 105])
        done = self.run_program("run", self.put_study(base=asked))
        lines = done.stdout.splitlines()
        self.assertTrue(lines[1].startswith("Doubtful question (speed_range [95, 105] says 95 to 105 times the rotor's speed: "), lines[1])
        self.assertEqual(lines[3], "Doubts")
        self.assertRegex(lines[4], r"^  - s\.json:1:\d+: /goals/0/rotor/speed_range: speed_range \[95, 105\] .*\[0\.95, 1\.05\] is meant\?$")
        self.assertNotIn("feasible and proven", done.stdout)
        self.assertEqual(re.findall(r"(?m)^  - proven: ", done.stdout), [])
        self.assertRegex(done.stderr, r"studies/s\.json:1:\d+: warning: /goals/0/rotor/speed_range: ")
        result = json.loads((self.folder / "results/s/result.json").read_text(encoding="utf-8"))
        self.assertTrue(result["status_text"].startswith("Doubtful question ("))
        self.assertEqual([d["kind"] for d in result["doubts"]][0], "speed_range")
        self.assertNotIn("feasible and proven", [r["grade"] for r in result["recommendations"]])
        page = (self.folder / "results/s/report.html").read_text(encoding="utf-8")
        self.assertLess(page.index("<h2>Doubts</h2>"), page.index("<h2>Parameters</h2>"))
        good = self.expect(0, "run", self.put_study())
        self.assertIn("feasible and proven", good.stdout)
        self.assertNotIn("oubt", good.stdout)

    def test_facts_of_the_model_stand_at_the_top_of_run(self):
        self.put_model(("joints", 0, "at"), [0.4, 0])
        lines = self.expect(0, "run", self.put_study()).stdout.splitlines()
        self.assertEqual(lines[3:5], ["Facts of the model", '  - default: joint "foot" lies 0.4 m off "rod.start"'])

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

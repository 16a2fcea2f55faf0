# SPDX-License-Identifier: GPL-3.0-or-later
"""Units of input and display: shipped files rewritten into millimetres, inches, degrees and turns per minute say the same, to the last digit;
what is shown is in the units that were given; what looks like a number of another unit is refused. MT_EVERY=1: every quick study in two ways and every model in all
of them, else each in one way, in turn, and no study of more than a sixth of a second."""
import copy
import csv
import json
import math
import re
import shutil
import struct
from fractions import Fraction
from pathlib import Path

from common_cli import SOURCE, CliTest, main
from suite import EVERY, FEW

# 1 of it in SI, as the program computes it: number * numerator / denominator.
UNITS = {"mm": (1.0, 1000.0), "cm": (1.0, 100.0), "in": (254.0, 10000.0), "ft": (3048.0, 10000.0), "deg": (math.pi / 180.0, 1.0),
         "rpm": (1.0, 60.0)}
SI = {"mm": "m", "cm": "m", "in": "m", "ft": "m", "deg": "rad", "rpm": "Hz"}
DIMENSION = {"m": "length", "rad": "angle", "Hz": "speed"}
WAYS = [{"length": "mm", "angle": "deg", "speed": "rpm"}, {"length": "in", "angle": "deg", "speed": "rpm"}, {"length": "ft"}, {"length": "cm"}]
SECONDS = {"inceptor_identification", "inceptor_rotor", *(("beam_identification", "inceptor_tuning_2", "truss_10bar_E68_9") if FEW else ())}
QUICK = ["beam_identification", "beam_table_3", "engine_orders", "inceptor_identification", "inceptor_rotor", "inceptor_stick",
         "inceptor_tuning_1", "inceptor_tuning_2", "six_masses_bands", "truss_10bar_E68_9"]
# Exact factors by definition: pound, inch, gravity (a pound of force is their product), foot, slug; a degree to thirty digits.
LB, INCH, G, FT = Fraction("0.45359237"), Fraction("0.0254"), Fraction("9.80665"), Fraction("0.3048")
LBF, SLUG, DEG = LB * G, LB * G / FT, Fraction("3.14159265358979323846264338328") / 180
EXACT = {"N/mm": 1000, "kN/m": 1000, "kN/mm": 10 ** 6, "N/um": 10 ** 6, "MPa": 10 ** 6, "GPa": 10 ** 9, "kPa": 1000, "N/mm^2": 10 ** 6,
         "g": Fraction(1, 1000), "t": 1000, "lb": LB, "oz": LB / 16, "slug": SLUG, "lbf s^2/in": LBF / INCH, "kg mm^2": Fraction(1, 10 ** 6),
         "g cm^2": Fraction(1, 10 ** 7), "g mm^2": Fraction(1, 10 ** 9), "kg cm^2": Fraction(1, 10 ** 4), "t mm^2": Fraction(1, 1000),
         "lb in^2": LB * INCH ** 2, "lb ft^2": LB * FT ** 2, "slug ft^2": SLUG * FT ** 2, "lbf in s^2": LBF * INCH, "N mm": Fraction(1, 1000),
         "N mm/rad": Fraction(1, 1000), "N m/deg": 1 / DEG, "N mm/deg": 1 / DEG / 1000, "kip": 1000 * LBF, "lbf": LBF, "psi": LBF / INCH ** 2,
         "ksi": 1000 * LBF / INCH ** 2, "lbf/in": LBF / INCH, "lbf/ft": LBF / FT, "kip/in": 1000 * LBF / INCH, "lbf in": LBF * INCH,
         "lbf ft": LBF * FT, "lbf in/rad": LBF * INCH, "lbf ft/rad": LBF * FT, "lbf in/deg": LBF * INCH / DEG, "g/cm^3": 1000,
         "t/mm^3": 10 ** 12, "lb/in^3": LB / INCH ** 3, "lb/ft^3": LB / FT ** 3, "slug/ft^3": SLUG / FT ** 3, "mm^2": Fraction(1, 10 ** 6),
         "mm^4": Fraction(1, 10 ** 12), "in^2": INCH ** 2, "in^4": INCH ** 4, "N s/mm": 1000, "lbf s/in": LBF / INCH, "mm/s^2": Fraction(1, 1000),
         "um": Fraction(1, 10 ** 6), "mrad": Fraction(1, 1000), "kHz": 1000, "ms": Fraction(1, 1000), "%": Fraction(1, 100), "in": INCH, "ft": FT,
         "mm": Fraction(1, 1000), "cm": Fraction(1, 100), "deg": DEG, "rpm": Fraction(1, 60), "kN": 1000, "kN m": 1000, "deg/s": DEG,
         "in/s^2": INCH, "kg/mm": 1000, "g/mm": 1, "lb/in": LB / INCH, "lb/ft": LB / FT}
# What tells people, or of files, and which unit that was shown in; it may differ, all else may not.
TOLD = {"quantity", "display_unit", "display_factor", "text", "reasons", "inputs", "outputs", "demand", "label", "unit", "goal", "what", "line", "column"}


def neighbours(x):
    bits = struct.unpack("<q", struct.pack("<d", x))[0]
    return [struct.unpack("<d", struct.pack("<q", bits + k))[0] for k in (0, 1, -1, 2, -2)] if x else [0.0]


def number(value, unit):
    """A number of this unit that means exactly this value, or None."""
    up, down = UNITS[unit]
    guess = float(Fraction(value) * Fraction(down) / Fraction(up))
    return next((x for x in neighbours(guess) if x * up / down == value), None)


def plain(x):
    return isinstance(x, (int, float)) and not isinstance(x, bool)


def constant(value):
    """The number that an expression without parameters is."""
    if isinstance(value, str) and not re.search(r"[A-Za-z_]", re.sub(r"sqrt|pi|deg", "", value)):
        return eval(value.replace("^", "**"), {"sqrt": math.sqrt, "pi": math.pi, "deg": math.pi / 180})
    return value


class Rewriter:
    """Files in other units. LookupError: a number has none in them that means exactly the same."""

    def __init__(self, way):
        self.way, self.turned = way, 0

    def value(self, x, unit):
        if not plain(x) or x == 0:
            return x
        out = number(x, unit)
        if out is None:
            raise LookupError(f"{x} has no number in {unit}")
        self.turned += 1
        return out

    def coordinates(self, v):
        return [self.coordinates(x) for x in v] if isinstance(v, list) else self.value(v, self.way["length"])

    def model(self, model):
        model = copy.deepcopy(model)
        model["units"] = dict(self.way)
        for p in model.get("parameters", {}).values():
            dimension = DIMENSION.get(p.get("unit")) if isinstance(p, dict) else None
            if dimension in self.way:
                value = constant(p["value"])
                if plain(value) and (value == 0 or number(value, self.way[dimension]) is not None):
                    p["value"] = self.value(value, self.way[dimension])
                    p["unit"] = self.way[dimension]
        for point, x in model.get("points", {}).items():
            model["points"][point] = self.coordinates(x)
        for items, members in (("bodies", ["centre"]), ("links", ["from", "to"]), ("joints", ["at"]), ("springs", ["at"]), ("dampers", ["at"]),
                               ("loads", ["at"]), ("sensors", ["at"])):
            for item in model.get(items, []):
                for member in members:
                    if isinstance(item.get(member), list):
                        item[member] = self.coordinates(item[member])
        for c in model.get("configurations", {}).values():
            for name, x in c.get("parameters", {}).items():
                p = model["parameters"][name]
                if isinstance(p, dict) and p.get("unit") in UNITS and plain(x):
                    c["parameters"][name] = self.value(x, p["unit"])
        return model

    def study(self, study, model):
        study = copy.deepcopy(study)
        study["units"] = dict(self.way)

        def unit(name):
            p = model["parameters"].get(name)
            own = p.get("unit") if isinstance(p, dict) else None
            return self.way.get(DIMENSION.get(SI.get(own, own)))

        def turn(o, members, name):
            for member in members:
                if unit(name) and plain(o.get(member)):
                    o[member] = self.value(o[member], unit(name))
                elif unit(name) and isinstance(o.get(member), list):
                    o[member] = [self.value(x, unit(name)) for x in o[member]]

        for v in study.get("variables", []):
            turn(v, ["lower", "upper", "scale", "catalogue"], v["parameter"])
        for p in study.get("published", []):
            if "parameter" in p:
                turn(p, ["value", "tolerance", "at_least", "at_most"], p["parameter"])
        for v in study.get("trade", {}).get("vary", []):
            turn(v, ["values"], v.get("variable", v.get("parameter", "")))
            if isinstance(v.get("values"), dict):
                turn(v["values"], ["from", "to"], v.get("variable", v.get("parameter", "")))
        return study


def bare(value):
    """Without what is told to people."""
    if isinstance(value, dict):
        return {k: bare(v) for k, v in value.items() if k not in TOLD}
    return [bare(v) for v in value] if isinstance(value, list) else value


class Twins(CliTest):
    def models(self):
        for path in sorted((SOURCE / "problems").glob("*.json")):
            model = json.loads(path.read_text())
            if model.get("format") == "modetune-model/1" and not (FEW and path.stem == "beam_reference"):  # the largest
                yield path, model

    def test_every_shipped_model_has_the_same_modes(self):
        done = 0
        for i, (path, model) in enumerate(self.models()):
            self.write(f"problems/{path.name}", json.dumps(model))
            wanted = self.run_program("modes", f"problems/{path.name}", "--count", "all", "--format", "json")
            for way in WAYS if EVERY else WAYS[i % len(WAYS):][:1]:
                try:
                    rewriter = Rewriter(way)
                    twin = self.write(f"problems/{path.name}", json.dumps(rewriter.model(model)))
                except LookupError:
                    continue
                with self.subTest(model=path.name, way=way):
                    got = self.run_program("modes", twin, "--count", "all", "--format", "json")
                    self.assertEqual(got.returncode, wanted.returncode, got.stderr)
                    self.assertEqual(bare(json.loads(got.stdout)), bare(json.loads(wanted.stdout)))
                    done += rewriter.turned > 0
        self.assertGreater(done, 12 if EVERY else 3)
        print(f"units: {done} twins of models")

    def test_every_quick_study_has_the_same_answer(self):
        done = 0
        shutil.copytree(SOURCE / "problems", self.folder / "problems", dirs_exist_ok=True)
        for i, name in enumerate(QUICK):
            if name in SECONDS and not EVERY:
                continue
            study = json.loads((SOURCE / "studies" / f"{name}.json").read_text())
            model = json.loads((SOURCE / "studies" / study["model"]).read_text())
            study["model"] = f"../problems/{Path(study['model']).name}"
            answers = []
            for way in [None, WAYS[0], WAYS[1]] if EVERY else [None, WAYS[i % 2]]:
                try:
                    new = model if way is None else Rewriter(way).model(model)
                    asked = study if way is None else Rewriter(way).study(study, new)
                except LookupError:
                    continue
                self.write(f"problems/{Path(study['model']).name}", json.dumps(new))
                path = self.write(f"studies/{name}.json", json.dumps(asked))
                got = self.run_program("run", path, "-o", "out")
                with self.subTest(study=name, way=way):
                    self.assertIn(got.returncode, (0, 1, 3), got.stderr)
                    answers.append(bare(json.loads((self.folder / "out" / name / "result.json").read_text())))
                    self.assertEqual(answers[-1], answers[0])
                    done += way is not None
        self.assertGreater(done, 10 if EVERY else 4)
        print(f"units: {done} twins of studies")


STICK = {
    "format": "modetune-model/1", "dimension": 2, "units": {"length": "mm", "angle": "deg"},
    "parameters": {"k": {"value": 3000, "unit": "N m/rad"}, "d": {"value": 170, "unit": "mm"}, "tilt": {"value": 3, "unit": "deg"},
                   "n": {"value": 258, "unit": "rpm"}, "w": {"value": 0.05, "unit": "m"}, "m": 2.3},
    "points": {"pivot": [0, 0], "grip": [0, 500]},
    "bodies": [{"name": "stick", "mass_kg": 1.5, "inertia_kg_m2": 0.03, "centre": [0, 250]},
               {"name": "gearbox", "mass_kg": "m", "inertia_kg_m2": 0.004, "centre": ["w*sin(tilt)", "-d"]}],
    "joints": [{"name": "pivot", "type": "revolute", "bodies": ["ground", "stick"], "at": "pivot"},
               {"name": "mount", "type": "fixed", "bodies": ["stick", "gearbox"], "at": [0, "-d"]}],
    "springs": [{"name": "servo", "type": "torsion", "joint": "pivot", "stiffness_n_m_per_rad": "k"}],
    "configurations": {"as_is": {}, "longer": {"parameters": {"d": 180}}, "longest": {"parameters": {"d": "4*w + 4*mm", "tilt": -6}}}}
ASK = {
    "format": "modetune-study/1", "model": "../problems/stick.json", "units": {"length": "in"},
    "variables": [{"parameter": "d", "lower": 4, "upper": 7.5, "scale": 1}, {"parameter": "k", "lower": 2000, "upper": 4000}],
    "goals": [{"type": "frequency", "configuration": "as_is", "mode": 1, "target_hz": 21.5},
              {"type": "limit", "expression": "d", "at_least": "4*inch"}],
    "spread": None, "published": [{"parameter": "d", "value": 6.7, "tolerance": 2}]}
DIGITS = 1e-13  # a frequency is computed from the same numbers in other places of a file: some units in its last place


def altered(base, **members):
    out = copy.deepcopy(base)
    out.update(members)
    return {k: v for k, v in out.items() if v is not None}


class Shown(CliTest):
    def setUp(self):
        super().setUp()
        self.write("problems/stick.json", json.dumps(STICK))
        self.write("studies/ask.json", json.dumps(altered(ASK)))

    def hz(self, *args):
        return self.json_of("modes", "problems/stick.json", *args)["modes"][0]["frequency_hz"]

    def exact(self, d, tilt):
        """Closed form: one freedom, k/J about the pivot."""
        x = 0.05 * math.sin(tilt * math.pi / 180)
        return math.sqrt(3000 / (1.5 * 0.25 ** 2 + 0.03 + 2.3 * (d * d + x * x) + 0.004)) / (2 * math.pi)

    def test_numbers_are_in_the_unit_beside_them(self):
        for args, d, tilt in ((["-c", "as_is"], 0.17, 3), (["-c", "longer"], 0.18, 3), (["-c", "longest"], 0.204, -6),
                              (["-c", "as_is", "--set", "d=120"], 0.12, 3), (["-c", "as_is", "--set", "d=+120"], 0.12, 3),
                              (["-c", "as_is", "--set", "d=0.5*d", "--set", "tilt=-(9)"], 0.085, -9),
                              (["-c", "as_is", "--set", "d=120*mm"], 0.12, 3), (["-c", "as_is", "--set", "tilt=pi/60"], 0.17, 3),
                              (["-c", "as_is", "--set", "d=5*inch", "--set", "tilt=10"], 0.127, 10)):
            with self.subTest(args=args):
                self.assertAlmostEqual(self.hz(*args) / self.exact(d, tilt), 1, delta=DIGITS)

    def test_set_refuses_what_looks_like_another_unit(self):
        for text, why in (("d=100+20", '120 is 120 m here, as expressions are in SI units: write "120*mm"'),
                          ("d=d+20", 'write "20*mm"'), ("d=max(d, 200)", 'write "200*mm"'), ("tilt=0.05+tilt", 'write 0.05 rad as "2.864788976*deg"'),
                          ("n=2*150", 'write "300*rpm"'), ("d=3*tilt", "this is an angle, where a length belongs"),
                          ("w=1+w", 'write "1*mm"'), ("d=20 mm", 'did you mean "20*mm"'), ("d=mm", '"mm" is a unit')):
            with self.subTest(text=text):
                self.assertIn(why, self.expect(2, "modes", "problems/stick.json", "--set", text).stderr)

    def test_curves_are_told_in_si(self):
        got = self.json_of("info", str(SOURCE / "tests/models/curve.json"))
        self.assertEqual(got[0]["curves"], [{"name": "rubber", "points": 4, "from": 0, "to": 0.009}])
        self.assertIn("rubber: 4 points, from 0 to 0.009 (SI)", self.expect(0, "info", str(SOURCE / "tests/models/curve.json")).stdout)

    def test_info_tells_the_conversion(self):
        said = self.expect(0, "info", "problems/stick.json", "-c", "as_is").stdout
        for line in ("Units: length in mm, angle in deg; expressions in SI units\n", "  d: 170 mm = 0.17 m\n",
                     "  tilt: 3 deg = 0.05235987756 rad\n", "  n: 258 rpm = 4.3 Hz\n"):
            self.assertIn(line, said)
        self.assertNotIn("  w: ", said)
        got = self.json_of("info", "problems/stick.json", "-c", "as_is")
        self.assertEqual(got["units"], {"length": "mm", "angle": "deg", "speed": "Hz"})
        self.assertEqual([c["parameter"] for c in got["converted"]], ["d", "tilt", "n"])
        self.assertEqual(got["converted"][0], {"parameter": "d", "number": 170, "number_unit": "mm", "value": 0.17, "unit": "m"})

    def test_sensitivity_shows_the_parameter_s_unit_and_json_si(self):
        said = self.expect(0, "sensitivity", "problems/stick.json", "-c", "as_is", "--parameters", "d").stdout
        self.assertRegex(said, r"d +170\.000 +mm ")
        got = self.json_of("sensitivity", "problems/stick.json", "-c", "as_is", "--parameters", "d")["modes"][0]["sensitivities"][0]
        self.assertEqual((got["value"], got["unit"]), (0.17, "m"))

    def test_a_study_shows_its_own_units_and_keeps_si(self):
        said = self.expect(0, "run", "studies/ask.json", "-o", "out").stdout
        result = json.loads((self.folder / "out/ask/result.json").read_text())
        d = result["recommendations"][0]["parameters"][0]
        self.assertEqual((d["unit"], d["display_unit"], d["display_factor"]), ("m", "in", 0.0254))
        self.assertEqual((d["lower"], d["upper"], d["measure_scale"]), (0.1016, 0.1905, 0.0254))
        shown = f"{d['recommended'] / 0.0254:#.6g}"
        self.assertRegex(said, rf"d +in +6\.69291 +{re.escape(shown)} ")
        self.assertIn(f"from 6.69291 to {shown.rstrip('0')} in.", said)
        self.assertIn("The change of d counts linearly, 1.00000 in as 1.", said)
        self.assertRegex(said, r"d +at least 4 in +6\.69291 in +[56]\.\d+ in +\+\S+ % +met")
        goal = result["recommendations"][0]["goals"][1]
        self.assertEqual((goal["unit"], goal["display_unit"], goal["display_factor"], goal["at_least"]), ("m", "in", 0.0254, 0.1016))
        self.assertEqual(self.expect(0, "report", "out/ask/result.json").stdout, said)
        self.assertRegex(self.expect(0, "explain", "out/ask/result.json").stdout, rf" {re.escape(shown)} +in ")
        self.assertRegex(self.expect(0, "compare", "studies/ask.json").stdout, r"d \[in\] +6\.7 +6\.\d+ ")
        rows = list(csv.DictReader((self.folder / "out/ask/recommendations.csv").read_text().splitlines()))
        self.assertIn("k [N m/rad]", rows[0])
        self.assertLessEqual(abs(float(rows[0]["d [in]"]) * 0.0254 - 0.17), math.ulp(0.17))
        self.assertLessEqual(abs(float(rows[1]["d [in]"]) * 0.0254 - d["recommended"]), 2 * math.ulp(d["recommended"]))
        self.assertEqual(float(rows[1]["k [N m/rad]"]), result["recommendations"][0]["parameters"][1]["recommended"])
        self.assertIn("<td>in</td>", (self.folder / "out/ask/report.html").read_text())

    def test_the_parameter_s_unit_holds_where_the_study_says_none(self):
        self.write("studies/own.json", json.dumps(altered(ASK, units=None, variables=[
            {"parameter": "d", "lower": 100, "upper": 190}, {"parameter": "k", "lower": 2000, "upper": 4000}],
            published=[{"parameter": "d", "value": 170, "tolerance": 50}])))
        self.assertRegex(self.expect(0, "run", "studies/own.json", "-o", "out").stdout, r"d +mm +170\.000 ")
        self.write("studies/si.json", json.dumps(altered(ASK, units={"length": "m"}, variables=[
            {"parameter": "d", "lower": 0.1, "upper": 0.19}, {"parameter": "k", "lower": 2000, "upper": 4000}],
            goals=[ASK["goals"][0], {"type": "limit", "expression": "d", "at_least": "100*mm"}], published=None)))
        self.assertRegex(self.expect(0, "run", "studies/si.json", "-o", "out").stdout, r"d +m +0\.170000 ")
        a, b = (json.loads((self.folder / f"out/{name}/result.json").read_text())["recommendations"][0]["parameters"][0]
                for name in ("own", "si"))
        self.assertEqual((a["recommended"], a["lower"], a["upper"]), (b["recommended"], 0.1, 0.19))

    def test_catalogues_are_those_of_the_unit(self):
        for catalogue, values in (({"step": 0.5, "lower": 5, "upper": 7}, [5, 5.5, 6, 6.5, 7]),
                                  ({"series": "E6", "lower": 4, "upper": "8*inch"}, [4.7, 6.8]), ([4, "4.5*inch", 6.25], [4, 4.5, 6.25])):
            study = altered(ASK, published=None, recommendations=1, goals=[{"type": "limit", "expression": "d", "at_least": "4.1*inch"}],
                            objective={"minimise": "d"}, variables=[{"parameter": "d", "catalogue": catalogue}])
            self.write("studies/list.json", json.dumps(study))
            self.expect(0, "run", "studies/list.json", "-o", "out")
            got = json.loads((self.folder / "out/list/result.json").read_text())["recommendations"][0]["parameters"][0]
            with self.subTest(catalogue=catalogue):
                self.assertEqual((got["lower"], got["upper"]), (values[0] * 254 / 10000, values[-1] * 254 / 10000))
                self.assertEqual(got["recommended"], min(x for x in values if x > 4.1) * 254 / 10000)

    def test_columns_of_parts_have_their_units_in_brackets_of_either_kind(self):
        for head, inches in (("d [mm]", 1 / 25.4), ("d (mm)", 1 / 25.4), ("d(mm)", 1), ("d (outer)", 1), ("d", 1)):
            self.write("studies/rods.csv", f"{head};name\n105;A\n150;B\n")
            self.write("studies/rods.json", json.dumps(altered(
                ASK, published=None, goals=[{"type": "limit", "expression": "d", "at_least": f"{120 * inches}*inch"}], objective={"minimise": "d"},
                catalogues={"rod": {"file": "rods.csv"}}, variables=[{"catalogue": "rod", "parameters": ["d"]}])))
            self.expect(0, "run", "studies/rods.json", "-o", "out")
            got = json.loads((self.folder / "out/rods/result.json").read_text())["recommendations"][0]["parameters"][0]
            with self.subTest(head=head):
                self.assertAlmostEqual(got["recommended"] / (150 * inches * 0.0254), 1, delta=DIGITS)
                self.assertEqual(got["part"], "B")

    def test_a_trade_study_and_what_would_let_a_design_exist(self):
        study = altered(ASK, published=None, trade={"vary": [{"variable": "d", "bound": "upper", "values": [5, 7]},
                                                             {"parameter": "w", "values": {"from": 1, "to": 2, "count": 2}}]})
        self.write("studies/grid.json", json.dumps(study))
        said = self.expect(0, "run", "studies/grid.json", "-o", "out").stdout
        self.assertRegex(said, r"upper bound of d \[in\] +w \[in\] ")
        self.assertRegex(said, r" d \[in\]")
        points = json.loads((self.folder / "out/grid/result.json").read_text())["trade"]["points"]
        self.assertEqual([p["values"] for p in points], [[x * 254 / 10000, y * 254 / 10000] for x in (5, 7) for y in (1, 2)])
        self.write("studies/never.json", json.dumps(altered(ASK, published=None, variables=ASK["variables"][:1], goals=[
            {"type": "frequency", "configuration": "as_is", "mode": 1, "target_hz": 23}])))
        said = self.run_program("run", "studies/never.json", "-o", "out").stdout
        self.assertRegex(said, r"Changing the lower bound of d from 4 to ([0-9.]+) in .*: d = \1 in\.")

    def test_what_an_expression_is_held_against_is_shown_in_its_unit(self):
        """The number stays in SI; what people see of it is in the unit of the expression's parameter, or in the study's."""
        study = altered(ASK, variables=[dict(ASK["variables"][0], lower=4, upper=7.5)], objective={"minimise": "d"}, goals=[
            {"type": "limit", "expression": "2*d", "at_least": "9*inch", "at_most": "14*inch"},
            {"type": "limit", "expression": "tilt", "at_most": "12*deg"}, {"type": "limit", "expression": "d^2", "at_most": 1}],
            published=[{"quantity": "2*d", "value": "9*inch", "tolerance": "0.01*inch"}])
        self.write("studies/limits.json", json.dumps(study))
        said = self.expect(0, "run", "studies/limits.json", "-o", "out").stdout
        self.assertRegex(said, r"2\*d +9 to 14 in +13\.3858 in +9\.0000\d* in +0 % +met")
        self.assertRegex(said, r"tilt +at most 12 deg +3\.00000 deg +3\.00000 deg +\+75\.0 % +met")
        self.assertRegex(said, r"d\^2 +at most 1 +0\.0289000 +0\.01306\d+ +\+98\.7 % +met")
        result = json.loads((self.folder / "out/limits/result.json").read_text())
        goals = result["recommendations"][0]["goals"]
        self.assertEqual((goals[0]["unit"], goals[0]["at_least"]), ("m", 9 * 0.0254))
        self.assertAlmostEqual(goals[0]["value"], 9 * 0.0254, delta=1e-6)
        self.assertEqual([g["display_unit"] for g in goals], ["in", "deg", None])
        explained = self.expect(0, "explain", "out/limits/result.json").stdout
        self.assertRegex(explained, r"2\*d from 9 to 14 in: 9\.0000\d* in, met")
        self.assertRegex(explained, r"2\*d from 9 to 14 in +d +\+0\.0900 +in +4\.50000 +in ")
        self.assertRegex(self.expect(0, "compare", "studies/limits.json").stdout, r"2\*d \[in\] +9 +9\.0000\d* .*within 0\.01 ")
        self.write("studies/wide.json", json.dumps(altered(study, published=None, goals=[
            {"type": "limit", "expression": "2*d", "at_least": "16*inch"}])))
        said = self.run_program("run", "studies/wide.json", "-o", "out").stdout
        self.assertRegex(said, r"Changing the at_least of goal /goals/0 from 16 to (15|14\.9999\d*) in ")
        self.write("studies/grid.json", json.dumps(altered(study, published=None, goals=study["goals"][:1], trade={
            "vary": [{"goal": 0, "member": "at_least", "values": ["9*inch", "10*inch"]}]})))
        self.assertRegex(self.expect(0, "run", "studies/grid.json", "-o", "out").stdout, r"at_least of [^\n]*\[in\]")

    def test_a_sweep_is_shown_in_the_model_s_units(self):
        said = self.expect(0, "sweep", "problems/stick.json", "-c", "as_is", "--drive", "pivot=-10:10:3").stdout
        self.assertRegex(said, r"pivot \[deg\] ")
        self.assertEqual(re.findall(r"^ +(-?[\d.]+) ", said, re.M), ["-10.0000", "0", "10.0000"])
        got = self.json_of("sweep", "problems/stick.json", "-c", "as_is", "--drive", "pivot=-10:10:3")
        self.assertIn(-10 * math.pi / 180, [p["position_rad"] for p in got["points"]])

    def test_asked_with_set_is_in_the_units(self):
        study = altered(ASK, published=None, variables=[{"parameter": "k", "lower": 1000, "upper": 9000}])
        self.write("studies/set.json", json.dumps(study))
        self.assertIn("Asked with d = 5.905511811 in (model: 6.692913386).",
                      self.expect(0, "run", "studies/set.json", "--set", "d=150", "-o", "out").stdout)
        applied = json.loads(self.expect(0, "apply", "out/set/result.json").stdout)
        self.assertEqual(applied["parameters"]["d"], {"value": 150, "unit": "mm"})

    def test_apply_writes_numbers_of_the_parameter_s_unit(self):
        for goal in (20.5, 21.1, 21.7, 22.3):
            self.write("studies/apply.json", json.dumps(altered(ASK, published=None, goals=[dict(ASK["goals"][0], target_hz=goal)])))
            self.expect(0, "run", "studies/apply.json", "-o", "out")
            best = json.loads((self.folder / "out/apply/result.json").read_text())["recommendations"][0]
            applied = self.expect(0, "apply", "out/apply/result.json").stdout
            self.write("problems/applied.json", applied)
            d = json.loads(applied)["parameters"]["d"]
            self.assertEqual(d["unit"], "mm")
            wanted = best["parameters"][0]["recommended"]
            self.assertLessEqual(abs(d["value"] * 1.0 / 1000.0 - wanted), math.ulp(wanted))
            got = self.json_of("modes", "problems/applied.json", "-c", "as_is")["modes"][0]["frequency_hz"]
            self.assertAlmostEqual(got / best["frequencies"][0]["recommended_hz"], 1, delta=DIGITS)

    def test_every_unit_of_a_parameter_there_and_back(self):
        """Numbers of one to fifteen digits: the value is within half a unit of the last place (two in degrees) of the exact one, info and apply
        give the number back to its last digit, and a study with bounds in the unit shows it."""
        names = json.loads((SOURCE / "schemas/model.schema.json").read_text())["definitions"]["parameter"]["properties"]["unit"]["enum"]
        self.assertLessEqual(set(EXACT), set(names))
        numbers = [3, 240, 6.8, 0.07, 1234.5678, 0.123456789012345, 987654321.987654]
        parameters = {f"p{i}_{k}": {"value": x, "unit": name} for i, name in enumerate(names) for k, x in enumerate(numbers)}
        self.write("problems/all.json", json.dumps(altered(STICK, parameters=dict(STICK["parameters"], **parameters))))
        got = {c["parameter"]: c for c in self.json_of("info", "problems/all.json", "-c", "as_is")["converted"]}
        for name, exact in EXACT.items():
            for k, x in enumerate(numbers):
                with self.subTest(unit=name, number=x):
                    c = got[f"p{names.index(name)}_{k}"]
                    self.assertEqual((c["number"], c["number_unit"]), (x, name))
                    wanted = Fraction(str(x)) * exact
                    self.assertLessEqual(abs(Fraction(c["value"]) - wanted), Fraction(math.ulp(float(wanted))) * (2 if "deg" in name else Fraction(3, 2)))
        si = {"1", *SI.values()} | {n for n in names if n not in EXACT}
        self.assertEqual({c["unit"] for c in got.values()} - si, set())

    def test_a_study_in_units_of_the_shop(self):
        shop = {"k": {"value": 3000000, "unit": "N mm/rad"}, "m": {"value": 2300, "unit": "g"}}
        self.write("problems/stick.json", json.dumps(altered(STICK, parameters=dict(STICK["parameters"], **shop))))
        study = altered(ASK, published=[{"parameter": "k", "value": 3e6, "tolerance": 1e6}], goals=[
            ASK["goals"][0], {"type": "limit", "expression": "m", "at_most": "2.5"}], variables=[
            {"parameter": "k", "lower": 2e6, "upper": 4e6}, {"parameter": "m", "lower": 2000, "upper": 2600}])
        self.write("studies/shop.json", json.dumps(study))
        refused = self.expect(2, "run", "studies/shop.json", "-o", "out").stderr
        self.assertIn('2.5 is 2.5 kg here, as expressions are in SI units: 2.5 g is written "0.0025"', refused)
        del study["goals"][1]
        self.write("studies/shop.json", json.dumps(study))
        said = self.expect(0, "run", "studies/shop.json", "-o", "out").stdout
        self.assertRegex(said, r"k +N mm/rad +3e\+06 +[23]\.\d+e\+06 ")
        self.assertRegex(said, r"m +g +2300\.00 +2\d\d\d\.\d")
        a, b = json.loads((self.folder / "out/shop/result.json").read_text())["recommendations"][0]["parameters"]
        self.assertEqual((a["unit"], a["display_unit"], a["display_factor"], a["lower"], a["upper"]), ("N m/rad", "N mm/rad", 0.001, 2000, 4000))
        self.assertEqual((b["unit"], b["display_unit"], b["display_factor"], b["lower"], b["upper"]), ("kg", "g", 0.001, 2, 2.6))
        applied = json.loads(self.expect(0, "apply", "out/shop/result.json").stdout)["parameters"]
        row = list(csv.DictReader((self.folder / "out/shop/recommendations.csv").read_text().splitlines()))[0]
        self.assertEqual((row["k [N mm/rad]"], row["m [g]"]), ("3000000", "2300"))
        for p, name in ((a, "k"), (b, "m")):
            self.assertEqual(applied[name]["unit"], p["display_unit"])
            self.assertLessEqual(abs(applied[name]["value"] / 1000 - p["recommended"]), math.ulp(p["recommended"]))
        self.assertAlmostEqual(self.hz("-c", "as_is", "--set", "m=2300", "--set", "k=3e6") / self.exact(0.17, 3), 1, delta=DIGITS)

    def test_what_g_is_follows_from_its_use(self):
        def tried(value, mass="m", gravity=None, unit="g", **more):
            model = altered(STICK, parameters=dict(STICK["parameters"], q={"value": value, "unit": unit}), gravity_m_per_s2=gravity)
            model["bodies"] = [dict(STICK["bodies"][0], mass_kg=mass), STICK["bodies"][1]]
            self.write("problems/g.json", json.dumps(dict(model, **more)))
            return self.run_program("info", "problems/g.json", "-c", "as_is", "--format", "json")

        for args, unit, value in (((1500, "q"), "kg", 1.5), ((1500, "1 + q/2"), "kg", 1.5), ((1500,), "kg", 1.5),
                                  ((1, 1.5, [0, "-q"]), "m/s^2", 9.80665), ((2, 1.5, [0, "-q*cos(tilt)"]), "m/s^2", 19.6133)):
            with self.subTest(args=args):
                c = next(c for c in json.loads(tried(*args).stdout)["converted"] if c["parameter"] == "q")
                self.assertEqual((c["number"], c["unit"], c["value"]), (args[0], unit, value))
        force = [{"name": "pull", "on": "stick", "at": "grip", "force_n": [0, "-2*q"]}]
        for got in (tried(1, "q", [0, "-q"]), tried(1, loads=force)):
            self.assertEqual(got.returncode, 2)
            self.assertIn('"g" is a gram or 9.80665 m/s^2, and what uses "q" does not say which', got.stderr)
        self.assertEqual(tried(1, "q", loads=force).returncode, 0)
        got = tried(1, "q", unit="lb/in")
        self.assertEqual(got.returncode, 2)
        self.assertIn('"q" is in lb/in, of which 1 is 17.858 kg/m: that is not what is wanted here', got.stderr)

    def test_an_unknown_unit_is_told_by_what_it_is(self):
        for unit, why in (("Nmm/rad", 'did you mean "N mm/rad"?'), ("kgm2", 'did you mean "kg m^2"?'), ("N\u00b7mm", 'did you mean "N mm"?'),
                          ("kN/um", '(of its kind: "N/m", '), ("N m/rd", 'did you mean "N m/rad"?'), ("lb/ft^4", "write the number in units of SI"),
                          ("furlong", "modetune schema model"), ("inch", 'did you mean "in"?'), ("\u00b5m", 'did you mean "um"?')):
            with self.subTest(unit=unit):
                self.write("problems/odd.json", json.dumps(altered(STICK, parameters=dict(STICK["parameters"], q={"value": 1, "unit": unit}))))
                self.assertIn(f'unknown unit "{unit}"', said := self.expect(2, "check", "problems/odd.json").stderr)
                self.assertIn(why, said)
        self.write("problems/odd.json", json.dumps(altered(STICK, units={"length": "um"})))
        self.assertIn('"um" is a unit of a parameter\'s number only: write "m" or "mm"', self.expect(2, "check", "problems/odd.json").stderr)

    def test_a_parameter_of_a_unit_s_name_is_refused(self):
        self.write("problems/old.json", json.dumps(altered(STICK, parameters=dict(STICK["parameters"], ft=3))))
        self.assertIn('"ft" is a function or constant of expressions', self.expect(2, "modes", "problems/old.json").stderr)


if __name__ == "__main__":
    main()

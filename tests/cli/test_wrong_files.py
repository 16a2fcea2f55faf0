# SPDX-License-Identifier: GPL-3.0-or-later
"""A generator of wrong files: every model, study, profile of vibration and catalogue of aircraft of the tree, and models that chance
makes, with one number that cannot be or hardly is, for each numeric member of its schema at each place where it stands. A change
that `check` passes in silence fails, and so does one that is told elsewhere; so does a numeric member that nothing here changes
(MT_EVERY=1: all places, not one of each member). Edges are driven by tests/documents/test_possible.c and test_possible_files.c, slips of
several numbers by test_wrong_models.py; here it is every file that has to be read with care."""
import copy
import json
import random
import sys

from common_cli import SOURCE, CliTest, main
from suite import EVERY

sys.path.insert(0, str(SOURCE / "tests/mechanisms"))
from makers import KINDS as MECHANISMS  # noqa: E402

PLACES = 10 ** 6 if EVERY else 1
FOLDERS = ("studies", "src/cli/init", "tests/models", "tests/schema", "tests/documents/good", "problems", "problems/profiles", "tests/bench/studies")
KINDS = ("model", "study", "profile", "aircraft")


def set_to(value):
    return lambda _: value


def times(factor):
    return lambda v: v * factor if isinstance(v, (int, float)) else f"({v})*{factor!r}"


def last(change):
    """The last of a pair, changed."""
    return lambda v: [*v[:-1], change(v[-1])]


def each(change):
    return lambda v: [change(x) for x in v]


def soft(value):
    """Every number of a compliance that is not "rigid"."""
    change = lambda x: x if x == "rigid" else value
    return lambda v: [change(x) for x in v] if isinstance(v, list) else change(v)


def level(change):
    """The level of each breakpoint that has one."""
    return lambda v: [[p[0], change(p[1])] if isinstance(p, list) else p for p in v]


def beyond(other, way):
    """On the wrong side of the member beside it, a number where that is one; None where there is none."""
    def change(v, parent):
        if other not in parent:
            return None
        edge = parent[other]
        return edge + way * (1 + abs(edge)) if isinstance(edge, (int, float)) else f"({edge}) + {way}*(1 + abs({edge}))"
    return change


def upwards(v, parent):
    """Where no configuration has a gravity of its own."""
    return None if any("gravity_m_per_s2" in c for c in parent.get("configurations", {}).values()) else [*[0] * (len(v) - 1), 9.81]


POSITIVE = [(set_to(-1), "error", "must be above 0")]
COUNT = [(set_to(0.5), "error", "must be a whole number"), (set_to(-3), "error", "must be a whole number|out of range")]
ENDS = [(last(set_to(-5)), "error", "must be above 0|must not be negative")]
SPEED = [(set_to(-1), "error", "must be above 0"), (set_to(1e6), "warning", "turns per")]
FACTORS = [(set_to([0, 1]), "error", "must be above 0"), (set_to([95, 105]), "warning", "per cent")]
MARGIN = [(set_to(100), "error", "below 100"), (set_to(0.1), "warning", "next to nothing")]
TOLERANCE = [(set_to(-1), "error", "must be above 0"), (set_to(60), "warning", "almost anything")]
ASKED = [(set_to(-1), "error", "must be above 0")]
SHARE = [(set_to(1.5), "error", "at most 1")]
PERCENT = [(set_to(101), "error", "from 0 to 100"), (set_to(-1), "error", "from 0 to 100")]
# Every number can be that of these: a shape's, a published value, a coordinate, a load, a stiffness (which may be negative).
ANY = {("measured_mode", "shape"), ("published", "value"), ("published", "at_least"), ("published", "at_most"), ("goal_limit", "equals"),
       ("", "parameters"), ("configuration", "parameters"), ("parameter", "value"), ("", "points"), ("body", "centre"), ("joint", "at"), ("spring", "at"),
       ("damper", "at"), ("sensor", "at"), ("load", "at"), ("link", "from"), ("link", "to"), ("load", "force_n"), ("load", "moment_n_m"),
       ("spring", "preload_n"), ("spring", "preload_n_m"), ("spring", "free_angle_rad"), ("spring", "stiffness_n_per_m"),
       ("spring", "stiffness_n_m_per_rad"), ("damper", "damping_n_s_per_m"), ("damper", "damping_n_m_s_per_rad"), ("link", "stiffness_n_m_per_rad"),
       ("configuration", "gravity_m_per_s2"), ("axes", "angles_rad"), ("include", "at"), ("include", "parameters"), ("rotate", "angle_rad"), ("polar", "angle_rad"), ("polar", "about"),
       ("linear", "step"), ("mirror", "about")}
NEGATIVE = [(set_to(-1), "error", "must not be negative")]
NO_DIRECTION = [(each(set_to(0)), "error", "no direction|length zero|length 0")]
# By member, and where its definition matters by both: changes, with what is told of them.
WRONG = {
    "weight": POSITIVE, "scale": POSITIVE, "length_m": POSITIVE, "ratio": POSITIVE, "step": POSITIVE, "up_to_hz": POSITIVE, "at_hz": POSITIVE,
    "tolerance": POSITIVE, "tolerance_percent": TOLERANCE, "margin_percent": MARGIN, "speed_range": FACTORS, "band_hz": ENDS,
    ("published", "tolerance_percent"): POSITIVE, ("measurement", "factor"): POSITIVE,
    ("variable", "tolerance_percent"): [(set_to(100), "error", "below 100"), (set_to(0.001), "warning", "next to nothing")],
    "factor": [(set_to(1), "error", "above 1"), (set_to(5000), "warning", "one goal alone")],
    "proof_s": [(set_to(-1), "error", "from 0 to 1e\\+06")],
    "target_hz": ASKED, "at_least_hz": ASKED, "at_most_hz": ASKED, "frequency_hz": POSITIVE,
    "at_least": POSITIVE, "at_most": POSITIVE, "target": POSITIVE, "at_least_percent": POSITIVE,
    ("goal_apart", "at_least_percent"): POSITIVE, ("goal_static", "target"): [(set_to("abc"), "error", "abc")],
    ("goal_static", "at_least"): [(beyond("at_most", 1), "error", "is not above")],
    ("goal_static", "at_most"): [(beyond("at_least", -1), "error", "is not above")],
    ("goal_apart", "modes"): [(set_to([1]), "error", "at least two modes")],
    ("goal_mac", "at_least"): SHARE, ("goal_damping", "at_least"): SHARE, ("goal_damping", "at_most"): SHARE, ("goal_damping", "target"): SHARE,
    "at_least_percent": PERCENT, "at_most_percent": PERCENT,
    ("goal_limit", "at_least"): [(beyond("at_most", 1), "error", "is not above")],
    ("goal_limit", "at_most"): [(beyond("at_least", -1), "error", "is not above")],
    "bands_hz": [(lambda v: [[v[0][1], v[0][0]], *v[1:]], "error", "is not above"), (lambda v: [[-1, v[0][1]], *v[1:]], "error", "negative")],
    ("variable", "lower"): [(beyond("upper", 1), "error", "below lower")], ("variable", "upper"): [(beyond("lower", -1), "error", "below lower")],
    ("variable", "catalogue"): [(lambda v: [*v, v[0]] if isinstance(v, list) else [1, 1], "error", "twice|go with the name")],
    ("parts", "rows"): [(lambda v: [*v[:-1], v[0]], "error", "are the same"), (lambda v: [*v[:-1], v[0][1:]], "error", "in this row")],
    ("parts", "tolerance_percent"): [(lambda v: v[1:], "error", "tolerances for"), (lambda v: [100, *v[1:]], "error", "below 100")],
    ("catalogue", "lower"): [(times(1e6), "error", "is below lower")], ("catalogue", "upper"): [(beyond("lower", -1), "error", "is below lower|must be above")],
    ("vary", "values"): [(lambda v: [*v, v[0]], "error", "twice")], "from": [(set_to(1e30), "error", "cannot be|is not|unit|twice")],
    "to": [(set_to(-1e30), "error", "cannot be|is not|unit|twice")],
    ("rotor", "speed_hz"): SPEED, ("rotor", "speed_rpm"): SPEED, ("tail_rotor", "speed_hz"): SPEED, ("tail_rotor", "speed_rpm"): SPEED,
    ("machine", "speed_hz"): [(set_to(-1), "error", "must be above 0"), (times(1e3), "warning", "turns per minute")],
    ("machine", "speed_range_hz"): [(last(set_to(0)), "error", "must be above 0"), (each(times(1e3)), "warning", "turns per minute")],
    "psd_g2_per_hz": [(level(set_to(0)), "error", "must be within"), (level(set_to(1e7)), "warning", "beyond any vibration")],
    "psd_m2_per_s3": [(level(set_to(-1)), "error", "must be within"), (level(set_to(1e9)), "warning", "beyond any vibration")],
    "published_rms_g": [(set_to(0), "error", "must be within"), (times(2), "warning", "off the published")],
    "slope_db_per_octave": [(set_to(400), "warning", "steeper than any filter")],
    ("slope", "frequency_hz"): [(set_to(-1), "error", "must be within"), (set_to(1e-5), "warning", "three hours")],
    ("tone", "frequency_hz"): [(set_to([0, 1]), "error", "must be within"), (set_to([1e7, 1e7]), "warning", "above 1 MHz")],
    "acceleration_g": [(set_to(0), "error", "must be within"), (set_to(1e5), "warning", "beyond any")],
    "acceleration_m_per_s2": [(set_to(-1), "error", "must be within"), (set_to(1e6), "warning", "beyond any")],
    "sigma": [(set_to(-1), "error", "must be within 0 and 100"), (set_to(50), "warning", "far above")],
    ("speed", "value"): SPEED,
    # of models
    ("curve", "x"): [(lambda v: v[::-1], "error", "ascend"), (lambda v: v[:-1], "error", "as many x as y")],
    ("curve", "y"): [(lambda v: v[:1], "error", "2 to 10000 points"), (lambda v: [*v, 1], "error", "as many x as y")],
    "mass_kg": NEGATIVE, "density_kg_per_m3": POSITIVE, "youngs_modulus_pa": POSITIVE, "shear_modulus_pa": POSITIVE, "loss_factor": NEGATIVE,
    "radius_of_gyration_m": NEGATIVE, "free_length_m": NEGATIVE, "area_m2": [(set_to(-1), "error", "must be above 0|must not be negative")],
    "second_moment_m4": POSITIVE, "second_moment_other_m4": POSITIVE, "torsion_constant_m4": NEGATIVE, "coefficient": POSITIVE, "coefficient_other": POSITIVE,
    "poissons_ratio": [(set_to(0.6), "error", "not above 0.5")], "fraction": [(set_to(1.1), "error", "within 0 and 1")], "axis": NO_DIRECTION,
    "axis_b": NO_DIRECTION, "normal": NO_DIRECTION, ("axes", "x"): NO_DIRECTION, ("axes", "y"): NO_DIRECTION, ("axes", "z"): NO_DIRECTION, "hinge_axis": NO_DIRECTION,
    ("joint", "ratio"): [(set_to(0), "error", "must not be 0")],
    ("compliance", "stiffness_n_per_m"): [(soft(0), "error", "must be above 0")], ("compliance", "stiffness_n_m_per_rad"): [(soft(0), "error", "must be above 0")],
    ("compliance", "damping_n_s_per_m"): [(soft(-1), "error", "must not be negative")],
    ("compliance", "damping_n_m_s_per_rad"): [(soft(-1), "error", "must not be negative")],
    "ratio_m_per_rad": [(set_to(0), "error", "must not be 0")], ("joint", "length_m"): POSITIVE, ("damping", "ratio"): NEGATIVE, "mass_per_s": NEGATIVE,
    "stiffness_s": NEGATIVE, "ratios": [(last(set_to(-1)), "error", "must not be negative")],
    ("damping", "modes"): [(lambda v: dict.fromkeys(v, -1), "error", "must not be negative")],
    "inertia_kg_m2": [(lambda v: [-1, *v[1:]] if isinstance(v, list) else -1, "error", "must not be negative")],
    "element_inertia_kg_m2": [(lambda v: [-1, *v[1:]] if isinstance(v, list) else -1, "error", "must not be negative")],
    "element_length_m": [(lambda v: [-1, *v[1:]] if isinstance(v, list) else -1, "error", "must be above 0|must not be negative|longer|add up|whole")],
    "element_mass_kg": [(lambda v: [-1, *v[1:]] if isinstance(v, list) else -1, "error", "must not be negative")],
    "position_rad": [(set_to(1e4), "error", "at most 1000 rad")], "position_m": [(set_to(1e9), "error|warning", "times|sizes|wide|stroke|drawing")],
    "stiffness_matrix": [(lambda v: [[*v[0][:-1], f"({v[0][-1]}) + 1 + abs({v[0][0]})"], *v[1:]], "error", "is")],
    "gravity_m_per_s2": [(upwards, "warning", "is up where")],
    "dimension": [(set_to(4), "error", "must be 2 or 3")],
}
WRONG.update({(s, m): POSITIVE for s in ("section",) for m in ("width_m", "height_m", "diameter_m", "outer_diameter_m")})
WRONG["section", "inner_diameter_m"] = NEGATIVE
COUNTS = {"seed", "starts", "max_evaluations", "max_modal_solutions", "recommendations", "mode", "up_to_mode", "reference_mode", "goal", "count", "blades", "teeth", "sidebands", "cluster",
          "dataset", ("blades", "value"), ("mode", "index"), ("link", "elements")}


class Walk:
    """Numeric members of a document, along its schema."""

    def __init__(self, kind):
        self.schema = json.loads((SOURCE / f"schemas/{kind}.schema.json").read_text(encoding="utf-8"))
        self.of = dict(self.schema["definitions"], **{"": self.schema})
        self.members = {(name, m) for name, d in self.of.items() if name != "goal" for m, s in d.get("properties", {}).items() if self.is_numeric(s)}

    def is_numeric(self, schema, seen=()):
        if "$ref" in schema:
            name = schema["$ref"].rsplit("/", 1)[1]
            return name not in seen and self.is_numeric(self.of[name], (*seen, name))
        if "properties" in schema:
            return False
        types = schema.get("type", [])
        if {"number", "integer"} & set([types] if isinstance(types, str) else types):
            return True
        parts = [s for k in ("anyOf", "oneOf", "allOf") for s in schema.get(k, [])]
        parts += [schema[k] for k in ("items", "additionalProperties", "then", "else") if isinstance(schema.get(k), dict)]
        return any(self.is_numeric(s, seen) for s in parts)

    def references(self, schema, out):
        """Definitions that a value may be of, but not those of its members."""
        if isinstance(schema, list):
            for s in schema:
                self.references(s, out)
        elif isinstance(schema, dict):
            for key, s in schema.items():
                name = s.rsplit("/", 1)[1] if key == "$ref" else None
                if name is not None and name not in out:
                    out.add(name)
                    self.references(self.of[name], out)
                elif key != "properties":
                    self.references(s, out)
        return out

    def places(self, document, name="", path=()):
        """(definition, member, path) of every number, list or rule of numbers."""
        for member, value in document.items():
            schema = self.of[name].get("properties", {}).get(member)
            if schema is None:
                continue
            if (name, member) in self.members:
                yield name, member, (*path, member)
            yield from self.inside(value, schema, (*path, member))

    def inside(self, value, schema, path):
        if isinstance(value, list):
            for i, v in enumerate(value):
                yield from self.inside(v, schema, (*path, i))
        elif isinstance(value, dict):
            fit = [n for n in sorted(self.references(schema, set())) if "properties" in self.of[n] and n != "goal"
                   and set(value) <= set(self.of[n]["properties"]) and set(self.of[n].get("required", [])) <= set(value)]
            goal = f"goal_{value.get('type')}"
            if fit:
                yield from self.places(value, goal if goal in fit else fit[0], path)
            else:
                for k, v in value.items():
                    yield from self.inside(v, schema, (*path, k))


def changes_of(name, member, value):
    if member in COUNTS or (name, member) in COUNTS:
        return COUNT if isinstance(value, (int, float)) else []
    if (name, member) in ANY or name in ("variable", "vary") and isinstance(value, dict):
        return []  # a rule has members of its own
    return WRONG.get((name, member), WRONG.get(member, []))


def changed(document, path, change):
    """None where the change cannot be made there."""
    out = copy.deepcopy(document)
    at = out
    for key in path[:-1]:
        at = at[key]
    at[path[-1]] = change(at[path[-1]], at) if change.__code__.co_argcount == 2 else change(at[path[-1]])
    return None if at[path[-1]] is None else out


def anchored(document, kind, folder):
    """With the files that it names found from anywhere."""
    out = copy.deepcopy(document)
    holders = [(out, "aircraft")] if kind != "aircraft" else []
    if kind == "model":
        holders += [(i, "file") for i in out.get("include", [])]
    if kind == "study":
        holders += [(out, "model")] + [(r, "model") for r in out.get("references", {}).values()]
        holders += [(m, "file") for tables in ("measurements", "catalogues") for m in out.get(tables, {}).values()]
        holders += [(g, "profile") for g in out.get("goals", []) + out.get("responses", [])]
        if "aircraft" not in out and "model" in out and ((folder / out["model"]).parent / "aircraft.json").is_file():
            out["aircraft"] = str(((folder / out["model"]).parent / "aircraft.json").resolve())
    for holder, member in holders:
        if isinstance(holder.get(member), str) and (folder / holder[member]).is_file():
            holder[member] = str((folder / holder[member]).resolve())
    return out


class WrongFiles(CliTest):
    def sound(self):
        """(path, kind, document) of the tree's files."""
        for folder in FOLDERS:
            for path in sorted((SOURCE / folder).glob("*.json")):
                document = json.loads(path.read_text(encoding="utf-8"))
                kind = document.get("format", "")[len("modetune-"):].split("/")[0] if isinstance(document, dict) else ""
                if kind in KINDS:
                    yield path.name, kind, anchored(document, kind, path.parent)
        for kind, make in MECHANISMS.items():
            for seed in range(3 if PLACES > 1 else 1):
                yield f"{kind} {seed}", "model", json.loads(json.dumps(make(random.Random(f"{kind} {seed}"))))

    def test_no_slip_is_passed_in_silence(self):
        walks = {kind: Walk(kind) for kind in KINDS}
        found, done, wanted = set(), {}, {}
        for path, kind, document in self.sound():
            for name, member, place in walks[kind].places(document):
                value = document
                for key in place:
                    value = value[key]
                for i, (change, severity, words) in enumerate(changes_of(name, member, value)):
                    wrong = changed(document, place, change)
                    if wrong is None:
                        continue
                    found.add((kind, name, member))
                    done[kind, name, member, i] = done.get((kind, name, member, i), 0) + 1
                    if done[kind, name, member, i] > PLACES:
                        continue
                    file = self.write(f"studies/w{len(wanted)}.json", json.dumps(wrong))
                    wanted[file] = (f"{path}: {'/'.join(map(str, place))}: change {i} of {name} {member}", place, severity, words)
        for kind, walk in walks.items():
            untouched = walk.members - {(n, m) for k, n, m in found if k == kind} - ANY
            self.assertEqual(untouched, set(), f"{kind}: members that nothing changes")
        answer = {got["file"]: got for got in json.loads(self.run_program("check", "--root", "/", "--format", "json", *wanted).stdout)}
        self.assertEqual(set(wanted) - set(answer), set())
        for file, (label, place, severity, words) in wanted.items():
            with self.subTest(label):
                around = "/" + "/".join(map(str, place[:-1]))
                told = [p for p in answer[file]["problems"] if p["severity"] in severity.split("|") and (p["pointer"] or "").startswith(around)]
                self.assertRegex("\n".join(p["message"] for p in told), words, answer[file]["problems"])


if __name__ == "__main__":
    main()

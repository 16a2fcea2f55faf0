# SPDX-License-Identifier: GPL-3.0-or-later
"""A generator of wrong files: every model of the tree with one change that makes it impossible or implausible, for each place where
the change can be made. A change that `check` passes in silence fails, and so does one that is told elsewhere. Numbers by
themselves are driven by tests/documents/test_possible.c; here is what a slip does to several at once (MT_EVERY=1: all places, not one of
each kind in a model)."""
import copy
import json
import random
import re
import sys

from common_cli import SOURCE, CliTest, main
from suite import EVERY

sys.path.insert(0, str(SOURCE / "tests/mechanisms"))
from makers import KINDS  # noqa: E402

PLACES = 10 ** 6 if EVERY else 1
SEEDS = 3 if EVERY else 1
FOLDERS = ("problems", "tests/models", "src/cli/init")
COINCIDE = r"two points coincide|is a point mass and can be held at its centre only"
LINES = ("axial", "bar")  # springs that act along the line between two points


def times(value, factor):
    """The number or expression, a list of them, so many times as large."""
    if isinstance(value, list):
        return [times(v, factor) for v in value]
    return value * factor if isinstance(value, (int, float)) else f"({value})*{factor!r}"


def total(values):
    return "+".join(f"({v})" for v in values)


def zero(value):
    return [0 for _ in value]


def nested(inertia, factor):
    """Three moments (products are left away) of which the first is `factor` times the sum of the others and 1e-6 more."""
    return [f"{factor}*({total(inertia[1:3])}) + 1e-6", *inertia[1:3]]


def items(model, name):
    return enumerate(model.get(name) or [])


def point(model, item):
    """The coordinates of the point of `at`, of two that of the second body; None where there is none."""
    at, named = item.get("at"), model.get("points") or {}
    if isinstance(at, list) and len(at) == 2 and all(isinstance(p, list) or p in named for p in at):
        at = at[1]
    at = named.get(at) if isinstance(at, str) else at
    return at if isinstance(at, list) and len(at) == model["dimension"] else None


def bodies(model):
    for i, body in items(model, "bodies"):
        inertia = body.get("inertia_kg_m2")
        if isinstance(inertia, list) and model["dimension"] == 3 and any(v != 0 for v in inertia):
            yield "triangle", ("bodies", i, "inertia_kg_m2"), nested(inertia, 1.1), "error", r"more than the other two"
        if inertia is not None and inertia not in (0, [0, 0, 0]) and body.get("mass_kg", 0) != 0:
            yield "kg mm^2", ("bodies", i, "inertia_kg_m2"), times(inertia, 1e9), "warning", r"radius of gyration"


def links(model):
    for i, link in items(model, "links"):
        if "density_kg_per_m3" in link:
            yield "g/cm^3", ("links", i, "density_kg_per_m3"), times(link["density_kg_per_m3"], 1e-3), "warning", r"below 10 kg/m\^3"
            yield "lighter than nothing", ("links", i, "density_kg_per_m3"), times(link["density_kg_per_m3"], -1), "error", r"must be above 0"
        if "youngs_modulus_pa" in link:
            yield "GPa", ("links", i, "youngs_modulus_pa"), times(link["youngs_modulus_pa"], 1e-9), "warning", r"MPa or GPa"
        section = link.get("section", {})
        for member in ("width_m", "height_m", "diameter_m", "outer_diameter_m"):
            if member in section:
                yield "mm", ("links", i, "section", member), times(section[member], 1e4), "warning", r"millimetres"
        if "inner_diameter_m" in section:
            yield "no wall", ("links", i, "section", "inner_diameter_m"), section["outer_diameter_m"], "error", r"no thickness"
        if isinstance(link["from"], list):
            yield "no length", ("links", i, "to"), [f"({x}) + 0" for x in link["from"]], "error", r"begins and ends at the same point"
        if "hinge_axis" in link:
            yield "no hinge", ("links", i, "hinge_axis"), zero(link["hinge_axis"]), "error", r"length zero|length 0"


def joints(model):
    for i, joint in items(model, "joints"):
        here = point(model, joint)
        if joint["type"] == "distance" and here is not None:
            yield "no rod", ("joints", i, "at"), [here, here], "error", COINCIDE
        for member in ("axis", "axis_b"):
            if member in joint:
                yield "no direction", ("joints", i, member), zero(joint[member]), "error", r"no direction"
        if "axis_b" in joint:
            yield "parallel", ("joints", i, "axis_b"), joint["axis"], "error", r"parallel"
        for member in ("ratio", "ratio_m_per_rad"):
            if member in joint:
                yield "no gear", ("joints", i, member), 0, "error", r"must not be 0"


def springs(model):
    for name in ("springs", "dampers"):
        for i, spring in items(model, name):
            here = point(model, spring)
            driven = "free_length_m" in spring and any("drive" in c for c in (model.get("configurations") or {}).values())
            if spring["type"] in LINES and "joint" not in spring and here is not None and not driven:
                yield "coincident", (name, i, "at"), [here, here], "error", COINCIDE
            if spring["type"] == "bushing" and here is not None and all(isinstance(v, (int, float)) for v in here):
                yield "apart", (name, i, "at"), [here, [here[0] + 300, *here[1:]]], "warning", r"two points are \S+ m apart"
            if "stiffness_matrix" in spring:
                matrix = copy.deepcopy(spring["stiffness_matrix"])
                matrix[0][4] = f"2*({matrix[0][4]}) + ({matrix[0][0]})"
                yield "one triangle", (name, i, "stiffness_matrix"), matrix, "error", r"\[4\]\[0\] is \S+ and \[0\]\[4\] is"
            if "loss_factor" in spring and spring["loss_factor"] != 0:
                yield "per cent", (name, i, "loss_factor"), 2.5, "warning", r"percent"


def units(model):
    """A number of metres where something else is measured, of 1 in SI."""
    for name, members in (("bodies", ("mass_kg",)), ("springs", ("stiffness_n_per_m", "stiffness_n_m_per_rad")), ("dampers", ("damping_n_s_per_m",)),
                          ("links", ("mass_kg", "youngs_modulus_pa", "density_kg_per_m3"))):
        for i, item in items(model, name):
            for member in members:
                if isinstance(item.get(member), (int, float, str)):
                    yield "unit", (name, i, member), "1000*mm", "warning", f'is in m, and "{member}" in '


def whole(model):
    gravity = model.get("gravity_m_per_s2")
    if gravity and gravity[-1] not in (0, "0") and not any("gravity_m_per_s2" in c for c in (model.get("configurations") or {}).values()):
        yield "up", ("gravity_m_per_s2",), [*zero(gravity[:-1]), 9.81], "warning", r"is up where"
    turning = [j["name"] for j in model.get("joints") or [] if j["type"] == "revolute" and "in" not in j]
    for name, own in (model.get("configurations") or {}).items():
        drive = own.get("drive", {})
        if isinstance(drive, list):  # the first one of several
            drive = drive[0] if drive else {}
            if "position_rad" in drive:
                yield "degrees", ("configurations", name, "drive", 0, "position_rad"), 20, "warning", r"more than a turn"
            continue
        if "position_rad" in drive:
            yield "degrees", ("configurations", name, "drive", "position_rad"), 20, "warning", r"more than a turn"
        if "position_rad" in drive and len(turning) > 1:
            other = [t for t in turning if t != drive["joint"]][0]
            like = {"like": name, "drive": {"joint": other, "position_rad": 0.01}}
            like = {"like": name, "drive": [like["drive"], {"joint": other, "position_rad": 0.02}]}
            yield "twice", ("configurations", "zz"), like, "error", f"joint \"{re.escape(other)}\" is driven twice"
            yield "free", ("configurations", "zz"), {"drive": {"joint": other, "free": True}}, "error", r"is free already"
    number = next((n for n, p in (model.get("parameters") or {}).items() if isinstance(p, dict) and isinstance(p.get("value"), (int, float))), None)
    if number is not None:
        yield "rad", ("parameters", "zz"), f"cos(30 + 0*{number})", "warning", r"without a unit"


def changed(model, path, value):
    out = copy.deepcopy(model)
    at = out
    for key in path[:-1]:
        at = at[key] if isinstance(at, list) else at.setdefault(key, {})
    at[path[-1]] = value
    return out


class WrongModels(CliTest):
    def generated(self):
        """Mechanisms that chance makes, of each kind."""
        made = {}
        for kind, make in KINDS.items():
            for seed in range(SEEDS):
                name = f"problems/{kind}_{seed}.json"
                model = json.loads(json.dumps(make(random.Random(f"{kind} {seed}"))))
                made[self.write(name, json.dumps(model))] = model
        return made

    def sound(self):
        """The models of the tree that can be analysed as they are."""
        paths = [p for folder in FOLDERS for p in sorted((SOURCE / folder).glob("*.json"))]
        models = {str(p): json.loads(p.read_text(encoding="utf-8")) for p in paths}
        models = {p: m for p, m in models.items() if m.get("format") == "modetune-model/1"}
        models.update(self.generated())
        answer = json.loads(self.run_program("check", "--format", "json", *models).stdout)
        return {got["file"]: models[got["file"]] for got in answer if not any(p["severity"] == "error" for p in got["problems"])}

    def test_no_slip_is_passed_in_silence(self):
        wanted = {}
        kinds = {}
        for path, model in self.sound().items():
            done = {}
            for make in (bodies, links, joints, springs, units, whole):
                for kind, place, value, severity, words in make(model):
                    done[kind] = done.get(kind, 0) + 1
                    if done[kind] > PLACES:
                        continue
                    kinds[kind] = kinds.get(kind, 0) + 1
                    name = self.write(f"problems/w{len(wanted)}.json", json.dumps(changed(model, place, value)))
                    wanted[name] = (f"{path}: {kind} at {'/'.join(map(str, place))}", "/" + "/".join(map(str, place)), severity, words)
        self.assertGreater(len(kinds), 15, kinds)
        answer = json.loads(self.run_program("check", "--format", "json", *wanted).stdout)
        self.assertEqual(len(answer), len(wanted))
        for got in answer:
            label, pointer, severity, words = wanted[got["file"]]
            with self.subTest(label):
                told = [p for p in got["problems"] if p["severity"] == severity and re.search(words, p["message"])]
                self.assertNotEqual(told, [], got["problems"])
                places = [p["pointer"] or "" for p in told]
                self.assertTrue(any(p.startswith(pointer) or pointer.startswith(p + "/") for p in places) or re.search("hinge_axis|links/./to", pointer), places)


if __name__ == "__main__":
    main()

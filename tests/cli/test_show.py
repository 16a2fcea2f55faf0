# SPDX-License-Identifier: GPL-3.0-or-later
"""`modetune show`: what it draws of every shipped model holds together, whatever the names say, and in all forms.
MT_EVERY=1: also of what is shown until it is too much."""
import functools
import json
import math
import re
import subprocess
import unittest
import xml.etree.ElementTree as ET
from html.parser import HTMLParser

import jsonschema

from common_cli import MODEL, PROGRAM, SOURCE, CliTest, study
from suite import EVERY
from common_pack import unpack

HOSTILE = "</script><img src=x onerror=alert(1)>"
SCHEMA = jsonschema.Draft7Validator(json.loads((SOURCE / "schemas/scene.schema.json").read_text(encoding="utf-8")))
MODES, POSITIONS = 12, range(15, 26)
SAME = 2e-5  # of the size: places have six digits
MODELS = sorted(path for path in (SOURCE / "problems").glob("*.json") if '"modetune-model/' in path.read_text(encoding="utf-8"))


def numbers(value):
    """All numbers of a document."""
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list):
        for item in value:
            yield from numbers(item)
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        yield value


def refuse(word):
    raise ValueError(word)


def parse(text):
    """JSON without NaN and Infinity."""
    return json.loads(text, parse_constant=refuse)


def distance(a, b):
    return math.dist(a, b)


def to_segment(x, a, b):
    d = [q - p for p, q in zip(a, b)]
    dd = sum(e * e for e in d)
    t = sum((p - q) * e for p, q, e in zip(x, a, d)) / dd if dd else 0
    return distance(x, [p + min(max(t, 0), 1) * e for p, e in zip(a, d)])


def mode_faults(view, mode):
    if len(mode["motion"]) != len(view["bodies"]) or any(len(m) != 6 for m in mode["motion"]):
        yield "a motion is not one of every body"
    if mode["motion"] and any(mode["motion"][0]):
        yield "the ground moves"
    for what, count in (("springs", len(view["springs"])), ("bodies", len(view["bodies"]))):
        shares = mode["energy"][what]
        if len(shares) != count or not all(0 <= s <= 1 for s in shares) or not sum(shares) <= 1 + 1e-9:
            yield f"shares of {what}: {sum(shares)}"
    if mode["note"] is None and not mode["hz"] >= 0:
        yield f"mode at {mode['hz']} Hz"
    if not 0.1 <= max(math.hypot(*m[:3]) for m in mode["motion"]) <= 1 + 1e-4 and not any(any(m[3:]) for m in mode["motion"]):
        yield "what moves most does not move by 1"


def held(view, size, joint, body):
    """Is the point of a joint on what is drawn of a body? Of the ground nothing is."""
    if body == 0:
        return True
    ends = [view["bodies"][body]["at"]] + [p for line in view["lines"] if line["body"] == body for p in (line["from"], line["to"])]
    near = min(distance(joint["at"], p) for p in ends)
    near = min([near] + [to_segment(joint["at"], line["from"], line["to"]) for line in view["lines"] if line["body"] == body])
    return near <= SAME * size


def view_faults(scene, view):
    """What is wrong with one configuration."""
    size, bodies = scene["size"], view["bodies"]
    if not bodies or bodies[0]["kind"] != "ground" or any(b["kind"] == "ground" for b in bodies[1:]):
        yield "the ground is not the first body"
    for joint in view["joints"]:
        if not all(0 <= i < len(bodies) for i in joint["bodies"]):
            yield f"{joint['name']}: no such body"
        elif joint["type"] == "revolute" and not all(held(view, size, joint, i) for i in joint["bodies"]):
            yield f"{joint['name']}: its bodies do not share its point"
        if joint["axis"] is not None and not abs(math.hypot(*joint["axis"]) - 1) <= 1e-5:
            yield f"{joint['name']}: its axis is no unit vector"
        if not joint["distance"] >= 0 or (joint["distance"] > 0) != (joint["far"] is not None):
            yield f"{joint['name']}: distance {joint['distance']} from {joint['far']}"
    for body in bodies:
        ellipsoid = body["ellipsoid"]
        if ellipsoid and not all(abs(sum(p * q for p, q in zip(a, b)) - (i == k)) <= 1e-5
                                 for i, a in enumerate(ellipsoid["axes"]) for k, b in enumerate(ellipsoid["axes"])):
            yield f"{body['name']}: axes are not orthogonal"
    vibrations = [m for m in view["modes"] if m["note"] is None]
    if len(vibrations) > MODES or any(a["hz"] > b["hz"] for a, b in zip(vibrations, vibrations[1:])):
        yield "modes are not the lowest in order"
    for mode in view["modes"]:
        yield from mode_faults(view, mode)


def drive_faults(view):
    drive = view["drive"]
    at = [p["at"] for p in drive["positions"]]
    if len(at) not in POSITIONS or at != sorted(at):
        yield f"{len(at)} positions"
    for position in drive["positions"]:
        if position["error"] is None and len(position["poses"]) != len(view["bodies"]):
            yield "a position without the poses of all bodies"
        if position["error"] is not None and (position["poses"] is not None or position["hz"]):
            yield "a position that failed has poses"
        for pose in position["poses"] or []:
            r = [pose[3:6], pose[6:9], pose[9:12]]
            if not all(abs(sum(p * q for p, q in zip(a, b)) - (i == k)) <= 2e-5 for i, a in enumerate(r) for k, b in enumerate(r)):
                yield "a pose is no rotation"
        if drive["at"] is not None and abs(position["at"] - drive["at"]) < 1e-12:
            for pose, body in zip(position["poses"], view["bodies"]):
                if distance(pose[:3], body["at"]) > 1e-5:
                    yield f"{body['name']} is not where the configuration has it"


def faults(scene):
    for design in scene["designs"]:
        for view in design["configurations"]:
            yield from (f"{view['name']}: {fault}" for fault in view_faults(scene, view))
            if view["drive"]:
                yield from (f"{view['name']}: {fault}" for fault in drive_faults(view))
    off = [j["distance"] for j in scene["joints"]]
    if off != sorted(off, reverse=True):
        yield "joints are not the farthest first"


class Tags(HTMLParser):
    """Elements and attributes of a page, and what stands in its blocks of data."""

    def __init__(self, page):
        super().__init__()
        self.tags, self.attributes, self.data, self._in = set(), set(), {}, None
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        self.tags.add(tag)
        self.attributes |= {name for name, _ in attrs}
        if tag == "script":
            self._in = dict(attrs).get("id")

    def handle_endtag(self, tag):
        self._in = None

    def handle_data(self, data):
        if self._in:
            self.data[self._in] = self.data.get(self._in, "") + data


@functools.cache
def told_of(path):
    """What is said of a shipped model, once for all tests."""
    return subprocess.run([PROGRAM, "show", "--format", "json", str(path)], capture_output=True, encoding="utf-8", timeout=600, check=True)


@functools.cache
def scene_of(path):
    return parse(told_of(path).stdout)


class Show(CliTest):
    def test_shipped_models_are_drawn_as_they_are(self):
        self.assertGreaterEqual(len(MODELS), 8)
        for path in MODELS:
            with self.subTest(path.name):
                self.assertEqual(told_of(path).stderr, "")
                scene = scene_of(path)
                self.assertTrue(all(math.isfinite(x) for x in numbers(scene)))
                self.assertEqual(list(faults(scene)), [])
                self.assertEqual([error.message for error in SCHEMA.iter_errors(scene)], [])
                self.assertEqual([v["error"] for v in scene["designs"][0]["configurations"] if v["error"]], [])
                self.assertEqual(scene["designs"][0]["label"], "original")

    def test_faults_are_found(self):
        scene = scene_of(SOURCE / "problems/inceptor.json")
        self.assertEqual(list(faults(scene)), [])
        for plant in (lambda v: v["joints"][0]["at"].__setitem__(1, 5.0), lambda v: v["modes"][1]["energy"]["springs"].append(0.0),
                      lambda v: v["modes"][1]["energy"]["bodies"].__setitem__(1, 1.0), lambda v: v["modes"][1].__setitem__("hz", float("nan")),
                      lambda v: v["modes"][1]["motion"].pop(), lambda v: v["drive"]["positions"][3]["poses"][2].__setitem__(4, 0.5),
                      lambda v: v["drive"]["positions"].pop(0) and [v["drive"]["positions"].pop() for _ in range(9)],
                      lambda v: v["joints"][0].__setitem__("distance", float("nan"))):
            wrong = parse(told_of(SOURCE / "problems/inceptor.json").stdout)
            view = wrong["designs"][0]["configurations"][1]
            plant(view)
            self.assertNotEqual(list(faults({**wrong, "designs": [{"configurations": [view]}]})), [])

    def test_frequencies_are_those_of_modes(self):
        path = SOURCE / "problems/inceptor.json"
        for view, told in zip(scene_of(path)["designs"][0]["configurations"], json.loads(self.expect(0, "modes", "--format", "json", "--count", "all", str(path)).stdout)):
            hz = {m["index"]: (m["frequency_hz"], m["name"]) for m in told["modes"] if m["index"]}
            for mode in view["modes"]:
                if mode["mode"]:
                    self.assertAlmostEqual(mode["hz"] / hz[mode["mode"]][0], 1, delta=1e-8)
                    self.assertEqual(mode["name"], hz[mode["mode"]][1])

    def test_the_page_holds_the_same_scene(self):
        for form in ([], ["--format", "html"]):
            page = Tags(self.expect(0, "show", self.model, *form).stdout)
            self.assertEqual(unpack(page.data["scene"]), parse(self.expect(0, "show", "--format", "json", self.model).stdout))

    def test_output_is_a_file_whole_or_not_at_all(self):
        done = self.expect(0, "show", self.model, "-o", "new/page.html")
        self.assertEqual(done.stdout, "")
        self.assertEqual((self.folder / "new/page.html").read_text(encoding="utf-8"), self.expect(0, "show", self.model).stdout)
        self.assertEqual([p.name for p in (self.folder / "new").iterdir()], ["page.html"])
        self.expect(0, "show", "--quiet", "--svg", self.model, "-o", "picture.svg")
        self.assertTrue((self.folder / "picture.svg").read_text(encoding="utf-8").startswith("<svg "))
        (self.folder / "kept.html").write_text("old", encoding="utf-8")
        self.expect(2, "show", "--svg", "--mode", "99", self.model, "-o", "kept.html")
        self.assertEqual((self.folder / "kept.html").read_text(encoding="utf-8"), "old")
        (self.folder / "taken").mkdir()
        self.assertNotEqual(self.run_program("show", self.model, "-o", "taken").returncode, 0)
        self.expect(2, "show", self.model, "-o", "taken/")

    def test_configuration_and_parameters_are_chosen(self):
        scene = parse(self.expect(0, "show", "--format", "json", "-c", "held", "--set", "k1=12", self.model).stdout)
        self.assertEqual([v["name"] for v in scene["designs"][0]["configurations"]], ["held"])
        self.assertIn({"name": "k1", "value": 12, "unit": "N/m", "display_unit": None, "display_factor": None}, scene["designs"][0]["parameters"])
        springs = {s["name"]: s["stiffness"] for s in scene["designs"][0]["configurations"][0]["springs"]}
        self.assertEqual(springs, {"s1": 12, "s2": 1})
        self.expect(2, "show", "-c", "nowhere", self.model)
        self.expect(2, "show", "--set", "m=-1", self.model)
        self.expect(2, "show", "--format", "text", self.model)
        self.expect(2, "show", "--mode", "1", self.model)
        self.expect(2, "show", "--model", self.model, self.model)

    def test_a_result_has_original_and_recommended_designs(self):
        self.write("studies/two.json", study(first_hz=0.15, second_hz=0.4))
        self.expect(0, "run", "--quiet", "studies/two.json")
        result = json.loads((self.folder / "results/two/result.json").read_text(encoding="utf-8"))
        scene = parse(self.expect(0, "show", "--format", "json", "-c", "held", "results/two/result.json").stdout)
        self.assertEqual([error.message for error in SCHEMA.iter_errors(scene)], [])
        ranks = [r["rank"] for r in result["recommendations"]]
        self.assertEqual([(d["label"], d["rank"]) for d in scene["designs"]], [("original", 0)] + [(f"recommended, rank {r}", r) for r in ranks])
        self.assertEqual(list(faults(scene)), [])
        for design, recommended in zip(scene["designs"][1:], result["recommendations"]):
            self.assertEqual([p["name"] for p in design["parameters"]], [p["name"] for p in recommended["parameters"]])
            for shown, told in zip(design["parameters"], recommended["parameters"]):
                self.assertAlmostEqual(shown["value"] / told["recommended"], 1, delta=1e-8)
            first = next(m for m in design["configurations"][0]["modes"] if m["mode"] == 1)
            self.assertAlmostEqual(first["hz"], 0.15, delta=1e-6)
            self.assertEqual(first["name"], "first")
        self.expect(2, "show", "--set", "k1=2", "results/two/result.json")
        (self.folder / self.model).write_text(MODEL.replace("Two masses", "Three masses"), encoding="utf-8")
        self.assertIn("is not found as it was", self.expect(2, "show", "results/two/result.json").stderr)
        changed = self.expect(0, "show", "--format", "json", "--model", self.model, "results/two/result.json")
        self.assertIn("has changed since", changed.stderr)

    def test_a_result_reads_its_model_below_the_root_of_its_study_only(self):
        here = self.folder / "a/b/c/d"  # far from it: below no folder that is looked into
        (here / "studies").mkdir(parents=True)
        far = str(self.folder / self.model)
        self.write("a/b/c/d/studies/two.json", json.dumps({**json.loads(study(first_hz=0.15, second_hz=0.4)), "model": far}))
        self.folder = here
        self.expect(0, "run", "--quiet", "--root", "../../../..", "studies/two.json")
        for command in ("show", "apply"):
            said = self.expect(2, command, "results/two/result.json").stderr
            self.assertIn("with --root a folder", said)
            self.expect(0, command, "--root", "../../../../problems", "results/two/result.json")
            self.expect(0, command, "--model", far, "results/two/result.json")
        pages = [self.expect(0, "report", "--format", "html", *root, "results/two/result.json").stdout
                 for root in ((), ("--root", "../../../.."))]
        self.assertEqual(['id="scene"' in page for page in pages], [False, True])

    def test_a_rod_is_drawn_and_keeps_its_length(self):
        path = self.write("rod.json", json.dumps({
            "format": "modetune-model/1", "dimension": 2,
            "bodies": [{"name": "a", "mass_kg": 1, "inertia_kg_m2": 0.1, "centre": [0, 0.3]},
                       {"name": "b", "mass_kg": 1, "inertia_kg_m2": 0.1, "centre": [1, 0.5]}],
            "joints": [{"name": "pa", "type": "revolute", "bodies": ["ground", "a"], "at": [0, 0]},
                       {"name": "pb", "type": "revolute", "bodies": ["ground", "b"], "at": [1, 0]},
                       {"name": "rod", "type": "distance", "bodies": ["a", "b"], "at": [[0.1, 0.4], [1.1, 0.7]]}],
            "springs": [{"name": "k", "type": "torsion", "joint": "pa", "stiffness_n_m_per_rad": 50}],
            "configurations": {"c": {}, "d": {"like": "c", "drive": {"joint": "pa", "position_rad": 0.2, "hold": {"trim": "k"}}}}}))
        scene = parse(self.expect(0, "show", "--format", "json", path).stdout)
        self.assertEqual([error.message for error in SCHEMA.iter_errors(scene)], [])
        self.assertEqual(list(faults(scene)), [])
        view = scene["designs"][0]["configurations"][0]
        self.assertEqual([j["from"] for j in view["joints"]], [None, None, [0.1, 0.4, 0]])
        rod = view["joints"][2]
        length = distance(rod["from"], rod["at"])

        def moved(mode, body, x):
            t, w, r = mode["motion"][body][:3], mode["motion"][body][5], [p - c for p, c in zip(x, view["bodies"][body]["at"])]
            return [t[0] - w * r[1], t[1] + w * r[0]]
        for mode in view["modes"]:
            v = [q - p for p, q in zip(moved(mode, rod["bodies"][0], rod["from"]), moved(mode, rod["bodies"][1], rod["at"]))]
            along = sum(a * (q - p) for a, p, q in zip(v, rod["from"], rod["at"])) / length
            self.assertLess(abs(along), 5e-5)  # motions of at most 1 have five digits, and four of them meet here
        self.assertGreaterEqual(len(view["modes"]), 1)
        # each body from its centre to its two joints, and the rod
        self.assertEqual(self.expect(0, "show", "--svg", path).stdout.count("<line"), 5)

    def test_what_cannot_be_analysed_is_told(self):
        path = self.write("ghost.json", '{"format": "modetune-model/1", "dimension": 2, "bodies": '
                                        '[{"name": "ghost", "mass_kg": 0, "inertia_kg_m2": 0, "centre": [1, 2]}]}')
        done = self.expect(0, "show", "--format", "json", path)
        self.assertEqual([error.message for error in SCHEMA.iter_errors(parse(done.stdout))], [])
        view = parse(done.stdout)["designs"][0]["configurations"][0]
        self.assertIn("neither mass nor stiffness", view["error"])
        self.assertIn(view["error"], done.stderr)
        self.assertEqual((len(view["bodies"]), view["modes"]), (2, []))

    def test_what_is_too_large_is_left_out_and_told(self):
        def chain(count, configurations):
            return self.write(f"problems/chain{count}.json", json.dumps({
                "format": "modetune-model/1", "dimension": 2, "configurations": {f"c{i}": {} for i in range(configurations)},
                "bodies": [{"name": f"b{i}", "mass_kg": 1, "inertia_kg_m2": 1e-5, "centre": [0.01 * i + 0.005, 0]} for i in range(count)],
                "joints": [{"name": f"j{i}", "type": "revolute", "bodies": [f"b{i - 1}" if i else "ground", f"b{i}"], "at": [0.01 * i, 0]} for i in range(count)],
                "springs": [{"name": f"k{i}", "type": "torsion", "joint": f"j{i}", "stiffness_n_m_per_rad": 1000} for i in range(count)]}))
        done = self.expect(0, "show", "--format", "json", chain(3000, 1))
        view = parse(done.stdout)["designs"][0]["configurations"][0]
        self.assertEqual(view["bodies"], [])
        self.assertIn("more than can be shown", view["error"])
        self.assertIn(view["error"], done.stderr)
        if not EVERY:
            return
        done = self.expect(0, "show", "--format", "json", chain(1000, 8))
        scene = parse(done.stdout)
        self.assertEqual(list(faults({**scene, "designs": [{"configurations": [v for v in scene["designs"][0]["configurations"] if not v["error"]]}]})), [])
        self.assertEqual([bool(v["error"]) for v in scene["designs"][0]["configurations"]], [False] * 6 + [True] * 2)
        self.assertIn("left out", scene["designs"][0]["configurations"][-1]["error"])
        self.assertIn("1 more like these", done.stderr)
        self.assertLess(len(done.stdout), 20e6)

    def test_a_joint_far_off_comes_first(self):
        text = MODEL.replace('"at": [2, 0], "axis": [1, 0] }', '"at": [7, 0], "axis": [1, 0] }', 1)
        scene = parse(self.expect(0, "show", "--format", "json", "-c", "held", self.write("problems/far.json", text)).stdout)
        self.assertEqual((scene["joints"][0]["joint"], scene["joints"][0]["body"]), ("rb", "b"))
        self.assertAlmostEqual(scene["joints"][0]["distance"], 5 - math.sqrt(2), delta=1e-4)  # of a disc of J = m r^2/2

    def test_names_never_become_markup(self):
        model = json.loads(MODEL)
        model["name"] = model["parameters"]["k1"]["description"] = HOSTILE
        plain = Tags(self.expect(0, "show", self.model).stdout)
        page = self.expect(0, "show", self.write("problems/hostile.json", json.dumps(model))).stdout
        self.assertNotIn("<img", page)
        tags = Tags(page)
        self.assertEqual((tags.tags, tags.attributes), (plain.tags, plain.attributes))
        self.assertEqual(unpack(tags.data["scene"])["model"], HOSTILE)
        svg = self.expect(0, "show", "--svg", "problems/hostile.json").stdout
        self.assertNotIn("<img", svg)
        self.assertIn(HOSTILE, "".join(ET.fromstring(svg).itertext()))

    def test_pictures_are_well_formed(self):
        for path in MODELS:
            with self.subTest(path.name):
                view = scene_of(path)["designs"][0]["configurations"][-1]
                first = min((m["mode"] for m in view["modes"] if m["mode"]), default=None)
                for more in ([], ["--mode", str(first)]):
                    svg = self.expect(0, "show", "--svg", "-c", view["name"], str(path), *more).stdout
                    root = ET.fromstring(svg)
                    self.assertEqual(re.findall(r"nan|inf|undefined", re.sub(r"<text.*?</text>", "", svg)), [])
                    said = "".join(root.itertext())
                    self.assertIn(view["name"], said)
                    self.assertTrue(all(j["name"] in said for j in view["joints"]))
        self.assertIn("shows no vibration mode", self.expect(2, "show", "--svg", "--mode", "50", self.model).stderr)


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""
What commands print as JSON is what their schemas say. Every command with a schema has command lines here, which print every member of it;
those that may be absent are absent once, and what may be null is null once, unless it is excused. Changed answers are refused.
The tests of cli/ hold every other command line against the schemas, too (cli/common_cli.py).
"""
import copy
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from common_schema import at, changed

TESTS = Path(__file__).resolve().parents[1]
sys.path.append(str(TESTS / "support"))
import large  # noqa: E402
import printed  # noqa: E402
from suite import PROGRAM, SOURCE  # noqa: E402

WRITTEN = "tests/result/written_by"
# The models: "tests/..." and "problems/..." are files, the others are made here.
LINES = {
    "check": [
        ["problems/stick.json", "tests/models/apart.json", "problems/aircraft.json", "studies/stick.json", "none.json"],
        ["tests/documents/wrong/beams.json", "tests/documents/wrong/aircraft_format.json"],
    ],
    "diff": [
        [f"{WRITTEN}/2026-11-20/inceptor_tuning_1.json", f"{WRITTEN}/2026-11-25/inceptor_catalogue.json"],
    ],
    "examples": [[]],
    "modes": [
        ["tests/models/pendulum.json", "--shapes"],
        ["tests/models/massless.json"],
        ["wheel.json", "--effective-mass"],
        ["tests/models/apart.json"],
        ["tests/models/ring.json", "--energy"],
        ["tests/models/space_stick.json", "-c", "plain", "--energy"],
        ["tests/models/damped_linkage.json", "--damped"],
        ["problems/stick.json", "-c", "installed", "--shapes"],
        ["tests/models/falling.json", "-c", "default"],
        ["link.json", "--count", "2"],
        ["link.json", "--count", "2", "--damped"],
        ["loop.json", "--count", "2"],
        ["standing.json", "--damped"],
    ],
    "mac": [
        ["problems/inceptor.json:installed", "problems/inceptor.json:table_8"],
        ["tests/models/ring.json", "tests/models/ring.json", "--count", "8"],
    ],
    "response": [
        ["one.json", "--input", "a.x", "--poles", "--points", "4"],
        ["one.json", "--input", "a.x", "--input", "base.x", "--state-space", "space.json", "--points", "4", "-c", "default"],
        ["one.json", "--input", "base.x", "--poles", "--points", "4"],
        ["one.json", "--input", "a.x", "--sensitivity", "k", "--points", "4"],
        ["one.json", "--input", "a.x", "--sensitivity", "k", "--points", "4", "--set", "c=0"],
        ["one.json", "--input", "base.x", "--vibration", "profile.json", "--points", "4"],
        ["one.json", "--vibration", "along.json", "--points", "4", "--set", "c=0"],
        ["one.json", "--input", "base.x", "--measure", "a.x", "--vibration", "helicopter_uh60_panel", "--points", "4"],
        ["one.json", "--input", "a.x", "--from", "1", "--to", "2", "--points", "3", "--set", "k=0"],
        ["free.json", "--input", "a.x", "--from", "1", "--to", "2", "--points", "3", "--poles"],
        ["link.json", "--input", "base.y", "--measure", "joint.root.y", "--points", "4"],
        ["tests/models/apart.json", "--input", "base.x"],
    ],
    "sensitivity": [
        ["tests/models/pendulum.json", "-c", "twice"],
        ["tests/models/four_bar.json", "--count", "1"],
        ["tests/models/apart.json"],
        ["problems/stick.json", "--count", "1"],
        ["cranks.json"],
    ],
    "profile": [
        [],
        ["helicopter_sine_on_random"],
        ["gevs_qualification", "--spectrum", "5:500:3"],
        ["shaken.json", "--spectrum", "17:18:1"],
    ],
    "info": [
        ["studies/stick.json"],
        ["problems/profiles/helicopter_sine_on_random.json"],
        ["problems/measurements/three_masses.csv"],
        ["shaken.json"],
        [f"{WRITTEN}/2026-11-25/inceptor_tuning_1.json"],
        ["problems/stick.json"],
        ["problems/stick.json", "-c", "free"],
        ["about.json"],
    ],
    "schema": [[]],
    "simulate": [
        ["tests/models/pendulum.json", "-c", "hanging", "--start", "pivot=0.5", "--duration", "8"],
        ["tests/models/pendulum.json", "-c", "hanging", "--start", "pivot=0.5", "--duration", "0.01", "--dt-out", "0.005"],
        ["tests/models/pendulum.json", "-c", "hanging", "--sine", "base.x=0.1@0.5", "--duration", "8"],
        ["tests/models/pendulum.json", "-c", "hanging", "--sine", "base.x=0.1@0.5", "--duration", "0.1"],
        ["problems/den_hartog.json", "--vibration", "base.x=shaken.json", "--duration", "0.5"],
        ["problems/den_hartog.json", "--vibration", "base.x=gevs_qualification", "--duration", "0.1"],
    ],
    "sweep": [
        ["slider.json", "--drive", "bore=-0.1:0.11715:5"],
        ["tests/models/apart.json", "--drive", "root=0:0.1:2"],
        ["tests/models/driven_rod.json", "--drive", "pivot=0:30*deg:3", "--frequencies", "--hold", "servo"],
        ["tests/models/driven_arm.json", "--drive", "shoulder=0:0.3:3", "--drive", "elbow=0:0.4:3", "--hold", "elbow=elbow_servo"],
        ["gantry.json", "--drive", "bridge=0:0.2:2", "--drive", "hoist=0:0.1:2", "--grid"],
    ],
}
# What is of studies alone, or of several commands, and not seen in these lines as null, absent, or as something else.
EXCUSED = {
    "check": {"doubt/file"},
    "modes": {"doubt/configuration", "doubt/file", "doubt/line", "doubt/column", "doubt/pointer"},
    # one mass has damping, and is seen by its acceleration
    "profile": {f"mass/{name}" for name in ("rms", "rms_error_at_most", "sine", "peak", "rms_g", "sine_g", "peak_g")}
    | {f"vibrated_tone/{name}" for name in ("frequency_hz", "peak", "excess_at_most")},
}
# A pendulum upside down, which its spring holds so that rounding hides whether it stands.
STANDING = {
    "format": "modetune-model/1", "dimension": 2, "gravity_m_per_s2": [0, -8],
    "bodies": [{"name": "bob", "mass_kg": 1, "inertia_kg_m2": 1, "centre": [0, 1]}],
    "joints": [{"name": "pin", "type": "revolute", "bodies": ["ground", "bob"], "at": [0, 0]}],
    "springs": [{"name": "k", "type": "torsion", "joint": "pin", "stiffness_n_m_per_rad": 8}],
}
# A bridge that goes along x, and a load that it lifts.
GANTRY = {
    "format": "modetune-model/1", "name": "Gantry", "dimension": 2, "gravity_m_per_s2": [0, -9.81],
    "bodies": [{"name": name, "mass_kg": 3, "inertia_kg_m2": 0.1, "centre": [0, at]} for name, at in (("bridge", 0), ("load", -1))],
    "joints": [{"name": "bridge", "type": "prismatic", "bodies": ["ground", "bridge"], "at": [0, 0], "axis": [1, 0]},
               {"name": "hoist", "type": "prismatic", "bodies": ["bridge", "load"], "at": [0, -1], "axis": [0, 1]}],
}
# A crank of 0.1 m, drawn upright, a rod of 0.3 m and a piston along x.
SLIDER = {
    "format": "modetune-model/1", "dimension": 2,
    "points": {"pin": [0, 0.1], "end": ["sqrt(0.08)", 0]},
    "bodies": [{"name": name, "mass_kg": 1, "inertia_kg_m2": 0.01, "centre": at} for name, at in (("crank", [0, 0]), ("rod", "pin"), ("piston", "end"))],
    "joints": [
        {"name": "shaft", "type": "revolute", "bodies": ["ground", "crank"], "at": [0, 0]},
        {"name": "big_end", "type": "revolute", "bodies": ["crank", "rod"], "at": "pin"},
        {"name": "small_end", "type": "revolute", "bodies": ["rod", "piston"], "at": "end"},
        {"name": "bore", "type": "prismatic", "bodies": ["ground", "piston"], "at": "end", "axis": [1, 0]},
    ],
}
# Along an axis, with and without an origin.
SHAKEN = {
    "format": "modetune-profile/1", "axis": "x", "random": {"psd_g2_per_hz": [[5, 0.01], [50, 0.01]]},
    "tones": [{"frequency_hz": [16, 19], "acceleration_g": 1.5, "origin": "assumed"}, {"frequency_hz": [60, 70], "acceleration_g": 1}],
}

# A mass on a rail.
ONE = {
    "format": "modetune-model/1", "dimension": 2, "parameters": {"k": 200, "c": 0.4},
    "bodies": [{"name": "a", "mass_kg": 2, "inertia_kg_m2": 1, "centre": [1, 0]}],
    "joints": [{"name": "rail", "type": "prismatic", "bodies": ["ground", "a"], "at": [1, 0], "axis": [1, 0]}],
    "springs": [{"name": "s", "type": "axial", "bodies": ["ground", "a"], "at": [[0, 0], [1, 0]], "stiffness_n_per_m": "k"}],
    "dampers": [{"name": "d", "type": "axial", "bodies": ["ground", "a"], "at": [[0, 0], [1, 0]], "damping_n_s_per_m": "c"}],
    "sensors": [{"name": "a", "on": "a", "directions": ["x"]}],
}
FREE = {**{key: value for key, value in ONE.items() if key not in ("springs", "dampers")}}
PROFILE = {"format": "modetune-profile/1", "random": {"psd_g2_per_hz": [[0.5, 0.001], [60, 0.02]]}, "tones": [{"frequency_hz": [1, 2], "acceleration_g": 0.1}]}

# A study that says all of itself.
ABOUT = {
    "format": "modetune-study/1", "name": "about", "description": "All of it.", "author": "A. Person", "revision": "2", "date": "2026-11-28",
    "model": "one.json", "variables": [{"parameter": "k", "lower": 100, "upper": 400}],
}

# A wheel without mass: no mass that a share could be of.
WHEEL = {
    "format": "modetune-model/1", "dimension": 2, "bodies": [{"name": "wheel", "mass_kg": 0, "inertia_kg_m2": 1, "centre": [0, 0]}],
    "joints": [{"name": "axle", "type": "revolute", "bodies": ["ground", "wheel"], "at": [0, 0]}],
    "springs": [{"name": "s", "type": "torsion", "joint": "axle", "stiffness_n_m_per_rad": 1}],
}

# Parallel cranks, the last with a length of its own: no length but the drawn one closes the joints.
CRANKS = {
    "format": "modetune-model/1", "dimension": 2, "parameters": {"far": 3, "other": 3},
    "bodies": [{"name": f"crank{i}", "mass_kg": 1, "inertia_kg_m2": 1, "centre": [4 * i, 1]} for i in range(3)]
    + [{"name": "coupler", "mass_kg": 1, "inertia_kg_m2": 1, "centre": [4, 3]}],
    "joints": [{"name": f"foot{i}", "type": "revolute", "bodies": ["ground", f"crank{i}"], "at": [4 * i, 0]} for i in range(3)]
    + [{"name": f"head{i}", "type": "revolute", "bodies": [f"crank{i}", "coupler"], "at": [[4 * i, y], [4 * i, 3]]} for i, y in enumerate((3, "other", "far"))],
    "springs": [{"name": "k", "type": "torsion", "joint": "foot0", "stiffness_n_m_per_rad": 8}],
}


def loop():
    """A link whose end lies in a slot, and in the same once more: an equation follows from another."""
    slot = {"type": "pin-in-slot", "bodies": ["ground", "beam.end"], "at": "tip", "axis": [1, 0]}
    model = large.link(100)
    model["joints"] += [{"name": f"tip{i}", **slot} for i in range(2)]
    return model


def schema_of(command):
    return json.loads((SOURCE / f"schemas/command_{command}.schema.json").read_text(encoding="utf-8"))


def commands():
    return sorted(path.name[len("command_"):-len(".schema.json")] for path in (SOURCE / "schemas").glob("command_*.schema.json"))


class Seen:
    """Which members of a schema have been there, absent, null and something else."""

    def __init__(self, schema):
        self.schema, self.there, self.absent, self.null, self.value = schema, set(), set(), set(), set()
        self.all, self.optional, self.nullable = set(), set(), set()

    def look(self, part, value, name=""):
        if "$ref" in part:
            name = part["$ref"].rsplit("/", 1)[1]
            part = self.schema["definitions"][name]
        for one in part.get("anyOf", []) + part.get("allOf", []):
            if self.fits(one, value):
                self.look(one, value, name)
        if "if" in part and value is not None:
            self.look(part["then"], value, name)
        if isinstance(value, list) and "items" in part:
            for item in value:
                self.look(part["items"], item, name)
        if isinstance(value, dict) and "properties" in part:
            for key, inner in part["properties"].items():
                place = f"{name}/{key}" if name else key
                if key not in value:
                    self.absent.add(place)
                    continue
                self.there.add(place)
                (self.null if value[key] is None else self.value).add(place)
                self.look(inner, value[key], place)

    def fits(self, part, value):
        part = self.schema["definitions"][part["$ref"].rsplit("/", 1)[1]] if "$ref" in part else part
        return isinstance(value, dict) == ("properties" in part) and (not isinstance(value, dict) or set(part.get("required", [])) <= set(value))

    def want(self, part=None, name=""):
        """What is to be seen."""
        part = self.schema if part is None else part
        if "properties" in part:
            for key, inner in part["properties"].items():
                place = f"{name}/{key}" if name else key
                self.all.add(place)
                self.optional |= {place} if key not in part.get("required", []) else set()
                kinds = inner.get("type", [])
                self.nullable |= {place} if "null" in (kinds if isinstance(kinds, list) else [kinds]) or "if" in inner else set()
                for below in (inner, inner.get("items", {}), inner.get("then", {})):
                    self.want(below, place)
        if not name:
            for below, definition in part.get("definitions", {}).items():
                self.want(definition, below)


class Answers(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.kept = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.kept.name)
        for name in ("tests", "problems", "studies"):
            (cls.folder / name).symlink_to(SOURCE / name)
        for name, model in (("link", large.link(100)), ("loop", loop()), ("standing", STANDING), ("cranks", CRANKS),
                            ("slider", SLIDER), ("gantry", GANTRY), ("shaken", SHAKEN), ("one", ONE), ("free", FREE), ("profile", PROFILE),
                            ("along", {**PROFILE, "axis": "x"}), ("about", ABOUT), ("wheel", WHEEL)):
            (cls.folder / f"{name}.json").write_text(json.dumps(model), encoding="utf-8")
        cls.answers = {command: [cls.printed(command, line) for line in lines] for command, lines in LINES.items()}

    @classmethod
    def tearDownClass(cls):
        cls.kept.cleanup()

    @classmethod
    def printed(cls, command, line):
        return subprocess.run([PROGRAM, command, *line, "--format", "json"], cwd=cls.folder, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                              encoding="utf-8", check=False).stdout

    def test_every_schema_has_command_lines(self):
        self.assertEqual(sorted(LINES), commands())

    def test_answers_are_what_the_schemas_say(self):
        for command, lines in LINES.items():
            for line, text in zip(lines, self.answers[command]):
                self.assertNotEqual(text, "", [command, *line])
                self.assertEqual(printed.faults([command, *line, "--format", "json"], text), [], [command, *line])

    def test_all_that_the_schemas_say_is_printed(self):
        for command, texts in self.answers.items():
            schema = schema_of(command)
            seen = Seen(schema)
            seen.want()
            for text in texts:
                seen.look(schema, json.loads(text))
            excused = EXCUSED.get(command, set())
            self.assertEqual(seen.all - seen.value - excused, set(), f"{command}: nowhere, or null everywhere")
            self.assertEqual(seen.optional - seen.absent - excused, set(), f"{command}: always there")
            self.assertEqual(seen.nullable - seen.null - excused, set(), f"{command}: never null")

    def test_a_changed_answer_is_refused(self):
        for command, texts in self.answers.items():
            answer = json.loads(texts[0])
            path = (0,) if isinstance(answer, list) else ()
            inner = at(answer, path)
            for key in inner:
                for change in ("rename", ("type", {"x": []})):
                    wrong = changed(copy.deepcopy(answer), (*path, key), change)
                    self.assertNotEqual(printed.faults([command, "--format", "json"], json.dumps(wrong)), [], f"{command}: {key}: {change}")

    def test_the_program_prints_the_schemas(self):
        for command in commands():
            for name in {f"command_{command}", command if not (SOURCE / f"schemas/{command}.schema.json").exists() else f"command_{command}"}:
                done = subprocess.run([PROGRAM, "schema", name], stdout=subprocess.PIPE, encoding="utf-8", check=True)
                self.assertEqual(json.loads(done.stdout), schema_of(command), name)


if __name__ == "__main__":
    unittest.main()

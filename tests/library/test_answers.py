# SPDX-License-Identifier: GPL-3.0-or-later
"""What modetune.Model answers is what the commands print: of every fifth model of the tree, of all of them where MT_EVERY says so, and of the same with
values of parameters."""
import json
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1] / "support"))
from test_python import SOURCE, modetune  # noqa: E402
from modetune import _models  # noqa: E402
from suite import EVERY, PROGRAM  # noqa: E402


def models():
    """(path, what it holds) of each model."""
    found = []
    for path in sorted([*SOURCE.glob("tests/models/*.json"), *SOURCE.glob("problems/*.json")]):
        held = json.loads(path.read_text(encoding="utf-8"))
        if isinstance(held, dict) and str(held.get("format", "")).startswith("modetune-model/"):
            found.append((path, held))
    return found if EVERY else found[::5]


def names(held, what):
    listed = held.get(what, [])
    return list(listed) if isinstance(listed, dict) else [item["name"] for item in listed]


def printed(*line):
    """What the command prints as JSON, or None where it has no answer at all."""
    done = subprocess.run([PROGRAM, *map(str, line), "--format", "json"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, encoding="utf-8", check=False)
    return done.stdout or None


def answered(model, name, arguments):
    """The text of the library, before Python reads it: by the same dump, or None where it fails."""
    texts = []
    before = _models.text_made
    _models.text_made = lambda *given: texts.append(before(*given)) or texts[-1]
    try:
        getattr(model, name)(*arguments.pop("of", ()), **arguments)
    except modetune.Error:
        return None
    finally:
        _models.text_made = before
    return texts[-1]


def questions(path, held):
    """(name, arguments in Python, command line)"""
    configurations, parameters, joints, sensors = (names(held, what) for what in ("configurations", "parameters", "joints", "sensors"))
    one = configurations[-1:]
    named = ["-c", *one] if one else []
    yield "modes", {}, [path]
    yield "modes", {"of": one, "shapes": True, "count": 3}, [path, *named, "--shapes", "--count", "3"]
    yield "modes", {"damped": True, "count": "all"}, [path, "--damped", "--count", "all"]
    yield "modes", {"effective_mass": True, "about_m": (0.1, 0.2, 0.3)}, [path, "--effective-mass", "--about", "0.1,0.2,0.3"]
    yield "modes", {"energy": True, "energy_axes": "principal"}, [path, "--energy", "--axes", "principal"]
    yield "sensitivity", {"count": 2}, [path, "--count", "2"]
    for parameter in parameters[:1]:
        setting = {"set": {parameter: f"1.01*{parameter}"}}
        line = [path, *named, "--set", f"{parameter}=1.01*{parameter}"]
        yield "modes", {"of": one, **setting}, line
        yield "sensitivity", {"of": one, "parameters": [parameter], **setting}, [*line, "--parameters", parameter]
        yield "response", {"of": ("base.x", None, *one), "parameters": [parameter], "points": 3, "start_hz": 1, "end_hz": "3*2", **setting}, [
            *line, "--input", "base.x", "--points", "3", "--from", "1", "--to", "3*2", "--sensitivity", parameter]
    yield "response", {"of": ("base.y",), "points": 4, "poles": True, "log": True}, [path, "--input", "base.y", "--points", "4", "--poles", "--log"]
    yield "response", {"of": ("base.x", sensors[:1] and f"{sensors[0]}.x"), "points": 3, "vibration": SHAKING}, [
        path, "--input", "base.x", *(["--measure", f"{sensors[0]}.x"] if sensors else []), "--points", "3", "--vibration", SHAKING]
    for joint in joints[:1]:
        yield "sweep", {"of": (f"{joint}=0:0.02:3", *one), "frequencies": True, "count": 2}, [
            path, *named, "--drive", f"{joint}=0:0.02:3", "--frequencies", "--count", "2"]
    a, b = configurations[:1] or [None], configurations[-1:] or [None]
    yield "mac", {"of": (None, *a, *b)}, [":".join([str(path), *filter(None, side)]) for side in (a, b)]


SHAKING = SOURCE / "problems/profiles/gevs_qualification.json"


class Answers(unittest.TestCase):
    def test_answers_are_what_the_commands_print(self):
        answers = dict.fromkeys(("modes", "mac", "sensitivity", "response", "sweep"), 0)
        for path, held in models():
            model = modetune.Model(path)
            for name, arguments, line in questions(path, held):
                with self.subTest(line=[name, *map(str, line)]):
                    text = answered(model, name, arguments)
                    self.assertEqual(text, self.of_the_command(name, line))
                    answers[name] += text is not None
        self.assertGreater(min(answers.values()), 2, answers)

    def of_the_command(self, name, line):
        """None of a named configuration that has no answer: there the library fails."""
        text = printed(name, *line)
        if text is not None and "-c" in line:
            return None if "error" in json.loads(text) and "configuration" in json.loads(text) and len(json.loads(text)) == 2 else text
        return text

    def test_a_dict_and_expressions_are_taken(self):
        path = SOURCE / "problems/stick.json"
        held = json.loads(path.read_text(encoding="utf-8"))
        modes = modetune.Model(held).modes("installed", set={"k_servo": 2000})
        self.assertEqual(modes["modes"], json.loads(printed("modes", path, "-c", "installed", "--set", "k_servo=2000"))["modes"])
        self.assertEqual(modetune.Model(held).sweep("pivot=0:0.01:2", "installed")["points"][1]["position_rad"], 0.01)

    def test_several_joints_and_energies_about_a_point(self):
        arm = SOURCE / "tests/models/driven_arm.json"
        drives = ["shoulder=0:0.4:2", "elbow=0.5:0.9:2"]
        for arguments, line in (({}, ()), ({"grid": True, "hold": ["elbow=elbow_servo"], "frequencies": True}, ("--grid", "--hold", "elbow=elbow_servo", "--frequencies"))):
            text = answered(modetune.Model(arm), "sweep", {"of": (drives, "drawn"), **arguments})
            self.assertEqual(text, printed("sweep", arm, "-c", "drawn", "--drive", drives[0], "--drive", drives[1], *line))
            self.assertEqual(len(json.loads(text)["points"]), 4 if arguments else 2)
        path = SOURCE / "problems/pump_on_mounts.json"
        text = answered(modetune.Model(path), "modes", {"energy": True, "energy_about": "front_left"})
        self.assertEqual(text, printed("modes", path, "--energy", "--energy-about", "front_left"))
        self.assertIsNotNone(text)

    def test_what_is_wrong_is_told(self):
        model = modetune.Model(SOURCE / "problems/stick.json")
        for call, status, said in (
                (lambda: model.modes("instaled"), "MT_E_USAGE", 'did you mean "installed"'),
                (lambda: model.modes(set={"k": 1}), "MT_E_USAGE", "k"),
                (lambda: model.modes(count=-1), "MT_E_USAGE", "count of the options is negative"),
                (lambda: model.response(), "MT_E_USAGE", "--input"),
                (lambda: model.sweep([]), "MT_E_USAGE", "--drive"),
                (lambda: model.mac(), "MT_E_USAGE", "name one"),
                (lambda: model.sensitivity(parameters=["nothing"]), "MT_E_USAGE", "unknown parameter")):
            with self.assertRaises(modetune.Error) as caught:
                call()
            self.assertEqual(caught.exception.status, status)
            self.assertIn(said, str(caught.exception))


if __name__ == "__main__":
    unittest.main()

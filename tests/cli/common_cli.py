# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests of the command line share: running the program, and small files to run it on."""
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1] / "support"))
from printed import faults  # noqa: E402
from suite import PROGRAM, SOURCE  # noqa: E402, F401  for who imports them from here, too
COMMANDS = ["run", "merge", "compare", "modes", "mac", "sweep", "simulate", "sensitivity", "response", "info", "show", "report", "explain", "apply", "diff", "check",
            "init", "examples", "schema", "profile", "help"]

# Two masses of 1 kg, ground - k1 - a - k2 - b, moving in x: omega^2 = 0.6972, 4.3028 for k1 = 3, k2 = 1 (closed form:
# omega^4 - (k1 + 2 k2) omega^2 + k1 k2 = 0); "twice" has a redundant joint, "free" no k1, "heavy" other masses.
MODEL = """{ "format": "modetune-model/1", "name": "Two masses", "dimension": 2,
  "parameters": { "k1": { "value": 3, "unit": "N/m" },  "k2": {"value":1e0, "unit": "N/m", "description": "gr\u00f6\u00dfer"},
                  "m": 1.0, "both": "k1+k2" },
  "points": { "o": [0, 0] },
  "bodies": [ { "name": "a", "mass_kg": "m", "inertia_kg_m2": 1, "centre": [1, 0] },
              { "name": "b", "mass_kg": "m", "inertia_kg_m2": 1, "centre": [2, 0] } ],
  "joints": [ { "name": "ra", "type": "prismatic", "bodies": ["ground", "a"], "at": [1, 0], "axis": [1, 0] },
              { "name": "rb", "type": "prismatic", "bodies": ["ground", "b"], "at": [2, 0], "axis": [1, 0] },
              { "name": "rc", "type": "prismatic", "bodies": ["ground", "b"], "at": [2, 0], "axis": [1, 0],
                "in": ["twice"] } ],
  "springs": [ { "name": "s1", "type": "axial", "bodies": ["ground", "a"], "at": ["o", [1, 0]],
                 "stiffness_n_per_m": "k1", "in": ["held", "twice", "heavy"] },
               { "name": "s2", "type": "axial", "bodies": ["a", "b"], "stiffness_n_per_m": "k2" } ],
  "sensors": [ { "name": "a", "on": "a", "directions": ["x"] }, { "name": "b", "on": "b", "directions": ["x"] } ],
  "modes": { "first": { "configuration": "held", "index": 1 } },
  "configurations": { "held": {}, "twice": {}, "free": {}, "heavy": { "parameters": { "m": 4 } } } }
"""
# Two equal springs at right angles hold a mass: its two modes are repeated, and each spring moves one of them.
REPEATED = """{ "format": "modetune-model/1", "dimension": 2,
  "parameters": { "kx": 100, "ky": 100 },
  "bodies": [ { "name": "p", "mass_kg": 1, "centre": [0, 0] } ],
  "springs": [ { "name": "sx", "type": "axial", "bodies": ["ground", "p"], "at": [[-1, 0], [0, 0]],
                 "stiffness_n_per_m": "kx" },
               { "name": "sy", "type": "axial", "bodies": ["ground", "p"], "at": [[0, -1], [0, 0]],
                 "stiffness_n_per_m": "ky" } ] }
"""
# A massless body without any stiffness.
MASSLESS = """{ "format": "modetune-model/1", "dimension": 2,
  "bodies": [ { "name": "ghost", "mass_kg": 0, "centre": [0, 0] } ] }
"""


def study(first_hz="sqrt((5-sqrt(13))/2)/(2*pi)", second_hz="sqrt((5+sqrt(13))/2)/(2*pi)", lower=0.1, extra=""):
    """Asks for the frequencies of the original design, unless others are given: (k1, k2) = (3, 1) and (2, 1.5) solve it."""
    return json.dumps({
        "format": "modetune-study/1", "name": "Two springs", "model": "../problems/model.json",
        "variables": [{"parameter": "k1", "lower": lower, "upper": 100}, {"parameter": "k2", "lower": lower, "upper": 100}],
        "goals": [{"type": "frequency", "configuration": "held", "mode": "first", "target_hz": first_hz},
                  {"type": "frequency", "configuration": "held", "mode": 2, "target_hz": second_hz}]
    })[:-1] + extra + "}"


class CliTest(unittest.TestCase):
    maxDiff = None

    def setUp(self):
        self._folder = tempfile.TemporaryDirectory()
        self.addCleanup(self._folder.cleanup)
        self.folder = Path(self._folder.name)
        (self.folder / "problems").mkdir()
        (self.folder / "studies").mkdir()
        self.model = self.write("problems/model.json", MODEL)

    def write(self, name, text):
        path = self.folder / name
        path.write_text(text, encoding="utf-8")
        return name

    def run_program(self, *args, env=None, **more):
        """Run in the test's folder; strings come back."""
        environment = dict(os.environ, **(env or {}))
        done = subprocess.run([PROGRAM, *args], cwd=self.folder, env=environment, capture_output=True,
                              encoding="utf-8", timeout=600, **more)
        self.assertEqual(faults([str(arg) for arg in args], done.stdout), [], args)
        return done

    def expect(self, code, *args, **more):
        done = self.run_program(*args, **more)
        self.assertEqual(done.returncode, code, f"{args}: {done.stdout}\n{done.stderr}")
        return done

    def json_of(self, *args, code=0):
        return json.loads(self.expect(code, *args, "--format", "json").stdout)


def options_in(text):
    return set(re.findall(r"(?<![\w-])--([a-z][a-z-]*)", text))


def main():
    unittest.main(verbosity=1)

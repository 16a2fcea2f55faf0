# SPDX-License-Identifier: GPL-3.0-or-later
"""
Slopes of repeated modes in space, by the order of differences. A hub with arms around it, on a bushing: the arms are welded to it with
levers (rigid members), a tip hangs from each by a leaf, tips are coupled to their neighbours in a ring and held by stays of no stiffness.
Turned by one arm the hub is the same, so modes come in pairs. A parameter of all arms keeps the pairs, one of a single arm splits them:
    lambda_j(p + h) = lambda + h d_j + O(h^2),   d the set of directional derivatives, which at -h stand the other way round,
and the central difference of each branch is off d_j by a term in h^2: a quarter of it at h/2, unless both are rounding. So it is where a
stiffness is 0 itself.
"""
import json
import math
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

PROGRAM = os.environ["MODETUNE"]
PARAMETERS = {"k": 2000.0, "c": 300.0, "e": 0.0, "r": 0.4, "h": 0.1, "m": 0.5, "s": 700.0, "d": 0.0, "u": 0.0, "v": 0.0}
SCALE = {"e": 300.0, "d": 100.0, "u": 0.1, "v": 0.5}  # of what is 0
STEP = 0.02         # of a parameter's size
ROUNDING = 1e-8     # of frequencies over sizes of parameters: what a difference of eigenvalues to 1e-13 leaves at h/2, times ten
MODES = 9


def hub(arms, lever):
    """`e` is of one coupling, `d` of the stays of all arms but the first, `u` lengthens the lever of one arm, `v` adds to its mass."""
    def at(i, radius, height):
        return [f"({radius})*cos(2*pi*{i}/{arms})", f"({radius})*sin(2*pi*{i}/{arms})", height]

    model = {"format": "modetune-model/1", "dimension": 3, "parameters": PARAMETERS, "joints": [], "configurations": {"c": {}},
             "bodies": [{"name": "hub", "mass_kg": "4*m", "inertia_kg_m2": [0.05, 0.05, 0.08], "centre": [0, 0, 0]}],
             "springs": [{"name": "foot", "type": "bushing", "bodies": ["ground", "hub"], "at": [0, 0, "-h"],
                          "stiffness_n_per_m": ["k", "k", "3*k"], "stiffness_n_m_per_rad": ["0.3*k", "0.3*k", "0.2*k"]}]}
    for i in range(arms):
        own = "r + u" if i == 0 else "r"
        model["bodies"] += [{"name": f"arm{i}", "mass_kg": "m", "inertia_kg_m2": [0.002, 0.002, 0.002], "centre": at(i, f"0.5*({own})", f"{lever}*h")},
                            {"name": f"tip{i}", "mass_kg": "0.6*m + v" if i == 0 else "0.6*m", "inertia_kg_m2": [0.001, 0.001, 0.001], "centre": at(i, "r", "h")}]
        model["joints"].append({"name": f"weld{i}", "type": "fixed", "bodies": ["hub", f"arm{i}"], "at": at(i, "0.2*r", 0)})
        model["springs"] += [{"name": f"leaf{i}", "type": "bushing", "bodies": [f"arm{i}", f"tip{i}"], "at": at(i, "0.9*r", "0.7*h"),
                              "stiffness_n_per_m": ["s", "s", "s"], "stiffness_n_m_per_rad": ["0.02*s"] * 3},
                             {"name": f"ring{i}", "type": "axial", "bodies": [f"tip{i}", f"tip{(i + 1) % arms}"], "at": [at(i, "r", "h"), at((i + 1) % arms, "r", "h")],
                              "stiffness_n_per_m": "c + e" if i == 0 else "c"}]
        if i > 0:
            model["springs"].append({"name": f"stay{i}", "type": "axial", "bodies": ["ground", f"tip{i}"], "at": [at(i, "1.7*r", 0.5), at(i, "r", "h")], "stiffness_n_per_m": "d"})
    return model


class ClusterSlopes(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = Path(self.folder.name) / "hub.json"

    def json_of(self, *arguments):
        done = subprocess.run([PROGRAM, *arguments, "--quiet", "--format", "json"], capture_output=True, text=True, timeout=60, check=True)
        return json.loads(done.stdout)[0]

    def frequencies(self, name, value):
        """One more than is looked at: no pair is cut."""
        modes = self.json_of("modes", self.path, "--count", str(MODES + 1), "--set", f"{name}={value!r}")["modes"]
        return [m["frequency_hz"] for m in modes]

    def errors(self, name, sets, slopes):
        """Of each branch, at h and at h/2."""
        out = []
        for part in (1.0, 0.5):
            h = STEP * part * (abs(PARAMETERS[name]) or SCALE[name])
            up, down = self.frequencies(name, PARAMETERS[name] + h), self.frequencies(name, PARAMETERS[name] - h)
            out.append([slopes[i] - (up[i] - down[pair[0] + pair[-1] - i]) / (2 * h) for pair in sets for i in pair])
        return out

    def test_clusters_move_as_their_set_says(self):
        for arms, lever in ((3, 0.2), (5, -0.6)):
            self.path.write_text(json.dumps(hub(arms, lever)), encoding="utf-8")
            modes = self.json_of("sensitivity", self.path, "--count", str(MODES))["modes"]
            hz = [m["frequency_hz"] for m in modes]
            sets = [[i] for i in range(MODES) if not modes[i]["repeated"]]
            sets += [[i, i + 1] for i in range(MODES - 1) if modes[i]["repeated"] and abs(hz[i + 1] / hz[i] - 1) < 1e-9]
            self.assertGreater(sum(len(s) == 2 for s in sets), 2)
            split = 0
            for number, name in enumerate(PARAMETERS):
                slopes = [m["sensitivities"][number]["hz_per_unit"] for m in modes]
                self.assertEqual(modes[0]["sensitivities"][number]["parameter"], name)
                size = abs(PARAMETERS[name]) or SCALE[name]
                coarse, fine = self.errors(name, sets, slopes)
                self.assertEqual(len(coarse), len(fine))
                for k, i in enumerate(i for pair in sets for i in pair):
                    with self.subTest(arms=arms, parameter=name, mode=i + 1):
                        rounding = ROUNDING * hz[i] / size
                        self.assertTrue(abs(fine[k]) <= rounding or 3.5 <= coarse[k] / fine[k] <= 4.5, (slopes[i], coarse[k], fine[k], rounding))
                for pair in sets:
                    split += len(pair) == 2 and math.fabs(slopes[pair[1]] - slopes[pair[0]]) * size > 1e-3
            self.assertGreaterEqual(split, 6)


if __name__ == "__main__":
    unittest.main()

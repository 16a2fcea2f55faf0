# SPDX-License-Identifier: GPL-3.0-or-later
"""
Sensors within a beam element: deflections are cubic along it, and what rotates is their slope; with shear, the slope less the shear angle,
which is one number for the whole element. In every mode, in the plane and in both planes of a beam in space. The slope is that of the cubic
through four of the deflections.
"""
import json
import math
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

PROGRAM = os.environ["MODETUNE"]
ELEMENTS, PLACES, LENGTH = 2, 7, 1.5  # places in each element


def fraction(element, place):
    return (element + place / (PLACES - 1)) / ELEMENTS


def model(dimension, shear):
    link = {"name": "rod", "kind": "beam", "from": [0, 0, 0][:dimension], "to": [LENGTH, 0, 0][:dimension], "elements": ELEMENTS,
            "density_kg_per_m3": 7850, "youngs_modulus_pa": 2.1e11, "section": {"shape": "rectangle", "width_m": 0.1, "height_m": 0.2}}
    if dimension == 3:
        link.update(shear_modulus_pa=8e10, hinge_axis=[0, 0, 1])
    if shear:
        link["shear"] = {"coefficient": 5 / 6, **({"poissons_ratio": 0.3} if dimension == 2 else {})}
    directions = ["x", "y", "r"] if dimension == 2 else ["x", "y", "z", "rx", "ry", "rz"]
    return {"format": "modetune-model/1", "dimension": dimension, "links": [link],
            "joints": [{"name": "foot", "type": "fixed", "bodies": ["ground", "rod.start"], "at": [0, 0, 0][:dimension]}],
            "sensors": [{"name": f"s{e}_{p}", "on": "rod", "fraction": fraction(e, p), "directions": directions}
                        for e in range(ELEMENTS) for p in range(PLACES)]}


def cubic(x, w, at):
    """Value and slope at a place of the polynomial through the points."""
    value = slope = 0.0
    for i, (xi, wi) in enumerate(zip(x, w)):
        others = [xk for k, xk in enumerate(x) if k != i]
        parts = [(at - xk) / (xi - xk) for xk in others]
        value += wi * math.prod(parts)
        slope += wi * sum(math.prod(parts[:k] + parts[k + 1:]) / (xi - xk) for k, xk in enumerate(others))
    return value, slope


class BeamSensors(unittest.TestCase):
    def modes(self, folder, case):
        (Path(folder) / "model.json").write_text(json.dumps(case))
        done = subprocess.run([PROGRAM, "modes", "model.json", "--shapes", "--format", "json"], cwd=folder, capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        return [mode["shape"] for mode in json.loads(done.stdout)[0]["modes"]]

    def test_rotations_are_slopes(self):
        x = [LENGTH * fraction(0, p) for p in range(PLACES)]
        planes = {2: [("y", "r", 1.0)], 3: [("y", "rz", 1.0), ("z", "ry", -1.0)]}
        with tempfile.TemporaryDirectory() as folder:
            for dimension, shear in ((2, False), (2, True), (3, False), (3, True)):
                shapes = self.modes(folder, model(dimension, shear))
                self.assertEqual(len(shapes), {2: 3, 3: 6}[dimension] * ELEMENTS)
                for mode, shape in enumerate(shapes):
                    for across, about, sign in planes[dimension]:
                        for e in range(ELEMENTS):
                            with self.subTest(f"{dimension} dimensions, shear {shear}, mode {mode + 1}, {across}, element {e + 1}"):
                                w = [shape[f"s{e}_{p}.{across}"] for p in range(PLACES)]
                                turn = [sign * shape[f"s{e}_{p}.{about}"] for p in range(PLACES)]
                                size = max(1e-3, *map(abs, w), *(LENGTH * abs(angle) for angle in turn))
                                fits = [cubic(x[::2], w[::2], at) for at in x]
                                self.assertLess(max(abs(value - own) for (value, _), own in zip(fits, w)), 1e-11 * size)
                                angles = [own - slope for (_, slope), own in zip(fits, turn)]
                                self.assertLess((max(angles) - min(angles)) * LENGTH, 1e-10 * size)
                                if not shear:
                                    self.assertLess(max(map(abs, angles)) * LENGTH, 1e-10 * size)


if __name__ == "__main__":
    unittest.main()

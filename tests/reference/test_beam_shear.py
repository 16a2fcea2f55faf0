# SPDX-License-Identifier: GPL-3.0-or-later
"""Timoshenko's beams ("shear", "rotary_inertia") against the closed forms of simple supports. With w = W sin(b x), theta = T cos(b x), b = i pi/L, a tension N:
(K - omega^2 M) (W, T) = 0, K = [[k A G b^2 + N b^2, -k A G b], [-k A G b, E I b^2 + k A G]], M = diag(rho A, rho I): both spectra. And held at inner nodes."""
import itertools
import json
import os
import subprocess
import tempfile
import unittest

import numpy as np
from scipy.linalg import eigh

PROGRAM = os.environ["MODETUNE"]
E, NU, RHO, LENGTH, WIDTH, HEIGHT = 2.1e11, 0.3, 7850.0, 1.2, 0.1, 0.24
AREA, INERTIA = WIDTH * HEIGHT, {3: WIDTH * HEIGHT**3 / 12, 2: HEIGHT * WIDTH**3 / 12}
G = E / 2 / (1 + NU)
PHI_E = np.pi**2 * E * INERTIA[3] / LENGTH**2


def modes(model):
    with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
        json.dump(model, file)
        file.flush()
        done = subprocess.run([PROGRAM, "modes", file.name, "--count", "all", "--format", "json"], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise AssertionError(done.stdout + done.stderr)
    return sorted(m["omega_squared"] for m in json.loads(done.stdout)[0]["modes"])


def beam(dimension, elements, flip=False, load=0.0, angle=0.6, **more):
    """Simply supported, in the direction `angle` of the xy plane; in space it bends about both axes and does not twist at its left end."""
    c, s = np.cos(angle), np.sin(angle)
    at = [[0.0, 0.0, 0.0], [LENGTH * c, LENGTH * s, 0.0], [2 * LENGTH * c, 2 * LENGTH * s, 0.0]]
    at = [p[:dimension] for p in at]
    link = {"name": "beam", "kind": "beam", "from": at[1 if flip else 0], "to": at[0 if flip else 1], "elements": elements, "youngs_modulus_pa": E,
            "density_kg_per_m3": RHO, "section": {"shape": "rectangle", "width_m": WIDTH, "height_m": HEIGHT}, **more}
    left, right = ("beam.end", "beam.start") if flip else ("beam.start", "beam.end")
    along = [c, s, 0.0][:dimension]
    model = {"format": "modetune-model/1", "dimension": dimension, "links": [link], "joints": [], "springs": []}
    if dimension == 2:
        model["joints"] = [{"name": "a", "type": "revolute", "bodies": ["ground", left], "at": at[0]},
                           {"name": "b", "type": "pin-in-slot", "bodies": ["ground", right], "at": at[1], "axis": along}]
    else:
        link["hinge_axis"] = [0, 0, 1]
        model["joints"] = [{"name": "a", "type": "universal", "bodies": ["ground", left], "at": at[0], "axis": [0, 0, 1], "axis_b": [-s, c, 0]},
                           {"name": "b", "type": "point-on-line", "bodies": ["ground", right], "at": at[1], "axis": along}]
    if load:
        model["springs"] = [{"name": "load", "type": "axial", "bodies": [right, "ground"], "at": [at[1], at[2]],
                             "stiffness_n_per_m": 1e-6, "preload_n": load}]
    return model


def closed_form(i, axis=3, k=5 / 6, rotary=True, tension=0.0, length=1.0):
    """omega^2 of mode i, both spectra; `length`: how much longer the tension makes it."""
    b = i * np.pi / LENGTH
    kag = k * AREA * G
    stiffness = np.array([[(kag / length + tension) * b * b / length, -kag * b / length], [-kag * b / length, E * INERTIA[axis] * b * b + kag]])
    if not rotary:
        kag_only = stiffness[0, 0] - stiffness[0, 1]**2 / stiffness[1, 1]
        return np.array([kag_only / (RHO * AREA)])
    return eigh(stiffness, np.diag([RHO * AREA, RHO * INERTIA[axis]]), eigvals_only=True)


def nearest(values, want):
    return min(values, key=lambda v: abs(v / want - 1)) / want - 1


class Shear(unittest.TestCase):
    def test_the_lower_spectrum(self):
        for dimension, flip, rotary in itertools.product((2, 3), (False, True), (True, False)):
            values = {n: modes(beam(dimension, n, flip, shear={"coefficient": "5/6", "poissons_ratio": NU}, rotary_inertia=rotary)) for n in (8, 16)}
            for i, axis in itertools.product((1, 2, 3), (3,) if dimension == 2 else (2, 3)):
                with self.subTest(dimension=dimension, flip=flip, rotary=rotary, mode=i, axis=axis):
                    want = closed_form(i, axis, rotary=rotary)[0]
                    coarse, fine = (nearest(values[n], want) for n in (8, 16))
                    self.assertLess(fine, 3.4e-4 * i**3.5)  # five times as long as thick: a shear that is even within each element errs with n^-2
                    self.assertGreater(fine, 0)  # from above
                    self.assertAlmostEqual(np.log2(coarse / fine), 2, delta=0.5)

    def test_the_upper_spectrum_is_there(self):
        """Sections that swing to and fro hardly bend the beam: 40 elements have it within one per cent."""
        values = modes(beam(2, 40, shear={"coefficient": "5/6", "poissons_ratio": NU}))
        self.assertLess(abs(nearest(values, closed_form(1)[1])), 0.01)

    def test_rotary_inertia_alone_is_rayleighs_beam(self):
        b = np.pi / LENGTH
        want = E * INERTIA[3] * b**4 / (RHO * (AREA + INERTIA[3] * b * b))
        plain = modes(beam(2, 16))[0]
        self.assertAlmostEqual(modes(beam(2, 16, rotary_inertia=True))[0] / want, 1, delta=1e-5)
        self.assertAlmostEqual(plain / (E * INERTIA[3] * b**4 / (RHO * AREA)), 1, delta=1e-5)

    def test_the_shear_modulus_may_be_given(self):
        for dimension in (2, 3):
            one = modes(beam(dimension, 6, shear={"coefficient": 0.8, "poissons_ratio": NU}))
            other = modes(beam(dimension, 6, shear={"coefficient": 0.8}, shear_modulus_pa=G))
            for a, b in zip(one, other):
                self.assertAlmostEqual(b / a, 1, delta=1e-11)

    def test_each_plane_has_its_coefficient(self):
        values = modes(beam(3, 16, shear={"coefficient": 0.9, "coefficient_other": 0.3, "poissons_ratio": NU}))
        self.assertLess(abs(nearest(values, closed_form(1, 3, 0.9)[0])), 4e-4)
        self.assertLess(abs(nearest(values, closed_form(1, 2, 0.3)[0])), 4e-4)

    def test_shear_that_is_stiff_changes_nothing(self):
        for a, b in zip(modes(beam(3, 4, shear_modulus_pa=G)),
                        modes(beam(3, 4, shear={"coefficient": 1e9}, shear_modulus_pa=G, rotary_inertia=False))):
            self.assertAlmostEqual(b / a, 1, delta=1e-6)

    def test_ratios_that_no_material_has_are_refused(self):
        for shear, words in (({"coefficient": 0, "poissons_ratio": 0.3}, "shear/coefficient (0) must be above 0"),
                             ({"coefficient": 1, "poissons_ratio": -1}, "shear/poissons_ratio (-1) must be above -1"),
                             ({"coefficient": 1, "poissons_ratio": 0.6}, "shear/poissons_ratio (0.6) must be above -1 and not above 0.5")):
            with self.assertRaises(AssertionError) as refused:
                modes(beam(2, 2, shear=shear))
            self.assertIn(words, str(refused.exception))

    def test_under_axial_load(self):
        """Engesser: P_cr = P_E/(1 + P_E/(k A G)); the frequencies with it."""
        critical = PHI_E / (1 + PHI_E / (5 / 6 * AREA * G))
        for dimension, flip, share in itertools.product((2, 3), (False, True), (0.5, -0.5, 0.9)):
            with self.subTest(dimension=dimension, flip=flip, share=share):
                load = -share * critical
                want = closed_form(1, tension=load, length=1 + load / (E * AREA))[0]
                model = beam(dimension, 16, flip, load, shear={"coefficient": "5/6", "poissons_ratio": NU})
                self.assertLess(abs(nearest(modes(model), want)), 5e-4 / (1 - max(share, 0)))


class InnerNodes(unittest.TestCase):
    def test_a_support_in_the_middle_makes_two_spans(self):
        """The first mode is that of one simply supported half, the second that of a half clamped at the other end."""
        for dimension in (2, 3):
            model = beam(dimension, 8)
            if dimension == 3:
                model["links"][0].update(shear_modulus_pa=G)
            place = [0.5 * x for x in model["links"][0]["to"]]
            model["joints"].append({"name": "middle", "type": model["joints"][1]["type"], "bodies": ["ground", "beam.node4"],
                                    "at": place, "axis": model["joints"][1]["axis"]})
            values = modes(model)
            scale = 16 * E * INERTIA[3] / (RHO * AREA * LENGTH**4)
            self.assertLess(abs(nearest(values, np.pi**4 * scale)), 2e-3)
            self.assertLess(abs(nearest(values, 3.92660231**4 * scale)), 4e-3)

    def rigid(self, part, lengths=None):
        link = {"name": "arm", "from": [0, 0], "to": [1, 0.5], "elements": 4, "mass_kg": 2, "stiffness_n_m_per_rad": [30, 20, 10]}
        where = (0.5, 0.25)
        if lengths:
            link["element_length_m"] = [x * np.hypot(1, 0.5) for x in lengths]
            where = (sum(lengths[:2]), 0.5 * sum(lengths[:2]))
        return {"format": "modetune-model/1", "dimension": 2, "links": [link],
                "joints": [{"name": "root", "type": "fixed", "bodies": ["ground", "arm.node0"], "at": [0, 0]}],
                "springs": [{"name": "stay", "type": "axial", "bodies": ["ground", part], "at": [[0.2, 1], list(where)], "stiffness_n_per_m": 50}]}

    def test_nodes_of_rigid_elements_are_the_elements_that_end_there(self):
        for lengths in (None, (0.1, 0.3, 0.4, 0.2)):
            want = modes(self.rigid("arm.2", lengths))
            self.assertEqual(modes(self.rigid("arm.node2", lengths)), want)
            self.assertNotEqual(modes(self.rigid("arm.node1", lengths)), want)

    def test_a_spring_without_a_point_holds_the_node(self):
        for lengths in (None, (0.1, 0.3, 0.4, 0.2)):
            model = self.rigid("arm.node2", lengths)
            model["bodies"] = [{"name": "bob", "mass_kg": 1, "centre": [0.2, 1]}]
            model["springs"][0]["bodies"][0] = "bob"
            bare = dict(model, springs=[{k: v for k, v in model["springs"][0].items() if k != "at"}])
            for a, b in zip(modes(model), modes(bare)):
                self.assertAlmostEqual(a, b, delta=1e-9 * (1 + abs(b)))

    def test_loads_act_at_nodes(self):
        for lengths in (None, (0.1, 0.3, 0.4, 0.2)):
            model = self.rigid("arm.2", lengths)
            share = 0.5 if lengths is None else lengths[0] + lengths[1]
            model["loads"] = [{"name": "push", "on": "arm.node2", "force_n": [3, -2]}]
            there = dict(model, loads=[{"name": "push", "on": "arm.2", "at": [share, 0.5 * share], "force_n": [3, -2]}])
            for a, b in zip(modes(model), modes(there)):
                self.assertAlmostEqual(b / a, 1, delta=1e-12)


if __name__ == "__main__":
    unittest.main()

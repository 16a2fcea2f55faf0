# SPDX-License-Identifier: GPL-3.0-or-later
"""Beam links under load against closed forms, finite elements integrated here (Hermite's cubics, linear twist), and polynomial Ritz solutions: axial loads at four kinds of supports, own
weight, lateral buckling, buckling under torque, frames; in the plane and in space, however they lie, whichever end is drawn first. E I = m = L = 1 but for frames."""
import itertools
import json
import os
import subprocess
import tempfile
import unittest

import numpy as np
from numpy.polynomial import Legendre
from numpy.polynomial.legendre import leggauss
from scipy.linalg import eigh

PROGRAM = os.environ["MODETUNE"]
EA = 1e5  # Euler's load shortens it by 1e-4
EULER = np.pi**2
GAUSS = [(0.5 * (1 + x), 0.5 * w) for x, w in zip(*leggauss(8))]


def modes(model, *args):
    with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
        json.dump(model, file)
        file.flush()
        done = subprocess.run([PROGRAM, "modes", file.name, "--count", "all", "--format", "json", *args], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise AssertionError(done.stdout + done.stderr)
    return json.loads(done.stdout)[0]


def squares(model, count=1):
    """The lowest omega^2, unstable ones first."""
    return sorted(m["omega_squared"] for m in modes(model)["modes"])[:count]


class Place:
    """A random position and orientation; the plane's x axis is along the beam, z out of the plane."""

    def __init__(self, rng, dimension):
        self.dimension = dimension
        turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        if dimension == 2:
            angle = rng.uniform(0, 2 * np.pi)
            turn = np.eye(3)
            turn[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
        self.turn = turn * np.linalg.det(turn)
        self.at = rng.normal(size=3)

    def point(self, *x):
        return list((self.turn @ np.array(x + (0,) * (3 - len(x)), float) + self.at)[:self.dimension])

    def axis(self, *x):
        return list((self.turn @ np.array(x + (0,) * (3 - len(x)), float))[:self.dimension])


def link(place, name, a, b, elements, flip, area=EA, **more):
    """A beam from a to b, drawn from b to a where `flip`."""
    at = {"from": place.point(*(b if flip else a)), "to": place.point(*(a if flip else b))}
    section = {"shape": "general", "area_m2": area, "second_moment_m4": 1}
    space = {}
    if place.dimension == 3:
        section.update(second_moment_other_m4=1.7, torsion_constant_m4=0.8)
        space = {"hinge_axis": place.axis(0, 0, 1), "shear_modulus_pa": 0.4}
    return {"name": name, "kind": "beam", "elements": elements, "youngs_modulus_pa": 1, "mass_kg": 1, "section": section, **at, **space, **more}


def ends(name, flip):
    return (f"{name}.end", f"{name}.start") if flip else (f"{name}.start", f"{name}.end")


SUPPORTS = {"pinned-pinned": "pp", "clamped-pinned": "cp", "clamped-clamped": "cc", "clamped-free": "cf"}


def column(place, supports, elements, load, flip, area=EA, **more):
    """A beam along x under the dead axial force `load` (compression positive) at its right end, which can move along x."""
    left, right = ends("beam", flip)
    model = {"format": "modetune-model/1", "dimension": place.dimension, "joints": [], "springs": [],
             "links": [link(place, "beam", (0,), (1,), elements, flip, area)], **more}
    plane = place.dimension == 2
    hinge = {} if plane else {"axis": place.axis(0, 0, 1)}
    first = {"name": "left", "bodies": ["ground", left], "at": place.point(0)}
    model["joints"].append({**first, "type": "fixed"} if supports[0] == "c" else {**first, "type": "revolute", **hinge})
    last = {"name": "right", "bodies": ["ground", right], "at": place.point(1), "axis": place.axis(1)}
    if supports[1] == "c":
        model["joints"].append({**last, "type": "prismatic"})
    elif supports[1] == "p":
        model["joints"].append({**last, "type": "pin-in-slot" if plane else "point-on-line"})
    if load != 0 and supports[1] == "f":  # gravity keeps its direction where a spring would not
        model["bodies"] = [{"name": "load", "mass_kg": 1e-9, "centre": place.point(1)}]
        model["joints"].append({"name": "top", "type": "revolute" if plane else "spherical", "bodies": ["load", right], "at": place.point(1)})
        model["gravity_m_per_s2"] = place.axis(-load * 1e9)
        model["links"][0]["mass_kg"] = 0
    elif load != 0:
        model["springs"].append({"name": "load", "type": "axial", "bodies": [right, "ground"],
                                 "at": [place.point(1), place.point(2)], "stiffness_n_per_m": 1e-9, "preload_n": -load})
    return model


def bending(x, l):
    """Second derivative of Hermite's cubics on (w, w', w, w')."""
    return np.array([-6 + 12 * x, (-4 + 6 * x) * l, 6 - 12 * x, (6 * x - 2) * l]) / l**2


def slope(x, l):
    return np.array([6 * x * x - 6 * x, (1 - 4 * x + 3 * x * x) * l, 6 * x - 6 * x * x, (3 * x * x - 2 * x) * l]) / l


def deflection(x, l):
    return np.array([1 - 3 * x * x + 2 * x**3, (x - 2 * x * x + x**3) * l, 3 * x * x - 2 * x**3, (x**3 - x * x) * l])


def elements_of(n, force=lambda x: 1.0):
    """K, K_G for a tension force(x), M of n elements over (w, w')."""
    l = 1 / n
    k, g, m = (np.zeros((2 * n + 2, 2 * n + 2)) for _ in range(3))
    for e in range(n):
        at = slice(2 * e, 2 * e + 4)
        for x, w in GAUSS:
            k[at, at] += w * l * np.outer(bending(x, l), bending(x, l))
            g[at, at] += w * l * force((e + x) / n) * np.outer(slope(x, l), slope(x, l))
            m[at, at] += w * l * np.outer(deflection(x, l), deflection(x, l))
    return k, g, m


def free_of(supports, n):
    held = {"c": [0, 1], "p": [0], "f": []}
    gone = held[supports[0]] + [2 * n + i for i in held[supports[1]]]
    return [i for i in range(2 * n + 2) if i not in gone]


def lowest_load(k, g, free):
    """Least P with a singular K - P G."""
    return 1 / eigh(g[np.ix_(free, free)], k[np.ix_(free, free)], eigvals_only=True).max()


def zero(function, low, high, points=6):
    """The zero of a smooth function near the middle of [low, high], where it is not asked, by its interpolating polynomial."""
    x = np.linspace(low, high, points)
    roots = np.polynomial.Polynomial.fit(x, [function(v) for v in x], points - 1).roots()
    roots = roots[np.abs(roots.imag) < 1e-9].real
    return roots[np.abs(roots - 0.5 * (low + high)).argmin()]


class Columns(unittest.TestCase):
    def setUp(self):
        self.rng = np.random.default_rng(3)

    def places(self):
        """Plane and space, drawn this way and that."""
        for dimension, flip in itertools.product((2, 3), (False, True)):
            yield Place(self.rng, dimension), flip

    def test_simply_supported_beams_follow_the_closed_form(self):
        for n, share, accuracy in ((4, 0.5, 6e-4), (4, -0.5, 6e-4), (8, 0.99, 2e-3), (16, 0.99, 3e-4)):
            for place, flip in self.places():
                with self.subTest(elements=n, share=share, dimension=place.dimension, flip=flip):
                    found = squares(column(place, "pp", n, share * EULER, flip))[0]
                    length = 1 - share * EULER / EA
                    want = np.pi**4 / length**2 * (1 - share * length)
                    self.assertAlmostEqual(np.sqrt(found / want), 1, delta=accuracy)

    def test_beyond_the_buckling_load_they_are_unstable(self):
        for place, flip in self.places():
            with self.subTest(dimension=place.dimension, flip=flip):
                self.assertEqual(modes(column(place, "pp", 8, 1.01 * EULER, flip))["unstable_modes"], 1)
                self.assertEqual(modes(column(place, "pp", 8, 0.99 * EULER, flip))["unstable_modes"], 0)

    def test_every_support_has_the_modes_of_its_consistent_matrices(self):
        n = 5
        k, g, m = elements_of(n)
        for name, supports in SUPPORTS.items():
            if supports == "cf":
                continue  # its load would be a mass
            free = free_of(supports, n)
            critical = lowest_load(k, g, free)
            for place, flip in self.places():
                for share in (-2, -0.5, 0.3, 0.8):
                    with self.subTest(supports=name, share=share, dimension=place.dimension, flip=flip):
                        length = 1 - share * critical / EA  # E I theta'^2/2 per drawn length, theta = w'/length
                        matrix = k / length**2 - share * critical / length * g
                        want = eigh(matrix[np.ix_(free, free)], m[np.ix_(free, free)], eigvals_only=True)[0]
                        self.assertAlmostEqual(squares(column(place, supports, n, share * critical, flip))[0] / want, 1, delta=1e-6)

    def test_the_buckling_load_is_that_of_the_matrices_and_nears_eulers(self):
        euler = {"pp": 1, "cp": 2.04574, "cc": 4, "cf": 0.25}
        for name, supports in SUPPORTS.items():
            place, flip = Place(self.rng, 2), bool(self.rng.integers(2))
            with self.subTest(supports=name, flip=flip):
                k, g, _ = elements_of(8)
                want = lowest_load(k, g, free_of(supports, 8))
                want *= 1 + want / EA  # shorter by want/EA
                found = zero(lambda p: squares(column(place, supports, 8, p * want, flip))[0], 0.9, 1.1)
                self.assertAlmostEqual(found, 1, delta=2e-6)
                self.assertAlmostEqual(found * want / (euler[supports] * EULER), 1, delta=2e-3)

    def test_a_load_between_two_ends_that_cannot_move_is_shared(self):
        """Statically indeterminate: the force in the middle pulls one half and presses the other."""
        n, load = 6, 15.0
        k, g, m = elements_of(n, lambda x: load / 2 if x < 0.5 else -load / 2)
        free = free_of("cc", n)
        want = eigh((k + g)[np.ix_(free, free)], m[np.ix_(free, free)], eigvals_only=True)[0]
        for place, flip in self.places():
            with self.subTest(dimension=place.dimension, flip=flip):
                model = {"format": "modetune-model/1", "dimension": place.dimension, "joints": [], "springs": [],
                         "links": [link(place, "a", (0,), (0.5,), n // 2, flip, mass_kg=0.5), link(place, "b", (0.5,), (1,), n // 2, not flip, mass_kg=0.5)]}
                for part in model["links"]:
                    part["section"] = dict(part["section"], area_m2=1e6)  # shorter and longer by 1e-5
                (first, middle), (other, last) = ends("a", flip), ends("b", not flip)
                for i, (one, two, x) in enumerate((("ground", first, 0), (middle, other, 0.5), ("ground", last, 1))):
                    model["joints"].append({"name": f"j{i}", "type": "fixed", "bodies": [one, two], "at": place.point(x)})
                model["springs"].append({"name": "load", "type": "axial", "bodies": [middle, "ground"],
                                         "at": [place.point(0.5), place.point(1e6)], "stiffness_n_per_m": 1e-9, "preload_n": load})
                self.assertAlmostEqual(squares(model)[0] / want, 1, delta=3e-5)


def ritz(weight, count=16):
    """omega^2 of a clamped-free column under its own weight (standing positive), by polynomials; and the weight under which it falls over."""
    x, w = leggauss(60)
    x, w = 0.5 * (1 + x), 0.5 * w
    rows = []
    for i in range(count):
        p = Legendre.basis(i, domain=[0, 1])
        q = p.deriv()
        rows.append((x * x * p(x), 2 * x * p(x) + x * x * q(x), 2 * p(x) + 4 * x * q(x) + x * x * q.deriv()(x)))
    f, d, dd = (np.array(part) for part in zip(*rows))
    k, g, m = (dd * w) @ dd.T, (d * (w * (1 - x))) @ d.T, (f * w) @ f.T
    return eigh(k - weight * g, m, eigvals_only=True), 1 / eigh(g, k, eigvals_only=True).max()


class OwnWeight(unittest.TestCase):
    def setUp(self):
        self.rng = np.random.default_rng(5)

    def standing(self, dimension, n, weight, flip):
        place = Place(self.rng, dimension)
        return column(place, "cf", n, 0, flip, 1e7, gravity_m_per_s2=place.axis(-weight))

    def test_columns_stand_and_hang_as_polynomials_do(self):
        self.assertAlmostEqual(ritz(0)[1], 7.837347438943, delta=1e-9)  # Greenhill 1881: 9 j^2/4, j the first zero of J_-1/3
        for dimension, flip, weight in itertools.product((2, 3), (False, True), (3.9, 7.0, -3.9, -50.0)):
            with self.subTest(dimension=dimension, flip=flip, weight=weight):
                want = np.sqrt(ritz(weight)[0][0])
                error = [np.sqrt(squares(self.standing(dimension, n, weight, flip))[0]) / want - 1 for n in (4, 8)]
                self.assertLess(abs(error[1]), 2e-4)
                self.assertLess(abs(error[1]), 0.09 * abs(error[0]) + 2e-6)  # fourth order: a sixteenth

    def test_a_column_falls_over_at_greenhills_height(self):
        for dimension, flip in itertools.product((2, 3), (False, True)):
            with self.subTest(dimension=dimension, flip=flip):
                found = zero(lambda q: squares(self.standing(dimension, 8, q * ritz(0)[1], flip))[0], 0.9, 1.1)
                self.assertAlmostEqual(found, 1, delta=2e-5)


class Space(unittest.TestCase):
    """Bending moments and torque in the stiffness of the other plane."""

    def setUp(self):
        self.rng = np.random.default_rng(7)

    def test_a_blade_trips_sideways(self):
        """Cantilever with a dead load at its end (Prandtl): 4.0126 sqrt(EI GJ)/L^2; the linear twist of the elements makes them too stiff by n^-2."""
        ei, gj = 1e-3, 0.4e-3
        for n, flip in itertools.product((3, 6), (False, True)):
            place = Place(self.rng, 3)
            size = 3 * (n + 1)
            k, g = np.zeros((size, size)), np.zeros((size, size))
            for e, (x, w) in itertools.product(range(n), GAUSS):
                v, t = [3 * e, 3 * e + 1, 3 * e + 3, 3 * e + 4], [3 * e + 2, 3 * e + 5]
                b, l = bending(x, 1 / n), 1 / n
                k[np.ix_(v, v)] += w * l * ei * np.outer(b, b)
                k[np.ix_(t, t)] += w * l * gj * n * n * np.array([[1, -1], [-1, 1]])
                mix = w * l * (1 - (e + x) * l) * np.outer(b, [1 - x, x])
                g[np.ix_(v, t)] += mix
                g[np.ix_(t, v)] += mix.T
            want = lowest_load(k, g, range(3, size))
            self.assertAlmostEqual(want / (4.0126 * np.sqrt(ei * gj)), 1, delta=0.3 / n**2)

            def square(load, n=n, flip=flip, place=place, want=want):
                root, tip = ends("beam", flip)
                section = {"shape": "general", "area_m2": 100, "second_moment_m4": 1e4 * ei, "second_moment_other_m4": ei, "torsion_constant_m4": gj}
                model = {"format": "modetune-model/1", "dimension": 3, "gravity_m_per_s2": place.axis(0, -load * want),
                         "links": [link(place, "beam", (0,), (1,), n, flip, section=section, mass_kg=0, shear_modulus_pa=1)],
                         "bodies": [{"name": "load", "mass_kg": 1, "centre": place.point(1), "inertia_kg_m2": [1e-3, 1e-3, 1e-3]}],
                         "joints": [{"name": "root", "type": "fixed", "bodies": ["ground", root], "at": place.point(0)},
                                    {"name": "tip", "type": "fixed", "bodies": ["load", tip], "at": place.point(1)}]}
                return squares(model)[0]
            with self.subTest(elements=n, flip=flip):
                self.assertAlmostEqual(zero(square, 0.9, 1.1), 1, delta=1e-3)  # (EI sideways)/(EI upright) = 1e-4

    def test_a_shaft_buckles_under_torque(self):
        """Clamped ends, one free to slide and turn about the axis (Greenhill 1883): T = 8.98682 EI/L. A stiff twist keeps the elements' triads in line."""
        for n in (4, 8):
            size = 4 * (n + 1)
            k, g = np.zeros((size, size)), np.zeros((size, size))
            for e, (x, w) in itertools.product(range(n), GAUSS):
                v, u = [4 * e, 4 * e + 1, 4 * e + 4, 4 * e + 5], [4 * e + 2, 4 * e + 3, 4 * e + 6, 4 * e + 7]
                b, d, l = bending(x, 1 / n), slope(x, 1 / n), 1 / n
                k[np.ix_(v, v)] += w * l * np.outer(b, b)
                k[np.ix_(u, u)] += w * l * np.outer(b, b)
                mix = 0.5 * w * l * (np.outer(d, b) - np.outer(b, d))
                g[np.ix_(v, u)] += mix
                g[np.ix_(u, v)] += mix.T
            want = lowest_load(k, g, range(4, size - 4))
            self.assertAlmostEqual(want / 8.986819, 1, delta=10 / n**4)
            for flip in (False, True):
                place = Place(self.rng, 3)

                def square(share, n=n, flip=flip, place=place, want=want):
                    first, last = ends("beam", flip)
                    section = {"shape": "general", "area_m2": 1e4, "second_moment_m4": 1, "second_moment_other_m4": 1, "torsion_constant_m4": 1e4}
                    model = {"format": "modetune-model/1", "dimension": 3,
                             "links": [link(place, "beam", (0,), (1,), n, flip, section=section, shear_modulus_pa=1)],
                             "joints": [{"name": "a", "type": "fixed", "bodies": ["ground", first], "at": place.point(0)},
                                        {"name": "b", "type": "cylindrical", "bodies": ["ground", last], "at": place.point(1), "axis": place.axis(1)}],
                             "springs": [{"name": "torque", "type": "torsion", "joint": "b", "stiffness_n_m_per_rad": 1e-9,
                                          "preload_n_m": want * share}]}
                    return squares(model)[0]
                with self.subTest(elements=n, flip=flip):
                    self.assertAlmostEqual(zero(square, 0.9, 1.1), 1, delta=2e-5)


    def test_tension_stiffens_twist(self):
        """Wagner: G J + N (I2 + I3)/A, which matters for strips; the lowest mode of this one twists."""
        for flip, strain in itertools.product((False, True), (1e-3, -5e-4)):
            place = Place(self.rng, 3)
            section = {"shape": "general", "area_m2": 1e4, "second_moment_m4": 1, "second_moment_other_m4": 1.7, "torsion_constant_m4": 0.01}
            first, last = ends("beam", flip)
            model = {"format": "modetune-model/1", "dimension": 3, "links": [link(place, "beam", (0,), (1,), 6, flip, section=section)],
                     "joints": [{"name": "a", "type": "fixed", "bodies": ["ground", first], "at": place.point(0)},
                                {"name": "b", "type": "cylindrical", "bodies": ["ground", last], "at": place.point(1), "axis": place.axis(1)}],
                     "springs": [{"name": "pull", "type": "axial", "bodies": [last, "ground"], "at": [place.point(1), place.point(2)],
                                  "stiffness_n_per_m": 1e-9, "preload_n": strain * 1e4}]}
            slack = dict(model, springs=[])
            with self.subTest(flip=flip, strain=strain):
                self.assertAlmostEqual(squares(model)[0] / squares(slack)[0], 1 + strain * 2.7 / (0.4 * 0.01), delta=1e-7)


class Frames(unittest.TestCase):
    """Whichever end of a beam is drawn first, a frame is the same frame."""

    def frame(self, rng, dimension):
        place = Place(rng, dimension)
        z = rng.normal(size=4) * 0.4 if dimension == 3 else np.zeros(4)
        corners = [(x + 0.2 * rng.normal(), y + 0.2 * rng.normal(), float(h)) for (x, y), h in zip(((0, 0), (0, 1), (1, 1), (1, 0)), z)]
        weight = place.axis(*rng.normal(size=dimension))
        numbers = [(int(rng.integers(1, 4)), float(rng.uniform(0.5, 2))) for _ in range(3)]

        def model(flips):
            out = {"format": "modetune-model/1", "dimension": dimension, "gravity_m_per_s2": weight, "links": [], "joints": []}
            parts = [ends(f"l{i}", flip) for i, flip in enumerate(flips)]
            for i, flip in enumerate(flips):
                a, b = np.array(corners[i]), np.array(corners[i + 1])
                across = np.cross(b - a, (0.3, 0.2, 1) if dimension == 3 else (0, 0, 1))
                more = {"hinge_axis": place.axis(*(across / np.linalg.norm(across)))} if dimension == 3 else {}
                out["links"].append(link(place, f"l{i}", tuple(a), tuple(b), numbers[i][0], flip, mass_kg=numbers[i][1], **more))
                out["links"][-1]["section"] = dict(out["links"][-1]["section"], area_m2=1e3)
                if i == 1:  # Timoshenko's, Phi about 10
                    out["links"][-1].update(shear={"coefficient": 0.02}, shear_modulus_pa=0.4)
            for i, (one, two) in enumerate(((("", "ground"), parts[0]), (parts[0], parts[1]), (parts[1], parts[2]), (parts[2], ("ground", "")))):
                out["joints"].append({"name": f"j{i}", "type": "fixed", "bodies": [one[1], two[0]], "at": place.point(*corners[i])})
            return out
        return model

    def test_the_direction_of_drawing_changes_nothing(self):
        rng = np.random.default_rng(11)
        for dimension, _ in itertools.product((2, 3), range(3 if "MT_EVERY" in os.environ else 1)):
            model = self.frame(rng, dimension)
            first = squares(model((False, False, False)), 4)
            weightless = dict(model((False, False, False)), gravity_m_per_s2=[0] * dimension)
            self.assertGreater(abs(squares(weightless)[0] / first[0] - 1), 1e-3)  # the load counts
            for flips in itertools.product((False, True), repeat=3):
                with self.subTest(dimension=dimension, flips=flips):
                    for a, b in zip(first, squares(model(flips), 4)):
                        self.assertAlmostEqual(b / a, 1, delta=1e-9)


if __name__ == "__main__":
    unittest.main()

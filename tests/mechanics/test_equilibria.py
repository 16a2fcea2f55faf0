# SPDX-License-Identifier: GPL-3.0-or-later
"""Equilibrium: what is drawn out of it settles downhill, what is drawn in it stays; against minimisers of their own."""
import math
import random
import unittest

import numpy

from common_mechanisms import Mechanism, MechanismTest, loop, seeded

G = 9.81
PENDULUM = math.sqrt(G / 1.02) / (2 * math.pi)  # 1 kg at 1 m, 0.02 kg m^2


def pendulum(degrees, length=1.0):
    m = Mechanism(2)
    angle = math.radians(degrees)
    m.body("bob", [length * math.sin(angle), -length * math.cos(angle)])
    m.joint("pin", "revolute", "ground", "bob", [0, 0])
    m.more["gravity_m_per_s2"] = [0, -G]
    return m


class Chain:
    """Links on hinges in gravity, drawn at random angles, torsion springs unstressed there, perhaps a spring to the ground."""

    def __init__(self, r):
        self.n = r.randint(1, 5)
        self.drawn = numpy.array([r.uniform(-math.pi, math.pi) for _ in range(self.n)])
        self.length = numpy.array([r.uniform(0.3, 1) for _ in range(self.n)])
        self.mass = numpy.array([10 ** r.uniform(-1, 1) for _ in range(self.n)])
        self.spin = 0.1 * self.mass * self.length**2
        self.k = numpy.array([10 ** r.uniform(-3, 2) * (r.random() < 0.6) for _ in range(self.n)])
        self.at = r.randrange(self.n)
        self.anchor = numpy.array([r.gauss(0, 1.5), r.gauss(0, 1.5)])
        self.axial = 10 ** r.uniform(-1, 2) * (r.random() < 0.5)
        self.rest = numpy.linalg.norm(self.tips(self.drawn)[:, self.at] - self.anchor)

    def tips(self, t):
        return numpy.cumsum(self.length * numpy.array([numpy.sin(t), -numpy.cos(t)]), axis=1)

    def model(self):
        ends = [[0.0, 0.0], *self.tips(self.drawn).T.tolist()]
        model = {"format": "modetune-model/1", "dimension": 2, "gravity_m_per_s2": [0, -G], "bodies": [], "joints": [],
                 "springs": []}
        for i in range(self.n):
            model["bodies"].append({"name": f"b{i}", "mass_kg": self.mass[i], "inertia_kg_m2": self.spin[i],
                                    "centre": [0.5 * (a + b) for a, b in zip(ends[i], ends[i + 1])]})
            model["joints"].append({"name": f"j{i}", "type": "revolute", "at": ends[i],
                                    "bodies": ["ground" if i == 0 else f"b{i - 1}", f"b{i}"]})
            if self.k[i] > 0:
                model["springs"].append({"name": f"s{i}", "type": "torsion", "joint": f"j{i}",
                                         "stiffness_n_m_per_rad": self.k[i]})
        if self.axial > 0:
            model["springs"].append({"name": "axial", "type": "axial", "bodies": ["ground", f"b{self.at}"],
                                     "at": [self.anchor.tolist(), ends[self.at + 1]], "stiffness_n_per_m": self.axial})
        return model

    def turns(self, t):
        return numpy.diff(numpy.r_[0, t - self.drawn])

    def energy(self, t):
        y = numpy.r_[0, self.tips(t)[1]]
        stretch = numpy.linalg.norm(self.tips(t)[:, self.at] - self.anchor) - self.rest
        return (G * numpy.sum(self.mass * (y[:-1] + y[1:]) / 2) + 0.5 * numpy.sum(self.k * self.turns(t)**2) +
                0.5 * self.axial * stretch**2)

    def gradient(self, t):
        carried = 0.5 * self.mass + numpy.r_[numpy.cumsum(self.mass[::-1])[::-1][1:], 0]
        moment = self.k * self.turns(t)
        g = G * carried * self.length * numpy.sin(t) + moment
        g[:-1] -= moment[1:]
        way = self.tips(t)[:, self.at] - self.anchor
        size = numpy.linalg.norm(way)
        force = self.axial * (size - self.rest) * way / size
        for i in range(self.at + 1):
            g[i] += self.length[i] * (force[0] * math.cos(t[i]) + force[1] * math.sin(t[i]))
        return g

    def hessian(self, t):
        h = numpy.zeros((self.n, self.n))
        for k in range(self.n):
            step = numpy.eye(self.n)[k]
            slope = [(self.gradient(t + d * step) - self.gradient(t - d * step)) / (2 * d) for d in (5e-4, 1e-3)]
            h[:, k] = (4 * slope[0] - slope[1]) / 3
        return (h + h.T) / 2

    def inertia(self, t):
        m = numpy.diag(self.spin)
        for i in range(self.n):
            arm = numpy.array([self.length[k] * (1 if k < i else 0.5) * (k <= i) for k in range(self.n)])
            rows = numpy.array([arm * numpy.cos(t), arm * numpy.sin(t)])
            m = m + self.mass[i] * rows.T @ rows
        return m

    def frequencies(self, t):
        root = numpy.linalg.inv(numpy.linalg.cholesky(self.inertia(t)))
        squares = numpy.linalg.eigvalsh(root @ self.hessian(t) @ root.T)
        return numpy.sqrt(numpy.maximum(0, squares)) / (2 * math.pi)

    def minimise(self, t):
        """Newton with the eigenvalues' signs made positive, short steps, always downhill."""
        for _ in range(3000):
            g = self.gradient(t)
            if abs(g).max() < 1e-12 * G * self.mass.sum():
                break
            w, u = numpy.linalg.eigh(self.hessian(t))
            step = -u @ ((u.T @ g) / numpy.maximum(abs(w), 1e-3 * abs(w).max()))
            step *= min(1, 0.3 / abs(step).max())
            while self.energy(t + step) > self.energy(t) and abs(step).max() > 1e-14:
                step *= 0.5
            t = t + step
        return t


class Equilibria(MechanismTest):
    def test_a_pendulum_hangs_wherever_it_is_drawn(self):
        for degrees in (0.5, 45, 89, 90, 91, 120, 179, 179.99, -91, -179):
            for m in (pendulum(degrees), pendulum(degrees).in_space()):
                got = self.answer(m.model(), "modes")
                self.assertEqual([x["kind"] for x in got["modes"]], ["flexible"])
                self.assertAlmostEqual(got["modes"][0]["frequency_hz"] / PENDULUM, 1, delta=1e-12)
                self.assertAlmostEqual(math.degrees(got["equilibrium"]["largest_turn_rad"]), abs(degrees), delta=1e-6)
                told = [f["text"] for f in got["facts"] if f["kind"] == "settles"]
                self.assertEqual(len(told), 0 if abs(degrees) < 1 else 1)
        self.assertIn('it settles far away from the drawing: "bob" turns by 91 degrees, "bob" moves by 1.43 m',
                      self.run_on(pendulum(91).model(), "info").stdout)

    def test_what_is_drawn_in_equilibrium_stays(self):
        for degrees in (180, 180 + 1e-8):
            got = self.answer(pendulum(degrees).model(), "modes")
            self.assertEqual([x["kind"] for x in got["modes"]], ["unstable"])
        # upright on a mount that sags: nothing says to which side it falls
        m = Mechanism(2)
        m.body("mount", [0, 0])
        m.body("mast", [0, 1])
        m.joint("slide", "prismatic", "ground", "mount", [0, 0], [0, 1])
        m.joint("pin", "revolute", "mount", "mast", [0, 0])
        m.springs = [{"name": "sag", "type": "axial", "bodies": ["ground", "mount"], "at": [[0, -1], [0, 0]],
                      "stiffness_n_per_m": 2000}]
        m.more["gravity_m_per_s2"] = [0, -G]
        got = self.answer(m.model(), "modes")
        self.assertEqual([x["kind"] for x in got["modes"]], ["unstable", "flexible"])
        m.bodies[1] = ("mast", [1e-3, 1])  # and here it does
        m.joints[1] = (*m.joints[1][:3], [1e-3, 0], None)
        m.joints[1] = ("pin", "revolute", ("mount", "mast"), [0, 0], None)
        got = self.answer(m.model(), "modes")
        self.assertEqual([x["kind"] for x in got["modes"]], ["flexible", "flexible"])

    def test_chains_settle_in_a_minimum_below_the_drawing(self):
        same = 0
        for i in range(60):
            with self.subTest(i):
                r = seeded("chain", i)
                chain = Chain(r)
                got = self.answer(chain.model(), "modes")
                self.assertEqual(got["unstable_modes"], 0)
                self.assertLessEqual(got["equilibrium"]["residual"], 1e-11)
                hz = [m["frequency_hz"] for m in got["modes"]]
                # the minimum below the drawing, or one beside it
                found = False
                for start in range(60):
                    away = numpy.array([r.uniform(-4, 4) * (start > 0) for _ in range(chain.n)])
                    found = numpy.allclose(chain.frequencies(chain.minimise(chain.drawn + away)), hz, rtol=1e-6, atol=0)
                    if found:
                        same += start == 0
                        break
                self.assertTrue(found, f"{hz} is no minimum's")
        self.assertGreater(same, 50)

    def test_driven_and_trimmed_chains_settle(self):
        """The upper pendulum is held at a position, by a lock or by its re-trimmed servo; the lower one hangs."""
        for upper in (0, 30, 100):
            for lower in (60, 91, 135, 179):
                tip = [math.sin(math.radians(upper)), -math.cos(math.radians(upper))]
                m = Mechanism(2)
                m.body("upper", [0.5 * x for x in tip])
                angle = math.radians(lower)
                m.body("lower", [tip[0] + math.sin(angle), tip[1] - math.cos(angle)])
                m.joint("shaft", "revolute", "ground", "upper", [0, 0])
                m.joint("pin", "revolute", "upper", "lower", tip)
                m.torsion("shaft", 1e3)
                m.more = {"gravity_m_per_s2": [0, -G], "configurations": {
                    hold: {"drive": {"joint": "shaft", "position_rad": 0.2,
                                     "hold": "lock" if hold == "lock" else {"trim": "s_shaft"}}} for hold in ("lock", "trim")}}
                with self.subTest(upper=upper, lower=lower):
                    lock = self.answer(m.model(), "modes", "-c", "lock")
                    self.assertEqual([x["kind"] for x in lock["modes"]], ["flexible"])
                    self.assertAlmostEqual(lock["modes"][0]["frequency_hz"] / PENDULUM, 1, delta=1e-9)
                    trim = self.answer(m.model(), "modes", "-c", "trim")
                    self.assertEqual([x["kind"] for x in trim["modes"]], ["flexible", "flexible"])

    def test_small_imbalances_do_not_end_the_search(self):
        for mass in (1e-3, 1e-6, 1e-8, 1e-9, 1e-10):
            for degrees in (60, 120):
                with self.subTest(mass=mass, degrees=degrees):
                    m = pendulum(0)
                    model = m.model()
                    angle = math.radians(degrees)
                    model["bodies"].append({"name": "tiny", "mass_kg": mass, "inertia_kg_m2": 0.02 * mass,
                                            "centre": [5 + math.sin(angle), -math.cos(angle)]})
                    model["joints"].append({"name": "pin2", "type": "revolute", "bodies": ["ground", "tiny"], "at": [5, 0]})
                    model["springs"].append({"name": "s", "type": "torsion", "joint": "pin", "stiffness_n_m_per_rad": 1e3})
                    got = self.answer(model, "modes")
                    self.assertEqual([x["kind"] for x in got["modes"]], ["flexible", "flexible"])
                    self.assertAlmostEqual(got["modes"][0]["frequency_hz"] / PENDULUM, 1, delta=1e-12)

    def test_a_body_without_an_extent_settles_in_every_unit(self):
        """What is far is said by a length of the model: between the ends of springs, a radius of gyration, or what the load moves it by."""
        for kind in ("ends", "gyration", "load"):
            for unit in (1e-8, 1e-4, 1.0, 1e4, 1e8):  # of lengths
                with self.subTest(kind=kind, unit=unit):
                    at = [0.9 * unit, 0.25 * unit]
                    body = {"name": "b", "mass_kg": 2.0, "centre": at}
                    model = {"format": "modetune-model/1", "dimension": 2, "gravity_m_per_s2": [0, -G * unit], "bodies": [body],
                             "springs": [{"name": "foot", "type": "bushing", "bodies": ["ground", "b"], "at": at, "stiffness_n_per_m": [200, 800],
                                          "stiffness_n_m_per_rad": 30 * unit**2 if kind == "gyration" else 0}]}
                    if kind == "gyration":
                        body["inertia_kg_m2"] = 0.3 * unit**2
                    if kind == "ends":
                        model["springs"].append({"name": "rope", "type": "axial", "bodies": ["ground", "b"], "at": [[at[0], at[1] + 2 * unit], at],
                                                 "stiffness_n_per_m": 100})
                    got = [m["omega_squared"] for m in self.answer(model, "modes")["modes"]]
                    down = 2 * G / (900 if kind == "ends" else 800)
                    across = 200 + (100 * down / (2 + down) if kind == "ends" else 0)  # N/m, with the rope's tension over its length
                    exact = sorted([across / 2, (900 if kind == "ends" else 800) / 2] + ([100.0] if kind == "gyration" else []))
                    for a, b in zip(got, exact, strict=True):
                        self.assertAlmostEqual(a / b, 1, delta=1e-12)

    def test_the_spins_of_rods_do_not_shorten_the_steps(self):
        """Off the equilibrium a rod's spin between ball joints has some stiffness: the step along it is long, and no other has to wait for it."""
        for seed in range(16):
            with self.subTest(seed=seed):
                r = random.Random(seed)
                tip = [r.uniform(0.5, 1) for _ in range(3)]
                model = {"format": "modetune-model/1", "dimension": 3, "gravity_m_per_s2": [-G, 0, 0], "joints": [], "springs": [],
                         "bodies": [{"name": "tip", "mass_kg": 1, "centre": tip}]}
                for i in range(2):
                    foot = [r.uniform(-0.3, 0.3) for _ in range(3)]
                    way = numpy.subtract(tip, foot)
                    spin = 0.5 * (way @ way * numpy.eye(3) - numpy.outer(way, way)) / 12
                    model["bodies"].append({"name": f"rod{i}", "mass_kg": 0.5, "centre": [(a + b) / 2 for a, b in zip(tip, foot)],
                                            "inertia_kg_m2": [*spin.diagonal().tolist(), spin[0, 1], spin[0, 2], spin[1, 2]]})
                    model["joints"] += [{"name": f"foot{i}", "type": "spherical", "bodies": ["ground", f"rod{i}"], "at": foot},
                                        {"name": f"tip{i}", "type": "spherical", "bodies": [f"rod{i}", "tip"], "at": tip}]
                for k, stiffness in enumerate((100, 500, 200)):
                    far = [x + (1 if i == k else 0) for i, x in enumerate(tip)]
                    model["springs"].append({"name": f"s{k}", "type": "axial", "bodies": ["ground", "tip"], "at": [far, tip],
                                             "stiffness_n_per_m": stiffness})
                got = self.answer(model, "modes")
                self.assertLessEqual(got["equilibrium"]["iterations"], 10)

    def test_a_closed_loop_without_equilibrium_is_not_called_open(self):
        for i in range(6):
            r = seeded("falls", i)
            m = loop([[0, 0], [0.2, r.uniform(0.3, 0.6)], [1, r.uniform(0.5, 0.9)], [1.1, 0]])
            m.body("base", [0.5, -0.1])
            m.joints = [(n, k, tuple("base" if b == "ground" else b for b in pair), at, axis)
                        for n, k, pair, at, axis in m.joints]
            if i % 2:
                m.joint("rail", "prismatic", "ground", "base", [0.5, -0.1], [1, r.uniform(0.2, 2)])
            m.more["gravity_m_per_s2"] = [0, -G]
            done = self.run_on(m.model(), "modes")
            self.assertEqual(done.returncode, 3)
            self.assertIn("no equilibrium found", done.stderr)


if __name__ == "__main__":
    unittest.main()

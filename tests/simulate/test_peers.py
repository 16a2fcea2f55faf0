# SPDX-License-Identifier: GPL-3.0-or-later
"""Motions against equations of motion written by hand and integrated by SciPy."""
import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

MODETUNE = os.environ["MODETUNE"]
G, M1, M2, L1, L2 = 9.81, 1.3, 0.7, 0.9, 0.6
DOUBLE = {
    "format": "modetune-model/1", "name": "double pendulum", "dimension": 2, "gravity_m_per_s2": [0, -G],
    "bodies": [{"name": "upper", "mass_kg": M1, "inertia_kg_m2": 0, "centre": [0, -L1]},
               {"name": "lower", "mass_kg": M2, "inertia_kg_m2": 0, "centre": [0, -L1 - L2]}],
    "joints": [{"name": "top", "type": "revolute", "bodies": ["ground", "upper"], "at": [0, 0]},
               {"name": "elbow", "type": "revolute", "bodies": ["upper", "lower"], "at": [0, -L1]}],
    "sensors": [{"name": "s", "on": "lower", "directions": ["x", "y"]}],
    "configurations": {"c": {}},
}
K, C, MASS, LENGTH = 40.0, 0.8, 1.1, 0.5
SPRUNG = {  # an elastic pendulum with a damper along it, on a ground that shakes
    "format": "modetune-model/1", "name": "elastic pendulum", "dimension": 2, "gravity_m_per_s2": [0, -G],
    "bodies": [{"name": "bob", "mass_kg": MASS, "centre": [0, -LENGTH]}],
    "springs": [{"name": "k", "type": "axial", "bodies": ["ground", "bob"], "at": [[0, 0], [0, -LENGTH]], "stiffness_n_per_m": K,
                 "free_length_m": LENGTH}],
    "dampers": [{"name": "c", "type": "axial", "bodies": ["ground", "bob"], "at": [[0, 0], [0, -LENGTH]], "damping_n_s_per_m": C}],
    "sensors": [{"name": "s", "on": "bob", "directions": ["x", "y"]}],
    "configurations": {"c": {}},
}


def double(_, y):
    """Angles against the vertical (Lagrange; point masses on massless rods)."""
    a, b, u, v = y
    d = a - b
    mass = np.array([[(M1 + M2) * L1, M2 * L2 * np.cos(d)], [L1 * np.cos(d), L2]])
    force = np.array([-M2 * L2 * v * v * np.sin(d) - (M1 + M2) * G * np.sin(a), L1 * u * u * np.sin(d) - G * np.sin(b)])
    return [u, v, *np.linalg.solve(mass, force)]


def sprung(t, y):
    """Position against the ground, whose acceleration along x is 3 sin(9 t)."""
    x, v = y[:2], y[2:]
    r = np.hypot(*x)
    along = x / r
    force = -(K * (r - LENGTH) + C * (along @ v)) * along
    return [*v, *(force / MASS + np.array([-3 * np.sin(9 * t), -G]))]


class Peers(unittest.TestCase):
    def simulate(self, model, *options):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "model.json")
            path.write_text(json.dumps(model))
            done = subprocess.run([MODETUNE, "simulate", path, "--format", "json", *options], check=True, capture_output=True, text=True)
        answer = json.loads(done.stdout)
        return np.array(answer["time_s"]), np.array([o["values"] for o in answer["outputs"]]), answer

    def test_double_pendulum(self):
        times, seen, answer = self.simulate(DOUBLE, "--start", "top=2.0", "--start", "elbow=-0.6", "--rate", "top=1.5", "--rate", "elbow=-2",
                                            "--duration", "3", "--dt-out", "0.1", "--measure", "top", "--measure", "elbow", "--measure", "top:velocity")
        peer = solve_ivp(double, (0, 3), [2.0, 1.4, 1.5, -0.5], method="DOP853", rtol=1e-13, atol=1e-13, t_eval=times)
        self.assertLess(np.abs(seen[0] - peer.y[0]).max(), 1e-8)
        self.assertLess(np.abs(seen[1] - (peer.y[1] - peer.y[0])).max(), 1e-8)
        self.assertLess(np.abs(seen[2] - peer.y[2]).max(), 1e-7)
        self.assertLess(answer["energy_error_j"], 1e-9 * answer["energy_scale_j"])

    def test_elastic_pendulum_with_a_damper_on_a_shaking_ground(self):
        times, seen, _ = self.simulate(SPRUNG, "--input", "base.x=3*sin(9*t)", "--duration", "4", "--dt-out", "0.05", "--measure", "s.x",
                                       "--measure", "s.y", "--measure", "s.x:velocity", "--measure", "s.x:acceleration")
        rest = -LENGTH - MASS * G / K  # where the spring carries the weight
        peer = solve_ivp(sprung, (0, 4), [0, rest, 0, 0], method="DOP853", rtol=1e-13, atol=1e-13, t_eval=times)
        self.assertLess(np.abs(seen[0] - peer.y[0]).max(), 1e-9)
        self.assertLess(np.abs(seen[1] - (peer.y[1] - rest)).max(), 1e-9)
        self.assertLess(np.abs(seen[2] - peer.y[2]).max(), 1e-8)
        absolute = np.array([sprung(t, y)[2] + 3 * np.sin(9 * t) for t, y in zip(peer.t, peer.y.T)])
        self.assertLess(np.abs(seen[3] - absolute).max(), 1e-7)


if __name__ == "__main__":
    unittest.main()

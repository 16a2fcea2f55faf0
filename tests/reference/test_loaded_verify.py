# SPDX-License-Identifier: GPL-3.0-or-later
"""Long chains and strips under load against forty digits: what is promised of the lowest modes up to a thousand links.

    chain   1 m, 1.5 kg, n rigid links with springs of 9800 n N m/rad between them, hung on a pin in gravity
    strip   a clamped beam in n elements, a preloaded string elsewhere in the model

Both are banded in displacements; the lowest eigenvalues come from inverse iteration in decimal arithmetic.
"""
import json
import math
import sys
import unittest
from decimal import Decimal, getcontext
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "cli"))
from common_cli import CliTest  # noqa: E402
from suite import INSTRUMENTED  # noqa: E402

getcontext().prec = 45
D = Decimal
PROMISED = 1e-9
SMALL = INSTRUMENTED
CHAINS = [40] if SMALL else [100, 400, 1000]
STRIPS = [12] if SMALL else [60, 144, 300]


class Pencil:
    """K x = lambda M x by lower bands: k[i][d] is entry (i, i - d)."""

    def __init__(self, n, band):
        self.n, self.band = n, band
        self.k = [[D(0)] * (band + 1) for _ in range(n)]
        self.m = [[D(0)] * (band + 1) for _ in range(n)]

    @staticmethod
    def add(a, c, row):
        for i, x in row:
            for j, y in row:
                if i >= j >= 0:
                    a[i][i - j] += c * x * y

    def times(self, a, x):
        y = [D(0)] * self.n
        for i in range(self.n):
            y[i] += a[i][0] * x[i]
            for d in range(1, min(self.band, i) + 1):
                y[i] += a[i][d] * x[i - d]
                y[i - d] += a[i][d] * x[i]
        return y

    def factor(self):
        """K = L D L^T."""
        low, diagonal = [[D(0)] * (self.band + 1) for _ in range(self.n)], [D(0)] * self.n
        for i in range(self.n):
            for j in range(max(0, i - self.band), i + 1):
                s = self.k[i][i - j]
                for p in range(max(0, i - self.band), j):
                    s -= low[i][i - p] * diagonal[p] * low[j][j - p]
                if i == j:
                    diagonal[i] = s
                else:
                    low[i][i - j] = s / diagonal[j]
        return low, diagonal

    def solve(self, factor, b):
        low, diagonal = factor
        x = list(b)
        for i in range(self.n):
            for d in range(1, min(self.band, i) + 1):
                x[i] -= low[i][d] * x[i - d]
        x = [a / b for a, b in zip(x, diagonal)]
        for i in reversed(range(self.n)):
            for d in range(1, min(self.band, self.n - 1 - i) + 1):
                x[i] -= low[i + d][d] * x[i + d]
        return x

    def lowest(self, count):
        """Inverse iteration, each vector kept orthogonal to those before."""
        factor, found, values = self.factor(), [], []
        for c in range(count):
            x = [D((7 * i * i + 3 * i + c) % 11 + 1) for i in range(self.n)]
            value, last = D(1), D(0)
            while abs(value - last) > abs(value) * D(10) ** -25:
                x = self.solve(factor, self.times(self.m, x))
                for v, mv in found:
                    part = sum(a * b for a, b in zip(mv, x))
                    x = [a - part * b for a, b in zip(x, v)]
                mx = self.times(self.m, x)
                size = sum(a * b for a, b in zip(x, mx)).sqrt()
                x, mx = [a / size for a in x], [a / size for a in mx]
                last, value = value, sum(a * b for a, b in zip(x, self.times(self.k, x)))
            found.append((x, mx))
            values.append(value)
        return [float(v) for v in values]


def chain_reference(n):
    p, h, m, g = Pencil(n, 2), D(1) / n, D("1.5") / n, D("9.81")
    for i in range(1, n + 1):
        p.add(p.m, m / 3, [(i - 2, D(1)), (i - 1, D("0.5"))])
        p.add(p.m, m / 4, [(i - 1, D(1))])
        p.add(p.k, g * m * h * (n - i + D("0.5")), [(i - 2, -1 / h), (i - 1, 1 / h)])
        if i > 1:
            p.add(p.k, D(9800) * n, [(i - 3, 1 / h), (i - 2, -2 / h), (i - 1, 1 / h)])
    return p.lowest(3)


def strip_reference(n):
    p, h = Pencil(2 * n, 3), D(1) / n
    stiff = [[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]]
    mass = [[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]
    for e in range(n):
        for i in range(4):
            for j in range(i + 1):
                row, col = 2 * (e - 1) + i, 2 * (e - 1) + j
                if col >= 0:
                    p.k[row][row - col] += D("0.04") / h ** 3 * stiff[i][j]
                    p.m[row][row - col] += D("0.08") * h / 420 * mass[i][j]
    return p.lowest(2)


def chain(n):
    return {"format": "modetune-model/1", "dimension": 2, "gravity_m_per_s2": [0, -9.81], "points": {"a": [0, 0], "b": [0, -1]},
            "links": [{"name": "c", "from": "a", "to": "b", "elements": n, "mass_kg": 1.5, "stiffness_n_m_per_rad": 9800 * n}],
            "joints": [{"name": "p", "type": "revolute", "bodies": ["ground", "c.start"], "at": "a"}]}


def strip(n):
    string = [{"name": name, "type": "axial", "bodies": ["ground", "bead"], "at": [[x, 3], [0, 3]], "stiffness_n_per_m": 2000,
               "preload_n": 50} for name, x in (("l", -0.5), ("r", 0.5))]
    return {"format": "modetune-model/1", "dimension": 2, "points": {"a": [0, 0], "b": [1, 0]},
            "links": [{"name": "s", "kind": "beam", "from": "a", "to": "b", "elements": n, "youngs_modulus_pa": 2e11,
                       "density_kg_per_m3": 8000,
                       "section": {"shape": "general", "area_m2": 1e-5, "second_moment_m4": 2e-13}}],
            "bodies": [{"name": "bead", "mass_kg": 0.2, "centre": [0, 3]}], "springs": string,
            "joints": [{"name": "w", "type": "fixed", "bodies": ["ground", "s.start"], "at": "a"}]}


class Loaded(CliTest):
    def compare(self, name, model, reference):
        path = self.write(f"problems/{name}.json", json.dumps(model))
        got = self.json_of("modes", path, "--count", "4")[0]
        self.assertEqual((got["rigid_body_modes"], got["unstable_modes"], got["undecided_modes"]), (0, 0, 0))
        for want in reference:
            mode = min(got["modes"], key=lambda m: abs(m["omega_squared"] - want))
            error = abs(mode["omega_squared"] - want)
            self.assertLess(error / want, PROMISED)
            self.assertLessEqual(error, mode["omega_squared_error"])
            self.assertLess(mode["omega_squared_error"] / want, 1e-6)
            hz = math.sqrt(want) / (2 * math.pi)
            self.assertLessEqual(abs(mode["frequency_hz"] - hz), mode["frequency_error_hz"])

    def test_hanging_chains(self):
        for n in CHAINS:
            with self.subTest(links=n):
                self.compare(f"chain_{n}", chain(n), chain_reference(n))

    def test_strips_beside_a_preloaded_string(self):
        for n in STRIPS:
            with self.subTest(elements=n):
                self.compare(f"strip_{n}", strip(n), strip_reference(n))


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""An independent solver: K(x) and M(x) of plane mechanisms written down from their geometry, and LAPACK through numpy.

Knows what the generator makes (models.py): bodies of 2 or 3 coordinates, axial and torsion springs, bars with consistent
mass, tension that is in equilibrium in the reference position, rows of masses hanging from distance joints, arms whose
unloaded joints are driven. Every matrix is a sum s_j(x) B_j of an expression and a constant matrix, so that thousands of
designs are solved at once.
"""
import math

import numpy as np

from expressions import evaluate, parameters

TWO_PI = 2.0 * math.pi
RIGID = 1e-11  # of the greatest eigenvalue: below it a mode is no vibration


class Body:
    def __init__(self, item, first, centre):
        self.item, self.first = item, first
        self.turns = "inertia_kg_m2" in item
        self.size = 3 if self.turns else 2
        self.centre = centre
        self.reference = self.centre.copy()
        self.angle = 0.0

    def carried(self, point):
        """Where a point of the reference position is now."""
        c, s = math.cos(self.angle), math.sin(self.angle)
        return self.centre + np.array([[c, -s], [s, c]]) @ (point - self.reference)


class Assembly:
    """One configuration: terms of K and M, reduced to the coordinates that the joints leave."""

    def __init__(self, model, name, settings=None):
        settings = model.get("configurations", {}).get(name, {}) if settings is None else settings
        self.model, self.name = model, name
        self.overrides = settings.get("parameters", {})
        values = parameters(model, self.overrides)
        self.values, self.points = values, {}
        self.points = {name: self._point(at) for name, at in model.get("points", {}).items()}
        self.bodies, size = {}, 0
        for item in model["bodies"]:
            if self._here(item):
                self.bodies[item["name"]] = Body(item, size, self._point(item["centre"]))
                size += self.bodies[item["name"]].size
        self.size = size
        self.stiffness, self.mass = [], []
        self.rows = []
        self._drive(settings.get("drive"))
        self._joints(settings.get("gravity_m_per_s2", model.get("gravity_m_per_s2", [0, 0])))
        for body in self.bodies.values():
            self._inertia(body)
        for spring in model.get("springs", []):
            if self._here(spring):
                self._spring(spring)
        basis = self._free(np.array(self.rows).reshape(-1, size))
        self.n = basis.shape[1]
        self.stiffness, self.mass = (
            ([s for s, _ in terms], np.array([basis.T @ b @ basis for _, b in terms]).reshape(len(terms), -1))
            for terms in (self.stiffness, self.mass))

    def _here(self, item):
        return "in" not in item or self.name in item["in"]

    def _point(self, at):
        return self.points[at] if isinstance(at, str) else np.array([float(evaluate(c, self.values)) for c in at])

    def _drive(self, drive):
        """Turn the second body of an unloaded revolute joint, and all bodies listed after it, about the joint."""
        if drive is None:
            return
        joint = next(j for j in self.model["joints"] if j["name"] == drive["joint"])
        angle, pivot = float(evaluate(drive["position_rad"], self.values)), self._point(joint["at"])
        c, s = math.cos(angle), math.sin(angle)
        moved = list(self.bodies).index(joint["bodies"][1])
        for body in list(self.bodies.values())[moved:]:
            body.centre = pivot + np.array([[c, -s], [s, c]]) @ (body.centre - pivot)
            body.angle += angle
        if drive.get("hold", "lock") == "lock":
            row = np.zeros(self.size)
            for name, sign in zip(joint["bodies"], (-1.0, 1.0)):
                if name != "ground":
                    row[self.bodies[name].first + 2] = sign
            self.rows.append(row)

    def _motion(self, name, point):
        """2 x size: how a point of a body moves; and where it is."""
        rows = np.zeros((2, self.size))
        if name == "ground":
            return rows, point
        body = self.bodies[name]
        place = body.carried(point)
        rows[0, body.first], rows[1, body.first + 1] = 1.0, 1.0
        if body.turns:
            rows[0, body.first + 2], rows[1, body.first + 2] = -(place - body.centre)[1], (place - body.centre)[0]
        return rows, place

    def _turn(self, name):
        row = np.zeros(self.size)
        if name != "ground":
            row[self.bodies[name].first + 2] = 1.0
        return row

    def _joints(self, gravity):
        hanging = []
        for joint in self.model.get("joints", []):
            if not self._here(joint):
                continue
            a, b = joint["bodies"]
            at = joint["at"] if joint["type"] == "distance" else [joint["at"], joint["at"]]
            (motion_a, place_a), (motion_b, place_b) = (self._motion(n, self._point(p)) for n, p in zip((a, b), at))
            apart = motion_b - motion_a
            if joint["type"] == "distance":
                along = (place_b - place_a) / np.linalg.norm(place_b - place_a)
                self.rows.append(along @ apart)
                hanging.append((b, np.array([-along[1], along[0]]) @ apart, joint["length_m"]))
            elif joint["type"] == "revolute":
                self.rows.extend(apart)
            else:
                axis = np.array(joint["axis"], float)
                self.rows.append(np.array([-axis[1], axis[0]]) / np.linalg.norm(axis) @ apart)
                if joint["type"] == "prismatic":
                    self.rows.append(self._turn(b) - self._turn(a))
        # a row of masses below each other: the tension of each joint is the weight of all that hangs from it
        for i, (_, across, length) in enumerate(hanging):
            below = "+".join(f"({self.bodies[b].item['mass_kg']})" for b, _, _ in hanging[i:])
            self.stiffness.append((f"{abs(evaluate(gravity[1], self.values))!r}*({below})/({length})", np.outer(across, across)))

    def _inertia(self, body):
        place = np.zeros((self.size, self.size))
        place[body.first, body.first] = place[body.first + 1, body.first + 1] = 1.0
        self.mass.append((body.item.get("mass_kg", 0), place))
        if body.turns:
            turn = np.zeros((self.size, self.size))
            turn[body.first + 2, body.first + 2] = 1.0
            self.mass.append((body.item["inertia_kg_m2"], turn))

    def _spring(self, spring):
        if spring["type"] == "torsion":
            a, b = spring["bodies"] if "bodies" in spring else next(
                j for j in self.model["joints"] if j["name"] == spring["joint"])["bodies"]
            angle = self._turn(b) - self._turn(a)
            self.stiffness.append((spring["stiffness_n_m_per_rad"], np.outer(angle, angle)))
            return
        if spring["type"] == "axial" and isinstance(spring["at"][0], list) and isinstance(spring["at"][0][1], str):
            self._rod(spring)
            return
        (motion_a, place_a), (motion_b, place_b) = (
            self._motion(n, self._point(p)) for n, p in zip(spring["bodies"], spring["at"]))
        apart, length = motion_b - motion_a, np.linalg.norm(place_b - place_a)
        along = (place_b - place_a) / length
        longer, across = along @ apart, np.array([-along[1], along[0]]) @ apart
        if spring["type"] == "axial":
            self.stiffness.append((spring["stiffness_n_per_m"], np.outer(longer, longer)))
        else:
            self.stiffness.append((f"({spring['youngs_modulus_pa']})*({spring['area_m2']})/{length!r}", np.outer(longer, longer)))
            if "density_kg_per_m3" in spring:
                consistent = sum(motion_a.T @ motion_a + motion_b.T @ motion_b + w
                                 for w in [0.5 * (motion_a.T @ motion_b + motion_b.T @ motion_a)]) / 3.0
                self.mass.append((f"({spring['density_kg_per_m3']})*({spring['area_m2']})*{length!r}", consistent))
        if "preload_n" in spring:
            self.stiffness.append((f"({spring['preload_n']})/{length!r}", np.outer(across, across)))

    def _rod(self, spring):
        """Along x at a height that is a length of the model: with e = u + height v, k e e^T = k u u^T + k height (u v^T + v u^T) + k height^2 v v^T."""
        height = spring["at"][0][1]
        assert spring["at"][1][1] == height
        at_0, at_1 = (sum(sign * self._motion(n, np.array([float(p[0]), y]))[0][0] for n, p, sign in zip(spring["bodies"], spring["at"], (-1.0, 1.0)))
                      for y in (0.0, 1.0))
        u, v, k = at_0, at_1 - at_0, f"({spring['stiffness_n_per_m']})"
        self.stiffness += [(k, np.outer(u, u)), (f"{k}*({height})", np.outer(u, v) + np.outer(v, u)), (f"{k}*({height})^2", np.outer(v, v))]

    def _free(self, rows):
        if rows.shape[0] == 0:
            return np.eye(self.size)
        _, s, vt = np.linalg.svd(rows)
        return vt[int(np.sum(s > 1e-9 * s[0])):].T

    def _sum(self, terms, values, count):
        scales = np.empty((len(terms[0]), count))
        for i, scale in enumerate(terms[0]):
            scales[i] = evaluate(scale, values)
        return (scales.T @ terms[1]).reshape(count, self.n, self.n)

    def matrices(self, design, count):
        """K, M [count, n, n] of designs {parameter: array[count]}; an override wins over a variable."""
        values = parameters(self.model, {**design, **self.overrides})
        return self._sum(self.stiffness, values, count), self._sum(self.mass, values, count)

    def frequencies(self, design, count):
        """[count, n] Hz of all modes, ascending; those without stiffness have 0, those without mass (that stiffness holds) infinity. NaN: unstable, or neither."""
        stiffness, mass = self.matrices(design, count)
        try:
            return self._solved(stiffness, mass)
        except (np.linalg.LinAlgError, ValueError):  # one of them has no solution: which?
            out = np.full((count, self.n), np.nan)
            for i in range(count):
                try:
                    k, m = condensed(stiffness[i], mass[i])
                    out[i] = np.inf
                    out[i, :len(k)] = self._solved(k[None], m[None])[0]
                except (np.linalg.LinAlgError, ValueError):
                    out[i] = np.nan
            return out

    def _solved(self, stiffness, mass):
        root = np.linalg.inv(np.linalg.cholesky(mass))
        squares = np.linalg.eigvalsh(root @ stiffness @ np.swapaxes(root, 1, 2))
        floor = RIGID * np.abs(squares).max(axis=1)[:, None]
        hz = np.where(squares > floor, np.sqrt(np.abs(squares)) / TWO_PI, 0.0)
        hz[np.any(~(squares >= -floor), axis=1)] = np.nan
        return hz


def condensed(k, m):
    """What has no mass follows the others statically."""
    sizes, ways = np.linalg.eigh(m)
    light = sizes <= 1e-14 * sizes.max(initial=0.0)
    if not light.any():
        return k, m
    heavy, still = ways[:, ~light], ways[:, light]
    held = still.T @ k @ still
    np.linalg.cholesky(held)
    ways = heavy - still @ np.linalg.solve(held, still.T @ k @ heavy)
    return ways.T @ k @ ways, ways.T @ m @ ways


class Plant:
    """All configurations of a model."""

    def __init__(self, model):
        self.model = model
        self.original = parameters(model, {})
        self.names = list(model.get("configurations", {})) or ["default"]
        self._made = {}

    def add(self, name, settings):
        """A configuration that the model does not have."""
        if name not in self._made:
            self._made[name] = Assembly(self.model, name, settings)

    def assembly(self, name):
        if name not in self._made:
            self._made[name] = Assembly(self.model, name)
        return self._made[name]

    def total_mass(self, design, count, configuration, of=None):
        """Of bodies and bars (all of them), with the overrides of a configuration, [count] kg."""
        from fnmatch import fnmatchcase
        values = parameters(self.model, {**design, **self.assembly(configuration).overrides})
        total = np.zeros(count)
        for item in self.model["bodies"] + [s for s in self.model.get("springs", []) if s["type"] == "bar"]:
            if of is not None and not any(fnmatchcase(item["name"], p) for p in of):
                continue
            if item.get("type") == "bar":
                length = np.linalg.norm(np.subtract(*[[float(evaluate(c, values)) for c in
                                                       (self.model["points"][p] if isinstance(p, str) else p)] for p in item["at"]]))
                total = total + evaluate(item.get("density_kg_per_m3", 0), values) * evaluate(item["area_m2"], values) * length
            else:
                total = total + evaluate(item.get("mass_kg", 0), values)
        return total

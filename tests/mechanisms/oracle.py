# SPDX-License-Identifier: GPL-3.0-or-later
"""An independent mechanics of one configuration, from first principles, in eighty digits.

A body of the plane has the coordinates (x, y, c, s), its rotation being [[c, -s], [s, c]]; one of space (x, R) with the nine entries of R;
a point mass x alone. That R is a rotation are constraints like all others. In these coordinates the kinetic energy is a constant quadratic form,
points and directions fixed to a body are linear, and every measure of a joint or spring is a function of one or two quadratic forms, whose Hessians are
constant: nothing here shares a chart, a formula or a rounding with the program under test.
    equilibrium   grad V + A' y = 0, c = 0           modes   Z'(V'' + sum y_i c_i'')Z u = lambda Z'M Z u,   A Z = 0
"""
import re
from decimal import Decimal

import exact
from exact import number

COUPLINGS = {"gear": "ratio", "rack": "ratio_m_per_rad"}
CONSTANT = -1  # index of what multiplies nothing


class Refused(Exception):
    """What the oracle cannot judge; a reason in one word."""


class Quad:
    """A quadratic form in the coordinates: value, gradient and the constant Hessian as {(i, j): h_ij}, i <= j."""

    def __init__(self, terms):
        self.terms = [(i, j, c) for (i, j), c in terms.items() if c]  # i <= j; CONSTANT first
        self._cast = {Decimal: self.terms, float: [(i, j, float(c)) for i, j, c in self.terms]}
        self._curves = {}

    def curves(self, cast):
        """[((i, j), h_ij)], i <= j, in decimals or floats."""
        if cast not in self._curves:
            self._curves[cast] = [((i, j), 2 * c if i == j else c) for i, j, c in self._cast[cast] if i >= 0]
        return self._curves[cast]

    def times(self, factor):
        return {(i, j): c * factor for i, j, c in self.terms}

    def at(self, q):
        value, slope = q[0] * 0, {}
        for i, j, c in self._cast[type(value)]:
            if j < 0:
                value += c
            elif i < 0:
                value += c * q[j]
                slope[j] = slope.get(j, 0) + c
            else:
                value += c * q[i] * q[j]
                slope[i] = slope.get(i, 0) + c * q[j]
                slope[j] = slope.get(j, 0) + c * q[i]
        return value, slope


def product(forms_a, forms_b):
    """Quad of sum_k a_k b_k of linear forms {index: coefficient}."""
    terms = {}
    for a, b in zip(forms_a, forms_b):
        for i, x in a.items():
            for j, y in b.items():
                key = (i, j) if i <= j else (j, i)
                terms[key] = terms.get(key, 0) + x * y
    return Quad(terms)


class Measure:
    """f(p_1, p_2 ...) of quads; outer(values) -> (f, [f_i], {(i, j): f_ij}) with i <= j."""

    def __init__(self, quads, outer):
        self.quads, self.outer, self.near = quads, outer, None

    def at(self, q):
        """Value, gradient {i: .}, and the parts of the Hessian: ([(factor, quad)], [(factor, gradient, gradient)])."""
        found = [p.at(q) for p in self.quads]
        f, first, second = self.outer([v for v, _ in found])
        slope = {}
        for d, (_, g) in zip(first, found):
            for i, x in g.items():
                slope[i] = slope.get(i, 0) + d * x
        bent = [(d, p) for d, p in zip(first, self.quads)]
        outer = [(d, found[i][1], found[j][1]) for (i, j), d in second.items() if d]
        return f, slope, bent, outer


def plain(quad):
    return Measure([quad], lambda p: (p[0], [1], {}))


def distance(quad):
    def outer(p):
        if not p[0]:  # where Newton's method may go from a rest that is neutral
            raise Refused("the ends of a length coincide")
        length = exact.root(p[0])
        return length, [1 / (2 * length)], {(0, 0): -1 / (4 * length * p[0])}
    return Measure([quad], outer)


def turned(sine, cosine):
    """atan2 of two quads, by whole turns next to `near` of the measure."""
    def outer(v):
        p, q = v
        r = p * p + q * q
        f = exact.angle(p, q)
        if measure.near is not None:
            turn = 2 * exact.PI if isinstance(p, Decimal) else 2 * float(exact.PI)
            f += turn * round((float(measure.near) - float(f)) / float(turn))
        return f, [q / r, -p / r], {(0, 0): -2 * p * q / r**2, (0, 1): (p * p - q * q) / r**2, (1, 1): 2 * p * q / r**2}
    measure = Measure([sine, cosine], outer)
    return measure


def rotation(skew, trace):
    """Component of the rotation vector: skew * f(cos), cos = (trace - 1)/2."""
    def outer(v):
        psi, cosine = v
        f, d, dd = exact.angle_over_sine(cosine)
        return f * psi, [f, d * psi], {(0, 1): d, (1, 1): dd * psi}
    return Measure([skew, trace], outer)


def geared(a, b, ratio):
    """b - ratio a of two measures of angles."""
    def outer(v):
        r = type(v[0])(ratio)
        f1, d1, s1 = a.outer(v[:2])
        f2, d2, s2 = b.outer(v[2:])
        second = {k: -r * x for k, x in s1.items()}
        second.update({(i + 2, j + 2): x for (i, j), x in s2.items()})
        return f2 - r * f1, [-r * x for x in d1] + d2, second
    return Measure(a.quads + b.quads, outer)


class Body:
    def __init__(self, first, centre, turns):
        self.first, self.centre, self.turns = first, centre, turns
        d = len(centre)
        self.size = d if not turns else d + (2 if d == 2 else 9)


class Spring:
    """V = sum over i, j of 1/2 k_ij d_i d_j + sum_i t_i d_i, d = measure - rest."""

    def __init__(self, name, measures, stiffness, rest, tension):
        self.name, self.measures, self.k, self.rest, self.tension = name, measures, stiffness, rest, tension
        self.trimmed = False


class Oracle:
    """One configuration of a model as read from its file, with other values of parameters."""

    def __init__(self, model, configuration=None, values=None, read=number):
        self.model, self.dim, self.read = model, model["dimension"], read
        self.name = configuration or next(iter(model.get("configurations") or {"default": {}}))
        self.settings = self._settings(self.name)
        self.values, self.given = {}, {**self.settings["parameters"], **(values or {})}
        for name in model.get("parameters", {}):
            self._parameter(name)
        self.bodies, self.size = {}, 0
        self.constraints, self.owner, self.coordinate = [], [], {}
        self.springs, self.mass, self.weights, self.forces = [], {}, [], []
        self.beams = False
        self._bodies()
        self._joints()
        self._springs()
        self._loads()
        self._drive()

    # numbers ------------------------------------------------------------------------------------------------------------------------------------
    def _settings(self, name):
        own = (self.model.get("configurations") or {}).get(name, {})
        base = self._settings(own["like"]) if "like" in own else {"parameters": {}, "gravity_m_per_s2": self.model.get("gravity_m_per_s2"), "names": []}
        return {"parameters": {**base["parameters"], **own.get("parameters", {})}, "names": [name, *base["names"]],
                "gravity_m_per_s2": own.get("gravity_m_per_s2", base["gravity_m_per_s2"]), "drive": own.get("drive", base.get("drive"))}

    def _parameter(self, name):
        if name not in self.values:
            given = self.model["parameters"][name]
            self.values[name] = self.n(self.given.get(name, given["value"] if isinstance(given, dict) else given))
        return self.values[name]

    def n(self, value):
        """A number or an expression of names, numbers, + - * /."""
        if not isinstance(value, str):
            return value if isinstance(value, Decimal) else self.read(value)
        if value in self.model.get("parameters", {}):
            return self._parameter(value)
        text = re.sub(r"(?<![\w.])(\d+\.?\d*(?:[eE][+-]?\d+)?)", r"D(\1)", value).replace("^", "**")
        return eval(text, {"D": self.read, "__builtins__": {}}, _Names(self))  # noqa: S307: our own models

    def v(self, value):
        """A point or vector."""
        return [self.n(x) for x in (self.model["points"][value] if isinstance(value, str) else value)]

    def here(self, item):
        return "in" not in item or any(n in item["in"] for n in self.settings["names"])

    # what moves ---------------------------------------------------------------------------------------------------------------------------------
    def _add_mass(self, forms, factor):
        """factor * sum of squares of linear forms, of velocities."""
        for form in forms:
            for i, x in form.items():
                for j, y in form.items():
                    if i >= 0 and j >= 0 and i <= j:
                        self.mass[i, j] = self.mass.get((i, j), 0) + factor * x * y

    def _body(self, name, centre, mass, inertia):
        """inertia: None, a number, or a 3 x 3 matrix about the centre."""
        body = Body(self.size, centre, inertia is not None)
        self.bodies[name] = body
        self.size += body.size
        self._add_mass([{body.first + i: Decimal(1)} for i in range(self.dim)], mass)
        self._weight(name, centre, mass)
        if inertia is None:
            return
        if self.dim == 2:
            self._add_mass([{body.first + 2: Decimal(1)}, {body.first + 3: Decimal(1)}], inertia)
            return
        trace = sum(inertia[i][i] for i in range(3))
        for k in range(3):
            for m in range(3):
                e = (trace / 2 if k == m else 0) - inertia[k][m]
                for i in range(3):  # row i of R: entries at 3 + 3 i + k
                    a, b = body.first + 3 + 3 * i + k, body.first + 3 + 3 * i + m
                    if a <= b and e:
                        self.mass[a, b] = self.mass.get((a, b), 0) + e

    def _weight(self, name, at, mass):
        if mass and name != "ground":
            self.weights.append((self.point(name, at), mass))

    def point(self, name, at):
        """Where a point drawn at `at` of a body is: linear forms."""
        if name == "ground":
            return [{CONSTANT: x} for x in at]
        body = self.bodies[name]
        arm = [x - c for x, c in zip(at, body.centre)]
        forms = [{body.first + i: Decimal(1)} for i in range(self.dim)]
        if not body.turns:
            if any(arm):
                raise Refused("a point mass is held at its centre")
            return forms
        return [{**f, **g} for f, g in zip(forms, self.direction(name, arm))]

    def direction(self, name, u):
        """A vector fixed to a body."""
        if name == "ground":
            return [{CONSTANT: x} for x in u]
        body = self.bodies[name]
        if not body.turns:
            return [{CONSTANT: x} for x in u]
        if self.dim == 2:
            c, s = body.first + 2, body.first + 3
            return [{c: u[0], s: -u[1]}, {c: u[1], s: u[0]}]
        return [{body.first + 3 + 3 * i + k: u[k] for k in range(3) if u[k]} for i in range(3)]

    def _bodies(self):
        for item in self.model.get("bodies", []):
            if not self.here(item):
                continue
            inertia = item.get("inertia_kg_m2")
            if inertia is not None and self.dim == 3:
                given = [self.n(x) for x in inertia] + [Decimal(0)] * (6 - len(inertia))
                xx, yy, zz, xy, xz, yz = given
                own, e = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], self._axes(item)
                n = range(3)
                inertia = [[sum(own[i][j] * e[i][r] * e[j][c] for i in n for j in n) for c in n] for r in n]
            elif inertia is not None:
                inertia = self.n(inertia)
            self._body(item["name"], self.v(item["centre"]), self.n(item.get("mass_kg", 0)), inertia)
        for link in self.model.get("links", []):
            if self.here(link):
                self._link(link)

    def _add_quadratic(self, forms, matrix):
        """v' matrix v of linear forms v of velocities."""
        for r, a in enumerate(forms):
            for c, b in enumerate(forms):
                for i, x in a.items():
                    for j, y in b.items():
                        if i <= j and matrix[r][c]:
                            self.mass[i, j] = self.mass.get((i, j), 0) + matrix[r][c] * x * y

    def _spin(self, name, u):
        """Rate of turning about u of a body as drawn: a linear form of velocities, at the drawing only."""
        first = self.bodies[name].first
        if self.dim == 2:
            return {first + 3: Decimal(1)}
        entry = lambda i, k: first + 3 + 3 * i + k
        out = {}
        for k in range(3):
            i, j = (k + 1) % 3, (k + 2) % 3
            out[entry(j, i)], out[entry(i, j)] = u[k] / 2, -u[k] / 2
        return out

    def _beam(self, link):
        """Euler-Bernoulli elements between nodes: of the second node seen from the first, the tip stiffness of a cantilever; consistent mass."""
        n, start, end = link["elements"], self.v(link["from"]), self.v(link["to"])
        span = [(b - a) / n for a, b in zip(start, end)]
        length, section = exact.root(sum(x * x for x in span)), link["section"]
        area, young = self.n(section["area_m2"]), self.n(link["youngs_modulus_pa"])
        mass = self.n(link["mass_kg"]) / n if "mass_kg" in link else self.n(link["density_kg_per_m3"]) * area * length
        second = [self.n(section[m]) for m in ["second_moment_m4"] + ["second_moment_other_m4"] * (self.dim == 3)]
        along = unit(span)
        triad = [along, [-along[1], along[0]]]
        if self.dim == 3:
            axis = unit(self.v(link["hinge_axis"]))
            triad = [along, cross(axis, along), axis]
        self.beams = True
        nodes = [f"{link['name']}.node{i}" for i in range(n + 1)]
        for i, node in enumerate(nodes):
            self._body(node, [a + i * x for a, x in zip(start, span)], Decimal(0), Decimal(0) if self.dim == 2 else [[Decimal(0)] * 3] * 3)
        for a, b in zip(nodes, nodes[1:]):
            self._weight(a, self.bodies[a].centre, mass / 2)
            self._weight(b, self.bodies[b].centre, mass / 2)
            apart = self._apart([a, b], [self.bodies[a].centre, self.bodies[b].centre])
            shifts = [plain(product(self.direction(a, u), apart)) for u in triad]
            turns = self._turns([a, b], triad)
            k = [[Decimal(0)] * (len(shifts) + len(turns)) for _ in range(len(shifts) + len(turns))]
            k[0][0] = young * area / length
            for plane, ei in enumerate(young * x for x in second):  # deflection along e2 turns about e3, along e3 about -e2
                w, t, sign = (1, len(k) - 1, -1) if plane == 0 else (2, 4, 1)
                k[w][w], k[t][t] = 12 * ei / length**3, 4 * ei / length
                k[w][t] = k[t][w] = sign * 6 * ei / length**2
            if self.dim == 3:
                k[3][3] = self.n(link["shear_modulus_pa"]) * self.n(section["torsion_constant_m4"]) / length
            self.springs.append(Spring(link["name"], shifts + turns, k, [None] * len(k), [0] * len(k)))
            self._beam_mass([a, b], triad, mass, length, mass * sum(second) / area)
        for alias, node in (("start", nodes[0]), ("end", nodes[-1])):
            self.bodies[f"{link['name']}.{alias}"] = self.bodies[node]

    def _beam_mass(self, nodes, triad, mass, length, polar):
        moved = lambda name, u: {self.bodies[name].first + i: x for i, x in enumerate(u) if x}
        simple = [[Decimal(2) / 6, Decimal(1) / 6], [Decimal(1) / 6, Decimal(2) / 6]]
        self._add_quadratic([moved(b, triad[0]) for b in nodes], [[mass * x for x in row] for row in simple])
        cubic = [[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]
        for plane in range(self.dim - 1):
            across, about, sign = (1, triad[-1], 1) if plane == 0 else (2, triad[1], -1)
            forms = []
            for b in nodes:
                forms += [moved(b, triad[across]), {i: sign * length * x for i, x in self._spin(b, about).items()}]
            self._add_quadratic(forms, [[mass * x / 420 for x in row] for row in cubic])
        if self.dim == 3:
            self._add_quadratic([self._spin(b, triad[0]) for b in nodes], [[polar * x for x in row] for row in simple])

    def _turns(self, bodies, triad):
        """Measures of the rotation of the second body against the first: the angle, or the rotation vector in the triad of the first."""
        if self.dim == 2:
            return [self.angle_between(bodies, None)]
        fixed, moved = ([self.direction(b, u) for u in triad] for b in bodies)
        half = Decimal("0.5")
        trace = Quad(add(*[product(fixed[i], moved[i]).times(half) for i in range(3)], {(CONSTANT, CONSTANT): -half}))
        out = []
        for k in range(3):
            i, j = (k + 1) % 3, (k + 2) % 3
            out.append(rotation(Quad(add(product(fixed[j], moved[i]).times(half), product(fixed[i], moved[j]).times(-half))), trace))
        return out

    def _link(self, link):
        if link.get("kind") == "beam":
            self._beam(link)
            return
        n, start, end = link["elements"], self.v(link["from"]), self.v(link["to"])
        span = [b - a for a, b in zip(start, end)]
        length, mass = exact.root(sum(x * x for x in span)) / n, self.n(link["mass_kg"]) / n
        slender, axis = mass * length * length / 12, None
        if self.dim == 3:
            axis, along = self.v(link["hinge_axis"]), [x / (length * n) for x in span]
            r = self.n(link.get("radius_of_gyration_m", 0))
            slender = [[slender * (int(i == j) - along[i] * along[j]) + mass * r * r * along[i] * along[j] for j in range(3)] for i in range(3)]
        at = lambda f: [a + x * f / n for a, x in zip(start, span)]
        for i in range(n):
            self._body(f"{link['name']}.{i + 1}", at(Decimal(i) + Decimal("0.5")), mass, slender)
        stiffness = link.get("stiffness_n_m_per_rad", 0)
        for i in range(1, n):
            k = self.n(stiffness[0 if len(stiffness) == 1 else i - 1] if isinstance(stiffness, list) else stiffness)
            pair = [f"{link['name']}.{i}", f"{link['name']}.{i + 1}"]
            self._joint(f"{link['name']}.h{i}", "revolute", pair, [at(i), at(i)], axis)
            self.springs.append(Spring(f"{link['name']}.k{i}", [self.coordinate[f"{link['name']}.h{i}"]], [[k]], [None], [0]))
        for alias, element in (("start", 1), ("end", n)):
            self.bodies[f"{link['name']}.{alias}"] = self.bodies[f"{link['name']}.{element}"]

    # joints -------------------------------------------------------------------------------------------------------------------------------------
    def _hold(self, joint, measure, target=None):
        """measure = target; None: as drawn."""
        self.constraints.append((measure, target))
        self.owner.append(joint)

    def _perpendicular(self, axis):
        """Two vectors perpendicular to it and to each other, not of unit length; in the plane one."""
        if self.dim == 2:
            return [[-axis[1], axis[0]]]
        k = min(range(3), key=lambda i: abs(axis[i]))
        e = [Decimal(int(i == k)) for i in range(3)]
        first = cross(axis, e)
        return [first, cross(axis, first)]

    def _apart(self, bodies, at):
        a, b = self.point(bodies[0], at[0]), self.point(bodies[1], at[1])
        return [minus(y, x) for x, y in zip(a, b)]

    def angle_between(self, bodies, axis):
        """Angle of the second body against the first about the axis."""
        if self.dim == 2:
            b, c = [Decimal(1), Decimal(0)], [Decimal(0), Decimal(1)]
        else:
            b = unit(self._perpendicular(axis)[0])
            c = cross(unit(axis), b)
        moved = self.direction(bodies[1], b)
        return turned(product(self.direction(bodies[0], c), moved), product(self.direction(bodies[0], b), moved))

    def _joint(self, name, kind, bodies, at, axis, axis_b=None, length=None):
        axes = [[Decimal(int(i == j)) for j in range(self.dim)] for i in range(self.dim)]
        fixed = lambda u: self.direction(bodies[0], u)
        moved = lambda u: self.direction(bodies[1], u)
        apart = self._apart(bodies, at)
        along = lambda u: plain(product(fixed(u), apart))
        dots = lambda u, v: plain(product(fixed(u), moved(v)))
        across = self._perpendicular(axis) if axis else None
        if kind in ("fixed", "revolute", "spherical", "universal"):
            for u in axes:
                self._hold(name, along(u), Decimal(0))
        if kind in ("prismatic", "pin-in-slot", "point-on-line", "cylindrical"):
            for u in across:
                self._hold(name, along(u), Decimal(0))
        if kind in ("planar", "point-on-plane"):
            self._hold(name, along(axis), Decimal(0))
        if self.dim == 3 and kind in ("revolute", "prismatic", "cylindrical", "planar"):
            for u in across:
                self._hold(name, dots(u, axis), Decimal(0))
            if kind == "prismatic":
                self._hold(name, dots(*across), Decimal(0))
        if kind in ("fixed", "orientation") or (kind == "prismatic" and self.dim == 2):
            for i in range(1 if self.dim == 2 else 3):
                self._hold(name, dots(axes[i], axes[(i + 1) % self.dim]), Decimal(0))
        if kind == "universal":
            self._hold(name, dots(axis, axis_b))
        if kind == "distance":
            self._hold(name, distance(product(apart, apart)), length)
        if kind in ("revolute", "cylindrical"):
            self.coordinate[name] = self.angle_between(bodies, axis)
        if kind in ("prismatic", "pin-in-slot", "point-on-line"):
            self.coordinate[name] = along(unit(axis))

    def _joints(self):
        for joint in self.model.get("joints", []):
            if self.here(joint) and joint["type"] not in COUPLINGS:
                at = joint.get("at", [Decimal(0)] * self.dim)  # of no account where it is absent
                if isinstance(at, str) or not isinstance(at[0], (list, str)) or self._is_point(at):
                    at = [at, at]
                at = [self.v(p) for p in at]
                bodies = self._carried(joint, at) if "compliance" in joint else joint["bodies"]
                self._joint(joint["name"], joint["type"], bodies, at, self.v(joint["axis"]) if "axis" in joint else None,
                            self.v(joint["axis_b"]) if "axis_b" in joint else None, self.n(joint["length_m"]) if "length_m" in joint else None)
        for joint in self.model.get("joints", []):
            if self.here(joint) and "mass_kg" in joint:
                self._rod(joint["bodies"], [self.v(p) for p in joint["at"]], self.n(joint["mass_kg"]))
        for joint in self.model.get("joints", []):
            if self.here(joint) and joint["type"] in COUPLINGS:
                a, b = (self.coordinate[j] for j in joint["joints"])
                self._hold(joint["name"], geared(a, b, self.n(joint[COUPLINGS[joint["type"]]])))

    def _carried(self, joint, at):
        """A body without mass between the first body and the joint: springs where the joint yields, equations elsewhere."""
        own, name, first = joint["compliance"], f"{joint['name']}.bearing", joint["bodies"][0]
        where = at[0] if "at" in joint else [Decimal(0)] * self.dim if first == "ground" else self.bodies[first].centre
        self._body(name, where, Decimal(0), Decimal(0) if self.dim == 2 else [[Decimal(0)] * 3] * 3)
        e = self._axes(own) if "axis" not in joint else None
        if "axis" in joint:
            last = unit(self.v(joint["axis"]))
            side = self.v(own["axes"]["x"]) if "axes" in own else self._perpendicular(last)[0]
            along = sum(a * b for a, b in zip(side, last))
            side = unit([a - along * b for a, b in zip(side, last)])
            e = [side, last] if self.dim == 2 else [side, cross(last, side), last]
        apart = self._apart([first, name], [where, where])
        measures = [plain(product(self.direction(first, u), apart)) for u in e] + self._turns([first, name], e)
        given = own.get("stiffness_n_per_m", ["rigid"] * self.dim), own.get("stiffness_n_m_per_rad", ["rigid"] * len(e) if self.dim == 3 else "rigid")
        given = [x for many in given for x in (many if isinstance(many, list) else [many])]
        soft = [(m, self.n(k)) for m, k in zip(measures, given) if k != "rigid"]
        self.springs.append(Spring(name, [m for m, _ in soft], [[k if i == j else 0 for j in range(len(soft))] for i, (_, k) in enumerate(soft)],
                                   [None] * len(soft), [0] * len(soft)))
        for measure, k in zip(measures, given):
            if k == "rigid":
                self._hold(name, measure, Decimal(0))
        return [name, joint["bodies"][1]]

    def _is_point(self, at):
        """A list of coordinates, some of which are expressions, and not of two names of points."""
        return all(not isinstance(x, list) for x in at) and not all(x in self.model.get("points", {}) for x in at)

    def _drive(self):
        drive = self.settings["drive"]
        self.driven, self.trim = None, None
        if drive is None:
            return
        position = self.n(drive["position_rad"] if "position_rad" in drive else drive["position_m"])
        self.driven = (self.coordinate[drive["joint"]], position)
        hold = drive.get("hold", "lock")
        if hold != "lock":
            self.trim = next(s for s in self.springs if s.name == hold["trim"])

    # springs ------------------------------------------------------------------------------------------------------------------------------------
    def _ends(self, spring):
        at = spring.get("at")
        if at is None:
            at = [[Decimal(0)] * self.dim if b == "ground" else self.bodies[b].centre for b in spring["bodies"]]
        elif isinstance(at, str) or not isinstance(at[0], (list, str)) or self._is_point(at):
            at = [self.v(at)] * 2
        else:
            at = [self.v(p) for p in at]
        return spring["bodies"], at

    def _springs(self):
        for item in self.model.get("springs", []):
            if self.here(item):
                getattr(self, "_" + item["type"])(item)

    def _one(self, item, measure, k, free, preload):
        rest = self.n(item[free]) if free in item else None
        self.springs.append(Spring(item["name"], [measure], [[k]], [rest], [self.n(item.get(preload, 0))]))

    def _torsion(self, item):
        if "joint" in item:
            measure = self.coordinate[item["joint"]]
        else:
            measure = self.angle_between(item["bodies"], None)
        self._one(item, measure, self.n(item["stiffness_n_m_per_rad"]), "free_angle_rad", "preload_n_m")

    def _axial(self, item):
        apart = self._apart(*self._ends(item))
        self._one(item, distance(product(apart, apart)), self.n(item["stiffness_n_per_m"]), "free_length_m", "preload_n")

    def _bar(self, item):
        bodies, at = self._ends(item)
        apart = self._apart(bodies, at)
        length = exact.root(sum((b - a) ** 2 for a, b in zip(*at)))
        area = self.n(item["area_m2"])
        self._one(item, distance(product(apart, apart)), self.n(item["youngs_modulus_pa"]) * area / length, "", "preload_n")
        self._rod(bodies, at, self.n(item.get("density_kg_per_m3", 0)) * area * length)

    def _rod(self, bodies, at, mass):
        """Uniform and thin, from point to point."""
        ends = [self.point(b, p) for b, p in zip(bodies, at)]
        for end, b, p in zip(ends, bodies, at):  # 1/3 (a a + a b + b b) = 1/6 (a a + b b + (a + b)(a + b))
            self._add_mass(end, mass / 6)
            self._weight(b, p, mass / 2)
        self._add_mass([plus(a, b) for a, b in zip(*ends)], mass / 6)

    def _axes(self, item):
        """Unit vectors of the item's own axes, by Gram and Schmidt, or by turns about x, y and z one after the other."""
        drawn = [[Decimal(int(i == j)) for j in range(self.dim)] for i in range(self.dim)]
        if "axes" not in item:
            return drawn
        own = item["axes"]
        if "angles_rad" in own:
            given = own["angles_rad"] if isinstance(own["angles_rad"], list) else [own["angles_rad"]]
            for k, angle in enumerate(given):
                s, c = exact.sine_cosine(self.n(angle))
                i, j = ((k + 1) % 3, (k + 2) % 3) if self.dim == 3 else (0, 1)
                for e in drawn:
                    e[i], e[j] = c * e[i] - s * e[j], s * e[i] + c * e[j]
            return drawn
        x = unit(self.v(own["x"]))
        if self.dim == 2:
            return [x, [-x[1], x[0]]]
        other = self.v(own.get("y") or own.get("z"))
        along = sum(a * b for a, b in zip(x, other))
        other = unit([b - along * a for a, b in zip(x, other)])
        return [x, other, cross(x, other)] if "y" in own else [x, cross(other, x), other]

    def _bushing(self, item):
        bodies, at = self._ends(item)
        apart = self._apart(bodies, at)
        axes = self._axes(item)
        measures = [plain(product(self.direction(bodies[0], u), apart)) for u in axes]
        if "stiffness_n_m_per_rad" in item or "stiffness_matrix" in item:
            measures += self._turns(bodies, axes)
        n = len(measures)
        if "stiffness_matrix" in item:
            rows = item["stiffness_matrix"]
            k = [[self.n(rows[max(i, j)][min(i, j)]) for j in range(6)] for i in range(6)]
        else:
            listed = lambda m: [self.n(x) for x in (item[m] if isinstance(item.get(m), list) else [item[m]] if m in item else [])]
            diagonal = listed("stiffness_n_per_m") or [Decimal(0)] * self.dim
            diagonal += listed("stiffness_n_m_per_rad")
            k = [[diagonal[i] if i == j else 0 for j in range(n)] for i in range(n)]
        self.springs.append(Spring(item["name"], measures, k, [None] * n, [0] * n))

    def _loads(self):
        """Dead: V = -F . P, or minus moment times angle."""
        for load in self.model.get("loads", []):
            if not self.here(load):
                continue
            if "joint" in load:
                self._pull(load, self.coordinate[load["joint"]], load.get("moment_n_m", load.get("force_n")))
                continue
            if "force_n" in load:
                at = self.v(load["at"]) if "at" in load else self.bodies[load["on"]].centre
                self.forces.append((self.point(load["on"], at), self.v(load["force_n"])))
            if "moment_n_m" in load:
                self._pull(load, self.angle_between(["ground", load["on"]], None), load["moment_n_m"])

    def _pull(self, load, measure, size):
        self.springs.append(Spring(load["name"], [measure], [[Decimal(0)]], [None], [-self.n(size)]))

    # coordinates --------------------------------------------------------------------------------------------------------------------------------
    def drawn(self):
        q = [Decimal(0)] * self.size
        for name, body in self.bodies.items():
            q[body.first:body.first + self.dim] = body.centre
            if body.turns and self.dim == 2:
                q[body.first + 2] = Decimal(1)
            elif body.turns:
                for i in range(3):
                    q[body.first + 3 + 4 * i] = Decimal(1)
        return q

    def rotations(self):
        """That the bodies are rigid: quads that vanish."""
        out, seen = [], set()
        for body in self.bodies.values():
            if not body.turns or body.first in seen:
                continue
            seen.add(body.first)
            if self.dim == 2:
                c, s = body.first + 2, body.first + 3
                out.append(Quad({(c, c): Decimal(1), (s, s): Decimal(1), (CONSTANT, CONSTANT): Decimal(-1)}))
                continue
            entry = lambda i, k, at=body.first + 3: at + 3 * i + k
            for k in range(3):
                for m in range(k, 3):
                    terms = {(entry(i, k), entry(i, m)): Decimal(1) for i in range(3)}
                    if k == m:
                        terms[CONSTANT, CONSTANT] = Decimal(-1)
                    out.append(Quad(terms))
        return out


class _Names(dict):
    def __init__(self, oracle):
        super().__init__(sin=lambda x: exact.sine_cosine(x)[0], cos=lambda x: exact.sine_cosine(x)[1], sqrt=exact.root,
                         pi=exact.PI, deg=exact.PI / 180)
        self.oracle = oracle

    def __missing__(self, name):
        return self.oracle._parameter(name)


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    length = exact.root(sum(x * x for x in a))
    return [x / length for x in a]


def plus(a, b, sign=1):
    out = dict(a)
    for i, x in b.items():
        out[i] = out.get(i, 0) + sign * x
    return out


def minus(a, b):
    return plus(a, b, -1)


def add(*terms):
    out = {}
    for t in terms:
        for k, x in t.items():
            out[k] = out.get(k, 0) + x
    return out

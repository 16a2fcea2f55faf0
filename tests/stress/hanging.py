# SPDX-License-Identifier: GPL-3.0-or-later
"""Long mechanisms under their own weight, and their eigenvalues by counting.

What hangs or stands in a plane at rest as it is drawn (all numbers are multiples of powers of two) has with L = V + mu c, grad L = 0, the matrices
    [ K - x M  A^T ]
    [    A      0  ],   K = grad^2 L,
whose negative pivots are the eigenvalues below x and one for each constraint. In the order of the mechanism it fills in next to nothing, and pivots in fifty digits need no
exchanges. In space, joints being on the vertical, the two planes do not know of each other."""
from decimal import Decimal, localcontext

from exact import binary

DIGITS = 50
G = 9.8125


# exact -----------------------------------------------------------------------------------------------------------------------------------------------------
class Symmetric:
    """Rows of the lower triangle, column -> value."""

    def __init__(self, n):
        self.row = [{} for _ in range(n)]

    def add(self, i, j, x):
        i, j = max(i, j), min(i, j)
        self.row[i][j] = self.row[i].get(j, 0) + x

    def pivots(self, right=None):
        """Of L D L^T; `right` becomes what solves it."""
        rows = [dict(r) for r in self.row]
        below = [[] for _ in rows]
        for i, r in enumerate(rows):
            for j in r:
                if j < i:
                    below[j].append(i)
        d, columns = [], []
        for k, r in enumerate(rows):
            pivot = r.get(k, Decimal(0)) or Decimal("1e-40")
            column = [(i, rows[i][k] / pivot) for i in sorted(set(below[k])) if rows[i].get(k)]
            for at, (i, x) in enumerate(column):
                whole = x * pivot
                for j, y in column[:at + 1]:
                    if j < i and j not in rows[i]:
                        below[j].append(i)
                    rows[i][j] = rows[i].get(j, Decimal(0)) - whole * y
            d.append(pivot)
            columns.append(column)
        if right is not None:
            for k, column in enumerate(columns):
                for i, x in column:
                    right[i] -= x * right[k]
            for k in reversed(range(len(rows))):
                right[k] = right[k] / d[k] - sum((x * right[i] for i, x in columns[k]), Decimal(0))
        return d


class Plane:
    """Bodies (mass, inertia, centre) and, in their order, joints: "revolute" at a place, "distance" between two, with a torsional stiffness."""

    def __init__(self, bodies, joints):
        self.bodies, self.c, self.freedoms = bodies, [], 3 * len(bodies)
        place = {}                  # of a body's coordinates, and of equations, in the order of the mechanism
        self.n = 0
        self.equations = []
        waiting = list(joints)
        springs = []
        for b in range(len(bodies)):
            place[b] = self.n
            self.n += 3
            for joint in [j for j in waiting if all(x is None or x in place for x in j["on"])]:
                waiting.remove(joint)
                for equation in self._equations(joint, place):
                    self.equations.append((self.n, equation))
                    self.n += 1
                if joint.get("k"):
                    springs.append(([place[x] + 2 if x is not None else None for x in joint["on"]], joint["k"]))
        self.freedoms -= len(self.equations)
        self.place = place
        mu = self._forces()
        self.k = Symmetric(self.n)
        for (at, (gradient, hessian)) in self.equations:
            for i, x in gradient.items():
                self.k.add(at, i, x)
            for (i, j), x in hessian.items():
                self.k.add(i, j, mu[at] * x)
        for (a, b), k in springs:
            for i in (a, b):
                if i is not None:
                    self.k.add(i, i, k)
            if a is not None and b is not None:
                self.k.add(a, b, -k)

    def _equations(self, joint, place):
        """(gradient, second derivatives, lower): u . (p_b - p_a), or the distance."""
        arms = [None if b is None else [p - c for p, c in zip(at, self.bodies[b][2])] for b, at in zip(joint["on"], joint["at"])]
        if joint["kind"] == "revolute":
            ways = [((Decimal(1), Decimal(0)), None), ((Decimal(0), Decimal(1)), None)]
        else:
            d = [y - x for x, y in zip(*joint["at"])]
            length = (d[0] * d[0] + d[1] * d[1]).sqrt()
            ways = [((d[0] / length, d[1] / length), length)]
        for u, length in ways:
            gradient, hessian, across = {}, {}, {}
            for sign, b, s in zip((-1, 1), joint["on"], arms):
                if b is None:
                    continue
                at = place[b]
                gradient.update({at: sign * u[0], at + 1: sign * u[1], at + 2: sign * (u[1] * s[0] - u[0] * s[1])})
                hessian[at + 2, at + 2] = -sign * (u[0] * s[0] + u[1] * s[1])
                across.update({at: -sign * u[1], at + 1: sign * u[0], at + 2: sign * (u[0] * s[0] + u[1] * s[1])})
            if length is not None:  # (I - u u^T) / l of what moves across it
                for i in across:
                    for j in across:
                        if j <= i:
                            hessian[i, j] = hessian.get((i, j), 0) + across[i] * across[j] / length
            yield gradient, hessian

    def _forces(self):
        """mu: A^T mu = - grad V, with x = 0 in [I A^T; A 0] [x; mu]."""
        system, right = Symmetric(self.n), [Decimal(0)] * self.n
        for b, (m, _, _) in enumerate(self.bodies):
            for i in range(3):
                system.add(self.place[b] + i, self.place[b] + i, Decimal(1))
            right[self.place[b] + 1] = -m * binary(G)
        for at, (gradient, _) in self.equations:
            for i, x in gradient.items():
                system.add(at, i, x)
        system.pivots(right)
        off = max(abs(right[self.place[b] + i]) for b in range(len(self.bodies)) for i in range(3))
        assert off < Decimal("1e-30") * sum(m for m, _, _ in self.bodies), "not drawn at rest"
        return right

    def below(self, x):
        """How many eigenvalues are."""
        system = Symmetric(self.n)
        for i, row in enumerate(self.k.row):
            system.row[i] = dict(row)
        for b, (m, inertia, _) in enumerate(self.bodies):
            for i, size in enumerate((m, m, inertia)):
                system.add(self.place[b] + i, self.place[b] + i, -x * size)
        return sum(p < 0 for p in system.pivots()) - len(self.equations)


class Hanging:
    """The planes of a model of this family; `free`: motions that nothing resists."""
    CHECKED = 7   # modes, the lowest, and others as far from each other
    STEPS = 10    # of bisection within what is stated

    def __init__(self, model):
        with localcontext() as context:
            context.prec = DIGITS
            self.planes = [Plane(*plane) for plane in _planes(model) if plane[0]]
        self.free = len(model["bodies"]) if any(j["type"] == "spherical" for j in model["joints"]) else 0
        self.asked = []

    def open(self):
        return Decimal(1)

    def _below(self, x):
        return sum(p.below(x) for p in self.planes)

    def judge(self, row, said):
        """Sentences on what is wrong: each mode checked is the one of its number, within its bound."""
        with localcontext() as context:
            context.prec = DIGITS
            unstable = self._below(Decimal("-1e-25"))
            exact = {"freedoms": sum(p.freedoms for p in self.planes) + self.free, "rigid_body_modes": self.free, "unstable_modes": unstable}
            told = {key: said[key] for key in exact}
            if told != exact:
                yield "counts", f"counts {told}, exact {exact}"
                return
            modes = [m for m in said["modes"] if m["kind"] != "rigid_body"]
            every = max(1, len(modes) // self.CHECKED)
            for i in range(0, len(modes), every):
                yield from self._judge_mode(row, i, modes[i])

    def _judge_mode(self, row, i, mode):
        given, bound = binary(mode["omega_squared"]), binary(mode["omega_squared_error"])
        low, high = given - bound, given + bound
        row.modes += 1
        row.determined += 1
        if mode["kind"] != ("unstable" if high < 0 else "flexible"):
            yield "kind", f"mode {i + 1} is called {mode['kind']}, omega^2 {given:.17g} within {bound:.3g}"
        if self._below(low) > i or self._below(high) <= i:
            yield "bound", f"mode {i + 1} ({mode['kind']}): omega^2 is {given:.17g} within {bound:.3g}, exactly there are {self._below(low)} below and {self._below(high)} up to its end"
            return
        for _ in range(self.STEPS):
            middle = (low + high) / 2
            low, high = (low, middle) if self._below(middle) > i else (middle, high)
        error = max(abs(given - low), abs(given - high))
        row.share = max(row.share, error / bound)
        row.error, row.told = max(row.error, error / abs(given)), max(row.told, bound / abs(given))
        row.excess = max(row.excess, bound / abs(given) * 2 ** 53)


def _planes(model):
    """Bodies and joints of what moves along x, and in space of what moves along z."""
    dim = model["dimension"]
    name = {b["name"]: i for i, b in enumerate(model["bodies"])}
    stiff = {s["joint"]: binary(s["stiffness_n_m_per_rad"]) for s in model["springs"]}
    for axis in range(dim - 1):
        bodies = [[binary(b["mass_kg"]), binary(b["inertia_kg_m2"][0] if dim == 3 else b["inertia_kg_m2"]), [binary(x) for x in b["centre"][:2]]] for b in model["bodies"]]
        into, joints = list(range(len(bodies))), []
        for j in model["joints"]:
            on = [name.get(b) for b in j["bodies"]]
            if j["type"] == "revolute" and dim == 3 and j["axis"][2 * (1 - axis)] == 0:  # turns in the other plane alone
                into[on[1]] = on[0] if on[0] is None else into[on[0]]
                continue
            at = [[binary(x) for x in p[:2]] for p in (j["at"] if j["type"] == "distance" else [j["at"]] * 2)]
            joints.append({"kind": "distance" if j["type"] == "distance" else "revolute", "on": on, "at": at, "k": stiff.get(j["name"])})
        yield _joined(bodies, into, joints)


def _joined(bodies, into, joints):
    """Bodies that do not turn against the one before are part of it; those on the ground go."""
    whole, place = [], {}
    for i, (m, inertia, at) in enumerate(bodies):
        if into[i] is None:
            place[i] = None
            continue
        if into[i] == i:
            place[i] = len(whole)
            whole.append([m, inertia, at])
            continue
        place[i] = place[into[i]]
        m0, i0, at0 = whole[place[i]]
        centre = [(m0 * p + m * q) / (m0 + m) for p, q in zip(at0, at)]
        far = sum((p - q) ** 2 for p, q in zip(at0, at))
        whole[place[i]] = [m0 + m, i0 + inertia + far * m0 * m / (m0 + m), centre]
    return whole, [{**j, "on": [None if b is None else place[b] for b in j["on"]]} for j in joints]


# models ----------------------------------------------------------------------------------------------------------------------------------------------------
def _model(dim, bodies, joints, springs=()):
    g = [0.0, -G, 0.0]
    return {"format": "modetune-model/1", "name": "Stress", "dimension": dim, "gravity_m_per_s2": g[:dim], "bodies": bodies, "joints": joints, "springs": list(springs)}


def _binary(rng, low, high, unit=64):
    """A multiple of 1 / unit."""
    return rng.randint(round(low * unit), round(high * unit)) / unit


def _mass(rng, decades):
    return 2.0 ** rng.randint(-round(3.32 * decades), round(3.32 * decades)) * rng.choice([1.0, 1.25, 1.5])


def _at(dim, x, y):
    return [x, y, 0.0][:dim]


def _solid(dim, name, mass, inertia, x, y):
    return {"name": name, "mass_kg": mass, "inertia_kg_m2": [inertia, inertia / 2, inertia] if dim == 3 else inertia, "centre": _at(dim, x, y)}


def chain(rng, far):
    """Links below each other; or above each other, held by torsion springs; in space with joints of one axis, of crossed ones, or spherical."""
    n, dim = round(10 * 15 ** far), rng.choice([2, 2, 3])
    kind = "revolute" if dim == 2 else rng.choice(["revolute", "crossed", "spherical"])
    decades, up = rng.choice([0, 0, 1, 3]), kind != "spherical" and rng.random() < 0.3
    springs, bodies, joints, y = [], [], [], 0.0
    for i in range(n):
        length = _binary(rng, 0.25, 2.0)
        to = y + length if up else y - length
        mass = _mass(rng, decades)
        bodies.append(_solid(dim, f"b{i}", mass, mass * length * length / 16, 0.0, (y + to) / 2))
        axis = {} if dim == 2 or kind == "spherical" else {"axis": [1, 0, 0] if kind == "crossed" and i % 2 else [0, 0, 1]}
        joints.append({"name": f"j{i}", "type": "spherical" if kind == "spherical" else "revolute", "bodies": [f"b{i - 1}" if i else "ground", f"b{i}"], "at": _at(dim, 0.0, y), **axis})
        y = to
    if up or (kind != "spherical" and rng.random() < 0.5):
        above = 0.0
        for i in reversed(range(n)):
            above += bodies[i]["mass_kg"]
            k = 2.0 ** round(20 * rng.random()) if not up else above * 2.0 * 8 * n * n  # well beyond G (weight above) n^2 / 4 links, which it needs
            springs.append({"name": f"s{i}", "type": "torsion", "joint": f"j{i}", "stiffness_n_m_per_rad": k})
    return _model(dim, bodies, joints, springs)


def stack(rng, far):
    """Platforms on two ropes or rods each, that lean to each other or do not, from the platform above: what one does is passed on to the next, turned and with any sign."""
    heavy = rng.random() < 0.6
    n = round(6 * (16 if heavy else 25) ** far)
    lean = rng.choice([0, 0.125, 0.25, 0.375, 0.5, 0.75])
    rod, wide, decades = rng.choice([0.25, 0.375, 1.0]), _binary(rng, 0.25, 1.0), rng.choice([0, 0, 0, 1, 3])
    down, low = rng.choice([0.25, 1.0, 1.5, 2.0]), _binary(rng, -0.25, 0.25)
    inertia, of_rod = 2.0 ** rng.randint(-4, 1), 2.0 ** rng.randint(-8, -3)
    bodies, joints, y = [], [], 0.0
    for i in range(n):
        mass, up = _mass(rng, decades), f"p{i - 1}" if i else "ground"
        top, bottom = y - down, y - down - rod
        centre = bottom - low
        for side, sign in (("a", -1), ("b", 1)):
            a, b = [_at(2, sign * wide * (1 - lean), top), _at(2, sign * wide, bottom)]
            if heavy:
                rods = mass / 8
                bodies.append(_solid(2, f"{side}{i}", rods, rods * of_rod, (a[0] + b[0]) / 2, (a[1] + b[1]) / 2))
                joints += [{"name": f"u{side}{i}", "type": "revolute", "bodies": [up, f"{side}{i}"], "at": a},
                           {"name": f"v{side}{i}", "type": "revolute", "bodies": [f"{side}{i}", f"p{i}"], "at": b}]
            else:
                joints.append({"name": f"r{side}{i}", "type": "distance", "bodies": [up, f"p{i}"], "at": [a, b]})
        bodies.append(_solid(2, f"p{i}", mass, mass * inertia, 0.0, centre))
        y = centre
    return _model(2, bodies, joints)


def swing(rng, far):
    """Two chains of equal links side by side, and a bar between their ends: a loop as long as the mechanism."""
    n, decades, wide = round(4 * 25 ** far), rng.choice([0, 0, 1, 3]), _binary(rng, 0.25, 1.0)
    bodies, joints, y = [], [], 0.0
    for i in range(n):
        length, mass = _binary(rng, 0.25, 2.0), _mass(rng, decades)
        for side, x in (("a", -wide), ("b", wide)):
            bodies.append(_solid(2, f"{side}{i}", mass, mass * length * length / 16, x, y - length / 2))
            joints.append({"name": f"j{side}{i}", "type": "revolute", "bodies": [f"{side}{i - 1}" if i else "ground", f"{side}{i}"], "at": [x, y]})
        y -= length
    mass = _mass(rng, decades)
    bodies.append(_solid(2, "bar", mass, mass * wide * wide / 4, 0.0, y))
    joints += [{"name": f"e{side}", "type": "revolute", "bodies": [f"{side}{n - 1}", "bar"], "at": [x, y]} for side, x in (("a", -wide), ("b", wide))]
    return _model(2, bodies, joints)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Random mechanisms. Every number has few digits, so that what the file says is what the oracle computes with."""
import copy
from decimal import Decimal

from oracle import Refused

JOINTS = {2: ["revolute", "revolute", "prismatic", "pin-in-slot", "distance", "fixed", "orientation"],
          3: ["revolute", "revolute", "spherical", "prismatic", "cylindrical", "universal", "planar", "point-on-line", "distance", "fixed",
              "point-on-plane", "orientation"]}
ANGLED, SLIDING = ("revolute", "cylindrical"), ("prismatic", "pin-in-slot", "point-on-line")
PYTHAGOREAN = [(0.6, 0.8), (0.8, 0.6), (0.28, 0.96), (0.96, 0.28), (0.352, 0.936), (0.5376, 0.8432)]


class Maker:
    def __init__(self, rng, dim, decades=1.0, name="", masses=None):
        self.rng, self.dim, self.decades, self.masses = rng, dim, decades, masses or decades
        self.step = rng.choice([16, 16, 100])  # points on a grid of 1/16 m, exact in binary, or of 1 cm
        self.scale = 1.0
        self.model = {"format": "modetune-model/1", "name": name, "dimension": dim, "parameters": {}, "bodies": [], "joints": [], "springs": []}
        self.points = {}

    # numbers ------------------------------------------------------------------------------------------------------------------------------------
    def size(self, low, high, decades=None):
        """Evenly over the decades, three digits; `decades` stretches the range about its middle."""
        middle, reach = (low * high) ** 0.5, (high / low) ** (0.5 * (decades or self.decades))
        return float(f"{middle * reach ** self.rng.uniform(-1, 1):.3g}")

    def grid(self, reach=1.0):
        return self.rng.randint(-int(reach * self.step), int(reach * self.step)) / self.step

    def point(self, near=None, reach=1.0):
        near = near or [0.0] * self.dim
        return [float(Decimal(repr(a)) + Decimal(repr(self.grid(reach)))) for a in near]

    def axis(self):
        if self.dim == 2:
            return self.rng.choice([[1, 0], [0, 1], [0.6, 0.8], [1, 1], [-0.8, 0.6], [2, 1], [5, -3]])
        if self.rng.random() < 0.6:
            k = self.rng.randrange(3)
            return [int(i == k) for i in range(3)]
        while True:
            a = [self.rng.randint(-2, 2) for _ in range(3)]
            if any(a):
                return a

    def chance(self, p):
        return self.rng.random() < p

    def parameter(self, prefix, value, unit):
        """A name for a number, most of the time."""
        if isinstance(value, str) or not self.chance(0.7):
            return value
        name = f"{prefix}_{len(self.model['parameters']) + 1}"
        self.model["parameters"][name] = {"value": value, "unit": unit}
        return name

    # items --------------------------------------------------------------------------------------------------------------------------------------
    def body(self, centre, point_mass=False):
        name = f"b{len(self.model['bodies'])}"
        item = {"name": name, "mass_kg": self.parameter("m", self.size(0.1, 10, self.masses), "kg"), "centre": centre}
        if not point_mass and self.dim == 2:
            item["inertia_kg_m2"] = self.parameter("J", self.size(0.01, 1, self.masses), "kg m^2")
        elif not point_mass:
            a, b, c = (self.size(0.01, 1, self.masses) for _ in range(3))  # second moments: any three are those of a body
            item["inertia_kg_m2"] = [round(x, 12) for x in (b + c, a + c, a + b)]
            if self.chance(0.4):
                small = float(f"{0.3 * min(a, b, c):.2g}")
                item["inertia_kg_m2"] += [small, -small, round(small / 2, 12)]
        self.model["bodies"].append(item)
        self.points[name] = centre
        return name

    def turns(self, name):
        return name == "ground" or any(b["name"] == name and "inertia_kg_m2" in b for b in self.model["bodies"])

    def place(self, a, b):
        """Where a joint or spring holds two bodies: near both; at the centre of a point mass."""
        for name in (a, b):
            if not self.turns(name):
                return self.points[name]
        return self.point(self.points.get(b) or self.points.get(a), 0.5)

    def joint(self, a, b, kind=None, at=None):
        kind = kind or self.rng.choice(JOINTS[self.dim])
        if not (self.turns(a) and self.turns(b)):
            kind = "distance"
            if (self.turns(a) or self.turns(b)) and self.chance(0.5):
                kind = "pin-in-slot" if self.dim == 2 else "point-on-line"
            if not self.turns(a):
                a, b = b, a
        name = f"j{len(self.model['joints'])}"
        item = {"name": name, "type": kind, "bodies": [a, b]}
        if kind == "distance":
            item["at"] = self.two_places(a, b)
        elif kind != "orientation":
            item["at"] = at or self.place(a, b)
        if kind in ("prismatic", "pin-in-slot") or (self.dim == 3 and kind not in ("fixed", "spherical", "distance", "orientation")):
            item["axis"] = self.axis()
        if kind == "universal":
            while True:
                other = self.axis()
                if any(x * item["axis"][(i + 1) % 3] - item["axis"][i] * other[(i + 1) % 3] for i, x in enumerate(other)):
                    break
            item["axis_b"] = other
        self.model["joints"].append(item)
        return item

    def two_places(self, a, b):
        for _ in range(100):
            pair = [self.points[n] if not self.turns(n) else self.point(self.points.get(n), 0.5) for n in (a, b)]
            if sum((x - y) ** 2 for x, y in zip(*pair)) > 0.01:
                return pair
        raise Refused("two point masses in one place")

    def spring(self, a, b, kind=None, **more):
        kinds = ["axial", "axial", "bar", "bushing"] + (["torsion"] if self.dim == 2 else [])
        kind = kind or self.rng.choice(kinds)
        if kind in ("torsion", "bushing") and not (self.turns(a) and self.turns(b)):
            kind = "axial"
        item = {"name": f"s{len(self.model['springs'])}", "type": kind, "bodies": [a, b]}
        if kind == "axial":
            item.update(at=self.two_places(a, b), stiffness_n_per_m=self.parameter("k", self.size(1e2, 1e5), "N/m"))
        elif kind == "bar":
            item.update(at=self.two_places(a, b), youngs_modulus_pa=self.size(1e9, 1e11), area_m2=self.parameter("A", self.size(1e-7, 1e-6), "m^2"))
            if self.chance(0.6):
                item["density_kg_per_m3"] = self.size(1e3, 1e4)
        elif kind == "torsion":
            item["stiffness_n_m_per_rad"] = self.parameter("c", self.size(1e1, 1e4), "N m/rad")
        else:
            self._bushing(item, a, b)
        item.update(more)
        self.model["springs"].append(item)
        return item

    def _bushing(self, item, a, b):
        item["at"] = self.place(a, b)
        if self.dim == 3 and self.chance(0.3):
            item["stiffness_matrix"] = self._matrix()
            return
        item["stiffness_n_per_m"] = [self.size(1e2, 1e5) for _ in range(self.dim)]
        turning = [self.size(1e1, 1e4) if self.chance(0.8) else 0 for _ in range(3)]
        item["stiffness_n_m_per_rad"] = turning[0] if self.dim == 2 else turning

    def _matrix(self):
        """Positive definite: that of six springs along and about axes that are not those of space."""
        rows = [[Decimal(0)] * 6 for _ in range(6)]
        for i in range(6):
            k = Decimal(repr(self.size(1e2, 1e4)))
            g = [Decimal(0)] * 6
            g[i] = Decimal(1)
            for j in range(6):
                if j != i and self.chance(0.3):
                    g[j] = Decimal(self.rng.randint(-4, 4)) / 8
            for r in range(6):
                for c in range(6):
                    rows[r][c] += k * g[r] * g[c]
        return [[float(x) for x in row] for row in rows]

    def torsion(self, joint, **more):
        name = joint if isinstance(joint, str) else joint["name"]
        item = {"name": f"s{len(self.model['springs'])}", "type": "torsion", "joint": name,
                "stiffness_n_m_per_rad": self.parameter("c", self.size(1e1, 1e4), "N m/rad"), **more}
        self.model["springs"].append(item)
        return item

    def other(self, name):
        choice = ["ground"] + [b["name"] for b in self.model["bodies"] if b["name"] != name]
        return self.rng.choice(choice)

    # parts --------------------------------------------------------------------------------------------------------------------------------------
    def tree(self, n, tied=0.9, masses=0.15):
        """Bodies each of which hangs on the ground or an earlier one by a joint, a spring, or nothing."""
        for i in range(n):
            name = self.body(self.point(reach=1.5), self.chance(masses))
            parent = "ground" if i == 0 or self.chance(0.25) else f"b{self.rng.randrange(i)}"
            if self.chance(tied):
                self.joint(parent, name)
            elif self.chance(0.7):
                self.spring(parent, name, "bushing")

    def springs(self, count):
        for _ in range(count):
            turning = [j for j in self.model["joints"] if j["type"] in ANGLED]
            if turning and self.chance(0.4):
                self.torsion(self.rng.choice(turning))
            else:
                b = self.rng.choice(self.model["bodies"])["name"]
                self.spring(self.other(b), b)

    def loops(self, count):
        for _ in range(count):
            b = self.rng.choice(self.model["bodies"])["name"]
            self.joint(self.other(b), b, self.rng.choice(["revolute", "distance", "distance", "prismatic", "pin-in-slot" if self.dim == 2 else "point-on-line"]))

    def doubled(self, count):
        """Joints drawn twice: equations that change nothing."""
        for _ in range(count):
            joint = self.rng.choice(self.model["joints"])
            twin = {**copy.deepcopy(joint), "name": f"j{len(self.model['joints'])}"}
            if joint["type"] == "fixed" and all(map(self.turns, joint["bodies"])) and self.chance(0.5):
                twin["at"] = self.point(reach=1.0)
            if joint["type"] in ("prismatic", "cylindrical", "planar", "revolute") and self.dim == 3 and self.chance(0.5) and all(map(self.turns, joint["bodies"])):
                k = self.rng.randint(-3, 3) / 2  # elsewhere on its axis
                twin["at"] = [float(Decimal(repr(a)) + Decimal(repr(k)) * Decimal(repr(u))) for a, u in zip(joint["at"], joint["axis"])]
            self.model["joints"].append(twin)

    def stand(self):
        """Every body on a soft foot: nothing falls, and loads move it a little."""
        for item in self.model["bodies"]:
            mass = item["mass_kg"]
            mass = self.model["parameters"][mass]["value"] if isinstance(mass, str) else mass
            soft = lambda: float(f"{mass * 9.81 / self.size(0.003, 0.05, 1.0):.3g}")
            name, at = item["name"], item["centre"]
            if "inertia_kg_m2" in item:
                self.model["springs"].append({"name": f"f{name}", "type": "bushing", "bodies": ["ground", name], "at": at,
                                              "stiffness_n_per_m": [soft() for _ in range(self.dim)],
                                              "stiffness_n_m_per_rad": soft() if self.dim == 2 else [soft() for _ in range(3)]})
                continue
            for k in range(self.dim):
                anchor = [float(Decimal(repr(x)) + int(i == k)) for i, x in enumerate(at)]
                self.model["springs"].append({"name": f"f{name}{k}", "type": "axial", "bodies": ["ground", name], "at": [anchor, at], "stiffness_n_per_m": soft()})

    def gravity(self):
        g = self.rng.choice([9.81, 9.81, 1.62, 3.0])
        k = self.rng.randrange(self.dim) if self.chance(0.3) else 1
        self.model["gravity_m_per_s2"] = [(-g if i == k else 0) for i in range(self.dim)]

    def preloads(self, p=0.5):
        """Springs under tension, springs that are drawn stretched or turned."""
        for s in self.model["springs"]:
            if s["type"] == "bushing" or not self.chance(p):
                continue
            if s["type"] == "torsion":
                k = s["stiffness_n_m_per_rad"]
                k = self.model["parameters"][k]["value"] if isinstance(k, str) else k
                if self.chance(0.5):
                    s["free_angle_rad"] = self.rng.randint(-8, 8) / 100
                else:
                    s["preload_n_m"] = float(f"{k * self.rng.uniform(-0.08, 0.08):.3g}")
            elif s["type"] == "axial":
                k = s["stiffness_n_per_m"]
                k = self.model["parameters"][k]["value"] if isinstance(k, str) else k
                length = sum((x - y) ** 2 for x, y in zip(*s["at"])) ** 0.5
                if self.chance(0.5):
                    s["free_length_m"] = float(f"{length * self.rng.uniform(0.9, 1.1):.3g}")
                else:
                    s["preload_n"] = float(f"{k * length * self.rng.uniform(-0.05, 0.08):.3g}")
            else:
                s["preload_n"] = float(f"{self.rng.uniform(-50, 200):.3g}")

    def lengths(self, p=0.3):
        """Some coordinates and loads become parameters."""
        for item in self.model["joints"] + self.model["springs"]:
            for member, unit in (("at", "m"), ("preload_n", "N"), ("preload_n_m", "N m"), ("free_angle_rad", "rad"), ("free_length_m", "m")):
                if member not in item or not self.chance(p):
                    continue
                value = item[member]
                if member != "at":
                    item[member] = self.parameter("p", value, unit)
                elif all(map(self.turns, item["bodies"])):
                    at = self.rng.choice(value) if isinstance(value[0], list) else value
                    k = self.rng.randrange(self.dim)
                    at[k] = self.parameter("x", at[k], "m")
            if "axis" in item and self.dim == 3 and self.chance(0.3 * p):
                axis = list(item["axis"])
                k = self.rng.randrange(3)
                axis[k] = self.parameter("t", axis[k], "1")
                item["axis"] = axis
        if "gravity_m_per_s2" in self.model and self.chance(p):
            self.model["gravity_m_per_s2"] = [self.parameter("g", x, "m/s^2") if x else 0 for x in self.model["gravity_m_per_s2"]]

    def gears(self, count):
        for _ in range(count):
            turning = [j["name"] for j in self.model["joints"] if j["type"] == "revolute"]
            sliding = [j["name"] for j in self.model["joints"] if j["type"] in SLIDING]
            name, ratio = f"j{len(self.model['joints'])}", self.rng.choice([-3, -2.5, -1, -0.5, 0.4, 1, 2, 4])
            if turning and sliding and self.chance(0.5):
                self.model["joints"].append({"name": name, "type": "rack", "joints": [self.rng.choice(turning), self.rng.choice(sliding)],
                                             "ratio_m_per_rad": self.parameter("r", ratio / 8, "m")})
            elif len(turning) > 1:
                self.model["joints"].append({"name": name, "type": "gear", "joints": self.rng.sample(turning, 2), "ratio": self.parameter("r", ratio, "1")})

    def pulls(self, count):
        """Dead loads."""
        loads = []
        for i in range(count):
            body = self.rng.choice(self.model["bodies"])
            joints = [j for j in self.model["joints"] if j["type"] in ANGLED + SLIDING]
            item = {"name": f"p{i}"}
            if joints and self.chance(0.3):
                joint = self.rng.choice(joints)
                item["joint"] = joint["name"]
                item["moment_n_m" if joint["type"] in ANGLED else "force_n"] = self.parameter("F", self.size(0.3, 3), "N m" if joint["type"] in ANGLED else "N")
            else:
                item.update(on=body["name"], force_n=[self.size(0.3, 30) * self.rng.choice([1, -1, 0]) for _ in range(self.dim)])
                if self.turns(body["name"]) and self.chance(0.7):
                    item["at"] = self.point(body["centre"], 0.5)
                if self.turns(body["name"]) and self.dim == 2 and self.chance(0.3):
                    item["moment_n_m"] = self.parameter("F", self.size(0.1, 1), "N m")
            loads.append(item)
        if loads:
            self.model["loads"] = loads

    def done(self):
        self.model = copy.deepcopy(self.model)  # nothing is shared
        if self.chance(0.4):
            self.lengths()
        for key in ("joints", "springs", "parameters"):
            if not self.model[key]:
                del self.model[key]
        return self.model


def _unloaded(rng, dim):
    m = Maker(rng, dim, name="Bodies, joints and springs without load")
    m.tree(rng.randint(1, 5 if dim == 2 else 3))
    m.springs(rng.randint(1, 5))
    if m.chance(0.3):
        m.loops(rng.randint(1, 2))
    if m.chance(0.3):
        m.gears(1)
    return m.done()


def _redundant(rng, dim):
    m = Maker(rng, dim, name="Joints drawn twice")
    m.tree(rng.randint(1, 4 if dim == 2 else 3), tied=1.0)
    m.springs(rng.randint(1, 5))
    if m.chance(0.3):
        m.loops(1)
    m.doubled(rng.randint(1, 3))
    return m.done()


def _loaded(rng, dim):
    m = Maker(rng, dim, name="Bodies on soft feet under gravity and preload")
    m.tree(rng.randint(1, 4 if dim == 2 else 3))
    m.springs(rng.randint(0, 4))
    if m.chance(0.3):
        m.loops(1)
    if m.chance(0.2) and m.model["joints"]:
        m.doubled(1)
    if m.chance(0.2):
        m.gears(1)
    if m.chance(0.4):
        m.pulls(rng.randint(1, 2))
    if m.chance(0.8):
        m.gravity()
    m.preloads()
    m.stand()
    return m.done()


def _decades(rng, dim):
    m = Maker(rng, dim, decades=rng.choice([2, 3, 4]), name="Masses and stiffnesses over many decades")
    m.tree(rng.randint(1, 4 if dim == 2 else 3))
    m.springs(rng.randint(1, 5))
    if m.chance(0.3):
        m.loops(1)
    return m.done()


def _stiff(rng, dim):
    """Springs of any stiffness beside soft feet, a little load: what is soft must not drown in what is stiff."""
    m = Maker(rng, dim, decades=rng.choice([2, 3, 4]), name="Stiff springs under load", masses=1.0)
    m.tree(rng.randint(1, 4 if dim == 2 else 3))
    m.springs(rng.randint(1, 5))
    m.stand()
    if m.chance(0.7):
        m.gravity()
    for spring in m.model["springs"]:
        if spring["type"] in ("axial", "bar") and m.chance(0.4):
            spring["preload_n"] = m.parameter("p", float(f"{rng.uniform(-2, 8):.3g}"), "N")
    return m.done()


def _blocked(rng, dim):
    """Springs of every type along what a joint leaves and what it blocks."""
    m = Maker(rng, dim, name="Springs against joints")
    m.tree(rng.randint(1, 4 if dim == 2 else 3), tied=1.0, masses=0.0)
    for joint in list(m.model["joints"]):
        if m.chance(0.8):
            at = joint["at"][1] if joint["type"] == "distance" else joint.get("at") or m.point()
            m.spring(*joint["bodies"], "bushing", at=at)
        if m.chance(0.4):
            m.spring(*joint["bodies"])
        if joint["type"] in ANGLED and m.chance(0.5):
            m.torsion(joint)
    if m.chance(0.3):
        m.doubled(1)
    if m.chance(0.3):
        m.loops(rng.randint(1, 2))
    return m.done()


def _driven(rng, dim):
    m = Maker(rng, dim, name="A driven joint")
    m.tree(rng.randint(1, 4 if dim == 2 else 2), tied=1.0, masses=0.0)
    able = [j for j in m.model["joints"] if j["type"] in ANGLED + SLIDING]
    if not able:
        able = [m.joint("ground", m.body(m.point()), "revolute")]
    m.springs(rng.randint(0, 3))
    joint = rng.choice(able)
    turning = joint["type"] in ANGLED
    servo = m.torsion(joint) if turning and m.chance(0.6) else None
    if m.chance(0.5):
        m.gravity()
        m.preloads(0.3)
    m.stand()
    drive = {"joint": joint["name"], "position_rad" if turning else "position_m": rng.randint(-40, 40) / 100 if turning else rng.randint(-20, 20) / 100}
    if servo and m.chance(0.5):
        drive["hold"] = {"trim": servo["name"]}
        for member in ("preload_n_m", "free_angle_rad"):
            servo.pop(member, None)
    m.model["configurations"] = {"driven": {"drive": drive}}
    return m.done()


def hanging(rng):
    """Bodies below each other on pins, drawn where they hang or some degrees beside."""
    m = Maker(rng, 2, name="Hanging bodies")
    n = rng.randint(1, 5)
    at, previous = [0.0, 0.0], "ground"
    straight = m.chance(0.5)
    for i in range(n):
        across, down = (0, 1) if straight or m.chance(0.3) else (rng.randint(-4, 4) / 16, 1)
        length = rng.randint(2, 12) / 16
        step = [across * length, -down * length]
        centre = [a + s / 2 for a, s in zip(at, step)]
        name = m.body(centre)
        joint = m.joint(previous, name, "revolute", at)
        if m.chance(0.3):
            m.torsion(joint)
        at, previous = [a + s for a, s in zip(at, step)], name
    m.model["gravity_m_per_s2"] = [0, -9.81]
    return m.done()


def chains(rng):
    """Links of rigid elements, hinged and sprung, with bodies at their ends."""
    m = Maker(rng, 2, name="Links of rigid elements")
    links = []
    for i in range(rng.randint(1, 2)):
        start = links[-1]["to"] if links else m.point()
        end = m.point(start)
        if start == end:
            end = [start[0] + 0.5, start[1]]
        n = rng.randint(1, 4)
        one = m.parameter("k", m.size(1e2, 1e5), "N m/rad")
        links.append({"name": f"L{i}", "from": start, "to": end, "elements": n, "mass_kg": m.parameter("m", m.size(0.1, 10), "kg")})
        if n > 1:
            links[-1]["stiffness_n_m_per_rad"] = one if m.chance(0.5) else [one] + [m.size(1e2, 1e5) for _ in range(n - 2)]
        if i or m.chance(0.6):
            m.model["joints"].append({"name": f"j{i}", "type": rng.choice(["revolute", "fixed"]), "bodies": [f"L{i - 1}.end" if i else "ground", f"L{i}.start"], "at": start})
    m.model["links"] = links
    last = links[-1]
    tip = m.body(last["to"])
    m.model["joints"].append({"name": "tip", "type": rng.choice(["revolute", "fixed"]), "bodies": [f"L{len(links) - 1}.end", tip], "at": last["to"]})
    m.springs(rng.randint(0, 2))
    if m.chance(0.5):
        m.stand()
        m.model["springs"][-1]["stiffness_n_m_per_rad"] = 400.0
        if links and all(j["bodies"][0] != "ground" for j in m.model["joints"]):
            m.model["joints"].append({"name": "root", "type": "fixed", "bodies": ["ground", "L0.start"], "at": links[0]["from"]})
        if m.chance(0.6):
            m.gravity()
    return m.done()


def _own_axes(m):
    """Vectors that are not of unit length nor at right angles, or angles; some of the numbers are parameters."""
    if m.chance(0.5):
        angles = [m.parameter("a", m.rng.randint(-30, 30) / 10, "rad") for _ in range(3 if m.dim == 3 else 1)]
        return {"angles_rad": angles if m.dim == 3 or m.chance(0.5) else angles[0]}
    if m.dim == 2:
        return {"x": m.axis()}
    while True:
        x, other = ([m.rng.randint(-3, 3) for _ in range(3)] for _ in range(2))
        if any(x[i] * other[(i + 1) % 3] - x[(i + 1) % 3] * other[i] for i in range(3)):
            break
    k = m.rng.randrange(3)
    x[k] = m.parameter("t", x[k], "1")
    return {"x": x, m.rng.choice("yz"): other}


def _axes(rng, dim):
    """Bushings and bodies with axes of their own, at rest or loaded."""
    m = Maker(rng, dim, name="Axes of their own")
    m.tree(rng.randint(1, 3), tied=0.6, masses=0.1)
    m.spring("ground", m.body(m.point()), "bushing")
    m.springs(rng.randint(0, 2))
    if m.chance(0.5):
        m.gravity()
        m.preloads(0.3)
        m.stand()
    for item in m.model["springs"] + (m.model["bodies"] if dim == 3 else []):
        if item.get("type") == "bushing" or (m.chance(0.5) and "inertia_kg_m2" in item):
            item["axes"] = _own_axes(m)
    return m.done()


HELD = {2: {"fixed": (0, 1, 2), "revolute": (0, 1), "prismatic": (0, 2), "pin-in-slot": (0,), "orientation": (2,)},
        3: {"fixed": range(6), "revolute": range(5), "prismatic": (0, 1, 3, 4, 5), "cylindrical": (0, 1, 3, 4), "spherical": range(3),
            "universal": range(3), "planar": (2, 3, 4), "point-on-line": (0, 1), "point-on-plane": (2,), "orientation": (3, 4, 5)}}


def _yield(m, joint):
    """A compliance along some of what the joint holds."""
    held = list(HELD[m.dim].get(joint["type"], ()))
    soft = [k for k in held if m.chance(0.6)] or held[:1]
    if not soft or not m.turns(joint["bodies"][0]):
        return
    n = m.dim
    numbers = [("rigid" if k not in soft else m.parameter("k", m.size(1e3, 1e6), "N/m") if k < n else m.parameter("c", m.size(1e2, 1e5), "N m/rad"))
               for k in range(6 if n == 3 else 3)]
    own = {"stiffness_n_per_m": numbers[:n], "stiffness_n_m_per_rad": numbers[n:] if n == 3 else numbers[n]}
    for member in list(own):
        if all(x == "rigid" for x in (own[member] if isinstance(own[member], list) else [own[member]])):
            del own[member]
    if "axis" not in joint:
        if m.chance(0.5):
            own["axes"] = _own_axes(m)
    elif n == 3:
        while True:
            own["axes"] = {"x": [m.rng.randint(-3, 3) for _ in range(3)]}
            if any(own["axes"]["x"][i] * joint["axis"][(i + 1) % 3] - own["axes"]["x"][(i + 1) % 3] * joint["axis"][i] for i in range(3)):
                break
    joint["compliance"] = own


def _yielding(rng, dim):
    """Joints that yield, at rest, loaded or driven."""
    if rng.random() < 0.3:
        m = Maker(rng, dim)
        m.model = _driven(rng, dim)
        m.model.setdefault("parameters", {})
        m.model.setdefault("springs", [])
    else:
        m = Maker(rng, dim)
        m.tree(rng.randint(1, 3), tied=1.0, masses=0.1)
        m.springs(rng.randint(1, 3))
        if m.chance(0.3):
            m.gears(1)
        if m.chance(0.5):
            m.gravity()
            m.preloads(0.3)
            m.stand()
    m.model["name"] = "Joints that yield"
    for joint in m.model["joints"]:
        if m.chance(0.7) and not any(isinstance(x, str) for x in joint.get("axis", [])):
            _yield(m, joint)
    return m.done()


def _of(maker, dim):
    return lambda rng: maker(rng, dim)


def _rods(rng, dim):
    """Thin rods with mass between bodies on soft feet, all in gravity."""
    m = Maker(rng, dim, name="Rods with mass")
    m.tree(rng.randint(1, 3), tied=0.3, masses=0.4)
    for _ in range(rng.randint(1, 3)):
        b = rng.choice(m.model["bodies"])["name"]
        m.joint(m.other(b), b, "distance")
    for joint in m.model["joints"]:
        if joint["type"] == "distance":
            joint["mass_kg"] = m.parameter("m", m.size(0.05, 2), "kg")
    m.stand()
    m.gravity()
    return m.done()


KINDS = {}
for _name, _maker in (("free", _unloaded), ("redundant", _redundant), ("loaded", _loaded), ("decades", _decades), ("stiff", _stiff), ("blocked", _blocked), ("driven", _driven)):
    KINDS[f"{_name}2"] = _of(_maker, 2)
    KINDS[f"{_name}3"] = _of(_maker, 3)
KINDS["axes2"] = _of(_axes, 2)
KINDS["axes3"] = _of(_axes, 3)
KINDS["yielding2"] = _of(_yielding, 2)
KINDS["yielding3"] = _of(_yielding, 3)
KINDS["rods2"] = _of(_rods, 2)
KINDS["rods3"] = _of(_rods, 3)
KINDS["hanging"] = hanging
KINDS["chains"] = chains

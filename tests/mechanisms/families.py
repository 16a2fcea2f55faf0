# SPDX-License-Identifier: GPL-3.0-or-later
"""Mechanisms with a structure that chance does not find: loops that move, dead centres, rest in any position, trusses on a grid."""
from changes import CHANGES, short
from exact import number
from makers import ANGLED, KINDS, Maker

PAIRS = [(0.3, 0.4), (0.4, 0.3), (0.6, 0.8), (0.8, 0.6), (0.5, 1.2), (1.2, 0.5), (0.28, 0.96), (0.75, 1.0)]


def _add(a, b, factor=1):
    return [short(number(x) + factor * number(y)) for x, y in zip(a, b)]


def _middle(a, b):
    return [short((number(x) + number(y)) / 2) for x, y in zip(a, b)]


def _turned(rng, model):
    """Anywhere in space, where the numbers allow."""
    if rng.random() < 0.6:
        return model
    moved = CHANGES["place"](rng, model)
    return model if moved is None else moved[0]


def _loop(m, corners, kind="revolute"):
    """Bodies along the sides of a polygon on the ground: pins at the corners."""
    rng, dim = m.rng, m.dim
    lift = lambda p: p if dim == 2 else [p[0], p[1], 0.0]
    previous, joints = "ground", []
    for i in range(len(corners) - 1):
        name = m.body(lift(_middle(corners[i], corners[i + 1])) if rng.random() < 0.7 else m.point(lift(corners[i]), 0.5))
        joints.append(m.joint(previous, name, kind, lift(corners[i])))
        previous = name
    joints.append(m.joint(previous, "ground", kind, lift(corners[-1])))
    for joint in joints:
        if dim == 3:
            joint["axis"] = [0, 0, rng.choice([1, 1, 2, -1])]
    return joints


def _load(m, joints, tensions=True):
    turning = [j for j in joints if j["type"] in ANGLED]
    for joint in m.rng.sample(turning, m.rng.randint(1, min(2, len(turning)))):
        m.torsion(joint)
    if m.chance(0.5):
        b = m.rng.choice(m.model["bodies"])["name"]
        m.spring("ground", b, m.rng.choice(["axial", "bar"]))
    if m.chance(0.6):
        for spring in m.model["springs"]:  # stiff enough to stay near the drawing
            if spring["type"] == "torsion":
                spring["stiffness_n_m_per_rad"] = m.parameter("c", m.size(3e2, 3e4), "N m/rad")
        m.gravity()
        if tensions and m.chance(0.5):
            m.preloads(0.4)


def four_bar(rng, dim):
    """A closed loop of three bodies with one freedom; in space three of its equations change nothing."""
    m = Maker(rng, dim, name="Four-bar")
    a, b, c = ([s * x for s, x in zip((1, rng.choice([1, 1, -1])), rng.choice(PAIRS))] for _ in range(3))
    start = [0.0, 0.0]
    one = _add(start, a)
    two = _add(one, [abs(b[0]), b[1]])
    joints = _loop(m, [start, one, two, _add(two, [abs(c[0]), -abs(c[1])])])
    if dim == 3 and m.chance(0.3):
        for joint, kind in zip(joints[1:3], ("spherical", "universal" if m.chance(0.3) else "cylindrical")):
            joint["type"] = kind
            if kind == "spherical":
                joint.pop("axis", None)
            if kind == "universal":
                joint["axis"], joint["axis_b"] = [0, 0, 1], [1, 0, 0]
    _load(m, joints)
    limit = abs(b[1] * abs(c[0]) + abs(c[1]) * abs(b[0])) < 1e-9  # coupler and rocker in one line: the crank stands still
    if m.chance(0.3) and joints[0]["type"] in ANGLED and not limit:
        drive = {"joint": joints[0]["name"], "position_rad": m.parameter("q", rng.randint(-20, 20) / 100, "rad")}
        servo = next((s for s in m.model["springs"] if s.get("joint") in [j["name"] for j in joints]), None)
        if servo and m.chance(0.5):
            drive["hold"] = {"trim": servo["name"]}
        m.model["configurations"] = {"driven": {"drive": drive}}
    return _turned(rng, m.done())


def parallel_cranks(rng, dim):
    """Three or four equal cranks under one coupler: redundant in every position."""
    m = Maker(rng, dim, name="Parallel cranks")
    lift = lambda p: p if dim == 2 else [p[0], p[1], 0.0]
    crank = [x * rng.choice([1, -1]) for x in rng.choice(PAIRS)]
    feet = [[x / 4, rng.choice([0.0, 0.125])] for x in rng.sample(range(-6, 7), rng.randint(2, 4))]
    coupler = m.body(lift(_add(m.point()[:2], crank)))
    joints = []
    for foot in feet:
        tip = _add(foot, crank)
        if m.chance(0.4) and len(joints) >= 2 and dim == 2:
            item = m.joint("ground", coupler, "distance")
            item["at"] = [lift(foot), lift(tip)]
            continue
        name = m.body(lift(_middle(foot, tip)))
        joints += [m.joint("ground", name, "revolute", lift(foot)), m.joint(name, coupler, "revolute", lift(tip))]
    for joint in joints:
        if dim == 3:
            joint["axis"] = [0, 0, 1]
    _load(m, joints, tensions=False)
    return _turned(rng, m.done())


def dead(rng, dim):
    """Positions where joints depend on each other at this very place only."""
    m = Maker(rng, dim, name="Dead centre")
    lift = lambda p: p if dim == 2 else [p[0], p[1], 0.0]
    kind = rng.choice(["ropes", "flat", "stretched"])
    along = rng.choice([(1.0, 0.0), (0.0, 1.0), (0.6, 0.8), (0.96, 0.28)])
    on = lambda s: lift([short(number(s) * number(x)) for x in along])
    if kind == "ropes":  # a bead between two ropes in one line
        name = m.body(on(0.0), point_mass=True)
        for s in (-rng.randint(1, 4) / 4, rng.randint(1, 4) / 4):
            m.model["joints"].append({"name": f"j{s}".replace("-", "m").replace(".", "_"), "type": "distance", "bodies": ["ground", name], "at": [on(s), on(0.0)]})
        m.spring("ground", name, "axial")
        m.spring("ground", name, "axial")
    elif kind == "flat":  # a parallelogram folded into a line
        a, b = rng.randint(1, 4) / 4, rng.randint(5, 8) / 4
        joints = _loop(m, [on(0.0)[:2], on(a)[:2], on(a + b)[:2], on(b)[:2]])
        _load_none(m, joints)
    else:  # crank, coupler and rocker in one line with the feet
        a, b, c = (rng.randint(1, 4) / 4 for _ in range(3))
        joints = _loop(m, [on(0.0)[:2], on(a)[:2], on(a + b)[:2], on(a + b + c)[:2]])
        _load_none(m, joints)
    return _turned(rng, m.done())


def _load_none(m, joints):
    for joint in joints:
        if m.chance(0.6) and joint["type"] in ANGLED:
            m.torsion(joint)


def tilted(rng, dim):
    """Closed loops and doubled hinges whose axes are parameters: where a tilt jams them, there is no derivative."""
    m = Maker(rng, dim, name="Tilted hinges")
    if m.chance(0.5):
        a, b, c = (rng.choice(PAIRS) for _ in range(3))
        one = _add([0.0, 0.0], a)
        two = _add(one, b)
        joints = _loop(m, [[0.0, 0.0], one, two, _add(two, [c[0], -c[1]])])
    else:
        joints = [m.joint("ground", m.body(m.point()), "revolute")]
        m.tree(rng.randint(0, 1), tied=1.0, masses=0.0)
        if m.chance(0.7):
            m.doubled(1)
    for joint in joints:
        m.torsion(joint, stiffness_n_m_per_rad=m.parameter("c", m.size(1e3, 1e5), "N m/rad"))
    joint = rng.choice(m.model["joints"])
    m.model["parameters"] = {k: v for k, v in m.model["parameters"].items() if k[0] != "t"}
    if "axis" in joint:
        k = rng.randrange(3)
        m.model["parameters"]["tilt"] = {"value": joint["axis"][k], "unit": "1"}
        joint["axis"] = [("tilt" if i == k else x) for i, x in enumerate(joint["axis"])]
    if m.chance(0.4) and len(joints) == len(m.model["joints"]):
        m.gravity()
    return m.done()


def taut(rng, dim):
    """Beads on strings in one line, in tension; some strings under pressure beside them."""
    m = Maker(rng, dim, name="Beads on strings")
    n, k = rng.randint(1, 8), m.size(1e3, 1e9)
    span = [[s * x for x in (1.0, 0.0, 0.0)[:dim]] for s in range(n + 2)]
    tension = m.parameter("T", m.size(5, 500), "N")
    for at in span[1:-1]:
        m.body(at, point_mass=True)
    name = lambda i: f"b{i - 1}" if 0 < i < n + 1 else "ground"
    for i in range(n + 1):
        m.model["springs"].append({"name": f"s{i}", "type": "axial", "bodies": [name(i), name(i + 1)], "at": [span[i], span[i + 1]], "stiffness_n_per_m": k, "preload_n": tension})
    if m.chance(0.5):  # some of it pushed, less than all is pulled
        m.model["springs"].append({"name": "push", "type": "axial", "bodies": ["ground", name(n)], "at": [span[0], span[n]], "stiffness_n_per_m": m.size(1e2, 1e5)})
    return _turned(rng, m.done())


def neutral(rng, dim):
    """Loads that balance in every position: what is left after cancellation is nothing."""
    m = Maker(rng, dim, name="Balanced")
    g = m.rng.choice([9.81, 10, 1.62])
    kind = rng.choice(["centre", "counterweight", "spring", "counterweight", "spin" if dim == 3 else "spring"])
    lift = lambda p: p if dim == 2 else [p[0], p[1], 0.0]
    m.model["gravity_m_per_s2"] = lift([0, -g])
    axis = {} if dim == 2 else {"axis": [0, 0, 1]}
    length = rng.randint(1, 8) / 8
    way = rng.choice([(1.0, 0.0), (0.0, 1.0), (0.6, 0.8), (-0.8, 0.6), (0.28, -0.96)])
    on = lambda s: lift([short(number(s) * number(x)) for x in way])
    pin = lambda name: m.model["joints"].append({"name": f"j{len(m.model['joints'])}", "type": "revolute", "bodies": ["ground", name], "at": on(0.0), **axis})
    if kind == "centre":
        pin(m.body(on(0.0)))
    elif kind == "spin":  # a top that hangs: turns about the vertical
        name = m.body([0.0, -length, 0.0])
        m.model["bodies"][-1]["inertia_kg_m2"] = [m.size(0.01, 1)] * 3
        m.model["joints"].append({"name": "j0", "type": "spherical", "bodies": ["ground", name], "at": [0.0, 0.0, 0.0]})
    elif kind == "counterweight":
        arm, ratio = m.body(on(length)), rng.choice([0.5, 2, 3, 0.4, 7])
        mass = m.size(0.1, 10)
        m.model["bodies"][-1]["mass_kg"] = short(number(mass) * number(ratio))
        other = m.body(on(short(-number(length) * number(ratio))))
        m.model["bodies"][-1]["mass_kg"] = mass
        pin(arm)
        m.model["joints"].append({"name": "j1", "type": "fixed", "bodies": [arm, other], "at": on(0.0)})
    else:  # a spring without free length, above the pin: k a b = m g l
        above, out, mass = 2.0 ** rng.randint(-3, 1), 2.0 ** rng.randint(-3, 1), m.size(0.1, 10)
        arm = m.body(on(length))
        m.model["bodies"][-1]["mass_kg"] = mass
        pin(arm)
        m.model["springs"].append({"name": "s0", "type": "axial", "bodies": ["ground", arm], "at": [lift([0.0, above]), on(out)], "free_length_m": 0,
                                   "stiffness_n_per_m": short(number(mass) * number(g) * number(length) / (number(above) * number(out)))})
    if m.chance(0.4):  # something that vibrates beside it
        other = m.body(m.point())
        m.joint("ground", other, "revolute")
        m.torsion(m.model["joints"][-1], stiffness_n_m_per_rad=m.size(1e3, 1e6))
    m.model["parameters"] = {}
    for body in m.model["bodies"]:
        for member in ("mass_kg", "inertia_kg_m2"):
            if isinstance(body.get(member), str) and body[member][0] in "mJ":
                body[member] = 0.5
    return m.done()


def trusses(rng, dim):
    """Points on a grid of small integers, held by rods and springs: rank in exact arithmetic."""
    m = Maker(rng, dim, name="Grid")
    n = rng.randint(2, 6 if dim == 2 else 4)
    sites = set()
    while len(sites) < n:
        sites.add(tuple(rng.randint(-1, 2) for _ in range(dim)))
    for at in sorted(sites):
        m.body(list(at), point_mass=True)
    names = [b["name"] for b in m.model["bodies"]]
    for _ in range(rng.randint(n, 4 * n)):
        b = rng.choice(names)
        a = rng.choice(names + ["ground"])
        if a == b:
            continue
        at = [m.points[a] if a != "ground" else [rng.randint(-2, 3) for _ in range(dim)], m.points[b]]
        if at[0] == at[1]:
            continue
        if m.chance(0.3):
            m.model["joints"].append({"name": f"j{len(m.model['joints'])}", "type": "distance", "bodies": [a, b], "at": at})
        else:
            m.model["springs"].append({"name": f"s{len(m.model['springs'])}", "type": "axial", "bodies": [a, b], "at": at, "stiffness_n_per_m": rng.choice([1000, 2000, 500])})
    return m.done()


def frames(rng, dim):
    """Bodies on a grid of small integers, with any joints: redundant by chance."""
    m = Maker(rng, dim, name="Bodies on a grid")
    m.step = 2
    m.tree(rng.randint(1, 4 if dim == 2 else 3), tied=1.0, masses=0.0)
    if m.chance(0.6):
        m.loops(rng.randint(1, 2))
    for _ in range(rng.randint(0, 4)):
        b = rng.choice(names := [x["name"] for x in m.model["bodies"]])
        a = rng.choice(names + ["ground"])
        if a != b:
            m.spring(a, b, "axial")
    return m.done()


def negative(rng, dim):
    """Springs over their dead centre: some motions are unstable."""
    m = Maker(rng, dim, name="Negative springs")
    m.tree(rng.randint(1, 4 if dim == 2 else 2))
    m.springs(rng.randint(1, 4))
    m.stand()
    for spring in rng.sample(m.model["springs"], rng.randint(1, 2)):
        for member in ("stiffness_n_per_m", "stiffness_n_m_per_rad"):
            value = spring.get(member)
            if isinstance(value, (int, float)):
                spring[member] = -value
            elif isinstance(value, str):
                spring[member] = f"-{value}"
            elif value:
                k = rng.randrange(len(value))
                value[k] = -value[k]
    return m.done()


def massless(rng, dim):
    """Knots and levers without mass between springs: condensed, not counted."""
    m = Maker(rng, dim, name="Without mass")
    m.tree(rng.randint(2, 4 if dim == 2 else 3), tied=0.8)
    m.springs(rng.randint(1, 4))
    m.stand()
    for body in rng.sample(m.model["bodies"], rng.randint(1, len(m.model["bodies"]) - 1)):
        body["mass_kg"] = 0
        if "inertia_kg_m2" in body and m.chance(0.7):
            body["inertia_kg_m2"] = 0 if dim == 2 else [0, 0, 0]
    return m.done()


def far(rng, dim):
    """Pendulums drawn at any angle: they settle hanging."""
    m = Maker(rng, 2, name="Far from rest")
    at, previous = [0.0, 0.0], "ground"
    for i in range(rng.randint(1, 3)):
        way = rng.choice([(0.6, 0.8), (0.8, 0.6), (1.0, 0.0), (0.8, -0.6), (0.28, 0.96), (-0.6, 0.8), (-0.96, -0.28), (0.0, -1.0)])
        length = rng.randint(2, 12) / 16
        tip = [short(number(a) + number(w) * number(length)) for a, w in zip(at, way)]
        name = m.body(_middle(at, tip))
        m.joint(previous, name, "revolute", at)
        at, previous = tip, name
    m.model["gravity_m_per_s2"] = [0, -9.81]
    return m.done()


def beams(rng, dim):
    """Beam elements, clamped or free, with bodies, bars and springs at their ends."""
    m = Maker(rng, dim, name="Beams")
    last = "ground"
    at = m.point()
    for i in range(rng.randint(1, 2 if dim == 2 else 1)):
        span = m.point()
        while not any(span):
            span = m.point()
        end = _add(at, span)
        link = {"name": f"L{i}", "kind": "beam", "from": at, "to": end, "elements": rng.randint(1, 3 if dim == 2 else 2), "youngs_modulus_pa": m.parameter("E", m.size(1e9, 1e11), "Pa"),
                "section": {"shape": "general", "area_m2": m.size(1e-5, 1e-4), "second_moment_m4": m.size(1e-10, 1e-8)}}
        if m.chance(0.5):
            link["mass_kg"] = m.size(0.1, 10)
        else:
            link["density_kg_per_m3"] = m.size(1e3, 1e4)
        if dim == 3:
            link["shear_modulus_pa"] = m.size(1e9, 1e10)
            link["section"].update(second_moment_other_m4=m.size(1e-10, 1e-8), torsion_constant_m4=m.size(1e-10, 1e-8))
            k = next((k for k in range(3) if span[k] == 0), None)
            link["hinge_axis"] = [int(i == k) for i in range(3)] if k is not None else [span[1], -span[0], 0.0]
        m.model.setdefault("links", []).append(link)
        if i or m.chance(0.7):
            joint = {"name": f"r{i}", "type": rng.choice(["fixed", "fixed", "revolute"]), "bodies": [last, f"L{i}.start"], "at": at}
            if dim == 3 and joint["type"] == "revolute":
                joint["axis"] = m.axis()
            m.model["joints"].append(joint)
        last, at = f"L{i}.end", end
    if m.chance(0.6):
        tip = m.body(at)
        joint = {"name": "tip", "type": rng.choice(["fixed", "revolute"]), "bodies": [last, tip], "at": at}
        if dim == 3 and joint["type"] == "revolute":
            joint["axis"] = m.axis()
        m.model["joints"].append(joint)
    if m.chance(0.4):
        m.model["springs"].append({"name": "s", "type": "axial", "bodies": ["ground", last], "at": [_add(at, [1.0] + [0.0] * (dim - 1)), at], "stiffness_n_per_m": m.size(1e2, 1e5)})
    return m.done()


def _of(maker, dim):
    return lambda rng: maker(rng, dim)


for _name, _maker, _dims in (("four_bar", four_bar, (2, 3)), ("cranks", parallel_cranks, (2, 3)), ("dead", dead, (2, 3)), ("neutral", neutral, (2, 3)), ("trusses", trusses, (2, 3)),
                             ("frames", frames, (2, 3)), ("negative", negative, (2, 3)), ("massless", massless, (2, 3)), ("far", far, (2,)), ("tilted", tilted, (3,)), ("taut", taut, (2, 3)), ("beams", beams, (2, 3))):
    for _dim in _dims:
        KINDS[f"{_name}{_dim}"] = _of(_maker, _dim)

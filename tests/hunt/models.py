# SPDX-License-Identifier: GPL-3.0-or-later
"""Random mechanisms. Each maker returns a model as a file has it; what a study may vary is every parameter with a number."""


def _between(rng, low, high):
    """Evenly over the decades, three digits."""
    return float(f"{low * (high / low) ** rng.random():.3g}")


def _parameters(rng, count, prefix, unit, low, high):
    return {f"{prefix}_{i + 1}": {"value": _between(rng, low, high), "unit": unit} for i in range(count)}


def _uses(rng, names, plain=0.6):
    """An expression of some of the names: positive wherever they are."""
    a, b = rng.choice(names), rng.choice(names)
    if rng.random() < plain:
        return a
    return rng.choice([f"2*{a}", f"{a}+{b}", f"{a}+0.5*{b}", f"sqrt({a}*{b})", f"{a}*{b}/({a}+{b})", f"min({a},{b})",
                       f"max({a},{b})", f"0.3*{a}+{b}"])


def _each(rng, names, count):
    """One expression per item: every name is used once where there are items enough, the rest is shared."""
    own = list(names[:count]) + [_uses(rng, names) for _ in range(count - len(names))]
    return [e if rng.random() < 0.85 else _uses(rng, names, 0.0) for e in own]


def _not_monotone(rng, model):
    """Some stiffness follows a parameter that is best in the middle."""
    spring = rng.choice(model["springs"])
    member = next(m for m in spring if m.startswith("stiffness"))
    value = spring[member]
    model["parameters"]["a"] = {"value": round(rng.uniform(0.1, 0.9), 3), "unit": "1"}
    spring[member] = f"({value})*((a-{round(rng.uniform(0.2, 0.8), 2)})^2+0.1)*2"


def _row_of_springs(rng, n):
    """Pairs of masses (-1: ground) that springs join: a row, and some more."""
    pairs = [(i - 1, i) for i in range(n)]
    if rng.random() < 0.4:
        pairs.append((-1, n - 1))
    for _ in range(rng.choice([0, 0, 1, 2])):
        a = rng.randrange(n - 1) if n > 1 else 0
        pairs.append((rng.choice([-1, a]), rng.randrange(a + 1, n) if n > 1 else 0))
    return [p for p in dict.fromkeys(pairs) if p[0] != p[1]]


def _configurations(rng, model):
    """Sometimes a second state: without an item, or with another value of a parameter."""
    if rng.random() < 0.65:
        return
    model["configurations"] = {"one": {}, "two": {}}
    if rng.random() < 0.5 and len(model["springs"]) > 2:
        rng.choice(model["springs"][1:])["in"] = ["one"]
    else:
        name = rng.choice([n for n, p in model["parameters"].items() if isinstance(p["value"], float)])
        model["configurations"]["two"]["parameters"] = {name: model["parameters"][name]["value"] * rng.choice([0.5, 0.8, 1.5])}


def chain(rng, loaded=False):
    """Point masses on guides along x (loaded: along y, under their weight), axial springs between them and to the ground."""
    n = rng.randint(1, 6)
    pairs = _row_of_springs(rng, n)
    ks = _parameters(rng, rng.randint(1, len(pairs)), "k", "N/m", 1e3, 1e5)
    ms = _parameters(rng, rng.randint(1, n), "m", "kg", 0.3, 5.0)
    stiffness, mass = _each(rng, list(ks), len(pairs)), _each(rng, list(ms), n)
    place = (lambda i: [0, -0.1 * (i + 1)]) if loaded else (lambda i: [0.1 * (i + 1), 0])
    axis = [0, 1] if loaded else [1, 0]
    side = 0.05 if rng.random() < 0.3 and not loaded else 0.0  # a body behind a prismatic joint instead of a point mass
    model = {
        "format": "modetune-model/1", "name": "Masses on guides", "dimension": 2, "parameters": {**ks, **ms},
        "bodies": [{"name": f"b{i}", "mass_kg": mass[i], "centre": place(i)} for i in range(n)],
        "joints": [{"name": f"g{i}", "type": "pin-in-slot", "bodies": ["ground", f"b{i}"], "at": place(i), "axis": axis} for i in range(n)],
        "springs": [{"name": f"s{j}", "type": "axial", "bodies": ["ground" if a < 0 else f"b{a}", f"b{b}"],
                     "at": [place(a if a >= 0 else -1 if b else -1), place(b)], "stiffness_n_per_m": stiffness[j]}
                    for j, (a, b) in enumerate(pairs)]}
    if side:
        for body, joint in zip(model["bodies"], model["joints"]):
            body["inertia_kg_m2"] = 0.01
            joint["type"] = "prismatic"
    if rng.random() < 0.2:
        _not_monotone(rng, model)
    if loaded:
        model["gravity_m_per_s2"] = [0, -9.81]
    else:
        _configurations(rng, model)  # not where a mass could lose its spring and fall
    return model


def loaded(rng):
    """Masses that hang on springs: their weight moves the equilibrium and no frequency."""
    return chain(rng, loaded=True)


def shaft(rng):
    """Discs on a shaft, torsion springs between them; held at one end, or free to turn."""
    n = rng.randint(2, 6)
    free = rng.random() < 0.3
    count = n - 1 if free else n
    ks = _parameters(rng, rng.randint(1, count), "k", "N m/rad", 1e2, 1e4)
    js = _parameters(rng, rng.randint(1, n), "J", "kg m^2", 0.01, 0.3)
    stiffness, inertia = _each(rng, list(ks), count), _each(rng, list(js), n)
    springs = [{"name": f"s{i}", "type": "torsion", "bodies": [f"d{i}", f"d{i + 1}"], "stiffness_n_m_per_rad": stiffness[i]}
               for i in range(n - 1)]
    if not free:
        springs.append({"name": "root", "type": "torsion", "joint": "p0", "stiffness_n_m_per_rad": stiffness[-1]})
    model = {
        "format": "modetune-model/1", "name": "Discs on a shaft", "dimension": 2, "parameters": {**ks, **js},
        "bodies": [{"name": f"d{i}", "mass_kg": 1, "inertia_kg_m2": inertia[i], "centre": [0.3 * i, 0]} for i in range(n)],
        "joints": [{"name": f"p{i}", "type": "revolute", "bodies": ["ground", f"d{i}"], "at": [0.3 * i, 0]} for i in range(n)],
        "springs": springs}
    if rng.random() < 0.2:
        _not_monotone(rng, model)
    _configurations(rng, model)
    return model


def truss(rng):
    """A cantilever of braced bays: bars with consistent mass, lumped masses at the nodes."""
    bays = rng.randint(1, 2)
    areas = _parameters(rng, rng.randint(1, 4), "A", "m^2", 1e-4, 2e-3)
    lumps = _parameters(rng, rng.randint(1, 2), "m", "kg", 5.0, 50.0)
    nodes = {f"n{i}{s}": [float(i), 0.0 if s == "l" else 0.9] for i in range(bays + 1) for s in "lu"}
    bars = []
    for i in range(bays):
        bars += [(f"n{i}l", f"n{i + 1}l"), (f"n{i}u", f"n{i + 1}u"), (f"n{i}l", f"n{i + 1}u"), (f"n{i}u", f"n{i + 1}l"),
                 (f"n{i + 1}l", f"n{i + 1}u")]
    area, free = _each(rng, list(areas), len(bars)), [n for n in nodes if not n.startswith("n0")]
    mass = _each(rng, list(lumps), len(free))
    body = lambda n: "ground" if n.startswith("n0") else n
    model = {
        "format": "modetune-model/1", "name": "Braced cantilever", "dimension": 2, "parameters": {**areas, **lumps},
        "points": {"p" + n: at for n, at in nodes.items()},
        "bodies": [{"name": n, "mass_kg": mass[i], "centre": "p" + n} for i, n in enumerate(free)],
        "springs": [{"name": f"bar{j}", "type": "bar", "bodies": [body(a), body(b)], "at": ["p" + a, "p" + b],
                     "youngs_modulus_pa": 7e10, "area_m2": area[j], "density_kg_per_m3": 2700} for j, (a, b) in enumerate(bars)]}
    return model


def beads(rng):
    """Beads on a tensioned string, free to move in the plane."""
    n = rng.randint(1, 4)
    ms = _parameters(rng, rng.randint(1, n), "m", "kg", 0.05, 0.5)
    mass = _each(rng, list(ms), n)
    body = lambda i: f"b{i}" if 0 <= i < n else "ground"
    return {
        "format": "modetune-model/1", "name": "Beads on a string", "dimension": 2,
        "parameters": {"T": {"value": _between(rng, 20, 200), "unit": "N"}, "k": {"value": _between(rng, 5e3, 5e4), "unit": "N/m"}, **ms},
        "bodies": [{"name": f"b{i}", "mass_kg": mass[i], "centre": [0.3 * (i + 1), 0]} for i in range(n)],
        "springs": [{"name": f"s{i}", "type": "axial", "bodies": [body(i - 1), body(i)], "at": [[0.3 * i, 0], [0.3 * (i + 1), 0]],
                     "stiffness_n_per_m": "k", "preload_n": "T"} for i in range(n + 1)]}


def hanging(rng):
    """Masses below each other on distance joints, in gravity: lengths are parameters."""
    n = rng.randint(1, 3)
    ms, ls = _parameters(rng, n, "m", "kg", 0.3, 5.0), _parameters(rng, n, "l", "m", 0.2, 1.0)
    depth = ["-" + "-".join(f"l_{j + 1}" for j in range(i + 1)) for i in range(n)]
    at = lambda i: [0, depth[i]] if i >= 0 else [0, 0]
    return {
        "format": "modetune-model/1", "name": "Hanging masses", "dimension": 2, "gravity_m_per_s2": [0, -9.81], "parameters": {**ms, **ls},
        "bodies": [{"name": f"b{i}", "mass_kg": f"m_{i + 1}", "centre": at(i)} for i in range(n)],
        "joints": [{"name": f"d{i}", "type": "distance", "bodies": [f"b{i - 1}" if i else "ground", f"b{i}"], "at": [at(i - 1), at(i)],
                    "length_m": f"l_{i + 1}"} for i in range(n)]}


def arm(rng):
    """Two links, servos at shoulder and elbow; the elbow is driven to several angles."""
    ks, ms = _parameters(rng, 2, "k", "N m/rad", 5e2, 2e4), _parameters(rng, 2, "m", "kg", 2.0, 20.0)
    angles = rng.choice([[-60, 0, 60], [0, 90], [-90, -30, 30, 90], [0, 150]])
    return {
        "format": "modetune-model/1", "name": "Two links", "dimension": 2, "parameters": {**ks, **ms},
        "bodies": [{"name": "upper", "mass_kg": "m_1", "inertia_kg_m2": "m_1*0.6^2/12", "centre": [0.3, 0]},
                   {"name": "lower", "mass_kg": "m_2", "inertia_kg_m2": "m_2*0.5^2/12", "centre": [0.85, 0]}],
        "joints": [{"name": "shoulder", "type": "revolute", "bodies": ["ground", "upper"], "at": [0, 0]},
                   {"name": "elbow", "type": "revolute", "bodies": ["upper", "lower"], "at": [0.6, 0]}],
        "springs": [{"name": "servo1", "type": "torsion", "joint": "shoulder", "stiffness_n_m_per_rad": "k_1"},
                    {"name": "servo2", "type": "torsion", "joint": "elbow", "stiffness_n_m_per_rad": "k_2"}],
        "configurations": {f"at{i}": {"drive": {"joint": "elbow", "position_rad": f"{a}*deg", "hold": {"trim": "servo2"}}}
                           for i, a in enumerate(angles)}}


def levers(rng):
    """Levers on hinges, rods between them at heights that are parameters: lengths where nothing loads the mechanism."""
    n = rng.randint(1, 3)
    ls, ks = _parameters(rng, rng.randint(1, n), "l", "m", 0.05, 0.5), _parameters(rng, rng.randint(1, n), "k", "N/m", 1e3, 1e5)
    js, ts = _parameters(rng, rng.randint(1, n), "J", "kg m^2", 0.01, 0.3), _parameters(rng, 1, "t", "N m/rad", 1e2, 1e3)
    height, stiffness, inertia = _each(rng, list(ls), n), _each(rng, list(ks), n), _each(rng, list(js), n)
    body = lambda i: f"b{i}" if i < n else "ground"
    model = {
        "format": "modetune-model/1", "name": "Levers and rods", "dimension": 2, "parameters": {**ls, **ks, **js, **ts},
        "bodies": [{"name": f"b{i}", "mass_kg": 40, "inertia_kg_m2": inertia[i], "centre": [i, 0]} for i in range(n)],
        "joints": [{"name": f"h{i}", "type": "revolute", "bodies": ["ground", f"b{i}"], "at": [i, 0]} for i in range(n)],
        "springs": [{"name": f"r{i}", "type": "axial", "bodies": [body(i), body(i + 1)], "at": [[i, height[i]], [i + 1, height[i]]],
                     "stiffness_n_per_m": stiffness[i]} for i in range(n)]
        + [{"name": f"t{i}", "type": "torsion", "bodies": ["ground", f"b{i}"], "stiffness_n_m_per_rad": "t_1"} for i in range(n) if i == 0 or rng.random() < 0.5]}
    _configurations(rng, model)
    return model


MAKERS = {"chain": chain, "loaded": loaded, "shaft": shaft, "truss": truss, "beads": beads, "hanging": hanging, "arm": arm, "levers": levers}
UNLOADED = ["chain", "shaft", "truss", "levers"]

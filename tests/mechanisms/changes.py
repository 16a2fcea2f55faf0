# SPDX-License-Identifier: GPL-3.0-or-later
"""The same mechanism written in another way. Each change takes (rng, model) and returns (model, factor of the frequencies), or None where it does not apply."""
import copy
from decimal import Decimal

from exact import number
from makers import PYTHAGOREAN

UNITS = {"m": (1, 0, 0), "m^2": (2, 0, 0), "kg": (0, 1, 0), "kg m^2": (2, 1, 0), "N/m": (0, 1, -2), "N m/rad": (2, 1, -2), "N": (1, 1, -2),
         "N m": (2, 1, -2), "m/s^2": (1, 0, -2), "rad": (0, 0, 0), "1": (0, 0, 0), "Pa": (-1, 1, -2)}  # powers of length, mass, time
MEMBERS = {"mass_kg": "kg", "inertia_kg_m2": "kg m^2", "centre": "m", "at": "m", "from": "m", "to": "m", "length_m": "m", "free_length_m": "m",
           "stiffness_n_per_m": "N/m", "stiffness_n_m_per_rad": "N m/rad", "area_m2": "m^2", "preload_n": "N", "preload_n_m": "N m",
           "gravity_m_per_s2": "m/s^2", "position_m": "m", "radius_of_gyration_m": "m", "ratio_m_per_rad": "m", "force_n": "N", "moment_n_m": "N m"}
OTHERS = {"youngs_modulus_pa": (-1, 1, -2), "shear_modulus_pa": (-1, 1, -2), "density_kg_per_m3": (-3, 1, 0), "second_moment_m4": (4, 0, 0),
          "second_moment_other_m4": (4, 0, 0), "torsion_constant_m4": (4, 0, 0)}
TURNABLE = ("fixed", "revolute", "cylindrical", "spherical", "universal", "planar", "prismatic", "distance", "orientation")


def short(x):
    """A decimal as a number of a file that means exactly it."""
    out = float(x)
    if number(out) != x:
        raise ArithmeticError(f"{x} has too many digits")
    return out


def each(value, change):
    """The same with every number (not a name) changed."""
    if isinstance(value, list):
        return [each(v, change) for v in value]
    return value if isinstance(value, (str, bool)) or value is None else change(value)


def items(model):
    yield model
    for name in ("bodies", "links", "joints", "springs", "loads"):
        yield from model.get(name, [])
    for configuration in (model.get("configurations") or {}).values():
        yield configuration
        if "drive" in configuration:
            yield configuration["drive"]
    for joint in model.get("joints", []):
        yield joint.get("compliance", {})
    for link in model.get("links", []):
        yield link.get("section", {})


def order(rng, model):
    model = copy.deepcopy(model)
    for name in ("bodies", "joints", "springs", "loads"):
        if name in model:
            rng.shuffle(model[name])
    return model, 1


def _negate(value):
    """The negative of a number or of the expression that it is."""
    return f"-({value})" if isinstance(value, str) else -value


def _ends(rng, model):
    """Links drawn from the other end: what held the start holds the end."""
    swap = {}
    for link in model.get("links", []):
        if rng.random() < 0.6:
            link["from"], link["to"] = link["to"], link["from"]
            if isinstance(link.get("stiffness_n_m_per_rad"), list):
                link["stiffness_n_m_per_rad"].reverse()
            n, name = link["elements"], link["name"]
            swap.update({f"{name}.start": f"{name}.end", f"{name}.end": f"{name}.start"})
            swap.update({f"{name}.{i}": f"{name}.{n + 1 - i}" for i in range(1, n + 1)})
    for item in model.get("joints", []) + model.get("springs", []):
        if "bodies" in item:
            item["bodies"] = [swap.get(b, b) for b in item["bodies"]]
    for load in model.get("loads", []):
        if "on" in load:
            load["on"] = swap.get(load["on"], load["on"])


def direction(rng, model):
    """Joints and springs that hold the same two bodies the other way round; links drawn from the other end."""
    model = copy.deepcopy(model)
    loaded = "gravity_m_per_s2" in model or "loads" in model or "configurations" in model or any(m in s for s in model.get("springs", [])
                                                                            for m in ("preload_n", "preload_n_m", "free_angle_rad", "free_length_m"))
    _ends(rng, model)
    turned = set()
    for joint in model.get("joints", []):
        if joint["type"] in TURNABLE and "compliance" not in joint and rng.random() < 0.6:
            joint["bodies"].reverse()
            turned.add(joint["name"])
            if joint["type"] == "distance":
                joint["at"].reverse()
            if joint["type"] == "universal":
                joint["axis"], joint["axis_b"] = joint["axis_b"], joint["axis"]
    for joint in model.get("joints", []):
        for member in ("ratio", "ratio_m_per_rad"):
            if member in joint and len(turned & set(joint["joints"])) == 1:
                joint[member] = _negate(joint[member])
    for load in model.get("loads", []):
        for member in ("force_n", "moment_n_m"):
            if load.get("joint") in turned and member in load:
                load[member] = _negate(load[member])
    for spring in model.get("springs", []):
        back = spring.get("joint") in turned
        if "bodies" in spring and (spring["type"] != "bushing" or not loaded) and rng.random() < 0.6:
            spring["bodies"].reverse()
            if spring["type"] in ("axial", "bar"):
                spring["at"] = spring["at"][::-1]
            back = spring["type"] == "torsion"
        for member in ("preload_n_m", "free_angle_rad"):
            if back and member in spring:
                spring[member] = _negate(spring[member])
    for configuration in (model.get("configurations") or {}).values():
        drive = configuration.get("drive", {})
        for member in ("position_rad", "position_m"):
            if drive.get("joint") in turned and member in drive:
                drive[member] = _negate(drive[member])
    return model, 1


def units(rng, model):
    """Lengths, masses and times in other units: all numbers change, one factor of all frequencies."""
    powers = [rng.randint(-4, 4), rng.randint(-4, 4), rng.randint(-3, 3)]
    model = copy.deepcopy(model)

    def scaled(dims):
        factor = Decimal(10) ** sum(d * p for d, p in zip(dims, powers))
        return lambda x: short(number(x) * factor)
    rescale(model, scaled)
    return model, Decimal(10) ** -powers[2]


def rescale(model, scaled):
    """Every number by the change that `scaled` gives for its dimensions: powers of length, mass and time."""
    for item in items(model):
        for member, unit in MEMBERS.items():
            if member in item:
                item[member] = each(item[member], scaled(UNITS[unit]))
        for member, dims in OTHERS.items():
            if member in item:
                item[member] = each(item[member], scaled(dims))
        if "stiffness_matrix" in item:
            item["stiffness_matrix"] = [[each(x, scaled(((r > 2) + (c > 2), 1, -2))) for c, x in enumerate(row)] for r, row in enumerate(item["stiffness_matrix"])]
    for parameter in model.get("parameters", {}).values():
        parameter["value"] = each(parameter["value"], scaled(UNITS[parameter["unit"]]))


LENGTHS = {"mm": Decimal("0.001"), "cm": Decimal("0.01"), "in": Decimal("0.0254"), "ft": Decimal("0.3048")}


def written(rng, model):
    """The same lengths, written in another unit than metres: coordinates by "units", parameters by their own. Nothing changes."""
    model = copy.deepcopy(model)
    unit = rng.choice(("mm", "mm", "cm", "in", "ft"))
    other = rng.choice(("mm", "cm"))
    to = lambda name: lambda x: short(number(x) / LENGTHS[name])
    model["units"] = {"length": unit, "angle": rng.choice(("rad", "deg"))}
    for item in items(model):
        for member in ("centre", "at", "from", "to"):
            if member in item:
                item[member] = each(item[member], to(unit))
    for name, point in model.get("points", {}).items():
        model["points"][name] = each(point, to(unit))
    for parameter in model.get("parameters", {}).values():
        if parameter["unit"] == "m" and not isinstance(parameter["value"], str):
            parameter["value"] = to(other)(parameter["value"])
            parameter["unit"] = other
    for configuration in (model.get("configurations") or {}).values():
        own = configuration.get("parameters", {})
        for name in own:
            if model["parameters"][name]["unit"] in LENGTHS:
                own[name] = each(own[name], to(model["parameters"][name]["unit"]))
    return model, 1


def _rotation(rng, dim, quarter):
    """Exact in few digits."""
    if dim == 2:
        c, s = rng.choice([(0, 1), (-1, 0), (0, -1)] if quarter else PYTHAGOREAN + [(0, 1)])
        c, s = number(c), number(s) * rng.choice([1, -1])
        return [[c, -s], [s, c]]
    while True:
        w, x, y, z = rng.choice([(4, 2, 2, 1), (2, 4, 2, 1), (1, 2, 4, 2), (1, 1, 1, 1), (3, 1, 3, 9), (1, 1, 7, 7), (9, 3, 1, 3), (2, 1, 4, 2)])
        signs = [rng.choice([1, -1]) for _ in range(4)]
        w, x, y, z = (Decimal(a * b) for a, b in zip((w, x, y, z), signs))
        n = w * w + x * x + y * y + z * z
        return [[(w * w + x * x - y * y - z * z) / n, 2 * (x * y - w * z) / n, 2 * (x * z + w * y) / n],
                [2 * (x * y + w * z) / n, (w * w - x * x + y * y - z * z) / n, 2 * (y * z - w * x) / n],
                [2 * (x * z - w * y) / n, 2 * (y * z + w * x) / n, (w * w - x * x - y * y + z * z) / n]]


def place(rng, model):
    """Elsewhere and turned. Not where a coordinate is a parameter: it would become an expression of all three."""
    dim = model["dimension"]
    if any(isinstance(x, str) for item in items(model) for m in ("at", "centre", "from", "to", "gravity_m_per_s2", "axis", "axis_b", "inertia_kg_m2", "force_n")
           for x in flat(item.get(m, [])) if dim == 3 or m != "inertia_kg_m2"):
        return None
    if any("angles_rad" in a or any(isinstance(x, str) for x in flat(list(a.values()))) for a in (item.get("axes", {}) for item in items(model))):
        return None
    uneven = any(s["type"] == "bushing" and "axes" not in s and s["stiffness_n_per_m"][0] != s["stiffness_n_per_m"][1] for s in model.get("springs", []) if dim == 2)
    q = _rotation(rng, dim, uneven)
    shift = [Decimal(rng.randint(-32, 32)) / 16 for _ in range(dim)]
    model = copy.deepcopy(model)
    turn = lambda v: [short(sum(q[i][k] * number(v[k]) for k in range(dim))) for i in range(dim)]
    move = lambda v: [short(number(x) + s) for x, s in zip(turn(v), shift)]
    both = lambda v: [both(w) for w in v] if isinstance(v[0], list) else move(v)
    for joint in model.get("joints", []):
        if "compliance" in joint and "axis" not in joint:
            joint["compliance"].setdefault("axes", {"x": [1, 0, 0], "y": [0, 1, 0]} if dim == 3 else {"x": [1, 0]})
    for item in items(model):
        for member in ("at", "centre", "from", "to"):
            if member in item:
                item[member] = both(item[member])
        for member in ("axis", "axis_b", "hinge_axis", "gravity_m_per_s2", "force_n"):
            if isinstance(item.get(member), list):
                item[member] = turn(item[member])
        if "axes" in item:
            item["axes"] = {member: turn(v) for member, v in item["axes"].items()}
            continue
        if dim == 3 and "inertia_kg_m2" in item:
            item["inertia_kg_m2"] = _inertia(q, item["inertia_kg_m2"])
        if dim == 3 and item.get("type") == "bushing":
            _bushing(q, item)
        if uneven and item.get("type") == "bushing" and q[0][0] == 0:
            item["stiffness_n_per_m"].reverse()
    return model, 1


def flat(value):
    return [x for v in value for x in flat(v)] if isinstance(value, list) else [value]


def _congruent(q, k):
    """q k q'."""
    n = range(3)
    return [[sum(q[i][a] * k[a][b] * q[j][b] for a in n for b in n) for j in n] for i in n]


def _inertia(q, given):
    xx, yy, zz, xy, xz, yz = [number(x) for x in given] + [Decimal(0)] * (6 - len(given))
    j = _congruent(q, [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return [short(x) for x in (j[0][0], j[1][1], j[2][2], j[0][1], j[0][2], j[1][2])]


def _bushing(q, item):
    if "stiffness_matrix" in item:
        k = [[number(x) for x in row] for row in item["stiffness_matrix"]]
    else:
        diagonal = [number(x) for x in item.pop("stiffness_n_per_m") + item.pop("stiffness_n_m_per_rad")]
        k = [[diagonal[i] if i == j else Decimal(0) for j in range(6)] for i in range(6)]
    out = [[None] * 6 for _ in range(6)]
    for r in (0, 3):
        for c in (0, 3):
            block = _congruent(q, [row[c:c + 3] for row in k[r:r + 3]])
            for i in range(3):
                for j in range(3):
                    out[r + i][c + j] = short(block[i][j])
    item["stiffness_matrix"] = out


def where_exact(change):
    """None where the numbers would have too many digits to be those of a file."""
    def tried(rng, model):
        try:
            return change(rng, model)
        except ArithmeticError:
            return None
    return tried


CHANGES = {"order": order, "direction": direction, "units": where_exact(units), "written": where_exact(written), "place": where_exact(place)}

# SPDX-License-Identifier: GPL-3.0-or-later
"""Hostile files: any of the tree's own files, grown at one place to a size that is asked for, and files of kinds that growing does not reach."""
import copy
import json

EXTREMES = [0, -1, 1e308, -1e308, 5e-324, 1e-200, 1e15, 1e12, 1e9, 2147483647, 100000, 0.1]


class Raw(str):
    """JSON text that is put in as it stands."""


def dumps(value):
    """JSON, with pairs in a list of Pairs as an object whose names may repeat."""
    if isinstance(value, Raw):
        return str(value)
    if isinstance(value, Pairs):
        return "{" + ",".join(f"{json.dumps(k)}:{dumps(v)}" for k, v in value) + "}"
    if isinstance(value, dict):
        return "{" + ",".join(f"{json.dumps(k)}:{dumps(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ",".join(map(dumps, value)) + "]"
    return json.dumps(value)


class Pairs(list):
    pass


def places(value, path=()):
    """Paths of all values of a document."""
    yield path
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, child in items:
        yield from places(child, (*path, key))


def value_at(document, path):
    for key in path:
        document = document[key]
    return document


def with_value(document, path, value):
    if not path:
        return value
    changed = copy.copy(document)
    changed[path[0]] = with_value(document[path[0]], path[1:], value)
    return changed


def renamed(item, i):
    if isinstance(item, dict) and isinstance(item.get("name"), str):
        return dict(item, name=f"{item['name']}{i}")
    return f"{item}{i}" if isinstance(item, str) else item


def copies(item, size):
    return max(2, size // (len(json.dumps(item)) + 12))


def grow_list(rng, value, size, same):
    item = rng.choice(value) if value else {}
    n = copies(item, size)
    more = [item] * n if same else [renamed(item, i) for i in range(n)]
    return value + more if rng.random() < 0.5 else more + value


def grow_object(rng, value, size, same):
    key = rng.choice(list(value)) if value else "x"
    item = value.get(key, 1)
    n = copies(item, size)
    return Pairs([*value.items(), *((key if same else f"{key}{i}", item) for i in range(n))])


def long_text(rng, value, size):
    kind = rng.randrange(5)
    if kind == 0:
        return (value or "x") * max(2, size // (len(value) + 1))
    if kind == 1:
        return "(" * (size // 2) + "1" + ")" * (size // 2)
    if kind == 2:
        return "+".join(["1"] * (size // 2))
    if kind == 3:
        return "\u00e9" * (size // 6)
    return Raw("1" + "0" * rng.choice([300, size]))


def nested(rng, size):
    n = rng.choice([63, 64, 65, size // 2])
    return Raw("[" * n + "]" * n)


def grown(rng, document, size):
    """The document grown at a random place; what was done, and the text."""
    path = rng.choice(list(places(document)))
    value = value_at(document, path)
    same = rng.random() < 0.5
    at = "/" + "/".join(map(str, path))
    if rng.random() < 0.1:
        return f"nested {at}", dumps(with_value(document, path, nested(rng, size)))
    if isinstance(value, list):
        what, new = f"list {at} same={same}", grow_list(rng, value, size, same)
    elif isinstance(value, dict):
        what, new = f"object {at} same={same}", grow_object(rng, value, size, same)
    elif isinstance(value, str):
        what, new = f"text {at}", long_text(rng, value, size)
    else:
        new = rng.choice(EXTREMES)
        what = f"number {at} {new}"
    return what, dumps(with_value(document, path, new))


def extreme(rng, document, changes=1):
    """The document with one number, or what may be one, replaced by an extreme."""
    what = []
    for _ in range(changes):
        numbers = [p for p in places(document) if isinstance(value_at(document, p), (int, float)) and not isinstance(value_at(document, p), bool)]
        if not numbers:
            break
        path = rng.choice(numbers)
        new = rng.choice(EXTREMES)
        document = with_value(document, path, new)
        what.append(f"/{'/'.join(map(str, path))} = {new}")
    return ", ".join(what), dumps(document)


# Files of one kind each, of n parts. A model unless it says otherwise.

def model(**members):
    return dumps({"format": "modetune-model/1", "dimension": 2, "bodies": [{"name": "a", "mass_kg": 1, "inertia_kg_m2": 1, "centre": [0, 0]}],
                  "springs": [{"name": "s", "type": "axial", "bodies": ["ground", "a"], "at": [[-1, 0], [0, 0]], "stiffness_n_per_m": 100}], **members})


def name(i):
    """Names of one length, no two alike."""
    return "n%07dq" % i


def far(i):
    """Far from all of name()."""
    return "".join(chr(97 + (i * 7919 + k * k * 31 + (i >> k)) % 26) for k in range(9))


def body(i, **more):
    return {"name": name(i), "mass_kg": 1, "inertia_kg_m2": 1, "centre": [i, 0], **more}


def axial(i, a, b, **more):
    return {"name": f"s{i}", "type": "axial", "bodies": [a, b], "at": [[0, 1], [i, 0]], "stiffness_n_per_m": 100, **more}


MODELS = {
    "unknown names in expressions": lambda n: model(parameters={name(i): f"{far(i)}+1" for i in range(n)}),
    "unknown names near known ones": lambda n: model(parameters={name(i): f"{name(i)[:-1]}r+1" for i in range(n)}),
    "long unknown names": lambda n: model(parameters={"a" * 200 + name(i): "a" * 200 + far(i) for i in range(n // 8)}),
    "unknown bodies": lambda n: model(springs=[axial(i, "ground", far(i)) for i in range(n // 4)],
                                      bodies=[body(i) for i in range(n // 4)]),
    "unknown points": lambda n: model(points={name(i): [i, 0] for i in range(n)},
                                      bodies=[dict(body(i), centre=far(i)) for i in range(n // 4)]),
    "unknown configurations": lambda n: model(configurations={name(i): {} for i in range(n)},
                                              bodies=[body(i, **{"in": [far(i)]}) for i in range(n // 4)]),
    "unknown likes": lambda n: model(configurations={name(i): {"like": far(i)} for i in range(n)}),
    "unknown overrides": lambda n: model(parameters={name(i): 1 for i in range(n // 2)},
                                         configurations={"c": {"parameters": {far(i): 1 for i in range(n // 2)}}}),
    "unknown members": lambda n: dumps(Pairs([("format", "modetune-model/1"), ("dimension", 2), *((far(i), 1) for i in range(n))])),
    "unknown members of many": lambda n: model(bodies=[dict(body(i), masss_kg=1, centr=2) for i in range(n // 4)]),
    "a circle": lambda n: model(parameters={name(i): name((i + 1) % n) for i in range(n)}),
    "many circles": lambda n: model(parameters={name(i): name(i ^ 1) for i in range(n // 2 * 2)}),
    "circles in overrides": lambda n: model(parameters={name(i): name(i + 1) if i < n - 1 else 1 for i in range(n)},
                                            configurations={f"c{k}": {"parameters": {name(n - 1): name(0)}} for k in range(50)}),
    "a circle of likes": lambda n: model(configurations={name(i): {"like": name((i + 1) % n)} for i in range(n)}),
    "a chain of likes": lambda n: model(configurations={name(i): {"like": name(i + 1)} if i < n - 1 else {} for i in range(n)}),
    "a chain of likes with overrides": lambda n: model(
        parameters={name(i): 1 for i in range(n // 4)},
        configurations={f"c{i}": {"like": f"c{i - 1}" if i else "o", "parameters": {name(i): 2}} for i in range(n // 4)} | {"o": {}}),
    "a chain of parameters": lambda n: model(parameters={name(i): f"{name(i + 1)}+1" if i < n - 1 else 1 for i in range(n)}),
    "a doubling chain": lambda n: model(parameters={name(i): f"{name(i + 1)}*{name(i + 1)}" if i < n - 1 else 1 for i in range(n)}),
    "all refer to one that refers to all before": lambda n: model(
        parameters={name(i): "+".join(name(k) for k in range(max(0, i - 200), i)) or 1 for i in range(n // 100)}),
    "one name for all parameters": lambda n: dumps({"format": "modetune-model/1", "dimension": 2, "parameters": Pairs([("k", 1)] * n)}),
    "one name for all bodies": lambda n: model(bodies=[dict(body(i), name="a") for i in range(n // 4)]),
    "one name for all springs": lambda n: model(springs=[dict(axial(i, "ground", "a"), name="s") for i in range(n // 4)]),
    "points": lambda n: model(points={name(i): [i, i] for i in range(n)}),
    "springs": lambda n: model(springs=[axial(i, "ground", "a") for i in range(n // 4)]),
    "gears of one joint": lambda n: model(joints=[{"name": f"j{i}", "type": "revolute", "bodies": ["ground", "a"], "at": [0, 0]} for i in range(n // 4)]),
    "sensors": lambda n: model(sensors=[{"name": name(i), "on": "a", "directions": ["x"]} for i in range(n // 4)]),
    "names of modes": lambda n: model(modes={name(i): {"configuration": "c", "index": 1} for i in range(n // 2)}, configurations={"c": {}}),
    "configurations": lambda n: model(configurations={name(i): {} for i in range(n)}),
    "configurations times parameters": lambda n: model(parameters={name(i): i for i in range(n // 2)},
                                                       configurations={f"c{i}": {"parameters": {name(i): 2}} for i in range(n // 8)}),
    "configurations times items": lambda n: model(configurations={f"c{i}": {} for i in range(n // 2)},
                                                  bodies=[body(i, **{"in": ["c1"]}) for i in range(n // 8)],
                                                  springs=[axial(i, "ground", name(i), **{"in": ["c1"]}) for i in range(n // 8)]),
    "bodies": lambda n: model(bodies=[body(i) for i in range(n // 4)], springs=[axial(i, "ground", name(i)) for i in range(n // 4)]),
    "links": lambda n: model(points={"o": [0, 0], "e": [0, 1]},
                             links=[{"name": f"l{i}", "from": "o", "to": "e", "elements": 3, "mass_kg": 1, "stiffness_n_m_per_rad": [1, 1]} for i in range(n // 5)]),
    "elements": lambda n: model(points={"o": [0, 0], "e": [0, 1]},
                                links=[{"name": "l", "from": "o", "to": "e", "elements": n, "mass_kg": 1, "stiffness_n_m_per_rad": 1}]),
    "elements beyond counting": lambda n: model(points={"o": [0, 0], "e": [0, 1]},
                                                links=[{"name": "l", "from": "o", "to": "e", "elements": 2147483647, "mass_kg": 1, "stiffness_n_m_per_rad": 1}]),
    "duplicates of a member": lambda n: "{" + ",".join(['"format": "modetune-model/1"'] * n) + "}",
    "nesting": lambda n: "[" * (8 * n) + "]" * (8 * n),
    "an open string": lambda n: '{"format": "' + "x" * (16 * n),
    "escapes": lambda n: '{"format": "' + "\\u00e9" * (3 * n) + '"}',
    "broken escapes": lambda n: '{"format": "' + "\\x" * (8 * n) + '"}',
    "digits": lambda n: '{"dimension": ' + "9" * (16 * n) + "}",
    "comments": lambda n: "{" + "/* */" * (3 * n) + "}",
    "commas": lambda n: "[" + "," * (16 * n) + "]",
    "values": lambda n: "[" + "0," * (8 * n) + "0]",
    "lines": lambda n: "\n" * (16 * n) + "[}",
}


def study(**members):
    return dumps({"format": "modetune-study/1", "model": "model.json",
                  "variables": [{"parameter": "k", "lower": 50, "upper": 200}],
                  "goals": [{"type": "frequency", "configuration": "c", "mode": 1, "target_hz": 2}], **members})


# The model of the studies: n parameters, of which the first is a stiffness.
def study_model(n):
    return model(parameters={"k": 100, "m": 1, **{name(i): 1 for i in range(n)}}, configurations={"c": {}},
                 bodies=[{"name": "a", "mass_kg": "m", "inertia_kg_m2": 1, "centre": [0, 0]}],
                 springs=[{"name": "s", "type": "axial", "bodies": ["ground", "a"], "at": [[-1, 0], [0, 0]], "stiffness_n_per_m": "k"}])


def frequency(i, **more):
    return {"type": "frequency", "configuration": "c", "mode": 1, "at_least_hz": 1 + i * 1e-7, **more}


def avoid(i, **more):
    return {"type": "avoid", "configurations": ["c"], "bands_hz": [[10 + i, 10.5 + i]], **more}


STUDIES = {
    "unknown variables": lambda n: study(variables=[{"parameter": far(i), "lower": 1, "upper": 2} for i in range(n // 4)]),
    "variables": lambda n: study(variables=[{"parameter": name(i), "lower": 1, "upper": 2} for i in range(n // 4)]),
    "one variable again and again": lambda n: study(variables=[{"parameter": "k", "lower": 1, "upper": 2}] * (n // 4)),
    "unknown configurations": lambda n: study(goals=[frequency(i, configuration=far(i)) for i in range(n // 6)]),
    "goals": lambda n: study(goals=[frequency(i) for i in range(n // 6)]),
    "goals that are equal": lambda n: study(goals=[frequency(0)] * (n // 6)),
    "limits": lambda n: study(goals=[{"type": "limit", "expression": f"k+{i}", "at_least": 1} for i in range(n // 6)]),
    "unknown names in limits": lambda n: study(goals=[{"type": "limit", "expression": far(i), "at_least": 1} for i in range(n // 6)]),
    "bands apart": lambda n: study(goals=[avoid(i) for i in range(n // 6)]),
    "bands that overlap": lambda n: study(goals=[avoid(i * 1e-3) for i in range(n // 6)]),
    "bands again and again": lambda n: study(goals=[avoid(0)] * (n // 6)),
    "a catalogue": lambda n: study(variables=[{"parameter": "k", "catalogue": [50 + i * 1e-3 for i in range(2 * n)]}]),
    "a catalogue of one value": lambda n: study(variables=[{"parameter": "k", "catalogue": [100] * (2 * n)}]),
    "a catalogue upside down": lambda n: study(variables=[{"parameter": "k", "catalogue": [50 - i * 1e-6 for i in range(n)]}]),
    "references": lambda n: study(references={name(i): {"modes": [{"frequency_hz": 1}]} for i in range(n // 3)}),
    "a reference of many modes": lambda n: study(references={"r": {"modes": [{"frequency_hz": 1 + i} for i in range(n)]}}),
    "published": lambda n: study(published=[{"parameter": name(i), "value": 1, "tolerance": 1} for i in range(n // 4)]),
    "unknown published": lambda n: study(published=[{"parameter": far(i), "value": 1, "tolerance": 1} for i in range(n // 4)]),
    "objectives": lambda n: study(objective=[{"minimise": f"k+{i}"} for i in range(n // 3)]),
    "patterns of mass": lambda n: study(objective={"minimise": "mass", "of": ["a*" * 20 + "b"] * (n // 4)}),
    
    "bands in one goal": lambda n: study(goals=[avoid(0, bands_hz=[[10 + i, 10.5 + i] for i in range(n)])]),
    "bands of one goal that overlap": lambda n: study(goals=[avoid(0, bands_hz=[[10 + i * 1e-4, 10.5 + i * 1e-4] for i in range(n)])]),
    "bands upside down": lambda n: study(goals=[avoid(0, bands_hz=[[10 + n - i, 10.5 + n - i] for i in range(n)])]),
    "orders of a machine": lambda n: study(goals=[{"type": "avoid", "configurations": ["c"], "machine": {
        "speed_range_hz": [1, 2], "orders": [f"{1 + i}E" for i in range(n)], "margin_percent": 1}}]),
    "gears with sidebands": lambda n: study(goals=[{"type": "avoid", "configurations": ["c"], "machine": {
        "speed_hz": 1, "orders": ["1E"], "margin_percent": 1e-6,
        "gears": [{"teeth": 20, "ratio": 1, "orders": ["1G"], "sidebands": 1000000000}]}}]),
    "gears": lambda n: study(goals=[{"type": "avoid", "configurations": ["c"], "machine": {
        "speed_hz": 1, "orders": ["1E"], "margin_percent": 1, "gears": [{"teeth": 20 + i, "ratio": 1, "orders": ["1G"], "sidebands": 20} for i in range(n // 8)]}}]),
    "harmonics of a rotor": lambda n: study(goals=[{"type": "avoid", "configurations": ["c"], "rotor": {
        "speed_hz": 4, "blades": 4, "harmonics": [f"{1 + i}P" for i in range(n)], "margin_percent": 1}}]),
    "steps of a catalogue": lambda n: study(variables=[{"parameter": "k", "catalogue": {"step": 1e-300, "lower": 50, "upper": 200}}]),
    "a wide catalogue": lambda n: study(variables=[{"parameter": "k", "catalogue": {"series": "E192", "lower": 1e-300, "upper": 1e300}}]),
    "trade of many values": lambda n: study(trade={"vary": [{"variable": "k", "bound": "upper", "values": {"from": 100, "to": 200, "count": 2147483647}}],
                                                   "objectives": ["change"]}),
    "trade of a long list": lambda n: study(trade={"vary": [{"variable": "k", "bound": "upper", "values": [100 + i for i in range(n)]}] * 2,
                                                   "objectives": ["change"]}),
    "starts": lambda n: study(search={"starts": 2147483647, "max_evaluations": 2147483647}),
    "recommendations": lambda n: study(recommendations=2147483647),
}

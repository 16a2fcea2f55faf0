# SPDX-License-Identifier: GPL-3.0-or-later
"""Random questions asked of a model. Demands are taken from a design within the bounds (then there is an answer) or moved away from it."""
import itertools
import math

import numpy as np

import models
from question import Question

SLIVER = 1.002  # a band of less than a thousandth is no question


def _round(value, digits=5):
    return float(f"{value:.{digits}g}")


def _variables(rng, model, most=5, where=None):
    """Bounds about the original values: around it, with it on an edge, or beside it."""
    names = [n for n, p in model["parameters"].items() if isinstance(p["value"], float)]
    rng.shuffle(names)
    place = where or rng.choice(["inside", "inside", "inside", "mixed", "edge", "outside"])
    out = []
    for name in names[:rng.randint(1, most)]:
        value, wide = model["parameters"][name]["value"], rng.choice([1.3, 2.0, 2.0, 4.0])
        if name == "a":
            out.append({"parameter": "a", "lower": 0, "upper": 1} if rng.random() < 0.5 else {"parameter": "a", "lower": 0.05, "upper": 0.95})
            continue
        how = rng.choice(["inside", "edge"]) if place == "mixed" else place
        low, high = {"inside": (1 / wide, wide), "edge": rng.choice([(1.0, wide), (1 / wide, 1.0)]),
                     "outside": rng.choice([(1.1, 1.1 * wide), (0.9 / wide, 0.9)])}[how]
        exact = how == "edge"
        item = {"parameter": name, "lower": value * low if exact else _round(value * low),
                "upper": value * high if exact else _round(value * high)}
        if rng.random() < 0.25:
            item["weight"] = rng.choice([0.25, 2, 4])
        out.append(item)
    return out


def _study(model, variables, goals, objective=None, **more):
    study = {"format": "modetune-study/1", "name": model["name"], "model": "model.json", "variables": variables, "goals": goals,
             "recommendations": 40, **more}
    if objective is not None:
        study["objective"] = objective
    return study


def _inner(rng, question):
    """A design within the bounds."""
    return np.array([[rng.choice(list(v.values)) if v.values is not None else v.x(v.t(v.lower) + rng.random() * (v.t(v.upper) - v.t(v.lower)))
                      for v in question.variables]])


def _probe(model, variables, configuration):
    """A question with nothing asked, to look at frequencies."""
    return Question(model, {"variables": variables, "goals": [
        {"type": "frequency", "mode": 1, "configuration": configuration, "at_least_hz": 0.001}]})


def _configuration(rng, model):
    names = list(model.get("configurations", {}))
    return rng.choice(names) if names else "default"


def _named(goal, model, configuration):
    return {**goal, "configuration": configuration} if "configurations" in model else goal


def _modes(probe, x, configuration):
    hz = probe.frequencies(x, configuration)[0]
    return hz[np.isfinite(hz) & (hz > 0.0)]


def _objective(rng, model, variables):
    name = rng.choice(variables)["parameter"]
    expressions = [f"{name}", f"-{name}", f"{name}^2+1", "+".join(v["parameter"] for v in variables)]
    one = [{"minimise": "change"}, {"minimise": "mass"}, {"minimise": rng.choice(expressions)}]
    kind = rng.random()
    if kind < 0.45:
        return None
    if kind < 0.85:
        return rng.choice(one)
    return rng.sample(one, 2)


def _frequency_goals(rng, model, variables, kinds):
    configuration = _configuration(rng, model)
    probe = _probe(model, variables, configuration)
    x = _inner(rng, probe)
    now, goals, twisted = _modes(probe, x, configuration), [], rng.random() < 0.25
    for mode in sorted(rng.sample(range(1, len(now) + 1), min(len(now), rng.randint(1, max(1, min(3, len(variables))))))):
        hz = now[mode - 1] * (rng.uniform(0.7, 1.4) if twisted else 1.0)
        goal = _named({"type": "frequency", "mode": mode}, model, configuration)
        kind = rng.choice(kinds)
        if kind == "target":
            goal["target_hz"] = _round(hz, 8 if not twisted else 4)
        elif kind == "least":
            goal["at_least_hz"] = _round(hz * 0.995)
        elif kind == "most":
            goal["at_most_hz"] = _round(hz * 1.005)
        else:
            goal["at_least_hz"], goal["at_most_hz"] = _round(hz * 0.99), _round(hz * 1.01)
        goals.append(goal)
    return goals


def _limit(rng, model, variables):
    """On a sum or a product of two parameters, met by half of the designs or so."""
    a, b = rng.choice(variables)["parameter"], rng.choice(variables)["parameter"]
    text = rng.choice([f"{a}+{b}", f"{a}*{b}", f"{a}-0.5*{b}"])
    question = Question(model, {"variables": variables, "goals": [{"type": "limit", "expression": text, "at_least": 0}]})
    value = float(question.rows(_inner(rng, question))[0][3][0]) * -1.0
    return {"type": "limit", "expression": text, rng.choice(["at_least", "at_most"]): _round(value)}


def _bands(rng, model, variables, count=None):
    configuration = _configuration(rng, model)
    probe = _probe(model, variables, configuration)
    sample = np.concatenate([_inner(rng, probe) for _ in range(20)])
    hz = probe.frequencies(sample, configuration)
    hz = hz[np.isfinite(hz) & (hz > 0.0)]
    bands = []
    for _ in range(count or rng.randint(1, 3)):
        middle, wide = rng.choice(list(hz)), rng.choice([0.02, 0.05, 0.1, 0.2])
        bands.append([_round(middle * (1 - wide)), _round(middle * (1 + wide))])
    if rng.random() < 0.08:
        bands.append([0, _round(min(hz) * rng.uniform(0.8, 1.05))])
    goal = _named({"type": "avoid", "bands_hz": bands}, model, configuration)
    if rng.random() < 0.5:
        goal["margin_percent"] = rng.choice([2, 5, 10])
    if rng.random() < 0.15:
        goal["up_to_hz"] = _round(max(b[1] for b in bands) * rng.uniform(0.7, 1.2))
        margin = 1.0 - goal.get("margin_percent", 0) / 100.0  # a band cut off below its base: cases/cut_off_within_a_margin.json; a sliver is doubted
        if all(b[0] * margin >= goal["up_to_hz"] for b in bands) or any(b[0] * margin < goal["up_to_hz"] <= b[0] * SLIVER for b in bands):
            del goal["up_to_hz"]
    if "configurations" in model and rng.random() < 0.4:
        del goal["configuration"]
        goal["configurations"] = list(model["configurations"])
    return goal


def _catalogues(rng, variables, model, few=6):
    for item in variables:
        if item["parameter"] == "a":
            continue
        low, high = item.pop("lower"), item.pop("upper")
        count = rng.randint(2, few)
        item["catalogue"] = sorted({_round(low * (high / low) ** (i / (count - 1)), 3) for i in range(count)})
    return variables


def targets(rng):
    model = models.MAKERS[rng.choice(list(models.MAKERS))](rng)
    variables = _variables(rng, model)
    return model, _study(model, variables, _frequency_goals(rng, model, variables, ["target"]), rng.choice([None, None, {"minimise": "mass"}]))


def limits(rng):
    model = models.MAKERS[rng.choice(list(models.MAKERS))](rng)
    variables = _variables(rng, model)
    goals = _frequency_goals(rng, model, variables, ["target", "least", "most", "range"])
    goals += [_limit(rng, model, variables)] if rng.random() < 0.5 else []
    return model, _study(model, variables, goals, _objective(rng, model, variables))


def corner(rng):
    """Originals on bounds or outside them."""
    model = models.MAKERS[rng.choice(list(models.MAKERS))](rng)
    variables = _variables(rng, model, where=rng.choice(["edge", "mixed", "outside"]))
    goals = _frequency_goals(rng, model, variables, ["target", "target", "least", "most"])
    return model, _study(model, variables, goals, rng.choice([None, None, None, {"minimise": "mass"}]))


def pairs(rng):
    """Ratios of modes, also between configurations, and modes that are apart: of a design within the bounds, or off it."""
    model = models.MAKERS[rng.choice(list(models.MAKERS))](rng)
    variables = _variables(rng, model)
    configuration, other = _configuration(rng, model), _configuration(rng, model)
    probe = _probe(model, variables, configuration)
    x = _inner(rng, probe)
    now, beside = _modes(probe, x, configuration), _modes(_probe(model, variables, other), x, other)
    goals, off = [], rng.uniform(0.8, 1.25) if rng.random() < 0.25 else 1.0
    for _ in range(rng.randint(1, 2)):
        high = rng.randint(1, len(now))
        low = rng.choice([m for m in range(1, len(beside) + 1) if m != high or configuration != other] or [0])
        if low == 0 or rng.random() < 0.4:
            if len(now) < 2:
                continue
            few = sorted(rng.sample(range(1, len(now) + 1), min(len(now), rng.choice([2, 2, 3]))))
            goal = {"type": "apart", "modes": few} if rng.random() < 0.6 else {"type": "apart", "up_to_mode": few[-1]}
            own = [now[m - 1] for m in goal.get("modes", range(1, few[-1] + 1))]
            gap = min(b - a for a, b in zip(own, own[1:])) if rng.random() < 0.4 else None
            part = min(100.0 * (b / a - 1.0) for a, b in zip(own, own[1:]))
            if min(gap or 1.0, part) < 1e-3:
                continue
            goal.update({"at_least_percent": _round(part * off)} if gap is None else {"at_least_hz": _round(gap * off)})
        else:
            goal = {"type": "ratio", "mode": high, "of": {"mode": low} if configuration == other else {"mode": low, "configuration": other}}
            ratio, kind = now[high - 1] / beside[low - 1] * off, rng.choice(["target", "at_least", "at_most", "range"])
            goal.update({"at_least": _round(ratio * 0.99), "at_most": _round(ratio * 1.01)} if kind == "range" else {kind: _round(ratio, 8)})
        goals.append(_named(goal, model, configuration))
    goals = goals or _frequency_goals(rng, model, variables, ["least", "most"])
    return model, _study(model, variables, goals, _objective(rng, model, variables))


def bands(rng):
    model = models.MAKERS[rng.choice(["chain", "chain", "shaft", "truss", "loaded", "beads", "hanging"])](rng)
    variables = _variables(rng, model)
    goals = [_bands(rng, model, variables)]
    if rng.random() < 0.3:
        goals += _frequency_goals(rng, model, variables, ["least", "most", "range", "target"])[:1]
    if rng.random() < 0.2:
        goals.append(_limit(rng, model, variables))
    objective = {"maximise": "clearance"} if rng.random() < 0.2 else _objective(rng, model, variables)
    if isinstance(objective, list) and rng.random() < 0.3:
        objective[rng.randrange(2)] = {"maximise": "clearance"}
    return model, _study(model, variables, goals, objective)


def catalogue(rng):
    model = models.MAKERS[rng.choice(list(models.MAKERS))](rng)
    variables = _catalogues(rng, [v for v in _variables(rng, model, 4, "inside") if v["parameter"] != "a"] or
                            _variables(rng, {**model, "parameters": {k: v for k, v in model["parameters"].items() if k != "a"}}, 2, "inside"), model)
    if rng.random() < 0.5:
        goals = [_bands(rng, model, variables)]
    else:
        goals = _frequency_goals(rng, model, variables, ["least", "most", "range"])
    return model, _study(model, variables, goals, _objective(rng, model, variables))


def mixed(rng):
    """Catalogues beside continuous variables."""
    model = models.MAKERS[rng.choice(models.UNLOADED)](rng)
    variables = _variables(rng, model, 4, "inside")
    chosen = [v for v in variables if v["parameter"] != "a"][:max(1, len(variables) // 2)]
    _catalogues(rng, chosen, model, 4)
    goals = [_bands(rng, model, variables)] if rng.random() < 0.4 else _frequency_goals(rng, model, variables, ["target", "least", "most"])[:1]
    return model, _study(model, variables, goals)


def branched(rng):
    """Catalogues beside continuous variables, with more combinations than are enumerated."""
    model = models.MAKERS[rng.choice(models.UNLOADED)](rng)
    variables = _variables(rng, model, 4, "inside")
    while sum(v["parameter"] != "a" for v in variables) < 2:
        variables = _variables(rng, model, 4, "inside")
    chosen = [v for v in variables if v["parameter"] != "a"][:-1][:3]
    each = {1: 401, 2: 21, 3: 8}[len(chosen)]
    for item in chosen:
        low, high = item.pop("lower"), item.pop("upper")
        item["catalogue"] = sorted({_round(low * (high / low) ** (i / (each + 1)), 5) for i in range(each + 2)})
    goals = [_bands(rng, model, variables)] if rng.random() < 0.4 else _frequency_goals(rng, model, variables, ["target", "least", "most"])[:1]
    return model, _study(model, variables, goals, _objective(rng, model, variables))


def rows(rng):
    """Catalogues of parts: variables of the kinds above are chosen together, by rows."""
    maker, few = rng.choice([(catalogue, 40), (catalogue, 40), (mixed, 12), (branched, 500)])
    model, study = maker(rng)
    while not any("catalogue" in v for v in study["variables"]):
        model, study = maker(rng)
    items = [v for v in study["variables"] if "catalogue" in v]
    rest = [v for v in study["variables"] if "catalogue" not in v]
    rng.shuffle(items)
    middle = rng.randint(0, len(items) - 1)
    tables, chosen = {}, []
    for group in [g for g in (items[:middle], items[middle:]) if g]:
        values = [g["catalogue"] for g in group]
        every = list(itertools.product(*values)) if math.prod(map(len, values)) <= 5000 else [
            tuple(rng.choice(v) for v in values) for _ in range(5000)]
        every = list(dict.fromkeys(every))
        picked = rng.sample(every, min(len(every), rng.randint(2, few) if maker is not branched else few))
        name, columns = f"part_{len(tables)}", [f"c{i}" for i in range(len(group))]
        parameters = [g["parameter"] for g in group]
        tables[name] = {"columns": columns, "rows": [list(row) for row in picked]}
        if rng.random() < 0.5:  # a column that nobody reads
            tables[name] = {"columns": ["price", *columns], "rows": [[i, *row] for i, row in enumerate(picked)]}
        if rng.random() < 0.5:
            tables[name]["names"] = [f"no. {i}" for i in range(len(picked))]
        by_order = rng.random() < 0.5 and tables[name]["columns"] == columns
        chosen.append({"catalogue": name, "parameters": parameters if by_order else dict(zip(columns, parameters))})
        if "weight" in group[0] and rng.random() < 0.5:
            chosen[-1]["weight"] = group[0]["weight"]
    study["catalogues"], study["variables"] = tables, rng.sample(chosen + rest, len(chosen + rest))
    return model, study


def _without_kinks(rng, model):
    """min and max put the worst between the corners, where brute force does not look."""
    for item in model["bodies"] + model.get("springs", []):
        for member, value in item.items():
            if isinstance(value, str) and value.startswith(("min(", "max(", "(min(", "(max(")):
                item[member] = rng.choice([n for n in model["parameters"] if n in value])
    return model


def tolerance(rng):
    model = _without_kinks(rng, models.MAKERS[rng.choice(["chain", "shaft", "truss", "beads", "hanging"])](rng))
    variables = _variables(rng, model, 4, "inside")
    for item in rng.sample(variables, rng.randint(1, len(variables))):
        item["tolerance_percent"] = rng.choice([1, 2, 5])
    if rng.random() < 0.5:
        goals = [_bands(rng, model, variables, 1)]
    else:
        goals = _frequency_goals(rng, model, variables, ["least", "most"])
        for goal in goals:  # room for the tolerances, mostly
            for member, factor in (("at_least_hz", 0.95), ("at_most_hz", 1.05)):
                if member in goal:
                    goal[member] = _round(goal[member] * factor)
    if rng.random() < 0.3:
        goals.append(_limit(rng, model, variables))
    return model, _study(model, variables, goals)


def trade(rng):
    model, study = rng.choice([limits, bands])(rng)
    values = []
    if rng.random() < 0.5 and study["variables"]:
        item = rng.choice(study["variables"])
        values = [_round(item["upper"] * f) for f in (1.0, 1.1, 1.3)]
        study["trade"] = {"vary": [{"variable": item["parameter"], "bound": "upper", "values": values}]}
    else:
        index = rng.randrange(len(study["goals"]))
        goal = study["goals"][index]
        member = next(m for m in ("target_hz", "at_least_hz", "at_most_hz", "at_least", "at_most", "margin_percent")
                      if m in goal or (m == "margin_percent" and goal["type"] == "avoid"))
        values = [1, 3, 6] if member == "margin_percent" else [_round(goal[member] * f) for f in (0.97, 1.0, 1.02)]
        study["trade"] = {"vary": [{"goal": index, "member": member, "values": values}]}
    study["recommendations"] = 3
    return model, study


def misfit(rng):
    model = models.MAKERS[rng.choice(["chain", "shaft", "truss", "beads"])](rng)
    variables = _variables(rng, model)
    goals = _frequency_goals(rng, model, variables, ["target"])
    for goal in goals:
        goal["weight"] = rng.choice([1, 1, 2, 10])
        goal["target_hz"] = _round(goal["target_hz"] * rng.uniform(0.97, 1.03))
    if rng.random() < 0.3:
        goals.append(_limit(rng, model, variables))
    return model, _study(model, variables, goals, {"minimise": "misfit"})


def driven(rng):
    model = models.arm(rng)
    variables = _variables(rng, model, 4, "inside")
    goal = _bands(rng, model, variables, 1)
    goal.pop("configuration", None)
    goal["configurations"] = list(model["configurations"])
    return model, _study(model, variables, [goal])


def infeasible(rng):
    """Demands that no design meets: beyond what the mode can reach, or two that contradict each other."""
    model = models.MAKERS[rng.choice(list(models.MAKERS))](rng)
    variables = _variables(rng, model)
    configuration = _configuration(rng, model)
    probe = _probe(model, variables, configuration)
    hz = probe.frequencies(np.concatenate([_inner(rng, probe) for _ in range(30)]), configuration)
    modes = int(np.sum(np.isfinite(hz[0])))
    mode = rng.randint(1, modes)
    low, high = hz[:, mode - 1].min(), hz[:, mode - 1].max()
    kind = rng.choice(["least", "most", "target", "both"])
    goals = [_named({"type": "frequency", "mode": mode}, model, configuration)]
    if kind == "least":
        goals[0]["at_least_hz"] = _round(high * rng.choice([1.02, 1.2, 3]))
    elif kind == "most":
        goals[0]["at_most_hz"] = _round(low * rng.choice([0.3, 0.8, 0.98]))
    elif kind == "target":
        goals[0]["target_hz"] = _round(high * rng.choice([1.02, 1.5]))
    else:
        goals[0]["at_least_hz"] = _round(high * 0.99)
        goals.append(_named({"type": "frequency", "mode": 1, "at_most_hz": _round(hz[:, 0].min() * 1.01)}, model, configuration))
    return model, _study(model, variables, goals)


def zero(rng):
    """A spring that is 0 in the original, or whose lower bound is 0: the rank of K changes within the bounds."""
    model = models.MAKERS[rng.choice(["chain", "shaft"])](rng)
    for spring in model["springs"]:  # what has no value or no slope at 0 is refused
        for member, value in spring.items():
            if isinstance(value, str) and ("sqrt" in value or "/" in value):
                spring[member] = rng.choice([n for n in model["parameters"] if n.startswith("k")])
    name = rng.choice([n for n in model["parameters"] if n.startswith("k")])
    variables = [v for v in _variables(rng, model, 4, "inside") if v["parameter"] != name]
    value = model["parameters"][name]["value"]
    if rng.random() < 0.6:
        model["parameters"][name]["value"] = 0.0
    variables.append({"parameter": name, "lower": 0, "upper": _round(2 * value)})
    if rng.random() < 0.4:
        variables = variables[-1:]
    if rng.random() < 0.6:
        goals = [_bands(rng, model, variables)]
    else:
        goals = _frequency_goals(rng, model, variables, ["least", "most", "range", "target"])
    return model, _study(model, variables, goals)


KINDS = {f.__name__: f for f in (targets, limits, pairs, corner, bands, catalogue, mixed, branched, rows, tolerance, trade, misfit, driven, infeasible, zero)}

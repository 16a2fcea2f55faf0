# SPDX-License-Identifier: GPL-3.0-or-later
"""Odd results: what a shipped study answers, changed to what an answer could be at its edges. Each is a result.json that the
program reads, and the page is the one that `report` makes of it."""
import copy
import os
import random

# What must stay text, wherever a file may bring it.
TEXTS = {
    "script": "</script><script>window.broken = 1</script>",
    "comment": "<!-- <script> --><img src=x onerror='window.broken = 1'>",
    "quotes": "\"'`${window.broken = 1}\\",
    "lines": "one\u2028two\u2029three",
    "bidi": "left\u202eright\u2066\u200f",
    "long": "a_very_long_name_" * 20,
    "wide": "\u6a5f\u68b0\u5b66" * 12 + " \U0001f681",
    "percent": "100 % &amp; &lt;b&gt; %s %n",
}
EVERY = "MT_EVERY" in os.environ
TINY, HUGE = 5e-324, 1.7976931348623157e308


def designs(result):
    """All of them, the original first."""
    points = (result["trade"] or {}).get("points") or []
    return [result["baseline"], *result["recommendations"], *[p["best"] for p in points if p["best"]]]


def rename_parameter(result, at, name):
    old = result["variables"][at]
    result["variables"][at] = name
    for item, member in [(u, "components") for u in result["undetermined"]] + [(r, "design") for r in result["relaxations"]]:
        item[member] = {name if k == old else k: v for k, v in item[member].items()}
    for design in designs(result):
        for p in design["parameters"]:
            p["name"] = name if p["name"] == old else p["name"]
        for item in design["frequencies"] + design["goals"]:
            for member in ("sensitivity", "worst_at"):
                if isinstance(item.get(member), dict):
                    item[member] = {name if k == old else k: v for k, v in item[member].items()}
        for b in (design["tolerance_box"] or {}).get("per_variable") or []:
            b["name"] = name if b["name"] == old else b["name"]


def rename_configurations(result, text):
    """Each gets the text, and stays one of its own."""
    names = {}
    for design in designs(result):
        for f in design["frequencies"]:
            names.setdefault(f["configuration"], f"{text} {len(names) + 1}")
    def walk(node):
        if isinstance(node, dict):
            for key, value in node.items():
                if key == "configuration" and value in names:
                    node[key] = names[value]
                elif key == "configurations" and isinstance(value, list):
                    node[key] = [names.get(v, v) for v in value]
                else:
                    walk(value)
        elif isinstance(node, list):
            for value in node:
                walk(value)
    walk(result)


def walked(node, change):
    """Each member of an object that is no list or object becomes change(key, value)."""
    for key, value in list(node.items()) if isinstance(node, dict) else enumerate(node):
        if isinstance(value, (dict, list)):
            walked(value, change)
        else:
            node[key] = change(key, value)


SAID = {"text", "band", "label", "source", "edge", "status_text", "drive", "message"}


def texts(result, text):
    """Everything that a file may name, or say in words."""
    for at in range(len(result["variables"])):
        rename_parameter(result, at, f"{text}{at}")
    rename_configurations(result, text)
    walked(result, lambda key, value: text if key in SAID and isinstance(value, str) else value)
    result["study"]["name"] = text
    result["warnings"] = [text] * 3
    for design in designs(result):
        for f in design["frequencies"]:
            f["name"] = text if f["name"] else f["name"]
        for p in design["parameters"]:
            p["unit"] = text[:40]
    curve_texts(result, text)
    for e in result["excitations"]:
        e["name"] = text
        for order in e["orders"]:
            order["label"] = text


def numbers(result, factor):
    """All numbers of designs by a factor, kept finite."""
    def scaled(value):
        if isinstance(value, bool) or not isinstance(value, (int, float)) or value == 0:
            return value
        x = float(value) * factor
        return max(-HUGE, min(HUGE, x)) if abs(x) >= TINY else TINY
    for design in designs(result):
        walked(design, lambda _, value: scaled(value) if isinstance(value, float) else value)


EDGES = ("lower_hz", "upper_hz", "margin_lower_hz", "margin_upper_hz", "frequency_hz")


def nulls(result):
    """Every number that may be missing is."""
    for design in designs(result):
        walked(design, lambda key, value: None if isinstance(value, float) and key not in EDGES else value)


def zeros(result):
    for design in designs(result):
        walked(design, lambda _, value: 0.0 if isinstance(value, float) else value)


def no_design(result):
    result.update(recommendations=[], status="infeasible", trade=None)


def one_design(result):
    result["recommendations"] = result["recommendations"][:1]


def many_designs(result, count):
    first = result["recommendations"][-1]
    dice = random.Random(1)
    for rank in range(len(result["recommendations"]) + 1, count + 1):
        design = copy.deepcopy(first)
        design.update(rank=rank, change=first["change"] * (1 + rank / 10), score=first["score"] and first["score"] * (1 + rank / 10))
        for p in design["parameters"]:
            p["recommended"] *= dice.uniform(0.5, 2)
        result["recommendations"].append(design)


def many_parameters(result, count):
    for i in range(len(result["variables"]), count):
        result["variables"].append(f"extra_{i}")
        for design in designs(result):
            p = copy.deepcopy(design["parameters"][0])
            p["name"] = f"extra_{i}"
            design["parameters"].append(p)
            for item in design["frequencies"] + design["goals"]:
                if isinstance(item.get("sensitivity"), dict):
                    item["sensitivity"][f"extra_{i}"] = 0.01 * i


def many_modes(result, count):
    for design in designs(result):
        last = design["frequencies"][-1]
        for i in range(len(design["frequencies"]), count):
            f = copy.deepcopy(last)
            f.update(mode=last["mode"] + i, recommended_hz=(last["recommended_hz"] or 1) + i, original_hz=(last["original_hz"] or 1) + i)
            design["frequencies"].append(f)


def interrupted(result):
    result.update(status="interrupted", status_text="Interrupted: the best so far.", undetermined=None, spread=None, certificates=None,
                  relaxations=None, published=None, trade=None)
    result["run"]["incomplete"] = ["search", "certificates"]


def infeasible(result):
    for design in result["recommendations"]:
        design.update(feasible=False, grade="compromise", violation_percent=123456.789)
        for goal in design["goals"]:
            goal.update(met=False)
    result.update(status="compromise", status_text="Compromise: nothing meets all goals.")


def profile(result):
    """All curves are under a profile, with a step and a tone that is a line; their answers are there."""
    for curve in result["curves"]:
        curve["profile"] = {"file": "floor.json", "name": None, "rms": 2.5, "sigma": 3.0, "rule": "sum", "densities": [
            {"frequency_hz": [10.0, 40.0, 40.0, 300.0], "level": [0.1, 0.4, 2.0, 0.01]}], "tones": [
            {"tone": "4P", "lower_hz": 17.0, "upper_hz": 17.5, "level": 2.0}, {"tone": "50 Hz", "lower_hz": 50.0, "upper_hz": 50.0, "level": 1.0}]}
    for design in designs(result):
        for curve in design["curves"]:
            curve["vibration"] = {"end": "finite", "proven": True, "rms": 3.5, "rms_error_at_most": 1e-12, "sine": 9.0, "peak": 19.5, "tones": [
                {"tone": "4P", "frequency_hz": 17.5, "peak": 8.0, "excess_at_most": 1e-12, "at_edge": True},
                {"tone": "50 Hz", "frequency_hz": 50.0, "peak": 1.0, "excess_at_most": None, "at_edge": True}]}


def measured(result):
    for curve in result["curves"]:
        curve["measured"] = {"frequency_hz": [20.0, 30.0, None, 1e9], "magnitude": [1.0, 1e300, 2.0], "phase_deg": [1e9, None, 3.0, 4.0], "psd": []}


def drawn(result, change):
    """Lists of what is drawn of a response, at all designs."""
    for design in designs(result):
        for curve in design["curves"]:
            change(curve, curve["drawn"])


def infinite(curve, points):
    for e in curve["extremes"]:
        e.update(kind="resonance", magnitude=None) if e["kind"] == "peak" else None


def first_only(curve, points):
    for key in points:
        points[key] = points[key][:1]


def unlike(curve, points):
    points["magnitude"] = points["magnitude"][:3]
    points["phase_deg"] = [None] * len(points["phase_deg"])


def huge_range(curve, points):
    n = len(points["magnitude"])
    points["magnitude"] = [10.0 ** (-300 + 600 * i / max(1, n - 1)) for i in range(n)]


def largest(curve, points):
    n = len(points["magnitude"])
    points["magnitude"] = [1e308 if i % 3 else 1.7e308 for i in range(n)]


def ends_of_range(curve, points):
    n = len(points["magnitude"])
    points["magnitude"] = [(5e-324, 1e308, 1.0)[i % 3] for i in range(n)]


def trouble(curve, points):
    curve.update(trouble="a motion grows by itself here", extremes=[], vibration=None)
    for key in points:
        points[key] = []


def curve_texts(result, text):
    profile(result)
    for curve in result["curves"]:
        curve.update(input=text, output=text, unit=text, output_unit=text, description=text)
        curve["profile"].update(name=text, file=text)
        for tone in curve["profile"]["tones"]:
            tone["tone"] = text


KINDS = {f"text_{name}": (lambda r, t=text: texts(r, t)) for name, text in TEXTS.items()}
KINDS.update({
    "tiny": lambda r: numbers(r, 1e-300), "huge": lambda r: numbers(r, 1e300), "small": lambda r: numbers(r, 1e-9),
    "large": lambda r: numbers(r, 1e9), "negative": lambda r: numbers(r, -1.0), "nulls": nulls, "zeros": zeros,
    "no_design": no_design, "one_design": one_design, "hundred_designs": lambda r: many_designs(r, 100),
    "thousands_of_designs": lambda r: many_designs(r, 3000 if EVERY else 1000), "hundreds_of_parameters": lambda r: many_parameters(r, 300),
    "many_modes": lambda r: many_modes(r, 120), "interrupted": interrupted, "infeasible": infeasible,
})
# Of results that have curves.
CURVES = {f"curve_{change.__name__}": (lambda r, c=change: (profile(r), drawn(r, c))) for change in
          (infinite, first_only, unlike, huge_range, largest, ends_of_range, trouble)}
CURVES.update({"profile": profile, "measured": measured, "curve_text_script": lambda r: texts(r, TEXTS["script"]), "curve_text_long": lambda r: texts(r, TEXTS["long"]),
               "curve_negative": lambda r: (profile(r), numbers(r, -1.0)), "curve_large": lambda r: (profile(r), numbers(r, 1e9)),
               "curve_zeros": lambda r: (profile(r), zeros(r)), "curve_nulls": lambda r: (profile(r), nulls(r))})
KINDS.update(CURVES)


def made(kind, result):
    """A copy of the result, changed."""
    changed = copy.deepcopy(result)
    KINDS[kind](changed)
    changed["run"]["outputs"] = []  # a copy that stands alone
    return changed

# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults planted in results: each must be found by the check that is for it. A planter changes the result and returns True, or
returns False where the study offers no place for its fault."""
import math
import re


def _first(result):
    return next((r for r in result["recommendations"] if r["feasible"]), None)


def _frequency(run):
    """Of the highest: modes near 0 are compared in its measure."""
    found = [f for f in run.result["recommendations"][0]["frequencies"] if f["recommended_hz"]] if run.result["recommendations"] else []
    if found:
        max(found, key=lambda f: f["recommended_hz"])["recommended_hz"] *= 0.999999
    return bool(found)


def _clearance(run):
    best = _first(run.result)
    if best is None or not best["clearances"]:
        return False
    best["clearances"][0]["percent"] += 0.01
    return True


def _gap(run):
    best = _first(run.result)
    if best is None or not best["gap_assignment"]:
        return False
    best["gap_assignment"][0]["modes_below"] += 1
    return True


def _least_clearance(run):
    best = _first(run.result)
    if best is None or best["clearance_percent"] is None:
        return False
    best["clearance_percent"] += 0.1
    return True


def _violation(run):
    best = run.result["recommendations"][0] if run.result["recommendations"] else None
    if best is None or len(run.study["goals"]) != 1 or len(best["goals"]) != 1 or not best["goals"][0]["violation_percent"]:
        return False
    if best["goals"][0]["violation_percent"] < 1.0:
        return False
    best["goals"][0]["violation_percent"] *= 0.99
    return True


def _called_feasible(run):
    if run.result["status"] in ("solved", "fitted") or not run.result["recommendations"] or len(run.study["goals"]) != 1:
        return False
    run.result["recommendations"][0]["feasible"] = True
    return True


def _score(run):
    best = _first(run.result)
    if best is None or not best["score"]:
        return False
    best["score"] *= 1.0001
    return abs(best["score"]) > 1e-1


def _second_objective(run):
    best = _first(run.result)
    if best is None or len(best["objectives"]) < 2 or not best["objectives"][1]["recommended"]:
        return False
    best["objectives"][1]["recommended"] *= 1.001
    return abs(best["objectives"][1]["recommended"]) > 1.0


def _ranks(run):
    good = [r for r in run.result["recommendations"] if r["feasible"] and r["score"] is not None]
    if len(good) < 2 or abs(good[0]["score"] - good[1]["score"]) < 1e-2 * abs(good[1]["score"]):
        return False
    recs = run.result["recommendations"]
    recs[0], recs[1] = recs[1], recs[0]
    recs[0]["rank"], recs[1]["rank"] = 1, 2
    return True


def _bound(run):
    for p in run.result["recommendations"][0]["parameters"] if run.result["recommendations"] else []:
        if p["at_bound"] == "upper":
            p["recommended"] = math.nextafter(p["recommended"], math.inf)
            return True
    return False


def _catalogue(run):
    for p, v in zip(run.result["recommendations"][0]["parameters"], run.question.variables):
        if v.values is not None:
            p["recommended"] *= 1.0 + 1e-15
            return p["recommended"] not in v.values
    return False


def _slope(run):
    best = _first(run.result)
    for f in best["frequencies"] if best else []:
        if f["sensitivity"] and not f["repeated"] and f["recommended_hz"]:
            name = max(f["sensitivity"], key=lambda n: abs(f["sensitivity"][n] or 0.0) * abs(
                next(p["recommended"] for p in best["parameters"] if p["name"] == n)))
            if f["sensitivity"][name] and abs(f["sensitivity"][name]) > 1e-9:
                f["sensitivity"][name] *= 1.01
                return True
    return False


def _second_best(run):
    good = [r for r in run.result["recommendations"] if r["feasible"] and r["score"] is not None]
    if len(good) < 2 or abs(good[0]["score"] - good[1]["score"]) < 1e-2 * abs(good[1]["score"]):
        return False
    del run.result["recommendations"][0]
    run.result["recommendations"][0]["rank"] = 1
    return True


def _not_found(run):
    if run.result["status"] not in ("solved", "fitted") or run.question.n == 0:
        return False
    run.result["status"] = "compromise"
    for r in run.result["recommendations"]:
        r["feasible"] = False
    return True


def _false_proof(run):
    if run.result["status"] not in ("solved", "fitted"):
        return False
    run.result["certificates"].append({"kind": "infeasible", "text": "No design meets all goals.", "proven": True, "pointer": None,
                                       "reachable_lower_hz": None, "reachable_upper_hz": None})
    return True


def _range(run):
    for c in run.result["certificates"]:
        found = re.search(r"stays between ([\d.e+-]+) and ([\d.e+-]+) Hz", c["text"])
        if found and c["proven"] and c["kind"] == "range" and float(found[2]) > 1.2 * float(found[1]):
            middle = f"{math.sqrt(float(found[1]) * float(found[2])):.6g}"
            c["text"] = c["text"].replace(found[2], middle)
            c["reachable_upper_hz"] = float(middle) if c["reachable_upper_hz"] is not None else None
            return True
    return False


def _assignment(run):
    for c in run.result["certificates"]:
        found = re.match(r"Of (\d+) mode placements (\d+) can be met", c["text"])
        if found and c["proven"] and int(found[2]) > 1 and len(run.result["recommendations"]) == int(found[2]):
            c["text"] = c["text"].replace(f" {found[2]} can", f" {int(found[2]) - 1} can", 1)
            del run.result["recommendations"][0]
            return True
    return False


def _box(run):
    for r in run.result["recommendations"]:
        box = r["tolerance_box"]
        if r["feasible"] and box and box["proven"] and box["all_percent"] and 0.2 < box["all_percent"] < 20.0 and box["edge"] and "edge of" in box["edge"]:
            box["all_percent"] *= 3.0
            return True
    return False


def _price(run):
    best = _first(run.result)
    for i, reason in enumerate([r["text"] for r in best["reasons"]] if best else []):
        found = re.match(r"((?:Relaxing goal|A target) .* would reduce .* by )(\d[\d.]*)( .*)", reason)
        if found and float(found[2]) > 1e-3 and "from" not in found[1]:
            best["reasons"][i]["text"] = f"{found[1]}{1.2 * float(found[2]):.3g}{found[3]}"
            return True
    return False


def _free_direction(run):
    if run.result["status"] != "solved" or not any("target_hz" in g and "weight" not in g for g in run.study["goals"]) or run.question.n != 1:
        return False
    name = run.question.variables[0].name
    run.result["undetermined"] = [{"direction": name, "effect_percent": 0, "components": {name: 1.0}}]
    return True


def _sentence(run):
    best = run.result["recommendations"][0] if run.result["recommendations"] else None
    for i, reason in enumerate([r["text"] for r in best["reasons"]] if best else []):
        found = re.match(r"(\w+ (?:rises|falls) by )(\d[\d.]*)( %.*)", reason)
        if found and float(found[2]) > 1.0:
            best["reasons"][i]["text"] = f"{found[1]}{1.05 * float(found[2]):.3g}{found[3]}"
            return True
    return False


def _sampled(run):
    if not any(c["kind"] == "infeasible" and c["proven"] for c in run.result["certificates"]):
        return False
    run.result["status"] = "compromise"
    run.result["status_text"] = "Compromise: no design found meets all goals (sampled, not proven)."
    return True


def _count(run):
    for c in run.result["certificates"]:
        found = re.match(r"Enumerated: all (\d+) combinations of catalogue values were judged, (\d+) of them", c["text"])
        if found and all(v.values is not None for v in run.question.variables):
            c["text"] = c["text"].replace(f"judged, {found[2]} of", f"judged, {int(found[2]) + 1} of")
            return True
    return False


def _point(run):
    for point in (run.result["trade"] or {"points": []})["points"]:
        if point["status"] in ("solved", "fitted") and point["best"]["score"] and abs(point["best"]["score"]) > 0.1:
            point["best"]["score"] *= 1.001
            return True
    return False


# (fault, kinds of studies to look in, the check that must find it)
def _doubt(run):
    run.result["doubts"].append({"kind": "margin", "text": "margin_percent 5 is next to nothing"})
    return True


def _written(run, name, old, new):
    """As if the program had written so; another run may share the words."""
    texts = dict(run.words.texts)
    texts[name] = texts[name].replace(old, new, 1)
    found, run.words = texts != run.words.texts, type(run.words)(str(run.words), texts)
    return found


def _word(run):
    return _written(run, "result.json", "null", "nan")


def _cell(run):
    return _written(run, "report.html", '<td class="n">', '<td class="n">nan ')


def _beside_mark(run):
    for rec in run.result["recommendations"]:
        for p, variable in zip(rec["parameters"], run.question.variables):
            if rec["feasible"] and variable.values is None and variable.log and p["recommended"] == variable.original != 0.0:
                p["recommended"] *= 1.0 + 1e-14
                return True
    return False


FAULTS = [
    (_word, ["limits"], "numbers"), (_cell, ["limits"], "numbers"),
    (_doubt, ["limits"], "undoubted"),
    (_frequency, ["limits", "bands"], "frequencies"), (_clearance, ["bands"], "clearances"), (_gap, ["bands"], "clearances"),
    (_least_clearance, ["bands"], "clearances"), (_violation, ["infeasible", "limits"], "goals"),
    (_called_feasible, ["infeasible", "limits"], "goals"), (_called_feasible, ["infeasible", "limits"], "consistent"),
    (_score, ["limits", "bands"], "scores"), (_second_objective, ["limits", "bands"], "scores"), (_ranks, ["bands"], "scores"), (_bound, ["limits", "bands"], "bounds"), (_beside_mark, ["bands", "limits"], "marks"),
    (_catalogue, ["catalogue"], "bounds"), (_slope, ["limits"], "slopes"), (_second_best, ["bands"], "optimum"),
    (_not_found, ["limits", "bands", "catalogue"], "optimum"), (_false_proof, ["limits", "bands"], "certificates"),
    (_false_proof, ["limits"], "consistent"), (_range, ["limits", "targets", "infeasible"], "certificates"),
    (_assignment, ["bands"], "certificates"), (_box, ["bands"], "tolerance_boxes"), (_price, ["limits", "targets"], "prices"),
    (_free_direction, ["targets", "limits"], "undetermined"), (_sentence, ["limits"], "reasons"), (_sampled, ["infeasible"], "consistent"),
    (_count, ["catalogue"], "enumerated"), (_point, ["trade"], "trade"),
]

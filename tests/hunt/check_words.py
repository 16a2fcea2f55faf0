# SPDX-License-Identifier: GPL-3.0-or-later
"""What is said beside the numbers: prices, undetermined directions, sentences; and that nothing contradicts anything else."""
import copy
import re
import sys
from decimal import Decimal
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).resolve().parents[1] / "cli"))  # where outputs are looked at
import search
from common_words import problems_of
from check_numbers import design_of, near
from question import Question

NUMBER = r"([-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?)"
PRICE = 0.03     # of a price: three digits, beside what the curve within the step leaves open
PRICES = 2       # of one design that are looked at
STEP = 1e-3      # of what a demand gives way by, in percent of itself


def _best(run):
    feasible = [r for r in run.result["recommendations"] if r["feasible"]]
    return feasible[0] if feasible else None


def _cost_with(run, study, start):
    """Cost of the best design near `start` for a changed study; None where the search finds nothing feasible."""
    question = Question(run.model, study)
    x = search.Local(question, np.clip(start, question.lower, question.upper)).run()
    cost, missed = float(question.cost(x[None, :])[0]), float(question.missed_robustly(x[None, :])[0])
    return cost if missed <= 1.0 else None


def _slopes(run, change, start):
    """How much is saved per 1 % that a demand gives way, measured to both sides: change(study, fraction) moves it. The slope of a curve, also where a bound lets go, lies between."""
    costs = []
    for fraction in (STEP, -STEP):
        study = copy.deepcopy(run.study)
        change(study, fraction)
        costs.append(_cost_with(run, study, start))
    if None in costs:
        return None
    run.here = _cost_with(run, run.study, start) if run.here is None else run.here
    here = run.here
    own = float(run.question.cost(start[None, :])[0])
    if here is None or abs(here - own) > 1e-5 * max(abs(own), 1e-3):
        return None  # the design is no optimum: "optimum" says so
    up, down = (here - costs[0]) / (100.0 * STEP), (costs[1] - here) / (100.0 * STEP)
    if abs(up - down) > 0.1 * max(abs(up), abs(down)):
        return None  # a kink: another constraint takes over
    return np.array(sorted((up, down)))


def _goal_mover(index, text, sense):
    def change(study, fraction):
        goal = study["goals"][index]
        members = [m for m in ("target_hz", "target", "equals", "at_least_hz", "at_least_percent", "at_least", "at_most_hz", "at_most") if m in goal]
        member = members[0]
        if member in ("target_hz", "target", "equals"):
            goal[member] *= np.exp(-sense * fraction) if member != "equals" else 1.0 - sense * fraction * np.sign(goal[member])
        else:
            goal[member] += (-1.0 if "least" in member else 1.0) * fraction * (abs(goal[member]) or 1.0)
    return change


def _bound_mover(variable, index, bound, amount):
    def change(study, fraction):
        if not variable.log:  # changes are measured as they were, not by the wider bounds
            study["variables"][index]["scale"] = variable.scale
        study["variables"][index][bound] += (1.0 if bound == "upper" else -1.0) * amount * 100.0 * fraction * 0.1
    return change


WORTH = r" would (?:reduce|raise) (?P<of>.*) by (?P<worth>[\d.]+(?:e[+-]?\d+)?)(?P<unit>.*)\.$"


def _worth(found, best):
    """What a price says in the objective's own measure: of the total change it is a percentage."""
    return float(found["worth"]) * (best["change"] / 100.0 if found["of"] == "the total change" else 1.0)


def prices(run):
    """By solving again with what has a price moved a little."""
    best, q = _best(run), run.question
    if best is None or run.study.get("trade") or any(v.values is not None for v in q.variables) or len(q.objectives) > 1 or q.robust:
        return
    start, told_of = design_of(q, best)[0], 0
    for reason in (r["text"] for r in best["reasons"]):
        if told_of == PRICES:
            return
        goal = re.match(r"Relaxing goal /goals/(?P<goal>\d+) \(.*\) by (?P<part>[\d.e-]+) %()" + WORTH, reason) or \
            re.match(r"A target (?P<part>[\d.e-]+) % (?P<way>lower|higher) in goal /goals/(?P<goal>\d+) \(.*\)" + WORTH, reason)
        bound = re.match(r"An? (?P<side>upper|lower) bound of (?P<name>\w+) that is " + NUMBER + r" ?(.*) (?:higher|lower)" + WORTH, reason)
        if goal:
            at, higher = int(goal["goal"]), goal.groupdict().get("way") == "higher"
            two = [m for m in run.study["goals"][at] if m.startswith("at_")]
            if len(two) > 1 or q.demands[[d[0] for d in q.demands].index(at)][1]["type"] == "avoid":
                continue
            if len(run.study["goals"][at].get("configurations", [1])) > 1:
                continue
            told = _worth(goal, best) / float(goal["part"])  # by 1 %
            slopes = _slopes(run, _goal_mover(at, reason, -1.0 if higher else 1.0), start)
        elif bound:
            index = [v.name for v in q.variables].index(bound["name"])
            told = _worth(bound, best)
            slopes = _slopes(run, _bound_mover(q.variables[index], index, bound["side"], float(bound[3])), start)
            slopes = None if slopes is None else 10.0 * slopes
        else:
            continue
        told_of += 1
        if slopes is None:
            continue
        room = PRICE * max(abs(told), *abs(slopes)) + 1e-7 * max(abs(best["score"] or 1.0), 1.0)
        if not slopes[0] - room <= told <= slopes[1] + room:
            yield f"\"{reason}\": solved again it is {slopes[0]} to {slopes[1]}"


def undetermined(run):
    """Crossing the bounds along the direction changes every goal by less than its tolerance, and by no more than told."""
    best, q = _best(run), run.question
    if best is None:
        return
    start = q.t(design_of(q, best))[0]
    lower, upper = q.t(q.lower[None, :])[0], q.t(q.upper[None, :])[0]
    for item in run.result["undetermined"]:
        d = np.array([item["components"][v.name] for v in q.variables], float)
        if not near(float(np.linalg.norm(d)), 1.0, 1e-6):
            yield f"{item['direction']}: the components are no unit vector: {d.tolist()}"
        moving = np.abs(d) > 1e-12
        with np.errstate(divide="ignore", invalid="ignore"):
            room = [np.where(d > 0, upper - start, start - lower)[moving] / np.abs(d[moving]),
                    np.where(d > 0, start - lower, upper - start)[moving] / np.abs(d[moving])]
        reach = [max(float(r.min()), 0.0) for r in room]
        if not all(np.isfinite(reach)):
            continue
        if sum(reach) <= 1e-9 * float(np.abs(upper - lower).max()):
            yield f"{item['direction']} is called undetermined and has no room within the bounds"
            continue
        steps = np.linspace(-reach[1], reach[0], 21)[:, None]
        x = q.x(start + steps * d)
        rows, here = q.rows(x), q.rows(q.x(start[None, :]))
        for (index, _, kind, value), own in zip(rows, here):
            if kind == "band":
                continue
            moved, tolerance = float(np.nanmax(np.abs(value - own[3]))), q.tolerance_of(q.goals[index])
            if moved > 1.05 * tolerance:
                yield f"{item['direction']} is called undetermined, but moves goal {index} by {100.0 * moved} %"
            elif item["effect_percent"] is not None and 100.0 * moved > 2.0 * item["effect_percent"] + 1e-6:
                yield f"{item['direction']}: effect {item['effect_percent']} %, but goal {index} moves by {100.0 * moved} %"
        if "weight" not in str(run.study["goals"]) and float(q.missed(x).max()) > 1.0 + 1.05:
            yield f"{item['direction']} is called undetermined, but goals are missed along it"


def _unit(text):
    """Of the last digit of a number as it is written."""
    return 10.0 ** Decimal(text).as_tuple().exponent


def reasons(run):
    """Percentages of sentences against the numbers of the same design."""
    for rec in [run.result["baseline"]] + run.result["recommendations"]:
        by_name = {p["name"]: p for p in rec["parameters"]}
        goals = {g["pointer"]: [h for h in rec["goals"] if h["pointer"] == g["pointer"]] for g in rec["goals"]}
        for reason in (r["text"] for r in rec["reasons"]):
            moved = re.match(r"(\w+) (rises|falls) by " + NUMBER + " %", reason)
            if moved and moved[1] in by_name:
                change = by_name[moved[1]]["change_percent"]
                if not near(abs(change), float(moved[3]), 6e-3) or (change > 0) != (moved[2] == "rises"):
                    yield f"rank {rec['rank']}: \"{reason}\", but it changes by {change} %"
            missed = re.match(r"Goal (/goals/\d+) \(.*\) is missed by " + NUMBER + " %", reason)
            if missed and not any(near(abs(g["violation_percent"]), float(missed[2]), 6e-3, 1e-9) for g in goals[missed[1]]
                                  if g["violation_percent"] is not None):
                yield f"rank {rec['rank']}: \"{reason}\", but goals say {goals[missed[1]]}"
            keeps = re.match(r"(\S+) mode (\d+) \(.* Hz\) keeps (?:only )?" + NUMBER + r" % (below|above) band", reason)
            if keeps and not any(c["configuration"] == keeps[1] and c["mode"] == int(keeps[2]) and c["side"] == keeps[4] and
                                 near(c["percent"], float(keeps[3]), 6e-3, 1e-9) for c in rec["clearances"]):
                yield f"rank {rec['rank']}: \"{reason}\" is in no clearance"
            stands = re.match(r"(\S+) mode (\d+) (?:moves|stays|comes).* Hz, " + NUMBER + r" % (below|above) its (target|lower|upper)", reason)
            if stands:
                f = [f for f in rec["frequencies"] if f["configuration"] == stands[1] and f["mode"] == int(stands[2])]
                limits = [{"target": g["target_hz"], "lower": g["at_least_hz"], "upper": g["at_most_hz"]}[stands[5]] for g in f]
                over = re.search(r"over the tolerances " + NUMBER + " to " + NUMBER + " Hz", reason)
                if over:  # the worst of them is what stands below or above
                    f = [{**g, "recommended_hz": float(over[1 if stands[4] == "below" else 2])} for g in f]
                away = [100.0 * (g["recommended_hz"] / limit - 1.0) for g, limit in zip(f, limits) if limit]
                read = 0.5 * _unit(over[1 if stands[4] == "below" else 2]) if over else 0.0  # Hz that the written number leaves open
                room = [6e-3 * max(abs(a), float(stands[3]), 1e-9) + 100.0 * read / limit for a, limit in zip(away, filter(None, limits))]
                if not any(abs(abs(a) - float(stands[3])) <= r and (a > 0) == (stands[4] == "above") for a, r in zip(away, room)):
                    yield f"rank {rec['rank']}: \"{reason}\", but it is {away} % away"


def consistent(run):
    """Status, grades, certificates and texts do not contradict each other."""
    result = run.result
    impossible = [c for c in result["certificates"] if c["kind"] == "infeasible" and c["proven"]]
    feasible = [r for r in result["recommendations"] if r["feasible"]]
    status, text = result["status"], result["status_text"] or ""
    if status in ("solved", "fitted") and run.question.n and not feasible:
        yield f"{status}, but nothing recommended is feasible"
    weighted = all("weight" in g for g in run.study["goals"]) and str(run.study.get("objective")).count("misfit") > 0
    if status == "fitted" and not weighted:
        yield "fitted, but not all goals are weighted"
    if status not in ("solved", "fitted") and feasible and not weighted:
        yield f"{status}, but rank {feasible[0]['rank']} is feasible"
    if impossible and feasible:
        yield f"\"{impossible[0]['text']}\", but rank {feasible[0]['rank']} is feasible"
    if impossible and status != "infeasible" and not ("proven" in text and "not proven" not in text):
        yield f"\"{impossible[0]['text']}\" (proven), but the status is {status}: {text}"
    if status == "infeasible" and not impossible and not any(
            c["proven"] and ("one of the" in c["text"] or "None of" in c["text"]) for c in result["certificates"]):
        yield f"infeasible without a certificate: {[c['text'] for c in result['certificates']]}"
    words = [text] + [s["text"] for r in result["recommendations"] for s in r["reasons"]] + [c["text"] for c in result["certificates"] if not c["proven"]]
    for sentence in words:
        if sentence.startswith(("Goals are judged", "All positions of a drive")):  # how the worst of one design is known
            continue
        if status == "infeasible" and re.search(r"sampled, not proven|others may exist", sentence):
            yield f"infeasible is proven, but \"{sentence}\""
        if re.search(r"\b(nan|inf|-nan)\b", sentence):
            yield f"\"{sentence}\""
    for rec in result["recommendations"]:
        if (rec["grade"] or "").startswith(("fitted", "local minimum", "not converged") if weighted else "feasible") != rec["feasible"]:
            yield f"rank {rec['rank']}: feasible {rec['feasible']}, grade \"{rec['grade']}\""
        if impossible and rec["grade"] == "compromise" and any(
                "not proven" in s["text"] and not s["text"].startswith("Goals are judged") for s in rec["reasons"]):
            yield f"rank {rec['rank']}: {rec['reasons']}"
    found = re.match(r"Solved: (\d+) ", text)
    if found and int(found[1]) < len(feasible):
        yield f"\"{text}\", but {len(feasible)} designs are listed"


FAR_TARGET = 100.0  # times away from where the mode is: a doubt, and right


def undoubted(run):
    """The studies here ask good questions of good models: none is doubted, but a target that is far away where a spring may become 0."""
    for doubt in run.result["doubts"]:
        far = re.match(r"\w+ " + NUMBER + " Hz is " + NUMBER + r" times (?:above|below) the original frequency, " + NUMBER + " Hz", doubt["text"])
        if doubt["kind"] == "target" and far:
            asked, times, hz = (float(x) for x in far.groups())
            ratio = max(asked / hz, hz / asked)
            if ratio >= FAR_TARGET and near(ratio, times, 6e-3) and any(near(f["original_hz"], hz, 1e-5) for f in run.result["baseline"]["frequencies"]):
                continue
        yield f"doubted: {doubt['kind']}: {doubt['text']}"


def numbers(run):
    """Everything that was written: what has no number has a word, an empty cell or null."""
    for name, text in {"standard error": str(run.words), **run.words.texts}.items():
        for problem in problems_of(text, name.rpartition(".")[2]):
            yield f"{name}: {problem}"


CHECKS = {"numbers": numbers, "undoubted": undoubted, "prices": prices, "undetermined": undetermined, "reasons": reasons, "consistent": consistent}

# SPDX-License-Identifier: GPL-3.0-or-later
"""What is said beside the best design: which single change lets a design exist, and that designs listed as distinct are."""
import copy
import math
import re

import numpy as np

import search
from check_numbers import design_of
from question import Question

LESS = 0.9   # of a move that is said to be the least
SURE = 0.05  # of the tolerance: a goal that is met by its tolerance alone asks for less of the move, too
SAME = 1e-7  # relative: scores that are one


def _moved(run, item, part=1.0):
    """The study with a bound or a goal's number moved by a part of the way; None: a band, or not so simple."""
    study = copy.deepcopy(run.study)
    here, there = item["from"], item["to"]
    to = there if part == 1.0 else here * (there / here) ** part if here * there > 0.0 else here + part * (there - here)
    _, what, index = item["pointer"].split("/")[:3]
    if item["kind"] == "bound":
        study["variables"][int(index)]["upper" if item["what"].startswith("upper") else "lower"] = to
        return study
    goal = study["goals"][int(index)]
    member = item["what"].split()[0]
    if item["kind"] != "goal" or member not in goal or len(goal.get("configurations", [1])) > 1:
        return None
    goal[member] = to
    return study


def _clear_with(run, item, x):
    """Does the design keep clear of the bands with one edge moved, and meet all other goals?"""
    q = run.question
    others = copy.deepcopy(run.study)
    others["goals"] = [g for g in others["goals"] if g["type"] != "avoid"]
    missed = float(Question(run.model, others).missed_robustly(x)[0])
    edge, configuration = item["what"].split()[0], re.search(r' in "([^"]*)"$', item["what"])[1]
    tolerance = max(q.tolerance_of(g) for g in q.goals if g["type"] == "avoid")
    for c in q.configurations:
        for band in q.bands[c]:
            band = copy.copy(band)
            if c == configuration and math.isclose(getattr(band, edge), item["from"], rel_tol=1e-9):
                setattr(band, edge, item["to"])
            corners = q.corners(x[0]) if q.robust else x
            if band.lower < band.upper:
                missed = max(missed, float(np.max(band.inside(q.frequencies(corners, c)))) / tolerance)
    return missed


def relaxations(run):
    """With the change that is named the design that is named meets all goals; and no design that brute force finds does with less of it."""
    for number, item in enumerate(run.result["relaxations"]):
        if run.result["status"] in ("solved", "fitted"):
            yield f"solved, but: {item['text']}"
        x = np.array([[item["design"][v.name] for v in run.question.variables]], float)
        if item["kind"] == "band":
            missed = _clear_with(run, item, x)
        else:
            study = _moved(run, item)
            if study is None:
                continue
            question = Question(run.model, study)
            missed = float(question.missed_robustly(x)[0])
            if np.any(x[0] < question.lower) or np.any(x[0] > question.upper):
                yield f"\"{item['text']}\": outside the bounds"
        if missed > 1.001:
            yield f"\"{item['text']}\": goals are missed by {missed} tolerances"
        less = _moved(run, item, LESS) if number == 0 and item["kind"] != "band" else None
        if less is not None:
            question = Question(run.model, less)
            x_less = search.samples(question, 500)
            at_once = question.missed_robustly(x_less)
            starts, _ = search.least_missed(question, x_less, at_once, 1)
            ends, missed, _ = search.descend(question, [np.clip(x[0], question.lower, question.upper), *starts])
            good = np.concatenate([x_less[at_once <= SURE], ends[missed <= SURE]])
            if len(good):
                yield f"\"{item['text']}\": {LESS} of it is enough, {good[0].tolist()}"


def distinct(run):
    """Two designs with the same score between which every design has that score are one, not two."""
    q = run.question
    listed = [r for r in run.result["recommendations"] if r["feasible"] and r["score"] is not None]
    for a, b in zip(listed, listed[1:]):
        if abs(a["score"] - b["score"]) > SAME * max(abs(a["score"]), 1e-3) or any(v.values is not None for v in q.variables):
            continue
        if a["gap_assignment"] != b["gap_assignment"]:
            continue
        ends = q.t(np.concatenate([design_of(q, a), design_of(q, b)]))
        between = q.x(ends[0] + np.linspace(0.0, 1.0, 9)[:, None] * (ends[1] - ends[0]))
        level = np.abs(q.objective(between) - a["score"]) <= 1e-6 * max(abs(a["score"]), 1e-3)
        if np.all(level) and np.all(q.missed_robustly(between) <= 1.0):
            yield f"ranks {a['rank']} and {b['rank']} are listed as distinct; all designs between them have the score {a['score']}"


CHECKS = {"relaxations": relaxations, "distinct": distinct}

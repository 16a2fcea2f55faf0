# SPDX-License-Identifier: GPL-3.0-or-later
"""Claims about all designs: that rank 1 is the best, that no design exists, ranges, assignments, tolerance boxes."""
import itertools
import math
import re

import numpy as np

import search
from check_numbers import design_of
from question import MANY_POSITIONS, Question

BETTER = 1e-4      # a design is better that much, relative (of at least FLOOR)
FLOOR = 2e-2
HELD = 1.01e-6     # of its value, or of one unit, an objective gives up for those behind it
SURE = 0.05        # of the tolerance: what a counterexample may miss
EXACT = 1e-3       # of the tolerance: a design that misses less gains nothing by it
SAMPLES = 1500
STARTS = 2
ENUMERATED = 20000  # combinations at most that are all judged


def _best(run):
    feasible = [r for r in run.result["recommendations"] if r["feasible"]]
    return feasible[0] if feasible else None


def _samples(run):
    """Designs all over the bounds, and by how many tolerances each misses."""
    if run.sampled is None:
        x = search.samples(run.question, SAMPLES)
        run.sampled = x, run.question.missed_robustly(x)
    return run.sampled


def _counterexamples(run):
    """Feasible designs found by brute force, with their cost: of the samples, and ends of local searches."""
    if run.found is None:
        q = run.question
        if all(v.values is not None for v in q.variables) and math.prod(len(rows) for _, rows in q.choices) <= ENUMERATED:
            x = search.combinations(q)
            missed = q.missed_robustly(x)
            run.found = x[missed <= SURE], q.cost(x[missed <= SURE])
        else:
            x, missed_there = _samples(run)
            starts, good = search.least_missed(q, x, missed_there, STARTS)
            own = [design_of(q, r)[0] for r in run.result["recommendations"][:2]]
            good = good[missed_there[good] <= SURE]
            ends, missed, cost = search.descend(q, own + list(starts))
            keep = missed <= SURE
            run.found = np.concatenate([ends[keep], x[good]]), np.concatenate([cost[keep], q.cost(x[good])])
    return run.found


def optimum(run):
    """Nothing feasible is better than rank 1; where something is feasible, the study is solved."""
    q, result = run.question, run.result
    if not q.goals or q.n == 0:
        return
    with np.errstate(all="ignore"):
        x, cost = _counterexamples(run)
    if len(x) == 0:
        return
    at = int(np.nanargmin(cost))
    best = _best(run)
    if best is None:
        yield f"{result['status']}, but {x[at].tolist()} meets all goals"
        return
    own = float(q.cost(design_of(q, best))[0])
    unit = 100.0 if "clearance" in q.objectives[0].values() else 1.0
    enough = own - BETTER * max(abs(own), FLOOR) - (HELD * max(abs(own), unit) if len(q.objectives) > 1 else 0.0)
    better, its = x[at], cost[at]
    if its < enough and q.missed_robustly(better[None, :])[0] > EXACT and any(v.values is None for v in q.variables):
        # a goal that the variables hardly move: the part of its tolerance that is missed buys much
        ends, missed, costs = search.descend(q, [better])
        better, its = ends[0], costs[0] if missed[0] <= EXACT else np.inf
    if its < enough and q.moving:  # beside what was looked at on the way?
        finer = Question(run.model, run.study, MANY_POSITIONS)
        its = its if finer.missed_robustly(better[None, :])[0] <= 1.0 else np.inf
    if its < enough:
        yield f"rank 1 has {q.objectives[0]} {own}, but {better.tolist()} has {its} (kkt {best['kkt_residual']})"


def enumerated(run):
    """Counts of an enumeration."""
    q = run.question
    for c in run.result["certificates"]:
        found = re.match(r"Enumerated: all (\d+) combinations of catalogue values were judged, (\d+) of them meet", c["text"])
        if found and all(v.values is not None for v in q.variables):
            x = search.combinations(q)
            good = int(np.sum(q.missed_robustly(x) <= 1.0))
            if (len(x), good) != (int(found[1]), int(found[2])):
                yield f"\"{c['text']}\": {good} of {len(x)}"
        if c["text"].startswith("None of the") and len(_counterexamples(run)[0]) and c["proven"]:
            yield f"\"{c['text']}\": {_counterexamples(run)[0][0].tolist()} does"


def certificates(run):
    """Proven: no sample, and no end of a local search, contradicts."""
    q, result = run.question, run.result
    proven = [c for c in result["certificates"] if c["proven"]]
    if not proven:
        return
    for c in proven:
        reach = re.search(r"(\S+) mode (\d+) stays between ([-\d.e+]+) and ([-\d.e+]+|inf) Hz", c["text"])
        if reach:
            hz = q.frequencies(_samples(run)[0], reach[1])[:, int(reach[2]) - 1]
            low, high = float(reach[3]), float(reach[4])
            if c["reachable_lower_hz"] is not None:
                low, high = c["reachable_lower_hz"], c["reachable_upper_hz"]
            hz = hz[np.isfinite(hz)]
            if len(hz) and (hz.min() < low * (1 - 1e-5) or hz.max() > high * (1 + 1e-5)):
                yield f"\"{c['text']}\": samples reach from {hz.min()} to {hz.max()}"
        elif c["kind"] == "infeasible":
            good = _counterexamples(run)[0]
            if len(good):
                yield f"\"{c['text']}\": {good[0].tolist()} meets all goals"
        elif c["kind"] == "gap_assignments":
            yield from _assignments(run, c)


def _assignments(run, certificate):
    """Every kind of a feasible design that brute force finds is among those that can be met; alone, they are all listed."""
    q = run.question
    good, _ = _counterexamples(run)
    x, missed = _samples(run)
    feasible = np.concatenate([x[missed <= SURE], good]) if len(good) else x[missed <= SURE]
    found = re.match(r"Of (\d+) mode placements (\d+) can be met (within the bounds|by catalogue values)?", certificate["text"])
    if not found:
        return
    kinds = {kind: design for design, kind in zip(feasible, q.kind(feasible))}
    if len(kinds) > int(found[2]):
        yield f"\"{certificate['text']}\": {len(kinds)} kinds are found, {list(kinds.items())[:9]}"
    listed = {tuple(g["modes_below"] for g in r["gap_assignment"]) for r in run.result["recommendations"]
              if r["feasible"] and r["gap_assignment"] is not None}
    if found[3] != "within the bounds" or int(found[2]) > run.study.get("recommendations", 5):
        return
    if len(listed) != int(found[2]):
        yield f"\"{certificate['text']}\": {len(listed)} kinds are listed"
    for kind, design in kinds.items():
        if kind not in listed:
            yield f"\"{certificate['text']}\": {design.tolist()} has {kind}"


def tolerance_boxes(run):
    """Within the box no mode enters a band (without its margin): corners and samples."""
    q = run.question
    for rec in run.result["recommendations"]:
        box = rec["tolerance_box"]
        if box is None or not rec["feasible"] or not box["proven"]:
            continue
        x = design_of(q, rec)[0]
        boxes = [(np.full(q.n, box["all_percent"] or 0.0), "all variables")]
        for i, item in enumerate(box["per_variable"]):
            if item["percent"] is not None:
                boxes.append((np.where(np.arange(q.n) == i, item["percent"], 0.0), item["name"]))
        for percent, what in boxes:
            if not percent.any():  # on an edge: the goal's tolerance counts
                continue
            part = np.minimum(percent / 100.0 * (1.0 - 1e-9), 0.999)
            signs = np.array(list(itertools.product((-1.0, 1.0), repeat=q.n))) if q.n <= 8 else np.zeros((0, q.n))
            inside = 2.0 * search._halton(60, q.n) - 1.0
            points = x * (1.0 + np.concatenate([signs, inside]) * part)
            with np.errstate(all="ignore"):
                hz = q.all_frequencies(points)
            for c in q.configurations:
                for band in q.bands[c]:
                    deep = np.max(band.inside(hz[c], base=True), axis=1)
                    if np.nanmax(deep) > 1e-7:
                        at = int(np.nanargmax(deep))
                        yield (f"rank {rec['rank']}: {what} may change by {percent.max()} % (proven), but at {points[at].tolist()} "
                               f"a mode is in the band {band.base}")


CHECKS = {"optimum": optimum, "enumerated": enumerated, "certificates": certificates, "tolerance_boxes": tolerance_boxes}

# SPDX-License-Identifier: GPL-3.0-or-later
"""Every number of a design, recomputed: frequencies, clearances, goals, objectives, bounds, ranks."""
import math

import numpy as np

from dense import RIGID

NEAR = 1e-7       # relative: frequencies of well-conditioned models of a few masses
FEW = 1.0         # of the greatest frequency: what a mode near 0 is compared at (the root of rounding)
SLACK = 1e-5      # relative, of what has a tolerance of its own
MARK = 3e-13      # of the bounds: nearer to the original value than this is rounding of a search
ROUNDING = 2e-16  # of the greatest eigenvalue: what the dense solve leaves open of each
SLOPE = 1e-4      # of a slope by differences, of the greatest slope of the mode


def near(a, b, tolerance=NEAR, scale=0.0):
    if a is None or b is None:
        return a is b
    return abs(a - b) <= tolerance * max(abs(a), abs(b), scale) + 1e-12


def same_hz(told, own, most):
    """A mode near 0 is compared at the root of rounding; the dense solve calls 0 what lies below the root of RIGID."""
    return near(told, own, scale=FEW * most) or (own == 0.0 and told is not None and 0.0 <= told <= math.sqrt(RIGID) * most)


def finite_max(hz):
    return hz.max(where=np.isfinite(hz), initial=0.0)


def design_of(question, recommendation):
    return np.array([[p["recommended"] for p in recommendation["parameters"]]], dtype=float)


def all_designs(result):
    return [result["baseline"]] + result["recommendations"]


def bounds(run):
    """Exactly within the bounds, a value or a row of the catalogue, and at_bound says so."""
    for rec in run.result["recommendations"]:
        design = np.array([p["recommended"] for p in rec["parameters"]], float)
        for first, rows in run.question.choices:
            if not np.any(np.all(rows == design[first:first + rows.shape[1]], axis=1)):
                yield f"rank {rec['rank']}: {design.tolist()} is no row of the catalogue from variable {first} on"
        for p, v in zip(rec["parameters"], run.question.variables):
            x = p["recommended"]
            if v.values is not None and not np.any(v.values == x):
                yield f"rank {rec['rank']}: {v.name} = {x!r} is not in the catalogue"
            if v.values is None and not v.lower <= x <= v.upper:
                yield f"rank {rec['rank']}: {v.name} = {x!r} is outside {v.lower!r} to {v.upper!r}"
            if v.values is None and p["at_bound"] != ("lower" if x == v.lower else "upper" if x == v.upper else None):
                yield f"rank {rec['rank']}: {v.name} = {x!r}: at_bound is {p['at_bound']}"
            if not near(p["original"], v.original):
                yield f"{v.name}: original {p['original']}, not {v.original}"
            change = 100.0 * (x - v.original) / abs(v.original) if v.original else None
            if not near(p["change_percent"], change, 1e-9, 1e-3):
                yield f"rank {rec['rank']}: {v.name} changes by {change} %, not {p['change_percent']}"


def frequencies(run):
    q = run.question
    for rec in all_designs(run.result):
        x = design_of(q, rec)
        for f in rec["frequencies"]:
            hz = q.frequencies(x, f["configuration"])[0]
            own = hz[f["mode"] - 1] if 0 < f["mode"] <= len(hz) else math.nan
            if f["recommended_hz"] is None:
                if math.isfinite(own):
                    yield f"rank {rec['rank']}: {f['configuration']} mode {f['mode']} has {own} Hz, not none"
            elif not same_hz(f["recommended_hz"], own, finite_max(hz)):
                yield f"rank {rec['rank']}: {f['configuration']} mode {f['mode']}: {f['recommended_hz']} Hz, dense solve {own}"


def clearances(run):
    q = run.question
    for rec in all_designs(run.result):
        x = design_of(q, rec)
        hz = {c: q.frequencies(x, c)[0] for c in q.configurations}
        least = math.inf
        for c in q.configurations:
            for band in q.bands[c]:
                least = min([least] + [band.clearance_percent(f) for f in hz[c][np.isfinite(hz[c])]])
        told = rec["clearance_percent"]
        if q.moving and told is not None and told <= least:  # the least on the way between two positions of a drive
            least = told
        if q.bands and math.isfinite(least) and told is not None and not near(told, least, SLACK, 1.0):
            yield f"rank {rec['rank']}: clearance {told} %, recomputed {least} %"
        for item in rec["clearances"]:
            modes = hz[item["configuration"]]
            own = modes[item["mode"] - 1] if item["mode"] <= len(modes) else math.nan
            if not same_hz(item["hz"], own, finite_max(modes)):
                yield f"rank {rec['rank']}: mode {item['mode']} beside {item['band']}: {item['hz']} Hz, dense solve {own}"
            percents = [band.clearance_percent(own) for band in q.bands[item["configuration"]]]
            if item["percent"] is None and any(math.isnan(p) for p in percents):
                continue  # at 0 Hz, infinitely far
            if not any(near(item["percent"], p, SLACK, 1.0) for p in percents):
                yield f"rank {rec['rank']}: mode {item['mode']} beside {item['band']}: {item['percent']} %, none of {percents}"
        bands = [(c, band) for c in q.configurations for band in q.bands[c]]
        gaps = rec["gap_assignment"] or []
        if gaps and len(gaps) == len(bands):
            for gap, (c, band) in zip(gaps, bands):
                edges = [gap["lower_hz"], gap["upper_hz"], gap["margin_lower_hz"], gap["margin_upper_hz"]]
                if not all(near(a, b) for a, b in zip(edges, [*band.base, band.lower, band.upper])):
                    yield f"rank {rec['rank']}: band {gap['band']} has the edges {edges}, not {[*band.base, band.lower, band.upper]}"
                elif gap["modes_below"] != int(band.below(hz[c][None, :])[0]):
                    yield f"rank {rec['rank']}: {gap['modes_below']} modes below {gap['band']}, not {int(band.below(hz[c][None, :])[0])}"


def goals(run):
    """met, feasible and violation_percent are those of the dense solve; of the worst corner where there are tolerances."""
    q = run.question
    for rec in all_designs(run.result):
        x = design_of(q, rec)
        if q.robust:
            x = q.within_tolerances(x[0])
        with np.errstate(all="ignore"):
            rows = q.rows(x)
        worst, met = 0.0, True
        for index, goal, c in q.demands:
            own = [r for r in rows if r[0] == index and r[1] == (c if goal["type"] != "limit" else None)]
            values = [np.abs(r[3]) if r[2] == "=" else np.maximum(r[3], 0.0) for r in own]
            violation = float(np.max([np.max(np.where(np.isnan(v), np.inf, v)) for v in values])) if values else 0.0
            percent = max([float(np.max(q.percent(index, r[2], r[3], q.frequencies(x, c) if c else None))) for r in own], default=0.0)
            told = [g for g in rec["goals"] if g["pointer"] == f"/goals/{index}" and (c is None or c in g["goal"].split())]
            told = [g for g in told if g["configuration"] == c] if goal["type"] in ("ratio", "apart") else told
            told = told or [g for g in rec["goals"] if g["pointer"] == f"/goals/{index}"]
            limit = q.tolerance_of(goal)
            if len(told) == 1 and math.isfinite(violation) and told[0]["violation_percent"] is not None:
                deep = q.robust and goal["type"] == "avoid" and violation > limit  # an enclosure may say more than the corners
                if not near(told[0]["violation_percent"], percent, 1e-4, 0.3) and len(own) == 1 and not deep:
                    yield f"rank {rec['rank']}: goal {index} ({told[0]['goal']}) is missed by {percent} %, not {told[0]['violation_percent']}"
            if abs(violation - limit) > 1e-3 * limit:
                for g in told[:1]:
                    if len(told) == 1 and g["met"] != (violation <= limit):
                        yield f"rank {rec['rank']}: goal {index} ({g['goal']}) is {'met' if g['met'] else 'missed'}, but misses by {100 * violation} %"
            if "weight" not in goal:
                worst, met = max(worst, violation), met and violation <= limit * 1.001
        if rec["feasible"] and not met:
            yield f"rank {rec['rank']} is called feasible and misses a goal by {100 * worst} %"
        if not rec["feasible"] and met and worst == 0.0 and float(q.missed(design_of(q, rec))[0]) == 0.0:
            yield f"rank {rec['rank']} is not called feasible and meets all goals"


def scores(run):
    q, result = run.question, run.result
    if q.n == 0:
        return
    for rec in all_designs(result):
        x = design_of(q, rec)
        with np.errstate(all="ignore"):
            change, score = float(q.change(x)[0]), float(q.objective(x)[0])
        if math.isfinite(change) and not near(rec["change"], change, 1e-6, 1e-3):
            yield f"rank {rec['rank']}: size of the redesign {rec['change']}, recomputed {change}"
        if len(rec["objectives"]) != len(q.objectives):
            yield f"rank {rec['rank']}: {len(rec['objectives'])} objectives, asked for {len(q.objectives)}"
        for k, told in enumerate(rec["objectives"]):
            for which, at in (("recommended", x), ("original", q.origin[None, :])):
                with np.errstate(all="ignore"):
                    value = float(q.objective(at, k)[0])
                if told[which] is not None and math.isfinite(value) and not near(told[which], value, 1e-6, 1e-2):
                    yield f"rank {rec['rank']}: {which} {told['text']} {told[which]}, recomputed {value}"
        if rec["score"] is not None and math.isfinite(score) and not near(rec["score"], score, 1e-6, 1e-2):
            yield f"rank {rec['rank']}: score {rec['score']}, recomputed {score}"
    ranks = [r["rank"] for r in result["recommendations"]]
    if ranks != list(range(1, len(ranks) + 1)):
        yield f"ranks are {ranks}"
    scored = [r["score"] for r in result["recommendations"] if r["feasible"] and r["score"] is not None]
    sign = -1.0 if "maximise" in q.objectives[0] else 1.0
    for a, b in zip(scored, scored[1:]):
        if sign * a > sign * b + 1e-5 * max(abs(a), abs(b), 1e-3):
            yield f"ranked by a score of {a} before {b}"
    if any(b["feasible"] and not a["feasible"] for a, b in zip(result["recommendations"], result["recommendations"][1:])):
        yield "a design that is not feasible ranks before one that is"


def slopes(run):
    """Sensitivities against central differences of the dense solve."""
    q = run.question
    for rec in run.result["recommendations"][:1]:
        x = design_of(q, rec)[0]
        step = 1e-5 * np.maximum(np.abs(x), 1e-3 * np.abs(q.upper - q.lower))
        points = np.concatenate([x + np.diag(step), x - np.diag(step)])
        for f in rec["frequencies"]:
            if f["sensitivity"] is None or f["repeated"]:
                continue
            hz = q.frequencies(points, f["configuration"])
            here = q.frequencies(x[None, :], f["configuration"])[0]
            others = np.delete(here, f["mode"] - 1)
            if np.any(np.abs(others - here[f["mode"] - 1]) < 1e-3 * here[f["mode"] - 1]):
                continue  # differences see two modes that change places
            slope = (hz[:q.n, f["mode"] - 1] - hz[q.n:, f["mode"] - 1]) / (2.0 * step)
            told = np.array([np.nan if v is None else v for v in f["sensitivity"].values()])
            scaled, scale = np.abs((slope - told) * x), max(np.abs(slope * x).max(), 1e-3 * here[f["mode"] - 1])
            rounding = ROUNDING * finite_max(here) ** 2 / here[f["mode"] - 1] * np.abs(x) / step
            if np.any(scaled > SLOPE * scale + rounding) and not _kinked(q, x):
                yield f"{f['configuration']} mode {f['mode']}: slopes {told.tolist()}, differences {slope.tolist()}"


def _kinked(q, x):
    """min and max have no slope where their arguments meet."""
    return any("min(" in str(i) or "max(" in str(i) for i in (q.model["bodies"], q.model["springs"] if "springs" in q.model else []))


def marks(run):
    """What stands within rounding of its original value or of a bound stands there."""
    q = run.question
    if q.n == 0:
        return
    originals, width = q.t(q.origin[None, :])[0], q.t(q.upper[None, :])[0] - q.t(q.lower[None, :])[0]
    for rec in run.result["recommendations"]:
        x = design_of(q, rec)
        t = q.t(x)[0]
        for i, variable in enumerate(q.variables):
            off = abs(t[i] - originals[i])
            if variable.values is None and x[0, i] != variable.original and off <= MARK * width[i]:
                yield f"rank {rec['rank']}: {variable.name} is {x[0, i]!r}, {off / width[i]:.1e} of its bounds beside its original {variable.original!r}"


CHECKS = {"bounds": bounds, "marks": marks, "frequencies": frequencies, "clearances": clearances, "goals": goals, "scores": scores, "slopes": slopes}

# SPDX-License-Identifier: GPL-3.0-or-later
"""What takes another run of the program: the same bytes for any number of workers, and every point of a trade study by itself."""
import copy

SAME = 1e-4  # of a score: two searches that started differently


def points(run):
    """[(study with the values of the point put in, point)]"""
    trade, out = run.result["trade"], []
    for point in (trade or {"points": []})["points"]:
        study = copy.deepcopy(run.study)
        for vary, value in zip(study.pop("trade")["vary"], point["values"]):
            if "variable" in vary:
                next(v for v in study["variables"] if v["parameter"] == vary["variable"])[vary["bound"]] = value
            else:
                study["goals"][vary["goal"]][vary["member"]] = value
        out.append((study, point))
    return out


def trade(run, solve):
    """solve(studies of the same model) -> results. Each point equals the study with its values; the better of two searches counts."""
    asked = points(run)
    if not asked:
        return
    for (study, point), (code, _, result) in zip(asked, solve(run.model, [s for s, _ in asked])):
        if result is None:
            if code != 2:
                yield f"point {point['values']}: exit code {code} by itself"
            continue
        if result["status"] != point["status"]:
            yield f"point {point['values']} is {point['status']}, by itself {result['status']}"
        best = result["recommendations"][0] if result["recommendations"] else None
        if best is None or result["status"] not in ("solved", "fitted") or point["status"] != result["status"] or best["score"] is None:
            continue
        sign = -1.0 if "maximise" in run.question.objectives[0] else 1.0
        if sign * point["best"]["score"] > sign * best["score"] + SAME * max(abs(best["score"]), 0.02):
            yield f"point {point['values']} has a score of {point['best']['score']}, by itself {best['score']}"
        if sign * point["best"]["score"] < sign * best["score"] - SAME * max(abs(best["score"]), 0.02):
            yield f"point {point['values']} has a score of {point['best']['score']}, but the study by itself finds only {best['score']}"


def same_bytes(folder, names, one, two):
    """Names of studies whose results differ between two folders of results."""
    for name in names:
        a, b = (folder / out / name / "result.json" for out in (one, two))
        if a.exists() != b.exists() or (a.exists() and a.read_bytes() != b.read_bytes()):
            yield name

#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Catalogues beside continuous variables by branch and bound, against all combinations one by one.

Random rows of masses with two or three catalogues and one or two continuous variables, bands, targets and limits, for the least change or the least of an
expression. What branch and bound says is the best of all must be: each value of the first catalogue is made a study of its own, whose combinations the program
enumerates (search/test_discrete has that against brute force). The suite has two of few combinations. MT_EVERY=1: ten of any size; MT_COUNT=N: so many (200 take ten minutes);
MT_SEED=S.

Few combinations are enumerated best first. Under "max_evaluations" all of them are judged: the list is the same without it, and no combination that was left out is
better than what is said of them.
"""
import json
import math
import random
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from suite import FEW, PROGRAM, SEED, SOURCE, count  # noqa: E402

import numpy as np

COUNT = count(0, every=6)  # 0: QUICK ones
QUICK = ((3,), (2,)) if FEW else ((2, 3), (1, 2, 4))  # seconds of one core; without and with lengths
SAME = 1e-5  # of the objectives of two searches that end at the same design


# A lever on the ground: its twist [N m/rad], its inertia [kg m^2], and a spring [N/m] at its arm to the first mass.
TWIST, INERTIA, ROD = 2.0, 0.02, 150.0


def chain(stiffness, arm=None):
    """Masses of 1 kg in a row, the first one on the ground, moving in x; with an arm, a lever beside it."""
    n = len(stiffness)
    model = {
        "format": "modetune-model/1", "dimension": 2,
        "parameters": {f"k{i}": k for i, k in enumerate(stiffness)},
        "bodies": [{"name": f"b{i}", "mass_kg": 1, "inertia_kg_m2": 1, "centre": [i + 1, 0]} for i in range(n)],
        "joints": [{"name": f"j{i}", "type": "prismatic", "bodies": ["ground", f"b{i}"], "at": [i + 1, 0], "axis": [1, 0]} for i in range(n)],
        "springs": [{"name": f"s{i}", "type": "axial", "bodies": ["ground" if i == 0 else f"b{i - 1}", f"b{i}"],
                     **({"at": [[0, 0], [1, 0]]} if i == 0 else {}), "stiffness_n_per_m": f"k{i}"} for i in range(n)],
        "configurations": {"held": {}},
    }
    if arm is not None:
        model["parameters"]["arm"] = arm
        model["bodies"].append({"name": "lever", "mass_kg": 1, "inertia_kg_m2": INERTIA, "centre": [0, 0]})
        model["joints"].append({"name": "hinge", "type": "revolute", "bodies": ["ground", "lever"], "at": [0, 0]})
        model["springs"] += [{"name": "twist", "type": "torsion", "bodies": ["ground", "lever"], "stiffness_n_m_per_rad": TWIST},
                             {"name": "rod", "type": "axial", "bodies": ["lever", "b0"], "at": [[0, "arm"], [1, "arm"]], "stiffness_n_per_m": ROD}]
    return model


def frequencies(stiffness, arm=None):
    n = len(stiffness)
    size = n if arm is None else n + 1
    k = np.zeros((size, size))
    for i, s in enumerate(stiffness):
        k[i, i] += s
        if i > 0:
            k[i - 1, i - 1] += s
            k[i - 1, i] -= s
            k[i, i - 1] -= s
    if arm is not None:
        turn = 1 / math.sqrt(INERTIA)  # the lever's coordinate, with a mass of 1
        longer = np.zeros(size)
        longer[0], longer[n] = 1, arm * turn
        k += ROD * np.outer(longer, longer)
        k[n, n] += TWIST * turn**2
    return np.sqrt(np.linalg.eigvalsh(k)) / (2 * math.pi)


def bands(rng, hz):
    middles = rng.sample(list(hz), rng.randint(1, 2))
    wide = rng.choice([0.03, 0.08, 0.15])
    return {"type": "avoid", "configurations": ["held"], "margin_percent": rng.choice([0, 5]),
            "bands_hz": sorted([round(m * (1 - wide), 6), round(m * (1 + wide), 6)] for m in middles)}


def question(rng, lever=False):
    """(model, study): more combinations than are enumerated, most of the time. With a lever the length of its arm has a catalogue, too."""
    n = rng.randint(3, 6)
    arm, arms = (round(rng.uniform(0.08, 0.3), 4), sorted({round(rng.uniform(0.05, 0.5), 4) for _ in range(rng.randint(4, 8))})) if lever else (None, [])
    stiffness = [round(math.exp(rng.uniform(-0.7, 0.7)) * 100, 3) for _ in range(n)]
    order = rng.sample(range(n), n)
    catalogues = rng.randint(2, min(3, n - 1))
    free = rng.randint(1, min(2, n - catalogues))
    variables, inside = [], list(stiffness)
    for place, i in enumerate(order[:catalogues + free]):
        low, high = stiffness[i] * rng.uniform(0.3, 0.9), stiffness[i] * rng.uniform(1.1, 3.0)
        if place < catalogues:
            count = rng.randint(20, 26) if catalogues == 2 else rng.randint(7, 12)
            values = sorted({round(rng.uniform(low, high), 3) for _ in range(count)})
            variables.append({"parameter": f"k{i}", "catalogue": values})
            inside[i] = rng.choice(values)
        else:
            variables.append({"parameter": f"k{i}", "lower": round(low, 3), "upper": round(high, 3)})
            inside[i] = rng.uniform(low, high)
    if lever:
        variables.insert(rng.randint(0, 1), {"parameter": "arm", "catalogue": arms})
    now, there = frequencies(stiffness, arm), frequencies(inside, rng.choice(arms) if lever else None)
    mode = rng.randint(1, len(now))
    goal = {"type": "frequency", "configuration": "held", "mode": mode}
    kind = rng.choice(["bands", "bands", "target", "limit", "limits"])
    if kind == "bands":
        goals = [bands(rng, now)]
    elif kind == "target":
        goals = [goal | {"target_hz": round(there[mode - 1], 6)}]
    elif kind == "limit":
        goals = [goal | {"at_least_hz" if there[mode - 1] > now[mode - 1] else "at_most_hz": round(there[mode - 1], 6)}]
    else:  # not all of these can be met
        goals = [goal | {"mode": 1, "at_least_hz": round(there[0], 6)}, goal | {"mode": len(now), "at_most_hz": round(there[-1], 6)}]
    study = {"format": "modetune-study/1", "model": "model.json", "variables": variables, "goals": goals}
    aim = rng.choice(["change", "sum", "weighted"])
    names = [v["parameter"] for v in variables]
    if aim != "change":
        study["objective"] = {"minimise": " + ".join(names if aim == "sum" else [f"{rng.randint(1, 9)}*{name}" for name in names])}
    return chain(stiffness, arm), study


def run(model, studies, *options):
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "model.json").write_text(json.dumps(model), encoding="utf-8")
        for i, study in enumerate(studies):
            Path(folder, f"s{i}.json").write_text(json.dumps(study), encoding="utf-8")
        names = [f"s{i}.json" for i in range(len(studies))]
        done = subprocess.run([PROGRAM, "run", "--quiet", "-o", "out", *options, *names], cwd=folder, capture_output=True, text=True, check=False)
        assert done.returncode in (0, 1), done.stderr
        return [json.loads(Path(folder, f"out/s{i}/result.json").read_text(encoding="utf-8")) for i in range(len(studies))]


def objective(study, result):
    """Of the best design; infinite where none meets the goals."""
    best = result["recommendations"][0] if result["recommendations"] else None
    if best is None or not all(g["met"] for g in best["goals"]):
        return math.inf
    if "objective" not in study:
        return best["change"]
    values = {p["name"]: p["recommended"] for p in best["parameters"]}
    return eval(study["objective"]["minimise"], {"__builtins__": {}}, values)


def pieces(study):
    first, rest = study["variables"][0], study["variables"][1:]
    return [dict(study, variables=[dict(first, catalogue=[value]), *rest]) for value in first["catalogue"]]


def combinations(study):
    return math.prod(len(v.get("catalogue", [0])) for v in study["variables"])


class Mixed(unittest.TestCase):
    def test_a_design_between_the_roundings(self):
        """Ten sizes each of three of six springs beside a fourth: steps to neighbours end 0.58 % above the best, which has its own values of two of them."""
        model = json.loads((SOURCE / "problems/six_masses.json").read_text(encoding="utf-8"))
        study = {
            "format": "modetune-study/1", "model": "model.json",
            "variables": [
                {"parameter": "k_1", "catalogue": [36000, 38000, 40000, 41000, 42500, 52000, 53000, 55000, 64000, 84000]},
                {"parameter": "k_2", "catalogue": [11000, 14000, 19000, 20500, 26500, 29000, 31000, 33000, 36500, 48500]},
                {"parameter": "k_3", "catalogue": [8000, 12000, 27500, 28000, 29500, 30500, 38500, 45000, 45500, 46000]},
                {"parameter": "k_4", "lower": 8000, "upper": 47000},
            ],
            "goals": [{"type": "avoid", "bands_hz": [[11.847732400984942, 14.347732400984942], [28.72538349812248, 33.72538349812248]], "margin_percent": 5, "up_to_hz": 60}],
            "objective": {"minimise": "k_1 + k_2 + k_3 + k_4"},
        }
        result, *others = run(model, [study, *pieces(study)[::5 if FEW else 1]])
        self.assertLess(objective(study, result), 88660)
        self.assertLessEqual(objective(study, result), min(objective(study, other) for other in others) * (1 + SAME))

    def check_all(self, indices, lever):
        branched = complete = 0
        for index in indices:
            model, study = question(random.Random(f"{SEED}:{index}"), lever)
            with self.subTest(seed=SEED, index=index):
                result, *others = run(model, [study, *pieces(study)])
                found = objective(study, result)
                want = min(objective(study, other) for other in others)
                text = next(c["text"] for c in result["certificates"] if c["kind"] == "enumeration")
                branched += "branch and bound excludes" in text
                complete += "excludes all others" in text
                self.assertTrue(found <= want * (1 + SAME), f"{found} found, {want} exists: {text}")
        self.assertGreater(branched, len(indices) // 2)
        self.assertGreater(complete, len(indices) // 2)

    def test_what_is_left_out_cannot_be_listed(self):
        rng, left_out, evaluations = random.Random(f"{SEED}:few"), 0, [0, 0]
        for case in range(10 * COUNT or (8 if FEW else 3)):
            model, study = question(rng, case % 4 == 3)
            while combinations(study) > 60:
                most = max((v for v in study["variables"] if "catalogue" in v), key=lambda v: len(v["catalogue"]))
                most["catalogue"].pop(rng.randrange(len(most["catalogue"])))
            study["recommendations"] = rng.choice([1, 3, 5])
            with self.subTest(seed=SEED, case=case):
                best, = run(model, [study], "--threads", "1", "--report", "none")
                whole, = run(model, [study | {"recommendations": 60, "search": {"max_evaluations": 10**8}}], "--report", "none")
                self.assertEqual(best["status"], whole["status"])
                got, all_of = ([r["score"] for r in result["recommendations"] if r["feasible"]] for result in (best, whole))
                self.assertEqual(len(got), min(len(all_of), study["recommendations"]))
                for a, b in zip(got, all_of):
                    self.assertLessEqual(a, b * (1 + SAME))
                evaluations[0] += best["run"]["evaluations"]
                evaluations[1] += whole["run"]["evaluations"]
                for told in (c for c in best["certificates"] if c["kind"] == "least_objective"):
                    found = re.match(r"No design of the (?:other (\d+) combinations|one other combination) meets all goals"
                                     r"(?: and has a (?:change|first objective) below ([\d.e+]+))?: proven by ", told["text"])
                    others, left_out = int(found[1] or 1), left_out + 1
                    self.assertTrue(told["proven"])
                    self.assertLess(others, combinations(study))
                    bound = float(found[2] or "inf")
                    self.assertLessEqual(sum(f < bound * (1 - SAME) for f in all_of), combinations(study) - others)
                    if math.isfinite(bound):
                        self.assertGreaterEqual(bound * (1 + 1e-3), got[-1])
                    else:
                        self.assertLessEqual(len(all_of), combinations(study) - others)
                if case < 3:
                    again, = run(model, [study], "--threads", "3", "--report", "none")
                    self.assertEqual(again["recommendations"], best["recommendations"])
                    self.assertEqual(again["run"]["evaluations"], best["run"]["evaluations"])
        self.assertGreater(left_out, 1)
        self.assertLess(evaluations[0], evaluations[1] / 2)

    def test_the_best_of_all_is_found(self):
        self.check_all(range(COUNT) or QUICK[0], False)

    def test_lengths_of_a_catalogue(self):
        """What shapes the geometry is divided first, until each box has one."""
        self.check_all(range(COUNT // 2 + 1) if COUNT else QUICK[1], True)


if __name__ == "__main__":
    unittest.main()

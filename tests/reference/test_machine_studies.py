#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Random machines beside a row of two masses, whose frequencies have a closed form: designs are clear of every order at every speed, no sampled
design that is clear changes less, where none is said to exist none is found, and lower bounds of 0 or above give one answer."""
import json
import math
import os
import random
import subprocess
import sys
import tempfile
from pathlib import Path

MODETUNE = os.environ["MODETUNE"]
SAMPLES = 100 if "MT_EVERY" in os.environ else 12
GUARD = 3e-6  # goals are met within 1e-4 % of an edge
ORDERS = (0.125, 0.5, 1, 1.5, 2, 2.5, 3, 4, 6, 7.333)
MODEL = {
    "format": "modetune-model/1", "dimension": 2,
    "bodies": [{"name": "a", "mass_kg": "m1", "centre": [1, 0]}, {"name": "b", "mass_kg": "m2", "centre": [2, 0]}],
    "joints": [{"name": "ra", "type": "pin-in-slot", "bodies": ["ground", "a"], "at": [1, 0], "axis": [1, 0]},
               {"name": "rb", "type": "pin-in-slot", "bodies": ["ground", "b"], "at": [2, 0], "axis": [1, 0]}],
    "springs": [{"name": "sa", "type": "axial", "bodies": ["ground", "a"], "at": [[0, 0], [1, 0]], "stiffness_n_per_m": "k1"},
                {"name": "sb", "type": "axial", "bodies": ["a", "b"], "at": [[1, 0], [2, 0]], "stiffness_n_per_m": "k2"}],
}
failures = []


def check(condition, text):
    if not condition:
        failures.append(text)
        print("FAILED:", text)


def frequencies(k1, k2, m1, m2):
    half = 0.5 * ((k1 + k2) / m1 + k2 / m2)
    product = k1 * k2 / (m1 * m2)
    upper = half + math.sqrt(max(half * half - product, 0.0))
    return [math.sqrt(product / upper) / (2 * math.pi), math.sqrt(upper) / (2 * math.pi)]


class Sample:
    def __init__(self, rng):
        self.m1, self.m2 = rng.uniform(1, 30), rng.uniform(1, 30)
        self.k1, self.k2 = 10 ** rng.uniform(3, 6), 10 ** rng.uniform(3, 7)
        self.low = rng.uniform(5, 30)
        self.high = self.low * rng.uniform(1.01, 3)
        self.margin = rng.choice([1, 5, 10])
        self.reach = rng.choice([1.3, 1e3, 1e4])  # bounds: from the original over it to the original times it
        orders = sorted(rng.sample(ORDERS, rng.randint(1, 5)))
        teeth, ratio, sidebands = rng.randint(5, 40), rng.choice([1, 0.5, 1.25]), rng.randint(0, 2)
        self.lines = orders + [(teeth * g + s) * ratio for g in (1, 2) for s in range(-sidebands, sidebands + 1)]
        self.machine = {"speed_range_hz": [self.low, self.high], "orders": [f"{o:g}E" for o in orders], "margin_percent": self.margin,
                        "gears": [{"teeth": teeth, "ratio": ratio, "orders": ["1G", "2G"], "sidebands": sidebands}]}

    def study(self, zero):
        bounds = [{"parameter": name, "lower": 0 if zero else k / self.reach, "upper": k * self.reach}
                  for name, k in (("k1", self.k1), ("k2", self.k2))]
        return {"format": "modetune-study/1", "name": "machine", "model": "../problems/p.json", "variables": bounds,
                "goals": [{"type": "avoid", "machine": self.machine}], "objective": {"minimise": "change"}}

    def clear(self, k1, k2):
        margin = self.margin / 100
        return all(not o * self.low * (1 - margin) * (1 + GUARD) < f < o * self.high * (1 + margin) * (1 - GUARD)
                   for f in frequencies(k1, k2, self.m1, self.m2) for o in self.lines)

    def solve(self, folder, zero):
        model = dict(MODEL, parameters={"k1": self.k1, "k2": self.k2, "m1": self.m1, "m2": self.m2})
        (folder / "problems" / "p.json").write_text(json.dumps(model))
        (folder / "studies" / "s.json").write_text(json.dumps(self.study(zero)))
        done = subprocess.run([MODETUNE, "run", "--quiet", "studies/s.json"], cwd=folder, capture_output=True, text=True)
        check(done.returncode in (0, 1), f"exit {done.returncode}: {done.stderr}")
        return json.loads((folder / "results" / "s" / "result.json").read_text())


def judge(sample, result, rng, name):
    told = sorted(o["order"] for o in result["excitations"][0]["orders"])
    check(all(abs(a - b) <= 1e-12 * b for a, b in zip(told, sorted(sample.lines))) and len(told) == len(sample.lines), f"{name}: orders {told}")
    if result["status"] != "solved":
        most = math.log(sample.reach)
        for _ in range(4000):
            k1, k2 = (k * math.exp(rng.uniform(-most, most)) for k in (sample.k1, sample.k2))
            if sample.clear(k1, k2):
                check(False, f"{name}: {result['status']}, but {k1:.9g}, {k2:.9g} is clear")
                break
        return math.nan
    best = result["recommendations"][0]
    k1, k2 = (p["recommended"] for p in best["parameters"])
    check(sample.clear(k1, k2), f"{name}: {frequencies(k1, k2, sample.m1, sample.m2)} meets an order")
    change = math.hypot(math.log(k1 / sample.k1), math.log(k2 / sample.k2))
    check(abs(change - best["change"]) <= 1e-9 * max(change, 1) or min(k1 / sample.k1, k2 / sample.k2) < 1e-3, f"{name}: a change of {change}")
    for _ in range(4000 if best["change"] > 0 else 0):
        size, angle = best["change"] * 0.99 * math.sqrt(rng.random()), rng.uniform(0, 2 * math.pi)
        a, b = size * math.cos(angle), size * math.sin(angle)
        if max(abs(a), abs(b)) <= math.log(sample.reach) and sample.clear(sample.k1 * math.exp(a), sample.k2 * math.exp(b)):
            check(False, f"{name}: a change of {size} is enough, not {best['change']}")
            break
    return best["change"]


rng = random.Random(12)
unsolved = 0
with tempfile.TemporaryDirectory() as name:
    folder = Path(name)
    for part in ("problems", "studies"):
        (folder / part).mkdir()
    for i in range(SAMPLES):
        sample = Sample(rng)
        change = judge(sample, sample.solve(folder, False), rng, f"sample {i}")
        unsolved += 1 if change != change else 0
        if sample.reach > 1e2 and change < 3:  # the bounds do nothing
            again = sample.solve(folder, True)["recommendations"][0]["change"]
            check(abs(again - change) <= 1e-8 * max(change, 1), f"sample {i}: {change} with lower bounds above 0, {again} with 0")
check(0 < unsolved < SAMPLES, f"some samples have a design, some have none: {unsolved} of {SAMPLES}")
sys.exit(1 if failures else 0)

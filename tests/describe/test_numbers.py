# SPDX-License-Identifier: GPL-3.0-or-later
"""
Every number of a result, computed once more from the model and the design alone: two masses on springs and a damper, whose parameters are
shown in other units than SI, under goals of every kind of number, met and missed, feasible or not, weighted, with tolerances, as a trade study.
A number of result.json that no rule below computes fails; tables of the text and CSV files say the same numbers.
"""
import csv
import itertools
import json
import math
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np

PROGRAM = os.environ["MODETUNE"]
N_PER_MM = 1000.0
EPS = 2.0 ** -52
SMALL = 1e-9       # of computed numbers
SLOPE = 1e-5       # of slopes by differences
DIGITS = 6e-6      # of what tables say, in six digits

MODEL = {
    "format": "modetune-model/1", "name": "Two masses", "dimension": 2,
    "parameters": {"k1": {"value": 30, "unit": "N/mm"}, "k2": {"value": 10, "unit": "N/mm"}, "w": {"value": 1, "unit": "N/mm"}, "m": {"value": 1000, "unit": "g"},
                   "c": 80},
    "bodies": [{"name": n, "mass_kg": "m", "inertia_kg_m2": 1, "centre": [x, 0]} for n, x in (("a", 1), ("b", 2))],
    "joints": [{"name": "r" + n, "type": "prismatic", "bodies": ["ground", n], "at": [x, 0], "axis": [1, 0]} for n, x in (("a", 1), ("b", 2))],
    "springs": [{"name": "s1", "type": "axial", "bodies": ["ground", "a"], "at": [[0, 0], [1, 0]], "stiffness_n_per_m": "k1 + 1e-5*w"},
                {"name": "s2", "type": "axial", "bodies": ["a", "b"], "stiffness_n_per_m": "k2"}],
    "dampers": [{"name": "d", "type": "axial", "bodies": ["ground", "a"], "at": [[0, 0], [1, 0]], "damping_n_s_per_m": "c"}],
    "sensors": [{"name": n + i, "on": n, "directions": ["x"]} for n in "ab" for i in ("", "2")],
    "modes": {"first": {"configuration": "held", "index": 1}},
    "configurations": {"held": {}, "heavy": {"parameters": {"m": 4000}}}}
MASS = {"held": 1.0, "heavy": 4.0}
VARIABLES = [{"parameter": "k1", "lower": 3, "upper": 100}, {"parameter": "k2", "lower": 3, "upper": 40, "weight": 2}]
REFERENCE = {"test": {"modes": [{"frequency_hz": 13.5, "shape": {"a.x": 0.3, "b.x": 1}}, {"frequency_hz": 31, "shape": {"a.x": 1, "b.x": -0.25}}]}}
OTHER = {"other": {"modes": [{"frequency_hz": 7, "shape": {"b2.x": 1, "a2.x": 0.4, "a.x": 0.3}}, {"frequency_hz": 30, "shape": {"a.x": -1, "b2.x": 0.2, "b.x": 0.4}}]}}
GOALS = [{"type": "frequency", "configuration": "held", "mode": "first", "target_hz": 14},
         {"type": "frequency", "configuration": "heavy", "mode": 2, "at_least_hz": 10, "at_most_hz": 15},
         {"type": "mac", "configuration": "held", "mode": 1, "reference": "test", "at_least": 0.99},
         {"type": "limit", "expression": "k1 - 2*k2", "at_least": -10000, "at_most": 15000},
         {"type": "damping", "configuration": "held", "mode": 2, "at_least": 0.01, "at_most": 0.16},
         {"type": "response", "configuration": "held", "input": "base.x", "output": "b.x", "at_hz": 13, "at_most": 1e-3},
         {"type": "avoid", "configuration": "held", "bands_hz": [[20, 25]], "margin_percent": 3},
         {"type": "avoid", "configuration": "heavy", "bands_hz": [[30, 35]], "margin_percent": 5}]
BANDS = [{"type": "avoid", "configuration": "held", "bands_hz": [[32, 36]], "margin_percent": 3},
         {"type": "avoid", "configuration": "heavy", "bands_hz": [[5, 6], [16, 18]], "margin_percent": 5}]
FIT = [{"type": "frequency", "configuration": "held", "mode": 1, "reference": "test", "weight": 4},
       {"type": "frequency", "configuration": "held", "mode": 2, "reference": "test", "reference_mode": 2, "weight": 1},
       {"type": "frequency", "configuration": "heavy", "mode": 2, "target_hz": 17, "weight": 1},
       {"type": "shape", "configuration": "held", "mode": 1, "reference": "test", "weight": 1}]
# Two of each that differ: channel lists, tolerances and margins of bands of one configuration, weights; one mode is inside both tolerances' span.
PAIRS = [{"type": "mac", "configuration": "held", "mode": 1, "reference": "test", "at_least": 0.9},
         {"type": "mac", "configuration": "heavy", "mode": 1, "reference": "other", "at_least": 0.999},
         {"type": "mac", "configuration": "held", "mode": 2, "reference": "other", "reference_mode": 2, "at_least": 0.8},
         {"type": "avoid", "configuration": "held", "bands_hz": [[12, 13.3]], "margin_percent": 0.1, "tolerance_percent": 0.5},
         {"type": "avoid", "configuration": "held", "bands_hz": [[32, 33]], "margin_percent": 0.2, "tolerance_percent": 0.1},
         {"type": "frequency", "configuration": "heavy", "mode": 1, "at_least_hz": 6.65, "tolerance_percent": 0.2},
         {"type": "frequency", "configuration": "heavy", "mode": 2, "at_most_hz": 16.5, "tolerance_percent": 0.01}]
STUDIES = {
    "pairs": {"goals": PAIRS, "objective": {"minimise": "change"}, "references": REFERENCE | OTHER},
    "pairs_turned": {"goals": PAIRS[::-1], "objective": {"minimise": "change"}, "references": OTHER | REFERENCE},
    "missed": {"goals": GOALS, "objective": [{"minimise": "change"}, {"minimise": "k1 + 3*k2"}], "references": REFERENCE},
    "infeasible": {"goals": [g | ({"at_most_hz": 9.9, "at_least_hz": 9.8} if g["type"] == "frequency" and "at_most_hz" in g else {}) for g in GOALS],
                   "objective": {"minimise": "k1 + 3*k2"}, "references": REFERENCE},
    "met": {"goals": [{"type": "frequency", "configuration": "held", "mode": 1, "at_least_hz": 13}, *BANDS], "objective": {"maximise": "clearance"}},
    "fitted": {"goals": FIT, "objective": {"minimise": "misfit"}, "references": REFERENCE, "spread": {"factor": 3}},
    "undetermined": {"variables": VARIABLES + [{"parameter": "w", "lower": 0.5, "upper": 2}],
                     "goals": [{"type": "frequency", "configuration": "held", "mode": i, "target_hz": f, "weight": 1} for i, f in ((1, 13.5), (2, 33.5))],
                     "objective": {"minimise": "misfit"}},
    "tolerances": {"variables": [v | {"tolerance_percent": p} for v, p in zip(VARIABLES, (2, 5))], "objective": {"minimise": "change"},
                   "goals": [{"type": "frequency", "configuration": "held", "mode": 1, "at_least_hz": 14},
                             {"type": "frequency", "configuration": "heavy", "mode": 2, "at_most_hz": 17.5},
                             {"type": "avoid", "configuration": "held", "bands_hz": [[20, 25]], "margin_percent": 3}],
                   "published": [{"parameter": "k1", "value": 31, "tolerance_percent": 1},
                                 {"frequency": {"configuration": "held", "mode": 2}, "value": 33, "tolerance": 0.1}]},
    "trade": {"goals": [{"type": "frequency", "configuration": "held", "mode": 1, "at_least_hz": 14}, BANDS[1]],
              "objective": [{"minimise": "change"}, {"maximise": "clearance"}],
              "trade": {"vary": [{"goal": 0, "member": "at_least_hz", "values": [13.5, 14.5]}, {"variable": "k1", "bound": "upper", "values": [40, 60]}],
                        "objectives": ["change", "clearance"]}}}


class Truth:
    """What the mechanism does with k1, k2 and the soft spring w [N/m]."""

    def __init__(self, k1, k2, w=1000.0):
        first = k1 + 1e-5 * w
        self.k = np.array([[first + k2, -k2], [-k2, k2]])
        self.k1, self.k2 = k1, k2

    def modes(self, configuration):
        values, shapes = np.linalg.eigh(self.k / MASS[configuration])
        return np.sqrt(values) / (2 * np.pi), shapes

    def hz(self, configuration, mode):
        return self.modes(configuration)[0][mode - 1]

    def damping(self, configuration, mode):
        m = MASS[configuration]
        first_order = np.block([[np.zeros((2, 2)), np.eye(2)], [-self.k / m, -np.diag([80.0, 0.0]) / m]])
        roots = np.linalg.eigvals(first_order)
        roots = sorted(roots[roots.imag > 0], key=abs)
        return -roots[mode - 1].real / abs(roots[mode - 1])

    def mac(self, configuration, mode, reference):
        mode_shape, wanted = self.modes(configuration)[1][:, mode - 1], np.array(list(reference["shape"].values()))
        shape = np.array([mode_shape["ab".index(channel[0])] for channel in reference["shape"]])
        return (shape @ wanted) ** 2 / (shape @ shape) / (wanted @ wanted)

    def response(self, hz):
        """Displacement of b by an acceleration of the ground along x, which the damper and springs stand on."""
        w, m = 2 * np.pi * hz, MASS["held"]
        damper = np.diag([80.0, 0.0])
        dynamic = self.k + 1j * w * damper - w * w * m * np.eye(2)
        force = (self.k + 1j * w * damper) @ np.ones(2) * (-1 / (w * w))
        return abs(np.linalg.solve(dynamic, force)[1])


def edges(goal, margin=0.0):
    part = margin / 100
    return [(low * (1 - part), high * (1 + part)) for low, high in goal["bands_hz"]]


def apart(inner, outer):
    """The greater over the smaller less 1, in percent; negative where they stand the other way round."""
    return 100 * (outer / inner - 1) if inner <= outer else -100 * (inner / outer - 1)


def clearance(hz, band):
    """|ln(hz/edge)| of the nearest edge as the greater over the smaller less 1, in percent; negative inside. The edge, too: 0 the lower, 1 the upper."""
    return max((apart(hz, band[0]), 0), (apart(band[1], hz), 1))


def margin(goal, side):
    """A margin in percent of an edge, as a clearance."""
    return goal["margin_percent"] if side == 1 else 100 * (1 / (1 - goal["margin_percent"] / 100) - 1)


def missing(goal, hz, base, wide):
    """How far a mode within a band and its margin has to go, down and up, in percent of the band's edges."""
    return 100 * (hz - wide[0]) / base[0], 100 * (wide[1] - hz) / base[1]


def standings(goal, frequencies):
    """(clearance, margin as one, what is missing) of each mode beside each band, by the edge that is left sooner, else by the nearer one."""
    for hz in frequencies:
        for base, wide in zip(edges(goal), edges(goal, goal["margin_percent"])):
            down, up = missing(goal, hz, base, wide)
            inside = min(down, up) > 0
            side = int(down > up) if inside else clearance(hz, base)[1]
            yield (apart(hz, base[0]), apart(base[1], hz))[side], margin(goal, side), max(min(down, up), 0.0)


class Rules:
    """One function for each path of a number, without indices: what it has to be. It gets the number's ancestors, the innermost last."""

    def __init__(self, study, result):
        self.study, self.result = study, result
        self.variables = study["variables"]

    def at(self, design, **moved):
        values = {p["name"]: p["recommended"] for p in design["parameters"]} | moved
        return Truth(**values)

    def goal_of(self, told):
        return self.study["goals"][int(told["pointer"].split("/")[2])]

    def avoids(self, configuration=None):
        return [g for g in self.study["goals"] if g["type"] == "avoid" and configuration in (None, g["configuration"])]

    def reference(self, goal):
        return self.study["references"][goal["reference"]]["modes"][goal.get("reference_mode", 1) - 1]

    def mode(self, goal):
        return 1 if goal.get("mode") == "first" else goal.get("mode")

    def target(self, goal):
        if goal["type"] == "shape":
            return 0.0
        return goal.get("target_hz", self.reference(goal)["frequency_hz"] if goal["type"] == "frequency" and "reference" in goal else None)

    def value(self, goal, truth):
        kind, configuration = goal["type"], goal.get("configuration")
        if kind == "frequency":
            return truth.hz(configuration, self.mode(goal))
        if kind == "mac":
            return truth.mac(configuration, goal["mode"], self.reference(goal))
        if kind == "shape":
            return math.sqrt(2 - 2 * math.sqrt(truth.mac(configuration, goal["mode"], self.reference(goal))))  # a chord
        if kind == "limit":
            return truth.k1 - 2 * truth.k2
        if kind == "damping":
            return truth.damping(configuration, goal["mode"])
        if kind == "response":
            return truth.response(goal["at_hz"])
        return min(standings(goal, truth.modes(configuration)[0]), key=lambda s: s[0] - s[1])[0]

    def limits(self, goal):
        return goal.get("at_least_hz", goal.get("at_least")), goal.get("at_most_hz", goal.get("at_most"))

    def violation(self, goal, value, truth):
        """In percent: of the limit or target; a MAC, a shape and a damping ratio as their kinds are measured."""
        if goal["type"] == "avoid":
            return max(s[2] for s in standings(goal, truth.modes(goal["configuration"])[0]))
        if goal["type"] == "shape":
            return 100 * value
        least, most = self.limits(goal)
        off = lambda v, limit: 100 * abs(v - limit) * (1 if goal["type"] == "mac" else 1 / abs(limit))
        if self.target(goal) is not None:
            return off(value, self.target(goal))
        return off(value, least) if least is not None and value < least else off(value, most) if most is not None and value > most else 0.0

    def corners(self, design):
        parts = [v.get("tolerance_percent", 0.0) / 100 for v in self.variables]
        x = {p["name"]: p["recommended"] for p in design["parameters"]}
        return [{"k1": x["k1"] * (1 + s * parts[0]), "k2": x["k2"] * (1 + t * parts[1])} for s in (-1, 1) for t in (-1, 1)]

    def change(self, design):
        return math.sqrt(sum(v.get("weight", 1) * math.log(p["recommended"] / p["original"]) ** 2 for v, p in zip(self.variables, design["parameters"])))

    def misfit(self, truth):
        square = 0.0
        for goal in self.study["goals"]:
            value, target = self.value(goal, truth), self.target(goal)
            square += goal.get("weight", 0) * (value if goal["type"] == "shape" else math.log(value / target)) ** 2
        return math.sqrt(square)

    def objective(self, text, design, original):
        start = json.loads(json.dumps(design))
        for p in start["parameters"]:
            p["recommended"] = p["original"] if original else p["recommended"]
        truth = self.at(start)
        if text == "clearance":  # of the bands with their margins, by ratios
            ratio = lambda hz, band: max(band[0] / hz, hz / band[1])
            return min(100 * (ratio(hz, band) - 1) for g in self.avoids() for hz in truth.modes(g["configuration"])[0] for band in edges(g, g["margin_percent"]))
        return {"change": lambda: self.change(start), "misfit": lambda: self.misfit(truth), "k1 + 3*k2": lambda: truth.k1 + 3 * truth.k2}[text]()

    def slope(self, f, design, name):
        """By central differences of fourth order; 0 where they are no more than rounding of the four values, of which an eigenproblem leaves some units."""
        x = next(p["recommended"] for p in design["parameters"] if p["name"] == name)
        h = 1e-3 * x
        near, far = ([f(self.at(design, **{name: x + n * h})) for n in (i, -i)] for i in (1, 2))
        sum_ = 8 * (near[0] - near[1]) - (far[0] - far[1])
        return 0.0 if abs(sum_) <= 18 * 4 * EPS * max(map(abs, near + far)) else sum_ / (12 * h)

    # of a design
    def design_change(self, d):
        return self.change(d)

    def design_misfit(self, d):
        return self.misfit(self.at(d))

    def design_violation_percent(self, d):
        return max(g["violation_percent"] for g in d["goals"] if not g["weighted"]) if any(not g["weighted"] for g in d["goals"]) else 0.0

    def design_clearance_percent(self, d):
        truth, avoids = self.at(d), self.avoids()
        return min((clearance(hz, band)[0] for g in avoids for hz in truth.modes(g["configuration"])[0] for band in edges(g)), default=None)

    def design_score(self, d):
        first = d["objectives"][0]
        return first["recommended"]

    def design_rank(self, d):
        return 0 if d is self.result["baseline"] else 1 + self.result["recommendations"].index(d) if d in self.result["recommendations"] else d["rank"]

    def design_objectives_original(self, d, o):
        return self.objective(o["text"], d, True)

    def design_objectives_recommended(self, d, o):
        return self.objective(o["text"], d, False)

    def _parameter(self, p):
        return next(v for v in self.variables if v["parameter"] == p["name"])

    def design_parameters_original(self, d, p):
        return N_PER_MM * MODEL["parameters"][p["name"]]["value"]

    def design_parameters_recommended(self, d, p):
        self.test.assertTrue(p["lower"] <= p["recommended"] <= p["upper"] or d["rank"] == 0)
        return p["recommended"]

    def design_parameters_change_percent(self, d, p):
        return 100 * (p["recommended"] / p["original"] - 1)

    def design_parameters_display_factor(self, d, p):
        return N_PER_MM

    def design_parameters_lower(self, d, p):
        return N_PER_MM * self._parameter(p)["lower"]

    def design_parameters_upper(self, d, p):
        return N_PER_MM * self._parameter(p)["upper"]

    def design_frequencies_mode(self, d, f):
        return 1 + [q["configuration"] for q in d["frequencies"][:d["frequencies"].index(f)]].count(f["configuration"])

    def design_frequencies_original_hz(self, d, f):
        return Truth(30000.0, 10000.0).hz(f["configuration"], f["mode"])

    def design_frequencies_recommended_hz(self, d, f):
        return self.at(d).hz(f["configuration"], f["mode"])

    def _asked(self, f):
        return [g for g in self.study["goals"] if g["type"] == "frequency" and g["configuration"] == f["configuration"] and self.mode(g) == f["mode"]]

    def design_frequencies_target_hz(self, d, f):
        return self.target(self._asked(f)[0])

    def design_frequencies_at_least_hz(self, d, f):
        return self.limits(self._asked(f)[0])[0]

    def design_frequencies_at_most_hz(self, d, f):
        return self.limits(self._asked(f)[0])[1]

    def design_frequencies_error_percent(self, d, f):
        goal, hz = self._asked(f)[0], f["recommended_hz"]
        least, most = self.limits(goal)
        if self.target(goal) is not None:
            return 100 * (hz / self.target(goal) - 1)
        return 100 * max(0.0, 1 - hz / least if least is not None else 0.0, hz / most - 1 if most is not None else 0.0)

    def design_frequencies_mac(self, d, f):
        return self.at(d).mac(f["configuration"], f["mode"], self.study["references"][f["reference"]]["modes"][self._shape(f) - 1])

    def _shape(self, f):
        asks = [g for g in self.study["goals"] if g["type"] in ("mac", "shape") and (g["configuration"], g["mode"]) == (f["configuration"], f["mode"])]
        return asks[0].get("reference_mode", 1)

    def _share(self, d, f, mode):
        before, now = Truth(30000.0, 10000.0).modes(f["configuration"])[1][:, 0], self.at(d).modes(f["configuration"])[1][:, mode - 1]
        return (before @ now) ** 2

    def design_frequencies_share(self, d, f):
        return self._share(d, f, f["mode"])

    def design_frequencies_rival_share(self, d, f):
        return self._share(d, f, f["rival_mode"])

    def design_frequencies_rival_mode(self, d, f):
        return 3 - f["mode"]

    def design_frequencies_sensitivity(self, d, f, name):
        return self.slope(lambda truth: truth.hz(f["configuration"], f["mode"]), d, name)

    def design_frequencies_lowest_hz(self, d, f):
        return min(Truth(**c).hz(f["configuration"], f["mode"]) for c in self.corners(d))

    def design_frequencies_highest_hz(self, d, f):
        return max(Truth(**c).hz(f["configuration"], f["mode"]) for c in self.corners(d))

    def design_mac_matrices_reference_modes(self, d, m, n):
        return n

    def design_mac_matrices_rows_mode(self, d, m, row):
        return 1 + m["rows"].index(row)

    def design_mac_matrices_rows_values(self, d, m, row, i):
        return self.at(d).mac(m["configuration"], row["mode"], self.study["references"][m["reference"]]["modes"][m["reference_modes"][i] - 1])

    def _bands(self):
        return [(c, g, band) for c in MASS for band, g in sorted(((band, g) for g in self.avoids(c) for band in g["bands_hz"]), key=lambda pair: pair[0])]

    def design_clearances_band_id(self, d, c):
        name = "{:g} to {:g} Hz"
        return 1 + next(i for i, (configuration, _, band) in enumerate(self._bands()) if configuration == c["configuration"] and name.format(*band) == c["band"])

    def _band_of(self, c):
        return self._bands()[c["band_id"] - 1]

    def design_clearances_mode(self, d, c):
        self.test.assertIn(c["mode"], (1, 2))
        return c["mode"]

    def design_clearances_hz(self, d, c):
        return self.at(d).hz(c["configuration"], c["mode"])

    def design_clearances_percent(self, d, c):
        percent, side = clearance(c["hz"], self._band_of(c)[2])
        self.test.assertEqual(c["side"], ("below", "above")[side] if percent >= 0 else "inside", c)
        return percent

    def design_clearances_margin_percent(self, d, c):
        return margin(self._band_of(c)[1], clearance(c["hz"], self._band_of(c)[2])[1])

    def design_clearances_worst_percent(self, d, c):
        return min(clearance(Truth(**x).hz(c["configuration"], c["mode"]), self._band_of(c)[2])[0] for x in self.corners(d))

    def design_clearances_worst_hz(self, d, c):
        return min((clearance(Truth(**x).hz(c["configuration"], c["mode"]), self._band_of(c)[2])[0], Truth(**x).hz(c["configuration"], c["mode"]))
                   for x in self.corners(d))[1]

    def design_gap_assignment_id(self, d, g):
        return 1 + d["gap_assignment"].index(g)

    def _gap(self, g):
        return self._bands()[g["id"] - 1]

    def design_gap_assignment_lower_hz(self, d, g):
        return self._gap(g)[2][0]

    def design_gap_assignment_upper_hz(self, d, g):
        return self._gap(g)[2][1]

    def design_gap_assignment_margin_lower_hz(self, d, g):
        return self._gap(g)[2][0] * (1 - self._gap(g)[1]["margin_percent"] / 100)

    def design_gap_assignment_margin_upper_hz(self, d, g):
        return self._gap(g)[2][1] * (1 + self._gap(g)[1]["margin_percent"] / 100)

    def design_gap_assignment_modes_below(self, d, g):
        """Of a band with a mode inside both numbers are right: that of the nearest edge is told."""
        modes = self.at(d).modes(g["configuration"])[0]
        middle = math.sqrt(g["margin_lower_hz"] * g["margin_upper_hz"])
        low, high = sum(modes <= g["margin_lower_hz"] * (1 + 1e-6)), sum(modes < g["margin_upper_hz"] * (1 - 1e-6))
        self.test.assertTrue(low <= g["modes_below"] <= high, (g, modes))
        return g["modes_below"] if low < high else sum(modes < middle)

    def design_goals_mode(self, d, g):
        return self.goal_of(g)["mode"]

    def design_goals_value(self, d, g):
        return self.value(self.goal_of(g), self.at(d))

    def design_goals_target(self, d, g):
        return self.target(self.goal_of(g))

    def design_goals_at_least(self, d, g):
        goal = self.goal_of(g)
        if goal["type"] == "avoid":
            return min(standings(goal, self.at(d).modes(goal["configuration"])[0]), key=lambda s: s[0] - s[1])[1]
        return self.limits(goal)[0]

    def design_goals_at_most(self, d, g):
        return self.limits(self.goal_of(g))[1]

    def design_goals_tolerance_percent(self, d, g):
        return self.goal_of(g).get("tolerance_percent", 1e-4)

    def design_goals_violation_percent(self, d, g):
        goal, truth = self.goal_of(g), self.at(d)
        worst = [truth] if g["worst"] is None else [Truth(**x) for x in self.corners(d)]
        off = max(self.violation(goal, self.value(goal, t), t) for t in worst)
        if abs(off / g["tolerance_percent"] - 1) > 1e-2:  # there a search stops, and what it counts by logarithms is not told from it
            self.test.assertEqual(g["met"], off <= g["tolerance_percent"], (g, off))
        return off

    def design_goals_worst(self, d, g):
        goal = self.goal_of(g)
        values = [self.value(goal, Truth(**x)) for x in self.corners(d)]
        return min(values) if goal["type"] == "avoid" or self.limits(goal)[0] is not None else max(values)

    def design_goals_worst_at(self, d, g, name):
        goal = self.goal_of(g)
        corner = min(self.corners(d), key=lambda x: abs(self.value(goal, Truth(**x)) - g["worst"]))
        return corner[name]

    def design_goals_sensitivity(self, d, g, name):
        return self.slope(lambda truth: self.value(self.goal_of(g), truth), d, name)

    def design_responses_value(self, d, r):
        return self.at(d).response(13.0)

    def _at_13(self, d, r):
        return 13.0

    design_responses_frequency_hz = design_responses_lower_hz = design_responses_upper_hz = _at_13

    # of the result
    def doubts_line(self, doubt):
        return 1

    def doubts_column(self, doubt):
        """Of the member's number, from 1."""
        goal = self.study["goals"][int(doubt["pointer"].split("/")[2])]
        start = self.text.index(json.dumps(goal))
        name = json.dumps(doubt["pointer"].split("/")[3]) + ": "
        return start + self.text[start:].index(name) + len(name) + 1

    def relaxations_from(self, r):
        goal = self.goal_of(r)
        return goal[r["what"].split(" ")[0]]

    def relaxations_change_percent(self, r):
        return 100 * (r["to"] - r["from"]) / abs(r["from"])

    def _relaxed(self, r):
        member = r["what"].split(" ")[0]
        return [g | ({member: r["to"]} if i == int(r["pointer"].split("/")[2]) else {}) for i, g in enumerate(self.study["goals"])]

    def relaxations_to(self, r):
        """With it the design that is told meets all goals, and just so."""
        for goal in self._relaxed(r):
            corners = self.corners({"parameters": [{"name": n, "recommended": v} for n, v in r["design"].items()]})
            off = [self.violation(goal, self.value(goal, Truth(**c)), Truth(**c)) for c in corners]
            self.test.assertLessEqual(max(off), 2e-3, (r, goal))
        return r["to"]

    def relaxations_design(self, r, name):
        low, high = next((v["lower"], v["upper"]) for v in self.variables if v["parameter"] == name)
        self.test.assertTrue(low * N_PER_MM <= r["design"][name] <= high * N_PER_MM)
        return r["design"][name]

    def published_published(self, p):
        asked = self.study["published"][int(p["pointer"].split("/")[2])]
        return asked["value"] * (N_PER_MM if "parameter" in asked else 1)

    def published_computed(self, p):
        asked, best = self.study["published"][int(p["pointer"].split("/")[2])], self.result["recommendations"][0]
        return best["parameters"][0]["recommended"] if "parameter" in asked else self.at(best).hz("held", 2)

    def published_difference(self, p):
        return p["computed"] - p["published"]

    def published_difference_percent(self, p):
        return 100 * (p["computed"] / p["published"] - 1)

    def published_display_factor(self, p):
        return N_PER_MM

    def _told(self, s):
        return next(p["recommended"] for p in self.result["recommendations"][0]["parameters"] if p["name"] == s["parameter"])

    def spread_value(self, s):
        return self._told(s)

    def spread_display_factor(self, s):
        return N_PER_MM

    def spread_low_percent(self, s):
        return 100 * (s["low"] / s["value"] - 1)

    def spread_high_percent(self, s):
        return 100 * (s["high"] / s["value"] - 1)

    def _with_weight(self, s, end):
        """The solution with one weight changed, by Newton's method on the slopes of the misfit."""
        goals = [dict(g) for g in self.study["goals"]]
        if s[end + "_goal"] is not None:
            goals[int(s[end + "_goal"].split("/")[2])]["weight"] *= s[end + "_weight_factor"]
        rules = Rules(self.study | {"goals": goals}, self.result)
        f = lambda t: rules.misfit(Truth(*np.exp(t))) ** 2
        t, h = np.log([p["recommended"] for p in self.result["recommendations"][0]["parameters"]]), 1e-4
        for _ in range(12):
            e = np.eye(2) * h
            gradient = np.array([(f(t + a) - f(t - a)) / (2 * h) for a in e])
            hessian = np.array([[(f(t + a + b) - f(t + a - b) - f(t - a + b) + f(t - a - b)) / (4 * h * h) for a in e] for b in e])
            t = t - np.linalg.solve(hessian, gradient)
        return np.exp(t)[["k1", "k2"].index(s["parameter"])]

    def spread_low(self, s):
        return self._with_weight(s, "low")

    def spread_high(self, s):
        return self._with_weight(s, "high")

    def spread_low_weight_factor(self, s):
        self.test.assertIn(s["low_weight_factor"], (3, 1 / 3))
        return s["low_weight_factor"]

    def spread_high_weight_factor(self, s):
        self.test.assertIn(s["high_weight_factor"], (3, 1 / 3))
        return s["high_weight_factor"]

    def undetermined_effect_percent(self, u):
        """The greatest change of a frequency as w crosses its bounds, the other two where they are."""
        best = self.result["recommendations"][0]
        ends = [self.at(best, w=N_PER_MM * w) for w in (0.5, 2)]
        moved = max(100 * math.log(ends[1].hz("held", i) / ends[0].hz("held", i)) for i in (1, 2))
        self.test.assertTrue(moved <= u["effect_percent"] <= 1.3 * moved, moved)  # the largest of what some designs make of it
        return u["effect_percent"]

    def undetermined_components(self, u, name):
        return 1.0 if name == "w" else 0.0

    # of a tolerance box: at its corners limits and bands without margins are kept, a little beyond they are not
    def _kept(self, design, percent):
        x = {p["name"]: p["recommended"] for p in design["parameters"]}
        corners = [Truth(**{n: v * (1 + s * percent[n] / 100) for (n, v), s in zip(x.items(), signs)}) for signs in itertools.product((-1, 1), repeat=len(x))]
        within = lambda t: all(v >= (self.limits(g)[0] or 0.0) for g in self.study["goals"] if g["type"] == "frequency" for v in [self.value(g, t)])
        counts = lambda t: [(sum(t.modes(c)[0] <= band[0]), sum(t.modes(c)[0] < band[1])) for c, _, band in self._bands()]
        wanted = [(g["modes_below"],) * 2 for g in design["gap_assignment"]]
        return all(counts(t) == wanted and within(t) for t in corners)

    def _just_kept(self, d, told, moved):
        percent = lambda p: {q["name"]: p if q["name"] in moved else 0.0 for q in d["parameters"]}
        self.test.assertTrue(told == 0 or self._kept(d, percent(told * (1 - 1e-6))), (d["tolerance_box"], moved))
        self.test.assertFalse(self._kept(d, percent(max(1.01 * told, 1e-3))), (d["tolerance_box"], moved))
        return told

    def design_tolerance_box_all_percent(self, d, box):
        return self._just_kept(d, box["all_percent"], [p["name"] for p in d["parameters"]])

    def design_tolerance_box_per_variable_percent(self, d, box, one):
        name = d["parameters"][box["per_variable"].index(one)]["name"]
        return self._just_kept(d, one["percent"], [name])


# Numbers of the result that are known to a tolerance of their own.
LOOSE = {"sensitivity": SLOPE, "spread_low": 1e-4, "spread_high": 1e-4, "spread_low_percent": 1e-9, "spread_high_percent": 1e-9,
         "undetermined_components": 1e-3, "undetermined_effect_percent": 1e-3, "rival_share": 1e-6, "kkt_residual": None, "residual": None, "orthogonality": None}


def numbers(value, path=(), chain=()):
    """(names on the way, what it is in, the number): of lists of numbers the index as well."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from numbers(inner, path + (key,), chain + (value,))
    elif isinstance(value, list):
        for i, inner in enumerate(value):
            yield from numbers(inner, path, chain + ((i,) if isinstance(inner, (int, float)) and not isinstance(inner, bool) else ()))
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        yield path, chain, value


class Numbers(unittest.TestCase):
    maxDiff = None

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.root = Path(cls.folder.name)
        (cls.root / "model.json").write_text(json.dumps(MODEL))
        for name, members in STUDIES.items():
            study = {"format": "modetune-study/1", "name": name, "model": "model.json", "variables": VARIABLES} | members
            (cls.root / f"{name}.json").write_text(json.dumps(study))
        command = [PROGRAM, "run", *(f"{name}.json" for name in STUDIES), "--starts", "4", "--threads", "1", "-o", "results"]
        cls.said = subprocess.run(command, cwd=cls.root, capture_output=True, text=True)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def read(self, name):
        path = self.root / "results" / name / "result.json"
        self.assertTrue(path.exists(), self.said.stderr)
        study = {"variables": VARIABLES} | STUDIES[name]
        return study, json.loads(path.read_text())

    def check(self, rules, method, path, got, *arguments):
        loose = LOOSE.get(method, LOOSE.get(path[-1], LOOSE.get(path[-2] if len(path) > 1 else "", SMALL)))
        if loose is None:  # of rounding: small, and no more is claimed
            self.assertTrue(0 <= got < 100, path)
            return
        rule = getattr(rules, method, None)
        if rule is None:
            self.wrong.append(f"{'.'.join(path)} is {got}: there is no rule {method}")
            return
        want = rule(*arguments)
        if want is None:
            self.wrong.append(f"{'.'.join(path)} is {got}, where there is none")
            return
        if not abs(got - want) <= loose * max(abs(want), 1e-12 if "sensitivity" in path else 1e-4):
            where = [a.get("pointer") or [a[k] for k in ("configuration", "mode", "name", "text") if k in a] if isinstance(a, dict) else a for a in arguments]
            self.wrong.append(f"{'.'.join(path)} at {where} is {got}, not {want}")

    def all_numbers(self, rules, top, prefix, skip=()):
        count = 0
        for path, chain, got in numbers(top):
            if path[0] in skip:
                continue
            count += 1
            inner = list(chain)
            names = [p for p in path if not (len(path) > 1 and p == path[-1] and path[-2] in ("sensitivity", "worst_at", "design", "components"))]
            arguments = [c for c in inner if isinstance(c, (dict, int))]
            if path[-1] in ("k1", "k2", "w"):
                arguments = arguments[:-1] + [path[-1]]  # a member of a table by names
            if not prefix:
                arguments = arguments[1:]
            elif path[-2:-1] == ("rows",) and path[-1] == "mode":
                pass
            if path[-1] == "reference_modes":
                arguments[-1] = arguments[-2]["reference_modes"][arguments[-1]]
            self.check(rules, "_".join([*prefix, *names]), path, got, *arguments)
        return count

    def lines(self, path):
        return list(csv.DictReader((self.root / "results" / path).read_text().splitlines()))

    def rules(self, name):
        study, result = self.read(name)
        rules = Rules(study, result)
        rules.test, rules.text = self, (self.root / f"{name}.json").read_text()
        return study, result, rules

    def setUp(self):
        self.wrong = []

    def test_every_number_of_every_result(self):
        for name in STUDIES:
            self.wrong = []
            with self.subTest(study=name):
                _, result, rules = self.rules(name)
                for design in [result["baseline"], *result["recommendations"]]:
                    self.assertGreater(self.all_numbers(rules, design, ("design",), skip=("curves",)), 20)
                rest = {k: v for k, v in result.items() if k not in ("run", "baseline", "recommendations", "curves", "trade")}
                self.all_numbers(rules, rest, ())
                self.assertEqual(self.wrong, [])

    def test_what_the_studies_are_for(self):
        """Or the rest says nothing: each is answered as it is meant."""
        status = {name: self.read(name)[1]["status"] for name in STUDIES}
        self.assertEqual(status["infeasible"], "infeasible")
        self.assertEqual(status["fitted"], "fitted")
        self.assertIn(status["missed"], ("compromise", "infeasible"))
        self.assertEqual([status["met"], status["trade"]], ["solved", "solved"])
        self.assertTrue(self.read("fitted")[1]["spread"])
        self.assertTrue(self.read("undetermined")[1]["undetermined"])
        self.assertTrue(self.read("tolerances")[1]["relaxations"])
        self.assertTrue(all(self.read(name)[1]["recommendations"][0]["tolerance_box"] for name in ("met", "trade")))

    def test_points_of_a_trade_study(self):
        study, result, rules = self.rules("trade")
        asked = [(a, b) for a in (13.5, 14.5) for b in (40, 60)]
        for (least, upper), point in zip(asked, result["trade"]["points"], strict=True):
            rules.study = study | {"goals": [study["goals"][0] | {"at_least_hz": least}, *study["goals"][1:]]}
            rules.variables = [VARIABLES[0] | {"upper": upper}, VARIABLES[1]]
            self.assertEqual(point["values"], [least, upper * N_PER_MM])
            self.all_numbers(rules, point["best"], ("design",), skip=("curves",))
        self.assertEqual(self.wrong, [])
        lines = self.lines("trade/trade.csv")
        for line, point in zip(lines, result["trade"]["points"], strict=True):
            design = point["best"]
            self.assertEqual([float(line["k1 [N/mm]"]), float(line["k2 [N/mm]"])], [p["recommended"] / N_PER_MM for p in design["parameters"]])
            self.assertEqual(float(line["change"]), design["change"])
            self.assertEqual(float(line["clearance_percent"]), design["clearance_percent"])
            self.assertEqual(float(line["objective clearance [%]"]), design["objectives"][1]["recommended"])

    def test_tables_of_designs_say_the_same(self):
        for name in STUDIES:
            study, result, rules = self.rules(name)
            lines = self.lines(f"{name}/recommendations.csv")
            for line, design in zip(lines, [result["baseline"], *result["recommendations"]], strict=True):
                truth = rules.at(design)
                for p in design["parameters"]:
                    self.assertLessEqual(abs(float(line[f"{p['name']} [N/mm]"]) * N_PER_MM / p["recommended"] - 1), 1e-15)
                for f in design["frequencies"]:
                    hz = float(line[f"{f['configuration']}.mode_{f['mode']}_hz"])
                    self.assertLessEqual(abs(hz / truth.hz(f["configuration"], f["mode"]) - 1), SMALL)
                self.assertEqual(float(line["change"]), design["change"])
                self.assertEqual(float(line["violation_percent"]), design["violation_percent"])
                if "clearance_percent" in line:
                    self.assertEqual(float(line["clearance_percent"]), design["clearance_percent"])

    def rows(self, name, title):
        """Rows of a table of the text, cells by the columns of the rule below its head."""
        said = subprocess.run([PROGRAM, "report", f"results/{name}/result.json"], cwd=self.root, capture_output=True, text=True, check=True).stdout
        lines = said.split("\n\n" + title + "\n", 1)[1].split("\n")
        places = [m.span() for m in re.finditer(r"-+", lines[1])]
        cut = lambda line: [line[a - (0 if a == places[0][0] else 1):b + 1].strip() for a, b in places]
        body = []
        for line in lines[2:]:
            if not line.strip():
                break
            body.append(dict(zip(cut(lines[0]), cut(line))))
        return body

    def near(self, text, want, told):
        """Six digits, of a percentage three; a dash where there is no number."""
        if want is None:
            self.assertEqual(text, "-", told)
            return
        digits = 6e-3 if "%" in told else DIGITS
        self.assertLessEqual(abs(float(text) - want), digits * max(abs(want), 1e-9 if want else 1e-4), told)

    def test_tables_of_the_text_say_the_same_in_units_of_the_shop(self):
        for name in STUDIES:
            _, result, _ = self.rules(name)
            best = result["recommendations"][0]
            for row, p in zip(self.rows(name, "Parameters"), best["parameters"], strict=True):
                self.assertEqual(row["unit"], "N/mm")
                self.near(row["before"], p["original"] / N_PER_MM, f"{name} before")
                self.near(row["after"], p["recommended"] / N_PER_MM, f"{name} after")
                self.near(row["change [%]"], p["change_percent"], f"{name} change %")
            for row, f in zip(self.rows(name, "Frequencies"), best["frequencies"], strict=True):
                self.near(row["before [Hz]"], f["original_hz"], name)
                self.near(row["after [Hz]"], f["recommended_hz"], name)
                self.near(row["error [%]"], f["error_percent"], f"{name} error %")
                for column, member in (("MAC", "mac"), ("lowest [Hz]", "lowest_hz"), ("highest [Hz]", "highest_hz")):
                    if column in row:
                        self.near(row[column], f[member], f"{name} % {column}")
                asked = [f[m] for m in ("target_hz", "at_least_hz", "at_most_hz") if f[m] is not None]
                self.assertEqual([float(n) for n in re.findall(r"\d+\.?\d*", row["asked [Hz]"])], [float(f"{a:.6g}") for a in asked])

    def test_requirements_say_what_is_asked_and_what_was_and_is(self):
        for name in STUDIES:
            study, result, rules = self.rules(name)
            best, base = result["recommendations"][0], result["baseline"]
            now, was = rules.at(best), rules.at(base)
            rows, seen = iter(self.rows(name, "Requirements")), set()
            for told in best["goals"]:
                goal = rules.goal_of(told)
                if goal["type"] == "avoid":
                    if goal["configuration"] not in seen:
                        seen.add(goal["configuration"])
                        self.check_bands(rows, rules, goal["configuration"], now, was, best)
                    continue
                row = next(rows)
                self.assertIn(row["requirement"], told["goal"])
                shown = N_PER_MM if told["display_unit"] else 1.0
                for column, truth in (("before", was), ("after", now)):
                    self.near(row[column].split(" ")[0], rules.value(goal, truth) / shown, f"{name} {column} {row}")
                limits, target = [x for x in rules.limits(goal) if x is not None], rules.target(goal)
                asked = [float(n) for n in re.findall(r"(?<![\w^])-?\d+\.?\d*(?:e-?\d+)?", row["limit"].split(" within")[0])]
                want = limits or [target] * bool(target)
                self.assertTrue(len(asked) == len(want) and all(abs(a * shown / b - 1) < 1e-9 for a, b in zip(asked, want)), row)
                judged = told["worst"] if told["worst"] is not None else rules.value(goal, now)
                if told["worst"] is not None:
                    self.near(row["at worst"].split(" ")[0], judged / shown, f"{name} worst {row}")
                least, most = rules.limits(goal)
                if limits:
                    rooms = [(judged - x) / abs(x) for x in [least] if x is not None] + [(x - judged) / abs(x) for x in [most] if x is not None]
                    self.margin(row["margin"], 100 * min(rooms), row)
                elif target:
                    self.near(re.fullmatch(r"off by (\S+) %", row["margin"])[1], 100 * abs(judged / target - 1), f"{name} % {row}")
                self.assertEqual(row["verdict"], "weighted" if "weight" in goal else "met" if told["met"] else "not met", row)
            self.assertEqual(list(rows), [])

    def margin(self, text, room, row):
        self.assertLessEqual(abs(float(text.removesuffix(" %")) - room), 6e-3 * abs(room) + 2e-6, row)

    def check_bands(self, rows, rules, configuration, now, was, best):
        """A row for each band: the mode that is nearest to it with its margin, before and after."""
        goals = rules.avoids(configuration)
        bands = sorted(band for g in goals for band in edges(g, g["margin_percent"]))
        away = lambda hz, band: max(band[0] / hz, hz / band[1]) - 1
        met = all(g["met"] for g in best["goals"] if g["type"] == "avoid" and g["configuration"] == configuration)
        for band in bands:
            row = next(rows)
            self.assertTrue(row["requirement"].startswith(configuration + ": no mode in "), row)
            said = [float(x) for x in re.fullmatch(r"outside (\S+) to (\S+) Hz", row["limit"]).groups()]
            self.assertTrue(all(abs(a / b - 1) < DIGITS for a, b in zip(said, band)), row)
            for column, truth in (("before", was), ("after", now)):
                hz = truth.modes(configuration)[0]
                rooms = [away(x, band) for x in hz[:2]]  # of equally near ones the first is told
                mode = 2 if rooms[0] - rooms[1] > 1e-6 * max(abs(x) for x in rooms) else 1
                if "at worst" not in row:
                    self.assertTrue(row[column].endswith(f" Hz (mode {mode})"), row)
                    self.near(row[column].split(" ")[0], hz[mode - 1], f"{column} {row}")
            corners = rules.corners(best) if "at worst" in row else []
            lowest = min((away(hz, band) for at in corners for hz in Truth(**at).modes(configuration)[0]), default=None)
            room = 100 * (lowest if corners else min(away(hz, band) for hz in now.modes(configuration)[0]))
            self.margin(row["margin"], room, row)
            if corners:
                self.assertLessEqual(abs(100 * away(float(row["at worst"].split(" ")[0]), band) - room), 1e-3, row)
            self.assertEqual(row["verdict"], "met" if met or room >= -1e-7 else "not met", row)

    def test_explain_says_what_one_per_cent_more_does(self):
        for name in ("missed", "fitted", "met"):
            study, result, rules = self.rules(name)
            best = result["recommendations"][0]
            command = [PROGRAM, "explain", f"results/{name}/result.json"]
            said = subprocess.run(command, cwd=self.root, capture_output=True, text=True, check=True).stdout
            told = subprocess.run(command + ["--format", "csv"], cwd=self.root, capture_output=True, text=True, check=True).stdout
            for goal in best["goals"]:
                line = next(line for line in said.splitlines() if line.startswith(f"  - {goal['goal']}: "))
                self.assertEqual("no sensitivity" in line, goal["sensitivity"] is None and goal["type"] != "avoid", line)
            rows = list(csv.DictReader(told.splitlines()))
            moved = [(g["goal"], p["name"]) for g in best["goals"] if g["sensitivity"] is not None for p in best["parameters"]]
            self.assertEqual(sorted((r["goal"], r["parameter"]) for r in rows if (r["goal"], "k1") in moved), sorted(moved))
            for one, other in zip(rows, rows[1:]):  # of each goal the most first
                self.assertTrue(one["goal"] != other["goal"] or 1.00001 * abs(float(one["change_per_percent"])) >= abs(float(other["change_per_percent"])), (one, other))
            for row in rows:
                goal = next((g for g in best["goals"] if g["goal"] == row["goal"]), None)
                p = next(p for p in best["parameters"] if p["name"] == row["parameter"])
                x = p["recommended"]
                self.assertLessEqual(abs(float(row["value"]) / x - 1), SMALL)
                down, up = (float(re.search(rf"(\S+) % {way}", row["room"])[1]) for way in ("down", "up"))
                self.assertLessEqual(abs(down - 100 * (1 - p["lower"] / x)), 6e-3 * down, row)
                self.assertLessEqual(abs(up - 100 * (p["upper"] / x - 1)), 6e-3 * up, row)
                if goal is not None and goal["type"] != "avoid":
                    slope = rules.slope(lambda t: rules.value(rules.goal_of(goal), t), best, p["name"])
                    self.assertLessEqual(abs(float(row["change_per_percent"]) - 0.01 * x * slope), 6e-3 * abs(0.01 * x * slope), row)

    def test_uncertainty_is_said_in_its_numbers(self):
        _, result, _ = self.rules("undetermined")
        said = subprocess.run([PROGRAM, "report", "results/undetermined/result.json"], cwd=self.root, capture_output=True, text=True, check=True).stdout
        told = float(re.search(r"by more than (\S+) % from bound to bound", said)[1])
        self.assertLessEqual(abs(told - result["undetermined"][0]["effect_percent"]), 6e-3 * told)


if __name__ == "__main__":
    unittest.main()

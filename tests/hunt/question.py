# SPDX-License-Identifier: GPL-3.0-or-later
"""What a study asks, as arrays over many designs: rows of X are designs, columns the variables."""
import itertools
import math

import numpy as np

from dense import Plant
from expressions import evaluate, parameters

TOLERANCE_PERCENT = 1e-4  # of a goal that gives none
POSITIONS = 13            # of a drive, between the first and the last that is named
MANY_POSITIONS = 401      # between which no mode moves by a tolerance
FLOOR_PART = 1e-3         # of the original: the change of a parameter that may become 0 is linear below


class Band:
    def __init__(self, base_lower, base_upper, margin):
        self.base = (base_lower, base_upper)
        self.lower, self.upper = base_lower * (1.0 - margin / 100.0), base_upper * (1.0 + margin / 100.0)

    def inside(self, hz, base=False):
        """ln of the way out, positive inside."""
        lower, upper = self.base if base else (self.lower, self.upper)
        with np.errstate(divide="ignore", invalid="ignore"):
            low = np.log(hz / lower) if lower > 0.0 else np.inf
            return np.minimum(low, np.log(upper / hz))

    def below(self, hz):
        """How many modes lie below the middle; rows of hz are designs. Below a band that begins at 0 there is none."""
        return np.zeros(len(hz), int) if self.lower <= 0.0 else np.sum(hz <= math.sqrt(self.lower * self.upper), axis=1)

    def missing_percent(self, hz):
        """The shorter way out of the band with its margin, in percent of the edge without it; 0 outside."""
        up = 100.0 * (self.upper - hz) / self.base[1]
        down = 100.0 * (hz - self.lower) / self.base[0] if self.base[0] > 0.0 else math.inf
        return max(0.0, min(up, down))

    def clearance_percent(self, hz):
        """From the nearest edge without margin, the greater over the smaller less 1; negative inside."""
        low, high = self.base
        if not hz > 0.0:
            return math.nan

        def ratio(ahead):
            return 100.0 * (ahead - 1.0) if ahead >= 1.0 else -100.0 * (1.0 / ahead - 1.0)

        return max(ratio(hz / high), ratio(low / hz)) if low > 0.0 else ratio(hz / high)


def merged(bands, up_to=math.inf):
    """Bands that overlap with their margins are one; all are cut off at up_to."""
    kept = []
    for band in sorted((b for b in bands if b.lower < up_to), key=lambda b: (b.lower, b.upper)):
        if kept and band.lower <= kept[-1].upper:
            last = kept[-1]
            last.base = (min(last.base[0], band.base[0]), max(last.base[1], band.base[1]))
            last.upper = max(last.upper, band.upper)
        else:
            kept.append(band)
    for band in kept:
        band.upper = min(band.upper, up_to)
        band.base = tuple(min(b, up_to) for b in band.base)
    return kept


class Variable:
    def __init__(self, item, original):
        self.item, self.name, self.original = item, item["parameter"], original
        self.weight = item.get("weight", 1.0)
        self.tolerance = item.get("tolerance_percent", 0.0) / 100.0
        if "catalogue" in item:
            given = item["catalogue"]
            self.values = np.array(sorted(set(given)) if isinstance(given, list) else
                                   np.arange(given["lower"], given["upper"] * (1 + 1e-12), given["step"]), float)
            self.lower, self.upper = self.values[0], self.values[-1]
        else:
            self.values, self.lower, self.upper = None, float(item["lower"]), float(item["upper"])
        # ln x; below the floor its tangent; linear where a scale is given or x may be negative
        self.log = self.lower >= 0.0 and original > 0.0 and "scale" not in item
        self.floor = FLOOR_PART * original if self.log and self.lower == 0.0 else 0.0
        self.scale = item.get("scale", (self.upper - self.lower) or 1.0)

    def t(self, x):
        if not self.log:
            return x / self.scale
        if self.floor == 0.0:
            return np.log(x)
        return np.where(x < self.floor, math.log(self.floor) + (x - self.floor) / self.floor, np.log(np.maximum(x, self.floor)))

    def x(self, t):
        if not self.log:
            return t * self.scale
        if self.floor == 0.0:
            return np.exp(t)
        return np.where(t < math.log(self.floor), self.floor * (1.0 + t - math.log(self.floor)), np.exp(t))


def _mode(modes, index):
    """One mode of many designs; NaN where there are not so many."""
    return modes[:, index - 1] if index <= modes.shape[1] else np.full(len(modes), np.nan)


def settled(study):
    """The variables one by one, and what is chosen at once: (index of the first, [rows, variables])."""
    items, choices = [], []
    for item in study.get("variables", []):
        first = len(items)
        if "parameters" in item:
            table = study["catalogues"][item["catalogue"]]
            given = item["parameters"]
            pairs = list(zip(table["columns"], given)) if isinstance(given, list) else [
                (c, p) for c, several in given.items() for p in (several if isinstance(several, list) else [several])]
            rows = np.array([[row[table["columns"].index(c)] for c, _ in pairs] for row in table["rows"]], float)
            rest = {k: v for k, v in item.items() if k not in ("parameters", "catalogue")}
            items += [{**rest, "parameter": p, "catalogue": sorted(set(rows[:, k]))} for k, (_, p) in enumerate(pairs)]
            choices.append((first, np.unique(rows, axis=0)))
        else:
            items.append(item)
            choices.append((first, None))
    return items, choices


class Question:
    def __init__(self, model, study, positions=POSITIONS):
        self.model, self.study, self.plant, self.positions = model, study, Plant(model), positions
        items, choices = settled(study)
        self.variables = [Variable(v, self.plant.original[v["parameter"]]) for v in items]
        self.n = len(self.variables)
        self.choices = [(first, self.variables[first].values[:, None] if rows is None else rows) for first, rows in choices
                        if rows is not None or self.variables[first].values is not None]
        self.lower = np.array([v.lower for v in self.variables])
        self.upper = np.array([v.upper for v in self.variables])
        self.origin = np.array([v.original for v in self.variables])
        self.tolerance = np.array([v.tolerance for v in self.variables])
        self.robust = bool(np.any(self.tolerance > 0.0))
        self._changes = self._corners()
        self.goals = study.get("goals", [])
        self.objectives = study.get("objective", {"minimise": "change"})
        self.objectives = self.objectives if isinstance(self.objectives, list) else [self.objectives]
        self.demands = [(i, g, c) for i, g in enumerate(self.goals) for c in self._configurations(g)]
        self.origin_t = self.t(self.origin[None, :]) if self.n else None
        named = [c for _, g, c in self.demands if c is not None] + [g["of"]["configuration"] for g in self.goals if "configuration" in g.get("of", ())]
        self.configurations = list(dict.fromkeys(named))
        self.bands = {c: self._bands(c) for c in self.configurations}
        self._rigid = {}
        self.moving = any("drive" in model.get("configurations", {}).get(c, {}) for c in self.configurations)

    def _configurations(self, goal):
        if goal["type"] == "limit":
            return [None]
        return goal.get("configurations") or [goal.get("configuration", self.plant.names[0])]

    def goal_bands(self, goal):
        margin = goal.get("margin_percent", 0.0)
        return merged([Band(low, high, margin) for low, high in goal["bands_hz"]], goal.get("up_to_hz", math.inf))

    def _bands(self, configuration):
        goals = [g for _, g, c in self.demands if g["type"] == "avoid" and c == configuration]
        return merged([b for g in goals for b in self.goal_bands(g)])

    def tolerance_of(self, goal):
        return goal.get("tolerance_percent", TOLERANCE_PERCENT) / 100.0

    # designs
    def design(self, x):
        return {v.name: x[:, i] for i, v in enumerate(self.variables)}

    def t(self, x):
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.stack([v.t(x[..., i]) for i, v in enumerate(self.variables)], axis=-1)

    def x(self, t):
        x = np.stack([v.x(t[..., i]) for i, v in enumerate(self.variables)], axis=-1)
        return np.clip(x, self.lower, self.upper)

    def frequencies(self, x, configuration):
        """[B, modes] of vibration. All designs are counted alike: rigid are the modes that no design within the bounds gives a stiffness."""
        if configuration not in self._rigid:
            inside = self.lower + np.array([[0.53], [0.41]]) * (self.upper - self.lower)
            here = self.plant.assembly(configuration).frequencies(self.design(inside), 2)
            self._rigid[configuration] = int(np.sum(here == 0.0, axis=1).min())
        return self.plant.assembly(configuration).frequencies(self.design(x), len(x))[:, self._rigid[configuration]:]

    def all_frequencies(self, x):
        return {c: self.frequencies(x, c) for c in self.configurations}

    # goals
    def rows(self, x, hz=None):
        """[(goal index, configuration, kind, [B] violation)]: relative (of frequencies a logarithm), positive where missed; kind "=", "<" or "band"."""
        hz = self.all_frequencies(x) if hz is None else hz
        return [row for i, goal, c in self.demands for row in self._demand(i, goal, c, x, hz)]

    def _demand(self, index, goal, configuration, x, hz):
        if goal["type"] == "limit":
            values = parameters(self.model, self.design(x))
            value = np.broadcast_to(np.asarray(evaluate(goal["expression"], values), float), (len(x),))
            for member, sign in (("at_least", -1.0), ("at_most", 1.0), ("equals", 0.0)):
                if member in goal:
                    unit = abs(goal[member]) or 1.0
                    yield index, None, "<" if sign else "=", (sign or 1.0) * (value - goal[member]) / unit
            return
        modes = hz[configuration]
        if goal["type"] == "avoid":
            inside = np.full(len(x), -np.inf)
            for band in self.goal_bands(goal):
                inside = np.maximum(inside, np.max(band.inside(modes), axis=1))
            yield index, configuration, "band", np.where(np.isnan(modes[:, 0]), np.nan, inside)
            return
        if goal["type"] == "ratio":
            ratio = _mode(modes, goal["mode"]) / _mode(hz[goal["of"].get("configuration", configuration)], goal["of"]["mode"])
            for member, sign in (("at_least", -1.0), ("at_most", 1.0), ("target", 0.0)):
                if member in goal:
                    yield index, configuration, "<" if sign else "=", (sign or 1.0) * np.log(ratio / goal[member])
            return
        if goal["type"] == "apart":
            listed = goal.get("modes") or range(1, goal["up_to_mode"] + 1)
            for low, high in itertools.pairwise(_mode(modes, m) for m in listed):
                apart = high - low if "at_least_hz" in goal else 100.0 * (high / low - 1.0)
                least = goal.get("at_least_hz") or goal["at_least_percent"]
                yield index, configuration, "<", (least - apart) / least
            return
        mode = _mode(modes, goal["mode"])
        if "target_hz" in goal:
            yield index, configuration, "=", np.log(mode / goal["target_hz"])
        if "at_least_hz" in goal:
            yield index, configuration, "<", -np.log(mode / goal["at_least_hz"])
        if "at_most_hz" in goal:
            yield index, configuration, "<", np.log(mode / goal["at_most_hz"])

    def percent(self, index, kind, value, modes=None):
        """A violation in percent of what is asked for; of a band how far the clearances of modes[B] fall short of their margins."""
        goal = self.goals[index]
        if goal["type"] in ("limit", "apart"):
            return 100.0 * (np.abs(value) if kind == "=" else np.maximum(value, 0.0))
        if kind == "band" and not self.robust:
            worst = np.zeros(len(value))
            for band in self.goal_bands(goal):
                for i in np.flatnonzero(value > 0.0):
                    worst[i] = max(worst[i], max(band.missing_percent(f) for f in modes[i]))
            return worst
        if ("at_least_hz" in goal or "at_least" in goal) and kind == "<" and "at_most_hz" not in goal and "at_most" not in goal:
            return -100.0 * np.expm1(-np.maximum(value, 0.0))
        return 100.0 * np.abs(np.expm1(value)) if kind == "=" else 100.0 * np.expm1(np.maximum(value, 0.0))

    def _motion(self, goal):
        """Names of configurations all the way between the named positions of a drive, for each drive of a goal."""
        drives = {}
        for name in self._configurations(goal):
            drive = self.model.get("configurations", {}).get(name, {}).get("drive")
            if drive is not None:
                angle = float(evaluate(drive["position_rad"], self.plant.original))
                drives.setdefault(drive["joint"], []).append((angle, {**self.model["configurations"][name]}))
        for joint, places in drives.items():
            if len(places) < 2:
                continue
            names = []
            for k, angle in enumerate(np.linspace(min(a for a, _ in places), max(a for a, _ in places), self.positions)):
                names.append(f"{joint} {k}")
                settings = {**places[0][1], "drive": {**places[0][1]["drive"], "position_rad": float(angle)}}
                self.plant.add(names[-1], settings)
            yield names

    def _missed_between(self, goal, x):
        """As missed, over the motion: one drive has one number of modes below a band, and keeps it all the way."""
        worst = np.zeros(len(x))
        for names in self._motion(goal):
            for band in self.goal_bands(goal):
                hz = [self.frequencies(x, name) for name in names]
                counts = np.array([band.below(h) for h in hz])
                inside = np.max([np.max(band.inside(h), axis=1) for h in hz], axis=0)
                worst = np.maximum(worst, np.where(np.ptp(counts, axis=0) > 0, np.inf, inside / self.tolerance_of(goal)))
        return worst

    def missed(self, x):
        """[B] greatest violation of a constraint divided by its tolerance; at most 1 is feasible. Unstable: infinite."""
        worst = np.zeros(len(x))
        for goal in self.goals:
            if goal["type"] == "avoid" and len(self._configurations(goal)) > 1:
                worst = np.maximum(worst, self._missed_between(goal, x))
        for index, _, kind, value in self.rows(x):
            if "weight" not in self.goals[index]:
                value = np.abs(value) if kind == "=" else value
                worst = np.maximum(worst, np.where(np.isnan(value), np.inf, value) / self.tolerance_of(self.goals[index]))
        return worst

    def _corners(self):
        """Factors [K, n] of corners and, where they are few, points between; 1 last."""
        which = np.flatnonzero(self.tolerance > 0.0)
        steps = [-1.0, 0.0, 1.0] if len(which) <= 3 else [-1.0, 1.0]
        signs = list(itertools.product(steps, repeat=len(which))) if len(which) else []
        out = np.ones((len(signs) + 1, self.n))
        if signs:
            out[:-1, which] += np.array(signs) * self.tolerance[which]
        return out

    def corners(self, x):
        """[..., K, n]: where the worst of the tolerances about designs x[..., n] is looked for; the designs themselves last."""
        return x[..., None, :] * self._changes

    def within_tolerances(self, x, count=150):
        """The corners, and points all over the tolerances: between two corners a mode may cross a band."""
        rng = np.random.default_rng(1)
        return np.concatenate([x * (1.0 + rng.uniform(-1.0, 1.0, (count, self.n)) * self.tolerance), self.corners(x)])

    def missed_robustly(self, x):
        """As missed, of the worst corner."""
        if not self.robust:
            return self.missed(x)
        return self.missed(self.corners(x).reshape(-1, self.n)).reshape(len(x), -1).max(axis=1)

    def kind(self, x, hz=None):
        """[B] tuples: the gap assignment of each design, bands of all configurations in order."""
        hz = self.all_frequencies(x) if hz is None else hz
        counts = [band.below(hz[c]) for c in self.configurations for band in self.bands[c]]
        return [tuple(int(c[i]) for c in counts) for i in range(len(x))]

    # objectives
    def change(self, x):
        d = self.t(x) - self.origin_t
        return np.sqrt(np.sum(np.array([v.weight for v in self.variables]) * d * d, axis=1))

    def misfit(self, x):
        total = np.zeros(len(x))
        for index, _, kind, value in self.rows(x):
            if "weight" in self.goals[index]:
                total = total + self.goals[index]["weight"] * value * value
        return np.sqrt(total)

    def clearance(self, x):
        """Score of the objective: percent of the least ratio to an edge with margin."""
        least = np.full(len(x), np.inf)
        hz = self.all_frequencies(x)
        for c in self.configurations:
            for band in self.bands[c]:
                least = np.minimum(least, np.min(-band.inside(hz[c]), axis=1))
        return 100.0 * np.expm1(least)

    def objective(self, x, k=0):
        """[B] score of objective k as results show it; less is better, but a clearance."""
        item = self.objectives[k]
        what = item.get("minimise", item.get("maximise"))
        if what == "change":
            return self.change(x)
        if what == "mass":
            first = self.configurations[0] if self.configurations else self.plant.names[0]
            return np.broadcast_to(self.plant.total_mass(self.design(x), len(x), first, item.get("of")), (len(x),))
        if what == "misfit":
            return self.misfit(x)
        if what == "clearance":
            return self.clearance(x)
        return np.broadcast_to(np.asarray(evaluate(what, parameters(self.model, self.design(x))), float), (len(x),))

    def cost(self, x, k=0):
        """Less is better, always."""
        return -self.objective(x, k) if "maximise" in self.objectives[k] else self.objective(x, k)

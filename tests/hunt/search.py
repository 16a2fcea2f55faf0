# SPDX-License-Identifier: GPL-3.0-or-later
"""Brute force: samples over the bounds, and local searches (SLSQP) from the best of them and from given designs."""
import itertools
import warnings

import numpy as np
from scipy.optimize import minimize


STEP = 3e-6  # of central differences, in the coordinates t
HALTON = (2, 3, 5, 7, 11, 13, 17, 19)


def _halton(count, n):
    out = np.zeros((count, n))
    for column, base in enumerate(HALTON[:n]):
        index, scale = np.arange(1, count + 1), 1.0 / base
        while index.any():
            out[:, column] += scale * (index % base)
            index, scale = index // base, scale / base
    return out


def samples(question, count):
    """[count, n] designs: evenly over t, and all corners of the bounds where they are few."""
    lower, upper = question.t(question.lower[None, :])[0], question.t(question.upper[None, :])[0]
    points = lower + _halton(count, question.n) * (upper - lower)
    if question.n <= 8:
        points = np.concatenate([np.array(list(itertools.product(*zip(lower, upper)))), points])
    x = question.x(points)
    for first, rows in question.choices:
        own = slice(first, first + rows.shape[1])
        span = np.ptp(rows, axis=0)
        away = np.abs(rows[None, :, :] - x[:, None, own]) / np.where(span > 0.0, span, 1.0)
        x[:, own] = rows[away.sum(axis=2).argmin(axis=1)]
    return x


def combinations(question):
    """All designs of catalogues alone."""
    return np.array([np.concatenate(rows) for rows in itertools.product(*[rows for _, rows in question.choices])], dtype=float)


class Local:
    """The rows of one local search: goals as they are, bands as the side that each mode has at the start."""

    def __init__(self, question, start):
        self.q, self.free = question, [i for i, v in enumerate(question.variables) if v.values is None]
        self.base, self.base_t = start.copy(), question.t(start[None, :])
        self.lower, self.upper = (question.t(b[None, :])[0][self.free] for b in (question.lower, question.upper))
        self.below = question.kind(start[None, :])[0] if question.configurations else ()
        self._at = {}

    def designs(self, t):
        x, whole = np.repeat(self.base[None, :], len(t), axis=0), np.repeat(self.base_t, len(t), axis=0)
        whole[:, self.free] = t
        x[:, self.free] = self.q.x(whole)[:, self.free]
        return x

    def _values(self, t):
        """[B, 1 + equalities + inequalities], inequalities at least 0."""
        x = self.designs(t)
        q, equal, least = self.q, [], []
        places = np.moveaxis(q.corners(x), -2, 0).reshape(-1, q.n) if q.robust else x
        hz = q.all_frequencies(places)
        for index, _, kind, value in q.rows(places, hz):
            if "weight" in q.goals[index]:
                continue
            if kind == "=":
                equal.extend(value.reshape(-1, len(x)))
            elif kind == "<":
                least.extend(-value.reshape(-1, len(x)))
        position = 0
        for c in q.configurations:
            for band in q.bands[c]:
                count, position = self.below[position], position + 1
                with np.errstate(divide="ignore"):
                    if count > 0:
                        least.extend(np.log(band.lower / hz[c][:, count - 1]).reshape(-1, len(x)))
                    if count < hz[c].shape[1]:
                        least.extend(row for row in np.log(hz[c][:, count] / band.upper).reshape(-1, len(x)) if not np.isnan(row).any())
        return self.cost(x), np.array(equal).reshape(len(equal), len(x)).T, np.array(least).reshape(len(least), len(x)).T

    def cost(self, x):
        value = self.q.cost(x)
        return 0.5 * value * value if self.q.objectives[0].get("minimise") in ("change", "misfit") else value

    def at(self, t):
        """Values and their slopes at t, remembered."""
        key = t.tobytes()
        if key not in self._at:
            n = len(t)
            points = np.concatenate([t[None, :], t + STEP * np.eye(n), t - STEP * np.eye(n)])
            cost, equal, least = self._values(np.clip(points, self.lower, self.upper))
            width = (np.clip(points[1:n + 1], self.lower, self.upper) - np.clip(points[n + 1:], self.lower, self.upper)).max(axis=1)
            slope = lambda v: (v[1:n + 1] - v[n + 1:]).T / width
            self._at = {key: (cost[0], slope(cost), equal[0], slope(equal).reshape(-1, n), least[0], slope(least).reshape(-1, n))}
        return self._at[key]

    def run(self, iterations=60):
        """The design that SLSQP ends at."""
        start = np.clip(self.q.t(self.base[None, :])[0][self.free], self.lower, self.upper)
        if len(start) == 0:
            return self.base
        scale = max(abs(self.at(start)[0]), 1e-3)
        constraints = []
        if self.at(start)[2].size:
            constraints.append({"type": "eq", "fun": lambda t: self.at(t)[2], "jac": lambda t: self.at(t)[3]})
        if self.at(start)[4].size:
            constraints.append({"type": "ineq", "fun": lambda t: self.at(t)[4], "jac": lambda t: self.at(t)[5]})
        try:
            warnings.simplefilter("ignore", RuntimeWarning)  # SLSQP steps outside the bounds by rounding
            found = minimize(lambda t: self.at(t)[0] / scale, start, jac=lambda t: self.at(t)[1] / scale, method="SLSQP",
                             bounds=list(zip(self.lower, self.upper)), constraints=constraints,
                             options={"maxiter": iterations, "ftol": 1e-13})
        except (ValueError, np.linalg.LinAlgError):  # no value on the way
            return self.base
        t = np.clip(found.x, self.lower, self.upper) if np.all(np.isfinite(found.x)) else start
        return self.designs(self._repaired(t)[None, :])[0]

    def _repaired(self, t):
        """Newton steps of least norm onto the rows that are missed, within the bounds."""
        for _ in range(6):
            _, _, equal, d_equal, least, d_least = self.at(t)
            # rows that almost hold are kept from falling, too
            rows = np.concatenate([equal, least[least < 1e-9] - 1e-10])
            slopes = np.concatenate([d_equal, d_least[least < 1e-9]])
            if rows.size == 0 or not np.all(np.isfinite(rows)) or np.abs(rows).max() < 2e-10 or not np.all(np.isfinite(slopes)):
                break
            open_ = (t > self.lower) & (t < self.upper)
            step = np.zeros_like(t)
            if open_.any():
                step[open_] = -np.linalg.lstsq(slopes[:, open_], rows, rcond=1e-10)[0]
            t = np.clip(t + step, self.lower, self.upper)
        return t


def least_missed(question, designs, missed, count):
    """The best `count` of designs that miss so much: feasible ones by objective, else those that miss least; and which are feasible."""
    cost = question.cost(designs)
    feasible = missed <= 1.0
    good = np.flatnonzero(feasible)[np.argsort(cost[feasible], kind="stable")]
    near = np.argsort(np.where(feasible, np.inf, missed), kind="stable")
    return designs[(good if len(good) else near)[:count]], good


def descend(question, starts):
    """Ends of local searches from each start, with what they miss."""
    ends = [Local(question, start).run() for start in starts]
    x = np.array(ends)
    return x, question.missed_robustly(x), question.cost(x)

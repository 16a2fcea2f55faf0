# SPDX-License-Identifier: GPL-3.0-or-later
"""Equilibrium and modes of an oracle's mechanism: first in floats from the drawing to the neighbourhood of rest, then Newton in eighty digits."""
from decimal import Decimal

import exact
import numpy as np
from oracle import Measure, Oracle, Refused

STEPS = 400          # of the search in floats
LARGEST_STEP = 0.05  # m or rad per step there: the branch of the drawing is followed
DRIVE_STEPS = 10
POLISH = 12          # Newton steps in decimals; each doubles the digits
AT_REST = Decimal("1e-40")


class State:
    """Value, slopes and curvature of everything at q."""

    def __init__(self, problem, q, force, drive):
        self.problem, self.q, self.force = problem, q, force
        oracle, n = problem.oracle, len(q)
        zero = q[0] * 0
        self.cast = type(zero)
        self.gradient = [zero] * n
        self.parts = []     # (size, [(factor, quad)], [(factor, g, g)]) of the springs
        self.forces = []    # gradients of the springs' and the weights' shares: what cancels in equilibrium
        self.trim_slope = None
        for form, vector in problem.forces(self.cast):
            share = {}
            for f, x in zip(form, vector):
                for i, y in f.items():
                    if i >= 0:
                        share[i] = share.get(i, zero) - x * y
            self._push(share)
        for spring in oracle.springs:
            self._spring(spring, force)
        self.rows, self.gaps, self.row_parts = [], [], []
        for measure, target in problem.rows(drive):
            value, slope, bent, outer = measure.at(q)
            self.rows.append([slope.get(i, zero) for i in range(n)])
            self.gaps.append(value - self.cast(target))
            self.row_parts.append((bent, outer))

    def _push(self, share):
        self.forces.append(share)
        for i, x in share.items():
            self.gradient[i] += x

    def _spring(self, spring, force):
        cast = self.cast
        found = [m.at(self.q) for m in spring.measures]
        d = [f[0] - cast(r) for f, r in zip(found, spring.rest)]
        k = [[cast(x) for x in row] for row in spring.k]
        if spring is self.problem.oracle.trim:
            pull = [force]
            self.trim_slope = found[0][1]
        else:
            pull = [cast(t) + sum(x * y for x, y in zip(row, d)) for t, row in zip(spring.tension, k)]
        share, bent, outer = {}, [], []
        for p, (_, slope, b, o) in zip(pull, found):
            for i, x in slope.items():
                share[i] = share.get(i, 0) + p * x
            if p:
                bent += [(p * f, quad) for f, quad in b]
                outer += [(p * f, g, h) for f, g, h in o]
        elastic = [(k[i][j], found[i][1], found[j][1]) for i in range(len(k)) for j in range(i + 1) if k[i][j]]
        self.parts.append((bent, outer, elastic))
        self._push(share)

    def _bent(self, u, bent, outer):
        total = self.cast(0)
        for f, quad in bent:
            total += f * sum((h * u[i] * u[j] * (1 if i == j else 2) for (i, j), h in quad.curves(self.cast)), self.cast(0))
        return total + self._outer(u, outer)

    def _outer(self, u, outer):
        return sum((f * along(g, u) * along(h, u) * (2 if g is not h else 1) for f, g, h in outer), self.cast(0))

    def hessian(self, y):
        """V'' + sum y_i c_i''."""
        n = len(self.q)
        out = [[self.cast(0)] * n for _ in range(n)]
        for bent, outer, elastic in self.parts:
            _add(out, 1, bent, outer + elastic, self.cast)
        for w, (bent, outer) in zip(y, self.row_parts):
            if w:
                _add(out, w, bent, outer, self.cast)
        return out

    def reach(self, u):
        """What the springs could store if no joint were in their way: sum of |k| |g|^2 |u|^2."""
        springs = sum((abs(f) * max(sum(x * x for x in g.values()), sum(x * x for x in h.values())) for _, _, e in self.parts for f, g, h in e), self.cast(0))
        return springs * sum(x * x for x in u)

    def terms(self, y, u):
        """What u' H u is a sum of, spring by spring: (elastic, geometric)."""
        elastic = [self._outer(u, e) for _, _, e in self.parts]
        geometric = [self._bent(u, b, o) for b, o, _ in self.parts] + [w * self._bent(u, b, o) for w, (b, o) in zip(y, self.row_parts) if w]
        return elastic, geometric


def along(g, u):
    return sum((x * u[i] for i, x in g.items()), u[0] * 0)


def _add(out, scale, bent, outer, cast):
    for f, quad in bent:
        for (i, j), h in quad.curves(cast):
            x = scale * f * h
            out[i][j] += x
            if i != j:
                out[j][i] += x
    for f, g, h in outer:  # f g g', or f (g h' + h g')
        for i, x in g.items():
            w = scale * f * x
            for j, z in h.items():
                out[i][j] += w * z
                if g is not h:
                    out[j][i] += w * z


class Problem:
    def __init__(self, oracle):
        self.oracle = oracle
        self.drawn = oracle.drawn()
        self.rotation_rows = [Measure([p], lambda v: (v[0], [1], {})) for p in oracle.rotations()]
        for spring in oracle.springs:
            spring.rest = [m.at(self.drawn)[0] if r is None else r for m, r in zip(spring.measures, spring.rest)]
        self.targets = [m.at(self.drawn)[0] if t is None else t for m, t in oracle.constraints]
        self.pull = oracle.v(oracle.settings["gravity_m_per_s2"]) if oracle.settings["gravity_m_per_s2"] else None
        self._forces = {}

    def forces(self, cast):
        """Weights and dead forces: (point, force)."""
        if cast not in self._forces:
            weights = [(form, [m * g for g in self.pull]) for form, m in self.oracle.weights] if self.pull else []
            self._forces[cast] = [([{i: cast(x) for i, x in f.items()} for f in form], [cast(x) for x in force])
                                  for form, force in weights + self.oracle.forces]
        return self._forces[cast]

    def rows(self, drive):
        """(measure, target) of all constraints; drive None: that of the driven joint is left out."""
        yield from ((m, 0) for m in self.rotation_rows)
        yield from zip((m for m, _ in self.oracle.constraints), self.targets)
        if drive is not None:
            yield self.oracle.driven[0], drive

    def state(self, q, force=0, drive=None):
        return State(self, q, type(q[0])(force), drive)

    # equilibrium --------------------------------------------------------------------------------------------------------------------------------
    def search(self):
        """Floats: q, force of the trimmed spring, near rest."""
        try:
            with np.errstate(all="ignore"):
                return self._searched()
        except ZeroDivisionError as error:
            raise Refused("a spring without length") from error

    def _searched(self):
        q, force = np.array([float(x) for x in self.drawn]), 0.0
        if self.oracle.driven is None:
            return self._descend(q, force, None)
        for k in range(1, DRIVE_STEPS + 1):
            q, force = self._descend(q, force, float(self.oracle.driven[1]) * k / DRIVE_STEPS, 1e-5 if k < DRIVE_STEPS else 1e-13)
        return q, force

    def _descend(self, q, force, drive, enough=1e-13):
        trim = self.oracle.trim is not None
        for k in range(STEPS):
            s = self.state(q.tolist(), force, drive)
            a, g, c = np.array(s.rows).reshape(-1, len(q)), np.array(s.gradient), np.array(s.gaps)
            z, fit = _float_null(a)
            close = -fit @ c
            y = -np.linalg.lstsq(a.T, g, rcond=1e-10)[0] if len(a) else []
            h = np.array(s.hessian(y))
            change = np.zeros(len(q))
            dforce = 0.0
            if z.shape[1] + trim:
                if trim:
                    change, dforce = self._trim_step(s, z, a, h, g, close)
                else:
                    r = -z.T @ (g + h @ close)
                    w, v = np.linalg.eigh(z.T @ h @ z)
                    top = max(np.abs(h).max(), sum(f for _, _, e in s.parts for f, _, _ in e if f > 0))
                    pull, push = v.T @ r, max((abs(x) for share in s.forces for x in share.values()), default=0.0)
                    keep = (np.abs(w) > 1e-11 * top) | (np.abs(pull) > 1e-9 * push)  # a force without stiffness is followed, too
                    change = z @ (v[:, keep] @ (pull[keep] / np.maximum(np.abs(w[keep]), 1e-6 * (top + push))))
            step = close + change
            if not np.all(np.isfinite(step)):
                break
            size = np.abs(step).max(initial=0.0)
            short = min(1.0, LARGEST_STEP / size) if size else 1.0
            q, force = q + short * step, force + short * dforce
            if size < enough:
                return q, force
            if size < 1e-9 and k > 50:
                return q, force
        raise Refused("no equilibrium found")

    def _trim_step(self, s, z, a, h, g, close):
        z0, _ = _float_null(a[:-1])
        gm = np.array([s.trim_slope.get(i, 0.0) for i in range(len(g))])
        m = np.column_stack([z0.T @ h @ z, z0.T @ gm])
        x = np.linalg.lstsq(m, -z0.T @ (g + h @ close), rcond=1e-12)[0]
        return z @ x[:-1], x[-1]

    def polish(self, q, force):
        """Decimals: the state at rest with its multipliers."""
        q, force = [Decimal(float(x)) for x in q], Decimal(float(force))
        locked = self.oracle.driven[1] if self.oracle.driven else None
        trim = self.oracle.trim is not None
        for _ in range(POLISH):
            s = self.state(q, force, locked)
            f = Frame(s)
            y = f.multipliers(s.gradient)
            h = s.hessian(y)
            close = f.particular()
            if trim:
                free = Frame(self.state(q, force, None))
                m = [row + [along(s.trim_slope, a)] for row, a in zip(between(h, free.z, f.z), free.z)]
                r = [-dot(a, [x + w for x, w in zip(s.gradient, times(h, close))]) for a in free.z]
            else:
                m = between(h, f.z, f.z)
                pushed = [x + w for x, w in zip(s.gradient, times(h, close))]
                r = [-dot(a, pushed) for a in f.z]
            size = max((abs(x) for row in h for x in row), default=Decimal(0)) + sum(f for _, _, e in s.parts for f, _, _ in e if f > 0)
            x, left = _consistent(m, r, size)
            dforce = x[-1] if trim and x else Decimal(0)
            dq = [c + sum((w * z[i] for w, z in zip(x, f.z)), Decimal(0)) for i, c in enumerate(close)]
            q = [a + b for a, b in zip(q, dq)]
            force += dforce
            if max((abs(x) for x in dq), default=0) < AT_REST:
                size = max((abs(x) for share in s.forces for x in share.values()), default=Decimal(0))
                if left > exact.ZERO * (size + 1):
                    raise Refused("no equilibrium")
                return self.state(q, force, locked if not trim else None)
        raise Refused("did not converge")

    def loaded(self):
        """Is there anything that could move it out of its drawing?"""
        return any(any(force) for _, force in self.forces(Decimal)) or self.oracle.driven is not None \
            or any(any(s.tension) or any(r != m.at(self.drawn)[0] for m, r in zip(s.measures, s.rest)) for s in self.oracle.springs)


def live(x):
    return [(i, v) for i, v in enumerate(x) if v]


def times(h, x):
    part = live(x)
    return [sum((row[i] * v for i, v in part if row[i]), Decimal(0)) for row in h]


def between(h, left, right):
    """left' h right of lists of vectors; h is symmetric."""
    rows, columns = [live(row) for row in h], []
    for b in right:
        hb = [Decimal(0)] * len(h)
        for j, v in live(b):
            for i, x in rows[j]:
                hb[i] += x * v
        columns.append(hb)
    return [[sum((x * hb[i] for i, x in part if hb[i]), Decimal(0)) for hb in columns] for part in map(live, left)]


def dot(a, b):
    return sum((x * y for x, y in zip(a, b) if x and y), Decimal(0))


def _float_null(a):
    if not len(a):
        return np.eye(a.shape[1]), np.zeros((a.shape[1], 0))
    u, s, vt = np.linalg.svd(a)
    rank = int(np.sum(s > 1e-9 * s[0]))
    return vt[rank:].T, (vt[:rank].T / s[:rank]) @ u[:, :rank].T


def _consistent(m, r, size):
    """A solution of m x = r with zero where x is free, and what no x can reach; m is made of terms of this size."""
    if not m:
        return [], Decimal(0)
    n = len(m[0])
    rows, pivots, _, _ = exact.eliminate([list(a) + [b] for a, b in zip(m, r)], n, exact.ZERO, size)
    x = [Decimal(0)] * n
    for row, p in zip(rows, pivots):
        x[p] = row[n]
    left = max((abs(b - dot(a, x)) for a, b in zip(m, r)), default=Decimal(0))
    return x, left


class Frame:
    """The constraints at a state: a basis of what they leave, their independent rows."""

    def __init__(self, state):
        n = len(state.q)
        self.state, self.n = state, n
        augmented = [row + [-gap] for row, gap in zip(state.rows, state.gaps)]
        rows, pivots, free, self.chosen = exact.eliminate(augmented, n, exact.ZERO)
        self.pivots, self.free, self.reduced = pivots, free, rows
        self.z = []
        for f in free:
            z = [Decimal(0)] * n
            z[f] = Decimal(1)
            for row, p in zip(rows, pivots):
                z[p] = -row[f]
            self.z.append(z)
        self.redundant = len(state.rows) - len(pivots)

    def particular(self):
        x = [Decimal(0)] * self.n
        for row, p in zip(self.reduced, self.pivots):
            x[p] = row[self.n]
        return x

    def multipliers(self, gradient):
        """A' y = -gradient on the independent rows; zero on the others."""
        y = [Decimal(0)] * len(self.state.rows)
        if self.chosen:
            rows = self.state.rows
            found = exact.solve([[rows[i][p] for i in self.chosen] for p in self.pivots], [[-gradient[p] for p in self.pivots]])[0]
            for i, x in zip(self.chosen, found):
                y[i] = x
        return y

    def dead_centre(self):
        """Rows that depend on each other at this very position: some y with A' y = 0 and Z'(sum y_i c_i'')Z not zero."""
        if not self.redundant:
            return False
        s = self.state
        columns = [[row[i] for row in s.rows] for i in range(self.n)]
        basis, _ = exact.null_space(columns, len(s.rows), Decimal(1), exact.ZERO)
        for y in basis:
            h = [[Decimal(0)] * self.n for _ in range(self.n)]
            size = Decimal(0)
            for w, (bent, outer) in zip(y, s.row_parts):
                if w:
                    _add(h, w, bent, outer, Decimal)
                    size = max(size, abs(w))
            for a in self.z:
                ha = times(h, a)
                if any(abs(dot(ha, b)) > exact.ZERO * size for b in self.z):
                    return True
        return False


class Modes:
    """lambda ascending; of each: the vector in the coordinates (mass-normalised), its terms' size, whether it is zero."""

    def __init__(self, problem, state=None):
        self.problem, self.loaded = problem, problem.loaded()
        if self.loaded and problem.oracle.beams:
            raise Refused("loaded beam")
        self.state = state or (problem.polish(*problem.search()) if self.loaded else problem.state(problem.drawn))
        self.frame = Frame(self.state)
        self.freedoms, self.redundant = len(self.frame.z), self.frame.redundant
        self.dead_centre = self.frame.dead_centre()
        self.y = self.frame.multipliers(self.state.gradient)
        z = self.frame.z
        h = self.state.hessian(self.y)
        m = [[Decimal(0)] * self.frame.n for _ in range(self.frame.n)]
        for (i, j), x in problem.oracle.mass.items():
            m[i][j] = x
            m[j][i] = x
        k, mm = (between(matrix, z, z) for matrix in (h, m))
        self.massless = 0
        low, back = exact.cholesky(mm), None
        if low is None:
            k, mm, back = self._condensed(k, mm)
            low = exact.cholesky(mm)
        n = len(k)
        half = [exact.forward(low, [k[i][j] for i in range(n)]) for j in range(n)]  # columns of L^-1 K
        self.values, vectors = exact.jacobi([exact.forward(low, [half[j][i] for j in range(n)]) for i in range(n)])
        self.shapes = []
        for v in vectors:
            x = exact.backward(low, v)
            x = x if back is None else back(x)
            self.shapes.append([sum((w * b[i] for w, b in zip(x, z)), Decimal(0)) for i in range(self.frame.n)])
        self.sizes, reach = [], Decimal(0)
        for u in self.shapes:
            elastic, geometric = self.state.terms(self.y, u)
            self.sizes.append(sum(map(abs, elastic), Decimal(0)) + sum(map(abs, geometric), Decimal(0)))
            reach = max(reach, self.sizes[-1] + self.state.reach(u))
        self.zero = [abs(x) <= exact.NOTHING * reach for x in self.values]
        self.top = max(self.sizes, default=Decimal(0))

    def hz(self):
        """Of the modes that vibrate, ascending."""
        return [x.sqrt() / (2 * exact.PI) for x, zero in zip(self.values, self.zero) if x > 0 and not zero]

    def _condensed(self, k, m):
        """Directions without mass follow the others statically: K11 - K10 K00^-1 K01, M11, and the way back."""
        sizes, t = exact.jacobi(m)
        nothing = exact.NOTHING * max(sizes, default=Decimal(0))
        t = [v for x, v in sorted(zip(sizes, t), key=lambda p: p[0])]
        self.massless = sum(x <= nothing for x in sizes)
        k, m = (between(matrix, t, t) for matrix in (k, m))
        p = self.massless
        k00 = [row[:p] for row in k[:p]]
        size = max((abs(x) for row in k for x in row), default=Decimal(0))
        least = min((abs(x) for x in exact.jacobi(k00)[0]), default=Decimal(0))
        if least <= exact.ZERO * size:
            raise Refused("massless")
        x = exact.solve(k00, [[k[i][j] for i in range(p)] for j in range(p, len(k))])  # columns K00^-1 K01
        reduced = [[k[i][j] - dot(k[i][:p], x[j - p]) for j in range(p, len(k))] for i in range(p, len(k))]

        def back(v):
            full = [-sum((w * x[j][i] for j, w in enumerate(v)), Decimal(0)) for i in range(p)] + list(v)
            return [sum((w * b[i] for w, b in zip(full, t)), Decimal(0)) for i in range(len(k))]
        return reduced, [row[p:] for row in m[p:]], back

    def shifted(self, values=None, read=None):
        """The same with other values of parameters, or its numbers read otherwise, at rest next to here."""
        o = self.problem.oracle
        near = Problem(Oracle(o.model, o.name, values, read or o.read))
        return Modes(near, near.polish(self.state.q, self.state.force) if self.loaded else None)

    def blocked(self):
        """Is there a spring that no motion stretches?"""
        return any(all(abs(along(g, z)) <= exact.ZERO for z in self.frame.z) for _, _, elastic in self.state.parts for f, g, _ in elastic if f)

    def motion(self, i):
        """Mode i at the bodies' centres: {"b0.x": ..., "b0.rz": ...}; turning by the rotation vector."""
        q, u, dim, out = self.state.q, self.shapes[i], self.problem.oracle.dim, {}
        for name, body in self.problem.oracle.bodies.items():
            at = body.first
            out.update({f"{name}.{'xyz'[k]}": u[at + k] for k in range(dim)})
            if body.turns and dim == 2:
                out[f"{name}.rz"] = q[at + 2] * u[at + 3] - q[at + 3] * u[at + 2]
            elif body.turns:
                row = lambda v, k, at=at: v[at + 3 + 3 * k:at + 6 + 3 * k]
                for k in range(3):  # R' = w^ R
                    out[f"{name}.r{'xyz'[k]}"] = dot(row(u, (k + 2) % 3), row(q, (k + 1) % 3))
        return out

    def momenta(self, about):
        """{"x": (r' M r, M r), ...}: r moves all bodies by 1 along an axis, or by 1 rad about one through a point."""
        q, o, out = self.state.q, self.problem.oracle, {}
        for name in ("x", "y", "rz") if o.dim == 2 else ("x", "y", "z", "rx", "ry", "rz"):
            axis, r = "xyz".index(name[-1]), [Decimal(0)] * self.frame.n
            for body in o.bodies.values():
                at, k, m = body.first, (axis + 1) % 3, (axis + 2) % 3
                if len(name) == 1:
                    r[at + axis] = Decimal(1)
                    continue
                r[at + k], r[at + m] = about[m] - q[at + m], q[at + k] - about[k]
                if body.turns and o.dim == 2:
                    r[at + 2], r[at + 3] = -q[at + 3], q[at + 2]
                elif body.turns:  # R' = e^ R
                    for i in range(3):
                        r[at + 3 + 3 * k + i], r[at + 3 + 3 * m + i] = -q[at + 3 + 3 * m + i], q[at + 3 + 3 * k + i]
            momentum = [Decimal(0)] * self.frame.n
            for (i, j), x in o.mass.items():
                momentum[i] += x * r[j]
                momentum[j] += x * r[i] if i != j else 0
            out[name] = dot(r, momentum), momentum
        return out

    def kinetic(self, i):
        """Shares of mode i of all bodies, motion times momentum: {"b0.x": ..., "b0.rz": ...}, in sum 1."""
        q, u, oracle, motion, out = self.state.q, self.shapes[i], self.problem.oracle, self.motion(i), {}
        w = [Decimal(0)] * len(u)
        for (a, b), x in oracle.mass.items():
            w[a] += x * u[b]
            if a != b:
                w[b] += x * u[a]
        for name, body in oracle.bodies.items():
            at = body.first
            momentum = {f"{name}.{'xyz'[k]}": w[at + k] for k in range(oracle.dim)}
            if body.turns and oracle.dim == 2:
                momentum[f"{name}.rz"] = q[at + 2] * w[at + 3] - q[at + 3] * w[at + 2]
            elif body.turns:
                row = lambda v, k, at=at: v[at + 3 + 3 * k:at + 6 + 3 * k]
                for k in range(3):  # of a turn R' = e^ R
                    momentum[f"{name}.r{'xyz'[k]}"] = (dot(row(w, (k + 2) % 3), row(q, (k + 1) % 3)) - dot(row(w, (k + 1) % 3), row(q, (k + 2) % 3)))
            out.update({key: motion[key] * p for key, p in momentum.items()})
        return out

    def strain(self, i):
        """Shares of mode i of the springs, by name."""
        elastic, _ = self.state.terms(self.y, self.shapes[i])
        out = {}
        for spring, energy in zip(self.problem.oracle.springs, elastic):
            out[spring.name] = out.get(spring.name, Decimal(0)) + energy / self.values[i]
        return out

    def centre(self):
        """Of all masses, at rest."""
        q, weights = self.state.q, self.problem.oracle.weights
        total = sum(m for _, m in weights)
        return [sum(m * sum(x * (q[i] if i >= 0 else 1) for i, x in form[k].items()) for form, m in weights) / total for k in range(self.problem.oracle.dim)] if total else None

    def counts(self):
        return {"freedoms": self.freedoms, "rigid": sum(self.zero), "unstable": sum(x < 0 and not z for x, z in zip(self.values, self.zero))}


def modes(model, read=exact.number):
    """Of the model's first configuration."""
    return Modes(Problem(Oracle(model, read=read)))

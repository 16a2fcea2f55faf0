#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Models at the limits of sixteen digits against an independent mechanics in eighty.

The command line is that of every campaign (tests/support/campaign.py), and --far F.

What the data determine is asked of the oracle: every number of the file is changed by a relative 1e-30, more or less, of random sign, every coordinate by that part of
the mechanism's size, and what that changes in an eigenvalue, relative, over 1e-30, is its condition. Held are: counts, and kinds unless
roundings of the data leave it open whether the eigenvalue is 0; error <= bound for every mode; where the condition is at most 1e4, error <= 1e-10 of the eigenvalue. The table's last columns judge the bound: how much of it the error
takes at worst, and how many times it exceeds what the data leave open, condition times 2^-53.
"""
import json
import math
import subprocess
import sys
import time
from decimal import Decimal
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parent), *(str(Path(__file__).resolve().parents[1] / room) for room in ("mechanisms", "support"))]

import campaign  # noqa: E402  first: it sets what numpy reads
import statics  # noqa: E402
from exact import binary, cholesky  # noqa: E402
from extremes import FAMILIES  # noqa: E402
from hanging import Hanging  # noqa: E402
from oracle import Oracle, Refused  # noqa: E402

WANTED = Decimal("1e-10")   # of an eigenvalue that the data determine
DETERMINED = Decimal("1e4")  # condition up to which they do: a hundred roundings of it are 1e-10
OPEN = Decimal("1e6")        # from here on rest, or which way a dead centre leads, may itself be lost, and the program says so
UNIT = Decimal(2) ** -53
ROUNDINGS = 16              # of as many numbers: what a decimal drawing says is 0 is no more than this as it is read
NEAR = Decimal("1e-9")      # m and rad, of what rests as drawn
STEP = Decimal("1e-30")
PLACES = ("at", "centre", "from", "to")
COUNTS = ("elements", "dimension", "index", "fraction")


# what the data determine -----------------------------------------------------------------------------------------------------------------------------------
def _size(model):
    """Of the mechanism: its largest coordinate."""
    def numbers(value):
        if isinstance(value, list):
            return max(map(numbers, value), default=Decimal(0))
        return Decimal(0) if isinstance(value, str) else abs(binary(value))
    lists = [model] + [item for key in ("bodies", "links", "joints", "springs", "loads") for item in model.get(key, [])]
    return max((numbers(item[m]) for item in lists for m in PLACES if m in item), default=Decimal(0))


def moved(model, sign, places):
    """The same with every number changed; coordinates where `places` says how: (value) -> change."""
    def change(value, place):
        if isinstance(value, list):
            return [change(v, place) for v in value]
        if isinstance(value, (str, bool)) or value is None:
            return value
        x = binary(value)
        return x + (places(x) if place else x * sign() * STEP)

    def walk(value, place):
        if isinstance(value, dict):
            return {k: v if k in COUNTS or k.startswith("axis") or k == "hinge_axis" else walk(v, k in PLACES) for k, v in value.items()}
        if isinstance(value, list) and value and isinstance(value[0], dict):
            return [walk(v, False) for v in value]
        return change(value, place)
    return walk(model, False)


def at_rest(model):
    """Modes of the model's first configuration; what rests as drawn is not searched for."""
    problem = statics.Problem(Oracle(model, read=binary))
    if problem.loaded() and not problem.oracle.driven:
        try:
            state = problem.polish([float(x) for x in problem.drawn], 0.0)
            if max(abs(a - b) for a, b in zip(state.q, problem.drawn)) <= NEAR:  # else Newton may have gone anywhere
                return statics.Modes(problem, state)
        except Refused:
            pass
    return statics.Modes(problem)


def volume(modes, rows):
    """The square of what these constraints span: 0 where they depend on each other."""
    rows = [modes.state.rows[i] for i in rows]
    low = cholesky([[statics.dot(a, b) for b in rows] for a in rows])
    return math.prod((x[i] * x[i] for i, x in enumerate(low)), start=Decimal(1)) if low else Decimal(0)


class Exact:
    """Eigenvalues, counts and conditions of a model as the program reads it."""

    def __init__(self, model, rng):
        one = at_rest(model)
        if one.dead_centre:
            raise Refused("dead centre")
        self.one = one
        self.asked = []
        self.values, self.zero, self.kept = one.values, one.zero, {**one.counts(), "redundant": one.redundant}
        size = _size(model) * STEP
        sign = lambda: rng.choice([1, -1]) * Decimal(rng.uniform(0.5, 1))  # of equal sizes some would cancel
        by_value = {}
        ways = [lambda x: sign() * size,                                             # every place for itself
                lambda x: by_value.setdefault(x, sign()) * size,                     # equal numbers together: what coincides stays so
                lambda x: Decimal(0)]                                                # the drawing is exact: joints are redundant in it
        self.condition = None
        for places in ways:
            try:
                near = [at_rest(moved(model, sign, places)) for _ in range(2)]
            except Refused:
                continue
            if all({**n.counts(), "redundant": n.redundant} == self.kept for n in near):
                self.condition = [max(abs(n.values[i] - x) for n in near) / abs(x) / STEP if not z else Decimal(0) for i, (x, z) in enumerate(zip(self.values, self.zero))]
                self.near = near
                return
        raise Refused("no neighbour")

    def judge(self, row, said):
        return judge(row, self, said)

    def open(self):
        """The worst condition: of an eigenvalue, or of the joints' independence, which says whether there is a dead centre."""
        rows = self.one.frame.chosen
        here = volume(self.one, rows)
        return max([abs(volume(n, rows) / here - 1) / STEP if here else 1 / STEP for n in self.near] + self.condition)


class Chain:
    """A row of masses and springs by Sturm's sequence: its lowest eigenvalues, which sums of positive terms determine."""
    MODES = 3

    def __init__(self, model):
        self.k = [binary(s["stiffness_n_per_m"]) for s in model["springs"]] + [Decimal(0)]
        self.m = [binary(b["mass_kg"]) for b in model["bodies"]]
        self.values = [self._value(i + 1) for i in range(self.MODES)]
        self.zero, self.condition = [False] * self.MODES, [Decimal(1)] * self.MODES
        self.kept = {"freedoms": len(self.m), "rigid": 0, "unstable": 0, "redundant": 0}
        self.asked = ["--count", str(self.MODES)]

    def judge(self, row, said):
        return judge(row, self, said)

    def open(self):
        return max(self.condition)

    def _below(self, x):
        count, before = 0, None
        for i, m in enumerate(self.m):
            d = self.k[i] + self.k[i + 1] - x * m - (self.k[i] ** 2 / before if before is not None else 0)
            before = d or Decimal("1e-70")
            count += before < 0
        return count

    def _value(self, i):
        low, high = Decimal("1e-30"), Decimal("1e30")
        while high / low > 4:
            middle = (low * high).sqrt()
            low, high = (low, middle) if self._below(middle) >= i else (middle, high)
        while high - low > Decimal("1e-20") * low:
            middle = (low + high) / 2
            low, high = (low, middle) if self._below(middle) >= i else (middle, high)
        return low


class Star(Chain):
    """The same of arms on a hub: the arms first."""
    MODES = 6

    def _below(self, x):
        hub, count = sum(self.k, Decimal(0)) - x * self.m[0], 0
        for k, m in zip(self.k[1:], self.m[1:]):
            d = k - x * m or Decimal("1e-70")
            hub -= k * k / d
            count += d < 0
        return count + (hub < 0)


COUNTED = {"long chains": Chain, "large trees": Chain, "large stars": Star, "hanging chains": Hanging, "hanging stacks": Hanging, "hanging swings": Hanging}


# what the program says -------------------------------------------------------------------------------------------------------------------------------------
class Row:
    """A line of the table."""
    SUMS, WORST = ("cases", "left", "modes", "determined", "seconds"), ("error", "told", "share", "excess")

    def __init__(self, name):
        self.name, self.cases, self.left, self.modes, self.determined = name, 0, 0, 0, 0
        self.error = self.told = self.share = self.excess = Decimal(0)
        self.seconds = 0.0

    def __add__(self, other):
        both = Row(self.name)
        vars(both).update({m: getattr(self, m) + getattr(other, m) for m in self.SUMS}, **{m: max(getattr(self, m), getattr(other, m)) for m in self.WORST})
        return both

    def text(self):
        return f"{self.name:26}{self.cases:6}{self.left:6}{self.modes:7}{self.determined:7}{self.error:10.1e}{self.told:10.1e}{self.share:9.3f}{self.excess:10.1e}{self.seconds:8.1f}"


HEAD = f"{'family':26}{'cases':>6}{'left':>6}{'modes':>7}{'determ.':>7}{'error':>10}{'bound':>10}{'err/bnd':>9}{'bnd/data':>10}{'time s':>8}"


def ask(folder, model, *more):
    path = Path(folder) / "model.json"
    path.write_text(json.dumps(model, indent=1))
    started = time.monotonic()
    more = more or ("--count", "all")
    done = subprocess.run([campaign.PROGRAM, "modes", str(path), "--format", "json", "--quiet", *more], capture_output=True, encoding="utf-8", timeout=120)
    return done, time.monotonic() - started


def judge(row, exact, said):
    """Sentences on what is wrong; counts in the row what is right."""
    counts = {"freedoms": said["freedoms"], "rigid": said["rigid_body_modes"], "unstable": said["unstable_modes"], "redundant": len(said["redundant_constraints"])}
    if counts["freedoms"] != exact.kept["freedoms"] or counts["redundant"] != exact.kept["redundant"]:
        yield "counts", f"counts {counts}, exact {exact.kept}"
        return
    for i, (mode, x, zero, condition) in enumerate(zip(said["modes"], exact.values, exact.zero, exact.condition)):
        given, bound = binary(mode["omega_squared"]), binary(mode["omega_squared_error"])
        error = abs(given - x)
        row.modes += 1
        if error > bound and not (zero and mode["kind"] == "rigid_body"):
            yield "bound", f"mode {i + 1} ({mode['kind']}): omega^2 is {given:.17g} within {bound:.3g}, exact {x:.20g}: {error / bound if bound else error:.3g} times the bound off"
        elif bound:
            row.share = max(row.share, error / bound)
        kind = "rigid_body" if zero else "unstable" if x < 0 else "flexible"
        if mode["kind"] != kind and mode["kind"] != "undecided" and condition * ROUNDINGS * UNIT < 1:
            yield "kind", f"mode {i + 1} is called {mode['kind']}, omega^2 {given:.17g} within {bound:.3g}; exact {x:.20g}, {kind}"
        if zero:
            continue
        open_ = max(condition, 1) * UNIT * abs(x)
        row.excess = max(row.excess, bound / open_)
        if condition > DETERMINED:
            continue
        row.determined += 1
        row.error, row.told = max(row.error, error / abs(x)), max(row.told, bound / abs(x))
        if mode["kind"] == "undecided":
            yield "undecided", f"mode {i + 1} is undecided, omega^2 {given:.17g} within {bound:.3g}; exact {x:.20g}, condition {condition:.1e}"
        if error > WANTED * abs(x):
            yield "accuracy", f"mode {i + 1}: omega^2 is {given:.17g} within {bound:.3g}, exact {x:.20g}, {error / abs(x):.1e} off; condition {condition:.1e}"


class Stress(campaign.Generator):
    script, cases, kinds, tallied = "tests/stress/run.py", "models", tuple(FAMILIES), ("left out",)

    def __init__(self, far=None):
        self.far = far

    def options(self, parser):
        parser.add_argument("--far", type=float, help="0 to 1: how far all of them go; else each at random")

    def asked(self, args):
        self.far = args.far
        return [] if self.far is None else ["--far", str(self.far)]

    def make(self, seed, kind, index):
        rng = campaign.draw("stress", seed, kind, index)
        return campaign.Case(kind, {"model": FAMILIES[kind](rng, rng.uniform(0, 1) if self.far is None else self.far)}, rng)

    def judge(self, case, folder, tally):
        row = tally.setdefault(case.kind, Row(case.kind))
        try:
            exact = COUNTED[case.kind](case.document["model"]) if case.kind in COUNTED else Exact(case.document["model"], case.rng)
        except (Refused, ZeroDivisionError) as why:
            row.left += 1
            raise campaign.LeftOut(why) from None
        done, seconds = ask(folder, case.document["model"], *exact.asked)
        if done.returncode == 3 and any(w in done.stderr for w in ("no equilibrium", "dead centre")) and exact.open() > OPEN:
            row.left += 1
            raise campaign.LeftOut("refused as undetermined")
        row.cases += 1
        row.seconds += seconds
        if done.returncode:
            yield "refused", f"exit code {done.returncode}: {done.stderr.strip()[-400:]}"
        else:
            yield from exact.judge(row, json.loads(done.stdout)[0])

    def table(self, tally):
        return [HEAD, *(row.text() for row in tally.values() if isinstance(row, Row))]


if __name__ == "__main__":
    sys.exit(campaign.main(Stress()))

#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Random mechanisms against an independent mechanics in eighty digits.

The command line is that of every campaign (tests/support/campaign.py).
"""
import json
import random
import subprocess
import sys
from decimal import Decimal
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parent), str(Path(__file__).resolve().parents[1] / "support")]

import campaign  # noqa: E402  first: it sets what numpy reads
import damped  # noqa: E402
import ring  # noqa: E402
import statics  # noqa: E402
from changes import CHANGES  # noqa: E402
from exact import binary, number  # noqa: E402
from families import KINDS  # noqa: E402
from oracle import Refused  # noqa: E402

ACCURACY = Decimal("1e-9")  # of frequencies
SLOPES = Decimal("1e-6")    # of derivatives, in frequency per parameter
MODEST = Decimal("1e-6")    # relative, of a bound where nothing cancels
SHAPES = Decimal("1e-7")    # of shapes, in their largest entry
ABOUT = "0.3,-0.2,0.1"      # point [m] that the ground turns about
SHARES = Decimal("1e-5")    # of energies [%]
STEP = Decimal("1e-20")     # relative, of a parameter; the oracle has eighty digits
LAST_DIGIT = Decimal(2) ** -52
APART = Decimal("1e-4")     # relative; closer frequencies have no derivative of their own


class Answer:
    """What the program says of one configuration."""

    def __init__(self, folder, name, model, command="modes", *more):
        path = folder / f"{name}.json"
        path.write_text(json.dumps(model, indent=1))
        more = [*more, "--count", "all"] if command == "modes" else more
        done = subprocess.run([campaign.PROGRAM, command, str(path), "--format", "json", "--quiet", *more], capture_output=True, encoding="utf-8", timeout=120)
        self.code, self.words = done.returncode, done.stderr
        answer = json.loads(done.stdout) if done.returncode == 0 else None
        self.said = answer[0] if isinstance(answer, list) else answer

    def crashed(self):
        return self.code not in (0, 2, 3) or "runtime error" in self.words or "Sanitizer" in self.words

    def counts(self):
        """What rounding leaves undecided counts as free: that it is exactly so is judged by eighty digits."""
        return {"freedoms": self.said["freedoms"], "rigid": self.said["rigid_body_modes"] + self.said.get("undecided_modes", 0),
                "unstable": self.said["unstable_modes"], "redundant": len(self.said["redundant_constraints"])}

    def hz(self):
        return [number(m["frequency_hz"]) for m in self.said["modes"] if m["kind"] == "flexible"]


class Judgement:
    def __init__(self, folder, kind, rng, model):
        self.folder, self.kind, self.rng, self.model = folder, kind, rng, model
        self.modes = statics.modes(model)
        self.expected = {**self.modes.counts(), "redundant": self.modes.redundant}
        self.hz = self.modes.hz()
        self.tones = 0  # of a motion, that were compared
        self.shares = 0  # of energies, that were compared

    def agree(self, answer, factor=1):
        """Sentences on what an answer of the program has wrong."""
        if answer.crashed():
            yield "exit", f"exit code {answer.code}: {answer.words[-1000:]}"
        elif self.modes.dead_centre:
            if not answer.code:
                yield "dead", "joints depend on each other at this very position, and it is not said"
        elif answer.code:
            yield "refused", f"refused: {answer.words.strip()[-300:]}"
        elif answer.counts() != self.expected:
            yield "counts", f"counts {answer.counts()}, exact {self.expected}"
        else:
            yield from self._numbers(answer, factor)

    def _numbers(self, answer, factor):
        given = answer.hz()
        worst = max(((abs(a / (b * factor) - 1), i) for i, (a, b) in enumerate(zip(given, self.hz))), default=(Decimal(0), 0))
        if worst[0] > ACCURACY:
            i = worst[1]
            yield "frequencies", f"mode {i + 1} is {given[i]} Hz, exact {self.hz[i] * factor:.17g} Hz, {worst[0]:.1e} off"

    def undetermined(self, model, factor):
        """Has the changed model, its numbers turned by their last digit, other frequencies? One of nine decades in a matrix does."""
        rng = random.Random(0)
        try:
            beside = statics.modes(model).shifted(read=lambda value: binary(value) * (1 + Decimal(rng.choice([-1, 1])) * LAST_DIGIT))
        except Refused:
            return False
        hz = beside.hz()
        return len(hz) == len(self.hz) and any(abs(a / (b * factor) - 1) > ACCURACY for a, b in zip(hz, self.hz))

    def bounds(self, answer):
        """The error that is told holds, against the numbers as the program reads them."""
        if not any("omega_squared_error" in mode for mode in answer.said["modes"]):
            return
        try:
            read = self.modes.shifted(read=binary)
        except Refused:
            return  # what is balanced in decimals may not be so in doubles
        if read.counts() != self.modes.counts():
            return  # nor dependent
        for mode, x in zip(answer.said["modes"], read.values):
            given, bound = number(mode["omega_squared"]), number(mode["omega_squared_error"])
            if mode["kind"] == "flexible" and abs(given - x) > bound:
                yield "bounds", f"omega^2 is {given} within {bound:.3g}, exact {x:.20g}, {abs(given - x) / bound:.3g} times the bound off"
                return
            if mode["kind"] == "flexible" and self.modest() and bound > MODEST * given:
                yield "bounds", f"omega^2 is {given} within {bound:.3g}, which says nothing; it is {abs(given - x):.1e} off"
                return

    def modest(self):
        """Is there a reason for more than a few digits to be lost?"""
        return all(x > APART * size for x, size, zero in zip(self.modes.values, self.modes.sizes, self.modes.zero) if not zero)

    def slopes(self):
        """One parameter's derivatives against differences of the oracle."""
        if not self.model.get("parameters") or not self.hz:
            return
        name = self.rng.choice(sorted(self.model["parameters"]))
        answer = Answer(self.folder, "slopes", self.model, "sensitivity", "--parameters", name)
        if answer.code:
            yield "exit", f"sensitivity to {name}: exit code {answer.code}: {answer.words[-300:]}"
            return
        value = number(self.model["parameters"][name]["value"])
        step = STEP * (abs(value) if value else 1) * self.rng.choice([-1, 1])
        try:
            near = self.modes.shifted({name: value + step})
            beside = near.hz()
            if near.counts() != self.modes.counts():
                yield from self._jammed(name, answer, beside, self.modes.shifted({name: value - step}).hz())
                return
        except Refused:
            return  # nor is there rest beside this value
        for i, mode in enumerate(answer.said["modes"]):
            f = self.hz[i]
            if any(abs(g / f - 1) < APART for j, g in enumerate(self.hz) if j != i):
                continue
            exact = (beside[i] - f) / step  # to twenty digits
            given = next(s for s in mode["sensitivities"] if s["parameter"] == name)["hz_per_unit"]
            size = f / abs(value) if value else f
            if given is None or abs(number(given) - exact) > SLOPES * max(abs(exact), size):
                yield "slopes", f"mode {i + 1} ({f:.6g} Hz) to {name}: {given} Hz per unit, exact {exact:.12g}"
                return

    def _jammed(self, name, answer, low, high):
        """Motions are blocked, or held, as soon as the parameter moves: from the first mode that jumps on there is no derivative."""
        if all(len(hz) == len(self.hz) for hz in (low, high)):
            return
        for i, mode in enumerate(answer.said["modes"]):
            if all(i < len(hz) and abs(hz[i] / self.hz[i] - 1) < ACCURACY for hz in (low, high)):
                continue
            given = next(s for s in mode["sensitivities"] if s["parameter"] == name)["hz_per_unit"]
            if given is not None and len(low) < len(self.hz):
                yield "no_slope", f"{name} jams mode {i + 1} ({self.hz[i]:.6g} Hz), and its derivative is {given}"
            return

    def shapes(self, answer):
        """Mass-normalised, of modes that stand alone."""
        values = self.modes.values
        for i, mode in enumerate(answer.said["modes"] if answer.said else []):
            gap = min((abs(values[i] - x) for j, x in enumerate(values) if j != i), default=values[i])
            if mode["kind"] != "flexible" or gap < APART * values[i]:
                continue
            exact = self.modes.motion(i)
            size = max(abs(x) for x in exact.values())
            given = {k: number(x) for k, x in mode["shape"].items()}
            most = max(given, key=lambda k: abs(given[k]))
            sign = 1 if given[most] * exact[most] > 0 else -1
            worst = max(given, key=lambda k: abs(given[k] - sign * exact[k]))
            if abs(given[worst] - sign * exact[worst]) > SHAPES * size:
                yield "shapes", f"mode {i + 1} moves {worst} by {given[worst]}, exact {sign * exact[worst]:.12g}"
                return

    def grounded(self):
        """May a bar or rod have a part of its mass on the ground?"""
        return any("density_kg_per_m3" in s for s in self.model.get("springs", [])) or any("mass_kg" in j for j in self.model.get("joints", []))

    def effective(self, answer):
        """Effective masses of modes that stand alone, and of all together."""
        if self.grounded():
            return
        momenta, values = self.modes.momenta([Decimal(x) for x in ABOUT.split(",")]), self.modes.values
        for row in answer.said["effective_mass"]:
            total, momentum = momenta[row["direction"]]
            exact = [statics.dot(u, momentum) ** 2 for u in self.modes.shapes]
            if abs(number(row["sum"]) - sum(exact)) > SHAPES * total:
                yield "effective", f"effective masses along {row['direction']} sum up to {row['sum']}, exact {float(sum(exact))}"
                return
            for i, (given, own) in enumerate(zip(row["effective_mass"], exact)):
                alone = not self.modes.zero[i] and all(abs(values[i] - x) > APART * max(abs(values[i]), abs(x)) for j, x in enumerate(values) if j != i)
                if alone and abs(number(given) - own) > SHAPES * total:
                    yield "effective", f"mode {i + 1} has an effective mass of {given} along {row['direction']}, exact {float(own)}"
                    return

    def energies(self, answer):
        """By body and direction, and by spring, of modes that stand alone; links by the sum of their elements."""
        values = self.modes.values
        for i, mode in enumerate(answer.said["modes"] if answer.said else []):
            gap = min((abs(values[i] - x) for j, x in enumerate(values) if j != i), default=values[i])
            if mode["kind"] != "flexible" or gap < APART * values[i]:
                continue
            told = mode["energy"]
            given = {f"{b['body']}.{d}": b[f"{d}_percent"] for b in told["kinetic"] for d in ("x", "y", "z", "rx", "ry", "rz")}
            given.update({s["spring"]: s["percent"] for s in told["strain"]})
            exact = {key: x for key, x in self.modes.kinetic(i).items() if key in given}
            for name, x in self.modes.strain(i).items():
                owner = name if name in given else name.rpartition(".")[0]
                if owner in given:
                    exact[owner] = exact.get(owner, Decimal(0)) + x
            self.shares += len(exact)
            for key, x in exact.items():
                if given[key] is None or abs(number(given[key]) - 100 * x) > SHARES:
                    yield "energies", f"mode {i + 1}: {key} has {given[key]} % of the energy, exact {100 * x:.12g} %"
                    return
            for what in ("kinetic", "strain"):
                if abs(number(told[f"{what}_sum_percent"]) - 100) > SHARES:
                    yield "energies", f"mode {i + 1}: {what} energies sum to {told[f'{what}_sum_percent']} %"
                    return

    def rest(self):
        """Where the centre of mass comes to rest."""
        exact = self.modes.centre()
        if exact is None or self.grounded():
            return
        answer = Answer(self.folder, "rest", self.model, "info")
        if answer.code:
            yield "exit", f"info: exit code {answer.code}: {answer.words[-300:]}"
        elif any(abs(number(a) - b) > ACCURACY * (1 + abs(b)) for a, b in zip(answer.said["centre_m"], exact)):
            yield "rest", f"the centre of mass rests at {answer.said['centre_m']}, exact {[float(x) for x in exact]}"

    def damping(self, spoil=None):
        """Complex modes with dampers, loss factors and damping ratios; spoil: a fault, put into what the program reads."""
        if not self.hz or self.modes.massless or self.expected["unstable"]:
            return
        model, dampers, losses = damped.damp(self.rng, self.model, self.modes)
        expected = damped.roots(self.modes, model, dampers, losses)
        if expected is None or (spoil and not spoil(model)):
            return
        answer = Answer(self.folder, "damped", model, "modes", "--damped")
        if answer.code == 3 and "has an undecided mode" in answer.words and {"ratios"} & set(model["damping"]) and any(self.modes.zero):
            return  # of a neutral position: modes have no index that a ratio could be given to
        if answer.code:
            yield "exit", f"modes --damped: exit code {answer.code}: {answer.words[-300:]}"
        else:
            wrong = damped.compare(answer.said, expected)
            yield from [("damped", wrong)] if wrong else []

    def ringing(self, answer, spoil=None):
        """A damped motion against complex modes; spoil: a fault, put into the motion that is read."""
        made = ring.prepare(self.rng, self.model, answer.said)
        if made is None:
            return
        model, amplitude, start = made
        modes = Answer(self.folder, "ring", model, "modes", "--damped")
        motion = Answer(self.folder, "ring", model, "simulate", *start)
        if modes.code or motion.code:
            bad = modes if modes.code else motion
            if not any(words in bad.words for words in ring.EXCUSES):
                yield "ring", f"exit code {bad.code}: {bad.words.strip()[-300:]}"
            return
        if spoil:
            spoil(motion.said)
        self.tones, wrong = ring.compare(motion.said, modes.said, amplitude)
        yield from [("ring", wrong)] if wrong else []

    def findings(self):
        """(check, sentence)."""
        answer = Answer(self.folder, "as_made", self.model, "modes", "--shapes", "--energy", "--effective-mass", "--about", ABOUT)
        found = list(self.agree(answer))
        yield from found
        if found:
            return
        if not answer.code:
            yield from self.bounds(answer)
        for name, change in CHANGES.items():
            changed = change(self.rng, self.model)
            if changed is not None:
                found = list(self.agree(Answer(self.folder, name, changed[0]), changed[1]))
                if any(check == "frequencies" for check, _ in found) and self.undetermined(*changed):
                    continue
                for check, text in found:
                    yield name if check in ("counts", "frequencies", "refused") else check, text
        if not self.modes.dead_centre:
            yield from self.shapes(answer)
            yield from self.effective(answer) if not answer.code else ()
            yield from self.energies(answer)
            yield from self.rest()
            yield from self.slopes()
            yield from self.damping()
            yield from self.ringing(answer) if not answer.code else ()


class Mechanisms(campaign.Generator):
    script, cases, kinds, tallied = "tests/mechanisms/run.py", "mechanisms", tuple(KINDS), ("left out",)

    def make(self, seed, kind, index):
        rng = campaign.draw(seed, kind, index)
        try:
            return campaign.Case(kind, {"model": KINDS[kind](rng)}, rng)
        except Refused as why:
            raise campaign.LeftOut(why) from None

    def judge(self, case, folder, tally):
        try:
            judgement = Judgement(folder, case.kind, case.rng, case.document["model"])
        except Refused as why:
            raise campaign.LeftOut(why) from None
        yield from judgement.findings()
        tally["tones"] += judgement.tones
        tally["shares"] += judgement.shares


if __name__ == "__main__":
    sys.exit(campaign.main(Mechanisms()))

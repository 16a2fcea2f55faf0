#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""No nan, no inf, no division by zero that is told as a number: not in words, tables, CSV, JSON, HTML or figures.

Studies and models are generated at the edges of what has a number: unstable designs, targets and originals of zero, percents of zero, bands that nothing reaches, masses
of zero, trades of one point, empty ranges, axes of any length, numbers at the ends of the range of doubles. The command line is that of
every campaign (tests/support/campaign.py). Without MT_EVERY=1 every fourth kind alone, another one with each seed.
With an instrumented program a division by zero ends it: that is a problem, too.
"""
import copy
import json
import random
import subprocess
import sys
import tempfile
from pathlib import Path

from common_cli import MODEL, PROGRAM, SOURCE  # first: it says where campaign is
import campaign
from suite import EVERY
from common_words import problems_of

EXTREMES = [0, -0.0, 1, -1, 1e-3, 1e3, 1e-9, 1e9, 1e-30, 1e30, 1e-160, 1e160, 1e-200, 1e200, 1e-300, 1e300, 5e-324, 1.7e308, -1e-200, -1e300]
# Exit statuses of an answer or of a reason against one; anything else is a crash or a sanitizer.
FINE = {0, 1, 2, 3, 4}
SECONDS = 60


def two_springs(rng, **changes):
    """The model of the other tests with other numbers."""
    model = json.loads(MODEL)
    model["parameters"]["k1"]["value"] = changes.get("k1", 3)
    model["parameters"]["k2"]["value"] = changes.get("k2", 1)
    model["parameters"]["m"] = changes.get("m", 1)
    return model


def study(goals=None, variables=None, **more):
    document = {"format": "modetune-study/1", "model": "model.json",
                "variables": variables or [{"parameter": "k1", "lower": 0.1, "upper": 100}, {"parameter": "k2", "lower": 0.1, "upper": 100}],
                "goals": goals if goals is not None else [{"type": "frequency", "configuration": "held", "mode": 1, "target_hz": 0.2}]}
    document.update(more)
    return document


def frequency(**more):
    return {"type": "frequency", "configuration": "held", "mode": 1, **more}


def generated(rng):
    """name, model, study"""
    pick = lambda: rng.choice(EXTREMES)
    tiny = rng.choice([1e-300, 1e-200, 1e-30, 0])
    huge = rng.choice([1e300, 1e200, 1e30])
    avoid = {"type": "avoid", "configurations": ["held"]}
    yield "zero originals", two_springs(rng, k1=0), study([frequency(at_least_hz=0.1)], [{"parameter": "k1", "lower": 0, "upper": 10}])
    yield "all originals zero", two_springs(rng, k1=0, k2=0), study([frequency(target_hz=0.1)], [{"parameter": p, "lower": 0, "upper": 10} for p in ("k1", "k2")])
    yield "unstable", two_springs(rng, k1=-1), study(variables=[{"parameter": "k1", "lower": -5, "upper": 5}])
    yield "unstable everywhere", two_springs(rng, k1=-1), study(variables=[{"parameter": "k1", "lower": -5, "upper": -1}])
    yield "unstable, avoid", two_springs(rng, k1=-1), study([{**avoid, "bands_hz": [[0.1, 0.2]], "margin_percent": 5}], [{"parameter": "k1", "lower": -5, "upper": -1}])
    yield "unstable, motion", two_springs(rng, k1=-1), study([frequency(at_least_hz=0.1), frequency(at_most_hz=3)], [{"parameter": "k1", "lower": -2, "upper": 2}])
    yield "target zero", two_springs(rng), study([frequency(target_hz=rng.choice([5e-324, 1e-300, 1e-30]))])
    yield "limits of zero", two_springs(rng), study([frequency(at_most_hz=rng.choice([1e-30, 1e-300])), frequency(at_least_hz=rng.choice([5e-324, 1e300]))])
    yield "unreachable target", two_springs(rng), study([frequency(target_hz=huge)])
    yield "changes of all sizes", two_springs(rng, k1=tiny, k2=huge), study([frequency(at_least_hz=0.1)], [{"parameter": "k1", "lower": 0, "upper": 1e9},
                                                                                                    {"parameter": "k2", "lower": 1, "upper": 2 * huge}])
    yield "trade over all sizes", two_springs(rng), study(trade={"vary": [{"parameter": "m", "values": [tiny, huge]}]})
    yield "one great point", two_springs(rng), study([frequency(at_least_hz=1e-9)], trade={"vary": [{"parameter": "m", "values": [1e9]}]})
    yield "unreachable bands", two_springs(rng), study([{**avoid, "bands_hz": [[0, huge]], "margin_percent": rng.choice([0, 5, 99])}])
    yield "bands from zero", two_springs(rng), study([{**avoid, "bands_hz": [[0, 0.01], [huge, 2 * huge]], "margin_percent": 5}], objective={"maximise": "clearance"})
    yield "clearance of nothing", two_springs(rng), study([{**avoid, "bands_hz": [[tiny, 2 * tiny + 1e-9]], "margin_percent": 0}], objective={"maximise": "clearance"})
    yield "no goals", two_springs(rng), study([])
    yield "no room", two_springs(rng), study(variables=[{"parameter": "k1", "lower": 3, "upper": 3}])
    yield "empty range", two_springs(rng), study(variables=[{"parameter": "k1", "lower": 4, "upper": 3}])
    yield "bounds of all sizes", two_springs(rng), study(variables=[{"parameter": "k1", "lower": tiny, "upper": huge}])
    yield "masses of zero", two_springs(rng, m=0), study(variables=[{"parameter": "k1", "lower": 1, "upper": 10}])
    yield "masses", two_springs(rng, m=rng.choice([1e-300, 1e300, 1e-30])), study()
    yield "mass varies to zero", two_springs(rng), study(variables=[{"parameter": "m", "lower": 0, "upper": 10}])
    yield "one point", two_springs(rng), study(trade={"vary": [{"goal": 0, "member": "target_hz", "values": [0.2]}]})
    yield "trade over nothing", two_springs(rng), study(trade={"vary": [{"goal": 0, "member": "target_hz", "values": [1e-9, 1e9]}]})
    yield "trade at zero", two_springs(rng), study(trade={"vary": [{"parameter": "m", "values": [0, 1]}]})
    yield "trade, unstable", two_springs(rng), study(variables=[{"parameter": "k2", "lower": 0, "upper": 5}], trade={"vary": [{"parameter": "k1", "values": [-3, 0, 3]}]})
    yield "tolerances", two_springs(rng), study([frequency(at_least_hz=0.05, tolerance_percent=rng.choice([0, 1e-9, 99]))],
                                               [{"parameter": "k1", "lower": 0.1, "upper": 100, "tolerance_percent": rng.choice([50, 99, 1e-9])}])
    yield "tolerances over zero", two_springs(rng, k1=0), study([frequency(at_least_hz=1e-6)], [{"parameter": "k1", "lower": 0, "upper": 1, "tolerance_percent": 50}])
    yield "weights", two_springs(rng), study([frequency(target_hz=0.1, weight=rng.choice([0, 1e-300, 1e300])), frequency(target_hz=0.3, weight=1)], objective={"minimise": "misfit"}, spread={"factor": rng.choice([2, 1e300])})
    yield "spread of nothing", two_springs(rng), study([frequency(target_hz=0.1, weight=1)], [{"parameter": "k1", "lower": 0, "upper": 1}], objective={"minimise": "misfit"}, spread={"factor": 2})
    yield "published zeros", two_springs(rng), study(published=[{"parameter": "k1", "value": 0, "tolerance_percent": 1}, {"parameter": "k2", "value": pick(), "tolerance": 1}])
    yield "parameter goals", two_springs(rng), study([{"type": "limit", "expression": "k1", "at_least": 0}, {"type": "limit", "expression": "k1-k2", "equals": pick()}])
    damped = two_springs(rng, k1=rng.choice([0, 3, pick()]), m=rng.choice([0, 1, pick()]))
    damped["dampers"] = [{"name": "d", "type": "axial", "bodies": ["ground", "a"], "at": ["o", [1, 0]], "damping_n_s_per_m": abs(pick())}]
    yield "dampers", damped, study()
    yield "catalogue", two_springs(rng, k1=0), study([frequency(at_least_hz=0.01)], [{"parameter": "k1", "catalogue": [0, 1, 2]}])
    yield "anything", two_springs(rng, k1=pick(), k2=pick(), m=pick()), study([frequency(target_hz=pick())], [{"parameter": "k1", "lower": pick(), "upper": pick()}])
    yield "anything avoided", two_springs(rng, k1=pick(), k2=pick(), m=pick()), study([{**avoid, "bands_hz": [[pick(), pick()]], "margin_percent": rng.choice([0, 5])}])


def axes(rng):
    """Directions of any length: the same model, whose numbers must not depend on it."""
    model = json.loads((SOURCE / "tests/models/space_four_bar.json").read_text(encoding="utf-8"))
    for size in (1, 1e-200, 1e200, 1e-320, 1e308, 2.0 ** -600):
        scaled = copy.deepcopy(model)
        for joint in scaled["joints"]:
            for member in ("axis", "axis_b"):
                if member in joint and all(isinstance(x, (int, float)) for x in joint[member]):
                    top = max(abs(x) for x in joint[member])
                    joint[member] = [size * (x / top) for x in joint[member]]
        yield size, scaled


def spoilt(rng, document):
    """A few numbers of a shipped file at the ends of the range."""
    places = []

    def collect(value):
        for k, v in value.items() if isinstance(value, dict) else enumerate(value):
            if isinstance(v, (dict, list)):
                collect(v)
            elif isinstance(v, (int, float)) and not isinstance(v, bool) and k not in ("dimension", "seed", "starts", "mode", "index"):
                places.append((value, k))

    collect(document)
    for _ in range(rng.choice([1, 1, 2, 4])):
        at, key = rng.choice(places)
        at[key] = rng.choice(EXTREMES)


class Hunt:
    def __init__(self):
        self.problems, self.runs, self.codes = [], 0, {}

    def program(self, folder, where, *args):
        self.runs += 1
        form = args[args.index("--format") + 1] if "--format" in args else "text"
        try:
            done = subprocess.run([PROGRAM, *args], cwd=folder, capture_output=True, encoding="utf-8", timeout=SECONDS)
        except subprocess.TimeoutExpired:
            self.problems.append(f"{where}: {' '.join(args)}: longer than {SECONDS} s")
            return None
        self.codes[done.returncode] = self.codes.get(done.returncode, 0) + 1
        if done.returncode not in FINE or "runtime error" in done.stderr:
            self.problems.append(f"{where}: {' '.join(args)}: exit status {done.returncode}: {done.stderr[:600]}")
        for text, kind in ((done.stdout, form), (done.stderr, "text")):
            self.problems += [f"{where}: {' '.join(args)}: {p}" for p in list(problems_of(text.replace(str(folder), ""), kind))[:3]]
        return done

    def answer(self, where, model, question, rng):
        with tempfile.TemporaryDirectory() as top:
            top = Path(top)
            (top / "model.json").write_text(json.dumps(model), encoding="utf-8")
            (top / "study.json").write_text(json.dumps(question), encoding="utf-8")
            done = self.program(top, where, "run", "study.json")
            if done is None:
                return
            for path in sorted((top / "results/study").glob("*")) if (top / "results/study").exists() else []:
                text = path.read_text(encoding="utf-8").replace(str(top), "")  # whose name is made by chance
                self.problems += [f"{where}: {path.name}: {p}" for p in list(problems_of(text, path.suffix[1:]))[:3]]
            self.program(top, where, *rng.choice([("run", "study.json", "--format", "csv", "-o", "again"), ("compare", "study.json")]))
            self.look(where, top, "model.json", rng, 2)

    def look(self, where, folder, model, rng, count):
        """A few of the commands that look at a model."""
        for args in rng.sample((["modes", model], ["modes", model, "--format", "csv"], ["sensitivity", model], ["sensitivity", model, "--format", "json"], ["info", model],
                     ["modes", model, "--damped"], ["modes", model, "--damped", "--format", "json"]), count):
            self.program(folder, where, *args)

    def directions(self, rng):
        wanted = None
        with tempfile.TemporaryDirectory() as top:
            for size, model in axes(rng):
                (Path(top) / "model.json").write_text(json.dumps(model), encoding="utf-8")
                done = self.program(top, f"axes of length {size}", "modes", "model.json", "--format", "json")
                hz = [m["frequency_hz"] for c in json.loads(done.stdout) for m in c["modes"]] if done.returncode == 0 else done.stderr
                wanted = hz if wanted is None else wanted
                if isinstance(hz, str) or len(hz) != len(wanted) or any(a is not None and abs(a - b) > 1e-9 * abs(b) for a, b in zip(hz, wanted)):
                    self.problems.append(f"axes of length {size}: {hz}, wanted {wanted}")


def self_test():
    bad = [("off by nan %", "text"), ("a,inf\r\n", "csv"), ('{"a": NaN}', "json"), ('{"a": -Infinity}', "json"), ('<rect x="1" width="nan"/>', "html"),
           ('<path d="M1 2L-1e9 3"/>', "html"), ("goes to undefined", "text"), ("-inf Hz", "text"),
           ("<p>nan Hz</p><script>NaN</script>", "html"), ('<script type="application/json" id="data">[NaN]</script>', "html")]
    good = [("information about nancy, inf_x", "text"), ('<path d="M1 2L3.5 -4"/>', "html"), ('{"a": null}', "json"), ("<p>1 Hz</p><script>x = NaN</script>", "html")]
    return [f"self-test: {text} passed" for text, form in bad if not list(problems_of(text, form))] + \
           [f"self-test: {text} was refused" for text, form in good if list(problems_of(text, form))]


class Words(campaign.Generator):
    """Round I of seed S draws from seed S + I."""
    script, cases, count, tallied = "tests/cli/test_words.py", "rounds", 1, ("runs",)

    def make(self, seed, kind, index):
        number = int(seed) + index
        return campaign.Case(kind, {"round": number}, random.Random(number), f"seed {number}: ")

    def judge(self, case, folder, tally):
        hunt, number, rng = Hunt(), case.document["round"], case.rng
        hunt.directions(rng)
        for place, (name, model, question) in enumerate(generated(rng)):
            if EVERY or place % 4 == number % 4:
                hunt.answer(name, model, question, rng)
        files = [p for folder_ in ("problems", "tests/models") for p in sorted((SOURCE / folder_).glob("*.json")) if p.name != "aircraft.json"]
        for path in rng.sample(files, 4):
            document = json.loads(path.read_text(encoding="utf-8"))
            spoilt(rng, document)
            (folder / "model.json").write_text(json.dumps(document), encoding="utf-8")
            hunt.look(f"{path.name} spoilt", folder, "model.json", rng, 7)
        tally["runs"] += hunt.runs
        for code, runs in hunt.codes.items():
            tally[f"exit status {code}"] += runs
        yield from (("words", problem[:700]) for problem in hunt.problems[:40])


if __name__ == "__main__":
    wrong = self_test()
    print("\n".join(wrong), end="\n" if wrong else "")
    sys.exit(campaign.main(Words()) or bool(wrong))

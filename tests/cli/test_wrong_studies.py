#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A generator of wrong studies: random ones that ask for everything (goals of every kind, variables, catalogues, tolerances, trades, orders,
references, measurements, published values), each with one change that makes it impossible or implausible. A change that `check` passes
in silence fails, and so does one that is told elsewhere, a kind of change that no study has room for, and a study that is doubted as
it is. Numbers by themselves are changed as in test_wrong_files.py, at every place of these studies; here is what refers to something
else, and what is wrong beside something else.

With options it is a campaign (tests/support/campaign.py) of other studies than the suite's, each changed at all places.
"""
import copy
import json
import math
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import campaign  # noqa: E402
from common_cli import PROGRAM  # noqa: E402
from test_wrong_files import Walk, changed, changes_of  # noqa: E402

TOLERANT = ("frequency", "avoid", "limit")
STUDIES, PLACES = 12, 1  # of the quick suite: studies, and places of each change in one of them
PROFILE = "flat.json"
FLAT = {"format": "modetune-profile/1", "random": {"psd_g2_per_hz": [[5, 0.001], [500, 0.001]]}}
CSV = "input,output,unit,frequency_hz,real,imag\n" + "".join(f"x1.x,x1.x,m per N,{f},{1e-3 / f},{-1e-4}\n" for f in range(1, 40))


def number(value):
    return float(f"{value:.4g}")


def chain(rng):
    """Masses in a row, each on the ground and on the next; `heavy` has a heavier first one."""
    n = rng.randint(2, 4)
    at = [[i + 1, 0] for i in range(n)]
    parameters = {f"k{i}": {"value": number(rng.uniform(500, 5000)), "unit": "N/m"} for i in range(n)}
    parameters.update({f"c{i}": number(rng.uniform(0.2, 2)) for i in range(n)}, m={"value": number(rng.uniform(0.5, 3)), "unit": "kg"})
    line = [{"name": f"s{i}", "type": "axial", "bodies": ["ground" if i == 0 else f"b{i}", f"b{i + 1}"], "at": [[i, 0], at[i]]} for i in range(n)]
    return {"format": "modetune-model/1", "dimension": 2, "parameters": parameters,
            "bodies": [{"name": f"b{i + 1}", "mass_kg": "m", "inertia_kg_m2": 0.1, "centre": at[i]} for i in range(n)],
            "joints": [{"name": f"j{i + 1}", "type": "prismatic", "bodies": ["ground", f"b{i + 1}"], "at": at[i], "axis": [1, 0]} for i in range(n)],
            "springs": [dict(s, stiffness_n_per_m=f"k{i}") for i, s in enumerate(line)],
            "dampers": [dict(s, name=f"d{i}", damping_n_s_per_m=f"c{i}") for i, s in enumerate(line)],
            "sensors": [{"name": f"x{i + 1}", "on": f"b{i + 1}", "directions": ["x"]} for i in range(n)],
            "modes": {"low": {"configuration": "held", "index": 1}}, "configurations": {"held": {}, "heavy": {"parameters": {"m": 4}}}}


def variables(rng, model):
    names = [n for n in model["parameters"] if n not in ("m", "k0")]
    rng.shuffle(names)
    names.insert(0, "k0")  # which limits and objectives are of
    out = []
    for name in names[:rng.randint(2, 4)]:
        own = model["parameters"][name]
        value = own["value"] if isinstance(own, dict) else own
        item = {"parameter": name, "lower": number(value / 2), "upper": number(value * 2)}
        if rng.random() < 0.3:
            item["tolerance_percent"] = rng.choice([1, 2, 5])
        elif rng.random() < 0.5:
            rule = rng.choice([[number(value / 2), value, number(value * 2)], {"series": "E12", "lower": number(value / 2), "upper": number(value * 2)}])
            item = {"parameter": name, "catalogue": rule}
        if rng.random() < 0.3:
            item["weight"] = rng.choice([0.5, 2])
        out.append(item)
    return out


def avoid(rng):
    one = {"rotor": {"speed_hz": number(rng.uniform(4, 8)), "blades": 4, "harmonics": ["1P", "4P"], "speed_range": [0.95, 1.02]},
           "machine": {"name": "pump", "speed_range_hz": [number(rng.uniform(20, 24)), 25], "orders": ["1E", "2E"],
                       "gears": [{"name": "wheel", "teeth": 17, "ratio": 2, "orders": ["1G"], "sidebands": 1}]},
           "bands_hz": [[number(rng.uniform(1, 2)), 3], [30, 40]]}
    kind = rng.choice(sorted(one))
    return {"type": "avoid", "configuration": "held", kind: one[kind], "margin_percent": rng.choice([5, 10]), **({} if kind == "machine" else {"up_to_hz": 300})}


def goals(rng, n):
    at = {"configuration": "held"}
    every = [{"type": "frequency", **at, "mode": "low", "at_least_hz": number(rng.uniform(0.5, 2)), "at_most_hz": 50},
             {"type": "frequency", **at, "mode": n, "target_hz": number(rng.uniform(8, 15)), "weight": 1},
             {"type": "frequency", "configurations": ["held", "heavy"], "mode": 1, "at_most_hz": number(rng.uniform(30, 60))},
             {"type": "mac", **at, "mode": 1, "reference": "test", "reference_mode": 1, "at_least": 0.8},
             {"type": "shape", **at, "mode": 1, "reference": "test", "reference_mode": 1, "weight": 1},
             {"type": "damping", **at, "mode": 1, "at_least": 0.001, "at_most": 0.4},
             {"type": "response", **at, "input": "x1.x", "output": f"x{n}.x", "band_hz": [0.5, 30], "at_most": number(rng.uniform(0.1, 1))},
             {"type": "response", **at, "input": "x1.x", "output": "x1.x", "at_hz": number(rng.uniform(1, 3)), "at_most": 1},
             {"type": "vibration", **at, "profile": PROFILE, "input": "base.x", "output": f"x{n}.x:acceleration", "quantity": "rms", "at_most": 500},
             {"type": "frequency_response", **at, "input": "x1.x", "output": "x1.x", "measurement": "hammer", "weight": 1},
             {"type": "limit", "expression": "k0 + k1", "at_least": 100, "at_most": 50000}, avoid(rng)]
    if rng.random() < 0.25:  # what is judged over tolerances
        every = [g for g in every if g["type"] in TOLERANT and g.get("mode") != "low" and "weight" not in g]
    return rng.sample(every, min(len(every), rng.randint(3, 7)))


def study(rng, model):
    n = len(model["bodies"])
    asked = goals(rng, n)
    own = variables(rng, model)
    if any(g["type"] not in TOLERANT or g.get("mode") == "low" or "weight" in g for g in asked):
        for v in own:
            v.pop("tolerance_percent", None)
    out = {"format": "modetune-study/1", "model": "../problems/chain.json", "variables": own, "goals": asked,
           "objective": rng.choice([{"minimise": "change"}, {"minimise": "mass"}, {"minimise": "k0 + 2*k1"}, [{"minimise": "change"}, {"minimise": "k1"}]]),
           "references": {"test": {"modes": [{"frequency_hz": number(rng.uniform(1, 3)), "shape": {f"x{i + 1}.x": number((i + 1) / n) for i in range(n)}}]}},
           "measurements": {"hammer": {"file": "hammer.csv"}}, "search": {"seed": rng.randint(1, 99), "starts": 4, "max_evaluations": 2000}, "recommendations": 3}
    aims = any("weight" in g for g in out["goals"])
    if aims:
        for g in out["goals"]:
            if g["type"] in ("shape", "frequency_response") or "target_hz" in g:
                g["weight"] = 1
        out["objective"] = {"minimise": "misfit"}
    limited = [i for i, g in enumerate(out["goals"]) if g["type"] in ("limit", "response", "vibration")]
    if limited and rng.random() < 0.8 and not aims:
        i = limited[0]
        edge = out["goals"][i]["at_most"]
        out["trade"] = {"vary": [{"goal": i, "member": "at_most", "values": [edge, number(edge * 1.5)]}], "objectives": ["change", "mass"]}
        out["objective"] = [{"minimise": "change"}, {"minimise": "mass"}]
    if rng.random() < 0.5:
        out["responses"] = [{"configuration": "held", "input": "x1.x", "output": "x1.x", "band_hz": [1, 20]}]
    if rng.random() < 0.5:
        out["published"] = [{"status": "solved"}, {"parameter": own[0]["parameter"], "value": 1, "tolerance_percent": 50, "role": "calibrates"}]
    return out


def set_at(document, path, value):
    out = copy.deepcopy(document)
    at = out
    for key in path[:-1]:
        at = at[key]
    at[path[-1]] = value
    return out


def of_goals(s):
    """What a goal can be wrong in beside its numbers: kind, place, value, severity, words."""
    for i, g in enumerate(s["goals"]):
        at = ("goals", i)
        if "configuration" in g:
            yield "no such configuration", (*at, "configuration"), "hold", "error", 'unknown configuration "hold"; did you mean "held"'
        if "configurations" in g:
            yield "twice the same", (*at, "configurations"), ["held", "held"], "error", "twice|listed before|already"
        if isinstance(g.get("mode"), int):
            yield "mode beyond", (*at, "mode"), 40, "error", "no vibration mode 40"
        elif "mode" in g:
            yield "no such mode", (*at, "mode"), "lowest", "error", 'unknown mode "lowest"'
        if "reference" in g:
            yield "no such reference", (*at, "reference"), "tests", "error", 'unknown reference "tests"; did you mean "test"'
            yield "reference mode beyond", (*at, "reference_mode"), 2, "error", "has 1 mode|one mode|1 mode"
        if "input" in g:
            yield "no such sensor", (*at, "input"), "y9.x", "error", "no input is called|the input is"
            yield "no such direction", (*at, "output"), "x1.z", "error", "no output is called"
        if "measurement" in g:
            yield "no such measurement", (*at, "measurement"), "hamer", "error", 'unknown measurement "hamer"; did you mean "hammer"'
        if "profile" in g:
            yield "no such profile", (*at, "profile"), "helicopter_uh61", "error", "cannot|no profile|unknown|not found"
        if "band_hz" in g:
            yield "band backwards", (*at, "band_hz"), g["band_hz"][::-1], "error", "not above|below|must"
        if g["type"] == "limit":
            yield "no such parameter", (*at, "expression"), "k0 + kk", "error", 'unknown name "kk"'
            yield "nothing moves it", (*at, "expression"), "m", "warning|error", "no variable|does not depend|changes"
        if "rotor" in g:
            yield "harmonic of none", (*at, "rotor", "harmonics"), ["0P"], "error", "harmonic|must|above 0"
            yield "harmonic twice", (*at, "rotor", "harmonics"), ["1P", "1P"], "error|warning", "twice|listed before|already|same"
        if "machine" in g:
            yield "order of none", (*at, "machine", "orders"), ["0E"], "error", "order|must|above 0"
            yield "order unit", (*at, "machine", "orders"), ["2R"], "error", "order|unknown|is no"
            yield "turns per minute", (*at, "machine", "speed_range_hz"), [13500, 15000], "warning", "turns per minute"
            yield "teeth of none", (*at, "machine", "gears", 0, "teeth"), 0, "error", "must|out of range"
        if "bands_hz" in g:
            yield "no band", (*at, "bands_hz"), [[5, 5]], "warning|error", "width|not above"
        if "up_to_hz" in g:
            yield "all cut off", (*at, "up_to_hz"), 0.5, "error|warning", "up_to_hz|cut off|no band|above"
        if "at_least_hz" in g and "at_most_hz" in g:
            yield "no room", (*at, "at_least_hz"), g["at_most_hz"] * 2, "error", "not above|is above|below"


def of_the_rest(s):
    own = [v["parameter"] for v in s["variables"]]
    for i, v in enumerate(s["variables"]):
        at = ("variables", i)
        yield "no such parameter", (*at, "parameter"), "kappa", "error", 'unknown parameter "kappa"|no parameter'
        if i > 0:
            yield "variable twice", (*at, "parameter"), own[0], "error", "twice|already|listed before"
        if "lower" in v:
            yield "bounds backwards", (*at, "lower"), v["upper"] * 2, "error", "below lower|not above|is below"
            yield "off the original", at, {**v, "lower": v["upper"] * 1e4, "upper": v["upper"] * 1e5}, "warning", "away|original|powers of ten|outside|times"
            yield "decades apart", at, {**v, "lower": v["lower"] * 1e-7, "upper": v["upper"] * 1e7}, "warning", "decades"
        if isinstance(v.get("catalogue"), list):
            yield "part twice", (*at, "catalogue"), [*v["catalogue"], v["catalogue"][0]], "error", "twice"
            yield "no part", (*at, "catalogue"), [], "error", "empty|entries"
        elif "catalogue" in v:
            yield "no series", (*at, "catalogue", "series"), "E13", "error", "E12|unknown"
            yield "no part", (*at, "catalogue"), {**v["catalogue"], "lower": 1.01, "upper": 1.02}, "error", "no value|none|empty"
    if isinstance(s["objective"], dict):
        yield "objective of none", ("objective",), {"minimise": "k0 + kk"}, "error", 'unknown name "kk"'
        yield "clearance of none", ("objective",), {"maximise": "clearance"}, "error" if not any(g["type"] == "avoid" for g in s["goals"]) else "", "band|avoid|clear"
    if "trade" in s:
        vary = ("trade", "vary", 0)
        yield "no such goal", (*vary, "goal"), 99, "error", "goal"
        yield "member that it has not", (*vary, "member"), "target_hz", "error", "target_hz|has no"
        yield "value twice", (*vary, "values"), [s["trade"]["vary"][0]["values"][0]] * 2, "error", "twice"
        yield "one objective", ("trade", "objectives"), ["change", "change"], "error", "twice|same|two"
    first = s["references"]["test"]["modes"][0]
    yield "shape of a sensor of none", ("references", "test", "modes", 0, "shape"), {**first["shape"], "y9.x": 1}, "warning", "no sensor and direction"
    yield "shape of zeros", ("references", "test", "modes", 0, "shape"), dict.fromkeys(first["shape"], 0), "error", "zero|0"
    yield "file of none", ("measurements", "hammer", "file"), "hamer.csv", "error", "cannot|No such"
    yield "model of none", ("model",), "../problems/chian.json", "error", "cannot|No such"
    yield "unit of none", ("units",), {"length": "yd"}, "error", "yd"
    yield "no search", ("search", "starts"), 0, "error", "must|out of range"
    for i, r in enumerate(s.get("responses", [])):
        yield "response of none", ("responses", i, "input"), "y9.x", "error", "no input is called"
        yield "range backwards", ("responses", i, "band_hz"), r["band_hz"][::-1], "error", "not above|below|must"
    for i, p in enumerate(s.get("published", [])):
        if "parameter" in p:
            yield "published of none", ("published", i, "parameter"), "kappa", "error", "kappa"


def numbers(s, walk):
    for name, member, place in walk.places(s):
        value = s
        for key in place:
            value = value[key]
        for i, (change, severity, words) in enumerate(changes_of(name, member, value)):
            wrong = changed(s, place, change)
            if wrong is not None:
                yield f"{name} {member} {i}", place, wrong, severity, words


def all_changes(s, walk, places, done):
    """(kind, place, document, severity, words), so many of each kind."""
    listed = [(kind, place, set_at(s, place, value), severity, words) for make in (of_goals, of_the_rest) for kind, place, value, severity, words in make(s) if severity]
    for kind, place, wrong, severity, words in listed + list(numbers(s, walk)):
        done[kind] = done.get(kind, 0) + 1
        if done[kind] <= places:
            yield kind, place, wrong, severity, words


def judge(told, place, severity, words):
    """None, or what is wrong: that nothing tells the change, or not there."""
    around = "/" + "/".join(map(str, place[:-1]))
    near = []
    for p in told:  # what is found by the study as a whole begins with its place
        pointer = p["pointer"] or re.match(r"(/[\w/]+)?", p["message"])[0]
        if p["severity"] in severity.split("|") and (pointer + "/").startswith(around.rstrip("/") + "/"):
            near.append(p["message"])
    return None if re.search(words, "\n".join(near)) else json.dumps(told)


def told_by_check(folder, files):
    """What `check` says of each file: {file: problems}."""
    done = subprocess.run([PROGRAM, "check", "--format", "json", *files], cwd=folder, capture_output=True, encoding="utf-8", timeout=600, check=False)
    return {got["file"]: got["problems"] for got in json.loads(done.stdout)}


class WrongStudies(campaign.Generator):
    script, cases, tallied = "tests/cli/test_wrong_studies.py", "wrong studies", ("changes",)

    def __init__(self, places=math.inf):
        self.places, self.done = places, {}  # so many places of each kind of change in all studies together

    def make(self, seed, kind, index):
        rng = campaign.draw(f"{seed} {index}")
        model = chain(rng)
        return campaign.Case(kind, {"model": model, "study": study(rng, model)}, rng)

    def put(self, case, folder):
        """The study as it is, with the files that it names; its name."""
        texts = {"problems/chain.json": json.dumps(case.document["model"]), "studies/hammer.csv": CSV, f"studies/{PROFILE}": json.dumps(FLAT),
                 "studies/sound.json": json.dumps(case.document["study"])}
        for name, text in texts.items():
            (folder / name).parent.mkdir(exist_ok=True)
            (folder / name).write_text(text, encoding="utf-8")
        return "studies/sound.json"

    def judge(self, case, folder, tally):
        sound = self.put(case, folder)
        files = {f"studies/w{i}.json": w for i, w in enumerate(all_changes(case.document["study"], Walk("study"), self.places, self.done))}
        for file, (_, _, wrong, _, _) in files.items():
            (folder / file).write_text(json.dumps(wrong), encoding="utf-8")
        tally["changes"] += len(files)
        told = told_by_check(folder, [sound, *files])
        for p in told[sound]:
            yield "sound", json.dumps(p)
        for file, (kind, place, _, severity, words) in files.items():
            bad = judge(told[file], place, severity, words)
            if bad is not None:
                yield kind, f"at {'/'.join(map(str, place))}: {bad[:400]}"


class Suite(unittest.TestCase):
    KINDS_LEAST = 100

    def test_no_slip_of_a_random_study_is_passed_in_silence(self):
        wrong = WrongStudies(PLACES)
        campaign.hold(self, wrong, "wrong", wrong.todo([""], STUDIES))
        self.assertGreater(len(wrong.done), self.KINDS_LEAST, sorted(wrong.done))

    def test_silence_is_noticed(self):
        """A change that nothing is said of, and one that is told at another place."""
        wrong = WrongStudies()
        with tempfile.TemporaryDirectory() as folder:
            sound = wrong.put(wrong.make("wrong", "", 0), Path(folder))
            self.assertIsNotNone(judge(told_by_check(folder, [sound])[sound], ("goals", 0, "mode"), "error", "."))
        elsewhere = [{"severity": "error", "pointer": "/goals/1/mode", "message": "unknown mode"}]
        self.assertIsNotNone(judge(elsewhere, ("goals", 0, "mode"), "error", "unknown mode"))
        self.assertIsNotNone(judge(elsewhere, ("goals", 1, "mode"), "warning", "unknown mode"))
        self.assertIsNone(judge(elsewhere, ("goals", 1, "mode"), "error", "unknown mode"))


if __name__ == "__main__":
    if len(sys.argv) > 1 and sys.argv[1].startswith("--"):
        sys.exit(campaign.main(WrongStudies()))
    unittest.main(verbosity=1)

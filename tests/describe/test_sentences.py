# SPDX-License-Identifier: GPL-3.0-or-later
"""
Every sentence that describes a design is reached by some study, and its claim is computed again. The sentences are read from the sources
(every text of mt_add_sentence in src/describe). Small studies of one mass, and the shipped ones, reach them; the numbers in them are computed here
from the rest of the result and from closed forms, or in the test that ELSEWHERE names. A sentence in the sources that nothing reaches, or
that nobody computes again, fails.
"""
import itertools
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(os.environ.get("SOURCE_DIR", Path(__file__).resolve().parents[2]))
sys.path.insert(0, str(SOURCE / "tests/support"))
from answers import answer  # noqa: E402

PROGRAM = os.environ["MODETUNE"]
SHIPPED = ("beam_identification", "inceptor_identification", "inceptor_tuning_1", "inceptor_tuning_3", "inceptor_rotor", "inceptor_vibration",
           "inceptor_catalogue", "three_masses_identification", "six_masses_bands", "six_masses_infeasible", "engine_orders", "den_hartog")

# What is computed again by another test, which fails if it is not true.
ELSEWHERE = {
    "NOT VERIFIED, do not use: %s.": "answer/test_verify.c plants a disagreement",
    "The search was interrupted: better designs may exist.": "cli/test_interrupts.py",
    "It is the only one of %.0f mode placements that meets all goals (%s).": "hunt/check_claims.py searches all assignments",
    "It ranks %d of the %d mode placements that meet all goals, of %.0f in all, by %s %s (%s).": "hunt/check_claims.py searches all assignments",
    "It ranks %d of the %d mode placements that were found to meet all goals, of %.0f in all, by %s %s (%s).": "search/test_best_first.py searches all",
    "It is not shown to be a local optimum: its KKT residual is %.2g, where an optimum has 0; a design near it may be better.": "hunt/check_claims.py",
    "Relaxing goal %s (%s) by %s would %s %s.": "hunt/check_words.py solves again",
    "A target %s %s in goal %s (%s) would %s %s.": "describe/test_prices.py",
    "Goal %s (%s) hardly depends on the variables here: %s; what its tolerance of %.3g %% leaves open may change %s.": "describe/test_prices.py",
    "Goal %s (%s) hardly depends on the variables here: %s.": "describe/test_prices.py",
    "Relaxing the %s edge of %s, which holds %s mode %d, by %s would %s %s.": "describe/test_study_bands.c solves again",
    "Relaxing the %s edge of %s, which holds mode %d where %s is at %s, between the positions, by %s would %s %s.": "cli/test_motion.py",
    "Relaxing the limit of goal %s where %s is at %s, between the positions, by %s would %s %s.": "cli/test_between.py",
    "Between the named positions %s.": "cli/test_between.py has closed forms",
    "Over the motion: %s.": "cli/test_motion.py",
    "Not identifiable: %s changes no goal by more than %.3g %% across its bounds and keeps its original value.": "hunt/check_words.py moves along it",
    "Goals are judged at the worst corner of the tolerances (%s), which is proven to be the worst case.": "cli/test_tolerances.py",
    "Goals are judged by the worst of the corners of the tolerances (%s) and of samples within them: sampled, not proven.": "cli/test_tolerances.py",
}


def formats():
    found = []
    for path in sorted((SOURCE / "src/describe").glob("*.c")):
        for m in re.finditer(r'(?:mt_)?add_sentence\(\s*(?:s|&s),\s*((?:"(?:\\.|[^"\\])*"\s*)+)', path.read_text(encoding="utf-8")):
            found.append("".join(re.findall(r'"((?:\\.|[^"\\])*)"', m[1])))
    return [f for f in dict.fromkeys(found) if f != "%s"]  # of catalogues: search/discrete's own sentence


def pattern(fmt):
    out = ""
    for part in re.split(r"(%%|%[-+ 0#]*[\d.*]*l?[sdgf])", fmt):
        number = r"([-+]?(?:\d[\d.e+-]*|inf|nan))"
        out += "%" if part == "%%" else re.escape(part) if not re.match(r"%.", part) else "(.*?)" if part[-1] == "s" else number
    return re.compile(out + r"\Z", re.S)


def model(parameters, *stiffness):
    """Masses of 1 kg, each on a guide of its own with a spring to the ground, and each to the next by none."""
    n = range(len(stiffness))
    return {"format": "modetune-model/1", "dimension": 2, "parameters": {k: {"value": v} for k, v in parameters.items()},
            "bodies": [{"name": f"b{i}", "mass_kg": 1, "inertia_kg_m2": 0.1, "centre": [i, 0]} for i in n],
            "joints": [{"name": f"j{i}", "type": "prismatic", "bodies": ["ground", f"b{i}"], "at": [i, 0], "axis": [0, 1]} for i in n],
            "springs": [{"name": f"s{i}", "type": "axial", "bodies": ["ground", f"b{i}"], "at": [[i, -1], [i, 0]], "stiffness_n_per_m": k} for i, k in enumerate(stiffness)],
            "sensors": [{"name": f"q{i}", "on": f"b{i}", "at": [i, 0], "directions": ["y"]} for i in n]}


def alike(a, b, coupling):
    """Two of them with a spring between: with a = b their modes are (1, 1) and (1, -1)."""
    data = model({"a": a, "b": b}, "a", "b")
    data["springs"].append({"name": "c", "type": "bushing", "bodies": ["b0", "b1"], "at": [[0, 0], [1, 0]], "stiffness_n_per_m": [0, coupling], "stiffness_n_m_per_rad": 0})
    return {**data, "modes": {"first": {"configuration": "default", "index": 1}}}


def hz(k):
    return math.sqrt(k) / (2 * math.pi)


def frequency(**members):
    return {"type": "frequency", **{"mode": 1, **members}}


def variable(name, lower, upper, **more):
    return {"parameter": name, "lower": lower, "upper": upper, **more}


CHANGE = {"minimise": "change"}
# name: (model, variables, goals, objective, more members)
STUDIES = {
    "bound": (model({"k": 1000}, "k"), [variable("k", 500, 2000)], [frequency(target_hz=hz(3000))], CHANGE),
    "coordinate": (model({"x": 0}, "1000*(1 + x)"), [variable("x", -0.5, 1)], [frequency(target_hz=hz(1440))], CHANGE),
    "kept": (model({"k": 1000, "c": 5000}, "k", "c"), [variable("k", 500, 2000), variable("c", 4000, 9000)], [frequency(at_least_hz=hz(1200))], CHANGE),
    "one band": (model({"k": 1000}, "k"), [variable("k", 500, 2000)], [{"type": "avoid", "bands_hz": [[hz(800), hz(1100)]], "margin_percent": 1}], CHANGE),
    "nothing holds it": (model({"k": 1000}, "k"), [variable("k", 0, 2000)], [frequency(at_most_hz=5)], {"minimise": "k"}),
    "held by nothing": (model({"k": 0}, "k"), [variable("k", 0, 2000)], [frequency(target_hz=5)], CHANGE),
    "unstable before": (model({"k": -100}, "k"), [variable("k", -1000, 1000)], [frequency(target_hz=2)], CHANGE),
    "always unstable": (model({"k": -700}, "k"), [variable("k", -1000, -500)], [frequency(target_hz=2)], CHANGE),
    "uncertain": ({**model({"a": 1000, "b": 2000}, "a", "b"), "modes": {"first": {"configuration": "default", "index": 1}}},
                  [variable("a", 500, 4000), variable("b", 500, 4000)],
                  [{"type": "mac", "mode": "first", "reference": "r", "at_least": 0.9}, frequency(target_hz=hz(1500)), frequency(mode=2, target_hz=hz(1500))], CHANGE,
                  {"references": {"r": {"modes": [{"shape": {"q0.y": 1, "q1.y": 0}}]}}}),
    "alike": (alike(1000, 2000, 100), [variable("a", 500, 4000)], [frequency(mode="first", at_least_hz=4), {"type": "limit", "expression": "a", "at_least": 2000}], CHANGE),
    "by far": (model({"k": 1000}, "k"), [variable("k", 500, 2000)], [frequency(at_most_hz=1e-307)], CHANGE),
    "sized": (model({"k": 1000}, "k"), [variable("k", 1500, 2000)], [frequency(at_most_hz=hz(5000))], {"minimise": "k"}),
    "unstable": (model({"k": 100}, "k"), [variable("k", -1000, 1000)], [frequency(target_hz=2), {"type": "limit", "expression": "k", "at_most": -500}], CHANGE),
    "far": (model({"k": 0}, "k"), [variable("k", 0, 1e-9)], [frequency(at_least_hz=5)], CHANGE),
    "continuum": (model({"a": 1, "b": 1}, "1000*(a + b)"), [variable("a", 0.5, 5), variable("b", 0.5, 5)], [frequency(at_least_hz=hz(3000))], {"minimise": "a + b"}),
    "two objectives": (model({"a": 1, "b": 1}, "1000*a*b"), [variable("a", 0.5, 5), variable("b", 0.5, 5)], [frequency(target_hz=hz(2000), weight=1)],
                       [{"minimise": "misfit"}, {"minimise": "a + 3*b"}]),
    "double": (model({"x": 0.3}, "1000*(2 - x^2)"), [variable("x", -1, 1)], [frequency(target_hz=hz(2000))], CHANGE),
    "several": (model({"x": 0.3}, "1000*(2 - x^2)"), [variable("x", -1, 1)], [frequency(target_hz=hz(1500))], CHANGE),
    "minima": (model({"x": 0.5}, "1000*((x^2 - 1)^2 + 0.2*(x + 1) + 1)"), [variable("x", -2, 2)], [frequency(target_hz=hz(1000), weight=1)], {"minimise": "misfit"}),
    "higher minima": (model({"x": 0.5}, "1000*((x^2 - 1)^2 + 0.2*(x + 1) + 1)"), [variable("x", -2, 2)], [frequency(target_hz=hz(900), weight=1)], {"minimise": "misfit"}),
    "original": (model({"k": 1000}, "k"), [variable("k", 500, 2000)], [frequency(at_least_hz=hz(900))], CHANGE),
    "tolerances": (model({"k": 1000}, "k"), [variable("k", 500, 4000, tolerance_percent=5)], [frequency(at_least_hz=hz(1200))], CHANGE),
}


def run(folder, name):
    data, variables, goals, objective, *more = STUDIES[name]
    study = {"format": "modetune-study/1", "model": "m.json", "variables": variables, "goals": goals, "objective": objective, **(more[0] if more else {})}
    (folder / "m.json").write_text(json.dumps(data), encoding="utf-8")
    (folder / "s.json").write_text(json.dumps(study), encoding="utf-8")
    done = subprocess.run([PROGRAM, "run", folder / "s.json", "--quiet", "-o", folder], capture_output=True, text=True, timeout=60)
    assert done.returncode in (0, 1), f"{name}: {done.stderr}"
    return json.loads((folder / "s/result.json").read_text(encoding="utf-8"))


ELSEWHERE.update({
    "T%s.": "cli/test_response_vibration.py and vibration/test_* have the responses in closed form",
    "%s: deviation %.3g %% rms, most at %.6g Hz, where the response is %.4g times what was measured and its phase %+.3g deg from it.":
        "answer/test_frequency_response.py has the misfit",
    "It is one of a continuum of equally good designs that %d start%s found.": "describe/test_study_reasons.c",
    "A continuum of designs is as good as this one: those between it and others that were found meet all goals, too, and have the same %s.":
        "describe/test_study_reasons.c",
    "It is a repeated mode and has no sensitivity of its own.": "reference/test_repeated_modes.py",
    "With the %s %s held, it has the %s %s near it.": "answer/test_study_objectives.c",
})


def close(text, value, digits):
    """Is the value what was written with so many digits?"""
    return abs(float(text) - value) <= 0.501 * 10.0 ** (math.floor(math.log10(abs(value))) + 1 - digits) if value else abs(float(text)) < 1e-9


def parameter(rec, name):
    return next(p for p in rec["parameters"] if p["name"] == name)


def shown(p, value):
    return value / p["display_factor"] if p["display_factor"] else value


def changes(m, rec, _):
    p = parameter(rec, m[1])
    part = 100 * (p["recommended"] - p["original"]) / abs(p["original"])
    return (part > 0) == (m[2] == "rises") and close(m[3], abs(part), 3) and close(m[4], shown(p, p["original"]), 6) and close(m[5], shown(p, p["recommended"]), 6)


def goes(m, rec, _):
    p = parameter(rec, m[1])
    return close(m[2], shown(p, p["original"]), 6) and close(m[3], shown(p, p["recommended"]), 6)


def at_bound(m, rec, _):
    p = parameter(rec, m[1])
    return p[m[2]] is not None and abs(p["recommended"] - p[m[2]]) <= 1e-9 * max(abs(p["upper"] - p["lower"]), abs(p[m[2]]))


def unchanged(p):
    return abs(p["recommended"] - p["original"]) <= 2e-6 * max(abs(p["original"]), 1e-3 * abs(p["upper"] - p["lower"]))


def stays(_, rec, __):
    return all(map(unchanged, rec["parameters"]))


def kept(m, rec, _):
    return all(unchanged(parameter(rec, name)) for name in re.split(", | and ", m[1]))


def mode_of(rec, configuration, mode):
    return next(f for f in rec["frequencies"] if (f["configuration"], f["mode"]) == (configuration, int(mode)))


def moves(m, rec, _):
    f = mode_of(rec, m[1], m[2])
    return close(m[6], f["original_hz"], 6) and close(m[7], f["recommended_hz"], 6)


def remains(m, rec, _):
    f = mode_of(rec, m[1], m[2])
    return close(m[6], f["recommended_hz"], 6) and close(m[6], f["original_hz"], 6)


def comes(m, rec, _):
    f = mode_of(rec, m[1], m[2])
    return f["original_hz"] is None and close(m[6], f["recommended_hz"], 6)


def slack(m, rec, _):
    return mode_of(rec, m[1], m[2])["recommended_hz"] == 0


def goal(rec, pointer):
    return [g for g in rec["goals"] if g["pointer"] == pointer]


def missed(m, rec, _):
    return any(not g["met"] and g["violation_percent"] is not None and close(m[3], g["violation_percent"], 3) for g in goal(rec, m[1]))


def valueless(m, rec, _):
    return any(not g["met"] and g["value"] is None for g in goal(rec, m[1]))


def uncertain(m, rec, _):
    """The named shape stood at an angle of t to its mass, tan 2 t = 2 c/(b - a) = 0.2; at a = b it is at 45 - t degrees to one mode, 45 + t to the other."""
    mode = next(f for f in rec["frequencies"] if f["name"] is not None)
    shares = sorted((mode["share"], mode["rival_share"]))
    half = 0.5 * math.sin(math.atan(0.2))
    return any(not g["met"] and g["doubtful"] for g in goal(rec, m[1])) and abs(shares[0] - 0.5 + half) < 1e-4 and abs(shares[1] - 0.5 - half) < 1e-4


def far(m, rec, _):
    """Its per cent are no number any more."""
    return any(not g["met"] and math.isinf(100 * (g["value"] / g["at_most"] - 1)) for g in goal(rec, m[1]))


def weighted(m, rec, _):
    return int(m[1]) == sum(g["weighted"] for g in rec["goals"]) and float(m[4]) >= 0


def least(m, rec, result):
    return rec["rank"] == 1 and int(m[1]) == len(result["recommendations"]) and all(r["misfit"] >= rec["misfit"] for r in result["recommendations"])


def times(m, rec, result):
    return close(m[1], rec["misfit"] / result["recommendations"][0]["misfit"], 3)


def no_fit(_, rec, result):
    return rec["misfit"] > 1e-9 >= result["recommendations"][0]["misfit"]


def exact(_, rec, result):
    return max(rec["misfit"], result["recommendations"][0]["misfit"]) <= 1e-9


def single(_, __, result):
    return len(result["recommendations"]) == 1 and result["run"]["distinct_designs"] <= 1


def least_of_all(_, rec, result):
    return rec["feasible"] and stays(_, rec, result) and rec["change"] == 0 and result["run"]["spent"]["search"] == 0


def none_meets(_, rec, result):
    return not any(r["feasible"] for r in result["recommendations"]) and not rec["feasible"]


def ranks(m, rec, result):
    scores = [r["score"] for r in result["recommendations"]]
    return int(m[1]) == rec["rank"] and int(m[2]) == len(scores) and (None in scores or scores == sorted(scores, reverse="greatest" in m[5]))


def below(m, rec, _):
    """How many frequencies lie below each band, one within it counting either way; bands with one number of modes stand together."""
    hz = [f["recommended_hz"] for f in rec["frequencies"] if f["configuration"] == m[1] and f["recommended_hz"] is not None]
    bands = [g for g in rec["gap_assignment"] if g["configuration"] == m[1]]
    if not all(sum(x < g["lower_hz"] for x in hz) <= g["modes_below"] <= sum(x < g["upper_hz"] for x in hz) for g in bands):
        return False
    counts, parts = [(g["band"], g["modes_below"]) for g in bands], []
    for n, group in itertools.groupby(counts, key=lambda c: c[1]):
        names = [name for name, _ in group]
        listed = names[0] if len(names) == 1 else ", ".join(names[:-1]) + " and " + names[-1]
        verb = "" if parts and n > 0 else " lies" if n < 2 else " lie"
        parts.append(f"{n or 'no'} mode{'s' if n > 1 else ''}{verb} below {listed}")
    return m[2] == ", ".join(parts)


def clearance(m, rec, side, percent):
    return any((c["configuration"], c["mode"], c["side"]) == (m[1], int(m[2]), side) and close(percent, abs(c["percent"]), 3) for c in rec["clearances"])


def on_edge(m, rec, _):
    f = mode_of(rec, m[1], m[2])
    return abs(f["recommended_hz"] / float(m[4]) - 1) < 1e-5


BOUND = re.compile(r"An? (?:upper|lower) bound of (\w+) that is ([-+\d.e]+).* (?:higher|lower)$")


def buys(m, rec, _):
    """100 N/m more of the one spring."""
    name, amount = BOUND.match(m[1]).groups()
    p, f = parameter(rec, name), mode_of(rec, m[2], m[3])
    step = float(amount) * (p["display_factor"] or 1)
    return close(m[4], 0.5 * f["recommended_hz"] * step / p["recommended"], 3)


def saves(m, rec, result):
    """Of an objective that is the variable itself the room at its bound is what it saves; else hunt/check_words.py solves again."""
    text = BOUND.match(m[1])
    return text is not None and (result["objectives"][0]["text"] != text[1] or float(text[2]) == float(re.match(r"the objective by ([-+\d.e]+)$", m[3])[1]))


def double(_, rec, __):
    """x comes to the top of 2 - x^2: a target that is 1e-6 higher has no design, one that is lower two, a thousandth apart."""
    return rec["singular"] and (len(rec["parameters"]) != 1 or abs(rec["parameters"][0]["recommended"]) < 1e-5)


CHECKS = {
    "%s %s by %.3g %%, from %.6g to %.6g%s%s.": changes, "%s goes from %.6g to %.6g%s%s.": goes,
    "%s stands at its %s bound: a wider bound may give a better design.": at_bound, "The original design stays as it is.": stays, "%s keep%s original value%s.": kept,
    "%s mode %d%s%s%s comes to %s Hz%s, %s%s.": comes, "%s mode %d%s%s%s stays at %s Hz%s, %s%s.": remains, "%s mode %d%s%s%s moves from %s to %s Hz%s, %s%s.": moves,
    "%s mode %d is at 0 Hz: nothing holds it at this design%s%s%s.": slack, "Goal %s (%s) has no value here and does not count as met.": valueless,
    "Goal %s (%s) does not count as met: it is not certain which mode it is.": uncertain, "Goal %s (%s) is missed by far.": far,
    "Goal %s (%s) is missed by %.3g %%.": missed, "The %d weighted goal%s deviate%s by %.3g %% rms.": weighted,
    "Its misfit is the least of %d local minima found from %d starts.": least, "It is a local minimum of the misfit, %.3g times that of recommendation 1.": times,
    "It is a local minimum of the misfit, where recommendation 1 has none.": no_fit, "It fits exactly, as recommendation 1 does.": exact,
    "It is the only local optimum, by %s %s, that %d start%s found (sampled, not proven).": single,
    "It is the only design that %d start%s found (sampled, not proven).": single,
    "None of the designs that %d start%s found meets all goals; this one %s.": none_meets, "It ranks %d of %d distinct designs found from %d starts, by %s %s.": ranks,
    "It is a double solution: two designs that meet the goals coincide here, so small errors in the targets move it far.": double,
    "In %s, %s.": below, "%s mode %d stands on the %s edge (%.6g Hz) of band %s.": on_edge,
    "%s mode %d (%.6g Hz) lies inside band %s, %.3g %% from its nearest edge.": lambda m, rec, _: clearance(m, rec, "inside", m[5]),
    "%s mode %d (%.6g Hz) keeps just the margin asked for, %.3g %% %s band %s.": lambda m, rec, _: clearance(m, rec, m[5], m[4]),
    "%s mode %d (%.6g Hz) keeps only %.3g %% %s band %s, of %.3g %% asked.": lambda m, rec, _: clearance(m, rec, m[5], m[4]),
    "%s mode %d (%.6g Hz) keeps %.3g %% %s band %s%s.": lambda m, rec, _: clearance(m, rec, m[5], m[4]),
    "The original design meets all goals, so no design changes less. Others were not searched, as the study asks for none.": least_of_all,
    "%s would %s %s.": saves, "%s would bring %s mode %d nearer to its goal by %.3g Hz.": buys,
}


class Sentences(unittest.TestCase):
    def setUp(self):
        self.formats = formats()
        # the most words first: "%s would %s %s." is what others are, too
        self.patterns = sorted(((pattern(f), f) for f in self.formats), key=lambda q: -len(re.sub(r"%[-+ 0#]*[\d.*]*l?[sdgf]", "", q[1])))
        self.reached = set()

    def judge(self, name, result):
        for rec in [result["baseline"], *result["recommendations"]]:
            for text in (r["text"] for r in rec["reasons"]):
                found = next(((m, f) for p, f in self.patterns if (m := p.match(text))), None)
                if found is None:
                    self.assertRegex(text, "^Of the combinations of catalogue values it ranks", name)
                    continue
                self.reached.add(found[1])
                if found[1] in CHECKS:
                    self.assertTrue(CHECKS[found[1]](found[0], rec, result), f"{name}, rank {rec['rank']}: {text}")

    def test_every_sentence_is_reached_and_computed_again(self):
        for name in STUDIES:
            with tempfile.TemporaryDirectory() as folder:
                self.judge(name, run(Path(folder), name))
        for name in SHIPPED:
            self.judge(name, json.loads((answer(SOURCE / f"studies/{name}.json").folder / "result.json").read_text(encoding="utf-8")))
        by_others = {f for f in self.formats if f in ELSEWHERE}  # some are reached by those tests alone
        self.assertEqual(sorted(set(self.formats) - self.reached - by_others), [])
        self.assertEqual(sorted(set(self.formats) - set(CHECKS) - set(ELSEWHERE)), [])
        self.assertEqual(sorted((set(CHECKS) | set(ELSEWHERE)) - set(self.formats)), [])

    def test_a_false_sentence_is_noticed(self):
        with tempfile.TemporaryDirectory() as folder:
            result = run(Path(folder), "bound")
        for was, false in (("by 100 %", "by 99 %"), ("upper bound", "lower bound"), ("to 7.11763 Hz", "to 7.21763 Hz"), ("by 18.4 %", "by 18.5 %"), ("goal by 0.178", "goal by 0.179")):
            text = json.dumps(result)
            self.assertIn(was, text)
            with self.assertRaises(AssertionError):
                self.judge("false", json.loads(text.replace(was, false)))


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""
Do the tests notice? Small faults, planted one at a time by rule in the rooms that compute bounds, slopes, rows and printed numbers: a
comparison that takes the other end in, a sign, a bound for the other, an index, a margin left out, "and" for "or", a term left out. Each is
built in a copy of the tree and judged by tests until the first that fails: first those of its room and of the rooms right above it, by what
they cost, then the quick suite. What both pass has survived, and is listed with its line.

    tests/planted/plant.py --count 100 --seed 1                of all rooms
    tests/planted/plant.py --rooms prove,expr --count 20
    tests/planted/plant.py --first --count 100                 without the quick suite
    tests/planted/plant.py --only src/prove/box.c:120:less      one fault once more (more of them: separated by commas)
    tests/planted/plant.py --again --seed 1                    what survived, once more: after a test was written
    tests/planted/plant.py --list                              how many there are of each kind

Answers go to build/planted/SEED.jsonl, one line for each fault; a run that was stopped goes on there. A fault costs ten seconds of one core,
one that the first stage does not notice one minute, one that survives four more.
"""
import argparse
import collections
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ROOMS = ["prove", "expr", "mechanics", "modal", "analysis", "nlp", "problem", "search", "vibration", "result", "describe", "answer", "report"]
# What judges a fault first: its own room's tests, then these, which rest upon it; those named in full whatever they cost.
ABOVE = {"prove": ["problem/", "search/", "answer/", "cli/test_tolerances"],
         "expr": ["prove/", "model/", "mechanics/", "problem/"],
         "mechanics": ["analysis/", "mechanisms/", "problem/", "tree/", "scene/", "simulate/", "response/"],
         "modal": ["analysis/test_lowest", "analysis/test_lowest_trees", "analysis/", "response/", "describe/test_study", "stress/test_eigensolver"],
         "analysis": ["prove/", "problem/", "response/", "search/", "answer/", "mechanisms/", "describe/"],
         "nlp": ["answer/test_study", "answer/", "search/", "problem/test_tolerance"],
         "problem": ["describe/test_numbers", "cli/test_motion", "describe/", "answer/", "search/"],
         "search": ["cli/test_possible", "cli/test_motion", "answer/", "describe/"],
         "vibration": ["cli/test_response_vibration", "response/", "answer/test_study_vibration", "problem/test_study_gradient"],
         "result": ["io/", "report/", "library/", "describe/", "cli/test_diff", "cli/test_result_folder", "cli/test_trade_table"],
         "answer": ["describe/", "search/", "library/", "cli/test_motion", "cli/test_budget", "cli/test_proof_budget", "cli/test_trade_table", "cli/test_models"],
         "describe": ["cli/test_motion", "answer/", "report/", "library/", "cli/test_explain", "cli/test_trade_table"],
         "report": ["describe/test_numbers", "library/", "cli/test_explain", "cli/test_trade_table", "cli/test_show", "cli/test_words"]}
FIRST_EACH, FIRST_ALL = 4.0, 40.0  # seconds that one of the others, and all of them, may cost
STEPS = (1.0, 6.0)  # it is built and run in steps: all tests below so many seconds, then the next
BUILD_LIMIT, STEP_LIMIT, QUICK_LIMIT = 600, 60, 1800  # seconds: a fault may never end; of a step beside ten times what its tests cost
UNSUITED = "^(browser|structure|install)/"  # what does not judge the code, or not in a copy
NAME = r"[A-Za-z_]\w*"
# kind: what is found (group 1 is replaced), by what
RULES = {
    "less": (r"(?<![<>=\-])(<)(?![<=])(?= )", "<="), "less or equal": (r"(<=)", "<"), "more": (r"(?<![<>\-=])(>)(?![>=])(?= )", ">="),
    "more or equal": (r"(>=)", ">"), "equal": (r"(==)", "!="), "unequal": (r"(!=)", "=="), "plus": (r"(?<=[\w)\]]) (\+) (?=[\w(])", "-"),
    "minus": (r"(?<=[\w)\]]) (-) (?=[\w(])", "+"), "sign": (r"(?<=[=(,?:] )(-)(?=[\w(])|(?<=\()(-)(?=[A-Za-z_(])", ""), "least": (r"\b(fmin)\(", "fmax"),
    "greatest": (r"\b(fmax)\(", "fmin"), "lower": (r"\b(lower|low|lo)\b(?!\w)", {"lower": "upper", "low": "high", "lo": "hi"}),
    "upper": (r"\b(upper|high|hi)\b(?!\w)", {"upper": "lower", "high": "low", "hi": "lo"}), "index": (r"\[(\w+ \+ 1|\w+ - 1)\]", None),
    "margin": (r"\b(1\.0 \+ )", "1.0 - "), "rounding": (r"\b(DBL_EPSILON)\b", "0.0"), "and": (r"(&&)", "||"), "or": (r"(\|\|)", "&&"),
    "term": (rf"^\s+({NAME}[\w.>\-\[\]]* [+\-*]= [^;]+;)$", ";"), "absolute": (r"\b(fabs)\(", ""), "half": (r"\b(0\.5)\b", "1.0"),
}


def without_comments(text):
    """The text with comments, strings and preprocessor lines blanked out, place by place."""
    blank = lambda m: re.sub(r"[^\n]", " ", m[0])
    return re.sub(r'/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'|^#(?:[^\n]*\\\n)*[^\n]*$', blank, text, flags=re.S | re.M)


def faults(rooms):
    """(file, line, column, kind, what, by what), in the order of the files."""
    found = []
    for room in rooms:
        for path in sorted((ROOT / "src" / room).glob("*.c")):
            text = path.read_text(encoding="utf-8")
            for number, (line, whole) in enumerate(zip(without_comments(text).split("\n"), text.split("\n")), 1):
                for kind, (pattern, other) in RULES.items():
                    for m in re.finditer(pattern, line):
                        group = next(i for i in range(1, len(m.groups()) + 1) if m[i] is not None)
                        was = whole[m.start(group):m.end(group)]
                        new = was.split(" ")[0] if other is None else other[was] if isinstance(other, dict) else other
                        found.append((str(path.relative_to(ROOT)), number, m.start(group), kind, was, new))
    return found


def chosen(all_of, count, rng):
    """Of every kind and room in turn, so that no kind drowns the others."""
    piles = collections.defaultdict(list)
    for fault in all_of:
        piles[fault[0].split("/")[1], fault[3]].append(fault)
    for pile in piles.values():
        rng.shuffle(pile)
    keys, out = sorted(piles), []
    rng.shuffle(keys)
    while len(out) < count and any(piles.values()):
        out += [piles[key].pop() for key in keys if piles[key]][:count - len(out)]
    return out


class Copy:
    """A copy of the tree with a build of its own, where faults are planted."""

    def __init__(self, folder, without, budget):
        self.budget = budget
        self.folder, self.build = folder, folder / "build/release"
        names = subprocess.run(["git", "ls-files", "-z", "-co", "--exclude-standard"], cwd=ROOT, capture_output=True, check=True).stdout.decode().split("\0")
        names = {name for name in names if name and (ROOT / name).is_file()}
        for path in [p for p in folder.rglob("*") if p.is_file() and not p.is_relative_to(folder / "build") and str(p.relative_to(folder)) not in names]:
            path.unlink()
        for name in sorted(names):  # what has not changed stays, and is not built again
            if not (folder / name).exists() or (folder / name).read_bytes() != (ROOT / name).read_bytes():
                (folder / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(ROOT / name, folder / name)
        self.environment = dict(os.environ, CMAKE_C_COMPILER_LAUNCHER="ccache", CCACHE_BASEDIR=str(folder), CCACHE_NOHASHDIR="1")
        for command in (["cmake", "--preset", "release"], ["cmake", "--build", "build/release"]):
            subprocess.run(command, cwd=folder, env=self.environment, check=True, stdout=subprocess.DEVNULL)
        self.targets = set(re.findall(r"^(tests/\w+/\w+): ", self.output("ninja", "-C", self.build, "-t", "targets", "all"), re.M))
        listed = json.loads(self.output("ctest", "--test-dir", self.build, "-LE", "long", "--show-only=json-v1"))
        self.tests = [test["name"] for test in listed["tests"] if not re.match(UNSUITED, test["name"]) and not (without and re.search(without, test["name"]))]
        self.costs = self.measured()

    def output(self, *command):
        return subprocess.run(command, cwd=self.folder, env=self.environment, capture_output=True, text=True, check=True).stdout

    def measured(self):
        """What each test cost when the suite ran last, here or in the tree: by that they are ordered."""
        found = {}
        for build in (ROOT / "build/release", self.build):
            path = build / "Testing/Temporary/CTestCostData.txt"
            if path.exists():
                rows = (line.split() for line in path.read_text(encoding="utf-8").split("---")[0].splitlines())
                found.update({row[0]: float(row[2]) for row in rows if row[0] not in found and float(row[2]) > 0})
        return found

    def first_stage(self, room):
        """The tests of the room, and of the rooms above while their costs allow; in steps, cheap ones first."""
        cost = lambda test: self.costs.get(test, 1.0)
        picked = [test for test in self.tests if test.startswith(room + "/") or test in ABOVE[room]]
        above = [test for test in self.tests if test.startswith(tuple(ABOVE[room])) and cost(test) <= FIRST_EACH]
        left = self.budget
        for test in sorted(set(above) - set(picked), key=lambda test: (cost(test), test)):
            left -= cost(test)
            if left >= 0:
                picked.append(test)
        marks = (0.0, *STEPS, float("inf"))
        return [sorted((t for t in picked if low <= cost(t) < high), key=cost) for low, high in zip(marks, marks[1:])]

    def run(self, command, limit):
        """None: it had no end, and was killed with all that it had started."""
        done = subprocess.Popen(command, cwd=self.folder, env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True)
        try:
            said, _ = done.communicate(timeout=limit)
        except subprocess.TimeoutExpired:
            os.killpg(done.pid, signal.SIGKILL)
            done.communicate()
            return None
        return subprocess.CompletedProcess(command, done.returncode, said)

    def built(self, wanted):
        """Does it compile, without a warning? A compiler that warns has noticed."""
        done = self.run(["ninja", "-C", str(self.build), *wanted], BUILD_LIMIT)
        return done is not None and done.returncode == 0 and "warning:" not in done.stdout

    def first_failure(self, *arguments, limit, jobs=1):
        done = self.run(["ctest", "--test-dir", str(self.build), "-LE", "long", "-j", str(jobs), "--stop-on-failure", *arguments], limit)
        if done is None:
            return "without an end"
        failed = re.search(r"Test +#\d+: (\S+) \.*\*\*\*", done.stdout)
        return failed[1] if failed else None if done.returncode == 0 else "ctest"

    def noticed_first(self, room):
        for step in self.first_stage(room):
            programs = [f"tests/{test}" for test in step if f"tests/{test}" in self.targets]
            if not self.built(["modetune", "libmodetune.so", "tests/modetune_faults", *programs]):
                return "the compiler"
            limit = STEP_LIMIT + 10 * sum(self.costs.get(test, 1.0) for test in step)
            found = step and self.first_failure("-R", "^(" + "|".join(step) + ")$", limit=limit)
            if found:
                return found
        return None

    def judge(self, fault, quick):
        """What notices it; None: nothing does."""
        name, line, column, _, was, new = fault
        path, room = self.folder / name, name.split("/")[1]
        sound = path.read_text(encoding="utf-8")
        lines = sound.split("\n")
        assert lines[line - 1][column:column + len(was)] == was, fault
        lines[line - 1] = lines[line - 1][:column] + new + lines[line - 1][column + len(was):]
        path.write_text("\n".join(lines), encoding="utf-8")
        try:
            found = self.noticed_first(room)
            if found is None and quick:
                found = self.first_failure("-E", UNSUITED, limit=QUICK_LIMIT, jobs=os.cpu_count()) if self.built([]) else "the compiler"
            return found
        finally:
            path.write_text(sound, encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rooms", default=",".join(ROOMS))
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", metavar="FILE:LINE:KIND,...")
    parser.add_argument("--first", action="store_true", help="the first stage alone")
    parser.add_argument("--budget", type=float, default=FIRST_ALL, metavar="SECONDS", help="of the tests of the rooms above that are not named, in the first stage")
    parser.add_argument("--without", metavar="REGEX", help="as if these tests were not there")
    parser.add_argument("--again", action="store_true", help="judges once more what survived")
    parser.add_argument("--list", action="store_true")
    asked = parser.parse_args()
    everything = faults(asked.rooms.split(","))
    if asked.list:
        for (room, kind), n in sorted(collections.Counter((f[0].split("/")[1], f[3]) for f in everything).items()):
            print(f"{room:10} {kind:14} {n}")
        print(f"{len(everything)} faults")
        return 0
    picked = chosen(everything, asked.count, random.Random(asked.seed))
    if asked.only:
        meant = {tuple(one.split(":")) for one in asked.only.split(",")}
        picked = [f for f in everything if (f[0], str(f[1]), f[3]) in meant]
    folder = ROOT / "build/planted"
    folder.mkdir(parents=True, exist_ok=True)
    answers = folder / ("only.jsonl" if asked.only else f"{asked.seed}.jsonl")
    known = {}
    if answers.exists() and not asked.only:
        known = {tuple(a["fault"]): a["noticed_by"] for a in map(json.loads, answers.read_text(encoding="utf-8").splitlines())}
        if asked.again:
            picked = [f for f in picked if f in known and known[f] is None]
            known = {}
    copy = None
    for fault in picked:
        if fault not in known:
            copy = copy or Copy(folder / "tree", asked.without, asked.budget)
            known[fault] = copy.judge(fault, quick=not asked.first)
            with answers.open("a", encoding="utf-8") as out:
                out.write(json.dumps({"fault": fault, "noticed_by": known[fault]}) + "\n")
        name, line, _, kind, was, new = fault
        print(f"{name}:{line}: {kind}: \"{was}\" is \"{new}\": {known[fault] or 'SURVIVED'}", flush=True)
    survived = [f for f in picked if known[f] is None]
    said = [f for f in picked if known[f] != "the compiler"]
    noticed = len(said) - len(survived)
    print(f"{len(picked)} faults, {len(picked) - len(said)} noticed by the compiler; of the others {noticed} of {len(said)} by a test"
          f" ({100 * noticed / max(len(said), 1):.0f} %)")
    return 0


if __name__ == "__main__":
    sys.exit(main())

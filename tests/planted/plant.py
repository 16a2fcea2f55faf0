#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""
Do the tests notice? Small faults, planted one at a time by rule in the rooms that compute bounds, slopes, rows and printed numbers: a
comparison that takes the other end in, a sign, a bound for the other, an index, a margin left out, "and" for "or", a term left out. Each is
built in a copy of the tree; the tests of its room judge it, then the quick suite. What both pass has survived, and is listed with its line.

    tests/planted/plant.py --count 100 --seed 1                of all rooms
    tests/planted/plant.py --rooms prove,expr --count 20
    tests/planted/plant.py --only src/prove/box.c:120:less      one fault once more
    tests/planted/plant.py --list                              how many there are of each kind

Answers go to build/planted/SEED.jsonl, one line for each fault; a run that was stopped goes on there. A fault costs a minute of one core,
one that survives four more.
"""
import argparse
import collections
import json
import os
import random
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ROOMS = ["prove", "expr", "modal", "problem", "search", "vibration", "describe", "report"]
BUILD_LIMIT, ROOM_LIMIT, QUICK_LIMIT = 600, 900, 1800  # seconds: a fault may never end
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

    def __init__(self, folder):
        self.folder, self.build = folder, folder / "build/release"
        shutil.rmtree(folder, ignore_errors=True)
        files = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=True).stdout.decode().split("\0")
        for name in filter(None, files):
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, folder / name)
        self.environment = dict(os.environ, CMAKE_C_COMPILER_LAUNCHER="ccache", CCACHE_BASEDIR=str(folder), CCACHE_NOHASHDIR="1")
        for command in (["cmake", "--preset", "release"], ["cmake", "--build", "build/release"]):
            subprocess.run(command, cwd=folder, env=self.environment, check=True, stdout=subprocess.DEVNULL)
        self.targets = subprocess.run(["ninja", "-C", self.build, "-t", "targets", "all"], capture_output=True, text=True, check=True).stdout.splitlines()

    def run(self, command, limit):
        try:
            return subprocess.run(command, cwd=self.folder, env=self.environment, capture_output=True, text=True, timeout=limit)
        except subprocess.TimeoutExpired:
            return None

    def built(self, room):
        """Does it compile, without a warning? A compiler that warns has noticed."""
        wanted = ["modetune", "libmodetune.so"] + [t.split(":")[0] for t in self.targets if re.match(rf"tests/{room}/test_\w+: ", t)]
        done = self.run(["ninja", "-C", str(self.build), *dict.fromkeys(wanted)], BUILD_LIMIT)
        return done is not None and done.returncode == 0 and "warning:" not in done.stdout

    def first_failure(self, *arguments, limit):
        done = self.run(["ctest", "--test-dir", str(self.build), "-LE", "long", "-j", str(os.cpu_count()), "--stop-on-failure", "--timeout", "300", *arguments], limit)
        if done is None:
            return "without an end"
        failed = re.search(r"Test +#\d+: (\S+) \.*\*\*\*", done.stdout)
        return failed[1] if failed else None if done.returncode == 0 else "ctest"

    def judge(self, fault):
        """What notices it; None: nothing does."""
        name, line, column, _, was, new = fault
        path, room = self.folder / name, name.split("/")[1]
        sound = path.read_text(encoding="utf-8")
        lines = sound.split("\n")
        assert lines[line - 1][column:column + len(was)] == was, fault
        lines[line - 1] = lines[line - 1][:column] + new + lines[line - 1][column + len(was):]
        path.write_text("\n".join(lines), encoding="utf-8")
        try:
            if not self.built(room):
                return "the compiler"
            found = self.first_failure("-L", f"^{room}$", limit=ROOM_LIMIT)
            if found is None:
                done = self.run(["ninja", "-C", str(self.build)], BUILD_LIMIT)
                found = "the compiler" if done is None or done.returncode != 0 else self.first_failure("-E", "^(browser|structure|install)/", limit=QUICK_LIMIT)
            return found
        finally:
            path.write_text(sound, encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rooms", default=",".join(ROOMS))
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", metavar="FILE:LINE:KIND")
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
        name, line, kind = asked.only.split(":")
        picked = [f for f in everything if (f[0], str(f[1]), f[3]) == (name, line, kind)]
    folder = ROOT / "build/planted"
    folder.mkdir(parents=True, exist_ok=True)
    answers = folder / ("only.jsonl" if asked.only else f"{asked.seed}.jsonl")
    known = {}
    if answers.exists() and not asked.only:
        known = {tuple(a["fault"]): a["noticed_by"] for a in map(json.loads, answers.read_text(encoding="utf-8").splitlines())}
    copy = None
    for fault in picked:
        if fault not in known:
            copy = copy or Copy(folder / "tree")
            known[fault] = copy.judge(fault)
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

# SPDX-License-Identifier: GPL-3.0-or-later
"""What exactly one sibling takes belongs into that sibling's file: functions that are external for one other file of their room are counted,
and so are the sources of less than 150 lines. The limits of this test only get lower."""
import os
from pathlib import Path

from common import ROOMS, ROOT, c_files, verdict
from test_symbols import BUILD, exported_names, functions, objects_of

MOST_FOR_ONE = 253
SHORT = 150  # lines
MOST_SHORT = 9


def for_one_sibling(table, exported):
    """table: {source: (defined, taken)}: {room: [(function, its source, the only source that takes it)]}"""
    takers = {}
    for source, (_, taken) in table.items():
        for symbol in taken:
            takers.setdefault(symbol, []).append(source)
    found = {}
    for source, (defined, _) in sorted(table.items()):
        for symbol in sorted(defined - exported):
            by = takers.get(symbol, [])
            if len(by) == 1 and by[0].parent == source.parent:
                found.setdefault(source.parent.name, []).append((symbol, source, by[0]))
    return found


def limit_problems(what, number, most):
    return [f"{number} {what}, more than {most}: merge files of one subject"] if number > most else []


def self_test():
    table = {Path(name): (set(defined.split()), set(taken.split())) for name, defined, taken in (
        ("tree/a.c", "one two up public", ""), ("tree/b.c", "", "one two public"), ("tree/c.c", "", "two"), ("modal/d.c", "", "up"))}
    problems = []
    if for_one_sibling(table, {"public"}) != {"tree": [("one", Path("tree/a.c"), Path("tree/b.c"))]}:
        problems.append(f"self-test: {for_one_sibling(table, {'public'})}")
    if [len(limit_problems("functions", number, 2)) for number in (2, 3)] != [0, 1]:
        problems.append("self-test: a limit is not held")
    return problems


def main():
    objects = objects_of(BUILD, ROOT)
    seen = functions(objects.values())
    public = exported_names("".join(p.read_text(encoding="utf-8") for p in c_files(ROOT / "include")))
    table = {source: seen[str(path)] for source, path in objects.items()}
    found = for_one_sibling(table, public)
    lines = {source: (ROOT / "src" / source).read_text(encoding="utf-8").count("\n") for source in objects}
    short = [source for source in sorted(lines) if lines[source] < SHORT]
    for room in ROOMS:
        units = [source for source in lines if source.parent.name == room]
        print(f"{room:10} {len(units):3} sources, {sum(source in short for source in units):3} of them short, "
              f"{len(found.get(room, [])):3} functions external for one sibling")
        if os.environ.get("MT_SIBLINGS") == room:  # to look at one room
            for symbol, source, by in found.get(room, []):
                print(f"    {symbol} of {source.name} for {by.name}")
    faults = limit_problems("functions are external for one sibling", sum(map(len, found.values())), MOST_FOR_ONE)
    faults += limit_problems(f"sources have less than {SHORT} lines", len(short), MOST_SHORT)
    verdict("siblings", len(table), faults + self_test())


if __name__ == "__main__":
    main()

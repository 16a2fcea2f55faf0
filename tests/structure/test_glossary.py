# SPDX-License-Identifier: GPL-3.0-or-later
"""The field's words stand in the code: no identifier of glossary.csv's first column where the second has taken its place.

The third column names the rooms of src, and the folders of tests beside them, in which a word was another's; * is everywhere.
"""
import csv
import re

from common import ROOMS, ROOT, c_files, code_only, verdict

TABLE = ROOT / "tests/structure/glossary.csv"


def read_table(lines):
    table = {}
    for row in csv.DictReader(lines):
        for room in row["rooms"].split():
            table[room, row["old"]] = row["new"]
    return table


def problems_of(name, text, room, table):
    for number, line in enumerate(code_only(text).split("\n"), 1):
        for word in re.findall(r"[A-Za-z_]\w*", line):
            new = table.get(("*", word)) or table.get((room, word))
            if new:
                yield f"{name}:{number}: {word} is called {new}"


def self_test(table):
    wrong = list(problems_of("x.c", "int mt_case; /* mt_case */ char *s = \"mt_case\";\nint posed;\n", "problem", table))
    if wrong != ["x.c:1: mt_case is called mt_subproblem", "x.c:2: posed is called at_position"]:
        return [f"self-test: found {wrong}"]
    if list(problems_of("x.c", "int motion, next, left, place;\n", "simulate", table)):
        return ["self-test: an ordinary word was refused"]
    return []


def main():
    with open(TABLE, encoding="utf-8", newline="") as file:
        table = read_table(file)
    rooms = {room for room, _ in table} - {"*"}
    faults = [f"glossary.csv: no room {room}" for room in sorted(rooms - set(ROOMS) - {"include"})]
    faults += [f"glossary.csv: {new} is old, too" for (room, old), new in table.items() if ("*", new) in table or (room, new) in table]
    files = c_files(ROOT / "src", ROOT / "include", ROOT / "tests")
    for path in files:
        name = str(path.relative_to(ROOT))
        parts = path.relative_to(ROOT).parts
        faults += problems_of(name, path.read_text(encoding="utf-8"), parts[1] if parts[0] != "include" else "include", table)
    assert len(table) > 600
    verdict("glossary", len(files), faults + self_test(table))


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""A kind of goal or objective is its line in a table of study and its own file: nobody else asks which one it is."""
import re
import tempfile
from pathlib import Path

from common import ROOT, c_files, code_only, verdict

TABLES = {"GOAL": "src/study/goals.h", "OBJECTIVE": "src/study/objectives.h"}
# what is meant where a kind is named all the same
MEANT = {
    "MT_OBJECTIVE_NONE": None,  # that there is no objective may be asked anywhere
    "MT_OBJECTIVE_EXPRESSION": ("src/study/objectives.c",),  # what is no word is an expression
    "MT_OBJECTIVE_CHANGE": (  # the distance from the original design itself
        "src/study/objectives.c",  # the objective where none is given
        "src/search/relaxation.c",  # the nearest design
        "src/search/search_nearest.c",  # of optima that are as good
        "src/search/search.c", "src/search/mode_placements.c",  # what no goal settles stays at the original
        "src/search/mode_placements_bounds.c",  # how far a box is from the original
        "src/search/catalogue_search.c",  # combinations come in the order of their change
        "src/answer/solve.c",  # the original itself
        "src/answer/trade.c",  # results tell the change of every design
    ),
}


def kinds(root, what):
    """Names of the enumerators of a table."""
    text = (root / TABLES[what]).read_text(encoding="utf-8")
    rows = re.search(rf"#define MT_{what}_LIST\(X\)((?:.*\\\n)*.*\n)", text)
    return [f"MT_{what}_{name}" for name in re.findall(r"\bX\((\w+),", rows.group(1))] if rows else []


def check(root):
    """(number of files, problems): kinds that are named where only their operations should be asked."""
    names = {name for what in TABLES for name in kinds(root, what)}
    count, problems = 0, []
    for path in c_files(root / "src"):
        place = path.relative_to(root).as_posix()
        count += 1
        if place in TABLES.values():
            continue
        for number, line in enumerate(code_only(path.read_text(encoding="utf-8")).split("\n"), 1):
            for name in re.findall(r"\bMT_(?:GOAL|OBJECTIVE)_[A-Z]+\b", line):
                allowed = MEANT.get(name, ())
                if name in names and allowed is not None and place not in allowed:
                    problems.append(f"{place}:{number}: asks for {name}: an operation or a property of the kind should tell")
    return count, problems


def self_test():
    """A planted question is found, a name that only begins alike is not."""
    problems = []
    for line, expected in (("if (g->type == MT_GOAL_MAC) {", 1), ("n = MT_GOAL_NUMBERS;", 0),
                           ("/* MT_GOAL_MAC */", 0), ("t = MT_OBJECTIVE_MASS;", 1), ("t = MT_OBJECTIVE_NONE;", 0)):
        with tempfile.TemporaryDirectory() as folder:
            for what, row in (("GOAL", "MAC, mac"), ("OBJECTIVE", "NONE, none) X(MASS, mass")):
                table = Path(folder, TABLES[what])
                table.parent.mkdir(parents=True, exist_ok=True)
                table.write_text(f"#define MT_{what}_LIST(X) X({row})\n", encoding="utf-8")
            Path(folder, "src", "search").mkdir()
            Path(folder, "src", "search", "a.c").write_text(line + "\n", encoding="utf-8")
            found = check(Path(folder))[1]
            if len(found) != expected:
                problems.append(f"self-test: {line!r} gave {found}")
    return problems


if __name__ == "__main__":
    if not all(kinds(ROOT, what) for what in TABLES):
        verdict("kinds", 0, ["a table of kinds could not be read"])
    number, faults = check(ROOT)
    verdict("kinds", number, faults + self_test())

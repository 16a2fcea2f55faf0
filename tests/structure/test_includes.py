# SPDX-License-Identifier: GPL-3.0-or-later
"""Rooms include only what the table allows, and every third party has one door."""
import re
import shutil
import tempfile
from pathlib import Path

from common import ROOMS, ROOT, c_files, verdict

MAP = "src/README.md"


def arrows(text):
    """The tables of the map: {room: rooms whose headers it may include, besides its own}."""
    table = {}
    for room, allowed in re.findall(r"^\| \[?`(\w+)`[^|]*\|[^|]*\|([^|]*)\|[^|]*\|$", text, re.M):
        table[room] = set(ROOMS) - {room} if "everything" in allowed else set(re.findall(r"\w+", allowed)) & set(ROOMS)
    return table


ALLOWED = arrows((ROOT / MAP).read_text(encoding="utf-8"))
# rooms that say which headers others may read; elsewhere all but *_priv.h
OPEN = {
    "nlp": {"nlp.h", "cone.h", "merit.h"},
    "scene": {"scene.h", "write.h"},
    "prove": {"enclosure.h", "box.h", "certify.h", "tolerance.h", "band_count.h"},
}
# public headers stand in include/modetune and belong to a room: the one of the same name, or
PUBLIC = {"export": "base", "read": "base", "version": "base", "status": "base", "dynamics": "mechanics", "study": "study", "profile": "environment", "mechanism": "library", "motion": "library", "answers": "library"}
# <system header> pattern: the rooms that may include it
DOORS = [
    (re.compile(r"lapacke|cblas|lapack|openblas|(suitesparse/)?cholmod"), {"linalg"}),
    (re.compile(r"(cjson/)?cJSON"), {"io"}),
    (re.compile(r"gsl/gsl_odeiv2\.h"), {"simulate"}),
    (re.compile(r"gsl/gsl_errno\.h"), {"simulate", "cli"}),  # cli: what GSL does where memory is out
    (re.compile(r"nlopt|gsl/(?!gsl_(odeiv2|errno)\.h)"), {"nlp"}),
    (re.compile(r"pthread\.h|threads\.h"), {"base"}),
    (re.compile(r"signal\.h|time\.h|sys/time\.h"), {"cli"}),
    (re.compile(r"locale\.h"), {"cli", "io"}),  # io: of one thread, while cJSON reads numbers; setlocale is refused by test_calls.py
]
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*(.*)$', re.M)


def quoted_problem(room, name):
    folder, _, rest = name.partition("/")
    if not rest or ".." in name:
        return "is not written as \"room/file.h\""
    if folder == "modetune":
        stem = rest.removesuffix(".h")
        owner = PUBLIC.get(stem, stem if stem in ROOMS else None)
        if owner is None:
            return "is a public header without a room: add it to PUBLIC in tests/structure/test_includes.py"
        folder = owner
    if folder not in ROOMS:
        return "names no room"
    if folder != room and folder not in ALLOWED.get(room, ()):
        return f"is not allowed in {room}"
    if folder != room and (rest.endswith("_priv.h") or rest not in OPEN.get(folder, {rest})):
        return f"is private to {folder}"
    return None


def system_problem(room, name):
    for pattern, rooms in DOORS:
        if pattern.match(name) and room not in rooms:
            return f"has its only door in {'/'.join(sorted(rooms))}"
    return None


def check_file(path, room):
    text = path.read_text(encoding="utf-8")
    for match in INCLUDE.finditer(text):
        target = match.group(1).strip()
        line = text.count("\n", 0, match.start()) + 1
        if target.startswith('"'):
            name = target[1:].partition('"')[0]
            problem = None if room == "public" and name.startswith("modetune/") else \
                "is not public" if room == "public" else quoted_problem(room, name)
        elif target.startswith("<"):
            name = target[1:].partition(">")[0]
            problem = system_problem(room, name)
        else:
            name, problem = target, "is neither <file> nor \"file\""
        if problem:
            yield f"{path}:{line}: include of {name} {problem}"


def check(root):
    """(number of files, problems) of the tree below root."""
    files, problems = 0, []
    for path in c_files(root / "src"):
        files += 1
        parts = path.relative_to(root / "src").parts
        if len(parts) != 2 or parts[0] not in ROOMS:
            problems.append(f"{path}: is not directly in a room of src/")
        else:
            problems += check_file(path, parts[0])
    for path in c_files(root / "include"):
        files += 1
        problems += check_file(path, "public")
    return files, problems


def map_problems(table):
    """Rooms that the map has not, and circles: rooms that are left when those that need none of the others are taken away."""
    problems = [f"{MAP}: has no room {room}" for room in ROOMS if room not in table]
    left = {room: set(needs) for room, needs in table.items()}
    while any(not needs & set(left) for needs in left.values()):
        left = {room: needs for room, needs in left.items() if needs & set(left)}
    return problems + [f"{MAP}: {' and '.join(sorted(left))} need each other"] * bool(left)


def self_test():
    """Every planted fault is found, and an empty tree is not a pass."""
    planted = [
        ("src/base/x.c", '#include "linalg/dense.h"', "not allowed in base"),
        ("src/modal/x.c", '#include "mechanics/x.h"', "not allowed in modal"),
        ("src/analysis/x.c", '#include "mechanics/x_priv.h"', "private to mechanics"),
        ("src/search/x.c", '#include "nlp/engine.h"', "private to nlp"),
        ("src/report/x.h", '#include "model/model.h"', "not allowed in report"),
        ("src/report/x.c", '#include "study/study.h"', "not allowed in report"),
        ("src/model/x.c", "#include <cjson/cJSON.h>", "only door in io"),
        ("src/modal/x.c", "  #  include <lapacke.h>", "only door in linalg"),
        ("src/io/x.c", "#include <nlopt.h>", "only door in nlp"),
        ("src/mechanics/x.c", "#include <gsl/gsl_math.h>", "only door in nlp"),
        ("src/nlp/x.c", "#include <gsl/gsl_odeiv2.h>", "only door in simulate"),
        ("src/simulate/x.c", "#include <gsl/gsl_qrng.h>", "only door in nlp"),
        ("src/search/x.c", "#include <time.h>", "only door in cli"),
        ("src/base/x.c", '#include "arena.h"', "not written as"),
        ("src/base/x.c", '#include "../linalg/dense.h"', "not written as"),
        ("src/base/x.c", '#include "modetune/unheard.h"', "without a room"),
        ("src/base/x.c", '#include "modetune/study.h"', "not allowed in base"),
        ("src/base/x.c", "#include SOME_MACRO", "neither"),
        ("src/odd/x.c", "", "not directly in a room"),
        ("include/modetune/x.h", '#include "base/arena.h"', "not public"),
        ("include/modetune/x.h", "#include <lapacke.h>", "only door in linalg"),
    ]
    problems = []
    for name, line, expected in planted:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, name)
            path.parent.mkdir(parents=True)
            path.write_text(f"/* x */\n{line}\n")
            found = check(Path(folder))[1]
            if len(found) != 1 or expected not in found[0]:
                problems.append(f"self-test: {line!r} in {name} gave {found}")
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder, "copy")
        shutil.copytree(ROOT / "src", copy / "src")
        before = check(copy)[1]
        (copy / "src/base/zz_planted.c").write_text('#include "cli/cli.h"\n')
        if len(check(copy)[1]) != len(before) + 1:
            problems.append("self-test: a fault planted in a copy of this tree was not found")
        if len(map_problems(arrows("| `base` | promise | linalg | |\n| `linalg` | promise | base | |"))) != len(ROOMS) - 1:
            problems.append("self-test: rooms that are missing, or a circle, were accepted")
        if check(Path(folder, "nothing"))[0] != 0:
            problems.append("self-test: an empty tree has files")
    return problems


if __name__ == "__main__":
    count, faults = check(ROOT)
    faults += map_problems(ALLOWED)
    verdict("includes", count, faults + self_test())

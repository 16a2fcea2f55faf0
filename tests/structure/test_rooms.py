# SPDX-License-Identifier: GPL-3.0-or-later
"""
Each room of src has a map, src/<room>/README.md of 20 to 60 lines: what it promises, its data, the way of a call through its files, its numerics with
their sources, and how it is tested. Every .c file of the room is named in it, and files and types that it names are there, as are the files that
src/README.md names. The map of cli, whose README.md is the user's manual, is its ROOM.md.
"""
import re
import tempfile
from pathlib import Path

from common import ROOMS, ROOT, verdict

MAPS = {"cli": "ROOM.md"}  # of others README.md
LEAST, MOST, COLUMNS = 20, 60, 118
SECTIONS = ("What it promises", "Data", "Way through", "Numerics and sources", "How it is tested")
NAMED = re.compile(r"`([\w./]+\.(?:c|h|py|sh|js|css|json|md))`")
IDENTIFIER = re.compile(r"`(mt_\w+)`")


def is_there(name, root, room):
    """A file of the room, of its tests, of another room, of the tests, or of the tree; or a schema."""
    return any((root / place / name).is_file() for place in (f"src/{room}", "src", f"tests/{room}", "tests", "", "schemas"))


def places(lines, pattern):
    """The names that the pattern finds, each with the number of its first line."""
    found = {}
    for number, line in enumerate(lines, 1):
        for name in pattern.findall(line):
            found.setdefault(name, number)
    return found


def problems_of(root, room, known):
    where = f"src/{room}/{MAPS.get(room, 'README.md')}"
    page = root / where
    if not page.is_file():
        return [f"{where}: is missing"]
    lines = page.read_text(encoding="utf-8").splitlines()
    found = [f"{where}: {len(lines)} lines, {LEAST} to {MOST} are wanted"] if not LEAST <= len(lines) <= MOST else []
    found += [f"{where}:{number}: {len(line)} columns" for number, line in enumerate(lines, 1) if len(line) > COLUMNS]
    heads = tuple(line[3:] for line in lines if line.startswith("## "))
    if heads != SECTIONS:
        found.append(f"{where}: its sections are {heads}, not {SECTIONS}")
    named = places(lines, NAMED)
    found += [f"{where}: {path.name} is not named" for path in sorted((root / "src" / room).glob("*.c")) if path.name not in named]
    found += [f"{where}:{line}: {name} does not exist" for name, line in named.items() if not is_there(name, root, room)]
    return found + [f"{where}:{line}: {name} is no name of the code" for name, line in places(lines, IDENTIFIER).items() if name not in known]


def check(root, rooms):
    """Problems of the rooms below root, and of the page above them."""
    headers = [path.read_text(encoding="utf-8") for folder in ("src", "include") for path in sorted((root / folder).rglob("*.h"))]
    known = {name for text in headers for name in re.findall(r"\bmt_\w+", text)}
    page = root / "src/README.md"
    named = places(page.read_text(encoding="utf-8").splitlines(), NAMED) if page.is_file() else {}
    found = [f"src/README.md:{line}: {name} does not exist" for name, line in named.items() if "/" in name and not is_there(name, root, "")]
    return found + [problem for room in rooms for problem in problems_of(root, room, known)]


def page_text(filler, text):
    return "# a\n" + "\n".join(f"## {head}\n" for head in SECTIONS) + "\nword" * filler + "\n" + text + "\n"


def self_test():
    """Every planted fault is found, what is right is not."""
    problems = []
    right = page_text(10, "`a.c`: `mt_a`, `b/c.h`")
    for house, text, expected in (
            ("`b/c.h`, `d.c`", right, None), ("", None, "README.md: is missing"), ("", page_text(2, "`a.c`"), "lines, 20"), ("", page_text(60, "`a.c`"), "lines, 20"),
            ("", page_text(10, "a.c"), "a.c is not named"), ("", page_text(10, "`a.c`, `d.c`"), "d.c does not exist"),
            ("", page_text(10, "`a.c`, `b/d.h`"), "b/d.h does not exist"), ("", page_text(10, "`a.c`, `mt_b`"), "mt_b is no name"),
            ("", right.replace("## Data", "## Dates"), "sections are"), ("", page_text(10, "`a.c` " + "x" * COLUMNS), "columns"), ("`b/d.c`", right, "b/d.c does not exist")):
        with tempfile.TemporaryDirectory() as folder:
            for name, content in (("src/a/a.c", ""), ("src/b/c.h", "typedef int mt_a;\n"), ("src/README.md", house), ("src/a/README.md", text)):
                if content is not None:
                    path = Path(folder, name)
                    path.parent.mkdir(parents=True, exist_ok=True)
                    path.write_text(content, encoding="utf-8")
            found = check(Path(folder), ["a"])
            if len(found) != (expected is not None) or (expected and expected not in found[0]):
                problems.append(f"self-test: {expected!r} was wanted, {found} found")
    if problems_of(Path("nowhere"), "cli", set()) != ["src/cli/ROOM.md: is missing"]:
        problems.append("self-test: the map of cli was not missed")
    return problems


if __name__ == "__main__":
    faults = check(ROOT, ROOMS) + self_test()
    unlisted = sorted(p.name for p in (ROOT / "src").iterdir() if p.is_dir() and p.name not in ROOMS)
    verdict("rooms", len(ROOMS), faults + [f"src/{room}: common.py does not list this room" for room in unlisted])

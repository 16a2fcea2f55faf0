# SPDX-License-Identifier: GPL-3.0-or-later
"""What the linker sees: rooms call only rooms that they may include, every external function has a caller outside its file, and no room grows over the others."""
import os
import re
import subprocess
import tempfile
from pathlib import Path

from common import ROOMS, ROOT, c_files, verdict
from test_includes import ALLOWED

BUILD = Path(os.environ.get("BUILD_DIR", ROOT / "build/release"))
MOST = 0.2  # of all lines of src in one room
FUNCTION = re.compile(r"(.*): (\w+) ([TWU])\b")
# Functions that nothing but tests calls. This list only gets shorter.
FOR_TESTS = {
    "mt_displaced_eval",  # the independent mechanics that the linearisation is held against
    "mt_enclosure_corners",  # the independent proof by corners
    "mt_model_key_tables", "mt_study_key_tables", "mt_model_types", "mt_study_types", "mt_profile_types", "mt_aircraft_key_tables", "mt_profile_key_tables",  # what readers know, for schemas
    "mt_vibration_respond_slopes",  # of responses of models, which call nothing yet
}


def functions(paths):
    """{object: (names of the external functions that it defines, what it takes from elsewhere)}"""
    table = {str(path): (set(), set()) for path in paths}
    said = subprocess.run(["nm", "-A", "-P", *table], check=True, capture_output=True, text=True).stdout if table else ""
    for line in said.splitlines():
        found = FUNCTION.match(line)
        if found:
            table[found.group(1)][found.group(3) == "U"].add(found.group(2))
    return table


def objects_of(build, root):
    """{source relative to src: object}, for what is there now; an older build may have left more."""
    places = [build / f"CMakeFiles/{target}.dir/src" for target in ("mt_objects", "mt_cli", "modetune_program")]
    found = {}
    for source in sorted((root / "src").glob("*/*.c")):
        name = source.relative_to(root / "src")
        for place in places:
            if (place / f"{name}.o").exists():
                found[name] = place / f"{name}.o"
    return found


def direction_problems(table):
    """table: {source: (defined, taken)}"""
    home = {symbol: source.parent.name for source, (defined, _) in table.items() for symbol in defined}
    for source, (_, taken) in sorted(table.items()):
        for symbol in sorted(taken & set(home)):
            if home[symbol] != source.parent.name and home[symbol] not in ALLOWED[source.parent.name]:
                yield f"src/{source}: {symbol} of {home[symbol]} is not allowed in {source.parent.name}"


def unused_problems(table, exported, by_tests, for_tests=FOR_TESTS):
    taken = set().union(*(symbols for _, symbols in table.values()))
    defined_here = set().union(*(symbols for symbols, _ in table.values()))
    for symbol in sorted(for_tests - defined_here | for_tests & taken):
        yield f"{symbol} is no longer for tests alone: take it from the list"
    for source, (defined, _) in sorted(table.items()):
        for symbol in sorted(defined - taken - exported - {"main"}):
            text = (ROOT / "src" / source).read_text(encoding="utf-8") if (ROOT / "src" / source).exists() else ""
            if len(re.findall(rf"\b{symbol}\b", text)) > 1:  # here and in tests: then it is looked at closely
                if symbol not in by_tests:
                    yield f"src/{source}: {symbol} is for this file alone: static"
            elif symbol not in for_tests:
                yield f"src/{source}: nothing calls {symbol}"
            elif symbol not in by_tests:
                yield f"src/{source}: nothing calls {symbol}, not even a test"


def size_problems(lines):
    """lines: {room: number of lines}"""
    total = sum(lines.values())
    return [f"src/{room}: {n} of {total} lines, more than {100 * MOST:g} %" for room, n in lines.items() if n > MOST * total]


def exported_names(text):
    """Functions that public headers declare."""
    return set(re.findall(r"\b(mt_\w+)\s*\(", text))


def self_test():
    sources = {"base/x.c": "int mt_up(int); int mt_down(int x); int mt_down(int x) { return mt_up(x); } int mt_idle(void); int mt_idle(void) { return 1; }",
               "io/y.c": "int mt_down(int x); int mt_up(int x); int mt_up(int x) { return x + mt_down(x); }"}
    table = {}
    with tempfile.TemporaryDirectory() as folder:
        for name, source in sources.items():
            path = Path(folder, name)
            path.parent.mkdir()
            path.write_text(source)
            subprocess.run([os.environ.get("CC", "cc"), "-fvisibility=hidden", "-c", path, "-o", f"{path}.o"], check=True)
            table[Path(name)] = functions([f"{path}.o"])[f"{path}.o"]
    problems = []
    if list(direction_problems(table)) != ["src/base/x.c: mt_up of io is not allowed in base"]:
        problems.append(f"self-test: {list(direction_problems(table))}")
    for exported, for_tests, wanted in ((set(), set(), 1), ({"mt_idle"}, set(), 0), (set(), {"mt_idle"}, 0), ({"mt_idle"}, {"mt_up"}, 1), ({"mt_idle"}, {"mt_gone"}, 1)):
        said = list(unused_problems(table, exported, {"mt_idle"}, for_tests))
        if len(said) != wanted:
            problems.append(f"self-test: exported {exported}, for tests {for_tests}: {said}")
    if len(size_problems({"base": 21, "io": 19, "cli": 20, "expr": 20, "nlp": 20})) != 1:
        problems.append("self-test: a room of 21 % was accepted")
    return problems


if __name__ == "__main__":
    found = objects_of(BUILD, ROOT)
    count = {room: sum(p.read_text(encoding="utf-8").count("\n") for p in c_files(ROOT / "src" / room)) for room in ROOMS}
    faults = [f"src/{s.relative_to(ROOT / 'src')}: no object below {BUILD}"
              for s in sorted((ROOT / "src").glob("*/*.c")) if s.relative_to(ROOT / "src") not in found]
    seen = functions(found.values())
    symbols = {source: seen[str(path)] for source, path in found.items()}
    tested = set().union(*(taken for _, taken in functions((BUILD / "tests/CMakeFiles").rglob("*.o")).values()))
    public = exported_names("".join(p.read_text(encoding="utf-8") for p in c_files(ROOT / "include")))
    faults += [*direction_problems(symbols), *unused_problems(symbols, public, tested), *size_problems(count)]
    verdict("symbols", len(found), faults + self_test())

# SPDX-License-Identifier: GPL-3.0-or-later
"""Names lead to files: what x.h declares, x.c or a file x_*.c of the same room defines."""
import re
import tempfile
from pathlib import Path

from common import ROOT, c_files, code_only, verdict

# rooms that hold it
ROOMS_HELD = ("base", "expr", "model", "linalg", "mechanics", "tree", "modal", "analysis", "response", "scene", "simulate", "nlp", "result", "prove", "study", "environment", "measurement", "vibration", "describe", "problem", "search", "answer", "inspect",
              "report", "io")
FUNCTION = re.compile(r"^(?!static\b|typedef\b|#|return\b)[A-Za-z_][\w \t*]*?\b(mt_\w+)\(", re.M)


def functions(path):
    """(name, is it a definition?) of every function with external linkage in the file."""
    text = code_only(path.read_text(encoding="utf-8"))
    for match in FUNCTION.finditer(text):
        at, depth = match.end(), 1
        while depth and at < len(text):
            depth += {"(": 1, ")": -1}.get(text[at], 0)
            at += 1
        end = re.match(r"\s*(MT_\w+\([^;{]*\))?\s*([;{])", text[at:])
        if end:
            yield match.group(1), end.group(2) == "{"


def leads(header, source, room):
    """Does the name of the header lead to the source? <room>_priv.h is what all of a room shares."""
    stem = header.stem.removesuffix("_priv")
    shared = header.stem == room + "_priv"
    return shared or source.stem == stem or source.stem.startswith(stem + "_")


def check(root, rooms):
    """(number of headers, problems) of the rooms below root."""
    count, problems = 0, []
    for room in rooms:
        files = c_files(root / "src" / room)
        homes = {name: path for path in files if path.suffix == ".c" for name, is_body in functions(path) if is_body}
        for header in (path for path in files if path.suffix == ".h"):
            count += 1
            for name, is_body in functions(header):
                home = homes.get(name)
                if is_body:
                    problems.append(f"{header}: {name} has its body in a header")
                elif home is None:
                    problems.append(f"{header}: {name} is defined nowhere in its room")
                elif not leads(header, home, room):
                    problems.append(f"{header}: {name} is defined in {home.name}, not in {header.stem}.c")
    return count, problems


def self_test():
    """Every planted fault is found, what is right is not."""
    problems = []
    for files, expected in (
            ({"a.h": "int mt_f(int x);\n", "a.c": "int mt_f(int x)\n{\n    return x;\n}\n"}, None),
            ({"a.h": "int mt_f(int x);\n", "a_b.c": "int mt_f(int x)\n{\n    return x;\n}\n"}, None),
            ({"a_priv.h": "void\nmt_f(int (*g)(int),\n     int x);\n", "a_b.c": "void\nmt_f(int (*g)(int), int x)\n{\n}\n"}, None),
            ({"room_priv.h": "int mt_f(void);\n", "c.c": "int mt_f(void)\n{\n    return 1;\n}\n"}, None),
            ({"a.h": "static inline int mt_f(void)\n{\n    return 1;\n}\n"}, None),
            ({"a.h": "int mt_f(int x);\n", "b.c": "int mt_f(int x)\n{\n    return x;\n}\n"}, "defined in b.c"),
            ({"a.h": "int mt_f(int x);\n", "ab.c": "int mt_f(int x)\n{\n    return x;\n}\n"}, "defined in ab.c"),
            ({"a.h": "int mt_f(int x);\n", "a.c": "int mt_g(void)\n{\n    return mt_f(1);\n}\n"}, "defined nowhere"),
            ({"a.h": "int mt_f(void)\n{\n    return 1;\n}\n"}, "body in a header")):
        with tempfile.TemporaryDirectory() as folder:
            for name, text in files.items():
                path = Path(folder, "src", "room", name)
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text, encoding="utf-8")
            found = check(Path(folder), ["room"])[1]
            if len(found) != (expected is not None) or (expected and expected not in found[0]):
                problems.append(f"self-test: {files} gave {found}")
    return problems


if __name__ == "__main__":
    number, faults = check(ROOT, ROOMS_HELD)
    verdict("homes", number, faults + self_test())

# SPDX-License-Identifier: GPL-3.0-or-later
"""
Every header compiles alone and included twice: public ones as C11 and C++17, all as C11. The first inclusion of a source is
compiled alone by every build; headers with no such source are compiled alone here, the others twice with all of their room.
"""
import itertools
import os
import re
import shlex
import subprocess
import tempfile
from pathlib import Path

from common import ROOT, c_files, verdict

WARNINGS = ["-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wundef", "-Werror", "-fsyntax-only"]
C11 = [os.environ.get("CC", "cc"), "-x", "c", "-std=c11", "-Wstrict-prototypes"]
PACKAGES = ["openblas", "lapacke", "nlopt", "gsl", "libcjson"]
CXX17 = ["g++", "-x", "c++", "-std=c++17", "-Wold-style-cast"]


FIRST = re.compile(r'^[ \t]*#.*$', re.M)


def compiles(command, folders, *headers):
    """None, or what the compiler says about two inclusions of each header and nothing else."""
    text = "".join(f'#include "{header}"\n' * 2 for header in headers) + "int mt_only_a_header;\n"
    run = subprocess.run([*command, *WARNINGS, *folders, "-"], input=text, text=True, capture_output=True)
    return None if run.returncode == 0 else run.stderr


def compiled_first(folder):
    """Headers that the first directive of a source includes."""
    directives = (FIRST.search(path.read_text(encoding="utf-8")) for path in folder.rglob("*.c"))
    return {match[0].split('"')[1] for match in directives if match and match[0].count('"') == 2}


def check(root):
    public, internal = c_files(root / "include"), [p for p in c_files(root / "src") if p.suffix == ".h"]
    third = shlex.split(subprocess.run(["pkg-config", "--cflags", *PACKAGES], check=True,
                                       capture_output=True, text=True).stdout)
    folders = ["-D_POSIX_C_SOURCE=200809L", f"-I{root / 'include'}", f"-I{root / 'src'}", *third]
    problems = []
    for path in public:
        name = str(path.relative_to(root / "include"))
        for command in (C11, CXX17):
            said = compiles(command, [f"-I{root / 'include'}"], name)
            problems += [f"{name} as {command[3]}:\n{said}"] if said else []
    first = compiled_first(root / "src")
    alone = [str(path.relative_to(root / "src")) for path in internal]
    for _, room in itertools.groupby([name for name in alone if name in first], lambda name: name.split("/")[0]):
        together = list(room)
        if compiles(C11, folders, *together) is None:
            alone = [name for name in alone if name not in together]  # else: whose fault is it, or do two not go together?
    for name in alone:
        said = compiles(C11, folders, name)
        problems += [f"{name} as C11:\n{said}"] if said else []
    return len(public), problems


def self_test():
    """A missing include, a missing guard and a C++ keyword are found; a missing guard also of what a source includes first."""
    planted = ["size_t mt_f(void);\n", "struct mt_s { int a; };\n",
               "#ifndef X\n#define X\nint mt_f(int new);\n#endif\n"]
    problems = []
    for text, place in (*((text, "include/x.h") for text in planted), (planted[0], "src/a/x.h"), (planted[1], "src/a/x.h"), (planted[1], "src/a/y.h")):
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "include").mkdir()
            Path(folder, "src/a").mkdir(parents=True)
            Path(folder, place).write_text(text)
            Path(folder, "src/a/y.c").write_text('#include "a/y.h"\n')
            if not check(Path(folder))[1]:
                problems.append(f"self-test: {text!r} in {place} compiled")
    return problems


if __name__ == "__main__":
    count, faults = check(ROOT)
    verdict("headers", count, faults + self_test())

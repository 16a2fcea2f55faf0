# SPDX-License-Identifier: GPL-3.0-or-later
"""Every header compiles alone and included twice: public ones as C11 and C++17, all as C11."""
import os
import shlex
import subprocess
import tempfile
from pathlib import Path

from common import ROOT, c_files, verdict

WARNINGS = ["-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wundef", "-Werror", "-fsyntax-only"]
C11 = [os.environ.get("CC", "cc"), "-x", "c", "-std=c11", "-Wstrict-prototypes"]
PACKAGES = ["openblas", "lapacke", "nlopt", "gsl", "libcjson"]
CXX17 = ["g++", "-x", "c++", "-std=c++17", "-Wold-style-cast"]


def compiles(command, folders, header):
    """None, or what the compiler says about two inclusions of the header and nothing else."""
    text = f'#include "{header}"\n#include "{header}"\nint mt_only_a_header;\n'
    run = subprocess.run([*command, *WARNINGS, *folders, "-"], input=text, text=True, capture_output=True)
    return None if run.returncode == 0 else run.stderr


def check(root):
    public, internal = c_files(root / "include"), [p for p in c_files(root / "src") if p.suffix == ".h"]
    third = shlex.split(subprocess.run(["pkg-config", "--cflags", *PACKAGES], check=True,
                                       capture_output=True, text=True).stdout)
    problems = []
    for path in public:
        name = str(path.relative_to(root / "include"))
        for command in (C11, CXX17):
            said = compiles(command, [f"-I{root / 'include'}"], name)
            problems += [f"{name} as {command[3]}:\n{said}"] if said else []
    for path in internal:
        name = str(path.relative_to(root / "src"))
        said = compiles(C11, ["-D_POSIX_C_SOURCE=200809L", f"-I{root / 'include'}", f"-I{root / 'src'}", *third], name)
        problems += [f"{name} as C11:\n{said}"] if said else []
    return len(public), problems


def self_test():
    """A missing include, a missing guard and a C++ keyword are found."""
    planted = ["size_t mt_f(void);\n", "struct mt_s { int a; };\n",
               "#ifndef X\n#define X\nint mt_f(int new);\n#endif\n"]
    problems = []
    for text in planted:
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "include").mkdir()
            Path(folder, "src").mkdir()
            Path(folder, "include", "x.h").write_text(text)
            if not check(Path(folder))[1]:
                problems.append(f"self-test: {text!r} compiled")
    return problems


if __name__ == "__main__":
    count, faults = check(ROOT)
    verdict("headers", count, faults + self_test())

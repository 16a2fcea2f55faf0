# SPDX-License-Identifier: GPL-3.0-or-later
"""The top level holds the agreed names, tests follow the rooms, files are short, C files name their licence."""
import subprocess

from common import ROOMS, ROOT, c_files, page_files, verdict

AGREED = {".ci", ".clang-format", ".clang-tidy", ".editorconfig", ".gitignore", "CHANGELOG.md", "CMakeLists.txt",
          "CMakePresets.json", "CONTRIBUTING.md", "LICENSE", "README.md", "bootstrap", "include", "problems",
          "schemas", "src", "studies", "tests"}
# Folders of tests besides those of the rooms: what judges the whole program, or the tree itself.
BESIDES = {"bench", "browser", "documents", "fuzz", "hunt", "install", "mechanisms", "models", "mutants", "planted", "races", "reference", "schema", "stress", "structure",
           "support"}
IGNORED = {".git", "build", "results"}
MAX_LINES = 1500
LICENCE = "/* SPDX-License-Identifier: GPL-3.0-or-later */"
LICENCE_JS = "// SPDX-License-Identifier: GPL-3.0-or-later"


def top_level():
    """Names that belong to the project: what git tracks, or all that is there in an unpacked archive."""
    if (ROOT / ".git").exists():
        run = subprocess.run(["git", "-C", ROOT, "-c", "safe.directory=*", "ls-files", "-z"],
                             capture_output=True, text=True)
        if run.returncode == 0:
            return {name.partition("/")[0] for name in run.stdout.split("\0") if name}
    return {path.name for path in ROOT.iterdir()} - IGNORED


def tree_problems(names):
    return [f"{name}: not an agreed name of the top level" for name in sorted(names - AGREED)]


def folder_problems(names):
    return [f"tests/{name}: neither a room of src nor an agreed folder" for name in sorted(names - BESIDES - set(ROOMS))]


def file_problems(name, text):
    lines = text.split("\n")
    if len(lines) >= MAX_LINES:
        yield f"{name}: {len(lines)} lines, {MAX_LINES} or more"
    if lines[0] != (LICENCE_JS if str(name).endswith(".js") else LICENCE):
        yield f"{name}: first line is not the SPDX line"


def self_test():
    problems = []
    if not tree_problems({"README.md", "scratch.txt"}):
        problems.append("self-test: a stray name was accepted")
    if not folder_problems({"linalg", "kitchen"}):
        problems.append("self-test: tests of a room that is not there were accepted")
    for text in (LICENCE + "\n" * MAX_LINES, "int x;\n"):
        if not list(file_problems("x.c", text)):
            problems.append("self-test: a bad file was accepted")
    if list(file_problems("x.c", LICENCE + "\nint x;\n")):
        problems.append("self-test: a good file was refused")
    return problems


if __name__ == "__main__":
    files = c_files(ROOT / "src", ROOT / "include", ROOT / "tests") + page_files()
    faults = tree_problems(top_level())
    faults += folder_problems({path.relative_to(ROOT / "tests").parts[0] for path in (ROOT / "tests").glob("*/*") if path.is_file()})
    for path in files:
        faults += file_problems(path.relative_to(ROOT), path.read_text(encoding="utf-8"))
    verdict("tree", len(files), faults + self_test())

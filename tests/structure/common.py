# SPDX-License-Identifier: GPL-3.0-or-later
"""What the structure tests share: the tree, C text without comments, and a verdict."""
import os
import re
import sys
from pathlib import Path

ROOT = Path(os.environ.get("SOURCE_DIR", Path(__file__).resolve().parents[2]))
ROOMS = ("base", "linalg", "expr", "io", "model", "environment", "measurement", "mechanics", "tree", "modal", "analysis", "response", "nlp",
         "study", "vibration", "result", "prove", "scene", "simulate", "problem", "search", "describe", "answer", "inspect", "library", "report", "cli")

_TOKENS = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'', re.S)


def c_files(*folders):
    """All .c and .h files below the folders, in a fixed order."""
    return sorted(p for folder in folders for p in Path(folder).rglob("*.[ch]"))


def page_files():
    """The scripts and styles of pages, in a fixed order."""
    return sorted(p for kind in ("js", "css") for p in (ROOT / "src").rglob("*." + kind))


def code_only(text):
    """The text with comments and the inside of literals blanked; line numbers stay."""
    def blank(match):
        token = match.group()
        if token[0] in "\"'":
            return token[0] * 2
        return " " + "\n" * token.count("\n")
    return _TOKENS.sub(blank, text)


def without_comments(text):
    """The text with comments blanked, literals as they are; line numbers stay."""
    return _TOKENS.sub(lambda m: m.group() if m.group()[0] in "\"'" else " " + "\n" * m.group().count("\n"), text)


def verdict(what, files, problems):
    """Exit 1 with every problem, or when there was nothing to look at."""
    for problem in problems:
        print(problem)
    if files == 0:
        print(f"{what}: no file found, nothing was checked")
    print(f"{what}: {files} files, {len(problems)} problems")
    sys.exit(1 if problems or files == 0 else 0)

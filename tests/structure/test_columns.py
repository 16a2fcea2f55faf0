# SPDX-License-Identifier: GPL-3.0-or-later
"""Code and comments of C files, and pages, keep to the same columns, and no declaration is broken across lines to make room for its comment."""
import re

from common import ROOT, c_files, page_files, code_only, verdict, without_comments

COLUMNS = 96  # as .clang-format has it, which leaves comments alone
UNBREAKABLE = re.compile(r"NOLINT|https?://")  # what means something else on two lines
TRAILING = re.compile(r"\S\s*/\*.*\*/\s*$")


def long_lines(name, text):
    for number, line in enumerate(text.split("\n"), 1):
        if len(line) > COLUMNS and not UNBREAKABLE.search(line):
            yield f"{name}:{number}: {len(line)} columns"


def statements(text):
    """(line, lines, the same without comments) of what ends in a semicolon and has no braces."""
    code = []
    for number, (shape, part, raw) in enumerate(zip(code_only(text).split("\n"), without_comments(text).split("\n"), text.split("\n")), 1):
        bare = shape.strip()
        if not bare or bare[0] == "#" or bare[-1] in ":\\" or "{" in bare or "}" in bare:
            code = []
            continue
        code.append((raw, part.rstrip()))
        if bare[-1] == ";":
            yield number + 1 - len(code), [raw for raw, _ in code], [part for _, part in code]
            code = []


def broken_for_comment(name, text):
    """A statement of several lines, one of which ends in a comment, that fits in one line without it."""
    for number, lines, parts in statements(text):
        joined = parts[0] + "".join(("" if before.endswith(("(", "*")) else " ") + part.strip()
                                   for before, part in zip(parts, parts[1:]))
        if len(lines) > 1 and len(joined) <= COLUMNS and any(TRAILING.search(line) for line in lines):
            yield f"{name}:{number}: broken across {len(lines)} lines to make room for a comment: {joined.strip()}"


def self_test():
    bad_lines = ["/* " + "x" * COLUMNS + " */", "int x; /* " + "word " * 20 + "*/"]
    good_lines = ["x" * COLUMNS, "/* https://example.org/" + "x" * COLUMNS + " */"]
    bad = ["struct s {\n    const double\n        *factors; /* one for each */\n};\n",
           "    double *const\n        values; /* in hertz */\n",
           "    mt_result *result =\n        given; /* the caller's */\n",
           "int f(int a, /* first */\n      int b);\n"]
    good = ["    int a; /* first */\n    int b; /* second */\n",
            "    double *const\n        values;\n",
            "    call(" + "a" * 40 + ",\n         " + "b" * 50 + "); /* both */\n",
            "    if (a) { /* so */\n        b();\n    }\n",
            "enum e {\n    A, /* first */\n    B, /* second */\n};\n"]
    problems = [f"self-test: {text!r} passed" for text in bad_lines if not list(long_lines("x.c", text))]
    problems += [f"self-test: {text!r} was refused" for text in good_lines if list(long_lines("x.c", text))]
    problems += [f"self-test: {text!r} passed" for text in bad if not list(broken_for_comment("x.c", text))]
    problems += [f"self-test: {text!r} was refused" for text in good if list(broken_for_comment("x.c", text))]
    return problems


if __name__ == "__main__":
    files = c_files(ROOT / "src", ROOT / "include", ROOT / "tests")
    faults = []
    for path in files:
        source, where = path.read_text(encoding="utf-8"), path.relative_to(ROOT)
        faults += [*long_lines(where, source), *broken_for_comment(where, source)]
    pages = page_files()
    for path in pages:
        faults += long_lines(path.relative_to(ROOT), path.read_text(encoding="utf-8"))
    verdict("columns", len(files) + len(pages), faults + self_test())

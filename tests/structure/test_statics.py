# SPDX-License-Identifier: GPL-3.0-or-later
"""A name of static functions says what is found, added or begun: one that stands in four files of src says nothing in any of them."""
import re

from common import ROOT, c_files, code_only, verdict

MOST = 3
IDIOMS = {"is_digit"}  # the same, and as short, wherever it stands
DEFINED = re.compile(r"^static (?:inline )?(?:[A-Za-z_]\w*[\s*]+)+?([A-Za-z_]\w*)\s*\([^;{]*?\)\s*\{", re.M)


def names_of(text):
    return set(DEFINED.findall(code_only(text)))


def problems_of(where):
    return [f"{name} is a static function of {len(files)} files: {' '.join(files)}"
            for name, files in sorted(where.items()) if len(files) > MOST and name not in IDIOMS]


def self_test():
    problems = []
    if names_of("static mt_status look(int a,\n                      double *b)\n{\n}\nstatic int x;\nint put(void)\n{\n}\n") != {"look"}:
        problems.append("self-test: a static function was not found, or what is none")
    if len(problems_of({"look": ["a", "b", "c", "d"], "put": ["a", "b", "c"]})) != 1:
        problems.append("self-test: four files are not told from three")
    return problems


def main():
    where = {}
    files = [path for path in c_files(ROOT / "src") if path.suffix == ".c"]
    for path in files:
        for name in names_of(path.read_text(encoding="utf-8")):
            where.setdefault(name, []).append(str(path.relative_to(ROOT)))
    assert len(where) > 2000
    verdict("statics", len(files), problems_of(where) + self_test())


if __name__ == "__main__":
    main()

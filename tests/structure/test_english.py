# SPDX-License-Identifier: GPL-3.0-or-later
"""
Every string that can reach a user, in the field's words. Strings are read from the sources (literals of C and of the pages' scripts, joined
where they stand side by side), from descriptions of the schemas and from the documents' prose; those of fewer than three words are names.
    test_english.py --list     all of them, a line each with its place (also: cmake --build build/release --target strings)
"""
import json
import re
import sys

from common import ROOT, verdict

# What nobody says, and what is said instead.
WORDS = {
    r"gap assignments?": "mode placement", r"kinds? of design": "mode placement", r"size of the redesign": "total change", r"ha(?:s|ve) a price": "relaxing ... would reduce",
    r"giving way by": "relaxing ... by", r"nothing is told": "(say what follows)", r"in their order": "(name each)", r"hardly meant": "suspicious", r"anew": "again",
    r"likewise": "(say it)", r"falls? over": "is unstable", r"rotor diagram": "Campbell diagram", r"1/min": "rpm", r"as drawn": "reference position", r"\boff by \[": "deviation",
    r"(?<![Tt]here )\bis no (?!longer\b|more\b|less\b)": "is not a", r"stationary response": "steady response", r"no certificate": "not proven, because ...",
    r"that are given alone": "named", r"to speak of": "almost no ...", r"hides whether it holds": "hides whether it is stable",
    r"Else:": "Alternatives:", r"nothing else changed": "and nothing else", r"per cent less would save": "relaxing by ... would reduce",
}
# Strings of another kind: words of a format that is read, places of drawings on pages whose names the files keep, quotations.
LEFT = {
    "src/measurement/read_uff.c": {"1/min"},          # labels of universal files
    "src/report/page": {"as drawn"},                     # the position of a drive that the page shows
    "src/cli/cmd_info.c": {"as drawn"}, "src/model": {"as drawn"}, "src/mechanics": {"as drawn"}, "src/answer": {"as drawn"}, "schemas": {"as drawn"},
    "problems/README.md": {"as drawn"}, "src/cli/README.md": {"as drawn", "anew"}, "studies/tutorial/README.md": {"as drawn", "anew"},
}
LONGEST = 420  # characters of a string that is printed in one piece; help texts and sentences of schemas have paragraphs
LITERAL = re.compile(r'"(?:\\.|[^"\\\n])*"(?:\s*"(?:\\.|[^"\\\n])*")*')
COMMENT = re.compile(r"/\*.*?\*/|^\s*#include[^\n]*$", re.S | re.M)
SCRIPT = re.compile(r"""\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])*'|`(?:\\.|[^`\\])*`""")


def literals(path, pattern):
    text = path.read_text(encoding="utf-8")
    blank = COMMENT.sub(lambda m: re.sub(r"[^\n]", " ", m[0]), text)
    for match in pattern.finditer(blank):
        parts = re.findall(r'"((?:\\.|[^"\\\n])*)"', match[0]) if pattern is LITERAL else [match[0][1:-1]]
        yield blank.count("\n", 0, match.start()) + 1, "".join(parts).replace('\\"', '"')


def descriptions(node):
    if isinstance(node, dict):
        if isinstance(node.get("description"), str):
            yield node["description"]
        for key, value in node.items():
            if key != "examples":
                yield from descriptions(value)
    elif isinstance(node, list):
        for value in node:
            yield from descriptions(value)


def prose(text):
    """Paragraphs of a page without its blocks and what stands in backquotes."""
    bare = re.sub(r"^```.*?^```$", lambda m: "\n" * m[0].count("\n"), text, flags=re.S | re.M)
    line = 1
    for paragraph in re.split(r"(\n\n+)", bare):
        if paragraph.strip():
            yield line, re.sub(r"`[^`\n]*`", "x", paragraph)
        line += paragraph.count("\n")


def strings():
    """(place, text) of all that may be read."""
    for path in sorted((ROOT / "src").rglob("*.c")):
        yield from ((f"{path.relative_to(ROOT)}:{line}", text) for line, text in literals(path, LITERAL))
    for path in sorted((ROOT / "src").rglob("*.js")):
        yield from ((f"{path.relative_to(ROOT)}:{line}", text) for line, text in literals(path, SCRIPT))
    for path, schema in schemas():
        yield from ((str(path.relative_to(ROOT)), text) for text in descriptions(schema))
    for path in [ROOT / "README.md", *sorted(p for folder in ("problems", "studies", "include", "src") for p in (ROOT / folder).rglob("README.md"))]:
        yield from ((f"{path.relative_to(ROOT)}:{line}", text) for line, text in prose(path.read_text(encoding="utf-8")))


def schemas():
    """The schemas, parsed, with their paths."""
    return [(path, json.loads(path.read_text(encoding="utf-8"))) for path in sorted((ROOT / "schemas").glob("*.schema.json"))]


SENTENCES = {text for _, schema in schemas() for text in descriptions(schema)}  # tables of readers have them


def faults(place, text):
    left = {word for start, words in LEFT.items() if place.startswith(start) for word in words}
    for pattern, better in WORDS.items():
        found = re.search(rf"(?<![\w_]){pattern}", text)
        if found and found[0] not in left:
            yield f"{place}: \"{found[0]}\": write {better}"
    if place.startswith("src/") and ".md" not in place and "\\n" not in text and len(text) > LONGEST and not place.startswith("src/cli/") and text not in SENTENCES:
        yield f"{place}: {len(text)} characters in one piece"


def questions(place, text):
    """Comments of C that end with a question mark: a comment states what is so, or when."""
    for match in re.finditer(r"/\*(.*?)\*/", text, re.S):
        said = re.sub(r"\n\s*\*", "\n", match[1]).rstrip()
        if said.endswith("?"):
            yield f"{place}:{text.count(chr(10), 0, match.end()) + 1}: a comment asks: {' '.join(said.split())[-60:]}"


def self_test():
    if not list(questions("x.h", "/* Is it\n * there? */")) or list(questions("x.h", '/* True where "?" is there. */')):
        return ["self-test: questions are not told from statements"]
    bad = ["Of 3 gap assignments", "it falls over", "is done anew", "x" * (LONGEST + 1)]
    return [f"self-test: {text[:40]!r} passed" for text in bad if not list(faults("src/x/y.c:1", text))]


if __name__ == "__main__":
    found = [(place, text) for place, text in strings() if len(re.findall(r"[A-Za-z]{2,}", text)) >= 3]
    if "--list" in sys.argv:
        for where, what in found:
            print(f"{where}: {' '.join(what.split())}")
        sys.exit(0)
    wrong = [fault for where, what in found for fault in faults(where, what)]
    for file in sorted([*(ROOT / "src").rglob("*.[ch]"), *(ROOT / "include").rglob("*.h")]):
        wrong += questions(file.relative_to(ROOT), file.read_text(encoding="utf-8"))
    verdict("english", len(found), wrong + self_test() + ([] if len(found) > 1500 else [f"only {len(found)} strings were found"]))

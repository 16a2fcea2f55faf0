# SPDX-License-Identifier: GPL-3.0-or-later
"""
The documents tell the truth. Each page is walked in a copy of problems/, studies/ and schemas/ (common_document.py):
- its blocks do what they show, and the files that they write pass `modetune check`;
- its links lead to files and headings that exist;
- problems/README.md names every member and every word of the schemas of models and profiles, with studies/README.md those of studies;
- tables of measurements are headed by columns of the files that the text above them names (their values are of another day);
- the first page is short, and the paths in its map exist.
MT_README_UPDATE=1 writes the present output into the pages instead: read the difference before you commit it.
"""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from common_document import Walk, edited, links_to_nowhere, merged, only, replaced, same_line, same_picture, same_token

TREE = Path(os.environ["SOURCE_DIR"])
PROGRAM = Path(os.environ["MODETUNE"])
sys.path.append(str(TREE / "tests/bench"))
from _tables import COLUMNS  # noqa: E402: where it is, is known now

# Pages and how many commands and blocks of JSON each runs at least.
PAGES = {"README.md": (1, 1), "problems/README.md": (4, 15), "studies/README.md": (5, 20), "tests/reference/README.md": (8, 0)}
LINKED = [*PAGES, "studies/tutorial/README.md", "include/README.md", "src/library/python/README.md", "tests/bench/README.md", "CONTRIBUTING.md", "src/README.md", "tests/README.md"]
FIRST_PAGE = 220  # lines
# A file that is named, or the head of a table.
HEADS = re.compile(r"^\| (.*) \|\n\|(?: -+ \|)+$", re.M)
DRAWN = {"inceptor": "installed", "stick": "installed", "beam_lumped": "pinned_free", "beam_reference": "pinned_free"}  # else the first
COMMON = {"$schema", "description", "source", "origin"}  # members of everything


def wrong_columns(text):
    wrong = []
    for head in HEADS.finditer(text):
        name = re.findall(r"`(\w+)\.csv`", text[:head.start()])[-1]
        wrong += [f"{name}.csv has no column {c}" for c in head[1].split(" | ") if c.strip("`") not in COLUMNS.get(name, ())]
    return wrong


def words_of(schema):
    """Names of members and words of enumerations, but for units, which have a page of their own."""
    words = set()
    if isinstance(schema, dict):
        for name, member in schema.get("properties", {}).items():
            words.add(name)
            words |= words_of(member) if name not in ("unit", "x_unit", "y_unit") else set()
        words |= {w for w in schema.get("enum", []) if isinstance(w, str)}
        for key in ("items", "oneOf", "anyOf", "allOf", "additionalProperties"):
            words |= words_of(schema.get(key))
        for definition in schema.get("definitions", {}).values():
            words |= words_of(definition)
    elif isinstance(schema, list):
        for part in schema:
            words |= words_of(part)
    return words


def unexplained(text, name):
    """Words of a schema that a page has neither in backquotes nor as strings of its JSON."""
    schema = json.loads((TREE / f"schemas/{name}.schema.json").read_text(encoding="utf-8"))
    said = set(re.findall(r"[\w./$^-]+", " ".join(re.findall(r"`([^`\n]+)`", text))))
    said |= set(re.findall(r'"([^"\n]*)"', text))
    return sorted(words_of(schema) - COMMON - said)


class Documents(unittest.TestCase):
    def walk(self, page):
        folder = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, folder, ignore_errors=True)
        for part in ("problems", "studies", "schemas"):
            shutil.copytree(TREE / part, folder / part)
        walk = Walk((TREE / page).read_text(encoding="utf-8"), folder, PROGRAM)
        if os.environ.get("MT_README_UPDATE"):
            (TREE / page).write_text(walk.now, encoding="utf-8")
            return
        if walk.files:
            walk.run("modetune check " + " ".join(str(path.relative_to(folder)) for path in walk.files))
        self.assertEqual(walk.wrong, [], "\n".join(walk.wrong))
        commands, parts = PAGES[page]
        self.assertGreaterEqual(walk.commands, commands)
        self.assertGreaterEqual(walk.parts, parts)

    def test_the_first_page(self):
        self.walk("README.md")

    def test_modelling(self):
        self.walk("problems/README.md")

    def test_asking(self):
        self.walk("studies/README.md")

    def test_published_against_computed(self):
        self.walk("tests/reference/README.md")

    def test_the_gallery_shows_every_model(self):
        text = (TREE / "problems/README.md").read_text(encoding="utf-8")
        models = [path for path in sorted((TREE / "problems").glob("*.json")) if "modetune-model/" in path.read_text(encoding="utf-8")]
        self.assertEqual({path.stem for path in (TREE / "problems/pictures").glob("*.svg")}, {path.stem for path in models})
        self.assertGreaterEqual(len(models), 10)
        for path in models:
            self.assertIn(f'"pictures/{path.stem}.svg"', text)
            first = next(iter(json.loads(path.read_text(encoding="utf-8")).get("configurations", {})), "default")
            done = subprocess.run([PROGRAM, "show", path, "--svg", "-c", DRAWN.get(path.stem, first)], capture_output=True, text=True, check=True)
            picture = TREE / f"problems/pictures/{path.stem}.svg"
            if os.environ.get("MT_README_UPDATE"):
                picture.write_text(done.stdout, encoding="utf-8")
            self.assertTrue(same_picture(picture.read_text(encoding="utf-8"), done.stdout), path.name)

    def test_links_lead_somewhere(self):
        for page in LINKED:
            self.assertEqual(links_to_nowhere((TREE / page).read_text(encoding="utf-8"), (TREE / page).parent), [], page)

    def test_every_member_is_explained(self):
        modelling, asking = ((TREE / f"{page}/README.md").read_text(encoding="utf-8") for page in ("problems", "studies"))
        for text, schema in ((modelling, "model"), (modelling, "profile"), (asking + modelling, "study")):
            self.assertEqual(unexplained(text, schema), [], schema)

    def test_the_first_page_is_short_and_its_map_is_of_this_tree(self):
        text = (TREE / "README.md").read_text(encoding="utf-8")
        self.assertLessEqual(text.count("\n"), FIRST_PAGE)
        table = text[text.index("## What is where"):]
        paths = [p for row in re.findall(r"^\| (`.*?) \|", table, re.M) for p in re.findall(r"`([^`]+)`", row)]
        self.assertGreaterEqual(len(paths), 8)
        for path in paths:
            self.assertTrue((TREE / path).exists(), path)

    def test_measurements_have_columns_of_their_files(self):
        text = (TREE / "tests/bench/README.md").read_text(encoding="utf-8")
        self.assertEqual(wrong_columns(text), [])
        self.assertEqual(set(re.findall(r"`(\w+)\.csv`", text)), set(COLUMNS))
        self.assertGreaterEqual(len(HEADS.findall(text)), 4)
        for name, column in (("beam", "`seconds`"), ("gone", "`cpu_s`")):
            self.assertEqual(len(wrong_columns(f"see `{name}.csv`:\n\n| `way` | {column} |\n| --- | --- |\n")), 1 if name == "beam" else 2)

    def test_a_difference_is_noticed(self):
        for want, got, same in (("16.2892", "16.2893", True), ("16.2892", "16.2895", False), ("1.62e-12", "4e-13", True),
                                ("0", "1.8e-12", True), ("+0.00424", "+0.00426", True), ("+0.00424", "-0.00424", False),
                                ("----", "---", True), ("-", "0", False), ("solved", "Solved", False), ("(1.7039", "(1.7039", True),
                                ("-1.8e-12", "+0", True), ("2e-3", "9e-3", False)):
            self.assertEqual(same_token(want, got), same, (want, got))
        self.assertFalse(same_line("a 1", "a 1 b"))
        self.assertEqual(merged({"a": [1], "b": {"c": 2}}, {"a": [3], "b": {"d": 4}, "e": 5}), {"a": [1, 3], "b": {"c": 2, "d": 4}, "e": 5})
        self.assertEqual(replaced({"a": [1], "b": 2, "c": 3}, {"a": [3], "b": None}), {"a": [3], "c": 3})
        self.assertIsNone(edited("a\nb\na\n", "-c\n+d\n"))
        self.assertEqual(only("A\n 1\n\nB\n", ["^A"]), "A\n 1\n\n...\n")
        self.assertIn("no_such_member", words_of({"properties": {"no_such_member": {}}}))
        page = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, page)
        (page / "a.md").write_text("# A title, of `x`\n", encoding="utf-8")
        self.assertEqual(links_to_nowhere("[a](a.md) [b](a.md#a-title-of-x) [c](b.md) [d](a.md#b) [e](#here)\n# Here\n", page), ["b.md", "a.md#b"])


if __name__ == "__main__":
    sys.exit(unittest.main())

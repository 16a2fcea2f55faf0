# SPDX-License-Identifier: GPL-3.0-or-later
"""
The README tells the truth. In a copy of problems/ and studies/:
- its blocks do what they show (common_document.py), and the files that they write pass `modetune check`;
- every path in the table "What is where" exists;
- tables of measurements are headed by columns of the files that the text above them names (their values are of another day).
MT_README_UPDATE=1 writes the present output into the README instead: read the difference before you commit it.
"""
import os
import re
import shutil
import sys
import tempfile
import unittest
from pathlib import Path

from common_document import Walk, links_to_nowhere, same_line, same_token

TREE = Path(os.environ["SOURCE_DIR"])
PROGRAM = Path(os.environ["MODETUNE"])
README = TREE / "README.md"
sys.path.append(str(TREE / "tests/bench"))
from _tables import COLUMNS  # noqa: E402: where it is, is known now

# A file that is named, or the head of a table.
HEADS = re.compile(r"^\| (.*) \|\n\|(?: -+ \|)+$", re.M)


def wrong_columns(text):
    wrong = []
    for head in HEADS.finditer(text):
        name = re.findall(r"`(\w+)\.csv`", text[:head.start()])[-1]
        wrong += [f"{name}.csv has no column {c}" for c in head[1].split(" | ") if c.strip("`") not in COLUMNS.get(name, ())]
    return wrong


class Readme(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        for part in ("problems", "studies", "schemas"):
            shutil.copytree(TREE / part, self.folder / part)
        self.text = README.read_text(encoding="utf-8")

    def test_commands_print_what_the_readme_shows(self):
        walk = Walk(self.text, self.folder, PROGRAM)
        if os.environ.get("MT_README_UPDATE"):
            README.write_text(walk.now, encoding="utf-8")
            return
        walk.run("modetune check " + " ".join(str(path.relative_to(self.folder)) for path in walk.files))
        self.assertEqual(walk.wrong, [], "\n".join(walk.wrong))
        self.assertGreaterEqual(walk.commands, 5)
        self.assertGreaterEqual(len(walk.files), 2)

    def test_the_map_is_of_this_tree(self):
        table = self.text[self.text.index("## What is where"):]
        paths = [p for row in re.findall(r"^\| (`.*?) \|", table, re.M) for p in re.findall(r"`([^`]+)`", row)]
        self.assertGreaterEqual(len(paths), 8)
        for path in paths:
            self.assertTrue((TREE / path).exists(), path)
        self.assertEqual(links_to_nowhere(self.text, TREE), [])

    def test_measurements_have_columns_of_their_files(self):
        text = self.text[self.text.index("## How fast, how exact"):]
        text = text[:text.index("\n## ", 1)]
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


if __name__ == "__main__":
    sys.exit(unittest.main())

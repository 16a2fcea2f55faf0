# SPDX-License-Identifier: GPL-3.0-or-later
"""
The tutorial works: in an empty folder, from top to bottom, each block does what it shows (common_document.py). Besides,
- what it leaves in the folder is valid by the schemas and passes `modetune check`;
- the picture beside it is the one that its commands draw;
- a number in its prose, with a decimal point or a unit, is one of a block of the same section or the one before, rounded;
- its links lead somewhere, and its list of contents names its sections.
MT_README_UPDATE=1 writes the present output and picture instead: read the difference before you commit it.
"""
import json
import os
import re
import shutil
import sys
import tempfile
import unittest
from pathlib import Path

import jsonschema
from common_document import BLOCK, Walk, anchor, edited, links_to_nowhere, only, same_line, same_picture

TREE = Path(os.environ["SOURCE_DIR"])
PROGRAM = Path(os.environ["MODETUNE"])
PAGE = TREE / "studies/tutorial/README.md"
PICTURE = "pedal.svg"
NUMBERS = re.compile(r"(?<![\w./#-])(-?\d+\.\d+|-?\d+(?= (?:%|(?:Hz|kg|m|N m/rad|N/m|rad)\b)))(?![\w.]*\d)")


def sections(text):
    """Heading, prose and what its blocks hold, with those of the section before, of each section."""
    before = ""
    for part in re.split(r"^(?=## )", text, flags=re.M)[1:]:
        blocks = "".join(match["body"] for match in BLOCK.finditer(part))
        prose = re.sub(r"<!--.*?-->|`[^`\n]*`", "", BLOCK.sub("", part).split("\n", 1)[1])
        yield part.split("\n")[0], prose, before + blocks
        before = blocks


def unheard_of(prose, blocks):
    """Numbers of the prose that no number of the blocks is, rounded to their digits."""
    known = [float(n) for n in re.findall(r"(?<![\w.])[+-]?\d+\.?\d*(?:e[+-]?\d+)?", blocks)]
    wrong = []
    for said in NUMBERS.findall(prose):
        unit = 10.0 ** -len(said.partition(".")[2])
        if not any(abs(abs(x) - abs(float(said))) <= 0.500001 * unit for x in known):
            wrong.append(said)
    return wrong


class Tutorial(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.text = PAGE.read_text(encoding="utf-8")

    def test_it_works_from_an_empty_folder(self):
        folder = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, folder, ignore_errors=True)
        walk = Walk(self.text, folder, PROGRAM, talk=True)
        place = Path(walk.place)
        picture = (place / PICTURE).read_text(encoding="utf-8")
        if os.environ.get("MT_README_UPDATE"):
            PAGE.write_text(walk.now, encoding="utf-8")
            (PAGE.parent / PICTURE).write_text(picture, encoding="utf-8")
            return
        self.assertTrue(same_picture((PAGE.parent / PICTURE).read_text(encoding="utf-8"), picture))
        walk.run("modetune check *.json")
        self.assertEqual(walk.wrong, [], "\n".join(walk.wrong))
        self.assertGreaterEqual(walk.commands, 20)
        files = [path for path in place.glob("*.json") if path.name != "model.json"]
        self.assertGreaterEqual(len(files), 5)
        for path in files:
            document = json.loads(path.read_text(encoding="utf-8"))
            schema = json.loads((place / document["$schema"]).read_text(encoding="utf-8"))
            self.assertEqual([e.message for e in jsonschema.Draft7Validator(schema).iter_errors(document)], [], path.name)

    def test_the_second_one_works_too(self):
        folder = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, folder, ignore_errors=True)
        page = PAGE.parent / "space/README.md"
        walk = Walk(page.read_text(encoding="utf-8"), folder, PROGRAM, talk=True)
        if os.environ.get("MT_README_UPDATE"):
            page.write_text(walk.now, encoding="utf-8")
            return
        self.assertEqual(walk.wrong, [], "\n".join(walk.wrong))
        self.assertGreaterEqual(walk.commands, 8)
        self.assertEqual(links_to_nowhere(page.read_text(encoding="utf-8"), page.parent), [])

    def test_its_prose_says_what_its_blocks_show(self):
        for heading, prose, blocks in sections(self.text):
            self.assertEqual(unheard_of(prose, blocks), [], heading)
        self.assertGreaterEqual(sum(len(NUMBERS.findall(prose)) for _, prose, _ in sections(self.text)), 20)

    def test_its_links_lead_somewhere(self):
        self.assertEqual(links_to_nowhere(self.text, PAGE.parent), [])
        headings = [heading for heading, _, _ in sections(self.text)]
        contents = re.findall(r"^\d+\. \[(.*)\]\(#(.*)\)$", self.text, re.M)
        numbered = [h for h in headings if re.match(r"## \d", h)]
        self.assertEqual([f"## {i + 1}. {title}" for i, (title, _) in enumerate(contents)], numbered)
        self.assertEqual([link for _, link in contents], [anchor(h) for h in numbered])
        readme = (TREE / "README.md").read_text(encoding="utf-8")
        self.assertTrue("(studies/tutorial/README.md)" in readme, "the first page names the tutorial")

    def test_a_difference_is_noticed(self):
        self.assertEqual(unheard_of("a of 3.1 Hz, 20 Hz, 0.05 Hz and 2", "x 3.1499 4 20.3 -0.0521\n"), [])
        self.assertEqual(unheard_of("a of 3.2 Hz, 21 Hz and 5 %", "x 3.1499 4 20.3\n"), ["3.2", "21", "5"])
        self.assertIsNone(edited("a\nb\na\n", "-c\n+d\n"))
        self.assertIsNone(edited("a\nb\na\n", "-a\n+c\n"))
        self.assertEqual(edited("a\nb\na\n", " a\n-b\n+c\n+d\n"), "a\nc\nd\na\n")
        self.assertEqual(only("A\n 1\n\nB\n\nC\n\nD\n 2\n", ["^A", "^D"]), "A\n 1\n\n...\n\nD\n 2\n")
        self.assertTrue(same_line("x.json: 0.02 s, 5 evaluations (search 5); written to r/x/", "x.json: 9 s, 6 evaluations (search 6); written to r/x/"))
        self.assertFalse(same_line("x.json: 0.02 s, 5 evaluations; written to r/x/", "x.json: 0.02 s, 5 evaluations; written to r/y/"))
        self.assertTrue(same_picture('<circle r="5.0"/>', '<circle r="5.1"/>'))
        self.assertFalse(same_picture('<circle r="5.0"/>', '<circle r="6"/>'))
        self.assertFalse(same_picture("<text>a</text>", "<text>b</text>"))


if __name__ == "__main__":
    sys.exit(unittest.main())

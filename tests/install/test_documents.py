# SPDX-License-Identifier: GPL-3.0-or-later
"""
What is installed to read: documents in their folders, whose links lead to files that are installed, too.
"""
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(os.environ["SOURCE_DIR"])
BUILD = Path(os.environ["BUILD_DIR"])
sys.path.insert(0, str(SOURCE / "tests/structure"))
from common_document import links_to_nowhere  # noqa: E402


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.prefix = Path(folder.name)
        subprocess.run(["cmake", "--install", BUILD, "--prefix", cls.prefix], check=True, capture_output=True)

    def test_documents_are_there_and_their_links_lead_somewhere(self):
        documents = self.prefix / "share/doc/modetune"
        pages = {str(path.relative_to(documents)) for path in documents.rglob("README.md")}
        self.assertLessEqual({"README.md", "schemas/README.md", "src/cli/README.md", "studies/tutorial/README.md"}, pages)
        # of src the program's manual and the Python package: the map and those of the rooms are for who changes the code
        in_tree = {str(p.relative_to(SOURCE))
                   for part in ("include", "problems", "schemas", "src/cli", "src/library/python", "studies", "tests/bench", "tests/reference")
                   for p in (SOURCE / part).rglob("README.md")}
        self.assertEqual(in_tree - pages, set(), "documents that CMakeLists.txt does not know")
        followed = 0
        for name in pages:
            text = (documents / name).read_text(encoding="utf-8")
            self.assertEqual(text, (SOURCE / name).read_text(encoding="utf-8"))
            there = set(links_to_nowhere(text, (documents / name).parent))
            missing = set(links_to_nowhere(text, (SOURCE / name).parent))  # of the tree's own pages other tests say so
            self.assertEqual(there - missing, set(), name)
            followed += len(re.findall(r"\]\(([^):#]+)", text))
        self.assertGreater(followed, 15)

    def test_manual_pages_are_those_that_the_program_prints(self):
        program = self.prefix / "bin/modetune"

        def said(*args):
            return subprocess.run([program, *args], check=True, capture_output=True, text=True).stdout

        commands = re.findall(r"^  ([a-z]+)  +\S", said("--help"), re.M)
        self.assertGreater(len(commands), 20)
        pages = {path.name: path.read_text(encoding="utf-8") for path in (self.prefix / "share/man/man1").iterdir()}
        self.assertEqual(pages, {"modetune.1": said("--manual")} | {f"modetune-{c}.1": said(c, "--manual") for c in commands})


if __name__ == "__main__":
    sys.exit(unittest.main())

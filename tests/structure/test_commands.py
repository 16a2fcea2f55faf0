# SPDX-License-Identifier: GPL-3.0-or-later
"""
src/cli/README.md tells the truth about the commands. In a copy of problems/ and studies/:
- every command has a section, in the order of --help, which begins with what COMMAND --help prints, to the letter;
- its blocks do what they show (common_document.py), and its commands and options are real;
- the manual page of a command has the sentences of its section.
MT_README_UPDATE=1 writes the present output into the page: read the difference before you commit it.
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from common_document import Walk, links_to_nowhere

TREE = Path(os.environ["SOURCE_DIR"])
PROGRAM = Path(os.environ["MODETUNE"])
PAGE = TREE / "src/cli/README.md"


def said(*args):
    return subprocess.run([PROGRAM, *args], capture_output=True, text=True, check=True).stdout


def listed():
    return re.findall(r"^  ([a-z]+)  +\S", said("--help"), re.M)


def sections(text):
    """(title, text) of each section of level 2, code blocks passed over."""
    fenced, found = False, []
    for line in text.splitlines(keepends=True):
        fenced ^= line.startswith("```")
        if line.startswith("## ") and not fenced:
            found.append([line[3:].strip(), ""])
        elif found:
            found[-1][1] += line
    return found


def faults(text, commands):
    """What the page lacks, or has in excess, of the commands."""
    own = [(title.strip("`"), body) for title, body in sections(text) if "`" in title]
    if [name for name, _ in own] != commands:
        yield f"sections of {[name for name, _ in own]}, not of {commands}"
    for name, body in own:
        if name in commands and not body.startswith(f"\n```console\n$ modetune {name} --help\n{said(name, '--help')}```\n"):
            yield f"{name}: does not begin with what --help prints"


def spoken(section):
    """Sentences of a section outside of blocks and pictures, as their words."""
    text = re.sub(r"^<!--.*?-->$|^!\[.*?\)$|^```.*?^```$|^#[^\n]*$|^See also: .*?\.$", "\n\n", section, flags=re.M | re.S)
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)
    for paragraph in re.split(r"\n\n+|\n- ", text):
        yield from filter(None, re.split(r"(?<=[.:]) (?=[A-Z])", " ".join(re.sub(r"`|^- ", "", paragraph).split())))


def letters(text):
    """Without what line breaks and emphasis change."""
    return re.sub(r"[\s*-]", "", text)


class Commands(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.text = PAGE.read_text(encoding="utf-8")

    def test_blocks_do_what_they_show(self):
        for part in ("problems", "studies", "schemas"):
            shutil.copytree(TREE / part, self.folder / part)
        walk = Walk(self.text, self.folder, PROGRAM)
        if os.environ.get("MT_README_UPDATE"):
            PAGE.write_text(walk.now, encoding="utf-8")
            return
        walk.run("modetune check " + " ".join(str(path.relative_to(self.folder)) for path in walk.files))
        self.assertEqual(walk.wrong, [], "\n".join(walk.wrong))
        self.assertGreaterEqual(walk.commands, len(listed()) + 15)

    def test_every_command_has_its_section_with_its_help(self):
        commands = listed()
        self.assertGreater(len(commands), 20)
        self.assertEqual(list(faults(self.text, commands)), [])
        self.assertIn(f"```console\n$ modetune --help\n{said('--help')}```\n", self.text)
        for changed in (self.text.replace("## `mac`", "## `mca`"), self.text.replace("## `mac`", "## Of mac"),
                        self.text.replace("which recommendation (default: 1", "which recommendation (default: 2", 1)):
            self.assertNotEqual(list(faults(changed, commands)), [])

    def test_commands_and_options_are_real(self):
        known = {name: set(re.findall(r"^\s+(?:-\w, )?--([a-z][a-z-]*)", said(name, "--help"), re.M)) for name in listed()}
        found = 0
        for line in re.findall(r"^(?:\$ )?(?:parallel |for .* do )?modetune .*$", self.text, re.M):
            name, rest = re.search(r"modetune (\S+)(.*)", line).groups()
            if name.startswith("-"):
                continue
            found += 1
            self.assertIn(name, known, line)
            self.assertLessEqual(set(re.findall(r" --([a-z][a-z-]*)", rest.split("|")[0])), known[name], line)
        self.assertGreater(found, 40)

    def test_links_lead_somewhere(self):
        self.assertEqual(links_to_nowhere(self.text, PAGE.parent), [])

    def test_manual_pages_say_what_the_page_says(self):
        commands = listed()
        spoken_of = 0
        for title, body in sections(self.text):
            name = [title.strip("`")] if "`" in title else []
            page = self.folder / "page.1"
            page.write_text(said(*name, "--manual"), encoding="utf-8")
            done = subprocess.run(["mandoc", "-mman", "-Tascii", page], capture_output=True, text=True, check=True)
            words = letters(re.sub(".\b", "", done.stdout))
            for sentence in spoken(body):
                spoken_of += 1
                self.assertIn(letters(sentence), words, f"{title}: {sentence}")
            for other in set(re.findall(r"`modetune ([a-z]+)`", "".join(re.findall(r"^See also: .*?\.$", body, re.M | re.S)))):
                self.assertIn(other, commands)
                self.assertIn(letters(f"modetune-{other}(1)"), words)
        self.assertGreater(spoken_of, 150)


if __name__ == "__main__":
    sys.exit(unittest.main())

# SPDX-License-Identifier: GPL-3.0-or-later
"""
The README tells the truth. In a copy of problems/ and studies/:
- a block ```json after <!-- file: NAME --> is written to NAME and must pass `modetune check`;
- a block ```console holds commands after "$ " and their standard output, which must be what the program prints now, except
  that numbers may differ by two units of their last digit, rounding noise by itself, and columns by their width;
- every path in the table "What is where" exists;
- tables of measurements are headed by columns of the files that the text above them names (their values are of another day).
MT_README_UPDATE=1 writes the present output into the README instead: read the difference before you commit it.
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from decimal import Decimal, InvalidOperation
from pathlib import Path

TREE = Path(os.environ["SOURCE_DIR"])
PROGRAM = Path(os.environ["MODETUNE"])
README = TREE / "README.md"
sys.path.append(str(TREE / "tests/bench"))
from _tables import COLUMNS  # noqa: E402: where it is, is known now

NOISE = 1e-9  # numbers below this are rounding: residuals of goals that are met
BLOCK = re.compile(r"(?:<!-- file: (?P<file>\S+) -->\n)?^```(?P<kind>json|console)\n(?P<body>.*?)^```$", re.M | re.S)
LAST_DIGITS = 2


# A file that is named, or the head of a table.
HEADS = re.compile(r"^\| (.*) \|\n\|(?: -+ \|)+$", re.M)


def wrong_columns(text):
    wrong = []
    for head in HEADS.finditer(text):
        name = re.findall(r"`(\w+)\.csv`", text[:head.start()])[-1]
        wrong += [f"{name}.csv has no column {c}" for c in head[1].split(" | ") if c.strip("`") not in COLUMNS.get(name, ())]
    return wrong


def number(token):
    """Value and unit of the last digit, or None."""
    match = re.fullmatch(r"[(]?([+-]?[0-9.]+(?:e[+-]?[0-9]+)?)[),.:;]*", token)
    try:
        value = Decimal(match.group(1)) if match else None
    except InvalidOperation:
        value = None
    return None if value is None else (float(value), float(Decimal(1).scaleb(value.as_tuple().exponent)))


def same_token(want, got):
    if want == got or (set(want) == set(got) == {"-"}):
        return True
    a, b = number(want), number(got)
    if a is None or b is None:
        return False
    return abs(a[0] - b[0]) <= max(NOISE, (LAST_DIGITS + 1e-6) * a[1])


def same_line(want, got):
    a, b = want.split(), got.split()
    return len(a) == len(b) and all(map(same_token, a, b))


def steps(body):
    """Pairs of command and output."""
    parts = re.split(r"^\$ (.*)\n", body, flags=re.M)
    return parts[0], list(zip(parts[1::2], parts[2::2]))


class Readme(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        for part in ("problems", "studies", "schemas"):
            shutil.copytree(TREE / part, self.folder / part)
        self.text = README.read_text(encoding="utf-8")

    def run_command(self, command):
        environment = dict(os.environ, PATH=f"{PROGRAM.parent}:{os.environ['PATH']}")
        # a pipe must read all: a program that is cut off reports it, and the command counts as failed
        done = subprocess.run(["bash", "-o", "pipefail", "-c", command], cwd=self.folder, env=environment,
                              capture_output=True, text=True, check=False)
        self.assertIn(done.returncode, (0, 1), f"{command}\n{done.stderr}")
        self.assertNotIn("error:", done.stderr, command)
        return done.stdout

    def block(self, match):
        """The block as it should be; problems are noted."""
        if match["kind"] == "json":
            if match["file"] is not None:
                self.assertFalse((self.folder / match["file"]).exists(), match["file"])
                (self.folder / match["file"]).write_text(match["body"], encoding="utf-8")
                self.files.append(match["file"])
            return match[0]
        before, pairs = steps(match["body"])
        self.assertEqual(before, "", "a console block begins with a command")
        now = []
        for command, want in pairs:
            self.commands += 1
            got = self.run_command(command).rstrip("\n") + "\n"
            now.append(f"$ {command}\n{got}")
            a, b = want.splitlines(), got.splitlines()
            if len(a) != len(b):
                self.wrong.append(f"$ {command}\nnow prints {len(b)} lines, not {len(a)}:\n{got}")
            self.wrong += [f"$ {command}\n  README: {x}\n  now:    {y}" for x, y in zip(a, b) if not same_line(x, y)]
        return match[0].replace(match["body"], "".join(now))

    def test_commands_print_what_the_readme_shows(self):
        self.wrong, self.files, self.commands = [], [], 0
        updated = BLOCK.sub(self.block, self.text)
        if os.environ.get("MT_README_UPDATE"):
            README.write_text(updated, encoding="utf-8")
            return
        self.assertEqual(self.wrong, [], "\n".join(self.wrong))
        self.assertGreaterEqual(self.commands, 5)
        self.assertGreaterEqual(len(self.files), 2)
        self.run_command("modetune check " + " ".join(self.files))

    def test_the_map_is_of_this_tree(self):
        table = self.text[self.text.index("## What is where"):]
        paths = [p for row in re.findall(r"^\| (`.*?) \|", table, re.M) for p in re.findall(r"`([^`]+)`", row)]
        self.assertGreaterEqual(len(paths), 8)
        for path in paths:
            self.assertTrue((TREE / path).exists(), path)
        links = re.findall(r"\]\(([^):]+)\)", self.text)
        for link in links:
            self.assertTrue((TREE / link).exists(), link)

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

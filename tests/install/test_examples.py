# SPDX-License-Identifier: GPL-3.0-or-later
"""
The programs of the pages on the C and the Python interface, against an installed package: a block ```c or ```python after
<!-- file: NAME --> is written to NAME, built with pkg-config or run by python3, and prints the block ```text that follows.
The frequencies are those of the command line. MT_README_UPDATE=1 writes what they print now into the pages.
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

SOURCE = Path(os.environ["SOURCE_DIR"])
sys.path.insert(0, str(SOURCE / "tests/structure"))
from common_document import same_line  # noqa: E402  numbers may differ by two units of their last digit

BUILD = Path(os.environ["BUILD_DIR"])
PAGES = [SOURCE / "include/README.md", SOURCE / "src/library/python/README.md"]
FILE = re.compile(r"<!-- file: (\S+) -->\n```(c|python)\n(.*?)^```$(?:\n+```text\n(.*?)^```$)?", re.M | re.S)
STRICT = ["-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]


@unittest.skipIf("MT_INSTRUMENTED" in os.environ, "a sanitizer's library is for its own programs")
class Examples(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp())
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        prefix = cls.folder / "prefix"
        subprocess.run(["cmake", "--install", BUILD, "--prefix", prefix], check=True, capture_output=True)
        (libraries,) = {p.parent for p in prefix.rglob("libmodetune.so")}
        cls.environment = dict(os.environ, PKG_CONFIG_PATH=str(libraries / "pkgconfig"), LD_LIBRARY_PATH=str(libraries),
                               PYTHONPATH=str(SOURCE / "src/library/python"),
                               OPENBLAS_NUM_THREADS="1")
        cls.blocks = {}
        for part in ("problems", "studies"):
            shutil.copytree(SOURCE / part, cls.folder / part)
        for page in PAGES:
            for name, kind, body, text in FILE.findall(page.read_text(encoding="utf-8")):
                (cls.folder / name).write_text(body, encoding="utf-8")
                cls.blocks[name] = (page, kind, text)

    def run_in_folder(self, *command):
        done = subprocess.run(command, cwd=self.folder, env=self.environment, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, f"{command}\n{done.stdout}{done.stderr}")
        return done.stdout

    def said(self, name):
        page, kind, want = self.blocks[name]
        if kind == "c":
            flags = self.run_in_folder("pkg-config", "--cflags", "--libs", "modetune").split()
            self.run_in_folder(os.environ.get("CC", "cc"), *STRICT, name, "-o", "example", *flags)
            got = self.run_in_folder("./example")
        else:
            got = self.run_in_folder(sys.executable, "-B", name)
        if os.environ.get("MT_README_UPDATE"):
            text = page.read_text(encoding="utf-8")
            page.write_text(text.replace(f"```text\n{want}```", f"```text\n{got}```"), encoding="utf-8")
            return got
        a, b = want.splitlines(), got.splitlines()
        self.assertTrue(len(a) == len(b) and all(map(same_line, a, b)), f"{page}:\n{want}now:\n{got}")
        return got

    def test_c_program_says_what_the_command_line_says(self):
        self.assertLessEqual((self.folder / "example.c").read_text().count("\n"), 45)
        lines = re.findall(r"^k_servo (\d+): ([0-9.]+) Hz", self.said("example.c"), re.M)
        self.assertEqual(len(lines), 3)
        for k, hz in lines:
            modes = json.loads(self.run_in_folder("prefix/bin/modetune", "modes", "problems/stick.json", "-c", "installed",
                                                  "--set", f"k_servo={k}", "--format", "json"))
            self.assertAlmostEqual(float(hz), modes["modes"][0]["frequency_hz"], delta=1e-4)

    def test_python_script_says_what_the_command_line_says(self):
        first = self.said("example.py").splitlines()[0]
        self.run_in_folder("prefix/bin/modetune", "run", "studies/stick.json", "--quiet", "--set", "d=0.18")
        result = json.loads((self.folder / "results/stick/result.json").read_text())
        for p in result["recommendations"][0]["parameters"]:
            value = float(re.search(rf"{p['name']} ([0-9.e+-]+)", first).group(1))
            self.assertAlmostEqual(value / p["recommended"], 1.0, delta=1e-4)


if __name__ == "__main__":
    unittest.main()

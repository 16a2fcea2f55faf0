# SPDX-License-Identifier: GPL-3.0-or-later
"""--help, the manual pages and the documents say the same, help finds topics; wrong use is answered helpfully."""
import re
import shlex
import subprocess
from pathlib import Path

from common_cli import COMMANDS, SOURCE, CliTest, main, options_in
from suite import EVERY

PAGES = [Path(SOURCE) / page for page in ("README.md", "problems/README.md", "studies/README.md", "studies/tutorial/README.md", "src/cli/README.md")]
# Which options each command has: written down once more, so that a change is a decision.
EVERYWHERE = {"max-memory", "root", "format", "quiet", "help"}
ALONE = {"manual", "completion", "version"}
OPTIONS = {
    "run": {"output", "verify", "threads", "time", "set", "seed", "starts", "max-evaluations", "max-modal-solutions", "proof", "resume", "shard", "timing", "progress", "report"},
    "merge": {"output", "verify", "threads", "time", "set", "seed", "starts", "max-evaluations", "max-modal-solutions", "proof", "redo", "timing", "progress", "report"},
    "compare": {"threads", "set", "seed", "starts", "max-evaluations", "max-modal-solutions", "proof", "progress"},
    "modes": {"configuration", "set", "count", "shapes", "damped", "effective-mass", "about", "energy", "energy-about", "axes", "timing", "progress"},
    "mac": {"count"},
    "sweep": {"configuration", "set", "count", "drive", "hold", "grid", "frequencies"},
    "simulate": {"vibration", "configuration", "set", "duration", "dt-out", "start", "rate", "start-mode", "input", "sine", "sine-sweep", "random", "integrate", "seed", "measure", "tolerance", "time"},
    "sensitivity": {"configuration", "set", "count", "parameters"},
    "response": {"configuration", "set", "input", "measure", "from", "to", "points", "log", "modes", "direct", "poles", "state-space", "sensitivity", "vibration"},
    "info": {"configuration", "set"},
    "show": {"configuration", "set", "output", "svg", "mode", "model"},
    "report": {"output", "verify"},
    "explain": {"rank"},
    "apply": {"rank", "model", "output"},
    "diff": {"rel-tol", "abs-tol"},
    "check": set(),
    "init": {"kind"},
    "examples": {"output"},
    "schema": {"output"},
    "profile": {"spectrum", "damping-ratio"},
    "help": set(),
}


def listed(text):
    """Options in the list of a help text: lines that begin with one."""
    return set(re.findall(r"^\s+(?:-\w, )?--([a-z][a-z-]*)", text, re.M))


def linted(page):
    """Complaints of mandoc about a manual page."""
    done = subprocess.run(["mandoc", "-mman", "-Tlint", "-Wwarning", page], capture_output=True, text=True)
    return done.stdout.splitlines()


def shown(page):
    """The words of a manual page as they are read."""
    done = subprocess.run(["mandoc", "-mman", "-Tascii", page], capture_output=True, text=True, check=True)
    return " ".join(re.sub(".\b", "", done.stdout).split())


class Help(CliTest):
    def test_every_command_explains_itself_and_its_options(self):
        for command in COMMANDS:
            with self.subTest(command):
                done = self.expect(0, command, "--help")
                self.assertEqual(done.stderr, "")
                self.assertTrue(done.stdout.startswith(f"Usage: modetune {command} "))
                self.assertEqual(listed(done.stdout), OPTIONS[command] | EVERYWHERE)
                self.assertLessEqual(max(map(len, done.stdout.splitlines())), 96)
                self.assertEqual(done.stdout, self.expect(0, command, "-h").stdout)

    def test_the_whole_lists_all_commands(self):
        text = self.expect(0, "--help").stdout
        self.assertEqual(re.findall(r"^  ([a-z]+)  +\S", text, re.M), COMMANDS)
        self.assertEqual(listed(text), EVERYWHERE | ALONE)
        self.assertEqual(re.findall(r"^  (\d+) +\S", text, re.M), ["0", "1", "2", "3", "4", "130"])

    def test_version_is_that_of_the_header(self):
        header = (SOURCE / "include/modetune/version.h").read_text(encoding="utf-8")
        version = re.search(r'MT_VERSION_STRING "([^"]+)"', header).group(1)
        self.assertRegex(self.expect(0, "--version").stdout,
                         rf"^modetune {re.escape(version)} \(commit [-+.0-9A-Za-z]+, compiled by [A-Za-z]+ [0-9.]+\)\n$")

    def read(self, *command):
        """A manual page as its source and as its words; mandoc has nothing to say against it."""
        page = self.expect(0, *command, "--manual").stdout
        path = self.folder / self.write("page.1", page)
        # a page that is made has no date, and needs none
        self.assertEqual([line for line in linted(path) if "missing date" not in line], [])
        return page, shown(path)

    def test_manual_page_of_the_program_lists_commands_and_common_options(self):
        page, words = self.read()
        self.assertNotEqual(linted(self.folder / self.write("wrong.1", page + ".XX\n")), linted(self.folder / "page.1"))
        self.assertLessEqual({"NAME", "SYNOPSIS", "DESCRIPTION", "COMMANDS", "OPTIONS", "EXIT STATUS", "PROGRESS", "TEXT FROM FILES", "ENVIRONMENT",
                              "SEE ALSO"}, set(re.findall(r"^\.SH (.*)$", page, re.M)))
        for command, summary in re.findall(r"^  ([a-z]+)  +(\S.*)$", self.expect(0, "--help").stdout, re.M):
            self.assertIn(f" {summary} ", words)
            self.assertIn(f"modetune-{command}(1)", words)
        own = page[page.index(".SH OPTIONS\n"):].split(".SH ")[1]
        self.assertEqual({name.replace("\\-", "-") for name in re.findall(r"^\\fB(?:\\-\w, )?\\-\\-([a-z\\-]+)\\fR", own, re.M)}, EVERYWHERE | ALONE)

    def test_manual_page_of_a_command_says_what_help_says(self):
        for command in COMMANDS:
            with self.subTest(command):
                page, words = self.read(command)
                self.assertIn(f".TH MODETUNE\\-{command.upper()} 1 ", page)
                sections = re.findall(r"^\.SH (.*)$", page, re.M)
                self.assertEqual(sections[:4], ["NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS"])
                self.assertLessEqual({"EXIT STATUS", "SEE ALSO"}, set(sections))
                self.assertEqual(len(sections), len(set(sections)))
                self.assertIn(f"modetune {command} ", words)
                about, options = self.expect(0, command, "--help").stdout.split("\nOptions:\n")
                self.assertIn(" ".join(about.split("\n", 1)[1].split()), words)
                for form, text in re.findall(r"^(?:  -| {6}-)(\S.*?)(?:  +|\n {31})(\S.*(?:\n {31}.*)*)$", options, re.M):
                    self.assertIn(f"-{form} {' '.join(text.split())}", words)

    def completed(self, *words):
        """What bash offers for the last word."""
        script = self.folder / self.write("completion.bash", self.expect(0, "--completion", "bash").stdout)
        done = subprocess.run(["bash", "-c", 'source "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _modetune; printf "%s\\n" "${COMPREPLY[@]}"',
                               script, "modetune", *words], capture_output=True, text=True, check=True, cwd=self.folder)
        self.assertEqual(done.stderr, "")
        return set(done.stdout.split())

    def test_completion_offers_commands_options_values_and_files(self):
        self.assertLessEqual(set(COMMANDS), self.completed(""))
        self.assertEqual(self.completed("sens"), {"sensitivity"})
        for command in COMMANDS:
            with self.subTest(command):
                self.assertEqual({word.removeprefix("--") for word in self.completed(command, "--")}, OPTIONS[command] | EVERYWHERE)
        self.assertEqual(self.completed("run", "--progress", ""), {"auto", "line", "json", "none"})
        self.assertEqual(self.completed("run", "--seed", ""), set())
        for command, forms in (("run", "text json csv"), ("report", "text json csv html"), ("check", "text json csv sarif"),
                               ("show", "json html"), ("apply", "text json")):
            self.assertEqual(self.completed(command, "--format", ""), set(forms.split()))
            for form in {"text", "json", "csv", "html", "sarif"} - set(forms.split()):
                self.assertIn(f'--format: "{form}" is not one of', self.expect(2, command, "--format", form, "x").stderr)
        self.assertEqual(self.completed("schema", "s"), {"study", "scene"})
        self.assertEqual(self.completed("examples", ""), {p.stem for p in (SOURCE / "studies").glob("*.json")})
        self.write("study.json", "{}")
        self.write("notes.txt", "")
        (self.folder / "models").mkdir()
        self.assertEqual(self.completed("run", "") & {"study.json", "notes.txt", "models"}, {"study.json", "models"})
        self.assertEqual(self.completed("run", "-o", "m"), {"models"})
        self.assertEqual(self.completed("show", "-o", "n"), {"notes.txt"})
        self.assertEqual(self.completed("apply", "--output", "n"), {"notes.txt"})
        self.assertEqual(self.completed("apply", "result.json", "--model", "study."), {"study.json"})

    def test_completion_of_zsh_is_well_formed_and_has_all(self):
        script = self.expect(0, "--completion=zsh").stdout
        path = self.folder / self.write("_modetune", script)
        done = subprocess.run(["zsh", "-n", path], capture_output=True, text=True, check=False)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(subprocess.run(["zsh", "-n", self.folder / self.write("wrong", script.replace("case", "cas", 1))],
                                        capture_output=True, check=False).returncode, 1)
        for command in COMMANDS:
            with self.subTest(command):
                own = re.search(rf"^        {command}\) _arguments(.*?);;$", script, re.M | re.S).group(1)
                self.assertEqual(set(re.findall(r"'\*?--([a-z-]+)=?\[", own)), OPTIONS[command] | EVERYWHERE)

    def test_documents_name_real_commands_and_options(self):
        text = "".join(page.read_text(encoding="utf-8") for page in PAGES)
        found = set(re.findall(r"(?:^\$ |`)modetune ([a-z]+)\b", text, re.M))
        self.assertEqual(found - set(COMMANDS), set())
        self.assertGreaterEqual(len(found), len(COMMANDS))
        for line in re.findall(r"^\$ (modetune [a-z]+ .*)$|`(modetune [a-z]+ [^`]*)`", text, re.M):
            line = "".join(line)
            command = re.search(r"modetune ([a-z]+)", line).group(1)
            self.assertLessEqual(options_in(line), OPTIONS[command] | EVERYWHERE, line)


class Topics(CliTest):
    def pages(self):
        """Text of the documents that the program has, by path."""
        names = ("README.md", "include/README.md", "problems/README.md", "schemas/README.md", "src/cli/README.md", "src/library/python/README.md",
                 "studies/README.md", "studies/tutorial/README.md", "tests/bench/README.md", "tests/reference/README.md")
        return {name: (SOURCE / name).read_text(encoding="utf-8") for name in names if (SOURCE / name).exists()}

    @staticmethod
    def headings(text):
        """(names, text of the section without comments) of every heading, code blocks passed over."""
        lines = text.splitlines()
        fenced, found = False, []
        for i, line in enumerate(lines):
            fenced ^= line.startswith("```")
            if not fenced and re.match(r"#+ ", line):
                found.append((i, len(line) - len(line.lstrip("#"))))
        for k, (i, level) in enumerate(found):
            end = next((j for j, other in found[k + 1:] if other <= level), len(lines))
            yield re.findall(r"`([^`]+)`", lines[i]), re.sub(r"<!--.*?-->\n+", "", "\n".join(lines[i:end]) + "\n", flags=re.S).strip()

    def test_a_name_in_a_heading_prints_the_section_of_every_page(self):
        want = {}
        for name, text in sorted(self.pages().items(), key=lambda page: (page[0] != "src/cli/README.md", page[0] == "schemas/README.md", page[0])):
            for names, section in self.headings(text):
                for one in set(names):
                    want.setdefault(one, []).append((name, section))
        self.assertGreater(len(want), 80)
        for topic in [t for t in want if " " not in t][::1 if EVERY else 12] + ["avoid", "search"]:
            with self.subTest(topic):
                if topic in COMMANDS and want[topic][0][0] != "src/cli/README.md":
                    continue
                said = self.expect(0, "help", topic).stdout
                at = 0
                for name, section in want[topic]:
                    self.assertIn(f"From {name}:\n\n", said)
                    at = said.index(section, at) + len(section)
                self.assertEqual(said[at:], "\n")
                self.assertNotIn("<!--", said)

    def test_a_member_without_a_heading_prints_its_entries(self):
        said = self.expect(0, "help", "margin_percent").stdout
        self.assertIn("From schemas/README.md, `avoid` (Study: `modetune-study/1`):\n\n- `margin_percent` (", said)
        self.assertIn("From schemas/README.md, `rotor`, `rotors` (Study: `modetune-study/1`):\n\n- `margin_percent` (", said)
        entries = re.findall(r"^- `.*(?:\n  .*)*", said, re.M)
        self.assertEqual(len(entries), len(set(entries)))
        reference = (SOURCE / "schemas/README.md").read_text(encoding="utf-8")
        self.assertLessEqual(set(re.findall(r"^- `margin_percent`.*(?:\n  .*)*", reference, re.M)), set(entries))

    def test_a_row_a_value_and_a_function_lead_to_what_explains_them(self):
        self.assertIn("| `revolute` |", self.expect(0, "help", "revolute").stdout)
        self.assertTrue(self.expect(0, "help", "revolute").stdout.startswith("From problems/README.md:\n\n### `joints`"))
        said = self.expect(0, "help", "E24").stdout
        self.assertTrue(said.startswith("From schemas/README.md, `catalogue` (Study: `modetune-study/1`):\n\n- `series` ("))
        for function in ("sin", "atan2"):
            said = self.expect(0, "help", function).stdout
            self.assertIn("From problems/README.md:\n\n## Numbers and expressions\n", said)
            self.assertLessEqual(len(re.findall(r"^From ", said, re.M)), 10)

    def test_an_unknown_topic_names_near_ones_and_lists_all(self):
        for topic, near in (("avod", '"avoid"'), ("margin_perc", '"margin_percent"'), ("modse", '"modes"')):
            done = self.expect(2, "help", topic)
            self.assertEqual(done.stdout, "")
            self.assertRegex(done.stderr, rf'^modetune: error: no topic is called "{topic}"; did you mean .*{near}')
            for word in ("compare", "tolerance_box", "Commands:"):
                self.assertIn(word, done.stderr)
        self.assertEqual(self.expect(2, "help", "xyzzyq").stderr.splitlines()[0], 'modetune: error: no topic is called "xyzzyq"')
        self.assertIn("\\u001b", self.expect(2, "help", "\x1b[31m").stderr)

    def test_alone_it_says_how_to_ask(self):
        said = self.expect(0, "help").stdout
        self.assertTrue(said.startswith(self.expect(0, "--help").stdout))
        self.assertIn('"modetune help TOPIC"', said)
        listed = set(re.findall(r"[a-z_0-9]+", said.split("Objects of files")[1]))
        self.assertLessEqual({"avoid", "catalogue", "tolerance_box", "ellipsoid"}, listed)


class WrongUse(CliTest):
    def wrong(self, want, *args):
        with self.subTest(args):
            done = self.expect(2, *args)
            self.assertEqual(done.stdout, "")
            self.assertEqual(done.stderr.splitlines()[0], f"modetune: error: {want}")
        return done.stderr

    def test_messages(self):
        self.wrong('a command is missing')
        self.wrong('unknown command "mods"; did you mean "modes"?', "mods")
        self.wrong('unknown command "xyzzy"', "xyzzy")
        self.wrong('unknown option "--hlep"; did you mean "--help"?', "--hlep")
        self.wrong('unknown option "--shape"; did you mean "--shapes"?', "modes", self.model, "--shape")
        self.wrong('unknown option "-z"', "modes", self.model, "-z")
        self.wrong('"info" has no option "--verify"', "info", self.model, "--verify")
        self.wrong('"modes" needs MODEL', "modes")
        self.wrong('"mac" needs MODEL:CONFIGURATION MODEL:CONFIGURATION', "mac", "a:b")
        self.wrong('"modes" takes MODEL, and "y" is too many', "modes", "x", "y")
        self.wrong('-c needs a value: CONFIGURATION', "modes", self.model, "-c")
        self.wrong('--count needs a value: N', "modes", self.model, "--count")
        self.wrong('--count: "0" is neither "all" nor a whole number from 1 to 2147483647', "modes", self.model, "--count", "0")
        self.wrong('--count: "2x" is neither "all" nor a whole number from 1 to 2147483647', "modes", self.model, "--count=2x")
        self.wrong('--count: "4294967297" is neither "all" nor a whole number from 1 to 2147483647', "modes", self.model, "--count=4294967297")
        self.wrong(f'--count: "{"9" * 30}" is neither "all" nor a whole number from 1 to 2147483647', "modes", self.model, "--count", "9" * 30)
        self.wrong('--count: "a" is neither "all" nor a whole number from 1 to 2147483647', "modes", self.model, "--count", "a")
        self.wrong('--threads: "1025" is not a whole number from 1 to 1024', "run", "x", "--threads", "1025")
        self.wrong('-h takes no value', "run", "x", "-hx")
        self.wrong('unknown option "--xyzzy"', "modes", self.model, "--xyzzy")
        self.wrong('unknown option "--"', "modes", self.model, "--=3")
        self.wrong('--threads: "-1" is not a whole number from 1 to 1024', "run", "x", "--threads", "-1")
        self.wrong('--shapes takes no value', "modes", self.model, "--shapes=yes")
        self.wrong('--format is given twice', "modes", self.model, "--format", "csv", "--format=json")
        self.wrong('--format: "jsn" is not one of text, json, csv; did you mean "json"?', "modes", "--format=jsn", "m")
        self.wrong('--output: the value is empty', "run", "x", "--output=")
        self.wrong('unknown configuration "hold"; did you mean "held"?', "modes", self.model, "-c", "hold")
        self.wrong('--set: "k1" is not NAME=VALUE', "modes", self.model, "--set", "k1")
        self.wrong('--set: unknown parameter "k3"; did you mean "k1"?', "modes", self.model, "--set", "k3=1")
        self.wrong('--set: parameter "k1" is set twice', "modes", self.model, "--set", "k1=1", "--set", "k1=2")
        self.wrong('--parameters: unknown parameter "k9"; did you mean "k1"?', "sensitivity", self.model,
                   "--parameters", "m,k9")
        self.wrong('--parameters: unknown parameter "xyzzy"', "sensitivity", self.model, "--parameters", "xyzzy")
        self.wrong('--parameters: "k1" is given twice', "sensitivity", self.model, "--parameters", "k1,m,k1")
        self.wrong('--set: "=1" is not NAME=VALUE', "modes", self.model, "--set", "=1")
        self.wrong('--set: unknown parameter "xyzzy"', "modes", self.model, "--set", "xyzzy=1")
        self.wrong('unknown configuration "xyzzy"', "modes", self.model, "-c", "xyzzy")
        self.wrong('"problems/model.json" has 4 configurations: name one, as problems/model.json:held', "mac",
                   self.model, f"{self.model}:held")

    def test_a_name_of_an_earlier_version_is_answered_by_the_line_to_type(self):
        for old, new, *line in (
                ("output", "measure", "response", "model.json", "--input", "e.y", "--output", "e.y:acceleration", "--output=spring.k"),
                ("output", "measure", "simulate", "model.json", "--duration", "1", "--output", "e.y"),
                ("modes", "frequencies", "sweep", "model.json", "--drive", "pivot=-10*deg:10*deg:3", "--modes", "--count", "2"),
                ("mode", "start-mode", "simulate", "it's mine.json", "--duration", "1", "--mode", "1:0.01"),
                ("sweep", "sine-sweep", "simulate", "--sweep", "base.x=1@5:9", "model.json", "--set", "--sweep", "--", "--sweep"),
                ("profile", "timing", "run", "study.json", "-o", "out", "--profile"),
                ("profile", "timing", "merge", "study.json", "a.journal", "--profile"),
                ("profile", "timing", "modes", "", "--profile", "--help")):
            with self.subTest(line):
                told = self.wrong(f'"{line[0]}" has no option "--{old}": it is called "--{new}"', *line)
                typed = re.search(r"^Type: (.*)$", told, re.M).group(1)
                want = [f"--{new}{word[2 + len(old):]}" if re.fullmatch(rf"--{old}(=.*)?", word) and line[i - 1] not in ("--set", "--") else word
                        for i, word in enumerate(line)]
                self.assertEqual(shlex.split(typed), ["modetune", *want])
                # no option of the line is unknown any more
                self.assertNotIn("has no option", self.run_program(*want).stderr)
        self.wrong('"show" has no option "--modes"', "show", self.model, "--modes")

    def test_a_file_takes_the_place_of_standard_output(self):
        self.expect(0, "schema", "study", "-o", "own.json")
        self.assertEqual((self.folder / "own.json").read_text(encoding="utf-8"), self.expect(0, "schema", "study").stdout)
        self.assertEqual(self.expect(2, "schema", "stdy", "--output", "own.json").stdout, "")
        self.assertEqual((self.folder / "own.json").read_text(encoding="utf-8"), self.expect(0, "schema", "study").stdout)
        self.assertIn("is not the name of a file", self.expect(2, "schema", "study", "-o", "./").stderr)

    def test_format_lists_what_the_command_has(self):
        for command, forms in (("run", "text|json|csv"), ("report", "text|json|csv|html"), ("check", "text|json|csv|sarif"), ("show", "json|html"),
                               ("apply", "text|json"), ("help", "text")):
            self.assertRegex(self.expect(0, command, "--help").stdout, rf"--format {re.escape(forms)}\s")

    def test_a_hint_points_to_the_help(self):
        self.assertIn('Try "modetune modes --help".\n', self.expect(2, "modes").stderr)
        self.assertIn('Try "modetune --help".\n', self.expect(2).stderr)

    def test_double_dash_ends_the_options(self):
        self.write("--help", "{}")
        self.assertIn("--help:1:1: error: ", self.expect(2, "check", "--", "--help").stderr)


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""Every command on a case, within limits of time and memory, and what must hold of each answer whatever the files say."""
import csv
import json
import math
import os
import re
import resource
import signal
import subprocess
import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1] / "cli"))  # where outputs are looked at
import document
from common_words import without_program

# How a change in a file may end. Nothing here is about the answer's numbers.
CODES = {0: "done", 1: "goals not met", 2: "bad input", 3: "numerical failure", 4: "system", 130: "interrupted"}
WORD = re.compile(r"(?<![A-Za-z0-9_.])[-+]?(nan|inf|infinity)(?![A-Za-z0-9_])", re.I)
PLACE = re.compile(r"^(?P<file>[^\n]*?):(?P<line>\d+):(?P<column>\d+): error: (?:(?P<pointer>/[^\n]*?): )?", re.M)
# About the command line and the files together: no place in one of them is to blame.
ABOUT_BOTH = re.compile(r"^modetune: error: (\S+: (configuration \"[^\"]*\": )?(drive|hold): |\S+: (configuration \"[^\"]*\": )?(the configuration has no sensors|there is no vibration)|\S+: is longer than|(\S+: )?--(rate|start): |[^\n]*: meant for small vibrations|--hold|--parameters|the two have no sensor|unknown configuration|\S+: there are no (published values|parameters)|"
                        r"\S+ has \d+ recommendation)", re.M)
# What only an analysis finds is told by its names: "FILE: configuration "loaded": sensor "mid": ...".
ITEM = re.compile(r'^modetune: error: \S+\.json: (?!/).*"', re.M)
MOST_OUTPUT = 64 << 20  # bytes; the files have some ten thousand
# CPU seconds after which a command on a small file counts as stuck, of an optimised and of an instrumented program, and what an interrupted one may still take
PATIENCE = {False: (10, 10), True: (15, 45)}
MEMORY = 1536 << 20  # address space of the optimised program
SANITIZERS = {"ASAN_OPTIONS": "detect_leaks=1:strict_string_checks=1:hard_rss_limit_mb=2000:max_allocation_size_mb=1000:allocator_may_return_null=1",
              "UBSAN_OPTIONS": "print_stacktrace=1", "LSAN_OPTIONS": "exitcode=77", "TSAN_OPTIONS": "exitcode=66"}


class Program:
    def __init__(self, path, patience=None):
        self.path = os.path.abspath(path)
        text = Path(path).read_bytes()
        self.instrumented = b"__asan_init" in text or b"__tsan_init" in text or "MT_INSTRUMENTED" in os.environ
        self.patience, self.grace = patience or PATIENCE[self.instrumented]
        self.environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "LC_ALL": "C", **(SANITIZERS if self.instrumented else {})}

    def _limits(self):
        patience, grace = self.patience, self.grace
        signal.signal(signal.SIGINT, signal.SIG_DFL)  # a hunt in the background of a shell has it ignored, and would hand that on
        most = math.ceil(patience + 2 * grace)
        resource.setrlimit(resource.RLIMIT_CPU, (most, most + 1))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_FSIZE, (MOST_OUTPUT, MOST_OUTPUT))
        if not self.instrumented:
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))

    def run(self, folder, args):
        with open(folder / "stdout", "wb") as out, open(folder / "stderr", "wb") as err:
            child = subprocess.Popen([self.path, *args], cwd=folder, stdin=subprocess.DEVNULL, stdout=out, stderr=err, env=self.environment,
                                     preexec_fn=self._limits)
            slow = self._wait(child, args[0] in ("run", "compare"))
        return Done(args, child.returncode, (folder / "stdout").read_bytes(), (folder / "stderr").read_bytes(), slow)

    def _wait(self, child, searches):
        """Wait by the child's own clock, as others may have the processor; "" or in what way it was too slow."""
        patience, grace = self.patience, self.grace
        slow = ""
        while True:
            try:
                child.wait(timeout=1.0 if slow else patience / 4)
                return slow
            except subprocess.TimeoutExpired:
                used = _cpu_seconds(child.pid)
            if used > patience + grace or (used > patience and not searches):
                child.kill()
                child.wait()
                return "stuck after an interrupt" if searches else "stuck"
            if used > patience and not slow:
                child.send_signal(signal.SIGINT)
                slow = "interrupted"


def _cpu_seconds(pid):
    try:
        fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    except OSError:
        return 0.0
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class Done:
    """How a command ended."""

    def __init__(self, args, code, out, err, slow):
        self.args, self.code, self.out, self.err, self.slow = args, code, out.decode("utf-8", "replace"), err.decode("utf-8", "replace"), slow
        self.bytes = out

    def said(self):
        if "Sanitizer" in self.err or "runtime error" in self.err:
            return "\n".join(re.findall(r"^.*(?:ERROR: |WARNING: |runtime error|SUMMARY: ).*$|^ *#[0-9] .*$", self.err, re.M)[:14])
        return self.err.strip()[-1500:] or "nothing"

    def form(self):
        return self.args[self.args.index("--format") + 1] if "--format" in self.args else "text"


def _moving(tree):
    """A joint that a sweep could drive."""
    names = [j.get("name") for j in tree.get("joints", []) if isinstance(j, document.Object) and j.get("type") in ("revolute", "prismatic")]
    return [n for n in names if isinstance(n, str)]


def commands(rng, case):
    """The arguments of every command that reads the case's file. The first says whether the file is good."""
    file, form = case.target, lambda: ["--format", rng.choice(("text", "json", "csv", "json"))]
    study = case.target if case.kind == "study" else "studies/changed.json"
    workers = ["--threads", str(rng.choice((1, 1, 2, 3)))]
    yield ["check", file, *form()]
    if case.kind == "profile":
        yield ["profile", file, *form()]
        yield ["profile", file, *form(), "--spectrum", rng.choice(("22.09:22.09:1", "5:500:4")), *rng.choice(([], ["--damping-ratio", "1e-4"]))]
        return
    if case.kind == "result":
        yield ["report", file, "--format", rng.choice(("text", "html", "json", "csv"))]
        yield ["apply", file, "--root", "."]
        yield ["show", file, "--root", ".", *rng.choice((["--svg"], ["--format", "json"]))]
        yield ["apply", file, "--root", ".", "--rank", str(rng.choice((1, 2, 7)))]
        return
    if case.kind == "model":
        configurations = [c[0] for c in case.original.get("configurations", [])] or ["default"]
        yield ["info", file, *form()]
        yield ["modes", file, *form(), *rng.choice(([], ["--shapes"], ["--damped"], ["--shapes", "--damped", "--count", "3"]))]
        yield ["sensitivity", file, *form()]
        yield ["response", file, "--input", "base.x", "--points", "5", *form(), *rng.choice(([], ["--direct"], ["--modes", "2"], ["--log"]))]
        yield ["response", file, "--input", "base.x", "--points", "5", *form(), "--vibration", rng.choice(("gevs_qualification", "helicopter_uh60_panel"))]
        joints = _moving(case.original)
        if joints:
            yield ["sweep", file, "-c", rng.choice(configurations), "--drive", f"{rng.choice(joints)}=-0.1:0.1:3", *form(), *rng.choice(([], ["--frequencies"]))]
            yield ["simulate", file, "-c", rng.choice(configurations), "--rate", f"{rng.choice(joints)}=0.1", "--duration", "1e-3", "--dt-out", "5e-4", "--time", "2", *form()]
        yield ["show", file, *rng.choice((["--svg"], ["--format", "json"], ["--format", "json"]))]
        yield ["mac", f"{file}:{rng.choice(configurations)}", f"{file}:{rng.choice(configurations)}", *form()]
    yield ["run", study, "-o", "out", *workers, *form()]
    yield ["compare", study, *workers, *form()]


class Answer:
    """All that a case's commands said, and what is wrong about it."""

    def __init__(self, program, folder, case, tally):
        self.program, self.folder, self.case, self.tally = program, folder, case, tally
        self.tree = self._plain()
        self.shows_words = any(WORD.search(t.decode("utf-8", "replace") if isinstance(t, bytes) else t) for t in case.files.values())

    def _plain(self):
        try:
            text = self.case.files[self.case.target]
            return document.plain(document.read(text if isinstance(text, str) else text.decode("utf-8")))
        except (ValueError, RecursionError):
            return None

    def do(self, args):
        done = self.program.run(self.folder, args)
        self.tally["commands"] += 1
        if done.slow == "interrupted":
            self.tally["interrupted"] = self.tally.get("interrupted", 0) + 1
        return done

    def findings(self, rng):
        """(check, sentence)."""
        good, interrupted = None, False
        for args in commands(rng, self.case):
            if args[0] == "compare" and interrupted:
                continue  # it would search as long as "run"
            before = self._files()
            done = self.do(args)
            interrupted = bool(done.slow)
            wrong = list(self.judge(done)) + list(self.left(done, before))
            if args[0] == "run" and done.code in (0, 1) and not wrong:
                wrong = list(self.written(done))
            for check, text in wrong:
                yield check, f"{' '.join(args)}: {text}"
            if good is None:
                good = done.code == 0
                self.tally["good"] = self.tally.get("good", 0) + good
            whole = args[0] in ("info", "modes") or self.case.kind in ("study", "result")  # of models the others look at a part
            if not good and whole and done.code in (0, 1) and not wrong:
                yield "agree", f"{' '.join(args)}: done, though \"check\" refuses the file"
            if good and done.code == 2 and re.search(rf"{re.escape(self.case.target)}:\d+:\d+: error|^modetune: error: ", done.err, re.M) and not ABOUT_BOTH.search(done.err):
                yield "agree", f"{' '.join(args)}: refused, though \"check\" finds nothing: {done.said()}"

    def judge(self, done):
        if done.slow and done.slow != "interrupted":
            yield "stuck", done.slow
            return
        if done.code < 0 or done.code not in CODES or (done.code == 130 and not done.slow):
            yield "crash", f"exit code {done.code}: {done.said()}"
            return
        if "Sanitizer" in done.err or "runtime error" in done.err:
            yield "crash", f"a sanitizer's report: {done.said()}"
            return
        if "internal error" in done.err:
            yield "internal", done.said()
        if done.code >= 2 and "error: " not in done.err and done.code != 130:
            yield "silent", f"exit code {done.code}, standard error: {done.said()}"
        if done.code == 4:
            if "memory" in done.err:
                self.tally["out of memory"] = self.tally.get("out of memory", 0) + 1
            elif not re.search(r"No such file|Is a directory|Permission denied|not a regular file|cannot be read|Not a directory|File name too long", done.err):
                yield "system", done.said()
        if done.code == 2:
            yield from self._place(done)
        yield from self._words(done.args[0], without_program(done.out) + done.err)
        yield from self._form(done)

    def _place(self, done):
        """A fault of a file has its line, its column, and its place in the document."""
        found = list(PLACE.finditer(done.err))
        if not found and not ABOUT_BOTH.search(done.err) and not ITEM.search(done.err):
            yield "place", f"no file, line and column: {done.said()}"
        for match in found:
            name = os.path.normpath(match["file"])
            text = self.case.files.get(name)
            if text is None:
                yield "place", f"{name} is none of the files: {done.said()}"
                return
            lines = re.split(rb"\r\n|\r|\n", text if isinstance(text, bytes) else text.encode("utf-8", "surrogateescape"))
            line, column = int(match["line"]), int(match["column"])
            if not 1 <= line <= len(lines) or not 1 <= column <= len(lines[line - 1]) + 1:
                yield "place", f"{match.group(0)} is outside of the file"
                return
            once = "is given twice" not in done.err  # else a pointer may lead into the first of two, which the tree has not
            if once and match["pointer"] and name == self.case.target and self.tree is not None and not document.resolves(self.tree, match["pointer"]):
                yield "place", f"the document has no {match['pointer']}: {done.said()}"
                return

    def _words(self, where, text):
        found = None if self.shows_words else WORD.search(text)
        if found:
            yield "words", f"{where}: ...{text[max(0, found.start() - 80):found.end() + 40]!r}..."

    def _form(self, done):
        """What is printed is whole, in its form."""
        if done.code == 2 and done.out and done.args[0] in ("run", "report", "apply", "mac"):
            yield "form", f"refused, and printed all the same: {done.out[:200]!r}"
        if len(done.bytes) >= MOST_OUTPUT:
            yield "form", "endless output"
        if done.form() == "json" and (done.out or done.code in (0, 1)):
            try:
                json.loads(done.out, parse_constant=lambda word: 1 / 0)
            except (ValueError, ZeroDivisionError, RecursionError) as why:
                yield "form", f"standard output is no JSON ({why!r}): {done.out[:200]!r}"
        if done.form() == "csv" and done.out and done.args[0] not in ("run", "compare"):
            yield from self._table(done.out)

    def _table(self, text):
        for part in re.split(r"\n\n+", text.strip("\n")):
            widths = {len(row) for row in csv.reader(part.splitlines(keepends=True))}
            if len(widths) > 1:
                yield "form", f"rows of {sorted(widths)} cells: {part[:200]!r}"
                return

    def _files(self):
        return {str(p.relative_to(self.folder)) for p in self.folder.rglob("*") if p.is_file()}

    def left(self, done, before):
        """Files come from "run" alone, and only where it answered."""
        new = self._files() - before - {"stdout", "stderr"}
        if done.args[0] == "run" and done.code in (0, 1, 130):
            new -= {f"out/changed/{n}" for n in ("result.json", "recommendations.csv", "report.html", "trade.csv", "curves.csv", "timing.json")}
        if new:
            yield "left", f"exit code {done.code}, and files that do not belong there: {sorted(new)[:5]}"

    def written(self, done):
        """What was written is whole, and the program itself takes it back."""
        out = self.folder / "out/changed"
        for name in ("result.json", "recommendations.csv", "report.html", "trade.csv", "curves.csv"):
            path = out / name
            if path.exists():
                yield from self._words(name, without_program(path.read_text(encoding="utf-8", errors="replace")))
            elif name not in ("trade.csv", "curves.csv"):
                yield "left", f"{name} is missing"
                return
        try:
            result = json.loads((out / "result.json").read_text(encoding="utf-8"), parse_constant=lambda word: 1 / 0)
        except (ValueError, ZeroDivisionError) as why:
            yield "form", f"result.json: {why!r}"
            return
        if not (out / "report.html").read_text(encoding="utf-8", errors="replace").endswith("</html>\n"):
            yield "form", "report.html has no end"
        rows = list(csv.reader((out / "recommendations.csv").read_text(encoding="utf-8", errors="replace").splitlines(keepends=True)))
        if len({len(row) for row in rows}) != 1:
            yield "form", "recommendations.csv is not rectangular"
        for args in (["check", "out/changed/result.json", "--root", "."], ["report", "out/changed/result.json", "--format", "json"], *([["apply", "out/changed/result.json", "--root", "."]]
                     if result.get("recommendations") and result["variables"] else [])):
            back = self.do(args)
            yield from ((check, f"then {' '.join(args)}: {text}") for check, text in self.judge(back))
            if back.code:
                yield "back", f"then {' '.join(args)}: exit code {back.code}: {back.said()}"

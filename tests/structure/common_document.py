# SPDX-License-Identifier: GPL-3.0-or-later
"""
What tests of pages share: a page is walked from its top in a folder, and what it shows must be what happens.
- A block ```json after <!-- file: NAME --> is written to NAME, after <!-- anew: NAME --> in place of what is there.
- A block ```json after <!-- add: NAME --> is a part of a model: added to NAME (lists grow, objects gain members), which then passes
  `modetune check` without a warning. After <!-- ask: NAME --> it is a part of a study: its members take the place of NAME's (null: none),
  and the study that comes of it is run from few starts, and answered (exit status 0, or what <!-- ask: NAME, exit: N --> says). NAME stays what it is.
- A block ```json after <!-- of: NAME --> shows members of NAME as they are there.
- A block ```diff after <!-- edit: NAME --> changes NAME: its lines without "+" stand there once, those without "-" come instead.
- A block ```console holds commands after "$ " and what they print, which must be what the program prints now, except that
  numbers may differ by two units of their last digit or the tenth, rounding noise by itself, columns by their width, and
  times altogether.
  After <!-- only: REGEX | REGEX --> of each output only those paragraphs are shown whose first line one of them matches,
  with "..." for others. After <!-- exit: N --> the last command ends with this status; else with 0, or 1 (goals are missed).
"""
import json
import os
import re
import subprocess
from decimal import Decimal, InvalidOperation

NOISE = 1e-9  # numbers below this are rounding: residuals of goals that are met
SEARCHED = 1e-9  # of a number with all its digits: how far searches go
LAST_DIGITS = 2
LEFT_OUT = "..."
PIXEL = 0.25
BLOCK = re.compile(r"(?:^<!-- (?P<mark>file|anew|edit|add|ask|of|only|exit): (?P<value>[^\n]*?) -->\n)?^```(?P<kind>json|diff|console)\n(?P<body>.*?)^```$", re.M | re.S)
# How long it took is of another day, how many evaluations of another processor.
TIMES = re.compile(r"^(\S+): [0-9.e+-]+ s, .*; (written to \S+)$")
# Of a mode, how well it was computed is rounding.
ROUNDING = re.compile(r"^( +(?:\d+|-)  (?:flexible|rigid body) +\S+(?:  +\S.*?)?) +\S+ +\S+$")
PROGRESS = re.compile(r"^(?:\S+: )?[a-z ]+: \d+ of \d+ .*, \d+ designs evaluated$")


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
    return abs(a[0] - b[0]) <= max(NOISE, SEARCHED * abs(a[0]), (LAST_DIGITS + 1e-6) * a[1])


def same_line(want, got):
    a, b = TIMES.match(want), TIMES.match(got)
    if a and b:
        return a.groups() == b.groups()
    a, b = (ROUNDING.sub(r"\1", line).split() for line in (want, got))
    return len(a) == len(b) and all(map(same_token, a, b))


def steps(body):
    """What stands before the first command, and pairs of command and output."""
    parts = re.split(r"^\$ (.*)\n", body, flags=re.M)
    return parts[0], list(zip(parts[1::2], parts[2::2]))


def only(text, patterns):
    """The paragraphs whose first line matches one of the patterns; all where there are none."""
    if not patterns:
        return text
    shown = []
    for paragraph in re.split(r"\n\n+", text.strip("\n")):
        if any(re.search(p, paragraph.split("\n")[0]) for p in patterns):
            shown.append(paragraph)
        elif shown[-1:] != [LEFT_OUT]:
            shown.append(LEFT_OUT)
    return "\n\n".join(shown) + "\n"


def edited(text, body):
    """The text with the change made; None where what it changes is not there, or more than once."""
    lines = body.splitlines()
    old, new = ("".join(line[1:] + "\n" for line in lines if line[:1] != sign) for sign in "+-")
    if not old or any(line[:1] not in (" ", "+", "-") for line in lines) or ("\n" + text).count("\n" + old) != 1:
        return None
    return ("\n" + text).replace("\n" + old, "\n" + new)[1:]


def merged(base, part):
    """A model with a part added: lists grow, objects gain members, anything else is replaced."""
    if isinstance(base, dict) and isinstance(part, dict):
        return {**base, **{key: merged(base[key], value) if key in base else value for key, value in part.items()}}
    return base + part if isinstance(base, list) and isinstance(part, list) else part


def replaced(base, part):
    """A study with other members in place of its own; null takes one away."""
    return {key: value for key, value in {**base, **part}.items() if value is not None}


class Walk:
    """A page walked in a folder: `wrong` says what is not as it shows, `files` what it wrote, `now` is the page as it should be."""

    def __init__(self, text, folder, program, talk=False):
        self.folder, self.place, self.program, self.talk = folder, folder, program, talk
        self.wrong, self.files, self.commands, self.parts = [], [], 0, 0
        self.now = BLOCK.sub(self.block, text)

    def run(self, command, status=None):
        """What it prints, after that, where talk is shown, what it says on standard error. Folders stay entered."""
        environment = dict(os.environ, PATH=f"{self.program.parent}:{os.environ['PATH']}")
        where = self.folder / ".where"
        # a pipe must read all: a program that is cut off reports it, and the command counts as failed
        done = subprocess.run(["bash", "-o", "pipefail", "-c", f'{command}\nstatus=$?; pwd > "{where}"; exit $status'], cwd=self.place,
                              env=environment, capture_output=True, text=True, check=False)
        self.place = where.read_text(encoding="utf-8").strip()
        where.unlink()
        errors = "error:" in done.stderr
        if done.returncode not in ((0, 1) if status is None else (status,)) or errors != (status is not None and status > 1):
            self.wrong.append(f"$ {command}\nends with {done.returncode}\n{done.stderr}")
        said = [line for line in done.stderr.splitlines() if not PROGRESS.match(line)]
        return done.stdout, "".join(line + "\n" for line in said) if self.talk else ""

    def write(self, match):
        path = self.folder / os.path.relpath(self.place, self.folder) / match["value"]
        if match["mark"] != "edit":
            if path.exists() != (match["mark"] == "anew"):
                self.wrong.append(f"{match['value']} is there, and not written anew, or the other way round")
            text = match["body"]
        else:
            text = edited(path.read_text(encoding="utf-8"), match["body"])
        if text is None:
            self.wrong.append(f"what is changed is not in {match['value']}, or not once:\n{match['body']}")
            return
        path.write_text(text, encoding="utf-8")
        if path not in self.files:
            self.files.append(path)

    def part(self, match):
        """A part of a model is checked, one of a study run, each in what it belongs to."""
        name, _, status = match["value"].partition(", exit: ")
        self.parts += 1
        path = self.folder / name
        try:
            base, part = json.loads(path.read_text(encoding="utf-8")), json.loads(match["body"])
        except json.JSONDecodeError as error:
            self.wrong.append(f"a part of {name} is no JSON: {error}\n{match['body']}")
            return
        made = path.with_name("part.json")
        asks = match["mark"] == "ask"
        made.write_text(json.dumps((replaced if asks else merged)(base, part), indent=1), encoding="utf-8")
        command = ["run", made, "--quiet", "--starts", "3", "--proof", "0.1", "-o", self.folder / "parts"] if asks else ["check", made]
        done = subprocess.run([self.program, *command], capture_output=True, text=True, check=False)
        if done.returncode != int(status or 0) or "warning:" in done.stderr:
            self.wrong.append(f"{name} with this part ends with {done.returncode}\n{match['body']}{done.stdout}{done.stderr}")
        made.unlink()

    def excerpt(self, match):
        """What is shown of a file is what it has."""
        self.parts += 1
        whole, shown = json.loads((self.folder / match["value"]).read_text(encoding="utf-8")), json.loads("{" + match["body"] + "}")
        self.wrong += [f"{match['value']} has another {key}: {whole.get(key)}" for key in shown if shown[key] != whole.get(key)]

    def block(self, match):
        """The block as it should be; what is wrong with it is noted."""
        if match["mark"] == "of":
            self.excerpt(match)
        if match["mark"] in ("add", "ask"):
            self.part(match)
        if match["mark"] in ("file", "anew", "edit"):
            self.write(match)
        if match["kind"] != "console":
            return match[0]
        before, pairs = steps(match["body"])
        if before:
            self.wrong.append(f"a console block begins with a command, not with\n{before}")
        now, known = [], len(self.wrong)
        for i, (command, want) in enumerate(pairs):
            self.commands += 1
            last = match["mark"] == "exit" and i + 1 == len(pairs)
            out, said = self.run(command, int(match["value"]) if last else None)
            patterns = match["value"].split(" | ") if match["mark"] == "only" else []
            got = "".join(part.rstrip("\n") + "\n" for part in (only(out, patterns), said) if part.strip())
            now.append(f"$ {command}\n{got}")
            if "|" in command and not got.strip():
                self.wrong.append(f"$ {command}\nshows nothing")
            a, b = want.rstrip("\n").splitlines(), got.splitlines()
            if len(a) != len(b):
                self.wrong.append(f"$ {command}\nnow prints {len(b)} lines, not {len(a)}:\n{got}")
            self.wrong += [f"$ {command}\n  page: {x}\n  now:  {y}" for x, y in zip(a, b) if not same_line(x, y)]
        return match[0] if len(self.wrong) == known else match[0].replace(match["body"], "".join(now))


def anchor(heading):
    """What a link to a heading says behind "#"."""
    return re.sub(r"[^\w -]", "", heading.lstrip("# ").lower()).replace(" ", "-")


def anchors(text):
    """What links to the headings of a page may say; of equal headings the second is "-1", the third "-2"."""
    seen, names = {}, set()
    for heading in re.findall(r"^#+ .*$", BLOCK.sub("", text), re.M):
        name = anchor(heading)
        names.add(f"{name}-{seen[name]}" if name in seen else name)
        seen[name] = seen.get(name, 0) + 1
    return names


def links_to_nowhere(text, folder):
    """Those links of a page that lead nowhere from its folder: no such file, or no such heading in it."""
    wrong = []
    for name, mark in re.findall(r"\]\((?!https?:)([^)#\s]*)(?:#([^)\s]*))?\)", text):
        path = folder / name
        if not path.exists():
            wrong.append(name)
        elif mark and mark not in anchors(path.read_text(encoding="utf-8") if name else text):
            wrong.append(f"{name}#{mark}")
    return wrong


def same_picture(a, b):
    """The same elements, with the same texts, and no place more than a part of a pixel away."""
    parts = [re.split(r"(-?\d+(?:\.\d+)?)", text) for text in (a, b)]
    return len(parts[0]) == len(parts[1]) and all(
        x == y or (i % 2 == 1 and abs(float(x) - float(y)) <= PIXEL) for i, (x, y) in enumerate(zip(*parts)))

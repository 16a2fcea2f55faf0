#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Names, titles, units, sources, arguments and file names that a terminal obeys, a browser runs or a spreadsheet computes.

Every shipped study and model is run as two twins that differ in their free texts only: harmless words in one, hostile ones in the other. What the program says of
both must be the same but for these texts, which are shown escaped: no control character leaves the program, no line, no cell and no tag is made by a name.
Each round takes every 48th file and half of the names and arguments, with MT_EVERY=1 every eighth, and shifts the hostile texts: MT_EVERY=1 and --count 8 take all.
The command line is that of every campaign (tests/support/campaign.py).
"""
import copy
import csv
import html.parser
import io
import json
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import unicodedata
from pathlib import Path

from common_cli import MODEL, PROGRAM, SOURCE, study as two_springs  # first: it says where campaign is
import campaign
from suite import EVERY, FEW

HOSTILE = [
    "\x1b]0;owned\x07", "\x1b[2J\x1b[1;1H", "\x9b31m", "\x90q\x9c", "\x7f\x08\x08", "a\nmodetune: error: forged", "a\r\nb", "a\rb", "\u202eesrever\u202c",
    "\u2066x\u2069", "z\u200bw\u200d\ufeff", "l\u2028p\u2029", "\U000e0041", "soft\u00adhyphen", "\t=1", "=1+1", "=HYPERLINK(\"http://x\",\"y\")",
    "+cmd|' /C calc'!A0", "-2+3", "@SUM(A1)", "\uff1d1", "'=1", " =1", "\"quoted\",and,commas", "<script>alert(1)</script>", "\" onmouseover=\"x", "' x='",
    "</title></h1></svg></style>", "--><!--", "&lt;b&gt;", "<![CDATA[", "%s%n%d", "\\u001b", "\u6f22\u5b57", "e\u0301\u0302", "nan", "inf", "null", "long" * 700,
]
FREE = {"description", "source", "label"}
SLOW = {"inceptor_identification", "inceptor_rotor", "truss_72bar", "inceptor_trade"}  # more than half a second
DROPPED = {"sha256", "study_path", "solve_s"}
SHARE = 8 if EVERY else 48 if FEW else 24
LONG = 400  # texts beyond it may be cut somewhere


def hidden(character):
    """Is it a control or format character, which cannot be seen? After Unicode's own table, not the program's."""
    return unicodedata.category(character) in ("Cc", "Cf", "Zl", "Zp", "Cs", "Co", "Cn")


def visible(text):
    """As the program is to show it."""
    return "".join(c if not hidden(c) else "".join(f"\\u{int.from_bytes(u, 'big'):04x}" for u in units(c)) for c in text)


def units(character):
    code = character.encode("utf-16-be")
    return [code[i:i + 2] for i in range(0, len(code), 2)]


def is_number(cell):
    return re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", cell) is not None


def protected(text):
    begins = re.match(r"[ ']*[=+\-@\uff1d\uff0b\uff0d\uff20]", text)
    return "'" + text if begins and not is_number(text) else text


# ---- what no output may hold: each yields what is wrong ----

def raw_characters(data, crlf=False):
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as error:
        yield f"no UTF-8: {error}"
        return
    for i, c in enumerate(text):
        line_end = c == "\n" or (crlf and c == "\r" and text[i + 1:i + 2] == "\n")
        if hidden(c) and not line_end:
            yield f"raw {c!r} in {text[max(0, i - 30):i + 30]!r}"


def cells(text):
    rows = list(csv.reader(io.StringIO(text, newline=""), strict=True))
    if len({len(row) for row in rows}) > 1:
        yield f"rows of {sorted({len(row) for row in rows})} cells"
    for row in rows:
        for cell in row:
            if re.match(r"[ ]*[=+\-@\t\r\uff1d\uff0b\uff0d\uff20]", cell) and not is_number(cell):
                yield f"a formula: {cell!r}"


class Page(html.parser.HTMLParser):
    VOID = {"meta", "br", "link"}

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.tags, self.words, self.open, self.problems = [], [], [], []
        self.feed(text)
        self.close()
        if self.open:
            self.problems.append(f"not closed: {self.open}")

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, tuple(name for name, _ in attrs)))
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.tags.append((tag, tuple(name for name, _ in attrs)))

    def handle_endtag(self, tag):
        self.tags.append(("/" + tag, ()))
        if not self.open or self.open.pop() != tag:
            self.problems.append(f"</{tag}> closes nothing")

    def handle_data(self, data):
        self.words.append(data)

    def handle_comment(self, data):
        self.tags.append(("comment", ()))

    def unknown_decl(self, data):
        self.tags.append(("declaration", ()))


# ---- the twins ----

class Twins:
    """Texts by number: the harmless word of a place and the hostile one."""

    def __init__(self, shift):
        self.shift, self.pairs = shift, []

    def new(self):
        i = len(self.pairs)
        self.pairs.append((f"Text{i}q", f"{HOSTILE[(i + self.shift) % len(HOSTILE)]}#{i}"))
        return self.pairs[-1]

    def replace(self, text, make):
        """Harmless words by what make(hostile) gives."""
        return re.sub(r"Text(\d+)q", lambda m: make(self.pairs[int(m[1])][1]), text)


def twist(documents, twins):
    """Both twins of documents (name -> parsed JSON) that belong together: (harmless, hostile)."""
    names, modes = {}, {}  # of aircraft and of modes, which are referred to
    for document in documents.values():
        for name in document.get("modes", {}):
            modes.setdefault(name, twins.new())
        for craft in document.get("aircraft", []) if isinstance(document.get("aircraft"), list) else []:
            names.setdefault(craft["name"], twins.new())

    def walk(value, key, which):
        if isinstance(value, dict):
            return {modes[k][which] if key == "modes" and k in modes else k: walk(v, k, which) for k, v in value.items()}
        if isinstance(value, list):
            return [walk(v, key, which) for v in value]
        if isinstance(value, str):
            if key in ("aircraft", "name") and value in names:
                return names[value][which]
            if key == "mode" and value in modes:
                return modes[value][which]
            place = (key, value)
            if key in FREE or (key == "name" and place in titles):
                if place not in texts:
                    texts[place] = twins.new()
                return texts[place][which]
        return value

    texts, titles = {}, {("name", d["name"]) for d in documents.values() if "name" in d}
    titles |= {("name", x["name"]) for d in documents.values() for g in d.get("goals", []) for m in ("rotor", "machine")
               for x in ([g.get(m)] if isinstance(g.get(m), dict) else []) if "name" in x}
    return [{path: walk(d, "", which) for path, d in documents.items()} for which in (0, 1)]


class Hunt:
    def __init__(self, seed):
        self.seed, self.problems, self.runs = seed, [], 0

    def say(self, where, what):
        self.problems.append(f"{where}: {what}")

    def program(self, folder, *args):
        self.runs += 1
        done = subprocess.run([os.fsencode(PROGRAM), *[os.fsencode(a) for a in args]], cwd=folder, capture_output=True, timeout=600)
        if done.returncode < 0:
            self.say(args, f"ended by signal {-done.returncode}")
        return done

    def same(self, where, good, bad, twins, form):
        """What is said of the harmless and of the hostile twin."""
        for problem in list(raw_characters(bad, crlf=form == "csv"))[:3]:
            self.say(where, problem)
        good, bad = good.decode(), bad.decode("utf-8", "replace")
        if good.count("\n") != bad.count("\n") and form != "html":
            self.say(where, f"{bad.count(chr(10))} lines, {good.count(chr(10))} of the harmless twin")
        if form == "csv":
            for problem in list(cells(bad))[:3]:
                self.say(where, problem)
            rows = [[list(csv.reader(io.StringIO(t, newline="")))] for t in (good, bad)]
            wanted = [[protected(twins.replace(c, visible)) for c in row] for row in rows[0][0]]
            for want, got in zip(wanted, rows[1][0]):
                for w, g in zip(want, got):
                    if w != g and len(w) < LONG:
                        self.say(where, f"cell {g!r}, wanted {w!r}")
        elif form == "json" and good:
            try:
                self.same_json(where, json.loads(good), json.loads(bad), twins)
            except json.JSONDecodeError as error:
                self.say(where, f"no JSON: {error}: {bad[:200]!r}")
        elif form == "html":
            a, b = Page(good), Page(bad)
            if a.tags != b.tags:
                self.say(where, f"other tags: {[t for t in zip(a.tags, b.tags) if t[0] != t[1]][:2]}, {len(a.tags)} and {len(b.tags)}")
            for problem in b.problems:
                self.say(where, problem)
        else:
            self.same_text(where, good, bad, twins)

    def same_text(self, where, good, bad, twins):
        for g, b in zip(good.splitlines(), bad.splitlines()):
            want = re.sub(r"[ -]+", " ", twins.replace(g, visible)).strip()
            got = re.sub(r"[ -]+", " ", b).strip()
            if want != got and len(want) < LONG and not re.search(r"\d s, \d+ evaluations", want):
                self.say(where, f"{got!r}, wanted {want!r}")
                return

    def same_json(self, where, good, bad, twins):
        if isinstance(good, dict) and isinstance(bad, dict):
            names = [visible(twins.replace(k, str)) for k in good]
            if names != [visible(k) for k in bad]:
                self.say(where, f"members {list(bad)[:9]}, wanted {names[:9]}")
                return
            for (k, g), b in zip(good.items(), bad.values()):
                if k not in DROPPED:
                    self.same_json(f"{where}/{visible(k)}", g, b, twins)
        elif isinstance(good, list) and isinstance(bad, list) and len(good) == len(bad):
            for i, (g, b) in enumerate(zip(good, bad)):
                self.same_json(f"{where}/{i}", g, b, twins)
        elif isinstance(good, str) and isinstance(bad, str):
            want = visible(twins.replace(good, str))
            if want != visible(bad) and len(want) < LONG:
                self.say(where, f"{bad!r}, wanted {want!r}")
        elif good != bad:
            self.say(where, f"{bad!r}, wanted {good!r}")

    def both(self, where, folders, twins, args, form="text"):
        """Run the same on both twins; arguments may hold words of the harmless one."""
        args = [*args, "--format", form] if form != "text" else list(args)
        good = self.program(folders[0], *args)
        bad = self.program(folders[1], *[twins.replace(a, str) for a in args])
        where = f"{where}: {' '.join(args)}"
        if good.returncode != bad.returncode:
            self.say(where, f"exit status {bad.returncode}, {good.returncode} of the harmless twin: {bad.stderr.decode()[:300]}")
            return good
        self.same(where + " (stdout)", good.stdout, bad.stdout, twins, "json" if args[0] == "apply" else form)
        self.same(where + " (stderr)", good.stderr, bad.stderr, twins, "text")
        return good

    def files(self, where, folders, twins, name):
        for kind in ("result.json", "recommendations.csv", "trade.csv", "report.html"):
            paths = [folder / "results" / name / kind for folder in folders]
            if paths[0].exists():
                self.same(f"{where}: {kind}", paths[0].read_bytes(), paths[1].read_bytes(), twins, paths[0].suffix[1:])

    def study(self, path, shift, forms):
        twins, documents = Twins(shift), {}
        text = path.read_text(encoding="utf-8")
        model = (path.parent / json.loads(text)["model"]).resolve()
        for p in [path] + sorted(model.parent.glob("*.json")):
            if p == path or p == model or p.name in text or p.name == "aircraft.json":
                documents[p.relative_to(SOURCE)] = json.loads(p.read_text(encoding="utf-8"))
        with tempfile.TemporaryDirectory() as top:
            folders = self.lay_out(Path(top), documents, twins)
            name, given = path.stem, str(path.relative_to(SOURCE))
            form = next(forms)
            self.both(path.name, folders, twins, ["run", given], form)
            self.files(path.name, folders, twins, name)
            self.both(path.name, folders, twins, ["check", given], next(forms))
            if "published" in documents[path.relative_to(SOURCE)]:
                self.both(path.name, folders, twins, ["compare", given], "csv")
            result = f"results/{name}/result.json"
            if (folders[0] / result).exists() and (folders[1] / result).exists():
                self.both(path.name, folders, twins, ["check", result], next(forms))
                self.both(path.name, folders, twins, ["report", result], next(forms))
                self.both(path.name, folders, twins, ["show", result], "json")
                self.both(path.name, folders, twins, ["apply", result], "text")

    def lay_out(self, top, documents, twins):
        folders = [top / "harmless", top / "hostile"]
        for folder, docs in zip(folders, twist(documents, twins)):
            for name, document in docs.items():
                (folder / name).parent.mkdir(parents=True, exist_ok=True)
                (folder / name).write_text(json.dumps(document, ensure_ascii=False, indent=1), encoding="utf-8")
        return folders

    def model(self, path, shift, forms):
        twins = Twins(shift)
        document = json.loads(path.read_text(encoding="utf-8"))
        given = str(path.relative_to(SOURCE))
        with tempfile.TemporaryDirectory() as top:
            folders = self.lay_out(Path(top), {path.relative_to(SOURCE): document}, twins)
            configurations = list(json.loads((folders[0] / given).read_text(encoding="utf-8")).get("configurations", {}))
            for command in ("check", "info", "modes", "sensitivity"):
                self.both(path.name, folders, twins, [command, given], next(forms))
            self.both(path.name, folders, twins, ["show", given], "json")
            joints = [j["name"] for j in document.get("joints", []) if j["type"] in ("revolute", "prismatic")]
            if joints and configurations:
                self.both(path.name, folders, twins, ["sweep", given, "--drive", f"{joints[0]}=0:0.001:2", "-c", configurations[0]], next(forms))
            if document.get("sensors") and configurations:
                self.both(path.name, folders, twins, ["mac", f"{given}:{configurations[0]}", f"{given}:{configurations[-1]}"], next(forms))

    # ---- hostile words where none are allowed, and on the command line ----

    def line_by_line(self, where, data):
        """A complaint is lines of ours: none begins with what a name brought."""
        for problem in list(raw_characters(data))[:3]:
            self.say(where, problem)
        for line in data.decode("utf-8", "replace").splitlines():
            if not re.match(r"modetune: (error|warning): |Try \"modetune|\S*\.json: |\S*\.json:\d+:\d+: (error|warning|note): ", line):
                self.say(where, f"a line of its own: {line[:200]!r}")

    def broken(self, path, rng, count):
        text = path.read_text(encoding="utf-8")
        with tempfile.TemporaryDirectory() as top:
            for _ in range(count):
                document = json.loads(text)
                spoil(document, rng)
                file = Path(top) / "broken.json"
                file.write_text(json.dumps(document, ensure_ascii=rng.random() < 0.5), encoding="utf-8")
                done = self.program(top, "check", "broken.json")
                self.line_by_line(f"{path.name} spoilt (seed {self.seed})", done.stderr)
                self.line_by_line(f"{path.name} spoilt (seed {self.seed}), stdout", done.stdout)

    def arguments(self):
        model = "tests/models/pendulum.json"
        shapes = [["{}"], ["run", "{}"], ["modes", model, "-c", "{}"], ["modes", model, "--set", "{}=1"], ["modes", model, "--set", "m={}"],
                  ["sweep", model, "--drive", "{}"], ["sweep", model, "--drive", "{}=0:1:2"], ["mac", model + ":{}", model], ["modes", "--{}", model],
                  ["modes", model, "--format", "{}"], ["modes", model, "--count", "{}"], ["check", "{}.json"], ["apply", "{}", "--model", "{}"],
                  ["modes", model, "--root", "{}"], ["sensitivity", model, "--parameters", "{}"], ["diff", "{}", "{}"],
                  ["diff", model, model, "--rel-tol", "{}"]]
        for i, word in enumerate(HOSTILE):
            for shape in (shapes[i % len(shapes)], shapes[(3 * i + 1) % len(shapes)])[:1 if FEW else 2]:
                args = [a.format(word) for a in shape]
                done = self.program(SOURCE, *args)
                for stream in (done.stdout, done.stderr):
                    for problem in list(raw_characters(stream))[:2]:
                        self.say(args, problem)
                if any(line.startswith("modetune: error: forged") for line in done.stderr.decode("utf-8", "replace").splitlines()):
                    self.say(args, "a forged line")

    def file_names(self):
        """Files with such names are read and written as they are, and shown escaped. The names are bytes."""
        names = [b"\x1b]0;x\x07", b"a\nb", b"=1+1", b"\xff\xfe", "\u202eb".encode(), b"<b>&\"'", b" ", b"\xc2\x9b", "gr\u00f6\u00dfe".encode()]
        study = json.loads(two_springs(extra=', "search": { "starts": 1 }'))
        with tempfile.TemporaryDirectory() as top:
            top = os.fsencode(top)
            for name in names[1::2] if FEW else names:
                folder = os.path.join(top, b"d" + name)
                os.makedirs(folder)
                given = copy.deepcopy(study)
                given["model"] = os.fsdecode(name) + "m.json"
                if any(0xDC80 <= ord(c) <= 0xDCFF for c in given["model"]):  # no JSON can name it
                    given["model"] = "m.json"
                Path(os.fsdecode(folder), given["model"]).write_text(MODEL, encoding="utf-8")
                given.pop("name", None)
                with open(os.path.join(folder, name + b".json"), "w", encoding="utf-8") as file:
                    json.dump(given, file)
                out = os.path.join(folder, b"out" + name)
                done = self.program(top, "run", os.path.join(folder, name + b".json"), "-o", out)
                kept = os.path.join(out, name, b"result.json")
                if not os.path.exists(kept):
                    self.say(name, f"is not there: {kept} ({done.stderr})")
                csv_out = self.program(folder, "check", "--format", "csv", name + b".json").stdout
                for problem in list(raw_characters(csv_out, crlf=True)) + list(cells(csv_out.decode())):
                    self.say(name, problem)
                twin = os.path.join(folder, b"twin" + name + b".json")
                shutil.copy(os.path.join(folder, name + b".json"), twin)
                both = self.program(top, "run", os.path.join(folder, name + b".json"), twin, os.path.join(folder, b"none" + name), "-o", out)
                index = Path(os.fsdecode(out)) / "index.html"
                for problem in Page(index.read_text(encoding="utf-8")).problems if index.exists() else ["no index"]:
                    self.say(name, f"index.html: {problem}")
                told = self.program(top, "diff", kept, os.path.join(out, b"twin" + name))
                log = self.program(folder, "check", "--format", "sarif", b"none" + name).stdout
                if len(json.loads((index.parent / "index.json").read_text(encoding="utf-8"))["studies"]) != 3 or not json.loads(log)["runs"][0]["results"]:
                    self.say(name, "is not told")
                for data in (both.stdout, both.stderr, told.stdout, log, done.stdout, done.stderr, self.program(top, "check", kept).stdout, self.program(top, "check", folder + b"/none").stderr):
                    for problem in raw_characters(data):
                        self.say(name, problem)
                    if data.count(b"\nb") > 0:
                        self.say(name, "a name makes a line")


def spoil(document, rng):
    """Put a hostile word where a name, a choice, a number or a member stands."""
    places = []

    def collect(value):
        for k, v in value.items() if isinstance(value, dict) else enumerate(value):
            places.append((value, k))
            if isinstance(v, (dict, list)):
                collect(v)

    collect(document)
    for _ in range(3):
        at, key = rng.choice(places)
        word = rng.choice(HOSTILE)
        if isinstance(at, dict) and rng.random() < 0.4:
            at[word] = at.pop(key, 1)
        elif isinstance(at, dict) or key < len(at):
            at[key] = word


def self_test():
    """Each fault is planted and seen."""
    faults = [list(raw_characters(b"a\x1b[2J")), list(raw_characters("\u202e".encode())), list(raw_characters(b"\xff")), list(raw_characters("\x9b".encode())),
              list(raw_characters(b"a\r\n")), list(cells("a,b\r\n1\r\n")), list(cells("a\r\n=1\r\n")), list(cells("a\r\n-x\r\n")), Page("<p><b></p>").problems]
    page = Page("<p>x<script>y</script></p>").tags != Page("<p>x&lt;script&gt;y</p>").tags
    hunt, twins = Hunt(0), Twins(0)
    word = twins.new()[0]
    hunt.same("", f"{word}\n".encode(), b"a\nb\n", twins, "text")
    hunt.same("", f"{word}\r\n".encode(), b"other\r\n", twins, "csv")
    hunt.same("", f'{{"a": "{word}"}}'.encode(), b'{"a": "x"}', twins, "json")
    hunt.line_by_line("", b"modetune: error: x\nforged\n")
    fine = list(raw_characters(b"a\tb\n".replace(b"\t", b" "))) + list(cells("a\r\n-1.5e-3\r\n"))
    return ["self-test: a planted fault is not seen"] if not all(faults) or not page or len(hunt.problems) < 4 or fine else []


def forms_from(rng):
    while True:
        yield rng.choice(["text", "json", "csv"])


class HostileTexts(campaign.Generator):
    """Round I of seed S draws from seed S + I."""
    script, cases, count, tallied = "tests/cli/test_hostile_text.py", "rounds", 1, ("runs",)

    def __init__(self):
        self.rounds, self.spoilt = 1, 2

    def options(self, parser):
        parser.add_argument("--spoilt", type=int, default=self.spoilt, help="spoilt documents of each file")

    def asked(self, args):
        self.rounds, self.spoilt = args.count, args.spoilt
        return ["--count", str(args.count), "--spoilt", str(args.spoilt)]

    def make(self, seed, kind, index):
        number = int(seed) + index
        return campaign.Case(kind, {"round": number}, random.Random(number), f"seed {number}: ")

    def judge(self, case, folder, tally):
        number, rng = case.document["round"], case.rng
        hunt, forms = Hunt(number), forms_from(rng)
        hunt.arguments()
        hunt.file_names()
        files = [p for room in ("studies", "problems", "tests/models") for p in sorted((SOURCE / room).glob("*.json"))]
        for path in files[number % SHARE::SHARE]:
            shift = rng.randrange(len(HOSTILE))
            if path.parent.name == "studies" and (path.stem not in SLOW or self.rounds > 1):
                hunt.study(path, shift, forms)
            elif path.parent.name != "studies" and path.name != "aircraft.json":
                hunt.model(path, shift, forms)
            hunt.broken(path, rng, self.spoilt)
        tally["runs"] += hunt.runs
        yield from (("text", problem[:600]) for problem in hunt.problems[:40])


if __name__ == "__main__":
    wrong = self_test()
    print("\n".join(wrong), end="\n" if wrong else "")
    sys.exit(campaign.main(HostileTexts()) or bool(wrong))

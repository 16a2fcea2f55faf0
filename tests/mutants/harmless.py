# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes that mean nothing: what every command answers is the same, to the last digit. Each takes (rng, {place: tree}) and changes the trees."""
import json
import re
from decimal import Decimal

import document
from document import Number, Object

MARK = "zq_"  # before every name: a name of no shipped file, and one that keeps their order
MAPS = ("parameters", "configurations", "modes", "references", "shape")  # the order of their members is that of the answer's lists
RESERVED = ("ground", "default", "original", "recommended")
NO_NAMES = ("directions", "file", "type", "minimise", "status", "dimension", "model", "aircraft", "series", "orders", "design", "kind", "by", *document.FREE)
NAMED = ("bodies", "links", "joints", "springs", "dampers", "loads", "sensors")
PLACES = ("sha256", "line", "column", "pointer", "file")


def tame(tree, kind):
    """A mutated study keeps a budget that ends, a link few elements: that a search may be long and a matrix large is no finding."""
    for path, key, value in list(document.nodes(tree)):
        if key == "elements" and isinstance(value, Number) and 30 < float(value) <= 100_000:
            document.put(tree, path, Number("30"))
        if kind == "study" and key == "search" and isinstance(value, Object):
            for pair in value:
                if pair[0] in ("starts", "max_evaluations") and isinstance(pair[1], Number) and abs(float(pair[1])) > 1000:
                    pair[1] = Number("1000")


def members(rng, trees):
    """Members in another order, but of the lists of names."""
    for tree in trees.values():
        for _, key, value in [((), None, tree), *document.nodes(tree)]:
            if isinstance(value, Object) and not (key in MAPS and not any(k == "type" for k, _ in value)):
                rng.shuffle(value)


def _exact(text):
    """The same number, spelt otherwise."""
    value = Decimal(text)
    if not value:
        return [text + ".000" if text.lstrip("-").isdigit() else text, f"{'-' if value.is_signed() else ''}0e7"]
    digits, exponent = str(value.as_tuple().digits).replace(", ", "").strip("(,)"), value.as_tuple().exponent
    return [f"{'-' if value.is_signed() else ''}{digits}.0e{exponent}", f"{'-' if value.is_signed() else ''}{digits}00E{exponent - 2:+03d}",
            f"{value:f}" + ("" if "." in f"{value:f}" else ".000")]


def spelling(rng, trees):
    for tree in trees.values():
        for path, _, value in list(document.nodes(tree)):
            if isinstance(value, Number) and rng.random() < 0.7:
                document.put(tree, path, Number(rng.choice(_exact(value))))


def expressions(rng, trees):
    """Sizes as expressions that are these very numbers; not of parameters, which then are none of their own."""
    for tree in trees.values():
        for path, key, value in list(document.nodes(tree)):
            within = tree[path[0]][0]
            if isinstance(value, Number) and "." in value and within in ("bodies", "springs", "goals", "variables") \
                    and key not in ("at", "centre", "speed_rpm"):  # where a point mass may be held is told by its text
                document.put(tree, path, rng.choice((str(value), f"({value})", f" {value} ", f"1*({value})", f"({value})/1")))


def comments(rng, trees):
    """Text for people."""
    for tree in trees.values():
        for path, key, value in list(document.nodes(tree)):
            if key in ("description", "source") and isinstance(value, str):
                document.put(tree, path, "something else: \u00e4 <b> \"x\" {}")
        tree.drop("$schema")
        tree.insert(0, ["description", "new"]) if tree.get("description") is None else None


def unused(rng, trees):
    """A parameter that nothing is made of."""
    for tree in trees.values():
        parameters = tree.get("parameters")
        if isinstance(parameters, Object):
            parameters.append([f"{MARK}unused", Number("3")])


def _names(tree):
    found = {value for key in NAMED for item in tree.get(key) or [] for k, value in item if k == "name"}
    for key in ("parameters", "points", "configurations", "modes", "references", "measurements"):
        found |= {k for k, _ in tree.get(key) or []}
    return found - set(RESERVED)


def _renamed(text, names, pattern=False):
    """A name, with what follows a dot; a pattern of names; or an expression of names."""
    if text in names or text.split(".")[0] in names or (pattern and text[0] not in "*?["):
        return MARK + text
    return re.sub(r"(?<![\w.])[A-Za-z_]\w*", lambda m: MARK + m[0] if m[0] in names else m[0], text)


def rename(rng, trees):
    """Every name, wherever it stands."""
    names = set().union(*(_names(tree) for tree in trees.values()))
    for tree in trees.values():
        for path, key, value in list(document.nodes(tree)):
            if isinstance(value, str) and not isinstance(value, Number) and (key not in NO_NAMES or (key == "name" and path[0] is not None and len(path) > 2)):
                document.put(tree, path, _renamed(value, names, key == "of"))
        for _, key, value in [((), None, tree), *document.nodes(tree)]:
            if isinstance(value, Object) and key in ("parameters", "points", "configurations", "modes", "references", "measurements", "shape"):
                for pair in value:
                    pair[0] = _renamed(pair[0], names) if pair[0] in names or pair[0].split(".")[0] in names else pair[0]


CHANGES = {"members": members, "spelling": spelling, "expressions": expressions, "comments": comments, "unused": unused, "rename": rename, "space": None}


def _clean(value):
    """Without what tells where something stands, or what a file's text was."""
    if isinstance(value, dict):
        return {k: _clean(v) for k, v in value.items() if k not in PLACES and k not in ("description", "source", "expression", "warnings", "text")
                and not k.startswith(MARK)}
    if isinstance(value, list):
        return [_clean(v) for v in value if not (isinstance(v, dict) and str(v.get("parameter", v.get("name"))).startswith(MARK))]
    return re.sub(r"[\w./]+\.json:\d+:\d+: ", "", value) if isinstance(value, str) else value


def _answers(program, case, folder, command, change):
    case.write(folder)
    done = program.run(folder, command)
    text = (folder / "out/changed/result.json").read_text(encoding="utf-8") if command[0] == "run" and done.code in (0, 1) else done.out
    if change == "rename":
        text = text.replace(MARK, "")
    try:
        return done, _clean(json.loads(text)) if text else None
    except ValueError:
        return done, text


def _different(a, b, path=""):
    """The first place where two answers differ."""
    if isinstance(a, dict) and isinstance(b, dict) and a.keys() == b.keys():
        return next((d for k in a if (d := _different(a[k], b[k], f"{path}/{k}"))), None)
    if isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
        return next((d for i, (x, y) in enumerate(zip(a, b)) if (d := _different(x, y, f"{path}/{i}"))), None)
    return None if a == b else f"{path}: {str(a)[:150]} and {str(b)[:150]}"


def _commands(case):
    file = case.target
    if case.kind == "study":
        yield ["run", file, "-o", "out", "--quiet"]
        return
    yield ["info", file, "--format", "json"]
    yield ["modes", file, "--format", "json", "--shapes", "--damped", "--count", "all"]
    yield ["sensitivity", file, "--format", "json"]
    yield ["response", file, "--input", "base.x", "--points", "5", "--format", "json"]


def changed(rng, case, change):
    """The case's files with the change, as text."""
    places = [place for place in case.files if place in (case.target, "problems/changed.json") or (case.kind == "study" and place.startswith("problems/"))]
    trees = {place: document.read(case.files[place]) for place in places if "aircraft" not in place and place.endswith(".json")}
    tables = {place: text for place, text in case.files.items() if place.endswith(".csv")} if change == "rename" else {}
    names = set().union(*(_names(tree) for tree in trees.values()))
    if CHANGES[change] is not None:
        CHANGES[change](rng, trees)
    texts = {place: document.write(tree, rng.choice((None, 1, 4))) for place, tree in trees.items()}
    if change == "space":
        texts = {place: text.replace("\n", rng.choice(("\r\n", "\n\n\t"))) + rng.choice(("", " ", "\n\n")) for place, text in texts.items()}
    for place, text in tables.items():  # names of ports
        texts[place] = re.sub(r"(?m)(?<![\w.:])\w+(?=\.)", lambda m: MARK + m[0] if m[0] in names else m[0], text)
    return {**case.files, **texts}


def compare(program, rng, case, change, folder, tally):
    """(check, sentence) where a change makes a difference."""
    original, twin = case.files, changed(rng, case, change)
    for command in _commands(case):
        tally["commands"] += 2
        case.files = original
        before, expected = _answers(program, case, folder / "as_shipped", command, "")
        case.files = twin
        after, given = _answers(program, case, folder / "changed", command, change)
        where = f"{case.name} ({change}): {' '.join(command)}"
        if before.code != after.code:
            yield "harmless", f"{where}: exit codes {before.code} and {after.code}: {after.said()}"
        elif expected != given:
            yield "harmless", f"{where}: {_different(expected, given)}"

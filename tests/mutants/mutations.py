# SPDX-License-Identifier: GPL-3.0-or-later
"""Harm done to a document: by node, where the text stays JSON, and by byte. Each mutation takes (rng, tree, corpus) and changes the tree, or
returns False where it finds no place."""
import document
from document import Number, Object

NUMBERS = ["0", "-0.0", "1e-320", "5e-324", "-1e-320", "2.2250738585072014e-308", "1e-200", "1e-18", "-1", "1", "2", "3", "0.5", "1e15", "-1e15",
           "1e16", "1e100", "1e200", "1e308", "-1e308", "1.7976931348623157e308", "1e309", "-1e400", "1e-400", "2147483647", "2147483648",
           "-2147483649", "4294967296", "9007199254740993", "18446744073709551616", "1.5", "100000", "1000", "64", "65",
           "0." + "3" * 400, "1" + "0" * 300, "123456789012345678901234567890"]
TEXTS = ["", " ", "nan", "NaN", "inf", "-inf", "Infinity", "1e999", "0/0", "1/0", "0x10", "1,5", "ground", "*", "?", "[", "../" * 40 + "etc/passwd", "/dev/zero",
         "/dev/null", ".", "..", "a/../b", "mode", "default", "x.y", "\u0000", "a\u0000b", "\u001b]0;x\u0007", "\u202e", "\ufeff", "\U0001F600", "\\", "\"", "%s%n%d",
         "<b>&amp;", "=1+1", "é" * 50, "q" * 5000]
UNITS = {"_hz": "_rpm", "_rpm": "_hz", "_m": "_n", "_n_per_m": "_n_m_per_rad", "_n_m_per_rad": "_n_per_m", "_percent": "", "_rad": "_m", "_kg": "_kg_m2",
         "_n": "_n_m", "_m2": "_m4", "_pa": "_n"}
FUNCTIONS = ("sqrt", "cbrt", "exp", "ln", "log10", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "abs")
PAIRS = ("atan2", "min", "max", "hypot")
DEEP = (3, 40, 300, 5000)


def _choose(rng, tree, wanted=lambda key, value: True):
    places = [(path, key, value) for path, key, value in document.nodes(tree) if wanted(key, value)]
    return rng.choice(places) if places else (None, None, None)


def _is_container(key, value):
    return isinstance(value, list)


def _is_text(key, value):
    return isinstance(value, str) and not isinstance(value, Number)


def _is_size(key, value):
    """A number, or what may be an expression."""
    return isinstance(value, Number) or (_is_text(key, value) and key not in document.FREE and "bodies" != key)


def delete(rng, tree, corpus):
    path, _, _ = _choose(rng, tree)
    if path is None:
        return False
    del document.at(tree, path[:-1])[path[-1]]
    return True


def duplicate(rng, tree, corpus):
    """An entry of a list again, or a member a second time: with the same name, or another."""
    path, _, value = _choose(rng, tree)
    if path is None:
        return False
    parent = document.at(tree, path[:-1])
    item = document.copy(value)
    if isinstance(parent, Object):
        item = [parent[path[-1]][0] + rng.choice(("", "_2", "x")), item]
    parent.insert(rng.randint(0, len(parent)), item)
    return True


def _put_elsewhere(rng, tree, same):
    one, _, a = _choose(rng, tree)
    other, _, b = _choose(rng, tree, lambda key, value: value is not a and (type(value) is type(a)) == same)
    if one is None or other is None or one == other[:len(one)] or other == one[:len(other)]:
        return False
    document.put(tree, one, b)
    document.put(tree, other, a)
    return True


def swap(rng, tree, corpus):
    return _put_elsewhere(rng, tree, True)


def swap_types(rng, tree, corpus):
    return _put_elsewhere(rng, tree, False)


def transplant(rng, tree, corpus):
    """What another shipped file has in a member of this name."""
    path, key, _ = _choose(rng, tree)
    if path is None or not corpus.values.get(key):
        return False
    document.put(tree, path, document.copy(rng.choice(corpus.values[key])))
    return True


def graft(rng, tree, corpus):
    """A member that is known somewhere, here."""
    path, _, value = _choose(rng, tree, lambda key, value: isinstance(value, Object))
    value = tree if path is None or rng.random() < 0.1 else value
    name = rng.choice(corpus.names)
    if isinstance(value, Object):
        value.insert(rng.randint(0, len(value)), [name, document.copy(rng.choice(corpus.values[name]))])
    return isinstance(value, Object)


def rename(rng, tree, corpus):
    """A word becomes another one of the document, of the same member, or a misspelt one."""
    path, key, value = _choose(rng, tree, lambda key, value: _is_text(key, value) and key not in ("description", "source", "$schema"))
    if path is None:
        return False
    others = [v for _, k, v in document.nodes(tree) if _is_text(k, v) and (k == key or rng.random() < 0.05)]
    cut = rng.randint(0, len(value))
    document.put(tree, path, rng.choice(others + [value + "x", value[:cut], value[:cut] + value[cut + 1:]]))
    return True


def rename_member(rng, tree, corpus):
    path, _, value = _choose(rng, tree, lambda key, value: isinstance(value, Object) and value)
    value = tree if path is None or rng.random() < 0.2 else value
    if not isinstance(value, Object) or not value:
        return False
    pair = rng.choice(value)
    pair[0] = rng.choice([pair[0] + "_", pair[0][:-1], pair[0].upper(), rng.choice(corpus.names), rng.choice(value)[0], ""])
    return True


def unit(rng, tree, corpus):
    places = [(pair, suffix) for _, _, v in [((), None, tree), *document.nodes(tree)] if isinstance(v, Object) for pair in v for suffix in UNITS
              if pair[0].endswith(suffix)]
    if not places:
        return False
    pair, suffix = rng.choice(places)
    pair[0] = pair[0][:-len(suffix)] + UNITS[suffix]
    return True


def number(rng, tree, corpus):
    path, key, _ = _choose(rng, tree, _is_size)
    if path is None:
        return False
    document.put(tree, path, Number(rng.choice(NUMBERS)))
    return True


def scale(rng, tree, corpus):
    """A number that is still one, far from where it was."""
    path, _, value = _choose(rng, tree, lambda key, value: isinstance(value, Number))
    if path is None:
        return False
    document.put(tree, path, Number(repr(float(value) * 10.0 ** rng.choice((-12, -6, -3, -1, 1, 3, 6, 12)) * rng.choice((1, 1, -1)))))
    return True


def modest(rng, tree, corpus):
    """A number, or an expression of one, that a file may well have."""
    path, key, value = _choose(rng, tree, _is_size)
    if path is None:
        return False
    x = str(value)
    document.put(tree, path, rng.choice((Number("0"), Number("1"), Number("2"), Number("3"), Number("1e-9"), Number("-1"), Number("1e6"), f"({x})*1.1", f"-({x})", f"({x})/2",
                                         f"({x})*{rng.choice(_names(tree))}", grown(rng, _names(tree), 1))))
    return True


def text(rng, tree, corpus):
    path, _, _ = _choose(rng, tree, lambda key, value: not isinstance(value, list))
    if path is None:
        return False
    document.put(tree, path, rng.choice(TEXTS) if rng.random() < 0.97 else "z" * 300_000)
    return True


def empty(rng, tree, corpus):
    path, _, _ = _choose(rng, tree)
    if path is None:
        return False
    document.put(tree, path, rng.choice(([], Object(), "", None)))
    return True


def wrong_type(rng, tree, corpus):
    path, _, value = _choose(rng, tree)
    if path is None:
        return False
    document.put(tree, path, rng.choice((None, True, False, Number("1"), "x", [], Object(), [value], Object([["name", value]]), [[[]]], [Number("1")] * 7)))
    return True


def many(rng, tree, corpus):
    """A list many times as long."""
    path, _, value = _choose(rng, tree, lambda key, value: isinstance(value, list) and not isinstance(value, Object) and value)
    if path is None:
        return False
    value.extend(document.copy(rng.choice(value)) for _ in range(rng.choice((1, 3, 30, 300))))
    return True


def shuffle(rng, tree, corpus):
    path, _, value = _choose(rng, tree, _is_container)
    if path is None:
        return False
    rng.shuffle(value)
    return True


def deep(rng, tree, corpus):
    path, _, value = _choose(rng, tree)
    if path is None:
        return False
    for _ in range(rng.choice(DEEP[:3])):
        value = [value] if rng.random() < 0.5 else Object([["a", value]])
    document.put(tree, path, value)
    return True


def _names(tree):
    parameters = tree.get("parameters")
    names = [p[0] for p in parameters] if isinstance(parameters, Object) else []
    names += [v.get("parameter") for _, _, v in document.nodes(tree) if isinstance(v, Object) and isinstance(v.get("parameter"), str)]
    return names or ["k"]


def grown(rng, names, depth):
    """An expression from the grammar."""
    if depth == 0 or rng.random() < 0.2:
        return rng.choice(names) if rng.random() < 0.6 else rng.choice(("0", "1", "2", "-1", "0.5", "1e300", "1e-300", "pi", "e", "g", "deg", "rpm", "1e5"))
    a, b = grown(rng, names, depth - 1), grown(rng, names, depth - 1)
    return rng.choice((f"({a})", f"-({a})", f"({a}) + ({b})", f"{a} - {b}", f"({a})*({b})", f"({a})/({b})", f"({a})^({b})", f"({a})^2", f"({a})^0.5",
                       f"{rng.choice(FUNCTIONS)}({a})", f"{rng.choice(PAIRS)}({a}, {b})"))


def expression(rng, tree, corpus):
    path, key, value = _choose(rng, tree, _is_size)
    if path is None:
        return False
    n, names = rng.choice(DEEP), _names(tree)
    own = tree[path[0]][1][path[1]][0] if isinstance(tree, Object) and len(path) > 1 and tree[path[0]][0] == "parameters" \
        and isinstance(tree[path[0]][1], Object) else rng.choice(names)
    x = str(value)
    document.put(tree, path, rng.choice((
        "(" * n + x + ")" * n, "-" * n + x, "sqrt(" * n + x + ")" * n, "+".join([x] * n), "^".join(["1"] * n), "*".join([f"({x})"] * min(n, 300)),
        f"({x})/0", f"({x})/({rng.choice(names)}-{rng.choice(names)})", "0/0", "0^0", "0^-1", "(-1)^0.5", "ln(0)", "sqrt(-1)", "asin(2)", "exp(1000)", "1e308*10",
        own, f"2*{own}", f"{own}*{rng.choice(names)}", f"({x}", f"{x})", f"{x} {x}", f"{x}*", f"*{x}", f"{x}*1e-300", f"({x})*1e300", f"({x}) + 1e-9", f"{x}^2", f"{x},{x}",
        f"min({x}, 1)", f"abs({x})", f"hypot({x}, 0)", f"atan2({x}, 0)", "nothing(1)", "sin()", "max(1)", grown(rng, names, 2), grown(rng, names, 4),
        grown(rng, names, 4))))
    return True


BY_NODE = [delete, delete, duplicate, swap, swap_types, transplant, transplant, graft, graft, rename, rename, rename_member, unit, number, number, number, scale, scale,
           text, empty, wrong_type, many, shuffle, deep, expression, expression]


GENTLE = [delete, swap, scale, scale, scale, modest, modest, transplant, shuffle, duplicate]  # of which much is still a question


def by_bytes(rng, text_, others):
    """Harm below the level of JSON."""
    data = bytearray(text_.encode("utf-8", "surrogateescape"))
    for _ in range(rng.choice((1, 1, 1, 2, 8))):
        at, to = sorted((rng.randint(0, len(data)), rng.randint(0, len(data))))
        to = min(to, at + rng.choice((1, 8, 200)))
        how = rng.randrange(8)
        if how == 0:
            del data[at:]
        elif how == 1:
            del data[at:to]
        elif how == 2 and at < len(data):
            data[at] ^= 1 << rng.randrange(8)
        elif how == 3:
            data[at:at] = data[at:to]
        elif how == 4:
            data[at:at] = bytes(rng.choice((b"\0", b"\xff", b"\xc0\xaf", b"\xed\xa0\x80", b"\xef\xbb\xbf", b"{", b"}", b"[", b"]", b",", b":", b'"', b"\\", b"\n", b"\\u0000",
                                            b"\\ud800", b"//", b"NaN", b"1e", b"-", b"0", b"\x1b", b"\r", b"[" * 3000, b" " * 70000)))
        elif how == 5:
            other = rng.choice(others).encode("utf-8", "surrogateescape")
            data[at:to] = other[rng.randint(0, len(other)):][:rng.choice((5, 60, 600))]
        elif how == 6:
            line = bytes(data[:at]).rsplit(b"\n", 1)[-1] + bytes(data[at:]).split(b"\n", 1)[0]  # a line again: a member twice
            start = at - len(bytes(data[:at]).rsplit(b"\n", 1)[-1])
            data[start:start] = line + b"\n"
        else:
            data[:] = data[:at].replace(b"\n", rng.choice((b"\r\n", b"\r", b" "))) + data[at:]
    return bytes(data)

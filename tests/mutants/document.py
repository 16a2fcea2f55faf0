# SPDX-License-Identifier: GPL-3.0-or-later
"""JSON as trees that keep what the text says: the order of members, members given twice, the spelling of numbers."""
import json

FREE = ("name", "description", "source", "label", "unit", "$schema", "format", "type", "origin", "role", "confirmed")  # text for people, or a word of ours


class Number(str):
    """A number as it is spelt."""


class Object(list):
    """[name, value] pairs."""

    def get(self, name, default=None):
        return next((value for key, value in self if key == name), default)

    def put(self, name, value):
        for pair in self:
            if pair[0] == name:
                pair[1] = value
                return
        self.append([name, value])

    def drop(self, name):
        self[:] = [pair for pair in self if pair[0] != name]


def read(text):
    return json.loads(text, object_pairs_hook=lambda pairs: Object([list(p) for p in pairs]), parse_float=Number, parse_int=Number,
                      parse_constant=Number)


def write(value, indent=None, level=0):
    """Compact, or with members on lines of their own."""
    if isinstance(value, Number):
        return str(value)
    if isinstance(value, list):
        braces, parts = "[]", [write(v, indent, level + 1) for v in value] if not isinstance(value, Object) else None
        if parts is None:
            braces, parts = "{}", [f"{json.dumps(k)}: {write(v, indent, level + 1)}" for k, v in value]
        if indent is None or not parts or not isinstance(value, Object):
            return braces[0] + ", ".join(parts) + braces[1]
        inner = "\n" + " " * indent * (level + 1)
        return braces[0] + inner + f",{inner}".join(parts) + "\n" + " " * indent * level + braces[1]
    return json.dumps(value)


def plain(value):
    """As Python's own objects; of members given twice the last."""
    if isinstance(value, Object):
        return {k: plain(v) for k, v in value}
    if isinstance(value, list):
        return [plain(v) for v in value]
    return float(value) if isinstance(value, Number) else value


def copy(value):
    if isinstance(value, Object):
        return Object([[k, copy(v)] for k, v in value])
    return [copy(v) for v in value] if isinstance(value, list) else value


def nodes(value, path=(), key=None):
    """(path, key, value) of every node below; a path is the places in lists and objects, a key the name of the nearest member."""
    for i, item in enumerate(value if isinstance(value, list) else []):
        name, inner = item if isinstance(value, Object) else (key, item)
        yield path + (i,), name, inner
        yield from nodes(inner, path + (i,), name)


def at(root, path):
    for i in path:
        root = root[i][1] if isinstance(root, Object) else root[i]
    return root


def put(root, path, value):
    parent = at(root, path[:-1])
    if isinstance(parent, Object):
        parent[path[-1]][1] = value
    else:
        parent[path[-1]] = value


def is_text(value):
    return isinstance(value, str) and not isinstance(value, Number)


def resolves(value, pointer):
    """Does a JSON pointer (of an error message) name a place of a plain document?"""
    for step in pointer.split("/")[1:]:
        step = step.replace("~1", "/").replace("~0", "~")
        if isinstance(value, dict) and step in value:
            value = value[step]
        elif isinstance(value, list) and step.isdigit() and int(step) < len(value):
            value = value[int(step)]
        else:
            return False
    return True

#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""
Writes src/library/python/modetune/types.py, the types of what the files hold, from the JSON Schemas beside it.
An object becomes a TypedDict called by its document and its definition, or by the member that holds it. A keyword that
this program does not know is an error. library/test_types holds the module against the schemas.
"""
import json
import keyword
import re
import textwrap
from pathlib import Path

HERE = Path(__file__).resolve().parent
MODULE = HERE.parent / "src/library/python/modetune/types.py"
FORMATS = ("model", "study", "aircraft", "profile", "result", "index", "progress", "scene",
           *sorted(path.name.removesuffix(".schema.json") for path in HERE.glob("command_*.schema.json")))
WIDTH = 96
SCALARS = {"string": "str", "number": "float", "integer": "int", "boolean": "bool", "null": "None"}
# what a type is made of, and what bounds it only or is for people
MAKING = {"$ref", "allOf", "anyOf", "oneOf", "if", "then", "else", "type", "properties", "required", "additionalProperties", "items", "enum", "const"}
BOUNDING = {"$schema", "$comment", "title", "description", "default", "examples", "definitions", "minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum",
            "minItems", "maxItems", "uniqueItems", "minLength", "maxLength", "minProperties", "pattern", "propertyNames", "not", "dependencies", "format"}

HEAD = '''\
# SPDX-License-Identifier: GPL-3.0-or-later
# Written from the schemas by the target schemas (schemas/python_types.py): do not edit.
"""Types of what the files hold, and of what commands print as JSON (CommandModes, ...), for
editors and checkers of types: Study, Model, Result, ...

    from modetune.types import Study
    study: Study = {"format": "modetune-study/1", "model": "stick.json", "goals": []}

What each member is stands in schemas/README.md. Numbers of models and studies may be texts,
expressions of parameters.
"""
from typing import Dict, List, Literal, Optional, TypedDict, Union
'''


def camel(name):
    return "".join(part[:1].upper() + part[1:] for part in re.split(r"[_\W]+", name))


def joined(types):
    """Several types, of which None comes last; each once."""
    flat = list(dict.fromkeys(types))
    others = [t for t in flat if t != "None"]
    inner = others[0] if len(others) == 1 else f"Union[{', '.join(others)}]" if others else "None"
    return inner if len(others) == len(flat) or not others else f"Optional[{inner}]"


def singular(name):
    return name[:-3] + "y" if name.endswith("ies") else name[:-1] if name.endswith("s") else name


class Document:
    """The classes and aliases of one schema."""

    def __init__(self, name, schema):
        self.prefix, self.schema, self.parts, self.names = camel(name), schema, [], set()
        self.reserved = {self.prefix + camel(key) for key in schema.get("definitions", {})} | {self.prefix + camel(singular(key)) for key in schema.get("properties", {})}

    def write(self):
        for name, part in self.schema.get("definitions", {}).items():
            own = self.prefix + camel(name)
            kinds = [kind["then"] for kind in part.get("allOf", []) if "then" in kind]
            if kinds:  # told apart by a member
                self.parts.append((own, f"{own} = {joined(self.type_of(kind, (name,)) for kind in kinds)}\n"))
            elif "properties" in part:
                self.make_class(own, part, (name,))
            else:
                self.parts.append((own, f"{own} = {self.type_of(part, (name,))}\n"))
        if "properties" in self.schema:
            self.make_class(self.prefix, self.schema, ())
        else:  # what a command prints: one of its definitions, or a list of them
            self.parts.append((self.prefix, f"{self.prefix} = {self.type_of(self.schema, (self.prefix,))}\n"))
        return self.parts

    def make_class(self, name, part, place):
        if name in self.names:
            raise SystemExit(f"python_types.py: two types are called {name}")
        self.names.add(name)
        needed = part.get("required", [])
        members = {key: self.type_of(value, (*place, key)) for key, value in part["properties"].items()}
        unknown = set(part) - MAKING - BOUNDING
        if unknown:
            raise SystemExit(f"python_types.py: {name}: {sorted(unknown)}")
        always = {key: value for key, value in members.items() if key in needed}
        sometimes = {key: value for key, value in members.items() if key not in needed}
        sentence = "\n".join(doc(part.get("description", f"Of a {self.prefix.lower()}."))) + "\n"
        text, base = "", "TypedDict"
        for some, total, last in ((always, "", not sometimes), (sometimes, ", total=False", True)):
            if any(not key.isidentifier() or keyword.iskeyword(key) for key in some):
                own = f"_{name}{'Sometimes' if total else 'Always'}"
                lines = "".join(f"    \"{key}\": {value},\n" for key, value in some.items())
                text += f"{own} = TypedDict(\"{own}\", {{\n{lines}}}{total})\n\n\n"
                base = own if base == "TypedDict" else f"{base}, {own}"
                text += f"class {name}({base}):\n{sentence}" if last else ""
            elif some:
                lines = "".join(f"    {key}: {value}\n" for key, value in some.items())
                text += f"class {name if last else f'_{name}Always'}({base}{total}):\n" + (f"{sentence}\n{lines}" if last else f"{lines}\n\n")
                base = f"_{name}Always"
        self.parts.append((name, text))

    def called(self, place):
        """The name of a class by its place, as short as it is its only one; lists at the root come first."""
        for k in range(len(place) - 1, -1, -1):
            name = self.prefix + "".join(map(camel, place[k:]))
            if name not in self.names and (len(place) == 1 or name not in self.reserved):
                return name
        raise SystemExit(f"python_types.py: {place}: there is no name")

    def type_of(self, part, place):
        """The expression of a type; `place` names the class of an object that is no definition."""
        unknown = set(part) - MAKING - BOUNDING
        if unknown:
            raise SystemExit(f"python_types.py: {place}: {sorted(unknown)}")
        if "$ref" in part:
            return f"\"{self.prefix}{camel(part['$ref'].rsplit('/', 1)[1])}\""
        if "const" in part:
            return f"Literal[{json.dumps(part['const'])}]"
        if "enum" in part:
            named = [value for value in part["enum"] if value is not None]
            return joined([f"Literal[{', '.join(map(json.dumps, named))}]"] + ["None"] * (len(named) < len(part["enum"])))
        if "if" in part:
            return joined(self.type_of({"type": "array", **part[way]} if "items" in part[way] else part[way], place) for way in ("then", "else"))
        for key in ("anyOf", "oneOf"):
            if key in part and "properties" not in part:
                return joined(self.type_of(one, place) for one in part[key])
        if "allOf" in part and len(part["allOf"]) == 1 and "properties" not in part:
            return self.type_of(part["allOf"][0], place)
        kinds = part["type"] if isinstance(part["type"], list) else [part["type"]]
        return joined(self.kind_of(kind, part, place) for kind in kinds)

    def kind_of(self, kind, part, place):
        if kind == "array":
            return f"List[{self.type_of(part['items'], (*place[:-1], singular(place[-1])))}]"
        if kind != "object":
            return SCALARS[kind]
        if "properties" in part:
            name = self.called(place)
            self.make_class(name, part, place)
            return f"\"{name}\""
        return f"Dict[str, {self.type_of(part['additionalProperties'], place)}]"


def doc(text):
    """A docstring."""
    lines = textwrap.wrap(f'"""{text}', WIDTH, initial_indent="    ", subsequent_indent="    ")
    return lines + ['    """'] if len(lines) > 1 or len(lines[0]) + 3 > WIDTH else [lines[0] + '"""']


def wrapped(text):
    """Types that are too long for a line: what is in their brackets stands below."""
    lines = []
    for line in text.split("\n"):
        if len(line) <= WIDTH or line.lstrip().startswith(('"""', "class")) or "[" not in line:
            lines.append(line)
            continue
        begin, end, indent = line.index("[") + 1, line.rindex("]"), " " * (len(line) - len(line.lstrip()))
        whole = re.sub(r'"[^"]*"', lambda text: text[0].replace(" ", "\0"), line[begin:end])  # texts are not broken
        inner = textwrap.wrap(whole, WIDTH, initial_indent=indent + "    ", subsequent_indent=indent + "    ", break_long_words=False, break_on_hyphens=False)
        lines += [line[:begin], *(part.replace("\0", " ") for part in inner), indent + line[end:]]
    return "\n".join(lines)


def in_order(parts):
    """Classes first, whose members are told by name; then what is called otherwise, after what it calls."""
    classes = [text for name, text in parts if not text.startswith(name + " =")]
    aliases = {name: text for name, text in parts if text.startswith(name + " =")}
    done, texts = set(), []

    def put(name):
        if name in done:
            return
        done.add(name)
        for other in re.findall(r'"(\w+)"', aliases[name]):
            if other in aliases:
                put(other)
        texts.append(aliases[name])

    for name in aliases:
        put(name)
    return classes, texts


def module():
    parts = []
    for name in FORMATS:
        parts += Document(name, json.loads((HERE / f"{name}.schema.json").read_text(encoding="utf-8"))).write()
    classes, aliases = in_order(parts)
    roots = [camel(name) for name in FORMATS]
    everything = "\n".join(textwrap.wrap(", ".join(f'"{name}"' for name in roots), WIDTH, initial_indent="    ", subsequent_indent="    "))
    text = HEAD + f"\n__all__ = [\n{everything},\n]\n" + "".join(f"\n\n{part}" for part in classes) + "\n\n" + "".join(aliases)
    return wrapped(text)


if __name__ == "__main__":
    MODULE.write_text(module(), encoding="utf-8")

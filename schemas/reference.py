#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""
Writes schemas/README.md, the reference of the file formats, from the JSON Schemas beside it.
Every keyword of a schema appears on the page; one that this program does not know is an error.
structure/test_reference holds the page against the schemas and writes it with MT_README_UPDATE=1.
"""
import json
import re
import textwrap
from pathlib import Path

HERE = Path(__file__).resolve().parent
PAGE = HERE / "README.md"
COMMANDS = tuple(sorted(path.name.removesuffix(".schema.json") for path in HERE.glob("command_*.schema.json")))
FORMATS = ("model", "study", "aircraft", "profile", "result", "index", "progress", "scene", *COMMANDS)
WIDTH = 96

HEAD = """\
<!-- Made from the schemas by schemas/reference.py: do not edit. -->

# File formats

This page lists every member of every JSON file that modetune reads or writes, and of what its
commands print as JSON: its type, its unit, its default and its meaning.
[problems/README.md](../problems/README.md) explains models by examples,
[studies/README.md](../studies/README.md) explains studies. `modetune help NAME` prints what the
pages say of a member; `modetune check FILE` reads a file as strictly as the program does.

## How to read an entry

    - `member` (type, unit; required; default; limits): meaning.

The unit stands behind the type where the member's name or its description names one. A member
that is not marked as required may be absent; "default" is the value that it then has. *Number
or expression* means a JSON number, or a string with an expression of the model's parameters.
An "object" links to the section that lists its members; that section begins with the place of
the object in the file, where `N` stands for a position in a list and `NAME` for a name that the
file chooses.

## Schemas in an editor

An editor that knows JSON Schema completes members, shows their descriptions and marks wrong
ones while you type. `modetune init` writes a model, a study and the schemas into a folder;
`modetune schema NAME` prints one schema. A file can name its schema itself:

```json
{
    "$schema": "schemas/study.schema.json",
    "format": "modetune-study/1"
}
```

In VS Code, the setting `json.schemas` (in `.vscode/settings.json`) attaches a schema to all
files of a folder:

```json
{
    "json.schemas": [
        {"fileMatch": ["problems/*.json"], "url": "./schemas/model.schema.json"},
        {"fileMatch": ["studies/*.json"], "url": "./schemas/study.schema.json"}
    ]
}
```

The schemas follow draft 7. They know the shape of a file; `modetune check` also evaluates
expressions, looks up names and warns of suspicious values.

## Versions of the formats

Each file names its format and the version number of the format (`modetune-model/1`). A new
version of modetune may add a member under the same number; the meaning of a member never
changes under it. The program refuses a number or a member that it does not know and reports the
place, so it never half understands a file that was written for a newer version. A program with
a new format number will also read this one, and the changelog will say what to change.

What a command prints has no number of its own: its schema, `modetune schema command_NAME`, is of
the program that prints it.
"""

UNITS = (("hz_per_percent", "Hz/%"), ("hz_per_unit", "Hz per unit"), ("_per_percent", None), ("_n_m_s_per_rad", "N m s/rad"), ("_n_m_per_rad", "N m/rad"), ("_n_s_per_m", "N s/m"), ("_n_per_m", "N/m"),
         ("_kg_per_m3", "kg/m^3"), ("_kg_m2", "kg m^2"), ("_m_per_rad", "m/rad"), ("_m_per_s2", "m/s^2"), ("_m2_per_s3", "m^2/s^3"),
         ("_g2_per_hz", "g^2/Hz"), ("_db_per_octave", "dB/octave"), ("_n_m", "N m"), ("_percent", "%"), ("_rad", "rad"),
         ("_deg", "degrees"), ("_rpm", "rpm"), ("_hz", "Hz"), ("_kg", "kg"), ("_pa", "Pa"), ("_m2", "m^2"), ("_m4", "m^4"), ("_rad_per_s", "rad/s"), ("_m_per_s", "m/s"),
         ("_per_s", "1/s"),
         ("_j", "J"), ("_n", "N"), ("_s", "s"), ("_m", "m"), ("_g", "g"))
# What says something of the members of an object together, or of a value; all else has an entry of its own.
KNOWN = {"$schema", "$comment", "title", "description", "type", "properties", "definitions", "required", "additionalProperties", "enum", "const", "items",
         "$ref", "allOf", "anyOf", "oneOf", "not", "if", "then", "else", "minimum", "maximum", "minItems", "maxItems", "minLength",
         "minProperties", "pattern", "propertyNames", "examples", "default", "dependencies"}


def shown(value):
    return "`" + json.dumps(value, ensure_ascii=False) + "`"


def examples(schema):
    found = schema.get("examples", [])
    return f" Example{'s' if len(found) > 1 else ''}: {', '.join(map(shown, found))}." if found else ""


def filled(text, indent=""):
    """A paragraph in lines that break between words, and not within backquotes."""
    kept = re.sub(r"`[^`]*`", lambda code: code[0].replace(" ", "\0"), text)
    return textwrap.fill(kept, WIDTH, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False).replace("\0", " ")


def listed(words, last="or"):
    words = list(words)
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} {last} {words[-1]}"


def unit_of(name, text):
    """The unit in brackets of the description, or else what the member's name ends in."""
    unit = re.search(r"\[((?:[A-Za-z0-9%/^() ]|\*)+)\]", text)
    if unit and re.search(r"[A-Za-z%1]", unit[1]) and "," not in unit[1]:
        return unit[1] if unit[1] != "1" else None
    return next((u for end, u in UNITS if name.endswith(end)), None)


class Format:
    """One schema: its objects as sections in the order in which a file mentions them."""

    def __init__(self, name):
        self.schema = json.loads((HERE / f"{name}.schema.json").read_text(encoding="utf-8"))
        self.name, self.sections, self.by_id, self.values = name, [], {}, {}
        self.section(self.schema, None, "")

    def resolve(self, schema):
        """A schema without references, and the name of its definition."""
        if "$ref" in schema:
            name = schema["$ref"].rpartition("/")[2]
            return self.schema["definitions"][name], name
        return schema, None

    def section(self, schema, heading, place):
        """The section of an object, which is made where it is met first."""
        unknown = set(schema) - KNOWN
        if unknown:
            raise ValueError(f"{self.name}{place}: nobody knows how to show {sorted(unknown)}")
        if id(schema) in self.by_id:
            old = self.by_id[id(schema)]
            if not place.startswith("/"):  # a type of values, whose members have said it
                return old
            old["headings"] += [heading] if heading not in old["headings"] else []
            old["places"] += [place] if place not in old["places"] else []
            return old
        new = {"headings": [heading], "places": [place], "schema": schema, "kinds": [], "entries": []}
        self.by_id[id(schema)] = new
        self.sections.append(new)
        for case in schema.get("allOf", []):
            if "if" in case:
                kind = case["if"]["properties"]["type"]["const"]
                new["kinds"].append((kind, self.section(self.resolve(case["then"])[0], f"`{kind}`", place)))
        if "properties" not in schema:  # what a command prints: one of its definitions, or a list of them
            for name in dict.fromkeys(re.findall(r'"#/definitions/(\w+)"', json.dumps([schema.get("anyOf"), schema.get("items")]))):
                self.section(self.schema["definitions"][name], f"`{name}`", "/N")
        # depth first: the sections of its objects follow
        for member, value in schema.get("properties", {}).items():
            new["entries"].append((member, value, self.kind(value, member, f"{place}/{member}")))
        return new

    def kind(self, schema, member, place):
        """Words for the type of a value, with the section of an object in place of its link: a list of text and sections."""
        schema, name = self.resolve(schema)
        if "properties" in schema:
            return [self.section(schema, f"`{member}`", place)]
        if name is not None:
            self.values[name] = schema
            inner = self.plain(schema, member, place)
            return ["number or expression"] if name == "number" else [f"*{name}*"] + [x for x in inner if isinstance(x, dict)]
        return self.plain(schema, member, place)

    def plain(self, schema, member, place):
        unknown = set(schema) - KNOWN
        if unknown:
            raise ValueError(f"{self.name}{place}: nobody knows how to show {sorted(unknown)}")
        cases = [c for c in schema.get("anyOf", schema.get("allOf", [])) if "required" not in c]
        if "if" in schema:
            cases = [dict(schema["then"], **({"type": "array"} if "items" in schema["then"] else {})), schema["else"]]
        if cases:
            parts = [self.kind(case, member, place) for case in cases]
            return [x for i, part in enumerate(parts) for x in ([" or "] if i else []) + part]
        types = schema.get("type", [])
        types = [types] if isinstance(types, str) else types
        if not types:
            types = sorted({"string" if isinstance(v, str) else "null" if v is None else "number" for v in schema.get("enum", ["x"])}, key="null".__eq__)
        out = []
        for i, one in enumerate(types):
            out += [" or "] if i else []
            if one == "array":
                least, most = schema.get("minItems"), schema.get("maxItems")
                many = f" of {least}" if least == most and least else f" of {least} to {most}" if most else f" of at least {least}" if least else ""
                inner = self.kind(schema["items"], member, f"{place}/N") if "items" in schema else []
                out += [f"list{many}" + (": " if many and inner else " of " if inner else "")] + inner
            elif one == "object" and isinstance(schema.get("additionalProperties"), dict):
                out += ["object with, by name, "] + self.kind(schema["additionalProperties"], member, f"{place}/NAME")
            else:
                out.append({"boolean": "true or false", "integer": "whole number"}.get(one, one))
        return out


class Page:
    def __init__(self):
        self.formats = [Format(name) for name in FORMATS]
        self.slugs, self.anchors = {}, {}
        self.titles = {f.name: f"Answer: `{f.schema['title']}`" if f.name in COMMANDS else
                       f"{f.name.capitalize()}: `{f.schema['properties']['format']['enum'][0]}`" for f in self.formats}
        for line in re.findall(r"^#+ (.*)$", HEAD, re.M):
            self.slug(line)
        for form in self.formats:
            self.slug(self.titles[form.name])
            for section in form.sections[1:]:
                self.anchors[id(section)] = self.slug(self.heading(section))

    def slug(self, heading):
        """The anchor that code hosts give a heading."""
        slug = re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
        count = self.slugs.get(slug, 0)
        self.slugs[slug] = count + 1
        return f"{slug}-{count}" if count else slug

    @staticmethod
    def heading(section):
        return ", ".join(section["headings"])

    def words(self, kind):
        """The type in words."""
        return "".join(f"[object](#{self.anchors[id(x)]})" if isinstance(x, dict) else x for x in kind)

    @staticmethod
    def limits(schema):
        """What else a schema says of a value, in a few words each."""
        at = [schema] + [schema[k] for k in ("items", "then") if isinstance(schema.get(k), dict) and "$ref" not in schema[k]]
        out = []
        for s in at:
            low, high = s.get("minimum"), s.get("maximum")
            out += [f"{low} to {high}"] if low is not None and high is not None else [f"at least {low}"] if low is not None else [f"at most {high}"] if high is not None else []
            out += [f"default {shown(s['default'])}"] if "default" in s else []
            out += [f"always {shown(s['const'])}"] if "const" in s else []
            if "enum" in s:
                values = [shown(v) for v in s["enum"] if v is not None]
                out.append(("" if len(values) == 1 else "one of ") + ", ".join(values))
            out += [f"matches `{s['pattern']}`"] if "pattern" in s else []
            out += ["not empty"] if s.get("minLength") or s.get("minProperties") else []
        names = schema.get("propertyNames", {})
        out += [f"names match `{names['pattern']}`"] if "pattern" in names else ["names not empty"] if names else []
        return out

    def entry(self, form, mark, member, schema, kind):
        inner = form.resolve(schema)[0]
        text = schema.get("description", inner.get("description", "")) if "$ref" not in schema else inner["description"]
        unit = unit_of(member, text) if any(w in self.words(kind) for w in ("number", "vector", "pair", "breakpoints")) else None
        notes = [self.words(kind) + (f", {unit}" if unit else "")]
        notes += [mark] if mark is not None else []
        own = inner if not ("$ref" in schema and schema["$ref"].rpartition("/")[2] in form.values) else {}
        notes += self.limits(own) if "properties" not in inner else []
        text += examples(own) if "properties" not in inner else ""
        return filled(f"- `{member}` ({'; '.join(notes)}): {text}", "  ")

    @staticmethod
    def together(schema):
        """Sentences about members together."""
        def sets(cases):
            return ["`" + "` and `".join(c["required"]) + "`" for c in cases]
        out = []
        for s in [schema] + [c for c in schema.get("allOf", []) if "if" not in c]:
            out += [f"Exactly one of {listed(sets(s['oneOf']), 'and')} is given."] if "oneOf" in s else []
            out += [f"At least one of {listed(sets(s['anyOf']), 'and')} is given."] if "anyOf" in s and "properties" in s else []
            for case in s["not"].get("anyOf", [s["not"]]) if "not" in s else []:
                out.append(f"Not both {sets([case])[0]} are given.")
            for member, others in s.get("dependencies", {}).items():
                out.append(f"`{member}` needs {listed([f'`{o}`' for o in others], 'and')}.")
        return out

    def section(self, form, section, title):
        schema = section["schema"]
        text = [schema["description"]] if "description" in schema else []
        places = [p for p in section["places"] if p]
        printed = form.name in COMMANDS
        written = form.name in ("result", "index", "progress", "scene") or printed
        properties = schema.get("properties", {})
        later = set(properties) - set(schema.get("required", [])) if written else set()
        everything = written or set(schema.get("required", [])) == set(properties)
        said = "Every member is required." if not written else "Every member is always there." if not later else \
            "Every member is always there, but those marked as sometimes." if printed else \
            "Every member is always there, but files that older programs wrote may lack those marked as later."
        text += [said] if everything and len(properties) > 1 and not any("Every member is" in t for t in text) else []
        text += self.together(schema)
        text += [examples(schema).strip()] if "examples" in schema else []
        lines = [title, ""]
        if places:
            more = f" and {len(places) - 4} more." if len(places) > 4 else "."
            lines += [filled("Place: " + ", ".join(f"`{p}`" for p in places[:4]) + more), ""]
        if text:
            lines += [filled(" ".join(text))] + ([""] if section["entries"] else [])
        lines += [self.entry(form, "sometimes" if m in later and printed else "later" if m in later else "required" if m in schema.get("required", []) and not everything else None, m, s, kind)
                  for m, s, kind in section["entries"]]
        if section["kinds"]:
            kinds = ", ".join(f"[`{kind}`](#{self.anchors[id(s)]})" for kind, s in section["kinds"])
            lines += ["", filled(f"The type decides which other members there are: {kinds}.")]
        return "\n".join(lines) + "\n"

    def format(self, form):
        out = [self.section(form, form.sections[0], f"## {self.titles[form.name]}")]
        if form.values:
            lines = []
            for name, schema in form.values.items():
                called = "number or expression" if name == "number" else name
                kind = self.words(form.plain(schema, name, "-")) if name != "number" else "number or string"
                notes = "; ".join([kind] + self.limits(schema))
                lines.append(filled(f"- *{called}* ({notes}): {schema.get('description', '')}{examples(schema)}", "  "))
            out.append("Types of values that several members share:\n\n" + "\n".join(lines) + "\n")
        for section in form.sections[1:]:
            out.append(self.section(form, section, f"### {self.heading(section)}"))
        return "\n".join(out)

    def text(self):
        return HEAD + "\n" + "\n".join(self.format(form) for form in self.formats)


if __name__ == "__main__":
    PAGE.write_text(Page().text(), encoding="utf-8")

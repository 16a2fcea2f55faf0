# SPDX-License-Identifier: GPL-3.0-or-later
"""The types of the Python package (modetune/types.py) are what schemas/python_types.py makes of the schemas; shipped files are of them, and
what the program writes."""
import importlib.util
import json
import os
import subprocess
import sys
import tempfile
import typing
import unittest
from pathlib import Path

SOURCE = Path(os.environ["SOURCE_DIR"])
MODULE = SOURCE / "src/library/python/modetune/types.py"


def loaded(path):
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # by which names of types are found
    spec.loader.exec_module(module)
    return module


sys.path.insert(0, str(SOURCE / "schemas"))
types = loaded(MODULE)


def hint_of(kind):
    """A type whose name may stand for it."""
    if isinstance(kind, typing.ForwardRef):
        kind = kind.__forward_arg__
    return getattr(types, kind) if isinstance(kind, str) else kind


def faults(value, kind, place=""):
    """Where the value is not of the type, and why."""
    kind = hint_of(kind)
    origin, args = typing.get_origin(kind), typing.get_args(kind)
    if origin is typing.Union:
        tries = [faults(value, one, place) for one in args]
        return [] if [] in tries else min(tries, key=len)
    if origin is typing.Literal:
        return [] if value in args else [f"{place}: {value!r} is none of {args}"]
    if origin is list:
        return [f for i, item in enumerate(value) for f in faults(item, args[0], f"{place}/{i}")] if isinstance(value, list) else [f"{place}: no list"]
    if origin is dict:
        return [f for key, item in value.items() for f in faults(item, args[1], f"{place}/{key}")] if isinstance(value, dict) else [f"{place}: no object"]
    if typing.is_typeddict(kind) if hasattr(typing, "is_typeddict") else hasattr(kind, "__total__"):
        return of_dictionary(value, kind, place)
    if kind is float:
        return [] if isinstance(value, (int, float)) and not isinstance(value, bool) else [f"{place}: no number"]
    return [] if isinstance(value, kind) and (kind is bool or not isinstance(value, bool)) else [f"{place}: no {kind.__name__}"]


def of_dictionary(value, kind, place):
    if not isinstance(value, dict):
        return [f"{place}: no object"]
    members = {key: hint for base in reversed(kind.__mro__) for key, hint in getattr(base, "__annotations__", {}).items()}
    found = [f"{place}: {key} is no key of {kind.__name__}" for key in value if key not in members]
    found += [f"{place}: {key} is missing" for key in kind.__required_keys__ if key not in value]
    return found + [f for key, item in value.items() if key in members for f in faults(item, members[key], f"{place}/{key}")]


def shipped():
    """(name of the type, file, what it holds) of all files of a format."""
    for folder in ("problems", "problems/profiles", "studies"):
        for path in sorted((SOURCE / folder).glob("*.json")):
            document = json.loads(path.read_text(encoding="utf-8"))
            if "format" in document:
                yield named(document), path, document


def named(document):
    return document["format"].split("-")[1].split("/")[0].capitalize()


def written():
    """(name of the type, document) of what the program writes."""
    program, studies = os.environ["MODETUNE"], [SOURCE / "studies" / f"{name}.json" for name in ("stick", "inceptor_tuning_1")]
    with tempfile.TemporaryDirectory() as folder:
        run = subprocess.run([program, "run", "--progress", "json", "-o", folder, *studies], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=True)
        show = subprocess.run([program, "show", "--format", "json", SOURCE / "problems/stick.json"], stdout=subprocess.PIPE, text=True, check=True)
        texts = [line for line in run.stderr.splitlines() if line.startswith("{")] + [show.stdout]
        texts += [path.read_text(encoding="utf-8") for path in (*Path(folder).glob("*/result.json"), *Path(folder).glob("index.json"))]
    for document in map(json.loads, texts):
        yield named(document), document


class Types(unittest.TestCase):
    def test_module_is_what_the_schemas_say(self):
        self.assertEqual(MODULE.read_text(encoding="utf-8"), loaded(SOURCE / "schemas/python_types.py").module(),
                         "cmake --build build/release --target schemas writes it")

    def test_shipped_files_are_of_their_types(self):
        seen = set()
        for name, path, document in shipped():
            seen.add(name)
            self.assertEqual(faults(document, name), [], path)
        self.assertEqual(seen, {"Model", "Study", "Profile", "Aircraft"})

    def test_what_the_program_writes_is_of_its_types(self):
        seen = set()
        for name, document in written():
            seen.add(name)
            self.assertEqual(faults(document, name), [], name)
        self.assertEqual(seen, {"Result", "Index", "Progress", "Scene"})

    def test_what_is_not_of_a_type_is_seen(self):
        study = json.loads((SOURCE / "studies/stick.json").read_text(encoding="utf-8"))
        for harm, word in (({"gaols": []}, "gaols is no key of Study"), ({"model": 3}, "/model: no str"), ({"goals": [{"type": "speed"}]}, "/goals/0"),
                           ({"format": "modetune-study/2"}, "/format"), ({"accepted": "mass"}, "/accepted: no list")):
            self.assertIn(word, " ".join(faults({**study, **harm}, "Study")))
        self.assertEqual(faults({key: value for key, value in study.items() if key != "model"}, "Study"), [": model is missing"])


if __name__ == "__main__":
    unittest.main()

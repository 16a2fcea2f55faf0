# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests of the schemas share: schemas that are quick on mutants, and mutants."""
import copy
import json
import os
from pathlib import Path

import jsonschema

ROOT = Path(os.environ.get("SOURCE_DIR", Path(__file__).resolve().parents[2]))


def load(path):
    return json.loads(path.read_text(encoding="utf-8"))


class Schema:
    """A schema that remembers what of the originals its references found valid: mutants share all that was not changed."""

    def __init__(self, kind):
        self.text = load(ROOT / f"schemas/{kind}.schema.json")
        jsonschema.Draft7Validator.check_schema(self.text)
        self.known = {}  # (reference, identity) to the value, which is kept, so that no other can have its identity
        self.learning = False
        self.usual = jsonschema.Draft7Validator.VALIDATORS["$ref"]
        self.validator = jsonschema.validators.extend(jsonschema.Draft7Validator, {"$ref": self.ref})(self.text)

    def ref(self, validator, reference, value, schema):
        if (reference, id(value)) in self.known:
            return
        errors = self.usual(validator, reference, value, schema)
        if self.learning:
            errors = list(errors)
            if not errors:
                self.known[reference, id(value)] = value
        yield from errors

    def errors_of_original(self, document):
        self.learning = True
        errors = list(self.validator.iter_errors(document))
        self.learning = False
        return errors


def at(document, path):
    for step in path:
        document = document[step]
    return document


def changed(document, path, change):
    """The document with one change; what is not above the place is the original's own."""
    mutant = parent = copy.copy(document)
    for step in path[:-1]:
        parent[step] = copy.copy(parent[step])
        parent = parent[step]
    key = path[-1]
    if change == "drop":
        del parent[key]
    elif change in ("rename", "sign"):
        parent[key + ("x" if change == "rename" else "-")] = parent.pop(key)
    elif change == "add":
        parent[key] = dict(parent[key], unknown_member=1)
    elif change == "double":
        parent.append(parent[key])
    else:
        parent[key] = change[1]
    return mutant

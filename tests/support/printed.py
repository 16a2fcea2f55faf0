# SPDX-License-Identifier: GPL-3.0-or-later
"""What a command prints as JSON against its schema (schemas/command_NAME.schema.json), where it has one."""
import functools
import json

from suite import SOURCE


@functools.lru_cache(maxsize=None)
def validator(command):
    """Of what this command prints; None: it has no schema."""
    import jsonschema  # where there is something to be checked: it takes a while

    path = SOURCE / f"schemas/command_{command}.schema.json"
    if not path.exists():
        return None
    schema = json.loads(path.read_text(encoding="utf-8"))
    jsonschema.Draft7Validator.check_schema(schema)
    return jsonschema.Draft7Validator(schema)


def faults(args, text):
    """Where what a command line printed is not what its schema says."""
    as_json = "--format=json" in args or any(pair == ("--format", "json") for pair in zip(args, args[1:]))
    found = validator(args[0]) if as_json and text else None
    return [] if found is None else [f"{error.json_path}: {error.message[:300]}" for error in deepest(found, json.loads(text))]


def deepest(found, document):
    """The errors, of alternatives those of the one that fits best."""
    from jsonschema.exceptions import best_match

    for error in found.iter_errors(document):
        while error.context:
            error = best_match(error.context) if len(error.context) == 1 else max(error.context, key=lambda e: (len(e.absolute_path), -len(e.message)))
        yield error

# SPDX-License-Identifier: GPL-3.0-or-later
"""Every shipped file validates against its schema, and on generated mutants schema and reader agree about structure."""
import copy
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from common_schema import ROOT, Schema, at, changed, load

BUILD = Path(os.environ.get("BUILD_DIR", ROOT / "build/release"))
HERE = ROOT / "tests/schema"
KINDS = {"modetune-model/1": "model", "modetune-study/1": "study", "modetune-result/1": "result",
         "modetune-aircraft/1": "aircraft", "modetune-profile/1": "profile"}


def shipped():
    """All files that are there to be read, with their kind."""
    files = [p for folder in ("problems", "problems/profiles", "studies", "examples", "tests/schema", "tests/documents/good") for p in sorted((ROOT / folder).glob("*.json"))]
    return [(p, KINDS.get(load(p).get("format"))) for p in files]


def undocumented(schema, where="#"):
    """Members of a schema without a description, which an editor would not explain."""
    if isinstance(schema, dict):
        for name, value in schema.get("properties", {}).items():
            if isinstance(value, dict) and "description" not in value and "$ref" not in value:
                yield f"{where}/properties/{name}"
        for key, value in schema.items():
            if key not in ("if", "not"):  # conditions: the members are described where they are allowed
                yield from undocumented(value, f"{where}/{key}")
    elif isinstance(schema, list):
        for i, value in enumerate(schema):
            yield from undocumented(value, f"{where}/{i}")


def places(value, path=()):
    """All places in a document, outer before inner."""
    yield path
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from places(inner, path + (key,))
    elif isinstance(value, list):
        for i, inner in enumerate(value):
            yield from places(inner, path + (i,))


OTHER_TYPES = [None, True, 7, 0, 2.5, -1, "x", "", [], {}, [1], ["x", "y"], {"x": 1}, [[0, 0], "x"], -0.0, 1e308, 1e-320, 2147483648, 2 ** 64, "0 * 1",
               "x" * 300, "\u001b", [[]], [None], [{}], [[0, 1], [1, 2]], [0] * 40, {"": 1}, {"x": {}}, {"x": []}]


def changes(document):
    """What may be done where: members dropped, renamed, doubled in lists, of another type; unknown members added; lists cut and stretched."""
    for path in places(document):
        if not path:
            continue
        parent = at(document, path[:-1])
        value, is_member = parent[path[-1]], isinstance(parent, dict)
        for change in ["drop", "rename", "sign", "add", "double"] + [("type", v) for v in OTHER_TYPES]:
            if change in ("rename", "sign") and not is_member or change == "add" and not isinstance(value, dict) or change == "double" and is_member:
                continue
            if isinstance(change, tuple) and type(value) is type(change[1]) and value == change[1]:
                continue
            yield path, change


def main():
    problems, checked = [], 0
    schema_of = {kind: Schema(kind) for kind in KINDS.values()}
    for kind, schema in schema_of.items():
        problems += [f"{kind}.schema.json: {where} has no description" for where in undocumented(schema.text)]
    files = shipped()
    jobs, originals = [], []
    for path, kind in files:
        if kind is None:
            problems.append(f"{path}: member \"format\" names no known format")
            continue
        document = load(path)
        problems += [f"{path}: {e.json_path}: {e.message}" for e in schema_of[kind].errors_of_original(document)]
        checked += 1
        if kind != "result":
            originals.append((path, kind, "as it is", document))
            # what a repeat or an include copies is made before anything else is read, and where that fails nothing is
            apart = {"repeat", "include"} & set(document)
            jobs += [(path, kind, document, *how) for how in changes(document) if not apart or (how[0][0] in apart and len(how[0]) > 1)]
    step = max(1, len(jobs) // int(os.environ.get("MT_MUTANTS", "15000" if "MT_EVERY" in os.environ else "1500")))  # evenly thinned where there are many
    # a file of another format is not read on: the verdicts agree, but there is nothing to compare
    jobs = originals + [(path, kind, f"{'/'.join(map(str, where))}: {change}", changed(document, where, change))
                        for path, kind, document, where, change in jobs[::step]]
    with tempfile.TemporaryDirectory() as folder:
        names = []
        for i, (path, kind, _, mutant) in enumerate(jobs):
            if kind in ("study", "profile", "model"):  # files are named relative to these
                mutant = copy.deepcopy(mutant)
                for holder in mutant["include"] if isinstance(mutant.get("include"), list) else []:
                    if isinstance(holder, dict) and isinstance(holder.get("file"), str):
                        holder["file"] = str((path.parent / holder["file"]).resolve())
                if isinstance(mutant.get("aircraft"), str):
                    mutant["aircraft"] = str((path.parent / mutant["aircraft"]).resolve())
            if kind == "study":
                references = mutant.get("references")
                for holder in [mutant] + (list(references.values()) if isinstance(references, dict) else []):
                    if isinstance(holder, dict) and isinstance(holder.get("model"), str):
                        holder["model"] = str((path.parent / holder["model"]).resolve())
                for goal in mutant["goals"] if isinstance(mutant.get("goals"), list) else []:
                    if isinstance(goal, dict) and isinstance(goal.get("profile"), str) and (path.parent / goal["profile"]).is_file():
                        goal["profile"] = str((path.parent / goal["profile"]).resolve())
                for tables in (mutant.get("measurements"), mutant.get("catalogues")):
                    for holder in tables.values() if isinstance(tables, dict) else []:
                        if isinstance(holder, dict) and isinstance(holder.get("file"), str):
                            holder["file"] = str((path.parent / holder["file"]).resolve())
            name = Path(folder, f"{i}.json")
            name.write_text(json.dumps(mutant), encoding="utf-8")
            names.append(f"{kind} {name}\n")
        Path(folder, "list").write_text("".join(names), encoding="utf-8")
        told = subprocess.run([BUILD / "tests/schema/test_verdict", Path(folder, "list")], check=True,
                              capture_output=True, text=True).stdout.splitlines()
    if len(told) != len(jobs):
        problems.append(f"{len(jobs)} mutants, but {len(told)} verdicts")
    wrong = 0
    for (path, kind, text, mutant), verdict in zip(jobs, told):
        refused = int(verdict.split()[0]) > 0
        if verdict.split()[2] not in ("MT_OK", "MT_E_INPUT"):
            problems.append(f"{path.name}: {text}: {verdict}")
        wrong += refused
        if text == "as it is" and not verdict.endswith(" MT_OK"):
            problems.append(f"{path}: the reader refuses it")
        if refused == schema_of[kind].validator.is_valid(mutant):
            problems.append(f"{path.name}: {text}: the reader {'refuses' if refused else 'accepts'} it, the schema does not agree")
    if jobs and (wrong == 0 or wrong == len(jobs)):
        problems.append("all verdicts are the same: the comparison cannot fail")
    for problem in problems[:60]:
        print(problem)
    print(f"schemas: {checked} files, {len(jobs)} mutants ({wrong} wrong in structure), {len(problems)} problems")
    sys.exit(1 if problems or checked == 0 or not jobs else 0)


if __name__ == "__main__":
    main()

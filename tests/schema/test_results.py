# SPDX-License-Identifier: GPL-3.0-or-later
"""Every shipped study holds what it publishes. Its result.json validates against its schema, every member of which appears, also those that results of older
programs lack: a member that the writer drops is missed here. Read back, it gives all files and texts again, to the byte: of some studies what takes long is left to MT_EVERY=1."""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import jsonschema

from common_schema import ROOT, Schema, changed, load

sys.path.append(str(ROOT / "tests/support"))
from suite import EVERY  # noqa: E402
from answers import PROGRAM, answer, answers  # noqa: E402

# They take longest to be read back, and have nothing that others have not.
NOT_AGAIN = set() if EVERY else {"inceptor_catalogue", "inceptor_identification", "inceptor_prediction", "inceptor_rotor",
                                                     "inceptor_tuning_2", "inceptor_tuning_3"}

SHIPPED = sorted((ROOT / "studies").glob("*.json"))

# One mass on a spring between 800 and 1200 N/m: 4.50 to 5.51 Hz.
MODEL = {
    "format": "modetune-model/1", "name": "One mass", "dimension": 2, "parameters": {"k": {"value": 1000, "unit": "N/m"}},
    "bodies": [{"name": "m", "mass_kg": 1, "centre": [1, 0]}],
    "joints": [{"name": "rail", "type": "pin-in-slot", "bodies": ["ground", "m"], "at": [1, 0], "axis": [1, 0]}],
    "springs": [{"name": "s", "type": "axial", "bodies": ["ground", "m"], "at": [[0, 0], [1, 0]], "stiffness_n_per_m": "k"}],
}
VARIABLES = [{"parameter": "k", "lower": 800, "upper": 1200}]
# What the shipped studies do not show: an answer that there is none, and a number that is asked for instead of the study's.
EXTRA = {
    "none": {"variables": VARIABLES, "goals": [{"type": "frequency", "mode": 1, "at_least_hz": 6}]},
    # between two positions of a drive
    "swung": {"model": "arm.json", "variables": VARIABLES, "goals": [
        {"type": "response", "configurations": ["down", "up"], "input": "tip.x", "output": "tip.x", "at_hz": 3, "at_most": 1e-6}]},
}
# The mass slides along an arm that is driven to where it is held.
ARM = MODEL | {
    "name": "Mass on an arm",
    "bodies": [{"name": "arm", "mass_kg": 1, "inertia_kg_m2": 1, "centre": [0, 0]}, {"name": "m", "mass_kg": 1, "inertia_kg_m2": 1, "centre": [1, 0]}],
    "joints": [{"name": "pivot", "type": "revolute", "bodies": ["ground", "arm"], "at": [0, 0]},
               {"name": "rail", "type": "prismatic", "bodies": ["arm", "m"], "at": [1, 0], "axis": [1, 0]}],
    "springs": [MODEL["springs"][0] | {"bodies": ["arm", "m"]}],
    "sensors": [{"name": "tip", "on": "m", "at": [1, 0], "directions": ["x"]}],
    "configurations": {name: {"drive": {"joint": "pivot", "position_rad": at, "hold": "lock"}} for name, at in (("down", -0.5), ("up", 0.7))},
}


def studies(folder):
    for name, model in (("model", MODEL), ("arm", ARM)):
        (folder / f"{name}.json").write_text(json.dumps(model), encoding="utf-8")
    for name, members in EXTRA.items():
        study = {"format": "modetune-study/1", "name": name, "model": "model.json", **members}
        (folder / f"{name}.json").write_text(json.dumps(study), encoding="utf-8")
    return SHIPPED + [folder / f"{name}.json" for name in EXTRA]


def objects(schema, where="#"):
    """All schemas of objects with named members, with their place."""
    if isinstance(schema, dict):
        if isinstance(schema.get("properties"), dict):
            yield where, schema
        for key, value in schema.items():
            yield from objects(value, f"{where}/{key}")
    elif isinstance(schema, list):
        for i, value in enumerate(schema):
            yield from objects(value, f"{where}/{i}")


def members_of(value, path=()):
    """The place of each member of each object; of lists only what the first and the last entry hold."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield path + (key,)
            yield from members_of(inner, path + (key,))
    elif isinstance(value, list) and value:
        for i in sorted({0, len(value) - 1}):
            yield from members_of(value[i], path + (i,))


def accounted(study, result):
    """What was spent adds up, and has room for all that the result shows."""
    spent = dict(result["run"]["spent"])
    designs = [result["baseline"], *result["recommendations"]]
    positions = sum(m["positions"] for d in designs for m in d["motion"] + d["responses_between"])
    spent.pop("multiplications")
    good = (sum(spent.values()) == result["run"]["evaluations"] and spent["descriptions"] >= 2 * len(designs) and spent["positions"] >= positions
            and (spent["trade"] > 0) == (result["trade"] is not None))
    return [] if good else [f"{study.name}: does not add up: {result['run']}"]


def seen_in(schema, root, value, seen, where="#"):
    """Note which objects of the schema the value has an example of."""
    while "$ref" in schema:
        where = schema["$ref"]
        schema = root["definitions"][where.rsplit("/", 1)[1]]
    for part in schema.get("allOf", []):
        seen_in(part, root, value, seen, where)
    if "if" in schema:
        branch = "then" if jsonschema.Draft7Validator(dict(schema["if"], definitions=root["definitions"])).is_valid(value) else "else"
        seen_in(schema.get(branch, {}), root, value, seen, f"{where}/{branch}")
    if isinstance(value, dict):
        if "properties" in schema:
            seen.add(where)
        for key, inner in value.items():
            if key in schema.get("properties", {}):
                seen_in(schema["properties"][key], root, inner, seen, f"{where}/properties/{key}")
    elif isinstance(value, list) and isinstance(schema.get("items"), dict):
        for inner in value:
            seen_in(schema["items"], root, inner, seen, f"{where}/items")


def run(*line):
    return subprocess.run([PROGRAM, *map(str, line), "--quiet"], capture_output=True, timeout=600)


def reported(study, path, ran, verify, again):
    """What "report" makes of the result alone is what "run" made: every file, and what both print."""
    told = run("report", path, "-o", again, *verify)
    if told.returncode != 0 or told.stdout != ran.stdout:
        yield f"{study.name}: report prints something else than run: exit {told.returncode}: {told.stderr.decode()[:300]}"
    for file in sorted(path.parent.iterdir()):
        other = again / study.stem / file.name
        if not other.exists() or other.read_bytes() != file.read_bytes():
            yield f"{study.name}: report writes another {file.name}"


# Members of kinds of goals and variables that no shipped study has, absent elsewhere: result/test_result_file has them all.
WHERE_ASKED = {"of_configuration", "of_mode", "of_name", "catalogue", "part"}


def required(study, schema, result, dropped):
    """Without any of its members a result is not valid: one of each kind that was not tried before."""
    for member in members_of(result):
        kind = tuple(step for step in member if isinstance(step, str))
        if kind in dropped or kind[-1] in WHERE_ASKED or kind[-2:-1] in (("sensitivity",), ("design",), ("components",)):
            continue
        dropped.add(kind)
        if schema.validator.is_valid(changed(result, member, "drop")):
            yield f"{study.name}: without {'/'.join(map(str, member))} it is valid all the same"


OF_CUT = {"#/definitions/unchecked"}  # of a run that was cut: cli/test_budget, cli/test_interrupts; result/test_result_file has one


def main():
    schema = Schema("result")
    problems, seen, checked, dropped = [], set(), 0, set()
    for _, part in objects(schema.text):
        part["required"] = [name for name in part["properties"] if name not in WHERE_ASKED]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        answers(SHIPPED)
        for study in studies(folder):
            verify = [] if study.stem in EXTRA else ["--verify"]
            ran = run("run", study, "-o", folder, "--starts", "3") if study.stem in EXTRA else answer(study)
            path = (folder if study.stem in EXTRA else ran.folder.parent) / study.stem / "result.json"
            if ran.returncode != (0 if verify else 1) or not path.exists():
                problems.append(f"{study.name}: exit {ran.returncode}: {ran.stderr.decode()}{ran.stdout.decode()[-2000:]}")
                continue
            result = load(path)
            problems += [f"{study.name}: {e.json_path}: {e.message}" for e in schema.errors_of_original(result)]
            if study.stem not in NOT_AGAIN:
                problems += reported(study, path, ran, verify, folder / "again")
            seen_in(schema.text, schema.text, result, seen)
            problems += accounted(study, result)
            checked += 1
            problems += required(study, schema, result, dropped)
    problems += [f"{where}: no result has one" for where, _ in objects(schema.text) if where not in seen | OF_CUT]
    for problem in problems[:60]:
        print(problem)
    print(f"results: {checked} studies, {len(dropped)} kinds of member, {len(problems)} problems")
    sys.exit(1 if problems or checked < 15 or not dropped else 0)


if __name__ == "__main__":
    main()

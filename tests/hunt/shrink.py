#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes a finding small: drops parts of study and model, one at a time, as long as the same check still fails.

    shrink.py DIR MODEL STUDY CHECK     writes DIR/model.json and DIR/study.json
    shrink.py DIR SEED:KIND:INDEX CHECK
"""
import copy
import json
import re
import sys
import tempfile
from pathlib import Path

import run


def fails(model, study, check):
    with tempfile.TemporaryDirectory() as folder:
        run.write(Path(folder), "case", model, study)
        try:
            answer = run.solve(Path(folder), ["case"])["case"]
            return [text for name, text in run.findings("case", model, study, answer) if name == check]
        except Exception:  # a part was dropped that another one needs
            return []


def _smaller(model, study):
    """Copies with one thing less."""
    for member in [m for m in study if m not in ("format", "model", "goals", "variables")]:
        yield model, {k: v for k, v in study.items() if k != member}
    for whole in ("variables", "goals"):
        for i, item in enumerate(study.get(whole, [])):
            if len(study[whole]) > 1:
                yield model, {**study, whole: study[whole][:i] + study[whole][i + 1:]}
            for member in [m for m in item if m not in ("parameter", "type", "lower", "upper")]:
                less = copy.deepcopy(study)
                del less[whole][i][member]
                yield model, less
            for k in range(len(item.get("bands_hz", []))):
                less = copy.deepcopy(study)
                del less[whole][i]["bands_hz"][k]
                yield model, less
    for member in [m for m in model if m not in ("format", "dimension", "bodies", "parameters")]:
        yield {k: v for k, v in model.items() if k != member}, study
    for whole in ("springs", "bodies"):
        for i, item in enumerate(model.get(whole, []) if not any("preload_n" in s for s in model.get("springs", [])) else []):
            less = copy.deepcopy(model)
            del less[whole][i]
            if whole == "bodies":
                for other in ("springs", "joints"):
                    less[other] = [o for o in less.get(other, []) if item["name"] not in o.get("bodies", [])]
            yield less, study
            for member in [m for m in item if m in ("in", "density_kg_per_m3", "inertia_kg_m2")]:
                less = copy.deepcopy(model)
                del less[whole][i][member]
                yield less, study
    for whole in ("parameters", "configurations"):
        for name in list(model.get(whole, {})):
            less = copy.deepcopy(model)
            del less[whole][name]
            yield less, study


def _sort(text):
    """What kind of finding it is: its first words without numbers."""
    return re.sub(r"[-\d.e+]+", "#", text)[:20]


def shrink(model, study, check):
    first, progress = fails(model, study, check), True
    while progress and first:
        progress = False
        for smaller in _smaller(model, study):
            if any(_sort(text) == _sort(first[0]) for text in fails(*smaller, check)):
                (model, study), progress = smaller, True
                break
    return model, study


def main():
    folder, what, check = Path(sys.argv[1]), sys.argv[2:-1], sys.argv[-1]
    if len(what) == 1:
        seed, kind, index = what[0].split(":")
        model, study = run.make(seed, kind, int(index))
    else:
        model, study = (json.loads(Path(w).read_text()) for w in what)
    model, study = shrink(model, study, check)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "model.json").write_text(json.dumps(model, indent=1) + "\n")
    (folder / "study.json").write_text(json.dumps({**study, "model": "model.json"}, indent=1) + "\n")
    print("\n".join(fails(model, study, check)) or "does not fail")


if __name__ == "__main__":
    main()

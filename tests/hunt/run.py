#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The hunt: random studies, every claim of whose results is held against brute force.

The command line is that of every campaign (tests/support/campaign.py).
"""
import copy
import itertools
import json
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parent), str(Path(__file__).resolve().parents[1] / "support")]

import campaign  # noqa: E402  first: it sets what numpy reads
import numpy as np  # noqa: E402

import check_again  # noqa: E402
import check_claims  # noqa: E402
import check_numbers  # noqa: E402
import check_relaxed  # noqa: E402
import check_words  # noqa: E402
import studies  # noqa: E402
from question import Question  # noqa: E402

CHECKS = {**check_numbers.CHECKS, **check_claims.CHECKS, **check_words.CHECKS, **check_relaxed.CHECKS}
WORKERS_EVERY = 4  # batches: one of so many is run with two workers, too


class Said(str):
    """Standard error; with it in `texts`, by name, what else was written."""

    def __new__(cls, text, texts):
        said = super().__new__(cls, text)
        said.texts = texts
        return said


class Run:
    """One study and its result."""

    def __init__(self, name, model, study, result, words):
        self.name, self.model, self.study, self.result, self.words = name, model, study, result, words
        self.question = Question(model, study)
        self.sampled = None  # designs all over the bounds, and what each misses (check_claims.py)
        self.found = None  # what brute force found, once it has searched (check_claims.py)
        self.here = None   # the cost where rank 1 is, by a search of ours (check_words.py)


def write(folder, name, model, study):
    (folder / name).mkdir(parents=True, exist_ok=True)
    (folder / name / "model.json").write_text(json.dumps(model, indent=1))
    (folder / name / f"{name}.json").write_text(json.dumps(study, indent=1))
    return str(folder / name / f"{name}.json")


def solve(folder, names, threads=1, out="out"):
    """{name: (exit code, standard error, result or None)}; the exit code of a batch is the worst of its studies."""
    paths = [str(folder / n / f"{n}.json") for n in names]
    command = [campaign.PROGRAM, "run", *paths, "-o", str(folder / out), "--quiet", "--threads", str(threads)]
    try:
        done = subprocess.run(command, capture_output=True, encoding="utf-8", timeout=600)
    except subprocess.TimeoutExpired:
        done = subprocess.CompletedProcess(command, -1, "", "not done in ten minutes")
    answers = {}
    for name in names:
        path = folder / out / name / "result.json"
        texts = {p.name: p.read_text(encoding="utf-8") for p in sorted(path.parent.glob("*")) if p.suffix in (".json", ".csv", ".html")}
        said = Said(done.stderr, {"standard output": done.stdout, **texts})
        answers[name] = (done.returncode, said, json.loads(texts["result.json"]) if path.exists() else None)
    if len(names) > 1 and (done.returncode not in (0, 1) or any(a[2] is None for a in answers.values())):
        for name in names:  # who was it?
            answers.update(solve(folder, [name], threads, out))
    return answers


def refused(code, words):
    """Is this a refusal that the documentation knows?"""
    return code == 2 and "error:" in words and "ERROR:" not in words and "runtime error" not in words


def again(model, asked):
    """(exit code, standard error, result) of each study of one model."""
    with tempfile.TemporaryDirectory() as scratch:
        for i, study in enumerate(asked):
            write(Path(scratch), f"s{i}", model, study)
        answers = solve(Path(scratch), [f"s{i}" for i in range(len(asked))])
        return [answers[f"s{i}"] for i in range(len(asked))]


def findings(name, model, study, answer):
    """(check, sentence) of what is wrong, at most one of each check."""
    code, words, result = answer
    if result is None:
        return [] if refused(code, words) else [("exit", f"exit code {code}: {words[-2000:]}")]
    out = []
    if code not in (0, 1) or "runtime error" in words or "Sanitizer" in words:
        out.append(("exit", f"exit code {code}: {words[-2000:]}"))
    run = Run(name, model, study, result, words)
    checks = {**CHECKS, "trade": lambda r: check_again.trade(r, again)}
    with np.errstate(all="ignore"):
        for check, function in checks.items():
            try:
                out += [(check, text) for text in itertools.islice(function(run), 1)]
            except Exception as fault:  # a fault of this reference ends one check, never the hunt
                out.append(("reference", f"{check}: {fault!r}"))
    return out


def smaller(model, study):
    """Copies of both with one thing less, and what depends on it."""
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


class Hunt(campaign.Generator):
    script, cases, kinds, batch, tallied = "tests/hunt/run.py", "studies", tuple(studies.KINDS), 20, ("refused",)

    def __init__(self, kept=None):
        self.kept = kept  # {(kind, index): (model, study, answer)} of all that was judged

    def make(self, seed, kind, index):
        rng = campaign.draw(seed, kind, index)
        model, study = studies.KINDS[kind](rng)
        return campaign.Case(kind, {"model": model, "study": study}, rng)

    def judge(self, case, folder, tally):
        model, study = case.document["model"], case.document["study"]
        yield from findings("case", model, study, again(model, [study])[0])

    def judge_batch(self, seed, number, batch, folder, tally):
        made = {}
        for kind, index in batch:
            tally["studies"] += 1
            try:
                case = self.make(seed, kind, index).document
            except Exception as fault:  # noqa: BLE001  of this reference ends one study, never the campaign
                yield campaign.Finding(kind, index, "reference", campaign.sentence(fault))
                continue
            made[campaign.name_of(kind, index)] = kind, index, case["model"], case["study"]
        for name, (_, _, model, study) in made.items():
            write(folder, name, model, study)
        answers = solve(folder, list(made))
        differ = []
        if number % WORKERS_EVERY == 0 or len(made) == 1:
            solve(folder, list(made), threads=2, out="two")
            differ = check_again.same_bytes(folder, list(made), "out", "two")
        for name in differ:
            yield campaign.Finding(*made[name][:2], "workers", "the results of one and two workers differ")
        for name, (kind, index, model, study) in made.items():
            tally["refused"] += answers[name][2] is None
            if self.kept is not None:
                self.kept[kind, index] = model, study, answers[name]
            for check, text in findings(name, model, study, answers[name]):
                yield campaign.Finding(kind, index, check, text)

    def smaller(self, document):
        for model, study in smaller(document["model"], document["study"]):
            yield {**document, "model": model, "study": study}
        yield from campaign.smaller(document)

    def write(self, case, folder):
        super().write(case, folder)
        (folder / "model.json").write_text(json.dumps(case.document["model"], indent=1) + "\n")
        (folder / "study.json").write_text(json.dumps({**case.document["study"], "model": "model.json"}, indent=1) + "\n")


if __name__ == "__main__":
    sys.exit(campaign.main(Hunt()))

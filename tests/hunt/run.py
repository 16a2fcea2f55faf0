#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The hunt: random studies, every claim of whose results is held against brute force.

    run.py [--seed S] [--count N] [--seconds T] [--only KIND] [--index I] [--keep DIR]

Study I of kind KIND with seed S is the same on every machine; a finding says how to see it again.
"""
import argparse
import itertools
import json
import os
import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.dont_write_bytecode = True

import numpy as np  # noqa: E402

import check_again  # noqa: E402
import check_claims  # noqa: E402
import check_numbers  # noqa: E402
import check_relaxed  # noqa: E402
import check_words  # noqa: E402
import studies  # noqa: E402
from known import reason  # noqa: E402
from question import Question  # noqa: E402

SOURCE = Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("MODETUNE", str(SOURCE / "build/release/modetune"))
CHECKS = {**check_numbers.CHECKS, **check_claims.CHECKS, **check_words.CHECKS, **check_relaxed.CHECKS}
BATCH = 20
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


def make(seed, kind, index):
    return studies.KINDS[kind](random.Random(f"{seed}:{kind}:{index}"))


def write(folder, name, model, study):
    (folder / name).mkdir(parents=True, exist_ok=True)
    (folder / name / "model.json").write_text(json.dumps(model, indent=1))
    (folder / name / f"{name}.json").write_text(json.dumps(study, indent=1))
    return str(folder / name / f"{name}.json")


def solve(folder, names, threads=1, out="out"):
    """{name: (exit code, standard error, result or None)}; the exit code of a batch is the worst of its studies."""
    paths = [str(folder / n / f"{n}.json") for n in names]
    command = [PROGRAM, "run", *paths, "-o", str(folder / out), "--quiet", "--threads", str(threads)]
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


def hunt(seed, kinds, indices, tally, seconds=None, keep=None, kept=None):
    """Yields (kind, index, check, text) of findings; counts in tally what was done, keeps (model, study, answer) of each in `kept`."""
    started = time.monotonic()
    todo = [(k, i) for i in indices for k in kinds]
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(keep or scratch)
        for number, first in enumerate(range(0, len(todo), BATCH)):
            if seconds is not None and time.monotonic() - started > seconds:
                return
            batch = {}
            for kind, index in todo[first:first + BATCH]:
                try:
                    batch[f"{kind}_{index}"] = (kind, index, *make(seed, kind, index))
                except Exception as fault:  # a fault of this reference ends one study, never the hunt
                    tally["studies"] += 1
                    yield kind, index, "reference", repr(fault)
            for name, (_, _, model, study) in batch.items():
                write(folder, name, model, study)
            answers = solve(folder, list(batch))
            differ = []
            if number % WORKERS_EVERY == 0 or len(batch) == 1:
                solve(folder, list(batch), threads=2, out="two")
                differ = check_again.same_bytes(folder, list(batch), "out", "two")
            for name in differ:
                yield *batch[name][:2], "workers", "the results of one and two workers differ"
            for name, (kind, index, model, study) in batch.items():
                tally["studies"] += 1
                tally["refused"] += answers[name][2] is None
                if kept is not None:
                    kept[kind, index] = model, study, answers[name]
                for check, text in findings(name, model, study, answers[name]):
                    yield kind, index, check, text


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", default="1")
    parser.add_argument("--count", type=int, default=20, help="studies of each kind")
    parser.add_argument("--seconds", type=float)
    parser.add_argument("--only", choices=list(studies.KINDS), action="append")
    parser.add_argument("--index", type=int)
    parser.add_argument("--known", action="store_true", help="show findings that wait for their mending, too")
    parser.add_argument("--rare", type=float, default=0.0, help="findings per study up to which the exit status is 0 (but of one always, where not 0)")
    parser.add_argument("--keep", help="write studies and results here")
    args = parser.parse_args()
    indices = range(args.count) if args.index is None else [args.index]
    bad, waiting, tally = 0, 0, {"studies": 0, "refused": 0}
    for kind, index, check, text in hunt(args.seed, args.only or list(studies.KINDS), indices, tally, args.seconds, args.keep):
        known = reason(check, kind)
        bad, waiting = bad + (known is None), waiting + (known is not None)
        if known is None or args.known or args.index is not None:
            print(f"{check}: {text}{f' (known: {known})' if known else ''}\n"
                  f"    tests/hunt/run.py --seed {args.seed} --only {kind} --index {index}", flush=True)
    print(f"{tally['studies']} studies of seed {args.seed} ({tally['refused']} refused): {bad} findings, {waiting} known")
    return 1 if bad > max(args.rare > 0, args.rare * tally["studies"]) else 0


if __name__ == "__main__":
    sys.exit(main())

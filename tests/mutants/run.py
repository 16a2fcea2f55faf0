#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Mutants: shipped files, changed at random, through every command.

    run.py [--seed S] [--count N] [--seconds T] [--only KIND] [--index I] [--keep DIR] [--shrink DIR]

Mutant I of kind KIND with seed S is the same on every machine; a finding says how to see it again. MODETUNE names the program; one with
sanitizers is recognised.
"""
import argparse
import os
import random
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
sys.setrecursionlimit(20_000)

import document  # noqa: E402
import harmless  # noqa: E402
import mutations  # noqa: E402
from commands import Answer, Program  # noqa: E402
from corpus import SOURCE, Corpus  # noqa: E402
from known import reason  # noqa: E402

PROGRAM = os.environ.get("MODETUNE", str(SOURCE / "build/release/modetune"))
KINDS = ["model", "study", "result", "aircraft", "profile", "bytes", "harmless"]
WEIGHTS = {"model": 6, "study": 6, "result": 1, "aircraft": 1, "profile": 2, "bytes": 2, "harmless": 2}  # of mutants, where all kinds are asked for
ROUND = [kind for kind, weight in WEIGHTS.items() for _ in range(weight)]
STEPS = (1, 1, 1, 1, 1, 2, 2, 3, 10)
GUIDED = 5  # tries of a change that the program still takes


def make(program, corpus, seed, kind, index):
    """(case, generator of the commands' random numbers, what was done to it)."""
    rng = random.Random(f"{seed}:{kind}:{index}")
    case = corpus.pick(rng, kind if kind in corpus.trees else rng.choice(("model", "study", "study", "aircraft", "profile", "result")))
    done = []
    if kind == "bytes":
        texts = list(case.files.values())
        case.files[case.target] = mutations.by_bytes(rng, case.files[case.target], texts)
        return case, rng, ["bytes"]
    tree, guided = document.copy(case.original), kind in ("model", "study", "profile") and rng.random() < 0.5
    for _ in range(GUIDED if guided else rng.choice(STEPS)):
        mutate, less = rng.choice(mutations.GENTLE if guided else mutations.BY_NODE), document.copy(tree)
        if mutate(rng, less, corpus) is False:
            continue
        harmless.tame(less, case.kind)
        case.files[case.target] = document.write(less, 2)
        if not guided or _taken(program, case):
            tree = less
            done.append(mutate.__name__)
    case.files[case.target] = document.write(tree, 2)
    return case, rng, done


def _taken(program, case):
    """Does the program take the case's file for a good one (or fail in a way that is to be seen)?"""
    with tempfile.TemporaryDirectory() as folder:
        case.write(Path(folder))
        return program.run(Path(folder), ["check", case.target]).code not in (2, 3)


def findings(program, corpus, case, rng, tally, keep=None):
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(keep or scratch)
        case.write(folder)
        yield from Answer(program, folder, case, tally).findings(rng)


def one(program, corpus, seed, kind, index, tally, keep=None):
    """(check, sentence) of mutant `index`; a mistake of ours in a case is a finding, too."""
    try:
        if kind == "harmless":
            yield from harmless.findings(program, corpus, random.Random(f"{seed}:{kind}:{index}"), tally, keep)
            return
        case, rng, done = make(program, corpus, seed, kind, index)
        for check, text in findings(program, corpus, case, rng, tally, keep):
            yield check, f"{case.name} ({', '.join(done)}): {text}"
    except Exception as why:  # noqa: BLE001
        yield "reference", f"{type(why).__name__}: {why}"


def hunt(program, seed, todo, tally, seconds=None, keep=None):
    """Yields (kind, index, check, text); counts in tally what was done."""
    corpus, started = Corpus(program.path), time.monotonic()
    for kind, index in todo:
        if seconds is not None and time.monotonic() - started > seconds:
            return
        tally["mutants"] += 1
        folder, told = Path(keep) / f"{kind}_{index}" if keep else None, set()
        for check, text in one(program, corpus, seed, kind, index, tally, folder):
            if check not in told:  # of each kind of finding the first
                told.add(check)
                yield kind, index, check, text


def rounds(kinds, count):
    """The kinds by their weights, `count` mutants in all."""
    order = [k for k in ROUND if k in kinds]
    of = dict.fromkeys(kinds, 0)
    for i in range(count):
        kind = order[i % len(order)]
        yield kind, of[kind]
        of[kind] += 1


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", default="1")
    parser.add_argument("--count", type=int, default=200, help="mutants in all")
    parser.add_argument("--seconds", type=float)
    parser.add_argument("--only", choices=KINDS, action="append")
    parser.add_argument("--index", type=int)
    parser.add_argument("--rare", type=float, default=0.0, help="findings per mutant up to which the exit status is 0 (but of one always, where not 0)")
    parser.add_argument("--known", action="store_true", help="show findings that wait for their mending, too")
    parser.add_argument("--keep", help="write files and outputs here")
    parser.add_argument("--shrink", help="make the first finding small, and write its files here")
    args = parser.parse_args()
    kinds, program = args.only or KINDS, Program(PROGRAM)
    todo = rounds(kinds, args.count) if args.index is None else [(k, args.index) for k in kinds]
    bad, waiting, tally = 0, 0, {"mutants": 0, "commands": 0}
    for kind, index, check, text in hunt(program, args.seed, todo, tally, args.seconds, args.keep):
        known = reason(check, text)
        bad, waiting = bad + (known is None), waiting + (known is not None)
        if known is None or args.known or args.index is not None:
            print(f"{check}: {text}{f' (known: {known})' if known else ''}\n"
                  f"    MODETUNE={os.path.relpath(PROGRAM)} tests/mutants/run.py --seed {args.seed} --only {kind} --index {index}", flush=True)
        if args.shrink and kind != "harmless":
            import shrink
            shrink.save(program, make(program, Corpus(program.path), args.seed, kind, index)[0], check, text, Path(args.shrink))
            return 1
    more = ", ".join(f"{k}: {v}" for k, v in tally.items() if k != "mutants")
    print(f"{tally['mutants']} mutants of seed {args.seed} ({more}): {bad} findings, {waiting} known")
    return 1 if bad > max(args.rare > 0, args.rare * tally["mutants"]) else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Mutants: shipped files, changed at random, through every command.

The command line is that of every campaign (tests/support/campaign.py). MODETUNE names the program; one with sanitizers is recognised.
"""
import copy
import json
import random
import re
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parent), str(Path(__file__).resolve().parents[1] / "support")]
sys.setrecursionlimit(20_000)

import campaign  # noqa: E402
import document  # noqa: E402
import harmless  # noqa: E402
import mutations  # noqa: E402
from commands import Answer, Program  # noqa: E402
from corpus import Case, Corpus  # noqa: E402

WEIGHTS = {"model": 6, "study": 6, "result": 1, "aircraft": 1, "profile": 2, "bytes": 2, "harmless": 2}  # of mutants, where all kinds are asked for
ROUND = [kind for kind, weight in WEIGHTS.items() for _ in range(weight)]
STEPS = (1, 1, 1, 1, 1, 2, 2, 3, 10)
GUIDED = 5  # tries of a change that the program still takes


def mutate(program, corpus, rng, kind):
    """A shipped case with its harm done, and what that was."""
    case = corpus.pick(rng, kind if kind in corpus.trees else rng.choice(("model", "study", "study", "aircraft", "profile", "result")))
    done = []
    if kind == "bytes":
        texts = list(case.files.values())
        case.files[case.target] = mutations.by_bytes(rng, case.files[case.target], texts)
        return case, ["bytes"]
    tree, guided = document.copy(case.original), kind in ("model", "study", "profile") and rng.random() < 0.5
    for _ in range(GUIDED if guided else rng.choice(STEPS)):
        change, less = rng.choice(mutations.GENTLE if guided else mutations.BY_NODE), document.copy(tree)
        if change(rng, less, corpus) is False:
            continue
        harmless.tame(less, case.kind)
        case.files[case.target] = document.write(less, 2)
        if not guided or _taken(program, case):
            tree = less
            done.append(change.__name__)
    case.files[case.target] = document.write(tree, 2)
    return case, done


def _taken(program, case):
    """Does the program take the case's file for a good one (or fail in a way that is to be seen)?"""
    with tempfile.TemporaryDirectory() as folder:
        case.write(Path(folder))
        return program.run(Path(folder), ["check", case.target]).code not in (2, 3)


def rounds(kinds, count):
    """The kinds by their weights, `count` mutants in all."""
    order = [k for k in ROUND if k in kinds]
    of = dict.fromkeys(kinds, 0)
    for i in range(count):
        kind = order[i % len(order)]
        yield kind, of[kind]
        of[kind] += 1


class Mutants(campaign.Generator):
    script, cases, kinds, count, tallied = "tests/mutants/run.py", "mutants", tuple(WEIGHTS), 200, ("commands",)

    def __init__(self, program):
        self.program, self.corpus = program, Corpus(program.path)

    def todo(self, kinds, count):
        return rounds(kinds, count)

    def make(self, seed, kind, index):
        rng = campaign.draw(seed, kind, index)
        if kind == "harmless":
            return campaign.Case(kind, self.corpus.pick(rng, rng.choice(("model", "model", "study"))), rng)
        case, done = mutate(self.program, self.corpus, rng, kind)
        return campaign.Case(kind, case, rng, f"{case.name} ({', '.join(done)}): ")

    def judge(self, case, folder, tally):
        if case.kind == "harmless":
            found = harmless.compare(self.program, case.rng, case.document, case.rng.choice(sorted(harmless.CHANGES)), folder, tally)
        else:
            case.document.write(folder)
            found = Answer(self.program, folder, case.document, tally).findings(case.rng)
        told = set()
        for check, text in found:
            if check not in told:  # of each kind of finding the first
                told.add(check)
                yield check, text

    def saved(self, name, kept, number=0):
        case = Case(kept["kind"], name, document.Object(), {})
        case.files = {place: text if isinstance(text, str) else json.dumps(text) for place, text in kept["files"].items()}
        case.original = document.read(case.files[case.target])
        return campaign.Case(kept["kind"], case, random.Random(number))

    def alike(self, case):
        """A saved case is judged with the draws of small numbers."""
        return [case] if case.kind == "harmless" else [replace(case, rng=random.Random(number)) for number in range(12)]

    def smaller(self, case):
        for place in sorted(case.files, key=lambda p: p != case.target):
            try:
                tree = document.read(case.files[place])
            except (ValueError, TypeError, RecursionError):
                continue  # harmed below the level of JSON
            for tree in campaign.smaller(tree, document):
                less = copy.copy(case)
                less.files = {**case.files, place: document.write(tree, 1)}
                yield less

    def likeness(self, text):
        """Its words without numbers and places; of a sanitizer's report where it happened."""
        text = text.rsplit(": ", 3)[-1] if "Sanitizer" not in text else "".join(re.findall(r"#\d+ 0x\w+ in (\w+)", text)[:6])
        return re.sub(r"[-\d.e+]+", "#", text)[:60]

    def write(self, case, folder):
        case.document.write(folder)
        files = {place: text.decode("utf-8", "surrogateescape") if isinstance(text, bytes) else text for place, text in case.document.files.items()}
        (folder / "case.json").write_text(json.dumps({"holds": "", "kind": case.document.kind, "files": files}, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    sys.exit(campaign.main(Mutants(Program(campaign.PROGRAM))))

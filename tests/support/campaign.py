# SPDX-License-Identifier: GPL-3.0-or-later
"""A campaign of random cases, which every generator of tests/ shares: seeds, time, processes, saved and known cases, shrinking, counting, printing.

    SCRIPT [--seed S] [--count N] [--seconds T] [--only KIND] [--index I] [--jobs N]     cases of seed S
    SCRIPT --seed S [--only KIND] --index I [--keep DIR] [--shrink DIR]                  one of them again, with its files; as small as it still fails
    SCRIPT --case FILE [--keep DIR] [--shrink DIR]                                       a saved one

Case I of kind KIND with seed S is the same on every machine, whatever else is asked of the campaign; a finding is printed with the command that shows it again.
A generator is a subclass of Generator: it makes cases and judges them. The tests of the suite run it by hold() and hold_saved().
"""
import argparse
import collections
import copy
import itertools
import json
import multiprocessing
import os
import random
import re
import shlex
import sys
import tempfile
import time
import traceback
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy is loaded
sys.dont_write_bytecode = True

from known import KNOWN  # noqa: E402
from suite import PROGRAM, SOURCE  # noqa: E402

Finding = collections.namedtuple("Finding", "kind index check text")


def draw(*words):
    """Random numbers by name: of each case its own, so that none has to be made before another."""
    return random.Random(":".join(map(str, words)))


@dataclass
class Case:
    """What is judged: a JSON document, and random numbers for what the judge draws."""
    kind: str
    document: object
    rng: random.Random
    about: str = ""  # before each sentence on it


class LeftOut(Exception):
    """A case that the generator's reference cannot judge, and why."""


class Tally(dict):
    """Sums by name; of numbers, or of what else can be added."""

    def __missing__(self, name):
        return 0

    def join(self, other):
        for name, value in other.items():
            self[name] = self[name] + value if name in self else value


class Generator:
    """Makes cases and judges them."""
    script = ""      # from the top of the tree
    cases = "cases"  # what the summary calls them
    kinds = ("",)
    count = 20       # of each kind
    batch = 1        # cases that are judged together
    tallied = ()     # what the summary tells of the tally even where it is 0

    def make(self, seed, kind, index):
        """The Case. May raise LeftOut."""
        raise NotImplementedError

    def judge(self, case, folder, tally):
        """Yields (check, sentence) of what is wrong with a case, in a folder of its own. May raise LeftOut."""
        raise NotImplementedError

    def judge_batch(self, seed, number, batch, folder, tally):
        """Yields findings of the cases (kind, index) of batch `number`, and counts them."""
        for kind, index in batch:
            try:
                tally[self.cases] += 1
                case = self.make(seed, kind, index)
                place = folder / name_of(kind, index)
                place.mkdir(parents=True, exist_ok=True)
                for check, text in self.judge(case, place, tally):
                    yield Finding(kind, index, check, case.about + text)
            except LeftOut as why:
                tally[self.cases] -= 1
                tally["left out"] += 1
                tally[str(why)] += 1
            except Exception as fault:  # noqa: BLE001  of this reference ends one case, never the campaign
                yield Finding(kind, index, "reference", sentence(fault))

    def todo(self, kinds, count):
        """(kind, index) in the order in which they are judged."""
        return ((kind, index) for index in range(count) for kind in kinds)

    def options(self, parser):
        """More options of the command line."""

    def asked(self, args):
        """Takes what they are; returns those that a finding is seen again with."""
        return []

    def table(self, tally):
        """Lines before the summary."""
        return []

    def saved(self, name, document, number=0):
        """A saved case, with the random numbers of draw `number`."""
        own = {key: value for key, value in document.items() if key not in ("holds", "kind")}
        return Case(document.get("kind", ""), own, draw(name, *([number] if number else [])))

    def alike(self, case):
        """Cases of the same document, of which the first that has the finding still is made small."""
        yield case

    def smaller(self, document):
        """Documents with less in them, large parts first."""
        return smaller(document)

    def repeated(self, case):
        """(check, sentence) of the same case once more, with the same random numbers."""
        again = replace(case, document=copy.deepcopy(case.document), rng=copy.deepcopy(case.rng))
        with tempfile.TemporaryDirectory() as folder:
            try:
                yield from self.judge(again, Path(folder), Tally())
            except Exception as fault:  # noqa: BLE001  a part was dropped that another one needs, or the reference fails as before
                yield "reference", sentence(fault)

    def likeness(self, text):
        """What kind of finding a sentence tells of: its first words without numbers."""
        return re.sub(r"[-\d.e+]+", "#", text)[:20]

    def write(self, case, folder):
        """The files of a case, for who looks at it; case.json is a saved one, once it says what holds."""
        text = json.dumps({"holds": "", "kind": case.kind, **case.document}, indent=1)
        (folder / "case.json").write_text(text + "\n", encoding="utf-8")


def name_of(kind, index):
    return f"{kind}_{index}".strip("_").replace(" ", "_")


def sentence(fault):
    """An exception of a generator, and where."""
    where = traceback.extract_tb(fault.__traceback__)[-1]
    return f"{Path(where.filename).name}:{where.lineno}: {fault!r}"


def reason(generator, finding):
    """Why a finding is expected; None: it is not."""
    of = (generator.script, finding.check, finding.kind)
    return next((why for *known, part, why in KNOWN if all(k in (None, o) for k, o in zip(known, of)) and part in finding.text), None)


def _judged(generator, seed, number, batch, end, keep):
    """Findings and tally of a batch; None: the time is up."""
    if end is not None and time.monotonic() > end:
        return None
    tally = Tally()
    with tempfile.TemporaryDirectory() as scratch:
        return list(generator.judge_batch(seed, number, batch, Path(keep or scratch), tally)), tally


def _in_processes(generator, jobs, tasks):
    """What _judged says of each task, in their order, however many are at work."""
    # workers are forks: they have the generator, whose corpus would take long to hand over
    with ProcessPoolExecutor(jobs, multiprocessing.get_context("fork"), _adopt, (generator,)) as pool:
        waiting = collections.deque()
        for task in tasks:
            waiting.append(pool.submit(_judged_here, *task))
            if len(waiting) > 2 * jobs:
                yield waiting.popleft().result()
        while waiting:
            yield waiting.popleft().result()


def _adopt(generator):
    _in_processes.generator = generator


def _judged_here(*task):
    return _judged(_in_processes.generator, *task)


def run(generator, seed, todo, tally, seconds=None, keep=None, jobs=1):
    """Yields findings of the cases (kind, index) until the time is up; counts in tally what was done. The same for any number of jobs."""
    end = None if seconds is None else time.monotonic() + seconds
    todo = iter(todo)
    batches = iter(lambda: tuple(itertools.islice(todo, generator.batch)), ())
    tasks = ((seed, number, batch, end, keep) for number, batch in enumerate(batches))
    for done in _in_processes(generator, jobs, tasks) if jobs > 1 else (_judged(generator, *task) for task in tasks):
        if done is None:
            return
        tally.join(done[1])
        yield from done[0]


def again(generator, seed, finding, more=()):
    """The command that shows a finding again."""
    only = ["--only", finding.kind] if len(generator.kinds) > 1 else []
    program = [] if Path(PROGRAM).resolve() == (SOURCE / "build/release/modetune").resolve() else [f"MODETUNE={os.path.relpath(PROGRAM)}"]
    return shlex.join([*program, generator.script, "--seed", seed, *only, "--index", str(finding.index), *more])


# the suite -----------------------------------------------------------------------------------------------------------------
def hold(test, generator, seed, todo):
    """None of these cases has an unknown finding; the tally."""
    tally = Tally()
    fail(test, generator, seed, run(generator, seed, todo, tally))
    return tally


def fail(test, generator, seed, findings):
    """Each unknown finding fails a subtest of the test case, with the command that shows it again."""
    for finding in findings:
        if reason(generator, finding) is None:
            with test.subTest(check=finding.check, kind=finding.kind, index=finding.index):
                test.fail(f"{finding.text}\n{again(generator, seed, finding)}")


def hold_saved(test, generator, folder, share=1, draws=1):
    """What was once found, each share-th, with so many draws of random numbers: a case is a file {"holds": why it is here, ...}."""
    paths = sorted(folder.glob("*.json"))
    test.assertNotEqual(paths, [])
    for path in paths[::share]:
        document = json.loads(path.read_text(encoding="utf-8"))
        for number in range(draws):
            with test.subTest(case=path.stem, draw=number):
                unknown = [f for f in _once(generator, generator.saved(path.stem, document, number)) if reason(generator, f) is None]
                test.assertEqual(unknown, [], document["holds"])


def _once(generator, case):
    return [Finding(case.kind, None, check, case.about + text) for check, text in generator.repeated(case)]


# shrinking -----------------------------------------------------------------------------------------------------------------
def nodes(value, path=()):
    """(path, name, value) of every node below."""
    for key, inner in value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ():
        yield (*path, key), key, inner
        yield from nodes(inner, (*path, key))


def at(root, path):
    for key in path:
        root = root[key]
    return root


def put(root, path, value):
    at(root, path[:-1])[path[-1]] = value


def is_text(value):
    return isinstance(value, str)


def without(tree, path, form=sys.modules[__name__]):
    less = copy.deepcopy(tree)
    del form.at(less, path[:-1])[path[-1]]
    return less


def smaller(tree, form=sys.modules[__name__]):
    """Trees with a node less, the great ones first; or with shorter text. `form` knows the tree: nodes, at, put, is_text."""
    places = sorted(((len(json.dumps(value)), path) for path, _, value in form.nodes(tree)), key=lambda p: (-p[0], str(p[1])))
    for _, path in places:
        yield without(tree, path, form)
    for _, path in places:
        value = form.at(tree, path)
        if form.is_text(value) and len(value) > 20:
            less = copy.deepcopy(tree)
            form.put(less, path, value[:len(value) // 2])
            yield less


def shrink(generator, case, check, text, seconds=None):
    """The case with less and less in it, as long as it has the finding still, until nothing can go or the time is up; None: once more it has it not."""
    like, end = generator.likeness(text), None if seconds is None else time.monotonic() + seconds
    checks = None  # that the case itself fails: one that fails others, too, is another case

    def fails(of):
        found = list(generator.repeated(of))
        return any(c == check and generator.likeness(t) == like for c, t in found) and (checks is None or {c for c, _ in found} <= checks)
    case = next((c for c in generator.alike(case) if fails(c)), None)
    if case is not None:
        checks = {c for c, _ in generator.repeated(case)}
    place, before = 0, case
    while case is not None and (end is None or time.monotonic() < end):
        # on from where something went: what could not go before seldom can now, and is tried again at the end
        document = next(itertools.islice(generator.smaller(case.document), place, None), None)
        if document is None:
            if case is before:
                break
            place, before = 0, case
        elif fails(replace(case, document=document)):
            case = replace(case, document=document)
        else:
            place += 1
    return case


def save_shrunk(generator, case, finding, folder, seconds=None):
    """Writes the files of a case as small as it still has the finding; what was done."""
    small = shrink(generator, case, finding.check, finding.text.removeprefix(case.about), seconds)
    if small is None:
        return "once more there is no such finding: not made small"
    folder.mkdir(parents=True, exist_ok=True)
    generator.write(small, folder)
    return f"{sum(path.stat().st_size for path in folder.rglob('*') if path.is_file())} bytes in {folder}"


# the command line ----------------------------------------------------------------------------------------------------------
def _parser(generator):
    parser = argparse.ArgumentParser(description=(sys.modules["__main__"].__doc__ or generator.cases).splitlines()[0])
    parser.add_argument("--seed", default="1")
    parser.add_argument("--count", type=int, default=generator.count, help=f"{generator.cases} of each kind, default %(default)s")
    parser.add_argument("--seconds", type=float, help="no further one after so many; then a finding is not made smaller, either")
    if len(generator.kinds) > 1:
        parser.add_argument("--only", choices=list(generator.kinds), action="append", metavar="KIND", help="one of: " + ", ".join(generator.kinds))
    parser.add_argument("--index", type=int, help="this one alone")
    parser.add_argument("--jobs", type=int, default=1, help="processes that share the work; which cases are made does not depend on it")
    parser.add_argument("--case", type=Path, help="a saved one in place of random ones")
    parser.add_argument("--rare", type=float, default=0.0, help="findings per case up to which the exit status is 0 (but of one always, where not 0)")
    parser.add_argument("--known", action="store_true", help="show findings that wait for their mending, too")
    parser.add_argument("--keep", help="write files here")
    parser.add_argument("--shrink", type=Path, help="make the first finding small, and write its files here")
    generator.options(parser)
    return parser


def _saved(generator, args):
    """Judges a saved case."""
    case = generator.saved(args.case.stem, json.loads(args.case.read_text(encoding="utf-8")))
    if args.keep:
        Path(args.keep).mkdir(parents=True, exist_ok=True)
        generator.write(case, Path(args.keep))
    found = _once(generator, case)
    for finding in found:
        print(f"{finding.check}: {finding.text}")
    if args.shrink and found:
        print(save_shrunk(generator, case, found[0], args.shrink, args.seconds))
    print(f"{args.case}: {len(found)} findings")
    return 1 if found else 0


def main(generator, words=None):
    """The campaign that the command line asks for; its exit status."""
    args = _parser(generator).parse_args(words)
    more = generator.asked(args)
    if args.case:
        return _saved(generator, args)
    kinds = getattr(args, "only", None) or list(generator.kinds)
    todo = generator.todo(kinds, args.count) if args.index is None else [(kind, args.index) for kind in kinds]
    bad, waiting, tally = 0, 0, Tally(dict.fromkeys((generator.cases, *generator.tallied), 0))
    for finding in run(generator, args.seed, todo, tally, args.seconds, args.keep, args.jobs):
        known = reason(generator, finding)
        bad, waiting = bad + (known is None), waiting + (known is not None)
        if known is None or args.known or args.index is not None:
            print(f"{finding.check}: {finding.text}{f' (known: {known})' if known else ''}\nagain: {again(generator, args.seed, finding, more)}", flush=True)
        if args.shrink:
            print(save_shrunk(generator, generator.make(args.seed, finding.kind, finding.index), finding, args.shrink, args.seconds))
            return 1
    for line in generator.table(tally):
        print(line)
    told_of = ", ".join(f"{name}: {n}" for name, n in tally.items() if name != generator.cases and isinstance(n, int))
    print(f"{tally[generator.cases]} {generator.cases} of seed {args.seed}{f' ({told_of})' if told_of else ''}: {bad} findings, {waiting} known")
    return 1 if bad > max(args.rare > 0, args.rare * tally[generator.cases]) else 0

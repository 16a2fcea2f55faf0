#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""
The same answer on every processor: shipped studies and random ones of the hunt print the same in every environment.

OpenBLAS has kernels for each kind of processor (OPENBLAS_CORETYPE), libm of glibc functions with and without fused
multiply-add (GLIBC_TUNABLES): one machine stands for several. Each setting is shown to take effect before it counts.

Of shipped studies every digit that is printed is the same. Of random ones the words and their order are, and no number
differs by more than one unit of its last digit, as one at the edge of rounding may.

    MT_EVERY=1                              all shipped studies and eight random ones of each kind, in all environments
    MT_PROCESSORS_SEED=S, _COUNT=N          of random studies, N of each kind
    MT_PROCESSORS_ONLY=KIND:INDEX           one of them again, with that seed, in all environments
"""
import ctypes.util
import json
import os
import random
import re
import subprocess
import sys
import tempfile
import unittest
from decimal import Decimal, InvalidOperation
from pathlib import Path

SOURCE = Path(os.environ["SOURCE_DIR"])
PROGRAM = os.environ["MODETUNE"]
EVERY = "MT_EVERY" in os.environ
SEED = os.environ.get("MT_PROCESSORS_SEED", "1")
COUNT = int(os.environ.get("MT_PROCESSORS_COUNT", "8" if EVERY else "1"))
ONLY = os.environ.get("MT_PROCESSORS_ONLY")
sys.path.insert(0, str(SOURCE / "tests/hunt"))
sys.dont_write_bytecode = True
for given in ("OPENBLAS_CORETYPE", "GLIBC_TUNABLES"):  # the machine itself is one side
    os.environ.pop(given, None)

# What a kernel of OpenBLAS needs of the processor that runs it, by its name in /proc/cpuinfo.
CORES = {"Prescott": "pni", "Nehalem": "sse4_2", "Haswell": "avx2", "Zen": "avx2", "SkylakeX": "avx512bw"}
NO_FMA = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4"}
CORE_NAME = ("import ctypes, sys; lib = ctypes.CDLL(sys.argv[1]); f = lib.openblas_get_corename; "
             "f.restype = ctypes.c_char_p; print(f().decode())")
LAST_BITS = "import math; print(hash(tuple(g(0.1 + 0.1 * i) for i in range(5000) for g in (math.exp, math.sin, math.log))))"
# Of the ordinary suite: bands that no design avoids, an identification that leaves directions open, designs that mirror each
# other; kinds of random studies with ties, and not much to compute.
FEW = ("six_masses_infeasible", "inceptor_prediction", "beam_identification")
FEW_KINDS = ("targets", "corner", "infeasible", "misfit", "catalogue")
FEW_ENVIRONMENTS = ("Prescott", "without FMA")

# Masked, with the reason.
COUNTS = re.compile(r"^\S+: [0-9.e+-]+ s, .*(; written to \S+)$")  # times are of the day; how many steps a search takes, of the rounding
STARTS = re.compile(r"\b[0-9]+ starts?\b")  # a search ends when its ends repeat: after how many starts, is of the rounding, too
# Columns of tables that are rounding or a bound of it by nature: they say how well a number was computed, not what it is.
ROUNDING_COLUMNS = {
    "residual": "of an eigenpair, in units of rounding",
    "error [Hz]": "a bound of the rounding of a frequency",
}


def environments():
    """{name: variables} of what this machine can stand for, and what it cannot, with the reason."""
    flags = set(Path("/proc/cpuinfo").read_text(encoding="utf-8").split()) if Path("/proc/cpuinfo").exists() else set()
    can = {name: {"OPENBLAS_CORETYPE": name} for name, flag in CORES.items() if flag in flags}
    if {"fma", "avx2"} <= flags:
        can["without FMA"] = dict(NO_FMA)
        can["Prescott without FMA"] = {"OPENBLAS_CORETYPE": "Prescott", **NO_FMA}
    return can


def said(code, variables, *words):
    return subprocess.run([sys.executable, "-c", code, *words], env={**os.environ, **variables}, capture_output=True, text=True,
                          check=True).stdout.strip()


def takes_effect(variables):
    """Is the setting more than a word in the environment?"""
    library = ctypes.util.find_library("openblas")
    core = variables.get("OPENBLAS_CORETYPE")
    if core and (library is None or said(CORE_NAME, variables, library).lower() != core.lower()):
        return False
    return "GLIBC_TUNABLES" not in variables or said(LAST_BITS, variables) != said(LAST_BITS, {})


def number(token):
    """Value and unit of the last digit of a number as it is printed, or None."""
    match = re.fullmatch(r"[(\[]?([+-]?[0-9]+\.?[0-9]*(?:e[+-]?[0-9]+)?)[)\],.:;%]*", token)
    try:
        value = Decimal(match.group(1)) if match else None
    except InvalidOperation:
        value = None
    return None if value is None else (value, Decimal(1).scaleb(value.as_tuple().exponent))


def same_token(a, b, units):
    if a == b:
        return True
    x, y = number(a), number(b)
    return units > 0 and x is not None and y is not None and abs(x[0] - y[0]) <= units * max(x[1], y[1])


def without(table):
    """The lines of a table without its columns of rounding; lines of no table as they are."""
    out, cut = [], []
    for line, following in zip(table, table[1:] + [""]):
        if re.fullmatch(r" *-+(?:  -+)* *", following) and not line.strip().startswith("--"):
            spans = [m.span() for m in re.finditer("-+", following)]
            cut = [(a, b) for a, b in spans if line[a:b].strip() in ROUNDING_COLUMNS]
        elif not line.strip():
            cut = []
        for a, b in cut:
            line = line[:a] + "~" * (b - a) + line[b:]
        out.append(line)
    return out


def printed(text):
    """What is compared of a text."""
    return [STARTS.sub("starts", COUNTS.sub(r"counts\1", line)) for line in without(text.splitlines())]


def differences(a, b, units):
    """Pairs of lines that do not say the same."""
    x, y = printed(a), printed(b)
    if len(x) != len(y):
        return [(f"{len(x)} lines", f"{len(y)} lines")] + [(p, q) for p, q in zip(x, y) if p != q][:1]
    wrong = []
    for p, q in zip(x, y):
        s, t = p.split(), q.split()
        # rules and columns have the width of what stands in them
        if len(s) != len(t) or not all(same_token(i, j, units) or set(i + j) == {"-"} for i, j in zip(s, t)):
            wrong.append((p, q))
    return wrong


def run(paths, variables, folder):
    """{study: what it prints} of each; of one that has no answer, what is wrong with it."""
    out = {}
    for path in paths:
        done = subprocess.run([PROGRAM, "run", str(path), "-o", str(folder), "--quiet", "--threads", "1"],
                              env={**os.environ, **variables}, capture_output=True, text=True, check=False, timeout=800)
        out[path.stem] = done.stdout if done.returncode in (0, 1) else f"exit {done.returncode}\n{done.stderr}"
    return out


def random_studies(folder):
    """Paths of random studies of the hunt, with their models beside them."""
    import studies  # needs numpy, which the comparison does not
    kinds = [k for k in studies.KINDS if EVERY or k in FEW_KINDS]
    todo = [(k, i) for i in range(COUNT) for k in kinds] if not ONLY else [(ONLY.split(":")[0], int(ONLY.split(":")[1]))]
    out = []
    for kind, index in todo:
        model, study = studies.KINDS[kind](random.Random(f"{SEED}:{kind}:{index}"))
        name = f"{kind}_{index}"
        (folder / name).mkdir()
        (folder / name / "model.json").write_text(json.dumps(model), encoding="utf-8")
        out.append(folder / name / f"{name}.json")
        out[-1].write_text(json.dumps(study), encoding="utf-8")
    return out


class Processors(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        every = environments()
        cls.environments = {n: v for n, v in every.items() if EVERY or ONLY or n in FEW_ENVIRONMENTS}
        cls.idle = [n for n, v in cls.environments.items() if not takes_effect(v)]

    def compare(self, paths, units):
        """All of it, then what differs: a study and an environment with the first lines that do."""
        with tempfile.TemporaryDirectory() as scratch:
            here = run(paths, {}, Path(scratch) / "here")
            self.assertTrue(all(here.values()), "every study prints something")
            wrong = []
            for name, variables in self.environments.items():
                there = run(paths, variables, Path(scratch) / name.replace(" ", "_"))
                for study in here:
                    for a, b in differences(here[study], there[study], units)[:3]:
                        wrong.append(f"{study} ({name})\n  here:  {a}\n  there: {b}")
            print(f"{len(paths)} studies in {len(self.environments)} environments: {len(wrong)} lines differ")
            self.assertTrue(not wrong, "\n" + "\n".join(wrong))

    def test_settings_take_effect(self):
        self.assertEqual(self.idle, [])

    @unittest.skipIf(ONLY, "one random study")
    def test_shipped_studies(self):
        self.compare([p for p in sorted((SOURCE / "studies").glob("*.json")) if EVERY or p.stem in FEW], 0)

    def test_random_studies(self):
        with tempfile.TemporaryDirectory() as folder:
            self.compare(random_studies(Path(folder)), 1)

    def test_a_difference_is_noticed(self):
        table = "Modes\n  mode     [Hz]  residual\n  ----  -------  --------\n     1  18.3259   3.1e-16\n\nk = 448.309\n"
        self.assertEqual(differences(table, table.replace("3.1e-16", "7.9e-16"), 0), [])
        self.assertEqual(len(differences(table, table.replace("18.3259", "18.3260"), 0)), 1)
        self.assertEqual(differences(table, table.replace("18.3259", "18.3260"), 1), [])
        self.assertEqual(len(differences(table, table.replace("18.3259", "18.3261"), 1)), 1)
        self.assertEqual(len(differences(table, table.replace("448.309", "471.318"), 1)), 1)
        self.assertEqual(len(differences("A_1 moves it most", "A_3 moves it most", 1)), 1)
        self.assertEqual(len(differences("a\nb\n", "b\na\n", 1)), 2)
        self.assertEqual(len(differences("a\n", "a\nb\n", 1)), 1)
        self.assertEqual(differences("x.json: 0.1 s, 5 evaluations (search 5); written to r/x/",
                                     "x.json: 2 s, 6 evaluations (search 6); written to r/x/", 0), [])


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""
Run time against error: every table, as text, CSV and (where matplotlib is installed) SVG.
    bench.py [--quick] [--only NAME] [--out FOLDER]
elements   a cantilever's first four frequencies by the number of its elements: rigid ones with the physical springs, beam
           elements; errors against the closed form
peers      the same cantilever of n beam elements from its file to its first four frequencies, beside SciPy (banded matrices,
           shift and invert) and CalculiX (B31, *FREQUENCY), each in a process of its own
evaluation one evaluation of shipped studies beside a bare dsyevd (bench_evaluation)
search     distance from the best known answer by evaluations and CPU time (bench_search)
beam       the nine-element beam beside the paper's way in Octave (bench_beam.sh)
Times are CPU seconds of processes without threads, the median of several runs with the spread (largest less smallest) beside it;
a peer that is not installed is left out and named. SOURCE_DIR, BUILD_DIR and MODETUNE as in the tests.
"""
import argparse
import csv
import json
import math
import os
import platform
import re
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

SOURCE = Path(os.environ.get("SOURCE_DIR", Path(__file__).resolve().parents[2]))
BUILD = Path(os.environ.get("BUILD_DIR", SOURCE / "build/release"))
PROGRAM = os.environ.get("MODETUNE", str(BUILD / "modetune"))
ALONE = dict(os.environ, OPENBLAS_NUM_THREADS="1", OMP_NUM_THREADS="1", LC_ALL="C", SOURCE_DIR=str(SOURCE), BUILD_DIR=str(BUILD))

# The beam of problems/beam_reference.json, clamped at its root.
LENGTH, WIDTH, YOUNG, DENSITY, MASS = 2 * math.sqrt(2), 0.05, 70e9, 2710.0, 1.0
HEIGHT = MASS / (DENSITY * WIDTH * LENGTH)
BENDING = YOUNG * WIDTH * HEIGHT**3 / 12
ROOTS = (1.875104068711961167, 4.694091132974174576, 7.854757438237612565, 10.995540734875466991)  # cos x cosh x = -1
EXACT = [b * b / (2 * math.pi) * math.sqrt(BENDING / (MASS * LENGTH**3)) for b in ROOTS]


def run(command, folder=None):
    """CPU seconds and output of a process; None where it failed."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, cwd=folder, env=ALONE, capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return cpu, done.stdout if done.returncode == 0 else None


def error(hz):
    """Largest relative error of the first four frequencies."""
    return max(abs(a / b - 1) for a, b in zip(hz, EXACT)) if hz and len(hz) >= 4 else math.nan


def model(elements, rigid):
    link = {"name": "beam", "from": "root", "to": "tip", "elements": elements}
    if rigid:
        link |= {"mass_kg": MASS, "stiffness_n_m_per_rad": [BENDING * elements / LENGTH] * (elements - 1)}
        hold = {"name": "clamp", "type": "revolute", "bodies": ["ground", "beam.start"], "at": "root"}
        spring = {"name": "root", "type": "torsion", "joint": "clamp", "stiffness_n_m_per_rad": 2 * BENDING * elements / LENGTH}
        more = {"springs": [spring]}
    else:
        link |= {"kind": "beam", "youngs_modulus_pa": YOUNG, "density_kg_per_m3": DENSITY,
                 "section": {"shape": "rectangle", "width_m": WIDTH, "height_m": HEIGHT}}
        hold = {"name": "clamp", "type": "fixed", "bodies": ["ground", "beam.start"], "at": "root"}
        more = {}
    return {"format": "modetune-model/1", "name": f"cantilever of {elements} elements", "dimension": 2,
            "points": {"root": [0, 0], "tip": [LENGTH, 0]}, "links": [link], "joints": [hold], **more}


def ours(elements, folder, rigid=False):
    path = Path(folder) / "model.json"
    path.write_text(json.dumps(model(elements, rigid)))
    cpu, text = run([PROGRAM, "modes", str(path), "--count", "4", "--format", "json"])
    return cpu, [m["frequency_hz"] for m in json.loads(text)[0]["modes"][:4]] if text else None


SCIPY = """
import sys, math
import numpy as np, scipy.sparse as sp
from scipy.sparse.linalg import eigsh
n, length, bending, axial, mass = int(sys.argv[1]), *map(float, sys.argv[2:])
h, rho = length / n, mass / length
k = bending / h**3 * np.array([[12, 6*h, -12, 6*h], [6*h, 4*h*h, -6*h, 2*h*h], [-12, -6*h, 12, -6*h], [6*h, 2*h*h, -6*h, 4*h*h]])
m = rho * h / 420 * np.array([[156, 22*h, 54, -13*h], [22*h, 4*h*h, 13*h, -3*h*h], [54, 13*h, 156, -22*h], [-13*h, -3*h*h, -22*h, 4*h*h]])
at = 2 * np.arange(n)[:, None] + np.arange(4)
rows, cols = np.repeat(at, 4, axis=1).ravel(), np.tile(at, (1, 4)).ravel()
K, M = (sp.coo_matrix((np.tile(e.ravel(), n), (rows, cols))).tocsc()[2:, 2:] for e in (k, m))
values = eigsh(K, 4, M, sigma=0, which="LM", return_eigenvectors=False)
print(*np.sort(np.sqrt(values) / (2 * math.pi)))
"""


def scipy(elements, folder):
    cpu, text = run([sys.executable, "-c", SCIPY, str(elements), *map(repr, (LENGTH, BENDING, YOUNG * WIDTH * HEIGHT, MASS))])
    return cpu, [float(x) for x in text.split()] if text else None


def calculix(elements, folder):
    with open(Path(folder) / "beam.inp", "w", encoding="ascii") as out:
        out.write("*NODE,NSET=ALL\n")
        out.writelines(f"{i + 1},{LENGTH * i / elements:.15g},0,0\n" for i in range(elements + 1))
        out.write("*ELEMENT,TYPE=B31,ELSET=BEAM\n")
        out.writelines(f"{i + 1},{i + 1},{i + 2}\n" for i in range(elements))
        out.write(f"*MATERIAL,NAME=M\n*ELASTIC\n{YOUNG},0.\n*DENSITY\n{DENSITY}\n*BEAM SECTION,ELSET=BEAM,MATERIAL=M,SECTION=RECT\n"
                  f"{WIDTH},{HEIGHT}\n0.,0.,1.\n*BOUNDARY\nALL,3\n1,1,6\n*STEP\n*FREQUENCY\n4\n*END STEP\n")
    cpu, text = run(["ccx", "beam"], folder)
    found = re.findall(r"^ +\d+ +\S+ +\S+ +(\S+) +\S+$", (Path(folder) / "beam.dat").read_text(), re.M) if text else []
    return cpu, [float(x) for x in found[:4]] or None


def measured(what, solve, elements, runs):
    """One row: medians over some runs."""
    with tempfile.TemporaryDirectory() as folder:
        done = [solve(elements, folder) for _ in range(runs)]
    times = [cpu for cpu, _ in done]
    return {"what": what, "elements": elements, "cpu_s": statistics.median(times), "spread_s": max(times) - min(times),
            "error": error(done[-1][1])}


class Bench:
    def __init__(self, out, quick):
        self.out, self.quick, self.runs = out, quick, 1 if quick else 5
        out.mkdir(parents=True, exist_ok=True)

    def write(self, name, rows):
        with open(self.out / f"{name}.csv", "w", newline="", encoding="utf-8") as file:
            table = csv.DictWriter(file, rows[0])
            table.writeheader()
            table.writerows(rows)

    def show(self, name, title, rows, x, y):
        """Rows as text and CSV, and as curves of `what` over x and y."""
        self.write(name, rows)
        print(f"{title}\n  {'':34} {'elements':>8} {'CPU s':>9} {'spread':>8} {'error':>8} {'ratio':>7}")
        for row in rows:
            same = [r for r in rows if r["elements"] == row["elements"]]
            ratio = row["cpu_s"] / same[0]["cpu_s"]
            print(f"  {row['what']:34} {row['elements']:8} {row['cpu_s']:9.3g} {row['spread_s']:8.1e} {row['error']:8.1e} {ratio:7.3g}")
        print(flush=True)
        curves = {}
        for row in rows:
            curves.setdefault(row["what"], []).append((row[x[0]], row[y[0]]))
        draw(self.out / f"{name}.svg", [(title, x[1], y[1], curves)])

    def elements(self):
        rows = [measured("rigid elements, springs EI/h", lambda n, f: ours(n, f, True), n, self.runs)
                for n in (5, 9, 18, 36, 72, 144)[:3 if self.quick else None]]
        rows += [measured("beam elements", ours, n, self.runs) for n in (2, 4, 9, 18, 36, 72)[:3 if self.quick else None]]
        self.show("elements", "cantilever, first four frequencies: elements against error", rows, ("elements", "elements"),
                  ("error", "largest relative error"))

    def peers(self):
        solvers = {"modetune": (ours, True), "SciPy": (scipy, True), "CalculiX B31": (calculix, shutil.which("ccx"))}
        rows = []
        for n in (100,) if self.quick else (100, 300, 1000, 3000, 10000, 30000, 100000):
            for name, (solve, there) in list(solvers.items()):
                if not there:
                    continue
                row = measured(name, solve, n, self.runs if n <= 3000 else 1)
                rows.append(row)
                if row["cpu_s"] > 30 or math.isnan(row["error"]):
                    solvers[name] = (solve, False)  # larger ones would take minutes, or fail, too
        if not shutil.which("ccx"):
            print("(no CalculiX here: apt-get install calculix-ccx)")
        self.show("peers", "cantilever of n beam elements, from the file to four frequencies", rows, ("cpu_s", "CPU s"),
                  ("error", "largest relative error"))

    def evaluation(self):
        subprocess.run([BUILD / "tests/bench/bench_evaluation"] + ["truss_10bar_E69_8"] * self.quick, env=ALONE, check=True)
        print(flush=True)

    def search(self):
        path = self.out / "search.csv"
        subprocess.run([BUILD / "tests/bench/bench_search", "--csv", path] + (["--quick", "inceptor_tuning_1", "truss_10bar_E69_8"] if self.quick else []), env=ALONE, check=True)
        panels = {}
        with open(path, encoding="utf-8") as file:
            for row in csv.DictReader(file):
                curve = panels.setdefault(row["study"], {}).setdefault(row["method"], {})
                curve.setdefault(float(row["distance"]), []).append(int(row["evaluations"]))
        draw(self.out / "search.svg", [
            (study, "evaluations", "distance from the best known answer",
             {m: [(statistics.median(n), d) for d, n in sorted(c.items(), reverse=True)] for m, c in methods.items()})
            for study, methods in panels.items()])

    def beam(self):
        subprocess.run([BUILD / "tests/bench/bench_beam"], env=ALONE, check=True)
        if not self.quick:
            subprocess.run(["bash", SOURCE / "tests/bench/bench_beam.sh"], env=ALONE, check=True)


def draw(path, panels):
    """Double logarithmic curves, a panel each; marks differ besides colours."""
    try:
        import matplotlib
    except ImportError:
        print(f"(no {path.name}: apt-get install python3-matplotlib)")
        return
    matplotlib.use("svg")
    from matplotlib import pyplot
    columns = min(len(panels), 2)
    lines = -(-len(panels) // columns)
    figure, axes = pyplot.subplots(lines, columns, figsize=(6.5 * columns, 4.2 * lines), squeeze=False, layout="constrained")
    for axis, (title, x, y, curves) in zip(axes.flat, panels):
        for mark, (name, points) in zip("osD^v<>Px*", curves.items()):
            axis.loglog(*zip(*points), marker=mark, label=name, markersize=4, linewidth=1)
        axis.set(title=title, xlabel=x, ylabel=y)
        axis.grid(alpha=0.3)
        axis.legend(fontsize="x-small")
    for axis in axes.flat[len(panels):]:
        axis.remove()
    figure.savefig(path, metadata={"Date": None})
    pyplot.close(figure)


def machine():
    names = re.findall(r"^model name\s*: (.*)$", Path("/proc/cpuinfo").read_text(), re.M) or [platform.processor() or "unknown"]
    _, version = run([PROGRAM, "--version"])
    print(f"{names[0]}, {os.cpu_count()} processors, {platform.system()} {platform.release()}\n{(version or '').strip()}\n")


def main():
    parser = argparse.ArgumentParser(description="run time against error")
    parser.add_argument("--quick", action="store_true", help="one short run of everything")
    parser.add_argument("--only", choices=("elements", "peers", "evaluation", "search", "beam"), action="append")
    parser.add_argument("--out", type=Path, default=BUILD / "bench")
    options = parser.parse_args()
    bench = Bench(options.out, options.quick)
    machine()
    for name in options.only or ("beam", "elements", "peers", "evaluation", "search"):
        getattr(bench, name)()
    print(f"tables and pictures: {options.out}")


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""
Run time against error: every table as text and CSV, and (where matplotlib is installed) a picture of each.
    bench.py [--quick] [--without-peers] [--only NAME] [--out FOLDER]
beam        the nine-element beam beside the paper's way in Octave and a bare dsyevd (bench_beam)
elements    a beam's first four frequencies by the number of its elements: rigid ones with the physical springs, with springs
            identified as the paper does, beam elements; errors against the closed form, of the supports that springs were
            identified with and of others
eigensolver ways to the lowest four modes of a chain of rigid elements (bench_eigen); errors against extended precision
peers       a cantilever of n beam elements from its file to its first four frequencies, beside SciPy (banded matrices, shift and
            invert) and CalculiX (B31, *FREQUENCY), each in a process of its own
frame       the ten lowest modes of a space frame, from its file, with the count that none is missing, beside a plain program with
            CHOLMOD and Lanczos' method that makes the frame itself and does not count (bench_frame)
evaluation  designs per second and core: one evaluation of studies beside a bare dsyevd (bench_evaluation)
search      distance from the best known answer by evaluations and CPU time (bench_search)
studies     whole studies, from their files to their answers
designs     studies of tests/bench/studies and shipped ones: CPU time to the first design that meets all goals, to the best, to what is
            proven of them, to the answer
response    a thousand frequencies of forced vibration: by modes, directly, and by NumPy (bench_response)
motion      a chain of masses from rest under a sine, in time: modetune simulate beside lsim of SciPy and of Octave's control
            package, each in a process of its own; errors against the exponential of its matrix
growth      the same question of larger models: CPU time and memory by size, and the exponent from the size before
threads     shipped studies on one thread and on two: wall time, the least of the runs, with what else the machine does
asked       what was to be reached beside what the other tables measured
Times are CPU seconds of one thread, what is compared runs in turn, and each gets the median of its runs with the spread
(largest less smallest) beside it. What is not installed is left out and named. SOURCE_DIR, BUILD_DIR and MODETUNE as in the tests.
"""
import argparse
import importlib.util
import json
import math
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from functools import partial
from pathlib import Path

import _cases as cases
import _growth as growth
import _pictures as pictures
from _tables import ALONE, BUILD, COLUMNS, PROGRAM, SOURCE, machine, middle, rows_of, run, show, side_by_side, write

PROGRAMS = BUILD / "tests/bench"
NEEDED = {"octave": "octave octave-control", "ccx": "calculix-ccx", "matplotlib": "python3-matplotlib"}


def there(name):
    return (importlib.util.find_spec(name) if name == "matplotlib" else shutil.which(name)) is not None


class Bench:
    def __init__(self, out, quick):
        self.out, self.quick, self.rows, self.drawn = out, quick, {}, []
        self.flags = ["--quick"] * quick
        self.missing = {name for name in NEEDED if not there(name)}
        out.mkdir(parents=True, exist_ok=True)
        self.head = list(machine())
        print("\n".join(self.head) + "\n")
        for name in sorted(self.missing):
            print(f"(no {name} here: sudo apt-get install --no-install-recommends {NEEDED[name]})\n")

    def tell(self, name, title, rows):
        """Rows as text and CSV; kept for the table of what was asked."""
        self.rows[name] = rows
        show(title, COLUMNS[name], rows)
        write(self.out / f"{name}.csv", title, self.head, COLUMNS[name], rows)

    def draw(self, name, *arguments):
        """At the end, as matplotlib is large: see rigid_exact."""
        self.drawn.append(partial(getattr(pictures, name), self.out / f"{name}.svg", self.head, *arguments))

    def finish(self):
        for draw in self.drawn if "matplotlib" not in self.missing else ():
            draw()

    def beam(self):
        rows = rows_of([PROGRAMS / "bench_beam", *self.flags])
        if "octave" not in self.missing and not self.quick:
            with tempfile.NamedTemporaryFile("w", suffix=".txt") as file:
                # Octave's own exit may complain, and says nothing about the numbers: bench_beam checks those
                subprocess.run(["octave", "--no-gui", "--norc", "--quiet", SOURCE / "tests/bench/bench_beam.m"], env=ALONE,
                               stdout=file, stderr=subprocess.DEVNULL)
                rows += rows_of([PROGRAMS / "bench_beam", file.name])
        bare = next(r["cpu_s"] for r in rows if r["way"] == "LAPACK")
        for row in rows:
            own = next((r["cpu_s"] for r in rows if r["what"] == row["what"] and r["way"] == "modetune"), bare)
            row["ratio"] = row["cpu_s"] / (own if row["way"] == "Octave" else bare)
        self.tell("beam", "nine-element beam; ratio: of ours to a bare dsyevd, of Octave (the paper's way) to ours; errors against "
                  "long double", rows)

    def elements(self):
        rows = []
        sizes = {"rigid elements, springs EI/h": (3, 5, 9, 20, 40, 80), "rigid elements, springs identified": (3, 4, 5, 7, 9, 12, 16, 20),
                 "beam elements": (3, 5, 9, 20, 40, 80)}
        for way, counts in sizes.items():
            for n in counts[:3] if self.quick else counts:
                rows.append(self.element_row(way, n))
        self.tell("elements", "beam without supports, first four frequencies by the number of elements: one evaluation; error_pinned: "
                  "the same springs, both ends pinned", rows)
        self.draw("elements", rows)

    def element_row(self, way, n):
        row = {"way": way, "elements": n, "modes": min(4, n - 1)}
        with tempfile.TemporaryDirectory() as folder:
            springs = None
            if way.endswith("identified"):
                row["identify_cpu_s"], springs = cases.identified(n, folder)
            model = cases.put(Path(folder) / "model.json", cases.beam(n, springs=springs, rigid=way.startswith("rigid")))
            for found in rows_of([PROGRAMS / "bench_eigen", *self.flags, model, "evaluation"]):
                where = found["configuration"]
                hz = [found[f"hz_{i + 1}"] for i in range(row["modes"])]
                if where == "free":
                    row |= {"cpu_s": found["cpu_s"], "spread_s": found["spread_s"], "error": cases.error(hz, cases.EXACT[where])}
                else:
                    row["error_pinned"] = cases.error(hz, cases.EXACT[where])
        return row

    def eigensolver(self):
        rows = []
        dense = {"plain": (10, 30) if self.quick else (10, 30, 100, 300, 1000), "accurate": (10, 30) if self.quick else (10, 30, 100, 300),
                 "few": (10, 30) if self.quick else (10, 30, 100, 300)}
        for n in (10, 30, 100) if self.quick else (10, 30, 100, 300, 1000, 3000, 10000, 30000, 100000):
            ways = [w for w, sizes in dense.items() if n in sizes] + ["lowest"] * (n >= 100)
            exact = cases.rigid_exact(n)
            with tempfile.TemporaryDirectory() as folder:
                model = cases.put(Path(folder) / "model.json", cases.cantilever(n, rigid=True))
                found = rows_of([PROGRAMS / "bench_eigen", *self.flags, model, *ways])
            for row in found:
                rows.append({"way": {"plain": "dense, dsyevd", "accurate": "dense, sum of squares",
                                     "few": "the same, four modes alone", "lowest": "lowest, by structure"}[row["way"]],
                             "elements": n, "freedoms": n, "cpu_s": row["cpu_s"], "spread_s": row["spread_s"],
                             "ratio": row["cpu_s"] / found[0]["cpu_s"] if found[0]["way"] == "plain" else math.nan,
                             "error": cases.error([row[f"hz_{i}"] for i in (1, 2, 3, 4)], exact)})
        self.tell("eigensolver", "cantilever of n rigid elements, four lowest frequencies; ratio: to dsyevd; errors against extended "
                  "precision", rows)
        self.draw("eigensolver", rows)

    def peers(self):
        solvers = {"modetune": cases.ours, "SciPy": cases.scipy, "CalculiX B31": cases.calculix}
        if "ccx" in self.missing:
            del solvers["CalculiX B31"]
        rows = []
        for n in (100,) if self.quick else (100, 300, 1000, 3000, 10000, 30000, 100000):
            runs = 1 if self.quick or n >= 100000 else 5 if n <= 3000 else 3
            with tempfile.TemporaryDirectory() as folder:
                done = side_by_side({name: partial(solve, n, folder) for name, solve in solvers.items()}, runs)
            for name, (times, hz) in done.items():
                rows.append({"way": name, "elements": n, "runs": runs, "ratio": times["cpu_s"] / done["modetune"][0]["cpu_s"],
                             "error": cases.error(hz, cases.EXACT["cantilever"]), **times})
        self.tell("peers", "cantilever of n beam elements, from its file to four frequencies; ratio: to modetune; errors against the "
                  "closed form", rows)
        self.draw("peers", rows)

    def frame(self):
        rows = []
        for floors in (4,) if self.quick else (10, 30, 108):
            with tempfile.TemporaryDirectory() as folder:
                task = cases.Frame(floors, folder)
                done = side_by_side({"modetune": task.ours, "CHOLMOD and Lanczos": partial(task.peer, PROGRAMS / "bench_frame")},
                                    1 if self.quick else 5)
            exact = done["CHOLMOD and Lanczos"][1]
            rows += [{"way": way, "elements": task.elements, "freedoms": task.freedoms, **took, "error": cases.error(hz, exact),
                      "ratio": took["cpu_s"] / done["CHOLMOD and Lanczos"][0]["cpu_s"]} for way, (took, hz) in done.items()]
        self.tell("frame", "space frame, ten lowest modes; ratio: to the plain program; error: to its frequencies, which hold no bound", rows)

    def evaluation(self):
        shipped = ["truss_10bar_E69_8"] if self.quick else [
            "beam_identification", "truss_10bar_E68_9", "truss_10bar_E69_8", "truss_72bar", "six_masses_bands",
            "inceptor_identification", "inceptor_tuning_1", "inceptor_stick", "engine_orders"]
        with tempfile.TemporaryDirectory() as folder:
            chains = [cases.affine(n, folder) for n in ((4,) if self.quick else (1, 2, 3, 4))]
            rows = rows_of([PROGRAMS / "bench_evaluation", *self.flags, *chains, *shipped])
        self.tell("evaluation", "designs per second and core: one evaluation of a study; ratio: to a bare dsyevd with vectors of each "
                  "configuration's order; errors against long double", rows)
        self.draw("evaluation", rows)

    def search(self):
        some = ["inceptor_tuning_1", "truss_10bar_E69_8"] if self.quick else []
        runs = rows_of([PROGRAMS / "bench_search", *self.flags, *some])
        levels, rows = {}, []
        for row in runs:
            levels.setdefault((row["study"], row["method"], row["distance"]), []).append(row)
        for (study, method, distance), of in levels.items():
            reached = [r for r in of if r["cpu_s"] == r["cpu_s"]]
            row = {"study": study, "method": method, "distance": distance, "runs": len(of), "reached": len(reached)}
            if reached:
                row |= {"evaluations": int(statistics.median(r["evaluations"] for r in reached)), **middle([r["cpu_s"] for r in reached])}
            rows.append(row)
        self.rows["search"] = rows
        title = "search: evaluations and CPU time to within a distance of the best known answer, of the runs that came so near"
        short = {}
        for r in rows:
            if r["distance"] in (1e-2, 1e-4, 1e-8):
                short.setdefault((r["study"], r["method"]), {"study": r["study"], "method": r["method"]}).update({
                    f"{r['distance']:g} runs": f"{r['reached']}/{r['runs']}", f"{r['distance']:g} evals": r.get("evaluations", ""),
                    f"{r['distance']:g} cpu_s": r.get("cpu_s", "")})
        show(title, tuple(next(iter(short.values()))), list(short.values()))
        write(self.out / "search.csv", title, self.head, COLUMNS["search"], rows)
        self.draw("search", rows)

    def studies(self):
        names = ("truss_10bar_E69_8",) if self.quick else (
            "truss_10bar_E68_9", "truss_10bar_E69_8", "truss_72bar", "six_masses_bands", "inceptor_identification", "beam_identification")
        with tempfile.TemporaryDirectory() as folder:
            done = side_by_side({name: partial(self.study, name, folder) for name in names}, 1 if self.quick else 5)
        self.tell("studies", "whole studies, from their files to their answers (search, proof, verification, report); error: what the "
                  "best design leaves of its goals, or is above the best known value", [
                      {"study": name, "runs": 1 if self.quick else 5, **times, **answer} for name, (times, answer) in done.items()])

    def study(self, name, folder):
        cpu, _, peak = run([PROGRAM, "run", SOURCE / "studies" / f"{name}.json", "--quiet", "--threads", "1", "-o", folder])
        return cpu, cases.answer(json.loads((Path(folder) / name / "result.json").read_text(encoding="utf-8"))), peak

    def designs(self):
        shipped = ("engine_orders", "inceptor_catalogue", "truss_10bar_E69_8", "six_masses_bands") if self.quick else (
            "truss_10bar_E68_9", "truss_10bar_E69_8", "truss_72bar", "beam_identification", "inceptor_identification", "inceptor_prediction",
            "inceptor_tuning_1", "inceptor_tuning_2", "inceptor_tuning_3", "inceptor_stick", "inceptor_stick_mac", "inceptor_catalogue",
            "inceptor_rotor", "inceptor_trade", "engine_orders", "six_masses_bands", "six_masses_infeasible")
        paths = {name: SOURCE / "studies" / f"{name}.json" for name in shipped}
        if not self.quick:
            paths |= {path.stem: path for path in sorted((SOURCE / "tests/bench/studies").glob("*.json"))}
        runs = 1 if self.quick else 5
        with tempfile.TemporaryDirectory() as folder:
            done = side_by_side({name: partial(cases.watched, path, folder) for name, path in paths.items()}, runs,
                                ("first_cpu_s", "best_cpu_s", "proof_cpu_s"))
        self.tell("designs", "studies on one thread, from the file: to the first design that meets all goals, to the best one (but for its "
                  "last digits), to the last proof that settled its question, to the answer with its report; error as in `studies`",
                  [{k: v for k, v in {"study": name, "runs": runs, **times, **answer}.items() if v is not None and v == v}
                   for name, (times, answer) in done.items()])

    def response(self):
        rows = rows_of([PROGRAMS / "bench_response", *self.flags])
        for n, coupled in ((10, 0), (10, 1), (40, 0), (40, 1)):
            solved = side_by_side({"NumPy": partial(cases.chain_response, n, coupled)}, 1 if self.quick else 5)["NumPy"]
            with tempfile.NamedTemporaryFile("w", suffix=".txt") as file:
                w, h = solved[1]
                for x, row in zip(w, h):
                    file.write(" ".join([repr(float(x))] + [f"{z.real!r} {z.imag!r}" for z in map(complex, row)]) + "\n")
                file.flush()
                error = rows_of([PROGRAMS / "bench_response", n, coupled, file.name])[0]["error"]
            rows.append({"problem": "coupled chain" if coupled else "chain", "freedoms": n, "outputs": n, "way": "NumPy", "frequencies": len(w),
                         "cpu_s": solved[0]["cpu_s"], "spread_s": solved[0]["spread_s"], "error": error})
        self.tell("response", "a thousand frequencies; errors in parts of the largest value", rows)

    def motion(self):
        with tempfile.TemporaryDirectory() as folder:
            for masses, samples in ((3, 2000), (12, 2000)):
                task = cases.Motion(masses, samples, folder)
                ways = {"modetune": task.ours, "SciPy lsim": task.scipy, "Octave lsim": task.octave}
                if "octave" in self.missing or not task.has_control():
                    del ways["Octave lsim"]
                solved = side_by_side(ways, 1 if self.quick else 5)
                own = solved["modetune"][0]["cpu_s"]
                self.rows.setdefault("motion", []).extend(
                    {"way": way, "masses": masses, "samples": samples, "cpu_s": took["cpu_s"], "spread_s": took["spread_s"],
                     "ratio": took["cpu_s"] / own, "error": task.error(x)} for way, (took, x) in solved.items())
        self.tell("motion", "a chain under a sine in time, from file to last sample; ratio: to ours; errors in parts of the largest "
                  "displacement", self.rows["motion"])

    def growth(self):
        rows = []
        for family in growth.FAMILIES:
            what, of, sizes, _ = family
            before = None
            for size in sizes[:2] if self.quick else sizes:
                runs = 1 if self.quick or (before is not None and before["cpu_s"] > 0.5) else 3
                with tempfile.TemporaryDirectory() as folder:
                    times, answered = side_by_side({"modetune": partial(growth.measure, family, size, folder)}, runs)["modetune"]
                if not answered:
                    sys.exit(f"{what}: no answer for {size} {of}")
                row = {"what": what, "of": of, "size": size, "runs": runs, **times}
                if before is not None:
                    row["exponent"] = math.log(row["cpu_s"] / before["cpu_s"]) / math.log(size / before["size"])
                rows.append(row)
                before = row
        self.tell("growth", "CPU time by size, from file to answer; exponent: between this size and the one before", rows)

    def threads(self):
        rows = []
        for name in ("inceptor_catalogue",) if self.quick else ("inceptor_rotor", "inceptor_identification", "inceptor_trade", "truss_72bar"):
            runs = 1 if self.quick else 5
            with tempfile.TemporaryDirectory() as folder:
                walls = [[growth.waited(name, count, folder) for count in (1, 2)] for _ in range(runs)]
            one, two = (min(w[k] for w in walls) for k in (0, 1))
            rows.append({"study": name, "runs": runs, "wall_1_s": one, "wall_2_s": two, "times": one / two})
        self.tell("threads", "wall time of studies with their reports, on one thread and on two", rows)

    def asked(self):
        def of(table, column, **want):
            return next((r for r in self.rows.get(table, ()) if all(r[k] == v for k, v in want.items())), {}).get(column, math.nan)

        rate = of("evaluation", "per_second", study="chain_4", way="values")
        bare = of("beam", "cpu_s", way="LAPACK")
        rows = [("nine-element beam, four frequencies with eight slopes, over a bare dsyevd", "<=", 1.5,
                 of("beam", "cpu_s", what="four frequencies, slopes for 8 springs", way="modetune") / bare, "",
                 of("beam", "error", what="four frequencies, slopes for 8 springs", way="modetune"))]
        rows += [(what, "<=", most, of("studies", "cpu_s", study=study), "s", of("studies", "error", study=study)) for what, study, most in (
            ("10-bar truss answered", "truss_10bar_E69_8", 0.05), ("72-bar truss answered", "truss_72bar", 0.5),
            ("six masses ranked and proven", "six_masses_bands", 0.03), ("inceptor identified", "inceptor_identification", 1.0))]
        rows += [("designs per second and core, affine, 4 masses", ">=", 3e5, rate, "1/s", of("evaluation", "error", study="chain_4", way="values")),
                 ("inceptor's response, 1000 frequencies, all sensors", "<=", 2e-3, of("response", "cpu_s", problem="inceptor", way="modes"), "s",
                  of("response", "error", problem="inceptor", way="modes")),
                 ("100,000 beam elements, CalculiX's time over ours", ">=", 5, of("peers", "ratio", way="CalculiX B31", elements=100000), "",
                  of("peers", "error", way="modetune", elements=100000))]
        self.tell("asked", "asked, and measured in this run", [
            {"what": what, "asked": f"{sign} {limit:g}", "measured": got, "unit": unit, "error": error,
             "reached": "not measured" if got != got else "yes" if (got <= limit if sign == "<=" else got >= limit) else "no"}
            for what, sign, limit, got, unit, error in rows])


def main():
    parser = argparse.ArgumentParser(description="run time against error")
    parser.add_argument("--quick", action="store_true", help="one short run of everything")
    parser.add_argument("--only", choices=tuple(COLUMNS), action="append")
    parser.add_argument("--out", type=Path, default=BUILD / "bench")
    parser.add_argument("--without-peers", action="store_true", help="leave out what Octave, CalculiX and matplotlib are needed for, where they are missing")
    options = parser.parse_args()
    missing = [NEEDED[name] for name in sorted(NEEDED) if not there(name)]
    if missing and not options.without_peers:
        parser.error(f"sudo apt-get install --no-install-recommends {' '.join(missing)}, or --without-peers")
    bench = Bench(options.out, options.quick)
    start = time.monotonic()
    for name in COLUMNS if options.only is None else (c for c in COLUMNS if c in options.only):
        getattr(bench, name)()
    bench.finish()
    print(f"tables and pictures: {options.out} ({time.monotonic() - start:.0f} s)")


if __name__ == "__main__":
    main()

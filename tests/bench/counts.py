#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""
What whole runs cost, in instructions: a count that repeats where times do not. Each run is counted by valgrind with one thread and the
plainest kernels, as a multiple of a small program that is counted beside it (`modetune --version`, which is the start of a process).
    counts.py            fails where one is above what counts.csv says by a tenth; says so where one is below by as much
    counts.py --update   writes what it finds. What has grown by a tenth over `least`, the least that it took since its growth was
                         last explained, needs an item in the newest section of CHANGELOG.md that has the name of the run in
                         backquotes and the word "instructions", or this fails
SOURCE_DIR and MODETUNE as in the tests.
"""
import argparse
import csv
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

SOURCE = Path(os.environ["SOURCE_DIR"])
PROGRAM = os.environ["MODETUNE"]
sys.path.insert(0, str(SOURCE / "tests/support"))
import large  # noqa: E402
import pedal  # noqa: E402

TABLE = SOURCE / "tests/bench/counts.csv"
MOST = 1e9  # of one run: what is longer belongs to bench.py
GROWTH = 1.1
WEIGHT = {"gravity_m_per_s2": [0, 0, -9.81]}
PLAIN = {"OPENBLAS_NUM_THREADS": "1", "OPENBLAS_CORETYPE": "Prescott", "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F,-AVX512VL,-ERMS,-FSRM",
         "LC_ALL": "C"}
STUDY = ("run", "--threads", "1", "--quiet", "--report", "none", "--output", "{out}")
# name: command. {sag} is a link of 300 elements that its weight bends, {frame} one in space of 540 beams, {link} one of 2,000 with a sensor,
# {mounts} the study of the pump on its mounts under its weight, {stick} a stick of beam elements in space under its own, {pedal} a study of bands in three
# driven positions, {seen} a frame of 144 beams with a sensor, {grid} a trade study of 16 points, {out} a folder for results.
RUNS = {
    "start": ("--version",),
    "check": ("check", "studies/inceptor_rotor.json"),
    "info": ("info", "problems/stick.json"),
    "modes": ("modes", "problems/inceptor.json"),
    "modes_driven": ("modes", "problems/stick.json"),
    "modes_settled": ("modes", "{sag}", "--count", "4"),
    "modes_frame": ("modes", "{frame}", "--count", "6"),
    "sensitivity": ("sensitivity", "problems/inceptor.json"),
    "response": ("response", "problems/den_hartog.json", "--input", "machine.x", "--from", "1", "--to", "20", "--points", "200"),
    "response_large": ("response", "{link}", "--input", "base.y", "--from", "0.1", "--to", "50", "--points", "300"),
    "response_frame": ("response", "{seen}", "--input", "base.x", "--from", "1", "--to", "8", "--points", "200"),
    "motion_linear": ("simulate", "problems/six_masses.json", "--start", "guide_1=0.001", "--duration", "1", "--dt-out", "0.001"),
    "mounts_gravity": (*STUDY, "--max-evaluations", "100", "{mounts}"),
    "stick_gravity": ("sensitivity", "{stick}"),
    "placements_driven": (*STUDY, "{pedal}"),
    "placements_tolerances": (*STUDY, "--max-modal-solutions", "1000", "{tolerances}"),
    "inceptor_catalogue": (*STUDY, "studies/inceptor_catalogue.json"),
    "inceptor_catalogue_page": (*STUDY[:4], "--output", "{out}", "studies/inceptor_catalogue.json"),
    "inceptor_tuning_1": (*STUDY, "studies/inceptor_tuning_1.json"),
    "six_masses_bands": (*STUDY, "studies/six_masses_bands.json"),
    "trade_grid": (*STUDY, "{grid}"),
}


def count(name, folder):
    files = ("sag", "frame", "seen", "link", "mounts", "stick", "pedal", "tolerances", "grid")
    places = {"out": str(folder / name), **{file: str(folder / f"{file}.json") for file in files}}
    command = [PROGRAM, *(word.format(**places) for word in RUNS[name])]
    done = subprocess.run(["valgrind", "--tool=callgrind", f"--callgrind-out-file={folder}/{name}.counts", *command], cwd=SOURCE,
                          env={**os.environ, **PLAIN}, capture_output=True, encoding="utf-8", timeout=600)
    found = re.search(r"Collected : (\d+)", done.stderr)
    if done.returncode not in (0, 1) or found is None:
        raise SystemExit(f"{name}: {' '.join(command)} ended with {done.returncode}:\n{done.stderr[-2000:]}")
    return int(found[1])


def measure():
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        (folder / "sag.json").write_text(json.dumps({**large.link(300), "gravity_m_per_s2": [0, -9.81]}), encoding="utf-8")
        (folder / "frame.json").write_text(json.dumps(large.frame(6, 6, 6, 1)), encoding="utf-8")
        top = {"sensors": [{"name": "top", "on": "L143", "fraction": 1, "directions": ["x"]}], "damping": {"mass_per_s": 1}}
        (folder / "seen.json").write_text(json.dumps({**large.frame(4, 4, 4, 1), **top}), encoding="utf-8")
        tip = {"sensors": [{"name": "tip", "on": "beam", "fraction": 1, "directions": ["y"]}]}
        (folder / "link.json").write_text(json.dumps({**large.link(2000), **tip}), encoding="utf-8")
        pump = json.loads((SOURCE / "problems/pump_on_mounts.json").read_text(encoding="utf-8"))
        (folder / "pump.json").write_text(json.dumps({**pump, **WEIGHT}), encoding="utf-8")
        mounts = json.loads((SOURCE / "studies/pump_on_mounts.json").read_text(encoding="utf-8"))
        (folder / "mounts.json").write_text(json.dumps({**mounts, "model": "pump.json"}), encoding="utf-8")
        subprocess.run([PROGRAM, "init", str(folder / "new"), "--kind", "stick"], capture_output=True, check=True)
        stick = json.loads((folder / "new/model.json").read_text(encoding="utf-8"))
        (folder / "stick.json").write_text(json.dumps({**stick, **WEIGHT}), encoding="utf-8")
        (folder / "model.json").write_text(json.dumps(pedal.PEDAL), encoding="utf-8")
        for file, variables in (("pedal", pedal.FREE), ("tolerances", [{**pedal.FREE[0], "tolerance_percent": 2}, pedal.FREE[1]])):
            question = {**pedal.study(variables), "model": "model.json", "search": {"starts": 1}}
            (folder / f"{file}.json").write_text(json.dumps(question), encoding="utf-8")
        grid = json.loads((SOURCE / "studies/inceptor_trade.json").read_text(encoding="utf-8"))
        for vary, values in zip(grid["trade"]["vary"], ([0.6, 1.4, 2.2, 3], [2, 10, 18, 26])):
            vary["values"] = values
        for name in ("inceptor.json", "aircraft.json"):
            shutil.copy(SOURCE / "problems" / name, folder)
        grid.update(model="inceptor.json", published=[])
        (folder / "grid.json").write_text(json.dumps(grid), encoding="utf-8")
        with ThreadPoolExecutor(os.cpu_count()) as workers:
            return dict(zip(RUNS, workers.map(lambda name: count(name, folder), RUNS)))


def explained(name):
    """Does the newest section of CHANGELOG say why this run takes more?"""
    newest = (SOURCE / "CHANGELOG.md").read_text(encoding="utf-8").split("\n## ")[1]
    return any(f"`{name}`" in item and "instructions" in item for item in re.split(r"\n(?=- )", newest))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--update", action="store_true")
    args = parser.parse_args()
    kept = {row["run"]: row for row in csv.DictReader(TABLE.open(encoding="utf-8"))} if TABLE.exists() else {}
    found = measure()
    wrong, rows = [], []
    print(f"{'run':30}{'instructions':>16}{'starts':>10}{'kept':>10}{'least':>10}")
    for name, n in found.items():
        ratio = n / found["start"]
        old = kept.get(name, {})
        least = float(old.get("least", ratio))
        before = float(old.get("starts", "nan"))
        print(f"{name:30}{n:16d}{ratio:10.2f}{before:10.2f}{least:10.2f}")
        grown = not ratio <= GROWTH * least
        rows.append({"run": name, "starts": f"{ratio:.3g}", "least": f"{ratio if grown else min(ratio, least):.3g}"})
        if n > MOST:
            wrong.append(f"{name}: {n} instructions are more than a count is for ({MOST:.0e})")
        if not args.update and not ratio <= GROWTH * before:
            wrong.append(f"{name}: {ratio:.3g} starts instead of {before:.3g}: find out why, or counts.py --update")
        elif ratio < before / GROWTH:
            print(f"{name}: less by more than a tenth (counts.py --update keeps it)")
        if grown and not explained(name):
            wrong.append(f"{name}: {ratio:.3g} starts, {least:.3g} at the least, and CHANGELOG does not say why `{name}` takes more instructions")
    if set(kept) - set(found):
        wrong.append(f"counts.csv has runs that there are not: {sorted(set(kept) - set(found))}")
    if args.update and not wrong:
        with TABLE.open("w", encoding="utf-8", newline="") as out:
            writer = csv.DictWriter(out, ["run", "starts", "least"], lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
    print("\n".join(wrong))
    print(f"{len(found)} runs, {len(wrong)} of them have grown")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())

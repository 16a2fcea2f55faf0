# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of measurements: what their columns are, how they are measured, printed and written."""
import csv
import json
import os
import platform
import re
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SOURCE = Path(os.environ.get("SOURCE_DIR", Path(__file__).resolve().parents[2]))
BUILD = Path(os.environ.get("BUILD_DIR", SOURCE / "build/release"))
PROGRAM = os.environ.get("MODETUNE", str(BUILD / "modetune"))
ALONE = dict(os.environ, OPENBLAS_NUM_THREADS="1", OMP_NUM_THREADS="1", LC_ALL="C", SOURCE_DIR=str(SOURCE), BUILD_DIR=str(BUILD))

# Every table and its columns, in order. cpu_s is a median, spread_s the largest less the smallest; ratio is the time over that
# of the table's named peer, in the same run; error is relative, to what the table's title says.
COLUMNS = {
    "beam": ("what", "way", "cpu_s", "spread_s", "ratio", "error", "evaluations"),
    "elements": ("way", "elements", "modes", "identify_cpu_s", "cpu_s", "spread_s", "error", "error_pinned"),
    "eigensolver": ("way", "elements", "freedoms", "cpu_s", "spread_s", "ratio", "error"),
    "peers": ("way", "elements", "runs", "cpu_s", "spread_s", "peak_mib", "ratio", "error"),
    "frame": ("way", "elements", "freedoms", "cpu_s", "spread_s", "peak_mib", "ratio", "error"),
    "evaluation": ("study", "variables", "configurations", "freedoms", "way", "cpu_s", "spread_s", "per_second", "ratio", "error"),
    "search": ("study", "method", "distance", "runs", "reached", "evaluations", "cpu_s", "spread_s"),
    "studies": ("study", "runs", "cpu_s", "spread_s", "peak_mib", "evaluations", "error", "status"),
    "designs": ("study", "variables", "runs", "first_cpu_s", "best_cpu_s", "proof_cpu_s", "cpu_s", "spread_s", "peak_mib", "first_evaluations",
                "best_evaluations", "evaluations", "multiplications", "status", "proven", "error"),
    "response": ("problem", "freedoms", "outputs", "way", "frequencies", "cpu_s", "spread_s", "error"),
    "motion": ("way", "masses", "samples", "cpu_s", "spread_s", "ratio", "error"),
    "growth": ("what", "of", "size", "runs", "cpu_s", "spread_s", "peak_mib", "exponent"),
    "threads": ("study", "runs", "wall_1_s", "wall_2_s", "times"),
    "asked": ("what", "asked", "measured", "unit", "reached", "error"),
}


def run(command, folder=None, fine=(0,), errors=subprocess.DEVNULL):
    """CPU seconds and output of a process; output None where its exit status is not fine; its greatest memory [MiB]."""
    with subprocess.Popen(list(map(str, command)), cwd=folder, env=ALONE, stdout=subprocess.PIPE, stderr=errors) as process:
        text = process.stdout.read().decode()
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    return used.ru_utime + used.ru_stime, text if process.returncode in fine else None, used.ru_maxrss / 1024


def rows_of(command):
    """What a program of this folder prints as CSV, numbers as numbers."""
    cpu, text, _ = run(command)
    if text is None:
        sys.exit(f"{' '.join(map(str, command))} failed after {cpu:.1f} s")
    return [{k: number(v) for k, v in row.items()} for row in csv.DictReader(text.splitlines())]


def number(text):
    try:
        return int(text) if re.fullmatch(r"[+-]?\d+", text) else float(text)
    except ValueError:
        return text


def middle(times):
    return {"cpu_s": statistics.median(times), "spread_s": max(times) - min(times)}


def side_by_side(solvers, runs, also=()):
    """All in turn, so many times: name -> medians, peak memory and the last answer. A solver gives CPU seconds, answer, MiB; what of
    its answer is a time, too (also), gets its median."""
    done = {name: [] for name in solvers}
    for _ in range(runs):
        for name, solve in solvers.items():
            done[name].append(solve())
    return {name: (middle([d[0] for d in all_of]) | {"peak_mib": max(d[2] for d in all_of)},
                   all_of[-1][1] if not also else all_of[-1][1] | {of: statistics.median(d[1][of] for d in all_of) for of in also})
            for name, all_of in done.items()}


def machine():
    """Where and when, in lines."""
    names = re.findall(r"^model name\s*: (.*)$", Path("/proc/cpuinfo").read_text(), re.M) or [platform.processor() or "unknown"]
    _, version, _ = run([PROGRAM, "--version"])
    with tempfile.TemporaryDirectory() as folder:  # a result says which BLAS it was made with
        run([PROGRAM, "run", SOURCE / "studies/engine_orders.json", "--quiet", "-o", folder])
        blas = json.loads((Path(folder) / "engine_orders/result.json").read_text(encoding="utf-8"))["run"]["blas"]
    yield f"{names[0]}, {os.cpu_count()} processors, {platform.system()} {platform.release()} {platform.machine()}"
    yield " ".join((version or "").split())
    yield f"{blas}, one thread"
    yield f"python {platform.python_version()}; {time.strftime('%Y-%m-%d')}"
    yield f"load average {os.getloadavg()[0]:.2f}"


def write(path, title, head, columns, rows):
    """CSV below lines of "# "."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        file.writelines(f"# {line}\n" for line in (title, *head))
        table = csv.DictWriter(file, columns, restval="")
        table.writeheader()
        table.writerows({k: f"{v:.4g}" if isinstance(v, float) else v for k, v in row.items()} for row in rows)


def cell(value):
    if isinstance(value, float):
        return "" if value != value else f"{value:.3g}"
    return str(value)


def show(title, columns, rows):
    """The same for a reader."""
    lines = [list(columns)] + [[cell(row.get(c, "")) for c in columns] for row in rows]
    width = [max(map(len, column)) for column in zip(*lines)]
    text = [isinstance(rows[0].get(c), str) for c in columns]
    print(title)
    for line in lines:
        print("  " + "  ".join(x.ljust(w) if t else x.rjust(w) for x, w, t in zip(line, width, text)).rstrip())
    print(flush=True)

#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shipped studies of every kind of search say the same bytes for any number of workers, and list the designs that are known."""
import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

MODETUNE = os.environ["MODETUNE"]
SOURCE = Path(os.environ["SOURCE_DIR"])
STUDIES = ("six_masses_bands", "truss_10bar_E69_8", "inceptor_catalogue", *(("inceptor_rotor",) if "MT_EVERY" in os.environ else ()))
WORKERS = ("1", "2", "8") if "MT_EVERY" in os.environ else ("1", "8")
failures = []


def check(condition, text):
    if not condition:
        failures.append(text)
        print("FAILED:", text)


def run(study, folder, *options):
    done = subprocess.run([MODETUNE, "run", "--quiet", "-o", folder, *options, str(study)],
                          capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


def same_bytes(folder):
    for name in STUDIES:
        answers = set()
        for workers in WORKERS:
            out = os.path.join(folder, workers)
            code, output = run(SOURCE / "studies" / f"{name}.json", out, "--threads", workers)
            check(code in (0, 1), f"{name} with {workers} workers: exit {code}\n{output[-500:]}")
            answers.add((Path(out) / name / "result.json").read_bytes())
        check(len(answers) == 1, f"{name}: the same bytes with {', '.join(WORKERS)} workers")


def result_of(folder, name):
    return json.loads((Path(folder) / name / "result.json").read_text())


def six_masses(folder):
    """The seven kinds of design of the row of six masses, all others proven infeasible; with springs within 5 % a proof that there is none."""
    result = result_of(Path(folder, "1"), "six_masses_bands")
    changes = [r["change"] for r in result["recommendations"]]
    wanted = [0.4142, 0.6874, 0.7445, 0.8327, 1.0478, 1.2400, 1.4724]
    check(len(changes) == len(wanted) and all(abs(a - b) <= 1e-4 for a, b in zip(changes, wanted)), f"seven designs: {changes}")
    check(all(c["proven"] for c in result["certificates"] if c["kind"] != "optimality"), "all other assignments are proven infeasible")
    run(SOURCE / "studies" / "six_masses_infeasible.json", folder)
    none = result_of(folder, "six_masses_infeasible")
    check(none["status"] == "infeasible" and any(c["proven"] for c in none["certificates"]), "within 5 %: proven infeasible")


def alternatives(folder):
    """The second local optimum of the ten-bar truss is listed."""
    result = result_of(Path(folder, "1"), "truss_10bar_E69_8")
    scores = [r["score"] for r in result["recommendations"]]
    check(any(abs(s - 530.57) <= 0.01 for s in scores), f"the second optimum of 530.57 kg: {scores}")


def in_order(folder):
    """Several objectives with bands: the second improves while the first is held."""
    study = json.loads((SOURCE / "studies" / "six_masses_bands.json").read_text())
    study["published"] = []
    shutil.copytree(SOURCE / "problems", Path(folder) / "tree" / "problems")
    (Path(folder) / "tree" / "studies").mkdir()
    best = {}
    for name, objective in (("one", {"maximise": "clearance"}), ("two", [{"maximise": "clearance"}, {"minimise": "change"}])):
        study["objective"] = objective
        path = Path(folder) / "tree" / "studies" / f"{name}.json"
        path.write_text(json.dumps(study))
        code, output = run(path, folder)
        check(code == 0, f"{name}: exit {code}\n{output[-500:]}")
        best[name] = result_of(folder, name)["recommendations"][0]
    check(abs(best["two"]["score"] - best["one"]["score"]) <= 1e-3, "the clearance is held")
    check(best["two"]["change"] <= best["one"]["change"] + 1e-6, "the change is not greater")


with tempfile.TemporaryDirectory() as folder:
    same_bytes(folder)
    six_masses(folder)
    alternatives(folder)
    in_order(folder)
sys.exit(1 if failures else 0)

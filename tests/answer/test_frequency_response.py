# SPDX-License-Identifier: GPL-3.0-or-later
"""Stiffness and damping from measured frequency responses, made by an independent solver: closed forms, a chain of masses in
numpy, tables and universal files, noise of a fixed seed."""
import json
import math
import os
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

PROGRAM = os.environ["MODETUNE"]
problems = []
STATIONS = 3
MASSES = (2.0, 1.5, 1.0)
TRUE = {"k_1": 4.0e4, "k_2": 3.0e4, "k_3": 2.0e4, "c_1": 6.0, "c_2": 3.0, "eta_3": 0.02}


def check(holds, text):
    if not holds:
        problems.append(text)


def model(n, values):
    """A row of n masses on a guide along x, a spring between each and the next, dampers and a loss factor where named."""
    points = {f"p{i}": [0.1 * i, 0] for i in range(n + 1)}
    names = ["ground"] + [f"m{i + 1}" for i in range(n)]
    pair = lambda i: {"bodies": [names[i], names[i + 1]], "at": [f"p{i}", f"p{i + 1}"]}
    springs = [{"name": f"s{i + 1}", "type": "axial", **pair(i), "stiffness_n_per_m": f"k_{i + 1}"} for i in range(n)]
    for i, spring in enumerate(springs):
        if f"eta_{i + 1}" in values:
            spring["loss_factor"] = f"eta_{i + 1}"
    return {
        "format": "modetune-model/1", "dimension": 2,
        "parameters": {name: {"value": value} for name, value in values.items()},
        "points": points,
        "bodies": [{"name": f"m{i + 1}", "mass_kg": MASSES[i], "centre": f"p{i + 1}"} for i in range(n)],
        "joints": [{"name": f"g{i + 1}", "type": "pin-in-slot", "bodies": ["ground", f"m{i + 1}"], "at": f"p{i + 1}", "axis": [1, 0]} for i in range(n)],
        "springs": springs,
        "dampers": [{"name": f"d{i + 1}", "type": "axial", **pair(i), "damping_n_s_per_m": f"c_{i + 1}"} for i in range(n) if f"c_{i + 1}" in values],
        "sensors": [{"name": f"x{i + 1}", "on": f"m{i + 1}", "at": f"p{i + 1}", "directions": ["x"]} for i in range(n)],
    }


def response(n, values, hz, force, seen, motion=2):
    """Motion of mass `seen` per force on mass `force`: (-w^2 M + i w C + K (1 + i eta)) x = f, dense."""
    k, c = np.zeros((n, n), complex), np.zeros((n, n))
    for i in range(n):
        stiffness = values[f"k_{i + 1}"] * (1 + 1j * values.get(f"eta_{i + 1}", 0.0))
        for matrix, number in ((k, stiffness), (c, values.get(f"c_{i + 1}", 0.0))):
            matrix[i, i] += number
            if i > 0:
                matrix[i - 1, i - 1] += number
                matrix[i - 1, i] -= number
                matrix[i, i - 1] -= number
    m = np.diag(MASSES[:n])
    out = []
    for f in hz:
        w = 2 * math.pi * f
        x = np.linalg.solve(-w * w * m + 1j * w * c + k, np.eye(n)[force])
        out.append((1j * w) ** motion * x[seen])
    return np.array(out)


def table(path, hz, h, **labels):
    head = ",".join([*labels, "frequency_hz", "real", "imag"])
    rows = [",".join([*labels.values(), repr(float(f)), repr(float(v.real)), repr(float(v.imag))]) for f, v in zip(hz, h)]
    path.write_text("\n".join([head, *rows]) + "\n")


def universal(path, hz, sets, binary):
    """Datasets 58 as their description has them: (response node, direction, reference node, direction, values)."""
    out = b""
    for node, direction, reference, along, h in sets:
        number = f"    58b{1:6d}{2:6d}{11:12d}{24 * len(hz):12d}{0:6d}{0:6d}{0:12d}{0:12d}\n" if binary else "    58\n"
        head = "    -1\n" + number + "NONE\n" * 5
        head += f"{4:5d}{0:10d}{0:5d}{0:10d} {'NONE':10s}{node:10d}{direction:4d} {'NONE':10s}{reference:10d}{along:4d}\n"
        head += f"{6:10d}{len(hz):10d}{0:10d}{0.0:13.5e}{0.0:13.5e}{0.0:13.5e}\n"
        for kind, name, unit in ((18, "Frequency", "Hz"), (12, "Acceleration", "m/s^2"), (13, "Force", "N"), (0, "NONE", "NONE")):
            head += f"{kind:10d}{0:5d}{0:5d}{0:5d} {name:20s} {unit:20s}\n"
        out += head.encode()
        for f, v in zip(hz, h):
            out += struct.pack("<ddd", f, v.real, v.imag) if binary else f"{f:13.5e}{v.real:20.12e}{v.imag:20.12e}\n".encode()
        out += b"    -1\n"
    path.write_bytes(out)


class Bench:
    """A folder with a model whose parameters are off, and a study of it."""

    def __init__(self, folder, n, start, bounds, goals, measurements):
        self.folder = Path(folder)
        (self.folder / "model.json").write_text(json.dumps(model(n, start)))
        self.study = {
            "format": "modetune-study/1", "model": "model.json",
            "variables": [{"parameter": name, "lower": lower, "upper": upper} for name, (lower, upper) in bounds.items()],
            "goals": goals, "measurements": measurements, "objective": {"minimise": "misfit"}, "search": {"seed": 1, "starts": 4},
        }

    def run(self, command="run"):
        (self.folder / "study.json").write_text(json.dumps(self.study))
        arguments = [PROGRAM, command, "study.json"] + (["--quiet", "-o", "out"] if command == "run" else [])
        done = subprocess.run(arguments, cwd=self.folder, capture_output=True, text=True, timeout=600)
        self.text = done.stdout + done.stderr
        return done.returncode

    def found(self, what):
        code = self.run()
        path = self.folder / "out" / "study" / "result.json"
        if code not in (0, 1) or not path.exists():
            check(False, f"{what}: exit status {code}: {self.text[-600:]}")
            return None, None
        result = json.loads(path.read_text())
        best = result["recommendations"][0]
        return result, {v["name"]: v["recommended"] for v in best["parameters"]}


def goal(seen, force, name, **more):
    return {"type": "frequency_response", "input": f"x{force}.x", "output": f"x{seen}.x:acceleration", "measurement": name, "weight": 1, **more}


def one_mass(folder):
    """H = -w^2 / (k - w^2 m + i w c) identifies k and c to rounding, from far."""
    k, c, m = 8000.0, 5.0, MASSES[0]
    hz = np.linspace(2.0, 30.0, 57)
    w = 2 * math.pi * hz
    table(folder / "frf.csv", hz, -w**2 / (k - w**2 * m + 1j * w * c))
    for start in ({"k_1": 2500.0, "c_1": 50.0}, {"k_1": 24000.0, "c_1": 0.5}):
        bench = Bench(folder, 1, start, {"k_1": (800, 80000), "c_1": (0.05, 500)}, [goal(1, 1, "hammer")], {"hammer": {"file": "frf.csv"}})
        result, values = bench.found("one mass")
        if values:
            for name, want in (("k_1", k), ("c_1", c)):
                check(abs(values[name] / want - 1) < 1e-10, f"one mass from {start}: {name} is {values[name]!r}, not {want}")


def chain_study(folder, measurements, goals, start=None):
    start = start or {name: value * off for (name, value), off in zip(TRUE.items(), (0.6, 1.5, 1.3, 3.0, 0.3, 2.0))}
    bounds = {name: (value / 10, value * 10) for name, value in TRUE.items()}
    return Bench(folder, STATIONS, start, bounds, goals, measurements)


def chain(folder):
    """Six parameters of a chain, from a table, a universal file in text and one in binary."""
    hz = np.linspace(4.0, 50.0, 93)
    pairs = ((1, 1), (3, 1))
    sets = {pair: response(STATIONS, TRUE, hz, pair[1] - 1, pair[0] - 1) for pair in pairs}
    text = "".join(
        f"x{force}.x,x{seen}.x:acceleration,m/s^2 per N,{float(f)!r},{float(v.real)!r},{float(v.imag)!r}\n"
        for (seen, force), h in sets.items() for f, v in zip(hz, h))
    (folder / "both.csv").write_text("input,output,unit,frequency_hz,real,imag\n" + text)
    goals = [goal(seen, force, "hammer") for seen, force in pairs]
    forms = [("a table", {"hammer": {"file": "both.csv"}}, goals, 1e-8)]
    for binary in (False, True):
        name = "b.uff" if binary else "t.uff"
        universal(folder / name, hz, [(seen, -1, force, 1, -h) for (seen, force), h in sets.items()], binary)
        measurements = {f"h{seen}": {"file": name, "response_node": f"{seen}X", "reference_node": f"{force}+X"} for seen, force in pairs}
        forms.append((name, measurements, [goal(seen, force, f"h{seen}") for seen, force in pairs], 1e-8))
    for what, measurements, asked, tolerance in forms:
        result, values = chain_study(folder, measurements, asked).found(what)
        for name, want in TRUE.items() if values else ():
            check(abs(values[name] / want - 1) < tolerance, f"{what}: {name} is {values[name]!r}, not {want}")


def noise(folder):
    """Noise of a fixed seed: parameters lie within four standard deviations, which follow from the residuals' slopes."""
    hz = np.linspace(4.0, 50.0, 93)
    part = 0.02
    rng = np.random.default_rng(58)
    h = response(STATIONS, TRUE, hz, 0, 2)
    table(folder / "noisy.csv", hz, h * (1 + part * (rng.standard_normal(len(hz)) + 1j * rng.standard_normal(len(hz)))))
    result, values = chain_study(folder, {"hammer": {"file": "noisy.csv"}}, [goal(3, 1, "hammer")]).found("noise")
    if not values:
        return
    step = 1e-6
    columns = []
    for name in TRUE:
        up, down = dict(TRUE, **{name: TRUE[name] * (1 + step)}), dict(TRUE, **{name: TRUE[name] * (1 - step)})
        d = (np.log(response(STATIONS, up, hz, 0, 2)) - np.log(response(STATIONS, down, hz, 0, 2))) / (2 * step)
        columns.append(np.concatenate([d.real, d.imag]))
    jacobian = np.array(columns).T
    deviation = part * np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian)))
    for (name, want), sigma in zip(TRUE.items(), deviation):
        off = values[name] / want - 1
        check(abs(off) < 4 * sigma, f"noise: {name} is off by {off:.3g}, {abs(off) / sigma:.1f} standard deviations")
        check(abs(off) > 1e-9, f"noise: {name} is not moved by it")
    misfit = result["recommendations"][0]["misfit"]  # residuals sqrt(1/N) ln(H/Hm)
    expected = part * math.sqrt(2 * (1 - len(TRUE) / (2 * len(hz))))
    check(abs(misfit / expected - 1) < 0.25, f"noise: misfit {misfit:.4g}, expected about {expected:.4g}")


def round_trip(folder):
    """What `response` writes is a measurement: at its own parameters the misfit is rounding, and from others it comes back."""
    bench = chain_study(folder, {"hammer": {"file": "own.csv"}}, [goal(2, 1, "hammer")], start=TRUE)
    (folder / "model.json").write_text(json.dumps(model(STATIONS, TRUE)))
    command = [PROGRAM, "response", "model.json", "--input", "x1.x", "--measure", "x1.x:acceleration", "--measure", "x2.x:acceleration", "--points", "40", "--format", "csv"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=60)
    check(done.returncode == 0, f"round trip: {done.stderr}")
    (folder / "own.csv").write_text(done.stdout)
    result, values = bench.found("round trip")
    if values:
        check(result["baseline"]["misfit"] < 1e-9, f"round trip: misfit {result['baseline']['misfit']}")
    result, values = chain_study(folder, {"hammer": {"file": "own.csv"}}, [goal(2, 1, "hammer")]).found("round trip")
    for name, want in TRUE.items() if values else ():
        check(abs(values[name] / want - 1) < 1e-8, f"round trip: {name} is {values[name]!r}, not {want}")


def refusals(folder):
    """Every wrong thing is told where it stands, in words."""
    hz = np.linspace(4.0, 50.0, 12)
    h = response(STATIONS, TRUE, hz, 0, 2)
    table(folder / "good.csv", hz, h)
    table(folder / "unit.csv", hz, h, unit="m per N")
    table(folder / "other.csv", hz, h, output="x2.x:acceleration")
    table(folder / "zero.csv", hz, h * (hz > 20))
    (folder / "bad.csv").write_text("frequency_hz,real,imag\n1,2,x\n")
    universal(folder / "two.uff", hz, [(1, 1, 1, 1, h), (3, 1, 1, 1, h)], False)
    base = {"measurements": {"hammer": {"file": "good.csv"}}, "goal": goal(3, 1, "hammer")}
    cases = [
        ("a port", {"goal": goal(4, 1, "hammer")}, "did you mean", "study.json"),
        ("a measurement", {"goal": goal(3, 1, "hamer")}, 'did you mean "hammer"', "study.json"),
        ("a unit", {"measurements": {"hammer": {"file": "unit.csv"}}}, "is in m per N", "study.json"),
        ("another output", {"measurements": {"hammer": {"file": "other.csv"}}}, "no responses", "study.json"),
        ("a zero", {"measurements": {"hammer": {"file": "zero.csv"}}}, "no logarithm", "study.json"),
        ("no line in the band", {"goal": goal(3, 1, "hammer", band_hz=[60, 70])}, "no line of", "study.json"),
        ("a band that descends", {"goal": goal(3, 1, "hammer", band_hz=[30, 20])}, "ascending", "study.json"),
        ("coherence", {"goal": goal(3, 1, "hammer", coherence=True)}, "has no coherence", "study.json"),
        ("a wrong number", {"measurements": {"hammer": {"file": "bad.csv"}}}, "not a finite number", "bad.csv:2:5"),
        ("no file", {"measurements": {"hammer": {"file": "absent.csv"}}}, "absent.csv", "study.json"),
        ("two datasets", {"measurements": {"hammer": {"file": "two.uff"}}}, "say which", "study.json"),
        ("no such dataset", {"measurements": {"hammer": {"file": "two.uff", "dataset": 3}}}, "dataset 2: 3+X by 1+X", "study.json"),
        ("a dataset of a table", {"measurements": {"hammer": {"file": "good.csv", "dataset": 1}}}, "is a table", "study.json"),
        ("no freedom", {"measurements": {"hammer": {"file": "two.uff", "response_node": "X"}}}, "not a node and direction", "study.json"),
        ("a factor below 0", {"measurements": {"hammer": {"file": "good.csv", "factor": -1}}}, "above 0", "study.json"),
    ]
    for what, changed, says, where in cases:
        asked = {**base, **changed}
        bench = chain_study(folder, asked["measurements"], [asked["goal"]])
        code = bench.run("check")
        check(code == 2 and says in bench.text and where in bench.text, f"{what}: exit status {code}: {bench.text.strip()[-400:]}")


def undamped(folder):
    """A line at a resonance that nothing damps has no residual, which is said."""
    k, m = (2 * math.pi * 10.0) ** 2 * MASSES[0], MASSES[0]
    hz = np.array([5.0, 10.0, 15.0])
    table(folder / "frf.csv", hz, np.array([1.0, 2.0, 3.0]))
    bench = Bench(folder, 1, {"k_1": k}, {"k_1": (k / 2, k * 2)}, [goal(1, 1, "hammer")], {"hammer": {"file": "frf.csv"}})
    code = bench.run()
    path = bench.folder / "out" / "study" / "result.json"
    original = json.loads(path.read_text())["baseline"]["objectives"][0]["original"] if path.exists() else "no result"
    check(original is None, f"undamped: a misfit that has no value is {original}")
    check("nothing damps the resonance at 10 Hz, line 3" in bench.text or code in (0, 1), f"undamped: exit status {code}: {bench.text[-300:]}")


def status(folder):
    """A study whose goals are all weighted is a fit: converged or not, with its other local minima, bounds, and data that fit no mechanism."""
    hz = np.linspace(4.0, 50.0, 185)
    values = dict(TRUE, c_1=40.0)
    h = response(STATIONS, values, hz, 0, 2)
    for what, data, says in (("as measured", h, None), ("conjugated", h.conj(), "look conjugated"), ("reversed", -h, "look reversed")):
        table(folder / "frf.csv", hz, data)
        bench = chain_study(folder, {"hammer": {"file": "frf.csv"}}, [goal(3, 1, "hammer")], start=values)
        code = bench.run()
        result = json.loads((folder / "out/study/result.json").read_text())
        best = result["recommendations"][0]
        check((code, result["status"], best["grade"]) == (0, "fitted", "fitted"), f"{what}: exit status {code}, {result['status']}, {best['grade']}")
        check(result["status_text"].startswith("Fitted: the least misfit found from 4 starts is "), f"{what}: {result['status_text']}")
        looks = [w for w in result["warnings"] if "the data look " in w]
        check(len(looks) == (says is not None) and all(says in w for w in looks), f"{what}: {looks}")
        at = [p["name"] for p in best["parameters"] if p["at_bound"] is not None]
        check(all(f"; {name} is at its " in result["status_text"] for name in at), f"{what}: {at} at a bound: {result['status_text']}")
        check((what == "as measured") == (not at), f"{what}: at a bound: {at}")
        others = [r for r in result["recommendations"][1:]]
        for other in others:
            ratio = other["misfit"] / best["misfit"] if best["misfit"] > 1e-9 else None
            told = [r["text"] for r in other["reasons"] if "local minimum of the misfit" in r["text"]]
            check(other["grade"] == "local minimum" and len(told) == 1, f"{what}: {other['grade']}, {told}")
            if ratio and told:
                check(abs(float(told[0].split(", ")[1].split()[0]) / ratio - 1) < 0.006, f"{what}: {ratio}: {told}")
    table(folder / "frf.csv", hz, h)
    bench = chain_study(folder, {"hammer": {"file": "frf.csv"}}, [goal(3, 1, "hammer")])
    bench.study["search"]["max_evaluations"] = 12
    code = bench.run()
    result = json.loads((folder / "out/study/result.json").read_text())
    check((code, result["status"]) == (1, "compromise"), f"a budget: exit status {code}, {result['status']}: {result['status_text']}")


def main():
    for test in (status, one_mass, chain, noise, round_trip, refusals, undamped):
        with tempfile.TemporaryDirectory() as folder:
            test(Path(folder))
    print("\n".join(problems))
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""What is measured: the beam of problems/beam_reference.json in many ways, its closed forms, and its peers."""
import json
import math
import re
import subprocess
import sys
import time
from pathlib import Path

from _tables import PROGRAM, SOURCE, run

sys.path.insert(0, str(SOURCE / "tests/support"))
import large  # noqa: E402

LENGTH, WIDTH, YOUNG, DENSITY, MASS = 2 * math.sqrt(2), 0.05, 70e9, 2710.0, 1.0
HEIGHT = MASS / (DENSITY * WIDTH * LENGTH)
BENDING = YOUNG * WIDTH * HEIGHT**3 / 12
ROOTS = {  # beta L of the first four modes
    "cantilever": (1.875104068711961167, 4.694091132974174576, 7.854757438237612565, 10.995540734875466991),  # cos x cosh x = -1
    "free": (4.730040744862704026, 7.853204624095837556, 10.995607838001670907, 14.137165491257464177),  # cos x cosh x = 1
    "pinned": tuple(math.pi * j for j in (1, 2, 3, 4))}
EXACT = {where: [b * b / (2 * math.pi) * math.sqrt(BENDING / (MASS * LENGTH**3)) for b in roots] for where, roots in ROOTS.items()}


def error(hz, exact):
    """Largest relative error of the first frequencies, of as many as are told."""
    hz = [x for x in hz or [] if x == x]
    return max((abs(a / b - 1) for a, b in zip(hz, exact)), default=math.nan)


def beam(elements, springs=None, rigid=False, sensors=()):
    """The beam without supports ("free"), and on a pin and a sliding pin ("pinned"); its stiffness is the first parameter.
    springs: of the hinges of rigid elements [N m/rad]."""
    link = {"name": "beam", "from": "root", "to": "tip", "elements": elements}
    if rigid:
        link |= {"mass_kg": MASS, "stiffness_n_m_per_rad": f"EI*{elements}/L" if springs is None else [
            s if isinstance(s, str) else f"{s!r}*EI/{BENDING!r}" for s in springs]}
    else:
        link |= {"kind": "beam", "youngs_modulus_pa": f"EI/{BENDING / YOUNG!r}", "density_kg_per_m3": DENSITY,
                 "section": {"shape": "rectangle", "width_m": WIDTH, "height_m": HEIGHT}}
    return {"format": "modetune-model/1", "name": f"beam of {elements} elements", "dimension": 2,
            "parameters": {"EI": {"value": BENDING}, "L": {"value": LENGTH}},
            "points": {"root": [0, 0], "tip": [LENGTH, 0]}, "links": [link],
            "joints": [{"name": "pin", "type": "revolute", "bodies": ["ground", "beam.start"], "at": "root", "in": ["pinned"]},
                       {"name": "slider", "type": "pin-in-slot", "bodies": ["ground", "beam.end"], "at": "tip", "axis": [1, 0],
                        "in": ["pinned"]}],
            "sensors": [{"name": f"c{i}", "on": "beam", "fraction": x, "directions": ["y"]} for i, x in enumerate(sensors)],
            "configurations": {"free": {}, "pinned": {}}}


def cantilever(elements, rigid=False):
    """The same clamped at its root; of rigid elements, half of one before the first spring."""
    model = beam(elements, rigid=rigid)
    del model["configurations"], model["sensors"]
    if rigid:
        model["joints"] = [{"name": "clamp", "type": "revolute", "bodies": ["ground", "beam.start"], "at": "root"}]
        model["springs"] = [{"name": "root", "type": "torsion", "joint": "clamp", "stiffness_n_m_per_rad": f"2*EI*{elements}/L"}]
    else:
        model["joints"] = [{"name": "clamp", "type": "fixed", "bodies": ["ground", "beam.start"], "at": "root"}]
    return model


def put(path, document):
    Path(path).write_text(json.dumps(document), encoding="utf-8")
    return path


def identified(elements, folder):
    """Springs of rigid elements, as the paper finds them: mirror-symmetric, with the free beam's first frequencies (so many as
    there are springs, four at most; else as near to four as can be) and shapes as near to its shapes as can be. CPU seconds,
    the springs; None: no design."""
    unknown = elements // 2
    modes = min(4, elements - 1)
    centres = [f"{2 * i + 1}/{2 * elements}" for i in range(elements)]
    names = [f"K{min(i, elements - 2 - i) + 1}" for i in range(elements - 1)]
    model = beam(elements, springs=names, rigid=True, sensors=centres)
    model["parameters"] |= {f"K{i + 1}": {"value": f"EI*{elements}/L"} for i in range(unknown)}
    put(Path(folder) / "rigid.json", model)
    put(Path(folder) / "reference.json", beam(4 * elements, sensors=centres))
    physical = BENDING * elements / LENGTH
    weight = {} if unknown >= modes else {"weight": 100}
    study = {"format": "modetune-study/1", "name": "springs of rigid elements", "model": "rigid.json",
             "variables": [{"parameter": f"K{i + 1}", "lower": physical / 20, "upper": 20 * physical} for i in range(unknown)],
             "references": {"beam": {"model": "reference.json", "configuration": "free"}},
             "goals": [{"type": "frequency", "configuration": "free", "mode": j + 1, "target_hz": EXACT["free"][j], **weight}
                       for j in range(modes)] +
                      [{"type": "shape", "configuration": "free", "mode": j + 1, "reference": "beam", "weight": 1} for j in range(modes)],
             "objective": {"minimise": "misfit"}, "search": {"starts": 8}}
    out = Path(folder) / "identified"
    cpu, _, _ = run([PROGRAM, "run", put(Path(folder) / "study.json", study), "--quiet", "--threads", "1", "-o", out], folder)
    result = out / "study/result.json"
    if not result.exists():
        return cpu, None
    best = json.loads(result.read_text())["recommendations"][0]["parameters"]
    value = {p["name"]: p["recommended"] for p in best}
    return cpu, [value[name] for name in names]


def rigid_reference(elements):
    """First four frequencies of the cantilever of rigid elements in extended precision: inverse iteration, all by recursions
    along the chain, frequencies as quotients of sums of squares."""
    import numpy as np
    x = np.longdouble
    h, mass = x(LENGTH) / elements, x(MASS) / elements
    inertia = mass * h * h / 12
    spring = np.full(elements, x(BENDING) * elements / x(LENGTH))
    spring[0] *= 2

    def height(turn):
        return h * (np.cumsum(turn) - turn / 2)

    def inner(a, b):
        return np.sum(mass * height(a) * height(b)) + inertia * np.sum(a * b)

    found, hz = [], []
    for mode in range(4):
        turn = np.cos(x(mode) * np.pi * np.arange(elements) / elements)
        for _ in range(40):
            force = mass * height(turn)
            behind = np.cumsum(force[::-1])[::-1] - force / 2
            bend = np.cumsum((h * behind + inertia * turn)[::-1])[::-1] / spring
            turn = np.cumsum(bend)
            for other in found:
                turn = turn - inner(turn, other) * other
            turn = turn / np.sqrt(inner(turn, turn))
        found.append(turn)
        bend = np.diff(turn, prepend=x(0))
        hz.append(np.sqrt(np.sum(spring * bend * bend)) / (2 * x(math.pi)))
    return [float(f) for f in hz]


def rigid_exact(elements):
    """The same from a process of its own: ours stays small, as its size counts in that of those that it starts."""
    return [float(x) for x in run([sys.executable, "-B", __file__, elements])[1].split()]


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


def ours(elements, folder):
    path = Path(folder) / "model.json"
    if not path.exists():
        put(path, cantilever(elements))
    cpu, text, peak = run([PROGRAM, "modes", path, "--count", "4", "--format", "json"])
    return cpu, [m["frequency_hz"] for m in json.loads(text)[0]["modes"][:4]] if text else None, peak


class Frame:
    """A tower of so many floors of 10 x 10 nodes, tubes between neighbours (tests/support/large.py), as a file and as bench_frame makes it."""
    COUNT = 10

    def __init__(self, floors, folder):
        self.floors, self.path, model = floors, Path(folder) / "tower.json", large.tower(floors)
        self.elements, self.freedoms = len(model["links"]), 6 * 100 * (floors - 1)
        put(self.path, model)

    def ours(self):
        cpu, text, peak = run([PROGRAM, "modes", self.path, "--count", self.COUNT, "--format", "json"])
        return cpu, [m["frequency_hz"] for m in json.loads(text)[0]["modes"][:self.COUNT]] if text else None, peak

    def peer(self, program):
        cpu, text, peak = run([program, self.floors, self.COUNT])
        return cpu, [float(x) for x in text.splitlines()[1].split(",")[3:]] if text else None, peak


def scipy(elements, folder):
    cpu, text, peak = run([sys.executable, "-c", SCIPY, elements, *map(repr, (LENGTH, BENDING, YOUNG * WIDTH * HEIGHT, MASS))], folder)
    return cpu, [float(x) for x in text.split()] if text else None, peak


def calculix(elements, folder):
    deck = Path(folder) / "beam.inp"
    if not deck.exists():
        with open(deck, "w", encoding="ascii") as out:
            out.write("*NODE,NSET=ALL\n")
            out.writelines(f"{i + 1},{LENGTH * i / elements:.15g},0,0\n" for i in range(elements + 1))
            out.write("*ELEMENT,TYPE=B31,ELSET=BEAM\n")
            out.writelines(f"{i + 1},{i + 1},{i + 2}\n" for i in range(elements))
            out.write(f"*MATERIAL,NAME=M\n*ELASTIC\n{YOUNG},0.\n*DENSITY\n{DENSITY}\n*BEAM SECTION,ELSET=BEAM,MATERIAL=M,SECTION=RECT\n"
                      f"{WIDTH},{HEIGHT}\n0.,0.,1.\n*BOUNDARY\nALL,3\n1,1,6\n*STEP\n*FREQUENCY\n4\n*END STEP\n")
    cpu, text, peak = run(["ccx", "beam"], folder)
    found = re.findall(r"^ +\d+ +\S+ +\S+ +(\S+) +\S+$", (Path(folder) / "beam.dat").read_text(), re.M) if text else []
    return cpu, [float(x) for x in found[:4]] or None, peak


# Both peers hold the force straight between samples, which is their error; they are given the same file of A, B, time and force.
LSIM_SCIPY = """
import sys, numpy as np
from scipy.signal import lsim
d = np.load(sys.argv[1])
n = len(d["a"])
_, _, x = lsim((d["a"], d["b"], np.eye(n), np.zeros((n, 1))), d["u"], d["t"])
np.save(sys.argv[1] + ".out.npy", x[:, :n // 2])
"""
LSIM_OCTAVE = """
pkg load control
load(argv(){1});
n = rows(a);
[~, ~, x] = lsim(ss(a, b, eye(n), zeros(n, 1)), u(:), t(:));
x = x(:, 1:n/2);
save("-ascii", "-double", [argv(){1} ".out"], "x");
"""


class Motion:
    """A chain of masses on springs and dampers whose last one is pushed by a sine, from rest. With z = (x, v, sin, cos) as the
    states z' = A z, so that exp(A dt) takes one sample to the next: the truth."""
    HZ, FORCE, DURATION = 2.5, 3.0, 4.0

    def __init__(self, masses, samples, folder):
        import numpy as np
        from scipy.linalg import expm
        self.np, self.n, self.folder = np, masses, Path(folder)
        self.step = self.DURATION / samples
        m = 1 + 0.1 * np.arange(masses)
        k, c = np.full(masses, 2000.0), np.full(masses, 1.5)

        def line(v):
            return np.diag(v) + np.diag(np.append(v[1:], 0)) - np.diag(v[1:], 1) - np.diag(v[1:], -1)
        n, w = masses, 2 * math.pi * self.HZ
        a = np.block([[np.zeros((n, n)), np.eye(n)], [-line(k) / m[:, None], -line(c) / m[:, None]]])
        b = np.zeros((2 * n, 1))
        b[-1] = 1 / m[-1]
        whole = np.zeros((2 * n + 2, 2 * n + 2))
        whole[:2 * n, :2 * n], whole[:2 * n, [2 * n]] = a, b * self.FORCE
        whole[2 * n, 2 * n + 1], whole[2 * n + 1, 2 * n] = w, -w
        t = self.step * np.arange(samples + 1)
        on, z = expm(whole * self.step), np.append(np.zeros(2 * n + 1), 1.0)
        self.truth = np.zeros((samples + 1, n))
        for i in range(samples):
            z = on @ z
            self.truth[i + 1] = z[:n]
        u = self.FORCE * np.sin(w * t)
        self.data = self.folder / f"motion_{masses}.npz"
        np.savez(self.data, a=a, b=b, u=u, t=t)
        from scipy.io import savemat
        savemat(self.folder / f"motion_{masses}.mat", {"a": a, "b": b, "u": u, "t": t}, format="4")
        (self.folder / "lsim.m").write_text(LSIM_OCTAVE, encoding="utf-8")
        put(self.folder / f"motion_{masses}.json", self.model(m, k, c))

    def model(self, m, k, c):
        def tie(i, value, kind, member):
            return {"name": f"{kind}{i}", "type": "axial", "bodies": [f"b{i - 1}" if i else "ground", f"b{i}"], "at": [[i, 0], [i + 1, 0]],
                    member: value}
        return {"format": "modetune-model/1", "name": "chain", "dimension": 2,
                "bodies": [{"name": f"b{i}", "mass_kg": m[i], "inertia_kg_m2": 1, "centre": [i + 1, 0]} for i in range(self.n)],
                "joints": [{"name": f"j{i}", "type": "prismatic", "bodies": ["ground", f"b{i}"], "at": [i + 1, 0], "axis": [1, 0]}
                           for i in range(self.n)],
                "springs": [tie(i, k[i], "s", "stiffness_n_per_m") for i in range(self.n)],
                "dampers": [tie(i, c[i], "d", "damping_n_s_per_m") for i in range(self.n)],
                "sensors": [{"name": f"b{i}", "on": f"b{i}", "directions": ["x"]} for i in range(self.n)]}

    def ours(self):
        cpu, text, peak = run([PROGRAM, "simulate", self.folder / f"motion_{self.n}.json", "-c", "default", "--duration", self.DURATION,
                               "--dt-out", repr(self.step), "--sine", f"b{self.n - 1}.x={self.FORCE}@{self.HZ}", "--format", "json"])
        if text is None:
            return cpu, None, peak
        return cpu, self.np.array([out["values"] for out in json.loads(text)["outputs"]]).T, peak

    def scipy(self):
        cpu, text, peak = run([sys.executable, "-c", LSIM_SCIPY, self.data])
        return cpu, None if text is None else self.np.load(f"{self.data}.out.npy"), peak

    def octave(self):
        data = self.folder / f"motion_{self.n}.mat"
        cpu, text, peak = run(["octave", "--no-gui", "--norc", "--quiet", self.folder / "lsim.m", data])
        return cpu, None if text is None else self.np.loadtxt(f"{data}.out"), peak

    @staticmethod
    def has_control():
        return run(["octave", "--no-gui", "--norc", "--quiet", "--eval", "pkg load control"])[1] is not None

    def error(self, x):
        if x is None or x.shape != self.truth.shape:
            return math.nan
        return float(self.np.max(abs(x - self.truth)) / self.np.max(abs(self.truth)))


def affine(masses, folder):
    """A study whose variables enter K affinely: a chain of masses on springs, the first frequency within a range."""
    model = {"format": "modetune-model/1", "name": f"chain of {masses} masses", "dimension": 2,
             "parameters": {f"k{i + 1}": {"value": 1000 * (i + 1)} for i in range(masses)},
             "points": {f"p{i}": [i, 0] for i in range(masses + 1)},
             "bodies": [{"name": f"m{i}", "mass_kg": i, "centre": f"p{i}"} for i in range(1, masses + 1)],
             "joints": [{"name": f"guide{i}", "type": "pin-in-slot", "bodies": ["ground", f"m{i}"], "at": f"p{i}", "axis": [1, 0]}
                        for i in range(1, masses + 1)],
             "springs": [{"name": f"s{i}", "type": "axial", "bodies": [f"m{i - 1}" if i > 1 else "ground", f"m{i}"],
                          "at": [f"p{i - 1}", f"p{i}"], "stiffness_n_per_m": f"k{i}"} for i in range(1, masses + 1)]}
    study = {"format": "modetune-study/1", "name": model["name"], "model": f"chain_{masses}_model.json",
             "variables": [{"parameter": f"k{i + 1}", "lower": 100, "upper": 10000} for i in range(masses)],
             "goals": [{"type": "frequency", "mode": 1, "at_least_hz": 2, "at_most_hz": 9}]}
    put(Path(folder) / study["model"], model)
    return put(Path(folder) / f"chain_{masses}.json", study)


def answer(result):
    """Of a result.json: what its best design leaves of its goals, or is above the best known value of what it minimises."""
    goals = [g["violation_percent"] / 100 for g in result["recommendations"][0]["goals"] if not g["weighted"]]
    known = [p["computed"] / p["published"] - 1 for p in result["published"] if (p["label"] or "").startswith("mass")]
    return {"status": result["status"], "evaluations": result["run"]["evaluations"], "error": max([0.0, *goals, *known])}


def watched(study, folder):
    """A study as `side_by_side` has it: its marks count from where its file is opened."""
    command = [PROGRAM, "run", study, "--quiet", "--progress", "json", "--threads", "1", "-o", folder]
    cpu, text, peak = run(command, fine=(0, 1), errors=subprocess.STDOUT)
    said = [json.loads(line) for line in text.splitlines() if line.startswith('{"format"')]
    ends = [s for s in said if s["state"] == "done"]
    reading = sum(s["cpu_s"] for s in ends[:-1])
    result = json.loads((Path(folder) / Path(study).stem / "result.json").read_text(encoding="utf-8"))
    marks = {of: math.nan if ends[-1][of] is None else reading + ends[-1][of] for of in ("first_cpu_s", "best_cpu_s", "proof_cpu_s")}
    proven = " ".join(sorted({c["kind"] for c in result["certificates"] if c["proven"]}))
    return cpu, {**answer(result), **marks, "first_evaluations": ends[-1]["first_evaluations"], "best_evaluations": ends[-1]["best_evaluations"],
                 "variables": len(result["variables"]), "multiplications": result["run"]["spent"]["multiplications"], "proven": proven}, peak


if __name__ == "__main__":
    print(*map(repr, rigid_reference(int(sys.argv[1]))))


def chain_response(n, coupled, frequencies=1000):
    """The chain of bench_response.c solved by NumPy, all frequencies at once: CPU seconds, (w, responses of all masses), no memory told."""
    import numpy  # not needed by the other tables

    i = numpy.arange(n)
    k, c = 1e4 * (1 + 0.05 * i), numpy.zeros(n)
    c[-1 if coupled else slice(None)] = 1e-2 * k[-1] if coupled else 1e-4 * k

    def banded(x):
        return numpy.diag(x + numpy.append(x[1:], 0)) - numpy.diag(x[1:], 1) - numpy.diag(x[1:], -1)

    w = 0.1 + (200.0 - 0.1) * numpy.arange(frequencies) / (frequencies - 1)
    push = numpy.zeros((n, 1))
    push[-1] = 1
    mass, damping, stiffness = numpy.diag(1 + 0.1 * i), banded(c), banded(k)
    start = time.process_time()
    d = stiffness - (w**2)[:, None, None] * mass + 1j * w[:, None, None] * damping
    h = numpy.linalg.solve(d, numpy.broadcast_to(push, (frequencies, n, 1)))[:, :, 0]
    return time.process_time() - start, (w, h), 0.0

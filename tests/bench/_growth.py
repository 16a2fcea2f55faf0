# SPDX-License-Identifier: GPL-3.0-or-later
"""What grows: the same question of larger models, and its CPU time by its size. Rows of masses of 1 kg between springs of 1 kN/m, which slide along a line,
and the models of tests/support/large.py; everything is made anew at each size."""
import json
import math
import sys
import time
from pathlib import Path

from _tables import PROGRAM, SOURCE, run

sys.path.insert(0, str(SOURCE / "tests/support"))
import large  # noqa: E402

STIFFNESS = 1000.0
SIX, TEN = (3, 4, 6, 8, 12), (10, 100, 1000)


def put(path, document):
    Path(path).write_text(json.dumps(document), encoding="utf-8")
    return path


def hz(n, j):
    """Mode j of n masses in a row, one end held: 2 sqrt(k/m) sin((2 j - 1) pi / (4 n + 2))."""
    return math.sqrt(STIFFNESS) / math.pi * math.sin((2 * j - 1) * math.pi / (4 * n + 2))


def row(n, configurations=None):
    model = {"format": "modetune-model/1", "name": f"{n} masses in a row", "dimension": 2,
             "parameters": {f"k{i}": STIFFNESS for i in range(n)} | ({"p": 1.0} if configurations else {}),
             "bodies": [{"name": f"b{i}", "mass_kg": "p" if configurations and i == 0 else 1, "inertia_kg_m2": 1, "centre": [i + 1, 0]} for i in range(n)],
             "joints": [{"name": f"j{i}", "type": "prismatic", "bodies": ["ground", f"b{i}"], "at": [i + 1, 0], "axis": [1, 0]} for i in range(n)],
             "springs": [{"name": f"s{i}", "type": "axial", "bodies": ["ground" if i == 0 else f"b{i - 1}", f"b{i}"],
                          **({"at": [[0, 0], [1, 0]]} if i == 0 else {}), "stiffness_n_per_m": f"k{i}"} for i in range(n)]}
    if configurations:
        model["configurations"] = {f"c{i}": {"parameters": {"p": 1.0 + 0.5 * i / configurations}} for i in range(configurations)}
    return model


def study(folder, model, goals, **more):
    put(Path(folder) / "row.json", model)
    free = [{"parameter": f"k{i}", "lower": STIFFNESS / 2, "upper": 2 * STIFFNESS} for i in range(len(model["bodies"]))]
    question = {"format": "modetune-study/1", "name": "as large as wanted", "model": "row.json", "variables": free, "goals": goals} | more
    return ["run", put(Path(folder) / "study.json", question), "--quiet", "--threads", "1", "--report", "none", "-o", folder]


def bands(n, at):
    """Goal and bands: narrow ones about modes at[.] of the row."""
    return {"type": "avoid", "bands_hz": [[hz(n, j) * 0.97, hz(n, j) * 1.03] for j in at]}


def by_modes(n, folder):
    return study(folder, row(n), [bands(n, (1, 2, 3))])


def by_bands(n, folder):
    return study(folder, row(12), [bands(12, range(1, n + 1))])


def by_variables(n, folder):
    return study(folder, row(n), [{"type": "frequency", "mode": 1, "target_hz": hz(n, 1) * 1.1}])


def by_tolerances(n, folder):
    question = study(folder, row(6), [{"type": "frequency", "mode": 1, "at_least_hz": hz(6, 1) * 1.1}])
    document = json.loads(Path(question[1]).read_text(encoding="utf-8"))
    for variable in document["variables"][:n]:
        variable["tolerance_percent"] = 2
    put(question[1], document)
    return question


def by_configurations(n, folder):
    where = [f"c{i}" for i in range(n)]
    return study(folder, row(4, n), [{"type": "frequency", "configurations": where, "mode": 1, "at_least_hz": hz(4, 1) * 1.02}])


def by_many_bands(n, folder):
    """As many thin bands between modes 3 and 4 of six, and one about mode 2."""
    low, high = hz(6, 3) * 1.08, hz(6, 4) * 0.94
    step = (high - low) / n
    thin = [[low + step * i, low + step * (i + 0.5)] for i in range(n)]
    return study(folder, row(6), [{"type": "avoid", "bands_hz": thin}, bands(6, (2,))])


def by_points(n, folder):
    goals = [{"type": "frequency", "mode": 1, "at_least_hz": hz(3, 1)}, {"type": "frequency", "mode": 3, "at_most_hz": hz(3, 3)}]
    vary = [{"goal": 0, "member": "at_least_hz", "values": [hz(3, 1) * (1 + 0.1 * i / n) for i in range(n)]},
            {"goal": 1, "member": "at_most_hz", "values": [hz(3, 3) * (1 - 0.1 * i / n) for i in range(n)]}]
    return study(folder, row(3), goals, trade={"vary": vary})


def by_lines(n, folder):
    """The shipped identification with so many lines of each response, straight between those that it has."""
    told = (SOURCE / "problems/measurements/three_masses.csv").read_text(encoding="utf-8").splitlines()
    head = next(k for k, line in enumerate(told) if line.startswith("input"))
    of = {}
    for line in told[head + 1:]:
        words = line.split(",")
        of.setdefault(tuple(words[:3]), []).append([float(x) for x in words[3:]])
    with open(Path(folder) / "hammer.csv", "w", encoding="utf-8") as file:
        file.write(told[head] + "\n")
        for names, rows in of.items():
            for i in range(n):
                at = i * (len(rows) - 1) / (n - 1)
                k = min(int(at), len(rows) - 2)
                values = [a + (at - k) * (b - a) for a, b in zip(rows[k], rows[k + 1])]
                file.write(",".join([*names, *(repr(x) for x in values)]) + "\n")
    shipped = json.loads((SOURCE / "studies/three_masses_identification.json").read_text(encoding="utf-8"))
    shipped.pop("published")
    shipped.update(model="model.json", measurements={"hammer": {"file": "hammer.csv"}}, search={"starts": 1})
    put(Path(folder) / "model.json", json.loads((SOURCE / "problems/three_masses.json").read_text(encoding="utf-8")))
    return ["run", put(Path(folder) / "study.json", shipped), "--quiet", "--threads", "1", "--report", "none", "-o", folder]


def modes(make, count):
    return lambda n, folder: ["modes", put(Path(folder) / "model.json", make(n)), "--count", str(count)]


def loaded(n):
    return large.link(n) | {"gravity_m_per_s2": [0, -1e-3]}


def response(n, folder):
    tip = {"sensors": [{"name": "tip", "on": "beam", "fraction": 1, "directions": ["y"]}]}
    return ["response", put(Path(folder) / "model.json", large.link(n) | tip), "--input", "base.y", "--from", "0.1", "--to", "50", "--points", "1000"]


def cube(n):
    return large.frame(n, n, n, 1)


def response_of_cube(n, folder):
    model = cube(n)
    top = {"sensors": [{"name": "top", "on": model["links"][-1]["name"], "fraction": 1, "directions": ["x"]}], "damping": {"mass_per_s": 1}}
    return ["response", put(Path(folder) / "model.json", model | top), "--input", "base.x", "--from", "0.1", "--to", "3", "--points", "200"]


# What is asked, of what there are so many, sizes, and the command.
FAMILIES = (
    ("modes of a link, 20 lowest", "elements", (1000, 10000, 100000, 1000000), modes(large.link, 20)),
    ("modes of a beam, 20 lowest", "elements", (1000, 10000, 100000, 1000000), modes(large.beam, 20)),
    ("modes of a link under its weight, 20 lowest", "elements", (1000, 10000, 100000), modes(loaded, 20)),
    ("all modes of a link", "elements", (100, 300, 1000), modes(large.link, "all")),
    ("modes of a space frame, 20 lowest", "beams to an edge", (4, 8, 16), modes(cube, 20)),
    ("response of a link, 1000 frequencies", "elements", (100, 1000, 10000, 100000), response),
    ("response of a space frame, 200 frequencies", "beams to an edge", (4, 8, 11), response_of_cube),
    ("least change out of three bands", "modes", SIX, by_modes),
    ("least change out of bands, 12 modes", "bands", (1, 2, 3, 4, 6), by_bands),
    ("least change to a target", "variables", (3, 6, 12, 24), by_variables),
    ("least change over tolerances, 6 variables", "tolerances", (1, 2, 4, 6), by_tolerances),
    ("least change in configurations", "configurations", TEN, by_configurations),
    ("least change out of many bands", "bands", TEN, by_many_bands),
    ("fit to a measured response", "lines", (100, 1000, 10000, 100000), by_lines),
    ("trade study", "points to an edge", (10, 30, 100), by_points),
)


def measure(family, size, folder):
    """CPU seconds, whether it was answered, peak memory [MiB]."""
    command = family[3](size, folder)
    cpu, text, peak = run([PROGRAM, *command], folder, fine=(0, 1))
    return cpu, text is not None, peak


def waited(name, count, folder):
    """Wall seconds of a shipped study on so many threads."""
    begun = time.monotonic()
    run([PROGRAM, "run", SOURCE / "studies" / f"{name}.json", "--quiet", "--threads", str(count), "-o", folder], fine=(0, 1))
    return time.monotonic() - begun

#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A space grid of bodies with springs and rods between them, assembled here row by row and answered by SciPy: by all modes in a basis of what the rods leave free, and,
with the rods as springs of their own, by ARPACK on the sparse matrices."""
import json
import math
import os
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from scipy.linalg import eigh, null_space
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import eigsh

MODETUNE = os.environ["MODETUNE"]
GRID = (6, 5, 4)
COUNT = 12


def grid(rods, fixed):
    """The model; its rows for springs and rods, stiffnesses, and masses: 6 states a body."""
    draw = np.random.default_rng(11)
    nodes = [(i, j, k) for k in range(GRID[2]) for j in range(GRID[1]) for i in range(GRID[0])]
    place = {node: at for at, node in enumerate(nodes)}
    centres = np.array(nodes, dtype=float) + draw.uniform(-0.1, 0.1, (len(nodes), 3))
    masses, inertias = draw.uniform(1, 3, len(nodes)), draw.uniform(0.03, 0.05, (len(nodes), 3))
    model = {"format": "modetune-model/1", "name": "Grid", "dimension": 3, "joints": [], "springs": [],
             "bodies": [{"name": f"b{b}", "mass_kg": masses[b], "centre": list(centres[b]), "inertia_kg_m2": [*inertias[b], 0, 0, 0]}
                        for b in range(len(nodes))]}
    springs, stiffnesses, equations = [], [], []

    def join(a, b):
        """Four springs, or three and a rod, from near the one centre (or the ground) to near the other."""
        for turn in range(4):
            ends = [centres[b] + [0, 0, -1] if a is None else centres[a], centres[b]] + draw.uniform(-0.3, 0.3, (2, 3))
            axis = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
            row = np.zeros(6 * len(nodes))
            for body, end, sign in ((a, ends[0], -1), (b, ends[1], 1)):
                if body is not None:
                    row[6 * body:6 * body + 6] = np.concatenate([sign * axis, sign * np.cross(end - centres[body], axis)])
            part = {"bodies": ["ground" if a is None else f"b{a}", f"b{b}"], "at": [list(end) for end in ends]}
            if rods and a is not None and turn == 0 and draw.uniform() < 0.3:
                model["joints"].append({"name": f"r{len(equations)}", "type": "distance", **part})
                equations.append(row)
            else:
                stiffness = 10 ** draw.uniform(3, 6)
                model["springs"].append({"name": f"s{len(springs)}", "type": "axial", "stiffness_n_per_m": stiffness, **part})
                springs.append(row)
                stiffnesses.append(stiffness)

    for node, b in place.items():
        if node[2] == 0 and fixed:
            join(None, b)
        for axis in range(3):
            behind = tuple(x - (a == axis) for a, x in enumerate(node))
            if behind in place:
                join(place[behind], b)
    mass = np.diag(np.concatenate([[masses[b]] * 3 + list(inertias[b]) for b in range(len(nodes))]))
    rows = np.array(springs)
    return model, rows.T @ (np.array(stiffnesses)[:, None] * rows), mass, np.array(equations).reshape(-1, mass.shape[0])


def answer(model):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "model.json")
        path.write_text(json.dumps(model), encoding="utf-8")
        done = subprocess.run([MODETUNE, "modes", str(path), "--count", str(COUNT), "--format", "json"], check=True, capture_output=True, timeout=100)
        return json.loads(done.stdout)[0]


def main():
    bad = 0
    for rods, fixed in ((False, True), (True, True), (True, False)):
        model, k, m, a = grid(rods, fixed)
        got = answer(model)
        z = null_space(a) if rods else np.eye(len(k))
        every = np.sqrt(np.maximum(eigh(z.T @ k @ z, z.T @ m @ z, eigvals_only=True), 0)) / (2 * math.pi)
        rigid = 0 if fixed else 6
        want = every[rigid:rigid + COUNT]
        if not rods:
            one = np.sort(eigsh(csc_matrix(k), COUNT, csc_matrix(m), sigma=0, tol=1e-14, return_eigenvectors=False))
            want = np.sqrt(one) / (2 * math.pi)
        told = [mode for mode in got["modes"] if mode["kind"] == "flexible"]
        f = np.array([mode["frequency_hz"] for mode in told])
        error = np.array([mode["frequency_error_hz"] for mode in told])
        noise = 1e-11 * want if fixed else 1e-9 * want  # of SciPy's answer: rounding of its K, as the largest eigenvalue has it
        fine = (got["method"] == "sparse" and got["rigid_body_modes"] == rigid and got["freedoms"] == z.shape[1] and
                len(f) == COUNT and bool(np.all(np.abs(f - want) <= error + noise)) and bool(np.all(error <= 1e-10 * f)))
        if not fine:
            bad += 1
        print(f"rods {rods}, fixed {fixed}: {got['method']}, {got['freedoms']} freedoms, {len(a)} rods, "
              f"worst difference {np.max(np.abs(f / want - 1)) if len(f) == COUNT else math.nan:.1e}, worst error told {np.max(error / f):.1e}: {'ok' if fine else 'FAILED'}")
    return bad


if __name__ == "__main__":
    raise SystemExit(main())

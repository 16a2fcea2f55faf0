#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Models of any size, as JSON on standard output: large.py KIND N.
link     one link of N rigid elements with springs in its hinges, pinned to the ground through a spring
beam     a clamped beam link of N elements
chain    N bodies with a revolute joint and a torsional spring each, all written out
points   the same with a named point for each joint
ring     N bodies in a circle of unit radius, hinged with torsional springs, free
tower    a space frame of 10 x 10 columns and N floors, an element for each of its beams: 280 to a floor, on clamped feet"""
import json
import math
import sys


def _root(dimension=2):
    return {"format": "modetune-model/1", "name": "As large as wanted", "dimension": dimension}


def link(n):
    """The cantilever of unit length, mass and stiffness EI in n rigid elements: k = EI/l, and twice that at the clamped end."""
    return {**_root(), "points": {"root": [0, 0], "tip": [1, 0]},
            "links": [{"name": "beam", "from": "root", "to": "tip", "elements": n, "mass_kg": 1.0, "stiffness_n_m_per_rad": float(n)}],
            "joints": [{"name": "root", "type": "revolute", "bodies": ["ground", "beam.start"], "at": "root"}],
            "springs": [{"name": "root", "type": "torsion", "joint": "root", "stiffness_n_m_per_rad": 2.0 * n}]}


def beam(n):
    section = {"shape": "general", "area_m2": 1.0, "second_moment_m4": 1e-6}
    return {**_root(), "points": {"root": [0, 0], "tip": [1, 0]},
            "links": [{"name": "beam", "kind": "beam", "from": "root", "to": "tip", "elements": n, "mass_kg": 1.0,
                       "youngs_modulus_pa": 1e6, "section": section}],
            "joints": [{"name": "root", "type": "fixed", "bodies": ["ground", "beam.start"], "at": "root"}]}


def chain(n, named_points=False):
    """As link(n), every part written out."""
    def at(i):
        return [f"p{i}", f"p{i}"] if named_points else [i / n, 0]
    model = {**_root(), "parameters": {"m": 1.0 / n, "k": float(n)},
             "bodies": [{"name": f"b{i}", "mass_kg": "m", "inertia_kg_m2": 1.0 / (12.0 * n ** 3), "centre": [(i + 0.5) / n, 0]}
                        for i in range(n)],
             "joints": [{"name": f"j{i}", "type": "revolute", "bodies": [f"b{i - 1}" if i else "ground", f"b{i}"], "at": at(i)}
                        for i in range(n)],
             "springs": [{"name": f"s{i}", "type": "torsion", "joint": f"j{i}", "stiffness_n_m_per_rad": "k" if i else "2*k"}
                         for i in range(n)]}
    if named_points:
        model["points"] = {f"p{i}": [i / n, 0] for i in range(n)}
    return model


def points(n):
    return chain(n, named_points=True)


def frame(nx, ny, nz, elements, clamped=True):
    """A space frame of nx x ny x nz nodes, tubes between neighbours, its lowest nodes clamped or free."""
    tube = {"shape": "tube", "outer_diameter_m": 0.2, "inner_diameter_m": 0.18}
    model = {**_root(3), "points": {}, "links": [], "joints": []}
    ends = {}
    for node in ((i, j, k) for i in range(nx) for j in range(ny) for k in range(nz)):
        model["points"]["p%d_%d_%d" % node] = [3.0 * node[0], 4.0 * node[1], 3.5 * node[2]]
        for axis, n in enumerate((nx, ny, nz)):
            if node[axis] + 1 < n:
                name = f"L{len(model['links'])}"
                other = tuple(x + (a == axis) for a, x in enumerate(node))
                model["links"].append({"name": name, "kind": "beam", "from": "p%d_%d_%d" % node, "to": "p%d_%d_%d" % other, "elements": elements,
                                       "youngs_modulus_pa": 2.1e11, "shear_modulus_pa": 8e10, "density_kg_per_m3": 7850, "section": tube})
                ends.setdefault(node, []).append(f"{name}.start")
                ends.setdefault(other, []).append(f"{name}.end")
    for node, there in ends.items():
        for end in (["ground"] if clamped and node[2] == 0 else []) + there[1:]:
            model["joints"].append({"name": f"J{len(model['joints'])}", "type": "fixed", "bodies": [there[0], end], "at": "p%d_%d_%d" % node})
    return model


def ring(n, bending_stiffness=1000.0):
    """Unit mass to a metre; the last hinge closes the loop."""
    at = [[math.cos(2 * math.pi * i / n), math.sin(2 * math.pi * i / n)] for i in range(n)]
    length = math.dist(at[0], at[1])
    middle = [[(a + b) / 2 for a, b in zip(at[i], at[(i + 1) % n])] for i in range(n)]
    return {**_root(),
            "bodies": [{"name": f"b{i}", "mass_kg": length, "inertia_kg_m2": length ** 3 / 12, "centre": middle[i]} for i in range(n)],
            "joints": [{"name": f"j{i}", "type": "revolute", "bodies": [f"b{(i - 1) % n}", f"b{i}"], "at": at[i]} for i in range(n)],
            "springs": [{"name": f"s{i}", "type": "torsion", "joint": f"j{i}", "stiffness_n_m_per_rad": bending_stiffness / length}
                        for i in range(n)]}


def tower(floors):
    return frame(10, 10, floors, 1)


KINDS = {"link": link, "beam": beam, "chain": chain, "points": points, "ring": ring, "tower": tower}

if __name__ == "__main__":
    json.dump(KINDS[sys.argv[1]](int(sys.argv[2])), sys.stdout)

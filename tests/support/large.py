#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Models of any size, as JSON on standard output: large.py KIND N.
link     one link of N rigid elements with springs in its hinges, pinned to the ground through a spring
beam     a clamped beam link of N elements
chain    N bodies with a revolute joint and a torsional spring each, all written out
points   the same with a named point for each joint"""
import json
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


KINDS = {"link": link, "beam": beam, "chain": chain, "points": points}

if __name__ == "__main__":
    json.dump(KINDS[sys.argv[1]](int(sys.argv[2])), sys.stdout)

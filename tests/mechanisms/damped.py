# SPDX-License-Identifier: GPL-3.0-or-later
"""Damping of a random mechanism: dampers beside its springs, loss factors, damping ratios, proportional damping; and the roots that it must have.

What a spring stores, sum of k_ij (g_i . u)(g_j . u), is what its damper and its loss factor are made of; in the exact modes without damping
    s^2 I + s C + Lambda + i H,   C = sum of (c/k) Gamma_s + alpha I + beta Lambda + 2 diag(zeta omega),   H = sum of eta Gamma_s
is an eigenproblem of doubles that nothing spoils.
"""
import copy
import math

import numpy as np
from statics import along

RATIO = 0.03     # of modes that have one of no other kind
CLOSE = 1e-3     # relative; roots nearer to each other than this are left out
REAL = 1e-4      # Im s / |s| below which nobody asks whether a root is real
APART = 1e5      # of frequencies in doubles
ACCURACY = 1e-8  # of roots


def _times(value, factor):
    """A number or expression, or a list of them; None where it is none, or negative."""
    if isinstance(value, list):
        many = [_times(x, factor) for x in value]
        return None if None in many else many
    if isinstance(value, str):
        return f"({value})*{factor!r}"
    return value * factor if isinstance(value, (int, float)) and value >= 0 else None


def _damper(spring, factor):
    """Beside the spring, with so many times its stiffness."""
    if spring["type"] == "bar" or "stiffness_matrix" in spring:
        return None
    out = {k: copy.deepcopy(v) for k, v in spring.items() if k in ("type", "bodies", "joint", "at", "axes", "in")}
    out["name"] = f"d_{spring['name']}"
    for member, own in (("stiffness_n_per_m", "damping_n_s_per_m"), ("stiffness_n_m_per_rad", "damping_n_m_s_per_rad")):
        if member in spring:
            out[own] = _times(spring[member], factor)
            if out[own] is None:
                return None
    return out


def _bearing(rng, joint, omega, dampers, losses):
    """Damping of what a joint yields: a loss factor, and dampers beside its stiffnesses."""
    own, name = joint["compliance"], f"{joint['name']}.bearing"
    if rng.random() < 0.6:
        losses[name] = own["loss_factor"] = rng.uniform(0.01, 0.3)
    if rng.random() < 0.6:
        dampers[name] = rng.uniform(0.01, 0.6) / omega
        beside = lambda k: k if k == "rigid" else f"({k})*{dampers[name]!r}"
        for member, damping in (("stiffness_n_per_m", "damping_n_s_per_m"), ("stiffness_n_m_per_rad", "damping_n_m_s_per_rad")):
            if member in own:
                own[damping] = [beside(k) for k in own[member]] if isinstance(own[member], list) else beside(own[member])


def damp(rng, model, modes):
    """The model with damping, and what it is made of: {spring: c/k}, {spring or link: eta}, its "damping"."""
    out, dampers, losses = copy.deepcopy(model), {}, {}
    omega = [2 * math.pi * float(f) for f in modes.hz()]
    out["dampers"] = []
    for spring in out.get("springs", []):
        factor = rng.uniform(0.01, 0.6) / rng.choice(omega)
        beside = _damper(spring, factor) if rng.random() < 0.5 else None
        if beside:
            out["dampers"].append(beside)
            dampers[spring["name"]] = factor
    if rng.random() < 0.6:
        for item in out.get("springs", []) + out.get("links", []):
            if rng.random() < 0.6:
                losses[item["name"]] = item["loss_factor"] = rng.uniform(0.01, 0.3)
            if "axes" in item and "stiffness_matrix" not in item:  # by direction
                losses[item["name"]] = item["loss_factor"] = [rng.uniform(0.01, 0.3) for _ in range(3 if out["dimension"] == 2 else 6)]
    for joint in out.get("joints", []):
        if "compliance" in joint:
            _bearing(rng, joint, rng.choice(omega), dampers, losses)
    given = {"ratio": RATIO, "ratios": [rng.uniform(0, 0.3) for _ in range(rng.randint(1, len(omega)))],
             "mass_per_s": rng.uniform(0, 0.3) * omega[0], "stiffness_s": rng.uniform(0, 0.1) / omega[-1]}
    out["damping"] = {k: v for k, v in given.items() if rng.random() < 0.5}
    return out, dampers, losses


def _gamma(elastic, shapes):
    """What the spring stores, of pairs of shapes."""
    out = np.zeros((len(shapes), len(shapes)))
    for f, g, h in elastic:
        a, b = (np.array([float(along(x, u)) for u in shapes]) for x in (g, h))
        one = float(f) * np.outer(a, b)
        out += one if g is h else one + one.T
    return out


def roots(modes, model, dampers, losses):
    """Of motions that oscillate, ascending by size; None where doubles, or the borders of what oscillates, are in the way."""
    given, n = model["damping"], len(modes.shapes)
    values = np.array([0.0 if zero else float(x) for x, zero in zip(modes.values, modes.zero)])
    omega = np.sqrt(values)
    c = given.get("mass_per_s", 0) * np.eye(n) + given.get("stiffness_s", 0) * np.diag(values)
    h, index = np.zeros((n, n)), 0
    for i, zero in enumerate(modes.zero):
        listed = given.get("ratios", [])
        if not zero:
            c[i, i] += 2 * omega[i] * (listed[index] if index < len(listed) else given.get("ratio", 0))
            index += 1
    for spring, (_, _, elastic) in zip(modes.problem.oracle.springs, modes.state.parts):
        link = spring.name.split(".")[0]
        lost, slow = losses.get(spring.name, losses.get(link, 0)), dampers.get(spring.name, 0)
        if lost or slow:
            if isinstance(lost, list):  # a bushing without couplings: one part for each direction that is not slack
                stiff = [i for i, row in enumerate(spring.k) if row[i]]
                h = h + sum(lost[i] * _gamma([part], modes.shapes) for i, part in zip(stiff, elastic))
                lost = 0
            gamma = _gamma(elastic, modes.shapes)
            h, c = h + lost * gamma, c + slow * gamma
    vibrations = omega[omega > 0]
    if not len(vibrations) or vibrations.max() > APART * vibrations.min():
        return None
    scale = np.where(omega > 0, omega, vibrations.min())
    a = np.block([[np.zeros((n, n)), np.diag(scale)], [-(np.diag(values) + 1j * h) / scale, -c]])
    s = np.linalg.eigvals(a)
    s = s[np.abs(s) > 1e-6 * vibrations.min()]
    if (np.abs(s.imag) < REAL * np.abs(s)).any():
        return None
    return sorted(s[s.imag > 0], key=abs)


def compare(answer, expected):
    """A sentence on the first root that is wrong, or None."""
    given = [complex(-m["decay_per_s"], 2 * math.pi * m["damped_frequency_hz"]) for m in answer["damped_modes"] if m["damped_frequency_hz"]]
    if len(given) != len(expected):
        return f"{len(given)} motions oscillate, exact {len(expected)}"
    for want in expected:
        if sum(abs(want - x) < CLOSE * abs(want) for x in expected) > 1:
            continue
        found = min(given, key=lambda x: abs(x - want))
        if abs(found - want) > ACCURACY * abs(want):
            return f"root {found:.12g}, exact {want:.12g}"
    return None

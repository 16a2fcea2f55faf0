# SPDX-License-Identifier: GPL-3.0-or-later
"""Ring-down against complex modes: a random mechanism with dampers, let go near its rest, moves in tones; each is a root of `modes --damped`.

Frequency and decay are read from the motion that `simulate` integrates, which has neither linearisation nor eigenproblem; the
start is small beside the model, since both depend on the amplitude's square.
"""
import copy
import math

SMALL = 1e-5       # of the model's size
SPREAD = 60        # of frequencies: steps follow the fastest, the length of the motion the slowest
MOST_MODES = 6     # tones of more modes are told apart by less
LEFT = 1e-4        # of a signal that tones leave over, beyond which they say nothing
STRONG = 0.05      # of the strongest; weaker tones are mixed with curvatures of the shapes
FREQUENCY = 1e-5   # relative
RATIO = 1e-5       # of a damping ratio
DAMPED = 0.3       # damping ratios beyond this are gone before a period is, and no tone
APART = 1.0        # beats of two tones in the motion, below which they are not told apart
PERIODS = 6        # of the slowest mode
SAMPLES = 10       # in a period of the fastest
MOST_SAMPLES = 3000
EXCUSES = ("dead centre", "no sensor moves in this mode")  # of a motion that has to be refused


def _size(model):
    """Of the bodies' places, where these are numbers."""
    flat = [x for b in model["bodies"] for x in b.get("centre", [0]) if isinstance(x, (int, float))]
    return max((abs(x) for x in flat), default=1.0) or 1.0


def prepare(rng, model, answer):
    """The model with dampers alone and sensors everywhere, how far it is moved, and how to let it go; None where motions are not asked."""
    modes = answer["modes"]
    hz = [m["frequency_hz"] for m in modes]
    if not hz or len(hz) > MOST_MODES or any(m["kind"] != "flexible" for m in modes) or not hz[0] or hz[-1] > SPREAD * hz[0]:
        return None
    if any(b.get("mass_kg") in (0, None) for b in model["bodies"]) or answer.get("massless_directions"):
        return None
    out = copy.deepcopy(model)
    out["dampers"] = []
    for spring in out.get("springs", []):
        own = {"stiffness_n_per_m": "damping_n_s_per_m", "stiffness_n_m_per_rad": "damping_n_m_s_per_rad"}
        values = {own[k]: v for k, v in spring.items() if k in own}
        plain = values and all(isinstance(v, (int, float, str)) for v in values.values())
        if spring["type"] not in ("axial", "torsion") or not plain or rng.random() < 0.3:
            continue
        factor = rng.uniform(0.02, 0.3) / (2 * math.pi * rng.choice(hz))
        out["dampers"].append({k: copy.deepcopy(v) for k, v in spring.items() if k in ("type", "bodies", "joint", "at", "in")}
                              | {"name": f"d_{spring['name']}"} | {k: f"abs({v})*{factor!r}" for k, v in values.items()})
    directions = ["x", "y", "z"][:out["dimension"]]
    out["sensors"] = [{"name": f"ring{i}", "on": b["name"], "directions": directions} for i, b in enumerate(out["bodies"])]
    period = 1 / hz[0]
    sample = max(1 / hz[-1] / SAMPLES, PERIODS * period / MOST_SAMPLES)
    start = SMALL * _size(model)
    return out, start, ["--start-mode", f"{rng.randint(1, len(hz))}:{start!r}", "--duration", repr(PERIODS * period), "--dt-out", repr(sample)]


def compare(motion, damped, start):
    """(tones compared, a sentence on the first that is no root, or None); start: how far it was moved."""
    roots = [(m["damped_frequency_hz"], m["damping_ratio_percent"] / 100) for m in damped["damped_modes"] if m["kind"] == "oscillating"]
    hz, lasts = sorted(f for f, _ in roots), motion["time_s"][-1]
    if any(ratio > DAMPED for _, ratio in roots) or any((b - a) * lasts < APART for a, b in zip(hz, hz[1:])):
        return 0, None
    most = max([start] + [r["tones"][0]["amplitude"] for r in motion["readings"] if r["tones"]])  # an overdamped mode has none
    count = 0
    for reading in motion["readings"]:
        if not reading["tones"] or reading["tones_residual"] > LEFT or reading["tones"][0]["amplitude"] < STRONG * most:
            continue
        strongest = max(t["amplitude"] for t in reading["tones"])
        for tone in reading["tones"]:
            if tone["amplitude"] < STRONG * strongest or abs(tone["damping_ratio"]) > DAMPED:
                continue
            count += 1
            if not any(abs(tone["frequency_hz"] / hz - 1) <= FREQUENCY and abs(tone["damping_ratio"] - ratio) <= RATIO for hz, ratio in roots):
                near = min(roots, key=lambda r: abs(tone["frequency_hz"] - r[0]), default=None)
                return count, f"{reading['port']} rings at {tone['frequency_hz']!r} Hz, ratio {tone['damping_ratio']!r}; the nearest root is {near}"
    return count, None

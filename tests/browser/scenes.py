# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene whose every place is known by closed form, a four-bar linkage, and a page around it without the program."""
import cmath
import json
import math
import os
import re
from pathlib import Path

SOURCE = Path(os.environ.get("SOURCE_DIR", Path(__file__).resolve().parents[2]))
PAGE = SOURCE / "src/report/page"
CRANK, COUPLER, ROCKER, GROUND = 0.15, 0.4, 0.3, 0.35  # lengths [m]
HOSTILE = "rocker <img src=x onerror=alert(1)>"
HANDS = {"crank": ("O", "A"), "coupler": ("A", "B"), HOSTILE: ("B", "D")}
DEAD = 17  # of the positions of the drive: there is none
BROKEN = "no position: joints A and B contradict each other"


def linkage(angle):
    """Where the four pivots are, as complex numbers, by the law of cosines."""
    a, d = cmath.rect(CRANK, angle), complex(GROUND)
    reach = abs(d - a)
    inner = math.acos((COUPLER**2 + reach**2 - ROCKER**2) / (2 * COUPLER * reach))
    return {"O": 0j, "A": a, "B": a + cmath.rect(COUPLER, cmath.phase(d - a) + inner), "D": d}


def place(z, up=0.0):
    return [z.real, z.imag, up]


def turn(angle):
    return [math.cos(angle), -math.sin(angle), 0, math.sin(angle), math.cos(angle), 0, 0, 0, 1]


def placed(pivots):
    """Mass centre and direction of each body."""
    return {name: ((pivots[p] + pivots[q]) / 2, cmath.phase(pivots[q] - pivots[p])) for name, (p, q) in HANDS.items()}


def poses(angle, drawn):
    """The bodies at another angle, from where they are drawn: the ground first."""
    now, before = placed(linkage(angle)), placed(linkage(drawn))
    return [[0, 0, 0] + turn(0)] + [place(now[name][0]) + turn(now[name][1] - before[name][1]) for name in HANDS]


def swing(angle, step=1e-6):
    """The mode of the mechanism itself, by central differences: largest displacement 1."""
    above, below = placed(linkage(angle + step)), placed(linkage(angle - step))
    motion = [[0.0] * 6]
    for name in HANDS:
        v = (above[name][0] - below[name][0]) / (2 * step)
        motion.append([v.real, v.imag, 0, 0, 0, (above[name][1] - below[name][1]) / (2 * step)])
    pivots = [abs((linkage(angle + step)[p] - linkage(angle - step)[p]) / (2 * step)) for p in "AB"]
    return [[x / max(pivots) for x in row] for row in motion]


def ellipsoid(p, q, width):
    e = (q - p) / abs(q - p)
    return {"radii": [0.55 * abs(q - p), 1.4 * width, width],
            "axes": [[e.real, e.imag, 0], [0, 0, 1], [e.imag, -e.real, 0]]}


def mode(index, hz, motion, springs, name=None, note=None):
    return {"mode": index, "hz": hz, "name": name, "note": note, "motion": motion,
            "energy": {"springs": springs, "bodies": [0, 0.2, 0.5, 0.3]}}


def configuration(name, angle, factor, free=False):
    at = linkage(angle)
    o, a, b, d = (at[p] for p in "OABD")
    tip = b + 0.5 * (b - a)
    out = [[0] * 6, [0, 0, 0.3, 1.2, 0.5, 0], [0, 0, 0.8, 0.3, 1, 0], [0, 0, 0.2, 0.4, -0.5, 0]]
    bodies = [{"name": "ground", "kind": "ground", "mass": 0, "at": [0, 0, 0], "ellipsoid": None}]
    lines = []
    for i, (body, (p, q)) in enumerate(HANDS.items(), 1):
        centre = place((at[p] + at[q]) / 2)
        bodies.append({"name": body, "kind": "body", "mass": 1.0 + 0.5 * i, "at": centre,
                       "ellipsoid": ellipsoid(at[p], at[q], 0.02)})
        lines += [{"body": i, "from": centre, "to": place(at[end])} for end in (p, q)]
    lines.append({"body": 2, "from": place((a + b) / 2), "to": place(tip)})
    joint = [("O", o, [0, 1], 0), ("A", a, [1, 2], 0), ("B", b, [2, 3], 0.001), ("D", d, [3, 0], 0.2 if free else 0)]
    types = ["revolute", "revolute", "spherical" if free else "revolute", "universal" if free else "revolute"]
    modes = [mode(1, round(math.pi * factor, 8), swing(angle), [0.7, 0.25, 0.05], name="swing"),
             mode(2, round(12.3456789 * factor, 7), out, [0.1, 0.2, 0.7]),
             mode(3, round(45.678 / factor, 7), out, [0.05, 0.55, 0.4])]
    if free:
        modes = [mode(0, 0, swing(angle), [0, 0, 0], note="rigid-body"), mode(0, None, out, [0, 0, 0], note="unstable"),
                 mode(1, 20.5 * factor, out, [0.2, 0.3, 0.5])]
    positions = [{"at": angle - 0.5 + 0.1 * i, "poses": poses(angle - 0.5 + 0.1 * i, angle),
                  "hz": [3 + 0.1 * i * factor, 12 + math.sin(0.3 * i), 45 - i], "error": None} for i in range(19)]
    positions[DEAD].update(poses=None, hz=[], error="crank is at its dead centre")
    drive = {"joint": "O", "unit": "rad", "at": angle, "error": None, "positions": positions}
    return {"name": name, "error": None, "bodies": bodies, "lines": lines,
            "points": [{"name": "tip", "body": 2, "at": place(tip)}],
            "joints": [{"name": n, "type": t, "bodies": pair, "at": place(z), "axis": [0, 0, 1], "distance": off,
                        "far": bodies[max(pair)]["name"] if off else None} for (n, z, pair, off), t in zip(joint, types)],
            "springs": [{"name": "K_T1", "type": "torsion", "bodies": [0, 1], "from": place(o), "to": place(o),
                         "axis": [0, 0, 1], "stiffness": 120.0},
                        {"name": "K_axial", "type": "axial", "bodies": [0, 2], "from": [0.05, 0.5, 0],
                         "to": place((a + b) / 2), "axis": None, "stiffness": 8e3},
                        {"name": "K_bush", "type": "bushing", "bodies": [3, 0], "from": place(d + 0.12),
                         "to": place(d + 0.12), "axis": None, "stiffness": None}],
            "dampers": [{"name": "c", "type": "axial", "bodies": [0, 3], "from": [0.6, 0.1, 0], "to": place((b + d) / 2),
                         "axis": None, "damping": 12.0}],
            "sensors": [{"name": "tip.y", "body": 2, "at": place(tip), "axis": [0, 1, 0]}],
            "loads": [{"name": "weight", "body": 2, "at": place(tip), "axis": [0, -20, 0]}],
            "rotors": [{"name": "main", "body": 0, "at": [0, 0, 0], "axis": [0, 0, 1]}] if free else [],
            "modes": modes, "drive": None if free else drive}


def scene(designs=2):
    """The linkage, as drawn and with other springs: a driven one, a free one in space, one that cannot be assembled."""
    made = []
    for rank in range(designs):
        factor = 1 + 0.3 * rank
        broken = configuration("broken", 1.1, factor)
        broken.update(error=BROKEN, joints=[], springs=[], dampers=[], sensors=[], loads=[], modes=[], drive=None)
        made.append({"label": "original" if rank == 0 else f"recommended, rank {rank}", "rank": rank,
                     "parameters": [{"name": "k1", "value": 120 * factor, "unit": "N*m/rad"},
                                    {"name": "crank", "value": CRANK, "unit": None}],
                     "configurations": [configuration("installed", 1.1, factor), configuration("free", 1.6, factor, True),
                                        broken]})
    joints = [{"configuration": c["name"], "joint": j["name"], "type": j["type"], "body": j["far"],
               "distance": j["distance"]} for c in made[0]["configurations"] for j in c["joints"]]
    return {"format": "modetune-scene/1", "model": "Four-bar </script><script>alert(1)</script>", "dimension": 2,
            "size": 0.9, "gravity": [0, -9.81, 0], "designs": made, "joints": sorted(joints, key=lambda j: -j["distance"])}


def files_of(name):
    """The files of a list in heads.cmake, in its order."""
    text = (PAGE / "heads.cmake").read_text(encoding="utf-8")
    return [PAGE / file for file in re.search(r"^set\(" + name + r"\s([^)]*)\)", text, re.M).group(1).split()]


def page(data):
    """A page of a scene as the program makes it, but for the policy."""
    style, script = ("\n".join(f.read_text(encoding="utf-8") for f in files_of(name)) for name in ("show_styles", "show_scripts"))
    block = json.dumps(data).replace("<", "\\u003c")
    return (f'<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><link rel="icon" href="data:,">'
            f'<meta name="viewport" content="width=device-width, initial-scale=1"><style>{style}</style></head>'
            f'<body><main><h1>Linkage</h1></main><script type="application/json" id="scene">{block}</script>'
            f'<script>{script}</script></body></html>')

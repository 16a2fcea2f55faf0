#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a file says once and means several times. `like` with every override: a random chain of configurations against the same ones written out in
full. `repeat` and `include`: repeats.py.

The command line is that of every campaign (tests/support/campaign.py).
"""
import copy
import json
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import campaign  # noqa: E402
import repeats  # noqa: E402

WHOLE = ("gravity_m_per_s2", "drive", "damping")  # members that an override replaces as a whole
COMMANDS = (("modes", "--damped", "--count", "all"), ("info",), ("response", "--input", "s2.x", "--from", "0.5", "--to", "30", "--points", "5"))


def base(rng):
    """Three bars in a row on a driven pivot, and items that some configurations have."""
    names = ["b0", "b1", "b2"]
    joints = [{"name": f"j{i}", "type": "revolute", "bodies": [["ground", *names][i], names[i]], "at": [0.3 * i, 0]} for i in range(3)]
    return {
        "format": "modetune-model/1", "dimension": 2,
        "parameters": {"k": rng.uniform(20, 200), "m": rng.uniform(0.3, 3), "c": rng.uniform(0.001, 0.02), "p": rng.uniform(-0.2, 0.2), "g": 9.81},
        "gravity_m_per_s2": [0, "-g"],
        "bodies": [{"name": n, "mass_kg": "m" if i == 2 else rng.uniform(0.3, 2), "inertia_kg_m2": rng.uniform(0.01, 0.03), "centre": [0.3 * i + 0.15, 0]}
                   for i, n in enumerate(names)],
        "joints": joints,
        "springs": [{"name": f"s{i}", "type": "torsion", "joint": f"j{i}", "stiffness_n_m_per_rad": "k" if i else rng.uniform(20, 200)} for i in range(3)],
        "dampers": [{"name": "d", "type": "torsion", "joint": "j1", "damping_n_m_s_per_rad": "c"}],
        "sensors": [{"name": "s2", "on": "b2", "directions": ["x", "y"]}],
    }


def override(rng, member):
    """Another value of a member of a configuration."""
    if member == "parameters":
        return {name: rng.choice([rng.uniform(0.01, 0.02), "2*0.01"]) if name == "c" else rng.uniform(0.5, 1.5) * {"k": 90, "m": 1, "p": 0.1, "g": 9.8}[name]
                for name in rng.sample(["k", "m", "c", "p", "g"], rng.randint(1, 3))}
    if member == "gravity_m_per_s2":
        return rng.choice([[0, 0], ["g", 0], [0, rng.uniform(-12, -2)]])
    if member == "drive":
        return {"joint": "j0", "position_rad": rng.choice(["p", 0, rng.uniform(-0.3, 0.3)]), "hold": rng.choice(["lock", {"trim": "s0"}])}
    return rng.choice([{"ratio": rng.uniform(0, 0.1)}, {"ratios": [0.01, rng.uniform(0, 0.1)]}, {"stiffness_s": rng.uniform(0, 1e-3)},
                       {"mass_per_s": rng.uniform(0, 0.1), "ratio": 0.01}])


def case(rng):
    """(with `like`, written out): the same names."""
    model = base(rng)
    names = rng.sample(["rest", "fwd", "aft", "corner"], rng.randint(2, 4))
    like, full, parents = {}, {}, {}
    for i, name in enumerate(names):
        own = {m: override(rng, m) for m in ("parameters", *WHOLE) if rng.random() < 0.45}
        parents[name] = rng.choice(names[:i]) if i else None
        above = full[parents[name]] if i else {}
        full[name] = copy.deepcopy({**above, **own})
        if "parameters" in own or "parameters" in above:
            full[name]["parameters"] = {**above.get("parameters", {}), **own.get("parameters", {})}
        like[name] = {**({"like": parents[name]} if i else {}), **own}
    extra = [{"name": "e0", "type": "torsion", "joint": "j2", "stiffness_n_m_per_rad": rng.uniform(10, 100)},
             {"name": "e1", "type": "axial", "bodies": ["ground", "b2"], "at": [[0.9, 0.5], [0.75, 0]], "stiffness_n_per_m": rng.uniform(50, 500)}]
    out = copy.deepcopy(model)
    model["springs"], out["springs"] = model["springs"] + copy.deepcopy(extra), out["springs"] + extra
    for i in (-2, -1):
        named = set(rng.sample(names, rng.randint(1, len(names))))
        model["springs"][i]["in"] = sorted(named)
        has = set(named)
        for name in names:  # parents come before
            has |= {name} if parents[name] in has else set()
        out["springs"][i]["in"] = [n for n in names if n in has]
    order = rng.sample(names, len(names))  # what is like another may stand before it
    return {**model, "configurations": {n: like[n] for n in order}}, {**out, "configurations": {n: full[n] for n in order}}


def answers(folder, model):
    """What every command says of it, without its warnings' places."""
    path = folder / "model.json"
    path.write_text(json.dumps(model, indent=1), encoding="utf-8")
    said = []
    for command, *more in COMMANDS:
        one = []
        for name in model["configurations"]:
            done = subprocess.run([campaign.PROGRAM, command, str(path), "-c", name, "--format", "json", "--quiet", *more], capture_output=True, encoding="utf-8",
                                  timeout=60, check=False)
            one.append((name, done.returncode, json.loads(done.stdout) if done.returncode == 0 else done.stderr))
        said.append(one)
    return said


def without_places(x):
    if isinstance(x, dict):
        if "doubts" in x:  # what an own damping drops is told, and is judged by itself
            x = {**x, "doubts": [d for d in x["doubts"] if d["kind"] != "dropped"]}
        return {k: without_places(v) for k, v in x.items() if k not in ("pointer", "line", "column", "sha256", "like")}
    return [without_places(v) for v in x] if isinstance(x, list) else x


def drops(like, full, name):
    """Does the configuration's own damping leave out what it would inherit?"""
    above = full["configurations"][like["configurations"][name]["like"]] if "like" in like["configurations"][name] else {}
    own = like["configurations"][name].get("damping")
    return own is not None and bool(set(above.get("damping", {})) - set(own))


class Likes(campaign.Generator):
    script, cases = "tests/hunt/likes.py", "models"
    kinds = ("like", "repeat")

    def make(self, seed, kind, index):
        rng = campaign.draw(seed, kind, index)
        if kind == "repeat":
            return campaign.Case(kind, repeats.case(rng), rng)
        like, full = case(rng)
        return campaign.Case(kind, {"like": like, "full": full}, rng)

    def judge(self, case, folder, tally):
        if case.kind == "repeat":
            yield from repeats.judge(case.document, folder)
            return
        like, full = case.document["like"], case.document["full"]
        for command, a, b in zip(COMMANDS, answers(folder, like), answers(folder, full)):
            for (name, code, one), (_, other_code, other) in zip(a, b):
                if code != other_code:
                    yield command[0], f"of {name}: exit code {code}, written out {other_code}: {one if code else other}"
                elif code == 0 and without_places(one) != without_places(other):
                    yield command[0], f"of {name} differs from what is written out"
                elif code == 0 and isinstance(one, list) and any(d["kind"] == "dropped" for d in one[0]["doubts"]) != drops(like, full, name):
                    yield command[0], f"of {name}: what its damping drops is {'not ' if drops(like, full, name) else ''}to be told"
                elif code not in (0, 2, 3):
                    yield command[0], f"of {name}: exit code {code}: {one}"

    def smaller(self, document):
        """Nodes go that both have."""
        if "alone" in document:
            yield from super().smaller(document)
            return
        like, full = document["like"], document["full"]
        common = {path for path, _, _ in campaign.nodes(full)}
        for path in sorted((p for p, _, _ in campaign.nodes(like) if p in common), key=len):
            yield {"like": campaign.without(like, path), "full": campaign.without(full, path)}


if __name__ == "__main__":
    sys.exit(campaign.main(Likes()))

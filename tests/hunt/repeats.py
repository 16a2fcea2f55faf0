# SPDX-License-Identifier: GPL-3.0-or-later
"""`repeat` and `include`: what stands turned, moved or mirrored beside itself vibrates as it does alone.

A random mechanism on the ground, without gravity, has some eigenvalues. With copies of all of it, it has each of them once more for every copy,
and so it has alone as part of another model, in other units, at another place. A hub with arms is the same whether the arms are repeats of one or
included several times with the hub for their ground."""
import json
import math
import subprocess

import campaign

NUMBERS = 1e-12  # of the largest eigenvalue: copies are computed apart from what they copy
LOADED = 1e-8    # where Newton's method has found the equilibrium, one that is stable


def vector(rng, dimension, size=1.0):
    return [rng.uniform(-size, size) for _ in range(dimension)]


def expressions(rng, values, text=lambda v: f"{v!r}*p"):
    """Some of the numbers as expressions of the parameter p, which is 1."""
    return [text(v) if rng.random() < 0.3 else v for v in values]


def direction(rng, dimension):
    if rng.random() < 0.3:
        return [1.0 if k == rng.randrange(dimension) else 0.0 for k in range(dimension - 1)] + [1.0]
    return vector(rng, dimension)


def inertia(rng, dimension):
    if dimension == 2:
        return rng.uniform(0.01, 0.1)
    a, b, c = (rng.uniform(0.01, 0.05) for _ in range(3))
    return [b + c, a + c, a + b, *rng.choice([[], [0.003, -0.002, 0.001]])]


def mechanism(rng, dimension):
    """Two bodies one behind the other on the ground, held by springs of all types, and perhaps a beam."""
    three = dimension == 3
    bodies, joints, springs, loads, dampers = [], [], [], [], []
    before, at = "ground", vector(rng, dimension)
    for i in range(2):
        far = [x + d for x, d in zip(at, vector(rng, dimension, 0.5))]
        body = f"b{i}"
        bodies.append({"name": body, "mass_kg": rng.uniform(0.5, 3), "inertia_kg_m2": inertia(rng, dimension), "centre": expressions(rng, far)})
        kind = rng.choice(["revolute", "prismatic", "fixed", "free", *(["cylindrical", "spherical", "universal"] if three else [])])
        joint = {"name": f"j{i}", "type": kind, "bodies": [before, body], "at": expressions(rng, at)}
        if kind in ("prismatic", "cylindrical") or (three and kind == "revolute"):
            joint["axis"] = direction(rng, dimension)
        if kind == "universal":
            joint["axis"], joint["axis_b"] = [1, 0.5, 0], [-0.5, 1, 0]
        if kind != "free":
            joints.append(joint)
        if kind in ("revolute", "cylindrical"):
            springs.append({"name": f"t{i}", "type": "torsion", "joint": f"j{i}", "stiffness_n_m_per_rad": rng.uniform(100, 300),
                            **rng.choice([{}, {"free_angle_rad": rng.uniform(-0.1, 0.1)}, {"preload_n_m": rng.uniform(-5, 5)}])})
            if rng.random() < 0.3:
                loads.append({"name": f"m{i}", "joint": f"j{i}", "moment_n_m": rng.uniform(-5, 5)})
        if kind in ("prismatic", "cylindrical"):
            springs.append({"name": f"x{i}", "type": "axial", "joint": f"j{i}", "stiffness_n_per_m": rng.uniform(500, 5000), **rng.choice([{}, {"preload_n": 20}])})
            if rng.random() < 0.3:
                loads.append({"name": f"f{i}", "joint": f"j{i}", "force_n": rng.uniform(-20, 20)})
        before, at = body, far
    end = [x + d for x, d in zip(at, vector(rng, dimension, 0.2))]
    springs.append({"name": "bush", "type": "bushing", "bodies": ["ground", "b1"], "at": "end", "stiffness_n_per_m": [rng.uniform(500, 5000) for _ in range(dimension)],
                    "stiffness_n_m_per_rad": [rng.uniform(50, 500) for _ in range(3)] if three else rng.uniform(50, 500)})
    springs.append({"name": "line", "type": "axial", "bodies": ["ground", "b0"], "at": ["near", bodies[0]["centre"]], "stiffness_n_per_m": "500*p"})
    if three and rng.random() < 0.3:
        K = [[0.0] * 6 for _ in range(6)]
        for _ in range(8):
            v = vector(rng, 6)
            for i in range(6):
                for k in range(6):
                    K[i][k] += 100 * v[i] * v[k]
        springs.append({"name": "full", "type": "bushing", "bodies": ["ground", "b1"], "at": "end", "stiffness_matrix": K})
    dampers.append({"name": "d", "type": "bushing", "bodies": ["ground", "b1"], "at": "end", "damping_n_s_per_m": [3.0] * dimension,
                    "damping_n_m_s_per_rad": [0.2] * 3 if three else 0.2})
    if rng.random() < 0.4:
        loads.append({"name": "w", "on": "b1", "force_n": vector(rng, dimension, 20.0)})
    model = {"format": "modetune-model/1", "dimension": dimension, "parameters": {"p": 1, "angle": 0.7},
             "points": {"end": expressions(rng, end), "near": vector(rng, dimension), "middle": vector(rng, dimension)},
             "bodies": bodies, "joints": joints, "springs": springs, "dampers": dampers, "loads": loads}
    if rng.random() < 0.3:  # a beam from the ground
        tip = [0.0] * dimension
        tip[0] = 0.5
        model["links"] = [{"name": "l", "kind": rng.choice(["beam", "rigid_elements"]), "from": "near", "to": [a + b for a, b in zip(model["points"]["near"], tip)],
                           "elements": 3, "mass_kg": 0.5, "youngs_modulus_pa": 7e10, "shear_modulus_pa": 2.6e10,
                           "section": {"shape": "rectangle", "width_m": 0.02, "height_m": 0.01}, **({"hinge_axis": [0, 0.6, 0.8]} if three else {})}]
        model["joints"].append({"name": "root", "type": "fixed", "bodies": ["ground", "l.start"], "at": "near"})
        if model["links"][0]["kind"] == "rigid_elements":
            del model["links"][0]["shear_modulus_pa"]
            model["springs"].append({"name": "h", "type": "torsion", "joint": "l.h1", "stiffness_n_m_per_rad": 5, "free_angle_rad": 0.02})
    return model


def motion(rng, dimension, angles=("angle",)):
    """A repeat, and how many there are then for each."""
    about = rng.choice([{}, {"about": "middle"}, {"about": expressions(rng, vector(rng, dimension))}])
    kind = rng.choice(["polar", "mirror", "linear"])
    if kind == "linear":
        n = rng.randint(2, 4)
        return {"linear": {"step": expressions(rng, vector(rng, dimension))}, "count": n}, n
    if kind == "polar":
        n = rng.randint(2, 4)
        axis = {"axis": direction(rng, 3)} if dimension == 3 else {}
        angle = rng.choice([{}, *({"angle_rad": a} for a in angles), {"angle_rad": "90*deg"}, {"angle_rad": rng.uniform(-2, 2)}])
        return {"polar": {**axis, **about, **angle}, "count": n}, n
    normal = direction(rng, 3) if dimension == 3 else [*vector(rng, 2), 0]
    plane = rng.choice([{"plane": rng.choice(["xz", "yz"])}, {"normal": normal}])
    return {"mirror": {**plane, **about}}, 2


def turn(rng, dimension):
    return {"at": vector(rng, dimension), "rotate": {**({"axis": direction(rng, 3)} if dimension == 3 else {}), "angle_rad": rng.choice(["spin", "90*deg", rng.uniform(-3, 3)])}}


def without_dampers(model):
    """Dampers of different numbers along their axes cannot be turned: these are alike, but in the plane bushings of springs cannot either."""
    if model["dimension"] == 2:
        for s in model["springs"]:
            if s["type"] == "bushing":
                s["stiffness_n_per_m"] = [s["stiffness_n_per_m"][0]] * 2
    return model


def case(rng):
    dimension = rng.choice([2, 3, 3])
    alone = without_dampers(mechanism(rng, dimension))
    if rng.random() < 0.35:
        sub = json.loads(json.dumps(alone).replace('"angle": 0.7', '"angle": 0.3'))
        times = rng.randint(1, 3)
        host = {"format": "modetune-model/1", "dimension": dimension, "units": {"length": "mm"}, "parameters": {"spin": 0.4, "one": 1},
                "include": [{"file": "alone.json", "prefix": f"s{i}_", **turn(rng, dimension), "parameters": {"p": rng.choice([1, "one"])}} for i in range(times)]}
        for one in host["include"]:
            one["at"] = [1000 * x for x in one["at"]]
        return {"alone": sub, "model": host, "times": times}
    model = json.loads(json.dumps(alone))
    model["repeat"], times = [], 1
    repeats = rng.randint(1, 2)
    for i in range(repeats):
        what, n = motion(rng, dimension, ("angle",) if repeats == 1 else ())  # the expression of a tensor turned twice would be too long
        model["repeat"].append({"of": ["*"], **what, "suffix": f"_{'ab'[i]}"})
        times *= n
    return {"alone": alone, "model": model, "times": times}


def eigenvalues(path):
    done = subprocess.run([campaign.PROGRAM, "modes", str(path), "--count", "all", "--format", "csv", "--quiet"], capture_output=True, encoding="utf-8", timeout=60, check=False)
    if done.returncode != 0:
        return None, done.stderr
    rows = [line.split(",") for line in done.stdout.splitlines()]
    at = rows[0].index("omega_squared_rad2_per_s2")
    return sorted(float(row[at]) for row in rows[1:]), ""


def judge(document, folder):
    for name in ("alone", "model"):
        (folder / f"{name}.json").write_text(json.dumps(document[name], indent=1), encoding="utf-8")
    one, why = eigenvalues(folder / "alone.json")
    if one is None:
        raise campaign.LeftOut(" ".join(why.split()[-6:]))
    if not one:
        raise campaign.LeftOut("without modes")
    loaded = document["alone"]["loads"] or any("reload" in k or k.startswith("free") for s in document["alone"]["springs"] for k in s)
    if loaded and min(one) < 1e-3 * max(one):
        raise campaign.LeftOut("equilibrium badly determined")
    many, why = eigenvalues(folder / "model.json")
    if many is None:
        yield "repeat", f"alone it has modes, with its copies it has not: {why}"
        return
    wanted = sorted(x for x in one for _ in range(document["times"]))
    allowed = (LOADED if loaded else NUMBERS) * max(map(abs, one))
    if len(many) != len(wanted):
        yield "repeat", f"{len(many)} modes, not {len(wanted)}"
    elif not all(math.isclose(a, b, rel_tol=0, abs_tol=allowed) for a, b in zip(many, wanted)):
        worst = max(zip(many, wanted), key=lambda p: abs(p[0] - p[1]))
        yield "repeat", f"an eigenvalue {worst[0]!r}, alone {worst[1]!r} (the largest {max(one)!r})"

# SPDX-License-Identifier: GPL-3.0-or-later
"""Models at the limits of sixteen digits, each family along one of its ways to them. A maker takes a source of chance and how far to go (0: hardly, 1: to the limit)."""
import math
import random

from changes import rescale
import hanging
from families import four_bar
from makers import KINDS, Maker

FAMILIES = {}


def family(name):
    def put(maker):
        FAMILIES[name] = maker
        return maker
    return put


def plain(dim, bodies=(), joints=(), springs=(), **more):
    return {"format": "modetune-model/1", "name": "Stress", "dimension": dim, "bodies": list(bodies), "joints": list(joints), "springs": list(springs), **more}


def point(name, mass, at):
    return {"name": name, "mass_kg": mass, "centre": at}


def solid(name, mass, inertia, at):
    return {"name": name, "mass_kg": mass, "inertia_kg_m2": inertia, "centre": at}


def joint(name, kind, a, b, at, **more):
    return {"name": name, "type": kind, "bodies": [a, b], "at": at, **more}


def axial(name, a, b, at, k, **more):
    return {"name": name, "type": "axial", "bodies": [a, b], "at": at, "stiffness_n_per_m": k, **more}


def torsion(name, on, k, **more):
    return {"name": name, "type": "torsion", "joint": on, "stiffness_n_m_per_rad": k, **more}


def decades(rng, low, high):
    """Evenly over the decades, three digits."""
    return float(f"{10 ** rng.uniform(math.log10(low), math.log10(high)):.3g}")


# stiffnesses and masses far apart -----------------------------------------------------------------------------------------------------------------------
def _network(rng, stiffness, masses, loops=True):
    m = Maker(rng, rng.choice([2, 2, 3]), decades=stiffness, masses=masses)
    m.tree(rng.randint(1, 4 if m.dim == 2 else 3))
    m.springs(rng.randint(2, 6))
    if loops and m.chance(0.3):
        m.loops(1)
    if m.chance(0.5):
        m.stand()
    return m.done()


@family("stiffnesses 1:1e12")
def stiffnesses(rng, far):
    return _network(rng, 1 + 3 * far, 1.0)


@family("masses 1:1e9")
def masses(rng, far):
    return _network(rng, 1.0, 1 + 3.5 * far)


@family("both")
def both(rng, far):
    return _network(rng, 1 + 3 * far, 1 + 3.5 * far)


@family("redundant springs")
def crossed(rng, far):
    """Point masses that many springs tie to each other, stiffnesses and masses far apart: more springs than freedoms."""
    n, dim = rng.randint(2, 4), rng.choice([2, 3])
    spot = lambda: [rng.randint(-16, 16) / 16 for _ in range(dim)]
    at = {"ground": [2.0] * dim}
    for i in range(n):
        at[f"b{i}"] = spot()
        while list(at.values()).count(at[f"b{i}"]) > 1:
            at[f"b{i}"] = spot()
    springs, names = [], list(at)
    for i, a in enumerate(names):
        for b in names[i + 1:]:
            springs.append(axial(f"s{len(springs)}", a, b, [at[a], at[b]], decades(rng, 1, 10 ** (12 * far) + 1)))
    for b in names[1:]:
        foot = spot()
        if foot != at[b]:
            springs.append(axial(f"s{len(springs)}", "ground", b, [foot, at[b]], decades(rng, 1, 10 ** (12 * far) + 1)))
    return plain(dim, [point(b, decades(rng, 1e-3, 1e3), at[b]) for b in names[1:]], [], springs)


@family("long chains")
def chain(rng, far):
    """Point masses in a row, from wall to end, sliding: judged by Sturm's count (run.py)."""
    n = rng.randint(20, 60)
    k = [decades(rng, 1, 10 ** (12 * far) + 1) for _ in range(n)]
    m = [decades(rng, 1, 10 ** (rng.choice([0, 9]) * far) + 1) for _ in range(n)]
    name = lambda i: f"b{i}" if i else "ground"
    return plain(2, [point(name(i + 1), m[i], [float(i + 1), 0.0]) for i in range(n)],
                 [joint(f"g{i}", "pin-in-slot", "ground", name(i + 1), [float(i + 1), 0.0], axis=[1, 0]) for i in range(n)],
                 [axial(f"s{i}", name(i), name(i + 1), [[float(i), 0.0], [float(i + 1), 0.0]], k[i]) for i in range(n)])


@family("large trees")
def tree(rng, far):
    """The same with each mass sliding on the one before: a tree, of which the program finds the lowest modes without the others."""
    n = rng.randint(100, 160)
    k = [decades(rng, 1, 10 ** (rng.choice([0, 12]) * far) + 1) for _ in range(n)]
    m = [decades(rng, 1, 10 ** (rng.choice([0, 9]) * far) + 1) for _ in range(n)]
    name = lambda i: f"b{i}" if i else "ground"
    at = lambda i: [float(i), 0.0]
    return plain(2, [solid(name(i + 1), m[i], m[i], at(i + 1)) for i in range(n)],
                 [joint(f"g{i}", "prismatic", name(i), name(i + 1), at(i + 1), axis=[1, 0]) for i in range(n)],
                 [axial(f"s{i}", name(i), name(i + 1), [at(i), at(i + 1)], k[i]) for i in range(n)])


@family("large stars")
def star(rng, far):
    """Many arms on a hub, in groups of equal ones or of such that differ by a gap."""
    n, group, gap = rng.randint(100, 120), rng.choice([1, 3, 7, 20, 200]), rng.choice([0.0, 10.0 ** -(2 + 12 * far)])
    m, k = rng.randint(1, 9) / 4, float(rng.randint(100, 999))
    hub = decades(rng, 1, 100)
    slide = lambda a, b, at: joint(f"g{b}", "prismatic", a, b, at, axis=[1, 0])
    arms = [f"b{i}" for i in range(n)]
    return plain(2, [solid("hub", hub, hub, [0.0, 0.0])] + [solid(b, m, m, [1.0, 0.0]) for b in arms],
                 [slide("ground", "hub", [0.0, 0.0])] + [slide("hub", b, [1.0, 0.0]) for b in arms],
                 [axial("w", "ground", "hub", [[-1.0, 0.0], [0.0, 0.0]], decades(rng, 1, 1e6))]
                 + [axial(f"s{i}", "hub", b, [[0.0, 0.0], [1.0, 0.0]], k * (1 + (i // group) * 2.0 ** -6) * (1 + (i % group) * gap)) for i, b in enumerate(arms)])


FAMILIES.update({"hanging chains": hanging.chain, "hanging stacks": hanging.stack, "hanging swings": hanging.swing})


# geometry ----------------------------------------------------------------------------------------------------------------------------------------------------
def _small(far):
    """1e-1 to 1e-7, one digit and a power of two's worth of it."""
    return 2.0 ** -round(3 + 20 * far)


@family("near dead centres")
def dead_centres(rng, far):
    e, kind = _small(far), rng.choice(["slider", "four-bar", "ropes", "toggle"])
    a, b = rng.randint(1, 4) / 4, rng.randint(5, 8) / 4
    bar = lambda name, p, q: solid(name, rng.randint(1, 9) / 4, rng.randint(1, 9) / 64, [(x + y) / 2 for x, y in zip(p, q)])
    if kind == "slider":  # crank and rod almost in line, held by the slider's spring alone
        o, p = [0.0, 0.0], [a, e]
        q = [a + b, 0.0]
        return plain(2, [bar("crank", o, p), bar("rod", p, q), solid("slider", 1.0, 0.125, q)],
                     [joint("j0", "revolute", "ground", "crank", o), joint("j1", "revolute", "crank", "rod", p), joint("j2", "revolute", "rod", "slider", q),
                      joint("j3", "prismatic", "ground", "slider", q, axis=[1, 0])],
                     [axial("s", "ground", "slider", [[a + b + 1, 0.0], q], decades(rng, 1e2, 1e6))])
    if kind == "four-bar":  # near its change point: all four pins almost in line
        c = rng.randint(1, 3) / 4
        o, p, q, r = [0.0, 0.0], [a, e], [a + b, rng.choice([-1, 2, 3]) * e], [a + b + c, 0.0]
        springs = [torsion("s0", "j0", decades(rng, 10, 1e3))] + ([torsion("s3", "j3", decades(rng, 10, 1e3))] if rng.random() < 0.5 else [])
        return plain(2, [bar("crank", o, p), bar("rod", p, q), bar("rocker", q, r)],
                     [joint("j0", "revolute", "ground", "crank", o), joint("j1", "revolute", "crank", "rod", p), joint("j2", "revolute", "rod", "rocker", q),
                      joint("j3", "revolute", "rocker", "ground", r)], springs)
    if kind == "ropes":  # a bead between two ropes that are almost in line turns about it
        at = [0.0, e, 0.0]
        return plain(3, [point("b", rng.randint(1, 9) / 4, at)],
                     [joint("j0", "distance", "ground", "b", [[-a, 0.0, 0.0], at]), joint("j1", "distance", "ground", "b", [[b, 0.0, 0.0], at])],
                     [axial("s", "ground", "b", [[0.0, e, 1.0], at], decades(rng, 1e2, 1e6))])
    o, p, q = [0.0, 0.0], [a, e], [a + b, 0.0]  # two struts on springs, and a soft one across
    return plain(2, [point("knee", 1.0, p), point("end", 2.0, q)],
                 [joint("j", "distance", "knee", "end", [p, q]), joint("g", "pin-in-slot", "ground", "end", q, axis=[1, 0])],
                 [axial("s0", "ground", "knee", [o, p], decades(rng, 1e4, 1e6)), axial("s1", "ground", "end", [[a + b + 1, 0.0], q], decades(rng, 1e2, 1e6))])


@family("nearly redundant joints")
def nearly_redundant(rng, far):
    e, kind = 2.0 ** -round(3 + 17 * far), rng.choice(["cranks", "hinges", "ropes"])
    if kind == "cranks":  # a third crank of another length stops the parallelogram; what hangs on it moves
        feet = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]
        tips = [[0.5, 0.75], [1.5, 0.75], [2.5, 0.75 + e]]
        coupler = solid("coupler", 2.0, 0.5, [1.5, 0.75])
        tail = solid("tail", decades(rng, 0.1, 10), decades(rng, 0.01, 1), [3.0, 1.0])
        return plain(2, [coupler, tail],
                     [{"name": f"j{i}", "type": "distance", "bodies": ["ground", "coupler"], "at": [f, t]} for i, (f, t) in enumerate(zip(feet, tips))]
                     + [joint("t", "revolute", "coupler", "tail", [2.5, 1.0])], [torsion("s", "t", decades(rng, 10, 1e3))])
    if kind == "hinges":  # two hinges whose axes hardly differ
        return plain(3, [solid("door", 2.0, [0.5, 0.75, 1.0], [0.5, 0.0, 0.0]), solid("tail", 1.0, [0.125, 0.25, 0.25], [1.0, 0.5, 0.0])],
                     [joint("h0", "revolute", "ground", "door", [0.0, 0.0, 0.0], axis=[0, 0, 1]), joint("h1", "revolute", "ground", "door", [0.0, 0.0, 1.0], axis=[e, 0, 1]),
                      joint("t", "spherical", "door", "tail", [1.0, 0.0, 0.0])],
                     [{"name": "s", "type": "bushing", "bodies": ["door", "tail"], "at": [1.0, 0.0, 0.0], "stiffness_n_per_m": [1, 1, 1],
                       "stiffness_n_m_per_rad": [decades(rng, 10, 1e3) for _ in range(3)]}])
    at = [rng.randint(4, 12) / 16, rng.randint(4, 12) / 16, rng.randint(4, 12) / 16]  # two ropes almost parallel leave a circle
    return plain(3, [point("b", rng.randint(1, 9) / 4, at)],
                 [joint("j0", "distance", "ground", "b", [[0.0, 0.0, 0.0], at]), joint("j1", "distance", "ground", "b", [[e, 0.0, 0.0], at])],
                 [axial("s0", "ground", "b", [[2.0, 0.0, 0.0], at], decades(rng, 1e2, 1e6)), axial("s1", "ground", "b", [[0.0, 0.0, 2.0], at], decades(rng, 1e2, 1e6))])


# close and equal frequencies ---------------------------------------------------------------------------------------------------------------------------------
@family("clusters")
def clusters(rng, far):
    """Up to eight equal arms on one body: as many equal modes but one, which are split by relative gaps of 1e-2 to 1e-14, or not at all."""
    gap = rng.choice([0.0, 10.0 ** -(2 + 12 * far)])
    if rng.random() < 0.5:
        n = rng.randint(3, 8)
        m, k = rng.randint(1, 9) / 4, float(rng.randint(100, 999))
        bodies = [point("hub", decades(rng, 1, 100), [0.0, 0.0])] + [point(f"b{i}", m, [1.0, 0.0]) for i in range(n)]
        slots = [joint(f"g{b['name']}", "pin-in-slot", "ground", b["name"], b["centre"], axis=[1, 0]) for b in bodies]
        springs = [axial(f"s{i}", "hub", f"b{i}", [[0.0, 0.0], [1.0, 0.0]], k * (1 + i * gap)) for i in range(n)]
        return plain(2, bodies, slots, springs + ([axial("w", "ground", "hub", [[-1.0, 0.0], [0.0, 0.0]], decades(rng, 1, 1e6))] if rng.random() < 0.7 else []))
    ways = [(1.0, 2.0, 2.0), (2.0, 1.0, -2.0), (2.0, -2.0, 1.0)]  # perpendicular: three equal modes in axes of no coordinate
    k = float(rng.randint(100, 999))
    springs = [axial(f"s{i}", "ground", "b", [list(w), [0.0, 0.0, 0.0]], k * (1 + i * gap)) for i, w in enumerate(ways)]
    bodies = [point("b", rng.randint(1, 9) / 4, [0.0, 0.0, 0.0])]
    if rng.random() < 0.5:  # a second one, stiff against the first
        bodies.append(point("c", rng.randint(1, 9) / 4, [3.0, 0.0, 0.0]))
        springs += [axial(f"t{i}", "b", "c", [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0]], decades(rng, 1, 1e9)) for i in range(1)]
        springs += [axial(f"u{i}", "ground", "c", [[3 + w[0], w[1], w[2]], [3.0, 0.0, 0.0]], k * (1 + i * gap)) for i, w in enumerate(ways)]
    return plain(3, bodies, [], springs)


# loads -------------------------------------------------------------------------------------------------------------------------------------------------------
@family("nearly buckled")
def buckling(rng, far):
    """A load short of the critical one by 1e-2 to 1e-14, or beyond it."""
    gap = rng.choice([1, -1]) * 10.0 ** -(2 + 12 * far)
    if rng.random() < 0.5:  # a mass on a rod on a spiral spring
        m, l = rng.randint(1, 9) / 4, rng.randint(1, 9) / 8
        return plain(2, [solid("b", m, rng.randint(1, 9) / 64, [0.0, l])], [joint("j", "revolute", "ground", "b", [0.0, 0.0])],
                     [torsion("s", "j", m * 9.75 * l * (1 + gap))], gravity_m_per_s2=[0, -9.75])
    n = rng.randint(2, 4)  # a column of hinged rods, pressed by a spring that is preloaded: P l = 2 k (1 - cos(pi/n)) between pins
    k, l = float(rng.randint(10, 99)), 0.25
    critical = 2 * k * (1 - math.cos(math.pi / n)) / l
    name = lambda i: f"b{i}"
    joints = [joint("j0", "revolute", "ground", "b0", [0.0, 0.0])]
    joints += [joint(f"j{i}", "revolute", name(i - 1), name(i), [i * l, 0.0]) for i in range(1, n)]
    joints.append(joint("end", "pin-in-slot", "ground", name(n - 1), [n * l, 0.0], axis=[1, 0]))
    return plain(2, [solid(name(i), 1.0, rng.choice([0.0078125, 0.015625]), [(i + 0.5) * l, 0.0]) for i in range(n)], joints,
                 [torsion(f"s{i}", f"j{i}", k) for i in range(1, n)]
                 + [axial("press", "ground", name(n - 1), [[n * l + 1, 0.0], [n * l, 0.0]], decades(rng, 1, 1e6), preload_n=-critical / (1 + critical / 1e300) * (1 - gap))])


@family("soft ground")
def soft_ground(rng, far):
    m = Maker(rng, rng.choice([2, 2, 3]), masses=1.5)
    m.tree(rng.randint(2, 4 if m.dim == 2 else 3), masses=0.0)
    for a, b in zip(m.model["bodies"], m.model["bodies"][1:]):
        m.spring(a["name"], b["name"], "bushing")
    for item in m.model["joints"] + m.model["springs"]:  # nothing else holds it
        if "bodies" in item:
            item["bodies"] = [b if b != "ground" else m.model["bodies"][0]["name"] for b in item["bodies"]]
    for key in ("joints", "springs"):
        m.model[key] = [i for i in m.model[key] if "bodies" not in i or i["bodies"][0] != i["bodies"][1]]
    model = m.done()
    foot = model["bodies"][-1]
    soft = lambda: float(f"{10 ** (4 - 13 * far) * rng.uniform(1, 9):.3g}")
    model.setdefault("springs", []).append({"name": "foot", "type": "bushing", "bodies": ["ground", foot["name"]], "at": foot["centre"],
                                            "stiffness_n_per_m": [soft() for _ in range(m.dim)], "stiffness_n_m_per_rad": soft() if m.dim == 2 else [soft() for _ in range(3)]})
    return model


@family("preload")
def preload(rng, far):
    """Strings of beads: tension large beside soft springs, or small beside stiff ones; loads that balance in one bead."""
    n, dim = rng.randint(1, 6), rng.choice([2, 3])
    tension = decades(rng, 1e-3, 1e6)
    ratio = rng.choice([10.0 ** (12 * far), 10.0 ** (-6 * far)])
    k = float(f"{tension * ratio:.3g}")
    at = [[float(i)] + [0.0] * (dim - 1) for i in range(n + 2)]
    name = lambda i: f"b{i}" if 0 < i < n + 1 else "ground"
    springs = [axial(f"s{i}", name(i), name(i + 1), [at[i], at[i + 1]], k, preload_n=tension) for i in range(n + 1)]
    if rng.random() < 0.5:  # pushed beside it by almost as much, so that little tension is left
        part = rng.choice([0.5, 1 - 2.0 ** -round(2 + 12 * far)])
        springs += [axial(f"p{i}", name(i), name(i + 1), [at[i], at[i + 1]], k, preload_n=-part * tension) for i in range(n + 1)]
    return plain(dim, [point(name(i), decades(rng, 0.1, 10), at[i]) for i in range(1, n + 1)], [], springs)


@family("heavy on stiff feet")
def sagging(rng, far):
    """Bodies on feet in gravity, springs over many decades beside them."""
    m = Maker(rng, rng.choice([2, 3]), decades=1 + 3 * far, masses=1.0)
    m.tree(rng.randint(1, 3))
    m.springs(rng.randint(1, 4))
    m.stand()
    m.gravity()
    return m.done()


@family("short levers")
def levers(rng, far):
    """Links on pins, each held by a spring whose line passes the pin at almost no distance: the softer its lever makes it, the stiffer it is. Weights and preloads move them."""
    n, at, bodies, joints, springs = rng.randint(1, 3), [0.0, 0.0], [], [], []
    name = lambda i: f"b{i}" if i >= 0 else "ground"
    coarse = lambda low, high: rng.randint(low, high) / 16
    for i in range(n):
        turn = rng.uniform(0, 2 * math.pi)
        lever, arm, length = 2.0 ** -rng.uniform(1, 2 + 6 * far), rng.uniform(0.25, 1), rng.uniform(0.25, 1)
        c, s = math.cos(turn), math.sin(turn)
        place = lambda along, across: [round(at[0] + along * c - across * s, 6), round(at[1] + along * s + across * c, 6)]
        bodies.append(solid(name(i), coarse(4, 40), coarse(1, 8), [at[0] + coarse(-8, 8), at[1] + coarse(-8, 8)]))
        joints.append(joint(f"j{i}", "revolute", name(i - 1), name(i), list(at)))
        k = float(f"{rng.uniform(100, 1000) / lever ** 2:.3g}")
        preload = {"preload_n": coarse(-32, 32)} if rng.random() < 0.5 else {}
        springs.append(axial(f"s{i}", name(i - 1), name(i), [place(arm, lever), place(arm + length, lever)], k, **preload))
        if rng.random() < 0.5:
            springs.append(torsion(f"t{i}", f"j{i}", decades(rng, 1, 1e3)))
        at = [at[0] + coarse(4, 16) * rng.choice([-1, 1]), at[1] + coarse(-8, 8)]
    return plain(2, bodies, joints, springs, gravity_m_per_s2=[0, -9.75 / 256])


# sizes -------------------------------------------------------------------------------------------------------------------------------------------------------
def resized(model, power):
    """Every length times 2^power, masses as the cube of it, times as the length: materials stay, frequencies are 2^-power times as high."""
    size = 2.0 ** power
    rescale(model, lambda dims: (lambda x: x * size ** (dims[0] + 3 * dims[1] + dims[2])))
    return model


@family("nanometres to kilometres")
def sizes(rng, far):
    kind = rng.choice(["free2", "free3", "loaded2", "loaded3", "chains", "hanging", "beams2", "beams3", "four_bar"])
    model = four_bar(rng, 2) if kind == "four_bar" else KINDS[kind](rng)
    return resized(model, rng.choice([-round(30 * far), round(10 * far)]))


@family("slender beams")
def slender(rng, far):
    """Beam elements whose bending is up to 1e12 times as soft as their stretching, with light and heavy bodies at their ends."""
    m = Maker(rng, rng.choice([2, 2, 3]), masses=1 + 2 * far)
    n, at, last = rng.randint(1, 3 if m.dim == 2 else 2), [0.0] * m.dim, "ground"
    for i in range(n):
        end = [x + (k == i % 2) * rng.randint(2, 8) / 8 for k, x in enumerate(at)]
        area = decades(rng, 1e-5, 1e-3)
        thin = lambda: float(f"{area * 10 ** (-2 - 10 * far) * rng.uniform(1, 9):.3g}")
        link = {"name": f"L{i}", "kind": "beam", "from": at, "to": end, "elements": rng.randint(1, 4 if m.dim == 2 else 2), "youngs_modulus_pa": decades(rng, 1e9, 1e11),
                "density_kg_per_m3": decades(rng, 1e3, 1e4), "section": {"shape": "general", "area_m2": area, "second_moment_m4": thin()}}
        if m.dim == 3:
            link.update(shear_modulus_pa=decades(rng, 1e9, 1e10), hinge_axis=[0, 0, 1])
            link["section"].update(second_moment_other_m4=thin(), torsion_constant_m4=thin())
        m.model.setdefault("links", []).append(link)
        if i or rng.random() < 0.7:
            m.model["joints"].append({"name": f"r{i}", "type": "fixed", "bodies": [last, f"L{i}.start"], "at": at})
        last, at = f"L{i}.end", end
    if rng.random() < 0.6:
        tip = m.body(at)
        m.model["joints"].append({"name": "tip", "type": "fixed", "bodies": [last, tip], "at": at})
    return m.done()


def model_of(name, seed, index, far):
    rng = random.Random(f"stress:{seed}:{name}:{index}")
    return FAMILIES[name](rng, rng.uniform(0, 1) if far is None else far)


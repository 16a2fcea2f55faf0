# SPDX-License-Identifier: GPL-3.0-or-later
"""What an equilibrium does: closed forms, and the balance of forces and moments of every body of random trees, drawn up from what
`info` says alone: sensors tell where the bodies are, springs and joints what acts on them. Slopes against differences."""
import json
import math
import random
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from common_mechanisms import PROGRAM, rotation  # noqa: E402
from suite import SEED, count  # noqa: E402

G = 9.81
JOINTS = {2: ["fixed", "revolute", "prismatic", "pin-in-slot", "distance"],
          3: ["fixed", "revolute", "prismatic", "cylindrical", "spherical", "universal", "planar", "point-on-line", "point-on-plane", "distance"]}


class Program(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def write(self, name, document):
        path = Path(self.folder.name) / name
        path.write_text(json.dumps(document))
        return path

    def call(self, *args):
        return subprocess.run([PROGRAM, *map(str, args)], capture_output=True, encoding="utf-8", timeout=300, cwd=self.folder.name)

    def rest(self, model, *args):
        """Numbers by their names; the reason of those that have none."""
        done = self.call("info", self.write("model.json", model), "--format", "json", "--quiet", *args)
        self.assertEqual(done.returncode, 0, done.stderr)
        answer = json.loads(done.stdout)
        answer = answer[0] if isinstance(answer, list) else answer
        self.assertEqual(answer["at_rest_left_out"], 0)
        return {r["output"]: r["why"] if r["value"] is None else r["value"] for r in answer["at_rest"]}

    def goals(self, model, goals, variables):
        """Of each goal its value and its slopes at the original design, which meets them all."""
        self.write("model.json", model)
        goals = [{"type": "static", **g, "at_least": -1e12} for g in goals]
        study = {"format": "modetune-study/1", "model": "model.json", "variables": variables, "goals": goals, "objective": {"minimise": "change"}}
        done = self.call("run", self.write("study.json", study), "-o", "results", "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        first = json.loads((Path(self.folder.name) / "results/study/result.json").read_text())["recommendations"][0]
        self.assertTrue(all(p["recommended"] == p["original"] for p in first["parameters"]))
        return first["goals"]

    def refused(self, model, goal):
        self.write("model.json", model)
        study = {"format": "modetune-study/1", "model": "model.json", "variables": [{"parameter": "k", "lower": 1, "upper": 1e6}],
                 "goals": [{"type": "static", "at_most": 1, **goal}]}
        done = self.call("check", self.write("study.json", study))
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        return done.stdout + done.stderr


def hung(**more):
    """2 kg on a rail upwards, on a spring of 1000 N/m beside its centre."""
    return {"format": "modetune-model/1", "dimension": 2, "gravity_m_per_s2": [0, -G], "parameters": {"k": {"value": 1000, "unit": "N/m"}},
            "bodies": [{"name": "b", "mass_kg": 2, "inertia_kg_m2": 0.1, "centre": [0.2, 0]}],
            "joints": [{"name": "rail", "type": "prismatic", "bodies": ["ground", "b"], "at": [0, 0], "axis": [0, 1]}],
            "springs": [{"name": "s", "type": "axial", "bodies": ["ground", "b"], "at": [[0.5, -1], [0.5, 0]], "stiffness_n_per_m": "k"}],
            "sensors": [{"name": "tip", "on": "b", "at": [0.5, 0], "directions": ["x", "y", "r"]}], **more}


class ClosedForms(Program):
    def close(self, found, wanted, part=1e-12):
        self.assertAlmostEqual(found, wanted, delta=part * max(abs(wanted), 1e-3))

    def test_mass_on_a_spring(self):
        """mg/k; the rail takes the moment of the weight 0.3 m beside the spring."""
        found = self.rest(hung())
        self.close(found["tip.y"], -2 * G / 1000)
        self.close(found["tip.r"], 0)
        self.close(found["spring.s"], -2 * G)
        self.close(found["joint.rail.x"], 0)
        self.close(found["joint.rail.y"], 0)
        self.close(found["joint.rail.rz"], -2 * G * 0.3)

    def test_lever_locked(self):
        """A lever of 3 kg, its centre at 0.4 m, held at 30 degrees: the moment of its weight, and its own."""
        model = {"format": "modetune-model/1", "dimension": 2, "gravity_m_per_s2": [0, -G],
                 "bodies": [{"name": "b", "mass_kg": 3, "inertia_kg_m2": 0.1, "centre": [0.4, 0]}],
                 "joints": [{"name": "pin", "type": "revolute", "bodies": ["ground", "b"], "at": [0, 0]}],
                 "sensors": [{"name": "c", "on": "b", "directions": ["x", "y", "r"]}],
                 "configurations": {"up": {"drive": {"joint": "pin", "position_rad": "30*deg"}}}}
        found = self.rest(model)
        moment = 3 * G * 0.4 * math.cos(math.pi / 6)
        self.close(found["joint.pin.hold"], moment)
        self.close(found["joint.pin.rz"], moment)
        self.close(found["joint.pin.y"], 3 * G)
        self.close(found["c.r"], math.pi / 6)
        self.close(found["c.x"], 0.4 * (math.cos(math.pi / 6) - 1))

    def test_cantilever(self):
        """P L^3/(3 E I) and P L^2/(2 E I) at the tip of a light beam, and its compliance, in the plane and in space; within an
        element its cubic."""
        for dimension in (2, 3):
            with self.subTest(dimension=dimension):
                bend = [0, 1, 0][:dimension]
                model = {"format": "modetune-model/1", "dimension": dimension,
                         "links": [{"name": "beam", "kind": "beam", "from": [0, 0, 0][:dimension], "to": [2, 0, 0][:dimension], "elements": 3,
                                    "density_kg_per_m3": 7850, "youngs_modulus_pa": 2.1e11,
                                    **({"shear_modulus_pa": 8e10, "hinge_axis": [0, 0, 1]} if dimension == 3 else {}),
                                    "section": {"shape": "circle", "diameter_m": 0.05}}],
                         "joints": [{"name": "clamp", "type": "fixed", "bodies": ["ground", "beam.start"], "at": [0, 0, 0][:dimension]}],
                         "loads": [{"name": "p", "on": "beam.end", "force_n": [3 * x for x in bend]}],
                         "sensors": [{"name": "tip", "on": "beam", "fraction": 1, "directions": ["y", "r" if dimension == 2 else "rz"]},
                                     {"name": "mid", "on": "beam", "fraction": 0.5, "directions": ["y", "r" if dimension == 2 else "rz"]}],
                         "parameters": {"k": 1}}
                found = self.rest(model)
                turn = "r" if dimension == 2 else "rz"
                ei = 2.1e11 * math.pi * 0.05**4 / 64
                # of a deflection of 1/80,000 of the length the difference to small motions is its square
                self.close(found["tip.y"], 3 * 8 / (3 * ei), 1e-7)
                self.close(found["tip." + turn], 3 * 4 / (2 * ei), 1e-7)
                self.close(found["mid.y"], 3 * 1 * (3 * 2 - 1) / (6 * ei), 1e-7)
                self.close(found["mid." + turn], 3 * 1 * (2 * 2 - 1) / (2 * ei), 1e-7)
                self.close(found["joint.clamp.y"], -3)
                self.close(found["joint.clamp.rz"], -6, 1e-7)


class Tree:
    """Bodies on joints of every type and on springs, in gravity, with forces and a preload: all that acts on one is in the model or told."""

    def __init__(self, rng, dimension):
        self.rng, self.dim = rng, dimension
        self.bodies, self.joints, self.springs, self.loads, self.sensors = [], [], [], [], []
        n = rng.randint(1, 4)
        for i in range(n):
            self._body(i)
        self.gravity = self.vector(G)

    def vector(self, size):
        return [self.rng.gauss(0, size) for _ in range(self.dim)]

    def point(self, reach=1.0):
        return [self.rng.uniform(-reach, reach) for _ in range(self.dim)]

    def axis(self):
        u = np.array(self.vector(1))
        return (u / np.linalg.norm(u)).tolist()

    def _body(self, i):
        r, name = self.rng, f"b{i}"
        inertia = [1 + r.random(), 1 + r.random(), 1 + r.random(), 0, 0, 0] if self.dim == 3 else 0.1 + r.random()
        self.bodies.append({"name": name, "mass_kg": 10 ** r.uniform(-1, 1), "inertia_kg_m2": inertia, "centre": self.point()})
        self.sensors.append({"name": name, "on": name, "directions": ["x", "y", "z", "rx", "ry", "rz"] if self.dim == 3 else ["x", "y", "r"]})
        other = "ground" if i == 0 else f"b{r.randrange(i)}"
        if r.random() < 0.85:
            self._joint(i, r.sample([other, name], 2) if r.random() < 0.3 else [other, name])
        for k in range(2 * self.dim - 1):  # whatever is free rests on springs
            self.springs.append({"name": f"s{i}_{k}", "type": "axial", "bodies": ["ground", name], "at": [self.point(3), self.point()],
                                 "stiffness_n_per_m": 10 ** r.uniform(3, 4), "preload_n": r.gauss(0, 20) * (r.random() < 0.3)})
        if r.random() < 0.5:
            k = 10 ** r.uniform(3, 4)
            turn = 10 ** r.uniform(2, 3)
            self.springs.append({"name": f"mount{i}", "type": "bushing", "bodies": ["ground", name], "at": self.point(),
                                 "stiffness_n_per_m": [k * (1 + r.random()) for _ in range(self.dim)],
                                 "stiffness_n_m_per_rad": [turn] * 3 if self.dim == 3 else turn})
        if r.random() < 0.7:
            self.loads.append({"name": f"p{i}", "on": name, "at": self.point(), "force_n": self.vector(30)})

    def _joint(self, i, bodies):
        kind = self.rng.choice(JOINTS[self.dim])
        joint = {"name": f"j{i}", "type": kind, "bodies": bodies, "at": self.point()}
        if kind == "distance":
            joint["at"] = [self.point(), self.point()]
        elif kind != "fixed" and kind != "spherical" and not (self.dim == 2 and kind == "revolute"):
            joint["axis"] = self.axis()
        if kind == "universal":
            u = np.cross(joint["axis"], self.axis())
            joint["axis_b"] = (u / np.linalg.norm(u)).tolist()
        if kind in ("fixed", "spherical") and self.rng.random() < 0.5:  # a bearing without mass: both bodies have what the joint carries
            turn = [10 ** self.rng.uniform(3, 5) for _ in range(3)] if self.dim == 3 else 1e4
            joint["compliance"] = {"stiffness_n_per_m": [10 ** self.rng.uniform(4, 6) for _ in range(self.dim)],
                                   **({"stiffness_n_m_per_rad": turn} if kind == "fixed" else {})}
        self.joints.append(joint)

    def model(self):
        return {"format": "modetune-model/1", "dimension": self.dim, "gravity_m_per_s2": self.gravity, "bodies": self.bodies, "joints": self.joints,
                "springs": self.springs, "loads": self.loads, "sensors": self.sensors}


def spatial(x):
    return np.array([*x, *[0.0] * (3 - len(x))])


def turned(v):
    """Rotation matrix of a rotation vector."""
    angle = np.linalg.norm(v)
    k = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
    if angle < 1e-9:
        return np.eye(3) + k
    return np.eye(3) + math.sin(angle) / angle * k + (1 - math.cos(angle)) / angle**2 * k @ k


class Balance:
    """Forces and moments about the origin on each body, from what is told."""

    def __init__(self, tree, found):
        self.tree, self.found = tree, found
        self.at = {"ground": (np.zeros(3), np.zeros(3), np.eye(3))}
        for b in tree.bodies:
            n = b["name"]
            read = [found.get(f"{n}.{d}", 0.0) for d in ("x", "y", "z", "rx", "ry", "rz")]
            if tree.dim == 2:
                read[5] = found[f"{n}.r"]
            self.at[n] = (spatial(b["centre"]), np.array(read[:3]), turned(np.array(read[3:])))
        self.sum = {n: np.zeros(6) for n in self.at}
        self.size = 0.0

    def place(self, body, point):
        centre, moved, r = self.at[body]
        return centre + moved + r @ (spatial(point) - centre)

    def push(self, body, at, force, moment=(0, 0, 0)):
        arm = np.cross(at, force) + moment
        self.sum[body] += [*force, *arm]
        self.size = max(self.size, np.linalg.norm(force), np.linalg.norm(arm))

    def pair(self, bodies, at, force, moment=(0, 0, 0)):
        """On the second body; the first has the opposite."""
        self.push(bodies[1], at, np.array(force), np.array(moment))
        self.push(bodies[0], at, -np.array(force), -np.array(moment))

    def told(self, name, letters=("x", "y", "z")):
        plane = self.tree.dim == 2
        force = [self.found.get(f"{name}.{d}", 0.0) for d in letters]
        turn = "r" if name.startswith("spring") and plane else "rz"
        moment = [self.found.get(f"{name}.{d}", 0.0) for d in ("rx", "ry", turn)]
        return force, moment

    def whole(self):
        for b in self.tree.bodies:
            centre, moved, _ = self.at[b["name"]]
            self.push(b["name"], centre + moved, b["mass_kg"] * spatial(self.tree.gravity))
        for p in self.tree.loads:
            self.push(p["on"], self.place(p["on"], p["at"]), spatial(p["force_n"]))
        for j in self.tree.joints:
            pair = isinstance(j["at"][0], list)
            self.pair(j["bodies"], self.place(j["bodies"][1], j["at"][1] if pair else j["at"]), *self.told(f"joint.{j['name']}"))
        for s in self.tree.springs:
            first, second = s["bodies"]
            if s["type"] == "axial":
                a, b = self.place(first, s["at"][0]), self.place(second, s["at"][1])
                self.pair(s["bodies"], b, self.found[f"spring.{s['name']}"] * (a - b) / np.linalg.norm(a - b))
            else:
                force, moment = self.told(f"spring.{s['name']}")
                self.pair(s["bodies"], self.place(second, s["at"]), -np.array(force), -np.array(moment))
        return max(np.abs(v).max() for n, v in self.sum.items() if n != "ground") / self.size


def crane():
    """A beam in space clamped to a bracket on a bushing, a rod to the ground, a counterweight on a sprung universal joint."""
    return {"format": "modetune-model/1", "dimension": 3, "gravity_m_per_s2": [0, 0, -G],
            "parameters": {"k": 2000, "e": 4e9, "d": 0.04, "m": 3, "reach": 0.9, "side": 0.3, "pull": 12},
            "bodies": [{"name": "bracket", "mass_kg": 2, "inertia_kg_m2": [0.02, 0.02, 0.02, 0, 0, 0], "centre": [0, 0, 0.1]},
                       {"name": "weight", "mass_kg": "m", "inertia_kg_m2": [0.02, 0.03, 0.02, 0, 0, 0], "centre": ["-side", 0.05, 0]}],
            "links": [{"name": "beam", "kind": "beam", "from": [0, 0, 0.2], "to": ["reach", 0.1, 0.2], "elements": 2, "density_kg_per_m3": 1200,
                       "youngs_modulus_pa": "e", "shear_modulus_pa": "e/3", "hinge_axis": [0, 0, 1], "section": {"shape": "circle", "diameter_m": "d"}}],
            "joints": [{"name": "clamp", "type": "fixed", "bodies": ["bracket", "beam.start"], "at": [0, 0, 0.2]},
                       {"name": "rod", "type": "distance", "bodies": ["ground", "bracket"], "at": [[0.2, 0.3, -0.5], [0.05, 0, 0.1]]},
                       {"name": "cross", "type": "universal", "bodies": ["bracket", "weight"], "at": ["-side/2", 0, 0.1], "axis": [0, 1, 0], "axis_b": [1, 0, 0]}],
            "springs": [{"name": "mount", "type": "bushing", "bodies": ["ground", "bracket"], "at": [0, 0, 0],
                         "stiffness_n_per_m": ["3*k", "2*k", "4*k"], "stiffness_n_m_per_rad": ["k/8", "k/9", "k/5"]},
                        {"name": "hold", "type": "axial", "bodies": ["weight", "bracket"], "at": [["-side", 0.1, 0], [0.1, 0.2, 0.1]],
                         "stiffness_n_per_m": "k", "preload_n": "pull"},
                        {"name": "stay", "type": "axial", "bodies": ["ground", "weight"], "at": [["-side", -0.5, 0.2], ["-side", 0, -0.1]], "stiffness_n_per_m": 900}],
            "sensors": [{"name": "tip", "on": "beam", "fraction": 0.8, "directions": ["x", "y", "z", "rx", "ry", "rz"]},
                        {"name": "head", "on": "bracket", "at": [0.1, 0, 0.2], "directions": ["x", "y", "z", "rx", "ry", "rz"]}]}


class Goals(Program):
    def test_slopes_in_space(self):
        """Of everything that info tells of the crane, by central differences of what it tells."""
        model = crane()
        names = ["k", "e", "d", "m", "reach", "side", "pull"]
        told = self.rest(model)
        goals = [{"output": o} for o, v in told.items() if not isinstance(v, str)]
        self.assertGreater(len(goals), 35)
        original = self.goals(model, goals, [{"parameter": n, "lower": 0.9 * model["parameters"][n], "upper": 1.1 * model["parameters"][n]} for n in names])
        size = max(abs(v) for v in told.values())
        for g, asked in zip(original, goals):
            turns, moves = asked["output"].rsplit(".", 1)[1].startswith("r"), asked["output"][:3] in ("tip", "hea")
            self.assertEqual(g["unit"], (("m", "rad") if moves else ("N", "N m"))[turns], asked)
            self.assertIn((("displacement", "rotation") if moves else ("force", "moment"))[turns], g["quantity"])
        for n in names:
            h = 1e-4 * model["parameters"][n]
            up, down = (self.rest(model, "--set", f"{n}={model['parameters'][n] + s * h!r}") for s in (1, -1))
            for g, asked in zip(original, goals):
                o = asked["output"]
                slope = (up[o] - down[o]) / (2 * h)
                with self.subTest(output=o, parameter=n):
                    self.assertAlmostEqual(g["value"], told[o], delta=1e-9 * max(abs(told[o]), 1e-3))
                    scale = max(abs(slope) * model["parameters"][n], 1e-3 * abs(told[o]), 1e-6 * (size if o[:3] in ("joi", "spr") else 1))
                    self.assertAlmostEqual(g["sensitivity"][n] * model["parameters"][n], slope * model["parameters"][n], delta=1e-5 * scale)

    def test_compliance_is_what_a_small_load_does(self):
        model = crane()
        goals = [{"output": o, "input": i, "quantity": q}
                 for o, i in (("tip.z", "tip.z"), ("head.x", "head.y"), ("head.rz", "tip.y")) for q in ("compliance", "stiffness")]
        found = [g["value"] for g in self.goals(model, goals, [{"parameter": "k", "lower": 1000, "upper": 4000}])]
        for a in (0, 2, 4):
            self.assertAlmostEqual(found[a] * found[a + 1], 1, delta=1e-12)
        h = 1e-2
        loads = [{**model, "loads": [{"name": "p", "on": "bracket", "at": [0.1, 0, 0.2], "force_n": [0, s * h, 0]}]} for s in (1, -1)]
        up, down = (self.rest(m)["head.x"] for m in loads)
        self.assertAlmostEqual(found[2], (up - down) / (2 * h), delta=1e-6 * abs(found[2]))

    def test_refusals(self):
        still = hung()
        self.assertIn('/goals/0/output: no output is called "joint.rail.rx"', self.refused(still, {"output": "joint.rail.rx"}))
        self.assertIn('no output is called "joint.rail"', self.refused(still, {"output": "joint.rail"}))
        self.assertIn("nothing holds it", self.refused(still, {"output": "joint.rail.hold"}))
        self.assertIn("at rest there is no velocity", self.refused(still, {"output": "tip.x:velocity"}))
        self.assertIn("the displacement of a sensor", self.refused(still, {"output": "spring.s", "input": "tip.y"}))
        self.assertIn("a motion of the ground", self.refused(still, {"output": "tip.y", "input": "base.y"}))
        two = hung()
        two["joints"].append({**two["joints"][0], "name": "other", "at": [0.4, 0.3]})
        self.assertIn('joint "rail" is redundant with others in rz', self.refused(two, {"output": "joint.rail.rz"}))
        loose = hung(gravity_m_per_s2=[0, 0], springs=[])
        self.assertIn("free to move as a rigid body", self.refused(loose, {"output": "tip.y", "input": "tip.y"}))


class Bodies(Program):
    def test_balance(self):
        worst, seen = 0.0, {}
        for i in range(count(16, every=400, instrumented=3)):
            rng = random.Random(f"{SEED} at rest {i}")
            tree = Tree(rng, 2 + i % 2)
            with self.subTest(i=i):
                found = self.rest(tree.model())
                for j in tree.joints:
                    seen[j["type"]] = seen.get(j["type"], 0) + 1
                off = Balance(tree, found).whole()
                worst = max(worst, off)
                self.assertLess(off, 1e-9)
        self.assertGreater(len(seen), 5)


if __name__ == "__main__":
    unittest.main()

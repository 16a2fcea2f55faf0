# SPDX-License-Identifier: GPL-3.0-or-later
"""Who has the energy of a mode: an engine on four mounts, worked out by hand with 6 x 6 matrices, against `modes --energy` and against
what a study decouples: with M of mass and inertia and K = sum G' k G of the mounts at r, G = [1, -r^], a mode u has of direction k
    u_k (M u)_k / u' M u,     and a mount    (G u)' k (G u) / u' K u."""
import csv
import io
import json

import numpy as np
from common_cli import CliTest, main

MASS, INERTIA = 182.0, np.array([[6.1, 0.4, -1.6], [0.4, 14.2, 0.2], [-1.6, 0.2, 12.8]])
CENTRE = np.array([-0.06, 0.008, 0.07])
PLACES = {"fl": (1, 1), "fr": (1, -1), "rl": (-1, 1), "rr": (-1, -1)}
VALUES = {"kc_f": 280e3, "ks_f": 70e3, "kc_r": 240e3, "ks_r": 60e3, "a_f": 40, "x_f": 0.25, "x_r": -0.42, "z_f": -0.02, "z_r": -0.06}
DIRECTIONS = ["x", "y", "z", "rx", "ry", "rz"]


def engine():
    front = {1: ("-kyz", "fl"), -1: ("kyz", "fr")}
    springs = []
    for side, (kyz, name) in front.items():
        rows = [["ks_f", 0, 0, 0, 0, 0], [0, "kyy", kyz, 0, 0, 0], [0, kyz, "kzz", 0, 0, 0], *[[0] * 6] * 3]
        springs.append({"name": name, "type": "bushing", "bodies": ["ground", "engine"], "at": ["x_f", 0.26 * side, "z_f"], "stiffness_matrix": rows})
    for side, name in ((1, "rl"), (-1, "rr")):
        springs.append({"name": name, "type": "bushing", "bodies": ["ground", "engine"], "at": ["x_r", 0.15 * side, "z_r"],
                        "stiffness_n_per_m": ["ks_r", "ks_r", "kc_r"], "stiffness_n_m_per_rad": [0, 0, 0]})
    angle = "a_f*deg"
    return {"format": "modetune-model/1", "dimension": 3,
            "parameters": {**VALUES, "kyy": f"kc_f*sin({angle})^2 + ks_f*cos({angle})^2", "kzz": f"kc_f*cos({angle})^2 + ks_f*sin({angle})^2",
                           "kyz": f"(kc_f - ks_f)*sin({angle})*cos({angle})"},
            "points": {"crank": [0, 0, 0]},
            "bodies": [{"name": "engine", "mass_kg": MASS, "centre": list(CENTRE), "inertia_kg_m2": [6.1, 14.2, 12.8, 0.4, -1.6, 0.2]}],
            "springs": springs}


def cross(r):
    return np.array([[0, -r[2], r[1]], [r[2], 0, -r[0]], [-r[1], r[0], 0]])


def mounts(v):
    """{name: (G, k)}"""
    s, c = np.sin(np.radians(v["a_f"])), np.cos(np.radians(v["a_f"]))
    out = {}
    for name, (front, side) in PLACES.items():
        r = np.array([v["x_f"], 0.26 * side, v["z_f"]] if front > 0 else [v["x_r"], 0.15 * side, v["z_r"]]) - CENTRE
        k = np.diag([v["ks_r"], v["ks_r"], v["kc_r"]])
        if front > 0:
            yz = -side * (v["kc_f"] - v["ks_f"]) * s * c
            k = np.array([[v["ks_f"], 0, 0], [0, v["kc_f"] * s * s + v["ks_f"] * c * c, yz], [0, yz, v["kc_f"] * c * c + v["ks_f"] * s * s]])
        out[name] = np.hstack([np.eye(3), -cross(r)]), k
    return out


def by_hand(v, point=CENTRE, axes=np.eye(3)):
    """(Hz, kinetic [mode, direction], strain {mount: [mode, component]}) in per cent, about a point and along axes (columns)."""
    m = np.zeros((6, 6))
    m[:3, :3], m[3:, 3:] = MASS * np.eye(3), INERTIA
    all_mounts = mounts(v)
    k = sum(g.T @ s @ g for g, s in all_mounts.values())
    low = np.linalg.cholesky(m)
    values, y = np.linalg.eigh(np.linalg.solve(low, np.linalg.solve(low, k).T))
    u = np.linalg.solve(low.T, y)
    shift = np.eye(6)  # of the centre's motion to the point's
    shift[:3, 3:] = -cross(np.array(point) - CENTRE)
    turn = np.kron(np.eye(2), axes.T) @ shift
    there, momentum = turn @ u, np.linalg.inv(turn).T @ m @ u
    strain = {name: 100 * ((g @ u) * (s @ g @ u)).T / values[:, None] for name, (g, s) in all_mounts.items()}
    return np.sqrt(values) / (2 * np.pi), 100 * (there * momentum).T, strain


class Energy(CliTest):
    def setUp(self):
        super().setUp()
        self.engine = self.write("problems/engine.json", json.dumps(engine()))

    def modes(self, *more, form="json"):
        done = self.run_program("modes", self.engine, "--energy", "--format", form, *more)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)[0]["modes"] if form == "json" else done.stdout

    def check(self, told, expected):
        hz, kinetic, strain = expected
        for i, mode in enumerate(told):
            self.assertAlmostEqual(mode["frequency_hz"], hz[i], delta=1e-9 * hz[i])
            energy = mode["energy"]
            (body,) = energy["kinetic"]
            for k, d in enumerate(DIRECTIONS):
                self.assertAlmostEqual(body[f"{d}_percent"], kinetic[i, k], delta=1e-8)
            for mount in energy["strain"]:
                for k, d in enumerate(DIRECTIONS):
                    self.assertAlmostEqual(mount[f"{d}_percent"], strain[mount["spring"]][i, k] if k < 3 else 0.0, delta=1e-8)
            self.assertAlmostEqual(energy["kinetic_sum_percent"], 100, delta=1e-9)
            self.assertAlmostEqual(energy["strain_sum_percent"], 100, delta=1e-9)
            self.assertEqual(energy["loads_percent"], 0)
            self.assertEqual(energy["modes"], 1)

    def test_against_matrices_by_hand(self):
        self.check(self.modes(), by_hand(VALUES))
        self.assertLess(min(by_hand(VALUES, [0, 0, 0])[1].min(), by_hand(VALUES)[1].min()), -0.4)  # shares below 0 where axes couple

    def test_about_a_point_and_along_other_axes(self):
        self.check(self.modes("--energy-about", "crank"), by_hand(VALUES, [0, 0, 0]))
        moments, axes = np.linalg.eigh(INERTIA)
        order = [int(np.argmax(axes[k] ** 2)) for k in range(3)]
        self.check(self.modes("--axes", "principal"), by_hand(VALUES, axes=axes[:, order]))
        roll = np.linalg.solve(INERTIA, [1, 0, 0])
        roll /= np.linalg.norm(roll)
        beside = np.array([0, 1, 0]) - roll[1] * roll
        beside /= np.linalg.norm(beside)
        self.check(self.modes("--axes", "torque_roll_x", "--energy-about", "crank"),
                   by_hand(VALUES, [0, 0, 0], np.array([roll, beside, np.cross(roll, beside)]).T))

    def test_tables_are_those_numbers(self):
        _, kinetic, strain = by_hand(VALUES)
        rows = list(csv.DictReader(io.StringIO(self.modes(form="csv"))))
        self.assertEqual(len(rows), 6 * (6 + 4 * 6 + 1))
        for row in rows:
            k, i = DIRECTIONS.index(row["direction"]) if row["direction"] else 0, int(row["mode"]) - 1
            expected = kinetic[i, k] if row["energy"] == "kinetic" else strain[row["name"]][i, k] if row["name"] in strain and k < 3 else 0.0
            self.assertAlmostEqual(float(row["percent"]), expected, delta=1e-8)
        text = self.modes(form="text")
        line = next(row for row in text.splitlines() if row.startswith("  engine.rx"))
        self.assertEqual(line.split()[1:], [f"{x:.1f}" for x in kinetic[:, 3] if abs(x) >= 0.5])
        self.assertIn("Each column sums to 100 %", text)

    def test_questions_without_an_answer(self):
        for more, words in ((["--energy", "--energy-about", "crnak"], 'no point "crnak"; did you mean "crank"?'), (["--energy", "--axes", "main"], '"main" is none of'),
                            (["--energy-about", "crank"], "--energy-about and --axes go with --energy")):
            done = self.run_program("modes", self.engine, *more)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(words, done.stderr)

    def test_six_modes_decoupled_beside_orders_and_a_catalogue(self):
        variables = [{"parameter": name, "lower": low, "upper": high} for name, low, high in (
            ("ks_f", 20e3, 200e3), ("kc_r", 100e3, 600e3), ("ks_r", 20e3, 200e3), ("a_f", 5, 70), ("z_f", -0.1, 0.15), ("z_r", -0.1, 0.15), ("x_f", 0.1, 0.4),
            ("x_r", -0.5, -0.1))]
        variables.append({"parameter": "kc_f", "catalogue": [200e3, 250e3, 315e3, 400e3]})
        study = {"format": "modetune-study/1", "model": "../problems/engine.json", "variables": variables, "recommendations": 1,
                 "goals": [{"type": "energy", "mode": "most", "body": "engine", "directions": DIRECTIONS, "at_least_percent": 85},
                           {"type": "avoid", "machines": [{"name": "idle", "speed_hz": "750*rpm", "speed_range": [0.95, 1.1], "orders": ["2E"]}], "margin_percent": 10}],
                 "objective": {"minimise": "change"}, "search": {"starts": 4}}
        done = self.run_program("run", self.write("studies/decoupled.json", json.dumps(study)), "-o", "out", "--quiet", "--report", "none")
        self.assertEqual(done.returncode, 0, done.stderr + done.stdout)
        (design,) = json.loads((self.folder / "out/decoupled/result.json").read_text())["recommendations"]
        v = VALUES | {p["name"]: p["recommended"] for p in design["parameters"]}
        hz, kinetic, _ = by_hand(v)
        told = [g for g in design["goals"] if g["type"] == "energy"]
        self.assertEqual(len(told), 6)
        for k, goal in enumerate(told):
            self.assertTrue(goal["met"])
            self.assertEqual(goal["unit"], "%")
            self.assertAlmostEqual(goal["value"], kinetic[:, k].max(), delta=1e-6)
            self.assertGreaterEqual(kinetic[:, k].max(), 85 * (1 - 1.01e-6))
        self.assertEqual(sorted(int(np.argmax(kinetic[:, k])) for k in range(6)), list(range(6)))  # each direction has a mode of its own
        self.assertTrue(all(f < 23.75 / 1.1 * 1.000002 or f > 27.5 * 1.1 / 1.000002 for f in hz))

    def test_a_bearing_that_yields_has_its_share(self):
        """A wheel about its centre on a bearing of kx, ky and beside a spring k along x: kx / (kx + k) of the mode along x."""
        kx, ky, k = 3e4, 9e4, 1e4
        wheel = {"format": "modetune-model/1", "dimension": 2, "parameters": {"k": k}, "bodies": [{"name": "wheel", "mass_kg": 1, "inertia_kg_m2": 1, "centre": [0, 0]}],
                 "joints": [{"name": "pin", "type": "revolute", "bodies": ["ground", "wheel"], "at": [0, 0], "compliance": {"stiffness_n_per_m": [kx, ky]}}],
                 "springs": [{"name": "side", "type": "bushing", "bodies": ["ground", "wheel"], "at": [0, 0], "stiffness_n_per_m": ["k", 0], "stiffness_n_m_per_rad": 10}]}
        wheel["configurations"] = {"as_is": {}}
        self.write("problems/wheel.json", json.dumps(wheel))
        asked = [{"mode": 2, "spring": "pin.bearing"}, {"mode": 2, "spring": "pin.bearing", "component": "x"}, {"mode": 3, "spring": "pin.bearing", "component": "y"}, {"mode": 2, "spring": "side"}]
        study = {"format": "modetune-study/1", "model": "../problems/wheel.json", "variables": [{"parameter": "k", "lower": 1e3, "upper": 3e4}],
                 "goals": [{"type": "energy", "at_least_percent": 1, **goal} for goal in asked]}
        done = self.run_program("run", self.write("studies/wheel.json", json.dumps(study)), "-o", "out", "--quiet", "--report", "none")
        self.assertEqual(done.returncode, 0, done.stderr)
        (design,) = json.loads((self.folder / "out/wheel/result.json").read_text())["recommendations"]
        for goal, share in zip(design["goals"], (75, 75, 100, 25)):
            self.assertAlmostEqual(goal["value"], share, delta=1e-8)
        study["goals"][0]["spring"] = "side.bearing"
        done = self.run_program("check", self.write("studies/wrong.json", json.dumps(study)))
        self.assertIn('unknown spring or link "side.bearing"; did you mean', done.stderr)


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""`repeat` and `include` through the commands: slopes, studies, what is applied, and files that would be endless."""
import json
import math

from common_cli import SOURCE, CliTest, main

MOUNT = {"name": "mount", "type": "bushing", "bodies": ["ground", "pump"], "at": "mount", "stiffness_n_per_m": ["0.6*k", "0.5*k", "k"], "stiffness_n_m_per_rad": [0, 0, 0]}
PUMP = {"format": "modetune-model/1", "dimension": 3, "units": {"length": "mm"},
        "parameters": {"k": {"value": 260, "unit": "N/mm"}, "a": {"value": 300, "unit": "mm"}, "turn": {"value": 75, "unit": "deg"}},
        "points": {"mount": ["a", 180, -210]},
        "bodies": [{"name": "pump", "mass_kg": 86, "inertia_kg_m2": [1.9, 4.6, 4.9], "centre": [0, 0, 0]}], "springs": [MOUNT],
        "repeat": [{"of": ["mount"], "count": 4, "polar": {"axis": [0, 0.2, 1], "about": [0, 10, 0], "angle_rad": "turn"}}]}
LEG = {"format": "modetune-model/1", "dimension": 3, "parameters": {"k": {"value": 3, "unit": "N/mm"}, "m": 0.5},
       "bodies": [{"name": "foot", "mass_kg": "m", "inertia_kg_m2": [1e-3, 1e-3, 1e-3], "centre": [0, 0, 0]}],
       "springs": [{"name": "leg", "type": "bushing", "bodies": ["ground", "foot"], "stiffness_n_per_m": ["k", "2*k", "k"], "stiffness_n_m_per_rad": [1, 2, 3]}]}
BENCH = {"format": "modetune-model/1", "dimension": 3, "parameters": {"front": {"value": 2, "unit": "N/mm"}},
         "bodies": [{"name": "frame", "mass_kg": 5, "inertia_kg_m2": [1, 1, 1], "centre": [0, 0, 0]}],
         "springs": [{"name": "floor", "type": "bushing", "bodies": ["ground", "frame"], "stiffness_n_per_m": [9e3, 9e3, 9e3], "stiffness_n_m_per_rad": [900, 900, 900]}],
         "include": [{"file": "leg.json", "prefix": "f_", "at": [1, 0, 0], "ground": "frame", "parameters": {"k": "front"}},
                     {"file": "leg.json", "prefix": "r_", "at": [-1, 0, 0], "rotate": {"axis": [0, 0, 1], "angle_rad": "90*deg"}, "ground": "frame"}]}
STUDY = {"format": "modetune-study/1", "model": "bench.json", "variables": [{"parameter": "r_k", "lower": 1, "upper": 9}],
         "goals": [{"type": "frequency", "configuration": "default", "mode": 1, "at_least_hz": 3.3}], "objective": {"minimise": "change"}}


class Copies(CliTest):
    def frequencies(self, path, *more):
        rows = self.expect(0, "modes", str(path), "--count", "all", "--format", "csv", *more).stdout.splitlines()
        at = rows[0].split(",").index("frequency_hz")
        return [float(row.split(",")[at]) for row in rows[1:]]

    def test_a_mirror_makes_the_shipped_pump(self):
        shipped = json.loads((SOURCE / "problems/pump_on_mounts.json").read_text(encoding="utf-8"))
        first = dict(shipped["springs"][0], name="mount")
        made = {**shipped, "springs": [first], "repeat": [{"of": ["mount"], "mirror": {"plane": p}, "suffix": s} for p, s in (("xz", "_right"), ("yz", "_rear"))]}
        made["repeat"][1]["of"] = ["mount*"]
        del made["$schema"]
        wanted = self.frequencies(SOURCE / "problems/pump_on_mounts.json")
        for a, b in zip(self.frequencies(self.write("pump.json", json.dumps(made))), wanted):
            self.assertAlmostEqual(a / b, 1, delta=1e-12)

    def test_joints_that_yield_are_turned_and_mirrored(self):
        bodies = [{"name": name, "mass_kg": mass, "inertia_kg_m2": [0.02, 0.03, 0.04], "centre": centre} for name, mass, centre in (("arm", 3, [0.3, 0.1, 0.2]), ("tip", 1, [0.6, 0.2, 0.1]))]
        yields = {"stiffness_n_per_m": [2e6, "s", 4e6], "stiffness_n_m_per_rad": ["rigid", 3e4, "rigid"], "damping_n_s_per_m": [10, 20, 30]}
        joints = [{"name": "hinge", "type": "revolute", "bodies": ["ground", "arm"], "at": [0, 0, 0], "axis": [0, 1, 0.4], "compliance": {**yields, "axes": {"x": [1, 0.5, 0]}}},
                  {"name": "clamp", "type": "fixed", "bodies": ["arm", "tip"], "at": [0.5, 0, 0], "compliance": yields}]
        alone = {"format": "modetune-model/1", "dimension": 3, "parameters": {"s": 3e6}, "bodies": bodies, "joints": joints,
                 "springs": [{"name": "coil", "type": "torsion", "joint": "hinge", "stiffness_n_m_per_rad": 500}]}
        wanted = [f for f in self.frequencies(self.write("alone.json", json.dumps(alone))) for _ in "ab"]
        for motion in ({"mirror": {"normal": [1, 2, 0]}}, {"count": 2, "polar": {"axis": [1, 0, 2], "angle_rad": 0.7}}):
            found = self.frequencies(self.write("two.json", json.dumps({**alone, "repeat": [{"of": ["*"], **motion}]})))
            self.assertEqual(len(wanted), len(found))
            for a, b in zip(found, wanted):
                self.assertAlmostEqual(a / b, 1, delta=1e-11)

    def test_slopes_of_an_angle_between_copies(self):
        path = self.write("pump.json", json.dumps(PUMP))
        rows = self.expect(0, "sensitivity", path, "--parameters", "turn", "--format", "csv").stdout.splitlines()
        head = rows[0].split(",")
        slopes = [float(row.split(",")[head.index("hz_per_unit")]) for row in rows[1:]]
        errors = []
        for h in (2e-3, 1e-3):
            low, high = (self.frequencies(path, "--set", f"turn={math.degrees(math.radians(75) + s * h)!r}") for s in (-1, 1))
            errors.append(max(abs((b - a) / (2 * h) - s) for a, b, s in zip(low, high, slopes)))
        self.assertAlmostEqual(math.log2(errors[0] / errors[1]), 2, delta=0.1)

    def bench(self):
        for name, document in (("leg.json", LEG), ("bench.json", BENCH), ("study.json", STUDY)):
            path = self.write(name, json.dumps(document, indent=1))
        return path

    def test_a_study_of_included_parts(self):
        self.expect(0, "run", self.bench(), "-o", "out")
        result = json.loads((self.folder / "out/study/result.json").read_text(encoding="utf-8"))
        self.assertEqual(["study.json", "bench.json", "leg.json", "leg.json"], [f["file"] for f in result["run"]["inputs"]])
        applied = self.write("elsewhere.json", self.expect(0, "apply", "out/study").stdout)
        self.assertNotIn("include", json.loads((self.folder / applied).read_text(encoding="utf-8")))
        self.assertAlmostEqual(self.frequencies(applied)[0], 3.3, delta=1e-6)
        self.write("leg.json", json.dumps({**LEG, "name": "changed"}))
        self.assertIn("\"leg.json\" has changed since", self.expect(2, "apply", "out/study").stderr)

    def test_what_would_be_endless_is_refused(self):
        points = {f"p{i}": [i, 0, 0] for i in range(300)}
        bomb = {"format": "modetune-model/1", "dimension": 3, "points": points, "repeat": [{"of": ["*"], "count": 10000, "linear": {"step": [1, 0, 0]}}] * 3}
        self.assertIn("has more than 3000000 values", self.expect(2, "check", self.write("bomb.json", json.dumps(bomb))).stderr)
        for i in range(20):
            include = [{"file": f"b{i + 1}.json", "prefix": f"x{k}_"} for k in range(10)]
            self.write(f"b{i}.json", json.dumps({"format": "modetune-model/1", "dimension": 3, "include": include}))
        said = self.expect(2, "check", "b0.json").stderr
        self.assertIn("included more than 16 deep", said)


if __name__ == "__main__":
    main()

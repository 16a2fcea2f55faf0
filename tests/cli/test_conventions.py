# SPDX-License-Identifier: GPL-3.0-or-later
"""Signs, axes and orders of bodies: what the schema states is what the mechanism does, and what `info` says that it understood."""
import json

from common_cli import CliTest, main

# A pointer that lies along x, on a hinge at the origin; its second body is the pointer. Sensitive: 1 N m turns it by 0.01 rad.
HINGE = {"name": "pin", "type": "revolute", "bodies": ["ground", "hand"], "at": [0, 0]}
SPRING = {"name": "s", "type": "torsion", "joint": "pin", "stiffness_n_m_per_rad": 100}
PLANE = {"format": "modetune-model/1", "dimension": 2, "bodies": [{"name": "hand", "mass_kg": 1, "inertia_kg_m2": 0.1, "centre": [1, 0]}],
         "joints": [HINGE], "springs": [SPRING]}
# The same on a slide along x.
SLIDE = dict(PLANE, joints=[dict(HINGE, type="prismatic", axis=[1, 0])],
             springs=[{"name": "s", "type": "axial", "joint": "pin", "stiffness_n_per_m": 100}])
BACK = dict(HINGE, bodies=["hand", "ground"])


class Conventions(CliTest):
    def info(self, model):
        path = self.write("problems/c.json", json.dumps(model))
        got, text = self.json_of("info", path)[0], " ".join(self.expect(0, "info", path).stdout.split())
        for c in got["conventions"]:  # what is said in words is a member, at its place, with its value
            self.assertIn(c["text"], text)
            at = model
            for key in c["pointer"].split("/")[1:]:
                at = at[int(key) if isinstance(at, list) else key]
            if c["value"] is not None:
                self.assertEqual(at, c["value"])
        return got, text

    def told(self, got):
        return [(c["pointer"], c["value"], c["first"], c["second"]) for c in got["conventions"]]

    def test_turning(self):
        rows = [  # changes, which way the pointer goes, what info says of it
            ({"springs": [dict(SPRING, preload_n_m=1)]}, -1, 'preload_n_m 1 turns "hand" against "ground" clockwise'),
            ({"springs": [dict(SPRING, preload_n_m=-1)]}, 1, 'preload_n_m -1 turns "hand" against "ground" counter-clockwise'),
            ({"springs": [dict(SPRING, free_angle_rad=0.01)]}, 1, 'no torque where "hand" is turned by 0.01 rad counter-clockwise'),
            ({"loads": [{"name": "l", "joint": "pin", "moment_n_m": 1}]}, 1, 'moment_n_m 1 turns "hand" counter-clockwise, and "ground"'),
            ({"loads": [{"name": "l", "on": "hand", "moment_n_m": -1}]}, -1, 'moment_n_m -1 turns "hand" clockwise'),
            ({"joints": [BACK], "springs": [dict(SPRING, preload_n_m=1)]}, 1, 'preload_n_m 1 turns "ground" against "hand" clockwise'),
            ({"joints": [BACK], "loads": [{"name": "l", "joint": "pin", "moment_n_m": 1}]}, -1, 'turns "ground" counter-clockwise, and "hand"'),
            ({"configurations": {"x": {"drive": {"joint": "pin", "position_rad": 0.01}}}}, 1,
             'drive: "hand" stands 0.01 rad counter-clockwise against "ground"'),
        ]
        for change, way, words in rows:
            with self.subTest(words):
                got, text = self.info(dict(PLANE, **change))
                self.assertAlmostEqual(got["centre_m"][1], 0.01 * way, delta=1e-5)
                self.assertIn(words, text)

    def test_sliding(self):
        spring = SLIDE["springs"][0]
        between = {"name": "s", "type": "axial", "bodies": ["ground", "hand"], "at": [[0, 0], [1, 0]], "stiffness_n_per_m": 100}
        rows = [
            ({"springs": [dict(spring, preload_n=1)]}, -1, 'preload_n 1 pushes "hand" against the axis of "pin"'),
            ({"springs": [dict(between, preload_n=1)]}, -1, "preload_n 1 is tension: it draws its two points together"),
            ({"springs": [dict(between, preload_n=-1)]}, 1, "preload_n -1 is compression: it pushes its two points apart"),
            ({"loads": [{"name": "l", "joint": "pin", "force_n": 1}]}, 1, 'force_n 1 pushes "hand" along the axis, and "ground" the other way'),
        ]
        for change, way, words in rows:
            with self.subTest(words):
                got, text = self.info(dict(SLIDE, **change))
                self.assertAlmostEqual(got["centre_m"][0], 1 + 0.01 * way, delta=1e-9)
                self.assertIn(words, text)

    def test_members_of_what_was_understood(self):
        back = {"springs": [dict(SPRING, preload_n_m=2), dict(SPRING, name="t", free_angle_rad=0.1)], "loads": [{"name": "l", "on": "hand", "moment_n_m": -1}]}
        got, _ = self.info(dict(PLANE, joints=[BACK], dampers=[{"name": "d", "type": "bushing", "bodies": ["ground", "hand"],
                                                               "damping_n_s_per_m": [1, 1], "damping_n_m_s_per_rad": 1}], **back))
        self.assertEqual(self.told(got), [("/springs/0/preload_n_m", 2, "hand", "ground"), ("/springs/1/free_angle_rad", 0.1, "hand", "ground"),
                                          ("/dampers/0", None, "ground", "hand"), ("/loads/0/moment_n_m", -1, "ground", "hand")])
        drive = {"x": {"drive": {"joint": "pin", "position_rad": 0.01}}, "y": {"like": "x"}}
        path = self.write("problems/c.json", json.dumps(dict(PLANE, configurations=drive)))
        for one in self.json_of("info", path):
            self.assertEqual(self.told(one), [("/configurations/x/drive/position_rad", 0.01, "ground", "hand")])
        self.assertEqual(self.info(PLANE)[0]["conventions"], [])
        loads = [{"name": f"l{i}", "on": "hand", "moment_n_m": 1e-9} for i in range(30)]
        self.assertEqual(len(self.json_of("info", self.write("problems/c.json", json.dumps(dict(PLANE, loads=loads))))[0]["conventions"]), 30)

    def test_axes_in_space_are_right_handed(self):
        model = {"format": "modetune-model/1", "dimension": 3,
                 "bodies": [{"name": "hand", "mass_kg": 1, "inertia_kg_m2": [0.1, 0.1, 0.1], "centre": [1, 0, 0]}],
                 "joints": [dict(HINGE, at=[0, 0, 0], axis=[0, 1, 0])], "springs": [dict(SPRING, preload_n_m=1)]}
        got, text = self.info(model)
        self.assertAlmostEqual(got["centre_m"][2], 0.01, delta=1e-5)  # -0.01 rad about y lifts what lies along x
        self.assertIn('preload_n_m 1 turns "hand" against "ground" against the axis', text)

    def test_gears(self):
        wheel = {"name": "wheel", "mass_kg": 1, "inertia_kg_m2": 0.1, "centre": [3, 0]}
        second = {"name": "axle", "type": "revolute", "bodies": ["ground", "wheel"], "at": [2, 0]}
        gear = {"name": "mesh", "type": "gear", "joints": ["pin", "axle"], "ratio": -2}
        drive = {"x": {"drive": {"joint": "pin", "position_rad": 0.01}}}
        got, text = self.info(dict(PLANE, bodies=PLANE["bodies"] + [wheel], joints=[HINGE, second, gear], configurations=drive))
        self.assertAlmostEqual(got["centre_m"][1], 0.5 * (0.01 - 0.02), delta=1e-5)
        self.assertIn('gear "mesh": "axle" turns -2 times as far as "pin"', text)

    def test_products_are_elements_of_the_tensor(self):
        """Two masses at +-(1, 1, 0) m: the integral of x y is 2 kg m^2, the element of the tensor -2."""
        masses = [{"name": n, "mass_kg": 1, "centre": [s, s, 0]} for n, s in (("a", 1), ("b", -1))]
        model = {"format": "modetune-model/1", "dimension": 3, "bodies": masses}
        body = {"name": "ab", "mass_kg": 2, "inertia_kg_m2": [2, 2, 4, -2, 0, 0], "centre": [0, 0, 0]}
        apart, _ = self.info(model)
        one, text = self.info(dict(model, bodies=[body]))
        for k in ("xx", "yy", "zz", "xy", "xz", "yz"):
            self.assertAlmostEqual(apart["inertia_kg_m2"][k], one["inertia_kg_m2"][k], delta=1e-12)
        self.assertIn('body "ab": inertia xy -2: elements of the tensor, minus the integrals', text)

    def test_sections(self):
        """A cantilever is stiffer by (height / width)^2 in the plane of its height."""
        link = {"name": "l", "kind": "beam", "from": [0, 0, 0], "to": [1, 0, 0], "elements": 2, "density_kg_per_m3": 7850,
                "youngs_modulus_pa": 2e11, "shear_modulus_pa": 8e10, "hinge_axis": [0, 0, 1],
                "section": {"shape": "rectangle", "width_m": 0.01, "height_m": 0.03}}
        model = {"format": "modetune-model/1", "dimension": 3, "links": [link], "sensors": [{"name": "tip", "on": "l", "fraction": 1}],
                 "joints": [{"name": "w", "type": "fixed", "bodies": ["ground", "l.start"], "at": [0, 0, 0]}]}
        _, text = self.info(model)
        self.assertIn('link "l": width_m is along its hinge axis, height_m across it', text)
        modes = self.json_of("modes", "problems/c.json", "--shapes")[0]["modes"]
        shape = [{k.split(".")[-1]: abs(v) for k, v in m["shape"].items()} for m in modes[:2]]
        self.assertGreater(shape[0]["z"], 100 * shape[0]["y"])  # soft along the hinge axis, where it is thin
        self.assertGreater(shape[1]["y"], 100 * shape[1]["z"])
        self.assertAlmostEqual(modes[1]["frequency_hz"] / modes[0]["frequency_hz"], 3, delta=1e-6)

    def test_a_bushing_acts_at_its_second_point(self):
        """A body held at one point: a force at the point of the second body turns nothing there."""
        bushing = {"name": "m", "type": "bushing", "bodies": ["ground", "hand"], "stiffness_n_per_m": [100, 100], "stiffness_n_m_per_rad": 100}
        for at, second in (([1, 0], 1.0), ([0, 0], 0.0), ([[0, 0], [1, 0]], 1.0), ([[1, 0], [0, 0]], 0.0), (None, 1.0)):
            spring = dict(bushing, at=at) if at else bushing
            push = {"name": "l", "on": "hand", "at": [second, 0], "force_n": [0, 1e-3]}
            got, text = self.info(dict(PLANE, joints=[], springs=[spring], loads=[push]))
            self.assertAlmostEqual(got["centre_m"][1], 1e-5, delta=1e-12)  # 1e-3 N / 100 N/m, and no turn
            self.assertIn('carried by "ground"; about the ' + ("point" if at else "centre") + ' of "hand", where its forces act on both', text)

    def test_the_same_is_said_once(self):
        base = dict(PLANE, springs=[dict(SPRING, preload_n_m="p")], parameters={"p": 1})
        base["configurations"] = {"a": {}, "b": {}, "c": {"parameters": {"p": 2}}}
        text = self.expect(0, "info", self.write("problems/c.json", json.dumps(base))).stdout
        self.assertEqual(text.count("conventions"), 2)
        self.assertLess(text.index("preload_n_m 1"), text.index("preload_n_m 2"))
        quiet = self.expect(0, "info", self.write("problems/c.json", json.dumps(PLANE))).stdout
        self.assertNotIn("conventions", quiet)

    def test_a_posture_far_from_the_drawing_comes_first(self):
        """1 N m turns it by 0.01 rad: 17 N m by less than ten degrees, 18 by more."""
        for moment, far in ((17, False), (18, True)):
            model = dict(PLANE, parameters={"k": 100}, gravity_m_per_s2=[0, 0])
            model["springs"] = [dict(SPRING, stiffness_n_m_per_rad="k", preload_n_m=moment)]
            model["bodies"] = [dict(PLANE["bodies"][0], centre=[1e-3, 0])]
            model["sensors"] = [{"name": "tip", "on": "hand", "at": [1, 0]}]
            model["links"] = [{"name": "beam", "kind": "beam", "from": [0, 2], "to": [1, 2], "elements": 1, "youngs_modulus_pa": 2e11,
                               "density_kg_per_m3": 5, "section": {"shape": "circle", "diameter_m": 0.02}}]
            model["joints"] = [HINGE, {"name": "w", "type": "fixed", "bodies": ["ground", "beam.start"], "at": [0, 2]}]
            path = self.write("problems/c.json", json.dumps(model))
            lines = self.expect(0, "modes", path).stdout.splitlines()
            self.assertEqual(lines[1].startswith("  note: it settles far away from the drawing: "), far, lines)
            study = {"format": "modetune-study/1", "model": "../problems/c.json", "variables": [{"parameter": "k", "lower": 99.9, "upper": 101}],
                     "goals": [{"type": "frequency", "mode": 1, "at_least_hz": 0.1}]}
            result = self.json_of("run", self.write("studies/c.json", json.dumps(study)))
            self.assertEqual(result["status_text"].startswith("default: it settles far away from the drawing"), far, result["status_text"])

    def test_axes_of_a_mount(self):
        """By its axes, and by the matrix that these make of k and 4 k."""
        body = {"name": "b", "mass_kg": 2, "inertia_kg_m2": [0.1, 0.2, 0.3], "centre": [0.1, 0, 0.2]}
        space = {"format": "modetune-model/1", "dimension": 3, "parameters": {"a": 0.7}, "gravity_m_per_s2": [0, 0, -9.81], "bodies": [body]}
        mount = {"name": "s", "type": "bushing", "bodies": ["ground", "b"], "at": [0, 0, 0]}
        yy, zz, yz = ("1e4*(1 + 3*sin(a)^2)", "1e4*(1 + 3*cos(a)^2)", "-3e4*sin(a)*cos(a)")
        rows = [["1e4" if i == j else 0 for j in range(6)] for i in range(6)]
        rows[1][1:3], rows[2][1:3] = [yy, yz], [yz, zz]
        lists = {"stiffness_n_per_m": [1e4, 1e4, 4e4], "stiffness_n_m_per_rad": [1e4, 1e4, 1e4]}
        written = [dict(mount, stiffness_matrix=rows), dict(mount, axes={"angles_rad": ["a", 0, 0]}, **lists),
                   dict(mount, axes={"x": [3, 0, 0], "z": [5, "-sin(a)", "cos(a)"]}, **lists)]
        answers = [self.json_of("sensitivity", self.write("problems/c.json", json.dumps(dict(space, springs=[s]))))[0]["modes"] for s in written]
        self.assertIn("along its own axes x (1, 0, 0), y (0, 0.7648, 0.6442), z (0, -0.6442, 0.7648)", self.info(dict(space, springs=[written[1]]))[1])
        for answer in answers[1:]:
            for got, want in zip(answer, answers[0], strict=True):
                self.assertLess(abs(got["frequency_hz"] / want["frequency_hz"] - 1), 1e-12)
                got, want = (m["sensitivities"][0]["hz_per_unit"] for m in (got, want))
                self.assertLess(abs(got - want), 1e-10 + 1e-9 * abs(want))

    def test_a_bearing_that_yields(self):
        """As a carrier made by hand, at rest and driven; the joint tells what it carries."""
        arm = {"name": "arm", "mass_kg": 2, "inertia_kg_m2": [0.1, 0.2, 0.3], "centre": [0.3, 0, 0]}
        pin = {"name": "pin", "type": "revolute", "bodies": ["ground", "arm"], "at": [0, 0, 0], "axis": [0, 1, 0]}
        bearing = [2e5, 3e5, 1e5]  # along x, y, z
        own = {"format": "modetune-model/1", "dimension": 3, "gravity_m_per_s2": [0, 0, -9.81], "bodies": [arm],
               "joints": [dict(pin, compliance={"axes": {"x": [0, 0, 1]}, "stiffness_n_per_m": [1e5, 2e5, 3e5], "loss_factor": 0.1})],
               "springs": [{"name": "s", "type": "torsion", "joint": "pin", "stiffness_n_m_per_rad": 500}],
               "configurations": {"rest": {}, "up": {"drive": {"joint": "pin", "position_rad": 0.4, "hold": {"trim": "s"}}}}}
        carrier = {"name": "carrier", "inertia_kg_m2": [0, 0, 0], "centre": [0, 0, 0]}
        hand = dict(own, bodies=[arm, carrier], joints=[dict(pin, bodies=["carrier", "arm"]), {"name": "o", "type": "orientation", "bodies": ["ground", "carrier"]}],
                    springs=own["springs"] + [{"name": "b", "type": "bushing", "bodies": ["ground", "carrier"], "at": [0, 0, 0], "stiffness_n_per_m": bearing,
                                               "stiffness_n_m_per_rad": [0, 0, 0], "loss_factor": 0.1}])
        answers = [self.json_of("modes", self.write("problems/c.json", json.dumps(model)), "--damped") for model in (own, hand)]
        for got, want in zip(*answers, strict=True):
            for a, b in zip(got["damped_modes"], want["damped_modes"], strict=True):
                for member in ("natural_frequency_hz", "damping_ratio_percent"):
                    self.assertLess(abs(a[member] - b[member]), 1e-11 * abs(b[member]) + 1e-12)
        self.assertIn('joint "pin": yields across its axis', self.info(own)[1])


if __name__ == "__main__":
    main()

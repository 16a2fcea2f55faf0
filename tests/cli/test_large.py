# SPDX-License-Identifier: GPL-3.0-or-later
"""Large models are read, checked and, where they are trees or bear no load, answered in time in proportion to their size. No time is measured: a million elements take hours where
time goes with the square of the size. MT_EVERY=1: a frame that nothing holds, rings of up to 20000 bars, else of 1000, and trees of 20000 bodies, else of 6000."""
import json
import math
import sys

from common_cli import SOURCE, CliTest, main
from suite import EVERY, FEW

sys.path.insert(0, str(SOURCE / "tests/support"))
import large  # noqa: E402

PARTS = 10000 if EVERY else 3000  # written out
TREE = 20000 if EVERY else 6000  # more than dense matrices take
ELEMENTS = 1000000  # the most that a link may have


class Large(CliTest):
    def model_of(self, kind, n):
        return self.write(f"{kind}{n}.json", json.dumps(large.KINDS[kind](n)))

    def test_many_parts_are_checked(self):
        for kind in ("chain", "points"):
            done = self.expect(0, "check", self.model_of(kind, PARTS))
            self.assertIn("ok (model)", done.stdout)

    def test_a_million_elements_are_checked(self):
        for kind in ("link", "beam"):
            done = self.expect(0, "check", self.model_of(kind, ELEMENTS))
            self.assertIn("ok (model)", done.stdout)
            done = self.expect(2, "check", self.model_of(kind, ELEMENTS + 1))
            self.assertIn(f"/links/0/elements: must be a whole number from 1 to {ELEMENTS}", done.stderr)

    def modes(self, model, *options):
        options = options if "--count" in options else ("--count", "all", *options)
        done = self.expect(0, "modes", model, "--format", "json", *options)
        return json.loads(done.stdout)[0]

    def test_the_lowest_modes_are_those_of_all(self):
        for kind in ("link", "beam", "chain"):
            model = self.model_of(kind, 100)
            whole, lowest = self.modes(model), self.modes(model, "--count", "5")
            self.assertEqual((whole["method"], whole["complete_below_hz"]), ("dense", None))
            self.assertEqual((lowest["method"], len(lowest["modes"]), lowest["redundant_constraints"]), ("tree", 5, []))
            self.assertEqual(whole["freedoms"], lowest["freedoms"])
            for i, (one, other) in enumerate(zip(lowest["modes"], whole["modes"])):
                self.assertEqual((one["index"], one["kind"]), (i + 1, "flexible"))
                self.assertLessEqual(abs(one["frequency_hz"] - other["frequency_hz"]),
                                     one["frequency_error_hz"] + other["frequency_error_hz"])
            below = [m["frequency_hz"] for m in whole["modes"] if m["frequency_hz"] < lowest["complete_below_hz"]]
            self.assertGreaterEqual(len(below), 5)
            self.assertLess(lowest["modes"][4]["frequency_hz"], lowest["complete_below_hz"])

    def test_large_ones_are_told_as_such(self):
        done = self.expect(0, "modes", self.model_of("link", 20000), "--count", "3")
        self.assertRegex(done.stdout, r"The lowest modes of a tree of 20000 bodies \(joint coordinates\): \d+ below [0-9.]+ Hz, by count, none missing\.")
        self.assertRegex(done.stdout, r" 1  flexible +0\.559591 ")
        table = self.expect(0, "modes", self.model_of("beam", TREE), "--count", "3", "--format", "csv").stdout.splitlines()
        self.assertEqual(len(table), 4)

    def test_damped_modes_need_no_others(self):
        """A cantilever of 6000 elements with damping beta K has the damping ratios beta omega/2; with a damper in its root, on which nothing else depends, the
        roots of 120 elements are those of all modes."""
        model = {**large.link(TREE), "damping": {"stiffness_s": 1e-3}}
        for mode, damped in zip(*(self.modes(self.write("proportional.json", json.dumps(model)), "--count", "4", "--damped")[k] for k in ("modes", "damped_modes"))):
            self.assertAlmostEqual(damped["natural_frequency_hz"] / mode["frequency_hz"], 1, delta=1e-12)
            self.assertAlmostEqual(damped["damping_ratio_percent"] / (100e-3 * math.pi * mode["frequency_hz"]), 1, delta=1e-9)
        model = {**large.link(120), "dampers": [{"name": "foot", "type": "torsion", "joint": "root", "damping_n_m_s_per_rad": 4.0}]}
        path = self.write("root.json", json.dumps(model))
        whole, few = (self.modes(path, "--count", count, "--damped") for count in ("all", "5"))
        # the damper makes one root real, between the third pair and the fourth
        self.assertEqual((whole["method"], few["method"], [m["index"] for m in few["damped_modes"]]), ("dense", "tree", [1, 2, 3, None, 4, 5]))
        # all roots at once are as good as rounding of the largest leaves them
        rounding = 10 * sys.float_info.epsilon * math.tau * max(m["natural_frequency_hz"] for m in whole["damped_modes"])
        for one, other in zip(few["damped_modes"], whole["damped_modes"]):
            self.assertEqual((one["kind"], one["index"]), (other["kind"], other["index"]))
            self.assertAlmostEqual(one["natural_frequency_hz"] / other["natural_frequency_hz"], 1, delta=1e-9)
            self.assertAlmostEqual(one["decay_per_s"], other["decay_per_s"], delta=rounding)
            self.assertLess(one["natural_frequency_error_hz"], 1e-9 * one["natural_frequency_hz"])
            self.assertIsNone(other["natural_frequency_error_hz"])
        said = self.expect(0, "modes", path, "--count", "5", "--damped").stdout
        self.assertRegex(said, r"by these and \d+ shapes that damping adds; errors below 1e-\d\d of a root\. Real roots above the last one are not sought")

    def test_free_ones_have_rigid_body_modes(self):
        model = large.link(150)
        del model["joints"], model["springs"]
        got = self.modes(self.write("free.json", json.dumps(model)), "--count", "2")
        self.assertEqual((got["method"], got["rigid_body_modes"]), ("tree", 3))
        self.assertEqual([m["kind"] for m in got["modes"]], ["rigid_body"] * 3 + ["flexible"] * 2)
        self.assertEqual([f["kind"] for f in got["facts"]], ["free_motion"])
        # free beam: (4.7300407/l)^2 sqrt(EI/(rho A))/(2 pi)
        self.assertAlmostEqual(got["modes"][3]["frequency_hz"], 4.730040744862704 ** 2 / 6.283185307179586, delta=1e-3)

    def test_what_is_too_large_is_refused_with_the_reason(self):
        model = large.link(6000)
        for options, said in ((("--count", "all"), "ask for the lowest modes only \\(--count\\)"),
                              (("--count", "all", "--damped"), "ask for the lowest modes only \\(--count\\)"),):
            done = self.expect(2, "modes", self.write("large.json", json.dumps(model)), *options)
            self.assertRegex(done.stderr, "6001 bodies are too many for dense matrices; " + said)
        model["parameters"] = {"m": {"value": 1}}
        model["links"][0]["mass_kg"] = "m"
        whole = self.write("large.json", json.dumps(model))
        study = self.write("study.json", json.dumps({
            "format": "modetune-study/1", "name": "Too large", "model": "large.json", "variables": [{"parameter": "m", "lower": 0.5, "upper": 2}],
            "goals": [{"type": "frequency", "configuration": "default", "mode": 1, "target_hz": 0.5}], "objective": {"minimise": "change"}}))
        for command in (("run", study), ("info", whole), ("mac", f"{whole}:default", f"{whole}:default")):
            self.assertIn("6001 bodies are too many for dense matrices, which take 5000", self.expect(2, *command).stderr)
        loop = {**model, "springs": model["springs"] + [{"name": "far", "type": "axial", "bodies": ["ground", "beam.end"], "at": [[1, 1], "tip"],
                                                         "stiffness_n_per_m": 1}]}
        loop = self.write("loop.json", json.dumps(loop))
        done = self.expect(0, "sensitivity", loop, "--count", "2")
        self.assertIn("The lowest modes of a mechanism of 6000 bodies (sparse factor).", done.stdout)
        model = {**large.link(6000), "gravity_m_per_s2": [0, -9.81], "joints": [], "springs": []}
        done = self.expect(2, "modes", self.write("loaded.json", json.dumps(model)), "--count", "3")
        self.assertRegex(done.stderr, r'because "beam\.\d+" is not drawn at rest under its load; nor the sparse one, as without dense matrices no place is found where it settles')

    def test_what_settles_far_from_the_drawing_has_its_lowest_modes_without_the_others(self):
        """A cantilever that its weight bends by sixty degrees: in n elements off by about 1/n^2, and no more than its bound from all modes. Its stiff pins in a
        row are softer than its twentieth mode: the count must not take them for modes."""
        def loaded(n):
            return self.write(f"bent{n}.json", json.dumps({**large.link(n), "gravity_m_per_s2": [0, -9.81]}))
        whole, few, many = (self.modes(loaded(n), *options) for n, options in ((120, ()), (120, ("--count", "20")), (1500, ("--count", "20"))))
        self.assertEqual([m["method"] for m in (whole, few, many)], ["dense", "tree", "tree"])
        self.assertEqual([len(m["modes"]) for m in (few, many)], [20, 20])
        for k, (one, other, fine) in enumerate(zip(few["modes"], whole["modes"], many["modes"])):
            bound = one["omega_squared_error"] + other["omega_squared_error"]
            self.assertLess(abs(one["omega_squared"] - other["omega_squared"]), bound)
            self.assertLess(one["omega_squared_error"], 1e-9 * one["omega_squared"])
            self.assertAlmostEqual(fine["frequency_hz"] / one["frequency_hz"], 1, delta=1e-3 if k < 4 else 0.1)
        for name in ("largest_motion_m", "largest_turn_rad"):
            self.assertAlmostEqual(few["equilibrium"][name] / whole["equilibrium"][name], 1, delta=1e-9)
        self.assertGreater(many["equilibrium"]["largest_turn_rad"], 1)
        if EVERY:  # what is 1/n^2 off, from two that are not so long
            f = [[m["frequency_hz"] for m in self.modes(loaded(n), "--count", "3")["modes"]] for n in (800, 3000)]
            longest = self.modes(loaded(100000), "--count", "3")["modes"]
            for mode, coarse, fine in zip(longest, *f):
                want = fine + (fine - coarse) * (1 / 3000 ** 2 - 1 / 100000 ** 2) / (1 / 800 ** 2 - 1 / 3000 ** 2)
                self.assertAlmostEqual(mode["frequency_hz"] / want, 1, delta=1e-9)
                self.assertLess(mode["omega_squared_error"], 1e-8 * mode["omega_squared"])
        self.assertEqual([d["kind"] for d in few["facts"]], [d["kind"] for d in whole["facts"]])

    def test_frames_and_loops_need_no_tree(self):
        for name, model, rigid in (("frame", large.frame(3, 3, 3, 2), 0), ("free", large.frame(3, 3, 3, 2, clamped=False), 6))[:1 if FEW else 2]:
            model = self.write(f"{name}.json", json.dumps(model))
            whole, lowest = self.modes(model), self.modes(model, "--count", "8")
            self.assertEqual((whole["method"], lowest["method"]), ("dense", "sparse"))
            self.assertEqual([d["freedoms"] for d in (whole, lowest)], [whole["freedoms"]] * 2)
            self.assertEqual((lowest["rigid_body_modes"], len(lowest["modes"])), (rigid, 8 + rigid))
            for one, other in zip(lowest["modes"], whole["modes"]):
                self.assertEqual(one["kind"], other["kind"])
                if one["kind"] == "flexible":
                    self.assertLessEqual(abs(one["frequency_hz"] - other["frequency_hz"]), one["frequency_error_hz"] + other["frequency_error_hz"])
                    self.assertLess(one["frequency_error_hz"], 1e-10 * one["frequency_hz"])
        chain = large.link(100)  # its end in a slot, and in the same once more: an equation follows from another
        chain["joints"] += [{"name": f"tip{i}", "type": "pin-in-slot", "bodies": ["ground", "beam.end"], "at": "tip", "axis": [1, 0]} for i in range(2)]
        model = self.write("loop.json", json.dumps(chain))
        whole, lowest = self.modes(model), self.modes(model, "--count", "4")
        self.assertEqual((lowest["method"], lowest["freedoms"], lowest["redundant_constraints"]), ("sparse", whole["freedoms"], None))
        for one, other in zip(lowest["modes"], whole["modes"]):
            self.assertLessEqual(abs(one["frequency_hz"] - other["frequency_hz"]), one["frequency_error_hz"] + other["frequency_error_hz"])

    def test_rings_of_any_size_are_rings(self):
        """Bending of an inextensible ring, EI = 1000 N m^2, 1 kg/m (Love, section 293): omega_j^2 = EI j^2 (j^2 - 1)^2 / (j^2 + 1), each twice. Bars
        are off by some 1/n^2. A loop of thousands passes its force on through all of them."""
        for n in (150, 6000, 20000) if EVERY else (150, 1000 if FEW else 2000):
            lowest = self.modes(self.model_of("ring", n), "--count", "6")
            self.assertEqual((lowest["method"], lowest["rigid_body_modes"]), ("sparse", 3))
            for i, mode in enumerate(lowest["modes"][3:]):
                j = 2 + i // 2
                closed = math.sqrt(1000 / (j**2 + 1)) * j * (j**2 - 1) / (2 * math.pi)
                self.assertAlmostEqual(mode["frequency_hz"] / closed, 1, delta=10 / n**2)
                self.assertLess(mode["frequency_error_hz"], max(1e-8, 1e-16 * n**2) * closed)  # strains round with n^2

    def test_frames_have_slopes_and_shapes(self):
        model = large.frame(3, 3, 3, 2)
        model["parameters"] = {name: {"value": value} for name, value in (("L", 1), ("E", 2.1e11), ("rho", 7850))}
        model["points"] = {name: [f"{x}*L" for x in at] for name, at in model["points"].items()}
        model["links"][0]["section"].update(outer_diameter_m="0.2*L", inner_diameter_m="0.18*L")  # of all links
        for link in model["links"]:
            link.update(youngs_modulus_pa="E", shear_modulus_pa="E*8/21", density_kg_per_m3="rho")
        frame = self.write("frame.json", json.dumps(model))
        method, slope, _ = self.slopes(frame, "--count", "8")
        self.assertEqual(method, "sparse")
        for name, power in (("L", -1), ("E", 0.5), ("rho", -0.5)):
            for got in slope[name]:
                self.assertAlmostEqual(got, power, delta=1e-9, msg=name)
        whole, lowest = self.modes(frame, "--shapes"), self.modes(frame, "--count", "3", "--shapes")
        self.assertEqual((whole["method"], lowest["method"]), ("dense", "sparse"))
        for one, other in zip(lowest["modes"], whole["modes"]):
            self.assertEqual(one["shape"].keys(), other["shape"].keys())
            sign = 1 if sum(x * other["shape"][name] for name, x in one["shape"].items()) > 0 else -1
            for name, x in one["shape"].items():
                self.assertAlmostEqual(sign * x, other["shape"][name], delta=1e-7 * max(abs(x) for x in other["shape"].values()), msg=name)

    def test_joints_carry_what_springs_near_them_hold(self):
        """Levers whose springs act close to the pivots, each held there once more: k a^2/(m l^2 + J). A joint's force is l/a of what moves the mass."""
        for ratio, error in ((4, 1e-14), (64, 3e-13), (128, 6e-13)):
            model = {"format": "modetune-model/1", "name": "Levers", "dimension": 2, "bodies": [], "joints": [], "springs": []}
            want = []
            for i in range(120):
                length, k = 1 - i / 256, 1000 + i
                arm = length / ratio
                on = ["ground", f"b{i}"]
                model["bodies"].append({"name": on[1], "mass_kg": 1.5, "inertia_kg_m2": 0.03125, "centre": [length, 0]})
                model["joints"] += [{"name": f"j{i}", "type": "revolute", "bodies": on, "at": [0, 0]},
                                    {"name": f"k{i}", "type": "distance", "bodies": on, "at": [[-1, 0], [0, 0]]}]
                model["springs"].append({"name": f"s{i}", "type": "axial", "bodies": on, "at": [[arm, -1], [arm, 0]], "stiffness_n_per_m": k})
                want.append((k * arm ** 2 / (1.5 * length ** 2 + 0.03125)) ** 0.5 / 6.283185307179586)
            got = self.modes(self.write("levers.json", json.dumps(model)), "--count", "40")
            self.assertEqual((got["method"], got["freedoms"]), ("sparse", 120))
            for mode, f in zip(got["modes"], sorted(want)):
                self.assertAlmostEqual(mode["frequency_hz"], f, delta=error * f)
                self.assertLessEqual(abs(mode["frequency_hz"] - f), mode["frequency_error_hz"])

    def hanging(self, n):
        model = {**large.link(n), "gravity_m_per_s2": ["-g", 0],
                 "parameters": {name: {"value": value} for name, value in (("L", 1), ("m", 1), ("g", 9.81), ("aside", 0))}}
        model["points"]["tip"] = ["-L", "aside"]
        model["links"][0].update(stiffness_n_m_per_rad=0, mass_kg="m")
        del model["springs"]
        return self.write("hangs.json", json.dumps(model))

    def test_a_chain_hangs(self):
        got = self.modes(self.hanging(20000), "--count", "3")
        self.assertEqual((got["method"], got["rigid_body_modes"]), ("tree", 0))
        self.assertEqual((got["equilibrium"]["solved"], got["equilibrium"]["iterations"]), (True, 0))
        for mode, zero in zip(got["modes"], (2.404825557695773, 5.520078110286311, 8.653727912911013)):  # of J0
            self.assertAlmostEqual(mode["frequency_hz"], zero / 2 * 9.81 ** 0.5 / 6.283185307179586, delta=1e-7)

    def slopes(self, model, *options):
        """{parameter: [d ln f / d ln p, or df/dp where p is 0, mode by mode]}"""
        got = json.loads(self.expect(0, "sensitivity", model, "--format", "json", *options).stdout)[0]
        out = {}
        for mode in got["modes"]:
            for s in mode["sensitivities"]:
                out.setdefault(s["parameter"], []).append(s["hz_per_unit"] * (s["value"] / mode["frequency_hz"] if s["value"] else 1))
        return got["method"], out, got["modes"]

    def test_sensitivities_of_large_ones_are_powers(self):
        model = large.beam(TREE)
        model["parameters"] = {name: {"value": value} for name, value in (("m", 1), ("E", 1e6), ("I", 1e-6), ("L", 1), ("unused", 3))}
        model["points"]["tip"] = ["L", 0]
        model["links"][0].update(mass_kg="m", youngs_modulus_pa="E", section={"shape": "general", "area_m2": 1, "second_moment_m4": "I"})
        beam = self.write("beam.json", json.dumps(model))
        for path, names, powers in ((beam, "m,E,I,L,unused", (-0.5, 0.5, 0.5, -1.5, 0)), (self.hanging(TREE), "m,g,L", (0, 0.5, -0.5))):
            method, slope, _ = self.slopes(path, "--parameters", names, "--count", "4")
            self.assertEqual(method, "tree")
            for name, power in zip(names.split(","), powers):
                for got in slope[name]:
                    self.assertAlmostEqual(got, power, delta=1e-9, msg=name)
        self.assertIn(f"The lowest modes of a tree of {TREE + 1} bodies (joint coordinates).", self.expect(0, "sensitivity", beam, "--count", "2").stdout)

    def test_what_no_recursion_can_tell_is_left_to_the_dense_way(self):
        chain = large.chain(150)
        chain["parameters"]["gap"] = {"value": 0}
        chain["joints"][70]["at"] = [[70 / 150, 0], [70 / 150, "gap"]]
        for path, parameter in ((self.hanging(150), "aside"), (self.write("gap.json", json.dumps(chain)), "gap")):
            self.assertEqual(self.slopes(path, "--parameters", parameter, "--count", "2")[0], "dense")
            self.assertEqual(self.slopes(path, "--parameters", "m", "--count", "2")[0], "tree")
        done = self.expect(2, "sensitivity", self.hanging(6000), "--parameters", "m,aside")
        self.assertIn('6001 bodies are too many for dense matrices; by parameter "aside" the equilibrium is not the reference position', done.stderr)

    def test_repeated_modes_of_many_have_directional_values(self):
        n = 120
        model = {"format": "modetune-model/1", "name": "Equal oscillators", "dimension": 2, "parameters": {
            "m": {"value": 1}, "k": {"value": 1}, "stiffer": {"value": 0}, "heavier": {"value": 0}},
            "bodies": [{"name": f"b{i}", "mass_kg": "m + heavier" if i == 7 else "m", "centre": [0, i]} for i in range(n)],
            "springs": [{"name": f"s{i}{d}", "type": "axial", "bodies": ["ground", f"b{i}"], "at": [at, [0, i]],
                         "stiffness_n_per_m": 1e3 if d == "y" else "k + stiffer" if i == 11 else "k"}
                        for i in range(n) for d, at in (("x", [1, i]), ("y", [0, i - 0.5]))]}
        method, slope, modes = self.slopes(self.write("equal.json", json.dumps(model)), "--count", "3")
        self.assertEqual((method, [m["repeated"] for m in modes]), ("tree", [True] * 3))
        f = 1 / 6.283185307179586
        for name, want in (("m", [-0.5] * 3), ("k", [0.5] * 3), ("stiffer", [0] * 3), ("heavier", [-f / 2, 0, 0])):
            for got, value in zip(slope[name], want):
                self.assertAlmostEqual(got, value, delta=1e-9, msg=name)

    def test_shapes_of_large_ones(self):
        model = large.beam(TREE)
        model["sensors"] = [{"name": "tip", "on": "beam", "fraction": 1, "directions": ["y"]},
                            {"name": "middle", "on": "beam", "fraction": 0.5, "directions": ["y", "rz"]}]
        got = self.modes(self.write("seen.json", json.dumps(model)), "--count", "2", "--shapes")
        self.assertEqual(got["method"], "tree")
        first = got["modes"][0]["shape"]  # of unit mass: 2 at the tip of a cantilever, whatever the mode
        self.assertAlmostEqual(abs(first["tip.y"]), 2, delta=1e-9)
        self.assertAlmostEqual(first["middle.y"] / first["tip.y"], 0.339523, delta=1e-6)
        for kind in ("link", "beam"):
            small = self.model_of(kind, 100)
            whole, lowest = self.modes(small, "--count", "60", "--shapes"), self.modes(small, "--count", "5", "--shapes")
            self.assertEqual((whole["method"], lowest["method"]), ("dense", "tree"))
            for one, other in zip(lowest["modes"], whole["modes"]):
                self.assertEqual(one["shape"].keys(), other["shape"].keys())
                most = max(abs(x) for x in other["shape"].values())
                sign = 1 if sum(x * other["shape"][name] for name, x in one["shape"].items()) > 0 else -1
                for name, x in one["shape"].items():
                    self.assertAlmostEqual(sign * x, other["shape"][name], delta=1e-7 * most, msg=name)


if __name__ == "__main__":
    main()

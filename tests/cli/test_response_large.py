# SPDX-License-Identifier: GPL-3.0-or-later
"""Responses of large trees, frames and loaded chains by their lowest modes are those of all modes (response/test_large compares random ones), and those of a beam where there are more bodies than dense
matrices take; what they cannot have is refused with its reason."""
import json
import math
import sys

from common_cli import SOURCE, CliTest, main

sys.path.insert(0, str(SOURCE / "tests/support"))
import large  # noqa: E402


class ResponseLarge(CliTest):
    def response(self, model, *options):
        return json.loads(self.expect(0, "response", model, "--format", "json", *options).stdout)[0]

    def both(self, model, *options):
        """By the lowest modes, and by all of them."""
        some = self.response(model, *options)
        whole = self.response(model, *options, "--modes", "1000000")
        self.assertIn("shapes_of_others", some)
        self.assertNotIn("shapes_of_others", whole)
        self.assertEqual(some["modes"] + some["modes_left_out"], whole["modes"])
        return some, whole

    def chain(self, damping):
        chain = large.chain(120)
        chain["sensors"] = [{"name": "tip", "on": "b119", "at": [1, 0], "directions": ["x", "y"]}, {"name": "middle", "on": "b60", "at": [0.5, 0], "directions": ["y"]}]
        chain["damping"] = damping
        return self.write("chain.json", json.dumps(chain))

    def test_a_chain(self):
        options = ("--input", "tip.y", "--measure", "tip.y", "--measure", "middle.y:velocity", "--from", "0.1", "--to", "60", "--points", "100")
        some, whole = self.both(self.chain({"mass_per_s": 2}), *options)
        for one, other in zip(some["responses"], whole["responses"]):
            self.assertEqual([e["kind"] for e in one["extremes"]], [e["kind"] for e in other["extremes"]])
            for a, b in zip(one["extremes"], other["extremes"]):
                self.assertAlmostEqual(a["frequency_hz"] / b["frequency_hz"], 1.0, delta=1e-9)
                self.assertAlmostEqual(a["magnitude"] / b["magnitude"], 1.0, delta=1e-7)

    def test_under_vibration(self):
        model = self.chain({"ratios": [0.02] * 8})
        profile = self.write("profile.json", json.dumps({"format": "modetune-profile/1", "axis": "y", "random": {"psd_g2_per_hz": [[0.5, 0.01], [20, 0.01]]}}))
        some, whole = self.both(model, "--vibration", profile, "--measure", "tip.y:relative_displacement", "--measure", "middle.y:acceleration")
        for one, other in zip(some["responses"], whole["responses"]):
            self.assertAlmostEqual(one["vibration"]["rms"] / other["vibration"]["rms"], 1.0, delta=1e-7)

    def test_more_bodies_than_dense_matrices_take(self):
        link = large.link(5000)
        link["sensors"] = [{"name": "tip", "on": "beam", "fraction": 1, "directions": ["y"]}]
        link["damping"] = {"mass_per_s": 1}
        model = self.write("link.json", json.dumps(link))
        done = self.expect(0, "response", model, "--input", "tip.y", "--measure", "tip.y")
        self.assertRegex(done.stdout, r"By the \d+ lowest of 5000 modes and \d+ shapes of the others\. .* rounding and what is left out are below 1e-\d\d of a value")
        whole = self.response(model, "--input", "tip.y", "--measure", "tip.y")
        # of a clamped beam of unit length, mass and stiffness: w = 1.875104^2, phi(1)^2 = 4, quality w
        peak = whole["responses"][0]["extremes"][0]
        self.assertAlmostEqual(peak["frequency_hz"], 1.8751040687 ** 2 / (2 * math.pi), delta=0.03)
        self.assertAlmostEqual(peak["magnitude"], 4 / 3.516015, delta=0.02)

    def test_frames(self):
        """Clamped, and free: what they differ by is within the errors told, and these are small."""
        for clamped in (True, False):
            frame = large.frame(4, 3, 2, 2, clamped)
            frame["sensors"] = [{"name": "top", "on": "L45", "fraction": 1, "directions": ["x", "z"]}, {"name": "low", "on": "L2", "fraction": 0.5, "directions": ["y"]}]
            model = self.write("frame.json", json.dumps(frame))
            options = ("--input", "top.x", *(("--input", "base.y") if clamped else ()), "--measure", "top.z", "--measure", "low.y:acceleration", "--from", "2", "--to", "30", "--points", "40")
            some, whole = self.both(model, *options)
            for one, other in zip(some["responses"], whole["responses"]):
                at = {f: i for i, f in enumerate(whole["frequencies_hz"])}
                told = []
                for i, f in enumerate(some["frequencies_hz"]):
                    if f in at and one["re"][i] is not None and other["re"][at[f]] is not None:
                        value = complex(other["re"][at[f]], other["im"][at[f]])
                        off = abs(complex(one["re"][i], one["im"][i]) - value)
                        self.assertLessEqual(off, one["error"][i] + other["error"][at[f]])
                        told.append(one["error"][i] / abs(value))
                self.assertGreaterEqual(len(told), 20)
                self.assertLess(sorted(told)[len(told) // 2], 1e-8)

    def test_what_settles_far_from_the_drawing(self):
        """A cantilever that its weight bends by sixty degrees: of 6000 links as of 150, but for 1/n^2."""
        def bent(n):
            tip = {"sensors": [{"name": "tip", "on": "beam", "fraction": 1, "directions": ["x", "y"]}], "damping": {"mass_per_s": 2}}
            return self.write(f"bent{n}.json", json.dumps({**large.link(n), **tip, "gravity_m_per_s2": [0, -9.81]}))
        options = ("--input", "tip.y", "--measure", "tip.x", "--measure", "tip.y", "--from", "0.2", "--to", "10", "--points", "30")
        some, whole = self.both(bent(150), *options)
        fine = self.response(bent(6000), *options)
        self.assertIn("shapes_of_others", fine)
        for one, other, third in zip(some["responses"], whole["responses"], fine["responses"]):
            self.assertEqual([len(r["extremes"]) for r in (one, third)], [len(other["extremes"])] * 2)
            for a, b, c in zip(one["extremes"], other["extremes"], third["extremes"]):
                self.assertAlmostEqual(a["frequency_hz"] / b["frequency_hz"], 1.0, delta=1e-9)
                self.assertAlmostEqual(a["magnitude"] / b["magnitude"], 1.0, delta=1e-7)
                self.assertAlmostEqual(c["frequency_hz"] / b["frequency_hz"], 1.0, delta=1e-3)

    def test_what_needs_all_modes_says_so(self):
        link = large.link(5000)
        link["sensors"] = [{"name": "tip", "on": "beam", "fraction": 1, "directions": ["y"]}]
        model = self.write("link.json", json.dumps(link))
        for options, why in ((("--poles",), "--poles needs all modes"), (("--direct",), "--direct needs all modes"), (("--modes", "5"), "--modes needs all modes"),
                             (("--to", "1e6"), "a response so far up needs more than its 384 lowest modes")):
            done = self.expect(2, "response", model, "--input", "tip.y", *options)
            self.assertIn("5001 bodies are too many for dense matrices", done.stderr)
            self.assertIn(why, done.stderr)
        for more, why in (({"gravity_m_per_s2": [9.81, 0]}, "forces in joints under a load need all modes"),
                          ({"joints": link["joints"] + [{"name": "slot", "type": "pin-in-slot", "bodies": ["ground", "beam.end"], "at": "tip", "axis": [0, 1]}]},
                           "the force of a joint in a loop of joints needs all modes")):
            done = self.expect(2, "response", self.write("more.json", json.dumps({**link, **more})), "--input", "tip.y", "--measure", "joint.root.y")
            self.assertIn(why, done.stderr)

    def test_joints_carry_what_hangs_on_them(self):
        """The root of a cantilever of 1 kg: slowly it carries the force at the tip, or the mass that the ground accelerates."""
        link = large.link(5000)
        link["sensors"] = [{"name": "tip", "on": "beam", "fraction": 1, "directions": ["y"]}]
        done = self.expect(0, "response", self.write("link.json", json.dumps(link)), "--input", "tip.y", "--input", "base.y", "--measure", "joint.root.y",
                           "--from", "0.0005", "--to", "0.001", "--points", "2", "--format", "json")
        for got, want in zip(json.loads(done.stdout)[0]["responses"], (-1.0, 1.0)):
            self.assertAlmostEqual(got["re"][0], want, delta=1e-5)
            self.assertLess(got["error"][0], 1e-6)


if __name__ == "__main__":
    main()

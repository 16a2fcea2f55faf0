# SPDX-License-Identifier: GPL-3.0-or-later
"""Large models are read, checked and, where they are trees, answered in time in proportion to their size. No time is measured: a million elements take hours where
time goes with the square of the size."""
import json
import os
import sys

from common_cli import SOURCE, CliTest, main

sys.path.insert(0, str(SOURCE / "tests/support"))
import large  # noqa: E402

PARTS = 3000 if "MT_INSTRUMENTED" in os.environ else 10000  # written out
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
        self.assertRegex(done.stdout, r"The lowest modes of a tree of 20000 bodies \(sparse\): \d+ below [0-9.]+ Hz, by count, none missing\.")
        self.assertRegex(done.stdout, r" 1  flexible +0\.559591 ")
        table = self.expect(0, "modes", self.model_of("beam", 20000), "--count", "3", "--format", "csv").stdout.splitlines()
        self.assertEqual(len(table), 4)

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
        for options, said in (((), "ask for the lowest modes alone, without shapes and dampers \\(--count\\)"),
                              (("--count", "3", "--shapes"), "ask for the lowest modes alone"),):
            done = self.expect(2, "modes", self.write("large.json", json.dumps(model)), *options)
            self.assertRegex(done.stderr, "6001 bodies are too many for dense matrices; " + said)
        model["springs"].append({"name": "far", "type": "axial", "bodies": ["ground", "beam.end"], "at": [[1, 1], "tip"],
                                 "stiffness_n_per_m": 1})
        done = self.expect(2, "modes", self.write("loop.json", json.dumps(model)), "--count", "3")
        self.assertRegex(done.stderr, r'the way for large trees is not open, as \w+ "[\w.]+" is part of a loop')
        model = {**large.link(6000), "gravity_m_per_s2": [0, -9.81]}
        done = self.expect(2, "modes", self.write("loaded.json", json.dumps(model)), "--count", "3")
        self.assertRegex(done.stderr, r'as "beam\.\d+" is not drawn at rest under its load')

    def test_a_chain_hangs(self):
        model = {**large.link(20000), "gravity_m_per_s2": [-9.81, 0]}
        model["points"]["tip"] = [-1, 0]
        model["links"][0]["stiffness_n_m_per_rad"] = 0
        del model["springs"]
        got = self.modes(self.write("hangs.json", json.dumps(model)), "--count", "3")
        self.assertEqual((got["method"], got["rigid_body_modes"]), ("tree", 0))
        self.assertEqual((got["equilibrium"]["solved"], got["equilibrium"]["iterations"]), (True, 0))
        for mode, zero in zip(got["modes"], (2.404825557695773, 5.520078110286311, 8.653727912911013)):  # of J0
            self.assertAlmostEqual(mode["frequency_hz"], zero / 2 * 9.81 ** 0.5 / 6.283185307179586, delta=1e-7)


if __name__ == "__main__":
    main()

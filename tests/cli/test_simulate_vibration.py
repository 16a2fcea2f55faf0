# SPDX-License-Identifier: GPL-3.0-or-later
"""simulate --vibration: a realisation of a profile has its RMS, and moves a mechanism as response says; numbers in the model's units.
MT_EVERY=1: three realisations, and a chain's outputs one by one."""
import json
import math
import unittest

import numpy

from common_cli import SOURCE, CliTest, main
from suite import EVERY
from common_shaken import G, chain, one_mass

PENDULUM = SOURCE / "tests/models/pendulum.json"


class Vibration(CliTest):
    def profile(self, **members):
        return self.write("p.json", json.dumps({"format": "modetune-profile/1"} | members))

    def moved(self, *args):
        return self.json_of("simulate", *args, "-c", "default", "--quiet")

    def test_a_realisation_has_the_rms_that_response_says(self):
        """Mean squares over a time T differ by about 1/sqrt(2 pi zeta f T) of them, of the RMS by half of that; 3 of these."""
        profile = self.profile(axis="x", random=[{"psd_g2_per_hz": [[4, 0.01], [20, 0.04], [20, 0.01], [60, 0.002]]}, {"psd_m2_per_s3": [[8, 1], [12, 1]]}])
        zeta, hz, begin, end = 0.05, 12.0, 1.0, 21.0
        model = self.write("one.json", json.dumps(one_mass(zeta, hz)))
        said = self.json_of("response", model, "-c", "default", "--vibration", profile, "--quiet")
        rms = said["responses"][0]["vibration"]["rms"]
        sigma = 0.5 / math.sqrt(2 * math.pi * zeta * hz * (end - begin))
        realised = set()
        seeds = ("1", "2", "3")[:3 if EVERY else 1]
        for seed in seeds:
            got = self.moved(model, "--vibration", profile, "--seed", seed, "--duration", str(end), "--dt-out", "0.002", "--measure", "a.x:acceleration",
                             "--tolerance", "1e-8")
            found = numpy.array(got["outputs"][0]["values"])[int(begin / 0.002):]
            self.assertLess(abs(math.sqrt(numpy.mean(found ** 2)) / rms - 1), 3 * sigma, seed)
            self.assertLess(abs(got["vibration"]["realised_rms_m_per_s2"] / said["profile"]["rms_m_per_s2"] - 1), 0.02)
            realised.add(got["vibration"]["realised_rms_m_per_s2"])
        self.assertEqual(len(realised), len(seeds))

    @unittest.skipUnless(EVERY, "simulates for seconds: MT_EVERY=1")
    def test_a_chain_agrees_output_by_output(self):
        model, _, _, _ = chain(5, 4)
        for entry in model["dampers"]:
            entry["damping_n_s_per_m"] *= 10
        path = self.write("chain.json", json.dumps(model))
        profile = self.profile(axis="x", random={"psd_m2_per_s3": [[0.3, 2], [40, 2]]})
        outputs = [word for i in range(4) for word in ("--measure", f"b{i}.x:acceleration")]
        said = self.json_of("response", path, "-c", "default", "--vibration", profile, *outputs)
        got = self.moved(path, "--vibration", profile, "--duration", "45", "--dt-out", "0.005", "--tolerance", "1e-7", *outputs)
        for a, b in zip(said["responses"], got["outputs"]):
            rms = math.sqrt(numpy.mean(numpy.array(b["values"])[1000:] ** 2))
            self.assertLess(abs(rms / a["vibration"]["rms"] - 1), 0.15, b["port"])  # 3 of 0.5/sqrt(2 pi 0.05 2 40)

    def test_tones_are_what_they_say(self):
        model = self.write("one.json", json.dumps(one_mass(0.3, 50.0)))
        still = self.profile(tones=[{"frequency_hz": [5, 5], "acceleration_g": 1.5}])
        got = self.moved(model, "--vibration", f"base.x={still}", "--duration", "1", "--dt-out", "0.01", "--measure", "a.x")
        same = self.moved(model, "--sine", f"base.x={1.5 * G!r}@5", "--duration", "1", "--dt-out", "0.01", "--measure", "a.x")
        self.assertEqual(got["outputs"][0]["values"], same["outputs"][0]["values"])
        self.assertEqual(got["vibration"]["port"], "base.x")
        wide = self.profile(axis="x", tones=[{"frequency_hz": [5, 9], "acceleration_g": 1.5}])
        got = self.moved(model, "--vibration", wide, "--duration", "1", "--dt-out", "0.01", "--measure", "a.x")
        same = self.moved(model, "--sine-sweep", f"base.x={1.5 * G!r}@5:9", "--duration", "1", "--dt-out", "0.01", "--measure", "a.x")
        self.assertEqual(got["outputs"][0]["values"], same["outputs"][0]["values"])
        text = self.expect(0, "simulate", model, "--vibration", "base.x=gevs_qualification", "--duration", "0.05").stdout
        self.assertRegex(text, r"base.x is shaken by GEVS, qualification: random parts of 1\d\.\d+ g RMS in this realisation \(seed 1\), 14.136 g in the profile")

    def test_wrong_use_is_named(self):
        model = self.write("one.json", json.dumps(one_mass(0.3, 50.0)))
        profile = self.profile(random={"psd_m2_per_s3": [[0.3, 2], [40, 2]]})
        for args, said in ((["--vibration", profile], "names no axis: name an input, base.x"),
                           (["--vibration", f"base.z={profile}"], 'no input is called "base.z"'),
                           (["--vibration", f"base.x:velocity={profile}"], '"base.x:velocity" is none'),
                           (["--vibration", "base.x=white"], "more than 100000 lines would be needed"),
                           (["--vibration", "base.x=whit"], 'no profile is called "whit"')):
            with self.subTest(args=args):
                self.assertIn(said, self.expect(2, "simulate", model, "--duration", "1", *args).stderr)

    def test_numbers_are_in_the_models_units(self):
        model = json.loads(PENDULUM.read_text(encoding="utf-8"))
        degrees = self.write("degrees.json", json.dumps(model | {"units": {"angle": "deg"}}))
        asked = ("-c", "hanging", "--duration", "0.2", "--measure", "pivot")
        for option, plain, there in (("--start", "0.3", "0.3"), ("--rate", "1", "1"), ("--start", "30*deg", "30*deg")):
            own = self.json_of("simulate", str(PENDULUM), option, f"pivot={plain}", *asked)
            if plain[-1] != "g":
                there = repr(math.degrees(float(plain)))
            other = self.json_of("simulate", degrees, option, f"pivot={there}", *asked)
            for a, b in zip(own["outputs"][0]["values"], other["outputs"][0]["values"]):
                self.assertAlmostEqual(a, b, places=13)
        own = self.json_of("simulate", str(PENDULUM), "--sine", "pivot=0.1@2", *asked)
        other = self.json_of("simulate", degrees, "--sine", f"pivot={math.degrees(0.1)!r}@2", *asked)
        for a, b in zip(own["outputs"][0]["values"], other["outputs"][0]["values"]):
            self.assertAlmostEqual(a, b, places=13)


if __name__ == "__main__":
    main()

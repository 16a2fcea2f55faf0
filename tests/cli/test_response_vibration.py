# SPDX-License-Identifier: GPL-3.0-or-later
"""response --vibration: closed forms, Lyapunov's equation and SciPy's quadrature, with poles and without; refusals in words."""
import csv
import io
import json
import math

import numpy
from scipy import integrate
from scipy.linalg import solve_continuous_lyapunov

from common_cli import SOURCE, CliTest, main
from common_shaken import G, chain, one_mass

SINE_ON_RANDOM = {"axis": "x", "random": {"psd_g2_per_hz": [[5, 0.001], [60, 0.02], [60, 0.01], [400, 0.001]]},
                  "tones": [{"frequency_hz": [14, 19], "acceleration_g": 1.5}, {"frequency_hz": [70, 75], "acceleration_m_per_s2": 5},
                            {"frequency_hz": [30, 30], "acceleration_g": 0.2}]}


def one(zeta, hz):
    return json.dumps(one_mass(zeta, hz))


class Vibration(CliTest):
    def profile(self, **members):
        return self.write("p.json", json.dumps({"format": "modetune-profile/1"} | members))

    def shaken(self, *args):
        return self.json_of("response", *args, "-c", "default", "--quiet")

    def test_white_noise_has_its_closed_form(self):
        profile = self.profile(axis="x", random={"psd_m2_per_s3": [[1e-9, 0.3], [1e9, 0.3]]})
        for zeta, hz in ((0.03, 22.09), (0.2, 7.0), (0.7, 300.0)):
            with self.subTest(zeta=zeta):
                found = self.shaken(self.write("one.json", one(zeta, hz)), "--vibration", profile)["responses"][0]["vibration"]
                beyond = 4 * (zeta * hz) ** 2 / 1e9  # of the band, to first order
                want = math.sqrt((math.pi / 2 * hz / (2 * zeta) * (1 + 4 * zeta ** 2) - beyond) * 0.3)
                self.assertLessEqual(abs(found["rms"] / want - 1), 1e-9)
                self.assertLessEqual(found["rms_error_at_most"], 1e-9 * want)
                self.assertLessEqual(abs(found["peak"] / (3 * found["rms"]) - 1), 1e-15)
                self.assertAlmostEqual(found["rms_g"] * G, found["rms"], delta=1e-14 * want)

    def test_the_bound_holds_next_to_an_undamped_pole(self):
        """Where the rounding of the pole itself decides; and it is no larger than that."""
        profile = self.profile(axis="x", random={"psd_m2_per_s3": [[1e-9, 0.3], [1e9, 0.3]]})
        for power in range(-40, -5):
            zeta, hz = 10 ** (power / 4), 22.09
            found = self.shaken(self.write("one.json", one(zeta, hz)), "--vibration", profile)["responses"][0]["vibration"]
            outside = 4 * (zeta * hz) ** 2 / 1e9 + 1e-9
            want = math.sqrt((math.pi / 2 * hz / (2 * zeta) * (1 + 4 * zeta ** 2) - outside) * 0.3)
            self.assertLessEqual(abs(found["rms"] - want), found["rms_error_at_most"] + 1e-15 * want, zeta)
            self.assertLessEqual(found["rms_error_at_most"], (2e-11 + 2e-15 / zeta) * want, zeta)

    def test_the_bound_holds_where_damping_couples_modes(self):
        """The same chain with all forces times 3: two computations of one number, which whole numbers times powers of 2 leave exact."""
        profile = self.profile(axis="x", random={"psd_m2_per_s3": [[1e-3, 0.3], [1e3, 0.3]]})
        differ = 0
        for power in range(-36, -8, 2):
            rms = []
            for times in (1, 3, 5, 7):
                model, *_ = chain(1, 4)
                for i, body in enumerate(model["bodies"]):
                    body["mass_kg"] = times * (1 + i)
                for i, spring in enumerate(model["springs"]):
                    spring["stiffness_n_per_m"] = times * (100 + 37 * i)
                for i, damper in enumerate(model["dampers"]):
                    damper["damping_n_s_per_m"] = times * (1 + i * i) * 2.0 ** power
                path = self.write("chain.json", json.dumps(model))
                found = self.shaken(path, "--vibration", profile, "--measure", "b2.x:relative_displacement")["responses"][0]["vibration"]
                rms.append((found["rms"], found["rms_error_at_most"]))
            for a, error in rms:
                for b, other in rms:
                    self.assertLessEqual(abs(a - b), error + other, power)
                    differ += abs(a - b) > 1e-11 * a
                self.assertLessEqual(error, (1e-9 + 1e-12 * 2.0 ** -power) * a)
        self.assertGreater(differ, 0, "rounding of the poles is not seen here")

    def test_a_chain_has_the_variances_of_lyapunov(self):
        profile = self.profile(axis="x", random={"psd_m2_per_s3": [[1e-9, 2.0], [1e9, 2.0]]})
        for seed, n in ((1, 3), (2, 6), (3, 12)):
            model, m, c, k = chain(seed, n)
            outputs = [word for i in range(n) for word in ("--measure", f"b{i}.x:relative_displacement", "--measure", f"b{i}.x:relative_velocity")]
            got = self.shaken(self.write("chain.json", json.dumps(model)), "--vibration", profile, *outputs)
            inverse = numpy.linalg.inv(m)
            a = numpy.block([[numpy.zeros((n, n)), numpy.eye(n)], [-inverse @ k, -inverse @ c]])
            b = numpy.concatenate([numpy.zeros(n), -numpy.ones(n)])[:, None]
            p = solve_continuous_lyapunov(a, -b @ b.T * 2.0 / 2)  # one-sided 2.0 per Hz: two-sided 1.0, of intensity 1.0
            for i in range(n):
                for entry, want in ((got["responses"][2 * i], p[i, i]), (got["responses"][2 * i + 1], p[n + i, n + i])):
                    found = entry["vibration"]
                    self.assertLessEqual(abs(found["rms"] / math.sqrt(want) - 1), 1e-8, (seed, entry["output"]))
                    self.assertNotIn("rms_g", found)

    def test_sine_on_random_is_scipys_with_poles_and_without(self):
        for rule in ("sum", "largest", "root_sum_square"):
            profile = self.profile(**SINE_ON_RANDOM, combine={"sigma": 2.5, "tones": rule})
            for zeta, method in ((0.03, "poles"), (1.0, "quadrature")):
                got = self.shaken(self.write("one.json", one(zeta, 17.0)), "--vibration", profile)
                self.assertEqual(got["vibration_method"], method)
                found = got["responses"][0]["vibration"]
                def size(f):
                    r = f / 17.0
                    return abs((1 + 2j * zeta * r) / (1 - r * r + 2j * zeta * r))
                def density(f):
                    points = [(5, 0.001), (60, 0.02)] if f < 60 else [(60, 0.01), (400, 0.001)]
                    (a, ga), (b, gb) = points
                    return ga * (f / a) ** (math.log(gb / ga) / math.log(b / a)) * G * G
                parts = [integrate.quad(lambda f: size(f) ** 2 * density(f), a, b, points=[17.0] if a < 17 < b else None, epsabs=0, epsrel=1e-12,
                                        limit=400)[0] for a, b in ((5, 60), (60, 400))]
                rms = math.sqrt(sum(parts))
                self.assertLessEqual(abs(found["rms"] - rms), found["rms_error_at_most"] + 1e-10 * rms)
                self.assertLessEqual(found["rms_error_at_most"], 1e-10 * rms)
                resonance = 17 * math.sqrt(math.sqrt(1 + 8 * zeta ** 2) - 1) / (2 * zeta)
                top = [1.5 * G * size(min(max(resonance, 14), 19)), 5 * size(70), 0.2 * G * size(30)]
                for tone, want in zip(found["tones"], top):
                    self.assertLessEqual(abs(tone["peak"] - want), 1e-10 * want, (zeta, tone))
                    self.assertEqual(tone["excess_at_most"] is None, method == "quadrature")
                sine = {"sum": sum(top), "largest": max(top), "root_sum_square": math.hypot(*top)}[rule]
                self.assertLessEqual(abs(found["peak"] - (2.5 * rms + sine)), 1e-9 * found["peak"])
                self.assertEqual(got["profile"]["combine"], {"sigma": 2.5, "tones": rule})
                for f, psd in zip(got["frequencies_hz"], got["responses"][0]["psd"]):
                    if abs(f - 60) > 1e-6 and 5.001 < f < 399.999:
                        self.assertLessEqual(abs(psd - size(f) ** 2 * density(f)), 1e-10 * psd, (f, psd))

    def test_tones_have_their_largest_response_within_or_at_either_end(self):
        """Critically damped, where there is no sum over poles: |H|^2 = (1 + 4 r^2) / (1 + r^2)^2, greatest at r^2 = 1/2."""
        ranges = [[8, 16], [12, 12.1], [5, 9], [20, 30], [12, 400], [1, 12.02]]
        profile = self.profile(axis="x", tones=[{"frequency_hz": r, "acceleration_m_per_s2": 2} for r in ranges])
        got = self.shaken(self.write("one.json", one(1.0, 17.0)), "--vibration", profile)
        self.assertEqual(got["vibration_method"], "quadrature")
        tones = got["responses"][0]["vibration"]["tones"]
        for (low, high), tone in zip(ranges, tones, strict=True):
            r2 = (min(max(17 / math.sqrt(2), low), high) / 17) ** 2
            want = 2 * math.sqrt((1 + 4 * r2) / (1 + r2) ** 2)
            self.assertLessEqual(abs(tone["peak"] - want), 1e-10 * want, tone)
            self.assertLessEqual(abs(tone["frequency_hz"] / 17 - math.sqrt(r2)), 1e-4, tone)

    def test_every_form_says_the_same(self):
        profile = self.profile(**SINE_ON_RANDOM)
        model = self.write("one.json", one(0.05, 17.0))
        asked = ("response", model, "--vibration", profile, "--points", "9")
        got = self.json_of(*asked, "-c", "default")
        self.assertEqual((got["inputs"][0]["name"], got["outputs"][0]["name"]), ("base.x:acceleration", "a.x:acceleration"))
        rows = list(csv.DictReader(io.StringIO(self.expect(0, *asked, "--format", "csv").stdout)))
        self.assertEqual([float(r["psd"]) for r in rows], got["responses"][0]["psd"])
        self.assertEqual({r["psd_unit"] for r in rows}, {"(m/s^2)^2/Hz"})
        self.assertEqual((got["frequencies_hz"][0], got["frequencies_hz"][-1]), (5, 400))
        narrow = self.json_of(*asked, "-c", "default", "--from", "10", "--to", "20")
        self.assertEqual(narrow["responses"][0]["vibration"], got["responses"][0]["vibration"])
        text = self.expect(0, *asked).stdout
        self.assertIn("the peak is 3 times the RMS\nand the sum of all tones", text)
        self.assertIn(f'{got["responses"][0]["vibration"]["rms"]:.5g}'[:5], text)
        self.assertIn("proven up to that part of it", text)
        both = self.json_of(*asked, "-c", "default", "--input", "base.x", "--input", "base.y")
        self.assertEqual(both["responses"][0]["vibration"], got["responses"][0]["vibration"])
        self.assertEqual(both["responses"][1]["vibration"]["rms"], 0)

    def test_all_accelerations_are_looked_at(self):
        got = self.json_of("response", str(SOURCE / "problems/inceptor.json"), "-c", "installed", "--input", "base.y", "--vibration", "gevs_qualification")
        self.assertTrue(all(o["name"].endswith(":acceleration") for o in got["outputs"]))
        self.assertEqual(got["profile"]["name"], "GEVS, qualification")

    def test_what_is_infinite_or_grows_names_its_mode(self):
        profile = self.profile(**SINE_ON_RANDOM)
        free = self.write("one.json", one(0, 17.0))
        text = self.expect(0, "response", free, "--vibration", profile).stdout
        self.assertIn("Vibration mode 1, 17 Hz, has no damping, and the profile acts there", text)
        found = self.shaken(free, "--vibration", profile)["responses"][0]["vibration"]
        self.assertEqual((found["end"], found["rms"], found["peak"], found["by_mode"]), ("infinite", None, None, 1))
        away = self.shaken(self.write("one.json", one(0, 900.0)), "--vibration", profile)["responses"][0]["vibration"]
        self.assertEqual(away["end"], "finite")

    def test_what_is_assumed_is_said(self):
        model = self.write("one.json", one(0.05, 17.0))
        asked = ("response", model, "--input", "base.x", "--vibration", "helicopter_uh60_panel")
        text = self.expect(0, *asked).stdout
        self.assertIn("Of the profile is assumed, or unconfirmed:\n  - the density from 10 to 500 Hz is assumed", text)
        self.assertEqual(len(self.json_of(*asked, "-c", "default")["profile"]["marks"]), 6)

    def test_wrong_use_is_named(self):
        model = self.write("one.json", one(0.05, 17.0))
        no_axis = self.profile(random=SINE_ON_RANDOM["random"])
        upright = self.write("z.json", json.dumps({"format": "modetune-profile/1", "axis": "z", "random": SINE_ON_RANDOM["random"]}))
        for args, said in ((["--vibration", no_axis], "names no axis: name an input, base.x"),
                           (["--vibration", upright], "is along z, and the mechanism is plane"),
                           (["--vibration", no_axis, "--input", "a.x"], '"a.x" is none'),
                           (["--vibration", no_axis, "--input", "base.x:velocity"], '"base.x:velocity" is none'),
                           (["--vibration", no_axis, "--input", "base.q"], 'no input is called "base.q"'),
                           (["--vibration", "whit", "--input", "base.x"], 'no profile is called "whit"; did you mean "white"?'),
                           (["--vibration", model, "--input", "base.x"], "modetune-profile/1"),
                           (["--vibration", no_axis, "--vibration", no_axis], "--vibration is given twice"),
                           ([], "needs --input, what shakes the mechanism, or --vibration, a profile")):
            with self.subTest(args=args):
                self.assertIn(said, self.expect(2, "response", model, *args).stderr)


if __name__ == "__main__":
    main()

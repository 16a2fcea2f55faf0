# SPDX-License-Identifier: GPL-3.0-or-later
"""profile: what a file says comes out in every form; what it does to one mass agrees with sums over fine grids and with closed forms."""
import csv
import io
import json
import math

import numpy

from common_cli import SOURCE, CliTest, main

G = 9.80665
WHITE = {"format": "modetune-profile/1", "random": {"psd_g2_per_hz": [[1e-3, 0.02], [1e7, 0.02]]}}
TONES = {"format": "modetune-profile/1", "name": "tones", "axis": "y",
         "tones": [{"frequency_hz": [16, 19], "acceleration_g": 1.5, "origin": "assumed", "source": "a guess"},
                   {"rotor": {"speed_rpm": 258, "blades": 4, "harmonics": ["2nP"], "speed_range": [0.95, 1.05]}, "acceleration_m_per_s2": 20}]}


def transmissibility(f, natural, zeta):
    x = f / natural
    return numpy.sqrt((1 + (2 * zeta * x) ** 2) / ((1 - x * x) ** 2 + (2 * zeta * x) ** 2))


def density(points, f):
    """At each of f: of the first part that holds it."""
    out, left = numpy.zeros_like(f), numpy.ones(len(f), dtype=bool)
    for (a, x), (b, y) in zip(points, points[1:]):
        if a < b:
            here = left & (a <= f) & (f <= b)
            out[here] = x * (f[here] / a) ** (math.log(y / x) / math.log(b / a))
            left &= ~here
    return out


class Profile(CliTest):
    def put(self, profile, name="p.json"):
        return self.write(name, json.dumps(profile))

    def masses(self, path, *args):
        return self.json_of("profile", path, *args)["spectrum"]["masses"]

    def test_white_noise_gives_miles_equation(self):
        path = self.put(WHITE)
        for zeta in (0.5, 0.05, 1e-3, 1e-6):
            for m in self.masses(path, "--spectrum", "5:80:3", "--damping-ratio", repr(zeta)):
                with self.subTest(zeta=zeta, hz=m["natural_frequency_hz"]):
                    want = math.sqrt(math.pi / 2 * m["natural_frequency_hz"] / (2 * zeta) * 0.02 * (1 + 4 * zeta * zeta))
                    self.assertLess(abs(m["rms_g"] / want - 1), 3e-4 if zeta == 0.5 else 1e-5)  # the band ends somewhere
                    self.assertAlmostEqual(m["peak_g"], 3 * m["rms_g"], delta=1e-13 * m["peak_g"])
                    self.assertLess(m["rms_error_at_most"], 1e-11 * m["rms"])

    def test_shipped_profiles_agree_with_sums(self):
        listed = [p["name"] for p in self.json_of("profile")]
        self.assertEqual(listed, sorted(p.stem for p in (SOURCE / "problems/profiles").glob("*.json")))
        for name in listed:
            if name == "white":
                continue
            got = self.json_of("profile", name, "--spectrum", "40:40:1", "--damping-ratio", "0.1")
            points = [(p["frequency_hz"], p["psd_g2_per_hz"]) for p in got["random"][0]["breakpoints"]]
            n = 200000
            lower, upper = points[0][0], points[-1][0]
            step = math.log(upper / lower) / n
            f = lower * numpy.exp((numpy.arange(n) + 0.5) * step)
            g = density(points, f) * f * step
            input_, output = g.sum(), (g * transmissibility(f, 40, 0.1) ** 2).sum()
            with self.subTest(name):
                self.assertLess(abs(got["rms_g"] / math.sqrt(input_) - 1), 1e-6)
                self.assertLess(abs(got["spectrum"]["masses"][0]["rms_g"] / math.sqrt(output) - 1), 1e-6)
                if got["random"][0]["published_rms_g"] is not None:
                    self.assertLess(abs(got["rms_g"] / got["random"][0]["published_rms_g"] - 1), 0.01)
                self.assertEqual(bool(got["marks"]), name not in ("gevs_qualification", "white"))

    def test_tones_peak_within_their_ranges(self):
        path = self.put(TONES)
        for natural in (10, 17.2, 18.9, 33, 35, 80):
            (m,) = self.masses(path, "--spectrum", f"{natural}:{natural}:1", "--damping-ratio", "0.02")
            for tone, (lower, upper, level) in zip(m["tones"], ((16, 19, 1.5 * G), (34.4 * 0.95, 34.4 * 1.05, 20))):
                most = max(level * transmissibility(lower + (upper - lower) * numpy.arange(20001) / 20000, natural, 0.02))
                with self.subTest(natural=natural, tone=tone["tone"]):
                    self.assertGreaterEqual(tone["peak"] * (1 + 1e-12), most)
                    self.assertLess(tone["peak"] / most - 1, 1e-6)
                    self.assertLess(tone["excess_at_most"], 1e-10)
                    self.assertEqual(tone["at_edge"], tone["frequency_hz"] in (lower, upper) or not lower + 1e-9 < tone["frequency_hz"] < upper - 1e-9)
            self.assertAlmostEqual(m["sine"], sum(t["peak"] for t in m["tones"]), delta=1e-12)
            self.assertEqual(m["peak"], m["sine"])

    def test_every_form_says_the_same(self):
        path = self.put(TONES)
        got = self.json_of("profile", path)
        self.assertEqual([t["tone"] for t in got["tones"]], ["16 to 19 Hz", "2nP of rotor"])
        self.assertEqual((got["axis"], got["random"], got["combine"]), ("y", [], {"sigma": 3, "tones": "sum"}))
        self.assertEqual(got["marks"], ["the level of 16 to 19 Hz is assumed (a guess)"])
        rows = list(csv.DictReader(io.StringIO(self.expect(0, "profile", path, "--format", "csv").stdout)))
        self.assertEqual([(r["part"], r["name"], float(r["from_hz"]), float(r["acceleration_g"])) for r in rows],
                         [("tone", t["tone"], t["lower_hz"], t["acceleration_g"]) for t in got["tones"]])
        done = self.expect(0, "profile", path)
        self.assertIn("tones, along y", done.stdout)
        self.assertRegex(done.stdout, r"16 to 19 Hz +16\.0+ +19\.0+ +1\.50* +14\.71")
        self.assertIn("warning: /tones/0: the level of 16 to 19 Hz is assumed (a guess)", done.stderr)
        spectrum = list(csv.DictReader(io.StringIO(self.expect(0, "profile", path, "--spectrum", "5:500:5", "--format", "csv").stdout)))
        self.assertEqual([float(r["natural_frequency_hz"]) for r in spectrum], [m["natural_frequency_hz"] for m in self.masses(path, "--spectrum", "5:500:5")])

    def test_rules_combine_as_they_say(self):
        peaks = {}
        for rule in ("sum", "largest", "root_sum_square"):
            for sigma in (0, 2):
                path = self.put({**TONES, **{"random": WHITE["random"]}, "combine": {"sigma": sigma, "tones": rule}})
                (m,) = self.masses(path, "--spectrum", "20:20:1")
                a = [t["peak"] for t in m["tones"]]
                want = {"sum": sum(a), "largest": max(a), "root_sum_square": math.hypot(*a)}[rule]
                self.assertAlmostEqual(m["sine"], want, delta=1e-12 * want)
                self.assertAlmostEqual(m["peak"], sigma * m["rms"] + want, delta=1e-12 * m["peak"])
                peaks[rule, sigma] = m["peak"]
        self.assertEqual(len(set(peaks.values())), 6)

    def test_wrong_use_is_explained(self):
        self.put(WHITE)
        for args, text in ((("gevs",), 'no profile is called "gevs"'), (("gevs_qualificaton",), 'did you mean "gevs_qualification"?'),
                           (("p.json", "--spectrum", "3"), "is not FROM:TO:N"), (("p.json", "--spectrum", "3:2:4"), "is not FROM:TO:N"),
                           (("p.json", "--spectrum", "2:3:nan"), "is not FROM:TO:N"), (("p.json", "--spectrum", "1:2:99999"), "is not FROM:TO:N"),
                           (("p.json", "--spectrum", "1:2:3:4"), "is not FROM:TO:N"),
                           (("p.json", "--damping-ratio", "1"), "is not a number between 0 and 1"),
                           (("p.json", "--damping-ratio", "x"), "is not a number between 0 and 1")):
            with self.subTest(args):
                self.assertIn(text, self.expect(2, "profile", *args).stderr)
        self.expect(4, "profile", "none.json")
        self.expect(2, "profile", str(SOURCE / "problems/aircraft.json"))
        self.write("white", json.dumps(TONES))  # a file of that name comes first
        self.assertIn("tones, along y", self.expect(0, "profile", "white").stdout)


if __name__ == "__main__":
    main()

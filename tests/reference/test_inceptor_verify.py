# SPDX-License-Identifier: GPL-3.0-or-later
"""`modetune run --verify` on the paper's inceptor: every study holds, says what it must, and notices a wrong number."""
import json
import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

TREE = Path(os.environ["SOURCE_DIR"])
PROGRAM = os.environ["MODETUNE"]
# published entries and expected status of each
STUDIES = {"inceptor_prediction": (10, "fitted"), "inceptor_identification": (12, "solved"), "inceptor_stick": (6, "solved"),
           "inceptor_stick_mac": (6, "solved"), "inceptor_tuning_1": (7, "solved"), "inceptor_tuning_2": (7, "solved"),
           "inceptor_tuning_3": (5, "compromise")}


class Inceptor(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.answers = {}
        cls.place = Path(tempfile.mkdtemp())
        cls.addClassCleanup(shutil.rmtree, cls.place, ignore_errors=True)
        for part in ("problems", "studies"):
            shutil.copytree(TREE / part, cls.place / part)
        for name in STUDIES:
            cls.answers[name] = cls.run_study(name)

    @classmethod
    def run_study(cls, name):
        """Exit status and result."""
        done = subprocess.run([PROGRAM, "run", "--verify", f"studies/{name}.json", "-o", "out"], cwd=cls.place,
                              capture_output=True, text=True, check=False)
        file = cls.place / f"out/{name}/result.json"
        return done.returncode, json.loads(file.read_text(encoding="utf-8")) if file.exists() else done.stderr

    def result(self, name):
        code, result = self.answers[name]
        self.assertEqual(code, 0, result)
        return result

    def test_every_study_holds(self):
        for name, (judged, status) in STUDIES.items():
            with self.subTest(study=name):
                result = self.result(name)
                self.assertEqual([p["holds"] for p in result["published"]], [True] * judged)
                self.assertEqual(result["status"], status)
                for p in result["published"]:
                    self.assertIn(p["role"], ("calibrates", "verifies", "not_comparable"))
                    self.assertTrue(p["source"] or p["kind"] == "status", p)

    def peaks(self, design):
        """The two highest peaks of the only curve of a design, which is whole and passes through all extremes."""
        curve = design["curves"][0]
        drawn = curve["drawn"]
        self.assertIsNone(curve["trouble"])
        self.assertEqual((drawn["frequency_hz"][0], drawn["frequency_hz"][-1]), (5, 500))
        self.assertLess(len(drawn["frequency_hz"]), 400)
        for e in curve["extremes"]:
            at = min(range(len(drawn["frequency_hz"])), key=lambda i: abs(drawn["frequency_hz"][i] - e["frequency_hz"]))
            self.assertLess(abs(drawn["frequency_hz"][at] / e["frequency_hz"] - 1), 1e-7)
            self.assertLess(abs(drawn["magnitude"][at] / e["magnitude"] - 1), 1e-5)
        found = [e for e in curve["extremes"] if e["kind"] == "peak"]
        self.assertEqual(max(drawn["magnitude"]), max(drawn["magnitude"][i] for i in range(len(drawn["magnitude"]))
                         if min(abs(drawn["frequency_hz"][i] / e["frequency_hz"] - 1) for e in found) < 1e-7))
        return sorted(sorted(found, key=lambda e: -e["magnitude"])[:2], key=lambda e: e["frequency_hz"])

    def test_the_grip_peaks_where_the_paper_has_its_frequencies(self):
        # Table 7 before, to what the model is identified to, and the targets of Tables 8 to 10 after. With 2 % of critical
        # damping a peak of |acceleration| lies beside its natural frequency, the nearer an antiresonance the farther
        tuned = {"inceptor_tuning_1": (18, 90), "inceptor_tuning_2": (25, 135), "inceptor_tuning_3": (21, 70)}
        for name, targets in tuned.items():
            result = self.result(name)
            off = 1e-6 if result["status"] == "solved" else 0.005  # a compromise has no design of both
            for design, wanted, within in ((result["baseline"], (22.09, 107.61), 1e-3), (result["recommendations"][0], targets, off)):
                with self.subTest(study=name, rank=design["rank"]):
                    peaks = self.peaks(design)
                    self.assertEqual(len(peaks), 2)
                    for e, hz, f in zip(peaks, wanted, design["frequencies"]):
                        self.assertLess(abs(e["natural_hz"] / hz - 1), within)
                        self.assertLess(abs(e["natural_hz"] / f["recommended_hz"] - 1), 1e-9)
                        self.assertAlmostEqual(e["damping_ratio"], 0.02, places=12)
                        self.assertLess(abs(e["frequency_hz"] / hz - 1), 0.02)

    def test_what_goals_settle_is_an_optimum(self):
        # the MAC study leaves K_T2 where it was, as nothing settles it: that is no residual of what is settled
        for name, (_, status) in STUDIES.items():
            result = self.result(name)
            best = result["recommendations"][0]
            self.assertTrue(status == "compromise" or best["kkt_residual"] is None or best["kkt_residual"] < 1e-6, (name, best["kkt_residual"]))

    def test_predictions_are_no_calibration(self):
        # Tables 9 and 10 took no part: no goal names their configurations, and every entry about them verifies
        result = self.result("inceptor_prediction")
        about = [p for p in result["published"] if p["label"].startswith(("Table 9", "Table 10"))]
        self.assertEqual([p["role"] for p in about], ["verifies"] * 4)
        self.assertTrue(all(abs(p["difference_percent"]) < 0.5 for p in about))
        goals = result["recommendations"][0]["goals"]
        self.assertEqual(len(goals), 5)
        self.assertFalse([g for g in goals if "table_9" in g["goal"] or "table_10" in g["goal"]])
        # as many data as unknowns that they can tell: met exactly
        self.assertLess(result["recommendations"][0]["misfit"], 1e-8)

    def test_predictions_do_not_depend_on_what_was_assumed(self):
        def predicted(result):
            return [p["computed"] for p in result["published"] if p["label"].startswith(("Table 9", "Table 10"))]
        want = predicted(self.result("inceptor_prediction"))
        model = self.place / "problems/inceptor.json"
        study = self.place / "studies/inceptor_prediction.json"
        model_text, study_text = model.read_text(encoding="utf-8"), study.read_text(encoding="utf-8")
        data = json.loads(study_text)
        data["search"] = {"starts": 4}
        every = (("part_2", 0.5), ("share_2", 0.5), ("beta", 1.6), ("r_SAU", 0.15), ("L_c", 0.09), ("s_z", 0.1),
                                 ("N_gear", 30), ("m_c", 0.2), ("m_s", 0.16))
        for parameter, value in every[::1 if "MT_EVERY" in os.environ else 3]:
            with self.subTest(parameter=parameter):
                changed = json.loads(model_text)
                self.assertEqual(changed["parameters"][parameter]["origin"], "assumed")
                changed["parameters"][parameter]["value"] = value
                model.write_text(json.dumps(changed), encoding="utf-8")
                study.write_text(json.dumps(data), encoding="utf-8")
                code, result = self.run_study("inceptor_prediction")
                self.assertEqual(code, 0)
                for got, ours in zip(predicted(result), want):
                    self.assertAlmostEqual(got / ours, 1, delta=1e-4)
        model.write_text(model_text, encoding="utf-8")
        study.write_text(study_text, encoding="utf-8")

    def test_the_scale_of_the_stick_is_the_only_thing_left_open(self):
        for name in ("inceptor_prediction", "inceptor_identification"):
            with self.subTest(study=name):
                open_ones = self.result(name)["undetermined"]
                self.assertEqual(len(open_ones), 1)
                part = open_ones[0]["components"]
                for parameter, times in (("m_1", 2), ("m_u", 2), ("l_a", -1), ("L_u", -1)):
                    self.assertAlmostEqual(part[parameter] / part["m_1"], times / 2, delta=1e-6)
                for parameter in set(part) - {"m_1", "m_u", "l_a", "L_u"}:
                    self.assertLess(abs(part[parameter]), 1e-6)

    def test_the_spread_is_the_uncertainty_of_table_9(self):
        spread = {s["parameter"]: s for s in self.result("inceptor_identification")["spread"]}
        self.assertEqual(set(spread), {"m_1", "m_u", "l_a", "L_u", "k_servo", "J_rotor", "M_SAU_table_9", "K_T1_table_9"})
        for s in spread.values():
            self.assertLess(s["low"], s["value"])
            self.assertGreater(s["high"], s["value"])
            self.assertIn(s["low_weight_factor"], (4, 0.25))
        # the data contradict each other most about the gearbox of Table 9, by a few percent; the unknowns hardly move
        self.assertTrue(2 < spread["M_SAU_table_9"]["high_percent"] - spread["M_SAU_table_9"]["low_percent"] < 6)
        self.assertTrue(all(s["high_percent"] - s["low_percent"] < 1 for n, s in spread.items() if "table_9" not in n))

    def test_the_tuned_designs_are_those_of_the_identification(self):
        # two ways to ask one thing: the exact frequencies as constraints of the identification, and study 2
        tied = {p["name"]: p["recommended"] for p in self.result("inceptor_identification")["recommendations"][0]["parameters"]}
        tuned = {p["name"]: p["recommended"] for p in self.result("inceptor_tuning_2")["recommendations"][0]["parameters"]}
        self.assertAlmostEqual(tied["M_SAU_table_9"] / tuned["M_SAU"], 1, delta=1e-5)  # M_SAU moves 70 times as much as the frequency
        self.assertAlmostEqual(tied["K_T1_table_9"] / tuned["K_T1"], 1, delta=1e-5)

    def test_the_second_spring_is_undetermined_and_stays(self):
        for name in ("inceptor_tuning_3", "inceptor_stick_mac"):
            with self.subTest(study=name):
                result = self.result(name)
                self.assertEqual([u["direction"] for u in result["undetermined"]], ["K_T2"])
                second = [p for p in result["recommendations"][0]["parameters"] if p["name"] == "K_T2"][0]
                self.assertEqual(second["recommended"], second["original"])
        self.assertEqual(self.result("inceptor_stick")["undetermined"], [])

    def test_a_wrong_number_is_noticed(self):
        for study, place, key, value in (("inceptor_tuning_1", 1, "value", 6.08), ("inceptor_tuning_2", 2, "value", 8050),
                                         ("inceptor_tuning_3", 0, "status", "solved"), ("inceptor_tuning_3", 4, "value", 70.4)):
            with self.subTest(study=study, place=place):
                file = self.place / f"studies/{study}.json"
                whole = file.read_text(encoding="utf-8")
                data = json.loads(whole)
                data["published"][place][key] = value
                file.write_text(json.dumps(data), encoding="utf-8")
                code, result = self.run_study(study)
                file.write_text(whole, encoding="utf-8")
                self.assertEqual(code, 1)
                self.assertEqual([i for i, p in enumerate(result["published"]) if not p["holds"]], [place])


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""Every printed clearance is the greater of frequency and edge over the smaller less 1, on both sides of a band."""
import csv
import json
import re

from common_cli import SOURCE, CliTest, main

STUDIES = ("engine_orders", "six_masses_bands")  # over positions of a drive: test_motion


def ratio(hz, band):
    """From the nearest edge without margin, in per cent; negative inside."""
    def signed(ahead):
        return 100 * (ahead - 1) if ahead >= 1 else -100 * (1 / ahead - 1)

    return max(signed(hz / band["upper_hz"]), signed(band["lower_hz"] / hz))


def asked(hz, band):
    """The margin at the edge that is nearer."""
    below = band["lower_hz"] / hz > hz / band["upper_hz"]
    return 100 * ((band["lower_hz"] / band["margin_lower_hz"] if below else band["margin_upper_hz"] / band["upper_hz"]) - 1)


class Clearances(CliTest):
    def setUp(self):
        super().setUp()
        self.runs = []
        for study in STUDIES:
            out = self.folder / study
            text = self.expect(0, "run", str(SOURCE / f"studies/{study}.json"), "--output", str(out), "--quiet", "--starts", "4").stdout
            result = json.loads((out / study / "result.json").read_text(encoding="utf-8"))
            table = list(csv.DictReader((out / study / "recommendations.csv").read_text(encoding="utf-8").splitlines()))
            self.runs.append((study, text, result, table))

    def test_numbers_of_results_and_csv(self):
        sides = set()
        for study, _, result, table in self.runs:
            rows = {int(r["rank"]): r for r in table}
            for rec in [result["baseline"]] + result["recommendations"]:
                bands = {b["id"]: b for b in rec["gap_assignment"]}
                hz = {(f["configuration"], f["mode"]): f["recommended_hz"] for f in rec["frequencies"]}
                with self.subTest(study, rank=rec["rank"]):
                    for c in rec["clearances"]:
                        self.assertAlmostEqual(c["hz"], hz.get((c["configuration"], c["mode"]), c["hz"]), delta=1e-9 * c["hz"])
                        self.assertAlmostEqual(c["percent"], ratio(c["hz"], bands[c["band_id"]]), delta=1e-8)
                        self.assertAlmostEqual(c["margin_percent"], asked(c["hz"], bands[c["band_id"]]), delta=1e-8)
                        sides.add(c["side"])
                    least = [c["percent"] for c in rec["clearances"]]
                    self.assertAlmostEqual(rec["clearance_percent"], min(least), delta=1e-9)
                    if rec["rank"] in rows:
                        self.assertAlmostEqual(float(rows[rec["rank"]]["clearance_percent"]), min(least), delta=1e-9)
        self.assertEqual(sides, {"above", "below", "inside"})

    def test_numbers_of_tables_and_sentences(self):
        for study, text, result, _ in self.runs:
            rec = result["recommendations"][0]
            with self.subTest(study):
                bands = {b["id"]: b for b in rec["gap_assignment"]}
                right = {(c["configuration"], c["mode"], c["side"]): (f"{ratio(c['hz'], bands[c['band_id']]):.3g}", c["band"]) for c in rec["clearances"]}
                said = re.findall(r"(\S+) mode (\d+) \(\S+ Hz\) keeps (?:just the margin asked for, |only )?(\S+) % (below|above) band", text)
                self.assertTrue(said)
                for configuration, mode, percent, side in said:
                    self.assertAlmostEqual(float(percent), float(right[configuration, int(mode), side][0]), delta=1e-9)
                block = text.split("Clearances from bands\n")[1].split("\n\n")[0]
                for (configuration, mode, side), (percent, band) in right.items():
                    line = next(x for x in block.splitlines() if re.match(rf"\s+{re.escape(configuration)}\s+{mode}\s", x))
                    told = re.search(re.escape(band) + r"\s+(-?[\d.]+)", line)
                    self.assertAlmostEqual(float(told[1]), float(percent), delta=0.006 * abs(float(percent)) + 1e-9)


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""`modetune run --verify` on the paper's beam: every study holds, and a wrong number in any of its parts is noticed."""
import json
import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

TREE = Path(os.environ["SOURCE_DIR"])
PROGRAM = os.environ["MODETUNE"]
STUDIES = {"beam_reference": 12, "beam_table_3": 8, "beam_table_4": 8, "beam_table_5": 8, "beam_identification": 29}


class Beam(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        for part in ("problems", "studies"):
            shutil.copytree(TREE / part, self.folder / part)

    def run_study(self, name, code):
        """Run and verify; the exit status is `code`. The published values as the result file has them."""
        done = subprocess.run([PROGRAM, "run", "--verify", f"studies/{name}.json", "-o", "out"], cwd=self.folder,
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return json.loads((self.folder / f"out/{name}/result.json").read_text(encoding="utf-8"))

    def edit(self, path, change):
        file = self.folder / path
        data = json.loads(file.read_text(encoding="utf-8"))
        change(data)
        file.write_text(json.dumps(data), encoding="utf-8")

    def test_every_study_holds(self):
        for name, judged in STUDIES.items():
            with self.subTest(study=name):
                result = self.run_study(name, 0)
                self.assertEqual([p["holds"] for p in result["published"]], [True] * judged)
                self.assertEqual(result["status"], "solved")

    def test_the_identified_springs_are_symmetric_and_inside_their_bounds(self):
        best = self.run_study("beam_identification", 0)["recommendations"][0]
        springs = [p["recommended"] for p in best["parameters"]]
        self.assertTrue(best["feasible"])
        self.assertEqual([p["at_bound"] for p in best["parameters"]], [None] * 8)
        for a, b in zip(springs, reversed(springs)):
            self.assertAlmostEqual(a / b, 1, delta=1e-5)  # the goals' tolerance is 1e-6

    def test_a_wrong_published_value_is_noticed(self):
        # one unit of the last printed digit more than the tolerance allows, or a MAC that cannot be
        for study, place, key, value in (("beam_table_3", 3, "value", 15.24), ("beam_table_5", 7, "at_least", 0.99991),
                                         ("beam_reference", 8, "value", 0.7515), ("beam_identification", 1, "value", 17.65),
                                         ("beam_identification", 0, "status", "compromise")):
            with self.subTest(study=study, place=place):
                def change(data, place=place, key=key, value=value):
                    data["published"][place][key] = value
                self.edit(f"studies/{study}.json", change)
                held = [p["holds"] for p in self.run_study(study, 1)["published"]]
                self.assertEqual([i for i, holds in enumerate(held) if not holds], [place])
                shutil.copy(TREE / f"studies/{study}.json", self.folder / "studies")

    def test_a_wrong_model_is_noticed(self):
        # the printed height, which is rounded, puts all frequencies 0.35 % low
        self.edit("problems/beam_reference.json", lambda data: data["parameters"]["m"].update(value="2710*0.05*0.0026*L"))
        held = [p["holds"] for p in self.run_study("beam_reference", 1)["published"]]
        self.assertEqual(held, [False] * 12)

    def test_a_joint_that_is_missing_is_noticed(self):
        self.edit("problems/beam_lumped.json", lambda data: data["joints"][1].update({"in": []}))
        held = [p["holds"] for p in self.run_study("beam_table_5", 1)["published"]]
        self.assertIn(False, held)


if __name__ == "__main__":
    unittest.main()

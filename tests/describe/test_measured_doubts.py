# SPDX-License-Identifier: GPL-3.0-or-later
"""
Measured data that look conjugated are told: through the highest peak, between the first lines below its half-power on either side, the phase
rises by more than half a radian, in words that say where and by how much. Made so line by line: the rise is known.
"""
import json
import math
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

PROGRAM = os.environ["MODETUNE"]
K, M, MIDDLE = 4000.0, 1.0, 20
MODEL = {
    "format": "modetune-model/1", "dimension": 2, "parameters": {"k": K},
    "bodies": [{"name": "m", "mass_kg": M, "centre": [0.1, 0]}],
    "joints": [{"name": "g", "type": "pin-in-slot", "bodies": ["ground", "m"], "at": [0.1, 0], "axis": [1, 0]}],
    "springs": [{"name": "s", "type": "axial", "bodies": ["ground", "m"], "at": [[0, 0], [0.1, 0]], "stiffness_n_per_m": "k", "loss_factor": 0.05}],
    "sensors": [{"name": "x", "on": "m", "at": [0.1, 0], "directions": ["x"]}],
}
STUDY = {
    "format": "modetune-study/1", "model": "model.json", "variables": [{"parameter": "k", "lower": K / 2, "upper": 2 * K}],
    "goals": [{"type": "frequency_response", "output": "x.x", "input": "x.x", "measurement": "bench", "weight": 1}],
    "measurements": {"bench": {"file": "frf.csv"}}, "objective": {"minimise": "misfit"}, "search": {"starts": 1, "max_evaluations": 4},
}


def lines(half_width, rise, begin=0.0, middle=MIDDLE):
    """41 lines, 9 to 11 Hz: a peak whose half-power points are so many lines from its middle; the phase rises by so much between the first
    lines below, and falls beside them by a quarter turn each way."""
    inside = math.floor(half_width) + 1
    out, phase = [], begin
    for i in range(41):
        out.append((9.0 + 0.05 * i, 1.0 / math.hypot(1.0, (i - middle) / half_width), phase))
        phase += rise / (2 * inside) if middle - inside <= i < middle + inside else -0.5 * math.pi / 20
    return out


class MeasuredDoubts(unittest.TestCase):
    def told(self, folder, data):
        rows = [f"{hz!r},{size * math.cos(phase)!r},{size * math.sin(phase)!r}" for hz, size, phase in data]
        (folder / "frf.csv").write_text("frequency_hz,real,imag\n" + "\n".join(rows) + "\n")
        done = subprocess.run([PROGRAM, "run", "study.json", "--quiet", "-o", "out"], cwd=folder, capture_output=True, text=True, timeout=60)
        self.assertIn(done.returncode, (0, 1), done.stderr)
        result = json.loads((folder / "out/study/result.json").read_text())
        return [w for w in result["warnings"] if "conjugated" in w]

    def test_a_phase_that_rises_through_the_peak_is_told(self):
        rows = [(3.5, rise, begin) for rise in (0.02, 0.4, 0.49, 0.51, 0.6, 0.95, 1.05, 2.0, 3.1) for begin in (0.0, 3.0)]
        rows += [(3.5, -2.0, 0.0), (3.5, -0.6, 3.0), (1.5, 0.6, 0.0), (1.5, 0.4, 0.0), (10.5, 0.6, 0.0), (10.5, 0.4, -3.0)]
        rows += [(0.9, 2.0, 0.0)]  # three lines: too few
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "model.json").write_text(json.dumps(MODEL))
            (Path(folder) / "study.json").write_text(json.dumps(STUDY))
            for width, rise, begin in rows:
                with self.subTest(f"{width} lines, {rise} rad from {begin}"):
                    told = self.told(Path(folder), lines(width, rise, begin))
                    self.assertEqual(len(told), int(rise > 0.5 and width > 1.0))
                    for text in told:
                        hz, degrees = re.search(r"peak at (\S+) Hz .* rises by (\d+) degrees", text).groups()
                        self.assertEqual((float(hz), int(degrees)), (10.0, round(math.degrees(rise))))
            for middle in (0, 40):  # half a peak says nothing
                self.assertEqual(self.told(Path(folder), lines(3.5, 2.0, middle=middle)), [])


if __name__ == "__main__":
    unittest.main()

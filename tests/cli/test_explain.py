# SPDX-License-Identifier: GPL-3.0-or-later
"""explain: the slopes are those of the closed form, in order; bounds and prices are told; refusals."""
import csv
import io
import json
import math

from common_cli import CliTest, main, study


def hz(k1, k2):
    """Frequencies of the two masses of common_cli.MODEL."""
    b = k1 + 2 * k2
    return [math.sqrt((b - s * math.sqrt(b * b - 4 * k1 * k2)) / 2) / (2 * math.pi) for s in (1, -1)]


class Explain(CliTest):
    def answer(self, goals, variables, code=0, **more):
        self.write("studies/asked.json", json.dumps({**json.loads(study()), "goals": goals, "variables": variables, **more}))
        self.expect(code, "run", "studies/asked.json", "-o", "out")
        return "out/asked/result.json"

    def rows(self, path, *args):
        return list(csv.DictReader(io.StringIO(self.expect(0, "explain", path, "--format", "csv", *args).stdout)))

    def test_slopes_are_those_of_the_closed_form_the_most_first(self):
        goals = [{"type": "frequency", "configuration": "held", "mode": 1, "at_least_hz": 0.15},
                 {"type": "frequency", "configuration": "held", "mode": 2, "at_least_hz": 0.36},
                 {"type": "limit", "expression": "k1*k1 + k2", "at_most": 60}]
        path = self.answer(goals, [{"parameter": "k1", "lower": 1, "upper": 10}, {"parameter": "k2", "lower": 0.5, "upper": 10}])
        result = json.loads((self.folder / path).read_text(encoding="utf-8"))
        best = result["recommendations"][0]
        k = [p["recommended"] for p in best["parameters"]]
        h = 1e-6
        of = {}
        for name, i in (("k1", 0), ("k2", 1)):
            up, down = [list(k), list(k)]
            up[i] *= 1 + h
            down[i] *= 1 - h
            for mode in (0, 1):
                of[(best["goals"][mode]["goal"], name)] = (hz(*up)[mode] - hz(*down)[mode]) / (2 * h) / 100
        of[(best["goals"][2]["goal"], "k1")] = 2 * k[0] * k[0] / 100
        of[(best["goals"][2]["goal"], "k2")] = k[1] / 100
        rows = self.rows(path)
        self.assertEqual({(r["goal"], r["parameter"]) for r in rows}, set(of))
        for r in rows:
            wanted = of[(r["goal"], r["parameter"])]
            self.assertLess(abs(float(r["change_per_percent"]) - wanted), 1e-7 * max(map(abs, of.values())))
        for goal in {r["goal"] for r in rows}:
            moves = [abs(float(r["change_per_percent"])) for r in rows if r["goal"] == goal]
            self.assertEqual(moves, sorted(moves, reverse=True))
        text = self.expect(0, "explain", path).stdout
        for part in ("Recommendation 1 (feasible)", "What moves each goal, the most first", "What holds it", "What it costs"):
            self.assertIn(part, text)
        costs = [r["text"] for r in best["reasons"] if r["kind"] == "cost"]
        self.assertTrue(costs)
        for sentence in costs + [r["text"] for r in best["reasons"] if r["kind"] == "hold"]:
            self.assertIn(f"  - {sentence}\n", text)

    def test_a_bound_in_the_way_is_told(self):
        path = self.answer([{"type": "frequency", "configuration": "held", "mode": 1, "at_least_hz": 5}],
                           [{"parameter": "k1", "lower": 1, "upper": 10}, {"parameter": "k2", "lower": 1, "upper": 10}], code=1)
        text = self.expect(0, "explain", path).stdout
        self.assertRegex(text, r"k1 .*\bupper\b.* 0 % up")
        self.assertIn("missed by", text)
        told = self.json_of("explain", path)
        self.assertEqual([p["at_bound"] for p in told["parameters"]], ["upper", "upper"])

    def test_other_ranks_and_what_is_refused(self):
        path = self.answer([{"type": "frequency", "configuration": "held", "mode": m, "target_hz": f}
                            for m, f in ((1, hz(3, 1)[0]), (2, hz(3, 1)[1]))],
                           [{"parameter": "k1", "lower": 1, "upper": 10}, {"parameter": "k2", "lower": 0.5, "upper": 10}])
        ranks = [self.json_of("explain", path, "--rank", str(n)) for n in (1, 2)]
        self.assertEqual([r["rank"] for r in ranks], [1, 2])
        self.assertIn("there is no rank 3", self.expect(2, "explain", path, "--rank", "3").stderr)
        self.expect(2, "explain", "studies/asked.json")
        self.expect(4, "explain", "none.json")


if __name__ == "__main__":
    main()

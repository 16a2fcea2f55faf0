# SPDX-License-Identifier: GPL-3.0-or-later
"""Reports of shipped studies, as a browser has them: their figures carry the result's numbers and follow the choice. MT_EVERY=1: of all
studies, in two windows each, of all designs and on paper."""
import json
import re
import shutil
import subprocess
import unittest

from common_pages import EVERY, PROGRAM, SOURCE, STUDIES, WINDOWS, Answers
from selenium.webdriver.common.keys import Keys

MOST_BYTES = 560_000
# Between them they have every kind of figure that a report has, no design, no answer and several of both; each is opened in another window.
SAMPLE = ["beam_identification", "inceptor_rotor", "den_hartog", "inceptor_trade", "inceptor_vibration", "beam_reference", "six_masses_infeasible"]
LIKE_ANOTHER = "beam_reference"  # has no figure of its own
# What reports have to have, and to say before all else.
FIGURES_OF = {
    "inceptor_rotor": {"frequencies", "parameters", "rotor-1", "parallel", "tolerance", "sensitivity", "spent"},
    "inceptor_trade": {"trade", "front", "parallel", "tolerance", "rotor-1"},
    "beam_identification": {"mac", "published", "starts", "sensitivity", "history-1", "mac-matrix-1"},
    "inceptor_tuning_1": {"bode-1", "nyquist-1"}, "den_hartog": {"bode-1", "nyquist-1"},
    "three_masses_identification": {"bode-1", "bode-2"},
    "beam_reference": {"published"}, "engine_orders": {"rotor-1", "frequencies"},
}
GISTS = {"inceptor_rotor": ["k_servo +8.21 %", "Graded feasible;", "all 4 are met", "Of 10 mode placements"],
         "six_masses_infeasible": ["Infeasible", "the goal is missed by", "No design within the bounds"],
         "beam_identification": ["and 4 others", "nothing; designs were found by local searches"]}
CUT = "six_masses_infeasible"
CURVES = {"inceptor_tuning_1", "inceptor_tuning_2", "inceptor_tuning_3", "den_hartog"}
HALF = 0.6e-3  # of the fourth digit, and a little
# Words of the frequency chart's lanes by configuration and mode; values of the chart of parameters by name.
LANES = """
return Object.fromEntries([...document.querySelectorAll('#figure-frequencies text[data-mode]')]
    .map((t) => [t.dataset.mode, t.textContent]));
"""
VALUES = """
return Object.fromEntries([...document.querySelectorAll('#figure-parameters text[data-parameter]')]
    .map((t) => [t.dataset.parameter, t.textContent]));
"""
# Modes of the last design that the mechanism is shown at: index and Hz.
MECHANISM = """
return [...document.querySelectorAll('.modes tbody tr')].map((row) => [row.querySelector('label').textContent.trim(),
    [...row.querySelectorAll('td[data-hz]')].map((cell) => cell.dataset.hz).pop()]).filter(([mode, hz]) => /^[0-9]+$/.test(mode) && hz);
"""
FIGURES = "return [...document.querySelectorAll('.figure')].filter((f) => !f.hidden).map((f) => f.id.slice(7))"
# What is saved, instead of files: names and contents.
SAVED = """
window.kept = []; mt.save = (name, content) => window.kept.push([name, content]);
document.querySelectorAll('.figure:not([hidden]) .export button').forEach((b) => b.click());
"""
KEPT = "return window.kept.map(([name, content]) => [name, content instanceof Blob ? content.size : content])"


def number(text):
    return float(text.replace("\u2212", "-"))


class Report(Answers):
    studies = STUDIES if EVERY else [SOURCE / "studies" / f"{name}.json" for name in SAMPLE if name != LIKE_ANOTHER]

    def near(self, text, value, where):
        self.assertLessEqual(abs(number(text) - value), HALF * abs(value) + 1e-12, f"{where}: {text} for {value}")

    def check_frequencies(self, design):
        """Every lane ends with the recommended frequency, and there is a lane or the words "above the scale" for each."""
        lanes = self.browser.run(LANES)
        for f in design["frequencies"]:
            key = f"{f['configuration']} {f['mode']}"
            if key in lanes:
                found = re.search(r"([\d.e\u2212]+) Hz", lanes[key])
                self.near(found[1], f["recommended_hz"], key)
                if " \u2192 " in lanes[key]:
                    self.near(lanes[key].split(" ")[0], f["original_hz"], key)
            elif f["recommended_hz"] is not None:
                figure = self.browser.one("#figure-frequencies svg").text
                self.assertIn("above the scale", figure, key)

    def check_parameters(self, design):
        values = self.browser.run(VALUES)
        self.assertEqual(set(values), {p["name"] for p in design["parameters"]})
        for p in design["parameters"]:
            self.near(values[p["name"]].split(" ")[-1], p["recommended"] / (p["display_factor"] or 1), p["name"])

    def check_told(self, rank):
        ranks = self.browser.run("return [...document.querySelectorAll('[data-rank]')].filter((s) => !s.hidden)"
                                 ".map((s) => Number(s.dataset.rank))")
        self.assertEqual(set(ranks) - {rank}, set())

    def check_mechanism(self, design):
        """The mechanism that is shown is the design's, in the first configuration of the result."""
        first = design["frequencies"][0]["configuration"]
        hertz = {f["mode"]: f["recommended_hz"] for f in design["frequencies"] if f["configuration"] == first}
        told = self.browser.run(MECHANISM)
        self.assertGreater(len(told), 0)
        for mode, hz in told:
            if int(mode) in hertz:
                self.assertAlmostEqual(float(hz) / hertz[int(mode)], 1, places=6)

    def check_curves(self, result):
        """Numbers of the diagrams are the result's; peaks are told and marked; limits of goals are drawn."""
        designs = {"original": result["baseline"], "No. 1": result["recommendations"][0]}
        for k, curve in enumerate(result["curves"]):
            bode, nyquist = self.browser.run("return [mt.chartBode, mt.chartNyquist].map((f) => f()[arguments[0]].table().rows)", k)
            for words, design in designs.items():
                drawn = design["curves"][k]["drawn"]
                mine = [row[1:] for row in bode if row[0] == words]
                self.assertEqual([row[:2] for row in mine], [list(p) for p in zip(drawn["frequency_hz"], drawn["magnitude"])])
                for (_, _, phase), given in zip(mine, drawn["phase_deg"]):
                    self.assertAlmostEqual((phase - given) / 360, round((phase - given) / 360), places=9)
                for (_, f, re_, im), size in zip([r for r in nyquist if r[0] == words], drawn["magnitude"]):
                    self.assertAlmostEqual(abs(complex(re_, im)) / size, 1, places=9, msg=f)
                lead = self.browser.one(f"#figure-bode-{k + 1} .lead").text
                peaks = [e for e in design["curves"][k]["extremes"] if e["kind"] == "peak"]
                for e in sorted(peaks, key=lambda e: -e["magnitude"])[:2]:
                    self.near(re.search(rf"([\d.e\u2212]+) at {e['frequency_hz']:.4g}", lead.replace(".00 ", " "))[1]
                              if f" at {e['frequency_hz']:.4g}" in lead else "0", e["magnitude"], lead)
            marks = self.browser.all(f"#figure-bode-{k + 1} svg path > title")
            told = [m.get_attribute("textContent") for m in marks]
            for limit in curve["limits"]:
                self.assertEqual(sum(limit["pointer"] in words for words in told), 1, limit)

    def check_trade_points(self, result):
        note = self.browser.one("#figure-mechanism .lead")
        self.assertFalse(note.is_displayed())
        cells = self.browser.all("#figure-trade [data-at]")
        self.assertEqual(len(cells), len(result["trade"]["points"]))
        for place in (0, 17, len(cells) - 1)[0 if EVERY else 1:]:
            self.browser.all("#figure-trade [data-at]")[place].send_keys("\ue007")
            self.browser.settle()
            best = result["trade"]["points"][place]["best"]
            self.check_frequencies(best)
            self.check_parameters(best)
        self.browser.run("mt.choose(10)")
        self.assertTrue(note.is_displayed())
        self.assertRegex(note.text, r"^Trade point: .* is not drawn; here is recommended, rank 1\.$")

    def check_saved(self, result):
        figures = self.browser.run(FIGURES)
        self.browser.run(SAVED)
        self.browser.driver.execute_async_script("const [count, done] = arguments; const wait = () => (window.kept.length < count"
                                                 " ? setTimeout(wait, 20) : done()); wait();", 3 * len(figures))
        kept = dict(self.browser.run(KEPT))
        for figure in figures:
            for ending in ("svg", "png", "csv"):
                self.assertIn(f"modetune_{figure}.{ending}", kept)
            self.assertGreater(kept[f"modetune_{figure}.png"], 2000, figure)
            svg = kept[f"modetune_{figure}.svg"]
            self.assertTrue(svg.startswith("<svg") and "style=" not in svg, figure)
        rows = kept["modetune_frequencies.csv"].split("\r\n")
        hz = [float(row.split(",")[5]) for row in rows if row.startswith("mode,")]
        self.assertEqual(hz, [f["recommended_hz"] for f in result["recommendations"][0]["frequencies"]])

    def check_arrow_keys(self, result):
        first = self.browser.run(VALUES)
        self.browser.all(".alternatives input")[0].send_keys("\ue015")
        self.browser.settle()
        self.assertNotEqual(self.browser.run(VALUES), first)
        self.assertTrue(self.browser.run("return document.querySelectorAll('.alternatives input')[1].checked"))

    def check_drive(self, result):
        self.assertIn("drive-1", self.browser.run(FIGURES))
        slider = self.browser.one("#drive")
        slider.send_keys(Keys.END)
        self.assertEqual(self.browser.one("#figure-mechanism output").text, "10\u00b0")
        slider.send_keys(Keys.HOME, Keys.ARROW_RIGHT)
        self.assertEqual(self.browser.one("#figure-mechanism output").text, "\u22129\u00b0")
        self.assertEqual(len(result["recommendations"]), 3)
        self.browser.all(".modes input")[2].click()
        self.browser.run("mt.choose(2)")
        self.assertEqual(self.browser.one("#figure-mechanism output").text, "\u22129\u00b0")  # and the mode stay as they were
        self.assertTrue(self.browser.run("return document.querySelectorAll('.modes input')[2].checked"))
        self.assertEqual(self.browser.all(".view3d figcaption")[-1].text, "recommended, rank 3")
        self.assertEqual(self.browser.problems(), [])

    def check_travel(self, _result):
        """Over the travel that the study asks about the lowest modes of the best design and the original are drawn in full."""
        self.browser.run("mt.choose(0)")
        paths = self.browser.run("return [...document.querySelectorAll('#figure-drive-1 svg path')].map((p) => ["
                                 "(p.querySelector('title') || {}).textContent || '', p.getAttribute('d')])")
        rows = self.browser.run("return mt.chartDrive()[0].table().rows")
        for mode in (1, 2):
            drawn = [d for title, d in paths if title.endswith(f" mode {mode}")]
            self.assertEqual(len(drawn), 2, mode)
            positions = len([r for r in rows if r[2] == mode])
            self.assertEqual(sum(d.count("L") + d.count("M") for d in drawn), positions, mode)

    def check_scales(self, result):
        """A mode far above all that goals are about is told; of a range that the study does not ask about nothing is drawn."""
        self.assertEqual(self.browser.all("#drive"), [])
        best = result["recommendations"][0]
        hz = sorted(max(f["original_hz"], f["recommended_hz"]) for f in best["frequencies"])
        self.assertGreater(hz[-1], 10_000)
        lead = self.browser.one("#figure-frequencies .lead").text
        told = re.search(r"1 mode above (\d+) Hz is not drawn\.$", lead)
        self.assertIsNotNone(told, lead)
        self.assertTrue(hz[-2] < int(told[1]) < 1.3 * hz[-2], lead)
        self.assertIn("above the scale: mode 3", self.browser.one("#figure-frequencies svg").text)
        self.assertEqual(self.browser.problems(), [])

    def check_keys(self, result):
        reached = []
        for _ in range(12):
            self.browser.one("html").send_keys(Keys.TAB) if not reached else self.browser.driver.switch_to.active_element.send_keys(Keys.TAB)
            reached.append(self.browser.run("const e = document.activeElement; const r = e.getBoundingClientRect(); return [e.tagName, "
                                            "getComputedStyle(e).outlineStyle, r.bottom > 0 && r.top < innerHeight]"))
        self.assertEqual([r for r in reached if r[1] == "none" or not r[2]], [])
        self.assertEqual(self.browser.run("return [...document.querySelectorAll('button, select, input, summary, canvas, [data-at]')]"
                                          ".filter((e) => e.tabIndex < 0).length"), 0)

    def check_printed(self, _result):
        printed = self.browser.pdf()
        self.assertTrue(printed.startswith(b"%PDF"))
        self.assertIn(printed.count(b"/Type /Page\n"), range(4, 20))

    def check_windows(self, windows):
        for window in windows:
            with self.subTest(window=window):
                self.browser.screen(**window)
                self.browser.settle()
                self.assertEqual(self.browser.console() if window["dark"] and len(windows) > 1 else self.browser.problems() + self.browser.numbers(), [])

    def check_designs(self, designs):
        radios = self.browser.all(".alternatives input")
        self.assertEqual(len(radios), len(designs) if len(designs) > 1 else 0)
        places = range(len(designs)) if EVERY else sorted({0, len(designs) - 1} & set(range(len(designs))))
        for place in places:
            if radios:
                radios[place].click()
            self.browser.settle()
            self.check_frequencies(designs[place])
            self.check_parameters(designs[place])
            self.check_told(designs[place]["rank"])
            self.check_mechanism(designs[place])
        self.assertEqual(self.browser.problems(), [])

    def test_reports(self):
        """In a window, or in all; of the designs that are chosen; on paper. What single reports are asked goes first."""
        asked = {"inceptor_trade": [self.check_keys, self.check_trade_points], "inceptor_rotor": [self.check_drive, self.check_travel],
                 "inceptor_vibration": [self.check_scales], "beam_identification": [self.check_saved, self.check_arrow_keys, self.check_printed]}
        asked.update({name: [self.check_curves] for name in CURVES})
        if EVERY:
            asked["inceptor_trade"].append(self.check_printed)
        figures = {}
        for turn, (name, (path, result)) in enumerate(self.reports.items()):
            windows = [WINDOWS[(turn + 2 * k) % len(WINDOWS)] for k in range(2 if EVERY else 1)]  # two widths of three, in turn light and dark
            with self.subTest(report=name):
                self.assertLess(path.stat().st_size, MOST_BYTES)
                self.open(name, **windows[0])
                figures[name] = set(self.browser.run(FIGURES))
                self.assertLessEqual(FIGURES_OF.get(name, set()), figures[name])
                told = self.browser.one("main").text[:1200]
                for part in GISTS.get(name, []):
                    self.assertIn(part, told)
                for check in asked.get(name, []):
                    check(result)
                self.check_windows(windows)
                self.check_designs(result["recommendations"])
                if EVERY or name in (CUT, SAMPLE[0], "inceptor_trade"):
                    self.assertEqual(self.browser.paper(), [])
                if name == CUT:  # what paper cuts is found
                    self.browser.run("document.querySelector('.gist').style.cssText = 'white-space: nowrap; overflow: hidden'")
                    self.assertIn("UL is cut on paper", " ".join(self.browser.paper()))
                self.assertEqual(self.browser.requests(), [])
        kinds = {name: {re.sub(r"-\d+$", "", figure) for figure in had} for name, had in figures.items()}
        self.assertEqual(set().union(*kinds.values()) - set().union(*(kinds[name] for name in SAMPLE if name in kinds)), set())

    def test_of_a_large_grid_some_points_can_be_chosen(self):
        """A cell for each of 420 points; those that the page has whole show their design, the others are words and numbers."""
        study = json.loads((SOURCE / "studies/inceptor_trade.json").read_text(encoding="utf-8"))
        study.pop("published")
        for name in ("inceptor.json", "aircraft.json"):
            shutil.copy(SOURCE / "problems" / name, self.folder)
        study["model"] = "inceptor.json"
        first, second = study["trade"]["vary"]
        first["values"], second["values"] = [0.6 + 0.12 * i for i in range(21)], [2 + 1.4 * i for i in range(20)]
        (self.folder / "grid.json").write_text(json.dumps(study), encoding="utf-8")
        subprocess.run([PROGRAM, "run", self.folder / "grid.json", "--quiet", "-o", self.folder], capture_output=True, timeout=300, check=False)
        report = self.folder / "grid"
        points = json.loads((report / "result.json").read_text(encoding="utf-8"))["trade"]["points"]
        self.browser.open(report / "report.html")
        front = [k for k, p in enumerate(points) if p["pareto"]]
        told = self.browser.run("return [...document.querySelectorAll('#figure-trade svg rect > title')].map((t) => t.textContent)")
        self.assertEqual([" on the front" in words for words in told], [p["pareto"] for p in points])
        for words, point in zip(told, points):
            self.assertIn(f": {point['status']}", words)
            if point["best"]["feasible"]:
                self.near(re.search(r"total change ([^ ,]+)", words)[1], point["best"]["change"], words)
        cells = self.browser.all("#figure-trade [data-at]")
        self.assertEqual(len(cells), len(front))
        self.assertIn(f" {len(front)} of them can be chosen, on the front;", self.browser.one("#figure-trade .lead").text)
        for place in (0, len(front) - 1):
            self.browser.all("#figure-trade [data-at]")[place].send_keys("\ue007")
            self.browser.settle()
            self.check_frequencies(points[front[place]]["best"])
            self.check_parameters(points[front[place]]["best"])
        self.assertEqual(self.browser.problems(), [])

    def test_parameters_are_shown_in_their_units(self):
        """The answer in inches is drawn in inches; the data in the page stay in SI."""
        model = json.loads((SOURCE / "problems/inceptor.json").read_text(encoding="utf-8"))
        model["configurations"] = {name: model["configurations"][name] for name in ("stick_free", "installed")}  # none is driven
        (self.folder / "m.json").write_text(json.dumps(model), encoding="utf-8")
        (self.folder / "s.json").write_text(json.dumps({
            "format": "modetune-study/1", "model": "m.json", "units": {"length": "in"}, "recommendations": 2,
            "variables": [{"parameter": "l_a", "lower": 4, "upper": 6}, {"parameter": "M_SAU", "lower": 1, "upper": 4}],
            "goals": [{"type": "limit", "expression": "l_a", "at_least": "5.5*inch"}]}), encoding="utf-8")
        subprocess.run([PROGRAM, "run", self.folder / "s.json", "--quiet", "-o", self.folder, "--set", "r_SAU=6.5*inch"], capture_output=True, timeout=300, check=False)
        report = self.folder / "s"
        result = json.loads((report / "result.json").read_text(encoding="utf-8"))
        best = result["recommendations"][0]["parameters"]
        self.assertEqual((best[0]["unit"], best[0]["display_unit"], best[1]["display_unit"]), ("m", "in", None))
        self.browser.open(report / "report.html")
        values = self.browser.run(VALUES)
        self.near(values["l_a"].split(" ")[-1], best[0]["recommended"] / 0.0254, "l_a")
        self.near(values["M_SAU"].split(" ")[-1], best[1]["recommended"], "M_SAU")
        self.assertIn("l_a [in]", self.browser.one("#figure-parameters svg").text)
        origin = self.browser.one("#figure-origin").text
        self.assertIn("asked with r_SAU = 6.5 in", origin)
        self.assertIn("--set 'r_SAU=6.5*inch'", origin)  # 6.5 alone would be metres
        self.assertIn("run time in timing.json", origin)


if __name__ == "__main__":
    unittest.main()

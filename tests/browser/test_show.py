# SPDX-License-Identifier: GPL-3.0-or-later
"""Pages of `modetune show`, of every shipped model and of what studies answer, as a browser has them."""
import json
import subprocess
import unittest
from concurrent.futures import ThreadPoolExecutor

from common_pages import EVERY, PROGRAM, SOURCE, STUDIES, WINDOWS, Answers
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.select import Select

MODELS = sorted(path for path in (SOURCE / "problems").glob("*.json") if path.name != "aircraft.json")
# A drive, what has no answer, and what has many; of every second model that none of them is about the page of the model itself. MT_EVERY=1: all.
SAMPLE = {"beam_identification", "inceptor_tuning_1", "six_masses_bands", "six_masses_infeasible", "truss_10bar_E68_9"}
DIGITS = 1e-7  # a page has nine, of a design with seventeen
# All that a page says of the modes of the chosen configuration: one list per design, null where it says nothing.
HERTZ = """
return [...document.querySelectorAll('.modes tbody tr')].map((row) => [row.querySelector('label').textContent.trim(),
    [...row.querySelectorAll('td.number')].map((cell) => [cell.dataset.hz === undefined ? null : Number(cell.dataset.hz),
        cell.textContent])]);
"""


def program(*arguments):
    """What the program prints; a study that is not solved is an answer, too."""
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=300)
    if done.returncode > 1:
        raise RuntimeError(f"{arguments}: exit status {done.returncode}\n{done.stderr}")
    return done.stdout


def model_of(study):
    return (study.parent / json.loads(study.read_text(encoding="utf-8"))["model"]).resolve()


def frequencies(model):
    """Configuration to the frequencies of its vibration modes, by their index."""
    told = json.loads(program("modes", model, "--count", "all", "--format", "json"))
    return {one["configuration"]: {mode["index"]: mode["frequency_hz"] for mode in one.get("modes", []) if mode["index"]}
            for one in (told if isinstance(told, list) else [told])}


class Show(Answers):
    studies = sorted(path for path in STUDIES if EVERY or path.stem in SAMPLE)

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        answered = set() if EVERY else set(map(model_of, cls.studies))
        alone = [m for m in MODELS if m not in answered][::1 if EVERY else 2]
        with ThreadPoolExecutor(2) as pool:
            shown = MODELS if EVERY else [*answered, *alone]
            cls.models = dict(zip(shown, pool.map(frequencies, shown)))
            cls.pages = dict(pool.map(cls.of_model, alone)) | dict(pool.map(cls.of_study, cls.studies))

    @classmethod
    def of_model(cls, model):
        page = cls.folder / f"{model.stem}.html"
        page.write_text(program("show", model), encoding="utf-8")
        return page, [cls.models[model]]

    @classmethod
    def of_study(cls, study):
        """The page of its result, and the frequencies of the original design and of the best."""
        report, answer = cls.reports[study.stem]
        result = report.with_name("result.json")
        page = cls.folder / f"{study.stem}_answer.html"
        model = model_of(study)
        page.write_text(program("show", result, "--model", model), encoding="utf-8")
        designs = [cls.models[model]]
        if answer["recommendations"]:
            applied = cls.folder / f"{study.stem}_applied.json"
            applied.write_text(program("apply", result, "--model", model), encoding="utf-8")
            designs.append(frequencies(applied))
        return page, designs

    def compare(self, configuration, wanted):
        """The panel's numbers, in every column that has a design."""
        rows = self.browser.run(HERTZ)
        told = 0
        for label, cells in rows:
            for (hz, text), design in zip(cells, wanted):
                if label.isdigit() and hz is not None:
                    right = design[configuration][int(label)]
                    self.assertLessEqual(abs(hz - right), DIGITS * right, f"{configuration} mode {label}")
                    self.assertAlmostEqual(float(text) / right, 1, places=5)
                    told += 1
        expected = sum(min(len(design[configuration]), 12) for design in wanted)
        # a mode that has its name in both designs stands in one row, wherever it is
        self.assertEqual(told, expected, f"{configuration}: {rows}")

    def layouts(self, windows):
        for window in windows:
            self.browser.screen(**window)
            self.browser.settle()
            self.assertEqual(self.browser.problems(), [], window)

    def handle(self):
        """Every mode, the whole drive and the keys of the view, as hands would."""
        self.browser.run("document.querySelectorAll('.modes input').forEach((input) => input.click())")
        self.browser.settle()
        if self.browser.all("#drive"):
            slider = self.browser.one("#drive")
            for key in (Keys.HOME, Keys.ARROW_RIGHT, Keys.END):
                slider.send_keys(key)
                self.browser.settle()
        self.browser.one("canvas").send_keys(Keys.ARROW_LEFT, "+", "x", "y", "z", "0")

    def page(self, path, designs, windows):
        self.browser.open(path, **windows[0])
        ranks, names = self.browser.run("const scene = mt.scene(); return [scene.designs.map((design) => design.rank), "
                                        "scene.designs[0].configurations.map((one) => one.name)];")
        self.assertEqual(ranks[:2], list(range(len(designs))))
        for place, name in enumerate(names):
            if len(names) > 1:
                Select(self.browser.one("select")).select_by_index(place)
            self.compare(name, designs)
        if EVERY or self.browser.all("#drive"):
            self.handle()
        self.layouts(windows)

    def test_every_model_and_every_answer(self):
        self.assertGreaterEqual(len(self.pages), len(self.models) + (len(STUDIES) if EVERY else 0))
        for turn, (path, designs) in enumerate(self.pages.items()):
            with self.subTest(page=path.stem):
                self.page(path, designs, [WINDOWS[(turn + 2 * k) % len(WINDOWS)] for k in range(2 if EVERY else 1)])

    def test_paper_and_a_wrong_number(self):
        """It is printed, and a number that is not the model's is found."""
        path, designs = next(iter(self.pages.items()))
        self.browser.open(path, dark=True)
        name = self.browser.run("return mt.scene().designs[0].configurations[0].name")
        wrong = [{name: {index: hz * (1 + 3 * DIGITS) for index, hz in designs[0][name].items()}}]
        with self.assertRaises(AssertionError):
            self.compare(name, wrong)
        self.assertEqual(self.browser.paper(), [])
        self.assertTrue(self.browser.pdf().startswith(b"%PDF"))


if __name__ == "__main__":
    unittest.main()

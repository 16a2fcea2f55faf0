# SPDX-License-Identifier: GPL-3.0-or-later
"""The documents' pictures are what pages look like: made again and compared, not pixel by pixel (another Chromium draws letters
another way) but as an eye does from some steps away. MT_README_UPDATE=1 writes them anew."""
import base64
import os
import re
import unittest

from common_pages import EVERY, SOURCE, Answers

FOLDER = SOURCE / "tests/browser/pictures"
UPDATE = "MT_README_UPDATE" in os.environ
MOST_BYTES = 200_000
# Name, study, first and last element (up to its lower edge) that a picture shows.
PICTURES = [("report", "pump_on_mounts", "h1", "#figure-frequencies figure"),
            ("mechanism", "inceptor_rotor", "#figure-mechanism h2", "#figure-mechanism .legend")]
# What may happen to each, and what takes it back.
HARMS = {
    "mechanism": [("window.yaw = mt.shown.camera.yaw; mt.shown.camera.yaw += 0.6; mt.shown.camera.fit()", "mt.shown.camera.yaw = window.yaw; mt.shown.camera.fit()"),
                  ("document.querySelectorAll('.legend svg').forEach((s) => { s.style.display = 'none'; })",
                   "document.querySelectorAll('.legend svg').forEach((s) => { s.style.display = ''; })"),
                  ("mt.shown.views.forEach((view) => view.setMode(2))", "")],
    "report": [("document.querySelector('.gist').style.visibility = 'hidden'", "document.querySelector('.gist').style.visibility = ''"),
               ("document.querySelector('#figure-frequencies').style.marginTop = '80px'", "document.querySelector('#figure-frequencies').style.marginTop = ''"),
               ("document.querySelectorAll('#figure-frequencies rect').forEach((r) => r.remove())", "")],
}
WIDTH = 1000
MARGIN = 12
SIZE = 0.03       # of width and height
CELL = 20         # px: letters are a few of these; what is compared is the mean of a cell
# Of 255. Letters of another drawing of the same font move a cell's mean by some 10, a word that is not there by 40 and more.
WORST = 40
MEAN = 2.0
# Both pictures, the second scaled to the first, as means of cells: greatest and mean difference of any colour.
DIFFERENCE = """
const [first, second, cell, done] = arguments;
const load = (data) => new Promise((ready, failed) => { const image = new Image(); image.onload = () => ready(image);
    image.onerror = failed; image.src = 'data:image/png;base64,' + data; });
Promise.all([load(first), load(second)]).then(([a, b]) => {
    const w = a.width, h = a.height;
    const pixels = (image) => { const canvas = document.createElement('canvas'); canvas.width = w; canvas.height = h;
        const pen = canvas.getContext('2d', { willReadFrequently: true }); pen.drawImage(image, 0, 0, w, h);
        return pen.getImageData(0, 0, w, h).data; };
    const p = pixels(a), q = pixels(b);
    let worst = 0, sum = 0, count = 0;
    for (let y = 0; y + cell <= h; y += cell) for (let x = 0; x + cell <= w; x += cell) for (let c = 0; c < 3; c++) {
        let d = 0;
        for (let j = 0; j < cell; j++) for (let i = 0; i < cell; i++) { const k = 4 * ((y + j) * w + x + i) + c; d += p[k] - q[k]; }
        d = Math.abs(d) / (cell * cell); worst = Math.max(worst, d); sum += d; count++;
    }
    done({ sizes: [w, h, b.width, b.height], worst, mean: sum / count });
}, () => done(null));
"""
EDGES = """
const [first, last] = arguments[0].map((s) => document.querySelector(s).getBoundingClientRect());
return [first.top + scrollY, last.bottom + scrollY];
"""


class Pictures(Answers):
    studies = [SOURCE / "studies" / f"{name}.json" for name in sorted({study for _, study, _, _ in PICTURES})]

    def make(self, name, first, last):
        self.browser.settle()
        top, bottom = self.browser.run(EDGES, [first, last])
        path = self.folder / f"{name}.png"
        self.browser.picture(path, (0, max(0, top - MARGIN), WIDTH, bottom - top + 2 * MARGIN))
        return path

    def difference(self, made, kept):
        data = [base64.b64encode(path.read_bytes()).decode() for path in (made, kept)]
        found = self.browser.driver.execute_async_script(DIFFERENCE, *data, CELL)
        self.assertIsNotNone(found, f"{kept} is no picture")
        return found

    def judge(self, made, kept):
        found = self.difference(made, kept)
        w, h, v, g = found["sizes"]
        told = [] if abs(w - v) <= SIZE * w and abs(h - g) <= SIZE * h else [f"{v} x {g} instead of {w} x {h}"]
        told += [f"a part differs by {found['worst']:.0f} of 255"] if not found["worst"] <= WORST else []
        return told + ([f"it differs by {found['mean']:.1f} of 255"] if not found["mean"] <= MEAN else [])

    def test_they_are_what_pages_look_like(self):
        """And what a page would look like that has changed is found: each harm in turn (the last; MT_EVERY=1: all), taken back but for the last."""
        for study in sorted({study for _, study, *_ in PICTURES}):
            self.open(study, width=WIDTH)
            for name, _, *ends in [picture for picture in PICTURES if picture[1] == study]:
                kept = FOLDER / f"{name}.png"
                with self.subTest(picture=name):
                    made = self.make(name, *ends)
                    if UPDATE:
                        FOLDER.mkdir(exist_ok=True)
                        kept.write_bytes(made.read_bytes())
                    self.assertLess(kept.stat().st_size, MOST_BYTES)
                    self.assertEqual(self.judge(made, kept), [])
                for harm, back in HARMS[name] if EVERY or UPDATE else HARMS[name][-1:]:
                    with self.subTest(picture=name, harm=harm):
                        self.browser.run(harm)
                        self.assertNotEqual(self.judge(self.make(name, *ends), kept), [])
                        self.browser.run(back)
                        if EVERY and back:
                            self.assertEqual(self.judge(self.make(name, *ends), kept), [])

    def test_the_documents_show_them_all(self):
        text = "".join((SOURCE / page).read_text(encoding="utf-8") for page in ("README.md", "problems/README.md"))
        shown = set(re.findall(r"!\[[^]]+\]\((?:\.\./)?(tests/browser/pictures/[^)]+)\)", text))
        self.assertEqual(shown, {f"tests/browser/pictures/{name}.png" for name, *_ in PICTURES})
        self.assertEqual({path.name for path in FOLDER.iterdir()}, {f"{name}.png" for name, *_ in PICTURES})


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""The view of a mechanism in a browser, on a linkage whose every place is known, and what the browser's judge can find."""
import math
import unittest

import common_pages
from common_pages import EVERY, WINDOWS
from scenes import BROKEN, DEAD, HOSTILE, page, scene
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.actions.wheel_input import ScrollOrigin
from selenium.webdriver.common.keys import Keys

FAULTS = """<!DOCTYPE html><html><body><div id="wide" style="width: 5000px">wide</div>
<svg width="200" height="50"><text x="5" y="20">one label</text><text x="8" y="22">another one</text></svg>
<script>console.log('heard'); fetch('http://127.0.0.1:9/').catch(() => 0);</script></body></html>"""
# Largest distance in pixels of the places where the two bodies of each joint have it, in a state of the configuration.
APART = """
const view = mt.shown.views[0];
Object.assign(view.camera, { yaw: 0.5, pitch: 0.5 });
const lens = view.camera.lens(1000, 1000);
const far = (state) => { const c = view.configuration(); let worst = 0;
    c.joints.forEach((joint) => { const [p, q] = joint.bodies.map((b) => {
        const one = { ...c, joints: [], lines: [], points: [{ body: b, at: joint.at }] };
        return lens.project(mt.pose(one, state).points[0].at); });
        worst = Math.max(worst, Math.hypot(p[0] - q[0], p[1] - q[1])); });
    return worst; };
return [far({ mode: null, position: arguments[0], displacement: 0 }),
    far({ mode: 0, position: null, displacement: 0.05 }), far({ mode: 1, position: null, displacement: 0.05 })];
"""
# An ellipsoid's outline against the farthest of many of its points, in each direction of the picture.
OUTLINE = """
const camera = mt.camera({ size: 1, dimension: 3, gravity: null });
camera.yaw = 0.7; camera.pitch = 0.4;
const lens = camera.lens(500, 400);
const at = [0.1, -0.2, 0.05];
const axes = [[0.3, 0.1, 0], [-0.05, 0.15, 0.02], [0.01, -0.02, 0.08]];
const [x, y, a, b, angle] = mt.symbols.ellipsoid(at, axes, lens);
const rays = Array.from({ length: 24 }, (_, k) => [Math.cos(k * Math.PI / 12), Math.sin(k * Math.PI / 12)]);
const reach = rays.map(() => 0);
for (let i = 0; i <= 180; i++) for (let j = 0; j < 360; j++) {
    const t = i * Math.PI / 180, f = j * Math.PI / 180;
    const w = [Math.sin(t) * Math.cos(f), Math.sin(t) * Math.sin(f), Math.cos(t)];
    const p = lens.project([0, 1, 2].map((c) => at[c] + axes.reduce((s, v, n) => s + w[n] * v[c], 0)));
    rays.forEach((u, k) => { reach[k] = Math.max(reach[k], (p[0] - x) * u[0] + (p[1] - y) * u[1]); });
}
let worst = 0;
rays.forEach((u, k) => {
    const along = Math.cos(angle) * u[0] + Math.sin(angle) * u[1];
    const across = -Math.sin(angle) * u[0] + Math.cos(angle) * u[1];
    worst = Math.max(worst, Math.abs(Math.hypot(a * along, b * across) - reach[k]) / a);
});
return worst;
"""
# Where the axes x, y, z point in the picture of a camera that looks along one of them.
ALONG = """
const camera = mt.camera(arguments[0]);
const lens = () => camera.lens(100, 100).direction;
return [0, 1, 2].map((axis) => { camera.lookAlong(axis);
    return [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((v) => lens()(v).map((x) => Math.round(x * 1e6) / 1e6 + 0)); });
"""
INSIDE = """
const view = mt.shown.views[0];
const width = view.canvas.clientWidth, height = view.canvas.clientHeight;
const lens = view.camera.lens(width, height);
const all = mt.poseExtent(mt.pose(view.configuration(), { mode: null, position: null, displacement: 0 })).map(lens.project);
return all.every((p) => p[0] > 0 && p[0] < width && p[1] > 0 && p[1] < height) && all.length > 10;
"""
JOINT = """
const view = mt.shown.views[0];
const lens = view.camera.lens(view.canvas.clientWidth, view.canvas.clientHeight);
const here = mt.pose(view.configuration(), { mode: 0, position: null, displacement: view.clock.value() * 0.9 });
return lens.project(here.joints.find((j) => j.item.name === arguments[0]).at);
"""


class Pages(common_pages.Pages):
    def show(self, data=None, name="scene", **wishes):
        path = self.folder / f"{name}.html"
        path.write_text(page(data or scene()), encoding="utf-8")
        self.browser.open(path, **wishes)

    def canvas(self):
        return self.browser.one(".view3d canvas")


class Judge(Pages):
    def test_what_is_planted_is_found(self):
        path = self.folder / "faults.html"
        path.write_text(FAULTS, encoding="utf-8")
        self.browser.open(path)
        found = "\n".join(self.browser.problems())
        for part in ("heard", "asks for http://127.0.0.1:9/", "DIV", "sideways", '"one label" on "another one"'):
            self.assertIn(part, found)


class Geometry(Pages):
    def test_axes_joints_and_ellipsoids(self):
        self.show()
        # axes point where people expect them
        up_z = self.browser.run(ALONG, {"size": 1, "dimension": 3, "gravity": [0, 0, -9.81]})
        # right, down, towards the eye
        self.assertEqual(up_z[0], [[0, 0, 1], [1, 0, 0], [0, -1, 0]])
        self.assertEqual(up_z[1], [[1, 0, 0], [0, 0, -1], [0, -1, 0]])
        self.assertEqual(up_z[2], [[1, 0, 0], [0, -1, 0], [0, 0, 1]])
        plane = self.browser.run(ALONG, {"size": 1, "dimension": 2, "gravity": None})
        self.assertEqual(plane[2], [[1, 0, 0], [0, -1, 0], [0, 0, 1]])
        hanging = self.browser.run(ALONG, {"size": 1, "dimension": 3, "gravity": [0, 0, 9.81]})
        self.assertEqual(hanging[0][2], [0, 1, 0])  # z is down
        # joints hold what they hold
        for k in (0, 8, 18):
            driven, moved, foreign = self.browser.run(APART, k)
            self.assertLess(driven, 1e-6)
            self.assertLess(moved, 0.01)  # by central differences
            self.assertGreater(foreign, 1)  # a mode that is none of the mechanism: the measure can fail
        self.assertTrue(math.isfinite(driven))
        # the outline of an ellipsoid
        self.assertLess(self.browser.run(OUTLINE), 2e-4)

    def test_a_fitted_scene_is_inside(self):
        for width in (390, 1280):
            self.show(width=width)
            self.assertTrue(self.browser.run(INSIDE))
            self.browser.run("mt.shown.camera.yaw = 1; mt.shown.camera.pitch = 0.6; mt.shown.camera.setPerspective(true); mt.shown.camera.fit()")
            self.assertTrue(self.browser.run(INSIDE))
            self.browser.run("mt.shown.camera.zoomBy(30)")
            self.assertFalse(self.browser.run(INSIDE))


class Hands(Pages):
    def state(self):
        return self.browser.run("const c = mt.shown.camera; return [c.yaw, c.pitch, c.zoom, ...c.centre]")

    def test_keys_turn_zoom_and_fit(self):
        self.show()
        home = self.state()
        self.canvas().send_keys(Keys.ARROW_LEFT, Keys.ARROW_UP, "+")
        yaw, pitch, zoom = self.state()[:3]
        self.assertLess(yaw, home[0])
        self.assertGreater(pitch, home[1])
        self.assertGreater(zoom, home[2])
        self.canvas().send_keys("z", "0")
        for now, then in zip(self.state(), home):
            self.assertAlmostEqual(now, then, places=9)

    def test_pointer_turns_shift_moves_wheel_zooms(self):
        self.show()
        hand = ActionChains(self.browser.driver, duration=10)
        home = self.state()
        hand.move_to_element(self.canvas()).click_and_hold().move_by_offset(60, 20).release().perform()
        turned = self.state()
        self.assertAlmostEqual(turned[0], home[0] - 60 * 0.008, places=6)
        self.assertAlmostEqual(turned[1], home[1] + 20 * 0.008, places=6)
        hand = ActionChains(self.browser.driver, duration=10)
        hand.move_to_element(self.canvas()).key_down(Keys.SHIFT).click_and_hold().move_by_offset(40, 0).release().key_up(Keys.SHIFT).perform()
        moved = self.state()
        self.assertEqual(moved[:2], turned[:2])
        self.assertNotEqual(moved[3:], turned[3:])
        ActionChains(self.browser.driver, duration=10).scroll_from_origin(ScrollOrigin.from_element(self.canvas()), 0, -200).perform()
        self.assertGreater(self.state()[2], moved[2])

    def test_what_lies_under_the_pointer_is_named_as_text(self):
        self.show()
        for name, told in (("A", "revolute joint"), ("B", HOSTILE)):
            x, y = self.browser.run(JOINT, name)[:2]
            box = self.canvas().rect
            hand = ActionChains(self.browser.driver, duration=10)
            hand.move_to_element_with_offset(self.canvas(), round(x - box["width"] / 2), round(y - box["height"] / 2)).perform()
            text = self.browser.one(".tip:not([hidden])").text
            self.assertTrue(text.startswith(name), text)
            self.assertIn(told, text)
        self.assertEqual(self.browser.all("img"), [])


class Panels(Pages):
    def hertz(self):
        return [float(cell.get_attribute("data-hz")) for cell in self.browser.all(".modes td[data-hz]")]

    def test_modes_of_two_designs_side_by_side(self):
        data = scene()
        self.show(data)
        rows = zip(*(design["configurations"][0]["modes"] for design in data["designs"]))
        self.assertEqual(self.hertz(), [mode["hz"] for row in rows for mode in row])
        self.assertEqual(len(self.browser.all(".view3d")), 2)
        chosen = "return mt.shown.views.map((v) => document.querySelector('tr.chosen').textContent)[0]"
        self.browser.one(".modes input").send_keys(Keys.ARROW_DOWN)
        self.assertTrue(self.browser.run(chosen).strip().startswith("2"))
        largest = self.browser.one("table.energy th").text
        self.assertEqual(largest, "K_bush")
        self.assertEqual([e.text for e in self.browser.all("table.energy tr:first-child .percent")][:2], ["70.0 %", "70.0 %"])

    def test_one_of_several_is_compared(self):
        self.show(scene(3))
        self.assertEqual([c.text for c in self.browser.all(".view3d figcaption")], ["original", "recommended, rank 1"])
        self.browser.all("select")[1].send_keys(Keys.ARROW_DOWN)
        self.assertEqual([c.text for c in self.browser.all(".view3d figcaption")], ["original", "recommended, rank 2"])
        self.assertEqual(self.browser.problems(), [])

    def test_drive_goes_through_its_positions(self):
        self.show()
        slider = self.browser.one("#drive")
        slider.send_keys(Keys.ARROW_RIGHT)
        place = self.browser.one("output").text
        self.assertEqual(place, f"{math.degrees(1.1 + 0.1):.4g}°")
        slider.send_keys(Keys.END, Keys.ARROW_LEFT)
        self.assertEqual(self.browser.run("return document.getElementById('drive').valueAsNumber"), DEAD)
        self.assertIn("dead centre", self.browser.one(".trouble:not([hidden])").text)
        self.browser.one(".drive button").click()
        self.assertIn("as drawn", self.browser.one("output").text)
        self.assertEqual(self.browser.problems(), [])

    def test_what_cannot_be_assembled_says_why(self):
        self.show()
        self.browser.one("select").send_keys(Keys.ARROW_DOWN, Keys.ARROW_DOWN)
        self.assertEqual(self.browser.one(".trouble:not([hidden])").text, BROKEN)
        self.assertEqual(self.browser.problems(), [])

    def test_unstable_modes_have_no_frequency_and_far_joints_are_marked(self):
        self.show()
        self.browser.one("select").send_keys(Keys.ARROW_DOWN)
        row = self.browser.all(".modes tbody tr")[1].text
        self.assertIn("unstable", row)
        self.assertNotIn("NaN", self.browser.one("main").text)
        far = self.browser.all("tr.far")
        self.assertEqual(len(far), 1)
        self.assertIn("200 mm", far[0].text)

    def test_nothing_overflows_or_hides(self):
        self.show(scene(3))
        for turn in range(3):
            for window in WINDOWS if EVERY else [WINDOWS[2 * turn + turn % 2]]:
                self.browser.screen(**window)
                self.browser.settle()
                self.assertEqual(self.browser.problems(), [], window)
            self.browser.one("select").send_keys(Keys.ARROW_DOWN)
            self.browser.settle()


class Motion(Pages):
    def test_it_moves_unless_people_ask_for_stillness(self):
        for still in (True, False):
            self.show(still=still)
            self.assertEqual(self.browser.run("return mt.shown.clock.playing"), not still)
        button = self.browser.one(".controls button")
        self.assertEqual(button.text, "Pause")
        picture = "return document.querySelector('canvas').toDataURL()"
        first = self.browser.run(picture)
        seen = {first}  # a swing shows the same picture twice in a period, and a busy browser the same frame again
        for _ in range(50):
            self.browser.settle()
            seen.add(self.browser.run(picture))
            if len(seen) > 2:
                break
        self.assertGreater(len(seen), 2)
        button.click()
        self.browser.settle()
        first = self.browser.run(picture)
        self.browser.settle()
        self.assertEqual(self.browser.run(picture), first)

    def test_pictures_and_paper(self):
        self.show(dark=True)
        self.browser.run("window.saved = []; mt.save = (...what) => window.saved.push(what)")
        for button in self.browser.all(".controls button"):
            if button.text.startswith("Save"):
                button.click()
        names = self.browser.driver.execute_async_script(
            "const done = arguments[0]; const wait = () => (window.saved.length < 4 ? setTimeout(wait, 20) : done(window.saved.map("
            "([name, what]) => [name, typeof what === 'string' ? what : what.type + ' ' + what.size]))); wait();")
        svg = [what for name, what in names if name.endswith(".svg")]
        png = [what for name, what in names if name.endswith(".png")]
        self.assertEqual((len(svg), len(png)), (2, 2))
        self.assertRegex(svg[0], r'^<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 \d+ \d+"')
        self.assertIn('fill="#ffffff"', svg[0])  # paper, also where the screen is dark
        self.assertNotIn("<script", svg[0])
        self.assertRegex(png[0], r"^image/png \d{4,}$")
        self.assertTrue(self.browser.pdf().startswith(b"%PDF"))
        self.assertEqual(self.browser.problems(), [])


if __name__ == "__main__":
    unittest.main()

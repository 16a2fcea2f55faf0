# SPDX-License-Identifier: GPL-3.0-or-later
"""A headless Chromium that opens pages from files and says what is wrong with them."""
import base64
import json
import os
import shutil
import tempfile

from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By

SWITCHES = ["--headless=new", "--disable-gpu", "--disable-dev-shm-usage", "--disable-extensions",
            "--disable-background-networking", "--disable-component-update", "--disable-sync",
            "--no-first-run", "--no-default-browser-check", "--hide-scrollbars", "--force-color-profile=srgb"]
INSIDE = ("data:", "blob:")  # what a page asks itself for

# Elements that reach beyond the window and that nobody can scroll into it.
OVERFLOW = """
const width = document.documentElement.clientWidth;
const scrolls = (e) => { for (let p = e.parentElement; p && p !== document.body; p = p.parentElement) {
    if (['auto', 'scroll', 'hidden'].includes(getComputedStyle(p).overflowX)) return true; } return false; };
const bad = [...document.body.querySelectorAll('*')].filter((e) => {
    const r = e.getBoundingClientRect();
    return r.width > 0 && r.height > 0 && (r.right > width + 1 || r.left < -1) && !scrolls(e); });
return bad.slice(0, 5).map((e) => e.tagName + '.' + (e.getAttribute('class') || '') + ' '
    + Math.round(e.getBoundingClientRect().right) + ' of ' + width)
    .concat(document.documentElement.scrollWidth > width ? ['the page scrolls sideways'] : []);
"""

# Pairs of texts of one figure that cover more than the given share of the smaller one, and texts cut off by its edge.
OVERLAPS = """
const bad = [];
document.querySelectorAll('svg').forEach((svg) => {
    const frame = svg.getBoundingClientRect();
    const texts = [...svg.querySelectorAll('text')].filter((t) => t.textContent.trim() !== '')
        .map((t) => [t.textContent, t.getBoundingClientRect()]).filter(([, r]) => r.width > 0);
    texts.forEach(([a, p], i) => {
        if (p.left < frame.left - 2 || p.right > frame.right + 2) bad.push('"' + a + '" is cut off');
        texts.slice(i + 1).forEach(([b, q]) => {
            const w = Math.min(p.right, q.right) - Math.max(p.left, q.left);
            const h = Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top);
            const least = Math.min(p.width * p.height, q.width * q.height);
            if (w > 0 && h > 0 && w * h > arguments[0] * least) bad.push('"' + a + '" on "' + b + '"');
        });
    });
});
return bad.slice(0, 8);
"""


class Browser:
    """One Chromium for many pages: starting it takes longer than any of them."""

    def __init__(self):
        self.profile = tempfile.mkdtemp(prefix="modetune-browser-")
        options = Options()
        for switch in SWITCHES + [f"--user-data-dir={self.profile}"] + (["--no-sandbox"] if os.geteuid() == 0 else []):
            options.add_argument(switch)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        options.binary_location = shutil.which("chromium") or "/usr/bin/chromium"
        service = Service(shutil.which("chromedriver") or "/usr/bin/chromedriver")
        self.driver = webdriver.Chrome(service=service, options=options)
        self.driver.set_script_timeout(20)

    def close(self):
        self.driver.quit()
        shutil.rmtree(self.profile, ignore_errors=True)

    def screen(self, width=1280, height=900, dark=False, still=True):
        """The window, and what people ask for: dark colours, no motion."""
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                    {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False})
        wishes = {"prefers-color-scheme": "dark" if dark else "light",
                  "prefers-reduced-motion": "reduce" if still else "no-preference"}
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {
            "features": [{"name": name, "value": value} for name, value in wishes.items()]})

    def open(self, path):
        """Opens a file and waits until it has drawn."""
        self.driver.get_log("browser")
        self.driver.get_log("performance")
        self.driver.get(path.as_uri())
        self.settle()

    def settle(self):
        """Until what was asked for is on the screen."""
        self.driver.execute_async_script(
            "const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => done()));")

    def run(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def all(self, selector):
        return self.driver.find_elements(By.CSS_SELECTOR, selector)

    def one(self, selector):
        return self.driver.find_element(By.CSS_SELECTOR, selector)

    def console(self):
        """All that the console has heard since the page was opened, refusals of its policy among it."""
        return [f"{entry['level']}: {entry['message']}" for entry in self.driver.get_log("browser")]

    def requests(self):
        """What the page asked for besides itself and its own data, since it was opened."""
        events = [json.loads(entry["message"])["message"] for entry in self.driver.get_log("performance")]
        asked = [event["params"]["request"]["url"] for event in events if event["method"] == "Network.requestWillBeSent"]
        return [url for url in asked if url != self.driver.current_url and not url.startswith(INSIDE)]

    def layout(self, share=0.2):
        """What reaches beyond the window, and texts of figures that hide each other."""
        return self.run(OVERFLOW) + self.run(OVERLAPS, share)

    def problems(self):
        """All of it, of the page as it is."""
        return self.console() + ["asks for " + url for url in self.requests()] + self.layout()

    def pdf(self):
        """The page as it would be printed."""
        printed = self.driver.execute_cdp_cmd("Page.printToPDF", {"printBackground": True, "preferCSSPageSize": True})
        return base64.b64decode(printed["data"])

    def picture(self, path):
        """For people who look at what a test sees."""
        path.write_bytes(self.driver.get_screenshot_as_png())

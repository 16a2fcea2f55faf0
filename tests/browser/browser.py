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

# Pairs of pieces of text of the page itself, outside figures, that cover more than the given share of the smaller one.
HIDDEN = """
const rects = [];
const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    const parent = node.parentElement;
    if (node.textContent.trim() === '' || parent.closest('svg, script, style, .choice, .tip, option')
        || (parent.closest('details:not([open])') && !parent.closest('summary'))) continue;
    const range = document.createRange();
    range.selectNodeContents(node);
    for (const r of range.getClientRects()) if (r.width > 1 && r.height > 1) rects.push([r, node.textContent.trim().slice(0, 30), node]);
}
rects.sort((a, b) => a[0].top - b[0].top);
const cut = (node, r) => { for (let p = node.parentElement; p; p = p.parentElement) {
    if (getComputedStyle(p).overflowX !== 'visible') { const q = p.getBoundingClientRect(); if (r.left >= q.right || r.right <= q.left) return true; } }
    return false; };
const bad = [];
rects.forEach(([p, a, n], i) => {
    for (let k = i + 1; k < rects.length && rects[k][0].top < p.bottom; k++) {
        const [q, b, m] = rects[k];
        const w = Math.min(p.right, q.right) - Math.max(p.left, q.left);
        const h = Math.min(p.bottom, q.bottom) - q.top;
        if (w > 0 && h > 0 && w * h > arguments[0] * Math.min(p.width * p.height, q.width * q.height) && !cut(n, p) && !cut(m, q))
            bad.push('"' + a + '" on "' + b + '" in the page');
    }
});
return bad.slice(0, 8);
"""

# What paper cannot scroll.
CUT = """
return [...document.querySelectorAll('main *')].filter((e) => !e.closest('svg') && e.clientWidth > 0 && e.scrollWidth > e.clientWidth + 1
    && getComputedStyle(e).overflowX !== 'visible').slice(0, 5).map((e) => e.tagName + ' is cut on paper: ' + e.textContent.slice(0, 40))
    .concat(document.documentElement.scrollWidth > document.documentElement.clientWidth ? ['wider than paper'] : []);
"""
# What paper has no use for: words for hands, and designs that are not chosen (the original stands above the one that is).
HANDS = """
const rows = [...document.querySelectorAll('.alternatives tbody tr')].filter((row) => row.getClientRects().length > 0);
return (document.querySelector('main').innerText.match(/.*\\b([Cc]lick|Drag|Choose)\\b.*/g) || []).map((line) => 'on paper: ' + line)
    .concat(rows.length > 2 ? [rows.length + ' designs on paper'] : []);
"""
# Numbers that are none, wherever they show.
NO_NUMBERS = r"""
const told = [...document.querySelectorAll('main *')].flatMap((e) => [...e.attributes].map((a) => a.value)
    .concat([...e.childNodes].filter((n) => n.nodeType === Node.TEXT_NODE).map((n) => n.textContent)));
return told.filter((text) => /\b(NaN|Infinity|undefined)\b|\[object/.test(text)).slice(0, 5);
"""
PAPER = 680  # px: A4 without its margins, at 96 to the inch


class Browser:
    """One Chromium for many pages: starting it takes longer than any of them."""

    def __init__(self):
        self.profile = tempfile.mkdtemp(prefix="modetune-browser-")
        options = Options()
        for switch in SWITCHES + [f"--user-data-dir={self.profile}"] + (["--no-sandbox"] if os.geteuid() == 0 else []):
            options.add_argument(switch)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        options.add_experimental_option("perfLoggingPrefs", {"enableNetwork": True, "enablePage": False})
        options.binary_location = shutil.which("chromium") or "/usr/bin/chromium"
        service = Service(shutil.which("chromedriver") or "/usr/bin/chromedriver")
        self.driver = webdriver.Chrome(service=service, options=options)
        self.driver.set_script_timeout(60)
        self.window = None  # as it was opened in, or unknown

    def close(self):
        self.driver.quit()
        shutil.rmtree(self.profile, ignore_errors=True)

    def screen(self, width=1280, height=900, dark=False, still=True):
        """The window, and what people ask for: dark colours, no motion."""
        self.window = None
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                    {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False})
        wishes = {"prefers-color-scheme": "dark" if dark else "light",
                  "prefers-reduced-motion": "reduce" if still else "no-preference"}
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {
            "media": "", "features": [{"name": name, "value": value} for name, value in wishes.items()]})

    def open(self, path, **wishes):
        """Opens a file in the window that is wished for and waits until it has drawn. The page before, if it had another one, is left first: it need
        not draw itself anew for it."""
        if self.window != wishes:
            self.driver.get("about:blank")
            self.screen(**wishes)
            self.window = wishes
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
        return self.run(OVERFLOW) + self.run(OVERLAPS, share) + self.run(HIDDEN, share)

    def numbers(self):
        """What shows instead of a number."""
        return ["shows " + text for text in self.run(NO_NUMBERS)]

    def paper(self):
        """What is wrong with the page as it would be printed; it stays on paper until `screen`."""
        self.screen(PAPER, 1000)
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
        self.run("window.dispatchEvent(new Event('beforeprint'))")
        self.settle()
        found = self.layout() + self.run(CUT) + self.run(HANDS)
        self.run("window.dispatchEvent(new Event('afterprint'))")
        return found

    def problems(self):
        """All of it, of the page as it is."""
        return self.console() + ["asks for " + url for url in self.requests()] + self.layout()

    def pdf(self):
        """The page as it would be printed."""
        printed = self.driver.execute_cdp_cmd("Page.printToPDF", {"printBackground": True, "preferCSSPageSize": True})
        return base64.b64decode(printed["data"])

    def picture(self, path, clip=None):
        """For people who look at what a test sees; clip: x, y, width, height on the page."""
        asked = {} if clip is None else {"clip": dict(zip(("x", "y", "width", "height"), clip), scale=1), "captureBeyondViewport": True}
        path.write_bytes(base64.b64decode(self.driver.execute_cdp_cmd("Page.captureScreenshot", asked)["data"]))

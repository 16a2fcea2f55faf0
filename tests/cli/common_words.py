# SPDX-License-Identifier: GPL-3.0-or-later
"""What no output may hold: numbers that are none. Also the hunt looks for it."""
import json
import re

WORD = re.compile(r"(?<![A-Za-z_])[-+]?(nan|inf|infinity|undefined|infinite)(?![A-Za-z_])", re.I)
FIGURE = re.compile(r'\b(x|y|x1|x2|y1|y2|cx|cy|r|width|height|points|d|viewBox|transform)="([^"]*)"')
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?")
# A cell of a table may hold the word for what overflows (a percent of 5e-324); a sentence finds better ones.
CELL = re.compile(r"(?<=  )[-+]?infinite(?=  |\n)|(?<=>)[-+]?infinite(?=<)")

# Of a page: data, and the program that draws them, whose own words are not the answer's.
DATA = re.compile(r'<script type="application/json" id="\w+">(.*?)</script>', re.S)
SCRIPT = re.compile(r"<script>.*?</script>", re.S)


def without_program(page):
    """A page with its data, without the script that draws them."""
    return SCRIPT.sub("", page)


def problems_of(text, form):
    """What is wrong with one output."""
    if form == "html":
        for block in DATA.findall(text):
            yield from problems_of(block, "json")
        text = without_program(DATA.sub("", text))
    for match in WORD.finditer(CELL.sub("", text)):
        yield f"\"{match[0]}\" in {match.string[max(0, match.start() - 90):match.end() + 40]!r}"
    if form == "json" and text:
        try:
            json.loads(text, parse_constant=lambda c: 1 / 0)
        except (ValueError, ZeroDivisionError) as error:
            yield f"no JSON: {error!r}: {text[:200]!r}"
    if form == "html":
        for name, value in FIGURE.findall(text):
            for part in re.sub(r"[MLVHZ,()%]|translate|rotate", " ", value).split():
                if not NUMBER.fullmatch(part) or abs(float(part)) > 1e6:
                    yield f"figure: {name}=\"{value[:80]}\""

#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a person needs of the log of a step that failed: failures.py LOG STEP

Of ctest's log, for each failed test: its name, the lines that tell what went wrong, and the command that runs it alone.
Of any other log, its end. At most MOST lines.
"""
import re
import sys

MOST = 26
TELLING = re.compile(r"\b[Ee]rror\b|[Aa]ssert|FAIL|Traceback|Sanitizer|runtime error|==\d+==|expected|differs|"
                     r"! |\bnot \w+|Segmentation|warning:|Warning|Timeout|timed out|^(/[^:]+|[\w./-]+):\d+")


def blocks(text):
    """Failed tests in the order of the log: number, name, how it ended, output."""
    starts = list(re.finditer(r"^ *\d+/\d+ Test +#(\d+): (\S+) .*?(\*\*\*\S.*|Passed .*)$", text, re.M))
    for this, following in zip(starts, starts[1:] + [None]):
        if this[3].startswith("***"):
            end = following.start() if following else len(text)
            output = re.split(r"^\d+% tests passed", text[this.end():end], flags=re.M)[0]
            output = re.sub(r"^ +Start +\d+: \S+$\n?", "", output, flags=re.M)
            yield this[2], " ".join(this[3].strip("*").split()), [line for line in output.split("\n") if line.strip()]


def telling(lines, most):
    """The lines that tell what went wrong, the last ones where there are too many; else the end."""
    found = [line for line in lines if TELLING.search(line) and not re.search(r"\[ +(OK|RUN|PASSED) +\]", line)]
    return [line[:180] for line in (found or lines)[-most:]]


def told(text, step):
    failed = list(blocks(text))
    if not failed:
        return [line[:180] for line in text.rstrip("\n").split("\n")[-MOST:]]
    each = max(3, min(20, MOST // len(failed) - 2))
    out = []
    for place, (name, how, lines) in enumerate(failed):
        if len(out) + 4 > MOST and place + 1 < len(failed):
            return out + [f"and {len(failed) - place} more: " + " ".join(n for n, _, _ in failed[place:])]
        out.append(f"{name}: {how}")
        out += ["    " + line for line in telling(lines, each)]
        out.append(f"    again: ONLY='^{re.escape(name)}$' .ci/run {step}")
    return out


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8", errors="replace") as log:
        print("\n".join(told(log.read(), sys.argv[2])))

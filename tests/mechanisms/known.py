# SPDX-License-Identifier: GPL-3.0-or-later
"""Findings that wait for their mending: (check or None: all, of which cases, reason). Empty where all is well."""

KNOWN = [
    (None, lambda case: case.kind.startswith("decades"), "masses far apart cost digits, and motions that are free"),
    ("dead", lambda case: True, "linear theory is applied where it does not hold"),
    (None, lambda case: case.kind.startswith("neutral"), "balanced loads are judged by what rounding leaves of them"),
    (None, lambda case: case.kind.startswith("far"), "rest is sought next to the drawing, stable or not"),
]


def reason(check, case):
    """Why a finding is expected; None: it is not."""
    return next((why for c, seen, why in KNOWN if c in (None, check) and seen(case)), None)

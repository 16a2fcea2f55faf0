# SPDX-License-Identifier: GPL-3.0-or-later
"""Findings that wait for their mending: (check or None: all, of which cases, reason). Empty where all is well."""

KNOWN = [
    (None, lambda case: case.modes.blocked(), "a spring acts against what joints block: rounding of its row is taken for stiffness"),
    (None, lambda case: case.kind.startswith("decades"), "masses far apart cost digits, and motions that are free"),
]


def reason(check, case):
    """Why a finding is expected; None: it is not."""
    return next((why for c, seen, why in KNOWN if c in (None, check) and seen(case)), None)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Findings that wait for their mending: (check or None: all, kind of study or None: all, reason). Empty where all is well."""

KNOWN = [
    ("certificates", "tolerance", "kinds are counted without tolerances, and found with them"),
    ("goals", "cut_off", "a mode on the edge where the band is cut off is told to miss the margin of the other edge"),
    ("certificates", "cut_off", "as above, over tolerances"),
]


def reason(check, kind):
    """Why a finding is expected; None: it is not."""
    return next((why for c, k, why in KNOWN if c in (None, check) and k in (None, kind)), None)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Findings that wait for their mending: (check or None: all, kind of study or None: all, reason). Empty where all is well."""

KNOWN = [
    ("undetermined", None, "a room of rounding counts as room"),
    ("reasons", None, "logarithms are printed as per cent"),
    (None, "zero", "the number of rigid-body modes is that of the original design"),
]


def reason(check, kind):
    """Why a finding is expected; None: it is not."""
    return next((why for c, k, why in KNOWN if c in (None, check) and k in (None, kind)), None)

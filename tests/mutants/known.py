# SPDX-License-Identifier: GPL-3.0-or-later
"""Findings that wait for their mending: (check, part of the sentence, reason). Empty where all is well."""

KNOWN = []


def reason(check, text):
    """Why a finding is expected; None: it is not."""
    return next((why for c, part, why in KNOWN if c == check and part in text), None)

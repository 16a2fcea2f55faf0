# SPDX-License-Identifier: GPL-3.0-or-later
"""Findings of the generators that wait for their mending: (script, check, kind of case, part of the sentence, reason), None and "" for all. Empty where all
is well."""

KNOWN = []

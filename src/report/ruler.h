/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_RULER_H
#define REPORT_RULER_H

#include "base/text.h"
#include "result/result.h"

/*
 * Frequencies of a design in one line of characters per configuration, to one linear scale that
 * ends a little above what the study asks for: digits are the modes as recommended, "o" as they
 * were, "#" a band, "-" its margin, "|" a target, "[" and "]" limits. Nothing where nothing is
 * asked of frequencies. width: of the terminal; 0: none.
 */
void mt_report_ruler(const mt_recommendation *r, int width, mt_text *out);

#endif

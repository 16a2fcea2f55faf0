/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_RULER_H
#define REPORT_RULER_H

#include "base/text.h"
#include "result/result.h"

/*
 * The frequencies of a design as one line of characters per configuration, on one linear scale
 * that ends a little above the study's requirements: digits are the recommended modes, "o" the
 * original ones, "#" a band, "-" its margin, "|" a target, "[" and "]" limits. No text where no
 * goal concerns frequencies. width: of the terminal; 0: none.
 */
void mt_report_ruler(const mt_recommendation *r, int width, mt_text *out);

#endif

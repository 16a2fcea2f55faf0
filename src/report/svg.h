/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_SVG_H
#define REPORT_SVG_H

#include "base/text.h"
#include "result/result.h"

/* Distance of the marks of an axis of this length: 1, 2 or 5 times a power of ten, about six
 * marks. */
double mt_svg_step(double length);

/* Figures of a design: its frequencies before and after, and the changes of its parameters. */
void mt_report_svg_frequencies(const mt_recommendation *r, mt_text *out);
void mt_report_svg_changes(const mt_recommendation *r, mt_text *out);

#endif

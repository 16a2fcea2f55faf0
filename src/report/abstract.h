/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_ABSTRACT_H
#define REPORT_ABSTRACT_H

#include "base/text.h"
#include "result/result.h"

/* The first thing on a page: the status, then in a few lines what the best design changes, how
 * it meets the goals, what is proven and what else there is. Memory running out shows in
 * out->failed. */
void mt_report_abstract(const mt_result *result, mt_text *out);

/* "mass 16.94 kg (was 11.92)": what the study makes least or greatest, at this design; false
 * (and nothing) where that is the change. */
bool mt_report_headline(const mt_recommendation *r, mt_text *out);

#endif

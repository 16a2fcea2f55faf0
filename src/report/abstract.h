/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_ABSTRACT_H
#define REPORT_ABSTRACT_H

#include "base/text.h"
#include "result/result.h"

/* The abstract of a page: the status, then in a few lines the changes of the best design, how
 * it meets the goals, what is proven, and alternatives. out->failed remembers a shortage of
 * memory. */
void mt_report_abstract(const mt_result *result, mt_text *out);

/* The first objective at this design: "mass 16.94 kg (was 11.92)"; false (and no text) where it
 * is the change. */
bool mt_report_headline(const mt_recommendation *r, mt_text *out);

#endif

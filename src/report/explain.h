/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_EXPLAIN_H
#define REPORT_EXPLAIN_H

#include "base/text.h"
#include "report/table.h"
#include "result/result.h"

/*
 * The sensitivities and active limits of a design: for every goal the variables whose change of
 * 1 % changes its value, the most influential first, with their remaining range; then the
 * active bounds, the reasons of the kinds "hold" and "cost". width: of the terminal; 0: none.
 * out->failed remembers a shortage of memory.
 */
void mt_report_explain(const mt_result *result, const mt_recommendation *r, int width,
                       mt_text *out);
/* The sensitivities as rows: one per goal and variable, the most influential first. */
mt_table mt_report_movers(const mt_recommendation *r);

#endif

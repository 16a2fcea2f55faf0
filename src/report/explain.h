/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_EXPLAIN_H
#define REPORT_EXPLAIN_H

#include "base/text.h"
#include "report/table.h"
#include "result/result.h"

/*
 * What moves each goal of a design, what holds it, and what that costs: of every goal the
 * variables whose 1 % moves its value, the most first, and how far each may still go; then the
 * bounds that hold the design, its reasons of the kinds "hold" and "cost". width: of the
 * terminal; 0: none. Memory running out shows in out->failed.
 */
void mt_report_explain(const mt_result *result, const mt_recommendation *r, int width,
                       mt_text *out);
/* The same as rows: one per goal and variable, the most first. */
mt_table mt_report_movers(const mt_recommendation *r);

#endif

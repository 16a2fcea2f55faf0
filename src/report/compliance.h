/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_COMPLIANCE_H
#define REPORT_COMPLIANCE_H

#include "base/text.h"
#include "report/table.h"
#include "result/result.h"

/*
 * What was asked against what a design does, as an engineer signs it: one row for each
 * requirement, or for each band where they are few; in hertz where the result has a margin as a
 * percentage.
 */

/* requirement, limit, before, after (of the original design: value), at worst, margin, verdict.
 * Margin: how far the value is from its limit, in per cent of the limit; below 0 beyond it. The
 * caller frees it. */
mt_table mt_report_compliance(const mt_result *result, const mt_recommendation *r);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_COMPLIANCE_H
#define REPORT_COMPLIANCE_H

#include "base/text.h"
#include "report/table.h"
#include "result/result.h"

/*
 * The requirements compared with a design, as a compliance table: one row per requirement, or
 * per band where they are few; margins in hertz where the result has percentages.
 */

/* requirement, limit, before, after (of the original design: value), at worst, margin, verdict.
 * Margin: distance of the value from its limit in per cent of the limit; negative beyond it.
 * The caller frees the table. */
mt_table mt_report_compliance(const mt_result *result, const mt_recommendation *r);

#endif

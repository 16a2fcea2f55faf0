/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_TRADE_H
#define REPORT_TRADE_H

#include "report/table.h"
#include "result/result.h"

/* One row per point of the trade study: varied quantities, status, objectives, change,
 * clearance, parameters; the caller frees it. No columns without a trade study. */
mt_table mt_report_trade(const mt_result *result);
/* The rows of the selected points of a large grid (mt_trade_select), and a sentence about their
 * number; of any other grid all rows, and no sentence. The result must have a trade study. */
mt_table mt_report_trade_selected(const mt_result *result);
void mt_report_trade_left(const mt_result *result, mt_text *line);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_TRADE_H
#define REPORT_TRADE_H

#include "report/table.h"
#include "result/result.h"

/* One line per point of the trade study: what varies, status, objectives, change, clearance,
 * parameters; the caller frees it. No columns where there is none. */
mt_table mt_report_trade(const mt_result *result);
/* Of a large grid those that are shown whole (mt_trade_select), and how many of all these are
 * as a sentence; of any other all, and no text. There is a trade study. */
mt_table mt_report_trade_selected(const mt_result *result);
void mt_report_trade_left(const mt_result *result, mt_text *line);

#endif

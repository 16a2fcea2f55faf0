/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_TRADE_H
#define REPORT_TRADE_H

#include "report/table.h"
#include "result/result.h"

/* One line per point of the trade study: what varies, status, objectives, change, clearance,
 * parameters; the caller frees it. No columns where there is none. */
mt_table mt_report_trade(const mt_result *result);

#endif
